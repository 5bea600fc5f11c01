!> A statement of a deck to a card: which keys are known, repeated, missing, superfluous; defaults.
module sgmp_card_parse
  use sgmp_card_values, only: evaluate_value
  use sgmp_deck_card, only: card_fail, deck_card_t
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_keys, only: key_t, kind_text
  use sgmp_lexer, only: statement_t, token_t
  use sgmp_parameters, only: parameters_t
  use sgmp_registry, only: card_definition_t
  use sgmp_spelling, only: suggestion, word_in_list, word_lower
  implicit none
  private
  public :: card_parse, card_default

contains

  !> A card as if written without any key: defaults only.
  subroutine card_default(definition, number, position, parameters, card, errors)
    type(card_definition_t), intent(in) :: definition
    integer, intent(in) :: number             !! of the definition in the table
    type(position_t), intent(in) :: position
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), intent(out) :: card
    type(deck_errors_t), intent(inout) :: errors
    call start_card(definition, number, position, card)
    call finish_card(definition, parameters, card, errors)
  end subroutine card_default

  !> Parses a statement whose keyword has been recognised.
  subroutine card_parse(definition, number, statement, parameters, card, errors)
    type(card_definition_t), intent(in) :: definition
    integer, intent(in) :: number             !! of the definition in the table
    type(statement_t), intent(in) :: statement
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), intent(out) :: card
    type(deck_errors_t), intent(inout) :: errors
    integer :: i, slot
    logical :: pair
    call start_card(definition, number, statement%tokens(1)%position, card)
    slot = 0
    i = 2
    associate (tokens => statement%tokens)
      do while (i <= size(tokens))
        pair = .false.
        if (i < size(tokens)) pair = tokens(i + 1)%equals
        if (tokens(i)%equals) then
          call card_fail(card, errors, tokens(i)%position, 'no key before the equals sign', &
                    'write key=value')
          i = i + 1
        else if (pair .and. i + 2 > size(tokens)) then
          call card_fail(card, errors, tokens(i)%position, &
                         "no value after '"//tokens(i)%text//"='", 'write key=value')
          i = i + 2
        else if (pair) then
          call take_key(definition, tokens(i), tokens(i + 2), parameters, card, errors)
          i = i + 3
        else
          call take_word(definition, tokens(i), slot, parameters, card, errors)
          i = i + 1
        end if
      end do
    end associate
    call finish_card(definition, parameters, card, errors)
  end subroutine card_parse

  subroutine start_card(definition, number, position, card)
    type(card_definition_t), intent(in) :: definition
    integer, intent(in) :: number
    type(position_t), intent(in) :: position
    type(deck_card_t), intent(out) :: card
    integer :: i
    card%definition = number
    card%name = definition%name
    card%position = position
    allocate (card%keys(size(definition%keys)), card%values(size(definition%keys)))
    do i = 1, size(card%keys)
      card%keys(i)%text = definition%keys(i)%name
      card%values(i)%position = position
    end do
  end subroutine start_card

  !> Stores `key=value`.
  subroutine take_key(definition, key, value, parameters, card, errors)
    type(card_definition_t), intent(in) :: definition
    type(token_t), intent(in) :: key, value
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    integer :: number
    number = definition%find_key(word_lower(key%text))
    if (number == 0) then
      call card_fail(card, errors, key%position, "unknown key '"//key%text//"' of card "// &
                "'"//card%name//"'", &
                suggestion(key%text, definition%key_names(''), 'keys of '//card%name))
    else if (card%values(number)%given) then
      call card_fail(card, errors, key%position, "'"//key%text//"' is given twice", &
                'remove one of the two')
    else if (value%equals) then
      call card_fail(card, errors, value%position, "no value after '"//key%text//"='", &
                     'write key=value')
    else
      call store(card, number, value, parameters, errors)
    end if
  end subroutine take_key

  !> Stores a word without key in its slot; a text takes all the words that are left.
  subroutine take_word(definition, token, slot, parameters, card, errors)
    type(card_definition_t), intent(in) :: definition
    type(token_t), intent(in) :: token
    integer, intent(inout) :: slot
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    integer :: number
    if (slot > 0) then
      number = definition%find_slot(slot)
      if (definition%keys(number)%kind == kind_text) then
        card%values(number)%text = card%values(number)%text//' '// &
                                   parameters%substitute(token%text, token%position, errors)
        return
      end if
    end if
    number = definition%find_slot(slot + 1)
    if (number == 0) then
      call card_fail(card, errors, token%position, "unexpected '"//token%text//"' in card "// &
                "'"//card%name//"'", &
                trim(misplaced_key(definition, token%text)))
      return
    end if
    slot = slot + 1
    if (card%values(number)%given) then
      call card_fail(card, errors, token%position, &
                     "'"//definition%keys(number)%name//"' is given twice", 'remove one of the two')
    else
      call store(card, number, token, parameters, errors)
    end if
  end subroutine take_word

  !> What may have been meant by a word in the wrong place.
  function misplaced_key(definition, word) result(remedy)
    type(card_definition_t), intent(in) :: definition
    character(*), intent(in) :: word
    character(:), allocatable :: remedy
    if (definition%find_key(word_lower(word)) > 0) then
      remedy = 'a key needs a value: '//word//'=…'
    else
      remedy = 'keys are written key=value, e.g. '//definition%example
    end if
  end function misplaced_key

  subroutine store(card, number, token, parameters, errors)
    type(deck_card_t), intent(inout) :: card
    integer, intent(in) :: number
    type(token_t), intent(in) :: token
    type(parameters_t), intent(inout) :: parameters
    type(deck_errors_t), intent(inout) :: errors
    integer :: errors_before
    errors_before = errors%count()
    associate (value => card%values(number))
      value%given = .true.
      value%position = token%position
      if (token%quoted) value%position%column = value%position%column + 1
      value%text = parameters%substitute(token%text, value%position, errors)
      value%present = errors%count() == errors_before
      if (.not. value%present) card%failed = .true.
    end associate
  end subroutine store

  !> Fills in defaults, finds missing and superfluous keys, evaluates.
  subroutine finish_card(definition, parameters, card, errors)
    type(card_definition_t), intent(in) :: definition
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: selected
    integer :: i, selector
    logical :: known
    selected = ''
    known = .true.
    selector = definition%find_key(definition%selector)
    if (selector > 0) then
      call evaluate_value(definition%keys(selector), card, selector, parameters, errors)
      known = card%values(selector)%present .and. .not. card%failed
      if (known) selected = card%values(selector)%text
    end if
    do i = 1, size(card%values)
      if (i == selector) then
        if (.not. card%values(i)%given) then
          call missing(definition, definition%keys(i), card, errors)
        end if
      else
        call finish_value(definition, i, selected, known, parameters, card, errors)
      end if
    end do
  end subroutine finish_card

  !> One key of a card: superfluous, missing, given or by default.
  subroutine finish_value(definition, number, selected, known, parameters, card, errors)
    type(card_definition_t), intent(in) :: definition
    integer, intent(in) :: number
    character(*), intent(in) :: selected  !! value of the key that selects which others apply
    logical, intent(in) :: known          !! that value could be made out
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    logical :: applies
    associate (key => definition%keys(number), value => card%values(number))
      applies = key%when == '' .or. word_in_list(selected, key%when) > 0
      if (value%given .and. known .and. .not. applies) then
        call card_fail(card, errors, value%position, "'"//key%name//"' means nothing for "// &
                  definition%selector//' '//selected, &
                  suggestion(key%name, definition%key_names(selected), 'keys for '//selected))
      else if (value%given) then
        if (value%present) call evaluate_value(key, card, number, parameters, errors)
      else if (applies .and. key%required) then
        if (known) call missing(definition, key, card, errors)
      else if (applies .and. key%default /= '') then
        value%text = key%default
        value%present = .true.
        call evaluate_value(key, card, number, parameters, errors)
      end if
    end associate
  end subroutine finish_value

  subroutine missing(definition, key, card, errors)
    type(card_definition_t), intent(in) :: definition
    type(key_t), intent(in) :: key
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: remedy
    remedy = 'add '//key%name//'=…: '//key%help
    if (key%slot > 0) remedy = 'e.g. '//definition%example
    call card_fail(card, errors, card%position, "card '"//card%name//"' needs '"//key%name//"'", &
                   remedy)
  end subroutine missing

end module sgmp_card_parse
