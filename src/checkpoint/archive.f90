!> A list of numbers that is filled from variables, or fills them, by one and the same procedure: so
!! what is read back is what was written, in the same order.
module sgmp_archive
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp, i4, i8
  implicit none
  private
  public :: archive_t

  !> Numbers on their way into a file or out of one.
  type :: archive_t
    logical :: reading = .false.           !! into variables; else from them
    logical :: complete = .true.           !! as long as a reader has found all it asked for
    real(dp), allocatable :: reals(:)
    integer(i8), allocatable :: wholes(:)
    integer :: real_place = 0, whole_place = 0
  contains
    procedure :: start
    procedure :: ended
    procedure, private :: pass_real, pass_reals, pass_i4, pass_i8, pass_i4s, pass_list, pass_table
    generic :: pass => pass_real, pass_reals, pass_i4, pass_i8, pass_i4s, pass_list, pass_table
  end type archive_t

contains

  !> An empty archive, to be filled.
  pure subroutine start(self)
    class(archive_t), intent(inout) :: self
    self%reading = .false.
    self%complete = .true.
    self%real_place = 0
    self%whole_place = 0
    if (allocated(self%reals)) deallocate (self%reals, self%wholes)
    allocate (self%reals(64), self%wholes(64))
  end subroutine start

  !> Whether all that was there has been read, and nothing was missing.
  pure function ended(self) result(yes)
    class(archive_t), intent(in) :: self
    logical :: yes
    yes = self%complete .and. self%real_place == size(self%reals) .and. &
          self%whole_place == size(self%wholes)
  end function ended

  pure subroutine pass_real(self, value)
    class(archive_t), intent(inout) :: self
    real(dp), intent(inout) :: value
    real(dp) :: values(1)
    values = value
    call self%pass_reals(values)
    value = values(1)
  end subroutine pass_real

  pure subroutine pass_reals(self, values)
    class(archive_t), intent(inout) :: self
    real(dp), intent(inout) :: values(:)
    integer :: last
    last = self%real_place + size(values)
    if (last > size(self%reals)) then
      if (self%reading) then
        self%complete = .false.
        return
      end if
      call grow(self%reals, self%real_place, last)
    end if
    if (self%reading) then
      values = self%reals(self%real_place + 1:last)
    else
      self%reals(self%real_place + 1:last) = values
    end if
    self%real_place = last
  end subroutine pass_reals

  pure subroutine pass_i8(self, value)
    class(archive_t), intent(inout) :: self
    integer(i8), intent(inout) :: value
    if (self%whole_place == size(self%wholes)) then
      if (self%reading) then
        self%complete = .false.
        return
      end if
      call grow(self%wholes, self%whole_place, self%whole_place + 1)
    end if
    self%whole_place = self%whole_place + 1
    if (self%reading) then
      value = self%wholes(self%whole_place)
    else
      self%wholes(self%whole_place) = value
    end if
  end subroutine pass_i8

  pure subroutine pass_i4(self, value)
    class(archive_t), intent(inout) :: self
    integer(i4), intent(inout) :: value
    integer(i8) :: wide
    wide = int(value, i8)
    call self%pass_i8(wide)
    value = int(wide, i4)
  end subroutine pass_i4

  pure subroutine pass_i4s(self, values)
    class(archive_t), intent(inout) :: self
    integer(i4), intent(inout) :: values(:)
    integer :: i
    do i = 1, size(values)
      call self%pass_i4(values(i))
    end do
  end subroutine pass_i4s

  !> A list with its length; a reader allocates it.
  pure subroutine pass_list(self, values, sized)
    class(archive_t), intent(inout) :: self
    integer(i4), allocatable, intent(inout) :: values(:)
    logical, intent(in) :: sized           !! tells this from a list of known length
    integer(i4) :: n
    n = 0
    if (allocated(values)) n = size(values)
    if (sized) call self%pass_i4(n)
    if (.not. self%complete) return
    if (self%reading) then
      if (allocated(values)) deallocate (values)
      allocate (values(n))
    end if
    call self%pass_i4s(values)
  end subroutine pass_list

  !> A table of known shape.
  pure subroutine pass_table(self, values)
    class(archive_t), intent(inout) :: self
    real(dp), intent(inout) :: values(:, :)
    integer :: i
    do i = 1, size(values, 2)
      call self%pass_reals(values(:, i))
    end do
  end subroutine pass_table

end module sgmp_archive
