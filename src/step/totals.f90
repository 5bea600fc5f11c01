!> What all ranks have and what a step did, put together when it ends.
module sgmp_totals
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_t
  use sgmp_contact_ledger, only: contact_sums_t, ledger_close
  use sgmp_drive, only: drive_power, drive_sums, drive_work
  use sgmp_energy, only: step_sums_t
  use sgmp_energy_terms, only: energy_terms_t, from_nodes, from_particles, from_removed, &
                               terms_gain, terms_open, terms_take
  use sgmp_field, only: field_t
  use sgmp_findings, only: findings_t
  use sgmp_halo, only: halo_own_planes
  use sgmp_kinds, only: dp, i8
  use sgmp_parallel, only: parallel_agree, parallel_max_place
  use sgmp_partition, only: partition_t
  use sgmp_rigid_motion, only: freedoms
  use sgmp_sums, only: feature_sums, nodes_external, nodes_features, nodes_lost, &
                       nodes_mass_aa, nodes_mass_av, nodes_sums, nodes_taken, &
                       removed_internal, removed_kinetic, &
                       removed_mass, removed_moment, removed_momentum, removed_sums, &
                       sum_applied, sum_internal, sum_kinetic, sum_loose, sum_mass_aa, &
                       sum_moment, sum_momentum, sum_springs, sum_viscous, sweep_sums
  use sgmp_tally, only: tally_reset, tally_total
  implicit none
  private
  public :: body_sums_t, totals_t, totals_close, totals_open

  !> Sums over one body, kept up to date by the sweeps.
  type :: body_sums_t
    real(dp) :: mass = 0.0_dp
    real(dp) :: moment(3) = 0.0_dp     !! sum m X, in cells from the grid origin
    real(dp) :: momentum(3) = 0.0_dp
    real(dp) :: kinetic = 0.0_dp, internal = 0.0_dp
    real(dp) :: taken = 0.0_dp         !! internal energy that removed particles took along
    real(dp) :: loose = 0.0_dp         !! particles that have failed and are open
  end type body_sums_t

  !> Sums over all ranks.
  type :: totals_t
    integer(i8), allocatable :: particles(:)         !! (bodies)
    integer(i8) :: points = 0_i8                     !! stored grid points
    type(body_sums_t), allocatable :: bodies(:)      !! (bodies)
    type(step_sums_t) :: sums                        !! of the step at hand
    real(dp), allocatable :: drives(:, :)            !! (drive_sums, prescribed motions) of the step
    real(dp) :: features(feature_sums) = 0.0_dp      !! over nodes, of features in the step
    real(dp), allocatable :: impulses(:, :)          !! (freedoms, pairs) of contact before the step
  end type totals_t

