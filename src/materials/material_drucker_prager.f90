!> Drucker and Prager's plasticity for soils and rocks (1952), with dilatancy and a cap on tension
!! (theory 4). With q the von Mises stress and s_m the mean stress, tension positive:
!!
!!     q + M s_m <= k,   s_m <= tension <= k/M                                          (D1)
!!     M = 6 sin(phi)/(3 - sin(phi)),  k = 6 c cos(phi)/(3 - sin(phi))                  (D2)
!!
!! which meets Mohr and Coulomb's friction angle phi and cohesion c in triaxial compression. Plastic
!! strain follows the potential q + M_psi s_m, M_psi as M from the angle of dilatancy. The return is
!! exact for constant moduli: to the cone along (3 G, K M_psi), else to the edge or the face of the
!! cap, the apex being the cap of the largest tension.
module sgmp_material_drucker_prager
  use sgmp_keys, only: fault_t, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  use sgmp_soil, only: degree, soil_check
  implicit none
  private
  public :: drucker_prager_read
  public :: drucker_prager_t, drucker_prager_init, drucker_prager_point, drucker_prager_return, &
            drucker_prager_shear

  !> Constants of (D1).
  type :: drucker_prager_t
    real(dp) :: friction = 0.0_dp    !! M
    real(dp) :: dilatancy = 0.0_dp   !! M_psi
    real(dp) :: cohesion = 0.0_dp    !! k (stress)
    real(dp) :: tension = 0.0_dp     !! largest mean stress (stress)
    real(dp) :: edge = 0.0_dp        !! q where the cap meets the cone (stress)
  end type drucker_prager_t

contains

  !> Law from the values of its keys.
  pure subroutine drucker_prager_read(values, law, history, fault)
    class(values_t), intent(in) :: values
    type(drucker_prager_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    law = drucker_prager_init(values%number('friction'), values%number('cohesion'), &
                              values%number('dilatancy'), values%number('tension', huge(1.0_dp)))
    history%plastic = .true.
    call soil_check(values, fault)
  end subroutine drucker_prager_read

  !> Constants from plain numbers; a tension beyond the apex is the apex.
  pure function drucker_prager_init(friction, cohesion, dilatancy, tension) result(law)
    real(dp), intent(in) :: friction   !! phi (degrees), > 0
    real(dp), intent(in) :: cohesion   !! c (stress)
    real(dp), intent(in) :: dilatancy  !! psi (degrees)
    real(dp), intent(in) :: tension    !! largest mean stress (stress)
    type(drucker_prager_t) :: law
    law%friction = slope(friction)
    law%dilatancy = slope(dilatancy)
    law%cohesion = 6.0_dp*cohesion*cos(degree*friction)/(3.0_dp - sin(degree*friction))
    law%tension = min(tension, law%cohesion/law%friction)
    law%edge = max(0.0_dp, law%cohesion - law%friction*law%tension)
  end function drucker_prager_init

  !> M of an angle, (D2).
  pure function slope(angle) result(m)
    real(dp), intent(in) :: angle  !! (degrees)
    real(dp) :: m
    m = 6.0_dp*sin(degree*angle)/(3.0_dp - sin(degree*angle))
  end function slope

  !> Return of one trial stress.
  pure subroutine drucker_prager_point(law, shear3, bulk, trial, mean, factor, dep, opened)
    type(drucker_prager_t), intent(in) :: law
    real(dp), intent(in) :: shear3    !! three times the shear modulus (stress)
    real(dp), intent(in) :: bulk      !! bulk modulus (stress)
    real(dp), intent(in) :: trial     !! von Mises stress of the trial stress (stress)
    real(dp), intent(inout) :: mean   !! its mean, tension positive; returned (stress)
    real(dp), intent(out) :: factor   !! scales the trial deviator
    real(dp), intent(out) :: dep      !! increment of the equivalent plastic shear strain
    real(dp), intent(out) :: opened   !! by which grains come apart, see soil_matter
    real(dp) :: q, excess
    excess = trial + law%friction*mean - law%cohesion
    excess = merge(excess, 0.0_dp, excess > 0.0_dp)/(shear3 + bulk*law%friction*law%dilatancy)
    q = trial - shear3*excess
    mean = mean - bulk*law%dilatancy*excess
    ! What lies behind the apex is beyond the cap, too.
    q = merge(merge(trial, law%edge, trial < law%edge), q, mean > law%tension)
    opened = merge(mean - law%tension, 0.0_dp, mean > law%tension)/bulk
    mean = merge(law%tension, mean, mean > law%tension)
    factor = q/merge(trial, 1.0_dp, trial > 0.0_dp)
    factor = merge(factor, 1.0_dp, trial > 0.0_dp)
    dep = (trial - q)/shear3
  end subroutine drucker_prager_point

  !> Lane kernel of drucker_prager_point.
  pure subroutine drucker_prager_return(law, shear3, bulk, trial, mean, ep, factor, opened)
    type(drucker_prager_t), intent(in) :: law
    real(dp), intent(in) :: shear3, bulk, trial(lanes)       !! as in the point function
    real(dp), intent(inout) :: mean(lanes), ep(lanes)        !! ep: plastic shear strain, updated
    real(dp), intent(out) :: factor(lanes), opened(lanes)    !! as in the point function
    real(dp) :: dep
    integer :: p
    !$omp simd simdlen(8) private(dep)
    do p = 1, lanes
      call drucker_prager_point(law, shear3, bulk, trial(p), mean(p), factor(p), dep, opened(p))
      ep(p) = ep(p) + dep
    end do
  end subroutine drucker_prager_return

  !> Return to the cone (D1) at a mean stress that an equation of state gives: of q alone, without
  !! dilatancy.
  pure subroutine drucker_prager_shear(law, shear3, mean, trial, ep, factor)
    type(drucker_prager_t), intent(in) :: law
    real(dp), intent(in) :: shear3, mean(lanes), trial(lanes)  !! as in drucker_prager_point
    real(dp), intent(inout) :: ep(lanes)         !! plastic shear strain, updated
    real(dp), intent(out) :: factor(lanes)       !! scales the trial deviator
    real(dp) :: q
    integer :: p
    !$omp simd simdlen(8) private(q)
    do p = 1, lanes
      q = min(trial(p), max(0.0_dp, law%cohesion - law%friction*mean(p)))
      factor(p) = q/merge(trial(p), 1.0_dp, trial(p) > 0.0_dp)
      ep(p) = ep(p) + (trial(p) - q)/shear3
    end do
  end subroutine drucker_prager_shear

end module sgmp_material_drucker_prager
