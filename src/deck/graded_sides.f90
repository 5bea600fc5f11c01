!> Sides of the cells of an axis that is fine in some intervals and grows coarser away from them
!! (doc/grids.md): from what a deck asks for to the tables of the axis.
!!
!! Cells are equal within the intervals. Beside them each is larger than the one before by at most
!! a ratio, up to the largest. Up to a wall, and between two intervals, the ratio is lowered until
!! cells end where they must; an end without a wall moves outwards.
module sgmp_graded_sides
  use sgmp_graded_axis, only: graded_axis_t, graded_make
  use sgmp_kinds, only: dp
  use sgmp_text, only: real_text_tidy
  implicit none
  private
  public :: graded_default_largest, graded_wish_t, graded_sides

  real(dp), parameter :: graded_default_largest = 8.0_dp  !! cells
  real(dp), parameter :: tolerance = 1.0e-6_dp  !! cells by which an interval may miss the grid
  integer, parameter :: most_sides = 10**7

  !> What a deck asks of an axis.
  type :: graded_wish_t
    logical :: open(2) = .true.          !! lower, upper: no end is given
    logical :: held(2) = .false.         !! the end stays where it is: a wall, or an edge
    logical :: walls(2) = .false.        !! matter ends there: the cell beyond is an image
    real(dp) :: ends(2) = 0.0_dp         !! (length)
    real(dp) :: cell = 1.0_dp            !! smallest side (length)
    real(dp) :: ratio = 1.1_dp           !! largest of the sides of two cells next to each other
    real(dp) :: largest = graded_default_largest  !! side (smallest cell)
    real(dp), allocatable :: fine(:, :)  !! (2, n) intervals of smallest cells (length)
  end type graded_wish_t

