!> Columns of the grid for the impedance of absorbing edges.
module sgmp_absorbing_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, stage_stress
  use sgmp_images, only: image_product, image_t
  implicit none
  private
  public :: absorbing_ask

contains

  !> Force per velocity, component by component; centres need its levers along each axis.
  pure subroutine absorbing_ask(columns, ndim, centred)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    logical, intent(in) :: centred
    integer :: a, b, d
    call columns_ask(columns, block_t('impedance', stage_stress, [(image_t(), a=1, ndim)], &
                                      apart=.true.))
    if (centred) call columns_ask(columns, block_t('leverage', stage_stress, &
      [((image_product(0, [(d == b, d=1, ndim)]), b=1, ndim), a=1, ndim)], apart=.true.))
  end subroutine absorbing_ask

end module sgmp_absorbing_columns
