! dimension-generic
#include "dimension.inc"
!> Particles that see the grid from their first places (method frame=reference, total Lagrangian):
!! weights are those of X, where a particle was at the start, and never change; no particle changes
!! its bin (doc/reference-frame.md).
!!
!! With F = dx/dX the grid gives dF/dt = Σ v_I grad_X N_I. The stress update wants
!!
!!     L = dF/dt F^-1,                                                                      (RF1)
!!
!! and the forces at the nodes are those of the first Piola stress, V_0 P = V sigma F^-T:
!!
!!     f_I = -Σ_p (V sigma F^-T) grad_X N_I.                                                (RF2)
!!
!! A wave of speed c with the normal N in the first shape goes through it at c |F^-T N|, at most at
!! c over the least stretch:
!!
!!     dt <= C h/max_p (c/lambda_1 + |v|), lambda_1^-2 the largest eigenvalue of F^-1 F^-T. (RF3)
!!
!! (Total Lagrangian MPM: A. de Vaucorbeil, V. P. Nguyen, C. R. Hutchinson, Comput. Methods Appl.
!! Mech. Engrg. 360, 2020, 112783.)
!!
!! Columns of a particle: X (cells), F row by row.
module DIM(sgmp_reference)
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_motion, only: motion_mass, motion_total
  use sgmp_particle_faults, only: fault_none, fault_squeezed, fault_through_wall
  use sgmp_sums, only: sum_moment, sweep_sums
  implicit none
  private
  public :: reference_check, reference_drift, reference_locate, reference_nominal, &
            reference_rates, reference_strain, reference_way, reference_way_now
  public :: nominal_of

  !> Component of the flux that (RF2) wants, (b, a): force along a by the derivative along b.
  integer, parameter :: nominal_of(NDIM, NDIM) = reshape([1, 2, 3, 4, 5, 6, 7, 8, 9], [NDIM, NDIM])
  integer, parameter :: mass_at = motion_mass(NDIM)
  real(dp), parameter :: least_stretch = 0.2_dp  !! of a particle whose first place still says where
                                                 !! its neighbours are

