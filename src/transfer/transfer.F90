! dimension-generic
#include "dimension.inc"
!> Particle-grid transfers of one chunk of particles with linear weights: gather (grid to particle),
!! scatter (particle to grid).
!!
!! A chunk is `lanes` particles of one bin. Gathers run over the lanes, so every grid value is a
!! broadcast; scatters run over the stencil's points, so every particle value is a broadcast and
!! nothing collides. Points of a stencil are numbered with the slowest axis fastest, then y, then x
!! outermost: a whole x-layer is contiguous, and moving to the next bin of the row shifts the
!! accumulator by one layer (`linear_carry`).
module DIM(sgmp_transfer)
  use sgmp_kinds, only: dp, lanes
  use sgmp_voigt, only: flux_between
  implicit none
  private
  public :: linear_weights, linear_gradients, linear_gather, linear_gather_gradient
  public :: linear_scatter, linear_scatter_force, linear_scatter_moment, linear_carry
  public :: flux_of, stride_of

  !> Flux component that acts along one axis across another.
  integer, parameter :: flux_of(NDIM, NDIM) = flux_between(:NDIM, :NDIM, NDIM)

  !> Way between a stencil's points along an axis, and the points that are the lower ones along it.
#if NDIM == 1
  integer, parameter :: stride_of(1) = 1, lower_point(1, 1) = 1
#elif NDIM == 2
  integer, parameter :: stride_of(2) = [2, 1]
  integer, parameter :: lower_point(2, 2) = reshape([1, 2, 1, 3], [2, 2])
#else
  integer, parameter :: stride_of(3) = [4, 2, 1]
  integer, parameter :: lower_point(4, 3) = reshape([1, 2, 3, 4, 1, 2, 5, 6, 1, 3, 5, 7], [4, 3])
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

  !> Velocity gradient at the particles, row by row: derivatives of the trilinear interpolant.
  !!
  !! Axis by axis: a difference taken along x is the same for all lanes, and what is interpolated
  !! along one axis serves the derivatives along the others.
  pure subroutine linear_gather_gradient(xi, inverse_h, stride, grid, row, gradient)
    real(dp), intent(in) :: xi(lanes, NDIM), inverse_h
    integer, intent(in) :: stride, row(NROW)       !! as in linear_gather
    real(dp), intent(in) :: grid(stride, *)        !! grid records that begin with the velocity
    real(dp), intent(out) :: gradient(lanes, NDIM, NDIM)  !! (:, b, a): component a along axis b
    integer :: l, a
#if NDIM == 2
    real(dp) :: v1, v2
#elif NDIM == 3
    real(dp) :: v1, v2, v3, v4, slope1, slope2
#endif
    do a = 1, NDIM
#if NDIM == 1
      do l = 1, lanes
        gradient(l, 1, 1) = inverse_h*(grid(1, row(1) + 1) - grid(1, row(1)))
      end do
#elif NDIM == 2
      associate (g1 => grid(a, row(1)), g2 => grid(a, row(2)), d1 => grid(a, row(1) + 1) - &
                 grid(a, row(1)), d2 => grid(a, row(2) + 1) - grid(a, row(2)))
        !$omp simd simdlen(8) private(v1, v2)
        do l = 1, lanes
          v1 = g1 + xi(l, 1)*d1
          v2 = g2 + xi(l, 1)*d2
          gradient(l, 1, a) = inverse_h*(d1 + xi(l, 2)*(d2 - d1))
          gradient(l, 2, a) = inverse_h*(v2 - v1)
        end do
      end associate
