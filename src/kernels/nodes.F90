! dimension-generic, axisymmetric
#include "dimension.inc"
!> The grid's part of a step: momentum equation at the nodes (Eqs. 17-20, 33, 34) and the MUSL
!! re-map.
!!
!! With SGMP a node gathers from the 2^d centres around it with fixed weights: 1/2 per axis, and
!! +-1/h along the axis of a derivative. Rows are handled in tiles so that the partial sums of a
!! tile stay in the first-level cache.
!!
!! In axisymmetric scenes the radial component has an inertia of its own (sgmp_axis): momentum and
!! force along r are divided by it as they come, and what follows knows of one mass.
module DIM(sgmp_nodes)
  use DIM(sgmp_auxmesh), only: graded_row
#ifdef AXISYMMETRIC
  use sgmp_axis, only: axis_inertia
#endif
  use sgmp_columns, only: node_acceleration, node_inertia, node_inverse_mass, node_remapped, &
                          node_swirl, node_total, node_velocity
  use sgmp_driven_nodes, only: driven_nodes_solve, driven_nodes_velocity
  use sgmp_field, only: field_t
  use CARTESIAN(sgmp_graded_rows), only: graded_divergence, graded_spread
#ifdef AXISYMMETRIC
  use CARTESIAN(sgmp_graded_rows), only: graded_hoop_force
#endif
  use sgmp_kernels, only: kernel_centred, kernel_mpm
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_kick, wall_speed
  use sgmp_nodes_swirl, only: nodes_swirl_book, nodes_swirl_push, nodes_swirl_remap, &
                              nodes_swirl_solve
#if NDIM > 1
  use CARTESIAN(sgmp_rotation), only: rotation_force
#endif
#if NDIM > 1
  use DIM(sgmp_surfaces), only: surfaces_push, surfaces_push_twists
#endif
  use sgmp_method, only: method_t
  use sgmp_one_sided_columns, only: one_sided_components
  use sgmp_sums, only: nodes_edge_push, nodes_edge_taken, nodes_external, nodes_lost, &
                       nodes_mass_aa, nodes_mass_av, nodes_sums
  use sgmp_voigt, only: flux_between
  use sgmp_wall_friction, only: wall_nodes_rub, wall_nodes_stick
  use sgmp_wall_reaction, only: wall_nodes_weigh
  use sgmp_wall_work, only: wall_nodes_book
  use sgmp_walls, only: walls_hold
  implicit none
  private
  public :: nodes_solve, nodes_velocity, nodes_remap
  public :: face_forces, node_forces

  integer, parameter :: tile = 128
  integer, parameter :: before_a = node_acceleration - 1      !! columns before the acceleration
  integer, parameter :: before_v = node_velocity(NDIM) - 1    !! before the velocity
  integer, parameter :: inverse_at = node_inverse_mass(NDIM)
  integer, parameter :: flux_of(NDIM, NDIM) = flux_between(:NDIM, :NDIM, NDIM)

contains

  !> Acceleration and trial velocity of the nodes of one plane (Eqs. 33, 34).
  ! allow(S901)
  pure subroutine nodes_solve(field, mesh, plane, method, dt, forced, sums)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane              !! plane of the field
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: dt                !! velocity step dt^k
    logical, intent(in) :: forced             !! the moments carry an external force
    real(dp), intent(inout) :: sums(nodes_sums)  !! of the plane, added to
    real(dp) :: m(tile), p(tile, NDIM), f(tile, NDIM), external(tile, NDIM)
    real(dp) :: booked(tile, NDIM)            !! external forces whose work nodes book
    real(dp) :: pressed(tile, NDIM)           !! those on faces
    real(dp) :: lane_sums(lanes, nodes_sums)
    integer :: s, first, n, idx
    logical :: driven
    driven = forced .or. any(abs(method%gravity) > 0.0_dp)
    if (method%features%wall_friction%rubs) external = 0.0_dp
    lane_sums = 0.0_dp
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        call node_moments(field, s, first, n, .true., m, p)
        idx = field%neighbour(0, 0, s) + first
        if (field%columns%turns) then  ! they are known
          f(:n, :) = field%rotation%force(idx:idx + n - 1, :)
        else
          call node_forces(field, mesh, s, first, n, f)
        end if
