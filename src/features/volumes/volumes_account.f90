!> Kept volumes in the energy balance: kinetic energy that the velocity filter turns to heat, which
!! the internal energy has already, and how much volume was put right.
module sgmp_volumes_account
  use sgmp_energy_terms, only: changes_kinetic, energy_term_t, energy_terms_t, from_particles, &
                               terms_add
  use sgmp_kinds, only: dp
  use sgmp_sums, only: sum_filter, sum_volume
  implicit none
  private
  public :: volumes_account

contains

  !> Adds the terms of kept volumes.
  pure subroutine volumes_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name='energy.filter_heat', column='filter_heat', &
                                        changes=changes_kinetic, sign=-1.0_dp, &
                                        source=from_particles, entry=sum_filter))
    call terms_add(terms, energy_term_t(name='energy.volume_correction', &
                                        column='volume_correction', source=from_particles, &
                                        entry=sum_volume))
  end subroutine volumes_account

end module sgmp_volumes_account
