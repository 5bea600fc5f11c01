!> Coulomb's friction at slip walls: a force along the wall on each node that lies on it.
!!
!! Nodes on a slip wall move along it; the images behind it are even for that motion, so that a
!! force T on such a node is what the momentum of the particles gains, to round-off. T stops the
!! slip of the node's trial velocity or is as large as friction admits,
!!   T = -m (v - V)/dt min(1, mu N dt/|m (v - V)|),   N = max(0, -f_n),
!! with V the velocity of the wall and f_n the force on the node out of the wall by stresses,
!! gravity and body forces: what the wall bears at this node. Where functions reach behind the wall
!! a part of it was given to the node there; what it gave came back with its sign turned, so it
!! counts twice (sgmp_wall_work). A wall that pulls does not rub. What it pulls at one node presses
!! on others, which would press less without: mu is that of the deck times a share,
!! so that over time a wall rubs with what presses on it less what it pulls
!! (sgmp_wall_friction_account).
!!
!! The power of T is that at the velocity in the middle of the step, as that of other external
!! forces: T . V of it is the work of the wall, T . (v - V) goes into friction. Where a node sticks
!! the velocity that strains the particles is the wall's as well, or they would creep without
!! stress. There stresses do work on V and not on v, so what goes into friction is
!! (m a - f_ext) . (v - V): with a wall at rest the kinetic energy that the node loses.
!!
!! Where matter turns about the axis slip has a component around it, too (sgmp_node_vectors). Walls
!! do not turn.
module sgmp_wall_friction
  use sgmp_columns, only: node_acceleration, node_inertia, node_inverse_mass, &
                          node_remapped, node_velocity, vector_column, vector_components
  use sgmp_driven_nodes, only: driven_nodes_pin
  use sgmp_features, only: nodes_pressed, nodes_pulled
  use sgmp_field, only: field_base, field_t
  use sgmp_images, only: vector_parity
  use sgmp_kernels, only: kernel_centred, kernel_folds
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_free, wall_kick, wall_speed
  use sgmp_node_vectors, only: vector_length
  use sgmp_rows, only: key_j, key_k
  use sgmp_space, only: space_axisymmetric
  use sgmp_sums, only: nodes_external, nodes_sums, nodes_taken, wall_entry
  use sgmp_wall_friction_type, only: wall_friction_t
  use sgmp_wall_work, only: holding_wall
  use sgmp_walls, only: ghost_point
  implicit none
  private
  public :: wall_friction_force, wall_nodes_rub, wall_nodes_stick

