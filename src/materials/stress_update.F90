! dimension-generic, axisymmetric
#include "dimension.inc"
!> Stress update of one chunk of particles: strain and rotation (Jaumann rate), constitutive law,
!! volume, energy, flux.
!!
!! The law is chosen once per chunk; each stage is a loop over the lanes. Volume follows the
!! determinant of the step's deformation gradient. Internal energy grows by V_old (1/2 (sigma_old +
!! sigma_new) - Q) : deps, Q the bulk viscosity, which is exact for a linear stress path in one
!! dimension; an equation of state takes its pressure work from the change of volume.
!!
!! Longer than 500 lines: the stages are small lane loops that the compiler inlines into one update.
module DIM(sgmp_stress_update)
  use sgmp_averaging, only: averaging_values
  use sgmp_constitutive, only: constitutive_t, eos_none, material_cam_clay, &
                               material_concrete, material_crushable_foam, &
                               material_drucker_prager, &
                               material_elastic, material_fluid, material_j2, &
                               material_johnson_cook, material_johnson_holmquist, &
                               material_mohr_coulomb, &
                               material_mooney_rivlin, material_neo_hookean, &
                               material_steinberg_guinan, material_zerilli_armstrong
  use sgmp_debris, only: debris_begin, debris_lanes, debris_largest, debris_t, tear_lanes
  use sgmp_ductility, only: ductility_given, ductility_lanes
  use sgmp_failure, only: carries_everything, failure_judge, failure_tension
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_cam_clay, only: cam_clay_moduli, cam_clay_return, cam_clay_start
  use sgmp_material_concrete, only: concrete_return
  use sgmp_material_crushable_foam, only: crushable_foam_return
  use sgmp_material_drucker_prager, only: drucker_prager_return, drucker_prager_shear
  use sgmp_material_fluid, only: fluid_diffusion_speed
  use sgmp_material_j2, only: j2_return
  use sgmp_material_jc, only: jc_return, jc_return_simple
  use sgmp_material_johnson_holmquist, only: johnson_holmquist_return
  use sgmp_material_mohr_coulomb, only: mohr_coulomb_return
  use sgmp_material_mooney_rivlin, only: mooney_rivlin_stress
  use sgmp_material_steinberg_guinan, only: steinberg_guinan_return, steinberg_guinan_stiffness
  use sgmp_material_zerilli_armstrong, only: zerilli_armstrong_return
  use sgmp_pressure, only: cavitate, equation_of_state, explosive, release, soften, viscosity, warm
  use sgmp_softening, only: softening_regain
  use sgmp_soil, only: soil_matter
  use sgmp_viscosity, only: closing_t
  use sgmp_voigt, only: flux_stress, voigt_axes
  implicit none
  private
  public :: stress_update, stress_flux, stress_probe

  !> Stress component of each flux (and strain) component, and its two axes.
  integer, parameter :: stress_of(NFLUX) = flux_stress(:NFLUX, SPACE)
  integer, parameter :: strain_pair(2, NFLUX) = voigt_axes(:, stress_of)
  real(dp), parameter :: least_square = 1.0e-200_dp     !! of a strain that has a direction
  real(dp), parameter :: most_share = 2.0_dp            !! of the work of a viscous pressure
#ifdef AXISYMMETRIC
  integer, parameter :: hoop = 3                        !! of the stress components
#endif

contains

  !> Advances volume, stress and history by one step and returns the flux sigma V that the grid
  !! wants (Eq. 23).
  ! allow(S902)
  subroutine stress_update(law, dt, time, mass, live, grad, nb, b, flux, speed2, jacobian, &
                           internal, viscous, behind)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt                          !! strain step
    real(dp), intent(in) :: time                        !! at the end of the step
    real(dp), intent(in) :: mass(lanes), live(lanes)    !! live: 1 for particles, 0 for pads
    real(dp), intent(in) :: grad(lanes, NGRAD)          !! velocity gradient, row by row
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)             !! volume, stress, history
    real(dp), intent(out) :: flux(lanes, NFLUX)         !! (sigma - Q) V; 0 in pads
    real(dp), intent(out) :: speed2(lanes)              !! square of the sound speed, negative
                                                        !! where waves have none
    real(dp), intent(out) :: jacobian(lanes)  !! determinant of the step's deformation gradient
    real(dp), intent(inout) :: internal(lanes)  !! growth of the internal energy, added to
    real(dp), intent(inout) :: viscous(lanes)   !! part of it that the bulk viscosity dissipates
    logical, intent(in), optional :: behind     !! the gradient is that at the places at the end of
                                                !! the step; absent: at its start
    real(dp) :: side, strain(lanes, NFLUX), trace(lanes), old_volume(lanes), work(lanes), q(lanes)
    real(dp) :: none(lanes, NSTRESS), mean(lanes), norm(lanes), opened(lanes)
    type(closing_t) :: closing
    integer :: l, s
    if (law%rigid) then
      flux = 0.0_dp
      speed2 = 0.0_dp
      jacobian = 1.0_dp
      return
    end if
    s = law%slots%stress
    side = 1.0_dp
    if (present(behind)) side = merge(-1.0_dp, 1.0_dp, behind)
    if (law%slots%stretch > 0) call stretch(dt, grad, b(1, law%slots%stretch))
    select case (law%kind)
    case (material_elastic)
      call predict(law, law%elastic%shear, law%elastic%lambda, dt, side, grad, b(1, 1), b(1, s), &
                   strain, trace, jacobian, old_volume, work)
      call elastic(law, dt, mass, strain, trace, b(1, 1), b(1, s), speed2, q, work)
    case (material_drucker_prager)
      if (law%eos == eos_none) then
        call predict(law, law%elastic%shear, law%elastic%lambda, dt, side, grad, b(1, 1), b(1, s), &
                     strain, trace, jacobian, old_volume, work)
        call soil(law, b(1, law%slots%plastic), b(1, 1), b(1, s))
        call elastic(law, dt, mass, strain, trace, b(1, 1), b(1, s), speed2, q, work)
      else
        call ground(law, dt, side, mass, grad, nb, b, trace, jacobian, old_volume, speed2, q, work)
      end if
    case (material_mohr_coulomb)
      call predict(law, law%elastic%shear, law%elastic%lambda, dt, side, grad, b(1, 1), b(1, s), &
                   strain, trace, jacobian, old_volume, work)
      call von_mises(b(1, s), mean, norm)
      call mohr_coulomb_return(law%mohr_coulomb, law%elastic, NSTRESS, mean, norm, &
                               b(1, law%slots%plastic), b(1, s), opened)
      if (.not. law%small_strain) call soil_matter(opened, b(1, 1))
      call elastic(law, dt, mass, strain, trace, b(1, 1), b(1, s), speed2, q, work)
    case (material_johnson_holmquist)
      call predict(law, law%elastic%shear, law%elastic%lambda, dt, side, grad, b(1, 1), b(1, s), &
                   strain, trace, jacobian, old_volume, work)
      call ceramic(law, dt, mass, strain, trace, nb, b, speed2, q, work)
    case (material_concrete)
      call predict(law, law%elastic%shear, law%elastic%lambda, dt, side, grad, b(1, 1), b(1, s), &
                   strain, trace, jacobian, old_volume, work)
      call concrete(law, dt, mass, strain, trace, nb, b, speed2, q, work)
    case (material_crushable_foam)
      call predict(law, law%elastic%shear, law%elastic%lambda, dt, side, grad, b(1, 1), b(1, s), &
                   strain, trace, jacobian, old_volume, work)
      call foam(law, b(1, law%slots%plastic), b(1, s))
      call elastic(law, dt, mass, strain, trace, b(1, 1), b(1, s), speed2, q, work)
    case (material_cam_clay)
      call von_mises(b(1, s), mean, norm)
      call cam_clay_start(law%cam_clay, -mean, norm, b(:, law%slots%preconsolidation))
      call predict(law, 0.0_dp, 0.0_dp, dt, side, grad, b(1, 1), b(1, s), strain, trace, jacobian, &
                   old_volume, work)
      call clay(law, dt, mass, old_volume, strain, trace, mean, nb, b, speed2, q, work)
    case (material_neo_hookean, material_mooney_rivlin)
      call predict(law, 0.0_dp, 0.0_dp, dt, side, grad, b(1, 1), b(1, s), strain, trace, jacobian, &
                   old_volume, work)
      call hyperelastic(law, dt, side, mass, grad, strain, trace, b(1, 1), b(1, s), &
                        b(1, law%slots%deformation), speed2, q, work)
    case (material_j2, material_johnson_cook, material_steinberg_guinan, material_zerilli_armstrong)
      call plastic(law, dt, side, mass, grad, nb, b, trace, jacobian, old_volume, speed2, q, work)
    case default  ! material_explosive, material_fluid
      none = 0.0_dp
      call predict(law, 0.0_dp, 0.0_dp, dt, side, grad, b(1, 1), none, strain, trace, jacobian, &
                   old_volume, work)
      closing%dt = dt
      closing%trace = trace
      call viscous_share(law, strain, trace, closing%share)
      if (law%kind == material_fluid) then
        call fluid(law, closing, mass, old_volume, strain, nb, b, speed2, q, work)
      else
        call explosive(law, closing, time, mass, old_volume, nb, b, speed2, q, work)
      end if
    end select
    call stress_flux(law, b(1, 1), q, live, b(1, s), flux)
    if (law%across) call turn_across(live, b(1, 1), q, strain, trace, flux)
    !$omp simd simdlen(8)
    do l = 1, lanes
      work(l) = live(l)*(old_volume(l)*work(l))
      q(l) = live(l)*(old_volume(l)*(q(l)*trace(l)))
      internal(l) = internal(l) + (work(l) - q(l))
      viscous(l) = viscous(l) - q(l)
    end do
    if (law%eos == eos_none .and. law%slots%energy > 0) then
      b(:, law%slots%energy) = b(:, law%slots%energy) + (work - q)*law%density/mass
    end if
  end subroutine stress_update

  !> Flux (sigma - q I) V of a chunk; 0 in pads.
  pure subroutine stress_flux(law, volume, q, live, stress, flux)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: volume(lanes), q(lanes), live(lanes)
    real(dp), intent(in) :: stress(lanes, NSTRESS)      !! or the mean stress alone
    real(dp), intent(out) :: flux(lanes, NFLUX)
    real(dp) :: v
    integer :: l, c
    if (law%slots%stresses == 1) then
      do c = 1, NFLUX
        do l = 1, lanes
          flux(l, c) = 0.0_dp
          if (stress_of(c) <= 3) flux(l, c) = live(l)*volume(l)*(stress(l, 1) - q(l))
        end do
      end do
      return
    end if
    !$omp simd simdlen(8) private(v, c)
    do l = 1, lanes
      v = live(l)*volume(l)
      do c = 1, NDIM
        flux(l, c) = v*(stress(l, c) - q(l))
      end do
      do c = NDIM + 1, NFLUX
        flux(l, c) = v*stress(l, stress_of(c))
      end do
