!> Boxes with sides along the axes, sorted into bins of one width: which of them may hold a point,
!! which one without size is nearest to it. Each question costs what lies near the point.
module sgmp_boxes
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: boxes_t, boxes_make, boxes_near, boxes_nearest

  !> Boxes in bins; there are at most as many bins as boxes.
  type :: boxes_t
    integer, allocatable :: items(:)       !! boxes of the bins, bin by bin, in each ascending
    integer, allocatable, private :: first(:)   !! (bins + 1) place of a bin's first in `items`
    integer, private :: bins(3) = 0             !! along each axis
    real(dp), private :: lower(3) = 0.0_dp, upper(3) = 0.0_dp   !! of all boxes
    real(dp), private :: width = 1.0_dp         !! of a bin
  end type boxes_t

contains

  !> Sorts boxes into bins.
  pure subroutine boxes_make(boxes, lower, upper)
    type(boxes_t), intent(out) :: boxes
    real(dp), intent(in) :: lower(:, :), upper(:, :)   !! (3, n) corners
    integer, allocatable :: next(:)
    integer :: b
    if (size(lower, 2) == 0) return
    boxes%lower = minval(lower, 2)
    boxes%upper = maxval(upper, 2)
    call choose_width(boxes, lower, upper)
    allocate (next(product(boxes%bins)), source=0)
    call enter(boxes, lower, upper, next)
    allocate (boxes%first(size(next) + 1))
    boxes%first(1) = 1
    do b = 1, size(next)
      boxes%first(b + 1) = boxes%first(b) + next(b)
    end do
    next = boxes%first(:size(next))
    allocate (boxes%items(boxes%first(size(next) + 1) - 1))
    call enter(boxes, lower, upper, next, boxes%items)
  end subroutine boxes_make

  !> Goes through all boxes and the bins of each: counts them, or puts them there.
  pure subroutine enter(boxes, lower, upper, next, items)
    type(boxes_t), intent(in) :: boxes
    real(dp), intent(in) :: lower(:, :), upper(:, :)
    integer, intent(inout) :: next(:)            !! (bins) one more for each box
    integer, intent(inout), optional :: items(:)  !! the box goes to place `next`
    integer :: at, bx, by, bz, from(3), i, to(3)
    do i = 1, size(lower, 2)
      from = bin_of(boxes, lower(:, i))
      to = bin_of(boxes, upper(:, i))
      do bz = from(3), to(3)
        do by = from(2), to(2)
          do bx = from(1), to(1)
            at = place(boxes, [bx, by, bz])
            if (present(items)) items(next(at)) = i
            next(at) = next(at) + 1
          end do
        end do
      end do
    end do
  end subroutine enter

  !> Width of the bins: no more bins than boxes, none smaller than a box usually is, so that few
  !! boxes lie in many bins.
  pure subroutine choose_width(boxes, lower, upper)
    type(boxes_t), intent(inout) :: boxes
    real(dp), intent(in) :: lower(:, :), upper(:, :)
    real(dp) :: extent(3), usual
    extent = boxes%upper - boxes%lower
    boxes%width = max(maxval(extent), tiny(1.0_dp))
    boxes%bins = 1
    usual = (sum(maxval(upper - lower, 1)**3)/size(lower, 2))**(1.0_dp/3.0_dp)
    do while (0.5_dp*boxes%width > usual .and. bins(0.5_dp*boxes%width) <= real(size(lower, 2), dp))
      boxes%width = 0.5_dp*boxes%width
      boxes%bins = int(extent/boxes%width) + 1
    end do
  contains
    pure real(dp) function bins(width) result(number)
      real(dp), intent(in) :: width
      number = product(1.0_dp + aint(extent/width))
    end function bins
  end subroutine choose_width

  !> The bin that a point is in, of the outer ones that is nearest: from 0 along each axis.
  pure function bin_of(boxes, point) result(bin)
    type(boxes_t), intent(in) :: boxes
    real(dp), intent(in) :: point(3)
    integer :: bin(3)
    bin = int(min(max(0.0_dp, (point - boxes%lower)/boxes%width), real(boxes%bins - 1, dp)))
  end function bin_of

  !> Number of a bin, from 1.
  pure integer function place(boxes, bin) result(number)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: bin(3)
    number = 1 + bin(1) + boxes%bins(1)*(bin(2) + boxes%bins(2)*bin(3))
  end function place

  !> The boxes that may hold a point - all that do, and others close by -: these places of `items`.
  pure function boxes_near(boxes, point) result(places)
    type(boxes_t), intent(in) :: boxes
    real(dp), intent(in) :: point(3)
    integer :: places(2)   !! first and last, the last below the first where there is none
    integer :: at
    places = [1, 0]
    if (any(boxes%bins == 0) .or. any(point < boxes%lower) .or. any(point > boxes%upper)) return
    at = place(boxes, bin_of(boxes, point))
    places = [boxes%first(at), boxes%first(at + 1) - 1]
  end function boxes_near

  !> The box without size that is nearest to a point, of equally near ones the first; 0: there is
  !! none. Bins are taken shell by shell until what is left must be further away.
  pure subroutine boxes_nearest(boxes, position, ndim, point, nearest, distance2)
    type(boxes_t), intent(in) :: boxes
    real(dp), intent(in) :: position(:, :)   !! (3, n) the boxes, which are points
    integer, intent(in) :: ndim              !! axes that count
    real(dp), intent(in) :: point(3)
    integer, intent(out) :: nearest
    real(dp), intent(out) :: distance2       !! its square
    real(dp) :: outside
    integer :: centre(3), shell
    nearest = 0
    distance2 = huge(1.0_dp)
    if (any(boxes%bins == 0)) return
    centre = bin_of(boxes, point)
    associate (out => max(0.0_dp, boxes%lower - point, point - boxes%upper))
      outside = sum(out(:ndim)**2)
    end associate
    do shell = 0, maxval(boxes%bins)
      ! A bin less than the shells before, for round-off in the choice of a bin.
      if (distance2 < outside + (max(0, shell - 2)*boxes%width)**2) exit
      call look_at_shell(boxes, position, ndim, point, [centre, shell], nearest, distance2)
    end do
  end subroutine boxes_nearest

  !> The bins that are so many away from one along some axis, and not more along any.
  pure subroutine look_at_shell(boxes, position, ndim, point, shell, nearest, distance2)
    type(boxes_t), intent(in) :: boxes
    real(dp), intent(in) :: position(:, :), point(3)
    integer, intent(in) :: ndim
    integer, intent(in) :: shell(4)          !! the bin in the middle, distance
    integer, intent(inout) :: nearest
    real(dp), intent(inout) :: distance2
    real(dp) :: d2
    integer :: bx, by, bz, from(3), i, step, to(3), at
    from = max(0, shell(:3) - shell(4))
    to = min(boxes%bins - 1, shell(:3) + shell(4))
    do bz = from(3), to(3)
      do by = from(2), to(2)
        step = 1  ! inside of the other axes only the two ends belong to the shell
        if (all(abs([by, bz] - shell(2:3)) < shell(4))) step = 2*shell(4)
        do bx = shell(1) - shell(4), to(1), step
          if (bx < from(1)) cycle
          at = place(boxes, [bx, by, bz])
          do i = boxes%first(at), boxes%first(at + 1) - 1
            associate (p => boxes%items(i))
              d2 = sum((position(:ndim, p) - point(:ndim))**2)
              if (d2 > distance2 .or. (d2 >= distance2 .and. p > nearest)) cycle
              distance2 = d2
              nearest = p
            end associate
          end do
        end do
      end do
    end do
  end subroutine look_at_shell

end module sgmp_boxes
