! dimension-generic
#include "dimension.inc"
!> Scatters of one chunk of particles with linear weights (particle to grid).
!!
!! Scatters run over the stencil's points, so every particle value is a broadcast and nothing
!! collides. In 3D a bin is one cell, and its sums stay in registers; in 1D and 2D every lane adds
!! to the sums of its own cell of the bin, up to the first pad, whose cell is negative.
!! Points are numbered as in sgmp_transfer: a whole x-layer is contiguous, and moving to the next
!! cell of the row shifts the accumulator by one layer (`linear_carry`).
!!
!! In 1D and 2D the cells of a bin share points with their neighbours. Even cells have one
!! accumulator and odd ones another, both by point: cells in one of them do not overlap, so that
!! layers stay apart, a particle adds whole vectors, and a bin is flushed as long ones.
module DIM(sgmp_scatter)
#if NDIM < 3
  use sgmp_kernels, only: linear_span
#endif
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: linear_scatter, linear_scatter_force, linear_scatter_pairs, linear_scatter_slopes
  public :: linear_carry, pair_spans, pair_ends
  public :: accumulators, column_sums, stride_of

  !> Accumulators of a bin, and numbers of a column of each.
#if NDIM < 3
  integer, parameter :: span = linear_span(NDIM)
  integer, parameter :: accumulators = 2, column_sums = NROW*(span + 1)
#else
  integer, parameter :: accumulators = 1, column_sums = NCORNER
#endif

  !> Way between a stencil's points along an axis; 1 for the lower points along it, 0 for others.
#if NDIM == 1
  integer, parameter :: stride_of(1) = 1
  real(dp), parameter :: lower(2, 1) = reshape([1, 0], [2, 1])
  real(dp), parameter :: pair_ends(2, 1) = 0.0_dp
#elif NDIM == 2
  integer, parameter :: stride_of(2) = [2, 1]
  real(dp), parameter :: lower(4, 2) = reshape([1, 1, 0, 0, 1, 0, 1, 0], [4, 2])
  real(dp), parameter :: pair_ends(4, 2) = 1.0_dp - lower  !! 1 at the points where a pair ends
#else
  integer, parameter :: stride_of(3) = [4, 2, 1]
  !> Weight of a point along an axis at 0, and its slope.
  real(dp), parameter :: cx(8) = [1, 1, 1, 1, 0, 0, 0, 0], sx(8) = [-1, -1, -1, -1, 1, 1, 1, 1]
  real(dp), parameter :: cy(8) = [1, 1, 0, 0, 1, 1, 0, 0], sy(8) = [-1, -1, 1, 1, -1, -1, 1, 1]
  real(dp), parameter :: cz(8) = [1, 0, 1, 0, 1, 0, 1, 0], sz(8) = [-1, 1, -1, 1, -1, 1, -1, 1]
  !> 1 at the points where a pair, or a quad, ends.
  real(dp), parameter :: pair_ends(8, 6) = reshape([ &
    0, 0, 0, 0, 1, 1, 1, 1,   0, 0, 1, 1, 0, 0, 1, 1,   0, 1, 0, 1, 0, 1, 0, 1, &
    0, 0, 0, 1, 0, 0, 0, 1,   0, 0, 0, 0, 0, 1, 0, 1,   0, 0, 0, 0, 0, 0, 1, 1], [8, 6])
#endif
#if NDIM < 3
  !> Weight of a point along an axis at 0, and its slope.
  real(dp), parameter :: upward(NCORNER, NDIM) = 1.0_dp - 2.0_dp*lower
#endif

contains

