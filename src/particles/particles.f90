!> The particles of one body: chunks of `lanes` particles, binned by the cell of their stencil.
!!
!! A bin holds the particles that share a grid stencil, ordered by id, in a chain of chunks; the
!! unused lanes of its last chunk hold a harmless pad. Two streams keep the two sweeps of a step
!! apart: `a` (position, velocity, mass) is all that a momentum sweep touches, `b` (volume, stress,
!! history) is read only where stress is updated.
module sgmp_particles
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_rows, only: row_key, rows_contains, rows_from_points, rows_t, rows_union
  use sgmp_sorting, only: sort_order
  implicit none
  private
  public :: particles_t, movers_t
  public :: particles_fill, particles_rebin, particles_bytes, particles_bin_of, movers_add, &
            movers_append, movers_reset, bin_coordinates

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

  !> Particles that have left their bin.
  type :: movers_t
    integer :: n = 0
    integer, allocatable :: chunk(:), lane(:), bin(:)
    integer(i4), allocatable :: id(:)               !! filled by particles_rebin, ascending
    logical, allocatable :: gone(:)  !! filled by particles_rebin: outside the grid, removed
    real(dp), allocatable :: record(:, :)           !! (na + nb, n) their state, in the order of id
    real(dp), allocatable :: values(:, :)           !! (values, n) what they give to the grid
  end type movers_t

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
        call pad_chunk(particles, chunk, 1)
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
    call place_pads(particles)
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
    call number_bins(particles)
    do p = 1, n
      number = particles_bin_of(particles, bin_coordinates(x(:, p), particles%shift, &
                                                           particles%ndim))
      particles%size(number) = particles%size(number) + 1
    end do
  end subroutine count_bins

  !> Numbers the bins of the rows and empties them.
  pure subroutine number_bins(particles)
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
  end subroutine number_bins

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
  pure subroutine take_chunk(particles, chunk)
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
  end subroutine take_chunk

  !> Makes the lanes from `lane` on harmless: at rest, unstressed, of the body's density.
  pure subroutine pad_chunk(particles, chunk, lane)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: chunk, lane
    integer :: l
    do l = lane, lanes
      particles%a(l, particles%ndim + 1:2*particles%ndim, chunk) = 0.0_dp
      particles%a(l, particles%na, chunk) = particles%pad_mass
      particles%b(l, :, chunk) = particles%pad
      particles%id(l, chunk) = 0
    end do
  end subroutine pad_chunk

  !> Puts the pads of every bin's last chunk at the bin's middle.
  pure subroutine place_pads(particles)
    type(particles_t), intent(inout) :: particles
    integer :: s, i, number, chunk, live
    do s = 1, particles%bins%n
      do i = particles%bins%first(s), particles%bins%last(s)
        number = particles%bin_start(s) + i
        chunk = particles%first(number)
        live = particles%size(number)
        do while (chunk > 0)
          if (live < lanes) call copy_place(particles, chunk, max(live, 1))
          live = live - lanes
          chunk = particles%next(chunk)
        end do
      end do
    end do
  end subroutine place_pads

  !> Pads sit where the bin's last particle sits, so that they never leave the bin before it does.
  pure subroutine copy_place(particles, chunk, live)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: chunk, live
    integer :: l
    do l = live + 1, lanes
      particles%a(l, 1:particles%ndim, chunk) = particles%a(live, 1:particles%ndim, chunk)
    end do
  end subroutine copy_place

  !> Forgets all movers; each will come with `nvalues` values for the grid.
  pure subroutine movers_reset(movers, nvalues)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: nvalues
    movers%n = 0
    if (.not. allocated(movers%chunk)) allocate (movers%chunk(64), movers%lane(64), movers%bin(64))
    if (allocated(movers%values)) then
      if (size(movers%values, 1) /= nvalues) deallocate (movers%values)
    end if
    if (.not. allocated(movers%values)) allocate (movers%values(nvalues, size(movers%chunk)))
  end subroutine movers_reset

  !> Notes a particle that has left its bin.
  pure subroutine movers_add(movers, chunk, lane, bin, values)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: chunk, lane, bin
    real(dp), intent(in) :: values(:)
    if (movers%n == size(movers%chunk)) call movers_reserve(movers, 2*movers%n)
    movers%n = movers%n + 1
    movers%chunk(movers%n) = chunk
    movers%lane(movers%n) = lane
    movers%bin(movers%n) = bin
    movers%values(:, movers%n) = values
  end subroutine movers_add

  !> Appends one list to another.
  pure subroutine movers_append(movers, more)
    type(movers_t), intent(inout) :: movers
    type(movers_t), intent(in) :: more
    integer :: n
    n = movers%n + more%n
    if (n > size(movers%chunk)) call movers_reserve(movers, n + n/2)
    movers%chunk(movers%n + 1:n) = more%chunk(:more%n)
    movers%lane(movers%n + 1:n) = more%lane(:more%n)
    movers%bin(movers%n + 1:n) = more%bin(:more%n)
    movers%values(:, movers%n + 1:n) = more%values(:, :more%n)
    movers%n = n
  end subroutine movers_append

  pure subroutine movers_reserve(movers, capacity)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: capacity
    type(movers_t) :: new
    allocate (new%chunk(capacity), new%lane(capacity), new%bin(capacity), &
              new%values(size(movers%values, 1), capacity))
    new%chunk(:movers%n) = movers%chunk(:movers%n)
    new%lane(:movers%n) = movers%lane(:movers%n)
    new%bin(:movers%n) = movers%bin(:movers%n)
    new%values(:, :movers%n) = movers%values(:, :movers%n)
    call move_alloc(new%chunk, movers%chunk)
    call move_alloc(new%lane, movers%lane)
    call move_alloc(new%bin, movers%bin)
    call move_alloc(new%values, movers%values)
  end subroutine movers_reserve

  !> Moves particles to the bins of their new positions; bins stay ordered by id, so nothing depends
  !! on history.
  pure subroutine particles_rebin(particles, movers, lower, upper, new_bins)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: movers      !! in: chunk, lane, bin; out: id and record,
                                                 !! ascending by id
    real(dp), intent(in) :: lower(3), upper(3)   !! particles outside this box (cells) are removed
    logical, intent(out) :: new_bins  !! the set of bins has changed: the field's layout must follow
    integer, allocatable :: target(:), order(:)
    integer :: m, p, t
    logical :: missing
    call lift_movers(particles, movers)
    allocate (target(movers%n), source=0)
    call find_gone(particles, movers, lower, upper)
    missing = .false.
    do m = 1, movers%n
      if (movers%gone(m)) cycle
      target(m) = particles_bin_of(particles, bin_coordinates(movers%record(:, m), &
                                                              particles%shift, particles%ndim))
      missing = missing .or. target(m) == 0
    end do
    new_bins = missing
    if (missing) then
      call close_bins(particles, movers%bin(:movers%n))
      call extend_bins(particles, movers)
      do m = 1, movers%n
        if (movers%gone(m)) cycle
        target(m) = particles_bin_of(particles, bin_coordinates(movers%record(:, m), &
                                                                particles%shift, particles%ndim))
      end do
    else
      call close_bins(particles, movers%bin(:movers%n))
    end if
    allocate (order(movers%n))
    call sort_order(int(target, i8), order)
    p = 1
    do while (p <= movers%n)
      t = p
      do while (t < movers%n)
        if (target(order(t + 1)) /= target(order(p))) exit
        t = t + 1
      end do
      if (target(order(p)) > 0) then
        call insert_arrivals(particles, target(order(p)), movers, order(p:t))
      end if
      p = t + 1
    end do
  end subroutine particles_rebin

  !> Finds the movers that have left the grid.
  pure subroutine find_gone(particles, movers, lower, upper)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: movers
    real(dp), intent(in) :: lower(3), upper(3)
    integer :: m, n
    n = particles%ndim
    if (allocated(movers%gone)) deallocate (movers%gone)
    allocate (movers%gone(movers%n))
    do m = 1, movers%n
      movers%gone(m) = any(movers%record(:n, m) < lower(:n)) .or. &
          any(movers%record(:n, m) > upper(:n))
    end do
    particles%count = particles%count - count(movers%gone)
  end subroutine find_gone

  !> Copies the movers' state out and marks their lanes empty.
  pure subroutine lift_movers(particles, movers)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: movers
    integer, allocatable :: order(:)
    integer :: m, c, l, na
    integer(i8), allocatable :: key(:)
    na = particles%na
    allocate (order(movers%n), key(movers%n))
    do m = 1, movers%n
      key(m) = int(particles%id(movers%lane(m), movers%chunk(m)), i8)
    end do
    call sort_order(key, order)
    if (allocated(movers%record)) deallocate (movers%record)
    allocate (movers%record(na + particles%nb, movers%n))
    movers%id = int(key(order), i4)
    movers%chunk(:movers%n) = movers%chunk(order)
    movers%lane(:movers%n) = movers%lane(order)
    movers%bin(:movers%n) = movers%bin(order)
    movers%values(:, :movers%n) = movers%values(:, order)
    do m = 1, movers%n
      c = movers%chunk(m)
      l = movers%lane(m)
      movers%record(:na, m) = particles%a(l, :, c)
      movers%record(na + 1:, m) = particles%b(l, :, c)
      particles%id(l, c) = 0
    end do
  end subroutine lift_movers

  !> Closes the gaps in bins that particles have left.
  pure subroutine close_bins(particles, bins)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bins(:)               !! bins, one entry per leaver
    integer :: m, live, c, l, to_c, to_l, next, n
    do m = 1, size(bins)
      n = particles%size(bins(m))
      c = particles%first(bins(m))
      to_c = c
      to_l = 0
      live = 0
      do l = 1, n
        if (l > 1 .and. mod(l - 1, lanes) == 0) c = particles%next(c)
        if (particles%id(mod(l - 1, lanes) + 1, c) == 0) cycle
        if (to_l == lanes) then
          to_c = particles%next(to_c)
          to_l = 0
        end if
        to_l = to_l + 1
        live = live + 1
        if (to_c /= c .or. to_l /= mod(l - 1, lanes) + 1) then
          call copy_lane(particles, mod(l - 1, lanes) + 1, c, to_l, to_c)
        end if
      end do
      if (live == n) cycle
      particles%size(bins(m)) = live
      if (live == 0) then
        c = particles%first(bins(m))
        particles%first(bins(m)) = 0
      else
        c = particles%next(to_c)
        particles%next(to_c) = 0
        call pad_chunk(particles, to_c, to_l + 1)
        call copy_place(particles, to_c, to_l)
      end if
      do while (c > 0)
        next = particles%next(c)
        particles%id(:, c) = 0
        particles%next(c) = particles%free_chunk
        particles%free_chunk = c
        c = next
      end do
    end do
  end subroutine close_bins

  pure subroutine copy_lane(particles, from_lane, from_chunk, to_lane, to_chunk)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: from_lane, from_chunk, to_lane, to_chunk
    particles%a(to_lane, :, to_chunk) = particles%a(from_lane, :, from_chunk)
    particles%b(to_lane, :, to_chunk) = particles%b(from_lane, :, from_chunk)
    particles%id(to_lane, to_chunk) = particles%id(from_lane, from_chunk)
  end subroutine copy_lane

  !> Renews the set of bins: those still occupied and those that movers need.
  pure subroutine extend_bins(particles, movers)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(in) :: movers
    type(rows_t) :: wanted, occupied, old
    integer, allocatable :: old_start(:), old_first(:), old_size(:), order(:), i(:), stay(:)
    integer(i8), allocatable :: key(:)
    integer :: m, bin(3), s, number, n
    stay = pack([(m, m=1, movers%n)], .not. movers%gone)
    allocate (order(size(stay)), i(size(stay)), key(size(stay)))
    call order_by_bin(particles, movers%record(:particles%ndim, stay), order)
    do m = 1, size(stay)
      bin = bin_coordinates(movers%record(:, stay(order(m))), particles%shift, particles%ndim)
      key(m) = row_key(bin(2), bin(3))
      i(m) = bin(1)
    end do
    call rows_from_points(key, i, wanted)
    call occupied_bins(particles, occupied)
    old = particles%bins
    call move_alloc(particles%bin_start, old_start)
    call move_alloc(particles%first, old_first)
    call move_alloc(particles%size, old_size)
    call rows_union(occupied, wanted, particles%bins)
    call number_bins(particles)
    do s = 1, old%n
      do m = old%first(s), old%last(s)
        n = old_start(s) + m
        if (old_size(n) == 0) cycle
        number = particles%bin_start(rows_contains(particles%bins, old%key(s), m)) + m
        particles%first(number) = old_first(n)
        particles%size(number) = old_size(n)
      end do
    end do
  end subroutine extend_bins

  !> The bins that hold particles.
  pure subroutine occupied_bins(particles, occupied)
    type(particles_t), intent(in) :: particles
    type(rows_t), intent(out) :: occupied
    integer(i8), allocatable :: key(:)
    integer, allocatable :: i(:)
    integer :: s, m, n
    allocate (key(size(particles%size)), i(size(particles%size)))
    n = 0
    do s = 1, particles%bins%n
      do m = particles%bins%first(s), particles%bins%last(s)
        if (particles%size(particles%bin_start(s) + m) == 0) cycle
        n = n + 1
        key(n) = particles%bins%key(s)
        i(n) = m
      end do
    end do
    call rows_from_points(key(:n), i(:n), occupied)
  end subroutine occupied_bins

  !> Inserts movers (ascending by id) into a bin at their places in the order of ids.
  pure subroutine insert_arrivals(particles, bin, movers, who)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: who(:)                !! movers that come to this bin, ascending by id
    integer :: chain((particles%size(bin) + size(who) + lanes - 1)/lanes)
    integer :: n, old, c, t, w, na
    na = particles%na
    old = particles%size(bin)
    n = old + size(who)
    c = particles%first(bin)
    do t = 1, size(chain)
      if (c == 0) then
        call take_chunk(particles, c)
        call pad_chunk(particles, c, 1)
        if (t == 1) particles%first(bin) = c
        if (t > 1) particles%next(chain(t - 1)) = c
      end if
      chain(t) = c
      c = particles%next(c)
    end do
    particles%size(bin) = n
    w = size(who)
    do t = n, 1, -1
      if (w == 0) exit
      c = chain((t - 1)/lanes + 1)
      if (old > 0) then
        if (particles%id(mod(old - 1, lanes) + 1, &
                         chain((old - 1)/lanes + 1)) > movers%id(who(w))) then
          call copy_lane(particles, mod(old - 1, lanes) + 1, chain((old - 1)/lanes + 1), &
                         mod(t - 1, lanes) + 1, c)
          old = old - 1
          cycle
        end if
      end if
      particles%a(mod(t - 1, lanes) + 1, :, c) = movers%record(:na, who(w))
      particles%b(mod(t - 1, lanes) + 1, :, c) = movers%record(na + 1:, who(w))
      particles%id(mod(t - 1, lanes) + 1, c) = movers%id(who(w))
      w = w - 1
    end do
    c = chain(size(chain))
    if (mod(n, lanes) /= 0) call copy_place(particles, c, mod(n - 1, lanes) + 1)
  end subroutine insert_arrivals

end module sgmp_particles
