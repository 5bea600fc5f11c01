!> Values that are files of numbers: rows of the same length, with the place of each number, and a
!! checksum that the complete deck says.
module sgmp_file_rows
  use sgmp_checksum, only: checksum_particles, checksum_text
  use sgmp_deck_card, only: card_fail, deck_card_t
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_number_rows, only: number_read, number_row_is_empty, number_row_next, number_separators
  use sgmp_spelling, only: word_lower
  use sgmp_text, only: integer_text
  use sgmp_units, only: units_in_si
  implicit none
  private
  public :: file_rows_check_sum, file_rows_convert, file_rows_path, file_rows_place, file_rows_read

  real(dp), parameter :: largest = 0.1_dp*huge(1.0_dp)
  character(*), parameter :: row_expected = 'rows of numbers, all of the same length; # and ! '// &
                                            'begin comments'

contains

  !> Path of a file that a card names: a relative one starts at the deck.
  pure function file_rows_path(card, key) result(path)
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key
    character(:), allocatable :: path
    path = card%word(key)
    if (index(path, '/') /= 1) path = card%position%file(:index(card%position%file, '/', &
                                                                back=.true.))//path
  end function file_rows_path

  !> Reads the file that value `number` of a card names. Where the card has a key `checksum` it says
  !! that of the rows, or refuses those that have another one.
  subroutine file_rows_read(card, number, errors, failed)
    type(deck_card_t), intent(inout) :: card
    integer, intent(in) :: number
    type(deck_errors_t), intent(inout) :: errors
    logical, intent(out) :: failed
    character(:), allocatable :: path
    integer :: unit, status
    logical :: before
    before = card%failed
    card%failed = .false.
    path = file_rows_path(card, card%keys(number)%text)
    open (newunit=unit, file=path, status='old', action='read', iostat=status)
    if (status /= 0) then
      call card_fail(card, errors, card%values(number)%position, "the file '"//path// &
                     "' cannot be opened", 'check its path')
      failed = .true.
      return
    end if
    call read_rows(card, number, path, unit, errors)
    close (unit)
    if (.not. card%failed .and. card%at('checksum') > 0) then
      call file_rows_check_sum(card, card%values(number)%rows, errors)
    end if
    failed = card%failed
    card%failed = before .or. failed
  end subroutine file_rows_read

  !> Reads the rows of an open file.
  subroutine read_rows(card, number, path, unit, errors)
    type(deck_card_t), intent(inout) :: card
    integer, intent(in) :: number, unit
    character(*), intent(in) :: path
    type(deck_errors_t), intent(inout) :: errors
    type(position_t) :: place
    character(:), allocatable :: line, wrong
    real(dp), allocatable :: row(:)
    integer, allocatable :: columns(:)
    integer :: n
    place%file = path
    n = 0
    associate (value => card%values(number))
      do while (number_row_next(unit, line))
        place%line = place%line + 1
        place%source = line
        if (number_row_is_empty(line)) cycle
        call read_line(line, row, columns, place%column, wrong)
        if (n == 0 .and. wrong == '') then
          allocate (value%rows(size(row), 64), value%columns(size(row), 64), value%lines(64))
        else if (wrong == '') then
          if (size(row) /= size(value%rows, 1)) wrong = integer_text(size(row))// &
            ' numbers in a row, not '//integer_text(size(value%rows, 1))
        end if
        if (wrong /= '') then
          call card_fail(card, errors, place, wrong, row_expected)
          return
        end if
        if (n == size(value%lines)) call widen(value%rows, value%columns, value%lines)
        n = n + 1
        value%rows(:, n) = row
        value%columns(:, n) = columns
        value%lines(n) = place%line
      end do
      if (n > 0) then
        value%rows = value%rows(:, :n)
      else
        call card_fail(card, errors, value%position, "the file '"//path//"' has no numbers", &
                       row_expected)
      end if
    end associate
  end subroutine read_rows

  !> Makes room for as many rows again.
  pure subroutine widen(rows, columns, lines)
    real(dp), allocatable, intent(inout) :: rows(:, :)
    integer, allocatable, intent(inout) :: columns(:, :), lines(:)
    real(dp), allocatable :: more(:, :)
    integer, allocatable :: places(:, :)
    integer :: n
    n = size(lines)
    allocate (more(size(rows, 1), 2*n), places(size(rows, 1), 2*n))
    more(:, :n) = rows
    places(:, :n) = columns
    lines = [lines, lines]
    call move_alloc(more, rows)
    call move_alloc(places, columns)
  end subroutine widen

  !> Numbers of a line and where each begins.
  subroutine read_line(line, row, columns, column, wrong)
    character(*), intent(in) :: line
    real(dp), allocatable, intent(out) :: row(:)
    integer, allocatable, intent(out) :: columns(:)
    integer, intent(out) :: column              !! of what is wrong
    character(:), allocatable, intent(out) :: wrong  !! nothing where all are numbers
    real(dp) :: value
    integer :: first, last
    allocate (row(0), columns(0))
    wrong = ''
    column = 1
    last = 0
    do
      first = verify(line(last + 1:), number_separators) + last
      if (first == last) return
      column = first
      last = scan(line(first:)//' ', number_separators) + first - 2
      call number_read(line(first:last), value, wrong)
      if (wrong == '' .and. .not. abs(value) <= largest) wrong = "'"//line(first:last)// &
        "' is not finite"
      if (wrong /= '') return
      row = [row, value]
      columns = [columns, first]
    end do
  end subroutine read_line

  !> Where a number of such a file stands, with its line.
  function file_rows_place(card, key, column, row) result(place)
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key
    integer, intent(in) :: column, row
    type(position_t) :: place
    integer :: unit, status, i
    associate (value => card%values(card%at(key)))
      place%file = file_rows_path(card, key)
      place%line = value%lines(row)
      place%column = value%columns(column, row)
      place%source = ''
    end associate
    open (newunit=unit, file=place%file, status='old', action='read', iostat=status)
    if (status /= 0) return
    do i = 1, place%line
      if (.not. number_row_next(unit, place%source)) exit
    end do
    close (unit)
  end function file_rows_place

  !> Converts the columns that have units.
  subroutine file_rows_convert(units, from, to, rows)
    character(*), intent(in) :: units            !! of the first columns, separated by commas
    character(*), intent(in) :: from(3), to(3)   !! length, mass, time
    real(dp), intent(inout) :: rows(:, :)
    real(dp) :: old, new
    character(:), allocatable :: rest
    integer :: column, comma
    logical :: known
    rest = units//','
    do column = 1, size(rows, 1)
      comma = index(rest, ',')
      if (comma == 0) return
      call units_in_si(trim(adjustl(rest(:comma - 1))), from, old, known)
      call units_in_si(trim(adjustl(rest(:comma - 1))), to, new, known)
      if (known) rows(column, :) = rows(column, :)*(old/new)
      rest = rest(comma + 1:)
    end do
  end subroutine file_rows_convert

  !> Says the checksum of the rows, or refuses rows that have another one than the card says.
  subroutine file_rows_check_sum(card, rows, errors)
    type(deck_card_t), intent(inout) :: card
    real(dp), intent(in) :: rows(:, :)
    type(deck_errors_t), intent(inout) :: errors
    integer(i8) :: total
    integer :: i
    total = checksum_particles([(int(i, i4), i=1, size(rows, 2))], rows)
    associate (said => card%values(card%at('checksum')))
      if (said%given .and. word_lower(said%text) /= word_lower(checksum_text(total))) then
        call card_fail(card, errors, said%position, 'the rows of the table have the checksum '// &
                       checksum_text(total), &
                       'give the file that the deck was made with, or remove checksum')
        return
      end if
      said%present = .true.
      said%text = checksum_text(total)
    end associate
  end subroutine file_rows_check_sum

end module sgmp_file_rows
