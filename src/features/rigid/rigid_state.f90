!> What a checkpoint keeps of rigid bodies that turn or are free.
module sgmp_rigid_state
  use sgmp_archive, only: archive_t
  use sgmp_rigid_motion, only: rigid_motion_t
  implicit none
  private
  public :: rigid_state_pass

contains

  !> Of a rigid body that turns or is free.
  subroutine rigid_state_pass(archive, motion)
    type(archive_t), intent(inout) :: archive
    type(rigid_motion_t), intent(inout) :: motion
    call archive%pass(motion%centre)
    call archive%pass(motion%attitude)
    call archive%pass(motion%spin)
    call archive%pass(motion%gradient_before)
    call archive%pass(motion%mass)
    call archive%pass(motion%heavier)
    call archive%pass(motion%inertia)
    call archive%pass(motion%inverse)
    call archive%pass(motion%momentum)
    call archive%pass(motion%impulse)
    call archive%pass(motion%last_change)
    call archive%pass(motion%last_growth)
  end subroutine rigid_state_pass

end module sgmp_rigid_state
