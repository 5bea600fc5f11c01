!> The text of a value to what its kind asks for: number, word, vector, interval, formula, list.
module sgmp_card_values
  use sgmp_absent_materials, only: absent_reason
  use sgmp_deck_card, only: deck_card_t, value_t
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_file_rows, only: file_rows_read
  use sgmp_keys, only: key_t, kind_expression, kind_integer, kind_interval, kind_list, &
                       kind_logical, kind_name_word, kind_points, kind_real, kind_rows, &
                       kind_vector, kind_word
  use sgmp_kinds, only: dp
  use sgmp_parameters, only: name_size, parameters_t
  use sgmp_spelling, only: suggestion, word_count, word_in_list, word_is_identifier, word_item, &
                           word_items, word_lower
  use sgmp_text, only: integer_text, real_text_plain
  implicit none
  private
  public :: evaluate_value

contains

  !> Turns the text of one value into what its kind asks for.
  subroutine evaluate_value(key, card, number, parameters, errors)
    type(key_t), intent(in) :: key
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
        call take_word(key, value, parameters, failed, errors)
        if (failed) card%failed = .true.
        if (value%named) return
        call parameters%number(value%text, value%position, value%number, failed, errors)
        if (.not. failed) call check_range(key, value, failed, errors)
      case (kind_integer)
        call take_word(key, value, parameters, failed, errors)
        if (failed) card%failed = .true.
        if (value%named) return
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
        call read_vector(value%text, value%position, 3, value%vector, value%components, &
                         parameters, failed, errors)
      case (kind_points)
        call read_points(value, parameters, failed, errors)
      case (kind_expression)
        call parameters%make_expression(value%text, value%position, value%expression, failed, &
                                        errors)
      case (kind_interval)
        call read_interval(key, value, parameters, failed, errors)
      case (kind_list)
        call read_list(key, value, failed, errors)
      case (kind_rows)
        call file_rows_read(card, number, errors, failed)
      case default  ! a text is taken as it is
        failed = .false.
      end select
      if (failed) card%failed = .true.
    end associate
  end subroutine evaluate_value

  !> Takes a word that a key accepts instead of a number; one that is no parameter either is an
  !! error.
  subroutine take_word(key, value, parameters, failed, errors)
    type(key_t), intent(in) :: key
    type(value_t), intent(inout) :: value
    type(parameters_t), intent(in) :: parameters
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: word
    failed = .false.
    value%named = .false.
    word = word_lower(value%text)
    if (key%choices == '' .or. .not. word_is_identifier(word) .or. word == 'pi') return
    if (parameters%find(word) > 0) return
    value%named = .true.
    value%text = word
    call check_choice(key, word, value%position, failed, errors)
  end subroutine take_word

  subroutine check_range(key, value, failed, errors)
    type(key_t), intent(in) :: key
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
    type(key_t), intent(in) :: key
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
    type(key_t), intent(in) :: key
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
    type(key_t), intent(in) :: key
    character(*), intent(in) :: word
    type(position_t), intent(in) :: position
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: remedy
    failed = word_in_list(word, key%choices) == 0
    if (.not. failed) return
    remedy = absent_reason(word)
    if (remedy == '') remedy = suggestion(word, word_items(key%choices), 'choices')
    call errors%add(position, "'"//word//"' is unknown for '"//key%name//"'", remedy)
  end subroutine check_choice

  subroutine check_name(key, value, failed, errors)
    type(key_t), intent(in) :: key
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
  subroutine read_vector(text, position, most, vector, components, parameters, failed, errors)
    character(*), intent(in) :: text
    type(position_t), intent(in) :: position
    integer, intent(in) :: most                  !! components
    real(dp), intent(inout) :: vector(:)
    integer, intent(out) :: components           !! that are given
    type(parameters_t), intent(inout) :: parameters
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: list
    type(position_t) :: place
    integer :: first, last
    logical :: bad
    failed = .true.
    components = 0
    list = trim(text)
    first = 1
    if (encloses(list)) then
      list = list(:len(list) - 1)
      first = 2
    end if
    do while (first <= len(list) + 1)
      if (components == most) then
        call errors%add(position, "'"//text//"' has more than "// &
                        trim(merge('three', 'two  ', most == 3))//' components', &
                        'write '//trim(merge('(a,b,c)', '(a,b)  ', most == 3)))
        return
      end if
      last = outer_scan(list, first, ',') - 1
      place = position
      place%column = place%column + first - 1
      components = components + 1
      call parameters%number(list(first:last), place, vector(components), bad, errors)
      if (bad) return
      first = last + 2
    end do
    failed = .false.
  end subroutine read_vector

  !> Reads (a,b),(c,d),... or the same in parentheses.
  subroutine read_points(value, parameters, failed, errors)
    type(value_t), intent(inout) :: value
    type(parameters_t), intent(inout) :: parameters
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    type(position_t) :: place
    real(dp) :: point(2)
    integer :: first, last, components
    allocate (value%points(2, 0))
    failed = .true.
    if (all_enclosed(value%text)) then
      value%text = value%text(2:len(value%text) - 1)
      value%position%column = value%position%column + 1
    end if
    first = 1
    do while (first <= len(value%text) + 1)
      last = outer_scan(value%text, first, ',') - 1
      place = value%position
      place%column = place%column + first - 1
      associate (text => value%text(first:last))
        if (.not. encloses(text)) then
          call errors%add(place, "'"//text//"' is not a point", 'write (a,b),(c,d),...')
          return
        end if
        call read_vector(text, place, 2, point, components, parameters, failed, errors)
        if (failed) return
        failed = components < 2
        if (failed) then
          call errors%add(place, "the point '"//text//"' has one component", 'write (a,b)')
          return
        end if
      end associate
      value%points = reshape([value%points, point], [2, size(value%points, 2) + 1])
      first = last + 2
    end do
  end subroutine read_points

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

  !> Whether parentheses stand around several points, ((a,b),(c,d),...).
  pure function all_enclosed(text) result(yes)
    character(*), intent(in) :: text
    logical :: yes
    integer :: first, last, n
    n = len(text) - 2
    yes = .false.
    if (n < 1) return
    if (.not. encloses(text)) return
    if (outer_scan(text(2:n + 1), 1, ',') > n) return
    first = 1
    do while (first <= n + 1)
      last = outer_scan(text(2:n + 1), first, ',') - 1
      if (.not. encloses(text(first + 1:last + 1))) return
      if (outer_scan(text(:last), first + 2, ',') >= last) return  ! one number in parentheses
      first = last + 2
    end do
    yes = .true.
  end function all_enclosed

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
    type(key_t), intent(in) :: key
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

  !> Checks words separated by commas, names where there are no choices; they are left separated by
  !! blanks.
  subroutine read_list(key, value, failed, errors)
    type(key_t), intent(in) :: key
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
    do i = 1, merge(0, word_count(value%text), key%choices == '')
      call check_choice(key, word_item(value%text, i), value%position, bad, errors)
      failed = failed .or. bad
    end do
  end subroutine read_list

end module sgmp_card_values
