!> What a run says of itself: the lines of its log and summary.json.
module sgmp_report
  use sgmp_body, only: body_given_id, body_number
  use sgmp_body_rows, only: momentum_in_output
  use sgmp_checksum, only: checksum_text
  use sgmp_command_line, only: command_line_t
  use sgmp_energy, only: ledger_drift, ledger_total
  use sgmp_energy_terms, only: energy_term_t, terms_value
  use sgmp_errors, only: error_t, exit_ok, exit_stopped
  use sgmp_features, only: features_split_limit
  use sgmp_forewarnings, only: forewarnings_find, gas_enclosed
  use sgmp_grid_fit, only: grid_fit_moved
  use sgmp_kernels, only: kernel_sgmp, method_names
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_collect, parallel_ranks, parallel_sum
  use sgmp_process, only: peak_memory_bytes
  use sgmp_run_log, only: level_normal, level_quiet, level_verbose, log_row_t, log_t
  use sgmp_scene, only: scene_t
  use sgmp_spelling, only: string_t
  use sgmp_summary, only: summary_t
  use sgmp_text, only: integer_text, real_text
  use sgmp_thread_choice, only: thread_choice_t
  use sgmp_time_step, only: limit_courant, limit_names
  use sgmp_timers, only: phase_balance, phase_count, phase_halo, phase_names
  use sgmp_update, only: update_names
  use sgmp_verdict, only: verdict_t
  use sgmp_version, only: commit_hash, compiler_string, version_string
  use sgmp_walls_apart, only: walls_apart_lines
  implicit none
  private
  public :: effort_t, effort_share, report_balance, report_banner, report_courant, report_end, &
            report_fraction, report_level, report_remaining, report_row, report_start, &
            summary_write

  !> What a run has cost.
  type :: effort_t
    type(thread_choice_t) :: threads
    real(dp) :: wall = 0.0_dp              !! wall seconds since the program started
    real(dp) :: solving = 0.0_dp           !! wall seconds in the time loop, output left out
    real(dp) :: cpu = 0.0_dp               !! CPU seconds of all threads and ranks
    integer(i8) :: particle_steps = 0_i8   !! sum of the particles over the steps
    integer(i8) :: earlier_particle_steps = 0_i8  !! the same, before the restart
    character(:), allocatable :: restart   !! checkpoint that the run went on from, or ''
    integer(i8) :: memory = 0_i8           !! peak of all ranks together (bytes)
    ! seconds in each phase: least, mean and most of all ranks
    real(dp) :: least(phase_count) = 0.0_dp
    real(dp) :: mean(phase_count) = 0.0_dp, most(phase_count) = 0.0_dp
    real(dp) :: messages = 0.0_dp, bytes = 0.0_dp  !! between neighbours, of the rank that sent most
  end type effort_t

