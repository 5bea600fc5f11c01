!> Particles of a cell along each axis, where the card of a body does not say.
!!
!! Two are enough for most. Particles of a ring that bends have stresses within a cell of which the
!! grid does not see anything: with two the energy in them is lost to its rebound, with three a
!! quarter of that, which saves more than it costs (doc/surfaces.md, 4).
module sgmp_particle_number
  use sgmp_kinds, only: dp
  use sgmp_scene, only: body_card_t, scene_t
  use sgmp_shapes, only: shape_ring
  use sgmp_springs, only: scene_springs
  implicit none
  private
  public :: particle_number_settle, particle_number_usual

  integer, parameter :: particle_number_usual = 2
  integer, parameter :: particle_number_bent = 3

contains

  !> Particles per cell of all bodies that leave it to the program, and the spacing of theirs.
  subroutine particle_number_settle(scene)
    type(scene_t), intent(inout) :: scene
    integer :: b
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        if (body%ppc == 0) then
          body%ppc = particle_number_usual
          if (particle_number_bends(scene, b)) body%ppc = particle_number_bent
        end if
        if (body%spacing <= 0.0_dp) body%spacing = scene%grid%cell/body%ppc
      end associate
    end do
  end subroutine particle_number_settle

  !> Whether a body is a ring in the plane that springs back, and strains are right at its surfaces.
  function particle_number_bends(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    associate (body => scene%bodies(b))
      yes = scene%dimension == 2 .and. .not. scene%axisymmetric .and. scene%method%surfaces .and. &
            body%material > 0 .and. allocated(body%shapes) .and. .not. body%rigid
      if (yes) yes = any(body%shapes%kind == shape_ring)
      if (yes) yes = scene_springs(scene, b)
    end associate
  end function particle_number_bends

end module sgmp_particle_number
