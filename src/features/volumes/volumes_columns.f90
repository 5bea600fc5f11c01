!> Columns of the grid for what particles relax by (doc/volumes.md).
module sgmp_volumes_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, stage_momentum, stage_stress
  use sgmp_images, only: image_t
  implicit none
  private
  public :: volumes_ask

contains

  !> Besides the volume, which others ask for, too: m |v|^2, the stiffness, the compliance and its
  !! products with p and p^2.
  pure subroutine volumes_ask(columns)
    type(columns_t), intent(inout) :: columns
    integer :: q
    call columns_ask(columns, block_t('square', stage_momentum, [image_t()]))
    call columns_ask(columns, block_t('stiffness', stage_stress, [image_t()]))
    call columns_ask(columns, block_t('compliance', stage_stress, [(image_t(), q=1, 3)]))
  end subroutine volumes_ask

end module sgmp_volumes_columns
