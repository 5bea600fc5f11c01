! dimension-generic
#include "dimension.inc"
#if NDIM > 1
#if NDIM == 2
#define VECTOR 1
#else
#define VECTOR 4
#endif
#define SUM vectors_sum
#define DIFFERENCES vectors_differences
!> Rigid rotation without strain (doc/rotation.md): velocities to the places of the nodes, and its
!! transpose for the forces.
!!
!! A node's velocity belongs to the centre of mass of what the node stands for, X_I, which near a
!! free surface is not the node's place x_I. It is taken there by the angular velocity w_I of what
!! is around the node, v^_I = v_I - w_I x (X_I - x_I), before particles are strained and moved by
!! it; the forces are the transpose of that. Rigid motion then strains nothing, and the internal
!! forces have no moment about the centres of mass, which is what particles receive.
!!
!! w_I is the angular velocity that a rigid motion would need for the curl found around the node
!! (sgmp_rotation_offsets). It is that of the velocity by which particles are strained: the nodes of
!! a body at rest may have accelerations that no particle feels, which are gone in the next step.
!! Taken to other places they would move particles on and on, without a strain that held them back.
!! Lengths are in cells.
module DIM(sgmp_rotation)
  use DIM(sgmp_auxmesh), only: graded_row, node_rows
  use sgmp_columns, only: node_acceleration
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_width
  use DIM(sgmp_graded_rows), only: graded_nodes, graded_weights_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_rotation_points, only: at_centre, at_force, at_node
  use DIM(sgmp_rotation_rows), only: centre_rows, next_run, slope
  implicit none
  private
  public :: rotation_couples, rotation_curls, rotation_place, rotation_moments, rotation_force

  !> The two axes across which each component of an angular velocity turns.
#if NDIM == 2
  integer, parameter :: axes(2, NSPIN) = reshape([1, 2], [2, 1])
#else
  integer, parameter :: axes(2, NSPIN) = reshape([2, 3, 3, 1, 1, 2], [2, 3])
#endif

contains

  !> Moments t_I = A_I^-T (D_I x f_I) of forces on a tile of nodes.
  pure subroutine rotation_moments(field, s, first, n, f)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n           !! interval, first node, nodes
    real(dp), intent(in) :: f(:, :)              !! (n or more, ndim)
    real(dp) :: moment(NSPIN), total
    integer :: q, r, i, at
    at = field%neighbour(0, 0, s) + first - 1
    associate (rotation => field%rotation)
      do i = 1, n
        if (.not. rotation%at(at + i, at_node)) cycle
        do q = 1, NSPIN
          associate (a => axes(1, q), b => axes(2, q))
            moment(q) = rotation%offset(a, at + i)*f(i, b) - rotation%offset(b, at + i)*f(i, a)
          end associate
        end do
        do q = 1, NSPIN
          total = 0.0_dp
          do r = 1, NSPIN
            total = total + moment(r)*rotation%inverse(r, q, at + i)
          end do
          rotation%moment(q, at + i) = total
        end do
      end do
    end associate
  end subroutine rotation_moments

  !> Couples T_c = m_c sum_I t_I at the centres of one plane.
  pure subroutine rotation_couples(field, plane, couple)
    type(field_t), intent(in) :: field
    integer, intent(in) :: plane
    real(dp), intent(inout) :: couple(VECTOR, *)
    integer :: s, i, at, b(NROW)
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      at = field%neighbour(0, 0, s)
      b = node_rows(field, s, 0)
      do i = field%work%first(s), field%work%last(s)
        if (.not. field%rotation%at(at + i, at_centre)) cycle
        couple(:, at + i) = field%moment(at + i, field%columns%mass)* &
                            vectors_sum(field%rotation%moment, b, i + 1)
      end do
    end do
  end subroutine rotation_couples

  !> f = f - sum_c T_c x G_cI for a tile of nodes: with the couples the force has no moment about
  !! the centres of mass.
  pure subroutine rotation_force(field, mesh, s, first, n, couple, f)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: couple(VECTOR, *)
    real(dp), intent(inout) :: f(:, :)           !! (n or more, ndim)
    real(dp) :: t(VECTOR, NDIM)
    type(graded_weights_t) :: w
    integer :: b(NROW), i, q, at
    at = field%neighbour(0, 0, s) + first - 1
    b = centre_rows(field, s, first)
    if (mesh%graded) call graded_nodes(mesh, field%linear, graded_row(field, s), first, n, w)
    do i = 1, n
      if (.not. field%rotation%at(at + i, at_force)) cycle
      if (mesh%graded) then
        t = scaled_differences(couple, b, i, w%slope(i - 1:i), w%slow_slope)
      else
        t = vectors_differences(couple, b, i)
      end if
      do q = 1, NSPIN
        f(i, axes(1, q)) = f(i, axes(1, q)) - slope*t(q, axes(2, q))
        f(i, axes(2, q)) = f(i, axes(2, q)) + slope*t(q, axes(1, q))
      end do
    end do
  end subroutine rotation_force

  !> Mass times the curl of a nodal velocity, less the kick times the acceleration, at the centres
  !! of one plane.
  pure subroutine rotation_curls(field, mesh, plane, column, kick)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane, column         !! first column of the velocity
    real(dp), intent(in) :: kick
    real(dp) :: curl(NSPIN), factors(NDIM)
    integer :: s, i, at, b(NROW)
    factors = slope
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      at = field%neighbour(0, 0, s)
      b = node_rows(field, s, 0)
      do i = field%work%first(s), field%work%last(s)
        if (.not. field%rotation%at(at + i, at_centre)) cycle
        curl = 0.0_dp
        if (mesh%graded) factors = slope*rotation_slopes(field, mesh, s, i)
        call add_curl(size(field%node, 1), field%node(1, column), b, i + 1, factors, curl)
        if (abs(kick) > 0.0_dp) call add_curl(size(field%node, 1), &
          field%node(1, node_acceleration), b, i + 1, -kick*factors, curl)
        field%rotation%couple(:NSPIN, at + i) = field%moment(at + i, field%columns%mass)*curl
      end do
    end do
  end subroutine rotation_curls

  !> Adds a factor times the curl of a nodal vector at one centre.
  pure subroutine add_curl(points, v, rows, i, factor, curl)
    integer, intent(in) :: points
    real(dp), intent(in) :: v(points, NDIM)
    integer, intent(in) :: rows(NROW), i
    real(dp), intent(in) :: factor(NDIM)         !! by axis of the difference
    real(dp), intent(inout) :: curl(NSPIN)
    integer :: q
    do q = 1, NSPIN
      associate (a => axes(1, q), b => axes(2, q))
        curl(q) = curl(q) + factor(a)*corner_difference(v(1, b), rows, i, a)
        curl(q) = curl(q) - factor(b)*corner_difference(v(1, a), rows, i, b)
      end associate
    end do
  end subroutine add_curl

  !> Difference of what the points around one hold, upper minus lower along an axis.
  pure function corner_difference(column, b, i, axis) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i, axis
    real(dp) :: t
    select case (axis)
    case (1)
      t = corner_sum(column, b, i) - corner_sum(column, b, i - 1)
    case (2)
      t = corner_slope_2(column, b, i - 1) + corner_slope_2(column, b, i)
    case default
