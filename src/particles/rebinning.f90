!> Moves particles between bins.
!!
!! Bins stay ordered by id, so that nothing depends on the way a particle came. A sweep closes the
!! gaps that its movers leave. Here every thread takes a range of bins, sorts the movers that come
!! into them, and merges them with the particles that are there, one bin after the other.
!!
!! The set of bins grows when a mover needs a new one; bins that run empty are dropped when they
!! have become many, for a new set means a new layout of the grid.
module sgmp_rebinning
  use sgmp_bin_change, only: bin_insert
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_movers, only: movers_t
  use sgmp_particles, only: bin_coordinates, chunk_prefetch, chunks_give_back, chunks_make_room, &
                            chunks_take, particles_number_bins, particles_t
  use sgmp_rows, only: key_k, row_key, rows_contains, rows_from_points, rows_t, rows_union
  use sgmp_sorting, only: sort_order, sort_order_within
  implicit none
  private
  public :: arrivals_t, particles_rebin, particles_renew_bins
  public :: particles_find_bins, particles_extend_bins, particles_close_lists, &
            particles_receive, particles_receive_rest

  !> Movers that come into a range of bins, ordered by bin, in each by id.
  type :: arrivals_t
    integer :: n = 0
    integer, allocatable :: list(:), at(:)  !! (n) list of each, and its place in there
    integer, allocatable :: bin(:)          !! (n) its bin
    integer :: first = 1                    !! from which on they are inserted
    integer :: owned = 0                    !! of these, those that are now particles of this rank
    integer, allocatable :: chunk(:)        !! chunks that their bins need beside those they have
    logical :: waiting = .false.            !! there was no room for those chunks
  end type arrivals_t

  integer, parameter :: prefetch_ahead = 6  !! movers
  integer, parameter :: few = 512   !! movers, or rows, that are not worth a meeting of threads

