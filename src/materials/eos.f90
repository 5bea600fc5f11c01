!> What all equations of state share (theory 4): p = f (a0 + b0 E), with terms of the volume alone,
!! or those of the tangent at an energy where the pressure is not linear in it.
!!
!! v = V/V0, E is the energy per initial volume, f the burn fraction (1 for an inert material).
module sgmp_eos
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: eos_energy, eos_sound_speed_squared, eos_energy_lanes, eos_energy_pressure, &
            eos_sound_speed_lanes

  real(dp), parameter :: least_whole = 0.5_dp  !! of 1 + f b0 (v_new - v_old)/2 in eos_energy

contains

  !> Energy after the step: E_new = E_old + work - (p_old + p_new)(v_new - v_old)/2, solved with
  !! p_new = f (a0 + b0 E_new).
  !!
  !! That is singular at f b0 (v_new - v_old) = -2, to which a step comes near that closes far
  !! expanded matter, where b0 stays as v grows (Grueneisen): there the old pressure does the work.
  pure function eos_energy(energy_old, pressure_old, work, dv, fraction, a0, b0) result(energy)
    real(dp), intent(in) :: energy_old   !! E before the step (energy/initial volume)
    real(dp), intent(in) :: pressure_old  !! p before the step (stress)
    real(dp), intent(in) :: work         !! deviatoric and viscous work (energy/initial volume)
    real(dp), intent(in) :: dv           !! v_new - v_old
    real(dp), intent(in) :: fraction     !! burn fraction f after the step
    real(dp), intent(in) :: a0, b0       !! terms of the equation of state at v_new
    real(dp) :: energy, whole
    whole = 1.0_dp + 0.5_dp*dv*fraction*b0
    energy = energy_old + work - 0.5_dp*dv*(pressure_old + fraction*a0)
    energy = merge(energy/merge(whole, 1.0_dp, whole > least_whole), &
                   energy_old + work - dv*pressure_old, whole > least_whole)
  end function eos_energy

  !> Squared bulk sound speed -(v^2/rho0) dp/dv at constant entropy, where dE = -p dv:
  !! c^2 = f (v^2/rho0) (p b0 - da - db E). Negative where the equation of state has lost
  !! hyperbolicity.
  pure function eos_sound_speed_squared(density0, v, pressure, energy, da, db, b0, fraction) &
    result(speed_squared)
    real(dp), intent(in) :: density0    !! initial density (mass/volume)
    real(dp), intent(in) :: v           !! volume over initial volume
    real(dp), intent(in) :: pressure    !! p, burn fraction included (stress)
    real(dp), intent(in) :: energy      !! E (energy/initial volume)
    real(dp), intent(in) :: da, db, b0  !! terms of the equation of state at v
    real(dp), intent(in) :: fraction    !! burn fraction f
    real(dp) :: speed_squared
    speed_squared = fraction*v*v*(pressure*b0 - da - db*energy)*(1.0_dp/density0)
  end function eos_sound_speed_squared

  !> Lane kernel of eos_energy: energy and pressure after the step.
  pure subroutine eos_energy_pressure(v_old, v_new, work, fraction, a0, b0, energy, pressure)
    real(dp), intent(in) :: v_old(lanes), v_new(lanes)      !! v before and after the step
    real(dp), intent(in) :: work(lanes), fraction(lanes)    !! as in eos_energy
    real(dp), intent(in) :: a0(lanes), b0(lanes)            !! terms at v_new
    real(dp), intent(inout) :: energy(lanes)                !! E, updated
    real(dp), intent(inout) :: pressure(lanes)              !! p, updated
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      energy(p) = eos_energy(energy(p), pressure(p), work(p), v_new(p) - v_old(p), fraction(p), &
                             a0(p), b0(p))
      pressure(p) = fraction(p)*(a0(p) + b0(p)*energy(p))
    end do
  end subroutine eos_energy_pressure

  !> Lane kernel of eos_energy alone.
  pure subroutine eos_energy_lanes(v_old, v_new, work, pressure, fraction, a0, b0, energy)
    real(dp), intent(in) :: v_old(lanes), v_new(lanes)      !! v before and after the step
    real(dp), intent(in) :: work(lanes), pressure(lanes), fraction(lanes)  !! as in eos_energy
    real(dp), intent(in) :: a0(lanes), b0(lanes)            !! terms at v_new
    real(dp), intent(inout) :: energy(lanes)                !! E, updated
    integer :: p
    do p = 1, lanes
      energy(p) = eos_energy(energy(p), pressure(p), work(p), v_new(p) - v_old(p), fraction(p), &
                             a0(p), b0(p))
    end do
  end subroutine eos_energy_lanes

  !> Lane kernel of eos_sound_speed_squared.
  pure subroutine eos_sound_speed_lanes(density0, v, pressure, energy, da, db, b0, fraction, &
                                        speed_squared)
    real(dp), intent(in) :: density0                           !! initial density, > 0
    real(dp), dimension(lanes), intent(in) :: v, pressure, energy  !! as in the point function
    real(dp), dimension(lanes), intent(in) :: da, db, b0, fraction  !! as in the point function
    real(dp), intent(out) :: speed_squared(lanes)              !! c^2
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      speed_squared(p) = eos_sound_speed_squared(density0, v(p), pressure(p), energy(p), da(p), &
                                                 db(p), b0(p), fraction(p))
    end do
  end subroutine eos_sound_speed_lanes

end module sgmp_eos
