! dimension-generic, axisymmetric
#include "dimension.inc"
#if NDIM > 1
#if NDIM == 2
#define ROWS 3
#define MIDDLE 2
#else
#define ROWS 9
#define MIDDLE 5
#endif
!> Strains that are right at surfaces which lie askew to the grid (doc/surfaces.md).
!!
!! The gradient that particles read is along one axis the slope of a quadratic B-spline, and across
!! it the wider weight with which they move: together no gradient of anything. Where a surface cuts
!! cells at an angle a uniform stress then pushes nodes about. What is missing of the B-spline is
!! added at the centres: every two neighbours of them, a pair e = (c, c + b) along an axis b, have
!! the weight (PR1)
!!     k_e = m_e/(2 (V_c + V_(c+b))),   m_e = sum over particles of V N_perp x (1 - x),
!! x the place between the two, and the derivative along another axis a gets at both of them (PR2)
!!     k_e h (H_ab,c - H_ab,(c+b)),     H_ab the second difference of the velocity along a and b.
!! In space four centres of a face, a quad, have k_q = m_q/(4 sum of V) and give to the derivative
!! across the face their alternating sum of the third difference (PR3). The forces are the exact
!! transpose (PR4), so that all identities of energy and momentum stay; constant and linear
!! velocities are read as before.
!!
!! About an axis the hoop strain gets at both centres of a pair along z (PR5)
!!     k_e h (D_c - D_(c+z)),     D the slope along z of what the hoop strain reads;
!! along r its own correction (sgmp_axis) stands for this, and next to the axis both would be wrong.
!!
!! Where cells are unequal (sgmp_graded_axis) differences are over the distances of the nodes, and a
!! pair's weight has the spacing of its centres as a factor: that is what the B-spline of unequal
!! cells has between two centres beyond what is linear.
module DIM(sgmp_surfaces)
  use DIM(sgmp_auxmesh), only: graded_row, node_rows
  use sgmp_columns, only: pair_sums
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_spacing
  use CARTESIAN(sgmp_graded_rows), only: graded_push, graded_twist_factors, graded_twists
#ifdef AXISYMMETRIC
  use CARTESIAN(sgmp_graded_rows), only: graded_push_slopes, graded_slopes_across
#endif
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_pair_points, only: stage_forces, stage_gains, stage_twists, &
                              stage_weights
  use sgmp_rows, only: key_j, key_k
  use CARTESIAN(sgmp_scatter), only: pair_spans
  use sgmp_voigt, only: flux_between
  implicit none
  private
  public :: surfaces_add_gains, surfaces_pass, surfaces_push, surfaces_push_twists

  integer, parameter :: flux_of(NDIM, NDIM) = flux_between(:NDIM, :NDIM, NDIM)
  real(dp), parameter :: half = 0.5_dp**(NDIM - 2)  !! mean along the third axis
  integer, parameter :: tile = 128                  !! points of a row that are handled at a time
  !> About an axis, the column of the slope of the radial velocity along z.
  integer, parameter :: slope = NDIM + 1

