!> Failure: when a particle fails, and what it carries from then on (theory 4).
!!
!! A particle has failed once its damage is 1: by Johnson and Cook's D1..D5, or at once where the
!! stress or the plastic strain at the beginning of a step meets a criterion:
!!
!!     mean stress > -pmin                         (spall)
!!     largest principal stress > principal_stress (Rankine)
!!     equivalent plastic strain >= plastic_strain
!!
!! -pmin is a number, or follows from energies (Grady 1988, J. Mech. Phys. Solids 36, 353): elastic
!! energy breaks ductile matter when it is the plastic work up to a strain of some 0.15, and brittle
!! matter when it and the kinetic energy of the opening make the surface of the fragments,
!!
!!     -pmin = sqrt(2 rho c^2 Y spall_strain)                                          (GR1)
!!     -pmin = (3 rho c toughness^2 tr D)^(1/3)                                        (GR2)
!!
!! with density, speed of sound in the bulk and yield stress of the start; (GR2) grows with the rate
!! at which the volume opens, and is not below a pmin of its own.
!!
!! or little by little with plastic strain, by the stress in it (sgmp_ductility).
!!
!! Failed matter carries nothing, or pressure alone (it closes again when it is compressed to its
!! initial density), or everything: then the damage is only a mark. A fluid tears without damage:
!! its pressure does not fall below pmin. With a fracture energy matter does not fail at once
!! (sgmp_softening); limits may scatter from particle to particle (sgmp_strength).
module sgmp_failure
  use sgmp_ductility, only: ductility_given, ductility_keys, ductility_read, ductility_t
  use sgmp_flaws, only: flaws_t
  use sgmp_keys, only: key, key_t, kind_integer, kind_real, kind_word, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_spelling, only: word_position, words_joined
  implicit none
  private
  public :: failure_keys, failure_read
  public :: failure_t, failure_judge, failure_bounds, failure_softens, largest_principal_stress
  public :: failure_by_strain, failure_set_spall, failure_tension
  public :: carries_nothing, carries_pressure, carries_everything, failure_none

  integer, parameter :: carries_nothing = 1, carries_pressure = 2, carries_everything = 3
  character(10), parameter :: carries_names(*) = [character(10) :: &
    'nothing', 'pressure', 'everything']

  integer, parameter :: components = 6  !! of a stress in space
  real(dp), parameter :: failure_none = huge(1.0_dp)  !! limit of a criterion that is not asked for

  !> Criteria and consequence.
  type :: failure_t
    logical :: given = .false.                       !! by a card
    integer :: carries = carries_pressure            !! one of carries_*
    real(dp) :: tension = failure_none               !! -pmin (stress)
    real(dp) :: spall_strain = 0.0_dp                !! of (GR1); 0: not asked for
    real(dp) :: toughness = 0.0_dp                   !! of (GR2) (stress length^1/2); 0: no rate
    real(dp) :: brittle = 0.0_dp                     !! 3 rho c toughness^2 (stress^3 time)
    real(dp) :: principal_stress = failure_none      !! (stress)
    real(dp) :: plastic_strain = failure_none
    real(dp) :: fracture_energy = 0.0_dp             !! per area of crack; 0: it fails at once
    real(dp) :: weibull = 0.0_dp                     !! modulus of the limits' scatter; 0: none
    integer :: seed = 0                              !! of the scatter
    real(dp) :: length = 0.0_dp                      !! over which plastic strain is averaged
    type(flaws_t) :: flaws                           !! of brittle matter
    type(ductility_t) :: ductility                   !! damage by stress and plastic strain
  end type failure_t

