!> What a command line asks for, done: help, or a deck read, checked and run; errors in words.
module sgmp_program
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use omp_lib, only: omp_get_max_threads
  use sgmp_combinations_help, only: combinations_write_json
  use sgmp_command_line, only: action_completion, action_help, action_import, action_json, &
                               action_man, action_markdown, action_materials, action_new, &
                               action_usage, action_usage_markdown, action_version, command_line_t
  use sgmp_deck, only: deck_read
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_errors, only: error_make, error_t, exit_deck, exit_ok, exit_stopped, exit_usage
  use sgmp_file_tools, only: file_remove
  use sgmp_gallery, only: gallery_copy, gallery_list
  use sgmp_import_mpm3d, only: import_is_mpm3d, import_locate, import_path, &
                                import_place, import_read, &
                               import_summary, import_write, imported_t
  use sgmp_kinds, only: dp
  use sgmp_material_library, only: material_list, material_show
  use sgmp_options, only: options_completion, options_man, options_markdown, options_usage
  use sgmp_parallel, only: parallel_agree, parallel_rank
  use sgmp_posix, only: signals_watch
  use sgmp_registry_help, only: registry_write_help, registry_write_markdown
  use sgmp_scene, only: scene_free, scene_t
  use sgmp_simulation, only: simulation_check, simulation_run, simulation_try
  use sgmp_suggest, only: suggest_write
  use sgmp_thread_choice, only: thread_choice_read, thread_choice_t
  use sgmp_version, only: commit_hash, compiler_string, version_string
  implicit none
  private
  public :: program_act, program_report

