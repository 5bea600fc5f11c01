!> How many cells a body is thick, by the shapes that its card unites.
module sgmp_thickness
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_shapes, only: combine_union, shape_block, shape_cylinder, shape_ring, shape_t
  use sgmp_turn, only: infinite_length
  implicit none
  private
  public :: body_thickness

contains

  !> Cells across the thinnest of the shapes that a body unites; huge where that has no end, or the
  !! shape is unknown. A wall continues a body that touches it, two walls without end.
  pure function body_thickness(shapes, mesh) result(cells)
    type(shape_t), allocatable, intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp) :: cells
    real(dp) :: thinnest
    integer :: s
    cells = huge(1.0_dp)
    if (.not. allocated(shapes)) return
    thinnest = infinite_length
    do s = 1, size(shapes)
      if (shapes(s)%combine == combine_union) then
        thinnest = min(thinnest, shape_thickness(shapes(s), mesh))
      end if
    end do
    if (thinnest < infinite_length) cells = thinnest/mesh%h
  end function body_thickness

  !> Least distance between opposite surfaces of a shape.
  pure function shape_thickness(shape, mesh) result(thickness)
    type(shape_t), intent(in) :: shape
    type(mesh_t), intent(in) :: mesh
    real(dp) :: thickness, across
    integer :: axis
    thickness = huge(1.0_dp)
    select case (shape%kind)
     case (shape_block)
      do axis = 1, mesh%ndim
        across = shape%upper(axis) - shape%lower(axis)
        if (at_wall(mesh, 1, axis, shape%lower(axis))) across = 2.0_dp*across
        if (at_wall(mesh, 2, axis, shape%upper(axis))) then
          across = merge(huge(1.0_dp), 2.0_dp*across, at_wall(mesh, 1, axis, shape%lower(axis)))
        end if
        thickness = min(thickness, across)
      end do
     case (shape_ring)
      thickness = shape%radius - shape%radius2
     case (shape_cylinder)
      thickness = min(2.0_dp*shape%radius, cylinder_length(shape, mesh))
     case default
      if (shape%radius > 0.0_dp) thickness = 2.0_dp*shape%radius
    end select
  end function shape_thickness

  !> Length of a cylinder, with its image behind a wall that an end touches; huge where both do, or
  !! where the cylinder is the section of an endless one.
  pure function cylinder_length(shape, mesh) result(length)
    type(shape_t), intent(in) :: shape
    type(mesh_t), intent(in) :: mesh
    real(dp) :: length, ends(2)
    logical :: touches(2)
    integer :: axis
    length = huge(1.0_dp)
    if (norm2(shape%axis(:mesh%ndim)) <= 0.0_dp) return
    length = shape%length
    axis = findloc(abs(shape%axis(:mesh%ndim)) > 1.0_dp - 1.0e-9_dp, .true., 1)
    if (axis == 0 .or. .not. length < infinite_length) return
    ends = shape%centre(axis) + [0.0_dp, shape%axis(axis)*length]
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
    if (yes) yes = abs(mesh%origin(axis) + node*mesh%h - x) < 0.01_dp*mesh%h
  end function at_wall

end module sgmp_thickness
