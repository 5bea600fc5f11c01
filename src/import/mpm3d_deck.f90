!> What an MPM3D deck says, entry by entry, before anything is made of it.
module sgmp_mpm3d_deck
  use sgmp_deck_errors, only: position_t
  use sgmp_kinds, only: dp
  use sgmp_mpm3d_words, only: keyword_length, mpm3d_words_t
  use sgmp_spelling, only: word_position
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: mpm3d_deck_t, mpm3d_material_t, mpm3d_part_t, mpm3d_setting_t
  public :: mpm3d_read, mpm3d_keywords, mpm3d_given, mpm3d_place, mpm3d_constants

  character(keyword_length), parameter :: mpm3d_keywords(*) = [character(keyword_length) :: &
    'mpm3', 'nbmp', 'nmat', 'nbbo', 'nbco', 'grid', 'spx', 'spy', 'spz', 'dcel', 'endt', 'outt', &
    'rptt', 'dtsc', 'fixe', 'mate', 'seos', 'part', 'load', 'velo', 'musl', 'usf', 'usl', 'jaum', &
    'gimp', 'bimp', 'sgmp', 'tlmp', 'uvfp', 'bulk', 'damp', 'qulo', 'drda', 'cont', 'deto', &
    'outr', 'curv', 'curx', 'pt2d', 'tecp', 'para', 'smoo', 'endi']

  character(keyword_length), parameter :: material_kinds(*) = [character(keyword_length) :: &
    'elas', 'pla1', 'pla2', 'john', 'sjc', 'sjcf', 'jcf', 'hiex', 'null', 'dpm', 'neoh']
  integer, parameter :: material_numbers(size(material_kinds)) = &
    [3, 4, 5, 12, 8, 9, 13, 2, 3, 7, 3]
  integer, parameter :: eos_numbers(4) = [8, 4, 6, 1]
  integer, parameter :: mpm3d_constants = 13  !! the most that a material has
  integer, parameter :: eos_constants = 8  !! the most that an equation of state has
  character(keyword_length), parameter :: forms(*) = [character(keyword_length) :: &
    'poin', 'bloc', 'sphe', 'blod', 'cicl']
  character(keyword_length), parameter :: variables(*) = [character(keyword_length) :: &
    'seqv', 'epef', 'mat', 'pres', 'volu', 'engk', 'engi', 'velx', 'vely', 'velz', 'cels', &
    'fail', 'sspd', 'damg', 'stsx', 'disx', 'disy', 'disz']
  integer, parameter :: most_rows = 100000        !! particles along an edge
  integer, parameter :: most_particles = 20000000  !! each is made, to find out what it is part of

  !> An entry of `mate`, with its equation of state.
  type :: mpm3d_material_t
    character(keyword_length) :: kind = ''
    real(dp) :: constant(mpm3d_constants) = 0.0_dp
    integer :: eos = 0                         !! 0: none
    real(dp) :: eos_constant(eos_constants) = 0.0_dp
    type(position_t) :: place, eos_place
  end type mpm3d_material_t

  !> An entry of `part`: a body.
  type :: mpm3d_part_t
    character(keyword_length) :: form = ''
    integer :: component = 1, material = 0
    real(dp) :: density = 0.0_dp, spacing = 0.0_dp
    real(dp) :: origin(3) = 0.0_dp              !! corner, or centre of what is round
    integer :: rows(3) = 0                      !! of a block; (1): the radius of what is round
    real(dp) :: hole(3) = 0.0_dp                !! a point of its axis
    integer :: hole_radius = 0                  !! (spacings)
    real(dp), allocatable :: points(:, :)       !! (4, n): mass, x, y, z
    type(position_t) :: place
  end type mpm3d_part_t

  !> A line of `load` or `velo`, or what `deto`, `outr`, `curv`, `curx` ask for.
  type :: mpm3d_setting_t
    character(keyword_length) :: kind = ''
    integer :: number = 0                       !! of the body or particle
    real(dp) :: value(3) = 0.0_dp
    type(position_t) :: place
  end type mpm3d_setting_t

  !> The whole deck.
  type :: mpm3d_deck_t
    character(:), allocatable :: file, title
    type(position_t) :: place(size(mpm3d_keywords))  !! of the last of each keyword; line 0: none
    integer :: particles = 0, material_sets = 0, bodies = 0, components = 1
    real(dp) :: box(2, 3) = 0.0_dp
    real(dp) :: cell = 0.0_dp, end = 0.0_dp, interval = 0.0_dp, courant = 0.9_dp
    integer :: fixed(2, 3) = 0
    logical :: on(size(mpm3d_keywords)) = .false.    !! switches
    real(dp) :: viscosity(2) = [1.5_dp, 0.06_dp]
    real(dp) :: damping = 0.0_dp, ramp = 0.0_dp, friction = 0.0_dp
    integer :: normal = 0
    logical :: contact = .false.
    type(mpm3d_material_t), allocatable :: materials(:)
    type(mpm3d_part_t), allocatable :: parts(:)
    type(mpm3d_setting_t), allocatable :: loads(:), velocities(:), detonations(:), outputs(:)
  end type mpm3d_deck_t

