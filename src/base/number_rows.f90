!> Text files of numbers, row by row: blanks, commas and tabs separate them; # and ! begin comments.
module sgmp_number_rows
  use, intrinsic :: ieee_exceptions, only: ieee_get_halting_mode, ieee_overflow, ieee_set_flag, &
                                           ieee_set_halting_mode
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: number_looks_so, number_read, number_row, number_row_is_empty, number_row_next, &
            number_separators

  character(*), parameter :: number_separators = ' ,'//achar(9)//achar(13)
  character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

contains

  !> Whether a line has nothing but separators.
  pure function number_row_is_empty(line) result(yes)
    character(*), intent(in) :: line
    logical :: yes
    yes = verify(line, number_separators) == 0
  end function number_row_is_empty

  !> The next line without its comment and the mark by which spreadsheets begin a file in UTF-8;
  !! false at the end of the file.
  function number_row_next(unit, line) result(there)
    integer, intent(in) :: unit
    character(:), allocatable, intent(inout) :: line
    logical :: there
    character(256) :: part
    integer :: length, status
    line = ''
    do
      read (unit, '(a)', advance='no', size=length, iostat=status) part
      if (status == 0 .or. is_iostat_eor(status)) line = line//part(:length)
      if (status /= 0) exit
    end do
    there = is_iostat_eor(status) .or. len(line) > 0
    if (index(line, byte_order_mark) == 1) line = line(len(byte_order_mark) + 1:)
    if (scan(line, '#!') > 0) line = line(:scan(line, '#!') - 1)
  end function number_row_next

  !> The numbers of a line: how many there are, and the first of them.
  subroutine number_row(line, row, found, wrong)
    character(*), intent(in) :: line
    real(dp), intent(out) :: row(:)
    integer, intent(out) :: found
    character(:), allocatable, intent(out) :: wrong  !! what is no number
    real(dp) :: value
    integer :: first, last
    row = 0.0_dp
    found = 0
    wrong = ''
    last = 0
    do
      first = verify(line(last + 1:), number_separators) + last
      if (first == last) return
      last = scan(line(first:)//' ', number_separators) + first - 2
      call number_read(line(first:last), value, wrong)
      if (wrong /= '') return
      found = found + 1
      if (found <= size(row)) row(found) = value
    end do
  end subroutine number_row

  !> Whether a word may be a number: 1+2, which Fortran reads as 100, is none, 1.5-100 of a file
  !! that a Fortran program wrote is one.
  pure logical function number_looks_so(text) result(yes)
    character(*), intent(in) :: text
    integer :: i
    yes = verify(text, '0123456789+-.eEdD') == 0
    do i = 2, len(text)
      if (scan(text(i:i), '+-') == 0 .or. scan(text(i - 1:i - 1), 'eEdD') > 0) cycle
      yes = yes .and. len(text) - i == 3
    end do
  end function number_looks_so

  !> Reads a number. One beyond the largest becomes infinite, which is an error of the file and not
  !! of the program: it must not trap.
  subroutine number_read(text, value, wrong)
    character(*), intent(in) :: text
    real(dp), intent(out) :: value
    character(:), allocatable, intent(out) :: wrong  !! nothing if it is a number
    logical :: traps
    integer :: status
    value = 0.0_dp
    status = 1
    call ieee_get_halting_mode(ieee_overflow, traps)
    if (traps) call ieee_set_halting_mode(ieee_overflow, .false.)
    if (number_looks_so(text)) read (text, *, iostat=status) value
    wrong = ''
    if (status /= 0) wrong = "'"//text//"' is not a number"
    if (.not. traps) return
    call ieee_set_flag(ieee_overflow, .false.)
    call ieee_set_halting_mode(ieee_overflow, .true.)
  end subroutine number_read

end module sgmp_number_rows
