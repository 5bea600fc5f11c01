! dimension-generic, axisymmetric
#include "dimension.inc"
!> The pressure around all of a scene that ends at absorbing edges (sgmp_edge_pressure), the
!! particles' part.
module DIM(sgmp_surrounding)
  use sgmp_kinds, only: dp, lanes
  use sgmp_sums, only: sum_applied, sum_edge_work, sweep_sums
  use sgmp_voigt, only: flux_stress
  implicit none
  private
  public :: surrounding_book, surrounding_leave

contains

  !> Takes that pressure from the flux of a chunk: the grid does not feel it.
  pure subroutine surrounding_leave(pressure, live, volume, flux)
    real(dp), intent(in) :: pressure             !! (stress)
    real(dp), intent(in) :: live(lanes), volume(lanes)
    real(dp), intent(inout) :: flux(lanes, NFLUX)
    integer :: c
    do c = 1, NFLUX
      if (flux_stress(c, SPACE) <= 3) flux(:, c) = flux(:, c) + live*volume*pressure
    end do
  end subroutine surrounding_leave

  !> Its work on a chunk whose volume has changed in a step of the strain.
  pure subroutine surrounding_book(pressure, live, volume, jacobian, sums)
    real(dp), intent(in) :: pressure             !! (stress)
    real(dp), intent(in) :: live(lanes), volume(lanes)
    real(dp), intent(in) :: jacobian(lanes)      !! volume over that before the step
    real(dp), intent(inout) :: sums(lanes, sweep_sums)
    real(dp) :: work(lanes)
    work = -pressure*live*volume*(1.0_dp - 1.0_dp/jacobian)
    sums(:, sum_applied) = sums(:, sum_applied) + work
    sums(:, sum_edge_work) = sums(:, sum_edge_work) + work
  end subroutine surrounding_book

end module DIM(sgmp_surrounding)
