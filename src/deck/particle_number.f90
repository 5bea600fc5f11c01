!> Particles of a cell along each axis, where the card of a body does not say.
!!
!! Two are enough for most. Particles of a ring that bends have stresses within a cell of which the
!! grid does not see anything: with two the energy in them is lost to its rebound, with three a
!! quarter of that, which saves more than it costs (doc/surfaces.md, 4).
module sgmp_particle_number
  use sgmp_constitutive, only: law_is_springy
  use sgmp_kinds, only: dp
  use sgmp_scene, only: body_card_t, scene_t
  use sgmp_shapes, only: shape_ring
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
          if (particle_number_bends(scene, body)) body%ppc = particle_number_bent
        end if
        if (body%spacing <= 0.0_dp) body%spacing = scene%grid%cell/body%ppc
      end associate
    end do
  end subroutine particle_number_settle

  !> Whether a body is an elastic ring in the plane, and strains are right at its surfaces.
  pure function particle_number_bends(scene, body) result(yes)
    type(scene_t), intent(in) :: scene
    type(body_card_t), intent(in) :: body
    logical :: yes
    yes = scene%dimension == 2 .and. .not. scene%axisymmetric .and. scene%method%surfaces .and. &
          body%material > 0 .and. allocated(body%shapes) .and. .not. body%rigid
    if (yes) yes = law_is_springy(scene%materials(body%material)%law) .and. &
                   any(body%shapes%kind == shape_ring)
  end function particle_number_bends

end module sgmp_particle_number