contains

  !> Tables of the axis, and where its ends then are; or what is wrong.
  subroutine graded_sides(wish, axis, ends, message, remedy)
    type(graded_wish_t), intent(in) :: wish
    type(graded_axis_t), intent(out) :: axis
    real(dp), intent(out) :: ends(2)     !! (length)
    character(:), allocatable, intent(out) :: message, remedy  !! '': nothing is
    real(dp), allocatable :: fine(:, :), sides(:)
    integer :: before
    message = ''
    remedy = ''
    ends = wish%ends
    call check_intervals(wish, message, remedy)
    if (message /= '') return
    call fit_intervals(wish, fine, message, remedy)
    if (message /= '') return
    call all_sides(wish, fine, sides, before, message, remedy)
    if (message /= '') return
    if (.not. wish%open(1)) ends(1) = fine(1, 1) - wish%cell*sum(sides(:before))
    if (wish%held(1)) ends(1) = wish%ends(1)
    if (.not. wish%open(2)) ends(2) = fine(1, 1) + wish%cell*sum(sides(before + 1:))
    if (wish%held(2)) ends(2) = wish%ends(2)
    if (.not. wish%open(1)) then
      axis = graded_make(ends(1), 0, sides, wish%walls)
    else if (.not. wish%open(2)) then
      axis = graded_make(ends(2), -size(sides), sides, wish%walls)
    else
      axis = graded_make(fine(1, 1), -before, sides, wish%walls)
    end if
  end subroutine graded_sides

  !> Sides of all cells from below: of intervals, and of what is beside and between them.
  subroutine all_sides(wish, fine, sides, before, message, remedy)
    type(graded_wish_t), intent(in) :: wish
    real(dp), intent(in) :: fine(:, :)   !! intervals
    real(dp), allocatable, intent(out) :: sides(:)  !! (smallest cell)
    integer, intent(out) :: before       !! cells before the first interval
    character(:), allocatable, intent(inout) :: message, remedy
    real(dp), allocatable :: more(:)
    real(dp) :: gap
    integer :: i
    allocate (sides(0))
    before = 0
    do i = 0, size(fine, 2)
      if (i == 0) then
        call end_sides(wish, 1, fine(1, 1) - wish%ends(1), more, message, remedy)
        more = more(size(more):1:-1)
        before = size(more)
      else if (i == size(fine, 2)) then
        call end_sides(wish, 2, wish%ends(2) - fine(2, i), more, message, remedy)
      else
        gap = (fine(1, i + 1) - fine(2, i))/wish%cell
        call fitted(gap, wish, .true., more)
        if (size(more) == 0) call no_room(wish, fine(2, i), fine(1, i + 1), message, remedy)
      end if
      if (message /= '') return
      sides = [sides, more]
      if (i < size(fine, 2)) then
        sides = [sides, spread(1.0_dp, 1, nint((fine(2, i + 1) - fine(1, i + 1))/wish%cell))]
      end if
    end do
  end subroutine all_sides

  !> Intervals that are none, reach out of the grid, or hold less than two cells.
  subroutine check_intervals(wish, message, remedy)
    type(graded_wish_t), intent(in) :: wish
    character(:), allocatable, intent(inout) :: message, remedy
    character(:), allocatable :: name
    integer :: i
    do i = 1, size(wish%fine, 2)
      associate (low => wish%fine(1, i), high => wish%fine(2, i), slack => tolerance*wish%cell)
        name = 'the fine interval '//interval_text(low, high)
        if (.not. high > low) then
          message = name//' ends before it begins'
          remedy = 'write (lower,upper)'
        else if ((.not. wish%open(1) .and. low < wish%ends(1) - slack) .or. &
                 (.not. wish%open(2) .and. high > wish%ends(2) + slack)) then
          message = name//' reaches out of the grid'
          remedy = 'let it end where the grid does'
        else if (high - low < 2.0_dp*wish%cell - slack) then
          message = name//' holds less than two cells of '//real_text_tidy(wish%cell)
          remedy = 'make it wider or the cells smaller'
        end if
      end associate
      if (message /= '') return
    end do
  end subroutine check_intervals

  !> The intervals in their order, those that touch as one, each a whole number of cells: they grow
  !! to both sides, but not beyond an end that is held.
  subroutine fit_intervals(wish, fine, message, remedy)
    type(graded_wish_t), intent(in) :: wish
    real(dp), allocatable, intent(out) :: fine(:, :)
    character(:), allocatable, intent(inout) :: message, remedy
    real(dp) :: more, length
    logical :: at(2)
    integer :: i
    fine = joined(sorted(wish%fine), wish%cell)
    do i = 1, size(fine, 2)
      at = wish%held .and. abs(fine(:, i) - wish%ends) <= tolerance*wish%cell
      length = (fine(2, i) - fine(1, i))/wish%cell
      if (abs(length - anint(length)) <= tolerance) then
        if (at(2) .and. .not. at(1)) fine(1, i) = fine(2, i) - anint(length)*wish%cell
        cycle
      end if
      more = (ceiling(length - tolerance) - length)*wish%cell
      if (all(at)) then
        message = 'cells of '//real_text_tidy(wish%cell)//' do not divide the fine interval '// &
                  interval_text(fine(1, i), fine(2, i))//' between two walls'
        remedy = 'choose a cell that does'
        return
      end if
      if (at(1)) then
        fine(2, i) = fine(2, i) + more
      else if (at(2)) then
        fine(1, i) = fine(1, i) - more
      else
        fine(:, i) = fine(:, i) + 0.5_dp*more*[-1.0_dp, 1.0_dp]
      end if
    end do
    fine = joined(fine, wish%cell)
  end subroutine fit_intervals

  !> Intervals by their lower ends.
  pure function sorted(intervals) result(order)
    real(dp), intent(in) :: intervals(:, :)
    real(dp) :: order(2, size(intervals, 2)), one(2)
    integer :: i, k
    order = intervals
    do i = 2, size(order, 2)
      one = order(:, i)
      do k = i - 1, 1, -1
        if (order(1, k) <= one(1)) exit
        order(:, k + 1) = order(:, k)
      end do
      order(:, k + 1) = one
    end do
  end function sorted

  !> Sorted intervals, of which those that overlap or touch are one.
  pure function joined(intervals, cell) result(fewer)
    real(dp), intent(in) :: intervals(:, :), cell
    real(dp), allocatable :: fewer(:, :)
    integer :: i, n
    fewer = intervals
    n = 1
    do i = 2, size(intervals, 2)
      if (intervals(1, i) <= fewer(2, n) + tolerance*cell) then
        fewer(2, n) = max(fewer(2, n), intervals(2, i))
      else
        n = n + 1
        fewer(:, n) = intervals(:, i)
      end if
    end do
    fewer = fewer(:, :n)
  end function joined

  !> Sides of the cells between an interval and an end, from the interval on.
  subroutine end_sides(wish, end, length, sides, message, remedy)
    type(graded_wish_t), intent(in) :: wish
    integer, intent(in) :: end           !! 1: lower, 2: upper
    real(dp), intent(in) :: length       !! between the two
    real(dp), allocatable, intent(out) :: sides(:)
    character(:), allocatable, intent(inout) :: message, remedy
    integer :: n
    allocate (sides(0))
    if (.not. wish%open(end) .and. length <= tolerance*wish%cell) return
    if (wish%open(end)) then             ! until they grow no more
      n = 1
      do while (wish%ratio > 1.0_dp .and. wish%ratio**n < wish%largest)
        n = n + 1
      end do
      sides = growing(n, wish%ratio, wish%largest, .false.)
    else if (wish%held(end)) then
      call fitted(length/wish%cell, wish, .false., sides)
      if (size(sides) > 0) return
      if (end == 1) then
        call no_room(wish, wish%ends(1), wish%ends(1) + length, message, remedy)
      else
        call no_room(wish, wish%ends(2) - length, wish%ends(2), message, remedy)
      end if
    else
      n = enough(length/wish%cell, wish, .false.)
      sides = growing(n, wish%ratio, wish%largest, .false.)
    end if
  end subroutine end_sides

  !> Sides that grow up to the ratio and fill a length; none where no ratio does.
  pure subroutine fitted(length, wish, both, sides)
    real(dp), intent(in) :: length       !! (smallest cell)
    type(graded_wish_t), intent(in) :: wish
    logical, intent(in) :: both          !! they grow from both ends
    real(dp), allocatable, intent(out) :: sides(:)
    real(dp) :: low, high, middle
    integer :: n, i
    n = enough(length, wish, both)
    allocate (sides(0))
    if (n > length*(1.0_dp + 1.0e-9_dp) + tolerance) return
    low = 1.0_dp
    high = wish%ratio
    do i = 1, 60
      middle = 0.5_dp*(low + high)
      if (sum(growing(n, middle, wish%largest, both)) < length) then
        low = middle
      else
        high = middle
      end if
    end do
    sides = growing(n, high, wish%largest, both)
    sides = sides*(length/sum(sides))    ! but for round-off they do
  end subroutine fitted

  !> Fewest cells that reach over a length.
  pure function enough(length, wish, both) result(n)
    real(dp), intent(in) :: length       !! (smallest cell)
    type(graded_wish_t), intent(in) :: wish
    logical, intent(in) :: both
    integer :: n
    real(dp) :: total
    integer :: k
    n = 0
    total = 0.0_dp
    do while (total < length*(1.0_dp - 1.0e-9_dp) - tolerance .and. n < most_sides)
      n = n + 1
      k = merge((n + 1)/2, n, both)      ! one more cell is one in the middle
      total = total + min(wish%ratio**min(k, 10000), wish%largest)
    end do
  end function enough

  !> So many sides, from one end or from both.
  pure function growing(n, ratio, largest, both) result(sides)
    integer, intent(in) :: n
    real(dp), intent(in) :: ratio, largest
    logical, intent(in) :: both
    real(dp) :: sides(n)
    integer :: i, k
    do i = 1, n
      k = merge(min(i, n + 1 - i), i, both)
      sides(i) = min(ratio**min(k, 10000), largest)
    end do
  end function growing

  subroutine no_room(wish, low, high, message, remedy)
    type(graded_wish_t), intent(in) :: wish
    real(dp), intent(in) :: low, high
    character(:), allocatable, intent(inout) :: message, remedy
    message = 'no cells that begin with '//real_text_tidy(wish%cell)//' and grow by at most '// &
              real_text_tidy(wish%ratio)//' fill '//interval_text(low, high)// &
              ' beside a fine interval'
    remedy = 'let the fine interval reach to the end, or end a whole number of cells before it'
  end subroutine no_room

  pure function interval_text(low, high) result(text)
    real(dp), intent(in) :: low, high
    character(:), allocatable :: text
    text = '('//real_text_tidy(low)//','//real_text_tidy(high)//')'
  end function interval_text

end module sgmp_graded_sides
