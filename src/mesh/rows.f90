!> Sparse sets of grid points, held as sorted intervals of rows: empty space is not stored.
!!
!! A row runs along x and is named by (j, k). In 2D the y axis takes the place of k, so that the
!! slowest axis - the one over which threads and ranks divide the work - is always k; in 1D there is
!! a single row.
module sgmp_rows
  use sgmp_kinds, only: i8
  implicit none
  private
  public :: rows_t, row_key, key_j, key_k
  public :: rows_from_points, rows_union, rows_intersection, rows_dilate, rows_locate, &
    rows_points, rows_contains, rows_find, rows_planes, rows_behind

  integer(i8), parameter :: key_stride = 2_i8**32

  !> Intervals [first, last] of rows, ascending by (k, j, first), disjoint and not touching.
  type :: rows_t
    integer :: n = 0
    integer(i8), allocatable :: key(:)               !! row_key(j, k)
    integer, allocatable :: first(:), last(:)        !! inclusive range of i
  end type rows_t

contains

  !> Sortable name of a row.
  elemental function row_key(j, k) result(key)
    integer, intent(in) :: j, k
    integer(i8) :: key
    key = int(k, i8)*key_stride + int(j, i8)
  end function row_key

  !> The k of a row.
  elemental function key_k(key) result(k)
    integer(i8), intent(in) :: key
    integer :: k
    k = int((key + key_stride/2 - modulo(key + key_stride/2, key_stride))/key_stride)
  end function key_k

  !> The j of a row.
  elemental function key_j(key) result(j)
    integer(i8), intent(in) :: key
    integer :: j
    j = int(modulo(key + key_stride/2, key_stride) - key_stride/2)
  end function key_j

  !> Number of points in the set.
  elemental function rows_points(rows) result(points)
    type(rows_t), intent(in) :: rows
    integer(i8) :: points
    integer :: s
    points = 0_i8
    do s = 1, rows%n
      points = points + int(rows%last(s) - rows%first(s) + 1, i8)
    end do
  end function rows_points

  !> A set from points sorted by (key, i); repeats are allowed.
  pure subroutine rows_from_points(key, i, rows)
    integer(i8), intent(in) :: key(:)    !! row of each point
    integer, intent(in) :: i(:)          !! position in the row
    type(rows_t), intent(out) :: rows
    integer :: p, intervals
    intervals = 0
    do p = 1, size(key)
      if (p > 1) then
        if (key(p) == key(p - 1) .and. i(p) <= i(p - 1) + 1) cycle
      end if
      intervals = intervals + 1
    end do
    call rows_reserve(rows, intervals)
    do p = 1, size(key)
      call rows_append(rows, key(p), i(p), i(p))
    end do
  end subroutine rows_from_points

  !> Union of two sets, in one merge.
  pure subroutine rows_union(a, b, rows)
    type(rows_t), intent(in) :: a, b
    type(rows_t), intent(out) :: rows
    integer :: s, t
    logical :: take_a
    call rows_reserve(rows, a%n + b%n)
    s = 1
    t = 1
    do while (s <= a%n .or. t <= b%n)
      if (t > b%n) then
        take_a = .true.
      else if (s > a%n) then
        take_a = .false.
      else
        take_a = a%key(s) < b%key(t) .or. (a%key(s) == b%key(t) .and. a%first(s) <= b%first(t))
      end if
      if (take_a) then
        call rows_append(rows, a%key(s), a%first(s), a%last(s))
        s = s + 1
      else
        call rows_append(rows, b%key(t), b%first(t), b%last(t))
        t = t + 1
      end if
    end do
  end subroutine rows_union

  !> Points that two sets have in common, in one merge.
  pure subroutine rows_intersection(a, b, rows)
    type(rows_t), intent(in) :: a, b
    type(rows_t), intent(out) :: rows
    integer :: s, t
    call rows_reserve(rows, a%n + b%n)
    s = 1
    t = 1
    do while (s <= a%n .and. t <= b%n)
      if (a%key(s) /= b%key(t)) then
        if (a%key(s) < b%key(t)) then
          s = s + 1
        else
          t = t + 1
        end if
        cycle
      end if
      if (max(a%first(s), b%first(t)) <= min(a%last(s), b%last(t))) then
        call rows_append(rows, a%key(s), max(a%first(s), b%first(t)), min(a%last(s), b%last(t)))
      end if
      if (a%last(s) <= b%last(t)) then
        s = s + 1
      else
        t = t + 1
      end if
    end do
  end subroutine rows_intersection

  !> The part of a set that lies in a range of planes.
  pure subroutine rows_planes(rows, planes, part)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: planes(2)     !! first and last k
    type(rows_t), intent(out) :: part
    integer :: s, k
    call rows_reserve(part, rows%n)
    do s = 1, rows%n
      k = key_k(rows%key(s))
      if (k < planes(1) .or. k > planes(2)) cycle
      call rows_append(part, rows%key(s), rows%first(s), rows%last(s))
    end do
  end subroutine rows_planes

  !> The set widened by lower..upper points along (i, j, k).
  pure subroutine rows_dilate(rows, lower, upper, wide)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: lower(3), upper(3)  !! offsets, lower <= 0 <= upper
    type(rows_t), intent(out) :: wide
    type(rows_t) :: along, sum_of, shifted
    integer :: axis, d
    wide = rows
    wide%first(:wide%n) = wide%first(:wide%n) + lower(1)
    wide%last(:wide%n) = wide%last(:wide%n) + upper(1)
    sum_of = wide
    call rows_union(sum_of, sum_of, wide)
    do axis = 2, 3
      along = wide
      do d = lower(axis), upper(axis)
        if (d == 0) cycle
        shifted = along
        shifted%key(:shifted%n) = shifted%key(:shifted%n) + &
                                  merge(1_i8, key_stride, axis == 2)*int(d, i8)
        call rows_union(wide, shifted, sum_of)
        wide = sum_of
      end do
    end do
  end subroutine rows_dilate

  !> For every interval of `rows`, moved by `shift` rows, the interval of `host` that contains its
  !! first point; 0: none.
  pure subroutine rows_locate(rows, shift, host, where_)
    type(rows_t), intent(in) :: rows, host
    integer(i8), intent(in) :: shift          !! added to the keys of `rows`
    integer, intent(out) :: where_(:)         !! (rows%n)
    integer :: s, t
    t = 1
    do s = 1, rows%n
      do while (t < host%n)
        if (host%key(t) > rows%key(s) + shift) exit
        if (host%key(t) == rows%key(s) + shift .and. host%last(t) >= rows%first(s)) exit
        t = t + 1
      end do
      where_(s) = 0
      if (t > host%n) cycle
      if (host%key(t) /= rows%key(s) + shift) cycle
      if (host%first(t) <= rows%first(s) .and. host%last(t) >= rows%first(s)) where_(s) = t
    end do
  end subroutine rows_locate

  !> Interval that holds point i of row `key`, 0 if none: a binary search.
  pure function rows_contains(rows, key, i) result(s)
    type(rows_t), intent(in) :: rows
    integer(i8), intent(in) :: key
    integer, intent(in) :: i
    integer :: s, low
    s = 0
    low = first_reaching(rows, 1, key, i)
    if (low > rows%n) return
    if (rows%key(low) == key .and. rows%first(low) <= i) s = low
  end function rows_contains

  !> The same for one who asks for points in their order: `from` is the first interval that does not
  !! lie before the point, to begin with 1, and is looked for from there.
  pure subroutine rows_find(rows, key, i, from, s)
    type(rows_t), intent(in) :: rows
    integer(i8), intent(in) :: key
    integer, intent(in) :: i
    integer, intent(inout) :: from
    integer, intent(out) :: s            !! as from rows_contains
    integer, parameter :: near = 4       !! intervals looked at one by one
    integer :: last
    last = min(from + near, rows%n + 1)
    do while (from < last)
      if (.not. before(rows, from, key, i)) exit
      from = from + 1
    end do
    if (from == last) from = first_reaching(rows, from, key, i)
    s = 0
    if (from > rows%n) return
    if (rows%key(from) == key .and. rows%first(from) <= i) s = from
  end subroutine rows_find

  !> Whether an interval lies before a point.
  pure function before(rows, s, key, i) result(yes)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: s, i
    integer(i8), intent(in) :: key
    logical :: yes
    yes = rows%key(s) < key .or. (rows%key(s) == key .and. rows%last(s) < i)
  end function before

  !> First interval from a given one that does not lie before a point: a binary search.
  pure function first_reaching(rows, start, key, i) result(low)
    type(rows_t), intent(in) :: rows
    integer, intent(in) :: start, i
    integer(i8), intent(in) :: key
    integer :: low, high, middle
    low = start
    high = rows%n
    do while (low <= high)
      middle = (low + high)/2
      if (before(rows, middle, key, i)) then
        low = middle + 1
      else
        high = middle - 1
      end if
    end do
  end function first_reaching

  !> First interval of row `key` or, where there is none, behind it; n + 1 where there is none.
  pure function rows_behind(rows, key) result(s)
    type(rows_t), intent(in) :: rows
    integer(i8), intent(in) :: key
    integer :: s, high, middle
    s = 1
    high = rows%n
    do while (s <= high)
      middle = (s + high)/2
      if (rows%key(middle) < key) then
        s = middle + 1
      else
        high = middle - 1
      end if
    end do
  end function rows_behind

  pure subroutine rows_reserve(rows, capacity)
    type(rows_t), intent(inout) :: rows
    integer, intent(in) :: capacity
    allocate (rows%key(capacity), rows%first(capacity), rows%last(capacity))
    rows%n = 0
  end subroutine rows_reserve

  !> Appends an interval, joining it to the last one where they touch.
  pure subroutine rows_append(rows, key, first, last)
    type(rows_t), intent(inout) :: rows
    integer(i8), intent(in) :: key
    integer, intent(in) :: first, last
    integer :: n
    n = rows%n
    if (n > 0) then
      if (rows%key(n) == key .and. rows%last(n) >= first - 1) then
        rows%last(n) = max(rows%last(n), last)
        return
      end if
    end if
    rows%n = n + 1
    rows%key(n + 1) = key
    rows%first(n + 1) = first
    rows%last(n + 1) = last
  end subroutine rows_append

end module sgmp_rows
