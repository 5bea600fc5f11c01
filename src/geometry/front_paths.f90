!> First arrival of a front that runs through a region with a speed of its own at every place, round
!! whatever is in its way: the eikonal equation |grad t| = 1/speed, solved along paths.
!!
!! The region is given at the points of a lattice. Every point keeps the place from which the front
!! reaches it straight: a source, or the point at which the path turns. Points are settled in the
!! order of their times (Dijkstra 1959); a neighbour first takes the turning point of the one before
!! it, and when its turn comes it is seen whether the straight way from there lies in the region; if
!! not, the path turns at a neighbour (Nash, Koenig and Tovey 2010, Lazy Theta*). Each time is that
!! of a path which exists, so no front is too early, and what a source sees has the time of the
!! straight line. Behind an obstacle times are late by less than two steps of the lattice;
!! differences of times on it (fast marching of second order) were off by three to four.
!!
!! Points of equal time are settled in the order of their numbers, so the result is the same on all
!! machines.
module sgmp_front_paths
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: front_source_t, front_t, front_never
  public :: front_arrival, front_lattice, front_place, front_solve, front_straight

  real(dp), parameter :: front_never = huge(1.0_dp)  !! time of what is not reached
  real(dp), parameter :: sample = 0.5_dp     !! steps between the places where a way is looked at
  real(dp), parameter :: ends = 0.75_dp      !! steps around its ends where it is not

  !> A point, or a plane through a point, from which a front starts.
  type :: front_source_t
    real(dp) :: point(3) = 0.0_dp                     !! (length)
    real(dp) :: time = 0.0_dp                         !! when it starts
    logical :: plane = .false.                        !! distance along `normal`, not from the point
    real(dp) :: normal(3) = [1.0_dp, 0.0_dp, 0.0_dp]  !! unit normal of the plane
  end type front_source_t

  !> A region on a lattice, and the times of a front in it.
  type :: front_t
    integer :: extent(3) = 1                 !! points along each axis
    real(dp) :: lower(3) = 0.0_dp            !! the first point (length)
    real(dp) :: step = 1.0_dp                !! between points
    type(front_source_t), allocatable :: sources(:)
    real(dp), allocatable :: speed(:)        !! (points), x first; 0: not in the region
    real(dp), allocatable :: time(:)         !! (points) front_never: not reached
    integer, allocatable :: from(:)          !! (points) where the last straight part of the path
                                             !! begins: a point, or minus a source
  end type front_t

  !> Points whose time is not yet settled, as a binary heap with the earliest on top.
  type :: heap_t
    integer :: n = 0
    integer, allocatable :: point(:)         !! (n)
    integer, allocatable :: place(:)         !! (points) in the heap; 0: not there
  end type heap_t

