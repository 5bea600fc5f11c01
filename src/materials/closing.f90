!> How much of its volume whole solid matter may lose in a step (doc/time-step.md).
!!
!! The internal energy of a step follows from the stress at its start and at its end, what the grid
!! gets from the stress at its start alone. Where a step takes much of a volume, as where bodies
!! meet faster than sound, the difference is energy from nowhere, of first order in the step. So the
!! step is bounded as if there was a wave with the speed
!!
!!     closing h |tr D|                                                               (CL1)
!!
!! which in ordinary impacts is far below that of sound.
module sgmp_closing
  use sgmp_constitutive, only: constitutive_t, eos_none, law_is_metal
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: closing_first, closing_solid, closing_waves

  real(dp), parameter :: closing = 4.0_dp     !! a step with Courant number C closes at most C/4
  real(dp), parameter :: gentle = 0.05_dp     !! part of a step that tells how fast matter closes

contains

  !> Whether a law is that of solid matter with an equation of state.
  elemental function closing_solid(law) result(yes)
    type(constitutive_t), intent(in) :: law
    logical :: yes
    yes = law%eos /= eos_none .and. .not. law%rigid .and. law_is_metal(law)
  end function closing_solid

  !> Part of a Courant step that the first step of a run takes: before it nobody knows how fast
  !! bodies close that already touch.
  pure function closing_first(laws, speeds) result(part)
    type(constitutive_t), intent(in) :: laws(:)
    real(dp), intent(in) :: speeds(:)            !! of the bodies
    real(dp) :: part
    logical :: solid(size(laws))
    part = 1.0_dp
    solid = closing_solid(laws)
    if (.not. any(solid)) return
    if (maxval(speeds, mask=solid) > minval(laws%bulk_speed, mask=solid)) part = gentle
  end function closing_first

  !> Squares of the speeds that bound the step: of sound, or (CL1) where whole matter closes faster.
  pure function closing_waves(law, dt, jacobian, nb, b, speed2) result(bound)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt                   !! strain step
    real(dp), intent(in) :: jacobian(lanes)      !! of the step
    integer, intent(in) :: nb
    real(dp), intent(in) :: b(lanes, nb), speed2(lanes)
    real(dp) :: bound(lanes), rate
    integer :: l
    bound = speed2
    if (.not. closing_solid(law) .or. .not. dt > 0.0_dp) return
    rate = closing*law%h/dt
    do l = 1, lanes
      if (bound(l) >= 0.0_dp) bound(l) = max(bound(l), (rate*max(1.0_dp - jacobian(l), 0.0_dp))**2)
    end do
    if (.not. law%fails .or. .not. law%history%damage) return
    where (b(:, law%slots%damage) >= 1.0_dp) bound = speed2
  end function closing_waves

end module sgmp_closing