contains

  !> One stage of one plane.
  pure subroutine surfaces_pass(field, mesh, plane, stage, column)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    integer, intent(in) :: stage                 !! one of stage_*
    integer, intent(in) :: column                !! first node column of the velocity (twists)
    integer :: s, first, n
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        if (bare(ROWS, n, rows_around(field, s, first), field%moment(1, firm(field)))) then
          call clear_row(field%neighbour(0, 0, s) + first, n, stage, field)
          cycle
        end if
        select case (stage)
        case (stage_weights)
          call weigh_row(field, s, first, n)
          if (mesh%graded) call grade_weights(field, mesh, s, first, n)
        case (stage_twists)
          if (mesh%graded) then
            call twist_graded(field, mesh, s, first, n, column)
          else
            call twist_row(field, s, first, n, column)
          end if
        case (stage_gains)
          call gain_row(field, mesh%inverse_h, s, first, n)
        case default  ! stage_forces
          call force_row(field, mesh%inverse_h, s, first, n)
          if (mesh%graded) call grade_forces(field, mesh, s, first, n)
        end select
      end do
      if (stage == stage_weights) call part_at_walls(field, mesh, s)
    end do
  end subroutine surfaces_pass

  !> The column that says where a body is: that of what has not come apart, where something can.
  !! Only that has pairs, so that rows without it have neither gains nor forces.
  pure function firm(field) result(column)
    type(field_t), intent(in) :: field
    integer :: column
    column = field%columns%mass
    if (field%columns%room > 0) column = field%columns%room
  end function firm

  !> Whether no centre of some rows, or next to their ends, holds a volume. Pairs of the centres of
  !! a row, and across walls of their images, then have no weight.
  pure function bare(rows, n, r, volume) result(yes)
    integer, intent(in) :: rows, n, r(rows)      !! r: records of the first centres
    real(dp), intent(in) :: volume(*)
    logical :: yes
    integer :: q
    yes = .false.
    do q = 1, rows
      if (any(volume(r(q) - 1:r(q) + n) > 0.0_dp)) return
    end do
    yes = .true.
  end function bare

  !> What a stage leaves at the centres of a row around which there is no volume.
  pure subroutine clear_row(at, n, stage, field)
    integer, intent(in) :: at, n                 !! record of the first centre
    integer, intent(in) :: stage
    type(field_t), intent(inout) :: field
    select case (stage)
    case (stage_weights)
      field%pairs%weight(at:at + n - 1, :) = 0.0_dp
    case (stage_gains)
      field%pairs%gain(at:at + n - 1, :) = 0.0_dp
    case (stage_forces)
      field%pairs%centre(at:at + n - 1, :) = 0.0_dp
    case default  ! nobody asks for its second differences
    end select
  end subroutine clear_row

  !> Weights of the pairs and quads of a row (PR1).
  pure subroutine weigh_row(field, s, first, n)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n           !! interval, first centre, centres
    call weigh(n, rows_around(field, s, first), size(field%moment, 1), &
               field%moment(1, field%columns%mass), &
               field%moment(1, field%columns%pairs), field%pairs%weight)
  end subroutine weigh_row

  !> The same of some centres.
  pure subroutine weigh(n, r, points, v, m, k)
    integer, intent(in) :: n, r(ROWS), points    !! r: rows_around
    real(dp), intent(in) :: v(points), m(points, pair_sums(NDIM))  !! volumes, moments
    real(dp), intent(inout) :: k(points, pair_sums(NDIM))
    real(dp) :: t(0:tile - 1, pair_sums(NDIM))
    integer :: i, c, y
#if NDIM == 3
    integer :: z, yz
#endif
    !$omp simd private(c, y)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE - 1) + i
      t(i, 1) = 0.5_dp*m(c, 1)*inverse(v(c) + v(c - 1))
      t(i, 2) = 0.5_dp*m(c, 2)*inverse(v(c) + v(y))
    end do
#if NDIM == 3
    !$omp simd private(c, y, z, yz)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE - 1) + i
      z = r(MIDDLE - 3) + i
      yz = r(MIDDLE - 4) + i
      t(i, 3) = 0.5_dp*m(c, 3)*inverse(v(c) + v(z))
      t(i, 4) = 0.25_dp*m(c, 4)*inverse((v(c) + v(y)) + (v(z) + v(yz)))
      t(i, 5) = 0.25_dp*m(c, 5)*inverse((v(c) + v(c - 1)) + (v(z) + v(z - 1)))
      t(i, 6) = 0.25_dp*m(c, 6)*inverse((v(c) + v(c - 1)) + (v(y) + v(y - 1)))
    end do
