! dimension-generic, axisymmetric
#include "dimension.inc"
!> Forces on faces where cells are unequal (doc/loads.md, doc/grids.md): levers in the spacings of
!! the centres between which particles are.
!!
!! At a centre stresses see what is linear between the nodes around it, by which forces on faces
!! are handed to the nodes, too (graded_spread). Between two centres that are H apart they see
!! -H xi (1 - xi)/2 (g_c+1 - g_c) more, g the derivative at a centre: the levers of equal cells,
!! with H in the place of the side. Particles read both nodes with 1/2, which is what is linear at a
!! place somewhat off theirs (graded_loads_aside).
module DIM(sgmp_graded_loads)
  use sgmp_columns, only: twist_takes
  use sgmp_graded_axis, only: graded_spacing, graded_width
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_total
  implicit none
  private
  public :: graded_loads_aside, graded_loads_factor, graded_loads_sides, graded_loads_slopes

contains

  !> Spacings of the centres between which particles are (smallest cell).
  pure function graded_loads_sides(mesh, motion) result(sides)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp) :: sides(lanes, NDIM)
    integer :: d
    do d = 1, NDIM
      sides(:, d) = graded_spacing(mesh%axes(d), below(motion(:, d)) + 1)
    end do
  end function graded_loads_sides

  !> Way from where the velocities that particles read are those of the nodes to where they are
  !! (smallest cell).
  pure function graded_loads_aside(mesh, motion) result(way)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp) :: way(lanes, NDIM), xi(lanes)
    integer :: d, c(lanes)
    do d = 1, NDIM
      c = below(motion(:, d))
      xi = motion(:, d) - (c + 0.5_dp)
      way(:, d) = (1.0_dp - xi)*aside(mesh, d, c) + xi*aside(mesh, d, c + 1)
    end do
  end function graded_loads_aside

  !> The slopes 1/h_c of the centres below and above (1/smallest cell).
  pure function graded_loads_slopes(mesh, motion) result(slopes)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp) :: slopes(lanes, NDIM, 2)
    integer :: d, side
    do d = 1, NDIM
      do side = 1, 2
        slopes(:, d, side) = 1.0_dp/graded_width(mesh%axes(d), below(motion(:, d)) + side - 1)
      end do
    end do
  end function graded_loads_slopes

  !> Product along the axes of a twist of the spacings times the slopes, at one corner.
  pure function graded_loads_factor(twist, corner, sides, slopes) result(factor)
    integer, intent(in) :: twist, corner         !! bits: upper ends
    real(dp), intent(in) :: sides(lanes, NDIM), slopes(lanes, NDIM, 2)
    real(dp) :: factor(lanes)
    integer :: d
    factor = 1.0_dp
    do d = 1, NDIM
      if (twist_takes(twist, d, NDIM)) then
        factor = factor*(sides(:, d)*slopes(:, d, merge(2, 1, btest(corner, d - 1))))
      end if
    end do
  end function graded_loads_factor

  !> The centre below a coordinate.
  elemental function below(x) result(c)
    real(dp), intent(in) :: x
    integer :: c
    c = floor(x - 0.5_dp)
  end function below

  !> How far a centre is from the middle of the nodes around it, (1/2 - low) h_c (smallest cell).
  elemental function aside(mesh, axis, c) result(way)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, c
    real(dp) :: way
    way = 0.25_dp*(graded_spacing(mesh%axes(axis), c) - graded_spacing(mesh%axes(axis), c + 1))
  end function aside

end module DIM(sgmp_graded_loads)
