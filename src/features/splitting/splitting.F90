! dimension-generic, axisymmetric
#include "dimension.inc"
!> Splits particles that have been stretched so far that they would leave gaps between them
!! (doc/volumes.md, 5): which of a chunk, along which axis, and what each half is.
!!
!! A particle stands for a box whose sides have the ratios of its stretches, which begin with those
!! of its sides at the start, and whose volume is the particle's. What happens to it depends on
!! nothing but the particle, the velocity gradient that strains it and the faces of the grid, so
!! that the same particles are split whatever threads and ranks do.
module DIM(sgmp_splitting)
#ifdef AXISYMMETRIC
  use sgmp_axis, only: axis_cell
#endif
  use sgmp_constitutive, only: constitutive_t, law_is_spherical
  use sgmp_graded_axis, only: graded_advance, graded_between, graded_place
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_occupied, mesh_sides, mesh_t
  use sgmp_motion, only: motion_mass, motion_total, motion_velocity
  use sgmp_splitting_type, only: splitting_t
  implicit none
  private
  public :: splitting_choose, splitting_halve

  integer, parameter :: before_v = motion_velocity(NDIM) - 1, mass_at = motion_mass(NDIM)
  real(dp), parameter :: widest_ratio = sqrt(3.0_dp)   !! of a fluid's side to the mean side

contains

  !> Which particles of a chunk are to be split: the axis, 0 for none, and how far from it (smallest
  !! cell) the centres of the halves will lie. Where one of these would lie outside the grid, or
  !! beyond the next bin, the particle waits; one that has failed stands for no space and is left
  !! alone. Sides are compared with those of the cell in which a particle is: where it comes into
  !! smaller ones it is split.
  !!
  !! Solids are judged by their longest side. A fluid shears without end, its sides are taken from
  !! what happened to it lately and it is judged by the mean side, so that splitting ends.
  pure subroutine splitting_choose(law, mesh, splitting, half_size, extent, nl, xi, nb, motion, &
                                   state, axis, offset)
    type(constitutive_t), intent(in) :: law
    type(mesh_t), intent(in) :: mesh
    type(splitting_t), intent(in) :: splitting
    real(dp), intent(in) :: half_size(NDIM)            !! of the particles at the start (cells)
    real(dp), intent(in) :: extent(2, NDIM)            !! of the bin (cells)
    integer, intent(in) :: nl                          !! particles in the chunk
    real(dp), intent(in) :: xi(lanes, NDIM)            !! place in the bin
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: state(lanes, nb)        !! a fluid's stretches are renewed
    integer, intent(out) :: axis(lanes)
    real(dp), intent(out) :: offset(lanes)
    real(dp) :: side(NDIM), cell(NDIM), mean, longest_path
    logical :: fluid, long(lanes)
    integer :: l
    axis = 0
    offset = 0.0_dp
    fluid = law_is_spherical(law)
    longest_path = 2.0_dp**splitting%halvings
    call look_at(mesh, splitting%limit, fluid, half_size, motion, state(1, law%slots%volume), &
                 state(1, law%slots%stretch), state(1, law%slots%path), longest_path, long)
    if (.not. any(long(:nl))) return
    do l = 1, nl
      if (.not. long(l)) cycle
      associate (stretch => state(l, law%slots%stretch:law%slots%stretch + NDIM - 1))
        mean = mesh_occupied(mesh, motion(l, :NDIM), state(l, law%slots%volume))**(1.0_dp/NDIM)
        cell = mesh_sides(mesh, motion(l, :NDIM))
        side = stretch/cell
        side = side*(mean/product(side)**(1.0_dp/NDIM))
        if (fluid) then
          side = max(mean/widest_ratio, min(mean*widest_ratio, side))
          side = side*(mean/product(side)**(1.0_dp/NDIM))
          stretch = side*cell/(2.0_dp*half_size)
        end if
        if (merge(mean, maxval(side), fluid) <= splitting%limit) cycle
        if (state(l, law%slots%path) >= longest_path) cycle
        if (law%slots%damage > 0) then
          if (state(l, law%slots%damage) >= 1.0_dp) cycle
        end if
        axis(l) = maxloc(side, 1)
        offset(l) = 0.25_dp*side(axis(l))*cell(axis(l))
