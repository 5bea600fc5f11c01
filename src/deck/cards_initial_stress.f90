!> The card `initial_stress`: what bodies bear before anything moves.
module sgmp_cards_initial_stress
  use sgmp_constitutive, only: law_is_spherical, material_names
  use sgmp_deck_card, only: deck_card_t
  use sgmp_expression, only: expression_clone, expression_free
  use sgmp_keys, only: kind_expression, kind_name_word, kind_real
  use sgmp_kinds, only: dp
  use sgmp_material_weight, only: law_bears_stress, laws_that_bear_stress
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: initial_stress_card_t, scene_space
  use sgmp_scene_draft, only: draft_t
  use sgmp_spelling, only: word_position
  use sgmp_voigt, only: stress_components, voigt_name, voigt_names
  implicit none
  private
  public :: register_initial_stress

  character(8), parameter :: ground(*) = [character(8) :: 'surface', 'pressure', 'k0']

contains

  !> Registers the card.
  subroutine register_initial_stress(registry)
    type(registry_t), intent(inout) :: registry
    integer :: c
    call registry%card('initial_stress', 'Stress of a body at the start: that of ground at '// &
                       'rest under gravity (surface, pressure, k0), a pressure, or any '// &
                       '(xx … xz).', &
                       'initial_stress soil surface=10 k0=0.5', read_stress, check_stress)
    call registry%key('body', kind_name_word, 'the body; default: all that are not rigid '// &
                      'and have no card of their own', &
                      default='all', slot=1)
    call registry%key('surface', kind_expression, 'height of the surface, against gravity and '// &
                      'from the origin, a function of the place; the stress is the weight '// &
                      'between it and the particle', unit='length', source='doc/loads.md')
    call registry%key('pressure', kind_real, 'on the surface, e.g. by what lies above; '// &
                      'without gravity and surface the same everywhere; '// &
                      'default: 0, of a fluid that of its equation of state', unit='stress')
    call registry%key('k0', kind_real, 'stress across gravity over that along it; default: '// &
                      'poisson/(1 - poisson)', range='[0,inf)')
    do c = 1, size(voigt_names)
      call registry%key(voigt_names(c), kind_expression, 'component of the stress, tension '// &
                        'positive, a function of the place; named as in output, so in an '// &
                        'axisymmetric scene yy is around the axis; default: 0', unit='stress')
    end do
  end subroutine register_initial_stress

  subroutine read_stress(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: named, b, c
    logical :: parts, weight, even
    named = draft%body_of(card, 'body')
    if (named < 0) return
    parts = any([(card%has(voigt_names(c)), c=1, size(voigt_names))])
    weight = any([(card%has(trim(ground(c))), c=1, size(ground))])
    if (parts .eqv. weight) then
      call draft%errors%add(card%position, trim(merge( &
        'components and the weight of the ground are two ways to say the stress', &
        'the card does not say which stress                                    ', parts)), &
        'give surface, or components such as xx, yy and zz')
      return
    end if
    even = card%has('pressure') .and. .not. card%has('k0')  ! the same everywhere, without gravity
    if (weight .and. .not. (card%has('surface') .or. even)) then
      call draft%errors%add(card%position, 'the ground has no surface', 'add surface=…')
      return
    end if
    call refuse_time(card, draft)
    call refuse_second(card, named, draft)
    do b = 1, draft%bodies
      associate (stress => draft%scene%bodies(b)%stress)
        if (named == b .or. (named == 0 .and. .not. stress%named)) call take(card, draft, stress)
        stress%named = stress%named .or. named == b
      end associate
    end do
  end subroutine read_stress

  !> A body has one card of its own, which comes before the one for all.
  subroutine refuse_second(card, named, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: named                 !! the body; 0: all
    type(draft_t), intent(inout) :: draft
    logical :: second
    if (named > 0) then
      second = draft%scene%bodies(named)%stress%named
    else
      second = any(draft%scene%bodies(:draft%bodies)%stress%given .and. &
                   .not. draft%scene%bodies(:draft%bodies)%stress%named)
    end if
    if (second) call draft%errors%add(card%position, "'"//card%word('body')//"' has two "// &
                                      'initial stresses', 'remove one of the cards')
  end subroutine refuse_second

  !> What a card says, for one body.
  subroutine take(card, draft, stress)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(in) :: draft
    type(initial_stress_card_t), intent(inout) :: stress
    integer :: c, k
    stress%given = .true.
    stress%geostatic = card%has('surface')
    stress%location = card%position%text()
    stress%pressure = card%number('pressure')
    stress%pressure_given = card%has('pressure')
    stress%k0 = card%number('k0', absent=-1.0_dp)
    call expression_free(stress%surface)
    stress%surface = expression_clone(card%values(card%at('surface'))%expression)
    do c = 1, stress_components(merge(3, draft%scene%dimension, draft%scene%swirl))
      k = card%at(voigt_name(c, scene_space(draft%scene)))
      call expression_free(stress%value(c))
      stress%value(c) = expression_clone(card%values(k)%expression)
    end do
  end subroutine take

  !> Nothing is at the start a function of the time, nor has a scene every component.
  subroutine refuse_time(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    character(2) :: kept(size(voigt_names))
    integer :: c, n
    n = stress_components(merge(3, draft%scene%dimension, draft%scene%swirl))
    do c = 1, n
      kept(c) = voigt_name(c, scene_space(draft%scene))
    end do
    do c = 1, size(card%values)
      if (card%values(c)%present .and. card%values(c)%expression%uses_time) then
        call draft%errors%add(card%values(c)%position, 'the initial stress cannot depend on t', &
                              'use the place')
      end if
    end do
    do c = 1, size(voigt_names)
      if (.not. card%has(voigt_names(c)) .or. any(kept(:n) == voigt_names(c))) cycle
      call draft%errors%add(card%place(voigt_names(c)), 'there is no '//voigt_names(c)//' '// &
                            draft%in_space(), 'remove it')
    end do
  end subroutine refuse_time

  !> Bodies that cannot bear it, and a weight without gravity.
  subroutine check_stress(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: named, b
    if (card%has('surface') .and. norm2(draft%scene%gravity) <= 0.0_dp) then
      call draft%errors%add(card%place('surface'), 'nothing weighs: there is no gravity', &
                            'add gravity, or give pressure alone, or components of the stress')
    end if
    if (card%has('pressure') .and. .not. card%has('surface') .and. &
        norm2(draft%scene%gravity) > 0.0_dp) then
      call draft%errors%add(card%position, 'the ground has no surface', 'add surface=…')
    end if
    named = 0
    if (card%word('body') /= 'all') then
      named = word_position(card%word('body'), draft%scene%bodies%name)
      if (named == 0) return  ! which was said when the card was read
    end if
    do b = 1, draft%bodies
      if (named /= 0 .and. named /= b) cycle
      if (draft%scene%bodies(b)%rigid .and. named == 0) cycle
      call check_body(card, b, draft)
    end do
  end subroutine check_stress

  subroutine check_body(card, b, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: b
    type(draft_t), intent(inout) :: draft
    character(:), allocatable :: name
    associate (body => draft%scene%bodies(b), law => draft%scene%materials)
      if (body%material == 0) return
      if (law(body%material)%law%kind == 0) return  ! an unknown kind, which was said
      name = "'"//trim(body%name)//"'"
      if (body%rigid) then
        call draft%errors%add(card%place('body'), name//' is rigid and has no stress', 'remove it')
      else if (.not. law_bears_stress(law(body%material)%law)) then
        call draft%errors%add(card%place('body'), 'the stress of '//name//' ('// &
                              trim(material_names(law(body%material)%law%kind))//') follows '// &
                              'from its volume or its deformation, so none can be given', &
                              'use '//laws_that_bear_stress()//' without eos and softening, '// &
                              'or a fluid without viscosity and pores')
      else if (law_is_spherical(law(body%material)%law)) then
        if (.not. (card%has('surface') .or. card%has('pressure'))) then
          call draft%errors%add(card%position, name//' is a fluid: its stress is a pressure', &
                                'give surface, and pressure if it is not that of the '// &
                                'equation; without gravity, pressure alone')
        else if (card%has('k0') .and. abs(card%number('k0') - 1.0_dp) > 0.0_dp) then
          call draft%errors%add(card%place('k0'), name//' is a fluid: its pressure is the same '// &
                                'all around', 'remove k0')
        end if
      end if
    end associate
  end subroutine check_body

end module sgmp_cards_initial_stress
