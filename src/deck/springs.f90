!> Bodies that spring back: what is elastic alone, and of metals what nothing in the scene is fast
!! or strong enough to make yield as a whole (doc/materials.md, Metals that do not yield). A spot
!! that is hit, a corner may.
module sgmp_springs
  use sgmp_constitutive, only: law_is_metal, law_is_springy, law_yield_stress, law_young
  use sgmp_fast_scenes, only: largest_load_of, largest_speed_of
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_pressure, load_traction
  use sgmp_scene, only: scene_at_rest, scene_t
  use sgmp_shapes, only: shapes_box
  implicit none
  private
  public :: scene_springs

contains

  !> Whether a body springs back.
  function scene_springs(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    real(dp) :: yield, speed
    yes = .false.
    associate (body => scene%bodies(b))
      if (body%rigid .or. body%material == 0) return
      associate (law => scene%materials(body%material)%law)
        yes = law_is_springy(law)
        if (yes .or. .not. law_is_metal(law) .or. is_pressed(scene)) return
        ! At this speed the kinetic energy is that of a body in tension at its yield stress.
        yield = law_yield_stress(law, 0.0_dp)
        speed = yield/sqrt(max(law_young(law)*law%density, tiny(1.0_dp)))
        yes = largest_speed_of(scene) <= speed .and. &
              (largest_load_of(scene) + weight(scene, b))*slenderness(scene, b)**2 <= yield
      end associate
    end associate
  end function scene_springs

  !> Whether something moves on, whatever it meets, or pushes with forces that are no pressures.
  pure function is_pressed(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b
    associate (walls => scene%grid%wall_velocity)
      yes = size(scene%motions) + size(scene%bodyforces) > 0 .or. &
            .not. all(walls%is_constant) .or. any(abs(walls%value) > 0.0_dp)
    end associate
    yes = yes .or. any(scene%loads%kind /= load_pressure .and. scene%loads%kind /= load_traction)
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        yes = yes .or. (body%rigid .and. .not. (body%free .or. scene_at_rest(body)))
      end associate
    end do
  end function is_pressed

  !> Weight of a body over its face: what its foot bears.
  function weight(scene, b) result(pressure)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    real(dp) :: pressure
    real(dp) :: sides(3)
    sides = box_sides(scene, b)
    pressure = scene%materials(scene%bodies(b)%material)%law%density* &
               sum(abs(scene%gravity)*sides, mask=abs(scene%gravity) > 0.0_dp)
  end function weight

  !> Longest over shortest side of the box around a body: a load bends what is slender with a stress
  !! of so many times its pressure squared.
  function slenderness(scene, b) result(ratio)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    real(dp) :: ratio
    real(dp) :: sides(3)
    sides = box_sides(scene, b)
    ratio = 1.0_dp
    associate (some => sides(:scene%dimension))
      if (minval(some) > 0.0_dp) ratio = maxval(some)/minval(some)
    end associate
  end function slenderness

  !> Sides of the box around a body; 0 of particles of a file.
  function box_sides(scene, b) result(sides)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    real(dp) :: sides(3)
    real(dp) :: lower(3), upper(3)
    sides = 0.0_dp
    if (.not. allocated(scene%bodies(b)%shapes)) return
    if (size(scene%bodies(b)%shapes) == 0) return
    call shapes_box(scene%bodies(b)%shapes, lower, upper)
    sides = upper - lower
  end function box_sides

end module sgmp_springs
