!> The complete resolved deck: every card and key with its value, itself a valid deck with the same
!! meaning.
module sgmp_deck_echo
  use sgmp_deck_card, only: deck_card_t, value_t
  use sgmp_keys, only: kind_expression, kind_integer, kind_interval, kind_list, kind_logical, &
                       kind_points, kind_real, kind_rows, kind_text, kind_vector
  use sgmp_parameters, only: parameters_t
  use sgmp_registry, only: card_definition_t, registry_t
  use sgmp_scene, only: statement_text_t
  use sgmp_spelling, only: word_is_identifier, word_lower
  use sgmp_text, only: real_text_plain
  implicit none
  private
  public :: deck_echo, deck_fixed

  integer, parameter :: line_length = 100
  character(1), parameter :: newline = new_line('a')

contains

  !> One card per statement, in the order of the deck, defaults included.
  function deck_echo(registry, parameters, cards) result(text)
    type(registry_t), intent(in) :: registry
    type(parameters_t), intent(in) :: parameters
    type(deck_card_t), intent(in) :: cards(:)
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(parameters%list)
      text = text//parameter_text(registry, parameters, i, cards)//newline
    end do
    do i = 1, size(cards)
      text = text//card_text(registry%cards(cards(i)%definition), cards(i))//newline
    end do
  end function deck_echo

  !> What a restart may not change: the parameters that formulas use, and the cards and keys that
  !! are not free.
  subroutine deck_fixed(registry, parameters, cards, fixed)
    type(registry_t), intent(in) :: registry
    type(parameters_t), intent(in) :: parameters
    type(deck_card_t), intent(in) :: cards(:)
    type(statement_text_t), allocatable, intent(out) :: fixed(:)
    type(statement_text_t) :: found(size(parameters%list) + size(cards))
    integer :: i, n
    n = 0
    do i = 1, size(parameters%list)
      if (.not. in_formulas(registry, cards, trim(parameters%list(i)%name))) cycle
      n = n + 1
      found(n)%text = parameter_text(registry, parameters, i, cards)
      found(n)%location = parameters%list(i)%position%text()
    end do
    do i = 1, size(cards)
      associate (definition => registry%cards(cards(i)%definition))
        if (definition%free) cycle
        n = n + 1
        found(n)%text = card_text(definition, cards(i), .true.)
        found(n)%location = cards(i)%position%text()
      end associate
    end do
    fixed = found(:n)
  end subroutine deck_fixed

  !> One parameter, as a comment where no formula needs it any more.
  function parameter_text(registry, parameters, number, cards) result(text)
    type(registry_t), intent(in) :: registry
    type(parameters_t), intent(in) :: parameters
    integer, intent(in) :: number
    type(deck_card_t), intent(in) :: cards(:)
    character(:), allocatable :: text
    associate (parameter => parameters%list(number))
      text = '! '
      if (in_formulas(registry, cards, trim(parameter%name))) text = ''
      text = text//'parameter '//trim(parameter%name)//' = '
      if (parameter%is_word) then
        text = text//quoted(parameter%text)
      else
        text = text//parameter%text
      end if
    end associate
  end function parameter_text

  !> Whether a formula of some card contains a name.
  pure logical function in_formulas(registry, cards, name) result(found)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: cards(:)
    character(*), intent(in) :: name
    integer :: i, k
    found = .true.
    do i = 1, size(cards)
      do k = 1, size(cards(i)%values)
        if (registry%cards(cards(i)%definition)%keys(k)%kind /= kind_expression) cycle
        if (.not. cards(i)%values(k)%present) cycle
        if (contains_word(word_lower(cards(i)%values(k)%text), name)) return
      end do
    end do
    found = .false.
  end function in_formulas

  !> Whether a name stands in a text with no letter, digit or underscore next to it.
  pure logical function contains_word(text, name) result(found)
    character(*), intent(in) :: text, name
    integer :: first, last
    found = .false.
    do first = 1, len(text) - len(name) + 1
      last = first + len(name) - 1
      if (text(first:last) /= name) cycle
      if (word_is_identifier('_'//text(max(1, first - 1):first - 1))) then
        if (first > 1) cycle
      end if
      found = last == len(text)
      if (.not. found) found = .not. word_is_identifier('_'//text(last + 1:last + 1))
      if (found) return
    end do
  end function contains_word

  !> One card; keys without `key=` first, long cards continued.
  function card_text(definition, card, fixed) result(text)
    type(card_definition_t), intent(in) :: definition
    type(deck_card_t), intent(in) :: card
    logical, intent(in), optional :: fixed  !! only what a restart may not change, in one line
    character(:), allocatable :: text, line
    integer :: i, slot
    logical :: all_keys
    all_keys = .true.
    if (present(fixed)) all_keys = .not. fixed
    line = card%name
    text = ''
    slot = 1
    do
      i = definition%find_slot(slot)
      if (i == 0) exit
      if (card%values(i)%present) call append_word(value_text(definition%keys(i)%kind, &
                                                              card%values(i)))
      slot = slot + 1
    end do
    do i = 1, size(definition%keys)
      if (definition%keys(i)%slot > 0 .or. .not. card%values(i)%present) cycle
      if (definition%keys(i)%free .and. .not. all_keys) cycle
      call append_word(definition%keys(i)%name//'='// &
                       value_text(definition%keys(i)%kind, card%values(i)))
    end do
    text = text//line
  contains
    subroutine append_word(word)
      character(*), intent(in) :: word
      if (len(line) + len(word) + 3 > line_length .and. all_keys) then
        text = text//line//' &'//newline
        line = '   '
      end if
      line = line//' '//word
    end subroutine append_word
  end function card_text

  !> A value as the deck would write it.
  function value_text(kind, value) result(text)
    integer, intent(in) :: kind
    type(value_t), intent(in) :: value
    character(:), allocatable :: text
    integer :: i
    select case (kind)
    case (kind_real, kind_integer)
      text = real_text_plain(value%number)
      if (value%named) text = value%text
    case (kind_logical)
      text = trim(merge('yes', 'no ', value%flag))
    case (kind_vector)
      text = '('//real_text_plain(value%vector(1))//','//real_text_plain(value%vector(2))//','// &
             real_text_plain(value%vector(3))//')'
    case (kind_points)
      text = ''
      do i = 1, size(value%points, 2)
        text = text//',('//real_text_plain(value%points(1, i))//','// &
               real_text_plain(value%points(2, i))//')'
      end do
      text = text(2:)
    case (kind_interval)
      text = end_text(1)//':'//end_text(2)
      if (all(value%open)) text = 'open'
    case (kind_expression, kind_rows, kind_text)
      text = quoted(value%text)
    case (kind_list)
      text = commas(value%text)
    case default
      text = value%text
    end select
  contains
    function end_text(side) result(bound)
      integer, intent(in) :: side
      character(:), allocatable :: bound
      bound = 'open'
      if (.not. value%open(side)) bound = real_text_plain(value%vector(side))
    end function end_text
  end function value_text

  !> In quotes that the text does not contain.
  pure function quoted(text) result(word)
    character(*), intent(in) :: text
    character(:), allocatable :: word
    word = '"'//text//'"'
    if (index(text, '"') > 0) word = "'"//text//"'"
  end function quoted

  !> Blank-separated words with commas.
  pure function commas(list) result(text)
    character(*), intent(in) :: list
    character(:), allocatable :: text
    integer :: i
    text = trim(adjustl(list))
    do i = 1, len(text)
      if (text(i:i) == ' ') text(i:i) = ','
    end do
  end function commas

end module sgmp_deck_echo
