!> The cards `grid`, `wall`, `wallmotion` and `lost`: where material may be.
module sgmp_cards_grid
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: position_t
  use sgmp_expression, only: expression_clone, expression_t
  use sgmp_features, only: features_drag, features_drag_words
  use sgmp_graded_sides, only: graded_default_largest, graded_sides, graded_wish_t
  use sgmp_grid_fit, only: grid_fit_extend, grid_fit_held, grid_fit_sizes, grid_fit_whole
  use sgmp_keys, only: kind_expression, kind_interval, kind_logical, kind_points, &
                       kind_real, kind_vector, kind_word
  use sgmp_kinds, only: dp
  use sgmp_lost_policy, only: lost_error, lost_names
  use sgmp_mesh, only: wall_absorbing, wall_fixed, wall_free, wall_names
  use sgmp_registry, only: read_first, registry_t
  use sgmp_scene, only: grid_card_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_space, only: axis_names, space_axisymmetric
  use sgmp_spelling, only: words_joined
  use sgmp_text, only: real_text_plain, real_text_tidy
  implicit none
  private
  public :: find_face, find_wall, register_grid

  character(1), parameter :: sides(2) = ['-', '+']

contains

  !> Registers the cards of this group.
  subroutine register_grid(registry)
    type(registry_t), intent(inout) :: registry
    integer :: axis, side
    call registry%card('grid', 'Background grid of cubic cells, or of cells that are small '// &
                       'where fine_x, fine_y, fine_z say. Walls lie at the ends given here; do '// &
                       'not extend the box by hand.', 'grid cell=h x=0:1 y=open '// &
                       'z=0:open', read_grid, check_grid, once=.true., turn=read_first, &
                       needed='add a grid, e.g. grid cell=0.1')
    call registry%key('cell', kind_real, 'side h of a cell, of the smallest where they differ', &
                      unit='length', range='(0,inf)', required=.true.)
    do axis = 1, 3
      call registry%key(axis_names(axis, 3), kind_interval, &
                        'extent; an open end follows the particles, one without a '// &
                        'wall moves outwards to the next cell', unit='length', &
                        default='open')
    end do
    call registry%key(axis_names(1, space_axisymmetric), kind_interval, 'extent of an '// &
                      'axisymmetric scene, in the place of x: from the axis, 0', unit='length')
    do axis = 1, 3
      call registry%key('fine_'//axis_names(axis, 3), kind_points, 'intervals along '// &
                        axis_names(axis, 3)//' with cells of the side h, (a,b),(c,d),…; beside '// &
                        'them cells grow. Default: all are equal', unit='length', &
                        source='doc/grids.md')
    end do
    call registry%key('fine_'//axis_names(1, space_axisymmetric), kind_points, 'the same along '// &
                      'the radius of an axisymmetric scene, in the place of fine_x', &
                      unit='length', source='doc/grids.md')
    call registry%key('ratio', kind_real, 'by which a cell beside a fine interval is at most '// &
                      'larger than the one before; default: 1.1', range='[1,1.5]', &
                      source='doc/grids.md')
    call registry%key('largest', kind_real, 'side up to which cells grow; default: '// &
                      real_text_plain(graded_default_largest)//' cells', unit='length', &
                      range='(0,inf)')
    call registry%card('wall', 'Boundary condition of the faces of the grid. A face with a '// &
                       'wall needs an extent in the card grid.', 'wall x-=fixed y-=slip', &
                       read_walls, check_walls, once=.true.)
    do axis = 1, 3
      do side = 1, 2
        call registry%key(axis_names(axis, 3)//sides(side), kind_word, &
                          'fixed: no velocity; slip: no normal velocity; free: nothing; '// &
                          'absorbing: absorbs waves', &
                          choices=words_joined(wall_names), default=trim(wall_names(wall_free)))
      end do
    end do
    call registry%key(axis_names(1, space_axisymmetric)//sides(2), kind_word, 'outer wall of '// &
                      'an axisymmetric scene, in the place of x+; the axis needs no card', &
                      choices=words_joined(wall_names))
    call registry%key('reactions', kind_logical, 'yes: what each slip or fixed wall does to '// &
                      'the bodies, its impulse since the start, is in history.csv', default='no', &
                      source='doc/loads.md')
    call registry%key('shift', kind_word, 'auto: walls that nothing touches at the start, and '// &
                      'floors, let go what meets them, those that move are a cell farther out, '// &
                      'for slow solids rest a cell before them; none: all are planes of '// &
                      'symmetry', &
                      choices='auto none', default='auto', source='doc/loads.md')
    call registry%key('centre', kind_vector, 'where the waves come from: absorbing walls then '// &
                      'bear what goes on pushing there, by springs beside the dashpots, '// &
                      'and let slow flow of fluids go; default: dashpots alone, but '// &
                      'for liquids the middle of the only gas or charge', &
                      unit='length', source='doc/loads.md')
    call register_motion(registry)
    call registry%card('lost', 'What happens to a particle that leaves through a closed face '// &
                       'without a wall.', 'lost remove', read_lost, once=.true.)
    call registry%key('policy', kind_word, 'error: stop; remove: count and drop; reflect: turn '// &
                      'back', choices=words_joined(lost_names), &
                      default=trim(lost_names(lost_error)), slot=1)
  end subroutine register_grid

  subroutine register_motion(registry)
    type(registry_t), intent(inout) :: registry
    integer :: axis
    call registry%card('wallmotion', 'A wall that moves along itself and drags what touches '// &
                       'it: fixed, or with friction. What pushes is a rigid body.', &
                       'wallmotion y+ x="min(t/0.1,1)"', read_motion, check_motion)
    call registry%key('face', kind_word, 'the face of the grid', choices='x- x+ y- y+ z- z+ r+', &
                      slot=1, required=.true.)
    do axis = 1, 3
      call registry%key(axis_names(axis, 3), kind_expression, 'velocity, a function of t alone', &
                        unit='speed', default='0', source='doc/loads.md')
    end do
  end subroutine register_motion

  subroutine read_grid(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: axis
    if (card%failed) return
    draft%scene%grid%position = card%position
    draft%scene%grid%cell = card%number('cell')
    do axis = 1, 3
      associate (extent => card%values(card%at(draft%axis_key(axis))))
        draft%scene%grid%open(:, axis) = extent%open
        draft%scene%grid%lower(axis) = extent%vector(1)
        draft%scene%grid%upper(axis) = extent%vector(2)
        draft%scene%grid%asked(:, axis) = extent%vector(:2)
      end associate
    end do
  end subroutine read_grid

  !> Box: a whole number of cells between walls, no extent beyond the dimension.
  subroutine check_grid(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    real(dp), parameter :: most_cells = 2.0e9_dp  ! along one axis
    real(dp) :: cells
    integer :: axis
    associate (cell => draft%scene%grid%cell, dimension => draft%scene%dimension, &
               errors => draft%errors)
      if (cell <= 0.0_dp) return
      call check_fine_words(card, draft)
      do axis = 1, 3
        associate (value => card%values(card%at(draft%axis_key(axis))))
          if (axis > dimension .and. .not. all(value%open)) then
            call errors%add(value%position, 'extent along '//draft%axis_key(axis)//' '// &
                            draft%in_space(), 'remove it or change the dimension')
          end if
          if (axis == 1 .and. draft%scene%axisymmetric .and. .not. value%open(1) .and. &
              abs(value%vector(1)) > 0.0_dp) then
            call errors%add(value%position, 'the grid begins at r = '// &
                            real_text_plain(value%vector(1))//' and not at the axis', &
                            'write r=0:… or r=open; a hollow body needs no inner face')
          end if
          if (axis <= dimension .and. size(card%points('fine_'//draft%axis_key(axis)), 2) > 0) then
            call grade_axis(card, axis, draft)
            cycle
          end if
          if (any(value%open)) cycle
          cells = (value%vector(2) - value%vector(1))/cell
          if (cells > most_cells) then
            call errors%add(value%position, 'the box has '//real_text_plain(anint(cells))// &
                            ' cells along '//draft%axis_key(axis), 'use larger cells')
          else
            call fit_axis(draft, axis, value%position)
          end if
        end associate
      end do
    end associate
  end subroutine check_grid

  !> Fine intervals beyond the dimension, and words that mean something beside fine intervals alone.
  subroutine check_fine_words(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    character(7), parameter :: words(2) = [character(7) :: 'ratio', 'largest']
    character(1), parameter :: names(4) = ['x', 'y', 'z', 'r']
    character(:), allocatable :: remedy
    character(6) :: key
    logical :: any_fine
    integer :: i, axis, w
    any_fine = .false.
    remedy = 'remove it or change the dimension'
    if (draft%scene%axisymmetric) remedy = 'the axes are r and z: write fine_r or fine_z'
    do i = 1, size(names)
      key = 'fine_'//names(i)
      if (size(card%points(key), 2) == 0) cycle
      any_fine = .true.
      if (any([(draft%axis_key(axis) == names(i), axis=1, draft%scene%dimension)])) cycle
      call draft%errors%add(card%place(key), key//' '//draft%in_space(), remedy)
    end do
    do w = 1, 2
      if (any_fine .or. .not. card%has(trim(words(w)))) cycle
      call draft%errors%add(card%place(trim(words(w))), trim(words(w))//' means nothing '// &
                            'where all cells are equal', 'add fine_x, fine_y or fine_z')
    end do
  end subroutine check_fine_words

  !> Tables of an axis with unequal cells.
  subroutine grade_axis(card, axis, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: axis
    type(draft_t), intent(inout) :: draft
    type(graded_wish_t) :: wish
    character(:), allocatable :: message, remedy
    character(6) :: key
    real(dp) :: ends(2)
    key = 'fine_'//draft%axis_key(axis)
    associate (grid => draft%scene%grid)
      call take_ends(grid, axis, draft%scene%axisymmetric, wish)
      wish%cell = grid%cell
      wish%ratio = card%number('ratio', absent=wish%ratio)
      wish%largest = card%number('largest', absent=graded_default_largest*grid%cell)/grid%cell
      wish%fine = card%points(key)
      if (.not. any(wish%open) .and. wish%ends(2) <= wish%ends(1)) return
      if (wish%largest < 1.0_dp) then
        call draft%errors%add(card%place('largest'), 'the largest cell is smaller than the '// &
                              'smallest', 'write largest='//real_text_plain(2.0_dp*grid%cell)// &
                              ' or more')
        return
      end if
      call graded_sides(wish, grid%axes(axis), ends, message, remedy)
      if (message /= '') then
        call draft%errors%add(card%place(key), message, remedy)
        return
      end if
      grid%moved(axis) = any(.not. wish%open .and. &
                             abs(ends - wish%ends) > 1.0e-6_dp*grid%cell)
      if (.not. grid%open(1, axis)) grid%lower(axis) = ends(1)
      if (.not. wish%open(2)) grid%upper(axis) = ends(2)
    end associate
  end subroutine grade_axis

  !> Where an axis ends, and how.
  pure subroutine take_ends(grid, axis, axisymmetric, wish)
    type(grid_card_t), intent(in) :: grid
    integer, intent(in) :: axis
    logical, intent(in) :: axisymmetric
    type(graded_wish_t), intent(inout) :: wish
    wish%open = grid%open(:, axis)
    if (axis == 1 .and. axisymmetric) wish%open(1) = .false.  ! it begins at the axis
    wish%held = grid_fit_held(grid, axis, axisymmetric) .and. .not. wish%open
    wish%walls = wish%held .and. grid%wall(:, axis) /= wall_absorbing
    wish%ends = [grid%lower(axis), grid%upper(axis)]
  end subroutine take_ends

  !> Moves an end without a wall to the grid; an error where walls at both ends are not on it.
  subroutine fit_axis(draft, axis, position)
    type(draft_t), intent(inout) :: draft
    integer, intent(in) :: axis
    type(position_t), intent(in) :: position     !! of the extent in the deck
    logical :: held(2)
    associate (grid => draft%scene%grid, name => draft%axis_key(axis))
      if (grid%upper(axis) <= grid%lower(axis)) return  ! of a card that was said to be wrong
      if (grid_fit_whole(grid%upper(axis) - grid%lower(axis), grid%cell)) return
      held = grid_fit_held(grid, axis, draft%scene%axisymmetric)
      if (all(held)) then
        call draft%errors%add(position, 'cell='//real_text_plain(grid%cell)//' does not divide '// &
                              real_text_tidy(grid%upper(axis) - grid%lower(axis))//' between '// &
                              'the walls '//name//'- and '//name//'+', fitting_words(draft))
      else
        call grid_fit_extend(grid, axis, held)
        grid%moved(axis) = .true.
      end if
    end associate
  end subroutine fit_axis

  !> Which cells near the deck's fit between all walls.
  function fitting_words(draft) result(text)
    type(draft_t), intent(in) :: draft
    character(:), allocatable :: text
    real(dp), allocatable :: lengths(:)
    real(dp) :: sizes(2)
    integer :: axis
    allocate (lengths(0))
    associate (scene => draft%scene, grid => draft%scene%grid)
      do axis = 1, scene%dimension
        if (any(grid%open(:, axis)) .or. grid%upper(axis) <= grid%lower(axis)) cycle
        if (.not. all(grid_fit_held(grid, axis, scene%axisymmetric))) cycle
        lengths = [lengths, grid%upper(axis) - grid%lower(axis)]
      end do
      sizes = grid_fit_sizes(lengths, grid%cell)
    end associate
    if (maxval(sizes) <= 0.0_dp) then
      text = 'no cell near it fits between the walls of all axes: change an extent'
    else if (minval(sizes) <= 0.0_dp) then
      text = 'cell='//real_text_tidy(maxval(sizes))//' fits'
    else
      text = 'cell='//real_text_tidy(sizes(1))//' and cell='//real_text_tidy(sizes(2))//' fit'
    end if
    if (maxval(sizes) > 0.0_dp .and. size(lengths) > 1) text = text//' all axes between walls'
  end function fitting_words

  subroutine read_walls(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: axis, side
    draft%scene%grid%walls_location = card%position%text()
    draft%scene%grid%reactions = card%flag('reactions')
    draft%scene%grid%shifts = card%word('shift') == 'auto'
    draft%scene%grid%springs = card%has('centre')
    if (card%has('centre')) draft%scene%grid%source = card%vector('centre')
    do axis = 1, 3
      do side = 1, 2
        if (axis == 1 .and. side == 1 .and. draft%scene%axisymmetric) cycle
        draft%scene%grid%wall(side, axis) = &
          max(wall_free, wall_free - 1 + card%pick(draft%axis_key(axis)//sides(side), wall_names))
      end do
    end do
  end subroutine read_walls

  subroutine check_walls(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    character(2) :: face
    integer :: axis, side
    do axis = 1, 3
      do side = 1, 2
        if (draft%scene%grid%wall(side, axis) == wall_free) cycle
        face = draft%axis_key(axis)//sides(side)
        if (axis > draft%scene%dimension) then
          call draft%errors%add(card%place(face), 'a wall on '//face//' '//draft%in_space(), &
                                'remove it or change the dimension')
        else if (draft%scene%grid%open(side, axis)) then
          call draft%errors%add(card%place(face), 'a wall on '//face//', which is open', &
                                'say where the wall is: grid '//draft%axis_key(axis)//'='// &
                                trim(merge('lower:open', 'open:upper', side == 1)))
        end if
      end do
    end do
    if (draft%scene%grid%springs) call check_source(card, draft)
  end subroutine check_walls

  !> A source whose far field absorbing walls bear: in the plane or in space, or on the axis.
  subroutine check_source(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    if (.not. any(draft%scene%grid%wall == wall_absorbing)) then
      call draft%errors%add(card%place('centre'), 'centre= without an absorbing wall', &
                            'remove it, or make a wall absorbing')
    else if (draft%scene%dimension == 1) then
      call draft%errors%add(card%place('centre'), 'centre= '//draft%in_space()//', where '// &
                            'nothing spreads: a plane wave that goes on pushing moves what it '// &
                            'meets', &
                            'remove it')
    else if (draft%scene%axisymmetric .and. abs(draft%scene%grid%source(1)) > 0.0_dp) then
      call draft%errors%add(card%place('centre'), 'centre= is not on the axis', &
                            'write centre=(0,z)')
    end if
  end subroutine check_source

  !> Axis and side of the face that a card names; axis = 0: the scene has none of that name.
  pure subroutine find_face(card, draft, side, axis)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(in) :: draft
    integer, intent(out) :: side, axis
    do axis = draft%scene%dimension, 1, -1
      do side = 1, 2
        if (draft%axis_key(axis)//sides(side) == card%word('face')) return
      end do
    end do
  end subroutine find_face

  !> The same for a card that acts on this face; axis = 0 is an error of the deck.
  subroutine find_wall(card, draft, side, axis)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer, intent(out) :: side, axis
    call find_face(card, draft, side, axis)
    if (axis > 0) return
    call draft%errors%add(card%place('face'), 'there is no face '//card%word('face')//' '// &
                          draft%in_space(), 'name one that has a card wall')
  end subroutine find_wall

  subroutine read_motion(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: side, axis, a
    call find_wall(card, draft, side, axis)
    if (axis == 0) return
    associate (velocity => draft%scene%grid%wall_velocity)
      if (any([(allocated(velocity(a, side, axis)%text), a=1, 3)])) then
        call draft%errors%add(card%position, 'the wall on '//card%word('face')//' has two '// &
                              'motions', 'remove one of the cards')
        return
      end if
      do a = 1, 3
        associate (value => card%values(card%at(axis_names(a, 3))))
          if (value%expression%uses_position .or. value%expression%uses_initial_position) then
            call draft%errors%add(value%position, 'the velocity of a wall cannot depend on '// &
                                  'position', 'use t only')
          end if
        end associate
      end do
      do a = 1, draft%scene%dimension
        if (card%at(draft%axis_key(a)) == 0) cycle  ! r
        velocity(a, side, axis) = &
          expression_clone(card%values(card%at(draft%axis_key(a)))%expression)
      end do
    end associate
  end subroutine read_motion

  !> What moves is a fixed wall or one with friction, and it moves along itself.
  subroutine check_motion(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    character(:), allocatable :: face
    integer :: side, axis
    call find_face(card, draft, side, axis)
    if (axis == 0) return
    face = card%word('face')
    associate (grid => draft%scene%grid, errors => draft%errors)
      if (grid%wall(side, axis) /= wall_fixed .and. &
          .not. features_drag(draft%scene%features, side, axis)) then
        call errors%add(card%place('face'), 'the wall on '//face//' is not fixed', &
                        'write wall '//face//'=fixed'//features_drag_words//'; nothing else is '// &
                        'dragged along')
      end if
      if (.not. rests(grid%wall_velocity(axis:axis, side, axis))) then
        call errors%add(card%place(draft%axis_key(axis)), 'the wall on '//face// &
                        ' would leave its place', &
                        'it moves along itself; what pushes is a rigid body')
      end if
      if (rests(grid%wall_velocity(:, side, axis))) then
        call errors%add(card%position, 'the wall on '//face//' does not move', &
                        'give a velocity along it, or remove this card')
      end if
    end associate
  end subroutine check_motion

  !> Whether a velocity is zero at all times.
  pure function rests(velocity) result(yes)
    type(expression_t), intent(in) :: velocity(:)
    logical :: yes
    yes = all(velocity%is_constant .and. abs(velocity%value) <= 0.0_dp)
  end function rests

  subroutine read_lost(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%grid%lost = card%pick('policy', lost_names)
  end subroutine read_lost

end module sgmp_cards_grid