#if NDIM < 3
  !> Adds the particles' values to the accumulators of their cells (Eqs. 21-23); pads must bring
  !! zeros.
  pure subroutine linear_scatter(nq, xi, cell, values, columns, sums)
    integer, intent(in) :: nq                      !! values per particle
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the cell
    integer, intent(in) :: cell(lanes)             !! of the bin, from 0; negative: pads
    real(dp), intent(in) :: values(lanes, nq)
    integer, intent(in) :: columns                 !! of an accumulator
    real(dp), intent(inout) :: sums(column_sums, columns, 0:*)
    real(dp) :: w(NCORNER)
    integer :: l, q, e, first, odd
    do l = 1, lanes
      if (cell(l) < 0) exit
      first = NROW*cell(l)
      odd = iand(cell(l), 1)
      !$omp simd
      do e = 1, NCORNER
        w(e) = corner_weight(xi(l, :), e, 0)
      end do
      do q = 1, nq
        !$omp simd simdlen(NCORNER)
        do e = 1, NCORNER
          sums(first + e, q, odd) = sums(first + e, q, odd) + w(e)*values(l, q)
        end do
      end do
    end do
  end subroutine linear_scatter

  !> Adds the particles' values times the derivatives of the weights along some axes (per cell of
  !! each), one value to a column every `apart`; pads must bring zeros.
  pure subroutine linear_scatter_slopes(along, xi, cell, values, apart, columns, sums)
    logical, intent(in) :: along(NDIM)             !! axes of the derivatives
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the cell
    integer, intent(in) :: cell(lanes)             !! of the bin, from 0; negative: pads
    real(dp), intent(in) :: values(lanes, NDIM)
    integer, intent(in) :: apart, columns          !! columns of an accumulator
    real(dp), intent(inout) :: sums(column_sums, columns, 0:*)
    real(dp) :: w(NCORNER)
    integer :: l, q, d, e, first, odd
    do l = 1, lanes
      if (cell(l) < 0) exit
      first = NROW*cell(l)
      odd = iand(cell(l), 1)
      w = 1.0_dp
      do d = 1, NDIM
        !$omp simd
        do e = 1, NCORNER
          w(e) = w(e)*merge(upward(e, d), lower(e, d) + upward(e, d)*xi(l, d), along(d))
        end do
      end do
      do q = 1, NDIM
        !$omp simd simdlen(NCORNER)
        do e = 1, NCORNER
          sums(first + e, 1 + (q - 1)*apart, odd) = sums(first + e, 1 + (q - 1)*apart, odd) + &
                                                    w(e)*values(l, q)
        end do
      end do
    end do
  end subroutine linear_scatter_slopes

  !> Adds -grad N . (sigma V) of the particles to the nodal forces of plain MPM (Eq. 11); pads must
  !! bring zeros.
  pure subroutine linear_scatter_force(xi, cell, inverse_h, of, flux, columns, sums)
    real(dp), intent(in) :: xi(lanes, NDIM), inverse_h
    integer, intent(in) :: cell(lanes)             !! of the bin, from 0; negative: pads
    integer, intent(in) :: of(NDIM, NDIM)          !! component of the flux: (along, of the force)
    real(dp), intent(in) :: flux(lanes, *)         !! sigma V
    integer, intent(in) :: columns                 !! of an accumulator
    real(dp), intent(inout) :: sums(column_sums, columns, 0:*)  !! the first NDIM columns
    real(dp) :: g(NCORNER, NDIM)
    integer :: l, a, b, e, first, odd
    do l = 1, lanes
      if (cell(l) < 0) exit
      first = NROW*cell(l)
      odd = iand(cell(l), 1)
      do b = 1, NDIM
        !$omp simd
        do e = 1, NCORNER
          g(e, b) = -inverse_h*corner_weight(xi(l, :), e, b)
        end do
      end do
      do a = 1, NDIM
        do b = 1, NDIM
          !$omp simd simdlen(NCORNER)
          do e = 1, NCORNER
            sums(first + e, a, odd) = sums(first + e, a, odd) + g(e, b)*flux(l, of(b, a))
          end do
        end do
      end do
    end do
  end subroutine linear_scatter_force

  !> Linear weight of a corner of a cell, or its derivative along an axis (1/cell).
  pure function corner_weight(xi, e, axis) result(w)
    real(dp), intent(in) :: xi(NDIM)
    integer, intent(in) :: e
    integer, intent(in) :: axis                    !! 0: the weight itself
    real(dp) :: w
    integer :: d
    w = 1.0_dp
    do d = 1, NDIM
      if (d == axis) then
        w = w*upward(e, d)
      else
        w = w*(lower(e, d) + upward(e, d)*xi(d))
      end if
    end do
  end function corner_weight
