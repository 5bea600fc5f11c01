!> Choice of the time step (Eq. 69): Courant number, growth limit, exact landing on output times,
!! lower bound.
module sgmp_time_step
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: clock_t, clock_choose, clock_advance, clock_kick_step
  public :: limit_fixed, limit_courant, limit_growth, limit_landing, limit_names

  integer, parameter :: limit_fixed = 1, limit_courant = 2, limit_growth = 3, limit_landing = 4
  character(16), parameter :: limit_names(4) = [character(16) :: 'fixed', 'Courant', 'growth', &
                                                'output time']

  !> Time and time step of a run.
  type :: clock_t
    integer :: step = 0
    real(dp) :: time = 0.0_dp
    real(dp) :: dt = 0.0_dp            !! dt^{k+1/2} of the step at hand
    real(dp) :: dt_before = 0.0_dp     !! dt^{k-1/2}; 0 at the start, which halves the first
                                       !! velocity step
    real(dp) :: dt_free = 0.0_dp       !! last step before it was cut to land on an output time
    real(dp) :: cfl = 0.5_dp, fixed = 0.0_dp, growth = 1.05_dp
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
    real(dp), intent(in) :: target     !! next time to land on
    logical, intent(out) :: ok
    real(dp) :: dt, left
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
    left = target - clock%time
    if (dt >= left*(1.0_dp - 1.0e-9_dp)) then
      dt = left
      clock%limited_by = limit_landing
    else if (clock%fixed <= 0.0_dp .and. 2.0_dp*dt > left) then
      dt = 0.5_dp*left
      clock%limited_by = limit_landing
    end if
    if (clock%smallest <= 0.0_dp) clock%smallest = 1.0e-6_dp*clock%dt_free
    clock%dt = dt
    ok = clock%dt_free >= clock%smallest
  end subroutine clock_choose

  !> Velocity step dt^k, the mean of the position steps around it.
  pure function clock_kick_step(clock) result(dt)
    type(clock_t), intent(in) :: clock
    real(dp) :: dt
    dt = 0.5_dp*(clock%dt_before + clock%dt)
  end function clock_kick_step

  !> Moves on to the next step; `landed` puts the time exactly on the target.
  pure subroutine clock_advance(clock, target)
    type(clock_t), intent(inout) :: clock
    real(dp), intent(in) :: target
    clock%step = clock%step + 1
    if (clock%limited_by == limit_landing .and. &
        abs(target - (clock%time + clock%dt)) < 1.0e-6_dp*clock%dt) then
      clock%time = target
    else
      clock%time = clock%time + clock%dt
    end if
    clock%dt_before = clock%dt
  end subroutine clock_advance

end module sgmp_time_step
