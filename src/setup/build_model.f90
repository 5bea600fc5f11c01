!> From the validated description of a scene to a model ready for its first step.
!!
!! Longer than 500 lines: everything that a model consists of begins here.
module sgmp_build_model
  use sgmp_absorbing_build, only: absorbing_check, absorbing_declare, absorbing_fill
  use sgmp_angular_momentum, only: angular_momentum_note
  use sgmp_averaging, only: averaging_spread
  use sgmp_axis, only: axis_correction_lattice
  use sgmp_body, only: body_t
  use sgmp_build_burn, only: burn_light
  use sgmp_build_columns, only: columns_build, matter_of, matter_t
  use sgmp_build_file_state, only: file_state_fill
  use sgmp_build_stress, only: stress_fill
  use sgmp_closing, only: closing_first
  use sgmp_constitutive, only: constitutive_t, eos_none, law_is_spherical, law_liquid, &
                               law_set_average, law_set_length, law_slots
  use sgmp_contact_build, only: contact_add_slot, contact_fields, contact_fill_slot, &
                                contact_pairs, contact_self
  use sgmp_debris, only: debris_possible, debris_set_apart
  use sgmp_driven_build, only: driven_add_columns, driven_declare, driven_fill, driven_number
  use sgmp_energy, only: ledger_open
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_expression, only: expression_places
  use sgmp_features, only: features_walls_act
  use sgmp_field, only: field_init
  use sgmp_first_partition, only: partition_first, partition_slab
  use sgmp_flaws, only: flaws_first
  use sgmp_graded_axis, only: graded_place
  use sgmp_kernels, only: bin_span, method_band, method_cpgimp, method_half_size, method_kernel, &
                          stencil_shift, stencil_width
  use sgmp_kinds, only: dp, i4, lanes, pi
  use sgmp_load, only: load_is_bound
  use sgmp_loads_build, only: loads_add_columns, loads_declare, loads_fill
  use sgmp_lost_policy, only: lost_reflect, lost_remove
  use sgmp_material_history, only: slots_ask, slots_first_values, slots_t
  use sgmp_material_weight, only: stress_energy
  use sgmp_mesh, only: mesh_find, mesh_make, mesh_place, mesh_places, mesh_sides, mesh_t
  use sgmp_method, only: method_t
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass
  use sgmp_one_sided_build, only: one_sided_add_columns, one_sided_declare, one_sided_rim, &
                                  one_sided_seat
  use sgmp_parallel, only: parallel_agree, parallel_exact_sums, parallel_max, parallel_rank, &
                           parallel_ranks
  use sgmp_particles, only: particles_fill, particles_t
  use sgmp_partition, only: partition_make
  use sgmp_phases, only: phase_layout
  use sgmp_ranks, only: ranks_hold, ranks_renew_bins
  use sgmp_reference_places, only: reference_fill
  use sgmp_rigid_build, only: rigid_begin, rigid_centre, rigid_declare
  use sgmp_rigid_motion, only: motion_energy
  use sgmp_scene, only: body_card_t, layout_gauss, layout_graded, layout_lattice, scene_space, &
                        scene_t, time_card_t
  use sgmp_seeding, only: seeding_check_inside, seeding_check_overlap, seeding_check_size, &
                          seeding_generate, survey_t
  use sgmp_self_contact, only: self_labels
  use sgmp_space, only: space_axisymmetric
  use sgmp_springs, only: scene_springs
  use sgmp_stages, only: stage_columns, stage_terms
  use sgmp_step, only: step_start
  use sgmp_strength, only: strength_factor, strength_variate
  use sgmp_sums, only: removed_causes, removed_sums
  use sgmp_swirl_driven, only: swirl_driven_start
  use sgmp_team, only: team_make
  use sgmp_totals, only: body_sums_t
  use sgmp_turn, only: infinite_length
  use sgmp_update, only: update_usavg, update_usf
  use sgmp_vectors, only: cross
  use sgmp_wall_motion, only: wall_motion_start
  implicit none
  private
  public :: model_build

  integer, parameter :: body_terms = 9  !! of the initial sums over a body
  real(dp), parameter :: still = 1.0e-12_dp  !! velocity over c + |v| below which all is round-off

