!> Modified Cam-clay (Roscoe and Burland 1968; Schofield and Wroth 1968; theory 4), for clays and
!! other soils that harden as their pores close. With p the mean pressure, q the von Mises stress
!! and v = (1 + e0) V/V0 the specific volume, e0 the initial void ratio:
!!
!!     (q/M)^2 + p (p - pc) <= 0                                                        (CC1)
!!     dv = -kappa dp/p  of elastic, so K = v p/kappa,  G = 3 K (1 - 2 nu)/(2 (1 + nu))  (CC2)
!!     dv = -(lambda - kappa) dpc/pc  of plastic strain, which is normal to (CC1)       (CC3)
!!
!! The return is implicit in p, q and pc (Borja and Lee 1990), and (CC2) and (CC3) are integrated as
!! logarithms: with u = q/(M p) after the step, p* and q* the stress of an elastic step, pc* the
!! preconsolidation before it,
!!
!!     p = pc/(1 + u^2),   L = ln(p* (1 + u^2)/pc*),   p = p* exp(-(1 - kappa/lambda) L)
!!     plastic decrease of v:  x = kappa (1 - kappa/lambda) L
!!     v M (1 - u^2) (q* - M u p) = 6 G u x                                             (CC4)
!!
!! one equation for u, whose root lies between the u of no plastic change of volume (or 0) and the
!! critical state u = 1. G is that of the beginning of the step.
!!
!! A pressure below `least` counts as `least`: without a pressure there were no moduli.
module sgmp_material_cam_clay
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_elastic, only: elastic_init, elastic_t, moduli_keys
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: cam_clay_keys, cam_clay_read
  public :: cam_clay_t, cam_clay_init, cam_clay_moduli, cam_clay_point, cam_clay_return, &
            cam_clay_start

  integer, parameter :: most_trials = 100              !! of u: halving the bracket needs no more
  real(dp), parameter :: settled = 1.0e-14_dp          !! of u
  real(dp), parameter :: nearly_settled = 1.0e-8_dp    !! of u: Newton's step squares the error
  real(dp), parameter :: most_squeezed = 300.0_dp      !! logarithm of the growth of p in a step

  !> Constants of (CC1) to (CC3).
  type :: cam_clay_t
    real(dp) :: ratio = 1.0_dp          !! M
    real(dp) :: compression = 1.0_dp    !! lambda
    real(dp) :: swelling = 0.5_dp       !! kappa
    real(dp) :: volume = 2.0_dp         !! 1 + e0
    real(dp) :: shear = 0.5_dp          !! G/K
    real(dp) :: preconsolidation = 0.0_dp    !! pc at the start, 0: none given (stress)
    real(dp) :: overconsolidation = 1.0_dp   !! pc over that of the stress at the start
    real(dp) :: least = 0.0_dp          !! least pressure (stress), > 0
  end type cam_clay_t

