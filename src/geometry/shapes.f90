!> Shapes of constructive solid geometry: whether a point lies in their combination, how deep below
!! its surface, and the box around it.
!!
!! Contact measures distances between surfaces, not between lattices of particles: a sphere of
!! cubes is a polyhedron with flat facets, and would neither roll nor touch where it should.
!!
!! A further shape is a number, its name, and a `case` in `in_shape`, `shape_depth` and `shape_box`;
!! the deck takes the name from here. Each may be turned by itself.
module sgmp_shapes
  use sgmp_kinds, only: dp, pi
  use sgmp_polygon, only: polygon_depth, polygon_holds
  use sgmp_turn, only: infinite_length, turn_back, turn_box, turn_direction, turn_moved, &
                       turn_t, turn_turns
  implicit none
  private
  public :: rim_depth, shape_t, surface_depth, shapes_anchor, shapes_box, shapes_cover, &
            shapes_flat, shapes_inside, shape_planes, shapes_near, shapes_rim, shapes_volume, &
            shape_moved
  public :: shape_block, shape_cylinder, shape_sphere, shape_ring, shape_cone, shape_ogive, &
    shape_halfspace, shape_polygon, shape_revolved, shape_names, most_corners
  public :: combine_union, combine_difference, combine_intersection, combine_names

  integer, parameter :: shape_block = 1, shape_cylinder = 2, shape_sphere = 3, shape_ring = 4, &
    shape_cone = 5, shape_ogive = 6, shape_halfspace = 7, shape_polygon = 8, &
    shape_revolved = 9
  character(9), parameter :: shape_names(*) = [character(9) :: &
    'block', 'cylinder', 'sphere', 'ring', 'cone', 'ogive', 'halfspace', 'polygon', &
    'revolved']
  integer, parameter :: combine_union = 1, combine_difference = 2, combine_intersection = 3
  character(9), parameter :: combine_names(*) = [character(9) :: 'add', 'subtract', 'intersect']
  integer, parameter :: most_corners = 64  !! of a polygon

  !> One primitive of constructive solid geometry.
  type :: shape_t
    integer :: kind = shape_block
    integer :: combine = combine_union
    real(dp) :: lower(3) = 0.0_dp, upper(3) = 0.0_dp  !! block: corners
    real(dp) :: centre(3) = 0.0_dp
      !! sphere, ring, half-space point; base centre of cylinder, cone, ogive, polygon; where the
      !! axis of a revolved polygon begins
    real(dp) :: axis(3) = [0.0_dp, 0.0_dp, 1.0_dp]
      !! unit axis of cylinder, ring, cone, ogive, revolved polygon; outward normal of a half-space
    real(dp) :: radius = 0.0_dp, radius2 = 0.0_dp     !! outer; inner (ring), top (cone)
    real(dp) :: length = 0.0_dp                       !! along the axis (huge: infinite, as in 2D)
    integer :: corners = 0
    real(dp) :: corner(2, most_corners) = 0.0_dp
      !! polygon: in order round it, either way; revolved: distances from and along the axis
    type(turn_t) :: turn                              !! after all that
  end type shape_t

