!> What round bodies that roll or slide on others say about a run (doc/verdict.md).
!!
!! A curved surface of particles is a staircase, and contact finds it at nodes: pressure under it is
!! ragged and turns what rolls to and fro. Disks and balls of 12 to 24 cells across that an incline
!! draws down are off by up to 12 % in their velocity and 26 % in their spin, with gimp and bspline
!! by twice the first (class Roll of the random scenes); where friction is so small that they slide,
!! more of the spin is noise.
!!
!! On rough walls of the grid that let go they roll on their round surface (sgmp_one_sided), disks
!! to 3 %, balls of 12 cells across to 5 %, in their spin to 12; without exact rotation a disk of 10
!! cells is 10 % behind. What falls on one first comes back too slow, for it touches it with single
!! particles.
module sgmp_judge_rolling
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_kernels, only: method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_pulls, scene_t
  use sgmp_shapes, only: combine_union, shapes_box, shapes_rim
  use sgmp_space, only: space_axisymmetric
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: body_thickness
  use sgmp_turn, only: turn_box, turn_direction, turn_inverse
  implicit none
  private
  public :: judge_rolling

  real(dp), parameter :: fair_cells = 32.0_dp    !! across
  real(dp), parameter :: error_sgmp = 0.3_dp, error_other = 0.35_dp
  real(dp), parameter :: fallen_error = 1.2_dp   !! times a cell, over the thickness
  real(dp), parameter :: fallen_cells = 20.0_dp
  real(dp), parameter :: ball_error = 0.15_dp, ball_cells = 16.0_dp
  real(dp), parameter :: standing = 0.02_dp      !! gap (cells) of what begins on a wall
  real(dp), parameter :: least_way = 1.0_dp      !! cells, at the velocity of the end
  real(dp), parameter :: least_rubbed = 1.0e-3_dp  !! impulse along the surfaces, over all of it

contains

  !> Round bodies that roll on something at the end.
  subroutine judge_rolling(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    if (model%mesh%ndim == 1 .or. model%mesh%space == space_axisymmetric) return
    call judge_bodies(opinion, scene, model)
    call judge_walls(opinion, scene, model)
  end subroutine judge_rolling

  !> On other bodies.
  subroutine judge_bodies(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells
    integer :: p, side, b
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (pair%family > 0) cycle
        if (pair%touching == 0 .and. .not. scene_pulls(scene)) cycle  ! it may hop
        if (.not. norm2(pair%friction_impulse) > least_rubbed*norm2(pair%impulse)) cycle
        do side = 1, 2
          b = pair%body(side)
          if (b > size(scene%bodies)) cycle
          if (.not. (is_round(scene, model, b, pair%impulse) .and. moves(model, b))) cycle
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
  end subroutine judge_bodies

  !> On rough walls of the grid.
  subroutine judge_walls(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells
    integer :: b, w
    do b = 1, size(scene%bodies)
      do w = 1, size(model%bodies(b)%walls)
        associate (wall => model%bodies(b)%walls(w))
          if (wall%rim == 0 .or. .not. moves(model, b)) cycle
          if (falls(scene, model, b, wall%axis)) cycle
          cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
          if (scene%method%kind == method_sgmp .and. .not. scene%method%rotation) then
            if (cells < fair_cells) call tell(error_sgmp, 'rolls on', 'way wants rotation=exact')
          else if (.not. begins_on(scene, model, b, wall%axis, wall%side)) then
            if (cells < fallen_cells) call tell(fallen_error/cells, 'falls on', &
                                                'velocity after it wants smaller cells')
          else if (model%mesh%ndim == 3 .and. cells < ball_cells) then
            call tell(ball_error, 'rolls on', 'spin wants smaller cells')
          end if
        end associate
      end do
    end do

  contains

    subroutine tell(error, meets, wants)
      real(dp), intent(in) :: error
      character(*), intent(in) :: meets, wants
      call opinion%expect(error, "body '"//trim(model%bodies(b)%name)//"', "// &
                          real_text_about(cells)//' cells across, '//meets// &
                          ' a rough wall: its '//wants)
    end subroutine tell

  end subroutine judge_walls

  !> Whether a body falls freely along an axis, as far as its velocity at the end tells.
  pure function falls(scene, model, b, axis) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b, axis
    logical :: yes
    real(dp), parameter :: nearly = 0.05_dp
    real(dp) :: fallen
    associate (start => scene%bodies(b)%velocity(axis), sums => model%totals%bodies(b))
      yes = start%is_constant .and. size(scene%bodyforces) == 0
      if (.not. yes) return
      fallen = scene%gravity(axis)*model%clock%time
      yes = abs(sums%momentum(axis) - sums%mass*(start%value + fallen)) <= &
            nearly*sums%mass*(abs(start%value) + abs(fallen))
    end associate
  end function falls

  !> Whether a body begins at a wall.
  pure function begins_on(scene, model, b, axis, side) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b, axis, side
    logical :: yes
    real(dp) :: lower(3), upper(3)
    call shapes_box(scene%bodies(b)%shapes, lower, upper)
    call turn_box(scene%bodies(b)%turn, lower, upper)
    if (side == 1) then
      yes = lower(axis) - scene%grid%lower(axis) < standing*model%mesh%h
    else
      yes = scene%grid%upper(axis) - upper(axis) < standing*model%mesh%h
    end if
  end function begins_on

  !> Whether a body is a solid that is round where something presses on it: a ball, or a disk, a
  !! cylinder, a tube on its side.
  pure function is_round(scene, model, b, impulse) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: impulse(3)
    logical :: yes
    real(dp), parameter :: aslant = 0.5_dp
    integer :: i
    yes = .false.
    associate (card => scene%bodies(b))
      if (model%bodies(b)%rigid .or. law_is_spherical(model%bodies(b)%law)) return
      if (.not. allocated(card%shapes)) return
      do i = 1, size(card%shapes)                ! one that is round is enough, of several
        if (card%shapes(i)%combine /= combine_union) cycle
        yes = yes .or. shapes_rim(card%shapes(i:i), &
                                  turn_direction(turn_inverse(card%turn), impulse), &
                                  aslant*norm2(impulse))
      end do
    end associate
  end function is_round

  !> Whether it goes on by more than a cell in as long a time again.
  pure logical function moves(model, b) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    yes = norm2(model%totals%bodies(b)%momentum)*model%clock%time > &
          least_way*model%mesh%h*model%totals%bodies(b)%mass
  end function moves

end module sgmp_judge_rolling
