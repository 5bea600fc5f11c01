!> Messages between a rank and those below and above it in a build without MPI: there are none.
module sgmp_neighbours
  use sgmp_buffer, only: buffer_t
  use sgmp_kinds, only: i8
  implicit none
  private
  public :: neighbours_t, neighbours_send, neighbours_receive, neighbours_wait, neighbours_free
  public :: traffic_t

  !> What a rank has sent so far.
  type :: traffic_t
    integer(i8) :: messages = 0_i8, bytes = 0_i8
  end type traffic_t

  !> An exchange under way.
  type :: neighbours_t
    type(buffer_t) :: to_below, to_above, from_below, from_above
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

  !> Nobody is there to send to.
  subroutine neighbours_send(messages, traffic, sides)
    type(neighbours_t), intent(inout), target :: messages
    type(traffic_t), intent(inout) :: traffic
    logical, intent(in), optional :: sides(2)
    associate (unused_messages => messages, unused_traffic => traffic, unused => present(sides))
    end associate
  end subroutine neighbours_send

  !> Nothing comes.
  subroutine neighbours_receive(messages, sides)
    type(neighbours_t), intent(inout) :: messages
    logical, intent(in), optional :: sides(2)
    associate (unused => present(sides))
    end associate
    messages%from_below%n = 0
    messages%from_above%n = 0
    messages%from_below%read = 0
    messages%from_above%read = 0
  end subroutine neighbours_receive

  !> Nothing is to be waited for.
  subroutine neighbours_wait(messages)
    type(neighbours_t), intent(inout), target :: messages
    call neighbours_free(messages)
  end subroutine neighbours_wait

end module sgmp_neighbours
