!> What contact would do to free rigid bodies that move as their nodes say: forces and moments, and
!! how they answer to a change of the motion (doc/loads.md).
!!
!! At a node a body that is pressed carries mass m of the other body with it along the normal, and
!! across it where it sticks: a change du of its velocity there changes the impulse on it by -C du,
!! C = m n n^T + m (1 - n n^T). Sums over the nodes are exact, so that nothing depends on who owns
!! them.
module sgmp_contact_reaction
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_acceleration, node_velocity
  use sgmp_contact, only: contact_gather, contact_step_t, contact_t
  use sgmp_contact_levers, only: tangential
  use sgmp_contact_resolve, only: contact_link_t, link_closed, link_sharing, link_sticking, &
                                  resolve_trial
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_parallel, only: parallel_exact_sums
  use sgmp_rigid_motion, only: freedoms, motion_jerk
  use sgmp_shared_nodes, only: shared_nodes_t, shared_place
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: reaction_t, reaction_find

  !> On one body.
  type :: reaction_t
    real(dp) :: impulse(freedoms) = 0.0_dp  !! linear and, about its centre, angular
    real(dp) :: carried(freedoms, freedoms) = 0.0_dp  !! mass and inertia that it carries with it
  end type reaction_t

  integer, parameter :: terms = freedoms + freedoms**2  !! numbers of a reaction

