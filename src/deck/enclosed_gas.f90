!> Scenes with gas: where nothing else moves and walls enclose it, the volumes of its particles are
!! those of the box; gas that bursts in gas or pushes rigid bodies, and products of explosives, fill
!! what room they find. There the program keeps volumes where the deck leaves it the choice, and
!! particles that grow too large it parts (doc/volumes.md, 6).
module sgmp_enclosed_gas
  use sgmp_constitutive, only: law_gaseous, material_explosive
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_fixed, wall_slip
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: combine_union, shape_block
  implicit none
  private
  public :: gas_alone, gas_burns, gas_in_gas, gas_may_part, gas_on_rigid, &
            gas_sides

contains

  !> Whether walls that hold enclose the grid on all sides and all that moves in it is gas in one
  !! field: with a card contact each body counts its own volume alone.
  pure function gas_alone(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: side, axis
    yes = size(scene%bodies) > 0 .and. size(scene%contacts) == 0
    do axis = 1, merge(2, scene%dimension, scene%axisymmetric)
      do side = 1, 2
        if (scene%axisymmetric .and. axis == 1 .and. side == 1) cycle  ! the axis
        yes = yes .and. any(scene%grid%wall(side, axis) == [wall_slip, wall_fixed])
      end do
    end do
    yes = yes .and. all(gaseous(scene))
  end function gas_alone

  !> Whether something burns beside other matter.
  pure function gas_burns(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes, gas(size(scene%bodies)), burns(size(scene%bodies))
    integer :: b
    gas = gaseous(scene)
    burns = .false.
    do b = 1, size(scene%bodies)
      if (gas(b)) burns(b) = scene%materials(scene%bodies(b)%material)%law%kind == &
                             material_explosive
    end do
    yes = any(burns) .and. .not. all(burns)
  end function gas_burns

  !> Whether all that moves are gases, more than one, in more than one dimension: where
  !! one bursts in another, volumes drift at their boundary.
  pure function gas_in_gas(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    yes = size(scene%bodies) > 1 .and. scene%dimension > 1
    if (yes) yes = all(gaseous(scene)) .and. &
                   any(scene%bodies%material /= scene%bodies(1)%material)
  end function gas_in_gas

  !> Whether all that deforms is gas, and rigid bodies are in it.
  pure function gas_on_rigid(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes, gas(size(scene%bodies))
    gas = gaseous(scene)
    yes = any(gas) .and. any(scene%bodies%rigid) .and. all(gas .or. scene%bodies%rigid)
  end function gas_on_rigid

  !> Whether particles of gas that outgrow their cells are better parted: but on a line, if there is
  !! nothing but gas with more to expand into than another gas, where halves make noise.
  pure function gas_may_part(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes, gas(size(scene%bodies))
    real(dp), parameter :: nearly = 1.0e-6_dp
    real(dp) :: filled
    integer :: b
    gas = gaseous(scene)
    yes = any(gas) .and. (scene%dimension > 1 .or. .not. all(gas))
    if (yes .or. .not. any(gas)) return
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

  !> Sides of the particles of bodies of gas, in cells.
  pure function gas_sides(scene) result(sides)
    type(scene_t), intent(in) :: scene
    real(dp), allocatable :: sides(:)
    sides = pack(scene%bodies%spacing/scene%grid%cell, gaseous(scene))
  end function gas_sides

  !> Which bodies are gas, or become it.
  pure function gaseous(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes(size(scene%bodies))
    integer :: b
    do b = 1, size(scene%bodies)
      yes(b) = .not. scene%bodies(b)%rigid .and. scene%bodies(b)%material > 0
      if (yes(b)) yes(b) = law_gaseous(scene%materials(scene%bodies(b)%material)%law)
    end do
  end function gaseous

end module sgmp_enclosed_gas
