!> One time step: the flow chart of the paper (Fig. 2), in two sweeps over the particles for MUSL
!! and USF, one for USL.
!!
!! A sweep ends with the projection of the new state, so the first half of step k+1 has been done
!! when step k ends.
module sgmp_step
  use sgmp_columns, only: node_acceleration, node_remapped, node_velocity
  use sgmp_contact, only: contact_step_t
  use sgmp_contact_phases, only: phase_contact_force, phase_contact_velocity, phase_find_contact
  use sgmp_damping, only: damping_factor, damping_slow
  use sgmp_driven_parts, only: driven_any, driven_book, driven_choose, driven_publish, &
                               driven_terms
  use sgmp_energy, only: ledger_after_kick, ledger_erode, ledger_relax, &
                         ledger_split, ledger_step
  use sgmp_free_bodies, only: free_any, free_close, free_open, free_settle
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_kick, wall_speed
  use sgmp_model, only: model_t
  use sgmp_phases, only: phase_mirror, phase_normalise, phase_place, phase_relax, phase_remap, &
                         phase_rotation, phase_solve, phase_sweep, phase_velocity, &
                         phase_velocity_rubbed
  use sgmp_plan, only: plan_t
  use sgmp_rebin_phases, only: phase_rebin_particles
  use sgmp_rigid_bodies, only: rigid_advance, rigid_choose_speed
  use sgmp_rigid_motion, only: freedoms
  use sgmp_scene, only: update_musl, update_usavg, update_usf, update_usl
  use sgmp_time_step, only: clock_kick_step
  use sgmp_timers, only: phase_drift, phase_grid, phase_halo, phase_kick, phase_rebin, &
                         timers_move, timers_stop, wall_time
  use sgmp_totals, only: totals_close, totals_open
  use sgmp_wall_motion, only: wall_motion_choose
  use sgmp_wall_work, only: phase_wall_work
  implicit none
  private
  public :: step_start, step_take
  public :: step_open, step_close, step_project, step_solve, step_sweep

  !> Part of the carried spin that each step replaces by the rotation of the grid, so that errors
  !! are forgotten (doc/rotation.md). The first step takes all of it from there.
  real(dp), parameter :: spin_relaxation = 0.02_dp

