!> The shortest line between two sets of balls: distance and direction of their convex hulls.
!!
!! It is the point nearest to the origin of the polytope of all differences, found by Wolfe's method
!! (Math. Program. 11,
!! 1976): a small set of vertices is kept of which the nearest point is a proper mean; the vertex
!! furthest back along the
!! current line is added until none is further back. Only the furthest points along a line are ever
!! looked for.
module sgmp_separation
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: separation

  integer, parameter :: most = 5             !! vertices kept, and one more
  integer, parameter :: most_rounds = 40
  real(dp), parameter :: tolerance = 1.0e-6_dp  !! of the squared distance

contains

  !> Vector from the hull of `first` to the hull of `second` where they are nearest; zero if they
  !! overlap.
  pure subroutine separation(ndim, first, second, start, line)
    integer, intent(in) :: ndim
    real(dp), intent(in) :: first(:, :), second(:, :)
      !! (balls, ndim + 1): centre, radius; a multiple of `lanes`
    real(dp), intent(in) :: start(:)                   !! (ndim) a guess of the direction
    real(dp), intent(out) :: line(:)                   !! (ndim)
    real(dp) :: vertex(ndim, most), weight(most), new(ndim), size2
    integer :: n, round
    logical :: solved
    vertex = 0.0_dp
    weight = 0.0_dp
    line = start
    n = 1
    call furthest_back(ndim, first, second, start, vertex(:, 1))
    weight(1) = 1.0_dp
    line = vertex(:, 1)
    do round = 1, most_rounds
      size2 = dot_product(line, line)
      call furthest_back(ndim, first, second, line, new)
      if (dot_product(line, new) >= size2*(1.0_dp - tolerance) .or. size2 <= tiny(1.0_dp)) return
      n = n + 1
      vertex(:, n) = new
      weight(n) = 0.0_dp
      call shrink(vertex, weight, n, solved)
      if (.not. solved) return
      line = matmul(vertex(:, :n), weight(:n))
      if (n == ndim + 1) then  ! the origin lies inside: the hulls overlap
        line = 0.0_dp
        return
      end if
    end do
  end subroutine separation

  !> The difference vertex furthest back along a direction.
  pure subroutine furthest_back(ndim, first, second, direction, vertex)
    integer, intent(in) :: ndim
    real(dp), intent(in) :: first(:, :), second(:, :), direction(ndim)
    real(dp), intent(out) :: vertex(ndim)
    integer :: a, b
    real(dp) :: length
    length = norm2(direction)
    a = furthest(ndim, size(first, 1), first, direction, length)
    b = furthest(ndim, size(second, 1), second, -direction, length)
    vertex = second(b, :ndim) - first(a, :ndim) &
             - (first(a, ndim + 1) + second(b, ndim + 1))/max(length, tiny(1.0_dp))*direction
  end subroutine furthest_back

  !> The point furthest along a direction; the first of equals.
  pure function furthest(ndim, n, points, direction, length) result(best)
    integer, intent(in) :: ndim, n
    real(dp), intent(in) :: points(n, ndim + 1), direction(ndim), length
    integer :: best
    real(dp) :: along(n), most_along(lanes), top
    integer :: p, d, l
    along = points(:, ndim + 1)*length
    do d = 1, ndim
      !$omp simd
      do p = 1, n
        along(p) = along(p) + points(p, d)*direction(d)
      end do
    end do
    most_along = along(:lanes)
    do p = lanes, n - lanes, lanes
      !$omp simd
      do l = 1, lanes
        most_along(l) = merge(along(p + l), most_along(l), along(p + l) > most_along(l))
      end do
    end do
    top = maxval(most_along)
    do best = 1, n - 1
      if (along(best) >= top) return
    end do
  end function furthest

  !> Nearest point of the affine hull of the vertices; vertices that do not help are dropped.
  pure subroutine shrink(vertex, weight, n, solved)
    real(dp), intent(inout) :: vertex(:, :), weight(:)
    integer, intent(inout) :: n
    logical, intent(out) :: solved
    real(dp) :: mean(most), theta, t
    integer :: i, drop
    do
      call affine_mean(vertex, n, mean, solved)
      if (.not. solved) return
      if (all(mean(:n) > 0.0_dp)) then
        weight(:n) = mean(:n)
        return
      end if
      theta = 1.0_dp
      drop = n
      do i = 1, n
        if (mean(i) > 0.0_dp) cycle
        t = weight(i)/max(weight(i) - mean(i), tiny(1.0_dp))
        if (t < theta) then
          theta = t
          drop = i
        end if
      end do
      weight(:n) = theta*mean(:n) + (1.0_dp - theta)*weight(:n)
      vertex(:, drop:n - 1) = vertex(:, drop + 1:n)
      weight(drop:n - 1) = weight(drop + 1:n)
      n = n - 1
      if (n == 0) solved = .false.
      if (n == 0) return
      weight(:n) = max(weight(:n), 0.0_dp)
      weight(:n) = weight(:n)/sum(weight(:n))
    end do
  end subroutine shrink

  !> Weights (of sum 1) of the point nearest to the origin in the affine hull of n vertices.
  pure subroutine affine_mean(vertex, n, mean, solved)
    real(dp), intent(in) :: vertex(:, :)
    integer, intent(in) :: n
    real(dp), intent(out) :: mean(most)
    logical, intent(out) :: solved
    real(dp) :: a(most, most + 1), edge(size(vertex, 1), most), scale, swap(most + 1)
    integer :: i, j, k, pivot
    mean = 0.0_dp
    solved = .true.
    if (n == 1) then
      mean(1) = 1.0_dp
      return
    end if
    k = n - 1
    do i = 1, k
      edge(:, i) = vertex(:, i + 1) - vertex(:, 1)
    end do
    do i = 1, k
      do j = 1, k
        a(i, j) = dot_product(edge(:, i), edge(:, j))
      end do
      a(i, k + 1) = -dot_product(edge(:, i), vertex(:, 1))
    end do
    scale = maxval([(a(i, i), i=1, k)])
    do i = 1, k
      pivot = i - 1 + maxloc(abs(a(i:k, i)), 1)
      solved = abs(a(pivot, i)) > 1.0e-13_dp*scale
      if (.not. solved) return
      swap(:k + 1) = a(i, :k + 1)
      a(i, :k + 1) = a(pivot, :k + 1)
      a(pivot, :k + 1) = swap(:k + 1)
      do j = i + 1, k
        a(j, i:k + 1) = a(j, i:k + 1) - (a(j, i)/a(i, i))*a(i, i:k + 1)
      end do
    end do
    do i = k, 1, -1
      mean(i + 1) = (a(i, k + 1) - dot_product(a(i, i + 1:k), mean(i + 2:n)))/a(i, i)
    end do
    mean(1) = 1.0_dp - sum(mean(2:n))
  end subroutine affine_mean

end module sgmp_separation
