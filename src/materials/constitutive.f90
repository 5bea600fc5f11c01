!> What a body is made of, as the stress update needs it: constants, and where its particles keep
!! their history.
module sgmp_constitutive
  use sgmp_eos_gruneisen, only: gruneisen_t
  use sgmp_eos_jwl, only: jwl_t
  use sgmp_kinds, only: dp
  use sgmp_material_elastic, only: elastic_t
  use sgmp_material_j2, only: j2_t
  use sgmp_material_jc, only: jc_t
  use sgmp_viscosity, only: viscosity_t
  implicit none
  private
  public :: constitutive_t, slots_t, slots_make

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

  !> Law and constants of one body.
  type :: constitutive_t
    integer :: kind = 0                        !! one of material_*
    integer :: eos = 0                         !! one of eos_*
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
