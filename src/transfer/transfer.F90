! dimension-generic
#include "dimension.inc"
!> Linear weights of one chunk of particles, and its gathers (grid to particle).
!!
!! A chunk is `lanes` particles of one bin. In 3D a bin is one cell: gathers run over the lanes, so
!! every grid value is a broadcast. In 1D and 2D a bin is some cells of a row, as few particles are
!! in each, and every lane reads the points of its own cell. Points of a stencil are numbered with
!! the slowest axis fastest, then y, then x outermost.
module DIM(sgmp_transfer)
  use sgmp_kinds, only: dp, lanes
  use sgmp_voigt, only: flux_between
  implicit none
  private
  public :: linear_weights, linear_gradients, linear_gather, linear_gather_gradient
#if NDIM == 2
  public :: linear_gather_cells
#endif
  public :: flux_of, record_group

  !> Flux component that acts along one axis across another.
  integer, parameter :: flux_of(NDIM, NDIM) = flux_between(:NDIM, :NDIM, NDIM)

  !> Components of grid records that are gathered together: records have whole groups.
#if NDIM == 2
  integer, parameter :: record_group = 8
#else
  integer, parameter :: record_group = 1
#endif

contains

  !> Linear weights at local coordinates xi in [0, 1) of the stencil's cell; theory 1, `mpm` and
  !! `sgmp`.
  pure subroutine linear_weights(xi, w)
    real(dp), intent(in) :: xi(lanes, NDIM)      !! position in the stencil's cell
    real(dp), intent(out) :: w(lanes, NCORNER)   !! weight of each point
    integer :: l
#if NDIM == 1
    !$omp simd simdlen(8)
    do l = 1, lanes
      w(l, 1) = 1.0_dp - xi(l, 1)
      w(l, 2) = xi(l, 1)
    end do
#elif NDIM == 2
    real(dp) :: x, y
    !$omp simd simdlen(8) private(x, y)
    do l = 1, lanes
      x = xi(l, 1)
      y = xi(l, 2)
      w(l, 4) = x*y
      w(l, 3) = x - w(l, 4)
      w(l, 2) = y - w(l, 4)
      w(l, 1) = (1.0_dp - x) - w(l, 2)
    end do
#else
    real(dp) :: x, y, z, a, b, c, d
    !$omp simd simdlen(8) private(x, y, z, a, b, c, d)
    do l = 1, lanes
      x = xi(l, 1)
      y = xi(l, 2)
      z = xi(l, 3)
      d = y*z
      c = y - d
      b = z - d
      a = (1.0_dp - y) - b
      w(l, 5) = x*a
      w(l, 6) = x*b
      w(l, 7) = x*c
      w(l, 8) = x*d
      w(l, 1) = a - w(l, 5)
      w(l, 2) = b - w(l, 6)
      w(l, 3) = c - w(l, 7)
      w(l, 4) = d - w(l, 8)
    end do
#endif
  end subroutine linear_weights

  !> Gradients of the linear weights (1/length), for plain MPM.
  pure subroutine linear_gradients(xi, inverse_h, g)
    real(dp), intent(in) :: xi(lanes, NDIM), inverse_h
    real(dp), intent(out) :: g(lanes, NCORNER, NDIM)  !! derivative along each axis
    integer :: l
#if NDIM == 1
    do l = 1, lanes
      g(l, 1, 1) = -inverse_h
      g(l, 2, 1) = inverse_h
    end do
#elif NDIM == 2
    real(dp) :: x, y
    !$omp simd simdlen(8) private(x, y)
    do l = 1, lanes
      x = inverse_h*xi(l, 1)
      y = inverse_h*xi(l, 2)
      g(l, 4, 1) = y
      g(l, 3, 1) = inverse_h - y
      g(l, 2, 1) = -y
      g(l, 1, 1) = y - inverse_h
      g(l, 4, 2) = x
      g(l, 3, 2) = -x
      g(l, 2, 2) = inverse_h - x
      g(l, 1, 2) = x - inverse_h
    end do
#else
    real(dp) :: x, y, z, u
    integer :: r
    !$omp simd simdlen(8) private(x, y, z, u, r)
    do l = 1, lanes
      x = xi(l, 1)
      y = xi(l, 2)
      z = xi(l, 3)
      u = inverse_h*y*z
      g(l, 8, 1) = u
      g(l, 7, 1) = inverse_h*y - u
      g(l, 6, 1) = inverse_h*z - u
      g(l, 5, 1) = inverse_h*(1.0_dp - y) - g(l, 6, 1)
      u = inverse_h*x*z
      g(l, 8, 2) = u
      g(l, 7, 2) = inverse_h*x - u
      g(l, 4, 2) = inverse_h*z - u
      g(l, 3, 2) = inverse_h*(1.0_dp - x) - g(l, 4, 2)
      u = inverse_h*x*y
      g(l, 8, 3) = u
      g(l, 6, 3) = inverse_h*x - u
      g(l, 4, 3) = inverse_h*y - u
      g(l, 2, 3) = inverse_h*(1.0_dp - x) - g(l, 4, 3)
      do r = 1, 4
        g(l, r, 1) = -g(l, r + 4, 1)
      end do
      g(l, 6, 2) = -g(l, 8, 2)
      g(l, 5, 2) = -g(l, 7, 2)
      g(l, 2, 2) = -g(l, 4, 2)
      g(l, 1, 2) = -g(l, 3, 2)
      g(l, 7, 3) = -g(l, 8, 3)
      g(l, 5, 3) = -g(l, 6, 3)
      g(l, 3, 3) = -g(l, 4, 3)
      g(l, 1, 3) = -g(l, 2, 3)
    end do
