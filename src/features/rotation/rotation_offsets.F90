! dimension-generic
#include "dimension.inc"
#if NDIM > 1
#if NDIM == 2
#define VECTOR 2
#define WIDTH 1
#else
#define VECTOR 4
#define WIDTH 4
#endif
!> Where the nodes' centres of mass are, and what takes the curl of the velocity around a node to
!! its angular velocity (doc/rotation.md): once per step, of the masses as they lie.
!!
!! With J_c = 1 + sum_I D_I (x) G_cI the curl of omega x X at a centre is (tr J - J) omega. Lengths
!! are in cells. Points far from surfaces, where the offsets D_I vanish, are passed over.
module DIM(sgmp_rotation_offsets)
  use DIM(sgmp_auxmesh), only: graded_row, node_rows
  use sgmp_driven_nodes, only: driven_nodes_hold
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_centre, graded_node, graded_spacing, graded_width
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_rotation_points, only: at_centre, at_force, at_node
  use DIM(sgmp_rotation_rows), only: add_differences, centre_rows, next_run, slope, &
                                     sums_row, tile
  use sgmp_rows, only: key_j, key_k
  use sgmp_space, only: space_axisymmetric
  implicit none
  private
  public :: rotation_offsets, rotation_inertia, rotation_inverses
  public :: angular_tensor, inverse_tensor

  !> A tensor with a smaller determinant, for a mass of 1, has no inverse that could be trusted: in
  !! the interior it is 2^d.
  real(dp), parameter :: least_determinant = 0.1_dp
  real(dp), parameter :: least_trace = 0.5_dp*(NDIM - 1)  !! half that of a body one cell thick

