!> The space of an MPM3D deck as it is solved here: which axes are left, where walls truly are.
!!
!! Directions one cell thick between two planes of symmetry are solved in fewer dimensions. For
!! methods with wide kernels MPM3D holds two layers of nodes, so that the wall is the second plane
!! of nodes; here the grid makes its own room beyond a wall.
module sgmp_mpm3d_space
  use sgmp_import_notes, only: import_notes_t, note_approximated, note_honoured
  use sgmp_kinds, only: dp
  use sgmp_mpm3d_deck, only: mpm3d_deck_t, mpm3d_given, mpm3d_place
  use sgmp_mpm3d_particles, only: cloud_rows, cloud_t
  use sgmp_mpm3d_words, only: mpm3d_words_t
  use sgmp_text, only: integer_text, real_text
  implicit none
  private
  public :: space_t, space_make, face_free

  integer, parameter :: face_free = 0, face_symmetric = 2  !! conditions of the card fixe; 1: fixed

  !> What is left of the box.
  type :: space_t
    integer, allocatable :: axes(:)              !! of the deck, in the order used here
    real(dp) :: lower(3) = 0.0_dp, upper(3) = 0.0_dp  !! true walls, or faces (deck's axes)
    logical :: open(2, 3) = .false.              !! particles lie beyond: the face gives way
    integer :: face(2, 3) = face_free
    real(dp) :: thickness = 1.0_dp               !! volume there over volume here
    character(1) :: name(3) = ['x', 'y', 'z']    !! what an axis of the deck is called here
  end type space_t

contains

  !> Decides on axes and faces.
  subroutine space_make(deck, clouds, keep_3d, words, space, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(inout) :: clouds(:)    !! rows along directions that are left out are set
    logical, intent(in) :: keep_3d
    type(mpm3d_words_t), intent(inout) :: words
    type(space_t), intent(out) :: space
    type(import_notes_t), intent(inout) :: notes
    logical :: thin(3)
    integer :: axis, k
    do axis = 1, 3
      space%lower(axis) = deck%box(1, axis)
      space%upper(axis) = deck%box(1, axis) + box_cells(deck, axis)*deck%cell
      space%face(:, axis) = deck%fixed(:, axis)
      thin(axis) = is_thin(deck, clouds, axis, keep_3d, notes)
    end do
    if (all(thin)) thin(1) = .false.
    space%axes = pack([1, 2, 3], .not. thin)
    do k = 1, size(space%axes)
      axis = space%axes(k)
      space%name(axis) = 'xyz'(k:k)
      call find_walls(deck, axis, space, notes)
      call check_faces(deck, clouds, axis, words, space, notes)
      if (mpm3d_given(deck, 'tlmp')) call free_space(deck, clouds, axis, space)
    end do
    do axis = 1, 3
      if (thin(axis)) call warn_off_middle(deck, clouds, axis, words, notes)
    end do
    call find_thickness(deck, clouds, thin, space, notes)
  end subroutine space_make

  !> Where walls truly are: with two layers of nodes one cell within the box; where fewer than three
  !! cells lie between two walls, at the box.
  subroutine find_walls(deck, axis, space, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    integer, intent(in) :: axis
    type(space_t), intent(inout) :: space
    type(import_notes_t), intent(inout) :: notes
    if (.not. two_layers(deck)) return
    if (all(space%face(:, axis) /= face_free) .and. box_cells(deck, axis) < 3) then
      if (box_cells(deck, axis) == 2) call notes%add( &
        note_approximated, mpm3d_place(deck, 'fixe'), 'fixed', 'two cells between walls along '// &
        'xyz'(axis:axis)//': the plane of nodes between them moves here, there it is held, too')
      return
    end if
    if (space%face(1, axis) /= face_free) space%lower(axis) = space%lower(axis) + deck%cell
    if (space%face(2, axis) /= face_free) space%upper(axis) = space%upper(axis) - deck%cell
  end subroutine find_walls

  !> Total Lagrangian motion knows neither the box nor walls that the matter does not touch at the
  !! start: such faces give way.
  pure subroutine free_space(deck, clouds, axis, space)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    integer, intent(in) :: axis
    type(space_t), intent(inout) :: space
    real(dp), parameter :: reach = 2.0_dp  !! of the widest kernel, in cells
    real(dp) :: gap(2)
    integer :: b
    gap = huge(gap)
    do b = 1, size(clouds)
      gap(1) = min(gap(1), minval(clouds(b)%position(axis, :)) - space%lower(axis))
      gap(2) = min(gap(2), space%upper(axis) - maxval(clouds(b)%position(axis, :)))
    end do
    where (gap > reach*deck%cell) space%face(:, axis) = face_free
    space%open(:, axis) = space%face(:, axis) == face_free
  end subroutine free_space

  !> Cells along an axis; MPM3D moves the upper end to fit.
  pure integer function box_cells(deck, axis) result(cells)
    type(mpm3d_deck_t), intent(in) :: deck
    integer, intent(in) :: axis
    cells = max(1, nint(min(1.0e8_dp, (deck%box(2, axis) - deck%box(1, axis))/deck%cell)))
  end function box_cells

  !> Whether MPM3D holds two layers of nodes at a wall.
  pure logical function two_layers(deck) result(yes)
    type(mpm3d_deck_t), intent(in) :: deck
    yes = mpm3d_given(deck, 'gimp') .or. mpm3d_given(deck, 'bimp') .or. mpm3d_given(deck, 'sgmp')
  end function two_layers

  !> Whether a direction can be left out: all its nodes are held, and nothing differs along it.
  function is_thin(deck, clouds, axis, keep_3d, notes) result(thin)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(inout) :: clouds(:)
    integer, intent(in) :: axis
    logical, intent(in) :: keep_3d
    type(import_notes_t), intent(inout) :: notes
    logical :: thin, moves, pushed
    integer :: b, rows(size(clouds))
    character(:), allocatable :: why
    thin = .false.
    if (box_cells(deck, axis) > merge(3, 1, two_layers(deck))) return
    if (any(deck%fixed(:, axis) /= face_symmetric)) return
    why = ''
    if (keep_3d) why = '--keep-3d'
    do b = 1, size(clouds)
      moves = any(abs(clouds(b)%velocity(axis, :)) > 0.0_dp)
      pushed = any(abs(clouds(b)%force(axis, :)) > 0.0_dp) .or. &
               abs(clouds(b)%gravity(axis)) > 0.0_dp
      if (moves .or. pushed) why = 'something moves or pushes along it'
      rows(b) = cloud_rows(clouds(b), axis)
      ! A hole runs along z: a plane across it would need a slot in its place.
      if (deck%parts(b)%form == 'blod' .and. axis < 3) rows(b) = 0
      if (rows(b) == 0) why = 'rows differ along it'
    end do
    thin = why == ''
    if (thin) clouds%rows(axis) = rows
    if (.not. thin) call notes%add(note_honoured, mpm3d_place(deck, 'fixe'), 'fixed', &
                                   'the direction '//'xyz'(axis:axis)// &
                                   ', one cell thick between planes of symmetry, is kept: '//why)
  end function is_thin

  !> Rows that do not lie about the middle of a direction that is left out. MPM3D is wrong there.
  subroutine warn_off_middle(deck, clouds, axis, words, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    integer, intent(in) :: axis
    type(mpm3d_words_t), intent(inout) :: words
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: text
    real(dp) :: middle
    integer :: b
    middle = deck%box(1, axis) + 0.5_dp*box_cells(deck, axis)*deck%cell
    do b = 1, size(clouds)
      associate (x => clouds(b)%position(axis, :))
        if (abs(0.5_dp*(minval(x) + maxval(x)) - middle) <= 1.0e-3_dp*deck%cell) cycle
      end associate
      text = 'the rows of body '//integer_text(b)//' lie off the middle ('//real_text(middle)// &
             ') of the direction '//'xyz'(axis:axis)//', which is one cell thick: MPM3D itself '// &
             'gives other results there than with rows in the middle'
      call words%errors%warn(deck%parts(b)%place, text, 'here it makes no difference; before '// &
                             'results are compared, move the rows there')
      call notes%add(note_approximated, deck%parts(b)%place, 'particle', text)
      return
    end do
  end subroutine warn_off_middle

  !> Particles beyond a wall are an error; a free face gives way to them.
  subroutine check_faces(deck, clouds, axis, words, space, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    integer, intent(in) :: axis
    type(mpm3d_words_t), intent(inout) :: words
    type(space_t), intent(inout) :: space
    type(import_notes_t), intent(inout) :: notes
    real(dp) :: slack
    logical :: beyond(2)
    integer :: b, side
    character(:), allocatable :: remedy
    slack = 1.0e-9_dp*deck%cell
    remedy = 'move it, or the box'
    if (two_layers(deck)) remedy = remedy//', one cell outwards: for gimp, bimp and sgmp the '// &
                                   'wall is the second plane of nodes'
    do b = 1, size(clouds)
      beyond = [minval(clouds(b)%position(axis, :)) < space%lower(axis) - slack, &
                maxval(clouds(b)%position(axis, :)) > space%upper(axis) + slack]
      do side = 1, 2
        if (.not. beyond(side)) cycle
        if (space%face(side, axis) == face_free) then
          if (.not. space%open(side, axis)) call notes%add( &
            note_approximated, deck%parts(b)%place, 'particle', 'there are particles beyond the'// &
            ' free face '//'xyz'(axis:axis)//'-+'(side:side)//', which MPM3D leaves out; here '// &
            'the grid follows them')
          space%open(side, axis) = .true.
        else
          words%position = deck%parts(b)%place
          call words%fail('the body has particles beyond the wall '//'xyz'(axis:axis)// &
                          '-+'(side:side)//', which is at '// &
                          real_text(merge(space%lower(axis), space%upper(axis), side == 1)), &
                          remedy)
        end if
      end do
    end do
  end subroutine check_faces

  !> What volumes are divided by in fewer dimensions: such that the first body's particles keep the
  !! volume of their squares, or their length.
  subroutine find_thickness(deck, clouds, thin, space, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    logical, intent(in) :: thin(3)
    type(space_t), intent(inout) :: space
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: names, here, there
    integer :: axis
    if (.not. any(thin)) return
    associate (first => clouds(1))
      space%thickness = first%volume(1)*product(first%rows, mask=thin)/ &
                        spacing_along(first, space%axes)**size(space%axes)
    end associate
    names = ''
    do axis = 1, 3
      if (thin(axis)) names = names//' '//'xyz'(axis:axis)
    end do
    call notes%add(note_honoured, mpm3d_place(deck, 'fixe'), 'fixed', 'one cell thick between '// &
                   'planes of symmetry along'//names//': solved in '// &
                   'fewer dimensions ('//trim(merge('uniaxial strain', 'plane strain   ', &
                   size(space%axes) == 1))//'); masses and energies here are those there over '// &
                   real_text(space%thickness)//'; --keep-3d keeps it as it is')
    here = ''
    there = ''
    do axis = 1, size(space%axes)
      here = here//' '//'xyz'(axis:axis)
      there = there//' '//'xyz'(space%axes(axis):space%axes(axis))
    end do
    if (here /= there) call notes%add(note_honoured, mpm3d_place(deck, 'fixe'), 'fixed', &
                                      'here'//here//', there'//there)
  end subroutine find_thickness

  !> Distance of particles in the directions that are left: of the lattice, or from the first one to
  !! the next.
  pure function spacing_along(cloud, axes) result(spacing)
    type(cloud_t), intent(in) :: cloud
    integer, intent(in) :: axes(:)
    real(dp) :: spacing, nearest, distance
    integer :: p
    spacing = cloud%spacing
    if (cloud%cubic) return
    nearest = huge(1.0_dp)
    do p = 2, size(cloud%mass)
      distance = norm2(cloud%position(axes, p) - cloud%position(axes, 1))
      if (distance > 1.0e-6_dp*spacing) nearest = min(nearest, distance)
    end do
    if (nearest < huge(1.0_dp)) spacing = nearest
  end function spacing_along

end module sgmp_mpm3d_space
