!> Numbers put as decimal text into a buffer, for tables of many numbers.
module sgmp_decimals
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_long_long
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: integer_put, reals_put, integer_width, real_width

  integer, parameter :: integer_width = 24  !! room that an integer may need
  integer, parameter :: real_width = 34     !! and a real with a separator

  interface
    pure subroutine c_reals_put(values, n, separator, text, length) bind(c, name='sgmp_reals_put')
      import :: c_char, c_double, c_int
      implicit none
      integer(c_int), value :: n
      real(c_double), intent(in) :: values(n)
      character(kind=c_char), intent(in) :: separator
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_int), intent(out) :: length
    end subroutine c_reals_put

    pure subroutine c_integer_put(value, text, length) bind(c, name='sgmp_integer_put')
      import :: c_char, c_int, c_long_long
      implicit none
      integer(c_long_long), value :: value
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_int), intent(out) :: length
    end subroutine c_integer_put
  end interface

contains

  !> Appends values with 17 significant digits, as `es24.16e3` writes them but without blanks, and
  !! `separator` between them.
  pure subroutine reals_put(values, separator, text, used)
    real(dp), intent(in) :: values(:)
    character(1), intent(in) :: separator
    character(*), intent(inout) :: text      !! with room for `real_width` letters each
    integer, intent(inout) :: used           !! letters of it
    integer(c_int) :: length
    call c_reals_put(values, size(values), separator, text(used + 1:), length)
    used = used + length
  end subroutine reals_put

  !> Appends an integer.
  pure subroutine integer_put(value, text, used)
    integer, intent(in) :: value
    character(*), intent(inout) :: text      !! with room for `integer_width` letters
    integer, intent(inout) :: used           !! letters of it
    integer(c_int) :: length
    call c_integer_put(int(value, c_long_long), text(used + 1:), length)
    used = used + length
  end subroutine integer_put

end module sgmp_decimals
