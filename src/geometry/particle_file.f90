!> Text files with a particle per line: `x y z volume [velocity_x velocity_y velocity_z]`; # and !
!! begin comments.
module sgmp_particle_file
  use, intrinsic :: ieee_exceptions, only: ieee_get_halting_mode, ieee_overflow, ieee_set_flag, &
                                           ieee_set_halting_mode
  use sgmp_errors, only: error_make, error_t, exit_deck, exit_io
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: particle_file_read

  integer, parameter :: with_velocity = 7, without = 4  !! numbers in a line
  real(dp), parameter :: largest = 0.1_dp*huge(1.0_dp)
  character(*), parameter :: separators = ' ,'//achar(9)//achar(13)
  character(*), parameter :: expected = &
    'expected: x y z volume [velocity_x velocity_y velocity_z], volume > 0'

contains

  !> Reads all particles; the first line decides whether there are velocities.
  subroutine particle_file_read(file, place, ndim, positions, volumes, error, velocities)
    character(*), intent(in) :: file, place      !! place: of the card that names it
    integer, intent(in) :: ndim                  !! coordinates beyond must be zero
    real(dp), allocatable, intent(out) :: positions(:, :), volumes(:)  !! (3, n), (n)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable, intent(out), optional :: velocities(:, :)
      !! (3, n), allocated if the file has them
    real(dp), allocatable :: rows(:, :)
    integer :: unit, status
    open (newunit=unit, file=file, status='old', action='read', iostat=status)
    if (status /= 0) then
      call error_make(error, exit_io, "the particle file '"//file//"' cannot be opened", &
                      'check its path', place)
      return
    end if
    call read_rows(unit, file, ndim, rows, error)
    close (unit)
    if (allocated(error)) return
    if (size(rows, 2) == 0) then
      call error_make(error, exit_deck, "the particle file '"//file//"' has no particles", &
                      'a line per particle: x y z volume', place)
      return
    end if
    positions = rows(1:3, :)
    volumes = rows(4, :)
    if (present(velocities) .and. size(rows, 1) == with_velocity) velocities = rows(5:7, :)
  end subroutine particle_file_read

  !> All rows of a particle file, each with as many numbers as the first.
  subroutine read_rows(unit, file, ndim, rows, error)
    integer, intent(in) :: unit
    character(*), intent(in) :: file
    integer, intent(in) :: ndim
    real(dp), allocatable, intent(out) :: rows(:, :)  !! (4 or 7, n)
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: line, wrong
    real(dp) :: row(with_velocity)
    integer :: n, found, line_number
    allocate (rows(without, 0))
    n = 0
    line_number = 0
    do while (next_line(unit, line))
      line_number = line_number + 1
      if (verify(line, separators) == 0) cycle
      call read_numbers(line, row, found, wrong)
      if (n == 0 .and. found == with_velocity) rows = reshape(rows, [with_velocity, 0])
      if (wrong == '') wrong = objection(row, found, size(rows, 1), ndim)
      if (wrong /= '') then
        call error_make(error, exit_deck, 'not a particle ('//wrong//'): '//trim(line), expected, &
                        file//':'//integer_text(line_number)//':1')
        return
      end if
      call grow(rows, n, n + 1)
      n = n + 1
      rows(:, n) = row(:found)
    end do
    rows = rows(:, :n)
  end subroutine read_rows

  !> What is wrong with the numbers of a line, nothing if it is a particle.
  pure function objection(row, found, columns, ndim) result(text)
    real(dp), intent(in) :: row(:)
    integer, intent(in) :: found, columns  !! numbers in this line and in the first
    integer, intent(in) :: ndim
    character(:), allocatable :: text
    text = ''
    if (found /= columns) then
      text = integer_text(found)//' numbers, not '//integer_text(columns)
    else if (any(.not. abs(row(:found)) <= largest)) then
      text = 'a number is not finite'
    else if (row(4) <= 0.0_dp) then
      text = 'the volume is not positive'
    else if (any(abs(row(ndim + 1:3)) > 0.0_dp)) then
      text = 'a coordinate beyond the dimension is not 0'
    end if
  end function objection

  !> The next line without its comment; false at the end of the file.
  function next_line(unit, line) result(there)
    integer, intent(in) :: unit
    character(:), allocatable, intent(inout) :: line
    logical :: there
    character(256) :: part
    integer :: length, status
    line = ''
    do
      read (unit, '(a)', advance='no', size=length, iostat=status) part
      if (status == 0 .or. is_iostat_eor(status)) line = line//part(:length)
      if (status /= 0) exit
    end do
    there = is_iostat_eor(status) .or. len(line) > 0
    if (scan(line, '#!') > 0) line = line(:scan(line, '#!') - 1)
  end function next_line

  !> The numbers of a line: how many there are, and the first of them.
  subroutine read_numbers(line, row, found, wrong)
    character(*), intent(in) :: line
    real(dp), intent(out) :: row(:)
    integer, intent(out) :: found
    character(:), allocatable, intent(out) :: wrong  !! what is no number
    real(dp) :: value
    logical :: unreadable
    integer :: first, last
    row = 0.0_dp
    found = 0
    wrong = ''
    first = 1
    do
      last = verify(line(first:), separators)
      if (last == 0) return
      first = first + last - 1
      last = scan(line(first:)//' ', separators) + first - 2
      unreadable = verify(line(first:last), '0123456789+-.eEdD') > 0
      if (.not. unreadable) call read_number(line(first:last), value, unreadable)
      if (unreadable) then
        wrong = "'"//line(first:last)//"' is not a number"
        return
      end if
      found = found + 1
      if (found <= size(row)) row(found) = value
      first = last + 1
      if (first > len(line)) return
    end do
  end subroutine read_numbers

  !> Reads a number. One beyond the largest becomes infinite, which is an error of the file and not
  !! of the program: it must not trap.
  subroutine read_number(word, value, wrong)
    character(*), intent(in) :: word
    real(dp), intent(out) :: value
    logical, intent(out) :: wrong
    logical :: traps
    integer :: status
    call ieee_get_halting_mode(ieee_overflow, traps)
    if (traps) call ieee_set_halting_mode(ieee_overflow, .false.)
    read (word, *, iostat=status) value
    wrong = status /= 0
    if (.not. traps) return
    call ieee_set_flag(ieee_overflow, .false.)
    call ieee_set_halting_mode(ieee_overflow, .true.)
  end subroutine read_number

end module sgmp_particle_file
