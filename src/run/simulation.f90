!> A run: time loop, guards, output, log and summary.
module sgmp_simulation
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sgmp_advice, only: advice_find, advice_of_output
  use sgmp_balancing, only: balancing_look
  use sgmp_body, only: body_number, body_particle
  use sgmp_build_model, only: model_build
  use sgmp_checkpoint, only: checkpoint_bytes, checkpoint_path, checkpoint_set_aside, &
                             checkpoint_write
  use sgmp_command_line, only: command_line_t
  use sgmp_cost_estimate, only: cost_estimate_write, cost_estimate_write_advice, &
                                cost_estimate_write_need, cost_estimate_write_time
  use sgmp_energy, only: ledger_drift, ledger_drift_beyond, ledger_total
  use sgmp_errors, only: error_make, error_t, exit_io, exit_numerical, exit_stopped
  use sgmp_forewarnings, only: forewarnings_find
  use sgmp_formula_faults, only: formula_faults_name
  use sgmp_kinds, only: dp, i8
  use sgmp_memory_need, only: memory_need_here, memory_refuse
  use sgmp_model, only: model_t
  use sgmp_model_checksum, only: model_checksum
  use sgmp_outputs, only: outputs_close, outputs_flush, outputs_next_time, outputs_open, &
                          outputs_step, outputs_stop, outputs_t
  use sgmp_parallel, only: parallel_agree, parallel_any, parallel_rank, parallel_ranks
  use sgmp_report, only: effort_share, effort_t, report_balance, report_banner, report_courant, &
                         report_end, report_fraction, report_level, report_remaining, report_row, &
                         report_start, summary_write
  use sgmp_restart, only: restart_find, restart_read
  use sgmp_run_folder, only: run_folder_clear, run_folder_open
  use sgmp_run_log, only: log_t
  use sgmp_scene, only: scene_t
  use sgmp_spelling, only: string_t
  use sgmp_stability, only: stability_choose
  use sgmp_stages, only: stage_guard
  use sgmp_step, only: step_take
  use sgmp_stopping, only: stopping_t
  use sgmp_text, only: integer_text, real_text
  use sgmp_thread_choice, only: thread_choice_t
  use sgmp_time_step, only: clock_advance, clock_choose, clock_t
  use sgmp_timers, only: phase_end, phase_grid, phase_output, phase_probe, phase_start, &
                         timers_stop, timers_t, wall_time
  use sgmp_trial, only: trial_t, trial_take
  use sgmp_update, only: update_usf
  use sgmp_verdict, only: verdict_t
  implicit none
  private
  public :: simulation_run, simulation_check, simulation_try

  ! Energy over what was given at which a run ends, where the deck does not say.
  real(dp), parameter :: beginning = 0.05_dp     !! part of the run
  integer, parameter :: first_steps = 200        !! that belong to the beginning of any
  real(dp), parameter :: growth_at_first = 10.0_dp, growth_later = 1.1_dp

