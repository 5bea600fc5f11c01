!> Matter that lies under its own weight at the start: which laws can, what state a fluid has below
!! its surface, and the elastic energy of a stress.
!!
!! A fluid that settles without heat goes along its isentrope, dE = -p dv, and its pressure grows
!! with the depth d by dp = rho g dd, rho = rho0/v. Both are integrated by Runge and Kutta's method
!! of fourth order, first at the surface from v = 1 to the pressure there, then down.
module sgmp_material_weight
  use sgmp_constitutive, only: constitutive_t, eos_none, eos_terms, law_is_spherical, &
                               material_concrete, material_explosive, material_fluid, &
                               material_johnson_holmquist, material_mooney_rivlin, &
                               material_names, material_neo_hookean
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: fluid_below, law_bears_stress, laws_that_bear_stress, stress_energy

  !> Laws whose stress follows from the volume or the deformation.
  integer, parameter :: stressless(*) = [material_explosive, material_neo_hookean, &
                                         material_mooney_rivlin, material_johnson_holmquist, &
                                         material_concrete]
  integer, parameter :: parts = 32           !! of each of the two ways
  real(dp), parameter :: reached = 1.0e-6_dp  !! of the pressure, relative: else there is no state

contains

  !> Whether particles of a law can have a stress at the start: that of a tensor they keep and no
  !! volume contradicts, or a pressure that their volume can have.
  pure function law_bears_stress(law) result(yes)
    type(constitutive_t), intent(in) :: law
    logical :: yes
    yes = all(law%kind /= stressless) .and. &
          (law%eos == eos_none .neqv. law_is_spherical(law)) .and. &
          .not. (law%softens .or. law%porosity%porous)
  end function law_bears_stress

  !> Names of the solids whose particles can, for messages.
  pure function laws_that_bear_stress() result(text)
    character(:), allocatable :: text
    integer :: kind
    text = ''
    do kind = 1, size(material_names)
      if (any(kind == stressless) .or. kind == material_fluid) cycle
      if (text /= '') text = text//', '
      text = text//trim(material_names(kind))
    end do
  end function laws_that_bear_stress

  !> Volume over initial volume, energy per initial volume and pressure of a fluid at a depth.
  pure subroutine fluid_below(law, surface, gravity, depth, v, energy, pressure, ok)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: surface            !! pressure at depth 0 (stress)
    real(dp), intent(in) :: gravity            !! its absolute value
    real(dp), intent(in) :: depth              !! at least 0 (length)
    real(dp), intent(out) :: v, energy, pressure
    logical, intent(out) :: ok                 !! the equation has such a state
    real(dp) :: state(2), start
    state = [1.0_dp, law%history%first_energy]
    start = -law%history%first_mean_stress
    ok = .true.
    call follow(law, surface - start, 0.0_dp, state, ok)
    call pressure_of(law, state, pressure)
    ok = ok .and. abs(pressure - surface) <= reached*(abs(start) + abs(surface))
    call follow(law, 0.0_dp, law%density*gravity*depth, state, ok)
    call pressure_of(law, state, pressure)
    v = state(1)
    energy = state(2)
  end subroutine fluid_below

  !> Follows an isentrope until the pressure has grown, or the weight of a fluid of the initial
  !! density would have made it grow, by so much.
  pure subroutine follow(law, growth, weight, state, ok)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: growth, weight     !! one of them is 0 (stress)
    real(dp), intent(inout) :: state(2)        !! v, E
    logical, intent(inout) :: ok
    real(dp) :: k1(2), k2(2), k3(2), k4(2), a, b
    integer :: i
    if (.not. abs(growth) + abs(weight) > 0.0_dp) return
    a = growth/parts
    b = weight/parts
    do i = 1, parts
      call slope(law, a, b, state, k1, ok)
      call slope(law, a, b, state + 0.5_dp*k1, k2, ok)
      call slope(law, a, b, state + 0.5_dp*k2, k3, ok)
      call slope(law, a, b, state + k3, k4, ok)
      state = state + (k1 + 2.0_dp*k2 + 2.0_dp*k3 + k4)/6.0_dp
    end do
  end subroutine follow

  !> Change of v and E along the isentrope while the pressure grows by `growth` + `weight`/v.
  pure subroutine slope(law, growth, weight, state, change, ok)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: growth, weight, state(2)
    real(dp), intent(out) :: change(2)
    logical, intent(inout) :: ok
    real(dp) :: a0, b0, da, db, p, stiffness
    change = 0.0_dp
    if (.not. (ok .and. state(1) > 0.0_dp)) then
      ok = .false.
      return
    end if
    call eos_terms(law, state(1), state(2), a0, b0, da, db)
    p = a0 + b0*state(2)
    stiffness = -(da + db*state(2) - b0*p)
    ok = stiffness > 0.0_dp
    if (.not. ok) return
    change(1) = -(growth + weight/state(1))/stiffness
    change(2) = -p*change(1)
  end subroutine slope

  pure subroutine pressure_of(law, state, pressure)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: state(2)
    real(dp), intent(out) :: pressure
    real(dp) :: a0, b0, da, db
    call eos_terms(law, state(1), state(2), a0, b0, da, db)
    pressure = a0 + b0*state(2)
  end subroutine pressure_of

  !> Elastic energy per volume of a stress, with the moduli of matter at rest:
  !! s:s/(4 G) + m^2/(2 K), s the deviator and m the mean.
  pure function stress_energy(law, stress) result(energy)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: stress(:)          !! 3 to 6 components in the order of sgmp_voigt
    real(dp) :: energy, mean
    mean = sum(stress(:3))/3.0_dp
    energy = (sum((stress(:3) - mean)**2) + 2.0_dp*sum(stress(4:)**2))/(4.0_dp*law%elastic%shear) &
             + mean**2/(2.0_dp*law%elastic%bulk)
  end function stress_energy

end module sgmp_material_weight
