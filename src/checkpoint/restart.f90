!> Going on from a checkpoint: finding it, making sure that it is whole and belongs to the deck, and
!! taking the state of the run from it.
module sgmp_restart
  use sgmp_archive, only: archive_t
  use sgmp_body, only: body_t
  use sgmp_build_model, only: model_build
  use sgmp_checkpoint, only: block_columns, checkpoint_fixed_text, checkpoint_format, &
                             checkpoint_path, checkpoint_prefix, checkpoint_suffix, plane_columns
  use sgmp_errors, only: error_make, error_t, exit_deck, exit_io
  use sgmp_field, only: field_t
  use sgmp_file_tools, only: newline
  use sgmp_hdf5_file, only: hdf5_file_t
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_outputs, only: outputs_t
  use sgmp_parallel, only: parallel_agree, parallel_any
  use sgmp_particles, only: particles_lay_out, particles_pad, particles_t
  use sgmp_partition, only: partition_cut, partition_t
  use sgmp_phases, only: phase_layout
  use sgmp_posix, only: file_number
  use sgmp_ranks, only: ranks_hold, ranks_renew_bins
  use sgmp_rows, only: key_k, rows_contains, rows_points, rows_t
  use sgmp_run_log, only: log_t
  use sgmp_scene, only: scene_t
  use sgmp_state, only: state_pass
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: restart_find, restart_read

