!> Walls of the grid that let go, as a body meets them.
module sgmp_one_sided_build
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_wave_modulus
  use sgmp_kinds, only: dp
  use sgmp_material_history, only: slots_ask, slots_column
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided_columns, only: one_sided_components
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_scene, only: scene_presses, scene_t
  implicit none
  private
  public :: one_sided_add_columns, one_sided_declare

  !> Stiffness of a wall over rho c^2/h, c that of plane waves, along rough ones over G/h. Softer
  !! ones are entered too far, stiffer ones shake what they throw back (doc/loads.md).
  real(dp), parameter :: stiffness = 0.4_dp
  !> The same where the deck moves something, which may press a body on a wall: there the springs
  !! must not give, and are as half a cell of the material.
  real(dp), parameter :: firm = 2.0_dp

contains

  !> The walls that a body may meet.
  pure subroutine one_sided_declare(scene, mesh, law, body)
    type(scene_t), intent(in) :: scene
    type(mesh_t), intent(in) :: mesh
    type(constitutive_t), intent(in) :: law
    type(body_t), intent(inout) :: body
    type(one_sided_wall_t) :: new
    real(dp) :: factor
    logical :: acts(3)
    integer :: axis, side, a
    allocate (body%walls(0))
    if (body%rigid) return
    acts = one_sided_components(mesh)
    new%columns = merge([(count(acts(:a)), a=1, 3)], 0, acts)
    new%spacing = body%spacing
    factor = merge(firm, stiffness, scene_presses(scene))
    new%stiffness = factor*law_wave_modulus(law)*mesh%inverse_h
    new%grip = factor*law%elastic%shear*mesh%inverse_h
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (.not. mesh%one_sided(side, axis)) cycle
        new%side = side
        new%axis = axis
        new%place = merge(scene%grid%lower(axis), scene%grid%upper(axis), side == 1)
        new%place = (new%place - mesh%origin(axis))*mesh%inverse_h
        new%friction = mesh%rough(side, axis)
        body%walls = [body%walls, new]
      end do
    end do
  end subroutine one_sided_declare

  !> Columns of the particles for their ways along rough walls: behind all that laws and methods ask
  !! for, before those of loads and driven parts, which know their places already when they ask.
  pure subroutine one_sided_add_columns(ndim, body)
    integer, intent(in) :: ndim
    type(body_t), intent(inout) :: body
    integer :: i, w, at
    associate (rough => count(body%walls%friction > 0.0_dp))
      call slots_ask(body%law%slots, 'grip', [(0.0_dp, i=1, ndim*rough)])
    end associate
    at = slots_column(body%law%slots, 'grip')
    do w = 1, size(body%walls)
      if (.not. body%walls(w)%friction > 0.0_dp) cycle
      body%walls(w)%way = at
      at = at + ndim
    end do
  end subroutine one_sided_add_columns

end module sgmp_one_sided_build
