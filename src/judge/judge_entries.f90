!> What rigid bodies that are driven into a liquid at rest say about a run (doc/verdict.md).
!!
!! Water and body meet in a layer a cell thick, and the water comes and goes there, so that forces
!! scatter. How much water moves with the body tells how fine the scene is: the impulse over speed
!! and density is a volume of n cells along each axis. Forces of wedges of 20 to 30 degrees, n from
!! 13 to 55, are off by up to 14 %, half of them by less than 3 % (class Slam of the random scenes).
module sgmp_judge_entries
  use sgmp_constitutive, only: law_liquid
  use sgmp_fast_scenes, only: speed_at_start
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_space, only: space_axisymmetric
  use sgmp_text, only: real_text_about
  implicit none
  private
  public :: is_pool, judge_entries

  real(dp), parameter :: way = 3.6_dp            !! error times cells
  real(dp), parameter :: covers = 0.9_dp         !! part of a liquid's width that pushes all of it
  real(dp), parameter :: least_error = 0.1_dp, most_error = 0.45_dp, enough = 70.0_dp

contains

  !> Rigid bodies, free or not, and others that are moved as a whole, which press on a liquid that
  !! rested at first.
  subroutine judge_entries(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells, velocity(3)
    integer :: p, b, t
    if (model%mesh%ndim == 1) return
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        b = findloc(pair%held, .true., dim=1)
        if (b == 0 .or. all(pair%held) .or. any(pair%body > size(scene%bodies))) cycle
        t = pair%body(3 - b)
        b = pair%body(b)
        if (.not. model%totals%bodies(b)%mass > 0.0_dp) cycle
        velocity = model%totals%bodies(b)%momentum/model%totals%bodies(b)%mass
        if (.not. is_pool(scene, model, b, t, velocity, covers)) cycle
        cells = cells_moved(model, norm2(pair%impulse), norm2(velocity), &
                            model%bodies(t)%law%density)
        if (.not. cells > 0.0_dp .or. cells >= enough) cycle
        call opinion%expect(max(least_error, min(most_error, way/cells)), &
                            "body '"//trim(model%bodies(b)%name)//"' moves as much of '"// &
                            trim(model%bodies(t)%name)//"' as is "//real_text_about(cells)// &
                            ' cells long and wide: its force scatters; use smaller cells')
        return
      end associate
    end do
  end subroutine judge_entries

  !> Whether a body is a liquid at rest that another one, which moves into it, does not push on as a
  !! whole, as a piston does: that is narrower, across its way, than a part of the liquid's width.
  pure logical function is_pool(scene, model, b, t, velocity, part) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b, t                  !! what moves; the liquid
    real(dp), intent(in) :: velocity(3)          !! of what moves
    real(dp), intent(in) :: part
    real(dp) :: own(3, 2), its(3, 2)
    integer :: d
    yes = law_liquid(model%bodies(t)%law) .and. &
          speed_at_start(scene, t, model%mesh%ndim) <= 0.0_dp .and. &
          allocated(scene%bodies(b)%shapes) .and. allocated(scene%bodies(t)%shapes)
    if (.not. yes) return
    call shapes_box(scene%bodies(b)%shapes, own(:, 1), own(:, 2))
    call shapes_box(scene%bodies(t)%shapes, its(:, 1), its(:, 2))
    yes = .false.
    do d = 1, model%mesh%ndim
      if (abs(velocity(d)) > 0.5_dp*norm2(velocity)) cycle
      yes = yes .or. own(d, 2) - own(d, 1) < part*(its(d, 2) - its(d, 1))
    end do
  end function is_pool

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
