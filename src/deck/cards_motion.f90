!> The card `motion`: the prescribed motion of a part of a body.
module sgmp_cards_motion
  use sgmp_deck_card, only: deck_card_t
  use sgmp_drive, only: most_drives
  use sgmp_expression, only: expression_clone, expression_t
  use sgmp_keys, only: kind_expression, kind_name_word, kind_real, kind_vector
  use sgmp_kinds, only: dp
  use sgmp_registry, only: registry_t
  use sgmp_rolling, only: scene_rubbed
  use sgmp_scene, only: motion_card_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_space, only: axis_names, omega_names, space_axisymmetric
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: register_motion

  integer, parameter :: around = 3               !! component around the axis

contains

  !> Registers the card.
  subroutine register_motion(registry)
    type(registry_t), intent(inout) :: registry
    integer :: axis
    call registry%card('motion', 'Prescribes the motion of a part of a body: a grip, a clamp, '// &
                       'a rim. What it takes is in motion.csv.', &
                       'motion bar where="x>0.9" x="v0*min(t/t0,1)" y=0', read_motion, &
                       check_motion)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call registry%key('where', kind_expression, 'the particles that are moved: those at whose '// &
                      'place at the start this function is not 0, e.g. "x<0.01 && y>0"', &
                      default='1', source='doc/loads.md')
    do axis = 1, 3
      call registry%key(axis_names(axis, 3), kind_expression, 'velocity, a function of t '// &
                        'alone; default: free, or 0 where the part turns', unit='speed')
    end do
    call registry%key(axis_names(1, space_axisymmetric), kind_expression, 'velocity along r of '// &
                      'an axisymmetric scene, a function of t alone', unit='speed')
    do axis = 1, 3
      call registry%key(omega_names(axis), kind_expression, 'angular velocity about an axis in '// &
                        'radians per time, a function of t alone', unit='1/time')
    end do
    call registry%key('spin', kind_expression, 'angular velocity about the axis of an '// &
                      'axisymmetric scene with swirl, radians per time, a function of t alone; '// &
                      'default: free', unit='1/time')
    call registry%key('about', kind_vector, 'the point that has the velocity, at the start; '// &
                      'default: the centre of mass of the part', unit='length')
    call registry%key('until', kind_real, 'the part is free from this time on; default: never', &
                      unit='time', range='(0,inf)')
  end subroutine register_motion

  subroutine read_motion(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(motion_card_t) :: new
    integer :: axis
    new%location = card%position%text()
    new%body = draft%body_of(card, 'body')
    if (new%body == 0) call draft%errors%add(card%place('body'), &
                                             'a motion belongs to a part of one body', &
                                             'name it; write a card for each')
    if (new%body <= 0) return
    do axis = 1, 3
      call take(card, omega_names(axis), draft, new%omega(axis), new%turns)
    end do
    do axis = 1, draft%scene%dimension
      call take(card, draft%axis_key(axis), draft, new%velocity(axis), new%axes(axis))
      new%axes(axis) = new%axes(axis) .or. new%turns
    end do
    call take(card, 'spin', draft, new%omega(around), new%axes(around))
    new%about_axis = draft%scene%swirl
    if (card%has('spin') .and. .not. new%about_axis) then
      call draft%errors%add(card%place('spin'), 'the scene has no swirl', &
                            'write dimension axisymmetric swirl=yes, or remove spin')
    end if
    new%about = card%vector('about')
    new%about_given = card%has('about')
    new%until = card%number('until', absent=new%until)
    associate (where => card%values(card%at('where')))
      if (where%expression%uses_time) then
        call draft%errors%add(where%position, "'where' cannot depend on t: it chooses at the "// &
                              'start', 'use x, y and z; let the velocity depend on t')
      end if
      new%where = expression_clone(where%expression)
    end associate
    call check_turning(card, draft, new%turns)
    if (.not. any(new%axes)) then
      call draft%errors%add(card%position, 'the motion prescribes nothing', &
                            'give a velocity: x=0 holds the part along x')
    end if
    draft%scene%motions = [draft%scene%motions, new]
    if (size(draft%scene%motions) == most_drives + 1) then
      call draft%errors%add(card%position, 'there are more than '//integer_text(most_drives)// &
                            ' cards motion', 'let one card move several parts alike: '// &
                            'where="x<0.1 || x>0.9"')
    end if
  end subroutine read_motion

  !> A component, if the card has it.
  subroutine take(card, key, draft, formula, given)
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key
    type(draft_t), intent(inout) :: draft
    type(expression_t), intent(inout) :: formula
    logical, intent(inout) :: given              !! set where there is one
    if (card%at(key) == 0) return
    if (.not. card%has(key)) return
    associate (value => card%values(card%at(key)))
      if (value%expression%uses_position .or. value%expression%uses_initial_position) then
        call draft%errors%add(value%position, 'the velocity of a part of a body cannot depend '// &
                              'on position', 'use t only; parts turn by omega_x, omega_y, omega_z')
      end if
      formula = expression_clone(value%expression)
    end associate
    given = .true.
  end subroutine take

  !> Parts turn about axes that the scene has.
  subroutine check_turning(card, draft, turns)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    logical, intent(in) :: turns
    integer :: axis
    do axis = 1, 3
      if (.not. card%has(omega_names(axis)) .or. draft%turns_about(axis)) cycle
      call draft%errors%add(card%place(omega_names(axis)), 'nothing turns about '// &
                            omega_names(axis)(7:)//' '//draft%in_space(), 'remove '// &
                            omega_names(axis)//trim(merge('; omega_z turns in the plane', &
                                                          '                            ', &
                                                          draft%turns_about(3))))
    end do
    if (card%has('about') .and. .not. turns) then
      call draft%errors%add(card%place('about'), "'about' of a part that does not turn", &
                            'give omega_x, omega_y or omega_z, or remove it')
    end if
  end subroutine check_turning

  !> What a part of a body can be moved with.
  subroutine check_motion(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b
    b = draft%body_of(card, 'body')
    if (b <= 0) return
    associate (scene => draft%scene, errors => draft%errors)
      if (scene%bodies(b)%rigid) then
        call errors%add(card%place('body'), "body '"//card%word('body')//"' is rigid: it moves "// &
                        'as a whole', 'its motion is that of its card rigid')
      end if
      if (.not. scene%method%rotation .or. scene%swirl) return
      if (scene_rubbed(scene, b) > 0) then
        call errors%add(card%place('body'), "body '"//card%word('body')//"' is rubbed by "// &
                        'others, and so cannot be moved in part with rotation=exact: friction '// &
                        'then acts at the surface and not at nodes', &
                        'remove friction from the card contact, or write rotation=plain')
      end if
    end associate
  end subroutine check_motion

end module sgmp_cards_motion
