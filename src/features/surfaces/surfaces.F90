! dimension-generic, axisymmetric
#include "dimension.inc"
#if NDIM > 1
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
!! About an axis the hoop strain gets at both centres of a pair, each with its own radius, (PR5)
!!     k_e h (D_b,c - D_b,(c+b))/r,     D_b the slope of the radial velocity along b.
module DIM(sgmp_surfaces)
#ifdef AXISYMMETRIC
  use sgmp_axis, only: axis_radius
#endif
  use DIM(sgmp_auxmesh), only: node_rows
  use sgmp_columns, only: pair_sums
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed
  use sgmp_pair_points, only: pair_twist, stage_gains, stage_twists, stage_weights
  use sgmp_rows, only: key_j, key_k
  use CARTESIAN(sgmp_scatter), only: pair_spans
  use sgmp_voigt, only: flux_between
  implicit none
  private
  public :: surfaces_add_gains, surfaces_pass, surfaces_push

  integer, parameter :: flux_of(NDIM, NDIM) = flux_between(:NDIM, :NDIM, NDIM)
  integer, parameter :: pair_corners = 2**(NDIM - 1)  !! most centres of a pair or quad
  real(dp), parameter :: half = 0.5_dp**(NDIM - 2)  !! mean along the third axis
  !> Columns before those of the third difference; about an axis, before the slopes.
  integer, parameter :: before_third = 3*NDIM, before_slope = NDIM

contains

  !> One stage of one plane.
  pure subroutine surfaces_pass(field, mesh, plane, stage, column)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    integer, intent(in) :: stage                 !! one of stage_*
    integer, intent(in) :: column                !! first node column of the velocity (twists)
    integer :: s
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      select case (stage)
      case (stage_weights)
        call weigh_row(field, s)
        call part_at_walls(field, mesh, s)
      case (stage_twists)
        call twist_row(field, s, column)
      case (stage_gains)
        call gain_row(field, mesh%inverse_h, s)
      case default  ! stage_forces
        call force_row(field, mesh%inverse_h, s)
      end select
    end do
  end subroutine surfaces_pass

  !> Weights of the pairs and quads of a row (PR1).
  pure subroutine weigh_row(field, s)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s
    real(dp) :: volume(field%work%last(s) - field%work%first(s) + 1)
    real(dp) :: part
    integer :: q, i, at, to(pair_corners)
    at = first_record(field, s)
    do q = 1, pair_sums(NDIM)
      to = corners(field, s, q)
      volume = 0.0_dp
      do i = 1, merge(2, 4, q <= NDIM)
        volume = volume + field%moment(to(i):to(i) + size(volume) - 1, field%columns%room)
      end do
      part = merge(0.5_dp, 0.25_dp, q <= NDIM)
      associate (m => field%moment(:, field%columns%pairs + q - 1), k => field%pairs%weight(:, q))
        !$omp simd
        do i = 1, size(volume)
          k(at + i - 1) = part*m(at + i - 1)/merge(volume(i), 1.0_dp, volume(i) > 0.0_dp)
        end do
      end associate
    end do
  end subroutine weigh_row

  !> Records of the centres of the pair, or quad, that begins at the first centre of a row: the
  !! lowest first, then along one axis after the other.
  pure function corners(field, s, pair) result(to)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, pair
    integer :: to(pair_corners)
    integer :: a, n
    integer :: way(3, pair_corners)
    way = 0
    n = 1
    do a = 1, NDIM
      if (.not. pair_spans(pair, a)) cycle
      way(:, n + 1:2*n) = way(:, :n) + spread(step_along(a), 2, n)
      n = 2*n
    end do
    do a = 1, pair_corners
      to(a) = record_at(field, s, way(:, a))
    end do
  end function corners

  !> Across fixed walls there is no pair: what lies behind them is no mirrored body.
  pure subroutine part_at_walls(field, mesh, s)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s
    integer :: axis, side, q, centre, row(3), at, n
    row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (NDIM == 2) row(2) = row(3)
    at = field%neighbour(0, 0, s)
    n = field%work%last(s)
    do axis = 1, NDIM
      do side = 1, 2
        if (mesh%wall(side, axis) /= wall_fixed) cycle
        centre = merge(mesh%lower(axis), mesh%upper(axis), side == 1) - 1
        do q = 1, pair_sums(NDIM)
          if (.not. pair_spans(q, axis)) cycle
          if (axis == 1) then
            if (centre < field%work%first(s) .or. centre > n) cycle
            field%pairs%weight(at + centre, q) = 0.0_dp
          else if (row(axis) == centre) then
            field%pairs%weight(at + field%work%first(s):at + n, q) = 0.0_dp
          end if
        end do
      end do
    end do
  end subroutine part_at_walls

  !> Second differences of a nodal velocity at the centres of a row, in space the third ones, too.
  pure subroutine twist_row(field, s, column)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: s, column
    integer :: a, n, at, b(NROW)
    n = field%work%last(s) - field%work%first(s) + 1
    at = first_record(field, s)
    b = node_rows(field, s, field%work%first(s))
    do a = 1, NDIM
      call twist(n, b, field%node(1, column + a - 1), size(field%pairs%centre, 1), &
                 field%pairs%centre(at, a))
    end do
