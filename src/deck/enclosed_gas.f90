!> Scenes of nothing but gas that walls enclose: the volumes of its particles are those of the box,
!! and the program keeps them where the deck leaves it the choice (doc/volumes.md).
module sgmp_enclosed_gas
  use sgmp_constitutive, only: law_gaseous
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_fixed, wall_slip
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: combine_union, shape_block
  implicit none
  private
  public :: gas_alone, gas_may_part

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

  !> Whether particles of gas that outgrow their cells are better parted: but on a line, if it has
  !! more to expand into than another gas, where halves make noise (doc/volumes.md, 6).
  pure function gas_may_part(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    real(dp), parameter :: nearly = 1.0e-6_dp
    real(dp) :: filled
    integer :: b
    yes = scene%dimension > 1
    if (yes) return
    filled = 0.0_dp
    do b = 1, size(scene%bodies)
      if (.not. allocated(scene%bodies(b)%shapes)) return
      associate (shapes => scene%bodies(b)%shapes)
        if (any(shapes%kind /= shape_block) .or. any(shapes%combine /= combine_union)) return
        filled = filled + sum(shapes%upper(1) - shapes%lower(1))
      end associate
    end do
    yes = filled >= (1.0_dp - nearly)*(scene%grid%upper(1) - scene%grid%lower(1))
  end function gas_may_part

end module sgmp_enclosed_gas
