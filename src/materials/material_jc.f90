!> Johnson-Cook plasticity and failure (Johnson and Cook 1983, 1985; theory 4):
!!
!!     sigma_y = (A + B ep^n) (1 + C ln(rate*)) (1 - T*^m)                             (J1)
!!     T*      = (T - room)/(melt - room) clamped to [0, 1]
!!     rate*   = max(1, dep/(dt reference_rate))
!!     dT      = taylor_quinney sigma_eq dep/(density specific_heat)                   (J2)
!!     dD      = dep/ep_f,  ep_f = (D1 + D2 exp(D3 s*)) (1 + D4 ln(rate*)) (1 + D5 T*) (J3)
!!
!! with s* = mean stress/equivalent stress, tension positive (D3 of a metal is negative). The return
!! is implicit in the plastic strain and its rate; the temperature is that of the beginning of the
!! step.
!!
!! Damage may take strength before matter fails (Borvik, Hopperstad, Berstad and Langseth, Eur. J.
!! Mech. A/Solids 20 (2001), 685-712, who count damage up to Dc where D is 1 here):
!!
!!     sigma_y = (1 - Dc D) (A + B r^n) ...,  dr = (1 - Dc D) dep                      (J4)
!!
!! with the damage of the beginning of the step, and r = ep (1 - Dc D/2), which is the integral
!! while D grows in proportion to ep.
module sgmp_material_jc
  use sgmp_heating, only: heating_keys, plastic_heat_lanes
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_logical, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  use sgmp_radial_return, only: hardening_keys, hardening_power_term, hardening_t, &
                                radial_return_linear, radial_return_power, radial_return_rate
  implicit none
  private
  public :: jc_t, jc_init, jc_set_thermal, jc_set_failure
  public :: jc_keys, jc_read
  public :: jc_yield_stress, jc_homologous_temperature, jc_softening, jc_rate_factor
  public :: jc_failure_strain
  public :: jc_return, jc_return_simple

  integer, parameter :: flow_linear = 1, flow_power = 2, flow_rate = 3
  integer, parameter :: damage_constants = 5
  character(2), parameter :: damage_names(damage_constants) = ['d1', 'd2', 'd3', 'd4', 'd5']

  real(dp), parameter :: tiny_number = 1.0e-30_dp
  real(dp), parameter :: least_failure_strain = 1.0e-6_dp  !! floor of ep_f (D1 may be negative)
  real(dp), parameter :: largest_triaxiality = 1.5_dp      !! (J3) was fitted up to here
  real(dp), parameter :: largest_power = 200.0_dp          !! bound of D3 s*

  !> Constants of the law; made by jc_init, then jc_set_thermal and jc_set_failure where wanted.
  type :: jc_t
    integer :: flow = flow_linear             !! which return solves (J1); private to this module
    real(dp) :: yield = 0.0_dp                !! A (stress)
    real(dp) :: modulus = 0.0_dp              !! B (stress)
    real(dp) :: exponent = 1.0_dp             !! n
    real(dp) :: rate_coefficient = 0.0_dp     !! C
    real(dp) :: reference_rate = 1.0_dp       !! (1/time)
    logical :: thermal = .false.              !! temperature softens and plastic work heats
    real(dp) :: thermal_exponent = 1.0_dp     !! m
    real(dp) :: room = 1.0e30_dp              !! (temperature); by default T* is always 0
    real(dp) :: melt = 2.0e30_dp              !! (temperature)
    real(dp) :: heat_capacity = 1.0_dp        !! density times specific heat
    real(dp) :: taylor_quinney = 0.0_dp       !! fraction of the plastic work that heats
    logical :: failure = .false.              !! damage accumulates
    real(dp) :: damage(damage_constants) = 0.0_dp  !! D1..D5
    real(dp) :: critical_damage = 0.0_dp      !! Dc, part of the strength that damage takes
  end type jc_t

