!> What a run knows besides its particles and its grid: time, sums, motions, counters of its files.
!!
!! One procedure names it all, for writing and for reading.
module sgmp_state
  use sgmp_body, only: body_t
  use sgmp_energy, only: ledger_t
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: body_sums_t, model_t
  use sgmp_outputs, only: outputs_t
  use sgmp_record, only: record_t
  use sgmp_shared_nodes, only: contact_pair_t
  use sgmp_time_step, only: clock_t
  implicit none
  private
  public :: state_pass

contains

  !> Writes the state of a run into a record, or takes it from one.
  subroutine state_pass(record, model, outputs, particle_steps)
    type(record_t), intent(inout) :: record
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    integer(i8), intent(inout) :: particle_steps
    integer :: b, p
    call pass_clock(record, model%clock)
    call record%pass(model%cutoff)
    call record%pass(model%fastest)
    call record%pass(model%fastest_id)
    call record%pass(model%fastest_field)
    call record%pass(model%fastest_before)
    call record%pass(model%lost)
    call record%pass(model%lost_before)
    call record%pass(model%moved)
    call record%pass(particle_steps)
    call pass_ledger(record, model%ledger)
    call record%pass(model%points)
    if (.not. allocated(model%counts)) allocate (model%counts(size(model%bodies)))
    do b = 1, size(model%bodies)
      call record%pass(model%counts(b))
      call pass_body(record, model%bodies(b), model%body_sums(b))
    end do
    do p = 1, size(model%pairs)
      call pass_pair(record, model%pairs(p))
    end do
    call pass_outputs(record, outputs, size(model%pairs))
  end subroutine state_pass

  !> The clock less what the deck sets.
  subroutine pass_clock(record, clock)
    type(record_t), intent(inout) :: record
    type(clock_t), intent(inout) :: clock
    call record%pass(clock%step)
    call record%pass(clock%limited_by)
    call record%pass(clock%next_probe)
    call record%pass(clock%limit)
    call record%pass(clock%time)
    call record%pass(clock%dt)
    call record%pass(clock%dt_before)
    call record%pass(clock%dt_free)
    call record%pass(clock%smallest)
    call record%pass(clock%next_probe)
    call record%pass(clock%limit)
  end subroutine pass_clock

  subroutine pass_ledger(record, ledger)
    type(record_t), intent(inout) :: record
    type(ledger_t), intent(inout) :: ledger
    call record%pass(ledger%kinetic)
    call record%pass(ledger%internal)
    call record%pass(ledger%initial_total)
    call record%pass(ledger%external_work)
    call record%pass(ledger%contact_dissipation)
    call record%pass(ledger%viscous_dissipation)
    call record%pass(ledger%interpolation_error)
    call record%pass(ledger%remainder)
    call record%pass(ledger%predicted)
    call record%pass(ledger%largest_kinetic)
    call record%pass(ledger%momentum)
    call record%pass(ledger%ignored_nodes)
  end subroutine pass_ledger

  subroutine pass_body(record, body, sums)
    type(record_t), intent(inout) :: record
    type(body_t), intent(inout) :: body
    type(body_sums_t), intent(inout) :: sums
    call record%pass(body%first_id)
    call record%pass(body%speed)
    call record%pass(body%speed_before)
    call record%pass(sums%mass)
    call record%pass(sums%moment)
    call record%pass(sums%momentum)
    call record%pass(sums%kinetic)
    call record%pass(sums%internal)
  end subroutine pass_body

  subroutine pass_pair(record, pair)
    type(record_t), intent(inout) :: record
    type(contact_pair_t), intent(inout) :: pair
    call record%pass(pair%impulse)
    call record%pass(pair%angular_impulse)
    call record%pass(pair%dissipation)
    call record%pass(pair%shared)
    call record%pass(pair%touching)
  end subroutine pass_pair

  !> How far the files of the run had come.
  subroutine pass_outputs(record, outputs, pairs)
    type(record_t), intent(inout) :: record
    type(outputs_t), intent(inout) :: outputs
    integer, intent(in) :: pairs
    call record%pass(outputs%dumps)
    call record%pass(outputs%history_rows)
    call record%pass(outputs%last_dump_step)
    call record%pass(outputs%last_row_step)
    call record%pass(outputs%last_dump_time)
    call record%pass(outputs%dump_interval)
    call record%pass(outputs%row_interval)
    call record%pass(outputs%gauge_ids, .true.)
    call record%pass(outputs%contact%step)
    call record%pass(outputs%contact%time)
    if (pairs == 0) return
    if (.not. allocated(outputs%contact%impulse)) allocate (outputs%contact%impulse(6, pairs))
    call record%pass(outputs%contact%impulse)
  end subroutine pass_outputs

end module sgmp_state
