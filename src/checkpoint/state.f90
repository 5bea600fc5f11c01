!> What a run knows besides its particles and its grid: time, sums, motions, counters of its files.
!!
!! One procedure names it all, for writing and for reading.
module sgmp_state
  use sgmp_archive, only: archive_t
  use sgmp_body, only: body_parts, body_t
  use sgmp_contact, only: contact_t
  use sgmp_contact_memory, only: memory_share
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_driven_output, only: motion_rows_t
  use sgmp_driven_part, only: driven_part_t, driven_totals
  use sgmp_energy, only: eroded_t, ledger_t
  use sgmp_kinds, only: dp, i8
  use sgmp_mesh, only: mesh_t, wall_speed
  use sgmp_model, only: model_t
  use sgmp_outputs, only: outputs_t
  use sgmp_rigid_motion, only: rigid_motion_t
  use sgmp_time_step, only: clock_t
  use sgmp_totals, only: body_sums_t
  implicit none
  private
  public :: state_pass

contains

  !> Writes the state of a run into an archive, or takes it from one.
  subroutine state_pass(archive, model, outputs, particle_steps)
    type(archive_t), intent(inout) :: archive
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    integer(i8), intent(inout) :: particle_steps
    integer :: b, f, p
    call pass_clock(archive, model%clock)
    call archive%pass(model%method%cutoff)
    call archive%pass(model%findings%fastest)
    call archive%pass(model%findings%fastest_id)
    call archive%pass(model%findings%fastest_field)
    call archive%pass(model%findings%fastest_before)
    call archive%pass(model%findings%lost)
    call archive%pass(model%findings%lost_before)
    call archive%pass(model%findings%moved)
    call archive%pass(particle_steps)
    call pass_ledger(archive, model%ledger)
    if (model%method%split > 0.0_dp) call archive%pass(model%ledger%split_energy)
    if (model%method%damped) call archive%pass(model%ledger%damping_dissipation)
    if (model%mesh%walls_act) call pass_walls(archive, model%mesh)
    if (model%mesh%walls_rub) call archive%pass(model%ledger%wall_impulses)
    if (model%method%erodes) call pass_eroded(archive, model%ledger%eroded)
    do f = 1, size(model%turning)
      call archive%pass(model%turning(f)%vector)
      call archive%pass(model%turning(f)%largest)
    end do
    call archive%pass(model%totals%points)
    if (.not. allocated(model%totals%particles)) then
      allocate (model%totals%particles(size(model%bodies)))
    end if
    do b = 1, size(model%bodies)
      call archive%pass(model%totals%particles(b))
      call pass_body(archive, model%bodies(b), model%totals%bodies(b))
    end do
    do p = 1, size(model%contact%pairs)
      call pass_pair(archive, model%contact%pairs(p))
    end do
    if (size(model%contact%pairs) > 0) call pass_memory(archive, model%contact, &
                                                         model%ranks%partition%own)
    call pass_outputs(archive, outputs, model%bodies, size(model%contact%pairs))
  end subroutine state_pass

  !> Velocities of the walls.
  subroutine pass_walls(archive, mesh)
    type(archive_t), intent(inout) :: archive
    type(mesh_t), intent(inout) :: mesh
    integer :: axis
    do axis = 1, mesh%ndim
      call archive%pass(mesh%wall_motion(:, :, axis, wall_speed))
    end do
  end subroutine pass_walls

  !> The clock less what the deck sets.
  subroutine pass_clock(archive, clock)
    type(archive_t), intent(inout) :: archive
    type(clock_t), intent(inout) :: clock
    call archive%pass(clock%step)
    call archive%pass(clock%limited_by)
    call archive%pass(clock%time)
    call archive%pass(clock%dt)
    call archive%pass(clock%dt_before)
    call archive%pass(clock%dt_free)
    call archive%pass(clock%longest)
    call archive%pass(clock%shortest)
    call archive%pass(clock%smallest)
    call archive%pass(clock%next_probe)
    call archive%pass(clock%limit)
  end subroutine pass_clock

  subroutine pass_ledger(archive, ledger)
    type(archive_t), intent(inout) :: archive
    type(ledger_t), intent(inout) :: ledger
    call archive%pass(ledger%kinetic)
    call archive%pass(ledger%internal)
    call archive%pass(ledger%initial_total)
    call archive%pass(ledger%external_work)
    call archive%pass(ledger%contact_dissipation)
    call archive%pass(ledger%viscous_dissipation)
    call archive%pass(ledger%filter_heat)
    call archive%pass(ledger%volume_correction)
    call archive%pass(ledger%interpolation_error)
    call archive%pass(ledger%remainder)
    call archive%pass(ledger%predicted)
    call archive%pass(ledger%largest_kinetic)
    call archive%pass(ledger%supplied)
    call archive%pass(ledger%moving_until)
    call archive%pass(ledger%momentum)
    call archive%pass(ledger%lost_impulse)
  end subroutine pass_ledger

  subroutine pass_eroded(archive, eroded)
    type(archive_t), intent(inout) :: archive
    type(eroded_t), intent(inout) :: eroded
    call archive%pass(eroded%particles)
    call archive%pass(eroded%mass)
    call archive%pass(eroded%momentum)
    call archive%pass(eroded%kinetic)
    call archive%pass(eroded%internal)
  end subroutine pass_eroded

  subroutine pass_body(archive, body, sums)
    type(archive_t), intent(inout) :: archive
    type(body_t), intent(inout) :: body
    type(body_sums_t), intent(inout) :: sums
    integer :: i
    call archive%pass(body%first_id)
    call archive%pass(body%speed)
    call archive%pass(body%speed_before)
    if (body%rigid_motion%free .or. body%rigid_motion%turns) then
      call pass_rigid(archive, body%rigid_motion)
    end if
    do i = 1, body_parts(body)
      call pass_driven(archive, body%driven(i))
    end do
    call archive%pass(sums%mass)
    call archive%pass(sums%moment)
    call archive%pass(sums%momentum)
    call archive%pass(sums%kinetic)
    call archive%pass(sums%internal)
  end subroutine pass_body

  !> Of a part of a body whose motion is prescribed.
  subroutine pass_driven(archive, part)
    type(archive_t), intent(inout) :: archive
    type(driven_part_t), intent(inout) :: part
    integer :: acts
    acts = merge(1, 0, part%drive%acts)
    call archive%pass(acts)
    part%drive%acts = acts > 0
    call archive%pass(part%drive%centre)
    call archive%pass(part%drive%velocity)
    call archive%pass(part%drive%gradient)
    call archive%pass(part%drive%before)
    call archive%pass(part%drive%gradient_before)
    call archive%pass(part%motion%centre)
    call archive%pass(part%motion%gradient_before)
    if (part%motion%turns) call archive%pass(part%motion%spin)  ! rows of what was let go show it
    call archive%pass(part%total)
    if (archive%reading) part%drive%axes = part%axes
  end subroutine pass_driven

  !> Of a rigid body that turns or is free.
  subroutine pass_rigid(archive, motion)
    type(archive_t), intent(inout) :: archive
    type(rigid_motion_t), intent(inout) :: motion
    call archive%pass(motion%centre)
    call archive%pass(motion%attitude)
    call archive%pass(motion%spin)
    call archive%pass(motion%gradient_before)
    call archive%pass(motion%mass)
    call archive%pass(motion%inertia)
    call archive%pass(motion%inverse)
    call archive%pass(motion%momentum)
    call archive%pass(motion%impulse)
    call archive%pass(motion%last_change)
    call archive%pass(motion%last_growth)
  end subroutine pass_rigid

  subroutine pass_pair(archive, pair)
    type(archive_t), intent(inout) :: archive
    type(contact_pair_t), intent(inout) :: pair
    call archive%pass(pair%impulse)
    call archive%pass(pair%angular_impulse)
    call archive%pass(pair%dissipation)
    call archive%pass(pair%shared)
    call archive%pass(pair%touching)
  end subroutine pass_pair

  !> States of contact at the nodes of all ranks; a reader's next layout takes them from the memory.
  subroutine pass_memory(archive, contact, own)
    type(archive_t), intent(inout) :: archive
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: own(2)          !! planes of this rank
    if (.not. archive%reading) call memory_share(contact%memory, contact%shared, own)
    call archive%pass(contact%memory%n)
    if (.not. archive%complete) return
    if (archive%reading) then
      if (allocated(contact%memory%values)) deallocate (contact%memory%values)
      allocate (contact%memory%values(contact%memory%n))
    end if
    call archive%pass(contact%memory%values(:contact%memory%n))
    if (.not. archive%reading) contact%memory%n = 0
  end subroutine pass_memory

  !> How far the files of the run had come.
  subroutine pass_outputs(archive, outputs, bodies, pairs)
    type(archive_t), intent(inout) :: archive
    type(outputs_t), intent(inout) :: outputs
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: pairs
    call archive%pass(outputs%dumps)
    call archive%pass(outputs%history_rows)
    call archive%pass(outputs%last_dump_step)
    call archive%pass(outputs%last_row_step)
    call archive%pass(outputs%last_dump_time)
    call archive%pass(outputs%dump_interval)
    call archive%pass(outputs%row_interval)
    call archive%pass(outputs%gauges%ids, .true.)
    call archive%pass(outputs%contact%step)
    call archive%pass(outputs%contact%time)
    if (any(bodies%rigid_motion%free .or. bodies%rigid_motion%turns)) then
      if (.not. allocated(outputs%rigid%impulse)) then
        allocate (outputs%rigid%impulse(6, size(bodies)), source=0.0_dp)
      end if
      call archive%pass(outputs%rigid%step)
      call archive%pass(outputs%rigid%time)
      call archive%pass(outputs%rigid%impulse)
    end if
    if (any(bodies%is_driven)) call pass_motion(archive, outputs%motion, bodies)
    if (pairs == 0) return
    if (.not. allocated(outputs%contact%impulse)) allocate (outputs%contact%impulse(6, pairs))
    call archive%pass(outputs%contact%impulse)
  end subroutine pass_outputs

  !> How far motion.csv had come.
  subroutine pass_motion(archive, rows, bodies)
    type(archive_t), intent(inout) :: archive
    type(motion_rows_t), intent(inout) :: rows
    type(body_t), intent(in) :: bodies(:)
    integer :: b
    if (.not. allocated(rows%before)) then
      allocate (rows%before(driven_totals, sum([(body_parts(bodies(b)), b=1, size(bodies))])), &
                source=0.0_dp)
    end if
    call archive%pass(rows%step)
    call archive%pass(rows%time)
    call archive%pass(rows%before)
  end subroutine pass_motion

end module sgmp_state
