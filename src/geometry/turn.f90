!> Rotation about an axis through a point: of a body with its lattice, or of one of its shapes.
module sgmp_turn
  use sgmp_kinds, only: dp, pi
  implicit none
  private
  public :: turn_same
  public :: turn_t, turn_back, turn_box, turn_direction, turn_forth, turn_inverse, turn_make, &
            turn_moved, turn_turns
  public :: infinite_length

  real(dp), parameter :: infinite_length = 0.1_dp*huge(1.0_dp)  !! whatever is longer has no end

  !> A rotation; none by default.
  type :: turn_t
    private
    logical :: turns = .false.
    real(dp) :: matrix(3, 3) = 0.0_dp
    real(dp) :: pivot(3) = 0.0_dp
  end type turn_t

contains

  !> Whether two turns are the same.
  pure function turn_same(a, b) result(same)
    type(turn_t), intent(in) :: a, b
    logical :: same
    real(dp), parameter :: nearly = 1.0e-12_dp
    same = a%turns .eqv. b%turns
    if (.not. (same .and. a%turns)) return
    same = all(abs(a%matrix - b%matrix) <= nearly) .and. &
           all(abs(a%pivot - b%pivot) <= nearly*max(1.0_dp, maxval(abs(a%pivot))))
  end function turn_same

  !> Rotation by an angle about an axis through a pivot (Rodrigues).
  pure function turn_make(degrees, axis, pivot) result(turn)
    real(dp), intent(in) :: degrees   !! right-handed about the axis
    real(dp), intent(in) :: axis(3)   !! not zero, of any length
    real(dp), intent(in) :: pivot(3)
    type(turn_t) :: turn
    real(dp) :: n(3), c, s, along(3, 3)
    integer :: i
    turn%pivot = pivot
    turn%turns = abs(degrees) > 0.0_dp
    if (.not. turn%turns) return
    n = axis/norm2(axis)
    c = cos(degrees*pi/180.0_dp)
    s = sin(degrees*pi/180.0_dp)
    along = spread(n, 2, 3)*spread(n, 1, 3)
    turn%matrix = (1.0_dp - c)*along
    do i = 1, 3
      turn%matrix(i, i) = along(i, i) + c*(1.0_dp - along(i, i))  ! exact where it is 0 or 1
    end do
    turn%matrix = turn%matrix + s*reshape([0.0_dp, n(3), -n(2), -n(3), 0.0_dp, n(1), n(2), -n(1), &
                                           0.0_dp], [3, 3])
  end function turn_make

  !> Whether it turns anything.
  elemental function turn_turns(turn) result(yes)
    type(turn_t), intent(in) :: turn
    logical :: yes
    yes = turn%turns
  end function turn_turns

  !> The rotation back.
  pure function turn_inverse(turn) result(back)
    type(turn_t), intent(in) :: turn
    type(turn_t) :: back
    back = turn
    back%matrix = transpose(turn%matrix)
  end function turn_inverse

  !> The same rotation about a pivot that has moved.
  pure function turn_moved(turn, by) result(moved)
    type(turn_t), intent(in) :: turn
    real(dp), intent(in) :: by(3)
    type(turn_t) :: moved
    moved = turn
    moved%pivot = turn%pivot + by
  end function turn_moved

  !> Takes a point with the body.
  pure subroutine turn_forth(turn, point)
    type(turn_t), intent(in) :: turn
    real(dp), intent(inout) :: point(3)
    if (turn%turns) call rotate(turn%matrix, turn%pivot, point)
  end subroutine turn_forth

  !> Takes a point back to where it was before the body was turned.
  pure subroutine turn_back(turn, point)
    type(turn_t), intent(in) :: turn
    real(dp), intent(inout) :: point(3)
    if (turn%turns) call rotate(transpose(turn%matrix), turn%pivot, point)
  end subroutine turn_back

  !> A direction as the body takes it along.
  pure function turn_direction(turn, direction) result(turned)
    type(turn_t), intent(in) :: turn
    real(dp), intent(in) :: direction(3)
    real(dp) :: turned(3)
    turned = direction
    if (turn%turns) turned = matmul(turn%matrix, direction)
  end function turn_direction

  pure subroutine rotate(matrix, pivot, point)
    real(dp), intent(in) :: matrix(3, 3), pivot(3)
    real(dp), intent(inout) :: point(3)
    real(dp) :: from(3)
    integer :: j
    from = point - pivot
    point = pivot
    do j = 1, 3
      point = point + matrix(:, j)*from(j)
    end do
  end subroutine rotate

  !> The box around a turned box.
  pure subroutine turn_box(turn, lower, upper)
    type(turn_t), intent(in) :: turn
    real(dp), intent(inout) :: lower(3), upper(3)
    real(dp) :: ends(3, 2), low, high
    integer :: i, j
    if (.not. turn%turns) return
    ends(:, 1) = lower - turn%pivot
    ends(:, 2) = upper - turn%pivot
    do i = 1, 3
      low = 0.0_dp
      high = 0.0_dp
      do j = 1, 3
        if (abs(turn%matrix(i, j)) <= 0.0_dp) cycle
        if (any(abs(ends(j, :)) > infinite_length)) exit
        low = low + minval(turn%matrix(i, j)*ends(j, :))
        high = high + maxval(turn%matrix(i, j)*ends(j, :))
      end do
      lower(i) = merge(turn%pivot(i) + low, -huge(1.0_dp), j > 3)
      upper(i) = merge(turn%pivot(i) + high, huge(1.0_dp), j > 3)
    end do
  end subroutine turn_box

end module sgmp_turn
