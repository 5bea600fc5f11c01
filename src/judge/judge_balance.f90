!> What the balances of energy, mass and momentum say about a run (doc/verdict.md).
module sgmp_judge_balance
  use sgmp_angular_momentum, only: angular_momentum_of, angular_momentum_t
  use sgmp_constitutive, only: eos_none, law_is_spherical, law_young
  use sgmp_energy, only: ledger_drift_beyond
  use sgmp_energy_terms, only: terms_value
  use sgmp_kernels, only: kernel_centred, kernel_mpm
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_text, only: percent_text, real_text
  use sgmp_update, only: update_usl
  implicit none
  private
  public :: judge_energy, judge_erosion, judge_impulse, judge_noise, judge_stressed, judge_turning

  ! What a sound run stays within.
  real(dp), parameter :: largest_gain = 0.1_dp         !! drift of the energy upwards
  real(dp), parameter :: coarse_gain = 0.03_dp         !! beyond which numbers are inexact
  real(dp), parameter :: gain_weight = 2.0_dp          !! their error over the gain
  real(dp), parameter :: largest_loss = 0.25_dp        !! and downwards
  real(dp), parameter :: coarse_loss = 0.03_dp         !! beyond which numbers are inexact
  real(dp), parameter :: loss_weight = 1.5_dp          !! their error over the loss
  real(dp), parameter :: least_error = 0.1_dp          !! of what is coarse
  real(dp), parameter :: largest_gift = 0.05_dp        !! negative internal energy
  real(dp), parameter :: largest_eroded = 0.05_dp      !! part of the mass
  real(dp), parameter :: largest_turn = 0.05_dp        !! change of angular momentum over the first
  real(dp), parameter :: coarse_turn = 0.02_dp         !! beyond which numbers are inexact
  real(dp), parameter :: least_turn = 0.1_dp           !! that over what the motion could have
  real(dp), parameter :: largest_impulse = 1.0e-4_dp   !! lost, over the largest momentum
  real(dp), parameter :: round_off = 1.0e-12_dp        !! kinetic over internal energy of what rests
  real(dp), parameter :: largest_unfelt = 10.0_dp      !! work of forces that particles do not feel
  real(dp), parameter :: coarse_unfelt = 3.0_dp        !! beyond which bodies are too soft
  real(dp), parameter :: unfelt_error = 0.15_dp        !! by so much
  ! Strain times time, over that of a wave through a cell, after which stress is noise.
  real(dp), parameter :: stressed_remapped = 220.0_dp  !! a strip at 44 degrees; at 30: above 600
  real(dp), parameter :: stressed_error = 0.3_dp       !! of it
  real(dp), parameter :: noise = 0.02_dp               !! kinetic over elastic energy
  !> The same with frame=reference, of mpm and gimp: bars held at both ends (make truth, held).
  real(dp), parameter :: stressed_first(2) = [120.0_dp, 310.0_dp]
  real(dp), parameter :: stressed_sgmp = 50.0_dp, stressed_mpm = 40.0_dp, stressed_other = 15.0_dp

