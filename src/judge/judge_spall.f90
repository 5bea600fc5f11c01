!> What a spall of few cells says about a run (doc/verdict.md).
!!
!! Matter that is pulled apart parts on the grid over a cell or two, and until it has, tension
!! goes on across the gap. So what flies off lacks velocity, the more the nearer the tension p at
!! which it fails is to the pressure of the impact: of plates that hit one of their own metal at v,
!! n cells thick, 2.4 to 6.5 parts of p/(rho c v/2)/n (class Spall of the random scenes, whose truth
!! is a Lagrangian code in one dimension).
module sgmp_judge_spall
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_failure, only: failure_by_strain, failure_none
  use sgmp_fast_scenes, only: speed_at_start
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_parallel, only: parallel_sum
  use sgmp_scene, only: scene_t
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: body_thickness
  implicit none
  private
  public :: judge_spall

  real(dp), parameter :: spall_weight = 6.0_dp
  real(dp), parameter :: least_told = 0.1_dp, most_error = 0.35_dp

contains

  !> Solids that have spalled in an impact; all ranks must call it.
  subroutine judge_spall(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: speeds(size(scene%bodies)), pressure, cells, lost
    integer :: b, fastest
    if (size(scene%bodies) < 2) return
    speeds = [(speed_at_start(scene, b, model%mesh%ndim), b=1, size(scene%bodies))]
    fastest = maxloc(speeds, dim=1)
    if (.not. speeds(fastest) > 0.0_dp) return
    do b = 1, size(scene%bodies)
      if (.not. may_spall(model%bodies(b))) cycle
      associate (law => model%bodies(b)%law)
        pressure = 0.5_dp*law%density*law%bulk_speed*speeds(fastest)
        if (.not. pressure > 0.0_dp) cycle
        cells = min(body_thickness(scene%bodies(b)%shapes, model%mesh), &
                    body_thickness(scene%bodies(fastest)%shapes, model%mesh))
        lost = spall_weight*law%failure%tension/pressure/cells
      end associate
      if (lost < least_told) cycle
      if (parallel_sum(failed(model%bodies(b))) == 0_i8) cycle
      call opinion%expect(min(most_error, lost), &
                          "body '"//trim(model%bodies(b)%name)//"' has spalled, and of "// &
                          real_text_about(cells)//' cells of it or of what hit it what flies '// &
                          'off lacks velocity: use smaller cells')
      return
    end do
  end subroutine judge_spall

  !> Whether a body is a solid that fails by a tension and by no strain, of which others judge.
  pure logical function may_spall(body) result(yes)
    type(body_t), intent(in) :: body
    yes = .not. body%rigid .and. .not. law_is_spherical(body%law)
    if (yes) yes = body%law%failure%tension < failure_none .and. body%law%slots%damage > 0 .and. &
                   .not. (body%law%jc%failure .or. failure_by_strain(body%law%failure))
  end function may_spall

  !> Particles of a body on this rank that have failed.
  pure function failed(body) result(number)
    type(body_t), intent(in) :: body
    integer(i8) :: number
    integer :: c
    number = 0_i8
    associate (particles => body%particles)
      do c = 1, particles%chunks
        number = number + count(particles%id(:lanes, c) /= 0 .and. &
                                particles%state(:lanes, body%law%slots%damage, c) >= 1.0_dp)
      end do
    end associate
  end function failed

end module sgmp_judge_spall
