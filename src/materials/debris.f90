!> Matter that has failed, and matter whose equation of state has no waves left in expansion (theory
!! 4): what is done to the particles of a chunk in the place of the update of whole matter.
!!
!! **Failed.** A particle stands for fragments and the room between them. It carries no deviator,
!! and a pressure between 0 and what the law allows. In a step that strains it by dv, in initial
!! volumes, its energy per initial volume obeys
!!
!!     E' = E + w - p dv/2 - p' dv'/2                                                 (DB1)
!!
!! with the pressure p' that it then has, bounds included. dv' is dv where it opens, whatever volume
!! it is then taken to have; where it closes, as far as its volume does. What is taken for p' and
!! for q is an advance on what they will do in the kick to come; where that is settled with what
!! they do (sgmp_settling) the term of p is no longer there in the next step. So what its stress
!! gives to the grid is what its internal energy loses, in every step and to round-off. Further
!!
!! * in open matter (v > 1) heat presses as that of a gas: b0 E is b0 E/v, and is spent when
!!   fragments are far apart;
!! * a particle is not larger than `debris_largest` times its initial volume, which is as much room
!!   as a cell can tell, and below its initial volume it closes by no more than a part in a step;
!!   what carries nothing does not become denser than it was;
!! * bulk viscosity acts where matter carried pressure before the step, and takes in a step no more
!!   than a lone particle's closing: q <= rho h^2 |tr D|/(6 dt).
!!
!! **Torn.** Mie-Grueneisen's pressure falls with the volume to its largest tension, where the speed
!! of sound is 0, and would rise beyond. Matter that has a card `failure` fails there, and, however
!! hot it is, at the volume at which that happens to cold matter. Without one the tension falls from
!! its largest value with further opening,
!!
!!     p = p_c exp(-(v - v_c)/opening)                                                (DB2)
!!
!! where v_c, p_c belong to a vanishing speed of sound at the particle's energy.
module sgmp_debris
  use sgmp_constitutive, only: constitutive_t, eos_linear, eos_none, eos_terms
  use sgmp_eos, only: eos_sound_speed_squared
  use sgmp_failure, only: carries_everything, carries_nothing, failure_none
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: debris_begin, debris_lanes, debris_largest, debris_loose, debris_mark, &
            debris_possible, debris_room, debris_set_apart, debris_settled, debris_t, debris_torn, &
            tear_lanes

  real(dp), parameter :: debris_largest = 8.0_dp  !! volume of fragments and their room, over the
                                                  !! first
  real(dp), parameter :: closing = 0.95_dp    !! least part of a dense volume after a step
  real(dp), parameter :: closed = 1.0e-9_dp   !! pressure over bulk modulus of what carries some
  real(dp), parameter :: lone = 1.0_dp/6.0_dp  !! of the closing of a lone particle, in a step
  real(dp), parameter :: least_whole = 0.5_dp  !! as in eos_energy
  real(dp), parameter :: opening = 0.3_dp     !! of (DB2)
  real(dp), parameter :: half_settled = -1.0_dp, whole_settled = -0.5_dp  !! marks
  integer, parameter :: halvings = 40
  integer, parameter :: tangents = 8          !! where the pressure is not linear in the energy

  !> State of a chunk before the step.
  type :: debris_t
    real(dp) :: volume(lanes) = 0.0_dp
    real(dp) :: pressure(lanes) = 0.0_dp
    real(dp) :: energy(lanes) = 0.0_dp        !! per initial volume
    real(dp) :: heat(lanes) = 0.0_dp          !! work of deviators per old volume
    real(dp) :: acting(lanes) = 0.0_dp        !! pressure that does work by the change of volume
    real(dp) :: settling(lanes) = 0.0_dp      !! pressure, q included, of which a half is settled
  end type debris_t