contains

  !> Builds bodies, fields and clock, and takes the first projection.
  subroutine model_build(scene, threads, model, error, empty)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: threads               !! OpenMP threads to use
    type(model_t), intent(out) :: model
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in), optional :: empty  !! without particles, which a restart brings
    type(survey_t), allocatable :: surveys(:)
    integer :: b, kernel, twin_of((self_labels)*size(scene%bodies))
    integer(i4) :: next_id
    real(dp) :: heaviest
    logical :: seeded
    seeded = .true.
    if (present(empty)) seeded = .not. empty
    associate (grid => scene%grid)
      model%mesh = mesh_make(scene_space(scene), grid%cell, grid%lower, grid%upper, grid%open, &
                             grid%wall, grid%axes, grid%one_sided, grid%rough)
    end associate
    model%mesh%hoop = scene%method%hoop
    model%mesh%walls_weigh = scene%grid%reactions
    model%wall_motion%velocity = scene%grid%wall_velocity
    call wall_motion_start(model%wall_motion, features_walls_act(scene%features), model%mesh)
    call set_method(scene, model%method)
    if (model%mesh%walls_act) model%method%debris_speed = 0.0_dp
    kernel = method_kernel(scene%method%kind)
    call list_twins(scene, twin_of)
    allocate (model%bodies(count(twin_of >= 0)), model%totals%bodies(count(twin_of >= 0)))
    call partition_make(model%ranks%partition, model%mesh, kernel, model%method%normalised, &
                        model%mesh%ndim > 1, parallel_rank(), parallel_ranks(), &
                        model%method%rotation, model%method%surfaces, model%method%consistent)
    if (seeded) then
      call partition_first(scene, model, kernel, surveys, error)
      if (allocated(error)) return
    else
      allocate (surveys(size(scene%bodies)))
    end if
    next_id = 1
    heaviest = 0.0_dp
    do b = 1, size(scene%bodies)
      call build_body(scene, b, model, kernel, next_id, seeded, surveys, model%bodies(b), error)
      call parallel_agree(error)
      if (allocated(error)) return
      if (model%ranks%partition%ranks > 1 .and. seeded) then
        next_id = next_id + sum(surveys(b)%points)
      else
        next_id = next_id + model%bodies(b)%particles%count
      end if
      if (model%bodies(b)%rigid) cycle
      associate (particles => model%bodies(b)%particles)
        heaviest = max(heaviest, maxval(particles%motion(:, motion_mass(particles%ndim), &
                                                         :particles%chunks), &
                                        mask=particles%id(:, :particles%chunks) > 0))
      end associate
    end do
    do b = size(scene%bodies) + 1, size(model%bodies)
      call build_body(scene, twin_of(b), model, kernel, next_id, .false., surveys, &
                      model%bodies(b), error)
      if (allocated(error)) return
      model%bodies(b)%twin_of = twin_of(b)
      model%bodies(b)%label = 1 + count(twin_of(:b - 1) == twin_of(b))
    end do
    if (seeded) call burn_light(scene, model%mesh, model%bodies(:size(scene%bodies)))
    model%method%cutoff = scene%method%mass_cutoff*parallel_max(heaviest)
    call contact_pairs(scene, model)
    call build_fields(scene, model, kernel, merge(1, threads, scene%dimension == 1))
    call build_clock(scene, model)
    call stage_terms(model)
    if (.not. seeded) return
    call step_start(model)
    call open_ledger(model)
    associate (sums => model%totals%bodies)
      model%clock%first = closing_first(model%bodies%law, sqrt(2.0_dp*sums%kinetic/ &
                                                               max(sums%mass, tiny(1.0_dp))))
    end associate
    call angular_momentum_note(model%mesh, model%method, model%bodies, model%contact%pairs, &
                               model%totals%bodies, model%turning)
    call check_limit(scene%time, model, error)
    call check_lengths(model%bodies, error)
    call absorbing_check(model%mesh, model%bodies, scene%grid%walls_location, error)
  end subroutine model_build

  !> Which body each is a twin of (sgmp_self_contact): 0 for those of the deck, behind them come the
  !! twins; -1 behind all.
  pure subroutine list_twins(scene, twin_of)
    type(scene_t), intent(in) :: scene
    integer, intent(out) :: twin_of(:)
    integer :: b, n, l
    twin_of = -1
    n = size(scene%bodies)
    twin_of(:n) = 0
    do b = 1, size(scene%bodies)
      if (.not. contact_self(scene, b)) cycle
      do l = 1, self_labels - 1
        n = n + 1
        twin_of(n) = b
      end do
    end do
  end subroutine list_twins

  !> What the cards say about the method, for all steps.
  subroutine set_method(scene, method)
    type(scene_t), intent(in) :: scene
    type(method_t), intent(inout) :: method
    integer :: m
    method%update = scene%method%update
    method%flip = scene%method%flip
    method%gravity = scene%gravity
    method%normalised = scene%method%normalised
    method%interior = scene%method%interior
    method%relaxed = scene%method%volumes_kept
    method%debris_speed = debris_speed(scene)
    method%features = scene%features
    method%rotation = scene%method%rotation .and. scene%dimension > 1  ! a line has none
    method%rubs_at_surface = method%rotation .and. .not. scene%swirl  ! its levers lie in the plane
    method%surfaces = scene%method%surfaces .and. scene%dimension > 1
    method%consistent = scene%method%consistent
    method%consistent_springs = scene%method%consistent_auto
    method%normalised_solids = scene%method%normalised_auto
    method%rotation_solids = scene%method%rotation_auto
    method%surfaces_solids = scene%method%surfaces_auto
    method%drift_remapped = scene%method%drift_remapped
    method%drift_solids = scene%method%drift_auto
    method%swirl = scene%swirl
    method%erodes = any([(scene%materials(m)%law%erosion%given, m=1, size(scene%materials))])
    method%damped = scene%damping%rate > 0.0_dp .or. scene%damping%kinetic
    if (method%damped) method%work_lag = 0.0_dp
    method%damping = scene%damping%rate
    method%kinetic_damping = scene%damping%kinetic
    method%damped_until = scene%damping%until
    method%lost_policy = scene%grid%lost
    method%loses = loses(scene)
    method%removes = any(scene%bodies%removed_at < huge(1.0_dp))
    if (method%erodes .or. method%loses .or. method%removes) then
      method%removed = removed_causes*removed_sums
    end if
  end subroutine set_method

  !> Fastest sound in the bulk of what may become debris that collides: where volumes are kept all
  !! matter does so already, and walls that move or rub are not made for it.
  pure function debris_speed(scene) result(speed)
    type(scene_t), intent(in) :: scene
    real(dp) :: speed
    integer :: m
    speed = 0.0_dp
    if (scene%method%volumes_kept) return
    do m = 1, size(scene%materials)
      if (debris_possible(scene%materials(m)%law)) then
        speed = max(speed, scene%materials(m)%law%bulk_speed)
      end if
    end do
  end function debris_speed

  !> Particles that may leave the grid keep the energy that they then take along.
  pure subroutine keep_energy(scene, body)
    type(scene_t), intent(in) :: scene
    type(body_t), intent(inout) :: body
    if (body%rigid) return
    body%law%history%energy = body%law%history%energy .or. loses(scene)
  end subroutine keep_energy

  !> Whether particles may leave the grid: what a card moves is not reflected.
  pure function loses(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    yes = scene%grid%lost == lost_remove .or. &
          (scene%grid%lost == lost_reflect .and. size(scene%motions) > 0)
  end function loses

  !> A step must have a limit: what cannot deform has no waves.
  pure subroutine check_limit(time, model, error)
    type(time_card_t), intent(in) :: time
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(inout) :: error
    if (model%clock%fixed > 0.0_dp .or. model%findings%fastest > 0.0_dp) return
    call error_make(error, exit_deck, 'nothing limits the time step: no body can deform, and '// &
                    'none moves at the start', 'write the step: time dt=…')
    if (allocated(time%location)) error%location = time%location
  end subroutine check_limit

  subroutine build_body(scene, number, model, kernel, first_id, seeded, surveys, body, error)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number, kernel
    type(model_t), intent(in) :: model
    integer(i4), intent(in) :: first_id
    logical, intent(in) :: seeded
    type(survey_t), intent(in) :: surveys(:)     !! (bodies), where there are several ranks
    type(body_t), intent(out) :: body
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: x(:, :), volume(:), file_velocity(:, :)
    integer(i4), allocatable :: ids(:)
    associate (card => scene%bodies(number), mesh => model%mesh, &
               material => scene%materials(scene%bodies(number)%material))
      if (.not. seeded) then
        allocate (x(3, 0), volume(0), body%given_ids(0))
      else if (model%ranks%partition%ranks > 1) then
        call seeding_generate(card, scene%grid%cell, mesh%origin, mesh%ndim, x, volume, error, &
                              file_velocity, partition_slab(model, kernel), surveys(number), &
                              ids, body%given_ids)
      else
        call seeding_generate(card, scene%grid%cell, mesh%origin, mesh%ndim, x, volume, error, &
                              file_velocity, file_ids=body%given_ids)
      end if
      if (seeded .and. .not. allocated(error)) then
        call seeding_check_overlap(scene%bodies, number, x, mesh%ndim, error)
      end if
      if (allocated(error)) return
      body%name = card%name
      body%first_id = first_id
      body%removed_at = card%removed_at
      body%spacing = card%spacing
      body%half_size = method_half_size(scene%method%kind)
      if (all(body%half_size <= 0.0_dp)) body%half_size = 0.5_dp*body%spacing*mesh%inverse_h
      call attach_force(scene, number, body)
      call loads_declare(scene, number, body)
      call absorbing_declare(card, scene%grid, mesh, material%law, body)
      call driven_declare(scene, number, body)
      call rigid_declare(card, mesh, body)
      call one_sided_declare(scene, mesh, kernel, material%law, body)
      body%sides_stretch = scene%method%kind == method_cpgimp
      body%law = material%law
      body%springs = scene_springs(scene, number)
      call law_set_length(body%law, mesh%h, method_band(scene%method%kind)*mesh%h)
      call law_set_average(body%law, mesh%h, &
                           averaging_spread(sum(body%half_size(:mesh%ndim))/mesh%ndim, &
                                            stencil_width(kernel) == 3), &
                           method_band(scene%method%kind)*mesh%h)
      call debris_set_apart(body%law)
      body%law%rigid = body%rigid
      body%law%ambient = scene%grid%ambient
      call keep_energy(scene, body)
      call law_slots(body%law, tensor_axes(scene))
      call add_columns(scene, number, mesh%ndim, body)
      call stage_columns(scene%features, mesh%ndim, body)
      call one_sided_add_columns(scene, number, mesh%ndim, body)
      call loads_add_columns(mesh%ndim, body)
      call driven_add_columns(body)
      call find_places(mesh, x)
      call seeding_check_inside(card, mesh, x, error)
      if (.not. allocated(error)) call seeding_check_size(card, mesh, x, volume, error)
      if (allocated(error)) return
      call particles_fill(body%particles, mesh%ndim, stencil_shift(kernel), x, &
                          material%law%density, volume, &
                          first_history(card, body), first_id, ids, &
                          bin_span(kernel, mesh%ndim))
      body%particles%path = body%law%slots%path
      call ranks_hold(model%ranks%partition, body%particles)
      call fill_columns(scene, number, mesh, file_velocity, seeded, body, error)
    end associate
  end subroutine build_body

  !> Grid coordinates of positions, in their place.
  subroutine find_places(mesh, x)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(inout) :: x(:, :)           !! (3, n)
    integer :: p, d
    !$omp parallel do schedule(static) default(none) shared(mesh, x) private(d)
    do p = 1, size(x, 2)
      do d = 1, mesh%ndim
        x(d, p) = mesh_find(mesh, d, x(d, p))
      end do
    end do
    !$omp end parallel do
  end subroutine find_places

  !> What particles have at the start besides their place, mass and history. All ranks must call it.
  subroutine fill_columns(scene, number, mesh, file_velocity, seeded, body, error)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(mesh_t), intent(in) :: mesh
    real(dp), allocatable, intent(in) :: file_velocity(:, :)
    logical, intent(in) :: seeded
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(inout) :: error
    associate (card => scene%bodies(number))
      body%matched = scene%method%volumes_matched .and. law_liquid(body%law) .and. &
                     .not. (body%rigid .or. mesh%graded)
      call set_velocities(card, mesh, file_velocity, body)
      call set_swirl(card, mesh, body)
      if (seeded) call set_rotation(card, mesh, body)
      call set_strength(body)
      call set_flaws(mesh, body)
      if (mesh%graded .and. any(card%layout == [layout_gauss, layout_graded])) then
        call set_stretch(mesh, body)
      end if
      if (seeded) then
        call one_sided_rim(card, mesh, body)
        call one_sided_seat(scene%grid, card, mesh, body)
      end if
      if (seeded) call stress_fill(card, scene%gravity, mesh, body, error)
      if (allocated(error)) return
      if (seeded) call file_state_fill(card, mesh%space, body, error)
      if (allocated(error)) return
      call fill_positions(mesh, body)
      call reference_fill(body)
      call contact_fill_slot(card, mesh, body)
      if (seeded) call fill_loads(scene, number, mesh, body, error)
    end associate
  end subroutine fill_columns

  !> Columns for loads and for prescribed motions of parts. All ranks must call it.
  subroutine fill_loads(scene, number, mesh, body, error)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(out) :: error
    call loads_fill(scene, number, mesh, body, error)
    if (.not. allocated(error)) then
      call absorbing_fill(scene%bodies(number), scene%gravity, mesh, body, error)
    end if
    if (.not. allocated(error)) call driven_fill(scene, number, mesh, body, error)
    if (.not. allocated(error)) call swirl_driven_start(mesh, body)
  end subroutine fill_loads

  !> Axes of stress and deformation: with swirl those of space.
  pure function tensor_axes(scene) result(n)
    type(scene_t), intent(in) :: scene
    integer :: n
    n = merge(3, scene%dimension, scene%swirl)
  end function tensor_axes

  !> Columns that the method needs, those of limits of failure and yield stresses that scatter, and
  !! of the compliance of matter whose pressure follows its volume.
  pure subroutine add_columns(scene, number, ndim, body)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number, ndim
    type(body_t), intent(inout) :: body
    real(dp), parameter :: one(1) = 1.0_dp, none(3) = 0.0_dp
    associate (law => body%law, slots => body%law%slots)
      if (body%sides_stretch) call slots_ask(slots, 'stretch', spread(1.0_dp, 1, ndim))
      if (needs_initial(body)) call slots_ask(slots, 'initial', none(:ndim))
      call contact_add_slot(scene, number, slots)
      if (scene%swirl) call slots_ask(slots, 'swirl', none(:1))
      if (law%failure%weibull > 0.0_dp .and. .not. law%rigid) call slots_ask(slots, 'strength', one)
      if (law%scatter%weibull > 0.0_dp .and. .not. law%rigid) then
        call slots_ask(slots, 'yield_factor', one)
      end if
      if (law%erosion%time_step > 0.0_dp .and. scene%method%update == update_usf) then
        call slots_ask(slots, 'reach', none(:1))
      end if
      call ask_flaws(law%failure%flaws%number, law%rigid, slots)
      if (scene%method%volumes_kept .and. law%eos /= eos_none .and. law_is_spherical(law)) then
        call slots_ask(slots, 'compliance', none(:1))
      end if
      if (settles(scene, law)) then
        call slots_ask(slots, 'advanced_energy', none(:1))
        call slots_ask(slots, 'viscous_pressure', none(:1))
      end if
    end associate
  end subroutine add_columns

  !> Whether the stress of debris is settled with its energy in each kick (sgmp_settling): what it
  !! does must be the transpose of the gradient that particles read, and act once a step. Debris
  !! that is settled has no surfaces, and its stress is not normalised (debris_room).
  pure function settles(scene, law) result(yes)
    type(scene_t), intent(in) :: scene
    type(constitutive_t), intent(in) :: law
    logical :: yes
    yes = debris_possible(law) .and. .not. (law%rigid .or. law%softens .or. law%porosity%porous)
    associate (method => scene%method)
      yes = yes .and. debris_speed(scene) > 0.0_dp .and. method%update /= update_usavg .and. &
            .not. (scene%swirl .or. size(scene%contacts) > 0)
    end associate
  end function settles

  !> Body forces that act on a body; a card for the body itself comes before one for all.
  subroutine attach_force(scene, number, body)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(body_t), intent(inout) :: body
    integer :: f
    do f = 1, size(scene%bodyforces)
      if (scene%bodyforces(f)%body /= 0 .and. scene%bodyforces(f)%body /= number) cycle
      if (body%forced .and. scene%bodyforces(f)%body == 0) cycle
      body%forced = .true.
      body%force = scene%bodyforces(f)%force
    end do
  end subroutine attach_force

  !> Whether a body's force refers to the initial position, which must then be stored.
  pure function needs_initial(body) result(yes)
    type(body_t), intent(in) :: body
    logical :: yes
    integer :: i
    yes = any(body%force%uses_initial_position)
    do i = 1, size(body%loads)
      yes = yes .or. load_is_bound(body%loads(i))
    end do
  end function needs_initial

  !> First values of the history columns behind the volume: what the law says, and the card's own.
  pure function first_history(card, body) result(history)
    type(body_card_t), intent(in) :: card
    type(body_t), intent(in) :: body
    real(dp) :: history(2:body%law%slots%total)
    history = slots_first_values(body%law%slots)
    associate (temperature => body%law%slots%temperature)
      if (temperature > 0 .and. card%temperature >= 0.0_dp) history(temperature) = card%temperature
    end associate
  end function first_history

  !> Initial velocities: the card's functions of position, plus what a particle file gives.
  subroutine set_velocities(card, mesh, file_velocity, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    real(dp), allocatable, intent(in) :: file_velocity(:, :)
    type(body_t), intent(inout) :: body
    integer :: c
    !$omp parallel do schedule(static) default(none) shared(card, mesh, file_velocity, body)
    do c = 1, body%particles%chunks
      call set_velocities_of(c, card, mesh, file_velocity, body)
    end do
    !$omp end parallel do
  end subroutine set_velocities

  !> The same of chunk c.
  subroutine set_velocities_of(c, card, mesh, file_velocity, body)
    integer, intent(in) :: c
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    real(dp), allocatable, intent(in) :: file_velocity(:, :)
    type(body_t), intent(inout) :: body
    integer :: l, d, n
    real(dp) :: v(lanes)
    n = mesh%ndim
    associate (particles => body%particles)
      do d = 1, n
        call card%velocity(d)%evaluate_lanes(places(mesh, particles%motion(:, :n, c)), &
                                             particles%id(:, c) /= 0, v)
        if (body%rigid .and. .not. card%free) v = body%speed(d)
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          if (allocated(file_velocity) .and. (card%free .or. .not. body%rigid)) then
            v(l) = v(l) + file_velocity(d, particles%id(l, c) - body%first_id + 1)
          end if
          particles%motion(l, n + d, c) = v(l)
        end do
      end do
    end associate
  end subroutine set_velocities_of

  !> What formulas may use at the start: positions of the lanes of a chunk.
  pure function places(mesh, coordinates) result(values)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coordinates(:, :)    !! (lanes, ndim)
    real(dp) :: values(lanes, expression_places)
    integer :: d
    values = 0.0_dp
    do d = 1, size(coordinates, 2)
      values(:, d) = mesh_place(mesh, d, coordinates(:, d))
    end do
    values(:, 4:6) = values(:, 1:3)
  end function places

  !> Adds an initial rotation; a rigid body then moves as a whole. All ranks must call it.
  subroutine set_rotation(card, mesh, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    if (any(abs(card%spin_at_start) > 0.0_dp)) call add_spin(card, mesh, body)
    if (body%rigid) call rigid_begin(card, mesh, body)
  end subroutine set_rotation

  subroutine add_spin(card, mesh, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    real(dp) :: mass, centre(3), x(3), v(3)
    integer :: c, l, n
    n = mesh%ndim
    call rigid_centre(mesh, body, mass, centre)
    if (card%spin_point(1) < huge(1.0_dp)) centre = card%spin_point
    x = centre
    associate (particles => body%particles)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          x(:n) = mesh_places(mesh, particles%motion(l, :n, c))
          v = cross(card%spin_at_start, x - centre)
          particles%motion(l, n + 1:2*n, c) = particles%motion(l, n + 1:2*n, c) + v(:n)
        end do
      end do
    end associate
  end subroutine add_spin

  !> Initial velocity around the axis, times the radius, from the card's angular velocity.
  subroutine set_swirl(card, mesh, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    integer :: c
    real(dp) :: spin(lanes), radius(lanes)
    if (body%law%slots%swirl == 0 .or. body%rigid) return
    associate (particles => body%particles)
      do c = 1, particles%chunks
        call card%spin%evaluate_lanes(places(mesh, particles%motion(:, :2, c)), &
                                      particles%id(:, c) /= 0, spin)
        radius = graded_place(mesh%axes(1), particles%motion(:, 1, c))
        where (particles%id(:, c) /= 0)
          particles%state(:, body%law%slots%swirl, c) = spin*mesh%h*radius**2
        end where
      end do
    end associate
  end subroutine set_swirl

  !> Limits of failure and yield stress of each particle, where they scatter.
  subroutine set_strength(body)
    type(body_t), intent(inout) :: body
    associate (law => body%law)
      call set_factor(law%failure%weibull, law%failure%seed, law%slots%strength, body%particles)
      call set_factor(law%scatter%weibull, law%scatter%seed, law%slots%yield_factor, body%particles)
    end associate
  end subroutine set_strength

  !> Stretches of particles that lie as many between any two centres begin with the ratios of their
  !! sides, where there is a column for them.
  subroutine set_stretch(mesh, body)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    integer :: c, l, s
    s = body%law%slots%stretch
    if (s == 0) return
    do c = 1, body%particles%chunks
      do l = 1, lanes
        if (body%particles%id(l, c) == 0) cycle
        body%particles%state(l, s:s + mesh%ndim - 1, c) = &
          mesh_sides(mesh, body%particles%motion(l, :mesh%ndim, c))
      end do
    end do
  end subroutine set_stretch

  !> Columns of flaws, where matter has them.
  pure subroutine ask_flaws(flaws, rigid, slots)
    real(dp), intent(in) :: flaws        !! per volume
    logical, intent(in) :: rigid
    type(slots_t), intent(inout) :: slots
    real(dp), parameter :: one(1) = 1.0_dp
    if (rigid .or. .not. flaws > 0.0_dp) return
    call slots_ask(slots, 'flaw_strain', one)
    call slots_ask(slots, 'flaw_radius', one)
  end subroutine ask_flaws

  !> The weakest flaw of each particle, and its size; in one and two dimensions it is as deep as it
  !! is wide, of a ring its cross-section counts.
  subroutine set_flaws(mesh, body)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    real(dp) :: volume
    integer :: c, l
    if (body%law%slots%flaw_strain == 0) return
    associate (particles => body%particles, slots => body%law%slots, failure => body%law%failure)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          volume = particles%state(l, slots%volume, c)
          if (mesh%space == space_axisymmetric) then
            volume = volume/(2.0_dp*pi*mesh%h*graded_place(mesh%axes(1), particles%motion(l, 1, c)))
          end if
          volume = volume**(3.0_dp/real(particles%ndim, dp))
          call flaws_first(failure%flaws, volume, strength_variate(failure%seed, &
                                                                   particles%id(l, c)), &
                           particles%state(l, slots%flaw_strain, c), &
                           particles%state(l, slots%flaw_radius, c))
        end do
      end do
    end associate
  end subroutine set_flaws

  !> Factor of each particle on what scatters, if there is a column for it.
  subroutine set_factor(weibull, seed, column, particles)
    real(dp), intent(in) :: weibull
    integer, intent(in) :: seed, column
    type(particles_t), intent(inout) :: particles
    integer :: c, l
    if (column == 0) return
    do c = 1, particles%chunks
      do l = 1, lanes
        if (particles%id(l, c) == 0) cycle
        particles%state(l, column, c) = strength_factor(weibull, seed, particles%id(l, c))
      end do
    end do
  end subroutine set_factor

  !> The initial position, where a force uses it.
  subroutine fill_positions(mesh, body)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    integer :: c, l
    if (body%law%slots%initial == 0) return
    do c = 1, body%particles%chunks
      do l = 1, lanes
        if (body%particles%id(l, c) == 0) cycle
        body%particles%state(l, body%law%slots%initial: &
                             body%law%slots%initial + mesh%ndim - 1, c) = &
            mesh_places(mesh, body%particles%motion(l, :mesh%ndim, c))
      end do
    end do
  end subroutine fill_positions

  !> Bodies of one field average their plastic strain over one length.
  subroutine check_lengths(bodies, error)
    type(body_t), intent(in) :: bodies(:)
    type(error_t), allocatable, intent(inout) :: error
    integer :: a, b
    if (allocated(error)) return
    do b = 2, size(bodies)
      do a = 1, b - 1
        if (bodies(a)%field /= bodies(b)%field .or. bodies(a)%rigid .or. bodies(b)%rigid) cycle
        if (.not. (bodies(a)%law%history%averaged .and. bodies(b)%law%history%averaged)) cycle
        if (abs(bodies(a)%law%failure%length - bodies(b)%law%failure%length) <= 0.0_dp) cycle
        call error_make(error, exit_deck, "bodies '"//trim(bodies(a)%name)//"' and '"// &
                        trim(bodies(b)%name)//"' move in one field and average their plastic "// &
                        'strain over different lengths', 'give both cards failure one length, '// &
                        'or the bodies a card contact')
        return
      end do
    end do
  end subroutine check_lengths

  !> Velocity fields and the threads that work on them.
  subroutine build_fields(scene, model, kernel, threads)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    integer, intent(in) :: kernel, threads
    integer :: f
    type(matter_t) :: matter
    logical :: moves(size(model%bodies))
    integer, dimension(contact_fields(model)) :: parts, terms
    allocate (model%fields(contact_fields(model)))
    call driven_number(model, parts, terms)
    allocate (model%turning(size(model%fields)))
    do f = 1, size(model%fields)
      moves = model%bodies%field == f .and. .not. model%bodies%rigid
      matter = matter_of(model%bodies, moves)
      call field_init(model%fields(f), model%mesh, kernel, &
                      columns_build(model, kernel, matter, parts(f)))
      model%fields(f)%drive_terms = terms(f)
      model%fields(f)%gaps = matter%solid
      model%fields(f)%linear = matter%bends
      where (model%bodies%field == f) model%bodies%linear = matter%bends
      if (scene%method%hoop_auto .and. .not. model%fields(f)%gaps .and. &
          (scene%method%normalised_auto .or. .not. scene%method%normalised)) then
        model%fields(f)%hoop_correction = lattice_correction(scene, model, moves)
      end if
    end do
    call team_make(model%team, threads, model%mesh%space, size(model%fields), size(model%bodies))
    allocate (model%ranks%below(size(model%fields)), model%ranks%above(size(model%fields)))
    call ranks_renew_bins(model%ranks, model%bodies)
    call phase_layout(model%mesh, model%fields, model%bodies, model%contact, model%team, &
                      model%ranks%partition)
  end subroutine build_fields

  !> Correction of the hoop strain of a field of fluids whose stress is not normalised: that of
  !! their lattice, if they have one whose origin is left to the program, and no jitter.
  pure function lattice_correction(scene, model, moves) result(correction)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical, intent(in) :: moves(:)              !! bodies of the field
    real(dp) :: correction
    real(dp) :: number
    integer :: b
    correction = model%mesh%hoop
    number = 0.0_dp
    do b = 1, size(scene%bodies)
      if (.not. moves(b)) cycle
      associate (card => scene%bodies(b))
        if (all(card%layout /= [layout_lattice, layout_graded]) .or. card%jitter > 0.0_dp .or. &
            card%lattice_origin(1) < infinite_length) return
      end associate
      if (number > 0.0_dp .and. abs(number*model%bodies(b)%spacing - model%mesh%h) > &
          1.0e-6_dp*model%mesh%h) return
      number = model%mesh%h/model%bodies(b)%spacing
    end do
    if (nint(number) < 1 .or. abs(number - anint(number)) > 1.0e-6_dp) return
    correction = axis_correction_lattice(nint(number))
  end function lattice_correction

  !> The clock's settings.
  subroutine build_clock(scene, model)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    model%clock%cfl = scene%time%cfl
    model%clock%automatic = scene%time%cfl_auto
    model%clock%fixed = scene%time%dt
    model%clock%growth = scene%time%growth
    model%clock%smallest = scene%time%dt_min
  end subroutine build_clock

  !> Energies and sums of the initial state: sums over each chunk, put together exactly.
  subroutine open_ledger(model)
    type(model_t), intent(inout) :: model
    real(dp), allocatable :: terms(:, :)
    real(dp) :: totals(body_terms)
    logical :: counted(size(model%bodies))       !! in the ledger
    integer :: b, c
    do b = 1, size(model%bodies)
      associate (particles => model%bodies(b)%particles, sums => model%totals%bodies(b))
        allocate (terms(body_terms, particles%chunks))
        !$omp parallel do schedule(static) default(none) shared(model, terms, b)
        do c = 1, model%bodies(b)%particles%chunks
          terms(:, c) = chunk_terms(model%mesh, model%bodies(b), c)
        end do
        !$omp end parallel do
        call parallel_exact_sums(terms, totals)
        deallocate (terms)
        sums = body_sums_t(mass=totals(1), moment=totals(2:4), momentum=totals(5:7), &
                           kinetic=totals(8), internal=totals(9))
        associate (motion => model%bodies(b)%rigid_motion)
          if (motion%free) then
            sums%momentum = motion%momentum(:3)
            sums%kinetic = motion_energy(motion)
          end if
        end associate
      end associate
    end do
    counted = .not. model%bodies%rigid .or. model%bodies%rigid_motion%free
    call ledger_open(model%ledger, sum(model%totals%bodies%kinetic, mask=counted), &
                     sum(model%totals%bodies%internal), &
                     [(sum(model%totals%bodies%momentum(c), mask=counted), c=1, 3)], &
                     least=0.5_dp*sum(model%totals%bodies%mass, mask=counted)* &
                           (still*model%findings%fastest)**2)
  end subroutine open_ledger

  !> Mass, moment, momentum, kinetic and internal energy of a chunk.
  pure function chunk_terms(mesh, body, c) result(terms)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    integer, intent(in) :: c                     !! chunk
    real(dp) :: terms(body_terms)
    real(dp) :: m
    integer :: l, n
    terms = 0.0_dp
    n = mesh%ndim
    associate (particles => body%particles, energy => body%law%slots%energy, &
               swirl => body%law%slots%swirl)
      do l = 1, lanes
        if (particles%id(l, c) == 0) cycle
        m = particles%motion(l, motion_mass(particles%ndim), c)
        terms(1) = terms(1) + m
        terms(2:1 + n) = terms(2:1 + n) + m*graded_place(mesh%axes(:n), particles%motion(l, :n, c))
        terms(5:4 + n) = terms(5:4 + n) + m*particles%motion(l, n + 1:2*n, c)
        terms(8) = terms(8) + 0.5_dp*m*sum(particles%motion(l, n + 1:2*n, c)**2)
        if (swirl > 0) then
          terms(7) = terms(7) + m*particles%state(l, swirl, c)
          terms(8) = terms(8) + 0.5_dp*m*(particles%state(l, swirl, c)/ &
                                          graded_place(mesh%axes(1), particles%motion(l, 1, c)))**2
        end if
        if (body%stressed) then
          terms(9) = terms(9) + first_energy(body, m, particles%state(l, :, c))
        else if (energy > 0) then
          terms(9) = terms(9) + particles%state(l, energy, c)*particles%state(l, 1, c)
        end if
      end do
    end associate
  end function chunk_terms

  !> Internal energy of a particle that begins with a stress: what it keeps, or that of the stress.
  pure function first_energy(body, mass, state) result(energy)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: mass, state(:)
    real(dp) :: energy
    associate (slots => body%law%slots)
      if (slots%energy > 0) then
        energy = state(slots%energy)*mass/body%law%density
      else
        energy = state(slots%volume)* &
                 stress_energy(body%law, state(slots%stress:slots%stress + slots%stresses - 1))
      end if
    end associate
  end function first_energy

end module sgmp_build_model
