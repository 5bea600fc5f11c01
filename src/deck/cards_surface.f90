!> The cards `load`, `pressure`, `traction` and `blast`: forces on particles of a body and on its
!! surface.
module sgmp_cards_surface
  use sgmp_air_blast, only: burst_names
  use sgmp_deck_card, only: deck_card_t
  use sgmp_expression, only: expression_clone
  use sgmp_keys, only: kind_expression, kind_name_word, kind_real, kind_vector, kind_word
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_blast, load_force, load_pressure, load_traction
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: body_card_t, layout_graded, layout_lattice, load_card_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_space, only: axis_names, space_axisymmetric
  use sgmp_spelling, only: words_joined
  use sgmp_turn, only: turn_turns
  implicit none
  private
  public :: register_surface

  character(*), parameter :: faces = 'all x- x+ y- y+ z- z+ r- r+'
  character(*), parameter :: functions = 'a function of x y z (where it acts), x0 y0 z0 (where '// &
                                         'the particle was at the start) and t'

contains

  !> Registers the cards of this group.
  subroutine register_surface(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('load', 'Force on a body or a part of it, which its particles share by '// &
                       'their masses; about an axis, the force on whole rings.', &
                       'load beam where="x>0.99" y="-50*min(t/1e-3,1)"', read_force, check_load)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call register_components(registry, 'force', 'component of the force, '//functions)
    call register_where(registry, 'the particles that bear it')
    call registry%card('pressure', 'Pressure on the surface of a body, or on a part of it: '// &
                       'the faces of its outermost particles, which follow the deformation.', &
                       'pressure rod face=x- p="p0*sin(pi*t/t0)^2*(t<t0)"', read_pressure, &
                       check_faces)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call registry%key('p', kind_expression, 'the pressure, '//functions, unit='stress', &
                      required=.true.)
    call register_faces(registry)
    call registry%card('traction', 'Force per area on the surface of a body, or on a part of '// &
                       'it; its direction does not follow the surface, its area does.', &
                       'traction block face=y+ x="tau*min(t/t0,1)"', read_traction, check_faces)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call register_components(registry, 'stress', 'component of the traction, '//functions)
    call register_faces(registry)
    call register_blast(registry)
  end subroutine register_surface

  subroutine register_blast(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('blast', 'Pressure of a charge of TNT in air on the surface of a body, '// &
                       'from the fits of Kingery and Bulmash (1984); the air itself is not '// &
                       'computed. The deck must have the card units.', &
                       'blast plate charge=1 point=(0,0,0.5)', read_blast, check_blast)
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call registry%key('charge', kind_real, 'mass of the explosive', unit='mass', &
                      range='(0,inf)', required=.true., source='doc/loads.md')
    call registry%key('tnt', kind_real, 'mass of TNT that acts as a unit of its mass does', &
                      range='(0,inf)', default='1')
    call registry%key('point', kind_vector, 'centre of the charge', unit='length', required=.true.)
    call registry%key('burst', kind_word, 'a sphere in free air, or a hemisphere on the ground', &
                      choices=words_joined(burst_names), default='free_air')
    call registry%key('time', kind_real, 'when it is lit', unit='time', default='0')
    call register_faces(registry)
  end subroutine register_blast

  !> Keys x, y, z, or r and z.
  subroutine register_components(registry, unit, help)
    type(registry_t), intent(inout) :: registry
    character(*), intent(in) :: unit, help
    integer :: axis
    do axis = 1, 3
      call registry%key(axis_names(axis, 3), kind_expression, help, unit=unit, default='0')
    end do
    call registry%key(axis_names(1, space_axisymmetric), kind_expression, &
                      'component of an axisymmetric scene, in the place of x', unit=unit)
  end subroutine register_components

  !> Keys that choose faces.
  subroutine register_faces(registry)
    type(registry_t), intent(inout) :: registry
    call registry%key('face', kind_word, 'which way the faces look, along an axis of the body '// &
                      'as it is before it is turned', choices=faces, default='all', &
                      source='doc/loads.md')
    call register_where(registry, 'the faces')
  end subroutine register_faces

  subroutine register_where(registry, what)
    type(registry_t), intent(inout) :: registry
    character(*), intent(in) :: what             !! is chosen
    call registry%key('where', kind_expression, what//': those at whose place at the start '// &
                      'this function is not 0, e.g. "x<0.01 && y>0"', default='1')
  end subroutine register_where

  subroutine read_force(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    call read_load(card, load_force, draft)
  end subroutine read_force

  subroutine read_pressure(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    call read_load(card, load_pressure, draft)
  end subroutine read_pressure

  subroutine read_blast(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    call read_load(card, load_blast, draft)
  end subroutine read_blast

  subroutine read_traction(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    call read_load(card, load_traction, draft)
  end subroutine read_traction

  subroutine read_load(card, kind, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: kind                  !! one of load_*
    type(draft_t), intent(inout) :: draft
    type(load_card_t) :: new
    integer :: axis
    new%kind = kind
    new%location = card%position%text()
    new%body = draft%body_of(card, 'body')
    if (new%body == 0) call draft%errors%add(card%place('body'), 'a load acts on one body', &
                                             'name it; write a card for each')
    if (new%body <= 0) return
    select case (kind)
    case (load_blast)
      new%charge = card%number('charge')*card%number('tnt')
      new%point = card%vector('point')
      new%burst = card%pick('burst', burst_names)
      new%time = card%number('time')
    case (load_pressure)
      new%value(1) = expression_clone(card%values(card%at('p'))%expression)
    case default  ! load_force, load_traction
      do axis = 1, 3
        new%value(axis) = expression_clone(card%values(card%at(draft%axis_key(axis)))%expression)
      end do
    end select
    associate (where => card%values(card%at('where')))
      if (where%expression%uses_time) then
        call draft%errors%add(where%position, "'where' cannot depend on t: it chooses at the "// &
                              'start', 'use x, y and z; let the load itself depend on t')
      end if
      new%where = expression_clone(where%expression)
    end associate
    if (kind /= load_force) call take_face(card, new, draft)
    draft%scene%loads = [draft%scene%loads, new]
  end subroutine read_load

  !> Axis and side that a face is named by.
  subroutine take_face(card, load, draft)
    type(deck_card_t), intent(in) :: card
    type(load_card_t), intent(inout) :: load
    type(draft_t), intent(inout) :: draft
    character(:), allocatable :: face
    integer :: axis
    face = card%word('face')
    if (face == 'all') return
    load%side = merge(1, 2, face(2:2) == '-')
    do axis = 1, draft%scene%dimension
      if (face(:1) == draft%axis_key(axis)) load%axis = axis
    end do
    if (load%axis == 0) call draft%errors%add(card%place('face'), "there is no face '"//face// &
                                              "' "//draft%in_space(), &
                                              'name one of an axis of the scene, or all')
  end subroutine take_face

  !> What can bear a load at all.
  subroutine check_load(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b
    b = draft%body_of(card, 'body')
    if (b <= 0) return
    if (.not. draft%scene%bodies(b)%rigid) return
    call draft%errors%add(card%place('body'), "body '"//card%word('body')//"' is rigid: it "// &
                          'bears no load', 'a free one feels a bodyforce')
  end subroutine check_load

  !> What can have faces: an undisturbed lattice, whose particles stay whole.
  subroutine check_faces(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: b
    call check_load(card, draft)
    b = draft%body_of(card, 'body')
    if (b <= 0) return
    associate (body => draft%scene%bodies(b))
      if (all(body%layout /= [layout_lattice, layout_graded]) .or. body%jitter > 0.0_dp .or. &
          (body%layout == layout_graded .and. turn_turns(body%turn))) then
        call draft%errors%add(card%place('body'), "the particles of body '"//card%word('body')// &
                              "' have no known faces", &
                              'faces are those of a lattice: no layout=gauss, no jitter, '// &
                              'no file, and of turned bodies no layout=graded')
      end if
    end associate
  end subroutine check_faces

  !> What a blast needs besides faces: units, and a space in which its wave is a sphere.
  subroutine check_blast(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    call check_faces(card, draft)
    if (any(draft%scene%units == '')) then
      call draft%errors%add(card%position, 'a blast must know what the numbers of the deck '// &
                            'mean: it is measured in metres, kilograms and seconds', &
                            'add the card units, e.g. units m kg s')
    end if
    if (draft%scene%axisymmetric .and. abs(axis_distance(card)) > 0.0_dp) then
      call draft%errors%add(card%place('point'), 'the charge is not on the axis', &
                            'its first number is r: write 0, or dimension 3')
    end if
  end subroutine check_blast

  !> First number of the place of a charge.
  function axis_distance(card) result(r)
    type(deck_card_t), intent(in) :: card
    real(dp) :: r, point(3)
    point = card%vector('point')
    r = point(1)
  end function axis_distance

end module sgmp_cards_surface