contains

  !> Lets walls rub on the nodes of a tile that lie on them, which have their accelerations and
  !! velocities as if there were no wall.
  pure subroutine wall_nodes_rub(field, mesh, friction, s, first, n, m, external, dt, sums)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(wall_friction_t), intent(in) :: friction
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    real(dp), intent(in) :: m(n)                 !! mass of the nodes
    real(dp), intent(in) :: external(:, :)       !! (n or more, axes) gravity and body forces
    real(dp), intent(in) :: dt                   !! velocity step
    real(dp), intent(inout) :: sums(nodes_sums)  !! of the plane, added to
    integer :: axis, side, i, nodes(2), point(3)
    do axis = 1, field%ndim
      do side = 1, 2
        if (.not. friction%coefficient(side, axis) > 0.0_dp) cycle
        call nodes_there(field, mesh, s, first, n, axis, side, nodes, point)
        do i = nodes(1), nodes(2)
          point(1) = first + i - 1
          call rub_node(field, mesh, friction%share(side, axis)*friction%coefficient(side, axis), &
                        s, point, axis, side, m(i), external(i, :), dt, sums)
        end do
      end do
    end do
  end subroutine wall_nodes_rub

  !> Gives nodes of a tile that stick to a wall its velocity after the re-map, too, so that what
  !! strains is what moves.
  pure subroutine wall_nodes_stick(field, mesh, friction, s, first, n)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(wall_friction_t), intent(in) :: friction
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    integer :: axis, side, i, nodes(2), point(3)
    do axis = 1, field%ndim
      do side = 1, 2
        if (.not. friction%coefficient(side, axis) > 0.0_dp) cycle
        call nodes_there(field, mesh, s, first, n, axis, side, nodes, point)
        do i = nodes(1), nodes(2)
          point(1) = first + i - 1
          call stick_node(field, mesh, s, point, axis, side)
        end do
      end do
    end do
  end subroutine wall_nodes_stick

  !> Those nodes of a tile that lie on a wall.
  pure subroutine nodes_there(field, mesh, s, first, n, axis, side, nodes, point)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n, axis, side
    integer, intent(out) :: nodes(2)             !! first and last, of the tile; none: last < first
    integer, intent(out) :: point(3)             !! the first one's place
    integer :: at
    nodes = [1, 0]
    point = [first, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (field%ndim == 2) point(2) = point(3)
    at = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
    if (axis == 1) then
      nodes = [max(1, at - first + 1), min(n, at - first + 1)]
    else if (point(axis) == at) then
      nodes(2) = n
    end if
  end subroutine nodes_there

  !> Whether a wall leaves the components of a node free; the others are held by it or by others, or
  !! prescribed with a part of a body.
  pure function free_components(field, mesh, s, point) result(free)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, point(3)           !! work interval, place of the node
    logical :: free(3)
    integer :: a, held_side, held_axis
    free = .false.
    if (field%columns%driven > 0) then
      call driven_nodes_pin(field, s, point(1), field%neighbour(0, 0, s) + point(1), free)
    end if
    do a = 1, vector_components(field%columns, field%ndim)
      call holding_wall(mesh, point, a, held_side, held_axis)
      free(a) = held_axis == 0 .and. .not. free(a)
    end do
  end function free_components

  !> Columns of a vector of the nodes that begins in a column.
  pure function columns_of(field, column) result(columns)
    type(field_t), intent(in) :: field
    integer, intent(in) :: column
    integer :: columns(3), a
    columns = [(vector_column(field%columns, column, a), a=1, 3)]
  end function columns_of

  !> The re-mapped velocity of one node at one wall: where the velocity after the kick is the wall's
  !! it stays so.
  pure subroutine stick_node(field, mesh, s, point, axis, side)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, point(3), axis, side
    logical :: free(3)
    integer :: record, n, from(3), to(3)
    n = vector_components(field%columns, field%ndim)
    record = field%neighbour(0, 0, s) + point(1)
    free = free_components(field, mesh, s, point)
    from = columns_of(field, node_velocity(field%ndim))
    to = columns_of(field, node_remapped)
    associate (wall => mesh%wall_motion(:, side, axis, wall_speed))
      if (any(free(:n) .and. abs(field%node(record, from(:n)) - wall(:n)) > 0.0_dp)) return
      field%node(record, to(:n)) = merge(wall(:n), field%node(record, to(:n)), free(:n))
    end associate
  end subroutine stick_node

  !> The same for one node and one wall.
  pure subroutine rub_node(field, mesh, coefficient, s, point, axis, side, m, external, dt, sums)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coefficient          !! of friction, of what presses here
    integer, intent(in) :: s, point(3), axis, side
    real(dp), intent(in) :: m, external(:), dt
    real(dp), intent(inout) :: sums(nodes_sums)
    real(dp) :: mass(3), scale(3), slip(3), force(3), applied(3), pressing, middle, wall_middle
    logical :: free(3), sticks
    integer :: record, face, a, at_velocity(3), at_acceleration(3)
    record = field%neighbour(0, 0, s) + point(1)
    if (.not. field%node(record, node_inverse_mass(field%ndim)) > 0.0_dp) return
    free = free_components(field, mesh, s, point)
    if (.not. any(free(:vector_components(field%columns, field%ndim)))) return
    mass = m
    if (field%space == space_axisymmetric) mass(1) = m*field%node(record, node_inertia)
    scale = [(vector_length(field, record, a), a=1, 3)]
    applied = 0.0_dp
    applied(:field%ndim) = external(:field%ndim)
    at_velocity = columns_of(field, node_velocity(field%ndim))
    at_acceleration = columns_of(field, node_acceleration)
    pressing = mass(axis)*field%node(record, node_acceleration + axis - 1) + &
               force_behind(field, mesh, point, axis, side)
    if (side == 1) pressing = -pressing
    face = 2*(axis - 1) + side - 1
    sums(nodes_pressed + face) = sums(nodes_pressed + face) + max(0.0_dp, pressing)
    sums(nodes_pulled + face) = sums(nodes_pulled + face) + max(0.0_dp, -pressing)
    slip = 0.0_dp
    do a = 1, vector_components(field%columns, field%ndim)
      if (free(a)) slip(a) = scale(a)*field%node(record, at_velocity(a)) - &
                             mesh%wall_motion(a, side, axis, wall_speed)
    end do
    call wall_friction_force(mass*slip/dt, coefficient*pressing, force, sticks)
    if (mesh%walls_weigh) then
      associate (reaction => sums(wall_entry(side, axis):wall_entry(side, axis) + 2), &
                 n => field%ndim)
        reaction(:n) = reaction(:n) + force(:n)
      end associate
    end if
    do a = 1, vector_components(field%columns, field%ndim)
      if (.not. abs(force(a)) > 0.0_dp) cycle
      associate (acceleration => field%node(record, at_acceleration(a)), &
                 velocity => field%node(record, at_velocity(a)))
        acceleration = acceleration + force(a)/(scale(a)*mass(a))
        velocity = velocity + dt*force(a)/(scale(a)*mass(a))
        if (sticks) velocity = mesh%wall_motion(a, side, axis, wall_speed)
        middle = scale(a)*(velocity - 0.5_dp*dt*acceleration)
      end associate
      wall_middle = mesh%wall_motion(a, side, axis, wall_speed) - &
                    0.5_dp*dt*mesh%wall_motion(a, side, axis, wall_kick)
      sums(nodes_external) = sums(nodes_external) + force(a)*wall_middle
      if (sticks) force(a) = mass(a)*scale(a)*field%node(record, at_acceleration(a)) - &
                             applied(a)
      sums(nodes_taken) = sums(nodes_taken) - force(a)*(middle - wall_middle)
    end do
  end subroutine rub_node

  !> Coulomb's law: the force that stops what needs -`needed` to stop, as far as `most` goes.
  pure subroutine wall_friction_force(needed, most, force, sticks)
    real(dp), intent(in) :: needed(3)            !! mass times slip over the time (force)
    real(dp), intent(in) :: most                 !! friction times what presses; below 0: it pulls
    real(dp), intent(out) :: force(3)
    logical, intent(out) :: sticks               !! it is enough
    real(dp) :: length
    length = norm2(needed)
    sticks = most >= length
    if (sticks) then
      force = -needed
    else
      force = -(max(0.0_dp, most)/max(length, tiny(1.0_dp)))*needed
    end if
  end subroutine wall_friction_force

  !> Twice the force along the normal that particles gave to the node behind a wall's node.
  pure function force_behind(field, mesh, point, axis, side) result(force)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: point(3), axis, side
    real(dp) :: force
    integer :: there(3), image
    force = 0.0_dp
    if (kernel_centred(field%kernel) .or. .not. kernel_folds(field%kernel)) return
    there = point
    call ghost_point(mesh, axis, side, .false., there(axis), image)
    force = 2.0_dp*kept_force(field, mesh, there, axis, axis + 1)
  end function force_behind

  !> Force along the normal that was kept of a point behind a wall, and of the points behind it and
  !! the walls of later axes: beside an edge, their part has been folded after it was kept.
  pure recursive function kept_force(field, mesh, point, axis, later) result(force)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: point(3), axis
    integer, intent(in) :: later                 !! the first axis whose walls are looked behind
    real(dp) :: force
    integer :: other, side, ghost, image, beyond(3)
    force = force_at(field, point, axis)
    do other = later, mesh%ndim
      do side = 1, 2
        if (mesh%wall(side, other) == wall_free) cycle
        call ghost_point(mesh, other, side, .false., ghost, image)
        if (point(other) /= image) cycle
        beyond = point
        beyond(other) = ghost
        force = force + vector_parity(axis, other, mesh%wall(side, other))* &
                kept_force(field, mesh, beyond, axis, other + 1)
      end do
    end do
  end function kept_force

  !> The same of one point; 0 where the field has none.
  pure function force_at(field, point, axis) result(force)
    type(field_t), intent(in) :: field
    integer, intent(in) :: point(3), axis
    real(dp) :: force
    integer :: there(3), base
    force = 0.0_dp
    there = point
    if (field%ndim == 2) there = [point(1), 0, point(2)]
    base = field_base(field, there(2), there(3), there(1))
    if (base == huge(1)) return
    force = field%moment(base + there(1), field%columns%behind(axis) + field%ndim + axis)
  end function force_at

end module sgmp_wall_friction
