!> Exceptions of the stand-in unit-test framework: a list that assertions add to and the runner looks at.
module funit_core
  implicit none
  private
  public :: SourceLocation, throw, catch, anyExceptions
  public :: exception_text, exceptions_clear, new_line_char

  integer, parameter :: max_message = 1024
  character(1), parameter :: new_line_char = achar(10)

  !> Where an assertion stands.
  type :: SourceLocation
    character(128) :: file_name = '<unknown file>'
    integer :: line_number = -1
  end type SourceLocation

  type :: exception_t
    character(max_message) :: message = ''
    type(SourceLocation) :: location
  end type exception_t

  type(exception_t), allocatable :: exceptions(:) ! of the running test; one per process, as in pFUnit

  interface catch
    module procedure catch_any, catch_message
  end interface catch

  interface anyExceptions
    module procedure any_exceptions
  end interface anyExceptions

contains

  !> Adds an exception to the running test.
  subroutine throw(message, location)
    character(*), intent(in) :: message
    type(SourceLocation), intent(in), optional :: location
    type(exception_t) :: exception
    type(exception_t), allocatable :: longer(:)
    integer :: n

    exception%message = message
    if (present(location)) exception%location = location
    n = 0
    if (allocated(exceptions)) n = size(exceptions)
    allocate (longer(n + 1))
    if (n > 0) longer(:n) = exceptions
    longer(n + 1) = exception
    call move_alloc(longer, exceptions)
  end subroutine throw

  logical function any_exceptions()
    any_exceptions = .false.
    if (allocated(exceptions)) any_exceptions = size(exceptions) > 0
  end function any_exceptions

  !> True if there was an exception; takes the oldest away unless `preserve`.
  logical function catch_any(preserve)
    logical, intent(in), optional :: preserve

    catch_any = any_exceptions()
    if (catch_any .and. .not. is_true(preserve)) call remove(1)
  end function catch_any

  !> True if there was an exception with this message; takes it away unless `preserve`.
  logical function catch_message(message, preserve)
    character(*), intent(in) :: message
    logical, intent(in), optional :: preserve
    integer :: i

    catch_message = .false.
    if (.not. any_exceptions()) return
    do i = 1, size(exceptions)
      if (exceptions(i)%message /= message) cycle
      catch_message = .true.
      if (.not. is_true(preserve)) call remove(i)
      return
    end do
  end function catch_message

  pure logical function is_true(flag)
    logical, intent(in), optional :: flag

    is_true = .false.
    if (present(flag)) is_true = flag
  end function is_true

  subroutine remove(k)
    integer, intent(in) :: k
    type(exception_t), allocatable :: shorter(:)

    allocate (shorter(size(exceptions) - 1))
    shorter(:k - 1) = exceptions(:k - 1)
    shorter(k:) = exceptions(k + 1:)
    call move_alloc(shorter, exceptions)
  end subroutine remove

  subroutine exceptions_clear()
    if (allocated(exceptions)) deallocate (exceptions)
  end subroutine exceptions_clear

  !> All exceptions of the running test as text, empty if there are none.
  function exception_text() result(text)
    character(:), allocatable :: text
    character(16) :: line
    integer :: i

    text = ''
    if (.not. any_exceptions()) return
    do i = 1, size(exceptions)
      write (line, '(i0)') exceptions(i)%location%line_number
      text = text // '  Location: [' // trim(exceptions(i)%location%file_name) // ':' // trim(line) // ']' // &
        new_line_char &
             // '  ' // trim(exceptions(i)%message) // new_line_char
    end do
  end function exception_text

end module funit_core
