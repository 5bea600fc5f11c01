!> The background grid: spacing, origin, walls, and the map between physical and grid coordinates.
!!
!! Particles live in grid coordinates X = (x - origin)/h, so that cell indices and weights need no
!! scaling. Node i of an axis sits at X = i, cell centre (auxiliary node) i at X = i + 1/2. A closed
!! box spans nodes 0..cells. Where cells are unequal, X counts their centres (sgmp_graded_axis), and
!! h is the smallest side.
module sgmp_mesh
  use sgmp_axis, only: axis_cell
  use sgmp_graded_axis, only: graded_axis_t, graded_coordinate, graded_place, graded_spacing
  use sgmp_kinds, only: dp
  use sgmp_space, only: space_axisymmetric, space_dimensions
  implicit none
  private
  public :: mesh_t, mesh_make, mesh_position, mesh_coordinate, mesh_filled, &
            mesh_occupied, mesh_place, mesh_places, mesh_find, &
            mesh_sides
  public :: wall_absorbing, wall_axis, wall_free, wall_slip, wall_fixed, wall_names
  public :: wall_kick, wall_speed

  integer, parameter :: wall_free = 0  !! material may leave or the face is open
  integer, parameter :: wall_slip = 1  !! normal velocity vanishes (symmetry)
  integer, parameter :: wall_fixed = 2  !! all velocity components vanish
  integer, parameter :: wall_absorbing = 3  !! of decks alone: the grid has an open face there, and
                                       !! faces of particles bear the edge (doc/loads.md)
  integer, parameter :: wall_axis = 4  !! a slip wall behind which radii are negative
  character(9), parameter :: wall_names(wall_free:wall_absorbing) = [character(9) :: &
    'free', 'slip', 'fixed', 'absorbing']

  integer, parameter :: wall_kick = 1    !! acceleration of a wall in a step
  integer, parameter :: wall_speed = 2   !! its velocity after it

  !> Grid geometry; axes beyond the dimension are unused.
  type :: mesh_t
    integer :: ndim = 3                  !! 1, 2 or 3 axes
    integer :: space = 3                 !! one of those of sgmp_space
    real(dp) :: h = 1.0_dp               !! cell side (length)
    real(dp) :: inverse_h = 1.0_dp
    real(dp) :: origin(3) = 0.0_dp       !! position of node 0
    logical :: open(2, 3) = .true.       !! (lower|upper, axis): the grid follows the particles
    integer :: wall(2, 3) = wall_free    !! (lower|upper, axis)
    logical :: absorbs(2, 3) = .false.   !! edges that let waves out: open faces
    integer :: edge(2, 3) = 0            !! nodes where these lie
    logical :: one_sided(2, 3) = .false.  !! walls that let go: open faces, springs on particles
    real(dp) :: rough(2, 3) = 0.0_dp     !! their friction: 0 smooth, huge: nothing slides
    logical :: walls_move = .false.      !! some fixed wall moves along itself
    logical :: walls_weigh = .false.     !! reactions of walls are asked for
    logical :: walls_act = .false.       !! or does more than to hold what comes
    real(dp) :: wall_motion(3, 2, 3, 2) = 0.0_dp
      !! (component, lower|upper, axis, wall_kick|wall_speed), 0 where a wall is at rest; images
      !! behind walls know of it where a component is odd, which it is at fixed walls
    integer :: cells(3) = 0              !! cells between the faces, where both are given
    integer :: lower(3) = -huge(1)/4     !! first node a particle's cell may have
    integer :: upper(3) = huge(1)/4      !! last node
    real(dp) :: hoop = 0.0_dp            !! correction of the hoop strain (sgmp_axis)
    logical :: graded = .false.          !! cells are unequal along some axis
    type(graded_axis_t) :: axes(3)       !! which, and how
  end type mesh_t

