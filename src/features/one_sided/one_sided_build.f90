!> Walls of the grid that let go, as a body meets them.
module sgmp_one_sided_build
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_wave_modulus
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: slots_ask, slots_column
  use sgmp_mesh, only: mesh_places, mesh_t
  use sgmp_one_sided, only: one_sided_gap, one_sided_load
  use sgmp_one_sided_columns, only: one_sided_components
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_scene, only: body_card_t, grid_card_t, layout_file, layout_lattice, scene_presses, &
                        scene_pulls, scene_t
  use sgmp_shapes, only: rim_depth, shapes_rim
  use sgmp_turn, only: turn_back, turn_direction, turn_inverse
  use sgmp_voigt, only: voigt_axes
  implicit none
  private
  public :: one_sided_add_columns, one_sided_bear, one_sided_declare, one_sided_rim, one_sided_seat

  !> Stiffness of a wall over rho c^2/h, c that of plane waves, along rough ones over G/h. Softer
  !! ones are entered too far, stiffer ones shake what they throw back (doc/loads.md).
  real(dp), parameter :: stiffness = 0.4_dp
  !> The same where the deck moves something, which may press a body on a wall: there the springs
  !! must not give.
  real(dp), parameter :: firm = 4.0_dp
  !> The same up to what stands on a smooth floor, which may move little for it to stand there.
  real(dp), parameter :: hard = 8.0_dp
  real(dp), parameter :: deepest = 0.1_dp     !! where these end (cells)
  real(dp), parameter :: near_one = 1.0e-6_dp  !! rows are a spacing from each other to round-off
  !> How far from its centre the face of a particle may lie (spacings; cells, of which springs reach
  !! one).
  real(dp), parameter :: rim_spacings = 1.5_dp, rim_cells = 0.95_dp
  real(dp), parameter :: beside = 1.0e-6_dp    !! a unit vector across another has no more of it