contains

  !> Whether a keyword is in the deck.
  pure function mpm3d_given(deck, keyword) result(given)
    type(mpm3d_deck_t), intent(in) :: deck
    character(*), intent(in) :: keyword
    logical :: given
    given = deck%place(word_position(keyword, mpm3d_keywords))%line > 0
  end function mpm3d_given

  !> Where a keyword stands last.
  pure function mpm3d_place(deck, keyword) result(place)
    type(mpm3d_deck_t), intent(in) :: deck
    character(*), intent(in) :: keyword
    type(position_t) :: place
    place = deck%place(word_position(keyword, mpm3d_keywords))
  end function mpm3d_place

  !> Reads all words up to `endi`; the first that does not fit ends it (`words%failed`).
  subroutine mpm3d_read(words, deck)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(out) :: deck
    character(keyword_length) :: keyword
    deck%file = words%file
    deck%title = ''
    allocate (deck%materials(0), deck%parts(0), deck%loads(0), deck%velocities(0), &
              deck%detonations(0), deck%outputs(0))
    do
      keyword = words%keyword(mpm3d_keywords, 'keywords')
      if (words%failed) return
      if (keyword == '') then
        call words%fail('the deck ends before endi', 'add endi')
        return
      end if
      deck%place(word_position(keyword, mpm3d_keywords)) = words%position
      if (keyword == 'endi') exit
      call read_keyword(words, keyword, deck)
    end do
    call check_counts(words, deck)
  end subroutine mpm3d_read

  !> What follows a keyword.
  subroutine read_keyword(words, keyword, deck)
    type(mpm3d_words_t), intent(inout) :: words
    character(*), intent(in) :: keyword
    type(mpm3d_deck_t), intent(inout) :: deck
    type(mpm3d_setting_t) :: new
    integer :: axis
    select case (keyword)
    case ('mpm3')
      deck%title = words%rest()
    case ('nbmp')
      deck%particles = words%whole(1, most_particles, 'the number of particles')
    case ('nmat')
      deck%material_sets = words%whole(1, 1000, 'the number of materials')
    case ('nbbo')
      deck%bodies = words%whole(1, 100000, 'the number of bodies')
    case ('nbco')
      deck%components = words%whole(1, 1000, 'the number of components')
    case ('grid')
      do axis = 1, 3
        call read_extent(words, deck%box(:, axis))
      end do
    case ('spx', 'spy', 'spz')
      call read_extent(words, deck%box(:, index('xyz', keyword(3:3))))
    case ('dcel')
      deck%cell = positive(words, 'the side of a cell')
    case ('endt')
      deck%end = positive(words, 'the end time')
      deck%interval = deck%end
    case ('outt')
      deck%interval = positive(words, 'the interval')
    case ('rptt')
      associate (interval => positive(words, 'the interval'))
      end associate
    case ('dtsc')
      deck%courant = positive(words, 'the factor of the time step')
      if (deck%courant > 2.5_dp) call words%fail('dtsc is above 2.5', &
                                                 'MPM3D refuses it, too: use a smaller one')
    case ('fixe')
      do axis = 1, 3
        deck%fixed(1, axis) = words%whole(0, 2, 'the condition of a face')
        deck%fixed(2, axis) = words%whole(0, 2, 'the condition of a face')
      end do
    case ('mate')
      call read_materials(words, deck)
    case ('seos')
      call read_eos(words, deck)
    case ('part')
      call read_part(words, deck)
    case ('load')
      call read_settings(words, deck, ['endl', 'part', 'body', 'grav'], 'loads', deck%loads)
    case ('velo')
      call read_settings(words, deck, ['endv', 'node', 'body', 'ksin', 'nuli', 'vsin'], &
                         'velocities', deck%velocities)
    case ('musl', 'usf', 'usl', 'jaum')
      deck%on(word_position(keyword, mpm3d_keywords)) = &
        words%keyword([character(keyword_length) :: 'on', 'off'], 'switches') == 'on'
    case ('bulk')
      deck%viscosity(1) = words%number()
      deck%viscosity(2) = words%number()
    case ('damp')
      deck%damping = words%number()
    case ('qulo')
      deck%ramp = positive(words, 'the time of the ramp')
    case ('cont')
      deck%contact = words%keyword(['lagr', 'othe'], 'kinds of contact') == 'lagr'
      deck%friction = words%number()
      deck%normal = words%whole(0, 2, 'the choice of the normal')
    case ('deto')
      new = mpm3d_setting_t(keyword, 0, [0.0_dp, 0.0_dp, 0.0_dp], words%position)
      new%value = words%vector()
      deck%detonations = [deck%detonations, new]
    case ('outr', 'curv', 'curx')
      call read_output(words, keyword, deck)
    case ('pt2d')
      associate (window => [words%vector(), words%vector()])
      end associate
    case default  ! switches without a value: given is on
    end select
  end subroutine read_keyword

  !> A number above zero.
  function positive(words, what) result(value)
    type(mpm3d_words_t), intent(inout) :: words
    character(*), intent(in) :: what
    real(dp) :: value
    value = words%number()
    if (words%failed .or. value > 0.0_dp) return
    call words%fail(what//' is not positive', 'check the order of the values')
  end function positive

  subroutine read_extent(words, extent)
    type(mpm3d_words_t), intent(inout) :: words
    real(dp), intent(out) :: extent(2)
    extent(1) = words%number()
    extent(2) = words%number()
    if (words%failed .or. extent(2) > extent(1)) return
    call words%fail('the extent is empty', 'the upper end must exceed the lower')
  end subroutine read_extent

  !> The sets of `mate`, one after the other.
  subroutine read_materials(words, deck)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(inout) :: deck
    type(mpm3d_material_t) :: new
    integer :: i, k
    if (deck%material_sets == 0) call words%fail('there is no nmat before material', 'add nmat')
    if (size(deck%materials) > 0) call words%fail('material is given twice', &
                                                  'put all sets into one')
    do i = 1, deck%material_sets
      associate (set => words%whole(i, i, 'the number of the material set'))
      end associate
      new%place = words%position
      new%kind = words%keyword(material_kinds, 'materials')
      if (new%kind == '') call words%fail('the deck ends where a material is expected', &
                                          'add what is missing')
      if (words%failed) return
      new%place = words%position
      new%constant = 0.0_dp
      do k = 1, material_numbers(word_position(new%kind, material_kinds))
        new%constant(k) = words%number()
        if (k == 1 .and. new%constant(1) <= 0.0_dp) then
          call words%fail('the density is not positive', 'check the order of the constants')
        end if
      end do
      if (words%failed) return
      deck%materials = [deck%materials, new]
    end do
  end subroutine read_materials

  subroutine read_eos(words, deck)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(inout) :: deck
    type(position_t) :: place
    integer :: set, kind, k
    place = words%position
    if (size(deck%materials) == 0) call words%fail('seos stands before material', 'move it down')
    set = words%whole(1, size(deck%materials), 'the number of the material set')
    kind = words%whole(1, size(eos_numbers), 'the number of the equation')
    if (words%failed) return
    associate (material => deck%materials(set))
      if (material%eos > 0) call words%fail('this material has an equation of state already', &
                                            'remove one')
      material%eos = kind
      material%eos_place = place
      do k = 1, eos_numbers(kind)
        material%eos_constant(k) = words%number()
      end do
    end associate
  end subroutine read_eos

  !> One body.
  subroutine read_part(words, deck)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(inout) :: deck
    type(mpm3d_part_t) :: part
    part%place = words%position
    if (size(deck%materials) == 0) call words%fail('part stands before material', 'move it down')
    part%form = words%keyword(forms, 'forms of bodies')
    part%component = words%whole(1, 1000, 'the number of the component')
    if (words%failed) return
    if (part%form == 'poin') then
      call read_points(words, deck, part)
    else
      call read_lattice(words, size(deck%materials), part)
    end if
    if (words%failed) return
    if (part%component > deck%components) then
      words%position = part%place
      call words%fail('the body is of component '//integer_text(part%component)//', nbco is '// &
                      integer_text(deck%components), 'make nbco larger, or the component smaller')
    end if
    deck%parts = [deck%parts, part]
  end subroutine read_part

  !> Particles one by one; the material of the last is that of the body.
  subroutine read_points(words, deck, part)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(in) :: deck
    type(mpm3d_part_t), intent(inout) :: part
    integer :: p, n, id
    n = words%whole(1, max(1, deck%particles), 'the number of particles of the body')
    if (words%failed) return
    allocate (part%points(4, n))
    do p = 1, n
      id = words%whole(p, most_particles, 'the number of the particle')
      part%material = words%whole(1, size(deck%materials), 'the number of the material set')
      part%points(1, p) = positive(words, 'the mass')
      part%points(2:, p) = words%vector()
      if (words%failed) return
    end do
  end subroutine read_points

  !> Particles that fill a shape.
  subroutine read_lattice(words, materials, part)
    type(mpm3d_words_t), intent(inout) :: words
    integer, intent(in) :: materials
    type(mpm3d_part_t), intent(inout) :: part
    integer :: i
    part%material = words%whole(1, materials, 'the number of the material set')
    part%density = positive(words, 'the density')
    part%spacing = positive(words, 'the distance of particles')
    part%origin = words%vector()
    select case (part%form)
    case ('bloc', 'blod')
      do i = 1, 3
        part%rows(i) = words%whole(1, most_rows, 'the number of particles along an edge')
      end do
      if (part%form == 'blod') then
        part%hole = words%vector()
        part%hole_radius = words%whole(1, most_rows, 'the radius of the hole in spacings')
      end if
    case default
      part%rows(1) = words%whole(1, 2000, 'the radius in spacings')
    end select
  end subroutine read_lattice

  !> The lines of `load` or `velo` up to the word that ends them.
  subroutine read_settings(words, deck, kinds, what, settings)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(in) :: deck
    character(*), intent(in) :: kinds(:)  !! the first ends the block
    character(*), intent(in) :: what
    type(mpm3d_setting_t), allocatable, intent(inout) :: settings(:)
    type(mpm3d_setting_t), allocatable :: longer(:)
    type(mpm3d_setting_t) :: new
    integer :: n
    if (size(deck%parts) == 0) call words%fail(what//' stand before the bodies', 'move them down')
    n = size(settings)
    do while (.not. words%failed)
      new%kind = words%keyword(kinds, what)
      if (new%kind == '') call words%fail('the deck ends within a block', 'add '//kinds(1))
      if (words%failed .or. new%kind == kinds(1)) exit
      new%place = words%position
      call read_setting(words, deck, new)
      if (n == size(settings)) then
        allocate (longer(2*n + 16))
        longer(:n) = settings
        call move_alloc(longer, settings)
      end if
      n = n + 1
      settings(n) = new
    end do
    settings = settings(:n)
  end subroutine read_settings

  subroutine read_setting(words, deck, setting)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(in) :: deck
    type(mpm3d_setting_t), intent(inout) :: setting
    setting%value = 0.0_dp
    select case (setting%kind)
    case ('part', 'node')
      setting%number = words%whole(1, max(1, deck%particles), 'the number of the particle')
      setting%value = words%vector()
    case ('body', 'grav')
      setting%number = words%whole(1, size(deck%parts), 'the number of the body')
      setting%value = words%vector()
    case ('ksin')
      setting%value(1) = words%number()
      setting%number = words%whole(1, size(deck%parts), 'the number of the body')
    case default  ! nuli, vsin
      setting%value(1) = words%number()
    end select
  end subroutine read_setting

  subroutine read_output(words, keyword, deck)
    type(mpm3d_words_t), intent(inout) :: words
    character(*), intent(in) :: keyword
    type(mpm3d_deck_t), intent(inout) :: deck
    type(mpm3d_setting_t) :: new
    character(keyword_length) :: variable
    real(dp) :: point(3)
    integer :: particle
    variable = words%keyword(variables, 'output variables')
    if (variable == '') call words%fail('the deck ends where a variable is expected', 'add it')
    new = mpm3d_setting_t(variable, 0, [0.0_dp, 0.0_dp, 0.0_dp], words%position)
    if (keyword == 'curv') then
      particle = 1
      if (words%more_on_line()) particle = words%whole(1, max(1, deck%particles), &
                                                       'the number of the particle')
      new%number = particle
    else if (keyword == 'curx') then
      point = words%vector()
      new%value = point
      new%number = -1
    end if
    deck%outputs = [deck%outputs, new]
  end subroutine read_output

  !> What a deck must have, and counts that must agree.
  subroutine check_counts(words, deck)
    type(mpm3d_words_t), intent(inout) :: words
    type(mpm3d_deck_t), intent(in) :: deck
    if (deck%cell <= 0.0_dp) call words%fail('the deck has no cell size', 'add dcell')
    if (deck%end <= 0.0_dp) call words%fail('the deck has no end time', 'add endtime')
    if (any(deck%box(2, :) <= deck%box(1, :))) call words%fail( &
      'the deck has no box along '//trim(empty_axes(deck%box)), 'add grid, or spx spy spz')
    if (size(deck%parts) == 0) call words%fail('the deck has no particles', 'add part')
    if (size(deck%parts) /= deck%bodies) call words%fail( &
      'there are '//integer_text(size(deck%parts))//' bodies, nbbo says '// &
      integer_text(deck%bodies), 'make them agree')
    if (deck%particles == 0) call words%fail('the deck has no nbmp', 'add nbmp')
  end subroutine check_counts

  pure function empty_axes(box) result(names)
    real(dp), intent(in) :: box(2, 3)
    character(3) :: names
    integer :: axis
    names = ''
    do axis = 1, 3
      if (box(2, axis) <= box(1, axis)) names = trim(names)//'xyz'(axis:axis)
    end do
  end function empty_axes

end module sgmp_mpm3d_deck