#endif
    k(r(MIDDLE):r(MIDDLE) + n - 1, :) = t(:n - 1, :)
  end subroutine weigh

  !> Points of a row in whole vectors: what lies behind its end is read and worked out, but not
  !! kept. Rows are short, and the rest of one would take as long as all its vectors.
  pure function whole(n) result(points)
    integer, intent(in) :: n
    integer :: points
    points = lanes*((n + lanes - 1)/lanes)
  end function whole

  !> 1/volume; where there is none, no pair has a moment.
  elemental function inverse(volume) result(one_over)
    real(dp), intent(in) :: volume
    real(dp) :: one_over
    one_over = 1.0_dp/merge(volume, 1.0_dp, volume > 0.0_dp)
  end function inverse

  !> Across fixed walls there is no pair: what lies behind them is no mirrored body. Across others
  !! the mass of its image is not there, which would halve the weight.
  pure subroutine part_at_walls(field, mesh, s)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s
    real(dp) :: part
    integer :: axis, side, q, centre, row(3), at, n
    row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (NDIM == 2) row(2) = row(3)
    at = field%neighbour(0, 0, s)
    n = field%work%last(s)
    do axis = 1, NDIM
      do side = 1, 2
        if (mesh%wall(side, axis) == wall_free) cycle
        part = merge(0.0_dp, 0.5_dp, mesh%wall(side, axis) == wall_fixed)
        centre = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
        do q = 1, pair_sums(NDIM)
          if (.not. pair_spans(q, axis)) cycle
          if (axis == 1) then
            if (centre < field%work%first(s) .or. centre > n) cycle
            field%pairs%weight(at + centre, q) = part*field%pairs%weight(at + centre, q)
          else if (row(axis) == centre) then
            field%pairs%weight(at + field%work%first(s):at + n, q) = &
              part*field%pairs%weight(at + field%work%first(s):at + n, q)
          end if
        end do
      end do
    end do
  end subroutine part_at_walls

  !> Weights of a row, times the spacings of the centres that they join.
  pure subroutine grade_weights(field, mesh, s, first, n)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp) :: factor
    integer :: row(2), at, i, q, axis
    row = graded_row(field, s)
    at = field%neighbour(0, 0, s) + first - 1
    do q = 1, pair_sums(NDIM)
      factor = 1.0_dp
      do axis = 2, NDIM
        if (pair_spans(q, axis)) factor = factor*graded_spacing(mesh%axes(axis), row(axis - 1))
      end do
      field%pairs%weight(at + 1:at + n, q) = factor*field%pairs%weight(at + 1:at + n, q)
      if (.not. pair_spans(q, 1)) cycle
      do i = 1, n
        field%pairs%weight(at + i, q) = graded_spacing(mesh%axes(1), first + i - 1)* &
                                        field%pairs%weight(at + i, q)
      end do
    end do
  end subroutine grade_weights

  !> Second differences where cells are unequal.
  pure subroutine twist_graded(field, mesh, s, first, n, column)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n, column
    real(dp) :: t(tile, 1 + 3*(NDIM - 2))
    integer :: a, q, at
    at = field%neighbour(0, 0, s) + first
    do a = 1, NDIM
      call graded_twists(mesh, field%linear, graded_row(field, s), first, n, &
                         field%node(1, column + a - 1), node_rows(field, s, first), t)
      do q = 1, size(t, 2)
        field%pairs%centre(at:at + n - 1, a + NDIM*(q - 1)) = t(:n, q)
      end do
    end do
#ifdef AXISYMMETRIC
    call graded_slopes_across(mesh, field%linear, graded_row(field, s), first, n, &
                              field%hoop(first, 1), field%hoop(first, 2), field%node(1, column), &
                              node_rows(field, s, first), field%pairs%centre(at, slope))
#endif
  end subroutine twist_graded

  !> Forces on the differences of a row, times the factors that these have.
  pure subroutine grade_forces(field, mesh, s, first, n)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp) :: factors(tile, 1 + 3*(NDIM - 2))
    integer :: a, q, at
    call graded_twist_factors(mesh, field%linear, graded_row(field, s), first, n, factors)
    at = field%neighbour(0, 0, s) + first
    do q = 1, size(factors, 2)
      do a = 1, NDIM
        field%pairs%centre(at:at + n - 1, a + NDIM*(q - 1)) = &
          factors(:n, q)*field%pairs%centre(at:at + n - 1, a + NDIM*(q - 1))
      end do
    end do
  end subroutine grade_forces

  !> Second differences of a nodal velocity at the centres of a row, in space the third ones, too.
  pure subroutine twist_row(field, s, first, n, column)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, first, n, column
    integer :: a, at, b(NROW)
    at = field%neighbour(0, 0, s) + first
    b = node_rows(field, s, first)
    do a = 1, NDIM
      call twist(n, b, field%node(1, column + a - 1), size(field%pairs%centre, 1), &
                 field%pairs%centre(at, a))
    end do
