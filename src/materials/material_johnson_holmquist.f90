!> Johnson and Holmquist's second ceramic law, JH-2 (1994; theory 4), for brittle matter under
!! impact. With p* = p/pHEL, T* = T/pHEL, sigmaHEL = 3/2 (HEL - pHEL), mu = rho/rho0 - 1:
!!
!!     p       = K1 mu + K2 mu^2 + K3 mu^3 + dp;  K1 mu + dp where mu < 0               (JH1)
!!     sigma_i = A (p* + T*)^N (1 + C ln r)                      of intact matter       (JH2)
!!     sigma_f = B p*^M (1 + C ln r) <= limit                    of fractured matter    (JH3)
!!     sigma_y = (sigma_i - D (sigma_i - sigma_f)) sigmaHEL                             (JH4)
!!     dD      = dep/(D1 (p* + T*)^D2)                                                  (JH5)
!!     (K1 mu + dp)^2 grows by 2 beta K1 dU,   U = sigma_y^2/(6 G)                      (JH6)
!!
!! r is the rate of the deviator of strain over the reference rate, at least 1. Powers of what is
!! negative are 0, and sigma_f is not above sigma_i. dU is what the growth of damage takes from U at
!! the same pressure and rate. Only matter under pressure (K1 mu + dp > 0) bulks: where it is drawn
!! there is room. Matter whose pressure falls below -T (1 - D) has torn: D = 1, and fractured matter
!! bears no tension.
!!
!! Explicit, as published: the strength of a step is that of the damage and of the bulking before
!! it, with the volume after it.
module sgmp_material_johnson_holmquist
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_elastic, only: elastic_init, elastic_t
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: johnson_holmquist_keys, johnson_holmquist_read
  public :: johnson_holmquist_t, johnson_holmquist_strength, johnson_holmquist_return

  ! Strains of round-off, which neither tear nor break: of a volume after many steps, and of a step.
  ! Matter without a tension limit has no strength at rest, and in flight rounding alone would break
  ! it.
  real(dp), parameter :: volume_noise = 1.0e-12_dp, step_noise = 1.0e-14_dp

  !> Constants of (JH1) to (JH6).
  type :: johnson_holmquist_t
    real(dp) :: shear = 0.0_dp                 !! G (stress)
    real(dp) :: k(3) = 0.0_dp                  !! K1, K2, K3 (stress)
    real(dp) :: intact = 0.0_dp                !! A
    real(dp) :: intact_exponent = 0.0_dp       !! N
    real(dp) :: fractured = 0.0_dp             !! B
    real(dp) :: fractured_exponent = 0.0_dp    !! M
    real(dp) :: limit = huge(1.0_dp)           !! of sigma_f sigmaHEL (stress)
    real(dp) :: rate_coefficient = 0.0_dp      !! C
    real(dp) :: reference_rate = 1.0_dp        !! (1/time)
    real(dp) :: tension = 0.0_dp               !! T (stress)
    real(dp) :: pressure = 1.0_dp              !! pHEL (stress)
    real(dp) :: stress = 0.0_dp                !! sigmaHEL (stress)
    real(dp) :: bulking = 1.0_dp               !! beta
    real(dp) :: damage_strain = 0.0_dp         !! D1
    real(dp) :: damage_exponent = 1.0_dp       !! D2
  end type johnson_holmquist_t

