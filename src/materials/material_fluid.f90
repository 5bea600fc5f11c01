!> A fluid: no strength, its pressure from an equation of state, and Newton's viscous stress
!! 2 eta dev D where it has a viscosity (theory 4).
!!
!! An inviscid fluid keeps the mean stress of a particle in place of the tensor.
module sgmp_material_fluid
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: fluid_keys, fluid_read, fluid_diffusion_speed

contains

  !> Keys of the law.
  function fluid_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('viscosity', kind_real, 'dynamic viscosity; 0: inviscid, no deviator is stored', &
                unit='stress time', range='[0,inf)', default='0')]
  end function fluid_keys

  !> Law from the values of its keys.
  pure subroutine fluid_read(values, viscosity, history)
    class(values_t), intent(in) :: values
    real(dp), intent(out) :: viscosity  !! eta (stress times time)
    type(history_t), intent(inout) :: history
    viscosity = values%number('viscosity')
    history%mean_stress = .not. viscosity > 0.0_dp
  end subroutine fluid_read

  !> Speed that, added to that of sound, keeps the Courant step h/(c + speed) below the limit of
  !! explicit diffusion: h^2/(2 nu) for the longitudinal viscosity nu = 4/3 eta/rho.
  elemental function fluid_diffusion_speed(viscosity, density, cell) result(speed)
    real(dp), intent(in) :: viscosity  !! eta (stress times time)
    real(dp), intent(in) :: density    !! current density (mass/volume)
    real(dp), intent(in) :: cell       !! cell side h (length)
    real(dp) :: speed
    speed = (8.0_dp/3.0_dp)*viscosity/(density*cell)
  end function fluid_diffusion_speed

end module sgmp_material_fluid