#ifdef AXISYMMETRIC
    call slopes(n, b, field%hoop(first, 1), field%hoop(first, 2), field%node(1, column), &
                field%pairs%centre(at, slope))
#endif
  end subroutine twist_row

  !> The same of one component; the columns are NDIM apart.
  pure subroutine twist(n, b, v, points, centre)
    integer, intent(in) :: n, b(NROW), points
    real(dp), intent(in) :: v(*)
    real(dp), intent(inout) :: centre(points, NDIM, *)
    real(dp) :: t(tile, 1 + 3*(NDIM - 2))
    integer :: i
    !$omp simd
    do i = 1, whole(n)
      t(i, 1) = half*(corner_slope_2(v, b, i) - corner_slope_2(v, b, i - 1))
#if NDIM == 3
      t(i, 2) = half*(corner_slope_3(v, b, i) - corner_slope_3(v, b, i - 1))
      t(i, 3) = half*(corner_twist(v, b, i) + corner_twist(v, b, i - 1))
      t(i, 4) = corner_twist(v, b, i) - corner_twist(v, b, i - 1)
#endif
    end do
    centre(:n, 1, :size(t, 2)) = t(:n, :)
  end subroutine twist

#ifdef AXISYMMETRIC
  !> Slopes of the hoop strain along z, of the radial velocity (sgmp_axis).
  pure subroutine slopes(n, b, inner, outer, v, slope)
    integer, intent(in) :: n, b(NROW)
    real(dp), intent(in) :: inner(n), outer(n), v(*)
    real(dp), intent(inout) :: slope(n)
    integer :: i
    !$omp simd
    do i = 1, n
      slope(i) = 2.0_dp*(outer(i)*corner_slope_2(v, b, i) + inner(i)*corner_slope_2(v, b, i - 1))
    end do
  end subroutine slopes
#endif

  !> What pairs and quads add to the velocity gradient at the centres of a row (PR2, PR3).
  pure subroutine gain_row(field, inverse_h, s, first, n)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, first, n
    integer :: a
    do a = 1, NDIM
      call gain(n, rows_around(field, s, first), inverse_h, size(field%moment, 1), &
                field%pairs%weight, &
                field%pairs%centre(1, a), field%pairs%gain(1, NDIM*(a - 1) + 1))
    end do
#ifdef AXISYMMETRIC
    call gain_hoop(field, inverse_h, s, first, n)
#endif
  end subroutine gain_row

  !> The same of one component of the velocity at some centres.
  pure subroutine gain(n, r, scale, points, k, h, g)
    integer, intent(in) :: n, r(ROWS), points
    real(dp), intent(in) :: scale
    real(dp), intent(in) :: k(points, pair_sums(NDIM))
    real(dp), intent(in) :: h(points, NDIM, *)   !! differences xy, xz, yz, xyz of the component
    real(dp), intent(inout) :: g(points, NDIM)
    real(dp) :: t(0:tile - 1, NDIM)
    integer :: i, c, y, yb
#if NDIM == 3
    integer :: z, zb, yz, ybz, yzb, ybzb
    real(dp) :: x1, x2, x3
#endif
    !$omp simd private(c, y, yb)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE + 1) + i
      yb = r(MIDDLE - 1) + i
      t(i, 1) = (k(y, 2)*(h(c, 1, 1) - h(y, 1, 1)) + k(c, 2)*(h(yb, 1, 1) - h(c, 1, 1)))
      t(i, 2) = (k(c + 1, 1)*(h(c, 1, 1) - h(c + 1, 1, 1)) + &
                       k(c, 1)*(h(c - 1, 1, 1) - h(c, 1, 1)))
    end do
