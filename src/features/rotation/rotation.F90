! dimension-generic
#include "dimension.inc"
#if NDIM > 1
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
  use DIM(sgmp_auxmesh), only: node_rows
  use sgmp_columns, only: node_acceleration
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_rotation_points, only: at_centre, at_force, at_node
  use DIM(sgmp_rotation_rows), only: add_differences, centre_rows, next_run, slope, &
                                     sums_row, tile
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

  !> Moments t_I = A_I^-T (D_I x f_I) of a run of nodes, f the internal force.
  pure subroutine rotation_moments(field, s, first, n)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n           !! interval, first node, nodes
    real(dp) :: moment(tile, NSPIN)
    integer :: q, r, from, to
    from = field%neighbour(0, 0, s) + first
    to = from + n - 1
    associate (rotation => field%rotation)
      do q = 1, NSPIN
        associate (a => axes(1, q), b => axes(2, q), f => rotation%force)
          moment(:n, q) = rotation%offset(from:to, a)*f(from:to, b) - &
                          rotation%offset(from:to, b)*f(from:to, a)
        end associate
      end do
      do q = 1, NSPIN
        rotation%moment(from:to, q) = 0.0_dp
        do r = 1, NSPIN
          rotation%moment(from:to, q) = rotation%moment(from:to, q) + &
                                        moment(:n, r)*rotation%inverse(from:to, r + NSPIN*(q - 1))
        end do
      end do
    end associate
  end subroutine rotation_moments

  !> Couples T_c = m_c sum_I t_I at the centres of one plane.
  pure subroutine rotation_couples(field, plane)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    real(dp) :: t(tile)
    integer :: s, first, last, n, q, at
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_centre, first, last)
        if (last < first) exit
        n = last - first + 1
        at = field%neighbour(0, 0, s) + first
        do q = 1, NSPIN
          call sums_row(n, field%rotation%moment(1, q), node_rows(field, s, first), t)
          field%rotation%centre(at:at + n - 1, q) = field%moment(at:at + n - 1, &
            field%columns%mass)*t(:n)
        end do
      end do
    end do
  end subroutine rotation_couples

  !> f = f - sum_c T_c x G_cI for a tile of nodes: with the couples the force has no moment about
  !! the centres of mass.
  pure subroutine rotation_force(field, s, first, n, f)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n
    real(dp), intent(inout) :: f(:, :)           !! (n or more, ndim)
    integer :: b(NROW), i, j, q, from, at
    at = field%neighbour(0, 0, s) + first - 1
    i = 1
    do while (i <= n)
      if (.not. field%rotation%at(at + i, at_force)) then
        i = i + 1
        cycle
      end if
      from = i
      do while (i <= n)
        if (.not. field%rotation%at(at + i, at_force)) exit
        i = i + 1
      end do
      b = centre_rows(field, s, first + from - 1)
      j = i - from
      associate (t => field%rotation%centre)
        do q = 1, NSPIN
          call add_differences(j, -slope, axes(2, q), t(1, q), b, f(from:i - 1, axes(1, q)))
          call add_differences(j, slope, axes(1, q), t(1, q), b, f(from:i - 1, axes(2, q)))
        end do
      end associate
    end do
  end subroutine rotation_force

  !> Mass times the curl of a nodal velocity, less the kick times the acceleration, at the centres
  !! of one plane.
  pure subroutine rotation_curls(field, plane, column, kick)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane, column         !! first column of the velocity
    real(dp), intent(in) :: kick
    real(dp) :: curl(tile)
    integer :: s, first, last, n, q, at
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_centre, first, last)
        if (last < first) exit
        n = last - first + 1
        at = field%neighbour(0, 0, s) + first
        do q = 1, NSPIN
          curl(:n) = 0.0_dp
          call add_curl(field, node_rows(field, s, first), n, q, column, slope, curl)
          if (abs(kick) > 0.0_dp) call add_curl(field, node_rows(field, s, first), n, q, &
                                                node_acceleration, -kick*slope, curl)
          field%rotation%centre(at:at + n - 1, q) = &
            field%moment(at:at + n - 1, field%columns%mass)*curl(:n)
        end do
      end do
    end do
  end subroutine rotation_curls

  !> Adds a component of the curl of what the nodes hold from a column on, times a factor.
  pure subroutine add_curl(field, rows, n, component, column, factor, curl)
    type(field_t), intent(in) :: field
    integer, intent(in) :: rows(NROW), n, component, column
    real(dp), intent(in) :: factor
    real(dp), intent(inout) :: curl(tile)
    associate (a => axes(1, component), b => axes(2, component))
      call add_differences(n, factor, a, field%node(1, column + b - 1), rows, curl)
      call add_differences(n, -factor, b, field%node(1, column + a - 1), rows, curl)
    end associate
  end subroutine add_curl

  !> Takes velocities to the places of the nodes of one plane, v = v - w x D, w from the curl above.
  pure subroutine rotation_place(field, plane, columns)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane, columns(:)
    integer :: s, first, last, v
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_node, first, last)
        if (last < first) exit
        do v = 1, size(columns)
          call place_run(field, s, first, last - first + 1, columns(v) - 1)
        end do
      end do
    end do
  end subroutine rotation_place

  !> The same of one velocity at a run of nodes.
  pure subroutine place_run(field, s, first, n, before)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n
    integer, intent(in) :: before                !! columns before the velocity's
    real(dp) :: curl(tile, NSPIN), w(tile)
    integer :: q, r, from, to, rows(NROW)
    rows = centre_rows(field, s, first)
    from = field%neighbour(0, 0, s) + first
    to = from + n - 1
    do q = 1, NSPIN
      call sums_row(n, field%rotation%centre(1, q), rows, curl(1, q))
    end do
    associate (rotation => field%rotation, v => field%node)
      do q = 1, NSPIN
        w(:n) = 0.0_dp
        do r = 1, NSPIN
          w(:n) = w(:n) + rotation%inverse(from:to, q + NSPIN*(r - 1))*curl(:n, r)
        end do
        associate (a => axes(1, q), b => axes(2, q))
          v(from:to, before + a) = v(from:to, before + a) + w(:n)*rotation%offset(from:to, b)
          v(from:to, before + b) = v(from:to, before + b) - w(:n)*rotation%offset(from:to, a)
        end associate
      end do
    end associate
  end subroutine place_run

end module DIM(sgmp_rotation)
#endif
