!> What a deck may say: the type of the table of cards and keys, and how to look things up in it.
!!
!! Each card is registered once, with its keys and with the procedures that read and check it; the
!! parser, the defaults, the echo, the help and the reference are made from that. The table itself
!! is in `sgmp_deck_table`.
module sgmp_registry
  use sgmp_deck_card, only: deck_card_t
  use sgmp_keys, only: key, key_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_spelling, only: string_t, word_in_list
  implicit none
  private
  public :: registry_t, card_definition_t
  public :: read_first, read_second, read_third, read_last

  !> When a card is read: what others refer to comes first. Cards of the last two turns are not
  !! read at all where they failed; the others are, for their names.
  integer, parameter :: read_first = 1   !! refers to nothing, others refer to it
  integer, parameter :: read_second = 2  !! refers to those: bodies
  integer, parameter :: read_third = 3   !! refers to those, too: groups of bodies
  integer, parameter :: read_last = 4    !! refers to anything; in the order of the deck

  abstract interface
    !> Reads a card into the scene, or checks it when all cards are read.
    subroutine card_action(card, draft)
      import :: deck_card_t, draft_t
      implicit none
      type(deck_card_t), intent(in) :: card
      type(draft_t), intent(inout) :: draft
    end subroutine card_action
  end interface

  !> What else a card does, for a feature whose keys it has.
  type :: card_extension_t
    procedure(card_action), pointer, nopass :: read => null()
    procedure(card_action), pointer, nopass :: check => null()
  end type card_extension_t

  !> One card.
  type :: card_definition_t
    character(:), allocatable :: name
    character(:), allocatable :: group    !! heading in the reference's contents
    character(:), allocatable :: help
    character(:), allocatable :: example
    character(:), allocatable :: selector
      !! name of the key that decides which others exist; '' for none
    character(:), allocatable :: needed
      !! what to say where a deck has no such card; '' where it needs none
    logical :: once = .false.             !! may appear once only
    logical :: free = .false.             !! may be changed when a run is restarted
    type(key_t), allocatable :: keys(:)
    integer :: turn = read_last           !! one of read_*
    procedure(card_action), pointer, nopass :: read => null()
    procedure(card_action), pointer, nopass :: check => null()
    type(card_extension_t), allocatable :: extensions(:)
  contains
    procedure :: do_read
    procedure :: do_check
    procedure :: find_key
    procedure :: find_slot
    procedure :: key_names
  end type card_definition_t

  !> The table.
  type :: registry_t
    type(card_definition_t), allocatable :: cards(:)
    character(:), allocatable :: group    !! of the cards registered next
    integer :: current = 0                !! card to which the keys belong that are registered next
  contains
    procedure :: card => register_card
    procedure :: extend => extend_card
    procedure :: key => register_key
    procedure :: keys => register_keys
    procedure :: find_card
    procedure :: card_names
  end type registry_t

contains

  !> Registers a card; the keys that follow belong to it.
  subroutine register_card(self, name, help, example, read, check, once, selector, free, needed, &
                           turn)
    class(registry_t), intent(inout) :: self
    character(*), intent(in) :: name, help, example
    procedure(card_action), optional :: read, check
    logical, intent(in), optional :: once, free
    character(*), intent(in), optional :: selector, needed
    integer, intent(in), optional :: turn
    type(card_definition_t) :: new
    new%name = name
    new%group = self%group
    new%help = help
    new%example = example
    new%selector = ''
    new%needed = ''
    if (present(read)) new%read => read
    if (present(check)) new%check => check
    if (present(selector)) new%selector = selector
    if (present(needed)) new%needed = needed
    if (present(once)) new%once = once
    if (present(free)) new%free = free
    if (present(turn)) new%turn = turn
    allocate (new%keys(0), new%extensions(0))
    if (.not. allocated(self%cards)) allocate (self%cards(0))
    self%cards = [self%cards, new]
    self%current = size(self%cards)
  end subroutine register_card

  !> Adds to a card that is registered already: the keys that follow belong to it, and these
  !! procedures read and check them.
  subroutine extend_card(self, name, read, check)
    class(registry_t), intent(inout) :: self
    character(*), intent(in) :: name
    procedure(card_action) :: read
    procedure(card_action), optional :: check
    type(card_extension_t) :: new
    self%current = self%find_card(name)
    new%read => read
    if (present(check)) new%check => check
    associate (card => self%cards(self%current))
      card%extensions = [card%extensions, new]
    end associate
  end subroutine extend_card

  !> Reads a card, and what features have added to it.
  subroutine do_read(self, card, draft)
    class(card_definition_t), intent(in) :: self
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: i
    if (associated(self%read)) call self%read(card, draft)
    do i = 1, size(self%extensions)
      call self%extensions(i)%read(card, draft)
    end do
  end subroutine do_read

  !> Checks a card, and what features have added to it.
  subroutine do_check(self, card, draft)
    class(card_definition_t), intent(in) :: self
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: i
    if (associated(self%check)) call self%check(card, draft)
    do i = 1, size(self%extensions)
      if (associated(self%extensions(i)%check)) call self%extensions(i)%check(card, draft)
    end do
  end subroutine do_check

  !> Registers a key of the card registered or extended last.
  subroutine register_key(self, name, kind, help, unit, default, range, choices, when, source, &
                          required, slot, free)
    class(registry_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind
    character(*), intent(in) :: help
    character(*), intent(in), optional :: unit, default, range, choices, when, source
    logical, intent(in), optional :: required, free
    integer, intent(in), optional :: slot
    associate (card => self%cards(self%current))
      card%keys = [card%keys, key(name, kind, help, unit, default, range, choices, when, source, &
                                  required, slot, free)]
    end associate
  end subroutine register_key

  !> Registers keys that exist for one value of the selector; a key known already exists for it,
  !! too. Without a selector they exist always.
  subroutine register_keys(self, keys, selected)
    class(registry_t), intent(inout) :: self
    type(key_t), intent(in) :: keys(:)
    character(*), intent(in), optional :: selected
    integer :: i, known
    associate (card => self%cards(self%current))
      do i = 1, size(keys)
        known = card%find_key(keys(i)%name)
        if (known == 0) then
          card%keys = [card%keys, keys(i)]
          if (present(selected)) card%keys(size(card%keys))%when = selected
        else
          card%keys(known)%when = card%keys(known)%when//' '//selected
        end if
      end do
    end associate
  end subroutine register_keys

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

end module sgmp_registry
