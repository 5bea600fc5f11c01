!> What a deck may say: the type of the table of cards and keys, and how to look things up in it.
!!
!! The table itself is in `sgmp_deck_table`. Each key is registered there once; the parser, the
!! defaults, the echo, the
!! help and the reference are made from it.
module sgmp_registry
  use sgmp_spelling, only: string_t, word_in_list
  implicit none
  private
  public :: registry_t, card_definition_t, key_definition_t, kind_name
  public :: kind_real, kind_integer, kind_logical, kind_word, kind_name_word, kind_text, &
    kind_vector, kind_expression, &
            kind_interval, kind_list

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

  !> One key of a card.
  type :: key_definition_t
    character(:), allocatable :: name
    integer :: kind = kind_real
    character(:), allocatable :: help
    character(:), allocatable :: unit     !! physical dimension, '' for none
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
  end type key_definition_t

  !> One card.
  type :: card_definition_t
    character(:), allocatable :: name
    character(:), allocatable :: help
    character(:), allocatable :: example
    character(:), allocatable :: selector
      !! name of the key that decides which others exist; '' for none
    logical :: once = .false.             !! may appear once only
    logical :: free = .false.             !! may be changed when a run is restarted
    type(key_definition_t), allocatable :: keys(:)
  contains
    procedure :: find_key
    procedure :: find_slot
    procedure :: key_names
  end type card_definition_t

  !> The table.
  type :: registry_t
    type(card_definition_t), allocatable :: cards(:)
  contains
    procedure :: card => register_card
    procedure :: key => register_key
    procedure :: find_card
    procedure :: card_names
  end type registry_t

contains

  !> Registers a card; the keys that follow belong to it.
  subroutine register_card(self, name, help, example, once, selector, free)
    class(registry_t), intent(inout) :: self
    character(*), intent(in) :: name, help, example
    logical, intent(in), optional :: once, free
    character(*), intent(in), optional :: selector
    type(card_definition_t), allocatable :: longer(:)
    integer :: n
    n = 0
    if (allocated(self%cards)) n = size(self%cards)
    allocate (longer(n + 1))
    if (n > 0) longer(:n) = self%cards
    associate (card => longer(n + 1))
      card%name = name
      card%help = help
      card%example = example
      card%selector = ''
      if (present(selector)) card%selector = selector
      if (present(once)) card%once = once
      if (present(free)) card%free = free
      allocate (card%keys(0))
    end associate
    call move_alloc(longer, self%cards)
  end subroutine register_card

  !> Registers a key of the card registered last.
  subroutine register_key(self, name, kind, help, unit, default, range, choices, when, source, &
                          required, slot, free)
    class(registry_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind
    character(*), intent(in) :: help
    character(*), intent(in), optional :: unit, default, range, choices, when, source
    logical, intent(in), optional :: required, free
    integer, intent(in), optional :: slot
    type(key_definition_t), allocatable :: longer(:)
    integer :: n
    associate (card => self%cards(size(self%cards)))
      n = size(card%keys)
      allocate (longer(n + 1))
      longer(:n) = card%keys
      associate (key => longer(n + 1))
        key%name = name
        key%kind = kind
        key%help = help
        key%unit = text_or_empty(unit)
        key%default = text_or_empty(default)
        key%range = text_or_empty(range)
        key%choices = text_or_empty(choices)
        key%when = text_or_empty(when)
        key%source = text_or_empty(source)
        if (present(required)) key%required = required
        if (present(slot)) key%slot = slot
        if (present(free)) key%free = free
      end associate
      call move_alloc(longer, card%keys)
    end associate
  end subroutine register_key

  pure function text_or_empty(text) result(value)
    character(*), intent(in), optional :: text
    character(:), allocatable :: value
    value = ''
    if (present(text)) value = text
  end function text_or_empty

  !> Number of a card in the table, 0 where there is none of this name.
  pure integer function find_card(self, name) result(number)
    class(registry_t), intent(in) :: self
    character(*), intent(in) :: name
    do number = 1, size(self%cards)
      if (self%cards(number)%name == name) return
    end do
    number = 0
  end function find_card

  !> All cards' names.
  pure function card_names(self) result(names)
    class(registry_t), intent(in) :: self
    type(string_t), allocatable :: names(:)
    integer :: i
    allocate (names(size(self%cards)))
    do i = 1, size(names)
      names(i)%text = self%cards(i)%name
    end do
  end function card_names

  !> Number of a key in its card, 0 where there is none of this name.
  pure integer function find_key(self, name) result(number)
    class(card_definition_t), intent(in) :: self
    character(*), intent(in) :: name
    do number = 1, size(self%keys)
      if (self%keys(number)%name == name) return
    end do
    number = 0
  end function find_key

  !> Number of the key that takes the n-th word without `key=`, 0 where there is none.
  pure integer function find_slot(self, slot) result(number)
    class(card_definition_t), intent(in) :: self
    integer, intent(in) :: slot
    do number = 1, size(self%keys)
      if (self%keys(number)%slot == slot) return
    end do
    number = 0
  end function find_slot

  !> The names of all keys that exist for a value of the selector ('' for all).
  pure function key_names(self, selected) result(names)
    class(card_definition_t), intent(in) :: self
    character(*), intent(in) :: selected
    type(string_t), allocatable :: names(:)
    logical :: exists(size(self%keys))
    integer :: i, n
    do i = 1, size(self%keys)
      associate (when => self%keys(i)%when)
        exists(i) = selected == '' .or. when == '' .or. word_in_list(selected, when) > 0
      end associate
    end do
    allocate (names(count(exists)))
    n = 0
    do i = 1, size(self%keys)
      if (.not. exists(i)) cycle
      n = n + 1
      names(n)%text = self%keys(i)%name
    end do
  end function key_names

  !> What is written for a kind of value, for help and messages.
  pure function kind_name(kind) result(text)
    integer, intent(in) :: kind
    character(:), allocatable :: text
    character(22), parameter :: names(*) = [character(22) :: &
      'number', 'whole number', 'yes or no', 'word', 'name', 'text', 'vector (a,b,c)', &
      'formula of x y z', 'interval lower:upper', 'words, comma-separated']
    text = trim(names(kind))
  end function kind_name

end module sgmp_registry
