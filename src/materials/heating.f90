!> Temperature of matter that exchanges no heat (theory 4):
!!
!!     dT = taylor_quinney sigma_eq dep/C                                               (T1)
!!     dT = -b0 T dv - q dv/C                                                           (T2)
!!
!! with C the specific heat per initial volume, dep the plastic strain and, where there is an
!! equation of state p = a0(v) + b0(v) E, the isentrope of constant specific heat, on which T varies
!! as exp(-int b0 dv), and what bulk viscosity q dissipates. Molten matter has no strength.
module sgmp_heating
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: heating_t, heating_keys, heating_read
  public :: heat_plastic_work, plastic_heat_lanes, compression_heat_lanes

  !> What warms matter.
  type :: heating_t
    logical :: warms = .false.              !! the temperature is carried
    real(dp) :: room = 0.0_dp               !! (temperature) initial
    real(dp) :: melt = huge(1.0_dp)         !! (temperature) where it has no strength
    real(dp) :: heat_capacity = 1.0_dp      !! density times specific heat
    real(dp) :: taylor_quinney = 0.0_dp     !! fraction of the plastic work that heats
  end type heating_t

contains

  !> Keys of temperature and heat.
  function heating_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('room_temperature', kind_real, 'initial and reference temperature', &
                unit='temperature', range='[0,inf)', default='293'), &
            key('melt_temperature', kind_real, 'melting temperature, where no strength is '// &
                'left; johnson_cook: needed if thermal', unit='temperature', range='(0,inf)'), &
            key('specific_heat', kind_real, 'specific heat; johnson_cook: needed if thermal, '// &
                'others: without it the temperature stays at the ambient one', &
                unit='specific heat', range='(0,inf)'), &
            key('taylor_quinney', kind_real, 'part of the plastic work that becomes heat', &
                range='[0,1]', default='0.9')]
  end function heating_keys

  !> Heating from the values of those keys.
  pure subroutine heating_read(density, values, heating, history, fault)
    real(dp), intent(in) :: density  !! initial density (mass/volume)
    class(values_t), intent(in) :: values
    type(heating_t), intent(out) :: heating
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    heating%warms = values%has('specific_heat')
    heating%room = values%number('room_temperature')
    heating%melt = values%number('melt_temperature', huge(1.0_dp))
    if (heating%warms) heating%heat_capacity = density*values%number('specific_heat')
    heating%taylor_quinney = values%number('taylor_quinney')
    history%temperature = heating%warms
    history%first_temperature = heating%room
    if (.not. heating%melt > heating%room) then
      call fault_make(fault, 'melt_temperature', &
                      'the melting temperature is not above room temperature', 'check both')
    else if (values%has('melt_temperature') .and. .not. heating%warms) then
      call fault_make(fault, 'melt_temperature', 'without specific_heat nothing warms, or melts', &
                      'add specific_heat, or remove melt_temperature')
    end if
  end subroutine heating_read

  !> Lane kernel: heat of the plastic work (T1) of matter that warms; none of other matter.
  pure subroutine heat_plastic_work(heating, trial, factor, dep, temperature)
    type(heating_t), intent(in) :: heating
    real(dp), dimension(lanes), intent(in) :: trial, factor, dep  !! as in plastic_heat_lanes
    real(dp), intent(inout) :: temperature(lanes)
    if (.not. heating%warms) return
    call plastic_heat_lanes(heating%taylor_quinney/heating%heat_capacity, trial, factor, dep, &
                            temperature)
  end subroutine heat_plastic_work

  !> Lane kernel: heat of the plastic work (T1).
  pure subroutine plastic_heat_lanes(rise, trial, factor, dep, temperature)
    real(dp), intent(in) :: rise  !! of the temperature by a plastic work of 1 per initial volume
    real(dp), dimension(lanes), intent(in) :: trial, factor, dep  !! as in jc_return
    real(dp), intent(inout) :: temperature(lanes)
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      temperature(p) = temperature(p) + rise*factor(p)*trial(p)*dep(p)
    end do
  end subroutine plastic_heat_lanes

  !> Lane kernel: heat of compression and of bulk viscosity (T2).
  pure subroutine compression_heat_lanes(heat_capacity, b0, v_old, v_new, viscous, temperature)
    real(dp), intent(in) :: heat_capacity                  !! C
    real(dp), dimension(lanes), intent(in) :: b0           !! dp/dE after the step
    real(dp), dimension(lanes), intent(in) :: v_old, v_new  !! volume over initial volume
    real(dp), dimension(lanes), intent(in) :: viscous      !! work of q per initial volume
    real(dp), intent(inout) :: temperature(lanes)
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      temperature(p) = temperature(p)*exp(-b0(p)*(v_new(p) - v_old(p))) + viscous(p)/heat_capacity
    end do
  end subroutine compression_heat_lanes

end module sgmp_heating
