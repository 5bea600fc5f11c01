!> Isotropic linear elasticity: the moduli that every solid material starts from (theory 4).
module sgmp_material_elastic
  use sgmp_keys, only: key, key_t, kind_real, kind_word, values_t
  use sgmp_kinds, only: dp
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: elastic_t, elastic_init, elastic_p_wave_modulus, elastic_sound_speed_squared
  public :: moduli_keys, moduli_read, elastic_keys, elastic_read, neo_hookean_read

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

  !> Keys of what every solid has.
  function moduli_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('young', kind_real, "Young's modulus", unit='stress', range='(0,inf)', &
                required=.true.), &
            key('poisson', kind_real, "Poisson's ratio", range='(-1,0.5)', required=.true.)]
  end function moduli_keys

  !> Moduli from the values of those keys.
  pure function moduli_read(density, values) result(law)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(elastic_t) :: law
    law = elastic_init(density, values%number('young'), values%number('poisson'))
  end function moduli_read

  !> Keys of the elastic law.
  function elastic_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [moduli_keys(), &
            key('strain', kind_word, 'small: the linear theory, with constant volume and '// &
                'no rotation of the stress', choices='finite small', default='finite', &
                source='the class in which the energy identities hold')]
  end function elastic_keys

  !> Elastic law from the values of its keys.
  pure subroutine elastic_read(density, values, law, small_strain)
    real(dp), intent(in) :: density
    class(values_t), intent(in) :: values
    type(elastic_t), intent(out) :: law
    logical, intent(out) :: small_strain  !! the linear theory
    law = moduli_read(density, values)
    small_strain = values%word('strain') == 'small'
  end subroutine elastic_read

  !> Neo-Hookean law: the same moduli, and the deformation gradient of each particle.
  pure subroutine neo_hookean_read(density, values, law, history)
    real(dp), intent(in) :: density
    class(values_t), intent(in) :: values
    type(elastic_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    law = moduli_read(density, values)
    history%deformation = .true.
  end subroutine neo_hookean_read

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
