!> Columns of the grid for forces from outside.
module sgmp_loads_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, stage_stress
  use sgmp_images, only: image_product, image_radial, image_t
  implicit none
  private
  public :: loads_ask, loads_ask_faces

contains

  !> The external force: what it is behind a wall, it is on this side, but along r behind an axis.
  pure subroutine loads_ask(columns, ndim)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    call columns_ask(columns, block_t('external', stage_stress, along_axes(ndim), outside=.true.))
  end subroutine loads_ask

  !> That on faces of particles; centres need its levers, component by component along each axis.
  pure subroutine loads_ask_faces(columns, ndim, centred)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    logical, intent(in) :: centred
    integer :: a, b, d
    call columns_ask(columns, block_t('faces', stage_stress, along_axes(ndim), apart=.true.))
    if (centred) call columns_ask(columns, block_t('lever', stage_stress, &
      [((image_product(a, [(d == b, d=1, ndim)]), b=1, ndim), a=1, ndim)], apart=.true.))
  end subroutine loads_ask_faces

  !> Images of the components of a force.
  pure function along_axes(ndim) result(images)
    integer, intent(in) :: ndim
    type(image_t) :: images(ndim)
    images(1) = image_radial()
  end function along_axes

end module sgmp_loads_columns
