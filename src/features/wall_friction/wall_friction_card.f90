!> The card `wallfriction`.
module sgmp_wall_friction_card
  use sgmp_cards_grid, only: find_face, find_wall
  use sgmp_deck_card, only: deck_card_t
  use sgmp_keys, only: kind_real, kind_word
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_slip
  use sgmp_registry, only: registry_t
  use sgmp_scene_draft, only: draft_t
  implicit none
  private
  public :: register_wall_friction

contains

  !> Registers the card.
  subroutine register_wall_friction(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('wallfriction', 'A frictional wall: what is pressed against it is '// &
                       'held back along it by up to friction times the force that presses.', &
                       'wallfriction y- friction=0.3', read_friction, check_friction)
    call registry%key('face', kind_word, 'the face of the grid', choices='x- x+ y- y+ z- z+ r+', &
                      slot=1, required=.true.)
    call registry%key('friction', kind_real, "Coulomb's coefficient of friction", &
                      range='[0,inf)', required=.true., source='doc/loads.md')
  end subroutine register_wall_friction

  subroutine read_friction(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: side, axis
    call find_wall(card, draft, side, axis)
    if (axis == 0) return
    associate (friction => draft%scene%features%wall_friction%coefficient(side, axis))
      if (friction > 0.0_dp) then
        call draft%errors%add(card%position, 'the wall on '//card%word('face')//' has two '// &
                              'frictions', 'remove one of the cards')
        return
      end if
      friction = card%number('friction')
      if (friction > 0.0_dp) draft%scene%features%wall_friction%rubs = .true.
    end associate
  end subroutine read_friction

  !> What rubs is a slip wall, along which something can slide.
  subroutine check_friction(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    character(:), allocatable :: face
    integer :: side, axis
    call find_face(card, draft, side, axis)
    if (axis == 0) return
    face = card%word('face')
    associate (scene => draft%scene, errors => draft%errors)
      if (scene%grid%wall(side, axis) /= wall_slip) then
        call errors%add(card%place('face'), 'the wall on '//face//' does not slip', &
                        'write wall '//face//'=slip; at a fixed wall everything sticks')
      end if
    end associate
  end subroutine check_friction

end module sgmp_wall_friction_card
