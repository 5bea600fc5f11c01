!> The grid's part of swirl (theory 8): the rate v_theta/X of a tile of nodes from the moments that
!! particles gave to the centres around them, and its acceleration.
!!
!! A node's moment of inertia is the sum of m X^2, X the particles' radius in cells: with it a rigid
!! rotation is projected exactly, as an expansion is with the radial mass.
module sgmp_nodes_swirl
  use sgmp_auxmesh_2d, only: graded_row
  use sgmp_columns, only: node_acceleration, node_gyration, node_inverse_mass, node_swirl, &
                          node_velocity
  use sgmp_field, only: field_t
  use sgmp_graded_rows_2d, only: graded_divergence
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_rotation_rows_2d, only: add_differences, centre_rows, sums_row, tile
  use sgmp_sums, only: nodes_external, nodes_mass_aa, nodes_mass_av
  implicit none
  private
  public :: nodes_swirl_push, nodes_swirl_solve, nodes_swirl_remap, nodes_swirl_book

  integer, parameter :: inverse_at = node_inverse_mass(2)
  integer, parameter :: rate_at = node_swirl(node_velocity(2))
  integer, parameter :: acceleration_at = node_swirl(node_acceleration)
  real(dp), parameter :: mean = 0.25_dp        !! of the centres around a node

contains

  !> Adds the centrifugal force to the radial force of a tile of nodes.
  pure subroutine nodes_swirl_push(field, s, first, n, f)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    real(dp), intent(inout) :: f(n)
    real(dp) :: sums(tile)
    call sums_row(n, field%moment(1, field%columns%torque + 2), centre_rows(field, s, first), sums)
    f = f + mean*sums(:n)
  end subroutine nodes_swirl_push

  !> Acceleration of the rate, and the rate after a step dt; both zero where the node is ignored.
  pure subroutine nodes_swirl_solve(field, mesh, s, first, n, m, dt)
    type(field_t), intent(inout) :: field        !! its nodes have their inverse masses
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: m(n)                 !! masses
    real(dp), intent(in) :: dt                   !! 0: the rate alone
    real(dp) :: inertia(tile), torque(tile), moment(tile), inverse
    integer :: i, at, b(2), axis
    b = centre_rows(field, s, first)
    call sums_row(n, field%moment(1, field%columns%swirl), b, moment)
    call sums_row(n, field%moment(1, field%columns%swirl + 1), b, inertia)
    torque = 0.0_dp
    if (dt > 0.0_dp .and. mesh%graded) then
      call graded_divergence(mesh, field%linear, graded_row(field, s), first, n, &
                             field%moment(1, field%columns%torque), &
                             field%moment(1, field%columns%torque + 1), b, torque)
      torque(:n) = torque(:n)/mean
    else if (dt > 0.0_dp) then
      do axis = 1, 2
        call add_differences(n, 2.0_dp*mesh%inverse_h, axis, &
                             field%moment(1, field%columns%torque + axis - 1), b, torque)
      end do
    end if
    at = field%neighbour(0, 0, s) + first - 1
    do i = 1, n
      associate (node => field%node(at + i, :))
        node(node_gyration) = 1.0_dp
        if (inertia(i) > 0.0_dp .and. m(i) > 0.0_dp) node(node_gyration) = mean*inertia(i)/m(i)
        inverse = mean*node(inverse_at)/node(node_gyration)
        node(acceleration_at) = inverse*torque(i)
        node(rate_at) = inverse*moment(i) + dt*node(acceleration_at)
      end associate
    end do
  end subroutine nodes_swirl_solve

  !> MUSL: the rate re-mapped from the particles' moments, in the place of the acceleration.
  pure subroutine nodes_swirl_remap(field, s, first, n)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n
    real(dp) :: moment(tile)
    integer :: at
    call sums_row(n, field%moment(1, field%columns%swirl), centre_rows(field, s, first), moment)
    at = field%neighbour(0, 0, s) + first
    associate (node => field%node(at:at + n - 1, :))
      node(:, acceleration_at) = mean*moment(:n)*node(:, inverse_at)/node(:, node_gyration)
    end associate
  end subroutine nodes_swirl_remap

  !> Adds what swirl has of m |a|^2 and m a.v before the kick to the sums for the energy ledger,
  !! each node's to the lane of its place along the grid.
  pure subroutine nodes_swirl_book(field, s, first, n, m, dt, sums)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: m(n), dt
    real(dp), intent(inout) :: sums(lanes, nodes_external)
    real(dp) :: force
    integer :: i, at, lane
    at = field%neighbour(0, 0, s) + first - 1
    do i = 1, n
      lane = 1 + modulo(first + i - 1, lanes)
      associate (node => field%node(at + i, :))
        force = m(i)*node(node_gyration)*node(acceleration_at)
        sums(lane, nodes_mass_aa) = sums(lane, nodes_mass_aa) + force*node(acceleration_at)
        sums(lane, nodes_mass_av) = sums(lane, nodes_mass_av) + &
                                    force*(node(rate_at) - dt*node(acceleration_at))
      end associate
    end do
  end subroutine nodes_swirl_book

end module sgmp_nodes_swirl
