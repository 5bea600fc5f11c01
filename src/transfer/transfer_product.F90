! dimension-generic
#include "dimension.inc"
!> Particle-grid transfers of one chunk of particles over three points per axis (theory 1, `gimp`,
!! `cpgimp`): what the weights per axis are is up to sgmp_axis_weights.
!!
!! Weights are products over the axes, and sums over the stencil are taken axis by axis: the 27
!! weights of a particle and their 81 derivatives never exist, but for particles that change bins.
!! The accumulator of a stencil has four entries along the slowest axis, three and a pad, so that a
!! row of points is a vector: `sums(4, across, column)`, where `across` numbers the products of the
!! other axes, x outermost.
module DIM(sgmp_transfer_product)
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: product_weights, product_gradients, product_gather, product_gather_gradient
  public :: product_spread, product_spread_t, product_scatter, product_scatter_force, product_carry

  !> Weights of a chunk as the scatters need them.
  type :: product_spread_t
    real(dp) :: across(lanes, NACROSS, NDIM)  !! products of the axes but the slowest: of weights,
                                              !! then with the derivative along each of them
    real(dp) :: weight(4, lanes)              !! along the slowest axis, by point
    real(dp) :: slope(4, lanes)               !! its derivative
  end type product_spread_t

contains

  !> Weights by point of the stencil (x outermost, slowest axis innermost).
  pure subroutine product_weights(s, w)
    real(dp), intent(in) :: s(lanes, 3, NDIM)      !! weights per axis
    real(dp), intent(out) :: w(lanes, NWIDE)
    call product_of(s, w)
  end subroutine product_weights

  !> Gradients of the weights (1/length).
  pure subroutine product_gradients(s, d, g)
    real(dp), intent(in) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)  !! weights, slopes per axis
    real(dp), intent(out) :: g(lanes, NWIDE, NDIM)
    real(dp) :: factor(lanes, 3, NDIM)
    integer :: a
    do a = 1, NDIM
      factor = s
      factor(:, :, a) = d(:, :, a)
      call product_of(factor, g(1, 1, a))
    end do
  end subroutine product_gradients

  !> Products of one factor per axis, in the stencil's numbering.
  pure subroutine product_of(factor, w)
    real(dp), intent(in) :: factor(lanes, 3, NDIM)
    real(dp), intent(out) :: w(lanes, NWIDE)
    integer :: e, a, digits
    do e = 1, NWIDE
      digits = e - 1
      w(:, e) = 1.0_dp
      do a = NDIM, 1, -1
        w(:, e) = factor(:, mod(digits, 3) + 1, a)*w(:, e)
        digits = digits/3
      end do
    end do
  end subroutine product_of

  !> Values at the particles, layer by layer of the stencil.
  pure subroutine product_gather(n, s, stride, grid, row, values)
    integer, intent(in) :: n, stride
    real(dp), intent(in) :: s(lanes, 3, NDIM)      !! weights per axis
    real(dp), intent(in) :: grid(stride, *)
    integer, intent(in) :: row(NACROSS)  !! record of the stencil's first point in each row
    real(dp), intent(out) :: values(lanes, n)
    integer :: layer, lines(WIDE_LINE)
    values = 0.0_dp
    do layer = 1, WIDE_LAYER
      lines = row(layer:NACROSS:WIDE_LAYER)
      call gather_layer(n, s, s(1, layer, NDIM), stride, grid, lines, values)
    end do
  end subroutine product_gather

  !> One layer: along x, then along y, then times the layer's weight. Nine grid values at a time fit
  !! in the registers, 27 would not.
  pure subroutine gather_layer(n, s, weight, stride, grid, line, values)
    integer, intent(in) :: n, stride, line(WIDE_LINE)
    real(dp), intent(in) :: s(lanes, 3, NDIM), weight(lanes), grid(stride, *)
    real(dp), intent(inout) :: values(lanes, n)
    integer :: l, q
    do q = 1, n
      !$omp simd simdlen(8)
      do l = 1, lanes
