!> Radial return on sigma_y = (yield + modulus ep^n) (1 + rate_coefficient ln(rate*)): solves, for the increment dep of the
!! equivalent plastic strain, the consistency condition
!!
!!     g(dep) = 3 G dep + sigma_y(ep + dep, dep/dt) - trial = 0                                            (R1)
!!
!! (METHOD 5; Simo and Hughes, Computational Inelasticity, box 3.1). Stresses are von Mises norms. Linear hardening has a
!! closed form. Otherwise g is, in q = ln(dep), a convex increasing sum of exponentials, so that Halley's iteration in q
!! converges from the upper bounds on dep that each term alone sets, also at ep = 0 with n < 1, where iterations in dep stall
!! on the infinite slope. A lane that has settled is frozen, so its bits do not depend on its neighbours, and the chunk leaves
!! when all have: none where all are elastic, usually two steps.
module sgmp_radial_return
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: return_linear, return_factor, hardening_power_term
  public :: radial_return_linear, radial_return_power, radial_return_rate

  real(dp), parameter :: tiny_strain = 1.0e-30_dp  !! strains below count as zero
  real(dp), parameter :: threshold = 1.0e-15_dp    !! overstress below threshold*3G counts as elastic
  real(dp), parameter :: benign = 1.0e-6_dp        !! overstress/3G that elastic lanes solve for and discard
  real(dp), parameter :: settled = 2.0e-4_dp       !! last change of ln(dep); what remains is about its cube over 12
  integer, parameter :: most_steps = 12            !! of the iteration; more than any state tried has needed
  real(dp), parameter :: largest_log = 600.0_dp    !! exp of it is finite

