!> Whether shapes are their own mirror images, are the same all along an axis, or are round about
!! one. Where that is not plain to see the answer is no.
module sgmp_shape_symmetry
  use sgmp_kinds, only: dp
  use sgmp_shapes, only: combine_difference, combine_intersection, shape_block, shape_cylinder, &
                         shape_halfspace, shape_polygon, shape_ring, shape_sphere, shape_t, &
                         shapes_box
  use sgmp_turn, only: turn_turns
  implicit none
  private
  public :: shapes_mirrored, shapes_revolved, shapes_uniform

  real(dp), parameter :: straight = 1.0e-9_dp  !! by which a direction may miss an axis

contains

  !> Whether each shape is its own mirror image in a plane across an axis.
  pure function shapes_mirrored(shapes, axis, plane, slack) result(yes)
    type(shape_t), intent(in) :: shapes(:)
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane, slack  !! place along the axis; what does not count (length)
    logical :: yes
    integer :: s
    yes = .true.
    do s = 1, size(shapes)
      yes = yes .and. mirrored(shapes(s), axis, plane, slack)
    end do
  end function shapes_mirrored

  pure function mirrored(shape, axis, plane, slack) result(yes)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane, slack
    logical :: yes, across
    yes = .false.
    if (turn_turns(shape%turn)) return
    across = abs(shape%axis(axis)) <= straight
    select case (shape%kind)
    case (shape_block)
      yes = middle_at(shape%lower(axis), shape%upper(axis))
    case (shape_sphere)
      yes = middle_at(shape%centre(axis), shape%centre(axis))
    case (shape_halfspace)
      yes = across
    case (shape_polygon)
      if (axis == 3) then
        yes = middle_at(shape%centre(3), shape%centre(3) + shape%length)
      else
        yes = corners_mirrored(shape%corner(:, :shape%corners), axis, plane, slack)
      end if
    case default
      yes = across .and. middle_at(shape%centre(axis), shape%centre(axis))
      if (yes .or. .not. any(shape%kind == [shape_cylinder, shape_ring])) return
      yes = along(shape, axis) .and. middle_at(shape%centre(axis), shape%centre(axis) + &
                                               shape%axis(axis)*shape%length)
    end select
  contains
    !> Whether the plane lies midway.
    pure function middle_at(low, high) result(so)
      real(dp), intent(in) :: low, high
      logical :: so
      so = abs(0.5_dp*(low + high) - plane) <= slack
    end function middle_at
  end function mirrored

  !> Whether a polygon is its own image: round it the other way its corners are the images.
  pure function corners_mirrored(corner, axis, plane, slack) result(yes)
    real(dp), intent(in) :: corner(:, :)  !! (x|y, corner)
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane, slack
    logical :: yes
    real(dp) :: image(2)
    integer :: i, start, n
    n = size(corner, 2)
    yes = .false.
    do start = 1, n
      yes = .true.
      do i = 1, n
        image = corner(:, i)
        image(axis) = 2.0_dp*plane - image(axis)
        yes = yes .and. all(abs(image - corner(:, modulo(start - i, n) + 1)) <= 2.0_dp*slack)
      end do
      if (yes) return
    end do
  end function corners_mirrored

  !> Whether each shape is the same all the way from one end to the other along an axis.
  pure function shapes_uniform(shapes, axis, ends, slack) result(yes)
    type(shape_t), intent(in) :: shapes(:)
    integer, intent(in) :: axis
    real(dp), intent(in) :: ends(2), slack  !! (length)
    logical :: yes
    integer :: s
    yes = .true.
    do s = 1, size(shapes)
      yes = yes .and. uniform(shapes(s), axis, ends, slack)
    end do
  end function shapes_uniform

  pure function uniform(shape, axis, ends, slack) result(yes)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    real(dp), intent(in) :: ends(2), slack
    logical :: yes
    real(dp) :: reach(2)
    yes = .false.
    if (turn_turns(shape%turn)) return
    select case (shape%kind)
    case (shape_halfspace)
      yes = abs(shape%axis(axis)) <= straight
      return
    case (shape_block)
      reach = [shape%lower(axis), shape%upper(axis)]
    case (shape_polygon)
      if (axis /= 3) return
      reach = shape%centre(3) + [0.0_dp, shape%length]
    case (shape_cylinder, shape_ring)
      if (.not. along(shape, axis)) return
      reach = shape%centre(axis) + shape%axis(axis)*[0.0_dp, shape%length]
    case default
      return
    end select
    yes = minval(reach) <= ends(1) + slack .and. maxval(reach) >= ends(2) - slack
  end function uniform

  !> Whether shapes make a body of revolution about a line along an axis, but for cuts along planes
  !! through the line, of which only what lies in walls there counts.
  pure function shapes_revolved(shapes, axis, line, walls, slack) result(yes)
    type(shape_t), intent(in) :: shapes(:)
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3)      !! a point of it (length)
    logical, intent(in) :: walls(2, 3)   !! (lower|upper, axis): a wall lies in the line
    real(dp), intent(in) :: slack        !! (length)
    logical :: yes
    real(dp) :: low(3), high(3)
    integer :: s
    call shapes_box(shapes, low, high)
    yes = .true.
    do s = 1, size(shapes)
      if (revolved(shapes(s), axis, line, slack)) cycle
      yes = yes .and. cuts(shapes(s), axis, line, walls, reshape([low, high], [3, 2]), slack)
    end do
  end function shapes_revolved

  !> Whether a shape takes away no more than what lies behind walls.
  pure function cuts(shape, axis, line, walls, box, slack) result(yes)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3), slack
    logical, intent(in) :: walls(2, 3)   !! (lower|upper, axis)
    real(dp), intent(in) :: box(3, 2)    !! of the body, (axis, lower|upper) (length)
    logical :: yes
    integer :: a
    yes = .false.
    if (turn_turns(shape%turn)) return
    if (shape%kind == shape_halfspace .and. shape%combine == combine_difference) then
      do a = 1, 3
        if (a == axis .or. .not. along(shape, a)) cycle
        yes = walls(merge(1, 2, shape%axis(a) > 0.0_dp), a) .and. &
              abs(shape%centre(a) - line(a)) <= slack
      end do
    else if (shape%kind == shape_block .and. shape%combine == combine_intersection) then
      yes = .true.
      do a = 1, 3
        if (a == axis) cycle
        yes = yes .and. leaves_side(shape%lower(a), walls(1, a), line(a), box(a, 1), slack) .and. &
              leaves_side(-shape%upper(a), walls(2, a), -line(a), -box(a, 2), slack)
      end do
    end if
  end function cuts

  !> Whether a block that begins at a place leaves all of a body, or all from a wall in the line on.
  pure function leaves_side(lower, wall, line, body, slack) result(yes)
    real(dp), intent(in) :: lower, line, body, slack  !! of the block, the line, the body (length)
    logical, intent(in) :: wall
    logical :: yes
    yes = lower <= body + slack .or. (wall .and. abs(lower - line) <= slack)
  end function leaves_side

  pure function revolved(shape, axis, line, slack) result(yes)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3), slack
    logical :: yes
    real(dp) :: off(3)
    yes = .false.
    if (turn_turns(shape%turn)) return
    off = abs(shape%centre - line)
    off(axis) = 0.0_dp
    select case (shape%kind)
    case (shape_block, shape_polygon)
      return
    case (shape_sphere)
      yes = all(off <= slack)
    case (shape_halfspace)
      yes = along(shape, axis)
    case default
      yes = along(shape, axis) .and. all(off <= slack)
    end select
  end function revolved

  !> Whether a shape's own axis lies along one of the grid's.
  pure function along(shape, axis) result(yes)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    logical :: yes
    yes = abs(shape%axis(axis)) > 1.0_dp - straight
  end function along

end module sgmp_shape_symmetry
