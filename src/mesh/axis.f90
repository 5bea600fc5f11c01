!> What an axis of symmetry makes of the grid: hoop strain, radial inertia and volumes next to it
!! (theory 7). Radii are in cells, where these are unequal in the smallest: node i lies at r = i,
!! centre c at r = c + 1/2, or where the table of the axis has them (sgmp_graded_axis).
!!
!! Of a full ring with the section of a cell the volume that particles give to a centre is, over the
!! length h_c of the cell,
!!     g_c = (F_(c+1) x_(c+1) - F_c x_c)/(2 h_c),  F_i = x_i + C H_i^2/x_i,  F_0 x_0 = 0
!! (x: radii of nodes, H: spacings of centres). With it and the hoop strain
!!     ((F_(c+1) - g_c) v_(c+1) + (g_c - F_c) v_c)/(h_c g_c)
!! a uniform stress is at rest and an expansion v = a r exact, whatever the sides (doc/grids.md).
module sgmp_axis
  use sgmp_graded_axis, only: graded_axis_t, graded_node, graded_spacing, graded_width
  use sgmp_kinds, only: dp, pi
  implicit none
  private
  public :: axis_correction, axis_correction_lattice, axis_cell, axis_hoop_weights, axis_inertia, &
            axis_radius, axis_radius_balanced, axis_radius_filled

  !> Default of the correction C of the hoop strain: what the hat functions' excess over the weight
  !! |r| is on average over the places of particles.
  real(dp), parameter :: axis_correction = 1.0_dp/12.0_dp
  !> Least radial mass of a node over its mass: without it the nodes beyond the surface of a rod
  !! thinner than about two cells would be lighter by far than what pulls at them.
  real(dp), parameter :: least_inertia = 0.75_dp

