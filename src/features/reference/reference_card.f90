!> The key `frame` of the card `method`.
module sgmp_reference_card
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_deck_card, only: deck_card_t
  use sgmp_keys, only: kind_word
  use sgmp_registry, only: registry_t
  use sgmp_scene_draft, only: draft_t
  implicit none
  private
  public :: register_reference

contains

  !> Registers the key.
  subroutine register_reference(registry)
    type(registry_t), intent(inout) :: registry
    call registry%extend('method', read_reference, check_reference)
    call registry%key('frame', kind_word, 'reference: particles see the grid from their first '// &
                      'places (total Lagrangian), for solids that keep together: no noise from '// &
                      'cells that are crossed, however far a body turns or flies '// &
                      '(gimp, mpm)', choices='current reference', default='current', &
                      source='doc/reference-frame.md')
  end subroutine register_reference

  subroutine read_reference(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%features%reference = card%word('frame') == 'reference'
  end subroutine read_reference

  !> What the first shape cannot tell; what goes with what is in `sgmp_combinations`.
  subroutine check_reference(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b
    if (card%word('frame') /= 'reference') return
    associate (scene => draft%scene)
      if (scene%features%meeting(1) > 0) call add_meeting(card, scene%features%meeting, draft)
      do b = 1, size(scene%bodies)
        if (scene%bodies(b)%rigid .or. scene%bodies(b)%material == 0) cycle
        if (.not. law_is_spherical(scene%materials(scene%bodies(b)%material)%law)) cycle
        call draft%errors%add(card%place('frame'), "body '"//trim(scene%bodies(b)%name)// &
                              "' flows: its first shape does not say what is near", &
                              'frame=reference is for solids')
      end do
      do b = 1, size(scene%motions)
        if (.not. scene%motions(b)%turns) cycle
        call draft%errors%add(card%place('frame'), 'a card motion turns a part: nodes would '// &
                              'turn about their first places', 'move that part along a line, '// &
                              'or leave out frame=reference')
      end do
    end associate
  end subroutine check_reference

  !> Two bodies that are not one piece.
  subroutine add_meeting(card, pair, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: pair(2)
    type(draft_t), intent(inout) :: draft
    call draft%errors%add(card%place('frame'), "bodies '"// &
                          trim(draft%scene%bodies(pair(1))%name)//"' and '"// &
                          trim(draft%scene%bodies(pair(2))%name)//"' are not one piece: their "// &
                          'first shapes do not meet, and nothing would keep them apart', &
                          'compute them one by one, or leave out frame=reference')
  end subroutine add_meeting

end module sgmp_reference_card
