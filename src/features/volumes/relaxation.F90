! dimension-generic, axisymmetric
#include "dimension.inc"
!> The particles' part of kept volumes (doc/volumes.md): a chunk relaxes towards the centres around
!! it, and gives them what they need for the next step.
module DIM(sgmp_relaxation)
  use sgmp_columns, only: relax_dilation, relax_exchange, relax_filling, relax_filter, &
                          relax_square, relax_stiffness, relax_velocity
  use sgmp_constitutive, only: constitutive_t, law_gaseous, law_is_spherical
  use sgmp_kinds, only: dp, lanes
  use sgmp_motion, only: motion_mass, motion_total, motion_velocity
  use sgmp_sums, only: sum_filter, sum_internal, sum_volume, sweep_sums
  implicit none
  private
  public :: relaxation_apply, relaxation_collect, relaxation_square

  integer, parameter :: before_v = motion_velocity(NDIM) - 1, mass_at = motion_mass(NDIM)

contains

  !> Velocities, volumes and energies of a chunk after they have relaxed, and the divergence that
  !! normalised stress works on.
  pure subroutine relaxation_apply(law, dt, live, relax, nb, motion, state, gradient, lane_sums)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt                 !! strain step
    real(dp), intent(in) :: live(lanes)        !! 1 for particles, 0 for pads
    real(dp), intent(in) :: relax(lanes, *)    !! gathered from the centres; 0 in pads
    integer, intent(in) :: nb
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: gradient(lanes, NGRAD)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    real(dp) :: heat(lanes), strain(lanes)
    integer :: d
    call filter_velocity(live, relax, motion, heat)
    lane_sums(:, sum_filter) = lane_sums(:, sum_filter) + heat
    lane_sums(:, sum_internal) = lane_sums(:, sum_internal) + heat
    if (law%slots%compliance == 0) return
    if (law_is_spherical(law)) then
      do d = 1, NDIM
        gradient(:, (d - 1)*NDIM + d) = gradient(:, (d - 1)*NDIM + d) &
                                        + relax(:, relax_dilation)/real(NDIM, dp)
      end do
    end if
    strain = 0.0_dp
    do d = 1, NDIM
      strain = strain + dt*gradient(:, (d - 1)*NDIM + d)
    end do
#ifdef AXISYMMETRIC
    strain = strain + dt*gradient(:, NGRAD)
