!> Rotation of a body about z through a pivot, as its card places it.
module sgmp_turn
  use sgmp_kinds, only: dp, pi
  use sgmp_shapes, only: infinite_length
  implicit none
  private
  public :: turn_t, turn_back, turn_box, turn_forth

  !> A rotation.
  type :: turn_t
    real(dp) :: degrees = 0.0_dp
    real(dp) :: pivot(3) = 0.0_dp
  end type turn_t

contains

  !> Takes a point with the body.
  pure subroutine turn_forth(turn, point)
    type(turn_t), intent(in) :: turn
    real(dp), intent(inout) :: point(3)
    call rotate(turn%degrees, turn%pivot, point)
  end subroutine turn_forth

  !> Takes a point back to where it was before the body was turned.
  pure subroutine turn_back(turn, point)
    type(turn_t), intent(in) :: turn
    real(dp), intent(inout) :: point(3)
    call rotate(-turn%degrees, turn%pivot, point)
  end subroutine turn_back

  pure subroutine rotate(degrees, pivot, point)
    real(dp), intent(in) :: degrees, pivot(3)
    real(dp), intent(inout) :: point(3)
    real(dp) :: c, s, x, y
    if (abs(degrees) <= 0.0_dp) return
    c = cos(degrees*pi/180.0_dp)
    s = sin(degrees*pi/180.0_dp)
    x = point(1) - pivot(1)
    y = point(2) - pivot(2)
    point(1) = pivot(1) + c*x - s*y
    point(2) = pivot(2) + s*x + c*y
  end subroutine rotate

  !> The box around a turned box.
  pure subroutine turn_box(turn, lower, upper)
    type(turn_t), intent(in) :: turn
    real(dp), intent(inout) :: lower(3), upper(3)
    real(dp) :: corners(3, 4)
    integer :: c
    if (abs(turn%degrees) <= 0.0_dp) return
    if (any(abs([lower(1:2), upper(1:2)]) > infinite_length)) return
    corners(:, 1) = lower
    corners(:, 2) = upper
    corners(:, 3) = [lower(1), upper(2), lower(3)]
    corners(:, 4) = [upper(1), lower(2), lower(3)]
    do c = 1, size(corners, 2)
      call turn_forth(turn, corners(:, c))
    end do
    lower(1:2) = minval(corners(1:2, :), dim=2)
    upper(1:2) = maxval(corners(1:2, :), dim=2)
  end subroutine turn_box

end module sgmp_turn
