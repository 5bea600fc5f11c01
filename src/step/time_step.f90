!> Choice of the time step (Eq. 69): Courant number, growth limit, equal steps to the next output
!! time, lower bound.
!!
!! Steps that differ can excite what equal steps of either length would not (doc/time-step.md):
!! all steps to an output time are shortened alike, instead of the last one or two.
module sgmp_time_step
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: clock_t, clock_choose, clock_advance, clock_kick_step
  public :: limit_fixed, limit_courant, limit_growth, limit_landing, limit_names

  integer, parameter :: limit_fixed = 1, limit_courant = 2, limit_growth = 3, limit_landing = 4
  character(16), parameter :: limit_names(4) = [character(16) :: 'fixed', 'Courant', 'growth', &
                                                'output time']
  real(dp), parameter :: noticed = 0.9_dp  !! a step shortened to less than this part of itself is
                                           !! said to be limited by the output time

  !> Time and time step of a run.
  type :: clock_t
    integer :: step = 0
    real(dp) :: time = 0.0_dp
    real(dp) :: dt = 0.0_dp            !! dt^{k+1/2} of the step at hand
    real(dp) :: dt_before = 0.0_dp     !! dt^{k-1/2}; 0 at the start, which halves the first
                                       !! velocity step
    real(dp) :: dt_free = 0.0_dp       !! last step before it was shortened for an output time
    real(dp) :: longest = 0.0_dp, shortest = huge(1.0_dp)  !! of dt_free, in the run
    real(dp) :: cfl = 0.5_dp, fixed = 0.0_dp, growth = 1.05_dp
    real(dp) :: first = 1.0_dp         !! part of a Courant step that the first one takes
    real(dp) :: smallest = 0.0_dp      !! lower bound
    logical :: automatic = .false.     !! cfl follows from the scheme (sgmp_stability)
    integer :: next_probe = 0          !! step at which it is found anew
    real(dp) :: limit = 0.0_dp         !! largest stable one when it was found last
    integer :: limited_by = limit_fixed
  end type clock_t

contains

  !> Sets dt for the next step; `ok` is false if it falls below the lower bound.
  pure subroutine clock_choose(clock, h, fastest, target, ok)
    type(clock_t), intent(inout) :: clock
    real(dp), intent(in) :: h          !! cell side
    real(dp), intent(in) :: fastest    !! largest c + |v|
    real(dp), intent(in) :: target     !! next time that a step has to end at
    logical, intent(out) :: ok
    real(dp) :: dt
    if (clock%fixed > 0.0_dp) then
      dt = clock%fixed
      clock%limited_by = limit_fixed
    else
      dt = clock%cfl*h/fastest
      clock%limited_by = limit_courant
      if (clock%dt_free > 0.0_dp .and. dt > clock%growth*clock%dt_free) then
        dt = clock%growth*clock%dt_free
        clock%limited_by = limit_growth
      end if
    end if
    clock%dt_free = dt
    clock%longest = max(clock%longest, dt)
    clock%shortest = min(clock%shortest, dt)
    if (clock%step == 0 .and. clock%limited_by == limit_courant) dt = clock%first*dt
    clock%dt = even_step(dt, target - clock%time)
    if (clock%dt < noticed*dt) clock%limited_by = limit_landing
    if (clock%smallest <= 0.0_dp) clock%smallest = 1.0e-6_dp*clock%dt_free
    ok = clock%dt_free >= clock%smallest
  end subroutine clock_choose

  !> The longest step, at most dt, with which a whole number of steps covers what is left. A step
  !! that divides it but for round-off stays as it is until the last one.
  pure function even_step(dt, left) result(step)
    real(dp), intent(in) :: dt, left
    real(dp) :: step, steps
    real(dp), parameter :: round_off = 1.0e-9_dp, many = 1.0e6_dp
    step = dt
    if (left > many*dt) return
    steps = real(ceiling(left/dt*(1.0_dp - round_off)), dp)
    if (steps <= 1.0_dp .or. abs(left - steps*dt) > round_off*left) step = left/max(steps, 1.0_dp)
  end function even_step

  !> Velocity step dt^k, the mean of the position steps around it: of all weights that let
  !! velocity steps add up to the time it has the narrowest bands of parametric resonance
  !! (doc/time-step.md).
  pure function clock_kick_step(clock) result(dt)
    type(clock_t), intent(in) :: clock
    real(dp) :: dt
    dt = 0.5_dp*(clock%dt_before + clock%dt)
  end function clock_kick_step

  !> Moves on to the next step; one that reaches the target puts the time exactly on it.
  pure subroutine clock_advance(clock, target)
    type(clock_t), intent(inout) :: clock
    real(dp), intent(in) :: target
    clock%step = clock%step + 1
    if (abs(target - (clock%time + clock%dt)) < 1.0e-6_dp*clock%dt) then
      clock%time = target
    else
      clock%time = clock%time + clock%dt
    end if
    clock%dt_before = clock%dt
  end subroutine clock_advance

end module sgmp_time_step