#if NDIM == 3
    !$omp simd private(c, y, yb, z, zb)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE + 1) + i
      yb = r(MIDDLE - 1) + i
      z = r(MIDDLE + 3) + i
      zb = r(MIDDLE - 3) + i
      t(i, 1) = t(i, 1) + (k(z, 3)*(h(c, 1, 2) - h(z, 1, 2)) + &
                                 k(c, 3)*(h(zb, 1, 2) - h(c, 1, 2)))
      t(i, 2) = t(i, 2) + (k(z, 3)*(h(c, 1, 3) - h(z, 1, 3)) + &
                                 k(c, 3)*(h(zb, 1, 3) - h(c, 1, 3)))
      t(i, 3) = ((k(c + 1, 1)*(h(c, 1, 2) - h(c + 1, 1, 2)) + &
                        k(c, 1)*(h(c - 1, 1, 2) - h(c, 1, 2))) + &
                       (k(y, 2)*(h(c, 1, 3) - h(y, 1, 3)) + &
                        k(c, 2)*(h(yb, 1, 3) - h(c, 1, 3))))
    end do
    !$omp simd private(c, y, yb, z, zb, yz, ybz, yzb, ybzb, x1, x2, x3)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE + 1) + i
      yb = r(MIDDLE - 1) + i
      z = r(MIDDLE + 3) + i
      zb = r(MIDDLE - 3) + i
      yz = r(MIDDLE + 4) + i
      ybz = r(MIDDLE + 2) + i
      yzb = r(MIDDLE - 2) + i
      ybzb = r(MIDDLE - 4) + i
      x1 = (k(yz, 4)*((h(c, 1, 4) - h(y, 1, 4)) - (h(z, 1, 4) - h(yz, 1, 4))) + &
            k(z, 4)*((h(yb, 1, 4) - h(c, 1, 4)) - (h(ybz, 1, 4) - h(z, 1, 4)))) + &
           (k(y, 4)*((h(zb, 1, 4) - h(yzb, 1, 4)) - (h(c, 1, 4) - h(y, 1, 4))) + &
            k(c, 4)*((h(ybzb, 1, 4) - h(zb, 1, 4)) - (h(yb, 1, 4) - h(c, 1, 4))))
      x2 = (k(z + 1, 5)*((h(c, 1, 4) - h(c + 1, 1, 4)) - (h(z, 1, 4) - h(z + 1, 1, 4))) + &
            k(z, 5)*((h(c - 1, 1, 4) - h(c, 1, 4)) - (h(z - 1, 1, 4) - h(z, 1, 4)))) + &
           (k(c + 1, 5)*((h(zb, 1, 4) - h(zb + 1, 1, 4)) - (h(c, 1, 4) - h(c + 1, 1, 4))) + &
            k(c, 5)*((h(zb - 1, 1, 4) - h(zb, 1, 4)) - (h(c - 1, 1, 4) - h(c, 1, 4))))
      x3 = (k(y + 1, 6)*((h(c, 1, 4) - h(c + 1, 1, 4)) - (h(y, 1, 4) - h(y + 1, 1, 4))) + &
            k(y, 6)*((h(c - 1, 1, 4) - h(c, 1, 4)) - (h(y - 1, 1, 4) - h(y, 1, 4)))) + &
           (k(c + 1, 6)*((h(yb, 1, 4) - h(yb + 1, 1, 4)) - (h(c, 1, 4) - h(c + 1, 1, 4))) + &
            k(c, 6)*((h(yb - 1, 1, 4) - h(yb, 1, 4)) - (h(c - 1, 1, 4) - h(c, 1, 4))))
      t(i, 1) = t(i, 1) + x1
      t(i, 2) = t(i, 2) + x2
      t(i, 3) = t(i, 3) + x3
    end do
#endif
    g(r(MIDDLE):r(MIDDLE) + n - 1, :) = scale*t(:n - 1, :)
  end subroutine gain

