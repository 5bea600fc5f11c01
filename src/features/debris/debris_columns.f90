!> Columns of the grid for collisions of debris.
module sgmp_debris_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, stage_debris
  use sgmp_images, only: image_t, image_vector
  implicit none
  private
  public :: debris_ask

contains

  !> Mass and momentum of all particles; mass of debris that the grid does not see move, and that
  !! mass times the square of its velocity against the grid.
  pure subroutine debris_ask(columns, ndim)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    integer :: a
    call columns_ask(columns, block_t('debris', stage_debris, &
                                      [image_t(), (image_vector(a), a=1, ndim), image_t(), &
                                       image_t()]))
  end subroutine debris_ask

end module sgmp_debris_columns
