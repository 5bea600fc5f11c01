! dimension-generic
#include "dimension.inc"
#if NDIM > 1
!> Rigid rotation without strain (doc/spin.md).
!!
!! A node's velocity belongs to the centre of mass of what the node stands for, X_I, which near a
!! free surface is not the node's place x_I. It is taken there by the angular velocity w_I of what
!! is around the node, v^_I = v_I - w_I x (X_I - x_I), before particles are strained and moved by
!! it; the forces are the transpose of that. Rigid motion then strains nothing, and the internal
!! forces have no moment about the centres of mass, which is what particles receive.
!!
!! w_I is the angular velocity that a rigid motion would need for the curl found around the node:
!! with J_c = 1 + sum_I D_I (x) G_cI the curl of omega x X at a centre is (tr J - J) omega. Lengths
!! are in cells. Points far from surfaces, where D_I vanishes, are passed over.
!!
!! Longer than 500 lines: correction and transpose must be read side by side.
module DIM(sgmp_rotation)
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_rotation_points, only: at_centre, at_force, at_node
  use sgmp_rows, only: key_j, key_k
#if NDIM == 3
  use sgmp_vectors, only: cross
#endif
  implicit none
  private
  public :: rotation_offsets, rotation_inertia, rotation_inverses, rotation_couples, rotation_curls
  public :: rotation_place, rotation_moments, rotation_force, next_run
  public :: angular_tensor, inverse_tensor, tile

  integer, parameter :: tile = 128   !! points of a row that are handled at a time
  !> A tensor with a smaller determinant, for a mass of 1, has no inverse that could be trusted: in
  !! the interior it is 2^d.
  real(dp), parameter :: least_determinant = 0.1_dp
  real(dp), parameter :: least_trace = 0.5_dp*(NDIM - 1)  !! half that of a body one cell thick
  real(dp), parameter :: slope = 0.5_dp**(NDIM - 1)  !! factor of a difference between 2^d corners

