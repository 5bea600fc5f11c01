!> Columns of the grid for the forces of walls that let go.
module sgmp_one_sided_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, stage_stress
  use sgmp_images, only: image_radial, image_t
  implicit none
  private
  public :: one_sided_ask

contains

  !> One for each axis that has such walls; along r it turns behind the axis.
  pure subroutine one_sided_ask(columns, axes)
    type(columns_t), intent(inout) :: columns
    logical, intent(in) :: axes(:)
    type(image_t) :: images(count(axes))
    if (.not. any(axes)) return
    if (axes(1)) images(1) = image_radial()
    call columns_ask(columns, block_t('push', stage_stress, images, apart=.true.))
  end subroutine one_sided_ask

end module sgmp_one_sided_columns
