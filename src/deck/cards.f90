!> One card of a deck: its tokens checked against the table and turned into values.
module sgmp_cards
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_expression, only: expression_free, expression_t
  use sgmp_kinds, only: dp
  use sgmp_lexer, only: statement_t, token_t
  use sgmp_parameters, only: name_size, parameters_t
  use sgmp_registry, only: card_definition_t, key_definition_t, kind_expression, kind_integer, &
                           kind_interval, kind_list, kind_logical, kind_name, kind_name_word, &
                           kind_real, kind_text, kind_vector, kind_word
  use sgmp_spelling, only: string_t, suggestion, word_count, word_in_list, word_is_identifier, &
                        word_item, word_lower
  use sgmp_text, only: integer_text, real_text_plain
  implicit none
  private
  public :: deck_card_t, value_t, card_parse, card_default, card_free

  !> The value of one key.
  type :: value_t
    logical :: given = .false.             !! written in the deck
    logical :: present = .false.           !! given, or has a default
    character(:), allocatable :: text      !! after replacement of `$name`; words in lower case
    type(position_t) :: position           !! of the value, or of the card where not given
    real(dp) :: number = 0.0_dp            !! real, integer
    logical :: named = .false.             !! real: one of the key's words instead of a number
    logical :: flag = .false.              !! logical
    real(dp) :: vector(3) = 0.0_dp         !! vector; interval: lower, upper
    integer :: components = 0              !! of the vector
    logical :: open(2) = .true.            !! interval
    type(expression_t) :: expression
  end type value_t

  !> A card with a value for each key of its definition, in the same order.
  type :: deck_card_t
    integer :: definition = 0              !! number in the table
    character(:), allocatable :: name      !! keyword
    type(string_t), allocatable :: keys(:)
    type(value_t), allocatable :: values(:)
    type(position_t) :: position
    logical :: failed = .false.            !! some value is wrong: do not use
  contains
    procedure :: at
    procedure :: number => card_number
    procedure :: whole => card_whole
    procedure :: word => card_word
    procedure :: vector => card_vector
    procedure :: flag => card_flag
    procedure :: has => card_has
  end type deck_card_t

