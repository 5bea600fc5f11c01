!> The card `remove`: a body that has done its work is taken out of the scene.
module sgmp_removal_card
  use sgmp_deck_card, only: deck_card_t
  use sgmp_keys, only: kind_name_word, kind_real
  use sgmp_kinds, only: dp
  use sgmp_registry, only: registry_t
  use sgmp_scene_draft, only: draft_t
  implicit none
  private
  public :: register_removal

contains

  !> Registers the card.
  subroutine register_removal(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('remove', 'Takes a body out of the scene at a time: gas whose pulse is '// &
                       'over, so that a plate can ring on alone at its own time step. Its '// &
                       'mass, momentum and energy are booked in history.csv and summary.json.', &
                       'remove air time=2', read_remove, check_remove)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call registry%key('time', kind_real, 'its particles go in the first step that begins then', &
                      required=.true., unit='time', range='(0,inf)', source='doc/loads.md')
  end subroutine register_removal

  subroutine read_remove(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b
    b = draft%body_of(card, 'body')
    if (b == 0) call draft%errors%add(card%place('body'), 'a card removes one body', &
                                      'name it; write a card for each')
    if (b <= 0) return
    associate (body => draft%scene%bodies(b))
      if (body%removed_at < huge(1.0_dp)) then
        call draft%errors%add(card%position, "body '"//trim(body%name)//"' has two cards remove", &
                              'remove one of the cards')
      end if
      body%removed_at = card%number('time')
    end associate
  end subroutine read_remove

  !> What can be removed. What goes takes its internal energy along, which particles without an
  !! equation of state keep for that alone.
  subroutine check_remove(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b, first
    b = draft%body_of(card, 'body')
    if (b <= 0) return
    associate (scene => draft%scene, errors => draft%errors)
      first = findloc(scene%bodies%rigid, .false., 1)
      if (scene%bodies(b)%rigid) then
        call errors%add(card%place('body'), "body '"//card%word('body')//"' is rigid", &
                        'rigid bodies stay; let it move out of the way by its card rigid')
      end if
      if (any(scene%motions%body == b)) then
        call errors%add(card%place('body'), "parts of body '"//card%word('body')//"' are moved "// &
                        'by a card motion', 'remove one of the cards')
      end if
      if (b == first .and. all(scene%bodies%removed_at < huge(1.0_dp) .or. scene%bodies%rigid)) then
        call errors%add(card%position, 'nothing that can be strained would be left', &
                        'end the run at that time instead')
      end if
      if (scene%bodies(b)%material == 0) return  ! an unknown material, which was said
      scene%materials(scene%bodies(b)%material)%law%history%energy = .true.
    end associate
  end subroutine check_remove

end module sgmp_removal_card
