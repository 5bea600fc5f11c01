!> Checkpoints: the whole state of a run in one file, from which it goes on with the same bits, on
!! any number of ranks and threads.
!!
!! Besides the particles the file holds the sums that the last sweep has projected onto the grid:
!! the next step starts from them, and projected anew they would differ in the last bits, for
!! particles that have just changed their bin were added in an order of their own, and the bulk
!! viscosity of the step is known to nobody any more.
!!
!! A file appears under its name only when all of it is on the disk; then files older than those to
!! be kept go.
module sgmp_checkpoint
  use sgmp_archive, only: archive_t
  use sgmp_body, only: body_t
  use sgmp_contents, only: contents_text
  use sgmp_errors, only: error_make, error_t, exit_io
  use sgmp_field, only: field_t
  use sgmp_file_tools, only: file_remove, file_rename, io_error, newline, system_message
  use sgmp_hdf5_file, only: hdf5_file_t, hdf5_long, hdf5_real
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_outputs, only: outputs_t
  use sgmp_parallel, only: parallel_agree, parallel_rank, parallel_scan, parallel_sum
  use sgmp_particles, only: particles_t
  use sgmp_posix, only: file_number, file_reserve, file_sync
  use sgmp_rows, only: key_k, rows_points, rows_t
  use sgmp_scene, only: scene_t, statement_text_t
  use sgmp_state, only: state_pass
  use sgmp_text, only: integer_text
  use sgmp_version, only: commit_hash, version_string
  implicit none
  private
  public :: checkpoint_bytes, checkpoint_fixed_text, checkpoint_path, checkpoint_set_aside, &
            checkpoint_write
  public :: checkpoint_format, checkpoint_prefix, checkpoint_suffix, block_columns, &
            plane_columns

  character(*), parameter :: checkpoint_format = 'sgmp checkpoint 13'
  character(*), parameter :: checkpoint_prefix = 'checkpoint_', checkpoint_suffix = '.h5'
  integer, parameter :: block_columns = 8192  !! particles or grid points put or got at a time
  integer, parameter :: plane_columns = 4     !! of the tables of planes
  integer(i8), parameter :: overhead = 2_i8**18  !! bytes allowed for the structure of a file

