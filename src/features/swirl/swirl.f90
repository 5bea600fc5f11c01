!> The velocity around the axis of axisymmetric scenes with swirl (theory 8): what a chunk of
!! particles has to do for it.
!!
!! Particles carry the moment of that velocity, v_theta X with X the radius in cells, and the grid
!! its rate v_theta/X. So a rigid rotation strains nothing, and stresses exert a moment about the
!! axis whose sum over the nodes vanishes. In the axes r, z, theta that turn with the particle the
!! strains of swirl are two shears of a velocity gradient in space, and the stress update is that of
!! space.
module sgmp_swirl
  use sgmp_constitutive, only: constitutive_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_stress_update_3d, only: stress_flux, stress_update
  use sgmp_sums, only: sum_angular, sum_kinetic, sum_mass_aa, sum_swirl, sweep_sums
  implicit none
  private
  public :: swirl_blend, swirl_kick, swirl_drift, swirl_strain, swirl_flux, swirl_collect

  integer, parameter :: swirl_moments = 2   !! columns: m v_theta X, m X^2
  integer, parameter :: swirl_stresses = 3
    !! X sigma_r_theta V, X sigma_z_theta V, centrifugal force
  integer, parameter :: flux_columns = 4    !! of the half-plane: rr zz rz theta theta
  integer, parameter :: flux_space = 6      !! of space: rr zz theta theta, rz, z theta, r theta
  integer, parameter :: grad_plane = 5, grad_space = 9  !! components of the velocity gradient
  integer, parameter :: plane(flux_columns) = [1, 2, 4, 3]  !! of these those of the half-plane
  real(dp), parameter :: least_radius = 1.0e-12_dp  !! (cells) of a particle on the axis

contains

  !> PIC: a part of v_theta X is that of the grid before the kick.
  pure subroutine swirl_blend(dt, flip, radius, acceleration, rate, moment)
    real(dp), intent(in) :: dt, flip           !! velocity step, weight of FLIP
    real(dp), intent(in) :: radius(lanes), acceleration(lanes)
    real(dp), intent(in) :: rate(lanes)        !! v_theta/X of the grid after the kick
    real(dp), intent(inout) :: moment(lanes)   !! v_theta X
    moment = flip*moment + (1.0_dp - flip)*(max(radius, least_radius)**2* &
                                            (rate - dt*acceleration))
  end subroutine swirl_blend

  !> v_theta X += dt X^2 a, a the acceleration of v_theta/X; sums for the energy ledger.
  pure subroutine swirl_kick(dt, live, radius, mass, acceleration, moment, lane_sums)
    real(dp), intent(in) :: dt, live(lanes), radius(lanes), mass(lanes), acceleration(lanes)
    real(dp), intent(inout) :: moment(lanes)   !! v_theta X
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    real(dp) :: m, square
    integer :: l
    !$omp simd simdlen(8) private(m, square)
    do l = 1, lanes
      m = live(l)*mass(l)
      square = max(radius(l), least_radius)**2
      moment(l) = moment(l) + dt*(square*acceleration(l))
      lane_sums(l, sum_angular) = lane_sums(l, sum_angular) + m*moment(l)
      lane_sums(l, sum_mass_aa) = lane_sums(l, sum_mass_aa) + m*(square*acceleration(l)**2)
      lane_sums(l, sum_kinetic) = lane_sums(l, sum_kinetic) + 0.5_dp*m*moment(l)**2/square
    end do
  end subroutine swirl_kick

  !> Books the kinetic energy that swirl loses where a ring widens and keeps its moment; the
  !! centrifugal force has given it to the radial motion.
  pure subroutine swirl_drift(live, before, after, mass, moment, lane_sums)
    real(dp), intent(in) :: live(lanes), before(lanes), after(lanes)  !! radii (cells)
    real(dp), intent(in) :: mass(lanes), moment(lanes)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    integer :: l
    !$omp simd simdlen(8)
    do l = 1, lanes
      lane_sums(l, sum_swirl) = lane_sums(l, sum_swirl) + 0.5_dp*live(l)*mass(l)*moment(l)**2* &
                                (1.0_dp/max(before(l), least_radius)**2 &
                                 - 1.0_dp/max(after(l), least_radius)**2)
    end do
  end subroutine swirl_drift

  !> Stress update with swirl, and the stresses that the grid wants.
  ! allow(S902)
  subroutine swirl_strain(law, dt, behind, time, inverse_h, radius, mass, live, grad, slope, nb, &
                          state, flux, speed2, jacobian, internal, viscous)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, time, inverse_h
    logical, intent(in) :: behind              !! as of the stress update
    real(dp), intent(in) :: radius(lanes), mass(lanes), live(lanes)
    real(dp), intent(in) :: grad(lanes, grad_plane)  !! rr rz zr zz, hoop strain rate
    real(dp), intent(in) :: slope(lanes, 2)    !! of v_theta/X along r and z
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb)
    real(dp), intent(out) :: flux(lanes, flux_columns + swirl_stresses)
    real(dp), intent(out) :: speed2(lanes), jacobian(lanes)  !! as of the stress update
    real(dp), intent(inout) :: internal(lanes), viscous(lanes)
    real(dp) :: in_space(lanes, grad_space), all(lanes, flux_space)
    in_space(:, 1:2) = grad(:, 1:2)
    in_space(:, 3) = 0.0_dp
    in_space(:, 4:5) = grad(:, 3:4)
    in_space(:, 6) = 0.0_dp
    in_space(:, 7) = radius*slope(:, 1)
    in_space(:, 8) = radius*slope(:, 2)
    in_space(:, 9) = grad(:, 5)
    call stress_update(law, dt, time, mass, live, in_space, nb, state, all, speed2, jacobian, &
                       internal, viscous, behind)
    call arrange(law, inverse_h, radius, mass, live, nb, state, all, flux)
  end subroutine swirl_strain

  !> The stresses that the grid wants, as they are.
  pure subroutine swirl_flux(law, inverse_h, radius, mass, live, nb, state, flux)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: inverse_h, radius(lanes), mass(lanes), live(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    real(dp), intent(out) :: flux(lanes, flux_columns + swirl_stresses)
    real(dp) :: all(lanes, flux_space), none(lanes)
    none = 0.0_dp
    call stress_flux(law, state(1, 1), none, live, state(1, law%slots%stress), all)
    call arrange(law, inverse_h, radius, mass, live, nb, state, all, flux)
  end subroutine swirl_flux

  !> Stresses of the half-plane, those that exert a moment, and the centrifugal force.
  pure subroutine arrange(law, inverse_h, radius, mass, live, nb, state, all, flux)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: inverse_h, radius(lanes), mass(lanes), live(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb), all(lanes, flux_space)
    real(dp), intent(out) :: flux(lanes, flux_columns + swirl_stresses)
    flux(:, :flux_columns) = all(:, plane)
    flux(:, flux_columns + 1) = radius*all(:, 6)
    flux(:, flux_columns + 2) = radius*all(:, 5)
    flux(:, flux_columns + 3) = inverse_h*live*mass*state(:, law%slots%swirl)**2/ &
                                max(radius, least_radius)**3
  end subroutine arrange

  !> The moments that the grid wants.
  pure subroutine swirl_collect(live, radius, mass, moment, values)
    real(dp), intent(in) :: live(lanes), radius(lanes), mass(lanes), moment(lanes)
    real(dp), intent(out) :: values(lanes, swirl_moments)
    values(:, 1) = live*mass*moment
    values(:, 2) = live*mass*radius**2
  end subroutine swirl_collect

end module sgmp_swirl
