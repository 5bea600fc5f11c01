!> What waves of few cells say about a run with a liquid under gravity (doc/verdict.md).
!!
!! Gravity waves of the wave number k are too slow on cells of the side h: with sgmp by 0.9 (kh)^2,
!! at any depth, with bspline by 0.55 (kh)^2; the others add noise (class Slosh of the random
!! scenes). A flow with a potential has |grad v|^2 = 2 k^2 v^2 in the mean, so that the velocities
!! of neighbouring points at the end say which k is in it; where waves stand just then, noise may
!! make it larger.
!!
!! Where a denser fluid lies on a lighter one, waves between them grow, by exp(t sqrt(A g k)) at
!! first (Rayleigh, Taylor). Both share the cells between them, so that they grow too slowly, by
!! 0.51 to 0.57 kh (16 to 64 cells a wave, A = 1/2).
module sgmp_judge_waves
  use sgmp_constitutive, only: law_is_spherical, law_liquid, material_explosive
  use sgmp_kernels, only: method_bspline, method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_node_motion, only: node_motion
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_text, only: real_text_about
  implicit none
  private
  public :: judge_waves

  real(dp), parameter :: wave_weight = 1.0_dp    !! error over (kh)^2, sgmp 0.86 to 1.02
  real(dp), parameter :: noisy_weight = 4.0_dp   !! of methods that are neither sgmp nor bspline
  real(dp), parameter :: growth_weight = 0.7_dp  !! error of the rate over kh
  real(dp), parameter :: least_told = 0.06_dp, least_error = 0.1_dp
  real(dp), parameter :: most_error = 0.45_dp
  real(dp), parameter :: heavier = 1.001_dp        !! density over that below
  real(dp), parameter :: least_motion = 1.0e-6_dp  !! v^2 over g and the liquid's extent

contains

  !> Waves that the cells hardly resolve.
  subroutine judge_waves(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    real(dp) :: square, lost, late
    integer :: f
    if (.not. any(abs(scene%gravity) > 0.0_dp) .or. model%mesh%ndim == 1) return
    do f = 1, size(model%fields)
      if (.not. any(law_liquid(model%bodies%law) .and. .not. model%bodies%rigid .and. &
                    model%bodies%field == f)) cycle
      square = wave_number(scene, model, f)
      lost = square*merge(wave_weight, noisy_weight, any(scene%method%kind == [method_sgmp, &
                                                                               method_bspline]))
      late = merge(growth_weight*sqrt(square), 0.0_dp, is_top_heavy(scene, model, f))
      if (max(lost, late) < least_told) cycle
      text = 'waves of the liquid are about '// &
             real_text_about(2.0_dp*acos(-1.0_dp)/sqrt(square))//' cells long: '
      if (late > lost) then
        text = text//'a denser fluid lies on a lighter one, and they grow too slowly'
      else
        text = text//'they are slower than they should be'
      end if
      call opinion%expect(min(most_error, max(least_error, lost, late)), &
                          text//'; use smaller cells')
      return
    end do
  end subroutine judge_waves

  !> Whether a fluid of a field begins above another that is lighter, by the middles of the boxes
  !! around them.
  pure function is_top_heavy(scene, model, f) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    logical :: yes
    real(dp) :: lower(3), upper(3), height(size(scene%bodies))
    logical :: own(size(scene%bodies))
    integer :: b, n
    n = model%mesh%ndim
    own = .false.
    height = 0.0_dp
    do b = 1, size(scene%bodies)
      associate (body => model%bodies(b))
        if (.not. allocated(scene%bodies(b)%shapes)) cycle
        own(b) = body%field == f .and. law_is_spherical(body%law) .and. &
                 body%law%kind /= material_explosive
      end associate
      call shapes_box(scene%bodies(b)%shapes, lower, upper)
      height(b) = -dot_product(scene%gravity(:n), lower(:n) + upper(:n))
    end do
    yes = .false.
    associate (density => model%bodies(:size(own))%law%density)
      do b = 1, size(own)
        if (own(b)) yes = yes .or. any(own .and. height > height(b) .and. &
                                       density > heavier*density(b))
      end do
    end associate
  end function is_top_heavy

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