contains

  !> First projection of the particles, which also finds the sound speeds.
  subroutine step_start(model)
    type(model_t), intent(inout) :: model
    type(plan_t) :: plan
    plan%strain = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%stress = model%method%update /= update_usf .or. brings_stress(model)
    plan%dt_strain = tiny(1.0_dp)**0.25_dp
    allocate (plan%vectors(0))
    call step_open(model)
    call step_sweep(model, plan, phase_drift)
    call step_close(model, .false.)
  end subroutine step_start

  !> Advances the model by clock%dt.
  subroutine step_take(model)
    type(model_t), intent(inout) :: model
    real(dp) :: dt_kick, kinetic
    dt_kick = clock_kick_step(model%clock)
    kinetic = model%ledger%kinetic
    call step_open(model)
    if (driven_any(model%fields)) call driven_publish(model%bodies, model%fields)
    if (model%method%rotation) call prepare_rotation(model)
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
    if (model%method%damped) call damp(model, dt_kick, kinetic)
  end subroutine step_take

  !> Takes from the velocities what damping wants.
  subroutine damp(model, dt_kick, kinetic_before)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick, kinetic_before
    real(dp) :: factor
    factor = damping_factor(model%method, model%clock%time, dt_kick, kinetic_before, &
                            model%ledger%kinetic)
    if (factor < 1.0_dp) call damping_slow(factor, model%team%threads, model%fields, &
                                           model%bodies, model%totals%bodies, model%ledger)
    call timers_stop(model%timers, phase_kick)
  end subroutine damp

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
    if (model%clock%step > 0) then
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
    plan%stress = brings_stress(model)
    call step_sweep(model, plan, phase_drift)
  end subroutine step_usavg

  !> Update stress last.
  subroutine step_usl(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    call step_solve(model, dt_kick)
    call step_sweep(model, plan_all(model, dt_kick), phase_drift)
  end subroutine step_usl

  !> Acceleration and trial velocity of the nodes: momentum equation, contact, walls.
  subroutine step_solve(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    associate (mesh => model%mesh, method => model%method, fields => model%fields, &
               bodies => model%bodies, contact => model%contact, team => model%team, &
               partition => model%ranks%partition, clock => model%clock)
      call phase_normalise(method, mesh, fields, team, partition)
      call rigid_choose_speed(bodies, clock%time + 0.5_dp*clock%dt, clock%dt, mesh%ndim)
      if (driven_any(fields)) call driven_choose(bodies, fields, clock%time + 0.5_dp*clock%dt, &
                                                 clock%dt)
      if (mesh%walls_act) call wall_motion_choose(model%wall_motion, &
                                                   clock%time + 0.5_dp*clock%dt, dt_kick, mesh)
      if (free_any(bodies)) call free_open(bodies, mesh, method%gravity, clock%time, clock%dt, &
                                           dt_kick)
      call phase_solve(method, dt_kick, mesh, fields, bodies, team, partition, &
                       model%findings%tally)
      if (.not. strains_before(model)) call find_contact(model)
      if (free_any(bodies)) call free_settle(contact_step(model), clock%dt, mesh, fields, bodies, &
                                             contact, team%threads, model%ranks)
      call phase_contact_force(contact_step(model), mesh, fields, bodies, contact, team%threads, &
                               model%ranks, model%findings, model%timers)
      ! Where a sweep of its own moves the particles the velocity waits for it: see remap.
      if (any(method%update == [update_usf, update_usl])) then
        call place(model, [node_velocity(mesh%ndim)], &
                   merge(dt_kick, 0.0_dp, method%update == update_usf))
      end if
      call phase_mirror(mesh, fields, bodies, [node_acceleration, node_velocity(mesh%ndim)], &
                        [wall_kick, wall_speed], team%threads)
      if (mesh%walls_move) call phase_wall_work(mesh, fields, bodies, partition%own, dt_kick, &
                                                model%findings%tally)
    end associate
    call timers_stop(model%timers, phase_grid)
  end subroutine step_solve

  !> Velocity of the nodes before the stress update (USF).
  subroutine step_project(model)
    type(model_t), intent(inout) :: model
    associate (mesh => model%mesh, fields => model%fields, bodies => model%bodies, &
               team => model%team, velocity => node_velocity(model%mesh%ndim))
      if (mesh%walls_rub) then
        call phase_velocity_rubbed(model%method, clock_kick_step(model%clock), mesh, fields, &
                                   bodies, team, model%ranks%partition)
      else
        call phase_velocity(model%method, mesh, fields, bodies, team, model%ranks%partition)
      end if
      call find_contact(model)
      call phase_contact_velocity(contact_step(model), .true., mesh, fields, bodies, &
                                  model%contact, team%threads, model%ranks, model%findings, &
                                  model%timers)
      call place(model, [velocity], 0.0_dp)
      call phase_mirror(mesh, fields, bodies, [velocity], [wall_speed], team%threads)
    end associate
    call timers_stop(model%timers, phase_grid)
  end subroutine step_project

  !> Velocity of the nodes from the updated particles (MUSL).
  subroutine remap(model)
    type(model_t), intent(inout) :: model
    associate (mesh => model%mesh, fields => model%fields, bodies => model%bodies, &
               team => model%team)
      call phase_remap(mesh, fields, bodies, team, model%ranks%partition)
      call phase_contact_velocity(contact_step(model), .false., mesh, fields, bodies, &
                                  model%contact, team%threads, model%ranks, model%findings, &
                                  model%timers)
      if (model%method%rotation) then
        call place(model, [node_remapped, node_velocity(mesh%ndim)], 0.0_dp)
        call phase_mirror(mesh, fields, bodies, [node_velocity(mesh%ndim)], [wall_speed], &
                          team%threads)
      end if
      call phase_mirror(mesh, fields, bodies, [node_remapped], [wall_speed], team%threads)
      call phase_relax(model%method, model%clock%dt, mesh, fields, bodies, team, &
                       model%ranks%partition)
    end associate
    call timers_stop(model%timers, phase_grid)
  end subroutine remap

  !> What exact rotation needs to know of the masses.
  subroutine prepare_rotation(model)
    type(model_t), intent(inout) :: model
    call phase_rotation(model%method, model%mesh, model%fields, model%bodies, model%team, &
                        model%ranks%partition)
    call timers_stop(model%timers, phase_grid)
  end subroutine prepare_rotation

  !> Nodal velocities, each from a column on, as they are at the places of the nodes: by the curl of
  !! the first, the one that strains, without the acceleration of the step where it strains before.
  subroutine place(model, columns, kick)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: columns(:)
    real(dp), intent(in) :: kick
    call phase_place(model%clock%step + 1, model%method, model%mesh, model%fields, model%bodies, &
                     columns, kick, model%team, model%ranks, model%findings, model%timers)
  end subroutine place

  !> Whether the step strains with the velocity before the kick, so that contact is found there.
  pure function strains_before(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    yes = model%method%update == update_usf .or. &
          (model%method%update == update_usavg .and. model%clock%step > 0)
  end function strains_before

  !> Whether sweeps that end a step which begins with a stress update bring the stress none the
  !! less: with it come the first moments of the mass, and all that lies behind walls that move or
  !! rub.
  pure function brings_stress(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    yes = model%method%rotation .or. model%mesh%walls_act
  end function brings_stress

  !> What contact must know of the step.
  pure function contact_step(model) result(step)
    type(model_t), intent(in) :: model
    type(contact_step_t) :: step
    step%number = model%clock%step + 1
    step%dt_kick = clock_kick_step(model%clock)
    if (size(model%contact%pairs) > 0) step%gap_speed = model%mesh%h/model%clock%dt
    step%pic = 1.0_dp - model%method%flip
    step%gravity = model%method%gravity
    step%strains_with_trial = model%method%update == update_usl
    if (step%strains_with_trial .or. strains_before(model)) step%before = 1.0_dp
    if (model%method%update == update_usavg .and. strains_before(model)) step%before = 0.5_dp
    step%after = 1.0_dp - step%before
  end function contact_step

  subroutine find_contact(model)
    type(model_t), intent(inout) :: model
    call phase_find_contact(model%clock%step + 1, model%method%cutoff, model%mesh, model%fields, &
                            model%bodies, model%contact, model%team%threads, model%ranks, &
                            model%findings, model%timers)
  end subroutine find_contact

  !> One sweep over the particles, after which they are in the bins of their new positions.
  subroutine step_sweep(model, plan, phase)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: phase                 !! of the timers
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
    call totals_open(model%totals, model%findings, model%contact, size(model%bodies), &
                     model%method%erodes, driven_terms(model%fields))
  end subroutine step_open

  !> Puts together what the ranks have found.
  subroutine step_close(model, whole)
    type(model_t), intent(inout) :: model
    logical, intent(in) :: whole                 !! of a whole step
    real(dp) :: since
    since = wall_time()
    call totals_close(model%totals, model%findings, model%contact, model%fields, model%bodies, &
                      model%ranks%partition, whole, model%method%erodes)
    if (model%ranks%partition%ranks > 1) call timers_move(model%timers, phase_halo, since)
  end subroutine step_close

  !> Adds the step to the energy ledger, whose identity holds unless particles were lost before it.
  subroutine book_step(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick
    real(dp) :: impulses(freedoms, size(model%contact%pairs))
    integer :: lost, p
    lost = model%findings%lost
    do p = 1, size(model%contact%pairs)
      impulses(:, p) = [model%contact%pairs(p)%impulse, model%contact%pairs(p)%angular_impulse]
    end do
    call step_close(model, .true.)
    call rigid_advance(model%bodies, model%clock%dt)
    if (driven_any(model%fields)) call driven_book(model%bodies, model%fields, model%clock%dt, &
                                                   dt_kick, model%totals%drives)
    if (free_any(model%bodies)) call free_close(model%bodies, model%contact, model%mesh%space, &
                                                model%clock%dt, impulses, model%totals)
    call ledger_step(model%ledger, model%totals%sums, dt_kick, &
                     exact=model%method%flip >= 1.0_dp .and. lost == model%findings%lost_before)
    if (model%method%relaxed) call ledger_relax(model%ledger, model%totals%sums)
    if (model%method%split > 0.0_dp) call ledger_split(model%ledger, model%totals%sums)
    if (model%method%swirl) call ledger_after_kick(model%ledger, model%totals%sums)
    if (model%method%erodes) call ledger_erode(model%ledger, model%totals%sums%eroded)
    model%findings%lost_before = lost
  end subroutine book_step

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
    if (model%method%spins > 0) then
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
    plan%relax = model%method%relaxed
    plan%split = model%method%split
    if (model%method%spins > 0) then
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
    plan = plan_empty(model)
    plan%strain = .true.
    plan%mass = any(model%bodies%sides_stretch)
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
    plan = plan_empty(model)
    plan%kick = .true.
    plan%drift = .true.
    plan%mass = .true.
    plan%momentum = .true.
    plan%stress = brings_stress(model)
    plan%dt_kick = dt_kick
    plan%dt = model%clock%dt
    plan%flip = model%method%flip
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
    plan%flip = model%method%flip
    plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
    plan%gradient = node_velocity(model%mesh%ndim)
    plan%split = model%method%split
  end function plan_all

  !> What all sweeps of a step have in common.
  pure function plan_empty(model) result(plan)
    type(model_t), intent(in) :: model
    type(plan_t) :: plan
    plan%step = model%clock%step + 1
    plan%lost_policy = model%method%lost_policy
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

end module sgmp_step
