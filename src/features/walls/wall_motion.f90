!> How walls move: each along itself, as prescribed. Those with friction may be at rest.
module sgmp_wall_motion
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free, wall_kick, wall_speed
  implicit none
  private
  public :: wall_motion_t, wall_motion_choose, wall_motion_start, wall_motion_meets_walls

  !> Prescribed velocities, functions of t.
  type :: wall_motion_t
    type(expression_t) :: velocity(3, 2, 3)      !! (component, lower|upper, axis)
  end type wall_motion_t

contains

  !> Walls before the start: fixed ones are at rest. Matter takes changes of their velocity, and the
  !! first of them is in the first kick. What rubs only has always moved.
  subroutine wall_motion_start(motion, others_act, mesh)
    type(wall_motion_t), intent(in) :: motion
    logical, intent(in) :: others_act            !! walls do for other reasons
    type(mesh_t), intent(inout) :: mesh
    integer :: a, side, axis
    mesh%wall_motion = 0.0_dp
    mesh%walls_move = .false.
    do axis = 1, 3
      do side = 1, 2
        do a = 1, 3
          if (mesh%wall(side, axis) == wall_fixed) then
            mesh%walls_move = mesh%walls_move .or. moves(motion%velocity(a, side, axis))
          else
            mesh%wall_motion(a, side, axis, wall_speed) = at(motion%velocity(a, side, axis), 0.0_dp)
          end if
        end do
      end do
    end do
    mesh%walls_act = mesh%walls_move .or. mesh%walls_weigh .or. others_act
  end subroutine wall_motion_start

  !> Whether a fixed wall moves towards one across its way, as the lid of a cavity does.
  pure logical function wall_motion_meets_walls(motion, mesh) result(meets)
    type(wall_motion_t), intent(in) :: motion
    type(mesh_t), intent(in) :: mesh
    integer :: a, side, axis
    meets = .false.
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (mesh%wall(side, axis) /= wall_fixed) cycle
        do a = 1, mesh%ndim
          meets = meets .or. (moves(motion%velocity(a, side, axis)) .and. &
                              any(mesh%wall(:, a) /= wall_free))
        end do
      end do
    end do
  end function wall_motion_meets_walls

  pure logical function moves(velocity) result(yes)
    type(expression_t), intent(in) :: velocity
    yes = .not. velocity%is_constant .or. abs(velocity%value) > 0.0_dp
  end function moves

  !> Velocities of the walls at a time, the middle of the step, and the accelerations that lead
  !! there in the velocity step dt.
  subroutine wall_motion_choose(motion, time, dt, mesh)
    type(wall_motion_t), intent(in) :: motion
    real(dp), intent(in) :: time, dt
    type(mesh_t), intent(inout) :: mesh
    real(dp) :: before
    integer :: a, side, axis
    do axis = 1, mesh%ndim
      do side = 1, 2
        do a = 1, mesh%ndim
          before = mesh%wall_motion(a, side, axis, wall_speed)
          mesh%wall_motion(a, side, axis, wall_speed) = at(motion%velocity(a, side, axis), time)
          mesh%wall_motion(a, side, axis, wall_kick) = &
            (mesh%wall_motion(a, side, axis, wall_speed) - before)/dt
        end do
      end do
    end do
  end subroutine wall_motion_choose

  function at(velocity, time) result(value)
    type(expression_t), intent(in) :: velocity
    real(dp), intent(in) :: time
    real(dp) :: value
    real(dp), parameter :: nowhere(3) = 0.0_dp
    value = velocity%evaluate(nowhere, nowhere, time)
  end function at

end module sgmp_wall_motion