#else
  !> Linear weights of a chunk by stencil point: the scatter's view of `linear_weights`.
  !!
  !! All points of a lane at a time, so that they are stored in the size in which they are loaded:
  !! loads of what was stored in halves would have to wait.
  pure subroutine point_weights(xi, w)
    real(dp), intent(in) :: xi(lanes, NDIM)
    real(dp), intent(out) :: w(NCORNER, lanes)
    integer :: l, e
    real(dp), parameter :: layer(8) = [0, 0, 0, 0, 1, 1, 1, 1]
    real(dp) :: yz, upper
    do l = 1, lanes
      !$omp simd simdlen(8) private(yz, upper)
      do e = 1, NCORNER
        yz = (cy(e) + sy(e)*xi(l, 2))*(cz(e) + sz(e)*xi(l, 3))
        upper = xi(l, 1)*yz
        w(e, l) = merge(upper, yz - upper, layer(e) > 0.0_dp)
      end do
    end do
  end subroutine point_weights

  !> The same of their derivatives along some axes (per cell of each).
  pure subroutine point_slopes(along, xi, w)
    logical, intent(in) :: along(NDIM)
    real(dp), intent(in) :: xi(lanes, NDIM)
    real(dp), intent(out) :: w(NCORNER, lanes)
    real(dp) :: base(NDIM), x(lanes, NDIM)
    integer :: l, e, d
    base = merge(0.0_dp, 1.0_dp, along)
    do d = 1, NDIM
      x(:, d) = merge(1.0_dp, xi(:, d), along(d))
    end do
    do l = 1, lanes
      !$omp simd simdlen(8)
      do e = 1, NCORNER
        w(e, l) = (cx(e)*base(1) + sx(e)*x(l, 1))*(cy(e)*base(2) + sy(e)*x(l, 2))* &
                  (cz(e)*base(3) + sz(e)*x(l, 3))
      end do
    end do
  end subroutine point_slopes

  !> Adds the particles' values times the derivatives of the weights along some axes (per cell of
  !! each), one value to a column every `apart`; pads must bring zeros.
  pure subroutine linear_scatter_slopes(along, xi, cell, values, apart, columns, sums)
    logical, intent(in) :: along(NDIM)             !! axes of the derivatives
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the stencil's cell
    integer, intent(in) :: cell(lanes)             !! the bin's only one, 0
    real(dp), intent(in) :: values(lanes, NDIM)
    integer, intent(in) :: apart, columns          !! columns of the accumulator
    real(dp), intent(inout) :: sums(NCORNER, columns, 0:*)
    real(dp) :: w(NCORNER, lanes)
    integer :: e, q
    call point_slopes(along, xi, w)
    do q = 1, NDIM
      associate (total => sums(:, 1 + (q - 1)*apart, cell(1)))
        !$omp simd
        do e = 1, NCORNER
          total(e) = total(e) + &
            w(e, 1)*values(1, q) + w(e, 2)*values(2, q) + w(e, 3)*values(3, q) + &
            w(e, 4)*values(4, q) + w(e, 5)*values(5, q) + w(e, 6)*values(6, q) + &
            w(e, 7)*values(7, q) + w(e, 8)*values(8, q)
        end do
      end associate
    end do
  end subroutine linear_scatter_slopes

  !> Adds the particles' values to the accumulator of their stencil (Eqs. 21-23); pads must bring
  !! zeros.
  pure subroutine linear_scatter(nq, xi, cell, values, columns, sums)
    integer, intent(in) :: nq                      !! values per particle
    real(dp), intent(in) :: xi(lanes, NDIM)        !! position in the stencil's cell
    integer, intent(in) :: cell(lanes)             !! the bin's only one, 0
    real(dp), intent(in) :: values(lanes, nq)
    integer, intent(in) :: columns                 !! of the accumulator
    real(dp), intent(inout) :: sums(NCORNER, columns, 0:*)
    real(dp) :: w(NCORNER, lanes)
    integer :: e, q
    call point_weights(xi, w)
    do q = 1, nq
      ! All lanes in one expression keep the sum in a register; a loop over the live lanes would
      ! not.
      !$omp simd
      do e = 1, NCORNER
        sums(e, q, cell(1)) = sums(e, q, cell(1)) + &
            w(e, 1)*values(1, q) + w(e, 2)*values(2, q) + w(e, 3)*values(3, q) + &
            w(e, 4)*values(4, q) + w(e, 5)*values(5, q) + w(e, 6)*values(6, q) + &
            w(e, 7)*values(7, q) + w(e, 8)*values(8, q)
      end do
    end do
  end subroutine linear_scatter

  !> Adds -grad N . (sigma V) of the particles to the nodal forces of plain MPM (Eq. 11); pads must
  !! bring zeros.
  !!
  !! A weight is the product of its part along x and its part across: the derivative along x is the
  !! same for both x-layers but for the sign, the others are those across, shared between the layers
  !! in the proportion x.
  pure subroutine linear_scatter_force(xi, cell, inverse_h, of, flux, columns, sums)
    real(dp), intent(in) :: xi(lanes, NDIM), inverse_h
    integer, intent(in) :: cell(lanes)             !! the bin's only one, 0
    integer, intent(in) :: of(NDIM, NDIM)          !! component of the flux: (along, of the force)
    real(dp), intent(in) :: flux(lanes, *)         !! sigma V
    integer, intent(in) :: columns                 !! of the accumulator
    real(dp), intent(inout) :: sums(NCORNER, columns, 0:*)  !! the first NDIM columns
    real(dp) :: along(lanes, NDIM), w(NCORNER/2, lanes), slope(NCORNER/2, lanes, NDIM - 1)
    real(dp) :: across(lanes, NDIM - 1, NDIM), upper(lanes, NDIM - 1, NDIM)
    integer :: a, b, l
    call across_weights(xi, w, slope)
    do a = 1, NDIM
      !$omp simd simdlen(8)
      do l = 1, lanes
        along(l, a) = inverse_h*flux(l, of(1, a))
        do b = 1, NDIM - 1
          across(l, b, a) = inverse_h*flux(l, of(b + 1, a))
          upper(l, b, a) = xi(l, 1)*across(l, b, a)
        end do
      end do
    end do
    do a = 1, NDIM  ! apart, so that values are broadcast from memory and not permuted
      call add_force(w, slope, along(1, a), across(1, 1, a), upper(1, 1, a), sums(1, a, cell(1)))
    end do
  end subroutine linear_scatter_force

  !> One component of the force: `along` x both layers get the opposite; of what acts `across` x the
  !! upper layer gets `upper` and the lower one the rest.
  pure subroutine add_force(w, slope, along, across, upper, sums)
    real(dp), intent(in) :: w(NCORNER/2, lanes), slope(NCORNER/2, lanes, NDIM - 1)
    real(dp), intent(in) :: along(lanes), across(lanes, NDIM - 1), upper(lanes, NDIM - 1)
    real(dp), intent(inout) :: sums(NCORNER/2, 2)
    real(dp) :: x, y, y_upper, z, z_upper
    integer :: e, l
    ! Vectors over the points, lanes inside: each sum has a register of its own.
    !$omp simd private(x, y, y_upper, z, z_upper, l)
    do e = 1, NCORNER/2
      x = 0.0_dp
      y = 0.0_dp
      y_upper = 0.0_dp
      do l = 1, lanes
        x = x + w(e, l)*along(l)
        y = y + slope(e, l, 1)*across(l, 1)
        y_upper = y_upper + slope(e, l, 1)*upper(l, 1)
      end do
      z = 0.0_dp
      z_upper = 0.0_dp
      do l = 1, lanes
        z = z + slope(e, l, 2)*across(l, 2)
        z_upper = z_upper + slope(e, l, 2)*upper(l, 2)
      end do
      y = y + z
      y_upper = y_upper + z_upper
      sums(e, 1) = sums(e, 1) + (x - (y - y_upper))
      sums(e, 2) = sums(e, 2) - (x + y_upper)
    end do
  end subroutine add_force

  !> Products of the linear weights of all axes but x, and their derivatives (1/cell), by point.
  pure subroutine across_weights(xi, w, slope)
    real(dp), intent(in) :: xi(lanes, NDIM)
    real(dp), intent(out) :: w(NCORNER/2, lanes), slope(NCORNER/2, lanes, NDIM - 1)
    integer :: l, e
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
  end subroutine across_weights