#ifdef AXISYMMETRIC
        if (axis(l) == 1) then                           ! a ring ends at the axis
          offset(l) = min(offset(l), 0.5_dp*graded_place(mesh%axes(1), motion(l, 1)))
        end if
#endif
        if (.not. fits(mesh, motion(l, :NDIM), extent(:, axis(l)), xi(l, axis(l)), axis(l), &
                       offset(l))) axis(l) = 0
      end associate
    end do
  end subroutine splitting_choose

  !> Which particles of a chunk may have a side longer than the limit, and have not been split as
  !! often as may be: none is missed. Without the roots of the sides themselves, which most
  !! particles do not need. Of a fluid's also those whose stretches are due to be renewed: with a
  !! side some way beyond its bounds, or with a product that is more than 1 % off the volume.
  ! allow(S902)
  pure subroutine look_at(mesh, limit, fluid, half_size, motion, volume, stretch, path, &
                          longest_path, long)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: limit                      !! (cells)
    logical, intent(in) :: fluid
    real(dp), intent(in) :: half_size(NDIM)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), volume(lanes), stretch(lanes, NDIM)
    real(dp), intent(in) :: path(lanes), longest_path  !! of halves since the start
    logical, intent(out) :: long(lanes)
    real(dp), parameter :: near = 0.999_dp, beyond = 1.05_dp, drift = 0.01_dp
    real(dp), dimension(lanes) :: whole, longest, shortest, unit, filled
    real(dp) :: inverse(lanes, NDIM), spacing(lanes), lower(lanes), place(lanes), size_at_start
    integer :: l, d
    inverse = 1.0_dp
    if (mesh%graded) then
      do d = 1, NDIM
        call graded_between(mesh%axes(d), lanes, motion(1, d), spacing, lower, place)
        inverse(:, d) = 1.0_dp/spacing
      end do
    end if
    filled = volume
    whole = 1.0_dp
    longest = 0.0_dp
    shortest = huge(1.0_dp)
    do d = 1, NDIM
      filled = filled*inverse(:, d)
      whole = whole*(stretch(:, d)*inverse(:, d))
      longest = max(longest, stretch(:, d)*inverse(:, d))
      shortest = min(shortest, stretch(:, d)*inverse(:, d))
    end do
    unit = mesh%h**NDIM
#ifdef AXISYMMETRIC
    unit = axis_cell(mesh%h)*motion(:, 1)
    if (mesh%graded) unit = axis_cell(mesh%h)*graded_place(mesh%axes(1), motion(:, 1))
#endif
    if (fluid) then
      size_at_start = product(2.0_dp*half_size)
      do l = 1, lanes
        long(l) = (filled(l) > near*limit**NDIM*unit(l) .and. path(l) < longest_path) .or. &
                  longest(l)**NDIM > beyond*widest_ratio**NDIM*whole(l) .or. &
                  beyond*shortest(l)**NDIM*widest_ratio**NDIM < whole(l) .or. &
                  abs(whole(l)*size_at_start*unit(l) - filled(l)) > drift*filled(l)
      end do
    else
      do l = 1, lanes
        long(l) = longest(l)**NDIM*filled(l) > near*limit**NDIM*unit(l)*whole(l) .and. &
                  path(l) < longest_path
      end do
    end if
  end subroutine look_at

  !> Whether both halves will be inside the grid and within a cell of the bin that the particle was
  !! in.
  pure function fits(mesh, x, extent, xi, axis, offset) result(yes)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: x(NDIM), extent(2), xi
    integer, intent(in) :: axis
    real(dp), intent(in) :: offset                     !! (smallest cell)
    logical :: yes
    real(dp) :: low, high, origin
    low = graded_advance(mesh%axes(axis), x(axis), -offset)
    high = graded_advance(mesh%axes(axis), x(axis), offset)
    origin = x(axis) - xi
    yes = all(x >= mesh%lower(:NDIM) .and. x <= mesh%upper(:NDIM)) .and. &
          low >= mesh%lower(axis) .and. high <= mesh%upper(axis) .and. &
          low - origin >= extent(1) - 1.0_dp .and. high - origin < extent(2) + 1.0_dp
  end function fits

  !> Makes one half of each particle that is split: side -1 or +1. The halves lie at a quarter of
  !! the side from the centre, each with half of the mass and the volume, and with the velocity that
  !! the gradient says for its place; everything per mass and volume is that of the whole. `kinetic`
  !! receives what the half has of kinetic energy beyond its share of the whole's.
  !!
  !! A ring that is split across the radius has halves as large as their radii say. Their centre of
  !! mass lies outside the whole's: velocities along the axis count from there, so that momentum
  !! stays, those along the radius from the whole's place, so that an expansion stays one. With
  !! swirl both turn at the rate that keeps the moment of momentum, (1 + 3 (offset/radius)^2)^-1 of
  !! the whole's.
  pure subroutine splitting_halve(law, mesh, side, axis, offset, gradient, nb, motion, state, &
                                  share, kinetic)
    type(constitutive_t), intent(in) :: law
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: side, axis(lanes)
    real(dp), intent(in) :: offset(lanes)              !! (smallest cell)
    real(dp), intent(in) :: gradient(lanes, NGRAD)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(out) :: share(lanes)              !! of the half in the whole
    real(dp), intent(inout) :: kinetic(lanes)
    real(dp) :: change, way(NDIM)
