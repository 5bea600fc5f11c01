!> Moves particles between bins.
!!
!! Bins stay ordered by id, so that nothing depends on the way a particle came. The set of bins
!! grows when a mover needs a new one; bins that run empty are dropped when they have become many,
!! for a new set means a new layout of the grid.
module sgmp_rebinning
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_movers, only: movers_sort, movers_t
  use sgmp_particles, only: bin_coordinates, chunk_free, chunk_pad, chunk_take, &
                            particles_number_bins, particles_t
  use sgmp_rows, only: key_k, row_key, rows_contains, rows_from_points, rows_t, rows_union
  use sgmp_sorting, only: sort_order
  implicit none
  private
  public :: particles_rebin, particles_renew_bins

contains

  !> Moves particles to the bins of their new positions.
  !!
  !! Movers that come from another rank have no chunk; those that go to one leave, and are given a
  !! bin where one is held for them, so that what they give to the grid can be added here.
  pure subroutine particles_rebin(particles, movers, lower, upper, new_bins)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: movers      !! in: row and bin they left; out: their new ones
    real(dp), intent(in) :: lower(3), upper(3)   !! particles outside this box (cells) are removed
    logical, intent(out) :: new_bins             !! the set of bins has changed: so must the layout
    integer :: m, r
    call movers_sort(movers)
    call find_gone(particles, movers, lower, upper)
    call close_bins(particles, movers)
    call find_bins(particles, movers, new_bins)
    if (new_bins) then
      call extend_bins(particles, movers)
      call find_bins(particles, movers)
    end if
    do r = 1, movers%n
      m = movers%order(r)
      if (movers%chunk(m) > 0) particles%count = particles%count - 1
      if (movers%gone(m)) cycle
      if (.not. within(plane_of(particles, movers, m), particles%own)) cycle
      particles%count = particles%count + 1
      call insert(particles, movers%bin(m), movers%id(m), movers%state(:, m))
    end do
  end subroutine particles_rebin

  !> Plane of bins that a mover belongs to now.
  pure function plane_of(particles, movers, m) result(plane)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: m
    integer :: plane, bin(3)
    bin = bin_coordinates(movers%state(:, m), particles%shift, particles%ndim)
    plane = bin(3)
  end function plane_of

  pure function within(plane, range) result(yes)
    integer, intent(in) :: plane, range(2)
    logical :: yes
    yes = plane >= range(1) .and. plane <= range(2)
  end function within

  !> Finds the movers that have left the grid.
  pure subroutine find_gone(particles, movers, lower, upper)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(inout) :: movers
    real(dp), intent(in) :: lower(3), upper(3)
    integer :: m, d
    do m = 1, movers%n
      do d = 1, particles%ndim
        if (movers%state(d, m) < lower(d) .or. movers%state(d, m) > upper(d)) then
          movers%gone(m) = .true.
        end if
      end do
    end do
  end subroutine find_gone

  !> Row and bin of each mover; `missing`: some of them have none yet.
  pure subroutine find_bins(particles, movers, missing)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(inout) :: movers
    logical, intent(out), optional :: missing
    integer :: m, bin(3)
    if (present(missing)) missing = .false.
    do m = 1, movers%n
      if (movers%gone(m)) cycle
      bin = bin_coordinates(movers%state(:, m), particles%shift, particles%ndim)
      movers%bin(m) = 0
      if (.not. within(bin(3), particles%held)) cycle
      movers%row(m) = row_near(particles%bins, movers%row(m), row_key(bin(2), bin(3)), bin(1))
      if (movers%row(m) > 0) movers%bin(m) = particles%bin_start(movers%row(m)) + bin(1)
      if (present(missing)) missing = missing .or. movers%bin(m) == 0
    end do
  end subroutine find_bins

  !> Interval of rows that holds point i of row `key`, 0: none; looked for at `guess` and beside it
  !! first, where most movers go.
  pure function row_near(rows, guess, key, i) result(s)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: guess, i
    integer(i8), intent(in) :: key
    integer :: s
    do s = max(1, guess - 1), min(rows%n, guess + 1)
      if (rows%key(s) == key .and. rows%first(s) <= i .and. rows%last(s) >= i) return
    end do
    s = rows_contains(rows, key, i)
  end function row_near

  !> Closes the gaps in bins that particles have left.
  pure subroutine close_bins(particles, movers)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(in) :: movers
    integer :: m, bin
    do m = 1, movers%n
      if (movers%chunk(m) > 0) particles%id(movers%lane(m), movers%chunk(m)) = 0
    end do
    bin = 0
    do m = 1, movers%n
      if (movers%chunk(m) == 0) cycle
      if (movers%bin(m) /= bin) call close_bin(particles, movers%bin(m))
      bin = movers%bin(m)
    end do
  end subroutine close_bins

  !> Moves the particles of one bin up to the front of its chain.
  pure subroutine close_bin(particles, bin)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin
    integer :: c, l, left, to_c, to_l, live
    c = particles%first(bin)
    to_c = c
    to_l = 0
    live = 0
    left = particles%size(bin)
    do while (left > 0)
      do l = 1, min(left, lanes)
        if (particles%id(l, c) == 0) cycle
        if (to_l == lanes) then
          to_c = particles%next(to_c)
          to_l = 0
        end if
        to_l = to_l + 1
        live = live + 1
        if (to_c /= c .or. to_l /= l) call copy_lane(particles, l, c, to_l, to_c)
      end do
      left = left - lanes
      c = particles%next(c)
    end do
    call cut_chain(particles, bin, live, to_c, to_l)
  end subroutine close_bin

  !> Ends a bin's chain behind its last particle.
  pure subroutine cut_chain(particles, bin, live, chunk, lane)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin, live   !! particles that are left
    integer, intent(in) :: chunk, lane  !! of the last of them
    integer :: c, next
    particles%size(bin) = live
    if (live == 0) then
      c = particles%first(bin)
      particles%first(bin) = 0
    else
      c = particles%next(chunk)
      particles%next(chunk) = 0
      call chunk_pad(particles, chunk, lane + 1)
    end if
    do while (c > 0)
      next = particles%next(c)
      call chunk_free(particles, c)
      c = next
    end do
  end subroutine cut_chain

  pure subroutine copy_lane(particles, from_lane, from_chunk, to_lane, to_chunk)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: from_lane, from_chunk, to_lane, to_chunk
    integer :: q
    do q = 1, particles%na
      particles%a(to_lane, q, to_chunk) = particles%a(from_lane, q, from_chunk)
    end do
    do q = 1, particles%nb
      particles%b(to_lane, q, to_chunk) = particles%b(from_lane, q, from_chunk)
    end do
    particles%id(to_lane, to_chunk) = particles%id(from_lane, from_chunk)
  end subroutine copy_lane

  !> Inserts a particle into a bin at its place in the order of ids.
  pure subroutine insert(particles, bin, id, state)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin
    integer(i4), intent(in) :: id
    real(dp), intent(in) :: state(:)             !! (na + nb)
    integer :: chain(0:particles%size(bin)/lanes), n, c, t, q
    n = particles%size(bin)
    c = particles%first(bin)
    do t = 0, (n - 1)/lanes
      if (n == 0) exit
      chain(t) = c
      c = particles%next(c)
    end do
    if (mod(n, lanes) == 0) then
      call chunk_take(particles, c)
      chain(n/lanes) = c
      if (n == 0) then
        particles%first(bin) = c
      else
        particles%next(chain(n/lanes - 1)) = c
      end if
    end if
    do t = n, 1, -1                              ! t + 1 is free
      if (particles%id(mod(t - 1, lanes) + 1, chain((t - 1)/lanes)) < id) exit
      call copy_lane(particles, mod(t - 1, lanes) + 1, chain((t - 1)/lanes), &
                     mod(t, lanes) + 1, chain(t/lanes))
    end do
    c = chain(t/lanes)
    t = mod(t, lanes) + 1
    do q = 1, particles%na
      particles%a(t, q, c) = state(q)
    end do
    do q = 1, particles%nb
      particles%b(t, q, c) = state(particles%na + q)
    end do
    particles%id(t, c) = id
    particles%size(bin) = n + 1
    if (mod(n, lanes) == 0) call chunk_pad(particles, chain(n/lanes), 2)
  end subroutine insert

  !> Adds the bins that movers need; drops the empty ones where they are more than an eighth.
  pure subroutine extend_bins(particles, movers)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(in) :: movers
    type(rows_t) :: wanted, kept
    call wanted_bins(particles, movers, wanted)
    if (8*empty_bins(particles) > size(particles%size)) then
      call occupied_bins(particles, .true., kept)
    else
      kept = particles%bins
    end if
    call change_bins(particles, kept, wanted)
  end subroutine extend_bins

  !> Renews the bins that stand for other ranks': `others` instead of all that are outside the own
  !! planes; own ones that are empty go, too.
  pure subroutine particles_renew_bins(particles, others)
    type(particles_t), intent(inout) :: particles
    type(rows_t), intent(in) :: others
    type(rows_t) :: kept
    call occupied_bins(particles, .false., kept)
    call change_bins(particles, kept, others)
  end subroutine particles_renew_bins

  !> Own bins without particles.
  pure function empty_bins(particles) result(empty)
    type(particles_t), intent(in) :: particles
    integer :: empty, s
    empty = 0
    do s = 1, particles%bins%n
      if (.not. within(key_k(particles%bins%key(s)), particles%own)) cycle
      empty = empty + count(particles%size(particles%bin_start(s) + particles%bins%first(s): &
                                           particles%bin_start(s) + particles%bins%last(s)) == 0)
    end do
  end function empty_bins

  !> A new set of bins, with all that are occupied in the first of two sets; the particles stay in
  !! their chunks.
  pure subroutine change_bins(particles, kept, more)
    type(particles_t), intent(inout) :: particles
    type(rows_t), intent(in) :: kept, more
    type(rows_t) :: old
    integer, allocatable :: old_start(:), old_first(:), old_size(:)
    integer :: s, t, i, shift
    old = particles%bins
    call move_alloc(particles%bin_start, old_start)
    call move_alloc(particles%first, old_first)
    call move_alloc(particles%size, old_size)
    call rows_union(kept, more, particles%bins)
    call particles_number_bins(particles)
    t = 1
    do s = 1, old%n
      do i = old%first(s), old%last(s)
        if (old_size(old_start(s) + i) == 0) cycle
        t = row_from(particles%bins, t, old%key(s), i)
        shift = particles%bin_start(t) + i
        particles%first(shift) = old_first(old_start(s) + i)
        particles%size(shift) = old_size(old_start(s) + i)
      end do
    end do
  end subroutine change_bins

  !> Interval, at `start` or behind it, that holds point i of row `key`, which must exist.
  pure function row_from(rows, start, key, i) result(s)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: start, i
    integer(i8), intent(in) :: key
    integer :: s
    s = start
    do while (rows%key(s) /= key .or. rows%last(s) < i)
      s = s + 1
    end do
  end function row_from

  !> The bins that movers need and that do not exist or are empty.
  pure subroutine wanted_bins(particles, movers, wanted)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: movers
    type(rows_t), intent(out) :: wanted
    integer, allocatable :: order(:), i(:)
    integer(i8), allocatable :: key(:), sortable(:)
    integer :: m, n, bin(3)
    n = 0
    allocate (i(movers%n), key(movers%n), sortable(movers%n))
    do m = 1, movers%n
      if (movers%gone(m)) cycle
      if (movers%bin(m) > 0) then
        if (particles%size(movers%bin(m)) > 0) cycle
      end if
      bin = bin_coordinates(movers%state(:, m), particles%shift, particles%ndim)
      if (.not. within(bin(3), particles%held)) cycle
      n = n + 1
      i(n) = bin(1)
      key(n) = row_key(bin(2), bin(3))
    end do
    allocate (order(n))
    sortable(:n) = int(i(:n), i8) - minval(i(:n))
    call sort_order(sortable(:n), order)
    i(:n) = i(order)
    key(:n) = key(order)
    sortable(:n) = key(:n) - minval(key(:n))
    call sort_order(sortable(:n), order)
    call rows_from_points(key(order), i(order), wanted)
  end subroutine wanted_bins

  !> The bins that hold particles, and where `all` those that stand for other ranks'.
  pure subroutine occupied_bins(particles, all, occupied)
    type(particles_t), intent(in) :: particles
    logical, intent(in) :: all
    type(rows_t), intent(out) :: occupied
    integer(i8), allocatable :: key(:)
    integer, allocatable :: i(:)
    integer :: s, m, n
    allocate (key(size(particles%size)), i(size(particles%size)))
    n = 0
    do s = 1, particles%bins%n
      do m = particles%bins%first(s), particles%bins%last(s)
        if (particles%size(particles%bin_start(s) + m) == 0) then
          if (.not. all .or. within(key_k(particles%bins%key(s)), particles%own)) cycle
        end if
        n = n + 1
        key(n) = particles%bins%key(s)
        i(n) = m
      end do
    end do
    call rows_from_points(key(:n), i(:n), occupied)
  end subroutine occupied_bins

end module sgmp_rebinning
