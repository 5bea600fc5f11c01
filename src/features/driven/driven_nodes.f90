!> Nodes whose motion is prescribed because most of their mass is.
!!
!! A node moves as a driven part does if at least `least_part` of its mass is that of the part's
!! particles: it has the velocity V and the acceleration A = (V - V-)/dt, V- the velocity in the
!! step before, as a node on a wall has. The force that it takes is F = m A - f.
!!
!! The kinetic identity (sgmp_energy) wants p . A with the momentum p that is there before the kick.
!! At nodes that other particles share, and where a part turns, p is not m V-: the difference is
!! drive_power, and as F moves p with A its power is F . (V + V-)/2 + (p - m V-) . A.
!!
!! What accelerates driven particles counts with them (sgmp_driven_particles), so that a part which
!! moves as a whole takes torque and work to round-off: m A acts at their places and not at those of
!! the nodes, and dt/2 m |A|^2 (drive_jolt), which is more at the nodes, is that of the particles.
module sgmp_driven_nodes
  use sgmp_columns, only: node_acceleration, node_inertia, node_inverse_mass, node_velocity, &
                          vector_column, vector_components
  use sgmp_drive, only: drive_add, drive_jolt, drive_sums, drive_velocity, drive_velocity_before, &
                        most_drives
  use sgmp_field, only: field_t
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_places, mesh_t
  use sgmp_node_vectors, only: vector_length
  use sgmp_rows, only: key_j, key_k
  use sgmp_wall_work, only: holding_wall
  implicit none
  private
  public :: driven_nodes_hold, driven_nodes_pin, driven_nodes_push, driven_nodes_solve, &
            driven_nodes_velocity

  !> Part of a node's mass that makes it driven. Where a part ends on a line of nodes these have
  !! one half, about an axis 1/2 - h/(6 r) where the part is the inner one.
  real(dp), parameter :: least_part = 0.15_dp

  integer, parameter :: around = 3             !! component around the axis

