!> Afterburn: what products of an explosive that lacks oxygen give when they burn in air (theory 4).
!!
!! Of the energy Q per initial volume the part y is given y(t), and heats the products. Either in a
!! window of time after the front has lit the particle, at an even rate, or by Miller's rate (Miller
!! 1995, Proc. 10th APS Conf. Shock Compression, from memory of the literature; so in the manuals of
!! LS-DYNA, *EOS_JWL, and Radioss, /MAT/LAW5, where p is in units of the deck),
!!
!!     dy/dt = rate (1 - y)^m (p/p_ref)^n                                               (AB1)
!!
!! which is solved exactly for the pressure at the beginning of the step.
module sgmp_afterburn
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: afterburn_keys, afterburn_lanes, afterburn_miller, afterburn_read, afterburn_t, &
            afterburn_window

  !> Constants; no energy: no afterburn.
  type :: afterburn_t
    real(dp) :: energy = 0.0_dp                  !! Q per initial volume (stress)
    real(dp) :: start = 0.0_dp, end = 0.0_dp     !! of the window, after lighting (time)
    real(dp) :: rate = 0.0_dp                    !! of (AB1) (1/time); 0: the window
    real(dp) :: order = 0.5_dp, exponent = 0.0_dp  !! m, n
    real(dp) :: pressure = 1.0_dp                !! p_ref (stress)
  end type afterburn_t

contains

  !> Keys of the equation of products.
  function afterburn_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('afterburn', kind_real, 'energy per initial volume that the products give when '// &
                'they burn in air, beside energy0; 0: none', unit='stress', range='[0,inf)'), &
            key('afterburn_start', kind_real, 'time after the front at which that begins', &
                unit='time', range='[0,inf)'), &
            key('afterburn_end', kind_real, 'and ends; in between the rate is even', &
                unit='time', range='(0,inf)'), &
            key('afterburn_rate', kind_real, 'in place of start and end, rate of dy/dt = rate '// &
                '(1 - y)^order (p/afterburn_pressure)^exponent, y: part that is given (Miller)', &
                unit='1/time', range='(0,inf)'), &
            key('afterburn_pressure', kind_real, 'pressure of reference of it', unit='stress', &
                range='(0,inf)'), &
            key('afterburn_order', kind_real, 'order of it; default: 1/2', range='[0,inf)'), &
            key('afterburn_exponent', kind_real, 'exponent of it; default: 1/6', range='[0,inf)')]
  end function afterburn_keys

  !> Constants from the values of those keys.
  pure subroutine afterburn_read(values, law, history, fault)
    class(values_t), intent(in) :: values
    type(afterburn_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(inout) :: fault
    if (values%has('afterburn')) law%energy = values%number('afterburn')
    if (.not. allocated(fault)) call check_keys(values, fault)
    if (law%energy <= 0.0_dp) return
    law%start = values%number('afterburn_start')
    law%end = values%number('afterburn_end')
    law%rate = values%number('afterburn_rate')
    law%pressure = values%number('afterburn_pressure', 1.0_dp)
    law%order = values%number('afterburn_order', 0.5_dp)
    law%exponent = values%number('afterburn_exponent', 1.0_dp/6.0_dp)
    history%afterburnt = .true.
  end subroutine afterburn_read

  !> Whether the keys go together.
  pure subroutine check_keys(values, fault)
    class(values_t), intent(in) :: values
    type(fault_t), allocatable, intent(inout) :: fault
    character(*), parameter :: of_window(*) = [character(18) :: 'afterburn_start', 'afterburn_end']
    character(*), parameter :: of_rate(*) = [character(18) :: 'afterburn_rate', &
      'afterburn_pressure', 'afterburn_order', 'afterburn_exponent']
    logical :: window(size(of_window)), rate(size(of_rate))
    integer :: k
    window = [(values%has(trim(of_window(k))), k=1, size(of_window))]
    rate = [(values%has(trim(of_rate(k))), k=1, size(of_rate))]
    if (.not. values%has('afterburn')) then
      if (any(window) .or. any(rate)) then
        call fault_make(fault, '', 'there is no energy of afterburn', 'add afterburn=…')
      end if
    else if (any(window) .and. any(rate)) then
      call fault_make(fault, 'afterburn', 'afterburn has a window of time and a rate', &
                      'give afterburn_start and afterburn_end, or afterburn_rate and '// &
                      'afterburn_pressure')
    else if (any(rate) .and. .not. all(rate(:2))) then
      call fault_make(fault, 'afterburn', "Miller's rate needs afterburn_rate and "// &
                      'afterburn_pressure', 'give both')
    else if (.not. any(rate) .and. values%number('afterburn') > 0.0_dp .and. &
             values%number('afterburn_end') <= values%number('afterburn_start')) then
      call fault_make(fault, 'afterburn', 'nothing says when the afterburn takes place', &
                      'give afterburn_end above afterburn_start, or afterburn_rate and '// &
                      'afterburn_pressure')
    end if
  end subroutine check_keys

  !> Part that is given in a window of time.
  pure real(dp) function afterburn_window(law, elapsed) result(part)
    type(afterburn_t), intent(in) :: law
    real(dp), intent(in) :: elapsed       !! since lighting (time)
    part = min(max((elapsed - law%start)/(law%end - law%start), 0.0_dp), 1.0_dp)
  end function afterburn_window

  !> Part that is given after a step at one pressure, by (AB1).
  pure real(dp) function afterburn_miller(law, part, pressure, dt) result(after)
    type(afterburn_t), intent(in) :: law
    real(dp), intent(in) :: part          !! before it
    real(dp), intent(in) :: pressure, dt
    real(dp) :: left, turned
    left = 1.0_dp - part
    after = part
    if (left <= 0.0_dp .or. pressure <= 0.0_dp) return
    turned = law%rate*dt*(pressure/law%pressure)**law%exponent
    if (abs(law%order - 1.0_dp) <= epsilon(1.0_dp)) then
      left = left*exp(-turned)
    else
      left = max(left**(1.0_dp - law%order) - (1.0_dp - law%order)*turned, 0.0_dp) &
             **(1.0_dp/(1.0_dp - law%order))
    end if
    after = 1.0_dp - left
  end function afterburn_miller

  !> Lane kernel: the part that is given after a step, and what is given in it.
  pure subroutine afterburn_lanes(law, time, dt, lighting_time, mean, part, energy)
    type(afterburn_t), intent(in) :: law
    real(dp), intent(in) :: time, dt             !! at the end of the step; of the step
    real(dp), intent(in) :: lighting_time(lanes)
    real(dp), intent(in) :: mean(lanes)          !! mean stress before the step
    real(dp), intent(inout) :: part(lanes)
    real(dp), intent(out) :: energy(lanes)       !! per initial volume (stress)
    real(dp) :: before
    integer :: p
    do p = 1, lanes
      before = part(p)
      if (time <= lighting_time(p)) then
        part(p) = before
      else if (law%rate > 0.0_dp) then
        part(p) = afterburn_miller(law, before, -mean(p), dt)
      else
        part(p) = max(before, afterburn_window(law, time - lighting_time(p)))
      end if
      energy(p) = law%energy*(part(p) - before)
    end do
  end subroutine afterburn_lanes

end module sgmp_afterburn
