!> What must hold between the cards of a deck, and orders of magnitude worth a warning.
module sgmp_scene_check
  use sgmp_cards, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_deck_table, only: wall_faces
  use sgmp_kernels, only: method_sgmp
  use sgmp_kinds, only: dp, i8
  use sgmp_material_kinds, only: eos_jwl, eos_none, material_explosive
  use sgmp_registry, only: card_definition_t, kind_real, registry_t
  use sgmp_scene, only: scene_t, update_musl, wall_free
  use sgmp_scene_contact, only: check_contact
  use sgmp_spelling, only: word_in_list
  use sgmp_text, only: integer_text, real_text_plain
  implicit none
  private
  public :: scene_check, scene_check_cards

contains

  !> Cards that are missing or repeated; looks at the deck only.
  subroutine scene_check_cards(registry, cards, deck, complete, errors)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: cards(:)
    type(position_t), intent(in) :: deck         !! the file as a whole
    logical, intent(in) :: complete              !! every file was read: a missing card is an error
    type(deck_errors_t), intent(inout) :: errors
    integer :: i, k
    do i = 1, size(cards)
      if (.not. registry%cards(cards(i)%definition)%once) cycle
      do k = 1, i - 1
        if (cards(k)%name /= cards(i)%name) cycle
        call errors%add(cards(i)%position, "card '"//cards(i)%name//"' is given twice", &
                        'first given at '//cards(k)%position%text())
        exit
      end do
    end do
    if (.not. complete) return
    call need('grid', 'add a grid, e.g. grid cell=0.1')
    call need('time', 'add an end, e.g. time end=1')
    call need('material', 'add a material')
    call need('body', 'add a body')
  contains
    subroutine need(name, remedy)
      character(*), intent(in) :: name, remedy
      integer :: j
      do j = 1, size(cards)
        if (cards(j)%name == name) return
      end do
      call errors%add(deck, "the deck has no card '"//name//"'", remedy)
    end subroutine need
  end subroutine scene_check_cards

  !> Relations between values; cards that failed are left alone.
  subroutine scene_check(registry, cards, scene, errors)
    type(registry_t), intent(in) :: registry
    type(deck_card_t), intent(in) :: cards(:)
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    do i = 1, size(cards)
      if (cards(i)%failed) cycle
      select case (cards(i)%name)
      case ('grid')
        call check_grid(cards(i), scene, errors)
      case ('wall')
        call check_walls(cards(i), scene, errors)
      case ('time')
        call check_time(cards(i), errors)
      case ('method')
        call check_spin(cards(i), scene, errors)
        if (scene%method%normalised .and. scene%method%kind /= method_sgmp) then
          call errors%add(cards(i)%position, 'normalised stress exists for method sgmp only', &
                          'remove stress=normalised or use method sgmp')
        end if
      case ('material')
        call check_material(cards(i), scene, errors)
      case ('body')
        call check_particle_number(cards(i), scene, errors)
      case ('contact', 'rigid')
        call check_contact(cards(i), scene, errors)
      case ('detonation')
        call check_detonation(cards(i), scene, errors)
      case default
      end select
      if (scene%units(1) /= '') call check_magnitudes(registry%cards(cards(i)%definition), &
                                                      cards(i), &
                                                      scene%units, errors)
    end do
  end subroutine scene_check

  !> Carried spin: where it exists.
  subroutine check_spin(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    if (.not. scene%method%spin) return
    if (scene%method%kind /= method_sgmp .or. scene%method%update /= update_musl) then
      call errors%add(card%position, 'spin=carried exists for method sgmp update=musl only', &
                      'remove spin=carried or use method sgmp update=musl')
    end if
    if (scene%dimension == 1) then
      call errors%add(card%position, 'spin=carried needs two dimensions', 'remove spin=carried')
    end if
    if (scene%method%flip < 1.0_dp) then
      call errors%add(card%position, 'spin=carried needs flip=1', &
                      'remove flip or spin=carried')
    end if
  end subroutine check_spin

  !> Box: whole number of cells, no extent beyond the dimension.
  subroutine check_grid(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    real(dp), parameter :: tolerance = 1.0e-6_dp  ! cells
    real(dp), parameter :: most_cells = 2.0e9_dp  ! along one axis
    real(dp) :: length, cells
    integer :: i
    if (scene%grid%cell <= 0.0_dp) return
    do i = 1, 3
      associate (value => card%values(card%at('xyz' (i:i))))
        if (i > scene%dimension .and. .not. all(value%open)) then
          call errors%add(value%position, 'extent along '//'xyz' (i:i)//' in '// &
                          integer_text(scene%dimension)//'D', 'remove it or change the '// &
                          'dimension')
        end if
        if (any(value%open)) cycle
        length = value%vector(2) - value%vector(1)
        cells = length/scene%grid%cell
        if (cells > most_cells) then
          call errors%add(value%position, 'the box has '//real_text_plain(anint(cells))// &
                          ' cells along '//'xyz' (i:i), 'use larger cells')
        else if (abs(cells - anint(cells)) > tolerance .or. cells < 0.5_dp) then
          call errors%add(value%position, 'the box is not a whole number of cells: '// &
                          real_text_plain(length)//' / '//real_text_plain(scene%grid%cell)// &
                          ' = '//real_text_plain(cells), 'nearest cell='// &
                          real_text_plain(length/max(1.0_dp, anint(cells)))// &
                          ', or change the extent')
        end if
      end associate
    end do
  end subroutine check_grid

  subroutine check_walls(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: i, side, axis
    do i = 1, size(wall_faces)
      side = 2 - mod(i, 2)
      axis = (i + 1)/2
      if (scene%grid%wall(side, axis) == wall_free) cycle
      associate (position => card%values(card%at(wall_faces(i)))%position, &
                 name => 'xyz' (axis:axis))
        if (axis > scene%dimension) then
          call errors%add(position, 'a wall on '//wall_faces(i)//' in '// &
                          integer_text(scene%dimension)//'D', 'remove it or change the '// &
                          'dimension')
        else if (scene%grid%open(side, axis)) then
          call errors%add(position, 'a wall on '//wall_faces(i)//', which is open', &
                          'say where the wall is: grid '//name//'='// &
                          trim(merge('lower:open', 'open:upper', side == 1)))
        end if
      end associate
    end do
  end subroutine check_walls

  subroutine check_time(card, errors)
    type(deck_card_t), intent(in) :: card
    type(deck_errors_t), intent(inout) :: errors
    if (.not. (card%has('end') .or. card%has('steps'))) then
      call errors%add(card%position, 'the time has no end', 'add end=… or steps=…')
    end if
    if (card%has('dt') .and. card%values(card%at('cfl'))%given) then
      call errors%add(card%values(card%at('cfl'))%position, 'both dt and cfl are given', &
                      'remove one of the two')
    end if
  end subroutine check_time

  subroutine check_material(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    do i = 1, size(scene%materials)
      if (scene%materials(i)%name == card%word('name')) exit
    end do
    if (i > size(scene%materials)) return
    associate (material => scene%materials(i))
      if (material%kind == material_explosive .and. material%eos /= eos_jwl) then
        call errors%add(card%position, "explosive '"//trim(material%name)//"' has no JWL "// &
                        'equation', &
                        'add: eos '//trim(material%name)//' jwl a=… b=… r1=… r2=… omega=… '// &
                        'energy0=…')
      end if
      if (material%kind /= material_explosive .and. material%eos == eos_jwl) then
        call errors%add(card%position, "'"//trim(material%name)//"' has a JWL equation but no "// &
                        'burn', &
                        'make it explosive')
      end if
      if (word_in_list(card%word('kind'), 'elastic neo_hookean') > 0 .and. &
          material%eos /= eos_none) then
        call errors%add(card%position, "the pressure of '"//trim(material%name)//"' is elastic "// &
                        'already', &
                        'remove the card eos, or use j2 or johnson_cook')
      end if
      if (material%thermal .and. .not. (card%has('melt_temperature') .and. &
                                        card%has('specific_heat'))) then
        call errors%add(card%position, 'thermal=yes needs melt_temperature and specific_heat', &
                        'add both')
      end if
      if (card%has('melt_temperature') .and. &
          material%melt_temperature <= material%room_temperature) then
        call errors%add(card%values(card%at('melt_temperature'))%position, &
                        'the melting temperature is not above room temperature', 'check both')
      end if
    end associate
  end subroutine check_material

  !> Particle numbers are 32-bit integers; a block tells at once how many there will be.
  subroutine check_particle_number(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    real(dp) :: particles, spacing
    integer :: i
    if (card%word('shape') /= 'block') return
    spacing = scene%grid%cell/card%whole('ppc')
    spacing = card%number('spacing', absent=spacing)
    if (spacing <= 0.0_dp) return
    particles = 1.0_dp
    associate (lower => card%vector('lower'), upper => card%vector('upper'))
      do i = 1, scene%dimension
        particles = particles*max(1.0_dp, (upper(i) - lower(i))/spacing)
      end do
    end associate
    if (particles > real(huge(1), dp)) then
      call errors%add(card%position, "body '"//card%word('name')//"' would have about "// &
                      real_text_plain(anint(particles))//' particles', &
                      'use a larger spacing; at most '//integer_text(huge(1)))
    end if
  end subroutine check_particle_number

  subroutine check_detonation(card, scene, errors)
    type(deck_card_t), intent(in) :: card
    type(scene_t), intent(in) :: scene
    type(deck_errors_t), intent(inout) :: errors
    if (any(scene%materials%kind == material_explosive)) return
    call errors%add(card%position, 'a detonation without an explosive', &
                    'add a material of kind explosive, or remove this card')
  end subroutine check_detonation

  !> Warns where a number in SI units is outside of what matter does.
  subroutine check_magnitudes(definition, card, units, errors)
    type(card_definition_t), intent(in) :: definition
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: units(3)
    type(deck_errors_t), intent(inout) :: errors
    real(dp) :: si, low, high, factor
    integer :: i
    do i = 1, size(definition%keys)
      associate (key => definition%keys(i), value => card%values(i))
        if (key%kind /= kind_real .or. .not. value%given) cycle
        if (abs(value%number) <= 0.0_dp) cycle
        call plausible(key%unit, units, factor, low, high)
        si = abs(value%number)*factor
        if (si >= low .and. si <= high) cycle
        call errors%warn(value%position, key%name//' = '//real_text_plain(value%number)//' is '// &
                         real_text_plain(real(real(si), dp))//' in SI units (m kg s)', &
                         'is it in '//trim(units(1))//' '//trim(units(2))//' '//trim(units(3))//'?')
      end associate
    end do
  end subroutine check_magnitudes

  !> Factor to SI units and the range that raises no eyebrow.
  subroutine plausible(unit, units, factor, low, high)
    character(*), intent(in) :: unit       !! of the key
    character(*), intent(in) :: units(3)   !! length, mass, time of the deck
    real(dp), intent(out) :: factor, low, high
    real(dp), parameter :: length_units(*) = [1.0_dp, 1.0e-3_dp, 1.0e-2_dp, 1.0e-6_dp, 1.0e3_dp]
    real(dp), parameter :: mass_units(*) = [1.0_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e3_dp]
    real(dp), parameter :: time_units(*) = [1.0_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp]
    real(dp) :: length, mass, time
    length = length_units(word_in_list(trim(units(1)), 'm mm cm um km'))
    mass = mass_units(word_in_list(trim(units(2)), 'kg g mg t'))
    time = time_units(word_in_list(trim(units(3)), 's ms us ns'))
    factor = 1.0_dp
    low = 0.0_dp
    high = huge(1.0_dp)
    select case (unit)
    case ('density')
      factor = mass/length**3
      low = 1.0e-2_dp
      high = 3.0e4_dp
    case ('stress')
      factor = mass/(length*time**2)
      low = 1.0e-3_dp
      high = 1.0e13_dp
    case ('speed')
      factor = length/time
      high = 1.0e5_dp
    case ('specific heat')
      factor = (length/time)**2
      low = 1.0e1_dp
      high = 2.0e4_dp
    case default  ! lengths and times may be anything
    end select
  end subroutine plausible

end module sgmp_scene_check
