!> Programmed burn of explosives: lighting times from detonation points, burn fraction as a ramp
!! (theory 4).
module sgmp_burn
  use sgmp_front_paths, only: front_source_t, front_straight
  use sgmp_keys, only: key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: burn_lighting_time, burn_fraction, burn_fraction_lanes, burn_never
  public :: burn_keys, burn_read

  real(dp), parameter :: burn_never = huge(1.0_dp)  !! lighting time of what no source reaches

contains

  !> Keys of an explosive.
  function burn_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('detonation_speed', kind_real, 'speed of the programmed burn', unit='speed', &
                range='(0,inf)', required=.true.), &
            key('burn_cells', kind_real, 'cells over which the burn fraction rises; 0: at once', &
                range='[0,inf)', default='0')]
  end function burn_keys

  !> Constants of an explosive from the values of its keys.
  pure subroutine burn_read(values, speed, cells, history)
    class(values_t), intent(in) :: values
    real(dp), intent(out) :: speed  !! detonation speed D
    real(dp), intent(out) :: cells  !! width of the ramp in cells
    type(history_t), intent(inout) :: history
    speed = values%number('detonation_speed')
    cells = values%number('burn_cells')
    history%mean_stress = .true.
    history%lighting = .true.
  end subroutine burn_read

  !> Time at which the detonation front of the first source to do so arrives along a straight line:
  !! min(time + distance/speed).
  pure function burn_lighting_time(sources, position, speed) result(time)
    type(front_source_t), intent(in) :: sources(:)  !! (n) sources; none: burn_never
    real(dp), intent(in) :: position(3)           !! initial position, unused components 0
    real(dp), intent(in) :: speed                 !! detonation speed D, > 0
    real(dp) :: time
    integer :: k
    time = burn_never
    do k = 1, size(sources)
      time = min(time, front_straight(sources(k), position, speed))
    end do
  end function burn_lighting_time

  !> Burn fraction: 0 before the front, 1 once it is `cells` cells past, linear between; cells = 0:
  !! a jump on arrival.
  pure function burn_fraction(time, lighting_time, speed, cell, cells) result(fraction)
    real(dp), intent(in) :: time          !! current time
    real(dp), intent(in) :: lighting_time  !! arrival of the front
    real(dp), intent(in) :: speed         !! detonation speed D
    real(dp), intent(in) :: cell          !! cell side h, > 0
    real(dp), intent(in) :: cells         !! width of the ramp in cells, >= 0
    real(dp) :: fraction
    real(dp) :: elapsed, width
    ! before the product, which burn_never would overflow
    elapsed = merge(time - lighting_time, 0.0_dp, time > lighting_time)
    width = cells*cell
    fraction = elapsed*speed/merge(width, cell, width > 0.0_dp)
    fraction = merge(fraction, 1.0_dp, fraction < 1.0_dp)
    fraction = merge(fraction, merge(1.0_dp, 0.0_dp, time >= lighting_time), width > 0.0_dp)
  end function burn_fraction

  !> Lane kernel of burn_fraction.
  pure subroutine burn_fraction_lanes(time, lighting_time, speed, cell, cells, fraction)
    real(dp), intent(in) :: time, speed, cell, cells  !! as in burn_fraction
    real(dp), intent(in) :: lighting_time(lanes)      !! arrival of the front
    real(dp), intent(out) :: fraction(lanes)          !! burn fraction
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      fraction(p) = burn_fraction(time, lighting_time(p), speed, cell, cells)
    end do
  end subroutine burn_fraction_lanes

end module sgmp_burn
