!> A consistent mass in the place of the lumped one (`method mass=consistent`, doc/mass.md).
!!
!! Particles give their momentum to nodes and take velocities from them by averages, which smooth
!! every wave twice on its way; gradients smooth it twice more. The consistent mass of the nodes
!! knows of the former, the lumped one does not: waves are slow by a third of (k h)^2. Here the
!! inverse of the mass is
!!
!!     P = M^-1 (M + K) M^-1,   (K v)_I = part sum_J min(M_I, M_J) (v_I - v_J),   J next to I
!!
!! for momentum (v = P p), forces (a = P f) and the places of nodes (doc/rotation.md) alike: P is
!! symmetric, so momentum, angular momentum and the identities of the energy stay as they are.
module sgmp_consistent_mass
  use sgmp_columns, only: node_acceleration, node_inverse_mass, node_velocity
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_rotation_points, only: at_node
  use sgmp_rows, only: key_j, key_k
  use sgmp_sums, only: nodes_external, nodes_mass_aa, nodes_mass_av, nodes_sums
  implicit none
  private
  public :: consistent_add, consistent_book, consistent_gains, consistent_kick, consistent_masses, &
            consistent_offsets, consistent_offsets_keep, consistent_remap, consistent_strain

  !> By which the dispersion of the second order vanishes: means over nodes and particles have the
  !! second moment 5/12 along an axis, gradients 1/4 along theirs; 5/12 + 1/4 = 2/3 is 0.35 twice,
  !! with what two particles per cell add.
  real(dp), parameter :: part = 0.35_dp
  integer, parameter :: tile = 128   !! nodes of a row that are handled at a time

