!> Reads a deck: text -> statements -> cards -> scene, with every error of the deck found in one go.
module sgmp_deck
  use sgmp_body_fit, only: body_fit_settle
  use sgmp_card_parse, only: card_default, card_parse
  use sgmp_combinations, only: combinations_bodies, combinations_check, combinations_choose, &
                               combinations_parts, combinations_walls
  use sgmp_deck_card, only: card_free, deck_card_t, value_t
  use sgmp_deck_echo, only: deck_echo, deck_fixed
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_deck_table, only: deck_table
  use sgmp_default_contact, only: default_contact_settle, solids_flow, solids_side
  use sgmp_edge_pressure, only: edge_pressure_settle
  use sgmp_edge_sources, only: edge_sources_settle
  use sgmp_enclosed_gas, only: gas_alone, gas_burns, gas_in_gas, gas_may_part, &
                               gas_on_rigid, gas_sides
  use sgmp_fast_scenes, only: fast_scene_settle, liquid_thrown
  use sgmp_features, only: features_split_gas, features_split_solids
  use sgmp_file_units, only: convert_files
  use sgmp_graded_bodies, only: graded_bodies_settle
  use sgmp_keys, only: key_t, kind_expression, kind_interval, kind_vector
  use sgmp_kinds, only: dp
  use sgmp_lexer, only: lexer_read, statement_t
  use sgmp_mesh, only: wall_free, wall_names
  use sgmp_parameters, only: parameters_t
  use sgmp_particle_number, only: particle_number_settle
  use sgmp_registry, only: read_first, read_last, read_second, read_third, registry_t
  use sgmp_rolling, only: scene_rolls, scene_weighs
  use sgmp_scene, only: alternatives_t, scene_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_spelling, only: string_t, suggestion, word_items, word_lower
  use sgmp_tables, only: table_define
  use sgmp_units, only: units_check
  use sgmp_walls_apart, only: walls_apart_from_rubbing, walls_apart_settle
  implicit none
  private
  public :: deck_read

  !> Courant number above which a deck that gives one by hand has lumped masses: with a consistent
  !! one steps are stable up to 1.1 with one particle per cell, 1.8 with two (doc/mass.md).
  real(dp), parameter :: consistent_cfl = 0.8_dp

