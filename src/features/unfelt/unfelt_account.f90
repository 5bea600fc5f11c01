!> Forces that particles do not feel in the energy balance: what they do on strains is gone
!! (sgmp_unfelt_stages).
module sgmp_unfelt_account
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, from_nodes, terms_add
  use sgmp_kinds, only: dp
  use sgmp_sums, only: nodes_unfelt
  implicit none
  private
  public :: unfelt_account

contains

  !> Adds the term.
  pure subroutine unfelt_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name='energy.unfelt_dissipation', &
                                        column='unfelt_dissipation', sign=-1.0_dp, &
                                        explained=.true., source=from_nodes, entry=nodes_unfelt))
  end subroutine unfelt_account

end module sgmp_unfelt_account
