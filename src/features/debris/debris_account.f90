!> Debris in the energy balance: kinetic energy that collisions turn to heat, which the internal
!! energy has already.
module sgmp_debris_account
  use sgmp_energy_terms, only: changes_kinetic, energy_term_t, energy_terms_t, from_particles, &
                               terms_add
  use sgmp_kinds, only: dp
  use sgmp_sums, only: sum_collisions
  implicit none
  private
  public :: debris_account

contains

  !> Adds the term of collisions.
  pure subroutine debris_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name='energy.collision_heat', column='collision_heat', &
                                        changes=changes_kinetic, sign=-1.0_dp, &
                                        source=from_particles, entry=sum_collisions))
  end subroutine debris_account

end module sgmp_debris_account
