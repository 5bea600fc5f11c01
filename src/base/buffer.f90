!> A list of numbers that grows while a message is written, and is read front to back.
module sgmp_buffer
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: buffer_t, buffer_put, buffer_get, buffer_whole, buffer_left, buffer_take

  !> A message.
  type :: buffer_t
    real(dp), allocatable :: values(:)
    integer :: n = 0          !! values written, or received
    integer :: read = 0       !! values read
  end type buffer_t

contains

  !> Room for some values at the end; they begin behind `before`.
  pure subroutine buffer_take(buffer, count, before)
    type(buffer_t), intent(inout) :: buffer
    integer, intent(in) :: count
    integer, intent(out) :: before
    if (.not. allocated(buffer%values)) allocate (buffer%values(max(count, 64)))
    before = buffer%n
    buffer%n = before + count
    call grow(buffer%values, before, buffer%n)
  end subroutine buffer_take

  !> Appends values.
  pure subroutine buffer_put(buffer, values)
    type(buffer_t), intent(inout) :: buffer
    real(dp), intent(in) :: values(:)
    integer :: before
    call buffer_take(buffer, size(values), before)
    buffer%values(before + 1:buffer%n) = values
  end subroutine buffer_put

  !> Reads the next values.
  pure subroutine buffer_get(buffer, values)
    type(buffer_t), intent(inout) :: buffer
    real(dp), intent(out) :: values(:)
    values = buffer%values(buffer%read + 1:buffer%read + size(values))
    buffer%read = buffer%read + size(values)
  end subroutine buffer_get

  !> Reads the next value, a whole number.
  pure subroutine buffer_whole(buffer, number)
    type(buffer_t), intent(inout) :: buffer
    integer, intent(out) :: number
    buffer%read = buffer%read + 1
    number = nint(buffer%values(buffer%read))
  end subroutine buffer_whole

  !> Whether there is anything left to read.
  pure function buffer_left(buffer) result(yes)
    type(buffer_t), intent(in) :: buffer
    logical :: yes
    yes = buffer%read < buffer%n
  end function buffer_left

end module sgmp_buffer
