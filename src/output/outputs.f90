!> All files of a run: which rows and dumps are due, and the writers behind them.
module sgmp_outputs
  use sgmp_body_rows, only: body_rows_write, momentum_in_output
  use sgmp_contact_output, only: contact_rows_open, contact_rows_t, contact_rows_write
  use sgmp_driven_output, only: motion_rows_open, motion_rows_t, motion_rows_write
  use sgmp_energy, only: ledger_total
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, from_removed
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: behind_error, directory_make
  use sgmp_gauges, only: gauges_find, gauges_from_start, gauges_open, gauges_start, gauges_t, &
                         gauges_write
  use sgmp_history, only: bodies_columns, bodies_integers, column_length, history_columns, &
                          history_t, swirl_columns
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_rank
  use sgmp_particle_fields, only: particle_field_find, particle_field_t
  use sgmp_particle_table, only: particle_table_write
  use sgmp_process, only: memory_available_bytes
  use sgmp_rigid_output, only: rigid_rows_open, rigid_rows_t, rigid_rows_write
  use sgmp_scene, only: dump_formats, dump_tecplot, dump_vtkhdf, dump_vtu, name_length, scene_t
  use sgmp_section_output, only: section_rows_open, section_rows_start, section_rows_t, &
                                 section_rows_write
  use sgmp_snapshot, only: snapshot_t
  use sgmp_snapshot_make, only: snapshot_give_ids, snapshot_initial_positions, &
                                snapshot_slice, snapshot_whole
  use sgmp_tecplot, only: tecplot_t
  use sgmp_vtkhdf, only: vtkhdf_t
  use sgmp_vtu, only: vtu_series_t
  use sgmp_write_behind, only: write_behind_t
  implicit none
  private
  public :: outputs_t, outputs_open, outputs_step, outputs_close, outputs_flush, &
            outputs_next_time, outputs_stop

  !> Writers and their schedules.
  type :: outputs_t
    character(:), allocatable :: folder
    type(history_t) :: history, bodies
    type(gauges_t) :: gauges
    type(section_rows_t) :: sections
    type(contact_rows_t) :: contact
    type(rigid_rows_t) :: rigid
    type(motion_rows_t) :: motion
    type(vtu_series_t) :: vtu
    type(tecplot_t) :: tecplot
    type(vtkhdf_t) :: vtkhdf
    type(write_behind_t) :: behind               !! on the first rank: writes files of all particles
    character(name_length), allocatable :: fields(:)
    real(dp), allocatable :: initial(:, :)  !! initial positions by id, where a field needs them
    integer :: dumps(dump_formats) = 0             !! written, by format
    integer :: last_dump_step(dump_formats) = -1
    real(dp) :: last_dump_time(dump_formats) = -huge(1.0_dp)
    integer :: history_rows = 0                    !! rows due by time that have been written
    integer :: last_row_step = -1
    real(dp) :: dump_interval(dump_formats) = 0.0_dp, row_interval = 0.0_dp
      !! that the counts belong to
  end type outputs_t

  integer(i8), parameter :: most_waiting = 2_i8**30  !! bytes that may wait to be written,
  integer(i8), parameter :: waiting_share = 16_i8    !! which part of the memory there is,
  integer(i8), parameter :: waiting_least = 2_i8**25, waiting_each = 32_i8
    !! and how many where particles are few, else of each
  real(dp), parameter :: round_off = 1.0e-9_dp
    !! of an interval: multiples of two intervals that are one time on paper

