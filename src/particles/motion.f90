!> Columns of the particles' first stream, `motion`: position, velocity, mass; the velocity and the
!! mass by dimension.
module sgmp_motion
  implicit none
  private
  public :: motion_position, motion_velocity, motion_mass, motion_total

  integer, parameter :: motion_position = 1            !! first of the position, in cells
  integer, parameter :: motion_velocity(3) = [2, 3, 4]  !! first of the velocity
  integer, parameter :: motion_mass(3) = [3, 5, 7]
  integer, parameter :: motion_total(3) = motion_mass  !! columns

end module sgmp_motion