contains

  !> The name of a checkpoint: that of its step.
  pure function checkpoint_path(folder, step) result(path)
    character(*), intent(in) :: folder
    integer(i8), intent(in) :: step
    character(:), allocatable :: path
    character(24) :: number
    write (number, '(i0.7)') step
    path = folder//'/'//checkpoint_prefix//trim(number)//checkpoint_suffix
  end function checkpoint_path

  !> Writes the state of a run at the end of a step; after a failure earlier checkpoints are as they
  !! were. All ranks come here together and get the same error.
  subroutine checkpoint_write(scene, model, outputs, particle_steps, folder, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    integer(i8), intent(inout) :: particle_steps
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path, part
    type(error_t), allocatable :: problem
    integer(i8) :: bytes
    path = checkpoint_path(folder, int(model%clock%step, i8))
    part = path//'.part'
    bytes = parallel_sum(checkpoint_bytes(model)) + overhead
    if (parallel_rank() == 0) then
      if (.not. file_reserve(part, bytes)) call io_error(error, 'write', part, system_message())
    end if
    call parallel_agree(error)
    if (allocated(error)) return
    call write_file(scene, model, outputs, particle_steps, part, error)
    if (parallel_rank() == 0 .and. .not. allocated(error)) call put_in_place(part, path, folder, &
                                                                             error)
    call parallel_agree(error)
    if (parallel_rank() > 0) return
    if (allocated(error)) then
      call file_remove(part, problem)
    else
      call remove_older(folder, int(model%clock%step, i8), scene%checkpoint%keep)
    end if
  end subroutine checkpoint_write

  !> Bytes of this rank's particles and grid sums.
  pure function checkpoint_bytes(model) result(bytes)
    type(model_t), intent(in) :: model
    integer(i8) :: bytes
    integer :: b, f
    bytes = 0_i8
    do b = 1, size(model%bodies)
      associate (particles => model%bodies(b)%particles)
        bytes = bytes + 8_i8*(particles%motion_columns + particles%state_columns + 1)* &
                particles%count &
                + 8_i8*size(particles%size) + 24_i8*particles%bins%n
      end associate
    end do
    do f = 1, size(model%fields)
      bytes = bytes + 8_i8*model%fields(f)%columns%total*rows_points(model%fields(f)%work) &
              + 24_i8*model%fields(f)%work%n
    end do
  end function checkpoint_bytes

  subroutine write_file(scene, model, outputs, particle_steps, path, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    integer(i8), intent(inout) :: particle_steps
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    type(archive_t) :: archive
    integer :: b, f
    call file%create(path, shared=.true., summed=.true.)
    call file%put_text('/format', checkpoint_format)
    call file%put_text('/program', version_string//' ('//commit_hash//')')
    call file%put_text('/contents', contents_text(model))
    call file%put_text('/deck', scene%resolved)
    call file%put_text('/fixed', checkpoint_fixed_text(scene%fixed))
    call archive%start()
    call state_pass(archive, model, outputs, particle_steps)
    call put_archive(file, archive)
    do b = 1, size(model%bodies)
      call put_particles(file, '/body_'//integer_text(b), model%bodies(b)%particles)
      call put_given_ids(file, '/body_'//integer_text(b), model%bodies(b))
    end do
    do f = 1, size(model%fields)
      call put_field(file, '/field_'//integer_text(f), model%fields(f), model%ranks%partition%own)
    end do
    call file%close(error)
    call parallel_agree(error)
  end subroutine write_file

  !> The part of the deck that a restart may not change, one statement per line.
  pure function checkpoint_fixed_text(fixed) result(text)
    type(statement_text_t), intent(in) :: fixed(:)
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(fixed)
      text = text//fixed(i)%text//newline
    end do
  end function checkpoint_fixed_text

  subroutine put_archive(file, archive)
    type(hdf5_file_t), intent(inout) :: file
    type(archive_t), intent(in) :: archive
    call file%declare('/reals', hdf5_real, int(archive%real_place, i8), 1)
    call file%declare('/wholes', hdf5_long, int(archive%whole_place, i8), 1)
    if (parallel_rank() > 0) return
    call file%put('/reals', reshape(archive%reals(:archive%real_place), [1, archive%real_place]), &
      0_i8)
    call file%put('/wholes', reshape(archive%wholes(:archive%whole_place), &
                                     [1, archive%whole_place]), 0_i8)
  end subroutine put_archive

  !> Intervals of a set whose planes a rank owns: they follow each other.
  pure function own_intervals(rows, own) result(range)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: own(2)          !! first and last plane
    integer :: range(2), s
    range = [rows%n + 1, rows%n]
    do s = 1, rows%n
      if (key_k(rows%key(s)) < own(1)) cycle
      if (key_k(rows%key(s)) > own(2)) then
        range(2) = s - 1
        exit
      end if
      range(1) = min(range(1), s)
    end do
    range(1) = min(range(1), range(2) + 1)  ! none at all, but some of higher planes
  end function own_intervals

  !> The own rows of a set as columns key, first, last; ranks follow each other. A table of the
  !! planes tells a reader where in the file each begins: k, intervals, points, particles.
  subroutine put_rows(file, name, rows, range, particles)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: range(2)        !! see own_intervals
    type(particles_t), intent(in), optional :: particles  !! whose bins they are
    integer(i8), allocatable :: table(:, :), planes(:, :)
    integer(i8) :: n
    integer :: s, p
    n = range(2) - range(1) + 1
    allocate (table(3, n), planes(plane_columns, n), source=0_i8)
    p = 0
    do s = range(1), range(2)
      table(:, s - range(1) + 1) = [rows%key(s), int(rows%first(s), i8), int(rows%last(s), i8)]
      if (p > 0) then
        if (planes(1, p) /= key_k(rows%key(s))) p = -p
      end if
      if (p <= 0) then
        p = 1 - p
        planes(1, p) = key_k(rows%key(s))
      end if
      planes(2:3, p) = planes(2:3, p) + [1_i8, int(rows%last(s) - rows%first(s) + 1, i8)]
      if (present(particles)) planes(4, p) = planes(4, p) + sum(particles%size( &
        particles%bin_start(s) + rows%first(s):particles%bin_start(s) + rows%last(s)))
    end do
    call file%declare(name, hdf5_long, parallel_sum(n), 3)
    call file%put(name, table, parallel_scan(n))
    call file%declare(name//'_planes', hdf5_long, parallel_sum(int(p, i8)), plane_columns)
    call file%put(name//'_planes', planes(:, :p), parallel_scan(int(p, i8)))
  end subroutine put_rows

  !> Own bins with their particles, in the order of the bins.
  subroutine put_particles(file, name, particles)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(particles_t), intent(in) :: particles
    integer(i8) :: bins, before
    integer :: range(2), first, last
    call file%add_group(name)
    range = own_intervals(particles%bins, particles%own)
    call put_rows(file, name//'/bins', particles%bins, range, particles)
    first = 1
    last = 0
    if (range(1) <= range(2)) then
      first = particles%bin_start(range(1)) + particles%bins%first(range(1))
      last = particles%bin_start(range(2)) + particles%bins%last(range(2))
    end if
    bins = last - first + 1
    call file%declare(name//'/sizes', hdf5_long, parallel_sum(bins), 1)
    call file%put(name//'/sizes', reshape(int(particles%size(first:last), i8), [1, int(bins)]), &
                  parallel_scan(bins))
    call file%declare(name//'/ids', hdf5_long, parallel_sum(int(particles%count, i8)), 1)
    call file%declare(name//'/particles', hdf5_real, parallel_sum(int(particles%count, i8)), &
                      particles%motion_columns + particles%state_columns)
    before = parallel_scan(int(particles%count, i8))
    call put_columns(file, name, particles, before)
  end subroutine put_particles

  !> Ids that a file gives the particles of a body, which every rank knows.
  subroutine put_given_ids(file, name, body)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(body_t), intent(in) :: body
    call file%declare(name//'/given_ids', hdf5_long, size(body%given_ids, kind=i8), 1)
    if (parallel_rank() > 0) return
    call file%put(name//'/given_ids', reshape(int(body%given_ids, i8), &
                                              [1, size(body%given_ids)]), 0_i8)
  end subroutine put_given_ids

  !> Particles of the bins one after the other, a block at a time.
  subroutine put_columns(file, name, particles, before)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(particles_t), intent(in) :: particles
    integer(i8), intent(in) :: before      !! particles of lower ranks
    integer(i8), allocatable :: ids(:, :)
    real(dp), allocatable :: columns(:, :)
    integer(i8) :: place
    integer :: bin, chunk, left, live, n, na, l, q
    na = particles%motion_columns
    allocate (ids(1, block_columns + lanes),  &
              columns(na + particles%state_columns, block_columns + lanes))
    place = before
    n = 0
    do bin = 1, size(particles%size)
      left = particles%size(bin)
      chunk = particles%first(bin)
      do while (left > 0)
        live = min(left, lanes)
        ids(1, n + 1:n + live) = int(particles%id(:live, chunk), i8)
        do l = 1, live
          do q = 1, na
            columns(q, n + l) = particles%motion(l, q, chunk)
          end do
          do q = 1, particles%state_columns
            columns(na + q, n + l) = particles%state(l, q, chunk)
          end do
        end do
        n = n + live
        left = left - live
        chunk = particles%next(chunk)
        if (n >= block_columns) call put_block()
      end do
    end do
    if (n > 0) call put_block()
  contains
    subroutine put_block()
      call file%put(name//'/ids', ids(:, :n), place)
      call file%put(name//'/particles', columns(:, :n), place)
      place = place + n
      n = 0
    end subroutine put_block
  end subroutine put_columns

  !> Projected sums at the points that a field computes on the own planes.
  subroutine put_field(file, name, field, own)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(field_t), intent(in) :: field
    integer, intent(in) :: own(2)
    real(dp), allocatable :: columns(:, :)
    integer(i8) :: place, points
    integer :: s, first, last, step, base, n, range(2)
    call file%add_group(name)
    range = own_intervals(field%work, own)
    call put_rows(file, name//'/points', field%work, range)
    points = sum(int(field%work%last(range(1):range(2)) - field%work%first(range(1):range(2)) + 1, &
                     i8))
    call file%declare(name//'/moments', hdf5_real, parallel_sum(points), field%columns%total)
    place = parallel_scan(points)
    allocate (columns(field%columns%total, block_columns))
    n = 0
    do s = range(1), range(2)
      base = field%neighbour(0, 0, s)
      first = field%work%first(s)
      do while (first <= field%work%last(s))
        step = min(block_columns - n, field%work%last(s) - first + 1)
        last = first + step - 1
        columns(:, n + 1:n + step) = transpose(field%moment(base + first:base + last, :))
        n = n + step
        first = last + 1
        if (n == block_columns) call put_block()
      end do
    end do
    if (n > 0) call put_block()
  contains
    subroutine put_block()
      call file%put(name//'/moments', columns(:, :n), place)
      place = place + n
      n = 0
    end subroutine put_block
  end subroutine put_field

  !> Makes a complete file safe and gives it its name.
  subroutine put_in_place(part, path, folder, error)
    character(*), intent(in) :: part, path, folder
    type(error_t), allocatable, intent(out) :: error
    if (.not. file_sync(part)) then
      call io_error(error, 'write', part)
      return
    end if
    call file_rename(part, path, error)
    if (allocated(error)) return
    if (.not. file_sync(folder)) call io_error(error, 'write', folder)
  end subroutine put_in_place

  !> Removes all but the newest checkpoints up to a step.
  subroutine remove_older(folder, step, keep)
    character(*), intent(in) :: folder
    integer(i8), intent(in) :: step
    integer, intent(in) :: keep
    type(error_t), allocatable :: error
    integer(i8) :: number
    integer :: n
    number = step + 1
    n = 0
    do
      number = file_number(folder, checkpoint_prefix, checkpoint_suffix, number)
      if (number < 0) return
      n = n + 1
      if (n > keep) call file_remove(checkpoint_path(folder, number), error)
    end do
  end subroutine remove_older

  !> Renames the checkpoints behind a step, which belong to another course of events, to *.old, so
  !! that `latest` does not find them.
  subroutine checkpoint_set_aside(folder, step, error)
    character(*), intent(in) :: folder
    integer(i8), intent(in) :: step
    type(error_t), allocatable, intent(out) :: error
    integer(i8) :: number
    if (parallel_rank() == 0) then
      number = huge(number)
      do
        number = file_number(folder, checkpoint_prefix, checkpoint_suffix, number)
        if (number <= step) exit
        call file_rename(checkpoint_path(folder, number), checkpoint_path(folder, number)//'.old', &
                         error)
        if (allocated(error)) exit
      end do
    end if
    call parallel_agree(error)
  end subroutine checkpoint_set_aside

end module sgmp_checkpoint