contains

  !> Offsets D_I = sum_c (M_c + m_c (x_c - x_I))/sum_c m_c of the nodes of one plane, M_c the first
  !! moment of the mass that particles gave to a centre: sum N m (x_p - x_c), along an axis the
  !! moment of the pair above the centre less that of the pair below it.
  pure subroutine rotation_offsets(field, mesh, plane, cutoff)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp), intent(in) :: cutoff               !! nodes lighter than this are ignored
    real(dp) :: offset(tile, NDIM)
    logical :: held(tile)
    integer :: s, first, n, i
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        call tile_offsets(field, mesh, s, first, n, cutoff, offset)
        call hold_offsets(field, mesh, s, first, n, offset)
        if (field%columns%driven > 0) then
          call driven_nodes_hold(field, s, first, n, held)
          do i = 1, n
            if (held(i)) offset(i, :) = 0.0_dp
          end do
        end if
        do i = 1, n  ! after walls: across those all nodes have an offset before they are held
          if (all(abs(offset(i, :)) < field%rotation%least_offset)) offset(i, :) = 0.0_dp
        end do
        call keep_offsets(n, field%neighbour(0, 0, s) + first - 1, offset, field)
      end do
    end do
  end subroutine rotation_offsets

  !> Those of a tile of nodes of a row.
  pure subroutine tile_offsets(field, mesh, s, first, n, cutoff, offset)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: cutoff
    real(dp), intent(inout) :: offset(tile, NDIM)
    real(dp) :: m(tile), radial(tile)
    logical :: rings
    integer :: i, a, b(NROW)
    rings = mesh%space == space_axisymmetric
    b = centre_rows(field, s, first)
    call sums_row(n, field%moment(1, field%columns%mass), b, m)
    do a = 1, NDIM
      if (mesh%graded) then
        call graded_moments(field, mesh, s, first, n, a, offset(1, a))
        cycle
      end if
      call pair_moments(field, s, first, n, a, offset(1, a))
      call add_differences(n, 0.5_dp, a, field%moment(1, field%columns%mass), b, offset(1, a))
    end do
    if (rings) call ring_offsets(field, mesh, s, first, n, radial)
    do i = 1, n
      if (m(i)*0.5_dp**NDIM > cutoff) then
        offset(i, :) = offset(i, :)/m(i)
        if (rings) offset(i, 1) = radial(i)
      else
        offset(i, :) = 0.0_dp
      end if
    end do
    if (field%columns%room > 0) then  ! what has come apart does not turn as a body
      call sums_row(n, field%moment(1, field%columns%room), b, m)
      do i = 1, n
        if (.not. m(i) > 0.0_dp) offset(i, :) = 0.0_dp
      end do
    end if
  end subroutine tile_offsets

  !> Offsets along the radius of a row of nodes about an axis (theory 7). Masses of rings grow with
  !! the radius, which by itself takes the centre of mass of full surroundings outwards. A ring
  !! turns in its half-plane about the centre of its section, so that masses are taken over their
  !! radii.
  !! Next to the axis and to an outer wall, where rings are folded, there are no offsets.
  pure subroutine ring_offsets(field, mesh, s, first, n, offset)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(out) :: offset(n)
    real(dp) :: inner, outer, next(-1:1), spacing(-1:1)
    integer :: i, c, last, b(NROW)
    b = centre_rows(field, s, first)
    last = merge(first + n, mesh%upper(1) - 2, mesh%wall(2, 1) == wall_free)
    offset = 0.0_dp
    associate (mass => field%moment(:, field%columns%mass), &
               pair => field%moment(:, field%columns%pairs))
      do i = max(1, 3 - first), min(n, last - first + 1)
        c = first + i - 1
        next = graded_node(mesh%axes(1), [c - 1, c, c + 1])
        spacing = graded_spacing(mesh%axes(1), [c - 1, c, c + 1])
        inner = corner_sum(mass, b, i - 1)/graded_centre(mesh%axes(1), c - 1)
        outer = corner_sum(mass, b, i)/graded_centre(mesh%axes(1), c)
        if (.not. inner + outer > 0.0_dp) cycle
        offset(i) = (0.5_dp*spacing(0)*(outer - inner) + &
                     spacing(1)*corner_sum(pair, b, i + 1)/next(1) - &
                     spacing(-1)*corner_sum(pair, b, i - 1)/next(-1))/(inner + outer)
      end do
    end associate
  end subroutine ring_offsets

  !> Sum of the first moments of the centres around the nodes of a row: the pair between the two
  !! centres along the axis cancels, and what is left are those beyond them.
  pure subroutine pair_moments(field, s, first, n, axis, total)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n, axis
    real(dp), intent(inout) :: total(*)          !! a tile
    integer :: above(NROW), below(NROW), r, dj, dk, i, at
    do r = 1, NROW
      dj = (r - 1)/2 - NDIM + 2
      dk = mod(r - 1, 2) - 1
      at = first - 1
      above(r) = at + field%neighbour(merge(1, dj, NDIM == 3 .and. axis == 2), &
                                      merge(1, dk, axis == NDIM), s)
      below(r) = at + field%neighbour(merge(-1, dj, NDIM == 3 .and. axis == 2), &
                                      merge(-1, dk, axis == NDIM), s)
    end do
    associate (pair => field%moment(:, field%columns%pairs + axis - 1))
      if (axis == 1) then
        !$omp simd
        do i = 1, lanes*((n + lanes - 1)/lanes)
          total(i) = corner_sum(pair, above, i + 1) - corner_sum(pair, below, i - 1)
        end do
      else
        ! Of the rows across the axis each is named twice.
        !$omp simd
        do i = 1, lanes*((n + lanes - 1)/lanes)
          total(i) = 0.5_dp*((corner_sum(pair, above, i) + corner_sum(pair, above, i - 1)) - &
                             (corner_sum(pair, below, i) + corner_sum(pair, below, i - 1)))
        end do
      end if
    end associate
  end subroutine pair_moments

  !> Sum of first moments of the centres around the nodes of a row, about the nodes, where cells are
  !! unequal: of pairs beyond the two centres, whose moments are in their spacings, and of centres
  !! half a spacing from the node.
  pure subroutine graded_moments(field, mesh, s, first, n, axis, total)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n, axis
    real(dp), intent(inout) :: total(*)          !! a tile
    real(dp) :: spacing(0:tile + 1), about(tile), upper, lower
    integer :: r, dj, dk, i, row(2), above, below, up(3)
    row = graded_row(field, s)
    up = merge(1, 0, [axis == 1, NDIM == 3 .and. axis == 2, axis == NDIM .and. axis > 1])
    about(:n) = 0.0_dp
    call add_differences(n, 0.5_dp, axis, field%moment(1, field%columns%mass), &
                         centre_rows(field, s, first), about)
    if (axis == 1) then
      spacing(:n + 1) = graded_spacing(mesh%axes(1), [(first + i - 1, i=0, n + 1)])
    else
      spacing(:n + 1) = graded_spacing(mesh%axes(axis), row(axis - 1))
      lower = graded_spacing(mesh%axes(axis), row(axis - 1) - 1)
      upper = graded_spacing(mesh%axes(axis), row(axis - 1) + 1)
    end if
    total(:n) = spacing(1:n)*about(:n)
    associate (pair => field%moment(:, field%columns%pairs + axis - 1))
      do r = 1, NROW
        dj = (r - 1)/2 - NDIM + 2
        dk = mod(r - 1, 2) - 1
        if (up(2) == 1 .and. dj < 0) cycle        ! rows along the axis: once
        if (up(3) == 1 .and. dk < 0) cycle
        above = first - 1 + field%neighbour(merge(1, dj, up(2) == 1), merge(1, dk, up(3) == 1), s)
        below = first - 1 + field%neighbour(merge(-1, dj, up(2) == 1), &
                                            merge(-1, dk, up(3) == 1), s)
        if (axis == 1) then
          do i = 1, n
            total(i) = total(i) + (spacing(i + 1)*pair(above + i + 1) - &
                                   spacing(i - 1)*pair(below + i - 1))
          end do
        else
          do i = 1, n
            total(i) = total(i) + (upper*(pair(above + i) + pair(above + i - 1)) - &
                                   lower*(pair(below + i) + pair(below + i - 1)))
          end do
        end if
      end do
    end associate
  end subroutine graded_moments

  !> Nodes on a slip wall have the offset of a body with its mirror image, those on a fixed wall do
  !! not move. (Nor do those that a part of a body moves, but as it says for their own places.)
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
        rotation%offset(:NDIM, before + i) = offset(i, :)
        rotation%at(before + i, at_node) = part
        if (.not. part) rotation%moment(:, before + i) = 0.0_dp
      end do
    end associate
  end subroutine keep_offsets

  !> Mass times tr J - J at the centres around those nodes.
  pure subroutine rotation_inertia(field, mesh, plane)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp) :: slopes(VECTOR, NDIM)
    integer :: s, i, a, at, b(NROW), row(2)
    call mark(field, plane, at_node, at_centre)
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      at = field%neighbour(0, 0, s)
      b = node_rows(field, s, 0)
      do i = field%work%first(s), field%work%last(s)
        if (.not. field%rotation%at(at + i, at_centre)) cycle
        slopes = slope*offset_differences(field%rotation%offset, b, i + 1)
        if (mesh%graded) then
          row = graded_row(field, s)
          slopes(:, 1) = slopes(:, 1)/graded_width(mesh%axes(1), i)
          do a = 2, NDIM
            slopes(:, a) = slopes(:, a)/graded_width(mesh%axes(a), row(a - 1))
          end do
        end if
        field%rotation%tensor(:WIDTH, :NSPIN, at + i) = &
          field%moment(at + i, field%columns%mass)*angular_tensor(slopes)
      end do
    end do
  end subroutine rotation_inertia

  !> The tensor that takes an angular velocity to the curl of the velocity that its rigid motion
  !! gives to centres of mass, tr J - J (in the plane tr J); from the derivatives of the offsets.
  !!
  !! In bodies thinner than a cell along two axes, of which the nodes' centres of mass are about the
  !! same, the trace is kept from vanishing.
  pure function angular_tensor(slopes) result(k)
    real(dp), intent(in) :: slopes(VECTOR, NDIM)   !! (a, b): component a along axis b
    real(dp) :: k(WIDTH, NSPIN)
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
    real(dp) :: sums(WIDTH*NSPIN), m(tile)
    integer :: i, at, rows(NROW), axis, side, r(2)
    logical :: held(NSPIN, tile)
    rows = centre_rows(field, s, first)
    call sums_row(n, field%moment(1, field%columns%mass), rows, m)
    held(:, :n) = .false.
    do axis = 1, NDIM
      do side = 1, 2
        r = on_wall(field, mesh, s, first, n, axis, side)
        do i = r(1), r(2)
          held(:, i) = held(:, i) .or. turns_across(axis)
        end do
      end do
    end do
    at = field%neighbour(0, 0, s) + first - 1
    do i = 1, n
      sums = tensors_around(field%rotation%tensor, field%rotation%at(1, at_centre), rows, i)
      field%rotation%inverse(:WIDTH, :NSPIN, at + i) = inverse_tensor(sums, m(i), held(:, i))
    end do
  end subroutine inverse_run

  !> Sum of the tensors of the centres around a node: those at the edge of the grid that have none
  !! hold nothing.
  pure function tensors_around(tensor, marked, b, i) result(sums)
    real(dp), intent(in) :: tensor(WIDTH*NSPIN, *)
    logical, intent(in) :: marked(*)
    integer, intent(in) :: b(NROW), i
    real(dp) :: sums(WIDTH*NSPIN)
    integer :: r, shift, q
    sums = 0.0_dp
    do shift = i - 1, i
      do r = 1, NROW
        if (.not. marked(b(r) + shift)) cycle
        !$omp simd
        do q = 1, WIDTH*NSPIN
          sums(q) = sums(q) + tensor(q, b(r) + shift)
        end do
      end do
    end do
  end function tensors_around

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
    real(dp), intent(in) :: tensor(WIDTH, NSPIN), m
    logical, intent(in) :: held(NSPIN)
    real(dp) :: inverse(WIDTH, NSPIN)
    real(dp) :: t(WIDTH, NSPIN), determinant
    integer :: a