#endif
  end subroutine linear_gradients

  !> Values at the particles: sum of weight times grid record over the stencil.
  pure subroutine linear_gather(n, w, cell, stride, grid, row, values)
    integer, intent(in) :: n                       !! components to gather
    real(dp), intent(in) :: w(lanes, NCORNER)      !! weights
    integer, intent(in) :: cell(lanes)             !! of the bin, from 0
    integer, intent(in) :: stride                  !! components of a grid record
    real(dp), intent(in) :: grid(stride, *)        !! grid records
    integer, intent(in) :: row(NROW)  !! record of the first cell's first point in each row
    real(dp), intent(out) :: values(lanes, *)      !! (lanes, n)
    integer :: l, q, grouped
#if NDIM == 1
    real(dp) :: low(lanes), high(lanes)
#endif
    grouped = 0
#if NDIM == 2
    grouped = n - mod(n, record_group)
    do q = 1, grouped, record_group
      call gather_group(w, cell, stride, grid(q, 1), row, values(1, q))
    end do
#endif
    do q = grouped + 1, n
#if NDIM == 1
      low = of_cells(cell, stride, grid(q, row(1)))
      high = of_cells(cell, stride, grid(q, row(1) + 1))
#endif
      !$omp simd simdlen(8)
      do l = 1, lanes
#if NDIM == 1
        values(l, q) = w(l, 1)*low(l) + w(l, 2)*high(l)
#elif NDIM == 2
        values(l, q) = w(l, 1)*grid(q, AT(1)) + w(l, 3)*grid(q, AT(1) + 1) &
                       + w(l, 2)*grid(q, AT(2)) + w(l, 4)*grid(q, AT(2) + 1)
#else
        ! One chain of multiply-adds: chains of different q and lanes overlap in the pipeline.
        values(l, q) = w(l, 1)*grid(q, AT(1)) + w(l, 5)*grid(q, AT(1) + 1) &
                       + w(l, 2)*grid(q, AT(2)) + w(l, 6)*grid(q, AT(2) + 1) &
                       + w(l, 3)*grid(q, AT(3)) + w(l, 7)*grid(q, AT(3) + 1) &
                       + w(l, 4)*grid(q, AT(4)) + w(l, 8)*grid(q, AT(4) + 1)
#endif
      end do
    end do
  end subroutine linear_gather

#if NDIM == 1
  !> One component of the records of all lanes, put together in a register: a loop over the lanes
  !! works their places out as vectors, only to take them apart again.
  pure function of_cells(cell, stride, grid) result(values)
    integer, intent(in) :: cell(lanes), stride
    real(dp), intent(in) :: grid(stride, 0:*)
    real(dp) :: values(lanes)
    values = [grid(1, cell(1)), grid(1, cell(2)), grid(1, cell(3)), grid(1, cell(4)), &
              grid(1, cell(5)), grid(1, cell(6)), grid(1, cell(7)), grid(1, cell(8))]
  end function of_cells
#endif

