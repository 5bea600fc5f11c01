!> What happens to particles that leave the grid.
module sgmp_lost_policy
  implicit none
  private
  public :: lost_error, lost_names, lost_reflect, lost_remove

  integer, parameter :: lost_error = 1, lost_remove = 2, lost_reflect = 3
  character(7), parameter :: lost_names(*) = [character(7) :: 'error', 'remove', 'reflect']

end module sgmp_lost_policy
