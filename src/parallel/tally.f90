!> Sums of a step over everything that all ranks hold, formed exactly and exchanged once.
!!
!! A quantity that has one term only, as in 1D, costs nothing: digits are used from the second on.
module sgmp_tally
  use sgmp_exact_sum, only: exact_add, exact_digits, exact_total
  use sgmp_kinds, only: dp, i8
  use sgmp_parallel, only: parallel_ranks, parallel_sum
  implicit none
  private
  public :: tally_t, tally_reset, tally_add, tally_total

  !> Sums that are being formed.
  type :: tally_t
    integer, allocatable :: terms(:)           !! of each quantity
    real(dp), allocatable :: first(:)          !! its first term
    integer(i8), allocatable :: digits(:, :)   !! (exact_digits, quantities), from two terms on
  end type tally_t

contains

  !> Sets all sums to zero.
  pure subroutine tally_reset(tally, quantities)
    type(tally_t), intent(inout) :: tally
    integer, intent(in) :: quantities
    if (allocated(tally%terms)) then
      if (size(tally%terms) /= quantities) deallocate (tally%terms, tally%first, tally%digits)
    end if
    if (.not. allocated(tally%terms)) then
      allocate (tally%terms(quantities), tally%first(quantities))
      allocate (tally%digits(exact_digits, quantities))
    end if
    tally%terms = 0
  end subroutine tally_reset

  !> Adds one term to each of the quantities from `begin` on.
  pure subroutine tally_add(tally, begin, terms)
    type(tally_t), intent(inout) :: tally
    integer, intent(in) :: begin
    real(dp), intent(in) :: terms(:)
    integer :: t, q
    do t = 1, size(terms)
      if (abs(terms(t)) <= 0.0_dp) cycle  ! not a number goes on
      q = begin + t - 1
      tally%terms(q) = tally%terms(q) + 1
      if (tally%terms(q) == 1) then
        tally%first(q) = terms(t)
        cycle
      end if
      if (tally%terms(q) == 2) call open_digits(tally, q)
      call exact_add(tally%digits(:, q), terms(t))
    end do
  end subroutine tally_add

  !> Writes the first term, or nothing, into the digits.
  pure subroutine open_digits(tally, q)
    type(tally_t), intent(inout) :: tally
    integer, intent(in) :: q
    tally%digits(:, q) = 0_i8
    if (tally%terms(q) > 0) call exact_add(tally%digits(:, q), tally%first(q))
  end subroutine open_digits

  !> Totals over all ranks, each rounded once; `counts` are summed on the way.
  subroutine tally_total(tally, totals, counts)
    type(tally_t), intent(inout) :: tally
    real(dp), intent(out) :: totals(:)
    integer(i8), intent(inout) :: counts(:)
    integer(i8), allocatable :: message(:)
    integer :: q, n
    if (parallel_ranks() > 1) then
      do q = 1, size(totals)
        if (tally%terms(q) < 2) call open_digits(tally, q)
      end do
      n = size(tally%digits)
      allocate (message(n + size(counts)))
      message(:n) = reshape(tally%digits, [n])
      message(n + 1:) = counts
      message = parallel_sum(message)
      tally%digits = reshape(message(:n), shape(tally%digits))
      counts = message(n + 1:)
      tally%terms = 2
    end if
    do q = 1, size(totals)
      select case (tally%terms(q))
      case (0)
        totals(q) = 0.0_dp
      case (1)
        totals(q) = tally%first(q)
      case default
        totals(q) = exact_total(tally%digits(:, q))
      end select
    end do
  end subroutine tally_total

end module sgmp_tally
