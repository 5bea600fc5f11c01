!> What a checkpoint keeps of walls that move or rub.
module sgmp_wall_state
  use sgmp_archive, only: archive_t
  use sgmp_mesh, only: mesh_t, wall_speed
  implicit none
  private
  public :: wall_state_pass

contains

  !> Velocities of the walls.
  subroutine wall_state_pass(archive, mesh)
    type(archive_t), intent(inout) :: archive
    type(mesh_t), intent(inout) :: mesh
    integer :: axis
    do axis = 1, mesh%ndim
      call archive%pass(mesh%wall_motion(:, :, axis, wall_speed))
    end do
  end subroutine wall_state_pass

end module sgmp_wall_state
