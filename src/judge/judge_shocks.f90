!> What shocks that charges send through liquids say about a run (doc/verdict.md).
!!
!! The pressure behind the front of a round charge under water falls by 1/e over about 2.2 radii
!! a of the charge. The front itself is spread by the viscosity: its width grows as the root of
!! its way, sigma^2 = 0.17 l h R with the linear coefficient l, cells of side h and the way R,
!! and takes a part of the peak, up to 0.30 sqrt(l R/h)/(a/h). Measured beside a code in one
!! dimension, 1 kg of TNT, 0.5 and 1 m from it: with l = 0.3 peaks lack 0.34, 0.26, 0.18, 0.14
!! and 0.37, 0.30, 0.24, 0.20 with 2.6, 3.5, 5.3, 7.0 cells to the radius. A smaller coefficient
!! lets the front overshoot: with 0.06 peaks are 0.19 too high with seven cells, with 0.02 0.3.
module sgmp_judge_shocks
  use sgmp_constitutive, only: law_is_spherical, law_liquid
  use sgmp_judge_gases, only: is_round_charge
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box, shapes_inside
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: body_thickness
  use sgmp_turn, only: turn_back
  implicit none
  private
  public :: judge_shocks

  real(dp), parameter :: spread = 0.30_dp
  real(dp), parameter :: overshoot = 0.35_dp, damps = 0.12_dp  !! linear coefficient by 1/e
  real(dp), parameter :: enough = 0.16_dp       !! linear coefficient: less is not advised
  real(dp), parameter :: least_told = 0.06_dp, least_error = 0.1_dp, most_error = 0.5_dp

contains

  !> Round charges in liquids: peaks at gauges, or anywhere where nothing but fluids is there.
  subroutine judge_shocks(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells, way, lost, over
    character(:), allocatable :: text
    integer :: b, l
    if (model%mesh%ndim == 1 .or. model%mesh%ndim == 2 .and. .not. scene%axisymmetric) return
    do b = 1, size(scene%bodies)
      if (.not. is_round_charge(scene, model, b)) cycle
      cells = 0.5_dp*body_thickness(scene%bodies(b)%shapes, model%mesh)
      do l = 1, size(scene%bodies)
        if (model%bodies(l)%rigid .or. .not. law_liquid(model%bodies(l)%law)) cycle
        way = way_of_front(scene, model, b, l)/model%mesh%h
        if (way <= cells) cycle
        associate (linear => model%bodies(l)%law%viscosity%linear)
          lost = spread*sqrt(linear*way)/cells
          over = overshoot*exp(-linear/damps)
          text = fault(lost > over, linear > enough)
        end associate
        if (max(lost, over) < least_told) cycle
        call opinion%expect(min(most_error, max(least_error, lost, over)), &
                            "the shock of charge '"//trim(model%bodies(b)%name)//"', "// &
                            real_text_about(cells)//" cells to its radius, in '"// &
                            trim(model%bodies(l)%name)//"' "//text)
        return
      end do
    end do
  end subroutine judge_shocks

  !> What is wrong with it, and what helps.
  function fault(low, thick) result(text)
    logical, intent(in) :: low                   !! peaks are too low, not too high
    logical, intent(in) :: thick                 !! and less viscosity would help
    character(:), allocatable :: text
    if (low) then
      text = 'is spread by viscosity, and its peaks are too low: use smaller cells'
      if (thick) text = text//', or viscosity all quadratic=1.5 linear=0.15'
    else
      text = 'overshoots, and its peaks are too high: viscosity all wants a larger linear='
    end if
  end function fault

  !> How far the front of a charge has come in a liquid, but not farther than the last gauge in it
  !! where there are any; 0 where solids are what counts.
  function way_of_front(scene, model, charge, liquid) result(way)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: charge, liquid        !! bodies
    real(dp) :: way
    real(dp) :: lower(3), upper(3), centre(3), point(3)
    integer :: g, n
    n = model%mesh%ndim
    way = 0.0_dp
    if (.not. allocated(scene%bodies(liquid)%shapes)) return
    call shapes_box(scene%bodies(charge)%shapes, lower, upper)
    centre = 0.5_dp*(lower + upper)
    do g = 1, size(scene%gauges)
      point = scene%gauges(g)%point
      call turn_back(scene%bodies(liquid)%turn, point)
      if (.not. shapes_inside(scene%bodies(liquid)%shapes, point, n, 0.0_dp)) cycle
      way = max(way, norm2(scene%gauges(g)%point(:n) - centre(:n)))
    end do
    if (.not. way > 0.0_dp) then
      if (any(model%bodies%rigid .or. .not. law_is_spherical(model%bodies%law))) return
      call shapes_box(scene%bodies(liquid)%shapes, lower, upper)
      way = norm2(max(abs(lower(:n) - centre(:n)), abs(upper(:n) - centre(:n))))
    end if
    way = min(way, model%bodies(liquid)%law%bulk_speed*model%clock%time)
  end function way_of_front

end module sgmp_judge_shocks