contains

  !> Opens the files of a run and writes the initial state; on a restart they are cut back to what
  !! the checkpoint knows of, and continued.
  subroutine outputs_open(outputs, scene, model, folder, error, restarted)
    type(outputs_t), intent(inout) :: outputs
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(out) :: error
    logical, intent(in) :: restarted             !! the counts come from a checkpoint
    real(dp), allocatable :: time  !! not allocated in a new run: an absent argument below
    outputs%folder = folder
    call gauges_start(outputs%gauges, scene%gauges, model)
    call section_rows_start(outputs%sections, scene%sections, model)
    if (restarted) call count_anew(outputs, scene, model)
    outputs%dump_interval = scene%output%every
    outputs%row_interval = scene%output%history_every
    if (parallel_rank() == 0) call open_files(outputs, scene, model, restarted, error)
    call parallel_agree(error)
    if (allocated(error)) return
    allocate (outputs%fields(0))
    if (allocated(scene%output%fields)) outputs%fields = scene%output%fields
    if (any_from_start(outputs%fields) .or. gauges_from_start(outputs%gauges)) then
      call snapshot_initial_positions(scene, model, outputs%initial, error)
      if (allocated(error)) return
    end if
    if (scene%output%writes(dump_vtkhdf)) then
      if (restarted) time = outputs%last_dump_time(dump_vtkhdf)
      call outputs%vtkhdf%open(folder//'/particles.vtkhdf', expected_dumps(scene), error, time)
      if (allocated(error)) return
    end if
    if (restarted) return
    call gauges_find(outputs%gauges, model, outputs%initial, error)
    if (allocated(error)) return
    call outputs_step(outputs, scene, model, .false., error)
  end subroutine outputs_open

  !> Whether a field needs the initial positions.
  function any_from_start(names) result(yes)
    character(*), intent(in) :: names(:)
    logical :: yes
    type(particle_field_t) :: field
    integer :: f
    yes = .false.
    do f = 1, size(names)
      field = particle_field_find(names(f))
      yes = yes .or. field%from_start
    end do
  end function any_from_start

  !> Opens the files, on the first rank.
  subroutine open_files(outputs, scene, model, restarted, error)
    type(outputs_t), intent(inout) :: outputs
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical, intent(in) :: restarted
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: folder
    folder = outputs%folder
    call outputs%behind%start(max(0_i8, min(most_waiting, memory_available_bytes()/waiting_share, &
                                            max(waiting_least, waiting_each* &
                                                sum(int(model%totals%particles, i8))))))
    call directory_make(folder, error)
    if (.not. allocated(error)) call open_tables(outputs, model, folder, restarted, error)
    if (.not. allocated(error)) call open_dumps(outputs, scene, folder, restarted, error)
  end subroutine open_files

  !> Tables that grow row by row.
  subroutine open_tables(outputs, model, folder, restarted, error)
    type(outputs_t), intent(inout) :: outputs
    type(model_t), intent(in) :: model
    character(*), intent(in) :: folder
    logical, intent(in) :: restarted
    type(error_t), allocatable, intent(out) :: error
    character(column_length), allocatable :: columns(:)
    integer, allocatable :: step  !! not allocated in a new run: an absent argument below
    if (restarted) step = outputs%last_row_step
    columns = history_columns
    columns = [columns, term_columns(model%ledger%terms)]
    if (model%method%swirl) columns = [columns, swirl_columns, around_columns(model%ledger%terms)]
    call outputs%history%open(folder//'/history.csv', columns, error, keep_to_step=step)
    if (allocated(error)) return
    call outputs%bodies%open(folder//'/bodies.csv', bodies_columns, error, bodies_integers, step, &
                             'name')
    if (allocated(error)) return
    call contact_rows_open(outputs%contact, model, folder//'/contact.csv', error, step)
    if (allocated(error)) return
    call rigid_rows_open(outputs%rigid, model, folder//'/rigid.csv', error, step)
    if (allocated(error)) return
    call motion_rows_open(outputs%motion, model, folder//'/motion.csv', error, step)
    if (allocated(error)) return
    call gauges_open(outputs%gauges, model, folder//'/gauges.csv', error, step)
    if (allocated(error)) return
    call section_rows_open(outputs%sections, folder//'/sections.csv', error, step)
  end subroutine open_tables

  !> Files of all particles.
  subroutine open_dumps(outputs, scene, folder, restarted, error)
    type(outputs_t), intent(inout) :: outputs
    type(scene_t), intent(in) :: scene
    character(*), intent(in) :: folder
    logical, intent(in) :: restarted
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: time  !! not allocated in a new run: an absent argument below
    if (scene%output%writes(dump_vtu)) then
      if (restarted) time = outputs%last_dump_time(dump_vtu)
      call outputs%vtu%open(folder, 'particles', error, time)
      if (allocated(error)) return
    end if
    if (scene%output%writes(dump_tecplot)) then
      if (restarted) time = outputs%last_dump_time(dump_tecplot)
      call outputs%tecplot%open(folder//'/particles.dat', scene%title, error, time)
    end if
  end subroutine open_dumps

  !> After a change of an interval: the counts of the new one.
  pure subroutine count_anew(outputs, scene, model)
    type(outputs_t), intent(inout) :: outputs
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer :: k
    do k = 1, dump_formats
      associate (every => scene%output%every(k))
        if (abs(every - outputs%dump_interval(k)) <= 0.0_dp) cycle
        outputs%dumps(k) = 1
        if (every > 0.0_dp) outputs%dumps(k) = int(model%clock%time/every + round_off) + 1
      end associate
    end do
    if (abs(scene%output%history_every - outputs%row_interval) > 0.0_dp) then
      outputs%history_rows = 0
      if (scene%output%history_every > 0.0_dp) outputs%history_rows = rows_due(scene, model)
    end if
  end subroutine count_anew

  !> Next time that a step has to end at: a dump or the end of the run. Rows of histories take the
  !! steps as they come, for steps cut short for them could make a stable run unstable.
  pure function outputs_next_time(outputs, scene) result(time)
    type(outputs_t), intent(in) :: outputs
    type(scene_t), intent(in) :: scene
    real(dp) :: time
    time = huge(1.0_dp)
    if (scene%time%end > 0.0_dp) time = scene%time%end
    associate (output => scene%output)
      time = min(time, minval(outputs%dumps*output%every, &
                              output%writes .and. output%every > 0.0_dp))
    end associate
  end function outputs_next_time

  !> Formats whose interval is over.
  pure function dumps_due(outputs, scene, model) result(due)
    type(outputs_t), intent(in) :: outputs
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical :: due(dump_formats)
    due = model%clock%step == 0
    where (scene%output%every > 0.0_dp) &
      due = model%clock%time >= (outputs%dumps - round_off)*scene%output%every
  end function dumps_due

  !> Rows that are due by a time, the one at the start among them; sums of steps fall short of a
  !! row's time by round-off.
  pure function rows_due(scene, model) result(rows)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer :: rows
    rows = 1 + int(min((model%clock%time + 1.0e-6_dp*model%clock%dt)/scene%output%history_every, &
                       0.5_dp*huge(rows)))
  end function rows_due

  !> Dumps that a run will write to its VTKHDF file, as far as its deck tells.
  pure function expected_dumps(scene) result(n)
    type(scene_t), intent(in) :: scene
    integer :: n
    integer, parameter :: unknown = 16, most = 1000  ! the file grows where these are too few
    real(dp) :: intervals
    n = 2
    if (scene%output%every(dump_vtkhdf) <= 0.0_dp) return
    n = unknown
    if (scene%time%end <= 0.0_dp .or. scene%time%end >= huge(1.0_dp)) return
    intervals = scene%time%end/scene%output%every(dump_vtkhdf)
    n = 1 + ceiling(min(intervals*(1.0_dp - 1.0e-12_dp), real(most, dp)))
  end function expected_dumps

  !> Writes what is due at the model's time; at the end everything that has not been written.
  subroutine outputs_step(outputs, scene, model, at_end, error)
    type(outputs_t), intent(inout) :: outputs
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical, intent(in) :: at_end
    type(error_t), allocatable, intent(out) :: error
    logical :: due
    if (scene%output%history_every > 0.0_dp) then
      due = rows_due(scene, model) > outputs%history_rows .or. &
            model%clock%dt >= scene%output%history_every
      if (due) outputs%history_rows = rows_due(scene, model)
    else
      due = mod(model%clock%step, max(1, scene%output%history_steps)) == 0
    end if
    if ((due .or. at_end) .and. model%clock%step /= outputs%last_row_step) then
      call write_rows(outputs, model, error)
    end if
    if (allocated(error)) return
    call dump(outputs, scene, model, at_end .or. dumps_due(outputs, scene, model), error)
    if (allocated(error)) return
    if (at_end .and. scene%output%csv_end) call write_csv(outputs, model, error)
  end subroutine outputs_step

  !> One row of each history.
  subroutine write_rows(outputs, model, error)
    type(outputs_t), intent(inout) :: outputs
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    outputs%last_row_step = model%clock%step
    if (parallel_rank() == 0) call write_sums(outputs, model, error)
    call parallel_agree(error)
    if (allocated(error)) return
    call gauges_write(outputs%gauges, model, outputs%initial, error)
    if (allocated(error)) return
    call section_rows_write(outputs%sections, model, error)
  end subroutine write_rows

  !> Columns of history.csv of the terms of the energy balance that have any.
  pure function term_columns(terms) result(columns)
    type(energy_terms_t), intent(in) :: terms
    character(column_length), allocatable :: columns(:)
    character(2), parameter :: ends(3) = ['_x', '_y', '_z']
    integer :: t, d
    allocate (columns(0))
    do t = 1, terms%n
      associate (term => terms%term(t))
        if (term%column == '') cycle
        if (term%components == 1) then
          columns = [columns, term%column]
        else
          columns = [columns, [(term%column(:len_trim(term%column))//ends(d), d=1, 3)]]
        end if
      end associate
    end do
  end function term_columns

  !> Columns of the moments about the axis that particles took along.
  pure function around_columns(terms) result(columns)
    type(energy_terms_t), intent(in) :: terms
    character(column_length), allocatable :: columns(:)
    integer :: t
    allocate (columns(0))
    do t = 1, terms%n
      associate (column => terms%term(t)%column)
        if (goes_around(terms%term(t))) then
          columns = [columns, [character(column_length) :: &
                               column(:index(column, '_'))//swirl_columns(1)]]
        end if
      end associate
    end do
  end function around_columns

  !> Whether the third component of a term is a moment about the axis, where there is swirl.
  pure logical function goes_around(term) result(yes)
    type(energy_term_t), intent(in) :: term
    yes = term%source == from_removed .and. term%components == 3 .and. term%column /= ''
  end function goes_around

  !> Rows of what all ranks know.
  subroutine write_sums(outputs, model, error)
    type(outputs_t), intent(inout) :: outputs
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: values(:)
    integer :: t
    associate (l => model%ledger)
      values = [model%clock%time, model%clock%dt, l%kinetic, l%internal, ledger_total(l), &
                l%external_work, l%contact_dissipation, l%viscous_dissipation, &
                l%interpolation_error, l%remainder, momentum_in_output(model, l%momentum)]
      do t = 1, l%terms%n
        associate (term => l%terms%term(t))
          if (term%column == '') cycle
          if (term%components == 1) then
            values = [values, term%value(1)]
          else
            values = [values, momentum_in_output(model, term%value)]
          end if
        end associate
      end do
      if (model%method%swirl) then
        values = [values, model%mesh%h*l%momentum(3)]
        do t = 1, l%terms%n
          if (goes_around(l%terms%term(t))) values = [values, model%mesh%h*l%terms%term(t)%value(3)]
        end do
      end if
    end associate
    call outputs%history%write_row(model%clock%step, values, error)
    if (allocated(error)) return
    call body_rows_write(outputs%bodies, model, error)
    if (allocated(error)) return
    call contact_rows_write(outputs%contact, model, error)
    if (allocated(error)) return
    call rigid_rows_write(outputs%rigid, model, error)
    if (allocated(error)) return
    call motion_rows_write(outputs%motion, model, error)
  end subroutine write_sums

  !> A dump of the fields in each format that is due and has none of this step.
  subroutine dump(outputs, scene, model, due, error)
    type(outputs_t), intent(inout) :: outputs
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical, intent(in) :: due(dump_formats)
    type(error_t), allocatable, intent(out) :: error
    type(snapshot_t) :: snapshot
    integer(i8) :: before, total
    logical :: written(dump_formats)
    written = due .and. outputs%last_dump_step /= model%clock%step
    where (written)
      outputs%dumps = outputs%dumps + 1
      outputs%last_dump_step = model%clock%step
      outputs%last_dump_time = model%clock%time
    end where
    written = written .and. scene%output%writes
    if (written(dump_vtkhdf)) then
      call snapshot_slice(model, outputs%fields, outputs%initial, snapshot, before, total)
      call snapshot_give_ids(model%bodies, snapshot)
      call outputs%vtkhdf%dump(snapshot, before, total, error)
      if (allocated(error)) return
    end if
    if (.not. (written(dump_vtu) .or. written(dump_tecplot))) return
    call snapshot_whole(model, outputs%fields, outputs%initial, snapshot)
    call snapshot_give_ids(model%bodies, snapshot)
    if (parallel_rank() == 0) then
      call behind_error(outputs%behind, .false., error)  ! of the dump before
      if (written(dump_vtu) .and. .not. allocated(error)) then
        call outputs%vtu%dump(snapshot, error, outputs%behind)
      end if
      if (written(dump_tecplot) .and. .not. allocated(error)) then
        call outputs%tecplot%dump(snapshot, error)
      end if
    end if
    call parallel_agree(error)
  end subroutine dump

  subroutine write_csv(outputs, model, error)
    type(outputs_t), intent(in) :: outputs
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    type(snapshot_t) :: snapshot
    call snapshot_whole(model, outputs%fields, outputs%initial, snapshot)
    call snapshot_give_ids(model%bodies, snapshot)
    if (parallel_rank() == 0) then
      call particle_table_write(outputs%folder//'/particles_end.csv', snapshot, error, &
                                outputs%behind)
    end if
    call parallel_agree(error)
  end subroutine write_csv

  !> Makes all rows written so far safe on the disk, as far as a checkpoint counts on them, and lets
  !! the dumps that are being written come to their end.
  subroutine outputs_flush(outputs, error)
    type(outputs_t), intent(inout) :: outputs
    type(error_t), allocatable, intent(out) :: error
    call outputs%history%flush(error, .true.)
    if (.not. allocated(error)) call outputs%bodies%flush(error, .true.)
    if (.not. allocated(error)) call outputs%contact%file%flush(error, .true.)
    if (.not. allocated(error)) call outputs%rigid%file%flush(error, .true.)
    if (.not. allocated(error)) call outputs%motion%file%flush(error, .true.)
    if (.not. allocated(error)) call outputs%gauges%file%flush(error, .true.)
    if (.not. allocated(error)) call outputs%sections%file%flush(error, .true.)
    if (.not. allocated(error)) call behind_error(outputs%behind, .true., error)
  end subroutine outputs_flush

  !> Writes the final state and closes all files.
  subroutine outputs_close(outputs, scene, model, error)
    type(outputs_t), intent(inout) :: outputs
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    type(snapshot_t) :: snapshot
    call outputs_step(outputs, scene, model, .true., error)
    if (allocated(error)) return
    if (outputs%vtkhdf%has_room()) then
      call snapshot_whole(model, outputs%fields, outputs%initial, snapshot)
      call snapshot_give_ids(model%bodies, snapshot)
      call outputs%vtkhdf%trim(snapshot, error)
      if (allocated(error)) return
    end if
    if (parallel_rank() == 0) call outputs_stop(outputs, error)
    call parallel_agree(error)
  end subroutine outputs_close

  !> Closes all files as they are, to be continued.
  subroutine outputs_stop(outputs, error)
    type(outputs_t), intent(inout) :: outputs
    type(error_t), allocatable, intent(out) :: error
    call behind_error(outputs%behind, .true., error)
    call outputs%behind%stop()
    if (allocated(error)) return
    call outputs%history%close(error)
    if (allocated(error)) return
    call outputs%bodies%close(error)
    if (allocated(error)) return
    if (outputs%contact%file%is_open()) call outputs%contact%file%close(error)
    if (allocated(error)) return
    if (outputs%rigid%file%is_open()) call outputs%rigid%file%close(error)
    if (allocated(error)) return
    if (outputs%motion%file%is_open()) call outputs%motion%file%close(error)
    if (allocated(error)) return
    if (outputs%gauges%file%is_open()) call outputs%gauges%file%close(error)
    if (allocated(error)) return
    if (outputs%sections%file%is_open()) call outputs%sections%file%close(error)
    if (allocated(error)) return
    call outputs%tecplot%close(error)
  end subroutine outputs_stop

end module sgmp_outputs
