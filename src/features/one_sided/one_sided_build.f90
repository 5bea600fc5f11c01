!> Walls of the grid that let go, as a body meets them.
module sgmp_one_sided_build
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_wave_modulus
  use sgmp_kinds, only: dp
  use sgmp_material_history, only: slots_ask, slots_column
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided, only: one_sided_first_way
  use sgmp_one_sided_columns, only: one_sided_components
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_scene, only: body_card_t, grid_card_t, scene_presses, scene_t
  use sgmp_voigt, only: voigt_axes
  implicit none
  private
  public :: one_sided_add_columns, one_sided_bear, one_sided_declare

  !> Stiffness of a wall over rho c^2/h, c that of plane waves, along rough ones over G/h. Softer
  !! ones are entered too far, stiffer ones shake what they throw back (doc/loads.md).
  real(dp), parameter :: stiffness = 0.4_dp
  !> The same where the deck moves something, which may press a body on a wall: there the springs
  !! must not give.
  real(dp), parameter :: firm = 2.0_dp
  real(dp), parameter :: deepest = 0.1_dp     !! of a floor's bed (cells)

contains

  !> The walls that a body may meet.
  pure subroutine one_sided_declare(scene, card, mesh, law, body)
    type(scene_t), intent(in) :: scene
    type(body_card_t), intent(in) :: card
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
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (.not. mesh%one_sided(side, axis)) cycle
        new%side = side
        new%axis = axis
        factor = merge(firm, stiffness, scene_presses(scene))
        new%stiffness = factor*law_wave_modulus(law)*mesh%inverse_h
        new%grip = factor*law%elastic%shear*mesh%inverse_h
        if (scene%grid%floor(side, axis)) then
          call make_floor(mesh, law, scene%grid, new)
        end if
        new%place = merge(scene%grid%lower(axis), scene%grid%upper(axis), side == 1)
        new%place = (new%place - mesh%origin(axis))*mesh%inverse_h
        new%friction = mesh%rough(side, axis)
        new%loaded = card%stress%given
        body%walls = [body%walls, new]
      end do
    end do
  end subroutine one_sided_declare

  !> The bed of a floor, which bears what stands on it: springs as stiff as the half of a particle
  !! that lies on them give as much as this half would, so that bodies stand as on a plane of
  !! symmetry. Those of a rough one are half as stiff: what slides shakes less.
  pure subroutine make_floor(mesh, law, grid, wall)
    type(mesh_t), intent(in) :: mesh
    type(constitutive_t), intent(in) :: law
    type(grid_card_t), intent(in) :: grid
    type(one_sided_wall_t), intent(inout) :: wall
    wall%hard = merge(1.0_dp, 2.0_dp, grid%rough(wall%side, wall%axis) > 0.0_dp)* &
                law_wave_modulus(law)/wall%spacing
    wall%hard = max(wall%hard, wall%stiffness)
    wall%bed = min(grid%floor_bears(wall%side, wall%axis)/wall%hard, deepest*mesh%h)
    wall%grip = firm*law%elastic%shear*mesh%inverse_h
  end subroutine make_floor

  !> Columns of the particles for their ways along rough walls, and their depths at the start:
  !! behind all that laws and methods ask for, before those of loads and driven parts, which know
  !! their places already when they ask.
  pure subroutine one_sided_add_columns(ndim, body)
    integer, intent(in) :: ndim
    type(body_t), intent(inout) :: body
    integer :: i, w, at
    associate (kept => count(body%walls%friction > 0.0_dp .or. body%walls%loaded))
      call slots_ask(body%law%slots, 'grip', [(0.0_dp, i=1, ndim*kept)])
    end associate
    at = slots_column(body%law%slots, 'grip')
    do w = 1, size(body%walls)
      if (.not. (body%walls(w)%friction > 0.0_dp .or. body%walls(w)%loaded)) cycle
      body%walls(w)%way = at
      at = at + ndim
    end do
  end subroutine one_sided_add_columns

  !> Lets the springs of a wall bear the stress with which a particle begins at it.
  pure subroutine one_sided_bear(mesh, wall, stress, place, state)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: stress(:)            !! components, at the face
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    real(dp), intent(inout) :: state(:)          !! columns of the particle
    real(dp) :: way(3), across(3)
    integer :: c, a, b
    across = 0.0_dp
    do c = 1, size(stress)
      a = voigt_axes(1, c)
      b = voigt_axes(2, c)
      if (a == wall%axis) across(b) = stress(c)
      if (b == wall%axis) across(a) = stress(c)
    end do
    across(mesh%ndim + 1:) = 0.0_dp
    way = one_sided_first_way(mesh, wall, place, across)
    state(wall%way:wall%way + mesh%ndim - 1) = way(:mesh%ndim)
  end subroutine one_sided_bear

end module sgmp_one_sided_build
