!> How many cells a body is thick, by the shapes that its card unites.
module sgmp_thickness
  use sgmp_kinds, only: dp, pi
  use sgmp_mesh, only: mesh_find, mesh_place, mesh_t, wall_free
  use sgmp_shapes, only: combine_union, shape_block, shape_cylinder, shape_ring, shape_sphere, &
                         shape_t, shapes_box, shapes_inside
  use sgmp_space, only: space_axisymmetric
  use sgmp_turn, only: infinite_length, turn_direction, turn_inverse
  implicit none
  private
  public :: body_thickness, body_width, length_along

  real(dp), parameter :: matters = 16.0_dp     !! cells: of thicker bodies nothing is said

contains

  !> Cells across the thinnest of the shapes that a body unites, those that are there where cells
  !! are unequal, but not more than what is left of them where something is cut out, or they have
  !! corners; huge where that has no end, or the shape is unknown. A wall continues a body that
  !! touches it, two walls without end.
  pure function body_thickness(shapes, mesh) result(cells)
    type(shape_t), allocatable, intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp) :: cells
    cells = thinnest(shapes, mesh, .true.)
    if (cells < huge(1.0_dp)) cells = cells/mesh%h
    if (.not. allocated(shapes) .or. mesh%ndim == 1) return
    if (.not. all(shapes%combine == combine_union .and. &
                  (shapes%kind == shape_block .or. shapes%kind == shape_cylinder .or. &
                   shapes%kind == shape_sphere .or. shapes%kind == shape_ring))) then
      cells = min(cells, local_thickness(shapes, mesh))
    end if
  end function body_thickness

  !> Cells along a direction in which a body has flat faces: cylinders and rings along their axis,
  !! and blocks, whose thickness counts in directions aslant; zero where it has other faces, huge
  !! where walls continue it without end.
  pure function length_along(shapes, mesh, direction) result(cells)
    type(shape_t), intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: direction(3)       !! of any length
    real(dp) :: cells, along(3)
    real(dp), parameter :: aligned = 0.995_dp  !! cosine: within 6 degrees
    integer :: s, axis
    cells = huge(1.0_dp)
    do s = 1, size(shapes)
      along = abs(turn_direction(turn_inverse(shapes(s)%turn), direction))
      select case (shapes(s)%kind)
      case (shape_block)
        axis = maxloc(along(:mesh%ndim), dim=1)
        if (along(axis) > aligned*norm2(along)) then
          cells = min(cells, block_length(shapes(s), mesh, axis, .true.))
        else
          cells = min(cells, shape_thickness(shapes(s), mesh, .true.))
        end if
      case (shape_cylinder, shape_ring)
        if (.not. dot_product(abs(shapes(s)%axis), along) > aligned*norm2(along)) cells = 0.0_dp
        cells = min(cells, cylinder_length(shapes(s), mesh, .true.))
      case default
        cells = 0.0_dp
      end select
    end do
    if (cells < huge(1.0_dp)) cells = cells/mesh%h
  end function length_along

  !> Cells across shapes that are combined, as three quarters of the body are at least: of points
  !! all over it the diameter of the largest ball inside that holds the point; the shortest chord
  !! through each of them is the diameter of one.
  pure function local_thickness(shapes, mesh) result(cells)
    type(shape_t), intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp) :: cells
    integer, parameter :: wanted = 100, tries = 60*wanted, bases(3) = [2, 3, 5]
    real(dp), parameter :: thin_part = 0.25_dp
    real(dp) :: lower(3), upper(3), point(3, wanted), centre(3, wanted)
    real(dp) :: across(wanted), of_point(wanted)
    integer :: i, axis, n
    cells = huge(1.0_dp)
    call shapes_box(shapes, lower, upper)
    if (any(abs([lower(:mesh%ndim), upper(:mesh%ndim)]) >= infinite_length)) return
    n = 0
    point = 0.0_dp
    do i = 1, tries
      do axis = 1, mesh%ndim
        point(axis, n + 1) = lower(axis) + &
                             (upper(axis) - lower(axis))*in_sequence(i, bases(axis))
      end do
      if (.not. shapes_inside(shapes, point(:, n + 1), mesh%ndim, 0.0_dp)) cycle
      n = n + 1
      call shortest_chord(shapes, mesh, point(:, n), centre(:, n), across(n))
      if (n == wanted) exit
    end do
    if (n == 0) return
    do i = 1, n
      of_point(i) = largest_ball(mesh, point(:, i), centre(:, :n), across(:n))
    end do
    cells = of_rank(of_point(:n), ceiling(thin_part*n))
    if (cells > matters) cells = huge(1.0_dp)
  end function local_thickness

  !> Diameter of the largest of some balls that holds a point.
  pure function largest_ball(mesh, point, centre, across) result(largest)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: point(3), centre(:, :), across(:)
    real(dp) :: largest
    real(dp), parameter :: slack = 1.05_dp
    integer :: i
    largest = 0.0_dp
    associate (sides => cell_sides(mesh, point))
      do i = 1, size(across)
        if (2.0_dp*norm2((point - centre(:, i))/sides) <= slack*across(i)) then
          largest = max(largest, across(i))
        end if
      end do
    end associate
  end function largest_ball

  !> The so manyth number of a list by size.
  pure function of_rank(numbers, rank) result(number)
    real(dp), intent(in) :: numbers(:)
    integer, intent(in) :: rank
    real(dp) :: number
    integer :: i
    number = numbers(1)
    do i = 1, size(numbers)
      number = numbers(i)
      if (count(numbers < number) < rank .and. count(numbers <= number) >= rank) return
    end do
  end function of_rank

  !> A number of van der Corput's sequence, between 0 and 1.
  pure function in_sequence(i, base) result(number)
    integer, intent(in) :: i, base
    real(dp) :: number, digit
    integer :: rest
    number = 0.0_dp
    digit = 1.0_dp/base
    rest = i
    do while (rest > 0)
      number = number + digit*mod(rest, base)
      rest = rest/base
      digit = digit/base
    end do
  end function in_sequence

  !> Length of the shortest chord through a point inside, in cells, and its middle.
  pure subroutine shortest_chord(shapes, mesh, point, middle, cells)
    type(shape_t), intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: point(3)
    real(dp), intent(out) :: middle(3), cells
    real(dp) :: direction(3), ways(2)
    integer, parameter :: plane = 16, space = 40
    integer :: d
    cells = huge(1.0_dp)
    middle = point
    do d = 1, merge(plane, space, mesh%ndim == 2)
      if (mesh%ndim == 2) then
        direction = [cos((d - 1)*pi/plane), sin((d - 1)*pi/plane), 0.0_dp]
      else
        direction = on_half_sphere(d, space)
      end if
      ways(1) = way_out(shapes, mesh, point, direction)
      if (ways(1) >= cells) cycle
      ways(2) = way_out(shapes, mesh, point, -direction)
      if (sum(ways) >= cells) cycle
      cells = sum(ways)
      middle = point + 0.5_dp*(ways(1) - ways(2))*direction/ &
               norm2(direction/cell_sides(mesh, point))
    end do
  end subroutine shortest_chord

  !> The axes, then directions that lie evenly on a half of the sphere, along a spiral.
  pure function on_half_sphere(d, n) result(direction)
    integer, intent(in) :: d, n
    real(dp) :: direction(3), height, radius
    real(dp), parameter :: golden = pi*(3.0_dp - sqrt(5.0_dp))
    direction = 0.0_dp
    if (d <= 3) then
      direction(d) = 1.0_dp
    else
      height = (d - 3.5_dp)/(n - 3)
      radius = sqrt(1.0_dp - height**2)
      direction = [radius*cos(d*golden), radius*sin(d*golden), height]
    end if
  end function on_half_sphere

  !> Cells from a point inside to where a straight line leaves the shapes, at most what matters.
  pure function way_out(shapes, mesh, point, direction) result(cells)
    type(shape_t), intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: point(3), direction(3)
    real(dp) :: cells, step, inside, outside, middle, sides(3)
    integer, parameter :: halvings = 5
    integer :: i
    sides = cell_sides(mesh, point)
    step = 0.5_dp/norm2(direction/sides)   ! half a cell
    inside = 0.0_dp
    outside = step
    do while (holds(shapes, mesh, point + outside*direction))
      inside = outside
      outside = outside + step
      if (inside > 2.0_dp*matters*step) exit
    end do
    do i = 1, halvings
      middle = 0.5_dp*(inside + outside)
      if (holds(shapes, mesh, point + middle*direction)) then
        inside = middle
      else
        outside = middle
      end if
    end do
    cells = 0.25_dp*(inside + outside)/step
  end function way_out

  !> Whether a place lies in the shapes, or in their image behind a wall or the axis.
  pure function holds(shapes, mesh, place) result(yes)
    type(shape_t), intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: place(3)
    logical :: yes
    real(dp) :: point(3), planes(2)
    integer :: axis
    point = place
    do axis = 1, mesh%ndim
      planes = mesh_place(mesh, axis, real([mesh%lower(axis), mesh%upper(axis)], dp))
      associate (x => point(axis), walls => mesh%wall(:, axis) /= wall_free)
        if (all(walls)) then                       ! images of images
          x = modulo(x - planes(1), 2.0_dp*(planes(2) - planes(1)))
          x = planes(1) + min(x, 2.0_dp*(planes(2) - planes(1)) - x)
        else if (walls(1)) then
          x = planes(1) + abs(x - planes(1))
        else if (walls(2)) then
          x = planes(2) - abs(x - planes(2))
        end if
      end associate
    end do
    if (mesh%space == space_axisymmetric) point(1) = abs(point(1))
    yes = shapes_inside(shapes, point, mesh%ndim, 0.0_dp)
  end function holds

  !> Sides of the cell about a place.
  pure function cell_sides(mesh, place) result(sides)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: place(3)
    real(dp) :: sides(3)
    integer :: axis
    sides = mesh%h
    do axis = 1, mesh%ndim
      if (.not. mesh%axes(axis)%graded) cycle
      sides(axis) = mesh%h/(mesh_find(mesh, axis, place(axis) + 0.5_dp*mesh%h) - &
                            mesh_find(mesh, axis, place(axis) - 0.5_dp*mesh%h))
    end do
  end function cell_sides

  !> The same as a length.
  pure function body_width(shapes, mesh) result(width)
    type(shape_t), allocatable, intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp) :: width
    width = thinnest(shapes, mesh, .false.)
  end function body_width

  !> Width of the thinnest of the shapes that a body unites; huge where there is none.
  pure function thinnest(shapes, mesh, in_cells) result(width)
    type(shape_t), allocatable, intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: in_cells              !! cells times the smallest side, not lengths
    real(dp) :: width
    integer :: s
    width = infinite_length
    if (allocated(shapes)) then
      do s = 1, size(shapes)
        if (shapes(s)%combine == combine_union) then
          width = min(width, shape_thickness(shapes(s), mesh, in_cells))
        end if
      end do
    end if
    if (.not. width < infinite_length) width = huge(1.0_dp)
  end function thinnest

  !> Least distance between opposite surfaces of a shape.
  pure function shape_thickness(shape, mesh, in_cells) result(thickness)
    type(shape_t), intent(in) :: shape
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: in_cells
    real(dp) :: thickness
    integer :: axis
    thickness = huge(1.0_dp)
    select case (shape%kind)
     case (shape_block)
      do axis = 1, mesh%ndim
        thickness = min(thickness, block_length(shape, mesh, axis, in_cells))
      end do
     case (shape_ring)
      thickness = round_width(shape, mesh, in_cells, shape%radius2, shape%radius)
     case (shape_cylinder)
      thickness = min(round_width(shape, mesh, in_cells, -shape%radius, shape%radius), &
                      cylinder_length(shape, mesh, in_cells))
     case default
      if (shape%radius > 0.0_dp) then
        thickness = round_width(shape, mesh, in_cells, -shape%radius, shape%radius)
      end if
    end select
  end function shape_thickness

  !> Length of a block along an axis, with its image behind a wall that it touches; huge between
  !! two walls.
  pure function block_length(shape, mesh, axis, in_cells) result(length)
    type(shape_t), intent(in) :: shape
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    logical, intent(in) :: in_cells
    real(dp) :: length
    length = span(mesh, in_cells, axis, shape%lower(axis), shape%upper(axis))
    if (at_wall(mesh, 1, axis, shape%lower(axis))) length = 2.0_dp*length
    if (at_wall(mesh, 2, axis, shape%upper(axis))) then
      length = merge(huge(1.0_dp), 2.0_dp*length, at_wall(mesh, 1, axis, shape%lower(axis)))
    end if
  end function block_length

  !> Distance of two places along an axis, as cells times the smallest side if asked for.
  pure function span(mesh, in_cells, axis, low, high) result(width)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: in_cells
    integer, intent(in) :: axis
    real(dp), intent(in) :: low, high
    real(dp) :: width
    width = high - low
    if (.not. (in_cells .and. mesh%axes(axis)%graded)) return
    if (max(abs(low), abs(high)) < infinite_length) then
      width = mesh%h*(mesh_find(mesh, axis, high) - mesh_find(mesh, axis, low))
    end if
  end function span

  !> Least width of a round shape between two radii, along the axes across which it is round.
  pure function round_width(shape, mesh, in_cells, inner, outer) result(width)
    type(shape_t), intent(in) :: shape
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: in_cells
    real(dp), intent(in) :: inner, outer
    real(dp) :: width
    integer :: axis
    width = outer - inner
    if (.not. mesh%graded) return
    width = huge(1.0_dp)
    do axis = 1, mesh%ndim
      if (shape%kind == shape_cylinder .and. abs(shape%axis(axis)) > 0.5_dp) cycle
      width = min(width, span(mesh, in_cells, axis, shape%centre(axis) + inner, &
                              shape%centre(axis) + outer))
    end do
  end function round_width

  !> Length of a cylinder, with its image behind a wall that an end touches; huge where both do, or
  !! where the cylinder is the section of an endless one.
  pure function cylinder_length(shape, mesh, in_cells) result(length)
    type(shape_t), intent(in) :: shape
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: in_cells
    real(dp) :: length, ends(2)
    logical :: touches(2)
    integer :: axis
    length = huge(1.0_dp)
    if (norm2(shape%axis(:mesh%ndim)) <= 0.0_dp) return
    length = shape%length
    axis = findloc(abs(shape%axis(:mesh%ndim)) > 1.0_dp - 1.0e-9_dp, .true., 1)
    if (axis == 0 .or. .not. length < infinite_length) return
    ends = shape%centre(axis) + [0.0_dp, shape%axis(axis)*length]
    length = span(mesh, in_cells, axis, minval(ends), maxval(ends))
    touches = [at_wall(mesh, 1, axis, minval(ends)), at_wall(mesh, 2, axis, maxval(ends))]
    length = merge(huge(1.0_dp), merge(2.0_dp, 1.0_dp, any(touches))*length, all(touches))
  end function cylinder_length

  !> Whether a coordinate lies on a wall, but for a hundredth of a cell.
  pure function at_wall(mesh, side, axis, x) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: side, axis
    real(dp), intent(in) :: x
    logical :: yes
    integer :: node
    node = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
    yes = mesh%wall(side, axis) /= wall_free
    if (yes) yes = abs(mesh_place(mesh, axis, real(node, dp)) - x) < 0.01_dp*mesh%h
  end function at_wall

end module sgmp_thickness
