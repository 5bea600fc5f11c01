!> What contact did in a step: impulses of the pairs, dissipation, changes of the step's sums.
!!
!! Every rank sums over the nodes of its own planes, plane by plane; the sums of all planes are
!! added in the order of the planes, so that nothing depends on who owns them.
module sgmp_contact_ledger
  use sgmp_body, only: body_t
  use sgmp_buffer, only: buffer_put, buffer_t
  use sgmp_columns, only: node_acceleration, node_inverse_mass, node_velocity
  use sgmp_contact, only: contact_t
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_contact_resolve, only: contact_link_t
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_parallel, only: parallel_gather
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: contact_add_up, contact_close, contact_sums_t

  !> Those sums of a step that contact changes.
  type :: contact_sums_t
    real(dp) :: dissipation = 0.0_dp       !! energy that contact took (friction, impact)
    real(dp) :: rigid_work = 0.0_dp        !! work of rigid bodies on the others
    real(dp) :: nodes_aa = 0.0_dp, power_before = 0.0_dp, external_power = 0.0_dp
  end type contact_sums_t

  !> Sums over the nodes of one plane for one pair.
  type :: terms_t
    logical :: used = .false.
    integer :: shared = 0, touching = 0    !! nodes
    real(dp) :: impulse(3) = 0.0_dp        !! on the first body
    real(dp) :: angular_impulse(3) = 0.0_dp
    real(dp) :: dissipation = 0.0_dp
    ! changes of the step's sums; what belongs to no single pair is with the node's first one
    real(dp) :: rigid_work = 0.0_dp, nodes_aa = 0.0_dp, power_before = 0.0_dp
    real(dp) :: external_power = 0.0_dp
  end type terms_t

  integer, parameter :: entry = 14         !! numbers of an entry: the terms and their pair

