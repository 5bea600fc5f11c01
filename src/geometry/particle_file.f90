!> Text files with a particle per line: `x y z volume [velocity_x velocity_y velocity_z]`; # and !
!! begin comments.
module sgmp_particle_file
  use sgmp_errors, only: error_make, error_t, exit_deck, exit_io
  use sgmp_kinds, only: dp
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: particle_file_read

  integer, parameter :: position_columns = 4  !! and volume
  integer, parameter :: most = 7              !! columns
  real(dp), parameter :: largest = 0.1_dp*huge(1.0_dp)

contains

  !> Reads all particles; the first line decides whether there are velocities.
  subroutine particle_file_read(file, place, positions, volumes, error, velocities)
    character(*), intent(in) :: file, place      !! place: of the card that names it
    real(dp), allocatable, intent(out) :: positions(:, :), volumes(:)  !! (3, n), (n)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable, intent(out), optional :: velocities(:, :)
      !! (3, n), allocated if the file has them
    real(dp), allocatable :: rows(:, :)
    integer :: unit, status, columns
    open (newunit=unit, file=file, status='old', action='read', iostat=status)
    if (status /= 0) then
      call error_make(error, exit_io, "the particle file '"//file//"' cannot be opened", &
                      'check its path', place)
      return
    end if
    call read_rows(unit, file, rows, columns, error)
    close (unit)
    if (allocated(error)) return
    if (size(rows, 2) == 0) then
      call error_make(error, exit_deck, "the particle file '"//file//"' has no particles", &
                      'a line per particle: x y z volume', place)
      return
    end if
    positions = rows(1:3, :)
    volumes = rows(4, :)
    if (present(velocities) .and. columns == most) velocities = rows(5:7, :)
  end subroutine particle_file_read

  !> All rows of a particle file; the first decides whether there are 4 or 7 columns.
  subroutine read_rows(unit, file, rows, columns, error)
    integer, intent(in) :: unit
    character(*), intent(in) :: file
    real(dp), allocatable, intent(out) :: rows(:, :)  !! (most, n)
    integer, intent(out) :: columns
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: longer(:, :)
    character(1000) :: line
    real(dp) :: row(most)
    integer :: n, status, line_number
    allocate (rows(most, 1000))
    columns = 0
    n = 0
    line_number = 0
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      line_number = line_number + 1
      if (scan(line, '#!') > 0) line = line(:scan(line, '#!') - 1)
      if (line == '') cycle
      row = 0.0_dp
      if (columns == 0) columns = merge(most, position_columns, readable(line, most))
      read (line, *, iostat=status) row(:columns)
      if (status == 0 .and. any(.not. abs(row) <= largest)) status = 1
      if (status /= 0 .or. row(4) <= 0.0_dp) then
        call error_make(error, exit_deck, 'not a particle: '//trim(line), &
                        'expected: x y z volume [velocity_x velocity_y velocity_z], volume > 0', &
                        file//':'//integer_text(line_number)//':1')
        return
      end if
      if (n == size(rows, 2)) then
        allocate (longer(most, 2*n))
        longer(:, :n) = rows
        call move_alloc(longer, rows)
      end if
      n = n + 1
      rows(:, n) = row
    end do
    longer = rows(:, :n)
    call move_alloc(longer, rows)
  end subroutine read_rows

  !> Whether a line holds this many numbers.
  function readable(line, columns) result(yes)
    character(*), intent(in) :: line
    integer, intent(in) :: columns
    logical :: yes
    real(dp) :: row(columns)
    integer :: status
    read (line, *, iostat=status) row
    yes = status == 0
  end function readable

end module sgmp_particle_file