contains

  !> Reactions on all free bodies, of the trial, or where a column is given of the straining
  !! velocity that begins there: what it takes from them to obey contact, the momentum that no
  !! particle receives. All ranks must call it.
  subroutine reaction_find(contact, mesh, own, fields, bodies, step, threads, reactions, column)
    type(contact_t), intent(in) :: contact
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: own(2)          !! first and last plane of this rank
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    integer, intent(in) :: threads
    type(reaction_t), intent(out) :: reactions(:)  !! (bodies)
    integer, intent(in), optional :: column
    real(dp), allocatable :: table(:, :)
    real(dp) :: sums(terms)
    integer, allocatable :: nodes(:)
    integer :: b, i
    do b = 1, size(bodies)
      if (.not. bodies(b)%rigid_motion%free) cycle
      nodes = nodes_of(contact%shared, own, b)
      allocate (table(terms, size(nodes)))
      !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
      !$omp& shared(contact, nodes, table, mesh, fields, bodies, step, b, column) private(i)
      do i = 1, size(nodes)
        if (present(column)) then
          table(:, i) = node_strain(contact%shared, nodes(i), b, mesh, fields, bodies, column)
        else
          table(:, i) = node_reaction(contact, nodes(i), b, mesh, fields, bodies, step)
        end if
      end do
      !$omp end parallel do
      call parallel_exact_sums(table, sums)
      reactions(b)%impulse = sums(:freedoms)
      reactions(b)%carried = reshape(sums(freedoms + 1:), [freedoms, freedoms])
      deallocate (table)
    end do
  end subroutine reaction_find

  !> Nodes of the own planes where a body may touch another.
  pure function nodes_of(shared, own, b) result(nodes)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: own(2), b
    integer, allocatable :: nodes(:)
    logical, allocatable :: chosen(:)
    integer :: n, l
    allocate (chosen(shared%nodes), source=.false.)
    do n = 1, shared%nodes
      if (shared%point(3, n) < own(1) .or. shared%point(3, n) > own(2)) cycle
      do l = shared%link_start(n), shared%link_start(n + 1) - 1
        if (shared%near(l)) chosen(n) = chosen(n) .or. side_of(shared, n, shared%link(l), b) > 0
      end do
    end do
    nodes = pack([(n, n=1, shared%nodes)], chosen)
  end function nodes_of

  !> Which side of a link a body is, 0 if it is none.
  pure function side_of(shared, n, link, b) result(side)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, b
    type(contact_link_t), intent(in) :: link
    integer :: side
    side = 0
    if (shared%body(shared%member_start(n) - 1 + link%first) == b) side = 1
    if (shared%body(shared%member_start(n) - 1 + link%second) == b) side = 2
  end function side_of

  !> Reaction on a body at one node: the trial, of which nothing is kept.
  pure function node_reaction(contact, n, b, mesh, fields, bodies, step) result(row)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: n, b
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    real(dp) :: row(terms)
    type(contact_link_t) :: &
      links(contact%shared%link_start(n + 1) - contact%shared%link_start(n))
    real(dp), dimension(3, contact%shared%member_start(n + 1) - contact%shared%member_start(n)) :: &
      velocity, kick, inverse_mass
    logical :: moving(size(velocity, 2))
    integer :: which(size(links)), l, active, side
    type(reaction_t) :: sum_of
    real(dp) :: sign
    associate (shared => contact%shared)
      call contact_gather(shared, n, bodies, fields, node_velocity(shared%ndim), velocity, &
                          inverse_mass, moving)
      call contact_gather(shared, n, bodies, fields, node_acceleration, kick, inverse_mass, moving)
      active = 0
      do l = shared%link_start(n), shared%link_start(n + 1) - 1
        associate (link => shared%link(l))
          if (.not. (shared%near(l) .and. moving(link%first) .and. moving(link%second))) cycle
          active = active + 1
          which(active) = l
          links(active) = link
          links(active)%approach = shared%gap(l)*step%gap_speed
        end associate
      end do
      if (active > 0) then
        call resolve_trial(links(:active), inverse_mass, velocity, step%dt_kick*kick)
      end if
      do l = 1, active
        side = side_of(shared, n, links(l), b)
        if (side == 0) cycle
        sign = merge(-1.0_dp, 1.0_dp, side == 1)
        call add_link(links(l), sign, step%pic, &
                      inverse_mass(:, links(l)%first) + inverse_mass(:, links(l)%second), &
                      shared_place(shared, n, mesh) - bodies(b)%rigid_motion%centre, sum_of)
        if (.not. shared%at_surface .or. links(l)%state <= link_closed) cycle
        call add_friction(contact, n, which(l), sign, mesh, bodies(b), step%dt_kick, sum_of)
      end do
    end associate
    row = [sum_of%impulse, reshape(sum_of%carried, [freedoms**2])]
  end function node_reaction

  !> The same of the straining velocity.
  pure function node_strain(shared, n, b, mesh, fields, bodies, column) result(row)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, b
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: column
    real(dp) :: row(terms)
    real(dp), dimension(3, shared%member_start(n + 1) - shared%member_start(n)) :: velocity, &
      inverse_mass
    logical :: moving(size(velocity, 2))
    type(reaction_t) :: sum_of
    real(dp) :: answer(3, 3), sign
    integer :: l, side
    call contact_gather(shared, n, bodies, fields, column, velocity, inverse_mass, moving)
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      associate (link => shared%link(l))
        side = side_of(shared, n, link, b)
        if (side == 0 .or. .not. shared%meets(l)) cycle
        if (.not. (moving(link%first) .and. moving(link%second))) cycle
        sign = merge(-1.0_dp, 1.0_dp, side == 1)
        answer = link_answer(link, link%held_normal, &
                             inverse_mass(:, link%first) + inverse_mass(:, link%second))
        call add(shared_place(shared, n, mesh) - bodies(b)%rigid_motion%centre, &
                 sign*matmul(answer, velocity(:, link%first) - velocity(:, link%second)), answer, &
                 sum_of)
      end associate
    end do
    row = [sum_of%impulse, reshape(sum_of%carried, [freedoms**2])]
  end function node_strain

  !> Adds friction at the surface, which is found later in the step: that of the step before, and
  !! where bodies stuck then, what it answers to a motion that has changed since.
  pure subroutine add_friction(contact, n, l, sign, mesh, body, dt, sum_of)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: n, l
    real(dp), intent(in) :: sign
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: dt
    type(reaction_t), intent(inout) :: sum_of
    real(dp) :: place(3), impulse(3), answer(3, 3)
    integer :: d
    associate (shared => contact%shared, link => contact%shared%link(l), &
               response => contact%levers%response(l), motion => body%rigid_motion)
      if (response <= 0.0_dp) return
      place = shared_place(shared, n, mesh) + mesh%h*shared%middle(l)*link%normal
      answer = 0.0_dp
      if (link%state == link_sticking) then
        answer = -spread(link%normal, 2, 3)*spread(link%normal, 1, 3)/response
        do d = 1, mesh%ndim
          answer(d, d) = answer(d, d) + 1.0_dp/response
        end do
      end if
      impulse = sign*tangential(shared, n, l, dt*link%drag) - &
                matmul(answer, motion_jerk(motion, body%speed - body%speed_before, place))
      call add(place - motion%centre, impulse, answer, sum_of)
    end associate
  end subroutine add_friction

  !> Adds what one link does to the body.
  pure subroutine add_link(link, sign, pic, weight, arm, sum_of)
    type(contact_link_t), intent(in) :: link
    real(dp), intent(in) :: sign           !! 1: the body is the second of the link
    real(dp), intent(in) :: pic
    real(dp), intent(in) :: weight(3)      !! inverse mass of each component
    real(dp), intent(in) :: arm(3)         !! from the body's centre
    type(reaction_t), intent(inout) :: sum_of
    call add(arm, sign*(link%impulse + pic*link%correction), &
             link_answer(link, link%normal, weight), sum_of)
  end subroutine add_link

  !> How the impulse of a pressed link answers to a change of the velocity between its bodies.
  pure function link_answer(link, normal, weight) result(answer)
    type(contact_link_t), intent(in) :: link
    real(dp), intent(in) :: normal(3)
    real(dp), intent(in) :: weight(3)      !! inverse mass of each component
    real(dp) :: answer(3, 3)
    real(dp) :: normal_weight, slip_weight
    integer :: d
    answer = 0.0_dp
    normal_weight = weight(3) + dot_product(normal**2, weight - weight(3))
    if (link%state <= link_closed .or. normal_weight <= 0.0_dp) return
    answer = spread(normal, 2, 3)*spread(normal, 1, 3)
    if ((link%state == link_sticking .and. .not. link%at_surface) .or. &
        link%state == link_sharing) then
      slip_weight = max(weight(1) + weight(2) - normal_weight, tiny(1.0_dp))
      answer = answer*(1.0_dp/normal_weight - 1.0_dp/slip_weight)
      do d = 1, 3
        answer(d, d) = answer(d, d) + 1.0_dp/slip_weight
      end do
    else
      answer = answer/normal_weight
    end if
  end function link_answer

  !> Adds an impulse at a place, and how it answers to a change of velocity there.
  pure subroutine add(arm, impulse, answer, sum_of)
    real(dp), intent(in) :: arm(3)         !! from the body's centre
    real(dp), intent(in) :: impulse(3), answer(3, 3)
    type(reaction_t), intent(inout) :: sum_of
    real(dp) :: lever(3, 3)
    lever = reshape([0.0_dp, arm(3), -arm(2), -arm(3), 0.0_dp, arm(1), arm(2), -arm(1), 0.0_dp], &
                    [3, 3])
    sum_of%impulse = sum_of%impulse + [impulse, cross(arm, impulse)]
    associate (k => sum_of%carried)
      k(:3, :3) = k(:3, :3) + answer
      k(4:, :3) = k(4:, :3) + matmul(lever, answer)
      k(:3, 4:) = k(:3, 4:) - matmul(answer, lever)
      k(4:, 4:) = k(4:, 4:) - matmul(lever, matmul(answer, lever))
    end associate
  end subroutine add

end module sgmp_contact_reaction
