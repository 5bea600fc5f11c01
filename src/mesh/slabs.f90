!> Slabs: ranges of planes of bins along the slowest axis, and which positions lie in them.
module sgmp_slabs
  use sgmp_graded_axis, only: graded_axis_t, graded_coordinate
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_coordinate
  implicit none
  private
  public :: far_plane, slab_t, slab_plane, slab_holds

  integer, parameter :: far_plane = huge(1)/4       !! no plane has a number as large as this

  !> A range of planes of bins along the slowest axis, and how positions are sorted into them.
  type :: slab_t
    integer :: axis = 0                             !! the slowest axis; 0 in 1D: all in plane 0
    real(dp) :: origin = 0.0_dp, h = 1.0_dp         !! of the grid (length)
    type(graded_axis_t) :: graded                   !! where cells along the axis are unequal
    real(dp) :: shift = 0.5_dp                      !! see particles_t
    integer :: own(2) = [-far_plane, far_plane]     !! first and last plane
  end type slab_t

contains

  !> Plane of bins of a position.
  pure function slab_plane(slab, point) result(plane)
    type(slab_t), intent(in) :: slab
    real(dp), intent(in) :: point(3)      !! position (length)
    integer :: plane
    real(dp) :: coordinate
    plane = 0
    if (slab%axis > 0) then
      coordinate = mesh_coordinate(slab%origin, slab%h, point(slab%axis))
      if (slab%graded%graded) coordinate = graded_coordinate(slab%graded, coordinate)
      plane = floor(coordinate - slab%shift)
    end if
  end function slab_plane

  !> Whether a position belongs to the slab.
  pure function slab_holds(slab, point) result(yes)
    type(slab_t), intent(in) :: slab
    real(dp), intent(in) :: point(3)
    logical :: yes
    integer :: plane
    plane = slab_plane(slab, point)
    yes = plane >= slab%own(1) .and. plane <= slab%own(2)
  end function slab_holds

end module sgmp_slabs