contains

  !> A mesh from plain arguments; faces that are not open must be a whole number of cells apart. An
  !! axisymmetric one begins at the axis.
  pure function mesh_make(space, h, lower, upper, open, wall, axes, one_sided, &
                          rough) result(mesh)
    integer, intent(in) :: space          !! number of dimensions, or space_axisymmetric
    real(dp), intent(in) :: h             !! cell side (length)
    real(dp), intent(in) :: lower(3), upper(3)  !! corners of the box (length)
    logical, intent(in) :: open(2, 3)     !! face not given
    integer, intent(in) :: wall(2, 3)     !! kind of wall per face
    type(graded_axis_t), intent(in), optional :: axes(3)  !! whose cells are unequal
    logical, intent(in), optional :: one_sided(2, 3)  !! open faces with walls that let go
    real(dp), intent(in), optional :: rough(2, 3)     !! their friction
    type(mesh_t) :: mesh
    integer :: axis
    mesh%ndim = space_dimensions(space)
    mesh%space = space
    mesh%h = h
    mesh%inverse_h = 1.0_dp/h
    mesh%open = open
    mesh%wall = wall
    if (space == space_axisymmetric) then
      mesh%open(1, 1) = .false.
      mesh%wall(1, 1) = wall_axis
    end if
    if (present(axes)) mesh%axes = axes
    if (present(one_sided)) mesh%one_sided = one_sided
    if (present(rough)) mesh%rough = rough
    mesh%open = mesh%open .and. .not. mesh%one_sided
    mesh%graded = any(mesh%axes(:mesh%ndim)%graded)
    do axis = 1, mesh%ndim
      call place_nodes(mesh, axis, lower(axis), upper(axis))
    end do
    call open_edges(mesh)
  end function mesh_make

  !> Origin and outermost nodes of an axis.
  pure subroutine place_nodes(mesh, axis, lower, upper)
    type(mesh_t), intent(inout) :: mesh
    integer, intent(in) :: axis
    real(dp), intent(in) :: lower, upper  !! ends of the box (length)
    if (mesh%axes(axis)%graded) then
      mesh%origin(axis) = mesh%axes(axis)%origin
      if (.not. mesh%open(1, axis)) mesh%lower(axis) = mesh%axes(axis)%first
      if (.not. mesh%open(2, axis)) mesh%upper(axis) = mesh%axes(axis)%last
      if (.not. any(mesh%open(:, axis))) then
        mesh%cells(axis) = mesh%upper(axis) - mesh%lower(axis)
      end if
    else if (.not. mesh%open(1, axis)) then
      if (mesh%wall(1, axis) /= wall_axis) mesh%origin(axis) = lower
      mesh%lower(axis) = 0
      if (.not. mesh%open(2, axis)) then
        mesh%cells(axis) = nint((upper - mesh%origin(axis))/mesh%h)
        mesh%upper(axis) = mesh%cells(axis)
      end if
    else if (.not. mesh%open(2, axis)) then
      mesh%origin(axis) = upper
      mesh%upper(axis) = 0
    end if
  end subroutine place_nodes

  !> Opens the faces of edges that let waves out and of walls that let go: the grid follows the
  !! particles there, a line of nodes lies where the face is.
  pure subroutine open_edges(mesh)
    type(mesh_t), intent(inout) :: mesh
    type(mesh_t) :: open
    mesh%absorbs = mesh%wall == wall_absorbing
    mesh%edge(1, :) = merge(mesh%lower, 0, mesh%absorbs(1, :))
    mesh%edge(2, :) = merge(mesh%upper, 0, mesh%absorbs(2, :))
    where (mesh%absorbs(1, :) .or. mesh%one_sided(1, :)) mesh%lower = open%lower
    where (mesh%absorbs(2, :) .or. mesh%one_sided(2, :)) mesh%upper = open%upper
    where (mesh%absorbs .or. mesh%one_sided)
      mesh%wall = wall_free
      mesh%open = .true.
    end where
  end subroutine open_edges

  !> Physical position of a grid coordinate along one axis.
  elemental function mesh_position(origin, h, coordinate) result(x)
    real(dp), intent(in) :: origin, h, coordinate
    real(dp) :: x
    x = origin + h*coordinate
  end function mesh_position

  !> Grid coordinate of a physical position along one axis.
  elemental function mesh_coordinate(origin, h, x) result(coordinate)
    real(dp), intent(in) :: origin, h, x
    real(dp) :: coordinate
    coordinate = (x - origin)/h
  end function mesh_coordinate

  !> Physical position of a grid coordinate along an axis of a mesh.
  elemental function mesh_place(mesh, axis, coordinate) result(x)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    real(dp), intent(in) :: coordinate
    real(dp) :: x
    if (mesh%axes(axis)%graded) then
      x = mesh_position(mesh%origin(axis), mesh%h, graded_place(mesh%axes(axis), coordinate))
    else
      x = mesh_position(mesh%origin(axis), mesh%h, coordinate)
    end if
  end function mesh_place

  !> The same along the first axes.
  pure function mesh_places(mesh, coordinates) result(x)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coordinates(:)
    real(dp) :: x(size(coordinates))
    integer :: axis
    do axis = 1, size(coordinates)
      x(axis) = mesh_place(mesh, axis, coordinates(axis))
    end do
  end function mesh_places

  !> Spacings of the centres between which a coordinate lies (smallest cell), along the first axes.
  pure function mesh_sides(mesh, coordinates) result(sides)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coordinates(:)
    real(dp) :: sides(size(coordinates))
    integer :: axis
    do axis = 1, size(coordinates)
      sides(axis) = graded_spacing(mesh%axes(axis), floor(coordinates(axis) - 0.5_dp) + 1)
    end do
  end function mesh_sides

  !> Grid coordinate of a physical position along an axis of a mesh.
  elemental function mesh_find(mesh, axis, x) result(coordinate)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    real(dp), intent(in) :: x
    real(dp) :: coordinate
    coordinate = mesh_coordinate(mesh%origin(axis), mesh%h, x)
    if (mesh%axes(axis)%graded) coordinate = graded_coordinate(mesh%axes(axis), coordinate)
  end function mesh_find

  !> How many cells a volume fills where it is; a ring, how many sections of cells.
  pure function mesh_filled(mesh, x, volume) result(cells)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: x(:)          !! its place (cells)
    real(dp), intent(in) :: volume
    real(dp) :: cells
    integer :: axis
    if (mesh%space == space_axisymmetric) then
      cells = volume/(graded_place(mesh%axes(1), x(1))*axis_cell(mesh%h))
    else
      cells = volume/mesh%h**mesh%ndim
    end if
    if (.not. mesh%graded) return
    do axis = 1, mesh%ndim
      ! Between two centres that of both, at a centre the mean of those beside it.
      cells = cells*2.0_dp/ &
              (graded_spacing(mesh%axes(axis), ceiling(x(axis) - 0.5_dp)) + &
               graded_spacing(mesh%axes(axis), floor(x(axis) - 0.5_dp) + 1))
    end do
  end function mesh_filled

  !> How many cells a particle occupies. A square section about a radius less than half of its side
  !! would reach behind the axis: the particle is a disc, as high as its radius is, which continues
  !! rings whose section touches the axis. Without it the section of a particle that comes close to
  !! the axis would grow without bounds.
  pure function mesh_occupied(mesh, x, volume) result(cells)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: x(:)          !! its place (cells)
    real(dp), intent(in) :: volume
    real(dp) :: cells
    cells = mesh_filled(mesh, x, volume)
    if (mesh%space == space_axisymmetric) then
      if (cells > (2.0_dp*x(1))**2) cells = (2.0_dp*x(1)*cells)**(2.0_dp/3.0_dp)
    end if
  end function mesh_occupied

end module sgmp_mesh
