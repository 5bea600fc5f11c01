!> Holmquist, Johnson and Cook's concrete (1993; theory 4), for large strains, high rates and high
!! pressures. With p* = p/fc, T* = T/fc, mu = rho/rho0 - 1, m the greatest mu so far:
!!
!!     sigma_y = fc (A (1 - D) + B p*^N) (1 + C ln r) <= fc Smax       where p >= 0         (HJC1)
!!     sigma_y = fc A (1 - D + p/T) (1 + C ln r) <= fc Smax            where it is drawn    (HJC2)
!!     dD = (dep + dmu_p)/max(EFMIN, D1 (p* + T*)^D2)                                       (HJC3)
!!     p = K0 mu,  K0 = Pcrush/mu_crush                                m <= mu_crush        (HJC4)
!!     p = Y(m) - K(m) (m - mu),  Y = Pcrush + S (m - mu_crush),  S = (Plock - Pcrush)/
!!         (mu_plock - mu_crush)                                       m <= mu_plock        (HJC5)
!!     p = K1 x + K2 x^2 + K3 x^3,  x = (mu - mu_lock)/(1 + mu_lock)   beyond               (HJC6)
!!     p >= -T (1 - D)                                                                      (HJC7)
!!
!! r is the rate of the deviator of strain over the reference rate, at least 1. mu_plock is where
!! (HJC6) reaches Plock. K grows linearly with m, from K0 to the modulus by which matter at mu_plock
!! unloads to mu_lock, so that (HJC5) and (HJC6) leave the same compaction there (the paper takes
!! K1, 2 % more for its constants). mu_p = m - Y/K is the compaction, what is left of mu without
!! pressure; mu_lock beyond mu_plock. Dense matter follows (HJC6) up and down, with its first slope
!! where x < 0. Powers of what is negative are 0.
!!
!! The paper gives (HJC1), (HJC3) to (HJC7); the straight line (HJC2) from A (1 - D) without
!! pressure to nothing at the limit of tension is the line of its figure. A gap closes where it
!! opened.
!!
!! Explicit, as published: the strength of a step is that of the damage before it, with the pressure
!! after it.
module sgmp_material_concrete
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_elastic, only: elastic_init, elastic_t
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: concrete_keys, concrete_read
  public :: concrete_finish, concrete_pressure, concrete_return, concrete_strength, concrete_t

  ! Strain of round-off in a step, which does no harm.
  real(dp), parameter :: step_noise = 1.0e-14_dp
  integer, parameter :: most_halvings = 200     !! to the compression at Plock

  !> Constants of (HJC1) to (HJC7); those from `crush_modulus` on follow from the others.
  type :: concrete_t
    real(dp) :: shear = 0.0_dp                 !! G (stress)
    real(dp) :: compressive = 1.0_dp           !! fc (stress)
    real(dp) :: cohesion = 0.0_dp              !! A
    real(dp) :: hardening = 0.0_dp             !! B
    real(dp) :: exponent = 1.0_dp              !! N
    real(dp) :: rate_coefficient = 0.0_dp      !! C
    real(dp) :: reference_rate = 1.0_dp        !! (1/time)
    real(dp) :: limit = huge(1.0_dp)           !! fc Smax (stress)
    real(dp) :: tension = 0.0_dp               !! T (stress)
    real(dp) :: damage_strain = 0.0_dp         !! D1
    real(dp) :: damage_exponent = 1.0_dp       !! D2
    real(dp) :: least_strain = 0.0_dp          !! EFMIN
    real(dp) :: crush = 1.0_dp                 !! Pcrush (stress)
    real(dp) :: crush_compression = 1.0_dp     !! mu_crush
    real(dp) :: lock = 1.0_dp                  !! Plock (stress)
    real(dp) :: lock_compression = 1.0_dp      !! mu_lock
    real(dp) :: k(3) = 0.0_dp                  !! K1, K2, K3 (stress)
    real(dp) :: crush_modulus = 0.0_dp         !! K0 (stress)
    real(dp) :: crush_slope = 0.0_dp           !! S (stress)
    real(dp) :: dense_compression = 0.0_dp     !! mu_plock
    real(dp) :: dense_modulus = 0.0_dp         !! K at mu_plock (stress)
  end type concrete_t

