!> The phases of a step over all fields and threads: who does which planes, in which order results
!! are put together.
module sgmp_phases
  use sgmp_body, only: body_forced, body_number, body_place
  use sgmp_columns, only: node_acceleration, node_remapped, node_velocity
  use sgmp_contact, only: contact_detect, contact_layout, contact_meet, contact_trial, &
                          contact_velocity
  use sgmp_contact_exchange, only: contact_exchange
  use sgmp_contact_ledger, only: contact_add_up, contact_close, contact_sums_t
  use sgmp_energy, only: step_sums_t
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_field, only: field_build
  use sgmp_field_nodes, only: field_normalise, field_remap, field_solve, field_velocity
  use sgmp_field_sweep, only: field_divide, field_sweep, sweep_columns
  use sgmp_halo, only: halo_own_planes
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_max_place
  use sgmp_plan, only: plan_t
  use sgmp_rigid_bodies, only: rigid_choose_speed, rigid_field, rigid_solve, rigid_velocity
  use sgmp_rows, only: rows_t, rows_union
  use sgmp_scene, only: update_usf
  use sgmp_sums, only: nodes_external, nodes_ignored, nodes_mass_aa, nodes_mass_av, nodes_sums, &
                       sum_internal, sum_kinetic, sum_mass_aa, sum_moment, sum_momentum, &
                       sum_viscous, sweep_sums
  use sgmp_tally, only: tally_add, tally_reset, tally_total
  use sgmp_text, only: integer_text
  use sgmp_timers, only: phase_contact, phase_halo, timers_move, wall_time
  use sgmp_walls, only: has_walls, walls_fold, walls_mirror
  implicit none
  private
  public :: phase_layout, phase_normalise, phase_sweep, phase_fold, phase_solve, &
            phase_velocity, phase_remap, phase_mirror, phase_open_sums, phase_close_sums

