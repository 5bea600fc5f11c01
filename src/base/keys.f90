!> Named values that a user sets: what each may be, and how its value is asked for.
!!
!! Whoever needs constants describes them as plain data (`key_t`) and reads them back through
!! `values_t`; where they were written, and how, is the deck's affair. Materials know no more.
module sgmp_keys
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: key_t, key, values_t, fault_t, fault_make, kind_name
  public :: kind_real, kind_integer, kind_logical, kind_word, kind_name_word, kind_text, &
            kind_vector, kind_expression, kind_interval, kind_list, kind_points, kind_rows

  integer, parameter :: kind_real = 1       !! number or constant expression
  integer, parameter :: kind_integer = 2    !! whole number
  integer, parameter :: kind_logical = 3    !! yes or no
  integer, parameter :: kind_word = 4       !! one of `choices`
  integer, parameter :: kind_name_word = 5  !! a name chosen by the user
  integer, parameter :: kind_text = 6       !! anything
  integer, parameter :: kind_vector = 7     !! (a,b,c), (a,b) or a
  integer, parameter :: kind_expression = 8  !! function of position and time
  integer, parameter :: kind_interval = 9   !! lower:upper, either may be `open`; or `open`
  integer, parameter :: kind_list = 10      !! words of `choices` separated by commas
  integer, parameter :: kind_points = 11    !! (a,b),(c,d),...: points of a plane
  integer, parameter :: kind_rows = 12      !! a file of rows of numbers, all of the same length
  character(22), parameter :: kind_names(*) = [character(22) :: &
    'number', 'whole number', 'yes or no', 'word', 'name', 'text', 'vector (a,b,c)', &
    'formula', 'interval lower:upper', 'words, comma-separated', 'points (a,b),(c,d),...', &
    'file of numbers']

  !> One named value.
  type :: key_t
    character(:), allocatable :: name
    integer :: kind = kind_real
    character(:), allocatable :: help
    character(:), allocatable :: unit     !! physical dimension, '' for none; of rows those of the
                                          !! first columns, separated by commas
    character(:), allocatable :: default  !! as it would be written; '' for none
    character(:), allocatable :: range    !! e.g. '(0,inf)' or '[0,1]'; '' for any
    character(:), allocatable :: choices  !! words separated by blanks
    character(:), allocatable :: when
      !! values of the card's selector for which the key exists; '' for all
    character(:), allocatable :: source   !! where the default or the formula comes from
    logical :: required = .false.
    integer :: slot = 0
      !! place among the words without `key=`; 0: only as `key=value`
    logical :: free = .false.             !! may be changed when a run is restarted
  end type key_t

  !> Values of keys, to be asked for by name.
  type, abstract :: values_t
  contains
    procedure(ask_number), deferred :: number
    procedure(ask_word), deferred :: word
    procedure(ask_logical), deferred :: flag
    procedure(ask_logical), deferred :: has  !! given, or by default
    procedure(ask_rows), deferred :: rows
  end type values_t

  abstract interface
    !> Value of a real key; `absent`, or else zero, where it has none.
    pure function ask_number(self, key, absent) result(value)
      import :: dp, values_t
      implicit none
      class(values_t), intent(in) :: self
      character(*), intent(in) :: key
      real(dp), intent(in), optional :: absent
      real(dp) :: value
    end function ask_number
    !> Text of a word; '' where it has none.
    pure function ask_word(self, key) result(word)
      import :: values_t
      implicit none
      class(values_t), intent(in) :: self
      character(*), intent(in) :: key
      character(:), allocatable :: word
    end function ask_word
    !> Rows of numbers of a file, (columns, rows); none where it has none.
    pure function ask_rows(self, key) result(rows)
      import :: dp, values_t
      implicit none
      class(values_t), intent(in) :: self
      character(*), intent(in) :: key
      real(dp), allocatable :: rows(:, :)
    end function ask_rows
    !> A yes or no.
    pure function ask_logical(self, key) result(yes)
      import :: values_t
      implicit none
      class(values_t), intent(in) :: self
      character(*), intent(in) :: key
      logical :: yes
    end function ask_logical
  end interface

  !> Why values do not go together.
  type :: fault_t
    character(:), allocatable :: key      !! the one to point at; '' for all together
    character(:), allocatable :: message  !! what is wrong
    character(:), allocatable :: remedy
    logical :: warning = .false.          !! the value can be meant
    integer :: row = 0, column = 0        !! of a file of numbers: the one that is meant
  end type fault_t

contains

  !> Describes a key; what is not given is empty or no.
  pure function key(name, kind, help, unit, default, range, choices, when, source, required, &
                    slot, free) result(new)
    character(*), intent(in) :: name
    integer, intent(in) :: kind           !! one of kind_*
    character(*), intent(in) :: help
    character(*), intent(in), optional :: unit, default, range, choices, when, source
    logical, intent(in), optional :: required, free
    integer, intent(in), optional :: slot
    type(key_t) :: new
    new%name = name
    new%kind = kind
    new%help = help
    new%unit = text_or_empty(unit)
    new%default = text_or_empty(default)
    new%range = text_or_empty(range)
    new%choices = text_or_empty(choices)
    new%when = text_or_empty(when)
    new%source = text_or_empty(source)
    if (present(required)) new%required = required
    if (present(slot)) new%slot = slot
    if (present(free)) new%free = free
  end function key

  pure function text_or_empty(text) result(value)
    character(*), intent(in), optional :: text
    character(:), allocatable :: value
    value = ''
    if (present(text)) value = text
  end function text_or_empty

  !> States a fault.
  pure subroutine fault_make(fault, key, message, remedy, at)
    type(fault_t), allocatable, intent(out) :: fault
    character(*), intent(in) :: key, message, remedy
    integer, intent(in), optional :: at(2)  !! column and row of a number in a file
    allocate (fault)
    fault%key = key
    fault%message = message
    fault%remedy = remedy
    if (present(at)) then
      fault%column = at(1)
      fault%row = at(2)
    end if
  end subroutine fault_make

  !> What is written for a kind of value, for help and messages.
  pure function kind_name(kind) result(text)
    integer, intent(in) :: kind
    character(:), allocatable :: text
    text = trim(kind_names(kind))
  end function kind_name

end module sgmp_keys
