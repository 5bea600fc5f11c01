!> Bodies of an MPM3D deck as bodies of a native deck: shapes with a lattice where that is what they
!! are, particle files otherwise.
module sgmp_mpm3d_bodies
  use sgmp_import_notes, only: import_notes_t, note_honoured
  use sgmp_kinds, only: dp
  use sgmp_mpm3d_deck, only: mpm3d_deck_t, mpm3d_part_t
  use sgmp_mpm3d_particles, only: beam_velocity, cloud_t, cloud_uniform, &
                                  lattice_tolerance, pi_there
  use sgmp_mpm3d_space, only: space_t
  use sgmp_mpm3d_words, only: mpm3d_words_t
  use sgmp_text, only: integer_text, real_text_plain
  implicit none
  private
  public :: piece_t, pieces_make
  public :: piece_block, piece_cylinder, piece_sphere, piece_file

  integer, parameter :: piece_block = 1, piece_cylinder = 2, piece_sphere = 3, piece_file = 4
  integer, parameter :: most_forces = 20               !! different forces within a body
  real(dp), parameter :: tolerance = 1.0e-6_dp         !! of volumes and places

  !> A body of the native deck; geometry along the axes of the deck it comes from.
  type :: piece_t
    character(:), allocatable :: name
    integer :: first = 0, last = 0                     !! bodies of the deck
    integer :: shape = piece_file
    real(dp) :: lower(3) = 0.0_dp, upper(3) = 0.0_dp   !! of a block
    real(dp) :: centre(3) = 0.0_dp, radius = 0.0_dp, length = 0.0_dp
    real(dp) :: spacing = 0.0_dp
    logical :: hole = .false.                          !! a block with a hole about (centre, radius)
    logical :: moves_as_one = .true.
    character(:), allocatable :: formula               !! of a built-in field of velocity; '': none
    integer :: formula_axis = 0                        !! the component it is
    real(dp) :: velocity(3) = 0.0_dp, force(3) = 0.0_dp, gravity(3) = 0.0_dp
    real(dp), allocatable :: rows(:, :)
      !! (7, n) of a file: position, volume, velocity (0 where it moves as one), axes as here
  end type piece_t

