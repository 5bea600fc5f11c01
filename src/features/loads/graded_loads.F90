! dimension-generic, axisymmetric
#include "dimension.inc"
!> Forces on faces where cells are unequal (doc/loads.md, doc/grids.md): levers in the spacings of
!! the centres between which particles are.
!!
!! Between two centres that are H apart stresses see -H xi (1 - xi)/2 (g_c+1 - g_c) more than forces
!! on faces, g the derivative at a centre: the levers of equal cells, with H in the place of the
!! side. Along the normal they see at a centre what is linear between the nodes around it. So do
!! forces on matter that bends, which are handed to the nodes that way (graded_spread); particles
!! read both nodes with 1/2, which is what is linear at a place somewhat off theirs
!! (graded_loads_off). On matter that flows centres hand forces to both nodes alike: what is missing
!! is the force of a stress at the centre, too (graded_loads_aside).
module DIM(sgmp_graded_loads)
  use sgmp_columns, only: twist_takes
  use sgmp_graded_axis, only: graded_spacing, graded_width
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_total
  implicit none
  private
  public :: graded_loads_aside, graded_loads_off, graded_loads_sides, graded_loads_slopes, &
            graded_loads_twist

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
  pure function graded_loads_off(mesh, motion) result(way)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp) :: way(lanes, NDIM), xi(lanes)
    integer :: d, c(lanes)
    do d = 1, NDIM
      c = below(motion(:, d))
      xi = motion(:, d) - (c + 0.5_dp)
      way(:, d) = (1.0_dp - xi)*middle_off(mesh, d, c) + xi*middle_off(mesh, d, c + 1)
    end do
  end function graded_loads_off

  !> Stresses at the centres below and above per force on a face and weight there, along each axis,
  !! as far as it is the normal (length): how far a centre is from the middle of its nodes.
  pure function graded_loads_aside(mesh, motion, way) result(aside)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(in) :: way(lanes, NDIM)       !! from the particle to its face (cells)
    real(dp) :: aside(lanes, NDIM, 2)
    real(dp) :: normal(lanes, NDIM), square(lanes)
    integer :: c(lanes), d, side
    normal = (graded_loads_sides(mesh, motion)*way)**2
    square = max(sum(normal, dim=2), tiny(1.0_dp))
    do d = 1, NDIM
      c = below(motion(:, d))
      do side = 1, 2
        aside(:, d, side) = -mesh%h*normal(:, d)/square*middle_off(mesh, d, c + side - 1)
      end do
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

  !> Product of the levers along the axes of a twist times the slopes, at one corner; forces push
  !! against second differences and along third ones (sgmp_surfaces).
  pure function graded_loads_twist(twist, corner, place, sides, slopes, aside) result(lever)
    integer, intent(in) :: twist, corner         !! bits: upper ends
    real(dp), intent(in) :: place(lanes, NDIM)   !! of the force, from the centre below (cells)
    real(dp), intent(in) :: sides(lanes, NDIM), slopes(lanes, NDIM, 2)
    real(dp), intent(in) :: aside(lanes, NDIM, 2)  !! graded_loads_aside (smallest cell)
    real(dp) :: lever(lanes)
    integer :: d, axes, side
    lever = 1.0_dp
    axes = 0
    do d = 1, NDIM
      if (.not. twist_takes(twist, d, NDIM)) cycle
      side = merge(2, 1, btest(corner, d - 1))
      lever = lever*slopes(:, d, side)* &
              (0.5_dp*sides(:, d)*place(:, d)*(1.0_dp - place(:, d)) + &
               merge(place(:, d)*aside(:, d, 2), (place(:, d) - 1.0_dp)*aside(:, d, 1), side == 2))
      axes = axes + 1
    end do
    if (axes == 2) lever = -lever
  end function graded_loads_twist

  !> The centre below a coordinate.
  elemental function below(x) result(c)
    real(dp), intent(in) :: x
    integer :: c
    c = floor(x - 0.5_dp)
  end function below

  !> How far a centre is from the middle of the nodes around it, (1/2 - low) h_c (smallest cell).
  elemental function middle_off(mesh, axis, c) result(way)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, c
    real(dp) :: way
    way = 0.25_dp*(graded_spacing(mesh%axes(axis), c) - graded_spacing(mesh%axes(axis), c + 1))
  end function middle_off

end module DIM(sgmp_graded_loads)
