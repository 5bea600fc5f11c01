!> Pores of a chunk: the equation of state of porous matter, and elastic pores whose distention is
!! found together with pressure and energy (sgmp_porosity, theory 4).
module sgmp_pores
  use sgmp_constitutive, only: constitutive_t, eos_lanes
  use sgmp_eos, only: eos_energy_pressure
  use sgmp_kinds, only: dp, lanes
  use sgmp_porosity, only: porosity_crushes, porosity_curve, porosity_excess, porosity_is_closed, &
                           porosity_speed_ratio, porosity_terms_lanes
  implicit none
  private
  public :: porous_lanes, pores_slow, squeeze_pores, narrow

  integer, parameter :: most_trials = 60           !! of a distention
  real(dp), parameter :: settled = 1.0e-13_dp      !! of a distention, of a pressure over K0
  real(dp), parameter :: wider = 1.02_dp           !! by which the upper end is sought

contains

  !> Terms of the equation of state of porous matter whose pores stay.
  pure subroutine porous_lanes(law, v, distention, energy, a0, b0, da, db)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v(lanes), distention(lanes), energy(lanes)
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)
    call eos_lanes(law, v*law%porosity%distention/distention, energy, a0, b0, da, db)
    call porosity_terms_lanes(law%porosity, distention, a0, b0, da, db)
  end subroutine porous_lanes

  !> From the square of the speed of sound while pores stay that while they give way.
  pure subroutine pores_slow(law, distention, speed2)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: distention(lanes)
    real(dp), intent(inout) :: speed2(lanes)
    speed2 = speed2*porosity_speed_ratio(law%porosity, distention)**2
  end subroutine pores_slow

  !> Distention of elastic pores after the step, their curve, and the terms with it.
  !!
  !! What the pressure is too high by grows with the distention; its zero is above the old one where
  !! matter opens, and between none and the old one where it closes. Each lane by itself.
  pure subroutine squeeze_pores(law, v_old, v, p_old, other, kept, a0, b0)
    type(constitutive_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: v_old, v, p_old, other  !! as in eos_energy_pressure
    real(dp), intent(inout) :: kept(lanes, 3)  !! energy before the step, distention, shift
    real(dp), dimension(lanes), intent(out) :: a0, b0
    real(dp), dimension(lanes) :: low, high, below, above, middle, excess, moving, moved, side, &
                                  pressure
    integer :: k
    high = kept(:, 2)
    call excess_pressure(law, v_old, v, p_old, other, kept, high, above, pressure, a0, b0)
    moving = merge(1.0_dp, 0.0_dp, abs(above) > settled .and. .not. porosity_is_closed(high))
    if (.not. any(moving > 0.0_dp)) return
    moved = moving
    low = merge(1.0_dp, high, above > 0.0_dp)
    call raise(law, v_old, v, p_old, other, kept, moving, high, above)
    call excess_pressure(law, v_old, v, p_old, other, kept, low, below, pressure, a0, b0)
    where (moving > 0.0_dp .and. below >= 0.0_dp)  ! nothing is left of the pores
      high = low
      moving = 0.0_dp
    end where
    side = 0.0_dp
    trials: do k = 1, most_trials
      if (.not. any(moving > 0.0_dp)) exit trials
      middle = high
      where (moving > 0.0_dp) middle = (low*above - high*below)/(above - below)
      call excess_pressure(law, v_old, v, p_old, other, kept, middle, excess, pressure, a0, b0)
      call narrow(settled, middle, excess, low, high, below, above, side, moving)
    end do trials
    call excess_pressure(law, v_old, v, p_old, other, kept, high, excess, pressure, a0, b0)
    kept(:, 2) = high
    where (moved > 0.0_dp .and. porosity_crushes(law%porosity, high, kept(:, 3)))
      kept(:, 3) = porosity_curve(law%porosity, high) - pressure
    end where
  end subroutine squeeze_pores

  !> Raises the upper end of lanes that open until the pressure is too high there.
  pure subroutine raise(law, v_old, v, p_old, other, kept, moving, high, above)
    type(constitutive_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: v_old, v, p_old, other  !! as in eos_energy_pressure
    real(dp), intent(in) :: kept(lanes, 3)
    real(dp), intent(inout) :: moving(lanes)    !! 0 where there is no such end
    real(dp), intent(inout) :: high(lanes), above(lanes)
    real(dp), dimension(lanes) :: pressure, a0, b0
    integer :: k
    where (moving > 0.0_dp .and. above < 0.0_dp) high = max(high, v*law%porosity%distention)
    widen: do k = 1, most_trials
      call excess_pressure(law, v_old, v, p_old, other, kept, high, above, pressure, a0, b0)
      if (.not. any(moving > 0.0_dp .and. above < 0.0_dp)) return
      where (moving > 0.0_dp .and. above < 0.0_dp) high = wider*high
    end do widen
    where (moving > 0.0_dp .and. above < 0.0_dp)
      high = kept(:, 2)
      moving = 0.0_dp
    end where
  end subroutine raise

  !> By how much, over K0, the pressure with a distention is above what the pores bear; the terms.
  pure subroutine excess_pressure(law, v_old, v, p_old, other, kept, distention, excess, pressure, &
                                  a0, b0)
    type(constitutive_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: v_old, v, p_old, other  !! as in eos_energy_pressure
    real(dp), intent(in) :: kept(lanes, 3)
    real(dp), intent(in) :: distention(lanes)
    real(dp), dimension(lanes), intent(out) :: excess, pressure, a0, b0
    real(dp), dimension(lanes) :: da, db, energy, ones
    ones = 1.0_dp
    energy = kept(:, 1)
    pressure = p_old
    call porous_lanes(law, v, distention, energy, a0, b0, da, db)
    call eos_energy_pressure(v_old, v, other, ones, a0, b0, energy, pressure)
    excess = porosity_excess(law%porosity, distention, pressure, kept(:, 3))
  end subroutine excess_pressure

  !> One step of the Illinois method; an end that stays twice loses half of its weight.
  pure subroutine narrow(settled, middle, excess, low, high, below, above, side, moving)
    real(dp), intent(in) :: settled                     !! of a distention, of its excess
    real(dp), dimension(lanes), intent(in) :: middle, excess
    real(dp), dimension(lanes), intent(inout) :: low, high, below, above
    real(dp), intent(inout) :: side(lanes)              !! of the last step: 1 high, -1 low
    real(dp), intent(inout) :: moving(lanes)            !! 1, 0 where it has settled, in `high`
    integer :: l
    do l = 1, lanes
      if (moving(l) < 0.5_dp) cycle
      if (excess(l) > 0.0_dp) then
        high(l) = middle(l)
        above(l) = excess(l)
        if (side(l) > 0.0_dp) below(l) = 0.5_dp*below(l)
        side(l) = 1.0_dp
      else
        low(l) = middle(l)
        below(l) = excess(l)
        if (side(l) < 0.0_dp) above(l) = 0.5_dp*above(l)
        side(l) = -1.0_dp
      end if
      if (abs(excess(l)) <= settled .or. high(l) - low(l) <= settled) then
        high(l) = middle(l)
        moving(l) = 0.0_dp
      end if
    end do
  end subroutine narrow

end module sgmp_pores
