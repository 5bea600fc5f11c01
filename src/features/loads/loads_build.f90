!> Loads on the particles of a body: who bears them, and how much of them.
module sgmp_loads_build
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use sgmp_air_blast, only: air_blast_farthest, air_blast_make, air_blast_nearest, air_blast_t
  use sgmp_body, only: body_t
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_expression, only: expression_t
  use sgmp_faces_build, only: face_t, faces_lattice, faces_length, faces_place, faces_shown
  use sgmp_kinds, only: dp, lanes
  use sgmp_lattice, only: lattice_t
  use sgmp_load, only: load_absorbing, load_blast, load_force, load_pressure, load_t
  use sgmp_material_history, only: slots_ask
  use sgmp_mesh, only: mesh_place, mesh_places, mesh_t, wall_free
  use sgmp_motion, only: motion_mass
  use sgmp_parallel, only: parallel_exact_sums, parallel_min
  use sgmp_scene, only: body_card_t, load_card_t, scene_t
  use sgmp_shapes, only: shape_block, shape_cylinder, shape_ring
  use sgmp_text, only: integer_text, real_text_about
  use sgmp_turn, only: turn_turns
  use sgmp_units, only: units_sizes
  implicit none
  private
  public :: chosen, loads_add_columns, loads_declare, loads_fill

  ! What is summed over particles: mass or area that bears a load, particles whose faces are
  ! opposite, places of which where=… does not say.
  integer, parameter :: borne = 1, squeezed = 2, unclear = 3, sums = 3
  real(dp), parameter :: on_edge = 0.5_dp     !! and an edge that lets waves out
  real(dp), parameter :: on_wall = 1.0e-6_dp  !! spacings between a face and the wall that bears it

