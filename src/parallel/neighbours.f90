!> Messages between a rank and those below and above it.
module sgmp_neighbours
  use mpi_f08, only: mpi_double_precision, mpi_get_count, mpi_isend, mpi_probe, mpi_recv, &
                     mpi_request, mpi_status, mpi_status_ignore, mpi_wait
  use sgmp_buffer, only: buffer_t
  use sgmp_kinds, only: dp, i8
  use sgmp_parallel, only: parallel_communicator, parallel_rank, parallel_ranks
  implicit none
  private
  public :: neighbours_t, neighbours_send, neighbours_receive, neighbours_wait, neighbours_free
  public :: traffic_t

  !> What a rank has sent so far.
  type :: traffic_t
    integer(i8) :: messages = 0_i8, bytes = 0_i8
  end type traffic_t

  !> An exchange under way: messages to both sides, and those from there.
  type :: neighbours_t
    type(buffer_t) :: to_below, to_above, from_below, from_above
    type(mpi_request) :: request(2)
    logical :: open(2) = .false.
  end type neighbours_t

contains

  !> Forgets the messages of the last exchange.
  subroutine neighbours_free(messages)
    type(neighbours_t), intent(inout) :: messages
    messages%to_below%n = 0
    messages%to_above%n = 0
    messages%from_below%n = 0
    messages%from_above%n = 0
  end subroutine neighbours_free

  !> Sends what has been written for both sides; the buffers must not be touched before
  !! `neighbours_wait`.
  subroutine neighbours_send(messages, traffic, sides)
    type(neighbours_t), intent(inout), target, asynchronous :: messages
    type(traffic_t), intent(inout) :: traffic
    logical, intent(in), optional :: sides(2)  !! below, above: as the ranks there see it, too;
                                               !! absent: both
    logical :: there(2)
    there = sides_with_ranks(sides)
    if (there(1)) then
      call send(messages%to_below, parallel_rank() - 1, messages%request(1), messages%open(1), &
                traffic)
    end if
    if (there(2)) then
      call send(messages%to_above, parallel_rank() + 1, messages%request(2), messages%open(2), &
                traffic)
    end if
  end subroutine neighbours_send

  subroutine send(buffer, rank, request, open, traffic)
    type(buffer_t), intent(inout), target, asynchronous :: buffer
    integer, intent(in) :: rank
    type(mpi_request), intent(out) :: request
    logical, intent(out) :: open
    type(traffic_t), intent(inout) :: traffic
    if (.not. allocated(buffer%values)) allocate (buffer%values(1))
    call mpi_isend(buffer%values, buffer%n, mpi_double_precision, rank, 0, &
                   parallel_communicator(), request)
    open = .true.
    traffic%messages = traffic%messages + 1_i8
    traffic%bytes = traffic%bytes + int(storage_size(1.0_dp)/8, i8)*buffer%n
  end subroutine send

  !> Sides on which there is a rank, among those asked for.
  function sides_with_ranks(sides) result(there)
    logical, intent(in), optional :: sides(2)
    logical :: there(2)
    there = [parallel_rank() > 0, parallel_rank() < parallel_ranks() - 1]
    if (present(sides)) there = there .and. sides
  end function sides_with_ranks

  !> Receives what the neighbours sent; nothing from where there is none.
  subroutine neighbours_receive(messages, sides)
    type(neighbours_t), intent(inout) :: messages
    logical, intent(in), optional :: sides(2)  !! see neighbours_send
    logical :: there(2)
    there = sides_with_ranks(sides)
    messages%from_below%n = 0
    messages%from_above%n = 0
    messages%from_below%read = 0
    messages%from_above%read = 0
    if (there(1)) call receive(messages%from_below, parallel_rank() - 1)
    if (there(2)) call receive(messages%from_above, parallel_rank() + 1)
  end subroutine neighbours_receive

  subroutine receive(buffer, rank)
    type(buffer_t), intent(inout) :: buffer
    integer, intent(in) :: rank
    type(mpi_status) :: status
    call mpi_probe(rank, 0, parallel_communicator(), status)
    call mpi_get_count(status, mpi_double_precision, buffer%n)
    if (allocated(buffer%values)) then
      if (size(buffer%values) < buffer%n) deallocate (buffer%values)
    end if
    if (.not. allocated(buffer%values)) allocate (buffer%values(max(buffer%n, 1)))
    call mpi_recv(buffer%values, buffer%n, mpi_double_precision, rank, 0, &
                  parallel_communicator(), mpi_status_ignore)
  end subroutine receive

  !> Waits until the messages sent may be written over.
  subroutine neighbours_wait(messages)
    type(neighbours_t), intent(inout), target, asynchronous :: messages
    integer :: side
    do side = 1, 2
      if (messages%open(side)) call mpi_wait(messages%request(side), mpi_status_ignore)
      messages%open(side) = .false.
    end do
    call neighbours_free(messages)
  end subroutine neighbours_wait

end module sgmp_neighbours