contains

  !> First places in the bin; pads lie with the last particle.
  pure subroutine reference_locate(nl, first, origin, xi)
    integer, intent(in) :: nl                    !! particles in the chunk
    real(dp), intent(in) :: first(lanes, NDIM), origin(NDIM)
    real(dp), intent(out) :: xi(lanes, NDIM)
    integer :: d
    do d = 1, NDIM
      xi(:nl, d) = first(:nl, d) - origin(d)
      xi(nl + 1:, d) = xi(nl, d)
    end do
  end subroutine reference_locate

  !> x += v dt in cells; the places by which particles see the grid stay.
  pure subroutine reference_drift(dt, live, velocity, motion, lane_sums)
    real(dp), intent(in) :: dt                   !! position step over the cell
    real(dp), intent(in) :: live(lanes), velocity(lanes, NDIM)
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), lane_sums(lanes, sweep_sums)
    integer :: d
    do d = 1, NDIM
      motion(:, d) = motion(:, d) + dt*velocity(:, d)
      lane_sums(:, sum_moment + d - 1) = lane_sums(:, sum_moment + d - 1) + &
                                         live*motion(:, mass_at)*motion(:, d)
    end do
  end subroutine reference_drift

  !> Turns dF/dt, which the grid gives, into the velocity gradient (RF1).
  pure subroutine reference_rates(f, gradient, rates)
    real(dp), intent(in) :: f(lanes, NDIM, NDIM)             !! (:, b, a) is F_ab, so below
    real(dp), intent(inout) :: gradient(lanes, NDIM, NDIM)   !! dF/dt, then L
    real(dp), intent(out) :: rates(lanes, NDIM, NDIM)        !! dF/dt
    real(dp) :: inverse(lanes, NDIM, NDIM)
    integer :: a, b, c
    rates = gradient
    call invert(f, inverse)
    do a = 1, NDIM
      do b = 1, NDIM
        gradient(:, b, a) = rates(:, 1, a)*inverse(:, b, 1)
        do c = 2, NDIM
          gradient(:, b, a) = gradient(:, b, a) + rates(:, c, a)*inverse(:, b, c)
        end do
      end do
    end do
  end subroutine reference_rates

  !> F after a strain step.
  pure subroutine reference_strain(dt, rates, f)
    real(dp), intent(in) :: dt, rates(lanes, NDIM, NDIM)
    real(dp), intent(inout) :: f(lanes, NDIM, NDIM)
    f = f + dt*rates
  end subroutine reference_strain

  !> V sigma F^-T of (RF2).
  pure subroutine reference_nominal(f, flux_of, flux, nominal)
    real(dp), intent(in) :: f(lanes, NDIM, NDIM)
    integer, intent(in) :: flux_of(NDIM, NDIM)   !! components of the flux
    real(dp), intent(in) :: flux(lanes, *)       !! V sigma
    real(dp), intent(out) :: nominal(lanes, NDIM, NDIM)
    real(dp) :: inverse(lanes, NDIM, NDIM)
    integer :: a, b, c
    call invert(f, inverse)
    do a = 1, NDIM
      do b = 1, NDIM
        nominal(:, b, a) = flux(:, flux_of(1, a))*inverse(:, 1, b)
        do c = 2, NDIM
          nominal(:, b, a) = nominal(:, b, a) + flux(:, flux_of(c, a))*inverse(:, c, b)
        end do
      end do
    end do
  end subroutine reference_nominal

  !> Squares of the speeds that limit the step (RF3), and what must not go on: particles that are
  !! squeezed too far, and such as have come through a wall, which holds only what shares its nodes.
  pure subroutine reference_check(mesh, nl, motion, f, speed2, fault, lane)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: nl                    !! particles in the chunk
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), f(lanes, NDIM, NDIM)
    real(dp), intent(inout) :: speed2(lanes)
    integer, intent(out) :: fault, lane          !! one of fault_*, and of which particle if any
    real(dp) :: shortness(lanes), inverse(lanes, NDIM, NDIM)
    logical :: outside(lanes)
    integer :: d
    lane = 1
    call invert(f, inverse)
    call invert_stretch(inverse, shortness)
    speed2 = speed2*shortness
    fault = fault_none
    if (maxval(shortness) > least_stretch**(-2)) then
      lane = maxloc(shortness(:nl), 1)
      if (shortness(lane) > least_stretch**(-2)) fault = fault_squeezed
    end if
    if (fault /= fault_none .or. all(mesh%wall == wall_free)) return
    outside = .false.
    do d = 1, NDIM
      if (mesh%wall(1, d) /= wall_free) outside = outside .or. motion(:, d) < mesh%lower(d)
      if (mesh%wall(2, d) /= wall_free) outside = outside .or. motion(:, d) > mesh%upper(d)
    end do
    if (.not. any(outside(:nl))) return
    lane = findloc(outside(:nl), .true., 1)
    fault = fault_through_wall
  end subroutine reference_check

  !> The way from a particle to one of its faces as it lies now, from the face's area vector a: in
  !! the first shape half of the volume lies between them, w_0 = V/2 F^T a/|F^T a|^2, and w = F w_0.
  pure subroutine reference_way_now(f, volume, area, way)
    real(dp), intent(in) :: f(lanes, NDIM, NDIM), volume(lanes)
    real(dp), intent(in) :: area(lanes, NDIM)    !! 0 where there is no face
    real(dp), intent(out) :: way(lanes, NDIM)    !! 0 there
    real(dp) :: first(lanes, NDIM), square(lanes)
    integer :: a, b
    do b = 1, NDIM
      first(:, b) = 0.0_dp
      do a = 1, NDIM
        first(:, b) = first(:, b) + f(:, b, a)*area(:, a)
      end do
    end do
    square = sum(first**2, dim=2)
    do b = 1, NDIM
      first(:, b) = 0.5_dp*volume*first(:, b)/merge(square, 1.0_dp, square > 0.0_dp)
    end do
    do a = 1, NDIM
      way(:, a) = 0.0_dp
      do b = 1, NDIM
        way(:, a) = way(:, a) + f(:, b, a)*first(:, b)
      end do
    end do
  end subroutine reference_way_now

  !> A way in the first shape, F^-1 w.
  pure function reference_way(f, way) result(first)
    real(dp), intent(in) :: f(lanes, NDIM, NDIM), way(lanes, NDIM)
    real(dp) :: first(lanes, NDIM)
    real(dp) :: inverse(lanes, NDIM, NDIM)
    integer :: a, b
    call invert(f, inverse)
    do a = 1, NDIM
      first(:, a) = 0.0_dp
      do b = 1, NDIM
        first(:, a) = first(:, a) + inverse(:, b, a)*way(:, b)
      end do
    end do
  end function reference_way

  !> Inverse of F; of pads, whose F may be 0, what is finite.
  pure subroutine invert(f, inverse)
    real(dp), intent(in) :: f(lanes, NDIM, NDIM)
    real(dp), intent(out) :: inverse(lanes, NDIM, NDIM)
    real(dp) :: one                              ! over the determinant
    integer :: l
    !$omp simd simdlen(8) private(one)
    do l = 1, lanes