#else
      associate (d1 => grid(a, row(1) + 1) - grid(a, row(1)), &
                 d2 => grid(a, row(2) + 1) - grid(a, row(2)), &
                 d3 => grid(a, row(3) + 1) - grid(a, row(3)), &
                 d4 => grid(a, row(4) + 1) - grid(a, row(4)))
        !$omp simd simdlen(8) private(v1, v2, v3, v4, slope1, slope2)
        do l = 1, lanes
          slope1 = d1 + xi(l, 2)*(d3 - d1)
          slope2 = d2 + xi(l, 2)*(d4 - d2)
          gradient(l, 1, a) = inverse_h*(slope1 + xi(l, 3)*(slope2 - slope1))
          v1 = grid(a, row(1)) + xi(l, 1)*d1
          v2 = grid(a, row(2)) + xi(l, 1)*d2
          v3 = grid(a, row(3)) + xi(l, 1)*d3
          v4 = grid(a, row(4)) + xi(l, 1)*d4
          gradient(l, 2, a) = inverse_h*((v3 - v1) + xi(l, 3)*((v4 - v2) - (v3 - v1)))
          gradient(l, 3, a) = inverse_h*((v2 - v1) + xi(l, 2)*((v4 - v3) - (v2 - v1)))
        end do
      end associate
#endif
    end do
  end subroutine linear_gather_gradient

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

  !> Adds -grad N . (sigma V) of the particles to the nodal forces of plain MPM (Eq. 11); pads must
  !! bring zeros.
  !!
  !! A weight is the product of its part along x and its part across: the derivative along x is the
  !! same for both x-layers but for the sign, the others are those across, shared between the layers
  !! in the proportion x.
  pure subroutine linear_scatter_force(xi, inverse_h, flux, sums)
    real(dp), intent(in) :: xi(lanes, NDIM), inverse_h
    real(dp), intent(in) :: flux(lanes, NFLUX)       !! sigma V
    real(dp), intent(inout) :: sums(NCORNER, NDIM)   !! force accumulators
    real(dp) :: along(lanes, NDIM)
    integer :: a, l
#if NDIM > 1
    real(dp) :: w(NCORNER/2, lanes), slope(NCORNER/2, lanes, NDIM - 1)
    real(dp) :: across(lanes, NDIM - 1, NDIM), upper(lanes, NDIM - 1, NDIM)
    integer :: b
    call across_weights(xi, w, slope)
#endif
    do a = 1, NDIM
      !$omp simd simdlen(8)
      do l = 1, lanes
        along(l, a) = inverse_h*flux(l, flux_of(1, a))
#if NDIM > 1
        do b = 1, NDIM - 1
          across(l, b, a) = inverse_h*flux(l, flux_of(b + 1, a))
          upper(l, b, a) = xi(l, 1)*across(l, b, a)
        end do
#endif
      end do
    end do
    do a = 1, NDIM  ! apart, so that values are broadcast from memory and not permuted
#if NDIM == 1
      sums(1, a) = sums(1, a) + sum(along(:, a))
      sums(2, a) = sums(2, a) - sum(along(:, a))
#else
      call add_force(w, slope, along(1, a), across(1, 1, a), upper(1, 1, a), sums(1, a))
#endif
    end do
  end subroutine linear_scatter_force

  !> Adds the first moments of the particles' masses about the points of their stencil, N m (x_p -
  !! x_c) in cells; pads must bring zeros.
  !!
  !! Along one axis both points get the same but for the sign, as the lever of one is the weight of
  !! the other.
  pure subroutine linear_scatter_moment(xi, mass, sums)
    real(dp), intent(in) :: xi(lanes, NDIM), mass(lanes)
    real(dp), intent(inout) :: sums(NCORNER, NDIM)
    real(dp) :: part(lanes), w(NCORNER/2, lanes), t(NCORNER/2)
    integer :: a, e, l
    do a = 1, NDIM
      part = mass*xi(:, a)*(1.0_dp - xi(:, a))
      call other_weights(xi, a, w)
      !$omp simd private(l)
      do e = 1, NCORNER/2
        t(e) = 0.0_dp
        do l = 1, lanes
          t(e) = t(e) + w(e, l)*part(l)
        end do
      end do
      do e = 1, NCORNER/2
        sums(lower_point(e, a), a) = sums(lower_point(e, a), a) + t(e)
        sums(lower_point(e, a) + stride_of(a), a) = sums(lower_point(e, a) + stride_of(a), a) - t(e)
      end do
    end do
  end subroutine linear_scatter_moment

  !> Products of the linear weights of all axes but one.
  pure subroutine other_weights(xi, axis, w)
    real(dp), intent(in) :: xi(lanes, NDIM)
    integer, intent(in) :: axis
    real(dp), intent(out) :: w(NCORNER/2, lanes)
    integer :: l