#ifdef AXISYMMETRIC
    call slopes(n, b, field%node(1, column), size(field%pairs%centre, 1), &
                field%pairs%centre(at, before_slope + 1))
#endif
  end subroutine twist_row

  !> The same of one component; the columns are NDIM apart.
  pure subroutine twist(n, b, v, points, centre)
    integer, intent(in) :: n, b(NROW), points
    real(dp), intent(in) :: v(*)
    real(dp), intent(inout) :: centre(points, *)
    integer :: i
    !$omp simd
    do i = 1, n
      centre(i, 1) = half*(corner_slope_2(v, b, i) - corner_slope_2(v, b, i - 1))
#if NDIM == 3
      centre(i, 1 + NDIM) = half*(corner_slope_3(v, b, i) - corner_slope_3(v, b, i - 1))
      centre(i, 1 + 2*NDIM) = half*(corner_twist(v, b, i) + corner_twist(v, b, i - 1))
      centre(i, 1 + before_third) = corner_twist(v, b, i) - corner_twist(v, b, i - 1)
#endif
    end do
  end subroutine twist

#ifdef AXISYMMETRIC
  !> Slopes of the radial velocity along both axes.
  pure subroutine slopes(n, b, v, points, slope)
    integer, intent(in) :: n, b(NROW), points
    real(dp), intent(in) :: v(*)
    real(dp), intent(inout) :: slope(points, 2)
    integer :: i
    !$omp simd
    do i = 1, n
      slope(i, 1) = 0.5_dp*(corner_sum(v, b, i) - corner_sum(v, b, i - 1))
      slope(i, 2) = 0.5_dp*(corner_slope_2(v, b, i) + corner_slope_2(v, b, i - 1))
    end do
  end subroutine slopes
#endif

  !> What pairs and quads add to the velocity gradient at the centres of a row (PR2, PR3).
  pure subroutine gain_row(field, inverse_h, s)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s
    real(dp) :: gain(field%work%last(s) - field%work%first(s) + 1)
    integer :: i, a, b, n, at, way
    n = size(gain)
    at = first_record(field, s)
    do i = 1, NDIM
      do a = 1, NDIM
        gain = 0.0_dp
        do b = 1, NDIM
          if (b == a) cycle
          way = record_at(field, s, step_along(b))
          call add_pair_gain(n, at, way, record_at(field, s, -step_along(b)), &
                             field%pairs%weight(1, b), &
                             field%pairs%centre(1, i + NDIM*(pair_twist(a, b) - 1)), gain)
        end do
#if NDIM == 3
        call add_quad_gain(n, quads_around(field, s, a), field%pairs%weight(1, NDIM + a), &
                           field%pairs%centre(1, before_third + i), gain)
