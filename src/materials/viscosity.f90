!> Bulk viscosity that spreads shocks over a few cells (von Neumann and Richtmyer 1950, Landshoff
!! 1955; theory 4).
module sgmp_viscosity
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: viscosity_keys, viscosity_read
  public :: closing_t, viscosity_t, viscosity_pressure, viscosity_lanes
  public :: viscosity_of_pulses, viscosity_of_shocks, viscosity_of_soils

  !> Coefficients; the defaults are the customary ones.
  type :: viscosity_t
    real(dp) :: quadratic = 1.5_dp  !! b1
    real(dp) :: linear = 0.06_dp   !! b2
    logical :: given = .false.     !! by a card
  end type viscosity_t

  !> What shocks get that no card speaks of. With the customary linear part peaks behind a front
  !! are 1.5 to 2 times too high, with five times as much 1.2 to 1.5 times (doc/theory.md, 4).
  type(viscosity_t), parameter :: viscosity_of_shocks = viscosity_t(1.5_dp, 0.3_dp)
  !> What liquids get beside explosives: pressure falls at once behind such fronts, so that
  !! spreading them takes more from their peaks than ringing adds (sgmp_judge_shocks).
  type(viscosity_t), parameter :: viscosity_of_pulses = viscosity_t(1.5_dp, 0.15_dp)
  type(viscosity_t), parameter :: viscosity_of_soils = viscosity_t(1.5_dp, 2.0_dp)

  !> How matter closes in a step: what its viscous pressure follows from.
  type :: closing_t
    real(dp) :: dt = 0.0_dp
    real(dp) :: trace(lanes) = 0.0_dp  !! of the strain
    real(dp) :: share(lanes) = 1.0_dp  !! factor on the viscous pressure (AV2)
  end type closing_t

contains

  !> Keys of the bulk viscosity.
  function viscosity_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('quadratic', kind_real, 'b1', range='[0,inf)', default='1.5'), &
            key('linear', kind_real, 'b2', range='[0,inf)', default='0.06')]
  end function viscosity_keys

  !> Coefficients from the values of those keys.
  pure function viscosity_read(values) result(law)
    class(values_t), intent(in) :: values
    type(viscosity_t) :: law
    law = viscosity_t(quadratic=values%number('quadratic'), linear=values%number('linear'), &
                      given=.true.)
  end function viscosity_read

  !> Viscous pressure q = rho h^2 b1 tr^2 - b2 rho h c tr in compression (tr < 0), else 0; adds to
  !! the pressure (stress).
  pure function viscosity_pressure(law, cell, density, sound_speed, trace) result(q)
    type(viscosity_t), intent(in) :: law     !! coefficients
    real(dp), intent(in) :: cell             !! cell side h (length)
    real(dp), intent(in) :: density          !! current density (mass/volume)
    real(dp), intent(in) :: sound_speed      !! current sound speed
    real(dp), intent(in) :: trace            !! trace of the rate of deformation (1/time)
    real(dp) :: q
    real(dp) :: closing
    closing = cell*merge(-trace, 0.0_dp, trace < 0.0_dp)
    q = density*closing*(law%quadratic*closing + law%linear*sound_speed)
  end function viscosity_pressure

  !> Lane kernel of viscosity_pressure.
  pure subroutine viscosity_lanes(law, cell, density, sound_speed, trace, q)
    type(viscosity_t), intent(in) :: law                                       !! coefficients
    real(dp), intent(in) :: cell(lanes)  !! cell side h (length)
    real(dp), dimension(lanes), intent(in) :: density, sound_speed  !! as in the point function
    real(dp), dimension(lanes), intent(in) :: trace                 !! as in the point function
    real(dp), intent(out) :: q(lanes)                                          !! viscous pressure
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      q(p) = viscosity_pressure(law, cell(p), density(p), sound_speed(p), trace(p))
    end do
  end subroutine viscosity_lanes

end module sgmp_viscosity
