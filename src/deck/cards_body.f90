!> The cards `body`, `add`, `subtract` and `intersect`: bodies and their shapes.
module sgmp_cards_body
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_keys, only: kind_integer, kind_name_word, kind_points, kind_real, kind_text, &
                       kind_vector, kind_word
  use sgmp_kinds, only: dp
  use sgmp_particle_file, only: particle_file_columns
  use sgmp_particle_number, only: particle_number_usual
  use sgmp_polygon, only: polygon_is_simple
  use sgmp_registry, only: read_second, registry_t
  use sgmp_scene, only: body_card_t, layout_file, layout_gauss, layout_graded, &
                        layout_lattice, layout_names
  use sgmp_scene_draft, only: draft_t, named_bodies
  use sgmp_shapes, only: combine_intersection, combine_names, combine_union, most_corners, &
                         shape_block, shape_cone, shape_cylinder, shape_halfspace, shape_moved, &
                         shape_names, shape_ogive, shape_polygon, shape_revolved, shape_ring, &
                         shape_sphere, shape_t
  use sgmp_spelling, only: word_position, words_joined
  use sgmp_state_columns, only: state_columns_of_files
  use sgmp_text, only: integer_text, real_text_plain
  use sgmp_turn, only: turn_make, turn_t
  implicit none
  private
  public :: register_body

  integer, parameter :: round(*) = [shape_cylinder, shape_ring, shape_cone, shape_ogive]
  character(*), parameter :: from_file = 'file'  !! the word for a body without a shape

