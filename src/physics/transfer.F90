! dimension-generic
#include "dimension.inc"
!> Particle-grid transfers of one chunk of particles: weights, gather (grid to particle), scatter
!! (particle to grid).
!!
!! A chunk is `lanes` particles of one bin. Gathers run over the lanes, so every grid value is a
!! broadcast; scatters run over the stencil's points, so every particle value is a broadcast and
!! nothing collides. Points of a stencil are numbered with the slowest axis fastest, then y, then x
!! outermost: a whole x-layer is contiguous, and moving to the next bin of the row shifts the
!! accumulator by one layer (`linear_carry`, `gimp_carry`).
module DIM(sgmp_transfer)
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: linear_weights, linear_gradients, linear_gather, linear_scatter, linear_scatter_force
  public :: gimp_weights, gimp_gradients, gimp_gather, gimp_scatter, gimp_function, gimp_slope
  public :: linear_carry, gimp_carry, flux_of

  !> Number of the flux component that acts along one axis across another.
#if NDIM == 1
  integer, parameter :: flux_of(1, 1) = 1
#elif NDIM == 2
  integer, parameter :: flux_of(2, 2) = reshape([1, 3, 3, 2], [2, 2])
#else
  integer, parameter :: flux_of(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])
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
  pure subroutine linear_gather(n, w, stride, grid, row, values)
    integer, intent(in) :: n                       !! components to gather
    real(dp), intent(in) :: w(lanes, NCORNER)      !! weights
    integer, intent(in) :: stride                  !! components of a grid record
    real(dp), intent(in) :: grid(stride, *)        !! grid records
    integer, intent(in) :: row(NROW)  !! record of the stencil's first point in each row
    real(dp), intent(out) :: values(lanes, *)      !! (lanes, n)
    integer :: l, q
    do q = 1, n
      !$omp simd simdlen(8)
      do l = 1, lanes
#if NDIM == 1
        values(l, q) = w(l, 1)*grid(q, row(1)) + w(l, 2)*grid(q, row(1) + 1)
#elif NDIM == 2
        values(l, q) = w(l, 1)*grid(q, row(1)) + w(l, 3)*grid(q, row(1) + 1) &
                       + w(l, 2)*grid(q, row(2)) + w(l, 4)*grid(q, row(2) + 1)
#else
        ! One chain of multiply-adds: chains of different q and lanes overlap in the pipeline.
        values(l, q) = w(l, 1)*grid(q, row(1)) + w(l, 5)*grid(q, row(1) + 1) &
                       + w(l, 2)*grid(q, row(2)) + w(l, 6)*grid(q, row(2) + 1) &
                       + w(l, 3)*grid(q, row(3)) + w(l, 7)*grid(q, row(3) + 1) &
                       + w(l, 4)*grid(q, row(4)) + w(l, 8)*grid(q, row(4) + 1)
#endif
      end do
    end do
  end subroutine linear_gather

  !> Linear weights of a chunk by stencil point: the scatter's view of `linear_weights`.
  pure subroutine point_weights(xi, w)
    real(dp), intent(in) :: xi(lanes, NDIM)
    real(dp), intent(out) :: w(NCORNER, lanes)
    integer :: l, e
#if NDIM == 1
    e = 0
    do l = 1, lanes
      w(1, l) = 1.0_dp - xi(l, 1)
      w(2, l) = xi(l, 1)
    end do
#elif NDIM == 2
    real(dp), parameter :: cx(4) = [1, 1, 0, 0], sx(4) = [-1, -1, 1, 1], cy(4) = [1, 0, 1, 0], &
        sy(4) = [-1, 1, -1, 1]
    do l = 1, lanes
      !$omp simd simdlen(4)
      do e = 1, 4
        w(e, l) = (cx(e) + sx(e)*xi(l, 1))*(cy(e) + sy(e)*xi(l, 2))
      end do
    end do
