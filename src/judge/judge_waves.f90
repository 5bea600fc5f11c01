!> What waves of few cells say about a run with a liquid under gravity (doc/verdict.md).
!!
!! Gravity waves of the wave number k are too slow on cells of the side h: with sgmp by 0.9 (kh)^2,
!! at any depth, with bspline by 0.55 (kh)^2; the others add noise (class Slosh of the random
!! scenes). A flow with a potential has |grad v|^2 = 2 k^2 v^2 in the mean, so that the velocities
!! of neighbouring points at the end say which k is in it; where waves stand just then, noise may
!! make it larger.
module sgmp_judge_waves
  use sgmp_constitutive, only: law_liquid
  use sgmp_kernels, only: method_bspline, method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_node_motion, only: node_motion
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_text, only: real_text_about
  implicit none
  private
  public :: judge_waves

  real(dp), parameter :: wave_weight = 1.0_dp    !! error over (kh)^2, sgmp 0.86 to 1.02
  real(dp), parameter :: noisy_weight = 4.0_dp   !! of methods that are neither sgmp nor bspline
  real(dp), parameter :: least_told = 0.06_dp, least_error = 0.1_dp
  real(dp), parameter :: most_error = 0.45_dp
  real(dp), parameter :: least_motion = 1.0e-6_dp  !! v^2 over g and the liquid's extent

contains

  !> Waves that the cells hardly resolve.
  subroutine judge_waves(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    real(dp) :: square, lost
    integer :: f
    if (.not. any(abs(scene%gravity) > 0.0_dp) .or. model%mesh%ndim == 1) return
    do f = 1, size(model%fields)
      if (.not. any(law_liquid(model%bodies%law) .and. .not. model%bodies%rigid .and. &
                    model%bodies%field == f)) cycle
      square = wave_number(scene, model, f)
      lost = square*merge(wave_weight, noisy_weight, any(scene%method%kind == [method_sgmp, &
                                                                               method_bspline]))
      if (lost < least_told) cycle
      text = 'waves of the liquid are about '// &
             real_text_about(2.0_dp*acos(-1.0_dp)/sqrt(square))//' cells long: '
      call opinion%expect(min(most_error, max(least_error, lost)), text//'they are slower than '// &
                          'they should be; use smaller cells')
      return
    end do
  end subroutine judge_waves

  !> The mean (kh)^2 of a field's motion; 0 if next to nothing moves. All ranks must call it.
  function wave_number(scene, model, f) result(square)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    real(dp) :: square
    real(dp) :: volume, motion, change
    volume = sum(model%totals%bodies%mass/model%bodies%law%density, mask=model%bodies%field == f)
    square = 0.0_dp
    call node_motion(model, f, motion, change)
    if (.not. motion > 0.0_dp) return
    if (motion < least_motion*norm2(scene%gravity)* &
        volume**(1.0_dp/merge(3, model%mesh%ndim, scene%axisymmetric))) return
    square = 0.5_dp*change/motion
  end function wave_number

end module sgmp_judge_waves
