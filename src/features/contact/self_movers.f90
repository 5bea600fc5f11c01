!> Particles that get another label go from one twin of their body to another, with all that a
!! mover takes along.
module sgmp_self_movers
  use sgmp_body, only: body_t
  use sgmp_kinds, only: i8
  use sgmp_mesh, only: mesh_t
  use sgmp_movers, only: movers_add, movers_t
  use sgmp_patches, only: patch_label
  use sgmp_rebinning, only: particles_find_bins
  implicit none
  private
  public :: self_hand_over

contains

  !> Puts the movers of all slabs into the lists of the bodies that their labels belong to.
  pure subroutine self_hand_over(mesh, bodies, lists)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: bodies(:)
    type(movers_t), intent(inout) :: lists(:, :)   !! (bodies, slabs)
    integer :: b, s, to
    integer :: before(size(bodies))
    do s = 1, size(lists, 2)
      before = lists(:, s)%n
      do b = 1, size(bodies)
        if (bodies(b)%relabels) call hand_over(b, before(b), bodies, lists(:, s))
      end do
      do to = 1, size(bodies)
        if (.not. bodies(to)%relabels) cycle
        associate (particles => bodies(to)%particles)
          call particles_find_bins(particles, mesh%lower - particles%shift, &
                                   mesh%upper + particles%shift, lists(to, s))
        end associate
      end do
    end do
  end subroutine self_hand_over

  !> The same for the first movers of one body, in one slab.
  pure subroutine hand_over(b, n, bodies, lists)
    integer, intent(in) :: b, n                    !! the body; its movers
    type(body_t), intent(inout) :: bodies(:)
    type(movers_t), intent(inout) :: lists(:)      !! (bodies)
    integer :: m, label, to, kept, from
    from = merge(bodies(b)%twin_of, b, bodies(b)%twin_of > 0)
    kept = 0
    do m = 1, lists(b)%n
      to = b
      if (m <= n .and. .not. (lists(b)%eroded(m) .or. lists(b)%gone(m))) then
        label = patch_label(bodies(b)%labels, &
                            nint(lists(b)%particle(bodies(b)%particles%motion_columns + &
                                                   bodies(b)%law%slots%patch, m), i8))
        if (label /= bodies(b)%label) to = twin(bodies, from, label)
      end if
      if (to /= b) then
        call copy_mover(lists(b), m, lists(to))
        if (lists(b)%here(m)) bodies(b)%particles%count = bodies(b)%particles%count - 1
      else
        kept = kept + 1
        call move_up(lists(b), m, kept)
      end if
    end do
    lists(b)%n = kept
  end subroutine hand_over

  !> The twin of a body that has a label, itself included.
  pure function twin(bodies, from, label) result(to)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: from, label
    integer :: to
    do to = 1, size(bodies)
      if ((to == from .or. bodies(to)%twin_of == from) .and. bodies(to)%label == label) return
    end do
    to = from
  end function twin

  !> Appends a mover to the list of another body, as one that comes from no bin of it.
  pure subroutine copy_mover(list, m, other)
    type(movers_t), intent(in) :: list
    integer, intent(in) :: m
    type(movers_t), intent(inout) :: other
    call movers_add(other, list%id(m), .false., 1)
    other%gone(other%n) = .false.
    other%particle(:, other%n) = list%particle(:, m)
    other%values(:, other%n) = list%values(:, m)
  end subroutine copy_mover

  pure subroutine move_up(list, from, to)
    type(movers_t), intent(inout) :: list
    integer, intent(in) :: from, to
    if (from == to) return
    list%id(to) = list%id(from)
    list%here(to) = list%here(from)
    list%gone(to) = list%gone(from)
    list%eroded(to) = list%eroded(from)
    list%row(to) = list%row(from)
    list%bin(to) = list%bin(from)
    list%particle(:, to) = list%particle(:, from)
    list%values(:, to) = list%values(:, from)
  end subroutine move_up

end module sgmp_self_movers