contains

  !> Forgets the sums of the step before.
  subroutine totals_open(totals, terms, findings, contact, fields, bodies, removed)
    type(totals_t), intent(inout) :: totals
    type(energy_terms_t), intent(inout) :: terms
    type(findings_t), intent(inout) :: findings
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(in) :: fields(:)
    integer, intent(in) :: bodies                !! how many
    integer, intent(in) :: removed               !! sums of each over particles that go
    totals%sums = step_sums_t()
    call terms_open(terms)
    contact%terms%n = 0
    findings%strained = 0
    findings%failed_in = 0
    call tally_reset(findings%tally, bodies*(sweep_sums + removed) + nodes_sums + &
                     sum(fields%columns%driven)*drive_sums)
  end subroutine totals_open

  !> Puts together what the ranks have found in a step: sums, particles, the fastest of them, and
  !! whether anything failed; with `whole` the sums are those of a whole step.
  subroutine totals_close(totals, terms, findings, contact, fields, bodies, partition, whole, &
                          removed)
    type(totals_t), intent(inout) :: totals
    type(energy_terms_t), intent(inout) :: terms  !! of features
    type(findings_t), intent(inout) :: findings
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(partition_t), intent(in) :: partition
    logical, intent(in) :: whole
    integer, intent(in) :: removed               !! as in totals_open
    real(dp) :: sums(size(bodies)*(sweep_sums + removed) + nodes_sums + &
                     sum(fields%columns%driven)*drive_sums)
    integer(i8) :: counts(size(bodies) + 4)
    integer :: b, n, first, cause
    n = size(bodies)
    counts(:n) = int(bodies%particles%count, i8)
    counts(n + 1) = int(findings%lost_here, i8)
    counts(n + 2) = merge(1_i8, 0_i8, allocated(findings%failure))
    counts(n + 3) = own_points(fields, partition)
    counts(n + 4) = int(contact%terms%n, i8)
    call tally_total(findings%tally, sums, counts)
    call parallel_max_place(findings%fastest, findings%fastest_id, findings%fastest_field)
    if (counts(n + 2) > 0_i8) call parallel_agree(findings%failure, findings%failed_in)
    do b = 1, n
      associate (of => bodies(b)%twin_of)
        if (of == 0) cycle
        counts(of) = counts(of) + counts(b)
        counts(b) = 0_i8
        first = (b - 1)*sweep_sums
        sums((of - 1)*sweep_sums + 1:of*sweep_sums) = &
          sums((of - 1)*sweep_sums + 1:of*sweep_sums) + sums(first + 1:first + sweep_sums)
        sums(first + 1:first + sweep_sums) = 0.0_dp
      end associate
    end do
    totals%particles = counts(:n)
    totals%points = counts(n + 3)
    findings%lost = findings%lost + int(counts(n + 1))
    findings%lost_here = 0
    if (.not. whole) return
    totals%impulses = contact_impulses(contact)
    do b = 1, n
      call add_body(bodies(b), sums((b - 1)*sweep_sums + 1:b*sweep_sums), terms, &
                    totals%bodies(b), totals%sums)
    end do
    call add_nodes(sums(n*sweep_sums + 1:n*sweep_sums + nodes_sums), totals%sums)
    first = n*sweep_sums + nodes_features
    totals%features = sums(first:first + feature_sums - 1)
    call terms_take(terms, from_nodes, sums(n*sweep_sums + 1:n*sweep_sums + nodes_sums))
    do b = 1, merge(n, 0, removed > 0)
      first = n*sweep_sums + nodes_sums + (b - 1)*removed
      call terms_take(terms, from_removed, sums(first + 1:first + removed))
      do cause = first, first + removed - 1, removed_sums
        call take_removed(sums(cause + 1:cause + removed_sums), &
                          totals%bodies(merge(bodies(b)%twin_of, b, bodies(b)%twin_of > 0)))
      end do
    end do
    if (any(fields%columns%driven > 0)) call add_drives(fields, sums, totals)
    call add_contact(contact, counts(n + 4) > 0_i8, totals%sums)
  end subroutine totals_close

  !> Adds what prescribed motions of parts of bodies did.
  pure subroutine add_drives(fields, sums, totals)
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: sums(:)
    type(totals_t), intent(inout) :: totals
    integer :: n
    n = sum(fields%columns%driven)
    totals%drives = reshape(sums(size(sums) - n*drive_sums + 1:), [drive_sums, n])
    totals%sums%external_power = totals%sums%external_power + sum(totals%drives(drive_work, :))
    totals%sums%power_before = totals%sums%power_before + sum(totals%drives(drive_power, :))
  end subroutine add_drives

  !> What the first body of each pair has received so far: impulse, and its moment about the origin.
  pure function contact_impulses(contact) result(impulses)
    type(contact_t), intent(in) :: contact
    real(dp) :: impulses(freedoms, size(contact%pairs))
    integer :: p
    do p = 1, size(contact%pairs)
      impulses(:, p) = [contact%pairs(p)%impulse, contact%pairs(p)%angular_impulse]
    end do
  end function contact_impulses

  !> Grid points stored in the planes of this rank.
  pure function own_points(fields, partition) result(points)
    type(field_t), intent(in) :: fields(:)
    type(partition_t), intent(in) :: partition
    integer(i8) :: points
    integer :: f, p1, p2
    points = 0_i8
    do f = 1, size(fields)
      call halo_own_planes(fields(f), partition, p1, p2)
      points = points + fields(f)%plane_start(p2 + 1) - fields(f)%plane_start(p1)
    end do
  end function own_points

  !> Adds a body's sums to those of the step.
  pure subroutine add_body(body, sums, terms, own, all)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: sums(sweep_sums)
    type(energy_terms_t), intent(inout) :: terms
    type(body_sums_t), intent(inout) :: own      !! of the body
    type(step_sums_t), intent(inout) :: all      !! of the step
    if (body%at_rest) return
    own%moment = sums(sum_moment:sum_moment + 2)
    if (body%rigid_motion%free) return  ! the rest belongs to the body as a whole
    own%momentum = sums(sum_momentum:sum_momentum + 2)
    own%kinetic = terms_gain(terms, sums(sum_kinetic), sums)
    if (body%rigid) return  ! its energy and momentum belong to whoever moves it
    own%internal = own%internal + sums(sum_internal)
    own%loose = sums(sum_loose)
    all%kinetic = all%kinetic + sums(sum_kinetic)
    all%particles_aa = all%particles_aa + sums(sum_mass_aa)
    all%momentum = all%momentum + sums(sum_momentum:sum_momentum + 2)
    all%internal = all%internal + sums(sum_internal)
    all%viscous = all%viscous + sums(sum_viscous)
    all%applied_work = all%applied_work + sums(sum_applied)
    all%springs = all%springs + sums(sum_springs)
    call terms_take(terms, from_particles, sums)
  end subroutine add_body

  !> Takes from a body what its particles that were removed have taken along.
  pure subroutine take_removed(sums, own)
    real(dp), intent(in) :: sums(removed_sums)
    type(body_sums_t), intent(inout) :: own      !! of the body
    own%mass = own%mass - sums(removed_mass)
    own%moment = own%moment - sums(removed_moment:removed_moment + 2)
    own%momentum = own%momentum - sums(removed_momentum:removed_momentum + 2)
    own%kinetic = own%kinetic - sums(removed_kinetic)
    own%internal = own%internal - sums(removed_internal)
    own%taken = own%taken + sums(removed_internal)
  end subroutine take_removed

  !> Adds the nodes' sums.
  pure subroutine add_nodes(sums, all)
    real(dp), intent(in) :: sums(nodes_sums)
    type(step_sums_t), intent(inout) :: all
    all%nodes_aa = all%nodes_aa + sums(nodes_mass_aa)
    all%power_before = all%power_before + sums(nodes_mass_av)
    all%external_power = all%external_power + sums(nodes_external)
    all%lost_force = all%lost_force + sums(nodes_lost)
    all%taken_power = all%taken_power + sums(nodes_taken)
  end subroutine add_nodes

  !> Adds what contact did.
  subroutine add_contact(contact, anywhere, all)
    type(contact_t), intent(inout) :: contact
    logical, intent(in) :: anywhere        !! on some rank
    type(step_sums_t), intent(inout) :: all
    type(contact_sums_t) :: sums
    sums = contact_sums_t(all%contact, all%rigid_work, all%nodes_aa, all%power_before, &
                          all%external_power)
    call ledger_close(contact%pairs, contact%terms, anywhere, sums)
    all%contact = sums%dissipation
    all%rigid_work = sums%rigid_work
    all%nodes_aa = sums%nodes_aa
    all%power_before = sums%power_before
    all%external_power = sums%external_power
  end subroutine add_contact

end module sgmp_totals
