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
    pure logical function middle_at(low, high)
      real(dp), intent(in) :: low, high
      middle_at = abs(0.5_dp*(low + high) - plane) <= slack
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
      yes = yes .and. cuts(shapes(s))
    end do
  contains
    !> Whether a shape takes away no more than what lies behind walls.
    pure function cuts(shape) result(so)
      type(shape_t), intent(in) :: shape
      logical :: so
      integer :: b, side
      so = .false.
      if (turn_turns(shape%turn)) return
      if (shape%kind == shape_halfspace .and. shape%combine == combine_difference) then
        do b = 1, 3
          if (b == axis .or. .not. along(shape, b)) cycle
          side = merge(1, 2, shape%axis(b) > 0.0_dp)
          so = walls(side, b) .and. abs(shape%centre(b) - line(b)) <= slack
        end do
      else if (shape%kind == shape_block .and. shape%combine == combine_intersection) then
        so = .true.
        do b = 1, 3
          if (b == axis) cycle
          so = so .and. (shape%lower(b) <= low(b) + slack .or. &
                         (walls(1, b) .and. abs(shape%lower(b) - line(b)) <= slack)) .and. &
               (shape%upper(b) >= high(b) - slack .or. &
                (walls(2, b) .and. abs(shape%upper(b) - line(b)) <= slack))
        end do
      end if
    end function cuts
  end function shapes_revolved

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