#ifdef AXISYMMETRIC
  !> The hoop strain (PR5).
  pure subroutine gain_hoop(field, inverse_h, s, first, n)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, first, n
    integer :: i, c, y, yb, r(ROWS)
    r = rows_around(field, s, first)
    associate (k => field%pairs%weight, d => field%pairs%centre)
      do i = 0, n - 1
        c = r(MIDDLE) + i
        y = r(MIDDLE + 1) + i
        yb = r(MIDDLE - 1) + i
        field%pairs%gain(c, NGRAD) = inverse_h* &
          (k(y, 2)*(d(c, slope) - d(y, slope)) + k(c, 2)*(d(yb, slope) - d(c, slope)))
      end do
    end associate
  end subroutine gain_hoop
#endif

  !> Forces on second and third differences at the centres of a row, of the stress times volume
  !! there (PR4).
  pure subroutine force_row(field, inverse_h, s, first, n)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, first, n
    integer :: a, before
    before = field%columns%force - 1
    do a = 1, NDIM
      call twist_force(n, rows_around(field, s, first), inverse_h, size(field%moment, 1), &
                       field%pairs%weight, field%moment(1, before + flux_of(a, 1)), &
                       field%moment(1, before + flux_of(a, 2)), &
#if NDIM == 3
                       field%moment(1, before + flux_of(a, 3)), &
#endif
                       field%pairs%centre(1, a))
    end do
#ifdef AXISYMMETRIC
    call force_hoop(field, inverse_h, s, first, n)
#endif
  end subroutine force_row

  !> The same of one component at some centres.
#if NDIM == 2
  pure subroutine twist_force(n, r, scale, points, k, sx, sy, f)
#else
  pure subroutine twist_force(n, r, scale, points, k, sx, sy, sz, f)
    real(dp), intent(in) :: sz(*)
#endif
    integer, intent(in) :: n, r(ROWS), points
    real(dp), intent(in) :: scale
    real(dp), intent(in) :: k(points, pair_sums(NDIM))
    real(dp), intent(in) :: sx(*), sy(*)         !! stresses of the component along the axes
    real(dp), intent(inout) :: f(points, NDIM, *)  !! on differences xy, xz, yz, xyz
    real(dp) :: t(0:tile - 1, 1 + 3*(NDIM - 2))
    integer :: i, c, y, yb
#if NDIM == 3
    integer :: z, zb, yz, ybz, yzb, ybzb
    real(dp) :: x1, x2, x3
#endif
    !$omp simd private(c, y, yb)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE + 1) + i
      yb = r(MIDDLE - 1) + i
      t(i, 1) = ((k(y, 2)*(sx(c) + sx(y)) - k(c, 2)*(sx(yb) + sx(c))) + &
                          (k(c + 1, 1)*(sy(c) + sy(c + 1)) - k(c, 1)*(sy(c - 1) + sy(c))))
    end do
#if NDIM == 3
    !$omp simd private(c, y, yb, z, zb)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE + 1) + i
      yb = r(MIDDLE - 1) + i
      z = r(MIDDLE + 3) + i
      zb = r(MIDDLE - 3) + i
      t(i, 2) = ((k(z, 3)*(sx(c) + sx(z)) - k(c, 3)*(sx(zb) + sx(c))) + &
                          (k(c + 1, 1)*(sz(c) + sz(c + 1)) - k(c, 1)*(sz(c - 1) + sz(c))))
      t(i, 3) = ((k(z, 3)*(sy(c) + sy(z)) - k(c, 3)*(sy(zb) + sy(c))) + &
                          (k(y, 2)*(sz(c) + sz(y)) - k(c, 2)*(sz(yb) + sz(c))))
    end do
    !$omp simd private(c, y, yb, z, zb, yz, ybz, yzb, ybzb, x1, x2, x3)
    do i = 0, whole(n) - 1
      c = r(MIDDLE) + i
      y = r(MIDDLE + 1) + i
      yb = r(MIDDLE - 1) + i
      z = r(MIDDLE + 3) + i
      zb = r(MIDDLE - 3) + i
      yz = r(MIDDLE + 4) + i
      ybz = r(MIDDLE + 2) + i
      yzb = r(MIDDLE - 2) + i
      ybzb = r(MIDDLE - 4) + i
      x1 = (k(yz, 4)*((sx(c) + sx(y)) + (sx(z) + sx(yz))) - &
            k(z, 4)*((sx(yb) + sx(c)) + (sx(ybz) + sx(z)))) - &
           (k(y, 4)*((sx(zb) + sx(yzb)) + (sx(c) + sx(y))) - &
            k(c, 4)*((sx(ybzb) + sx(zb)) + (sx(yb) + sx(c))))
      x2 = (k(z + 1, 5)*((sy(c) + sy(c + 1)) + (sy(z) + sy(z + 1))) - &
            k(z, 5)*((sy(c - 1) + sy(c)) + (sy(z - 1) + sy(z)))) - &
           (k(c + 1, 5)*((sy(zb) + sy(zb + 1)) + (sy(c) + sy(c + 1))) - &
            k(c, 5)*((sy(zb - 1) + sy(zb)) + (sy(c - 1) + sy(c))))
      x3 = (k(y + 1, 6)*((sz(c) + sz(c + 1)) + (sz(y) + sz(y + 1))) - &
            k(y, 6)*((sz(c - 1) + sz(c)) + (sz(y - 1) + sz(y)))) - &
           (k(c + 1, 6)*((sz(yb) + sz(yb + 1)) + (sz(c) + sz(c + 1))) - &
            k(c, 6)*((sz(yb - 1) + sz(yb)) + (sz(c - 1) + sz(c))))
      t(i, 4) = ((x1 + x2) + x3)
    end do
