!> The background grid: spacing, origin, walls, and the map between physical and grid coordinates.
!!
!! Particles live in grid coordinates X = (x - origin)/h, so that cell indices and weights need no
!! scaling. Node i of an axis sits at X = i, cell centre (auxiliary node) i at X = i + 1/2. A closed
!! box spans nodes 0..cells.
module sgmp_mesh
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: mesh_t, mesh_make, mesh_position, mesh_coordinate
  public :: axis_names
  public :: wall_free, wall_slip, wall_fixed, wall_names

  character(1), parameter :: axis_names(3) = ['x', 'y', 'z']

  integer, parameter :: wall_free = 0  !! material may leave or the face is open
  integer, parameter :: wall_slip = 1  !! normal velocity vanishes (symmetry)
  integer, parameter :: wall_fixed = 2  !! all velocity components vanish
  character(8), parameter :: wall_names(wall_free:wall_fixed) = [character(8) :: &
    'free', 'slip', 'fixed']

  !> Grid geometry; axes beyond the dimension are unused.
  type :: mesh_t
    integer :: ndim = 3                  !! 1, 2 (plane strain) or 3
    real(dp) :: h = 1.0_dp               !! cell side (length)
    real(dp) :: inverse_h = 1.0_dp
    real(dp) :: origin(3) = 0.0_dp       !! position of node 0
    logical :: open(2, 3) = .true.       !! (lower|upper, axis): the grid follows the particles
    integer :: wall(2, 3) = wall_free    !! (lower|upper, axis)
    integer :: cells(3) = 0              !! cells between the faces, where both are given
    integer :: lower(3) = -huge(1)/4     !! first node a particle's cell may have
    integer :: upper(3) = huge(1)/4      !! last node
  end type mesh_t

contains

  !> A mesh from plain arguments; faces that are not open must be a whole number of cells apart.
  pure function mesh_make(ndim, h, lower, upper, open, wall) result(mesh)
    integer, intent(in) :: ndim           !! dimension
    real(dp), intent(in) :: h             !! cell side (length)
    real(dp), intent(in) :: lower(3), upper(3)  !! corners of the box (length)
    logical, intent(in) :: open(2, 3)     !! face not given
    integer, intent(in) :: wall(2, 3)     !! kind of wall per face
    type(mesh_t) :: mesh
    integer :: axis
    mesh%ndim = ndim
    mesh%h = h
    mesh%inverse_h = 1.0_dp/h
    mesh%open = open
    mesh%wall = wall
    do axis = 1, ndim
      if (.not. open(1, axis)) then
        mesh%origin(axis) = lower(axis)
        mesh%lower(axis) = 0
        if (.not. open(2, axis)) then
          mesh%cells(axis) = nint((upper(axis) - lower(axis))/h)
          mesh%upper(axis) = mesh%cells(axis)
        end if
      else if (.not. open(2, axis)) then
        mesh%origin(axis) = upper(axis)
        mesh%upper(axis) = 0
      end if
    end do
  end function mesh_make

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

end module sgmp_mesh
