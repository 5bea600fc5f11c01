!> One time step: the flow chart of the paper (Fig. 2), in two sweeps over the particles for MUSL
!! and USF, one for USL.
!!
!! A sweep ends with the projection of the new state, so the first half of step k+1 has been done
!! when step k ends.
module sgmp_step
  use sgmp_columns, only: node_acceleration, node_remapped, node_velocity
  use sgmp_energy, only: ledger_step
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_phases, only: phase_close_sums, phase_normalise, phase_open_sums, phase_remap, &
                         phase_solve, phase_sweep, phase_velocity
  use sgmp_plan, only: plan_t
  use sgmp_rebin_phases, only: phase_rebin_particles
  use sgmp_scene, only: update_musl, update_usavg, update_usf
  use sgmp_time_step, only: clock_kick_step
  use sgmp_timers, only: phase_drift, phase_grid, phase_kick, phase_rebin, timers_start, timers_stop
  implicit none
  private
  public :: step_start, step_take

  !> Part of the carried spin that each step replaces by the rotation of the grid, so that errors
  !! are forgotten (doc/spin.md). The first step takes all of it from there.
  real(dp), parameter :: spin_relaxation = 0.02_dp

contains

  !> First projection of the particles, which also finds the sound speeds.
  subroutine step_start(model)
    type(model_t), intent(inout) :: model
    type(plan_t) :: plan
    plan%strain = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%stress = model%update /= update_usf
    plan%dt_strain = tiny(1.0_dp)**0.25_dp
    allocate (plan%vectors(0))
    call phase_open_sums(model)
    call sweep_and_rebin(model, plan, phase_drift)
    call phase_close_sums(model, .false.)
  end subroutine step_start

  !> Advances the model by clock%dt.
  subroutine step_take(model)
    type(model_t), intent(inout) :: model
    real(dp) :: dt_kick
    integer :: known
    known = model%lost
    dt_kick = clock_kick_step(model%clock)
    model%fastest_before = model%fastest
    call phase_open_sums(model)
    select case (model%update)
    case (update_musl)
      call step_musl(model, dt_kick)
    case (update_usf)
      call step_usf(model, dt_kick)
    case (update_usavg)
      call step_usavg(model, dt_kick)
    case default  ! update_usl
      call step_usl(model, dt_kick)
    end select
    call phase_close_sums(model, .true.)
    call ledger_step(model%ledger, model%sums, dt_kick, &
                     exact=model%flip >= 1.0_dp .and. known == model%lost_before)
    model%lost_before = known
  end subroutine step_take

  !> Modified update stress last.
  subroutine step_musl(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call solve(model, dt_kick)
    call sweep_and_rebin(model, plan_kick(model, dt_kick), phase_kick)
    call timers_start(model%timers)
    call phase_remap(model)
    call timers_stop(model%timers, phase_grid)
    call sweep_and_rebin(model, plan_drift_strain(model), phase_drift)
  end subroutine step_musl

  !> Update stress first.
  subroutine step_usf(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call timers_start(model%timers)
    call phase_velocity(model)
    call timers_stop(model%timers, phase_grid)
    call sweep_and_rebin(model, plan_strain(model), phase_drift)
    call solve(model, dt_kick)
    call sweep_and_rebin(model, plan_kick_drift(model, dt_kick), phase_kick)
  end subroutine step_usf

  !> Half of the stress update first, with the velocity projected anew, half last, with the
  !! re-mapped velocity.
  subroutine step_usavg(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    type(plan_t) :: plan
    if (model%clock%step > 0) then
      call timers_start(model%timers)
      call phase_velocity(model)
      call timers_stop(model%timers, phase_grid)
      plan = plan_strain(model)
      plan%dt_strain = 0.5_dp*plan%dt_strain
      call sweep_and_rebin(model, plan, phase_drift)
    end if
    call solve(model, dt_kick)
    call sweep_and_rebin(model, plan_kick(model, dt_kick), phase_kick)
    call timers_start(model%timers)
    call phase_remap(model)
    call timers_stop(model%timers, phase_grid)
    plan = plan_drift_strain(model)
    plan%dt_strain = 0.5_dp*plan%dt_strain
    plan%stress = .false.
    call sweep_and_rebin(model, plan, phase_drift)
  end subroutine step_usavg

  !> Update stress last.
  subroutine step_usl(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call solve(model, dt_kick)
    call sweep_and_rebin(model, plan_all(model, dt_kick), phase_drift)
  end subroutine step_usl

  subroutine solve(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call timers_start(model%timers)
    call phase_normalise(model)
    call phase_solve(model, dt_kick)
    call timers_stop(model%timers, phase_grid)
  end subroutine solve

  subroutine sweep_and_rebin(model, plan, phase)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: phase
    call timers_start(model%timers)
    call phase_sweep(model, plan)
    call timers_stop(model%timers, phase)
    call phase_rebin_particles(model, plan)
    call timers_stop(model%timers, phase_rebin)
  end subroutine sweep_and_rebin

  !> MUSL, first sweep: particle velocities (Eq. 29), momentum projected with the old weights.
  function plan_kick(model, dt_kick) result(plan)
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: dt_kick
    type(plan_t) :: plan
    plan%kick = .true.
    plan%momentum = .true.
    plan%dt_kick = dt_kick
    plan%flip = model%flip
    plan%time = model%clock%time
    plan%vectors = [node_acceleration]
    if (model%flip < 1.0_dp) plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
    if (model%spins > 0) then
      plan%spin_gain = dt_kick
      plan%gradient = node_acceleration
    end if
  end function plan_kick

  !> MUSL, second sweep: positions, strains from the re-mapped velocity, stress; everything
  !! projected anew.
  function plan_drift_strain(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan = plan_full(model)
    plan%drift = .true.
    plan%vectors = [node_velocity(model%mesh%ndim)]
    plan%gradient = node_remapped
    if (model%spins > 0) then
      plan%spin_gain = merge(1.0_dp, spin_relaxation, model%clock%step == 0)
      plan%spin_keep = 1.0_dp - plan%spin_gain
    end if
  end function plan_drift_strain

  !> USF, first sweep: stress from the nodal velocity before the kick; the step since the last
  !! update is dt_before. Where particles change their size with it (cpGIMP) everything is projected
  !! anew, for what they get in the second sweep must be the transpose of what they give.
  function plan_strain(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan%strain = .true.
    plan%mass = any(model%bodies%law%slots%stretch > 0)
    plan%momentum = plan%mass
    plan%stress = .true.
    plan%dt_strain = max(model%clock%dt_before, tiny(1.0_dp)**0.25_dp)
    plan%time = model%clock%time
    allocate (plan%vectors(0))
    plan%gradient = node_velocity(model%mesh%ndim)
  end function plan_strain

  !> USF, second sweep: velocities and positions, mass and momentum projected anew.
  function plan_kick_drift(model, dt_kick) result(plan)
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: dt_kick
    type(plan_t) :: plan
    plan%kick = .true.
    plan%drift = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%dt_kick = dt_kick
    plan%dt = model%clock%dt
    plan%flip = model%flip
    plan%time = model%clock%time + model%clock%dt
    plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
  end function plan_kick_drift

  !> USL, the only sweep.
  function plan_all(model, dt_kick) result(plan)
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: dt_kick
    type(plan_t) :: plan
    plan = plan_full(model)
    plan%kick = .true.
    plan%drift = .true.
    plan%dt_kick = dt_kick
    plan%flip = model%flip
    plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
    plan%gradient = node_velocity(model%mesh%ndim)
  end function plan_all

  !> What the sweeps that end a step have in common: stress update, projection of everything.
  pure function plan_full(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan%strain = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%stress = .true.
    plan%dt = model%clock%dt
    plan%dt_strain = model%clock%dt
    plan%time = model%clock%time + model%clock%dt
  end function plan_full

end module sgmp_step
