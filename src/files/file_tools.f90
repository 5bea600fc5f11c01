!> Files that cannot lose data unnoticed.
!!
!! Every text and binary file of the solver (HDF5 apart) is written through `output_file_t`. It
!! rests on the standard C streams because the Fortran run-time library here reports success for
!! WRITE, FLUSH and CLOSE on a full disk. The first failure is kept, later writes are skipped, and
!! whoever flushes or closes gets it.
module sgmp_file_tools
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_int32_t, &
    c_int8_t, c_loc, c_null_char, c_null_ptr, c_ptr, c_size_t
  use sgmp_errors, only: error_make, error_t, exit_io
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_write_behind, only: write_behind_t
  implicit none
  private
  public :: output_file_t, directory_make, file_exists, file_lines, file_remove, file_rename, &
    behind_error, io_error, line_t, is_terminal, system_message

  character(1), parameter, public :: newline = achar(10)

  !> One line of a text file, without its end-of-line mark.
  type :: line_t
    character(:), allocatable :: text
  end type line_t

  !> A file being written; bytes go out in the machine's own order.
  type :: output_file_t
    private
    type(c_ptr) :: stream = c_null_ptr           !! C stream, null while closed
    character(:), allocatable :: target          !! final path
    character(:), allocatable :: path            !! path being written (differs while replacing)
    type(error_t), allocatable :: failure        !! first failure not yet handed out
    type(write_behind_t) :: behind               !! the thread that writes, where there is one
  contains
    procedure :: open => output_file_open
    procedure, private :: put_text, put_real1, put_real2, put_int8, put_int32, put_int64
    generic :: put => put_text, put_real1, put_real2, put_int8, put_int32, put_int64
    procedure :: line => put_line
    procedure :: flush => output_file_flush
    procedure :: close => output_file_close
    procedure :: is_open => output_file_is_open
    procedure :: name => output_file_name
  end type output_file_t

  interface
    function c_fopen(path, mode) result(stream) bind(c, name='fopen')
      import :: c_char, c_ptr
      implicit none
      character(kind=c_char), intent(in) :: path(*), mode(*)
      type(c_ptr) :: stream
    end function c_fopen
    function c_fwrite(buffer, size, count, stream) result(written) bind(c, name='fwrite')
      import :: c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: buffer, stream
      integer(c_size_t), value :: size, count
      integer(c_size_t) :: written
    end function c_fwrite
    function c_text_address(text) result(address) bind(c, name='sgmp_text_address')
      import :: c_char, c_ptr
      implicit none
      character(kind=c_char), intent(in) :: text(*)
      type(c_ptr) :: address
    end function c_text_address
    function c_fflush(stream) result(status) bind(c, name='fflush')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_fflush
    function c_fclose(stream) result(status) bind(c, name='fclose')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: stream
      integer(c_int) :: status
    end function c_fclose
    function c_rename(old, new) result(status) bind(c, name='rename')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: old(*), new(*)
      integer(c_int) :: status
    end function c_rename
    function c_remove(path) result(status) bind(c, name='remove')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function c_remove
    !> Removes a symbolic link to a file, and nothing else.
    subroutine c_link_remove(path) bind(c, name='sgmp_link_remove')
      import :: c_char
      implicit none
      character(kind=c_char), intent(in) :: path(*)
    end subroutine c_link_remove
    function c_mkdir(path, mode) result(status) bind(c, name='mkdir')
      import :: c_char, c_int, c_int32_t
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int32_t), value :: mode
      integer(c_int) :: status
    end function c_mkdir
    function c_isatty(descriptor) result(yes) bind(c, name='isatty')
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: yes
    end function c_isatty
    function c_errno_location() result(location) bind(c, name='__errno_location')
      import :: c_ptr
      implicit none
      type(c_ptr) :: location
    end function c_errno_location
    function c_strerror(number) result(text) bind(c, name='strerror')
      import :: c_int, c_ptr
      implicit none
      integer(c_int), value :: number
      type(c_ptr) :: text
    end function c_strerror
    function c_strlen(text) result(length) bind(c, name='strlen')
      import :: c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function c_strlen
  end interface

