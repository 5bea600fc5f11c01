!> Contact between fields, and bodies with prescribed motion, as phases of a step.
!!
!! Contact changes the trial velocity and the acceleration alike, so that what particles receive is
!! the contact force; the re-mapped velocity of MUSL and the velocity that strains the particles in
!! USF are made admissible by the same rule.
!! Normals and distances belong to the positions at the start of the step and are found once.
module sgmp_contact_phases
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_link_t, contact_resolve
  use sgmp_contact_exchange, only: contact_exchange
  use sgmp_contact_ledger, only: contact_book
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_shared_nodes, only: clouds_t, shared_build, shared_detect, shared_meet, shared_nodes_t
  use sgmp_surface_particles, only: surface_count, surface_pack
  use sgmp_timers, only: phase_contact, timers_move, wall_time
  implicit none
  private
  public :: contact_layout, contact_detect, contact_trial, contact_velocity
  public :: rigid_choose_speed, rigid_solve, rigid_velocity, rigid_field

contains

  !> Lists the shared nodes of a new layout.
  subroutine contact_layout(model)
    type(model_t), intent(inout) :: model
    if (size(model%pairs) == 0) return
    call shared_build(model%shared, model%mesh, model%fields, model%bodies, model%pairs, &
                      model%partition%own + [0, model%partition%nodes])
  end subroutine contact_layout

  !> Finds normals and touching pairs at all shared nodes.
  subroutine contact_detect(model)
    type(model_t), intent(inout) :: model
    type(clouds_t) :: clouds
    real(dp) :: since
    integer :: n, b
    if (model%shared%nodes == 0) return
    since = wall_time()
    !$omp parallel do schedule(static) num_threads(model%threads) if(model%threads > 1) &
    !$omp& default(none) shared(model) private(n)
    do n = 1, model%shared%nodes
      call shared_meet(model%shared, n, model%fields, model%cutoff)
    end do
    !$omp end parallel do
    do b = 1, size(model%bodies)
      call surface_count(model%shared%surface(b), model%bodies(b)%particles, model%moved > 0, &
                         model%bodies(b)%law%slots%surface, model%threads)
    end do
    call timers_move(model%timers, phase_contact, since)
    call contact_exchange(model)
    since = wall_time()
    do b = 1, size(model%bodies)
      call surface_pack(model%shared%surface(b), model%bodies(b)%particles, &
                        model%bodies(b)%law%slots%surface, model%threads)
    end do
    !$omp parallel num_threads(model%threads) if(model%threads > 1) default(none) &
    !$omp& shared(model) private(n, clouds)
    !$omp do schedule(dynamic, 16)
    do n = 1, model%shared%nodes
      call shared_detect(model%shared, n, model%mesh, model%fields, model%bodies, model%pairs, &
                         clouds)
    end do
    !$omp end do nowait
    !$omp end parallel
    call timers_move(model%timers, phase_contact, since)
  end subroutine contact_detect

  !> Contact forces: corrects trial velocity and acceleration (Eqs. 79, 80) and books work and
  !! impulses.
  subroutine contact_trial(model, dt)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt             !! velocity step dt^k
    real(dp) :: since
    integer :: n
    if (model%shared%nodes == 0) return
    since = wall_time()
    !$omp parallel do schedule(dynamic, 16) num_threads(model%threads) default(none) &
    !$omp& shared(model, dt) private(n)
    do n = 1, model%shared%nodes
      call resolve_node(model%shared, n, model%bodies, model%fields, model%mesh%ndim + 1, dt)
    end do
    !$omp end parallel do
    call contact_book(model, dt)
    call timers_move(model%timers, phase_contact, since)
  end subroutine contact_trial

  !> Makes another nodal velocity admissible: the re-mapped one of MUSL, or that which strains the
  !! particles in USF.
  subroutine contact_velocity(model, column)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: column          !! first column of the velocity
    real(dp) :: since
    integer :: n
    if (model%shared%nodes == 0) return
    since = wall_time()
    !$omp parallel do schedule(dynamic, 16) num_threads(model%threads) default(none) &
    !$omp& shared(model, column) private(n)
    do n = 1, model%shared%nodes
      call resolve_node(model%shared, n, model%bodies, model%fields, column, 0.0_dp)
    end do
    !$omp end parallel do
    call timers_move(model%timers, phase_contact, since)
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
      inverse_mass(k) = fields(shared%field(m))%node(shared%record(m), 2*nd + 1)
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
        if (dt > 0.0_dp) node(i, 1:nd) = node(i, 1:nd) + inverse_mass(k)*gained(:nd, k)/dt
      end associate
    end do
  end subroutine resolve_node

  !> The rigid body that a field belongs to, 0 if it has none.
  pure function rigid_field(model, f) result(b)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    integer :: b
    do b = 1, size(model%bodies)
      if (model%bodies(b)%field == f .and. model%bodies(b)%rigid) return
    end do
    b = 0
  end function rigid_field

  !> Velocities of rigid bodies at the middle of the step.
  subroutine rigid_choose_speed(model)
    type(model_t), intent(inout) :: model
    real(dp) :: nowhere(3)
    integer :: b, d
    nowhere = 0.0_dp
    do b = 1, size(model%bodies)
      if (.not. model%bodies(b)%rigid) cycle
      model%bodies(b)%speed_before = model%bodies(b)%speed
      do d = 1, model%mesh%ndim
        model%bodies(b)%speed(d) = &
          model%bodies(b)%motion(d)%evaluate(nowhere, nowhere, model%clock%time + &
            0.5_dp*model%clock%dt)
      end do
    end do
  end subroutine rigid_choose_speed

  !> Nodal acceleration and velocity of a rigid body.
  subroutine rigid_solve(model, f, b, dt)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f, b
    real(dp), intent(in) :: dt
    integer :: d
    if (rigid_known(model, f, b)) return
    do d = 1, model%mesh%ndim
      model%fields(f)%node(:, d) = (model%bodies(b)%speed(d) - model%bodies(b)%speed_before(d))/dt
    end do
    call rigid_velocity(model, f, b, model%mesh%ndim + 1)
  end subroutine rigid_solve

  !> Nodal velocity of a rigid body, in the vector that starts at `column`.
  subroutine rigid_velocity(model, f, b, column)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f, b, column
    integer :: d
    if (rigid_known(model, f, b)) return
    do d = 1, model%mesh%ndim
      model%fields(f)%node(:, column + d - 1) = model%bodies(b)%speed(d)
    end do
    model%fields(f)%node(:, 2*model%mesh%ndim + 1) = 1.0_dp
  end subroutine rigid_velocity

  !> Whether the nodes of a body at rest hold what they always will: a new layout sets them to zero.
  pure function rigid_known(model, f, b) result(known)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f, b
    logical :: known
    known = .false.
    if (.not. model%bodies(b)%at_rest .or. model%fields(f)%points == 0) return
    known = model%fields(f)%node(1, 2*model%mesh%ndim + 1) > 0.0_dp
  end function rigid_known

end module sgmp_contact_phases
