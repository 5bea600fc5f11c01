! dimension-generic
#include "dimension.inc"
!> Inelastic collisions of debris, the particles' part (doc/materials.md, Debris): what a chunk
!! gives to the points around it, and the velocities that it takes on there.
module DIM(sgmp_collisions)
  use sgmp_columns, only: collide_rate, collide_square, collide_velocity
  use sgmp_constitutive, only: constitutive_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_motion, only: motion_mass, motion_total, motion_velocity
  implicit none
  private
  public :: collisions_apply, collisions_collect, collisions_plan

  integer, parameter :: before_v = motion_velocity(NDIM) - 1, mass_at = motion_mass(NDIM)
  real(dp), parameter :: seen = 0.25_dp  !! (v - v_grid)^2 of a linear field, over h^2 slope^2: at
                                         !! most that, where particles lie unevenly
  real(dp), parameter :: noticed = 1.0e-3_dp  !! of the speed of sound: less is no collision

contains

  !> Mass and momentum of a chunk, and of its debris what the grid does not see: mass times the part
  !! w of u^2 that exceeds what a linear field explains, and that mass times u^2, where
  !! u = v - sum N v_I.
  pure subroutine collisions_collect(loose, live, h, speed, velocity, gradient, motion, values)
    real(dp), intent(in) :: loose(lanes), live(lanes)  !! 1 or 0
    real(dp), intent(in) :: h(lanes)                   !! side of the cell
    real(dp), intent(in) :: speed                      !! of sound
    real(dp), intent(in) :: velocity(lanes, NDIM)      !! of the grid, before the kick
    real(dp), intent(in) :: gradient(lanes, NDIM**2)   !! of it
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(out) :: values(lanes, NDIM + 3)
    real(dp) :: unseen, represented
    integer :: l, d
    values(:, 1) = live*motion(:, mass_at)
    do d = 1, NDIM
      values(:, 1 + d) = values(:, 1)*motion(:, before_v + d)
    end do
    values(:, NDIM + 2:) = 0.0_dp
    do l = 1, lanes
      if (loose(l) < 0.5_dp) cycle
      unseen = sum((motion(l, before_v + 1:before_v + NDIM) - velocity(l, :))**2)
      represented = seen*h(l)**2*sum(gradient(l, :)**2) + (noticed*speed)**2
      if (unseen <= represented) cycle
      values(l, NDIM + 2) = values(l, 1)*(1.0_dp - represented/unseen)
      values(l, NDIM + 3) = values(l, NDIM + 2)*unseen
    end do
  end subroutine collisions_collect

  !> Change of the velocity by collisions, dv = -sum N a (v - v_c) at the velocity before the kick,
  !! and the heat m (sum N a |v - v_c|^2 - |dv|^2/2), which is positive for every particle.
  pure subroutine collisions_plan(collide, live, motion, change, heat)
    real(dp), intent(in) :: collide(lanes, *)    !! gathered from the points
    real(dp), intent(in) :: live(lanes), motion(lanes, motion_total(NDIM))
    real(dp), intent(out) :: change(lanes, NDIM), heat(lanes)
    real(dp) :: v, mean
    integer :: l, d
    heat = collide(:, collide_square)
    do d = 1, NDIM
      !$omp simd simdlen(8) private(v, mean)
      do l = 1, lanes
        v = motion(l, before_v + d)
        mean = collide(l, collide_velocity + d - 1)
        change(l, d) = live(l)*(mean - collide(l, collide_rate)*v)
        heat(l) = heat(l) - v*(mean + change(l, d)) - 0.5_dp*change(l, d)**2
      end do
    end do
    heat = live*motion(:, mass_at)*heat
  end subroutine collisions_plan

  !> Changes the velocity of a chunk that has been kicked since; `kicked` is by how much, or half of
  !! that where the strain of the step has the change in it: what pushes then takes a half of the
  !! work of the kick on the change. The heat is all other kinetic energy that is lost by the
  !! change; what the materials keep no energy for is booked alone.
  pure subroutine collisions_apply(law, change, kicked, live, nb, heat, motion, state, momentum, &
                                   kinetic, internal)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: change(lanes, NDIM), kicked(lanes, NDIM), live(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: heat(lanes)
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: momentum(lanes, NDIM), kinetic(lanes), internal(lanes)  !! sums
    real(dp) :: mass(lanes), v(lanes)
    integer :: d
    mass = live*motion(:, mass_at)
    do d = 1, NDIM
      v = motion(:, before_v + d)
      heat = heat - mass*kicked(:, d)*change(:, d)
      kinetic = kinetic - mass*change(:, d)*(v + 0.5_dp*change(:, d))
      momentum(:, d) = momentum(:, d) + mass*change(:, d)
      motion(:, before_v + d) = v + change(:, d)
    end do
    internal = internal + heat
    if (law%slots%energy == 0) return
    associate (e => state(:, law%slots%energy))
      e = e + heat*(law%density/motion(:, mass_at))
    end associate
  end subroutine collisions_apply

end module DIM(sgmp_collisions)
