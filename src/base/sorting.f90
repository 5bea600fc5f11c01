!> Stable sorting of integer keys.
module sgmp_sorting
  use sgmp_kinds, only: i8
  implicit none
  private
  public :: sort_order, sort_order_within, sorted_first

  integer, parameter :: digit_bits = 11
  integer, parameter :: few = 32  !! keys that are sorted before a radix sort has cleared its counts

contains

  !> Permutation that puts non-negative keys in ascending order, equal keys in their old order: a
  !! radix sort.
  pure subroutine sort_order(keys, order)
    integer(i8), intent(in) :: keys(:)
    integer, intent(out) :: order(:)  !! (size(keys)); keys(order) ascends
    integer, allocatable :: other(:)
    integer :: counts(0:2**digit_bits - 1), start, n, p, digit, shift
    integer(i8) :: largest
    do p = 1, size(keys)
      order(p) = p
    end do
    if (size(keys) <= few) then
      call sort_few(keys, order)
      return
    end if
    largest = maxval(keys)
    allocate (other(size(keys)))
    shift = 0
    do while (shift < 63)
      if (ishft(largest, -shift) == 0_i8) exit
      counts = 0
      do p = 1, size(keys)
        digit = digit_of(keys(p), shift)
        counts(digit) = counts(digit) + 1
      end do
      start = 1
      do digit = 0, size(counts) - 1
        n = counts(digit)
        counts(digit) = start
        start = start + n
      end do
      other = order
      do p = 1, size(keys)
        digit = digit_of(keys(other(p)), shift)
        order(counts(digit)) = other(p)
        counts(digit) = counts(digit) + 1
      end do
      shift = shift + digit_bits
    end do
  end subroutine sort_order

  !> The same, where equal keys follow each other in the order of their second keys.
  pure subroutine sort_order_within(keys, second, order)
    integer(i8), intent(in) :: keys(:), second(:)
    integer, intent(out) :: order(:)  !! (size(keys))
    integer :: by_second(size(keys))
    call sort_order(second, by_second)
    call sort_order(keys(by_second), order)
    order = by_second(order)
  end subroutine sort_order_within

  !> sort_order for a handful of keys: by insertion.
  pure subroutine sort_few(keys, order)
    integer(i8), intent(in) :: keys(:)
    integer, intent(inout) :: order(:)
    integer :: p, q
    do p = 2, size(keys)
      do q = p, 2, -1
        if (keys(order(q - 1)) <= keys(p)) exit
        order(q) = order(q - 1)
      end do
      order(q) = p
    end do
  end subroutine sort_few

  pure function digit_of(key, shift) result(digit)
    integer(i8), intent(in) :: key
    integer, intent(in) :: shift
    integer :: digit
    digit = int(ibits(key, shift, min(digit_bits, 64 - shift)))
  end function digit_of

  !> Place of the first of some ascending numbers that is not below a value; size + 1: none.
  pure integer function sorted_first(sorted, value) result(first)
    integer, intent(in) :: sorted(:), value
    integer :: last, middle
    first = 1
    last = size(sorted) + 1
    do while (first < last)
      middle = first + (last - first)/2
      if (sorted(middle) < value) then
        first = middle + 1
      else
        last = middle
      end if
    end do
  end function sorted_first

end module sgmp_sorting
