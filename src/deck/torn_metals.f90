!> Metals without a card `failure` that are hit so hard that they may be torn: what no equation of
!! state holds together any more would stretch without end. Where a scene is so fast they fail there
!! (doc/materials.md, Failure); a slow one does not pay for it.
module sgmp_torn_metals
  use sgmp_constitutive, only: law_may_tear, law_tear
  use sgmp_kinds, only: dp
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box
  implicit none
  private
  public :: speed_at_start, tear_fast_metals

  ! Of the bodies over that of sound in the bulk; a ball on a plate tears from a third of it on.
  real(dp), parameter :: fast = 0.2_dp

contains

  !> Lets metals fail where they are torn, in a scene that is fast for them.
  subroutine tear_fast_metals(scene)
    type(scene_t), intent(inout) :: scene
    real(dp) :: fastest
    integer :: b, m
    fastest = 0.0_dp
    do b = 1, size(scene%bodies)
      fastest = max(fastest, largest_speed(scene, b, scene%dimension))
    end do
    do m = 1, size(scene%materials)
      associate (law => scene%materials(m)%law)
        if (law_may_tear(law) .and. fastest > fast*law%bulk_speed) call law_tear(law)
      end associate
    end do
  end subroutine tear_fast_metals

  !> Largest speed of a body at the start: of a rigid one that of its motion, of a formula at the
  !! corners of the box around it, and in its middle.
  function largest_speed(scene, b, n) result(speed)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, n        !! body, axes
    real(dp) :: speed
    real(dp) :: box(3, 0:1), place(3), velocity(n)
    integer :: corner, d
    speed = speed_at_start(scene, b, n)
    associate (body => scene%bodies(b))
      if (body%rigid .and. .not. body%free) then
        place = 0.0_dp
        velocity = [(body%motion(d)%evaluate(place, place, 0.0_dp), d=1, n)]
        if (all(abs(velocity) < huge(1.0_dp))) speed = norm2(velocity)
        return
      end if
      if (all(body%velocity(:n)%is_constant) .or. .not. allocated(body%shapes)) return
      call shapes_box(body%shapes, box(:, 0), box(:, 1))
      do corner = 0, 2**n
        place = 0.0_dp
        place(:n) = [(box(d, merge(1, 0, btest(corner, d - 1))), d=1, n)]
        if (corner == 2**n) place(:n) = 0.5_dp*(box(:n, 0) + box(:n, 1))
        velocity = [(body%velocity(d)%evaluate(place, place, 0.0_dp), d=1, n)]
        if (all(abs(velocity) < huge(1.0_dp))) speed = max(speed, norm2(velocity))
      end do
    end associate
  end function largest_speed

  !> Speed of a body at the start; 0 where it is not the same everywhere.
  pure function speed_at_start(scene, b, n) result(speed)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, n        !! body, axes
    real(dp) :: speed
    speed = 0.0_dp
    associate (start => scene%bodies(b)%velocity(:n))
      if (all(start%is_constant)) speed = norm2(start%value)
    end associate
  end function speed_at_start

end module sgmp_torn_metals
