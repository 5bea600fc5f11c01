!> The cards `deck_version`, `title`, `units`, `dimension` and `table`.
module sgmp_cards_general
  use sgmp_deck_card, only: deck_card_t
  use sgmp_keys, only: kind_integer, kind_logical, kind_name_word, kind_points, kind_text, kind_word
  use sgmp_kinds, only: dp
  use sgmp_registry, only: read_first, registry_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_spelling, only: words_joined
  use sgmp_units, only: length_units, mass_units, time_units
  implicit none
  private
  public :: register_general

  integer, parameter :: language_version = 1  !! of decks

contains

  !> Registers the cards of this group.
  subroutine register_general(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('deck_version', 'The version of the deck language in which the deck is '// &
                       'written. The language is stable: within a version words are added and '// &
                       'keep their meaning, and a word that is replaced goes on with a warning.', &
                       'deck_version 1', check=check_version, once=.true., free=.true.)
    call registry%key('number', kind_integer, 'version; a deck of a later one is refused', slot=1, &
                      default='1', range='[1,inf)')
    call registry%card('title', 'What the run is called in its output.', 'title "Taylor bar"', &
                       read_title, once=.true., free=.true.)
    call registry%key('text', kind_text, 'the title', slot=1, required=.true.)
    call registry%card('units', "Units of the deck's numbers; labels the output and enables "// &
                       'checks of orders of magnitude. The numbers must be consistent: force '// &
                       'in mass*length/time^2, stress in mass/(length*time^2).', 'units mm g ms', &
                       read_units, once=.true.)
    call registry%key('length', kind_word, 'unit of length', choices=words_joined(length_units), &
                      slot=1, required=.true.)
    call registry%key('mass', kind_word, 'unit of mass', choices=words_joined(mass_units), &
                      slot=2, required=.true.)
    call registry%key('time', kind_word, 'unit of time', choices=words_joined(time_units), &
                      slot=3, required=.true.)
    call registry%key('scope', kind_word, 'file: these are the units of the file alone in '// &
                      'which the card stands, and its materials are converted to the units of '// &
                      'the deck that includes it (input/materials)', choices='deck file', &
                      default='deck', free=.true.)
    call registry%card('dimension', '1: uniaxial strain along x; 2: plane strain, per unit '// &
                       'thickness; 3; axisymmetric: a body of revolution by its half-plane, '// &
                       'with axes r and z in the place of x, y and z, vectors (r,z), and '// &
                       'particles that are whole rings; stands before all cards but title '// &
                       'and units.', &
                       'dimension axisymmetric', read_dimension, once=.true., &
                       turn=read_first)
    call registry%key('value', kind_integer, 'number of dimensions', default='3', range='[1,3]', &
                      choices='axisymmetric', slot=1, source='doc/theory.md, 7')
    call registry%key('swirl', kind_logical, 'axisymmetric: a velocity around the axis, for '// &
                      'what spins or is twisted (sgmp)', default='no', &
                      source='doc/theory.md, 8')
    call registry%card('table', 'A function that formulas call by its name, with t or any '// &
                       'other argument: linear between its rows, constant before the first '// &
                       'and behind the last. Stands before the formulas that use it.', &
                       'table pull file="pull.csv"')
    call registry%key('name', kind_name_word, 'name of the function: "v0*pull(t)"', slot=1, &
                      required=.true.)
    call registry%key('file', kind_text, 'rows t, value in the units of the deck, t growing '// &
                      'from row to row; # and ! begin comments, the first line may name the '// &
                      'columns; a relative path starts at the deck')
    call registry%key('rows', kind_points, 'the rows themselves instead of a file: (t,value),...')
    call registry%key('checksum', kind_text, 'of the rows of the file, as the complete deck in '// &
                      'run.log says it: rows with another one are refused')
  end subroutine register_general

  !> A deck of a later version may say what this program would misunderstand.
  subroutine check_version(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    if (card%whole('number') <= language_version) return
    call draft%errors%add(card%place('number'), 'the deck is of a later version of the deck '// &
                          'language than this sgmp knows', 'take a newer sgmp, or write '// &
                          'deck_version 1 and see what is not understood')
  end subroutine check_version

  subroutine read_title(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%title = card%word('text')
  end subroutine read_title

  subroutine read_units(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%units = [character(8) :: card%word('length'), card%word('mass'), card%word('time')]
  end subroutine read_units

  subroutine read_dimension(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%dimension = 1  ! checks the least where the card is wrong
    if (card%failed) return
    draft%scene%axisymmetric = card%word('value') == 'axisymmetric'
    draft%scene%dimension = merge(2, card%whole('value'), draft%scene%axisymmetric)
    draft%scene%swirl = card%flag('swirl')
  end subroutine read_dimension

end module sgmp_cards_general