contains

  !> The checkpoint that `--restart` means: a path, or with `latest` the newest of the output folder
  !! that is whole; '' where the folder has none at all. Fails where none of them is whole.
  subroutine restart_find(wanted, folder, log, path, error)
    character(*), intent(in) :: wanted, folder
    type(log_t), intent(inout) :: log
    character(:), allocatable, intent(out) :: path
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: problem
    integer(i8) :: number
    path = ''
    if (wanted /= 'latest') then
      path = wanted
      call check_file(path, error)
      return
    end if
    number = huge(number)
    do
      number = file_number(folder, checkpoint_prefix, checkpoint_suffix, number)
      if (number < 0) exit
      path = checkpoint_path(folder, number)
      call check_file(path, problem)
      if (.not. allocated(problem)) return
      call log%warning(problem%message//'; trying the one before')
    end do
    if (.not. allocated(problem)) return
    call error_make(error, exit_io, "no checkpoint in '"//folder//"' is whole", &
                    'remove them and start without --restart')
  end subroutine restart_find

  !> Reads all of a file and compares its checksums.
  subroutine check_file(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    type(error_t), allocatable :: problem
    character(:), allocatable :: format
    call file%open(path, shared=.true., writable=.false.)
    if (file%good()) then
      if (.not. file%has('/format')) then
        call error_make(error, exit_io, "cannot read '"//path//"': it is not a checkpoint of sgmp")
      else
        call file%get_text('/format', format)
        if (file%good() .and. format /= checkpoint_format) then
          call error_make(error, exit_io, "cannot read '"//path//"': its format is '"//format// &
                          "', not '"//checkpoint_format//"'", &
                          'go on with the version of sgmp that wrote it')
        end if
      end if
      if (.not. allocated(error)) call file%verify()
    end if
    call file%close(problem)
    if (.not. allocated(error)) call move_alloc(problem, error)
    if (allocated(error)) then
      if (error%remedy == '' .or. index(error%remedy, 'space left') > 0) error%remedy = &
        'take another checkpoint; --restart latest looks for the newest that is whole'
    end if
    call parallel_agree(error)
  end subroutine check_file

  !> Builds the model of a scene with the state of a checkpoint that has been found whole.
  subroutine restart_read(path, scene, threads, model, outputs, particle_steps, error)
    character(*), intent(in) :: path
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: threads
    type(model_t), intent(out) :: model
    type(outputs_t), intent(inout) :: outputs
    integer(i8), intent(out) :: particle_steps
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    type(error_t), allocatable :: problem
    call file%open(path, shared=.true., writable=.false.)
    call compare_decks(file, path, scene, error)
    if (.not. allocated(error)) call model_build(scene, threads, model, error, empty=.true.)
    if (.not. allocated(error)) call take_state(file, model, outputs, particle_steps, path, error)
    call file%close(problem)
    if (.not. allocated(error)) call move_alloc(problem, error)
    call parallel_agree(error)
  end subroutine restart_read

  !> Refuses a deck that differs from the checkpoint's in more than a restart may change.
  subroutine compare_decks(file, path, scene, error)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: path
    type(scene_t), intent(in) :: scene
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: free = &
      'a restart may change: time end, cfl and steps; title, output, history, checkpoint, '// &
      'balance, stop'
    character(:), allocatable :: before
    integer :: i, last
    call file%get_text('/fixed', before)
    if (.not. file%good() .or. before == checkpoint_fixed_text(scene%fixed)) return
    do i = 1, size(scene%fixed)
      last = index(before, newline) - 1
      if (last < 0) exit
      if (before(:last) /= scene%fixed(i)%text) then
        call error_make(error, exit_deck, 'the deck says `'//scene%fixed(i)%text// &
                        "`, that of '"//path//"' said `"//before(:last)//'`', free, &
                        scene%fixed(i)%location)
        return
      end if
      before = before(last + 2:)
    end do
    if (i <= size(scene%fixed)) then
      call error_make(error, exit_deck, "the deck of '"//path//"' did not have `"// &
                      scene%fixed(i)%text//'`', free, scene%fixed(i)%location)
    else
      call error_make(error, exit_deck, "the deck of '"//path//"' had `"// &
                      before(:index(before, newline) - 1)//'`, which this one has not', free, &
                      scene%file)
    end if
  end subroutine compare_decks

  !> Particles, grid sums and everything else.
  subroutine take_state(file, model, outputs, particle_steps, path, error)
    type(hdf5_file_t), intent(inout) :: file
    type(model_t), intent(inout) :: model
    type(outputs_t), intent(inout) :: outputs
    integer(i8), intent(out) :: particle_steps
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(archive_t) :: archive
    logical :: fits
    integer :: b, f
    particle_steps = 0_i8
    call get_archive(file, archive)
    if (file%good()) call state_pass(archive, model, outputs, particle_steps)
    fits = archive%ended() .and. file%good()
    if (fits) call cut_planes(file, model)
    do b = 1, size(model%bodies)
      if (fits) call get_particles(file, '/body_'//integer_text(b), model%bodies(b)%particles, fits)
      if (fits) call get_given_ids(file, '/body_'//integer_text(b), model%bodies(b))
    end do
    fits = .not. parallel_any(.not. (fits .and. file%good()))
    if (fits) then
      call ranks_renew_bins(model%ranks, model%bodies)
      call phase_layout(model%mesh, model%fields, model%bodies, model%contact, model%team, &
                        model%ranks%partition)
      do f = 1, size(model%fields)
        if (fits) call get_field(file, '/field_'//integer_text(f), model%fields(f), &
          model%ranks%partition, &
                                 fits)
      end do
    end if
    if (.not. fits) call error_make(error, exit_io, "cannot read '"//path// &
                                    "': it does not fit the model of this deck")
  end subroutine take_state

  !> Gives every rank planes with about as many particles that move.
  subroutine cut_planes(file, model)
    type(hdf5_file_t), intent(inout) :: file
    type(model_t), intent(inout) :: model
    integer(i8), allocatable :: planes(:, :)
    real(dp), allocatable :: load(:)
    integer :: b, p, low, high, pass
    low = huge(1)
    high = -huge(1)
    do pass = 1, 2
      if (pass == 2) allocate (load(low:max(low - 1, high)), source=0.0_dp)
      do b = 1, size(model%bodies)
        if (model%bodies(b)%at_rest) cycle
        call get_table(file, '/body_'//integer_text(b)//'/bins_planes', plane_columns, planes)
        if (size(planes, 2) == 0) cycle
        low = min(low, int(planes(1, 1)))
        high = max(high, int(planes(1, size(planes, 2))))
        if (pass == 1) cycle
        do p = 1, size(planes, 2)
          load(planes(1, p)) = load(planes(1, p)) + planes(4, p)
        end do
      end do
    end do
    if (high >= low) call partition_cut(model%ranks%partition, low, load)
    do b = 1, size(model%bodies)
      call ranks_hold(model%ranks%partition, model%bodies(b)%particles)
    end do
  end subroutine cut_planes

  subroutine get_archive(file, archive)
    type(hdf5_file_t), intent(inout) :: file
    type(archive_t), intent(inout) :: archive
    real(dp), allocatable :: reals(:, :)
    integer(i8), allocatable :: wholes(:, :)
    integer(i8) :: n, m
    integer :: rows
    call file%extent('/reals', rows, n)
    call file%extent('/wholes', rows, m)
    allocate (reals(1, max(n, 0_i8)), wholes(1, max(m, 0_i8)))
    call file%get('/reals', reals, 0_i8)
    call file%get('/wholes', wholes, 0_i8)
    call archive%start()
    archive%reading = .true.
    archive%reals = reals(1, :)
    archive%wholes = wholes(1, :)
  end subroutine get_archive

  !> A table of whole numbers, all of it.
  subroutine get_table(file, name, columns, table)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    integer, intent(in) :: columns
    integer(i8), allocatable, intent(out) :: table(:, :)
    integer(i8) :: n
    integer :: rows
    call file%extent(name, rows, n)
    allocate (table(columns, max(n, 0_i8)), source=0_i8)
    if (rows == columns) call file%get(name, table, 0_i8)
  end subroutine get_table

  !> The rows of a set on some planes, and how many points and particles of the file come before.
  subroutine get_rows(file, name, held, rows, points_before, particles_before)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    integer, intent(in) :: held(2)         !! first and last plane
    type(rows_t), intent(out) :: rows
    integer(i8), intent(out) :: points_before, particles_before
    integer(i8), allocatable :: planes(:, :), table(:, :)
    integer(i8) :: before, n
    integer :: p
    call get_table(file, name//'_planes', plane_columns, planes)
    before = 0_i8
    points_before = 0_i8
    particles_before = 0_i8
    n = 0_i8
    do p = 1, size(planes, 2)
      if (planes(1, p) > held(2)) exit
      if (planes(1, p) < held(1)) then
        before = before + planes(2, p)
        points_before = points_before + planes(3, p)
        particles_before = particles_before + planes(4, p)
      else
        n = n + planes(2, p)
      end if
    end do
    allocate (table(3, n), source=0_i8)
    call file%get(name, table, before)
    rows%n = int(n)
    rows%key = table(1, :)
    rows%first = int(table(2, :))
    rows%last = int(table(3, :))
  end subroutine get_rows

  !> The particles of a body in their bins, those of the own planes.
  subroutine get_particles(file, name, particles, fits)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(particles_t), intent(inout) :: particles
    logical, intent(inout) :: fits
    type(rows_t) :: bins
    integer(i8), allocatable :: sizes(:, :)
    integer, allocatable :: slot(:)
    integer(i8) :: n, bins_before, before
    integer :: rows
    call get_rows(file, name//'/bins', particles%own, bins, bins_before, before)
    call file%extent(name//'/particles', rows, n)
    fits = rows == particles%motion_columns + particles%state_columns .and. file%good()
    if (.not. fits) return
    allocate (sizes(1, rows_points(bins)), source=0_i8)
    call file%get(name//'/sizes', sizes, bins_before)
    fits = before + sum(sizes) <= n .and. file%good()
    if (.not. fits) return
    call particles_lay_out(particles, bins, int(sizes(1, :)), slot)
    call get_columns(file, name, particles, slot, before)
    call particles_pad(particles)
  end subroutine get_particles

  !> Ids that the particles' file gave all particles of a body, for every rank.
  subroutine get_given_ids(file, name, body)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(body_t), intent(inout) :: body
    integer(i8), allocatable :: table(:, :)
    call get_table(file, name//'/given_ids', 1, table)
    body%given_ids = int(table(1, :), i4)
  end subroutine get_given_ids

  !> Fills the lanes with the particles behind the first `before` of the file.
  subroutine get_columns(file, name, particles, slot, before)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: slot(:)         !! see particles_lay_out
    integer(i8), intent(in) :: before
    integer(i8), allocatable :: ids(:, :)
    real(dp), allocatable :: columns(:, :)
    integer :: first, n, p, l, c, q
    allocate (ids(1, min(block_columns, size(slot))))
    allocate (columns(particles%motion_columns + particles%state_columns, size(ids)))
    do first = 1, size(slot), block_columns
      n = min(block_columns, size(slot) - first + 1)
      call file%get(name//'/ids', ids(:, :n), before + first - 1)
      call file%get(name//'/particles', columns(:, :n), before + first - 1)
      do p = 1, n
        l = mod(slot(first + p - 1) - 1, lanes) + 1
        c = (slot(first + p - 1) - 1)/lanes + 1
        particles%id(l, c) = int(ids(1, p))
        do q = 1, particles%motion_columns
          particles%motion(l, q, c) = columns(q, p)
        end do
        do q = 1, particles%state_columns
          particles%state(l, q, c) = columns(particles%motion_columns + q, p)
        end do
      end do
    end do
  end subroutine get_columns

  !> The projected sums of a field at the points of the own planes and of those held beside them.
  subroutine get_field(file, name, field, partition, fits)
    type(hdf5_file_t), intent(inout) :: file
    character(*), intent(in) :: name
    type(field_t), intent(inout) :: field
    type(partition_t), intent(in) :: partition
    logical, intent(inout) :: fits
    type(rows_t) :: points
    real(dp), allocatable :: columns(:, :)
    integer(i8), allocatable :: before(:)  !! points in front of each interval
    integer(i8) :: total, place, first, last
    integer :: held(2), rows, s, w, i, k
    held = partition%own + [-partition%moments(1), partition%moments(2)]
    call get_rows(file, name//'/points', held, points, place, first)
    call file%extent(name//'/moments', rows, total)
    fits = rows == field%columns%total .and. place + rows_points(points) <= total .and. file%good()
    if (.not. fits) return
    allocate (columns(rows, min(total, int(block_columns, i8))), before(points%n))
    do s = 1, points%n
      before(s) = place
      place = place + points%last(s) - points%first(s) + 1
    end do
    first = 0_i8
    last = 0_i8                            ! columns holds the points first + 1 to last
    do w = 1, field%work%n
      k = key_k(field%work%key(w))
      if (k < held(1) .or. k > held(2)) cycle
      s = interval_around(points, field%work%key(w), field%work%first(w), field%work%last(w))
      if (s == 0) then
        fits = k < partition%own(1) .or. k > partition%own(2)  ! elsewhere nobody reads such points
        if (.not. fits) return
        cycle
      end if
      do i = field%work%first(w), field%work%last(w)
        place = before(s) + i - points%first(s) + 1
        if (place <= first .or. place > last) then
          first = place - 1
          last = min(total, first + size(columns, 2))
          call file%get(name//'/moments', columns(:, :int(last - first)), first)
        end if
        field%moment(field%neighbour(0, 0, w) + i, :) = columns(:, int(place - first))
      end do
    end do
  end subroutine get_field

  !> Interval that holds the points first to last of a row, 0 if none.
  pure function interval_around(rows, key, first, last) result(s)
    type(rows_t), intent(in) :: rows
    integer(i8), intent(in) :: key
    integer, intent(in) :: first, last
    integer :: s
    s = rows_contains(rows, key, first)
    if (s == 0) return
    if (rows%last(s) < last) s = 0
  end function interval_around

end module sgmp_restart
