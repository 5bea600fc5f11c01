!> The card `section`: a plane through which forces are measured.
module sgmp_section_card
  use sgmp_deck_card, only: deck_card_t
  use sgmp_keys, only: kind_name_word, kind_real, kind_vector
  use sgmp_kinds, only: dp
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: section_card_t
  use sgmp_scene_draft, only: draft_t, named_sections
  implicit none
  private
  public :: register_section

contains

  !> Registers the card.
  subroutine register_section(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('section', 'Force and moment through a plane, in sections.csv: what the '// &
                       'matter on the side of the normal does to the other; tension is along '// &
                       'the normal.', 'section waist point=(0,0,5) normal=(0,0,1)', read_section, &
                       check_section)
    call registry%key('name', kind_name_word, 'name in sections.csv', slot=1, required=.true.)
    call registry%key('point', kind_vector, 'a point of the plane, which stays where it is', &
                      unit='length', required=.true.)
    call registry%key('normal', kind_vector, 'its normal, of any length; axisymmetric: along z', &
                      required=.true.)
    call registry%key('body', kind_name_word, 'the body that is cut; default: all', default='all')
    call registry%key('width', kind_real, 'particles count that are nearer to the plane than '// &
                      'this, less the farther they are; the plane should be farther from '// &
                      'ends of the body; default: a cell', unit='length', range='(0,inf)', &
                      source='doc/loads.md')
  end subroutine register_section

  subroutine read_section(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(section_card_t) :: new
    if (.not. draft%new_name(card, named_sections)) return
    new%name = card%word('name')
    new%point = card%vector('point')
    new%normal = card%vector('normal')
    new%body = draft%body_of(card, 'body')
    new%width = draft%scene%grid%cell
    if (card%has('width')) new%width = card%number('width')
    draft%scene%sections = [draft%scene%sections, new]
  end subroutine read_section

  !> A plane has a normal; a ring's forces across the axis have no resultant.
  subroutine check_section(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    real(dp) :: normal(3), beyond
    normal = card%vector('normal')
    if (norm2(normal) <= 0.0_dp) then
      call draft%errors%add(card%place('normal'), 'the normal has no direction', &
                            'e.g. normal=(1,0,0)')
      return
    end if
    beyond = norm2(normal(draft%scene%dimension + 1:))
    if (draft%scene%axisymmetric) beyond = max(beyond, abs(normal(1)))
    if (beyond > 0.0_dp) then
      call draft%errors%add(card%place('normal'), 'there is no such plane '//draft%in_space(), &
                            merge('take normal=(0,1)  ', 'leave it to x and y', &
                                  draft%scene%axisymmetric))
    end if
  end subroutine check_section

end module sgmp_section_card