contains

  !> Whether a point lies in a combination of shapes; lower boundaries belong to a shape, upper ones
  !! do not.
  pure function shapes_inside(shapes, point, ndim, margin) result(inside)
    type(shape_t), intent(in) :: shapes(:)   !! combined in order
    real(dp), intent(in) :: point(3)         !! before the body is turned
    integer, intent(in) :: ndim
    real(dp), intent(in) :: margin           !! by which boundaries are moved down
    logical :: inside
    integer :: i
    inside = .false.
    do i = 1, size(shapes)
      select case (shapes(i)%combine)
      case (combine_union)
        inside = inside .or. in_shape(shapes(i), point, ndim, margin)
      case (combine_difference)
        inside = inside .and. .not. in_shape(shapes(i), point, ndim, margin)
      case default  ! combine_intersection
        inside = inside .and. in_shape(shapes(i), point, ndim, margin)
      end select
    end do
  end function shapes_inside

  !> Distance to the surface of a combination of shapes, positive inside. Exact inside of a union
  !! or an intersection's faces and edges; where shapes are combined, a lower bound.
  pure function surface_depth(shapes, point, ndim) result(depth)
    type(shape_t), intent(in) :: shapes(:)  !! combined in order
    real(dp), intent(in) :: point(3)        !! before the body is turned
    integer, intent(in) :: ndim
    real(dp) :: depth
    integer :: i
    depth = -huge(1.0_dp)
    do i = 1, size(shapes)
      select case (shapes(i)%combine)
      case (combine_union)
        depth = max(depth, shape_depth(shapes(i), point, ndim))
      case (combine_difference)
        depth = min(depth, -shape_depth(shapes(i), point, ndim))
      case (combine_intersection)
        depth = min(depth, shape_depth(shapes(i), point, ndim))
      case default  ! the list is complete
      end select
    end do
  end function surface_depth

  !> The part of a small box that a combination of shapes covers, 0 to 1: exact for a block along
  !! the axes, for others nearly so in the mean over all places of the box. Two shapes that are
  !! united cover more together than each where the middle lies in one of them only.
  pure function shapes_cover(shapes, middle, sides, ndim) result(part)
    type(shape_t), intent(in) :: shapes(:)   !! combined in order
    real(dp), intent(in) :: middle(3)        !! before the body is turned
    real(dp), intent(in) :: sides(3)         !! of the box (length)
    integer, intent(in) :: ndim
    real(dp) :: part, of_shape
    integer :: i
    part = 0.0_dp
    do i = 1, size(shapes)
      of_shape = shape_cover(shapes(i), middle, sides, ndim)
      select case (shapes(i)%combine)
      case (combine_union)
        if ((part > 0.5_dp) .neqv. (of_shape > 0.5_dp)) then
          part = min(1.0_dp, part + of_shape)
        else
          part = max(part, of_shape)
        end if
      case (combine_difference)
        part = min(part, 1.0_dp - of_shape)
      case default  ! combine_intersection
        part = min(part, of_shape)
      end select
    end do
  end function shapes_cover

  !> The same of one shape. Its surface is taken for a plane, a box for a cube of its least side.
  pure function shape_cover(shape, middle, sides, ndim) result(part)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: middle(3), sides(3)
    integer, intent(in) :: ndim
    real(dp) :: part, common(3)
    if (shape%kind == shape_block .and. .not. turn_turns(shape%turn)) then
      common = min(shape%upper, middle + 0.5_dp*sides) - max(shape%lower, middle - 0.5_dp*sides)
      part = product(max(0.0_dp, common(:ndim))/sides(:ndim))
    else
      part = 0.5_dp + shape_depth(shape, middle, ndim)/minval(sides(:ndim))
      part = min(1.0_dp, max(0.0_dp, part))
    end if
  end function shape_cover

  !> Those shapes, in their order, that decide about the points of a box: united or subtracted ones
  !! that lie elsewhere are left out.
  pure function shapes_near(shapes, lower, upper, ndim) result(near)
    type(shape_t), intent(in) :: shapes(:)
    real(dp), intent(in) :: lower(3), upper(3)  !! corners, with a margin for what touches
    integer, intent(in) :: ndim
    type(shape_t), allocatable :: near(:)
    real(dp) :: low(3), high(3), slack(3)
    logical :: decides(size(shapes))
    integer :: i
    do i = 1, size(shapes)
      call shape_box(shapes(i), low, high)
      slack = 16.0_dp*epsilon(1.0_dp)*max(abs(low), abs(high))
      decides(i) = all(low(:ndim) <= upper(:ndim) + slack(:ndim) .and. &
                       high(:ndim) >= lower(:ndim) - slack(:ndim)) .or. &
                   shapes(i)%combine == combine_intersection
    end do
    near = pack(shapes, decides)
  end function shapes_near

  !> The box around the shapes that are united; the others only take away.
  pure subroutine shapes_box(shapes, lower, upper)
    type(shape_t), intent(in) :: shapes(:)
    real(dp), intent(out) :: lower(3), upper(3)
    real(dp) :: low(3), high(3)
    integer :: i
    lower = huge(1.0_dp)
    upper = -huge(1.0_dp)
    do i = 1, size(shapes)
      if (shapes(i)%combine /= combine_union) cycle
      call shape_box(shapes(i), low, high)
      lower = min(lower, low)
      upper = max(upper, high)
    end do
  end subroutine shapes_box

  !> Volume of a combination of shapes from parts of small blocks that they cover, exact for a
  !! block; of sections in a half-plane, that of the body of revolution.
  pure function shapes_volume(shapes, ndim, points, rings) result(volume)
    type(shape_t), intent(in) :: shapes(:)
    integer, intent(in) :: ndim
    integer, intent(in) :: points          !! along each axis
    logical, intent(in), optional :: rings  !! only x > 0 counts, and by its way about x = 0
    real(dp) :: volume, lower(3), upper(3), step(3), point(3), from(3), to(3), cover, covered, ways
    type(shape_t), allocatable :: near(:)
    integer :: n(3), i, j, k
    call shapes_box(shapes, lower, upper)
    n = 1
    n(:ndim) = points
    lower(ndim + 1:) = 0.0_dp
    upper(ndim + 1:) = 0.0_dp
    step = (upper - lower)/n
    covered = 0.0_dp
    ways = 0.0_dp
    do k = 1, n(3)
      do j = 1, n(2)
        from = lower + step*([0, j - 1, k - 1])
        to = from + step
        to(1) = upper(1)
        near = shapes_near(shapes, from, to, ndim)
        do i = 1, n(1)
          point = lower + step*([i, j, k] - 0.5_dp)
          cover = shapes_cover(near, point, step, ndim)
          covered = covered + cover
          ways = ways + 2.0_dp*pi*max(point(1), 0.0_dp)*cover
        end do
      end do
    end do
    volume = covered*product(step(:ndim))
    if (present(rings)) then
      if (rings) volume = ways*product(step(:ndim))
    end if
  end function shapes_volume

  !> A point where a lattice that fills the shapes has a corner: the first shape's lower corner;
  !! round shapes have their axis (a sphere its centre) there, so that particles lie symmetrically
  !! about it.
  pure function shapes_anchor(shapes) result(anchor)
    type(shape_t), intent(in) :: shapes(:)
    real(dp) :: anchor(3), lower(3), upper(3)
    associate (shape => shapes(1))
      call shape_box(shape, lower, upper)
      anchor = lower
      if (any(shape%kind == [shape_block, shape_polygon])) return
      anchor = shape%centre
      if (shape%kind == shape_sphere) return
      if (shape%length >= infinite_length) return
      ! along its own direction the lattice starts at the lower end
      where (abs(shape%axis) > 1.0_dp - 1.0e-12_dp) anchor = lower
    end associate
  end function shapes_anchor

  !> Whether all that looks along an axis, of shapes before their body is turned, are planes across
  !! it, as far as their kinds tell: blocks, half-spaces along an axis, ends of cylinders.
  pure function shapes_flat(shapes, axis) result(flat)
    type(shape_t), intent(in) :: shapes(:)
    integer, intent(in) :: axis
    logical :: flat
    real(dp), parameter :: along = 1.0_dp - 1.0e-12_dp
    integer :: i
    flat = .false.
    do i = 1, size(shapes)
      associate (shape => shapes(i))
        if (turn_turns(shape%turn)) return
        select case (shape%kind)
        case (shape_block)
          cycle
        case (shape_halfspace)
          if (maxval(abs(shape%axis)) < along) return
        case (shape_cylinder, shape_ring, shape_polygon)
          if (abs(shape%axis(axis)) < along) return
        case default
          return
        end select
      end associate
    end do
    flat = .true.
  end function shapes_flat

  !> The two planes across an axis along which a shape is flat; huge where there is none.
  pure function shape_planes(shape, axis) result(places)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    real(dp) :: places(2)
    real(dp) :: lower(3), upper(3)
    if (shape%kind == shape_halfspace) then
      places = [-huge(1.0_dp), huge(1.0_dp)]
      if (shape%axis(axis) > 0.5_dp) places(2) = shape%centre(axis)
      if (shape%axis(axis) < -0.5_dp) places(1) = shape%centre(axis)
      return
    end if
    call shape_box(shape, lower, upper)
    places = [lower(axis), upper(axis)]
  end function shape_planes

  !> The same shape elsewhere.
  pure function shape_moved(shape, by) result(moved)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: by(3)
    type(shape_t) :: moved
    moved = shape
    moved%lower = shape%lower + by
    moved%upper = shape%upper + by
    moved%centre = shape%centre + by
    if (shape%kind == shape_polygon) moved%corner = shape%corner + spread(by(:2), 2, most_corners)
    moved%turn = turn_moved(shape%turn, by)
  end function shape_moved

  pure function in_shape(shape, place, ndim, margin) result(inside)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: place(3), margin
    integer, intent(in) :: ndim
    logical :: inside
    real(dp) :: point(3), along
    point = place
    call turn_back(shape%turn, point)
    select case (shape%kind)
    case (shape_block)
      inside = all(point(:ndim) >= shape%lower(:ndim) - margin .and. &
                   point(:ndim) < shape%upper(:ndim) - margin)
    case (shape_polygon)
      inside = polygon_holds(shape%corner(:, :shape%corners), point(:2) + margin)
      along = point(3) - shape%centre(3)
      if (ndim == 3) inside = inside .and. along >= -margin .and. along < shape%length - margin
    case (shape_halfspace)
      inside = dot_product(point - shape%centre, shape%axis) < -margin
    case (shape_sphere)
      inside = norm2(point - shape%centre) <= shape%radius + margin
    case default
      along = dot_product(point - shape%centre, shape%axis)
      inside = in_round(shape, norm2(point - shape%centre - along*shape%axis), along, margin)
    end select
  end function in_shape

  !> Whether a point lies in a shape about an axis.
  pure function in_round(shape, radius, along, margin) result(inside)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: radius, along, margin  !! distances from the axis and along it
    logical :: inside
    real(dp) :: outer
    if (shape%kind == shape_revolved) then
      inside = polygon_holds(shape%corner(:, :shape%corners), [radius, along + margin])
      return
    end if
    inside = along >= -margin .and. along < shape%length - margin
    if (.not. inside) return
    outer = shape%radius
    if (shape%kind == shape_cone .and. shape%length < infinite_length) then
      outer = shape%radius + (shape%radius2 - shape%radius)*along/shape%length
    else if (shape%kind == shape_ogive .and. shape%length < infinite_length) then
      outer = ogive_radius(shape, along)
    end if
    inside = radius <= outer + margin
    if (shape%kind == shape_ring) inside = inside .and. radius >= shape%radius2 - margin
  end function in_round

  !> Tangent ogive: an arc that leaves the base at a right angle and ends in the tip.
  pure function ogive_radius(shape, along) result(radius)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: along  !! distance from the base
    real(dp) :: radius, arc
    arc = ogive_arc(shape)
    radius = sqrt(max(0.0_dp, arc**2 - along**2)) - (arc - shape%radius)
  end function ogive_radius

  !> Radius of an ogive's arc.
  pure function ogive_arc(shape) result(arc)
    type(shape_t), intent(in) :: shape
    real(dp) :: arc
    arc = (shape%radius**2 + shape%length**2)/(2.0_dp*shape%radius)
  end function ogive_arc

  !> Distance to the surface of one shape, positive inside.
  pure function shape_depth(shape, place, ndim) result(depth)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: place(3)
    integer, intent(in) :: ndim
    real(dp) :: depth
    real(dp) :: point(3), along, radius, slant, arc
    point = place
    call turn_back(shape%turn, point)
    if (shape%kind == shape_block) then
      depth = min(minval(point(:ndim) - shape%lower(:ndim)), &
                  minval(shape%upper(:ndim) - point(:ndim)))
      return
    end if
    if (shape%kind == shape_polygon) then
      depth = polygon_depth(shape%corner(:, :shape%corners), point(:2), .false.)
      along = point(3) - shape%centre(3)
      if (ndim == 3) depth = min(depth, along, shape%length - along)
      return
    end if
    along = dot_product(point - shape%centre, shape%axis)
    if (shape%kind == shape_halfspace) then
      depth = -along
      return
    end if
    if (shape%kind == shape_sphere) then
      depth = shape%radius - norm2(point - shape%centre)
      return
    end if
    radius = norm2(point - shape%centre - along*shape%axis)
    if (shape%kind == shape_revolved) then
      depth = polygon_depth(shape%corner(:, :shape%corners), [radius, along], .true.)
      return
    end if
    select case (shape%kind)
    case (shape_cone)
      slant = (shape%radius2 - shape%radius)/shape%length
      depth = (shape%radius + slant*along - radius)/sqrt(1.0_dp + slant**2)
    case (shape_ogive)
      arc = ogive_arc(shape)
      depth = arc - sqrt(along**2 + (radius + (arc - shape%radius))**2)
    case (shape_ring)
      depth = min(shape%radius - radius, radius - shape%radius2)
    case default
      depth = shape%radius - radius
    end select
    if (any(abs(shape%axis(:ndim)) > 0.0_dp)) depth = min(depth, along, shape%length - along)
  end function shape_depth

  !> Whether the outside of shapes is that of a ball, or as seen along a direction the round side of
  !! a cylinder or a tube, whatever is taken out of it.
  pure function shapes_rim(shapes, direction, along) result(yes)
    type(shape_t), intent(in) :: shapes(:)
    real(dp), intent(in) :: direction(3)         !! before the body is turned
    real(dp), intent(in) :: along                !! most of it along the axis of these
    logical :: yes
    yes = .false.
    if (size(shapes) == 0) return
    if (any(shapes(2:)%combine /= combine_difference)) return
    select case (shapes(1)%kind)
    case (shape_sphere)
      yes = .true.
    case (shape_cylinder, shape_ring)
      yes = abs(dot_product(turn_direction(shapes(1)%turn, shapes(1)%axis), direction)) <= along
    case default
      yes = .false.
    end select
  end function shapes_rim

  !> Distance to the round outside of a ball, a cylinder or a tube, positive inside.
  pure function rim_depth(shape, place) result(depth)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: place(3)
    real(dp) :: depth
    real(dp) :: from(3)
    from = place
    call turn_back(shape%turn, from)
    from = from - shape%centre
    if (shape%kind /= shape_sphere) from = from - dot_product(from, shape%axis)*shape%axis
    depth = shape%radius - norm2(from)
  end function rim_depth

  pure subroutine shape_box(shape, lower, upper)
    type(shape_t), intent(in) :: shape
    real(dp), intent(out) :: lower(3), upper(3)
    select case (shape%kind)
    case (shape_block)
      lower = shape%lower
      upper = shape%upper
    case (shape_sphere)
      lower = shape%centre - shape%radius
      upper = shape%centre + shape%radius
    case (shape_halfspace)
      lower = -huge(1.0_dp)
      upper = huge(1.0_dp)
    case (shape_polygon)
      lower = [minval(shape%corner(:, :shape%corners), dim=2), shape%centre(3)]
      upper = [maxval(shape%corner(:, :shape%corners), dim=2), shape%centre(3) + shape%length]
    case default
      call round_box(shape, lower, upper)
    end select
    call turn_box(shape%turn, lower, upper)
  end subroutine shape_box

  !> The box around what is round about an axis.
  pure subroutine round_box(shape, lower, upper)
    type(shape_t), intent(in) :: shape
    real(dp), intent(out) :: lower(3), upper(3)
    real(dp) :: radius, reach(3), ends(3, 2)
    integer :: i
    if (shape%kind == shape_revolved) then
      associate (corners => shape%corner(:, :shape%corners))
        radius = maxval(corners(1, :))
        ends(:, 1) = shape%centre + shape%axis*minval(corners(2, :))
        ends(:, 2) = shape%centre + shape%axis*maxval(corners(2, :))
      end associate
    else
      radius = max(shape%radius, merge(shape%radius2, 0.0_dp, shape%kind == shape_cone))
      ends = spread(shape%centre, 2, 2)
      do i = 1, 3
        if (abs(shape%axis(i)) > epsilon(1.0_dp)) ends(i, 2) = end_along(shape, i)
      end do
    end if
    reach = radius*sqrt(max(0.0_dp, 1.0_dp - shape%axis**2))
    lower = minval(ends, dim=2) - reach
    upper = maxval(ends, dim=2) + reach
  end subroutine round_box

  pure function end_along(shape, axis) result(coordinate)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    real(dp) :: coordinate
    coordinate = sign(huge(1.0_dp), shape%axis(axis))
    if (shape%length < infinite_length) coordinate = shape%centre(axis) + &
                                                     shape%axis(axis)*shape%length
  end function end_along

end module sgmp_shapes
