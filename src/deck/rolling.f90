!> Scenes in which something rolls: friction in contact then wants exact rotation, which puts it at
!! the surface (doc/rotation.md, Rolling).
module sgmp_rolling
  use sgmp_kinds, only: dp
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shape_cylinder, shape_ring, shape_sphere
  implicit none
  private
  public :: scene_rolls

contains

  !> Whether gravity presses a deformable ball, disk or ring onto something, in plane or space.
  pure function scene_rolls(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b
    yes = .false.
    if (scene%axisymmetric .or. scene%dimension == 1) return
    if (size(scene%motions) > 0) return  ! parts that are moved and rubbed at their surface: refused
    if (.not. any(abs(scene%gravity) > 0.0_dp)) return
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%rigid .or. .not. allocated(scene%bodies(b)%shapes)) cycle
      associate (kind => scene%bodies(b)%shapes%kind)
        yes = all(kind == shape_sphere .or. kind == shape_ring .or. &
                  (kind == shape_cylinder .and. scene%dimension == 2))
      end associate
      if (yes) return
    end do
  end function scene_rolls

end module sgmp_rolling
