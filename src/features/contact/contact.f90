!> Contact between fields, as phases of a step.
!!
!! The trial decides once in a step which pairs are pressed together, slide or stick, and gives
!! particles the contact force; the velocity that strains the particles then obeys that state: the
!! re-mapped one of MUSL, in USF the one before the kick with the state of the step before
!! (sgmp_contact_resolve). Normals and distances belong to the positions at the start of the step
!! and are found once. Where rotation is exact, friction acts at the surface and has stages of its
!! own (sgmp_friction_stages).
module sgmp_contact
  use sgmp_body, only: body_t
  use sgmp_buffer, only: buffer_t
  use sgmp_columns, only: node_acceleration, node_inertia, node_inverse_mass, node_remapped, &
                          node_velocity, vector_components
  use sgmp_contact_distance, only: clouds_t, distance_detect
  use sgmp_contact_ledger, only: ledger_kick, ledger_strain
  use sgmp_contact_levers, only: levers_layout, levers_t
  use sgmp_contact_memory, only: memory_give, memory_take
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_contact_resolve, only: contact_link_t, link_free, resolve_strain, resolve_trial
  use sgmp_driven_nodes, only: driven_nodes_pin
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_node_vectors, only: shared_vector_add, shared_vector_around, shared_vector_length
  use sgmp_rigid_motion, only: motion_kick
  use sgmp_self_contact, only: self_decide, self_t
  use sgmp_shared_nodes, only: node_terms_t, shared_build, shared_mark, shared_meet, &
                               shared_members, shared_nodes_t, shared_place, shared_share
  use sgmp_space, only: space_axisymmetric
  use sgmp_surface_exposure, only: exposure_steps, surface_expose
  use sgmp_surface_particles, only: surface_count, surface_pack
  implicit none
  private
  public :: contact_t, contact_step_t, contact_layout, contact_meet, contact_detect, &
            contact_between, contact_gather, contact_trial, contact_trial_strain, &
            contact_velocity

  !> All that contact knows.
  type :: contact_t
    type(contact_pair_t), allocatable :: pairs(:)  !! none: one field for all bodies
    logical :: at_surface = .false.        !! friction acts there, not at the nodes
    type(shared_nodes_t) :: shared         !! nodes where the fields of pairs meet
    type(levers_t) :: levers               !! how friction at the surface reaches the nodes
    type(self_t) :: self                   !! where bodies come near themselves
    logical :: anywhere = .true.           !! on some rank bodies are near each other
    type(buffer_t) :: memory               !! states of links until the next layout
    type(buffer_t) :: terms
      !! of the ledger: what contact did in the step, own planes
  end type contact_t

  !> What contact must know of the step at hand.
  type :: contact_step_t
    integer :: number = 0                  !! of the step
    real(dp) :: dt_kick = 0.0_dp           !! velocity step dt^k
    real(dp) :: gap_speed = 0.0_dp         !! that closes a gap of one cell in the position step
    real(dp) :: pic = 0.0_dp               !! share of the grid's velocity in particles' (1 - flip)
    real(dp) :: gravity(3) = 0.0_dp
    real(dp) :: work_part = 0.5_dp         !! of a kick's change of velocity, where forces work
    logical :: strains_with_trial = .false.  !! the trial velocity also strains the particles (USL)
    real(dp) :: before = 0.0_dp, after = 0.0_dp
      !! parts of the strain that come from velocities before and after the kick
  end type contact_step_t

  !> Nodes that fields share and whose sums are not worth a meeting of threads.
  integer, parameter :: few_nodes = 1024

