!> When bodies that a card removes go.
module sgmp_removal_stages
  use sgmp_body, only: body_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: removal_open

contains

  !> Start of a step: bodies whose time has come lose their particles at the end of its drift.
  pure subroutine removal_open(time, bodies)
    real(dp), intent(in) :: time                 !! at which the step begins
    type(body_t), intent(inout) :: bodies(:)
    bodies%leaves = time >= bodies%removed_at
  end subroutine removal_open

end module sgmp_removal_stages