contains

  !> Keys of the law, besides the moduli.
  function jc_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [hardening_keys(), &
            key('rate_coefficient', kind_real, 'Johnson-Cook C: yield stress (yield + '// &
                'hardening_modulus e^hardening_exponent) (1 + rate_coefficient ln r) '// &
                '(1 - T*^thermal_exponent), e: plastic strain; johnson_holmquist: C of '// &
                'intact_strength and fractured_strength', range='[0,inf)', default='0'), &
            key('reference_rate', kind_real, 'strain rate at which the rate factor is 1; r: '// &
                'rate of plastic strain (johnson_holmquist: of the deviator of strain) over '// &
                'it; johnson_cook and johnson_holmquist take r as at least 1', &
                unit='1/time', range='(0,inf)', default='1'), &
            key('thermal', kind_logical, 'carry the temperature and soften the yield stress', &
                default='no'), &
            key('thermal_exponent', kind_real, 'Johnson-Cook m; T* of johnson_cook: '// &
                '(temperature - room) over (melting - room), 0 to 1', &
                range='(0,inf)', default='1'), &
            heating_keys(), &
            key('failure', kind_logical, 'Johnson-Cook damage and failure: at a plastic strain '// &
                'of (d1 + d2 exp(d3 s)) (1 + d4 ln r) (1 + d5 T*); no where it is not given'), &
            key('d1', kind_real, 'Johnson-Cook D1', default='0'), &
            key('d2', kind_real, 'Johnson-Cook D2', default='0'), &
            key('d3', kind_real, 'Johnson-Cook D3; s: mean stress over von Mises stress, '// &
                'tension positive, so d3 of a metal is negative', default='0'), &
            key('d4', kind_real, 'Johnson-Cook D4', default='0'), &
            key('d5', kind_real, 'Johnson-Cook D5', default='0'), &
            key('critical_damage', kind_real, 'part of the strength that damage has taken when '// &
                'it fails, with failure=yes (Borvik and others 2001; theirs is 0.3 for steel); '// &
                'without it strength is all there until it fails', range='[0,1)', default='0')]
  end function jc_keys

  !> Law from the values of its keys.
  pure subroutine jc_read(density, values, law, history, fault)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(jc_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    integer :: i
    law = jc_init(values%number('yield'), values%number('hardening_modulus'), &
                  values%number('hardening_exponent'), values%number('rate_coefficient'), &
                  values%number('reference_rate'))
    if (values%flag('thermal')) then
      call jc_set_thermal(law, values%number('thermal_exponent'), &
                          values%number('room_temperature'), values%number('melt_temperature'), &
                          density*values%number('specific_heat'), values%number('taylor_quinney'))
    end if
    if (values%flag('failure')) then
      call jc_set_failure(law, [(values%number(damage_names(i)), i=1, damage_constants)])
      law%critical_damage = values%number('critical_damage')
    end if
    history%plastic = .true.
    history%temperature = law%thermal
    history%damage = law%failure
    history%first_temperature = values%number('room_temperature')
    if (law%thermal .and. .not. (values%has('melt_temperature') .and. &
                                 values%has('specific_heat'))) then
      call fault_make(fault, '', 'thermal=yes needs melt_temperature and specific_heat', 'add both')
    else if (values%has('melt_temperature') .and. &
             values%number('melt_temperature') <= values%number('room_temperature')) then
      call fault_make(fault, 'melt_temperature', &
                      'the melting temperature is not above room temperature', 'check both')
    else if (values%number('critical_damage') > 0.0_dp .and. .not. values%has('failure')) then
      call fault_make(fault, 'critical_damage', 'without failure=yes no damage grows that '// &
                      'could take strength', &
                      'add failure=yes with d1 to d5, or remove critical_damage')
    else if (law%failure .and. law%damage(2) > 0.0_dp .and. law%damage(3) > 0.0_dp) then
      call fault_make(fault, 'd3', 'with d3 above 0 tension makes the material more ductile', &
                      'stress is positive in tension here; where pressure is, d3 has the '// &
                      'other sign')
      fault%warning = .true.
    end if
  end subroutine jc_read

  !> Law without temperature and failure, from plain numbers.
  pure function jc_init(yield, modulus, exponent, rate_coefficient, reference_rate) result(law)
    real(dp), intent(in) :: yield            !! A (stress)
    real(dp), intent(in) :: modulus          !! B >= 0 (stress)
    real(dp), intent(in) :: exponent         !! n > 0 unless B = 0
    real(dp), intent(in) :: rate_coefficient  !! C >= 0
    real(dp), intent(in) :: reference_rate   !! > 0 unless C = 0 (1/time)
    type(jc_t) :: law
    law%yield = yield
    law%modulus = modulus
    if (modulus > 0.0_dp) law%exponent = exponent
    law%rate_coefficient = rate_coefficient
    if (reference_rate > 0.0_dp) law%reference_rate = reference_rate
    if (rate_coefficient > 0.0_dp) then
      law%flow = flow_rate
    else if (abs(law%exponent - 1.0_dp) > 0.0_dp) then
      law%flow = flow_power
    else
      law%flow = flow_linear
    end if
  end function jc_init

  !> Adds thermal softening and adiabatic heating.
  pure subroutine jc_set_thermal(law, exponent, room, melt, heat_capacity, taylor_quinney)
    type(jc_t), intent(inout) :: law         !! law to extend
    real(dp), intent(in) :: exponent         !! m > 0
    real(dp), intent(in) :: room             !! temperature below which nothing softens
    real(dp), intent(in) :: melt             !! where the yield stress vanishes, > room
    real(dp), intent(in) :: heat_capacity    !! density times specific heat, > 0
    real(dp), intent(in) :: taylor_quinney   !! fraction of the plastic work that heats
    law%thermal = .true.
    law%thermal_exponent = exponent
    law%room = room
    law%melt = melt
    law%heat_capacity = heat_capacity
    law%taylor_quinney = taylor_quinney
  end subroutine jc_set_thermal

  !> Adds failure.
  pure subroutine jc_set_failure(law, damage)
    type(jc_t), intent(inout) :: law      !! law to extend
    real(dp), intent(in) :: damage(damage_constants)     !! D1..D5
    law%failure = .true.
    law%damage = damage
  end subroutine jc_set_failure

  !> Yield stress (J1) (stress).
  pure function jc_yield_stress(law, ep, rate, temperature) result(stress)
    type(jc_t), intent(in) :: law          !! constants
    real(dp), intent(in) :: ep             !! equivalent plastic strain
    real(dp), intent(in) :: rate           !! its rate (1/time)
    real(dp), intent(in) :: temperature    !! ignored unless the law is thermal
    real(dp) :: stress
    stress = (law%yield + law%modulus*hardening_power_term(ep, law%exponent)) &
             *jc_rate_factor(law%rate_coefficient, rate/law%reference_rate)
    if (law%thermal) stress = stress*jc_softening(law, temperature)
  end function jc_yield_stress

  !> T* of (J1), in [0, 1].
  pure function jc_homologous_temperature(law, temperature) result(t_star)
    type(jc_t), intent(in) :: law       !! constants
    real(dp), intent(in) :: temperature  !! current temperature
    real(dp) :: t_star
    t_star = (temperature - law%room)/(law%melt - law%room)
    t_star = merge(t_star, 0.0_dp, t_star > 0.0_dp)
    t_star = merge(t_star, 1.0_dp, t_star < 1.0_dp)
  end function jc_homologous_temperature

  !> Thermal factor 1 - T*^m of (J1), in [0, 1].
  pure function jc_softening(law, temperature) result(factor)
    type(jc_t), intent(in) :: law       !! constants
    real(dp), intent(in) :: temperature  !! current temperature
    real(dp) :: factor
    factor = jc_homologous_temperature(law, temperature)
    factor = 1.0_dp - hardening_power(factor, law%thermal_exponent)
  end function jc_softening

  !> Rate factor 1 + coefficient ln(max(1, ratio)) of (J1) and (J3).
  pure function jc_rate_factor(coefficient, ratio) result(factor)
    real(dp), intent(in) :: coefficient  !! C or D4
    real(dp), intent(in) :: ratio       !! plastic strain rate over the reference rate
    real(dp) :: factor
    factor = 1.0_dp + coefficient*log(merge(ratio, 1.0_dp, ratio > 1.0_dp))
  end function jc_rate_factor

  !> Failure strain ep_f of (J3), not below 1e-6.
  pure function jc_failure_strain(law, triaxiality, rate_ratio, temperature) result(strain)
    type(jc_t), intent(in) :: law          !! constants
    real(dp), intent(in) :: triaxiality    !! s*, tension positive; taken as 1.5 above 1.5
    real(dp), intent(in) :: rate_ratio     !! plastic strain rate over the reference rate
    real(dp), intent(in) :: temperature    !! current temperature
    real(dp) :: strain
    real(dp) :: power
    power = law%damage(3)*merge(triaxiality, largest_triaxiality, triaxiality < largest_triaxiality)
    power = merge(power, largest_power, power < largest_power)
    strain = (law%damage(1) + law%damage(2)*exp(power))*jc_rate_factor(law%damage(4), rate_ratio) &
             *(1.0_dp + law%damage(5)*jc_homologous_temperature(law, temperature))
    strain = merge(strain, least_failure_strain, strain > least_failure_strain)
  end function jc_failure_strain

  !> base**exponent for base >= 0; as hardening_power_term, here to be inlined.
  pure function hardening_power(base, exponent) result(power)
    real(dp), intent(in) :: base, exponent
    real(dp) :: power
    power = exp(exponent*log(base + tiny_number))
    power = merge(power, 0.0_dp, base > tiny_number)
  end function hardening_power

  !> Lane kernel, complete model: temperature where the law is thermal, damage where it fails.
  !!
  !! A lane fails when its damage reaches 1, where it then stays. What it carries from then on is
  !! the caller's affair (sgmp_failure), who gives it no deviator to return.
  pure subroutine jc_return(law, shear3, dt, trial, mean, ep, temperature, damage, factor, dep, &
                            scatter, driving, loss)
    type(jc_t), intent(in) :: law                !! constants
    real(dp), intent(in) :: shear3               !! three times the shear modulus (stress)
    real(dp), intent(in) :: dt                   !! time step, > 0
    real(dp), intent(in) :: trial(lanes)         !! von Mises norm of the trial deviator (stress)
    real(dp), intent(in) :: mean(lanes)          !! mean stress, tension positive
    real(dp), intent(inout) :: ep(lanes)         !! equivalent plastic strain, updated
    real(dp), intent(inout) :: temperature(lanes)  !! updated by (J2)
    real(dp), intent(inout) :: damage(lanes)     !! updated by (J3); 1: failed
    real(dp), intent(out) :: factor(lanes)       !! scales the trial deviator
    real(dp), intent(out) :: dep(lanes)          !! plastic strain increment
    real(dp), intent(in), optional :: scatter(lanes)  !! factor on the yield stress
    real(dp), intent(in), optional :: driving(lanes)  !! strain increment of heat and damage, by
                                                      !! default that of the step
    real(dp), intent(in), optional :: loss(lanes)     !! part of the strength lost, Dc D of (J4)
    real(dp) :: softening(lanes), drive(lanes), hardened(lanes)
    softening = 1.0_dp
    if (law%thermal) call softening_lanes(law, temperature, softening)
    if (present(scatter)) softening = scatter*softening
    if (present(loss)) then
      softening = (1.0_dp - loss)*softening
      hardened = (1.0_dp - 0.5_dp*loss)*ep
      call flow_lanes(law, shear3, dt, softening, trial, hardened, factor, dep)
      ep = ep + dep
    else
      call flow_lanes(law, shear3, dt, softening, trial, ep, factor, dep)
    end if
    drive = dep
    if (present(driving)) drive = driving
    if (law%failure) call damage_lanes(law, dt, trial, factor, mean, temperature, drive, damage)
    if (law%thermal) then
      call plastic_heat_lanes(law%taylor_quinney/law%heat_capacity, trial, factor, drive, &
                              temperature)
    end if
  end subroutine jc_return

  !> Lane kernel, model without temperature and failure.
  pure subroutine jc_return_simple(law, shear3, dt, trial, ep, factor, dep, scatter)
    type(jc_t), intent(in) :: law           !! constants
    real(dp), intent(in) :: shear3, dt      !! as in jc_return
    real(dp), intent(in) :: trial(lanes)    !! as in jc_return
    real(dp), intent(inout) :: ep(lanes)    !! as in jc_return
    real(dp), intent(out) :: factor(lanes), dep(lanes)  !! as in jc_return
    real(dp), intent(in), optional :: scatter(lanes)    !! as in jc_return
    real(dp) :: softening(lanes)
    softening = 1.0_dp
    if (present(scatter)) softening = scatter
    call flow_lanes(law, shear3, dt, softening, trial, ep, factor, dep)
  end subroutine jc_return_simple

  !> The return that the law needs, and nothing dearer.
  pure subroutine flow_lanes(law, shear3, dt, softening, trial, ep, factor, dep)
    type(jc_t), intent(in) :: law
    real(dp), intent(in) :: shear3, dt
    real(dp), dimension(lanes), intent(in) :: softening, trial
    real(dp), dimension(lanes), intent(inout) :: ep
    real(dp), dimension(lanes), intent(out) :: factor, dep
    type(hardening_t) :: hardening
    hardening%shear3 = shear3
    hardening%yield = law%yield
    hardening%modulus = law%modulus
    hardening%exponent = law%exponent
    hardening%rate_coefficient = law%rate_coefficient
    hardening%dep_reference = merge(dt*law%reference_rate, tiny_number, dt > 0.0_dp)
    select case (law%flow)
    case (flow_linear)
      call radial_return_linear(hardening, softening, trial, ep, factor, dep)
    case (flow_power)
      call radial_return_power(hardening, softening, trial, ep, factor, dep)
    case default
      call radial_return_rate(hardening, softening, trial, ep, factor, dep)
    end select
  end subroutine flow_lanes

  !> Thermal factor of each lane.
  pure subroutine softening_lanes(law, temperature, softening)
    type(jc_t), intent(in) :: law
    real(dp), intent(in) :: temperature(lanes)
    real(dp), intent(out) :: softening(lanes)
    real(dp) :: hot
    integer :: p
    hot = 0.0_dp
    !$omp simd simdlen(8) reduction(+:hot)
    do p = 1, lanes
      softening(p) = 1.0_dp - jc_homologous_temperature(law, temperature(p))
      hot = hot + (1.0_dp - softening(p))
    end do
    ! An exponent of 1 and cold lanes need no power.
    if (.not. hot > 0.0_dp .or. .not. abs(law%thermal_exponent - 1.0_dp) > 0.0_dp) return
    !$omp simd simdlen(8)
    do p = 1, lanes
      softening(p) = jc_softening(law, temperature(p))
    end do
  end subroutine softening_lanes

  !> Damage (J3) with the temperature of the beginning of the step.
  pure subroutine damage_lanes(law, dt, trial, factor, mean, temperature, dep, damage)
    type(jc_t), intent(in) :: law
    real(dp), intent(in) :: dt
    real(dp), dimension(lanes), intent(in) :: trial, factor, mean, temperature, dep
    real(dp), dimension(lanes), intent(inout) :: damage
    real(dp) :: equivalent, triaxiality, floor_stress, rate_ratio
    integer :: p
    floor_stress = 1.0e-9_dp*(law%yield + law%modulus)
    floor_stress = merge(floor_stress, 1.0_dp, floor_stress > 0.0_dp)
    !$omp simd simdlen(8) private(equivalent, triaxiality, rate_ratio)
    do p = 1, lanes
      equivalent = factor(p)*trial(p)
      triaxiality = mean(p)/merge(equivalent, floor_stress, equivalent > floor_stress)
      rate_ratio = dep(p)/(dt*law%reference_rate)
      damage(p) = damage(p) + dep(p)/jc_failure_strain(law, triaxiality, rate_ratio, temperature(p))
      damage(p) = merge(damage(p), 1.0_dp, damage(p) < 1.0_dp)
    end do
  end subroutine damage_lanes

end module sgmp_material_jc
