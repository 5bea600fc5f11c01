!> Damping in the energy balance: a part of all velocities is gone when the step has been booked.
module sgmp_damping_account
  use sgmp_energy, only: ledger_t
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, terms_add, terms_find
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: damping_account, damping_book

  character(*), parameter :: dissipation = 'energy.damping_dissipation'

contains

  !> Adds the term of damping.
  pure subroutine damping_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name=dissipation, column='damping_dissipation', &
                                        sign=-1.0_dp, explained=.true.))
  end subroutine damping_account

  !> Books the kinetic energy that is lost where all velocities are multiplied by a factor.
  pure subroutine damping_book(ledger, factor)
    type(ledger_t), intent(inout) :: ledger
    real(dp), intent(in) :: factor
    integer :: t
    t = terms_find(ledger%terms, dissipation)
    ledger%terms%term(t)%value(1) = ledger%terms%term(t)%value(1) + &
                                    (1.0_dp - factor**2)*ledger%kinetic
    ledger%kinetic = factor**2*ledger%kinetic
    ledger%momentum = factor*ledger%momentum
  end subroutine damping_book

end module sgmp_damping_account
