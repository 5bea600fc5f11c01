!> Mie-Grueneisen equation of state with a linear shock velocity Us = c0 + s up (theory 4),
!! mu = 1/v - 1:
!!
!!     compression  p = (C1 mu + C2 mu^2 + C3 mu^3) (1 - gamma0 (1 - v)/2) + gamma0 E  (G1)
!!     expansion    p = C1 mu + gamma0 E                                               (G2)
!!                  p = C1 mu, with expansion=cold                                     (G2c)
!!     C1 = rho0 c0^2,  C2 = C1 (2 s - 1),  C3 = C1 (s - 1)(3 s - 1)
!!
!! with v = V/V0 and E the energy per initial volume. 1 - v = rho0 mu/rho, so that the bracket in
!! (G1) is exactly what puts the Hugoniot E = p (1 - v)/2 on the cubic; the cubic is
!! rho0 c0^2 eta/(1 - s eta)^2, eta = 1 - v, up to an error of order mu^4.
module sgmp_eos_gruneisen
  use sgmp_keys, only: key, key_t, kind_real, kind_word, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: gruneisen_keys, gruneisen_read
  public :: gruneisen_t, gruneisen_init, gruneisen_terms, gruneisen_lanes
  public :: gruneisen_hugoniot_pressure

  !> Constants of (G1), (G2).
  type :: gruneisen_t
    real(dp) :: c1 = 0.0_dp     !! C1 (stress)
    real(dp) :: c2 = 0.0_dp     !! C2 (stress)
    real(dp) :: c3 = 0.0_dp     !! C3 (stress)
    real(dp) :: gamma0 = 0.0_dp  !! Grueneisen's parameter, gamma rho constant
    real(dp) :: gamma_expanded = 0.0_dp  !! the same in expansion: gamma0, or 0 in (G2c)
  end type gruneisen_t

contains

  !> Keys of the equation.
  function gruneisen_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('c0', kind_real, 'bulk sound speed', unit='speed', range='(0,inf)', &
                required=.true.), &
            key('s', kind_real, &
                'slope of the shock speed over the particle speed, Us = c0 + s up', &
                range='[0,inf)', required=.true.), &
            key('gamma0', kind_real, 'Grueneisen coefficient', range='[0,inf)', required=.true.), &
            key('expansion', kind_word, 'pressure below the initial density: thermal counts '// &
                'the energy, cold does not, so that the pressure of hot matter jumps there', &
                choices='thermal cold', default='thermal')]
  end function gruneisen_keys

  !> Equation from the values of its keys.
  pure function gruneisen_read(density, values) result(law)
    real(dp), intent(in) :: density     !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(gruneisen_t) :: law
    law = gruneisen_init(density, values%number('c0'), values%number('s'), values%number('gamma0'))
    if (values%word('expansion') == 'cold') law%gamma_expanded = 0.0_dp
  end function gruneisen_read

  !> Constants from initial density, sound speed, slope of the shock velocity, and Grueneisen's
  !! parameter.
  pure function gruneisen_init(density0, c0, s, gamma0) result(law)
    real(dp), intent(in) :: density0  !! initial density (mass/volume)
    real(dp), intent(in) :: c0       !! bulk sound speed
    real(dp), intent(in) :: s        !! slope of Us(up)
    real(dp), intent(in) :: gamma0   !! Grueneisen's parameter
    type(gruneisen_t) :: law
    law%c1 = density0*c0**2
    law%c2 = law%c1*(2.0_dp*s - 1.0_dp)
    law%c3 = law%c1*(s - 1.0_dp)*(3.0_dp*s - 1.0_dp)
    law%gamma0 = gamma0
    law%gamma_expanded = gamma0
  end function gruneisen_init

  !> Terms of p = a0 + b0 E and their derivatives with respect to v; v <= 0 (an empty lane) is taken
  !! as 1.
  pure subroutine gruneisen_terms(law, v, a0, b0, da, db)
    type(gruneisen_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v            !! volume over initial volume
    real(dp), intent(out) :: a0          !! pressure at E = 0 (stress)
    real(dp), intent(out) :: b0          !! dp/dE
    real(dp), intent(out) :: da          !! d(a0)/dv (stress)
    real(dp), intent(out) :: db          !! d(b0)/dv
    real(dp) :: volume, inverse, mu, dense, cubic, slope, bracket, half
    volume = merge(v, 1.0_dp, v > 0.0_dp)
    inverse = 1.0_dp/volume
    mu = inverse - 1.0_dp
    dense = merge(1.0_dp, 0.0_dp, mu > 0.0_dp)  ! switches off what only compression has
    cubic = mu*(law%c1 + dense*mu*(law%c2 + mu*law%c3))
    slope = law%c1 + dense*mu*(2.0_dp*law%c2 + 3.0_dp*mu*law%c3)
    half = 0.5_dp*dense*law%gamma0
    bracket = 1.0_dp - half*(1.0_dp - volume)
    a0 = cubic*bracket
    da = cubic*half - slope*bracket*(inverse*inverse)
    b0 = merge(law%gamma0, law%gamma_expanded, mu > 0.0_dp)
    db = 0.0_dp
  end subroutine gruneisen_terms

  !> Lane kernel of gruneisen_terms.
  pure subroutine gruneisen_lanes(law, v, a0, b0, da, db)
    type(gruneisen_t), intent(in) :: law                                  !! constants
    real(dp), intent(in) :: v(lanes)                                      !! as in gruneisen_terms
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)   !! as in gruneisen_terms
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      call gruneisen_terms(law, v(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine gruneisen_lanes

  !> Pressure on the Hugoniot from (v = 1, E = 0): E = p (1 - v)/2 (stress).
  pure function gruneisen_hugoniot_pressure(law, v) result(pressure)
    type(gruneisen_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v            !! volume over initial volume, < 1
    real(dp) :: pressure
    real(dp) :: a0, b0, da, db
    call gruneisen_terms(law, v, a0, b0, da, db)
    pressure = a0/(1.0_dp - 0.5_dp*b0*(1.0_dp - v))
  end function gruneisen_hugoniot_pressure

end module sgmp_eos_gruneisen