#if NDIM == 3
    integer :: p, q
#endif
    do l = 1, lanes
#if NDIM == 1
      w(1, l) = merge(1.0_dp, xi(l, 1), axis == 1)
#elif NDIM == 2
      w(2, l) = xi(l, 3 - axis)
      w(1, l) = 1.0_dp - w(2, l)
#else
      p = merge(2, 1, axis == 1)
      q = merge(2, 3, axis == 3)
      w(4, l) = xi(l, p)*xi(l, q)
      w(3, l) = xi(l, p) - w(4, l)
      w(2, l) = xi(l, q) - w(4, l)
      w(1, l) = (1.0_dp - xi(l, p)) - w(2, l)
#endif
    end do
  end subroutine other_weights

#if NDIM > 1
  !> One component of the force: `along` x both layers get the opposite; of what acts `across` x the
  !! upper layer gets `upper` and the lower one the rest.
  pure subroutine add_force(w, slope, along, across, upper, sums)
    real(dp), intent(in) :: w(NCORNER/2, lanes), slope(NCORNER/2, lanes, NDIM - 1)
    real(dp), intent(in) :: along(lanes), across(lanes, NDIM - 1), upper(lanes, NDIM - 1)
    real(dp), intent(inout) :: sums(NCORNER/2, 2)
    real(dp) :: x, y, y_upper
#if NDIM == 3
    real(dp) :: z, z_upper
#endif
    integer :: e, l
    ! Vectors over the points, lanes inside: each sum has a register of its own.
    !$omp simd private(x, y, y_upper, l)
    do e = 1, NCORNER/2
      x = 0.0_dp
      y = 0.0_dp
      y_upper = 0.0_dp
      do l = 1, lanes
        x = x + w(e, l)*along(l)
        y = y + slope(e, l, 1)*across(l, 1)
        y_upper = y_upper + slope(e, l, 1)*upper(l, 1)
      end do
#if NDIM == 3
      z = 0.0_dp
      z_upper = 0.0_dp
      do l = 1, lanes
        z = z + slope(e, l, 2)*across(l, 2)
        z_upper = z_upper + slope(e, l, 2)*upper(l, 2)
      end do
      y = y + z
      y_upper = y_upper + z_upper
#endif
      sums(e, 1) = sums(e, 1) + (x - (y - y_upper))
      sums(e, 2) = sums(e, 2) - (x + y_upper)
    end do
  end subroutine add_force

  !> Products of the linear weights of all axes but x, and their derivatives (1/cell), by point.
  pure subroutine across_weights(xi, w, slope)
    real(dp), intent(in) :: xi(lanes, NDIM)
    real(dp), intent(out) :: w(NCORNER/2, lanes), slope(NCORNER/2, lanes, NDIM - 1)
    integer :: l, e
#if NDIM == 2
    real(dp), parameter :: c(2) = [1, 0], s(2) = [-1, 1]
    do l = 1, lanes
      do e = 1, 2
        w(e, l) = c(e) + s(e)*xi(l, 2)
        slope(e, l, 1) = s(e)
      end do
    end do
#else
    real(dp), parameter :: cy(4) = [1, 1, 0, 0], sy(4) = [-1, -1, 1, 1]
    real(dp), parameter :: cz(4) = [1, 0, 1, 0], sz(4) = [-1, 1, -1, 1]
    do l = 1, lanes
      !$omp simd simdlen(4)
      do e = 1, 4
        w(e, l) = (cy(e) + sy(e)*xi(l, 2))*(cz(e) + sz(e)*xi(l, 3))
        slope(e, l, 1) = sy(e)*(cz(e) + sz(e)*xi(l, 3))
        slope(e, l, 2) = sz(e)*(cy(e) + sy(e)*xi(l, 2))
      end do
    end do
#endif
  end subroutine across_weights
#endif

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

end module DIM(sgmp_transfer)
