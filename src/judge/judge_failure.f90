!> What failure by a local strain says about a run (doc/verdict.md).
!!
!! Strain localises in bands as wide as a cell or two, so where matter fails by its own plastic
!! strain alone, the work that a crack or a plug takes goes with the cell. How much a result can
!! depend on it is told by that work, what failed matter had taken up to its failure: it matters
!! where it is a part of what the scene was given and of what kinetic energy is left. Where failed
!! matter itself flies with more than that work, as in a debris cloud, inertia rules more than
!! strength, and the run is coarse at most. All of it as seen from the centre of mass of all.
module sgmp_judge_failure
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_tears, law_yield_stress
  use sgmp_energy_terms, only: terms_value
  use sgmp_failure, only: carries_everything, failure_by_strain, failure_none
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass, motion_velocity
  use sgmp_opinion, only: opinion_t
  use sgmp_tally, only: tally_add, tally_reset, tally_t, tally_total
  use sgmp_text, only: percent_text
  implicit none
  private
  public :: judge_failure, judge_torn

  real(dp), parameter :: least_work = 0.01_dp      !! of failed matter over the energy supplied
  real(dp), parameter :: flying_work = 0.05_dp     !! the same, where failed matter flies
  real(dp), parameter :: coarse_work = 0.05_dp     !! over the kinetic energy that is left
  real(dp), parameter :: doubtful_work = 0.25_dp   !! the same
  real(dp), parameter :: failure_weight = 2.0_dp   !! error of energies over the work
  real(dp), parameter :: least_error = 0.1_dp      !! of what is coarse
  real(dp), parameter :: doubtful_torn = 0.01_dp   !! of the mass of a body