#endif

  !> Adds the mass moments of the pairs of the stencil's points, m N_perp x (1 - x) of every axis,
  !! to the upper point of each, and in space those of its quads, with one such factor for each of
  !! two axes, to the uppermost (doc/surfaces.md); pads must bring zeros.
  pure subroutine linear_scatter_pairs(pairs, xi, cell, mass, columns, sums)
    integer, intent(in) :: pairs                   !! pairs and quads
    real(dp), intent(in) :: xi(lanes, NDIM), mass(lanes)
    integer, intent(in) :: cell(lanes)             !! of the bin, from 0; negative: pads
    integer, intent(in) :: columns                 !! of an accumulator
    real(dp), intent(inout) :: sums(column_sums, columns, 0:*)  !! the first columns
    ! The weight of an upper point is N_perp x; the other points get nothing.
#if NDIM == 2
    real(dp) :: w(NCORNER)
    integer :: a, e, l, first, odd
    do l = 1, lanes
      if (cell(l) < 0) exit
      first = NROW*cell(l)
      odd = iand(cell(l), 1)
      !$omp simd
      do e = 1, NCORNER
        w(e) = mass(l)*corner_weight(xi(l, :), e, 0)
      end do
      do a = 1, pairs
        !$omp simd simdlen(NCORNER)
        do e = 1, NCORNER
          sums(first + e, a, odd) = sums(first + e, a, odd) + &
                                    pair_ends(e, a)*(w(e)*(1.0_dp - xi(l, a)))
        end do
      end do
    end do