contains

  !> Moves particles to the bins of their new positions; the bins that they have left are closed.
  !!
  !! Those that go to other ranks leave. The same as the procedures below in their order, which
  !! threads may share: all have their lists of movers and their ranges of bins.
  subroutine particles_rebin(particles, lists, lower, upper, arrivals, new_bins)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: lists(:)    !! in: row they left; out: new rows and bins
    real(dp), intent(in) :: lower(3), upper(3)   !! particles outside this box (cells) are removed
    type(arrivals_t), intent(inout) :: arrivals(:)  !! those with a bin now, bins ascending
    logical, intent(out) :: new_bins             !! the set of bins has changed
    integer :: t, bins(3)
    do t = 1, size(lists)
      call particles_find_bins(particles, lower, upper, lists(t))
    end do
    new_bins = any(lists%without_bin)
    if (new_bins) call particles_extend_bins(particles, lists, lower, upper)
    call particles_close_lists(particles, lists)
    do t = 1, size(arrivals)
      bins(2) = 1 + int(size(particles%size, kind=i8)*(t - 1)/size(arrivals))
      bins(3) = int(size(particles%size, kind=i8)*t/size(arrivals))
      bins(1) = bins(2)
      call particles_receive(particles, lists, bins, arrivals(t))
    end do
    call particles_receive_rest(particles, lists, arrivals)
  end subroutine particles_rebin

  !> Row and bin of each mover, and which have left the grid. Those that go to another rank are
  !! given a bin where one is held for them, so that what they give to the grid can be added here.
  pure subroutine particles_find_bins(particles, lower, upper, movers)
    type(particles_t), intent(in) :: particles
    real(dp), intent(in) :: lower(3), upper(3)   !! of the grid (cells)
    type(movers_t), intent(inout) :: movers
    integer :: m, bin(3), d
    d = particles%ndim
    movers%without_bin = .false.
    do m = 1, movers%n
      movers%bin(m) = 0
      if (movers%eroded(m)) cycle
      ! What is not a number is nowhere.
      movers%gone(m) = .not. all(movers%particle(:d, m) >= lower(:d) .and. &
                                 movers%particle(:d, m) <= upper(:d))
      if (movers%gone(m)) cycle
      bin = bin_of_mover(particles, movers%particle(:, m))
      if (.not. within(bin(3), particles%held)) cycle
      movers%row(m) = row_near(particles%bins, movers%row(m), row_key(bin(2), bin(3)), bin(1))
      if (movers%row(m) > 0) then
        movers%bin(m) = particles%bin_start(movers%row(m)) + bin(1)
      else
        movers%without_bin = .true.
      end if
    end do
  end subroutine particles_find_bins

  !> Bin coordinates of a particle by its columns.
  pure function bin_of_mover(particles, columns) result(bin)
    type(particles_t), intent(in) :: particles
    real(dp), intent(in) :: columns(:)           !! motion, then state
    integer :: bin(3), first
    first = 1
    if (particles%reference > 0) first = particles%motion_columns + particles%reference
    bin = bin_coordinates(particles, columns(first:))
  end function bin_of_mover

  pure function within(number, range) result(yes)
    integer, intent(in) :: number, range(2)
    logical :: yes
    yes = number >= range(1) .and. number <= range(2)
  end function within

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

  !> Takes back the chunks that movers have left empty, forgets the movers, and notes between which
  !! bins those of a list come.
  pure subroutine particles_close_lists(particles, lists)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: lists(:)
    integer :: t
    do t = 1, size(lists)
      associate (movers => lists(t))
        movers%bins = [minval(movers%bin(:movers%n)), maxval(movers%bin(:movers%n))]
      end associate
      call chunks_give_back(particles, lists(t)%chunk(:lists(t)%freed))
      lists(t)%freed = 0
      particles%count = particles%count - count(lists(t)%here(:lists(t)%n))
    end do
  end subroutine particles_close_lists

  !> Puts movers into bins(2)..bins(3), and lists those that come into bins(1)..bins(3). Threads do
  !! that at the same time, each with bins(2)..bins(3) of its own.
  subroutine particles_receive(particles, lists, bins, arrivals)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(in) :: lists(:)
    integer, intent(in) :: bins(3)
    type(arrivals_t), intent(out) :: arrivals
    logical :: room
    call sort_arrivals(particles, lists, bins([1, 3]), arrivals)
    do while (arrivals%first <= arrivals%n)
      if (arrivals%bin(arrivals%first) >= bins(2)) exit
      arrivals%first = arrivals%first + 1
    end do
    call count_chunks(particles, lists, arrivals)
    !$omp critical (taking_chunks)
    call chunks_take(particles, arrivals%chunk, room)
    !$omp end critical (taking_chunks)
    arrivals%waiting = .not. room
    if (room) call insert_arrivals(particles, lists, arrivals)
  end subroutine particles_receive

  !> Puts movers into bins for which there was no room, and counts all that have come.
  pure subroutine particles_receive_rest(particles, lists, arrivals)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(in) :: lists(:)
    type(arrivals_t), intent(inout) :: arrivals(:)
    logical :: room
    integer :: t
    do t = 1, size(arrivals)
      particles%count = particles%count + arrivals(t)%owned
      if (.not. arrivals(t)%waiting) cycle
      call chunks_make_room(particles, size(arrivals(t)%chunk))
      call chunks_take(particles, arrivals(t)%chunk, room)
      if (room) call insert_arrivals(particles, lists, arrivals(t))
      arrivals(t)%waiting = .false.
    end do
  end subroutine particles_receive_rest

  !> Sorts the movers that come into a range of bins.
  pure subroutine sort_arrivals(particles, lists, range, arrivals)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: lists(:)
    integer, intent(in) :: range(2)
    type(arrivals_t), intent(inout) :: arrivals
    integer(i8), allocatable :: id(:), bin(:), path(:)
    integer, allocatable :: by_id(:), by_bin(:)
    logical :: comes(size(lists))                ! some mover of the list may
    integer :: t, m, n
    n = 0
    do t = 1, size(lists)
      comes(t) = lists(t)%n > 0
      if (comes(t)) comes(t) = lists(t)%bins(1) <= range(2) .and. lists(t)%bins(2) >= range(1)
      if (.not. comes(t)) cycle
      do m = 1, lists(t)%n
        if (within(lists(t)%bin(m), range)) n = n + 1
      end do
    end do
    arrivals%n = n
    allocate (arrivals%list(n), arrivals%at(n), id(n), bin(n), by_id(n), by_bin(n))
    n = 0
    do t = 1, size(lists)
      if (.not. comes(t)) cycle
      do m = 1, lists(t)%n
        if (.not. within(lists(t)%bin(m), range)) cycle
        n = n + 1
        arrivals%list(n) = t
        arrivals%at(n) = m
        id(n) = lists(t)%id(m)
        bin(n) = lists(t)%bin(m) - range(1)
      end do
    end do
    if (particles%path == 0) then
      call sort_order(id - minval(id), by_id)
    else
      path = [(nint(lists(arrivals%list(m))%particle( &
                    particles%motion_columns + particles%path, arrivals%at(m)), i8), m=1, n)]
      call sort_order_within(id - minval(id), path, by_id)
    end if
    call sort_order(bin(by_id), by_bin)
    by_bin = by_id(by_bin)
    arrivals%list = arrivals%list(by_bin)
    arrivals%at = arrivals%at(by_bin)
    arrivals%bin = range(1) + int(bin(by_bin))
  end subroutine sort_arrivals

  !> Counts the chunks that bins need for their arrivals.
  pure subroutine count_chunks(particles, lists, arrivals)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: lists(:)
    type(arrivals_t), intent(inout) :: arrivals
    integer :: r, r2, wanted, n
    wanted = 0
    r = arrivals%first
    do while (r <= arrivals%n)
      r2 = last_of_bin(arrivals, r)
      if (owned(particles, lists, arrivals, r)) then
        n = particles%size(arrivals%bin(r))
        wanted = wanted + (n + (r2 - r + 1) + lanes - 1)/lanes - (n + lanes - 1)/lanes
        arrivals%owned = arrivals%owned + (r2 - r + 1)
      end if
      r = r2 + 1
    end do
    allocate (arrivals%chunk(wanted))
  end subroutine count_chunks

  !> Last of the arrivals that have the bin of arrival r.
  pure function last_of_bin(arrivals, r) result(last)
    type(arrivals_t), intent(in) :: arrivals
    integer, intent(in) :: r
    integer :: last
    last = r
    do while (last < arrivals%n)
      if (arrivals%bin(last + 1) /= arrivals%bin(r)) return
      last = last + 1
    end do
  end function last_of_bin

  !> Whether arrival r comes into a plane of this rank.
  pure function owned(particles, lists, arrivals, r) result(yes)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: lists(:)
    type(arrivals_t), intent(in) :: arrivals
    integer, intent(in) :: r
    logical :: yes
    yes = within(key_k(particles%bins%key(lists(arrivals%list(r))%row(arrivals%at(r)))), &
                 particles%own)
  end function owned

  !> Merges arrivals with the particles of their bins.
  pure subroutine insert_arrivals(particles, lists, arrivals)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(in) :: lists(:)
    type(arrivals_t), intent(in) :: arrivals
    integer :: r, r2, used
    used = 0
    r = arrivals%first
    do while (r <= arrivals%n)
      r2 = last_of_bin(arrivals, r)
      if (owned(particles, lists, arrivals, r)) then
        associate (ahead => arrivals%bin(min(r2 + prefetch_ahead, arrivals%n)))
          if (particles%scattered) call chunk_prefetch(particles, particles%first(ahead), .true.)
        end associate
        call bin_insert(particles, arrivals%bin(r), lists, arrivals%list(r:r2), &
                        arrivals%at(r:r2), arrivals%chunk, used)
      end if
      r = r2 + 1
    end do
  end subroutine insert_arrivals

  !> Adds the bins that movers need; drops the empty ones where they are more than an eighth.
  subroutine particles_extend_bins(particles, lists, lower, upper)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: lists(:)
    real(dp), intent(in) :: lower(3), upper(3)   !! see particles_find_bins
    type(rows_t) :: wanted, kept
    integer :: t
    call wanted_bins(particles, lists, wanted)
    if (8*empty_bins(particles) > size(particles%size)) then
      call occupied_bins(particles, .true., kept)
    else
      kept = particles%bins
    end if
    call change_bins(particles, kept, wanted)
    !$omp parallel do schedule(dynamic) if(sum(lists%n) > few) default(none) &
    !$omp& shared(particles, lower, upper, lists)
    do t = 1, size(lists)
      call particles_find_bins(particles, lower, upper, lists(t))
    end do
    !$omp end parallel do
  end subroutine particles_extend_bins

  !> Renews the bins that stand for other ranks': `others` instead of all that are outside the own
  !! planes; own ones that are empty go, too.
  subroutine particles_renew_bins(particles, others)
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
  subroutine change_bins(particles, kept, more)
    type(particles_t), intent(inout) :: particles
    type(rows_t), intent(in) :: kept, more
    type(rows_t) :: old
    integer, allocatable :: old_start(:), old_first(:), old_size(:)
    integer :: s, i, to
    old = particles%bins
    call move_alloc(particles%bin_start, old_start)
    call move_alloc(particles%first, old_first)
    call move_alloc(particles%size, old_size)
    call rows_union(kept, more, particles%bins)
    call particles_number_bins(particles)
    !$omp parallel do schedule(static) if(old%n > few) default(none) &
    !$omp& shared(particles, old, old_start, old_first, old_size) private(i, to)
    do s = 1, old%n
      do i = old%first(s), old%last(s)
        if (old_size(old_start(s) + i) == 0) cycle
        to = bin_from(particles, old%key(s), i)
        particles%first(to) = old_first(old_start(s) + i)
        particles%size(to) = old_size(old_start(s) + i)
      end do
    end do
    !$omp end parallel do
  end subroutine change_bins

  !> Bin at point i of row `key`, which must exist.
  pure function bin_from(particles, key, i) result(bin)
    type(particles_t), intent(in) :: particles
    integer(i8), intent(in) :: key
    integer, intent(in) :: i
    integer :: bin
    bin = i + particles%bin_start(rows_contains(particles%bins, key, i))
  end function bin_from

  !> The bins that movers need and that do not exist or are empty.
  subroutine wanted_bins(particles, lists, wanted)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: lists(:)
    type(rows_t), intent(out) :: wanted
    integer, allocatable :: order(:), i(:)
    integer(i8), allocatable :: key(:), sortable(:)
    integer :: t, m, n, at(size(lists))  ! at: places of the list, before those that are wanted
    n = 0
    do t = 1, size(lists)
      at(t) = n
      n = n + lists(t)%n
    end do
    allocate (i(n), key(n), sortable(n))
    !$omp parallel do schedule(dynamic) if(n > few) default(none) &
    !$omp& shared(particles, lists, at, i, key)
    do t = 1, size(lists)
      call list_wanted(particles, lists(t), at(t), i, key)
    end do
    !$omp end parallel do
    n = 0
    do m = 1, size(i)
      if (i(m) == huge(i)) cycle
      n = n + 1
      i(n) = i(m)
      key(n) = key(m)
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

  !> Bins that the movers of a list need, behind place `at`; those that need none have i = huge.
  pure subroutine list_wanted(particles, movers, at, i, key)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: at
    integer, intent(inout) :: i(:)
    integer(i8), intent(inout) :: key(:)
    integer :: m, bin(3)
    do m = 1, movers%n
      i(at + m) = huge(i)
      if (.not. wants_bin(particles, movers, m)) cycle
      bin = bin_of_mover(particles, movers%particle(:, m))
      i(at + m) = bin(1)
      key(at + m) = row_key(bin(2), bin(3))
    end do
  end subroutine list_wanted

  !> Whether a mover needs a bin that does not exist or is empty.
  pure function wants_bin(particles, movers, m) result(yes)
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: m
    logical :: yes
    integer :: bin(3)
    yes = .not. movers%gone(m)
    if (.not. yes) return
    if (movers%bin(m) > 0) then
      yes = particles%size(movers%bin(m)) == 0
    else
      bin = bin_of_mover(particles, movers%particle(:, m))
      yes = within(bin(3), particles%held)
    end if
  end function wants_bin

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
