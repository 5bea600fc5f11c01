!> Which symmetries a scene has by its cards: planes of which one side is the image of the other,
!! axes along which nothing changes, an axis of revolution.
!!
!! Shapes are compared by what their cards say, formulas at many places and times. Where that is
!! not plain, and where something is drawn by chance, the answer is no.
module sgmp_scene_symmetry
  use sgmp_expression, only: expression_t
  use sgmp_features, only: features_walls_act
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_blast, load_force, load_pressure, load_traction
  use sgmp_mesh, only: wall_free, wall_slip
  use sgmp_scene, only: body_card_t, detonation_card_t, grid_card_t, load_card_t, scene_t
  use sgmp_shape_symmetry, only: shapes_mirrored, shapes_revolved, shapes_uniform
  use sgmp_shapes, only: shapes_box
  use sgmp_turn, only: turn_turns
  implicit none
  private
  public :: scene_mirrored, scene_plain, scene_revolved, scene_uniform

  real(dp), parameter :: noticed = 1.0e-6_dp   !! cells that do not count
  integer, parameter :: samples = 64           !! places and times at which formulas are compared
  ! Parts of their whole multiples are spread evenly: they are irrational.
  real(dp), parameter :: shares(3) = [0.7548776662_dp, 0.5698402910_dp, 0.3819660113_dp]
  real(dp), parameter :: golden = 0.6180339887_dp
  integer, parameter :: image_even = 1, image_odd = 2, image_same = 3
    !! of a formula at the image of a place: the same, the opposite; everywhere along the axis

