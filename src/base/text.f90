!> Numbers as text: for messages, for files that are read back, for decks.
module sgmp_text
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sgmp_decimals, only: real_width, reals_put
  use sgmp_kinds, only: dp, i4, i8
  implicit none
  private
  public :: integer_text, percent_text, real_text, real_text_about, real_text_full, &
            real_text_plain, &
            real_text_short, real_text_tidy, row_text, text_with_backslashes

  !> Decimal text of an integer of either kind.
  interface integer_text
    module procedure integer_text_i4, integer_text_i8
  end interface integer_text

contains

  pure function integer_text_i4(value) result(text)
    integer(i4), intent(in) :: value
    character(:), allocatable :: text
    text = integer_text_i8(int(value, i8))
  end function integer_text_i4

  pure function integer_text_i8(value) result(text)
    integer(i8), intent(in) :: value
    character(:), allocatable :: text
    character(24) :: buffer
    write (buffer, '(i0)') value
    text = trim(buffer)
  end function integer_text_i8

  !> A part of a whole as a percentage with two decimals.
  pure function percent_text(part) result(text)
    real(dp), intent(in) :: part
    character(:), allocatable :: text
    character(24) :: number
    write (number, '(f24.2)') max(-1.0e12_dp, min(1.0e12_dp, 100.0_dp*part))
    text = trim(adjustl(number))//' %'
  end function percent_text

  !> A real with six significant digits at most, as one writes it, for messages: 8, 0.25, 1.17e-11.
  pure function real_text(x) result(text)
    real(dp), intent(in) :: x
    character(:), allocatable :: text
    character(40) :: buffer
    if (ieee_is_finite(x)) then
      write (buffer, '(es40.5e3)') x
      text = plain_text(trim(adjustl(buffer)))
    else
      text = real_text_full(x)
    end if
  end function real_text

  !> A real with 17 significant digits, which restores every bit when read back; NaN, Infinity as
  !! words.
  pure function real_text_full(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    character(24) :: buffer
    write (buffer, '(es24.16e3)') value
    text = trim(adjustl(buffer))
  end function real_text_full

  !> The shortest decimal text that restores every bit and shows that it is real (JSON): 0.1, 25.0,
  !! 1.17E+11.
  pure function real_text_short(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    character(40) :: buffer, form
    integer :: exponent, mark
    if (.not. ieee_is_finite(value)) then
      text = real_text_full(value)
      return
    end if
    text = shortest(value)
    mark = index(text, 'E')
    read (text(mark + 1:), *) exponent
    if (exponent >= -4 .and. exponent <= 9) then
      write (form, '("(f40.", i0, ")")') max(mark - index(text, '.') - 1 - exponent, 1)
      write (buffer, form) value
      text = trim(adjustl(buffer))
    else
      text = text(:mark - 1)
      if (text(len(text):) == '.') text = text//'0'
      text = text//'E'//merge('-', '+', exponent < 0)//integer_text(abs(exponent))
    end if
  end function real_text_short

  !> The shortest decimal text that restores every bit, as one writes it in a deck: 0.1, 25,
  !! 1.17e11; NaN, Infinity as words.
  pure function real_text_plain(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    if (ieee_is_finite(value)) then
      text = plain_text(shortest(value))
    else
      text = real_text_full(value)
    end if
  end function real_text_plain

  !> About a real, as one writes it: four digits.
  pure function real_text_about(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    character(40) :: buffer
    real(dp) :: rounded
    write (buffer, '(es40.3e3)') value
    read (buffer, *) rounded
    text = real_text_plain(rounded)
  end function real_text_about

  !> A real as one writes it in a deck, without the noise of its last digits: 0.7 for 0.1 + 3*0.2.
  pure function real_text_tidy(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    character(40) :: buffer
    real(dp) :: short
    write (buffer, '(es40.12e3)') value
    read (buffer, *) short
    if (abs(short - value) > 4.0_dp*spacing(value)) write (buffer, '(es40.16e3)') value
    text = plain_text(trim(adjustl(buffer)))
  end function real_text_tidy

  !> Scientific notation with as few digits as restore every bit: -1.17E+011.
  pure function shortest(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    character(40) :: buffer
    character(16) :: form
    real(dp) :: again
    integer :: n
    do n = 0, 16
      write (form, '("(es40.", i0, "e3)")') n
      write (buffer, form) value
      if (abs(value) > 0.1_dp*huge(value)) cycle  ! rounded up it could overflow: take all digits
      read (buffer, *) again
      if (transfer(again, 0_i8) == transfer(value, 0_i8)) exit
    end do
    text = trim(adjustl(buffer))
  end function shortest

  !> Turns `-d.ddddE+ddd` into plain decimals where that is short.
  pure function plain_text(scientific) result(text)
    character(*), intent(in) :: scientific
    character(:), allocatable :: text, mantissa, sign
    integer :: e, exponent
    sign = ''
    text = scientific
    if (text(1:1) == '-') then
      sign = '-'
      text = text(2:)
    end if
    e = index(text, 'E')
    read (text(e + 1:), *) exponent
    mantissa = text(1:1)//text(3:e - 1)
    do while (len(mantissa) > 1 .and. mantissa(len(mantissa):) == '0')
      mantissa = mantissa(:len(mantissa) - 1)
    end do
    if (exponent >= 0 .and. exponent < 7) then
      if (len(mantissa) <= exponent + 1) then
        text = mantissa//repeat('0', exponent + 1 - len(mantissa))
      else
        text = mantissa(:exponent + 1)//'.'//mantissa(exponent + 2:)
      end if
    else if (exponent < 0 .and. exponent >= -4) then
      text = '0.'//repeat('0', -exponent - 1)//mantissa
    else
      text = mantissa(1:1)
      if (len(mantissa) > 1) text = text//'.'//mantissa(2:)
      text = text//'e'//integer_text(exponent)
    end if
    text = sign//text
  end function plain_text

  !> Values in full precision with `separator` between them, no blanks besides it.
  pure function row_text(values, separator) result(text)
    real(dp), intent(in) :: values(:)
    character(1), intent(in) :: separator
    character(:), allocatable :: text
    character(real_width*size(values)) :: buffer
    integer :: n
    n = 0
    call reals_put(values, separator, buffer, n)
    text = buffer(:n)
  end function row_text

  !> A text with a backslash before each of some letter that means something where it goes.
  pure function text_with_backslashes(text, letter) result(escaped)
    character(*), intent(in) :: text
    character(1), intent(in) :: letter
    character(:), allocatable :: escaped
    integer :: i
    escaped = ''
    do i = 1, len(text)
      if (text(i:i) == letter) escaped = escaped//'\'
      escaped = escaped//text(i:i)
    end do
  end function text_with_backslashes

end module sgmp_text
