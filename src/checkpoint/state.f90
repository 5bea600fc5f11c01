!> What a run knows besides its particles and its grid: time, sums, motions, counters of its files.
!!
!! One procedure names it all, for writing and for reading; what a feature keeps beyond its columns
!! its own file says, src/features/<name>/<name>_state.f90.
module sgmp_state
  use sgmp_archive, only: archive_t
  use sgmp_body, only: body_parts, body_t
  use sgmp_contact_output, only: contact_impulses
  use sgmp_contact_state, only: contact_state_pass
  use sgmp_driven_output, only: motion_rows_t
  use sgmp_driven_part, only: driven_totals
  use sgmp_driven_state, only: driven_state_pass
  use sgmp_energy, only: ledger_t
  use sgmp_features, only: feature_memory, features_memory, features_recall, features_t
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_outputs, only: outputs_t
  use sgmp_patches, only: labels_t
  use sgmp_rigid_state, only: rigid_state_pass
  use sgmp_time_step, only: clock_t
  use sgmp_totals, only: body_sums_t
  use sgmp_wall_state, only: wall_state_pass
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
    integer :: b, f
    call pass_clock(archive, model%clock)
    call archive%pass(model%method%cutoff)
    call archive%pass(model%findings%fastest)
    call archive%pass(model%findings%fastest_id)
    call archive%pass(model%findings%fastest_field)
    call archive%pass(model%findings%fastest_before)
    call archive%pass(model%findings%lost)
    call archive%pass(model%findings%moved)
    call archive%pass(particle_steps)
    call pass_ledger(archive, model%ledger)
    if (model%mesh%walls_act) call wall_state_pass(archive, model%mesh)
    call pass_features(archive, model%method%features)
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
    if (size(model%contact%pairs) > 0) call contact_state_pass(archive, model%contact, &
                                                                model%ranks%partition%own)
    call pass_outputs(archive, outputs, model%bodies, size(model%contact%pairs))
  end subroutine state_pass

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

  subroutine pass_features(archive, features)
    type(archive_t), intent(inout) :: archive
    type(features_t), intent(inout) :: features
    real(dp) :: memory(feature_memory)
    memory = features_memory(features)
    call archive%pass(memory)
    call features_recall(features, memory)
  end subroutine pass_features

  subroutine pass_ledger(archive, ledger)
    type(archive_t), intent(inout) :: archive
    type(ledger_t), intent(inout) :: ledger
    integer :: t
    call archive%pass(ledger%kinetic)
    call archive%pass(ledger%kinetic_before)
    call archive%pass(ledger%internal)
    call archive%pass(ledger%initial_total)
    call archive%pass(ledger%external_work)
    call archive%pass(ledger%springs)
    call archive%pass(ledger%contact_dissipation)
    call archive%pass(ledger%viscous_dissipation)
    call archive%pass(ledger%interpolation_error)
    call archive%pass(ledger%remainder)
    call archive%pass(ledger%predicted)
    call archive%pass(ledger%largest_kinetic)
    call archive%pass(ledger%supplied)
    call archive%pass(ledger%moving_until)
    call archive%pass(ledger%momentum)
    call archive%pass(ledger%lost_impulse)
    call archive%pass(ledger%slowed)
    call archive%pass(ledger%damped_share)
    call archive%pass(ledger%stress_time)
    do t = 1, ledger%terms%n
      call archive%pass(ledger%terms%term(t)%value)
    end do
  end subroutine pass_ledger

  !> Labels of patches of a body that touches itself; their numbers are exact as reals.
  subroutine pass_labels(archive, labels)
    type(archive_t), intent(inout) :: archive
    type(labels_t), intent(inout) :: labels
    real(dp), allocatable :: patch(:)
    integer :: n
    n = 0
    if (allocated(labels%patch)) n = size(labels%patch)
    call archive%pass(n)
    if (.not. archive%complete) return
    allocate (patch(n))
    if (archive%reading) then
      if (allocated(labels%patch)) deallocate (labels%patch, labels%label)
      allocate (labels%patch(n), labels%label(n))
    end if
    if (n == 0) return
    patch = real(labels%patch, dp)
    call archive%pass(patch)
    labels%patch = nint(patch, i8)
    call archive%pass(labels%label)
  end subroutine pass_labels

  subroutine pass_body(archive, body, sums)
    type(archive_t), intent(inout) :: archive
    type(body_t), intent(inout) :: body
    type(body_sums_t), intent(inout) :: sums
    integer :: i
    call archive%pass(body%first_id)
    call archive%pass(body%speed)
    call archive%pass(body%speed_before)
    if (body%family > 0) call pass_labels(archive, body%labels)
    if (body%rigid_motion%free .or. body%rigid_motion%turns) then
      call rigid_state_pass(archive, body%rigid_motion)
    end if
    do i = 1, body_parts(body)
      call driven_state_pass(archive, body%driven(i))
    end do
    call archive%pass(sums%mass)
    call archive%pass(sums%moment)
    call archive%pass(sums%momentum)
    call archive%pass(sums%kinetic)
    call archive%pass(sums%internal)
    call archive%pass(sums%taken)
    call archive%pass(sums%loose)
  end subroutine pass_body

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
    if (.not. allocated(outputs%contact%impulse)) then
      allocate (outputs%contact%impulse(contact_impulses, pairs))
    end if
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