contains

  !> Adds up the terms of the nodes of the own planes.
  subroutine contact_add_up(contact, mesh, fields, bodies, own, gravity, dt)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: own(2)          !! first and last plane of this rank
    real(dp), intent(in) :: gravity(3)
    real(dp), intent(in) :: dt             !! velocity step dt^k
    type(terms_t) :: table(size(contact%pairs))
    integer :: n, p, plane
    do n = 1, contact%shared%nodes
      plane = contact%shared%point(3, n)
      if (plane < own(1)) cycle
      if (plane > own(2)) exit
      call add_node(contact, n, mesh, fields, bodies, gravity, dt, table)
      if (n < contact%shared%nodes) then
        if (contact%shared%point(3, n + 1) == plane) cycle
      end if
      do p = 1, size(table)
        if (.not. table(p)%used) cycle
        call write_terms(table(p), p, contact%terms)
        table(p) = terms_t()
      end do
    end do
  end subroutine contact_add_up

  pure subroutine write_terms(terms, pair, buffer)
    type(terms_t), intent(in) :: terms
    integer, intent(in) :: pair
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, [real([pair, terms%shared, terms%touching], dp), &
                             terms%impulse, terms%angular_impulse, terms%dissipation, &
                             terms%rigid_work, terms%nodes_aa, terms%power_before, &
                             terms%external_power])
  end subroutine write_terms

  !> Adds what contact did at one node.
  subroutine add_node(contact, n, mesh, fields, bodies, gravity, dt, table)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: n
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: gravity(3), dt
    type(terms_t), intent(inout) :: table(:)   !! (pairs)
    real(dp), dimension(3, contact%shared%member_start(n + 1) - &
                        contact%shared%member_start(n)) :: gained, middle
    real(dp) :: position(3)
    integer :: l, k, m, nd, first
    nd = mesh%ndim
    first = 0
    do l = contact%shared%link_start(n), contact%shared%link_start(n + 1) - 1
      if (.not. contact%shared%meets(l)) cycle
      associate (terms => table(contact%shared%pair(l)))
        terms%used = .true.
        terms%shared = terms%shared + 1
      end associate
      if (contact%shared%link(l)%normal_impulse <= 0.0_dp) cycle
      if (first == 0) first = contact%shared%pair(l)
    end do
    if (first == 0) return
    position = 0.0_dp
    position(:nd) = real(contact%shared%point([1, merge(3, 2, nd == 2), 3], n), dp)
    position(:nd) = mesh%origin(:nd) + mesh%h*position(:nd)
    gained = 0.0_dp
    middle = 0.0_dp
    do k = 1, size(gained, 2)
      m = contact%shared%member_start(n) + k - 1
      associate (node => fields(contact%shared%field(m))%node, i => contact%shared%record(m))
        middle(:nd, k) = node(i, node_velocity(nd):node_velocity(nd) + nd - 1)
        if (bodies(contact%shared%body(m))%rigid) cycle
        middle(:nd, k) = middle(:nd, k) - &
          0.5_dp*dt*node(i, node_acceleration:node_acceleration + nd - 1)
      end associate
    end do
    do l = contact%shared%link_start(n), contact%shared%link_start(n + 1) - 1
      if (contact%shared%link(l)%normal_impulse <= 0.0_dp) cycle
      associate (pair => contact%shared%pair(l))
        call add_link(bodies(contact%pairs(pair)%body)%rigid, contact%shared%link(l), position, &
                      middle, gained, table(pair))
      end associate
    end do
    do k = 1, size(gained, 2)
      m = contact%shared%member_start(n) + k - 1
      if (bodies(contact%shared%body(m))%rigid) cycle
      call add_member(fields(contact%shared%field(m)), contact%shared%record(m), &
                      contact%shared%point(:, n), gravity, gained(:nd, k), middle(:nd, k), dt, &
                      table(first))
    end do
  end subroutine add_node

  !> Adds the impulse of one link.
  pure subroutine add_link(rigid, link, position, middle, gained, terms)
    logical, intent(in) :: rigid(2)              !! which bodies of the pair are
    type(contact_link_t), intent(in) :: link
    real(dp), intent(in) :: position(3)          !! of the node
    real(dp), intent(in) :: middle(:, :)         !! (3, members) velocity at the middle of the step
    real(dp), intent(inout) :: gained(:, :)      !! (3, members) momentum from contact
    type(terms_t), intent(inout) :: terms
    real(dp) :: impulse(3)
    impulse = link%normal_impulse*link%normal + link%tangent_impulse
    gained(:, link%first) = gained(:, link%first) - impulse
    gained(:, link%second) = gained(:, link%second) + impulse
    terms%touching = terms%touching + 1
    terms%impulse = terms%impulse - impulse
    terms%angular_impulse = terms%angular_impulse - cross(position, impulse)
    terms%dissipation = terms%dissipation + &
                          dot_product(impulse, middle(:, link%first) - middle(:, link%second))
    if (rigid(1)) then
      terms%rigid_work = terms%rigid_work + dot_product(impulse, middle(:, link%first))
    end if
    if (rigid(2)) then
      terms%rigid_work = terms%rigid_work - dot_product(impulse, middle(:, link%second))
    end if
  end subroutine add_link

  !> What a contact impulse adds to the sums that were taken before contact.
  pure subroutine add_member(field, record, point, gravity, gained, middle, dt, terms)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, point(3)
    real(dp), intent(in) :: gravity(3), gained(:), middle(:), dt
    type(terms_t), intent(inout) :: terms
    real(dp) :: change(size(gained)), acceleration(size(gained)), inverse
    inverse = field%node(record, node_inverse_mass(field%ndim))
    if (inverse <= 0.0_dp) return
    change = gained*inverse/dt
    acceleration = field%node(record, node_acceleration:node_velocity(field%ndim) - 1)
    terms%nodes_aa = terms%nodes_aa + dot_product(gained/dt, 2.0_dp*acceleration - change)
    terms%power_before = terms%power_before + &
                           dot_product(gained/dt, middle - 0.5_dp*dt*acceleration)
    terms%external_power = terms%external_power + 0.5_dp*dt* &
      dot_product(change, gravity(:field%ndim)/inverse + body_force(field, record, point))
  end subroutine add_member

  !> Adds the terms of all ranks to the pairs and to the sums of the step.
  subroutine contact_close(contact, anywhere, sums)
    type(contact_t), intent(inout) :: contact
    logical, intent(in) :: anywhere        !! some rank has terms
    type(contact_sums_t), intent(inout) :: sums  !! added to
    real(dp), allocatable :: all(:)
    integer :: p, e
    do p = 1, size(contact%pairs)
      contact%pairs(p)%shared = 0
      contact%pairs(p)%touching = 0
    end do
    if (.not. anywhere) return
    if (.not. allocated(contact%terms%values)) allocate (contact%terms%values(0))
    call parallel_gather(contact%terms%values(:contact%terms%n), all)  ! ranks own ascending planes
    do e = 1, size(all), entry
      call add_entry(contact%pairs(nint(all(e))), sums, all(e:e + entry - 1))
    end do
    contact%terms%n = 0
  end subroutine contact_close

  !> Adds the terms of one plane and pair.
  pure subroutine add_entry(pair, sums, values)
    type(contact_pair_t), intent(inout) :: pair
    type(contact_sums_t), intent(inout) :: sums
    real(dp), intent(in) :: values(entry)
    pair%shared = pair%shared + nint(values(2))
    pair%touching = pair%touching + nint(values(3))
    pair%impulse = pair%impulse + values(4:6)
    pair%angular_impulse = pair%angular_impulse + values(7:9)
    pair%dissipation = pair%dissipation + values(10)
    sums%dissipation = sums%dissipation + values(10)
    sums%rigid_work = sums%rigid_work + values(11)
    sums%nodes_aa = sums%nodes_aa + values(12)
    sums%power_before = sums%power_before + values(13)
    sums%external_power = sums%external_power + values(14)
  end subroutine add_entry

  !> Body force at a node, as the momentum equation takes it from the moments.
  pure function body_force(field, record, point) result(force)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, point(3)
    real(dp) :: force(field%ndim)
    integer :: column, last, j, k, base
    force = 0.0_dp
    column = field%columns%external
    if (column == 0) return
    last = column + field%ndim - 1
    if (.not. kernel_centred(field%kernel)) then
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

end module sgmp_contact_ledger
