!> Numbers as text, for messages.
module sgmp_text
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: integer_text, real_text

contains

  !> Shortest decimal form of an integer.
  pure function integer_text(i) result(text)
    integer, intent(in) :: i
    character(:), allocatable :: text
    character(12) :: buffer
    write (buffer, '(i0)') i
    text = trim(buffer)
  end function integer_text

  !> A real with six significant digits.
  pure function real_text(x) result(text)
    real(dp), intent(in) :: x
    character(:), allocatable :: text
    character(16) :: buffer
    write (buffer, '(g0.6)') x
    text = trim(adjustl(buffer))
  end function real_text

end module sgmp_text
