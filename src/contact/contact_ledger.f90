!> What contact did in a step: impulses of the pairs, dissipation, changes of the step's sums.
!!
!! Every rank sums over the nodes of its own planes, plane by plane; the sums of all planes are
!! added in the order of the planes, so that nothing depends on who owns them.
module sgmp_contact_ledger
  use sgmp_buffer, only: buffer_put, buffer_t
  use sgmp_contact, only: contact_link_t
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: kernel_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_gather
  implicit none
  private
  public :: contact_book, contact_close

  !> Sums over the nodes of one plane for one pair.
  type :: booking_t
    logical :: used = .false.
    integer :: shared = 0, touching = 0    !! nodes
    real(dp) :: impulse(3) = 0.0_dp        !! on the first body
    real(dp) :: angular_impulse(3) = 0.0_dp
    real(dp) :: dissipation = 0.0_dp
    ! changes of the step's sums; what belongs to no single pair is with the node's first one
    real(dp) :: rigid_work = 0.0_dp, nodes_aa = 0.0_dp, power_before = 0.0_dp
    real(dp) :: external_power = 0.0_dp
  end type booking_t

  integer, parameter :: entry = 14         !! numbers of a booking, with its pair

contains

  !> Books the nodes of the own planes.
  subroutine contact_book(model, dt)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt             !! velocity step dt^k
    type(booking_t) :: table(size(model%pairs))
    integer :: n, p, plane
    do n = 1, model%shared%nodes
      plane = model%shared%point(3, n)
      if (plane < model%partition%own(1)) cycle
      if (plane > model%partition%own(2)) exit
      call book_node(model, n, dt, table)
      if (n < model%shared%nodes) then
        if (model%shared%point(3, n + 1) == plane) cycle
      end if
      do p = 1, size(table)
        if (.not. table(p)%used) cycle
        call write_booking(table(p), p, model%booked)
        table(p) = booking_t()
      end do
    end do
  end subroutine contact_book

  pure subroutine write_booking(booking, pair, buffer)
    type(booking_t), intent(in) :: booking
    integer, intent(in) :: pair
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, [real([pair, booking%shared, booking%touching], dp), &
                             booking%impulse, booking%angular_impulse, booking%dissipation, &
                             booking%rigid_work, booking%nodes_aa, booking%power_before, &
                             booking%external_power])
  end subroutine write_booking

  !> Books what contact did at one node.
  subroutine book_node(model, n, dt, table)
    type(model_t), intent(in) :: model
    integer, intent(in) :: n
    real(dp), intent(in) :: dt
    type(booking_t), intent(inout) :: table(:)   !! (pairs)
    real(dp), dimension(3, model%shared%member_start(n + 1) - &
                        model%shared%member_start(n)) :: gained, middle
    real(dp) :: position(3)
    integer :: l, k, m, nd, first
    nd = model%mesh%ndim
    first = 0
    do l = model%shared%link_start(n), model%shared%link_start(n + 1) - 1
      if (.not. model%shared%meets(l)) cycle
      associate (booking => table(model%shared%pair(l)))
        booking%used = .true.
        booking%shared = booking%shared + 1
      end associate
      if (model%shared%link(l)%normal_impulse <= 0.0_dp) cycle
      if (first == 0) first = model%shared%pair(l)
    end do
    if (first == 0) return
    position = 0.0_dp
    position(:nd) = real(model%shared%point([1, merge(3, 2, nd == 2), 3], n), dp)
    position(:nd) = model%mesh%origin(:nd) + model%mesh%h*position(:nd)
    gained = 0.0_dp
    middle = 0.0_dp
    do k = 1, size(gained, 2)
      m = model%shared%member_start(n) + k - 1
      associate (node => model%fields(model%shared%field(m))%node, i => model%shared%record(m))
        middle(:nd, k) = node(i, nd + 1:2*nd) - 0.5_dp*dt*node(i, 1:nd)
        if (model%bodies(model%shared%body(m))%rigid) middle(:nd, k) = node(i, nd + 1:2*nd)
      end associate
    end do
    do l = model%shared%link_start(n), model%shared%link_start(n + 1) - 1
      if (model%shared%link(l)%normal_impulse <= 0.0_dp) cycle
      associate (pair => model%shared%pair(l))
        call book_link(model, model%shared%link(l), model%pairs(pair)%body, position, middle, &
                       gained, table(pair))
      end associate
    end do
    do k = 1, size(gained, 2)
      m = model%shared%member_start(n) + k - 1
      if (model%bodies(model%shared%body(m))%rigid) cycle
      call book_member(model, model%fields(model%shared%field(m)), model%shared%record(m), &
                       model%shared%point(:, n), gained(:nd, k), middle(:nd, k), dt, table(first))
    end do
  end subroutine book_node

  !> Books the impulse of one link.
  pure subroutine book_link(model, link, body, position, middle, gained, booking)
    type(model_t), intent(in) :: model
    type(contact_link_t), intent(in) :: link
    integer, intent(in) :: body(2)               !! of the pair
    real(dp), intent(in) :: position(3)          !! of the node
    real(dp), intent(in) :: middle(:, :)         !! (3, members) velocity at the middle of the step
    real(dp), intent(inout) :: gained(:, :)      !! (3, members) momentum from contact
    type(booking_t), intent(inout) :: booking
    real(dp) :: impulse(3)
    impulse = link%normal_impulse*link%normal + link%tangent_impulse
    gained(:, link%first) = gained(:, link%first) - impulse
    gained(:, link%second) = gained(:, link%second) + impulse
    booking%touching = booking%touching + 1
    booking%impulse = booking%impulse - impulse
    booking%angular_impulse = booking%angular_impulse - cross(position, impulse)
    booking%dissipation = booking%dissipation + &
                          dot_product(impulse, middle(:, link%first) - middle(:, link%second))
    if (model%bodies(body(1))%rigid) then
      booking%rigid_work = booking%rigid_work + dot_product(impulse, middle(:, link%first))
    end if
    if (model%bodies(body(2))%rigid) then
      booking%rigid_work = booking%rigid_work - dot_product(impulse, middle(:, link%second))
    end if
  end subroutine book_link

  !> What a contact impulse adds to the sums that were taken before contact.
  pure subroutine book_member(model, field, record, point, gained, middle, dt, booking)
    type(model_t), intent(in) :: model
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, point(3)
    real(dp), intent(in) :: gained(:), middle(:), dt
    type(booking_t), intent(inout) :: booking
    real(dp) :: change(size(gained)), acceleration(size(gained)), inverse
    inverse = field%node(record, 2*field%ndim + 1)
    if (inverse <= 0.0_dp) return
    change = gained*inverse/dt
    acceleration = field%node(record, 1:field%ndim)
    booking%nodes_aa = booking%nodes_aa + dot_product(gained/dt, 2.0_dp*acceleration - change)
    booking%power_before = booking%power_before + &
                           dot_product(gained/dt, middle - 0.5_dp*dt*acceleration)
    booking%external_power = booking%external_power + 0.5_dp*dt* &
      dot_product(change, model%gravity(:field%ndim)/inverse + body_force(field, record, point))
  end subroutine book_member

  !> Adds the bookings of all ranks to the pairs and to the sums of the step.
  subroutine contact_close(model, anywhere)
    type(model_t), intent(inout) :: model
    logical, intent(in) :: anywhere        !! some rank has booked something
    real(dp), allocatable :: all(:)
    integer :: p, e
    do p = 1, size(model%pairs)
      model%pairs(p)%shared = 0
      model%pairs(p)%touching = 0
    end do
    if (.not. anywhere) return
    if (.not. allocated(model%booked%values)) allocate (model%booked%values(0))
    call parallel_gather(model%booked%values(:model%booked%n), all)  ! ranks own ascending planes
    do e = 1, size(all), entry
      call add_entry(model, all(e:e + entry - 1))
    end do
    model%booked%n = 0
  end subroutine contact_close

  !> Adds the booking of one plane and pair.
  subroutine add_entry(model, values)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: values(entry)
    associate (pair => model%pairs(nint(values(1))), sums => model%sums)
      pair%shared = pair%shared + nint(values(2))
      pair%touching = pair%touching + nint(values(3))
      pair%impulse = pair%impulse + values(4:6)
      pair%angular_impulse = pair%angular_impulse + values(7:9)
      pair%dissipation = pair%dissipation + values(10)
      sums%contact = sums%contact + values(10)
      sums%rigid_work = sums%rigid_work + values(11)
      sums%nodes_aa = sums%nodes_aa + values(12)
      sums%power_before = sums%power_before + values(13)
      sums%external_power = sums%external_power + values(14)
    end associate
  end subroutine add_entry

  !> Body force at a node, as the momentum equation takes it from the moments.
  pure function body_force(field, record, point) result(force)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, point(3)
    real(dp) :: force(field%ndim)
    integer :: column, last, j, k, base
    force = 0.0_dp
    column = 2 + field%ndim + field%spins + merge(field%ndim*(field%ndim + 1)/2, field%ndim, &
      field%kernel == kernel_sgmp)
    last = column + field%ndim - 1
    if (last > field%nmoment - merge(1, 0, field%volume_column > 0)) return
    if (field%kernel /= kernel_sgmp) then
      force = field%moment(record, column:last)
      return
    end if
    do k = point(3) - merge(1, 0, field%ndim >= 2), point(3)
      do j = point(2) - merge(1, 0, field%ndim == 3), point(2)
        base = field_base(field, j, k, point(1)) + point(1)
        force = force + (field%moment(base - 1, column:last) + field%moment(base, column:last))
      end do
    end do
    force = force*0.5_dp**field%ndim
  end function body_force

  pure function cross(a, b) result(c)
    real(dp), intent(in) :: a(3), b(3)
    real(dp) :: c(3)
    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

end module sgmp_contact_ledger