#if NDIM > 1
        if (field%columns%turns) call rotation_force(field, mesh, s, first, n, &
                                                          field%rotation%couple, f)
#endif
        if (driven) then
          call external_forces(field, s, first, n, m, method%gravity, forced, external)
          booked(:n, :) = external(:n, :)
          if (forced .and. field%columns%faces > 0) then
            call press(field, mesh, s, first, n, pressed)
            external(:n, :) = external(:n, :) + pressed(:n, :)
          end if
          f(:n, :) = f(:n, :) + external(:n, :)
          if (field%columns%consistent .and. forced) then
            idx = field%neighbour(0, 0, s) + first
            field%mass%external(idx:idx + n - 1, :) = booked(:n, :)
          end if
        end if
        if (field%columns%push > 0 .and. .not. (forced .and. field%columns%faces > 0)) then
          call press(field, mesh, s, first, n, pressed)
          f(:n, :) = f(:n, :) + pressed(:n, :)
        end if
        idx = field%neighbour(0, 0, s) + first
#ifdef AXISYMMETRIC
        if (field%columns%swirl > 0) call nodes_swirl_push(field, s, first, n, f(1, 1))
        call radial_inertia(field, s, first, n, m, field%node(idx, node_inertia))
#endif
        if (forced .and. field%columns%impedance > 0) then
          call edge_forces(field, mesh, s, first, n, dt, method%cutoff, m, p, f, external, &
                          booked, sums)
        end if
#ifdef AXISYMMETRIC
        call divide_radial(n, field%node(idx, node_inertia), p)
        call divide_radial(n, field%node(idx, node_inertia), f)
#endif
        call solve_tile(n, size(field%node, 1), field%kernel, m, p, f, dt, method%cutoff, &
                        field%node(idx, 1))
        if (field%columns%swirl > 0) call nodes_swirl_solve(field, mesh, s, first, n, m, &
                                                            dt)
        if (mesh%walls_move) call wall_nodes_book(field, mesh, s, first, n, m, dt, sums)
        if (method%features%wall_friction%rubs) then
          call wall_nodes_rub(field, mesh, method%features%wall_friction, s, first, n, m, &
                              external, dt, sums)
        end if
        if (mesh%walls_weigh) call wall_nodes_weigh(field, mesh, s, first, n, m, sums)
        call walls_hold(field, mesh, s, first, n, node_acceleration, wall_kick)
        call walls_hold(field, mesh, s, first, n, node_velocity(NDIM), wall_speed)
        if (field%columns%driven > 0) call driven_nodes_solve(field, mesh, s, first, n, m, dt, &
                                                              plane)
        call book_energies(n, first, driven, size(field%node, 1), m, f, booked, dt, &
                           method%work_lag, field%node(idx, 1), lane_sums)
        if (field%columns%swirl > 0) call nodes_swirl_book(field, s, first, n, m, dt, lane_sums)
      end do
    end do
    sums = sums + sum(lane_sums, dim=1)
  end subroutine nodes_solve

  !> Nodal velocity from the projected momentum alone (USF).
  pure subroutine nodes_velocity(field, mesh, plane, cutoff)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp), intent(in) :: cutoff
    real(dp) :: m(tile), p(tile, NDIM), f(tile, NDIM)
    integer :: s, first, n, idx
    f = 0.0_dp
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        call node_moments(field, s, first, n, .true., m, p)
        idx = field%neighbour(0, 0, s) + first