contains

  !> Keys of the law.
  function concrete_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('shear_modulus', kind_real, 'shear modulus', unit='stress', range='(0,inf)', &
                required=.true.), &
            key('compressive_strength', kind_real, 'fc: of a cylinder, by which the law '// &
                'normalises stresses', unit='stress', range='(0,inf)', required=.true.), &
            key('cohesive_strength', kind_real, 'Holmquist-Johnson-Cook A: strength '// &
                '(A (1 - damage) + pressure_hardening p*^pressure_exponent) (1 + '// &
                'rate_coefficient ln r), this and p* over compressive_strength', &
                range='[0,inf)', required=.true.), &
            key('pressure_hardening', kind_real, 'Holmquist-Johnson-Cook B', range='[0,inf)', &
                required=.true.), &
            key('pressure_exponent', kind_real, 'Holmquist-Johnson-Cook N', range='[0,10]', &
                required=.true.), &
            key('strength_limit', kind_real, 'Holmquist-Johnson-Cook Smax: greatest strength '// &
                'over compressive_strength; default: none', range='(0,inf)'), &
            key('rate_coefficient', kind_real, 'C', range='[0,inf)', default='0'), &
            key('reference_rate', kind_real, 'rate', unit='1/time', range='(0,inf)', &
                default='1'), &
            key('tension_limit', kind_real, 'Holmquist-Johnson-Cook T: greatest mean tension '// &
                'of undamaged material', unit='stress', range='[0,inf)', required=.true.), &
            key('damage_strain', kind_real, 'Holmquist-Johnson-Cook D1: damage grows by '// &
                'plastic strain and compaction over D1 (p* + T*)^damage_exponent', &
                range='[0,inf)', required=.true.), &
            key('damage_exponent', kind_real, 'Holmquist-Johnson-Cook D2', range='[0,10]', &
                default='1'), &
            key('least_damage_strain', kind_real, 'EFMIN: strain to failure is not below it', &
                range='[0,inf)', default='0'), &
            key('crush_pressure', kind_real, 'pressure where pores begin to close', &
                unit='stress', range='(0,inf)', required=.true.), &
            key('crush_compression', kind_real, 'density over the initial one - 1 there', &
                range='(0,1)', required=.true.), &
            key('lock_pressure', kind_real, 'pressure where no pores are left', &
                unit='stress', range='(0,inf)', required=.true.), &
            key('lock_compression', kind_real, 'density over the initial one - 1 of material '// &
                'without pores, without pressure', range='(0,10)', required=.true.), &
            key('k1', kind_real, 'K1 of the pressure k1 x + k2 x^2 + k3 x^3 of material '// &
                'without pores, x: its density over that without pressure - 1', unit='stress', &
                range='(0,inf)', required=.true.), &
            key('k2', kind_real, 'K2', unit='stress', default='0'), &
            key('k3', kind_real, 'K3', unit='stress', default='0')]
  end function concrete_keys

  !> Law from the values of its keys.
  pure subroutine concrete_read(density, values, law, elastic, history, fault)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(concrete_t), intent(out) :: law
    type(elastic_t), intent(out) :: elastic    !! of small strains
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    law%shear = values%number('shear_modulus')
    law%compressive = values%number('compressive_strength')
    law%cohesion = values%number('cohesive_strength')
    law%hardening = values%number('pressure_hardening')
    law%exponent = values%number('pressure_exponent')
    if (values%has('strength_limit')) law%limit = law%compressive*values%number('strength_limit')
    law%rate_coefficient = values%number('rate_coefficient')
    law%reference_rate = values%number('reference_rate')
    law%tension = values%number('tension_limit')
    law%damage_strain = values%number('damage_strain')
    law%damage_exponent = values%number('damage_exponent')
    law%least_strain = values%number('least_damage_strain')
    law%crush = values%number('crush_pressure')
    law%crush_compression = values%number('crush_compression')
    law%lock = values%number('lock_pressure')
    law%lock_compression = values%number('lock_compression')
    law%k = [values%number('k1'), values%number('k2'), values%number('k3')]
    history%plastic = .true.
    history%damage = .true.
    history%compaction = .true.
    call check_dense(law, fault)
    if (.not. allocated(fault)) call concrete_finish(law)
    if (.not. allocated(fault)) call check_crush(law, fault)
    associate (g => law%shear, k => law%crush/law%crush_compression)
      elastic = elastic_init(density, 9.0_dp*k*g/(3.0_dp*k + g), &
                             (3.0_dp*k - 2.0_dp*g)/(2.0_dp*(3.0_dp*k + g)))
    end associate
  end subroutine concrete_read

  !> Whether the pressure of dense matter grows wherever it is compressed.
  pure subroutine check_dense(law, fault)
    type(concrete_t), intent(in) :: law
    type(fault_t), allocatable, intent(out) :: fault
    logical :: grows
    grows = law%k(3) >= 0.0_dp
    if (law%k(2) < 0.0_dp) grows = law%k(2)**2 < 3.0_dp*law%k(1)*law%k(3)
    if (.not. grows) call fault_make(fault, 'k2', 'the pressure of dense material falls where '// &
                                     'it is compressed further', &
                                     'k3 not below 0, and k2^2 below 3 k1 k3 where k2 is negative')
  end subroutine check_dense

  !> Whether the pores close under a pressure that grows, and stay closed.
  pure subroutine check_crush(law, fault)
    type(concrete_t), intent(in) :: law
    type(fault_t), allocatable, intent(out) :: fault
    real(dp) :: growth
    if (law%lock <= law%crush) then
      call fault_make(fault, 'lock_pressure', 'pores are closed at a pressure not above the '// &
                      'one at which they begin to close', 'lock_pressure above crush_pressure')
      return
    end if
    if (law%dense_compression <= law%crush_compression) then
      call fault_make(fault, 'lock_compression', 'material without pores is not denser than '// &
                      'material whose pores begin to close', 'more than crush_compression')
      return
    end if
    ! K >= S, and d mu_p/dm = (K^2 - S K + Y K')/K^2, whose numerator grows or falls with K all the
    ! way, not below 0: then Y - d/dm (Y^2/(2 K)), what crushing dissipates, is not below 0 either.
    growth = (law%dense_modulus - law%crush_modulus)/(law%dense_compression - law%crush_compression)
    if (min(law%crush_modulus, law%dense_modulus) < law%crush_slope .or. &
        law%crush_modulus*(law%crush_modulus - law%crush_slope) + law%crush*growth < 0.0_dp .or. &
        law%dense_modulus*(law%dense_modulus - law%crush_slope) + law%lock*growth < 0.0_dp) then
      call fault_make(fault, 'lock_pressure', 'material that is let go would give more than '// &
                      'crushing it took', 'check crush_pressure over crush_compression, '// &
                      'lock_pressure over lock_compression, and k1: the second is the least')
    end if
  end subroutine check_crush

  !> Constants that follow from the others.
  pure subroutine concrete_finish(law)
    type(concrete_t), intent(inout) :: law
    real(dp) :: low, high, middle
    integer :: n
    low = 0.0_dp
    high = 1.0_dp
    do n = 1, most_halvings
      if (dense_pressure(law, high) >= law%lock) exit
      high = 2.0_dp*high
    end do
    do n = 1, most_halvings
      middle = 0.5_dp*(low + high)
      if (dense_pressure(law, middle) < law%lock) then
        low = middle
      else
        high = middle
      end if
    end do
    law%crush_modulus = law%crush/law%crush_compression
    law%dense_compression = law%lock_compression + (1.0_dp + law%lock_compression)*high
    law%dense_modulus = law%lock/(law%dense_compression - law%lock_compression)
    law%crush_slope = (law%lock - law%crush)/(law%dense_compression - law%crush_compression)
  end subroutine concrete_finish

  !> (HJC6) (stress), with its first slope where x < 0.
  elemental function dense_pressure(law, x) result(pressure)
    type(concrete_t), intent(in) :: law
    real(dp), intent(in) :: x
    real(dp) :: pressure, pushed
    pushed = merge(x, 0.0_dp, x > 0.0_dp)
    pressure = law%k(1)*x + pushed*pushed*(law%k(2) + law%k(3)*pushed)
  end function dense_pressure

  !> (HJC4) to (HJC6): pressure without the limit of tension, slope dp/dmu where mu falls (stress),
  !! and compaction mu_p.
  elemental subroutine concrete_pressure(law, mu, greatest, pressure, slope, compaction)
    type(concrete_t), intent(in) :: law
    real(dp), intent(in) :: mu           !! not above `greatest`
    real(dp), intent(in) :: greatest     !! m
    real(dp), intent(out) :: pressure, slope, compaction
    real(dp) :: m, part, bound, modulus, x, pushed, tangent
    logical :: dense
    dense = greatest >= law%dense_compression
    m = merge(greatest, law%crush_compression, greatest > law%crush_compression)
    part = (m - law%crush_compression)/(law%dense_compression - law%crush_compression)
    modulus = law%crush_modulus + part*(law%dense_modulus - law%crush_modulus)
    bound = law%crush + law%crush_slope*(m - law%crush_compression)
    x = (mu - law%lock_compression)/(1.0_dp + law%lock_compression)
    pushed = merge(x, 0.0_dp, x > 0.0_dp)
    tangent = (law%k(1) + pushed*(2.0_dp*law%k(2) + 3.0_dp*law%k(3)*pushed)) &
              /(1.0_dp + law%lock_compression)
    pressure = merge(dense_pressure(law, x), bound - modulus*(m - mu), dense)
    slope = merge(tangent, modulus, dense)
    compaction = merge(law%lock_compression, m - bound/modulus, dense)
  end subroutine concrete_pressure

  !> Strength (HJC1), (HJC2) (stress).
  elemental function concrete_strength(law, pressure, rate, damage) result(strength)
    type(concrete_t), intent(in) :: law
    real(dp), intent(in) :: pressure   !! (stress)
    real(dp), intent(in) :: rate       !! of the deviator of strain (1/time)
    real(dp), intent(in) :: damage     !! 0 to 1
    real(dp) :: strength, ratio, drawn
    ratio = rate/law%reference_rate
    drawn = merge(pressure, 0.0_dp, pressure < 0.0_dp) &
            /merge(law%tension, 1.0_dp, law%tension > 0.0_dp)
    drawn = law%cohesion*(1.0_dp - damage + drawn)
    strength = merge(drawn, 0.0_dp, drawn > 0.0_dp) &
               + law%hardening*power(pressure/law%compressive, law%exponent)
    strength = law%compressive*strength*(1.0_dp + law%rate_coefficient &
                                         *log(merge(ratio, 1.0_dp, ratio > 1.0_dp)))
    strength = merge(strength, law%limit, strength < law%limit)
  end function concrete_strength

  !> base^exponent, 0 where the base is not above 0.
  elemental function power(base, exponent) result(value)
    real(dp), intent(in) :: base, exponent
    real(dp) :: value
    value = exp(exponent*log(merge(base, 1.0_dp, base > 0.0_dp)))
    value = merge(value, 0.0_dp, base > 0.0_dp)
  end function power

  !> Lane kernel: compaction, pressure, radial return, and damage.
  pure subroutine concrete_return(law, volume, rate, trial, ep, damage, greatest, pressure, slope, &
                                  factor)
    type(concrete_t), intent(in) :: law
    real(dp), intent(in) :: volume(lanes)      !! over initial volume, after the step; 0: empty
    real(dp), intent(in) :: rate(lanes)        !! of the deviator of strain (1/time)
    real(dp), intent(in) :: trial(lanes)       !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: ep(lanes)       !! equivalent plastic strain, updated
    real(dp), intent(inout) :: damage(lanes)   !! updated by (HJC3)
    real(dp), intent(inout) :: greatest(lanes)  !! compression so far, m, updated
    real(dp), intent(out) :: pressure(lanes)   !! (stress)
    real(dp), intent(out) :: slope(lanes)      !! dp/dmu where mu falls (stress)
    real(dp), intent(out) :: factor(lanes)     !! scales the trial deviator
    real(dp) :: mu, least, strength, dep, harm, fatal, before, closed, now, ignored, same
    integer :: p
    !$omp simd simdlen(8) private(mu, least, strength, dep, harm, fatal, before, closed, now) &
    !$omp& private(ignored, same)
    do p = 1, lanes
      mu = 1.0_dp/merge(volume(p), 1.0_dp, volume(p) > 0.0_dp) - 1.0_dp
      call concrete_pressure(law, greatest(p), greatest(p), ignored, same, closed)
      greatest(p) = merge(mu, greatest(p), mu > greatest(p))
      call concrete_pressure(law, mu, greatest(p), pressure(p), slope(p), now)
      before = damage(p)
      least = -law%tension*(1.0_dp - before)
      pressure(p) = merge(pressure(p), least, pressure(p) > least)
      strength = concrete_strength(law, pressure(p), rate(p), before)
      dep = merge(trial(p) - strength, 0.0_dp, trial(p) > strength)/(3.0_dp*law%shear)
      factor(p) = strength/merge(trial(p), 1.0_dp, dep > 0.0_dp)
      factor(p) = merge(factor(p), 1.0_dp, dep > 0.0_dp)
      ep(p) = ep(p) + dep
      harm = dep + (now - closed)
      fatal = law%damage_strain*power((pressure(p) + law%tension)/law%compressive, &
                                      law%damage_exponent)
      fatal = merge(fatal, law%least_strain, fatal > law%least_strain)
      damage(p) = before + harm/merge(fatal, 1.0_dp, fatal > 0.0_dp)
      damage(p) = merge(damage(p), 1.0_dp, harm < fatal*(1.0_dp - before))
      damage(p) = merge(damage(p), before, harm > step_noise)
    end do
  end subroutine concrete_return

end module sgmp_material_concrete