#ifdef AXISYMMETRIC
      flux(l, NFLUX) = v*(stress(l, hoop) - q(l))
#endif
    end do
  end subroutine stress_flux

  !> The viscous pressure that does the work of (AV1) over the one of a plane front:
  !!     Q : D = min(|D|/|tr D|, 2) q tr D, |D|^2 = D : D.                             (AV2)
  !! Where all directions close it is less than q; where shear prevails it takes no more than twice
  !! the energy that q would.
  pure subroutine viscous_share(law, strain, trace, share)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: strain(lanes, NFLUX), trace(lanes)
    real(dp), intent(out) :: share(lanes)
    real(dp) :: square(lanes)
    integer :: l
    share = 1.0_dp
    if (NFLUX == 1 .or. .not. law%across) return
    call square_of(strain, square)
    !$omp simd simdlen(8)
    do l = 1, lanes
      if (trace(l) < 0.0_dp .and. square(l) > least_square) then
        share(l) = min(-sqrt(square(l))/trace(l), most_share)
      end if
    end do
  end subroutine viscous_share

  !> Makes the viscous pressure in a flux act as the deformation goes: across a front, not along it,
  !!     Q = (Q : D) D/(D : D), with Q : D of (AV2).                                       (AV1)
  !! As a pressure it pushes round blasts out along their own front (doc/theory.md, 4).
  pure subroutine turn_across(live, volume, q, strain, trace, flux)
    real(dp), intent(in) :: live(lanes), volume(lanes)
    real(dp), intent(in) :: q(lanes)             !! Q : D over tr D
    real(dp), intent(in) :: strain(lanes, NFLUX), trace(lanes)
    real(dp), intent(inout) :: flux(lanes, NFLUX)
    real(dp) :: square(lanes), room, along
    integer :: l, c
    if (NFLUX == 1 .or. .not. any(q > 0.0_dp)) return
    call square_of(strain, square)
    !$omp simd simdlen(8) private(room, along, c)
    do l = 1, lanes
      room = 0.0_dp
      along = 0.0_dp
      if (square(l) > least_square) then
        room = live(l)*volume(l)*q(l)
        along = room*trace(l)/square(l)
      end if
      do c = 1, NFLUX
        if (stress_of(c) <= 3) then
          flux(l, c) = (flux(l, c) + room) - along*strain(l, c)
        else
          flux(l, c) = flux(l, c) - 0.5_dp*along*strain(l, c)
        end if
      end do
    end do
  end subroutine turn_across

  !> strain : strain.
  pure subroutine square_of(strain, square)
    real(dp), intent(in) :: strain(lanes, NFLUX)
    real(dp), intent(out) :: square(lanes)
    integer :: l, c
    !$omp simd simdlen(8) private(c)
    do l = 1, lanes
      square(l) = 0.0_dp
      do c = 1, NFLUX
        square(l) = square(l) + merge(1.0_dp, 0.5_dp, stress_of(c) <= 3)*strain(l, c)**2
      end do
    end do
  end subroutine square_of

  !> Stress of an elastic body of unit wave modulus, times the weight of each lane.
  pure subroutine stress_probe(law, weight, grad, flux)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: weight(lanes), grad(lanes, NGRAD)
    real(dp), intent(out) :: flux(lanes, NFLUX)
    real(dp) :: shear, lame, trace(lanes)
    integer :: a, b, c
    shear = 0.0_dp  ! a fluid
    if (law%elastic%shear > 0.0_dp) then
      shear = law%elastic%shear/(law%elastic%lambda + 2.0_dp*law%elastic%shear)
    end if
    lame = 1.0_dp - 2.0_dp*shear
    call volume_rate(grad, trace)
    do c = 1, NFLUX
      a = strain_pair(1, c)
      b = strain_pair(2, c)
#ifdef AXISYMMETRIC
      if (a == hoop) then
        flux(:, c) = weight*(2.0_dp*shear*grad(:, NGRAD) + lame*trace)
        cycle
      end if
