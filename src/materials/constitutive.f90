!> The table of materials and equations of state, and what a body is made of as the stress update
!! needs it: constants, and where its particles keep their history.
!!
!! A law is described in a module of its own, material_<law>.f90: keys of the deck, constants and
!! how they come from the values of the keys, history, kernel. Here it has a number, a name, a
!! component of `constitutive_t`, and a case in law_keys, law_pressure and law_read; its kernel is
!! called in stress_update.F90. An equation of state has a number, a name, a component, and a case
!! in eos_keys, eos_set, eos_terms and eos_lanes (and in eos_linear, where the pressure is not
!! linear in the energy). Nothing else knows of them.
!!
!! Longer than 500 lines: one table, with a case for each law and each equation of state.
module sgmp_constitutive
  use sgmp_afterburn, only: afterburn_keys, afterburn_read, afterburn_t
  use sgmp_averaging, only: averaging_make, averaging_t
  use sgmp_burn, only: burn_keys, burn_read
  use sgmp_ductility, only: ductility_check, ductility_given
  use sgmp_eos, only: eos_sound_speed_squared
  use sgmp_eos_gruneisen, only: gruneisen_keys, gruneisen_lanes, gruneisen_read, gruneisen_t, &
                                gruneisen_terms
  use sgmp_eos_jwl, only: jwl_keys, jwl_lanes, jwl_read, jwl_t, jwl_terms
  use sgmp_eos_polynomial, only: polynomial_keys, polynomial_lanes, polynomial_read, polynomial_t, &
                                 polynomial_terms
  use sgmp_eos_shock, only: shock_keys, shock_lanes, shock_read, shock_t, shock_terms
  use sgmp_eos_stiffened_gas, only: ideal_gas_keys, stiffened_gas_keys, stiffened_gas_lanes, &
                                    stiffened_gas_read, stiffened_gas_t, stiffened_gas_terms
  use sgmp_eos_table, only: table_gaseous, table_keys, table_lanes, table_read, table_t, &
                            table_terms
  use sgmp_eos_tait, only: tait_keys, tait_lanes, tait_read, tait_t, tait_terms
  use sgmp_eos_tillotson, only: tillotson_check, tillotson_keys, tillotson_lanes, &
                                tillotson_read, tillotson_t, tillotson_terms
  use sgmp_erosion, only: erosion_read, erosion_t
  use sgmp_failure, only: carries_everything, failure_by_strain, failure_none, failure_read, &
                          failure_set_spall, failure_softens, failure_t
  use sgmp_flaws, only: flaws_crack_speed
  use sgmp_heating, only: heating_t
  use sgmp_keys, only: fault_make, fault_t, key_t, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_cam_clay, only: cam_clay_keys, cam_clay_read, cam_clay_t
  use sgmp_material_concrete, only: concrete_keys, concrete_read, concrete_t
  use sgmp_material_crushable_foam, only: crushable_foam_keys, crushable_foam_read, crushable_foam_t
  use sgmp_material_drucker_prager, only: drucker_prager_read, drucker_prager_t
  use sgmp_material_elastic, only: elastic_keys, elastic_read, elastic_t, moduli_keys, &
                                   moduli_read, neo_hookean_read
  use sgmp_material_fluid, only: fluid_keys, fluid_read
  use sgmp_material_history, only: history_t, slots_ask_history, slots_t
  use sgmp_material_j2, only: j2_keys, j2_read, j2_t, j2_yield_stress
  use sgmp_material_jc, only: jc_keys, jc_read, jc_t, jc_yield_stress
  use sgmp_material_johnson_holmquist, only: johnson_holmquist_keys, johnson_holmquist_read, &
                                             johnson_holmquist_t
  use sgmp_material_mohr_coulomb, only: mohr_coulomb_read, mohr_coulomb_t
  use sgmp_material_mooney_rivlin, only: mooney_rivlin_keys, mooney_rivlin_read, mooney_rivlin_t
  use sgmp_material_steinberg_guinan, only: steinberg_guinan_keys, steinberg_guinan_read, &
                                            steinberg_guinan_t, steinberg_guinan_yield_stress
  use sgmp_material_zerilli_armstrong, only: zerilli_armstrong_keys, zerilli_armstrong_read, &
                                             zerilli_armstrong_t, zerilli_armstrong_yield_stress
  use sgmp_porosity, only: porosity_keys, porosity_read, porosity_speed_ratio, porosity_t, &
                           porosity_terms
  use sgmp_softening, only: softening_make, softening_t, softening_widest
  use sgmp_soil, only: soil_keys
  use sgmp_strength, only: scatter_t, yield_scatter_keys, yield_scatter_read
  use sgmp_viscosity, only: viscosity_of_pulses, viscosity_of_shocks, viscosity_of_soils, &
                            viscosity_read, viscosity_t
  use sgmp_voigt, only: stress_components
  implicit none
  private
  public :: constitutive_t
  public :: material_elastic, material_neo_hookean, material_j2, material_johnson_cook, &
            material_explosive, material_fluid, material_drucker_prager, material_mohr_coulomb, &
            material_mooney_rivlin, material_steinberg_guinan, material_zerilli_armstrong, &
            material_johnson_holmquist, material_cam_clay, material_crushable_foam, &
            material_concrete, material_names
  public :: eos_none, eos_jwl, eos_gruneisen, eos_ideal_gas, eos_stiffened_gas, eos_polynomial, &
            eos_tait, eos_shock, eos_tillotson, eos_table, eos_names
  public :: law_keys, law_read, law_slots, law_check, law_set_average, law_set_length, &
            law_widest_band, law_yield_stress
  public :: eos_keys, eos_lanes, eos_linear, eos_read, eos_state, eos_terms
  public :: law_set_failure, law_set_viscosity, law_set_erosion, law_set_spall
  public :: law_bends, law_by_cells, law_gaseous, law_is_metal, law_is_spherical, law_is_springy, &
            law_liquid
  public :: law_bulk, law_may_tear, law_sound, law_tear, law_tears, law_wave_modulus, law_young
  public :: law_cavitate, law_first_pressure, law_may_cavitate, law_may_shock, law_spread_shocks

  integer, parameter :: material_elastic = 1, material_neo_hookean = 2, material_j2 = 3, &
                        material_johnson_cook = 4, material_explosive = 5, material_fluid = 6, &
                        material_drucker_prager = 7, material_mohr_coulomb = 8, &
                        material_mooney_rivlin = 9, material_steinberg_guinan = 10, &
                        material_zerilli_armstrong = 11, material_johnson_holmquist = 12, &
                        material_cam_clay = 13, material_crushable_foam = 14, &
                        material_concrete = 15
  character(17), parameter :: material_names(*) = [character(17) :: &
    'elastic', 'neo_hookean', 'j2', 'johnson_cook', 'explosive', 'fluid', &
    'drucker_prager', 'mohr_coulomb', 'mooney_rivlin', 'steinberg_guinan', 'zerilli_armstrong', &
    'johnson_holmquist', 'cam_clay', 'crushable_foam', 'concrete']

  integer, parameter :: eos_none = 0, eos_jwl = 1, eos_gruneisen = 2, eos_ideal_gas = 3, &
                        eos_stiffened_gas = 4, eos_polynomial = 5, eos_tait = 6, eos_shock = 7, &
                        eos_tillotson = 8, eos_table = 9
  character(16), parameter :: eos_names(*) = [character(16) :: &
    'jwl', 'gruneisen', 'ideal_gas', 'stiffened_gas', 'polynomial', 'tait', &
    'shock', 'tillotson', 'table']

  !> Where the pressure of a law comes from.
  integer, parameter :: pressure_own = 1       !! the law itself: it takes no equation of state
  integer, parameter :: pressure_either = 2    !! the bulk modulus, or an equation for solids
  integer, parameter :: pressure_products = 3  !! an equation for detonation products
  integer, parameter :: pressure_state = 4     !! any other equation of state

  !> Of the speed of sound or detonation at the start: the least that an equation of state returns.
  real(dp), parameter :: slowest_part = 1.0e-3_dp

  integer, parameter :: most_tangents = 30     !! to a first energy

  !> Law and constants of one material.
  type :: constitutive_t
    integer :: kind = 0                        !! one of material_*
    integer :: eos = 0                         !! one of eos_*
    type(history_t) :: history
    type(slots_t) :: slots
    type(elastic_t) :: elastic
    type(j2_t) :: j2
    type(jc_t) :: jc
    type(drucker_prager_t) :: soil
    type(mohr_coulomb_t) :: mohr_coulomb
    type(mooney_rivlin_t) :: mooney_rivlin
    type(steinberg_guinan_t) :: steinberg_guinan
    type(zerilli_armstrong_t) :: zerilli_armstrong
    type(johnson_holmquist_t) :: johnson_holmquist
    type(cam_clay_t) :: cam_clay
    type(crushable_foam_t) :: crushable_foam
    type(concrete_t) :: concrete
    type(heating_t) :: heating                 !! where compression warms, too
    type(jwl_t) :: jwl
    type(afterburn_t) :: afterburn             !! of detonation products
    type(gruneisen_t) :: gruneisen
    type(stiffened_gas_t) :: gas               !! the ideal gas, too
    type(polynomial_t) :: polynomial
    type(tait_t) :: tait
    type(shock_t) :: shock
    type(tillotson_t) :: tillotson
    type(table_t) :: table
    type(porosity_t) :: porosity
    integer :: kept = 1                        !! columns of an equation of state: energy,
                                               !! distention of porous material, shift of pores
    real(dp) :: fluid_viscosity = 0.0_dp       !! Newton's, of a fluid (stress times time)
    real(dp) :: ambient = 0.0_dp               !! pressure all around, which the grid does not
                                               !! feel (sgmp_edge_pressure)
    logical :: small_strain = .false.          !! the linear theory: constant volume, no spin
    logical :: rigid = .false.                 !! prescribed motion: no stress
    logical :: thermal = .false.
    logical :: fails = .false.                 !! by damage, or a fluid's tension is bounded
    type(failure_t) :: failure
    logical :: softens = .false.               !! it fails little by little
    type(averaging_t) :: averaging             !! of the plastic strain that drives failure
    real(dp) :: apart = 1.0e30_dp           !! volume over the first at which it fails in any case
    type(softening_t) :: softening
    type(erosion_t) :: erosion
    type(scatter_t) :: scatter                 !! of the yield stress
    real(dp) :: density = 0.0_dp               !! initial density
    real(dp) :: detonation_speed = 0.0_dp, burn_cells = 0.0_dp
    logical :: viscous = .false.               !! bulk viscosity acts
    logical :: across = .false.                !! and that across fronts alone
    type(viscosity_t) :: viscosity
    real(dp) :: bulk_speed = 0.0_dp            !! of sound in the bulk at the start, without shear
    real(dp) :: slowest = 0.0_dp               !! least sound speed an equation of state may return
    real(dp) :: h = 0.0_dp  !! cell side, the length of the viscosity and of the burn front
    real(dp) :: side(lanes) = 1.0_dp           !! of a chunk where cells are unequal: what the
                                               !! length of the viscosity is times that
    logical :: unequal = .false.               !! cells are, and these are the sides of a chunk's
    real(dp) :: cells(lanes, 3) = 1.0_dp       !! along the axes (h); without an axis their mean
  end type constitutive_t

