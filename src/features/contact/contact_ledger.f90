!> What contact did in a step: impulses of the pairs, energy taken, changes of the step's sums.
!!
!! Along with the impulse J that particles receive and the correction K of the velocity d that
!! strains them, contact takes the energy J . d - dt g . K from a pair, g its relative acceleration
!! by all other forces: dt f_ext . K/m of external work and dt K . A of the work of rigid bodies
!! belong to it (doc/contact.md).
!!
!! Every rank sums over the nodes of its own planes, plane by plane; the sums of all planes are
!! added in the order of the planes, so that nothing depends on who owns them.
module sgmp_contact_ledger
  use sgmp_body, only: body_t
  use sgmp_buffer, only: buffer_put, buffer_t
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_contact_resolve, only: link_closed, link_dissipation
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_parallel, only: parallel_gather
  use sgmp_shared_nodes, only: node_terms_t, shared_nodes_t, shared_place
  use sgmp_space, only: axes_in_output
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: body_force, contact_sums_t, ledger_kick, ledger_strain, ledger_add_up, ledger_close

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
    real(dp) :: rubbed(3) = 0.0_dp         !! the part of the impulse along the surfaces
    real(dp) :: dissipation = 0.0_dp
    type(node_terms_t) :: node             !! of all pairs: with the first one at the node
  end type terms_t

  integer, parameter :: entry = 17         !! numbers of an entry: the terms and their pair

