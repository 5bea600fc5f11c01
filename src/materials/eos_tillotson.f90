!> Tillotson's equation of state for metals and rocks that melt and evaporate (Tillotson 1962,
!! General Atomic GA-3216; in this form Melosh 1989, Impact Cratering, appendix II; theory 4).
!!
!! With v = V/V0, E the energy per initial volume, mu = 1/v - 1 and w = 1 + E v^2/E0,
!!
!!     dense or cold    p_c = (a + b/w) E/v + A mu + B mu^2                             (TI1)
!!     expanded, hot    p_e = a E/v + (b E/(v w) + A mu exp(-beta (v - 1))) exp(-alpha (v - 1)^2)
!!                                                                                      (TI2)
!!     in between       p = p_c + s (p_e - p_c),  s = (E - E_iv)/(E_cv - E_iv)          (TI3)
!!
!! (TI1) holds for v <= 1 and for E <= E_iv, where evaporation begins; (TI2) for v > 1 and
!! E >= E_cv, where it is complete. The pressure is continuous everywhere. It is not linear in E:
!! the terms a0, b0 are those of its tangent at the energy given, p = a0 + b0 E there. Below E = 0
!! w stays 1.
module sgmp_eos_tillotson
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: tillotson_check, tillotson_keys, tillotson_read
  public :: tillotson_t, tillotson_init, tillotson_terms, tillotson_lanes

  !> Constants of (TI1) to (TI3), energies per initial volume.
  type :: tillotson_t
    real(dp) :: a = 0.0_dp, b = 0.0_dp                  !! 1
    real(dp) :: bulk = 0.0_dp, bulk2 = 0.0_dp           !! A, B (stress)
    real(dp) :: energy = 1.0_dp                         !! E0 (stress)
    real(dp) :: incipient = 0.0_dp, complete = 1.0_dp   !! E_iv, E_cv (stress)
    real(dp) :: alpha = 0.0_dp, beta = 0.0_dp           !! 1
  end type tillotson_t

