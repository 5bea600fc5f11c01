! dimension-generic
#include "dimension.inc"
!> Differences between nodes and centres where cells are unequal (sgmp_graded_axis): gradients at a
!! row of centres, and the transpose, forces on a row of nodes.
!!
!! The derivative along an axis is the difference of the nodes over their distance h_c. Across it,
!! of matter that bends the nodes have the weights by which what is linear between them is read at
!! the centre: the gradient is that of products of quadratic B-splines with knots at the centres. Of
!! matter that flows they have equal weights, as masses have: a stress that grows along an axis then
!! pushes all nodes across it by the mass that they have (doc/grids.md, 2).
!!
!! Compiled without fused multiply-adds (CMakeLists.txt): which of two products is fused with their
!! sum would depend on where a row begins and ends, and with that on the ranks.
module DIM(sgmp_graded_rows)
  use sgmp_graded_axis, only: graded_tables
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  implicit none
  private
  public :: graded_divergence, graded_nodes, graded_points, graded_slopes, graded_spread, &
            graded_weights_t
#if NDIM > 1
  public :: graded_push, graded_twist_factors, graded_twists
#endif
#if NDIM == 2
  public :: graded_hoop, graded_hoop_force, graded_push_slopes, graded_slopes_across
#endif

  integer, parameter :: tile = 128               !! points of a row that are handled at a time

  !> Tables for a row: along x by point, of the slower axes of the row itself.
  type :: graded_weights_t
    real(dp), dimension(0:tile) :: slope, low, high  !! of centres along x
    real(dp) :: slow_slope(2, 2) = 1.0_dp        !! (lower|upper row, axis - 1)
    real(dp) :: slow(2, 2) = 0.5_dp              !! weights of the nodes in these rows
    real(dp) :: row(NROW) = 1.0_dp               !! their products, by row
  end type graded_weights_t

contains

  !> Tables for a row of centres: index i is centre first + i - 1; of the slower axes the rows are
  !! those of the nodes around it.
  pure subroutine graded_points(mesh, linear, row, first, n, w)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! numbers of the row along y, z; points
    type(graded_weights_t), intent(out) :: w
    real(dp) :: slope(1), low(1), high(1)
    integer :: a
    call graded_tables(mesh%axes(1), linear, first, n, w%slope(1), w%low(1), w%high(1))
    do a = 2, NDIM
      call graded_tables(mesh%axes(a), linear, row(a - 1), 1, slope, low, high)
      w%slow_slope(:, a - 1) = slope(1)
      w%slow(:, a - 1) = [low(1), high(1)]
    end do
    call multiply_rows(w)
  end subroutine graded_points

  !> Tables for a row of nodes: index i is the centre above node first + i - 1; of the slower axes
  !! the rows are those of the centres around it.
  pure subroutine graded_nodes(mesh, linear, row, first, n, w)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n
    type(graded_weights_t), intent(out) :: w
    real(dp), dimension(2) :: slope, low, high
    integer :: a
    call graded_tables(mesh%axes(1), linear, first - 1, n + 1, w%slope, w%low, w%high)
    do a = 2, NDIM
      call graded_tables(mesh%axes(a), linear, row(a - 1) - 1, 2, slope, low, high)
      w%slow_slope(:, a - 1) = slope
      w%slow(:, a - 1) = [high(1), low(2)]
    end do
    call multiply_rows(w)
  end subroutine graded_nodes

  !> Weights of the rows.
  pure subroutine multiply_rows(w)
    type(graded_weights_t), intent(inout) :: w
#if NDIM == 2
    w%row = w%slow(:, 1)
#elif NDIM == 3
    w%row = [w%slow(1, 1)*w%slow(1, 2), w%slow(1, 1)*w%slow(2, 2), &
             w%slow(2, 1)*w%slow(1, 2), w%slow(2, 1)*w%slow(2, 2)]
