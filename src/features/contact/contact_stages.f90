!> The phases of a step that belong to contact, and what ranks tell each other in them.
module sgmp_contact_stages
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_inverse_mass, node_remapped, node_velocity
  use sgmp_contact, only: contact_detect, contact_meet, contact_step_t, contact_t, contact_trial, &
                          contact_velocity
  use sgmp_contact_exchange, only: contact_exchange
  use sgmp_contact_ledger, only: ledger_add_up
  use sgmp_contact_levers, only: plane_colours
  use sgmp_drive, only: drive_sums, most_drives
  use sgmp_driven_nodes, only: driven_nodes_push
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_field, only: field_t
  use sgmp_findings, only: findings_t
  use sgmp_friction_stages, only: friction_after_strain, friction_after_trial, &
                                  friction_before_strain, friction_before_trial, friction_first, &
                                  friction_levers, friction_next, friction_strain
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_parallel, only: parallel_any
  use sgmp_partition, only: partition_t
  use sgmp_phases, only: phase_swap_nodes
  use sgmp_ranks, only: ranks_t
  use sgmp_shared_nodes, only: shared_nodes_t
  use sgmp_tally, only: tally_add
  use sgmp_text, only: integer_text
  use sgmp_timers, only: phase_contact, phase_halo, timers_move, timers_t, wall_time
  implicit none
  private
  public :: phase_contact_force, phase_contact_velocity, phase_find_contact

