!> The stages of a step: what features do, and when (doc/developer-guide.md).
!!
!! The step (sgmp_step) calls these in the order below, each at the point that its comment names; a
!! stage calls the features that the scene asks for, in a fixed order, and hands them those parts of
!! the model that they read or change. A feature that the scene does not ask for is not called.
!!
!!   step              stage               features
!!   before the run    columns             splitting
!!                     terms               all that change the energy after the kick
!!   start             open                bodies that are removed, driven parts, rotation, surfaces
!!   stress first      project             walls that rub, consistent mass
!!                     meet                contact
!!                     strain_velocity     contact
!!                     place               rotation
!!   momentum          before_solve        damping (stress first), normalised stress, rigid bodies,
!!                                         driven parts, walls
!!                     solved              consistent mass
!!                     meet                contact
!!                     forces              free rigid bodies, contact, consistent mass
!!                     place               rotation
!!                     after_solve         walls that move, reactions of walls, debris
!!   re-map            strain_velocity     consistent mass, contact
!!                     place               rotation
!!                     after_remap         rotation, kept volumes
!!   sweeps            plan                kept volumes
!!                     sweep               averages over a length, self-contact, surfaces
!!   sums known        close               rigid bodies, driven parts
!!   books closed      finish              damping (stress last)
!!                     guard               splitting
!!   after the run     objection           walls that rub
module sgmp_stages
  use sgmp_absorbing_account, only: absorbing_account
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_acceleration, node_remapped, node_velocity
  use sgmp_contact, only: contact_step_t
  use sgmp_contact_stages, only: phase_contact_force, phase_contact_velocity, phase_find_contact
  use sgmp_damping_account, only: damping_account, damping_book_kick
  use sgmp_damping_stages, only: damping_factor, damping_slow
  use sgmp_debris_account, only: debris_account
  use sgmp_debris_stages, only: phase_collisions, phase_debris_mass
  use sgmp_driven_parts, only: driven_any, driven_book, driven_choose, driven_publish
  use sgmp_erosion_account, only: erosion_account
  use sgmp_erosion_stages, only: erosion_open
  use sgmp_features, only: features_t
  use sgmp_kinds, only: dp
  use sgmp_loss_account, only: loss_account
  use sgmp_mass_stages, only: mass_project, mass_remap, mass_solve, mass_strain
  use sgmp_mesh, only: wall_speed
  use sgmp_method, only: method_t
  use sgmp_model, only: model_t
  use sgmp_one_sided_reaction, only: one_sided_weigh
  use sgmp_phases, only: phase_average, phase_mirror, phase_normalise, phase_place, phase_relax, &
                         phase_rotation, phase_surfaces_strain, phase_surfaces_weigh, phase_velocity
  use sgmp_plan, only: plan_t
  use sgmp_reference_places, only: reference_columns
  use sgmp_removal_account, only: removal_account
  use sgmp_removal_stages, only: removal_open
  use sgmp_rigid_bodies, only: rigid_advance, rigid_choose_speed
  use sgmp_rigid_stages, only: free_any, free_close, free_open, free_settle, free_strain
  use sgmp_self_contact, only: self_look
  use sgmp_splitting_account, only: splitting_account
  use sgmp_splitting_stages, only: splitting_columns, splitting_guard
  use sgmp_swirl_account, only: swirl_account
  use sgmp_time_step, only: clock_kick_step
  use sgmp_timers, only: phase_grid, phase_kick, timers_stop
  use sgmp_unfelt_account, only: unfelt_account
  use sgmp_unfelt_stages, only: unfelt_part, unfelt_possible, unfelt_tally
  use sgmp_update, only: update_musl, update_strains_before, update_usavg, update_usl
  use sgmp_volumes_account, only: volumes_account
  use sgmp_wall_friction_account, only: wall_friction_account, wall_friction_book
  use sgmp_wall_friction_stages, only: wall_friction_objection, wall_velocity_rubbed
  use sgmp_wall_motion, only: wall_motion_choose
  use sgmp_wall_reaction, only: phase_wall_reaction, reaction_account
  use sgmp_wall_work, only: phase_wall_work
  implicit none
  private
  public :: stage_after_remap, stage_after_solve, stage_before_solve, stage_brings_stress, &
            stage_close, stage_columns, stage_finish, stage_forces, stage_guard, &
            stage_meet, stage_objection, stage_open, stage_place, stage_plan, stage_project, &
            stage_solved, stage_strain_velocity, stage_sweep, stage_terms