#endif
        field%pairs%gain(at:at + n - 1, NDIM*(i - 1) + a) = inverse_h*gain
      end do
    end do
#ifdef AXISYMMETRIC
    call gain_hoop(field, inverse_h, s, n, at)
#endif
  end subroutine gain_row

  !> Adds what the two pairs of each centre along an axis give.
  pure subroutine add_pair_gain(n, at, up, down, k, h, gain)
    integer, intent(in) :: n, at, up, down       !! records of the first centre and its neighbours
    real(dp), intent(in) :: k(*), h(*)           !! weights; second differences
    real(dp), intent(inout) :: gain(n)
    integer :: i
    !$omp simd
    do i = 0, n - 1
      gain(i + 1) = gain(i + 1) + (k(at + i)*(h(at + i) - h(up + i)) + &
                                   k(down + i)*(h(down + i) - h(at + i)))
    end do
  end subroutine add_pair_gain

#ifdef AXISYMMETRIC
  !> The hoop strain (PR5); next to the axis radii are those of no particle, and the pair of the
  !! first two centres along r is left out.
  pure subroutine gain_hoop(field, inverse_h, s, n, at)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, n, at
    real(dp) :: gain(n)
    integer :: i, b
    gain = 0.0_dp
    do b = 1, NDIM
      associate (k => field%pairs%weight(:, b), d => field%pairs%centre(:, before_slope + b), &
                 up => record_at(field, s, step_along(b)), &
                 down => record_at(field, s, -step_along(b)), first => field%work%first(s))
        do i = 0, n - 1
          gain(i + 1) = gain(i + 1) + (counted(b, first + i, k(at + i))*(d(at + i) - d(up + i)) + &
                                       counted(b, first + i - step(b), k(down + i))* &
                                       (d(down + i) - d(at + i)))
        end do
      end associate
    end do
    do i = 0, n - 1
      field%pairs%gain(at + i, NGRAD) = inverse_h*gain(i + 1)/axis_radius(field%work%first(s) + i)
    end do
  end subroutine gain_hoop

  !> The weight of a pair that begins at a centre along x, for the hoop strain.
  pure function counted(axis, centre, weight) result(k)
    integer, intent(in) :: axis, centre
    real(dp), intent(in) :: weight
    real(dp) :: k
    k = merge(0.0_dp, weight, axis == 1 .and. centre < 1)
  end function counted

  !> How far a step along an axis goes along x.
  pure function step(axis) result(cells)
    integer, intent(in) :: axis
    integer :: cells
    cells = merge(1, 0, axis == 1)
  end function step
#endif

  !> Forces on second and third differences at the centres of a row, of the stress times volume
  !! there (PR4).
  pure subroutine force_row(field, inverse_h, s)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s
    real(dp) :: force(field%work%last(s) - field%work%first(s) + 1)
    integer :: i, a, b, n, at, before
    n = size(force)
    at = first_record(field, s)
    before = field%columns%force - 1
    do i = 1, NDIM
      do b = 2, NDIM
        do a = 1, b - 1
          force = 0.0_dp
          call add_pair_force(n, at, record_at(field, s, step_along(b)), &
                              record_at(field, s, -step_along(b)), field%pairs%weight(1, b), &
                              field%moment(1, before + flux_of(i, a)), force)
          call add_pair_force(n, at, record_at(field, s, step_along(a)), &
                              record_at(field, s, -step_along(a)), field%pairs%weight(1, a), &
                              field%moment(1, before + flux_of(i, b)), force)
          field%pairs%centre(at:at + n - 1, i + NDIM*(pair_twist(a, b) - 1)) = inverse_h*force
        end do
      end do
#if NDIM == 3
      force = 0.0_dp
      do a = 1, NDIM
        call add_quad_force(n, quads_around(field, s, a), field%pairs%weight(1, NDIM + a), &
                            field%moment(1, before + flux_of(i, a)), force)
      end do
      field%pairs%centre(at:at + n - 1, before_third + i) = inverse_h*force