#ifdef AXISYMMETRIC
        call radial_inertia(field, s, first, n, m, field%node(idx, node_inertia))
        call divide_radial(n, field%node(idx, node_inertia), p)
#endif
        call solve_tile(n, size(field%node, 1), field%kernel, m, p, f, 0.0_dp, cutoff, &
                        field%node(idx, 1))
        if (field%columns%swirl > 0) call nodes_swirl_solve(field, mesh, s, first, n, m, &
                                                            0.0_dp)
        call walls_hold(field, mesh, s, first, n, node_acceleration, wall_kick)
        call walls_hold(field, mesh, s, first, n, node_velocity(NDIM), wall_speed)
        if (field%columns%driven > 0) call driven_nodes_velocity(field, mesh, s, first, n, &
                                                                 node_velocity(NDIM), .true.)
      end do
    end do
  end subroutine nodes_velocity

  !> MUSL: velocity re-mapped from the updated particle momenta, in the place of the acceleration.
  pure subroutine nodes_remap(field, mesh, plane, method)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    type(method_t), intent(in) :: method
    real(dp) :: m(tile), p(tile, NDIM), power(lanes), unfelt
    integer :: s, first, n, idx
    power = 0.0_dp
    unfelt = merge(0.0_dp, method%unfelt, field%columns%consistent)  ! see sgmp_mass_stages
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        call node_moments(field, s, first, n, .false., m, p)
        idx = field%neighbour(0, 0, s) + first
#ifdef AXISYMMETRIC
        call divide_radial(n, field%node(idx, node_inertia), p)
#endif
        if (unfelt > 0.0_dp) then
          call book_unfelt(n, first, size(field%node, 1), p, field%node(idx, 1), power)
        end if
        call divide_tile(n, size(field%node, 1), unfelt, p, field%node(idx, 1))
        if (field%columns%swirl > 0) call nodes_swirl_remap(field, s, first, n)
        call walls_hold(field, mesh, s, first, n, node_remapped, wall_speed)
        if (method%features%wall_friction%rubs) then
          call wall_nodes_stick(field, mesh, method%features%wall_friction, s, first, n)
        end if
        if (field%columns%driven > 0) call driven_nodes_velocity(field, mesh, s, first, n, &
                                                                 node_remapped, .false.)
      end do
    end do
    if (unfelt > 0.0_dp) field%unfelt(plane) = unfelt*sum(power)
  end subroutine nodes_remap

  !> v = p/m, and of what the velocity after the kick has beyond it, which no particle feels, a part
  !! (sgmp_unfelt_stages); where the mass is below the cut-off, round-off of the weights, the
  !! velocity stays.
  pure subroutine divide_tile(n, stride, unfelt, p, node)
    integer, intent(in) :: n, stride
    real(dp), intent(in) :: unfelt               !! that part
    real(dp), intent(in) :: p(tile, NDIM)
    real(dp), intent(inout) :: node(stride, node_total(SPACE))
    real(dp) :: v
    integer :: i, a
    !$omp simd private(a, v)
    do i = 1, n
      do a = 1, NDIM
        v = p(i, a)*node(i, inverse_at)
        v = v + unfelt*(node(i, before_v + a) - v)
        node(i, before_a + a) = merge(v, node(i, before_v + a), node(i, inverse_at) >= 0.0_dp)
      end do
    end do
  end subroutine divide_tile

  !> Adds the power of the forces on what the velocity after the kick has beyond the re-mapped one,
  !! sum m a . (v - p/m), before the latter takes the place of the acceleration.
  pure subroutine book_unfelt(n, first, stride, p, node, power)
    integer, intent(in) :: n, first, stride      !! nodes, place of the first, stride of `node`
    real(dp), intent(in) :: p(tile, NDIM)
    real(dp), intent(in) :: node(stride, node_total(SPACE))
    real(dp), intent(inout) :: power(lanes)      !! of nodes by their place along the grid
    real(dp) :: one, whole
    integer :: i, a, l
    do i = 1, n
      if (.not. node(i, inverse_at) > 0.0_dp) cycle
      l = 1 + modulo(first + i - 1, lanes)
      whole = 0.0_dp
      do a = 1, NDIM
        one = node(i, before_a + a)*(node(i, before_v + a) - p(i, a)*node(i, inverse_at))
