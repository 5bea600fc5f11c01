! dimension-generic
#include "dimension.inc"
#if NDIM > 1
!> Rows of points that take part in exact rotation (doc/rotation.md), and sums and differences of
!! what the 2^d points around them hold.
module DIM(sgmp_rotation_rows)
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: tile, slope, next_run, sums_row, add_differences, centre_rows

  integer, parameter :: tile = 128   !! points of a row that are handled at a time
  real(dp), parameter :: slope = 0.5_dp**(NDIM - 1)  !! factor of a difference between 2^d corners

contains

  !> The next points of a row that are marked, at most a tile of them; last < first: no more.
  pure subroutine next_run(field, s, as, first, last)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, as                 !! interval; column of the marks
    integer, intent(out) :: first
    integer, intent(inout) :: last               !! of the run before
    integer :: at
    at = field%neighbour(0, 0, s)
    first = last + 1
    do while (first <= field%work%last(s))
      if (field%rotation%at(at + first, as)) exit
      first = first + 1
    end do
    last = first - 1
    do while (last < min(field%work%last(s), first + tile - 1))
      if (.not. field%rotation%at(at + last + 1, as)) exit
      last = last + 1
    end do
  end subroutine next_run

  !> Sums of the 2^d points around those of a row; in whole vectors, since rows are short.
  pure subroutine sums_row(n, column, b, total)
    integer, intent(in) :: n, b(NROW)
    real(dp), intent(in) :: column(*)
    real(dp), intent(inout) :: total(*)          !! a tile
    integer :: i
    !$omp simd
    do i = 1, lanes*((n + lanes - 1)/lanes)
      total(i) = corner_sum(column, b, i - 1) + corner_sum(column, b, i)
    end do
  end subroutine sums_row

  !> Adds a factor times the differences, upper minus lower along an axis, of the points around
  !! those of a row.
  pure subroutine add_differences(n, factor, axis, column, b, total)
    integer, intent(in) :: n, axis, b(NROW)
    real(dp), intent(in) :: factor, column(*)
    real(dp), intent(inout) :: total(n)
    integer :: i
    select case (axis)
    case (1)
      !$omp simd
      do i = 1, n
        total(i) = total(i) + factor*(corner_sum(column, b, i) - corner_sum(column, b, i - 1))
      end do
    case (2)
      !$omp simd
      do i = 1, n
        total(i) = total(i) + factor*(corner_slope_2(column, b, i - 1) + &
                                      corner_slope_2(column, b, i))
      end do
#if NDIM == 3
    case (3)
      !$omp simd
      do i = 1, n
        total(i) = total(i) + factor*(corner_slope_3(column, b, i - 1) + &
                                      corner_slope_3(column, b, i))
      end do
#endif
    case default  ! the axes are complete
    end select
  end subroutine add_differences

  !> Records of the centre left of node `first` in the rows of centres around a row of nodes.
  pure function centre_rows(field, s, first) result(b)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first
    integer :: b(NROW)
    integer :: r
    do r = 1, NROW
      b(r) = field%neighbour((r - 1)/2 - NDIM + 2, mod(r - 1, 2) - 1, s) + first - 1
    end do
  end function centre_rows

#include "corner_sums.inc"

end module DIM(sgmp_rotation_rows)
#endif
