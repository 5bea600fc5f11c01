!> Where particles may be: points of a rectilinear lattice with the volume that each stands for,
!! cubic or of Gauss-Legendre points in every cell of the grid.
!!
!! Points come in a fixed order: x fastest, then y, then z. A volume is per unit area in 1D and per
!! unit thickness in 2D. The jitter is a hash of the lattice's indices, thus reproducible.
module sgmp_lattice
  use sgmp_graded_axis, only: graded_axis_t, graded_centre, graded_coordinate, graded_node
  use sgmp_kinds, only: dp, i8, pi
  implicit none
  private
  public :: lattice_t, lattice_cubic, lattice_gauss, lattice_graded, lattice_ijk, &
            lattice_jitter, lattice_layers, lattice_lines, lattice_point, lattice_volume, &
            gauss_points
  public :: lattice_fits, lattice_too_far, lattice_too_many, lattice_tolerance

  real(dp), parameter :: lattice_tolerance = 1.0e-9_dp  !! of boundaries, in lattice constants
  integer, parameter :: lattice_fits = 0, lattice_too_many = 1, lattice_too_far = 2

  !> A piece of a lattice.
  type :: lattice_t
    integer :: ndim = 3
    integer :: first(3) = 0                        !! index of the first point along each axis
    integer :: count(3) = 1                        !! points along each axis
    real(dp), allocatable :: coordinate(:, :)      !! (point, axis)
    real(dp), allocatable :: length(:, :)          !! (point, axis): share of the volume
    real(dp) :: margin = 0.0_dp                    !! tolerance of boundaries (length)
    real(dp) :: jitter = 0.0_dp                    !! largest displacement (length)
    logical :: cut = .false.                       !! what it fills takes parts of cubes
  end type lattice_t