contains

  !> What the impulses at a node change in the sums that were taken before contact.
  pure subroutine ledger_kick(shared, n, fields, inverse_mass, trial, kick, gained, dt, gravity, &
                              work_part)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: inverse_mass(:, :)   !! (3, members)
    real(dp), intent(in) :: trial(:, :)          !! (3, members) trial velocity
    real(dp), intent(in) :: kick(:, :)           !! (3, members) the part of it by forces
    real(dp), intent(in) :: gained(:, :)         !! (3, members) impulses on the members
    real(dp), intent(in) :: dt, gravity(3)
    real(dp), intent(in) :: work_part            !! see contact_step_t
    real(dp) :: got(3)
    integer :: k
    associate (terms => shared%terms(n))
      do k = 1, size(inverse_mass, 2)
        ! Along components that are prescribed whoever moves them takes it.
        got = merge(gained(:, k), 0.0_dp, inverse_mass(:, k) > 0.0_dp)
        if (all(abs(got) <= 0.0_dp)) cycle
        terms%nodes_aa = terms%nodes_aa + &
          dot_product(got, 2.0_dp*kick(:, k) + inverse_mass(:, k)*got)/dt**2
        terms%power_before = terms%power_before + &
                             dot_product(got, trial(:, k) - kick(:, k))/dt
        terms%external_power = terms%external_power + work_part*dot_product(got, &
          external(shared, n, k, fields, inverse_mass(:, k), gravity, .false.))
      end do
    end associate
  end subroutine ledger_kick

  !> What contact takes from the bodies at a node through one straining velocity.
  pure subroutine ledger_strain(shared, n, bodies, fields, inverse_mass, velocity, kick, part, &
                                gravity)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: inverse_mass(:, :)   !! (3, members)
    real(dp), intent(in) :: velocity(:, :)       !! (3, members) before it was made to obey
    real(dp), intent(in) :: kick(:, :)           !! (3, members) of rigid ones: change of velocity
    real(dp), intent(in) :: part                 !! of the strain that it makes
    real(dp), intent(in) :: gravity(3)
    real(dp), dimension(3, size(inverse_mass, 2)) :: gained, corrected
    logical :: yields(3)
    integer :: b, k, l, m
    gained = 0.0_dp
    corrected = 0.0_dp
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      associate (link => shared%link(l))
        link%dissipation = link%dissipation + part*link_dissipation(link, &
          velocity(:, link%first) - velocity(:, link%second))
        gained(:, link%first) = gained(:, link%first) - link%passed
        gained(:, link%second) = gained(:, link%second) + link%passed
        corrected(:, link%first) = corrected(:, link%first) - link%correction
        corrected(:, link%second) = corrected(:, link%second) + link%correction
      end associate
    end do
    associate (terms => shared%terms(n))
      do k = 1, size(inverse_mass, 2)
        m = shared%member_start(n) + k - 1
        b = shared%body(m)
        if (bodies(b)%rigid_motion%free) cycle  ! what it gives it loses
        if (bodies(b)%rigid) then
          terms%rigid_work = terms%rigid_work + part*(dot_product(corrected(:, k), kick(:, k)) &
                                                      - dot_product(gained(:, k), velocity(:, k)))
          cycle
        end if
        yields = inverse_mass(:, k) > 0.0_dp
        if (fields(shared%field(m))%columns%driven > 0) then
          shared%driven_work(:, m) = shared%driven_work(:, m) + part* &
            merge(0.0_dp, gained(:, k)*velocity(:, k) - corrected(:, k)*kick(:, k), yields)
        end if
        if (any(abs(corrected(:, k)) > 0.0_dp .and. yields)) then
          terms%external_power = terms%external_power + &
            part*dot_product(merge(corrected(:, k), 0.0_dp, yields), &
            external(shared, n, k, fields, inverse_mass(:, k), gravity, .true.))
        end if
      end do
    end associate
  end subroutine ledger_strain

  !> Acceleration of a member by gravity and body forces, and by forces on faces, whose work is
  !! booked on the particles.
  pure function external(shared, n, k, fields, inverse_mass, gravity, faces) result(acceleration)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, k
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: inverse_mass(3), gravity(3)
    logical, intent(in) :: faces
    real(dp) :: acceleration(3)
    integer :: m
    m = shared%member_start(n) + k - 1
    acceleration = gravity
    associate (nd => shared%ndim)
      acceleration(:nd) = acceleration(:nd) + inverse_mass(:nd)* &
        body_force(fields(shared%field(m)), shared%record(m), shared%point(:, n), faces)
    end associate
  end function external

  !> Body force at a node, and force on faces (without its levers), as the momentum equation takes
  !! them from the moments.
  pure function body_force(field, record, point, faces) result(force)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, point(3)
    logical, intent(in) :: faces
    real(dp) :: force(field%ndim)
    force = 0.0_dp
    if (field%columns%external > 0) force = at_node(field, record, point, field%columns%external)
    if (faces .and. field%columns%faces > 0) then
      force = force + at_node(field, record, point, field%columns%faces)
    end if
  end function body_force

  !> The same of one vector of the moments.
  pure function at_node(field, record, point, column) result(force)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, point(3), column
    real(dp) :: force(field%ndim)
    integer :: last, j, k, base
    force = 0.0_dp
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
  end function at_node

  !> Adds up what contact did at the nodes of the own planes.
  subroutine ledger_add_up(shared, mesh, own, pairs, buffer)
    type(shared_nodes_t), intent(in) :: shared
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: own(2)          !! first and last plane of this rank
    integer, intent(in) :: pairs
    type(buffer_t), intent(inout) :: buffer
    type(terms_t) :: table(pairs)
    integer :: n, p, plane
    do n = 1, shared%nodes
      plane = shared%point(3, n)
      if (plane < own(1)) cycle
      if (plane > own(2)) exit
      call add_node(shared, n, mesh, table)
      if (n < shared%nodes) then
        if (shared%point(3, n + 1) == plane) cycle
      end if
      do p = 1, size(table)
        if (.not. table(p)%used) cycle
        call write_terms(table(p), p, buffer)
        table(p) = terms_t()
      end do
    end do
  end subroutine ledger_add_up

  !> Adds what contact did at one node.
  pure subroutine add_node(shared, n, mesh, table)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n
    type(mesh_t), intent(in) :: mesh
    type(terms_t), intent(inout) :: table(:)     !! (pairs)
    real(dp) :: position(3), impulse(3)
    integer :: axes(3), l
    logical :: first
    axes = axes_in_output(:, mesh%space)
    position = shared_place(shared, n, mesh)
    position = position(axes)
    first = .true.
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      if (.not. shared%meets(l)) cycle
      associate (terms => table(shared%pair(l)), link => shared%link(l))
        terms%used = .true.
        if (.not. link%seam) terms%shared = terms%shared + 1
        terms%dissipation = terms%dissipation + link%dissipation
        if (first) call add_terms(shared%terms(n), terms%node)
        first = .false.
        impulse = link%passed(axes)
        terms%impulse = terms%impulse - impulse
        terms%angular_impulse = terms%angular_impulse - cross(position, impulse)
        terms%rubbed = terms%rubbed - along_surface(impulse, link%normal(axes))
        if (link%at_surface) then
          impulse = link%rub(axes)
          terms%impulse = terms%impulse - impulse
          terms%angular_impulse = terms%angular_impulse - &
            cross(position + mesh%h*shared%middle(l)*link%normal(axes), impulse)
          terms%rubbed = terms%rubbed - along_surface(impulse, link%normal(axes))
        end if
        if (link%state > link_closed .and. .not. link%seam) terms%touching = terms%touching + 1
      end associate
    end do
  end subroutine add_node

  !> A vector without its part along a normal.
  pure function along_surface(vector, normal) result(part)
    real(dp), intent(in) :: vector(3), normal(3)
    real(dp) :: part(3)
    part = vector - dot_product(vector, normal)*normal
  end function along_surface

  pure subroutine add_terms(terms, total)
    type(node_terms_t), intent(in) :: terms
    type(node_terms_t), intent(inout) :: total
    total%rigid_work = total%rigid_work + terms%rigid_work
    total%nodes_aa = total%nodes_aa + terms%nodes_aa
    total%power_before = total%power_before + terms%power_before
    total%external_power = total%external_power + terms%external_power
  end subroutine add_terms

  pure subroutine write_terms(terms, pair, buffer)
    type(terms_t), intent(in) :: terms
    integer, intent(in) :: pair
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, [real([pair, terms%shared, terms%touching], dp), &
                             terms%impulse, terms%angular_impulse, terms%dissipation, &
                             terms%node%rigid_work, terms%node%nodes_aa, terms%node%power_before, &
                             terms%node%external_power, terms%rubbed])
  end subroutine write_terms

  !> Adds the terms of all ranks to the pairs and to the sums of the step.
  subroutine ledger_close(pairs, buffer, anywhere, sums)
    type(contact_pair_t), intent(inout) :: pairs(:)
    type(buffer_t), intent(inout) :: buffer
    logical, intent(in) :: anywhere        !! some rank has terms
    type(contact_sums_t), intent(inout) :: sums  !! added to
    real(dp), allocatable :: all(:)
    integer :: p, e
    do p = 1, size(pairs)
      pairs(p)%shared = 0
      pairs(p)%touching = 0
    end do
    if (.not. anywhere) return
    if (.not. allocated(buffer%values)) allocate (buffer%values(0))
    call parallel_gather(buffer%values(:buffer%n), all)  ! ranks own ascending planes
    do e = 1, size(all), entry
      call add_entry(pairs(nint(all(e))), sums, all(e:e + entry - 1))
    end do
    buffer%n = 0
  end subroutine ledger_close

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
    pair%friction_impulse = pair%friction_impulse + values(15:17)
  end subroutine add_entry

end module sgmp_contact_ledger
