!> Damping in the energy balance: a part of all velocities is gone when the step has been booked.
module sgmp_damping_account
  use sgmp_energy, only: ledger_t
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, terms_add, terms_find
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: damping_account, damping_book, damping_book_kick

  character(*), parameter :: dissipation = 'energy.damping_dissipation'

contains

  !> Adds the term of damping.
  pure subroutine damping_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name=dissipation, column='damping_dissipation', &
                                        sign=-1.0_dp, explained=.true.))
  end subroutine damping_account

  !> Books the kinetic energy that is lost where all velocities are multiplied by a factor, and
  !! notes what projection has lost so far.
  pure subroutine damping_book(ledger, factor)
    type(ledger_t), intent(inout) :: ledger
    real(dp), intent(in) :: factor
    call add(ledger, (1.0_dp - factor**2)*ledger%kinetic)
    ledger%slowed = factor
    ledger%damped_share = ledger%interpolation_error/max(ledger%supplied, tiny(1.0_dp))
    ledger%kinetic = factor**2*ledger%kinetic
    ledger%momentum = factor*ledger%momentum
  end subroutine damping_book

  !> Books what damping before a kick takes of the work of the forces in it.
  !!
  !! Potential energy changes by the mean of the work on the ways before and after the kick, the
  !! kinetic energy by that of the mean velocity during it. With what damping left of the first, f
  !! w, these differ by 1/2 (1 - f) w . m a dt = 1/2 (1/f - 1) dt S(v-): a part of rate dt/2 of all
  !! that damping takes where bodies creep to rest.
  pure subroutine damping_book_kick(ledger, dt_kick, power_before)
    type(ledger_t), intent(inout) :: ledger
    real(dp), intent(in) :: dt_kick              !! velocity step
    real(dp), intent(in) :: power_before         !! S(v-) of the kick
    real(dp), parameter :: least = 1.0e-3_dp     !! less is as good as a stop
    if (ledger%slowed > least) call add(ledger, 0.5_dp*dt_kick*power_before* &
                                        (1.0_dp - ledger%slowed)/ledger%slowed)
    ledger%slowed = 1.0_dp
  end subroutine damping_book_kick

  pure subroutine add(ledger, amount)
    type(ledger_t), intent(inout) :: ledger
    real(dp), intent(in) :: amount
    integer :: t
    t = terms_find(ledger%terms, dissipation)
    ledger%terms%term(t)%value(1) = ledger%terms%term(t)%value(1) + amount
  end subroutine add

end module sgmp_damping_account