#endif
    end do
#ifdef AXISYMMETRIC
    call force_hoop(field, inverse_h, s, n, at)
#endif
  end subroutine force_row

  !> Adds the forces of the two pairs of each centre along an axis.
  pure subroutine add_pair_force(n, at, up, down, k, stress, force)
    integer, intent(in) :: n, at, up, down       !! as for add_pair_gain
    real(dp), intent(in) :: k(*), stress(*)
    real(dp), intent(inout) :: force(n)
    integer :: i
    !$omp simd
    do i = 0, n - 1
      force(i + 1) = force(i + 1) + (k(at + i)*(stress(at + i) + stress(up + i)) - &
                                     k(down + i)*(stress(down + i) + stress(at + i)))
    end do
  end subroutine add_pair_force

#ifdef AXISYMMETRIC
  !> The forces of the hoop stress on the slopes of the radial velocity.
  pure subroutine force_hoop(field, inverse_h, s, n, at)
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, n, at
    integer :: i, b
    real(dp) :: above, below
    do b = 1, NDIM
      associate (k => field%pairs%weight(:, b), d => step(b), &
                 stress => field%moment(:, field%columns%force - 1 + NFLUX), &
                 up => record_at(field, s, step_along(b)), &
                 down => record_at(field, s, -step_along(b)), first => field%work%first(s))
        do i = 0, n - 1
          above = stress(at + i)/axis_radius(first + i) + stress(up + i)/axis_radius(first + i + d)
          below = stress(down + i)/axis_radius(first + i - d) + stress(at + i)/axis_radius(first + i)
          field%pairs%centre(at + i, before_slope + b) = inverse_h* &
            (counted(b, first + i, k(at + i))*above - counted(b, first + i - d, k(down + i))*below)
        end do
      end associate
    end do
  end subroutine force_hoop
#endif

  !> Adds to the internal forces of a tile of nodes what pairs and quads give (PR4).
  pure subroutine surfaces_push(field, b, n, f)
    type(field_t), intent(in) :: field
    integer, intent(in) :: b(NROW)               !! rows of centres around the nodes
    integer, intent(in) :: n
    real(dp), intent(inout) :: f(:, :)           !! (n or more, ndim)
    integer :: a
    do a = 1, NDIM
      call push(n, b, size(field%pairs%centre, 1), field%pairs%centre(1, a), f(:, a))
    end do
#ifdef AXISYMMETRIC
    call push_slopes(n, b, field%pairs%centre(:, before_slope + 1), &
                     field%pairs%centre(:, before_slope + 2), f(:, 1))
#endif
  end subroutine surfaces_push

  !> The same of one component.
  pure subroutine push(n, b, points, centre, f)
    integer, intent(in) :: n, b(NROW), points
    real(dp), intent(in) :: centre(points, *)
    real(dp), intent(inout) :: f(n)
    integer :: i
    !$omp simd
    do i = 1, n
      f(i) = f(i) - half*(corner_slope_2(centre, b, i) - corner_slope_2(centre, b, i - 1))
#if NDIM == 3
      f(i) = f(i) - half*((corner_slope_3(centre(1, 1 + NDIM), b, i) - &
                           corner_slope_3(centre(1, 1 + NDIM), b, i - 1)) + &
                          (corner_twist(centre(1, 1 + 2*NDIM), b, i) + &
                           corner_twist(centre(1, 1 + 2*NDIM), b, i - 1)))
      f(i) = f(i) + (corner_twist(centre(1, 1 + before_third), b, i) - &
                     corner_twist(centre(1, 1 + before_third), b, i - 1))
#endif
    end do
  end subroutine push