contains

  !> Keys of the equation.
  function tillotson_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('a_thermal', kind_real, 'a of p = (a + b/(1 + E V^2/E0)) E/V + A mu + '// &
                'B mu^2, V: volume, E: energy, both per initial volume', range='(0,inf)', &
                required=.true.), &
            key('b_thermal', kind_real, 'b of it', range='[0,inf)', required=.true.), &
            key('bulk', kind_real, 'A of it, the bulk modulus when cold', &
                unit='stress', range='(0,inf)', required=.true.), &
            key('bulk2', kind_real, 'B of it', unit='stress', range='[0,inf)', required=.true.), &
            key('e0', kind_real, 'E0 of it per mass', unit='speed^2', range='(0,inf)', &
                required=.true.), &
            key('e_incipient', kind_real, 'energy per mass at which expanded material begins '// &
                'to evaporate', unit='speed^2', range='(0,inf)', required=.true.), &
            key('e_complete', kind_real, 'energy per mass at which all of it has, above '// &
                'e_incipient', unit='speed^2', range='(0,inf)', required=.true.), &
            key('alpha', kind_real, 'of the expanded gas', range='(0,inf)', default='5'), &
            key('beta', kind_real, 'of the expanded gas', range='(0,inf)', default='5')]
  end function tillotson_keys

  !> Equation from the values of its keys.
  pure function tillotson_read(density, values) result(law)
    real(dp), intent(in) :: density     !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(tillotson_t) :: law
    law = tillotson_init(density, [values%number('a_thermal'), values%number('b_thermal')], &
                         [values%number('bulk'), values%number('bulk2')], &
                         [values%number('e0'), values%number('e_incipient'), &
                          values%number('e_complete')], &
                         [values%number('alpha'), values%number('beta')])
  end function tillotson_read

  !> Whether evaporation begins before it is complete.
  pure subroutine tillotson_check(law, fault)
    type(tillotson_t), intent(in) :: law
    type(fault_t), allocatable, intent(inout) :: fault
    if (allocated(fault) .or. law%complete > law%incipient) return
    call fault_make(fault, 'e_complete', 'evaporation is complete before it begins', &
                    'give e_complete > e_incipient')
  end subroutine tillotson_check

  !> Constants from plain numbers.
  pure function tillotson_init(density0, thermal, cold, energies, expanded) result(law)
    real(dp), intent(in) :: density0     !! initial density (mass/volume)
    real(dp), intent(in) :: thermal(2)   !! a, b
    real(dp), intent(in) :: cold(2)      !! A, B (stress)
    real(dp), intent(in) :: energies(3)  !! E0, E_iv, E_cv per mass
    real(dp), intent(in) :: expanded(2)  !! alpha, beta
    type(tillotson_t) :: law
    law = tillotson_t(thermal(1), thermal(2), cold(1), cold(2), density0*energies(1), &
                      density0*energies(2), density0*energies(3), expanded(1), expanded(2))
  end function tillotson_init

  !> Terms of the tangent p = a0 + b0 E at an energy, with da + db E = dp/dv there; v <= 0 (an empty
  !! lane) is taken as 1.
  pure subroutine tillotson_terms(law, v, energy, a0, b0, da, db)
    type(tillotson_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: v            !! volume over initial volume
    real(dp), intent(in) :: energy       !! E (energy/initial volume)
    real(dp), intent(out) :: a0          !! pressure less b0 E (stress)
    real(dp), intent(out) :: b0          !! dp/dE
    real(dp), intent(out) :: da          !! dp/dv at that E (stress)
    real(dp), intent(out) :: db          !! 0
    real(dp) :: dense(3), hot(3), p(3), share, volume
    volume = merge(v, 1.0_dp, v > 0.0_dp)
    p = dense_state(law, volume, energy)
    if (volume > 1.0_dp .and. energy > law%incipient) then
      dense = p
      hot = hot_state(law, volume, energy)
      share = min(1.0_dp, (energy - law%incipient)/(law%complete - law%incipient))
      p = dense + share*(hot - dense)
      if (energy < law%complete) then
        p(3) = p(3) + (hot(1) - dense(1))/(law%complete - law%incipient)
      end if
    end if
    b0 = p(3)
    a0 = p(1) - b0*energy
    da = p(2)
    db = 0.0_dp
  end subroutine tillotson_terms

  !> Lane kernel of tillotson_terms.
  pure subroutine tillotson_lanes(law, v, energy, a0, b0, da, db)
    type(tillotson_t), intent(in) :: law                                 !! constants
    real(dp), intent(in) :: v(lanes), energy(lanes)                      !! as in the point function
    real(dp), intent(out) :: a0(lanes), b0(lanes), da(lanes), db(lanes)  !! as in the point function
    integer :: p
    do p = 1, lanes
      call tillotson_terms(law, v(p), energy(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine tillotson_lanes

  !> (TI1): p, dp/dv, dp/dE.
  pure function dense_state(law, v, energy) result(p)
    type(tillotson_t), intent(in) :: law
    real(dp), intent(in) :: v, energy
    real(dp) :: p(3), mu, thermal(3)
    mu = 1.0_dp/v - 1.0_dp
    thermal = bound_state(law, v, energy)
    p(1) = law%a*energy/v + thermal(1) + mu*(law%bulk + law%bulk2*mu)
    p(2) = -law%a*energy/v**2 + thermal(2) - (law%bulk + 2.0_dp*law%bulk2*mu)/v**2
    p(3) = law%a/v + thermal(3)
  end function dense_state

  !> (TI2): p, dp/dv, dp/dE.
  pure function hot_state(law, v, energy) result(p)
    type(tillotson_t), intent(in) :: law
    real(dp), intent(in) :: v, energy
    real(dp) :: p(3), mu, thermal(3), cold, fade, bound
    mu = 1.0_dp/v - 1.0_dp
    thermal = bound_state(law, v, energy)
    cold = law%bulk*exp(-law%beta*(v - 1.0_dp))
    fade = exp(-law%alpha*(v - 1.0_dp)**2)
    bound = thermal(1) + cold*mu
    p(1) = law%a*energy/v + bound*fade
    p(2) = -law%a*energy/v**2 + fade*(thermal(2) - cold*(1.0_dp/v**2 + law%beta*mu) &
                                      - 2.0_dp*law%alpha*(v - 1.0_dp)*bound)
    p(3) = law%a/v + fade*thermal(3)
  end function hot_state

  !> b E/(v w), and its derivatives with respect to v and E.
  pure function bound_state(law, v, energy) result(p)
    type(tillotson_t), intent(in) :: law
    real(dp), intent(in) :: v, energy
    real(dp) :: p(3), heat, w
    heat = max(energy, 0.0_dp)/law%energy
    w = 1.0_dp + heat*v**2
    p(1) = law%b*energy/(v*w)
    p(2) = -p(1)*(1.0_dp/v + 2.0_dp*heat*v/w)
    p(3) = law%b/(v*w**2)
  end function bound_state

end module sgmp_eos_tillotson
