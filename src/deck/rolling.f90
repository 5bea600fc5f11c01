!> Scenes in which something rolls, topples or bounces on what it rubs: friction then wants exact
!! rotation, which puts it at the surface (doc/rotation.md, Rolling).
module sgmp_rolling
  use sgmp_constitutive, only: law_bends
  use sgmp_kinds, only: dp
  use sgmp_scene, only: scene_pulls, scene_t
  use sgmp_shapes, only: shape_cylinder, shape_ring, shape_sphere
  use sgmp_springs, only: scene_springs
  implicit none
  private
  public :: scene_rolls, scene_rubbed, scene_weighs

contains

  !> Whether there is a deformable ball, disk or ring that gravity or a body force presses onto
  !! something, or that springs back: what friction gives it of rotation is half of what it does.
  function scene_rolls(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b
    yes = .false.
    if (.not. may_turn(scene)) return
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        if (body%rigid .or. .not. allocated(body%shapes) .or. body%material == 0) cycle
        if (.not. (scene_pulls(scene) .or. scene_springs(scene, b))) cycle
        yes = all(is_round(body%shapes%kind, scene%dimension))
      end associate
      if (yes) return
    end do
  end function scene_rolls

  !> Whether gravity or a body force presses a deformable solid onto something: a stiff block that
  !! is pushed over would stay upright.
  pure function scene_weighs(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b
    yes = .false.
    if (.not. (may_turn(scene) .and. scene_pulls(scene))) return
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        if (body%rigid .or. body%material == 0) cycle
        yes = yes .or. law_bends(scene%materials(body%material)%law)
      end associate
    end do
  end function scene_weighs

  !> Whether bodies turn in plane or space, and none that others rub is moved in part: there exact
  !! rotation is refused.
  pure function may_turn(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: m
    yes = .not. (scene%axisymmetric .or. scene%dimension == 1)
    do m = 1, size(scene%motions)
      yes = yes .and. scene_rubbed(scene, scene%motions(m)%body) == 0
    end do
  end function may_turn

  !> Number of the card contact by which a body is rubbed by others; 0: none.
  pure function scene_rubbed(scene, b) result(card)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b                       !! body
    integer :: card
    if (b > 0) then
      do card = 1, size(scene%contacts)
        associate (bodies => scene%contacts(card)%body)
          if (all(bodies /= b .and. bodies /= scene%bodies(b)%leader .and. bodies /= 0)) cycle
        end associate
        if (scene%contacts(card)%friction > 0.0_dp) return
      end do
    end if
    card = 0
  end function scene_rubbed

  !> Whether a shape rolls.
  elemental logical function is_round(kind, dimension) result(yes)
    integer, intent(in) :: kind, dimension
    yes = kind == shape_sphere .or. kind == shape_ring .or. &
          (kind == shape_cylinder .and. dimension == 2)
  end function is_round

end module sgmp_rolling
