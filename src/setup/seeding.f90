!> Bodies to particles: where the particles of a body's card are, by its shapes and layout or from a
!! file; a survey that counts them before any is made; bodies that overlap.
module sgmp_seeding
  use sgmp_body_lattice, only: body_lattice_lay, body_lattice_of_grid
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kinds, only: dp, i4, pi
  use sgmp_lattice, only: lattice_fits, lattice_ijk, lattice_jitter, lattice_layers, &
                          lattice_lines, lattice_point, lattice_t, lattice_tolerance, &
                          lattice_too_many, lattice_volume
  use sgmp_lattice_shares, only: fitting_t, lattice_fitting_prepare, lattice_share, &
                                  share_reach, share_t
  use sgmp_mesh, only: mesh_make, mesh_occupied, mesh_place, mesh_t
  use sgmp_particle_file, only: file_particles_t, particle_file_read
  use sgmp_scene, only: body_card_t, layout_file, layout_gauss, layout_graded, &
                        layout_lattice, scene_space, scene_t
  use sgmp_shapes, only: combine_union, shape_t, shapes_box, shapes_inside, &
                         shapes_near, shapes_volume
  use sgmp_slabs, only: slab_holds, slab_plane, slab_t
  use sgmp_space, only: axis_names, space_axisymmetric
  use sgmp_text, only: real_text
  use sgmp_turn, only: infinite_length, turn_back, turn_box, turn_forth, turn_inverse
  implicit none
  private
  public :: seeding_generate, seeding_check_inside, seeding_check_lattices, seeding_check_overlap, &
            seeding_check_size, &
            seeding_overlap, seeding_shape_volume, seeding_survey, survey_t

  real(dp), parameter :: farthest = 1.0e7_dp  !! cells from the grid's origin, where 1e-9 are left

  !> Where a body's particles are, before any of them is made.
  type :: survey_t
    integer, allocatable :: points(:)              !! (layers of the lattice) particles
    integer, allocatable :: lowest(:), highest(:)  !! (layers) planes of bins they are in
    integer :: first = 0                           !! first plane of `load`
    integer, allocatable :: load(:)                !! (planes) particles
  end type survey_t

  !> The particles of one line of a lattice.
  type :: line_t
    integer :: n = 0
    real(dp), allocatable :: position(:, :)        !! (3, at least n)
    real(dp), allocatable :: volume(:)
  end type line_t

