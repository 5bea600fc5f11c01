! dimension-generic
#include "dimension.inc"
!> Weights of a chunk of particles per axis, for kernels with three points per axis: the one place
!! that knows which kernel has which.
module DIM(sgmp_axis_weights)
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: axis_weights, gimp_axes, gimp_size

contains

  !> Weights and slopes per axis of the three points of the stencil, the middle one at xi = 1/2.
  pure subroutine axis_weights(kernel, xi, size_of, inverse_h, s, d)
    integer, intent(in) :: kernel
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the bin
    real(dp), intent(in) :: size_of(lanes, NDIM, 2)  !! as in gimp_axes, where particles have a size
    real(dp), intent(in) :: inverse_h
    real(dp), intent(out) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)  !! weights, slopes (1/length)
    select case (kernel)
    case default  ! kernel_gimp
      call gimp_axes(xi, size_of, inverse_h, s, d)
    end select
  end subroutine axis_weights

  !> Sizes of a chunk along one axis, stretched: the half-size, cut to half a cell, and 1/(2 half).
  pure subroutine gimp_size(half, stretch, cut, inverse)
    real(dp), intent(in) :: half                   !! half-size of the undeformed particle (cells)
    real(dp), intent(in) :: stretch(lanes)
    real(dp), intent(out) :: cut(lanes), inverse(lanes)
    integer :: l
    !$omp simd simdlen(8)
    do l = 1, lanes
      cut(l) = merge(half*stretch(l), 0.5_dp, half*stretch(l) < 0.5_dp)
      inverse(l) = 0.5_dp/cut(l)
    end do
  end subroutine gimp_size

  !> GIMP weights and slopes per axis of a chunk; nodes of the stencil lie at xi - 1/2 = -1, 0, 1
  !! from its middle.
  !!
  !! With u = xi - 1/2 and t = p - u between 0 and 2p the lower node has the weight t^2/(4p), and
  !! beyond, where the particle lies in its cell, -u - p more; the upper node is its mirror image,
  !! and the middle one has the rest. The same as gimp_function, without a division.
  pure subroutine gimp_axes(xi, size_of, inverse_h, s, d)
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the bin, the middle node at 1/2
    real(dp), intent(in) :: size_of(lanes, NDIM, 2)  !! half-size (cells, <= 1/2), 1/(2 half)
    real(dp), intent(in) :: inverse_h
    real(dp), intent(out) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)  !! weights, slopes (1/length)
    integer :: l, axis
    real(dp) :: u, p, inverse, below, above
    do axis = 1, NDIM
      !$omp simd simdlen(8) private(u, p, inverse, below, above)
      do l = 1, lanes
        u = xi(l, axis) - 0.5_dp
        p = size_of(l, axis, 1)
        inverse = size_of(l, axis, 2)
        below = between(p - u, 2.0_dp*p)
        above = between(p + u, 2.0_dp*p)
        s(l, 1, axis) = (0.5_dp*inverse)*below*below + positive(-u - p)
        s(l, 3, axis) = (0.5_dp*inverse)*above*above + positive(u - p)
        s(l, 2, axis) = (1.0_dp - s(l, 1, axis)) - s(l, 3, axis)
        d(l, 1, axis) = -inverse_h*(inverse*below)
        d(l, 3, axis) = inverse_h*(inverse*above)
        d(l, 2, axis) = -(d(l, 1, axis) + d(l, 3, axis))
      end do
    end do
  end subroutine gimp_axes

  !> A number cut to [0, most].
  pure function between(number, most) result(cut)
    real(dp), intent(in) :: number, most
    real(dp) :: cut
    cut = positive(number)
    cut = merge(cut, most, cut < most)
  end function between

  !> A number, or zero where it is negative.
  pure function positive(number) result(cut)
    real(dp), intent(in) :: number
    real(dp) :: cut
    cut = merge(number, 0.0_dp, number > 0.0_dp)
  end function positive

end module DIM(sgmp_axis_weights)