contains

  !> Whether two fields are a pair that may touch.
  pure function contact_between(contact, a, b) result(yes)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: a, b
    logical :: yes
    integer :: p
    yes = .false.
    do p = 1, size(contact%pairs)
      yes = yes .or. all(contact%pairs(p)%field == [a, b]) .or. &
            all(contact%pairs(p)%field == [b, a])
    end do
  end function contact_between

  !> Lists the shared nodes of a new layout; pairs keep their states.
  subroutine contact_layout(contact, mesh, fields, bodies, planes)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: planes(2)       !! first and last k that this rank solves
    integer :: f
    if (size(contact%pairs) == 0) return
    call memory_take(contact%memory, contact%shared, [-huge(1), huge(1)])
    call shared_build(contact%shared, mesh, fields, bodies, contact%pairs, planes, &
                      contact%at_surface)
    contact%shared%around = any([(vector_components(fields(f)%columns, mesh%ndim) > mesh%ndim, &
                                  f=1, size(fields))])
    if (contact%at_surface) call levers_layout(contact%levers, contact%shared, mesh%h)
    call memory_give(contact%memory, contact%shared, &
                     contact%pairs(:merge(size(contact%pairs), 0, contact%self%on)))
    contact%self%fresh = contact%self%on
  end subroutine contact_layout

  !> Finds where bodies meet, and counts the surface particles around.
  subroutine contact_meet(contact, mesh, fields, bodies, step, cutoff, moved, threads)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    integer, intent(in) :: step            !! its number
    real(dp), intent(in) :: cutoff         !! nodes lighter than this are ignored
    logical, intent(in) :: moved           !! particles have changed bins since the last time
    integer, intent(in) :: threads
    integer :: n, b
    logical :: any_meet
    if (contact%self%fresh) call self_decide(contact%self, mesh%ndim, bodies, contact%pairs, &
                                             contact%shared)
    contact%self%fresh = .false.
    !$omp parallel do schedule(static) num_threads(threads) &
    !$omp& if(threads > 1 .and. contact%shared%nodes > few_nodes) &
    !$omp& default(none) shared(contact, fields, cutoff) private(n)
    do n = 1, contact%shared%nodes
      call shared_meet(contact%shared, n, fields, cutoff)
    end do
    !$omp end parallel do
    if (mod(step, exposure_steps) == 0) then
      call shared_mark(contact%shared, [-huge(1), huge(1)], any_meet)
      do b = 1, merge(size(bodies), 0, any_meet)
        call surface_expose(contact%shared%surface(b), b, bodies, fields, mesh)
      end do
    end if
    do b = 1, size(bodies)
      call surface_count(contact%shared%surface(b), bodies(b)%particles, moved, &
                         bodies(b)%law%slots%surface, threads)
    end do
  end subroutine contact_meet

  !> Finds normals and gaps at all shared nodes. It must be known where bodies meet, and what other
  !! ranks have there.
  subroutine contact_detect(contact, mesh, fields, bodies, threads)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: threads
    type(clouds_t) :: clouds
    integer :: n, b, labelled
    labelled = merge(size(contact%pairs), 0, contact%self%on)
    do b = 1, size(bodies)
      call surface_pack(contact%shared%surface(b), bodies(b)%particles, &
                        bodies(b)%law%slots%surface, threads)
    end do
    !$omp parallel num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, mesh, fields, bodies, labelled) private(n, clouds)
    !$omp do schedule(dynamic, 16)
    do n = 1, contact%shared%nodes
      call shared_share(contact%shared, n, fields, contact%pairs(:labelled))
      call distance_detect(contact%shared, n, mesh, fields, bodies, contact%pairs, clouds)
    end do
    !$omp end do nowait
    !$omp end parallel
  end subroutine contact_detect

  !> Contact forces: corrects trial velocity and acceleration (Eqs. 79, 80).
  subroutine contact_trial(contact, fields, bodies, step, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, fields, bodies, step) private(n)
    do n = 1, contact%shared%nodes
      call trial_node(contact%shared, n, bodies, fields, step)
    end do
    !$omp end parallel do
  end subroutine contact_trial

  !> What contact takes through the velocity that particles receive from the trial, where that
  !! strains them (USL) and friction has come later.
  subroutine contact_trial_strain(contact, fields, bodies, step, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, fields, bodies, step) private(n)
    do n = 1, contact%shared%nodes
      call trial_strain_node(contact%shared, n, bodies, fields, step)
    end do
    !$omp end parallel do
  end subroutine contact_trial_strain

  !> Makes the velocity that strains the particles obey the last trial: the re-mapped velocity of
  !! MUSL, or the one before the kick, of which the trial has yet to come.
  subroutine contact_velocity(contact, mesh, fields, bodies, step, before_kick, threads)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    logical, intent(in) :: before_kick
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, mesh, fields, bodies, step, before_kick) private(n)
    do n = 1, contact%shared%nodes
      call strain_node(contact%shared, n, mesh, bodies, fields, step, before_kick)
    end do
    !$omp end parallel do
  end subroutine contact_velocity

  !> Contact at one node: the trial.
  ! allow(S901): two solves and what they give to whom, on arrays that all of it shares
  subroutine trial_node(shared, n, bodies, fields, step)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(inout) :: fields(:)
    type(contact_step_t), intent(in) :: step
    type(contact_link_t) :: links(shared%link_start(n + 1) - shared%link_start(n))
    real(dp), dimension(3, shared%member_start(n + 1) - shared%member_start(n)) :: velocity, &
      kick, trial, gained
    real(dp) :: inverse_mass(3, size(velocity, 2)), length
    logical :: moving(size(velocity, 2))
    integer :: which(size(links)), l, k, m, nd, active
    shared%terms(n) = node_terms_t()
    if (shared%driven) then
      associate (first => shared%member_start(n), last => shared%member_start(n + 1) - 1)
        shared%driven_kick(:, first:last) = 0.0_dp
        shared%driven_push(:, first:last) = 0.0_dp
        shared%driven_work(:, first:last) = 0.0_dp
      end associate
    end if
    if (.not. any(shared%meets(shared%link_start(n):shared%link_start(n + 1) - 1))) then
      do l = shared%link_start(n), shared%link_start(n + 1) - 1
        call forget(shared%link(l))
      end do
      return
    end if
    nd = shared%ndim
    call contact_gather(shared, n, bodies, fields, node_velocity(nd), velocity, inverse_mass, &
                        moving)
    call contact_gather(shared, n, bodies, fields, node_acceleration, kick, inverse_mass, moving)
    kick = step%dt_kick*kick
    if (shared%driven) call note_driven(shared, n, fields, inverse_mass, kick)
    active = 0
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      associate (link => shared%link(l))
        link%pull = kick(:, link%first) - kick(:, link%second)
        if (shared%near(l) .and. moving(link%first) .and. moving(link%second)) then
          link%approach = shared%gap(l)*step%gap_speed
          active = active + 1
          which(active) = l
          links(active) = link
        else
          link%state = link_free
          link%impulse = 0.0_dp
          link%passed = 0.0_dp
          link%dissipation = 0.0_dp
          if (step%strains_with_trial) link%correction = 0.0_dp
        end if
      end associate
    end do
    length = shared_vector_length(shared, n, bodies, fields)
    trial = velocity
    if (active > 0) call resolve_trial(links(:active), inverse_mass, velocity, kick)
    gained = 0.0_dp
    do l = 1, active
      links(l)%passed = links(l)%impulse + step%pic*links(l)%correction
      ! USF strained before: the correction of that velocity stays.
      if (.not. step%strains_with_trial) links(l)%correction = shared%link(which(l))%correction
      links(l)%dissipation = 0.0_dp
      shared%link(which(l)) = links(l)
      gained(:, links(l)%first) = gained(:, links(l)%first) - links(l)%impulse
      gained(:, links(l)%second) = gained(:, links(l)%second) + links(l)%impulse
    end do
    do k = 1, size(inverse_mass, 2)
      if (active == 0 .or. all(inverse_mass(:, k) <= 0.0_dp)) cycle
      m = shared%member_start(n) + k - 1
      associate (field => fields(shared%field(m)), i => shared%record(m))
        call shared_vector_add(field, i, node_velocity(nd), velocity(:, k) - trial(:, k), length)
        call shared_vector_add(field, i, node_acceleration, &
                               inverse_mass(:, k)*gained(:, k)/step%dt_kick, length)
      end associate
    end do
    if (shared%driven) call push_driven(shared, n, fields, inverse_mass)
    call ledger_kick(shared, n, fields, inverse_mass, trial, kick, gained, step%dt_kick, &
                     step%gravity, step%work_part)
    if (step%strains_with_trial .and. shared%at_surface) return  ! friction is yet to come
    if (step%strains_with_trial) then
      do k = 1, size(inverse_mass, 2)
        trial(:, k) = trial(:, k) + inverse_mass(:, k)*gained(:, k)
      end do
      call ledger_strain(shared, n, bodies, fields, inverse_mass, trial, kick, step%before, &
                         step%gravity)
    else if (step%before > 0.0_dp) then
      call ledger_strain(shared, n, bodies, fields, inverse_mass, trial - kick, kick, step%before, &
                         step%gravity)
    end if
  end subroutine trial_node

  !> The change of velocity that is prescribed for members of a node; 0 along other components.
  pure subroutine note_driven(shared, n, fields, inverse_mass, kick)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: inverse_mass(:, :), kick(:, :)  !! (3, members)
    integer :: k, m
    do k = 1, size(inverse_mass, 2)
      m = shared%member_start(n) + k - 1
      if (fields(shared%field(m))%columns%driven == 0) cycle
      shared%driven_kick(:, m) = merge(0.0_dp, kick(:, k), inverse_mass(:, k) > 0.0_dp)
    end do
  end subroutine note_driven

  !> The impulses that contact gives to such components: whoever moves them takes these.
  pure subroutine push_driven(shared, n, fields, inverse_mass)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: inverse_mass(:, :)   !! (3, members)
    integer :: l, side, m, at(2)
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      at = shared_members(shared, n, l)
      do side = 1, 2
        m = at(side)
        if (fields(shared%field(m))%columns%driven == 0) cycle
        associate (push => shared%driven_push(:, m), k => m - shared%member_start(n) + 1)
          push = push + merge(0.0_dp, merge(-shared%link(l)%passed, shared%link(l)%passed, &
                                            side == 1), inverse_mass(:, k) > 0.0_dp)
        end associate
      end do
    end do
  end subroutine push_driven

  !> The same at one node: what particles receive is the trial's velocity without the corrections.
  subroutine trial_strain_node(shared, n, bodies, fields, step)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    type(contact_step_t), intent(in) :: step
    real(dp), dimension(3, shared%member_start(n + 1) - shared%member_start(n)) :: velocity, kick
    real(dp) :: inverse_mass(3, size(velocity, 2))
    logical :: moving(size(velocity, 2))
    integer :: l
    call contact_gather(shared, n, bodies, fields, node_velocity(shared%ndim), velocity, &
                        inverse_mass, moving)
    call contact_gather(shared, n, bodies, fields, node_acceleration, kick, inverse_mass, moving)
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      associate (link => shared%link(l))
        velocity(:, link%first) = velocity(:, link%first) + &
                                  inverse_mass(:, link%first)*link%correction
        velocity(:, link%second) = velocity(:, link%second) - &
                                   inverse_mass(:, link%second)*link%correction
      end associate
    end do
    call ledger_strain(shared, n, bodies, fields, inverse_mass, velocity, step%dt_kick*kick, &
                       step%before, step%gravity)
  end subroutine trial_strain_node

  !> Contact at one node: the velocity that strains the particles.
  subroutine strain_node(shared, n, mesh, bodies, fields, step, before_kick)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(inout) :: fields(:)
    type(contact_step_t), intent(in) :: step
    logical, intent(in) :: before_kick
    real(dp), dimension(3, shared%member_start(n + 1) - shared%member_start(n)) :: velocity, &
      obeying, kick
    real(dp) :: inverse_mass(3, size(velocity, 2)), length
    logical :: moving(size(velocity, 2))
    integer :: l, k, m, nd, column
    associate (links => shared%link(shared%link_start(n):shared%link_start(n + 1) - 1), &
               meets => shared%meets(shared%link_start(n):shared%link_start(n + 1) - 1))
      links%correction(1) = 0.0_dp
      links%correction(2) = 0.0_dp
      links%correction(3) = 0.0_dp
      if (all(links%state == link_free)) return
      nd = shared%ndim
      column = merge(node_velocity(nd), node_remapped, before_kick)
      call contact_gather(shared, n, bodies, fields, column, velocity, inverse_mass, moving)
      do l = 1, size(links)
        ! A node that bodies have left stays listed until the next layout, which comes at another
        ! time with other ranks: the state of its last trial must not act on.
        if (.not. meets(l)) call forget(links(l))
        if (.not. (moving(links(l)%first) .and. moving(links(l)%second))) call forget(links(l))
      end do
      obeying = velocity
      call resolve_strain(links, inverse_mass, obeying)
    end associate
    length = shared_vector_length(shared, n, bodies, fields)
    do k = 1, size(inverse_mass, 2)
      if (all(inverse_mass(:, k) <= 0.0_dp)) cycle
      m = shared%member_start(n) + k - 1
      call shared_vector_add(fields(shared%field(m)), shared%record(m), column, &
                             obeying(:, k) - velocity(:, k), length)
    end do
    if (before_kick) return
    kick = 0.0_dp
    do k = 1, size(inverse_mass, 2)
      associate (body => bodies(shared%body(shared%member_start(n) + k - 1)))
        if (shared%driven) kick(:, k) = shared%driven_kick(:, shared%member_start(n) + k - 1)
        if (.not. body%rigid) cycle
        kick(:, k) = merge(0.0_dp, motion_kick(body%rigid_motion, body%speed - body%speed_before, &
                                               shared_place(shared, n, mesh)), shared%held(:, n))
      end associate
    end do
    call ledger_strain(shared, n, bodies, fields, inverse_mass, velocity, kick, step%after, &
                       step%gravity)
  end subroutine strain_node

  !> A pair that does not meet at the node any more.
  pure subroutine forget(link)
    type(contact_link_t), intent(inout) :: link
    link%state = link_free
    link%impulse = 0.0_dp
    link%passed = 0.0_dp
    link%correction = 0.0_dp
    link%dissipation = 0.0_dp
  end subroutine forget

  !> A vector of all members of a node, without the components that walls hold, and the inverse
  !! masses: 0 for rigid bodies, and for components whose motion is prescribed.
  pure subroutine contact_gather(shared, n, bodies, fields, column, vector, inverse_mass, moving)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, column
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(out) :: vector(:, :)        !! (3, members)
    real(dp), intent(out) :: inverse_mass(:, :)  !! (3, members) of each component
    logical, intent(out) :: moving(:)            !! (members) it has mass at the node
    logical :: pinned(3)
    integer :: k, m
    vector = 0.0_dp
    do k = 1, size(inverse_mass, 2)
      m = shared%member_start(n) + k - 1
      associate (node => fields(shared%field(m))%node, i => shared%record(m), nd => shared%ndim)
        vector(:nd, k) = merge(0.0_dp, node(i, column:column + nd - 1), shared%held(:nd, n))
        inverse_mass(:, k) = node(i, node_inverse_mass(nd))
        moving(k) = inverse_mass(3, k) > 0.0_dp
        if (bodies(shared%body(m))%rigid) then
          inverse_mass(:, k) = 0.0_dp
        else if (fields(shared%field(m))%space == space_axisymmetric) then
          inverse_mass(1, k) = inverse_mass(1, k)/node(i, node_inertia)
        end if
        if (fields(shared%field(m))%columns%driven == 0) cycle
        call driven_nodes_pin(fields(shared%field(m)), shared%interval(m), shared%point(1, n), i, &
                              pinned)
        inverse_mass(:, k) = merge(0.0_dp, inverse_mass(:, k), pinned)
      end associate
    end do
    call shared_vector_around(shared, n, bodies, fields, column, vector, inverse_mass)
  end subroutine contact_gather

end module sgmp_contact