#if NDIM == 2
  !> Some components that follow each other, as vectors: one lane after the other, then components
  !! become lanes.
  pure subroutine gather_group(w, cell, stride, grid, row, values)
    real(dp), intent(in) :: w(lanes, NCORNER)
    integer, intent(in) :: cell(lanes), stride, row(NROW)
    real(dp), intent(in) :: grid(stride, *)
    real(dp), intent(out) :: values(lanes, record_group)
    real(dp) :: own(record_group, lanes)
    integer :: l, q
    do l = 1, lanes
      !$omp simd simdlen(8)
      do q = 1, record_group
        own(q, l) = w(l, 1)*grid(q, AT(1)) + w(l, 3)*grid(q, AT(1) + 1) &
                    + w(l, 2)*grid(q, AT(2)) + w(l, 4)*grid(q, AT(2) + 1)
      end do
    end do
    call turn(own, values)
  end subroutine gather_group

  !> Components become lanes.
  pure subroutine turn(own, values)
    real(dp), intent(in) :: own(record_group, lanes)
    real(dp), intent(out) :: values(lanes, record_group)
    integer :: l
    !$omp simd simdlen(8)
    do l = 1, lanes
      values(l, 1) = own(1, l)
      values(l, 2) = own(2, l)
      values(l, 3) = own(3, l)
      values(l, 4) = own(4, l)
      values(l, 5) = own(5, l)
      values(l, 6) = own(6, l)
      values(l, 7) = own(7, l)
      values(l, 8) = own(8, l)
    end do
  end subroutine turn

  !> A vector at the particles, from records that hold it at all points of a cell: one load per
  !! lane, to the bit what `linear_gather` makes of four. Pads get zeros.
  pure subroutine linear_gather_cells(w, cell, live, grid, row, values)
    real(dp), intent(in) :: w(lanes, NCORNER)      !! weights
    integer, intent(in) :: cell(lanes)             !! of the bin, from 0
    real(dp), intent(in) :: live(lanes)            !! 1 for particles, 0 for pads
    real(dp), intent(in) :: grid(record_group, *)  !! (component, point; cells)
    integer, intent(in) :: row(NROW)               !! the first: record of the first cell
    real(dp), intent(out) :: values(lanes, NDIM)
    real(dp) :: own(record_group, lanes), at(lanes, NDIM, NCORNER)
    integer :: l, q, d
    do l = 1, lanes
      ! A product, as a mere copy would be stored in halves on some processors, and loaded whole.
      !$omp simd simdlen(8)
      do q = 1, record_group
        own(q, l) = live(l)*grid(q, AT(1))
      end do
    end do
    call turn(own, at)
    do d = 1, NDIM
      !$omp simd simdlen(8)
      do l = 1, lanes
        values(l, d) = w(l, 1)*at(l, d, 1) + w(l, 3)*at(l, d, 3) &
                       + w(l, 2)*at(l, d, 2) + w(l, 4)*at(l, d, 4)
      end do
    end do
  end subroutine linear_gather_cells
#endif

  !> Velocity gradient at the particles, row by row: derivatives of the trilinear interpolant.
  !!
  !! Axis by axis: a difference taken along x is the same for all lanes, and what is interpolated
  !! along one axis serves the derivatives along the others.
  pure subroutine linear_gather_gradient(xi, cell, inverse_h, stride, grid, row, gradient)
    real(dp), intent(in) :: xi(lanes, NDIM), inverse_h
    integer, intent(in) :: cell(lanes), stride, row(NROW)  !! as in linear_gather
    real(dp), intent(in) :: grid(stride, *)        !! grid records that begin with the velocity
    real(dp), intent(out) :: gradient(lanes, NDIM, NDIM)  !! (:, b, a): component a along axis b
    integer :: l, a
#if NDIM == 2
    real(dp) :: g1, g2, d1, d2, v1, v2
#elif NDIM == 3
    real(dp) :: v1, v2, v3, v4, slope1, slope2
#endif
    do a = 1, NDIM
#if NDIM == 1
      do l = 1, lanes
        gradient(l, 1, 1) = inverse_h*(grid(1, AT(1) + 1) - grid(1, AT(1)))
      end do
#elif NDIM == 2
      !$omp simd simdlen(8) private(g1, g2, d1, d2, v1, v2)
      do l = 1, lanes
        g1 = grid(a, AT(1))
        g2 = grid(a, AT(2))
        d1 = grid(a, AT(1) + 1) - g1
        d2 = grid(a, AT(2) + 1) - g2
        v1 = g1 + xi(l, 1)*d1
        v2 = g2 + xi(l, 1)*d2
        gradient(l, 1, a) = inverse_h*(d1 + xi(l, 2)*(d2 - d1))
        gradient(l, 2, a) = inverse_h*(v2 - v1)
      end do
#else
      associate (d1 => grid(a, AT(1) + 1) - grid(a, AT(1)), &
                 d2 => grid(a, AT(2) + 1) - grid(a, AT(2)), &
                 d3 => grid(a, AT(3) + 1) - grid(a, AT(3)), &
                 d4 => grid(a, AT(4) + 1) - grid(a, AT(4)))
        !$omp simd simdlen(8) private(v1, v2, v3, v4, slope1, slope2)
        do l = 1, lanes
          slope1 = d1 + xi(l, 2)*(d3 - d1)
          slope2 = d2 + xi(l, 2)*(d4 - d2)
          gradient(l, 1, a) = inverse_h*(slope1 + xi(l, 3)*(slope2 - slope1))
          v1 = grid(a, AT(1)) + xi(l, 1)*d1
          v2 = grid(a, AT(2)) + xi(l, 1)*d2
          v3 = grid(a, AT(3)) + xi(l, 1)*d3
          v4 = grid(a, AT(4)) + xi(l, 1)*d4
          gradient(l, 2, a) = inverse_h*((v3 - v1) + xi(l, 3)*((v4 - v2) - (v3 - v1)))
          gradient(l, 3, a) = inverse_h*((v2 - v1) + xi(l, 2)*((v4 - v3) - (v2 - v1)))
        end do
      end associate
#endif
    end do
  end subroutine linear_gather_gradient

end module DIM(sgmp_transfer)