#ifdef AXISYMMETRIC
        if (a == 1) one = node(i, node_inertia)*one
#endif
        whole = whole + one
      end do
      power(l) = power(l) + whole/node(i, inverse_at)
    end do
  end subroutine book_unfelt

  !> Sums of a tile for the energy ledger, over the nodes that take part.
  !!
  !! Nodes go to the lane of their place along the grid, not along the tile: empty nodes beside
  !! them, of which ranks may store different ones, then change nothing.
  pure subroutine book_energies(n, first, driven, stride, m, f, external, dt, lag, node, sums)
    integer, intent(in) :: n, first, stride      !! nodes, place of the first, stride of `node`
    logical, intent(in) :: driven                !! there are external forces
    real(dp), intent(in) :: m(tile), f(tile, NDIM), external(tile, NDIM), dt, lag
    real(dp), intent(in) :: node(stride, node_total(SPACE))
    real(dp), intent(inout) :: sums(lanes, nodes_sums)
    real(dp), dimension(0:tile + 2*lanes) :: aa, av, ev, lost
    real(dp) :: active, a2, v2, push
    integer :: i, a, before
    before = modulo(first, lanes)
    aa(:before) = 0.0_dp
    av(:before) = 0.0_dp
    lost(:before) = 0.0_dp
    aa(before + n:before + n + lanes - 2) = 0.0_dp
    av(before + n:before + n + lanes - 2) = 0.0_dp
    lost(before + n:before + n + lanes - 2) = 0.0_dp
    !$omp simd private(active, a, a2, v2, push)
    do i = 1, n
      active = merge(m(i), 0.0_dp, node(i, inverse_at) > 0.0_dp)
      a2 = 0.0_dp
      v2 = 0.0_dp
      push = 0.0_dp
      do a = 1, NDIM
        push = push + abs(f(i, a))
        a2 = a2 + node(i, before_a + a)**2
        v2 = v2 + node(i, before_a + a)*(node(i, before_v + a) - dt*node(i, before_a + a))
#ifdef AXISYMMETRIC
        if (a == 1) then
          a2 = node(i, node_inertia)*a2
          v2 = node(i, node_inertia)*v2
        end if
#endif
      end do
      aa(before + i - 1) = active*a2
      av(before + i - 1) = active*v2
      lost(before + i - 1) = merge(0.0_dp, push, node(i, inverse_at) > 0.0_dp)
    end do
    call add_lanes(before + n, aa, sums(1, nodes_mass_aa))
    call add_lanes(before + n, av, sums(1, nodes_mass_av))
    call add_lanes(before + n, lost, sums(1, nodes_lost))
    if (.not. driven) return
    ev(:before) = 0.0_dp
    ev(before + n:before + n + lanes - 2) = 0.0_dp
    !$omp simd private(a, v2)
    do i = 1, n
      v2 = 0.0_dp
      do a = 1, NDIM
        v2 = v2 + external(i, a)*(node(i, before_v + a) - lag*dt*node(i, before_a + a))
      end do
      ev(before + i - 1) = v2
    end do
    call add_lanes(before + n, ev, sums(1, nodes_external))
  end subroutine book_energies

  !> Adds terms to the sums of their lanes; behind the last there are zeros.
  pure subroutine add_lanes(n, terms, sums)
    integer, intent(in) :: n
    real(dp), intent(in) :: terms(lanes, *)
    real(dp), intent(inout) :: sums(lanes)
    integer :: i
    do i = 1, (n + lanes - 1)/lanes
      sums = sums + terms(:, i)
    end do
  end subroutine add_lanes

  !> Mass (if asked for) and momentum of a tile of nodes (Eqs. 17, 18; MPM Eqs. 9, 10).
  pure subroutine node_moments(field, s, first, n, with_mass, m, p)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n        !! work interval, first node, nodes
    logical, intent(in) :: with_mass
    real(dp), intent(inout) :: m(tile), p(tile, NDIM)
    integer :: a, i, b(NROW)
    if (kernel_centred(field%kernel)) then
      b = centre_rows(field, s, first)
      if (with_mass) call mean_row(n, field%moment(1, field%columns%mass), b, m)
      do a = 1, NDIM
        call mean_row(n, field%moment(1, field%columns%momentum + a - 1), b, p(1, a))
      end do
    else
      i = field%neighbour(0, 0, s) + first
      if (with_mass) m(:n) = field%moment(i:i + n - 1, field%columns%mass)
      do a = 1, NDIM
        p(:n, a) = field%moment(i:i + n - 1, field%columns%momentum + a - 1)
      end do
    end if
  end subroutine node_moments