#endif
      flux(:, c) = shear*(grad(:, (a - 1)*NDIM + b) + grad(:, (b - 1)*NDIM + a))
      if (a == b) flux(:, c) = flux(:, c) + lame*trace
      flux(:, c) = weight*flux(:, c)
    end do
  end subroutine stress_probe

  !> Strain increment, new volume, and the trial stress of an elastic step: the stress turned by the
  !! step's spin (Jaumann rate, to second order) plus Hooke's law.
  !!
  !! The strain is that of the places in the middle of the step, which a velocity moves by straight
  !! lines: what turns by an angle without strain gets longer along them by half of its square. Per
  !! volume at the start it is dt D + 1/2 dt^2 (I2 I - sym adj L), I2 the second invariant of L; its
  !! trace is the change of the volume (doc/theory.md, 2). Minus 1/2 from the places at the end.
  !!
  !! One loop over the lanes, so that nothing on the way goes through memory.
  ! allow(S902)
  pure subroutine predict(law, shear, lame, dt, side, grad, volume, stress, strain, trace, &
                          jacobian, old_volume, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: shear, lame, dt, side, grad(lanes, NGRAD)
    real(dp), intent(inout) :: volume(lanes), stress(lanes, NSTRESS)
    real(dp), intent(out) :: strain(lanes, NFLUX)   !! shears as engineering strains
    real(dp), intent(out) :: trace(lanes), jacobian(lanes)  !! of the strain; change of volume
    real(dp), intent(out) :: old_volume(lanes)
    real(dp), intent(out) :: work(lanes)            !! 1/2 old stress : strain
    real(dp) :: turn, keep, half, s1, s2, s3, mean, shear2
    integer :: l
#if NDIM == 2
    real(dp) :: xx, yy, xy, yx, det, s4, w, t1, t4
#ifdef AXISYMMETRIC
    real(dp) :: zz
#endif
#elif NDIM == 3
    real(dp) :: xx, yy, zz, xy, yx, xz, zx, yz, zy, wxy, wyz, wxz, s4, s5, s6
    real(dp) :: axx, ayy, azz, t1, t2, t3, t4, t5, t6
#endif
    ! Numbers, not a merge in the loop: the vectoriser has no condition that is the same for all
    ! lanes.
    keep = merge(1.0_dp, 0.0_dp, law%small_strain)
    turn = 0.5_dp*dt*(1.0_dp - keep)
    half = 0.5_dp*side*(1.0_dp - keep)
    shear2 = 2.0_dp*shear
#if NDIM == 1
    !$omp simd simdlen(8) private(s1, s2, s3, mean)
    do l = 1, lanes
      strain(l, 1) = dt*grad(l, 1)
      trace(l) = strain(l, 1)
      jacobian(l) = 1.0_dp + trace(l)
      s1 = stress(l, 1)
      s2 = stress(l, 2)
      s3 = stress(l, 3)
      work(l) = 0.5_dp*(s1*strain(l, 1))
      mean = lame*trace(l)
      stress(l, 1) = s1 + (mean + shear2*strain(l, 1))
      stress(l, 2) = s2 + mean
      stress(l, 3) = s3 + mean
#elif NDIM == 2
#ifdef AXISYMMETRIC
    !$omp simd simdlen(8) private(s1, s2, s3, s4, xx, yy, zz, xy, yx, det, w, t1, t4, mean)
#else
    !$omp simd simdlen(8) private(s1, s2, s3, s4, xx, yy, xy, yx, det, w, t1, t4, mean)
#endif
    do l = 1, lanes
      xx = dt*grad(l, 1)
      xy = dt*grad(l, 2)
      yx = dt*grad(l, 3)
      yy = dt*grad(l, 4)
      det = xx*yy - xy*yx
      strain(l, 1) = xx + half*det
      strain(l, 2) = yy + half*det
      strain(l, 3) = xy + yx
      jacobian(l) = (1.0_dp + (xx + yy)) + side*det
#ifdef AXISYMMETRIC
      zz = dt*grad(l, NGRAD)
      strain(l, 1) = strain(l, 1) + half*(zz*xx)
      strain(l, 2) = strain(l, 2) + half*(zz*yy)
      strain(l, 3) = strain(l, 3) + half*(zz*(xy + yx))
      strain(l, NFLUX) = zz + half*(zz*(xx + yy))
      jacobian(l) = (jacobian(l) + zz) + zz*(side*(xx + yy) + det)
#endif
      trace(l) = strain(l, 1) + strain(l, 2)
#ifdef AXISYMMETRIC
      trace(l) = trace(l) + strain(l, NFLUX)
#endif
      s1 = stress(l, 1)
      s2 = stress(l, 2)
      s3 = stress(l, 3)
      s4 = stress(l, 4)
      work(l) = 0.5_dp*(s1*strain(l, 1) + s2*strain(l, 2) + s4*strain(l, 3))
#ifdef AXISYMMETRIC
      work(l) = work(l) + 0.5_dp*(s3*strain(l, NFLUX))
#endif
      mean = lame*trace(l)
      w = turn*(grad(l, 2) - grad(l, 3))
      t1 = 2.0_dp*w*s4
      t4 = w*(s2 - s1)
      stress(l, 1) = (s1 + (t1 + w*t4)) + (mean + shear2*strain(l, 1))
      stress(l, 2) = (s2 - (t1 + w*t4)) + (mean + shear2*strain(l, 2))
      stress(l, 3) = s3 + mean
#ifdef AXISYMMETRIC
      stress(l, 3) = stress(l, 3) + shear2*strain(l, NFLUX)
#endif
      stress(l, 4) = (s4 + (t4 - w*t1)) + shear*strain(l, 3)
#else
    !$omp simd simdlen(8) private(s1, s2, s3, s4, s5, s6, mean, wxy, wyz, wxz) &
    !$omp& private(xx, yy, zz, xy, yx, xz, zx, yz, zy, axx, ayy, azz, t1, t2, t3, t4, t5, t6)
    do l = 1, lanes
      xx = dt*grad(l, 1)
      xy = dt*grad(l, 2)
      xz = dt*grad(l, 3)
      yx = dt*grad(l, 4)
      yy = dt*grad(l, 5)
      yz = dt*grad(l, 6)
      zx = dt*grad(l, 7)
      zy = dt*grad(l, 8)
      zz = dt*grad(l, 9)
      axx = yy*zz - yz*zy
      ayy = xx*zz - xz*zx
      azz = xx*yy - xy*yx
      strain(l, 1) = xx + half*(ayy + azz)
      strain(l, 2) = yy + half*(azz + axx)
      strain(l, 3) = zz + half*(axx + ayy)
      strain(l, 4) = (xy + yx) + half*((xy + yx)*zz - (xz*zy + yz*zx))
      strain(l, 5) = (yz + zy) + half*((yz + zy)*xx - (xz*yx + xy*zx))
      strain(l, 6) = (xz + zx) + half*((xz + zx)*yy - (xy*yz + yx*zy))
      trace(l) = (strain(l, 1) + strain(l, 2)) + strain(l, 3)
      jacobian(l) = (1.0_dp + ((xx + yy) + zz)) + side*((axx + ayy) + azz) &
                    + (xx*axx - xy*(yx*zz - yz*zx) + xz*(yx*zy - yy*zx))
      s1 = stress(l, 1)
      s2 = stress(l, 2)
      s3 = stress(l, 3)
      s4 = stress(l, 4)
      s5 = stress(l, 5)
      s6 = stress(l, 6)
      work(l) = 0.5_dp*((s1*strain(l, 1) + s2*strain(l, 2) + s3*strain(l, 3)) &
                        + (s4*strain(l, 4) + s5*strain(l, 5) + s6*strain(l, 6)))
      mean = lame*trace(l)
      wxy = turn*(grad(l, 2) - grad(l, 4))
      wyz = turn*(grad(l, 6) - grad(l, 8))
      wxz = turn*(grad(l, 3) - grad(l, 7))
      t1 = 2.0_dp*(wxy*s4 + wxz*s6)
      t2 = 2.0_dp*(wyz*s5 - wxy*s4)
      t3 = -2.0_dp*(wxz*s6 + wyz*s5)
      t4 = wxy*(s2 - s1) + wxz*s5 + wyz*s6
      t5 = wyz*(s3 - s2) - wxy*s6 - wxz*s4
      t6 = wxz*(s3 - s1) + wxy*s5 - wyz*s4
      stress(l, 1) = (s1 + (t1 + (wxy*t4 + wxz*t6))) + (mean + shear2*strain(l, 1))
      stress(l, 2) = (s2 + (t2 + (wyz*t5 - wxy*t4))) + (mean + shear2*strain(l, 2))
      stress(l, 3) = (s3 + (t3 - (wxz*t6 + wyz*t5))) + (mean + shear2*strain(l, 3))
      stress(l, 4) = (s4 + (t4 + 0.5_dp*(wxy*(t2 - t1) + wxz*t5 + wyz*t6))) + shear*strain(l, 4)
      stress(l, 5) = (s5 + (t5 + 0.5_dp*(wyz*(t3 - t2) - wxy*t6 - wxz*t4))) + shear*strain(l, 5)
      stress(l, 6) = (s6 + (t6 + 0.5_dp*(wxz*(t3 - t1) + wxy*t5 - wyz*t4))) + shear*strain(l, 6)
#endif
      old_volume(l) = volume(l)
      volume(l) = volume(l)*(keep + (1.0_dp - keep)*jacobian(l))
    end do
  end subroutine predict

  !> What an elastic step leaves to do once the stress is known.
  pure subroutine elastic(law, dt, mass, strain, trace, volume, stress, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, mass(lanes), strain(lanes, NFLUX), trace(lanes), volume(lanes)
    real(dp), intent(in) :: stress(lanes, NSTRESS)
    real(dp), intent(out) :: speed2(lanes), q(lanes)
    real(dp), intent(inout) :: work(lanes)
    real(dp) :: modulus
    integer :: l
    modulus = law%elastic%lambda + 2.0_dp*law%elastic%shear
    !$omp simd simdlen(8)
    do l = 1, lanes
      speed2(l) = modulus*volume(l)/mass(l)
    end do
    call add_half_work(stress, strain, work)
    call viscosity(law, dt, mass, volume, trace, speed2, q)
  end subroutine elastic

  !> Returns the trial stress of a soil to its cone or cap.
  pure subroutine soil(law, ep, volume, stress)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(inout) :: ep(lanes), volume(lanes), stress(lanes, NSTRESS)
    real(dp), dimension(lanes) :: mean, norm, returned, factor, opened
    call von_mises(stress, mean, norm)
    returned = mean
    call drucker_prager_return(law%soil, 3.0_dp*law%elastic%shear, law%elastic%bulk, norm, &
                               returned, ep, factor, opened)
    call rescale(factor, mean, returned, stress)
    if (.not. law%small_strain) call soil_matter(opened, volume)
  end subroutine soil

  !> A soil with an equation of state: its deviator returns to the cone at the pressure before the
  !! step, which it does not change; it bears no more tension than at the cap.
  ! allow(S902)
  subroutine ground(law, dt, side, mass, grad, nb, b, trace, jacobian, old_volume, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, side, mass(lanes), grad(lanes, NGRAD)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: trace(lanes), jacobian(lanes), old_volume(lanes)
    real(dp), intent(out) :: speed2(lanes), q(lanes), work(lanes)
    real(dp) :: strain(lanes, NFLUX), mean(lanes), norm(lanes), factor(lanes)
    real(dp) :: ones(lanes), shear(lanes), pressure_work(lanes)
    integer :: s
    s = law%slots%stress
    ones = 1.0_dp
    shear = law%elastic%shear
    call predict(law, law%elastic%shear, -2.0_dp/3.0_dp*law%elastic%shear, dt, side, grad, &
                 b(1, 1), b(1, s), strain, trace, jacobian, old_volume, work)
    call von_mises(b(1, s), mean, norm)
    call drucker_prager_shear(law%soil, 3.0_dp*law%elastic%shear, mean, norm, &
                              b(1, law%slots%plastic), factor)
    call relax(factor, mean, strain, trace, b(1, s), work)
    call equation_of_state(law, closing_t(dt, trace), mass, old_volume, b(1, 1), work, &
                           4.0_dp/3.0_dp*shear, ones, b(1, law%slots%energy), mean, speed2, q, &
                           pressure_work)
    work = work + pressure_work
    call cavitate(law, mass, old_volume, nb, b, mean, speed2, work)
    call add_mean(mean, b(1, s))
  end subroutine ground

  !> Scales the deviator of a stress, and gives it another mean.
  pure subroutine rescale(factor, mean, new_mean, stress)
    real(dp), intent(in) :: factor(lanes), mean(lanes), new_mean(lanes)
    real(dp), intent(inout) :: stress(lanes, NSTRESS)
    integer :: l, c
    !$omp simd simdlen(8) private(c)
    do l = 1, lanes
      do c = 1, 3
        stress(l, c) = factor(l)*(stress(l, c) - mean(l)) + new_mean(l)
      end do
      do c = 4, NSTRESS
        stress(l, c) = factor(l)*stress(l, c)
      end do
    end do
  end subroutine rescale

  !> Returns the trial stress of a foam to its ellipsoid.
  pure subroutine foam(law, strain, stress)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(inout) :: strain(lanes), stress(lanes, NSTRESS)
    real(dp) :: mean(lanes), norm(lanes), returned(lanes), factor(lanes)
    call von_mises(stress, mean, norm)
    returned = mean
    call crushable_foam_return(law%crushable_foam, law%elastic, norm, returned, strain, factor)
    call rescale(factor, mean, returned, stress)
  end subroutine foam

  !> Gives a clay the stress of a step, from that before it, turned.
  pure subroutine clay(law, dt, mass, old_volume, strain, trace, mean, nb, b, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, mass(lanes), old_volume(lanes), strain(lanes, NFLUX), trace(lanes)
    real(dp), intent(in) :: mean(lanes)          !! of the stress before
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: speed2(lanes), q(lanes)
    real(dp), intent(inout) :: work(lanes)
    real(dp), dimension(lanes) :: before, volume, bulk, shear, norm, pressure, factor, same
    integer :: l, s
    s = law%slots%stress
    associate (initial => law%cam_clay%volume*law%density/mass)
      before = initial*old_volume
      volume = initial*b(:, 1)
    end associate
    call cam_clay_moduli(law%cam_clay, before, -mean, bulk)
    shear = law%cam_clay%shear*bulk
    call add_shear(shear, strain, trace, b(1, s))
    call von_mises(b(1, s), same, norm)
    pressure = -mean
    call cam_clay_return(law%cam_clay, before, volume, shear, norm, pressure, &
                         b(1, law%slots%plastic), b(1, law%slots%preconsolidation), factor)
    call rescale(factor, same, -pressure, b(1, s))
    call cam_clay_moduli(law%cam_clay, volume, pressure, bulk)
    !$omp simd simdlen(8)
    do l = 1, lanes
      speed2(l) = bulk(l)*(1.0_dp + 4.0_dp/3.0_dp*law%cam_clay%shear)*b(l, 1)/mass(l)
    end do
    call add_half_work(b(1, s), strain, work)
    call viscosity(law, dt, mass, b(1, 1), trace, speed2, q)
  end subroutine clay

  !> Returns the trial stress of a ceramic to its strength, and gives it the pressure of its volume.
  pure subroutine ceramic(law, dt, mass, strain, trace, nb, b, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, mass(lanes), strain(lanes, NFLUX), trace(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: speed2(lanes), q(lanes)
    real(dp), intent(inout) :: work(lanes)
    real(dp), dimension(lanes) :: mean, norm, volume, rate, bulking, pressure, slope, factor
    integer :: l, s
    s = law%slots%stress
    call von_mises(b(1, s), mean, norm)
    call deviator_rate(dt, strain, trace, rate)
    volume = b(:, 1)*law%density/mass
    bulking = 0.0_dp
    if (law%slots%bulking > 0) bulking = b(:, law%slots%bulking)
    call johnson_holmquist_return(law%johnson_holmquist, volume, rate, norm, &
                                  b(1, law%slots%plastic), b(1, law%slots%damage), bulking, &
                                  pressure, slope, factor)
    if (law%slots%bulking > 0) b(:, law%slots%bulking) = bulking
    call rescale(factor, mean, -pressure, b(1, s))
    !$omp simd simdlen(8)
    do l = 1, lanes
      speed2(l) = (slope(l) + 4.0_dp/3.0_dp*law%elastic%shear*volume(l))/law%density
      ! Waves without a speed are left as they are, for the caller to see.
      speed2(l) = merge(speed2(l), slope(l)/law%density, slope(l) > 0.0_dp)
    end do
    call add_half_work(b(1, s), strain, work)
    call viscosity(law, dt, mass, b(1, 1), trace, speed2, q)
  end subroutine ceramic

  !> Returns the trial stress of concrete to its strength, and gives it the pressure of its volume.
  !!
  !! Rubble in the open bears no shear: its waves are not those of a modulus over its density, which
  !! would shorten the steps the more the farther it flies. It is taken to be no larger than a cell
  !! can tell, as debris is (sgmp_debris), so that it presses again when the room is gone.
  pure subroutine concrete(law, dt, mass, strain, trace, nb, b, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, mass(lanes), strain(lanes, NFLUX), trace(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: speed2(lanes), q(lanes)
    real(dp), intent(inout) :: work(lanes)
    real(dp), dimension(lanes) :: mean, norm, volume, rate, pressure, slope, factor
    real(dp) :: thin, most
    logical :: open
    integer :: l, s, d
    s = law%slots%stress
    d = law%slots%damage
    call von_mises(b(1, s), mean, norm)
    call deviator_rate(dt, strain, trace, rate)
    volume = b(:, 1)*law%density/mass
    call concrete_return(law%concrete, volume, rate, norm, b(1, law%slots%plastic), b(1, d), &
                         b(1, law%slots%compaction), pressure, slope, factor)
    call rescale(factor, mean, -pressure, b(1, s))
    !$omp simd simdlen(8) private(thin, most, open)
    do l = 1, lanes
      open = b(l, d) >= 1.0_dp .and. pressure(l) <= 0.0_dp
      thin = merge(min(volume(l), 1.0_dp), volume(l), open)
      most = debris_largest*mass(l)/law%density
      b(l, 1) = merge(most, b(l, 1), open .and. b(l, 1) > most)
      speed2(l) = (slope(l) + 4.0_dp/3.0_dp*law%elastic%shear*thin)/law%density
    end do
    call add_half_work(b(1, s), strain, work)
    call viscosity(law, dt, mass, b(1, 1), trace, speed2, q)
  end subroutine concrete

  !> Rate of the deviator of a strain, sqrt(2/3 e:e); none in a step without time.
  pure subroutine deviator_rate(dt, strain, trace, rate)
    real(dp), intent(in) :: dt, strain(lanes, NFLUX), trace(lanes)
    real(dp), intent(out) :: rate(lanes)
    real(dp) :: inverse, square(lanes)
    integer :: l
    inverse = 0.0_dp
    if (dt > 0.0_dp) inverse = 1.0_dp/dt
    call square_of(strain, square)
    !$omp simd simdlen(8)
    do l = 1, lanes
      rate(l) = inverse*sqrt(2.0_dp/3.0_dp*max(square(l) - trace(l)**2/3.0_dp, 0.0_dp))
    end do
  end subroutine deviator_rate

  !> work += 1/2 stress : strain.
  pure subroutine add_half_work(stress, strain, work)
    real(dp), intent(in) :: stress(lanes, NSTRESS), strain(lanes, NFLUX)
    real(dp), intent(inout) :: work(lanes)
    real(dp) :: double
    integer :: l, c
    !$omp simd simdlen(8) private(double, c)
    do l = 1, lanes
      double = 0.0_dp
      do c = 1, NFLUX
        double = double + stress(l, stress_of(c))*strain(l, c)
      end do
      work(l) = work(l) + 0.5_dp*double
    end do
  end subroutine add_half_work

  !> Rubbers, whose stress follows from b = F F^T.
  pure subroutine hyperelastic(law, dt, side, mass, grad, strain, trace, volume, stress, f, &
                               speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, side, mass(lanes), grad(lanes, NGRAD), strain(lanes, NFLUX), &
        trace(lanes), volume(lanes)
    real(dp), intent(inout) :: stress(lanes, NSTRESS), f(lanes, NDIM, NDIM)  !! f(:, b, a) = F_ab
    real(dp), intent(out) :: speed2(lanes), q(lanes)
    real(dp), intent(inout) :: work(lanes)
    real(dp) :: new(lanes, NDIM, NDIM), bij(lanes, NSTRESS), j(lanes), log_j(lanes)
#if NDIM > 1
    real(dp) :: ahead(lanes, NDIM, NDIM)
#endif
    integer :: l, a, b, c
    integer, parameter :: row(6) = voigt_axes(1, :), col(6) = voigt_axes(2, :)
    real(dp), parameter :: collapsed = 1.0e-100_dp  !! stands for a volume without a logarithm
    call deform(dt, grad, f, f, new)
#if NDIM > 1
    if (side < 0.0_dp) then  ! f + dt L f + dt^2 (L - tr L) L f
      call volume_rate(grad, log_j)
      do a = 1, NDIM
        do b = 1, NDIM
          ahead(:, b, a) = new(:, b, a) - dt*log_j*f(:, b, a)
        end do
      end do
      call deform(dt, grad, f, ahead, new)
    end if
#endif
    f = new
    do c = 1, NSTRESS
      if (row(c) > NDIM .or. col(c) > NDIM) then
        bij(:, c) = merge(1.0_dp, 0.0_dp, row(c) == col(c))
      else
        call row_product(f(1, 1, row(c)), f(1, 1, col(c)), bij(1, c))
      end if
    end do
    do l = 1, lanes
      j(l) = max(volume(l)*law%density/mass(l), collapsed)  ! the caller looks at the jacobian
#ifdef AXISYMMETRIC
      bij(l, hoop) = (j(l)/(f(l, 1, 1)*f(l, 2, 2) - f(l, 2, 1)*f(l, 1, 2)))**2
#endif
    end do
    !GCC$ novector
    do l = 1, lanes  ! vectors of logarithms are less exact
      log_j(l) = log(j(l))
    end do
    if (law%kind == material_mooney_rivlin) then
      call mooney_rivlin_stress(law%mooney_rivlin, NSTRESS, bij, j, log_j, stress, speed2)
      speed2 = speed2*volume/mass
    else
      call neo_hookean(law%elastic%shear, law%elastic%lambda, mass, volume, bij, j, log_j, stress, &
                       speed2)
    end if
    call add_half_work(stress, strain, work)
    call viscosity(law, dt, mass, volume, trace, speed2, q)
  end subroutine hyperelastic

  !> f + dt L g.
  pure subroutine deform(dt, grad, f, g, new)
    real(dp), intent(in) :: dt, grad(lanes, NGRAD), f(lanes, NDIM, NDIM), g(lanes, NDIM, NDIM)
    real(dp), intent(out) :: new(lanes, NDIM, NDIM)
    integer :: l, a, b, c
    do a = 1, NDIM
      do b = 1, NDIM
        new(:, b, a) = f(:, b, a)
        do c = 1, NDIM
          do l = 1, lanes
            new(l, b, a) = new(l, b, a) + dt*grad(l, (a - 1)*NDIM + c)*g(l, b, c)
          end do
        end do
      end do
    end do
  end subroutine deform

  !> Product of two rows of tensors.
  pure subroutine row_product(x, y, product)
    real(dp), intent(in) :: x(lanes, NDIM), y(lanes, NDIM)
    real(dp), intent(out) :: product(lanes)
    real(dp) :: total
    integer :: l, a
    !$omp simd simdlen(8) private(total, a)
    do l = 1, lanes
      total = 0.0_dp
      do a = 1, NDIM
        total = total + x(l, a)*y(l, a)
      end do
      product(l) = total
    end do
  end subroutine row_product

  !> Compressible neo-Hookean: sigma = (mu (b - I) + lambda ln J I)/J.
  pure subroutine neo_hookean(mu, lambda, mass, volume, bij, j, log_j, stress, speed2)
    real(dp), intent(in) :: mu, lambda, mass(lanes), volume(lanes), bij(lanes, NSTRESS), j(lanes), &
        log_j(lanes)
    real(dp), intent(out) :: stress(lanes, NSTRESS), speed2(lanes)
    integer :: l, c
    do c = 1, NSTRESS
      !$omp simd simdlen(8)
      do l = 1, lanes
        stress(l, c) = mu/j(l)*bij(l, c)
        if (c <= 3) stress(l, c) = stress(l, c) + (lambda*log_j(l) - mu)/j(l)
      end do
    end do
    !$omp simd simdlen(8)
    do l = 1, lanes
      speed2(l) = (lambda*(1.0_dp - log_j(l)) + mu)*volume(l)/(j(l)*mass(l)) &
                  + mu*max(bij(l, 1), bij(l, 2), bij(l, 3))*volume(l)/(j(l)*mass(l))
    end do
  end subroutine neo_hookean

  !> Plasticity of metals by radial return, with linear bulk response or an equation of state.
  ! allow(S902)
  subroutine plastic(law, dt, side, mass, grad, nb, b, trace, jacobian, old_volume, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, side, mass(lanes), grad(lanes, NGRAD)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: trace(lanes), jacobian(lanes), old_volume(lanes)
    real(dp), intent(out) :: speed2(lanes), q(lanes), work(lanes)
    real(dp) :: strain(lanes, NFLUX), mean(lanes), norm(lanes), factor(lanes), increment(lanes)
    real(dp) :: ones(lanes), pressure_work(lanes), failed(lanes), left(lanes), late(lanes)
    real(dp) :: shear(lanes), bulk, driven(lanes)
    type(debris_t) :: before
    integer :: l, s
    s = law%slots%stress
    shear = law%elastic%shear
    bulk = law%elastic%bulk
    if (law%fails) call judge(law, grad, nb, b, failed)
    if (law%softens) call softening_regain(NSTRESS, b(1, law%slots%damage), b(1, s), left)
    if (law%kind == material_steinberg_guinan) then
      call predict(law, 0.0_dp, 0.0_dp, dt, side, grad, b(1, 1), b(1, s), strain, trace, jacobian, &
                   old_volume, work)
      call stiffen(law, mass, old_volume, strain, trace, nb, b, shear)
    else
      call predict(law, law%elastic%shear, -2.0_dp/3.0_dp*law%elastic%shear, dt, side, grad, &
                   b(1, 1), b(1, s), strain, trace, jacobian, old_volume, work)
    end if
    call von_mises(b(1, s), mean, norm)
    if (law%softens) late = work - 0.5_dp*(mean*trace)
    if (law%fails) norm = (1.0_dp - failed)*norm
    driven = average_used(law, nb, b)
    call return_to_yield(law, shear, dt, norm, mean, nb, b, factor, increment)
    if (law%fails) factor = (1.0_dp - failed)*factor
    call relax(factor, mean, strain, trace, b(1, s), work)
    if (law%softens) then
      late = work - late
      work = left*work
    end if
    call debris_begin(law, old_volume, mean, nb, b, work, before)
    if (law%eos == eos_none) then
      !$omp simd simdlen(8)
      do l = 1, lanes
        speed2(l) = (bulk + 4.0_dp/3.0_dp*shear(l))*b(l, 1)/mass(l)
        work(l) = work(l) + (mean(l) + 0.5_dp*bulk*trace(l))*trace(l)
        mean(l) = mean(l) + bulk*trace(l)
      end do
      call viscosity(law, dt, mass, b(1, 1), trace, speed2, q)
    else
      ones = 1.0_dp
      call equation_of_state(law, closing_t(dt, trace), mass, old_volume, b(1, 1), work, &
                             4.0_dp/3.0_dp*shear, ones, b(1, law%slots%energy), &
                             mean, speed2, q, pressure_work)
      !$omp simd simdlen(8)
      do l = 1, lanes
        work(l) = work(l) + pressure_work(l)
      end do
      if (law%heating%warms) then
        call warm(law, mass, old_volume, b(1, 1), trace, b(1, law%slots%energy), q, &
                  b(1, law%slots%temperature))
      end if
    end if
    call wear(law, mean, driven, increment, nb, b)
    if (law%fails) then
      call come_apart(law, dt, mass, trace, left, late, before, nb, b, failed, mean, speed2, q, &
                      work)
    else if (any(speed2 < 0.0_dp) .and. .not. law%porosity%porous) then
      call tear_lanes(law, mass, before, trace, nb, b, mean, speed2, q, work)
    end if
    call add_mean(mean, b(1, s))
  end subroutine plastic

  !> The average of plastic strain that damage has seen so far; 0 where nothing is averaged.
  pure function average_used(law, nb, b) result(used)
    type(constitutive_t), intent(in) :: law
    integer, intent(in) :: nb
    real(dp), intent(in) :: b(lanes, nb)
    real(dp) :: used(lanes)
    used = 0.0_dp
    if (law%slots%averaged > 0) used = b(:, law%slots%averaging + averaging_values - 1)
  end function average_used

  !> Damage by the stress at the end of a step and the plastic strain in it, or its average.
  pure subroutine wear(law, mean, driven, increment, nb, b)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: mean(lanes)          !! of the stress
    real(dp), intent(in) :: driven(lanes)        !! average_used before the step
    real(dp), intent(inout) :: increment(lanes)  !! of plastic strain; over the strength after it
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)      !! with the deviator
    real(dp) :: deviator(lanes, 6)
    if (.not. ductility_given(law%failure%ductility)) return
    if (law%slots%averaged > 0) increment = b(:, law%slots%averaged) - driven
    deviator = 0.0_dp
    deviator(:, :NSTRESS) = b(:, law%slots%stress:law%slots%stress + NSTRESS - 1)
    if (law%slots%strength > 0) increment = increment/b(:, law%slots%strength)
    call ductility_lanes(law%failure%ductility, mean, deviator, increment, &
                         b(1, law%slots%damage))
    if (law%slots%averaged == 0) return
    b(:, law%slots%averaging + averaging_values - 1) = b(:, law%slots%averaged)
  end subroutine wear

  !> What failing and softening leave of a chunk's pressure, and of its deviator.
  subroutine come_apart(law, dt, mass, trace, left, late, before, nb, b, failed, mean, speed2, q, &
                        work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, mass(lanes), trace(lanes)
    real(dp), intent(in) :: left(lanes), late(lanes)    !! for those that soften
    type(debris_t), intent(in) :: before
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb), failed(lanes), mean(lanes), speed2(lanes), q(lanes)
    real(dp), intent(inout) :: work(lanes)
    logical :: lets_go
    lets_go = law%failure%carries /= carries_everything
    if (lets_go) then
      if (any(speed2 < 0.0_dp .or. b(:, 1)*law%density > law%apart*mass)) then
        call tear(law, mass, nb, b, speed2, failed)
      end if
    end if
    if (law%softens) then
      call soften(law, dt, left, mass, before%volume, trace, late, nb, b, mean, speed2, work)
    end if
    if (law%porosity%porous) then
      if (.not. law%softens) call release(law, failed, mass, before%volume, trace, nb, b, mean, &
                                          speed2, work)
    else if (lets_go) then
      if (any(failed > 0.5_dp)) call debris_lanes(law, dt, failed, mass, trace, before, nb, b, &
                                                  mean, speed2, q, work)
    else if (any(speed2 < 0.0_dp)) then
      call tear_lanes(law, mass, before, trace, nb, b, mean, speed2, q, work)
    end if
  end subroutine come_apart

  !> Matter with a card `failure` whose equation of state has no waves left in expansion, or would
  !! have none if it were cold, fails.
  pure subroutine tear(law, mass, nb, b, speed2, failed)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: mass(lanes), speed2(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb), failed(lanes)
    integer :: l
    do l = 1, lanes
      if (b(l, 1)*law%density <= mass(l)) cycle
      if (speed2(l) >= 0.0_dp .and. b(l, 1)*law%density <= law%apart*mass(l)) cycle
      b(l, law%slots%damage) = 1.0_dp
      failed(l) = 1.0_dp
      b(l, law%slots%stress:law%slots%stress + NSTRESS - 1) = 0.0_dp
    end do
  end subroutine tear

  !> Shear modulus of each lane, and the stress that its shear strain adds with it.
  pure subroutine stiffen(law, mass, old_volume, strain, trace, nb, b, shear)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: mass(lanes), old_volume(lanes), strain(lanes, NFLUX), trace(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: shear(lanes)
    real(dp) :: pressure(lanes), v(lanes), temperature(lanes)
    integer :: s
    s = law%slots%stress
    pressure = -(b(:, s) + b(:, s + 1) + b(:, s + 2))*(1.0_dp/3.0_dp)
    v = old_volume*law%density/mass
    temperature = law%history%first_temperature
    if (law%heating%warms) temperature = b(:, law%slots%temperature)
    call steinberg_guinan_stiffness(law%steinberg_guinan, pressure, v, temperature, shear)
    shear = law%elastic%shear*shear
    call add_shear(shear, strain, trace, b(1, s))
  end subroutine stiffen

  !> Adds the deviator that a strain makes with the shear modulus of each lane.
  pure subroutine add_shear(shear, strain, trace, stress)
    real(dp), intent(in) :: shear(lanes), strain(lanes, NFLUX), trace(lanes)
    real(dp), intent(inout) :: stress(lanes, NSTRESS)
    real(dp) :: third(lanes)
    integer :: c
    third = (2.0_dp/3.0_dp)*shear*trace
    do c = 1, 3
      stress(:, c) = stress(:, c) - third
    end do
    do c = 1, NFLUX
      if (stress_of(c) <= 3) then
        stress(:, stress_of(c)) = stress(:, stress_of(c)) + 2.0_dp*shear*strain(:, c)
      else
        stress(:, stress_of(c)) = stress(:, stress_of(c)) + shear*strain(:, c)
      end if
    end do
  end subroutine add_shear

  !> Which lanes have failed, by the stress and history at the beginning of the step.
  subroutine judge(law, grad, nb, b, failed)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: grad(lanes, NGRAD)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: failed(lanes)  !! 1 or 0
    real(dp) :: stress(lanes, 6), plastic(lanes), rate(lanes)
    if (law%softens) then  ! damage grows with the stress at the end of a step
      failed = merge(1.0_dp, 0.0_dp, b(:, law%slots%damage) >= 1.0_dp)
      return
    end if
    stress = 0.0_dp
    stress(:, :NSTRESS) = b(:, law%slots%stress:law%slots%stress + NSTRESS - 1)
    plastic = b(:, law%slots%plastic)
    if (law%slots%averaged > 0) plastic = b(:, law%slots%averaged)
    if (law%slots%strength > 0) then
      stress = stress/spread(b(:, law%slots%strength), 2, 6)
      plastic = plastic/b(:, law%slots%strength)
    end if
    if (law%failure%toughness > 0.0_dp) then
      call volume_rate(grad, rate)
      call failure_judge(law%failure, stress, plastic, b(1, law%slots%damage), failed, &
                         failure_tension(law%failure, rate))
    else
      call failure_judge(law%failure, stress, plastic, b(1, law%slots%damage), failed)
    end if
  end subroutine judge

  !> Trace of a velocity gradient.
  pure subroutine volume_rate(grad, rate)
    real(dp), intent(in) :: grad(lanes, NGRAD)
    real(dp), intent(out) :: rate(lanes)
    integer :: a
    rate = 0.0_dp
    do a = 1, NDIM
      rate = rate + grad(:, (a - 1)*NDIM + a)
    end do
#ifdef AXISYMMETRIC
    rate = rate + grad(:, NGRAD)
#endif
  end subroutine volume_rate

  !> Mean of a stress and von Mises norm of its deviator.
  pure subroutine von_mises(stress, mean, norm)
    real(dp), intent(in) :: stress(lanes, NSTRESS)
    real(dp), intent(out) :: mean(lanes), norm(lanes)
    real(dp) :: m, square
    integer :: l, c
    !$omp simd simdlen(8) private(m, square, c)
    do l = 1, lanes
      m = (stress(l, 1) + stress(l, 2) + stress(l, 3))*(1.0_dp/3.0_dp)
      square = (stress(l, 1) - m)**2 + (stress(l, 2) - m)**2 + (stress(l, 3) - m)**2
      do c = 4, NSTRESS
        square = square + 2.0_dp*stress(l, c)**2
      end do
      mean(l) = m
      norm(l) = sqrt(1.5_dp*square)
    end do
  end subroutine von_mises

  !> Scales the deviator of the trial stress back to the yield surface.
  pure subroutine relax(factor, mean, strain, trace, stress, work)
    real(dp), intent(in) :: factor(lanes), mean(lanes), strain(lanes, NFLUX), trace(lanes)
    real(dp), intent(inout) :: stress(lanes, NSTRESS)  !! in: trial stress; out: deviator
    real(dp), intent(inout) :: work(lanes)  !! in: 1/2 old stress : strain; out: work of the
                                            !! deviator
    real(dp) :: double
    integer :: l, c
    !$omp simd simdlen(8) private(double, c)
    do l = 1, lanes
      do c = 1, 3
        stress(l, c) = factor(l)*(stress(l, c) - mean(l))
      end do
      do c = 4, NSTRESS
        stress(l, c) = factor(l)*stress(l, c)
      end do
      double = 0.0_dp
      do c = 1, NFLUX
        double = double + stress(l, stress_of(c))*strain(l, c)
      end do
      work(l) = (work(l) - 0.5_dp*(mean(l)*trace(l))) + 0.5_dp*double
    end do
  end subroutine relax

  !> Adds a mean to a deviator.
  pure subroutine add_mean(mean, stress)
    real(dp), intent(in) :: mean(lanes)
    real(dp), intent(inout) :: stress(lanes, NSTRESS)
    integer :: l, c
    !$omp simd simdlen(8) private(c)
    do l = 1, lanes
      do c = 1, 3
        stress(l, c) = stress(l, c) + mean(l)
      end do
    end do
  end subroutine add_mean

  !> Radial return of the law at hand, to the yield stress of each lane where it scatters.
  subroutine return_to_yield(law, shear, dt, norm, mean, nb, b, factor, increment)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: shear(lanes), dt, norm(lanes), mean(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: factor(lanes), increment(lanes)
    real(dp) :: scatter(lanes)
    if (law%slots%yield_factor == 0) then
      call return_to(law, shear, dt, norm, mean, nb, b, factor, increment)
    else
      scatter = b(:, law%slots%yield_factor)
      call return_to(law, shear, dt, norm, mean, nb, b, factor, increment, scatter)
    end if
  end subroutine return_to_yield

  !> Radial return to the yield stress, times a factor where one is given.
  subroutine return_to(law, shear, dt, norm, mean, nb, b, factor, increment, scatter)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: shear(lanes), dt, norm(lanes), mean(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: factor(lanes), increment(lanes)
    real(dp), intent(in), optional :: scatter(lanes)
    real(dp) :: damage(lanes), temperature(lanes), driving(lanes), shear3
    real(dp), allocatable :: loss(:)             !! absent from calls where damage takes no strength
    shear3 = 3.0_dp*law%elastic%shear
    temperature = law%history%first_temperature
    if (law%slots%temperature > 0) temperature = b(:, law%slots%temperature)
    select case (law%kind)
    case (material_j2)
      call j2_return(law%j2, shear3, norm, b(1, law%slots%plastic), factor, increment, scatter)
    case (material_steinberg_guinan)
      call steinberg_guinan_return(law%steinberg_guinan, shear3, shear/law%elastic%shear, norm, &
                                   b(1, law%slots%plastic), temperature, factor, increment, &
                                   scatter)
    case (material_zerilli_armstrong)
      call zerilli_armstrong_return(law%zerilli_armstrong, shear3, dt, norm, &
                                    b(1, law%slots%plastic), temperature, factor, increment, &
                                   scatter)
    case default  ! material_johnson_cook
      if (.not. (law%thermal .or. law%jc%failure)) then
        call jc_return_simple(law%jc, shear3, dt, norm, b(1, law%slots%plastic), factor, &
                              increment, scatter)
        return
      end if
      damage = 0.0_dp
      if (law%jc%failure .and. law%slots%strength == 0) damage = b(:, law%slots%damage)
      if (law%jc%critical_damage > 0.0_dp) then
        loss = law%jc%critical_damage*b(:, law%slots%damage)
      end if
      if (law%slots%averaged == 0) then
        call jc_return(law%jc, shear3, dt, norm, mean, b(1, law%slots%plastic), temperature, &
                       damage, factor, increment, scatter, loss=loss)
      else
        driving = b(:, law%slots%averaged) - b(:, law%slots%averaging + averaging_values - 1)
        b(:, law%slots%averaging + averaging_values - 1) = b(:, law%slots%averaged)
        call jc_return(law%jc, shear3, dt, norm, mean, b(1, law%slots%plastic), temperature, &
                       damage, factor, increment, scatter, driving, loss)
      end if
      if (law%jc%failure .and. law%slots%strength > 0) then
        damage = min(1.0_dp, b(:, law%slots%damage) + damage/b(:, law%slots%strength))
      end if
      if (law%jc%failure) b(:, law%slots%damage) = damage
    end select
    if (law%slots%temperature > 0) b(:, law%slots%temperature) = temperature
  end subroutine return_to

  !> A fluid: pressure from the equation of state, and Newton's viscous stress where it has one.
  subroutine fluid(law, closing, mass, old_volume, strain, nb, b, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    type(closing_t), intent(in) :: closing
    real(dp), intent(in) :: mass(lanes), old_volume(lanes), strain(lanes, NFLUX)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: speed2(lanes), q(lanes), work(lanes)
    real(dp) :: mean(lanes), viscous_work(lanes), ones(lanes), no_shear(lanes)
    integer :: l, s
    s = law%slots%stress
    ones = 1.0_dp
    no_shear = 0.0_dp
    if (law%slots%stresses == 1) then
      viscous_work = 0.0_dp
      call equation_of_state(law, closing, mass, old_volume, b(1, 1), viscous_work, no_shear, &
                             ones, b(1, law%slots%energy), b(1, s), speed2, q, work)
      if (law%fails) call cavitate(law, mass, old_volume, nb, b, b(1, s), speed2, work)
      return
    end if
    call newtonian(law%fluid_viscosity, closing%dt, strain, closing%trace, b(1, s), mean, &
                   viscous_work)
    call equation_of_state(law, closing, mass, old_volume, b(1, 1), viscous_work, no_shear, ones, &
                           b(1, law%slots%energy), mean, speed2, q, work)
    if (law%fails) call cavitate(law, mass, old_volume, nb, b, mean, speed2, work)
    call add_mean(mean, b(1, s))
    !$omp simd simdlen(8)
    do l = 1, lanes
      work(l) = work(l) + viscous_work(l)
      speed2(l) = merge((sqrt(max(speed2(l), 0.0_dp)) &
                         + fluid_diffusion_speed(law%fluid_viscosity, mass(l)/b(l, 1), law%h))**2, &
                        speed2(l), speed2(l) >= 0.0_dp)
    end do
  end subroutine fluid

  !> Viscous stress 2 eta dev D of the step, its work per old volume, and the mean of the old
  !! stress.
  pure subroutine newtonian(viscosity, dt, strain, trace, stress, mean, work)
    real(dp), intent(in) :: viscosity, dt, strain(lanes, NFLUX), trace(lanes)
    real(dp), intent(inout) :: stress(lanes, NSTRESS)  !! in: old stress; out: new viscous stress
    real(dp), intent(out) :: mean(lanes), work(lanes)
    real(dp) :: eta, old, double
    integer :: l, c
    eta = 0.0_dp
    if (dt > 0.0_dp) eta = viscosity/dt
    !$omp simd simdlen(8) private(old, double, c)
    do l = 1, lanes
      mean(l) = (stress(l, 1) + stress(l, 2) + stress(l, 3))*(1.0_dp/3.0_dp)
      old = -mean(l)*trace(l)
      do c = 1, NFLUX
        old = old + stress(l, stress_of(c))*strain(l, c)
      end do
      do c = 1, 3
        stress(l, c) = -(2.0_dp/3.0_dp)*eta*trace(l)
      end do
      double = 0.0_dp
      do c = 1, NFLUX
        if (stress_of(c) <= 3) then
          stress(l, stress_of(c)) = stress(l, stress_of(c)) + 2.0_dp*eta*strain(l, c)
        else
          stress(l, stress_of(c)) = eta*strain(l, c)
        end if
        double = double + stress(l, stress_of(c))*strain(l, c)
      end do
      work(l) = 0.5_dp*(old + double)
    end do
  end subroutine newtonian

  !> Diagonal of the deformation gradient, for the size of particles.
  pure subroutine stretch(dt, grad, diagonal)
    real(dp), intent(in) :: dt, grad(lanes, NGRAD)
    real(dp), intent(inout) :: diagonal(lanes, NDIM)
    integer :: a
    do a = 1, NDIM
      diagonal(:, a) = diagonal(:, a)*(1.0_dp + dt*grad(:, (a - 1)*NDIM + a))
    end do
  end subroutine stretch

end module DIM(sgmp_stress_update)
