!> From what an MPM3D deck says to the cards of a native deck, with a note for every keyword.
module sgmp_mpm3d_native
  use sgmp_deck_errors, only: position_t
  use sgmp_import_notes, only: import_notes_t, note_approximated, note_honoured
  use sgmp_kinds, only: dp
  use sgmp_mpm3d_bodies, only: piece_block, piece_cylinder, piece_file, piece_sphere, piece_t
  use sgmp_mpm3d_deck, only: mpm3d_deck_t, mpm3d_given, mpm3d_keywords, mpm3d_place
  use sgmp_mpm3d_materials, only: materials_write
  use sgmp_mpm3d_outputs, only: outputs_write
  use sgmp_mpm3d_particles, only: cloud_t
  use sgmp_mpm3d_space, only: face_free, space_t
  use sgmp_mpm3d_words, only: mpm3d_words_t
  use sgmp_native_deck, only: native_deck_t, native_vector
  use sgmp_spelling, only: word_position
  use sgmp_text, only: integer_text, real_text_tidy
  implicit none
  private
  public :: native_write, particle_file_name

  real(dp), parameter :: earliest_rest = 100.0_dp  !! MPM3D does not look before
  character(5), parameter :: face_words(0:2) = ['free ', 'fixed', 'slip ']

contains

  !> Writes all cards. What cannot be honoured becomes an error in `words`.
  subroutine native_write(deck, clouds, space, pieces, stem, words, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    type(space_t), intent(in) :: space
    type(piece_t), intent(in) :: pieces(:)
    character(*), intent(in) :: stem            !! of the names of particle files
    type(mpm3d_words_t), intent(inout) :: words
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: title
    call refuse(deck, words)
    title = deck%title(verify(deck%title//'x', '* "'):)
    if (title == '') title = stem
    call native%from(mpm3d_place(deck, 'mpm3'))
    call native%add('title "'//without_quotes(title)//'"')
    call write_parameters(deck, pieces, native, notes)
    call write_space(deck, space, native, notes)
    call write_method(deck, native, notes)
    call materials_write(deck, clouds, words, native, notes)
    call write_bodies(deck, pieces, space, stem, native)
    call write_loads(deck, pieces, space, native, notes)
    call write_contact(deck, pieces, words, native, notes)
    call write_detonations(deck, space, native, notes)
    call outputs_write(deck, clouds, space, native, notes)
    call note_counts(deck, clouds, notes)
  end subroutine native_write

  !> Name of the file of a body's particles.
  pure function particle_file_name(stem, piece) result(name)
    character(*), intent(in) :: stem
    type(piece_t), intent(in) :: piece
    character(:), allocatable :: name
    name = stem//'_'//piece%name//'.txt'
  end function particle_file_name

  pure function without_quotes(text) result(plain)
    character(*), intent(in) :: text
    character(len(text)) :: plain
    integer :: i
    plain = text
    do i = 1, len(text)
      if (text(i:i) == '"' .or. text(i:i) == '$' .or. iachar(text(i:i)) < 32 .or. &
          iachar(text(i:i)) > 126) plain(i:i) = ' '
    end do
  end function without_quotes

  !> Keywords of what the solver does not have.
  subroutine refuse(deck, words)
    type(mpm3d_deck_t), intent(in) :: deck
    type(mpm3d_words_t), intent(inout) :: words
    if (deck%damping < 0.0_dp) call words%errors%add( &
      mpm3d_place(deck, 'damp'), 'Damp is negative: it would drive what moves', &
      'check the sign')
    if (count([mpm3d_given(deck, 'gimp'), mpm3d_given(deck, 'bimp'), &
               mpm3d_given(deck, 'sgmp')]) > 1) call words%errors%add( &
      mpm3d_place(deck, merge('sgmp', 'bimp', mpm3d_given(deck, 'sgmp'))), &
      'more than one of gimp, bimp, sgmp', 'keep one')
  end subroutine refuse

  subroutine write_parameters(deck, pieces, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(piece_t), intent(in) :: pieces(:)
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    call native%section('parameters: --set h=… replaces one')
    call native%from(mpm3d_place(deck, 'dcel'))
    call native%parameter('h', real_text_tidy(deck%cell), 'side of a grid cell')
    if (common_spacing(pieces) > 0.0_dp) then
      call native%parameter('spacing', real_text_tidy(common_spacing(pieces)), &
                            'distance of particles')
    end if
    call native%from(mpm3d_place(deck, 'endt'))
    if (mpm3d_given(deck, 'qulo')) then
      call native%parameter('t_end', real_text_tidy(max(deck%end, earliest_rest)), &
                            'earliest end: when at rest')
      call notes%add(note_approximated, mpm3d_place(deck, 'qulo'), 'QuLo', 'the run ends at '// &
                     'rest, the kinetic energy below 0.005 of kinetic and internal, from '// &
                     'endtime on and not before 100, as in MPM3D; at the latest at ten times that')
    else
      call native%parameter('t_end', real_text_tidy(deck%end), 'end time')
    end if
    if (mpm3d_given(deck, 'dtsc')) call native%from(mpm3d_place(deck, 'dtsc'))
    call native%parameter('cfl', real_text_tidy(deck%courant), 'Courant number')
    call notes%add(note_honoured, mpm3d_place(deck, 'dcel'), 'dcell', 'grid cell=h')
    call notes%add(note_honoured, mpm3d_place(deck, 'endt'), 'endtime', 'time end=t_end')
    if (mpm3d_given(deck, 'dtsc')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'dtsc'), 'dtscale', &
      'time cfl=cfl, with the current sound speed and the velocity of the particles')
  end subroutine write_parameters

  !> The distance of particles of all bodies with a lattice, 0 where they differ.
  pure function common_spacing(pieces) result(spacing)
    type(piece_t), intent(in) :: pieces(:)
    real(dp) :: spacing
    integer :: i
    spacing = 0.0_dp
    do i = 1, size(pieces)
      if (pieces(i)%shape == piece_file) cycle
      if (spacing > 0.0_dp .and. abs(pieces(i)%spacing - spacing) > 1.0e-9_dp*spacing) then
        spacing = 0.0_dp
        return
      end if
      spacing = pieces(i)%spacing
    end do
  end function common_spacing

  subroutine write_space(deck, space, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(space_t), intent(in) :: space
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: grid, wall, free
    integer :: k, axis, side
    call native%section('space: walls lie where they act')
    call native%from(mpm3d_place(deck, 'dcel'))
    call native%add('dimension '//integer_text(size(space%axes)))
    grid = 'grid cell=h'
    wall = ''
    free = ''
    do k = 1, size(space%axes)
      axis = space%axes(k)
      grid = grid//' '//'xyz'(k:k)//'='//end_of(space%lower(axis), space%open(1, axis))//':'// &
             end_of(space%upper(axis), space%open(2, axis))
      do side = 1, 2
        if (space%face(side, axis) /= face_free) then
          wall = wall//' '//'xyz'(k:k)//'-+'(side:side)//'='// &
                 trim(face_words(space%face(side, axis)))
        else if (.not. space%open(side, axis)) then
          free = free//' '//'xyz'(k:k)//'-+'(side:side)
        end if
      end do
    end do
    call native%add(grid)
    if (mpm3d_given(deck, 'fixe')) call native%from(mpm3d_place(deck, 'fixe'))
    if (wall /= '') call native%add('wall'//wall//' shift=none')
    if (free /= '') call native%add('lost remove  ! through'//free)
    call note_space(deck, wall /= '', free, notes)
  end subroutine write_space

  subroutine note_space(deck, walls, free, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    logical, intent(in) :: walls      !! there are any
    character(*), intent(in) :: free  !! closed faces without a wall
    type(import_notes_t), intent(inout) :: notes
    character(4) :: keyword
    integer :: i
    do i = 1, 4
      keyword = trim(mpm3d_keywords(word_position('grid', mpm3d_keywords) + i - 1))
      if (mpm3d_given(deck, keyword)) call notes%add( &
        note_honoured, mpm3d_place(deck, keyword), trim(keyword), &
        'extent of the grid, a whole number of cells')
    end do
    if (mpm3d_given(deck, 'fixe')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'fixe'), 'fixed', 'wall; 1 is fixed, 2 is slip')
    if (walls .and. (mpm3d_given(deck, 'sgmp') .or. mpm3d_given(deck, 'gimp') .or. &
                     mpm3d_given(deck, 'bimp'))) then
      call notes%add(note_honoured, mpm3d_place(deck, 'fixe'), 'fixed', 'walls lie one cell '// &
                     'within the box, at the second plane of nodes, where MPM3D has them, too')
    end if
    if (free /= '') call notes%add( &
      note_approximated, mpm3d_place(deck, merge('fixe', 'dcel', mpm3d_given(deck, 'fixe'))), &
      'fixed', 'what leaves through the free faces'//free//' is removed and counted; MPM3D '// &
      'leaves it where it is')
  end subroutine note_space

  pure function end_of(x, open) result(text)
    real(dp), intent(in) :: x
    logical, intent(in) :: open
    character(:), allocatable :: text
    text = 'open'
    if (.not. open) text = real_text_tidy(x)
  end function end_of

  subroutine write_method(deck, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: method, update
    method = 'mpm'
    if (mpm3d_given(deck, 'gimp')) method = 'gimp'
    if (mpm3d_given(deck, 'bimp')) method = 'bspline'
    if (mpm3d_given(deck, 'sgmp')) method = 'sgmp'
    update = 'musl'
    if (deck%on(word_position('usf', mpm3d_keywords))) update = 'usf'
    if (deck%on(word_position('usl', mpm3d_keywords))) update = 'usl'
    if (deck%on(word_position('musl', mpm3d_keywords))) update = 'musl'
    call native%section('numerics')
    call native%from(method_place(deck))
    if (in_first_shape(deck)) method = method//' frame=reference'
    call native%add('method '//method//' update='//update)
    call native%from(mpm3d_place(deck, 'endt'))
    if (mpm3d_given(deck, 'qulo')) then
      call native%add('time end=10*t_end cfl=$cfl')
      call native%add('stop at_rest=0.005 after=t_end')
    else
      call native%add('time end=t_end cfl=$cfl')
    end if
    call write_damping(deck, native, notes)
    call note_switches(deck, update, notes)
    if (mpm3d_given(deck, 'bimp')) call notes%add(note_honoured, mpm3d_place(deck, 'bimp'), &
                                                  'bimp', 'method bspline')
    if (mpm3d_given(deck, 'sgmp')) call notes%add(note_honoured, mpm3d_place(deck, 'sgmp'), &
                                                  'sgmp', 'method sgmp')
    if (mpm3d_given(deck, 'gimp')) call notes%add( &
      note_approximated, mpm3d_place(deck, 'gimp'), 'gimp', &
      'method gimp: a particle is as wide as its own volume; in MPM3D always half a cell')
    if (in_first_shape(deck)) then
      call notes%add(note_honoured, mpm3d_place(deck, 'tlmp'), 'TLmp', 'frame=reference')
    else if (mpm3d_given(deck, 'tlmp')) then
      call notes%add( &
        note_approximated, mpm3d_place(deck, 'tlmp'), 'TLmp', &
        'runs updated-Lagrangian: particles cross cells, and bodies can separate numerically; '// &
        'faces and walls that nothing touches at the start give way, as there')
    end if
    if (mpm3d_given(deck, 'uvfp')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'uvfp'), 'UVFp', 'volumes follow the deformation anyway')
  end subroutine write_method

  !> Whether total Lagrangian motion is what frame=reference computes: solids without an equation
  !! of state, which no card lets fail, and no contact.
  pure logical function in_first_shape(deck) result(yes)
    type(mpm3d_deck_t), intent(in) :: deck
    character(4), parameter :: solids(*) = ['elas', 'pla1', 'pla2', 'neoh']
    integer :: m
    yes = mpm3d_given(deck, 'tlmp') .and. .not. (mpm3d_given(deck, 'cont') .or. &
                                                 mpm3d_given(deck, 'bimp') .or. &
                                                 mpm3d_given(deck, 'sgmp'))
    do m = 1, size(deck%materials)
      yes = yes .and. any(deck%materials(m)%kind == solids) .and. deck%materials(m)%eos == 0
    end do
  end function in_first_shape

  !> Where the method is said.
  pure function method_place(deck) result(place)
    type(mpm3d_deck_t), intent(in) :: deck
    type(position_t) :: place
    character(4), parameter :: keywords(*) = ['musl', 'usf ', 'usl ', 'gimp', 'bimp', 'sgmp']
    integer :: i
    place = mpm3d_place(deck, 'dcel')
    do i = 1, size(keywords)
      if (mpm3d_given(deck, trim(keywords(i)))) place = mpm3d_place(deck, trim(keywords(i)))
    end do
  end function method_place

  subroutine note_switches(deck, update, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    character(*), intent(in) :: update
    type(import_notes_t), intent(inout) :: notes
    character(4), parameter :: schemes(3) = ['musl', 'usf ', 'usl ']
    integer :: i
    do i = 1, size(schemes)
      if (.not. mpm3d_given(deck, trim(schemes(i)))) cycle
      if (deck%on(word_position(schemes(i), mpm3d_keywords)) .and. schemes(i) /= update) then
        call notes%add(note_approximated, mpm3d_place(deck, trim(schemes(i))), trim(schemes(i)), &
                       'one scheme at a time: '//update//' is taken; in MPM3D all that are on act')
      else
        call notes%add(note_honoured, mpm3d_place(deck, trim(schemes(i))), trim(schemes(i)), &
                       'method update='//update)
      end if
    end do
    if (mpm3d_given(deck, 'jaum')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'jaum'), 'jaum', &
      'stress is always turned with the material, as in MPM3D, which does not use this word')
  end subroutine note_switches

  subroutine write_bodies(deck, pieces, space, stem, native)
    type(mpm3d_deck_t), intent(in) :: deck
    type(piece_t), intent(in) :: pieces(:)
    type(space_t), intent(in) :: space
    character(*), intent(in) :: stem
    type(native_deck_t), intent(inout) :: native
    character(:), allocatable :: spacing, tail
    integer :: i, d
    d = size(space%axes)
    call native%section('bodies')
    spacing = ''
    if (common_spacing(pieces) > 0.0_dp) spacing = ' spacing=spacing'
    do i = 1, size(pieces)
      associate (piece => pieces(i), part => deck%parts(pieces(i)%first))
        call native%from(part%place)
        tail = ' material=material_'//integer_text(part%material)
        if (piece%shape /= piece_file .and. spacing == '') then
          tail = tail//' spacing='//real_text_tidy(piece%spacing)
        else if (piece%shape /= piece_file) then
          tail = tail//spacing
        end if
        select case (deck%materials(part%material)%kind)
        case ('john', 'jcf')
          tail = tail//' temperature=293'
        case default  ! no temperature
        end select
        if (size(pieces) > 1) tail = tail//' overlap=allow'
        if (any(piece%shape == [piece_cylinder, piece_sphere]) .or. &
            (piece%hole .and. piece%shape == piece_block)) then
          tail = tail//' fit=cubes'  ! as MPM3D counts particles
        end if
        call native%add('body '//piece%name//' '//shape_text(piece, space, stem)//tail)
        if (piece%hole .and. piece%shape /= piece_file) call native%add( &
          'subtract '//piece%name//' '//round_text(piece, space, piece%upper(3) - piece%lower(3)))
        call write_velocity(piece, space, native)
      end associate
    end do
  end subroutine write_bodies

  !> Words and keys of a body's shape.
  pure function shape_text(piece, space, stem) result(text)
    type(piece_t), intent(in) :: piece
    type(space_t), intent(in) :: space
    character(*), intent(in) :: stem
    character(:), allocatable :: text
    select case (piece%shape)
    case (piece_block)
      text = 'block lower='//native_vector(piece%lower(space%axes))//' upper='// &
             native_vector(piece%upper(space%axes))
    case (piece_cylinder)
      text = round_text(piece, space, piece%length)
    case (piece_sphere)
      text = 'sphere centre='//native_vector(piece%centre)//' radius='//real_text_tidy(piece%radius)
    case default
      text = 'file file="'//particle_file_name(stem, piece)//'"'
    end select
  end function shape_text

  !> A cylinder about z.
  pure function round_text(piece, space, length) result(text)
    type(piece_t), intent(in) :: piece
    type(space_t), intent(in) :: space
    real(dp), intent(in) :: length
    character(:), allocatable :: text
    text = 'cylinder centre='//native_vector(piece%centre(space%axes))//' radius='// &
           real_text_tidy(piece%radius)
    if (size(space%axes) == 3) text = text//' axis=(0,0,1) length='//real_text_tidy(length)
  end function round_text

  subroutine write_velocity(piece, space, native)
    type(piece_t), intent(in) :: piece
    type(space_t), intent(in) :: space
    type(native_deck_t), intent(inout) :: native
    character(:), allocatable :: card
    integer :: k
    card = ''
    if (piece%shape /= piece_file .and. piece%formula /= '') then
      card = ' '//space%name(piece%formula_axis)//'="'//piece%formula//'"'
    else if (piece%moves_as_one) then
      do k = 1, size(space%axes)
        if (abs(piece%velocity(space%axes(k))) > 0.0_dp) card = card//' '//'xyz'(k:k)//'='// &
          real_text_tidy(piece%velocity(space%axes(k)))
      end do
    end if
    if (card /= '') call native%add('velocity '//piece%name//card)
  end subroutine write_velocity

  subroutine write_damping(deck, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: card
    card = ''
    if (mpm3d_given(deck, 'damp')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'damp'), 'Damp', 'damping rate')
    if (deck%damping > 0.0_dp) card = ' rate='//real_text_tidy(deck%damping)
    if (mpm3d_given(deck, 'drda')) then
      card = card//' kinetic=yes'
      call notes%add(note_honoured, mpm3d_place(deck, 'drda'), 'drda', 'damping kinetic=yes')
    end if
    call native%from(mpm3d_place(deck, merge('drda', 'damp', mpm3d_given(deck, 'drda'))))
    if (card /= '') call native%add('damping'//card)
  end subroutine write_damping

  !> Gravity and forces as forces per mass.
  subroutine write_loads(deck, pieces, space, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(piece_t), intent(in) :: pieces(:)
    type(space_t), intent(in) :: space
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    integer :: i
    if (mpm3d_given(deck, 'qulo')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'qulo'), 'QuLo', 'forces on particles rise over this time')
    do i = 1, size(deck%loads)
      call notes%add(note_honoured, deck%loads(i)%place, 'load', 'bodyforce: force per mass')
    end do
    do i = 1, size(deck%velocities)
      call notes%add(note_honoured, deck%velocities(i)%place, 'velo', &
                     'velocity, or columns of a particle file')
    end do
    if (size(deck%loads) == 0) return
    call native%section('loads: forces per mass')
    call native%from(deck%loads(1)%place)
    if (mpm3d_given(deck, 'qulo')) then
      call native%parameter('t_ramp', real_text_tidy(deck%ramp), 'forces rise over this time')
    end if
    do i = 1, size(pieces)
      call write_load(pieces(i), mpm3d_given(deck, 'qulo'), space, native)
    end do
  end subroutine write_loads

  subroutine write_load(piece, ramped, space, native)
    type(piece_t), intent(in) :: piece
    logical, intent(in) :: ramped
    type(space_t), intent(in) :: space
    type(native_deck_t), intent(inout) :: native
    character(:), allocatable :: card, formula
    integer :: k
    card = ''
    do k = 1, size(space%axes)
      associate (force => piece%force(space%axes(k)), gravity => piece%gravity(space%axes(k)))
        formula = ''
        if (abs(gravity) > 0.0_dp) formula = real_text_tidy(gravity)
        if (abs(force) > 0.0_dp) then
          if (formula /= '' .and. force > 0.0_dp) formula = formula//'+'
          formula = formula//real_text_tidy(force)
          if (ramped) formula = formula//'*min(t/t_ramp,1)'
        end if
        if (formula /= '') card = card//' '//'xyz'(k:k)//'="'//formula//'"'
      end associate
    end do
    if (card /= '') call native%add('bodyforce '//piece%name//card)
  end subroutine write_load

  !> Contact between all bodies of different components; those of one component stick together.
  subroutine write_contact(deck, pieces, words, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(piece_t), intent(in) :: pieces(:)
    type(mpm3d_words_t), intent(inout) :: words
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(7), parameter :: normals(0:2) = ['average', 'first  ', 'second ']
    integer :: i, component(size(pieces))
    component = [(deck%parts(pieces(i)%first)%component, i=1, size(pieces))]
    if (all(component == component(1))) then
      if (mpm3d_given(deck, 'cont')) call notes%add( &
        note_honoured, mpm3d_place(deck, 'cont'), 'cont', 'nothing to do: there is one component')
      call write_group(deck, pieces, 'all_bodies', spread(.true., 1, size(pieces)), native)
      return
    end if
    i = findloc(component == component(1), .false., 1)
    if (.not. mpm3d_given(deck, 'cont')) then
      call notes%add(note_honoured, deck%parts(pieces(i)%first)%place, 'particle', 'without '// &
                     'cont all components share one field: their bodies stick together where '// &
                     'they meet, as in MPM3D')
      call write_group(deck, pieces, 'all_bodies', spread(.true., 1, size(pieces)), native)
      return
    end if
    if (.not. deck%contact) then
      call words%errors%add( &
        deck%parts(pieces(i)%first)%place, 'with cont othe bodies of different components go '// &
        'through each other in MPM3D, which they cannot here', &
        'use `cont lagr 0 0`, or leave cont out: then they stick together')
      return
    end if
    call native%from(mpm3d_place(deck, 'cont'))
    call notes%add(note_approximated, mpm3d_place(deck, 'cont'), 'cont', 'contact normal='// &
                   trim(normals(deck%normal))//': bodies touch where their particles are '// &
                   'closer than the mean of their spacings; in MPM3D as soon as they share a '// &
                   'node'//trim(merge(', and only components 1 and 2', repeat(' ', 29), &
                              any(component > 2))))
    call native%section('contact')
    call write_pairs(deck, pieces, component, ' friction='//real_text_tidy(deck%friction)// &
                     ' normal='//trim(normals(deck%normal)), native)
  end subroutine write_contact

  !> A card for each pair of components, and a group for each that is of several bodies.
  subroutine write_pairs(deck, pieces, component, keys, native)
    type(mpm3d_deck_t), intent(in) :: deck
    type(piece_t), intent(in) :: pieces(:)
    integer, intent(in) :: component(:)          !! of the pieces
    character(*), intent(in) :: keys             !! of all cards `contact`
    type(native_deck_t), intent(inout) :: native
    integer :: i, k, pair(2)
    logical :: leads(size(pieces))               !! the first of its component
    leads = [(findloc(component, component(i), 1) == i, i=1, size(pieces))]
    do i = 1, size(pieces)
      if (leads(i)) call write_group(deck, pieces, group_name(component(i)), &
                                     component == component(i), native)
    end do
    do i = 1, size(pieces)
      do k = i + 1, size(pieces)
        if (component(i) == component(k)) cycle
        if (is_grouped(deck, pieces, component == component(i)) .and. .not. leads(i)) cycle
        if (is_grouped(deck, pieces, component == component(k)) .and. .not. leads(k)) cycle
        pair = merge([i, k], [k, i], component(i) < component(k))
        call native%add('contact '//side(pair(1))//' '//side(pair(2))//keys)
      end do
    end do
  contains

    function side(piece) result(name)
      integer, intent(in) :: piece
      character(:), allocatable :: name
      name = pieces(piece)%name
      if (is_grouped(deck, pieces, component == component(piece))) then
        name = group_name(component(piece))
      end if
    end function side

  end subroutine write_pairs

  pure function group_name(component) result(name)
    integer, intent(in) :: component
    character(:), allocatable :: name
    name = 'component_'//integer_text(component)
  end function group_name

  !> Whether pieces that share a field in MPM3D need a group to do so: several, not all of which
  !! flow.
  pure function is_grouped(deck, pieces, together) result(yes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(piece_t), intent(in) :: pieces(:)
    logical, intent(in) :: together(:)           !! which pieces
    logical :: yes
    integer :: i
    yes = .false.
    if (count(together) < 2) return
    do i = 1, size(pieces)
      if (.not. together(i) .or. deck%parts(pieces(i)%first)%material == 0) cycle
      associate (kind => deck%materials(deck%parts(pieces(i)%first)%material)%kind)
        yes = yes .or. .not. any(kind == [character(4) :: 'hiex', 'null'])
      end associate
    end do
  end function is_grouped

  subroutine write_group(deck, pieces, name, together, native)
    type(mpm3d_deck_t), intent(in) :: deck
    type(piece_t), intent(in) :: pieces(:)
    character(*), intent(in) :: name
    logical, intent(in) :: together(:)           !! which pieces
    type(native_deck_t), intent(inout) :: native
    character(:), allocatable :: names
    integer :: i
    if (.not. is_grouped(deck, pieces, together)) return
    names = ''
    do i = 1, size(pieces)
      if (together(i)) names = names//','//pieces(i)%name
    end do
    call native%add('group '//name//' '//names(2:))
  end subroutine write_group

  subroutine write_detonations(deck, space, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(space_t), intent(in) :: space
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    integer :: i
    if (size(deck%detonations) == 0) return
    call native%add('')
    do i = 1, size(deck%detonations)
      associate (setting => deck%detonations(i))
        call native%from(setting%place)
        call native%add('detonation point='//native_vector(setting%value(space%axes)))
        if (size(space%axes) == 3) then
          call notes%add(note_honoured, setting%place, 'deto', 'detonation')
        else
          call notes%add(note_approximated, setting%place, 'deto', &
                         'detonation; distances are measured along the axes that are left')
        end if
      end associate
    end do
  end subroutine write_detonations

  !> Counts: nothing here depends on them.
  subroutine note_counts(deck, clouds, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    type(import_notes_t), intent(inout) :: notes
    character(4), parameter :: counts(3) = ['nmat', 'nbbo', 'nbco']
    integer :: i, n
    if (mpm3d_given(deck, 'mpm3')) call notes%add(note_honoured, mpm3d_place(deck, 'mpm3'), &
                                                  'mpm3d', 'title')
    n = clouds(size(clouds))%first - 1 + size(clouds(size(clouds))%mass)
    if (n == deck%particles) then
      call notes%add(note_honoured, mpm3d_place(deck, 'nbmp'), 'nbmp', &
                     integer_text(n)//' particles')
    else
      call notes%add(note_approximated, mpm3d_place(deck, 'nbmp'), 'nbmp', 'the bodies have '// &
                     integer_text(n)//' particles, not '//integer_text(deck%particles)// &
                     '; MPM3D does not use the others, either')
    end if
    do i = 1, size(counts)
      if (mpm3d_given(deck, counts(i))) call notes%add( &
        note_honoured, mpm3d_place(deck, counts(i)), counts(i), 'agrees with what is there')
    end do
  end subroutine note_counts

end module sgmp_mpm3d_native
