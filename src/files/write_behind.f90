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
  integer, parameter :: most_lent = 64           !! blocks at once, as in write_behind.cpp
  integer(c_size_t), parameter :: block = 1048576_c_size_t  !! bytes

  !> The thread, and what waits for it; copies name the same one.
  type :: write_behind_t
    private
    type(c_ptr) :: writer = c_null_ptr           !! null: there is none
  contains
    procedure :: start => write_behind_start
    procedure :: works => write_behind_works
    procedure :: settle => write_behind_settle
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
    function c_lend(writer, wanted, blocks) result(lent) bind(c, name='sgmp_writer_lend')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: writer
      integer(c_int), value :: wanted
      type(c_ptr), intent(inout) :: blocks(*)
      integer(c_int) :: lent
    end function c_lend
    subroutine c_give(writer, stream, n) bind(c, name='sgmp_writer_give')
      import :: c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: writer, stream
      integer(c_size_t), value :: n
    end subroutine c_give
    subroutine c_fill(block, bytes, offset, n) bind(c, name='sgmp_writer_fill')
      import :: c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: block, bytes
      integer(c_size_t), value :: offset, n
    end subroutine c_fill
    subroutine c_close(writer, stream, path, target) bind(c, name='sgmp_writer_close')
      import :: c_char, c_ptr
      implicit none
      type(c_ptr), value :: writer, stream
      character(kind=c_char), intent(in) :: path(*), target(*)
    end subroutine c_close
    subroutine c_settle(writer, path) bind(c, name='sgmp_writer_settle')
      import :: c_char, c_ptr
      implicit none
      type(c_ptr), value :: writer
      character(kind=c_char), intent(in) :: path(*)
    end subroutine c_settle
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

  !> Waits until a file that is being written at a path is in its place: it may be opened anew.
  subroutine write_behind_settle(self, path)
    class(write_behind_t), intent(in) :: self
    character(*), intent(in) :: path
    if (c_associated(self%writer)) call c_settle(self%writer, path//c_null_char)
  end subroutine write_behind_settle

  !> Hands over bytes of an open stream; waits where too many wait already. Many bytes are copied by
  !! all threads.
  subroutine write_behind_put(self, stream, address, bytes)
    class(write_behind_t), intent(in) :: self
    type(c_ptr), intent(in) :: stream, address
    integer(c_size_t), intent(in) :: bytes
    type(c_ptr) :: blocks(most_lent)
    integer(c_size_t) :: done, last
    integer :: lent, i
    if (bytes < 2*block) then
      call c_put(self%writer, stream, address, bytes)
      return
    end if
    done = 0
    do while (done < bytes)
      lent = c_lend(self%writer, int(min((bytes - done + block - 1)/block, &
                                         int(most_lent, c_size_t)), c_int), blocks)
      last = min(bytes, done + lent*block)
      !$omp parallel do schedule(static) default(none) shared(blocks, address, lent, done, last)
      do i = 1, lent
        call c_fill(blocks(i), address, done + (i - 1)*block, last)
      end do
      !$omp end parallel do
      call c_give(self%writer, stream, last - done)
      done = last
    end do
  end subroutine write_behind_put

  !> The stream is to be closed, and its file to be renamed to `target`, when its bytes are written.
  subroutine write_behind_close(self, stream, path, target)
    class(write_behind_t), intent(in) :: self
    type(c_ptr), intent(in) :: stream
    character(*), intent(in) :: path, target
    call c_close(self%writer, stream, path//c_null_char, target//c_null_char)
  end subroutine write_behind_close

  !> Tells the first failure since it was asked last: the file, '' for none, and the number that
  !! the system gives it.
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