contains

  !> Offsets D_I = sum_c (M_c + m_c (x_c - x_I))/sum_c m_c of the nodes of one plane, M_c the first
  !! moment of the mass that particles gave to a centre.
  pure subroutine rotation_offsets(field, mesh, plane, cutoff)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp), intent(in) :: cutoff               !! nodes lighter than this are ignored
    real(dp) :: m(tile), offset(tile, NDIM)
    integer :: s, first, n, i, a, b(NROW), before
    before = field%columns%offset - 1
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        b = centre_rows(field, s, first)
        call sums_row(n, field%moment(1, field%columns%mass), b, m)
        do a = 1, NDIM
          call sums_row(n, field%moment(1, before + a), b, offset(1, a))
          call add_differences(n, 0.5_dp, a, field%moment(1, field%columns%mass), b, offset(1, a))
        end do
        do i = 1, n
          if (m(i)*0.5_dp**NDIM > cutoff) then
            offset(i, :) = offset(i, :)/m(i)
            if (all(abs(offset(i, :)) < field%rotation%least_offset)) offset(i, :) = 0.0_dp
          else
            offset(i, :) = 0.0_dp
          end if
        end do
        call hold_offsets(field, mesh, s, first, n, offset)
        call keep_offsets(n, field%neighbour(0, 0, s) + first - 1, offset, field)
      end do
    end do
  end subroutine rotation_offsets

  !> Nodes on a slip wall have the offset of a body with its mirror image, those on a fixed wall do
  !! not move.
  pure subroutine hold_offsets(field, mesh, s, first, n, offset)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(inout) :: offset(tile, NDIM)
    integer :: axis, side, r(2)
    do axis = 1, NDIM
      do side = 1, 2
        r = on_wall(field, mesh, s, first, n, axis, side)
        if (mesh%wall(side, axis) == wall_fixed) then
          offset(r(1):r(2), :) = 0.0_dp
        else
          offset(r(1):r(2), axis) = 0.0_dp
        end if
      end do
    end do
  end subroutine hold_offsets

  !> First and last node of a tile that lies on a wall; none: 1, 0.
  pure function on_wall(field, mesh, s, first, n, axis, side) result(nodes)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n, axis, side
    integer :: nodes(2)
    integer :: at, row(3)
    nodes = [1, 0]
    if (mesh%wall(side, axis) == wall_free) return
    at = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
    if (axis == 1) then
      if (at >= first .and. at < first + n) nodes = at - first + 1
    else
      row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
      if (row(merge(3, axis, NDIM == 2)) == at) nodes = [1, n]
    end if
  end function on_wall

  !> Stores the offsets of a tile; what is left of a node that takes part no longer is cleared.
  pure subroutine keep_offsets(n, before, offset, field)
    integer, intent(in) :: n, before             !! nodes; record before the first
    real(dp), intent(in) :: offset(tile, NDIM)
    type(field_t), intent(inout) :: field
    logical :: part
    integer :: i
    associate (rotation => field%rotation)
      do i = 1, n
        part = any(abs(offset(i, :)) > 0.0_dp)
        if (.not. (part .or. rotation%at(before + i, at_node))) cycle
        rotation%offset(before + i, :) = offset(i, :)
        rotation%at(before + i, at_node) = part
        if (.not. part) rotation%moment(before + i, :) = 0.0_dp
      end do
    end associate
  end subroutine keep_offsets

  !> Mass times tr J - J at the centres around those nodes.
  pure subroutine rotation_inertia(field, plane)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    integer :: s, first, last
    call mark(field, plane, at_node, at_centre)
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_centre, first, last)
        if (last < first) exit
        call inertia_run(field, s, first, last - first + 1)
      end do
    end do
  end subroutine rotation_inertia

  !> The same of a run of centres.
  pure subroutine inertia_run(field, s, first, n)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n
    real(dp) :: slopes(tile, NDIM, NDIM), k(NSPIN, NSPIN)
    integer :: i, a, e, b(NROW), at
    b = node_rows(field, s, first)
    slopes(:n, :, :) = 0.0_dp
    do e = 1, NDIM
      do a = 1, NDIM
        call add_differences(n, slope, e, field%rotation%offset(1, a), b, slopes(1, a, e))
      end do
    end do
    at = field%neighbour(0, 0, s) + first - 1
    do i = 1, n
      k = angular_tensor(slopes(i, :, :))
      field%rotation%centre(at + i, :) = field%moment(at + i, field%columns%mass)*reshape(k, &
        [NSPIN*NSPIN])
    end do
  end subroutine inertia_run

  !> The tensor that takes an angular velocity to the curl of the velocity that its rigid motion
  !! gives to centres of mass, tr J - J (in the plane tr J); from the derivatives of the offsets.
  !!
  !! In bodies thinner than a cell along two axes, of which the nodes' centres of mass are about the
  !! same, the trace is kept from vanishing.
  pure function angular_tensor(slopes) result(k)
    real(dp), intent(in) :: slopes(NDIM, NDIM)   !! (a, b): component a along axis b
    real(dp) :: k(NSPIN, NSPIN)
    real(dp) :: trace
    integer :: a
    trace = real(NDIM, dp)
    do a = 1, NDIM
      trace = trace + slopes(a, a)
    end do
    trace = max(trace, least_trace)
#if NDIM == 2
    k = trace
#else
    k = -slopes
    do a = 1, NDIM
      k(a, a) = k(a, a) + (trace - 1.0_dp)
    end do
