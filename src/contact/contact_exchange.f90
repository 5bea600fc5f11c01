!> What ranks tell their neighbours about contact near the cut: the particles around the nodes that
!! both solve, as far as bodies meet there.
!!
!! Both ranks hold the bodies' masses at those nodes and so agree, without a message, on whether
!! there is anything to tell.
module sgmp_contact_exchange
  use sgmp_buffer, only: buffer_left, buffer_put, buffer_t, buffer_whole
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_kernels, only: kernel_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_shared_nodes, only: shared_mark
  use sgmp_surface_particles, only: surface_forget_guests, surface_read, surface_write
  use sgmp_text, only: integer_text
  use sgmp_timers, only: phase_halo, timers_move, wall_time
  implicit none
  private
  public :: contact_exchange

contains

  !> Swaps particles with both neighbours. It must be known where bodies meet, and own particles
  !! must have been counted.
  subroutine contact_exchange(model)
    type(model_t), intent(inout) :: model
    logical :: sides(2), complete
    integer :: b
    real(dp) :: since
    if (model%partition%ranks == 1) return
    do b = 1, size(model%bodies)
      call surface_forget_guests(model%shared%surface(b))
    end do
    associate (own => model%partition%own, nodes => model%partition%nodes, swap => model%swap)
      call write_side(model, own(1) + [0, nodes - 1], swap%to_below, sides(1))
      call write_side(model, own(2) + [1, nodes], swap%to_above, sides(2))
      if (.not. any(sides)) return
      since = wall_time()
      call neighbours_send(swap, model%traffic, sides)
      call neighbours_receive(swap, sides)
      complete = .true.
      call read_side(model, swap%from_below, complete)
      call read_side(model, swap%from_above, complete)
      call neighbours_wait(swap)
    end associate
    if (.not. complete .and. .not. allocated(model%failure)) then
      call error_make(model%failure, exit_numerical, 'a rank has no place for particles of its '// &
                      'neighbour in step '//integer_text(model%clock%step + 1), &
                      'this is a fault of the program: report it')
    end if
    call timers_move(model%timers, phase_halo, since)
  end subroutine contact_exchange

  !> Writes the message about the planes of nodes that this rank and one neighbour solve.
  subroutine write_side(model, planes, buffer, any_meet)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: planes(2)             !! first and last k
    type(buffer_t), intent(inout) :: buffer
    logical, intent(out) :: any_meet             !! there is a message
    integer :: b
    call shared_mark(model%shared, planes, any_meet)
    if (.not. any_meet) return
    do b = 1, size(model%bodies)
      if (model%shared%surface(b)%bins == 0) cycle
      call buffer_put(buffer, [real(b, dp)])
      call surface_write(model%shared%surface(b), model%bodies(b), whole_particles(model), buffer)
    end do
  end subroutine write_side

  !> Reads a message.
  subroutine read_side(model, buffer, complete)
    type(model_t), intent(inout) :: model
    type(buffer_t), intent(inout) :: buffer
    logical, intent(inout) :: complete
    integer :: b
    do while (buffer_left(buffer))
      call buffer_whole(buffer, b)
      call surface_read(model%shared%surface(b), model%mesh%ndim, whole_particles(model), buffer, &
                        complete)
    end do
  end subroutine read_side

  !> Whether normals are taken from all particles around a node (Eq. 87) and not from centres.
  pure function whole_particles(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    yes = model%fields(1)%kernel /= kernel_sgmp
  end function whole_particles

end module sgmp_contact_exchange
