!> Splitting in the energy balance: what the halves have of kinetic energy beyond the whole
!! particle, that of the velocity gradient inside it, which one velocity cannot hold.
module sgmp_splitting_account
  use sgmp_energy_terms, only: changes_kinetic, energy_term_t, energy_terms_t, from_particles, &
                               terms_add
  use sgmp_features, only: sum_split
  implicit none
  private
  public :: splitting_account

contains

  !> Adds the term of splitting.
  pure subroutine splitting_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name='energy.split_energy', column='split_energy', &
                                        changes=changes_kinetic, source=from_particles, &
                                        entry=sum_split))
  end subroutine splitting_account

end module sgmp_splitting_account