#ifdef AXISYMMETRIC
    real(dp) :: radius
#endif
    integer :: l, d
    share = 0.5_dp
    do l = 1, lanes
      if (axis(l) == 0) cycle
      way = side*offset(l)
#ifdef AXISYMMETRIC
      radius = graded_place(mesh%axes(1), motion(l, 1))
      if (axis(l) == 1) then
        share(l) = 0.5_dp*(1.0_dp + side*offset(l)/radius)
        way(2) = way(2) - offset(l)**2/radius
        kinetic(l) = kinetic(l) + share(l)*motion(l, mass_at)*motion(l, before_v + 1)*way(1)* &
                     mesh%h*gradient(l, 1)
      end if
#endif
      motion(l, axis(l)) = graded_advance(mesh%axes(axis(l)), motion(l, axis(l)), side*offset(l))
      motion(l, mass_at) = share(l)*motion(l, mass_at)
      do d = 1, NDIM
        change = way(d)*mesh%h*gradient(l, (d - 1)*NDIM + axis(l))
        motion(l, before_v + d) = motion(l, before_v + d) + change
        kinetic(l) = kinetic(l) + 0.5_dp*motion(l, mass_at)*change**2
      end do
      associate (slots => law%slots, stretch => state(l, law%slots%stretch + axis(l) - 1), &
                 path => state(l, law%slots%path))
        state(l, slots%volume) = share(l)*state(l, slots%volume)
        if (slots%compliance > 0) then
          state(l, slots%compliance) = share(l)*state(l, slots%compliance)
        end if
#ifdef AXISYMMETRIC
        if (slots%swirl > 0 .and. axis(l) == 1) then
          call halve_swirl(side*offset(l), radius + side*offset(l), motion(l, mass_at), &
                           state(l, slots%swirl), kinetic(l))
        end if
#endif
        stretch = 0.5_dp*stretch
        path = 2.0_dp*path + merge(0.0_dp, 1.0_dp, side < 0)
      end associate
    end do
  end subroutine splitting_halve

#ifdef AXISYMMETRIC
  !> The moment v_theta X of a half of a ring split across the radius, and what it has of kinetic
  !! energy beyond its share of the whole's.
  pure subroutine halve_swirl(way, radius, mass, moment, kinetic)
    real(dp), intent(in) :: way, radius    !! from the whole, of the half (smallest cell)
    real(dp), intent(in) :: mass
    real(dp), intent(inout) :: moment, kinetic
    real(dp) :: whole, part
    whole = radius - way
    part = moment*(radius/whole)**2/(1.0_dp + 3.0_dp*(way/whole)**2)
    kinetic = kinetic + 0.5_dp*mass*((part/radius)**2 - (moment/whole)**2)
    moment = part
  end subroutine halve_swirl
#endif

end module DIM(sgmp_splitting)
