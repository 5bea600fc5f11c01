!> Particles that change bins: those that leave the grid or the rank, those that come, and what they
!! bring to the grid.
module sgmp_rebin_phases
  use sgmp_body, only: body_particle, body_t
  use sgmp_buffer, only: buffer_left, buffer_put, buffer_t, buffer_whole
  use sgmp_contact, only: contact_t
  use sgmp_errors, only: error_make, error_t, exit_numerical
  use sgmp_field, only: field_t
  use sgmp_field_sweep, only: sweep_columns
  use sgmp_findings, only: findings_t
  use sgmp_graded_axis, only: graded_place
  use sgmp_kernels, only: stencil_width
  use sgmp_kinds, only: dp, i4
  use sgmp_lost_particles, only: lost_particles_find_bins
  use sgmp_mesh, only: mesh_place, mesh_t
  use sgmp_motion, only: motion_mass, motion_velocity
  use sgmp_movers, only: movers_read, movers_reset, movers_t, movers_write
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_pace, only: pace_due
  use sgmp_parallel, only: parallel_any, parallel_collect
  use sgmp_particles, only: bin_coordinates, particles_t
  use sgmp_partition, only: partition_t
  use sgmp_phases, only: phase_fold, phase_layout
  use sgmp_plan, only: plan_t
  use sgmp_ranks, only: ranks_t
  use sgmp_rebinning, only: arrivals_t, particles_close_lists, particles_extend_bins, &
                            particles_receive, particles_receive_rest
  use sgmp_self_movers, only: self_hand_over
  use sgmp_space, only: axis_names
  use sgmp_sums, only: nodes_sums, removed_by_card, removed_by_erosion, removed_by_loss, &
                       removed_causes, &
                       removed_count, removed_internal, removed_kinetic, removed_mass, &
                       removed_moment, removed_momentum, removed_sums, sweep_sums
  use sgmp_tally, only: tally_add
  use sgmp_team, only: team_divide, team_t
  use sgmp_text, only: integer_text, real_text
  use sgmp_timers, only: phase_halo, timers_move, timers_t, wall_time
  implicit none
  private
  public :: phase_rebin_particles

  integer, parameter :: few = 512                !! movers that are not worth a meeting of threads

