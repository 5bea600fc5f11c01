!> What rigid bodies that are driven into a liquid at rest say about a run (doc/verdict.md).
!!
!! Water and body meet somewhat before they touch, and force and impulse are too large at first. How
!! much water moves with the body tells how far it is: the impulse over speed and density is a
!! volume, whose side of n cells goes with an error of up to 4/n (wedges of 20 to 30 degrees, 6 to
!! 16 cells deep; class Slam of the random scenes).
module sgmp_judge_entries
  use sgmp_constitutive, only: law_liquid
  use sgmp_fast_scenes, only: speed_at_start
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_space, only: space_axisymmetric
  use sgmp_text, only: real_text_about
  implicit none
  private
  public :: judge_entries

  real(dp), parameter :: way = 4.0_dp            !! error times cells
  real(dp), parameter :: least_told = 0.06_dp, least_error = 0.1_dp

contains

  !> Rigid bodies that move as prescribed and press on a liquid that rested at first.
  subroutine judge_entries(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells
    integer :: p, b, t
    if (model%mesh%ndim == 1) return
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        b = findloc(pair%held, .true., dim=1)
        if (b == 0 .or. all(pair%held) .or. any(pair%body > size(scene%bodies))) cycle
        t = pair%body(3 - b)
        b = pair%body(b)
        if (.not. law_liquid(model%bodies(t)%law)) cycle
        if (speed_at_start(scene, t, model%mesh%ndim) > 0.0_dp) cycle
        cells = cells_moved(model, norm2(pair%impulse), norm2(model%bodies(b)%speed), &
                            model%bodies(t)%law%density)
        if (.not. cells > 0.0_dp .or. way/max(cells, 1.0_dp) <= least_told) cycle
        call opinion%expect(max(least_error, way/max(cells, way)), &
                            "body '"//trim(model%bodies(b)%name)//"' moves as much of '"// &
                            trim(model%bodies(t)%name)//"' as is "//real_text_about(cells)// &
                            ' cells long and wide: its force is too large; use smaller cells')
        return
      end associate
    end do
  end subroutine judge_entries

  !> Side, in cells, of the volume of a liquid that an impulse brings to a speed; 0 for none.
  pure function cells_moved(model, impulse, speed, density) result(cells)
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: impulse, speed, density
    real(dp) :: cells
    integer :: n
    n = merge(3, model%mesh%ndim, model%mesh%space == space_axisymmetric)
    cells = 0.0_dp
    if (.not. impulse > 0.0_dp .or. .not. speed > 0.0_dp) return
    cells = (impulse/(speed*density))**(1.0_dp/n)*model%mesh%inverse_h
  end function cells_moved

end module sgmp_judge_entries
