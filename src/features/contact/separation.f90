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
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: separation

  integer, parameter :: most = 4             !! vertices kept, one of them about to go
  integer, parameter :: most_rounds = 40
  integer, parameter :: group = 8*lanes      !! balls looked at in one go
  real(dp), parameter :: turn = 3.0e-4_dp    !! angle by which the line may be off
  real(dp), parameter :: flat = 1.0e-13_dp   !! squared sine below which vertices span nothing

contains

  !> Vector from the hull of the first balls to the hull of the second where they are nearest; zero
  !! if they overlap.
  !!
  !! Every line that is looked along bounds the distance from below. Once it is known to be `enough`
  !! the search ends with that line, which is then as long as the bound.
  pure subroutine separation(ndim, na, a, nb, b, start, enough, line)
    integer, intent(in) :: ndim
    integer, intent(in) :: na, nb
      !! balls; a multiple of `lanes`
    real(dp), intent(in), contiguous :: a(:, :), b(:, :)
      !! (>= na or nb, 4) centre, 0 along axes that do not exist; radius
    real(dp), intent(in) :: start(3)       !! a guess of the direction
    real(dp), intent(in) :: enough         !! distance that need not be known more closely
    real(dp), intent(out) :: line(3)
    real(dp) :: vertex(3, most), weight(most), new(3), size2, along
    integer :: n, round
    logical :: solved
    n = 0
    vertex = 0.0_dp
    weight = 0.0_dp
    line = start
    do round = 1, most_rounds
      size2 = dot_product(line, line)
      if (size2 <= tiny(1.0_dp)) return
      call furthest_back(na, a, nb, b, line, new)
      along = dot_product(line, new)
      if (along > 0.0_dp .and. along**2 > enough**2*size2) then
        line = line*(along/size2)
        return
      end if
      if (n == 0) then
        n = 1
        vertex(:, 1) = new
        weight(1) = 1.0_dp
        line = new
        cycle
      end if
      ! Along the edge to the new vertex the line would turn by less than this.
      if ((size2 - along)**2 <= turn**2*size2*dot_product(new - line, new - line)) return
      if (along >= size2) return
      n = n + 1
      vertex(:, n) = new
      weight(n) = 0.0_dp
      call shrink(vertex, weight, n, solved)
      if (.not. solved) return
      line = weight(1)*vertex(:, 1) + weight(2)*vertex(:, 2) + weight(3)*vertex(:, 3) + &
             weight(4)*vertex(:, 4)
      if (n == ndim + 1) then  ! the origin lies inside: the hulls overlap
        line = 0.0_dp
        return
      end if
    end do
  end subroutine separation

  !> The difference vertex furthest back along a direction.
  pure subroutine furthest_back(na, a, nb, b, direction, vertex)
    integer, intent(in) :: na, nb
    real(dp), intent(in), contiguous :: a(:, :), b(:, :)
    real(dp), intent(in) :: direction(3)
    real(dp), intent(out) :: vertex(3)
    integer :: pa, pb
    real(dp) :: length
    length = norm2(direction)
    pa = furthest(size(a, 1), na, a, direction, length)
    pb = furthest(size(b, 1), nb, b, -direction, length)
    vertex = b(pb, :3) - a(pa, :3) - ((a(pa, 4) + b(pb, 4))/length)*direction
  end subroutine furthest_back

  !> The ball that reaches furthest along a direction; the first of equals.
  pure function furthest(stride, n, balls, direction, length) result(best)
    integer, intent(in) :: stride, n
    real(dp), intent(in) :: balls(stride, 4), direction(3), length
    integer :: best
    real(dp) :: along(group), most_along, highest
    integer :: p, first, last, at
    best = 1
    highest = -huge(1.0_dp)
    do first = 1, n, group
      last = min(n - first + 1, group)
      most_along = -huge(1.0_dp)
      !$omp simd reduction(max:most_along)
      do p = 1, last
        along(p) = balls(first - 1 + p, 4)*length + balls(first - 1 + p, 1)*direction(1) &
                   + balls(first - 1 + p, 2)*direction(2) + balls(first - 1 + p, 3)*direction(3)
        most_along = max(most_along, along(p))
      end do
      if (.not. most_along > highest) cycle
      highest = most_along
      at = last
      !$omp simd reduction(min:at)
      do p = 1, last
        at = min(at, merge(p, last, along(p) >= most_along))
      end do
      best = first - 1 + at
    end do
  end function furthest

  !> Weights of the nearest point of the hull of the vertices; vertices that do not help are dropped
  !! one by one, each where the way from the last point to the nearest one of the affine hull leaves
  !! the hull. Weights of absent vertices are zero.
  pure subroutine shrink(vertex, weight, n, solved)
    real(dp), intent(inout) :: vertex(3, most), weight(most)
    integer, intent(inout) :: n
    logical, intent(out) :: solved
    real(dp) :: mean(most), theta, t
    integer :: i, drop
    do
      call affine_mean(vertex, n, mean, solved)
      if (.not. solved) return
      theta = 1.0_dp
      drop = 0
      do i = 1, n
        if (mean(i) > 0.0_dp) cycle
        t = weight(i)/max(weight(i) - mean(i), tiny(1.0_dp))
        if (t < theta .or. drop == 0) then
          theta = t
          drop = i
        end if
      end do
      if (drop == 0) exit
      mean = weight + theta*(mean - weight)
      do i = drop, n - 1
        vertex(:, i) = vertex(:, i + 1)
        mean(i) = mean(i + 1)
      end do
      mean(n) = 0.0_dp
      n = n - 1
      do i = 1, most
        weight(i) = max(mean(i), 0.0_dp)
      end do
      weight = weight/((weight(1) + weight(2)) + (weight(3) + weight(4)))
    end do
    weight = mean
  end subroutine shrink

  !> Weights (of sum 1) of the point nearest to the origin in the affine hull of up to four
  !! vertices; not solved where they do not span it.
  pure subroutine affine_mean(vertex, n, mean, solved)
    real(dp), intent(in) :: vertex(3, most)
    integer, intent(in) :: n
    real(dp), intent(out) :: mean(most)
    logical, intent(out) :: solved
    real(dp) :: edge(3, 3), across(3), size1, size2, both, part1, part2, volume
    mean = 0.0_dp
    solved = .true.
    edge(:, 1) = vertex(:, 2) - vertex(:, 1)
    edge(:, 2) = vertex(:, 3) - vertex(:, 1)
    edge(:, 3) = vertex(:, 4) - vertex(:, 1)
    select case (n)
    case (1)
      continue  ! the vertex itself
    case (2)
      size1 = dot_product(edge(:, 1), edge(:, 1))
      solved = size1 > 0.0_dp
      if (solved) mean(2) = -dot_product(edge(:, 1), vertex(:, 1))/size1
    case (3)
      size1 = dot_product(edge(:, 1), edge(:, 1))
      size2 = dot_product(edge(:, 2), edge(:, 2))
      both = dot_product(edge(:, 1), edge(:, 2))
      part1 = -dot_product(edge(:, 1), vertex(:, 1))
      part2 = -dot_product(edge(:, 2), vertex(:, 1))
      volume = size1*size2 - both**2
      solved = volume > flat*size1*size2
      if (solved) mean(2:3) = [part1*size2 - part2*both, part2*size1 - part1*both]/volume
    case default
      across = cross(edge(:, 2), edge(:, 3))
      volume = dot_product(edge(:, 1), across)
      solved = volume**2 > flat*dot_product(edge(:, 1), edge(:, 1))*dot_product(across, across)
      if (solved) mean(2:4) = -[dot_product(vertex(:, 1), across), &
                                dot_product(vertex(:, 1), cross(edge(:, 3), edge(:, 1))), &
                                dot_product(vertex(:, 1), cross(edge(:, 1), edge(:, 2)))]/volume
    end select
    mean(1) = 1.0_dp - (mean(2) + mean(3) + mean(4))
  end subroutine affine_mean

end module sgmp_separation
