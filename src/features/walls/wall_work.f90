!> The work of walls that move along themselves, for the energy ledger.
!!
!! A wall acts on particles in three ways, each a force F whose power is F . (V + V-)/2, V- and V
!! its velocities before and after the kick: it holds nodes that the force f would accelerate,
!!   F = m A - f;
!! particles read the mirror image a_g of the acceleration a_i behind the wall,
!!   F = m_g (a_g - a_i), m_g the mass that lay there;
!! and the force f_g that they gave to nodes there was folded with its sign turned, F = -2 f_g.
!! (Stresses at auxiliary nodes are even, there is no such force.) Together they are what the
!! momentum of the particles gains beyond their own forces.
!!
!! The kinetic identity (sgmp_energy) wants sum_p m_p a_p . v_p at the velocity before the kick,
!! which is sum_I m_I a_I . v_I- only where walls are at rest. What it is more: (p - m V-) . A at
!! nodes on walls, p_g . (a_g + a_i) - 2 m_g V- . a_i behind them. Behind walls at rest, slip walls
!! too, it is not nothing in edges where one that speeds up meets them.
module sgmp_wall_work
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_acceleration, node_inverse_mass, node_velocity
  use sgmp_field, only: field_base, field_t
  use sgmp_images, only: vector_parity
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free, wall_kick, wall_speed
  use sgmp_rigid_bodies, only: rigid_field
  use sgmp_rows, only: key_j, key_k
  use sgmp_sums, only: nodes_external, nodes_mass_av, nodes_sums, sweep_sums
  use sgmp_tally, only: tally_add, tally_t
  use sgmp_walls, only: ghost_intervals, ghost_point, ghost_records
  implicit none
  private
  public :: ghost_force, holding_wall, phase_wall_work, wall_nodes_book

