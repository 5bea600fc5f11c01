!> Foams of metals and polymers that crush (Deshpande and Fleck 2000; theory 4). With q the von
!! Mises stress, s_m the mean stress, e the plastic strain that is conjugate to the left side:
!!
!!     sqrt((q^2 + a^2 s_m^2)/(1 + a^2/9)) <= Y(e),  a^2 = 9/2 (1 - 2 nu_p)/(1 + nu_p)  (CF1)
!!     Y = plateau + g e/e_D - d ln(1 - (e/e_D)^b)                                       (CF2)
!!
!! (CF2) is that of Hanssen, Hopperstad, Langseth and Ilstad (2002), e_D the strain at which the
!! pores have closed. Uniaxial stress yields at Y; of its plastic strain the part nu_p is sideways.
!! Plastic strain is normal to (CF1), and de is what it does in work over Y. The return is implicit:
!!
!!     q = q*/(1 + 3 G w),  s_m = s_m*/(1 + K a^2 w),  w = de/((1 + a^2/9) Y(e + de))    (CF3)
!!
!! in (CF1) is one equation for de. Moduli are those of the foam and constant.
module sgmp_material_crushable_foam
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_elastic, only: elastic_t
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: crushable_foam_keys, crushable_foam_read
  public :: crushable_foam_t, crushable_foam_init, crushable_foam_yield, crushable_foam_point, &
            crushable_foam_return

  integer, parameter :: most_trials = 100            !! of de: halving the bracket needs no more
  real(dp), parameter :: settled = 1.0e-16_dp        !! of de over e_D
  real(dp), parameter :: nearly_settled = 1.0e-8_dp  !! of de: Newton's step squares the error
  real(dp), parameter :: closed = 1.0_dp - 1.0e-6_dp   !! e/e_D from which (CF2) is its tangent

  !> Constants of (CF1) and (CF2).
  type :: crushable_foam_t
    real(dp) :: shape = 4.5_dp                 !! a^2
    real(dp) :: size = 1.5_dp                  !! 1 + a^2/9
    real(dp) :: plateau = 0.0_dp               !! (stress)
    real(dp) :: hardening = 0.0_dp             !! g (stress)
    real(dp) :: densification = 0.0_dp         !! d (stress)
    real(dp) :: densified = 1.0_dp             !! e_D
    real(dp) :: exponent = 1.0_dp              !! b
  end type crushable_foam_t

