!> What the correction of strains at surfaces keeps at the points of a velocity field
!! (`method surfaces=corrected`, doc/surfaces.md). Two neighbouring centres are a pair, which is
!! stored at the lower one; four around a face, in space, a quad, stored at the lowest.
module sgmp_pair_points
  use sgmp_columns, only: pair_sums, twists
  use sgmp_kinds, only: dp
  use sgmp_space, only: space_axisymmetric, space_dimensions
  implicit none
  private
  public :: pair_points_t, pair_points_make, pair_points_clear, pair_points_move
  public :: stage_weights, stage_twists, stage_gains, stage_forces

  !> Stages, one pass over the planes each: weights of the pairs, of the volumes as they lie;
  !! second differences of a velocity; what they add to its gradient; the transpose for the forces.
  integer, parameter :: stage_weights = 1, stage_twists = 2, stage_gains = 3, stage_forces = 4

  !> Components of a velocity gradient, by dimension.
  integer, parameter :: gains(3) = [1, 4, 9]

  type :: pair_points_t
    real(dp), allocatable :: weight(:, :)  !! (points, pair_sums) weights of pairs, then of quads
    !> (points, components of the vector times twists) second and third differences of a velocity,
    !! or the forces on them; about an axis behind them the slope of the radial component along z
    real(dp), allocatable :: centre(:, :)
    real(dp), allocatable :: gain(:, :)    !! (points, gains) added to a velocity gradient;
                                           !! about an axis behind it that of the hoop strain
  end type pair_points_t

contains

  !> Room for some points.
  pure subroutine pair_points_make(space, points, beyond, pairs)
    integer, intent(in) :: space, points
    integer, intent(in) :: beyond    !! points behind them, of which nothing is used
    type(pair_points_t), intent(out) :: pairs
    integer :: ndim, more, n
    ndim = space_dimensions(space)
    n = points + beyond
    more = merge(1, 0, space == space_axisymmetric)
    allocate (pairs%weight(n, pair_sums(ndim)))
    allocate (pairs%centre(n, ndim*twists(ndim) + more))
    allocate (pairs%gain(n, gains(ndim) + more))
    call pair_points_clear(points + 1, n, pairs)
  end subroutine pair_points_make

  !> Clears the points of a range, of what is read where nothing has been written.
  pure subroutine pair_points_clear(first, last, pairs)
    integer, intent(in) :: first, last
    type(pair_points_t), intent(inout) :: pairs
    pairs%weight(first:last, :) = 0.0_dp
    pairs%centre(first:last, :) = 0.0_dp
  end subroutine pair_points_clear

  !> Hands what is kept over without copying it.
  pure subroutine pair_points_move(from, to)
    type(pair_points_t), intent(inout) :: from, to
    call move_alloc(from%weight, to%weight)
    call move_alloc(from%centre, to%centre)
    call move_alloc(from%gain, to%gain)
  end subroutine pair_points_move

end module sgmp_pair_points
