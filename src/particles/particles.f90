!> The particles of one body: chunks of `lanes` particles, binned by the cell of their stencil.
!!
!! A bin holds the particles of one cell, or of some cells that follow each other along a row
!! (`bin_span`), ordered by id (where particles are split, in each id by the path from the particle
!! that they come from), in a chain of chunks; those of a cell share a grid stencil. The unused
!! lanes of a bin's last chunk hold a harmless pad. Two streams keep the two sweeps of a step
!! apart: `motion` (position, velocity, mass) is all that a momentum sweep touches,
!! `state` (volume, stress, history) is read only where stress is updated.
module sgmp_particles
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_large_pages, only: large_pages_ask
  use sgmp_motion, only: motion_mass, motion_total, motion_velocity
  use sgmp_prefetch, only: prefetch
  use sgmp_rows, only: row_key, rows_contains, rows_from_points, rows_t, rows_union
  use sgmp_slabs, only: far_plane
  use sgmp_sorting, only: sort_order
  implicit none
  private
  public :: particles_t, particles_fill, particles_bytes, particles_bin_of, &
    particles_lay_out, particles_number_bins, particles_pad, particles_cells, &
    bin_coordinates, bin_of_cell, bins_of_cells, &
    first_cell, particles_seat
  public :: chunks_take, chunks_make_room, chunks_give_back, chunk_pad, chunk_prefetch

  integer, parameter :: many_chunks = 2**14         !! 15 MB

  !> Chunks and bins of a body.
  type :: particles_t
    integer :: ndim = 3
    integer :: motion_columns = 7                   !! see sgmp_motion
    integer :: state_columns = 7                    !! volume, stress, history
    integer :: path = 0                             !! column of the path, where particles are split
    integer :: reference = 0                        !! first column of the place by which particles
                                                    !! are in bins, where that is the first one
    integer :: count = 0                            !! live particles
    integer :: chunks = 0                           !! chunks in use or spare
    integer :: spares = 0
    logical :: scattered = .false.  !! chunks no longer lie in the order of their bins, and caches
                                    !! do not hold them all
    real(dp) :: shift = 0.5_dp                      !! cell of X is floor(X - shift)
    integer :: span = 1                             !! cells of a bin, along its row
    integer :: own(2) = [-far_plane, far_plane]     !! planes whose particles are held here
    integer :: held(2) = [-far_plane, far_plane]
      !! planes with bins; those outside `own` stand for other ranks' and are empty
    real(dp), allocatable :: motion(:, :, :)        !! (lanes, motion_columns, chunk), in cells from
                                                    !! the grid origin
    real(dp), allocatable :: state(:, :, :)         !! (lanes, state_columns, chunk)
    integer(i4), allocatable :: id(:, :)            !! (lanes, chunk); 0 in pads
    integer, allocatable :: next(:)                 !! chunk that continues the bin, 0: none
    integer, allocatable :: spare(:)                !! (spares) chunks that no bin uses
    real(dp), allocatable :: pad(:)                 !! (state_columns) harmless values in pads
    real(dp) :: pad_mass = 1.0_dp
    type(rows_t) :: bins                            !! rows of bins
    integer, allocatable :: bin_start(:)  !! (bins%n): bin i of a row has number bin_start + i
    integer, allocatable :: first(:)                !! (bins) first chunk, 0: empty
    integer, allocatable :: size(:)                 !! (bins) particles
    integer, allocatable :: plane_row(:)  !! (planes + 1) first interval of each plane of the field
    integer, allocatable :: place(:, :)             !! (rows of a stencil, bins%n) base of the
                                                    !! stencil's rows in the field
  end type particles_t

