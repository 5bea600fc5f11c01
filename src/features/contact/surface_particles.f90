!> The particles at the surface of a body, around the nodes that it shares with others: packed, so
!! that contact reads each of them once per step from its bin, however many nodes look at it.
!!
!! Bins come in the order of their rows (by plane, row, place) and particles in the order of their
!! ids, so the particles of neighbouring bins of a row, and those of a plane, follow each other.
!! Bins of planes that belong to other ranks hold guests: copies of the particles that those ranks
!! have there, in the same order.
module sgmp_surface_particles
  use sgmp_body, only: body_t
  use sgmp_buffer, only: buffer_get, buffer_put, buffer_t, buffer_take, buffer_whole
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_motion, only: motion_mass
  use sgmp_particles, only: bin_of_cell, bins_of_cells, particles_t
  use sgmp_rows, only: key_j, key_k, row_key, rows_contains, rows_intersection, rows_points, rows_t
  implicit none
  private
  public :: surface_t, surface_list, surface_count, surface_pack, surface_bins
  public :: surface_covered
  public :: surface_write, surface_read, surface_forget_guests, surface_columns

  real(dp), parameter :: nowhere = -1.0_dp  !! offsets below are no surface particle's
  !> Offset of a particle inside its body, which becomes one if it comes to lie bare.
  real(dp), parameter :: surface_covered = -1.0e3_dp

  !> Surface particles by bin.
  type :: surface_t
    integer :: bins = 0
    integer :: span = 1                   !! cells of a bin, along its row
    logical :: counted = .false.          !! `count` of the own bins is that of the particles
    integer :: own(2) = [1, 0]            !! first and last bin in planes of this rank
    type(rows_t) :: rows                  !! the bins, as rows
    integer, allocatable :: row_start(:)  !! (rows%n) bin i of a row has number row_start + i here
    integer, allocatable :: bin(:)        !! (bins) number among all bins of the body
    integer, allocatable :: count(:)      !! (bins) surface particles of each
    integer, allocatable :: start(:)      !! (bins + 1) first particle of each bin
    real(dp), allocatable :: x(:, :)
      !! (particles + lanes or more, 4) position (cells; 0 along axes that do not exist), surface
      !! offset
    logical, allocatable :: marked(:)     !! (bins) to be sent to another rank
    integer, allocatable :: guest_first(:), guest_size(:)  !! (bins) guests of each
    integer :: guests = 0
    real(dp), allocatable :: guest(:, :)
      !! (surface_columns, guests or more) position, surface offset, and where the kernel needs them
      !! mass and half-sizes
  end type surface_t

  integer, parameter :: few = 2048             !! bins that are not worth a meeting of threads

