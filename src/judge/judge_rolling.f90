!> What round bodies that roll or slide on others say about a run (doc/verdict.md).
!!
!! A curved surface of particles is a staircase, and contact finds it at nodes: pressure under it is
!! ragged and turns what rolls to and fro. Disks and balls of 12 to 24 cells across that an incline
!! draws down are off by up to 12 % in their velocity and 26 % in their spin, with gimp and bspline
!! by twice the first (class Roll of the random scenes); where friction is so small that they slide,
!! more of the spin is noise.
module sgmp_judge_rolling
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_kernels, only: method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: combine_union, shape_sphere
  use sgmp_space, only: space_axisymmetric
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: body_thickness
  implicit none
  private
  public :: judge_rolling

  real(dp), parameter :: fair_cells = 32.0_dp    !! across
  real(dp), parameter :: error_sgmp = 0.3_dp, error_other = 0.35_dp
  real(dp), parameter :: least_way = 1.0_dp      !! cells, at the velocity of the end
  real(dp), parameter :: least_rubbed = 1.0e-3_dp  !! impulse along the surfaces, over all of it

contains

  !> Round bodies that roll on something at the end.
  subroutine judge_rolling(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells
    integer :: p, side, b
    if (model%mesh%ndim == 1 .or. model%mesh%space == space_axisymmetric) return
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (pair%touching == 0 .or. pair%family > 0) cycle
        if (.not. norm2(pair%friction_impulse) > least_rubbed*norm2(pair%impulse)) cycle
        do side = 1, 2
          b = pair%body(side)
          if (b > size(scene%bodies)) cycle
          if (.not. rolls(scene, model, b)) cycle
          cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
          if (cells >= fair_cells) cycle
          call opinion%expect(merge(error_sgmp, error_other, scene%method%kind == method_sgmp), &
                              "body '"//trim(model%bodies(b)%name)//"', "// &
                              real_text_about(cells)//' cells across, rolls or slides on '// &
                              "'"//trim(model%bodies(pair%body(3 - side))%name)//"': its spin "// &
                              'wants smaller cells')
          return
        end do
      end associate
    end do
  end subroutine judge_rolling

  !> Whether a body is a solid ball or disk that moves.
  pure function rolls(scene, model, b) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    logical :: yes
    yes = .not. (model%bodies(b)%rigid .or. law_is_spherical(model%bodies(b)%law))
    if (yes) yes = allocated(scene%bodies(b)%shapes)
    if (yes) yes = any(scene%bodies(b)%shapes%kind == shape_sphere .and. &
                       scene%bodies(b)%shapes%combine == combine_union)
    if (yes) yes = norm2(model%totals%bodies(b)%momentum)*model%clock%time > &
                   least_way*model%mesh%h*model%totals%bodies(b)%mass
  end function rolls

end module sgmp_judge_rolling
