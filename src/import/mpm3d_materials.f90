!> Materials, equations of state and bulk viscosity of an MPM3D deck as native cards.
module sgmp_mpm3d_materials
  use sgmp_constitutive, only: eos_names, material_names
  use sgmp_import_notes, only: import_notes_t, note_approximated, note_honoured
  use sgmp_kinds, only: dp
  use sgmp_mpm3d_deck, only: mpm3d_deck_t, mpm3d_given, mpm3d_material_t, mpm3d_place
  use sgmp_mpm3d_particles, only: cloud_t
  use sgmp_mpm3d_words, only: mpm3d_words_t
  use sgmp_native_deck, only: native_deck_t
  use sgmp_spelling, only: word_item
  use sgmp_text, only: integer_text, real_text_tidy
  implicit none
  private
  public :: materials_write

  integer, parameter :: eos_polynomial = 1, eos_gruneisen = 2, eos_jwl = 3, eos_weak = 4

contains

  !> Writes the materials that bodies are made of.
  subroutine materials_write(deck, clouds, words, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    type(mpm3d_words_t), intent(inout) :: words
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    integer :: i, b
    character(:), allocatable :: name
    call native%section('materials')
    do i = 1, size(deck%materials)
      associate (material => deck%materials(i))
        name = 'material_'//integer_text(i)
        if (.not. any([(deck%parts(b)%material == i, b=1, size(clouds))])) then
          call notes%add(note_honoured, material%place, trim(material%kind), &
                         'left out: no body is made of it')
          cycle
        end if
        call native%from(material%place)
        call write_law(material, name, words, native, notes)
        call native%from(material%eos_place)
        call write_eos(material, name, words, native, notes)
        call native%from(material%place)
        call write_viscosity(deck, material, name, native, notes)
      end associate
    end do
    if (mpm3d_given(deck, 'mate')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'mate'), 'material', 'a card material for each set')
  end subroutine materials_write

  !> The card material.
  subroutine write_law(material, name, words, native, notes)
    type(mpm3d_material_t), intent(in) :: material
    character(*), intent(in) :: name
    type(mpm3d_words_t), intent(inout) :: words
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: card, solid
    integer :: status
    associate (c => material%constant)
      solid = keys(c(2:3), 'young poisson')
      status = note_honoured
      select case (material%kind)
      case ('elas')
        card = 'elastic'//solid
      case ('neoh')
        card = 'neo_hookean'//solid
      case ('pla1')
        card = 'j2'//solid//keys(c(4:4), 'yield')
      case ('pla2')
        if (c(5) >= c(2)) then
          call words%errors%add(material%place, 'pla2: the tangent modulus is not below '// &
                                "Young's modulus", 'check the order: density E nu yield Et')
          return
        end if
        card = 'j2'//solid//keys(c(4:4), 'yield')//' hardening=linear'// &
               keys([c(2)*c(5)/(c(2) - c(5))], 'hardening_modulus')
      case ('sjc', 'sjcf')
        card = flow(c(4:7), c(8), solid)
        if (material%kind == 'sjcf') card = card//' failure=yes'//keys(c(9:9), 'd1')
      case ('john', 'jcf')
        card = flow(c(4:7), c(12), solid)//' thermal=yes taylor_quinney=1'// &
               keys(c(8:11), 'thermal_exponent room_temperature melt_temperature specific_heat')
        if (material%kind == 'jcf') card = card//' failure=yes'//keys(c(13:13), 'd1')
      case ('hiex')
        card = 'explosive'//keys(c(2:2), 'detonation_speed')
      case ('null')
        card = 'fluid'//keys(c(3:3), 'viscosity')
      case ('dpm')
        call write_soil(c, solid, card)
        if (card == '') then
          call words%errors%add(material%place, 'dpm: a cone that is none: qphi must lie '// &
                                'between 0 and sqrt(3), qpsi not above it, kphi and tenf not '// &
                                'below 0', &
                                'check the order: density E nu qphi kphi qpsi tenf')
          return
        end if
      case default
        card = ''
      end select
      if (card /= '') then
        if (.not. any(material_names == word_item(card, 1))) card = ''
      end if
      if (card == '') then
        call words%errors%add(material%place, trim(material%kind)//': this material is not '// &
                              'available here', 'see sgmp help material for those that are')
        return
      end if
      call native%add('material '//name//' '//word_item(card, 1)//keys(c(1:1), 'density')// &
                      card(len(word_item(card, 1)) + 1:))
    end associate
    call note_law(material, word_item(card, 1), notes)
  end subroutine write_law

  !> Drucker-Prager: the cone sqrt(J2) + qphi s <= kphi, s the mean stress, by the angles and the
  !! cohesion of the Mohr-Coulomb hexagon whose compressive edges it touches; '' where none does.
  pure subroutine write_soil(c, solid, card)
    real(dp), intent(in) :: c(:)     !! density E nu qphi kphi qpsi tension
    character(*), intent(in) :: solid
    character(:), allocatable, intent(out) :: card
    real(dp), parameter :: degree = acos(-1.0_dp)/180.0_dp
    real(dp) :: sines(2)
    card = ''
    sines = 3.0_dp*c([4, 6])/(sqrt(12.0_dp) + c([4, 6]))
    if (c(4) <= 0.0_dp .or. c(5) < 0.0_dp .or. c(6) < 0.0_dp .or. c(7) < 0.0_dp) return
    if (sines(1) >= 1.0_dp .or. sines(2) > sines(1)) return
    card = 'drucker_prager'//solid//keys(asin(sines)/degree, 'friction dilatancy')// &
           keys([c(5)*(sqrt(3.0_dp) - sines(1)/sqrt(3.0_dp))/(2.0_dp*sqrt(1.0_dp - sines(1)**2))], &
                'cohesion')
    if (c(7) < c(5)/c(4)) card = card//keys(c(7:7), 'tension')
  end subroutine write_soil

  !> Johnson-Cook without temperature; constants that have no effect are left out.
  pure function flow(abnc, rate, solid) result(card)
    real(dp), intent(in) :: abnc(4)  !! A, B, n, C
    real(dp), intent(in) :: rate     !! at which the rate factor is 1
    character(*), intent(in) :: solid
    character(:), allocatable :: card
    card = 'johnson_cook'//solid//keys(abnc(1:1), 'yield')
    if (abs(abnc(2)) > 0.0_dp) card = card//keys(abnc(2:3), 'hardening_modulus hardening_exponent')
    if (abs(abnc(4)) > 0.0_dp) card = card//keys([abnc(4), rate], 'rate_coefficient reference_rate')
  end function flow

  subroutine note_law(material, kind, notes)
    type(mpm3d_material_t), intent(in) :: material
    character(*), intent(in) :: kind
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: keyword
    keyword = trim(material%kind)
    select case (keyword)
    case ('john')
      call notes%add(note_honoured, material%place, keyword, kind//': all plastic work heats '// &
                     '(taylor_quinney=1), from 293, as in MPM3D; 0.9 is usual for metals')
    case ('sjcf')
      call notes%add(note_approximated, material%place, keyword, kind//' with d1 alone, a '// &
                     'constant failure strain; a failed particle keeps its pressure in compression')
    case ('jcf')
      call notes%add(note_approximated, material%place, keyword, kind//' with d1 alone: '// &
                     'strength is whole until the damage is 1; in MPM3D it falls with it')
    case ('neoh')
      call notes%add(note_approximated, material%place, keyword, kind//': compressible, with '// &
                     'the same moduli; the volumetric term of its energy may be another')
    case ('dpm')
      call notes%add(note_honoured, material%place, keyword, kind//': the same cone, its slope '// &
                     'as an angle, its size as a cohesion; tension is the largest mean stress')
    case default
      call notes%add(note_honoured, material%place, keyword, kind)
    end select
  end subroutine note_law

  !> The card eos.
  subroutine write_eos(material, name, words, native, notes)
    type(mpm3d_material_t), intent(in) :: material
    character(*), intent(in) :: name
    type(mpm3d_words_t), intent(inout) :: words
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: card
    if (material%eos == 0) then
      if (material%kind == 'hiex' .or. material%kind == 'null') call words%errors%add( &
        material%place, trim(material%kind)//' needs an equation of state', 'add seos')
      return
    end if
    if (material%kind == 'elas' .or. material%kind == 'neoh' .or. material%kind == 'dpm') then
      call notes%add(note_approximated, material%eos_place, 'seos', 'left out: '// &
                     trim(material%kind)//' has its pressure from its moduli, in MPM3D, too')
      return
    end if
    associate (c => material%eos_constant)
      select case (material%eos)
      case (eos_polynomial)
        card = 'polynomial'//keys(c, 'a0 a1 a2 a3 b0 b1 b2 energy0')
      case (eos_gruneisen)
        card = 'gruneisen'//keys(c(:4), 'c0 s gamma0 energy0')//' expansion=cold'
      case (eos_jwl)
        card = 'jwl'//keys(c(:6), 'a b r1 r2 omega energy0')
      case default
        card = 'polynomial'//keys([merge(material%constant(2), material%constant(1)*c(1)**2, &
                                         material%kind == 'null')], 'a1')
      end select
    end associate
    if (.not. any(eos_names == word_item(card, 1)) .or. &
        (material%kind == 'hiex' .and. material%eos /= eos_jwl)) then
      call words%errors%add(material%eos_place, 'seos '//integer_text(material%eos)// &
                            ': this equation is not available here for '//trim(material%kind), &
                            'see sgmp help eos for those that are')
      return
    end if
    call native%add('eos '//name//' '//card)
    call note_eos(material, word_item(card, 1), notes)
  end subroutine write_eos

  subroutine note_eos(material, kind, notes)
    type(mpm3d_material_t), intent(in) :: material
    character(*), intent(in) :: kind
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: also
    integer :: status
    status = note_honoured
    also = ''
    if (material%kind == 'john' .or. material%kind == 'pla1' .or. material%kind == 'pla2') then
      status = note_approximated
      also = '; it acts, where MPM3D takes the pressure of '//trim(material%kind)// &
             ' from its moduli'
    else if (material%eos /= eos_weak .and. material%kind == 'null') then
      status = note_approximated
      also = '; as it is given: MPM3D overwrites its first constant with the speed of sound'
    else if (material%eos == eos_gruneisen) then
      also = '; expansion=cold: in expansion the energy does not count, as in MPM3D'
    else if (material%eos == eos_weak .and. material%kind == 'null') then
      also = ', a1 the bulk modulus of the material: MPM3D overwrites the speed that is given'
    end if
    call notes%add(status, material%eos_place, 'seos', kind//also)
  end subroutine note_eos

  !> The card viscosity. MPM3D has it whether `bulk` is given or not, but not in every law: not
  !! where the pressure is of `seos` 1 or 3, nor in total Lagrangian steps; and its linear term only
  !! where particles have a speed of sound.
  subroutine write_viscosity(deck, material, name, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(mpm3d_material_t), intent(in) :: material
    character(*), intent(in) :: name
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    real(dp) :: terms(2)
    character(37), parameter :: words(0:2) = [character(37) :: 'no bulk viscosity', &
                                              'the quadratic term of bulk viscosity', &
                                              'both terms of bulk viscosity']
    character(:), allocatable :: text
    integer :: n
    n = viscosity_terms(material, mpm3d_given(deck, 'tlmp'))
    terms = deck%viscosity
    terms(n + 1:) = 0.0_dp
    if (any(terms > 0.0_dp)) then
      call native%add('viscosity '//name//keys(terms, 'quadratic linear'))
    else if (material%eos > 0) then   ! what the program would give a fast scene
      call native%add('viscosity '//name//' quadratic=0 linear=0')
    end if
    text = name//': of '//trim(material%kind)//' MPM3D has '//trim(words(n))
    if (n > 0) text = text//' (there only where the mean stress is compressive)'
    if (mpm3d_given(deck, 'bulk')) then
      call notes%add(note_honoured, mpm3d_place(deck, 'bulk'), 'bulk', text)
    else
      call notes%add(note_honoured, material%place, trim(material%kind), text)
    end if
  end subroutine write_viscosity

  !> Terms of bulk viscosity that act in MPM3D: 2 quadratic and linear, 1 quadratic, 0 none.
  pure integer function viscosity_terms(material, total_lagrangian) result(terms)
    type(mpm3d_material_t), intent(in) :: material
    logical, intent(in) :: total_lagrangian
    terms = 1
    select case (material%kind)
    case ('elas', 'neoh')
      terms = 2
    case ('sjc', 'sjcf', 'jcf', 'hiex', 'null')  ! their pressure is that of seos
      if (material%kind == 'null') terms = 2
      if (material%eos == eos_polynomial .or. material%eos == eos_jwl) terms = 0
    case default  ! their pressure is that of their moduli
    end select
    if (total_lagrangian) terms = 0
  end function viscosity_terms

  !> ` name=value` for each value.
  pure function keys(values, names) result(text)
    real(dp), intent(in) :: values(:)
    character(*), intent(in) :: names  !! separated by blanks
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(values)
      text = text//' '//word_item(names, i)//'='//real_text_tidy(values(i))
    end do
  end function keys

end module sgmp_mpm3d_materials
