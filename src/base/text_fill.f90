!> Sentences broken into lines: the help of the program on a terminal, lines of its documents.
module sgmp_text_fill
  implicit none
  private
  public :: text_filled

contains

  !> A text in lines of at most so many bytes, broken at blanks; a longer word has a line of its
  !! own.
  pure function text_filled(text, width, first, later) result(lines)
    character(*), intent(in) :: text   !! words with blanks between them
    integer, intent(in) :: width       !! of a line, what it begins with included
    character(*), intent(in) :: first  !! what the first line begins with
    character(*), intent(in) :: later  !! what the others begin with
    character(:), allocatable :: lines  !! with a line feed between two lines
    integer :: start, length, used
    logical :: begins
    lines = first
    used = len(first)
    begins = .true.
    start = 1
    do while (start <= len_trim(text))
      length = index(text(start:)//' ', ' ') - 1
      if (length > 0) then
        if (.not. begins .and. used + 1 + length > width) then
          lines = lines//new_line('a')//later
          used = len(later)
          begins = .true.
        end if
        if (.not. begins) lines = lines//' '
        lines = lines//text(start:start + length - 1)
        used = used + length + merge(0, 1, begins)
        begins = .false.
      end if
      start = start + length + 1
    end do
  end function text_filled

end module sgmp_text_fill