contains

  !> Moves particles to their new bins, follows them with the grid, and folds the moments at walls.
  ! allow(S901): movers of all kinds, one after the other
  subroutine phase_rebin_particles(plan, mesh, fields, bodies, contact, team, ranks, findings, &
                                   timers)
    type(plan_t), intent(in) :: plan
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(contact_t), intent(inout) :: contact
    type(team_t), intent(inout) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    integer :: b, f
    logical :: changed(size(fields))
    changed = .false.
    findings%moved = 0
    if (plan%drift) then
      call report_escaped(plan, mesh, bodies, team%movers, findings%failure)
      if (any(bodies%relabels)) then
        call self_hand_over(mesh, bodies, team%movers(:, :size(team%movers, 2) - 1))
        bodies%relabels = .false.
      end if
      do b = 1, size(bodies)
        if (bodies(b)%rigid) cycle
        if (.not. (plan%loses .or. bodies(b)%law%erosion%given .or. bodies(b)%leaves)) cycle
        call book_removed(mesh, b, bodies, team%movers(b, :size(team%movers, 2) - 1), findings)
      end do
      if (ranks%partition%ranks > 1) then
        call exchange_movers(plan, mesh, bodies, team%movers, ranks, findings, timers)
      end if
      findings%moved = sum(team%movers%n)
      do b = 1, size(bodies)
        if (.not. any(team%movers(b, :)%without_bin)) cycle
        associate (particles => bodies(b)%particles)
          call particles_extend_bins(particles, team%movers(b, :), mesh%lower - particles%shift, &
                                     mesh%upper + particles%shift)
        end associate
        changed(bodies(b)%field) = .true.
      end do
      if (any(changed)) then
        call phase_layout(mesh, fields, bodies, contact, team, ranks%partition, changed)
      end if
      do f = 1, size(fields)
        if (changed(f) .or. .not. pace_due(team%paces(f))) cycle
        call team_divide(team, f, fields(f), bodies, ranks%partition)
      end do
      do b = 1, size(bodies)
        if (all(team%movers(b, :)%n == 0 .and. team%movers(b, :)%freed == 0)) cycle
        call settle_movers(plan, mesh, fields(bodies(b)%field), bodies(b), team, &
                           team%movers(b, :), findings%lost_here)
      end do
    end if
    call phase_fold(plan, mesh, fields, team%threads)
  end subroutine phase_rebin_particles

  !> An error for the first particle that has left the grid where it must not.
  subroutine report_escaped(plan, mesh, bodies, lists, failure)
    type(plan_t), intent(in) :: plan
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    type(movers_t), intent(in) :: lists(:, :)    !! (bodies, slabs + 1)
    type(error_t), allocatable, intent(inout) :: failure
    integer :: b, s
    do b = 1, size(bodies)
      do s = 1, size(lists, 2) - 1
        associate (movers => lists(b, s), m => lists(b, s)%escaped(1), &
                   d => lists(b, s)%escaped(2))
          if (movers%n == 0 .or. m == 0 .or. allocated(failure)) cycle
          if (movers%particle(d, m) /= movers%particle(d, m)) then
            call error_make(failure, exit_numerical, body_particle(bodies, movers%id(m))// &
                            ' is nowhere: its place along '//axis_names(d, mesh%space)// &
                            ' is not a number after step '//integer_text(plan%step), &
                            'look at formulas of time and place, and at cfl')
            return
          end if
          call error_make(failure, exit_numerical, body_particle(bodies, movers%id(m))// &
                          ' left the grid along '//axis_names(d, mesh%space)//' at '// &
                          real_text(mesh_place(mesh, d, movers%particle(d, m)))// &
                          ' in step '//integer_text(plan%step), &
                          'extend the grid, leave that face open, or choose '// &
                          '`lost policy=remove` or `reflect`')
        end associate
      end do
    end do
  end subroutine report_escaped

  !> Adds what particles of a body that are removed take along to the sums of the step.
  subroutine book_removed(mesh, b, bodies, lists, findings)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: b                     !! the body
    type(body_t), intent(in) :: bodies(:)
    type(movers_t), intent(in) :: lists(:)       !! of the body, of its own slabs
    type(findings_t), intent(inout) :: findings
    integer :: s, m, first
    first = 1 + size(bodies)*sweep_sums + nodes_sums + (b - 1)*removed_causes*removed_sums
    do s = 1, size(lists)
      do m = 1, lists(s)%n
        if (lists(s)%eroded(m)) then
          call tally_add(findings%tally, first + removed_sums*merge( &
                         removed_by_card, removed_by_erosion, bodies(b)%leaves), &
                         taken_along(mesh, bodies(b), lists(s)%particle(:, m)))
        else if (lists(s)%gone(m)) then
          call tally_add(findings%tally, first + removed_by_loss*removed_sums, &
                         taken_along(mesh, bodies(b), lists(s)%particle(:, m)))
        end if
      end do
    end do
  end subroutine book_removed

  !> What a particle takes along; with swirl its third momentum is that about the axis.
  pure function taken_along(mesh, body, particle) result(terms)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: particle(:)          !! columns of motion, then of state
    real(dp) :: terms(removed_sums)
    real(dp) :: mass, around, radius
    integer :: n
    associate (law => body%law, columns => body%particles%motion_columns)
      n = body%particles%ndim
      mass = particle(motion_mass(n))
      terms = 0.0_dp
      terms(removed_count) = 1.0_dp
      terms(removed_mass) = mass
      terms(removed_moment:removed_moment + n - 1) = mass*graded_place(mesh%axes(:n), particle(:n))
      associate (velocity => particle(motion_velocity(n):motion_velocity(n) + n - 1))
        terms(removed_momentum:removed_momentum + n - 1) = mass*velocity
        terms(removed_kinetic) = 0.5_dp*mass*sum(velocity**2)
      end associate
      terms(removed_internal) = mass/law%density*particle(columns + law%slots%energy)
      if (law%slots%swirl == 0) return
      around = particle(columns + law%slots%swirl)  ! v_theta X
      radius = graded_place(mesh%axes(1), particle(1))
      terms(removed_momentum + 2) = mass*around
      terms(removed_kinetic) = terms(removed_kinetic) + &
                               0.5_dp*mass*(around/max(radius, tiny(1.0_dp)))**2
    end associate
  end function taken_along

  !> Tells the neighbours of the particles that have moved into their planes, or next to them.
  !!
  !! Where particles may cross more than a cell, every rank tells all others.
  subroutine exchange_movers(plan, mesh, bodies, lists, ranks, findings, timers)
    type(plan_t), intent(in) :: plan
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    type(movers_t), intent(inout) :: lists(:, :)  !! (bodies, slabs + 1)
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    type(buffer_t) :: all
    real(dp) :: since
    integer :: b, s, m, n, plane, bin(3), received
    logical :: far
    since = wall_time()
    received = size(lists, 2)
    far = goes_far(plan, mesh, bodies, lists(:, :received - 1), ranks%partition, findings)
    do b = 1, size(bodies)
      call movers_reset(lists(b, received), size(lists(b, 1)%particle, 1), &
                        size(lists(b, 1)%values, 1))
      do s = 1, received - 1
        associate (movers => lists(b, s), particles => bodies(b)%particles, &
                   partition => ranks%partition)
          do m = 1, movers%n
            if (movers%eroded(m)) cycle
            bin = bin_coordinates(particles, movers%particle(:, m))
            plane = bin(3)
            if (far) then
              call write_mover(b, movers, m, all)
              cycle
            end if
            if (plane < partition%own(1) + partition%bins(2)) then
              call write_mover(b, movers, m, ranks%messages%to_below)
            end if
            if (plane > partition%own(2) - partition%bins(1)) then
              call write_mover(b, movers, m, ranks%messages%to_above)
            end if
            if (beyond_neighbours(plane, partition)) then
              call moved_too_far(plan, bodies, movers%id(m), findings%failure)
            end if
          end do
        end associate
      end do
    end do
    if (far) then
      if (.not. allocated(all%values)) allocate (all%values(0))
      n = all%n
      call parallel_collect(all%values(:n), ranks%messages%from_below%values)
      ranks%messages%from_below%n = size(ranks%messages%from_below%values)
      ranks%messages%from_below%read = 0
      call read_movers(lists(:, received), ranks%messages%from_below)
    else
      call neighbours_send(ranks%messages, ranks%traffic)
      call neighbours_receive(ranks%messages)
      call read_movers(lists(:, received), ranks%messages%from_below)
      call read_movers(lists(:, received), ranks%messages%from_above)
      call neighbours_wait(ranks%messages)
    end if
    do b = 1, size(bodies)
      call lost_particles_find_bins(mesh, bodies(b)%particles, lists(b, received))
    end do
    call timers_move(timers, phase_halo, since)
  end subroutine exchange_movers

  pure subroutine write_mover(b, movers, m, buffer)
    integer, intent(in) :: b, m
    type(movers_t), intent(in) :: movers
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, [real(b, dp)])
    call movers_write(movers, m, buffer)
  end subroutine write_mover

  subroutine read_movers(lists, buffer)
    type(movers_t), intent(inout) :: lists(:)    !! (bodies)
    type(buffer_t), intent(inout) :: buffer
    integer :: b
    do while (buffer_left(buffer))
      call buffer_whole(buffer, b)
      call movers_read(lists(b), buffer)
    end do
  end subroutine read_movers

  !> Whether particles of some rank may have moved beyond the planes next to its own.
  logical function goes_far(plan, mesh, bodies, lists, partition, findings) result(far)
    type(plan_t), intent(in) :: plan
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    type(movers_t), intent(in) :: lists(:, :)    !! (bodies, slabs)
    type(partition_t), intent(in) :: partition
    type(findings_t), intent(in) :: findings
    far = plan%dt*findings%fastest_before*mesh%inverse_h > 1.0_dp
    ! A rigid body is as fast as it is made in this step, no wave limits that.
    if (any(bodies%rigid .and. .not. bodies%at_rest)) then
      far = parallel_any(far .or. rigid_body_far(bodies, lists, partition))
    end if
  end function goes_far

  !> Whether particles of rigid bodies here have moved beyond the planes next to this rank's own.
  pure logical function rigid_body_far(bodies, lists, partition) result(far)
    type(body_t), intent(in) :: bodies(:)
    type(movers_t), intent(in) :: lists(:, :)    !! (bodies, slabs)
    type(partition_t), intent(in) :: partition
    integer :: b, s, m, bin(3)
    far = .false.
    do b = 1, size(bodies)
      if (.not. bodies(b)%rigid) cycle
      do s = 1, size(lists, 2)
        do m = 1, lists(b, s)%n
          bin = bin_coordinates(bodies(b)%particles, lists(b, s)%particle(:, m))
          far = far .or. beyond_neighbours(bin(3), partition)
        end do
      end do
    end do
  end function rigid_body_far

  !> Whether a plane is neither of this rank nor next to its planes.
  pure logical function beyond_neighbours(plane, partition) result(yes)
    integer, intent(in) :: plane
    type(partition_t), intent(in) :: partition
    yes = plane < partition%own(1) - 1 .or. plane > partition%own(2) + 1
  end function beyond_neighbours

  !> A particle has crossed more than a cell although the time step should not let it.
  subroutine moved_too_far(plan, bodies, id, failure)
    type(plan_t), intent(in) :: plan
    type(body_t), intent(in) :: bodies(:)
    integer(i4), intent(in) :: id
    type(error_t), allocatable, intent(inout) :: failure
    if (allocated(failure)) return
    call error_make(failure, exit_numerical, body_particle(bodies, id)// &
                    ' has crossed more than a cell in step '//integer_text(plan%step), &
                    'reduce cfl or dt; see the last dump for where it is')
  end subroutine moved_too_far

  !> Puts the movers of one body into their bins and adds them to the grid; every thread has a range
  !! of planes, and the bins that reach into it are all it needs.
  subroutine settle_movers(plan, mesh, field, body, team, lists, lost)
    type(plan_t), intent(in) :: plan
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field        !! in which the body moves
    type(body_t), intent(inout) :: body
    type(team_t), intent(in) :: team
    type(movers_t), intent(inout) :: lists(:)    !! of the body
    integer, intent(inout) :: lost               !! particles that left the grid, counted here
    type(plan_t) :: own
    type(arrivals_t) :: arrivals(team%threads)
    integer :: s, t, planes(2), members
    own = plan
    call sweep_columns(own, field)
    do s = 1, size(lists)
      lost = lost + count(lists(s)%gone(:lists(s)%n) .and. lists(s)%here(:lists(s)%n))
    end do
    call particles_close_lists(body%particles, lists)
    members = merge(team%threads, 1, sum(lists%n) > few)
    !$omp parallel do schedule(static, 1) num_threads(members) if(members > 1) default(none) &
    !$omp& shared(own, mesh, field, body, team, lists, arrivals) private(t, planes)
    do t = 1, team%threads
      planes = planes_of(team, body%field, t, field%planes)
      call particles_receive(body%particles, lists, &
                             bins_of(body%particles, planes, stencil_width(field%kernel)), &
                             arrivals(t))
      if (arrivals(t)%n == 0) cycle
      call team%passes%add_movers(mesh, field, body, own, lists, arrivals(t), planes)
    end do
    !$omp end parallel do
    call particles_receive_rest(body%particles, lists, arrivals)
  end subroutine settle_movers

  !> Planes of field f that a thread adds movers to: those of its slab, and for the first and the
  !! last also those of the borders and of other ranks.
  pure function planes_of(team, f, thread, last) result(planes)
    type(team_t), intent(in) :: team
    integer, intent(in) :: f, thread
    integer, intent(in) :: last                  !! plane of the field
    integer :: planes(2)
    planes = [team%slabs(thread + 1, f), team%slabs(thread + 2, f) - 1]
    if (thread == 1) planes(1) = 1
    if (thread == team%threads) planes(2) = last
  end function planes_of

  !> First bin whose stencil reaches into some planes, first bin in them, last bin.
  pure function bins_of(particles, planes, width) result(bins)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: planes(2), width      !! width: of the stencil
    integer :: bins(3)
    bins = [first_bin(particles, max(1, planes(1) - width + 1)), &
            first_bin(particles, planes(1)), first_bin(particles, planes(2) + 1) - 1]
  end function bins_of

  !> First bin of a plane or, where it has none, of the next that does.
  pure function first_bin(particles, plane) result(bin)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: plane
    integer :: bin, row
    row = particles%plane_row(plane)
    bin = size(particles%size) + 1
    if (row <= particles%bins%n) bin = particles%bin_start(row) + particles%bins%first(row)
  end function first_bin

end module sgmp_rebin_phases