#ifdef AXISYMMETRIC
  !> Radial mass of a tile of nodes over its mass.
  pure subroutine radial_inertia(field, s, first, n, m, inertia)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: m(tile)
    real(dp), intent(inout) :: inertia(n)
    real(dp) :: moment(tile)
    integer :: i
    if (kernel_centred(field%kernel)) then
      call mean_row(n, field%moment(1, field%columns%radial), centre_rows(field, s, first), moment)
    else
      i = field%neighbour(0, 0, s) + first
      moment(:n) = field%moment(i:i + n - 1, field%columns%radial)
    end if
    call axis_inertia(field%radii, first, n, m, moment, inertia)
  end subroutine radial_inertia

  !> Divides the radial component of a tile's vector by its inertia.
  pure subroutine divide_radial(n, inertia, vector)
    integer, intent(in) :: n
    real(dp), intent(in) :: inertia(n)
    real(dp), intent(inout) :: vector(tile, NDIM)
    vector(:n, 1) = vector(:n, 1)/inertia
  end subroutine divide_radial

  !> Adds the force of the hoop stress, the transpose of the hoop strain, to a tile of nodes.
  pure subroutine add_hoop_force(n, inverse_h, inner, outer, flux, b, f)
    integer, intent(in) :: n, b(NROW)         !! b: as for divergence_row
    real(dp), intent(in) :: inverse_h
    real(dp), intent(in) :: inner(0:n), outer(0:n)  !! weights at the centres around the nodes
    real(dp), intent(in) :: flux(*)           !! hoop stress times volume, at the centres
    real(dp), intent(inout) :: f(n)
    integer :: i
    !$omp simd
    do i = 1, n
      f(i) = f(i) - inverse_h*(outer(i - 1)*corner_sum(flux, b, i - 1) &
                               + inner(i)*corner_sum(flux, b, i))
    end do
  end subroutine add_hoop_force
#endif

  !> Means of the centres around the nodes of a row.
  pure subroutine mean_row(n, column, b, mean)
    integer, intent(in) :: n, b(NROW)
    real(dp), intent(in) :: column(*)
    real(dp), intent(inout) :: mean(n)
    integer :: i
    !$omp simd
    do i = 1, n
      mean(i) = 0.5_dp**NDIM*(corner_sum(column, b, i - 1) + corner_sum(column, b, i))
    end do
  end subroutine mean_row

  !> Internal forces of a tile of nodes (Eq. 19; MPM Eq. 11).
  pure subroutine node_forces(field, mesh, s, first, n, f)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(inout) :: f(tile, NDIM)
    integer :: a, i, before
    before = field%columns%force - 1
    if (kernel_centred(field%kernel)) then
      do a = 1, NDIM
        if (mesh%graded) then
          call graded_divergence(mesh, field%linear, graded_row(field, s), first, n, &
                                 field%moment(1, before + flux_of(a, 1)), &
#if NDIM > 1
                                 field%moment(1, before + flux_of(a, 2)), &
#endif
#if NDIM > 2
                                 field%moment(1, before + flux_of(a, 3)), &
#endif
                                 centre_rows(field, s, first), f(1, a))
          cycle
        end if
        call divergence_row(n, mesh%inverse_h*0.5_dp**(NDIM - 1), &
                            field%moment(1, before + flux_of(a, 1)), &
#if NDIM > 1
                            field%moment(1, before + flux_of(a, 2)), &
#endif
#if NDIM > 2
                            field%moment(1, before + flux_of(a, 3)), &
#endif
                            centre_rows(field, s, first), f(1, a))
      end do
