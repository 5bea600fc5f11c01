!> Names of the constitutive laws, of their hardening and of the equations of state.
module sgmp_material_kinds
  implicit none
  private
  public :: material_elastic, material_neo_hookean, material_j2, material_johnson_cook, &
    material_explosive, material_names
  public :: hardening_perfect, hardening_linear, hardening_power, eos_none, eos_jwl, eos_gruneisen

  integer, parameter :: material_elastic = 1, material_neo_hookean = 2, material_j2 = 3, &
    material_johnson_cook = 4, material_explosive = 5
  character(16), parameter :: material_names(*) = [character(16) :: 'elastic', 'neo_hookean', &
    'j2', 'johnson_cook', 'explosive']
  integer, parameter :: hardening_perfect = 1, hardening_linear = 2, hardening_power = 3
  integer, parameter :: eos_none = 0, eos_jwl = 1, eos_gruneisen = 2

end module sgmp_material_kinds