#if NDIM == 3
    integer :: b
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
    inverse(4, :) = 0.0_dp
    do b = 1, 3
      do a = 1, 3
        inverse(a, b) = t(next(b + 1), next(a + 1))*t(next(b + 2), next(a + 2)) &
                        - t(next(b + 1), next(a + 2))*t(next(b + 2), next(a + 1))
      end do
    end do
    determinant = t(1, 1)*inverse(1, 1) + t(1, 2)*inverse(2, 1) + t(1, 3)*inverse(3, 1)
#endif
    if (determinant > least_determinant*m**NSPIN) then
      inverse = inverse*(1.0_dp/determinant)
    else
      inverse = 0.0_dp
    end if
    do a = 1, NSPIN
      if (.not. held(a)) cycle
      inverse(a, :) = 0.0_dp
      inverse(:, a) = 0.0_dp
    end do
  end function inverse_tensor

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
          field%rotation%couple(:, at) = 0.0_dp
          if (allocated(field%rotation%face_couple)) field%rotation%face_couple(:, at) = 0.0_dp
        end if
        field%rotation%at(at, as) = part
      end do
    end do
  end subroutine mark

#include "corner_sums.inc"

#define DIFFERENCES offset_differences
#include "vectors_differences.inc"

end module DIM(sgmp_rotation_offsets)
#endif
