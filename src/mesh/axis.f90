!> What an axis of symmetry makes of the grid: hoop strain, radial inertia and volumes next to it
!! (theory 7). Radii are in cells: node i lies at r = i, centre c at r = c + 1/2.
module sgmp_axis
  use sgmp_kinds, only: dp, pi
  implicit none
  private
  public :: axis_correction, axis_cell, axis_hoop_weights, axis_inertia, axis_radius, &
            axis_radius_balanced, axis_radius_filled

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
  pure subroutine axis_hoop_weights(correction, first, n, inner, outer)
    real(dp), intent(in) :: correction           !! C
    integer, intent(in) :: first, n              !! first centre, how many
    real(dp), intent(out) :: inner(n), outer(n)
    real(dp) :: inverse, part, lower, upper
    integer :: i, c
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

  !> Radial mass of nodes over their mass: with moment/(r mass) in the place of 1 an expansion
  !! v_r = a r is projected exactly.
  pure subroutine axis_inertia(first, n, mass, moment, inertia)
    integer, intent(in) :: first, n              !! first node, how many
    real(dp), intent(in) :: mass(n), moment(n)   !! moment: sum of mass times radius
    real(dp), intent(out) :: inertia(n)
    real(dp) :: weight
    logical :: counts
    integer :: i
    !$omp simd private(weight, counts)
    do i = 1, n
      counts = first + i - 1 > 0 .and. mass(i) > 0.0_dp
      weight = merge(mass(i)*(first + i - 1), 1.0_dp, counts)
      weight = merge(moment(i), 1.0_dp, counts)/weight
      inertia(i) = merge(weight, least_inertia, weight > least_inertia)
    end do
  end subroutine axis_inertia

  !> Volume of a ring with the section of a cell, over its radius in cells.
  elemental function axis_cell(h) result(volume)
    real(dp), intent(in) :: h
    real(dp) :: volume
    volume = 2.0_dp*pi*h**3
  end function axis_cell

  !> Radius of a centre.
  elemental function axis_radius(c) result(radius)
    integer, intent(in) :: c
    real(dp) :: radius
    radius = c + 0.5_dp
  end function axis_radius

  !> Volume that particles give to a centre in a body that fills everything, over axis_cell: hat
  !! functions cannot integrate |r| over its kink, so that the one next to the axis gets 1/12 more.
  elemental function axis_radius_filled(c) result(radius)
    integer, intent(in) :: c
    real(dp) :: radius
    radius = merge(13.0_dp/24.0_dp, c + 0.5_dp, c == 0)
  end function axis_radius_filled

  !> Volume of a full centre, over axis_cell, with which a uniform stress is at rest: at the first
  !! node off the axis its radial and its hoop stress balance if the centre beside the axis has
  !! (1 + C)/2. With C = 1/12 that is what hat functions give it.
  elemental function axis_radius_balanced(correction, c) result(radius)
    real(dp), intent(in) :: correction           !! C
    integer, intent(in) :: c
    real(dp) :: radius
    radius = merge(0.5_dp + 0.5_dp*correction, c + 0.5_dp, c == 0)
  end function axis_radius_balanced

end module sgmp_axis
