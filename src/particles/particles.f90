!> The particles of one body: chunks of `lanes` particles, binned by the cell of their stencil.
!!
!! A bin holds the particles that share a grid stencil, ordered by id, in a chain of chunks; the
!! unused lanes of its last chunk hold a harmless pad. Two streams keep the two sweeps of a step
!! apart: `a` (position, velocity, mass) is all that a momentum sweep touches, `b` (volume, stress,
!! history) is read only where stress is updated.
module sgmp_particles
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_rows, only: row_key, rows_contains, rows_from_points, rows_t
  use sgmp_sorting, only: sort_order
  implicit none
  private
  public :: particles_t, particles_fill, particles_bytes, particles_bin_of, particles_number_bins, bin_coordinates
  public :: chunk_take, chunk_free, chunk_pad

  !> Chunks and bins of a body.
  type :: particles_t
    integer :: ndim = 3
    integer :: na = 7                               !! columns of `a`: X (ndim), v (ndim), mass
    integer :: nb = 7                               !! columns of `b`: volume, stress, history
    integer :: count = 0                            !! live particles
    integer :: chunks = 0                           !! chunks in use or on the free list
    integer :: free_chunk = 0                       !! head of the free list
    real(dp) :: shift = 0.5_dp                      !! bin of X is floor(X - shift)
    real(dp), allocatable :: a(:, :, :)  !! (lanes, na, chunk); X in cells from the grid origin
    real(dp), allocatable :: b(:, :, :)             !! (lanes, nb, chunk)
    integer(i4), allocatable :: id(:, :)            !! (lanes, chunk); 0 in pads
    integer, allocatable :: next(:)                 !! chunk that continues the bin, 0: none
    real(dp), allocatable :: pad(:)                 !! (nb) harmless values of b in pads
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

  !> Bin coordinates (i, j, k) of a position: in 2D the y axis is k.
  pure function bin_coordinates(x, shift, ndim) result(bin)
    real(dp), intent(in) :: x(:)          !! (>= ndim) grid coordinates
    real(dp), intent(in) :: shift
    integer, intent(in) :: ndim
    integer :: bin(3)
    bin = 0
    bin(1) = floor(x(1) - shift)
    if (ndim == 2) bin(3) = floor(x(2) - shift)
    if (ndim == 3) bin(2:3) = floor(x(2:3) - shift)
  end function bin_coordinates

  !> Number of the bin with given coordinates, 0 if it does not exist.
  pure function particles_bin_of(particles, bin) result(number)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin(3)
    integer :: number, s
    s = rows_contains(particles%bins, row_key(bin(2), bin(3)), bin(1))
    number = 0
    if (s > 0) number = particles%bin_start(s) + bin(1)
  end function particles_bin_of

  !> Bytes held by the particles of a body.
  pure function particles_bytes(particles) result(bytes)
    type(particles_t), intent(in) :: particles
    integer(i8) :: bytes
    bytes = 8_i8*(size(particles%a, kind=i8) + size(particles%b, kind=i8)) &
            + 4_i8*(size(particles%id, kind=i8) + size(particles%next, kind=i8) &
                    + size(particles%first, kind=i8) + size(particles%size, kind=i8))
  end function particles_bytes

  !> Puts particles into bins; `history` gives the first values of the columns of b behind the
  !! volume.
  pure subroutine particles_fill(particles, ndim, shift, x, v, mass, volume, history, first_id)
    type(particles_t), intent(out) :: particles
    integer, intent(in) :: ndim
    real(dp), intent(in) :: shift
    real(dp), intent(in) :: x(:, :)        !! (>= ndim, n) grid coordinates
    real(dp), intent(in) :: v(:, :)        !! (>= ndim, n) velocities
    real(dp), intent(in) :: mass(:), volume(:)  !! (n)
    real(dp), intent(in) :: history(:)     !! (nb - 1)
    integer(i4), intent(in) :: first_id    !! id of the first particle
    integer :: p, n, chunk, lane, in_bin, number, previous
    integer, allocatable :: order(:)
    n = size(mass)
    particles%ndim = ndim
    particles%na = 2*ndim + 1
    particles%nb = 1 + size(history)
    particles%count = n
    particles%shift = shift
    particles%pad = [1.0_dp, history]
    if (n > 0) particles%pad_mass = mass(1)/volume(1)
    allocate (order(n))
    call order_by_bin(particles, x, order)
    call count_bins(particles, x)
    particles%chunks = sum((particles%size + lanes - 1)/lanes)
    call allocate_chunks(particles, particles%chunks + particles%chunks/64 + 4)
    chunk = 0
    lane = lanes
    in_bin = 0
    previous = 0
    do p = 1, n
      number = particles_bin_of(particles, bin_coordinates(x(:, order(p)), shift, ndim))
      if (number /= previous .or. lane == lanes) then
        chunk = chunk + 1
        if (number /= previous) then
          particles%first(number) = chunk
        else
          particles%next(chunk - 1) = chunk
        end if
        lane = 0
        previous = number
      end if
      lane = lane + 1
      particles%a(lane, 1:ndim, chunk) = x(1:ndim, order(p))
      particles%a(lane, ndim + 1:2*ndim, chunk) = v(1:ndim, order(p))
      particles%a(lane, 2*ndim + 1, chunk) = mass(order(p))
      particles%b(lane, 1, chunk) = volume(order(p))
      particles%b(lane, 2:, chunk) = history
      particles%id(lane, chunk) = first_id + order(p) - 1
    end do
    call pad_bins(particles)
  end subroutine particles_fill

  !> Order of the particles by bin, then by id.
  pure subroutine order_by_bin(particles, x, order)
    type(particles_t), intent(in) :: particles
    real(dp), intent(in) :: x(:, :)
    integer, intent(out) :: order(:)
    integer(i8), allocatable :: key(:)
    integer :: p, low(3), high(3), bin(3)
    integer(i8) :: extent(3)
    low = huge(1)
    high = -huge(1)
    do p = 1, size(order)
      bin = bin_coordinates(x(:, p), particles%shift, particles%ndim)
      low = min(low, bin)
      high = max(high, bin)
    end do
    extent = int(high, i8) - int(low, i8) + 1_i8
    allocate (key(size(order)))
    do p = 1, size(order)
      bin = bin_coordinates(x(:, p), particles%shift, particles%ndim) - low
      key(p) = (int(bin(3), i8)*extent(2) + int(bin(2), i8))*extent(1) + int(bin(1), i8)
    end do
    call sort_order(key, order)
  end subroutine order_by_bin

  !> Makes the bins for a set of positions and counts them.
  pure subroutine count_bins(particles, x)
    type(particles_t), intent(inout) :: particles
    real(dp), intent(in) :: x(:, :)
    integer, allocatable :: order(:), i(:)
    integer(i8), allocatable :: key(:)
    integer :: p, n, bin(3), number
    n = particles%count
    allocate (order(n), i(n), key(n))
    call order_by_bin(particles, x, order)
    do p = 1, n
      bin = bin_coordinates(x(:, order(p)), particles%shift, particles%ndim)
      key(p) = row_key(bin(2), bin(3))
      i(p) = bin(1)
    end do
    call rows_from_points(key, i, particles%bins)
    call particles_number_bins(particles)
    do p = 1, n
      number = particles_bin_of(particles, bin_coordinates(x(:, p), particles%shift, &
                                                           particles%ndim))
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

  pure subroutine allocate_chunks(particles, capacity)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: capacity
    allocate (particles%a(lanes, particles%na, capacity))
    allocate (particles%b(lanes, particles%nb, capacity))
    allocate (particles%id(lanes, capacity), particles%next(capacity), source=0)
  end subroutine allocate_chunks

  !> More room for chunks; one stream at a time, so that no more than one is held twice.
  pure subroutine grow_chunks(particles)
    type(particles_t), intent(inout) :: particles
    real(dp), allocatable :: stream(:, :, :)
    integer(i4), allocatable :: id(:, :)
    integer, allocatable :: next(:)
    integer :: old, capacity
    old = size(particles%next)
    capacity = old + old/8 + 16
    allocate (stream(lanes, particles%na, capacity))
    stream(:, :, :old) = particles%a
    call move_alloc(stream, particles%a)
    allocate (stream(lanes, particles%nb, capacity))
    stream(:, :, :old) = particles%b
    call move_alloc(stream, particles%b)
    allocate (id(lanes, capacity), next(capacity), source=0)
    id(:, :old) = particles%id
    next(:old) = particles%next
    call move_alloc(id, particles%id)
    call move_alloc(next, particles%next)
  end subroutine grow_chunks

  !> A chunk from the free list, or a new one.
  pure subroutine chunk_take(particles, chunk)
    type(particles_t), intent(inout) :: particles
    integer, intent(out) :: chunk
    if (particles%free_chunk > 0) then
      chunk = particles%free_chunk
      particles%free_chunk = particles%next(chunk)
    else
      if (particles%chunks == size(particles%next)) call grow_chunks(particles)
      particles%chunks = particles%chunks + 1
      chunk = particles%chunks
    end if
    particles%next(chunk) = 0
  end subroutine chunk_take

  !> Puts a chunk on the free list.
  pure subroutine chunk_free(particles, chunk)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: chunk
    particles%id(:, chunk) = 0
    particles%next(chunk) = particles%free_chunk
    particles%free_chunk = chunk
  end subroutine chunk_free

  !> Makes the lanes from `lane` (> 1) on harmless: at rest, unstressed, of the body's density, and where the particle
  !! before them sits. They receive nothing from the grid, so they stay there, inside the bin.
  pure subroutine chunk_pad(particles, chunk, lane)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: chunk, lane
    integer :: d, q
    if (lane > lanes) return
    do d = 1, particles%ndim
      particles%a(lane:, d, chunk) = particles%a(lane - 1, d, chunk)
      particles%a(lane:, particles%ndim + d, chunk) = 0.0_dp
    end do
    particles%a(lane:, particles%na, chunk) = particles%pad_mass
    do q = 1, particles%nb
      particles%b(lane:, q, chunk) = particles%pad(q)
    end do
    particles%id(lane:, chunk) = 0
  end subroutine chunk_pad

  !> Pads the last chunk of every bin.
  pure subroutine pad_bins(particles)
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
  end subroutine pad_bins

end module sgmp_particles