#endif
    f(r(MIDDLE):r(MIDDLE) + n - 1, 1, :size(t, 2)) = scale*t(:n - 1, :)
  end subroutine twist_force

#ifdef AXISYMMETRIC
  !> The forces of the hoop stress on the slopes of the radial velocity.
  pure subroutine force_hoop(field, inverse_h, s, first, n)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, first, n
    integer :: i, c, y, yb, r(ROWS)
    r = rows_around(field, s, first)
    associate (k => field%pairs%weight, stress => field%moment(:, field%columns%force - 1 + NFLUX))
      do i = 0, n - 1
        c = r(MIDDLE) + i
        y = r(MIDDLE + 1) + i
        yb = r(MIDDLE - 1) + i
        field%pairs%centre(c, slope) = inverse_h* &
          (k(y, 2)*(stress(c) + stress(y)) - k(c, 2)*(stress(yb) + stress(c)))
      end do
    end associate
  end subroutine force_hoop
#endif

  !> Adds to the internal forces of a tile of nodes what pairs and quads give (PR4).
  pure subroutine surfaces_push(field, mesh, s, first, b, n, f)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first              !! interval, first node
    integer, intent(in) :: b(NROW)               !! rows of centres around the nodes
    integer, intent(in) :: n
    real(dp), intent(inout) :: f(:, :)           !! (n in whole vectors or more, ndim)
    integer :: a
    if (bare(NROW, n, b + 1, field%moment(1, firm(field)))) return
    do a = 1, NDIM
      if (mesh%graded) then
        call graded_push(mesh, field%linear, graded_row(field, s), first, n, b, &
                         size(field%pairs%centre, 1), field%pairs%centre(1, a), f(:, a))
      else
        call push(n, b, size(field%pairs%centre, 1), field%pairs%centre(1, a), f(:, a))
      end if
    end do
#ifdef AXISYMMETRIC
    if (mesh%graded) then
      call graded_push_slopes(mesh, field%linear, graded_row(field, s), first, n, &
                              field%hoop(first - 1, 1), field%hoop(first - 1, 2), b, &
                              field%pairs%centre(:, slope), f(:, 1))
    else
      call push_slopes(n, field%hoop(first - 1, 1), field%hoop(first - 1, 2), b, &
                       field%pairs%centre(:, slope), f(:, 1))
    end if