#if NDIM == 1
        values(l, q) = three(s, l, 1, grid(q, line(1)), grid(q, line(1) + 1), grid(q, line(1) + 2))
#elif NDIM == 2
        values(l, q) = values(l, q) + weight(l)* &
            three(s, l, 1, grid(q, line(1)), grid(q, line(1) + 1), grid(q, line(1) + 2))
#else
        values(l, q) = values(l, q) + weight(l)*three(s, l, 2, &
            three(s, l, 1, grid(q, line(1)), grid(q, line(1) + 1), grid(q, line(1) + 2)), &
            three(s, l, 1, grid(q, line(2)), grid(q, line(2) + 1), grid(q, line(2) + 2)), &
            three(s, l, 1, grid(q, line(3)), grid(q, line(3) + 1), grid(q, line(3) + 2)))
#endif
      end do
    end do
  end subroutine gather_layer

  !> Velocity gradient at the particles, row by row, layer by layer of the stencil.
  pure subroutine product_gather_gradient(s, d, stride, grid, row, gradient)
    real(dp), intent(in) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)  !! weights, slopes per axis
    integer, intent(in) :: stride, row(NACROSS)
    real(dp), intent(in) :: grid(stride, *)        !! grid records that begin with the velocity
    real(dp), intent(out) :: gradient(lanes, NDIM, NDIM)  !! (:, b, a): component a along axis b
    integer :: layer, lines(WIDE_LINE)
    gradient = 0.0_dp
    do layer = 1, WIDE_LAYER
      lines = row(layer:NACROSS:WIDE_LAYER)
      call gradient_layer(s, d, s(1, layer, NDIM), d(1, layer, NDIM), stride, grid, lines, gradient)
    end do
  end subroutine product_gather_gradient

  !> One layer: values and derivatives along x of its lines serve all three derivatives.
  pure subroutine gradient_layer(s, d, weight, slope, stride, grid, line, gradient)
    real(dp), intent(in) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM), weight(lanes), slope(lanes)
    integer, intent(in) :: stride, line(WIDE_LINE)
    real(dp), intent(in) :: grid(stride, *)
    real(dp), intent(inout) :: gradient(lanes, NDIM, NDIM)
    integer :: l, a
#if NDIM == 3
    real(dp) :: v1, v2, v3, x1, x2, x3             ! along each line: value, derivative along x
#endif
    do a = 1, NDIM
#if NDIM == 1
      !$omp simd simdlen(8)
      do l = 1, lanes
        gradient(l, 1, a) = three(d, l, 1, grid(a, line(1)), grid(a, line(1) + 1), &
                                  grid(a, line(1) + 2))
      end do
#elif NDIM == 2
      !$omp simd simdlen(8)
      do l = 1, lanes
        gradient(l, 1, a) = gradient(l, 1, a) + weight(l)* &
            three(d, l, 1, grid(a, line(1)), grid(a, line(1) + 1), grid(a, line(1) + 2))
        gradient(l, 2, a) = gradient(l, 2, a) + slope(l)* &
            three(s, l, 1, grid(a, line(1)), grid(a, line(1) + 1), grid(a, line(1) + 2))
      end do
#else
      !$omp simd simdlen(8) private(v1, v2, v3, x1, x2, x3)
      do l = 1, lanes
        v1 = three(s, l, 1, grid(a, line(1)), grid(a, line(1) + 1), grid(a, line(1) + 2))
        v2 = three(s, l, 1, grid(a, line(2)), grid(a, line(2) + 1), grid(a, line(2) + 2))
        v3 = three(s, l, 1, grid(a, line(3)), grid(a, line(3) + 1), grid(a, line(3) + 2))
        x1 = three(d, l, 1, grid(a, line(1)), grid(a, line(1) + 1), grid(a, line(1) + 2))
        x2 = three(d, l, 1, grid(a, line(2)), grid(a, line(2) + 1), grid(a, line(2) + 2))
        x3 = three(d, l, 1, grid(a, line(3)), grid(a, line(3) + 1), grid(a, line(3) + 2))
        gradient(l, 1, a) = gradient(l, 1, a) + weight(l)*three(s, l, 2, x1, x2, x3)
        gradient(l, 2, a) = gradient(l, 2, a) + weight(l)*three(d, l, 2, v1, v2, v3)
        gradient(l, 3, a) = gradient(l, 3, a) + slope(l)*three(s, l, 2, v1, v2, v3)
      end do