contains

  !> Weights of the radial velocity, summed over the two nodes at the inner and the outer radius of
  !! a centre, in its hoop strain rate (times h),
  !!     mean(v_r)/r + C ((v_r/r)_outer - (v_r/r)_inner)/r;
  !! the centres on both sides of the axis have no C, so that nothing is divided by its radius.
  !! Of unequal cells they are those for means of the nodes along the axis, halved.
  pure subroutine axis_hoop_weights(axis, correction, first, n, inner, outer)
    type(graded_axis_t), intent(in) :: axis      !! of the radius
    real(dp), intent(in) :: correction           !! C
    integer, intent(in) :: first, n              !! first centre, how many
    real(dp), intent(out) :: inner(n), outer(n)
    real(dp) :: inverse, part, lower, upper
    integer :: i, c
    if (axis%graded) then
      call graded_hoop_weights(axis, correction, first, n, inner, outer)
      return
    end if
    !$omp simd private(c, inverse, part, lower, upper)
    do i = 1, n
      c = first + i - 1
      inverse = 1.0_dp/(c + 0.5_dp)
      part = merge(0.0_dp, 0.5_dp*correction, c == 0 .or. c == -1)
      lower = merge(1.0_dp, real(c, dp), c == 0)
      upper = merge(1.0_dp, real(c + 1, dp), c == -1)
      inner(i) = inverse*(0.25_dp - part/lower)
      outer(i) = inverse*(0.25_dp + part/upper)
    end do
  end subroutine axis_hoop_weights

  !> The same of unequal cells; inside of the axis they are those of the image.
  pure subroutine graded_hoop_weights(axis, correction, first, n, inner, outer)
    type(graded_axis_t), intent(in) :: axis
    real(dp), intent(in) :: correction
    integer, intent(in) :: first, n
    real(dp), intent(out) :: inner(n), outer(n)
    real(dp) :: radius, width, weight(2)
    integer :: i, c
    do i = 1, n
      c = first + i - 1
      if (c < 0) c = -1 - c
      radius = axis_radius_balanced(axis, correction, c)
      width = graded_width(axis, c)
      weight = 0.0_dp
      if (c > 0) weight(1) = radius - balance(axis, correction, c)
      weight(2) = balance(axis, correction, c + 1) - radius
      weight = 0.5_dp*weight/(width*radius)
      if (first + i - 1 < 0) weight = -weight([2, 1])
      inner(i) = weight(1)
      outer(i) = weight(2)
    end do
  end subroutine graded_hoop_weights

  !> F of a node that is not on the axis.
  elemental function balance(axis, correction, node) result(f)
    type(graded_axis_t), intent(in) :: axis
    real(dp), intent(in) :: correction
    integer, intent(in) :: node
    real(dp) :: f
    f = graded_node(axis, node)
    f = f + correction*graded_spacing(axis, node)**2/f
  end function balance

  !> Radial mass of nodes over their mass: with moment/(r mass) in the place of 1 an expansion
  !! v_r = a r is projected exactly.
  pure subroutine axis_inertia(axis, first, n, mass, moment, inertia)
    type(graded_axis_t), intent(in) :: axis      !! of the radius
    integer, intent(in) :: first, n              !! first node, how many
    real(dp), intent(in) :: mass(n), moment(n)   !! moment: sum of mass times radius
    real(dp), intent(out) :: inertia(n)
    real(dp) :: radius(n), weight
    logical :: counts
    integer :: i
    do i = 1, n
      radius(i) = first + i - 1
    end do
    if (axis%graded) radius = graded_node(axis, [(first + i - 1, i=1, n)])
    !$omp simd private(weight, counts)
    do i = 1, n
      counts = radius(i) > 0.0_dp .and. mass(i) > 0.0_dp
      weight = merge(mass(i)*radius(i), 1.0_dp, counts)
      weight = merge(moment(i), 1.0_dp, counts)/weight
      inertia(i) = merge(weight, least_inertia, weight > least_inertia)
    end do
  end subroutine axis_inertia

  !> The correction C with which a lattice of some particles per cell and axis is at rest under a
  !! pressure: what hat functions make of them next to the axis (theory 7).
  elemental function axis_correction_lattice(number) result(correction)
    integer, intent(in) :: number
    real(dp) :: correction
    correction = merge(1.0_dp + 2.0_dp/number**2, 1.0_dp - 1.0_dp/number**2, mod(number, 2) == 0)
    correction = axis_correction*correction
  end function axis_correction_lattice

  !> Volume of a ring with the section of a cell, over its radius in cells.
  elemental function axis_cell(h) result(volume)
    real(dp), intent(in) :: h
    real(dp) :: volume
    volume = 2.0_dp*pi*h**3
  end function axis_cell

  !> Radius of a centre; of unequal cells the mean of the nodes around it.
  elemental function axis_radius(axis, c) result(radius)
    type(graded_axis_t), intent(in) :: axis      !! of the radius
    integer, intent(in) :: c
    real(dp) :: radius
    radius = c + 0.5_dp
    if (axis%graded) radius = 0.5_dp*(graded_node(axis, c) + graded_node(axis, c + 1))
  end function axis_radius

  !> Volume that particles give to a centre in a body that fills everything, over axis_cell: hat
  !! functions cannot integrate |r| over its kink, so that the one next to the axis gets 1/12 more.
  !! Of unequal cells it is over their sections.
  elemental function axis_radius_filled(axis, c) result(radius)
    type(graded_axis_t), intent(in) :: axis      !! of the radius
    integer, intent(in) :: c
    real(dp) :: radius
    radius = merge(13.0_dp/24.0_dp, c + 0.5_dp, c == 0)
    if (axis%graded) radius = axis_radius_balanced(axis, axis_correction, c)
  end function axis_radius_filled

  !> Volume of a full centre, over axis_cell, with which a uniform stress is at rest: at the first
  !! node off the axis its radial and its hoop stress balance if the centre beside the axis has
  !! (1 + C)/2. With C = 1/12 that is what hat functions give it. Of unequal cells it is over their
  !! sections.
  elemental function axis_radius_balanced(axis, correction, c) result(radius)
    type(graded_axis_t), intent(in) :: axis      !! of the radius
    real(dp), intent(in) :: correction           !! C
    integer, intent(in) :: c
    real(dp) :: radius
    radius = merge(0.5_dp + 0.5_dp*correction, c + 0.5_dp, c == 0)
    if (.not. axis%graded) return
    if (c < 0) then
      radius = axis_radius(axis, c)
    else if (c == 0) then
      radius = 0.5_dp*(balance(axis, correction, 1)*graded_node(axis, 1))/graded_width(axis, 0)
    else
      radius = axis_radius(axis, c) + correction*(graded_spacing(axis, c + 1) - &
                                                  graded_spacing(axis, c))
    end if
  end function axis_radius_balanced

end module sgmp_axis
