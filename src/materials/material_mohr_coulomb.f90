!> Mohr and Coulomb's plasticity for soils and rocks, with dilatancy and a cut-off of tension
!! (theory 4). With s1 >= s2 >= s3 the principal stresses, tension positive:
!!
!!     (1 + sin(phi)) s1 - (1 - sin(phi)) s3 <= 2 c cos(phi),   s1 <= tension           (M1)
!!     tension <= c/tan(phi)
!!
!! Plastic strain follows (1 + sin(psi), 0, -(1 - sin(psi))) on the first face, the stress itself
!! behind the cut-off, and both, or that of two faces, where they meet (Koiter 1953). The return is
!! exact for constant moduli: all is linear in principal stresses, whose axes do not turn. To the
!! face; where that would change the order, to the edge s2 = s3 or s1 = s2 (de Souza Neto, Peric
!! and Owen 2008, 8.2); what is then beyond the cut-off, as what lies behind the apex is, returns to
!! the cut-off alone; and what that leaves outside the face, to where both meet.
module sgmp_material_mohr_coulomb
  use sgmp_keys, only: fault_t, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_elastic, only: elastic_t
  use sgmp_material_history, only: history_t
  use sgmp_principal, only: principal_dyad, principal_values
  use sgmp_soil, only: degree, soil_apex, soil_check
  implicit none
  private
  public :: mohr_coulomb_read
  public :: mohr_coulomb_t, mohr_coulomb_init, mohr_coulomb_point, mohr_coulomb_return

  integer, parameter :: components = 6  !! of a stress in space
  real(dp), parameter :: nearly = 1.0e-9_dp  !! of the cohesion: rounding at the apex

  !> Constants of (M1).
  type :: mohr_coulomb_t
    real(dp) :: friction = 0.0_dp    !! sin(phi)
    real(dp) :: dilatancy = 0.0_dp   !! sin(psi)
    real(dp) :: cohesion = 0.0_dp    !! 2 c cos(phi) (stress)
    real(dp) :: tension = 0.0_dp     !! largest principal stress (stress)
    real(dp) :: least = 0.0_dp       !! least principal stress beside that (stress)
  end type mohr_coulomb_t