contains

  !> Fills a body with particles; an error where it is unbounded, empty, too large or its file is
  !! wrong.
  subroutine seeding_generate(body, cell, grid_lower, dimension, positions, volumes, error, &
                              velocities, slab, survey, ids, file_ids)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: cell                      !! side of a grid cell (length)
    real(dp), intent(in) :: grid_lower(3)             !! a corner of the grid (length)
    integer, intent(in) :: dimension                  !! 1, 2 or 3
    real(dp), allocatable, intent(out) :: positions(:, :)  !! (3, n), unused components zero
    real(dp), allocatable, intent(out) :: volumes(:)  !! (n) (length**dimension)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable, intent(out), optional :: velocities(:, :)
      !! (3, n), allocated if the file has them; all of them, also with a slab
    type(slab_t), intent(in), optional :: slab        !! only the particles in these planes
    type(survey_t), intent(in), optional :: survey    !! comes with the slab
    integer(i4), allocatable, intent(out), optional :: ids(:)
      !! (n) which particles of the whole body they are, from 1; comes with the slab
    integer(i4), allocatable, intent(out), optional :: file_ids(:)
      !! ids of all particles in the body's file; empty where it gives none
    type(lattice_t) :: lattice
    type(file_particles_t) :: file
    if (present(file_ids)) allocate (file_ids(0))
    if (body%layout == layout_file) then
      call read_file(body, cell, grid_lower, dimension, file, error)
      if (allocated(error)) return
      call move_alloc(file%position, positions)
      call move_alloc(file%volume, volumes)
      if (present(velocities)) call move_alloc(file%velocity, velocities)
      if (present(file_ids)) call move_alloc(file%id, file_ids)
      if (present(slab)) call keep_slab(slab, positions, volumes, ids)
      return
    end if
    call lay_lattice(body, cell, grid_lower, dimension, lattice, error)
    if (allocated(error)) return
    if (present(slab)) then
      call fill_slab(body, lattice, slab, survey, positions, volumes, ids)
      return
    end if
    call fill_body(body, lattice, positions, volumes)
    if (size(volumes) == 0) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' has no particles", &
                      'use a smaller spacing or check its shapes', place_of(body))
    end if
  end subroutine seeding_generate

  !> Counts a body's particles layer by layer of its lattice and plane by plane of the grid, each of
  !! several sharers doing some of the layers; the sum of their surveys is that of the body.
  subroutine seeding_survey(body, cell, grid_lower, dimension, slab, sharer, sharers, survey, error)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: cell, grid_lower(3)       !! as for seeding_generate
    integer, intent(in) :: dimension
    type(slab_t), intent(in) :: slab                  !! how positions are sorted into planes
    integer, intent(in) :: sharer, sharers            !! from 0; how many
    type(survey_t), intent(out) :: survey
    type(error_t), allocatable, intent(out) :: error
    type(lattice_t) :: lattice
    type(line_t) :: found
    type(file_particles_t) :: file
    integer :: layer, line, p
    if (body%layout == layout_file) then
      call read_file(body, cell, grid_lower, dimension, file, error)
      if (allocated(error)) return
      call survey_open(survey, 1)
      do p = 1, merge(size(file%volume), 0, sharer == 0)
        call survey_note(survey, 1, slab_plane(slab, file%position(:, p)))
      end do
      return
    end if
    call lay_lattice(body, cell, grid_lower, dimension, lattice, error)
    if (allocated(error)) return
    call survey_open(survey, lattice_layers(lattice))
    do layer = 1 + sharer, size(survey%points), sharers
      do line = 1, lattice_lines(lattice)
        call fill_line(body, lattice, line, layer, found, volumes=.true.)
        do p = 1, found%n
          call survey_note(survey, layer, slab_plane(slab, found%position(:, p)))
        end do
      end do
    end do
  end subroutine seeding_survey

  !> The particles that a body takes from its file.
  subroutine read_file(body, cell, grid_lower, dimension, file, error)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: cell, grid_lower(3)       !! as for seeding_generate
    integer, intent(in) :: dimension
    type(file_particles_t), intent(out) :: file
    type(error_t), allocatable, intent(out) :: error
    call particle_file_read(body%file, place_of(body), &
                            merge(space_axisymmetric, dimension, body%rings), body%choice, file, &
                            error)
    if (allocated(error)) return
    call check_reach(body, minval(file%position, dim=2), maxval(file%position, dim=2), cell, &
                     grid_lower, dimension, error)
  end subroutine read_file

  !> An empty survey.
  pure subroutine survey_open(survey, layers)
    type(survey_t), intent(out) :: survey
    integer, intent(in) :: layers
    allocate (survey%points(layers), survey%lowest(layers), survey%highest(layers), source=0)
    allocate (survey%load(0))
  end subroutine survey_open

  !> Counts one particle.
  pure subroutine survey_note(survey, layer, plane)
    type(survey_t), intent(inout) :: survey
    integer, intent(in) :: layer, plane
    integer, allocatable :: longer(:)
    integer :: low, high
    if (survey%points(layer) == 0) then
      survey%lowest(layer) = plane
      survey%highest(layer) = plane
    end if
    survey%points(layer) = survey%points(layer) + 1
    survey%lowest(layer) = min(survey%lowest(layer), plane)
    survey%highest(layer) = max(survey%highest(layer), plane)
    if (size(survey%load) == 0) survey%first = plane
    low = min(survey%first, plane)
    high = max(survey%first + size(survey%load) - 1, plane)
    if (high - low + 1 > size(survey%load)) then
      allocate (longer(high - low + 1), source=0)
      longer(survey%first - low + 1:survey%first - low + size(survey%load)) = survey%load
      call move_alloc(longer, survey%load)
      survey%first = low
    end if
    survey%load(plane - survey%first + 1) = survey%load(plane - survey%first + 1) + 1
  end subroutine survey_note

  !> An error where the lattice of a body of the scene cannot be laid, before any is filled.
  subroutine seeding_check_lattices(scene, error)
    type(scene_t), intent(in) :: scene
    type(error_t), allocatable, intent(out) :: error
    type(mesh_t) :: mesh
    type(lattice_t) :: lattice
    integer :: b
    mesh = mesh_make(scene_space(scene), scene%grid%cell, scene%grid%lower, scene%grid%upper, &
                     scene%grid%open, scene%grid%wall, scene%grid%axes, scene%grid%one_sided)
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%layout == layout_file) cycle
      call lay_lattice(scene%bodies(b), scene%grid%cell, mesh%origin, scene%dimension, lattice, &
                       error)
      if (allocated(error)) return
    end do
  end subroutine seeding_check_lattices

  !> An error where a body is so far from the grid's origin that its particles could not move.
  subroutine check_reach(body, lower, upper, cell, grid_lower, ndim, error)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: lower(3), upper(3)   !! of the body
    real(dp), intent(in) :: cell, grid_lower(3)
    integer, intent(in) :: ndim
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: cells
    cells = maxval(max(abs(lower(:ndim)/cell - grid_lower(:ndim)/cell), &
                       abs(upper(:ndim)/cell - grid_lower(:ndim)/cell)))
    if (cells <= farthest) return
    call error_make(error, exit_deck, "body '"//trim(body%name)//"' reaches "//real_text(cells)// &
                    " cells from the grid's origin; there can be "//real_text(farthest), &
                    'move the body or the corner of the grid, or use larger cells', place_of(body))
  end subroutine check_reach

  !> The lattice around a body, or why there is none.
  subroutine lay_lattice(body, cell, grid_lower, ndim, lattice, error)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: cell, grid_lower(3)
    integer, intent(in) :: ndim
    type(lattice_t), intent(out) :: lattice
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: lower(3), upper(3), low(3), high(3)
    integer :: status
    call shapes_box(body%shapes, lower, upper)
    low = lower
    high = upper
    if (ndim > 1) call turn_box(body%turn, low, high)
    if (body_lattice_of_grid(body)) then
      lower = low
      upper = high
    end if
    if (any(abs([lower(:ndim), upper(:ndim)]) > infinite_length)) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' is unbounded", &
                      'give its shapes a finite length', place_of(body))
      return
    end if
    call check_reach(body, low, high, cell, grid_lower, ndim, error)
    if (allocated(error)) return
    call body_lattice_lay(body, cell, grid_lower, ndim, lattice, status)
    if (status == lattice_too_many) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' would have too many "// &
                      'particles', 'use a larger spacing; there can be 2147483647', place_of(body))
    else if (status /= lattice_fits) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' is too far from the "// &
                      'origin of its lattice', 'move lattice_origin or the grid', place_of(body))
    end if
  end subroutine lay_lattice

  !> The particles of a line. A lattice is turned with its body; the Gauss points of the grid stay
  !! where they are, and the body is turned over them.
  pure subroutine fill_line(body, lattice, line, layer, found, volumes)
    type(body_card_t), intent(in) :: body
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: line, layer
    type(line_t), intent(inout) :: found
    logical, intent(in), optional :: volumes       !! are asked for, and places to the last digit
    type(shape_t), allocatable :: shapes(:)
    type(fitting_t) :: fitting
    real(dp) :: point(3), tested(3), ends(3, 2)
    integer :: i, ijk(3)
    logical :: lattice_turns
    if (.not. allocated(found%volume)) then
      allocate (found%position(3, lattice%count(1)), found%volume(lattice%count(1)))
    end if
    found%n = 0
    lattice_turns = .not. body_lattice_of_grid(body)
    ends(:, 1) = lattice_point(lattice, lattice_ijk(lattice, 1, line, layer))
    ends(:, 2) = lattice_point(lattice, lattice_ijk(lattice, lattice%count(1), line, layer))
    call choose_shapes(body, ends(:, 1), ends(:, 2), .not. lattice_turns, lattice%margin, &
                       lattice%ndim, shapes)
    if (size(shapes) == 0) return
    if (present(volumes)) call prepare_fitting(body, lattice, ends, fitting)
    do i = 1, lattice%count(1)
      ijk = lattice_ijk(lattice, i, line, layer)
      point = lattice_point(lattice, ijk)
      tested = point
      if (.not. lattice_turns) call turn_back(body%turn, tested)
      if (.not. shapes_inside(shapes, tested, lattice%ndim, lattice%margin)) cycle
      call lattice_jitter(lattice, ijk, point)
      if (body%rings .and. point(1) <= 0.0_dp) cycle
      found%n = found%n + 1
      found%volume(found%n) = lattice_volume(lattice, ijk)*merge(2.0_dp*pi*point(1), 1.0_dp, &
                                                                 body%rings)
      if (allocated(fitting%shapes)) then
        call take_share(lattice_share(fitting, lattice, ijk), lattice_point(lattice, ijk), &
                        body%rings, point, found%volume(found%n))
      end if
      if (lattice_turns) call turn_forth(body%turn, point)
      found%position(:, found%n) = point
    end do
  end subroutine fill_line

  !> What the shares of the particles of a line follow from, where its lattice is cut.
  pure subroutine prepare_fitting(body, lattice, ends, fitting)
    type(body_card_t), intent(in) :: body
    type(lattice_t), intent(in) :: lattice
    real(dp), intent(in) :: ends(3, 2)           !! of the line
    type(fitting_t), intent(out) :: fitting
    real(dp) :: reach
    if (.not. lattice%cut) return
    reach = share_reach*maxval(lattice%length(:, :lattice%ndim))
    fitting%turn = body%turn
    fitting%turns = body_lattice_of_grid(body)
    fitting%rings = body%rings
    call choose_shapes(body, ends(:, 1) - reach, ends(:, 2) + reach, fitting%turns, &
                       lattice%margin, lattice%ndim, fitting%shapes)
    call lattice_fitting_prepare(fitting, lattice%ndim)
  end subroutine prepare_fitting

  !> Gives a particle its share, and moves it as far as that lies beside the middle of its cube.
  pure subroutine take_share(share, middle, rings, point, volume)
    type(share_t), intent(in) :: share
    real(dp), intent(in) :: middle(3)
    logical, intent(in) :: rings
    real(dp), intent(inout) :: point(3)          !! with its jitter
    real(dp), intent(out) :: volume
    real(dp) :: moved(3)
    volume = share%volume
    moved = point + (share%centre - middle)
    if (rings .and. moved(1) <= 0.0_dp) moved(1) = share%centre(1)
    point = moved
  end subroutine take_share

  !> Those shapes of a body that decide about the points of a box, none where it is outside.
  pure subroutine choose_shapes(body, lower, upper, placed, margin, ndim, shapes)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: lower(3), upper(3)
    logical, intent(in) :: placed           !! the box is where the body is, after its turn
    real(dp), intent(in) :: margin          !! of boundaries (length)
    integer, intent(in) :: ndim
    type(shape_t), allocatable, intent(out) :: shapes(:)
    real(dp) :: low(3), high(3), wide
    low = lower
    high = upper
    if (placed) call turn_box(turn_inverse(body%turn), low, high)
    wide = 2.0_dp*margin + 1.0e-9_dp*maxval(abs([low(:ndim), high(:ndim)]))  ! beyond all rounding
    shapes = shapes_near(body%shapes, low - wide, high + wide, ndim)
    if (.not. any(shapes%combine == combine_union)) shapes = shapes(:0)
  end subroutine choose_shapes

  !> All particles of a body: counts, then stores them, every thread some layers.
  subroutine fill_body(body, lattice, positions, volumes)
    type(body_card_t), intent(in) :: body
    type(lattice_t), intent(in) :: lattice
    real(dp), allocatable, intent(out) :: positions(:, :), volumes(:)
    integer, allocatable :: before(:)    ! particles before those of each layer
    integer :: layer, layers
    layers = lattice_layers(lattice)
    allocate (before(layers + 1), source=0)
    !$omp parallel do schedule(dynamic) default(none) shared(body, lattice, layers, before)
    do layer = 1, layers
      call count_layer(body, lattice, layer, before(layer + 1))
    end do
    !$omp end parallel do
    do layer = 1, layers
      before(layer + 1) = before(layer) + before(layer + 1)
    end do
    allocate (positions(3, before(layers + 1)), volumes(before(layers + 1)))
    !$omp parallel do schedule(dynamic) default(none) &
    !$omp& shared(body, lattice, layers, before, positions, volumes)
    do layer = 1, layers
      if (before(layer + 1) == before(layer)) cycle
      call fill_layer(body, lattice, layer, positions(:, before(layer) + 1:before(layer + 1)), &
                      volumes(before(layer) + 1:before(layer + 1)))
    end do
    !$omp end parallel do
  end subroutine fill_body

  !> Counts the particles of a layer.
  pure subroutine count_layer(body, lattice, layer, n)
    type(body_card_t), intent(in) :: body
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: layer
    integer, intent(out) :: n
    type(line_t) :: found
    integer :: line
    n = 0
    do line = 1, lattice_lines(lattice)
      call fill_line(body, lattice, line, layer, found)
      n = n + found%n
    end do
  end subroutine count_layer

  !> Stores the particles of a layer.
  pure subroutine fill_layer(body, lattice, layer, positions, volumes)
    type(body_card_t), intent(in) :: body
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: layer
    real(dp), intent(inout) :: positions(:, :), volumes(:)  !! of the layer
    type(line_t) :: found
    integer :: line, n
    n = 0
    do line = 1, lattice_lines(lattice)
      call fill_line(body, lattice, line, layer, found, volumes=.true.)
      positions(:, n + 1:n + found%n) = found%position(:, :found%n)
      volumes(n + 1:n + found%n) = found%volume(:found%n)
      n = n + found%n
    end do
  end subroutine fill_layer

  !> Counts, then stores the particles of a slab, in the layers that reach into it.
  pure subroutine fill_slab(body, lattice, slab, survey, positions, volumes, ids)
    type(body_card_t), intent(in) :: body
    type(lattice_t), intent(in) :: lattice
    type(slab_t), intent(in) :: slab
    type(survey_t), intent(in) :: survey
    real(dp), allocatable, intent(out) :: positions(:, :), volumes(:)
    integer(i4), allocatable, intent(out) :: ids(:)
    type(line_t) :: found
    integer :: pass, layer, line, p, n
    integer(i4) :: id
    do pass = 1, 2
      n = 0
      do layer = 1, size(survey%points)
        if (survey%points(layer) == 0) cycle
        if (survey%highest(layer) < slab%own(1) .or. survey%lowest(layer) > slab%own(2)) cycle
        id = sum(survey%points(:layer - 1))
        do line = 1, lattice_lines(lattice)
          call fill_line(body, lattice, line, layer, found, volumes=.true.)
          do p = 1, found%n
            id = id + 1
            if (.not. slab_holds(slab, found%position(:, p))) cycle
            n = n + 1
            if (pass == 1) cycle
            positions(:, n) = found%position(:, p)
            volumes(n) = found%volume(p)
            ids(n) = id
          end do
        end do
      end do
      if (pass == 1) allocate (positions(3, n), volumes(n), ids(n))
    end do
  end subroutine fill_slab

  !> Leaves only the particles of a slab.
  pure subroutine keep_slab(slab, positions, volumes, ids)
    type(slab_t), intent(in) :: slab
    real(dp), allocatable, intent(inout) :: positions(:, :), volumes(:)
    integer(i4), allocatable, intent(out) :: ids(:)
    integer :: p
    ids = pack([(p, p=1, size(volumes))], &
               [(slab_holds(slab, positions(:, p)), p=1, size(volumes))])
    positions = positions(:, ids)
    volumes = volumes(ids)
  end subroutine keep_slab

  !> An error where a body is not inside the faces of the grid, or a wall cuts it.
  subroutine seeding_check_inside(body, mesh, coordinates, error)
    type(body_card_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coordinates(:, :)    !! (3, n) of its particles (cells)
    type(error_t), allocatable, intent(out) :: error
    integer :: d, p
    do p = 1, size(coordinates, 2)
      do d = 1, mesh%ndim
        if (coordinates(d, p) >= mesh%lower(d) .and. coordinates(d, p) <= mesh%upper(d)) cycle
        call error_make(error, exit_deck, &
          "body '"//trim(body%name)//"' reaches out of the grid "// &
                        'along '//axis_names(d, mesh%space)//', where it has a particle at '// &
                        real_text(mesh_place(mesh, d, coordinates(d, p))), &
                        'move or cut the body, widen the grid, or leave that face open', &
                        place_of(body))
        return
      end do
    end do
  end subroutine seeding_check_inside

  !> An error where a particle is wider than half of a cell of a grid with unequal cells. Gauss
  !! points divide what lies between nodes, in a grading up to a quarter more than between centres.
  subroutine seeding_check_size(body, mesh, coordinates, volumes, error)
    type(body_card_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coordinates(:, :)    !! (3, n) of its particles (cells)
    real(dp), intent(in) :: volumes(:)
    type(error_t), allocatable, intent(inout) :: error
    real(dp), parameter :: between_centres = 0.5_dp*(1.0_dp + 1.0e-6_dp)
    real(dp), parameter :: between_nodes = 1.25_dp*between_centres
    real(dp), parameter :: at_surfaces = 1.5_dp*between_centres  !! with shares of cut cubes
    real(dp) :: side, most, volume
    integer :: p
    if (.not. mesh%graded) return
    most = merge(between_nodes, between_centres, body%layout == layout_gauss)
    if (body%layout == layout_graded .and. body%fitted) most = at_surfaces
    do p = 1, size(volumes)
      volume = volumes(p)
      if (body%layout == layout_lattice) then
        volume = min(volume, cube_of(body, mesh, coordinates(:, p)))
      end if
      side = mesh_occupied(mesh, coordinates(:, p), volume)**(1.0_dp/mesh%ndim)
      if (side <= most) cycle
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' has particles as wide as "// &
                      real_text(side)//' cells where they begin; where cells are unequal half '// &
                      'a cell is the most', 'write ppc=2 or more, or a smaller spacing', &
                      place_of(body))
      return
    end do
  end subroutine seeding_check_size

  !> Volume of a whole cube of a body's lattice at a place.
  pure function cube_of(body, mesh, coordinate) result(volume)
    type(body_card_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coordinate(3)        !! (cells)
    real(dp) :: volume
    volume = body%spacing**mesh%ndim
    if (body%rings) volume = 2.0_dp*pi*mesh_place(mesh, 1, coordinate(1))*volume
  end function cube_of

  !> Volume of a body's shapes to a tenth of a percent (length**dimension; of rings length**3), 0
  !! where it has none.
  pure function seeding_shape_volume(body, ndim, bodies, section) result(volume)
    type(body_card_t), intent(in) :: body
    integer, intent(in) :: ndim
    integer, intent(in) :: bodies                !! of the scene, who share the effort
    logical, intent(in), optional :: section     !! of rings, the area of their section instead
    real(dp) :: volume
    logical :: rings
    integer, parameter :: effort = 2**22, finest(3) = [64, 512, 64], coarsest = 12
    volume = 0.0_dp
    if (body%layout == layout_file) return
    rings = body%rings .and. .not. present(section)
    volume = shapes_volume(body%shapes, ndim, max(coarsest, min(finest(ndim), int( &
                           (real(effort, dp)/bodies)**(1.0_dp/ndim)))), rings)
  end function seeding_shape_volume

  !> An error where another body's shape contains one of these particles and neither body allows it.
  subroutine seeding_check_overlap(bodies, own, positions, dimension, error)
    type(body_card_t), intent(in) :: bodies(:)
    integer, intent(in) :: own                  !! the body that the particles belong to
    real(dp), intent(in) :: positions(:, :)     !! (3, n)
    integer, intent(in) :: dimension            !! 1, 2 or 3
    type(error_t), allocatable, intent(out) :: error
    integer :: other
    other = seeding_overlap(bodies, own, positions, dimension)
    if (other == 0) return
    call error_make(error, exit_deck, "body '"//trim(bodies(own)%name)//"' overlaps body '"// &
                    trim(bodies(other)%name)//"'", 'move one of them, or say overlap=allow', &
                    place_of(bodies(own)))
  end subroutine seeding_check_overlap

  !> Number of another body whose shape contains one of these particles, 0 where there is none.
  pure function seeding_overlap(bodies, own, positions, dimension) result(other)
    type(body_card_t), intent(in) :: bodies(:)
    integer, intent(in) :: own                  !! the body that the particles belong to
    real(dp), intent(in) :: positions(:, :)     !! (3, n)
    integer, intent(in) :: dimension            !! 1, 2 or 3
    type(shape_t), allocatable :: shapes(:)
    real(dp) :: lower(3), upper(3), point(3), margin
    integer :: other, p
    lower = minval(positions, dim=2)
    upper = maxval(positions, dim=2)
    do other = 1, size(bodies)
      if (other == own .or. .not. allocated(bodies(other)%shapes)) cycle
      if (bodies(other)%allow_overlap .or. bodies(own)%allow_overlap) cycle
      if (bodies(other)%layout == layout_file .or. size(positions, 2) == 0) cycle
      margin = lattice_tolerance*bodies(other)%spacing
      call choose_shapes(bodies(other), lower, upper, .true., margin, dimension, shapes)
      if (size(shapes) == 0) cycle
      do p = 1, size(positions, 2)
        point = positions(:, p)
        call turn_back(bodies(other)%turn, point)
        if (shapes_inside(shapes, point, dimension, margin)) return
      end do
    end do
    other = 0
  end function seeding_overlap

  pure function place_of(body) result(place)
    type(body_card_t), intent(in) :: body
    character(:), allocatable :: place
    place = ''
    if (allocated(body%location)) place = body%location
  end function place_of

end module sgmp_seeding