contains

  !> Lists the bins of a body that have cells in a set of rows; no particles yet.
  pure subroutine surface_list(surface, particles, around)
    type(surface_t), intent(inout) :: surface
    type(particles_t), intent(in) :: particles
    type(rows_t), intent(in) :: around     !! cells
    type(rows_t) :: bins
    integer :: s, t, i, n
    surface%counted = .false.
    surface%guests = 0
    surface%span = particles%span
    call bins_of_cells(particles%span, around, bins)
    call rows_intersection(particles%bins, bins, surface%rows)
    surface%bins = int(rows_points(surface%rows))
    if (allocated(surface%bin)) then
      deallocate (surface%bin, surface%count, surface%start, surface%row_start)
      deallocate (surface%marked, surface%guest_first, surface%guest_size)
    end if
    allocate (surface%bin(surface%bins), surface%row_start(surface%rows%n))
    allocate (surface%count(surface%bins), surface%guest_first(surface%bins), &
              surface%guest_size(surface%bins), source=0)
    allocate (surface%start(surface%bins + 1), source=1)
    allocate (surface%marked(surface%bins), source=.false.)
    if (.not. allocated(surface%x)) allocate (surface%x(0, 4))
    surface%own = [1, 0]
    n = 0
    t = 1
    do s = 1, surface%rows%n
      do while (particles%bins%key(t) /= surface%rows%key(s) .or. &
                particles%bins%last(t) < surface%rows%first(s))
        t = t + 1
      end do
      surface%row_start(s) = n + 1 - surface%rows%first(s)
      do i = surface%rows%first(s), surface%rows%last(s)
        n = n + 1
        surface%bin(n) = particles%bin_start(t) + i
      end do
      if (key_k(surface%rows%key(s)) < particles%own(1)) surface%own = [n + 1, n]
      if (key_k(surface%rows%key(s)) <= particles%own(2)) surface%own(2) = n
    end do
  end subroutine surface_list

  !> First and last bin here of those that the cells from `first_cell` to `last_cell` of a row lie
  !! in, an empty range if there are none. Asked again for the same row with a larger `first_cell`,
  !! it goes on from where it was.
  pure subroutine surface_bins(surface, key, first_cell, last_cell, place, range)
    type(surface_t), intent(in) :: surface
    integer(i8), intent(in) :: key         !! of the row
    integer, intent(in) :: first_cell, last_cell
    integer, intent(inout) :: place
      !! interval that it was found in; 0 for a row that has not been asked for
    integer, intent(out) :: range(2)
    integer :: s, high, middle, first, last
    range = [1, 0]
    first = bin_of_cell(surface%span, first_cell)
    last = bin_of_cell(surface%span, last_cell)
    if (place == 0) then
      place = 1
      high = surface%rows%n
      do while (place <= high)
        middle = (place + high)/2
        if (surface%rows%key(middle) < key) then
          place = middle + 1
        else
          high = middle - 1
        end if
      end do
    end if
    do while (place <= surface%rows%n)
      if (surface%rows%key(place) /= key .or. surface%rows%last(place) >= first) exit
      place = place + 1
    end do
    do s = place, surface%rows%n
      if (surface%rows%key(s) /= key .or. surface%rows%first(s) > last) exit
      if (s == place) range(1) = surface%row_start(s) + max(first, surface%rows%first(s))
      range(2) = surface%row_start(s) + min(last, surface%rows%last(s))
    end do
  end subroutine surface_bins

  !> Counts the surface particles of the own bins.
  subroutine surface_count(surface, particles, moved, column, threads)
    type(surface_t), intent(inout) :: surface
    type(particles_t), intent(in) :: particles
    logical, intent(in) :: moved           !! particles have changed bins since the last time
    integer, intent(in) :: column          !! of the surface offset among the particles' data
    integer, intent(in) :: threads
    integer :: n
    if (surface%bins == 0 .or. (surface%counted .and. .not. moved)) return
    !$omp parallel do num_threads(threads) if(threads > 1 .and. surface%bins > few) default(none) &
    !$omp& shared(surface, particles, column) private(n)
    do n = surface%own(1), surface%own(2)
      surface%count(n) = bin_count(particles, surface%bin(n), column)
    end do
    !$omp end parallel do
    surface%counted = .true.
  end subroutine surface_count

  !> Packs the surface particles of all listed bins, which must have been counted.
  subroutine surface_pack(surface, particles, column, threads)
    type(surface_t), intent(inout) :: surface
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: column          !! of the surface offset among the particles' data
    integer, intent(in) :: threads
    integer :: n
    if (surface%bins == 0) return
    call make_places(surface)
    !$omp parallel do num_threads(threads) if(threads > 1 .and. surface%bins > few) default(none) &
    !$omp& shared(surface, particles, column) private(n)
    do n = 1, surface%bins
      if (surface%count(n) == 0) cycle
      if (n < surface%own(1) .or. n > surface%own(2)) then
        call pack_guests(surface, n, particles%ndim)
      else
        call pack_bin(particles, surface%bin(n), column, surface%start(n), surface%x)
      end if
    end do
    !$omp end parallel do
  end subroutine surface_pack

  !> First particle of each bin, and room for all of them.
  pure subroutine make_places(surface)
    type(surface_t), intent(inout) :: surface
    integer :: n
    surface%start(1) = 1
    do n = 1, surface%bins
      surface%start(n + 1) = surface%start(n) + surface%count(n)
    end do
    n = surface%start(surface%bins + 1) - 1
    if (size(surface%x, 1) < n + lanes) then
      deallocate (surface%x)
      allocate (surface%x(n + n/8 + lanes, 4), source=0.0_dp)
    end if
  end subroutine make_places

  !> Surface particles in a bin.
  pure function bin_count(particles, bin, column) result(n)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin, column
    integer :: n, chunk
    n = 0
    chunk = particles%first(bin)
    do while (chunk > 0)
      n = n + count(particles%state(:, column, chunk) > nowhere)
      chunk = particles%next(chunk)
    end do
  end function bin_count

  !> Writes the surface particles of a bin from row `start` of the table on.
  pure subroutine pack_bin(particles, bin, column, start, x)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin, column, start
    real(dp), intent(inout) :: x(:, :)
    integer :: n, l, d, chunk
    n = start - 1
    chunk = particles%first(bin)
    do while (chunk > 0)
      do l = 1, lanes
        if (particles%state(l, column, chunk) <= nowhere) cycle
        n = n + 1
        do d = 1, particles%ndim
          x(n, d) = particles%motion(l, d, chunk)
        end do
        x(n, particles%ndim + 1:3) = 0.0_dp
        x(n, 4) = particles%state(l, column, chunk)
      end do
      chunk = particles%next(chunk)
    end do
  end subroutine pack_bin

  !> Writes the surface particles among the guests of a bin into the table.
  pure subroutine pack_guests(surface, bin, ndim)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: bin, ndim
    integer :: n, g
    n = surface%start(bin) - 1
    do g = surface%guest_first(bin), surface%guest_first(bin) + surface%guest_size(bin) - 1
      if (surface%guest(ndim + 1, g) <= nowhere) cycle
      n = n + 1
      surface%x(n, :ndim) = surface%guest(:ndim, g)
      surface%x(n, ndim + 1:3) = 0.0_dp
      surface%x(n, 4) = surface%guest(ndim + 1, g)
    end do
  end subroutine pack_guests

  !> Values of a guest: position and surface offset, and with `whole` mass and half-sizes.
  pure function surface_columns(ndim, whole) result(columns)
    integer, intent(in) :: ndim
    logical, intent(in) :: whole
    integer :: columns
    columns = ndim + 1 + merge(1 + ndim, 0, whole)
  end function surface_columns

  !> Appends the particles of the marked own bins to a message: the surface particles, or with
  !! `whole` all of them.
  pure subroutine surface_write(surface, body, whole, buffer)
    type(surface_t), intent(in) :: surface
    type(body_t), intent(in) :: body
    logical, intent(in) :: whole
    type(buffer_t), intent(inout) :: buffer
    integer :: s, i, n, particles, head
    call buffer_take(buffer, 1, head)
    head = head + 1
    buffer%values(head) = 0.0_dp
    do s = 1, surface%rows%n
      do i = surface%rows%first(s), surface%rows%last(s)
        n = surface%row_start(s) + i
        if (.not. surface%marked(n) .or. n < surface%own(1) .or. n > surface%own(2)) cycle
        particles = surface%count(n)
        if (whole) particles = body%particles%size(surface%bin(n))
        if (particles == 0) cycle
        buffer%values(head) = buffer%values(head) + 1.0_dp
        call buffer_put(buffer, real([key_j(surface%rows%key(s)), key_k(surface%rows%key(s)), i, &
                                      particles], dp))
        call write_bin(body, surface%bin(n), whole, buffer)
      end do
    end do
  end subroutine surface_write

  !> Appends the particles of one bin.
  pure subroutine write_bin(body, bin, whole, buffer)
    type(body_t), intent(in) :: body
    integer, intent(in) :: bin
    logical, intent(in) :: whole
    type(buffer_t), intent(inout) :: buffer
    real(dp) :: half(3)
    integer :: l, chunk, left
    associate (particles => body%particles, slots => body%law%slots)
      chunk = particles%first(bin)
      left = particles%size(bin)
      do while (left > 0)
        do l = 1, min(left, lanes)
          associate (n => particles%ndim, offset => particles%state(l, slots%surface, chunk))
            if (offset <= nowhere .and. .not. whole) cycle
            call buffer_put(buffer, [particles%motion(l, :n, chunk), offset])
            if (.not. whole) cycle
            half = body%half_size
            if (slots%stretch > 0) half(:n) = half(:n)* &
              particles%state(l, slots%stretch:slots%stretch + n - 1, chunk)
            call buffer_put(buffer, [particles%motion(l, motion_mass(n), chunk), half(:n)])
          end associate
        end do
        left = left - lanes
        chunk = particles%next(chunk)
      end do
    end associate
  end subroutine write_bin

  !> Forgets all guests.
  pure subroutine surface_forget_guests(surface)
    type(surface_t), intent(inout) :: surface
    surface%guests = 0
    if (surface%bins == 0) return
    surface%count(:surface%own(1) - 1) = 0
    surface%count(surface%own(2) + 1:) = 0
    surface%guest_size = 0
  end subroutine surface_forget_guests

  !> Takes what `surface_write` has written as guests; `complete` is false if a bin is not listed
  !! here.
  pure subroutine surface_read(surface, ndim, whole, buffer, complete)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: ndim
    logical, intent(in) :: whole
    type(buffer_t), intent(inout) :: buffer
    logical, intent(inout) :: complete
    integer :: bins, b, j, k, i, particles, s, n, g, columns
    columns = surface_columns(ndim, whole)
    call buffer_whole(buffer, bins)
    do b = 1, bins
      call buffer_whole(buffer, j)
      call buffer_whole(buffer, k)
      call buffer_whole(buffer, i)
      call buffer_whole(buffer, particles)
      s = 0
      if (surface%bins > 0) s = rows_contains(surface%rows, row_key(j, k), i)
      if (s == 0) then
        complete = .false.
        buffer%read = buffer%read + columns*particles
        cycle
      end if
      call make_room(surface, columns, surface%guests + particles)
      n = surface%row_start(s) + i
      surface%guest_first(n) = surface%guests + 1
      surface%guest_size(n) = particles
      do g = surface%guests + 1, surface%guests + particles
        call buffer_get(buffer, surface%guest(:, g))
      end do
      surface%guests = surface%guests + particles
      surface%count(n) = count(surface%guest(ndim + 1, surface%guest_first(n):surface%guests) &
                               > nowhere)
    end do
  end subroutine surface_read

  !> Room for guests; those that are there stay, all of as many columns.
  pure subroutine make_room(surface, columns, guests)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: columns, guests
    if (allocated(surface%guest)) then
      if (size(surface%guest, 1) /= columns) deallocate (surface%guest)
    end if
    if (.not. allocated(surface%guest)) allocate (surface%guest(columns, 0))
    call grow(surface%guest, surface%guests, guests)
  end subroutine make_room

end module sgmp_surface_particles
