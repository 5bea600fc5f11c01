!> Tait's equation in Murnaghan's form for weakly compressible liquids (Cole 1948; theory 4):
!!
!!     p = p0 + (rho0 c0^2/n) (v^-n - 1)                                                (T1)
!!
!! with v = V/V0. The pressure does not depend on the energy. In tension it falls to
!! p0 - rho0 c0^2/n as v grows: a liquid that may tear needs `failure … pmin`.
module sgmp_eos_tait
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: tait_keys, tait_read
  public :: tait_t, tait_init, tait_terms, tait_lanes

  !> Constants of (T1).
  type :: tait_t
    real(dp) :: base = 0.0_dp      !! p0, the pressure at v = 1 (stress)
    real(dp) :: bulk = 0.0_dp      !! rho0 c0^2 (stress)
    real(dp) :: exponent = 7.0_dp  !! n
  end type tait_t

contains

  !> Keys of the equation.
  function tait_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('c0', kind_real, 'sound speed at the initial density', unit='speed', &
                range='(0,inf)', required=.true.), &
            key('exponent', kind_real, 'n of p = density c0^2/n (V^-n - 1); 7 for water', &
                range='[1,inf)', default='7')]
  end function tait_keys

  !> Equation from the values of its keys.
  pure function tait_read(density, values) result(law)
    real(dp), intent(in) :: density     !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(tait_t) :: law
    law = tait_init(density, values%number('c0'), values%number('exponent'), &
                    values%number('pressure0'))
  end function tait_read

  !> Constants from plain numbers.
  pure function tait_init(density0, c0, exponent, base) result(law)
    real(dp), intent(in) :: density0  !! initial density (mass/volume)
    real(dp), intent(in) :: c0        !! sound speed at that density
    real(dp), intent(in) :: exponent  !! n >= 1
    real(dp), intent(in) :: base      !! pressure at that density (stress)
    type(tait_t) :: law
    law%base = base
    law%bulk = density0*c0**2
    law%exponent = exponent
  end function tait_init

  !> Terms of p = a0 + b0 E and their derivatives with respect to v; v <= 0 (an empty lane) is taken
  !! as 1.
  pure subroutine tait_terms(law, v, a0, b0, da, db)
    type(tait_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v     !! volume over initial volume
    real(dp), intent(out) :: a0   !! pressure at E = 0 (stress)
    real(dp), intent(out) :: b0   !! dp/dE
    real(dp), intent(out) :: da   !! d(a0)/dv (stress)
    real(dp), intent(out) :: db   !! d(b0)/dv
    real(dp) :: volume, power
    volume = merge(v, 1.0_dp, v > 0.0_dp)
    power = exp(-law%exponent*log(volume))
    a0 = law%base + law%bulk/law%exponent*(power - 1.0_dp)
    da = -law%bulk*power/volume
    b0 = 0.0_dp
    db = 0.0_dp
  end subroutine tait_terms

  !> Lane kernel of tait_terms.
  pure subroutine tait_lanes(law, v, a0, b0, da, db)
    type(tait_t), intent(in) :: law                                      !! constants
    real(dp), intent(in) :: v(lanes)                                     !! as in the point function
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)  !! as in the point function
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      call tait_terms(law, v(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine tait_lanes

end module sgmp_eos_tait
