!> Walls of the grid that let go, as a body meets them.
module sgmp_one_sided_build
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_wave_modulus
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_scene, only: grid_card_t
  implicit none
  private
  public :: one_sided_declare

  !> Stiffness of a wall over rho c^2/h, c that of plane waves. Softer ones are entered too far,
  !! stiffer ones shake what they throw back (doc/loads.md).
  real(dp), parameter :: stiffness = 0.4_dp

contains

  !> The walls that a body may meet.
  pure subroutine one_sided_declare(grid, mesh, law, body)
    type(grid_card_t), intent(in) :: grid
    type(mesh_t), intent(in) :: mesh
    type(constitutive_t), intent(in) :: law
    type(body_t), intent(inout) :: body
    real(dp) :: place
    integer :: axis, column, side
    allocate (body%walls(0))
    if (body%rigid) return
    column = 0
    do axis = 1, mesh%ndim
      if (any(mesh%one_sided(:, axis))) column = column + 1
      do side = 1, 2
        if (.not. mesh%one_sided(side, axis)) cycle
        place = merge(grid%lower(axis), grid%upper(axis), side == 1)
        body%walls = [body%walls, &
                      one_sided_wall_t(side=side, axis=axis, column=column, spacing=body%spacing, &
                                       place=(place - mesh%origin(axis))*mesh%inverse_h, &
                                       stiffness=stiffness*law_wave_modulus(law)*mesh%inverse_h)]
      end do
    end do
  end subroutine one_sided_declare

end module sgmp_one_sided_build
