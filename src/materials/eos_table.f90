!> An equation of state from a table of the pressure over density and energy per mass (theory 4).
!!
!! Between its points the pressure is bicubic in density and energy (Hermite's polynomials), with
!! slopes as Steffen (1990, Astron. Astrophys. 239, 443) limits them: those of a parabola through
!! three points, and not more than twice that of either interval next to the point, none where the
!! points turn. Along the lines of the table the pressure is then monotone where its points are; it
!! and its slopes have no jumps, a plane is a plane. With rho, e and p(rho, e),
!!
!!     c^2 = dp/drho + p/rho^2 dp/de                                                    (TB1)
!!
!! which must be above 0 everywhere in the table. Where a fourth column has the temperature, matter
!! must have an entropy, T ds = de + p dv: between two corners of the table it must be the same by
!! way of both other corners,
!!
!!     integral of de/T at the least density, and then of p/T dv at e; or the other way round. (TB2)
!!
!! Beyond the edges the table goes on along its tangent for half of its last interval. Farther out
!! there are no waves: who asks is told by a square of the speed of sound below 0.
module sgmp_eos_table
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_rows, kind_text, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_text, only: percent_text, real_text
  implicit none
  private
  public :: table_check, table_gaseous, table_holds, table_init, table_keys, table_lanes, &
            table_read, table_t, table_terms

  integer, parameter :: probes = 4                !! along each side of a field, for (TB1)
  real(dp), parameter :: overhang = 0.5_dp        !! of the last interval
  real(dp), parameter :: entropy_error = 0.02_dp  !! of the range of the entropy, in (TB2)
  character(*), parameter :: file = 'file'
  character(*), parameter :: grid_expected = &
    'rows: density, energy per mass, pressure, and if known temperature; all energies of the '// &
    'first density, then all of the next, or the other way round; both grow'

  !> Points of the table; no points: no table.
  type :: table_t
    real(dp) :: density0 = 1.0_dp                !! of the start (mass/volume)
    real(dp), allocatable :: density(:)          !! (m) grows
    real(dp), allocatable :: energy(:)           !! (n) per mass, grows
    real(dp), allocatable :: p(:, :, :)          !! (4, m, n) p, dp/drho, dp/de, d2p/drho de
    real(dp) :: stiffest = 0.0_dp                !! largest bulk modulus at a point
  end type table_t

contains

  !> Keys of the equation.
  function table_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key(file, kind_rows, 'rows of density, energy per mass, pressure and, for a check, '// &
                'temperature, on a grid of densities and energies; # and ! begin comments; a '// &
                'relative path starts at the deck', unit='density,speed^2,stress', &
                required=.true.), &
            key('checksum', kind_text, 'of the rows of the file, as the complete deck in '// &
                'run.log says it: rows with another one are refused')]
  end function table_keys

  !> Equation from the values of its keys: the first pressure must be in the table, waves must have
  !! a speed everywhere, and with a temperature there must be an entropy.
  pure subroutine table_read(density, values, table, fault)
    real(dp), intent(in) :: density     !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(table_t), intent(out) :: table
    type(fault_t), allocatable, intent(inout) :: fault
    real(dp), allocatable :: rows(:, :), p(:, :), densities(:), energies(:)
    integer, allocatable :: row(:, :)
    if (allocated(fault)) return
    rows = values%rows(file)
    if (size(rows) == 0) return
    call find_grid(rows, densities, energies, row, fault)
    if (allocated(fault)) return
    p = reshape(rows(3, pack(row, .true.)), shape(row))
    call table_init(density, densities, energies, p, table)
    call table_check(table, row, fault)
    if (size(rows, 1) > 3 .and. .not. allocated(fault)) then
      call check_entropy(table, reshape(rows(4, pack(row, .true.)), shape(row)), row, fault)
    end if
    if (allocated(fault)) return
    if (density < table%density(1) .or. density > table%density(size(table%density))) then
      call fault_make(fault, file, 'the density of the material, '//real_text(density)// &
                      ', is not in the table', 'its densities are '// &
                      real_text(table%density(1))//' to '// &
                      real_text(table%density(size(table%density))))
    end if
  end subroutine table_read

  !> Densities, energies and the row of each point, from rows in either order.
  pure subroutine find_grid(rows, density, energy, row, fault)
    real(dp), intent(in) :: rows(:, :)
    real(dp), allocatable, intent(out) :: density(:), energy(:)
    integer, allocatable, intent(out) :: row(:, :)  !! (density, energy)
    type(fault_t), allocatable, intent(inout) :: fault
    integer :: total, inner, outer, slow, i, j
    total = size(rows, 2)
    if (size(rows, 1) < 3 .or. size(rows, 1) > 4 .or. total < 4) then
      call fault_make(fault, file, 'a table has three or four numbers in a row, and four rows '// &
                      'at least', grid_expected, [1, 1])
      return
    end if
    slow = merge(1, 2, abs(rows(1, 2) - rows(1, 1)) <= 0.0_dp)
    inner = 1
    do while (inner < total)
      if (abs(rows(slow, inner + 1) - rows(slow, 1)) > 0.0_dp) exit
      inner = inner + 1
    end do
    outer = total/inner
    do i = 1, total
      j = i - 1 - inner*((i - 1)/inner)   ! place among those of the same slow value
      call check_row(rows, slow, i, j, fault)
      if (allocated(fault)) return
    end do
    if (inner*outer /= total .or. inner < 2 .or. outer < 2) then
      call fault_make(fault, file, 'the last lines of the grid are missing', grid_expected, &
                      [1, total])
      return
    end if
    row = reshape([(i, i=1, total)], [inner, outer])
    if (slow == 1) row = transpose(row)
    density = rows(1, row(:, 1))
    energy = rows(2, row(1, :))
  end subroutine find_grid

  !> Whether row i, with j rows of the same slow value before it, goes on with the grid.
  pure subroutine check_row(rows, slow, i, j, fault)
    real(dp), intent(in) :: rows(:, :)
    integer, intent(in) :: slow                  !! column that grows slowly
    integer, intent(in) :: i, j
    type(fault_t), allocatable, intent(inout) :: fault
    integer :: grows
    associate (fast => 3 - slow)
      grows = merge(fast, slow, j > 0)
      if (abs(rows(slow, i) - rows(slow, i - j)) > 0.0_dp) then
        call fault_make(fault, file, 'the grid of the table has a gap', grid_expected, [slow, i])
      else if (abs(rows(fast, i) - rows(fast, j + 1)) > 0.0_dp) then
        call fault_make(fault, file, real_text(rows(fast, i))//' is not '// &
                        real_text(rows(fast, j + 1))//' as in the first rows', grid_expected, &
                        [fast, i])
      else if (rows(1, i) <= 0.0_dp) then
        call fault_make(fault, file, 'a density is not above 0', grid_expected, [1, i])
      else if (i > 1) then
        if (rows(grows, i) > rows(grows, i - 1)) return
        call fault_make(fault, file, real_text(rows(grows, i))//' does not follow '// &
                        real_text(rows(grows, i - 1)), grid_expected, [grows, i])
      end if
    end associate
  end subroutine check_row

  !> Slopes at all points.
  pure subroutine table_init(density0, density, energy, pressure, table)
    real(dp), intent(in) :: density0                   !! of the start (mass/volume)
    real(dp), intent(in) :: density(:), energy(:)      !! (m), (n) per mass; both grow
    real(dp), intent(in) :: pressure(:, :)             !! (m, n)
    type(table_t), intent(out) :: table
    integer :: i, j
    table%density0 = density0
    table%density = density
    table%energy = energy
    allocate (table%p(4, size(density), size(energy)))
    associate (p => table%p)
      p(1, :, :) = pressure
      do j = 1, size(energy)
        p(2, :, j) = slopes(density, pressure(:, j))
      end do
      do i = 1, size(density)
        p(3, i, :) = slopes(energy, pressure(i, :))
        p(4, i, :) = slopes(energy, p(2, i, :))
      end do
      do i = 1, size(density)
        table%stiffest = max(table%stiffest, maxval(abs(density(i)*p(2, i, :))))
      end do
    end associate
  end subroutine table_init

  !> Limited slopes of points (Steffen 1990, equations 8 to 11, and 24 to 28 at the ends).
  pure function slopes(x, y) result(slope)
    real(dp), intent(in) :: x(:), y(:)
    real(dp) :: slope(size(x))
    real(dp) :: h(size(x) - 1), s(size(x) - 1)
    integer :: i, n
    n = size(x)
    h = x(2:) - x(:n - 1)
    s = (y(2:) - y(:n - 1))/h
    slope = s(1)
    if (n == 2) return
    slope(1) = end_slope(s(1), s(2), h(1)/(h(1) + h(2)))
    slope(n) = end_slope(s(n - 1), s(n - 2), h(n - 1)/(h(n - 1) + h(n - 2)))
    do i = 2, n - 1
      slope(i) = (s(i - 1)*h(i) + s(i)*h(i - 1))/(h(i - 1) + h(i))
      slope(i) = (sign(1.0_dp, s(i - 1)) + sign(1.0_dp, s(i))) &
                 *min(abs(s(i - 1)), abs(s(i)), 0.5_dp*abs(slope(i)))
    end do
  end function slopes

  !> Slope of the parabola at an end, within none and twice that of the interval.
  pure function end_slope(near, far, part) result(slope)
    real(dp), intent(in) :: near, far     !! slopes of the last interval and the one before it
    real(dp), intent(in) :: part          !! of the last interval in both
    real(dp) :: slope
    slope = near*(1.0_dp + part) - far*part
    if (slope*near <= 0.0_dp) slope = 0.0_dp
    if (abs(slope) > 2.0_dp*abs(near)) slope = 2.0_dp*near
  end function end_slope

  !> Whether waves have a speed everywhere in the table, by (TB1).
  pure subroutine table_check(table, row, fault)
    type(table_t), intent(in) :: table
    integer, intent(in) :: row(:, :)      !! of each point, for messages
    type(fault_t), allocatable, intent(inout) :: fault
    real(dp) :: part(2), rho, e, q(3)
    integer :: i, j, k
    do j = 1, size(table%energy) - 1
      do i = 1, size(table%density) - 1
        do k = 0, (probes + 1)**2 - 1
          part = [mod(k, probes + 1), k/(probes + 1)]/real(probes, dp)
          rho = table%density(i) + part(1)*(table%density(i + 1) - table%density(i))
          e = table%energy(j) + part(2)*(table%energy(j + 1) - table%energy(j))
          q = patch(table, i, j, rho, e)
          if (q(2) + q(1)*q(3)/rho**2 > 0.0_dp) cycle
          call fault_make(fault, file, 'waves have no speed at a density of '//real_text(rho)// &
                          ' and an energy of '//real_text(e)//': dp/drho + p/rho^2 dp/de is '// &
                          'not above 0', 'leave out densities and energies where matter falls '// &
                          'apart, or take closer points', [3, row(i, j)])
          return
        end do
      end do
    end do
  end subroutine table_check

  !> Whether there is an entropy, by (TB2), to a part of its range.
  pure subroutine check_entropy(table, temperature, row, fault)
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: temperature(:, :)
    integer, intent(in) :: row(:, :)
    type(fault_t), allocatable, intent(inout) :: fault
    real(dp), dimension(size(temperature, 1), size(temperature, 2)) :: first, second, entropy, error
    real(dp) :: range
    integer :: i, j, m, n, worst(2)
    m = size(temperature, 1)
    n = size(temperature, 2)
    if (any(.not. temperature > 0.0_dp)) then
      worst = findloc(temperature > 0.0_dp, .false.)
      call fault_make(fault, file, 'a temperature is not above 0', &
                      'temperatures are absolute', [4, row(worst(1), worst(2))])
      return
    end if
    do i = 1, m
      second(i, :) = integral(table%energy, 1.0_dp/temperature(i, :))
    end do
    do j = 1, n
      first(:, j) = -integral(-1.0_dp/table%density, table%p(1, :, j)/temperature(:, j))
    end do
    entropy = spread(second(1, :), 1, m) + first
    error = abs(entropy - (spread(first(:, 1), 2, n) + second))
    range = maxval(entropy) - minval(entropy)
    if (maxval(error) <= entropy_error*range) return
    worst = maxloc(error)
    call fault_make(fault, file, 'pressure and temperature have no entropy: two ways through '// &
                    'the table to a density of '//real_text(table%density(worst(1)))// &
                    ' and an energy of '//real_text(table%energy(worst(2)))//' differ by '// &
                    percent_text(maxval(error)/range)//' of its range', &
                    'check the columns and their units; take closer points; or leave the '// &
                    'temperature out', [4, row(worst(1), worst(2))])
  end subroutine check_entropy

  !> Integral of a curve through points from the first of them to each, with its limited slopes.
  pure function integral(x, y) result(sums)
    real(dp), intent(in) :: x(:), y(:)
    real(dp) :: sums(size(x))
    real(dp) :: slope(size(x)), h
    integer :: i
    slope = slopes(x, y)
    sums(1) = 0.0_dp
    do i = 2, size(x)
      h = x(i) - x(i - 1)
      sums(i) = sums(i - 1) + 0.5_dp*h*(y(i) + y(i - 1)) + h**2/12.0_dp*(slope(i - 1) - slope(i))
    end do
  end function integral

  !> Whether no point of the table is under tension.
  elemental logical function table_gaseous(table) result(yes)
    type(table_t), intent(in) :: table
    yes = allocated(table%p)
    if (yes) yes = all(table%p(1, :, :) >= 0.0_dp)
  end function table_gaseous

  !> Whether a state is in the table or no more than its overhang outside of it.
  pure logical function table_holds(table, rho, e) result(yes)
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: rho, e        !! density; energy per mass
    yes = holds(table%density, rho) .and. holds(table%energy, e)
  end function table_holds

  pure logical function holds(x, value) result(yes)
    real(dp), intent(in) :: x(:), value
    integer :: n
    n = size(x)
    yes = value >= x(1) - overhang*(x(2) - x(1)) .and. &
          value <= x(n) + overhang*(x(n) - x(n - 1))
  end function holds

  !> Terms of the tangent p = a0 + b0 E at an energy, with da + db E = dp/dv there; v <= 0 (an empty
  !! lane) is taken as 1.
  pure subroutine table_terms(table, v, energy, a0, b0, da, db)
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: v            !! volume over initial volume
    real(dp), intent(in) :: energy       !! E (energy/initial volume)
    real(dp), intent(out) :: a0          !! pressure less b0 E (stress)
    real(dp), intent(out) :: b0          !! dp/dE
    real(dp), intent(out) :: da          !! dp/dv at that E (stress)
    real(dp), intent(out) :: db          !! 0
    real(dp) :: volume, rho, e, q(3), inside(2)
    integer :: i, j
    volume = merge(v, 1.0_dp, v > 0.0_dp)
    rho = table%density0/volume
    e = energy/table%density0
    i = interval(table%density, rho)
    j = interval(table%energy, e)
    inside = [clip(table%density, rho), clip(table%energy, e)]
    q = patch(table, i, j, inside(1), inside(2))
    q(1) = q(1) + q(2)*(rho - inside(1)) + q(3)*(e - inside(2))
    b0 = q(3)/table%density0
    a0 = q(1) - b0*energy
    da = -q(2)*rho/volume
    db = 0.0_dp
    ! No waves: c^2 is proportional to p b0 - da.
    if (.not. table_holds(table, rho, e)) da = max(q(1)*b0, 0.0_dp) + table%stiffest
  end subroutine table_terms

  !> Lane kernel of table_terms.
  pure subroutine table_lanes(table, v, energy, a0, b0, da, db)
    type(table_t), intent(in) :: table
    real(dp), intent(in) :: v(lanes), energy(lanes)                      !! as in the point function
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)  !! as in the point function
    integer :: p
    do p = 1, lanes
      call table_terms(table, v(p), energy(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine table_lanes

  !> Nearest value between the ends of a list.
  pure real(dp) function clip(x, value) result(inside)
    real(dp), intent(in) :: x(:), value
    inside = min(max(value, x(1)), x(size(x)))
  end function clip

  !> Interval of a growing list that a value is in, or is next to.
  pure integer function interval(x, value) result(low)
    real(dp), intent(in) :: x(:), value
    integer :: high, middle
    low = 1
    high = size(x)
    do while (high - low > 1)
      middle = (low + high)/2
      if (value < x(middle)) then
        high = middle
      else
        low = middle
      end if
    end do
  end function interval

  !> p, dp/drho, dp/de in a field of the table.
  pure function patch(table, i, j, rho, e) result(q)
    type(table_t), intent(in) :: table
    integer, intent(in) :: i, j           !! its lower corner
    real(dp), intent(in) :: rho, e
    real(dp) :: q(3)
    real(dp) :: a(4), b(4), da(4), db(4), c(4, 4)
    call hermite(table%density(i), table%density(i + 1), rho, a, da)
    call hermite(table%energy(j), table%energy(j + 1), e, b, db)
    ! Rows: values at both ends, slopes at both ends, along the density; columns along the energy.
    c(:2, :2) = table%p(1, i:i + 1, j:j + 1)
    c(3:, :2) = table%p(2, i:i + 1, j:j + 1)
    c(:2, 3:) = table%p(3, i:i + 1, j:j + 1)
    c(3:, 3:) = table%p(4, i:i + 1, j:j + 1)
    q = [dot_product(a, matmul(c, b)), dot_product(da, matmul(c, b)), dot_product(a, matmul(c, db))]
  end function patch

  !> Hermite's cubic polynomials of the values and the slopes at two ends, and their slopes.
  pure subroutine hermite(first, last, x, f, df)
    real(dp), intent(in) :: first, last, x
    real(dp), intent(out) :: f(4), df(4)
    real(dp) :: h, t
    h = last - first
    t = (x - first)/h
    f(2) = t**2*(3.0_dp - 2.0_dp*t)
    f(1) = 1.0_dp - f(2)
    f(3) = h*t*(1.0_dp - t)**2
    f(4) = -h*t**2*(1.0_dp - t)
    df(2) = 6.0_dp*t*(1.0_dp - t)/h
    df(1) = -df(2)
    df(3) = (1.0_dp - t)*(1.0_dp - 3.0_dp*t)
    df(4) = t*(3.0_dp*t - 2.0_dp)
  end subroutine hermite

end module sgmp_eos_table