#endif
    call exchange_volume(law, live, motion(1, mass_at), relax, abs(strain), heat, nb, state, &
                         lane_sums)
  end subroutine relaxation_apply

  !> dv = -sum N a (v - v_c), and the kinetic energy that is lost with it:
  !! m (sum N a |v - v_c|^2 - |dv|^2/2), which is positive for every particle.
  pure subroutine filter_velocity(live, relax, motion, heat)
    real(dp), intent(in) :: live(lanes), relax(lanes, *)
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(out) :: heat(lanes)
    real(dp) :: change, v
    integer :: l, d
    heat = relax(:, relax_square)
    do d = 1, NDIM
      !$omp simd simdlen(8) private(change, v)
      do l = 1, lanes
        v = motion(l, before_v + d)
        change = relax(l, relax_velocity + d - 1) - relax(l, relax_filter)*v
        heat(l) = heat(l) - v*(relax(l, relax_velocity + d - 1) + change) - 0.5_dp*change**2
        motion(l, before_v + d) = v + change
      end do
    end do
    heat = live*motion(:, mass_at)*heat
  end subroutine filter_velocity

  !> Volume and energy that particles exchange where their pressures differ,
  !!     dV = w sum N b (p - p_c),   dE = -w sum N b (p - p_c) p_c,
  !! and the volume that cells take or give where particles fill them wrongly, without work: it was
  !! done when the volume drifted.
  pure subroutine exchange_volume(law, live, mass, relax, strain, heat, nb, state, lane_sums)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: live(lanes), mass(lanes), relax(lanes, *), heat(lanes)
    real(dp), intent(in) :: strain(lanes)      !! by which the volume changes in the step, > 0
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb), lane_sums(lanes, sweep_sums)
    real(dp) :: p(lanes), energy(lanes), exchanged(lanes), change(lanes)
    integer :: l
    p = pressure(law, nb, state)
    change = max(-strain, min(strain, relax(:, relax_filling)))
    if (.not. law_gaseous(law)) change = min(change, 0.0_dp)
    associate (w => state(:, law%slots%compliance), volume => state(:, 1))
      !$omp simd simdlen(8)
      do l = 1, lanes
        exchanged(l) = volume(l) + w(l)*(relax(l, relax_exchange)*p(l) &
                                         - relax(l, relax_exchange + 1))
        energy(l) = live(l)*w(l)*(relax(l, relax_exchange + 2) - relax(l, relax_exchange + 1)*p(l))
      end do
      volume = exchanged
      if (any(abs(change) > 0.0_dp)) volume = exchanged*exp(change)
      !$omp simd simdlen(8)
      do l = 1, lanes
        lane_sums(l, sum_internal) = lane_sums(l, sum_internal) + energy(l)
        lane_sums(l, sum_volume) = lane_sums(l, sum_volume) &
                                   + live(l)*abs((volume(l) - exchanged(l))*p(l))
      end do
    end associate
    associate (e => state(:, law%slots%energy))
      e = e + (energy + heat)*(law%density/mass)
    end associate
  end subroutine exchange_volume

  !> What the centres need for the next step: m c^2, the compliance w = 2 V/(K + sum N K_c) that the
  !! particle exchanges volume with, w p, w p^2.
  pure subroutine relaxation_collect(law, live, mass, speed2, stiffness, nb, state, values)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: live(lanes), mass(lanes)
    real(dp), intent(in) :: speed2(lanes)      !! square of the sound speed
    real(dp), intent(in) :: stiffness(lanes)   !! bulk modulus around the particle, 0: unknown
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb)
    real(dp), intent(inout) :: values(lanes, 4)
    real(dp) :: own, around, p(lanes)
    integer :: l
    values(:, 1) = live*mass*max(speed2, 0.0_dp)
    values(:, 2:) = 0.0_dp
    if (law%slots%compliance == 0) return
    p = pressure(law, nb, state)
    associate (w => state(:, law%slots%compliance), volume => state(:, 1))
      !$omp simd simdlen(8) private(own, around)
      do l = 1, lanes
        own = max(mass(l)*speed2(l), tiny(1.0_dp))
        around = stiffness(l)*volume(l)
        w(l) = 2.0_dp*volume(l)**2/(own + merge(around, own, around > 0.0_dp))
        values(l, 2) = live(l)*w(l)
        values(l, 3) = values(l, 2)*p(l)
        values(l, 4) = values(l, 3)*p(l)
      end do
    end associate
  end subroutine relaxation_collect

  !> m |v|^2 of a chunk. Gas slides along a solid, and the difference of their velocities is no
  !! noise: where a solid is the variance is made negative, and nothing is filtered.
  pure subroutine relaxation_square(law, live, motion, square)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: live(lanes), motion(lanes, motion_total(NDIM))
    real(dp), intent(out) :: square(lanes)
    real(dp), parameter :: solid = -1.0e6_dp  !! a trace of it outweighs all noise of a gas
    integer :: d
    square = 0.0_dp
    do d = 1, NDIM
      square = square + motion(:, before_v + d)**2
    end do
    if (.not. law_is_spherical(law)) square = solid*(square + law%bulk_speed**2)
    square = live*motion(:, mass_at)*square
  end subroutine relaxation_square

  !> Pressure of a chunk.
  pure function pressure(law, nb, state) result(p)
    type(constitutive_t), intent(in) :: law
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    real(dp) :: p(lanes)
    associate (s => law%slots%stress)
      if (law%slots%stresses == 1) then
        p = -state(:, s)
      else
        p = -(state(:, s) + state(:, s + 1) + state(:, s + 2))*(1.0_dp/3.0_dp)
      end if
    end associate
  end function pressure

end module DIM(sgmp_relaxation)
