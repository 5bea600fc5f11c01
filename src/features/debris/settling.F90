! dimension-generic, axisymmetric
#include "dimension.inc"
!> What the stress of debris gives to the grid in a kick, settled with its internal energy particle
!! by particle (doc/materials.md, Debris).
!!
!! The trapezoidal rule takes half of the work of a stress with the strain of the update that made
!! it, half with that of the next one. That closes where the velocity of the grid is the same at the
!! end of a step and at the start of the next. It is not where particles have crossed cells, nor
!! where nodes are kicked in ways that particles do not follow (update=usl, usf): what expands then
!! pays too much or too little, always with the same sign. Stresses add to the kinetic energy of
!! the particles, to round-off and for all kernels, -sum g_p - sum s_p with
!!
!!     g_p = dt V_p (sigma_p - q_p I) : grad(v + k/2)                                  (DB4)
!!     s_p = m_p/2 (sum S |k|^2 - |sum S k|^2)                                         (DB5)
!!
!! where v is the velocity of the grid, k = a dt its kick, and s_p what is lost as nodes hand it on.
!! About an axis the radial |k|^2 has the inertia of its node (theory 7). The energy of debris, from
!! which sgmp_debris has taken an advance, becomes
!!
!!     E_p <- E_p + advance + (g_p + s_p)/V0                                           (DB6)
!!
!! MUSL strains with w, the particles' velocity after the kick. There v + k in g_p is w and s_p is 0:
!! before the kick the half with v is settled, and the stress update settles that with w.
module DIM(sgmp_settling)
  use sgmp_constitutive, only: constitutive_t
  use sgmp_debris, only: debris_mark, debris_settled
  use sgmp_kinds, only: dp, lanes
  use sgmp_motion, only: motion_mass, motion_total
  implicit none
  private
  public :: settling_chunk, settling_part

  integer, parameter :: mass_at = motion_mass(NDIM)

contains

  !> Part of the kick with which the gradient of (DB4) is read.
  pure function settling_part(by_halves) result(part)
    logical, intent(in) :: by_halves             !! only the first half is settled before the kick
    real(dp) :: part
    part = merge(0.0_dp, 0.5_dp, by_halves)
  end function settling_part

  !> (DB6) for those particles of a chunk that have failed and whose stress is yet to act.
  pure subroutine settling_chunk(law, by_halves, dt, live, gradient, kick, square, motion, nb, &
                                 state, internal)
    type(constitutive_t), intent(in) :: law      !! that settles
    logical, intent(in) :: by_halves             !! only the half with v
    real(dp), intent(in) :: dt                   !! velocity step
    real(dp), intent(in) :: live(lanes)
    real(dp), intent(in) :: gradient(lanes, NGRAD)  !! of v + k/2 or v
    real(dp), intent(in) :: kick(lanes, NDIM), square(lanes)  !! over dt: sum S k, sum S |k|^2
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb), internal(lanes)
    real(dp) :: gain, part, handed
    integer :: l, s
    s = law%slots%stress
    part = merge(0.5_dp, 1.0_dp, by_halves)
    handed = merge(0.0_dp, 0.5_dp*law%density*dt**2, by_halves)
    do l = 1, lanes
      if (live(l) < 0.5_dp .or. state(l, law%slots%damage) < 1.0_dp) cycle
      if (debris_settled(state(l, law%slots%viscous))) cycle
      gain = state(l, law%slots%advanced) + handed*(square(l) - sum(kick(l, :)**2))
      gain = gain + (sum(state(l, s:s + 2))/3.0_dp - state(l, law%slots%viscous))* &
             (law%density/motion(l, mass_at))*state(l, 1)*part*dt*divergence(gradient(l, :))
      if (law%slots%energy > 0) state(l, law%slots%energy) = state(l, law%slots%energy) + gain
      internal(l) = internal(l) + gain*motion(l, mass_at)/law%density
      state(l, law%slots%advanced) = 0.0_dp
      state(l, law%slots%viscous) = debris_mark(by_halves, state(l, law%slots%viscous))
    end do
  end subroutine settling_chunk

  !> Trace of a velocity gradient.
  pure function divergence(gradient) result(rate)
    real(dp), intent(in) :: gradient(NGRAD)
    real(dp) :: rate
    integer :: a
    rate = 0.0_dp
    do a = 1, NDIM
      rate = rate + gradient((a - 1)*NDIM + a)
    end do
#ifdef AXISYMMETRIC
    rate = rate + gradient(NGRAD)
#endif
  end function divergence

end module DIM(sgmp_settling)
