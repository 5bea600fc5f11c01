!> The states that pairs have at nodes, as a list: it carries them to a new layout of the fields, to
!! other ranks and into checkpoints.
module sgmp_contact_memory
  use sgmp_buffer, only: buffer_get, buffer_left, buffer_put, buffer_t
  use sgmp_contact_pairs, only: contact_pair_t, pair_turn
  use sgmp_contact_resolve, only: link_free
  use sgmp_kinds, only: dp
  use sgmp_parallel, only: parallel_gather
  use sgmp_shared_nodes, only: shared_nodes_t
  implicit none
  private
  public :: memory_take, memory_give, memory_share

  integer, parameter :: entry = 8          !! numbers: pair, node, state, normal
  integer, parameter :: entry_surface = 11  !! and the force of friction, where it acts there

contains

  !> Appends the states of the nodes in a range of planes.
  pure subroutine memory_take(memory, shared, planes)
    type(buffer_t), intent(inout) :: memory
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: planes(2)       !! first and last k
    integer :: n, l
    do n = 1, shared%nodes
      if (shared%point(3, n) < planes(1)) cycle
      if (shared%point(3, n) > planes(2)) exit
      do l = shared%link_start(n), shared%link_start(n + 1) - 1
        associate (link => shared%link(l))
          if (link%state == link_free) cycle
          call buffer_put(memory, [real([shared%pair(l), shared%point(:, n), link%state], dp), &
                                   link%held_normal])
          if (shared%at_surface) call buffer_put(memory, link%drag)
        end associate
      end do
    end do
  end subroutine memory_take

  !> Gives the states to the nodes that are listed here, and forgets them. A pair that is not there
  !! any more, because particles have got another label, leaves its state to the next of its kind.
  pure subroutine memory_give(memory, shared, pairs)
    type(buffer_t), intent(inout) :: memory
    type(shared_nodes_t), intent(inout) :: shared
    type(contact_pair_t), intent(in) :: pairs(:)  !! all, or none where no body touches itself
    real(dp) :: values(merge(entry_surface, entry, shared%at_surface))
    integer :: n, l, p
    memory%read = 0
    do while (buffer_left(memory))
      call buffer_get(memory, values)
      n = node_at(shared, nint(values(2:4)))
      if (n == 0) cycle
      p = nint(values(1))
      if (p <= size(pairs) .and. &
          all(shared%pair(shared%link_start(n):shared%link_start(n + 1) - 1) /= p)) then
        do l = shared%link_start(n), shared%link_start(n + 1) - 1
          if (shared%link(l)%state /= link_free) cycle
          if (pair_turn(pairs(p), pairs(shared%pair(l))) == 0) cycle
          shared%link(l)%state = nint(values(5))
          shared%link(l)%held_normal = pair_turn(pairs(p), pairs(shared%pair(l)))*values(6:8)
        end do
      end if
      do l = shared%link_start(n), shared%link_start(n + 1) - 1
        if (shared%pair(l) /= p) cycle
        shared%link(l)%state = nint(values(5))
        shared%link(l)%held_normal = values(6:8)
        if (shared%at_surface) shared%link(l)%drag = values(9:11)
      end do
    end do
    memory%n = 0
    memory%read = 0
  end subroutine memory_give

  !> The states of all nodes of all ranks, on every rank.
  subroutine memory_share(memory, shared, own)
    type(buffer_t), intent(inout) :: memory
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: own(2)          !! planes of this rank
    real(dp), allocatable :: all(:)
    memory%n = 0
    if (.not. allocated(memory%values)) allocate (memory%values(0))
    call memory_take(memory, shared, own)
    call parallel_gather(memory%values(:memory%n), all)
    memory%n = size(all)
    call move_alloc(all, memory%values)
  end subroutine memory_share

  !> The node at a point, 0 if it is not listed.
  pure function node_at(shared, point) result(n)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: point(3)
    integer :: n, low, high
    low = 1
    high = shared%nodes
    do while (low <= high)
      n = (low + high)/2
      if (all(shared%point(:, n) == point)) return
      if (lies_before(shared%point(:, n), point)) then
        low = n + 1
      else
        high = n - 1
      end if
    end do
    n = 0
  end function node_at

  !> The order of the nodes: by plane, row, place.
  pure function lies_before(a, b) result(yes)
    integer, intent(in) :: a(3), b(3)
    logical :: yes
    yes = a(1) < b(1)
    if (a(2) /= b(2)) yes = a(2) < b(2)
    if (a(3) /= b(3)) yes = a(3) < b(3)
  end function lies_before

end module sgmp_contact_memory
