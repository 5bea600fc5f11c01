!> Parsed cards to a scene: copies values, resolves names.
module sgmp_scene_build
  use sgmp_cards, only: deck_card_t, value_t
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_deck_table, only: wall_faces
  use sgmp_expression, only: expression_clone, expression_free, expression_t
  use sgmp_kernels, only: method_cpgimp, method_gimp, method_names
  use sgmp_kinds, only: dp
  use sgmp_material_kinds, only: eos_gruneisen, eos_jwl, eos_none, hardening_linear, &
                                 hardening_perfect, hardening_power, material_names
  use sgmp_scene, only: body_card_t, bodyforce_card_t, detonation_card_t, gauge_card_t, &
                        layout_file, layout_gauss, layout_lattice, lost_error, material_card_t, &
                        name_length, scene_t, update_names
  use sgmp_scene_contact, only: add_contact, set_rigid
  use sgmp_shapes, only: combine_difference, combine_intersection, combine_union, shape_block, &
                         shape_halfspace, shape_names, shape_t
  use sgmp_spelling, only: string_t, suggestion, word_count, word_in_list, word_item
  implicit none
  private
  public :: scene_build


contains

  !> Fills a scene; unknown and duplicate names go to `errors`.
  subroutine scene_build(cards, scene, errors)
    type(deck_card_t), intent(in) :: cards(:)
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    call reserve(cards, scene)
    do i = 1, size(cards)  ! whatever others refer to comes first
      select case (cards(i)%name)
      case ('dimension')
        scene%dimension = 1  ! checks the least where the card is wrong
        if (.not. cards(i)%failed) scene%dimension = cards(i)%whole('value')
      case ('material')
        call add_material(cards(i), scene, errors)
      case ('grid')
        if (.not. cards(i)%failed) call set_grid(cards(i), scene)
      case default
        cycle
      end select
    end do
    do i = 1, size(cards)
      if (cards(i)%name == 'body') call add_body(cards(i), scene, errors)
    end do
    do i = 1, size(cards)
      if (.not. cards(i)%failed) call apply_card(cards(i), scene, errors)
    end do
  end subroutine scene_build

  !> Allocates what the scene counts.
  subroutine reserve(cards, scene)
    type(deck_card_t), intent(in) :: cards(:)
    type(scene_t), intent(inout) :: scene
    allocate (scene%contacts(0), scene%materials(0), scene%bodies(0), scene%bodyforces(0), &
              scene%detonations(0), scene%gauges(0), scene%output%fields(0))
    if (size(cards) == 0) return
  end subroutine reserve

  !> Everything that refers to nothing, or to materials and bodies only.
  subroutine apply_card(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    select case (card%name)
    case ('title')
      scene%title = card%word('text')
    case ('units')
      scene%units = [character(8) :: card%word('length'), card%word('mass'), card%word('time')]
    case ('wall')
      call set_walls(card, scene)
    case ('lost')
      scene%grid%lost = word_in_list(card%word('policy'), 'error remove reflect') - 1 + lost_error
    case ('method')
      call set_method(card, scene)
    case ('time')
      call set_time(card, scene)
    case ('stop')
      scene%stop%energy_growth = card%number('energy_growth')
      scene%stop%kinetic_below = card%number('kinetic_below')
    case ('gravity')
      scene%gravity = card%vector('vector')
    case ('eos')
      call set_eos(card, scene, errors)
    case ('viscosity')
      call set_viscosity(card, scene, errors)
    case ('add', 'subtract', 'intersect')
      call combine(card, scene, errors)
    case ('velocity')
      call set_velocity(card, scene, errors)
    case ('bodyforce')
      call add_bodyforce(card, scene, errors)
    case ('detonation')
      call add_detonation(card, scene)
    case ('contact')
      call add_contact(card, scene, bodies_of(scene), errors)
    case ('rigid')
      call set_rigid(card, scene, bodies_of(scene), errors)
    case ('output')
      call set_output(card, scene, errors)
    case ('history')
      scene%output%history_steps = card%whole('steps')
      scene%output%history_every = card%number('every')
    case ('balance')
      scene%balance%every = card%whole('every')
      scene%balance%gain = card%number('gain')
    case ('checkpoint')
      scene%checkpoint%every = card%whole('every')
      scene%checkpoint%minutes = card%number('minutes')
      scene%checkpoint%keep = card%whole('keep')
    case ('gauge')
      call add_gauge(card, scene, errors)
    case default  ! dimension, material, grid and body are done already
    end select
  end subroutine apply_card

  subroutine set_grid(card, scene)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    integer :: i
    scene%grid%cell = card%number('cell')
    do i = 1, 3
      associate (extent => card%values(card%at('xyz' (i:i))))
        scene%grid%open(:, i) = extent%open
        scene%grid%lower(i) = extent%vector(1)
        scene%grid%upper(i) = extent%vector(2)
      end associate
    end do
  end subroutine set_grid

  subroutine set_walls(card, scene)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    integer :: i, side, axis
    do i = 1, size(wall_faces)
      side = 2 - mod(i, 2)
      axis = 1 + (i - side)/2
      scene%grid%wall(side, axis) = word_in_list(card%word(wall_faces(i)), 'free slip fixed') - 1
    end do
  end subroutine set_walls

  subroutine set_method(card, scene)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    scene%method%kind = word_in_list(card%word('kind'), joined(method_names))
    scene%method%update = word_in_list(card%word('update'), joined(update_names))
    scene%method%flip = card%number('flip')
    ! At the end of its support a GIMP weight is the square of its gradient: a node lighter by 1e-12
    ! than a particle still carries 1e-6 of its force, and dropping that is felt in the momentum.
    if (any(scene%method%kind == [method_gimp, method_cpgimp])) then
      scene%method%mass_cutoff = 1.0e-20_dp
    end if
    scene%method%mass_cutoff = card%number('mass_cutoff', absent=scene%method%mass_cutoff)
    scene%method%normalised = card%word('stress') == 'normalised'
    scene%method%interior = card%number('interior')
    scene%method%spin = card%word('spin') == 'carried'
  end subroutine set_method

  subroutine set_time(card, scene)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    scene%time%end = card%number('end', absent=huge(1.0_dp))
    scene%time%cfl = card%number('cfl')
    scene%time%cfl_auto = card%has('cfl') .and. card%word('cfl') == 'auto'
    scene%time%dt = card%number('dt')
    scene%time%dt_min = card%number('dt_min')
    scene%time%growth = card%number('growth')
    scene%time%steps = card%whole('steps', absent=huge(1))
  end subroutine set_time

  subroutine add_material(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    type(material_card_t) :: new
    type(material_card_t), allocatable :: longer(:)
    integer :: n
    if (card%word('name') == '') return
    if (find(card%word('name'), materials_of(scene)) > 0) then
      call errors%add(card%values(card%at('name'))%position, &
                      "there are two materials '"//card%word('name')//"'", 'rename one of them')
      return
    end if
    new%name = card%word('name')
    new%kind = word_in_list(card%word('kind'), joined(material_names))
    new%density = card%number('density')
    new%young = card%number('young')
    new%poisson = card%number('poisson')
    new%small_strain = card%word('strain') == 'small'
    new%yield = card%number('yield')
    new%hardening = hardening_power
    if (card%has('hardening')) then
      new%hardening = word_in_list(card%word('hardening'), 'perfect linear power') - 1 + &
                      hardening_perfect
    end if
    new%hardening_modulus = card%number('hardening_modulus')
    new%hardening_exponent = card%number('hardening_exponent', absent=1.0_dp)
    call set_johnson_cook(card, new)
    new%detonation_speed = card%number('detonation_speed')
    new%burn_cells = card%number('burn_cells')
    n = size(scene%materials)
    allocate (longer(n + 1))
    longer(:n) = scene%materials
    longer(n + 1) = new
    call move_alloc(longer, scene%materials)
  end subroutine add_material

  subroutine set_johnson_cook(card, material)
    type(deck_card_t), intent(in) :: card
    type(material_card_t), intent(inout) :: material
    integer :: i
    material%rate_coefficient = card%number('rate_coefficient')
    material%reference_rate = card%number('reference_rate', absent=material%reference_rate)
    material%thermal = card%flag('thermal')
    material%thermal_exponent = card%number('thermal_exponent', absent=material%thermal_exponent)
    material%room_temperature = card%number('room_temperature', absent=material%room_temperature)
    material%melt_temperature = card%number('melt_temperature')
    material%specific_heat = card%number('specific_heat')
    material%taylor_quinney = card%number('taylor_quinney', absent=material%taylor_quinney)
    material%failure = card%flag('failure')
    do i = 1, 5
      material%damage(i) = card%number('d'//achar(iachar('0') + i))
    end do
  end subroutine set_johnson_cook

  subroutine set_eos(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    i = material_of(card, scene, errors)
    if (i == 0) return
    associate (material => scene%materials(i))
      if (material%eos /= eos_none) then
        call errors%add(card%position, "material '"//trim(material%name)// &
                        "' has two equations of state", 'remove one of the cards eos')
        return
      end if
      material%eos = merge(eos_jwl, eos_gruneisen, card%word('kind') == 'jwl')
      material%c0 = card%number('c0')
      material%s = card%number('s')
      material%gamma0 = card%number('gamma0')
      material%jwl_a = card%number('a')
      material%jwl_b = card%number('b')
      material%jwl_r1 = card%number('r1')
      material%jwl_r2 = card%number('r2')
      material%jwl_omega = card%number('omega')
      material%energy0 = card%number('energy0')
    end associate
  end subroutine set_eos

  subroutine set_viscosity(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: first, last
    first = 1
    last = size(scene%materials)
    if (card%word('material') /= 'all') then
      first = material_of(card, scene, errors)
      last = first
    end if
    if (first == 0) return
    scene%materials(first:last)%viscosity_quadratic = card%number('quadratic')
    scene%materials(first:last)%viscosity_linear = card%number('linear')
  end subroutine set_viscosity

  !> Number of the material that a card names, 0 and an error where there is none.
  integer function material_of(card, scene, errors) result(number)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    number = find(card%word('material'), materials_of(scene))
    if (number == 0) call errors%add(card%values(card%at('material'))%position, &
                                     "there is no material '"//card%word('material')//"'", &
                                     suggestion(card%word('material'), materials_of(scene), &
                                                'materials of this deck'))
  end function material_of

  subroutine add_body(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    type(body_card_t) :: new
    type(body_card_t), allocatable :: longer(:)
    integer :: n
    if (card%word('name') == '') return
    if (find(card%word('name'), bodies_of(scene)) > 0) then
      call errors%add(card%values(card%at('name'))%position, &
                      "there are two bodies '"//card%word('name')//"'", 'rename one of them')
      return
    end if
    new%name = card%word('name')
    new%location = card%position%text()
    if (.not. card%failed) call fill_body(card, scene, new, errors)
    n = size(scene%bodies)
    allocate (longer(n + 1))
    longer(:n) = scene%bodies
    longer(n + 1) = new
    call move_alloc(longer, scene%bodies)
  end subroutine add_body

  subroutine fill_body(card, scene, body, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(body_card_t), intent(inout) :: body
    type(deck_errors_t), intent(inout) :: errors
    body%material = material_of(card, scene, errors)
    body%layout = merge(layout_gauss, layout_lattice, card%word('layout') == 'gauss')
    allocate (body%shapes(0))
    if (card%word('shape') == 'file') then
      body%layout = layout_file
      body%file = card%word('file')
      if (index(body%file, '/') /= 1) body%file = directory_of(card%position%file)//body%file
    else
      call append_shape(card, combine_union, scene%dimension, body, errors)
    end if
    body%ppc = card%whole('ppc')
    body%spacing = card%number('spacing', absent=scene%grid%cell/body%ppc)
    body%jitter = card%number('jitter')
    body%rotation = card%number('rotation')
    body%pivot = card%vector('pivot')
    if (card%has('lattice_origin')) body%lattice_origin = card%vector('lattice_origin')
    body%temperature = card%number('temperature', absent=-1.0_dp)
    body%allow_overlap = card%word('overlap') == 'allow'
    scene%allow_overlap = scene%allow_overlap .or. body%allow_overlap
    if (body%layout /= layout_gauss) return
    if (card%has('spacing') .or. body%jitter > 0.0_dp) then
      call errors%add(card%position, 'spacing and jitter mean nothing for layout=gauss', &
                      'use ppc, or layout=uniform')
    end if
  end subroutine fill_body

  subroutine combine(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    i = body_of(card, scene, errors)
    if (i <= 0) return
    if (.not. allocated(scene%bodies(i)%shapes)) return
    if (scene%bodies(i)%layout == layout_file) then
      call errors%add(card%position, 'particles from a file have no shape', 'remove this card')
      return
    end if
    select case (card%name)
    case ('add')
      call append_shape(card, combine_union, scene%dimension, scene%bodies(i), errors)
    case ('subtract')
      call append_shape(card, combine_difference, scene%dimension, scene%bodies(i), errors)
    case default
      call append_shape(card, combine_intersection, scene%dimension, scene%bodies(i), errors)
    end select
  end subroutine combine

  subroutine append_shape(card, operation, dimension, body, errors)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: operation  !! one of combine_*
    integer, intent(in) :: dimension
    type(body_card_t), intent(inout) :: body
    type(deck_errors_t), intent(inout) :: errors
    type(shape_t) :: new
    type(shape_t), allocatable :: longer(:)
    integer :: n
    new%kind = word_in_list(card%word('shape'), shape_names) - 1 + shape_block
    new%combine = operation
    new%lower = card%vector('lower')
    new%upper = card%vector('upper')
    new%centre = card%vector('centre')
    new%radius = card%number('radius')
    new%radius2 = card%number('inner') + card%number('top')
    new%length = card%number('length', absent=huge(1.0_dp))
    if (card%has('axis')) new%axis = card%vector('axis')
    call check_shape(card, new, dimension, errors)
    if (norm2(new%axis) > 0.0_dp) new%axis = new%axis/norm2(new%axis)
    n = size(body%shapes)
    allocate (longer(n + 1))
    longer(:n) = body%shapes
    longer(n + 1) = new
    call move_alloc(longer, body%shapes)
  end subroutine append_shape

  subroutine check_shape(card, shape, dimension, errors)
    type(deck_card_t), intent(in) :: card
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: dimension
    type(deck_errors_t), intent(inout) :: errors
    logical :: in_plane
    if (shape%kind == shape_block) then
      if (any(shape%upper(:dimension) <= shape%lower(:dimension))) then
        call errors%add(card%values(card%at('upper'))%position, 'the block is empty', &
                        'each component of upper must exceed that of lower')
      end if
    end if
    if (norm2(shape%axis) <= 0.0_dp) then
      call errors%add(card%values(card%at('axis'))%position, 'the axis has no direction', &
                      'e.g. axis=(0,0,1)')
      return
    end if
    if (card%word('shape') == 'ring' .and. shape%radius2 >= shape%radius) then
      call errors%add(card%values(card%at('inner'))%position, &
                      'the inner radius is not smaller than the outer', 'make inner smaller')
    end if
    in_plane = dimension < 3 .and. all(abs(shape%axis(:dimension)) <= 0.0_dp)
    if (word_in_list(card%word('shape'), 'cylinder ring cone ogive') == 0 .or. in_plane) return
    if (.not. card%has('length')) then
      call errors%add(card%position, 'the '//card%word('shape')//" needs a 'length'", &
                      'add length=…')
    end if
  end subroutine check_shape

  !> Number of the body that a card names, 0 for all, negative and an error where there is none.
  integer function body_of(card, scene, errors) result(number)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    number = 0
    if (card%word('body') == 'all') return
    number = find(card%word('body'), bodies_of(scene))
    if (number > 0) return
    number = -1
    call errors%add(card%values(card%at('body'))%position, &
                    "there is no body '"//card%word('body')//"'", &
                    suggestion(card%word('body'), bodies_of(scene), 'bodies of this deck'))
  end function body_of

  subroutine set_velocity(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: b, i, k
    b = body_of(card, scene, errors)
    do k = 1, 3
      associate (value => card%values(card%at('xyz' (k:k))))
        if (value%expression%uses_time) then
          call errors%add(value%position, 'the initial velocity cannot depend on t', &
                          'use x, y and z')
        end if
        do i = 1, size(scene%bodies)
          if (b /= 0 .and. b /= i) cycle
          call expression_free(scene%bodies(i)%velocity(k))
          scene%bodies(i)%velocity(k) = expression_clone(value%expression)
        end do
      end associate
    end do
  end subroutine set_velocity

  subroutine add_bodyforce(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    type(bodyforce_card_t), allocatable :: longer(:)
    integer :: b, k, n
    b = body_of(card, scene, errors)
    if (b < 0) return
    n = size(scene%bodyforces)
    allocate (longer(n + 1))
    longer(:n) = scene%bodyforces
    longer(n + 1)%body = b
    do k = 1, 3
      longer(n + 1)%force(k) = expression_clone(card%values(card%at('xyz' (k:k)))%expression)
    end do
    call move_alloc(longer, scene%bodyforces)
  end subroutine add_bodyforce

  subroutine add_detonation(card, scene)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(detonation_card_t) :: new
    type(detonation_card_t), allocatable :: longer(:)
    integer :: n
    new%point = card%vector('point')
    new%time = card%number('time')
    new%plane = card%has('normal')
    if (new%plane) new%normal = card%vector('normal')
    if (norm2(new%normal) > 0.0_dp) new%normal = new%normal/norm2(new%normal)
    n = size(scene%detonations)
    allocate (longer(n + 1))
    longer(:n) = scene%detonations
    longer(n + 1) = new
    call move_alloc(longer, scene%detonations)
  end subroutine add_detonation

  subroutine set_output(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    associate (output => scene%output)
      select case (card%word('kind'))
      case ('vtkhdf')
        output%vtkhdf = .true.
      case ('vtu')
        output%vtu = .true.
      case ('tecplot')
        output%tecplot = .true.
      case default
        output%csv_end = .true.
      end select
      if (card%has('every')) then
        if (output%every > 0.0_dp .and. abs(output%every - card%number('every')) > 0.0_dp) then
          call errors%add(card%values(card%at('every'))%position, &
                          'two outputs with different intervals', 'give both the same every')
        end if
        output%every = card%number('every')
      end if
      do i = 1, word_count(card%word('fields'))
        if (find(word_item(card%word('fields'), i), strings(output%fields)) > 0) cycle
        output%fields = [character(name_length) :: output%fields, word_item(card%word('fields'), i)]
      end do
    end associate
  end subroutine set_output

  subroutine add_gauge(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(inout) :: scene
    type(deck_errors_t), intent(inout) :: errors
    type(gauge_card_t), allocatable :: longer(:)
    integer :: n
    n = size(scene%gauges)
    if (find(card%word('name'), gauges_of(scene)) > 0) then
      call errors%add(card%values(card%at('name'))%position, &
                      "there are two gauges '"//card%word('name')//"'", 'rename one of them')
      return
    end if
    allocate (longer(n + 1))
    longer(:n) = scene%gauges
    longer(n + 1)%name = card%word('name')
    longer(n + 1)%point = card%vector('point')
    call move_alloc(longer, scene%gauges)
  end subroutine add_gauge

  !> Position of a name in a list, 0 where it is not in it.
  pure integer function find(name, names) result(number)
    character(*), intent(in) :: name
    type(string_t), intent(in) :: names(:)
    do number = 1, size(names)
      if (names(number)%text == name) return
    end do
    number = 0
  end function find

  pure function materials_of(scene) result(names)
    type(scene_t), intent(in) :: scene
    type(string_t), allocatable :: names(:)
    integer :: i
    allocate (names(size(scene%materials)))
    do i = 1, size(names)
      names(i)%text = trim(scene%materials(i)%name)
    end do
  end function materials_of

  pure function bodies_of(scene) result(names)
    type(scene_t), intent(in) :: scene
    type(string_t), allocatable :: names(:)
    integer :: i
    allocate (names(size(scene%bodies)))
    do i = 1, size(names)
      names(i)%text = trim(scene%bodies(i)%name)
    end do
  end function bodies_of

  pure function gauges_of(scene) result(names)
    type(scene_t), intent(in) :: scene
    type(string_t), allocatable :: names(:)
    integer :: i
    allocate (names(size(scene%gauges)))
    do i = 1, size(names)
      names(i)%text = trim(scene%gauges(i)%name)
    end do
  end function gauges_of

  pure function strings(names) result(list)
    character(*), intent(in) :: names(:)
    type(string_t), allocatable :: list(:)
    integer :: i
    allocate (list(size(names)))
    do i = 1, size(names)
      list(i)%text = trim(names(i))
    end do
  end function strings

  !> Names as one blank-separated list.
  pure function joined(names) result(list)
    character(*), intent(in) :: names(:)
    character(:), allocatable :: list
    integer :: i
    list = ''
    do i = 1, size(names)
      list = list//trim(names(i))//' '
    end do
  end function joined

  pure function directory_of(path) result(directory)
    character(*), intent(in) :: path
    character(:), allocatable :: directory
    directory = path(:index(path, '/', back=.true.))
  end function directory_of

end module sgmp_scene_build
