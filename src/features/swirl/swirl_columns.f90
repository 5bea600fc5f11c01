!> Columns of the grid for the velocity around the axis.
module sgmp_swirl_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, node_gyration, stage_momentum, &
                          stage_stress
  use sgmp_images, only: image_shear, image_t, image_vector
  implicit none
  private
  public :: swirl_ask

  integer, parameter :: around = 3   !! component of a vector around the axis

contains

  !> The velocity around the axis goes along all walls, its rate is even at the axis. Shear stresses
  !! at walls are odd, the centrifugal force is radial.
  pure subroutine swirl_ask(columns)
    type(columns_t), intent(inout) :: columns
    call columns_ask(columns, block_t('swirl', stage_momentum, [image_vector(around)]))
    call columns_ask(columns, block_t('gyration', stage_momentum, [image_t()], power=2))
    call columns_ask(columns, block_t('torque', stage_stress, [image_shear(1), image_shear(2)], &
                                      normalised=.true.))
    call columns_ask(columns, block_t('centrifugal', stage_stress, [image_vector(1)]))
    columns%nodes = node_gyration
  end subroutine swirl_ask

end module sgmp_swirl_columns