#ifdef AXISYMMETRIC
  !> The radial force of the hoop stress.
  pure subroutine push_slopes(n, b, radial, axial, f)
    integer, intent(in) :: n, b(NROW)
    real(dp), intent(in) :: radial(*), axial(*)
    real(dp), intent(inout) :: f(n)
    integer :: i
    !$omp simd
    do i = 1, n
      f(i) = f(i) + 0.5_dp*((corner_sum(radial, b, i) - corner_sum(radial, b, i - 1)) + &
                            (corner_slope_2(axial, b, i) + corner_slope_2(axial, b, i - 1)))
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
  !> Adds to each centre what the four quads across an axis give of which it is a corner.
  pure subroutine add_quad_gain(n, quads, k, h, gain)
    integer, intent(in) :: n, quads(4, 4)        !! see quads_around
    real(dp), intent(in) :: k(*), h(*)           !! weights; third differences
    real(dp), intent(inout) :: gain(n)
    integer :: i, q
    do q = 1, 4
      associate (a => quads(1, q), b => quads(2, q), c => quads(3, q), d => quads(4, q))
        !$omp simd
        do i = 0, n - 1
          gain(i + 1) = gain(i + 1) + k(a + i)*((h(a + i) - h(b + i)) - (h(c + i) - h(d + i)))
        end do
      end associate
    end do
  end subroutine add_quad_gain

  !> Adds the forces of the four quads across an axis of which each centre is a corner.
  pure subroutine add_quad_force(n, quads, k, stress, force)
    integer, intent(in) :: n, quads(4, 4)        !! see quads_around
    real(dp), intent(in) :: k(*), stress(*)
    real(dp), intent(inout) :: force(n)
    real(dp), parameter :: signs(4) = [1, -1, -1, 1]
    integer :: i, q
    do q = 1, 4
      associate (a => quads(1, q), b => quads(2, q), c => quads(3, q), d => quads(4, q))
        !$omp simd
        do i = 0, n - 1
          force(i + 1) = force(i + 1) + signs(q)*k(a + i)*((stress(a + i) + stress(b + i)) + &
                                                          (stress(c + i) + stress(d + i)))
        end do
      end associate
    end do
  end subroutine add_quad_force

  !> Records of the corners (lowest, next along either axis, highest) of the quads across an axis
  !! around the first centre of a row: it is the lowest of the first, the highest of the last.
  pure function quads_around(field, s, across) result(quads)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, across
    integer :: quads(4, 4)
    integer :: b(3), g(3), q, start(3)
    b = step_along(mod(across, 3) + 1)
    g = step_along(mod(across + 1, 3) + 1)
    do q = 1, 4
      start = -b*mod(q - 1, 2) - g*((q - 1)/2)
      quads(:, q) = [record_at(field, s, start), record_at(field, s, start + b), &
                     record_at(field, s, start + g), record_at(field, s, start + b + g)]
    end do
  end function quads_around

  !> Difference of the four rows around one of points, along their two axes.
  pure function corner_twist(column, b, i) result(t)
    real(dp), intent(in) :: column(*)
    integer, intent(in) :: b(NROW), i
    real(dp) :: t
    t = (column(b(4) + i) - column(b(3) + i)) - (column(b(2) + i) - column(b(1) + i))
  end function corner_twist
#endif

  !> Record of the first centre of a row.
  pure function first_record(field, s) result(at)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s
    integer :: at
    at = field%neighbour(0, 0, s) + field%work%first(s)
  end function first_record

  !> Record of a neighbour of the first centre of a row.
  pure function record_at(field, s, way) result(at)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, way(3)             !! way: cells along each axis
    integer :: at
#if NDIM == 2
    at = field%neighbour(0, way(2), s) + field%work%first(s) + way(1)
#else
    at = field%neighbour(way(2), way(3), s) + field%work%first(s) + way(1)
#endif
  end function record_at

  !> A cell along an axis.
  pure function step_along(axis) result(way)
    integer, intent(in) :: axis
    integer :: way(3)
    way = 0
    way(axis) = 1
  end function step_along

#include "corner_sums.inc"

end module DIM(sgmp_surfaces)
#endif