#endif
    end do
  end subroutine gradient_layer

  !> Sum over the three points along an axis, to be inlined in a loop over the lanes.
  pure function three(factor, l, axis, a, b, c) result(total)
    real(dp), intent(in) :: factor(lanes, 3, NDIM)
    integer, intent(in) :: l, axis
    real(dp), intent(in) :: a, b, c                !! values at the points
    real(dp) :: total
    total = factor(l, 1, axis)*a + factor(l, 2, axis)*b + factor(l, 3, axis)*c
  end function three

  !> What the scatters need of a chunk's weights.
  pure subroutine product_spread(s, d, forces, spread)
    real(dp), intent(in) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)  !! weights, slopes per axis
    logical, intent(in) :: forces                  !! product_scatter_force will come, too
    type(product_spread_t), intent(out) :: spread
    call by_point(s(1, 1, NDIM), spread%weight)
    call products_across(s, s, spread%across(1, 1, 1))
    if (.not. forces) return
    call by_point(d(1, 1, NDIM), spread%slope)
#if NDIM > 1
    call products_across(d, s, spread%across(1, 1, 2))
#endif
#if NDIM > 2
    call products_across(s, d, spread%across(1, 1, 3))
#endif
  end subroutine product_spread

  !> Products of the factors of all axes but the slowest.
  pure subroutine products_across(x, y, across)
    real(dp), intent(in) :: x(lanes, 3, NDIM), y(lanes, 3, NDIM)
      !! factors of the first, second axis
    real(dp), intent(out) :: across(lanes, NACROSS)
#if NDIM == 1
    across = 1.0_dp
#elif NDIM == 2
    across = x(:, :, 1)
#else
    integer :: l, a, b
    do a = 1, 3
      do b = 1, 3
        !$omp simd simdlen(8)
        do l = 1, lanes
          across(l, 3*(a - 1) + b) = x(l, a, 1)*y(l, b, 2)
        end do
      end do
    end do
#endif
  end subroutine products_across

  !> Factors of one axis by point, padded. Transposed in registers, so that points are stored whole:
  !! a load does not have to wait for four small stores.
  pure subroutine by_point(factor, points)
    real(dp), intent(in) :: factor(lanes, 3)
    real(dp), intent(out) :: points(4, lanes)
    real(dp) :: padded(lanes, 4)
    integer :: l
    padded(:, :3) = factor
    padded(:, 4) = 0.0_dp
    do l = 1, lanes
      points(1, l) = padded(l, 1)
      points(2, l) = padded(l, 2)
      points(3, l) = padded(l, 3)
      points(4, l) = padded(l, 4)
    end do
  end subroutine by_point

  !> Adds the particles' values to the accumulator of their stencil (MPM Eqs. 9, 10); pads must
  !! bring zeros.
  pure subroutine product_scatter(nq, spread, values, sums)
    integer, intent(in) :: nq
    type(product_spread_t), intent(in) :: spread
    real(dp), intent(in) :: values(lanes, nq)
    real(dp), intent(inout) :: sums(4, NACROSS, nq)
    real(dp) :: share(lanes, NACROSS)
    integer :: l, q, c, e
    do q = 1, nq
      do c = 1, NACROSS
        !$omp simd simdlen(8)
        do l = 1, lanes
          share(l, c) = spread%across(l, c, 1)*values(l, q)
        end do
      end do
      do c = 1, NACROSS  ! apart, so that shares are broadcast from memory and not permuted
        !$omp simd simdlen(4)
        do e = 1, 4
          sums(e, c, q) = sums(e, c, q) + over_lanes(spread%weight, e, share(1, c))
        end do
      end do
    end do
  end subroutine product_scatter

  !> Adds -grad S . (sigma V) of the particles to the nodal forces; pads must bring zeros.
  pure subroutine product_scatter_force(spread, of, flux, sums)
    type(product_spread_t), intent(in) :: spread
    integer, intent(in) :: of(NDIM, NDIM)          !! component of the flux: (along, of the force)
    real(dp), intent(in) :: flux(lanes, *)
    real(dp), intent(inout) :: sums(4, NACROSS, NDIM)
    real(dp) :: across(lanes, NACROSS), along(lanes, NACROSS)  ! the slowest axis
    integer :: l, a, c, e
    do a = 1, NDIM
      do c = 1, NACROSS
        !$omp simd simdlen(8)
        do l = 1, lanes
          along(l, c) = spread%across(l, c, 1)*flux(l, of(NDIM, a))