#else
    real(dp), parameter :: cy(4) = [1, 1, 0, 0], sy(4) = [-1, -1, 1, 1]
    real(dp), parameter :: cz(4) = [1, 0, 1, 0], sz(4) = [-1, 1, -1, 1]
    real(dp) :: yz
    do l = 1, lanes
      !$omp simd simdlen(4) private(yz)
      do e = 1, 4
        yz = (cy(e) + sy(e)*xi(l, 2))*(cz(e) + sz(e)*xi(l, 3))
        w(e + 4, l) = xi(l, 1)*yz
        w(e, l) = yz - w(e + 4, l)
      end do
    end do
#endif
  end subroutine point_weights

  !> Adds the particles' values to the accumulator of their stencil (Eqs. 21-23); pads must bring
  !! zeros.
  pure subroutine linear_scatter(nq, xi, values, sums)
    integer, intent(in) :: nq                      !! values per particle
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the stencil's cell
    real(dp), intent(in) :: values(lanes, nq)
    real(dp), intent(inout) :: sums(NCORNER, nq)   !! accumulator
    real(dp) :: w(NCORNER, lanes)
    integer :: e, q
    call point_weights(xi, w)
    do q = 1, nq
      ! All lanes in one expression keep the sum in a register; a loop over the live lanes would
      ! not.
      !$omp simd
      do e = 1, NCORNER
        sums(e, q) = sums(e, q) + w(e, 1)*values(1, q) + w(e, 2)*values(2, q) + &
            w(e, 3)*values(3, q) + w(e, 4)*values(4, q) + w(e, 5)*values(5, q) + &
            w(e, 6)*values(6, q) + w(e, 7)*values(7, q) + w(e, 8)*values(8, q)
      end do
    end do
  end subroutine linear_scatter

  !> Adds -grad N . (sigma V) of the particles to the nodal forces of plain MPM (Eq. 11).
  pure subroutine linear_scatter_force(nl, g, flux, sums)
    integer, intent(in) :: nl
    real(dp), intent(in) :: g(lanes, NCORNER, NDIM)  !! weight gradients
    real(dp), intent(in) :: flux(lanes, NFLUX)       !! sigma V
    real(dp), intent(inout) :: sums(NCORNER, NDIM)   !! force accumulators
    integer :: l, e
    do l = 1, nl
      do e = 1, NCORNER
#if NDIM == 1
        sums(e, 1) = sums(e, 1) - g(l, e, 1)*flux(l, 1)
#elif NDIM == 2
        sums(e, 1) = sums(e, 1) - (g(l, e, 1)*flux(l, 1) + g(l, e, 2)*flux(l, 3))
        sums(e, 2) = sums(e, 2) - (g(l, e, 1)*flux(l, 3) + g(l, e, 2)*flux(l, 2))
#else
        sums(e, 1) = sums(e, 1) - ((g(l, e, 1)*flux(l, 1) + g(l, e, 2)*flux(l, 4)) + &
                                   g(l, e, 3)*flux(l, 6))
        sums(e, 2) = sums(e, 2) - ((g(l, e, 1)*flux(l, 4) + g(l, e, 2)*flux(l, 2)) + &
                                   g(l, e, 3)*flux(l, 5))
        sums(e, 3) = sums(e, 3) - ((g(l, e, 1)*flux(l, 6) + g(l, e, 2)*flux(l, 5)) + &
                                   g(l, e, 3)*flux(l, 3))
