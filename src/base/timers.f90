!> Wall-clock timers of the phases of a run. Whatever happens belongs to the phase that is stopped
!! next, so that the phases together are the whole run.
module sgmp_timers
  use sgmp_kinds, only: dp, i8
  implicit none
  private
  public :: timers_t, timers_stop, timers_move, wall_time, phase_names
  public :: phase_kick, phase_drift, phase_grid, phase_rebin, phase_output, phase_probe, &
            phase_halo, phase_balance, phase_contact, phase_start, phase_end, phase_count

  integer, parameter :: phase_kick = 1   !! momentum sweep over the particles
  integer, parameter :: phase_drift = 2  !! stress sweep over the particles
  integer, parameter :: phase_grid = 3   !! nodes, walls, sums of the step
  integer, parameter :: phase_rebin = 4  !! particles that change bins, new grid rows
  integer, parameter :: phase_output = 5
  integer, parameter :: phase_probe = 6  !! search for the largest stable step (cfl=auto)
  integer, parameter :: phase_halo = 7   !! messages between ranks, and waiting for them
  integer, parameter :: phase_balance = 8  !! new cuts between ranks
  integer, parameter :: phase_contact = 9  !! at nodes that bodies share
  integer, parameter :: phase_start = 10  !! from the start of the program to the first step
  integer, parameter :: phase_end = 11  !! verdict and checksum
  integer, parameter :: phase_count = 11
  character(16), parameter :: phase_names(phase_count) = &
      [character(16) :: 'momentum sweep', 'stress sweep', 'grid', 're-binning', 'output', &
       'step limit', 'halo', 'balancing', 'contact', 'start', 'end']

  !> Seconds spent in each phase.
  type :: timers_t
    real(dp) :: seconds(phase_count) = 0.0_dp
    real(dp) :: started = 0.0_dp                 !! when the phase that is running began
  end type timers_t

contains

  !> Seconds since some fixed moment.
  function wall_time() result(seconds)
    real(dp) :: seconds
    integer(i8) :: count, rate
    call system_clock(count, rate)
    seconds = real(count, dp)/real(rate, dp)
  end function wall_time

  !> Books the time since the stop before on a phase.
  subroutine timers_stop(timers, phase)
    type(timers_t), intent(inout) :: timers
    integer, intent(in) :: phase
    real(dp) :: now
    now = wall_time()
    timers%seconds(phase) = timers%seconds(phase) + now - timers%started
    timers%started = now
  end subroutine timers_stop

  !> Books the time since `since` on a phase and takes it out of the one that is being timed.
  subroutine timers_move(timers, phase, since)
    type(timers_t), intent(inout) :: timers
    integer, intent(in) :: phase
    real(dp), intent(in) :: since
    real(dp) :: spent
    spent = wall_time() - since
    timers%seconds(phase) = timers%seconds(phase) + spent
    timers%started = timers%started + spent
  end subroutine timers_move

end module sgmp_timers
