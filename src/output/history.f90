!> Tables that grow with the run: history.csv, bodies.csv, gauges.csv.
!!
!! First line the column names, then one row per sample in full precision; units are in summary.json
!! and run.log, so that every reader of CSV files takes these. Rows reach the operating system at
!! the latest with the first row written a second later, so that a plot of a running simulation is
!! current and short steps do not wait for the disk.
module sgmp_history
  use sgmp_errors, only: error_make, error_t, exit_io
  use sgmp_file_tools, only: file_exists, file_lines, io_error, line_t, output_file_t
  use sgmp_kinds, only: dp, i8
  use sgmp_posix, only: file_sync
  use sgmp_text, only: integer_text, row_text
  implicit none
  private
  public :: history_t, history_columns, swirl_columns
  public :: bodies_columns, bodies_integers, gauges_columns, &
    gauges_integers, contact_columns, contact_integers, motion_columns, motion_integers, &
    rigid_columns, rigid_integers, column_length

  integer, parameter :: column_length = 32

  !> Columns of history.csv after `step`.
  character(column_length), parameter :: history_columns(*) = [character(column_length) :: &
    'time', 'dt', 'kinetic_energy', 'internal_energy', 'total_energy', 'external_work', &
    'contact_dissipation', 'viscous_dissipation', 'interpolation_error', 'energy_remainder', &
    'momentum_x', 'momentum_y', 'momentum_z']
  !> Behind them those of the terms of the energy balance (sgmp_energy_terms), and with swirl.
  character(column_length), parameter :: swirl_columns(*) = [character(column_length) :: &
    'angular_momentum']
  !> Columns of bodies.csv after `step`: sums and the centroid of each body.
  character(column_length), parameter :: bodies_columns(*) = [character(column_length) :: &
    'time', 'body', 'mass', 'x', 'y', 'z', 'velocity_x', 'velocity_y', 'velocity_z', &
    'kinetic_energy', 'internal_energy', 'particles']
  character(column_length), parameter :: bodies_integers(*) = [character(column_length) :: &
    'body', 'particles']
  !> First columns of gauges.csv after `step`; the fields asked for follow.
  character(column_length), parameter :: gauges_columns(*) = [character(column_length) :: &
    'time', 'gauge', 'particle', 'x', 'y', 'z', 'velocity_x', 'velocity_y', 'velocity_z']
  character(column_length), parameter :: gauges_integers(*) = [character(column_length) :: &
    'gauge', 'particle']

  !> Columns of contact.csv after `step`: the force on the pair's first body, its torque about the
  !> origin and the friction in it, means over the time since the row before; dissipation since the
  !> start.
  character(column_length), parameter :: contact_columns(*) = [character(column_length) :: &
    'time', 'pair', 'force_x', 'force_y', 'force_z', 'torque_x', 'torque_y', 'torque_z', &
    'friction_x', 'friction_y', 'friction_z', 'shared_nodes', 'contact_nodes', 'dissipation']
  character(column_length), parameter :: contact_integers(3) = [character(column_length) :: &
    'pair', 'shared_nodes', 'contact_nodes']

  !> Columns of rigid.csv after `step`: the attitude is a unit quaternion, its scalar first.
  character(column_length), parameter :: rigid_columns(*) = [character(column_length) :: &
    'time', 'body', 'x', 'y', 'z', 'attitude_0', 'attitude_x', 'attitude_y', 'attitude_z', &
    'velocity_x', 'velocity_y', 'velocity_z', 'omega_x', 'omega_y', 'omega_z', 'force_x', &
    'force_y', 'force_z', 'torque_x', 'torque_y', 'torque_z']
  character(column_length), parameter :: rigid_integers(1) = [character(column_length) :: 'body']

  !> Columns of motion.csv after `step`: `motion` counts those of a body, work is since the start.
  character(column_length), parameter :: motion_columns(*) = [character(column_length) :: &
    'time', 'body', 'motion', 'x', 'y', 'z', 'velocity_x', 'velocity_y', 'velocity_z', &
    'omega_x', 'omega_y', 'omega_z', 'force_x', 'force_y', 'force_z', 'torque_x', 'torque_y', &
    'torque_z', 'work']
  character(column_length), parameter :: motion_integers(2) = [character(column_length) :: &
    'body', 'motion']

  !> One table being written.
  type :: history_t
    private
    type(output_file_t) :: file
    logical, allocatable :: whole(:)   !! (columns) printed as an integer
    logical :: labelled = .false.      !! a text ends every row
    integer(i8) :: flushed = -huge(1_i8)  !! clock count of the last flush
  contains
    procedure :: open => history_open
    procedure :: write_row => history_write_row
    procedure :: flush => history_flush
    procedure :: close => history_close
    procedure :: is_open => history_is_open
  end type history_t

