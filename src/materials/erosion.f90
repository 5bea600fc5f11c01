!> Erosion: particles that are removed once they stand for nothing, or cost more than they tell.
!!
!! A particle goes when its plastic strain reaches a limit, when its damage is 1, or when waves and
!! its velocity would force a time step on the run that is below a limit.
module sgmp_erosion
  use sgmp_keys, only: key, key_t, kind_logical, kind_real, values_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: erosion_t, erosion_keys, erosion_read, erosion_wanted

  !> When a particle is removed.
  type :: erosion_t
    logical :: given = .false.                     !! by a card
    logical :: failed = .false.                    !! where the damage is 1
    real(dp) :: plastic_strain = huge(1.0_dp)
    real(dp) :: time_step = 0.0_dp                 !! (time)
    real(dp) :: speed = huge(1.0_dp)               !! c + |v| that the time step stands for
  end type erosion_t

contains

  !> Keys of the card.
  function erosion_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('plastic_strain', kind_real, 'equivalent plastic strain at which a particle goes', &
                range='(0,inf)'), &
            key('failed', kind_logical, 'whether a particle goes that has failed', default='no'), &
            key('time_step', kind_real, 'a particle goes that would force a shorter step on '// &
                'the run (with time dt=…: a step with a Courant number of 1)', unit='time', &
                range='(0,inf)')]
  end function erosion_keys

  !> Criteria from the values of those keys.
  pure function erosion_read(values) result(erosion)
    class(values_t), intent(in) :: values
    type(erosion_t) :: erosion
    erosion%given = .true.
    erosion%failed = values%flag('failed')
    erosion%plastic_strain = values%number('plastic_strain', huge(1.0_dp))
    erosion%time_step = values%number('time_step')
  end function erosion_read

  !> Whether a particle is to be removed.
  elemental logical function erosion_wanted(erosion, plastic_strain, damage, speed) result(yes)
    type(erosion_t), intent(in) :: erosion
    real(dp), intent(in) :: plastic_strain         !! equivalent
    real(dp), intent(in) :: damage
    real(dp), intent(in) :: speed                  !! c + |v|
    yes = plastic_strain >= erosion%plastic_strain .or. (erosion%failed .and. damage >= 1.0_dp) &
          .or. speed > erosion%speed
  end function erosion_wanted

end module sgmp_erosion
