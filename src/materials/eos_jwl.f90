!> Jones-Wilkins-Lee equation of state of detonation products (theory 4):
!!
!!     p = A (1 - w/(R1 v)) exp(-R1 v) + B (1 - w/(R2 v)) exp(-R2 v) + w E/v           (W1)
!!
!! with v = V/V0 and E the energy per initial volume, in the form p = a0(v) + b0(v) E that sgmp_eos
!! solves.
module sgmp_eos_jwl
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: jwl_keys, jwl_read
  public :: jwl_t, jwl_init, jwl_terms, jwl_lanes, jwl_hugoniot_pressure, jwl_chapman_jouguet

  !> Constants of (W1).
  type :: jwl_t
    real(dp) :: a = 0.0_dp     !! A (stress)
    real(dp) :: b = 0.0_dp     !! B (stress)
    real(dp) :: r1 = 0.0_dp    !! R1
    real(dp) :: r2 = 0.0_dp    !! R2
    real(dp) :: omega = 0.0_dp  !! w
  end type jwl_t

contains

  !> Keys of the equation.
  function jwl_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('a', kind_real, 'A of p = A (1 - omega/(R1 V)) exp(-R1 V) + '// &
                'B (1 - omega/(R2 V)) exp(-R2 V) + omega E/V, V: volume, E: energy, both per '// &
                'initial volume', unit='stress', required=.true.), &
            key('b', kind_real, 'B', unit='stress', required=.true.), &
            key('r1', kind_real, 'R1', range='(0,inf)', required=.true.), &
            key('r2', kind_real, 'R2', range='(0,inf)', required=.true.), &
            key('omega', kind_real, 'omega', range='(0,inf)', required=.true.)]
  end function jwl_keys

  !> Equation from the values of its keys.
  pure function jwl_read(values) result(law)
    class(values_t), intent(in) :: values
    type(jwl_t) :: law
    law = jwl_init(values%number('a'), values%number('b'), values%number('r1'), &
                   values%number('r2'), values%number('omega'))
  end function jwl_read

  !> Constants from plain numbers; r1, r2 > 0.
  pure function jwl_init(a, b, r1, r2, omega) result(law)
    real(dp), intent(in) :: a, b, r1, r2, omega  !! as in (W1)
    type(jwl_t) :: law
    law%a = a
    law%b = b
    law%r1 = r1
    law%r2 = r2
    law%omega = omega
  end function jwl_init

  !> Terms of p = a0 + b0 E and their derivatives with respect to v; v <= 0 (an empty lane) is taken
  !! as 1.
  pure subroutine jwl_terms(law, v, a0, b0, da, db)
    type(jwl_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v      !! volume over initial volume
    real(dp), intent(out) :: a0    !! pressure at E = 0 (stress)
    real(dp), intent(out) :: b0    !! dp/dE
    real(dp), intent(out) :: da    !! d(a0)/dv (stress)
    real(dp), intent(out) :: db    !! d(b0)/dv
    real(dp) :: volume, inverse, first, second
    volume = merge(v, 1.0_dp, v > 0.0_dp)
    inverse = 1.0_dp/volume
    b0 = law%omega*inverse
    db = -b0*inverse
    first = law%a*exp(-law%r1*volume)
    second = law%b*exp(-law%r2*volume)
    a0 = first*(1.0_dp - b0/law%r1) + second*(1.0_dp - b0/law%r2)
    da = first*(b0 - law%r1 - db/law%r1) + second*(b0 - law%r2 - db/law%r2)
  end subroutine jwl_terms

  !> Lane kernel of jwl_terms.
  pure subroutine jwl_lanes(law, v, a0, b0, da, db)
    type(jwl_t), intent(in) :: law                                        !! constants
    real(dp), intent(in) :: v(lanes)                                      !! as in jwl_terms
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)   !! as in jwl_terms
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      call jwl_terms(law, v(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine jwl_lanes

  !> Pressure on the detonation Hugoniot E = energy0 + p (1 - v)/2 (stress).
  pure function jwl_hugoniot_pressure(law, energy0, v) result(pressure)
    type(jwl_t), intent(in) :: law     !! constants
    real(dp), intent(in) :: energy0    !! energy of the unburnt explosive per initial volume
    real(dp), intent(in) :: v          !! volume over initial volume
    real(dp) :: pressure
    real(dp) :: a0, b0, da, db
    call jwl_terms(law, v, a0, b0, da, db)
    pressure = (a0 + b0*energy0)/(1.0_dp - 0.5_dp*b0*(1.0_dp - v))
  end function jwl_hugoniot_pressure

  !> Chapman-Jouguet state: where the isentrope touches the Rayleigh line, dp/dv|_s = -p/(1 - v); by
  !! bisection.
  pure subroutine jwl_chapman_jouguet(law, density0, energy0, v, pressure, speed, particle_speed)
    type(jwl_t), intent(in) :: law             !! constants
    real(dp), intent(in) :: density0           !! density of the unburnt explosive
    real(dp), intent(in) :: energy0            !! its energy per initial volume
    real(dp), intent(out) :: v                 !! volume over initial volume, sought in [0.5, 0.999]
    real(dp), intent(out) :: pressure          !! p_CJ (stress)
    real(dp), intent(out) :: speed             !! D_CJ
    real(dp), intent(out) :: particle_speed    !! u_CJ
    real(dp) :: lower, upper, energy, a0, b0, da, db
    integer :: k
    lower = 0.5_dp
    upper = 0.999_dp
    do k = 1, 60
      v = 0.5_dp*(lower + upper)
      pressure = jwl_hugoniot_pressure(law, energy0, v)
      energy = energy0 + 0.5_dp*pressure*(1.0_dp - v)
      call jwl_terms(law, v, a0, b0, da, db)
      if (da + db*energy - b0*pressure + pressure/(1.0_dp - v) < 0.0_dp) then
        lower = v
      else
        upper = v
      end if
    end do
    speed = sqrt(pressure/(density0*(1.0_dp - v)))
    particle_speed = speed*(1.0_dp - v)
  end subroutine jwl_chapman_jouguet

end module sgmp_eos_jwl
