!> Bodies that a card removes, in the energy balance: what they take along.
module sgmp_removal_account
  use sgmp_energy_terms, only: changes_internal, changes_kinetic, changes_momentum, &
                               energy_term_t, energy_terms_t, from_removed, terms_add
  use sgmp_kinds, only: dp
  use sgmp_sums, only: removed_by_card, removed_count, removed_internal, removed_kinetic, &
                       removed_mass, removed_momentum, removed_sums
  implicit none
  private
  public :: removal_account

contains

  !> Adds the terms of the cards `remove`.
  pure subroutine removal_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    integer, parameter :: before = removed_by_card*removed_sums
    call terms_add(terms, energy_term_t(name='removed.particles', column='removed_particles', &
                                        source=from_removed, entry=before + removed_count, &
                                        whole=.true.))
    call terms_add(terms, energy_term_t(name='removed.mass', column='removed_mass', &
                                        source=from_removed, entry=before + removed_mass))
    call terms_add(terms, energy_term_t(name='removed.momentum', column='removed_momentum', &
                                        changes=changes_momentum, sign=-1.0_dp, components=3, &
                                        source=from_removed, entry=before + removed_momentum))
    call terms_add(terms, energy_term_t(name='removed.kinetic_energy', &
                                        column='removed_kinetic_energy', &
                                        changes=changes_kinetic, sign=-1.0_dp, explained=.true., &
                                        source=from_removed, entry=before + removed_kinetic))
    call terms_add(terms, energy_term_t(name='removed.internal_energy', &
                                        column='removed_internal_energy', &
                                        changes=changes_internal, sign=-1.0_dp, explained=.true., &
                                        source=from_removed, entry=before + removed_internal))
  end subroutine removal_account

end module sgmp_removal_account
