!> What the cards `wallfriction` say.
module sgmp_wall_friction_type
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: wall_friction_t

  !> Slip walls that rub.
  type :: wall_friction_t
    logical :: rubs = .false.                     !! some wall does
    real(dp) :: coefficient(2, 3) = 0.0_dp        !! Coulomb's, (lower|upper, axis)
    real(dp) :: share(2, 3) = 1.0_dp              !! of what presses that rubs
    real(dp) :: credit(2, 3) = 0.0_dp             !! impulse that could have rubbed, has not;
                                                  !! < 0: the other way round
    real(dp) :: usual(2, 3) = 0.0_dp              !! impulse that presses in a step, of late
  end type wall_friction_t

end module sgmp_wall_friction_type