contains

  !> The walls that a body may meet.
  pure subroutine one_sided_declare(scene, mesh, kernel, law, body)
    type(scene_t), intent(in) :: scene
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel
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
    new%turns = kernel_centred(kernel)
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (.not. mesh%one_sided(side, axis)) cycle
        new%side = side
        new%axis = axis
        factor = merge(firm, stiffness, scene_presses(scene))
        new%stiffness = factor*law_wave_modulus(law)*mesh%inverse_h
        new%grip = factor*law%elastic%shear*mesh%inverse_h
        if (scene%grid%floor(side, axis)) call make_bed(mesh, law, scene%grid, new)
        new%place = merge(scene%grid%lower(axis), scene%grid%upper(axis), side == 1)
        new%place = (new%place - mesh%origin(axis))*mesh%inverse_h
        new%friction = mesh%rough(side, axis)
        body%walls = [body%walls, new]
      end do
    end do
  end subroutine one_sided_declare

  !> The bed of a smooth floor bears what stands there as a plane of symmetry would. What rubs needs
  !! none: it would hop.
  pure subroutine make_bed(mesh, law, grid, wall)
    type(mesh_t), intent(in) :: mesh
    type(constitutive_t), intent(in) :: law
    type(grid_card_t), intent(in) :: grid
    type(one_sided_wall_t), intent(inout) :: wall
    if (grid%rough(wall%side, wall%axis) > 0.0_dp) return
    wall%hard = hard*law_wave_modulus(law)*mesh%inverse_h
    wall%bed = min(grid%floor_bears(wall%side, wall%axis)/wall%hard, deepest*mesh%h)
  end subroutine make_bed

  !> Columns of the particles for their faces at walls: behind all that laws and methods ask for,
  !! before those of loads and driven parts, which know their places already when they ask.
  pure subroutine one_sided_add_columns(scene, number, ndim, body)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number, ndim          !! number: of the body
    type(body_t), intent(inout) :: body
    logical :: round(size(body%walls))
    integer :: columns, i, w, at
    round = [(rolls(scene, scene%bodies(number), body%walls(w)), w=1, size(body%walls))]
    columns = size(round) + (ndim - 1)*count(body%walls%friction > 0.0_dp)
    call slots_ask(body%law%slots, 'grip', &
                   [(0.0_dp, i=1, columns + merge(1, 0, any(round)))])
    at = slots_column(body%law%slots, 'grip')
    where (round) body%walls%rim = at + columns
    do w = 1, size(body%walls)
      associate (wall => body%walls(w))
        wall%half = at
        if (wall%friction > 0.0_dp) then
          wall%way = at
          wall%half = at + wall%axis - 1
        end if
        at = at + merge(ndim, 1, wall%way > 0)
      end associate
    end do
  end subroutine one_sided_add_columns

  !> Whether a body may roll on a wall: it is round there, the wall is rough, and something pulls.
  !! What only bounces keeps its velocity better with facets, for it presses with more particles: a
  !! disk of 12 cells across that comes with 0.003 c keeps 0.98 of it, 0.90 without; of 36 cells,
  !! 0.98 and 0.97. (Its spin is 5 % too small with 16 cells, 1 % without.)
  pure function rolls(scene, card, wall) result(yes)
    type(scene_t), intent(in) :: scene
    type(body_card_t), intent(in) :: card
    type(one_sided_wall_t), intent(in) :: wall
    logical :: yes
    real(dp) :: across(3)
    yes = .false.
    if (.not. (scene_pulls(scene) .and. wall%friction > 0.0_dp)) return
    if (scene%axisymmetric .or. card%layout == layout_file) return  ! rings do not roll
    if (.not. allocated(card%shapes)) return
    across = 0.0_dp
    across(wall%axis) = 1.0_dp
    yes = shapes_rim(card%shapes, turn_direction(turn_inverse(card%turn), across), beside)
  end function rolls

  !> Lets the faces of particles begin at the round surface of their body, where that is near.
  pure subroutine one_sided_rim(card, mesh, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    real(dp) :: x(3), face
    integer :: c, l, w
    do w = 1, size(body%walls)
      associate (wall => body%walls(w), particles => body%particles, n => mesh%ndim)
        if (wall%rim == 0) cycle
        do c = 1, particles%chunks
          do l = 1, lanes
            if (particles%id(l, c) == 0) cycle
            x = 0.0_dp
            x(:n) = mesh_places(mesh, particles%motion(l, :n, c))
            call turn_back(card%turn, x)
            face = rim_depth(card%shapes(1), x)
            if (face > min(rim_spacings*wall%spacing, rim_cells*mesh%h)) cycle
            particles%state(l, [wall%rim, wall%half], c) = face - 0.5_dp*wall%spacing
          end do
        end do
      end associate
    end do
  end subroutine one_sided_rim

  !> Lets the faces of particles begin at the walls that their body begins at, and those of others
  !! not behind one: rows of particles need not be half a spacing away from it.
  pure subroutine one_sided_seat(grid, card, mesh, body)
    type(grid_card_t), intent(in) :: grid
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    real(dp) :: more, most
    integer :: c, l, w
    most = merge(1.0_dp, 0.75_dp, card%jitter <= 0.0_dp .and. card%layout == layout_lattice)
    do w = 1, size(body%walls)
      associate (wall => body%walls(w), particles => body%particles)
        do c = 1, particles%chunks
          do l = 1, lanes
            if (particles%id(l, c) == 0) cycle
            more = one_sided_gap(mesh, wall, particles%motion(l, wall%axis, c))
            if (wall%rim > 0) then
              more = min(more, particles%state(l, wall%half, c))
            else
              if (more > (most - 0.5_dp)*(1.0_dp - near_one)*wall%spacing) cycle
              if (.not. grid%floor(wall%side, wall%axis)) more = min(more, 0.0_dp)
            end if
            particles%state(l, wall%half, c) = more
          end do
        end do
      end associate
    end do
  end subroutine one_sided_seat

  !> Lets the springs of a wall bear the stress with which a particle begins at it.
  pure subroutine one_sided_bear(mesh, wall, stress, place, state)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: stress(:)            !! components, at the face
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    real(dp), intent(inout) :: state(:)          !! columns of the particle
    real(dp) :: across(3)
    integer :: c, a, b
    across = 0.0_dp
    do c = 1, size(stress)
      a = voigt_axes(1, c)
      b = voigt_axes(2, c)
      if (a == wall%axis) across(b) = stress(c)
      if (b == wall%axis) across(a) = stress(c)
    end do
    across(mesh%ndim + 1:) = 0.0_dp
    call one_sided_load(mesh, wall, across, place, state)
  end subroutine one_sided_bear

end module sgmp_one_sided_build