contains

  !> Keys of the card.
  function failure_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('pmin', kind_real, 'pressure (negative: tension) below which it spalls; a '// &
                "fluid's pressure stays there", unit='stress', range='(-inf,0]'), &
            key('spall_strain', kind_real, "in place of pmin, Grady's ductile spall: it fails "// &
                'at a tension of (2 rho c^2 Y spall_strain)^(1/2), Y: its first yield stress; '// &
                'he takes 0.15', range='(0,1]'), &
            key('toughness', kind_real, "with pmin, Grady's brittle spall: it fails at a "// &
                'tension of (3 rho c toughness^2 r)^(1/3), r: rate at which its volume opens, '// &
                'and not before pmin', unit='stress length^1/2', range='(0,inf)'), &
            key('principal_stress', kind_real, 'largest principal stress above which it fails', &
                unit='stress', range='(0,inf)'), &
            key('plastic_strain', kind_real, 'equivalent plastic strain at which it fails', &
                range='(0,inf)'), &
            ductility_keys(), &
            key('carries', kind_word, 'post-failure strength: what failed material carries; '// &
                'everything: damage is only '// &
                'a mark', choices=words_joined(carries_names), &
                default=trim(carries_names(carries_pressure))), &
            key('fracture_energy', kind_real, 'energy per area that a crack takes while '// &
                'strength falls from the limit that was met (pmin, spall_strain, '// &
                'principal_stress, or the yield stress at plastic_strain) to nothing; without '// &
                'it all is lost at once', &
                unit='stress length', range='(0,inf)'), &
            key('length', kind_real, 'length of the material over which plastic strain is '// &
                'averaged for plastic_strain, plastic_work, hosford_strain, d1 to d5 and the '// &
                'heat of johnson_cook: failure then does not follow cells of half of it and '// &
                'less; see doc/materials.md', &
                unit='length', range='(0,inf)'), &
            key('flaws', kind_real, 'k of the k e^m flaws per volume that grow at strains '// &
                'below e (Grady and Kipp): brittle matter, alone', unit='1/volume', &
                range='(0,inf)'), &
            key('flaw_exponent', kind_real, 'm of it; with flaws', range='[1,inf)'), &
            key('crack_speed', kind_real, 'speed of the cracks from flaws; default: 0.4 of '// &
                'that of longitudinal waves', unit='speed', range='(0,inf)'), &
            key('flaw_count', kind_real, 'number of flaws of a particle that must grow to '// &
                'break it; default: 1; Benz and Asphaug take the logarithm of the number of '// &
                'particles', &
                range='[1,inf)'), &
            key('weibull', kind_real, 'Weibull modulus of all limits of this card, and of the '// &
                'failure strain of d1 to d5, which scatter from particle to particle; the '// &
                'given ones are the means', range='[0.5,inf)'), &
            key('seed', kind_integer, 'another number, another scatter, and other flaws', &
                range='[0,inf)', default='0')]
  end function failure_keys

  !> Criteria from the values of those keys.
  pure function failure_read(values) result(law)
    class(values_t), intent(in) :: values
    type(failure_t) :: law
    law%given = .true.
    law%carries = word_position(values%word('carries'), carries_names)
    law%tension = -values%number('pmin', -failure_none)
    law%spall_strain = values%number('spall_strain')
    law%toughness = values%number('toughness')
    law%principal_stress = values%number('principal_stress', failure_none)
    law%plastic_strain = values%number('plastic_strain', failure_none)
    law%fracture_energy = values%number('fracture_energy')
    law%weibull = values%number('weibull')
    law%seed = nint(values%number('seed'))
    law%length = values%number('length')
    law%ductility = ductility_read(values)
    law%flaws = flaws_t(values%number('flaws'), values%number('flaw_exponent', 1.0_dp), &
                        values%number('crack_speed'), values%number('flaw_count', 1.0_dp))
  end function failure_read

  !> Whether plastic strain makes matter fail.
  elemental logical function failure_by_strain(law) result(yes)
    type(failure_t), intent(in) :: law
    yes = law%plastic_strain < failure_none .or. ductility_given(law%ductility)
  end function failure_by_strain

  !> Whether matter softens before it has failed.
  pure logical function failure_softens(law) result(yes)
    type(failure_t), intent(in) :: law
    yes = law%fracture_energy > 0.0_dp .or. law%flaws%number > 0.0_dp
  end function failure_softens

  !> Gives the law what Grady's tensions need of the material.
  pure subroutine failure_set_spall(law, density, speed, yield)
    type(failure_t), intent(inout) :: law
    real(dp), intent(in) :: density, speed       !! of the start; of sound in the bulk
    real(dp), intent(in) :: yield                !! first yield stress (stress)
    if (law%spall_strain > 0.0_dp) then
      law%tension = speed*sqrt(2.0_dp*density*yield*law%spall_strain)
    end if
    law%brittle = 3.0_dp*density*speed*law%toughness**2
  end subroutine failure_set_spall

  !> Tension that is borne while the volume opens at a rate, (GR2) where that is asked for (stress).
  pure elemental function failure_tension(law, rate) result(tension)
    type(failure_t), intent(in) :: law
    real(dp), intent(in) :: rate                 !! trace of the velocity gradient (1/time)
    real(dp) :: tension
    tension = max(law%tension, (law%brittle*max(rate, 0.0_dp))**(1.0_dp/3.0_dp))
  end function failure_tension

  !> Lane kernel: damage 1 where a criterion is met; which lanes carry less than their law says.
  pure subroutine failure_judge(law, stress, plastic_strain, damage, failed, tension)
    type(failure_t), intent(in) :: law
    real(dp), intent(in) :: stress(lanes, components)  !! in Voigt's order
    real(dp), intent(in) :: plastic_strain(lanes)  !! equivalent
    real(dp), intent(inout) :: damage(lanes)
    real(dp), intent(out) :: failed(lanes)         !! 1 or 0
    real(dp), intent(in), optional :: tension(lanes)  !! in place of the law's (stress)
    real(dp) :: mean, released, most(lanes)
    integer :: p
    released = merge(0.0_dp, 1.0_dp, law%carries == carries_everything)
    most = law%tension
    if (present(tension)) most = tension
    if (law%principal_stress < failure_none) then
      do p = 1, lanes
        if (largest_principal_stress(stress(p, :)) > law%principal_stress) damage(p) = 1.0_dp
      end do
    end if
    !$omp simd simdlen(8) private(mean)
    do p = 1, lanes
      mean = (stress(p, 1) + stress(p, 2) + stress(p, 3))*(1.0_dp/3.0_dp)
      damage(p) = merge(1.0_dp, damage(p), mean > most(p))
      damage(p) = merge(1.0_dp, damage(p), plastic_strain(p) >= law%plastic_strain)
      failed(p) = merge(released, 0.0_dp, damage(p) >= 1.0_dp)
    end do
  end subroutine failure_judge

  !> Lane kernel: bounds of the pressure, none where a lane has not failed.
  pure subroutine failure_bounds(law, failed, least, most)
    type(failure_t), intent(in) :: law
    real(dp), intent(in) :: failed(lanes)                !! 1 or 0
    real(dp), intent(out) :: least(lanes), most(lanes)   !! (stress)
    real(dp) :: top
    integer :: p
    top = merge(0.0_dp, failure_none, law%carries == carries_nothing)
    !$omp simd simdlen(8)
    do p = 1, lanes
      least(p) = merge(0.0_dp, -failure_none, failed(p) > 0.5_dp)
      most(p) = merge(top, failure_none, failed(p) > 0.5_dp)
    end do
  end subroutine failure_bounds

  !> Largest eigenvalue of a stress, in closed form (Smith 1961).
  pure function largest_principal_stress(stress) result(largest)
    real(dp), intent(in) :: stress(components)  !! in Voigt's order: xx yy zz xy yz xz
    real(dp) :: largest
    real(dp) :: mean, size, d(3), determinant
    mean = sum(stress(:3))/3.0_dp
    d = stress(:3) - mean
    size = sqrt((sum(d**2) + 2.0_dp*sum(stress(4:)**2))/6.0_dp)
    largest = mean
    if (.not. size > 0.0_dp) return
    determinant = d(1)*(d(2)*d(3) - stress(5)**2) &
                  - stress(4)*(stress(4)*d(3) - stress(5)*stress(6)) &
                  + stress(6)*(stress(4)*stress(5) - d(2)*stress(6))
    largest = mean + 2.0_dp*size*cos(acos(max(-1.0_dp, min(1.0_dp, 0.5_dp*determinant/size**3))) &
                                     /3.0_dp)
  end function largest_principal_stress

end module sgmp_failure