contains

  !> Does what the command line asks for.
  subroutine program_act(options, started, error, status)
    type(command_line_t), intent(in) :: options
    real(dp), intent(in) :: started        !! wall time at which the program started
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out) :: status         !! exit code, where there is no error
    character(:), allocatable :: native
    type(imported_t) :: imported
    logical :: speaks
    status = exit_ok
    speaks = parallel_rank() == 0
    select case (options%action)
    case (action_help)
      if (speaks) call registry_write_help(output_unit, options%keyword, error)
    case (action_markdown)
      if (speaks) call registry_write_markdown(output_unit)
    case (action_usage)
      if (speaks) call options_usage(output_unit)
    case (action_usage_markdown)
      if (speaks) call options_markdown(output_unit)
    case (action_completion)
      if (speaks) call options_completion(output_unit)
    case (action_json)
      if (speaks) call combinations_write_json(output_unit)
    case (action_man)
      if (speaks) call options_man(output_unit)
    case (action_new)
      if (speaks) call new_deck(options, error)
    case (action_materials)
      if (speaks) call show_materials(options%deck, error)
    case (action_version)
      if (speaks) write (output_unit, '(a)') 'sgmp '//version_string//' ('//commit_hash//') '// &
        compiler_string
    case (action_import)
      call import_deck(options, options%output, .false., imported, native, error, status)
      if (allocated(error) .or. status /= exit_ok) return
      call try_native(imported, native, error)
      if (.not. allocated(error)) call announce(options, imported, native)
    case default
      call run_deck(options, started, error, status)
    end select
  end subroutine program_act

  !> Copies a deck of the gallery, or lists what there is.
  subroutine new_deck(options, error)
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    if (options%deck == '') then
      call gallery_list(output_unit)
      return
    end if
    call gallery_copy(options%deck, options%output, path, error)
    if (allocated(error)) return
    write (output_unit, '(a)') path//': run it with sgmp '//path// &
      '; --check first says what it will cost'
  end subroutine new_deck

  !> Lists the library of materials, or shows an entry.
  subroutine show_materials(name, error)
    character(*), intent(in) :: name  !! '' for the list
    type(error_t), allocatable, intent(out) :: error
    if (name == '') then
      call material_list(output_unit, error)
    else
      call material_show(name, output_unit, error)
    end if
  end subroutine show_materials

  !> Makes a native deck of an MPM3D deck, in a folder, and reads it.
  subroutine import_deck(options, folder, replace, imported, native, error, status)
    type(command_line_t), intent(in) :: options
    character(*), intent(in) :: folder
    logical, intent(in) :: replace  !! files that are there already
    type(imported_t), intent(out) :: imported
    character(:), allocatable, intent(out) :: native  !! path of the new deck
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out) :: status
    type(deck_errors_t) :: errors
    native = ''
    call import_read(options%deck, options%keep_3d, imported, errors, error)
    if (allocated(error)) return
    call tell(errors, status)
    if (status /= exit_ok) return
    if (parallel_rank() == 0) call import_write(imported, folder, replace, error)
    call parallel_agree(error)
    if (allocated(error)) return
    native = import_path(imported, folder)
    call read_native(imported, native, errors)
    call tell(errors, status)
    if (status /= exit_ok .and. parallel_rank() == 0) call file_remove(native, error)
    call parallel_agree(error)
  end subroutine import_deck

  !> Says what has become of a deck.
  subroutine announce(options, imported, native)
    type(command_line_t), intent(in) :: options
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: native
    if (options%quiet .or. parallel_rank() /= 0) return
    write (output_unit, '(a)') import_summary(imported, native)
  end subroutine announce

  !> Prints what is wrong with a deck.
  subroutine tell(errors, status)
    type(deck_errors_t), intent(in) :: errors
    integer, intent(out) :: status
    status = merge(exit_deck, exit_ok, errors%count() > 0)
    if (parallel_rank() /= 0) return
    call errors%print(error_unit)
  end subroutine tell

  !> Errors of a native deck, at the places of the deck that it comes from.
  subroutine read_native(imported, native, errors)
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: native
    type(deck_errors_t), intent(out) :: errors
    type(deck_errors_t) :: found
    type(scene_t) :: scene
    character(1) :: settings(0)
    call deck_read(native, settings, scene, found)
    call import_place(imported, native, found, errors)
    call scene_free(scene)
  end subroutine read_native

  !> Builds what a native deck describes, which finds what reading does not: bodies without
  !! particles, for example. A deck that cannot be built is not left behind.
  subroutine try_native(imported, native, error)
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: native
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: problem
    type(deck_errors_t) :: errors
    type(scene_t) :: scene
    character(1) :: settings(0)
    call deck_read(native, settings, scene, errors)
    call simulation_try(scene, omp_get_max_threads(), error)
    call scene_free(scene)
    if (.not. allocated(error)) return
    call import_locate(imported, native, error)
    if (parallel_rank() == 0) call file_remove(native, problem)
  end subroutine try_native

  !> Reads a deck, then checks or runs it.
  subroutine run_deck(options, started, error, status)
    type(command_line_t), intent(in) :: options
    real(dp), intent(in) :: started
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out) :: status
    type(scene_t) :: scene
    type(deck_errors_t) :: errors
    character(:), allocatable :: deck
    type(imported_t) :: imported
    type(thread_choice_t) :: threads
    status = exit_ok
    deck = options%deck
    if (import_is_mpm3d(deck)) then
      if (options%suggest) then
        call error_make(error, exit_usage, '--suggest takes native decks only', &
                        'write '//deck//' anew with sgmp import')
        return
      end if
      call import_deck(options, output_folder(options), .true., imported, deck, error, status)
      if (allocated(error) .or. status /= exit_ok) return
      call announce(options, imported, deck)
    end if
    call deck_read(deck, options%settings, scene, errors)
    call tell(errors, status)
    if (status /= exit_ok) return
    call thread_choice_read(merge(options%threads, omp_get_max_threads(), options%threads > 0), &
                            threads, error)
    if (allocated(error)) return
    if (options%suggest) then
      call suggest_write(scene, threads, error)
    else if (options%check) then
      call simulation_check(scene, threads, error)
    else
      call signals_watch()
      call simulation_run(scene, options, threads, output_folder(options), started, error)
    end if
    call scene_free(scene)
    if (import_is_mpm3d(options%deck)) call import_locate(imported, deck, error)
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
  subroutine program_report(error)
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
  end subroutine program_report

end module sgmp_program