contains

  ! ---------------------------------------------------------------- files

  !> Opens a file for writing: `mode` is 'new' (default; truncates), 'append', or 'replace', which
  !! writes `path.part` and renames it over `path` on a successful close, so that a reader never
  !! finds half a file. A failure is kept for `flush` and `close`, and returned if `error` is given.
  !! With `behind` a thread writes and closes the file later; `behind_error` tells its failures.
  subroutine output_file_open(self, path, mode, error, behind)
    class(output_file_t), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in), optional :: mode
    type(error_t), allocatable, intent(out), optional :: error
    type(write_behind_t), intent(in), optional :: behind
    character(:), allocatable :: how
    how = 'new'
    if (present(mode)) how = mode
    if (c_associated(self%stream)) call self%close()
    if (allocated(self%failure)) deallocate (self%failure)
    self%behind = write_behind_t()
    if (present(behind)) self%behind = behind
    self%target = trim(path)
    self%path = self%target
    if (how == 'replace') self%path = self%target//'.part'
    call self%behind%settle(self%path)
    if (how /= 'append') call c_link_remove(c_text(self%path))
    self%stream = c_fopen(c_text(self%path), c_text(merge('a', 'w', how == 'append')//'b'))
    if (.not. c_associated(self%stream)) call io_error(self%failure, 'open', self%path)
    if (present(error)) call move_alloc(self%failure, error)
  end subroutine output_file_open

  !> Writes `text` and an end-of-line mark.
  subroutine put_line(self, text)
    class(output_file_t), intent(inout) :: self
    character(*), intent(in) :: text
    call self%put(text//newline)
  end subroutine put_line

  !> Writes characters as they are.
  subroutine put_text(self, text)
    class(output_file_t), intent(inout) :: self
    character(*), intent(in) :: text
    if (len(text) > 0) call put_bytes(self, c_text_address(text), len(text, c_size_t))
  end subroutine put_text

  subroutine put_real1(self, values)
    class(output_file_t), intent(inout) :: self
    real(dp), intent(in), contiguous, target :: values(:)
    if (size(values) > 0) call put_bytes(self, c_loc(values), 8*size(values, kind=c_size_t))
  end subroutine put_real1

  subroutine put_real2(self, values)
    class(output_file_t), intent(inout) :: self
    real(dp), intent(in), contiguous, target :: values(:, :)
    if (size(values) > 0) call put_bytes(self, c_loc(values), 8*size(values, kind=c_size_t))
  end subroutine put_real2

  subroutine put_int8(self, values)
    class(output_file_t), intent(inout) :: self
    integer(c_int8_t), intent(in), contiguous, target :: values(:)
    if (size(values) > 0) call put_bytes(self, c_loc(values), size(values, kind=c_size_t))
  end subroutine put_int8

  subroutine put_int32(self, values)
    class(output_file_t), intent(inout) :: self
    integer(i4), intent(in), contiguous, target :: values(:)
    if (size(values) > 0) call put_bytes(self, c_loc(values), 4*size(values, kind=c_size_t))
  end subroutine put_int32

  subroutine put_int64(self, values)
    class(output_file_t), intent(inout) :: self
    integer(i8), intent(in), contiguous, target :: values(:)
    if (size(values) > 0) call put_bytes(self, c_loc(values), 8*size(values, kind=c_size_t))
  end subroutine put_int64

  subroutine put_bytes(self, address, bytes)
    class(output_file_t), intent(inout) :: self
    type(c_ptr), intent(in) :: address
    integer(c_size_t), intent(in) :: bytes
    if (allocated(self%failure) .or. .not. c_associated(self%stream)) return
    if (self%behind%works()) then
      call self%behind%put(self%stream, address, bytes)
      return
    end if
    if (c_fwrite(address, 1_c_size_t, bytes, self%stream) /= bytes) then
      call io_error(self%failure, 'write', self%path)
    end if
  end subroutine put_bytes

  !> Hands everything written so far to the operating system; reports the first failure since
  !! opening.
  subroutine output_file_flush(self, error)
    class(output_file_t), intent(inout) :: self
    type(error_t), allocatable, intent(out) :: error
    if (c_associated(self%stream) .and. .not. allocated(self%failure)) then
      if (c_fflush(self%stream) /= 0) call io_error(self%failure, 'write', self%path)
    end if
    if (allocated(self%failure)) allocate (error, source=self%failure)
  end subroutine output_file_flush

  !> Closes the file (harmless if closed) and reports the first failure since opening; after a
  !! failure a file being replaced keeps its old contents.
  subroutine output_file_close(self, error)
    class(output_file_t), intent(inout) :: self
    type(error_t), allocatable, intent(out), optional :: error
    integer(c_int) :: status
    if (c_associated(self%stream) .and. self%behind%works()) then
      call self%behind%close(self%stream, self%path, self%target)
      self%stream = c_null_ptr
    else if (c_associated(self%stream)) then
      status = c_fclose(self%stream)
      if (status /= 0 .and. .not. allocated(self%failure)) then
        call io_error(self%failure, 'write', self%path)
      end if
      self%stream = c_null_ptr
      if (self%path /= self%target) then
        if (allocated(self%failure)) then
          status = c_remove(c_text(self%path))
        else
          call file_rename(self%path, self%target, self%failure)
        end if
      end if
    end if
    if (present(error)) call move_alloc(self%failure, error)
  end subroutine output_file_close

  !> Whether the file is open.
  pure function output_file_is_open(self) result(open)
    class(output_file_t), intent(in) :: self
    logical :: open
    open = c_associated(self%stream)
  end function output_file_is_open

  !> The path given to `open`.
  pure function output_file_name(self) result(path)
    class(output_file_t), intent(in) :: self
    character(:), allocatable :: path
    path = ''
    if (allocated(self%target)) path = self%target
  end function output_file_name

  !> Reads a whole text file as lines (carriage returns before line ends dropped).
  subroutine file_lines(path, lines, error)
    character(*), intent(in) :: path
    type(line_t), allocatable, intent(inout) :: lines(:)  !! replaced; empty after an error
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text
    character(256) :: message
    integer(i8) :: bytes, first, i
    integer :: unit, status, n
    if (allocated(lines)) deallocate (lines)
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status, iomsg=message)
    if (status == 0) then
      inquire (unit=unit, size=bytes)
      allocate (character(max(bytes, 0_i8)) :: text)
      read (unit, iostat=status, iomsg=message) text
      close (unit)
    end if
    if (status /= 0) then
      allocate (lines(0))
      call io_error(error, 'read', path, trim(message))
      return
    end if
    n = 0
    do i = 1, len(text, i8)
      if (text(i:i) == newline .or. i == len(text, i8)) n = n + 1
    end do
    allocate (lines(n))
    first = 1
    do n = 1, size(lines)
      i = index(text(first:), newline, kind=i8)
      if (i == 0) i = len(text, i8) - first + 2
      lines(n)%text = text(first:first + i - 2)
      if (len(lines(n)%text) > 0) then
        if (lines(n)%text(len(lines(n)%text):) == achar(13)) then
          lines(n)%text = lines(n)%text(:len(lines(n)%text) - 1)
        end if
      end if
      first = first + i
    end do
  end subroutine file_lines

  !> Whether a file or directory of this name exists.
  function file_exists(path) result(exists)
    character(*), intent(in) :: path
    logical :: exists
    inquire (file=path, exist=exists)
  end function file_exists

  !> Makes a directory and its missing parents; no error if it is there already.
  subroutine directory_make(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer(c_int32_t), parameter :: mode = int(o'777', c_int32_t)  ! narrowed by the user's umask
    character(:), allocatable :: part, reason
    integer :: i
    do i = 1, len_trim(path)
      if (path(i:i) /= '/' .and. i < len_trim(path)) cycle
      part = path(:i)
      if (part == '/') cycle
      if (c_mkdir(c_text(part), mode) == 0) cycle
      reason = system_message()
      if (.not. file_exists(part//'/.')) then
        call io_error(error, 'make directory', trim(path), reason)
        return
      end if
    end do
  end subroutine directory_make

  !> Renames a file, replacing `new` in one step if it exists (same file system).
  subroutine file_rename(old, new, error)
    character(*), intent(in) :: old, new
    type(error_t), allocatable, intent(out) :: error
    if (c_rename(c_text(old), c_text(new)) /= 0) call io_error(error, 'rename to '//trim(new), old)
  end subroutine file_rename

  !> Removes a file or an empty directory.
  subroutine file_remove(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    if (c_remove(c_text(path)) /= 0) call io_error(error, 'remove', path)
  end subroutine file_remove

  !> Whether standard output is a terminal that somebody looks at: mpirun gives the processes that
  !! it starts terminals of their own, but passes on what they write there, to a file maybe; errors
  !! go through a pipe then.
  function is_terminal() result(yes)
    logical :: yes
    yes = c_isatty(1_c_int) /= 0 .and. c_isatty(2_c_int) /= 0
  end function is_terminal

  !> Builds "cannot <action> 'path': reason"; the reason defaults to the system's for the last C
  !! call.
  subroutine io_error(error, action, path, reason)
    type(error_t), allocatable, intent(out) :: error
    character(*), intent(in) :: action, path
    character(*), intent(in), optional :: reason
    character(:), allocatable :: why
    if (present(reason)) then
      why = reason
    else
      why = system_message()
    end if
    call error_make(error, exit_io, 'cannot '//action//" '"//trim(path)//"': "//why, &
                    'check that the folder exists, may be written to, and has space left')
  end subroutine io_error

  !> The first failure of what a thread has written since this was asked last.
  subroutine behind_error(behind, wait, error)
    type(write_behind_t), intent(in) :: behind
    logical, intent(in) :: wait                  !! until all is written
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    integer :: number
    call behind%failed(wait, path, number)
    if (path /= '') call io_error(error, 'write', path, system_words(int(number, c_int)))
  end subroutine behind_error

  !> The system's words for the last failure of a C call (C's errno as glibc and musl hold it).
  function system_message() result(message)
    character(:), allocatable :: message
    integer(c_int), pointer :: number
    call c_f_pointer(c_errno_location(), number)
    message = system_words(number)
  end function system_message

  !> The system's words for one of its numbers of failures.
  function system_words(number) result(message)
    integer(c_int), intent(in) :: number
    character(:), allocatable :: message
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: text
    integer :: i
    text = c_strerror(number)
    call c_f_pointer(text, letters, [int(c_strlen(text))])
    allocate (character(size(letters)) :: message)
    do i = 1, size(letters)
      message(i:i) = letters(i)
    end do
  end function system_words

  !> A Fortran string as C wants it.
  pure function c_text(text) result(letters)
    character(*), intent(in) :: text
    character(kind=c_char), allocatable :: letters(:)
    letters = transfer(trim(text)//c_null_char, [c_char_' '], len_trim(text) + 1)
  end function c_text

end module sgmp_file_tools
