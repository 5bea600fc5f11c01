!> Scenes of nothing but gas that walls enclose: the volumes of its particles are those of the box,
!! and the program keeps them where the deck leaves it the choice (doc/volumes.md).
module sgmp_enclosed_gas
  use sgmp_constitutive, only: law_gaseous
  use sgmp_mesh, only: wall_fixed, wall_slip
  use sgmp_scene, only: scene_t
  implicit none
  private
  public :: gas_alone

contains

  !> Whether walls that hold enclose the grid on all sides and all that moves in it is gas in one
  !! field: with a card contact each body counts its own volume alone.
  pure function gas_alone(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: side, axis, b
    yes = size(scene%bodies) > 0 .and. size(scene%contacts) == 0
    do axis = 1, merge(2, scene%dimension, scene%axisymmetric)
      do side = 1, 2
        if (scene%axisymmetric .and. axis == 1 .and. side == 1) cycle  ! the axis
        yes = yes .and. any(scene%grid%wall(side, axis) == [wall_slip, wall_fixed])
      end do
    end do
    do b = 1, size(scene%bodies)
      if (.not. yes) return
      yes = .not. scene%bodies(b)%rigid .and. scene%bodies(b)%material > 0
      if (yes) yes = law_gaseous(scene%materials(scene%bodies(b)%material)%law)
    end do
  end function gas_alone

end module sgmp_enclosed_gas
