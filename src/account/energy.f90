!> The energy ledger: what every step does to the energy, and how much of it the scheme explains
!! (theory 6).
!!
!! All sums come from the particles and nodes themselves; no mass matrix is formed. With a and v the
!! accelerations and velocities, I nodes and p particles, the kinetic energy of a step obeys exactly
!!   dE_kin = dt S(v-) + dt^2/2 sum_p m_p |a_p|^2,   S(v) = sum_I m_I a_I . v_I    (Eqs. 41, 42)
!! for USF, USL and MUSL alike, which holds to round-off if what particles give to the grid and what
!! they get are transposes of each other. MUSL knows S at the re-mapped velocity v*,
!! S(v*) = S(v-) + dt sum_p m_p |a_p|^2.
!!
!! What features change beyond that stands in a table of named terms (sgmp_energy_terms).
module sgmp_energy
  use sgmp_energy_terms, only: energy_terms_t, terms_book, terms_explained
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: ledger_t, ledger_open, ledger_step, ledger_book, ledger_total, step_sums_t
  public :: ledger_drift, ledger_drift_beyond

  !> Sums of one step, of the scheme itself; those of features are in their terms.
  type :: step_sums_t
    real(dp) :: kinetic = 0.0_dp            !! of the particles after the kick
    real(dp) :: particles_aa = 0.0_dp       !! sum m_p |a_p|^2
    real(dp) :: nodes_aa = 0.0_dp           !! sum m_I |a_I|^2
    real(dp) :: power_before = 0.0_dp       !! sum m_I a_I . v_I at the velocity before the kick
    real(dp) :: external_power = 0.0_dp     !! of gravity and body forces at the mid-step velocity
    real(dp) :: applied_work = 0.0_dp       !! of forces on faces of particles
    real(dp) :: springs = 0.0_dp            !! energy of walls ahead of the velocities
    real(dp) :: internal = 0.0_dp           !! growth of internal energy
    real(dp) :: viscous = 0.0_dp  !! bulk-viscous dissipation (part of the internal energy)
    real(dp) :: contact = 0.0_dp     !! kinetic energy that contact took (friction, impact)
    real(dp) :: taken_power = 0.0_dp  !! that walls take for good, at the mid-step velocity
    real(dp) :: rigid_work = 0.0_dp  !! work of rigid bodies on the others, and on free ones that of
                                     !! gravity and body forces
    real(dp) :: free_growth = 0.0_dp  !! of the kinetic energy of free rigid bodies
    real(dp) :: momentum(3) = 0.0_dp
    real(dp) :: lost_force = 0.0_dp  !! on nodes below the mass cut-off, which move nothing
  end type step_sums_t

  !> Energies and their history.
  type :: ledger_t
    real(dp) :: kinetic = 0.0_dp, internal = 0.0_dp
    real(dp) :: kinetic_before = 0.0_dp      !! before the last step
    real(dp) :: initial_total = 0.0_dp
    real(dp) :: external_work = 0.0_dp
    real(dp) :: springs = 0.0_dp             !! of the last step, part of the external work
    real(dp) :: contact_dissipation = 0.0_dp
    real(dp) :: viscous_dissipation = 0.0_dp
    real(dp) :: interpolation_error = 0.0_dp  !! sum of dt^2/2 (sum_I m|a|^2 - sum_p m|a|^2), Eq. 43
    real(dp) :: remainder = 0.0_dp           !! kinetic energy that the identity does not explain
    real(dp) :: predicted = 0.0_dp           !! sum of the energy errors that the identities predict
    real(dp) :: largest_kinetic = 0.0_dp
    real(dp) :: supplied = 0.0_dp            !! most that was there to be spent: of the energy at
                                             !! the start, also what became kinetic of it, and the
                                             !! external work at any time
    real(dp) :: moving_until = 0.0_dp        !! last time that was not at rest
    real(dp) :: momentum(3) = 0.0_dp
    real(dp) :: lost_impulse = 0.0_dp        !! of forces on nodes below the mass cut-off
    real(dp) :: slowed = 1.0_dp              !! what damping left of the velocities before a kick
    real(dp) :: damped_share = 0.0_dp        !! interpolation error over the energy supplied when
                                             !! damping last acted
    real(dp) :: stress_time = 0.0_dp         !! root of internal energy, over time
    type(energy_terms_t) :: terms            !! of features
  end type ledger_t

