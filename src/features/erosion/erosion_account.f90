!> Erosion in the energy balance: what particles that are removed take along.
module sgmp_erosion_account
  use sgmp_energy_terms, only: changes_internal, changes_kinetic, changes_momentum, &
                               energy_term_t, energy_terms_t, from_removed, terms_add
  use sgmp_kinds, only: dp
  use sgmp_sums, only: removed_count, removed_internal, removed_kinetic, removed_mass, &
                       removed_momentum
  implicit none
  private
  public :: erosion_account

contains

  !> Adds the terms of erosion.
  pure subroutine erosion_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name='eroded.particles', column='eroded_particles', &
                                        source=from_removed, entry=removed_count, whole=.true.))
    call terms_add(terms, energy_term_t(name='eroded.mass', column='eroded_mass', &
                                        source=from_removed, entry=removed_mass))
    call terms_add(terms, energy_term_t(name='eroded.momentum', column='eroded_momentum', &
                                        changes=changes_momentum, sign=-1.0_dp, components=3, &
                                        source=from_removed, entry=removed_momentum))
    call terms_add(terms, energy_term_t(name='eroded.kinetic_energy', &
                                        column='eroded_kinetic_energy', &
                                        changes=changes_kinetic, sign=-1.0_dp, explained=.true., &
                                        source=from_removed, entry=removed_kinetic))
    call terms_add(terms, energy_term_t(name='eroded.internal_energy', &
                                        column='eroded_internal_energy', &
                                        changes=changes_internal, sign=-1.0_dp, explained=.true., &
                                        source=from_removed, entry=removed_internal))
  end subroutine erosion_account

end module sgmp_erosion_account