#if NDIM == 3
      t = corner_slope_3(column, b, i - 1) + corner_slope_3(column, b, i)
#else
      t = 0.0_dp
#endif
    end select
  end function corner_difference

  !> Slopes 1/h_c along the axes at a centre, of unequal cells.
  pure function rotation_slopes(field, mesh, s, centre) result(slopes)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, centre
    real(dp) :: slopes(NDIM)
    integer :: row(2), axis
    row = graded_row(field, s)
    slopes(1) = 1.0_dp/graded_width(mesh%axes(1), centre)
    do axis = 2, NDIM
      slopes(axis) = 1.0_dp/graded_width(mesh%axes(axis), row(axis - 1))
    end do
  end function rotation_slopes

  !> Differences of vectors that are first multiplied by the slopes of their centres along the axis.
  pure function scaled_differences(vectors, b, i, fast, slow) result(t)
    real(dp), intent(in) :: vectors(VECTOR, *)
    integer, intent(in) :: b(NROW), i
    real(dp), intent(in) :: fast(2)              !! of centres i - 1, i along x
    real(dp), intent(in) :: slow(2, 2)           !! (lower|upper row, axis - 1)
    real(dp) :: t(VECTOR, NDIM)
    integer :: r, upper(2)
    t = 0.0_dp
    do r = 1, NROW
      t(:, 1) = t(:, 1) + (fast(2)*vectors(:, b(r) + i) - fast(1)*vectors(:, b(r) + i - 1))
      upper = 1 + [(r - 1)/2, mod(r - 1, 2)]
      if (NDIM == 2) upper(1) = r
      associate (both => vectors(:, b(r) + i) + vectors(:, b(r) + i - 1))
        t(:, 2) = t(:, 2) + (2*upper(1) - 3)*slow(upper(1), 1)*both
        if (NDIM == 3) t(:, NDIM) = t(:, NDIM) + (2*upper(2) - 3)*slow(upper(2), 2)*both
      end associate
    end do
  end function scaled_differences

  !> Takes velocities to the places of the nodes of one plane, v = v - w x D, w from the curl above.
  pure subroutine rotation_place(field, plane, columns)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane, columns(:)
    integer :: s, first, last
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_node, first, last)
        if (last < first) exit
        call place_run(field, s, first, last - first + 1, columns)
      end do
    end do
  end subroutine rotation_place

  !> The same of a run of nodes.
  pure subroutine place_run(field, s, first, n, columns)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n, columns(:)
    real(dp) :: curl(VECTOR), w(VECTOR), moved(NDIM)
    integer :: i, q, c, at, b(NROW)
    b = centre_rows(field, s, first)
    at = field%neighbour(0, 0, s) + first - 1
    associate (rotation => field%rotation, v => field%node)
      do i = 1, n
        curl = vectors_sum(rotation%couple, b, i)
        w = 0.0_dp
        do q = 1, NSPIN
          w = w + rotation%inverse(:VECTOR, q, at + i)*curl(q)
        end do
        do c = 1, size(columns)
          moved = v(at + i, columns(c):columns(c) + NDIM - 1)
          do q = 1, NSPIN
            associate (x => axes(1, q), y => axes(2, q))
              moved(x) = moved(x) + w(q)*rotation%offset(y, at + i)
              moved(y) = moved(y) - w(q)*rotation%offset(x, at + i)
            end associate
          end do
          v(at + i, columns(c):columns(c) + NDIM - 1) = moved
        end do
      end do
    end associate
  end subroutine place_run

#include "vectors_sum.inc"
#include "vectors_differences.inc"
#include "corner_sums.inc"

end module DIM(sgmp_rotation)
#endif
