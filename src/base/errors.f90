!> Errors as values: what went wrong, where in the user's input, and what to do about it.
!!
!! Anything that can fail for the user's reasons returns `type(error_t), allocatable`; only `main`
!! ends the run.
module sgmp_errors
  implicit none
  private
  public :: error_t, error_make
  public :: exit_ok, exit_usage, exit_deck, exit_numerical, exit_io, exit_stopped, exit_codes

  integer, parameter :: exit_ok = 0        !! finished
  integer, parameter :: exit_usage = 2     !! wrong command line
  integer, parameter :: exit_deck = 3      !! errors in the deck
  integer, parameter :: exit_numerical = 4  !! blow-up, lost particles, time step below its minimum
  integer, parameter :: exit_io = 5        !! a file could not be read or written
  integer, parameter :: exit_stopped = 6   !! time limit or signal, after a complete checkpoint

  !> An exit code in words.
  type :: exit_code_t
    integer :: code
    character(88) :: meaning
  end type exit_code_t

  !> All of them, for help and documents.
  type(exit_code_t), parameter :: exit_codes(*) = [ &
    exit_code_t(exit_ok, 'finished'), &
    exit_code_t(exit_usage, 'command line'), &
    exit_code_t(exit_deck, 'deck; all errors are listed with file:line:column'), &
    exit_code_t(exit_numerical, &
                'the computation: not a number, energy growth, lost particles, '// &
                'time step too small'), &
    exit_code_t(exit_io, 'files; the folder belongs to a run that is still going'), &
    exit_code_t(exit_stopped, &
                'stopped by a signal, the time limit or the stop file, after a checkpoint')]

  !> One failure.
  type :: error_t
    integer :: code = exit_usage            !! exit code of its class
    character(:), allocatable :: location   !! `file:line:column`, or empty
    character(:), allocatable :: message    !! what is wrong, with the offending word
    character(:), allocatable :: remedy     !! what was expected, or what to do; may be empty
  end type error_t

contains

  !> Builds an error; `location` and `remedy` default to empty.
  pure subroutine error_make(error, code, message, remedy, location)
    type(error_t), allocatable, intent(out) :: error  !! the new error
    integer, intent(in) :: code                      !! one of the exit_* constants
    character(*), intent(in) :: message              !! what is wrong
    character(*), intent(in), optional :: remedy     !! what to do
    character(*), intent(in), optional :: location   !! file:line:column
    allocate (error)
    error%code = code
    error%message = message
    error%remedy = ''
    error%location = ''
    if (present(remedy)) error%remedy = remedy
    if (present(location)) error%location = location
  end subroutine error_make

end module sgmp_errors
