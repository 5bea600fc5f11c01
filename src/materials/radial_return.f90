!> Radial return on sigma_y = softening (yield + modulus ep^n) (1 + C ln(rate*)): solves, for the
!! increment dep of the equivalent plastic strain, the consistency condition
!!
!!     g(dep) = 3 G dep + sigma_y(ep + dep, dep/dt) - trial = 0                              (R1)
!!
!! (theory 4; Simo and Hughes, Computational Inelasticity, box 3.1). Stresses are von Mises norms.
!! Linear hardening has a closed form. Otherwise g is, in q = ln(dep), a convex increasing sum of
!! exponentials, so that Halley's iteration in q converges from the upper bounds on dep that each
!! term alone sets, also at ep = 0 with n < 1, where iterations in dep stall on the infinite slope.
!! A lane that has settled is frozen, so its bits do not depend on its neighbours, and the chunk
!! leaves when all have: without a step where all are elastic, usually after two.
!!
!! `radial_return_activated` is for thermally activated flow, with a power of the rate in place of
!! the logarithm, which is an exponential in q, too.
module sgmp_radial_return
  use sgmp_keys, only: key, key_t, kind_real
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: hardening_t, activated_t, hardening_keys
  public :: return_linear, return_factor, hardening_power_term
  public :: radial_return_linear, radial_return_power, radial_return_rate, radial_return_activated

  real(dp), parameter :: tiny_strain = 1.0e-30_dp  !! strains below count as zero
  real(dp), parameter :: threshold = 1.0e-15_dp    !! overstress/3G below which a lane is elastic
  real(dp), parameter :: benign = 1.0e-6_dp        !! overstress/3G that elastic lanes solve for
  real(dp), parameter :: settled = 2.0e-4_dp       !! last change of ln(dep); its cube/12 remains
  integer, parameter :: most_steps = 12            !! more than any state tried has needed
  integer, parameter :: most_activated_steps = 60  !! from far above where the rate hardly matters
  real(dp), parameter :: largest_log = 600.0_dp    !! exp of it is finite
  !> Least increment of activated flow: below, a lane is elastic.
  real(dp), parameter :: least_increment = 1.0e-30_dp

  !> What the return needs to know of a material.
  type :: hardening_t
    real(dp) :: shear3 = 0.0_dp            !! three times the shear modulus (stress)
    real(dp) :: yield = 0.0_dp             !! yield stress at ep = 0 (stress)
    real(dp) :: modulus = 0.0_dp           !! hardening modulus, >= 0 (stress)
    real(dp) :: exponent = 1.0_dp          !! n > 0
    real(dp) :: rate_coefficient = 0.0_dp  !! C >= 0
    real(dp) :: dep_reference = 1.0_dp     !! reference strain rate times dt, > 0
  end type hardening_t

  !> Thermally activated part (stress + hardening ep^(1/2)) (dep/dep_reference)^power of the yield
  !! stress of each lane.
  type :: activated_t
    real(dp) :: stress(lanes) = 0.0_dp     !! (stress)
    real(dp) :: hardening(lanes) = 0.0_dp  !! (stress)
    real(dp) :: power(lanes) = 0.0_dp      !! >= 0
  end type activated_t

