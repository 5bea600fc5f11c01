!> The particles of an MPM3D deck: where they are, their mass, velocity and force, in its own three
!! axes and order.
module sgmp_mpm3d_particles
  use sgmp_kinds, only: dp, i8
  use sgmp_mpm3d_deck, only: mpm3d_deck_t, mpm3d_part_t, mpm3d_setting_t
  use sgmp_mpm3d_words, only: mpm3d_words_t
  use sgmp_sorting, only: sort_order, sort_order_within
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: cloud_t, clouds_make, lattice_tolerance, cloud_uniform, cloud_rows, beam_velocity, &
            pi_there

  real(dp), parameter :: pi_there = 3.1415926535_dp   !! as MPM3D has it
  real(dp), parameter :: lattice_tolerance = 1.0e-5_dp  !! of a particle's place, in spacings

  real(dp), parameter :: most_tried = 1.0e8_dp        !! points of a lattice around a body

  !> The particles of one body.
  type :: cloud_t
    integer :: first = 1                              !! number of the first in the deck
    real(dp), allocatable :: position(:, :)           !! (3, n)
    real(dp), allocatable :: mass(:), volume(:)       !! volume: mass over the material's density
    real(dp), allocatable :: velocity(:, :), force(:, :)  !! (3, n); force per mass
    real(dp) :: gravity(3) = 0.0_dp
    logical :: cubic = .false.                        !! fills a block of a cubic lattice
    real(dp) :: spacing = 0.0_dp, corner(3) = 0.0_dp  !! of the lattice
    integer :: rows(3) = 1                            !! of the block
  end type cloud_t

