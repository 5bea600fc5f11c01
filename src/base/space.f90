!> The spaces that a scene can be computed in: Cartesian ones of one, two (plane strain) and three
!! dimensions, whose number is that of their dimensions, and the half-plane of an axisymmetric one.
!!
!! Axisymmetric scenes have two axes, r and z; what particles give is that of the whole ring.
module sgmp_space
  implicit none
  private
  public :: axis_names, omega_names, axes_in_output, space_axisymmetric, space_dimensions, spaces

  integer, parameter :: spaces = 4
  integer, parameter :: space_axisymmetric = 4
  integer, parameter :: space_dimensions(spaces) = [1, 2, 3, 2]  !! axes of each
  !> The last axis of an axisymmetric scene is the one across its half-plane.
  character(1), parameter :: axis_names(3, spaces) = reshape( &
    ['x', 'y', 'z', 'x', 'y', 'z', 'x', 'y', 'z', 'r', 'z', 'y'], [3, spaces])
  !> Angular velocities about the axes.
  character(7), parameter :: omega_names(3) = ['omega_x', 'omega_y', 'omega_z']
  !> Axes of output that those of a space are: an axisymmetric scene is written as it is in the
  !! half-plane x > 0, y = 0.
  integer, parameter :: axes_in_output(3, spaces) = reshape( &
    [1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 3, 2], [3, spaces])

end module sgmp_space