contains

  !> Normals and touching pairs at all shared nodes.
  subroutine phase_find_contact(step, cutoff, mesh, fields, bodies, contact, threads, ranks, &
                                findings, timers)
    integer, intent(in) :: step                  !! its number
    real(dp), intent(in) :: cutoff               !! node mass below which a node is ignored
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: threads
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    logical :: complete
    real(dp) :: since
    if (nothing_shared(contact, ranks)) return
    since = wall_time()
    call contact_meet(contact, mesh, fields, bodies, step, cutoff, findings%moved > 0, threads)
    call timers_move(timers, phase_contact, since)
    call contact_exchange(contact%shared, bodies, ranks%partition, ranks%messages, &
                          ranks%traffic, complete)
    if (.not. complete .and. .not. allocated(findings%failure)) then
      call error_make(findings%failure, exit_numerical, 'a rank has no place for particles of '// &
                      'its neighbour in step '//integer_text(step), &
                      'this is a fault of the program: report it')
    end if
    if (ranks%partition%ranks > 1) call timers_move(timers, phase_halo, since)
    call contact_detect(contact, mesh, fields, bodies, threads)
    if (contact%at_surface) then
      contact%anywhere = any(contact%shared%near)
      if (ranks%partition%ranks > 1) contact%anywhere = parallel_any(contact%anywhere)
      call swap(step, contact, fields, bodies, ranks, findings, timers, since)
      call friction_levers(contact, mesh, fields, bodies, threads)
    end if
    call timers_move(timers, phase_contact, since)
  end subroutine phase_find_contact

  !> Contact forces at all shared nodes.
  subroutine phase_contact_force(step, mesh, fields, bodies, contact, threads, ranks, findings, &
                                 timers)
    type(contact_step_t), intent(in) :: step
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: threads
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    real(dp) :: since
    integer :: c
    if (nothing_shared(contact, ranks)) return
    since = wall_time()
    if (contact%at_surface) then
      call swap(step%number, contact, fields, bodies, ranks, findings, timers, since)
      call friction_before_trial(contact, fields, bodies, step, threads)
    end if
    call contact_trial(contact, fields, bodies, step, threads)
    if (contact%at_surface) then
      call swap(step%number, contact, fields, bodies, ranks, findings, timers, since)
      call friction_first(contact, fields, bodies, step, threads)
      call swap(step%number, contact, fields, bodies, ranks, findings, timers, since)
      do c = 1, plane_colours
        call friction_next(contact, c, fields, bodies, step, threads)
        call swap(step%number, contact, fields, bodies, ranks, findings, timers, since)
      end do
      call friction_after_trial(contact, fields, bodies, step, threads)
    end if
    if (step%after <= 0.0_dp) call add_up(contact, step, mesh, fields, ranks%partition, findings)
    call timers_move(timers, phase_contact, since)
  end subroutine phase_contact_force

  !> Makes the velocity that strains the particles obey contact at all shared nodes.
  subroutine phase_contact_velocity(step, before_kick, mesh, fields, bodies, contact, threads, &
                                    ranks, findings, timers)
    type(contact_step_t), intent(in) :: step
    logical, intent(in) :: before_kick           !! it is the velocity before the kick
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: threads
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    real(dp) :: since
    integer :: c, column
    if (nothing_shared(contact, ranks)) return
    since = wall_time()
    column = merge(node_velocity(mesh%ndim), node_remapped, before_kick)
    if (contact%at_surface) then
      call swap(step%number, contact, fields, bodies, ranks, findings, timers, since)
      call friction_before_strain(contact, column, fields, bodies, threads)
    end if
    call contact_velocity(contact, mesh, fields, bodies, step, before_kick, threads)
    if (contact%at_surface) then
      call swap(step%number, contact, fields, bodies, ranks, findings, timers, since)
      do c = 1, plane_colours
        call friction_strain(contact, c, column, fields, bodies, threads)
        call swap(step%number, contact, fields, bodies, ranks, findings, timers, since)
      end do
      if (.not. before_kick) call friction_after_strain(contact, step%after)
    end if
    if (.not. before_kick) call add_up(contact, step, mesh, fields, ranks%partition, findings)
    call timers_move(timers, phase_contact, since)
  end subroutine phase_contact_velocity

  !> Whether there is nothing to do: no shared nodes, and no neighbour that wants to know of others.
  pure function nothing_shared(contact, ranks) result(yes)
    type(contact_t), intent(in) :: contact
    type(ranks_t), intent(in) :: ranks
    logical :: yes
    yes = contact%shared%nodes == 0 .and. &
          .not. (contact%at_surface .and. ranks%partition%ranks > 1)
  end function nothing_shared

  !> Nodes of the neighbours around those that this rank solves: friction there changes them, and
  !! they have a share in what it meets here.
  subroutine swap(step, contact, fields, bodies, ranks, findings, timers, since)
    integer, intent(in) :: step                  !! its number
    type(contact_t), intent(in) :: contact
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    real(dp), intent(inout) :: since             !! when contact has begun or gone on
    if (ranks%partition%ranks == 1 .or. .not. contact%anywhere) return
    call timers_move(timers, phase_contact, since)
    call phase_swap_nodes(step, [1, node_inverse_mass(contact%shared%ndim)], 2, fields, bodies, &
                          ranks, findings, timers)
    since = wall_time()
  end subroutine swap

  !> Sums of what contact did in the step, when all of it is done.
  subroutine add_up(contact, step, mesh, fields, partition, findings)
    type(contact_t), intent(inout) :: contact
    type(contact_step_t), intent(in) :: step
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(partition_t), intent(in) :: partition
    type(findings_t), intent(inout) :: findings
    call ledger_add_up(contact%shared, mesh, partition%own, size(contact%pairs), contact%terms)
    if (contact%shared%driven) call book_driven(contact%shared, step%dt_kick, mesh, fields, &
                                                partition%own, findings)
  end subroutine add_up

  !> What contact gives to parts whose motion is prescribed is a force on whoever moves them: to the
  !! sums of their drives.
  subroutine book_driven(shared, dt, mesh, fields, own, findings)
    type(shared_nodes_t), intent(in) :: shared
    real(dp), intent(in) :: dt                   !! velocity step
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    integer, intent(in) :: own(2)                !! first and last plane of this rank
    type(findings_t), intent(inout) :: findings
    real(dp) :: sums(drive_sums, most_drives)
    integer :: n, m, k
    do n = 1, shared%nodes
      if (shared%point(3, n) < own(1)) cycle
      if (shared%point(3, n) > own(2)) exit
      do m = shared%member_start(n), shared%member_start(n + 1) - 1
        if (all(abs(shared%driven_push(:, m)) + abs(shared%driven_work(:, m)) <= 0.0_dp)) cycle
        associate (field => fields(shared%field(m)))
          call driven_nodes_push(field, mesh, shared%interval(m), shared%point(1, n), &
                                 shared%record(m), shared%driven_push(:, m)/dt, &
                                 shared%driven_work(:, m)/dt, sums(:, :size(field%drives)))
          do k = 1, size(field%drives)
            call tally_add(findings%tally, 1 + field%drive_terms + (k - 1)*drive_sums, sums(:, k))
          end do
        end associate
      end do
    end do
  end subroutine book_driven

end module sgmp_contact_stages
