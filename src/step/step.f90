!> One time step: the flow chart of the paper (Fig. 2), in two sweeps over the particles for MUSL
!! and USF, three for USAVG, one for USL.
!!
!! A sweep ends with the projection of the new state, so the first half of step k+1 has been done
!! when step k ends. What goes beyond the paper has its place in the stages (sgmp_stages).
module sgmp_step
  use sgmp_columns, only: node_acceleration, node_remapped, node_velocity
  use sgmp_energy, only: ledger_book, ledger_step
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_kick, wall_speed
  use sgmp_model, only: model_t
  use sgmp_phases, only: phase_mirror, phase_remap, phase_solve, phase_sweep
  use sgmp_plan, only: plan_t
  use sgmp_plans, only: plan_all, plan_drift_strain, plan_kick, plan_kick_drift, plan_start, &
                        plan_strain
  use sgmp_rebin_phases, only: phase_rebin_particles
  use sgmp_stages, only: stage_after_remap, stage_after_solve, stage_before_solve, &
                         stage_brings_stress, stage_close, stage_finish, stage_forces, &
                         stage_meet, stage_open, stage_place, stage_project, &
                         stage_solved, stage_strain_velocity, stage_sweep
  use sgmp_time_step, only: clock_kick_step
  use sgmp_timers, only: phase_drift, phase_grid, phase_halo, phase_kick, phase_rebin, &
                         timers_move, timers_stop, wall_time
  use sgmp_totals, only: totals_close, totals_open
  use sgmp_update, only: update_musl, update_strains_before, update_usavg, update_usf, update_usl
  implicit none
  private
  public :: step_start, step_take
  public :: step_open, step_close, step_project, step_solve, step_sweep