contains

  !> Books what walls do to the nodes of a tile that lie on them, which have their accelerations and
  !! velocities as if there were no wall.
  pure subroutine wall_nodes_book(field, mesh, s, first, n, m, dt, sums)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    real(dp), intent(in) :: m(n), dt
    real(dp), intent(inout) :: sums(nodes_sums)
    real(dp) :: kick, speed, force
    integer :: i, a, side, axis, record, point(3)
    point = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (field%ndim == 2) point(2) = point(3)
    do i = 1, n
      point(1) = first + i - 1
      record = field%neighbour(0, 0, s) + point(1)
      if (.not. field%node(record, node_inverse_mass(field%ndim)) > 0.0_dp) cycle
      do a = 1, field%ndim
        call holding_wall(mesh, point, a, side, axis)
        if (axis == 0) cycle
        kick = mesh%wall_motion(a, side, axis, wall_kick)
        speed = mesh%wall_motion(a, side, axis, wall_speed)
        associate (acceleration => field%node(record, node_acceleration + a - 1), &
                   velocity => field%node(record, node_velocity(field%ndim) + a - 1))
          force = m(i)*(kick - acceleration)
          sums(nodes_external) = sums(nodes_external) + (speed - 0.5_dp*dt*kick)*force
          sums(nodes_mass_av) = sums(nodes_mass_av) + &
            m(i)*kick*((velocity - dt*acceleration) - (speed - dt*kick))
        end associate
      end do
    end do
  end subroutine wall_nodes_book

  !> The wall that holds component `a` of the node at `point` (3), as walls_hold has it: its side
  !! and axis; axis = 0: none.
  pure subroutine holding_wall(mesh, point, a, held_side, held_axis)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: point(3), a
    integer, intent(out) :: held_side, held_axis
    integer :: turn, axis, side
    held_side = 1
    held_axis = 0
    do turn = a, a + mesh%ndim - 1
      axis = modulo(turn, mesh%ndim) + 1
      do side = 1, 2
        if (mesh%wall(side, axis) == wall_free) cycle
        if (axis /= a .and. mesh%wall(side, axis) /= wall_fixed) cycle
        if (point(axis) /= merge(mesh%lower(axis), mesh%upper(axis), side == 1)) cycle
        held_side = side
        held_axis = axis
      end do
    end do
  end subroutine holding_wall

  !> Books what walls do by what particles read and gave behind them, in the planes of this rank;
  !! the nodes there are mirror images already.
  pure subroutine phase_wall_work(mesh, fields, bodies, own, dt, tally)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: own(2)                !! planes of this rank
    real(dp), intent(in) :: dt                   !! velocity step
    type(tally_t), intent(inout) :: tally
    real(dp) :: terms(2)
    integer :: f, axis, side, s, ghost, image, first, last, at_ghost, at_image, n, i
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0) cycle
      do axis = 1, mesh%ndim
        if (fields(f)%columns%behind(axis) == 0) cycle
        do side = 1, 2
          if (mesh%wall(side, axis) == wall_free) cycle
          call ghost_point(mesh, axis, side, kernel_centred(fields(f)%kernel), ghost, image)
          call ghost_intervals(fields(f), axis, ghost, 1, fields(f)%planes, first, last)
          do s = first, last
            call ghost_records(fields(f), s, axis, ghost, image, at_ghost, at_image, n)
            if (key_k(fields(f)%work%key(s)) < own(1)) cycle
            if (key_k(fields(f)%work%key(s)) > own(2)) cycle
            do i = 0, n - 1
              terms = ghost_terms(mesh, fields(f), axis, side, s, at_ghost + i, image, dt)
              call tally_add(tally, size(bodies)*sweep_sums + nodes_mass_av, terms)
            end do
          end do
        end do
      end do
    end do
  end subroutine phase_wall_work

  !> What one point behind a wall adds to the power at the velocity before the kick, and to the
  !! power of the wall.
  pure function ghost_terms(mesh, field, axis, side, s, record, image, dt) result(terms)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    integer, intent(in) :: axis, side            !! of the wall
    integer, intent(in) :: s, record             !! work interval and record of the point
    integer, intent(in) :: image                 !! place of its image along the axis
    real(dp), intent(in) :: dt
    real(dp) :: terms(nodes_mass_av:nodes_external)
    real(dp) :: here, there, parity, middle, before, force(3)
    integer :: a, point(3), mirrored(3)
    terms = 0.0_dp
    point = [record - field%neighbour(0, 0, s), key_j(field%work%key(s)), key_k(field%work%key(s))]
    mirrored = point
    mirrored(merge(3, axis, axis == field%ndim .and. axis > 1)) = image
    force = ghost_force(mesh, field, axis, side, s, record, image)
    associate (behind => field%moment(record, field%columns%behind(axis):))
      if (.not. behind(1) > 0.0_dp) return
      do a = 1, field%ndim
        parity = vector_parity(a, axis, mesh%wall(side, axis))
        here = value_at(field, point, node_acceleration + a - 1)
        there = value_at(field, mirrored, node_acceleration + a - 1)
        associate (speed => mesh%wall_motion(a, side, axis, wall_speed), &
                   kick => mesh%wall_motion(a, side, axis, wall_kick))
          before = speed - dt*kick
          middle = speed - 0.5_dp*dt*kick
        end associate
        terms(nodes_mass_av) = terms(nodes_mass_av) + behind(1 + a)*(here - parity*there) - &
                               (1.0_dp - parity)*behind(1)*before*there
        terms(nodes_external) = terms(nodes_external) + middle*force(a)
      end do
    end associate
  end function ghost_terms

  !> Force of a wall on matter by one point behind it.
  pure function ghost_force(mesh, field, axis, side, s, record, image) result(force)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    integer, intent(in) :: axis, side            !! of the wall
    integer, intent(in) :: s, record             !! work interval and record of the point
    integer, intent(in) :: image                 !! place of its image along the axis
    real(dp) :: force(3)
    integer :: a, point(3), mirrored(3)
    force = 0.0_dp
    point = [record - field%neighbour(0, 0, s), key_j(field%work%key(s)), key_k(field%work%key(s))]
    mirrored = point
    mirrored(merge(3, axis, axis == field%ndim .and. axis > 1)) = image
    associate (behind => field%moment(record, field%columns%behind(axis):))
      if (.not. behind(1) > 0.0_dp) return
      do a = 1, field%ndim
        force(a) = behind(1)*(value_at(field, point, node_acceleration + a - 1) - &
                              value_at(field, mirrored, node_acceleration + a - 1))
        if (kernel_centred(field%kernel)) cycle
        force(a) = force(a) - (1.0_dp - vector_parity(a, axis, mesh%wall(side, axis)))* &
                   behind(1 + field%ndim + a)
      end do
    end associate
  end function ghost_force

  !> What particles read at a point (i, j, k): the node, or the mean of the nodes around a centre.
  pure function value_at(field, point, column) result(value)
    type(field_t), intent(in) :: field
    integer, intent(in) :: point(3), column
    real(dp) :: value
    integer :: j, k, record, reach(3)
    reach = 0
    if (kernel_centred(field%kernel)) reach = merge([1, 1, 1], [0, 0, 0], &
                                                    [.true., field%ndim == 3, field%ndim > 1])
    value = 0.0_dp
    do k = point(3), point(3) + reach(3)
      do j = point(2), point(2) + reach(2)
        record = field_base(field, j, k, point(1)) + point(1)
        value = value + sum(field%node(record:record + reach(1), column))
      end do
    end do
    value = value*0.5_dp**sum(reach)
  end function value_at

end module sgmp_wall_work
