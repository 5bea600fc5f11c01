!> Snapshots: the particles of the model, ordered by id, on one rank or dealt out to all.
module sgmp_snapshot_make
  use sgmp_body, only: body_given_id, body_t
  use sgmp_errors, only: error_t
  use sgmp_graded_axis, only: graded_place
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_mesh, only: mesh_places
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_velocity
  use sgmp_parallel, only: parallel_deal, parallel_max, parallel_scan, parallel_sum
  use sgmp_particle_fields, only: most_components, particle_field_components, &
                                  particle_field_find, particle_field_t, particle_field_values, &
                                  particle_place_t
  use sgmp_scene, only: scene_t
  use sgmp_seeding, only: seeding_generate
  use sgmp_snapshot, only: snapshot_field_t, snapshot_t
  use sgmp_sorting, only: sort_order, sort_order_within
  use sgmp_space, only: axes_in_output
  use sgmp_voigt, only: stress_components
  implicit none
  private
  public :: snapshot_own, snapshot_some, snapshot_position, snapshot_gather, snapshot_give_ids, &
            snapshot_whole, snapshot_slice, snapshot_initial_positions

contains

  !> A snapshot of this rank's particles with the fields asked for; `initial` holds the initial
  !! positions by id.
  subroutine snapshot_own(model, names, initial, snapshot)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(dp), allocatable, intent(in) :: initial(:, :)  !! (3, ids), where a field needs it
    type(snapshot_t), intent(out) :: snapshot
    type(particle_field_t), allocatable :: kinds(:)
    integer, allocatable :: place(:), before(:)
    integer :: b, c, l, p
    call order_of_ids(model, place)  ! first, while there is little else
    call prepare(model, names, size(place), kinds, snapshot)
    do b = 1, size(model%bodies)
      call count_before(model%bodies, b, before)
      !$omp parallel do default(none) shared(model, kinds, initial, place, before, b, snapshot) &
      !$omp   private(l, p)
      do c = 1, model%bodies(b)%particles%chunks
        p = before(c)
        do l = 1, lanes
          if (model%bodies(b)%particles%id(l, c) == 0) cycle
          p = p + 1
          call take_particle(model, kinds, initial, [b, l, c], place(p), snapshot)
        end do
      end do
      !$omp end parallel do
    end do
    if (.not. (allocated(initial) .and. any(names == 'initial_position'))) return
    allocate (snapshot%initial_position(3, size(place)))
    !$omp parallel do schedule(static) default(none) shared(snapshot, initial)
    do p = 1, size(snapshot%id)
      snapshot%initial_position(:, p) = initial(:, snapshot%id(p))
    end do
    !$omp end parallel do
  end subroutine snapshot_own

  !> The same of some of them, each named by body, lane and chunk.
  subroutine snapshot_some(model, names, initial, where_, snapshot)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(dp), allocatable, intent(in) :: initial(:, :)
    integer, intent(in) :: where_(:, :)                 !! (3, n)
    type(snapshot_t), intent(out) :: snapshot
    type(particle_field_t), allocatable :: kinds(:)
    integer(i8) :: ids(size(where_, 2)), paths(size(where_, 2))
    integer :: order(size(where_, 2)), p
    do p = 1, size(ids)
      associate (body => model%bodies(where_(1, p)), l => where_(2, p), c => where_(3, p))
        ids(p) = body%particles%id(l, c)
        paths(p) = nint(path_of(body, l, c), i8)
      end associate
    end do
    call sort_order_within(ids, paths, order)
    call prepare(model, names, size(ids), kinds, snapshot)
    do p = 1, size(order)
      call take_particle(model, kinds, initial, where_(:, order(p)), p, snapshot)
    end do
    if (allocated(initial) .and. any(names == 'initial_position')) then
      snapshot%initial_position = initial(:, snapshot%id)
    end if
  end subroutine snapshot_some

  !> Makes room for n particles.
  subroutine prepare(model, names, n, kinds, snapshot)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    integer, intent(in) :: n
    type(particle_field_t), allocatable, intent(out) :: kinds(:)
    type(snapshot_t), intent(inout) :: snapshot
    snapshot%dimension = maxval(axes_in_output(:model%mesh%ndim, model%mesh%space))
    snapshot%step = model%clock%step
    snapshot%time = model%clock%time
    if (any(model%bodies%particles%path > 0)) allocate (snapshot%path(n))
    allocate (snapshot%id(n), snapshot%body(n), snapshot%position(3, n), snapshot%velocity(3, n))
    snapshot%body_names = pack(model%bodies%name, model%bodies%twin_of == 0)
    call declare_fields(names, model%mesh%space, &
                        stress_components(merge(3, model%mesh%ndim, model%method%swirl)), n, &
                        kinds, snapshot%fields)
  end subroutine prepare

  !> Position of a particle, along the axes of the output; unused ones are 0.
  pure function snapshot_position(model, where_) result(position)
    type(model_t), intent(in) :: model
    integer, intent(in) :: where_(3)                   !! body, lane, chunk
    real(dp) :: position(3)
    integer :: axes(3), nd
    nd = model%mesh%ndim
    axes = axes_in_output(:, model%mesh%space)
    position = 0.0_dp
    position(axes(:nd)) = mesh_places(model%mesh, model%bodies( &
                                      where_(1))%particles%motion(where_(2), :nd, where_(3)))
  end function snapshot_position

  !> Everything of one particle, to its place in a snapshot.
  pure subroutine take_particle(model, kinds, initial, where_, p, snapshot)
    type(model_t), intent(in) :: model
    type(particle_field_t), intent(in) :: kinds(:)
    real(dp), allocatable, intent(in) :: initial(:, :)
    integer, intent(in) :: where_(3)                   !! body, lane, chunk
    integer, intent(in) :: p
    type(snapshot_t), intent(inout) :: snapshot
    type(particle_place_t) :: at
    real(dp) :: values(most_components)
    integer :: axes(3), f, nd, v
    nd = model%mesh%ndim
    axes = axes_in_output(:, model%mesh%space)
    associate (body => model%bodies(where_(1)), l => where_(2), c => where_(3))
      snapshot%id(p) = body%particles%id(l, c)
      snapshot%body(p) = merge(body%twin_of, where_(1), body%twin_of > 0)
      if (allocated(snapshot%path)) snapshot%path(p) = path_of(body, l, c)
      v = motion_velocity(nd)
      snapshot%position(:, p) = snapshot_position(model, where_)
      snapshot%velocity(:, p) = 0.0_dp
      snapshot%velocity(axes(:nd), p) = body%particles%motion(l, v:v + nd - 1, c)
      if (model%method%swirl) snapshot%velocity(2, p) = &
        body%particles%state(l, body%law%slots%swirl, c)/ &
        graded_place(model%mesh%axes(1), body%particles%motion(l, 1, c))
      at%ndim = nd
      at%lane = l
      at%chunk = c
      at%position = snapshot%position(:, p)
      if (allocated(initial)) at%initial = initial(:, snapshot%id(p))
      do f = 1, size(kinds)
        values = particle_field_values(kinds(f), body, at)
        snapshot%fields(f)%values(:, p) = values(:size(snapshot%fields(f)%values, 1))
      end do
    end associate
  end subroutine take_particle

  !> Particles of a body and the bodies before it in the chunks before each.
  pure subroutine count_before(bodies, number, before)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: number
    integer, allocatable, intent(out) :: before(:)
    integer :: c, n
    n = sum(bodies(:number - 1)%particles%count)
    allocate (before(bodies(number)%particles%chunks))
    do c = 1, size(before)
      before(c) = n
      n = n + count(bodies(number)%particles%id(:, c) /= 0)
    end do
  end subroutine count_before

  !> A snapshot on the first rank of all ranks' particles; empty on the others. All ranks must call
  !! it.
  subroutine snapshot_whole(model, names, initial, snapshot)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(dp), allocatable, intent(in) :: initial(:, :)
    type(snapshot_t), intent(out) :: snapshot
    integer :: p
    call snapshot_own(model, names, initial, snapshot)
    if (model%ranks%partition%ranks == 1) return
    call snapshot_gather(snapshot, [(.true., p=1, size(snapshot%id))])
  end subroutine snapshot_whole

  !> Gathers chosen particles of the snapshots of all ranks on the first one; the others' become
  !! empty. All ranks must call it.
  subroutine snapshot_gather(snapshot, chosen)
    type(snapshot_t), intent(inout) :: snapshot
    logical, intent(in) :: chosen(:)
    integer :: p
    call deal_snapshot(snapshot, pack([(p, p=1, size(chosen))], chosen), &
                       [(0, p=1, count(chosen))])
  end subroutine snapshot_gather

  !> A snapshot of particles dealt out by id: each rank gets a range of ids, behind the `before`
  !! particles of lower ranks. All ranks must call it.
  subroutine snapshot_slice(model, names, initial, snapshot, before, total)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(dp), allocatable, intent(in) :: initial(:, :)
    type(snapshot_t), intent(out) :: snapshot
    integer(i8), intent(out) :: before, total    !! total: of all ranks
    integer :: p, largest
    call snapshot_own(model, names, initial, snapshot)
    if (model%ranks%partition%ranks > 1) then
      largest = nint(parallel_max(real(maxval([0, snapshot%id]), dp)))
      call deal_snapshot(snapshot, [(p, p=1, size(snapshot%id))], &
                         int((snapshot%id - 1_i8)*model%ranks%partition%ranks/max(1, largest)))
    end if
    before = parallel_scan(size(snapshot%id, kind=i8))
    total = parallel_sum(size(snapshot%id, kind=i8))
  end subroutine snapshot_slice

  !> Gives particles the ids by which the user knows them, in the same order.
  subroutine snapshot_give_ids(bodies, snapshot)
    type(body_t), intent(in) :: bodies(:)
    type(snapshot_t), intent(inout) :: snapshot
    integer :: p
    !$omp parallel do schedule(static) default(none) shared(bodies, snapshot)
    do p = 1, size(snapshot%id)
      snapshot%id(p) = body_given_id(bodies(snapshot%body(p)), snapshot%id(p))
    end do
    !$omp end parallel do
  end subroutine snapshot_give_ids

  !> Sends particles of a snapshot to other ranks; what arrives is ordered by id.
  subroutine deal_snapshot(snapshot, chosen, destination)
    type(snapshot_t), intent(inout) :: snapshot
    integer, intent(in) :: chosen(:)             !! which particles
    integer, intent(in) :: destination(:)        !! (chosen) rank, from 0
    real(dp), allocatable :: columns(:, :), received(:, :)
    integer, allocatable :: order(:)
    call snapshot_columns(snapshot, columns)
    columns = columns(:, chosen)
    call parallel_deal(columns, destination, received)
    allocate (order(size(received, 2)))
    if (allocated(snapshot%path)) then
      call sort_order_within(nint(received(1, :), i8), nint(received(9, :), i8), order)
    else
      call sort_order(nint(received(1, :), i8), order)
    end if
    received = received(:, order)
    call snapshot_fill(snapshot, received)
  end subroutine deal_snapshot

  !> All values of a snapshot, a column for each particle.
  pure subroutine snapshot_columns(snapshot, columns)
    type(snapshot_t), intent(in) :: snapshot
    real(dp), allocatable, intent(out) :: columns(:, :)
    integer :: f, q, n
    n = 8
    if (allocated(snapshot%path)) n = n + 1
    if (allocated(snapshot%initial_position)) n = n + 3
    n = n + sum([(size(snapshot%fields(f)%values, 1), f=1, size(snapshot%fields))])
    allocate (columns(n, size(snapshot%id)))
    columns(1, :) = snapshot%id
    columns(2, :) = snapshot%body
    columns(3:5, :) = snapshot%position
    columns(6:8, :) = snapshot%velocity
    q = 8
    if (allocated(snapshot%path)) then
      columns(9, :) = snapshot%path
      q = 9
    end if
    if (allocated(snapshot%initial_position)) then
      columns(q + 1:q + 3, :) = snapshot%initial_position
      q = q + 3
    end if
    do f = 1, size(snapshot%fields)
      n = size(snapshot%fields(f)%values, 1)
      columns(q + 1:q + n, :) = snapshot%fields(f)%values
      q = q + n
    end do
  end subroutine snapshot_columns

  !> Gives a snapshot the particles of such columns.
  pure subroutine snapshot_fill(snapshot, columns)
    type(snapshot_t), intent(inout) :: snapshot
    real(dp), intent(in) :: columns(:, :)
    integer :: f, q, n
    snapshot%id = nint(columns(1, :))
    snapshot%body = nint(columns(2, :))
    snapshot%position = columns(3:5, :)
    snapshot%velocity = columns(6:8, :)
    q = 8
    if (allocated(snapshot%path)) then
      snapshot%path = columns(9, :)
      q = 9
    end if
    if (allocated(snapshot%initial_position)) then
      snapshot%initial_position = columns(q + 1:q + 3, :)
      q = q + 3
    end if
    do f = 1, size(snapshot%fields)
      n = size(snapshot%fields(f)%values, 1)
      snapshot%fields(f)%values = columns(q + 1:q + n, :)
      q = q + n
    end do
  end subroutine snapshot_fill

  !> Path of a particle from the one that was split; 1 where none is.
  pure real(dp) function path_of(body, lane, chunk) result(path)
    type(body_t), intent(in) :: body
    integer, intent(in) :: lane, chunk
    path = 1.0_dp
    if (body%particles%path > 0) path = body%particles%state(lane, body%particles%path, chunk)
  end function path_of

  !> Place in the output of each of the rank's particles, in the order of their chunks: ids
  !! ascending, in each of them the paths.
  subroutine order_of_ids(model, place)
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: place(:)
    integer(i8), allocatable :: ids(:), paths(:)
    integer, allocatable :: order(:)
    integer :: n
    call list_ids(model, ids, paths)
    n = size(ids)
    allocate (place(n))
    if (allocated(paths)) then
      allocate (order(n))
      call sort_order_within(ids, paths, order)
      place(order) = [(n, n=1, size(order))]
    else if (n > 0) then
      call rank_of_ids(ids, place)
    end if
  end subroutine order_of_ids

  !> Ids, and paths where particles are split, in the order of the chunks.
  subroutine list_ids(model, ids, paths)
    type(model_t), intent(in) :: model
    integer(i8), allocatable, intent(out) :: ids(:), paths(:)
    integer, allocatable :: before(:)
    integer :: b, c, l, n
    n = sum(model%bodies%particles%count)
    allocate (ids(n))
    if (any(model%bodies%particles%path > 0)) allocate (paths(n))
    do b = 1, size(model%bodies)
      call count_before(model%bodies, b, before)
      !$omp parallel do default(none) shared(model, ids, paths, before, b) private(l, n)
      do c = 1, model%bodies(b)%particles%chunks
        n = before(c)
        do l = 1, lanes
          if (model%bodies(b)%particles%id(l, c) == 0) cycle
          n = n + 1
          ids(n) = model%bodies(b)%particles%id(l, c)
          if (allocated(paths)) paths(n) = nint(path_of(model%bodies(b), l, c), i8)
        end do
      end do
      !$omp end parallel do
    end do
  end subroutine list_ids

  !> Place of each of some different ids among them: by counting where they lie close, by sorting
  !! where not. Where none is missing an id is its own place.
  subroutine rank_of_ids(ids, place)
    integer(i8), intent(in) :: ids(:)
    integer, intent(out) :: place(:)   !! (size(ids))
    integer, parameter :: thin = 8     !! ids per particle from which sorting takes less
    integer, allocatable :: number(:)
    integer(i8) :: least, most
    integer :: n, i, width
    least = huge(least)
    most = -huge(most)
    !$omp parallel do schedule(static) default(none) shared(ids) reduction(min: least) &
    !$omp& reduction(max: most)
    do n = 1, size(ids)
      least = min(least, ids(n))
      most = max(most, ids(n))
    end do
    !$omp end parallel do
    if (most - least == size(ids, kind=i8) - 1) then
      !$omp parallel do schedule(static) default(none) shared(ids, place, least)
      do n = 1, size(ids)
        place(n) = int(ids(n) - least) + 1
      end do
      !$omp end parallel do
      return
    end if
    if (most - least > thin*size(ids, kind=i8)) then
      allocate (number(size(ids)))
      call sort_order(ids, number)
      place(number) = [(n, n=1, size(ids))]
      return
    end if
    width = int(most - least) + 1
    allocate (number(width), source=0)
    do n = 1, size(ids)
      number(ids(n) - least + 1) = 1
    end do
    do i = 2, width
      number(i) = number(i) + number(i - 1)
    end do
    do n = 1, size(ids)
      place(n) = number(ids(n) - least + 1)
    end do
  end subroutine rank_of_ids

  !> Makes room for the fields asked for; initial positions have a place of their own.
  subroutine declare_fields(names, space, stresses, n, kinds, fields)
    character(*), intent(in) :: names(:)
    integer, intent(in) :: space, stresses, n    !! stresses: components of a tensor
    type(particle_field_t), allocatable, intent(out) :: kinds(:)
    type(snapshot_field_t), allocatable, intent(out) :: fields(:)
    integer :: f
    kinds = [(particle_field_find(names(f)), f=1, size(names))]
    kinds = pack(kinds, names /= 'initial_position')
    allocate (fields(size(kinds)))
    do f = 1, size(fields)
      fields(f)%name = kinds(f)%name
      fields(f)%components = particle_field_components(kinds(f), space, stresses)
      allocate (fields(f)%values(size(fields(f)%components), n))
    end do
  end subroutine declare_fields

  !> Initial positions by id, by seeding once more: nothing is stored during the run.
  subroutine snapshot_initial_positions(scene, model, initial, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(out) :: initial(:, :)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: x(:, :), volume(:)
    integer :: b
    allocate (initial(3, 0))
    do b = 1, size(scene%bodies)
      call seeding_generate(scene%bodies(b), scene%grid%cell, model%mesh%origin, model%mesh%ndim, &
                            x, volume, error)
      if (allocated(error)) return
      initial = reshape([initial, x(axes_in_output(:, model%mesh%space), :)], &
                        [3, size(initial, 2) + size(x, 2)])
    end do
  end subroutine snapshot_initial_positions

end module sgmp_snapshot_make
