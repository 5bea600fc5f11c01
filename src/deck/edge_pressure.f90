!> The pressure around all of a scene, at edges that let waves out (doc/loads.md, Absorbing edges).
!!
!! A pressure that is the same everywhere moves nothing where matter fills all of the grid and
!! something holds it at all sides. The grid then gets the stress above it alone, and such edges
!! bear nothing at rest: otherwise the errors of two large forces at their faces, which should
!! cancel, drive each other, and gas under its own pressure comes apart there.
module sgmp_edge_pressure
  use sgmp_constitutive, only: law_first_pressure, law_gaseous
  use sgmp_features, only: features_walls_act
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_absorbing, wall_free
  use sgmp_scene, only: body_card_t, scene_t
  use sgmp_shapes, only: shapes_inside
  use sgmp_text, only: real_text
  use sgmp_turn, only: turn_back
  implicit none
  private
  public :: edge_pressure_settle, edge_pressure_warning

  integer, parameter :: most_points(3) = [1024, 128, 32]  !! along each axis, to look for voids
  real(dp), parameter :: beside = 0.25_dp      !! cells from a side of the grid to the points there

contains

  !> Sets that pressure; it stays 0 where matter does not fill the grid, and where something tells
  !! it from none.
  subroutine edge_pressure_settle(scene)
    type(scene_t), intent(inout) :: scene
    if (.not. any(scene%grid%wall(:, :scene%dimension) == wall_absorbing)) return
    if (obstacle(scene) == '') scene%grid%ambient = pressure_at_edges(scene, .false.)
  end subroutine edge_pressure_settle

  !> What to say of gas whose pressure at such edges the grid has to bear; empty: nothing.
  pure function edge_pressure_warning(scene) result(text)
    type(scene_t), intent(in) :: scene
    character(:), allocatable :: text
    real(dp) :: pressure
    text = ''
    if (.not. any(scene%grid%wall(:, :scene%dimension) == wall_absorbing)) return
    if (scene%grid%ambient > 0.0_dp .or. scene%dimension == 1) return
    pressure = pressure_at_edges(scene, .true.)
    if (.not. pressure > 0.0_dp) return
    text = 'gas under a pressure of '//real_text(pressure)//' ends at absorbing edges, whose '// &
           'faces must balance it: noise grows there, and within a few crossings of sound the '// &
           'gas comes apart (doc/loads.md, Absorbing edges). The grid would feel no more than '// &
           'what is above that pressure but that '//obstacle(scene)
  end function edge_pressure_warning

  !> Why a pressure that is the same everywhere must be felt; empty: it need not.
  pure function obstacle(scene) result(text)
    type(scene_t), intent(in) :: scene
    character(:), allocatable :: text
    text = ''
    if (size(scene%contacts) > 0) then
      text = 'bodies touch (contact)'
    else if (any(scene%bodies%rigid)) then
      text = 'bodies are rigid'
    else if (any(scene%bodies%removed_at < huge(1.0_dp))) then
      text = 'bodies are removed'
    else if (scene%grid%reactions) then
      text = 'the reactions of walls are asked for (wall … reactions=yes)'
    else if (features_walls_act(scene%features)) then
      text = 'walls rub'
    else if (.not. closed(scene)) then
      text = 'a side of the grid is neither a wall nor such an edge'
    else if (.not. fills(scene)) then
      text = 'matter does not fill the grid'
    else if (.not. pressure_at_edges(scene, .false.) > 0.0_dp) then
      text = 'what else ends there begins without a pressure (initial_stress … pressure=)'
    end if
  end function obstacle

  !> Whether something holds a fluid at all sides: a wall, such an edge or the axis.
  pure function closed(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    logical :: holds(2, 3)
    associate (grid => scene%grid)
      holds = .not. grid%open .and. .not. grid%one_sided .and. grid%wall /= wall_free
      if (scene%axisymmetric) holds(1, 1) = .true.  ! the axis
    end associate
    yes = all(holds(:, :scene%dimension))
  end function closed

  !> The least pressure at the start of those bodies that end at absorbing edges.
  pure function pressure_at_edges(scene, gases) result(least)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: gases                 !! of these alone
    real(dp) :: least
    integer :: number(3), axis, b, i, side
    real(dp) :: point(3)
    least = huge(1.0_dp)
    number = points_along(scene)
    do axis = 1, scene%dimension
      do side = 1, 2
        if (scene%grid%wall(side, axis) /= wall_absorbing) cycle
        do i = 1, product(number)/number(axis)
          point = point_at(scene, number, face_point(number, axis, side, i))
          b = body_at(scene, point)
          if (b == 0) cycle
          if (gases .and. .not. law_gaseous(scene%materials(scene%bodies(b)%material)%law)) cycle
          least = min(least, first_pressure(scene, b))
        end do
      end do
    end do
    if (least > 0.5_dp*huge(1.0_dp)) least = 0.0_dp
  end function pressure_at_edges

  !> Pressure of a body at the start, at its surface; 0: there is none, or one by a formula.
  pure function first_pressure(scene, b) result(pressure)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    real(dp) :: pressure
    associate (stress => scene%bodies(b)%stress)
      pressure = law_first_pressure(scene%materials(scene%bodies(b)%material)%law)
      if (stress%given .and. .not. stress%geostatic) pressure = 0.0_dp
      if (stress%pressure_given) pressure = stress%pressure
    end associate
  end function first_pressure

  !> Whether bodies leave no void.
  pure function fills(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: number(3), i, j, k
    number = points_along(scene)
    yes = .true.
    do k = 1, number(3)
      do j = 1, number(2)
        do i = 1, number(1)
          yes = yes .and. body_at(scene, point_at(scene, number, [i, j, k])) > 0
        end do
        if (.not. yes) return
      end do
    end do
  end function fills

  !> How many points are looked at along each axis.
  pure function points_along(scene) result(number)
    type(scene_t), intent(in) :: scene
    integer :: number(3)
    integer :: n
    n = scene%dimension
    number = 1
    associate (grid => scene%grid)
      number(:n) = min(max(2, nint((grid%upper(:n) - grid%lower(:n))/grid%cell)), most_points(n))
    end associate
  end function points_along

  !> Place of a point: the first and the last of each axis lie beside the sides of the grid.
  pure function point_at(scene, number, at) result(point)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number(3), at(3)
    real(dp) :: point(3)
    integer :: d
    point = 0.0_dp
    associate (grid => scene%grid)
      do d = 1, scene%dimension
        point(d) = grid%lower(d) + (at(d) - 0.5_dp)/number(d)*(grid%upper(d) - grid%lower(d))
        if (at(d) == 1) point(d) = grid%lower(d) + beside*grid%cell
        if (at(d) == number(d)) point(d) = grid%upper(d) - beside*grid%cell
      end do
    end associate
  end function point_at

  !> The i-th point beside a side of the grid.
  pure function face_point(number, axis, side, i) result(at)
    integer, intent(in) :: number(3), axis, side, i
    integer :: at(3)
    integer :: d, rest
    rest = i - 1
    do d = 1, 3
      if (d == axis) then
        at(d) = merge(1, number(d), side == 1)
      else
        at(d) = 1 + mod(rest, number(d))
        rest = rest/number(d)
      end if
    end do
  end function face_point

  !> A body that holds a point; 0: none does.
  pure function body_at(scene, point) result(b)
    type(scene_t), intent(in) :: scene
    real(dp), intent(in) :: point(3)
    integer :: b
    do b = 1, size(scene%bodies)
      if (holds(scene%bodies(b), point, scene%dimension)) return
    end do
    b = 0
  end function body_at

  !> Whether a body holds a point.
  pure function holds(body, point, ndim) result(yes)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: point(3)
    integer, intent(in) :: ndim
    logical :: yes
    real(dp) :: place(3)
    yes = allocated(body%shapes) .and. body%material > 0
    if (.not. yes) return
    place = point
    if (ndim > 1) call turn_back(body%turn, place)
    yes = shapes_inside(body%shapes, place, ndim, 0.0_dp)
  end function holds

end module sgmp_edge_pressure
