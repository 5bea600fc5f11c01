!> A thread that writes files while the others compute (write_behind.cpp): who writes hands bytes
!! over and goes on; a failure is told later, to whoever asks next.
module sgmp_write_behind
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_int64_t, c_null_char, &
                                         c_null_ptr, c_ptr, c_size_t
  use sgmp_kinds, only: i8
  implicit none
  private
  public :: write_behind_t

  integer, parameter :: longest = 4096           !! letters of a path

  !> The thread, and what waits for it; copies name the same one.
  type :: write_behind_t
    private
    type(c_ptr) :: writer = c_null_ptr           !! null: there is none
  contains
    procedure :: start => write_behind_start
    procedure :: works => write_behind_works
    procedure :: put => write_behind_put
    procedure :: close => write_behind_close
    procedure :: failed => write_behind_failed
    procedure :: stop => write_behind_stop
  end type write_behind_t

  interface
    function c_start(limit) result(writer) bind(c, name='sgmp_writer_start')
      import :: c_int64_t, c_ptr
      implicit none
      integer(c_int64_t), value :: limit
      type(c_ptr) :: writer
    end function c_start
    subroutine c_put(writer, stream, bytes, n) bind(c, name='sgmp_writer_put')
      import :: c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: writer, stream, bytes
      integer(c_size_t), value :: n
    end subroutine c_put
    subroutine c_close(writer, stream, path, target) bind(c, name='sgmp_writer_close')
      import :: c_char, c_ptr
      implicit none
      type(c_ptr), value :: writer, stream
      character(kind=c_char), intent(in) :: path(*), target(*)
    end subroutine c_close
    function c_wait(writer, path, n) result(number) bind(c, name='sgmp_writer_wait')
      import :: c_char, c_int, c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: writer
      character(kind=c_char), intent(inout) :: path(*)
      integer(c_size_t), value :: n
      integer(c_int) :: number
    end function c_wait
    function c_look(writer, path, n) result(number) bind(c, name='sgmp_writer_look')
      import :: c_char, c_int, c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: writer
      character(kind=c_char), intent(inout) :: path(*)
      integer(c_size_t), value :: n
      integer(c_int) :: number
    end function c_look
    subroutine c_stop(writer) bind(c, name='sgmp_writer_stop')
      import :: c_ptr
      implicit none
      type(c_ptr), value :: writer
    end subroutine c_stop
  end interface

contains

  !> Starts the thread. Where the system gives none, `works` says no, and files are written at once.
  subroutine write_behind_start(self, bytes)
    class(write_behind_t), intent(inout) :: self
    integer(i8), intent(in) :: bytes             !! that may wait
    if (.not. c_associated(self%writer)) self%writer = c_start(int(bytes, c_int64_t))
  end subroutine write_behind_start

  !> Whether there is a thread.
  pure function write_behind_works(self) result(yes)
    class(write_behind_t), intent(in) :: self
    logical :: yes
    yes = c_associated(self%writer)
  end function write_behind_works

  !> Hands over bytes of an open stream; waits where too many wait already.
  subroutine write_behind_put(self, stream, address, bytes)
    class(write_behind_t), intent(in) :: self
    type(c_ptr), intent(in) :: stream, address
    integer(c_size_t), intent(in) :: bytes
    call c_put(self%writer, stream, address, bytes)
  end subroutine write_behind_put

  !> The stream is to be closed, and its file to be renamed to `target`, when its bytes are written.
  subroutine write_behind_close(self, stream, path, target)
    class(write_behind_t), intent(in) :: self
    type(c_ptr), intent(in) :: stream
    character(*), intent(in) :: path, target
    call c_close(self%writer, stream, path//c_null_char, target//c_null_char)
  end subroutine write_behind_close

  !> Tells the first failure since it was asked last: the file, '' for none, and the system's number.
  subroutine write_behind_failed(self, wait, path, number)
    class(write_behind_t), intent(in) :: self
    logical, intent(in) :: wait                  !! until all is written
    character(:), allocatable, intent(out) :: path
    integer, intent(out) :: number
    character(kind=c_char) :: letters(longest)
    integer :: i
    path = ''
    number = 0
    if (.not. c_associated(self%writer)) return
    letters = c_null_char
    if (wait) then
      number = c_wait(self%writer, letters, size(letters, kind=c_size_t))
    else
      number = c_look(self%writer, letters, size(letters, kind=c_size_t))
    end if
    if (number == 0) return
    do i = 1, longest
      if (letters(i) == c_null_char) exit
      path = path//letters(i)
    end do
  end subroutine write_behind_failed

  !> Writes what waits and ends the thread.
  subroutine write_behind_stop(self)
    class(write_behind_t), intent(inout) :: self
    if (c_associated(self%writer)) call c_stop(self%writer)
    self%writer = c_null_ptr
  end subroutine write_behind_stop

end module sgmp_write_behind