#endif
  end subroutine multiply_rows

  !> Derivatives of one column of nodes along all axes at the centres of a row (1/length).
  pure subroutine graded_slopes(mesh, linear, row, first, n, column, b, stride, records)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the centres
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), stride       !! b: records of node `first` in the rows
    real(dp), intent(inout) :: records(stride, n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_points(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      records(1, i) = mesh%inverse_h*w%slope(i)*(sum_rows(column, b, i, w%row) - &
                                                 sum_rows(column, b, i - 1, w%row))
#if NDIM > 1
      records(2, i) = mesh%inverse_h*w%slow_slope(1, 1)* &
                      (w%low(i)*step_2(column, b, i - 1, w%slow(:, 2)) + &
                       w%high(i)*step_2(column, b, i, w%slow(:, 2)))
#endif
#if NDIM > 2
      records(3, i) = mesh%inverse_h*w%slow_slope(1, 2)* &
                      (w%low(i)*step_3(column, b, i - 1, w%slow(:, 1)) + &
                       w%high(i)*step_3(column, b, i, w%slow(:, 1)))
#endif
    end do
  end subroutine graded_slopes

  !> What the nodes of a row get of a column of centres by what is linear between them.
  pure subroutine graded_spread(mesh, linear, row, first, n, column, b, f)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the nodes
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW)               !! records of centre first - 1 in the rows
    real(dp), intent(inout) :: f(n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_nodes(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      f(i) = w%low(i)*sum_rows(column, b, i, w%row) + &
             w%high(i - 1)*sum_rows(column, b, i - 1, w%row)
    end do
  end subroutine graded_spread

  !> Component of the force on the nodes of a row: the transpose, of its fluxes along the axes.
#if NDIM == 1
  pure subroutine graded_divergence(mesh, linear, row, first, n, x, b, f)
    real(dp), intent(in) :: x(*)                 !! flux along each axis, at the centres
#elif NDIM == 2
  pure subroutine graded_divergence(mesh, linear, row, first, n, x, y, b, f)
    real(dp), intent(in) :: x(*), y(*)           !! flux along each axis, at the centres
#else
  pure subroutine graded_divergence(mesh, linear, row, first, n, x, y, z, b, f)
    real(dp), intent(in) :: x(*), y(*), z(*)     !! flux along each axis, at the centres
#endif
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the nodes
    integer, intent(in) :: b(NROW)               !! records of centre first - 1 in the rows
    real(dp), intent(inout) :: f(n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_nodes(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      f(i) = w%slope(i)*sum_rows(x, b, i, w%row) - w%slope(i - 1)*sum_rows(x, b, i - 1, w%row)
#if NDIM > 1
      f(i) = f(i) + (w%low(i)*scaled_2(y, b, i, w) + w%high(i - 1)*scaled_2(y, b, i - 1, w))
#endif
#if NDIM > 2
      f(i) = f(i) + (w%low(i)*scaled_3(z, b, i, w) + w%high(i - 1)*scaled_3(z, b, i - 1, w))
#endif
      f(i) = mesh%inverse_h*f(i)
    end do
  end subroutine graded_divergence

#if NDIM > 1
  !> Second differences xy, xz, yz and third ones xyz of a column of nodes at the centres of a row,
  !! of the derivatives times h.
  pure subroutine graded_twists(mesh, linear, row, first, n, column, b, twists)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the centres
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW)               !! records of node `first` in the rows
    real(dp), intent(inout) :: twists(tile, 1 + 3*(NDIM - 2))
    type(graded_weights_t) :: w
    integer :: i
    call graded_points(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      twists(i, 1) = w%slope(i)*w%slow_slope(1, 1)*(step_2(column, b, i, w%slow(:, 2)) - &
                                                    step_2(column, b, i - 1, w%slow(:, 2)))
#if NDIM == 3
      twists(i, 2) = w%slope(i)*w%slow_slope(1, 2)*(step_3(column, b, i, w%slow(:, 1)) - &
                                                    step_3(column, b, i - 1, w%slow(:, 1)))
      twists(i, 3) = w%slow_slope(1, 1)*w%slow_slope(1, 2)* &
                     (w%high(i)*corners(column, b, i) + w%low(i)*corners(column, b, i - 1))
      twists(i, 4) = w%slope(i)*w%slow_slope(1, 1)*w%slow_slope(1, 2)* &
                     (corners(column, b, i) - corners(column, b, i - 1))
#endif
    end do
  end subroutine graded_twists

  !> The slopes' factors of these differences at the centres of a row.
  pure subroutine graded_twist_factors(mesh, linear, row, first, n, factors)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the centres
    real(dp), intent(out) :: factors(tile, 1 + 3*(NDIM - 2))
    type(graded_weights_t) :: w
    call graded_points(mesh, linear, row, first, n, w)
    factors(:n, 1) = w%slope(1:n)*w%slow_slope(1, 1)
#if NDIM == 3
    factors(:n, 2) = w%slope(1:n)*w%slow_slope(1, 2)
    factors(:n, 3) = w%slow_slope(1, 1)*w%slow_slope(1, 2)
    factors(:n, 4) = w%slope(1:n)*w%slow_slope(1, 1)*w%slow_slope(1, 2)
#endif
  end subroutine graded_twist_factors

  !> Adds to the forces on the nodes of a row what acts on these differences, factors included.
  pure subroutine graded_push(mesh, linear, row, first, n, b, points, centre, f)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the nodes
    integer, intent(in) :: b(NROW), points       !! b: records of centre first - 1 in the rows
    real(dp), intent(in) :: centre(points, *)    !! every NDIMth column from the first on
    real(dp), intent(inout) :: f(n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_nodes(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      f(i) = f(i) - (step_2(centre, b, i, w%slow(:, 2)) - step_2(centre, b, i - 1, w%slow(:, 2)))
#if NDIM == 3
      f(i) = f(i) - ((step_3(centre(1, 1 + NDIM), b, i, w%slow(:, 1)) - &
                      step_3(centre(1, 1 + NDIM), b, i - 1, w%slow(:, 1))) + &
                     (w%low(i)*corners(centre(1, 1 + 2*NDIM), b, i) + &
                      w%high(i - 1)*corners(centre(1, 1 + 2*NDIM), b, i - 1)))
      f(i) = f(i) + (corners(centre(1, 1 + 3*NDIM), b, i) - &
                     corners(centre(1, 1 + 3*NDIM), b, i - 1))
#endif
    end do
  end subroutine graded_push
#endif

#if NDIM == 2
  !> Hoop strain rates at the centres of a row (sgmp_axis).
  pure subroutine graded_hoop(mesh, linear, row, first, n, inner, outer, column, b, stride, records)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the centres
    real(dp), intent(in) :: inner(n), outer(n)   !! weights of the two nodes along z, each
    real(dp), intent(in) :: column(*)            !! radial velocity
    integer, intent(in) :: b(NROW), stride       !! b: records of node `first` in the rows
    real(dp), intent(inout) :: records(stride, n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_points(mesh, linear, row, first, n, w)
    do i = 1, n
      records(1, i) = 2.0_dp*mesh%inverse_h*(inner(i)*sum_rows(column, b, i - 1, w%row) + &
                                             outer(i)*sum_rows(column, b, i, w%row))
    end do
  end subroutine graded_hoop

  !> Adds the force of the hoop stress, the transpose, to a row of nodes.
  pure subroutine graded_hoop_force(mesh, linear, row, first, n, inner, outer, flux, b, f)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the nodes
    real(dp), intent(in) :: inner(0:n), outer(0:n)  !! weights at the centres around the nodes
    real(dp), intent(in) :: flux(*)              !! hoop stress times volume, at the centres
    integer, intent(in) :: b(NROW)               !! records of centre first - 1 in the rows
    real(dp), intent(inout) :: f(n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_nodes(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      f(i) = f(i) - 2.0_dp*mesh%inverse_h*(outer(i - 1)*sum_rows(flux, b, i - 1, w%row) + &
                                           inner(i)*sum_rows(flux, b, i, w%row))
    end do
  end subroutine graded_hoop_force

  !> Derivatives of hoop strain rates across a row of centres, times h^2.
  pure subroutine graded_slopes_across(mesh, linear, row, first, n, inner, outer, column, b, slopes)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the centres
    real(dp), intent(in) :: inner(n), outer(n)   !! as for graded_hoop
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW)               !! records of node `first` in the rows
    real(dp), intent(inout) :: slopes(n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_points(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      slopes(i) = 2.0_dp*w%slow_slope(1, 1)*(inner(i)*step_2(column, b, i - 1, w%slow(:, 2)) + &
                                             outer(i)*step_2(column, b, i, w%slow(:, 2)))
    end do
  end subroutine graded_slopes_across

  !> Adds to the forces on the nodes of a row what acts on these derivatives: the transpose.
  pure subroutine graded_push_slopes(mesh, linear, row, first, n, inner, outer, b, axial, f)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! as of graded_tables
    integer, intent(in) :: row(2), first, n      !! of the nodes
    real(dp), intent(in) :: inner(0:n), outer(0:n)  !! as for graded_hoop_force
    integer, intent(in) :: b(NROW)               !! records of centre first - 1 in the rows
    real(dp), intent(in) :: axial(*)             !! at the centres
    real(dp), intent(inout) :: f(n)
    type(graded_weights_t) :: w
    integer :: i
    call graded_nodes(mesh, linear, row, first, n, w)
    !$omp simd
    do i = 1, n
      f(i) = f(i) + 2.0_dp*(inner(i)*scaled_2(axial, b, i, w) + &
                            outer(i - 1)*scaled_2(axial, b, i - 1, w))
    end do
  end subroutine graded_push_slopes
#endif

  !> Sum of a column over the rows around a row, with weights.
  pure function sum_rows(column, b, i, weight) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    real(dp), intent(in) :: weight(NROW)
    real(dp) :: t
#if NDIM == 1
    t = column(b(1) + i)*weight(1)
#elif NDIM == 2
    t = weight(1)*column(b(1) + i) + weight(2)*column(b(2) + i)
#else
    t = (weight(1)*column(b(1) + i) + weight(2)*column(b(2) + i)) + &
        (weight(3)*column(b(3) + i) + weight(4)*column(b(4) + i))
#endif
  end function sum_rows

#if NDIM > 1
  !> Difference of the rows along the second axis, with weights along the third.
  pure function step_2(column, b, i, weight) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    real(dp), intent(in) :: weight(2)
    real(dp) :: t
#if NDIM == 2
    t = (weight(1) + weight(2))*(column(b(2) + i) - column(b(1) + i))
#else
    t = weight(1)*(column(b(3) + i) - column(b(1) + i)) + &
        weight(2)*(column(b(4) + i) - column(b(2) + i))
#endif
  end function step_2

  !> The same of what is first multiplied by the slopes of the rows.
  pure function scaled_2(column, b, i, w) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    type(graded_weights_t), intent(in) :: w
    real(dp) :: t
#if NDIM == 2
    t = w%slow_slope(2, 1)*column(b(2) + i) - w%slow_slope(1, 1)*column(b(1) + i)
#else
    t = w%slow_slope(2, 1)*(w%slow(1, 2)*column(b(3) + i) + w%slow(2, 2)*column(b(4) + i)) - &
        w%slow_slope(1, 1)*(w%slow(1, 2)*column(b(1) + i) + w%slow(2, 2)*column(b(2) + i))
#endif
  end function scaled_2
#endif

#if NDIM > 2
  !> Difference of the rows along the third axis, with weights along the second.
  pure function step_3(column, b, i, weight) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    real(dp), intent(in) :: weight(2)
    real(dp) :: t
    t = weight(1)*(column(b(2) + i) - column(b(1) + i)) + &
        weight(2)*(column(b(4) + i) - column(b(3) + i))
  end function step_3

  !> The same of what is first multiplied by the slopes of the rows.
  pure function scaled_3(column, b, i, w) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    type(graded_weights_t), intent(in) :: w
    real(dp) :: t
    t = w%slow_slope(2, 2)*(w%slow(1, 1)*column(b(2) + i) + w%slow(2, 1)*column(b(4) + i)) - &
        w%slow_slope(1, 2)*(w%slow(1, 1)*column(b(1) + i) + w%slow(2, 1)*column(b(3) + i))
  end function scaled_3

  !> Difference of the four rows along both of their axes.
  pure function corners(column, b, i) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    real(dp) :: t
    t = (column(b(4) + i) - column(b(3) + i)) - (column(b(2) + i) - column(b(1) + i))
  end function corners
#endif

end module DIM(sgmp_graded_rows)