contains

  !> Keys of the law.
  function cam_clay_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    type(key_t), allocatable :: moduli(:)
    moduli = moduli_keys()
    keys = [moduli(2), &
            key('critical_ratio', kind_real, 'M: von Mises stress over pressure at the '// &
                'critical state; of an angle of friction in triaxial compression '// &
                '6 sin(phi)/(3 - sin(phi))', range='(0,inf)', required=.true.), &
            key('compression_slope', kind_real, 'lambda: specific volume (1 + void ratio) over '// &
                'the natural logarithm of the pressure, in first compression', &
                range='(0,inf)', required=.true.), &
            key('swelling_slope', kind_real, 'kappa: the same where it swells or is compressed '// &
                'again, below compression_slope', range='(0,inf)', required=.true.), &
            key('void_ratio', kind_real, 'volume of the pores over that of the grains at the '// &
                'start', range='(0,inf)', required=.true.), &
            key('pressure0', kind_real, 'pressure at the start, the same in all directions', &
                unit='stress', range='(0,inf)', required=.true.), &
            key('preconsolidation', kind_real, 'pressure at which it first yields under '// &
                'pressure alone, not below pressure0; in place of overconsolidation', &
                unit='stress', range='(0,inf)'), &
            key('overconsolidation', kind_real, 'preconsolidation over that whose ellipse '// &
                'passes through the stress at the start; default: 1', range='[1,inf)'), &
            key('least_pressure', kind_real, 'a lower pressure counts as this; default: '// &
                'pressure0/1000', unit='stress', range='(0,inf)')]
  end function cam_clay_keys

  !> Law from the values of its keys.
  pure subroutine cam_clay_read(density, values, law, elastic, history, fault)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(cam_clay_t), intent(out) :: law
    type(elastic_t), intent(out) :: elastic    !! of small strains at the start
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    real(dp) :: bulk, pressure
    pressure = values%number('pressure0')
    law = cam_clay_init(values%number('critical_ratio'), values%number('compression_slope'), &
                        values%number('swelling_slope'), values%number('void_ratio'), &
                        values%number('poisson'), values%number('preconsolidation'), &
                        values%number('overconsolidation', 1.0_dp), &
                        values%number('least_pressure', 1.0e-3_dp*pressure))
    call cam_clay_moduli(law, law%volume, pressure, bulk)
    elastic = elastic_init(density, 3.0_dp*bulk*(1.0_dp - 2.0_dp*values%number('poisson')), &
                           values%number('poisson'))
    history%plastic = .true.
    history%preconsolidation = .true.
    history%first_mean_stress = -pressure
    if (.not. law%swelling < law%compression) then
      call fault_make(fault, 'swelling_slope', 'it swells as much as it was compressed', &
                      'swelling_slope is below compression_slope, often a fifth of it')
    else if (values%has('preconsolidation') .and. values%has('overconsolidation')) then
      call fault_make(fault, 'overconsolidation', 'preconsolidation and overconsolidation are '// &
                      'both given', 'keep one of them')
    else if (values%has('preconsolidation') .and. law%preconsolidation < pressure) then
      call fault_make(fault, 'preconsolidation', 'the preconsolidation is below pressure0', &
                      'give more, or leave it out: then it is pressure0')
    end if
  end subroutine cam_clay_read

  !> Constants from plain numbers.
  pure function cam_clay_init(ratio, compression, swelling, void_ratio, poisson, &
                              preconsolidation, overconsolidation, least) result(law)
    real(dp), intent(in) :: ratio              !! M
    real(dp), intent(in) :: compression, swelling  !! lambda > kappa > 0
    real(dp), intent(in) :: void_ratio         !! e0
    real(dp), intent(in) :: poisson            !! nu
    real(dp), intent(in) :: preconsolidation   !! pc at the start, 0: by overconsolidation (stress)
    real(dp), intent(in) :: overconsolidation  !! at least 1
    real(dp), intent(in) :: least              !! least pressure (stress), > 0
    type(cam_clay_t) :: law
    law%ratio = ratio
    law%compression = compression
    law%swelling = swelling
    law%volume = 1.0_dp + void_ratio
    law%shear = 3.0_dp*(1.0_dp - 2.0_dp*poisson)/(2.0_dp*(1.0_dp + poisson))
    law%preconsolidation = preconsolidation
    law%overconsolidation = overconsolidation
    law%least = least
  end function cam_clay_init

  !> Bulk modulus (CC2) (stress).
  elemental subroutine cam_clay_moduli(law, volume, pressure, bulk)
    type(cam_clay_t), intent(in) :: law
    real(dp), intent(in) :: volume    !! specific volume
    real(dp), intent(in) :: pressure  !! (stress)
    real(dp), intent(out) :: bulk
    bulk = volume*merge(pressure, law%least, pressure > law%least)/law%swelling
  end subroutine cam_clay_moduli

  !> Preconsolidation of particles that have none yet, from the stress that they start from,
  !! whoever has set it: the ellipse (CC1) is not smaller than that stress.
  elemental subroutine cam_clay_start(law, pressure, norm, preconsolidation)
    type(cam_clay_t), intent(in) :: law
    real(dp), intent(in) :: pressure, norm   !! of the stress: mean, von Mises (stress)
    real(dp), intent(inout) :: preconsolidation  !! 0: none yet (stress)
    real(dp) :: p, least
    if (preconsolidation > 0.0_dp) return
    p = max(pressure, law%least)
    least = p + (norm/law%ratio)**2/p
    preconsolidation = max(law%preconsolidation, law%overconsolidation*least)
  end subroutine cam_clay_start

  !> Return of one trial stress to the ellipse (CC1).
  pure subroutine cam_clay_point(law, volume, shear, trial, pressure, preconsolidation, norm)
    type(cam_clay_t), intent(in) :: law
    real(dp), intent(in) :: volume   !! specific volume after the step
    real(dp), intent(in) :: shear    !! G (stress)
    real(dp), intent(in) :: trial    !! q*, von Mises stress of the trial stress (stress)
    real(dp), intent(inout) :: pressure          !! p*, > 0; returned (stress)
    real(dp), intent(inout) :: preconsolidation  !! pc before the step, > 0; after it (stress)
    real(dp), intent(out) :: norm    !! q after the step (stress)
    real(dp) :: u, low, high, residual, slope, change, logarithm, part
    logical :: newton
    integer :: k
    norm = trial
    if (.not. outside(law, trial, pressure, preconsolidation) > 0.0_dp) return
    part = 1.0_dp - law%swelling/law%compression
    u = sqrt(max(0.0_dp, preconsolidation/pressure - 1.0_dp))
    low = min(u, 1.0_dp)
    high = max(u, 1.0_dp)
    do k = 1, most_trials
      call flow_rule(law, volume, shear, trial, pressure, preconsolidation, u, residual, slope)
      if (residual > 0.0_dp) low = u
      if (residual < 0.0_dp) high = u
      change = 0.0_dp
      if (abs(slope) > 0.0_dp) change = -residual/slope
      ! A step out of the bracket, and one up where the residual rises, lead nowhere.
      newton = slope < 0.0_dp .and. u + change >= low .and. u + change <= high
      if (.not. newton) change = 0.5_dp*(low + high) - u
      u = u + change
      if (abs(change) <= merge(nearly_settled, settled, newton)*(1.0_dp + u)) exit
    end do
    logarithm = log(pressure*(1.0_dp + u**2)/preconsolidation)
    pressure = pressure*exp(-part*logarithm)
    preconsolidation = pressure*(1.0_dp + u**2)
    norm = law%ratio*u*pressure
  end subroutine cam_clay_point

  !> How far a stress lies outside of (CC1) (stress squared).
  elemental real(dp) function outside(law, norm, pressure, preconsolidation) result(excess)
    type(cam_clay_t), intent(in) :: law
    real(dp), intent(in) :: norm, pressure, preconsolidation
    excess = (norm/law%ratio)**2 + pressure*(pressure - preconsolidation)
  end function outside

  !> Left less right side of (CC4) in units of the trial pressure, and its derivative.
  pure subroutine flow_rule(law, volume, shear, trial, pressure, preconsolidation, u, residual, &
                            slope)
    type(cam_clay_t), intent(in) :: law
    real(dp), intent(in) :: volume, shear, trial, pressure, preconsolidation, u
    real(dp), intent(out) :: residual, slope
    real(dp) :: part, logarithm, grows, p, missing, x, stiff, m
    m = law%ratio
    part = 1.0_dp - law%swelling/law%compression
    logarithm = log(pressure*(1.0_dp + u**2)/preconsolidation)
    grows = 2.0_dp*u/(1.0_dp + u**2)          ! dL/du
    p = exp(-part*logarithm)                  ! over p*
    missing = trial/pressure - m*u*p
    x = law%swelling*part*logarithm
    stiff = 6.0_dp*shear/pressure
    residual = volume*m*(1.0_dp - u**2)*missing - stiff*u*x
    slope = -volume*m*(2.0_dp*u*missing + (1.0_dp - u**2)*m*p*(1.0_dp - part*u*grows)) &
            - stiff*(x + law%swelling*part*u*grows)
  end subroutine flow_rule

  !> Lane kernel: pressures after a step, trial deviators returned.
  pure subroutine cam_clay_return(law, before, volume, shear, trial, pressure, ep, &
                                  preconsolidation, factor)
    type(cam_clay_t), intent(in) :: law
    real(dp), intent(in) :: before(lanes), volume(lanes)  !! specific volumes, before and after
    real(dp), intent(in) :: shear(lanes)       !! G (stress)
    real(dp), intent(in) :: trial(lanes)       !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: pressure(lanes)  !! before the step; after it (stress)
    real(dp), intent(inout) :: ep(lanes)       !! equivalent plastic shear strain, updated
    real(dp), intent(inout) :: preconsolidation(lanes)  !! updated (stress)
    real(dp), intent(out) :: factor(lanes)     !! scales the trial deviator
    real(dp) :: norm, squeezed
    integer :: l
    !GCC$ novector
    do l = 1, lanes  ! vectors of exponentials are less exact, and most lanes return in turn
      squeezed = min((before(l) - volume(l))/law%swelling, most_squeezed)
      pressure(l) = max(pressure(l), law%least)*exp(squeezed)
      pressure(l) = max(pressure(l), law%least)
      factor(l) = 1.0_dp
      if (.not. outside(law, trial(l), pressure(l), preconsolidation(l)) > 0.0_dp) cycle
      call cam_clay_point(law, volume(l), shear(l), trial(l), pressure(l), preconsolidation(l), &
                          norm)
      if (trial(l) > 0.0_dp) factor(l) = norm/trial(l)
      ep(l) = ep(l) + (trial(l) - norm)/(3.0_dp*shear(l))
    end do
  end subroutine cam_clay_return

end module sgmp_material_cam_clay
