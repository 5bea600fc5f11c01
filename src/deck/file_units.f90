!> Files with units of their own (`units … scope=file`): what they say of materials is converted to
!! the units of the deck that includes them.
module sgmp_file_units
  use sgmp_deck_card, only: card_fail, card_free, deck_card_t
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_file_rows, only: file_rows_convert
  use sgmp_keys, only: key_t, kind_real, kind_rows
  use sgmp_kinds, only: dp
  use sgmp_registry, only: registry_t
  use sgmp_spelling, only: word_in_list
  use sgmp_units, only: units_in_si
  implicit none
  private
  public :: convert_files

  character(*), parameter :: materials = 'material eos failure viscosity'
    !! cards that such a file may have: all their values with units are numbers

contains

  !> Converts what stands in files with units of their own, and drops those units cards.
  subroutine convert_files(registry, cards, errors)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), allocatable, intent(inout) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    type(deck_card_t), allocatable :: kept(:)
    logical :: own(size(cards))
    integer :: i, deck
    own = [(of_file(cards(i)), i=1, size(cards))]
    if (.not. any(own)) return
    deck = findloc([(cards(i)%name == 'units' .and. .not. own(i), i=1, size(cards))], .true., 1)
    do i = 1, size(cards)
      if (.not. own(i)) cycle
      if (repeated(i, own, cards, errors)) cycle
      if (deck == 0) then
        call errors%add(cards(i)%position, 'this file has units of its own, but the deck that '// &
                        'includes it has none', 'add to the deck, e.g.: units mm g ms')
      else if (.not. (cards(i)%failed .or. cards(deck)%failed)) then
        call convert_file(registry, cards(i), cards(deck), own, cards, errors)
      end if
    end do
    do i = 1, size(cards)
      if (own(i)) call card_free(cards(i))
    end do
    kept = cards(pack([(i, i=1, size(cards))], .not. own))
    call move_alloc(kept, cards)
  end subroutine convert_files

  !> Whether a card gives the units of a file.
  function of_file(card) result(yes)
    type(deck_card_t), intent(in) :: card
    logical :: yes
    yes = card%name == 'units'
    if (yes) yes = card%word('scope') == 'file'
  end function of_file

  !> Whether a file has said its units before card i does; that is an error.
  function repeated(i, own, cards, errors) result(yes)
    integer, intent(in) :: i
    logical, intent(in) :: own(:)              !! the card gives the units of a file
    type(deck_card_t), intent(in) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    logical :: yes
    integer :: k
    k = findloc([(own(k) .and. cards(k)%position%file == cards(i)%position%file, &
                  k=1, size(cards))], .true., 1)
    yes = k < i
    if (yes) call errors%add(cards(i)%position, "card 'units' is given twice", &
                             'first given at '//cards(k)%position%text())
  end function repeated

  !> Converts the cards of one file.
  subroutine convert_file(registry, from, to, own, cards, errors)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: from, to  !! cards units of the file and of the deck
    logical, intent(in) :: own(:)              !! the card gives the units of a file
    type(deck_card_t), intent(inout) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    do i = 1, size(cards)
      if (own(i) .or. cards(i)%position%file /= from%position%file) cycle
      if (word_in_list(cards(i)%name, materials) > 0) then
        call convert_card(registry%cards(cards(i)%definition)%keys, from, to, cards(i), errors)
      else
        call card_fail(cards(i), errors, cards(i)%position, "card '"//cards(i)%name//"' in a "// &
                       'file with units of its own', 'such a file has '//materials// &
                       ' only: move the card into the deck')
      end if
    end do
  end subroutine convert_file

  !> Converts the numbers of one card, defaults among them.
  subroutine convert_card(keys, from, to, card, errors)
    type(key_t), intent(in) :: keys(:)         !! of the card
    type(deck_card_t), intent(in) :: from, to  !! cards units of the file and of the deck
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    real(dp) :: old, new
    logical :: known
    integer :: i
    do i = 1, size(keys)
      associate (key => keys(i), value => card%values(i))
        if (key%unit == '' .or. .not. value%present .or. value%named) cycle
        if (key%kind == kind_rows) then
          if (card%failed) cycle
          call file_rows_convert(key%unit, names(from), names(to), value%rows)
          cycle
        end if
        call units_in_si(key%unit, names(from), old, known)
        call units_in_si(key%unit, names(to), new, known)
        if (known .and. key%kind == kind_real) then
          value%number = value%number*(old/new)
        else
          call card_fail(card, errors, value%position, "'"//key%name//"' cannot be converted", &
                         'move the card into the deck')
        end if
      end associate
    end do
  end subroutine convert_card

  !> Units of length, mass and time.
  pure function names(card) result(units)
    type(deck_card_t), intent(in) :: card
    character(8) :: units(3)
    units = [character(8) :: card%word('length'), card%word('mass'), card%word('time')]
  end function names

end module sgmp_file_units
