! dimension-generic, axisymmetric
#include "dimension.inc"
!> What particles relax to at the centres of one plane, so that their volumes stay those of the
!! space they fill (doc/volumes.md): velocities and pressures to their means where they differ by
!! what the grid cannot see, volumes to the cell's where they sum to more or less than it holds.
!!
!! Every coefficient belongs to a centre, so that all particles around it see the same and sums of
!! what they exchange vanish centre by centre.
module DIM(sgmp_centres_relax)
  use DIM(sgmp_auxmesh), only: node_rows
  use sgmp_axis, only: axis_correction
  use sgmp_columns, only: node_remapped, relax_dilation, relax_exchange, relax_filling, &
                          relax_filter, relax_square, relax_stiffness, relax_velocity
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use DIM(sgmp_nodes_normalise), only: cell_sides, cell_volume, filled_volumes, grade_volumes, &
                                       least_volume, normalise_factor
  use sgmp_rows, only: key_j, key_k
  implicit none
  private
  public :: centres_relax
  public :: filling_change, scatter_excess

  integer, parameter :: tile = 128
  real(dp), parameter :: seen = 0.25_dp  !! variance of a linear field, over h^2 slope^2: that of
                                         !! a hat function is 1/6 where particles lie evenly
  real(dp), parameter :: noticed = 1.0e-3_dp  !! of sound speed and bulk modulus: less is no noise
  real(dp), parameter :: band = 0.1_dp        !! of the filling: the quadrature's own ripple
  real(dp), parameter :: filling_rate = 0.1_dp  !! part of the logarithm that a step takes away

contains

  !> Rates and means at the centres of one plane, from the moments of the particles at the start of
  !! the step and the re-mapped velocity.
  pure subroutine centres_relax(field, mesh, plane, method, dt)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: dt
    real(dp) :: least(0:tile + 1), filled(tile), slope2(tile), pressure(tile), jump2(tile), cell
    real(dp) :: sides(tile)
    integer :: s, first, n, idx, j, k
    cell = cell_volume(mesh%h)
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      j = key_j(field%work%key(s))
      k = key_k(field%work%key(s))
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        idx = field%neighbour(0, 0, s) + first
        call least_volume(field, mesh, s, first, n, cell, least)
        call filled_volumes(mesh, cell, axis_correction, first, n, filled)
        if (mesh%graded) call grade_volumes(mesh, j, k, first, n, filled)
        call cell_sides(mesh, j, k, first, n, sides)
        call velocity_slopes(field, mesh%inverse_h, s, first, n, slope2)
        call pressure_jumps(field, s, first, n, pressure, jump2)
        call relax_row(field, n, idx, method, mesh%h, dt, cell, sides, least, filled, slope2, &
                       pressure, jump2)
      end do
    end do
  end subroutine centres_relax

  !> All of it for the centres of a row.
  pure subroutine relax_row(field, n, idx, method, h, dt, cell, sides, least, filled, slope2, &
                            pressure, jump2)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: n, idx             !! centres, record of the first
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: h, dt, cell
    real(dp), intent(in) :: sides(tile)        !! of the cells, the least of each (smallest cell)
    real(dp), intent(in) :: least(0:tile + 1)  !! volume in the rows around
    real(dp), intent(in), dimension(tile) :: filled, slope2, pressure, jump2
    real(dp) :: mass, volume, speed2, courant, velocity(NDIM), square, rate, weight
    logical :: interior
    integer :: i, c
    associate (columns => field%columns)
      do i = 1, n
        c = idx + i - 1
        field%relax(c, :) = 0.0_dp
        mass = field%moment(c, columns%mass)
        volume = field%moment(c, columns%volume)
        if (mass <= method%cutoff .or. volume <= 0.0_dp) cycle
        interior = min(least(i - 1), least(i), least(i + 1)) > method%interior*cell
        speed2 = field%moment(c, columns%stiffness)/mass
        courant = dt*sqrt(speed2)/(h*sides(i))
        field%relax(c, relax_stiffness) = field%moment(c, columns%stiffness)/volume
        velocity = field%moment(c, columns%momentum:columns%momentum + NDIM - 1)/mass
        square = sum(velocity**2)
        rate = min(1.0_dp, courant*scatter_excess(field%moment(c, columns%square)/mass - square, &
                                                  seen*h**2*slope2(i) + noticed**2*speed2))
        if (.not. interior) rate = 0.0_dp
        field%relax(c, relax_filter) = rate
        field%relax(c, relax_velocity:relax_velocity + NDIM - 1) = rate*velocity
        field%relax(c, relax_square) = rate*square
        weight = field%moment(c, columns%compliance)
        if (weight > 0.0_dp) then
          rate = scatter_excess(field%moment(c, columns%compliance + 2)/weight - pressure(i)**2, &
                                seen*jump2(i) &
                                + (noticed*field%relax(c, relax_stiffness))**2)
          rate = 0.5_dp*min(1.0_dp, courant*rate)
          field%relax(c, relax_exchange:relax_exchange + 2) = rate*[1.0_dp, pressure(i), &
                                                                    pressure(i)**2]
        end if
        field%relax(c, relax_filling) = filling_change(volume/filled(i), interior)
        if (interior) then
          field%relax(c, relax_dilation) = normalise_factor(volume, filled(i), field%gaps) - 1.0_dp
        end if
      end do
    end associate
  end subroutine relax_row

  !> Part of a variance that exceeds what the grid can represent; 0 to the bit where it can.
  elemental function scatter_excess(variance, represented) result(part)
    real(dp), intent(in) :: variance, represented
    real(dp) :: part
    part = 0.0_dp
    if (variance > represented) part = 1.0_dp - represented/variance
  end function scatter_excess

  !> Logarithm of the factor on the volumes around a centre.
  elemental function filling_change(filling, interior) result(change)
    real(dp), intent(in) :: filling           !! volume over the cell's
    logical, intent(in) :: interior           !! all neighbours are filled
    real(dp) :: change
    change = 0.0_dp
    if (filling > 1.0_dp + band) then
      change = -filling_rate*log(filling/(1.0_dp + band))
    else if (interior .and. filling < 1.0_dp - band) then
      change = -filling_rate*log(filling/(1.0_dp - band))
    end if
  end function filling_change

  !> Square of the gradient of the re-mapped velocity at the centres of a row, as if cells were
  !! equal: of unequal ones it is that of the differences across each, which is what scatters.
  pure subroutine velocity_slopes(field, inverse_h, s, first, n, slope2)
    type(field_t), intent(in) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, first, n
    real(dp), intent(out) :: slope2(tile)
    integer :: i, a, b(NROW)
    b = node_rows(field, s, first)
    slope2 = 0.0_dp
    do a = node_remapped, node_remapped + NDIM - 1
      associate (v => field%node(:, a))
        do i = 1, n
          slope2(i) = slope2(i) + (corner_sum(v, b, i) - corner_sum(v, b, i - 1))**2
