!> Bodies to particles: shapes combined, filled with a cubic lattice, with Gauss points, or from a
!! file.
!!
!! Particles come in a fixed order: x fastest, then y, then z of the lattice. A volume is per unit
!! area in 1D and per unit
!! thickness in 2D. Everything is reproducible; the jitter is a hash of the lattice indices.
module sgmp_seeding
  use sgmp_errors, only: error_make, error_t, exit_deck, exit_io
  use sgmp_kinds, only: dp, i4, i8, pi
  use sgmp_scene, only: body_card_t, layout_file, layout_gauss
  use sgmp_shapes, only: combine_difference, combine_union, shape_block, shape_cone, &
                         shape_halfspace, shape_ogive, shape_ring, shape_sphere, shape_t
  use sgmp_slabs, only: slab_holds, slab_plane, slab_t
  implicit none
  private
  public :: seeding_generate, seeding_check_overlap, seeding_overlap, seeding_inside, &
            seeding_gauss_points, seeding_turned, seeding_survey, survey_t

  real(dp), parameter :: tolerance = 1.0e-9_dp     !! of boundaries, in lattice constants
  real(dp), parameter :: infinite = 0.1_dp*huge(1.0_dp)

  !> Where the candidates for particles are: points `coordinate(index, axis)` of a rectilinear grid.
  type :: candidates_t
    integer :: first(3) = 0
      !! lattice index of the first point along each axis
    integer :: count(3) = 1                        !! points along each axis
    real(dp), allocatable :: coordinate(:, :)      !! (point, axis)
    real(dp), allocatable :: length(:, :)          !! (point, axis): share of the volume
    real(dp) :: margin = 0.0_dp                    !! tolerance of boundaries (length)
    real(dp) :: jitter = 0.0_dp                    !! largest displacement (length)
    logical :: turn_before = .false.               !! membership is decided at the turned-back point
    logical :: turn_after = .false.                !! points are turned after membership is decided
  end type candidates_t

  !> Where a body's particles are, before any of them is made.
  type :: survey_t
    integer, allocatable :: points(:)              !! (layers of the lattice) particles
    integer, allocatable :: lowest(:), highest(:)  !! (layers) planes of bins they are in
    integer :: first = 0                           !! first plane of `load`
    integer, allocatable :: load(:)                !! (planes) particles
  end type survey_t