contains

  !> Makes the bodies.
  subroutine pieces_make(deck, clouds, space, words, pieces, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    type(space_t), intent(in) :: space
    type(mpm3d_words_t), intent(inout) :: words
    type(piece_t), allocatable, intent(out) :: pieces(:)
    type(import_notes_t), intent(inout) :: notes
    type(piece_t), allocatable :: room(:), found(:)
    integer :: b, n
    allocate (room(size(clouds)))
    n = 0
    do b = 1, size(clouds)
      call make(deck, clouds(b), b, space, words, found)
      if (words%failed) return
      call note_body(deck%parts(b), clouds(b), b, found, notes)
      if (n > 0) then
        if (stacked(room(n), found(1), deck%parts)) then
          room(n)%last = b
          room(n)%length = room(n)%length + found(1)%length
          room(n)%name = 'bodies_'//integer_text(room(n)%first)//'_to_'//integer_text(b)
          cycle
        end if
      end if
      if (n + size(found) > size(room)) room = [room, found, found]  ! any more room will do
      room(n + 1:n + size(found)) = found
      n = n + size(found)
    end do
    pieces = room(:n)
  end subroutine pieces_make

  !> The pieces of one body: itself, or one for each force on its particles.
  subroutine make(deck, cloud, number, space, words, pieces)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: cloud
    integer, intent(in) :: number
    type(space_t), intent(in) :: space
    type(mpm3d_words_t), intent(inout) :: words
    type(piece_t), allocatable, intent(out) :: pieces(:)
    type(piece_t) :: whole
    integer, allocatable :: group(:)
    integer :: g, groups
    real(dp) :: forces(3, most_forces)
    whole%first = number
    whole%last = number
    whole%name = 'body_'//integer_text(number)
    whole%gravity = cloud%gravity
    whole%moves_as_one = cloud_uniform(cloud%velocity)
    if (whole%moves_as_one) whole%velocity = cloud%velocity(:, 1)
    call find_formula(deck, cloud, space, whole)
    call find_groups(cloud, group, forces, groups)
    if (groups > most_forces) then
      words%position = deck%parts(number)%place
      call words%fail('load puts more than '//integer_text(most_forces)// &
                      ' different forces per mass on the particles of this body', &
                      'split the body, or give a body force by hand')
      return
    end if
    allocate (pieces(groups))
    do g = 1, groups
      pieces(g) = whole
      pieces(g)%force = forces(:, g)
      if (groups > 1) pieces(g)%name = whole%name//'_load_'//integer_text(g)
      if (groups == 1 .and. (whole%moves_as_one .or. whole%formula /= '')) then
        call find_shape(deck%parts(number), cloud, space, pieces(g))
      end if
      if (pieces(g)%shape == piece_file) call take_rows(cloud, group == g, space, pieces(g))
    end do
  end subroutine make

  !> The formula of a field of velocity built into MPM3D, if the last line of velo is one and the
  !! particles are where it takes them to be.
  pure subroutine find_formula(deck, cloud, space, piece)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: cloud
    type(space_t), intent(in) :: space
    type(piece_t), intent(inout) :: piece
    real(dp) :: expected(size(cloud%mass))
    integer :: variable
    character(:), allocatable :: x
    piece%formula = ''
    if (piece%moves_as_one) return
    associate (last => deck%velocities(size(deck%velocities)))
      variable = merge(2, 1, last%kind == 'vsin')
      if (.not. any(space%axes == variable)) return
      x = space%name(variable)
      piece%formula_axis = merge(2, 1, last%kind == 'nuli')
      select case (last%kind)
      case ('ksin')
        expected = last%value(1)*sin(pi_there*cloud%position(1, :))
        piece%formula = real_text_plain(last%value(1))//'*sin(pi*'//x//')'
      case ('vsin')
        expected = last%value(1)*sin(pi_there*cloud%position(2, :)/6.0_dp)
        piece%formula = real_text_plain(last%value(1))//'*sin(pi*'//x//'/6)'
      case ('nuli')
        expected = last%value(1)*beam_velocity(cloud%position(1, :))
        piece%formula = beam_formula(last%value(1), x)
      case default
        return
      end select
    end associate
    expected = abs(expected - cloud%velocity(piece%formula_axis, :))
    if (any(expected > tolerance*maxval(abs(cloud%velocity)))) piece%formula = ''
  end subroutine find_formula

  !> The same as beam_velocity.
  pure function beam_formula(deflection, x) result(formula)
    real(dp), intent(in) :: deflection
    character(*), intent(in) :: x
    character(:), allocatable :: formula, q
    q = '(78.83*'//x//')'
    formula = real_text_plain(deflection)// &
              '/(2*(sinh(78.83*0.06)-sin(78.83*0.06)))'// &
              '*78.83^2*sqrt(318e9*0.01^2/(12*1845*(1-0.054^2)))'// &
              '*((cosh(78.83*0.06)-cos(78.83*0.06))*(sinh'//q//'+sin'//q//')'// &
              '-(sinh(78.83*0.06)-sin(78.83*0.06))*(cosh'//q//'+cos'//q//'))'
  end function beam_formula

  !> Particles with the same force per mass.
  subroutine find_groups(cloud, group, forces, groups)
    type(cloud_t), intent(in) :: cloud
    integer, allocatable, intent(out) :: group(:)      !! of each particle
    real(dp), intent(out) :: forces(3, most_forces)    !! of each group
    integer, intent(out) :: groups                     !! most_forces + 1: too many
    real(dp) :: least
    integer :: p, g
    allocate (group(size(cloud%mass)), source=1)
    forces = 0.0_dp
    forces(:, 1) = cloud%force(:, 1)
    groups = 1
    if (cloud_uniform(cloud%force)) return
    least = 1.0e-12_dp*maxval(abs(cloud%force))
    do p = 1, size(cloud%mass)
      do g = 1, groups
        if (all(abs(cloud%force(:, p) - forces(:, g)) <= least)) exit
      end do
      group(p) = g
      if (g <= groups) cycle
      groups = g
      if (groups > most_forces) return
      forces(:, g) = cloud%force(:, p)
    end do
  end subroutine find_groups

  !> The shape of a body whose particles have the volume of their squares or cubes.
  subroutine find_shape(part, cloud, space, piece)
    type(mpm3d_part_t), intent(in) :: part
    type(cloud_t), intent(in) :: cloud
    type(space_t), intent(in) :: space
    type(piece_t), intent(inout) :: piece
    real(dp) :: filled
    piece%spacing = cloud%spacing
    filled = row_volume(cloud, space, 1)/cloud%spacing**size(space%axes)
    if (abs(filled - 1.0_dp) > tolerance) return
    piece%lower = cloud%corner
    piece%upper = cloud%corner + cloud%rows*cloud%spacing
    piece%centre = part%origin
    piece%radius = part%rows(1)*part%spacing
    select case (part%form)
    case ('sphe')
      piece%shape = piece_sphere
    case ('cicl')
      piece%shape = piece_cylinder
      piece%length = part%spacing
    case ('blod')
      piece%centre = [part%hole(1), part%hole(2), cloud%corner(3)]
      piece%radius = part%hole_radius*part%spacing
      piece%hole = .true.
      if (.not. on_edge(cloud, piece)) piece%shape = piece_block
    case default
      if (cloud%cubic) piece%shape = piece_block
    end select
  end subroutine find_shape

  !> Whether particles lie on the edge of the hole, where round-off would decide.
  pure function on_edge(cloud, piece) result(yes)
    type(cloud_t), intent(in) :: cloud
    type(piece_t), intent(in) :: piece
    logical :: yes
    integer :: p
    yes = .false.
    do p = 1, size(cloud%mass)
      yes = yes .or. abs(norm2(cloud%position(:2, p) - piece%centre(:2)) - piece%radius) < &
            tolerance*cloud%spacing
    end do
  end function on_edge

  !> Volume here of the rows of particles that one particle stands for.
  pure function row_volume(cloud, space, p) result(volume)
    type(cloud_t), intent(in) :: cloud
    type(space_t), intent(in) :: space
    integer, intent(in) :: p
    real(dp) :: volume
    integer :: axis
    volume = cloud%volume(p)/space%thickness
    do axis = 1, 3
      if (.not. any(space%axes == axis)) volume = volume*cloud%rows(axis)
    end do
  end function row_volume

  !> Rows of a particle file: of the first row where the others are left out.
  subroutine take_rows(cloud, mine, space, piece)
    type(cloud_t), intent(in) :: cloud
    logical, intent(in) :: mine(:)
    type(space_t), intent(in) :: space
    type(piece_t), intent(inout) :: piece
    real(dp), allocatable :: rows(:, :)
    logical :: first_row(3)
    integer :: p, n, axis, d
    real(dp) :: least(3)
    d = size(space%axes)
    least = minval(cloud%position, dim=2)
    allocate (rows(7, count(mine)), source=0.0_dp)
    n = 0
    do p = 1, size(mine)
      if (.not. mine(p)) cycle
      first_row = cloud%position(:, p) <= least + lattice_tolerance*cloud%spacing
      if (.not. all([(first_row(axis) .or. any(space%axes == axis), axis=1, 3)])) cycle
      n = n + 1
      rows(:d, n) = cloud%position(space%axes, p)
      rows(4, n) = row_volume(cloud, space, p)
      if (.not. piece%moves_as_one) rows(5:4 + d, n) = cloud%velocity(space%axes, p)
    end do
    piece%rows = rows(:, :n)
  end subroutine take_rows

  !> Whether a disc lies on a cylinder that is all the same.
  pure function stacked(below, above, parts) result(yes)
    type(piece_t), intent(in) :: below, above
    type(mpm3d_part_t), intent(in) :: parts(:)
    logical :: yes
    real(dp) :: top(3), slack
    yes = .false.
    if (below%shape /= piece_cylinder .or. above%shape /= piece_cylinder) return
    associate (a => parts(below%last), b => parts(above%first))
      if (a%component /= b%component .or. a%material /= b%material) return
    end associate
    slack = tolerance*below%spacing
    top = below%centre + [0.0_dp, 0.0_dp, below%length]
    yes = all(abs(top - above%centre) <= slack) .and. &
          abs(below%radius - above%radius) <= slack .and. &
          abs(below%spacing - above%spacing) <= slack .and. &
          all(abs(below%velocity - above%velocity) <= 0.0_dp) .and. below%moves_as_one .and. &
          above%moves_as_one .and. all(abs(below%force - above%force) <= 0.0_dp) .and. &
          all(abs(below%gravity - above%gravity) <= 0.0_dp)
  end function stacked

  !> What became of a body.
  subroutine note_body(part, cloud, number, pieces, notes)
    type(mpm3d_part_t), intent(in) :: part
    type(cloud_t), intent(in) :: cloud
    integer, intent(in) :: number
    type(piece_t), intent(in) :: pieces(:)
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: text
    text = 'body '//integer_text(number)//' ('//trim(part%form)//', '// &
           integer_text(size(cloud%mass))//' particles): '
    select case (pieces(1)%shape)
    case (piece_block)
      text = text//'a block'
      if (part%form == 'poin') text = text//', for its particles are a complete lattice'
      if (pieces(1)%hole) text = text//' with a hole'
    case (piece_cylinder)
      text = text//'a cylinder; discs on top of each other become one'
    case (piece_sphere)
      text = text//'a sphere'
    case default
      text = text//'a particle file'
      if (size(pieces) > 1) text = text//' for each force on its particles'
    end select
    if (part%form /= 'poin' .and. pieces(1)%shape == piece_file .and. size(pieces) == 1) then
      if (pieces(1)%moves_as_one .or. pieces(1)%formula /= '') then
        text = text//', for the volume of a particle (mass over the density of material) is '// &
               'not that of its lattice'
        if (pieces(1)%hole) text = text//', or particles lie on the edge of the hole'
      else
        text = text//', for its particles differ in velocity'
      end if
    end if
    call notes%add(note_honoured, part%place, 'particle', text)
  end subroutine note_body

end module sgmp_mpm3d_bodies