#endif
      end do
    end do
  end subroutine linear_scatter_force

  !> GIMP function of a node at distance d (cells) from a particle of half-size p (cells), p <= 1/2.
  elemental function gimp_function(d, p) result(s)
    real(dp), intent(in) :: d, p
    real(dp) :: s
    real(dp) :: r
    r = abs(d)
    s = merge(1.0_dp - (r*r + p*p)/(2.0_dp*p), &
              merge(1.0_dp - r, merge((1.0_dp + p - r)**2/(4.0_dp*p), 0.0_dp, r < 1.0_dp + p), &
                    r < 1.0_dp - p), r < p)
  end function gimp_function

  !> Derivative of the GIMP function with respect to the particle's position (1/cell).
  elemental function gimp_slope(d, p) result(g)
    real(dp), intent(in) :: d, p  !! d = particle minus node
    real(dp) :: g
    real(dp) :: r
    r = abs(d)
    g = merge(-d/p, sign(1.0_dp, d)*merge(-1.0_dp, merge(-(1.0_dp + p - r)/(2.0_dp*p), 0.0_dp, &
                                                         r < 1.0_dp + p), r < 1.0_dp - p), r < p)
  end function gimp_slope

  !> GIMP weights and slopes per axis of a chunk; nodes of the stencil lie at xi - 1/2 = -1, 0, 1
  !! from its middle.
  pure subroutine gimp_axis(xi, half, inverse_h, s, d)
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the bin, the middle node at 1/2
    real(dp), intent(in) :: half(lanes, NDIM)      !! particle half-size (cells)
    real(dp), intent(in) :: inverse_h
    real(dp), intent(out) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)  !! weights, slopes (1/length)
    integer :: l, e, axis
    real(dp) :: p
    do axis = 1, NDIM
      do e = 1, 3
        !$omp simd simdlen(8) private(p)
        do l = 1, lanes
          p = merge(half(l, axis), 0.5_dp, half(l, axis) < 0.5_dp)
          s(l, e, axis) = gimp_function(xi(l, axis) + (1.5_dp - e), p)
          d(l, e, axis) = inverse_h*gimp_slope(xi(l, axis) + (1.5_dp - e), p)
        end do
      end do
    end do
  end subroutine gimp_axis

  !> GIMP weights (products over the axes).
  pure subroutine gimp_weights(xi, half, w)
    real(dp), intent(in) :: xi(lanes, NDIM), half(lanes, NDIM)
    real(dp), intent(out) :: w(lanes, NGIMP_PAD)
    real(dp) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)
    call gimp_axis(xi, half, 1.0_dp, s, d)
    call gimp_product(s, s, s, w)
  end subroutine gimp_weights

  !> Gradients of the GIMP weights (1/length).
  pure subroutine gimp_gradients(xi, half, inverse_h, g)
    real(dp), intent(in) :: xi(lanes, NDIM), half(lanes, NDIM), inverse_h
    real(dp), intent(out) :: g(lanes, NGIMP_PAD, NDIM)
    real(dp) :: s(lanes, 3, NDIM), d(lanes, 3, NDIM)
    call gimp_axis(xi, half, inverse_h, s, d)
    call gimp_product(d, s, s, g(:, :, 1))
#if NDIM > 1
    call gimp_product(s, d, s, g(:, :, 2))
#endif
#if NDIM > 2
    call gimp_product(s, s, d, g(:, :, 3))
#endif
  end subroutine gimp_gradients

  !> Products of one factor per axis, in the stencil's numbering.
  pure subroutine gimp_product(x, y, z, w)
    real(dp), intent(in) :: x(lanes, 3, NDIM), y(lanes, 3, NDIM), z(lanes, 3, NDIM)
      !! the factor of axis d is (:, :, d)
    real(dp), intent(out) :: w(lanes, NGIMP_PAD)
    integer :: l, a, e
#if NDIM == 1
    do a = 1, 3
      w(:, a) = x(:, a, 1)
    end do
    l = 0
    e = 3
#elif NDIM == 2
    integer :: b
    e = 0
    do a = 1, 3
      do b = 1, 3
        e = e + 1
        !$omp simd simdlen(8)
        do l = 1, lanes
          w(l, e) = x(l, a, 1)*y(l, b, 2)
        end do
      end do
    end do
#else
    integer :: b, c
    real(dp) :: yz(lanes, 9)
    e = 0
    do b = 1, 3
      do c = 1, 3
        e = e + 1
        !$omp simd simdlen(8)
        do l = 1, lanes
          yz(l, e) = y(l, b, 2)*z(l, c, 3)
        end do
      end do
    end do
    e = 0
    do a = 1, 3
      do b = 1, 9
        e = e + 1
        !$omp simd simdlen(8)
        do l = 1, lanes
          w(l, e) = x(l, a, 1)*yz(l, b)
        end do
      end do
    end do