#ifdef AXISYMMETRIC
      if (mesh%graded) then
        call graded_hoop_force(mesh, field%linear, graded_row(field, s), first, n, &
                               field%hoop(first - 1, 1), field%hoop(first - 1, 2), &
                               field%moment(1, before + NFLUX), &
                               centre_rows(field, s, first), f(1, 1))
      else
        call add_hoop_force(n, mesh%inverse_h, field%hoop(first - 1, 1), &
                            field%hoop(first - 1, 2), field%moment(1, before + NFLUX), &
                            centre_rows(field, s, first), f(1, 1))
      end if
#endif
#if NDIM > 1
      if (field%columns%corrected) then
        call surfaces_push(field, mesh, s, first, centre_rows(field, s, first), n, f)
      end if
#endif
    else
      i = field%neighbour(0, 0, s) + first
      f(:n, :) = field%moment(i:i + n - 1, before + 1:before + NDIM)
    end if
  end subroutine node_forces

  !> One component of the force: derivatives of its fluxes along the axes, summed in their order.
#if NDIM == 1
  pure subroutine divergence_row(n, scale, x, b, f)
    real(dp), intent(in) :: x(*)              !! flux along each axis, at the centres
#elif NDIM == 2
  pure subroutine divergence_row(n, scale, x, y, b, f)
    real(dp), intent(in) :: x(*), y(*)        !! flux along each axis, at the centres
#else
  pure subroutine divergence_row(n, scale, x, y, z, b, f)
    real(dp), intent(in) :: x(*), y(*), z(*)  !! flux along each axis, at the centres
#endif
    integer, intent(in) :: n, b(NROW)
    real(dp), intent(in) :: scale
    real(dp), intent(inout) :: f(n)
    integer :: i
    !$omp simd
    do i = 1, n
      f(i) = corner_sum(x, b, i) - corner_sum(x, b, i - 1)
#if NDIM > 1
      f(i) = f(i) + (corner_slope_2(y, b, i) + corner_slope_2(y, b, i - 1))
#endif
#if NDIM > 2
      f(i) = f(i) + (corner_slope_3(z, b, i) + corner_slope_3(z, b, i - 1))
#endif
      f(i) = scale*f(i)
    end do
  end subroutine divergence_row

  !> Gravity on the nodes' mass, and the body forces that particles brought (Eq. 20; MPM Eq. 12).
  pure subroutine external_forces(field, s, first, n, m, gravity, forced, f)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: m(tile), gravity(3)
    logical, intent(in) :: forced
    real(dp), intent(inout) :: f(tile, NDIM)
    real(dp) :: t(tile)
    integer :: a
    do a = 1, NDIM
      f(:n, a) = m(:n)*gravity(a)
      if (.not. forced) cycle
      call spread_force(field, s, first, n, field%columns%external + a - 1, t)
      f(:n, a) = f(:n, a) + t(:n)
    end do
  end subroutine external_forces

  !> What acts on faces, with the couples of exact rotation.
  pure subroutine press(field, mesh, s, first, n, pressed)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(inout) :: pressed(tile, NDIM)
    call face_forces(field, mesh, s, first, n, pressed)
