!> Pressure of a chunk from an equation of state, its bounds where matter has failed or a fluid
!! tears, softening, and bulk viscosity: what the stress update does that is the same in every
!! space.
module sgmp_pressure
  use sgmp_afterburn, only: afterburn_lanes
  use sgmp_burn, only: burn_fraction_lanes
  use sgmp_constitutive, only: constitutive_t, eos_lanes, eos_linear, eos_none, &
                               material_explosive
  use sgmp_eos, only: eos_energy_lanes, eos_energy_pressure, eos_sound_speed_lanes
  use sgmp_failure, only: carries_nothing, failure_bounds, failure_none, largest_principal_stress
  use sgmp_flaws, only: flaws_advance
  use sgmp_heating, only: compression_heat_lanes
  use sgmp_kinds, only: dp, lanes
  use sgmp_pores, only: narrow, pores_slow, porous_lanes, squeeze_pores
  use sgmp_porosity, only: porosity_bound_lanes
  use sgmp_softening, only: softening_damage, softening_width
  use sgmp_viscosity, only: closing_t, viscosity_lanes
  implicit none
  private
  public :: cavitate, equation_of_state, explosive, release, soften, viscosity, warm

  integer, parameter :: components = 6  !! of a stress in space
  integer, parameter :: most_trials = 60           !! of a distention
  integer, parameter :: most_tangents = 30         !! of an equation of state
  real(dp), parameter :: settled = 1.0e-13_dp      !! also of an energy over bulk modulus

