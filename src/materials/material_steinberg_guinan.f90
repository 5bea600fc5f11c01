!> Steinberg, Cochran and Guinan's (1980) shear modulus and yield stress at high strain rates
!! (theory 4):
!!
!!     G/G0    = 1 + A p v^(1/3) - B (T - room)                                         (SG1)
!!     sigma_y = min(Y0 (1 + beta (ep + initial))^n, Ymax) G/G0                         (SG2)
!!     Tm      = melt exp(2 a (1 - v)) v^(-2 (gamma0 - a - 1/3))                        (SG3)
!!
!! with v = V/V0; above Tm there is neither. Pressure, volume and temperature are those of the
!! beginning of the step. In units of G/G0 trial stress and law are those of virgin matter, so that
!! the return is the common one; it starts from the strain at which the power alone is the yield
!! stress, and of hardening and Ymax the one that yields more is the solution.
module sgmp_material_steinberg_guinan
  use sgmp_heating, only: heat_plastic_work, heating_keys, heating_read, heating_t
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  use sgmp_radial_return, only: hardening_keys, hardening_t, radial_return_linear, &
                                radial_return_power
  implicit none
  private
  public :: steinberg_guinan_t, steinberg_guinan_keys, steinberg_guinan_read
  public :: steinberg_guinan_set_hardening, steinberg_guinan_yield_stress
  public :: steinberg_guinan_melting, steinberg_guinan_stiffness, steinberg_guinan_return

  real(dp), parameter :: least_stiffness = 1.0e-6_dp  !! of G/G0; below, matter is molten

  !> Constants of the law.
  type :: steinberg_guinan_t
    real(dp) :: yield = 0.0_dp                !! Y0 (stress)
    real(dp) :: limit = huge(1.0_dp)          !! Ymax (stress)
    real(dp) :: modulus = 0.0_dp              !! Y0 beta^n (stress); 0: no hardening
    real(dp) :: exponent = 1.0_dp             !! n
    real(dp) :: before = 0.0_dp               !! initial strain + 1/beta
    real(dp) :: pressure_stiffening = 0.0_dp  !! A (1/stress)
    real(dp) :: thermal_softening = 0.0_dp    !! B (1/temperature)
    real(dp) :: melt_slope = 0.0_dp           !! a
    real(dp) :: melt_power = 0.0_dp           !! 2 (gamma0 - a - 1/3)
    type(heating_t) :: heating
  end type steinberg_guinan_t