#endif
    w(:, NGIMP + 1:) = 0.0_dp
  end subroutine gimp_product

  !> Values at the particles from a GIMP stencil.
  pure subroutine gimp_gather(n, w, stride, grid, row, values)
    integer, intent(in) :: n, stride
    real(dp), intent(in) :: w(lanes, NGIMP_PAD)
    real(dp), intent(in) :: grid(stride, *)
    integer, intent(in) :: row(NGIMP/3)  !! record of the stencil's first point in each row
    real(dp), intent(out) :: values(lanes, *)      !! (lanes, n)
    integer :: l, q, r, e
    real(dp) :: total(lanes)
    do q = 1, n
      total = 0.0_dp
      do r = 1, NGIMP/3
        do e = 0, 2
          !$omp simd simdlen(8)
          do l = 1, lanes
            total(l) = total(l) + w(l, r + e*(NGIMP/3))*grid(q, row(r) + e)
          end do
        end do
      end do
      values(:, q) = total
    end do
  end subroutine gimp_gather

  !> Adds mass-like values and forces of the particles to the accumulator of a GIMP stencil.
  pure subroutine gimp_scatter(nl, nq, w, values, sums)
    integer, intent(in) :: nl, nq
    real(dp), intent(in) :: w(lanes, NGIMP_PAD), values(lanes, nq)
    real(dp), intent(inout) :: sums(NGIMP_PAD, nq)
    real(dp) :: wl(NGIMP_PAD)
    integer :: l, q, e
    do l = 1, nl
      wl = w(l, :)
      do q = 1, nq
        !$omp simd
        do e = 1, NGIMP_PAD
          sums(e, q) = sums(e, q) + wl(e)*values(l, q)
        end do
      end do
    end do
  end subroutine gimp_scatter

  !> Flushes the accumulator's first x-layer to the plane buffers and moves the stencil one bin
  !! along the row.
  !!
  !! Line j of the buffers receives row j's lower part on top of row j-1's upper part: with the
  !! layers kept apart until the planes are joined, every grid point's sum is one fixed tree.
  pure subroutine linear_carry(nq, sums, shift, place, planes)
    integer, intent(in) :: nq
    real(dp), intent(inout) :: sums(NCORNER, nq)
    integer, intent(in) :: shift                   !! bin along the row
    integer, intent(in) :: place(NLINE)            !! record of bin 0 in each line
    real(dp), intent(inout) :: planes(NLAYER, nq, *)
    integer :: q, line, e
    do q = 1, nq
      do line = 1, NLINE
        do e = 1, NLAYER
          planes(e, q, place(line) + shift) = planes(e, q, place(line) + shift) + &
              sums((line - 1)*NLAYER + e, q)
        end do
      end do
      do e = 1, NROW
        sums(e, q) = sums(e + NROW, q)
        sums(e + NROW, q) = 0.0_dp
      end do
    end do
  end subroutine linear_carry

  !> The same for a GIMP stencil.
  pure subroutine gimp_carry(nq, sums, shift, place, planes)
    integer, intent(in) :: nq
    real(dp), intent(inout) :: sums(NGIMP_PAD, nq)
    integer, intent(in) :: shift, place(GIMP_LINE)
    real(dp), intent(inout) :: planes(GIMP_LAYER, nq, *)
    integer :: q, line, e
    do q = 1, nq
      do line = 1, GIMP_LINE
        do e = 1, GIMP_LAYER
          planes(e, q, place(line) + shift) = planes(e, q, place(line) + shift) + &
              sums((line - 1)*GIMP_LAYER + e, q)
        end do
      end do
      do e = 1, NGIMP - NGIMP/3
        sums(e, q) = sums(e + NGIMP/3, q)
      end do
      sums(NGIMP - NGIMP/3 + 1:, q) = 0.0_dp
    end do
  end subroutine gimp_carry

end module DIM(sgmp_transfer)