contains

  !> Notes the state before the step.
  pure subroutine debris_begin(law, old_volume, mean, nb, b, heat, before)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: old_volume(lanes), mean(lanes), heat(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: b(lanes, nb)
    type(debris_t), intent(out) :: before
    before%volume = old_volume
    before%pressure = -mean
    before%heat = heat
    if (law%slots%energy > 0) before%energy = b(:, law%slots%energy)
    before%acting = before%pressure
    before%settling = 0.0_dp
    if (law%slots%viscous == 0) return
    where (debris_settled(b(:, law%slots%viscous))) before%acting = 0.0_dp
    where (b(:, law%slots%viscous) <= half_settled)
      before%settling = before%pressure + (half_settled - b(:, law%slots%viscous))
    end where
  end subroutine debris_begin

  !> What takes the place of the viscous pressure once its work has been settled, half or whole.
  elemental function debris_mark(half, q) result(mark)
    logical, intent(in) :: half
    real(dp), intent(in) :: q
    real(dp) :: mark
    mark = merge(half_settled - q, whole_settled, half)
  end function debris_mark

  !> Whether it is such a mark.
  elemental function debris_settled(q) result(yes)
    real(dp), intent(in) :: q
    logical :: yes
    yes = q < 0.0_dp
  end function debris_settled

  !> Volume of the lanes that bear stress as a body does: none of what has failed and come apart,
  !! whose surfaces are nowhere (doc/surfaces.md), nor of what is settled (sgmp_settling), whose
  !! work is that with plain strains.
  pure subroutine debris_room(law, live, mass, nb, b, room)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: live(lanes), mass(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: b(lanes, nb)
    real(dp), intent(out) :: room(lanes)
    room = live*b(:, 1)
    if (.not. debris_possible(law)) return
    where (b(:, law%slots%damage) >= 1.0_dp .and. &
           (b(:, 1)*law%density > mass .or. law%slots%advanced > 0)) room = 0.0_dp
  end subroutine debris_room

  !> Whether particles of a law may become debris: fail, and come apart.
  elemental function debris_possible(law) result(yes)
    type(constitutive_t), intent(in) :: law
    logical :: yes
    yes = law%fails .and. law%history%damage .and. law%failure%carries /= carries_everything
  end function debris_possible

  !> 1 for particles that have failed and come apart, 0 for all others and for pads.
  pure function debris_loose(law, live, mass, nb, b) result(loose)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: live(lanes), mass(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: b(lanes, nb)
    real(dp) :: loose(lanes)
    loose = 0.0_dp
    if (.not. debris_possible(law)) return
    if (all(b(:, law%slots%damage) < 1.0_dp)) return  ! other columns need not come to the cache
    where (b(:, law%slots%damage) >= 1.0_dp .and. b(:, 1)*law%density > mass) loose = live
  end function debris_loose

  !> Failed lanes: volume, energy, mean stress, speed, viscosity and work after the step.
  pure subroutine debris_lanes(law, dt, failed, mass, trace, before, nb, b, mean, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: failed(lanes)        !! 1 or 0
    real(dp), intent(in) :: mass(lanes), trace(lanes)
    type(debris_t), intent(in) :: before
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb), mean(lanes), speed2(lanes), q(lanes), work(lanes)
    real(dp) :: scale, v_old, v, dv, p, most, gone, other, rate, advance, settled
    integer :: l
    most = merge(0.0_dp, failure_none, law%failure%carries == carries_nothing)
    do l = 1, lanes
      if (failed(l) < 0.5_dp) cycle
      scale = law%density/mass(l)
      v_old = before%volume(l)*scale
      dv = b(l, 1)*scale - v_old
      v = debris_volume(law%failure%carries == carries_nothing, v_old, v_old + dv)
      b(l, 1) = v/scale
      if (before%pressure(l) <= closed*law%density*law%bulk_speed**2) q(l) = 0.0_dp
      if (dt > 0.0_dp) then
        rate = abs(trace(l))/dt
        q(l) = min(q(l), lone*law%density/v*law%h**2*rate/dt)
      end if
      settled = 0.5_dp*before%settling(l)*v_old*trace(l)
      other = v_old*(before%heat(l) - q(l)*trace(l)) - settled
      call debris_pressure(law, v, dv, before%acting(l), before%energy(l) + other, most, p, &
                           speed2(l))
      advance = 0.5_dp*p*merge(dv, v - v_old, dv > 0.0_dp)
      gone = 0.5_dp*before%acting(l)*dv + advance
      if (law%eos /= eos_none) b(l, law%slots%energy) = before%energy(l) + other - gone
      work(l) = before%heat(l) - (gone + settled)/v_old
      mean(l) = -p
      if (law%slots%viscous == 0) cycle
      b(l, law%slots%advanced) = advance + v_old*q(l)*trace(l)
      b(l, law%slots%viscous) = q(l)
    end do
  end subroutine debris_lanes

  !> Volume of failed matter after a step that would make it v.
  pure function debris_volume(empty, v_old, v) result(volume)
    logical, intent(in) :: empty                 !! it carries nothing
    real(dp), intent(in) :: v_old, v
    real(dp) :: volume, least
    least = closing*min(v_old, 1.0_dp)
    if (empty) least = min(v_old, 1.0_dp)
    volume = min(max(v, least), max(debris_largest, min(v, v_old)))
  end function debris_volume

  !> Pressure of failed matter after a step, and the square of its speed of sound.
  pure subroutine debris_pressure(law, v, dv, p_old, energy_before, most, p, speed2)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v, dv, p_old         !! volume, and by how much it was strained
    real(dp), intent(in) :: energy_before        !! with heat, but without work of pressure
    real(dp), intent(in) :: most                 !! largest pressure that it carries
    real(dp), intent(out) :: p, speed2
    real(dp) :: a0, b0, da, db, whole, energy
    integer :: k
    speed2 = law%bulk_speed**2
    if (law%eos == eos_none) then
      p = min(max(-law%elastic%bulk*log(v), 0.0_dp), most)
      return
    end if
    energy = energy_before
    do k = 1, merge(1, tangents, eos_linear(law))
      call open_terms(law, v, energy, a0, b0, da, db)
      whole = 1.0_dp + 0.5_dp*dv*b0
      energy = energy_before - 0.5_dp*dv*(p_old + a0)
      if (whole > least_whole) then
        energy = energy/whole
      else
        energy = energy_before - dv*p_old
      end if
    end do
    p = min(max(a0 + b0*energy, 0.0_dp), most)
    if (p <= 0.0_dp) return
    speed2 = max(speed2, eos_sound_speed_squared(law%density, v, p, energy, da, db, b0, 1.0_dp))
  end subroutine debris_pressure

  !> Terms of the equation of state, those of a gas where matter is open.
  pure subroutine open_terms(law, v, energy, a0, b0, da, db)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v, energy
    real(dp), intent(out) :: a0, b0, da, db
    call eos_terms(law, v, energy, a0, b0, da, db)
    if (v <= 1.0_dp .or. .not. eos_linear(law)) return
    db = (db - b0/v)/v
    b0 = b0/v
  end subroutine open_terms

  !> Whether the equation of state of whole matter has no waves left in expansion.
  pure function debris_torn(law, v, pressure, energy) result(yes)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v, pressure, energy
    logical :: yes
    real(dp) :: a0, b0, da, db
    yes = .false.
    if (v <= 1.0_dp) return
    call eos_terms(law, v, energy, a0, b0, da, db)
    yes = eos_sound_speed_squared(law%density, v, pressure, energy, da, db, b0, 1.0_dp) < 0.0_dp
  end function debris_torn

  !> Lanes of whole matter without a card `failure` that are torn: tension and energy after the
  !! step.
  pure subroutine tear_lanes(law, mass, before, trace, nb, b, mean, speed2, q, work)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: mass(lanes), trace(lanes)
    type(debris_t), intent(in) :: before
    integer, intent(in) :: nb
    real(dp), intent(inout) :: b(lanes, nb), mean(lanes), speed2(lanes), work(lanes)
    real(dp), intent(in) :: q(lanes)
    real(dp) :: scale, v_old, v, p, energy
    integer :: l
    do l = 1, lanes
      if (speed2(l) >= 0.0_dp) cycle
      scale = law%density/mass(l)
      v_old = before%volume(l)*scale
      v = b(l, 1)*scale
      if (v <= 1.0_dp) cycle                     ! lost in compression: for the caller to see
      energy = before%energy(l) + v_old*(before%heat(l) - q(l)*trace(l))
      p = torn_pressure(law, v, energy)
      b(l, law%slots%energy) = energy - 0.5_dp*(before%pressure(l) + p)*(v - v_old)
      work(l) = before%heat(l) - 0.5_dp*(before%pressure(l) + p)*(v - v_old)/v_old
      mean(l) = -p
      speed2(l) = law%bulk_speed**2
    end do
  end subroutine tear_lanes

  !> (DB2)
  pure function torn_pressure(law, v, energy) result(pressure)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: v, energy
    real(dp) :: pressure
    real(dp) :: critical, a0, b0, da, db
    critical = critical_volume(law, v, energy)
    call eos_terms(law, critical, energy, a0, b0, da, db)
    pressure = (a0 + b0*energy)*exp(-(v - critical)/opening)
  end function torn_pressure

  !> Largest volume up to a given one at which there are waves, at an energy.
  pure function critical_volume(law, most, energy) result(low)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: most, energy
    real(dp) :: low
    real(dp) :: high, middle, a0, b0, da, db
    integer :: i
    low = 1.0_dp
    high = most
    do i = 1, halvings
      middle = 0.5_dp*(low + high)
      call eos_terms(law, middle, energy, a0, b0, da, db)
      if (eos_sound_speed_squared(law%density, middle, a0 + b0*energy, energy, da, db, b0, &
                                  1.0_dp) < 0.0_dp) then
        high = middle
      else
        low = middle
      end if
    end do
  end function critical_volume

  !> Volume beyond which matter with a card `failure` is no body any more: the one at which cold
  !! matter loses its waves. What is hot keeps a pressure there that grows with the volume, without
  !! bound, and its speed of sound with it.
  pure subroutine debris_set_apart(law)
    type(constitutive_t), intent(inout) :: law
    real(dp) :: a0, b0, da, db
    law%apart = 1.0e30_dp
    if (.not. debris_possible(law) .or. law%eos == eos_none .or. law%softens .or. &
        law%porosity%porous) return
    if (.not. eos_linear(law)) return
    call eos_terms(law, debris_largest, 0.0_dp, a0, b0, da, db)
    if (debris_torn(law, debris_largest, a0, 0.0_dp)) then
      law%apart = critical_volume(law, debris_largest, 0.0_dp)
    end if
  end subroutine debris_set_apart

end module sgmp_debris
