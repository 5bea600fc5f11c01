!> What the operating system does for a run besides reading and writing: signals, files that are
!! safe on the disk, space, numbered files (posix.c).
module sgmp_posix
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_null_char
  use sgmp_kinds, only: i8
  implicit none
  private
  public :: environment_default, file_number, file_reserve, file_sync, signal_name, signals_watch

  character(8), parameter :: names(3) = [character(8) :: 'SIGTERM', 'SIGUSR1', 'SIGXCPU']

  interface
    subroutine c_signals_watch() bind(c, name='sgmp_signals_watch')
      implicit none
    end subroutine c_signals_watch
    function c_signal_seen() result(number) bind(c, name='sgmp_signal_seen')
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function c_signal_seen
    function c_file_sync(path) result(status) bind(c, name='sgmp_file_sync')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function c_file_sync
    function c_file_reserve(path, bytes) result(status) bind(c, name='sgmp_file_reserve')
      import :: c_char, c_int, c_int64_t
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int64_t), value :: bytes
      integer(c_int) :: status
    end function c_file_reserve
    function c_file_number(folder, prefix, suffix, below) result(number) &
        bind(c, name='sgmp_file_number')
      import :: c_char, c_int64_t
      implicit none
      character(kind=c_char), intent(in) :: folder(*), prefix(*), suffix(*)
      integer(c_int64_t), value :: below
      integer(c_int64_t) :: number
    end function c_file_number
    subroutine c_environment_default(name, value) bind(c, name='sgmp_environment_default')
      import :: c_char
      implicit none
      character(kind=c_char), intent(in) :: name(*), value(*)
    end subroutine c_environment_default
  end interface

contains

  !> From now on SIGTERM, SIGUSR1 and SIGXCPU are noted instead of ending the program, and a file
  !! that outgrows its limit (SIGXFSZ) fails like a full disk.
  subroutine signals_watch()
    call c_signals_watch()
  end subroutine signals_watch

  !> The signal noted last, '' if there was none.
  function signal_name() result(name)
    character(:), allocatable :: name
    integer :: number
    number = int(c_signal_seen())
    name = ''
    if (number > 0) name = trim(names(number))
  end function signal_name

  !> Waits until a file, or the entries of a folder, are on the disk.
  function file_sync(path) result(ok)
    character(*), intent(in) :: path
    logical :: ok                          !! if not, the system's message says why
    ok = c_file_sync(c_text(path)) == 0
  end function file_sync

  !> Whether the disk, the quota and the limits of the process allow a file of so many bytes; leaves
  !! an empty or reserved file.
  function file_reserve(path, bytes) result(ok)
    character(*), intent(in) :: path
    integer(i8), intent(in) :: bytes
    logical :: ok                          !! if not, the system's message says why
    ok = c_file_reserve(c_text(path), int(bytes, c_int64_t)) == 0
  end function file_reserve

  !> Largest number below `below` among the files `<prefix>NUMBER<suffix>` of a folder, -1: none.
  function file_number(folder, prefix, suffix, below) result(number)
    character(*), intent(in) :: folder, prefix, suffix
    integer(i8), intent(in) :: below
    integer(i8) :: number
    number = int(c_file_number(c_text(folder), c_text(prefix), c_text(suffix), &
                               int(below, c_int64_t)), i8)
  end function file_number

  !> Gives an environment variable a value unless the user has.
  subroutine environment_default(name, value)
    character(*), intent(in) :: name, value
    call c_environment_default(c_text(name), c_text(value))
  end subroutine environment_default

  pure function c_text(text) result(letters)
    character(*), intent(in) :: text
    character(kind=c_char), allocatable :: letters(:)
    letters = transfer(trim(text)//c_null_char, [c_char_' '], len_trim(text) + 1)
  end function c_text

end module sgmp_posix
