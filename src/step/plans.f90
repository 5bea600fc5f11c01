!> What each sweep of a step does with the particles: one plan per sweep of MUSL, USF, USL.
!!
!! A plan says what the method wants. What features want of a sweep they add to it (sgmp_stages).
module sgmp_plans
  use sgmp_columns, only: node_acceleration, node_remapped, node_velocity
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_plan, only: plan_t
  use sgmp_stages, only: stage_brings_stress, stage_plan
  use sgmp_time_step, only: clock_kick_step
  use sgmp_update, only: update_strains_before
  implicit none
  private
  public :: plan_all, plan_drift_strain, plan_kick, plan_kick_drift, plan_start, plan_strain

contains

  !> Before the first step: everything is projected, and a strain of next to nothing finds the sound
  !! speeds.
  function plan_start(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan%strain = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%stress = .not. update_strains_before(model%method%update, 0) .or. &
                  stage_brings_stress(model)
    plan%dt_strain = tiny(1.0_dp)**0.25_dp
    allocate (plan%vectors(0))
  end function plan_start

  !> MUSL, first sweep: particle velocities (Eq. 29), momentum projected with the old weights.
  function plan_kick(model, dt_kick) result(plan)
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: dt_kick
    type(plan_t) :: plan
    plan = plan_empty(model)
    plan%kick = .true.
    plan%momentum = .true.
    plan%dt_kick = dt_kick
    plan%flip = model%method%flip
    plan%time = model%clock%time
    plan%vectors = [node_acceleration]
    if (model%method%flip < 1.0_dp) then
      plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
    end if
    call stage_plan(model, plan)
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
    call stage_plan(model, plan)
  end function plan_drift_strain

  !> USF, first sweep: stress from the nodal velocity before the kick; the step since the last
  !! update is dt_before. Where particles change their size with it (cpGIMP) everything is projected
  !! anew, for what they get in the second sweep must be the transpose of what they give.
  function plan_strain(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan = plan_empty(model)
    plan%strain = .true.
    plan%mass = any(model%bodies%sides_stretch)
    plan%momentum = plan%mass
    plan%stress = .true.
    plan%dt_strain = max(model%clock%dt_before, tiny(1.0_dp)**0.25_dp)
    plan%behind = .true.
    plan%time = model%clock%time
    allocate (plan%vectors(0))
    plan%gradient = node_velocity(model%mesh%ndim)
    call stage_plan(model, plan)
  end function plan_strain

  !> USF, second sweep: velocities and positions, mass and momentum projected anew.
  function plan_kick_drift(model, dt_kick) result(plan)
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: dt_kick
    type(plan_t) :: plan
    plan = plan_empty(model)
    plan%kick = .true.
    plan%drift = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%stress = stage_brings_stress(model)
    plan%dt_kick = dt_kick
    plan%dt = model%clock%dt
    plan%flip = model%method%flip
    plan%time = model%clock%time + model%clock%dt
    plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
    call stage_plan(model, plan)
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
    plan%flip = model%method%flip
    plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
    plan%gradient = node_velocity(model%mesh%ndim)
    call stage_plan(model, plan)
  end function plan_all

  !> What all sweeps of a step have in common.
  pure function plan_empty(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan%step = model%clock%step + 1
    plan%began = model%clock%time
    plan%features = model%method%features
    plan%dt_work = clock_kick_step(model%clock)
    plan%work_lag = model%method%work_lag
    plan%lost_policy = model%method%lost_policy
    plan%loses = model%method%loses
  end function plan_empty

  !> What the sweeps that end a step have in common: stress update, projection of everything.
  pure function plan_full(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan = plan_empty(model)
    plan%strain = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%stress = .true.
    plan%dt = model%clock%dt
    plan%dt_strain = model%clock%dt
    plan%time = model%clock%time + model%clock%dt
  end function plan_full

end module sgmp_plans
