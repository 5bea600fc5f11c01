!> An axis of the grid with cells of unequal sides: tables of the spacings of the cells' centres.
!!
!! The sides that a deck asks for give the centres, each in the middle of its cell; what the grid
!! stores is the spacing H_I of the two centres around node I, the mean of the sides next to it.
!! Nodes lie midway between centres, so that the distance of two nodes around a centre is
!!     h_c = (H_c + H_(c+1))/2
!! (doc/grids.md). The coordinate X of a particle grows by 1 from centre to centre, linearly with
!! its place: weights are those of equal cells. The integral of a centre's hat function over the
!! place is h_c for any sides, and a uniform stress therefore pushes no node.
!!
!! Lengths are in the smallest cell's side h. Beyond the table sides are as they are at its ends;
!! the centre behind a wall is the image of the one before it.
module sgmp_graded_axis
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: graded_axis_t, graded_make
  public :: graded_advance, graded_between, graded_centre, graded_coordinate, graded_node, &
            graded_place, graded_spacing, graded_tables, graded_width

  !> Tables of one axis; without them cells are equal.
  type :: graded_axis_t
    logical :: graded = .false.
    real(dp) :: origin = 0.0_dp          !! place of the deck's node 0 (length)
    integer :: first = 0, last = 0       !! outermost nodes of the table
    logical :: walls(2) = .false.        !! there is a wall, or the axis of symmetry
    real(dp), allocatable :: spacing(:)  !! (first:last) H_I
    real(dp), allocatable :: centre(:)   !! (first - 1:last) places of centres from the origin
    real(dp), allocatable :: width(:)    !! (first - 1:last) h_c
    real(dp), allocatable :: slope(:)    !! (first - 1:last) 1/h_c
    real(dp), allocatable :: low(:)      !! (first - 1:last) weight of the lower node in what is
                                         !! linear between the two at the centre
  end type graded_axis_t

