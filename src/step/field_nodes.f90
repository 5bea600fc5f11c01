!> The node stages of one velocity field, over the planes that this rank's particles read: which
!! dimension's procedures do them, and how threads share the planes.
module sgmp_field_nodes
  use sgmp_halo, only: halo_planes
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_nodes_1d, only: nodes_remap_1d => nodes_remap, nodes_solve_1d => nodes_solve, &
                           nodes_normalise_1d => nodes_normalise, &
                           nodes_velocity_1d => nodes_velocity
  use sgmp_nodes_2d, only: nodes_remap_2d => nodes_remap, nodes_solve_2d => nodes_solve, &
                           nodes_normalise_2d => nodes_normalise, &
                           nodes_velocity_2d => nodes_velocity
  use sgmp_nodes_3d, only: nodes_remap_3d => nodes_remap, nodes_solve_3d => nodes_solve, &
                           nodes_normalise_3d => nodes_normalise, &
                           nodes_velocity_3d => nodes_velocity
  implicit none
  private
  public :: field_node_planes, field_normalise, field_remap, field_solve, field_velocity

contains

  !> Planes of nodes that this rank's particles read; p2 < p1: none.
  pure subroutine field_node_planes(model, f, p1, p2)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f                     !! field
    integer, intent(out) :: p1, p2
    call halo_planes(model%fields(f), model%partition%own + [0, model%partition%nodes], p1, p2)
  end subroutine field_node_planes

  !> Volume-normalised stress at the centres around those nodes.
  subroutine field_normalise(model, f)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f
    integer :: p, p1, p2
    call halo_planes(model%fields(f), model%partition%own + [-1, model%partition%nodes], p1, p2)
    !$omp parallel do schedule(static) num_threads(model%threads) if(model%threads > 1) &
    !$omp& default(none) shared(model, f, p1, p2) private(p)
    do p = p1, p2
      select case (model%mesh%ndim)
      case (1)
        call nodes_normalise_1d(model%fields(f), model%mesh, p, model%interior)
      case (2)
        call nodes_normalise_2d(model%fields(f), model%mesh, p, model%interior)
      case default
        call nodes_normalise_3d(model%fields(f), model%mesh, p, model%interior)
      end select
    end do
    !$omp end parallel do
  end subroutine field_normalise

  !> Momentum equation (Eqs. 33, 34).
  subroutine field_solve(model, f, dt, gravity, forced, sums)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f
    real(dp), intent(in) :: dt, gravity(3)
    logical, intent(in) :: forced                !! the moments carry an external force
    real(dp), intent(inout) :: sums(:, :)        !! (nodes_sums, planes), added to
    integer :: p, p1, p2
    call field_node_planes(model, f, p1, p2)
    !$omp parallel do schedule(static) num_threads(model%threads) if(model%threads > 1) &
    !$omp& default(none) shared(model, f, dt, gravity, forced, sums, p1, p2) private(p)
    do p = p1, p2
      select case (model%mesh%ndim)
      case (1)
        call nodes_solve_1d(model%fields(f), model%mesh, p, dt, gravity, model%cutoff, forced, &
                            sums(:, p))
      case (2)
        call nodes_solve_2d(model%fields(f), model%mesh, p, dt, gravity, model%cutoff, forced, &
                            sums(:, p))
      case default
        call nodes_solve_3d(model%fields(f), model%mesh, p, dt, gravity, model%cutoff, forced, &
                            sums(:, p))
      end select
    end do
    !$omp end parallel do
  end subroutine field_solve

  !> Velocity from the projected momentum.
  subroutine field_velocity(model, f)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f
    integer :: p, p1, p2
    call field_node_planes(model, f, p1, p2)
    !$omp parallel do schedule(static) num_threads(model%threads) if(model%threads > 1) &
    !$omp& default(none) shared(model, f, p1, p2) private(p)
    do p = p1, p2
      select case (model%mesh%ndim)
      case (1)
        call nodes_velocity_1d(model%fields(f), model%mesh, p, model%cutoff)
      case (2)
        call nodes_velocity_2d(model%fields(f), model%mesh, p, model%cutoff)
      case default
        call nodes_velocity_3d(model%fields(f), model%mesh, p, model%cutoff)
      end select
    end do
    !$omp end parallel do
  end subroutine field_velocity

  !> Velocity re-mapped from the updated particles, in the place of the acceleration (MUSL).
  subroutine field_remap(model, f)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f
    integer :: p, p1, p2
    call field_node_planes(model, f, p1, p2)
    !$omp parallel do schedule(static) num_threads(model%threads) if(model%threads > 1) &
    !$omp& default(none) shared(model, f, p1, p2) private(p)
    do p = p1, p2
      select case (model%mesh%ndim)
      case (1)
        call nodes_remap_1d(model%fields(f), model%mesh, p)
      case (2)
        call nodes_remap_2d(model%fields(f), model%mesh, p)
      case default
        call nodes_remap_3d(model%fields(f), model%mesh, p)
      end select
    end do
    !$omp end parallel do
  end subroutine field_remap

end module sgmp_field_nodes
