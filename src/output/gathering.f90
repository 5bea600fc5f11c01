!> Gathers particle data for output, ordered by id, and sums over bodies.
module sgmp_gathering
  use sgmp_body, only: body_t
  use sgmp_checksum, only: checksum_add, checksum_particles
  use sgmp_errors, only: error_t
  use sgmp_history, only: bodies_columns
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_mesh, only: mesh_position
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass, motion_velocity
  use sgmp_parallel, only: parallel_deal, parallel_max, parallel_scan, parallel_sum
  use sgmp_scene, only: scene_t
  use sgmp_seeding, only: seeding_generate
  use sgmp_snapshot, only: snapshot_field_t, snapshot_t
  use sgmp_sorting, only: sort_order
  use sgmp_voigt, only: voigt_names
  implicit none
  private
  public :: gather_whole, gather_slice, gather_snapshot, gather_body_row, gather_checksum, &
            gather_initial_positions, gather_field_known, field_names

  character(16), parameter :: field_names(*) = &
    [character(16) :: 'stress', 'pressure', 'density', 'volume', 'mass', 'plastic_strain', &
     'temperature', 'damage', 'energy', 'von_mises', 'displacement', 'initial_position']

contains

  !> Whether a field of that name can be written.
  pure function gather_field_known(name) result(known)
    character(*), intent(in) :: name
    logical :: known
    known = any(field_names == name)
  end function gather_field_known

  !> A snapshot of all particles with the fields asked for; `initial` holds the initial positions by
  !! id.
  subroutine gather_snapshot(model, names, initial, snapshot)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(dp), allocatable, intent(in) :: initial(:, :)  !! (3, ids), where a field needs it
    type(snapshot_t), intent(out) :: snapshot
    integer, allocatable :: place(:)
    integer :: b, c, l, p, f, n, nd, visited
    n = sum(model%bodies%particles%count)
    nd = model%mesh%ndim
    snapshot%dimension = nd
    snapshot%step = model%clock%step
    snapshot%time = model%clock%time
    call order_of_ids(model, place)  ! first, while there is little else
    allocate (snapshot%id(n), snapshot%body(n), snapshot%position(3, n), snapshot%velocity(3, n))
    snapshot%position = 0.0_dp
    snapshot%velocity = 0.0_dp
    snapshot%body_names = model%bodies%name
    call declare_fields(model, names, n, snapshot%fields)
    visited = 0
    do b = 1, size(model%bodies)
      associate (body => model%bodies(b))
        do c = 1, body%particles%chunks
          do l = 1, lanes
            if (body%particles%id(l, c) == 0) cycle
            visited = visited + 1
            p = place(visited)
            snapshot%id(p) = body%particles%id(l, c)
            snapshot%body(p) = b
            snapshot%position(:nd, p) = mesh_position(model%mesh%origin(:nd), model%mesh%h, &
                                                      body%particles%motion(l, :nd, c))
            snapshot%velocity(:nd, p) = &
              body%particles%motion(l, motion_velocity(nd):motion_velocity(nd) + nd - 1, c)
            do f = 1, size(snapshot%fields)
              if (allocated(initial)) then
                call take_field(body, nd, l, c, initial(:, body%particles%id(l, c)), &
                                snapshot%position(:, p), snapshot%fields(f), p)
              else
                call take_field(body, nd, l, c, snapshot%position(:, p), snapshot%position(:, p), &
                                snapshot%fields(f), p)
              end if
            end do
          end do
        end do
      end associate
    end do
    if (allocated(initial) .and. any(names == 'initial_position')) then
      snapshot%initial_position = initial(:, snapshot%id)
    end if
  end subroutine gather_snapshot

  !> A snapshot on the first rank of all ranks' particles, or of those with certain ids; empty on
  !! the others. All ranks must call it.
  subroutine gather_whole(model, names, initial, snapshot, ids)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(dp), allocatable, intent(in) :: initial(:, :)
    type(snapshot_t), intent(out) :: snapshot
    integer, intent(in), optional :: ids(:)
    integer, allocatable :: chosen(:)
    integer :: p
    call gather_snapshot(model, names, initial, snapshot)
    if (model%ranks%partition%ranks == 1) return
    chosen = [(p, p=1, size(snapshot%id))]
    if (present(ids)) chosen = pack(chosen, [(any(snapshot%id(p) == ids), p=1, size(snapshot%id))])
    call deal_snapshot(snapshot, chosen, [(0, p=1, size(chosen))])
  end subroutine gather_whole

  !> A snapshot of particles dealt out by id: each rank gets a range of ids, behind the `before`
  !! particles of lower ranks. All ranks must call it.
  subroutine gather_slice(model, names, initial, snapshot, before, total)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(dp), allocatable, intent(in) :: initial(:, :)
    type(snapshot_t), intent(out) :: snapshot
    integer(i8), intent(out) :: before, total    !! total: of all ranks
    integer :: p, largest
    call gather_snapshot(model, names, initial, snapshot)
    if (model%ranks%partition%ranks > 1) then
      largest = nint(parallel_max(real(maxval([0, snapshot%id]), dp)))
      call deal_snapshot(snapshot, [(p, p=1, size(snapshot%id))], &
                         int((snapshot%id - 1_i8)*model%ranks%partition%ranks/max(1, largest)))
    end if
    before = parallel_scan(size(snapshot%id, kind=i8))
    total = parallel_sum(size(snapshot%id, kind=i8))
  end subroutine gather_slice

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
    call sort_order(nint(received(1, :), i8), order)
    received = received(:, order)
    call snapshot_fill(snapshot, received)
  end subroutine deal_snapshot

  !> All values of a snapshot, a column for each particle.
  pure subroutine snapshot_columns(snapshot, columns)
    type(snapshot_t), intent(in) :: snapshot
    real(dp), allocatable, intent(out) :: columns(:, :)
    integer :: f, q, n
    n = 8
    if (allocated(snapshot%initial_position)) n = n + 3
    n = n + sum([(size(snapshot%fields(f)%values, 1), f=1, size(snapshot%fields))])
    allocate (columns(n, size(snapshot%id)))
    columns(1, :) = snapshot%id
    columns(2, :) = snapshot%body
    columns(3:5, :) = snapshot%position
    columns(6:8, :) = snapshot%velocity
    q = 8
    if (allocated(snapshot%initial_position)) then
      columns(9:11, :) = snapshot%initial_position
      q = 11
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
    if (allocated(snapshot%initial_position)) then
      snapshot%initial_position = columns(9:11, :)
      q = 11
    end if
    do f = 1, size(snapshot%fields)
      n = size(snapshot%fields(f)%values, 1)
      snapshot%fields(f)%values = columns(q + 1:q + n, :)
      q = q + n
    end do
  end subroutine snapshot_fill

  !> Place in the output of each of the rank's particles, in the order of their chunks: ids
  !! ascending.
  pure subroutine order_of_ids(model, place)
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: place(:)
    integer(i8), allocatable :: ids(:)
    integer, allocatable :: order(:)
    integer :: b, c, l, n
    n = sum(model%bodies%particles%count)
    allocate (ids(n), order(n), place(n))
    n = 0
    do b = 1, size(model%bodies)
      do c = 1, model%bodies(b)%particles%chunks
        do l = 1, lanes
          if (model%bodies(b)%particles%id(l, c) == 0) cycle
          n = n + 1
          ids(n) = model%bodies(b)%particles%id(l, c)
        end do
      end do
    end do
    call sort_order(ids, order)
    do n = 1, size(order)
      place(order(n)) = n
    end do
  end subroutine order_of_ids

  !> Names and components of the fields.
  subroutine declare_fields(model, names, n, fields)
    type(model_t), intent(in) :: model
    character(*), intent(in) :: names(:)
    integer, intent(in) :: n
    type(snapshot_field_t), allocatable, intent(out) :: fields(:)
    integer :: f, c, count, wanted
    count = 0
    do f = 1, size(names)
      if (names(f) /= 'initial_position' .and. names(f) /= '') count = count + 1
    end do
    allocate (fields(count))
    count = 0
    do wanted = 1, size(names)
      if (names(wanted) == 'initial_position' .or. names(wanted) == '') cycle
      count = count + 1
      f = count
      fields(f)%name = names(wanted)
      select case (names(wanted))
      case ('stress')
        c = 3 + merge(3, model%mesh%ndim - 1, model%mesh%ndim == 3)
        fields(f)%components = 'stress_'//voigt_names(:c)
      case ('displacement')
        fields(f)%components = [character(32) :: 'displacement_x', 'displacement_y', &
                                'displacement_z']
      case default
        fields(f)%components = names(wanted:wanted)
      end select
      allocate (fields(f)%values(size(fields(f)%components), n), source=0.0_dp)
    end do
  end subroutine declare_fields

  !> One field of one particle.
  subroutine take_field(body, nd, l, c, initial, position, field, p)
    type(body_t), intent(in) :: body
    integer, intent(in) :: nd, l, c, p
    real(dp), intent(in) :: initial(3), position(3)
    type(snapshot_field_t), intent(inout) :: field
    real(dp) :: stress(size(voigt_names))
    integer :: column
    stress = particle_stress(body, l, c)
    column = 0
    select case (field%name)
    case ('stress')
      field%values(:, p) = stress(:size(field%values, 1))
    case ('pressure')
      field%values(1, p) = -sum(stress(:3))/3.0_dp
    case ('von_mises')
      field%values(1, p) = sqrt(0.5_dp*((stress(1) - stress(2))**2 + (stress(2) - stress(3))**2 + &
                                        (stress(3) - stress(1))**2) + 3.0_dp*sum(stress(4:)**2))
    case ('density')
      field%values(1, p) = body%particles%motion(l, motion_mass(nd), c)/ &
                           body%particles%state(l, body%law%slots%volume, c)
    case ('mass')
      field%values(1, p) = body%particles%motion(l, motion_mass(nd), c)
    case ('displacement')
      field%values(:, p) = position - initial
    case ('volume')
      column = 1
    case ('plastic_strain')
      column = body%law%slots%plastic
    case ('temperature')
      column = body%law%slots%temperature
    case ('damage')
      column = body%law%slots%damage
    case ('energy')
      column = body%law%slots%energy
    case default  ! the rest has been filled in by gather_snapshot
      column = 0
    end select
    if (column > 0) field%values(1, p) = body%particles%state(l, column, c)
  end subroutine take_field

  !> Stress of a particle, xx yy zz xy yz xz.
  pure function particle_stress(body, l, c) result(stress)
    type(body_t), intent(in) :: body
    integer, intent(in) :: l, c
    real(dp) :: stress(size(voigt_names))
    integer :: s, n
    stress = 0.0_dp
    s = body%law%slots%stress
    n = body%law%slots%stresses
    if (n == 1) then
      stress(:3) = body%particles%state(l, s, c)
    else
      stress(:n) = body%particles%state(l, s:s + n - 1, c)
    end if
  end function particle_stress

  !> Row of bodies.csv: time, body, mass, centroid, velocity, kinetic and internal energy,
  !! particles.
  pure function gather_body_row(model, b) result(row)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: row(size(bodies_columns))
    real(dp) :: centroid(3)
    associate (sums => model%totals%bodies(b))
      centroid = mesh_position(model%mesh%origin, model%mesh%h, sums%moment/sums%mass)
      centroid(model%mesh%ndim + 1:) = 0.0_dp
      row = [model%clock%time, real(b, dp), sums%mass, centroid, sums%momentum/sums%mass, &
             sums%kinetic, sums%internal, real(model%totals%particles(b), dp)]
    end associate
  end function gather_body_row

  !> Checksum of the whole particle state, independent of order and layout.
  function gather_checksum(model) result(checksum)
    type(model_t), intent(in) :: model
    integer(i8) :: checksum
    integer :: b, c, l, n
    integer(i4) :: ids(lanes)
    real(dp), allocatable :: values(:, :)
    checksum = 0_i8
    do b = 1, size(model%bodies)
      associate (particles => model%bodies(b)%particles)
        allocate (values(particles%motion_columns + particles%state_columns, lanes))
        do c = 1, particles%chunks
          n = 0
          do l = 1, lanes
            if (particles%id(l, c) == 0) cycle
            n = n + 1
            ids(n) = particles%id(l, c)
            values(:particles%motion_columns, n) = particles%motion(l, :, c)
            values(particles%motion_columns + 1:, n) = particles%state(l, :, c)
          end do
          checksum = checksum_add(checksum, checksum_particles(ids(:n), values(:, :n)))
        end do
        deallocate (values)
      end associate
    end do
    checksum = parallel_sum(checksum)
  end function gather_checksum

  !> Initial positions by id, by seeding once more: nothing is stored during the run.
  subroutine gather_initial_positions(scene, model, initial, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(out) :: initial(:, :)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: x(:, :), volume(:), grown(:, :)
    integer :: b, n
    allocate (initial(3, 0))
    do b = 1, size(scene%bodies)
      call seeding_generate(scene%bodies(b), scene%grid%cell, model%mesh%origin, model%mesh%ndim, &
                            x, volume, error)
      if (allocated(error)) return
      n = size(initial, 2)
      allocate (grown(3, n + size(x, 2)))
      grown(:, :n) = initial
      grown(:, n + 1:) = x
      call move_alloc(grown, initial)
    end do
  end subroutine gather_initial_positions

end module sgmp_gathering