#if NDIM > 1
          slope2(i) = slope2(i) + (corner_slope_2(v, b, i - 1) + corner_slope_2(v, b, i))**2
#endif
#if NDIM > 2
          slope2(i) = slope2(i) + (corner_slope_3(v, b, i - 1) + corner_slope_3(v, b, i))**2
#endif
        end do
      end associate
    end do
    slope2(:n) = (inverse_h*0.5_dp**(NDIM - 1))**2*slope2(:n)
  end subroutine velocity_slopes

  !> Mean pressure at the centres of a row, and the sum over the axes of the square of its larger
  !! one-sided difference; centres without pressure make none.
  pure subroutine pressure_jumps(field, s, first, n, pressure, jump2)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n
    real(dp), intent(out) :: pressure(tile), jump2(tile)
    integer :: i, c, axis, below, above
    do i = 1, n
      c = first + i - 1
      pressure(i) = mean_pressure(field, field%neighbour(0, 0, s) + c, 0.0_dp)
      jump2(i) = 0.0_dp
      do axis = 1, NDIM
        if (axis == 1) then
          below = field%neighbour(0, 0, s) - 1
          above = field%neighbour(0, 0, s) + 1
        else if (axis == NDIM) then
          below = field%neighbour(0, -1, s)
          above = field%neighbour(0, 1, s)
        else
          below = field%neighbour(-1, 0, s)
          above = field%neighbour(1, 0, s)
        end if
        jump2(i) = jump2(i) + max((mean_pressure(field, below + c, pressure(i)) - pressure(i))**2, &
                                  (mean_pressure(field, above + c, pressure(i)) - pressure(i))**2)
      end do
    end do
  end subroutine pressure_jumps

  !> Mean pressure at a centre.
  pure function mean_pressure(field, c, absent) result(pressure)
    type(field_t), intent(in) :: field
    integer, intent(in) :: c                  !! its record
    real(dp), intent(in) :: absent            !! where nothing has a pressure
    real(dp) :: pressure
    associate (w => field%moment(c, field%columns%compliance))
      pressure = absent
      if (w > 0.0_dp) pressure = field%moment(c, field%columns%compliance + 1)/w
    end associate
  end function mean_pressure

#include "corner_sums.inc"

end module DIM(sgmp_centres_relax)
