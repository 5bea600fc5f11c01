! dimension-generic
#include "dimension.inc"
!> The drift of a chunk where cells are unequal (sgmp_graded_axis). Apart from sgmp_chunk, whose
!! code for equal cells is then what it would be without.
module DIM(sgmp_drift_graded)
  use sgmp_graded_axis, only: graded_advance, graded_between, graded_centre, graded_place, &
                              graded_spacing
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_mass, motion_total
  use sgmp_sums, only: sum_moment, sweep_sums
  implicit none
  private
  public :: drift_graded

  integer, parameter :: mass_at = motion_mass(NDIM)

contains

  !> Moves a chunk: coordinates grow by the way over the spacing of the centres
  !! between which a particle is, and sums are those of places.
  ! allow(S902)
  pure subroutine drift_graded(mesh, dt, live, origin, extent, velocity, motion, xi, lane_sums, &
                               outside)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: dt, live(lanes), origin(NDIM), extent(2, NDIM), velocity(lanes, NDIM)
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), lane_sums(lanes, sweep_sums)
    real(dp), intent(out) :: xi(lanes, NDIM)     !! new position in the bin
    logical, intent(out) :: outside
    real(dp), dimension(lanes, NDIM) :: before, place
    real(dp), dimension(lanes) :: sides, lower, base, off
    real(dp) :: spacing, inverse, start, part, middle, half, furthest, left
    integer :: l, d, c
    before = motion(:, :NDIM)
    off = 0.0_dp
    do d = 1, NDIM
      if (NDIM == 3 .or. d > 1) then             ! along this axis a bin is a cell
        c = nint(origin(d) - 0.5_dp)
        spacing = graded_spacing(mesh%axes(d), c + 1)
        inverse = dt/spacing
        start = graded_centre(mesh%axes(d), c)
        !$omp simd simdlen(8)
        do l = 1, lanes
          motion(l, d) = before(l, d) + inverse*velocity(l, d)
          xi(l, d) = motion(l, d) - origin(d)
          place(l, d) = start + spacing*xi(l, d)
          off(l) = max(off(l), abs(xi(l, d) - 0.5_dp))
        end do
      else
        call graded_between(mesh%axes(d), lanes, before(1, d), sides, lower, base)
        !$omp simd simdlen(8) private(part)
        do l = 1, lanes
          part = (before(l, d) - lower(l)) + dt*velocity(l, d)/sides(l)
          motion(l, d) = lower(l) + part
          xi(l, d) = motion(l, d) - origin(d)
          place(l, d) = base(l) + part*sides(l)
          off(l) = max(off(l), abs(part - 0.5_dp))
        end do
      end if
    end do
    furthest = 0.0_dp
    !$omp simd simdlen(8) reduction(max:furthest)
    do l = 1, lanes
      furthest = max(furthest, off(l))
    end do
    if (.not. furthest < 0.5_dp) then            ! some have come between other centres
      do d = 1, NDIM
        do l = 1, lanes
          if (off(l) < 0.5_dp) cycle
          motion(l, d) = graded_advance(mesh%axes(d), before(l, d), dt*velocity(l, d))
          xi(l, d) = motion(l, d) - origin(d)
          place(l, d) = graded_place(mesh%axes(d), motion(l, d))
        end do
      end do
    end if
    left = 0.0_dp
    off = 0.0_dp
    do d = 1, NDIM
      middle = 0.5_dp*(extent(2, d) + extent(1, d))
      half = 0.5_dp*(extent(2, d) - extent(1, d))
      !$omp simd simdlen(8)
      do l = 1, lanes
        lane_sums(l, sum_moment + d - 1) = lane_sums(l, sum_moment + d - 1) + &
                                           live(l)*motion(l, mass_at)*place(l, d)
        off(l) = max(off(l), merge(0.0_dp, 1.0_dp, abs(xi(l, d) - middle) < half))
      end do
    end do
    !$omp simd simdlen(8) reduction(max:left)
    do l = 1, lanes
      left = max(left, off(l))
    end do
    outside = left > 0.0_dp
  end subroutine drift_graded

end module DIM(sgmp_drift_graded)
