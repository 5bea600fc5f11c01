!> The card `table`: the rows of a function that formulas call, from a file or from the card itself.
module sgmp_tables
  use sgmp_deck_card, only: card_fail, deck_card_t
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_file_rows, only: file_rows_check_sum, file_rows_path
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp
  use sgmp_number_rows, only: number_looks_so, number_row, number_row_is_empty, number_row_next
  use sgmp_parameters, only: parameters_t
  use sgmp_spelling, only: word_is_identifier, word_lower
  use sgmp_text, only: integer_text, real_text_plain
  implicit none
  private
  public :: table_define

  real(dp), parameter :: largest = 0.1_dp*huge(1.0_dp)
  character(*), parameter :: row_expected = 'a row is: t, value; t grows from row to row'

contains

  !> Makes a table of a card known to the formulas that follow. One from a file gets the checksum of
  !! its rows, which the complete deck says, so that neither it nor a restart goes on with others.
  subroutine table_define(card, parameters, errors)
    type(deck_card_t), intent(inout) :: card
    type(parameters_t), intent(inout) :: parameters
    type(deck_errors_t), intent(inout) :: errors
    real(dp), allocatable :: rows(:, :)
    if (.not. card%failed) call take_rows(card, rows, errors)
    ! Formulas know one that failed, too: they are not wrong.
    if (card%failed) then
      if (.not. (card%has('name') .and. word_is_identifier(card%word('name')))) return
      rows = reshape([0.0_dp, 0.0_dp], [2, 1])
    end if
    call parameters%define_table(card%word('name'), card%place('name'), rows, errors)
  end subroutine table_define

  !> The rows of a card, its own or those of its file.
  subroutine take_rows(card, rows, errors)
    type(deck_card_t), intent(inout) :: card
    real(dp), allocatable, intent(out) :: rows(:, :)
    type(deck_errors_t), intent(inout) :: errors
    if (card%has('file') .eqv. card%has('rows')) then
      call card_fail(card, errors, card%position, 'a table has either a file or rows', &
                     'e.g. file="pull.csv", or rows=(0,0),(1,5)')
    else if (card%has('file')) then
      call read_file(card, rows, errors)
      if (.not. card%failed) call file_rows_check_sum(card, rows, errors)
    else
      rows = card%points('rows')
      call check_rows(card, rows, errors)
      if (.not. card%failed .and. card%has('checksum')) call file_rows_check_sum(card, rows, errors)
    end if
  end subroutine take_rows

  !> Rows that the card itself has.
  subroutine check_rows(card, rows, errors)
    type(deck_card_t), intent(inout) :: card
    real(dp), intent(in) :: rows(:, :)
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    do i = 2, size(rows, 2)
      if (rows(1, i) > rows(1, i - 1)) cycle
      call card_fail(card, errors, card%place('rows'), 't = '//real_text_plain(rows(1, i))// &
                     ' does not follow t = '//real_text_plain(rows(1, i - 1)), row_expected)
      return
    end do
    if (size(rows, 2) < 2) call card_fail(card, errors, card%place('rows'), &
                                          'a table needs two rows', 'e.g. rows=(0,0),(1,5)')
  end subroutine check_rows

  !> Rows of the file that the card names; its first line may say what the columns are.
  subroutine read_file(card, rows, errors)
    type(deck_card_t), intent(inout) :: card
    real(dp), allocatable, intent(out) :: rows(:, :)
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: path, line, wrong
    type(position_t) :: place
    real(dp) :: row(2)
    integer :: unit, status, n, found
    logical :: begun
    path = file_rows_path(card, 'file')
    open (newunit=unit, file=path, status='old', action='read', iostat=status)
    if (status /= 0) then
      call card_fail(card, errors, card%place('file'), "the table '"//path//"' cannot be opened", &
                     'check its path')
      return
    end if
    allocate (rows(2, 0))
    n = 0
    begun = .false.
    place%file = path
    place%column = 1
    do while (number_row_next(unit, line))
      place%line = place%line + 1
      place%source = line
      if (number_row_is_empty(line)) cycle
      call number_row(line, row, found, wrong)
      if (wrong /= '' .and. .not. begun .and. is_heading(line)) then
        begun = .true.
        cycle
      end if
      begun = .true.
      if (wrong == '') wrong = objection(row, found, n, rows)
      if (wrong /= '') then
        call card_fail(card, errors, place, "table '"//card%word('name')//"': "//wrong, &
                       row_expected)
        exit
      end if
      call grow(rows, n, n + 1)
      n = n + 1
      rows(:, n) = row
    end do
    close (unit)
    rows = rows(:, :n)
    if (n < 2 .and. .not. card%failed) call card_fail(card, errors, card%place('file'), &
      "the table '"//path//"' has fewer than two rows", row_expected)
  end subroutine read_file

  !> Whether a line names its columns: it begins with a letter or a quote, and none of its words is
  !! a number or meant to be one.
  pure function is_heading(line) result(yes)
    character(*), intent(in) :: line
    logical :: yes
    character(*), parameter :: between = ' ,;'//achar(9)
    character(:), allocatable :: rest, word
    integer :: n
    rest = word_lower(line(verify(line, ' '):))
    yes = verify(rest(1:1), 'abcdefghijklmnopqrstuvwxyz"'//"'") == 0
    do while (yes .and. verify(rest, between) > 0)
      rest = rest(verify(rest, between):)//' '
      n = scan(rest, between) - 1
      word = rest(:n)
      rest = rest(n + 1:)
      yes = .not. (number_looks_so(word) .or. word == 'nan' .or. word == 'inf')
    end do
  end function is_heading

  !> What is wrong with a row behind n others, nothing if it is one.
  pure function objection(row, found, n, rows) result(text)
    real(dp), intent(in) :: row(2), rows(:, :)
    integer, intent(in) :: found, n
    character(:), allocatable :: text
    text = ''
    if (found /= 2) then
      text = integer_text(found)//' numbers in a row, not 2'
    else if (any(.not. abs(row) <= largest)) then
      text = 'a number is not finite'
    else if (n > 0) then
      if (.not. row(1) > rows(1, n)) text = 't = '//real_text_plain(row(1))// &
        ' does not follow t = '//real_text_plain(rows(1, n))
    end if
  end function objection

end module sgmp_tables