#elif NDIM == 3
    real(dp) :: w(NCORNER, lanes), part(lanes, 6)
    integer :: e, q
    call point_weights(xi, w)
    call pair_values(xi, mass, part)
    do q = 1, pairs
      !$omp simd
      do e = 1, NCORNER
        sums(e, q, cell(1)) = sums(e, q, cell(1)) + pair_ends(e, q)*( &
            w(e, 1)*part(1, q) + w(e, 2)*part(2, q) + w(e, 3)*part(3, q) + w(e, 4)*part(4, q) + &
            w(e, 5)*part(5, q) + w(e, 6)*part(6, q) + w(e, 7)*part(7, q) + w(e, 8)*part(8, q))
      end do
    end do
#endif
  end subroutine linear_scatter_pairs

#if NDIM == 3
  !> Mass times the way that is left to the upper point, of pairs along each axis and of quads.
  pure subroutine pair_values(xi, mass, part)
    real(dp), intent(in) :: xi(lanes, NDIM), mass(lanes)
    real(dp), intent(out) :: part(lanes, 6)
    integer :: l
    !$omp simd simdlen(8)
    do l = 1, lanes
      part(l, 1) = mass(l)*(1.0_dp - xi(l, 1))
      part(l, 2) = mass(l)*(1.0_dp - xi(l, 2))
      part(l, 3) = mass(l)*(1.0_dp - xi(l, 3))
      part(l, 4) = part(l, 2)*(1.0_dp - xi(l, 3))
      part(l, 5) = part(l, 3)*(1.0_dp - xi(l, 1))
      part(l, 6) = part(l, 1)*(1.0_dp - xi(l, 2))
    end do
  end subroutine pair_values
#endif

  !> Whether a pair reaches along an axis, or a quad, of which there is one across each axis.
  pure function pair_spans(pair, axis) result(yes)
    integer, intent(in) :: pair, axis
    logical :: yes
    if (pair <= NDIM) then
      yes = pair == axis
    else
      yes = pair - NDIM /= axis
    end if
  end function pair_spans