contains

  !> Prints what a scene will cost, by a trial of some steps; writes no file.
  subroutine simulation_check(scene, threads, error)
    type(scene_t), intent(in) :: scene
    type(thread_choice_t), intent(inout) :: threads
    type(error_t), allocatable, intent(out) :: error
    type(model_t), allocatable :: model
    type(string_t), allocatable :: warnings(:), advice(:)
    type(trial_t) :: trial
    real(dp) :: need, available
    integer(i8) :: particles
    logical :: speaks
    integer :: w
    call memory_need_here(scene, need, available, error)
    if (allocated(error)) return
    if (parallel_any(need > 0.5_dp*available)) then
      if (parallel_rank() == 0) call cost_estimate_write_need(scene, need, available)
      return
    end if
    call threads%choose(scene)
    allocate (model)
    call model_build(scene, threads%threads, model, error)
    call parallel_agree(error)
    if (allocated(error)) return
    call stability_choose(model)
    call forewarnings_find(scene, model, warnings)
    call advice_find(scene, model, advice)
    particles = sum(model%totals%particles)
    speaks = parallel_rank() == 0
    if (speaks) call cost_estimate_write(scene, model)
    call trial_take(scene, model, trial)
    if (.not. speaks) return
    call cost_estimate_write_time(trial, model, particles)
    call cost_estimate_write_advice([advice, advice_of_output(scene, trial, particles)])
    if (trial%failure /= '') write (error_unit, '(a)') 'warning: '//trial%failure
    do w = 1, size(warnings)
      write (error_unit, '(a)') 'warning: '//warnings(w)%text
    end do
  end subroutine simulation_check

  !> Builds a scene's model and forgets it: an error where that cannot be. What needs over half of
  !! the memory is not built.
  subroutine simulation_try(scene, threads, error)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: threads
    type(error_t), allocatable, intent(out) :: error
    type(model_t), allocatable :: model
    real(dp) :: need, available
    call memory_need_here(scene, need, available, error)
    if (allocated(error)) return
    if (parallel_any(need > 0.5_dp*available)) return
    allocate (model)
    call model_build(scene, threads, model, error)
    call parallel_agree(error)
  end subroutine simulation_try

  !> Runs a scene from its initial state, or a checkpoint, to its end.
  subroutine simulation_run(scene, options, threads, folder, started, error)
    type(scene_t), intent(in) :: scene
    type(command_line_t), intent(in) :: options
    type(thread_choice_t), intent(inout) :: threads
    character(*), intent(in) :: folder           !! where the files go
    real(dp), intent(in) :: started              !! wall time at which the program started
    type(error_t), allocatable, intent(out) :: error
    type(model_t), allocatable :: model
    type(outputs_t), allocatable :: outputs
    type(log_t) :: log
    type(error_t), allocatable :: problem
    type(effort_t) :: effort
    type(stopping_t) :: stopping
    type(verdict_t) :: verdict
    integer(i8) :: checksum
    real(dp) :: solving
    allocate (model, outputs)
    call memory_refuse(scene, error)
    if (allocated(error)) return
    call threads%choose(scene)
    effort%threads = threads
    call run_folder_open(folder, error)
    if (allocated(error)) return
    call open_log(log, folder, options, error)
    if (allocated(error)) return
    call report_banner(log, scene, threads)
    call begin(scene, options, threads%threads, folder, log, model, outputs, effort, error)
    call parallel_agree(error)
    if (allocated(error)) return
    call report_start(log, scene, model)
    call stopping%start(started, options%time_limit, scene%checkpoint, folder, &
                        real(checkpoint_bytes(model), dp))
    model%timers = timers_t(started=started)
    call timers_stop(model%timers, phase_start)
    solving = wall_time()
    call time_loop(scene, model, outputs, log, stopping, effort, error)
    effort%solving = wall_time() - solving - model%timers%seconds(phase_output)
    if (allocated(error)) then
      if (any(error%code == [exit_stopped, exit_io])) then
        if (parallel_rank() == 0) call outputs_stop(outputs, problem)
        call parallel_agree(problem)
      else
        call outputs_close(outputs, scene, model, problem)
      end if
    else
      call outputs_close(outputs, scene, model, problem)
    end if
    if (allocated(problem) .and. .not. allocated(error)) call move_alloc(problem, error)
    call timers_stop(model%timers, phase_output)
    call verdict%reach(scene, model, error)
    checksum = model_checksum(model)
    call timers_stop(model%timers, phase_end)
    effort%wall = wall_time() - started
    call effort_share(effort, model)
    call report_end(log, model, effort, verdict, error)
    call summary_write(scene, model, effort, verdict, checksum, log, folder//'/summary.json', error)
    call log%close(problem)
    if (allocated(problem) .and. .not. allocated(error)) call move_alloc(problem, error)
  end subroutine simulation_run

  !> Opens the log, on the first rank.
  subroutine open_log(log, folder, options, error)
    type(log_t), intent(inout) :: log
    character(*), intent(in) :: folder
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    if (parallel_rank() == 0) then
      call log%open(folder//'/run.log', report_level(options), error, options%restart /= '')
    end if
    call parallel_agree(error)
  end subroutine open_log

  !> The model and the files as they are at the start: new, or from the checkpoint asked for.
  subroutine begin(scene, options, threads, folder, log, model, outputs, effort, error)
    type(scene_t), intent(in) :: scene
    type(command_line_t), intent(in) :: options
    integer, intent(in) :: threads
    character(*), intent(in) :: folder
    type(log_t), intent(inout) :: log
    type(model_t), intent(out) :: model
    type(outputs_t), intent(inout) :: outputs
    type(effort_t), intent(inout) :: effort
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: started
    started = wall_time()
    effort%restart = ''
    if (options%restart /= '') then
      call restart_find(options%restart, folder, log, effort%restart, error)
      if (allocated(error)) return
      if (effort%restart == '') call log%warning("no checkpoint in '"//folder// &
                                                 "': starting from the beginning")
    end if
    if (effort%restart == '') then
      call model_build(scene, threads, model, error)
      call parallel_agree(error)
      if (.not. allocated(error)) call run_folder_clear(folder, error)
    else
      call restart_read(effort%restart, scene, threads, model, outputs, &
                        effort%earlier_particle_steps, error)
      if (allocated(error)) return
      call checkpoint_set_aside(folder, int(model%clock%step, i8), error)
      call log%line("restarted from '"//effort%restart//"': step "// &
                    integer_text(model%clock%step)//', time '//real_text(model%clock%time)//', '// &
                    real_text(wall_time() - started)//' s')
    end if
    if (allocated(error)) return
    call outputs_open(outputs, scene, model, folder, error, effort%restart /= '')
  end subroutine begin

  !> Steps until the end, a stop condition, a stop that was asked for, or a failure.
  subroutine time_loop(scene, model, outputs, log, stopping, effort, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    type(log_t), intent(inout) :: log
    type(stopping_t), intent(inout) :: stopping
    type(effort_t), intent(inout) :: effort
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: target, started, shown, before
    logical :: ok, last
    started = wall_time()
    before = report_fraction(scene, model)
    shown = started - 1.0e9_dp
    do while (.not. finished(scene, model))
      target = outputs_next_time(outputs, scene)
      call look_ahead(scene, model, log)
      call clock_choose(model%clock, model%mesh%h, model%findings%fastest, target, ok)
      if (.not. ok) then
        call step_too_small(scene, model, error)
        return
      end if
      call step_take(model)
      call clock_advance(model%clock, target)
      effort%particle_steps = effort%particle_steps + sum(model%totals%particles)
      call guard(scene, model)
      call note_motion(scene, model)
      if (allocated(model%findings%failure)) then
        call move_alloc(model%findings%failure, error)
        call formula_faults_name(scene, model%clock%time, error)
        return
      end if
      call timers_stop(model%timers, phase_grid)
      call outputs_step(outputs, scene, model, .false., error)
      if (allocated(error)) return
      if (wall_time() - shown > 5.0_dp) then
        shown = wall_time()
        call log%step_row(report_row(scene, model, shown - started, before))
      end if
      call log%progress(report_fraction(scene, model), model%clock%step, model%clock%time, &
                        report_remaining(scene, model, wall_time() - started, before))
      last = finished(scene, model)
      if (stopping%look(model%clock%step) .or. (last .and. wants_checkpoints(scene))) then
        call save(scene, model, outputs, log, stopping, effort, error)
        if (allocated(error)) return
      end if
      call timers_stop(model%timers, phase_output)
      if (stopping%stops() .and. .not. last) then
        call error_make(error, exit_stopped, 'stopped by '//stopping%reason()//' in step '// &
                        integer_text(model%clock%step), 'go on with --restart latest')
        return
      end if
    end do
    call log%step_row(report_row(scene, model, wall_time() - started, before))
  end subroutine time_loop

  !> Before a step: who does which part of it, and how long it may be.
  subroutine look_ahead(scene, model, log)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(log_t), intent(inout) :: log
    logical :: found
    call balancing_look(model, scene%balance, found)
    if (found) call log%line(report_balance(model))
    call stability_choose(model, found)
    if (found) call log%line(report_courant(model))
    call timers_stop(model%timers, phase_probe)
  end subroutine look_ahead

  pure function wants_checkpoints(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    yes = scene%checkpoint%every > 0 .or. scene%checkpoint%minutes > 0.0_dp
  end function wants_checkpoints

  !> Writes a checkpoint, with all that it counts on in the other files.
  subroutine save(scene, model, outputs, log, stopping, effort, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    type(log_t), intent(inout) :: log
    type(stopping_t), intent(inout) :: stopping
    type(effort_t), intent(inout) :: effort
    type(error_t), allocatable, intent(out) :: error
    integer(i8) :: particle_steps
    real(dp) :: started
    started = wall_time()
    particle_steps = effort%earlier_particle_steps + effort%particle_steps
    call outputs_flush(outputs, error)
    call parallel_agree(error)
    if (.not. allocated(error)) call checkpoint_write(scene, model, outputs, particle_steps, &
                                                      outputs%folder, error)
    if (allocated(error)) return
    call stopping%written(wall_time() - started)
    call log%line('checkpoint of step '//integer_text(model%clock%step)//' at time '// &
                  real_text(model%clock%time)//', '//real_text(wall_time() - started)//' s')
  end subroutine save

  !> Whether the run has reached its end.
  pure function finished(scene, model) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical :: yes
    yes = model%clock%step >= scene%time%steps
    if (scene%time%end > 0.0_dp) then
      yes = yes .or. model%clock%time >= scene%time%end*(1.0_dp - 1.0e-12_dp)
    end if
    if (model%clock%step > 0 .and. scene%stop%kinetic_below > 0.0_dp) then
      yes = yes .or. model%ledger%kinetic < scene%stop%kinetic_below*model%ledger%largest_kinetic
    end if
    if (scene%stop%at_rest > 0.0_dp .and. model%clock%time > model%ledger%moving_until) then
      yes = yes .or. model%clock%time - model%ledger%moving_until >= scene%stop%hold
    end if
    yes = yes .or. sum(model%totals%particles) == 0_i8
  end function finished

  !> Notes that the scene is not at rest yet.
  subroutine note_motion(scene, model)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    associate (kinetic => model%ledger%kinetic, total => ledger_total(model%ledger))
      if (model%clock%time >= scene%stop%after .and. kinetic < scene%stop%at_rest*total) return
      model%ledger%moving_until = model%clock%time
    end associate
  end subroutine note_motion

  !> Energy from nowhere beyond the deck's limit, or beyond all sense, is a failure. Not in the
  !! first step: what matter gives away as it expands from rest is booked from the second on. Nor
  !! where a rigid body has only just met what rests: the first strain is booked before its work.
  subroutine guard(scene, model)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    real(dp) :: drift, gained
    if (allocated(model%findings%failure)) return
    drift = ledger_drift(model%ledger)
    call stage_guard(model)
    if (allocated(model%findings%failure)) return
    if (drift /= drift) then
      call error_make(model%findings%failure, exit_numerical, &
                      'the total energy is not a number in step '// &
                      integer_text(model%clock%step), &
                      'reduce cfl; the last dump shows where it started')
      return
    end if
    gained = ledger_drift_beyond(model%ledger)*model%ledger%supplied
    if (model%clock%step > 1 .and. model%ledger%supplied > 0.0_dp .and. &
        gained > (most_growth(scene, model%clock) - 1.0_dp)* &
        max(model%ledger%supplied, carried_energy(model))) then
      call error_make(model%findings%failure, exit_numerical, 'the energy has grown to '// &
                      real_text(1.0_dp + drift)//' times the input energy in step '// &
                      integer_text(model%clock%step)//' at time '// &
                      real_text(model%clock%time)//'; the fastest is '// &
                      fastest_particle(scene, model), &
                      'reduce cfl (now '//real_text(model%clock%cfl)// &
                      '), or raise `stop energy_growth`')
    end if
  end subroutine guard

  !> A small part of the energy that all that is not rigid would have as fast as the fastest rigid
  !! body: less than such a body gives once it has pushed the rest for a while.
  pure function carried_energy(model) result(energy)
    type(model_t), intent(in) :: model
    real(dp) :: energy
    real(dp), parameter :: part = 1.0e-3_dp
    real(dp) :: mass, speed2
    integer :: b
    mass = 0.0_dp
    speed2 = 0.0_dp
    do b = 1, size(model%bodies)
      associate (own => model%totals%bodies(b))
        if (.not. model%bodies(b)%rigid) then
          mass = mass + own%mass
        else if (own%mass > 0.0_dp) then
          speed2 = max(speed2, 2.0_dp*own%kinetic/own%mass)
        end if
      end associate
    end do
    energy = part*0.5_dp*mass*speed2
  end function carried_energy

  !> How many times the energy given there may be. Where the deck does not say, more is forgiven to
  !! the start of a run, where energies at half steps are compared with the little that was given so
  !! far, and to USF, whose stresses and velocities belong to different times.
  pure function most_growth(scene, clock) result(growth)
    type(scene_t), intent(in) :: scene
    type(clock_t), intent(in) :: clock
    real(dp) :: growth
    logical :: begins
    begins = .true.
    if (scene%time%end > 0.0_dp) begins = clock%time < beginning*scene%time%end
    begins = (begins .and. clock%step < beginning*scene%time%steps) .or. clock%step < first_steps
    growth = merge(growth_at_first, growth_later, begins .or. scene%method%update == update_usf)
    if (scene%stop%energy_growth > 0.0_dp) growth = scene%stop%energy_growth
  end function most_growth

  !> The failure of a step below the lower bound, with what limits it.
  subroutine step_too_small(scene, model, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    call error_make(error, exit_numerical, 'the time step '//real_text(model%clock%dt_free)// &
                    ' is below its minimum '//real_text(model%clock%smallest)//' in step '// &
                    integer_text(model%clock%step + 1)//'; '//fastest_particle(scene, model)// &
                    ' limits it with c + |v| = '// &
                    real_text(model%findings%fastest), &
                    'look at that particle in the last dump; lower `time dt_min` if so small a '// &
                    'step is meant')
  end subroutine step_too_small

  !> The fastest particle, with its body and material.
  pure function fastest_particle(scene, model) result(text)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    integer :: b
    b = body_number(model%bodies, model%findings%fastest_id)
    text = body_particle(model%bodies, model%findings%fastest_id)// &
           ' ('//trim(scene%materials(scene%bodies(b)%material)%name)//')'
  end function fastest_particle

end module sgmp_simulation