contains

  !> Centres of cubes that fill a box.
  pure subroutine lattice_cubic(lower, upper, corner, spacing, jitter, ndim, lattice, status)
    real(dp), intent(in) :: lower(3), upper(3)     !! of the box
    real(dp), intent(in) :: corner(3)              !! a corner of a cube
    real(dp), intent(in) :: spacing
    real(dp), intent(in) :: jitter                 !! largest displacement (spacings)
    integer, intent(in) :: ndim
    type(lattice_t), intent(out) :: lattice
    integer, intent(out) :: status                 !! lattice_fits, or why not
    call lay_out(lower, upper, corner, spacing, [0.5_dp], [2.0_dp], ndim, lattice, status)
    lattice%jitter = jitter*spacing
  end subroutine lattice_cubic

  !> Gauss-Legendre points of the cells of a grid that fill a box.
  pure subroutine lattice_gauss(lower, upper, corner, cell, points, ndim, lattice, status)
    real(dp), intent(in) :: lower(3), upper(3)     !! of the box
    real(dp), intent(in) :: corner(3)              !! a corner of a cell
    real(dp), intent(in) :: cell
    integer, intent(in) :: points                  !! per cell and axis
    integer, intent(in) :: ndim
    type(lattice_t), intent(out) :: lattice
    integer, intent(out) :: status                 !! lattice_fits, or why not
    real(dp) :: place(points), weight(points)
    call gauss_points(points, place, weight)
    call lay_out(lower, upper, corner, cell, 0.5_dp*(1.0_dp + place), weight, ndim, lattice, status)
  end subroutine lattice_gauss

  !> So many points between each two centres of an axis with unequal cells, and of the part of such
  !! an interval that is in the box as many as its length has room for: the shares of the points of
  !! a block add up to its length. Along other axes the centres of a cubic lattice. `gauss`: Gauss
  !! points, between nodes, of all axes.
  pure subroutine lattice_graded(lower, upper, corner, axes, cell, per_cell, gauss, lattice, status)
    real(dp), intent(in) :: lower(3), upper(3)     !! of the box
    real(dp), intent(in) :: corner(3)              !! of a cube or cell, for other axes
    type(graded_axis_t), intent(in) :: axes(:)     !! (dimension)
    real(dp), intent(in) :: cell                   !! smallest side of a cell
    integer, intent(in) :: per_cell
    logical, intent(in) :: gauss
    type(lattice_t), intent(out) :: lattice
    integer, intent(out) :: status                 !! lattice_fits, or why not
    type(lattice_t) :: cubic
    real(dp), allocatable :: points(:), lengths(:)
    real(dp) :: box(2, 3), spacing
    integer :: axis, most
    box = 0.0_dp
    box(1, :size(axes)) = lower(:size(axes))
    box(2, :size(axes)) = upper(:size(axes))
    spacing = cell/per_cell
    lattice%ndim = size(axes)
    lattice%margin = lattice_tolerance*spacing
    status = lattice_fits
    allocate (lattice%coordinate(1, 3), source=0.0_dp)
    allocate (lattice%length(1, 3), source=1.0_dp)
    do axis = 1, size(axes)
      if (axes(axis)%graded) then
        call between(box(:, axis), axes(axis), cell, per_cell, gauss, points, lengths)
      else if (gauss) then
        call lattice_gauss(spread(box(1, axis), 1, 3), spread(box(2, axis), 1, 3), &
                           spread(corner(axis), 1, 3), cell, per_cell, 1, cubic, status)
        if (status /= lattice_fits) return
        points = cubic%coordinate(:cubic%count(1), 1)
        lengths = cubic%length(:cubic%count(1), 1)
      else
        call lattice_cubic(spread(box(1, axis), 1, 3), spread(box(2, axis), 1, 3), &
                           spread(corner(axis), 1, 3), spacing, 0.0_dp, 1, cubic, status)
        if (status /= lattice_fits) return
        points = cubic%coordinate(:cubic%count(1), 1)
        lengths = cubic%length(:cubic%count(1), 1)
      end if
      lattice%count(axis) = size(points)
      most = max(size(lattice%coordinate, 1), size(points))
      lattice%coordinate = taller(lattice%coordinate, most)
      lattice%length = taller(lattice%length, most)
      lattice%coordinate(:size(points), axis) = points
      lattice%length(:size(points), axis) = lengths
    end do
    if (product(real(lattice%count, dp)) > real(huge(1), dp)) status = lattice_too_many
  end subroutine lattice_graded

  !> Points between the centres of an axis, as Gauss points between its nodes, within the ends of a
  !! box, and their shares.
  pure subroutine between(ends, axis, cell, per_cell, gauss, points, lengths)
    real(dp), intent(in) :: ends(2), cell
    type(graded_axis_t), intent(in) :: axis
    integer, intent(in) :: per_cell
    logical, intent(in) :: gauss
    real(dp), allocatable, intent(out) :: points(:), lengths(:)
    real(dp) :: low, high, place(2), fraction(per_cell), weight(per_cell), start
    integer :: c, n, pass, total, first, last
    place = (ends - axis%origin)/cell
    start = merge(0.0_dp, 0.5_dp, gauss)
    first = floor(graded_coordinate(axis, place(1)) - start)
    last = floor(graded_coordinate(axis, place(2)) - start)
    do pass = 1, 2
      total = 0
      do c = first, last                           ! from this centre or node to the next
        low = max(place(1), end_of(axis, c, gauss))
        high = min(place(2), end_of(axis, c + 1, gauss))
        if (high - low <= lattice_tolerance) cycle
        n = ceiling(per_cell*(high - low)/(end_of(axis, c + 1, gauss) - end_of(axis, c, gauss)) &
                    - 1.0e-6_dp)
        if (pass == 2) then
          call in_interval(n, gauss, fraction, weight)
          points(total + 1:total + n) = axis%origin + cell*(low + fraction(:n)*((high - low)/n))
          lengths(total + 1:total + n) = cell*(high - low)/n*weight(:n)
        end if
        total = total + n
      end do
      if (pass == 1) allocate (points(total), lengths(total))
    end do
  end subroutine between

  !> A node of an axis, or a centre.
  pure function end_of(axis, i, node) result(place)
    type(graded_axis_t), intent(in) :: axis
    integer, intent(in) :: i
    logical, intent(in) :: node
    real(dp) :: place
    if (node) then
      place = graded_node(axis, i)
    else
      place = graded_centre(axis, i)
    end if
  end function end_of

  !> Points of an interval of length n, and their shares of it.
  pure subroutine in_interval(n, gauss, place, share)
    integer, intent(in) :: n
    logical, intent(in) :: gauss
    real(dp), intent(inout) :: place(:), share(:)  !! (n or more)
    integer :: i
    if (gauss) then
      call gauss_points(n, place(:n), share(:n))
      place(:n) = 0.5_dp*n*(1.0_dp + place(:n))
      share(:n) = 0.5_dp*n*share(:n)
    else
      place(:n) = [(i - 0.5_dp, i=1, n)]
      share(:n) = 1.0_dp
    end if
  end subroutine in_interval

  !> A table with more rows.
  pure function taller(table, rows) result(more)
    real(dp), intent(in) :: table(:, :)
    integer, intent(in) :: rows
    real(dp) :: more(rows, size(table, 2))
    more = 0.0_dp
    more(:size(table, 1), :) = table
  end function taller

  !> Points at some fractions of each period.
  pure subroutine lay_out(lower, upper, origin, pitch, fraction, weight, ndim, lattice, status)
    real(dp), intent(in) :: lower(3), upper(3), origin(3), pitch
    real(dp), intent(in) :: fraction(:)            !! places of points in a period, 0 to 1
    real(dp), intent(in) :: weight(:)              !! their shares, of 2
    integer, intent(in) :: ndim
    type(lattice_t), intent(out) :: lattice
    integer, intent(out) :: status
    real(dp) :: points(3)
    integer :: i, axis, k, per_pitch, offset(3)
    per_pitch = size(fraction)
    lattice%ndim = ndim
    lattice%margin = lattice_tolerance*pitch
    points = 1.0_dp
    points(:ndim) = ((upper(:ndim) - lower(:ndim))/pitch + 2.0_dp)*per_pitch
    status = lattice_too_many
    if (.not. product(points) <= real(huge(1), dp)) return
    status = lattice_too_far
    if (any(abs(lower(:ndim) - origin(:ndim)) > 0.25_dp*huge(1)*pitch/per_pitch)) return
    status = lattice_fits
    offset = 0
    offset(:ndim) = floor((lower(:ndim) - origin(:ndim))/pitch - lattice_tolerance)
    lattice%first = offset*per_pitch
    lattice%count(:ndim) = nint(points(:ndim))
    allocate (lattice%coordinate(maxval(lattice%count), 3), source=0.0_dp)
    allocate (lattice%length(maxval(lattice%count), 3), source=1.0_dp)
    do axis = 1, ndim
      do i = 1, lattice%count(axis)
        k = 1 + mod(i - 1, per_pitch)
        lattice%coordinate(i, axis) = origin(axis) + &
                                      (offset(axis) + (i - 1)/per_pitch + fraction(k))*pitch
        lattice%length(i, axis) = 0.5_dp*weight(k)*pitch
      end do
    end do
  end subroutine lay_out

  !> Layers of a lattice, along the slowest of its axes; one in 1D.
  pure function lattice_layers(lattice) result(layers)
    type(lattice_t), intent(in) :: lattice
    integer :: layers
    layers = 1
    if (lattice%ndim > 1) layers = lattice%count(lattice%ndim)
  end function lattice_layers

  !> Lines along x in a layer.
  pure function lattice_lines(lattice) result(lines)
    type(lattice_t), intent(in) :: lattice
    integer :: lines
    lines = merge(lattice%count(2), 1, lattice%ndim == 3)
  end function lattice_lines

  !> Numbers along the axes of a point in a line of a layer.
  pure function lattice_ijk(lattice, i, line, layer) result(ijk)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: i, line, layer
    integer :: ijk(3)
    ijk = [i, line, layer]
    if (lattice%ndim == 2) ijk = [i, layer, 1]
  end function lattice_ijk

  !> A point, before any jitter.
  pure function lattice_point(lattice, ijk) result(point)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)   !! number of the point along each axis, from 1
    real(dp) :: point(3)
    integer :: axis
    do axis = 1, 3
      point(axis) = lattice%coordinate(ijk(axis), axis)
    end do
  end function lattice_point

  !> Volume that a point stands for.
  pure function lattice_volume(lattice, ijk) result(volume)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    real(dp) :: volume
    volume = lattice%length(ijk(1), 1)*lattice%length(ijk(2), 2)*lattice%length(ijk(3), 3)
  end function lattice_volume

  !> Displaces a point by its jitter.
  pure subroutine lattice_jitter(lattice, ijk, point)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    real(dp), intent(inout) :: point(3)
    integer :: axis
    if (lattice%jitter <= 0.0_dp) return
    do axis = 1, lattice%ndim
      point(axis) = point(axis) + lattice%jitter*unit_hash(lattice%first + ijk, axis)
    end do
  end subroutine lattice_jitter

  !> A number in [-1, 1] that depends on lattice indices and axis only (a chain of Lehmer
  !! generators).
  pure function unit_hash(ijk, axis) result(number)
    integer, intent(in) :: ijk(3), axis
    integer(i8), parameter :: modulus = 2147483647_i8, multiplier = 48271_i8
    real(dp) :: number
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

  !> Gauss-Legendre points and weights on [-1, 1].
  pure subroutine gauss_points(n, points, weights)
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
  end subroutine gauss_points

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

end module sgmp_lattice
