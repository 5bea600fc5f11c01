!> What collisions of few cells say about a run (doc/verdict.md).
!!
!! Elastic bodies that meet face to face bounce by a wave that runs through them and back. On the
!! grid its front is as wide as the cube root of its way: of n cells the bodies keep a part
!! n^(-2/3) of what they should hand on, as a chain of masses does.
module sgmp_judge_collisions
  use sgmp_constitutive, only: constitutive_t, eos_none, material_elastic, &
                               material_mooney_rivlin, material_neo_hookean
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shape_block
  use sgmp_text, only: real_text
  use sgmp_thickness, only: body_thickness
  implicit none
  private
  public :: judge_collisions, bounce_error

  real(dp), parameter :: bounce_weight = 0.41_dp  !! sgmp, bars of 4 to 80 cells: 0.30 to 0.41
  real(dp), parameter :: bounce_cells = 16.0_dp   !! from here on the error is below 0.05 or so
  real(dp), parameter :: least_error = 0.1_dp     !! of what is coarse
  real(dp), parameter :: least_blow = 0.1_dp      !! impulse, over what the lighter body could have

contains

  !> Bodies that bounce off each other, where nothing else acts on them.
  subroutine judge_collisions(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells, mass, speed2
    integer :: b, p
    if (any(abs(scene%gravity) > 0.0_dp)) return
    if (size(scene%bodyforces) + size(scene%loads) + size(scene%motions) > 0) return
    speed2 = 2.0_dp*model%ledger%supplied/max(sum(model%totals%bodies%mass), tiny(1.0_dp))
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (.not. all([(bounces(scene, model, pair%body(b)), b=1, 2)])) cycle
        mass = minval(model%totals%bodies(pair%body)%mass)
        if (sum(pair%impulse**2) < least_blow**2*mass**2*speed2) cycle
        cells = minval([(body_thickness(scene%bodies(pair%body(b))%shapes, model%mesh), b=1, 2)])
        if (cells >= bounce_cells) cycle
        call opinion%expect(max(least_error, bounce_error(cells)), &
                            "bodies '"//trim(model%bodies(pair%body(1))%name)//"' and '"// &
                            trim(model%bodies(pair%body(2))%name)//"' of "//real_text(cells)// &
                            ' cells bounce off each other: their velocities after it want '// &
                            'smaller cells')
      end associate
      return
    end do
  end subroutine judge_collisions

  !> Part of the velocity that elastic bodies of so many cells do not hand on.
  pure real(dp) function bounce_error(cells)
    real(dp), intent(in) :: cells
    bounce_error = bounce_weight*cells**(-2.0_dp/3.0_dp)
  end function bounce_error

  !> Whether a body is elastic and has faces that are flat.
  pure logical function bounces(scene, model, b)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    bounces = .false.
    if (model%bodies(b)%rigid .or. .not. allocated(scene%bodies(b)%shapes)) return
    bounces = springy(model%bodies(b)%law) .and. all(scene%bodies(b)%shapes%kind == shape_block)
  end function bounces

  pure logical function springy(law)
    type(constitutive_t), intent(in) :: law
    springy = law%eos == eos_none .and. any(law%kind == [material_elastic, material_neo_hookean, &
                                                         material_mooney_rivlin])
  end function springy

end module sgmp_judge_collisions
