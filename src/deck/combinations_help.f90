!> What goes with what, for readers: lines of `sgmp help`, a section of the deck reference, JSON.
module sgmp_combinations_help
  use sgmp_combinations, only: combinations_features, combinations_refusals, feature_label, &
                               feature_of_card, feature_t, refusal_t
  use sgmp_spelling, only: string_t, word_items
  use sgmp_text_fill, only: text_filled
  implicit none
  private
  public :: combinations_write_json, combinations_write_markdown, combinations_write_text

contains

  !> Writes what excludes each other, with what a card asks for or in all; nothing where there is
  !! nothing.
  subroutine combinations_write_text(unit, card)
    integer, intent(in) :: unit        !! formatted unit
    character(*), intent(in) :: card   !! '': all
    type(refusal_t), allocatable :: refusals(:)
    logical :: some
    integer :: r
    refusals = combinations_refusals()
    some = .false.
    do r = 1, size(refusals)
      if (.not. concerns(refusals(r), card)) cycle
      if (.not. some) write (unit, '(/, a)') 'What does not go together:'
      some = .true.
      write (unit, '(a)') text_filled(feature_label(trim(refusals(r)%feature))//' not with '// &
                          labels(refusals(r)%with, ' or ', '')//except(refusals(r)), 100, '  ', &
                          '    '), text_filled(trim(refusals(r)%reason), 100, '      ', '      ')
    end do
  end subroutine combinations_write_text

  !> Whether a refusal names a feature of a card ('': any).
  function concerns(refusal, card) result(yes)
    type(refusal_t), intent(in) :: refusal
    character(*), intent(in) :: card
    logical :: yes
    type(string_t), allocatable :: others(:)
    integer :: i
    yes = card == ''
    if (yes) return
    others = word_items(trim(refusal%with))
    yes = feature_of_card(trim(refusal%feature), card)
    do i = 1, size(others)
      yes = yes .or. feature_of_card(others(i)%text, card)
    end do
  end function concerns

  !> Writes the section of the deck reference.
  subroutine combinations_write_markdown(unit)
    integer, intent(in) :: unit        !! formatted unit
    type(refusal_t), allocatable :: refusals(:)
    integer :: r
    refusals = combinations_refusals()
    write (unit, '(a)') '### What goes with what', '', &
      'These exclude each other; whatever is not named here goes together. `sgmp help '// &
      'combinations` prints', 'the list, `sgmp help --json` writes it for programs.', '', &
      '| this | not with | because | instead |', '|---|---|---|---|'
    do r = 1, size(refusals)
      associate (refusal => refusals(r))
        write (unit, '(a)') '| `'//feature_label(trim(refusal%feature))//'` | '// &
          labels(refusal%with, ', ', '`')//except(refusal)//' | '//trim(refusal%reason)// &
          ' | '//trim(refusal%remedy)//' |'
      end associate
    end do
    write (unit, '(a)') ''
  end subroutine combinations_write_markdown

  !> Writes features and refusals as one JSON object.
  subroutine combinations_write_json(unit)
    integer, intent(in) :: unit        !! formatted unit
    type(feature_t), allocatable :: features(:)
    type(refusal_t), allocatable :: refusals(:)
    integer :: i
    features = combinations_features()
    refusals = combinations_refusals()
    write (unit, '(a)') '{"features": ['
    do i = 1, size(features)
      associate (feature => features(i))
        write (unit, '(a)') '  {"name": "'//trim(feature%name)//'", "label": "'// &
          feature_label(trim(feature%name))//'", "cards": '//list(feature%cards)//', "key": "'// &
          trim(feature%key)//'"}'//comma(i < size(features))
      end associate
    end do
    write (unit, '(a)') '], "refusals": ['
    do i = 1, size(refusals)
      associate (refusal => refusals(i))
        write (unit, '(a)') '  {"feature": "'//trim(refusal%feature)//'", "with": '// &
          list(refusal%with)//', "unless": "'//trim(refusal%unless)//'", "reason": "'// &
          trim(refusal%reason)//'", "remedy": "'//trim(refusal%remedy)//'"}'// &
          comma(i < size(refusals))
      end associate
    end do
    write (unit, '(a)') ']}'
  end subroutine combinations_write_json

  !> Labels of a list of features.
  function labels(names, between, quote) result(text)
    character(*), intent(in) :: names, between, quote
    character(:), allocatable :: text
    type(string_t), allocatable :: words(:)
    integer :: i
    words = word_items(trim(names))
    text = ''
    do i = 1, size(words)
      if (i > 1) text = text//between
      text = text//quote//feature_label(words(i)%text)//quote
    end do
  end function labels

  !> Where a refusal does not hold.
  function except(refusal) result(text)
    type(refusal_t), intent(in) :: refusal
    character(:), allocatable :: text
    text = ''
    if (refusal%unless /= '') text = ' (but in '//feature_label(trim(refusal%unless))//')'
  end function except

  !> A list of names in JSON.
  function list(names) result(text)
    character(*), intent(in) :: names
    character(:), allocatable :: text
    type(string_t), allocatable :: words(:)
    integer :: i
    words = word_items(trim(names))
    text = '['
    do i = 1, size(words)
      text = text//'"'//words(i)%text//'"'//comma(i < size(words))
    end do
    text = text//']'
  end function list

  pure function comma(more) result(text)
    logical, intent(in) :: more
    character(:), allocatable :: text
    text = ''
    if (more) text = ','
  end function comma

end module sgmp_combinations_help
