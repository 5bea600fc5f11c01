!> The cards `group`, `contact` and `rigid`: names to bodies, and what must hold between them.
module sgmp_cards_contact
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_contact_pairs, only: normal_names, normal_separating
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_expression, only: expression_clone, expression_free, expression_t
  use sgmp_keys, only: kind_expression, kind_list, kind_logical, kind_name_word, kind_real, &
                       kind_vector, kind_word
  use sgmp_kinds, only: dp
  use sgmp_registry, only: read_third, registry_t
  use sgmp_scene, only: contact_card_t, scene_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_space, only: axis_names, omega_names, space_axisymmetric
  use sgmp_spelling, only: string_t, suggestion, word_items, word_position, words_joined
  implicit none
  private
  public :: register_contact

contains

  !> Registers the cards of this group.
  subroutine register_contact(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('group', 'Bodies that share a velocity field: fluids and explosives '// &
                       'mix, others are bonded. A card contact names them by the name of the '// &
                       'group.', 'group gas charge,air', read_group, check_group, &
                       turn=read_third)
    call registry%key('name', kind_name_word, 'name of the group, of no body', slot=1, &
                      required=.true.)
    call registry%key('bodies', kind_list, 'its bodies, two or more', slot=2, required=.true.)
    call registry%card('contact', 'Lets bodies touch, slide and separate. Without it solids '// &
                       'touch without friction, but those that share a surface at the start '// &
                       'and move alike are bonded (doc/contact.md, Without a card). Names two '// &
                       'bodies or groups, one (with all others) or all; the card that names '// &
                       'more counts.', &
                       'contact ball plate friction=0.4', read_contact, check_contact)
    call registry%key('first', kind_name_word, 'a body, a group or all', default='all', slot=1)
    call registry%key('second', kind_name_word, 'another body or group; default: all others', &
                      default='all', slot=2)
    call registry%key('friction', kind_real, "Coulomb's coefficient of friction", &
                      range='[0,inf)', default='0', &
                      source='Kan, Liang and Zhang 2021, Eqs. 81 to 84')
    call registry%key('lambda', kind_real, 'bodies touch where their particles are closer than '// &
                      'this many cells along the normal; default: the mean of their spacings', &
                      range='(0,inf)', &
                      source='Kan, Liang and Zhang 2021, Eq. 86')
    call registry%key('depth', kind_real, 'contact acts at nodes no further than this many '// &
                      'cells from where the surfaces touch; default: at all shared nodes', &
                      range='[0.5,inf)', source='doc/contact.md')
    call registry%key('normal', kind_word, 'common normal: along the shortest line between the '// &
                      "bodies' particles around a node, or from the gradient of volume of "// &
                      'both bodies, of one, or of the stiffer', &
                      choices=words_joined(normal_names), &
                      default=trim(normal_names(normal_separating)), &
                      source='Kan, Liang and Zhang 2021, Eqs. 87 and 88')
    call registry%key('self', kind_logical, 'the bodies that the card names, or all that are '// &
                      'neither rigid nor flow, touch themselves, too', default='no', &
                      source='doc/contact.md')
    call register_rigid(registry)
  end subroutine register_contact

  subroutine register_rigid(registry)
    type(registry_t), intent(inout) :: registry
    integer :: axis
    call registry%card('rigid', 'Makes a body rigid: it moves and turns as prescribed, '// &
                       'whatever acts on it, or with free=yes by the forces on it.', &
                       'rigid punch y="-v0*sin(pi*t)"', read_rigid, check_rigid)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    do axis = 1, 3
      call registry%key(axis_names(axis, 3), kind_expression, 'velocity, a function of t alone', &
                        unit='speed', default='0')
    end do
    call registry%key(axis_names(1, space_axisymmetric), kind_expression, 'velocity along r of '// &
                      'an axisymmetric scene, a function of t alone', unit='speed')
    do axis = 1, 3
      call registry%key(omega_names(axis), kind_expression, 'angular velocity about an axis in '// &
                        'radians per time, a function of t alone', unit='1/time', default='0')
    end do
    call registry%key('about', kind_vector, 'the point that has the velocity, at the start; '// &
                      'default: the centre of mass', unit='length')
    call registry%key('free', kind_logical, 'contact, gravity and body forces move and turn '// &
                      'the body, which starts with its card velocity', default='no', &
                      source='doc/loads.md')
    call registry%key('mass', kind_real, 'mass of a free body; default: of its particles', &
                      unit='mass', range='(0,inf)')
  end subroutine register_rigid

  !> Gives the bodies of a group their leader, the first of them.
  subroutine read_group(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(string_t), allocatable :: names(:)
    character(:), allocatable :: name
    integer :: number, i, b, leader
    names = word_items(card%word('bodies'))
    name = card%word('name')
    associate (bodies => draft%scene%bodies, errors => draft%errors)
      if (word_position(name, bodies%name) > 0 .or. name == 'all') then
        call errors%add(card%place('name'), "'"//name//"' is the name of a body", &
                        'give the group another one')
        return
      end if
      if (word_position(name, bodies%group) > 0) then
        call errors%add(card%place('name'), "there are two groups '"//name//"'", &
                        'rename one of them')
        return
      end if
      if (size(names) < 2) then
        call errors%add(card%place('bodies'), 'a group of one body', &
                        'name two or more, with commas between them: group '//name//' a,b')
        return
      end if
      leader = huge(1)
      do i = 1, size(names)
        number = word_position(names(i)%text, bodies%name)
        if (number == 0) then
          call errors%add(card%place('bodies'), "there is no body '"//names(i)%text//"'", &
                          suggestion(names(i)%text, word_items(words_joined(bodies%name)), &
                                     'bodies of this deck'))
        else if (bodies(number)%group == name) then
          call errors%add(card%place('bodies'), "body '"//names(i)%text//"' is named twice", &
                          'name it once')
        else if (bodies(number)%group /= '') then
          call errors%add(card%place('bodies'), "body '"//names(i)%text//"' is in two groups: '"// &
                          trim(bodies(number)%group)//"' and '"//name//"'", &
                          'a body has one velocity field: remove it from one of them')
        else
          bodies(number)%group = name
          leader = min(leader, number)
        end if
      end do
      do b = 1, size(bodies)
        if (bodies(b)%group == name) bodies(b)%leader = leader
      end do
    end associate
  end subroutine read_group

  !> What a group cannot be of, and what it may not be meant to be of.
  subroutine check_group(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(string_t), allocatable :: names(:)
    integer :: kinds(2), number, i
    names = word_items(card%word('bodies'))
    kinds = 0
    associate (scene => draft%scene, errors => draft%errors)
      do i = 1, size(names)
        number = word_position(names(i)%text, scene%bodies%name)
        if (number == 0) cycle
        if (scene%bodies(number)%rigid) then
          call errors%add(card%place('bodies'), "body '"//names(i)%text//"' is rigid", &
                          'it has a motion of its own: remove it from the group')
          return
        end if
        if (scene%bodies(number)%material == 0) return
        associate (law => scene%materials(scene%bodies(number)%material)%law)
          associate (kind => kinds(merge(1, 2, law_is_spherical(law))))
            kind = kind + 1
          end associate
        end associate
      end do
      if (all(kinds > 0)) then
        call errors%warn(card%place('bodies'), "group '"//card%word('name')//"' is of gases "// &
                         'or fluids and of solids: they stick together', &
                         'put what flows and what does not in different groups')
      end if
      if (size(scene%contacts) > 0) then
        if (all(scene%bodies%group == card%word('name'))) then
          call errors%add(card%place('bodies'), 'all bodies are in one group: nothing is left '// &
                          'that it could touch', 'leave out those that shall touch the others')
        end if
        return
      end if
      if (kinds(2) > 1) return
      call errors%warn(card%position, "group '"//card%word('name')//"' does nothing: without "// &
                       'contact gases and liquids share the velocity field of all', &
                       'add a card contact, or remove this one')
    end associate
  end subroutine check_group

  !> Number of the body that a card of contact means, the leader where that is a group; 0: all;
  !! negative: an error.
  integer function party(card, key, draft) result(number)
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key
    type(draft_t), intent(inout) :: draft
    number = word_position(card%word(key), draft%scene%bodies%group)
    if (number > 0) return
    number = draft%body_of(card, key)
    if (number <= 0) return
    associate (body => draft%scene%bodies(number))
      if (body%leader == 0) return
      call draft%errors%add(card%place(key), "body '"//trim(body%name)//"' is in group '"// &
                            trim(body%group)//"', which touches others as a whole", &
                            'name the group: '//trim(body%group))
    end associate
    number = -1
  end function party

  subroutine read_contact(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(contact_card_t) :: new
    integer :: i
    new%body(1) = party(card, 'first', draft)
    new%body(2) = party(card, 'second', draft)
    if (any(new%body < 0)) return
    if (new%body(1) == new%body(2) .and. new%body(1) > 0) then
      call draft%errors%add(card%place('second'), 'contact of a '// &
                            trim(merge('group', 'body ', draft%scene%bodies(new%body(1))%leader > &
                                       0))//' with itself', &
                            'name two of them; what shares a velocity field does not touch itself')
      return
    end if
    if (new%body(1) == 0) new%body = new%body([2, 1])
    new%friction = card%number('friction')
    new%lambda = card%number('lambda', absent=new%lambda)
    new%depth = card%number('depth', absent=new%depth)
    new%normal = card%pick('normal', normal_names)
    new%self = card%flag('self')
    do i = 1, size(draft%scene%contacts)
      associate (body => draft%scene%contacts(i)%body)
        if (.not. (all(body == new%body) .or. all(body == new%body([2, 1])))) cycle
      end associate
      call draft%errors%add(card%position, 'there are two cards for this contact', &
                            'remove one of them')
      return
    end do
    draft%scene%contacts = [draft%scene%contacts, new]
  end subroutine read_contact

  subroutine check_contact(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: named(2)
    if (card%flag('self')) then
      call check_self(card, draft)
    else if (lonely(card, draft)) then
      return
    end if
    associate (bodies => draft%scene%bodies)
      named = [word_position(card%word('first'), bodies%name), &
               word_position(card%word('second'), bodies%name)]
      if (any(named == 0)) return
      if (all(bodies(named)%rigid)) then
        call draft%errors%add(card%position, 'contact of two rigid bodies', &
                              'one of them must be able to give way')
      end if
    end associate
  end subroutine check_contact

  !> What cannot touch itself.
  subroutine check_self(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b, named(2)
    logical :: flows
    associate (scene => draft%scene)
      named = [word_position(card%word('first'), scene%bodies%name), &
               word_position(card%word('second'), scene%bodies%name)]
      do b = 1, size(scene%bodies)
        if (.not. any(named == b)) cycle
        if (scene%bodies(b)%material == 0) cycle
        flows = law_is_spherical(scene%materials(scene%bodies(b)%material)%law)
        if (.not. (flows .or. scene%bodies(b)%rigid)) cycle
        call draft%errors%add(card%place('self'), "body '"//trim(scene%bodies(b)%name)//"' "// &
                              trim(merge('is rigid', 'flows   ', scene%bodies(b)%rigid))// &
                              ' and does not touch itself', 'remove self=yes')
        return
      end do
    end associate
  end subroutine check_self

  !> Whether a deck has nothing that could touch, which is an error.
  function lonely(card, draft) result(yes)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    logical :: yes
    yes = size(draft%scene%bodies) < 2
    if (yes) call draft%errors%add(card%position, "'"//card%name//"' in a deck with one body", &
                                      'remove this card, or add the other body')
  end function lonely

  subroutine read_rigid(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b, axis
    b = draft%body_of(card, 'body')
    if (b == 0) call draft%errors%add(card%place('body'), &
                                      'a rigid motion belongs to one body', 'name it')
    if (b <= 0) return
    associate (body => draft%scene%bodies(b), errors => draft%errors)
      if (body%rigid) then
        call errors%add(card%position, "body '"//trim(body%name)//"' is made rigid twice", &
                        'remove one of the cards')
        return
      end if
      body%rigid = .true.
      body%free = card%flag('free')
      body%mass = card%number('mass')
      body%about = card%vector('about')
      body%about_given = card%has('about')
      do axis = 1, 3
        call take_motion(card, draft%axis_key(axis), errors, body%motion(axis))
        call take_motion(card, omega_names(axis), errors, body%omega(axis))
      end do
    end associate
    call check_turning(card, draft)
    call check_freedom(card, draft)
  end subroutine read_rigid

  !> A component of a prescribed motion.
  subroutine take_motion(card, key, errors, motion)
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key
    type(deck_errors_t), intent(inout) :: errors
    type(expression_t), intent(inout) :: motion
    associate (value => card%values(card%at(key)))
      if (value%expression%uses_position .or. value%expression%uses_initial_position) then
        call errors%add(value%position, 'the velocity of a rigid body cannot depend on position', &
                        'use t only')
      end if
      call expression_free(motion)
      motion = expression_clone(value%expression)
    end associate
  end subroutine take_motion

  !> Bodies turn about axes that the scene has.
  subroutine check_turning(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: axis
    logical :: turns
    turns = .false.
    do axis = 1, 3
      associate (value => card%values(card%at(omega_names(axis))))
        if (value%expression%is_constant .and. abs(value%expression%value) <= 0.0_dp) cycle
        turns = .true.
        if (draft%turns_about(axis)) cycle
        call draft%errors%add(value%position, 'nothing turns about '//omega_names(axis)(7:)// &
                              ' '//draft%in_space(), 'remove '//omega_names(axis)// &
                              trim(merge('; omega_z turns in the plane', &
                                         '                            ', draft%turns_about(3))))
      end associate
    end do
    if (card%has('about') .and. .not. turns) then
      call draft%errors%add(card%place('about'), "'about' of a body that does not turn", &
                            'give omega_x, omega_y or omega_z, or remove it')
    end if
  end subroutine check_turning

  !> Forces or a prescription move a body, not both.
  subroutine check_freedom(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: i
    if (.not. card%flag('free')) then
      if (card%has('mass')) call draft%errors%add(card%place('mass'), &
        'the mass of a body whose motion is prescribed means nothing', &
        'write free=yes, or remove it')
      return
    end if
    do i = 1, size(card%keys)
      associate (value => card%values(i))
        if (.not. value%given) cycle
        if (all(card%keys(i)%text /= [character(7) :: 'x', 'y', 'z', 'r', omega_names, &
                                      'about'])) cycle
        call draft%errors%add(value%position, 'a free body with a prescribed '// &
                              trim(merge('point ', 'motion', card%keys(i)%text == 'about')), &
                              'its initial motion is that of the card velocity: remove '// &
                              card%keys(i)%text//', or free=yes')
      end associate
    end do
  end subroutine check_freedom

  !> A rigid body is there to be touched: one for which no card contact is touches all others
  !! without friction.
  subroutine check_rigid(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b
    if (card%flag('free') .and. size(draft%scene%bodies) == 1) return  ! it flies
    if (lonely(card, draft)) return
    b = word_position(card%word('body'), draft%scene%bodies%name)
    if (b == 0) return
    if (is_touched(draft%scene, b) .or. all(draft%scene%bodies%rigid)) return
    draft%scene%contacts = [draft%scene%contacts, contact_card_t(body=[b, 0])]
    call draft%errors%warn(card%position, "no card contact is for the rigid body '"// &
                           card%word('body')//"': it touches all others without friction", &
                           'add the card contact that is meant')
  end subroutine check_rigid

  !> Whether a card contact is for a rigid body: it names it or its group, or others, or all.
  pure function is_touched(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    integer :: c, leader
    yes = .false.
    leader = merge(scene%bodies(b)%leader, b, scene%bodies(b)%leader > 0)
    do c = 1, size(scene%contacts)
      associate (named => scene%contacts(c)%body)
        yes = yes .or. any(named == b) .or. any(named == leader) .or. all(named == 0)
        if (yes .or. all(named > 0)) cycle
        yes = .not. scene%bodies(maxval(named))%rigid  ! which touches all others, but no rigid one
      end associate
    end do
  end function is_touched

end module sgmp_cards_contact