contains

  !> Plastic increment for yield + modulus*ep, exact.
  pure function return_linear(shear3, trial, yield, modulus, ep) result(dep)
    real(dp), intent(in) :: shear3  !! three times the shear modulus (stress)
    real(dp), intent(in) :: trial   !! von Mises norm of the trial deviator (stress)
    real(dp), intent(in) :: yield   !! yield stress at ep = 0 (stress)
    real(dp), intent(in) :: modulus !! hardening modulus (stress)
    real(dp), intent(in) :: ep      !! equivalent plastic strain before the step
    real(dp) :: dep
    dep = (trial - (yield + modulus*ep))/(shear3 + modulus)
    dep = merge(dep, 0.0_dp, dep > 0.0_dp)
  end function return_linear

  !> Factor that scales the trial deviator after the increment dep, in [0, 1]; 1 where dep = 0.
  pure function return_factor(shear3, trial, dep) result(factor)
    real(dp), intent(in) :: shear3, trial, dep !! as in return_linear
    real(dp) :: factor
    factor = 1.0_dp - shear3*dep/merge(trial, 1.0_dp, dep > 0.0_dp)
    factor = merge(factor, 0.0_dp, factor > 0.0_dp)
  end function return_factor

  !> ep**exponent for ep >= 0, with 0 for ep = 0.
  pure function hardening_power_term(ep, exponent) result(term)
    real(dp), intent(in) :: ep, exponent !! strain, n > 0
    real(dp) :: term
    term = exp(exponent*log(greater(ep, tiny_strain))) ! before the merge: a call inside it would branch
    term = merge(term, 0.0_dp, ep > tiny_strain)
  end function hardening_power_term

  !> Overstress to solve for: the given one, or a benign positive one for lanes that stay elastic.
  pure function overstress(shear3, excess) result(over)
    real(dp), intent(in) :: shear3, excess !! 3 G, trial stress minus yield stress (stress)
    real(dp) :: over
    over = merge(excess, benign*shear3, excess > threshold*shear3)
  end function overstress

  !> Start from the tangent at ep, near where the increment is below ep.
  pure function start_tangent(shear3, over, hard, exponent, ep) result(dep)
    real(dp), intent(in) :: shear3, over, hard, exponent, ep
    real(dp) :: dep
    dep = over/(shear3 + exponent*hard/greater(ep, tiny_strain))
  end function start_tangent

  !> Start for increments above ep: the lesser of the bounds that elasticity alone and hardening alone set.
  pure function start_bound(shear3, over, hard, modulus, exponent, ep, tangent) result(dep)
    real(dp), intent(in) :: shear3, over, hard, modulus, exponent, ep, tangent
    real(dp) :: dep
    real(dp) :: x
    x = log((over + hard)/greater(modulus, tiny_strain*shear3))/exponent
    dep = lesser(over/shear3, exp(lesser(x, largest_log)) - ep)
    dep = merge(dep, tangent, dep > ep)
  end function start_bound

  !> Start with the rate factor, from the start without: the bound that it sets, then one step on the condition with the
  !! hardening taken as linear, over*(dep/start - 1) + rate ln(dep/dep_reference) = 0.
  pure function start_rate(over, rate, dep_reference, start) result(dep)
    real(dp), intent(in) :: over, rate, dep_reference, start
    real(dp) :: dep
    real(dp) :: q, rigid
    q = over/greater(rate, tiny_strain*over)
    dep = lesser(start, dep_reference*exp(lesser(q, largest_log)))
    rigid = over*(dep/start)
    dep = dep*halley(rigid + rate*log(dep/dep_reference) - over, rigid + rate, rigid)
  end function start_rate

  !> Ratio by which one Halley step changes dep, without rate factor.
  pure function power_step(shear3, over, hard, modulus, exponent, ep, dep) result(ratio)
    real(dp), intent(in) :: shear3, over, hard, modulus, exponent, ep, dep
    real(dp) :: ratio
    real(dp) :: curvature, h, h1, elastic
    curvature = 1.0_dp + (exponent - 1.0_dp)*(dep/(ep + dep))
    h = modulus*exp(exponent*log(ep + dep))
    elastic = shear3*dep
    h1 = exponent*h*(dep/(ep + dep))
    ratio = halley(elastic + (h - hard) - over, elastic + h1, elastic + h1*curvature)
  end function power_step

  !> Ratio by which one Halley step changes dep, with the rate factor 1 + rate*ln(dep/dep_reference).
  pure function rate_step(shear3, over, hard, yield, modulus, exponent, rate, dep_reference, ep, dep) result(ratio)
    real(dp), intent(in) :: shear3, over, hard, yield, modulus, exponent, rate, dep_reference, ep, dep
    real(dp) :: ratio
    real(dp) :: curvature, h, h1, elastic, q, factor
    q = rate*log(dep/dep_reference)
    factor = 1.0_dp + q
    curvature = 1.0_dp + (exponent - 1.0_dp)*(dep/(ep + dep))
    h = modulus*exp(exponent*log(ep + dep))
    elastic = shear3*dep
    h1 = exponent*h*(dep/(ep + dep))
    ratio = halley(elastic + (h - hard) + (yield + h)*q - over, elastic + h1*factor + (yield + h)*rate, &
                   elastic + h1*(curvature*factor + 2.0_dp*rate))
  end function rate_step

  !> Halley's step in q from g and its derivatives with respect to q, as exp(step) to the order of the step; |step| <= 3/2.
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

  !> Lane kernel of return_linear with yield and modulus scaled by `softening`.
  pure subroutine radial_return_linear(shear3, yield, modulus, softening, trial, ep, factor, dep)
    real(dp), intent(in) :: shear3, yield, modulus !! as in return_linear
    real(dp), intent(in) :: softening(lanes)       !! thermal factor in [0, 1]
    real(dp), intent(in) :: trial(lanes)           !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: ep(lanes)           !! equivalent plastic strain, updated
    real(dp), intent(out) :: factor(lanes)         !! scales the trial deviator
    real(dp), intent(out) :: dep(lanes)            !! plastic strain increment
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      dep(p) = return_linear(shear3, trial(p), softening(p)*yield, softening(p)*modulus, ep(p))
      factor(p) = return_factor(shear3, trial(p), dep(p))
      ep(p) = ep(p) + dep(p)
    end do
  end subroutine radial_return_linear

  !> Lane kernel for yield + modulus*ep**exponent, both scaled by `softening`; (R1) to round-off for 0.05 <= exponent <= 2.
  pure subroutine radial_return_power(shear3, yield, modulus, exponent, softening, trial, ep, factor, dep)
    real(dp), intent(in) :: shear3, yield, modulus         !! as in return_linear
    real(dp), intent(in) :: exponent                       !! n > 0
    real(dp), intent(in) :: softening(lanes), trial(lanes) !! as in radial_return_linear
    real(dp), intent(inout) :: ep(lanes)                   !! equivalent plastic strain, updated
    real(dp), intent(out) :: factor(lanes), dep(lanes)     !! as in radial_return_linear
    real(dp) :: hard(lanes), over(lanes), plastic(lanes), moving(lanes), ratio(lanes), least(lanes)
    integer :: k, p
    call prepare_power(shear3, yield, modulus, exponent, softening, trial, ep, hard, over, plastic, dep)
    moving = plastic
    least = 0.0_dp
    do k = 1, most_steps
      if (.not. any(moving > 0.0_dp)) exit
      !$omp simd simdlen(8)
      do p = 1, lanes
        ratio(p) = power_step(shear3, over(p), hard(p), softening(p)*modulus, exponent, ep(p), dep(p))
      end do
      call advance(ratio, least, dep, moving)
    end do
    call finish(shear3, trial, plastic, ep, factor, dep)
  end subroutine radial_return_power

  !> Lane kernel with the rate factor 1 + rate_coefficient*ln(max(1, dep/dep_reference)), implicit in dep.
  pure subroutine radial_return_rate(shear3, yield, modulus, exponent, rate_coefficient, dep_reference, softening, trial, &
                                     ep, factor, dep)
    real(dp), intent(in) :: shear3, yield, modulus, exponent !! as in radial_return_power
    real(dp), intent(in) :: rate_coefficient                 !! C >= 0
    real(dp), intent(in) :: dep_reference                    !! reference rate times dt, > 0
    real(dp), intent(in) :: softening(lanes), trial(lanes)   !! as in radial_return_linear
    real(dp), intent(inout) :: ep(lanes)                     !! equivalent plastic strain, updated
    real(dp), intent(out) :: factor(lanes), dep(lanes)       !! as in radial_return_linear
    real(dp) :: hard(lanes), over(lanes), plastic(lanes), moving(lanes), ratio(lanes), rate(lanes), least(lanes)
    integer :: k, p
    call prepare_power(shear3, yield, modulus, exponent, softening, trial, ep, hard, over, plastic, dep)
    moving = plastic
    if (any(moving > 0.0_dp)) then
      call prepare_rate(shear3, yield, modulus, exponent, rate_coefficient, dep_reference, softening, ep, hard, over, &
                        rate, least, dep)
    end if
    do k = 1, most_steps
      if (.not. any(moving > 0.0_dp)) exit
      !$omp simd simdlen(8)
      do p = 1, lanes
        ratio(p) = rate_step(shear3, over(p), hard(p), softening(p)*yield, softening(p)*modulus, exponent, rate(p), &
                          dep_reference, ep(p), dep(p))
      end do
      call advance(ratio, least, dep, moving)
    end do
    call finish(shear3, trial, plastic, ep, factor, dep)
  end subroutine radial_return_rate

  !> Static part of the power-law returns: hardening at ep, overstress to solve for, lanes to iterate, start.
  pure subroutine prepare_power(shear3, yield, modulus, exponent, softening, trial, ep, hard, over, plastic, dep)
    real(dp), intent(in) :: shear3, yield, modulus, exponent, softening(lanes), trial(lanes), ep(lanes)
    real(dp), intent(out) :: hard(lanes)   !! modulus*ep**exponent, softened
    real(dp), intent(out) :: over(lanes)   !! overstress to solve for
    real(dp), intent(out) :: plastic(lanes) !! 1 where plastic, else 0
    real(dp), intent(out) :: dep(lanes)    !! start
    real(dp) :: far(lanes)
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      hard(p) = softening(p)*modulus*hardening_power_term(ep(p), exponent)
      over(p) = trial(p) - softening(p)*yield - hard(p)
      plastic(p) = merge(1.0_dp, 0.0_dp, over(p) > threshold*shear3)
      over(p) = overstress(shear3, over(p))
      dep(p) = start_tangent(shear3, over(p), hard(p), exponent, ep(p))
      far(p) = plastic(p)*(over(p) - shear3*ep(p))
    end do
    if (any(far > 0.0_dp)) then ! elsewhere start_bound would return the tangent
      !$omp simd simdlen(8)
      do p = 1, lanes
        dep(p) = start_bound(shear3, over(p), hard(p), softening(p)*modulus, exponent, ep(p), dep(p))
      end do
    end if
  end subroutine prepare_power

  !> Side of the kink of the rate factor on which the root lies, told by the sign of (R1) there, and the start on that side,
  !! where the condition is smooth.
  pure subroutine prepare_rate(shear3, yield, modulus, exponent, rate_coefficient, dep_reference, softening, ep, hard, over, &
                               rate, least, dep)
    real(dp), intent(in) :: shear3, yield, modulus, exponent, rate_coefficient, dep_reference
    real(dp), intent(in) :: softening(lanes), ep(lanes), hard(lanes), over(lanes)
    real(dp), intent(out) :: rate(lanes)    !! rate_coefficient above the kink, 0 below
    real(dp), intent(out) :: least(lanes)   !! least possible dep: dep_reference above the kink, 0 below
    real(dp), intent(inout) :: dep(lanes)   !! start without rate factor; start with
    real(dp) :: kink
    integer :: p
    !$omp simd simdlen(8) private(kink)
    do p = 1, lanes
      kink = shear3*dep_reference + softening(p)*modulus*hardening_power_term(ep(p) + dep_reference, exponent) - hard(p)
      kink = merge(1.0_dp, 0.0_dp, kink < over(p)) ! a number: several merges on one condition would become a branch
      rate(p) = kink*rate_coefficient
      least(p) = kink*dep_reference
      dep(p) = start_rate(over(p), rate(p)*(softening(p)*yield + hard(p)), dep_reference, dep(p))
      dep(p) = greater(least(p), dep(p))
    end do
  end subroutine prepare_rate

  !> Applies a step to the lanes that still move, and stops those that it hardly moved.
  pure subroutine advance(ratio, least, dep, moving)
    real(dp), intent(in) :: ratio(lanes), least(lanes)
    real(dp), intent(inout) :: dep(lanes), moving(lanes)
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      dep(p) = greater(least(p), dep(p) + moving(p)*(ratio(p)*dep(p) - dep(p)))
      moving(p) = moving(p)*merge(1.0_dp, 0.0_dp, abs(ratio(p) - 1.0_dp) > settled)
    end do
  end subroutine advance

  !> Sets dep to zero in elastic lanes, updates ep.
  pure subroutine finish(shear3, trial, plastic, ep, factor, dep)
    real(dp), intent(in) :: shear3, trial(lanes), plastic(lanes)
    real(dp), intent(inout) :: ep(lanes), dep(lanes)
    real(dp), intent(out) :: factor(lanes)
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      dep(p) = dep(p)*plastic(p)
      factor(p) = return_factor(shear3, trial(p), dep(p))
      ep(p) = ep(p) + dep(p)
    end do
  end subroutine finish

end module sgmp_radial_return
