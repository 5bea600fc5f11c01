!> When a run writes a checkpoint, and when it stops before its end: on a signal, on a file named
!! `stop` in its folder, or when its time is nearly over. All ranks decide alike.
module sgmp_stopping
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: file_exists, file_remove
  use sgmp_kinds, only: dp
  use sgmp_parallel, only: parallel_max, parallel_rank
  use sgmp_posix, only: signal_name
  use sgmp_scene, only: checkpoint_card_t
  use sgmp_timers, only: wall_time
  implicit none
  private
  public :: stopping_t

  integer, parameter :: nothing = 0, due = 1, by_signal = 2, by_file = 3, by_time = 4
  real(dp), parameter :: glance = 0.1_dp   !! seconds between looks for the stop file
  real(dp), parameter :: slow_disk = 1.0e8_dp  !! bytes per second assumed before the first write

  !> What the decisions rest on.
  type :: stopping_t
    private
    real(dp) :: started = 0.0_dp           !! all times of the wall clock, in seconds
    real(dp) :: limit = 0.0_dp             !! since the start; 0: none
    real(dp) :: last_write = 0.0_dp, last_look = 0.0_dp, last_step = 0.0_dp
    real(dp) :: longest_step = 0.0_dp
    real(dp) :: write_seconds = 0.0_dp     !! that a checkpoint takes
    character(:), allocatable :: path      !! of the stop file
    type(checkpoint_card_t) :: card
    integer :: found = nothing
  contains
    procedure :: start
    procedure :: look
    procedure :: written
    procedure :: stops
    procedure :: reason
  end type stopping_t

contains

  !> Starts the clocks; a stop file from an earlier run goes.
  subroutine start(self, started, limit, card, folder, bytes)
    class(stopping_t), intent(inout) :: self
    real(dp), intent(in) :: started        !! wall time at which the program started
    integer, intent(in) :: limit           !! seconds, 0: none
    type(checkpoint_card_t), intent(in) :: card
    character(*), intent(in) :: folder
    real(dp), intent(in) :: bytes          !! of a checkpoint, roughly
    type(error_t), allocatable :: error
    self%started = started
    self%limit = real(limit, dp)
    self%card = card
    self%path = folder//'/stop'
    self%last_write = wall_time()
    self%last_look = self%last_write
    self%last_step = self%last_write
    self%write_seconds = 0.5_dp + bytes/slow_disk
    if (parallel_rank() == 0 .and. file_exists(self%path)) call file_remove(self%path, error)
  end subroutine start

  !> At the end of a step: whether a checkpoint is to be written now.
  function look(self, step) result(yes)
    class(stopping_t), intent(inout) :: self
    integer, intent(in) :: step
    logical :: yes
    real(dp) :: now
    integer :: found
    now = wall_time()
    self%longest_step = max(self%longest_step, now - self%last_step)
    self%last_step = now
    found = nothing
    if (len(signal_name()) > 0) found = by_signal
    if (parallel_rank() == 0) found = max(found, look_around(self, now))
    self%found = nint(parallel_max(real(found, dp)))
    yes = self%found > nothing
    if (self%card%every > 0) yes = yes .or. mod(step, self%card%every) == 0
  end function look

  !> What the clock and the folder say.
  function look_around(self, now) result(found)
    class(stopping_t), intent(inout) :: self
    real(dp), intent(in) :: now
    integer :: found
    real(dp) :: needed
    found = nothing
    if (self%card%minutes > 0.0_dp .and. now - self%last_write >= 60.0_dp*self%card%minutes) then
      found = due
    end if
    needed = self%longest_step + 1.5_dp*self%write_seconds
    if (self%limit > 0.0_dp .and. now - self%started + needed >= self%limit) found = by_time
    if (now - self%last_look < glance) return
    self%last_look = now
    if (file_exists(self%path)) found = max(found, by_file)
  end function look_around

  !> A checkpoint has been written, in so many seconds.
  subroutine written(self, seconds)
    class(stopping_t), intent(inout) :: self
    real(dp), intent(in) :: seconds
    type(error_t), allocatable :: error
    self%write_seconds = seconds
    self%last_write = wall_time()
    self%last_step = self%last_write
    if (self%found == by_file .and. parallel_rank() == 0) call file_remove(self%path, error)
  end subroutine written

  !> Whether the run is to end after the checkpoint.
  pure function stops(self) result(yes)
    class(stopping_t), intent(in) :: self
    logical :: yes
    yes = self%found > due
  end function stops

  !> What stopped the run.
  function reason(self) result(text)
    class(stopping_t), intent(in) :: self
    character(:), allocatable :: text
    select case (self%found)
    case (by_signal)
      text = signal_name()
      if (text == '') text = 'a signal to another rank'
    case (by_file)
      text = "the file '"//self%path//"'"
    case (by_time)
      text = 'the time limit'
    case default
      text = ''
    end select
  end function reason

end module sgmp_stopping
