!> What ranks tell their neighbours about the planes of a field near the cut.
!!
!! Messages describe themselves: each section names its plane and rows, so that ranks may store
!! different rows as long as every value that is not zero finds its place. Sums travel as they are
!! before the planes on both sides of the cut are joined, and both ranks join them by the rule that
!! joins the slabs of threads (`sweep_join`): what every node receives is one expression, whoever
!! works it out.
module sgmp_halo
  use sgmp_buffer, only: buffer_left, buffer_put, buffer_t, buffer_take, buffer_whole
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp, i8
  use sgmp_particles, only: particles_t
  use sgmp_partition, only: partition_t
  use sgmp_plan, only: workspace_t
  use sgmp_rows, only: key_j, key_k, row_key, rows_contains, rows_from_points, rows_t
  implicit none
  private
  public :: halo_own_planes, halo_planes, halo_write_below, halo_write_above, halo_read_sums
  public :: halo_put_bins, halo_get_bins
  public :: halo_put_moments, halo_put_nodes, halo_get_planes, halo_clear

  !> What a section holds: columns of the moments, columns of the nodes' values, or a layer (2, 3)
  !! of the sums before the planes are joined.
  integer, parameter :: section_moments = 1, section_nodes = -1

contains

  !> Stored planes p1..p2 whose k lies in a range; p2 = p1 - 1 where there are none.
  pure subroutine halo_planes(field, range, p1, p2)
    type(field_t), intent(in) :: field
    integer, intent(in) :: range(2)    !! first and last k
    integer, intent(out) :: p1, p2
    p1 = 1
    do while (p1 <= field%planes)
      if (field%plane_k(p1) >= range(1)) exit
      p1 = p1 + 1
    end do
    p2 = p1 - 1
    do while (p2 < field%planes)
      if (field%plane_k(p2 + 1) > range(2)) exit
      p2 = p2 + 1
    end do
  end subroutine halo_planes

  !> Stored planes that the rank owns.
  pure subroutine halo_own_planes(field, partition, p1, p2)
    type(field_t), intent(in) :: field
    type(partition_t), intent(in) :: partition
    integer, intent(out) :: p1, p2
    call halo_planes(field, partition%own, p1, p2)
  end subroutine halo_own_planes

  !> Writes the message of a sweep to the rank below: the first planes. In the slab that has them
  !! they must be complete but for what the rank below adds.
  pure subroutine halo_write_below(field, partition, columns, layers, first, buffer)
    type(field_t), intent(in) :: field
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: columns(2)            !! first and last column of the moments
    integer, intent(in) :: layers                !! planes that a particle gives to
    type(workspace_t), intent(in) :: first       !! workspace of the lowest slab
    type(buffer_t), intent(inout) :: buffer
    integer :: p, p1, p2
    if (partition%rank == 0) return
    call halo_own_planes(field, partition, p1, p2)
    if (p2 < p1) return
    do p = p1, p2
      if (field%plane_k(p) >= partition%own(1) + partition%moments(2)) exit
      call halo_put_moments(field, p, columns, buffer)
    end do
    if (layers == 3 .and. field%plane_k(p1) == partition%own(1)) then
      call put_layer(field, p1, 2, size(first%lead, 2), first%lead, buffer)
    end if
  end subroutine halo_write_below

  !> Writes the message of a sweep to the rank above: the last planes, and the layers that reach
  !! beyond them.
  pure subroutine halo_write_above(field, partition, columns, layers, last, buffer)
    type(field_t), intent(in) :: field
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: columns(2)            !! first and last column of the moments
    integer, intent(in) :: layers                !! planes that a particle gives to
    type(workspace_t), intent(in) :: last        !! workspace of the highest slab
    type(buffer_t), intent(inout) :: buffer
    integer :: p, p1, p2, layer
    if (partition%rank == partition%ranks - 1) return
    call halo_own_planes(field, partition, p1, p2)
    do p = p1, p2
      if (field%plane_k(p) > partition%own(2) - partition%moments(1)) then
        call halo_put_moments(field, p, columns, buffer)
      end if
      do layer = 2, layers
        if (field%plane_k(p) + layer - 1 <= partition%own(2)) cycle
        call put_layer(field, p, layer, size(last%planes, 2), &
                       last%planes(:, :, :, mod(p, layers) + 1), buffer)
      end do
    end do
  end subroutine halo_write_above

  !> Reads the messages of a sweep; planes of others hold what they sent, and zero elsewhere.
  pure subroutine halo_read_sums(field, partition, columns, layers, from_below, from_above, below, &
                                 above, complete)
    type(field_t), intent(inout) :: field
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: columns(2), layers
    type(buffer_t), intent(inout) :: from_below, from_above
    type(workspace_t), intent(inout) :: below    !! planes: of the slab below
    type(workspace_t), intent(inout) :: above    !! lead: of the first plane above
    logical, intent(out) :: complete             !! everything has found its place
    integer :: nq, p1, p2
    logical :: fine
    nq = columns(2) - columns(1) + 1
    call make_room(below, layers, nq, field%largest_plane)
    call make_room(above, layers, nq, field%largest_plane)
    call halo_own_planes(field, partition, p1, p2)
    call halo_clear(field, 1, p1 - 1, columns)
    call halo_clear(field, p2 + 1, field%planes, columns)
    call halo_get_planes(field, columns, below, from_below, complete)
    call halo_get_planes(field, columns, above, from_above, fine)
    complete = complete .and. fine
    above%lead = 0.0_dp
    if (p2 < field%planes) above%lead = above%planes(:, :, :, mod(p2 + 1, layers) + 1)
  end subroutine halo_read_sums

  !> A workspace's planes, all zero.
  pure subroutine make_room(work, layers, nq, largest)
    type(workspace_t), intent(inout) :: work
    integer, intent(in) :: layers, nq, largest
    if (allocated(work%planes)) then
      if (size(work%planes, 2) /= nq .or. size(work%planes, 3) /= largest) then
        deallocate (work%planes, work%lead)
      end if
    end if
    if (.not. allocated(work%planes)) then
      allocate (work%planes(layers, nq, largest, layers), work%lead(layers, nq, largest))
    end if
    work%planes = 0.0_dp
  end subroutine make_room

  !> Zeroes columns of the moments of planes p1..p2.
  pure subroutine halo_clear(field, p1, p2, columns)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: p1, p2, columns(2)
    if (p2 < p1) return
    field%moment(field%plane_start(p1):field%plane_start(p2 + 1) - 1, columns(1):columns(2)) = &
      0.0_dp
  end subroutine halo_clear

  !> Appends columns of the moments of one plane.
  pure subroutine halo_put_moments(field, p, columns, buffer)
    type(field_t), intent(in) :: field
    integer, intent(in) :: p, columns(2)
    type(buffer_t), intent(inout) :: buffer
    call put_columns(field, p, columns, field%moment, section_moments, buffer)
  end subroutine halo_put_moments

  !> Appends columns of the nodes' values of one plane.
  pure subroutine halo_put_nodes(field, p, columns, buffer)
    type(field_t), intent(in) :: field
    integer, intent(in) :: p, columns(2)
    type(buffer_t), intent(inout) :: buffer
    call put_columns(field, p, columns, field%node, section_nodes, buffer)
  end subroutine halo_put_nodes

  pure subroutine put_columns(field, p, columns, values, section, buffer)
    type(field_t), intent(in) :: field
    integer, intent(in) :: p, columns(2), section
    real(dp), intent(in) :: values(:, :)
    type(buffer_t), intent(inout) :: buffer
    integer :: s, q, n, to, from
    call put_head(field, p, section, columns(2) - columns(1) + 1, buffer)
    do s = field%plane_work(p), field%plane_work(p + 1) - 1
      call put_row(field, s, n, buffer)
      from = field%neighbour(0, 0, s) + field%work%first(s)
      do q = columns(1), columns(2)
        call buffer_take(buffer, n, to)
        buffer%values(to + 1:to + n) = values(from:from + n - 1, q)
      end do
    end do
  end subroutine put_columns

  !> Appends one layer of the sums of one plane.
  pure subroutine put_layer(field, p, layer, nq, planes, buffer)
    type(field_t), intent(in) :: field
    integer, intent(in) :: p, layer, nq
    real(dp), intent(in) :: planes(:, :, :)      !! (layers, nq, points of the plane)
    type(buffer_t), intent(inout) :: buffer
    integer :: s, q, n, to, from
    call put_head(field, p, layer, nq, buffer)
    do s = field%plane_work(p), field%plane_work(p + 1) - 1
      call put_row(field, s, n, buffer)
      from = field%neighbour(0, 0, s) + field%work%first(s) - field%plane_start(p) + 1
      do q = 1, nq
        call buffer_take(buffer, n, to)
        buffer%values(to + 1:to + n) = planes(layer, q, from:from + n - 1)
      end do
    end do
  end subroutine put_layer

  !> Starts a section: what it is, its plane, columns and rows.
  pure subroutine put_head(field, p, section, nq, buffer)
    type(field_t), intent(in) :: field
    integer, intent(in) :: p, section, nq
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, real([section, field%plane_k(p), nq, &
                                  field%plane_work(p + 1) - field%plane_work(p)], dp))
  end subroutine put_head

  !> Starts a row: its j, first point and number of points, which is returned.
  pure subroutine put_row(field, s, n, buffer)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s
    integer, intent(out) :: n
    type(buffer_t), intent(inout) :: buffer
    n = field%work%last(s) - field%work%first(s) + 1
    call buffer_put(buffer, real([key_j(field%work%key(s)), field%work%first(s), n], dp))
  end subroutine put_row

  !> Reads sections to the end of a message; `complete` is false if a value that is not zero has no
  !! place.
  pure subroutine halo_get_planes(field, columns, work, buffer, complete)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: columns(2)            !! those that sections of moments or nodes hold
    type(workspace_t), intent(inout) :: work     !! receives layers
    type(buffer_t), intent(inout) :: buffer
    logical, intent(out) :: complete
    integer :: section, k, nq, rows, row, p
    complete = .true.
    do while (buffer_left(buffer))
      call buffer_whole(buffer, section)
      call buffer_whole(buffer, k)
      call buffer_whole(buffer, nq)
      call buffer_whole(buffer, rows)
      p = plane_of(field, k)
      do row = 1, rows
        call get_row(field, section, p, k, nq, columns(1), work, buffer, complete)
      end do
    end do
  end subroutine halo_get_planes

  !> Stored plane of a k, 0: none.
  pure function plane_of(field, k) result(p)
    type(field_t), intent(in) :: field
    integer, intent(in) :: k
    integer :: p
    p = findloc(field%plane_k(:field%planes), k, 1)
  end function plane_of

  !> Reads one row, which may be stored here in several pieces, or not at all where it is zero.
  pure subroutine get_row(field, section, p, k, nq, column, work, buffer, complete)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: section, p, k, nq, column
    type(workspace_t), intent(inout) :: work
    type(buffer_t), intent(inout) :: buffer
    logical, intent(inout) :: complete
    integer :: head(3), j, i, n, s, q, at, from
    do q = 1, 3
      call buffer_whole(buffer, head(q))
    end do
    j = head(1)
    i = head(2)
    do while (i < head(2) + head(3))
      s = 0
      if (p > 0) s = rows_contains(field%store, row_key(j, k), i)
      n = 1
      if (s > 0) n = min(field%store%last(s), head(2) + head(3) - 1) - i + 1
      do q = 1, nq
        from = buffer%read + (q - 1)*head(3) + i - head(2) + 1
        associate (values => buffer%values(from:from + n - 1))
          if (s == 0) then
            complete = complete .and. all(abs(values) <= 0.0_dp)
            cycle
          end if
          at = field%base(s) + i
          select case (section)
          case (section_moments)
            field%moment(at:at + n - 1, column + q - 1) = values
          case (section_nodes)
            field%node(at:at + n - 1, column + q - 1) = values
          case default
            at = at - field%plane_start(p) + 1
            work%planes(section, q, at:at + n - 1, &
                        mod(p, size(work%planes, 1)) + 1) = values
          end select
        end associate
      end do
      i = i + n
    end do
    buffer%read = buffer%read + nq*head(3)
  end subroutine get_row

  !> Appends the rows of occupied bins of a body in a range of planes.
  pure subroutine halo_put_bins(particles, range, buffer)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: range(2)
    type(buffer_t), intent(inout) :: buffer
    integer :: s, i, k, head
    call buffer_take(buffer, 1, head)
    head = head + 1
    buffer%values(head) = 0.0_dp
    do s = 1, particles%bins%n
      k = key_k(particles%bins%key(s))
      if (k < range(1) .or. k > range(2)) cycle
      do i = particles%bins%first(s), particles%bins%last(s)
        if (particles%size(particles%bin_start(s) + i) == 0) cycle
        call buffer_put(buffer, real([key_j(particles%bins%key(s)), k, i], dp))
        buffer%values(head) = buffer%values(head) + 1.0_dp
      end do
    end do
  end subroutine halo_put_bins

  !> Reads them; none from an empty message.
  pure subroutine halo_get_bins(buffer, rows)
    type(buffer_t), intent(inout) :: buffer
    type(rows_t), intent(out) :: rows
    integer(i8), allocatable :: key(:)
    integer, allocatable :: i(:)
    integer :: n, m, bin(2)
    n = 0
    if (buffer_left(buffer)) call buffer_whole(buffer, n)
    allocate (key(n), i(n))
    do m = 1, n
      call buffer_whole(buffer, bin(1))
      call buffer_whole(buffer, bin(2))
      call buffer_whole(buffer, i(m))
      key(m) = row_key(bin(1), bin(2))
    end do
    call rows_from_points(key, i, rows)
  end subroutine halo_get_bins

end module sgmp_halo