contains

  !> Inverse masses of the nodes of one plane, before the momentum equation finds them.
  pure subroutine consistent_masses(field, plane, cutoff)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    real(dp), intent(in) :: cutoff               !! nodes lighter than this are ignored
    integer :: s, i, at, r, rows(4), nrows
    real(dp) :: m
    nrows = 2**(field%ndim - 1)
    associate (inverse => node_inverse_mass(field%ndim), mass => field%columns%mass)
      do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
        at = field%neighbour(0, 0, s)
        do r = 1, nrows
          rows(r) = field%neighbour((r - 1)/2 - field%ndim + 2, mod(r - 1, 2) - 1, s)
        end do
        if (field%ndim == 1) rows(1) = at
        do i = field%work%first(s), field%work%last(s)
          m = 0.0_dp
          do r = 1, nrows
            m = m + (field%moment(rows(r) + i - 1, mass) + field%moment(rows(r) + i, mass))
          end do
          m = m*0.5_dp**field%ndim
          field%node(at + i, inverse) = 0.0_dp
          if (m > cutoff) field%node(at + i, inverse) = 1.0_dp/m
        end do
      end do
    end associate
  end subroutine consistent_masses

  !> What vectors of the nodes of one plane gain, M^-1 K v, each from a column of the nodes on.
  pure subroutine consistent_gains(field, mesh, plane, columns)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane, columns(:)
    real(dp) :: weight(tile, 2, 3)
    integer :: s, first, n, c, a, at, nd
    integer :: step(2, 3)
    nd = field%ndim
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      call row_steps(field, s, step)
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        at = field%neighbour(0, 0, s) + first
        call tile_weights(field, mesh, s, first, n, step, weight)
        do c = 1, size(columns)
          do a = 1, nd
            call gain_row(n, nd, weight, step + at, at, field%node(:, columns(c) + a - 1), &
                          field%mass%gain(at:at + n - 1, (c - 1)*nd + a))
          end do
          call hold_gains(field, mesh, s, first, n, (c - 1)*nd)
        end do
      end do
    end do
  end subroutine consistent_gains

  !> From a row of nodes to those next to it, lower and upper along each axis.
  pure subroutine row_steps(field, s, step)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s
    integer, intent(out) :: step(2, 3)           !! records
    integer :: side, way
    step = 0
    do side = 1, 2
      way = 2*side - 3
      step(side, 1) = way
      if (field%ndim == 3) step(side, 2) = field%neighbour(way, 0, s) - field%neighbour(0, 0, s)
      if (field%ndim > 1) step(side, field%ndim) = field%neighbour(0, way, s) - &
                                                   field%neighbour(0, 0, s)
    end do
  end subroutine row_steps

  !> Weights of the nodes next to those of a tile, part min(M_I, M_J)/M_I. A node on a wall stands
  !! for half of what it is with its mirror image, and its neighbour behind the wall is the image of
  !! that before it.
  pure subroutine tile_weights(field, mesh, s, first, n, step, weight)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n, step(2, 3)
    real(dp), intent(out) :: weight(tile, 2, 3)
    integer :: axis, side, i, at, to, inverse, row(3)
    real(dp) :: own, other
    inverse = node_inverse_mass(field%ndim)
    at = field%neighbour(0, 0, s) + first - 1
    row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (field%ndim == 2) row(2) = row(3)
    do axis = 1, field%ndim
      do side = 1, 2
        to = at + step(side, axis)
        own = 1.0_dp
        other = 1.0_dp
        if (axis > 1) then
          if (on_wall(mesh, axis, row(axis)) > 0) own = 0.5_dp
          if (on_wall(mesh, axis, row(axis) + 2*side - 3) > 0) other = 0.5_dp
        end if
        !$omp simd
        do i = 1, n
          weight(i, side, axis) = edge(own*field%node(at + i, inverse), &
                                       other*field%node(to + i, inverse))
        end do
        if (own < 1.0_dp) weight(:n, side, axis) = 2.0_dp*weight(:n, side, axis)
      end do
    end do
    call weigh_at_walls(field, mesh, first, n, at, weight(:, :, 1))
  end subroutine tile_weights

  !> The same along the rows, next to walls across them.
  pure subroutine weigh_at_walls(field, mesh, first, n, at, weight)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: first, n, at          !! record before the first
    real(dp), intent(inout) :: weight(tile, 2)
    integer :: wall, inner, inverse, i, outer
    inverse = node_inverse_mass(field%ndim)
    do wall = 1, 2
      if (mesh%wall(wall, 1) == wall_free) cycle
      inner = 3 - wall                           ! side of what lies inside
      i = merge(mesh%lower(1), mesh%upper(1), wall == 1) - first + 1
      if (i >= 1 .and. i <= n) then
        outer = at + i + 2*inner - 3
        weight(i, inner) = 2.0_dp*edge(0.5_dp*field%node(at + i, inverse), &
                                       field%node(outer, inverse))
      end if
      i = i + 2*inner - 3
      if (i < 1 .or. i > n) cycle
      weight(i, wall) = edge(field%node(at + i, inverse), &
                             0.5_dp*field%node(at + i + 2*wall - 3, inverse))
    end do
  end subroutine weigh_at_walls

  !> Part of the exchange between two nodes, by the inverse masses of both.
  elemental function edge(own, other) result(weight)
    !$omp declare simd(edge)
    real(dp), intent(in) :: own, other
    real(dp) :: weight
    real(dp) :: divisor
    logical :: both
    both = own > 0.0_dp .and. other > 0.0_dp
    divisor = merge(max(own, other), 1.0_dp, both)
    weight = merge(part*own/divisor, 0.0_dp, both)
  end function edge

  !> Which wall of an axis a node lies on: 1, 2, or 0 for none.
  pure integer function on_wall(mesh, axis, place) result(side)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, place
    side = 0
    if (mesh%wall(1, axis) /= wall_free .and. place == mesh%lower(axis)) side = 1
    if (mesh%wall(2, axis) /= wall_free .and. place == mesh%upper(axis)) side = 2
  end function on_wall

  !> One component of the gains of a tile.
  pure subroutine gain_row(n, ndim, weight, to, at, value, gain)
    integer, intent(in) :: n, ndim, at           !! record of the first node
    real(dp), intent(in) :: weight(tile, 2, 3)
    integer, intent(in) :: to(2, 3)              !! records of the first of the nodes next to them
    real(dp), intent(in) :: value(:)             !! (points)
    real(dp), intent(out) :: gain(n)
    integer :: axis, i, low, high
    gain = 0.0_dp
    do axis = 1, ndim
      low = to(1, axis) - 1
      high = to(2, axis) - 1
      !$omp simd
      do i = 1, n
        gain(i) = gain(i) + (weight(i, 1, axis)*(value(at - 1 + i) - value(low + i)) + &
                             weight(i, 2, axis)*(value(at - 1 + i) - value(high + i)))
      end do
    end do
  end subroutine gain_row

  !> Nodes on walls keep the components that walls hold.
  pure subroutine hold_gains(field, mesh, s, first, n, before)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    integer, intent(in) :: before                !! columns before those of the vector
    integer :: axis, side, a, at, row(3)
    row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (field%ndim == 2) row(2) = row(3)
    do axis = 1, field%ndim
      do side = 1, 2
        if (mesh%wall(side, axis) == wall_free) cycle
        at = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
        do a = 1, field%ndim
          if (a /= axis .and. mesh%wall(side, axis) /= wall_fixed) cycle
          if (axis == 1) then
            if (at < first .or. at >= first + n) cycle
            field%mass%gain(field%neighbour(0, 0, s) + at, before + a) = 0.0_dp
          else if (row(axis) == at) then
            field%mass%gain(field%neighbour(0, 0, s) + first: &
                            field%neighbour(0, 0, s) + first + n - 1, before + a) = 0.0_dp
          end if
        end do
      end do
    end do
  end subroutine hold_gains

  !> Books what the gains change of the sums over nodes of one plane, before they are added: powers
  !! of all forces and of those from outside at the velocity before the kick, sum f . P f; keeps the
  !! forces.
  pure subroutine consistent_book(field, plane, dt, lag, gravity, forced, sums)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    real(dp), intent(in) :: dt, lag, gravity(3)
    logical, intent(in) :: forced                !! there are forces from outside beside gravity
    real(dp), intent(inout) :: sums(nodes_sums)
    real(dp) :: lane_sums(lanes, 3), m(tile), terms(tile, 3), f, outside, kick, more
    integer :: s, i, a, l, at, nd, first, n
    nd = field%ndim
    lane_sums = 0.0_dp
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        at = field%neighbour(0, 0, s) + first - 1
        m(:n) = node_masses(field%node(at + 1:at + n, node_inverse_mass(nd)))
        terms(:n, :) = 0.0_dp
        do a = 1, nd
          !$omp simd private(f, outside, kick, more)
          do i = 1, n
            f = m(i)*field%node(at + i, node_acceleration + a - 1)
            field%mass%force(at + i, a) = f
            outside = m(i)*gravity(a)
            if (forced) outside = merge(field%mass%external(at + i, a), 0.0_dp, m(i) > 0.0_dp)
            kick = field%mass%gain(at + i, a)
            more = field%mass%gain(at + i, nd + a)
            terms(i, 1) = terms(i, 1) + f*kick
            terms(i, 2) = terms(i, 2) + f*(more - dt*kick)
            terms(i, 3) = terms(i, 3) + outside*(more - lag*dt*kick)
          end do
        end do
        do i = 1, n
          l = 1 + modulo(first + i - 1, lanes)
          lane_sums(l, :) = lane_sums(l, :) + terms(i, :)
        end do
      end do
    end do
    sums(nodes_mass_aa) = sums(nodes_mass_aa) + sum(lane_sums(:, 1))
    sums(nodes_mass_av) = sums(nodes_mass_av) + sum(lane_sums(:, 2))
    sums(nodes_external) = sums(nodes_external) + sum(lane_sums(:, 3))
  end subroutine consistent_book

  !> Masses of nodes, 0 of those too light to be accelerated.
  elemental real(dp) function node_masses(inverse) result(mass)
    real(dp), intent(in) :: inverse
    mass = merge(1.0_dp/merge(inverse, 1.0_dp, inverse > 0.0_dp), 0.0_dp, inverse > 0.0_dp)
  end function node_masses

  !> Adds the gains to the vectors of one plane, each from a column on.
  pure subroutine consistent_add(field, plane, columns)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane, columns(:)
    integer :: s, c, first, last, nd
    nd = field%ndim
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      first = field%neighbour(0, 0, s) + field%work%first(s)
      last = field%neighbour(0, 0, s) + field%work%last(s)
      do c = 1, size(columns)
        field%node(first:last, columns(c):columns(c) + nd - 1) = &
          field%node(first:last, columns(c):columns(c) + nd - 1) + &
          field%mass%gain(first:last, (c - 1)*nd + 1:c*nd)
      end do
    end do
  end subroutine consistent_add

  !> The acceleration of the nodes of one plane gains, and the velocity after the kick what comes of
  !! that. What the velocity before the kick gains is for strains alone: contact meets the momentum
  !! that particles bring, for its impulses act on single nodes, by the lumped mass.
  pure subroutine consistent_kick(field, plane, dt)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    real(dp), intent(in) :: dt
    integer :: s, first, last, nd
    nd = field%ndim
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      first = field%neighbour(0, 0, s) + field%work%first(s)
      last = field%neighbour(0, 0, s) + field%work%last(s)
      associate (a => field%node(first:last, node_acceleration:node_acceleration + nd - 1), &
                 v => field%node(first:last, node_velocity(nd):node_velocity(nd) + nd - 1), &
                 gain => field%mass%gain(first:last, :))
        a = a + gain(:, :nd)
        v = v + dt*gain(:, :nd)
        gain(:, nd + 1:) = gain(:, nd + 1:) - dt*gain(:, :nd)
        field%mass%before(first:last, :) = a
      end associate
    end do
  end subroutine consistent_kick

  !> The velocity gains the rest, after contact, whose impulses are added to the forces.
  pure subroutine consistent_strain(field, plane)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    integer :: s, i, a, at, nd
    nd = field%ndim
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do a = 1, nd
        do i = field%work%first(s), field%work%last(s)
          at = field%neighbour(0, 0, s) + i
          associate (inverse => field%node(at, node_inverse_mass(nd)), &
                     v => field%node(at, node_velocity(nd) + a - 1))
            v = v + field%mass%gain(at, nd + a)
            if (inverse > 0.0_dp) field%mass%force(at, a) = field%mass%force(at, a) + &
              (field%node(at, node_acceleration + a - 1) - field%mass%before(at, a))/inverse
          end associate
        end do
      end do
    end do
  end subroutine consistent_strain

  !> Adds the gains to the re-mapped velocity of one plane, and of what the velocity after the kick
  !! has beyond it, which no particle feels, a part (sgmp_unfelt_stages), whose power it books.
  pure subroutine consistent_remap(field, plane, unfelt)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    real(dp), intent(in) :: unfelt               !! that part
    real(dp) :: power(lanes), beyond
    integer :: s, i, a, l, at, nd
    nd = field%ndim
    call consistent_add(field, plane, [node_acceleration])
    if (.not. unfelt > 0.0_dp) return
    power = 0.0_dp
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do i = field%work%first(s), field%work%last(s)
        at = field%neighbour(0, 0, s) + i
        if (.not. field%node(at, node_inverse_mass(nd)) > 0.0_dp) cycle
        l = 1 + modulo(i, lanes)
        do a = 0, nd - 1
          beyond = field%node(at, node_velocity(nd) + a) - field%node(at, node_acceleration + a)
          power(l) = power(l) + field%mass%force(at, a + 1)*beyond
          field%node(at, node_acceleration + a) = field%node(at, node_acceleration + a) + &
                                                  unfelt*beyond
        end do
      end do
    end do
    field%unfelt(plane) = unfelt*sum(power)
  end subroutine consistent_remap

  !> The places of the nodes of one plane, as the consistent mass has them, less the nodes' own: in
  !! the gains.
  pure subroutine consistent_offsets(field, mesh, plane)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp) :: weight(tile, 2, 3), from
    integer :: s, first, n, a, i, at, axis, side, other, step(2, 3)
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      call row_steps(field, s, step)
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        call tile_weights(field, mesh, s, first, n, step, weight)
        do i = 1, n
          at = field%neighbour(0, 0, s) + first + i - 1
          if (surrounded(field, at, step, weight(i, :, :))) then
            field%mass%gain(at, :field%ndim) = 0.0_dp
            cycle
          end if
          do a = 1, field%ndim
            from = 0.0_dp
            do axis = 1, field%ndim
              do side = 1, 2
                other = at + step(side, axis)
                from = from + weight(i, side, axis)* &
                  (field%rotation%offset(a, at) - field%rotation%offset(a, other) + &
                   merge(real(3 - 2*side, dp), 0.0_dp, a == axis))
              end do
            end do
            field%mass%gain(at, a) = from
          end do
        end do
        call hold_gains(field, mesh, s, first, n, 0)
      end do
    end do
  end subroutine consistent_offsets

  !> Whether a node and those next to it are where they are, with as much on either side.
  pure logical function surrounded(field, at, step, weight) result(yes)
    type(field_t), intent(in) :: field
    integer, intent(in) :: at, step(2, 3)
    real(dp), intent(in) :: weight(2, 3)
    integer :: axis
    yes = .not. field%rotation%at(at, at_node)
    do axis = 1, field%ndim
      if (.not. yes) return
      yes = abs(weight(1, axis) - weight(2, axis)) < 0.1_dp*field%rotation%least_offset .and. &
            .not. (field%rotation%at(at + step(1, axis), at_node) .or. &
                   field%rotation%at(at + step(2, axis), at_node))
    end do
  end function surrounded

  !> Takes these for the offsets of the nodes.
  pure subroutine consistent_offsets_keep(field, plane)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    real(dp) :: offset(field%ndim)
    integer :: s, i, at
    logical :: takes_part
    associate (rotation => field%rotation)
      do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
        do i = field%work%first(s), field%work%last(s)
          at = field%neighbour(0, 0, s) + i
          offset = rotation%offset(:field%ndim, at) + field%mass%gain(at, :field%ndim)
          takes_part = any(abs(offset) >= rotation%least_offset)
          if (.not. takes_part) offset = 0.0_dp
          rotation%offset(:field%ndim, at) = offset
          rotation%at(at, at_node) = takes_part
          if (.not. takes_part) rotation%moment(:, at) = 0.0_dp
        end do
      end do
    end associate
  end subroutine consistent_offsets_keep

end module sgmp_consistent_mass
