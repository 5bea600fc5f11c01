!> What became of each keyword of an imported deck: the report that goes with the native deck.
module sgmp_import_notes
  use sgmp_deck_errors, only: position_t
  use sgmp_file_tools, only: output_file_t
  use sgmp_kinds, only: i8
  use sgmp_sorting, only: sort_order
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: import_notes_t, note_honoured, note_approximated

  integer(i8), parameter :: column_bound = 2_i8**31  !! more than any column
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
    type(note_t) :: new
    new = note_t(kind, place%line, place%column, keyword, text)
    if (.not. allocated(self%entries)) allocate (self%entries(0))
    self%entries = [self%entries, new]
  end subroutine notes_add

  !> Number of notes of a kind.
  pure integer function notes_count(self, kind) result(number)
    class(import_notes_t), intent(in) :: self
    integer, intent(in) :: kind  !! one of note_*
    number = 0
    if (allocated(self%entries)) number = count(self%entries%kind == kind)
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
    integer(i8), allocatable :: place(:)
    if (.not. allocated(self%entries)) then
      allocate (order(0))
      return
    end if
    allocate (order(size(self%entries)))
    place = int(self%entries%line, i8)*column_bound + self%entries%column
    call sort_order(place, order)
  end function by_place

end module sgmp_import_notes
