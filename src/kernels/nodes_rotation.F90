! dimension-generic, axisymmetric
#include "dimension.inc"
#if NDIM > 1
!> The stages of exact rotation as passes over the planes of a field (doc/rotation.md).
module DIM(sgmp_nodes_rotation)
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use DIM(sgmp_nodes), only: face_forces, node_forces
  use CARTESIAN(sgmp_rotation), only: rotation_couples, rotation_curls, rotation_moments, rotation_place
  use CARTESIAN(sgmp_rotation_offsets), only: rotation_inertia, rotation_inverses, rotation_offsets
  use sgmp_rotation_points, only: stage_couples, stage_curls, stage_face_couples, &
                                  stage_face_moments, stage_inertia, stage_inverses, &
                                  stage_moments, stage_offsets
  use CARTESIAN(sgmp_rotation_rows), only: tile
  implicit none
  private
  public :: nodes_rotation

contains

  !> One stage of one plane.
  pure subroutine nodes_rotation(field, mesh, plane, stage, number, columns)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane, stage
    !> Of the offsets: nodes lighter than this are ignored. Of the curls: see rotation_curls.
    real(dp), intent(in) :: number
    integer, intent(in) :: columns(:)        !! first columns of velocities; the curl of the first
    select case (stage)
    case (stage_offsets)
      call rotation_offsets(field, mesh, plane, number)
    case (stage_inertia)
      call rotation_inertia(field, mesh, plane)
    case (stage_inverses)
      call rotation_inverses(field, mesh, plane)
    case (stage_moments)
      call force_moments(field, mesh, plane)
    case (stage_couples)
      call rotation_couples(field, plane, field%rotation%couple)
    case (stage_face_moments)
      call face_moments(field, mesh, plane)
    case (stage_face_couples)
      call rotation_couples(field, plane, field%rotation%face_couple)
    case (stage_curls)
      call rotation_curls(field, mesh, plane, columns(1), number)
    case default  ! stage_place
      call rotation_place(field, plane, columns)
    end select
  end subroutine nodes_rotation

  !> Internal forces of all nodes, and their moments about those whose centre of mass is not at
  !! their place.
  pure subroutine force_moments(field, mesh, plane)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp) :: f(tile, NDIM)
    integer :: s, first, n, at
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        call node_forces(field, mesh, s, first, n, f)
        at = field%neighbour(0, 0, s) + first
        field%rotation%force(at:at + n - 1, :) = f(:n, :)
        call rotation_moments(field, s, first, n, f)
      end do
    end do
  end subroutine force_moments

  !> Moments of the forces on faces: those act at their places and not at centres of mass.
  pure subroutine face_moments(field, mesh, plane)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp) :: f(tile, NDIM)
    integer :: s, first, n
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        call face_forces(field, mesh, s, first, n, f)
        call rotation_moments(field, s, first, n, f)
      end do
    end do
  end subroutine face_moments

end module DIM(sgmp_nodes_rotation)
#endif