#if NDIM < 3
  !> Flushes the accumulators of a bin to the plane buffers and empties them, but for the upper
  !! x-layer of the last cell, an odd one, which waits for the next bin as that of the cell before
  !! it. Behind the last bin, where one more cell is flushed, nothing else is left.
  !!
  !! Every grid point's sum is one fixed tree: lower layer of a cell, upper layer of the cell
  !! before, then rows and planes.
  pure subroutine linear_carry(lead, nq, cells, sums, shift, place, fresh, planes)
    integer, intent(in) :: lead                    !! first extent of the buffers
    integer, intent(in) :: nq, cells               !! all of a bin, or 1
    real(dp), intent(inout) :: sums(NROW, 0:span, nq, 0:1)
    integer, intent(in) :: shift                   !! first cell along the row
    integer, intent(in) :: place(NLINE)            !! record of cell 0 in each line
    logical, intent(in) :: fresh                   !! nothing is in the buffers yet
    real(dp), intent(inout) :: planes(lead, nq, *)  !! (layers, columns, points), in 1D (points,
                                                    !! columns, 1)
    integer :: q
    associate (point => place(1) + shift)
      do q = 1, nq
        if (cells == 1) then
          call put(1, nq, fresh, sums(1, 0, q, 1), LOWEST(point, q))
          sums(:, 0, q, 1) = 0.0_dp
        else
          call flush(nq, fresh, sums(1, 0, q, 0), sums(1, 0, q, 1), LOWEST(point, q))
        end if
      end do
    end associate
  end subroutine linear_carry

  !> One column of a bin: sums of its points as long vectors.
  pure subroutine flush(nq, fresh, even, odd, planes)
    integer, intent(in) :: nq
    logical, intent(in) :: fresh
    real(dp), intent(inout) :: even(column_sums), odd(column_sums), planes(*)
    real(dp) :: both(NROW*span), carried(NROW)
    integer :: n
    !$omp simd simdlen(8)
    do n = 1, NROW*span
      both(n) = even(n) + odd(n)
    end do
    carried = odd(NROW*span + 1:)
    even = 0.0_dp
    odd = 0.0_dp
    odd(:NROW) = carried
    call put(span, nq, fresh, both, planes)
  end subroutine flush

  !> Puts the sums of some points into one column of the buffers, or adds them.
  pure subroutine put(n, nq, fresh, sums, planes)
    integer, intent(in) :: n, nq                   !! n: points
    logical, intent(in) :: fresh
    real(dp), intent(in) :: sums(NROW, n)
#if NDIM == 1
    real(dp), intent(inout) :: planes(NROW, *)
#else
    real(dp), intent(inout) :: planes(NROW*nq, *)
#endif
    integer :: c, e
    if (fresh) then
      do c = 1, n
        !$omp simd simdlen(NROW)
        do e = 1, NROW
          planes(e, c) = sums(e, c)
        end do
      end do
    else
      do c = 1, n
        !$omp simd simdlen(NROW)
        do e = 1, NROW
          planes(e, c) = planes(e, c) + sums(e, c)
        end do
      end do
    end if
  end subroutine put
#else
  !> Flushes the accumulator's first x-layer to the plane buffers and moves the stencil one cell
  !! along the row.
  !!
  !! Line j of the buffers receives row j's lower part on top of row j-1's upper part: with the
  !! layers kept apart until the planes are joined, every grid point's sum is one fixed tree.
  pure subroutine linear_carry(lead, nq, cells, sums, shift, place, planes)
    integer, intent(in) :: lead                    !! first extent of the buffers: NLAYER
    integer, intent(in) :: nq, cells               !! 1 cell
    real(dp), intent(inout) :: sums(NCORNER, nq, cells)
    integer, intent(in) :: shift                   !! cell along the row
    integer, intent(in) :: place(NLINE)            !! record of cell 0 in each line
    real(dp), intent(inout) :: planes(lead, nq, *)
    integer :: q, line, e
    do q = 1, nq
      do line = 1, NLINE
        ! Vectors of a layer: those over columns, which the compiler would make, cost a permutation
        ! per number.
        !$omp simd simdlen(NLAYER)
        do e = 1, NLAYER
          planes(e, q, place(line) + shift) = planes(e, q, place(line) + shift) + &
              sums((line - 1)*NLAYER + e, q, 1)
        end do
      end do
      !$omp simd simdlen(NROW)
      do e = 1, NROW
        sums(e, q, 1) = sums(e + NROW, q, 1)
        sums(e + NROW, q, 1) = 0.0_dp
      end do
    end do
  end subroutine linear_carry
#endif

end module DIM(sgmp_scatter)
