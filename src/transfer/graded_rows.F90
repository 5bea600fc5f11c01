! dimension-generic
#include "dimension.inc"
!> Differences between nodes and centres where cells are unequal (sgmp_graded_axis): gradients at a
!! row of centres, and the transpose, forces on a row of nodes.
!!
!! The derivative along an axis is the difference of the nodes over their distance h_c; across it
!! nodes have equal weights, as where masses and velocities go between nodes and centres: a stress
!! that grows along an axis then pushes all nodes across it by the mass that they have
!! (doc/grids.md, 2).
!!
!! Compiled without fused multiply-adds (CMakeLists.txt): which of two products is fused with their
!! sum would depend on where a row begins and ends, and with that on the ranks.
module DIM(sgmp_graded_rows)
  use sgmp_graded_axis, only: graded_inverse
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  implicit none
  private
  public :: graded_divergence, graded_nodes, graded_points, graded_slopes, graded_weights_t
#if NDIM > 1
  public :: graded_twist_factors
#endif

  integer, parameter :: tile = 128               !! points of a row that are handled at a time
  real(dp), parameter :: part = 0.5_dp**(NDIM - 1)  !! of a derivative, at a node beside it

  !> Slopes 1/h_c for a row: along x by point, of the slower axes of the rows around.
  type :: graded_weights_t
    real(dp) :: slope(0:tile)                    !! of centres along x
    real(dp) :: slow_slope(2, 2) = 1.0_dp        !! (lower|upper row, axis - 1)
  end type graded_weights_t

contains

  !> Slopes for a row of centres: index i is centre first + i - 1; of the slower axes the rows are
  !! those of the nodes around it.
  pure subroutine graded_points(mesh, row, first, n, w)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: row(2), first, n      !! numbers of the row along y, z; points
    type(graded_weights_t), intent(out) :: w
    real(dp) :: slope(1)
    integer :: a
    call graded_inverse(mesh%axes(1), first, n, w%slope(1))
    do a = 2, NDIM
      call graded_inverse(mesh%axes(a), row(a - 1), 1, slope)
      w%slow_slope(:, a - 1) = slope(1)
    end do
  end subroutine graded_points

  !> Slopes for a row of nodes: index i is the centre above node first + i - 1; of the slower axes
  !! the rows are those of the centres around it.
  pure subroutine graded_nodes(mesh, row, first, n, w)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: row(2), first, n
    type(graded_weights_t), intent(out) :: w
    integer :: a
    call graded_inverse(mesh%axes(1), first - 1, n + 1, w%slope)
    do a = 2, NDIM
      call graded_inverse(mesh%axes(a), row(a - 1) - 1, 2, w%slow_slope(1, a - 1))
    end do
  end subroutine graded_nodes

  !> Derivatives of one column of nodes along all axes at the centres of a row (1/length).
  pure subroutine graded_slopes(mesh, row, first, n, column, b, stride, records)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: row(2), first, n      !! of the centres
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), stride       !! b: records of node `first` in the rows
    real(dp), intent(inout) :: records(stride, n)
    type(graded_weights_t) :: w
    real(dp) :: scale
    integer :: i
    call graded_points(mesh, row, first, n, w)
    scale = part*mesh%inverse_h
    !$omp simd
    do i = 1, n
      records(1, i) = scale*w%slope(i)*(corner_sum(column, b, i) - corner_sum(column, b, i - 1))
#if NDIM > 1
      records(2, i) = scale*w%slow_slope(1, 1)* &
                      (corner_slope_2(column, b, i - 1) + corner_slope_2(column, b, i))
#endif
#if NDIM > 2
      records(3, i) = scale*w%slow_slope(1, 2)* &
                      (corner_slope_3(column, b, i - 1) + corner_slope_3(column, b, i))
#endif
    end do
  end subroutine graded_slopes

  !> Component of the force on the nodes of a row: the transpose, of its fluxes along the axes.
#if NDIM == 1
  pure subroutine graded_divergence(mesh, row, first, n, x, b, f)
    real(dp), intent(in) :: x(*)                 !! flux along each axis, at the centres
#elif NDIM == 2
  pure subroutine graded_divergence(mesh, row, first, n, x, y, b, f)
    real(dp), intent(in) :: x(*), y(*)           !! flux along each axis, at the centres
#else
  pure subroutine graded_divergence(mesh, row, first, n, x, y, z, b, f)
    real(dp), intent(in) :: x(*), y(*), z(*)     !! flux along each axis, at the centres
#endif
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: row(2), first, n      !! of the nodes
    integer, intent(in) :: b(NROW)               !! records of centre first - 1 in the rows
    real(dp), intent(inout) :: f(n)
    type(graded_weights_t) :: w
    real(dp) :: scale
    integer :: i
    call graded_nodes(mesh, row, first, n, w)
    scale = part*mesh%inverse_h
    !$omp simd
    do i = 1, n
      f(i) = w%slope(i)*corner_sum(x, b, i) - w%slope(i - 1)*corner_sum(x, b, i - 1)
#if NDIM > 1
      f(i) = f(i) + (scaled_2(y, b, i, w) + scaled_2(y, b, i - 1, w))
#endif
#if NDIM > 2
      f(i) = f(i) + (scaled_3(z, b, i, w) + scaled_3(z, b, i - 1, w))
#endif
      f(i) = scale*f(i)
    end do
  end subroutine graded_divergence

#if NDIM > 1
  !> Factors of the second differences xy, xz, yz and the third ones xyz at the centres of a row, by
  !! which those of equal cells are derivatives times h.
  pure subroutine graded_twist_factors(mesh, row, first, n, factors)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: row(2), first, n      !! of the centres
    real(dp), intent(out) :: factors(tile, 1 + 3*(NDIM - 2))
    type(graded_weights_t) :: w
    call graded_points(mesh, row, first, n, w)
    factors(:n, 1) = w%slope(1:n)*w%slow_slope(1, 1)
#if NDIM == 3
    factors(:n, 2) = w%slope(1:n)*w%slow_slope(1, 2)
    factors(:n, 3) = w%slow_slope(1, 1)*w%slow_slope(1, 2)
    factors(:n, 4) = w%slope(1:n)*w%slow_slope(1, 1)*w%slow_slope(1, 2)
#endif
  end subroutine graded_twist_factors
#endif

#include "corner_sums.inc"

#if NDIM > 1
  !> Difference of the rows along the second axis of what is first multiplied by their slopes.
  pure function scaled_2(column, b, i, w) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    type(graded_weights_t), intent(in) :: w
    real(dp) :: t
#if NDIM == 2
    t = w%slow_slope(2, 1)*column(b(2) + i) - w%slow_slope(1, 1)*column(b(1) + i)
#else
    t = w%slow_slope(2, 1)*(column(b(3) + i) + column(b(4) + i)) - &
        w%slow_slope(1, 1)*(column(b(1) + i) + column(b(2) + i))
#endif
  end function scaled_2
#endif

#if NDIM > 2
  !> The same along the third axis.
  pure function scaled_3(column, b, i, w) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    type(graded_weights_t), intent(in) :: w
    real(dp) :: t
    t = w%slow_slope(2, 2)*(column(b(2) + i) + column(b(4) + i)) - &
        w%slow_slope(1, 2)*(column(b(1) + i) + column(b(3) + i))
  end function scaled_3
#endif

end module DIM(sgmp_graded_rows)