contains

  !> Lays a lattice over a box, with points in the middle of its cells.
  pure subroutine front_lattice(lower, upper, ndim, step, front)
    real(dp), intent(in) :: lower(3), upper(3)  !! corners of the box
    integer, intent(in) :: ndim
    real(dp), intent(in) :: step
    type(front_t), intent(out) :: front
    integer :: points
    front%step = step
    front%extent(:ndim) = max(1, ceiling((upper(:ndim) - lower(:ndim))/step))
    front%lower = 0.0_dp
    front%lower(:ndim) = 0.5_dp*(lower(:ndim) + upper(:ndim)) &
                         - 0.5_dp*step*(front%extent(:ndim) - 1)
    points = product(front%extent)
    allocate (front%speed(points), source=0.0_dp)
    allocate (front%time(points), source=front_never)
    allocate (front%from(points), source=0)
  end subroutine front_lattice

  !> Place of a point of the lattice.
  pure function front_place(front, p) result(place)
    type(front_t), intent(in) :: front
    integer, intent(in) :: p
    real(dp) :: place(3)
    integer :: n
    n = p - 1
    place = front%lower + front%step*[mod(n, front%extent(1)), &
                                      mod(n/front%extent(1), front%extent(2)), &
                                      n/(front%extent(1)*front%extent(2))]
  end function front_place

  !> Time at which a source's front arrives along the straight line.
  pure function front_straight(source, place, speed) result(time)
    type(front_source_t), intent(in) :: source
    real(dp), intent(in) :: place(3), speed
    real(dp) :: time
    if (source%plane) then
      time = source%time + abs(dot_product(place - source%point, source%normal))/speed
    else
      time = source%time + norm2(place - source%point)/speed
    end if
  end function front_straight

  !> The way of a source's front to a place, where nothing is in its way.
  pure function way_from(source, place) result(way)
    type(front_source_t), intent(in) :: source
    real(dp), intent(in) :: place(3)
    real(dp) :: way(3)
    way = place - source%point
    if (source%plane) way = dot_product(way, source%normal)*source%normal
  end function way_from

  !> Times at all points of the region, from the sources and speeds.
  pure subroutine front_solve(front)
    type(front_t), intent(inout) :: front
    type(heap_t) :: heap
    logical, allocatable :: settled(:)
    real(dp) :: time
    integer :: p, from
    allocate (heap%point(size(front%time)))
    allocate (heap%place(size(front%time)), source=0)
    allocate (settled(size(front%time)), source=.false.)
    call begin_at_sources(front, heap)
    do while (heap%n > 0)
      p = heap%point(1)
      if (.not. sees(front, front%from(p), front_place(front, p), front%speed(p))) then
        call around(front, settled, p, time, from)
        front%from(p) = from
        front%time(p) = time
        call heap_sink(heap, front%time, 1)
        if (heap%point(1) /= p) cycle        ! another one is earlier now
      end if
      call heap_drop(heap, front%time)
      settled(p) = .true.
      call tell_neighbours(front, settled, p, heap)
    end do
  end subroutine front_solve

  !> Points that a source lights: those it is in, or if it lies outside, the nearest of the region.
  pure subroutine begin_at_sources(front, heap)
    type(front_t), intent(inout) :: front
    type(heap_t), intent(inout) :: heap
    real(dp) :: nearest, time
    integer :: k, p
    do k = 1, size(front%sources)
      nearest = huge(1.0_dp)
      do p = 1, size(front%speed)
        if (front%speed(p) > 0.0_dp) nearest = min(nearest, distance_to(front, k, p))
      end do
      do p = 1, size(front%speed)
        if (front%speed(p) <= 0.0_dp) cycle
        if (distance_to(front, k, p) > nearest + front%step) cycle
        time = front_straight(front%sources(k), front_place(front, p), front%speed(p))
        if (time >= front%time(p)) cycle
        front%time(p) = time
        front%from(p) = -k
        call heap_put(heap, front%time, p)
      end do
    end do
  end subroutine begin_at_sources

  !> Distance of a point from a source.
  pure function distance_to(front, k, p) result(distance)
    type(front_t), intent(in) :: front
    integer, intent(in) :: k, p
    real(dp) :: distance
    distance = norm2(way_from(front%sources(k), front_place(front, p)))
  end function distance_to

  !> Offers the neighbours of a settled point the straight way from where its own begins, and where
  !! the front changes its speed, that from the point.
  pure subroutine tell_neighbours(front, settled, p, heap)
    type(front_t), intent(inout) :: front
    logical, intent(in) :: settled(:)
    integer, intent(in) :: p
    type(heap_t), intent(inout) :: heap
    real(dp) :: time
    integer :: way, q, from
    do way = 0, 26
      q = neighbour(front%extent, p, way)
      if (q == 0) cycle
      if (settled(q) .or. front%speed(q) <= 0.0_dp) cycle
      from = merge(p, front%from(p), abs(front%speed(q) - front%speed(p)) > 0.0_dp)
      time = straight_time(front, from, front_place(front, q), front%speed(q))
      if (time >= front%time(q)) cycle
      front%time(q) = time
      front%from(q) = from
      call heap_put(heap, front%time, q)
    end do
  end subroutine tell_neighbours

  !> The earliest way to a point that is not seen from where it was expected to be: straight from
  !! where the way to one of its settled neighbours begins, or from the neighbour itself.
  pure subroutine around(front, settled, p, time, from)
    type(front_t), intent(in) :: front
    logical, intent(in) :: settled(:)
    integer, intent(in) :: p
    real(dp), intent(out) :: time
    integer, intent(out) :: from
    real(dp) :: place(3), other
    integer :: way, q, known
    place = front_place(front, p)
    time = front_never
    from = 0
    known = front%from(p)                    ! does not see it
    do way = 0, 26
      q = neighbour(front%extent, p, way)
      if (q == 0) cycle
      if (.not. settled(q)) cycle
      other = straight_time(front, q, place, front%speed(p))
      if (other < time) then
        time = other
        from = q
      end if
      if (front%from(q) == known) cycle
      other = straight_time(front, front%from(q), place, front%speed(p))
      if (other >= time) cycle
      if (.not. sees(front, front%from(q), place, front%speed(p))) cycle
      time = other
      from = front%from(q)
    end do
  end subroutine around

  !> Time along the straight line from a point or, if negative, from a source.
  pure function straight_time(front, from, place, speed) result(time)
    type(front_t), intent(in) :: front
    integer, intent(in) :: from
    real(dp), intent(in) :: place(3), speed
    real(dp) :: time
    if (from < 0) then
      time = front_straight(front%sources(-from), place, speed)
    else
      time = front%time(from) + norm2(place - front_place(front, from))/speed
    end if
  end function straight_time

  !> Whether the straight way to a place lies in the region and has one speed. A source may lie
  !! outside: then the way leads into the region and does not leave it again.
  pure function sees(front, from, place, speed) result(yes)
    type(front_t), intent(in) :: front
    integer, intent(in) :: from
    real(dp), intent(in) :: place(3), speed
    logical :: yes
    real(dp) :: way(3), distance, there
    integer :: i, n
    logical :: outside
    if (from < 0) then
      way = -way_from(front%sources(-from), place)
    else
      way = front_place(front, from) - place
    end if
    distance = norm2(way)
    n = int(distance/(sample*front%step))
    outside = .false.
    yes = .true.
    do i = 1, n
      if (min(i*sample, distance/front%step - i*sample) < ends) cycle
      there = speed_at(front, place + way*(i*sample*front%step/distance))
      if (there <= 0.0_dp .and. from < 0) then
        outside = .true.
      else if (outside .or. abs(there - speed) > 0.0_dp) then
        yes = .false.
        return
      end if
    end do
  end function sees

  !> Speed at the lattice point next to a place; 0 beyond the lattice.
  pure function speed_at(front, place) result(speed)
    type(front_t), intent(in) :: front
    real(dp), intent(in) :: place(3)
    real(dp) :: speed
    integer :: at(3)
    at = nint((place - front%lower)/front%step)
    speed = 0.0_dp
    if (any(at < 0 .or. at >= front%extent)) return
    speed = front%speed(number_of(front%extent, at))
  end function speed_at

  !> Number of a point from its places along the axes, counted from 0.
  pure function number_of(extent, at) result(p)
    integer, intent(in) :: extent(3), at(3)
    integer :: p
    p = 1 + at(1) + extent(1)*(at(2) + extent(2)*at(3))
  end function number_of

  !> Time at any place of the region: the earliest by the ways of the points around it.
  pure function front_arrival(front, place, speed) result(time)
    type(front_t), intent(in) :: front
    real(dp), intent(in) :: place(3), speed
    real(dp) :: time
    real(dp) :: other
    integer :: at(3), p, q, way, from
    at = nint((place - front%lower)/front%step)
    p = number_of(front%extent, max(0, min(at, front%extent - 1)))
    time = front_never
    do way = 0, 26
      q = p
      if (way /= 13) q = neighbour(front%extent, p, way)
      if (q == 0) cycle
      if (front%time(q) >= front_never) cycle
      from = front%from(q)
      other = straight_time(front, from, place, speed)
      if (other >= time) cycle
      if (.not. sees(front, from, place, speed)) then
        other = straight_time(front, q, place, speed)
        if (other >= time) cycle
      end if
      time = other
    end do
  end function front_arrival

  !> One of the 26 points around another; 0: it is not there. `way` 13 is the point itself.
  pure function neighbour(extent, p, way) result(q)
    integer, intent(in) :: extent(3), p, way
    integer :: q
    integer :: at(3)
    q = 0
    if (way == 13) return
    at = [mod(p - 1, extent(1)), mod((p - 1)/extent(1), extent(2)), (p - 1)/(extent(1)*extent(2))]
    at = at + [mod(way, 3), mod(way/3, 3), way/9] - 1
    if (all(at >= 0 .and. at < extent)) q = number_of(extent, at)
  end function neighbour

  !> Puts a point into the heap, or moves it up if its time has become earlier.
  pure subroutine heap_put(heap, time, p)
    type(heap_t), intent(inout) :: heap
    real(dp), intent(in) :: time(:)
    integer, intent(in) :: p
    integer :: i
    if (heap%place(p) == 0) then
      heap%n = heap%n + 1
      heap%point(heap%n) = p
      heap%place(p) = heap%n
    end if
    i = heap%place(p)
    do while (i > 1)
      if (.not. before(time, heap%point(i), heap%point(i/2))) exit
      call exchange(heap, i, i/2)
      i = i/2
    end do
  end subroutine heap_put

  !> Takes the first point out of the heap.
  pure subroutine heap_drop(heap, time)
    type(heap_t), intent(inout) :: heap
    real(dp), intent(in) :: time(:)
    call exchange(heap, 1, heap%n)
    heap%place(heap%point(heap%n)) = 0
    heap%n = heap%n - 1
    call heap_sink(heap, time, 1)
  end subroutine heap_drop

  !> Moves what is too high in the heap down.
  pure subroutine heap_sink(heap, time, start)
    type(heap_t), intent(inout) :: heap
    real(dp), intent(in) :: time(:)
    integer, intent(in) :: start
    integer :: i, child
    i = start
    do while (2*i <= heap%n)
      child = 2*i
      if (child < heap%n) then
        if (before(time, heap%point(child + 1), heap%point(child))) child = child + 1
      end if
      if (.not. before(time, heap%point(child), heap%point(i))) exit
      call exchange(heap, i, child)
      i = child
    end do
  end subroutine heap_sink

  !> Whether a point comes before another.
  pure function before(time, p, q) result(yes)
    real(dp), intent(in) :: time(:)
    integer, intent(in) :: p, q
    logical :: yes
    yes = time(p) < time(q) .or. (time(p) <= time(q) .and. p < q)
  end function before

  !> Exchanges two places of the heap.
  pure subroutine exchange(heap, i, j)
    type(heap_t), intent(inout) :: heap
    integer, intent(in) :: i, j
    heap%point([i, j]) = heap%point([j, i])
    heap%place(heap%point([i, j])) = [i, j]
  end subroutine exchange

end module sgmp_front_paths