contains

  !> Detonation products: JWL pressure behind the burn front, none ahead of it; heated by afterburn.
  subroutine explosive(law, closing, time, mass, old_volume, nb, b, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    type(closing_t), intent(in) :: closing
    real(dp), intent(in) :: time, mass(lanes), old_volume(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)
    real(dp), intent(out) :: speed2(lanes), q(lanes), work(lanes)
    real(dp) :: burnt(lanes), none(lanes), heat(lanes)
    none = 0.0_dp
    heat = 0.0_dp
    call burn_fraction_lanes(time, b(1, law%slots%lighting), law%detonation_speed, law%h, &
                             law%burn_cells, burnt)
    if (law%slots%afterburnt > 0) then
      call afterburn_lanes(law%afterburn, time, closing%dt, b(1, law%slots%lighting), &
                           b(1, law%slots%stress), b(1, law%slots%afterburnt), heat)
      heat = heat*mass/(law%density*old_volume)
    end if
    call equation_of_state(law, closing, mass, old_volume, b(1, 1), heat, none, burnt, &
                           b(1, law%slots%energy), b(1, law%slots%stress), speed2, q, work)
  end subroutine explosive

  !> What failed lanes carry of their pressure. Without an equation of state it follows the volume
  !! and not the strain of the step, so that a gap closes where it opened.
  subroutine release(law, failed, mass, old_volume, trace, nb, b, mean, speed2, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: failed(lanes), mass(lanes), old_volume(lanes), trace(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb), mean(lanes), speed2(lanes), work(lanes)
    real(dp) :: least(lanes), most(lanes), energy(lanes), closed
    integer :: l
    call failure_bounds(law%failure, failed, least, most)
    if (law%eos == eos_none) then
      do l = 1, lanes
        closed = law%elastic%bulk*log(b(l, 1)*law%density/mass(l))
        if (failed(l) < 0.5_dp) closed = mean(l)
        work(l) = work(l) + 0.5_dp*(closed - mean(l))*trace(l)
        mean(l) = closed
      end do
      energy = 0.0_dp
      call bound_pressure(law, mass, old_volume, b(1, 1), least, most, energy, mean, speed2, work)
    else
      call bound_pressure(law, mass, old_volume, b(1, 1), least, most, b(1, law%slots%energy), &
                          mean, speed2, work)
    end if
  end subroutine release

  !> What softening leaves of the stress that undamaged matter would carry, and the work that is
  !! done with it. Without an equation of state the pressure follows the volume, as where matter has
  !! failed.
  subroutine soften(law, dt, before, mass, old_volume, trace, late, nb, b, mean, speed2, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: before(lanes)        !! part of the strength before the step
    real(dp), intent(in) :: mass(lanes), old_volume(lanes), trace(lanes)
    real(dp), intent(in) :: late(lanes)          !! 1/2 new deviator : strain, undamaged
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb)      !! with the deviator, undamaged
    real(dp), intent(inout) :: mean(lanes), speed2(lanes), work(lanes)
    real(dp) :: stress(lanes, components), strength(lanes), whole(lanes), width(lanes)
    real(dp) :: missing, left
    integer :: l, n, strain
    n = law%slots%stresses
    associate (deviator => b(:, law%slots%stress:law%slots%stress + n - 1), &
               damage => b(:, law%slots%damage))
      whole = mean
      if (law%eos == eos_none) whole = law%elastic%bulk*log(b(:, 1)*law%density/mass)
      stress = 0.0_dp
      stress(:, :n) = deviator
      stress(:, :3) = stress(:, :3) + spread(whole, 2, 3)
      if (law%slots%flaw_strain > 0) then
        call crack(law, dt, stress, b(1, law%slots%flaw_strain), b(1, law%slots%flaw_radius), &
                   damage)
      else
        strength = 1.0_dp
        if (law%slots%strength > 0) strength = b(:, law%slots%strength)
        strain = merge(law%slots%averaged, law%slots%plastic, law%slots%averaged > 0)
        width = 1.0_dp
        if (law%unequal) width = softening_width(law%cells, stress)
        call softening_damage(law%failure, law%softening, stress, b(1, strain), strength, width, &
                              damage)
      end if
      do l = 1, lanes
        left = 1.0_dp - damage(l)
        deviator(l, :) = left*deviator(l, :)
        missing = (left - before(l))*late(l)
        left = merge(left, 1.0_dp, whole(l) > 0.0_dp)
        if (law%failure%carries == carries_nothing .and. damage(l) >= 1.0_dp) left = 0.0_dp
        if (damage(l) >= 1.0_dp .and. left < 1.0_dp) speed2(l) = law%bulk_speed**2
        if (law%eos == eos_none) then
          missing = missing + 0.5_dp*(left*whole(l) - mean(l))*trace(l)
        else
          missing = missing + 0.5_dp*(left - 1.0_dp)*whole(l)*(b(l, 1) - old_volume(l)) &
                              /old_volume(l)
          b(l, law%slots%energy) = b(l, law%slots%energy) + &
                                   missing*old_volume(l)*law%density/mass(l)
        end if
        work(l) = work(l) + missing
        mean(l) = left*whole(l)
      end do
    end associate
  end subroutine soften

  !> Damage by flaws that grow in the stress that undamaged matter would carry.
  pure subroutine crack(law, dt, stress, first, radius, damage)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, stress(lanes, components)
    real(dp), intent(in) :: first(lanes), radius(lanes)  !! of flaws_first
    real(dp), intent(inout) :: damage(lanes)
    real(dp) :: young, strain(lanes)
    integer :: l
    young = 9.0_dp*law%elastic%bulk*law%elastic%shear &
            /(3.0_dp*law%elastic%bulk + law%elastic%shear)
    do l = 1, lanes
      strain(l) = largest_principal_stress(stress(l, :))/young
    end do
    call flaws_advance(law%failure%flaws, dt, strain, first, radius, damage)
  end subroutine crack

  !> The tension that a fluid bears is bounded.
  pure subroutine cavitate(law, mass, old_volume, nb, b, mean, speed2, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: mass(lanes), old_volume(lanes)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb), mean(lanes), speed2(lanes), work(lanes)
    real(dp) :: least(lanes), most(lanes)
    least = -law%failure%tension
    most = failure_none
    call bound_pressure(law, mass, old_volume, b(1, 1), least, most, b(1, law%slots%energy), mean, &
                        speed2, work)
  end subroutine cavitate

  !> Keeps the pressure within bounds, and does the work that it has then done. Where it is held,
  !! waves have the speed that they have when the matter closes.
  pure subroutine bound_pressure(law, mass, old_volume, volume, least, most, energy, mean, speed2, &
                                 work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in), dimension(lanes) :: mass, old_volume, volume, least, most
    real(dp), intent(inout), dimension(lanes) :: energy, mean, speed2, work
    real(dp) :: bounded, missing
    integer :: l
    !$omp simd simdlen(8) private(bounded, missing)
    do l = 1, lanes
      bounded = merge(-mean(l), least(l), -mean(l) > least(l))
      bounded = merge(bounded, most(l), bounded < most(l))
      missing = 0.5_dp*(-mean(l) - bounded)*(volume(l) - old_volume(l))
      work(l) = work(l) + missing/old_volume(l)
      energy(l) = energy(l) + missing*law%density/mass(l)
      speed2(l) = merge(law%bulk_speed**2, speed2(l), abs(bounded + mean(l)) > 0.0_dp)
      mean(l) = -bounded
    end do
  end subroutine bound_pressure

  !> Pressure and energy by an equation of state; `mean` is the mean stress -p.
  subroutine equation_of_state(law, closing, mass, old_volume, volume, deviatoric_work, stiffness, &
                               burnt, kept, mean, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    type(closing_t), intent(in) :: closing
    real(dp), intent(in) :: mass(lanes), old_volume(lanes), volume(lanes)
    real(dp), intent(in) :: deviatoric_work(lanes)      !! per current (old) volume
    real(dp), intent(in) :: stiffness(lanes)  !! 4/3 G, of the shear part of the sound speed
    real(dp), intent(in) :: burnt(lanes)                !! factor on the pressure
    real(dp), intent(inout) :: kept(lanes, law%kept)    !! energy, distention, shift of pores
    real(dp), intent(inout) :: mean(lanes)
    real(dp), intent(out) :: speed2(lanes), q(lanes)
    real(dp), intent(out) :: work(lanes)                !! pressure work per old volume
    real(dp) :: v_old(lanes), v(lanes), p_old(lanes), p(lanes), other(lanes)
    real(dp) :: a0(lanes), b0(lanes), da(lanes), db(lanes), ones(lanes)
    real(dp) :: scale, inverse
    real(dp) :: cold                                    !! energy below which there are no waves
    real(dp) :: bulk(lanes)                             !! its square, of the volume alone
    integer :: l
    inverse = 1.0_dp/law%density
    cold = huge(1.0_dp)
    if (law%kind == material_explosive) cold = -law%history%first_energy
    !$omp simd simdlen(8) private(scale)
    do l = 1, lanes
      scale = law%density/mass(l)
      v_old(l) = old_volume(l)*scale
      v(l) = volume(l)*scale
      p_old(l) = -mean(l)
    end do
    if (law%porosity%porous) then
      call porous_lanes(law, v, kept(1, 2), kept(1, 1), a0, b0, da, db)
    else
      call eos_lanes(law, v, kept(1, 1), a0, b0, da, db)
    end if
    p = burnt*(a0 + b0*kept(:, 1))
    ones = 1.0_dp
    call eos_sound_speed_lanes(law%density, v, p, kept(1, 1), da, db, b0, ones, bulk)
    if (law%porosity%elastic) call pores_slow(law, kept(1, 2), bulk)
    !$omp simd simdlen(8)
    do l = 1, lanes
      speed2(l) = merge(bulk(l), law%slowest**2, bulk(l) > law%slowest**2)
      speed2(l) = merge(speed2(l), law%detonation_speed**2, burnt(l) > 0.0_dp) + &
          (stiffness(l)*inverse)*v(l)
    end do
    call viscosity(law, closing%dt, mass, volume, closing%trace, speed2, q)
    !$omp simd simdlen(8)
    do l = 1, lanes
      q(l) = merge(closing%share(l)*q(l), 0.0_dp, burnt(l) > 0.0_dp)
      other(l) = v_old(l)*(deviatoric_work(l) - q(l)*closing%trace(l))
    end do
    p = p_old
    if (law%porosity%elastic) then
      call squeeze_pores(law, v_old, v, p_old, other, kept, a0, b0)
    else if (law%porosity%porous) then
      call close_pores(law, v_old, v, p_old, other, kept, a0, b0)
    else if (.not. eos_linear(law)) then
      call settle_terms(law, v_old, v, p_old, other, burnt, kept(1, 1), a0, b0)
    end if
    call eos_energy_pressure(v_old, v, other, burnt, a0, b0, kept(1, 1), p)
    !$omp simd simdlen(8)
    do l = 1, lanes
      work(l) = -0.5_dp*(p_old(l) + p(l))*(v(l) - v_old(l))/v_old(l)
      mean(l) = -p(l)
      ! Waves without a speed are left as they are, for the caller to see; but in products of
      ! explosives that have lost a little more energy than they had.
      bulk(l) = merge(bulk(l) + (stiffness(l)*inverse)*v(l), 0.0_dp, burnt(l) > 0.0_dp)
      speed2(l) = merge(bulk(l), speed2(l), bulk(l) < 0.0_dp .and. kept(l, 1) < cold)
    end do
  end subroutine equation_of_state

  !> Terms of an equation of state that is not linear in the energy: those of its tangent at the
  !! energy after the step (Newton's method; energy and work agree to round-off whatever is left).
  pure subroutine settle_terms(law, v_old, v, p_old, other, burnt, energy, a0, b0)
    type(constitutive_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: v_old, v, p_old, other  !! as in eos_energy_pressure
    real(dp), intent(in) :: burnt(lanes), energy(lanes)  !! factor; energy before the step
    real(dp), dimension(lanes), intent(inout) :: a0, b0  !! in: at the energy before the step
    real(dp), dimension(lanes) :: da, db, next, last
    integer :: k
    last = energy
    trials: do k = 1, most_tangents
      next = energy
      call eos_energy_lanes(v_old, v, other, p_old, burnt, a0, b0, next)
      if (all(abs(next - last) <= settled*law%density*law%bulk_speed**2)) exit trials
      call eos_lanes(law, v, next, a0, b0, da, db)
      last = next
    end do trials
  end subroutine settle_terms

  !> Distention after the step, and the terms with it: the pressure that it leaves is the one that
  !! closes the pores so far.
  !!
  !! What a distention is above its bound grows with it, by no less; regula falsi (Illinois) between
  !! none and the old one finds where it is nothing, in each lane by itself.
  pure subroutine close_pores(law, v_old, v, p_old, other, kept, a0, b0)
    type(constitutive_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: v_old, v, p_old, other  !! as in eos_energy_pressure
    real(dp), intent(inout) :: kept(lanes, 2)           !! energy before the step, distention
    real(dp), dimension(lanes), intent(out) :: a0, b0
    real(dp), dimension(lanes) :: low, high, below, above, middle, excess, moving, side
    integer :: k
    high = kept(:, 2)
    call excess_distention(law, v_old, v, p_old, other, kept, high, above, a0, b0)
    moving = merge(1.0_dp, 0.0_dp, above > settled)
    if (.not. any(moving > 0.0_dp)) return
    low = 1.0_dp
    side = 0.0_dp
    call excess_distention(law, v_old, v, p_old, other, kept, low, below, a0, b0)
    trials: do k = 1, most_trials
      if (.not. any(moving > 0.0_dp)) exit trials
      middle = merge((low*above - high*below)/(above - below), high, moving > 0.0_dp)
      call excess_distention(law, v_old, v, p_old, other, kept, middle, excess, a0, b0)
      call narrow(settled, middle, excess, low, high, below, above, side, moving)
    end do trials
    kept(:, 2) = high
    call excess_distention(law, v_old, v, p_old, other, kept, high, excess, a0, b0)
  end subroutine close_pores

  !> By how much a distention is above the bound that the pressure with it sets, and the terms.
  pure subroutine excess_distention(law, v_old, v, p_old, other, kept, distention, excess, a0, b0)
    type(constitutive_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: v_old, v, p_old, other  !! as in eos_energy_pressure
    real(dp), intent(in) :: kept(lanes, 2)              !! energy before the step
    real(dp), intent(in) :: distention(lanes)
    real(dp), dimension(lanes), intent(out) :: excess, a0, b0
    real(dp), dimension(lanes) :: da, db, energy, pressure, ones, bound
    ones = 1.0_dp
    energy = kept(:, 1)
    pressure = p_old
    call porous_lanes(law, v, distention, energy, a0, b0, da, db)
    call eos_energy_pressure(v_old, v, other, ones, a0, b0, energy, pressure)
    call porosity_bound_lanes(law%porosity, pressure, bound)
    excess = distention - bound
  end subroutine excess_distention

  !> Temperature of matter that is compressed, and heated by bulk viscosity.
  subroutine warm(law, mass, old_volume, volume, trace, energy, q, temperature)
    type(constitutive_t), intent(in) :: law
    real(dp), dimension(lanes), intent(in) :: mass, old_volume, volume, trace
    real(dp), intent(in) :: energy(lanes)               !! per initial volume, after the step
    real(dp), intent(in) :: q(lanes)                    !! viscous pressure
    real(dp), intent(inout) :: temperature(lanes)
    real(dp), dimension(lanes) :: scale, v_old, v, viscous, a0, b0, da, db
    scale = law%density/mass
    v_old = old_volume*scale
    v = volume*scale
    viscous = -v_old*q*trace
    call eos_lanes(law, v, energy, a0, b0, da, db)
    call compression_heat_lanes(law%heating%heat_capacity, b0, v_old, v, viscous, temperature)
  end subroutine warm

  !> Bulk viscosity of a chunk; none where the scene has none.
  pure subroutine viscosity(law, dt, mass, volume, trace, speed2, q)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt, mass(lanes), volume(lanes), trace(lanes), speed2(lanes)
    real(dp), intent(out) :: q(lanes)
    real(dp) :: density(lanes), speed(lanes), rate(lanes)
    integer :: l
    q = 0.0_dp
    if (.not. law%viscous .or. dt <= 0.0_dp) return
    !$omp simd simdlen(8)
    do l = 1, lanes
      density(l) = mass(l)/volume(l)
      speed(l) = sqrt(max(speed2(l), 0.0_dp))
      rate(l) = trace(l)*(1.0_dp/dt)
    end do
    call viscosity_lanes(law%viscosity, law%h*law%side, density, speed, rate, q)
  end subroutine viscosity

end module sgmp_pressure
