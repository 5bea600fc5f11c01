!> Sums of doubles that do not depend on the order of their terms.
!!
!! A long fixed-point number holds every double exactly (Kulisch's accumulator): the terms are added
!! as integers, which is associative, and the total is rounded once. Ranks add their digits, so that
!! a sum over planes has the same bits however the planes are divided among ranks and threads.
module sgmp_exact_sum
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use sgmp_kinds, only: dp, i8
  implicit none
  private
  public :: exact_add, exact_digits, exact_total

  integer, parameter :: digit_bits = 32
  !> Digits of 32 bits from 2^-1074 to beyond 2^1024; each has 31 bits of room for carries, which is
  !! enough for 2^31 terms. The last counts terms that are not finite.
  integer, parameter :: exact_digits = 69
  integer, parameter :: top = exact_digits - 1
  integer, parameter :: smallest = -1074         !! exponent of the lowest bit
  integer, parameter :: mantissa_bits = digits(1.0_dp)
  integer(i8), parameter :: mask = int(z'FFFFFFFF', i8)

contains

  !> Adds one term.
  pure subroutine exact_add(number, term)
    integer(i8), intent(inout) :: number(exact_digits)
    real(dp), intent(in) :: term
    integer(i8) :: bits, mantissa, sign
    integer :: exponent, at, shift
    bits = transfer(term, bits)
    exponent = int(ibits(bits, mantissa_bits - 1, 11))
    mantissa = ibits(bits, 0, mantissa_bits - 1)
    if (exponent == 2047) then
      number(exact_digits) = number(exact_digits) + 1_i8
      return
    end if
    if (exponent > 0) mantissa = ibset(mantissa, mantissa_bits - 1)
    if (mantissa == 0_i8) return
    shift = max(exponent, 1) - 1
    at = 1 + shift/digit_bits
    shift = mod(shift, digit_bits)
    sign = merge(-1_i8, 1_i8, bits < 0_i8)
    number(at) = number(at) + sign*iand(ishft(mantissa, shift), mask)
    number(at + 1) = number(at + 1) + sign*iand(ishft(mantissa, shift - digit_bits), mask)
    number(at + 2) = number(at + 2) + sign*iand(ishft(mantissa, shift - 2*digit_bits), mask)
  end subroutine exact_add

  !> The sum, rounded to nearest, ties to even; not a number if a term was not finite.
  pure function exact_total(number) result(total)
    integer(i8), intent(in) :: number(exact_digits)
    real(dp) :: total
    integer(i8) :: proper(exact_digits)
    integer :: highest, d
    logical :: negative
    if (number(exact_digits) /= 0_i8) then
      total = ieee_value(total, ieee_quiet_nan)
      return
    end if
    proper = number
    call carry(proper)
    negative = proper(top) < 0_i8
    if (negative) then
      proper = -number
      call carry(proper)
    end if
    total = 0.0_dp
    do d = top, 1, -1
      if (proper(d) == 0_i8) cycle
      highest = (d - 1)*digit_bits + bit_size(proper(d)) - leadz(proper(d)) - 1
      total = rounded(proper, highest)
      exit
    end do
    if (negative) total = -total
  end function exact_total

  !> Brings all digits but the top one into 0 .. 2^32 - 1.
  pure subroutine carry(number)
    integer(i8), intent(inout) :: number(exact_digits)
    integer(i8) :: over
    integer :: d
    do d = 1, top - 1
      over = shifta(number(d), digit_bits)
      number(d) = iand(number(d), mask)
      number(d + 1) = number(d + 1) + over
    end do
  end subroutine carry

  !> The double nearest to a proper number whose highest bit is given.
  pure function rounded(number, highest) result(value)
    integer(i8), intent(in) :: number(exact_digits)
    integer, intent(in) :: highest
    real(dp) :: value
    integer(i8) :: mantissa
    integer :: lowest
    lowest = highest - mantissa_bits + 1
    if (lowest <= 0) then
      mantissa = part(number, 0, highest + 1)
      value = scale(real(mantissa, dp), smallest)
      return
    end if
    mantissa = part(number, lowest, mantissa_bits)
    if (part(number, lowest - 1, 1) == 1_i8) then
      if (btest(mantissa, 0) .or. below(number, lowest - 1)) mantissa = mantissa + 1_i8
    end if
    value = scale(real(mantissa, dp), lowest + smallest)
  end function rounded

  !> `count` bits (at most 53) from bit `first` on.
  pure function part(number, first, count) result(bits)
    integer(i8), intent(in) :: number(exact_digits)
    integer, intent(in) :: first, count
    integer(i8) :: bits
    integer :: at, shift, d
    at = 1 + first/digit_bits
    shift = mod(first, digit_bits)
    bits = 0_i8
    do d = 0, 2
      if (at + d > top) exit
      bits = ior(bits, ishft(number(at + d), d*digit_bits - shift))
    end do
    bits = ibits(bits, 0, count)
  end function part

  !> Whether any bit below bit `first` is set.
  pure function below(number, first) result(yes)
    integer(i8), intent(in) :: number(exact_digits)
    integer, intent(in) :: first
    logical :: yes
    integer :: at
    at = first/digit_bits
    yes = any(number(:at) /= 0_i8)
    if (mod(first, digit_bits) > 0) then
      yes = yes .or. ibits(number(at + 1), 0, mod(first, digit_bits)) /= 0_i8
    end if
  end function below

end module sgmp_exact_sum