#if NDIM == 1
      one = f(l, 1, 1)
      inverse(l, 1, 1) = 1.0_dp/merge(one, 1.0_dp, abs(one) > 0.0_dp)
#elif NDIM == 2
      one = f(l, 1, 1)*f(l, 2, 2) - f(l, 2, 1)*f(l, 1, 2)
      one = 1.0_dp/merge(one, 1.0_dp, abs(one) > 0.0_dp)
      inverse(l, 1, 1) = one*f(l, 2, 2)
      inverse(l, 2, 2) = one*f(l, 1, 1)
      inverse(l, 2, 1) = -one*f(l, 2, 1)
      inverse(l, 1, 2) = -one*f(l, 1, 2)
#else
      one = f(l, 1, 1)*minor(f, l, 2, 3, 2, 3) + f(l, 2, 1)*minor(f, l, 3, 1, 2, 3) + &
            f(l, 3, 1)*minor(f, l, 1, 2, 2, 3)
      one = 1.0_dp/merge(one, 1.0_dp, abs(one) > 0.0_dp)
      inverse(l, 1, 1) = one*minor(f, l, 2, 3, 2, 3)
      inverse(l, 1, 2) = one*minor(f, l, 3, 1, 2, 3)
      inverse(l, 1, 3) = one*minor(f, l, 1, 2, 2, 3)
      inverse(l, 2, 1) = one*minor(f, l, 2, 3, 3, 1)
      inverse(l, 2, 2) = one*minor(f, l, 3, 1, 3, 1)
      inverse(l, 2, 3) = one*minor(f, l, 1, 2, 3, 1)
      inverse(l, 3, 1) = one*minor(f, l, 2, 3, 1, 2)
      inverse(l, 3, 2) = one*minor(f, l, 3, 1, 1, 2)
      inverse(l, 3, 3) = one*minor(f, l, 1, 2, 1, 2)
#endif
    end do
  end subroutine invert

#if NDIM == 3
  !> f_i1,j1 f_i2,j2 - f_i1,j2 f_i2,j1, to be inlined in a loop over the lanes.
  pure function minor(f, l, i1, i2, j1, j2) result(value)
    real(dp), intent(in) :: f(lanes, 3, 3)
    integer, intent(in) :: l, i1, i2, j1, j2
    real(dp) :: value
    value = f(l, i1, j1)*f(l, i2, j2) - f(l, i1, j2)*f(l, i2, j1)
  end function minor

#endif
  !> Largest eigenvalue of F^-1 F^-T, lambda_1^-2; in space the bound m + 2 p of it, m a third of
  !! the trace, 6 p^2 the square of the deviator: exact where nothing or one direction is shortened.
  pure subroutine invert_stretch(inverse, shortness)
    real(dp), intent(in) :: inverse(lanes, NDIM, NDIM)
    real(dp), intent(out) :: shortness(lanes)
#if NDIM == 1
    shortness = inverse(:, 1, 1)**2
#else
    real(dp) :: mean, square, component
    integer :: l, a, b
    !$omp simd simdlen(8) private(mean, square, component, a, b)
    do l = 1, lanes
      mean = 0.0_dp
      square = 0.0_dp
      do a = 1, NDIM
        do b = a, NDIM
#if NDIM == 2
          component = inverse(l, 1, a)*inverse(l, 1, b) + inverse(l, 2, a)*inverse(l, 2, b)
#else
          component = inverse(l, 1, a)*inverse(l, 1, b) + inverse(l, 2, a)*inverse(l, 2, b) + &
                      inverse(l, 3, a)*inverse(l, 3, b)
#endif
          square = square + merge(1.0_dp, 2.0_dp, a == b)*component**2
          if (a == b) mean = mean + component/NDIM
        end do
      end do
      square = max(square - NDIM*mean**2, 0.0_dp)  ! of the deviator
#if NDIM == 2
      shortness(l) = mean + sqrt(0.5_dp*square)
#else
      shortness(l) = mean + 2.0_dp*sqrt(square/6.0_dp)
#endif
    end do
#endif
  end subroutine invert_stretch

end module DIM(sgmp_reference)
