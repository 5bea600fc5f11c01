!> Isotropic linear elasticity: the moduli that every solid material starts from (theory 4).
module sgmp_material_elastic
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: elastic_t, elastic_init, elastic_p_wave_modulus, elastic_sound_speed_squared

  !> Elastic constants, all consistent with one another.
  type :: elastic_t
    real(dp) :: density = 0.0_dp  !! initial density (mass/volume)
    real(dp) :: young = 0.0_dp   !! Young's modulus E (stress)
    real(dp) :: poisson = 0.0_dp  !! Poisson's ratio nu
    real(dp) :: bulk = 0.0_dp    !! bulk modulus K = E/(3(1-2nu)) (stress)
    real(dp) :: shear = 0.0_dp   !! shear modulus G = E/(2(1+nu)) (stress)
    real(dp) :: lambda = 0.0_dp  !! Lame's first constant E nu/((1+nu)(1-2nu)) (stress)
  end type elastic_t

contains

  !> Elastic constants from density, Young's modulus and Poisson's ratio; -1 < poisson < 1/2.
  pure function elastic_init(density, young, poisson) result(law)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    real(dp), intent(in) :: young   !! Young's modulus (stress)
    real(dp), intent(in) :: poisson  !! Poisson's ratio
    type(elastic_t) :: law
    law%density = density
    law%young = young
    law%poisson = poisson
    law%bulk = young/(3.0_dp*(1.0_dp - 2.0_dp*poisson))
    law%shear = young/(2.0_dp*(1.0_dp + poisson))
    law%lambda = young*poisson/((1.0_dp + poisson)*(1.0_dp - 2.0_dp*poisson))
  end function elastic_init

  !> Modulus K + 4/3 G of plane longitudinal waves (stress).
  pure function elastic_p_wave_modulus(law) result(modulus)
    type(elastic_t), intent(in) :: law  !! elastic constants
    real(dp) :: modulus
    modulus = law%bulk + (4.0_dp/3.0_dp)*law%shear
  end function elastic_p_wave_modulus

  !> Squared speed (K + 4/3 G)/rho of longitudinal waves at the current density (theory 4).
  pure function elastic_sound_speed_squared(law, density) result(speed_squared)
    type(elastic_t), intent(in) :: law  !! elastic constants
    real(dp), intent(in) :: density     !! current density (mass/volume)
    real(dp) :: speed_squared
    speed_squared = elastic_p_wave_modulus(law)/density
  end function elastic_sound_speed_squared

end module sgmp_material_elastic