contains

  !> Registers the cards of this group.
  subroutine register_body(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('body', 'A body: its first shape, its material, its particles. Further '// &
                       'shapes are added, subtracted or intersected by the cards of those names.', &
                       'body rod cylinder material=copper radius=3.8 length=25.4 spacing=0.38', &
                       read_body, check_body, selector='shape', needed='add a body', &
                       turn=read_second)
    call registry%key('name', kind_name_word, 'name used by other cards', slot=1, required=.true.)
    call registry%key('shape', kind_word, 'first shape (a halfspace, which has no '// &
                      'end, only adds, subtracts or intersects); file: particles from a '// &
                      'file', slot=2, &
                      choices=words_joined(pack(shape_names, shape_names /= &
                                                shape_names(shape_halfspace)))//' '//from_file, &
                      required=.true.)
    call registry%key('material', kind_name_word, 'the material', required=.true.)
    call register_shape_keys(registry)
    call registry%key('file', kind_text, 'text file with a line per particle: '// &
                      particle_file_columns//', or columns that its first line names, '// &
                      'among them id, material and a state (doc/user-guide.md); a relative '// &
                      'path starts at the deck', &
                      when=from_file, required=.true.)
    call registry%key('layout', kind_word, 'uniform: particles in the middle of cubes; gauss: '// &
                      'Gauss points of each grid cell; graded: ppc along each axis between '// &
                      'centres of unequal cells, the default for bodies at rest on a grid with '// &
                      'fine_x, fine_y or fine_z', choices=words_joined(layout_names), &
                      default=trim(layout_names(layout_lattice)))
    call registry%key('spacing', kind_real, 'lattice constant; default: cell/ppc', unit='length', &
                      range='(0,inf)')
    call registry%key('ppc', kind_integer, 'particles per cell along each axis; default: 2, of '// &
                      'elastic rings in the plane with surfaces=corrected 3', range='[1,10]')
    call registry%key('jitter', kind_real, 'largest random displacement, in spacings', &
                      range='[0,0.5]', default='0')
    call registry%key('fit', kind_word, 'shape: a particle at the surface has the volume of '// &
                      'that part of the shapes that is next to it, so that the body has their '// &
                      'mass; cubes: all have that of their cube; default: shape, but cubes '// &
                      'where pressure, traction, blast or an absorbing wall acts on what is '// &
                      'round, oblique to the lattice or stepped, or on a body of gimp, cpgimp', &
                      choices='shape cubes')
    call register_copies(registry)
    call register_turn(registry, 'angle in degrees; turns shapes and lattice')
    call registry%key('lattice_origin', kind_vector, &
                      'a corner of the cubes of the lattice; default: lower corner of the '// &
                      'first shape, or the axis of a round one', unit='length')
    call registry%key('temperature', kind_real, 'initial temperature, of '// &
                      'material that keeps one; default: room_temperature', &
                      unit='temperature', range='[0,inf)')
    call registry%key('overlap', kind_word, 'allow: bodies may share space at the start', &
                      choices='error allow', default='error')
    call register_combination(registry, combine_names(1), 'Adds a shape to a body.')
    call register_combination(registry, combine_names(2), 'Cuts a shape out of a body.')
    call register_combination(registry, combine_names(3), 'Keeps what lies inside a shape.')
  end subroutine register_body

  subroutine register_combination(registry, name, help)
    type(registry_t), intent(inout) :: registry
    character(*), intent(in) :: name, help
    call registry%card(trim(name), help, trim(name)//' rod sphere centre=(0,0,0) radius=1', &
                       read_combination, selector='shape')
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call registry%key('shape', kind_word, 'the shape', slot=2, required=.true., &
                      choices=words_joined(shape_names))
    call register_shape_keys(registry)
    if (name /= combine_names(combine_intersection)) call register_copies(registry)
    call register_turn(registry, 'angle in degrees; turns this shape, and its copies each')
  end subroutine register_combination

  !> Keys of an array of shapes.
  subroutine register_copies(registry)
    type(registry_t), intent(inout) :: registry
    call registry%key('copies', kind_integer, 'so many of the shape in a row; default: 1', &
                      range='[1,10000]')
    call registry%key('offset', kind_vector, 'from each copy to the next', unit='length')
  end subroutine register_copies

  !> Keys of a rotation.
  subroutine register_turn(registry, help)
    type(registry_t), intent(inout) :: registry
    character(*), intent(in) :: help
    call registry%key('rotation', kind_real, help, default='0')
    call registry%key('rotation_axis', kind_vector, 'direction of the axis of the rotation, '// &
                      'right-handed; default: z')
    call registry%key('pivot', kind_vector, 'a point of the axis of the rotation', unit='length', &
                      default='(0,0,0)')
  end subroutine register_turn

  !> Keys of a shape, shared by body, add, subtract and intersect.
  subroutine register_shape_keys(registry)
    type(registry_t), intent(inout) :: registry
    character(:), allocatable :: block, plane, ball, rounds, flat, lathe
    block = trim(shape_names(shape_block))
    plane = trim(shape_names(shape_halfspace))
    ball = trim(shape_names(shape_sphere))
    rounds = words_joined(shape_names(round))
    flat = trim(shape_names(shape_polygon))
    lathe = trim(shape_names(shape_revolved))
    call registry%key('lower', kind_vector, 'lower corner', unit='length', when=block, &
                      required=.true.)
    call registry%key('upper', kind_vector, 'upper corner', unit='length', when=block, &
                      required=.true.)
    call registry%key('centre', kind_vector, 'centre; of the base for cylinder, ring, cone, '// &
                      'ogive; a point of the plane for halfspace; from where corners are '// &
                      'measured for polygon and revolved', unit='length', default='(0,0,0)', &
                      when=ball//' '//plane//' '//rounds//' '//flat//' '//lathe)
    call registry%key('axis', kind_vector, 'direction of the axis; outward normal of a halfspace', &
                      default='(0,0,1)', when=plane//' '//rounds//' '//lathe)
    call registry%key('radius', kind_real, 'outer radius, of the base for cone and ogive', &
                      unit='length', range='(0,inf)', when=ball//' '//rounds, required=.true.)
    call registry%key('inner', kind_real, 'inner radius', unit='length', range='(0,inf)', &
                      when=trim(shape_names(shape_ring)), required=.true.)
    call registry%key('top', kind_real, 'radius of the top', unit='length', range='[0,inf)', &
                      when=trim(shape_names(shape_cone)), default='0')
    call registry%key('length', kind_real, 'length along the axis, of a polygon along z; not '// &
                      'needed in 2D', unit='length', range='(0,inf)', when=rounds//' '//flat)
    call registry%key('corners', kind_points, 'corners in order round it, either way, at most '// &
                      integer_text(most_corners)//': of a polygon (x,y), axisymmetric '// &
                      '(r,z); revolved: distances from and along the axis', unit='length', &
                      when=flat//' '//lathe, required=.true.)
  end subroutine register_shape_keys

  subroutine read_body(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(body_card_t) :: new
    if (.not. draft%new_name(card, named_bodies)) return
    new%name = card%word('name')
    new%location = card%position%text()
    if (.not. card%failed) call fill_body(card, draft, new)
    draft%bodies = draft%bodies + 1
    draft%scene%bodies(draft%bodies) = new
  end subroutine read_body

  subroutine fill_body(card, draft, body)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(body_card_t), intent(inout) :: body
    body%material = draft%material_of(card)
    body%layout = card%pick('layout', layout_names)
    body%layout_asked = card%values(card%at('layout'))%given .or. card%has('spacing') .or. &
                        card%has('lattice_origin') .or. card%number('jitter') > 0.0_dp
    allocate (body%shapes(0))
    if (card%word('shape') == from_file) then
      body%layout = layout_file
      body%file = card%word('file')
      if (index(body%file, '/') /= 1) body%file = directory_of(card%position%file)//body%file
      call refuse_for_files(card, draft%errors)
    else
      call append_shape(card, combine_union, draft%scene%dimension, draft%scene%axisymmetric, &
                        turn_t(), body, draft%errors)
    end if
    body%rings = draft%scene%axisymmetric
    call take_turn(card, draft%scene%dimension, body%rings, body%turn, draft%errors)
    body%ppc = card%whole('ppc')
    body%spacing = card%number('spacing')
    body%jitter = card%number('jitter')
    body%fitted = all(body%layout /= [layout_file, layout_gauss]) .and. card%word('fit') /= 'cubes'
    if (card%has('lattice_origin')) body%lattice_origin = card%vector('lattice_origin')
    body%temperature = card%number('temperature', absent=-1.0_dp)
    body%allow_overlap = card%word('overlap') == 'allow'
    draft%scene%allow_overlap = draft%scene%allow_overlap .or. body%allow_overlap
    if (all(body%layout /= [layout_gauss, layout_graded])) return
    if (card%has('spacing') .or. body%jitter > 0.0_dp) then
      call draft%errors%add(card%position, 'spacing and jitter mean nothing for layout='// &
                            trim(layout_names(body%layout)), 'use ppc, or layout=uniform')
    end if
  end subroutine fill_body

  !> Keys that would be ignored.
  subroutine refuse_for_files(card, errors)
    type(deck_card_t), intent(in) :: card
    type(deck_errors_t), intent(inout) :: errors
    if (abs(card%number('rotation')) > 0.0_dp) call refuse('rotation')
    if (card%number('jitter') > 0.0_dp) call refuse('jitter')
    if (card%has('copies')) call refuse('copies')
    if (card%has('fit')) call refuse('fit')
    if (card%has('lattice_origin')) call refuse('lattice_origin')
  contains
    subroutine refuse(key)
      character(*), intent(in) :: key
      call errors%add(card%place(key), key//' means nothing for particles from a file', &
                      'remove it; particles are where the file has them')
    end subroutine refuse
  end subroutine refuse_for_files

  !> The rotation that a card asks for.
  subroutine take_turn(card, dimension, axisymmetric, turn, errors)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: dimension
    logical, intent(in) :: axisymmetric
    type(turn_t), intent(out) :: turn
    type(deck_errors_t), intent(inout) :: errors
    real(dp) :: axis(3)
    axis = [0.0_dp, 0.0_dp, 1.0_dp]
    if (axisymmetric .and. abs(card%number('rotation')) > 0.0_dp) then
      call errors%add(card%place('rotation'), 'a body of revolution cannot be turned', &
                      'remove rotation')
    else if (card%has('rotation_axis') .and. dimension < 3) then
      call errors%add(card%place('rotation_axis'), 'in the plane a body turns about z', &
                      'remove rotation_axis')
    else if (card%has('rotation_axis')) then
      axis = card%vector('rotation_axis')
      if (norm2(axis) <= 0.0_dp) then
        call errors%add(card%place('rotation_axis'), 'the axis has no direction', &
                        'e.g. rotation_axis=(0,1,0)')
        return
      end if
    end if
    turn = turn_make(card%number('rotation'), axis, card%vector('pivot'))
  end subroutine take_turn

  pure function directory_of(path) result(directory)
    character(*), intent(in) :: path
    character(:), allocatable :: directory
    directory = path(:index(path, '/', back=.true.))
  end function directory_of

  subroutine read_combination(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(turn_t) :: turn
    integer :: b
    b = draft%body_of(card, 'body')
    if (b <= 0) return
    if (.not. allocated(draft%scene%bodies(b)%shapes)) return
    if (draft%scene%bodies(b)%layout == layout_file) then
      call draft%errors%add(card%position, 'particles from a file have no shape', &
                            'remove this card')
      return
    end if
    call take_turn(card, draft%scene%dimension, draft%scene%axisymmetric, turn, draft%errors)
    call append_shape(card, word_position(card%name, combine_names), draft%scene%dimension, &
                      draft%scene%axisymmetric, turn, draft%scene%bodies(b), draft%errors)
  end subroutine read_combination

  subroutine append_shape(card, operation, dimension, axisymmetric, turn, body, errors)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: operation  !! one of combine_*
    integer, intent(in) :: dimension
    logical, intent(in) :: axisymmetric
    type(turn_t), intent(in) :: turn  !! of the shape within its body
    type(body_card_t), intent(inout) :: body
    type(deck_errors_t), intent(inout) :: errors
    type(shape_t) :: new
    integer :: i, copies
    new%kind = card%pick('shape', shape_names)
    new%combine = operation
    new%lower = card%vector('lower')
    new%upper = card%vector('upper')
    new%centre = card%vector('centre')
    new%radius = card%number('radius')
    new%radius2 = card%number('inner') + card%number('top')
    new%length = card%number('length', absent=huge(1.0_dp))
    if (card%has('axis')) new%axis = card%vector('axis')
    if (any(new%kind == [shape_polygon, shape_revolved])) then
      call take_corners(card, new, dimension, errors)
    end if
    if (axisymmetric) then
      ! The z axis is the second one; as a third component the default direction means it, too.
      new%axis = [new%axis(1), new%axis(2) + new%axis(3), 0.0_dp]
      call check_ring(card, new, errors)
    end if
    call check_shape(card, new, dimension, errors)
    if (norm2(new%axis) > 0.0_dp) new%axis = new%axis/norm2(new%axis)
    new%turn = turn
    if (operation == combine_intersection) then
      body%shapes = [body%shapes, new]
      return
    end if
    call check_copies(card, new, axisymmetric, errors)
    copies = max(1, card%whole('copies', absent=1))
    body%shapes = [body%shapes, (shape_moved(new, (i - 1)*card%vector('offset')), i=1, copies)]
  end subroutine append_shape

  !> A row of shapes needs its length and its distance.
  subroutine check_copies(card, shape, axisymmetric, errors)
    type(deck_card_t), intent(in) :: card
    type(shape_t), intent(in) :: shape
    logical, intent(in) :: axisymmetric
    type(deck_errors_t), intent(inout) :: errors
    if (card%has('copies') .neqv. card%has('offset')) then
      call errors%add(card%position, 'copies and offset come together', &
                      'e.g. copies=5 offset=(2,0,0)')
    else if (card%has('offset') .and. norm2(card%vector('offset')) <= 0.0_dp) then
      call errors%add(card%place('offset'), 'the copies are all in one place', &
                      'e.g. offset=(2,0,0)')
    else if (axisymmetric .and. card%has('offset')) then
      associate (offset => card%vector('offset'))
        if (abs(offset(1)) > 0.0_dp .and. any(round == shape%kind)) then
          call errors%add(card%place('offset'), 'the copies of a '//card%word('shape')// &
                          ' leave the axis', 'write offset=(0,z)')
        else if (offset(1) < 0.0_dp) then
          call errors%add(card%place('offset'), 'the copies move towards the axis', &
                          'begin with the innermost one')
        end if
      end associate
    end if
  end subroutine check_copies

  !> The corners of a polygon: those of the plane where they are, those that turn about an axis
  !! as distances from and along it.
  subroutine take_corners(card, shape, dimension, errors)
    type(deck_card_t), intent(in) :: card
    type(shape_t), intent(inout) :: shape
    integer, intent(in) :: dimension
    type(deck_errors_t), intent(inout) :: errors
    real(dp), allocatable :: points(:, :)
    points = card%points('corners')
    shape%corners = min(size(points, 2), most_corners)
    shape%corner(:, :shape%corners) = points(:, :shape%corners)
    if (size(points, 2) < 3 .or. size(points, 2) > most_corners) then
      call errors%add(card%place('corners'), 'a polygon of '//integer_text(size(points, 2))// &
                      ' corners', 'write 3 to '//integer_text(most_corners)//': (a,b),(c,d),...')
    else if (.not. polygon_is_simple(points)) then
      call errors%add(card%place('corners'), 'the sides of the polygon cross, or one has no '// &
                      'length', 'write the corners in order round it')
    end if
    if (shape%kind == shape_polygon) then
      shape%corner(1, :) = shape%corner(1, :) + shape%centre(1)
      shape%corner(2, :) = shape%corner(2, :) + shape%centre(2)
      if (dimension < 2) call errors%add(card%place('shape'), 'there are no polygons on a line', &
                                         'write a block')
      return
    end if
    if (size(points, 2) > 0) shape%length = maxval(points(2, :)) - minval(points(2, :))
    if (dimension /= 3) then
      call errors%add(card%place('shape'), 'a revolved polygon is a solid', &
                      'use polygon, in axisymmetric scenes its half at r > 0')
    else if (any(points(1, :) < 0.0_dp)) then
      call errors%add(card%place('corners'), 'the polygon reaches beyond its axis', &
                      'the first number of a corner is its distance from the axis')
    end if
  end subroutine take_corners

  subroutine check_shape(card, shape, dimension, errors)
    type(deck_card_t), intent(in) :: card
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: dimension
    type(deck_errors_t), intent(inout) :: errors
    logical :: in_plane
    if (shape%kind == shape_block) then
      if (any(shape%upper(:dimension) <= shape%lower(:dimension))) then
        call errors%add(card%place('upper'), 'the block is empty', &
                        'each component of upper must exceed that of lower')
      end if
    end if
    if (norm2(shape%axis) <= 0.0_dp) then
      call errors%add(card%place('axis'), 'the axis has no direction', 'e.g. axis=(0,0,1)')
      return
    end if
    if (shape%kind == shape_ring .and. shape%radius2 >= shape%radius) then
      call errors%add(card%place('inner'), 'the inner radius is not smaller than the outer', &
                      'make inner smaller')
    end if
    in_plane = dimension < 3 .and. all(abs(shape%axis(:dimension)) <= 0.0_dp)
    if (shape%kind == shape_polygon) in_plane = dimension < 3
    if (.not. any([round, shape_polygon] == shape%kind)) return
    if (in_plane .or. card%has('length')) return
    call errors%add(card%position, 'the '//card%word('shape')//" needs a 'length'", 'add length=…')
  end subroutine check_shape

  !> A shape must be the section of a body of revolution.
  subroutine check_ring(card, shape, errors)
    type(deck_card_t), intent(in) :: card
    type(shape_t), intent(in) :: shape
    type(deck_errors_t), intent(inout) :: errors
    if (any(shape%corner(1, :shape%corners) < 0.0_dp)) then
      call errors%add(card%place('corners'), 'the polygon reaches beyond the axis, to r < 0', &
                      'write its half at r > 0')
    else if (shape%kind == shape_block .and. shape%lower(1) < 0.0_dp) then
      call errors%add(card%place('lower'), 'the block reaches beyond the axis, to r < 0', &
                      'write the half-plane: lower=(0,z), or r of the inner radius')
    else if (any(round == shape%kind) .and. abs(shape%axis(1)) > 0.0_dp) then
      call errors%add(card%place('axis'), 'the axis of a '//card%word('shape')// &
                      ' in an axisymmetric scene is z', 'write axis=(0,1) or axis=(0,-1)')
    else if (any(round == shape%kind) .and. abs(shape%centre(1)) > 0.0_dp) then
      call errors%add(card%place('centre'), 'the '//card%word('shape')//' is not about the axis', &
                      'write centre=(0,z); a tube is a ring with inner and radius, or a block')
    else if (shape%kind == shape_sphere .and. abs(shape%centre(1)) > 0.0_dp .and. &
             shape%centre(1) < shape%radius) then
      call errors%add(card%place('centre'), 'the sphere is neither about the axis nor beside it', &
                      'write centre=(0,z), or a centre at r > radius for a torus')
    end if
  end subroutine check_ring

  !> What a body's card says together with others.
  subroutine check_body(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    call check_fit(card, draft)
    call check_temperature(card, draft)
    if (card%word('shape') == from_file) then
      call share_file(card, word_position(card%word('name'), draft%scene%bodies%name), draft)
    else
      call check_particle_number(card, draft)
    end if
  end subroutine check_body

  !> Only some laws know a temperature.
  subroutine check_temperature(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: i
    i = word_position(card%word('material'), draft%scene%materials%name)
    if (i == 0 .or. .not. card%has('temperature')) return
    associate (material => draft%scene%materials(i))
      if (material%law%history%temperature) return
      call draft%errors%add(card%place('temperature'), "particles of '"//trim(material%name)// &
                            "' keep no temperature", 'remove it, or use johnson_cook '// &
                            'thermal=yes, or steinberg_guinan or zerilli_armstrong with '// &
                            'specific_heat')
    end associate
  end subroutine check_temperature

  !> Bodies that take their particles from the same file take those of their material each.
  subroutine share_file(card, number, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: number            !! of the body
    type(draft_t), intent(inout) :: draft
    integer :: b
    associate (bodies => draft%scene%bodies, body => draft%scene%bodies(number), &
               materials => draft%scene%materials)
      body%choice%known = words_joined(materials%name)
      body%choice%material = card%word('material')
      body%choice%others = ''
      body%choice%state = state_columns_of_files()
      do b = 1, size(bodies)
        if (b == number .or. .not. allocated(bodies(b)%file) .or. bodies(b)%material == 0) cycle
        if (bodies(b)%file /= body%file) cycle
        if (bodies(b)%material == body%material .and. b < number) then
          call draft%errors%add(card%place('file'), "body '"//trim(bodies(b)%name)// &
                                "' takes the same particles", 'remove one of the bodies, or '// &
                                'give them materials that the file tells apart')
        end if
        body%choice%others = body%choice%others//trim(materials(bodies(b)%material)%name)//' '
      end do
    end associate
  end subroutine share_file

  !> Particle numbers are 32-bit integers; a block tells at once how many there will be.
  subroutine check_particle_number(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    real(dp) :: particles, spacing
    integer :: i
    if (card%word('shape') /= shape_names(shape_block)) return
    spacing = draft%scene%grid%cell/card%whole('ppc', absent=particle_number_usual)
    spacing = card%number('spacing', absent=spacing)
    if (spacing <= 0.0_dp) return
    particles = 1.0_dp
    if (any(draft%scene%grid%axes%graded)) return  ! there are fewer
    associate (lower => card%vector('lower'), upper => card%vector('upper'))
      do i = 1, draft%scene%dimension
        particles = particles*max(1.0_dp, (upper(i) - lower(i))/spacing)
      end do
    end associate
    if (particles > real(huge(1), dp)) then
      call draft%errors%add(card%position, "body '"//card%word('name')//"' would have about "// &
                            real_text_plain(anint(particles))//' particles', &
                            'use a larger spacing; at most '//integer_text(huge(1)))
    end if
  end subroutine check_particle_number

  !> Volumes that were asked to fit where they cannot.
  subroutine check_fit(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b
    if (card%word('fit') /= 'shape') return
    b = findloc(draft%scene%bodies%name == card%word('name'), .true., 1)
    if (b == 0) return
    if (draft%scene%bodies(b)%fitted .or. draft%scene%bodies(b)%layout == layout_file) return
    if (draft%scene%bodies(b)%layout == layout_gauss) then
      call draft%errors%add(card%place('fit'), 'Gauss points have the volumes of their rule', &
                            'use layout=uniform, or remove fit')
    else
      call draft%errors%add(card%place('fit'), 'pressure, traction, blast and absorbing '// &
                            'walls take particles for whole cubes where a body is round, '// &
                            'oblique to its lattice or stepped, and with gimp and cpgimp', &
                            'use fit=cubes, or remove fit')
    end if
  end subroutine check_fit

end module sgmp_cards_body
