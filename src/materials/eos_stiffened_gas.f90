!> Stiffened gas (Harlow and Amsden 1971; Menikoff and Plohr 1989), of which the ideal gas is the
!! case p_inf = 0 (theory 4):
!!
!!     p = (gamma - 1) E/v + gamma p_inf (1/v - 1)                                      (S1)
!!
!! with v = V/V0 and E the energy per initial volume, counted from the state p = 0, v = 1: it is
!! e = (p + gamma p_inf) v/(gamma - 1) less the constant gamma p_inf/(gamma - 1). Isentropes are
!! (p + p_inf) v^gamma = const, so that rho c^2 = gamma (p + p_inf).
module sgmp_eos_stiffened_gas
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: ideal_gas_keys, stiffened_gas_keys, stiffened_gas_read
  public :: stiffened_gas_t, stiffened_gas_init, stiffened_gas_terms, stiffened_gas_lanes

  !> Constants of (S1).
  type :: stiffened_gas_t
    real(dp) :: gamma = 1.4_dp      !! ratio of specific heats
    real(dp) :: stiffness = 0.0_dp  !! p_inf (stress)
  end type stiffened_gas_t

contains

  !> Keys of the ideal gas.
  function ideal_gas_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('gamma', kind_real, 'ratio of specific heats: p = (gamma - 1) E/V + '// &
                'gamma p_inf (1/V - 1)', range='(1,inf)', required=.true.)]
  end function ideal_gas_keys

  !> Keys of the stiffened gas.
  function stiffened_gas_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [ideal_gas_keys(), &
            key('p_inf', kind_real, 'pressure that stiffens the gas', unit='stress', &
                range='[0,inf)', required=.true.)]
  end function stiffened_gas_keys

  !> Equation from the values of its keys; an ideal gas has no p_inf.
  pure function stiffened_gas_read(values) result(law)
    class(values_t), intent(in) :: values
    type(stiffened_gas_t) :: law
    law = stiffened_gas_init(values%number('gamma'), values%number('p_inf'))
  end function stiffened_gas_read

  !> Constants from plain numbers.
  pure function stiffened_gas_init(gamma, stiffness) result(law)
    real(dp), intent(in) :: gamma      !! ratio of specific heats, > 1
    real(dp), intent(in) :: stiffness  !! p_inf >= 0 (stress)
    type(stiffened_gas_t) :: law
    law%gamma = gamma
    law%stiffness = stiffness
  end function stiffened_gas_init

  !> Terms of p = a0 + b0 E and their derivatives with respect to v; v <= 0 (an empty lane) is taken
  !! as 1.
  pure subroutine stiffened_gas_terms(law, v, a0, b0, da, db)
    type(stiffened_gas_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v     !! volume over initial volume
    real(dp), intent(out) :: a0   !! pressure at E = 0 (stress)
    real(dp), intent(out) :: b0   !! dp/dE
    real(dp), intent(out) :: da   !! d(a0)/dv (stress)
    real(dp), intent(out) :: db   !! d(b0)/dv
    real(dp) :: inverse, bulk
    inverse = 1.0_dp/merge(v, 1.0_dp, v > 0.0_dp)
    bulk = law%gamma*law%stiffness
    a0 = bulk*(inverse - 1.0_dp)
    da = -bulk*inverse*inverse
    b0 = (law%gamma - 1.0_dp)*inverse
    db = -b0*inverse
  end subroutine stiffened_gas_terms

  !> Lane kernel of stiffened_gas_terms.
  pure subroutine stiffened_gas_lanes(law, v, a0, b0, da, db)
    type(stiffened_gas_t), intent(in) :: law                             !! constants
    real(dp), intent(in) :: v(lanes)                                     !! as in the point function
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)  !! as in the point function
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      call stiffened_gas_terms(law, v(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine stiffened_gas_lanes

end module sgmp_eos_stiffened_gas
