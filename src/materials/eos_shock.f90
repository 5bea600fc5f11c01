!> Mie-Grueneisen equation of state on the measured Hugoniot (Steinberg 1996; theory 4),
!! eta = 1 - v:
!!
!!     Us = c0 + s up + s2 (up/Us) up + s3 (up/Us)^2 up
!!     compression  p = pH (1 - gamma0 eta/2) + gamma0 E,  pH = rho0 c0^2 eta/D^2       (H1)
!!                  D = 1 - s eta - s2 eta^2 - s3 eta^3
!!     expansion    p = rho0 c0^2 mu + gamma0 E,  mu = 1/v - 1                          (H2)
!!
!! with v = V/V0 and E the energy per initial volume. A shock from v = 1, E = 0 has eta = up/Us, so
!! that pH = rho0 Us up exactly; `gruneisen` is the series of (H1) to mu^3. D ends at `least`, where
!! no shock gets: beyond it the matter stiffens no more.
module sgmp_eos_shock
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: shock_keys, shock_read
  public :: shock_t, shock_init, shock_terms, shock_lanes

  real(dp), parameter :: least = 0.1_dp  !! of D

  !> Constants of (H1), (H2).
  type :: shock_t
    real(dp) :: bulk = 0.0_dp                !! rho0 c0^2 (stress)
    real(dp) :: s = 0.0_dp, s2 = 0.0_dp, s3 = 0.0_dp
    real(dp) :: gamma0 = 0.0_dp              !! Grueneisen's parameter, gamma rho constant
  end type shock_t

contains

  !> Keys of the equation.
  function shock_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('c0', kind_real, 'bulk sound speed', unit='speed', range='(0,inf)', &
                required=.true.), &
            key('s', kind_real, &
                'slope of the shock speed over the particle speed, Us = c0 + s up', &
                range='[0,inf)', required=.true.), &
            key('gamma0', kind_real, 'Grueneisen coefficient', range='[0,inf)', required=.true.), &
            key('s2', kind_real, 'coefficient of (up/Us) up in the shock speed', default='0'), &
            key('s3', kind_real, 'coefficient of (up/Us)^2 up in the shock speed', default='0')]
  end function shock_keys

  !> Equation from the values of its keys.
  pure function shock_read(density, values) result(law)
    real(dp), intent(in) :: density     !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(shock_t) :: law
    law = shock_init(density, values%number('c0'), [values%number('s'), values%number('s2'), &
                                                    values%number('s3')], values%number('gamma0'))
  end function shock_read

  !> Constants from plain numbers.
  pure function shock_init(density0, c0, s, gamma0) result(law)
    real(dp), intent(in) :: density0  !! initial density (mass/volume)
    real(dp), intent(in) :: c0        !! bulk sound speed
    real(dp), intent(in) :: s(3)      !! s, s2, s3
    real(dp), intent(in) :: gamma0    !! Grueneisen's parameter
    type(shock_t) :: law
    law%bulk = density0*c0**2
    law%s = s(1)
    law%s2 = s(2)
    law%s3 = s(3)
    law%gamma0 = gamma0
  end function shock_init

  !> Terms of p = a0 + b0 E and their derivatives with respect to v; v <= 0 (an empty lane) is taken
  !! as 1.
  pure subroutine shock_terms(law, v, a0, b0, da, db)
    type(shock_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v     !! volume over initial volume
    real(dp), intent(out) :: a0   !! pressure at E = 0 (stress)
    real(dp), intent(out) :: b0   !! dp/dE
    real(dp), intent(out) :: da   !! d(a0)/dv (stress)
    real(dp), intent(out) :: db   !! d(b0)/dv
    real(dp) :: volume, inverse, eta, d, d_eta, hugoniot, slope, bracket, half
    volume = merge(v, 1.0_dp, v > 0.0_dp)
    inverse = 1.0_dp/volume
    eta = merge(1.0_dp - volume, 0.0_dp, volume < 1.0_dp)
    d = 1.0_dp - eta*(law%s + eta*(law%s2 + eta*law%s3))
    d_eta = merge(-(law%s + eta*(2.0_dp*law%s2 + 3.0_dp*eta*law%s3)), 0.0_dp, d > least)
    d = merge(d, least, d > least)
    hugoniot = law%bulk*eta/(d*d)
    slope = law%bulk*(d - 2.0_dp*eta*d_eta)/(d*d*d)
    half = 0.5_dp*law%gamma0
    bracket = 1.0_dp - half*eta
    a0 = merge(hugoniot*bracket, law%bulk*(inverse - 1.0_dp), volume < 1.0_dp)
    da = merge(hugoniot*half - slope*bracket, -law%bulk*inverse*inverse, volume < 1.0_dp)
    b0 = law%gamma0
    db = 0.0_dp
  end subroutine shock_terms

  !> Lane kernel of shock_terms.
  pure subroutine shock_lanes(law, v, a0, b0, da, db)
    type(shock_t), intent(in) :: law                                     !! constants
    real(dp), intent(in) :: v(lanes)                                     !! as in the point function
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)  !! as in the point function
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      call shock_terms(law, v(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine shock_lanes

end module sgmp_eos_shock
