!> The list of everything wrong with a deck, each entry with its place, source line, caret and
!! remedy.
module sgmp_deck_errors
  use, intrinsic :: iso_fortran_env, only: output_unit
  use sgmp_errors, only: error_t, exit_deck
  use sgmp_spelling, only: string_t
  implicit none
  private
  public :: deck_errors_t, deck_error_t, position_t

  !> A place in a deck.
  type :: position_t
    character(:), allocatable :: file   !! path as opened, or `--set`
    integer :: line = 0                 !! from 1; 0: the file as a whole
    integer :: column = 0               !! from 1
    character(:), allocatable :: source  !! the text of that line
  contains
    procedure :: text => position_text
  end type position_t

  !> One error or warning.
  type :: deck_error_t
    logical :: warning = .false.
    type(position_t) :: position
    character(:), allocatable :: message
    character(:), allocatable :: remedy
  end type deck_error_t

  !> All errors and warnings of a deck, in order of discovery.
  type :: deck_errors_t
    type(deck_error_t), allocatable :: entries(:)
  contains
    procedure :: add => errors_add
    procedure :: warn => errors_warn
    procedure :: count => errors_count
    procedure :: warnings => errors_warnings
    procedure :: warning_lines => errors_warning_lines
    procedure :: print => errors_print
    procedure :: first => errors_first
  end type deck_errors_t

contains

  !> `file:line:column`, or only the file where there is no line.
  pure function position_text(self) result(text)
    class(position_t), intent(in) :: self
    character(:), allocatable :: text
    character(12) :: line, column
    text = ''
    if (allocated(self%file)) text = self%file
    if (self%line <= 0) return
    write (line, '(i0)') self%line
    write (column, '(i0)') self%column
    text = text//':'//trim(line)//':'//trim(column)
  end function position_text

  !> Appends an error.
  subroutine errors_add(self, position, message, remedy)
    class(deck_errors_t), intent(inout) :: self
    type(position_t), intent(in) :: position
    character(*), intent(in) :: message          !! what is wrong, with the offending word
    character(*), intent(in), optional :: remedy  !! what was expected, or what to do
    call append(self, position, message, .false., remedy)
  end subroutine errors_add

  !> Appends a warning, which stops nothing.
  subroutine errors_warn(self, position, message, remedy)
    class(deck_errors_t), intent(inout) :: self
    type(position_t), intent(in) :: position
    character(*), intent(in) :: message
    character(*), intent(in), optional :: remedy
    call append(self, position, message, .true., remedy)
  end subroutine errors_warn

  subroutine append(self, position, message, warning, remedy)
    class(deck_errors_t), intent(inout) :: self
    type(position_t), intent(in) :: position
    character(*), intent(in) :: message
    logical, intent(in) :: warning
    character(*), intent(in), optional :: remedy
    type(deck_error_t) :: new
    new%warning = warning
    new%position = position
    new%message = message
    new%remedy = ''
    if (present(remedy)) new%remedy = remedy
    if (.not. allocated(self%entries)) allocate (self%entries(0))
    self%entries = [self%entries, new]
  end subroutine append

  !> Number of errors, warnings not counted.
  pure integer function errors_count(self) result(n)
    class(deck_errors_t), intent(in) :: self
    n = 0
    if (allocated(self%entries)) n = count(.not. self%entries%warning)
  end function errors_count

  !> Number of warnings.
  pure integer function errors_warnings(self) result(n)
    class(deck_errors_t), intent(in) :: self
    n = 0
    if (allocated(self%entries)) n = count(self%entries%warning)
  end function errors_warnings

  !> Each warning in one line: place and message.
  function errors_warning_lines(self) result(lines)
    class(deck_errors_t), intent(in) :: self
    type(string_t), allocatable :: lines(:)
    integer :: i, n
    allocate (lines(self%warnings()))
    if (size(lines) == 0) return
    n = 0
    do i = 1, size(self%entries)
      if (.not. self%entries(i)%warning) cycle
      n = n + 1
      lines(n)%text = self%entries(i)%position%text()//': '//self%entries(i)%message
    end do
  end function errors_warning_lines

  !> The first error as a value for callers that report only one; not allocated if there is none.
  subroutine errors_first(self, error)
    class(deck_errors_t), intent(in) :: self
    type(error_t), allocatable, intent(out) :: error
    integer :: i
    if (self%count() == 0) return
    do i = 1, size(self%entries)
      if (.not. self%entries(i)%warning) exit
    end do
    allocate (error)
    error%code = exit_deck
    error%location = self%entries(i)%position%text()
    error%message = self%entries(i)%message
    error%remedy = self%entries(i)%remedy
  end subroutine errors_first

  !> Writes every entry: place and message, the line, a caret under the column, the remedy.
  subroutine errors_print(self, unit)
    class(deck_errors_t), intent(in) :: self
    integer, intent(in), optional :: unit  !! formatted unit; default: standard output
    integer :: i, to
    to = output_unit
    if (present(unit)) to = unit
    if (.not. allocated(self%entries)) return
    do i = 1, size(self%entries)
      call print_entry(self%entries(i), to)
    end do
    if (self%count() > 0) write (to, '(i0, a)') self%count(), ' error(s) in the deck'
  end subroutine errors_print

  subroutine print_entry(entry, unit)
    type(deck_error_t), intent(in) :: entry
    integer, intent(in) :: unit
    character(:), allocatable :: kind
    kind = 'error'
    if (entry%warning) kind = 'warning'
    write (unit, '(a)') entry%position%text()//': '//kind//': '//entry%message
    if (allocated(entry%position%source) .and. entry%position%line > 0) then
      write (unit, '(a)') '  | '//entry%position%source
      write (unit, '(a)') '  | '//caret(entry%position)
    end if
    if (len(entry%remedy) > 0) write (unit, '(a)') '  = '//entry%remedy
  end subroutine print_entry

  !> Blanks (and the line's own tabs) up to the column, then a caret.
  pure function caret(position) result(text)
    type(position_t), intent(in) :: position
    character(:), allocatable :: text
    character(1), parameter :: tab = achar(9)
    integer :: i
    text = repeat(' ', max(0, position%column - 1))
    do i = 1, min(len(text), len(position%source))
      if (position%source(i:i) == tab) text(i:i) = tab
    end do
    text = text//'^'
  end function caret

end module sgmp_deck_errors