contains

  !> Makes the particles of all bodies; what does not fit ends with an error in `words`.
  subroutine clouds_make(deck, words, clouds)
    type(mpm3d_deck_t), intent(in) :: deck
    type(mpm3d_words_t), intent(inout) :: words
    type(cloud_t), allocatable, intent(out) :: clouds(:)
    integer :: b, n, most
    allocate (clouds(size(deck%parts)))
    n = 0
    do b = 1, size(clouds)
      associate (part => deck%parts(b), cloud => clouds(b))
        words%position = part%place
        most = deck%particles - n
        cloud%first = n + 1
        call fill(part, most, cloud)
        if (.not. allocated(cloud%mass)) then
          call words%fail('there are more particles than nbmp says ('// &
                          integer_text(deck%particles)//')', 'make nbmp their number')
        else if (size(cloud%mass) == 0) then
          call words%fail('the body has no particles', 'check its numbers')
        end if
        if (words%failed) return
        n = n + size(cloud%mass)
        cloud%volume = cloud%mass/deck%materials(part%material)%constant(1)
        allocate (cloud%velocity(3, size(cloud%mass)), cloud%force(3, size(cloud%mass)), &
                  source=0.0_dp)
        call find_block(part, cloud)
      end associate
    end do
    call set_velocities(deck, clouds)
    call set_forces(deck, clouds)
  end subroutine clouds_make

  !> Positions and masses of a body; none allocated where there would be more than `most`.
  subroutine fill(part, most, cloud)
    type(mpm3d_part_t), intent(in) :: part
    integer, intent(in) :: most
    type(cloud_t), intent(inout) :: cloud
    real(dp), allocatable :: found(:, :)
    integer :: i, j, k, n, low(3), high(3)
    real(dp) :: x(3)
    if (part%form == 'poin') then
      if (size(part%points, 2) > most) return
      cloud%mass = part%points(1, :)
      cloud%position = part%points(2:, :)
      return
    end if
    low = 1
    high = part%rows
    if (part%form == 'sphe' .or. part%form == 'cicl') then
      low = 1 - part%rows(1)
      high = part%rows(1)
      if (part%form == 'cicl') low(3) = 1
      if (part%form == 'cicl') high(3) = 1
    end if
    ! At least half of the cube around a sphere is inside; of a block with a hole it may be little.
    if (part%form /= 'blod' .and. product(real(high - low + 1, dp)) > 2.0_dp*most + 8.0_dp) return
    if (product(real(high - low + 1, dp)) > most_tried) return
    allocate (found(3, min(most, product(high - low + 1))))
    n = 0
    do k = low(3), high(3)
      do j = low(2), high(2)
        do i = low(1), high(1)
          x = part%origin + (real([i, j, k], dp) - 0.5_dp)*part%spacing
          if (.not. belongs(part, x)) cycle
          n = n + 1
          if (n > most) return
          found(:, n) = x
        end do
      end do
    end do
    cloud%position = found(:, :n)
    allocate (cloud%mass(n), source=part%density*part%spacing**3)
  end subroutine fill

  !> Whether a point of the lattice is one of the body.
  pure function belongs(part, x) result(yes)
    type(mpm3d_part_t), intent(in) :: part
    real(dp), intent(in) :: x(3)
    logical :: yes
    select case (part%form)
    case ('sphe')
      yes = sum((x - part%origin)**2) < (part%rows(1)*part%spacing)**2
    case ('cicl')
      yes = sum((x(:2) - part%origin(:2))**2) < (part%rows(1)*part%spacing)**2
    case ('blod')
      yes = sum((x(:2) - part%hole(:2))**2) >= (part%hole_radius*part%spacing)**2
    case default
      yes = .true.
    end select
  end function belongs

  !> Sees whether a body fills a block of a cubic lattice whose cubes have the particles' volume.
  pure subroutine find_block(part, cloud)
    type(mpm3d_part_t), intent(in) :: part
    type(cloud_t), intent(inout) :: cloud
    logical, allocatable :: taken(:)
    real(dp) :: rows(3), index(3)
    integer :: p, at
    if (part%form /= 'poin') then
      cloud%spacing = part%spacing
      cloud%corner = part%origin
      cloud%cubic = part%form == 'bloc'
      if (cloud%cubic .or. part%form == 'blod') cloud%rows = part%rows
      return
    end if
    cloud%spacing = (sum(cloud%volume)/size(cloud%volume))**(1.0_dp/3.0_dp)
    if (any(abs(cloud%mass - cloud%mass(1)) > 1.0e-9_dp*cloud%mass(1))) return
    cloud%corner = minval(cloud%position, dim=2) - 0.5_dp*cloud%spacing
    rows = anint((maxval(cloud%position, dim=2) - cloud%corner)/cloud%spacing + 0.5_dp)
    if (abs(product(rows) - size(cloud%mass)) > 0.5_dp) return
    allocate (taken(size(cloud%mass)), source=.false.)
    do p = 1, size(cloud%mass)
      index = (cloud%position(:, p) - cloud%corner)/cloud%spacing - 0.5_dp
      if (any(abs(index - anint(index)) > lattice_tolerance)) return
      at = 1 + nint(index(1)) + nint(rows(1))*(nint(index(2)) + nint(rows(2))*nint(index(3)))
      if (taken(at)) return
      taken(at) = .true.
    end do
    cloud%cubic = .true.
    cloud%rows = nint(rows)
  end subroutine find_block

  !> The block velo, line by line: a later line replaces an earlier one.
  subroutine set_velocities(deck, clouds)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(inout) :: clouds(:)
    integer :: i, b, p, range(2)
    do i = 1, size(deck%velocities)
      associate (setting => deck%velocities(i))
        if (setting%kind == 'ksin' .and. setting%number /= 1) cycle
        do b = 1, size(clouds)
          range = concerned(setting, b, clouds(b))
          do p = range(1), range(2)
            call set_velocity(setting, clouds(b)%first + p - 1, clouds(b)%position(:, p), &
                              clouds(b)%velocity(:, p))
          end do
        end do
      end associate
    end do
  end subroutine set_velocities

  !> The first and the last particle of a body that a line is about.
  pure function concerned(setting, body, cloud) result(range)
    type(mpm3d_setting_t), intent(in) :: setting
    integer, intent(in) :: body
    type(cloud_t), intent(in) :: cloud
    integer :: range(2)
    range = [1, size(cloud%mass)]
    if (setting%kind == 'body' .and. setting%number /= body) range(2) = 0
    if (setting%kind == 'node' .or. setting%kind == 'part') then
      range(1) = max(range(1), setting%number - cloud%first + 1)
      range(2) = min(range(2), setting%number - cloud%first + 1)
    end if
  end function concerned

  !> Velocity of a particle as one line of velo has it; the rows of the fields built into MPM3D are
  !! counted, not located.
  pure subroutine set_velocity(setting, number, position, velocity)
    type(mpm3d_setting_t), intent(in) :: setting
    integer, intent(in) :: number         !! of the particle
    real(dp), intent(in) :: position(3)
    real(dp), intent(inout) :: velocity(3)
    integer, parameter :: bar_row = 320, bar = 4*bar_row, beam_row = 384, beam = 128*beam_row
    real(dp), parameter :: bar_spacing = 0.003125_dp, beam_spacing = 0.00015625_dp
    select case (setting%kind)
    case ('body', 'node')
      velocity = setting%value
    case ('ksin')
      if (number <= bar) velocity = [setting%value(1)*sin(pi_there*bar_spacing* &
                                     (mod(number - 1, bar_row) + 0.5_dp)), 0.0_dp, 0.0_dp]
    case ('nuli')
      if (number <= beam) velocity = [0.0_dp, setting%value(1)*beam_velocity( &
                                      beam_spacing*(mod(number - 1, beam_row) + 0.5_dp)), 0.0_dp]
    case default  ! vsin
      velocity = [setting%value(1)*sin(pi_there*position(2)/6.0_dp), 0.0_dp, 0.0_dp]
    end select
  end subroutine set_velocity

  !> Velocity of MPM3D's built-in beam of beryllium (m, kg, s) for unit deflection: the first mode
  !! of a free-free beam of length 0.06 and height 0.01.
  pure elemental function beam_velocity(x) result(velocity)
    real(dp), intent(in) :: x  !! from the left end
    real(dp) :: velocity
    real(dp), parameter :: q = 78.83_dp, length = 0.06_dp
    real(dp) :: c1, c2, w
    c1 = cosh(q*length) - cos(q*length)
    c2 = sinh(q*length) - sin(q*length)
    w = q**2*sqrt(318.0e9_dp*0.01_dp**2/(12.0_dp*1845.0_dp*(1.0_dp - 0.054_dp**2)))
    velocity = w/(2.0_dp*c2)*(c1*(sinh(q*x) + sin(q*x)) - c2*(cosh(q*x) + cos(q*x)))
  end function beam_velocity

  !> The block load: forces of particles as forces per mass, and gravity of bodies.
  subroutine set_forces(deck, clouds)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(inout) :: clouds(:)
    integer :: i, b, p, range(2)
    do i = 1, size(deck%loads)
      associate (setting => deck%loads(i))
        if (setting%kind == 'grav') then
          clouds(setting%number)%gravity = setting%value
          cycle
        end if
        do b = 1, size(clouds)
          range = concerned(setting, b, clouds(b))
          do p = range(1), range(2)
            clouds(b)%force(:, p) = setting%value/clouds(b)%mass(p)
          end do
        end do
      end associate
    end do
  end subroutine set_forces

  !> Whether all columns are the same.
  pure function cloud_uniform(vectors) result(uniform)
    real(dp), intent(in) :: vectors(:, :)  !! (3, n)
    logical :: uniform
    uniform = all(maxval(vectors, dim=2) - minval(vectors, dim=2) <= &
                  1.0e-12_dp*maxval(abs(vectors)))
  end function cloud_uniform

  !> Number of rows of a body along an axis, if they are all alike: the same places across it,
  !! masses, velocities and forces; 0 where they are not.
  pure function cloud_rows(cloud, axis) result(rows)
    type(cloud_t), intent(in) :: cloud
    integer, intent(in) :: axis
    integer :: rows
    integer :: across(2), p, length
    integer, allocatable :: order(:)
    integer(i8), allocatable :: layer(:), first(:), second(:)
    across = pack([1, 2, 3], [1, 2, 3] /= axis)
    call find_levels(cloud, axis, layer)
    rows = int(maxval(layer))
    length = size(cloud%mass)/rows
    if (rows == 1) return
    if (rows*length == size(cloud%mass)) then
      call find_levels(cloud, across(1), first)
      call find_levels(cloud, across(2), second)
      allocate (order(size(layer)))
      call sort_order_within(layer, first*(size(layer) + 1_i8) + second, order)
      do p = 1, size(order)
        if (.not. alike(cloud, across, order(p), order(mod(p - 1, length) + 1))) exit
      end do
      if (p > size(order)) return
    end if
    rows = 0
  end function cloud_rows

  !> Whether two particles differ in nothing but their place along the third axis.
  pure function alike(cloud, across, p, q) result(yes)
    type(cloud_t), intent(in) :: cloud
    integer, intent(in) :: across(2), p, q
    logical :: yes
    real(dp), parameter :: round_off = 1.0e-9_dp
    yes = all(abs(cloud%position(across, p) - cloud%position(across, q)) <= &
              lattice_tolerance*cloud%spacing) .and. &
          abs(cloud%mass(p) - cloud%mass(q)) <= round_off*cloud%mass(q) .and. &
          all(abs(cloud%velocity(:, p) - cloud%velocity(:, q)) <= &
              round_off*maxval(abs(cloud%velocity(:, q)))) .and. &
          all(abs(cloud%force(:, p) - cloud%force(:, q)) <= &
              round_off*maxval(abs(cloud%force(:, q))))
  end function alike

  !> Numbers the different coordinates along an axis from the lowest; those closer than the
  !! tolerance are one.
  pure subroutine find_levels(cloud, axis, level)
    type(cloud_t), intent(in) :: cloud
    integer, intent(in) :: axis
    integer(i8), allocatable, intent(out) :: level(:)
    real(dp), parameter :: steps = 1.0e8_dp        !! per spacing, for the order alone
    real(dp), parameter :: most_steps = 1.0e18_dp  !! that an integer holds
    integer, allocatable :: order(:)
    real(dp) :: least, unit
    integer :: p
    least = minval(cloud%position(axis, :))
    unit = max(cloud%spacing/steps, (maxval(cloud%position(axis, :)) - least)/most_steps)
    allocate (level(size(cloud%mass)), order(size(cloud%mass)))
    call sort_order(nint((cloud%position(axis, :) - least)/unit, i8), order)
    level(order(1)) = 1
    do p = 2, size(order)
      level(order(p)) = level(order(p - 1))
      if (cloud%position(axis, order(p)) - cloud%position(axis, order(p - 1)) > &
          lattice_tolerance*cloud%spacing) level(order(p)) = level(order(p)) + 1
    end do
  end subroutine find_levels

end module sgmp_mpm3d_particles
