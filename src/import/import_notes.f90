!> What became of each keyword of an imported deck: the report that goes with the native deck.
module sgmp_import_notes
  use sgmp_deck_errors, only: position_t
  use sgmp_file_tools, only: output_file_t
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: import_notes_t, note_honoured, note_approximated

  integer, parameter :: note_honoured = 1      !! means here what it means there
  integer, parameter :: note_approximated = 2  !! means something else, for the reason given
  character(12), parameter :: words(2) = [character(12) :: 'honoured', 'approximated']

  type :: note_t
    integer :: kind = note_honoured
    integer :: line = 0, column = 0
    character(:), allocatable :: keyword, text
  end type note_t

  !> All notes, in order of discovery.
  type :: import_notes_t
    type(note_t), allocatable :: entries(:)
    integer :: n = 0
  contains
    procedure :: add => notes_add
    procedure :: write => notes_write
    procedure :: count => notes_count
  end type import_notes_t

contains

  !> Appends a note.
  subroutine notes_add(self, kind, place, keyword, text)
    class(import_notes_t), intent(inout) :: self
    integer, intent(in) :: kind             !! one of note_*
    type(position_t), intent(in) :: place   !! of the keyword
    character(*), intent(in) :: keyword
    character(*), intent(in) :: text        !! what it became, and why
    type(note_t), allocatable :: longer(:)
    if (.not. allocated(self%entries)) allocate (self%entries(32))
    if (self%n == size(self%entries)) then
      allocate (longer(2*self%n))
      longer(:self%n) = self%entries
      call move_alloc(longer, self%entries)
    end if
    self%n = self%n + 1
    self%entries(self%n) = note_t(kind, place%line, place%column, keyword, text)
  end subroutine notes_add

  !> Number of notes of a kind.
  pure integer function notes_count(self, kind) result(number)
    class(import_notes_t), intent(in) :: self
    integer, intent(in) :: kind  !! one of note_*
    number = 0
    if (self%n > 0) number = count(self%entries(:self%n)%kind == kind)
  end function notes_count

  !> Writes the report, a line per keyword in the order of the deck.
  subroutine notes_write(self, deck, native, file)
    class(import_notes_t), intent(in) :: self
    character(*), intent(in) :: deck, native   !! paths
    type(output_file_t), intent(inout) :: file
    integer :: i
    integer, allocatable :: order(:)
    call file%line('Import of '//deck//' to '//native//': '// &
                   integer_text(self%count(note_honoured))//' entries honoured, '// &
                   integer_text(self%count(note_approximated))//' approximated.')
    call file%line('')
    order = by_place(self)
    do i = 1, size(order)
      associate (note => self%entries(order(i)))
        call file%line(deck//':'//integer_text(note%line)//':'//integer_text(note%column)//': '// &
                       trim(words(note%kind))//': '//note%keyword//': '//note%text)
      end associate
    end do
  end subroutine notes_write

  !> Order of the notes by line and column; notes of one place stay as they came.
  pure function by_place(self) result(order)
    class(import_notes_t), intent(in) :: self
    integer, allocatable :: order(:)
    integer :: i, k
    allocate (order(self%n))
    do i = 1, self%n
      k = i
      do while (k > 1)
        if (.not. before(self%entries(i), self%entries(order(k - 1)))) exit
        order(k) = order(k - 1)
        k = k - 1
      end do
      order(k) = i
    end do
  end function by_place

  pure function before(a, b) result(yes)
    type(note_t), intent(in) :: a, b
    logical :: yes
    yes = a%line < b%line .or. (a%line == b%line .and. a%column < b%column)
  end function before

end module sgmp_import_notes
