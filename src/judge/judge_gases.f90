!> What gases that solids press, and charges that burn in them, say about a run (doc/verdict.md).
!!
!! Behind the shock of a round charge the gas is a thin layer, and its boundary with the products,
!! heavy against light, is unstable: on the grid it breaks into fingers which reach what the charge
!! stands before early and hit it in spots. A hollow ball of metal takes up to 54 % too large an
!! impulse from charges of 4 to 8 cells to the radius in dense gas, 13 % from those of 16, a tube up
!! to 9 % (class Shell of the random scenes, whose truth has one dimension and no fingers). In water
!! a hollow ball takes up to 13 % too large a velocity from charges of 8 cells (class Well).
!!
!! Gas between plates that fly at each other is pressed into few cells, and what it passes on of
!! their velocities is up to 13 % off where these are fewer than four (class Stack).
!!
!! Bubbles of gas in a liquid that goes on beyond the edges of the grid swing with 0.90, 0.90, 0.96,
!! 1.03, 1.03 of their period with 5, 6, 8, 10, 12 cells to the radius; with mpm and gimp, where
!! particles of gas beside those of the liquid take part in its motion, hardly at all.
!!
!! Plates of four cells that a charge drives through a liquid get up to 13 % too large or 9 % too
!! small a velocity, of six cells 6 % (class Sea).
module sgmp_judge_gases
  use sgmp_constitutive, only: law_gaseous, law_is_spherical, law_liquid, &
                               material_explosive
  use sgmp_kernels, only: method_bspline, method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: combine_union, shape_block
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: body_thickness
  implicit none
  private
  public :: is_round_charge, judge_bubbles, judge_charges, judge_cushions, judge_mines

  real(dp), parameter :: ball_weight = 5.0_dp, tube_weight = 1.2_dp  !! cells of the radius
  real(dp), parameter :: wet_weight = 1.1_dp           !! of a ball in a liquid
  real(dp), parameter :: least_told = 0.06_dp
  real(dp), parameter :: cushion_cells = 4.0_dp, cushion_error = 0.15_dp
  real(dp), parameter :: bubble_cells = 14.0_dp, bubble_error = 0.12_dp  !! across it
  real(dp), parameter :: mine_cells(2) = [5.0_dp, 7.0_dp], mine_error(2) = [0.15_dp, 0.1_dp]
  real(dp), parameter :: least_error = 0.1_dp, most_error = 0.6_dp

contains

  !> Round charges with few cells that burn in a gas.
  subroutine judge_charges(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells, lost, weight
    integer :: b
    weight = charge_weight(scene, model)
    if (.not. weight > 0.0_dp) return
    do b = 1, size(scene%bodies)
      if (.not. is_round_charge(scene, model, b)) cycle
      cells = 0.5_dp*body_thickness(scene%bodies(b)%shapes, model%mesh)
      lost = weight/cells
      if (lost < least_told) cycle
      call opinion%expect(min(most_error, max(least_error, lost)), &
                          "charge '"//trim(model%bodies(b)%name)//"' of "// &
                          real_text_about(cells)//' cells to its radius burns in a '// &
                          trim(merge('gas   ', 'liquid', any(is_gas(model))))//', where '// &
                          'its products break into fingers: impulses on what they hit want '// &
                          'smaller cells')
      return
    end do
  end subroutine judge_charges

  !> Thin solids that a charge drives through a liquid.
  subroutine judge_mines(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells
    integer :: b
    associate (bodies => model%bodies)
      if (.not. any(bodies%law%kind == material_explosive .and. .not. bodies%rigid)) return
      if (.not. any(law_liquid(bodies%law) .and. .not. bodies%rigid)) return
    end associate
    do b = 1, size(scene%bodies)
      if (model%bodies(b)%rigid .or. law_is_spherical(model%bodies(b)%law)) cycle
      cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
      if (cells >= mine_cells(2)) cycle
      call opinion%expect(merge(mine_error(1), mine_error(2), cells < mine_cells(1)), &
                          "body '"//trim(model%bodies(b)%name)//"' is "// &
                          real_text_about(cells)//' cells thick, and a charge drives it '// &
                          'through a liquid: use smaller cells')
      return
    end do
  end subroutine judge_mines

  !> Error of what a round charge does to what it hits, times the cells of its radius, by what is
  !! around it; 0: none is known.
  pure function charge_weight(scene, model) result(weight)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: weight
    logical :: ball
    weight = 0.0_dp
    if (model%mesh%ndim == 1) return
    ball = scene%axisymmetric .or. model%mesh%ndim == 3
    associate (bodies => model%bodies)
      if (any(is_gas(model))) then
        weight = merge(ball_weight, tube_weight, ball)
      else if (ball .and. any(law_liquid(bodies%law) .and. .not. bodies%rigid) .and. &
               any(bodies%rigid .or. .not. law_is_spherical(bodies%law))) then
        weight = wet_weight
      end if
    end associate
  end function charge_weight

  !> Gas that solids have pressed into few cells, where nothing burns.
  subroutine judge_cushions(opinion, scene, model, compression)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: compression  !! largest of all gas, density over that of the start
    real(dp) :: cells
    logical :: gas(size(model%bodies))
    integer :: b
    gas = is_gas(model)
    if (any(model%bodies%law%kind == material_explosive)) return
    if (all(gas .or. model%bodies%rigid)) return
    do b = 1, size(scene%bodies)
      if (.not. gas(b)) cycle
      cells = body_thickness(scene%bodies(b)%shapes, model%mesh)/max(1.0_dp, compression)
      if (cells >= cushion_cells) cycle
      call opinion%expect(cushion_error, "gas '"//trim(model%bodies(b)%name)//"' was pressed "// &
                          'into '//real_text_about(cells)//' cells: what it passes on wants '// &
                          'smaller cells')
      return
    end do
  end subroutine judge_cushions

  !> Bubbles of gas in a liquid between edges that let waves out.
  subroutine judge_bubbles(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells
    logical :: gas(size(model%bodies))
    integer :: b
    if (.not. (scene%grid%inertia .or. scene%grid%springs)) return
    if (model%mesh%ndim == 1 .or. .not. any(law_liquid(model%bodies%law))) return
    gas = is_gas(model)
    do b = 1, size(scene%bodies)
      if (.not. gas(b)) cycle
      cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
      if (all(scene%method%kind /= [method_sgmp, method_bspline])) then
        call opinion%object("gas '"//trim(model%bodies(b)%name)//"' in a liquid hardly swings "// &
                            'with this method: use sgmp')
      else if (cells < bubble_cells) then
        call opinion%expect(bubble_error, "gas '"//trim(model%bodies(b)%name)//"' is "// &
                            real_text_about(cells)//' cells across in a liquid: the period '// &
                            'with which it swings wants smaller cells')
      end if
      return
    end do
  end subroutine judge_bubbles

  !> Which bodies are gas from the start.
  pure function is_gas(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes(size(model%bodies))
    yes = law_gaseous(model%bodies%law) .and. model%bodies%law%kind /= material_explosive .and. &
          .not. model%bodies%rigid
  end function is_gas

  !> Whether a body burns and is none of blocks.
  pure logical function is_round_charge(scene, model, b) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    yes = model%bodies(b)%law%kind == material_explosive .and. .not. model%bodies(b)%rigid
    if (yes) yes = allocated(scene%bodies(b)%shapes)
    if (yes) yes = any(scene%bodies(b)%shapes%kind /= shape_block .and. &
                       scene%bodies(b)%shapes%combine == combine_union)
  end function is_round_charge

end module sgmp_judge_gases