contains

  !> First projection of the particles, which also finds the sound speeds.
  subroutine step_start(model)
    type(model_t), intent(inout) :: model
    call step_open(model)
    call step_sweep(model, plan_start(model), phase_drift)
    call step_close(model, .false.)
  end subroutine step_start

  !> Advances the model by clock%dt.
  subroutine step_take(model)
    type(model_t), intent(inout) :: model
    real(dp) :: dt_kick
    dt_kick = clock_kick_step(model%clock)
    call step_open(model)
    call stage_open(model)
    select case (model%method%update)
    case (update_musl)
      call step_musl(model, dt_kick)
    case (update_usf)
      call step_usf(model, dt_kick)
    case (update_usavg)
      call step_usavg(model, dt_kick)
    case default  ! update_usl
      call step_usl(model, dt_kick)
    end select
    call book_step(model, dt_kick)
    call stage_finish(model, dt_kick)
  end subroutine step_take

  !> Modified update stress last.
  subroutine step_musl(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call step_solve(model, dt_kick)
    call step_sweep(model, plan_kick(model, dt_kick), phase_kick)
    call remap(model)
    call step_sweep(model, plan_drift_strain(model), phase_drift)
  end subroutine step_musl

  !> Update stress first.
  subroutine step_usf(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call step_project(model)
    call step_sweep(model, plan_strain(model), phase_drift)
    call step_solve(model, dt_kick)
    call step_sweep(model, plan_kick_drift(model, dt_kick), phase_kick)
  end subroutine step_usf

  !> Half of the stress update first, with the velocity projected anew, half last, with the
  !! re-mapped velocity.
  subroutine step_usavg(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    type(plan_t) :: plan
    if (strains_before(model)) then
      call step_project(model)
      plan = plan_strain(model)
      plan%dt_strain = 0.5_dp*plan%dt_strain
      call step_sweep(model, plan, phase_drift)
    end if
    call step_solve(model, dt_kick)
    call step_sweep(model, plan_kick(model, dt_kick), phase_kick)
    call remap(model)
    plan = plan_drift_strain(model)
    plan%dt_strain = 0.5_dp*plan%dt_strain
    plan%stress = stage_brings_stress(model)
    call step_sweep(model, plan, phase_drift)
  end subroutine step_usavg

  !> Update stress last.
  subroutine step_usl(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call step_solve(model, dt_kick)
    call step_sweep(model, plan_all(model, dt_kick), phase_drift)
  end subroutine step_usl

  !> Velocity of the nodes before the stress update (USF).
  subroutine step_project(model)
    type(model_t), intent(inout) :: model
    integer :: velocity
    velocity = node_velocity(model%mesh%ndim)
    call stage_project(model)
    call stage_meet(model)
    call stage_strain_velocity(model, .true.)
    call stage_place(model, [velocity], 0.0_dp)
    call phase_mirror(model%mesh, model%fields, model%bodies, [velocity], [wall_speed], &
                      model%team%threads)
    call timers_stop(model%timers, phase_grid)
  end subroutine step_project

  !> Acceleration and trial velocity of the nodes: momentum equation, forces between bodies, walls.
  subroutine step_solve(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    integer :: velocity
    velocity = node_velocity(model%mesh%ndim)
    call stage_before_solve(model, dt_kick)
    call phase_solve(model%method, dt_kick, model%mesh, model%fields, model%bodies, model%team, &
                     model%ranks%partition, model%findings%tally)
    call stage_solved(model, dt_kick)
    if (.not. strains_before(model)) call stage_meet(model)
    call stage_forces(model)
    ! Where a sweep of its own moves the particles the velocity waits for it: see remap.
    if (any(model%method%update == [update_usf, update_usl])) then
      call stage_place(model, [velocity], &
                       merge(dt_kick, 0.0_dp, model%method%update == update_usf))
    end if
    call phase_mirror(model%mesh, model%fields, model%bodies, [node_acceleration, velocity], &
                      [wall_kick, wall_speed], model%team%threads)
    call stage_after_solve(model, dt_kick)
    call timers_stop(model%timers, phase_grid)
  end subroutine step_solve

  !> Velocity of the nodes from the updated particles (MUSL).
  subroutine remap(model)
    type(model_t), intent(inout) :: model
    call phase_remap(model%method, model%mesh, model%fields, model%bodies, model%team, &
                     model%ranks%partition)
    call stage_strain_velocity(model, .false.)
    call stage_place(model, [node_remapped, node_velocity(model%mesh%ndim)], 0.0_dp)
    call phase_mirror(model%mesh, model%fields, model%bodies, [node_remapped], [wall_speed], &
                      model%team%threads)
    call stage_after_remap(model)
    call timers_stop(model%timers, phase_grid)
  end subroutine remap

  !> Whether the step strains with the velocity before the kick.
  pure function strains_before(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    yes = update_strains_before(model%method%update, model%clock%step)
  end function strains_before

  !> One sweep over the particles, after which they are in the bins of their new positions.
  subroutine step_sweep(model, plan, phase)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: phase                 !! of the timers
    call stage_sweep(model, plan)
    call phase_sweep(plan, model%mesh, model%fields, model%bodies, model%team, model%ranks, &
                     model%findings, model%timers)
    call timers_stop(model%timers, phase)
    call phase_rebin_particles(plan, model%mesh, model%fields, model%bodies, model%contact, &
                               model%team, model%ranks, model%findings, model%timers)
    call timers_stop(model%timers, phase_rebin)
  end subroutine step_sweep

  !> Forgets the sums of the step before.
  subroutine step_open(model)
    type(model_t), intent(inout) :: model
    model%findings%fastest_before = model%findings%fastest
    call totals_open(model%totals, model%ledger%terms, model%findings, model%contact, &
                     model%fields, size(model%bodies), model%method%removed)
  end subroutine step_open

  !> Puts together what the ranks have found.
  subroutine step_close(model, whole)
    type(model_t), intent(inout) :: model
    logical, intent(in) :: whole                 !! of a whole step
    real(dp) :: since
    since = wall_time()
    call totals_close(model%totals, model%ledger%terms, model%findings, model%contact, &
                      model%fields, model%bodies, model%ranks%partition, whole, &
                      model%method%removed)
    if (model%ranks%partition%ranks > 1) call timers_move(model%timers, phase_halo, since)
  end subroutine step_close

  !> Adds the step to the energy ledger.
  subroutine book_step(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call step_close(model, .true.)
    call stage_close(model, dt_kick)
    call ledger_step(model%ledger, model%totals%sums, dt_kick, &
                     exact=model%method%flip >= 1.0_dp)
    call ledger_book(model%ledger, dt_kick)
  end subroutine book_step

end module sgmp_step
