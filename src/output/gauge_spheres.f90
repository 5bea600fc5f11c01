!> The spheres of gauges with a radius - those that stay where they are, or those that follow the
!! particles which are in them at the start -, and which of them hold a point.
module sgmp_gauge_spheres
  use sgmp_boxes, only: boxes_make, boxes_near, boxes_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: gauge_spheres_t, gauge_spheres_make, gauge_spheres_any, gauge_spheres_holding

  !> Some spheres, each with the number of its gauge.
  type :: gauge_spheres_t
    private
    integer :: ndim = 0                    !! axes that count
    integer, allocatable :: gauges(:)
    real(dp), allocatable :: centre(:, :)  !! (3, spheres)
    real(dp), allocatable :: radius2(:)    !! its square
    type(boxes_t) :: boxes
  end type gauge_spheres_t

contains

  !> The spheres of chosen gauges.
  pure subroutine gauge_spheres_make(spheres, chosen, centre, radius, ndim)
    type(gauge_spheres_t), intent(out) :: spheres
    logical, intent(in) :: chosen(:)       !! (gauges)
    real(dp), intent(in) :: centre(:, :)   !! (3, gauges)
    real(dp), intent(in) :: radius(:)      !! (gauges)
    integer, intent(in) :: ndim
    real(dp), allocatable :: reach(:, :)
    integer :: g, n
    spheres%ndim = ndim
    spheres%gauges = pack([(g, g=1, size(chosen))], chosen)
    n = size(spheres%gauges)
    spheres%centre = centre(:, spheres%gauges)
    spheres%centre(ndim + 1:, :) = 0.0_dp  ! where all particles are
    spheres%radius2 = radius(spheres%gauges)**2
    ! A bit more than the radius: round-off must not hide what is just inside.
    reach = spread((1.0_dp + 1.0e-9_dp)*radius(spheres%gauges), 1, 3) + &
            4.0_dp*spacing(abs(spheres%centre))
    call boxes_make(spheres%boxes, reshape(spheres%centre - reach, [3, n]), spheres%centre + reach)
  end subroutine gauge_spheres_make

  !> Whether a point is in some sphere, with so much to spare (part of the radius squared).
  pure logical function gauge_spheres_any(spheres, point, spare) result(yes)
    type(gauge_spheres_t), intent(in) :: spheres
    real(dp), intent(in) :: point(3), spare
    integer :: k, places(2)
    places = boxes_near(spheres%boxes, point)
    yes = .false.
    do k = places(1), places(2)
      associate (s => spheres%boxes%items(k))
        yes = distance2(spheres, s, point) <= (1.0_dp + spare)*spheres%radius2(s)
      end associate
      if (yes) return
    end do
  end function gauge_spheres_any

  !> Gauges whose spheres hold a point, behind those that `gauges` names already.
  pure subroutine gauge_spheres_holding(spheres, point, gauges, n)
    type(gauge_spheres_t), intent(in) :: spheres
    real(dp), intent(in) :: point(3)
    integer, intent(inout) :: gauges(:)    !! has room for all spheres
    integer, intent(inout) :: n            !! named so far
    integer :: k, places(2)
    places = boxes_near(spheres%boxes, point)
    do k = places(1), places(2)
      associate (s => spheres%boxes%items(k))
        if (distance2(spheres, s, point) > spheres%radius2(s)) cycle
        n = n + 1
        gauges(n) = spheres%gauges(s)
      end associate
    end do
  end subroutine gauge_spheres_holding

  pure real(dp) function distance2(spheres, s, point) result(square)
    type(gauge_spheres_t), intent(in) :: spheres
    integer, intent(in) :: s
    real(dp), intent(in) :: point(3)
    square = sum((point(:spheres%ndim) - spheres%centre(:spheres%ndim, s))**2)
  end function distance2

end module sgmp_gauge_spheres
