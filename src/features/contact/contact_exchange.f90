!> What ranks tell their neighbours about contact near the cut: the particles around the nodes that
!! both solve, as far as bodies meet there.
!!
!! Both ranks hold the bodies' masses at those nodes and so agree, without a message, on whether
!! there is anything to tell.
module sgmp_contact_exchange
  use sgmp_body, only: body_t
  use sgmp_buffer, only: buffer_left, buffer_put, buffer_t, buffer_whole
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_t, neighbours_wait, &
                             traffic_t
  use sgmp_partition, only: partition_t
  use sgmp_shared_nodes, only: shared_mark, shared_nodes_t
  use sgmp_surface_particles, only: surface_forget_guests, surface_read, surface_write
  implicit none
  private
  public :: contact_exchange

contains

  !> Swaps particles with both neighbours. It must be known where bodies meet, and own particles
  !! must have been counted. `complete` is false if a rank has no place for what it is told.
  subroutine contact_exchange(shared, bodies, partition, messages, traffic, complete)
    type(shared_nodes_t), intent(inout) :: shared
    type(body_t), intent(in) :: bodies(:)
    type(partition_t), intent(in) :: partition
    type(neighbours_t), intent(inout) :: messages
    type(traffic_t), intent(inout) :: traffic
    logical, intent(out) :: complete
    logical :: sides(2)
    integer :: b
    complete = .true.
    if (partition%ranks == 1) return
    do b = 1, size(bodies)
      call surface_forget_guests(shared%surface(b))
    end do
    associate (own => partition%own, nodes => partition%nodes)
      call write_side(shared, bodies, own(1) + [0, nodes - 1], messages%to_below, sides(1))
      call write_side(shared, bodies, own(2) + [1, nodes], messages%to_above, sides(2))
    end associate
    if (.not. any(sides)) return
    call neighbours_send(messages, traffic, sides)
    call neighbours_receive(messages, sides)
    call read_side(shared, messages%from_below, complete)
    call read_side(shared, messages%from_above, complete)
    call neighbours_wait(messages)
  end subroutine contact_exchange

  !> Writes the message about the planes of nodes that this rank and one neighbour solve.
  subroutine write_side(shared, bodies, planes, buffer, any_meet)
    type(shared_nodes_t), intent(inout) :: shared
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: planes(2)             !! first and last k
    type(buffer_t), intent(inout) :: buffer
    logical, intent(out) :: any_meet             !! there is a message
    integer :: b
    call shared_mark(shared, planes, any_meet)
    if (.not. any_meet) return
    do b = 1, size(bodies)
      if (shared%surface(b)%bins == 0) cycle
      call buffer_put(buffer, [real(b, dp)])
      call surface_write(shared%surface(b), bodies(b), whole_particles(shared), buffer)
    end do
  end subroutine write_side

  !> Reads a message.
  subroutine read_side(shared, buffer, complete)
    type(shared_nodes_t), intent(inout) :: shared
    type(buffer_t), intent(inout) :: buffer
    logical, intent(inout) :: complete
    integer :: b
    do while (buffer_left(buffer))
      call buffer_whole(buffer, b)
      call surface_read(shared%surface(b), shared%ndim, whole_particles(shared), buffer, complete)
    end do
  end subroutine read_side

  !> Whether normals are taken from all particles around a node (Eq. 87) and not from centres.
  pure function whole_particles(shared) result(yes)
    type(shared_nodes_t), intent(in) :: shared
    logical :: yes
    yes = .not. kernel_centred(shared%kernel)
  end function whole_particles

end module sgmp_contact_exchange
