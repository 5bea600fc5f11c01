!> The correction at surfaces of one velocity field (doc/surfaces.md): which planes each stage
!! needs, and how threads share them.
!!
!! Particles read the centres of planes own(1)..own(2) + nodes - 1. What is added to a gradient
!! there takes second differences one plane away, and these the nodes of two more planes, which are
!! a neighbour's; the forces are worked out from the moments that the rank holds.
module sgmp_field_surfaces
  use sgmp_field, only: field_t
  use sgmp_halo, only: halo_planes
  use sgmp_mesh, only: mesh_t
  use sgmp_pair_points, only: stage_forces, stage_gains, stage_twists, stage_weights
  use sgmp_partition, only: partition_t
  use sgmp_surface_walls, only: surface_walls_fold, surface_walls_mirror
  use sgmp_team, only: team_t
  implicit none
  private
  public :: field_surfaces_forces, field_surfaces_strain, field_surfaces_weigh

contains

  !> Weights of pairs and quads, of the volumes as they lie.
  subroutine field_surfaces_weigh(field, mesh, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    call run(stage_weights, [-2, 2], field, mesh, 0, team, partition)
  end subroutine field_surfaces_weigh

  !> What is added to the gradient of a nodal velocity.
  subroutine field_surfaces_strain(field, mesh, column, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: column                !! first column of the velocity
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    call run(stage_twists, [-1, 0], field, mesh, column, team, partition)
    call run(stage_gains, [0, -1], field, mesh, 0, team, partition)
    call surface_walls_mirror(field, mesh)
  end subroutine field_surfaces_strain

  !> The forces that go with it, at the centres around the nodes that are solved.
  subroutine field_surfaces_forces(field, mesh, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    call run(stage_forces, [-2, 1], field, mesh, 0, team, partition)
    call surface_walls_fold(field, mesh)
  end subroutine field_surfaces_forces

  !> One stage on all planes that it concerns.
  subroutine run(stage, reach, field, mesh, column, team, partition)
    integer, intent(in) :: stage
    integer, intent(in) :: reach(2)              !! planes below and above the nodes that are read
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: column
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: p, p1, p2
    call halo_planes(field, partition%own + [0, partition%nodes] + reach, p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(stage, field, mesh, column, team, p1, p2) private(p)
    do p = p1, p2
      call team%passes%surfaces(field, mesh, p, stage, column)
    end do
    !$omp end parallel do
  end subroutine run

end module sgmp_field_surfaces
