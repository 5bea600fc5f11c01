!> Scenes in which something round rolls or bounces: friction then wants exact rotation, which puts
!! it at the surface (doc/rotation.md, Rolling).
module sgmp_rolling
  use sgmp_constitutive, only: law_is_springy
  use sgmp_kinds, only: dp
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shape_cylinder, shape_ring, shape_sphere
  implicit none
  private
  public :: scene_rolls

contains

  !> Whether there is a deformable ball, disk or ring, in plane or space, that gravity presses onto
  !! something, or that is elastic: what friction gives it of rotation is half of what it does.
  pure function scene_rolls(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b
    yes = .false.
    if (scene%axisymmetric .or. scene%dimension == 1) return
    if (size(scene%motions) > 0) return  ! parts that are moved and rubbed at their surface: refused
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        if (body%rigid .or. .not. allocated(body%shapes) .or. body%material == 0) cycle
        if (.not. any(abs(scene%gravity) > 0.0_dp) .and. &
            .not. law_is_springy(scene%materials(body%material)%law)) cycle
        yes = all(is_round(body%shapes%kind, scene%dimension))
      end associate
      if (yes) return
    end do
  end function scene_rolls

  !> Whether a shape rolls.
  elemental logical function is_round(kind, dimension) result(yes)
    integer, intent(in) :: kind, dimension
    yes = kind == shape_sphere .or. kind == shape_ring .or. &
          (kind == shape_cylinder .and. dimension == 2)
  end function is_round

end module sgmp_rolling