contains

  !> Holds the driven nodes of a tile, which have their accelerations and velocities as if they were
  !! free, and sums up what that takes.
  pure subroutine driven_nodes_solve(field, mesh, s, first, n, m, dt, plane)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    real(dp), intent(in) :: m(n)                 !! their masses
    real(dp), intent(in) :: dt                   !! velocity step
    integer, intent(in) :: plane                 !! of the field
    real(dp), dimension(3, most_drives) :: v, before, force
    real(dp) :: part(most_drives), power(most_drives), extra(most_drives), place(3), kick(3)
    logical :: rules(3, most_drives)
    integer :: i, k, record, point(3)
    if (.not. any(field%drives%acts)) return
    do i = 1, n
      record = field%neighbour(0, 0, s) + first + i - 1
      call parts_of(field, mesh, s, first + i - 1, record, point, part, rules)
      if (.not. any(part > 0.0_dp)) cycle
      call speeds(field, mesh, record, point, part, place, v, before)
      call hold(field, record, m(i), dt, part, rules, v, before, force, power, extra)
      do k = 1, size(field%drives)
        if (.not. part(k) > 0.0_dp) cycle
        kick = accelerated(field, record, k)
        call drive_add(field%drives(k), place, force(:, k), force(:, k) - part(k)*m(i)*kick, &
                       power(k) - part(k)*m(i)*drive_jolt(field%drives(k), place, dt), extra(k), &
                       field%drive_sums(:, k, plane))
      end do
    end do
  end subroutine driven_nodes_solve

  !> Gives a node the motion of the parts that rule it: the force of each, its power, and what it
  !! adds to drive_power.
  pure subroutine hold(field, record, m, dt, part, rules, v, before, force, power, extra)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: record
    real(dp), intent(in) :: m, dt                !! mass, velocity step
    real(dp), intent(in) :: part(most_drives), v(3, most_drives), before(3, most_drives)
    logical, intent(in) :: rules(3, most_drives)
    real(dp), intent(out) :: force(3, most_drives), power(most_drives), extra(most_drives)
    real(dp) :: share(most_drives), now, was, kick, own, mass, pic, scale
    integer :: a
    pic = maxval(field%drives%pic)
    force = 0.0_dp
    power = 0.0_dp
    extra = 0.0_dp
    do a = 1, vector_components(field%columns, field%ndim)
      if (.not. any(rules(a, :))) cycle
      share = merge(part, 0.0_dp, rules(a, :))
      share = share/sum(share)
      now = sum(share*v(a, :))
      was = sum(share*before(a, :))
      kick = (now - was)/dt
      scale = vector_length(field, record, a)
      associate (velocity => &
                   field%node(record, vector_column(field%columns, node_velocity(field%ndim), a)), &
                 acceleration => &
                   field%node(record, vector_column(field%columns, node_acceleration, a)))
        if (field%node(record, node_inverse_mass(field%ndim)) > 0.0_dp) then
          mass = m
          if (a == 1 .and. field%columns%radial > 0) mass = mass*field%node(record, node_inertia)
          own = scale*(velocity - dt*acceleration)
          force(a, :) = share*(mass*(kick - scale*acceleration))
          ! PIC reads V- of the node where p/m would keep the momentum.
          if (pic > 0.0_dp) force(a, :) = force(a, :) + share*(mass*(pic*(was - own)/dt))
          power = power + force(a, :)*(0.5_dp*(now + was)) + share*(mass*kick*(own - was))
          extra = extra + share*(mass*kick*(own - was))
          acceleration = kick/scale
        end if
        velocity = now/scale
      end associate
    end do
  end subroutine hold

  !> Acceleration of a node along the axes that a drive prescribes.
  pure function accelerated(field, record, k) result(acceleration)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, k
    real(dp) :: acceleration(3)
    integer :: a
    acceleration = 0.0_dp
    do a = 1, vector_components(field%columns, field%ndim)
      if (field%drives(k)%axes(a)) then
        acceleration(a) = vector_length(field, record, a)* &
                          field%node(record, vector_column(field%columns, node_acceleration, a))
      end if
    end do
  end function accelerated

  !> Gives the driven nodes of a tile their velocity, in the vector that starts at `column`.
  pure subroutine driven_nodes_velocity(field, mesh, s, first, n, column, before_kick)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    integer, intent(in) :: column
    logical, intent(in) :: before_kick           !! that of the step before
    real(dp), dimension(3, most_drives) :: v, before
    real(dp) :: part(most_drives), place(3)
    logical :: rules(3, most_drives)
    integer :: i, a, record, point(3)
    if (.not. any(field%drives%acts)) return
    do i = 1, n
      record = field%neighbour(0, 0, s) + first + i - 1
      call parts_of(field, mesh, s, first + i - 1, record, point, part, rules)
      if (.not. any(rules)) cycle
      call speeds(field, mesh, record, point, part, place, v, before)
      if (before_kick) v = before
      do a = 1, vector_components(field%columns, field%ndim)
        if (.not. any(rules(a, :))) cycle
        field%node(record, vector_column(field%columns, column, a)) = &
          sum(part*v(a, :), mask=rules(a, :))/sum(part, mask=rules(a, :))/ &
          vector_length(field, record, a)
      end do
    end do
  end subroutine driven_nodes_velocity

  !> Nodes of a tile that have enough driven mass to be moved with a part, walls or not.
  pure subroutine driven_nodes_hold(field, s, first, n, held)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    logical, intent(out) :: held(:)
    real(dp) :: part
    integer :: i, k
    held = .false.
    do i = 1, n
      part = 0.0_dp
      do k = 1, size(field%drives)
        if (field%drives(k)%acts) part = part + mass_at(field, s, first + i - 1, &
                                                        field%columns%drives + k - 1)
      end do
      if (part > 0.0_dp) held(i) = part >= least_part*mass_at(field, s, first + i - 1, &
                                                              field%columns%mass)
    end do
  end subroutine driven_nodes_hold

  !> Which components of a node's velocity parts prescribe, walls or not.
  pure subroutine driven_nodes_pin(field, s, i, record, held)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, i, record          !! work interval, place in it, record
    logical, intent(out) :: held(3)
    real(dp) :: part(most_drives)
    logical :: rules(3, most_drives)
    held = .false.
    if (.not. any(field%drives%acts)) return
    call shares_of(field, s, i, record, part, rules)
    held = any(rules, 2)
  end subroutine driven_nodes_pin

  !> A force with which contact pushes a node, which whoever prescribes its motion takes: what it
  !! adds to the sums of the drives.
  pure subroutine driven_nodes_push(field, mesh, s, i, record, force, power, sums)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, i, record          !! work interval, place in it, record
    real(dp), intent(in) :: force(3), power(3)   !! on the node; its components' power
    real(dp), intent(out) :: sums(drive_sums, size(field%drives))
    real(dp), dimension(3, most_drives) :: v, before, share
    real(dp) :: part(most_drives), place(3)
    logical :: rules(3, most_drives)
    integer :: a, k, point(3)
    sums = 0.0_dp
    call parts_of(field, mesh, s, i, record, point, part, rules)
    if (.not. any(rules)) return
    call speeds(field, mesh, record, point, part, place, v, before)
    share = 0.0_dp
    do a = 1, vector_components(field%columns, field%ndim)
      if (any(rules(a, :))) share(a, :) = merge(part, 0.0_dp, rules(a, :))/ &
                                          sum(part, mask=rules(a, :))
    end do
    do k = 1, size(field%drives)
      call drive_add(field%drives(k), place, -share(:, k)*force, -share(:, k)*force, &
                     -sum(share(:, k)*power), 0.0_dp, sums(:, k))
    end do
  end subroutine driven_nodes_push

  !> Parts of a node's mass that are driven, and which of them rule its components; walls come
  !! first.
  pure subroutine parts_of(field, mesh, s, i, record, point, part, rules)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, i, record          !! work interval, place in it, record
    integer, intent(out) :: point(3)
    real(dp), intent(out) :: part(most_drives)
    logical, intent(out) :: rules(3, most_drives)
    integer :: a, side, axis
    point = [i, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (field%ndim == 2) point(2) = point(3)
    call shares_of(field, s, i, record, part, rules)
    do a = 1, vector_components(field%columns, field%ndim)
      if (.not. any(rules(a, :))) cycle
      call holding_wall(mesh, point, a, side, axis)
      if (axis > 0) rules(a, :) = .false.
    end do
  end subroutine parts_of

  !> The same without walls.
  pure subroutine shares_of(field, s, i, record, part, rules)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, i, record          !! work interval, place in it, record
    real(dp), intent(out) :: part(most_drives)
    logical, intent(out) :: rules(3, most_drives)
    integer :: a, k
    rules = .false.
    part = 0.0_dp
    associate (inverse => field%node(record, node_inverse_mass(field%ndim)))
      if (.not. abs(inverse) > 0.0_dp) return
      do k = 1, size(field%drives)
        if (field%drives(k)%acts) part(k) = abs(inverse)*mass_at(field, s, i, &
                                                                 field%columns%drives + k - 1)
      end do
    end associate
    if (sum(part) < least_part) return
    do a = 1, vector_components(field%columns, field%ndim)
      do k = 1, size(field%drives)
        rules(a, k) = part(k) > 0.0_dp .and. field%drives(k)%axes(a)
      end do
      if (sum(part, mask=rules(a, :)) < least_part) rules(a, :) = .false.
    end do
  end subroutine shares_of

  !> Where a node is, and the velocities there of the parts that have mass, now and in the step
  !! before.
  pure subroutine speeds(field, mesh, record, point, part, place, v, before)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: record, point(3)
    real(dp), intent(in) :: part(most_drives)
    real(dp), intent(out) :: place(3), v(3, most_drives), before(3, most_drives)
    integer :: k, n
    n = field%ndim
    place = 0.0_dp
    place(:n) = mesh_places(mesh, real(point(:n), dp))
    if (vector_components(field%columns, n) > n) then
      place(1) = mesh%h*vector_length(field, record, around)
    end if
    v = 0.0_dp
    before = 0.0_dp
    do k = 1, size(field%drives)
      if (.not. part(k) > 0.0_dp) cycle
      v(:, k) = drive_velocity(field%drives(k), place)
      before(:, k) = drive_velocity_before(field%drives(k), place)
    end do
  end subroutine speeds

  !> A column of masses at a node: with sgmp the mean of the centres around it.
  pure function mass_at(field, s, i, column) result(mass)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, i, column
    real(dp) :: mass
    integer :: dj, dk, record
    if (.not. kernel_centred(field%kernel)) then
      mass = field%moment(field%neighbour(0, 0, s) + i, column)
      return
    end if
    mass = 0.0_dp
    do dj = merge(-1, 0, field%ndim == 3), 0
      do dk = merge(-1, 0, field%ndim >= 2), 0
        record = field%neighbour(dj, dk, s) + i
        mass = mass + field%moment(record - 1, column) + field%moment(record, column)
      end do
    end do
    mass = 0.5_dp**field%ndim*mass
  end function mass_at

end module sgmp_driven_nodes
