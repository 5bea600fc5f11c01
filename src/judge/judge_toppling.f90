!> What bodies that stood and turn over say about a run (doc/verdict.md).
!!
!! A block that topples turns about the middle of the particle at its edge: of n cells across it has
!! 1/(2 n) less that rights it, and its angle is off by up to 1.7/n where little more than that
!! pushed it (class Topple of the random scenes). Without exact rotation the grid strains what
!! turns, and a stiff block does not topple at all (doc/rotation.md).
module sgmp_judge_toppling
  use sgmp_angular_momentum, only: angular_momentum_of, angular_momentum_t
  use sgmp_constitutive, only: law_bends, law_wave_modulus
  use sgmp_kernels, only: method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_rolling, only: scene_rubbed
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: combine_union, shape_block, shapes_box
  use sgmp_space, only: space_axisymmetric
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: body_thickness
  implicit none
  private
  public :: judge_toppling

  real(dp), parameter :: least_angle = 0.05_dp   !! by the rate at the end, in the time of the run
  real(dp), parameter :: coherent = 0.25_dp      !! of the moment if all turned the same way
  real(dp), parameter :: least_turning = 0.05_dp  !! of the energy; a quarter, where an edge rests
  real(dp), parameter :: edge_error = 1.7_dp, fair_cells = 34.0_dp
  real(dp), parameter :: least_rubbed = 1.0e-3_dp  !! impulse along the surfaces, over all of it
  !> Energy of false strains over rho c^2, for an angle of 1 (measured: block of 1 by 3, 8 cells).
  real(dp), parameter :: false_strain = 9.0e-6_dp
  real(dp), parameter :: least_strained = 1.0_dp   !! that energy over the kinetic one

contains

  !> Blocks that turn at the end, under gravity, and stand on a floor of the grid or on a body.
  subroutine judge_toppling(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer :: b
    if (model%mesh%ndim == 1 .or. model%mesh%space == space_axisymmetric) return
    if (scene%method%kind /= method_sgmp) return
    if (all(abs(scene%gravity) <= 0.0_dp) .and. size(scene%bodyforces) == 0) return
    do b = 1, size(scene%bodies)
      if (.not. (any(scene%grid%floor) .or. rubs(model, b))) cycle
      if (.not. stands(scene, model, b)) cycle
      if (.not. turns(scene, model, b)) cycle
      call tell(opinion, scene, model, b)
      return
    end do
  end subroutine judge_toppling

  !> What it says of one that turns.
  subroutine tell(opinion, scene, model, b)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: cells
    cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
    if (rubs(model, b) .and. .not. scene%method%rotation .and. stiff(model, b)) then
      call opinion%object("body '"//trim(model%bodies(b)%name)//"' turns over and is stiff: "// &
                          'without exact rotation the grid strains what turns, and holds it; '// &
                          remedy(scene))
    else if (cells < fair_cells) then
      call opinion%expect(edge_error/cells, "body '"//trim(model%bodies(b)%name)//"', "// &
                          real_text_about(cells)//' cells across, turns over: the edge it '// &
                          'turns on wants smaller cells')
    end if
  end subroutine tell

  !> What to do against it: beside a part that is moved exact rotation is refused.
  function remedy(scene) result(text)
    type(scene_t), intent(in) :: scene
    character(:), allocatable :: text
    integer :: m
    text = 'method sgmp rotation=exact (doc/rotation.md)'
    do m = 1, size(scene%motions)
      if (scene_rubbed(scene, scene%motions(m)%body) == 0) cycle
      text = 'hold what it stands on by walls of the grid, or make it rigid, not by a card '// &
             'motion, beside which there is none (doc/rotation.md)'
      return
    end do
  end function remedy

  !> Whether a body has rubbed on another.
  pure logical function rubs(model, b) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    integer :: p
    yes = .false.
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (all(pair%body /= b)) cycle
        yes = yes .or. norm2(pair%friction_impulse) > least_rubbed*norm2(pair%impulse)
      end associate
    end do
  end function rubs

  !> Whether a body is a solid block with a velocity field of its own.
  pure function stands(scene, model, b) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    logical :: yes
    yes = .not. model%bodies(b)%rigid .and. law_bends(model%bodies(b)%law) .and. &
          count(model%bodies%field == model%bodies(b)%field) == 1
    if (yes) yes = allocated(scene%bodies(b)%shapes)
    if (yes) yes = any(scene%bodies(b)%shapes%kind == shape_block .and. &
                       scene%bodies(b)%shapes%combine == combine_union)
  end function stands

  !> Whether it turns as a whole at the end.
  function turns(scene, model, b) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    logical :: yes
    type(angular_momentum_t) :: now
    real(dp) :: lower(3), upper(3), inertia
    integer :: n
    n = model%mesh%ndim
    call angular_momentum_of(model%mesh, model%bodies, model%totals%bodies, &
                             model%bodies(b)%field, now)
    call shapes_box(scene%bodies(b)%shapes, lower, upper)
    inertia = model%totals%bodies(b)%mass*sum((upper(:n) - lower(:n))**2)/12.0_dp
    yes = norm2(now%vector) > coherent*now%largest .and. &
          norm2(now%vector)*model%clock%time > least_angle*inertia .and. &
          0.5_dp*norm2(now%vector)**2 > least_turning*inertia*model%totals%bodies(b)%kinetic
  end function turns

  !> Whether false strains would take the energy of its motion.
  pure logical function stiff(model, b) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    associate (own => model%totals%bodies(b), law => model%bodies(b)%law)
      yes = false_strain*law_wave_modulus(law)/law%density*own%mass > least_strained*own%kinetic
    end associate
  end function stiff

end module sgmp_judge_toppling
