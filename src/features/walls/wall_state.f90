!> What a checkpoint keeps of walls that move or rub.
module sgmp_wall_state
  use sgmp_archive, only: archive_t
  use sgmp_mesh, only: mesh_t, wall_speed
  use sgmp_wall_friction_type, only: wall_friction_t
  implicit none
  private
  public :: wall_state_pass

contains

  !> Velocities of the walls, and what of that which presses on them rubs.
  subroutine wall_state_pass(archive, mesh, friction)
    type(archive_t), intent(inout) :: archive
    type(mesh_t), intent(inout) :: mesh
    type(wall_friction_t), intent(inout) :: friction
    integer :: axis
    if (friction%rubs) then
      call archive%pass(friction%share)
      call archive%pass(friction%credit)
      call archive%pass(friction%usual)
    end if
    do axis = 1, mesh%ndim
      call archive%pass(mesh%wall_motion(:, :, axis, wall_speed))
    end do
  end subroutine wall_state_pass

end module sgmp_wall_state
