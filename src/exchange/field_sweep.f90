!> A sweep over the particles of one velocity field: which slab each thread takes, and how the sums
!! of slabs and ranks are joined.
!!
!! Between ranks the planes that neighbours wait for are swept first and sent, so that messages are
!! under way while the others are swept. Where a slab ends changes no sum: a plane between two slabs
!! is joined to what the straight sweep would have made of it.
module sgmp_field_sweep
  use sgmp_body, only: body_particle, body_t
  use sgmp_columns, only: columns_range
  use sgmp_drive, only: drive_sums
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_field, only: field_t
  use sgmp_findings, only: findings_t
  use sgmp_halo, only: halo_own_planes, halo_read_sums, halo_write_above, halo_write_below
  use sgmp_kinds, only: dp
  use sgmp_lost_particles, only: lost_particles_check
  use sgmp_mesh, only: mesh_t
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_pace, only: pace_note
  use sgmp_particle_faults, only: fault_names, fault_squeezed, fault_through_wall
  use sgmp_plan, only: plan_t
  use sgmp_ranks, only: ranks_t
  use sgmp_sums, only: sweep_sums
  use sgmp_tally, only: tally_add
  use sgmp_team, only: slab_empty, stencil_layers, team_slabs, team_t
  use sgmp_text, only: integer_text
  use sgmp_timers, only: phase_halo, timers_move, timers_t, wall_time
  implicit none
  private
  public :: field_sweep, sweep_columns

