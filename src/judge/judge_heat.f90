!> What softening by heat says about a run (doc/verdict.md).
!!
!! Where the heat of plastic work takes more strength than hardening gives, strain gathers in bands
!! as wide as a cell or two, so that their strain and heat follow the cell, and what they bear
!! differs by some tenths from size to size. Matter that has not failed and has lost two fifths of
!! its strength to heat is that of such bands: in uniform strain it takes plastic work of some GPa.
!! It matters where its plastic work is a part of what the scene was given and of what kinetic
!! energy is left, as that of failed matter does (judge_failure.f90), but is never more than coarse.
!! A length of two cells and more gives bands a width.
module sgmp_judge_heat
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_yield_stress, material_johnson_cook, &
                               material_steinberg_guinan, material_zerilli_armstrong
  use sgmp_heating, only: heating_t
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_material_jc, only: jc_softening
  use sgmp_material_zerilli_armstrong, only: zerilli_armstrong_yield_stress
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass
  use sgmp_opinion, only: opinion_t
  use sgmp_tally, only: tally_add, tally_reset, tally_t, tally_total
  use sgmp_text, only: percent_text
  implicit none
  private
  public :: judge_heat

  real(dp), parameter :: softened = 0.6_dp       !! of the strength is left to what counts
  real(dp), parameter :: least_work = 0.05_dp    !! of softened matter over the energy supplied
  real(dp), parameter :: coarse_work = 0.05_dp   !! over the kinetic energy that is left
  real(dp), parameter :: softened_weight = 2.0_dp  !! error of energies over the work
  real(dp), parameter :: least_error = 0.1_dp, largest_error = 0.3_dp  !! of what is coarse

contains

  !> Bands of matter that heat has softened, where they take enough work to matter; all ranks must
  !! call it. `work` is theirs over the energy supplied, below 0 where heat softens nothing.
  subroutine judge_heat(opinion, model, work)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp), intent(out) :: work
    type(tally_t) :: tally
    character(:), allocatable :: reason
    real(dp) :: total(1), left, frame(3), common
    integer(i8) :: none(0)
    integer :: b, i
    work = -1.0_dp
    if (.not. any([(warms(model%bodies(b)), b=1, size(model%bodies))])) return
    frame = [(sum(model%totals%bodies%momentum(i)), i=1, 3)]/ &
            max(sum(model%totals%bodies%mass), tiny(1.0_dp))
    common = 0.5_dp*sum(frame**2)*sum(model%totals%bodies%mass)
    call tally_reset(tally, 1)
    do b = 1, size(model%bodies)
      if (warms(model%bodies(b))) call add_softened(model%bodies(b), model%mesh%ndim, tally)
    end do
    call tally_total(tally, total, none)
    work = total(1)/max(model%ledger%supplied - common, total(1), tiny(1.0_dp))
    left = total(1)/max(model%ledger%kinetic - common, tiny(1.0_dp))
    if (work < least_work .or. left < coarse_work) return
    reason = 'bands that heat softens follow the cell: matter that lost two fifths of its '// &
             'strength took '//percent_text(work)//' of the energy that the scene was given; '// &
             'repeat with another cell size'//remedy(model)
    call opinion%expect(min(max(least_error, softened_weight*left), largest_error), reason)
  end subroutine judge_heat

  !> What gives bands a width, where a law of the scene takes it.
  function remedy(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    integer :: b
    text = ' (sgmp-view error)'
    if (model%mesh%graded) return            ! averages are those of equal cells
    do b = 1, size(model%bodies)
      if (.not. warms(model%bodies(b))) cycle
      if (model%bodies(b)%law%kind /= material_johnson_cook) return
    end do
    text = text//', or give failure length=, of two cells and more'
  end function remedy

  !> Whether heat of its own plastic strain softens a body.
  pure logical function warms(body) result(yes)
    type(body_t), intent(in) :: body
    associate (law => body%law)
      yes = .not. body%rigid .and. law%slots%temperature > 0 .and. &
            law%failure%length < 2.0_dp*law%h*(1.0_dp - 1.0e-9_dp)
      select case (law%kind)
      case (material_johnson_cook)
        yes = yes .and. law%jc%thermal
      case (material_steinberg_guinan, material_zerilli_armstrong)
        yes = yes .and. law%heating%warms
      case default
        yes = .false.
      end select
    end associate
  end function warms

  !> Adds the plastic work of a body's particles that heat has softened: what their temperature
  !! says, and at most their yield stress times their strain.
  subroutine add_softened(body, ndim, tally)
    type(body_t), intent(in) :: body
    integer, intent(in) :: ndim
    type(tally_t), intent(inout) :: tally
    type(heating_t) :: heating
    real(dp) :: strain, temperature, volume, heat
    integer :: c, l
    heating = heat_of(body%law)
    if (heating%taylor_quinney <= 0.0_dp) return
    associate (law => body%law, particles => body%particles)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          if (law%slots%damage > 0) then
            if (particles%state(l, law%slots%damage, c) >= 1.0_dp) cycle
          end if
          strain = particles%state(l, law%slots%plastic, c)
          temperature = particles%state(l, law%slots%temperature, c)
          if (heat_left(law, strain, temperature) >= softened) cycle
          volume = particles%motion(l, motion_mass(ndim), c)/law%density
          heat = heating%heat_capacity*(temperature - heating%room)/heating%taylor_quinney
          call tally_add(tally, 1, [volume*min(heat, strain*law_yield_stress(law, strain))])
        end do
      end do
    end associate
  end subroutine add_softened

  !> Part of the strength at a plastic strain that a temperature leaves, without pressure.
  pure function heat_left(law, strain, temperature) result(left)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: strain, temperature
    real(dp) :: left
    select case (law%kind)
    case (material_johnson_cook)
      left = jc_softening(law%jc, temperature)
    case (material_steinberg_guinan)
      left = max(0.0_dp, 1.0_dp - law%steinberg_guinan%thermal_softening &
                 *(temperature - law%heating%room))
      if (temperature >= law%heating%melt) left = 0.0_dp
    case default  ! material_zerilli_armstrong
      left = zerilli_armstrong_yield_stress(law%zerilli_armstrong, strain, &
                                            law%zerilli_armstrong%reference_rate, temperature) &
             /law_yield_stress(law, strain)
    end select
  end function heat_left

  !> Heat that plastic work gives, whichever law it is.
  pure function heat_of(law) result(heating)
    type(constitutive_t), intent(in) :: law
    type(heating_t) :: heating
    heating = law%heating
    if (law%kind /= material_johnson_cook) return
    heating%room = law%jc%room
    heating%heat_capacity = law%jc%heat_capacity
    heating%taylor_quinney = law%jc%taylor_quinney
  end function heat_of

end module sgmp_judge_heat
