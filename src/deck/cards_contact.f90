!> The cards `contact` and `rigid`: names to bodies, and what must hold between them.
module sgmp_cards_contact
  use sgmp_contact_pairs, only: normal_names, normal_separating
  use sgmp_deck_card, only: deck_card_t
  use sgmp_expression, only: expression_clone, expression_free
  use sgmp_keys, only: kind_expression, kind_name_word, kind_real, kind_word
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: contact_card_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_space, only: axis_names, space_axisymmetric
  use sgmp_spelling, only: word_position, words_joined
  implicit none
  private
  public :: register_contact

contains

  !> Registers the cards of this group.
  subroutine register_contact(registry)
    type(registry_t), intent(inout) :: registry
    integer :: axis
    call registry%card('contact', 'Lets bodies touch, slide and separate; without it they '// &
                       'stick together where they meet. Names two bodies, one (with all '// &
                       'others) or all; the card that names more counts.', &
                       'contact ball plate friction=0.4', read_contact, check_contact)
    call registry%key('first', kind_name_word, 'a body, or all', default='all', slot=1)
    call registry%key('second', kind_name_word, 'another body; default: all others', &
                      default='all', slot=2)
    call registry%key('friction', kind_real, "Coulomb's coefficient of friction", &
                      range='[0,inf)', default='0', source='Eqs. 81 to 84')
    call registry%key('lambda', kind_real, 'bodies touch where their particles are closer than '// &
                      'this many cells along the normal; default: the mean of their spacings', &
                      range='(0,inf)', source='Eq. 86')
    call registry%key('depth', kind_real, 'contact acts at nodes no further than this many '// &
                      'cells from where the surfaces touch; default: at all shared nodes', &
                      range='[0.5,inf)', source='doc/contact.md')
    call registry%key('normal', kind_word, 'common normal: along the shortest line between the '// &
                      "bodies' particles around a node, or from the gradient of volume of "// &
                      'both bodies, of one, or of the stiffer', &
                      choices=words_joined(normal_names), &
                      default=trim(normal_names(normal_separating)), source='Eqs. 87 and 88')
    call registry%card('rigid', 'Gives a body a prescribed velocity and infinite mass.', &
                       'rigid punch y="-v0*sin(pi*t)"', read_rigid, check_rigid)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    do axis = 1, 3
      call registry%key(axis_names(axis, 3), kind_expression, 'velocity, a function of t', &
                        unit='speed', default='0')
    end do
    call registry%key(axis_names(1, space_axisymmetric), kind_expression, 'velocity along r of '// &
                      'an axisymmetric scene', unit='speed')
  end subroutine register_contact

  subroutine read_contact(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(contact_card_t) :: new
    integer :: i
    new%body(1) = draft%body_of(card, 'first')
    new%body(2) = draft%body_of(card, 'second')
    if (any(new%body < 0)) return
    if (new%body(1) == new%body(2) .and. new%body(1) > 0) then
      call draft%errors%add(card%place('second'), 'contact of a body with itself', &
                            'name two bodies; a body does not touch itself')
      return
    end if
    if (new%body(1) == 0) new%body = new%body([2, 1])
    new%friction = card%number('friction')
    new%lambda = card%number('lambda', absent=new%lambda)
    new%depth = card%number('depth', absent=new%depth)
    new%normal = card%pick('normal', normal_names)
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
    if (lonely(card, draft)) return
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
      do axis = 1, 3
        associate (value => card%values(card%at(draft%axis_key(axis))))
          if (value%expression%uses_position .or. value%expression%uses_initial_position) then
            call errors%add(value%position, &
                            'the velocity of a rigid body cannot depend on position', 'use t only')
          end if
          call expression_free(body%motion(axis))
          body%motion(axis) = expression_clone(value%expression)
        end associate
      end do
    end associate
  end subroutine read_rigid

  !> A rigid body is there to be touched.
  subroutine check_rigid(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b, c
    if (lonely(card, draft)) return
    b = word_position(card%word('body'), draft%scene%bodies%name)
    if (b == 0) return
    do c = 1, size(draft%scene%contacts)
      if (any(draft%scene%contacts(c)%body == b) .or. &
          any(draft%scene%contacts(c)%body == 0)) return
    end do
    call draft%errors%warn(card%position, "nothing touches the rigid body '"// &
                           card%word('body')//"'", 'add a card contact')
  end subroutine check_rigid

end module sgmp_cards_contact