contains

  !> Puts the ranks' efforts together.
  subroutine effort_share(effort, model)
    type(effort_t), intent(inout) :: effort
    type(model_t), intent(in) :: model
    real(dp), allocatable :: own(:), others(:), all(:, :)
    real(dp) :: cpu
    integer(i8) :: memory
    memory = peak_memory_bytes()
    effort%memory = parallel_sum(memory)
    call cpu_time(cpu)
    own = [model%timers%seconds, real(model%ranks%traffic%messages, dp), &
           real(model%ranks%traffic%bytes, dp), cpu]
    call parallel_collect(own, others)
    all = reshape([own, others], [size(own), model%ranks%partition%ranks])
    effort%least = minval(all(:phase_count, :), dim=2)
    effort%mean = sum(all(:phase_count, :), dim=2)/model%ranks%partition%ranks
    effort%most = maxval(all(:phase_count, :), dim=2)
    effort%messages = maxval(all(phase_count + 1, :))
    effort%bytes = maxval(all(phase_count + 2, :))
    effort%cpu = sum(all(phase_count + 3, :))
  end subroutine effort_share

  !> How much the log shows on the terminal.
  pure function report_level(options) result(level)
    type(command_line_t), intent(in) :: options
    integer :: level
    level = level_normal
    if (options%quiet) level = level_quiet
    if (options%verbose) level = level_verbose
  end function report_level

  !> First lines of the log: program, deck, and with `--verbose` the deck with all defaults.
  subroutine report_banner(log, scene, threads)
    type(log_t), intent(inout) :: log
    type(scene_t), intent(in) :: scene
    type(thread_choice_t), intent(in) :: threads
    call log%line('sgmp '//version_string//' ('//commit_hash//'), '//compiler_string// &
                  ', '//integer_text(parallel_ranks())//' '// &
                  trim(merge('rank ', 'ranks', parallel_ranks() == 1))//' x '// &
                  integer_text(threads%threads)// &
                  trim(merge(' thread ', ' threads', threads%threads == 1))//thread_reason(threads))
    call log%line('deck '//scene%file//': '//scene%title)
    if (allocated(scene%resolved)) call log%line(scene%resolved, level_verbose)
  end subroutine report_banner

  !> Why fewer threads are taken than may be.
  pure function thread_reason(threads) result(text)
    type(thread_choice_t), intent(in) :: threads
    character(:), allocatable :: text
    text = ''
    if (threads%threads < threads%most) text = ' of '//integer_text(threads%most)//' ('// &
                                               threads%reason//')'
  end function thread_reason

  !> What is about to run.
  subroutine report_start(log, scene, model)
    type(log_t), intent(inout) :: log
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable :: warnings(:), moved(:)
    integer :: w
    if (allocated(scene%warnings)) then
      do w = 1, size(scene%warnings)
        call log%note_warning(scene%warnings(w)%text)
      end do
    end if
    moved = grid_fit_moved(scene)
    do w = 1, size(moved)
      call log%line(moved(w)%text)
    end do
    moved = walls_apart_lines(scene)
    do w = 1, size(moved)
      call log%line(moved(w)%text)
    end do
    call log%line(space_text(scene)//', '// &
                  trim(method_names(scene%method%kind))//'-'// &
                  trim(update_names(scene%method%update))//', '// &
                  integer_text(sum(model%totals%particles))//' particles, '// &
                  integer_text(model%totals%points)//' grid points')
    if (gas_enclosed(model) .and. model%fields(1)%kernel == kernel_sgmp) then
      call log%line('gas enclosed by walls: where it has free surfaces the volumes of its '// &
                    'particles drift; volumes=kept keeps them (doc/volumes.md)')
    end if
    call forewarnings_find(scene, model, warnings)
    do w = 1, size(warnings)
      call log%warning(warnings(w)%text)
    end do
  end subroutine report_start

  !> What a scene is computed in.
  pure function space_text(scene) result(text)
    type(scene_t), intent(in) :: scene
    character(:), allocatable :: text
    text = integer_text(scene%dimension)//'D'
    if (scene%axisymmetric) text = 'axisymmetric'
  end function space_text

  !> The Courant number that the program has found.
  function report_courant(model) result(line)
    type(model_t), intent(in) :: model
    character(:), allocatable :: line
    line = 'cfl = '//real_text(model%clock%cfl)//' from step '// &
           integer_text(model%clock%step + 1)//' on; the limit with resting particles is '// &
           real_text(model%clock%limit)
  end function report_courant

  !> The part of the run that is done, 0 to 1.
  pure function report_fraction(scene, model) result(fraction)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: fraction
    fraction = real(model%clock%step, dp)/real(scene%time%steps, dp)
    if (scene%time%end > 0.0_dp) fraction = max(fraction, model%clock%time/scene%time%end)
  end function report_fraction

  !> Seconds that the rest of the run takes if it goes on like this.
  pure function report_remaining(scene, model, elapsed, before) result(eta)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: elapsed              !! seconds spent since the start or restart
    real(dp), intent(in) :: before               !! part of the run that was done then
    real(dp) :: eta, done
    done = report_fraction(scene, model)
    eta = elapsed*(1.0_dp - done)/max(done - before, 1.0e-9_dp)
  end function report_remaining

  !> The line about new cuts between ranks.
  function report_balance(model) result(line)
    type(model_t), intent(in) :: model
    character(:), allocatable :: line
    line = 'step '//integer_text(model%clock%step)//': cuts between ranks moved for the '// &
           integer_text(model%ranks%balance%cuts)//'. time, most particles on a rank now '// &
           real_text(model%ranks%balance%imbalance)//' of the mean'
  end function report_balance

  !> A row of the log's table.
  function report_row(scene, model, elapsed, before) result(row)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: elapsed, before      !! see report_remaining
    type(log_row_t) :: row
    row%step = model%clock%step
    row%time = model%clock%time
    row%dt = model%clock%dt
    row%limited_by = limit_names(model%clock%limited_by)
    if (model%clock%limited_by == limit_courant) then
      associate (id => model%findings%fastest_id)
        row%limited_by = 'particle '//integer_text(body_given_id( &
                         model%bodies(body_number(model%bodies, id)), id))
      end associate
    end if
    row%kinetic = model%ledger%kinetic
    row%internal = model%ledger%internal
    row%total = ledger_total(model%ledger)
    row%drift = ledger_drift(model%ledger)
    row%active_cells = model%totals%points
    row%lost = int(model%findings%lost, i8)
    row%fraction = report_fraction(scene, model)
    row%eta = report_remaining(scene, model, elapsed, before)
  end function report_row

  !> Last lines of the log: where the time went, what it cost, how it ended.
  subroutine report_end(log, model, effort, verdict, error)
    type(log_t), intent(inout) :: log
    type(model_t), intent(in) :: model
    type(effort_t), intent(in) :: effort
    type(verdict_t), intent(in) :: verdict
    type(error_t), allocatable, intent(in) :: error  !! what ended the run early
    call log%phase_table(phase_names, effort%least, effort%mean, effort%most, effort%wall)
    call log%line(integer_text(model%clock%step)//' steps, '//real_text(cost(effort))// &
                  ' ns per particle-step, '//real_text(effort%solving)//' s solving, '// &
                  real_text(effort%cpu)//' s of CPU in all, '// &
                  real_text(real(effort%memory, dp)/1048576.0_dp)//' MiB peak')
    if (model%ranks%partition%ranks > 1) then
      call log%line('halo: '//real_text(effort%messages/max(model%clock%step, 1))// &
                    ' messages and '//real_text(effort%bytes/max(model%clock%step, 1))// &
                    ' bytes per step from the rank that sends most')
    end if
    if (model%findings%lost > 0) then
      call log%warning(integer_text(model%findings%lost)// &
                       ' particles left the grid and were removed')
    end if
    if (model%method%removes) then
      associate (terms => model%ledger%terms)
        call log%line(integer_text(nint(terms_value(terms, 'removed.particles'), i8))// &
                      ' particles were removed by cards remove, of mass '// &
                      real_text(terms_value(terms, 'removed.mass'))//' and energy '// &
                      real_text(terms_value(terms, 'removed.kinetic_energy') + &
                                terms_value(terms, 'removed.internal_energy')))
      end associate
    end if
    if (model%method%erodes) then
      associate (terms => model%ledger%terms)
        call log%line(integer_text(nint(terms_value(terms, 'eroded.particles'), i8))// &
                      ' particles were eroded, of mass '// &
                      real_text(terms_value(terms, 'eroded.mass'))//' and energy '// &
                      real_text(terms_value(terms, 'eroded.kinetic_energy') + &
                                terms_value(terms, 'eroded.internal_energy')))
      end associate
    end if
    call verdict%report(log)
    if (.not. allocated(error)) return
    if (error%code == exit_stopped) then
      call log%line(error%message)
    else
      call log%line('FAILED: '//error%message)
    end if
  end subroutine report_end

  !> Nanoseconds per particle and step.
  pure function cost(effort) result(nanoseconds)
    type(effort_t), intent(in) :: effort
    real(dp) :: nanoseconds
    nanoseconds = 1.0e9_dp*effort%solving/max(real(effort%particle_steps, dp), 1.0_dp)
  end function cost

  !> Writes summary.json; a failure to do so becomes `error` if there is none yet.
  subroutine summary_write(scene, model, effort, verdict, checksum, log, path, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(effort_t), intent(in) :: effort
    type(verdict_t), intent(in) :: verdict
    integer(i8), intent(in) :: checksum          !! of the model
    type(log_t), intent(in) :: log
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(inout) :: error  !! what ended the run early
    type(error_t), allocatable :: problem
    type(summary_t) :: summary
    call summary%set('exit_status', exit_ok)
    if (allocated(error)) then
      call summary%set('exit_status', error%code)
      call summary%set('failure', error%message)
    end if
    call verdict%summarise(summary)
    if (allocated(log%warnings)) call summary%set('warnings', log%warnings)
    call summarise_scene(summary, scene, model)
    call summarise_effort(summary, model, effort)
    call summary%set('checksum', checksum_text(checksum))
    call summarise_energy(summary, model)
    if (model%ranks%partition%rank == 0) call summary%write(path, problem)
    call parallel_agree(problem)
    if (allocated(problem) .and. .not. allocated(error)) call move_alloc(problem, error)
  end subroutine summary_write

  !> Program, deck, method and sizes.
  subroutine summarise_scene(summary, scene, model)
    type(summary_t), intent(inout) :: summary
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    call summary%set('version', version_string)
    call summary%set('commit', commit_hash)
    call summary%set('deck', scene%file)
    call summary%set('title', scene%title)
    call summary%set('method', trim(method_names(scene%method%kind)))
    call summary%set('update', trim(update_names(scene%method%update)))
    call summary%set('stress', trim(merge('normalised', 'plain     ', &
                                          any(model%fields%columns%volume > 0))))
    call summary%set('rotation', trim(merge('exact', 'plain', &
                                            any(model%fields%columns%turns))))
    call summary%set('surfaces', trim(merge('corrected', 'plain    ', &
                                            any(model%fields%columns%corrected))))
    call summary%set('mass', trim(merge('consistent', 'lumped    ', &
                                        any(model%fields%columns%consistent))))
    call summary%set('volumes', volumes_word(model))
    call summary%set('drift', trim(merge('remapped', 'plain   ', &
                                         any(model%fields%columns%remapped))))
    call summary%set('split_limit', features_split_limit(scene%features))
    call summary%set('contact', contact_word(scene))
    call summary%set('walls_shifted', count(scene%grid%shifted))
    call summary%set('walls_let_go', count(scene%grid%one_sided))
    if (scene%axisymmetric) then
      call summary%set('dimension', 'axisymmetric')
    else
      call summary%set('dimension', scene%dimension)
    end if
    call summary%set('cfl', model%clock%cfl)
    call summary%set('cfl_limit', model%clock%limit)
    call summary%set('h', scene%grid%cell)
    call summary%set('spacing', model%bodies(1)%spacing)
    call summary%set('particles', sum(model%totals%particles))
    call summary%set('particles_lost', model%findings%lost)
    call summary%set('grid_points', model%totals%points)
    call summary%set('units.length', trim(scene%units(1)))
    call summary%set('units.mass', trim(scene%units(2)))
    call summary%set('units.time', trim(scene%units(3)))
  end subroutine summarise_scene

  !> What the volumes of particles are (doc/volumes.md).
  pure function volumes_word(model) result(word)
    type(model_t), intent(in) :: model
    character(:), allocatable :: word
    word = 'plain'
    if (any(model%bodies%matched)) word = 'matched'
    if (model%method%relaxed) word = 'kept'
  end function volumes_word

  !> Where contact comes from.
  pure function contact_word(scene) result(word)
    type(scene_t), intent(in) :: scene
    character(:), allocatable :: word
    word = 'deck'
    if (size(scene%contacts) == 0) then
      word = 'none'
    else if (any(scene%contacts%unasked)) then
      word = 'default'
    end if
  end function contact_word

  !> Steps, seconds and bytes.
  subroutine summarise_effort(summary, model, effort)
    type(summary_t), intent(inout) :: summary
    type(model_t), intent(in) :: model
    type(effort_t), intent(in) :: effort
    real(dp) :: total
    integer :: k
    call summary%set('steps', model%clock%step)
    call summary%set('time', model%clock%time)
    call summary%set('particle_steps', effort%earlier_particle_steps + effort%particle_steps)
    call summary%set('restarted_from', effort%restart)
    call summary%set('wall_seconds', effort%wall)
    call summary%set('cpu_seconds', effort%cpu)
    call summary%set('solve_seconds', effort%solving)
    call summary%set('ns_per_particle_step', cost(effort))
    call summary%set('ranks', model%ranks%partition%ranks)
    call summary%set('threads', effort%threads%threads)
    call summary%set('threads_allowed', effort%threads%most)
    call summary%set('threads_reason', effort%threads%reason)
    call summary%set('peak_memory_bytes', effort%memory)
    total = max(sum(effort%mean), tiny(total))
    do k = 1, phase_count
      call summary%set('phase_seconds.'//trim(phase_names(k)), effort%mean(k))
    end do
    do k = 1, phase_count
      call summary%set('phase_percent.'//trim(phase_names(k)), 100.0_dp*effort%mean(k)/total)
    end do
    if (model%ranks%partition%ranks == 1) return
    call summary%set('halo.share', effort%mean(phase_halo)/max(effort%solving, tiny(1.0_dp)))
    call summary%set('halo.messages_per_step', effort%messages/max(model%clock%step, 1))
    call summary%set('halo.bytes_per_step', effort%bytes/max(model%clock%step, 1))
    call summary%set('balance.cuts', model%ranks%balance%cuts)
    call summary%set('balance.particles_moved', model%ranks%balance%moved)
    call summary%set('balance.imbalance', model%ranks%balance%imbalance)
    call summary%set('balance.largest_imbalance', model%ranks%balance%largest)
    call summary%set('balance.share', effort%mean(phase_balance)/max(effort%solving, tiny(1.0_dp)))
    call summary%set('halo.seconds_per_step', effort%mean(phase_halo)/max(model%clock%step, 1))
  end subroutine summarise_effort

  !> The energy ledger at the end.
  subroutine summarise_energy(summary, model)
    type(summary_t), intent(inout) :: summary
    type(model_t), intent(in) :: model
    integer :: t
    call summary%set('energy.kinetic', model%ledger%kinetic)
    call summary%set('energy.internal', model%ledger%internal)
    call summary%set('energy.total', ledger_total(model%ledger))
    call summary%set('energy.initial_total', model%ledger%initial_total)
    call summary%set('energy.external_work', model%ledger%external_work)
    call summary%set('energy.contact_dissipation', model%ledger%contact_dissipation)
    call summary%set('energy.supplied', model%ledger%supplied)
    call summary%set('energy.drift', ledger_drift(model%ledger))
    call summary%set('energy.viscous_dissipation', model%ledger%viscous_dissipation)
    do t = 1, model%ledger%terms%n
      call summarise_term(summary, model, model%ledger%terms%term(t))
    end do
    call summary%set('energy.interpolation_error', model%ledger%interpolation_error)
    call summary%set('energy.predicted_error', model%ledger%predicted)
    call summary%set('energy.remainder', model%ledger%remainder)
  end subroutine summarise_energy

  !> A term of the energy balance, under its name if it has one; vectors along the axes of output.
  subroutine summarise_term(summary, model, term)
    type(summary_t), intent(inout) :: summary
    type(model_t), intent(in) :: model
    type(energy_term_t), intent(in) :: term
    if (term%name == '') return
    if (term%whole) then
      call summary%set(trim(term%name), nint(term%value(1), i8))
    else if (term%components == 1) then
      call summary%set(trim(term%name), term%value(1))
    else
      call summary%set(trim(term%name), momentum_in_output(model, term%value))
    end if
  end subroutine summarise_term

end module sgmp_report