#endif
  end function angular_tensor

  !> Inverses of A_I = sum_c m_c (tr J - J) at the nodes.
  pure subroutine rotation_inverses(field, mesh, plane)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    integer :: s, first, last
    call mark(field, plane, at_centre, at_force)
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_node, first, last)
        if (last < first) exit
        call inverse_run(field, mesh, s, first, last - first + 1)
      end do
    end do
  end subroutine rotation_inverses

  !> The same of a run of nodes.
  pure subroutine inverse_run(field, mesh, s, first, n)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp) :: sums(tile, NSPIN*NSPIN), m(tile), inverse(NSPIN, NSPIN)
    integer :: i, q, at, b(NROW), axis, side, r(2)
    logical :: held(tile, NSPIN)
    b = centre_rows(field, s, first)
    call sums_row(n, field%moment(1, field%columns%mass), b, m)
    do q = 1, NSPIN*NSPIN
      call sums_row(n, field%rotation%centre(1, q), b, sums(1, q))
    end do
    held = .false.
    do axis = 1, NDIM
      do side = 1, 2
        r = on_wall(field, mesh, s, first, n, axis, side)
        held(r(1):r(2), :) = held(r(1):r(2), :) .or. spread(turns_across(axis), 1, r(2) - r(1) + 1)
      end do
    end do
    at = field%neighbour(0, 0, s) + first - 1
    do i = 1, n
      inverse = inverse_tensor(reshape(sums(i, :), [NSPIN, NSPIN]), m(i), held(i, :))
      field%rotation%inverse(at + i, :) = reshape(inverse, [NSPIN*NSPIN])
    end do
  end subroutine inverse_run

  !> Components of an angular velocity that a mirror across an axis turns round, and which therefore
  !! vanish on a slip wall: all but that about its normal.
  pure function turns_across(axis) result(yes)
    integer, intent(in) :: axis
    logical :: yes(NSPIN)
    yes = .true.
    if (NDIM == 3) yes(axis) = .false.
  end function turns_across

  !> Inverse of the tensor of a node of mass m, with nothing in the components that are held. A node
  !! whose tensor has no inverse is left as it is: an inverse of zero.
  pure function inverse_tensor(tensor, m, held) result(inverse)
    real(dp), intent(in) :: tensor(NSPIN, NSPIN), m
    logical, intent(in) :: held(NSPIN)
    real(dp) :: inverse(NSPIN, NSPIN)
    real(dp) :: t(NSPIN, NSPIN), determinant
    integer :: a, b
#if NDIM == 3
    integer, parameter :: next(5) = [1, 2, 3, 1, 2]
#endif
    t = tensor
    do a = 1, NSPIN
      if (.not. held(a)) cycle
      t(a, :) = 0.0_dp
      t(:, a) = 0.0_dp
      t(a, a) = m
    end do
#if NDIM == 2
    inverse = 1.0_dp
    determinant = t(1, 1)
#else
    do b = 1, 3
      do a = 1, 3
        inverse(a, b) = t(next(b + 1), next(a + 1))*t(next(b + 2), next(a + 2)) &
                        - t(next(b + 1), next(a + 2))*t(next(b + 2), next(a + 1))
      end do
    end do
    determinant = sum(t(1, :)*inverse(:, 1))
#endif
    if (determinant > least_determinant*m**NSPIN) then
      inverse = inverse/determinant
    else
      inverse = 0.0_dp
    end if
    do b = 1, NSPIN
      do a = 1, NSPIN
        if (held(a) .or. held(b)) inverse(a, b) = 0.0_dp
      end do
    end do
  end function inverse_tensor

  !> Moments t_I = A_I^-T (D_I x f_I) of a run of nodes, f the internal force.
  pure subroutine rotation_moments(field, s, first, n, f)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n           !! interval, first node, nodes
    real(dp), intent(in) :: f(:, :)              !! (n or more, ndim)
    real(dp) :: moment(NSPIN)
    integer :: i, at
    at = field%neighbour(0, 0, s) + first - 1
    associate (rotation => field%rotation)
      do i = 1, n
        moment = cross(rotation%offset(at + i, :), f(i, :))
        rotation%moment(at + i, :) = matmul(moment, reshape(rotation%inverse(at + i, :), &
                                                            [NSPIN, NSPIN]))
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
    integer :: b(NROW), i, j, from, at
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
#if NDIM == 2
        call add_differences(j, -slope, 2, t(1, 1), b, f(from:i - 1, 1))
        call add_differences(j, slope, 1, t(1, 1), b, f(from:i - 1, 2))