contains

  !> Keys of a law, besides its density.
  function law_keys(kind) result(keys)
    integer, intent(in) :: kind  !! one of material_*
    type(key_t), allocatable :: keys(:)
    select case (kind)
    case (material_elastic)
      keys = elastic_keys()
    case (material_neo_hookean)
      keys = moduli_keys()
    case (material_j2)
      keys = [moduli_keys(), j2_keys(), yield_scatter_keys()]
    case (material_johnson_cook)
      keys = [moduli_keys(), jc_keys(), yield_scatter_keys()]
    case (material_fluid)
      keys = fluid_keys()
    case (material_drucker_prager, material_mohr_coulomb)
      keys = [moduli_keys(), soil_keys()]
    case (material_mooney_rivlin)
      keys = mooney_rivlin_keys()
    case (material_steinberg_guinan)
      keys = [moduli_keys(), steinberg_guinan_keys(), yield_scatter_keys()]
    case (material_zerilli_armstrong)
      keys = [moduli_keys(), zerilli_armstrong_keys(), yield_scatter_keys()]
    case (material_johnson_holmquist)
      keys = johnson_holmquist_keys()
    case (material_cam_clay)
      keys = cam_clay_keys()
    case (material_crushable_foam)
      keys = [moduli_keys(), crushable_foam_keys()]
    case (material_concrete)
      keys = concrete_keys()
    case default  ! material_explosive
      keys = burn_keys()
    end select
  end function law_keys

  !> Where the pressure of a law comes from: one of pressure_*.
  pure integer function law_pressure(kind) result(pressure)
    integer, intent(in) :: kind  !! one of material_*
    select case (kind)
    case (material_elastic, material_neo_hookean, material_mohr_coulomb, &
          material_mooney_rivlin, material_johnson_holmquist, material_cam_clay, &
          material_crushable_foam, material_concrete)
      pressure = pressure_own
    case (material_explosive)
      pressure = pressure_products
    case (material_fluid)
      pressure = pressure_state
    case default
      pressure = pressure_either
    end select
  end function law_pressure

  !> A law from the values of its keys.
  pure subroutine law_read(kind, values, law, fault)
    integer, intent(in) :: kind  !! one of material_*
    class(values_t), intent(in) :: values
    type(constitutive_t), intent(out) :: law
    type(fault_t), allocatable, intent(out) :: fault
    law%kind = kind
    law%density = values%number('density')
    law%scatter = yield_scatter_read(values)
    select case (kind)
    case (material_elastic)
      call elastic_read(law%density, values, law%elastic, law%small_strain)
    case (material_neo_hookean)
      call neo_hookean_read(law%density, values, law%elastic, law%history)
    case (material_j2)
      call solid_read(values, law)
      call j2_read(values, law%j2, law%history)
    case (material_johnson_cook)
      call solid_read(values, law)
      call jc_read(law%density, values, law%jc, law%history, fault)
      law%thermal = law%jc%thermal
      law%fails = law%jc%failure
    case (material_drucker_prager)
      call solid_read(values, law)
      call drucker_prager_read(values, law%soil, law%history, fault)
    case (material_mohr_coulomb)
      call solid_read(values, law)
      call mohr_coulomb_read(values, law%mohr_coulomb, law%history, fault)
    case (material_mooney_rivlin)
      call mooney_rivlin_read(law%density, values, law%mooney_rivlin, law%elastic, law%history, &
                              fault)
    case (material_steinberg_guinan)
      call solid_read(values, law)
      call steinberg_guinan_read(law%density, values, law%steinberg_guinan, law%history, fault)
      law%heating = law%steinberg_guinan%heating
    case (material_zerilli_armstrong)
      call solid_read(values, law)
      call zerilli_armstrong_read(law%density, values, law%zerilli_armstrong, law%history, fault)
      law%heating = law%zerilli_armstrong%heating
    case (material_johnson_holmquist)
      call johnson_holmquist_read(law%density, values, law%johnson_holmquist, law%elastic, &
                                  law%history, fault)
      law%bulk_speed = sqrt(law%elastic%bulk/law%density)
    case (material_cam_clay)
      call cam_clay_read(law%density, values, law%cam_clay, law%elastic, law%history, fault)
      law%bulk_speed = sqrt(law%elastic%bulk/law%density)
    case (material_crushable_foam)
      call solid_read(values, law)
      call crushable_foam_read(values, law%crushable_foam, law%history, fault)
    case (material_concrete)
      call concrete_read(law%density, values, law%concrete, law%elastic, law%history, fault)
      law%bulk_speed = sqrt(law%elastic%bulk/law%density)
    case (material_fluid)
      call fluid_read(values, law%fluid_viscosity, law%history)
    case default  ! material_explosive
      call burn_read(values, law%detonation_speed, law%burn_cells, law%history)
    end select
  end subroutine law_read

  !> Moduli of a solid.
  pure subroutine solid_read(values, law)
    class(values_t), intent(in) :: values
    type(constitutive_t), intent(inout) :: law
    law%elastic = moduli_read(law%density, values)
    law%bulk_speed = sqrt(law%elastic%bulk/law%density)
  end subroutine solid_read

  !> Keys of an equation of state, besides its initial energy or pressure.
  function eos_keys(eos) result(keys)
    integer, intent(in) :: eos  !! one of eos_*
    type(key_t), allocatable :: keys(:)
    select case (eos)
    case (eos_jwl)
      keys = [jwl_keys(), afterburn_keys()]
    case (eos_ideal_gas)
      keys = ideal_gas_keys()
    case (eos_stiffened_gas)
      keys = stiffened_gas_keys()
    case (eos_polynomial)
      keys = polynomial_keys()
    case (eos_tait)
      keys = tait_keys()
    case (eos_shock)
      keys = [shock_keys(), porosity_keys()]
    case (eos_tillotson)
      keys = tillotson_keys()
    case (eos_table)
      keys = table_keys()
    case default  ! eos_gruneisen
      keys = [gruneisen_keys(), porosity_keys()]
    end select
  end function eos_keys

  !> Gives a law an equation of state from the values of its keys, and the state it starts from.
  pure subroutine eos_read(eos, values, law, fault)
    integer, intent(in) :: eos  !! one of eos_*
    class(values_t), intent(in) :: values
    type(constitutive_t), intent(inout) :: law
    type(fault_t), allocatable, intent(out) :: fault
    call porosity_read(law%density, values, law%porosity, law%history, fault)
    if (law%porosity%porous) law%kept = 2
    if (law%porosity%elastic) law%kept = 3
    call eos_set(eos, values, law%density*law%porosity%distention, law)
    if (eos == eos_tillotson) call tillotson_check(law%tillotson, fault)
    if (eos == eos_table) call table_read(law%density, values, law%table, fault)
    law%history%energy = .true.
    law%history%first_energy = values%number('energy0')
    if (eos == eos_jwl) then
      call afterburn_read(values, law%afterburn, law%history, fault)
      law%slowest = slowest_part*law%detonation_speed
    else if (.not. allocated(fault)) then
      call start_state(values, law, fault)
    end if
    if (law%kind == material_drucker_prager) then
      law%failure%tension = law%soil%tension
      if (law%soil%dilatancy > 0.0_dp .and. .not. allocated(fault)) then
        call fault_make(fault, '', 'the pressure of an equation of state does not know a '// &
                        'dilatancy', 'remove dilatancy of the material')
      end if
    end if
    if (law%porosity%porous .and. law%heating%warms .and. .not. allocated(fault)) then
      call fault_make(fault, 'distention', 'the temperature of porous material is not known', &
                      'remove specific_heat of the material')
    end if
  end subroutine eos_read

  !> Constants of an equation of state from the values of its keys.
  pure subroutine eos_set(eos, values, density, law)
    integer, intent(in) :: eos  !! one of eos_*
    class(values_t), intent(in) :: values
    real(dp), intent(in) :: density  !! of the solid, where matter is porous
    type(constitutive_t), intent(inout) :: law
    law%eos = eos
    select case (eos)
    case (eos_jwl)
      law%jwl = jwl_read(values)
    case (eos_ideal_gas, eos_stiffened_gas)
      law%gas = stiffened_gas_read(values)
    case (eos_polynomial)
      law%polynomial = polynomial_read(values)
    case (eos_tait)
      law%tait = tait_read(density, values)
    case (eos_shock)
      law%shock = shock_read(density, values)
    case (eos_tillotson)
      law%tillotson = tillotson_read(density, values)
    case (eos_table)  ! read where its faults can be said
    case default  ! eos_gruneisen
      law%gruneisen = gruneisen_read(density, values)
    end select
  end subroutine eos_set

  !> Pressure and the square of the speed of sound of a law's equation of state.
  pure subroutine eos_state(law, v, energy, pressure, speed_squared)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v                  !! volume over initial volume
    real(dp), intent(in) :: energy             !! per initial volume
    real(dp), intent(out) :: pressure          !! (stress)
    real(dp), intent(out) :: speed_squared     !! negative where there are no waves
    real(dp) :: a0, b0, da, db
    call eos_terms(law, v, energy, a0, b0, da, db)
    pressure = a0 + b0*energy
    speed_squared = eos_sound_speed_squared(law%density, v, pressure, energy, da, db, b0, 1.0_dp)
  end subroutine eos_state

  !> Whether the pressure is linear in the energy, so that the terms do not depend on it.
  elemental logical function eos_linear(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%eos /= eos_tillotson .and. law%eos /= eos_table
  end function eos_linear

  !> Terms of p = a0 + b0 E of a law's equation of state at a volume and an energy, and their
  !! derivatives with respect to the volume. Where the pressure is not linear in E that is its
  !! tangent: a0 + b0 E and da + db E are p and dp/dv at this E.
  pure subroutine eos_terms(law, v, energy, a0, b0, da, db)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v                  !! volume over initial volume
    real(dp), intent(in) :: energy             !! per initial volume
    real(dp), intent(out) :: a0, b0, da, db    !! (stress), 1, d/dv of both
    select case (law%eos)
    case (eos_jwl)
      call jwl_terms(law%jwl, v, a0, b0, da, db)
    case (eos_ideal_gas, eos_stiffened_gas)
      call stiffened_gas_terms(law%gas, v, a0, b0, da, db)
    case (eos_polynomial)
      call polynomial_terms(law%polynomial, v, a0, b0, da, db)
    case (eos_tait)
      call tait_terms(law%tait, v, a0, b0, da, db)
    case (eos_shock)
      call shock_terms(law%shock, v, a0, b0, da, db)
    case (eos_tillotson)
      call tillotson_terms(law%tillotson, v, energy, a0, b0, da, db)
    case (eos_table)
      call table_terms(law%table, v, energy, a0, b0, da, db)
    case default  ! eos_gruneisen
      call gruneisen_terms(law%gruneisen, v, a0, b0, da, db)
    end select
  end subroutine eos_terms

  !> Lane kernel of eos_terms: one choice for all lanes.
  pure subroutine eos_lanes(law, v, energy, a0, b0, da, db)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v(lanes), energy(lanes)
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)
    select case (law%eos)
    case (eos_jwl)
      call jwl_lanes(law%jwl, v, a0, b0, da, db)
    case (eos_ideal_gas, eos_stiffened_gas)
      call stiffened_gas_lanes(law%gas, v, a0, b0, da, db)
    case (eos_polynomial)
      call polynomial_lanes(law%polynomial, v, a0, b0, da, db)
    case (eos_tait)
      call tait_lanes(law%tait, v, a0, b0, da, db)
    case (eos_shock)
      call shock_lanes(law%shock, v, a0, b0, da, db)
    case (eos_tillotson)
      call tillotson_lanes(law%tillotson, v, energy, a0, b0, da, db)
    case (eos_table)
      call table_lanes(law%table, v, energy, a0, b0, da, db)
    case default  ! eos_gruneisen
      call gruneisen_lanes(law%gruneisen, v, a0, b0, da, db)
    end select
  end subroutine eos_lanes

  !> Energy, pressure and sound speed at the initial density; the energy follows from the pressure
  !! where that is given.
  pure subroutine start_state(values, law, fault)
    class(values_t), intent(in) :: values
    type(constitutive_t), intent(inout) :: law
    type(fault_t), allocatable, intent(out) :: fault
    real(dp) :: a0, b0, da, db, pressure, speed_squared
    call eos_terms(law, 1.0_dp, law%history%first_energy, a0, b0, da, db)
    call porosity_terms(law%porosity, law%porosity%distention, a0, b0, da, db)
    if (values%has('pressure0')) then
      if (abs(law%history%first_energy) > 0.0_dp) then
        call fault_make(fault, 'energy0', 'energy0 and pressure0 are both given', &
                        'keep one of them')
      else if (b0 > 0.0_dp) then
        call energy_of_pressure(law, values%number('pressure0'), a0, b0)
      else if (abs(values%number('pressure0') - a0) > 0.0_dp) then
        call fault_make(fault, 'pressure0', 'the pressure does not depend on the energy', &
                        "give the pressure by the equation's constants")
      end if
    end if
    call eos_terms(law, 1.0_dp, law%history%first_energy, a0, b0, da, db)
    call porosity_terms(law%porosity, law%porosity%distention, a0, b0, da, db)
    pressure = a0 + b0*law%history%first_energy
    law%history%first_mean_stress = 0.0_dp - pressure  ! no negative zero
    speed_squared = eos_sound_speed_squared(law%density, 1.0_dp, pressure, &
                                            law%history%first_energy, da, db, b0, 1.0_dp) &
                    *porosity_speed_ratio(law%porosity, law%porosity%distention)**2
    if (speed_squared > 0.0_dp) then
      law%bulk_speed = sqrt(speed_squared)
      law%slowest = slowest_part*law%bulk_speed
    else if (.not. allocated(fault)) then
      call fault_make(fault, '', 'the initial state has no speed of sound', &
                      'check the constants, and energy0 or pressure0')
    end if
  end subroutine start_state

  !> First energy by Newton's method, which a pressure linear in the energy needs one step of.
  pure subroutine energy_of_pressure(law, pressure, a0, b0)
    type(constitutive_t), intent(inout) :: law
    real(dp), intent(in) :: pressure           !! (stress)
    real(dp), intent(inout) :: a0, b0          !! terms, at the energy
    real(dp) :: da, db
    integer :: k
    law%history%first_energy = (pressure - a0)/b0
    if (eos_linear(law)) return
    do k = 1, most_tangents
      call eos_terms(law, 1.0_dp, law%history%first_energy, a0, b0, da, db)
      law%history%first_energy = (pressure - a0)/b0
    end do
  end subroutine energy_of_pressure

  !> Whether a law has the equation of state that it needs, and none that it does not know.
  pure subroutine law_check(law, name, fault)
    type(constitutive_t), intent(in) :: law
    character(*), intent(in) :: name  !! of the material
    type(fault_t), allocatable, intent(out) :: fault
    integer :: pressure
    pressure = law_pressure(law%kind)
    if (pressure == pressure_products .and. law%eos /= eos_jwl) then
      call fault_make(fault, '', trim(material_names(law%kind))//" '"//name// &
                      "' has no JWL equation", 'add: eos '//name// &
                      ' jwl a=… b=… r1=… r2=… omega=… energy0=…')
    else if (pressure /= pressure_products .and. law%eos == eos_jwl) then
      call fault_make(fault, '', "'"//name//"' has a JWL equation but no burn", &
                      'make it explosive')
    else if (pressure == pressure_state .and. law%eos == eos_none) then
      call fault_make(fault, '', trim(material_names(law%kind))//" '"//name// &
                      "' has no equation of state", 'add one, e.g. eos '//name//' tait c0=…')
    else if (pressure == pressure_own .and. law%eos /= eos_none) then
      call fault_make(fault, '', "the pressure of '"//name//"' is elastic already", &
                      'remove the card eos, or use j2 or johnson_cook')
    end if
  end subroutine law_check

  !> Gives a law criteria of failure from the values of its keys.
  pure subroutine law_set_failure(values, name, law, fault)
    class(values_t), intent(in) :: values
    character(*), intent(in) :: name  !! of the material
    type(constitutive_t), intent(inout) :: law
    type(fault_t), allocatable, intent(out) :: fault
    law%failure = failure_read(values)
    law%fails = .true.
    select case (law%kind)
    case (material_j2, material_johnson_cook, material_steinberg_guinan, material_zerilli_armstrong)
      law%history%damage = .true.
      law%history%averaged = law%failure%length > 0.0_dp
      law%softens = failure_softens(law%failure)
      call check_criteria(values, name, law, fault)
    case (material_fluid)
      if (.not. values%has('pmin') .or. any_given(values, &
                                                  [character(16) :: 'principal_stress', &
                                                   'plastic_strain', 'fracture_energy', &
                                                   'spall_strain', 'toughness', 'weibull', &
                                                   'length', 'plastic_work', 'flaws', &
                                                   'hosford_strain', 'hosford_exponent', &
                                                   'hosford_friction', 'hosford_power'])) then
        call fault_make(fault, '', "a fluid such as '"//name//"' fails by pmin alone", &
                        'give pmin, and no other criterion')
      end if
    case (material_johnson_holmquist, material_concrete)
      call fault_make(fault, '', "'"//name//"' ("//trim(material_names(law%kind))// &
                      ') fails by damage of its own', 'remove the card failure; erode '//name// &
                      ' failed=yes removes what has failed')
    case default
      call fault_make(fault, '', "'"//name//"' ("//trim(material_names(law%kind))// &
                      ') cannot fail', 'use j2, johnson_cook, steinberg_guinan, '// &
                      'zerilli_armstrong or fluid')
    end select
  end subroutine law_set_failure

  !> Whether a solid has criteria of failure that go together.
  pure subroutine check_criteria(values, name, law, fault)
    class(values_t), intent(in) :: values
    character(*), intent(in) :: name  !! of the material
    type(constitutive_t), intent(in) :: law
    type(fault_t), allocatable, intent(out) :: fault
    if (.not. (law%jc%failure .or. any_given(values, [character(16) :: &
                                                      'pmin', 'principal_stress', &
                                                      'plastic_strain', 'spall_strain', &
                                                      'toughness', 'length', 'plastic_work', &
                                                      'hosford_strain', 'flaws']))) then
      call fault_make(fault, '', "nothing says when '"//name//"' fails", &
                      'give pmin, principal_stress, plastic_strain, plastic_work or '// &
                      'hosford_strain, or johnson_cook failure=yes')
    end if
    call ductility_check(values, fault)
    if (.not. allocated(fault)) call check_flaws(values, fault)
    if (.not. allocated(fault)) call check_damage(law, name, fault)
    if (.not. allocated(fault) .and. values%has('length')) call check_length(law, name, fault)
    if (.not. allocated(fault)) call check_spall(values, name, fault)
    if (law%softens .and. .not. allocated(fault)) call check_softening(law, name, fault)
  end subroutine check_criteria

  !> Whether flaws have both constants, and are alone.
  pure subroutine check_flaws(values, fault)
    class(values_t), intent(in) :: values
    type(fault_t), allocatable, intent(out) :: fault
    if (values%has('flaws') .neqv. values%has('flaw_exponent')) then
      call fault_make(fault, '', 'Grady and Kipp need flaws and flaw_exponent', 'give both')
    else if (any_given(values, [character(16) :: 'crack_speed', 'flaw_count']) .and. &
             .not. values%has('flaws')) then
      call fault_make(fault, '', 'there are no flaws from which cracks run', &
                      'give flaws and flaw_exponent')
    else if (values%has('flaws') .and. &
             any_given(values, [character(16) :: 'pmin', 'principal_stress', 'plastic_strain', &
                                'spall_strain', 'toughness', 'plastic_work', 'hosford_strain', &
                                'fracture_energy', 'weibull', 'length'])) then
      call fault_make(fault, 'flaws', 'matter that breaks by its flaws has no other criterion', &
                      'keep flaws, flaw_exponent, crack_speed, seed and carries alone')
    end if
  end subroutine check_flaws

  !> Whether one thing alone makes the damage of a law grow.
  pure subroutine check_damage(law, name, fault)
    type(constitutive_t), intent(in) :: law
    character(*), intent(in) :: name  !! of the material
    type(fault_t), allocatable, intent(out) :: fault
    character(:), allocatable :: key
    if (.not. ductility_given(law%failure%ductility)) return
    key = 'hosford_strain'
    if (law%failure%ductility%work > 0.0_dp) key = 'plastic_work'
    if (law%jc%failure) then
      call fault_make(fault, key, "the damage of '"//name//"' grows by Johnson and Cook's "// &
                      'constants already', 'remove '//key//', or failure=yes of the material')
    else if (law%softens) then
      call fault_make(fault, key, "the damage of '"//name//"' grows by its softening already", &
                      'remove '//key//', or fracture_energy')
    end if
  end subroutine check_damage

  !> Whether something of a law is driven by plastic strain, and may be by its average.
  pure subroutine check_length(law, name, fault)
    type(constitutive_t), intent(in) :: law
    character(*), intent(in) :: name  !! of the material
    type(fault_t), allocatable, intent(out) :: fault
    if (.not. (law%jc%failure .or. law%jc%thermal .or. failure_by_strain(law%failure))) then
      call fault_make(fault, 'length', "no plastic strain drives the failure of '"//name//"'", &
                      'remove length; a crack in tension has its width by fracture_energy')
    else if (law%kind /= material_johnson_cook .and. law%heating%warms) then
      call fault_make(fault, 'length', "the heat of '"//name//"' ("// &
                      trim(material_names(law%kind))//') follows the strain of each particle', &
                      'use johnson_cook, or remove specific_heat')
    end if
  end subroutine check_length

  !> Whether any of some keys is given.
  pure logical function any_given(values, names) result(yes)
    class(values_t), intent(in) :: values
    character(*), intent(in) :: names(:)
    integer :: i
    yes = .false.
    do i = 1, size(names)
      yes = yes .or. values%has(trim(names(i)))
    end do
  end function any_given

  !> Whether a law's spall has one limit of tension, which softening can start from.
  pure subroutine check_spall(values, name, fault)
    class(values_t), intent(in) :: values
    character(*), intent(in) :: name  !! of the material
    type(fault_t), allocatable, intent(out) :: fault
    if (values%has('spall_strain') .and. values%has('toughness')) then
      call fault_make(fault, 'toughness', "'"//name//"' is ductile (spall_strain) and brittle "// &
                      '(toughness)', 'keep one of them')
    else if (values%has('spall_strain') .and. values%has('pmin')) then
      call fault_make(fault, 'pmin', 'spall_strain says at what tension it spalls', &
                      'keep one of them')
    else if (values%has('toughness') .and. .not. values%has('pmin')) then
      call fault_make(fault, 'toughness', "nothing says what tension '"//name//"' bears when "// &
                      'it opens slowly', 'add pmin, a tension that is borne at any rate')
    else if (values%has('toughness') .and. values%has('fracture_energy')) then
      call fault_make(fault, 'fracture_energy', 'softening starts from a limit that stays, and '// &
                      'that of toughness goes with the rate', 'remove one of them')
    end if
  end subroutine check_spall

  !> Gives a law that spalls by Grady's energies what they need of the other cards of its material.
  pure subroutine law_set_spall(law)
    type(constitutive_t), intent(inout) :: law
    real(dp) :: yield
    yield = 0.0_dp
    if (law%failure%spall_strain > 0.0_dp) yield = law_yield_stress(law, 0.0_dp)
    call failure_set_spall(law%failure, law%density, law%bulk_speed, yield)
    if (law%failure%flaws%speed <= 0.0_dp) then
      law%failure%flaws%speed = flaws_crack_speed &
                                *sqrt(law%bulk_speed**2 + 4.0_dp/3.0_dp*law%elastic%shear &
                                      /law%density)
    end if
  end subroutine law_set_spall

  !> Gives a law criteria of erosion from the values of its keys. What goes takes its internal
  !! energy along, which particles without an equation of state keep for that alone.
  pure subroutine law_set_erosion(values, name, law, fault)
    class(values_t), intent(in) :: values
    character(*), intent(in) :: name  !! of the material
    type(constitutive_t), intent(inout) :: law
    type(fault_t), allocatable, intent(out) :: fault
    law%erosion = erosion_read(values)
    law%history%energy = .true.
    if (.not. (values%has('plastic_strain') .or. values%has('time_step') .or. &
               values%flag('failed'))) then
      call fault_make(fault, '', "nothing says when particles of '"//name//"' go", &
                      'give plastic_strain, failed=yes or time_step')
    else if (values%has('plastic_strain') .and. .not. law%history%plastic) then
      call fault_make(fault, 'plastic_strain', "'"//name//"' ("//trim(material_names(law%kind))// &
                      ') has no plastic strain', 'use time_step, or a plastic material')
    else if (values%flag('failed') .and. .not. law%history%damage) then
      call fault_make(fault, 'failed', "'"//name//"' does not fail", 'add: failure '//name// &
                      ' pmin=…, or johnson_cook failure=yes')
    end if
  end subroutine law_set_erosion

  !> Whether a law that is to soften can.
  pure subroutine check_softening(law, name, fault)
    type(constitutive_t), intent(in) :: law
    character(*), intent(in) :: name  !! of the material
    type(fault_t), allocatable, intent(out) :: fault
    if (law%jc%failure) then
      call fault_make(fault, softener(law), "the damage of '"//name// &
                      "' grows by Johnson and Cook's constants already", &
                      'remove '//softener(law)//', or failure=yes of the material')
    else if (law%failure%carries == carries_everything) then
      call fault_make(fault, softener(law), "'"//name//"' carries everything when it has "// &
                      'failed, and does not soften', &
                      'remove '//softener(law)//', or carries=everything')
    end if
  end subroutine check_softening

  !> The key by which a law softens.
  pure function softener(law) result(key)
    type(constitutive_t), intent(in) :: law
    character(:), allocatable :: key
    key = 'fracture_energy'
    if (law%failure%flaws%number > 0.0_dp) key = 'flaws'
  end function softener

  !> Gives a law its lengths: the side of the cells, for viscosity and burn front, and the width of
  !! the band in which a crack opens.
  pure subroutine law_set_length(law, h, band)
    type(constitutive_t), intent(inout) :: law
    real(dp), intent(in) :: h, band
    real(dp) :: yield
    law%h = h
    if (.not. law%softens) return
    yield = 0.0_dp
    if (law%failure%plastic_strain < failure_none) then
      yield = law_yield_stress(law, law%failure%plastic_strain)
    end if
    law%softening = softening_make(law%failure, law%density*law%bulk_speed**2, law%elastic%shear, &
                                   yield, band)
  end subroutine law_set_length

  !> Gives a law that averages its plastic strain what it must know of the grid, after its lengths.
  !! A band of softening is then not narrower than twice the length: of a strain that is gathered at
  !! a point the average is exp(-|x|/l)/(2 l).
  pure subroutine law_set_average(law, h, spread, band)
    type(constitutive_t), intent(inout) :: law
    real(dp), intent(in) :: h, spread     !! of averaging_make
    real(dp), intent(in) :: band          !! as of law_set_length
    type(softening_t) :: wide
    if (.not. law%history%averaged) return
    law%averaging = averaging_make(law%failure%length, law%bulk_speed, h, spread)
    if (.not. law%softens .or. .not. law%failure%plastic_strain < failure_none) return
    wide = softening_make(law%failure, law%density*law%bulk_speed**2, law%elastic%shear, &
                          law_yield_stress(law, law%failure%plastic_strain), &
                          max(band, 2.0_dp*law%failure%length))
    law%softening%plastic = wide%plastic
  end subroutine law_set_average

  !> Yield stress at a plastic strain, in the room and at the rate of reference.
  pure function law_yield_stress(law, strain) result(yield)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: strain
    real(dp) :: yield
    select case (law%kind)
    case (material_j2)
      yield = j2_yield_stress(law%j2, strain)
    case (material_steinberg_guinan)
      yield = steinberg_guinan_yield_stress(law%steinberg_guinan, strain)
    case (material_zerilli_armstrong)
      yield = zerilli_armstrong_yield_stress(law%zerilli_armstrong, strain, &
                                             law%zerilli_armstrong%reference_rate, law%heating%room)
    case default  ! material_johnson_cook
      yield = jc_yield_stress(law%jc, strain, law%jc%reference_rate, law%jc%room)
    end select
  end function law_yield_stress

  !> Width of the widest band in which a law can soften; huge where it does not.
  pure function law_widest_band(law) result(width)
    type(constitutive_t), intent(in) :: law
    real(dp) :: width
    width = huge(1.0_dp)
    if (law%failure%fracture_energy > 0.0_dp .and. law%softens .and. law%bulk_speed > 0.0_dp) then
      width = softening_widest(law%failure, law%density*law%bulk_speed**2, law%elastic%shear)
    end if
  end function law_widest_band

  !> Gives a law bulk viscosity from the values of its keys.
  pure subroutine law_set_viscosity(values, law)
    class(values_t), intent(in) :: values
    type(constitutive_t), intent(inout) :: law
    call set_viscosity(viscosity_read(values), law)
  end subroutine law_set_viscosity

  pure subroutine set_viscosity(viscosity, law)
    type(viscosity_t), intent(in) :: viscosity
    type(constitutive_t), intent(inout) :: law
    law%viscosity = viscosity
    law%viscous = viscosity%quadratic > 0.0_dp .or. viscosity%linear > 0.0_dp
    law%across = law%viscous .and. law_is_spherical(law)
  end subroutine set_viscosity

  !> Whether a material that shocks can run through has no card that says how they are spread.
  elemental logical function law_may_shock(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = .not. (law%viscosity%given .or. law%rigid) .and. &
          (law%eos /= eos_none .or. any(law%kind == [material_johnson_holmquist, &
                                                     material_concrete]))
  end function law_may_shock

  !> Such a material gets the bulk viscosity that shocks want. In soil, particles that ring would
  !! lose the shear that friction bears each time that their pressure falls.
  pure subroutine law_spread_shocks(law, burst)
    type(constitutive_t), intent(inout) :: law
    logical, intent(in) :: burst                 !! of what explodes beside it
    if (law%kind == material_drucker_prager) then
      call set_viscosity(viscosity_of_soils, law)
    else if (burst .and. law_liquid(law)) then
      call set_viscosity(viscosity_of_pulses, law)
    else
      call set_viscosity(viscosity_of_shocks, law)
    end if
  end subroutine law_spread_shocks

  !> Whether a liquid has no card that says how much tension it bears.
  elemental logical function law_may_cavitate(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law_liquid(law) .and. law%eos /= eos_none .and. &
          .not. (law%fails .or. law%rigid .or. law%porosity%porous)
  end function law_may_cavitate

  !> Such a liquid bears none: its pressure does not fall below 0.
  elemental subroutine law_cavitate(law)
    type(constitutive_t), intent(inout) :: law
    law%fails = .true.
    law%failure%tension = 0.0_dp
  end subroutine law_cavitate

  !> Pressure of a fluid at the start; 0 of what is none.
  pure function law_first_pressure(law) result(pressure)
    type(constitutive_t), intent(in) :: law
    real(dp) :: pressure
    real(dp) :: a0, b0, da, db
    pressure = 0.0_dp
    if (law%kind /= material_fluid .or. law%eos == eos_none) return
    call eos_terms(law, 1.0_dp, law%history%first_energy, a0, b0, da, db)
    pressure = a0 + b0*law%history%first_energy
  end function law_first_pressure

  !> Speed of sound in the bulk, at the start.
  elemental function law_sound(law) result(speed)
    type(constitutive_t), intent(in) :: law
    real(dp) :: speed
    speed = law%bulk_speed
    if (.not. speed > 0.0_dp) speed = sqrt(law%elastic%bulk/law%density)
  end function law_sound

  !> Modulus of plane waves of compression, at the start.
  elemental function law_wave_modulus(law) result(modulus)
    type(constitutive_t), intent(in) :: law
    real(dp) :: modulus
    modulus = law_bulk(law) + 4.0_dp/3.0_dp*law%elastic%shear
  end function law_wave_modulus

  !> Bulk modulus, at the start.
  elemental function law_bulk(law) result(modulus)
    type(constitutive_t), intent(in) :: law
    real(dp) :: modulus
    modulus = law%elastic%bulk
    if (law%eos /= eos_none) modulus = law%density*law%bulk_speed**2
  end function law_bulk

  !> Young's modulus, at the start.
  elemental function law_young(law) result(modulus)
    type(constitutive_t), intent(in) :: law
    real(dp) :: modulus
    modulus = 9.0_dp*law_bulk(law)*law%elastic%shear/ &
              max(3.0_dp*law_bulk(law) + law%elastic%shear, tiny(1.0_dp))
  end function law_young

  !> Whether the stress depends on the sides of the cells that matter is in.
  elemental logical function law_by_cells(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%viscous .or. law%softens
  end function law_by_cells

  !> Whether the stress is a pressure, but for viscosity.
  elemental logical function law_is_spherical(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%kind == material_fluid .or. law%kind == material_explosive
  end function law_is_spherical

  !> Whether a material is elastic and nothing else.
  elemental logical function law_is_springy(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%eos == eos_none .and. any(law%kind == [material_elastic, material_neo_hookean, &
                                                     material_mooney_rivlin])
  end function law_is_springy

  !> Whether a law is one of metals: a yield stress that does not depend on the pressure.
  elemental logical function law_is_metal(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = any(law%kind == [material_j2, material_johnson_cook, material_steinberg_guinan, &
                           material_zerilli_armstrong])
  end function law_is_metal

  !> Whether a metal with an equation of state has nobody who says when it fails, and goes.
  elemental logical function law_may_tear(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law_is_metal(law) .and. law%eos /= eos_none .and. eos_linear(law) .and. &
          .not. (law%fails .or. law%erosion%given .or. law%porosity%porous .or. law%rigid .or. &
                 law%small_strain)
  end function law_may_tear

  !> Such a metal fails where its equation of state bears no more tension.
  elemental subroutine law_tear(law)
    type(constitutive_t), intent(inout) :: law
    law%fails = .true.
    law%history%damage = .true.
  end subroutine law_tear

  !> Whether it does, and by nothing that a deck has asked for.
  elemental logical function law_tears(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%fails .and. law%history%damage .and. .not. (law%failure%given .or. law%jc%failure)
  end function law_tears

  !> Whether matter keeps its form: neither a fluid nor a soil, which flow.
  elemental logical function law_bends(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = .not. (law_is_spherical(law) .or. any(law%kind == [material_drucker_prager, &
                                                             material_mohr_coulomb, &
                                                             material_cam_clay]))
  end function law_bends

  !> Whether the material bears no tension, so that it fills whatever room it has.
  elemental logical function law_gaseous(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%kind == material_explosive .or. &
          (law%kind == material_fluid .and. &
           (law%eos == eos_ideal_gas .or. (law%eos == eos_table .and. table_gaseous(law%table))))
  end function law_gaseous

  !> Whether the material is a fluid that has a volume of its own.
  elemental logical function law_liquid(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%kind == material_fluid .and. .not. law_gaseous(law)
  end function law_liquid

  !> Columns for what a law keeps.
  pure subroutine law_slots(law, ndim)
    type(constitutive_t), intent(inout) :: law
    integer, intent(in) :: ndim
    call slots_ask_history(law%slots, law%history, ndim, &
                           merge(1, stress_components(ndim), law%history%mean_stress))
  end subroutine law_slots

end module sgmp_constitutive