#endif
  end subroutine surfaces_push

  !> Adds to external forces on a tile of nodes those that act on second and third differences.
  pure subroutine surfaces_push_twists(field, mesh, s, first, b, n, f)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first              !! interval, first node
    integer, intent(in) :: b(NROW)               !! rows of centres around the nodes
    integer, intent(in) :: n
    real(dp), intent(inout) :: f(:, :)           !! (n in whole vectors or more, ndim)
    integer :: a
    do a = 1, NDIM
      associate (column => field%columns%twist + a - 1)
        if (mesh%graded) then  ! the slopes' factors are in the column
          call graded_push(mesh, field%linear, graded_row(field, s), first, n, b, &
                           size(field%moment, 1), field%moment(1, column), f(:, a))
        else
          call push(n, b, size(field%moment, 1), field%moment(1, column), f(:, a))
        end if
      end associate
    end do
  end subroutine surfaces_push_twists

  !> The same of one component.
  pure subroutine push(n, b, points, centre, f)
    integer, intent(in) :: n, b(NROW), points
    real(dp), intent(in) :: centre(points, *)
    real(dp), intent(inout) :: f(*)              !! (n in whole vectors or more)
    integer :: i
    f(n + 1:whole(n)) = 0.0_dp
    !$omp simd
    do i = 1, whole(n)
      f(i) = f(i) - half*(corner_slope_2(centre, b, i) - corner_slope_2(centre, b, i - 1))
#if NDIM == 3
      f(i) = f(i) - half*((corner_slope_3(centre(1, 1 + NDIM), b, i) - &
                           corner_slope_3(centre(1, 1 + NDIM), b, i - 1)) + &
                          (corner_twist(centre(1, 1 + 2*NDIM), b, i) + &
                           corner_twist(centre(1, 1 + 2*NDIM), b, i - 1)))
      f(i) = f(i) + (corner_twist(centre(1, 1 + 3*NDIM), b, i) - &
                     corner_twist(centre(1, 1 + 3*NDIM), b, i - 1))
#endif
    end do
  end subroutine push

#ifdef AXISYMMETRIC
  !> The radial force of the hoop stress.
  pure subroutine push_slopes(n, inner, outer, b, axial, f)
    integer, intent(in) :: n, b(NROW)
    real(dp), intent(in) :: inner(0:n), outer(0:n)  !! weights at the centres around the nodes
    real(dp), intent(in) :: axial(*)
    real(dp), intent(inout) :: f(n)
    integer :: i
    !$omp simd
    do i = 1, n
      f(i) = f(i) + 2.0_dp*(inner(i)*corner_slope_2(axial, b, i) + &
                            outer(i - 1)*corner_slope_2(axial, b, i - 1))
    end do
  end subroutine push_slopes
#endif

  !> Adds the gains of one plane to the gradients in its records.
  pure subroutine surfaces_add_gains(field, plane, before, stride, records)
    type(field_t), intent(in) :: field
    integer, intent(in) :: plane                 !! plane of the field
    integer, intent(in) :: before                !! components of a record before the gradient
    integer, intent(in) :: stride                !! components of a record
    real(dp), intent(inout) :: records(stride, *)  !! (stride, points of the plane)
    integer :: s, i, q, from, to
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      from = field%neighbour(0, 0, s)
      to = from - field%plane_start(plane) + 1
      do i = field%work%first(s), field%work%last(s)
        do q = 1, NGRAD
          records(before + q, to + i) = records(before + q, to + i) + field%pairs%gain(from + i, q)
        end do
      end do
    end do
  end subroutine surfaces_add_gains

#if NDIM == 3
  !> Difference of the four rows around one of points, along their two axes.
  pure function corner_twist(column, b, i) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    real(dp) :: t
    t = (column(b(4) + i) - column(b(3) + i)) - (column(b(2) + i) - column(b(1) + i))
  end function corner_twist
#endif

  !> Records of a centre of a row in the rows around it, y first: its own is MIDDLE.
  pure function rows_around(field, s, first) result(r)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first
    integer :: r(ROWS)
    integer :: q
    do q = 1, ROWS
#if NDIM == 2
      r(q) = field%neighbour(0, q - 2, s) + first
#else
      r(q) = field%neighbour(mod(q - 1, 3) - 1, (q - 1)/3 - 1, s) + first
#endif
    end do
  end function rows_around

#include "corner_sums.inc"

end module DIM(sgmp_surfaces)
#endif
