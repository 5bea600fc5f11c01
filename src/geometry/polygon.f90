!> Polygons of the plane, given by their corners in order, either way round.
module sgmp_polygon
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: polygon_depth, polygon_holds, polygon_is_simple

contains

  !> Whether a polygon is around a point: a ray to the right crosses its sides an odd number of
  !! times.
  pure function polygon_holds(corners, point) result(inside)
    real(dp), intent(in) :: corners(:, :)  !! (2, n)
    real(dp), intent(in) :: point(2)
    logical :: inside
    real(dp) :: a(2), b(2)
    integer :: i
    inside = .false.
    b = corners(:, size(corners, 2))
    do i = 1, size(corners, 2)
      a = b
      b = corners(:, i)
      if ((a(2) <= point(2)) .eqv. (b(2) <= point(2))) cycle
      if (point(1) < a(1) + (b(1) - a(1))*((point(2) - a(2))/(b(2) - a(2)))) inside = .not. inside
    end do
  end function polygon_holds

  !> Distance to the nearest side of a polygon, positive inside.
  pure function polygon_depth(corners, point, about_axis) result(depth)
    real(dp), intent(in) :: corners(:, :)  !! (2, n)
    real(dp), intent(in) :: point(2)
    logical, intent(in) :: about_axis
      !! it turns about its second axis: sides there are no surface of what it makes
    real(dp) :: depth, a(2), side(2), foot
    integer :: i
    depth = huge(1.0_dp)
    a = corners(:, size(corners, 2))
    do i = 1, size(corners, 2)
      side = corners(:, i) - a
      if (.not. about_axis .or. any(abs([a(1), corners(1, i)]) > 0.0_dp)) then
        foot = max(0.0_dp, min(1.0_dp, dot_product(point - a, side)/dot_product(side, side)))
        depth = min(depth, norm2(point - a - foot*side))
      end if
      a = corners(:, i)
    end do
    if (.not. polygon_holds(corners, point)) depth = -depth
  end function polygon_depth

  !> Whether the sides of a polygon have a length and none crosses another.
  pure function polygon_is_simple(corners) result(simple)
    real(dp), intent(in) :: corners(:, :)  !! (2, n)
    logical :: simple
    real(dp) :: a(2), b(2), c(2), d(2)
    integer :: i, j, n
    n = size(corners, 2)
    simple = .false.
    do i = 1, n
      a = corners(:, i)
      b = corners(:, modulo(i, n) + 1)
      if (all(abs(b - a) <= 0.0_dp)) return
      do j = i + 1, n
        c = corners(:, j)
        d = corners(:, modulo(j, n) + 1)
        if (turn(a, b, c)*turn(a, b, d) < 0.0_dp .and. turn(c, d, a)*turn(c, d, b) < 0.0_dp) return
      end do
    end do
    simple = .true.
  contains
    !> Positive where the way from p over q to r turns left.
    pure function turn(p, q, r) result(area)
      real(dp), intent(in) :: p(2), q(2), r(2)
      real(dp) :: area
      area = (q(1) - p(1))*(r(2) - p(2)) - (q(2) - p(2))*(r(1) - p(1))
    end function turn
  end function polygon_is_simple

end module sgmp_polygon
