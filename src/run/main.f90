!> sgmp: an explicit material point solver for extreme events.
!!
!! Reads the command line and the deck, runs, and is the only place that ends the program.
! allow(S901): the complexity counted here is the sum over the procedures
program sgmp
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use omp_lib, only: omp_get_max_threads, omp_set_num_threads
  use sgmp_command_line, only: action_completion, action_help, action_markdown, action_run, &
                               action_usage, action_usage_markdown, action_version, &
                               command_line_read, command_line_t
  use sgmp_deck, only: deck_read
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_errors, only: error_t, exit_deck, exit_io, exit_ok, exit_stopped
  use sgmp_options, only: options_completion, options_markdown, options_usage
  use sgmp_parallel, only: parallel_agree, parallel_end, parallel_rank, parallel_start
  use sgmp_posix, only: environment_default, signals_watch
  use sgmp_registry_help, only: registry_write_help, registry_write_markdown
  use sgmp_scene, only: scene_free, scene_t
  use sgmp_simulation, only: simulation_check, simulation_run
  use sgmp_version, only: commit_hash, compiler_string, version_string
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
  integer :: status
  ! Open MPI's own module for files loses data in one of its components (vulcan).
  call environment_default('OMPI_MCA_io', '^ompio')
  call parallel_start()
  status = exit_ok
  call command_line_read(options, error)
  if (.not. allocated(error)) call act(options, error, status)
  call parallel_agree(error)
  if (allocated(error)) then
    if (parallel_rank() == 0) call report(error)
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

contains

  !> Does what the command line asks for.
  subroutine act(options, error, status)
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out) :: status
    status = exit_ok
    if (options%action /= action_run .and. parallel_rank() > 0) return
    select case (options%action)
    case (action_help)
      call registry_write_help(output_unit, options%keyword, error)
    case (action_markdown)
      call registry_write_markdown(output_unit)
    case (action_usage)
      call options_usage(output_unit)
    case (action_usage_markdown)
      call options_markdown(output_unit)
    case (action_completion)
      call options_completion(output_unit)
    case (action_version)
      write (output_unit, '(a)') 'sgmp '//version_string//' ('//commit_hash//') '//compiler_string
    case default
      call run_deck(options, error, status)
    end select
  end subroutine act

  !> Reads a deck, then checks or runs it.
  subroutine run_deck(options, error, status)
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out) :: status
    type(scene_t) :: scene
    type(deck_errors_t) :: errors
    integer :: threads
    status = exit_ok
    call deck_read(options%deck, options%settings, scene, errors)
    if (errors%count() > 0) then
      if (parallel_rank() == 0) call errors%print(error_unit)
      status = exit_deck
      return
    end if
    if (errors%warnings() > 0 .and. .not. options%quiet .and. parallel_rank() == 0) then
      call errors%print(error_unit)
    end if
    threads = options%threads
    if (threads == 0) threads = omp_get_max_threads()
    call omp_set_num_threads(threads)
    if (options%check) then
      call simulation_check(scene, threads, error)
    else
      call signals_watch()
      call simulation_run(scene, options, threads, output_folder(options), error)
    end if
    call scene_free(scene)
  end subroutine run_deck

  !> Folder of the output: as asked for, or the deck's name with .out in the current folder.
  pure function output_folder(options) result(folder)
    type(command_line_t), intent(in) :: options
    character(:), allocatable :: folder
    integer :: slash, dot
    if (len(options%output) > 0) then
      folder = options%output
      return
    end if
    slash = index(options%deck, '/', back=.true.)
    folder = options%deck(slash + 1:)
    dot = index(folder, '.', back=.true.)
    if (dot > 1) folder = folder(:dot - 1)
    folder = folder//'.out'
  end function output_folder

  !> Prints an error: where, what, and what to do.
  subroutine report(error)
    type(error_t), intent(in) :: error
    character(:), allocatable :: where_
    if (error%code == exit_stopped) then  ! as asked for: no error
      write (error_unit, '(a)') error%message//'; '//error%remedy
      return
    end if
    where_ = ''
    if (len(error%location) > 0) where_ = error%location//': '
    write (error_unit, '(a)') where_//'error: '//error%message
    if (len(error%remedy) > 0) write (error_unit, '(a)') '  remedy: '//error%remedy
  end subroutine report

end program sgmp