contains

  !> Where a particle is in its bin: its position, or the first one.
  pure function particles_seat(particles, l, c) result(x)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: l, c                     !! lane, chunk
    real(dp) :: x(particles%ndim)
    if (particles%reference > 0) then
      x = particles%state(l, particles%reference:particles%reference + particles%ndim - 1, c)
    else
      x = particles%motion(l, :particles%ndim, c)
    end if
  end function particles_seat

  !> Bin coordinates (i, j, k) of a position: in 2D the y axis is k.
  pure function bin_coordinates(particles, x) result(bin)
    type(particles_t), intent(in) :: particles
    real(dp), intent(in) :: x(:)          !! (>= ndim) grid coordinates
    integer :: bin(3)
    bin = 0
    bin(1) = bin_of_cell(particles%span, floor(x(1) - particles%shift))
    if (particles%ndim == 2) bin(3) = floor(x(2) - particles%shift)
    if (particles%ndim == 3) bin(2:3) = floor(x(2:3) - particles%shift)
  end function bin_coordinates

  !> Place of a cell's bin in the row.
  elemental function bin_of_cell(span, cell) result(bin)
    integer, intent(in) :: span, cell
    integer :: bin
    bin = (cell - first_cell(span, 0) - modulo(cell - first_cell(span, 0), span))/span
  end function bin_of_cell

  !> First cell of a bin. Bins of several cells begin where the cells of a grid with a wall at 0 do.
  elemental function first_cell(span, bin) result(cell)
    integer, intent(in) :: span, bin
    integer :: cell
    cell = span*bin - merge(1, 0, span > 1)
  end function first_cell

  !> The bins that some cells lie in, as rows.
  pure subroutine bins_of_cells(span, cells, bins)
    integer, intent(in) :: span
    type(rows_t), intent(in) :: cells
    type(rows_t), intent(out) :: bins
    type(rows_t) :: some
    integer :: n
    some = cells
    n = some%n
    some%first(:n) = bin_of_cell(span, some%first(:n))
    some%last(:n) = bin_of_cell(span, some%last(:n))
    call rows_union(some, some, bins)  ! joins those that now touch
  end subroutine bins_of_cells

  !> The cells of all bins.
  pure subroutine particles_cells(particles, cells)
    type(particles_t), intent(in) :: particles
    type(rows_t), intent(out) :: cells
    cells = particles%bins
    associate (n => cells%n)
      cells%first(:n) = first_cell(particles%span, cells%first(:n))
      cells%last(:n) = first_cell(particles%span, cells%last(:n) + 1) - 1
    end associate
  end subroutine particles_cells

  !> Number of the bin with given coordinates, 0 if it does not exist.
  pure function particles_bin_of(particles, bin) result(number)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin(3)
    integer :: number, s
    s = rows_contains(particles%bins, row_key(bin(2), bin(3)), bin(1))
    number = 0
    if (s > 0) number = particles%bin_start(s) + bin(1)
  end function particles_bin_of

  !> Bytes that the particles of a body have written.
  pure function particles_bytes(particles) result(bytes)
    type(particles_t), intent(in) :: particles
    integer(i8) :: bytes
    bytes = particles%chunks*(8_i8*lanes*(particles%motion_columns + particles%state_columns) &
                              + 4_i8*(lanes + 1)) &
            + 4_i8*(size(particles%first, kind=i8) + size(particles%size, kind=i8))
  end function particles_bytes

  !> Puts particles at rest into bins; `history` gives the first values of the columns of `state`
  !! behind the volume. The positions are given up on the way, so that both streams and they are
  !! never held at the same time.
  subroutine particles_fill(particles, ndim, shift, x, density, volume, history, first_id, ids, &
                            span)
    type(particles_t), intent(out) :: particles
    integer, intent(in) :: ndim
    real(dp), intent(in) :: shift
    real(dp), allocatable, intent(inout) :: x(:, :)  !! (>= ndim, n) grid coordinates, used up
    real(dp), intent(in) :: density                 !! mass per volume
    real(dp), intent(in) :: volume(:)               !! (n)
    real(dp), intent(in) :: history(:)              !! (state_columns - 1)
    integer(i4), intent(in) :: first_id             !! id of the first particle
    integer(i4), intent(in), optional :: ids(:)     !! (n) ascending places in the body, from 1,
                                                    !! where they are not consecutive
    integer, intent(in), optional :: span           !! cells of a bin; absent: one
    integer, allocatable :: order(:), slot(:)
    integer :: p, l, c
    particles%ndim = ndim
    particles%motion_columns = motion_total(ndim)
    particles%state_columns = 1 + size(history)
    particles%count = size(volume)
    particles%shift = shift
    if (present(span)) particles%span = span
    particles%pad = [1.0_dp, history]
    particles%pad_mass = density
    allocate (order(particles%count), slot(particles%count))
    call order_by_bin(particles, x, order)
    call count_bins(particles, x, order)
    particles%chunks = sum((particles%size + lanes - 1)/lanes)
    call allocate_chunks(particles)
    call chain_bins(particles, slot)
    !$omp parallel do schedule(static) default(none) private(l, c) &
    !$omp& shared(particles, slot, order, x, volume, ndim, density, first_id, ids)
    do p = 1, particles%count
      l = mod(slot(p) - 1, lanes) + 1
      c = (slot(p) - 1)/lanes + 1
      particles%id(l, c) = first_id + order(p) - 1
      if (present(ids)) particles%id(l, c) = first_id + ids(order(p)) - 1
      particles%motion(l, 1:ndim, c) = x(1:ndim, order(p))
      particles%motion(l, motion_mass(ndim), c) = density*volume(order(p))
    end do
    !$omp end parallel do
    deallocate (x, order, slot)
    !$omp parallel do schedule(static) default(none) &
    !$omp& shared(particles, density, history) private(c, p)
    do c = 1, particles%chunks
      particles%state(:, 1, c) = particles%motion(:, motion_mass(particles%ndim), c)/density
      do p = 2, particles%state_columns
        particles%state(:, p, c) = history(p - 1)
      end do
    end do
    !$omp end parallel do
    call particles_pad(particles)
  end subroutine particles_fill

  !> Room for the chunks of a body and half as many: as they fill unevenly where particles change
  !! bins at random, that is as many as there ever will be. What is not written takes no memory;
  !! the threads write first what they will later work on, so that it lies near them; `state` is
  !! left to the caller, who may hold much else until then.
  subroutine allocate_chunks(particles)
    type(particles_t), intent(inout) :: particles
    integer :: capacity, c
    capacity = particles%chunks + particles%chunks/2 + 16
    allocate (particles%id(lanes, capacity), particles%next(capacity))
    allocate (particles%motion(lanes, particles%motion_columns, capacity))
    allocate (particles%state(lanes, particles%state_columns, capacity))
    call large_pages_ask(particles%motion, size(particles%motion, kind=i8))
    call large_pages_ask(particles%state, size(particles%state, kind=i8))
    !$omp parallel do schedule(static) default(none) shared(particles) private(c)
    do c = 1, particles%chunks
      particles%id(:, c) = 0
      particles%next(c) = 0
      particles%motion(:, :, c) = 0.0_dp
      particles%motion(:, motion_mass(particles%ndim), c) = particles%pad_mass
    end do
    !$omp end parallel do
  end subroutine allocate_chunks

  !> Makes room for particles that are already known by bin: bins, chunks and lanes, whose contents
  !! the caller fills in and ends with `particles_pad`. Columns and pads stay as they are.
  subroutine particles_lay_out(particles, bins, sizes, slot)
    type(particles_t), intent(inout) :: particles
    type(rows_t), intent(in) :: bins
    integer, intent(in) :: sizes(:)                 !! (bins) particles of each
    integer, allocatable, intent(out) :: slot(:)  !! lane + lanes*(chunk - 1), in the bins' order
    integer :: c
    particles%bins = bins
    call particles_number_bins(particles)
    particles%size = sizes
    particles%count = sum(sizes)
    particles%chunks = sum((sizes + lanes - 1)/lanes)
    particles%spares = 0
    deallocate (particles%motion, particles%state, particles%id, particles%next)
    call allocate_chunks(particles)
    !$omp parallel do schedule(static) default(none) shared(particles) private(c)
    do c = 1, particles%chunks
      particles%state(:, :, c) = 0.0_dp
    end do
    !$omp end parallel do
    allocate (slot(particles%count))
    call chain_bins(particles, slot)
  end subroutine particles_lay_out

  !> Gives every bin its chunks, one after the other, and every particle its lane.
  pure subroutine chain_bins(particles, slot)
    type(particles_t), intent(inout) :: particles
    integer, intent(out) :: slot(:)                 !! lane + lanes*(chunk - 1), in the bins' order
    integer :: number, chunk, n, p, k
    chunk = 0
    p = 0
    do number = 1, size(particles%size)
      if (particles%size(number) == 0) cycle
      particles%first(number) = chunk + 1
      do n = 1, particles%size(number)
        slot(p + n) = lanes*chunk + n
      end do
      p = p + particles%size(number)
      n = (particles%size(number) + lanes - 1)/lanes
      particles%next(chunk + 1:chunk + n - 1) = [(chunk + k, k=2, n)]
      chunk = chunk + n
    end do
  end subroutine chain_bins

  !> Order of the particles by bin, then by id.
  subroutine order_by_bin(particles, x, order)
    type(particles_t), intent(in) :: particles
    real(dp), intent(in) :: x(:, :)
    integer, intent(out) :: order(:)
    integer(i8), allocatable :: key(:)
    integer :: p, low(3), high(3), bin(3)
    integer(i8) :: extent(3)
    low = huge(1)
    high = -huge(1)
    !$omp parallel do schedule(static) default(none) shared(particles, x, order) private(bin) &
    !$omp& reduction(min: low) reduction(max: high)
    do p = 1, size(order)
      bin = bin_coordinates(particles, x(:, p))
      low = min(low, bin)
      high = max(high, bin)
    end do
    !$omp end parallel do
    extent = int(high, i8) - int(low, i8) + 1_i8
    allocate (key(size(order)))
    !$omp parallel do schedule(static) default(none) private(bin) &
    !$omp& shared(particles, x, order, key, low, extent)
    do p = 1, size(order)
      bin = bin_coordinates(particles, x(:, p)) - low
      key(p) = (int(bin(3), i8)*extent(2) + int(bin(2), i8))*extent(1) + int(bin(1), i8)
    end do
    !$omp end parallel do
    call sort_order(key, order)
  end subroutine order_by_bin

  !> Makes the bins for a set of positions and counts their particles.
  subroutine count_bins(particles, x, order)
    type(particles_t), intent(inout) :: particles
    real(dp), intent(in) :: x(:, :)
    integer, intent(in) :: order(:)                 !! of the particles by bin
    integer, allocatable :: i(:)
    integer(i8), allocatable :: key(:)
    integer :: p, bin(3), number
    allocate (i(size(order)), key(size(order)))
    !$omp parallel do schedule(static) default(none) &
    !$omp   shared(particles, x, order, i, key) private(bin)
    do p = 1, size(order)
      bin = bin_coordinates(particles, x(:, order(p)))
      key(p) = row_key(bin(2), bin(3))
      i(p) = bin(1)
    end do
    !$omp end parallel do
    call rows_from_points(key, i, particles%bins)
    call particles_number_bins(particles)
    number = 0  ! bins are numbered in the order of the rows, and none is empty
    do p = 1, size(order)
      if (p == 1) then
        number = 1
      else if (key(p) /= key(p - 1) .or. i(p) /= i(p - 1)) then
        number = number + 1
      end if
      particles%size(number) = particles%size(number) + 1
    end do
  end subroutine count_bins

  !> Numbers the bins of the rows and empties them.
  pure subroutine particles_number_bins(particles)
    type(particles_t), intent(inout) :: particles
    integer :: s, next
    if (allocated(particles%bin_start)) then
      deallocate (particles%bin_start, particles%first, particles%size)
    end if
    allocate (particles%bin_start(particles%bins%n))
    next = 1
    do s = 1, particles%bins%n
      particles%bin_start(s) = next - particles%bins%first(s)
      next = next + particles%bins%last(s) - particles%bins%first(s) + 1
    end do
    allocate (particles%first(next - 1), particles%size(next - 1), source=0)
  end subroutine particles_number_bins

  !> Makes room for some more chunks; one stream at a time, so that no more than one is held twice.
  pure subroutine chunks_make_room(particles, more)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: more
    real(dp), allocatable :: stream(:, :, :)
    integer(i4), allocatable :: id(:, :)
    integer, allocatable :: next(:)
    integer :: old, capacity
    old = particles%chunks
    capacity = old + old/8 + 16 + more
    allocate (stream(lanes, particles%motion_columns, capacity))
    call large_pages_ask(stream, size(stream, kind=i8))
    stream(:, :, :old) = particles%motion(:, :, :old)
    call move_alloc(stream, particles%motion)
    allocate (stream(lanes, particles%state_columns, capacity))
    call large_pages_ask(stream, size(stream, kind=i8))
    stream(:, :, :old) = particles%state(:, :, :old)
    call move_alloc(stream, particles%state)
    allocate (id(lanes, capacity), next(capacity))
    id(:, :old) = particles%id(:, :old)
    next(:old) = particles%next(:old)
    call move_alloc(id, particles%id)
    call move_alloc(next, particles%next)
  end subroutine chunks_make_room

  !> Chunks for new use: spare ones, then new ones; `done`: there was room. One thread at a time.
  pure subroutine chunks_take(particles, taken, done)
    type(particles_t), intent(inout) :: particles
    integer, intent(out) :: taken(:)
    logical, intent(out) :: done
    integer :: n, new, c
    n = min(size(taken), particles%spares)
    new = size(taken) - n
    done = particles%chunks + new <= size(particles%next)
    if (.not. done) return
    taken(:n) = particles%spare(particles%spares - n + 1:particles%spares)
    taken(n + 1:) = [(particles%chunks + c, c=1, new)]
    particles%spares = particles%spares - n
    particles%chunks = particles%chunks + new
    particles%next(taken) = 0
  end subroutine chunks_take

  !> Takes chunks back that no bin uses any more, after which others may take them.
  pure subroutine chunks_give_back(particles, chunks)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: chunks(:)
    integer :: n
    n = particles%spares + size(chunks)
    if (.not. allocated(particles%spare)) allocate (particles%spare(n))
    call grow(particles%spare, particles%spares, n)
    particles%spare(particles%spares + 1:n) = chunks
    particles%spares = n
    particles%scattered = particles%chunks > many_chunks
  end subroutine chunks_give_back

  !> Makes the lanes from `lane` (> 1) on harmless: at rest, unstressed, of the body's density, and
  !! where the particle before them sits. They receive nothing from the grid, so they stay there,
  !! inside the bin.
  pure subroutine chunk_pad(particles, chunk, lane)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: chunk, lane
    integer :: d, q
    if (lane > lanes) return
    do d = 1, particles%ndim
      particles%motion(lane:, d, chunk) = particles%motion(lane - 1, d, chunk)
      particles%motion(lane:, motion_velocity(particles%ndim) + d - 1, chunk) = 0.0_dp
    end do
    particles%motion(lane:, motion_mass(particles%ndim), chunk) = particles%pad_mass
    do q = 1, particles%state_columns
      particles%state(lane:, q, chunk) = particles%pad(q)
    end do
    particles%id(lane:, chunk) = 0
  end subroutine chunk_pad

  !> Has the memory of a chunk (0: none) fetched into the cache; `state` only where wanted.
  pure subroutine chunk_prefetch(particles, chunk, both)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: chunk
    logical, intent(in) :: both
    if (chunk == 0) return
    call prefetch(particles%motion(1, 1, chunk), 8*lanes*particles%motion_columns)
    if (both) then
      call prefetch(particles%state(1, 1, chunk), 8*lanes*particles%state_columns)
    else if (particles%reference > 0) then
      call prefetch(particles%state(1, particles%reference, chunk), 8*lanes*particles%ndim)
    end if
  end subroutine chunk_prefetch

  !> Pads the last chunk of every bin.
  pure subroutine particles_pad(particles)
    type(particles_t), intent(inout) :: particles
    integer :: number, chunk, live
    do number = 1, size(particles%size)
      chunk = particles%first(number)
      live = particles%size(number)
      do while (live > lanes)
        chunk = particles%next(chunk)
        live = live - lanes
      end do
      if (live > 0) call chunk_pad(particles, chunk, live + 1)
    end do
  end subroutine particles_pad

end module sgmp_particles
