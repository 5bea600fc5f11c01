!> sgmp: an explicit material point solver for extreme events.
!!
!! Reads the command line, does what it asks for, and is the only place that ends the program.
program sgmp
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use omp_lib, only: omp_get_num_procs
  use sgmp_command_line, only: command_line_read, command_line_t
  use sgmp_errors, only: error_t, exit_io, exit_ok
  use sgmp_kinds, only: dp
  use sgmp_parallel, only: parallel_agree, parallel_end, parallel_rank, parallel_start
  use sgmp_posix, only: environment_default, wait_politely
  use sgmp_program, only: program_act, program_report
  use sgmp_timers, only: wall_time
  implicit none
  interface
    subroutine c_exit(status) bind(c, name='exit')
      import :: c_int
      implicit none
      integer(c_int), value :: status
    end subroutine c_exit
    subroutine c_exit_at_once(status) bind(c, name='_exit')
      import :: c_int
      implicit none
      integer(c_int), value :: status
    end subroutine c_exit_at_once
  end interface
  type(command_line_t) :: options
  type(error_t), allocatable :: error
  real(dp) :: started
  integer :: status
  if (omp_get_num_procs() > 1) call wait_politely()
  started = wall_time()
  ! Open MPI's own module for files loses data in one of its components (vulcan).
  call environment_default('OMPI_MCA_io', '^ompio')
  status = exit_ok
  call parallel_start(error)
  if (.not. allocated(error)) call command_line_read(options, error)
  if (.not. allocated(error)) call program_act(options, started, error, status)
  call parallel_agree(error)
  if (allocated(error)) then
    if (parallel_rank() == 0) call program_report(error)
    status = error%code
  end if
  if (status == exit_io) then
    ! MPI would close HDF5, which trips over a file that it could not write.
    flush (output_unit)
    flush (error_unit)
    call c_exit_at_once(int(status, c_int))
  end if
  call parallel_end()
  call c_exit(int(status, c_int))
end program sgmp
