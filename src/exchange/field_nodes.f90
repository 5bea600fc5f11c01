!> The node stages of one velocity field, over the planes that this rank's particles read: how
!! threads share the planes.
module sgmp_field_nodes
  use sgmp_field, only: field_t
  use sgmp_field_rotation, only: field_rotation_forces
  use sgmp_field_surfaces, only: field_surfaces_forces
  use sgmp_halo, only: halo_planes
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use sgmp_partition, only: partition_t
  use sgmp_team, only: team_t
  implicit none
  private
  public :: field_node_planes, field_normalise, field_relax, field_remap, field_solve, &
            field_velocity

  !> Points of a field whose re-map is not worth a meeting of threads.
  integer, parameter :: few_points = 8192

contains

  !> Planes of nodes that this rank's particles read; p2 < p1: none.
  pure subroutine field_node_planes(field, partition, p1, p2)
    type(field_t), intent(in) :: field
    type(partition_t), intent(in) :: partition
    integer, intent(out) :: p1, p2
    call halo_planes(field, partition%own + [0, partition%nodes], p1, p2)
  end subroutine field_node_planes

  !> Volume-normalised stress at the centres around those nodes.
  subroutine field_normalise(field, mesh, method, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(method_t), intent(in) :: method
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: p, p1, p2, more
    more = merge(1, 0, method%rotation) + merge(1, 0, method%surfaces)
    call halo_planes(field, partition%own + [-1 - more, partition%nodes + more], p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(field, mesh, method, team, p1, p2) private(p)
    do p = p1, p2
      call team%passes%normalise(field, mesh, p, method%interior)
    end do
    !$omp end parallel do
  end subroutine field_normalise

  !> What particles relax to at the centres that they read.
  subroutine field_relax(field, mesh, method, dt, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: dt
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: p, p1, p2
    call halo_planes(field, partition%own + [0, partition%nodes - 1], p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(field, mesh, method, dt, team, p1, p2) private(p)
    do p = p1, p2
      call team%passes%relax(field, mesh, p, method, dt)
    end do
    !$omp end parallel do
  end subroutine field_relax

  !> Momentum equation (Eqs. 33, 34).
  subroutine field_solve(field, mesh, method, dt, forced, team, partition, sums)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: dt                   !! velocity step
    logical, intent(in) :: forced                !! the moments carry an external force
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    real(dp), intent(inout) :: sums(:, :)        !! (nodes_sums, planes), added to
    integer :: p, p1, p2
    if (field%columns%corrected) call field_surfaces_forces(field, mesh, team, partition)
    if (field%columns%turns) call field_rotation_forces(field, mesh, forced, team, partition)
    call field_node_planes(field, partition, p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(field, mesh, method, dt, forced, team, sums, p1, p2) private(p)
    do p = p1, p2
      call team%passes%solve(field, mesh, p, method, dt, forced, sums(:, p))
    end do
    !$omp end parallel do
  end subroutine field_solve

  !> Velocity from the projected momentum.
  subroutine field_velocity(field, mesh, cutoff, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: cutoff
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: p, p1, p2
    call field_node_planes(field, partition, p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(field, mesh, cutoff, team, p1, p2) private(p)
    do p = p1, p2
      call team%passes%velocity(field, mesh, p, cutoff)
    end do
    !$omp end parallel do
  end subroutine field_velocity

  !> Velocity re-mapped from the updated particles, in the place of the acceleration (MUSL).
  subroutine field_remap(field, mesh, method, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(method_t), intent(in) :: method
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: p, p1, p2
    if (method%unfelt > 0.0_dp) then
      if (allocated(field%unfelt)) deallocate (field%unfelt)
      allocate (field%unfelt(field%planes), source=0.0_dp)
    end if
    call field_node_planes(field, partition, p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) &
    !$omp& if(team%threads > 1 .and. field%points > few_points) &
    !$omp& default(none) shared(field, mesh, method, team, p1, p2) private(p)
    do p = p1, p2
      call team%passes%remap(field, mesh, p, method)
    end do
    !$omp end parallel do
  end subroutine field_remap

end module sgmp_field_nodes