contains

  !> Before the run: columns of the particles of a body beside those of its law and of the method.
  pure subroutine stage_columns(features, ndim, body)
    type(features_t), intent(in) :: features
    integer, intent(in) :: ndim
    type(body_t), intent(inout) :: body
    call splitting_columns(features%splitting, ndim, body)
    if (features%reference) call reference_columns(ndim, body)
  end subroutine stage_columns

  !> Before the run: terms of the energy balance beside those of the scheme, in the order in which a
  !! step books them and history.csv shows them.
  pure subroutine stage_terms(model)
    type(model_t), intent(inout) :: model
    associate (method => model%method, terms => model%ledger%terms)
      if (method%relaxed) call volumes_account(terms)
      if (method%debris_speed > 0.0_dp) call debris_account(terms)
      if (method%features%splitting%limit > 0.0_dp) call splitting_account(terms)
      if (method%swirl) call swirl_account(terms)
      if (method%damped) call damping_account(terms)
      if (unfelt_possible(method, model%bodies, model%fields)) call unfelt_account(terms)
      if (method%erodes) call erosion_account(terms)
      if (method%loses) call loss_account(terms)
      if (method%removes) call removal_account(terms)
      if (method%features%wall_friction%rubs) call wall_friction_account(terms)
      if (model%mesh%walls_weigh) call reaction_account(terms, model%mesh)
      if (any(model%mesh%absorbs)) call absorbing_account(terms)
    end associate
  end subroutine stage_terms

  !> Start of a step: the grid holds what the particles gave it at the end of the step before, the
  !! sums are empty, nothing of this step is known but its length.
  subroutine stage_open(model)
    type(model_t), intent(inout) :: model
    if (model%method%removes) call removal_open(model%clock%time, model%bodies)
    model%method%unfelt = unfelt_part(model%method, model%clock%time, model%bodies, &
                                      model%totals%bodies%internal, &
                                      model%ledger%largest_kinetic, model%fields)
    if (model%method%erodes) call erosion_open(model%mesh%h*merge(1.0_dp, model%clock%cfl, &
                                                                  model%clock%fixed > 0.0_dp), &
                                               model%bodies)
    if (driven_any(model%fields)) call driven_publish(model%bodies, model%fields)
    if (model%method%rotation) then
      call phase_rotation(model%method, model%mesh, model%fields, model%bodies, model%team, &
                          model%ranks%partition)
      call timers_stop(model%timers, phase_grid)
    end if
    call phase_surfaces_weigh(model%method, model%mesh, model%fields, model%bodies, model%team, &
                              model%ranks%partition)
  end subroutine stage_open

  !> Velocity of the nodes before a stress update that comes first: that of the particles' momentum,
  !! or the one that features want in its place.
  subroutine stage_project(model)
    type(model_t), intent(inout) :: model
    associate (mesh => model%mesh, fields => model%fields, bodies => model%bodies, &
               team => model%team)
      if (model%method%features%wall_friction%rubs) then
        call wall_velocity_rubbed(model%method, clock_kick_step(model%clock), mesh, fields, &
                                  bodies, team, model%ranks%partition)
      else
        call phase_velocity(model%method, mesh, fields, bodies, team, model%ranks%partition)
      end if
    end associate
    call mass_project(model)
  end subroutine stage_project

  !> Before the momentum equation: the nodes hold mass, momentum and stress. What is prescribed for
  !! the middle of the step is evaluated here.
  subroutine stage_before_solve(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick              !! velocity step
    real(dp) :: middle
    associate (mesh => model%mesh, method => model%method, fields => model%fields, &
               bodies => model%bodies, clock => model%clock)
      middle = clock%time + 0.5_dp*clock%dt
      if (strains_first(method)) call slow_down(model, dt_kick)
      call phase_normalise(method, mesh, fields, model%team, model%ranks%partition)
      call rigid_choose_speed(bodies, middle, clock%dt, mesh%ndim)
      if (driven_any(fields)) call driven_choose(bodies, fields, middle, clock%dt)
      if (mesh%walls_act) call wall_motion_choose(model%wall_motion, middle, dt_kick, mesh)
      if (free_any(bodies)) call free_open(bodies, mesh, method%gravity, clock%time, clock%dt, &
                                           dt_kick)
    end associate
  end subroutine stage_before_solve

  !> The nodes hold acceleration and trial velocity of the momentum equation, every field as if it
  !! were alone.
  subroutine stage_solved(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick              !! velocity step
    call mass_solve(model, dt_kick)
  end subroutine stage_solved

  !> Where bodies meet: once a step, before the first velocity that has to obey it.
  subroutine stage_meet(model)
    type(model_t), intent(inout) :: model
    type(plan_t) :: plan
    if (model%method%debris_speed > 0.0_dp .and. size(model%contact%pairs) > 0) then
      plan%loose = .true.
      plan%step = model%clock%step + 1
      allocate (plan%vectors(0))
      call phase_debris_mass(plan, model%totals, model%mesh, model%fields, model%bodies, &
                             model%team, model%ranks, model%findings, model%timers)
    end if
    call phase_find_contact(model%clock%step + 1, model%method%cutoff, model%mesh, model%fields, &
                            model%bodies, model%contact, model%team%threads, model%ranks, &
                            model%findings, model%timers)
  end subroutine stage_meet

  !> Forces between bodies: the nodes hold acceleration and trial velocity as if every field were
  !! alone; where bodies meet is known.
  subroutine stage_forces(model)
    type(model_t), intent(inout) :: model
    associate (mesh => model%mesh, fields => model%fields, bodies => model%bodies, &
               contact => model%contact, threads => model%team%threads)
      if (free_any(bodies)) call free_settle(contact_step(model), model%clock%dt, mesh, fields, &
                                             bodies, contact, threads, model%ranks)
      call phase_contact_force(contact_step(model), mesh, fields, bodies, contact, threads, &
                               model%ranks, model%findings, model%timers)
    end associate
    call mass_strain(model)
  end subroutine stage_forces

  !> Nodal velocities, each from a column on, as they are at the places of the nodes: by the curl of
  !! the first, the one that strains, without the acceleration of the step where it strains before.
  subroutine stage_place(model, columns, kick)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: columns(:)
    real(dp), intent(in) :: kick
    call phase_place(model%clock%step + 1, model%method, model%mesh, model%fields, model%bodies, &
                     columns, kick, model%team, model%ranks, model%findings, model%timers)
  end subroutine stage_place

  !> After the momentum equation: the nodes hold the acceleration and the velocity of the step,
  !! those behind walls their mirror images.
  subroutine stage_after_solve(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick              !! velocity step
    if (model%mesh%walls_move) then
      call phase_wall_work(model%mesh, model%fields, model%bodies, model%ranks%partition%own, &
                           dt_kick, model%findings%tally)
    end if
    if (model%mesh%walls_weigh) then
      call phase_wall_reaction(model%mesh, model%fields, model%bodies, &
                               model%ranks%partition%own, model%findings%tally)
      call one_sided_weigh(model%mesh, model%bodies, model%findings%tally)
    end if
    if (model%method%debris_speed > 0.0_dp) call collide(model, dt_kick)
  end subroutine stage_after_solve

  !> By how much debris collides in the kick to come.
  subroutine collide(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick              !! velocity step
    type(plan_t) :: plan
    plan%loose = .true.
    plan%dt_kick = dt_kick
    plan%step = model%clock%step + 1
    plan%vectors = [node_acceleration, node_velocity(model%mesh%ndim)]
    plan%gradient = node_velocity(model%mesh%ndim)
    plan%by_halves = by_halves(model%method)
    call phase_collisions(plan, model%method%debris_speed, model%totals, model%mesh, model%fields, &
                          model%bodies, model%team, model%ranks, model%findings, model%timers)
    call timers_stop(model%timers, phase_grid)
  end subroutine collide

  !> Whether a stress is updated with the velocity that particles have after the kick.
  pure function by_halves(method) result(yes)
    type(method_t), intent(in) :: method
    logical :: yes
    yes = any(method%update == [update_musl, update_usavg])
  end function by_halves

  !> The velocity that strains the particles, of the nodes before the kick or re-mapped after it.
  subroutine stage_strain_velocity(model, before_kick)
    type(model_t), intent(inout) :: model
    logical, intent(in) :: before_kick
    if (.not. before_kick) call mass_remap(model)
    if (free_any(model%bodies)) then
      call free_strain(contact_step(model), model%mesh, model%fields, model%bodies, &
                       model%contact, &
                       merge(node_velocity(model%mesh%ndim), node_remapped, before_kick), &
                       model%team%threads, model%ranks)
    end if
    call phase_contact_velocity(contact_step(model), before_kick, model%mesh, model%fields, &
                                model%bodies, model%contact, model%team%threads, model%ranks, &
                                model%findings, model%timers)
  end subroutine stage_strain_velocity

  !> After the re-map: the nodes hold the re-mapped velocity, which obeys contact and has its mirror
  !! images. What else the sweep to come will read, at nodes and centres.
  subroutine stage_after_remap(model)
    type(model_t), intent(inout) :: model
    associate (mesh => model%mesh, fields => model%fields, bodies => model%bodies, &
               team => model%team)
      if (model%method%rotation) call phase_mirror(mesh, fields, bodies, &
                                                   [node_velocity(mesh%ndim)], [wall_speed], &
                                                   team%threads)
      call phase_relax(model%method, model%clock%dt, mesh, fields, bodies, team, &
                       model%ranks%partition)
      if (model%method%unfelt > 0.0_dp) then
        call unfelt_tally(model%method, fields, bodies, model%ranks%partition, &
                           model%findings%tally)
      end if
    end associate
  end subroutine stage_after_remap

  !> Whether sweeps that end a step which begins with a stress update bring the stress none the
  !! less: with it come the first moments of the mass, and all that lies behind walls that move or
  !! rub.
  pure function stage_brings_stress(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    yes = model%mesh%walls_act
  end function stage_brings_stress

  !> A sweep is planned: what features want of it beside what the method wants.
  subroutine stage_plan(model, plan)
    type(model_t), intent(in) :: model
    type(plan_t), intent(inout) :: plan
    ! The halves of a particle have the velocities that its gradient says.
    if (plan%drift .and. plan%gradient == 0 .and. &
        model%method%features%splitting%limit > 0.0_dp) then
      plan%gradient = node_velocity(model%mesh%ndim)
    end if
    if (plan%gradient == node_remapped) plan%relax = model%method%relaxed
    if (plan%kick) plan%by_halves = by_halves(model%method)
  end subroutine stage_plan

  !> Before a sweep: what particles will read is at the nodes, those behind walls included.
  subroutine stage_sweep(model, plan)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    if (plan%drift) call phase_average(model%mesh, model%fields, model%team%threads)
    if (plan%drift .and. model%contact%self%on) then
      call self_look(model%contact%self, model%mesh, model%bodies, plan%step, model%clock%time)
    end if
    if (plan%gradient == 0 .or. .not. plan%strain) return
    call phase_surfaces_strain(model%clock%step + 1, model%method, model%mesh, model%fields, &
                               model%bodies, plan%gradient, model%team, model%ranks, &
                               model%findings, model%timers)
  end subroutine stage_sweep

  !> The sums of the step are known, its energy is not booked yet: what moves as a whole goes on to
  !! the end of the step and adds what it did to the sums.
  subroutine stage_close(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick              !! velocity step
    call rigid_advance(model%bodies, model%clock%dt)
    if (model%method%features%wall_friction%rubs) then
      call wall_friction_book(model%method%features%wall_friction, model%totals%features, &
                              dt_kick, model%ledger%terms)
    end if
    if (driven_any(model%fields)) call driven_book(model%bodies, model%fields, model%clock%dt, &
                                                   dt_kick, model%totals%drives)
    if (free_any(model%bodies)) call free_close(model%bodies, model%contact, model%mesh%space, &
                                                model%clock%dt, model%totals)
  end subroutine stage_close

  !> The step is over and booked; what changes velocities now books that itself.
  subroutine stage_finish(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick              !! velocity step
    if (.not. model%method%damped) return
    call damping_book_kick(model%ledger, dt_kick, model%totals%sums%power_before)
    if (.not. strains_first(model%method)) call slow_down(model, dt_kick)
  end subroutine stage_finish

  !> After each step: what must not go on is a failure.
  subroutine stage_guard(model)
    type(model_t), intent(inout) :: model
    if (model%method%features%splitting%limit > 0.0_dp) call splitting_guard(model)
  end subroutine stage_guard

  !> After the run: by which part its numbers are inexact, and why; 1: the run is doubtful.
  subroutine stage_objection(model, inexact, reason)
    type(model_t), intent(in) :: model
    real(dp), intent(out) :: inexact
    character(:), allocatable, intent(out) :: reason
    inexact = 0.0_dp
    reason = ''
    if (model%method%features%wall_friction%rubs) then
      call wall_friction_objection(model%ledger%terms, inexact, reason)
    end if
  end subroutine stage_objection

  !> Damping. What strains the particles must be the velocity that has moved them: where the step to
  !! come strains with it they keep it until then, or they would go further than they are strained.
  subroutine slow_down(model, dt_kick)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt_kick              !! velocity step
    real(dp) :: factor
    if (.not. model%method%damped) return
    factor = damping_factor(model%method, model%clock%time, dt_kick, &
                            model%ledger%kinetic_before, model%ledger%kinetic)
    if (factor < 1.0_dp) call damping_slow(factor, model%team%threads, model%mesh, &
                                           model%fields, model%bodies, model%totals%bodies, &
                                           model%ledger)
    call timers_stop(model%timers, phase_kick)
  end subroutine slow_down

  !> Whether steps begin with a stress update, but perhaps for the first.
  pure function strains_first(method) result(yes)
    type(method_t), intent(in) :: method
    logical :: yes
    yes = update_strains_before(method%update, 1)
  end function strains_first

  !> What contact must know of the step.
  pure function contact_step(model) result(step)
    type(model_t), intent(in) :: model
    type(contact_step_t) :: step
    logical :: strains_before
    strains_before = update_strains_before(model%method%update, model%clock%step)
    step%number = model%clock%step + 1
    step%dt_kick = clock_kick_step(model%clock)
    if (size(model%contact%pairs) > 0) step%gap_speed = model%mesh%h/model%clock%dt
    step%pic = 1.0_dp - model%method%flip
    step%gravity = model%method%gravity
    step%work_part = 1.0_dp - model%method%work_lag
    step%strains_with_trial = model%method%update == update_usl
    if (step%strains_with_trial .or. strains_before) step%before = 1.0_dp
    if (model%method%update == update_usavg .and. strains_before) step%before = 0.5_dp
    step%after = 1.0_dp - step%before
  end function contact_step

end module sgmp_stages
