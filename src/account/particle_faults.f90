!> What is wrong with a particle with which a run must not go on.
module sgmp_particle_faults
  implicit none
  private
  public :: fault_inside_out, fault_names, fault_none, fault_silent, fault_squeezed, &
            fault_through_wall

  integer, parameter :: fault_none = 0
  integer, parameter :: fault_inside_out = 1, fault_silent = 2, fault_squeezed = 3, &
                        fault_through_wall = 4
  character(64), parameter :: fault_names(*) = [character(64) :: &
    'is inside out or not a number', 'has an imaginary sound speed', &
    'is shorter than a fifth along a direction, with frame=reference', &
    'has come through a wall that it did not touch (frame=reference)']

end module sgmp_particle_faults
