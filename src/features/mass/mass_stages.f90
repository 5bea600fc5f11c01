!> A consistent mass in the step (doc/mass.md): vectors of the nodes gain what it has beyond the
!! lumped one, as soon as they are found.
module sgmp_mass_stages
  use sgmp_body, only: body_forced, body_t
  use sgmp_columns, only: node_acceleration, node_inverse_mass, node_remapped, node_velocity
  use sgmp_consistent_mass, only: consistent_add, consistent_book, consistent_gains, &
                                  consistent_kick, consistent_remap, consistent_strain
  use sgmp_field, only: field_t
  use sgmp_field_nodes, only: field_node_planes
  use sgmp_findings, only: findings_t
  use sgmp_halo, only: halo_own_planes
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use sgmp_model, only: model_t
  use sgmp_phases, only: phase_swap_nodes
  use sgmp_sums, only: nodes_sums, sweep_sums
  use sgmp_tally, only: tally_add
  use sgmp_team, only: team_t
  implicit none
  private
  public :: mass_project, mass_remap, mass_solve, mass_spread, mass_strain

  !> What is done with the planes of a field once their gains are known.
  integer, parameter :: take_add = 1, take_solve = 2, take_remap = 3

contains

  !> The velocity of the nodes before a stress update that comes first.
  subroutine mass_project(model)
    type(model_t), intent(inout) :: model
    integer :: first
    if (.not. model%method%consistent) return
    first = node_velocity(model%mesh%ndim)
    call gain(model, [first], [first, node_inverse_mass(model%mesh%ndim)], take_add, 0.0_dp)
  end subroutine mass_project

  !> Acceleration and trial velocity of the nodes, every field as if it were alone.
  subroutine mass_solve(model, dt)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt                   !! velocity step
    if (.not. model%method%consistent) return
    call gain(model, [node_acceleration, node_velocity(model%mesh%ndim)], &
              [1, node_inverse_mass(model%mesh%ndim)], take_solve, dt)
  end subroutine mass_solve

  !> Contact has met the nodes: the velocity that strains gains the rest.
  subroutine mass_strain(model)
    type(model_t), intent(inout) :: model
    integer :: f, p, p1, p2
    if (.not. model%method%consistent) return
    do f = 1, size(model%fields)
      associate (field => model%fields(f), team => model%team)
        if (.not. field%columns%consistent) cycle
        call field_node_planes(field, model%ranks%partition, p1, p2)
        !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
        !$omp& default(shared) private(p)
        do p = p1, p2
          call consistent_strain(field, p)
        end do
        !$omp end parallel do
      end associate
    end do
  end subroutine mass_strain

  !> The velocity re-mapped from the updated particles (MUSL).
  subroutine mass_remap(model)
    type(model_t), intent(inout) :: model
    integer :: nd
    if (.not. model%method%consistent) return
    nd = model%mesh%ndim
    call gain(model, [node_remapped], [node_remapped, node_remapped + nd - 1], take_remap, 0.0_dp)
  end subroutine mass_remap

  !> A vector in the place of the acceleration, as probes of the stability limit have it.
  subroutine mass_spread(model)
    type(model_t), intent(inout) :: model
    if (.not. model%method%consistent) return
    call gain(model, [node_acceleration], [1, node_inverse_mass(model%mesh%ndim)], take_add, 0.0_dp)
  end subroutine mass_spread

  !> Vectors of the nodes gain what the consistent mass has beyond the lumped one.
  subroutine gain(model, columns, swapped, take, dt)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: columns(:)            !! first columns of the vectors
    integer, intent(in) :: swapped(2)            !! first and last column that neighbours must know
    integer, intent(in) :: take                  !! one of take_*
    real(dp), intent(in) :: dt                   !! velocity step
    real(dp), allocatable :: sums(:, :)
    integer :: f, p, p1, p2
    call phase_swap_nodes(model%clock%step + 1, swapped, 1, model%fields, model%bodies, &
                          model%ranks, model%findings, model%timers)
    do f = 1, size(model%fields)
      associate (field => model%fields(f), partition => model%ranks%partition)
        if (.not. field%columns%consistent) cycle
        call field_node_planes(field, partition, p1, p2)
        allocate (sums(nodes_sums, field%planes), source=0.0_dp)
        call find_gains(model%mesh, model%team, [p1, p2], columns, field)
        call take_gains(model%method, model%team, [p1, p2], columns, take, dt, &
                        body_forced(model%bodies, f), field, sums)
        if (take == take_solve) then
          call halo_own_planes(field, partition, p1, p2)
          do p = p1, p2
            call tally_add(model%findings%tally, 1 + size(model%bodies)*sweep_sums, sums(:, p))
          end do
        end if
        deallocate (sums)
      end associate
    end do
  end subroutine gain

  !> The gains of some planes.
  subroutine find_gains(mesh, team, planes, columns, field)
    type(mesh_t), intent(in) :: mesh
    type(team_t), intent(in) :: team
    integer, intent(in) :: planes(2), columns(:)
    type(field_t), intent(inout) :: field
    integer :: p
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(mesh, planes, columns, field) private(p)
    do p = planes(1), planes(2)
      call consistent_gains(field, mesh, p, columns)
    end do
    !$omp end parallel do
  end subroutine find_gains

  !> What is done with them.
  subroutine take_gains(method, team, planes, columns, take, dt, forced, field, sums)
    type(method_t), intent(in) :: method
    type(team_t), intent(in) :: team
    integer, intent(in) :: planes(2), columns(:), take
    real(dp), intent(in) :: dt
    logical, intent(in) :: forced                !! particles bring forces from outside
    type(field_t), intent(inout) :: field
    real(dp), intent(inout) :: sums(:, :)        !! (nodes_sums, planes)
    integer :: p
    !$omp parallel do schedule(static) num_threads(team%threads) if(team%threads > 1) &
    !$omp& default(none) shared(method, planes, columns, take, dt, forced, field, sums) private(p)
    do p = planes(1), planes(2)
      select case (take)
      case (take_solve)
        call consistent_book(field, p, dt, method%work_lag, method%gravity, forced, sums(:, p))
        call consistent_kick(field, p, dt)
      case (take_remap)
        call consistent_remap(field, p, method%unfelt)
      case default  ! take_add
        call consistent_add(field, p, columns)
      end select
    end do
    !$omp end parallel do
  end subroutine take_gains

end module sgmp_mass_stages
