! dimension-generic
#include "dimension.inc"
!> Liquids move so that the room of a particle changes as its volume does (doc/volumes.md).
!!
!! Strains are interpolated between the gradients at centres. A particle that moves with the
!! interpolated velocity moves through a field with another divergence: liquids drift into clusters,
!! heavy to gravity and not to pressure, which stir. The field whose divergence is that of the
!! strains has along each axis a, xi the place between two centres,
!!     w_a = v_a - h xi (1 - xi)/2 (g_above - g_below),   g = dv_a/dx_a at the centres,     (VM1)
!! the differences interpolated across the axis as the strains are: the quadratic spline along a in
!! the place of two means.
module DIM(sgmp_drift_matched)
  use sgmp_kinds, only: dp, lanes
  use DIM(sgmp_transfer), only: linear_gather, linear_weights
  implicit none
  private
  public :: drift_matched

contains

  !> Takes the velocity that moves the particles of a chunk to that of (VM1).
  pure subroutine drift_matched(h, live, xi, cell, stride, gradients, row, velocity)
    real(dp), intent(in) :: h                    !! cell side
    real(dp), intent(in) :: live(lanes)          !! 0 for pads
    real(dp), intent(in) :: xi(lanes, NDIM)      !! places between centres
    integer, intent(in) :: cell(lanes), stride
    real(dp), intent(in) :: gradients(stride, *)  !! of the velocity, from the first on
    integer, intent(in) :: row(NROW)
    real(dp), intent(inout) :: velocity(lanes, NDIM)
    real(dp), dimension(lanes, NCORNER) :: above, below
    real(dp) :: end(lanes, NDIM), jump(lanes, 1)
    integer :: a
    do a = 1, NDIM
      end = xi
      end(:, a) = 1.0_dp
      call linear_weights(end, above)
      end(:, a) = 0.0_dp
      call linear_weights(end, below)
      call linear_gather(1, above - below, cell, stride, gradients(1 + (a - 1)*(NDIM + 1), 1), &
                         row, jump)
      velocity(:, a) = velocity(:, a) - 0.5_dp*h*live*xi(:, a)*(1.0_dp - xi(:, a))*jump(:, 1)
    end do
  end subroutine drift_matched

end module DIM(sgmp_drift_matched)
