!> What a floor may have to bear at rest: the weight of all that can stand on it, and what presses
!! that down (doc/loads.md, Bodies near walls). An estimate from above, by the deck alone.
module sgmp_floor_pressure
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_force, load_pressure, load_traction
  use sgmp_scene, only: load_card_t, scene_presses, scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_turn, only: turn_box
  implicit none
  private
  public :: floor_pressure

  real(dp), parameter :: sudden = 3.0_dp      !! a weight that begins to act at once presses twice
  integer, parameter :: moments = 40          !! at which formulas are looked at

contains

  !> Pressure on a wall across an axis (stress); huge where something of the deck may press as much
  !! as it likes.
  function floor_pressure(scene, axis, side) result(pressure)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis, side
    real(dp) :: pressure
    real(dp) :: heaviest, pull, box(3, 0:1), lower, upper
    integer :: b, i
    pressure = huge(1.0_dp)
    if (scene_presses(scene) .or. any([(size(scene%bodies(b)%shapes) == 0, &
                                        b=1, size(scene%bodies))])) return
    lower = huge(1.0_dp)
    upper = -huge(1.0_dp)
    heaviest = 0.0_dp
    do b = 1, size(scene%bodies)
      box = box_of(scene, b)
      lower = min(lower, box(axis, 0))
      upper = max(upper, box(axis, 1))
      heaviest = max(heaviest, scene%materials(scene%bodies(b)%material)%law%density)
    end do
    pull = abs(scene%gravity(axis))
    do i = 1, size(scene%bodyforces)
      pull = pull + most_of(scene, scene%bodyforces(i)%force(axis:axis))
    end do
    associate (wall => merge(scene%grid%lower(axis), scene%grid%upper(axis), side == 1))
      pressure = heaviest*pull*max(upper - wall, wall - lower)
    end associate
    do i = 1, size(scene%loads)
      pressure = pressure + pressure_of(scene, scene%loads(i), axis)
    end do
    pressure = sudden*pressure
  end function floor_pressure

  !> What a load presses with on average; that of an air blast is over before it matters.
  function pressure_of(scene, load, axis) result(pressure)
    type(scene_t), intent(in) :: scene
    type(load_card_t), intent(in) :: load
    integer, intent(in) :: axis
    real(dp) :: pressure
    real(dp) :: box(3, 0:1), sides(3)
    select case (load%kind)
    case (load_pressure)
      pressure = most_of(scene, load%value(:1))
    case (load_traction)
      pressure = most_of(scene, load%value)
    case (load_force)
      box = box_of(scene, load%body)
      sides = box(:, 1) - box(:, 0)
      sides(axis) = 1.0_dp
      sides(scene%dimension + 1:) = 1.0_dp
      pressure = most_of(scene, load%value)/product(sides)
    case default  ! load_blast
      pressure = 0.0_dp
    end select
  end function pressure_of

  !> Largest sum of formulas' magnitudes, at the corners of all bodies and in their middles.
  function most_of(scene, formulas) result(most)
    type(scene_t), intent(in) :: scene
    type(expression_t), intent(in) :: formulas(:)
    real(dp) :: most
    real(dp) :: box(3, 0:1), place(3), found, time
    integer :: b, corner, d, moment
    most = 0.0_dp
    if (all(formulas%is_constant)) then
      most = sum(abs(formulas%value))
      return
    end if
    do b = 1, size(scene%bodies)
      box = box_of(scene, b)
      do corner = 0, 8
        place = [(box(d, merge(1, 0, btest(corner, d - 1))), d=1, 3)]
        if (corner == 8) place = 0.5_dp*(box(:, 0) + box(:, 1))
        do moment = 0, moments
          time = scene%time%end*real(moment, dp)/real(moments, dp)
          found = sum([(abs(formulas(d)%evaluate(place, place, time)), d=1, size(formulas))])
          if (found < huge(1.0_dp)) most = max(most, found)
        end do
      end do
    end do
  end function most_of

  !> The box around a body at the start.
  function box_of(scene, b) result(box)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    real(dp) :: box(3, 0:1)
    associate (body => scene%bodies(b))
      call shapes_box(body%shapes, box(:, 0), box(:, 1))
      if (scene%dimension > 1) call turn_box(body%turn, box(:, 0), box(:, 1))
    end associate
    box(scene%dimension + 1:, :) = 0.0_dp
  end function box_of

end module sgmp_floor_pressure
