!> Linear polynomial equation of state, linear in the energy (Woodruff 1973; theory 4),
!! mu = 1/v - 1:
!!
!!     p = A0 + A1 mu + A2 mu^2 + A3 mu^3 + (B0 + B1 mu + B2 mu^2) E                    (P1)
!!
!! with v = V/V0 and E the energy per initial volume. A2 and B2 act in compression only, where
!! mu > 0. LS-DYNA calls the coefficients C0..C6.
module sgmp_eos_polynomial
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: polynomial_keys, polynomial_read
  public :: polynomial_t, polynomial_init, polynomial_terms, polynomial_lanes

  integer, parameter :: last = 6  !! coefficient of mu^2 E, from 0
  character(2), parameter :: names(0:last) = ['a0', 'a1', 'a2', 'a3', 'b0', 'b1', 'b2']

  !> Constants of (P1).
  type :: polynomial_t
    real(dp) :: c(0:last) = 0.0_dp  !! A0..A3 (stress), B0..B2
  end type polynomial_t

contains

  !> Keys of the equation.
  function polynomial_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    integer :: i
    keys = [key(names(0), kind_real, 'A0 of p = A0 + A1 mu + A2 mu^2 + A3 mu^3 + (B0 + B1 mu + '// &
                'B2 mu^2) E, mu: density over the initial one - 1, positive in compression, '// &
                'E: energy per initial volume; A2 and B2 act where mu > 0', unit='stress', &
                default='0')]
    do i = 1, 3
      keys = [keys, key(names(i), kind_real, 'A'//names(i)(2:), unit='stress', &
                        default='0')]
    end do
    do i = 4, last
      keys = [keys, key(names(i), kind_real, 'B'//names(i)(2:), &
                        default='0')]
    end do
  end function polynomial_keys

  !> Equation from the values of its keys.
  pure function polynomial_read(values) result(law)
    class(values_t), intent(in) :: values
    type(polynomial_t) :: law
    integer :: i
    law = polynomial_init([(values%number(names(i)), i=0, last)])
  end function polynomial_read

  !> Constants from plain numbers.
  pure function polynomial_init(c) result(law)
    real(dp), intent(in) :: c(0:last)  !! A0..A3 (stress), B0..B2
    type(polynomial_t) :: law
    law%c = c
  end function polynomial_init

  !> Terms of p = a0 + b0 E and their derivatives with respect to v; v <= 0 (an empty lane) is taken
  !! as 1.
  pure subroutine polynomial_terms(law, v, a0, b0, da, db)
    type(polynomial_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v     !! volume over initial volume
    real(dp), intent(out) :: a0   !! pressure at E = 0 (stress)
    real(dp), intent(out) :: b0   !! dp/dE
    real(dp), intent(out) :: da   !! d(a0)/dv (stress)
    real(dp), intent(out) :: db   !! d(b0)/dv
    real(dp) :: inverse, mu, dense, slope
    inverse = 1.0_dp/merge(v, 1.0_dp, v > 0.0_dp)
    mu = inverse - 1.0_dp
    dense = merge(mu, 0.0_dp, mu > 0.0_dp)
    slope = -inverse*inverse  ! d(mu)/dv
    associate (c => law%c)
      a0 = c(0) + mu*(c(1) + mu*mu*c(3)) + c(2)*dense*dense
      b0 = c(4) + mu*c(5) + c(6)*dense*dense
      da = slope*(c(1) + 3.0_dp*mu*mu*c(3) + 2.0_dp*c(2)*dense)
      db = slope*(c(5) + 2.0_dp*c(6)*dense)
    end associate
  end subroutine polynomial_terms

  !> Lane kernel of polynomial_terms.
  pure subroutine polynomial_lanes(law, v, a0, b0, da, db)
    type(polynomial_t), intent(in) :: law                                !! constants
    real(dp), intent(in) :: v(lanes)                                     !! as in the point function
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)  !! as in the point function
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      call polynomial_terms(law, v(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine polynomial_lanes

end module sgmp_eos_polynomial
