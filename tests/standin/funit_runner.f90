!> Counts tests and prints the summary that ctest looks for, in pFUnit's words.
module funit_runner
  use, intrinsic :: iso_fortran_env, only: output_unit
  use funit_core, only: anyExceptions, exception_text, exceptions_clear
  implicit none
  private
  public :: test_begin, test_end, test_disabled, test_record, run_summary

  character(128) :: current = ''
  integer :: tests = 0, failures = 0, disabled = 0

contains

  subroutine test_begin(name)
    character(*), intent(in) :: name

    current = name
    call exceptions_clear()
  end subroutine test_begin

  subroutine test_end()
    call test_record(current, anyExceptions(), exception_text())
    call exceptions_clear()
  end subroutine test_end

  !> Counts one test and reports it if it failed.
  subroutine test_record(name, has_failed, text)
    character(*), intent(in) :: name, text
    logical, intent(in) :: has_failed

    tests = tests + 1
    if (.not. has_failed) return
    failures = failures + 1
    write (output_unit, '(a)') 'Failure in: ' // trim(name)
    write (output_unit, '(a)') text
  end subroutine test_record

  subroutine test_disabled(name)
    character(*), intent(in) :: name

    disabled = disabled + 1
    write (output_unit, '(a)') 'Disabled: ' // name
  end subroutine test_disabled

  !> Prints the outcome of all tests so far; true if the program has to end with an error.
  logical function run_summary() result(has_failed)
    has_failed = failures > 0
    if (has_failed) then
      write (output_unit, '(a)') 'FAILURES!!!'
      write (output_unit, '(2(a, i0), a)') 'Tests run: ', tests, ', Failures: ', failures, ', Errors: 0'
      write (output_unit, '(a)') ' *** Encountered 1 or more failures/errors during testing ***'
    else
      write (output_unit, '(a)') ' OK'
      if (disabled > 0) then
        write (output_unit, '(2(a, i0), a)') ' (', tests, ' tests, ', disabled, ' disabled)'
      else
        write (output_unit, '(a, i0, a)') ' (', tests, merge(' test) ', ' tests)', tests == 1)
      end if
    end if
    flush (output_unit)
  end function run_summary

end module funit_runner