#if NDIM > 1
    if (field%columns%turns) call rotation_force(field, mesh, s, first, n, &
                                                      field%rotation%face_couple, pressed)
#endif
  end subroutine press

  !> Adds the forces of walls that let go.
  pure subroutine add_push(field, mesh, s, first, n, f)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(inout) :: f(tile, NDIM)
    real(dp) :: t(tile)
    logical :: acts(3)
    integer :: a, column
    column = field%columns%push
    acts = one_sided_components(mesh)
    do a = 1, NDIM
      if (.not. acts(a)) cycle
      call spread_force(field, s, first, n, column, t)
      f(:n, a) = f(:n, a) + t(:n)
      column = column + 1
    end do
  end subroutine add_push

  !> Forces on faces of particles, with their levers, and those of walls that let go.
  pure subroutine face_forces(field, mesh, s, first, n, f)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(inout) :: f(tile, NDIM)
    integer :: a
    if (field%columns%faces == 0) f(:n, :) = 0.0_dp
    do a = 1, merge(NDIM, 0, field%columns%faces > 0)
      call hand_faces(field, mesh, s, first, n, field%columns%faces + a - 1, &
                      field%columns%lever + (a - 1)*NDIM, field%columns%lever > 0, f(1, a))
    end do
#if NDIM > 1
    if (field%columns%twist > 0) then
      call surfaces_push_twists(field, mesh, s, first, centre_rows(field, s, first), n, f)
    end if
#endif
    if (field%columns%push > 0) call add_push(field, mesh, s, first, n, f)
  end subroutine face_forces

  !> A component of what acts on faces at a tile of nodes, with its levers.
  pure subroutine hand_faces(field, mesh, s, first, n, column, lever, levers, f)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    integer, intent(in) :: column, lever         !! of the component, the first of its levers
    logical, intent(in) :: levers                !! there are some
    real(dp), intent(inout) :: f(tile)
    real(dp) :: t(tile)
    if (mesh%graded) then
      call graded_spread(mesh, field%linear, graded_row(field, s), first, n, &
                         field%moment(1, column), centre_rows(field, s, first), f)
    else
      call spread_force(field, s, first, n, column, f)
    end if
    if (.not. levers) return
    if (mesh%graded) then
      call graded_divergence(mesh, field%linear, graded_row(field, s), first, n, &
                             field%moment(1, lever), &
#if NDIM > 1
                             field%moment(1, lever + 1), &
#endif
#if NDIM > 2
                             field%moment(1, lever + 2), &
#endif
                             centre_rows(field, s, first), t)
    else
      call divergence_row(n, mesh%inverse_h*0.5_dp**(NDIM - 1), field%moment(1, lever), &
#if NDIM > 1
                          field%moment(1, lever + 1), &
#endif
#if NDIM > 2
                          field%moment(1, lever + 2), &
#endif
                          centre_rows(field, s, first), t)
    end if
    f(:n) = f(:n) + t(:n)
  end subroutine hand_faces

  !> A component of a force at a tile of nodes, of what particles brought to its column.
  pure subroutine spread_force(field, s, first, n, column, f)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n, column
    real(dp), intent(inout) :: f(tile)
    integer :: i
    if (kernel_centred(field%kernel)) then
      call mean_row(n, field%moment(1, column), centre_rows(field, s, first), f)
    else
      i = field%neighbour(0, 0, s) + first
      f(:n) = field%moment(i:i + n - 1, column)
    end if
  end subroutine spread_force

  !> Adds the forces of absorbing edges to all forces on a tile of nodes, and to the external ones:
  !! -Z v at the velocity in the middle of the kick, which they change, so that a step of any length
  !! takes energy. What they take and how they push is added to the sums.
  pure subroutine edge_forces(field, mesh, s, first, n, dt, cutoff, m, p, f, external, booked, &
                              sums)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: dt, cutoff, m(tile), p(tile, NDIM)
    real(dp), intent(inout) :: f(tile, NDIM), external(tile, NDIM), booked(tile, NDIM)
    real(dp), intent(inout) :: sums(nodes_sums)
    real(dp) :: impedance(tile), force, inertia(tile), middle
    integer :: a, i
    do a = 1, NDIM
      call edge_impedance(field, mesh, s, first, n, a, impedance)
      inertia(:n) = m(:n)