#if NDIM == 1
          across(l, c) = 0.0_dp
#elif NDIM == 2
          across(l, c) = spread%across(l, c, 2)*flux(l, of(1, a))
#else
          across(l, c) = spread%across(l, c, 2)*flux(l, of(1, a)) &
                         + spread%across(l, c, 3)*flux(l, of(2, a))
#endif
        end do
      end do
      do c = 1, NACROSS
        !$omp simd simdlen(4)
        do e = 1, 4
          sums(e, c, a) = sums(e, c, a) - over_lanes(spread%weight, e, across(1, c)) &
                          - over_lanes(spread%slope, e, along(1, c))
        end do
      end do
    end do
  end subroutine product_scatter_force

  !> Sum over the lanes of weight times value for one point of a row, to be inlined in a loop over
  !! the points.
  pure function over_lanes(w, e, v) result(total)
    real(dp), intent(in) :: w(4, lanes), v(lanes)
    integer, intent(in) :: e
    real(dp) :: total
    total = w(e, 1)*v(1) + w(e, 2)*v(2) + w(e, 3)*v(3) + w(e, 4)*v(4) &
            + w(e, 5)*v(5) + w(e, 6)*v(6) + w(e, 7)*v(7) + w(e, 8)*v(8)
  end function over_lanes

  !> Flushes the accumulator's first x-layer to the plane buffers and moves the stencil one bin
  !! along the row, as linear_carry does.
  pure subroutine product_carry(lead, nq, sums, shift, place, planes)
    integer, intent(in) :: lead, nq                !! lead: first extent of the buffers
    real(dp), intent(inout) :: sums(4, NACROSS, nq)
    integer, intent(in) :: shift, place(WIDE_LINE)
    real(dp), intent(inout) :: planes(lead, nq, *)  !! (layers, columns, points), in 1D (points,
                                                    !! columns, 1)
    integer :: q, e
#if NDIM == 1
    do q = 1, nq
      planes(place(1) + shift, q, 1) = planes(place(1) + shift, q, 1) + sums(1, 1, q)
      do e = 1, 3
        sums(e, 1, q) = sums(e + 1, 1, q)
      end do
      sums(4, 1, q) = 0.0_dp
    end do
#else
    integer :: line
    do q = 1, nq
      do line = 1, WIDE_LINE
        do e = 1, WIDE_LAYER
          planes(e, q, place(line) + shift) = planes(e, q, place(line) + shift) + sums(e, line, q)
        end do
      end do
      ! Rows of four stay vectors: a load of what was stored in smaller pieces would have to wait.
      do line = 1, WIDE_LINE
        !$omp simd simdlen(4)
        do e = 1, 4
          sums(e, line, q) = sums(e, line + WIDE_LINE, q)
          sums(e, line + WIDE_LINE, q) = sums(e, line + 2*WIDE_LINE, q)
          sums(e, line + 2*WIDE_LINE, q) = 0.0_dp
        end do
      end do
    end do
#endif
  end subroutine product_carry

end module DIM(sgmp_transfer_product)