contains

  !> Energy from nowhere, or gone.
  subroutine judge_energy(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp) :: drift, given
    integer :: b
    drift = ledger_drift_beyond(model%ledger)
    if (drift > largest_gain) then
      call opinion%object('the energy has grown by '//percent_text(drift)// &
                          ' of what the scene was given: reduce cfl')
    else if (drift > coarse_gain) then
      call opinion%expect(max(least_error, gain_weight*drift), 'the energy has grown by '// &
                          percent_text(drift)//' of what the scene was given: reduce cfl')
    else if (drift < -largest_loss) then
      call opinion%object(percent_text(-drift)//' of the energy that the scene was given is '// &
                          'gone, not into contact: use update=musl, smaller cells')
    else if (drift < -coarse_loss) then
      call opinion%expect(max(least_error, -loss_weight*drift), percent_text(-drift)// &
                          ' of the energy that the scene was given is gone: use '// &
                          'update=musl, smaller cells')
    end if
    do b = 1, size(model%bodies)
      ! Elastic energy is never negative, plastic work neither; an equation of state has its own.
      if (model%bodies(b)%rigid .or. model%bodies(b)%law%eos /= eos_none) cycle
      given = -(model%totals%bodies(b)%internal + model%totals%bodies(b)%taken)
      if (given <= largest_gift*model%ledger%supplied) cycle
      call opinion%object("body '"//trim(model%bodies(b)%name)//"' has given away energy "// &
                          'that it never had, '//percent_text(given/model%ledger%supplied)// &
                          ' of what the scene was given: soil that dilates (reduce '// &
                          'dilatancy), or an elastic law far beyond small strains')
    end do
  end subroutine judge_energy

  !> Where a body is damped to rest, forces that nodes receive and no particle feels: noise of the
  !! stress, by which the body becomes too soft (doc/hard-cases.md). Bodies that move have such
  !! forces, too, without harm; and so have those whose strains are corrected at surfaces.
  subroutine judge_noise(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    character(:), allocatable :: reason
    if (.not. model%method%damped .or. model%method%flip < 1.0_dp) return
    if (model%method%surfaces .and. .not. plain_solids(model)) return
    if (model%ledger%damped_share <= coarse_unfelt) return
    reason = 'nodes push with forces that no particle feels: projection has lost '// &
             real_text(model%ledger%damped_share)//' times the energy that the scene was '// &
             'given, so stress is noise in part and bodies are too soft: use method bspline, '// &
             'half the cfl or more particles per cell'
    if (model%ledger%damped_share > largest_unfelt) then
      call opinion%object(reason)
    else
      call opinion%expect(unfelt_error, reason)
    end if
  end subroutine judge_noise

  !> Whether a solid moves in a field whose strains are not corrected at surfaces.
  pure function plain_solids(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    integer :: b
    yes = .false.
    do b = 1, size(model%bodies)
      associate (body => model%bodies(b))
        if (body%rigid .or. law_is_spherical(body%law)) cycle
        yes = yes .or. .not. model%fields(body%field)%columns%corrected
      end associate
    end do
  end function plain_solids

  !> Elastic bodies that have been under stress for long, where particles move with another velocity
  !! than the one that strains them: their stress turns into noise (doc/surfaces.md, 7).
  subroutine judge_stressed(opinion, model, stressed)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp), intent(out) :: stressed  !! strain times time over that of a wave through a cell;
                                       !! -1: no such bodies
    real(dp) :: young, stiffness, fastest, bound
    logical :: remapped
    integer :: b
    stressed = -1.0_dp
    if (model%method%update == update_usl) return
    remapped = .true.                  ! what deforms; fields of rigid bodies are not
    stiffness = 0.0_dp
    fastest = 0.0_dp
    do b = 1, size(model%bodies)
      if (model%bodies(b)%rigid .or. model%bodies(b)%twin_of > 0) cycle
      if (.not. model%bodies(b)%springs) return
      associate (law => model%bodies(b)%law)
        young = law_young(law)
        stiffness = stiffness + model%totals%bodies(b)%mass*young/law%density
        fastest = max(fastest, sqrt(young/law%density))
      end associate
      remapped = remapped .and. model%fields(model%bodies(b)%field)%columns%remapped
    end do
    if (stiffness <= 0.0_dp) return
    stressed = sqrt(2.0_dp/stiffness)*fastest/model%mesh%h*model%ledger%stress_time
    if (remapped) then
      if (stressed <= stressed_remapped) return
      if (model%ledger%kinetic <= noise*model%ledger%internal) return
      call opinion%expect(stressed_error, 'elastic bodies have been under stress for long, '// &
                          'strain times time '//real_text(stressed)//' over that of a wave '// &
                          'through a cell, and move: along the diagonals of cells stress '// &
                          'becomes noise in the end (doc/surfaces.md); use larger cells, or '// &
                          'turn what is thin by some degrees')
      return
    end if
    if (kernel_centred(model%fields(1)%kernel)) then
      bound = stressed_sgmp
    else
      bound = merge(stressed_mpm, stressed_other, model%fields(1)%kernel == kernel_mpm)
      if (model%method%features%reference) then
        bound = stressed_first(merge(1, 2, model%fields(1)%kernel == kernel_mpm))
      end if
    end if
    if (stressed <= bound) return
    call opinion%object('elastic bodies have been under stress for so long, strain times time '// &
                        real_text(stressed)//' over that of a wave through a cell (at most '// &
                        real_text(bound)//'), that much of it has become noise: use '// &
                        'drift=remapped with update=musl, best of all method sgmp, which takes it')
  end subroutine judge_stressed

  !> Mass and energy that erosion has taken away from what would have been hit or held by them, and
  !! bodies of which it has left nothing.
  subroutine judge_erosion(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp) :: all, mass, energy
    integer :: b
    associate (terms => model%ledger%terms)
      if (terms_value(terms, 'eroded.particles') <= 0.0_dp) return
      mass = terms_value(terms, 'eroded.mass')
      energy = (terms_value(terms, 'eroded.kinetic_energy') + &
                terms_value(terms, 'eroded.internal_energy'))/ &
               max(model%ledger%supplied, tiny(1.0_dp))
      all = mass + sum(model%totals%bodies%mass, mask=.not. model%bodies%rigid)
      if (mass > largest_eroded*all) then
        call opinion%object(percent_text(mass/all)//' of the mass was eroded: what it would '// &
                         'have pushed or stopped is not in the result; raise the limits of erode')
      else if (energy > largest_eroded) then
        call opinion%object(percent_text(energy)//' of the energy that the scene was given was '// &
                         'eroded: what it would have done is not in the result; raise the '// &
                         'limits of erode')
      end if
    end associate
    do b = 1, size(model%bodies)
      if (model%totals%particles(b) > 0 .or. model%bodies(b)%rigid) cycle
      if (model%bodies(b)%twin_of > 0) cycle
      if (model%clock%time >= model%bodies(b)%removed_at) cycle
      call opinion%object("erosion has left nothing of body '"//trim(model%bodies(b)%name)// &
                       "': what it would have hit was not hit; raise the limits of erode")
    end do
  end subroutine judge_erosion

  !> Forces that moved nothing, for they acted on nodes without mass: momentum is not kept.
  subroutine judge_impulse(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp) :: momentum
    ! Of what rests the kinetic energy is round-off.
    momentum = sqrt(2.0_dp*sum(model%totals%bodies%mass, mask=.not. model%bodies%rigid)* &
                    max(model%ledger%largest_kinetic, round_off*abs(model%ledger%internal)))
    associate (lost => model%ledger%lost_impulse)
      if (.not. lost > largest_impulse*momentum) return
      call opinion%object('forces acted on grid points without mass and moved nothing, an '// &
                          'impulse of '//percent_text(lost/max(momentum, tiny(1.0_dp)))// &
                          ' of the largest momentum: particles lie on the faces of cells; '// &
                          'shift the body or the grid by a part of a cell')
    end associate
  end subroutine judge_impulse

  !> Angular momentum that nothing acts on, and yet has changed.
  subroutine judge_turning(opinion, scene, model, largest)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), intent(inout) :: largest     !! change that was judged
    type(angular_momentum_t) :: now
    character(:), allocatable :: remedy
    real(dp) :: change
    integer :: f
    if (model%findings%lost > 0) return
    remedy = '; use smaller cells or cfl'
    if (.not. scene%method%rotation) remedy = '; method sgmp rotation=exact keeps it'
    do f = 1, size(model%fields)
      associate (before => model%turning(f))
        if (norm2(before%vector) <= least_turn*before%largest) cycle
        call angular_momentum_of(model%mesh, model%bodies, model%totals%bodies, f, now)
        change = norm2(now%vector - before%vector)/norm2(before%vector)
        largest = max(largest, change)
        if (.not. change > coarse_turn) cycle
        call turned(opinion, change, "the angular momentum of body '"// &
                    trim(model%bodies(findloc(model%bodies%field, f, 1))%name)// &
                    "' has changed by "//percent_text(change)//', though nothing acts on it'// &
                    remedy)
      end associate
    end do
  end subroutine judge_turning

  !> A change of angular momentum: an error, or a doubt.
  subroutine turned(opinion, change, reason)
    type(opinion_t), intent(inout) :: opinion
    real(dp), intent(in) :: change         !! over that of the start
    character(*), intent(in) :: reason
    if (change > largest_turn) then
      call opinion%object(reason)
    else
      call opinion%expect(least_error, reason)
    end if
  end subroutine turned

end module sgmp_judge_balance
