!> Particles that leave the grid for good, in the energy balance: what they take along.
module sgmp_loss_account
  use sgmp_energy_terms, only: changes_internal, changes_kinetic, changes_momentum, &
                               energy_term_t, energy_terms_t, from_removed, terms_add
  use sgmp_kinds, only: dp
  use sgmp_sums, only: removed_by_loss, removed_internal, removed_kinetic, removed_mass, &
                       removed_momentum, removed_sums
  implicit none
  private
  public :: loss_account

contains

  !> Adds the terms of `lost remove`.
  pure subroutine loss_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    integer, parameter :: before = removed_by_loss*removed_sums
    call terms_add(terms, energy_term_t(name='lost.mass', column='lost_mass', &
                                        source=from_removed, entry=before + removed_mass))
    call terms_add(terms, energy_term_t(name='lost.momentum', column='lost_momentum', &
                                        changes=changes_momentum, sign=-1.0_dp, components=3, &
                                        source=from_removed, entry=before + removed_momentum))
    call terms_add(terms, energy_term_t(name='lost.kinetic_energy', column='lost_kinetic_energy', &
                                        changes=changes_kinetic, sign=-1.0_dp, explained=.true., &
                                        source=from_removed, entry=before + removed_kinetic))
    call terms_add(terms, energy_term_t(name='lost.internal_energy', &
                                        column='lost_internal_energy', &
                                        changes=changes_internal, sign=-1.0_dp, explained=.true., &
                                        source=from_removed, entry=before + removed_internal))
  end subroutine loss_account

end module sgmp_loss_account
