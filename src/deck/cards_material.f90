!> The cards `material`, `eos`, `failure`, `erode` and `viscosity`. Which laws there are, what they
!! are called and which keys they have is said in src/materials.
module sgmp_cards_material
  use sgmp_constitutive, only: eos_keys, eos_names, eos_none, eos_read, eos_table, law_check, &
                               law_keys, law_read, law_set_erosion, law_set_failure, &
                               law_set_spall, law_set_viscosity, law_widest_band, &
                               material_explosive, material_names
  use sgmp_deck_card, only: deck_card_t
  use sgmp_erosion, only: erosion_keys
  use sgmp_failure, only: failure_keys
  use sgmp_file_rows, only: file_rows_place
  use sgmp_kernels, only: method_band
  use sgmp_keys, only: fault_t, kind_name_word, kind_real, kind_word
  use sgmp_kinds, only: dp
  use sgmp_registry, only: read_first, registry_t
  use sgmp_scene, only: grid_card_t, material_card_t
  use sgmp_scene_draft, only: draft_t, named_materials
  use sgmp_spelling, only: word_position, words_joined
  use sgmp_text, only: real_text
  use sgmp_viscosity, only: viscosity_keys
  implicit none
  private
  public :: register_material

contains

  !> Registers the cards of this group.
  subroutine register_material(registry)
    type(registry_t), intent(inout) :: registry
    integer :: i
    call registry%card('material', 'A material: name, kind, constants.', &
                       'material steel elastic density=7850 young=210e9 poisson=0.3', &
                       read_material, check_material, selector='kind', needed='add a material', &
                       turn=read_first)
    call registry%key('name', kind_name_word, 'name used by other cards', slot=1, required=.true.)
    call registry%key('kind', kind_word, 'constitutive model', slot=2, required=.true., &
                      choices=words_joined(material_names))
    call registry%key('density', kind_real, 'initial density', unit='density', range='(0,inf)', &
                      required=.true.)
    do i = 1, size(material_names)
      call registry%keys(law_keys(i), trim(material_names(i)))
    end do
    call registry%card('eos', 'Equation of state of a material.', &
                       'eos copper gruneisen c0=3940 s=1.49 gamma0=1.96', read_eos, &
                       selector='kind')
    call registry%key('material', kind_name_word, 'the material', slot=1, required=.true.)
    call registry%key('kind', kind_word, 'equation; shock: on the measured Hugoniot itself; '// &
                      'gruneisen: its series to mu^3, without s2 and s3 (doc/materials.md)', &
                      choices=words_joined(eos_names), slot=2, &
                      required=.true.)
    do i = 1, size(eos_names)
      call registry%keys(eos_keys(i), trim(eos_names(i)))
    end do
    call registry%key('energy0', kind_real, 'initial energy per initial volume', unit='stress', &
                      range='[0,inf)', default='0')
    call registry%key('pressure0', kind_real, 'initial pressure, in place of energy0', &
                      unit='stress', when=words_joined(pack(eos_names, eos_names /= 'jwl')))
    call registry%card('failure', 'When a material fails, and what it carries then. Johnson '// &
                       "and Cook's damage is material … johnson_cook failure=yes; without "// &
                       'this card it leaves pressure alone.', 'failure copper pmin=-1.5e9', &
                       read_failure, check_failure)
    call registry%key('material', kind_name_word, 'the material', slot=1, required=.true.)
    call registry%keys(failure_keys())
    call registry%card('erode', 'When particles of a material are removed. Their mass, '// &
                       'momentum and energy are booked in history.csv and summary.json.', &
                       'erode copper plastic_strain=2', read_erode, check_erode)
    call registry%key('material', kind_name_word, 'the material', slot=1, required=.true.)
    call registry%keys(erosion_keys())
    call registry%card('viscosity', 'Bulk viscosity in compression, q = rho h^2 b1 (tr D)^2 - '// &
                       'b2 rho h c tr D. Without this card quadratic=1.5 linear=0.3 in '// &
                       'materials with an equation of state of fast scenes (doc/materials.md; '// &
                       'liquids beside explosives: linear=0.15), none in others; '// &
                       'quadratic=0 linear=0 leaves it out.', 'viscosity copper', &
                       read_viscosity)
    call registry%key('material', kind_name_word, 'the material; default: all', default='all', &
                      slot=1)
    call registry%keys(viscosity_keys())
  end subroutine register_material

  subroutine read_material(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(material_card_t) :: new
    type(fault_t), allocatable :: fault
    integer :: kind
    if (.not. draft%new_name(card, named_materials)) return
    new%name = card%word('name')
    kind = card%pick('kind', material_names)
    if (.not. card%failed) then
      call law_read(kind, card, new%law, fault)
      call complain(card, fault, draft)
    end if
    if (kind > 0) new%law%kind = kind  ! also where the constants are wrong: other cards ask
    draft%scene%materials = [draft%scene%materials, new]
  end subroutine read_material

  subroutine check_material(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(fault_t), allocatable :: fault
    integer :: i
    i = word_position(card%word('name'), draft%scene%materials%name)
    if (i == 0) return
    call law_check(draft%scene%materials(i)%law, card%word('name'), fault)
    call complain(card, fault, draft)
    if (draft%scene%materials(i)%law%kind == material_explosive .and. &
        size(draft%scene%detonations) == 0) then
      call draft%errors%add(card%position, "nothing lights the explosive '"//card%word('name')// &
                            "'", 'add a card detonation, e.g. detonation point=(0,0,0)')
    end if
  end subroutine check_material

  !> Passes on what a law has to say about a card.
  subroutine complain(card, fault, draft)
    type(deck_card_t), intent(in) :: card
    type(fault_t), allocatable, intent(in) :: fault
    type(draft_t), intent(inout) :: draft
    if (.not. allocated(fault)) return
    if (fault%row > 0) then
      call draft%errors%add(file_rows_place(card, fault%key, fault%column, fault%row), &
                            fault%message, fault%remedy)
    else if (fault%warning) then
      call draft%errors%warn(card%place(fault%key), fault%message, fault%remedy)
    else if (fault%key == '') then
      call draft%errors%add(card%position, fault%message, fault%remedy)
    else
      call draft%errors%add(card%place(fault%key), fault%message, fault%remedy)
    end if
  end subroutine complain

  subroutine read_eos(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(fault_t), allocatable :: fault
    integer :: i, eos
    i = draft%material_of(card)
    if (i == 0) return
    associate (law => draft%scene%materials(i)%law)
      if (law%eos == eos_none) then
        eos = card%pick('kind', eos_names)
        if (law%density > 0.0_dp .and. (eos /= eos_table .or. .not. card%failed)) then
          call eos_read(eos, card, law, fault)
          call complain(card, fault, draft)
        end if
        law%eos = eos  ! also where the material's card is wrong: other cards ask
      else
        call draft%errors%add(card%position, "material '"//card%word('material')// &
                              "' has two equations of state", 'remove one of the cards eos')
      end if
    end associate
  end subroutine read_eos

  subroutine read_failure(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(fault_t), allocatable :: fault
    integer :: i
    i = draft%material_of(card)
    if (i == 0 .or. card%failed) return
    associate (law => draft%scene%materials(i)%law)
      if (law%failure%given) then
        call draft%errors%add(card%position, "material '"//card%word('material')// &
                              "' has two cards failure", 'write all criteria on one card')
      else
        call law_set_failure(card, card%word('material'), law, fault)
        call complain(card, fault, draft)
      end if
    end associate
  end subroutine read_failure

  !> What spall knows of the other cards; cells in which a crack would give back energy.
  subroutine check_failure(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: i
    i = word_position(card%word('material'), draft%scene%materials%name)
    if (i == 0) return
    call law_set_spall(draft%scene%materials(i)%law)
    call check_resolved(card, draft, i)
    associate (cell => draft%scene%grid%cell, largest => largest_cell(draft%scene%grid), &
               widest => law_widest_band(draft%scene%materials(i)%law) &
               /method_band(draft%scene%method%kind))
      if (cell < widest .and. largest >= widest) then
        call draft%errors%warn(card%place('fracture_energy'), 'cells grow to '// &
                               real_text(largest)//', and cells beyond '//real_text(widest)// &
                               ' hold more elastic energy than a crack of this energy takes: '// &
                               'there it opens at once', 'lower largest of the card grid, or '// &
                               'keep cracks where cells are small')
      end if
      if (cell < widest) return
      call draft%errors%add(card%place('fracture_energy'), 'cells of '//real_text(cell)// &
                            ' hold more elastic energy than a crack of this energy takes', &
                            'use cells below '//real_text(widest)// &
                            ', a lower limit or a higher fracture_energy')
    end associate
  end subroutine check_failure

  !> Side of the largest cells of a grid (length).
  pure function largest_cell(grid) result(side)
    type(grid_card_t), intent(in) :: grid
    real(dp) :: side
    integer :: axis
    side = grid%cell
    do axis = 1, size(grid%axes)
      if (grid%axes(axis)%graded) side = max(side, grid%cell*maxval(grid%axes(axis)%spacing))
    end do
  end function largest_cell

  !> Warns of cells that do not resolve the length of a material.
  subroutine check_resolved(card, draft, material)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer, intent(in) :: material
    real(dp), parameter :: rounding = 1.0e-9_dp
    associate (cell => draft%scene%grid%cell, &
               length => draft%scene%materials(material)%law%failure%length)
      if (.not. length > 0.0_dp .or. length >= 2.0_dp*cell*(1.0_dp - rounding)) return
      call draft%errors%warn(card%place('length'), 'cells of '//real_text(cell)//' do not '// &
                             'resolve a length of '//real_text(length)//': failure follows the '// &
                             'cell', 'use cells of half of it or less')
    end associate
  end subroutine check_resolved

  subroutine read_erode(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: i
    i = draft%material_of(card)
    if (i == 0 .or. card%failed) return
    associate (erosion => draft%scene%materials(i)%law%erosion)
      if (erosion%given) then
        call draft%errors%add(card%position, "material '"//card%word('material')// &
                              "' has two cards erode", 'write all criteria on one card')
      end if
      erosion%given = .true.
    end associate
  end subroutine read_erode

  !> Erosion knows the other cards of its material: the law keeps what it asks for.
  subroutine check_erode(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(fault_t), allocatable :: fault
    integer :: i
    i = word_position(card%word('material'), draft%scene%materials%name)
    if (i == 0 .or. card%failed) return
    call law_set_erosion(card, card%word('material'), draft%scene%materials(i)%law, fault)
    call complain(card, fault, draft)
  end subroutine check_erode

  subroutine read_viscosity(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: i, first, last
    first = 1
    last = size(draft%scene%materials)
    if (card%word('material') /= 'all') then
      first = draft%material_of(card)
      last = first
    end if
    if (first == 0) return
    do i = first, last
      call law_set_viscosity(card, draft%scene%materials(i)%law)
    end do
  end subroutine read_viscosity

end module sgmp_cards_material