contains

  !> Keys of the law, besides the moduli.
  function crushable_foam_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('plateau', kind_real, 'yield stress Y under uniaxial stress at the start: '// &
                'Y = plateau + linear_hardening r - densification ln(1 - '// &
                'r^densification_exponent), r: plastic strain over densification_strain', &
                unit='stress', range='(0,inf)', required=.true.), &
            key('plastic_poisson', kind_real, "Poisson's ratio of the plastic strain under "// &
                'uniaxial stress', range='[0,0.5)', default='0'), &
            key('linear_hardening', kind_real, 'gamma', unit='stress', range='[0,inf)', &
                default='0'), &
            key('densification', kind_real, 'alpha2', unit='stress', range='[0,inf)', &
                default='0'), &
            key('densification_strain', kind_real, 'plastic strain at which the pores have '// &
                'closed: of foams that hardly bulge, the logarithm of the density of the '// &
                "solid over the foam's", range='(0,inf)', required=.true.), &
            key('densification_exponent', kind_real, 'beta', range='[1,inf)', default='1')]
  end function crushable_foam_keys

  !> Law from the values of its keys.
  pure subroutine crushable_foam_read(values, law, history, fault)
    class(values_t), intent(in) :: values
    type(crushable_foam_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    law = crushable_foam_init(values%number('plateau'), values%number('plastic_poisson'), &
                              values%number('linear_hardening'), &
                              values%number('densification'), &
                              values%number('densification_strain'), &
                              values%number('densification_exponent'))
    history%plastic = .true.
    if (values%number('young') < law%plateau) then
      call fault_make(fault, 'plateau', "the foam yields above its Young's modulus", &
                      'plateaus are a hundredth of it or less: check the units')
    end if
  end subroutine crushable_foam_read

  !> Constants from plain numbers.
  pure function crushable_foam_init(plateau, poisson, hardening, densification, densified, &
                                    exponent) result(law)
    real(dp), intent(in) :: plateau        !! (stress)
    real(dp), intent(in) :: poisson        !! nu_p, from 0 to below 1/2
    real(dp), intent(in) :: hardening      !! g (stress)
    real(dp), intent(in) :: densification  !! d (stress)
    real(dp), intent(in) :: densified      !! e_D, > 0
    real(dp), intent(in) :: exponent       !! b, at least 1
    type(crushable_foam_t) :: law
    law%shape = 4.5_dp*(1.0_dp - 2.0_dp*poisson)/(1.0_dp + poisson)
    law%size = 1.0_dp + law%shape/9.0_dp
    law%plateau = plateau
    law%hardening = hardening
    law%densification = densification
    law%densified = densified
    law%exponent = exponent
  end function crushable_foam_init

  !> Yield stress (CF2) and its derivative (stress). Without densification the strain has no end.
  elemental subroutine crushable_foam_yield(law, strain, yield, slope)
    type(crushable_foam_t), intent(in) :: law
    real(dp), intent(in) :: strain         !! e
    real(dp), intent(out) :: yield, slope
    real(dp) :: part, within, power, steep
    part = max(strain, 0.0_dp)/law%densified
    yield = law%plateau + law%hardening*part
    slope = law%hardening/law%densified
    if (.not. law%densification > 0.0_dp) return
    within = min(part, closed)
    power = within**law%exponent
    steep = law%densification*law%exponent*within**(law%exponent - 1.0_dp)/(1.0_dp - power)
    yield = yield - law%densification*log(1.0_dp - power) + steep*(part - within)
    slope = slope + steep/law%densified
  end subroutine crushable_foam_yield

  !> Return of one trial stress to (CF1).
  pure subroutine crushable_foam_point(law, shear3, bulk, trial, strain, mean, norm)
    type(crushable_foam_t), intent(in) :: law
    real(dp), intent(in) :: shear3    !! three times the shear modulus (stress)
    real(dp), intent(in) :: bulk      !! bulk modulus (stress)
    real(dp), intent(in) :: trial     !! q*, von Mises stress of the trial stress (stress)
    real(dp), intent(inout) :: strain  !! e, updated
    real(dp), intent(inout) :: mean   !! s_m*, tension positive; returned (stress)
    real(dp), intent(out) :: norm     !! q after the step (stress)
    real(dp) :: low, high, flow, change, residual, slope, w
    logical :: newton
    integer :: k
    norm = trial
    flow = 0.0_dp
    call excess(law, shear3, bulk, trial, mean, strain, flow, residual, slope, w)
    if (.not. residual > 0.0_dp) return
    low = 0.0_dp
    high = law%size*residual/min(shear3, bulk*law%shape)
    do k = 1, most_trials
      change = high
      if (slope < 0.0_dp) change = -residual/slope
      newton = slope < 0.0_dp .and. flow + change >= low .and. flow + change <= high
      if (.not. newton) change = 0.5_dp*(low + high) - flow
      flow = flow + change
      if (abs(change) <= settled*law%densified) exit
      if (newton .and. abs(change) <= nearly_settled*flow) exit
      call excess(law, shear3, bulk, trial, mean, strain, flow, residual, slope, w)
      if (residual > 0.0_dp) low = flow
      if (residual < 0.0_dp) high = flow
    end do
    call excess(law, shear3, bulk, trial, mean, strain, flow, residual, slope, w)
    norm = trial/(1.0_dp + shear3*w)
    mean = mean/(1.0_dp + bulk*law%shape*w)
    strain = strain + flow
  end subroutine crushable_foam_point

  !> Left less right side of (CF1) with the stresses of (CF3) for a plastic strain of the step, its
  !! derivative by that, and w.
  pure subroutine excess(law, shear3, bulk, trial, mean, strain, flow, residual, slope, w)
    type(crushable_foam_t), intent(in) :: law
    real(dp), intent(in) :: shear3, bulk, trial, mean, strain
    real(dp), intent(in) :: flow      !! de
    real(dp), intent(out) :: residual, slope  !! (stress)
    real(dp), intent(out) :: w        !! (1/stress)
    real(dp) :: yield, hardens, grows, a, b, size
    call crushable_foam_yield(law, strain + flow, yield, hardens)
    w = flow/(law%size*yield)
    grows = (1.0_dp - flow*hardens/yield)/(law%size*yield)
    a = 1.0_dp + shear3*w
    b = 1.0_dp + bulk*law%shape*w
    size = sqrt(((trial/a)**2 + law%shape*(mean/b)**2)/law%size)
    residual = size - yield
    slope = -hardens
    if (size > 0.0_dp) then
      slope = slope - grows/(law%size*size)*(shear3*trial**2/a**3 &
                                             + bulk*law%shape**2*mean**2/b**3)
    end if
  end subroutine excess

  !> Lane kernel of crushable_foam_point.
  pure subroutine crushable_foam_return(law, elastic, trial, mean, strain, factor)
    type(crushable_foam_t), intent(in) :: law
    type(elastic_t), intent(in) :: elastic
    real(dp), intent(in) :: trial(lanes)       !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: mean(lanes)     !! of the trial stress; returned (stress)
    real(dp), intent(inout) :: strain(lanes)   !! e, updated
    real(dp), intent(out) :: factor(lanes)     !! scales the trial deviator
    real(dp) :: norm
    integer :: l
    factor = 1.0_dp
    do l = 1, lanes
      ! No foam yields below its plateau: most particles of a quiet scene need no more.
      if (.not. trial(l)**2 + law%shape*mean(l)**2 > law%size*law%plateau**2) cycle
      call crushable_foam_point(law, 3.0_dp*elastic%shear, elastic%bulk, trial(l), strain(l), &
                                mean(l), norm)
      if (trial(l) > 0.0_dp) factor(l) = norm/trial(l)
    end do
  end subroutine crushable_foam_return

end module sgmp_material_crushable_foam