#else
        call add_differences(j, slope, 3, t(1, 2), b, f(from:i - 1, 1))
        call add_differences(j, -slope, 2, t(1, 3), b, f(from:i - 1, 1))
        call add_differences(j, slope, 1, t(1, 3), b, f(from:i - 1, 2))
        call add_differences(j, -slope, 3, t(1, 1), b, f(from:i - 1, 2))
        call add_differences(j, slope, 2, t(1, 1), b, f(from:i - 1, 3))
        call add_differences(j, -slope, 1, t(1, 2), b, f(from:i - 1, 3))
#endif
      end associate
    end do
  end subroutine rotation_force

  !> Mass times the curl of the velocities that start at the given node columns, at the centres of
  !! one plane.
  pure subroutine rotation_curls(field, plane, columns)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane, columns(:)
    real(dp) :: curl(tile)
    integer :: s, first, last, n, v, q, a, c, b(NROW), at
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_centre, first, last)
        if (last < first) exit
        n = last - first + 1
        b = node_rows(field, s, first)
        at = field%neighbour(0, 0, s) + first
        do v = 1, size(columns)
          do q = 1, NSPIN
            a = merge(1, mod(q, 3) + 1, NDIM == 2)
            c = merge(2, mod(q + 1, 3) + 1, NDIM == 2)
            curl(:n) = 0.0_dp
            call add_differences(n, slope, a, field%node(1, columns(v) + c - 1), b, curl)
            call add_differences(n, -slope, c, field%node(1, columns(v) + a - 1), b, curl)
            field%rotation%centre(at:at + n - 1, (v - 1)*NSPIN + q) = &
              field%moment(at:at + n - 1, field%columns%mass)*curl(:n)
          end do
        end do
      end do
    end do
  end subroutine rotation_curls

  !> Takes those velocities to the places of the nodes of one plane, v = v - w x D.
  pure subroutine rotation_place(field, plane, columns)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane, columns(:)
    real(dp) :: sums(tile, NSPIN), w(NSPIN)
    integer :: s, first, last, n, v, q, i, at, b(NROW)
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      last = field%work%first(s) - 1
      do
        call next_run(field, s, at_node, first, last)
        if (last < first) exit
        n = last - first + 1
        b = centre_rows(field, s, first)
        at = field%neighbour(0, 0, s) + first - 1
        do v = 1, size(columns)
          do q = 1, NSPIN
            call sums_row(n, field%rotation%centre(1, (v - 1)*NSPIN + q), b, sums(1, q))
          end do
          associate (rotation => field%rotation, c => columns(v))
            do i = 1, n
              w = matmul(reshape(rotation%inverse(at + i, :), [NSPIN, NSPIN]), sums(i, :))
              field%node(at + i, c:c + NDIM - 1) = field%node(at + i, c:c + NDIM - 1) &
                                                   - turned(w, rotation%offset(at + i, :))
            end do
          end associate
        end do
      end do
    end do
  end subroutine rotation_place

#if NDIM == 2
  !> Component across the plane of a x b.
  pure function cross(a, b) result(c)
    real(dp), intent(in) :: a(2), b(2)
    real(dp) :: c(1)
    c = a(1)*b(2) - a(2)*b(1)
  end function cross
#endif

  !> w x d.
  pure function turned(w, d) result(v)
    real(dp), intent(in) :: w(NSPIN), d(NDIM)
    real(dp) :: v(NDIM)
#if NDIM == 2
    v = w(1)*[-d(2), d(1)]
#else
    v = cross(w, d)
