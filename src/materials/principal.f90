!> Principal values and directions of a symmetric tensor by Jacobi's rotations, which are exact to
!! round-off also where values coincide.
module sgmp_principal
  use sgmp_kinds, only: dp
  use sgmp_voigt, only: voigt_axes
  implicit none
  private
  public :: principal_values, principal_dyad

  integer, parameter :: components = 6              !! of a tensor in space
  real(dp), parameter :: negligible = 1.0e-20_dp    !! of the largest component: no rotation
  integer, parameter :: most_sweeps = 12            !! convergence is quadratic: five do

contains

  !> Principal values, the largest first, and their directions axes(:, i).
  pure subroutine principal_values(tensor, values, axes)
    real(dp), intent(in) :: tensor(components)      !! in Voigt's order: xx yy zz xy yz xz
    real(dp), intent(out) :: values(3), axes(3, 3)
    real(dp) :: a(3, 3), small
    integer :: c, i, j, sweep
    logical :: turned
    axes = 0.0_dp
    do c = 1, components
      i = voigt_axes(1, c)
      j = voigt_axes(2, c)
      a(i, j) = tensor(c)
      a(j, i) = tensor(c)
      if (i == j) axes(i, i) = 1.0_dp
    end do
    small = negligible*maxval(abs(tensor))
    do sweep = 1, most_sweeps
      turned = .false.
      do c = 4, components
        i = voigt_axes(1, c)
        j = voigt_axes(2, c)
        if (.not. abs(a(i, j)) > small) cycle
        call rotate(i, j, a, axes)
        turned = .true.
      end do
      if (.not. turned) exit
    end do
    values = [a(1, 1), a(2, 2), a(3, 3)]
    call order(1, 2, values, axes)
    call order(2, 3, values, axes)
    call order(1, 2, values, axes)
  end subroutine principal_values

  !> Components of the sum of weights times the dyads of directions.
  pure function principal_dyad(weights, axes) result(tensor)
    real(dp), intent(in) :: weights(3), axes(3, 3)
    real(dp) :: tensor(components)
    tensor = matmul(axes(voigt_axes(1, :), :)*axes(voigt_axes(2, :), :), weights)
  end function principal_dyad

  !> Turns the axes i and j so that a_ij is 0 (Golub and Van Loan, 8.5.2).
  pure subroutine rotate(i, j, a, axes)
    integer, intent(in) :: i, j
    real(dp), intent(inout) :: a(3, 3), axes(3, 3)
    real(dp) :: ratio, tangent, c, s, old(3)
    ratio = (a(j, j) - a(i, i))/(2.0_dp*a(i, j))
    tangent = sign(1.0_dp, ratio)/(abs(ratio) + sqrt(1.0_dp + ratio**2))
    c = 1.0_dp/sqrt(1.0_dp + tangent**2)
    s = tangent*c
    old = a(:, i)
    a(:, i) = c*old - s*a(:, j)
    a(:, j) = s*old + c*a(:, j)
    old = a(i, :)
    a(i, :) = c*old - s*a(j, :)
    a(j, :) = s*old + c*a(j, :)
    a(i, j) = 0.0_dp
    a(j, i) = 0.0_dp
    old = axes(:, i)
    axes(:, i) = c*old - s*axes(:, j)
    axes(:, j) = s*old + c*axes(:, j)
  end subroutine rotate

  !> Exchanges two values where the second is larger.
  pure subroutine order(i, j, values, axes)
    integer, intent(in) :: i, j
    real(dp), intent(inout) :: values(3), axes(3, 3)
    if (values(i) >= values(j)) return
    values([i, j]) = values([j, i])
    axes(:, [i, j]) = axes(:, [j, i])
  end subroutine order

end module sgmp_principal
