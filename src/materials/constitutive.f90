!> The table of materials and equations of state, and what a body is made of as the stress update
!! needs it: constants, and where its particles keep their history.
!!
!! A law is described in a module of its own, material_<law>.f90: keys of the deck, constants and
!! how they come from the values of the keys, history, kernel. Here it has a number, a name, a
!! component of `constitutive_t`, and a case in law_keys, law_pressure and law_read; its kernel is
!! called in stress_update.F90. Nothing else knows of it.
module sgmp_constitutive
  use sgmp_burn, only: burn_keys, burn_read
  use sgmp_eos_gruneisen, only: gruneisen_keys, gruneisen_read, gruneisen_t
  use sgmp_eos_jwl, only: jwl_keys, jwl_read, jwl_t
  use sgmp_keys, only: fault_make, fault_t, key_t, values_t
  use sgmp_kinds, only: dp
  use sgmp_material_elastic, only: elastic_keys, elastic_read, elastic_t, moduli_keys, &
                                   moduli_read, neo_hookean_read
  use sgmp_material_history, only: history_t
  use sgmp_material_j2, only: j2_keys, j2_read, j2_t
  use sgmp_material_jc, only: jc_keys, jc_read, jc_t
  use sgmp_viscosity, only: viscosity_read, viscosity_t
  use sgmp_voigt, only: stress_components
  implicit none
  private
  public :: constitutive_t, slots_t, slots_make
  public :: material_elastic, material_neo_hookean, material_j2, material_johnson_cook, &
            material_explosive, material_names
  public :: eos_none, eos_jwl, eos_gruneisen, eos_names
  public :: law_keys, law_read, law_slots, law_first_history, law_check
  public :: eos_keys, eos_read, law_set_viscosity

  integer, parameter :: material_elastic = 1, material_neo_hookean = 2, material_j2 = 3, &
                        material_johnson_cook = 4, material_explosive = 5
  character(16), parameter :: material_names(*) = [character(16) :: &
    'elastic', 'neo_hookean', 'j2', 'johnson_cook', 'explosive']

  integer, parameter :: eos_none = 0, eos_jwl = 1, eos_gruneisen = 2
  character(16), parameter :: eos_names(*) = [character(16) :: 'jwl', 'gruneisen']

  !> Where the pressure of a law comes from.
  integer, parameter :: pressure_own = 1       !! the law itself: it takes no equation of state
  integer, parameter :: pressure_either = 2    !! the bulk modulus, or an equation for solids
  integer, parameter :: pressure_products = 3  !! an equation for detonation products

  !> Of the speed of sound or detonation at the start: the least that an equation of state returns.
  real(dp), parameter :: slowest_part = 1.0e-3_dp

  !> Columns of the particles' second stream; 0: not stored, because nothing of the scene uses it.
  type :: slots_t
    integer :: volume = 1        !! current volume
    integer :: stress = 0        !! first of the stress components (or the mean stress alone)
    integer :: stresses = 0      !! how many
    integer :: plastic = 0       !! equivalent plastic strain
    integer :: temperature = 0
    integer :: damage = 0
    integer :: energy = 0        !! internal energy per initial volume, for an equation of state
    integer :: lighting = 0      !! lighting time of an explosive
    integer :: deformation = 0   !! deformation gradient, row by row
    integer :: stretch = 0       !! its diagonal alone, for cpGIMP
    integer :: initial = 0       !! initial position, for body forces that use it
    integer :: spin = 0          !! first component of the spin that particles carry
    integer :: surface = 0       !! distance to the body's surface, for contact
    integer :: total = 1
  end type slots_t

  !> Law and constants of one material.
  type :: constitutive_t
    integer :: kind = 0                        !! one of material_*
    integer :: eos = 0                         !! one of eos_*
    type(history_t) :: history
    type(slots_t) :: slots
    type(elastic_t) :: elastic
    type(j2_t) :: j2
    type(jc_t) :: jc
    type(jwl_t) :: jwl
    type(gruneisen_t) :: gruneisen
    logical :: small_strain = .false.          !! the linear theory: constant volume, no spin
    logical :: rigid = .false.                 !! prescribed motion: no stress
    logical :: thermal = .false., failure = .false.
    real(dp) :: density = 0.0_dp               !! initial density
    real(dp) :: detonation_speed = 0.0_dp, burn_cells = 0.0_dp
    logical :: viscous = .false.               !! bulk viscosity acts
    type(viscosity_t) :: viscosity
    real(dp) :: slowest = 0.0_dp               !! least sound speed an equation of state may return
    real(dp) :: h = 0.0_dp  !! cell side, the length of the viscosity and of the burn front
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
      keys = [moduli_keys(), j2_keys()]
    case (material_johnson_cook)
      keys = [moduli_keys(), jc_keys()]
    case default  ! material_explosive
      keys = burn_keys()
    end select
  end function law_keys

  !> Where the pressure of a law comes from: one of pressure_*.
  pure integer function law_pressure(kind) result(pressure)
    integer, intent(in) :: kind  !! one of material_*
    select case (kind)
    case (material_elastic, material_neo_hookean)
      pressure = pressure_own
    case (material_explosive)
      pressure = pressure_products
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
    select case (kind)
    case (material_elastic)
      call elastic_read(law%density, values, law%elastic, law%small_strain)
    case (material_neo_hookean)
      call neo_hookean_read(law%density, values, law%elastic, law%history)
    case (material_j2)
      law%elastic = moduli_read(law%density, values)
      call j2_read(values, law%j2, law%history)
    case (material_johnson_cook)
      law%elastic = moduli_read(law%density, values)
      call jc_read(law%density, values, law%jc, law%history, fault)
      law%thermal = law%jc%thermal
      law%failure = law%jc%failure
    case default  ! material_explosive
      call burn_read(values, law%detonation_speed, law%burn_cells, law%history)
    end select
  end subroutine law_read

  !> Keys of an equation of state, besides its initial energy.
  function eos_keys(eos) result(keys)
    integer, intent(in) :: eos  !! one of eos_*
    type(key_t), allocatable :: keys(:)
    select case (eos)
    case (eos_jwl)
      keys = jwl_keys()
    case default  ! eos_gruneisen
      keys = gruneisen_keys()
    end select
  end function eos_keys

  !> Gives a law an equation of state from the values of its keys.
  pure subroutine eos_read(eos, values, law)
    integer, intent(in) :: eos  !! one of eos_*
    class(values_t), intent(in) :: values
    type(constitutive_t), intent(inout) :: law
    real(dp) :: speed
    law%eos = eos
    select case (eos)
    case (eos_jwl)
      law%jwl = jwl_read(values)
      speed = law%detonation_speed
    case default  ! eos_gruneisen
      call gruneisen_read(law%density, values, law%gruneisen, speed)
    end select
    law%slowest = slowest_part*speed
    law%history%energy = .true.
    law%history%first_energy = values%number('energy0')
  end subroutine eos_read

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
    else if (pressure == pressure_own .and. law%eos /= eos_none) then
      call fault_make(fault, '', "the pressure of '"//name//"' is elastic already", &
                      'remove the card eos, or use j2 or johnson_cook')
    end if
  end subroutine law_check

  !> Gives a law bulk viscosity from the values of its keys.
  pure subroutine law_set_viscosity(values, law)
    class(values_t), intent(in) :: values
    type(constitutive_t), intent(inout) :: law
    law%viscosity = viscosity_read(values)
    law%viscous = law%viscosity%quadratic > 0.0_dp .or. law%viscosity%linear > 0.0_dp
  end subroutine law_set_viscosity

  !> Columns for what a law keeps and what the scene adds to it.
  pure subroutine law_slots(law, ndim, stretch, initial, spin)
    type(constitutive_t), intent(inout) :: law
    integer, intent(in) :: ndim
    integer, intent(in) :: stretch, initial, spin  !! components wanted
    associate (keeps => law%history)
      law%slots = slots_make(stresses=merge(1, stress_components(ndim), keeps%mean_stress), &
                             plastic=keeps%plastic, temperature=keeps%temperature, &
                             damage=keeps%damage, energy=keeps%energy, lighting=keeps%lighting, &
                             deformation=merge(ndim**2, 0, keeps%deformation), &
                             stretch=stretch, initial=initial, spin=spin)
    end associate
  end subroutine law_slots

  !> First values of the columns behind the volume.
  pure function law_first_history(law, ndim) result(first)
    type(constitutive_t), intent(in) :: law
    integer, intent(in) :: ndim
    real(dp) :: first(2:law%slots%total)
    integer :: d
    first = 0.0_dp
    associate (slots => law%slots)
      if (slots%temperature > 0) first(slots%temperature) = law%history%first_temperature
      if (slots%energy > 0) first(slots%energy) = law%history%first_energy
      do d = 1, ndim
        if (slots%deformation > 0) first(slots%deformation + (d - 1)*(ndim + 1)) = 1.0_dp
        if (slots%stretch > 0) first(slots%stretch + d - 1) = 1.0_dp
      end do
    end associate
  end function law_first_history

  !> Assigns columns to the fields that are wanted, in a fixed order.
  pure function slots_make(stresses, plastic, temperature, damage, energy, lighting, deformation, &
                           stretch, initial, spin) result(slots)
    integer, intent(in) :: stresses            !! stress components
    logical, intent(in) :: plastic, temperature, damage, energy, lighting
    integer, intent(in) :: deformation, stretch, initial, spin  !! components wanted
    type(slots_t) :: slots
    slots%volume = 1
    slots%total = 1
    slots%stresses = stresses
    call take(slots%total, stresses, slots%stress)
    call take(slots%total, merge(1, 0, plastic), slots%plastic)
    call take(slots%total, merge(1, 0, temperature), slots%temperature)
    call take(slots%total, merge(1, 0, damage), slots%damage)
    call take(slots%total, merge(1, 0, energy), slots%energy)
    call take(slots%total, merge(1, 0, lighting), slots%lighting)
    call take(slots%total, deformation, slots%deformation)
    call take(slots%total, stretch, slots%stretch)
    call take(slots%total, initial, slots%initial)
    call take(slots%total, spin, slots%spin)
  end function slots_make

  !> The next n columns, 0 where none is wanted.
  pure subroutine take(total, n, column)
    integer, intent(inout) :: total   !! columns given so far
    integer, intent(in) :: n
    integer, intent(out) :: column
    column = merge(total + 1, 0, n > 0)
    total = total + n
  end subroutine take

end module sgmp_constitutive