contains

  !> Fills a body with particles; an error where it is unbounded, empty, too large or its file is
  !! wrong.
  subroutine seeding_generate(body, cell, grid_lower, dimension, positions, volumes, error, &
                              velocities, slab, survey, ids)
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
    type(candidates_t) :: candidates
    integer :: n
    if (body%layout == layout_file) then
      call read_particles(body, positions, volumes, error, velocities)
      if (present(slab) .and. .not. allocated(error)) then
        call keep_slab(slab, positions, volumes, ids)
      end if
      return
    end if
    call list_candidates(body, cell, grid_lower, dimension, candidates, error)
    if (allocated(error)) return
    if (present(slab)) then
      call select_slab(body, candidates, dimension, slab, survey, positions, volumes, ids)
      return
    end if
    call select_points(body, candidates, dimension, .false., n, positions, volumes)
    if (n == 0) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' has no particles", &
                      'use a smaller spacing or check its shapes', place_of(body))
      return
    end if
    allocate (positions(3, n), volumes(n))
    call select_points(body, candidates, dimension, .true., n, positions, volumes)
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
    type(candidates_t) :: candidates
    real(dp), allocatable :: positions(:, :), volumes(:)
    real(dp) :: point(3)
    integer :: layer, line, i, p, ijk(3)
    logical :: inside
    if (body%layout == layout_file) then
      call read_particles(body, positions, volumes, error)
      if (allocated(error)) return
      call survey_open(survey, 1)
      do p = 1, merge(size(volumes), 0, sharer == 0)
        call survey_note(survey, 1, slab_plane(slab, positions(:, p)))
      end do
      return
    end if
    call list_candidates(body, cell, grid_lower, dimension, candidates, error)
    if (allocated(error)) return
    call survey_open(survey, layers_of(candidates, dimension))
    do layer = 1 + sharer, size(survey%points), sharers
      do line = 1, lines_of(candidates, dimension)
        do i = 1, candidates%count(1)
          ijk = [i, line, layer]
          if (dimension == 2) ijk = [i, layer, 1]
          call candidate_point(body, candidates, ijk, dimension, inside, point)
          if (inside) call survey_note(survey, layer, slab_plane(slab, point))
        end do
      end do
    end do
  end subroutine seeding_survey

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

  !> Layers of the lattice, the slowest of its axes; in 1D its points.
  pure function layers_of(candidates, dimension) result(layers)
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: dimension
    integer :: layers
    layers = 1
    if (dimension > 1) layers = candidates%count(dimension)
  end function layers_of

  !> Lines of candidates in a layer.
  pure function lines_of(candidates, dimension) result(lines)
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: dimension
    integer :: lines
    lines = merge(candidates%count(2), 1, dimension == 3)
  end function lines_of

  !> Counts, then stores the particles of a slab, in the layers that reach into it.
  subroutine select_slab(body, candidates, dimension, slab, survey, positions, volumes, ids)
    type(body_card_t), intent(in) :: body
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: dimension
    type(slab_t), intent(in) :: slab
    type(survey_t), intent(in) :: survey
    real(dp), allocatable, intent(out) :: positions(:, :), volumes(:)
    integer(i4), allocatable, intent(out) :: ids(:)
    real(dp) :: point(3)
    integer :: pass, layer, line, i, n, ijk(3)
    integer(i4) :: id
    logical :: inside
    do pass = 1, 2
      n = 0
      do layer = 1, size(survey%points)
        if (survey%points(layer) == 0) cycle
        if (survey%highest(layer) < slab%own(1) .or. survey%lowest(layer) > slab%own(2)) cycle
        id = sum(survey%points(:layer - 1))
        do line = 1, lines_of(candidates, dimension)
          do i = 1, candidates%count(1)
            ijk = [i, line, layer]
            if (dimension == 2) ijk = [i, layer, 1]
            call candidate_point(body, candidates, ijk, dimension, inside, point)
            if (.not. inside) cycle
            id = id + 1
            if (.not. slab_holds(slab, point)) cycle
            n = n + 1
            if (pass == 1) cycle
            positions(:, n) = point
            volumes(n) = candidate_volume(candidates, ijk)
            ids(n) = id
          end do
        end do
      end do
      if (pass == 1) allocate (positions(3, n), volumes(n), ids(n))
    end do
  end subroutine select_slab

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
  pure integer function seeding_overlap(bodies, own, positions, dimension) result(other)
    type(body_card_t), intent(in) :: bodies(:)
    integer, intent(in) :: own                  !! the body that the particles belong to
    real(dp), intent(in) :: positions(:, :)     !! (3, n)
    integer, intent(in) :: dimension            !! 1, 2 or 3
    integer :: p
    real(dp) :: margin
    do other = 1, size(bodies)
      if (other == own .or. .not. allocated(bodies(other)%shapes)) cycle
      if (bodies(other)%allow_overlap .or. bodies(own)%allow_overlap) cycle
      if (bodies(other)%layout == layout_file) cycle
      margin = tolerance*bodies(other)%spacing
      do p = 1, size(positions, 2)
        if (seeding_inside(bodies(other)%shapes, &
                           seeding_turned(bodies(other), positions(:, p), -1), &
                           dimension, margin)) return
      end do
    end do
    other = 0
  end function seeding_overlap

  !> Whether a point lies in a combination of shapes; lower boundaries belong to a shape, upper ones
  !! do not.
  pure logical function seeding_inside(shapes, point, dimension, margin) result(inside)
    type(shape_t), intent(in) :: shapes(:)   !! combined in order
    real(dp), intent(in) :: point(3)
    integer, intent(in) :: dimension         !! 1, 2 or 3
    real(dp), intent(in) :: margin           !! by which boundaries are moved down
    integer :: i
    inside = .false.
    do i = 1, size(shapes)
      select case (shapes(i)%combine)
      case (combine_union)
        inside = inside .or. in_shape(shapes(i), point, dimension, margin)
      case (combine_difference)
        inside = inside .and. .not. in_shape(shapes(i), point, dimension, margin)
      case default  ! combine_intersection
        inside = inside .and. in_shape(shapes(i), point, dimension, margin)
      end select
    end do
  end function seeding_inside

  !> Gauss-Legendre points and weights on [-1, 1].
  pure subroutine seeding_gauss_points(n, points, weights)
    integer, intent(in) :: n
    real(dp), intent(out) :: points(n), weights(n)
    real(dp) :: x, step, value, slope
    integer :: i, iteration
    do i = 1, n
      x = -cos(pi*(i - 0.25_dp)/(n + 0.5_dp))
      do iteration = 1, 100
        call legendre(n, x, value, slope)
        step = value/slope
        x = x - step
        if (abs(step) < 1.0e-15_dp) exit
      end do
      call legendre(n, x, value, slope)
      points(i) = x
      weights(i) = 2.0_dp/((1.0_dp - x**2)*slope**2)
    end do
    if (mod(n, 2) == 1) points(n/2 + 1) = 0.0_dp
  end subroutine seeding_gauss_points

  pure subroutine legendre(n, x, value, slope)
    integer, intent(in) :: n
    real(dp), intent(in) :: x
    real(dp), intent(out) :: value, slope
    real(dp) :: before, new
    integer :: k
    before = 1.0_dp
    value = x
    do k = 2, n
      new = ((2*k - 1)*x*value - (k - 1)*before)/k
      before = value
      value = new
    end do
    slope = n*(x*value - before)/(x**2 - 1.0_dp)
  end subroutine legendre

  pure logical function in_shape(shape, point, dimension, margin) result(inside)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: point(3), margin
    integer, intent(in) :: dimension
    real(dp) :: along, radius, outer
    if (shape%kind == shape_block) then
      inside = all(point(:dimension) >= shape%lower(:dimension) - margin .and. &
                   point(:dimension) < shape%upper(:dimension) - margin)
      return
    end if
    along = dot_product(point - shape%centre, shape%axis)
    if (shape%kind == shape_halfspace) then
      inside = along < -margin
      return
    end if
    if (shape%kind == shape_sphere) then
      inside = norm2(point - shape%centre) <= shape%radius + margin
      return
    end if
    radius = norm2(point - shape%centre - along*shape%axis)
    inside = along >= -margin .and. along < shape%length - margin
    if (.not. inside) return
    outer = shape%radius
    if (shape%kind == shape_cone .and. shape%length < infinite) then
      outer = shape%radius + (shape%radius2 - shape%radius)*along/shape%length
    else if (shape%kind == shape_ogive .and. shape%length < infinite) then
      outer = ogive_radius(shape, along)
    end if
    inside = radius <= outer + margin
    if (shape%kind == shape_ring) inside = inside .and. radius >= shape%radius2 - margin
  end function in_shape

  !> Tangent ogive: an arc that leaves the base at a right angle and ends in the tip.
  pure real(dp) function ogive_radius(shape, along) result(radius)
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: along  !! distance from the base
    real(dp) :: arc
    arc = (shape%radius**2 + shape%length**2)/(2.0_dp*shape%radius)
    radius = sqrt(max(0.0_dp, arc**2 - along**2)) - (arc - shape%radius)
  end function ogive_radius

  !> The points among which the shapes select.
  subroutine list_candidates(body, cell, grid_lower, dimension, candidates, error)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: cell, grid_lower(3)
    integer, intent(in) :: dimension
    type(candidates_t), intent(out) :: candidates
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: lower(3), upper(3), origin(3), fraction(body%ppc), weight(body%ppc), pitch
    real(dp) :: points(3)
    integer :: per_pitch, i, axis, k, offset(3)
    logical :: gauss
    gauss = body%layout == layout_gauss
    candidates%turn_before = gauss
    candidates%turn_after = .not. gauss
    call bounding_box(body%shapes, lower, upper)
    if (gauss) call turn_box(body, dimension, lower, upper)
    if (gauss) then
      pitch = cell
      origin = grid_lower
      per_pitch = body%ppc
      call seeding_gauss_points(body%ppc, fraction, weight)
      fraction = 0.5_dp*(1.0_dp + fraction)
    else
      pitch = body%spacing
      origin = lattice_origin(body)
      per_pitch = 1
      fraction = 0.5_dp
      weight = 2.0_dp
      candidates%jitter = body%jitter*body%spacing
    end if
    candidates%margin = tolerance*pitch
    if (any(abs(lower(:dimension)) > infinite) .or. any(abs(upper(:dimension)) > infinite)) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' is unbounded", &
                      'give its shapes a finite length', place_of(body))
      return
    end if
    points = 1.0_dp
    points(:dimension) = ((upper(:dimension) - lower(:dimension))/pitch + 2.0_dp)*per_pitch
    if (product(points) > real(huge(1), dp)) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' would have too many "// &
                      'particles', &
                      'use a larger spacing; there can be 2147483647', place_of(body))
      return
    end if
    if (any(abs(lower(:dimension) - origin(:dimension)) > 0.25_dp*huge(1)*pitch/per_pitch)) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' is too far from the "// &
                      'origin of its lattice', 'move lattice_origin or the grid', place_of(body))
      return
    end if
    offset = 0
    offset(:dimension) = floor((lower(:dimension) - origin(:dimension))/pitch - tolerance)
    candidates%first = offset*per_pitch
    candidates%count(:dimension) = nint(points(:dimension))
    allocate (candidates%coordinate(maxval(candidates%count), 3), source=0.0_dp)
    allocate (candidates%length(maxval(candidates%count), 3), source=1.0_dp)
    do axis = 1, dimension
      do i = 1, candidates%count(axis)
        k = 1 + mod(i - 1, per_pitch)
        candidates%coordinate(i, axis) = origin(axis) + &
                                         (offset(axis) + (i - 1)/per_pitch + fraction(k))*pitch
        candidates%length(i, axis) = 0.5_dp*weight(k)*pitch
      end do
    end do
  end subroutine list_candidates

  !> Counts the candidates inside the body and, where asked to, stores them.
  pure subroutine select_points(body, candidates, dimension, store, n, positions, volumes)
    type(body_card_t), intent(in) :: body
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: dimension
    logical, intent(in) :: store
    integer, intent(out) :: n
    real(dp), allocatable, intent(inout) :: positions(:, :)  !! (3, n)
    real(dp), allocatable, intent(inout) :: volumes(:)      !! (n)
    real(dp) :: point(3)
    integer :: i, j, k
    logical :: inside
    n = 0
    do k = 1, candidates%count(3)
      do j = 1, candidates%count(2)
        do i = 1, candidates%count(1)
          call candidate_point(body, candidates, [i, j, k], dimension, inside, point)
          if (.not. inside) cycle
          n = n + 1
          if (.not. store) cycle
          positions(:, n) = point
          volumes(n) = candidate_volume(candidates, [i, j, k])
        end do
      end do
    end do
  end subroutine select_points

  !> A candidate: whether it is inside the body, and if so the position of its particle.
  pure subroutine candidate_point(body, candidates, ijk, dimension, inside, point)
    type(body_card_t), intent(in) :: body
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: ijk(3)   !! number of the candidate along each axis
    integer, intent(in) :: dimension
    logical, intent(out) :: inside
    real(dp), intent(out) :: point(3)
    real(dp) :: tested(3)
    integer :: axis
    do axis = 1, 3
      point(axis) = candidates%coordinate(ijk(axis), axis)
    end do
    tested = point
    if (candidates%turn_before) tested = seeding_turned(body, point, -1)
    inside = seeding_inside(body%shapes, tested, dimension, candidates%margin)
    if (.not. inside) return
    call displace(candidates, ijk, dimension, point)
    if (candidates%turn_after) point = seeding_turned(body, point, 1)
  end subroutine candidate_point

  !> Volume of a candidate's particle.
  pure function candidate_volume(candidates, ijk) result(volume)
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: ijk(3)
    real(dp) :: volume
    volume = candidates%length(ijk(1), 1)*candidates%length(ijk(2), 2)*candidates%length(ijk(3), 3)
  end function candidate_volume

  !> Moves a point by its reproducible jitter.
  pure subroutine displace(candidates, ijk, dimension, point)
    type(candidates_t), intent(in) :: candidates
    integer, intent(in) :: ijk(3)   !! number of the candidate along each axis
    integer, intent(in) :: dimension
    real(dp), intent(inout) :: point(3)
    integer :: axis
    if (candidates%jitter <= 0.0_dp) return
    do axis = 1, dimension
      point(axis) = point(axis) + candidates%jitter*unit_hash(candidates%first + ijk, axis)
    end do
  end subroutine displace

  !> A number in [-1, 1] that depends on lattice indices and axis only (a chain of Lehmer
  !! generators).
  pure real(dp) function unit_hash(ijk, axis) result(number)
    integer, intent(in) :: ijk(3), axis
    integer(i8), parameter :: modulus = 2147483647_i8, multiplier = 48271_i8
    integer(i8) :: state
    integer :: i, round
    state = 12345 + axis
    do i = 1, 3
      state = modulo(state*multiplier + ijk(i), modulus)
      do round = 1, 3
        state = modulo((state + 1)*multiplier + 1, modulus)
      end do
    end do
    number = 2.0_dp*real(state, dp)/real(modulus - 1, dp) - 1.0_dp
  end function unit_hash

  !> Turns a point about z through the pivot, forth (+1) or back (-1).
  pure function seeding_turned(body, point, direction) result(image)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: point(3)
    integer, intent(in) :: direction
    real(dp) :: image(3), c, s, x, y
    image = point
    if (abs(body%rotation) <= 0.0_dp) return
    c = cos(body%rotation*pi/180.0_dp)
    s = direction*sin(body%rotation*pi/180.0_dp)
    x = point(1) - body%pivot(1)
    y = point(2) - body%pivot(2)
    image(1) = body%pivot(1) + c*x - s*y
    image(2) = body%pivot(2) + s*x + c*y
  end function seeding_turned

  !> The box around a turned box.
  pure subroutine turn_box(body, dimension, lower, upper)
    type(body_card_t), intent(in) :: body
    integer, intent(in) :: dimension
    real(dp), intent(inout) :: lower(3), upper(3)
    real(dp) :: corners(3, 4)
    if (abs(body%rotation) <= 0.0_dp .or. dimension == 1) return
    if (any(abs([lower(1:2), upper(1:2)]) > infinite)) return
    corners(:, 1) = seeding_turned(body, lower, 1)
    corners(:, 2) = seeding_turned(body, upper, 1)
    corners(:, 3) = seeding_turned(body, [lower(1), upper(2), lower(3)], 1)
    corners(:, 4) = seeding_turned(body, [upper(1), lower(2), lower(3)], 1)
    lower(1:2) = minval(corners(1:2, :), dim=2)
    upper(1:2) = maxval(corners(1:2, :), dim=2)
  end subroutine turn_box

  !> The box around the shapes that are united; the others only take away.
  pure subroutine bounding_box(shapes, lower, upper)
    type(shape_t), intent(in) :: shapes(:)
    real(dp), intent(out) :: lower(3), upper(3)
    real(dp) :: low(3), high(3)
    integer :: i
    lower = huge(1.0_dp)
    upper = -huge(1.0_dp)
    do i = 1, size(shapes)
      if (shapes(i)%combine /= combine_union) cycle
      call shape_box(shapes(i), low, high)
      lower = min(lower, low)
      upper = max(upper, high)
    end do
  end subroutine bounding_box

  pure subroutine shape_box(shape, lower, upper)
    type(shape_t), intent(in) :: shape
    real(dp), intent(out) :: lower(3), upper(3)
    real(dp) :: reach(3), far_end(3)
    integer :: i
    select case (shape%kind)
    case (shape_block)
      lower = shape%lower
      upper = shape%upper
    case (shape_sphere)
      lower = shape%centre - shape%radius
      upper = shape%centre + shape%radius
    case (shape_halfspace)
      lower = -huge(1.0_dp)
      upper = huge(1.0_dp)
    case default
      reach = max(shape%radius, merge(shape%radius2, 0.0_dp, shape%kind == shape_cone))* &
              sqrt(max(0.0_dp, 1.0_dp - shape%axis**2))
      do i = 1, 3
        far_end(i) = shape%centre(i)
        if (abs(shape%axis(i)) > epsilon(1.0_dp)) far_end(i) = end_along(shape, i)
      end do
      lower = min(shape%centre, far_end) - reach
      upper = max(shape%centre, far_end) + reach
    end select
  end subroutine shape_box

  pure real(dp) function end_along(shape, axis) result(coordinate)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    coordinate = sign(huge(1.0_dp), shape%axis(axis))
    if (shape%length < infinite) coordinate = shape%centre(axis) + shape%axis(axis)*shape%length
  end function end_along

  !> A corner of the lattice: as given, or the first shape's lower corner; round shapes have their
  !! axis
  !! (a sphere its centre) at a corner, so that the particles lie symmetrically about it.
  pure function lattice_origin(body) result(origin)
    type(body_card_t), intent(in) :: body
    real(dp) :: origin(3), lower(3), upper(3)
    if (all(body%lattice_origin < infinite)) then
      origin = body%lattice_origin
      return
    end if
    associate (shape => body%shapes(1))
      call shape_box(shape, lower, upper)
      origin = lower
      if (shape%kind == shape_block) return
      origin = shape%centre
      ! along its own direction the lattice starts at the lower end
      if (shape%kind == shape_sphere) return
      if (shape%length >= infinite) return
      where (abs(shape%axis) > 1.0_dp - 1.0e-12_dp) origin = lower
    end associate
  end function lattice_origin

  !> Reads `x y z volume [velocity_x velocity_y velocity_z]`, one particle per line, # and !
  !! comments.
  subroutine read_particles(body, positions, volumes, error, velocities)
    type(body_card_t), intent(in) :: body
    real(dp), allocatable, intent(out) :: positions(:, :), volumes(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable, intent(out), optional :: velocities(:, :)
    real(dp), allocatable :: rows(:, :)
    integer :: unit, status, columns
    open (newunit=unit, file=body%file, status='old', action='read', iostat=status)
    if (status /= 0) then
      call error_make(error, exit_io, "the particle file '"//body%file//"' cannot be opened", &
                      'check its path', place_of(body))
      return
    end if
    call read_rows(unit, body%file, rows, columns, error)
    close (unit)
    if (allocated(error)) return
    if (size(rows, 2) == 0) then
      call error_make(error, exit_deck, "the particle file '"//body%file//"' has no particles", &
                      'a line per particle: x y z volume', place_of(body))
      return
    end if
    positions = rows(1:3, :)
    volumes = rows(4, :)
    if (present(velocities) .and. columns == 7) velocities = rows(5:7, :)
  end subroutine read_particles

  !> All rows of a particle file; the first decides whether there are 4 or 7 columns.
  subroutine read_rows(unit, file, rows, columns, error)
    integer, intent(in) :: unit
    character(*), intent(in) :: file
    real(dp), allocatable, intent(out) :: rows(:, :)  !! (7, n)
    integer, intent(out) :: columns
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: longer(:, :)
    character(1000) :: line
    character(12) :: number
    integer, parameter :: most = 7
    real(dp) :: row(most)
    integer :: n, status, line_number
    allocate (rows(most, 1000))
    columns = 0
    n = 0
    line_number = 0
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      line_number = line_number + 1
      if (scan(line, '#!') > 0) line = line(:scan(line, '#!') - 1)
      if (line == '') cycle
      row = 0.0_dp
      if (columns == 0) columns = merge(most, 4, readable(line, most))
      read (line, *, iostat=status) row(:columns)
      if (status == 0 .and. any(.not. abs(row) <= infinite)) status = 1
      if (status /= 0 .or. row(4) <= 0.0_dp) then
        write (number, '(i0)') line_number
        call error_make(error, exit_deck, 'not a particle: '//trim(line), &
                        'expected: x y z volume [velocity_x velocity_y velocity_z], volume > 0', &
                        file//':'//trim(number)//':1')
        return
      end if
      if (n == size(rows, 2)) then
        allocate (longer(most, 2*n))
        longer(:, :n) = rows
        call move_alloc(longer, rows)
      end if
      n = n + 1
      rows(:, n) = row
    end do
    longer = rows(:, :n)
    call move_alloc(longer, rows)
  end subroutine read_rows

  !> Whether a line holds this many numbers.
  function readable(line, columns) result(yes)
    character(*), intent(in) :: line
    integer, intent(in) :: columns
    logical :: yes
    real(dp) :: row(columns)
    integer :: status
    read (line, *, iostat=status) row
    yes = status == 0
  end function readable

  pure function place_of(body) result(place)
    type(body_card_t), intent(in) :: body
    character(:), allocatable :: place
    place = ''
    if (allocated(body%location)) place = body%location
  end function place_of

end module sgmp_seeding
