!> A run: time loop, guards, output, log and summary.
module sgmp_simulation
  use sgmp_bill, only: bill_write
  use sgmp_build_model, only: model_build
  use sgmp_command_line, only: command_line_t
  use sgmp_energy, only: ledger_total
  use sgmp_errors, only: error_make, error_t, exit_numerical, exit_ok
  use sgmp_file_tools, only: checksum_text, directory_make
  use sgmp_gathering, only: gather_checksum
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_outputs, only: outputs_close, outputs_next_time, outputs_open, outputs_step, outputs_t
  use sgmp_process, only: peak_memory_bytes
  use sgmp_run_log, only: level_normal, level_quiet, level_verbose, log_row_t, log_t
  use sgmp_scene, only: method_names, scene_t, update_names
  use sgmp_step, only: step_take
  use sgmp_summary, only: summary_t
  use sgmp_text, only: integer_text, real_text
  use sgmp_time_step, only: clock_advance, clock_choose, limit_courant, limit_names
  use sgmp_timers, only: phase_count, phase_names, phase_output, timers_start, timers_stop, timers_t, wall_time
  use sgmp_version, only: commit_hash, compiler_string, version_string
  implicit none
  private
  public :: simulation_run, simulation_check

contains

  !> Prints what a scene will cost, and runs nothing.
  subroutine simulation_check(scene, threads, error)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: threads
    type(error_t), allocatable, intent(out) :: error
    type(model_t), allocatable :: model
    allocate (model)
    call model_build(scene, threads, model, error)
    if (allocated(error)) return
    call bill_write(scene, model)
  end subroutine simulation_check

  !> Runs a scene from its initial state to its end.
  subroutine simulation_run(scene, options, threads, folder, error)
    type(scene_t), intent(in) :: scene
    type(command_line_t), intent(in) :: options
    integer, intent(in) :: threads
    character(*), intent(in) :: folder           !! where the files go
    type(error_t), allocatable, intent(out) :: error
    type(model_t), allocatable :: model
    type(outputs_t), allocatable :: outputs
    type(log_t) :: log
    type(error_t), allocatable :: problem
    real(dp) :: started, solving
    integer(i8) :: particle_steps
    started = wall_time()
    allocate (model, outputs)
    call directory_make(folder, error)
    if (allocated(error)) return
    call log%open(folder//'/run.log', log_level(options), error)
    if (allocated(error)) return
    call write_banner(log, scene, threads)
    call model_build(scene, threads, model, error)
    if (.not. allocated(error)) call outputs_open(outputs, scene, model, folder, error)
    if (allocated(error)) return
    call write_start(log, scene, model)
    model%timers = timers_t()
    solving = wall_time()
    particle_steps = 0_i8
    call time_loop(scene, model, outputs, log, particle_steps, error)
    solving = wall_time() - solving - model%timers%seconds(phase_output)
    call outputs_close(outputs, scene, model, problem)
    if (allocated(problem) .and. .not. allocated(error)) call move_alloc(problem, error)
    call write_end(log, scene, model, folder, threads, wall_time() - started, solving, particle_steps, error)
  end subroutine simulation_run

  !> Steps until the end, a stop condition or a failure.
  subroutine time_loop(scene, model, outputs, log, particle_steps, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    type(log_t), intent(inout) :: log
    integer(i8), intent(inout) :: particle_steps
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: target, started, shown
    logical :: ok
    started = wall_time()
    shown = started - 1.0e9_dp
    do while (.not. finished(scene, model))
      target = outputs_next_time(outputs, scene)
      call clock_choose(model%clock, model%mesh%h, model%fastest, target, ok)
      if (.not. ok) then
        call step_too_small(model, error)
        return
      end if
      call step_take(model)
      call clock_advance(model%clock, target)
      particle_steps = particle_steps + sum(int(model%bodies%particles%count, i8))
      call guard(scene, model)
      if (allocated(model%failure)) then
        call move_alloc(model%failure, error)
        return
      end if
      call timers_start(model%timers)
      call outputs_step(outputs, scene, model, .false., error)
      if (allocated(error)) return
      if (wall_time() - shown > 5.0_dp) then
        shown = wall_time()
        call log%step_row(log_row(scene, model, shown - started))
      end if
      call log%progress(progress(scene, model), model%clock%step, model%clock%time, &
                        remaining(scene, model, wall_time() - started))
      call timers_stop(model%timers, phase_output)
    end do
    call log%step_row(log_row(scene, model, wall_time() - started))
  end subroutine time_loop

  !> Whether the run has reached its end.
  pure function finished(scene, model) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical :: yes
    yes = model%clock%step >= scene%time%steps
    if (scene%time%end > 0.0_dp) yes = yes .or. model%clock%time >= scene%time%end*(1.0_dp - 1.0e-12_dp)
    if (model%clock%step > 0 .and. scene%stop%kinetic_below > 0.0_dp) &
      yes = yes .or. model%ledger%kinetic < scene%stop%kinetic_below*model%ledger%largest_kinetic
    yes = yes .or. sum(model%bodies%particles%count) == 0
  end function finished

  !> Energy growth beyond the deck's limit, or beyond all sense, is a failure.
  subroutine guard(scene, model)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    real(dp) :: total, reference
    if (allocated(model%failure)) return
    total = ledger_total(model%ledger)
    reference = max(abs(model%ledger%initial_total), abs(model%ledger%external_work))
    if (total /= total) then
      call error_make(model%failure, exit_numerical, 'the total energy is not a number in step '// &
                      integer_text(model%clock%step), 'reduce cfl; the last dump shows where it started')
    else if (total > reference .and. total/max(reference, tiny(1.0_dp)) > scene%stop%energy_growth .and. reference > 0.0_dp) then
      call error_make(model%failure, exit_numerical, 'the total energy has grown to '//real_text(total/reference)// &
                      ' times its reference in step '//integer_text(model%clock%step)//' at time '//real_text(model%clock%time), &
                      'reduce cfl (now '//real_text(model%clock%cfl)//'), or raise `stop energy_growth`')
    end if
  end subroutine guard

  !> The failure of a step below the lower bound, with what limits it.
  subroutine step_too_small(model, error)
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    call error_make(error, exit_numerical, 'the time step '//real_text(model%clock%dt_free)//' is below its minimum '// &
                    real_text(model%clock%smallest)//' in step '//integer_text(model%clock%step + 1)//'; particle '// &
                    integer_text(model%fastest_id)//' limits it with c + |v| = '//real_text(model%fastest), &
                    'look at that particle in the last dump; lower `time dt_min` if so small a step is meant')
  end subroutine step_too_small

  pure function progress(scene, model) result(fraction)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: fraction
    fraction = real(model%clock%step, dp)/real(scene%time%steps, dp)
    if (scene%time%end > 0.0_dp) fraction = max(fraction, model%clock%time/scene%time%end)
  end function progress

  pure function remaining(scene, model, elapsed) result(eta)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: elapsed
    real(dp) :: eta
    eta = elapsed*(1.0_dp/max(progress(scene, model), 1.0e-9_dp) - 1.0_dp)
  end function remaining

  !> A row of the log's table.
  function log_row(scene, model, elapsed) result(row)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: elapsed
    type(log_row_t) :: row
    row%step = model%clock%step
    row%time = model%clock%time
    row%dt = model%clock%dt
    row%limited_by = limit_names(model%clock%limited_by)
    if (model%clock%limited_by == limit_courant) row%limited_by = 'particle '//integer_text(int(model%fastest_id))
    row%kinetic = model%ledger%kinetic
    row%internal = model%ledger%internal
    row%total = ledger_total(model%ledger)
    row%drift = (row%total - model%ledger%initial_total - model%ledger%external_work) &
                /max(abs(model%ledger%initial_total), abs(row%total), tiny(1.0_dp))
    row%active_cells = sum(int(model%fields%points, i8))
    row%lost = int(model%lost, i8)
    row%fraction = progress(scene, model)
    row%eta = remaining(scene, model, elapsed)
  end function log_row

  pure function log_level(options) result(level)
    type(command_line_t), intent(in) :: options
    integer :: level
    level = level_normal
    if (options%quiet) level = level_quiet
    if (options%verbose) level = level_verbose
  end function log_level

  subroutine write_banner(log, scene, threads)
    type(log_t), intent(inout) :: log
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: threads
    call log%line('sgmp '//version_string//' ('//commit_hash//'), '//compiler_string//', 1 rank x '// &
                  integer_text(threads)//' threads')
    call log%line('deck '//scene%file//': '//scene%title)
    if (allocated(scene%resolved)) call log%line(scene%resolved, level_verbose)
  end subroutine write_banner

  subroutine write_start(log, scene, model)
    type(log_t), intent(inout) :: log
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    call log%line(integer_text(scene%dimension)//'D, '//trim(method_names(scene%method%kind))//'-'// &
                  trim(update_names(scene%method%update))//', '//integer_text(sum(model%bodies%particles%count))// &
                  ' particles, '//integer_text(sum(model%fields%points))//' grid points')
  end subroutine write_start

  !> Last lines of the log, and summary.json.
  subroutine write_end(log, scene, model, folder, threads, wall, solving, particle_steps, error)
    type(log_t), intent(inout) :: log
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(*), intent(in) :: folder
    integer, intent(in) :: threads
    real(dp), intent(in) :: wall, solving
    integer(i8), intent(in) :: particle_steps
    type(error_t), allocatable, intent(inout) :: error
    type(error_t), allocatable :: problem
    type(summary_t) :: summary
    real(dp) :: cost
    integer :: p
    cost = 1.0e9_dp*solving/max(real(particle_steps, dp), 1.0_dp)
    call log%phase_table(phase_names, model%timers%seconds, model%timers%seconds, model%timers%seconds, wall)
    call log%line(integer_text(model%clock%step)//' steps, '//real_text(cost)//' ns per particle-step, '// &
                  real_text(solving)//' s solving, '//real_text(real(peak_memory_bytes(), dp)/1048576.0_dp)//' MiB peak')
    if (model%lost > 0) call log%warning(integer_text(model%lost)//' particles left the grid and were removed')
    call summary%set('exit_status', exit_ok)
    if (allocated(error)) then
      call summary%set('exit_status', error%code)
      call summary%set('failure', error%message)
      call log%line('FAILED: '//error%message)
    end if
    call summary%set('version', version_string)
    call summary%set('commit', commit_hash)
    call summary%set('deck', scene%file)
    call summary%set('title', scene%title)
    call summary%set('method', trim(method_names(scene%method%kind)))
    call summary%set('update', trim(update_names(scene%method%update)))
    call summary%set('dimension', scene%dimension)
    call summary%set('cfl', scene%time%cfl)
    call summary%set('h', scene%grid%cell)
    call summary%set('spacing', model%bodies(1)%spacing)
    call summary%set('particles', sum(model%bodies%particles%count))
    call summary%set('particles_lost', model%lost)
    call summary%set('grid_points', sum(model%fields%points))
    call summary%set('steps', model%clock%step)
    call summary%set('time', model%clock%time)
    call summary%set('particle_steps', particle_steps)
    call summary%set('wall_seconds', wall)
    call summary%set('solve_seconds', solving)
    call summary%set('ns_per_particle_step', cost)
    call summary%set('ranks', 1)
    call summary%set('threads', threads)
    call summary%set('peak_memory_bytes', peak_memory_bytes())
    call summary%set('checksum', checksum_text(gather_checksum(model)))
    call summary%set('units.length', trim(scene%units(1)))
    call summary%set('units.mass', trim(scene%units(2)))
    call summary%set('units.time', trim(scene%units(3)))
    call summary%set('energy.kinetic', model%ledger%kinetic)
    call summary%set('energy.internal', model%ledger%internal)
    call summary%set('energy.total', ledger_total(model%ledger))
    call summary%set('energy.initial_total', model%ledger%initial_total)
    call summary%set('energy.external_work', model%ledger%external_work)
    call summary%set('energy.viscous_dissipation', model%ledger%viscous_dissipation)
    call summary%set('energy.interpolation_error', model%ledger%interpolation_error)
    call summary%set('energy.predicted_error', model%ledger%predicted)
    call summary%set('energy.remainder', model%ledger%remainder)
    do p = 1, phase_count
      call summary%set('phase_seconds.'//trim(phase_names(p)), model%timers%seconds(p))
    end do
    call summary%write(folder//'/summary.json', problem)
    if (allocated(problem) .and. .not. allocated(error)) call move_alloc(problem, error)
    call log%close(problem)
    if (allocated(problem) .and. .not. allocated(error)) call move_alloc(problem, error)
  end subroutine write_end

end module sgmp_simulation