contains

  !> Reads and validates a deck. Where `errors%count()` is positive the scene is incomplete: do not
  !! run it.
  subroutine deck_read(path, settings, scene, errors)
    character(*), intent(in) :: path         !! file
    character(*), intent(in) :: settings(:)  !! `NAME=VALUE` from the command line
    type(scene_t), intent(out) :: scene      !! to be released with `scene_free`
    type(deck_errors_t), intent(out) :: errors
    type(draft_t) :: draft
    draft%scene%file = path
    draft%scene%title = path
    call read_file(path, settings, draft)
    scene = draft%scene
    errors = draft%errors
    scene%warnings = errors%warning_lines()
  end subroutine deck_read

  !> Statements, then cards, then the scene.
  subroutine read_file(path, settings, draft)
    character(*), intent(in) :: path
    character(*), intent(in) :: settings(:)
    type(draft_t), intent(inout) :: draft
    type(registry_t) :: registry
    type(statement_t), allocatable :: statements(:)
    type(parameters_t) :: parameters
    type(deck_card_t), allocatable :: cards(:), found(:)
    type(position_t) :: deck
    logical :: complete, rings
    integer :: i, n
    registry = deck_table()
    deck%file = path
    call lexer_read(path, statements, complete, draft%errors)
    if (size(statements) == 0) return
    if (foreign(statements(1), draft%errors)) return
    call parameters%start(settings, draft%errors)
    allocate (found(size(statements)))
    n = 0
    rings = names_radius(statements)
    do i = 1, size(statements)
      call read_statement(registry, statements(i), rings, parameters, found, n, draft%errors)
    end do
    cards = found(:n)
    call convert_files(registry, cards, draft%errors)
    call parameters%check_use(draft%errors)
    call check_repeated(registry, cards, draft%errors)
    if (complete) call check_needed(registry, cards, deck, draft%errors)
    call add_default_cards(registry, deck, parameters, cards, draft%errors)
    call read_cards(registry, cards, draft)
    call combinations_check(cards, draft%errors)
    call default_contact_settle(draft%scene)
    call settle_method(cards, draft%errors%count() == 0, draft%scene)
    call fast_scene_settle(draft%scene)
    call particle_number_settle(draft%scene)
    call body_fit_settle(draft%scene)
    call settle_halves(cards, draft%scene)
    draft%scene%allows = alternatives(cards)
    call check_cards(registry, cards, draft)
    if (draft%errors%count() == 0) then
      call walls_apart_settle(draft%scene)
      call edge_sources_settle(draft%scene)
      call edge_pressure_settle(draft%scene)
    end if
    call graded_bodies_settle(draft%scene%grid, draft%scene%bodies)
    call drop_overridden(cards)
    if (draft%errors%count() == 0) then
      draft%scene%resolved = deck_echo(registry, parameters, cards)
      call deck_fixed(registry, parameters, cards, draft%scene%fixed)
    end if
    do i = 1, size(cards)
      call card_free(cards(i))
    end do
  end subroutine read_file

  !> Whether a file is a deck of another program, which its first word tells; that is then the only
  !! error.
  function foreign(first, errors) result(yes)
    type(statement_t), intent(in) :: first
    type(deck_errors_t), intent(inout) :: errors
    logical :: yes
    type(deck_errors_t) :: only
    character(:), allocatable :: language, remedy
    associate (keyword => first%tokens(1))
      language = ''
      if (index(word_lower(keyword%text), 'mpm3') == 1) language = 'MPM3D'
      remedy = 'give it a name that ends in .mpm: sgmp X.mpm runs it, sgmp import X.mpm rewrites it'
      if (index(keyword%text, '*') == 1) then
        language = 'LS-DYNA'
        remedy = 'write it anew; see doc/deck-reference.md or sgmp help'
      end if
      yes = language /= ''
      if (.not. yes) return
      call only%add(keyword%position, 'this is a deck of '//language//', not of sgmp', remedy)
      errors = only
    end associate
  end function foreign

  !> What the method leaves to the program: the best there is, where it goes with the rest of the
  !! deck (doc/surfaces.md, 1).
  subroutine settle_method(cards, faultless, scene)
    type(deck_card_t), intent(in) :: cards(:)
    logical, intent(in) :: faultless
    type(scene_t), intent(inout) :: scene
    associate (method => scene%method)
      if (method%surfaces_auto) method%surfaces = combinations_choose(cards, 'surfaces')
      if (method%rotation_auto) then
        method%rotation = combinations_choose(cards, 'rotation', &
                                              beside=rubbing(scene, faultless))
      end if
      if (method%consistent_auto) then
        method%consistent = combinations_choose(cards, 'consistent') .and. &
                            .not. scene%time%dt > 0.0_dp .and. &
                            scene%time%cfl <= consistent_cfl .and. size(scene%contacts) == 0
      end if
      if (method%normalised_auto) method%normalised = combinations_choose(cards, 'normalised')
      if (method%drift_auto) then
        method%drift_remapped = method%normalised .and. combinations_choose(cards, 'drift')
      end if
      if (method%volumes_auto) call settle_volumes(cards, scene)
      if (method%volumes_kept) then
        method%normalised = .true.
        method%normalised_auto = .false.
      end if
    end associate
  end subroutine settle_method

  !> Friction beside which rotation is exact: that of bodies and of walls that let go, where a stiff
  !! block would not topple without it, for the grid strains what turns; any, where something rolls.
  function rubbing(scene, faultless) result(words)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: faultless
    character(:), allocatable :: words
    words = ''
    if (scene_rolls(scene)) then
      words = combinations_bodies//' '//combinations_walls
      return
    end if
    if (scene_weighs(scene)) words = combinations_bodies
    if (.not. faultless) return
    if (walls_apart_from_rubbing(scene)) words = words//' '//combinations_walls
  end function rubbing

  !> Which particles are split, where the deck leaves it open.
  subroutine settle_halves(cards, scene)
    type(deck_card_t), intent(in) :: cards(:)
    type(scene_t), intent(inout) :: scene
    if (.not. combinations_parts(cards)) return
    if (scene%method%volumes_auto .and. combinations_choose(cards, 'kept') .and. &
        gas_may_part(scene)) then
      call features_split_gas(scene%features, scene%dimension, gas_sides(scene), gas_alone(scene))
    end if
    if (solids_flow(scene)) then
      call features_split_solids(scene%features, scene%dimension, solids_side(scene))
    end if
  end subroutine settle_halves

  !> Whether volumes are kept.
  subroutine settle_volumes(cards, scene)
    type(deck_card_t), intent(in) :: cards(:)
    type(scene_t), intent(inout) :: scene
    logical :: gas_free                            !! the deck leaves open what becomes of gas
    gas_free = combinations_choose(cards, 'kept')
    scene%method%volumes_kept = gas_free .and. (gas_alone(scene) .or. gas_burns(scene) .or. &
                                       gas_in_gas(scene) .or. gas_on_rigid(scene) .or. &
                                       liquid_thrown(scene))
  end subroutine settle_volumes

  !> What else would go with the deck.
  function alternatives(cards) result(allows)
    type(deck_card_t), intent(in) :: cards(:)
    type(alternatives_t) :: allows
    allows%graded = combinations_choose(cards, 'graded')
    allows%axisymmetric = combinations_choose(cards, 'axisymmetric')
    allows%dimension(1) = combinations_choose(cards, '1D')
    allows%dimension(2) = combinations_choose(cards, '2D')
    allows%dimension(3) = .true.
  end function alternatives

  !> Cards that may appear once only.
  subroutine check_repeated(registry, cards, errors)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    integer :: i, k
    do i = 1, size(cards)
      if (.not. registry%cards(cards(i)%definition)%once) cycle
      do k = 1, i - 1
        if (cards(k)%definition /= cards(i)%definition) cycle
        call errors%add(cards(i)%position, "card '"//cards(i)%name//"' is given twice", &
                        'first given at '//cards(k)%position%text()//'; write all of its '// &
                        'keys in one card')
        exit
      end do
    end do
  end subroutine check_repeated

  !> Cards without which there is nothing to compute.
  subroutine check_needed(registry, cards, deck, errors)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: cards(:)
    type(position_t), intent(in) :: deck         !! the file as a whole
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    do i = 1, size(registry%cards)
      if (registry%cards(i)%needed == '' .or. any(cards%definition == i)) cycle
      call errors%add(deck, "the deck has no card '"//registry%cards(i)%name//"'", &
                      registry%cards(i)%needed)
    end do
  end subroutine check_needed

  !> Fills the scene: what others refer to first, otherwise in the order of the deck.
  subroutine read_cards(registry, cards, draft)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: cards(:)
    type(draft_t), intent(inout) :: draft
    integer :: i, turn
    associate (scene => draft%scene)
      allocate (scene%contacts(0), scene%materials(0), scene%bodyforces(0), scene%detonations(0), &
                scene%sections(0), scene%loads(0), scene%motions(0), scene%output%fields(0))
      allocate (scene%bodies(count(registry%cards(cards%definition)%turn == read_second)))
      allocate (scene%gauges(count([(cards(i)%name == 'gauge', i=1, size(cards))])))
    end associate
    do turn = read_first, read_last
      do i = 1, size(cards)
        associate (definition => registry%cards(cards(i)%definition))
          if (definition%turn /= turn) cycle
          if (turn >= read_third .and. cards(i)%failed) cycle
          call definition%do_read(cards(i), draft)
        end associate
      end do
      if (turn == read_second) draft%scene%bodies = draft%scene%bodies(:draft%bodies)
    end do
    draft%scene%gauges = draft%scene%gauges(:draft%gauges)
  end subroutine read_cards

  !> Relations between cards, and orders of magnitude; cards that failed are left alone.
  subroutine check_cards(registry, cards, draft)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: cards(:)
    type(draft_t), intent(inout) :: draft
    integer :: i
    do i = 1, size(cards)
      if (cards(i)%failed) cycle
      associate (definition => registry%cards(cards(i)%definition))
        call check_plane(definition%keys, cards(i), draft)
        call definition%do_check(cards(i), draft)
        if (draft%scene%units(1) == '') cycle
        call units_check(definition%keys, cards(i), draft%scene%units, draft%errors)
      end associate
    end do
  end subroutine check_cards

  !> Parameters are defined as they come; everything else becomes a card.
  subroutine read_statement(registry, statement, rings, parameters, cards, n, errors)
    type(registry_t), intent(in) :: registry
    type(statement_t), intent(in) :: statement
    logical, intent(in) :: rings             !! the deck says dimension axisymmetric somewhere
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), intent(inout) :: cards(:)
    integer, intent(inout) :: n              !! cards so far
    type(deck_errors_t), intent(inout) :: errors
    integer :: number
    associate (keyword => statement%tokens(1))
      if (word_lower(keyword%text) == 'parameter') then
        call define_parameters(statement, parameters, errors)
        return
      end if
      number = registry%find_card(word_lower(keyword%text))
      if (number == 0 .and. begins_with_key(statement)) then
        call errors%add(keyword%position, "unknown card '"//keyword%text//"'", &
                        'a line goes on where the one before it ends with &')
        return
      end if
      if (number == 0) then
        call errors%add(keyword%position, "unknown card '"//keyword%text//"'", &
                        suggestion(keyword%text, known_keywords(registry), 'cards'))
        return
      end if
    end associate
    n = n + 1
    if (rings .and. .not. is_plain(registry%cards(number)%name)) parameters%axisymmetric = .true.
    call card_parse(registry%cards(number), number, statement, parameters, cards(n), errors)
    if (cards(n)%name == 'dimension') call choose_variables(cards(:n), parameters, errors)
    if (cards(n)%name == 'table') call table_define(cards(n), parameters, errors)
  end subroutine read_statement

  !> Whether a statement has the form of a card's end.
  pure function begins_with_key(statement) result(yes)
    type(statement_t), intent(in) :: statement
    logical :: yes
    yes = size(statement%tokens) > 1
    if (yes) yes = statement%tokens(2)%equals
  end function begins_with_key

  !> Whether a card is read alike in all spaces.
  pure logical function is_plain(name) result(yes)
    character(*), intent(in) :: name
    yes = any(name == [character(12) :: 'deck_version', 'title', 'units', 'table'])
  end function is_plain

  !> Whether a statement says `dimension axisymmetric`.
  pure logical function names_radius(statements) result(yes)
    type(statement_t), intent(in) :: statements(:)
    integer :: i
    yes = .false.
    do i = 1, size(statements)
      associate (tokens => statements(i)%tokens)
        if (size(tokens) < 2) cycle
        yes = yes .or. (word_lower(tokens(1)%text) == 'dimension' .and. &
                        word_lower(tokens(2)%text) == 'axisymmetric')
      end associate
    end do
  end function names_radius

  !> From here on formulas are functions of r and z, if the last card says so.
  subroutine choose_variables(cards, parameters, errors)
    type(deck_card_t), intent(in) :: cards(:)
    type(parameters_t), intent(inout) :: parameters
    type(deck_errors_t), intent(inout) :: errors
    logical :: known                         !! before this card
    integer :: i
    associate (card => cards(size(cards)))
      known = parameters%axisymmetric
      parameters%axisymmetric = card%word('value') == 'axisymmetric'
      if (.not. parameters%axisymmetric) return
      do i = 1, merge(0, size(cards) - 1, known)
        if (is_plain(cards(i)%name)) cycle
        call errors%add(card%position, "'dimension axisymmetric' comes after the card '"// &
                        cards(i)%name//"'", 'put it first: it names the axes of all other cards')
        return
      end do
      if (parameters%find('r') + parameters%find('r0') > 0) then
        call errors%add(card%position, 'r and r0 mean the radius in an axisymmetric scene', &
                        'give the parameter of that name another one')
      end if
    end associate
  end subroutine choose_variables

  !> `parameter name = value [name = value …]`.
  subroutine define_parameters(statement, parameters, errors)
    type(statement_t), intent(in) :: statement
    type(parameters_t), intent(inout) :: parameters
    type(deck_errors_t), intent(inout) :: errors
    logical :: fits
    integer :: i
    associate (tokens => statement%tokens)
      fits = size(tokens) > 1 .and. mod(size(tokens) - 1, 3) == 0
      do i = 2, merge(size(tokens), 1, fits), 3
        fits = fits .and. tokens(i + 1)%equals .and. .not. (tokens(i)%equals .or. &
                                                            tokens(i + 2)%equals)
      end do
      if (.not. fits) then
        call errors%add(tokens(1)%position, 'a parameter is written name = value', &
                        'put a value that contains blanks in quotes')
        return
      end if
      do i = 2, size(tokens), 3
        call parameters%define(tokens(i), tokens(i + 2), errors)
      end do
    end associate
  end subroutine define_parameters

  !> No component of a place or a motion beyond the dimension; directions alone may point there.
  subroutine check_plane(keys, card, draft)
    type(key_t), intent(in) :: keys(:)  !! of the card
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    logical :: beyond(3)
    integer :: i, axis
    associate (n => draft%scene%dimension)
      do i = 1, size(keys)
        associate (key => keys(i), value => card%values(i))
          if (.not. value%given) cycle
          call check_axis(key, value, draft)
          beyond = .false.
          if (key%kind == kind_vector .and. n > 1 .and. value%components == 1 .and. &
              abs(value%vector(1)) > 0.0_dp) then
            call draft%errors%add(value%position, "'"//key%name//"' is one number "// &
                                  draft%in_space(), 'write all components: '// &
                                  trim(merge('(a,b)  ', '(a,b,c)', n == 2)))
          end if
          if (key%kind == kind_vector .and. key%unit /= '') then
            beyond(n + 1:) = abs(value%vector(n + 1:)) > 0.0_dp
          else if (key%kind == kind_expression) then
            beyond(n + 1:) = [(draft%axis_key(axis) == key%name, axis=n + 1, 3)] .and. &
                             .not. says_nothing(key, value)
          end if
          axis = findloc(beyond, .true., 1)
          if (axis == 0) cycle
          call draft%errors%add(value%position, "'"//key%name//"' has a component along "// &
                                draft%axis_key(axis)//' '//draft%in_space(), &
                                'make it 0, or change the dimension')
        end associate
      end do
    end associate
  end subroutine check_plane

  !> No axis x in an axisymmetric scene, and no r in any other.
  subroutine check_axis(key, value, draft)
    type(key_t), intent(in) :: key
    type(value_t), intent(in) :: value
    type(draft_t), intent(inout) :: draft
    character(1) :: name
    name = merge('x', 'r', draft%scene%axisymmetric)
    if (all(key%name /= [name//' ', name//'-', name//'+'])) return
    if (says_nothing(key, value)) return
    call draft%errors%add(value%position, "there is no axis '"//name//"' "//draft%in_space(), &
                          'the axes are '//trim(merge('r and z  ', 'x, y, z  ', &
                                                      draft%scene%axisymmetric)))
  end subroutine check_axis

  !> Whether a value is what the key means when it is not given.
  pure function says_nothing(key, value) result(yes)
    type(key_t), intent(in) :: key
    type(value_t), intent(in) :: value
    logical :: yes
    if (key%kind == kind_interval) then
      yes = all(value%open)
    else if (key%kind == kind_expression) then
      yes = value%expression%is_constant .and. abs(value%expression%value) <= 0.0_dp
    else
      yes = value%text == wall_names(wall_free)
    end if
  end function says_nothing

  !> Cards that mean something when absent, so that the echo is complete.
  subroutine add_default_cards(registry, deck, parameters, cards, errors)
    type(registry_t), intent(in) :: registry
    type(position_t), intent(in) :: deck
    type(parameters_t), intent(inout) :: parameters
    type(deck_card_t), allocatable, intent(inout) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    type(deck_card_t) :: card
    integer :: i, k
    do i = 1, size(registry%cards)
      associate (definition => registry%cards(i))
        if (.not. definition%once) cycle
        if (any([(definition%keys(k)%required, k=1, size(definition%keys))])) cycle
        if (definition%needed /= '') cycle
        if (any(cards%definition == i)) cycle
        call card_default(definition, i, deck, parameters, card, errors)
        cards = [cards, card]
      end associate
    end do
  end subroutine add_default_cards

  !> A fixed step overrides the Courant number, whose default must then not be echoed.
  subroutine drop_overridden(cards)
    type(deck_card_t), intent(inout) :: cards(:)
    integer :: i
    do i = 1, size(cards)
      if (cards(i)%name /= 'time') cycle
      if (cards(i)%has('dt')) cards(i)%values(cards(i)%at('cfl'))%present = .false.
    end do
  end subroutine drop_overridden

  !> The table's cards and the two that are dealt with before it.
  pure function known_keywords(registry) result(names)
    type(registry_t), intent(in) :: registry
    type(string_t), allocatable :: names(:)
    names = [registry%card_names(), word_items('parameter include')]
  end function known_keywords

end module sgmp_deck