contains

  !> Number of the value of a key that the table has for this card.
  pure integer function at(self, key) result(number)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    do number = 1, size(self%keys)
      if (self%keys(number)%text == key) return
    end do
    number = 0
  end function at

  !> The number of a real key, or a replacement where it has none.
  pure real(dp) function card_number(self, key, absent) result(value)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    real(dp), intent(in), optional :: absent  !! zero if not given
    value = 0.0_dp
    if (present(absent)) value = absent
    if (self%has(key)) value = self%values(self%at(key))%number
  end function card_number

  !> The number of a whole-number key, or a replacement where it has none.
  pure integer function card_whole(self, key, absent) result(value)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    integer, intent(in), optional :: absent  !! zero if not given
    value = 0
    if (present(absent)) value = absent
    if (self%has(key)) value = nint(self%values(self%at(key))%number)
  end function card_whole

  !> The text of a word, name, list or text; '' where it has none.
  pure function card_word(self, key) result(word)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    character(:), allocatable :: word
    word = ''
    if (self%has(key)) word = self%values(self%at(key))%text
  end function card_word

  !> The three components of a vector.
  pure function card_vector(self, key) result(vector)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    real(dp) :: vector(3)
    vector = self%values(self%at(key))%vector
  end function card_vector

  !> A yes or no.
  pure logical function card_flag(self, key) result(flag)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    flag = self%values(self%at(key))%flag
  end function card_flag

  !> Whether a key has a value, given or by default.
  pure logical function card_has(self, key) result(has)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    has = self%values(self%at(key))%present
  end function card_has

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
          call fail(card, errors, tokens(i)%position, 'no key before the equals sign', &
                    'write key=value')
          i = i + 1
        else if (pair .and. i + 2 > size(tokens)) then
          call fail(card, errors, tokens(i)%position, "no value after '"//tokens(i)%text//"='", &
                    'write key=value')
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

  !> Releases what the values hold.
  subroutine card_free(card)
    type(deck_card_t), intent(inout) :: card
    integer :: i
    if (.not. allocated(card%values)) return
    do i = 1, size(card%values)
      call expression_free(card%values(i)%expression)
    end do
  end subroutine card_free

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
      call fail(card, errors, key%position, "unknown key '"//key%text//"' of card "// &
                "'"//card%name//"'", &
                suggestion(key%text, definition%key_names(''), 'keys of '//card%name))
    else if (card%values(number)%given) then
      call fail(card, errors, key%position, "'"//key%text//"' is given twice", &
                'remove one of the two')
    else if (value%equals) then
      call fail(card, errors, value%position, "no value after '"//key%text//"='", 'write key=value')
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
      call fail(card, errors, token%position, "unexpected '"//token%text//"' in card "// &
                "'"//card%name//"'", &
                trim(misplaced_key(definition, token%text)))
      return
    end if
    slot = slot + 1
    if (card%values(number)%given) then
      call fail(card, errors, token%position, "'"//definition%keys(number)%name//"' is given "// &
                'twice', &
                'remove one of the two')
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
        call fail(card, errors, value%position, "'"//key%name//"' means nothing for "// &
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
    type(key_definition_t), intent(in) :: key
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: remedy
    remedy = 'add '//key%name//'=…: '//key%help
    if (key%slot > 0) remedy = 'e.g. '//definition%example
    call fail(card, errors, card%position, "card '"//card%name//"' needs '"//key%name//"'", remedy)
  end subroutine missing

  !> Turns the text of one value into what its kind asks for.
  subroutine evaluate_value(key, card, number, parameters, errors)
    type(key_definition_t), intent(in) :: key
    type(deck_card_t), intent(inout) :: card
    integer, intent(in) :: number
    type(parameters_t), intent(inout) :: parameters
    type(deck_errors_t), intent(inout) :: errors
    logical :: failed
    associate (value => card%values(number))
      if (.not. value%present) return
      failed = .false.
      select case (key%kind)
      case (kind_real)
        value%named = word_in_list(word_lower(value%text), key%choices) > 0
        if (value%named) then
          value%text = word_lower(value%text)
          return
        end if
        call parameters%number(value%text, value%position, value%number, failed, errors)
        if (.not. failed) call check_range(key, value, failed, errors)
      case (kind_integer)
        call parameters%number(value%text, value%position, value%number, failed, errors)
        if (.not. failed) call check_integer(key, value, failed, errors)
        if (.not. failed) call check_range(key, value, failed, errors)
      case (kind_logical)
        call read_logical(key, value, failed, errors)
      case (kind_word)
        value%text = word_lower(value%text)
        call check_choice(key, value%text, value%position, failed, errors)
      case (kind_name_word)
        call check_name(key, value, failed, errors)
      case (kind_vector)
        call read_vector(value, parameters, failed, errors)
      case (kind_expression)
        call parameters%make_expression(value%text, value%position, value%expression, failed, &
                                        errors)
      case (kind_interval)
        call read_interval(key, value, parameters, failed, errors)
      case (kind_list)
        call read_list(key, value, failed, errors)
      case default  ! a text is taken as it is
        failed = .false.
      end select
      if (failed) card%failed = .true.
    end associate
  end subroutine evaluate_value

  subroutine check_range(key, value, failed, errors)
    type(key_definition_t), intent(in) :: key
    type(value_t), intent(in) :: value
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    failed = .not. in_range(value%number, key%range)
    if (failed) then
      call errors%add(value%position, "'"//key%name//"' = "//real_text_plain(value%number)// &
                      ' is out of range', 'allowed: '//key%range//', '//key%help)
    end if
  end subroutine check_range

  !> Whether a number lies in an interval written `[a,b]`, `(a,b)`, …; '' is everything.
  function in_range(number, range) result(inside)
    real(dp), intent(in) :: number
    character(*), intent(in) :: range
    logical :: inside
    integer :: comma
    real(dp) :: bound
    inside = .true.
    if (range == '') return
    comma = index(range, ',')
    read (range(2:comma - 1), *) bound
    inside = number > bound .or. (range(1:1) == '[' .and. number >= bound)
    if (range(comma + 1:len(range) - 1) == 'inf') return
    read (range(comma + 1:len(range) - 1), *) bound
    inside = inside .and. (number < bound .or. (range(len(range):) == ']' .and. number <= bound))
  end function in_range

  subroutine check_integer(key, value, failed, errors)
    type(key_definition_t), intent(in) :: key
    type(value_t), intent(inout) :: value
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    real(dp), parameter :: tolerance = 1.0e-9_dp  ! of an expression like 3*(1/3)
    failed = abs(value%number) > real(huge(1), dp)
    if (failed) then
      call errors%add(value%position, "'"//key%name//"' = "//real_text_plain(value%number)// &
                      ' is too large', 'at most '//integer_text(huge(1)))
      return
    end if
    failed = abs(value%number - anint(value%number)) > tolerance*max(1.0_dp, abs(value%number))
    if (failed) then
      call errors%add(value%position, "'"//key%name//"' = "//real_text_plain(value%number)// &
                      ' is not a whole number', 'give a whole number')
    end if
    value%number = anint(value%number)
  end subroutine check_integer

  subroutine read_logical(key, value, failed, errors)
    type(key_definition_t), intent(in) :: key
    type(value_t), intent(inout) :: value
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    value%text = word_lower(value%text)
    value%flag = word_in_list(value%text, 'yes true on') > 0
    failed = .not. (value%flag .or. word_in_list(value%text, 'no false off') > 0)
    if (failed) call errors%add(value%position, "'"//value%text//"' is not an answer for '"// &
                                key%name//"'", 'answer yes or no')
  end subroutine read_logical

  subroutine check_choice(key, word, position, failed, errors)
    type(key_definition_t), intent(in) :: key
    character(*), intent(in) :: word
    type(position_t), intent(in) :: position
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    type(string_t), allocatable :: choices(:)
    integer :: i
    failed = word_in_list(word, key%choices) == 0
    if (.not. failed) return
    allocate (choices(word_count(key%choices)))
    do i = 1, size(choices)
      choices(i)%text = word_item(key%choices, i)
    end do
    call errors%add(position, "'"//word//"' is unknown for '"//key%name//"'", &
                    suggestion(word, choices, 'choices'))
  end subroutine check_choice

  subroutine check_name(key, value, failed, errors)
    type(key_definition_t), intent(in) :: key
    type(value_t), intent(inout) :: value
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    value%text = word_lower(value%text)
    failed = .not. word_is_identifier(value%text) .or. len(value%text) > name_size
    if (failed) call errors%add(value%position, "'"//value%text//"' cannot be a "//key%name, &
                                'a name is a letter, then letters, digits and underscores, 32 '// &
                                'at most')
  end subroutine check_name

  !> Reads (a,b,c), a,b,c, (a,b) or a; missing components are zero.
  subroutine read_vector(value, parameters, failed, errors)
    type(value_t), intent(inout) :: value
    type(parameters_t), intent(inout) :: parameters
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: list
    type(position_t) :: place
    integer :: first, last
    logical :: bad
    failed = .true.
    list = trim(value%text)
    first = 1
    if (encloses(list)) then
      list = list(:len(list) - 1)
      first = 2
    end if
    do while (first <= len(list) + 1)
      if (value%components == 3) then
        call errors%add(value%position, "'"//value%text//"' has more than three components", &
                        'write (a,b,c)')
        return
      end if
      last = outer_scan(list, first, ',') - 1
      place = value%position
      place%column = place%column + first - 1
      value%components = value%components + 1
      call parameters%number(list(first:last), place, value%vector(value%components), bad, errors)
      if (bad) return
      first = last + 2
    end do
    failed = .false.
  end subroutine read_vector

  !> Whether the first parenthesis is closed by the last letter.
  pure function encloses(text) result(yes)
    character(*), intent(in) :: text
    logical :: yes
    integer :: i, depth
    yes = .false.
    if (len(text) == 0) return
    depth = 0
    do i = 1, len(text)
      if (text(i:i) == '(') depth = depth + 1
      if (text(i:i) == ')') depth = depth - 1
      if (depth == 0) exit
    end do
    yes = i == len(text) .and. text(1:1) == '('
  end function encloses

  !> Column of a separator outside parentheses, or the one after the text.
  pure integer function outer_scan(text, first, separator) result(column)
    character(*), intent(in) :: text
    integer, intent(in) :: first
    character(1), intent(in) :: separator
    integer :: depth
    depth = 0
    do column = first, len(text)
      if (text(column:column) == '(') depth = depth + 1
      if (text(column:column) == ')') depth = depth - 1
      if (depth == 0 .and. text(column:column) == separator) return
    end do
  end function outer_scan

  !> Reads `open` or `lower:upper`.
  subroutine read_interval(key, value, parameters, failed, errors)
    type(key_definition_t), intent(in) :: key
    type(value_t), intent(inout) :: value
    type(parameters_t), intent(inout) :: parameters
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    type(position_t) :: place
    integer :: colon
    failed = .false.
    if (word_lower(value%text) == 'open') return
    colon = outer_scan(value%text, 1, ':')
    if (colon > len(value%text)) then
      failed = .true.
      call errors%add(value%position, "'"//value%text//"' is not an interval", &
                      'write '//key%name//'=lower:upper, lower:open, open:upper or open')
      return
    end if
    place = value%position
    call read_end(value%text(:colon - 1), place, 1)
    place%column = place%column + colon
    call read_end(value%text(colon + 1:), place, 2)
    if (failed .or. any(value%open)) return
    failed = value%vector(2) <= value%vector(1)
    if (failed) call errors%add(value%position, "the interval '"//value%text//"' is empty", &
                                'write the smaller number first')
  contains
    subroutine read_end(text, position, side)
      character(*), intent(in) :: text
      type(position_t), intent(in) :: position
      integer, intent(in) :: side
      logical :: bad
      value%open(side) = word_lower(text) == 'open'
      if (value%open(side)) return
      call parameters%number(text, position, value%vector(side), bad, errors)
      failed = failed .or. bad
    end subroutine read_end
  end subroutine read_interval

  !> Checks words separated by commas; they are left separated by blanks.
  subroutine read_list(key, value, failed, errors)
    type(key_definition_t), intent(in) :: key
    type(value_t), intent(inout) :: value
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    logical :: bad
    failed = .false.
    value%text = word_lower(value%text)
    do i = 1, len(value%text)
      if (scan(value%text(i:i), ',()') > 0) value%text(i:i) = ' '
    end do
    do i = 1, word_count(value%text)
      call check_choice(key, word_item(value%text, i), value%position, bad, errors)
      failed = failed .or. bad
    end do
  end subroutine read_list

  subroutine fail(card, errors, position, message, remedy)
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    type(position_t), intent(in) :: position
    character(*), intent(in) :: message, remedy
    card%failed = .true.
    call errors%add(position, message, remedy)
  end subroutine fail

end module sgmp_cards
