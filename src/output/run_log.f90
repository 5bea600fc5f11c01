!> run.log and the terminal: messages, the table of steps, a progress bar, the table of phases.
!!
!! The file receives everything; the terminal what its level asks for. A log that was never opened
!! (ranks other than the first) swallows all calls. The first failure to write is reported on
!! standard error at once and returned by `close`.
module sgmp_run_log
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: is_terminal, output_file_t
  use sgmp_kinds, only: dp, i8
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: log_t, log_row_t, duration_text
  public :: level_quiet, level_normal, level_verbose

  integer, parameter :: level_quiet = 0   !! terminal: warnings only
  integer, parameter :: level_normal = 1  !! terminal: messages, table of steps, progress bar
  integer, parameter :: level_verbose = 2  !! terminal: everything

  integer, parameter :: warning_length = 240
  integer, parameter :: rows_per_header = 40
  integer, parameter :: bar_width = 30
  character(*), parameter :: header = '     step           t         dt  limited by'// &
    '            kinetic    internal       total      drift     cells   lost  % done        ETA'

  !> One row of the table of steps.
  type :: log_row_t
    integer :: step = 0
    real(dp) :: time = 0.0_dp
    real(dp) :: dt = 0.0_dp
    character(16) :: limited_by = ''           !! what limits dt: a material, growth, output, …
    real(dp) :: kinetic = 0.0_dp, internal = 0.0_dp, total = 0.0_dp  !! energies
    real(dp) :: drift = 0.0_dp                 !! unexplained change of the total, relative
    integer(i8) :: active_cells = 0
    integer(i8) :: lost = 0                    !! particles removed so far
    real(dp) :: fraction = 0.0_dp              !! of the run, 0 to 1
    real(dp) :: eta = -1.0_dp                  !! seconds left; negative: unknown
  end type log_row_t

  !> The log of a run.
  type :: log_t
    private
    type(output_file_t) :: file
    integer :: level = level_normal
    integer :: rows = 0                        !! written since the last header
    logical :: opened = .false.
    logical :: complained = .false.            !! a failure to write has been reported
    logical :: bar = .false.                   !! progress bar wanted (terminal, not quiet)
    logical :: bar_shown = .false.
    integer(i8) :: bar_drawn = -huge(1_i8)     !! clock count of the last drawing
    character(warning_length), allocatable, public :: warnings(:)  !! so far, for summary.json
  contains
    procedure :: open => log_open
    procedure :: line => log_line
    procedure :: warning => log_warning
    procedure :: note_warning => log_note_warning
    procedure :: step_row => log_step_row
    procedure :: progress => log_progress
    procedure :: phase_table => log_phase_table
    procedure :: close => log_close
  end type log_t

