!> Reads a deck: text -> statements -> cards -> scene, with every error of the deck found in one go.
module sgmp_deck
  use sgmp_cards, only: card_default, card_free, card_parse, deck_card_t
  use sgmp_deck_echo, only: deck_echo, deck_fixed
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_deck_table, only: deck_table
  use sgmp_lexer, only: lexer_read, statement_t
  use sgmp_parameters, only: parameters_t
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: scene_free, scene_t
  use sgmp_scene_build, only: scene_build
  use sgmp_scene_check, only: scene_check, scene_check_cards
  use sgmp_spelling, only: string_t, suggestion, word_lower
  implicit none
  private
  public :: deck_read

contains

  !> Reads and validates a deck. Where `errors%count()` is positive the scene is incomplete: do not
  !! run it.
  subroutine deck_read(path, settings, scene, errors)
    character(*), intent(in) :: path         !! file
    character(*), intent(in) :: settings(:)  !! `NAME=VALUE` from the command line
    type(scene_t), intent(out) :: scene      !! to be released with `scene_free`
    type(deck_errors_t), intent(out) :: errors
    type(registry_t) :: registry
    type(statement_t), allocatable :: statements(:)
    type(parameters_t) :: parameters
    type(deck_card_t), allocatable :: cards(:)
    type(position_t) :: deck
    logical :: complete
    integer :: i
    registry = deck_table()
    scene%file = path
    scene%title = path
    deck%file = path
    call lexer_read(path, statements, complete, errors)
    if (size(statements) == 0) return
    call parameters%start(settings, errors)
    allocate (cards(0))
    do i = 1, size(statements)
      call read_statement(registry, statements(i), parameters, cards, errors)
    end do
    call parameters%check_use(errors)
    call scene_check_cards(registry, cards, deck, complete, errors)
    call add_default_cards(registry, deck, parameters, cards, errors)
    call scene_build(cards, scene, errors)
    call scene_check(registry, cards, scene, errors)
    call drop_overridden(cards)
    if (errors%count() == 0) then
      scene%resolved = deck_echo(registry, parameters, cards)
      call deck_fixed(registry, parameters, cards, scene%fixed)
    end if
    do i = 1, size(cards)
      call card_free(cards(i))
    end do
  end subroutine deck_read

  !> Parameters are defined as they come; everything else becomes a card.
  subroutine read_statement(registry, statement, parameters, cards, errors)
    type(registry_t), intent(in) :: registry
    type(statement_t), intent(in) :: statement
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), allocatable, intent(inout) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    type(deck_card_t) :: card
    integer :: number
    associate (keyword => statement%tokens(1))
      if (word_lower(keyword%text) == 'parameter') then
        call define_parameters(statement, parameters, errors)
        return
      end if
      number = registry%find_card(word_lower(keyword%text))
      if (number == 0) then
        call errors%add(keyword%position, "unknown card '"//keyword%text//"'", &
                        suggestion(keyword%text, known_keywords(registry), 'cards'))
        return
      end if
    end associate
    call card_parse(registry%cards(number), number, statement, parameters, card, errors)
    call append_card(cards, card)
  end subroutine read_statement

  !> `parameter name = value [name = value …]`.
  subroutine define_parameters(statement, parameters, errors)
    type(statement_t), intent(in) :: statement
    type(parameters_t), intent(inout) :: parameters
    type(deck_errors_t), intent(inout) :: errors
    logical :: fits
    integer :: i
    associate (tokens => statement%tokens)
      fits = size(tokens) > 1 .and. mod(size(tokens) - 1, 3) == 0
      do i = 2, merge(size(tokens), 1, fits), 3
        fits = fits .and. tokens(i + 1)%equals .and. .not. (tokens(i)%equals .or. &
                                                            tokens(i + 2)%equals)
      end do
      if (.not. fits) then
        call errors%add(tokens(1)%position, 'a parameter is written name = value', &
                        'put a value that contains blanks in quotes')
        return
      end if
      do i = 2, size(tokens), 3
        call parameters%define(tokens(i), tokens(i + 2), errors)
      end do
    end associate
  end subroutine define_parameters

  !> Cards that mean something when absent, so that the echo is complete.
  subroutine add_default_cards(registry, deck, parameters, cards, errors)
    type(registry_t), intent(in) :: registry
    type(position_t), intent(in) :: deck
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), allocatable, intent(inout) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    type(deck_card_t) :: card
    integer :: i, k
    do i = 1, size(registry%cards)
      associate (definition => registry%cards(i))
        if (.not. definition%once) cycle
        if (any([(definition%keys(k)%required, k=1, size(definition%keys))])) cycle
        if (definition%name == 'time') cycle
        if (any(cards%definition == i)) cycle
        call card_default(definition, i, deck, parameters, card, errors)
        call append_card(cards, card)
      end associate
    end do
  end subroutine add_default_cards

  !> A fixed step overrides the Courant number, whose default must then not be echoed.
  subroutine drop_overridden(cards)
    type(deck_card_t), intent(inout) :: cards(:)
    integer :: i
    do i = 1, size(cards)
      if (cards(i)%name /= 'time') cycle
      if (cards(i)%has('dt')) cards(i)%values(cards(i)%at('cfl'))%present = .false.
    end do
  end subroutine drop_overridden

  !> The table's cards and the two that are dealt with before it.
  pure function known_keywords(registry) result(names)
    type(registry_t), intent(in) :: registry
    type(string_t), allocatable :: names(:)
    type(string_t), allocatable :: cards(:)
    integer :: n
    cards = registry%card_names()
    n = size(cards)
    allocate (names(n + 2))
    names(:n) = cards
    names(n + 1)%text = 'parameter'
    names(n + 2)%text = 'include'
  end function known_keywords

  subroutine append_card(cards, card)
    type(deck_card_t), allocatable, intent(inout) :: cards(:)
    type(deck_card_t), intent(in) :: card
    type(deck_card_t), allocatable :: longer(:)
    integer :: n
    n = size(cards)
    allocate (longer(n + 1))
    longer(:n) = cards
    longer(n + 1) = card
    call move_alloc(longer, cards)
  end subroutine append_card

end module sgmp_deck