contains

  !> Starts a table, or continues one: with `keep_to_step`, rows of an existing file up to that step
  !! stay (its columns must be the same), later ones, which a restart writes again, go.
  subroutine history_open(self, path, columns, error, integers, keep_to_step, label)
    class(history_t), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: columns(:)               !! names after `step`
    type(error_t), allocatable, intent(out) :: error
    character(*), intent(in), optional :: integers(:)    !! columns of whole numbers
    integer, intent(in), optional :: keep_to_step
    character(*), intent(in), optional :: label          !! name of a last column of text
    character(:), allocatable :: header
    integer :: i
    header = 'step'
    do i = 1, size(columns)
      header = header//','//trim(columns(i))
    end do
    self%labelled = present(label)
    if (present(label)) header = header//','//label
    allocate (self%whole(size(columns)), source=.false.)
    if (present(integers)) self%whole = [(any(columns(i) == integers), i=1, size(columns))]
    self%flushed = -huge(1_i8)
    if (present(keep_to_step)) then
      if (file_exists(path)) then
        call cut_back(path, header, keep_to_step, error)
        if (.not. allocated(error)) call self%file%open(path, 'append', error)
        return
      end if
    end if
    call self%file%open(path, 'new', error)
    if (allocated(error)) return
    call self%file%line(header)
    call self%file%flush(error)
  end subroutine history_open

  !> Appends one row; `values` in the order of the columns, `label` where the table has such a one.
  subroutine history_write_row(self, step, values, error, label)
    class(history_t), intent(inout) :: self
    integer, intent(in) :: step
    real(dp), intent(in) :: values(:)
    type(error_t), allocatable, intent(out) :: error
    character(*), intent(in), optional :: label
    character(:), allocatable :: row
    integer(i8) :: now, rate
    integer :: first, last
    if (size(values) /= size(self%whole) .or. (present(label) .neqv. self%labelled)) then
      call error_make(error, exit_io, "a row of '"//self%file%name()//"' has "// &
                      integer_text(size(values))//' values, its header '// &
                      integer_text(size(self%whole)), 'this is a fault of the program: report it')
      return
    end if
    row = integer_text(step)
    first = 1
    do while (first <= size(values))
      if (self%whole(first)) then
        row = row//','//integer_text(nint(values(first), i8))
        first = first + 1
        cycle
      end if
      do last = first, size(values) - 1
        if (self%whole(last + 1)) exit
      end do
      last = min(last, size(values))
      row = row//','//row_text(values(first:last), ',')
      first = last + 1
    end do
    if (present(label)) row = row//','//label
    call self%file%line(row)
    call system_clock(now, rate)
    if (now - rate >= self%flushed) then
      call self%file%flush(error)
      self%flushed = now
    end if
  end subroutine history_write_row

  !> Makes all rows visible to readers, and with `safe` survive a crash of the machine; harmless if
  !! the table was never opened.
  subroutine history_flush(self, error, safe)
    class(history_t), intent(inout) :: self
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in), optional :: safe
    call self%file%flush(error)
    if (allocated(error) .or. .not. present(safe) .or. .not. self%is_open()) return
    if (.not. safe) return
    if (.not. file_sync(self%file%name())) call io_error(error, 'write', self%file%name())
  end subroutine history_flush

  !> Ends the table; harmless if it was never opened.
  subroutine history_close(self, error)
    class(history_t), intent(inout) :: self
    type(error_t), allocatable, intent(out) :: error
    call self%file%close(error)
    if (allocated(self%whole)) deallocate (self%whole)
  end subroutine history_close

  !> Whether rows can be written.
  pure function history_is_open(self) result(open)
    class(history_t), intent(in) :: self
    logical :: open
    open = self%file%is_open()
  end function history_is_open

  !> Rewrites the table without the rows after `step`; a last line cut short by a crash goes too.
  subroutine cut_back(path, header, step, error)
    character(*), intent(in) :: path, header
    integer, intent(in) :: step
    type(error_t), allocatable, intent(out) :: error
    type(line_t), allocatable :: lines(:)
    type(output_file_t) :: file
    integer :: commas, i, row_step, status
    call file_lines(path, lines, error)
    if (allocated(error)) return
    if (size(lines) > 0) then
      if (lines(1)%text /= header) then
        call io_error(error, 'continue', path, 'its columns are not those of this run')
        error%remedy = 'move the file away, or restart with the same output cards'
        return
      end if
    end if
    commas = count_commas(header)
    call file%open(path, 'replace', error)
    if (allocated(error)) return
    do i = 1, size(lines)
      if (index(lines(i)%text, '#') == 1) cycle  ! older versions wrote a line of units
      if (i > 1) then
        if (count_commas(lines(i)%text) /= commas) exit
        read (lines(i)%text(:index(lines(i)%text, ',') - 1), *, iostat=status) row_step
        if (status /= 0) exit
        if (row_step > step) exit
      end if
      call file%line(lines(i)%text)
    end do
    call file%close(error)
  end subroutine cut_back

  pure function count_commas(text) result(n)
    character(*), intent(in) :: text
    integer :: n, i
    n = 0
    do i = 1, len(text)
      if (text(i:i) == ',') n = n + 1
    end do
  end function count_commas

end module sgmp_history