contains

  !> Failure by a strain of the particle alone, where it takes enough work to matter; all ranks must
  !! call it. `work` is that of failed matter over the energy supplied, below 0 where nothing can
  !! fail so.
  subroutine judge_failure(opinion, model, work)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp), intent(out) :: work
    type(tally_t) :: tally
    character(:), allocatable :: reason
    real(dp) :: total(2), left, common, frame(3)
    logical :: flies                             !! failed matter, with more than its work
    integer(i8) :: none(0)
    integer :: b
    work = -1.0_dp
    if (.not. any([(fails_by_strain(model%bodies(b)), b=1, size(model%bodies))])) return
    frame = [(sum(model%totals%bodies%momentum(b)), b=1, 3)]/ &
            max(sum(model%totals%bodies%mass), tiny(1.0_dp))
    common = 0.5_dp*sum(frame**2)*sum(model%totals%bodies%mass)
    call tally_reset(tally, 2)
    do b = 1, size(model%bodies)
      if (.not. fails_by_strain(model%bodies(b))) cycle
      call add_failed(model%bodies(b), frame(:model%mesh%ndim), tally)
    end do
    call tally_total(tally, total, none)
    total(2) = total(2) + terms_value(model%ledger%terms, 'eroded.kinetic_energy')
    do b = 1, size(model%bodies)
      if (fails_by_strain(model%bodies(b))) total(1) = total(1) + model%totals%bodies(b)%taken
    end do
    work = total(1)/max(model%ledger%supplied - common, total(1), tiny(1.0_dp))
    left = total(1)/max(model%ledger%kinetic - common, tiny(1.0_dp))
    flies = total(1) < total(2)
    if (flies) left = work
    if (work < merge(flying_work, least_work, flies) .or. left < coarse_work) return
    reason = 'failure by a strain follows the cell: failed matter took '//percent_text(work)// &
             ' of the energy that the scene was given; repeat with another cell size '// &
             '(sgmp-view error)'
    if (.not. model%mesh%graded) reason = reason// &  ! averages are those of equal cells
                                          ', or give failure length=, of two cells and more'
    if (left > doubtful_work .and. .not. flies) then
      call opinion%object(reason)
    else
      call opinion%expect(max(least_error, failure_weight*left), reason)
    end if
  end subroutine judge_failure

  !> Metals that were torn though no card says when they fail; all ranks must call it. They have
  !! borne all the tension that their equation of state knows, ten times and more what metals bear
  !! (sgmp_fast_scenes).
  subroutine judge_torn(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    type(tally_t) :: tally
    character(:), allocatable :: reason
    logical :: tears(size(model%bodies))
    real(dp) :: torn(size(model%bodies))
    integer(i8) :: none(0)
    integer :: b
    tears = [(law_tears(model%bodies(b)%law) .and. .not. model%bodies(b)%rigid, &
              b=1, size(model%bodies))]
    if (.not. any(tears)) return
    call tally_reset(tally, size(model%bodies))
    do b = 1, size(model%bodies)
      if (tears(b)) call add_torn(model%bodies(b), b, tally)
    end do
    call tally_total(tally, torn, none)
    torn = torn/max(model%totals%bodies%mass, tiny(1.0_dp))
    b = maxloc(torn, dim=1)
    if (.not. torn(b) > 0.0_dp) return
    reason = percent_text(torn(b))//" of body '"//trim(model%bodies(b)%name)//"' was torn, and "// &
             'nothing says when it fails: so it held out for as long as its equation of state '// &
             'lets it; give its material a card failure, such as pmin=…'
    if (torn(b) > doubtful_torn) then
      call opinion%object(reason)
    else
      call opinion%expect(least_error, reason)
    end if
  end subroutine judge_torn

  !> Adds the mass of a body's particles that have failed.
  subroutine add_torn(body, number, tally)
    type(body_t), intent(in) :: body
    integer, intent(in) :: number                !! of the body
    type(tally_t), intent(inout) :: tally
    integer :: c, l
    associate (particles => body%particles, damage => body%law%slots%damage)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          if (particles%state(l, damage, c) < 1.0_dp) cycle
          call tally_add(tally, number, [particles%motion(l, motion_mass(particles%ndim), c)])
        end do
      end do
    end associate
  end subroutine add_torn

  !> Whether the particles of a body fail, or go, by a plastic strain of their own.
  pure logical function fails_by_strain(body) result(yes)
    type(body_t), intent(in) :: body
    yes = .not. body%rigid
    if (yes) yes = lets_go(body%law) .or. (body%law%erosion%plastic_strain < failure_none .and. &
                                           .not. resolved(body%law))
  end function fails_by_strain

  !> Whether failed matter of a law lets go at once. With a fracture energy a crack takes its own.
  pure logical function lets_go(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = (law%jc%failure .or. failure_by_strain(law%failure)) &
          .and. .not. (law%softens .or. resolved(law)) .and. &
          (law%failure%carries /= carries_everything .or. law%erosion%failed)
  end function lets_go

  !> Whether strain is averaged over a length that cells resolve.
  pure logical function resolved(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%failure%length >= 2.0_dp*law%h*(1.0_dp - 1.0e-9_dp)
  end function resolved

  !> Adds plastic work and kinetic energy of a body's particles that have failed by strain; the work
  !! is at most their yield stress times their strain.
  subroutine add_failed(body, frame, tally)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: frame(:)             !! velocity of the centre of mass
    type(tally_t), intent(inout) :: tally
    real(dp) :: strain, mass, velocity(size(frame))
    integer :: c, l, v, ndim
    if (.not. lets_go(body%law)) return
    ndim = size(frame)
    v = motion_velocity(ndim)
    associate (law => body%law, particles => body%particles)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          if (particles%state(l, law%slots%damage, c) < 1.0_dp) cycle
          strain = particles%state(l, law%slots%plastic, c)
          if (.not. law%jc%failure) strain = min(strain, law%failure%plastic_strain)
          mass = particles%motion(l, motion_mass(ndim), c)
          velocity = particles%motion(l, v:v + ndim - 1, c) - frame
          call tally_add(tally, 1, [mass/law%density*strain*law_yield_stress(law, strain), &
                                    0.5_dp*mass*sum(velocity**2)])
        end do
      end do
    end associate
  end subroutine add_failed

end module sgmp_judge_failure