contains

  !> What the cards say of a body's loads.
  subroutine loads_declare(scene, number, body)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(body_t), intent(inout) :: body
    type(load_t) :: new
    integer :: i, set
    allocate (body%loads(0))
    do i = 1, size(scene%loads)
      if (scene%loads(i)%body /= number) cycle
      new%kind = scene%loads(i)%kind
      new%value = scene%loads(i)%value
      if (new%kind == load_blast) new%blast = charge_of(scene%loads(i), scene%units)
      associate (along => faces_together(scene%loads(i), scene%bodies(number), scene%dimension))
        do set = 1, size(along, 2)
          new%set = set
          body%loads = [body%loads, new]
        end do
      end associate
    end do
    body%forced = body%forced .or. size(body%loads) > 0
    body%faced = any(body%loads%kind /= load_force)
  end subroutine loads_declare

  !> The charge of an air blast.
  pure function charge_of(card, units) result(blast)
    type(load_card_t), intent(in) :: card
    character(*), intent(in) :: units(3)         !! length, mass, time of the deck
    type(air_blast_t) :: blast
    call air_blast_make(card%charge, card%burst, card%point, card%time, units_sizes(units), blast)
  end function charge_of

  !> Columns of the particles for shares and area vectors.
  pure subroutine loads_add_columns(ndim, body)
    integer, intent(in) :: ndim
    type(body_t), intent(inout) :: body
    integer, parameter :: most = 7   !! an area vector, a traction in space, a part of it that fades
    real(dp), parameter :: none(most) = 0.0_dp
    integer :: i
    do i = 1, size(body%loads)
      body%loads(i)%column = body%law%slots%total + 1
      select case (body%loads(i)%kind)
      case (load_force)
        call slots_ask(body%law%slots, 'share'//integer_text(i), none(:1))
      case (load_absorbing)
        ! The traction at rest, too.
        call slots_ask(body%law%slots, 'area'//integer_text(i), &
                       none(:2*ndim + merge(1, 0, body%loads(i)%fading > 0.0_dp)))
      case default
        call slots_ask(body%law%slots, 'area'//integer_text(i), none(:ndim))
      end select
    end do
  end subroutine loads_add_columns

  !> Axes along which faces look that act on a particle at one place, a set a column. Pressure acts
  !! along each axis by itself: so the forces on any lattice balance a uniform stress. What depends
  !! on the size of an area or on where it looks acts so on the faces of a block, and on the ends of
  !! a straight cylinder and the stairs around it; elsewhere on all at once, since the faces of
  !! stairs stand for one that is oblique.
  pure function faces_together(card, body, ndim) result(along)
    type(load_card_t), intent(in) :: card
    type(body_card_t), intent(in) :: body
    integer, intent(in) :: ndim
    logical, allocatable :: along(:, :)          !! (axis, set)
    logical, parameter :: every(3, 1) = .true.
    real(dp), parameter :: straight = 1.0_dp - 1.0e-9_dp
    logical :: ends(3)
    integer :: a, b
    along = every
    if (card%kind == load_force) return
    if (card%axis > 0) then
      along(:, 1) = [(a == card%axis, a=1, 3)]
      return
    end if
    if (card%kind == load_pressure .or. all(body%shapes%kind == shape_block .and. &
                                            .not. turn_turns(body%shapes%turn))) then
      along = reshape([((a == b, a=1, 3), b=1, ndim)], [3, ndim])
    else if (size(body%shapes) == 1 .and. .not. turn_turns(body%shapes(1)%turn)) then
      ends = abs(body%shapes(1)%axis) > straight .and. &
             any(body%shapes(1)%kind == [shape_cylinder, shape_ring])
      if (any(ends(:ndim))) along = reshape([ends, .not. ends], [3, 2])
    end if
  end function faces_together

  !> Fills these columns; an error where nothing bears a load. All ranks must call it.
  subroutine loads_fill(scene, number, mesh, body, error)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: total(sums), of_set(sums)
    type(load_t), allocatable :: loads(:)
    integer :: i, before, set
    logical, allocatable :: along(:, :)
    before = 0
    do i = 1, size(scene%loads)
      if (scene%loads(i)%body /= number) cycle
      associate (card => scene%loads(i))
        along = faces_together(card, scene%bodies(number), mesh%ndim)
        total = 0.0_dp
        do set = 1, size(along, 2)
          call fill_columns(card, scene%bodies(number), mesh, along(:, set), &
                            body%loads(before + set)%column, body, of_set)
          total = total + of_set
        end do
        call check_bearers(card, trim(body%name), total, error)
        if (card%kind == load_blast .and. .not. allocated(error)) then
          loads = body%loads(before + 1:before + size(along, 2))
          call check_distance(card, body, loads, mesh, error)
          body%loads(before + 1:before + size(along, 2)) = loads
        end if
        if (allocated(error)) return
        if (card%kind == load_force) call share(body, body%loads(before + 1)%column, total(borne))
        before = before + size(along, 2)
      end associate
    end do
  end subroutine loads_fill

  !> An error where a load has nothing to act on, or no place to act at.
  subroutine check_bearers(card, name, total, error)
    type(load_card_t), intent(in) :: card
    character(*), intent(in) :: name             !! of the body
    real(dp), intent(in) :: total(sums)
    type(error_t), allocatable, intent(out) :: error
    if (total(unclear) > 0.0_dp) then
      call error_make(error, exit_deck, "where=… is not a number at some places of body '"// &
                      name//"'", 'particles bear the load where it is not 0', card%location)
    else if (total(squeezed) > 0.0_dp) then
      call error_make(error, exit_deck, "particles of body '"//name// &
                      "' show opposite faces, which one force cannot press", &
                      'a card for each face (face=x- … face=x+), or two particles across '// &
                      'the thinnest part', card%location)
    else if (total(borne) <= 0.0_dp) then
      call error_make(error, exit_deck, trim(merge('the load acts on no particle  ', &
                                                   'there are no such faces       ', &
                                                   card%kind == load_force)), &
                      'look at where=… and face=…; particles are at the centres of their '// &
                      'cubes', card%location)
    end if
  end subroutine check_bearers

  !> Fills the columns of a load: 1 for the particles that bear a force, area vectors of the faces
  !! that particles show.
  subroutine fill_columns(card, owner, mesh, along, column, body, total)
    type(load_card_t), intent(in) :: card
    type(body_card_t), intent(in) :: owner
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: along(3)              !! axes along which its faces look
    integer, intent(in) :: column
    type(body_t), intent(inout) :: body
    real(dp), intent(out) :: total(sums)         !! of the mass or the area, and of particles
    real(dp), allocatable :: terms(:, :)
    type(lattice_t) :: lattice
    real(dp) :: x(3), faces(3)
    integer :: c, l, n
    n = mesh%ndim
    x = 0.0_dp
    if (card%kind /= load_force) call faces_lattice(owner, mesh, lattice)
    associate (particles => body%particles)
      allocate (terms(sums, particles%chunks), source=0.0_dp)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          x(:n) = mesh_places(mesh, particles%motion(l, :n, c))
          if (card%kind /= load_force) then
            associate (volume => particles%state(l, 1, c), counts => terms(:, c))
              call faces_of(card, owner, mesh, lattice, along, x, volume, faces, counts)
            end associate
            particles%state(l, column:column + n - 1, c) = faces(:n)
          else if (chosen(card%where, x, terms(unclear, c))) then
            particles%state(l, column, c) = 1.0_dp
            terms(borne, c) = terms(borne, c) + particles%motion(l, motion_mass(n), c)
          end if
        end do
      end do
    end associate
    call parallel_exact_sums(terms, total)
  end subroutine fill_columns

  !> Notes how near the faces are to the charge; an error where the fits of its blast do not hold
  !! for all of them. All ranks must call it.
  subroutine check_distance(card, body, loads, mesh, error)
    type(load_card_t), intent(in) :: card
    type(body_t), intent(in) :: body
    type(load_t), intent(inout) :: loads(:)      !! one for each set of faces
    type(mesh_t), intent(in) :: mesh
    type(error_t), allocatable, intent(out) :: error
    type(air_blast_t) :: blast
    real(dp) :: least, most
    integer :: i
    blast = loads(1)%blast
    least = huge(1.0_dp)
    most = 0.0_dp
    do i = 1, size(loads)
      call find_distances(body, loads(i), mesh, least, most)
    end do
    blast%nearest = parallel_min(least)
    most = -parallel_min(-most)
    loads%blast = blast
    if (blast%nearest*blast%scale < air_blast_nearest(blast%burst)) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' is "// &
                      scaled_text(blast%nearest)//' from the charge; the fits of its blast '// &
                      'begin at '//real_text_about(air_blast_nearest(blast%burst)), &
                      'so near compute the charge and the air: material explosive, doc/loads.md', &
                      card%location)
    else if (most*blast%scale > air_blast_farthest) then
      call error_make(error, exit_deck, "faces of body '"//trim(body%name)//"' are up to "// &
                      scaled_text(most)//' from the charge; the fits of its blast end at '// &
                      real_text_about(air_blast_farthest), 'choose nearer faces: face=…, '// &
                      'where=…; or look at units, charge and point', card%location)
    end if

  contains

    function scaled_text(distance) result(text)
      real(dp), intent(in) :: distance
      character(:), allocatable :: text
      text = real_text_about(distance*blast%scale)//' m/kg^(1/3)'
    end function scaled_text

  end subroutine check_distance

  !> Least and largest distance of faces from the charge.
  pure subroutine find_distances(body, load, mesh, least, most)
    type(body_t), intent(in) :: body
    type(load_t), intent(in) :: load
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(inout) :: least, most
    real(dp) :: x(3)
    integer :: c, l, n
    n = mesh%ndim
    x = 0.0_dp
    do c = 1, body%particles%chunks
      do l = 1, lanes
        associate (area => body%particles%state(l, load%column:load%column + n - 1, c))
          if (all(abs(area) <= 0.0_dp)) cycle
          x(:n) = mesh_places(mesh, body%particles%motion(l, :n, c)) + &
                  0.5_dp*body%particles%state(l, body%law%slots%volume, c)/sum(area**2)*area
        end associate
        least = min(least, norm2(x - load%blast%point))
        most = max(most, norm2(x - load%blast%point))
      end do
    end do
  end subroutine find_distances

  !> Shares of particles in a force, per mass: one over the mass of all that bear it.
  pure subroutine share(body, column, mass)
    type(body_t), intent(inout) :: body
    integer, intent(in) :: column
    real(dp), intent(in) :: mass
    integer :: c
    do c = 1, body%particles%chunks
      body%particles%state(:, column, c) = body%particles%state(:, column, c)/mass
    end do
  end subroutine share

  !> Sum of the area vectors of those faces of a particle that a card means.
  subroutine faces_of(card, owner, mesh, lattice, along, x, volume, area, counts)
    type(load_card_t), intent(in) :: card
    type(body_card_t), intent(in) :: owner
    type(mesh_t), intent(in) :: mesh
    type(lattice_t), intent(in) :: lattice
    logical, intent(in) :: along(3)              !! axes along which the faces look that count
    real(dp), intent(in) :: x(3)                 !! of the particle
    real(dp), intent(in) :: volume
    real(dp), intent(out) :: area(3)
    real(dp), intent(inout) :: counts(sums)
    type(face_t) :: face
    integer :: axis, side, shown(3), at(3)
    area = 0.0_dp
    shown = 0
    at = faces_place(owner, lattice, x)
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (card%axis > 0 .and. (card%axis /= axis .or. card%side /= side)) cycle
        face = faces_shown(owner, lattice, at, axis, side, x, volume)
        if (.not. face%shown) cycle
        if (borne_by_wall(mesh, faces_length(lattice, at, axis), face%middle)) cycle
        if (.not. chosen(card%where, face%middle, counts(unclear))) cycle
        if (along(axis)) area = area + face%area
        shown(axis) = shown(axis) + 1
      end do
    end do
    call count_faces(area, shown, counts)
  end subroutine faces_of

  !> Notes the area of a set of faces of a particle, and whether it shows opposite ones only, in all
  !! sets. Those of a tip one particle wide cancel.
  pure subroutine count_faces(area, shown, counts)
    real(dp), intent(in) :: area(3)
    integer, intent(in) :: shown(3)              !! faces along each axis
    real(dp), intent(inout) :: counts(sums)
    counts(borne) = counts(borne) + norm2(area)
    if (any(shown == 2) .and. all(shown /= 1)) counts(squeezed) = counts(squeezed) + 1.0_dp
  end subroutine count_faces

  !> Whether a face lies on a wall of the grid, or on an edge that lets waves out.
  pure function borne_by_wall(mesh, spacing, face) result(yes)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: spacing, face(3)
    logical :: yes
    real(dp) :: edges(2), walls(2)
    integer :: axis
    yes = .false.
    do axis = 1, mesh%ndim
      walls = mesh_place(mesh, axis, real([mesh%lower(axis), mesh%upper(axis)], dp))
      yes = yes .or. any(mesh%wall(:, axis) /= wall_free .and. &
                         abs(face(axis) - walls) < on_wall*spacing)
      edges = mesh_place(mesh, axis, real(mesh%edge(:, axis), dp))
      yes = yes .or. any(mesh%absorbs(:, axis) .and. abs(face(axis) - edges) < on_edge*spacing)
    end do
  end function borne_by_wall

  !> Whether a card means a place, by its `where`; counts those of which that does not say.
  function chosen(where, x, unknown) result(yes)
    type(expression_t), intent(in) :: where
    real(dp), intent(in) :: x(3)
    real(dp), intent(inout) :: unknown
    logical :: yes
    real(dp) :: weight
    weight = where%evaluate(x, x, 0.0_dp)
    yes = abs(weight) > 0.0_dp
    if (ieee_is_nan(weight)) unknown = unknown + 1.0_dp
  end function chosen

end module sgmp_loads_build