contains

  !> Whether nothing of a scene is drawn by chance, comes from files or is stressed at the start,
  !! and no wall moves or rubs: only of such scenes more is said.
  pure function scene_plain(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b
    yes = size(scene%bodies) > 0 .and. .not. features_walls_act(scene%features)
    yes = yes .and. all(zero(reshape(scene%grid%wall_velocity, [18])))
    do b = 1, size(scene%bodies)
      associate (law => scene%materials(scene%bodies(b)%material)%law)
        yes = yes .and. body_plain(scene%bodies(b)) .and. law%scatter%weibull <= 0.0_dp .and. &
              law%failure%weibull <= 0.0_dp .and. law%failure%flaws%number <= 0.0_dp
      end associate
      if (.not. yes) return
    end do
    yes = yes .and. .not. any(scene%loads%kind == load_force)
    yes = yes .and. .not. any(scene%motions%turns)
  end function scene_plain

  !> Whether a body is made of shapes in their places and does not turn.
  pure function body_plain(body) result(yes)
    type(body_card_t), intent(in) :: body
    logical :: yes
    yes = allocated(body%shapes) .and. .not. turn_turns(body%turn) .and. &
          .not. body%stress%given .and. body%jitter <= 0.0_dp .and. body%mass <= 0.0_dp .and. &
          all(abs(body%spin_at_start) <= 0.0_dp) .and. all(zero(body%omega))
  end function body_plain

  !> Whether one side of a plane across an axis is the image of the other.
  function scene_mirrored(scene, axis, plane) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane        !! place along the axis (length)
    logical :: yes
    real(dp) :: slack
    integer :: i
    slack = noticed*scene%grid%cell
    yes = grid_mirrored(scene%grid, axis, plane, slack) .and. abs(scene%gravity(axis)) <= 0.0_dp
    do i = 1, size(scene%bodies)
      if (yes) yes = body_mirrored(scene, i, axis, plane, slack)
    end do
    do i = 1, size(scene%bodyforces)
      if (yes) yes = vector_alike(scene, scene%bodyforces(i)%body, scene%bodyforces(i)%force, &
                                  axis, plane)
    end do
    do i = 1, size(scene%loads)
      if (yes) yes = load_mirrored(scene, scene%loads(i), axis, plane, slack)
    end do
    do i = 1, size(scene%motions)
      associate (motion => scene%motions(i))
        if (yes) yes = zero(motion%velocity(axis)) .and. &
                       alike(scene, motion%body, motion%where, axis, plane, image_even)
      end associate
    end do
    do i = 1, size(scene%detonations)
      yes = yes .and. detonation_mirrored(scene%detonations(i), axis, plane, slack)
    end do
  end function scene_mirrored

  function body_mirrored(scene, b, axis, plane, slack) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, axis
    real(dp), intent(in) :: plane, slack
    logical :: yes
    associate (body => scene%bodies(b))
      yes = shapes_mirrored(body%shapes, axis, plane, slack) .and. zero(body%motion(axis))
      if (yes) yes = vector_alike(scene, b, body%velocity, axis, plane) .and. &
                     alike(scene, b, body%spin, axis, plane, image_even)
    end associate
  end function body_mirrored

  pure function detonation_mirrored(light, axis, plane, slack) result(yes)
    type(detonation_card_t), intent(in) :: light
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane, slack
    logical :: yes
    if (light%plane) then
      yes = abs(light%normal(axis)) <= 0.0_dp
    else
      yes = abs(light%point(axis) - plane) <= slack
    end if
  end function detonation_mirrored

  !> Whether the two ends of the grid along an axis are images of each other.
  pure function grid_mirrored(grid, axis, plane, slack) result(yes)
    type(grid_card_t), intent(in) :: grid
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane, slack
    logical :: yes
    yes = grid%open(1, axis) .eqv. grid%open(2, axis)
    yes = yes .and. grid%wall(1, axis) == grid%wall(2, axis) .and. &
          (grid%one_sided(1, axis) .eqv. grid%one_sided(2, axis))
    if (yes .and. (grid%one_sided(1, axis) .or. .not. grid%open(1, axis))) then
      yes = abs(0.5_dp*(grid%lower(axis) + grid%upper(axis)) - plane) <= slack
    end if
  end function grid_mirrored

  function load_mirrored(scene, load, axis, plane, slack) result(yes)
    type(scene_t), intent(in) :: scene
    type(load_card_t), intent(in) :: load
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane, slack
    logical :: yes
    yes = .not. (load%axis == axis .and. load%side > 0)
    if (yes) yes = alike(scene, load%body, load%where, axis, plane, image_even)
    if (.not. yes) return
    select case (load%kind)
    case (load_pressure)
      yes = alike(scene, load%body, load%value(1), axis, plane, image_even)
    case (load_traction)
      yes = vector_alike(scene, load%body, load%value, axis, plane)
    case (load_blast)
      yes = abs(load%point(axis) - plane) <= slack
    case default
      yes = .false.
    end select
  end function load_mirrored

  !> Whether nothing changes along an axis, which begins and ends with slip walls that all bodies
  !! reach: the scene is one of fewer dimensions.
  function scene_uniform(scene, axis) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    logical :: yes
    integer :: i
    associate (grid => scene%grid)
      yes = all(grid%wall(:, axis) == wall_slip) .and. .not. any(grid%open(:, axis)) .and. &
            abs(scene%gravity(axis)) <= 0.0_dp .and. size(scene%detonations) == 0 .and. &
            size(scene%loads) == 0 .and. size(scene%motions) == 0
      do i = 1, size(scene%bodies)
        if (.not. yes) return
        associate (body => scene%bodies(i))
          yes = shapes_uniform(body%shapes, axis, [grid%lower(axis), grid%upper(axis)], &
                               noticed*grid%cell) .and. zero(body%motion(axis)) .and. &
                .not. body%free
          if (yes) yes = vector_uniform(scene, i, body%velocity, axis)
        end associate
      end do
      do i = 1, size(scene%bodyforces)
        associate (push => scene%bodyforces(i))
          if (yes) yes = vector_uniform(scene, push%body, push%force, axis)
        end associate
      end do
    end associate
  end function scene_uniform

  !> Whether a vector is the same all along an axis, and lies across it.
  function vector_uniform(scene, body, vector, axis) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body          !! 0: all
    type(expression_t), intent(in) :: vector(3)
    integer, intent(in) :: axis
    logical :: yes
    integer :: a
    yes = zero(vector(axis))
    do a = 1, 3
      if (yes) yes = alike(scene, body, vector(a), axis, 0.0_dp, image_same)
    end do
  end function vector_uniform

  !> Whether all bodies are round about one line along an axis and move along it, whole or cut by
  !! slip walls in the line: the scene is an axisymmetric one.
  function scene_revolved(scene, axis, line) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3)      !! a point of it (length)
    logical :: yes
    logical :: cut(2, 3)
    real(dp) :: slack
    integer :: i
    slack = noticed*scene%grid%cell
    call cut_by_walls(scene%grid, axis, line, slack, cut)
    yes = size(scene%motions) == 0 .and. size(scene%bodyforces) == 0 .and. &
          all(held_by_none(scene%grid%wall, scene%grid%one_sided) .or. cut .or. &
              spread(axis_is(axis), 1, 2)) .and. &
          all(abs(scene%gravity) <= 0.0_dp .or. axis_is(axis))
    do i = 1, size(scene%bodies)
      if (yes) yes = body_revolved(scene%bodies(i), axis, line, cut, slack)
    end do
    do i = 1, size(scene%loads)
      yes = yes .and. load_revolved(scene%loads(i), axis, line, slack)
    end do
    do i = 1, size(scene%detonations)
      yes = yes .and. detonation_revolved(scene%detonations(i), axis, line, slack)
    end do
  end function scene_revolved

  !> Ends of the grid that have no wall.
  elemental function held_by_none(wall, one_sided) result(yes)
    integer, intent(in) :: wall
    logical, intent(in) :: one_sided
    logical :: yes
    yes = wall == wall_free .and. .not. one_sided
  end function held_by_none

  !> Which slip walls lie in a line along an axis.
  pure subroutine cut_by_walls(grid, axis, line, slack, cut)
    type(grid_card_t), intent(in) :: grid
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3), slack
    logical, intent(out) :: cut(2, 3)    !! (lower|upper, axis)
    cut(1, :) = abs(grid%lower - line) <= slack
    cut(2, :) = abs(grid%upper - line) <= slack
    cut = cut .and. grid%wall == wall_slip
    cut(:, axis) = .false.
  end subroutine cut_by_walls

  pure function body_revolved(body, axis, line, cut, slack) result(yes)
    type(body_card_t), intent(in) :: body
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3), slack
    logical, intent(in) :: cut(2, 3)
    logical :: yes
    yes = shapes_revolved(body%shapes, axis, line, cut, slack) .and. &
          all((zero(body%velocity) .and. zero(body%motion)) .or. axis_is(axis)) .and. &
          body%velocity(axis)%is_constant
  end function body_revolved

  pure function load_revolved(load, axis, line, slack) result(yes)
    type(load_card_t), intent(in) :: load
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3), slack
    logical :: yes
    yes = load%kind == load_blast .and. load%where%is_constant .and. &
          (load%axis == axis .or. load%axis == 0) .and. &
          all(abs(load%point - line) <= slack .or. axis_is(axis))
  end function load_revolved

  pure function detonation_revolved(light, axis, line, slack) result(yes)
    type(detonation_card_t), intent(in) :: light
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3), slack
    logical :: yes
    if (light%plane) then
      yes = all(abs(light%normal) <= 0.0_dp .or. axis_is(axis))
    else
      yes = all(abs(light%point - line) <= slack .or. axis_is(axis))
    end if
  end function detonation_revolved

  !> Which of the axes is one of them.
  pure function axis_is(axis) result(yes)
    integer, intent(in) :: axis
    logical :: yes(3)
    yes = [1, 2, 3] == axis
  end function axis_is

  !> Whether a vector is that of the image: its component across the plane is the opposite.
  function vector_alike(scene, body, vector, axis, plane) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body          !! 0: all
    type(expression_t), intent(in) :: vector(3)
    integer, intent(in) :: axis
    real(dp), intent(in) :: plane
    logical :: yes
    integer :: a
    yes = .true.
    do a = 1, 3
      if (yes) yes = alike(scene, body, vector(a), axis, plane, &
                           merge(image_odd, image_even, a == axis))
    end do
  end function vector_alike

  !> Whether a formula has the value of the image in all places and times that are tried, within
  !! the box of a body.
  function alike(scene, body, formula, axis, plane, image) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body          !! 0: all
    type(expression_t), intent(in) :: formula
    integer, intent(in) :: axis, image   !! one of image_*
    real(dp), intent(in) :: plane
    logical :: yes
    real(dp) :: low(3), high(3), point(3), other(3), here(samples), there(samples), time
    integer :: i
    if (formula%is_constant) then
      yes = image /= image_odd .or. zero(formula)
      return
    end if
    call box(scene, body, low, high)
    yes = all(high - low < 1.0e30_dp)    ! a half-space has no box
    if (formula%uses_time) yes = yes .and. scene%time%end > 0.0_dp
    if (.not. yes) return
    do i = 1, samples
      point = low + (high - low)*modulo(i*shares, 1.0_dp)
      other = point
      other(axis) = 2.0_dp*plane - point(axis)
      if (image == image_same) other(axis) = high(axis) - 0.5_dp*(point(axis) - low(axis))
      time = scene%time%end*modulo(i*golden, 1.0_dp)
      here(i) = formula%evaluate(point, point, time)
      there(i) = formula%evaluate(other, other, time)
    end do
    if (image == image_odd) there = -there
    yes = all(abs(here - there) <= 1.0e-9_dp*maxval(abs(here)))
  end function alike

  !> The box around a body, or around all.
  pure subroutine box(scene, body, low, high)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: body          !! 0: all
    real(dp), intent(out) :: low(3), high(3)
    real(dp) :: lower(3), upper(3)
    integer :: b
    low = huge(1.0_dp)
    high = -huge(1.0_dp)
    do b = 1, size(scene%bodies)
      if (body > 0 .and. b /= body) cycle
      call shapes_box(scene%bodies(b)%shapes, lower, upper)
      low = min(low, lower)
      high = max(high, upper)
    end do
    low(scene%dimension + 1:) = 0.0_dp
    high(scene%dimension + 1:) = 0.0_dp
  end subroutine box

  !> Whether a formula is zero.
  elemental function zero(formula) result(yes)
    type(expression_t), intent(in) :: formula
    logical :: yes
    yes = formula%is_constant .and. abs(formula%value) <= 0.0_dp
  end function zero

end module sgmp_scene_symmetry
