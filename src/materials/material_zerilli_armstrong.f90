!> Zerilli and Armstrong's (1987) flow stress, from the motion of dislocations (theory 4):
!!
!!     sigma_y = C0 + C5 ep^n + (C1 + C2 ep^(1/2)) exp(-C3 T) rate*^(C4 T)              (ZA1)
!!
!! which is C exp(-C3 T + C4 T ln rate*) of the paper, rate* = dep/(dt reference_rate). Metals with
!! a body-centred lattice have C2 = 0, those with a face-centred one C1 = C5 = 0. The return is
!! implicit in the plastic strain and its rate, the temperature that of the beginning of the step.
module sgmp_material_zerilli_armstrong
  use sgmp_heating, only: heat_plastic_work, heating_keys, heating_read, heating_t
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  use sgmp_radial_return, only: activated_t, hardening_keys, hardening_power_term, hardening_t, &
                                radial_return_activated
  implicit none
  private
  public :: zerilli_armstrong_t, zerilli_armstrong_keys, zerilli_armstrong_read
  public :: zerilli_armstrong_yield_stress, zerilli_armstrong_return

  !> Constants of (ZA1).
  type :: zerilli_armstrong_t
    real(dp) :: yield = 0.0_dp              !! C0 (stress)
    real(dp) :: thermal_stress = 0.0_dp     !! C1 (stress)
    real(dp) :: thermal_hardening = 0.0_dp  !! C2 (stress)
    real(dp) :: thermal_softening = 0.0_dp  !! C3 (1/temperature)
    real(dp) :: thermal_rate = 0.0_dp       !! C4 (1/temperature)
    real(dp) :: modulus = 0.0_dp            !! C5 (stress)
    real(dp) :: exponent = 1.0_dp           !! n
    real(dp) :: reference_rate = 1.0_dp     !! (1/time)
    type(heating_t) :: heating
  end type zerilli_armstrong_t

contains

  !> Keys of the law, besides the moduli.
  function zerilli_armstrong_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [hardening_keys(), &
            key('thermal_stress', kind_real, 'Zerilli-Armstrong C1: yield stress yield + '// &
                'hardening_modulus e^hardening_exponent + (C1 + C2 e^(1/2)) exp(-C3 T) '// &
                'r^(C4 T), e: plastic strain, r: its rate over reference_rate', unit='stress', &
                range='[0,inf)', default='0'), &
            key('thermal_hardening', kind_real, 'Zerilli-Armstrong C2; 0 for a body-centred '// &
                'lattice', unit='stress', range='[0,inf)', default='0'), &
            key('thermal_softening', kind_real, 'C3', unit='1/temperature', range='[0,inf)', &
                default='0'), &
            key('thermal_rate', kind_real, 'Zerilli-Armstrong C4', unit='1/temperature', &
                range='[0,inf)', default='0'), &
            key('reference_rate', kind_real, 'rate', unit='1/time', range='(0,inf)', &
                default='1'), &
            heating_keys()]
  end function zerilli_armstrong_keys

  !> Law from the values of its keys.
  pure subroutine zerilli_armstrong_read(density, values, law, history, fault)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(zerilli_armstrong_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    law%yield = values%number('yield')
    law%modulus = values%number('hardening_modulus')
    law%exponent = values%number('hardening_exponent')
    law%thermal_stress = values%number('thermal_stress')
    law%thermal_hardening = values%number('thermal_hardening')
    law%thermal_softening = values%number('thermal_softening')
    law%thermal_rate = values%number('thermal_rate')
    law%reference_rate = values%number('reference_rate')
    history%plastic = .true.
    call heating_read(density, values, law%heating, history, fault)
    if (allocated(fault)) return
    if (.not. law%thermal_stress + law%thermal_hardening > 0.0_dp) then
      call fault_make(fault, '', 'neither thermal_stress nor thermal_hardening is given', &
                      'add one of them, or use j2')
    end if
  end subroutine zerilli_armstrong_read

  !> Yield stress (ZA1) (stress).
  pure function zerilli_armstrong_yield_stress(law, ep, rate, temperature) result(stress)
    type(zerilli_armstrong_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: ep                    !! equivalent plastic strain, >= 0
    real(dp), intent(in) :: rate                  !! its rate, > 0 (1/time)
    real(dp), intent(in) :: temperature
    real(dp) :: stress
    stress = 0.0_dp
    if (temperature >= law%heating%melt) return
    stress = law%yield + law%modulus*hardening_power_term(ep, law%exponent) + &
             (law%thermal_stress + law%thermal_hardening*sqrt(ep)) &
             *exp(temperature*(law%thermal_rate*log(rate/law%reference_rate) - &
                               law%thermal_softening))
  end function zerilli_armstrong_yield_stress

  !> Lane kernel: radial return; molten lanes lose their deviator, and count it not as plastic.
  pure subroutine zerilli_armstrong_return(law, shear3, dt, trial, ep, temperature, factor, dep, &
                                           scatter)
    type(zerilli_armstrong_t), intent(in) :: law  !! constants
    real(dp), intent(in) :: shear3                !! three times the shear modulus (stress)
    real(dp), intent(in) :: dt                    !! time step
    real(dp), intent(in) :: trial(lanes)          !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: ep(lanes)          !! equivalent plastic strain, updated
    real(dp), intent(inout) :: temperature(lanes)  !! updated by (T1) where the law warms
    real(dp), intent(out) :: factor(lanes)        !! scales the trial deviator
    real(dp), intent(out) :: dep(lanes)           !! plastic strain increment
    real(dp), intent(in), optional :: scatter(lanes)  !! factor on the yield stress
    real(dp), parameter :: tiny_number = 1.0e-30_dp
    real(dp) :: softening, strength(lanes)
    type(hardening_t) :: hardening
    type(activated_t) :: activated
    real(dp) :: solid(lanes)
    integer :: p
    strength = 1.0_dp
    if (present(scatter)) strength = scatter
    hardening%shear3 = shear3
    hardening%yield = law%yield
    hardening%modulus = law%modulus
    hardening%exponent = law%exponent
    hardening%dep_reference = merge(dt*law%reference_rate, tiny_number, dt > 0.0_dp)
    !$omp simd simdlen(8) private(softening)
    do p = 1, lanes
      softening = exp(-law%thermal_softening*temperature(p))
      activated%stress(p) = strength(p)*law%thermal_stress*softening
      activated%hardening(p) = strength(p)*law%thermal_hardening*softening
      activated%power(p) = law%thermal_rate*temperature(p)
      solid(p) = merge(1.0_dp, 0.0_dp, temperature(p) < law%heating%melt)
    end do
    call radial_return_activated(hardening, strength, activated, solid*trial, ep, factor, dep)
    factor = solid*factor
    call heat_plastic_work(law%heating, trial, factor, dep, temperature)
  end subroutine zerilli_armstrong_return

end module sgmp_material_zerilli_armstrong
