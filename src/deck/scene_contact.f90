!> The cards `contact` and `rigid`: names to bodies, and what must hold between them.
module sgmp_scene_contact
  use sgmp_cards, only: deck_card_t
  use sgmp_contact_pairs, only: normal_words
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_expression, only: expression_clone, expression_free
  use sgmp_scene, only: contact_card_t, scene_t
  use sgmp_spelling, only: string_t, suggestion, word_in_list
  implicit none
  private
  public :: add_contact, set_rigid, check_contact

contains

  !> Adds the contact of a card `contact`.
  subroutine add_contact(card, scene, names, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(string_t), intent(in) :: names(:)          !! of all bodies
    type(deck_errors_t), intent(inout) :: errors
    type(contact_card_t) :: new
    integer :: i
    new%body(1) = body_named(card, 'first', names, errors)
    new%body(2) = body_named(card, 'second', names, errors)
    if (any(new%body < 0)) return
    if (new%body(1) == new%body(2) .and. new%body(1) > 0) then
      call errors%add(card%values(card%at('second'))%position, 'contact of a body with itself', &
                      'name two bodies; a body does not touch itself')
      return
    end if
    if (new%body(1) == 0) new%body = new%body([2, 1])
    new%friction = card%number('friction')
    new%lambda = card%number('lambda', absent=new%lambda)
    new%depth = card%number('depth', absent=new%depth)
    new%normal = word_in_list(card%word('normal'), normal_words)
    do i = 1, size(scene%contacts)
      associate (body => scene%contacts(i)%body)
        if (.not. (all(body == new%body) .or. all(body == new%body([2, 1])))) cycle
      end associate
      call errors%add(card%position, 'there are two cards for this contact', 'remove one of them')
      return
    end do
    scene%contacts = [scene%contacts, new]
  end subroutine add_contact

  !> Makes a body rigid.
  subroutine set_rigid(card, scene, names, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(string_t), intent(in) :: names(:)
    type(deck_errors_t), intent(inout) :: errors
    integer :: b, k
    b = body_named(card, 'body', names, errors)
    if (b == 0) call errors%add(card%values(card%at('body'))%position, &
      'a rigid motion belongs to one body', 'name it')
    if (b <= 0) return
    if (scene%bodies(b)%rigid) then
      call errors%add(card%position, "body '"//names(b)%text//"' is made rigid twice", &
        'remove one of the cards')
      return
    end if
    scene%bodies(b)%rigid = .true.
    do k = 1, 3
      associate (value => card%values(card%at('xyz' (k:k))))
        if (value%expression%uses_position .or. value%expression%uses_initial_position) then
          call errors%add(value%position, &
            'the velocity of a rigid body cannot depend on position', 'use t only')
        end if
        call expression_free(scene%bodies(b)%motion(k))
        scene%bodies(b)%motion(k) = expression_clone(value%expression)
      end associate
    end do
  end subroutine set_rigid

  !> What must hold between contacts and bodies; called for the cards `contact` and `rigid`.
  subroutine check_contact(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: b, c
    if (size(scene%bodies) < 2) then
      call errors%add(card%position, "'"//card%name//"' in a deck with one body", &
        'remove this card, or add the other body')
      return
    end if
    if (card%name == 'contact') then
      do c = 1, size(scene%contacts)
        if (any(scene%contacts(c)%body == 0)) cycle
        if (card%word('first') /= scene%bodies(scene%contacts(c)%body(1))%name) cycle
        if (card%word('second') /= scene%bodies(scene%contacts(c)%body(2))%name) cycle
        if (all(scene%bodies(scene%contacts(c)%body)%rigid)) then
          call errors%add(card%position, 'contact of two rigid bodies', &
            'one of them must be able to give way')
        end if
      end do
    else
      do b = 1, size(scene%bodies)
        if (scene%bodies(b)%name /= card%word('body')) cycle
        do c = 1, size(scene%contacts)
          if (any(scene%contacts(c)%body == b) .or. any(scene%contacts(c)%body == 0)) return
        end do
        call errors%warn(card%position, "nothing touches the rigid body '"// &
          trim(scene%bodies(b)%name)//"'", &
                         'add a card contact')
      end do
    end if
  end subroutine check_contact

  !> Number of the body that a key names, 0 for all, negative and an error where there is none.
  integer function body_named(card, key, names, errors) result(number)
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key
    type(string_t), intent(in) :: names(:)
    type(deck_errors_t), intent(inout) :: errors
    number = 0
    if (card%word(key) == 'all') return
    do number = 1, size(names)
      if (names(number)%text == card%word(key)) return
    end do
    number = -1
    call errors%add(card%values(card%at(key))%position, "there is no body '"//card%word(key)//"'", &
                    suggestion(card%word(key), names, 'bodies of this deck'))
  end function body_named

end module sgmp_scene_contact