contains

  !> Keys of the law.
  function johnson_holmquist_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('shear_modulus', kind_real, 'shear modulus', unit='stress', range='(0,inf)', &
                required=.true.), &
            key('k1', kind_real, 'bulk modulus, K1 of the pressure k1 m + k2 m^2 + k3 m^3, m: '// &
                'density over the initial one - 1; k1 m where m < 0', unit='stress', &
                range='(0,inf)', required=.true.), &
            key('k2', kind_real, 'K2', unit='stress', default='0'), &
            key('k3', kind_real, 'K3', unit='stress', default='0'), &
            key('hugoniot_limit', kind_real, 'HEL: stress at the Hugoniot elastic limit, above '// &
                'hugoniot_pressure', unit='stress', range='(0,inf)', required=.true.), &
            key('hugoniot_pressure', kind_real, 'PHEL: pressure there', unit='stress', &
                range='(0,inf)', required=.true.), &
            key('intact_strength', kind_real, 'Johnson-Holmquist A: intact strength A (p* + '// &
                'T*)^intact_exponent (1 + rate_coefficient ln r), p* and T*: pressure and '// &
                'tension_limit over hugoniot_pressure (not the T* of johnson_cook)', &
                range='(0,inf)', required=.true.), &
            key('intact_exponent', kind_real, 'Johnson-Holmquist N', range='[0,10]', &
                required=.true.), &
            key('fractured_strength', kind_real, 'Johnson-Holmquist B: fractured strength '// &
                'B p*^fractured_exponent (1 + rate_coefficient ln r), not above the intact '// &
                'one', range='[0,inf)', required=.true.), &
            key('fractured_exponent', kind_real, 'Johnson-Holmquist M', range='[0,10]', &
                default='1'), &
            key('fractured_limit', kind_real, 'greatest fractured strength; default: none. '// &
                'This and the two other strengths are stresses over 3/2 (HEL - PHEL)', &
                range='[0,inf)'), &
            key('rate_coefficient', kind_real, 'C', range='[0,inf)', default='0'), &
            key('reference_rate', kind_real, 'rate', unit='1/time', range='(0,inf)', &
                default='1'), &
            key('tension_limit', kind_real, 'Johnson-Holmquist T: greatest tension of intact '// &
                'material', unit='stress', range='[0,inf)', required=.true.), &
            key('bulking', kind_real, 'Johnson-Holmquist beta: part of the lost elastic energy '// &
                'of the deviator that becomes pressure', range='[0,1]', default='1'), &
            key('damage_strain', kind_real, 'Johnson-Holmquist D1: damage grows by plastic '// &
                'strain over D1 (p* + T*)^damage_exponent; 0: at once', range='[0,inf)', &
                required=.true.), &
            key('damage_exponent', kind_real, 'Johnson-Holmquist D2', range='[0,10]', &
                default='1')]
  end function johnson_holmquist_keys

  !> Law from the values of its keys.
  pure subroutine johnson_holmquist_read(density, values, law, elastic, history, fault)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(johnson_holmquist_t), intent(out) :: law
    type(elastic_t), intent(out) :: elastic    !! of small strains
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    law%shear = values%number('shear_modulus')
    law%k = [values%number('k1'), values%number('k2'), values%number('k3')]
    law%intact = values%number('intact_strength')
    law%intact_exponent = values%number('intact_exponent')
    law%fractured = values%number('fractured_strength')
    law%fractured_exponent = values%number('fractured_exponent')
    law%rate_coefficient = values%number('rate_coefficient')
    law%reference_rate = values%number('reference_rate')
    law%tension = values%number('tension_limit')
    law%pressure = values%number('hugoniot_pressure')
    law%stress = 1.5_dp*(values%number('hugoniot_limit') - law%pressure)
    if (values%has('fractured_limit')) law%limit = law%stress*values%number('fractured_limit')
    law%bulking = values%number('bulking')
    law%damage_strain = values%number('damage_strain')
    law%damage_exponent = values%number('damage_exponent')
    associate (g => law%shear, k => law%k(1))
      elastic = elastic_init(density, 9.0_dp*k*g/(3.0_dp*k + g), &
                             (3.0_dp*k - 2.0_dp*g)/(2.0_dp*(3.0_dp*k + g)))
    end associate
    history%plastic = .true.
    history%damage = .true.
    history%bulking = law%bulking > 0.0_dp
    if (.not. law%stress > 0.0_dp) then
      call fault_make(fault, 'hugoniot_limit', 'the stress at the elastic limit is not above '// &
                      'the pressure there', 'without a difference there is no strength: '// &
                      'check both')
    end if
  end subroutine johnson_holmquist_read

  !> Strength (JH4) (stress), and what damage takes of it: that of intact less that of fractured
  !! matter.
  elemental subroutine johnson_holmquist_strength(law, pressure, rate, damage, strength, loss)
    type(johnson_holmquist_t), intent(in) :: law
    real(dp), intent(in) :: pressure   !! (stress)
    real(dp), intent(in) :: rate       !! of the deviator of strain (1/time)
    real(dp), intent(in) :: damage     !! 0 to 1
    real(dp), intent(out) :: strength, loss  !! (stress)
    real(dp) :: ratio, intact, fractured, faster
    ratio = rate/law%reference_rate
    faster = law%stress*(1.0_dp + law%rate_coefficient*log(merge(ratio, 1.0_dp, ratio > 1.0_dp)))
    intact = faster*law%intact*power((pressure + law%tension)/law%pressure, law%intact_exponent)
    fractured = faster*law%fractured*power(pressure/law%pressure, law%fractured_exponent)
    fractured = min(fractured, law%limit, intact)
    loss = intact - fractured
    strength = intact - damage*loss
  end subroutine johnson_holmquist_strength

  !> base^exponent, 0 where the base is not above 0.
  elemental function power(base, exponent) result(value)
    real(dp), intent(in) :: base, exponent
    real(dp) :: value
    value = exp(exponent*log(merge(base, 1.0_dp, base > 0.0_dp)))
    value = merge(value, 0.0_dp, base > 0.0_dp)
  end function power

  !> Lane kernel: radial return, damage, and pressure.
  pure subroutine johnson_holmquist_return(law, volume, rate, trial, ep, damage, bulking, &
                                           pressure, slope, factor)
    type(johnson_holmquist_t), intent(in) :: law
    real(dp), intent(in) :: volume(lanes)      !! over initial volume, after the step; 0: empty
    real(dp), intent(in) :: rate(lanes)        !! of the deviator of strain (1/time)
    real(dp), intent(in) :: trial(lanes)       !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: ep(lanes)       !! equivalent plastic strain, updated
    real(dp), intent(inout) :: damage(lanes)   !! updated by (JH5)
    real(dp), intent(inout) :: bulking(lanes)  !! dp (stress), updated by (JH6)
    real(dp), intent(out) :: pressure(lanes)   !! (JH1), not below -T (1 - D) (stress)
    real(dp), intent(out) :: slope(lanes)      !! dp/dmu without bulking (stress)
    real(dp), intent(out) :: factor(lanes)     !! scales the trial deviator
    real(dp) :: mu, dense, pushed, least, strength, loss, dep, fatal, before, released
    logical :: torn
    integer :: p
    !$omp simd simdlen(8) private(mu, dense, pushed, least, strength, loss, dep, fatal, before) &
    !$omp& private(released, torn)
    do p = 1, lanes
      mu = 1.0_dp/merge(volume(p), 1.0_dp, volume(p) > 0.0_dp) - 1.0_dp
      dense = merge(mu, 0.0_dp, mu > 0.0_dp)
      pushed = law%k(1)*mu + bulking(p)
      pressure(p) = pushed + dense*dense*(law%k(2) + law%k(3)*dense)
      slope(p) = law%k(1) + dense*(2.0_dp*law%k(2) + 3.0_dp*law%k(3)*dense)
      least = -law%tension*(1.0_dp - damage(p))
      torn = pressure(p) < least - volume_noise*law%k(1)
      damage(p) = merge(1.0_dp, damage(p), torn)
      least = merge(0.0_dp, least, torn)
      pressure(p) = merge(pressure(p), least, pressure(p) > least)
      call johnson_holmquist_strength(law, pressure(p), rate(p), damage(p), strength, loss)
      dep = merge(trial(p) - strength, 0.0_dp, trial(p) > strength)/(3.0_dp*law%shear)
      factor(p) = strength/merge(trial(p), 1.0_dp, dep > 0.0_dp)
      factor(p) = merge(factor(p), 1.0_dp, dep > 0.0_dp)
      ep(p) = ep(p) + dep
      fatal = law%damage_strain*power((pressure(p) + law%tension)/law%pressure, &
                                      law%damage_exponent)
      before = damage(p)
      damage(p) = before + dep/merge(fatal, 1.0_dp, fatal > 0.0_dp)
      damage(p) = merge(damage(p), 1.0_dp, dep < fatal*(1.0_dp - before))
      damage(p) = merge(damage(p), before, dep > step_noise)
      loss = (damage(p) - before)*loss
      released = loss*(2.0_dp*strength - loss)/(6.0_dp*law%shear)
      released = merge(2.0_dp*law%bulking*law%k(1)*released, 0.0_dp, pushed > 0.0_dp)
      ! sqrt(pushed^2 + released) - pushed, which would cancel.
      released = released/merge(pushed + sqrt(pushed*pushed + released), 1.0_dp, pushed > 0.0_dp)
      bulking(p) = bulking(p) + released
      pressure(p) = pressure(p) + released
    end do
  end subroutine johnson_holmquist_return

end module sgmp_material_johnson_holmquist
