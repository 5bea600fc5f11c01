! dimension-generic
#include "dimension.inc"
!> Particles that carry the angular velocity of what is around them to the grid (doc/rotation.md).
!!
!! Momentum at a centre is sum N m (v + w x (x_c - x_p)): what the lower corner of the bin would get
!! is scattered like any momentum, and what the other corners get more is spin x (way between them).
module DIM(sgmp_spin)
  use sgmp_kinds, only: dp, lanes
  use DIM(sgmp_scatter), only: accumulators, column_sums, linear_scatter
  implicit none
  private
  public :: spin_collect, spin_lever, spin_to_corners, spin_to_origin

contains

  !> spin = keep spin + gain (rotation of a vector field), half the curl of which the gradient is
  !! given: the field is the acceleration, or the velocity towards which the spin relaxes.
  pure subroutine spin_turn(keep, gain, gradient, spin)
    real(dp), intent(in) :: keep, gain
    real(dp), intent(in) :: gradient(lanes, NDIM, NDIM)  !! (:, b, a): component a along axis b
    real(dp), intent(inout) :: spin(lanes, *)            !! z in the plane; x, y, z
    integer :: n, p, q
    do n = 1, NSPIN
      p = merge(1, mod(n, 3) + 1, NDIM == 2)
      q = merge(2, mod(n + 1, 3) + 1, NDIM == 2)
      spin(:, n) = keep*spin(:, n) + 0.5_dp*gain*(gradient(:, p, q) - gradient(:, q, p))
    end do
  end subroutine spin_turn

  !> Spin times mass, once the spin has been kicked or relaxed.
  pure subroutine spin_collect(keep, gain, live, gradient, mass, spin, values)
    real(dp), intent(in) :: keep, gain                   !! as in `spin_turn`
    real(dp), intent(in) :: live(lanes), mass(lanes)
    real(dp), intent(in) :: gradient(lanes, NDIM, NDIM)  !! as in `spin_turn`
    real(dp), intent(inout) :: spin(lanes, *), values(lanes, *)
    integer :: n
    if (gain > 0.0_dp) call spin_turn(keep, gain, gradient, spin)
    do n = 1, NSPIN
      values(:, n) = live*mass*spin(:, n)
    end do
  end subroutine spin_collect

  !> Momentum of particles that spin, as it is at the lower corner of their bin:
  !! m (v - h spin x xi); what the other corners get more is added with `spin_to_corners`.
  pure subroutine spin_to_origin(h, xi, spin, momentum)
    real(dp), intent(in) :: h, xi(lanes, NDIM)
    real(dp), intent(in) :: spin(lanes, *)               !! times mass
    real(dp), intent(inout) :: momentum(lanes, NDIM)
#if NDIM == 2
    momentum(:, 1) = momentum(:, 1) + h*spin(:, 1)*xi(:, 2)
    momentum(:, 2) = momentum(:, 2) - h*spin(:, 1)*xi(:, 1)
#elif NDIM == 3
    momentum(:, 1) = momentum(:, 1) - h*(spin(:, 2)*xi(:, 3) - spin(:, 3)*xi(:, 2))
    momentum(:, 2) = momentum(:, 2) - h*(spin(:, 3)*xi(:, 1) - spin(:, 1)*xi(:, 3))
    momentum(:, 3) = momentum(:, 3) - h*(spin(:, 1)*xi(:, 2) - spin(:, 2)*xi(:, 1))
#endif
  end subroutine spin_to_origin

  !> Adds h spin x (way from the bin's lower corner) to the momentum of the stencil's points.
  pure subroutine spin_to_corners(h, xi, cell, spin, cells, columns, momentum)
    real(dp), intent(in) :: h, xi(lanes, NDIM)
    integer, intent(in) :: cell(lanes)                   !! of the bin, from 0
    real(dp), intent(in) :: spin(lanes, *)               !! times mass
    integer, intent(in) :: cells, columns                !! of the bin; of an accumulator
    real(dp), intent(inout) :: momentum(column_sums, columns, 0:*)  !! the first NDIM columns
#if NDIM > 1
    real(dp) :: sums(column_sums, NSPIN, 0:accumulators - 1)
    integer :: c, e, d, first, odd
    sums = 0.0_dp
    call linear_scatter(NSPIN, xi, cell, spin, NSPIN, sums)
    do c = 0, cells - 1
      first = NROW*c
      odd = iand(c, 1)
      do d = 1, NDIM
        do e = 1, NCORNER
          momentum(first + e, d, odd) = momentum(first + e, d, odd) &
                                        + h*spin_lever(sums(first + e, :, odd), e, d)
        end do
      end do
    end do
#endif
  end subroutine spin_to_corners

  !> Component d of spin x (way from the stencil's first point to point e), in cells.
  pure function spin_lever(spin, e, d) result(t)
    real(dp), intent(in) :: spin(*)
    integer, intent(in) :: e, d                          !! point of the stencil; component
    real(dp) :: t
    real(dp) :: way(3)
    way = 0.0_dp
    way(1) = real((e - 1)/(NCORNER/2), dp)
    if (NDIM == 2) way(2) = real(mod(e - 1, 2), dp)
    if (NDIM == 3) way(2:) = real([mod((e - 1)/2, 2), mod(e - 1, 2)], dp)
    if (NDIM == 2) then
      t = spin(1)*merge(-way(2), way(1), d == 1)
    else
      t = spin(mod(d, 3) + 1)*way(mod(d + 1, 3) + 1) - spin(mod(d + 1, 3) + 1)*way(mod(d, 3) + 1)
    end if
  end function spin_lever

end module DIM(sgmp_spin)