contains

  !> Lays out fields for the bins of their bodies and divides the planes among the threads.
  subroutine phase_layout(model, changed)
    type(model_t), intent(inout) :: model
    logical, intent(in), optional :: changed(:)  !! (fields) whose bins are new; absent: all
    type(rows_t) :: bins, more
    integer :: f, b
    do f = 1, size(model%fields)
      if (present(changed)) then
        if (.not. changed(f)) cycle
      end if
      bins%n = 0
      if (allocated(bins%key)) deallocate (bins%key, bins%first, bins%last)
      allocate (bins%key(0), bins%first(0), bins%last(0))
      do b = 1, size(model%bodies)
        if (model%bodies(b)%field /= f) cycle
        call rows_union(bins, model%bodies(b)%particles%bins, more)
        bins = more
      end do
      call field_build(model%fields(f), bins)
      do b = 1, size(model%bodies)
        if (model%bodies(b)%field == f) call body_place(model%bodies(b), model%fields(f))
      end do
      call field_divide(model, f)
    end do
    call contact_layout(model%contact, model%mesh, model%fields, model%bodies, &
                        model%partition%own + [0, model%partition%nodes])
  end subroutine phase_layout

  !> One sweep over all particles.
  subroutine phase_sweep(model, plan)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer :: f, b
    model%fastest = merge(0.0_dp, model%fastest, plan%strain)
    do f = 1, size(model%fields)
      b = rigid_field(model%bodies, f)
      if (b > 0 .and. model%clock%dt > 0.0_dp) then
        if (model%bodies(b)%at_rest) cycle  ! nothing of it changes after the first projection
      end if
      call field_sweep(model, plan, f)
    end do
  end subroutine phase_sweep

  !> Forgets the sums of the step before.
  subroutine phase_open_sums(model)
    type(model_t), intent(inout) :: model
    model%sums = step_sums_t()
    model%contact%terms%n = 0
    call tally_reset(model%tally, size(model%bodies)*sweep_sums + nodes_sums)
  end subroutine phase_open_sums

  !> Puts together what the ranks have found in a step: sums, particles, the fastest of them, and
  !! whether anything failed; with `book` the sums are those of a whole step.
  subroutine phase_close_sums(model, book)
    type(model_t), intent(inout) :: model
    logical, intent(in) :: book
    real(dp) :: totals(size(model%bodies)*sweep_sums + nodes_sums), since
    integer(i8) :: counts(size(model%bodies) + 4)
    integer :: b, n
    since = wall_time()
    n = size(model%bodies)
    counts(:n) = int(model%bodies%particles%count, i8)
    counts(n + 1) = int(model%lost_here, i8)
    counts(n + 2) = merge(1_i8, 0_i8, allocated(model%failure))
    counts(n + 3) = own_points(model)
    counts(n + 4) = int(model%contact%terms%n, i8)
    call tally_total(model%tally, totals, counts)
    call parallel_max_place(model%fastest, model%fastest_id, model%fastest_field)
    if (counts(n + 2) > 0_i8) call parallel_agree(model%failure)
    model%counts = counts(:n)
    model%points = counts(n + 3)
    model%lost = model%lost + int(counts(n + 1))
    model%lost_here = 0
    if (book) then
      do b = 1, n
        call book_body(model, b, totals((b - 1)*sweep_sums + 1:b*sweep_sums))
      end do
      call book_nodes(model, totals(n*sweep_sums + 1:))
      call book_contact(model, counts(n + 4) > 0_i8)
    end if
    if (model%partition%ranks > 1) call timers_move(model%timers, phase_halo, since)
  end subroutine phase_close_sums

  !> Grid points stored in the planes of this rank.
  pure function own_points(model) result(points)
    type(model_t), intent(in) :: model
    integer(i8) :: points
    integer :: f, p1, p2
    points = 0_i8
    do f = 1, size(model%fields)
      call halo_own_planes(model%fields(f), model%partition, p1, p2)
      points = points + model%fields(f)%plane_start(p2 + 1) - model%fields(f)%plane_start(p1)
    end do
  end function own_points

  !> Adds a body's sums to those of the step.
  pure subroutine book_body(model, b, sums)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: sums(sweep_sums)
    if (model%bodies(b)%at_rest) return
    model%body_sums(b)%moment = sums(sum_moment:sum_moment + 2)
    model%body_sums(b)%momentum = sums(sum_momentum:sum_momentum + 2)
    model%body_sums(b)%kinetic = sums(sum_kinetic)
    if (model%bodies(b)%rigid) return  ! its energy and momentum belong to whoever moves it
    model%body_sums(b)%internal = model%body_sums(b)%internal + sums(sum_internal)
    model%sums%kinetic = model%sums%kinetic + sums(sum_kinetic)
    model%sums%particles_aa = model%sums%particles_aa + sums(sum_mass_aa)
    model%sums%momentum = model%sums%momentum + sums(sum_momentum:sum_momentum + 2)
    model%sums%internal = model%sums%internal + sums(sum_internal)
    model%sums%viscous = model%sums%viscous + sums(sum_viscous)
  end subroutine book_body

  !> Adds the nodes' sums.
  pure subroutine book_nodes(model, sums)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: sums(nodes_sums)
    model%sums%nodes_aa = model%sums%nodes_aa + sums(nodes_mass_aa)
    model%sums%power_before = model%sums%power_before + sums(nodes_mass_av)
    model%sums%external_power = model%sums%external_power + sums(nodes_external)
    model%sums%ignored_nodes = model%sums%ignored_nodes + sums(nodes_ignored)
  end subroutine book_nodes

  !> Adds what contact did to the sums of the step.
  subroutine book_contact(model, anywhere)
    type(model_t), intent(inout) :: model
    logical, intent(in) :: anywhere        !! on some rank
    type(contact_sums_t) :: sums
    associate (all => model%sums)
      sums = contact_sums_t(all%contact, all%rigid_work, all%nodes_aa, all%power_before, &
                            all%external_power)
      call contact_close(model%contact, anywhere, sums)
      all%contact = sums%dissipation
      all%rigid_work = sums%rigid_work
      all%nodes_aa = sums%nodes_aa
      all%power_before = sums%power_before
      all%external_power = sums%external_power
    end associate
  end subroutine book_contact

  !> Folds what was just scattered behind walls.
  subroutine phase_fold(model, plan)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    type(plan_t) :: own
    integer :: f, axis, p
    do f = 1, size(model%fields)
      own = plan
      call sweep_columns(own, model%fields(f))
      do axis = 1, model%mesh%ndim
        if (.not. has_walls(model%mesh, axis)) cycle
        if (axis == model%mesh%ndim) then
          call walls_fold(model%fields(f), model%mesh, axis, 1, model%fields(f)%planes, &
                          own%first_column, own%last_column)
        else
          !$omp parallel do num_threads(model%threads) if(model%threads > 1) &
          !$omp& default(none) shared(model, own, f, axis) private(p)
          do p = 1, model%fields(f)%planes
            call walls_fold(model%fields(f), model%mesh, axis, p, p, own%first_column, &
                            own%last_column)
          end do
          !$omp end parallel do
        end if
      end do
    end do
  end subroutine phase_fold

  !> Fills nodes behind walls with their mirror images, in all fields that the walls act on.
  subroutine phase_mirror(model, columns)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: columns(:)
    integer :: f
    do f = 1, size(model%fields)
      if (rigid_field(model%bodies, f) == 0) call mirror(model, f, columns)
    end do
  end subroutine phase_mirror

  !> Fills nodes behind walls with their mirror images.
  subroutine mirror(model, f, columns)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f, columns(:)
    integer :: axis, p
    do axis = 1, model%mesh%ndim
      if (.not. has_walls(model%mesh, axis)) cycle
      if (axis == model%mesh%ndim) then
        call walls_mirror(model%fields(f), model%mesh, axis, 1, model%fields(f)%planes, columns)
      else
        !$omp parallel do num_threads(model%threads) if(model%threads > 1) &
        !$omp& default(none) shared(model, f, axis, columns) private(p)
        do p = 1, model%fields(f)%planes
          call walls_mirror(model%fields(f), model%mesh, axis, p, p, columns)
        end do
        !$omp end parallel do
      end if
    end do
  end subroutine mirror

  !> Volume-normalised stress at all centres, where the scene asks for it.
  subroutine phase_normalise(model)
    type(model_t), intent(inout) :: model
    integer :: f
    if (.not. model%normalised) return
    do f = 1, size(model%fields)
      call field_normalise(model, f)
    end do
  end subroutine phase_normalise

  !> Momentum equation at all nodes (Eqs. 33, 34).
  subroutine phase_solve(model, dt)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt
    real(dp), allocatable :: sums(:, :)
    integer :: f, p, b, p1, p2
    call rigid_choose_speed(model%bodies, model%clock%time + 0.5_dp*model%clock%dt, &
                            model%mesh%ndim)
    do f = 1, size(model%fields)
      b = rigid_field(model%bodies, f)
      if (b > 0) then
        call rigid_solve(model%bodies(b), model%fields(f), dt)
        cycle
      end if
      allocate (sums(nodes_sums, model%fields(f)%planes), source=0.0_dp)
      call field_solve(model, f, dt, model%gravity, body_forced(model%bodies, f), sums)
      call halo_own_planes(model%fields(f), model%partition, p1, p2)
      do p = p1, p2
        call tally_add(model%tally, 1 + size(model%bodies)*sweep_sums, sums(:, p))
      end do
      deallocate (sums)
    end do
    if (model%update /= update_usf) call find_contact(model)
    call contact_force(model, dt)
    call phase_mirror(model, [node_acceleration, node_velocity(model%mesh%ndim)])
  end subroutine phase_solve

  !> Nodal velocity before the stress update (USF).
  subroutine phase_velocity(model)
    type(model_t), intent(inout) :: model
    integer :: f, b
    do f = 1, size(model%fields)
      b = rigid_field(model%bodies, f)
      if (b > 0) then
        call rigid_velocity(model%bodies(b), model%fields(f), node_velocity(model%mesh%ndim))
      else
        call field_velocity(model, f)
      end if
    end do
    call find_contact(model)
    call admit_velocity(model, node_velocity(model%mesh%ndim))
    call phase_mirror(model, [node_velocity(model%mesh%ndim)])
  end subroutine phase_velocity

  !> Nodal velocity re-mapped from the updated particles (MUSL).
  subroutine phase_remap(model)
    type(model_t), intent(inout) :: model
    integer :: f, b
    do f = 1, size(model%fields)
      b = rigid_field(model%bodies, f)
      if (b > 0) then
        call rigid_velocity(model%bodies(b), model%fields(f), node_remapped)
      else
        call field_remap(model, f)
      end if
    end do
    call admit_velocity(model, node_remapped)
    call phase_mirror(model, [node_remapped])
  end subroutine phase_remap

  !> Normals and touching pairs at all shared nodes.
  subroutine find_contact(model)
    type(model_t), intent(inout) :: model
    logical :: complete
    real(dp) :: since
    if (model%contact%shared%nodes == 0) return
    since = wall_time()
    call contact_meet(model%contact, model%fields, model%bodies, model%cutoff, model%moved > 0, &
                      model%threads)
    call timers_move(model%timers, phase_contact, since)
    call contact_exchange(model%contact%shared, model%bodies, model%partition, model%swap, &
                          model%traffic, complete)
    if (.not. complete .and. .not. allocated(model%failure)) then
      call error_make(model%failure, exit_numerical, 'a rank has no place for particles of its '// &
                      'neighbour in step '//integer_text(model%clock%step + 1), &
                      'this is a fault of the program: report it')
    end if
    call timers_move(model%timers, phase_halo, since)
    call contact_detect(model%contact, model%mesh, model%fields, model%bodies, model%threads)
    call timers_move(model%timers, phase_contact, since)
  end subroutine find_contact

  !> Contact forces at all shared nodes.
  subroutine contact_force(model, dt)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt             !! velocity step dt^k
    real(dp) :: since
    if (model%contact%shared%nodes == 0) return
    since = wall_time()
    call contact_trial(model%contact, model%fields, model%bodies, dt, model%threads)
    call contact_add_up(model%contact, model%mesh, model%fields, model%bodies, &
                        model%partition%own, model%gravity, dt)
    call timers_move(model%timers, phase_contact, since)
  end subroutine contact_force

  !> Makes the velocity in some columns admissible at all shared nodes.
  subroutine admit_velocity(model, column)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: column
    real(dp) :: since
    if (model%contact%shared%nodes == 0) return
    since = wall_time()
    call contact_velocity(model%contact, model%fields, model%bodies, column, model%threads)
    call timers_move(model%timers, phase_contact, since)
  end subroutine admit_velocity

end module sgmp_phases
