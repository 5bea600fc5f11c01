!> Softening: matter that has met a criterion of failure loses its strength little by little, so
!! that a crack takes a given energy per area whatever the size of the cells (theory 4).
!!
!! Damage D scales the deviator and the tension of what undamaged matter would carry (strain
!! equivalence: (1 - D) sigma), compression stays whole, so a crack closes. With r the largest of
!! mean stress/-pmin and principal stress/principal_stress, both of undamaged matter,
!!
!!     1 - D = (R - r)/(r (R - 1)),   1 <= r <= R                                      (F1)
!!     R     = 2 Gc M/(L s^2)                                                          (F2)
!!
!! and the stress falls along a line as the crack opens (Hillerborg 1976). L is the width of the
!! band in which strain localises (crack band, Bazant and Oh 1983), a cell or two (method_band), s
!! the limit, M the modulus K + 4/3 G across the crack, K for the mean stress. Beyond the plastic
!! strain e of its criterion
!!
!!     D = (ep - e) L yield(e)/(2 Gc)                                                  (F3)
!!
!! D does not fall again. A band wider than 2 Gc M/s^2 would have to give back energy:
!! R is above 1. Where cells are unequal the band is as wide as they are along the tension.
module sgmp_softening
  use sgmp_failure, only: failure_none, failure_t, largest_principal_stress
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: softening_t, softening_make, softening_widest
  public :: softening_regain, softening_damage, softening_left, softening_width

  integer, parameter :: components = 6           !! of a stress in space
  real(dp), parameter :: nothing_left = 1.0e-6_dp  !! of the strength: it has failed

  !> How far matter opens from a limit until nothing is left.
  type :: softening_t
    real(dp) :: mean = 0.0_dp, principal = 0.0_dp  !! R of (F2)
    real(dp) :: plastic = 0.0_dp                   !! plastic strain beyond that of the criterion
  end type softening_t

contains

  !> Softening of a law in bands of some width.
  pure function softening_make(law, bulk, shear, yield, width) result(softening)
    type(failure_t), intent(in) :: law
    real(dp), intent(in) :: bulk, shear          !! moduli (stress)
    real(dp), intent(in) :: yield                !! at the plastic strain of the criterion (stress)
    real(dp), intent(in) :: width                !! (length)
    type(softening_t) :: softening
    real(dp) :: twice
    twice = 2.0_dp*law%fracture_energy/width
    if (law%tension < failure_none) softening%mean = twice*bulk/law%tension**2
    if (law%principal_stress < failure_none) then
      softening%principal = twice*(bulk + 4.0_dp/3.0_dp*shear)/law%principal_stress**2
    end if
    if (law%plastic_strain < failure_none) softening%plastic = twice/yield
  end function softening_make

  !> Width of the widest band that can soften (length).
  pure function softening_widest(law, bulk, shear) result(width)
    type(failure_t), intent(in) :: law
    real(dp), intent(in) :: bulk, shear          !! moduli (stress)
    real(dp) :: width
    width = huge(1.0_dp)
    if (law%tension < failure_none) then
      width = min(width, 2.0_dp*law%fracture_energy*bulk/law%tension**2)
    end if
    if (law%principal_stress < failure_none) then
      width = min(width, 2.0_dp*law%fracture_energy*(bulk + 4.0_dp/3.0_dp*shear) &
                         /law%principal_stress**2)
    end if
  end function softening_widest

  !> Part of the strength that is left at a stretch r, of reach R (F1).
  pure elemental function softening_left(r, reach) result(left)
    real(dp), intent(in) :: r, reach
    real(dp) :: left
    left = 1.0_dp
    if (r <= 1.0_dp) return
    left = 0.0_dp
    if (r < reach) left = (reach - r)/(r*(reach - 1.0_dp))
  end function softening_left

  !> Lane kernel: the deviator that undamaged matter would carry, and what of it there is.
  pure subroutine softening_regain(n, damage, stress, left)
    integer, intent(in) :: n                     !! components stored
    real(dp), intent(in) :: damage(lanes)
    real(dp), intent(inout) :: stress(lanes, n)
    real(dp), intent(out) :: left(lanes)         !! part of the strength, 0 where it has failed
    real(dp) :: mean, gain
    integer :: l
    do l = 1, lanes
      left(l) = 1.0_dp - damage(l)
      gain = 0.0_dp
      if (left(l) > 0.0_dp) gain = 1.0_dp/left(l)
      mean = sum(stress(l, :3))*(1.0_dp/3.0_dp)
      stress(l, :3) = mean + gain*(stress(l, :3) - mean)
      stress(l, 4:) = gain*stress(l, 4:)
    end do
  end subroutine softening_regain

  !> Lane kernel: width of the cells across a crack: the mean of their sides along the axes, each
  !! weighted by the tension along it; without any, as in a band of shear, of all.
  pure function softening_width(cells, stress) result(width)
    real(dp), intent(in) :: cells(lanes, 3)            !! sides along the axes
    real(dp), intent(in) :: stress(lanes, components)  !! in Voigt's order
    real(dp) :: width(lanes)
    real(dp) :: pull(3)
    integer :: l
    do l = 1, lanes
      pull = max(stress(l, :3), 0.0_dp)
      if (.not. any(pull > 0.0_dp)) pull = 1.0_dp
      width(l) = sum(cells(l, :)*pull)/sum(pull)
    end do
  end function softening_width

  !> Lane kernel: damage of what undamaged matter would carry, which `strength` multiplies the
  !! limits of.
  pure subroutine softening_damage(law, softening, stress, plastic_strain, strength, width, &
                                   damage)
    type(failure_t), intent(in) :: law
    type(softening_t), intent(in) :: softening
    real(dp), intent(in) :: stress(lanes, components)  !! in Voigt's order
    real(dp), intent(in) :: plastic_strain(lanes)      !! equivalent
    real(dp), intent(in) :: strength(lanes)
    real(dp), intent(in) :: width(lanes)               !! of the band, over that of `softening`
    real(dp), intent(inout) :: damage(lanes)
    real(dp) :: left, weaker
    integer :: l
    do l = 1, lanes
      left = 1.0_dp - damage(l)
      weaker = 1.0_dp/strength(l)
      if (law%tension < failure_none) then
        left = min(left, softening_left(weaker*sum(stress(l, :3))/(3.0_dp*law%tension), &
                                        weaker**2*softening%mean/width(l)))
      end if
      if (law%principal_stress < failure_none) then
        left = min(left, softening_left(weaker*largest_principal_stress(stress(l, :)) &
                                        /law%principal_stress, &
                                        weaker**2*softening%principal/width(l)))
      end if
      if (law%plastic_strain < failure_none) then
        left = min(left, 1.0_dp - (plastic_strain(l) - strength(l)*law%plastic_strain) &
                                  *width(l)/softening%plastic)
      end if
      damage(l) = merge(1.0_dp - left, 1.0_dp, left > nothing_left)
    end do
  end subroutine softening_damage

end module sgmp_softening
