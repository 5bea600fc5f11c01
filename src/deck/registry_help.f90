!> `sgmp help` and the reference of all cards, both written from the table.
module sgmp_registry_help
  use sgmp_combinations_help, only: combinations_write_markdown, combinations_write_text
  use sgmp_deck_table, only: deck_table
  use sgmp_errors, only: error_make, error_t, exit_usage
  use sgmp_expression, only: expression_functions, expression_variables
  use sgmp_keys, only: key_t, kind_integer, kind_list, kind_name, kind_real
  use sgmp_registry, only: card_definition_t, registry_t
  use sgmp_spelling, only: suggestion, word_lower
  use sgmp_text, only: text_with_backslashes
  use sgmp_text_fill, only: text_filled
  implicit none
  private
  public :: registry_write_help, registry_write_markdown

  character(*), parameter :: topic_combinations = 'combinations'  !! sgmp help combinations
  integer, parameter :: terminal = 100  !! letters of a line of help
  integer, parameter :: page = 120      !! of a line of the reference

contains

  !> Writes the list of cards, or one card where a keyword is given.
  subroutine registry_write_help(unit, keyword, error)
    integer, intent(in) :: unit           !! formatted unit
    character(*), intent(in) :: keyword   !! '' for the list
    type(error_t), allocatable, intent(out) :: error
    type(registry_t) :: registry
    integer :: i
    registry = deck_table()
    if (keyword == '') then
      write (unit, '(a)') 'Cards (sgmp help CARD shows its keys):', ''
      do i = 1, size(registry%cards)
        write (unit, '(2x, a, t18, a)') registry%cards(i)%name, &
          first_sentence(registry%cards(i)%help)
      end do
      write (unit, '(2x, a, t18, a)') 'parameter', &
        'parameter name = value: a number, or a word used as $name.'
      write (unit, '(2x, a, t18, a)') 'include', 'include "file": another file''s cards.'
      write (unit, '(a)') '', 'sgmp help --markdown writes the complete reference, '// &
        'sgmp --help lists the options.'
      return
    end if
    if (word_lower(keyword) == topic_combinations) then
      call combinations_write_text(unit, '')
      return
    end if
    i = registry%find_card(word_lower(keyword))
    if (i == 0) then
      call error_make(error, exit_usage, "there is no card '"//keyword//"'", &
                      suggestion(keyword, registry%card_names(), 'cards'))
      return
    end if
    call write_card(unit, registry%cards(i))
  end subroutine registry_write_help

  !> What stands before the help of a key: its name, on a line of its own where it is long.
  pure function beside(name) result(text)
    character(*), intent(in) :: name
    character(:), allocatable :: text
    if (len(name) > 20) then
      text = '  '//name//new_line('a')//repeat(' ', 23)
    else
      text = '  '//name//repeat(' ', 21 - len(name))
    end if
  end function beside

  subroutine write_card(unit, card)
    integer, intent(in) :: unit
    type(card_definition_t), intent(in) :: card
    integer :: i
    write (unit, '(a)') text_filled(card%name//': '//card%help, terminal, '', ''), ''
    write (unit, '(a)') '  e.g. '//card%example, ''
    do i = 1, size(card%keys)
      associate (key => card%keys(i))
        write (unit, '(a)') text_filled(key%help, terminal, beside(key%name), repeat(' ', 23)), &
          text_filled(facts(key), terminal, repeat(' ', 25), repeat(' ', 25))
      end associate
    end do
    if (card%once) write (unit, '(/, a)') 'At most one such card.'
    if (card%free) write (unit, '(/, a)') 'May be changed when a run is restarted.'
    call combinations_write_text(unit, card%name)
  end subroutine write_card

  !> Kind, unit, default and limits of a key in one line.
  function facts(key) result(text)
    type(key_t), intent(in) :: key
    character(:), allocatable :: text
    text = value_cell(key)
    if (key%unit /= '') text = text//', '//key%unit
    if (key%range /= '') text = text//' in '//key%range
    if (key%default /= '') text = text//'; default '//key%default
    if (key%required) text = text//'; required'
    if (key%when /= '') text = text//'; only for '//key%when
    if (key%slot > 0) text = text//'; may be written without the key'
    if (key%free) text = text//'; may be changed on restart'
    if (key%source /= '') text = text//' ('//key%source//')'
  end function facts

  !> Writes the reference of all cards in Markdown.
  subroutine registry_write_markdown(unit)
    integer, intent(in) :: unit  !! formatted unit
    type(registry_t) :: registry
    integer :: i
    registry = deck_table()
    call write_preface(unit)
    call write_contents(unit, registry)
    call combinations_write_markdown(unit)
    do i = 1, size(registry%cards)
      call write_section(unit, registry%cards(i))
    end do
  end subroutine registry_write_markdown

  subroutine write_preface(unit)
    integer, intent(in) :: unit
    write (unit, '(a)') '# Deck reference', '', &
      '<!-- written by `sgmp help --markdown`; do not edit -->', '', &
      'A deck is a text file of cards, one per line: `keyword word … key=value key=value …`.', '', &
      '* Upper and lower case are the same. `!` and `#` start a comment. `&` at the end of a '// &
      'line', &
      '  continues it. Text with blanks goes into quotes.', &
      '* `include "file"` inserts another file; its path is relative to the file that includes '// &
      'it,', &
      '  else to the folders of SGMP_PATH (separated by colons), else to the library of the '// &
      'program:', &
      '  `include "materials/copper.inp"` works from any folder. `sgmp materials` lists those.', &
      '* `parameter name = value` defines a number, or a word. `--set name=value` replaces it.', &
      '* A number may be a formula of numbers and parameters: `cell=h/2`, or in quotes with '// &
      'blanks.', &
      '  `^` and `**` are powers.', &
      "* `$name` or `${name}` puts a parameter's text in anywhere: `method $method`. A "// &
      'formula that', &
      '  contains x, y, z or t is kept as text when its value is in quotes, for use as `$name`.', &
      '* A vector is `(a,b,c)`, `a,b,c`, or shorter: missing components are 0. One number '// &
      'alone, if it is', &
      '  not 0, is for scenes in 1D.', &
      '* Units are those of the deck: length, mass, time and what follows from them. '// &
      'Temperatures are in kelvin.', &
      '* Kan, Liang and Zhang 2021 is the paper that describes the method: '// &
      '[README](../README.md#citation).', &
      '* The value *formula* is a formula that is evaluated while the program runs; the key '// &
      'says of what it is', &
      '  a function. It may use the variables and constants', &
      '  `'//expression_variables//'` and the functions', &
      text_filled('`'//expression_functions//'`.', page, '  ', '  ')
  end subroutine write_preface

  !> The cards with links to their sections, group by group.
  subroutine write_contents(unit, registry)
    integer, intent(in) :: unit
    type(registry_t), intent(in) :: registry
    character(:), allocatable :: group, links
    integer :: i
    write (unit, '(a)') '', 'All cards:', ''
    i = 1
    do while (i <= size(registry%cards))
      group = registry%cards(i)%group
      links = ''
      do while (i <= size(registry%cards))
        if (registry%cards(i)%group /= group) exit
        associate (name => registry%cards(i)%name)
          links = links//' ['//name//'](#'//name//')'
        end associate
        i = i + 1
      end do
      write (unit, '(a)') text_filled(group//':'//links, page, '* ', '  ')
    end do
    write (unit, '(a)') ''
  end subroutine write_contents

  subroutine write_section(unit, card)
    integer, intent(in) :: unit
    type(card_definition_t), intent(in) :: card
    integer :: i
    write (unit, '(a)') '## '//card%name, '', text_filled(card%help, page, '', '')
    if (card%once) write (unit, '(a)') 'At most one such card.'
    if (card%free) write (unit, '(a)') 'May be changed when a run is restarted.'
    write (unit, '(a)') '', '    '//card%example, '', &
      '| key | value | unit | default | range | for | meaning |', &
      '|---|---|---|---|---|---|---|'
    do i = 1, size(card%keys)
      associate (key => card%keys(i))
        write (unit, '(a)') '| `'//key%name//'`'//slot_mark(key)//' | '//value_cell(key)//' | '// &
          key%unit//' | '//default_cell(key)//' | '//range_cell(key)//' | '//key%when//' | '// &
          text_with_backslashes(key%help, '|')//source_cell(key)//free_cell(key)//' |'
      end associate
    end do
    write (unit, '(a)') ''
  end subroutine write_section

  function slot_mark(key) result(text)
    type(key_t), intent(in) :: key
    character(:), allocatable :: text
    text = ''
    if (key%slot > 0) text = ' (word '//achar(iachar('0') + key%slot)//')'
  end function slot_mark

  !> What a value may be: of the kind of the key, a word, or either.
  function value_cell(key) result(text)
    type(key_t), intent(in) :: key
    character(:), allocatable :: text
    text = kind_name(key%kind)
    if (key%choices == '') return
    select case (key%kind)
    case (kind_real, kind_integer)
      text = text//' or '//key%choices
    case (kind_list)
      text = text//': '//key%choices
    case default
      text = 'one of '//key%choices
      if (index(key%choices, ' ') == 0) text = key%choices
    end select
  end function value_cell

  function default_cell(key) result(text)
    type(key_t), intent(in) :: key
    character(:), allocatable :: text
    text = key%default
    if (key%required) text = '*required*'
  end function default_cell

  function range_cell(key) result(text)
    type(key_t), intent(in) :: key
    character(:), allocatable :: text
    text = ''
    if (key%range /= '') text = '`'//key%range//'`'
  end function range_cell

  function source_cell(key) result(text)
    type(key_t), intent(in) :: key
    character(:), allocatable :: text
    text = ''
    if (key%source /= '') text = ' ('//key%source//')'
  end function source_cell

  function free_cell(key) result(text)
    type(key_t), intent(in) :: key
    character(:), allocatable :: text
    text = ''
    if (key%free) text = '; may be changed on restart'
  end function free_cell

  !> Up to the first full stop that ends a sentence, or the first colon or semicolon.
  function first_sentence(help) result(text)
    character(*), intent(in) :: help
    character(:), allocatable :: text
    integer :: last
    last = index(help//' ', '. ')
    if (last == 0) last = len(help)
    text = help(:min(last, len(help)))
  end function first_sentence

end module sgmp_registry_help
