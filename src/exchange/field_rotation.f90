!> Exact rotation of one velocity field (doc/rotation.md): which planes each stage needs, how
!! threads share them, and what ranks tell each other.
!!
!! Particles read the nodes of planes own(1)..own(2) + nodes. A velocity that is to be taken to a
!! node's place needs the velocities of the nodes next to it, which at the cut are a neighbour's;
!! all else both ranks work out from the moments they hold.
module sgmp_field_rotation
  use sgmp_buffer, only: buffer_t
  use sgmp_consistent_mass, only: consistent_masses, consistent_offsets, consistent_offsets_keep
  use sgmp_field, only: field_t
  use sgmp_halo, only: halo_get_planes, halo_planes, halo_put_nodes
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_partition, only: partition_t
  use sgmp_plan, only: workspace_t
  use sgmp_ranks, only: ranks_t
  use sgmp_rotation_points, only: stage_couples, stage_curls, stage_face_couples, &
                                  stage_face_moments, stage_inertia, stage_inverses, &
                                  stage_moments, stage_offsets, stage_place
  use sgmp_team, only: team_t
  implicit none
  private
  public :: field_rotation_prepare, field_rotation_forces, field_rotation_swap, field_rotation_place

  integer, parameter :: no_columns(0) = 0

contains

  !> Where the nodes' centres of mass are, and what takes the curl around a node to its angular
  !! velocity: of the masses as they lie.
  subroutine field_rotation_prepare(field, mesh, cutoff, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: cutoff               !! nodes lighter than this are ignored
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    if (field%columns%consistent) then
      call find_places(field, mesh, cutoff, team, partition)
    else
      call run(stage_offsets, [-2, 2], field, mesh, cutoff, no_columns, team, partition)
    end if
    call run(stage_inertia, [-2, 1], field, mesh, cutoff, no_columns, team, partition)
    call run(stage_inverses, [-1, 1], field, mesh, cutoff, no_columns, team, partition)
  end subroutine field_rotation_prepare

  !> The places of the nodes as a consistent mass has them (doc/mass.md).
  subroutine find_places(field, mesh, cutoff, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: cutoff
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: p, p1, p2
    call run(stage_offsets, [-3, 3], field, mesh, cutoff, no_columns, team, partition)
    call halo_planes(field, partition%own + [-3, partition%nodes + 3], p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(field, cutoff, p1, p2) private(p)
    do p = p1, p2
      call consistent_masses(field, p, cutoff)
    end do
    !$omp end parallel do
    call halo_planes(field, partition%own + [-2, partition%nodes + 2], p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(field, mesh, p1, p2) private(p)
    do p = p1, p2
      call consistent_offsets(field, mesh, p)
    end do
    !$omp end parallel do
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(field, p1, p2) private(p)
    do p = p1, p2
      call consistent_offsets_keep(field, p)
    end do
    !$omp end parallel do
  end subroutine find_places

  !> Couples that free the internal forces, and those on faces and of walls that let go, of their
  !! moment about the nodes' centres of mass.
  subroutine field_rotation_forces(field, mesh, forced, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: forced                !! the moments carry an external force
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    call run(stage_moments, [-1, 1], field, mesh, 0.0_dp, no_columns, team, partition)
    call run(stage_couples, [-1, 0], field, mesh, 0.0_dp, no_columns, team, partition)
    if (field%columns%push == 0 .and. (.not. forced .or. field%columns%faces == 0)) return
    call run(stage_face_moments, [-1, 1], field, mesh, 0.0_dp, no_columns, team, partition)
    call run(stage_face_couples, [-1, 0], field, mesh, 0.0_dp, no_columns, team, partition)
  end subroutine field_rotation_forces

  !> Takes nodal velocities to the places of the nodes, by the curl of the first of them.
  subroutine field_rotation_place(field, mesh, columns, kick, team, partition)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: columns(:)            !! first column of each velocity
    real(dp), intent(in) :: kick                 !! times the acceleration is left out of the curl
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    call run(stage_curls, [-1, 0], field, mesh, kick, columns, team, partition)
    call run(stage_place, [0, 0], field, mesh, 0.0_dp, columns, team, partition)
  end subroutine field_rotation_place

  !> One stage on all planes that it concerns.
  subroutine run(stage, reach, field, mesh, number, columns, team, partition)
    integer, intent(in) :: stage
    integer, intent(in) :: reach(2)              !! planes below and above those that particles read
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: number               !! see sgmp_nodes_rotation
    integer, intent(in) :: columns(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: p, p1, p2
    call halo_planes(field, partition%own + [0, partition%nodes] + reach, p1, p2)
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(stage, field, mesh, number, columns, team, p1, p2) private(p)
    do p = p1, p2
      call team%passes%rotation(field, mesh, p, stage, number, columns)
    end do
    !$omp end parallel do
  end subroutine run

  !> Swaps nodes: those next to the ones that particles of both ranks read, or more planes of them.
  subroutine field_rotation_swap(field, columns, planes, ranks, complete)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: columns(2)            !! first and last
    integer, intent(in) :: planes                !! on either side
    type(ranks_t), intent(inout) :: ranks
    logical, intent(out) :: complete             !! everything has found its place
    type(workspace_t) :: none
    logical :: fine
    integer :: p
    associate (partition => ranks%partition, messages => ranks%messages)
      if (partition%rank > 0) then
        do p = planes - 1, 0, -1
          call put_plane(field, partition%own(1) + partition%nodes - p, columns, &
                         messages%to_below)
        end do
      end if
      if (partition%rank < partition%ranks - 1) then
        do p = 0, planes - 1
          call put_plane(field, partition%own(2) + p, columns, messages%to_above)
        end do
      end if
      call neighbours_send(messages, ranks%traffic)
      call neighbours_receive(messages)
      call halo_get_planes(field, columns, none, messages%from_below, complete)
      call halo_get_planes(field, columns, none, messages%from_above, fine)
      call neighbours_wait(messages)
    end associate
    complete = complete .and. fine
  end subroutine field_rotation_swap

  !> Appends the nodes of one plane, where it is stored.
  pure subroutine put_plane(field, k, columns, buffer)
    type(field_t), intent(in) :: field
    integer, intent(in) :: k, columns(2)
    type(buffer_t), intent(inout) :: buffer
    integer :: p, p2
    call halo_planes(field, [k, k], p, p2)
    if (p2 == p) call halo_put_nodes(field, p, columns, buffer)
  end subroutine put_plane

end module sgmp_field_rotation