contains

  !> One sweep over field f; what it finds goes into the tally, `fastest` and `failure` of the
  !! findings.
  subroutine field_sweep(plan, f, mesh, field, bodies, team, ranks, findings, timers)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    type(body_t), intent(inout) :: bodies(:)
    type(team_t), intent(inout) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    real(dp), allocatable :: sums(:, :, :)
    type(plan_t) :: own
    real(dp) :: spent(team%threads)
    integer :: t, s, b, p
    logical :: sent
    own = plan
    call sweep_columns(own, field)
    sent = has_borders(team, f)
    allocate (sums(sweep_sums, field%planes, size(bodies)), source=0.0_dp)
    ! One region for both: each that is opened costs a meeting of the threads more.
    !$omp parallel num_threads(team%threads) if(team%threads > 1) default(none) private(t, s) &
    !$omp& shared(own, f, mesh, field, bodies, team, ranks, timers, sums, sent, spent)
    !$omp do schedule(static, 1)
    do t = 1, team%threads
      spent(t) = wall_time()
      if (t == 1) then
        call sweep_slab(own, f, 1, mesh, field, bodies, team, sums)
        call sweep_slab(own, f, team_slabs(team%threads), mesh, field, bodies, team, sums)
        if (sent) call send_sums(own, f, field, team, ranks, timers)  ! this thread may send
      end if
      call sweep_slab(own, f, t + 1, mesh, field, bodies, team, sums)
      spent(t) = wall_time() - spent(t)
    end do
    !$omp end do
    !$omp do schedule(static, 1)
    do s = 1, team_slabs(team%threads)
      call join_slabs(own, f, s, field, team, ranks%partition%ranks == 1)
    end do
    !$omp end do nowait
    !$omp end parallel
    if (team%threads > 1) call pace_note(team%paces(f), spent)
    if (ranks%partition%ranks > 1) then
      if (.not. sent) call send_sums(own, f, field, team, ranks, timers)
      call join_ranks(own, f, field, team, ranks, findings, timers)
    end if
    do b = 1, size(bodies)
      if (bodies(b)%field /= f) cycle
      do p = team%slabs(1, f), team%slabs(size(team%slabs, 1), f) - 1
        call tally_add(findings%tally, 1 + (b - 1)*sweep_sums, sums(:, p, b))
      end do
    end do
    if (field%columns%driven > 0 .and. plan%kick) call add_drives(f, field, team, findings)
    if (plan%strain) call collect_findings(plan, f, bodies, team, findings)
  end subroutine field_sweep

  !> Adds what driven particles took from whoever moves them to the sums of the step.
  subroutine add_drives(f, field, team, findings)
    integer, intent(in) :: f
    type(field_t), intent(in) :: field
    type(team_t), intent(in) :: team
    type(findings_t), intent(inout) :: findings
    integer :: s, p, k
    do s = 1, team_slabs(team%threads)
      do p = team%slabs(s, f), team%slabs(s + 1, f) - 1
        do k = 1, field%columns%driven
          call tally_add(findings%tally, 1 + field%drive_terms + (k - 1)*drive_sums, &
                         team%workspaces(s, f)%drives(:, k, p))
        end do
      end do
    end do
  end subroutine add_drives

  !> Columns of the moments that a sweep fills, and what of a field it must know besides; a probe
  !! knows nothing of external forces and of swirl.
  pure subroutine sweep_columns(plan, field)
    type(plan_t), intent(inout) :: plan
    type(field_t), intent(in) :: field
    integer :: range(2)
    associate (columns => field%columns)
      plan%collide = plan%kick .and. field%collides
      if (plan%loose) then
        plan%first_column = columns%debris
        plan%last_column = columns%debris + merge(field%ndim + 2, 0, plan%gradient > 0)
        return
      end if
      plan%average = plan%drift .and. columns%average > 0
      range = columns_range(columns, plan%mass, plan%momentum, plan%stress, plan%probe)
      plan%first_column = range(1)
      plan%last_column = range(2)
      plan%swirl = columns%swirl > 0 .and. .not. plan%probe
      if (.not. plan%stress .or. plan%probe) return
      if (columns%faces > 0) plan%faces = columns%faces - plan%first_column
      plan%corrected = columns%corrected .and. columns%external > 0
    end associate
  end subroutine sweep_columns

  !> Whether there are planes that are swept first because neighbours wait for them.
  pure function has_borders(team, f) result(yes)
    type(team_t), intent(in) :: team
    integer, intent(in) :: f
    logical :: yes
    yes = .not. (slab_empty(team, f, 1) .and. slab_empty(team, f, team_slabs(team%threads)))
  end function has_borders

  !> Sweeps slab s.
  subroutine sweep_slab(plan, f, s, mesh, field, bodies, team, sums)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f, s
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    type(body_t), intent(inout) :: bodies(:)
    type(team_t), intent(inout) :: team
    real(dp), intent(inout) :: sums(:, :, :)     !! (sweep_sums, planes, bodies)
    call team%passes%sweep(mesh, field, f, bodies, plan, team%slabs(s, f), &
                           team%slabs(s + 1, f) - 1, sums, team%movers(:, s), &
                           team%workspaces(s, f))
    if (plan%drift) call lost_particles_check(plan, f, mesh, field%columns, bodies, &
                                               team%movers(:, s))
  end subroutine sweep_slab

  !> Joins a slab with the one below it; the lowest one waits for the rank below, if there is one.
  subroutine join_slabs(plan, f, s, field, team, alone)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f, s
    type(field_t), intent(inout) :: field
    type(team_t), intent(in) :: team
    logical, intent(in) :: alone                 !! there is one rank
    integer :: below
    if (slab_empty(team, f, s)) return
    below = s - 1
    do while (below > 0)
      if (.not. slab_empty(team, f, below)) exit
      below = below - 1
    end do
    associate (first => team%slabs(s, f), last => team%slabs(s + 1, f) - 1, &
               work => team%workspaces(:, f))
      if (below > 0) then
        call team%passes%join(field, plan, first, last, work(s), work(below))
      else if (alone) then
        call team%passes%join(field, plan, first, last, work(s))
      end if
    end associate
  end subroutine join_slabs

  !> The lowest and highest slab that are not empty; 1 if all are.
  pure subroutine outer_slabs(team, f, lowest, highest)
    type(team_t), intent(in) :: team
    integer, intent(in) :: f
    integer, intent(out) :: lowest, highest
    lowest = 1
    do while (lowest < team_slabs(team%threads) .and. slab_empty(team, f, lowest))
      lowest = lowest + 1
    end do
    highest = team_slabs(team%threads)
    do while (highest > 1 .and. slab_empty(team, f, highest))
      highest = highest - 1
    end do
  end subroutine outer_slabs

  !> Sends the sums of the outer planes, before they are joined with those of other ranks.
  subroutine send_sums(plan, f, field, team, ranks, timers)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    type(field_t), intent(in) :: field
    type(team_t), intent(in) :: team
    type(ranks_t), intent(inout) :: ranks
    type(timers_t), intent(inout) :: timers
    real(dp) :: since
    integer :: lowest, highest, columns(2)
    since = wall_time()
    columns = [plan%first_column, plan%last_column]
    call outer_slabs(team, f, lowest, highest)
    associate (work => team%workspaces(:, f), messages => ranks%messages)
      call halo_write_below(field, ranks%partition, columns, stencil_layers(field), work(lowest), &
                            messages%to_below)
      call halo_write_above(field, ranks%partition, columns, stencil_layers(field), work(highest), &
                            messages%to_above)
      call neighbours_send(messages, ranks%traffic)
    end associate
    call timers_move(timers, phase_halo, since)
  end subroutine send_sums

  !> Joins the own planes with those of the neighbours, as slabs of threads are joined.
  subroutine join_ranks(plan, f, field, team, ranks, findings, timers)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    type(field_t), intent(inout) :: field
    type(team_t), intent(in) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    real(dp) :: since
    integer :: lowest, highest, p1, p2, columns(2)
    logical :: complete
    since = wall_time()
    columns = [plan%first_column, plan%last_column]
    call outer_slabs(team, f, lowest, highest)
    associate (work => team%workspaces(:, f), messages => ranks%messages)
      call neighbours_receive(messages)
      call halo_read_sums(field, ranks%partition, columns, stencil_layers(field), &
                          messages%from_below, messages%from_above, ranks%below(f), &
                          ranks%above(f), complete)
      call neighbours_wait(messages)
      if (.not. complete) call misplaced(plan, findings)
      call halo_own_planes(field, ranks%partition, p1, p2)
      if (p2 >= p1) then
        call team%passes%join(field, plan, p1, team%slabs(lowest + 1, f) - 1, work(lowest), &
                              ranks%below(f))
        if (p2 < field%planes) then
          call team%passes%join(field, plan, p2 + 1, min(p2 + 2, field%planes), ranks%above(f), &
                                work(highest))
        end if
      end if
    end associate
    call timers_move(timers, phase_halo, since)
  end subroutine join_ranks

  !> A neighbour sent a value for a point that is not stored here.
  subroutine misplaced(plan, findings)
    type(plan_t), intent(in) :: plan
    type(findings_t), intent(inout) :: findings
    if (allocated(findings%failure)) return
    call error_make(findings%failure, exit_numerical, 'a rank has no place for what its '// &
                    'neighbour sent in step '//integer_text(plan%step), &
                    'this is a fault of the program: report it')
  end subroutine misplaced

  !> Puts the findings of the slabs together: the fastest particle, and the first one whose state
  !! makes no sense.
  subroutine collect_findings(plan, f, bodies, team, findings)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(findings_t), intent(inout) :: findings
    integer :: s
    findings%strained = findings%strained + 1
    do s = 1, team_slabs(team%threads)
      if (slab_empty(team, f, s)) cycle
      associate (work => team%workspaces(s, f))
        if (work%fastest > findings%fastest) then
          findings%fastest = work%fastest
          findings%fastest_id = work%fastest_id
          findings%fastest_field = f
        end if
        if (work%bad_id > 0 .and. .not. allocated(findings%failure)) then
          findings%failed_in = findings%strained
          call error_make(findings%failure, exit_numerical, &
                          body_particle(bodies, work%bad_id)//' '// &
                          trim(fault_names(work%fault))//' after step '// &
                          integer_text(plan%step), remedy_of(work%fault))
        end if
      end associate
    end do
  end subroutine collect_findings

  !> What helps a particle whose state makes no sense.
  pure function remedy_of(fault) result(remedy)
    integer, intent(in) :: fault                 !! one of fault_*
    character(:), allocatable :: remedy
    select case (fault)
    case (fault_squeezed, fault_through_wall)
      remedy = 'first places no longer say what is near: leave out frame=reference; '// &
               'see doc/reference-frame.md'
    case default
      remedy = 'reduce cfl, add bulk viscosity, or use a finer grid; look at formulas of time, '// &
               'which must stay numbers; see the last dump for where it is'
    end select
  end function remedy_of

end module sgmp_field_sweep