contains

  !> The axis of some cells.
  pure function graded_make(origin, first, sides, walls) result(axis)
    real(dp), intent(in) :: origin       !! place of the deck's node 0 (length)
    integer, intent(in) :: first         !! the first cell, whose lower node has the same number
    real(dp), intent(in) :: sides(first:)  !! of the cells (smallest cell)
    logical, intent(in) :: walls(2)      !! at the lower and the upper end, or the axis of symmetry
    type(graded_axis_t) :: axis
    integer :: last, i
    last = ubound(sides, 1) + 1
    axis%graded = .true.
    axis%origin = origin
    axis%first = first
    axis%last = last
    axis%walls = walls
    allocate (axis%spacing(first:last), axis%centre(first - 1:last), axis%width(first - 1:last), &
              axis%slope(first - 1:last), axis%low(first - 1:last))
    axis%spacing(first) = sides(first)
    axis%spacing(last) = sides(last - 1)
    do i = first + 1, last - 1
      axis%spacing(i) = 0.5_dp*(sides(i - 1) + sides(i))
    end do
    ! Centres from node 0 outwards: what lies near it is exact.
    axis%centre = 0.0_dp
    i = min(max(0, first), last - 1)
    axis%centre(i) = 0.5_dp*sides(i)
    if (i < 0) axis%centre(i) = -0.5_dp*sides(i)
    do i = min(max(0, first), last - 1) + 1, last
      axis%centre(i) = axis%centre(i - 1) + axis%spacing(i)
    end do
    do i = min(max(0, first), last - 1) - 1, first - 1, -1
      axis%centre(i) = axis%centre(i + 1) - axis%spacing(i + 1)
    end do
    axis%width(first) = 0.5_dp*(axis%spacing(first) + axis%spacing(first + 1))
    axis%width(first - 1) = merge(axis%width(first), axis%spacing(first), walls(1))
    do i = first + 1, last - 1
      axis%width(i) = 0.5_dp*(axis%spacing(i) + axis%spacing(i + 1))
    end do
    axis%width(last) = merge(axis%width(last - 1), axis%spacing(last), walls(2))
    do i = first - 1, last
      axis%slope(i) = 1.0_dp/axis%width(i)
      axis%low(i) = 0.5_dp*graded_spacing(axis, i + 1)*axis%slope(i)
    end do
    if (walls(1)) axis%low(first - 1) = 1.0_dp - axis%low(first)
    if (walls(2)) axis%low(last) = 1.0_dp - axis%low(last - 1)
  end function graded_make

  !> Spacing H_I of the centres around a node.
  elemental function graded_spacing(axis, node) result(spacing)
    type(graded_axis_t), intent(in) :: axis
    integer, intent(in) :: node
    real(dp) :: spacing
    spacing = 1.0_dp
    if (axis%graded) spacing = axis%spacing(min(max(node, axis%first), axis%last))
  end function graded_spacing

  !> Distance h_c of the nodes around a centre.
  elemental function graded_width(axis, centre) result(width)
    type(graded_axis_t), intent(in) :: axis
    integer, intent(in) :: centre
    real(dp) :: width
    width = 1.0_dp
    if (axis%graded) width = axis%width(min(max(centre, axis%first - 1), axis%last))
  end function graded_width

  !> Place of a centre, from the origin.
  elemental function graded_centre(axis, centre) result(place)
    type(graded_axis_t), intent(in) :: axis
    integer, intent(in) :: centre
    real(dp) :: place
    integer :: c
    if (.not. axis%graded) then
      place = centre + 0.5_dp
    else
      c = min(max(centre, axis%first - 1), axis%last)
      place = axis%centre(c) + (centre - c)*graded_spacing(axis, centre)
    end if
  end function graded_centre

  !> Place of a node, midway between the centres around it, from the origin.
  elemental function graded_node(axis, node) result(place)
    type(graded_axis_t), intent(in) :: axis
    integer, intent(in) :: node
    real(dp) :: place
    place = node
    if (axis%graded) place = 0.5_dp*(graded_centre(axis, node - 1) + graded_centre(axis, node))
  end function graded_node

  !> Place of a coordinate, from the origin.
  elemental function graded_place(axis, x) result(place)
    type(graded_axis_t), intent(in) :: axis
    real(dp), intent(in) :: x            !! coordinate
    real(dp) :: place
    integer :: c
    place = x
    if (.not. axis%graded) return
    c = table_centre(axis, x)
    place = axis%centre(c) + (x - (c + 0.5_dp))*graded_spacing(axis, c + 1)
  end function graded_place

  !> What some coordinates lie between: the spacing of the centres around each, the coordinate of
  !! the lower of them and its place from the origin.
  pure subroutine graded_between(axis, n, x, spacing, lower, place)
    type(graded_axis_t), intent(in) :: axis
    integer, intent(in) :: n
    real(dp), intent(in) :: x(n)
    real(dp), intent(out) :: spacing(n), lower(n), place(n)
    real(dp) :: least, most, at
    integer :: i, c, first, last
    if (.not. axis%graded) then
      do i = 1, n
        lower(i) = floor(x(i) - 0.5_dp) + 0.5_dp
      end do
      spacing = 1.0_dp
      place = lower
      return
    end if
    first = axis%first
    last = axis%last
    least = real(first - 2, dp)
    most = real(last, dp)
    ! As table_centre and graded_spacing, written so that it becomes vectors.
    !$omp simd private(at, c)
    do i = 1, n
      at = min(max(x(i) - 0.5_dp, least), most)
      c = int(at)
      c = max(c - merge(1, 0, at < real(c, dp)), first - 1)
      spacing(i) = axis%spacing(min(c + 1, last))
      lower(i) = c + 0.5_dp
      place(i) = axis%centre(c)
    end do
  end subroutine graded_between

  !> Coordinate of a place.
  elemental function graded_coordinate(axis, place) result(x)
    type(graded_axis_t), intent(in) :: axis
    real(dp), intent(in) :: place        !! from the origin
    real(dp) :: x
    integer :: low, high, middle
    x = place
    if (.not. axis%graded) return
    low = axis%first - 1
    high = axis%last
    do while (high - low > 1)
      middle = (low + high)/2
      if (axis%centre(middle) <= place) then
        low = middle
      else
        high = middle
      end if
    end do
    if (axis%centre(high) <= place) low = high
    if (place < axis%centre(axis%first - 1)) low = axis%first - 2
    x = low + 0.5_dp + (place - graded_centre(axis, low))/graded_spacing(axis, low + 1)
  end function graded_coordinate

  !> Coordinate of what has moved from one some way along the axis.
  elemental function graded_advance(axis, x, way) result(moved)
    type(graded_axis_t), intent(in) :: axis
    real(dp), intent(in) :: x, way       !! coordinate; way (smallest cell)
    real(dp) :: moved
    real(dp) :: part, spacing
    integer :: c
    moved = x + way
    if (.not. axis%graded .or. abs(way) <= 0.0_dp) return
    c = table_centre(axis, x)
    spacing = graded_spacing(axis, c + 1)
    part = (x - (c + 0.5_dp)) + way/spacing
    do while (part >= 1.0_dp .and. c < axis%last)
      part = (part - 1.0_dp)*spacing
      c = c + 1
      spacing = graded_spacing(axis, c + 1)
      part = part/spacing
    end do
    do while (part < 0.0_dp .and. c >= axis%first)
      part = part*spacing
      c = c - 1
      spacing = graded_spacing(axis, c + 1)
      part = 1.0_dp + part/spacing
    end do
    moved = (c + 0.5_dp) + part
  end function graded_advance

  !> Centre at or below a coordinate, as far as the table goes.
  elemental function table_centre(axis, x) result(c)
    type(graded_axis_t), intent(in) :: axis
    real(dp), intent(in) :: x
    integer :: c
    c = floor(min(max(x - 0.5_dp, real(axis%first - 2, dp)), real(axis%last, dp)))
    c = max(c, axis%first - 1)
  end function table_centre

  !> Slopes 1/h_c of some centres, and the weights of their lower and upper nodes in what is read
  !! across the axis.
  pure subroutine graded_tables(axis, linear, first, n, slope, low, high)
    type(graded_axis_t), intent(in) :: axis
    logical, intent(in) :: linear        !! what is linear between the nodes; else their mean
    integer, intent(in) :: first, n      !! first centre, how many
    real(dp), intent(out) :: slope(n), low(n), high(n)
    integer :: i, c
    if (.not. axis%graded) then
      slope = 1.0_dp
      low = 0.5_dp
      high = 0.5_dp
      return
    end if
    if (first >= axis%first - 1 .and. first + n - 1 <= axis%last) then
      slope = axis%slope(first:first + n - 1)
      low = axis%low(first:first + n - 1)
      if (.not. linear) low = 0.5_dp
      high = 1.0_dp - low
      return
    end if
    do i = 1, n
      c = min(max(first + i - 1, axis%first - 1), axis%last)
      slope(i) = axis%slope(c)
      low(i) = axis%low(c)
      if (.not. linear) low(i) = 0.5_dp
      high(i) = 1.0_dp - low(i)
    end do
  end subroutine graded_tables

end module sgmp_graded_axis