contains

  !> Keys of the law, besides the moduli.
  function steinberg_guinan_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    type(key_t), allocatable :: shared(:)
    shared = hardening_keys()
    keys = [shared(1), shared(3), &
            key('hardening_factor', kind_real, 'Steinberg-Guinan beta: yield stress '// &
                'min(yield (1 + beta (e + initial_strain))^hardening_exponent, yield_limit) '// &
                'G/G0, e: plastic strain', range='[0,inf)', default='0'), &
            key('initial_strain', kind_real, 'plastic strain of the material before the start', &
                range='[0,inf)', default='0'), &
            key('yield_limit', kind_real, 'greatest yield stress at G = G0; default: none', &
                unit='stress', range='(0,inf)'), &
            key('pressure_stiffening', kind_real, 'A of G/G0 = 1 + A p v^(1/3) - '// &
                'thermal_softening (temperature - room), v: volume over the initial one', &
                unit='1/stress', range='[0,inf)', default='0'), &
            key('thermal_softening', kind_real, 'Steinberg-Guinan B; Zerilli-Armstrong C3', &
                unit='1/temperature', range='[0,inf)', default='0'), &
            key('melt_slope', kind_real, 'a of the melting temperature, melt_temperature '// &
                'exp(2 a (1 - v)) v^(-2 (melt_gamma - a - 1/3)); without it that is constant', &
                range='[0,inf)'), &
            key('melt_gamma', kind_real, "Grueneisen's coefficient in it; needed with "// &
                'melt_slope', range='[0,inf)'), &
            heating_keys()]
  end function steinberg_guinan_keys

  !> Law from the values of its keys.
  pure subroutine steinberg_guinan_read(density, values, law, history, fault)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(steinberg_guinan_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    call steinberg_guinan_set_hardening(law, values%number('yield'), &
                                        values%number('yield_limit', huge(1.0_dp)), &
                                        values%number('hardening_factor'), &
                                        values%number('hardening_exponent'), &
                                        values%number('initial_strain'))
    law%pressure_stiffening = values%number('pressure_stiffening')
    law%thermal_softening = values%number('thermal_softening')
    history%plastic = .true.
    call heating_read(density, values, law%heating, history, fault)
    if (values%has('melt_slope')) then
      law%melt_slope = values%number('melt_slope')
      law%melt_power = 2.0_dp*(values%number('melt_gamma') - law%melt_slope - 1.0_dp/3.0_dp)
    end if
    if (allocated(fault)) return
    if (values%has('melt_slope') .neqv. values%has('melt_gamma')) then
      call fault_make(fault, '', 'melt_slope and melt_gamma belong together', 'give both, or none')
    else if (values%has('melt_slope') .and. .not. values%has('melt_temperature')) then
      call fault_make(fault, 'melt_slope', 'nothing says where it melts without pressure', &
                      'add melt_temperature')
    else if (law%thermal_softening > 0.0_dp .and. .not. law%heating%warms) then
      call fault_make(fault, 'thermal_softening', 'without specific_heat nothing '// &
                      'warms, or softens', 'add specific_heat, or remove thermal_softening')
    else if (law%limit < law%yield) then
      call fault_make(fault, 'yield_limit', 'the greatest yield stress is below the first', &
                      'check both')
    end if
  end subroutine steinberg_guinan_read

  !> Constants of (SG2).
  pure subroutine steinberg_guinan_set_hardening(law, yield, limit, factor, exponent, initial)
    type(steinberg_guinan_t), intent(inout) :: law
    real(dp), intent(in) :: yield, limit  !! Y0, Ymax (stress)
    real(dp), intent(in) :: factor        !! beta >= 0
    real(dp), intent(in) :: exponent      !! n > 0
    real(dp), intent(in) :: initial       !! plastic strain before the start, >= 0
    law%yield = yield
    law%limit = limit
    law%exponent = exponent
    if (factor > 0.0_dp) then
      law%modulus = yield*factor**exponent
      law%before = initial + 1.0_dp/factor
    else
      law%limit = min(limit, yield)
    end if
  end subroutine steinberg_guinan_set_hardening

  !> Yield stress (SG2) at G = G0 (stress).
  pure function steinberg_guinan_yield_stress(law, ep) result(stress)
    type(steinberg_guinan_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: ep                   !! equivalent plastic strain, >= 0
    real(dp) :: stress
    stress = law%limit
    if (law%modulus > 0.0_dp) then
      stress = min(stress, law%modulus*(law%before + ep)**law%exponent)
    end if
  end function steinberg_guinan_yield_stress

  !> Melting temperature (SG3).
  pure function steinberg_guinan_melting(law, v) result(temperature)
    type(steinberg_guinan_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v                    !! volume over initial volume, > 0
    real(dp) :: temperature
    temperature = melting(law, v, log(v))
  end function steinberg_guinan_melting

  !> (SG3), where the logarithm of v is known already.
  pure function melting(law, v, log_v) result(temperature)
    type(steinberg_guinan_t), intent(in) :: law
    real(dp), intent(in) :: v, log_v
    real(dp) :: temperature
    temperature = law%heating%melt*exp(2.0_dp*law%melt_slope*(1.0_dp - v) - law%melt_power*log_v)
  end function melting

  !> Lane kernel: G/G0 (SG1), 0 where matter is molten; empty lanes count as virgin.
  pure subroutine steinberg_guinan_stiffness(law, pressure, volume, temperature, stiffness)
    type(steinberg_guinan_t), intent(in) :: law       !! constants
    real(dp), intent(in) :: pressure(lanes)           !! (stress)
    real(dp), intent(in) :: volume(lanes)             !! over initial volume
    real(dp), intent(in) :: temperature(lanes)
    real(dp), intent(out) :: stiffness(lanes)
    real(dp) :: v, log_v, melt
    integer :: p
    !$omp simd simdlen(8) private(v, log_v, melt)
    do p = 1, lanes
      v = merge(volume(p), 1.0_dp, volume(p) > 0.0_dp)
      log_v = log(v)
      melt = melting(law, v, log_v)
      stiffness(p) = 1.0_dp + law%pressure_stiffening*pressure(p)*exp(log_v*(1.0_dp/3.0_dp)) - &
                     law%thermal_softening*(temperature(p) - law%heating%room)
      stiffness(p) = merge(stiffness(p), 0.0_dp, temperature(p) < melt)
      stiffness(p) = merge(stiffness(p), 0.0_dp, stiffness(p) > least_stiffness)
    end do
  end subroutine steinberg_guinan_stiffness

  !> Lane kernel: radial return; molten lanes lose their deviator, and count it not as plastic.
  pure subroutine steinberg_guinan_return(law, shear3, stiffness, trial, ep, temperature, factor, &
                                          dep, scatter)
    type(steinberg_guinan_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: shear3               !! three times G0 (stress)
    real(dp), intent(in) :: stiffness(lanes)     !! G/G0
    real(dp), intent(in) :: trial(lanes)         !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: ep(lanes)         !! equivalent plastic strain, updated
    real(dp), intent(inout) :: temperature(lanes)  !! updated by (T1) where the law warms
    real(dp), intent(out) :: factor(lanes)       !! scales the trial deviator
    real(dp), intent(out) :: dep(lanes)          !! plastic strain increment
    real(dp), intent(in), optional :: scatter(lanes)  !! factor on the yield stress
    real(dp), dimension(lanes) :: solid, virgin, hardened, capped_dep, capped_factor, strength
    type(hardening_t) :: hardening
    strength = 1.0_dp
    if (present(scatter)) strength = scatter
    solid = merge(1.0_dp, 0.0_dp, stiffness > 0.0_dp)
    virgin = solid*trial/merge(stiffness, 1.0_dp, stiffness > 0.0_dp)
    factor = solid
    dep = 0.0_dp
    if (.not. any(virgin > strength*min(law%yield, law%limit))) return
    hardening%shear3 = shear3
    hardening%yield = law%limit
    hardened = ep
    call radial_return_linear(hardening, strength, virgin, hardened, capped_factor, capped_dep)
    if (law%modulus > 0.0_dp) then
      hardening%yield = 0.0_dp
      hardening%modulus = law%modulus
      hardening%exponent = law%exponent
      hardened = ep + law%before
      call radial_return_power(hardening, strength, virgin, hardened, factor, dep)
    end if
    dep = max(dep, capped_dep)
    factor = solid*min(factor, capped_factor)
    ep = ep + dep
    call heat_plastic_work(law%heating, trial, factor, dep, temperature)
  end subroutine steinberg_guinan_return

end module sgmp_material_steinberg_guinan
