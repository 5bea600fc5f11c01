!> What the operating system does for a run besides reading and writing: signals, files that are
!! safe on the disk, space, numbered files, locks (posix.c).
module sgmp_posix
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_null_char
  use sgmp_kinds, only: i8
  use sgmp_spelling, only: string_t
  implicit none
  private
  public :: environment_default, file_names, file_number, file_regular, file_reserve, file_sync, &
            folder_lock, signal_name, program_path, signals_watch, wait_politely
  public :: lock_taken, lock_unknown, lock_impossible

  character(8), parameter :: names(4) = [character(8) :: 'SIGTERM', 'SIGUSR1', 'SIGXCPU', 'SIGINT']
  integer(i8), parameter :: lock_taken = 0_i8      !! by this process
  integer(i8), parameter :: lock_unknown = -1_i8   !! the file system has no locks
  integer(i8), parameter :: lock_impossible = -2_i8  !! the file cannot be made

  interface
    subroutine c_signals_watch() bind(c, name='sgmp_signals_watch')
      implicit none
    end subroutine c_signals_watch
    function c_signal_seen() result(number) bind(c, name='sgmp_signal_seen')
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function c_signal_seen
    function c_program_path(path, n) result(length) bind(c, name='sgmp_program_path')
      import :: c_char, c_int64_t
      implicit none
      character(kind=c_char), intent(inout) :: path(*)
      integer(c_int64_t), value :: n
      integer(c_int64_t) :: length
    end function c_program_path
    function c_file_sync(path) result(status) bind(c, name='sgmp_file_sync')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function c_file_sync
    function c_file_regular(path) result(yes) bind(c, name='sgmp_file_regular')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: yes
    end function c_file_regular
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
    function c_file_next(folder, suffix, after, name, n) result(length) &
        bind(c, name='sgmp_file_next')
      import :: c_char, c_int64_t
      implicit none
      character(kind=c_char), intent(in) :: folder(*), suffix(*), after(*)
      character(kind=c_char), intent(inout) :: name(*)
      integer(c_int64_t), value :: n
      integer(c_int64_t) :: length
    end function c_file_next
    function c_folder_lock(path, rank) result(holder) bind(c, name='sgmp_folder_lock')
      import :: c_char, c_int64_t
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int64_t), value :: rank
      integer(c_int64_t) :: holder
    end function c_folder_lock
    subroutine c_environment_default(name, value) bind(c, name='sgmp_environment_default')
      import :: c_char
      implicit none
      character(kind=c_char), intent(in) :: name(*), value(*)
    end subroutine c_environment_default
    subroutine c_start_anew_with(names, value) bind(c, name='sgmp_start_anew_with')
      import :: c_char
      implicit none
      character(kind=c_char), intent(in) :: names(*), value(*)
    end subroutine c_start_anew_with
  end interface

  !> Turns for which a thread looks whether the others have come before it gives its core away:
  !! about 100 microseconds. The library's own 300000 take the core from who is waited for where
  !! there is other work (doc/performance.md).
  character(*), parameter :: polite_turns = '2000'

contains

  !> From now on SIGTERM, SIGUSR1, SIGXCPU and the first SIGINT (Ctrl-C) are noted instead of ending
  !! the program, and a file that outgrows its limit (SIGXFSZ) fails like a full disk.
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

  !> Path of the program's own file, links followed; as it was called where the system does not say.
  function program_path() result(path)
    character(:), allocatable :: path
    integer, parameter :: most = 4096
    character(kind=c_char) :: letters(most)
    integer :: length, i
    length = int(c_program_path(letters, int(most, c_int64_t)))
    if (length > 0) then
      path = repeat(' ', length)
      do i = 1, length
        path(i:i) = letters(i)
      end do
    else
      call get_command_argument(0, length=length)
      path = repeat(' ', length)
      call get_command_argument(0, path)
    end if
  end function program_path

  !> Whether a path is a file or a link to one: no pipe or device, which may never end.
  function file_regular(path) result(yes)
    character(*), intent(in) :: path
    logical :: yes
    yes = c_file_regular(c_text(path)) /= 0
  end function file_regular

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

  !> Names of the files of a folder that end with a suffix, without it, sorted; none where there is
  !! no such folder.
  subroutine file_names(folder, suffix, names)
    character(*), intent(in) :: folder, suffix
    type(string_t), allocatable, intent(out) :: names(:)
    integer, parameter :: most = 255
    character(kind=c_char) :: letters(most)
    type(string_t) :: next
    character(most) :: whole
    integer :: length, i
    allocate (names(0))
    whole = ''
    do
      length = int(c_file_next(c_text(folder), c_text(suffix), c_text(whole), letters, &
                               int(most, c_int64_t)))
      if (length == 0) return
      whole = ''
      do i = 1, length
        whole(i:i) = letters(i)
      end do
      next%text = whole(:length - len(suffix))
      names = [names, next]
    end do
  end subroutine file_names

  !> Takes a rank's part of a lock file until the process ends, however it ends; the first rank,
  !! who comes first, gets it only where no process of another run has any part.
  function folder_lock(path, rank) result(holder)
    character(*), intent(in) :: path
    integer, intent(in) :: rank
    integer(i8) :: holder                  !! lock_*, or the number of a process that has the lock
    holder = int(c_folder_lock(c_text(path), int(rank, c_int64_t)), i8)
  end function folder_lock

  !> Gives an environment variable a value unless the user has.
  subroutine environment_default(name, value)
    character(*), intent(in) :: name, value
    call c_environment_default(c_text(name), c_text(value))
  end subroutine environment_default

  !> From now on OpenMP's threads that wait give their cores to others soon, unless the user has
  !! said how they wait. The library reads that before the program's first line, so the program
  !! begins anew: call this first.
  subroutine wait_politely()
    call c_start_anew_with([c_text('GOMP_SPINCOUNT'), c_text('OMP_WAIT_POLICY'), c_null_char], &
                           c_text(polite_turns))
  end subroutine wait_politely

  pure function c_text(text) result(letters)
    character(*), intent(in) :: text
    character(kind=c_char), allocatable :: letters(:)
    letters = transfer(trim(text)//c_null_char, [c_char_' '], len_trim(text) + 1)
  end function c_text

end module sgmp_posix