#ifdef AXISYMMETRIC
      i = field%neighbour(0, 0, s) + first
      if (a == 1) inertia(:n) = m(:n)*field%node(i:i + n - 1, node_inertia)
#endif
      do i = 1, n
        if (.not. (impedance(i) > 0.0_dp .and. m(i) > cutoff)) cycle
        middle = (p(i, a) + 0.5_dp*dt*f(i, a))/(inertia(i) + 0.5_dp*dt*impedance(i))
        force = -impedance(i)*middle
        f(i, a) = f(i, a) + force
        external(i, a) = external(i, a) + force
        booked(i, a) = booked(i, a) + force
        sums(nodes_edge_taken) = sums(nodes_edge_taken) - force*middle
        sums(nodes_edge_push + a - 1) = sums(nodes_edge_push + a - 1) + force
      end do
    end do
  end subroutine edge_forces

  !> Force per velocity along axis `a` by which edges hold a tile of nodes.
  pure subroutine edge_impedance(field, mesh, s, first, n, a, impedance)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n, a
    real(dp), intent(out) :: impedance(tile)
    integer :: column
    column = field%columns%impedance
    call hand_faces(field, mesh, s, first, n, column + a - 1, column + NDIM + (a - 1)*NDIM, &
                    kernel_centred(field%kernel), impedance)
  end subroutine edge_impedance

  !> Records of the centre left of node `first` in the rows of centres around a row of nodes.
  pure function centre_rows(field, s, first) result(b)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first
    integer :: b(NROW)
#if NDIM == 1
    b(1) = field%neighbour(0, 0, s)
#elif NDIM == 2
    b(1) = field%neighbour(0, -1, s)
    b(2) = field%neighbour(0, 0, s)
#else
    b(1) = field%neighbour(-1, -1, s)
    b(2) = field%neighbour(-1, 0, s)
    b(3) = field%neighbour(0, -1, s)
    b(4) = field%neighbour(0, 0, s)
#endif
    b = b + first - 1
  end function centre_rows

#include "corner_sums.inc"

  !> a = f/m, v = p/m + dt a, 1/m; all zero where the mass is below the cut-off. MPM's gradients see
  !! such nodes: there they move as their particles do, and 1/m is negative to tell them.
  pure subroutine solve_tile(n, stride, kernel, m, p, f, dt, cutoff, node)
    integer, intent(in) :: n, stride, kernel
    real(dp), intent(in) :: m(tile), p(tile, NDIM), f(tile, NDIM), dt, cutoff
    real(dp), intent(inout) :: node(stride, node_total(SPACE))
    real(dp) :: inverse, active, least
    integer :: i, a
    least = merge(1.0e-290_dp, cutoff, kernel == kernel_mpm)  ! that can be divided by
    !$omp simd private(inverse, active, a)
    do i = 1, n
      inverse = merge(1.0_dp/merge(m(i), 1.0_dp, m(i) > least), 0.0_dp, m(i) > least)
      active = merge(inverse, 0.0_dp, m(i) > cutoff)
      node(i, inverse_at) = active - (inverse - active)
      do a = 1, NDIM
        node(i, before_a + a) = f(i, a)*active
        node(i, before_v + a) = p(i, a)*inverse + dt*node(i, before_a + a)
      end do
    end do
  end subroutine solve_tile

end module DIM(sgmp_nodes)
