!> Keys that the laws of soils share: angles, cohesion, tension; and which of them cannot be.
module sgmp_soil
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: soil_keys, soil_check, soil_apex, soil_matter, degree

  real(dp), parameter :: degree = acos(-1.0_dp)/180.0_dp

contains

  !> Keys of a soil, besides the moduli.
  function soil_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('friction', kind_real, 'angle of internal friction', unit='degrees', &
                range='(0,90)', required=.true.), &
            key('cohesion', kind_real, 'cohesion', unit='stress', range='[0,inf)', default='0'), &
            key('dilatancy', kind_real, 'angle of dilatancy, not above that of friction', &
                unit='degrees', range='[0,90)', default='0'), &
            key('tension', kind_real, 'largest mean stress (drucker_prager) or principal '// &
                'stress (mohr_coulomb); default: that of the apex', unit='stress', &
                range='[0,inf)')]
  end function soil_keys

  !> Whether a soil's constants go together.
  pure subroutine soil_check(values, fault)
    class(values_t), intent(in) :: values
    type(fault_t), allocatable, intent(out) :: fault
    if (values%number('dilatancy') > values%number('friction')) then
      call fault_make(fault, 'dilatancy', 'the angle of dilatancy is above that of friction', &
                      'such a soil would make energy')
    else if (values%number('tension') > soil_apex(values%number('friction'), &
                                                  values%number('cohesion'))) then
      call fault_make(fault, 'tension', 'the tension lies beyond the apex, '// &
                      'cohesion/tan(friction)', 'leave it out, or give less')
    end if
  end subroutine soil_check

  !> Largest tension of a soil, the same along all axes, c/tan(phi).
  pure function soil_apex(friction, cohesion) result(tension)
    real(dp), intent(in) :: friction   !! phi (degrees), > 0
    real(dp), intent(in) :: cohesion   !! c (stress)
    real(dp) :: tension
    tension = cohesion/tan(degree*friction)
  end function soil_apex

  !> Volumes without what has opened between grains, (s_m - tension)/K of a trial mean stress beyond
  !! the largest tension: the gap has no stress, and waves do not cross it. What is left is the
  !! volume of the matter, in which stress acts when grains meet again.
  pure subroutine soil_matter(opened, volume)
    real(dp), intent(in) :: opened(lanes)   !! change of volume over the volume, at least 0
    real(dp), intent(inout) :: volume(lanes)
    if (all(opened <= 0.0_dp)) return
    volume = volume/(1.0_dp + opened)
  end subroutine soil_matter

end module sgmp_soil
