!> Erosion by the time step: which wave and particle speed a limit stands for.
module sgmp_erosion_stages
  use sgmp_body, only: body_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: erosion_open

contains

  !> Start of a step: c + |v| above which a particle would force a step below the limit of its
  !! material, with the Courant number as it is now.
  pure subroutine erosion_open(reach, bodies)
    real(dp), intent(in) :: reach
      !! Courant number, 1 where the step is fixed, times the side of a cell (length)
    type(body_t), intent(inout) :: bodies(:)
    integer :: b
    do b = 1, size(bodies)
      associate (erosion => bodies(b)%law%erosion)
        if (erosion%time_step > 0.0_dp) erosion%speed = reach/erosion%time_step
      end associate
    end do
  end subroutine erosion_open

end module sgmp_erosion_stages
