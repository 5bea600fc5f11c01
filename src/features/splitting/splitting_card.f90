!> Keys of the card `method` for splitting.
module sgmp_splitting_card
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_keys, only: kind_integer, kind_real
  use sgmp_kinds, only: dp
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: scene_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_text, only: real_text
  implicit none
  private
  public :: register_splitting

contains

  !> Registers the keys.
  subroutine register_splitting(registry)
    type(registry_t), intent(inout) :: registry
    call registry%extend('method', read_splitting, check_splitting)
    call registry%key('split', kind_real, 'particles whose longest side is stretched beyond so '// &
                      'many cells are split in two along it, fluids by their volume; 0.75 '// &
                      'leaves no gaps; auto: those of gas and explosives alone, 1 where '// &
                      'nothing else moves in a box of walls, else 0.75 and a few times '// &
                      'only, and so those of solids that touch in a scene faster than a '// &
                      'tenth of their speed of sound', &
                      range='[0.25,2]', choices='auto none', &
                      default='auto', source='doc/volumes.md, 5')
    call registry%key('split_most', kind_integer, 'more particles than these after splitting '// &
                      'end the run; default: 1e7, none where auto splits a few times only', &
                      range='[1,inf)')
  end subroutine register_splitting

  subroutine read_splitting(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    associate (splitting => draft%scene%features%splitting)
      splitting%automatic = card%word('split') == 'auto'
      if (all(card%word('split') /= ['auto', 'none'])) splitting%limit = card%number('split')
      splitting%most = card%whole('split_most', absent=0)
    end associate
  end subroutine read_splitting

  !> Numbers that depend on other cards; what goes with what is in `sgmp_combinations`.
  subroutine check_splitting(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    associate (splitting => draft%scene%features%splitting, &
               limit => draft%scene%features%splitting%limit, errors => draft%errors)
      if (limit > 0.0_dp .and. .not. splitting%automatic .and. &
          draft%scene%grid%cell > 0.0_dp) then
        call check_sides(card, draft%scene, limit, errors)
      end if
      if (card%has('split_most') .and. .not. limit > 0.0_dp) then
        call errors%add(card%place('split_most'), 'split_most bounds what split makes of the '// &
                        'particles, and none is split', 'add split=0.75 or remove split_most')
      end if
    end associate
  end subroutine check_splitting

  !> Particles that would be split at once.
  subroutine check_sides(card, scene, limit, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    real(dp), intent(in) :: limit
    type(deck_errors_t), intent(inout) :: errors
    real(dp) :: spacing
    integer :: b
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%rigid) cycle
      spacing = scene%bodies(b)%spacing/scene%grid%cell
      if (spacing <= limit) cycle
      call errors%add(card%place('split'), "particles of body '"//trim(scene%bodies(b)%name)// &
                      "' have sides of "//real_text(spacing)//' cells at the start', &
                      'use more of them, or a larger split')
    end do
  end subroutine check_sides

end module sgmp_splitting_card