contains

  !> Law from the values of its keys.
  pure subroutine mohr_coulomb_read(values, law, history, fault)
    class(values_t), intent(in) :: values
    type(mohr_coulomb_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    law = mohr_coulomb_init(values%number('friction'), values%number('cohesion'), &
                            values%number('dilatancy'), values%number('tension', huge(1.0_dp)))
    history%plastic = .true.
    call soil_check(values, fault)
  end subroutine mohr_coulomb_read

  !> Constants from plain numbers; a tension beyond the apex is the apex.
  pure function mohr_coulomb_init(friction, cohesion, dilatancy, tension) result(law)
    real(dp), intent(in) :: friction   !! phi (degrees), > 0
    real(dp), intent(in) :: cohesion   !! c (stress)
    real(dp), intent(in) :: dilatancy  !! psi (degrees)
    real(dp), intent(in) :: tension    !! largest principal stress (stress)
    type(mohr_coulomb_t) :: law
    law%friction = sin(degree*friction)
    law%dilatancy = sin(degree*dilatancy)
    law%cohesion = 2.0_dp*cohesion*cos(degree*friction)
    law%tension = min(tension, soil_apex(friction, cohesion))
    law%least = ((1.0_dp + law%friction)*law%tension - law%cohesion)/(1.0_dp - law%friction)
  end function mohr_coulomb_init

  !> Return of one trial stress.
  pure subroutine mohr_coulomb_point(law, elastic, s)
    type(mohr_coulomb_t), intent(in) :: law
    type(elastic_t), intent(in) :: elastic
    real(dp), intent(inout) :: s(3)   !! principal stresses, the largest first; returned (stress)
    real(dp) :: trial(3)
    trial = s
    call return_to_shear(law, elastic, s)
    if (s(1) <= law%tension) return
    s = trial
    call return_to_tension(law%tension, elastic%poisson, s)
    if (s(3) >= law%least) return
    ! Faces meet: nothing has flowed along the second axis, unless its stress is one of the others.
    s = [law%tension, 0.0_dp, law%least]
    s(2) = trial(2) - elastic%poisson*((trial(1) - s(1)) + (trial(3) - s(3)))
    s(2) = max(s(3), min(s(1), s(2)))
  end subroutine mohr_coulomb_point

  !> Return to the face of (M1), or to one of its edges, as if there were no cut-off.
  pure subroutine return_to_shear(law, elastic, s)
    type(mohr_coulomb_t), intent(in) :: law
    type(elastic_t), intent(in) :: elastic
    real(dp), intent(inout) :: s(3)
    real(dp) :: trial(3), normal(3), flow(3)
    normal = [1.0_dp + law%friction, 0.0_dp, -(1.0_dp - law%friction)]
    flow = [1.0_dp + law%dilatancy, 0.0_dp, -(1.0_dp - law%dilatancy)]
    trial = s
    s = pushed_back(elastic, normal, law%cohesion, flow, trial)
    if (s(1) >= s(2) .and. s(2) >= s(3)) return
    ! Two faces that are mirror images of each other: the mean of the two stresses, and what half
    ! of either flow does.
    if (-flow(3)*(trial(1) - trial(2)) >= flow(1)*(trial(2) - trial(3))) then
      trial(2:) = 0.5_dp*(trial(2) + trial(3))
      flow(2:) = 0.5_dp*flow(3)
    else
      trial(:2) = 0.5_dp*(trial(1) + trial(2))
      flow(:2) = 0.5_dp*flow(1)
    end if
    s = pushed_back(elastic, normal, law%cohesion, flow, trial)
  end subroutine return_to_shear

  !> Trial stress less the stress of a strain along `flow` that takes normal . s down to `most`.
  pure function pushed_back(elastic, normal, most, flow, trial) result(s)
    type(elastic_t), intent(in) :: elastic
    real(dp), intent(in) :: normal(3), most, flow(3), trial(3)
    real(dp) :: s(3)
    real(dp) :: push(3), excess
    push = elastic%lambda*sum(flow) + 2.0_dp*elastic%shear*flow
    excess = dot_product(normal, trial) - most
    s = trial
    if (excess > 0.0_dp) s = trial - excess/dot_product(normal, push)*push
  end function pushed_back

  !> Return to a largest principal stress (Rankine 1857): no strain along the axes below it.
  pure subroutine return_to_tension(most, poisson, s)
    real(dp), intent(in) :: most, poisson
    real(dp), intent(inout) :: s(3)
    real(dp) :: second
    second = s(2) - poisson/(1.0_dp - poisson)*(s(1) - most)
    if (s(1) <= most) return
    if (second <= most) then
      s = [most, second, s(3) - (s(2) - second)]
    else
      s = [most, most, min(most, s(3) - poisson*((s(1) - most) + (s(2) - most)))]
    end if
  end subroutine return_to_tension

  !> Lane kernel: trial stresses returned.
  pure subroutine mohr_coulomb_return(law, elastic, n, mean, norm, ep, stress, opened)
    type(mohr_coulomb_t), intent(in) :: law
    type(elastic_t), intent(in) :: elastic
    integer, intent(in) :: n                        !! components stored
    real(dp), intent(in) :: mean(lanes), norm(lanes)  !! of the stress: mean, von Mises (stress)
    real(dp), intent(inout) :: ep(lanes)            !! equivalent plastic strain, updated
    real(dp), intent(inout) :: stress(lanes, n)
    real(dp), intent(out) :: opened(lanes)          !! by which grains come apart, see soil_matter
    real(dp) :: tensor(components), values(3), axes(3, 3), change(3)
    integer :: l
    opened = 0.0_dp
    do l = 1, lanes
      if (inside(law, mean(l), norm(l))) cycle
      tensor = 0.0_dp
      tensor(:n) = stress(l, :)
      call principal_values(tensor, values, axes)
      change = values
      call mohr_coulomb_point(law, elastic, values)
      change = values - change
      if (values(1) >= law%tension - nearly*law%cohesion) then
        opened(l) = max(0.0_dp, -sum(change)/(3.0_dp*elastic%bulk))
      end if
      tensor = principal_dyad(change, axes)
      stress(l, :) = stress(l, :) + tensor(:n)
      change = change - sum(change)/3.0_dp
      ep(l) = ep(l) + sqrt(sum(change**2)/6.0_dp)/elastic%shear
    end do
  end subroutine mohr_coulomb_return

  !> Whether a stress meets (M1) whatever its principal axes: s1 - s3 <= 2 q/sqrt(3),
  !! s1 + s3 <= 2 mean + q/3, s1 <= mean + 2 q/3. Most particles of a quiet scene need no more.
  pure logical function inside(law, mean, norm) result(yes)
    type(mohr_coulomb_t), intent(in) :: law
    real(dp), intent(in) :: mean, norm
    real(dp) :: shear
    shear = 2.0_dp/sqrt(3.0_dp)*norm + law%friction*(2.0_dp*mean + norm/3.0_dp)
    yes = shear <= law%cohesion .and. mean + 2.0_dp/3.0_dp*norm <= law%tension
  end function inside

end module sgmp_material_mohr_coulomb
