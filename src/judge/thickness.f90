!> How many cells a body is thick, by the shapes that its card unites.
module sgmp_thickness
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_find, mesh_place, mesh_t, wall_free
  use sgmp_shapes, only: combine_union, shape_block, shape_cylinder, shape_ring, shape_t
  use sgmp_turn, only: infinite_length
  implicit none
  private
  public :: body_thickness, body_width

contains

  !> Cells across the thinnest of the shapes that a body unites, those that are there where cells
  !! are unequal; huge where that has no end, or the shape is unknown. A wall continues a body that
  !! touches it, two walls without end.
  pure function body_thickness(shapes, mesh) result(cells)
    type(shape_t), allocatable, intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp) :: cells
    cells = thinnest(shapes, mesh, .true.)
    if (cells < huge(1.0_dp)) cells = cells/mesh%h
  end function body_thickness

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
    real(dp) :: thickness, across
    integer :: axis
    thickness = huge(1.0_dp)
    select case (shape%kind)
     case (shape_block)
      do axis = 1, mesh%ndim
        across = span(mesh, in_cells, axis, shape%lower(axis), shape%upper(axis))
        if (at_wall(mesh, 1, axis, shape%lower(axis))) across = 2.0_dp*across
        if (at_wall(mesh, 2, axis, shape%upper(axis))) then
          across = merge(huge(1.0_dp), 2.0_dp*across, at_wall(mesh, 1, axis, shape%lower(axis)))
        end if
        thickness = min(thickness, across)
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