contains

  !> Keys of yield stress and hardening.
  function hardening_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('yield', kind_real, 'initial yield stress (Johnson-Cook A, Zerilli-Armstrong C0)', &
                unit='stress', range='(0,inf)', required=.true.), &
            key('hardening_modulus', kind_real, &
                'slope, or factor of the power law (Johnson-Cook B, Zerilli-Armstrong C5)', &
                unit='stress', range='[0,inf)', default='0'), &
            key('hardening_exponent', kind_real, &
                'exponent of the power law (Johnson-Cook n)', range='(0,inf)', default='1')]
  end function hardening_keys

  !> Plastic increment for linear hardening (n = 1, C = 0), exact.
  pure function return_linear(law, softening, trial, ep) result(dep)
    type(hardening_t), intent(in) :: law  !! hardening
    real(dp), intent(in) :: softening     !! factor of the yield stress, in [0, 1]
    real(dp), intent(in) :: trial         !! von Mises norm of the trial deviator (stress)
    real(dp), intent(in) :: ep            !! equivalent plastic strain before the step
    real(dp) :: dep
    dep = trial - softening*(law%yield + law%modulus*ep)
    dep = dep/(law%shear3 + softening*law%modulus)
    dep = merge(dep, 0.0_dp, dep > 0.0_dp)
  end function return_linear

  !> Factor that scales the trial deviator after the increment dep, in [0, 1]; 1 where dep = 0.
  pure function return_factor(shear3, trial, dep) result(factor)
    real(dp), intent(in) :: shear3  !! three times the shear modulus (stress)
    real(dp), intent(in) :: trial   !! von Mises norm of the trial deviator (stress)
    real(dp), intent(in) :: dep     !! plastic increment
    real(dp) :: factor
    factor = 1.0_dp - shear3*dep/merge(trial, 1.0_dp, dep > 0.0_dp)
    factor = merge(factor, 0.0_dp, factor > 0.0_dp)
  end function return_factor

  !> ep**exponent for ep >= 0, with 0 for ep = 0.
  pure function hardening_power_term(ep, exponent) result(term)
    real(dp), intent(in) :: ep        !! strain
    real(dp), intent(in) :: exponent  !! n > 0
    real(dp) :: term
    ! A sum, not the greater of the two: the compiler would see that the merge makes the comparison
    ! needless, and log(0) is taken lane by lane.
    term = exp(exponent*log(ep + tiny_strain))
    term = merge(term, 0.0_dp, ep > tiny_strain)
  end function hardening_power_term

  !> Overstress to solve for: the given one, or a benign positive one where that is elastic.
  pure function overstress(shear3, excess) result(over)
    real(dp), intent(in) :: shear3, excess
    real(dp) :: over
    over = merge(excess, benign*shear3, excess > threshold*shear3)
  end function overstress

  !> Start from the tangent at ep, near where the increment is below ep.
  pure function start_tangent(law, over, hard, ep) result(dep)
    type(hardening_t), intent(in) :: law
    real(dp), intent(in) :: over, hard, ep
    real(dp) :: dep
    dep = over/(law%shear3 + law%exponent*hard/greater(ep, tiny_strain))
  end function start_tangent

  !> Start above ep: the lesser of the bounds that elasticity alone and hardening alone set.
  pure function start_bound(law, softening, over, hard, ep, tangent) result(dep)
    type(hardening_t), intent(in) :: law
    real(dp), intent(in) :: softening, over, hard, ep, tangent
    real(dp) :: dep
    real(dp) :: x
    x = log((over + hard)/greater(softening*law%modulus, tiny_strain*law%shear3))/law%exponent
    dep = lesser(over/law%shear3, exp(lesser(x, largest_log)) - ep)
    dep = merge(dep, tangent, dep > ep)
  end function start_bound

  !> Start with the rate factor, from the start without: the bound that it sets, then one step on
  !! the condition with linear hardening, over*(dep/start - 1) + slope ln(dep/dep_reference) = 0.
  pure function start_rate(over, slope, dep_reference, start) result(dep)
    real(dp), intent(in) :: over, slope, dep_reference, start
    real(dp) :: dep
    real(dp) :: q, rigid
    q = lesser(over/greater(slope, tiny_strain*over), largest_log)
    q = lesser(log(start/dep_reference), q)
    dep = dep_reference*exp(q)
    rigid = over*(dep/start)
    dep = dep*halley(rigid + slope*q - over, rigid + slope, rigid)
  end function start_rate

  !> Ratio by which one Halley step changes dep, without rate factor.
  pure function power_step(law, softening, over, hard, ep, dep) result(ratio)
    type(hardening_t), intent(in) :: law
    real(dp), intent(in) :: softening, over, hard, ep, dep
    real(dp) :: ratio
    real(dp) :: share, h, h1, elastic
    share = dep/(ep + dep)
    h = softening*law%modulus*exp(law%exponent*log(ep + dep))
    h1 = law%exponent*h*share
    elastic = law%shear3*dep
    ratio = halley(elastic + (h - hard) - over, elastic + h1, &
                   elastic + h1*(1.0_dp + (law%exponent - 1.0_dp)*share))
  end function power_step

  !> Ratio by which one Halley step changes dep, with the factor 1 + rate*ln(dep/dep_reference).
  pure function rate_step(law, softening, over, hard, rate, ep, dep) result(ratio)
    type(hardening_t), intent(in) :: law
    real(dp), intent(in) :: softening, over, hard, rate, ep, dep
    real(dp) :: ratio
    real(dp) :: share, h, h1, elastic, static, q, curvature
    q = rate*log(dep/law%dep_reference)
    share = dep/(ep + dep)
    h = softening*law%modulus*exp(law%exponent*log(ep + dep))
    h1 = law%exponent*h*share
    curvature = 1.0_dp + (law%exponent - 1.0_dp)*share
    elastic = law%shear3*dep
    static = softening*law%yield + h
    ratio = halley(elastic + (h - hard) + static*q - over, &
                   elastic + h1*(1.0_dp + q) + static*rate, &
                   elastic + h1*(curvature*(1.0_dp + q) + 2.0_dp*rate))
  end function rate_step

  !> Ratio by which one Halley step changes dep, with the activated part.
  pure function activated_step(law, softening, stress, root, power, over, hard, ep, dep) &
    result(ratio)
    type(hardening_t), intent(in) :: law
    real(dp), intent(in) :: softening
    real(dp), intent(in) :: stress, root, power  !! of activated_t, one lane
    real(dp), intent(in) :: over, hard, ep, dep
    real(dp) :: ratio
    real(dp) :: share, h, h1, elastic, rate, a, b, slope
    share = dep/(ep + dep)
    h = softening*law%modulus*exp(law%exponent*log(ep + dep))
    h1 = law%exponent*h*share
    rate = exp(power*log(dep/law%dep_reference))
    a = stress*rate
    b = root*sqrt(ep + dep)*rate
    slope = power + 0.5_dp*share
    elastic = law%shear3*dep
    ratio = halley(elastic + (h - hard) + a + b - over, elastic + h1 + a*power + b*slope, &
                   elastic + h1*(1.0_dp + (law%exponent - 1.0_dp)*share) + a*power**2 &
                   + b*(slope**2 + 0.5_dp*share*(1.0_dp - share)))
  end function activated_step

  !> Halley's step in q from g and its derivatives with respect to q, as exp(step) to the order of
  !! the step; |step| <= 3/2.
  pure function halley(g, g1, g2) result(ratio)
    real(dp), intent(in) :: g, g1, g2
    real(dp) :: ratio
    real(dp) :: above, below
    above = g*g1
    below = greater(g1*g1 - 0.5_dp*g*g2, 0.5_dp*g1*g1)
    above = greater(-1.5_dp*below, lesser(above, 1.5_dp*below))
    ratio = (2.0_dp*below - above)/(2.0_dp*below + above)
  end function halley

  !> The lesser of two numbers; a NaN in `a` gives `b`.
  pure function lesser(a, b) result(c)
    real(dp), intent(in) :: a, b
    real(dp) :: c
    c = merge(a, b, a < b)
  end function lesser

  !> The greater of two numbers; a NaN in `a` gives `b`.
  pure function greater(a, b) result(c)
    real(dp), intent(in) :: a, b
    real(dp) :: c
    c = merge(a, b, a > b)
  end function greater

  !> Lane kernel of return_linear.
  pure subroutine radial_return_linear(law, softening, trial, ep, factor, dep)
    type(hardening_t), intent(in) :: law      !! hardening
    real(dp), intent(in) :: softening(lanes)  !! factor of the yield stress, in [0, 1]
    real(dp), intent(in) :: trial(lanes)      !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: ep(lanes)      !! equivalent plastic strain, updated
    real(dp), intent(out) :: factor(lanes)    !! scales the trial deviator
    real(dp), intent(out) :: dep(lanes)       !! plastic increment
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      dep(p) = return_linear(law, softening(p), trial(p), ep(p))
      factor(p) = return_factor(law%shear3, trial(p), dep(p))
      ep(p) = ep(p) + dep(p)
    end do
  end subroutine radial_return_linear

  !> Lane kernel for power hardening (C = 0); (R1) to round-off for 0.05 <= n <= 2.
  pure subroutine radial_return_power(law, softening, trial, ep, factor, dep)
    type(hardening_t), intent(in) :: law                     !! hardening
    real(dp), intent(in) :: softening(lanes), trial(lanes)   !! as in radial_return_linear
    real(dp), intent(inout) :: ep(lanes)                     !! as in radial_return_linear
    real(dp), intent(out) :: factor(lanes), dep(lanes)       !! as in radial_return_linear
    real(dp), dimension(lanes) :: hard, over, plastic, moving, ratio, least
    integer :: k, p
    if (all_elastic(law, softening, trial)) then
      factor = 1.0_dp
      dep = 0.0_dp
      return
    end if
    call prepare_power(law, softening, trial, ep, hard, over, plastic, dep)
    moving = plastic
    least = 0.0_dp
    steps: do k = 1, most_steps
      if (.not. any(moving > 0.0_dp)) exit steps
      !$omp simd simdlen(8)
      do p = 1, lanes
        ratio(p) = power_step(law, softening(p), over(p), hard(p), ep(p), dep(p))
      end do
      call advance(ratio, least, dep, moving)
    end do steps
    call finish(law%shear3, trial, plastic, ep, factor, dep)
  end subroutine radial_return_power

  !> Lane kernel for power hardening with the factor 1 + C ln(max(1, dep/dep_reference)), implicit
  !! in dep.
  pure subroutine radial_return_rate(law, softening, trial, ep, factor, dep)
    type(hardening_t), intent(in) :: law                     !! hardening
    real(dp), intent(in) :: softening(lanes), trial(lanes)   !! as in radial_return_linear
    real(dp), intent(inout) :: ep(lanes)                     !! as in radial_return_linear
    real(dp), intent(out) :: factor(lanes), dep(lanes)       !! as in radial_return_linear
    real(dp), dimension(lanes) :: hard, over, plastic, moving, ratio, rate, least
    integer :: k, p
    if (all_elastic(law, softening, trial)) then
      factor = 1.0_dp
      dep = 0.0_dp
      return
    end if
    call prepare_power(law, softening, trial, ep, hard, over, plastic, dep)
    moving = plastic
    if (any(moving > 0.0_dp)) then
      call prepare_rate(law, softening, ep, hard, over, rate, least, dep)
    end if
    steps: do k = 1, most_steps
      if (.not. any(moving > 0.0_dp)) exit steps
      !$omp simd simdlen(8)
      do p = 1, lanes
        ratio(p) = rate_step(law, softening(p), over(p), hard(p), rate(p), ep(p), dep(p))
      end do
      call advance(ratio, least, dep, moving)
    end do steps
    call finish(law%shear3, trial, plastic, ep, factor, dep)
  end subroutine radial_return_rate

  !> Lane kernel for power hardening (C = 0) and a thermally activated part, implicit in dep.
  pure subroutine radial_return_activated(law, softening, activated, trial, ep, factor, dep)
    type(hardening_t), intent(in) :: law                 !! hardening
    real(dp), intent(in) :: softening(lanes)             !! factor of the other part
    type(activated_t), intent(in) :: activated           !! the activated part
    real(dp), intent(in) :: trial(lanes)                 !! as in radial_return_linear
    real(dp), intent(inout) :: ep(lanes)                 !! as in radial_return_linear
    real(dp), intent(out) :: factor(lanes), dep(lanes)   !! as in radial_return_linear
    real(dp), dimension(lanes) :: hard, over, plastic, moving, ratio, least
    integer :: k, p
    if (all_elastic(law, softening, trial)) then
      factor = 1.0_dp
      dep = 0.0_dp
      return
    end if
    call prepare_activated(law, softening, activated, trial, ep, hard, over, plastic, dep)
    moving = plastic
    least = least_increment
    steps: do k = 1, most_activated_steps
      if (.not. any(moving > 0.0_dp)) exit steps
      !$omp simd simdlen(8)
      do p = 1, lanes
        ratio(p) = activated_step(law, softening(p), activated%stress(p), activated%hardening(p), &
                                  activated%power(p), over(p), hard(p), ep(p), dep(p))
      end do
      call advance(ratio, least, dep, moving)
    end do steps
    call finish(law%shear3, trial, plastic, ep, factor, dep)
  end subroutine radial_return_activated

  !> Overstress to solve for, lanes that flow by more than the least increment, and the start: the
  !! lesser of the bounds that elasticity alone and the activated stress at ep alone set.
  pure subroutine prepare_activated(law, softening, activated, trial, ep, hard, over, plastic, dep)
    type(hardening_t), intent(in) :: law
    type(activated_t), intent(in) :: activated
    real(dp), dimension(lanes), intent(in) :: softening, trial, ep
    real(dp), dimension(lanes), intent(out) :: hard, over, plastic, dep
    real(dp) :: slowest, now, q
    integer :: p
    slowest = log(least_increment/law%dep_reference)
    !$omp simd simdlen(8) private(now, q)
    do p = 1, lanes
      hard(p) = softening(p)*law%modulus*hardening_power_term(ep(p), law%exponent)
      over(p) = trial(p) - softening(p)*law%yield - hard(p)
      now = activated%stress(p) + activated%hardening(p)*sqrt(ep(p))
      plastic(p) = merge(1.0_dp, 0.0_dp, &
                         over(p) - now*exp(activated%power(p)*slowest) > threshold*law%shear3)
      over(p) = overstress(law%shear3, over(p))
      q = log(over(p)/greater(now, tiny_strain*over(p)))/greater(activated%power(p), tiny_strain)
      q = greater(-largest_log, lesser(q, largest_log))
      dep(p) = greater(least_increment, &
                       lesser(law%dep_reference*exp(q), over(p)/law%shear3))
    end do
  end subroutine prepare_activated

  !> Whether every lane stays below the yield stress of the virgin material, whatever its hardening:
  !! most of a body mostly does, and needs no power then.
  pure function all_elastic(law, softening, trial) result(yes)
    type(hardening_t), intent(in) :: law
    real(dp), intent(in) :: softening(lanes), trial(lanes)
    logical :: yes
    real(dp) :: beyond
    integer :: p
    beyond = 0.0_dp
    !$omp simd simdlen(8) reduction(+:beyond)
    do p = 1, lanes
      beyond = beyond + merge(1.0_dp, 0.0_dp, &
                              trial(p) - softening(p)*law%yield > threshold*law%shear3)
    end do
    yes = beyond < 0.5_dp
  end function all_elastic

  !> Static part: hardening at ep, overstress to solve for, lanes to iterate, start.
  pure subroutine prepare_power(law, softening, trial, ep, hard, over, plastic, dep)
    type(hardening_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: softening, trial, ep
    real(dp), intent(out) :: hard(lanes)     !! softening*modulus*ep**n
    real(dp), intent(out) :: over(lanes)     !! overstress to solve for
    real(dp), intent(out) :: plastic(lanes)  !! 1 where plastic, else 0
    real(dp), intent(out) :: dep(lanes)      !! start
    real(dp) :: far(lanes)
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      hard(p) = softening(p)*law%modulus*hardening_power_term(ep(p), law%exponent)
      over(p) = trial(p) - softening(p)*law%yield - hard(p)
      plastic(p) = merge(1.0_dp, 0.0_dp, over(p) > threshold*law%shear3)
      over(p) = overstress(law%shear3, over(p))
      dep(p) = start_tangent(law, over(p), hard(p), ep(p))
      far(p) = plastic(p)*(over(p) - law%shear3*ep(p))
    end do
    if (any(far > 0.0_dp)) then  ! elsewhere start_bound would return the tangent
      !$omp simd simdlen(8)
      do p = 1, lanes
        dep(p) = start_bound(law, softening(p), over(p), hard(p), ep(p), dep(p))
      end do
    end if
  end subroutine prepare_power

  !> Side of the kink of the rate factor on which the root lies, told by the sign of (R1) there, and
  !! the start on that side, where the condition is smooth.
  pure subroutine prepare_rate(law, softening, ep, hard, over, rate, least, dep)
    type(hardening_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: softening, ep, hard, over
    real(dp), intent(out) :: rate(lanes)     !! C above the kink, 0 below
    real(dp), intent(out) :: least(lanes)    !! least possible dep
    real(dp), intent(inout) :: dep(lanes)    !! start without rate factor; start with
    real(dp) :: above(lanes)
    integer :: p
    call find_side(law, softening, ep, hard, over, above)
    !$omp simd simdlen(8)
    do p = 1, lanes
      rate(p) = above(p)*law%rate_coefficient
      least(p) = above(p)*law%dep_reference
      dep(p) = start_rate(over(p), rate(p)*(softening(p)*law%yield + hard(p)), &
                          law%dep_reference, dep(p))
      dep(p) = greater(least(p), dep(p))
    end do
  end subroutine prepare_rate

  !> Whether the root lies above the kink of the rate factor: 1 or 0.
  !!
  !! The condition at the kink is below its tangent from ep where n <= 1; only where the tangent
  !! leaves doubt is its power needed.
  pure subroutine find_side(law, softening, ep, hard, over, above)
    type(hardening_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: softening, ep, hard, over
    real(dp), intent(out) :: above(lanes)
    real(dp) :: kink, sure
    integer :: p
    sure = 0.0_dp
    !$omp simd simdlen(8) private(kink) reduction(+:sure)
    do p = 1, lanes
      kink = law%dep_reference*(law%shear3 + law%exponent*hard(p)/greater(ep(p), tiny_strain))
      above(p) = merge(1.0_dp, 0.0_dp, 2.0_dp*kink < over(p))
      sure = sure + above(p)*merge(1.0_dp, 0.0_dp, ep(p) > tiny_strain)
    end do
    if (sure > lanes - 0.5_dp .and. law%exponent <= 1.0_dp) return
    !$omp simd simdlen(8) private(kink)
    do p = 1, lanes
      kink = hardening_power_term(ep(p) + law%dep_reference, law%exponent)
      kink = law%shear3*law%dep_reference + softening(p)*law%modulus*kink - hard(p)
      ! a number: several merges on one condition would become a branch
      above(p) = merge(1.0_dp, 0.0_dp, kink < over(p))
    end do
  end subroutine find_side

  !> Applies a step to the lanes that still move, and stops those that it hardly moved.
  pure subroutine advance(ratio, least, dep, moving)
    real(dp), dimension(lanes), intent(in) :: ratio, least
    real(dp), dimension(lanes), intent(inout) :: dep, moving
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      dep(p) = greater(least(p), dep(p) + moving(p)*(ratio(p)*dep(p) - dep(p)))
      moving(p) = moving(p)*merge(1.0_dp, 0.0_dp, abs(ratio(p) - 1.0_dp) > settled)
    end do
  end subroutine advance

  !> Sets dep to zero in elastic lanes, updates ep.
  pure subroutine finish(shear3, trial, plastic, ep, factor, dep)
    real(dp), intent(in) :: shear3
    real(dp), dimension(lanes), intent(in) :: trial, plastic
    real(dp), dimension(lanes), intent(inout) :: ep, dep
    real(dp), dimension(lanes), intent(out) :: factor
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      dep(p) = dep(p)*plastic(p)
      factor(p) = return_factor(shear3, trial(p), dep(p))
      ep(p) = ep(p) + dep(p)
    end do
  end subroutine finish

end module sgmp_radial_return