contains

  !> Opens the log on the first rank; `continued` keeps the file of the run that is restarted.
  subroutine log_open(self, path, level, error, continued)
    class(log_t), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in) :: level                  !! of the terminal, one of level_*
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in), optional :: continued
    character(:), allocatable :: mode
    mode = 'new'
    if (present(continued)) then
      if (continued) mode = 'append'
    end if
    self%level = level
    self%rows = 0
    self%bar = is_terminal()
    if (level == level_quiet) self%bar = .false.
    self%complained = .false.
    allocate (self%warnings(0))
    call self%file%open(path, mode, error)
    self%opened = .not. allocated(error)
  end subroutine log_open

  !> Writes one line (or several, with line ends inside) to the file, and to the terminal if its
  !! level is at least `level` (default: normal).
  subroutine log_line(self, text, level)
    class(log_t), intent(inout) :: self
    character(*), intent(in) :: text
    integer, intent(in), optional :: level
    integer :: needed
    if (.not. self%opened) return
    needed = level_normal
    if (present(level)) needed = level
    call write_file(self, text)
    if (self%level < needed) return
    call clear_bar(self)
    write (output_unit, '(a)') text
    flush (output_unit)
  end subroutine log_line

  !> Writes a warning to the file and to standard error, also when quiet.
  subroutine log_warning(self, text)
    class(log_t), intent(inout) :: self
    character(*), intent(in) :: text
    if (.not. self%opened) return
    self%warnings = [character(warning_length) :: self%warnings, text]
    call write_file(self, 'warning: '//text)
    call clear_bar(self)
    write (error_unit, '(a)') 'warning: '//text
    flush (error_unit)
  end subroutine log_warning

  !> Notes a warning that the terminal has seen already.
  subroutine log_note_warning(self, text)
    class(log_t), intent(inout) :: self
    character(*), intent(in) :: text
    if (.not. self%opened) return
    self%warnings = [character(warning_length) :: self%warnings, text]
    call write_file(self, 'warning: '//text)
  end subroutine log_note_warning

  !> Adds a row to the table of steps, with the header before the first and every 40 rows.
  subroutine log_step_row(self, row)
    class(log_t), intent(inout) :: self
    type(log_row_t), intent(in) :: row
    character(160) :: text
    if (.not. self%opened) return
    if (modulo(self%rows, rows_per_header) == 0) call self%line(header)
    self%rows = self%rows + 1
    write (text, '(i9, es12.4, es11.3, 2x, a16, 3es12.4, es11.2, i10, i7, f8.1, 2x, a9)') &
      row%step, row%time, row%dt, row%limited_by, row%kinetic, row%internal, row%total, row%drift, &
      row%active_cells, row%lost, 100*row%fraction, adjustr(fixed(duration_text(row%eta), 9))
    call self%line(trim(text))
  end subroutine log_step_row

  !> Redraws the one-line progress bar, at most ten times a second, if standard output is a
  !! terminal.
  subroutine log_progress(self, fraction, step, time, eta)
    class(log_t), intent(inout) :: self
    real(dp), intent(in) :: fraction            !! of the run, 0 to 1
    integer, intent(in) :: step
    real(dp), intent(in) :: time
    real(dp), intent(in) :: eta                 !! seconds left; negative: unknown
    character(120) :: text
    integer(i8) :: now, rate
    integer :: filled
    if (.not. (self%opened .and. self%bar)) return
    call system_clock(now, rate)
    if (now - rate/10 < self%bar_drawn) return
    self%bar_drawn = now
    filled = nint(bar_width*min(max(fraction, 0.0_dp), 1.0_dp))
    write (text, '(3a, f6.1, a, i0, a, es9.3, 2a)') '[', repeat('#', filled), &
      repeat('.', bar_width - filled)//']', 100*fraction, ' %  step ', step, '  t ', time, &
      '  ETA ', duration_text(eta)
    write (output_unit, '(a)', advance='no') achar(13)//trim(text)//achar(27)//'[K'
    flush (output_unit)
    self%bar_shown = .true.
  end subroutine log_progress

  !> Writes the time spent per phase: minimum, average and maximum over ranks, and the share of
  !! `total`.
  subroutine log_phase_table(self, names, minimum, average, maximum, total)
    class(log_t), intent(inout) :: self
    character(*), intent(in) :: names(:)
    real(dp), intent(in) :: minimum(:), average(:), maximum(:)  !! seconds per phase
    real(dp), intent(in) :: total                              !! seconds of the whole run
    character(100) :: text
    real(dp) :: percent, rest
    integer :: i
    percent = 0.0_dp
    if (total > 0.0_dp) percent = 100/total
    rest = total
    write (text, '(a28, 3a12, a9)') fixed('phase (seconds)', 28), 'min', 'avg', 'max', 'share'
    call self%line(trim(text))
    do i = 1, size(names)
      rest = rest - average(i)
      write (text, '(a28, 3f12.3, f7.1, " %")') fixed(names(i), 28), minimum(i), average(i), &
        maximum(i), percent*average(i)
      call self%line(trim(text))
    end do
    write (text, '(a28, a12, f12.3, a12, f7.1, " %")') fixed('other', 28), '', rest, '', &
      percent*rest
    call self%line(trim(text))
    write (text, '(a28, a12, f12.3)') fixed('total', 28), '', total
    call self%line(trim(text))
  end subroutine log_phase_table

  !> Ends the log and reports the first failure to write it; harmless if it was never opened.
  subroutine log_close(self, error)
    class(log_t), intent(inout) :: self
    type(error_t), allocatable, intent(out) :: error
    if (.not. self%opened) return
    call clear_bar(self)
    call self%file%close(error)
    self%opened = .false.
  end subroutine log_close

  !> "0:07", "12:34", "1:02:03", "2d 03:04", or "-" if negative.
  pure function duration_text(seconds) result(text)
    real(dp), intent(in) :: seconds
    character(:), allocatable :: text
    character(24) :: buffer
    integer(i8) :: s
    if (.not. (seconds >= 0.0_dp .and. seconds < 1.0e10_dp)) then
      text = '-'
      return
    end if
    s = nint(seconds, i8)
    if (s < 3600) then
      write (buffer, '(i0, ":", i2.2)') s/60, modulo(s, 60_i8)
    else if (s < 86400) then
      write (buffer, '(i0, ":", i2.2, ":", i2.2)') s/3600, modulo(s/60, 60_i8), modulo(s, 60_i8)
    else
      write (buffer, '(i0, "d ", i2.2, ":", i2.2)') s/86400, modulo(s/3600, 24_i8), &
        modulo(s/60, 60_i8)
    end if
    text = trim(buffer)
  end function duration_text

  subroutine write_file(self, text)
    class(log_t), intent(inout) :: self
    character(*), intent(in) :: text
    type(error_t), allocatable :: error
    call self%file%line(text)
    call self%file%flush(error)
    if (allocated(error) .and. .not. self%complained) then
      write (error_unit, '(a)') 'warning: '//error%message
      self%complained = .true.
    end if
  end subroutine write_file

  subroutine clear_bar(self)
    class(log_t), intent(inout) :: self
    if (.not. self%bar_shown) return
    write (output_unit, '(a)', advance='no') achar(13)//achar(27)//'[K'
    flush (output_unit)
    self%bar_shown = .false.
  end subroutine clear_bar

  !> Text cut or padded to a width.
  pure function fixed(text, width) result(padded)
    character(*), intent(in) :: text
    integer, intent(in) :: width
    character(width) :: padded
    padded = text
  end function fixed

end module sgmp_run_log
