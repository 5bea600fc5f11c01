!> Contact between fields, as phases of a step.
!!
!! Contact changes the trial velocity and the acceleration alike, so that what particles receive is
!! the contact force; the re-mapped velocity of MUSL and the velocity that strains the particles in
!! USF are made admissible by the same rule.
!! Normals and distances belong to the positions at the start of the step and are found once.
module sgmp_contact
  use sgmp_body, only: body_t
  use sgmp_buffer, only: buffer_t
  use sgmp_columns, only: node_acceleration, node_inverse_mass, node_velocity
  use sgmp_contact_distance, only: clouds_t, distance_detect
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_contact_resolve, only: contact_link_t, contact_resolve
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_shared_nodes, only: shared_build, shared_meet, shared_nodes_t
  use sgmp_surface_particles, only: surface_count, surface_pack
  implicit none
  private
  public :: contact_t, contact_layout, contact_meet, contact_detect, contact_trial, &
            contact_velocity

  !> All that contact knows.
  type :: contact_t
    type(contact_pair_t), allocatable :: pairs(:)  !! none: one field for all bodies
    type(shared_nodes_t) :: shared         !! nodes where the fields of pairs meet
    type(buffer_t) :: terms                !! of the ledger: what contact did in the step, own planes
  end type contact_t

contains

  !> Lists the shared nodes of a new layout.
  subroutine contact_layout(contact, mesh, fields, bodies, planes)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: planes(2)       !! first and last k that this rank solves
    if (size(contact%pairs) == 0) return
    call shared_build(contact%shared, mesh, fields, bodies, contact%pairs, planes)
  end subroutine contact_layout

  !> Finds where bodies meet, and counts the surface particles around.
  subroutine contact_meet(contact, fields, bodies, cutoff, moved, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: cutoff         !! nodes lighter than this are ignored
    logical, intent(in) :: moved           !! particles have changed bins since the last time
    integer, intent(in) :: threads
    integer :: n, b
    !$omp parallel do schedule(static) num_threads(threads) if(threads > 1) &
    !$omp& default(none) shared(contact, fields, cutoff) private(n)
    do n = 1, contact%shared%nodes
      call shared_meet(contact%shared, n, fields, cutoff)
    end do
    !$omp end parallel do
    do b = 1, size(bodies)
      call surface_count(contact%shared%surface(b), bodies(b)%particles, moved, &
                         bodies(b)%law%slots%surface, threads)
    end do
  end subroutine contact_meet

  !> Finds normals and touching pairs at all shared nodes. It must be known where bodies meet, and
  !! what other ranks have there.
  subroutine contact_detect(contact, mesh, fields, bodies, threads)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: threads
    type(clouds_t) :: clouds
    integer :: n, b
    do b = 1, size(bodies)
      call surface_pack(contact%shared%surface(b), bodies(b)%particles, &
                        bodies(b)%law%slots%surface, threads)
    end do
    !$omp parallel num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, mesh, fields, bodies) private(n, clouds)
    !$omp do schedule(dynamic, 16)
    do n = 1, contact%shared%nodes
      call distance_detect(contact%shared, n, mesh, fields, bodies, contact%pairs, clouds)
    end do
    !$omp end do nowait
    !$omp end parallel
  end subroutine contact_detect

  !> Contact forces: corrects trial velocity and acceleration (Eqs. 79, 80).
  subroutine contact_trial(contact, fields, bodies, dt, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: dt             !! velocity step dt^k
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) default(none) &
    !$omp& shared(contact, fields, bodies, dt) private(n)
    do n = 1, contact%shared%nodes
      call resolve_node(contact%shared, n, bodies, fields, node_velocity(fields(1)%ndim), dt)
    end do
    !$omp end parallel do
  end subroutine contact_trial

  !> Makes another nodal velocity admissible: the re-mapped one of MUSL, or that which strains the
  !! particles in USF.
  subroutine contact_velocity(contact, fields, bodies, column, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: column          !! first column of the velocity
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) default(none) &
    !$omp& shared(contact, fields, bodies, column) private(n)
    do n = 1, contact%shared%nodes
      call resolve_node(contact%shared, n, bodies, fields, column, 0.0_dp)
    end do
    !$omp end parallel do
  end subroutine contact_velocity

  !> Contact at one node; with a time step the acceleration follows.
  subroutine resolve_node(shared, n, bodies, fields, column, dt)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n, column
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(inout) :: fields(:)
    real(dp), intent(in) :: dt
    type(contact_link_t) :: links(shared%link_start(n + 1) - shared%link_start(n))
    real(dp), dimension(3, shared%member_start(n + 1) - shared%member_start(n)) :: velocity, gained
    real(dp) :: inverse_mass(size(velocity, 2))
    integer :: which(size(links))
    integer :: l, k, m, nd, active
    active = 0
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      shared%link(l)%normal_impulse = 0.0_dp
      shared%link(l)%tangent_impulse = 0.0_dp
      if (.not. shared%touching(l)) cycle
      active = active + 1
      which(active) = l
      links(active) = shared%link(l)
    end do
    if (active == 0) return
    velocity = 0.0_dp
    do k = 1, size(inverse_mass)
      m = shared%member_start(n) + k - 1
      nd = fields(shared%field(m))%ndim
      velocity(:nd, k) = fields(shared%field(m))%node(shared%record(m), column:column + nd - 1)
      inverse_mass(k) = fields(shared%field(m))%node(shared%record(m), node_inverse_mass(nd))
      if (bodies(shared%body(m))%rigid) inverse_mass(k) = 0.0_dp
    end do
    call contact_resolve(links(:active), inverse_mass, velocity)
    gained = 0.0_dp
    do l = 1, active
      where (shared%held(:, n)) links(l)%tangent_impulse = 0.0_dp
      shared%link(which(l)) = links(l)
      associate (impulse => links(l)%normal_impulse*links(l)%normal + links(l)%tangent_impulse)
        gained(:, links(l)%first) = gained(:, links(l)%first) - impulse
        gained(:, links(l)%second) = gained(:, links(l)%second) + impulse
      end associate
    end do
    do k = 1, size(inverse_mass)
      if (inverse_mass(k) <= 0.0_dp) cycle
      m = shared%member_start(n) + k - 1
      associate (node => fields(shared%field(m))%node, i => shared%record(m))
        node(i, column:column + nd - 1) = node(i, column:column + nd - 1) + &
          inverse_mass(k)*gained(:nd, k)
        if (dt <= 0.0_dp) cycle
        node(i, node_acceleration:node_velocity(nd) - 1) = &
          node(i, node_acceleration:node_velocity(nd) - 1) + inverse_mass(k)*gained(:nd, k)/dt
      end associate
    end do
  end subroutine resolve_node

end module sgmp_contact
