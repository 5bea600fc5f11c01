!> What a law keeps of each particle's past, as its module declares it.
module sgmp_material_history
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: history_t

  !> Columns that a law wants besides volume and stress, with their first values where not 0.
  type :: history_t
    logical :: mean_stress = .false.    !! a fluid: the mean stress in place of the tensor
    logical :: plastic = .false.        !! equivalent plastic strain
    logical :: temperature = .false.
    logical :: damage = .false.
    logical :: energy = .false.         !! internal energy per initial volume
    logical :: distention = .false.     !! of porous matter
    logical :: pore_shift = .false.     !! of elastic pores
    logical :: bulking = .false.        !! pressure of broken ceramics
    logical :: preconsolidation = .false.  !! of clays
    logical :: lighting = .false.       !! lighting time of an explosive
    logical :: deformation = .false.    !! deformation gradient
    real(dp) :: first_temperature = 0.0_dp
    real(dp) :: first_energy = 0.0_dp
    real(dp) :: first_mean_stress = 0.0_dp
  end type history_t

end module sgmp_material_history