#endif
  end function turned

  !> Marks the points of one plane around which others are marked, and clears what centres hold that
  !! are marked no longer.
  pure subroutine mark(field, plane, by, as)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: plane
    integer, intent(in) :: by, as                !! columns of the marks, at_*
    integer :: s, i, r, b(NROW), at
    logical :: part
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      if (as == at_centre) then
        b = node_rows(field, s, 0)
      else
        b = centre_rows(field, s, 0)
      end if
      do i = field%work%first(s), field%work%last(s)
        part = .false.
        do r = 1, NROW
          part = part .or. field%rotation%at(b(r) + i, by) .or. field%rotation%at(b(r) + i + 1, by)
        end do
        at = field%neighbour(0, 0, s) + i
        if (as == at_centre .and. field%rotation%at(at, as) .and. .not. part) then
          field%rotation%centre(at, :) = 0.0_dp
        end if
        field%rotation%at(at, as) = part
      end do
    end do
  end subroutine mark

  !> The next points of a row that are marked, at most a tile of them; last < first: no more.
  pure subroutine next_run(field, s, as, first, last)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, as                 !! interval; column of the marks
    integer, intent(out) :: first
    integer, intent(inout) :: last               !! of the run before
    integer :: at
    at = field%neighbour(0, 0, s)
    first = last + 1
    do while (first <= field%work%last(s))
      if (field%rotation%at(at + first, as)) exit
      first = first + 1
    end do
    last = first - 1
    do while (last < min(field%work%last(s), first + tile - 1))
      if (.not. field%rotation%at(at + last + 1, as)) exit
      last = last + 1
    end do
  end subroutine next_run

  !> Sums of the 2^d points around those of a row.
  pure subroutine sums_row(n, column, b, total)
    integer, intent(in) :: n, b(NROW)
    real(dp), intent(in) :: column(*)
    real(dp), intent(inout) :: total(n)
    integer :: i
    !$omp simd
    do i = 1, n
      total(i) = corner_sum(column, b, i - 1) + corner_sum(column, b, i)
    end do
  end subroutine sums_row

  !> Adds a factor times the differences, upper minus lower along an axis, of the points around
  !! those of a row.
  pure subroutine add_differences(n, factor, axis, column, b, total)
    integer, intent(in) :: n, axis, b(NROW)
    real(dp), intent(in) :: factor, column(*)
    real(dp), intent(inout) :: total(n)
    integer :: i
    select case (axis)
    case (1)
      !$omp simd
      do i = 1, n
        total(i) = total(i) + factor*(corner_sum(column, b, i) - corner_sum(column, b, i - 1))
      end do
    case (2)
      !$omp simd
      do i = 1, n
        total(i) = total(i) + factor*(corner_slope_2(column, b, i - 1) + &
                                      corner_slope_2(column, b, i))
      end do
#if NDIM == 3
    case (3)
      !$omp simd
      do i = 1, n
        total(i) = total(i) + factor*(corner_slope_3(column, b, i - 1) + &
                                      corner_slope_3(column, b, i))
      end do
#endif
    case default  ! the axes are complete
    end select
  end subroutine add_differences

  !> Records of node `first` in the rows of nodes around a row of centres.
  pure function node_rows(field, s, first) result(b)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first
    integer :: b(NROW)
    integer :: r
    do r = 1, NROW
      b(r) = field%neighbour((r - 1)/2, mod(r - 1, 2), s) + first
    end do
  end function node_rows

  !> Records of the centre left of node `first` in the rows of centres around a row of nodes.
  pure function centre_rows(field, s, first) result(b)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first
    integer :: b(NROW)
    integer :: r
    do r = 1, NROW
      b(r) = field%neighbour((r - 1)/2 - NDIM + 2, mod(r - 1, 2) - 1, s) + first - 1
    end do
  end function centre_rows

#include "corner_sums.inc"

end module DIM(sgmp_rotation)
#endif