contains

  !> Kinetic plus internal energy.
  pure function ledger_total(ledger) result(total)
    type(ledger_t), intent(in) :: ledger
    real(dp) :: total
    total = ledger%kinetic + ledger%internal
  end function ledger_total

  !> Part of the energy supplied that has come from nowhere (or, if negative, is gone): the total
  !! energy and what contact, damping, erosion and particles that have left took, less the energy at
  !! the start and the external work, over the most that was there to be spent. What the scheme
  !! itself dissipates or creates is in it.
  pure function ledger_drift(ledger) result(drift)
    type(ledger_t), intent(in) :: ledger
    real(dp) :: drift
    drift = (ledger_total(ledger) + ledger%contact_dissipation + terms_explained(ledger%terms) - &
             ledger%initial_total - ledger%external_work)/max(ledger%supplied, tiny(1.0_dp))
  end function ledger_drift

  !> The same beyond what swings to and fro: velocities and stresses are half a step apart, so that
  !! a total of the two is off by half of what goes from one to the other in a step.
  pure function ledger_drift_beyond(ledger) result(drift)
    type(ledger_t), intent(in) :: ledger
    real(dp) :: drift
    real(dp) :: beat
    beat = 0.5_dp*abs(ledger%kinetic - ledger%kinetic_before)/max(ledger%supplied, tiny(1.0_dp))
    drift = ledger_drift(ledger)
    drift = sign(max(abs(drift) - beat, 0.0_dp), drift)
  end function ledger_drift_beyond

  !> Starts a ledger from the initial state; its terms are those it has.
  pure subroutine ledger_open(ledger, kinetic, internal, momentum, least)
    type(ledger_t), intent(inout) :: ledger
    real(dp), intent(in) :: kinetic, internal, momentum(3)
    real(dp), intent(in), optional :: least   !! energy below which all is round-off; absent: 0
    ledger = ledger_t(terms=ledger%terms)
    ledger%kinetic = kinetic
    ledger%internal = internal
    ledger%initial_total = kinetic + internal
    ledger%momentum = momentum
    ledger%largest_kinetic = kinetic
    ledger%supplied = max(kinetic, abs(kinetic + internal))
    if (present(least)) ledger%supplied = max(ledger%supplied, least)
  end subroutine ledger_open

  !> Books one step; `exact` says that the kinetic identity applies (pure FLIP).
  pure subroutine ledger_step(ledger, sums, dt_kick, exact)
    type(ledger_t), intent(inout) :: ledger
    type(step_sums_t), intent(in) :: sums
    real(dp), intent(in) :: dt_kick
    logical, intent(in) :: exact
    real(dp) :: explained, taken, external
    taken = sums%contact + dt_kick*sums%taken_power
    explained = dt_kick*sums%power_before + 0.5_dp*dt_kick**2*sums%particles_aa + sums%free_growth
    if (exact) ledger%remainder = ledger%remainder + (sums%kinetic - ledger%kinetic) - explained
    external = dt_kick*sums%external_power + sums%applied_work + sums%rigid_work + &
               (sums%springs - ledger%springs)
    ledger%springs = sums%springs
    ledger%external_work = ledger%external_work + external
    ledger%contact_dissipation = ledger%contact_dissipation + taken
    ledger%predicted = ledger%predicted + explained + sums%internal + taken - external
    ledger%interpolation_error = ledger%interpolation_error + &
                                 0.5_dp*dt_kick**2*(sums%nodes_aa - sums%particles_aa)
    ledger%kinetic_before = ledger%kinetic
    ledger%kinetic = sums%kinetic
    ledger%internal = ledger%internal + sums%internal
    ledger%stress_time = ledger%stress_time + dt_kick*sqrt(max(ledger%internal, 0.0_dp))
    ledger%viscous_dissipation = ledger%viscous_dissipation + sums%viscous
    ledger%momentum = sums%momentum
    ledger%largest_kinetic = max(ledger%largest_kinetic, sums%kinetic)
    ledger%supplied = max(ledger%supplied, abs(ledger%external_work), &
                          ledger%initial_total - ledger%internal)
    ledger%lost_impulse = ledger%lost_impulse + dt_kick*sums%lost_force
  end subroutine ledger_step

  !> Books what the terms of features have changed after the kick, in the order of their table.
  pure subroutine ledger_book(ledger, dt_kick)
    type(ledger_t), intent(inout) :: ledger
    real(dp), intent(in) :: dt_kick
    call terms_book(ledger%terms, dt_kick, ledger%kinetic, ledger%internal, ledger%momentum, &
                    ledger%predicted)
  end subroutine ledger_book

end module sgmp_energy
