!> Fluids that are pushed at surfaces that lie at an angle to the grid.
module sgmp_judge_pushed
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_blast, load_pressure, load_traction
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_turn, only: turn_direction
  implicit none
  private
  public :: judge_pushed

contains

  !> Forces on faces of a fluid whose lattice is turned: they are not quite in balance with the
  !! pressure behind them, and a fluid does not resist what that drives along its surface. A block
  !! of water at 30 degrees, under the pressure that it has got itself, is torn apart.
  subroutine judge_pushed(opinion, scene)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    integer :: i
    if (scene%dimension == 1) return
    do i = 1, size(scene%loads)
      associate (load => scene%loads(i))
        if (all(load%kind /= [load_pressure, load_traction, load_blast]) .or. load%body == 0) cycle
        associate (body => scene%bodies(load%body))
          if (body%material == 0 .or. .not. oblique(scene, load%body)) cycle
          if (.not. law_is_spherical(scene%materials(body%material)%law)) cycle
          call opinion%object("fluid '"//trim(body%name)//"' is pushed at surfaces that lie at "// &
                              'an angle to the grid: nothing in it resists what is out of '// &
                              'balance there; lay it along the grid, or let a wall or a body '// &
                              'push it')
          return
        end associate
      end associate
    end do
  end subroutine judge_pushed

  !> Whether a body is turned, but not by right angles.
  pure function oblique(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    real(dp), parameter :: beside = 1.0e-6_dp
    real(dp) :: axis(3), turned(3)
    integer :: a
    yes = .false.
    do a = 1, 3
      axis = merge([1.0_dp, 1.0_dp, 1.0_dp], 0.0_dp, [1, 2, 3] == a)
      turned = turn_direction(scene%bodies(b)%turn, axis)
      yes = yes .or. count(abs(turned) > beside) > 1
    end do
  end function oblique

end module sgmp_judge_pushed
