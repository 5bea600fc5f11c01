!> Swirl in the energy balance: the kinetic energy that rings lose as they widen and keep their
!! moment. The centrifugal force gives it to the radial motion.
module sgmp_swirl_account
  use sgmp_energy_terms, only: changes_kinetic, energy_term_t, energy_terms_t, from_particles, &
                               terms_add
  use sgmp_kinds, only: dp
  use sgmp_sums, only: sum_swirl
  implicit none
  private
  public :: swirl_account

contains

  !> Adds the term of swirl, which no file shows.
  pure subroutine swirl_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(changes=changes_kinetic, sign=-1.0_dp, &
                                        source=from_particles, entry=sum_swirl))
  end subroutine swirl_account

end module sgmp_swirl_account
