!> What a checkpoint keeps of parts of bodies whose motion is prescribed.
module sgmp_driven_state
  use sgmp_archive, only: archive_t
  use sgmp_driven_part, only: driven_part_t
  implicit none
  private
  public :: driven_state_pass

contains

  !> Of a part of a body whose motion is prescribed.
  subroutine driven_state_pass(archive, part)
    type(archive_t), intent(inout) :: archive
    type(driven_part_t), intent(inout) :: part
    integer :: acts
    acts = merge(1, 0, part%drive%acts)
    call archive%pass(acts)
    part%drive%acts = acts > 0
    call archive%pass(part%drive%centre)
    call archive%pass(part%drive%velocity)
    call archive%pass(part%drive%gradient)
    call archive%pass(part%drive%before)
    call archive%pass(part%drive%gradient_before)
    if (part%drive%about_axis) then
      call archive%pass(part%drive%spin)
      call archive%pass(part%drive%spin_before)
    end if
    call archive%pass(part%motion%centre)
    call archive%pass(part%motion%gradient_before)
    if (part%motion%turns .or. part%drive%about_axis) then  ! rows of what was let go show it
      call archive%pass(part%motion%spin)
    end if
    call archive%pass(part%total)
    if (archive%reading) part%drive%axes = part%axes
  end subroutine driven_state_pass

end module sgmp_driven_state
