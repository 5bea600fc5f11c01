!> Shapes of constructive solid geometry, and how deep a point lies below the surface of their
!! combination.
!!
!! Contact measures distances between surfaces, not between lattices of particles: a sphere of
!! cubes is a polyhedron with flat facets, and would neither roll nor touch where it should.
module sgmp_shapes
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: shape_t, surface_depth
  public :: shape_block, shape_cylinder, shape_sphere, shape_ring, shape_cone, shape_ogive, &
    shape_halfspace
  public :: combine_union, combine_difference, combine_intersection

  integer, parameter :: shape_block = 1, shape_cylinder = 2, shape_sphere = 3, shape_ring = 4, &
    shape_cone = 5, shape_ogive = 6, shape_halfspace = 7
  integer, parameter :: combine_union = 1, combine_difference = 2, combine_intersection = 3

  !> One primitive of constructive solid geometry.
  type :: shape_t
    integer :: kind = shape_block
    integer :: combine = combine_union
    real(dp) :: lower(3) = 0.0_dp, upper(3) = 0.0_dp  !! block: corners
    real(dp) :: centre(3) = 0.0_dp
      !! sphere, ring, half-space point; base centre of cylinder, cone, ogive
    real(dp) :: axis(3) = [0.0_dp, 0.0_dp, 1.0_dp]
      !! unit axis of cylinder, ring, cone, ogive; outward normal of a half-space
    real(dp) :: radius = 0.0_dp, radius2 = 0.0_dp     !! outer; inner (ring), top (cone)
    real(dp) :: length = 0.0_dp                       !! along the axis (huge: infinite, as in 2D)
  end type shape_t

contains

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

  !> Distance to the surface of one shape, positive inside.
  pure function shape_depth(shape, point, ndim) result(depth)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: point(3)
    integer, intent(in) :: ndim
    real(dp) :: depth
    real(dp) :: along, radius, slant, arc
    if (shape%kind == shape_block) then
      depth = min(minval(point(:ndim) - shape%lower(:ndim)), &
                  minval(shape%upper(:ndim) - point(:ndim)))
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
    select case (shape%kind)
    case (shape_cone)
      slant = (shape%radius2 - shape%radius)/shape%length
      depth = (shape%radius + slant*along - radius)/sqrt(1.0_dp + slant**2)
    case (shape_ogive)
      arc = (shape%radius**2 + shape%length**2)/(2.0_dp*shape%radius)
      depth = arc - sqrt(along**2 + (radius + (arc - shape%radius))**2)
    case (shape_ring)
      depth = min(shape%radius - radius, radius - shape%radius2)
    case default
      depth = shape%radius - radius
    end select
    if (ndim == 3) depth = min(depth, along, shape%length - along)
  end function shape_depth

end module sgmp_shapes
