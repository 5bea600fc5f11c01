!> A part of a body whose motion is prescribed (doc/loads.md).
module sgmp_driven_part
  use sgmp_drive, only: drive_sums, drive_t
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  use sgmp_rigid_motion, only: motion_advance, motion_plan, rigid_motion_t
  implicit none
  private
  public :: driven_part_t, driven_part_advance, driven_part_book, driven_part_choose, &
            driven_part_start, driven_totals

  integer, parameter :: driven_totals = drive_sums - 1  !! of force, torque and power over time
  integer, parameter :: around = 3           !! component around the axis

  !> One prescription.
  type :: driven_part_t
    integer :: mark = 0                      !! column of the particles' second stream, 1 for its
                                             !! own and 0 for others
    integer :: number = 0                    !! of its drive in the field
    type(expression_t) :: velocity(3)        !! functions of t
    logical :: axes(3) = .false.             !! components that are prescribed
    real(dp) :: until = huge(1.0_dp)         !! the part is free from this time on
    type(rigid_motion_t) :: motion           !! its rotation
    type(drive_t) :: drive                   !! the step at hand
    real(dp) :: total(driven_totals) = 0.0_dp  !! impulse, angular impulse and work since the start
  end type driven_part_t

contains

  !> Sets the motion before the first step; the centre must be known.
  subroutine driven_part_start(part)
    type(driven_part_t), intent(inout) :: part
    real(dp), parameter :: nowhere(3) = 0.0_dp
    integer :: d
    do d = 1, 3
      if (part%motion%turns) then
        part%motion%spin(d) = part%motion%omega(d)%evaluate(nowhere, nowhere, 0.0_dp)
      end if
      if (part%axes(d) .and. .not. (d == around .and. part%drive%about_axis)) then
        part%drive%velocity(d) = part%velocity(d)%evaluate(nowhere, nowhere, 0.0_dp)
      end if
    end do
    if (part%motion%turns) then
      associate (w => part%motion%spin)
        part%motion%gradient = reshape([0.0_dp, w(3), -w(2), -w(3), 0.0_dp, w(1), &
                                        w(2), -w(1), 0.0_dp], [3, 3])
      end associate
      part%motion%gradient_before = part%motion%gradient
    end if
    if (turns_around(part)) then
      part%motion%spin(around) = part%motion%omega(around)%evaluate(nowhere, nowhere, 0.0_dp)
      part%drive%spin = part%motion%spin(around)
      part%drive%spin_before = part%drive%spin
    end if
    part%drive%acts = .true.
    part%drive%axes = part%axes
    part%drive%centre = part%motion%centre
    part%drive%gradient = part%motion%gradient
    part%drive%before = part%drive%velocity
    part%drive%gradient_before = part%motion%gradient_before
  end subroutine driven_part_start

  !> Velocity of the step at hand, taken in its middle.
  subroutine driven_part_choose(part, middle, dt)
    type(driven_part_t), intent(inout) :: part
    real(dp), intent(in) :: middle           !! time
    real(dp), intent(in) :: dt               !! position step
    real(dp), parameter :: nowhere(3) = 0.0_dp
    integer :: d
    part%drive%acts = middle < part%until
    if (.not. part%drive%acts) return
    part%drive%before = part%drive%velocity
    do d = 1, 3
      if (part%motion%turns) then
        part%motion%spin(d) = part%motion%omega(d)%evaluate(nowhere, nowhere, middle)
      end if
      if (part%axes(d) .and. .not. (d == around .and. part%drive%about_axis)) then
        part%drive%velocity(d) = part%velocity(d)%evaluate(nowhere, nowhere, middle)
      end if
    end do
    if (turns_around(part)) then
      part%motion%spin(around) = part%motion%omega(around)%evaluate(nowhere, nowhere, middle)
      part%drive%spin_before = part%drive%spin
      part%drive%spin = part%motion%spin(around)
    end if
    if (part%motion%turns) call motion_plan(part%motion, part%drive%velocity, dt)
    part%drive%centre = part%motion%centre
    part%drive%gradient = part%motion%gradient
    part%drive%gradient_before = part%motion%gradient_before
  end subroutine driven_part_choose

  !> The part is where the step has taken it.
  pure subroutine driven_part_advance(part, dt)
    type(driven_part_t), intent(inout) :: part
    real(dp), intent(in) :: dt               !! position step
    if (.not. part%drive%acts) return
    if (part%motion%turns) then
      call motion_advance(part%motion, part%drive%velocity, part%drive%before, dt)
    else
      part%motion%centre = part%motion%centre + dt*part%drive%velocity
    end if
    ! What strains before the next kick (USF) sees this motion from where the part is then.
    part%drive%centre = part%motion%centre
    part%drive%gradient_before = part%motion%gradient_before
    part%drive%before = part%drive%velocity
    part%drive%spin_before = part%drive%spin
  end subroutine driven_part_advance

  !> Whether an angular velocity about the axis of the scene is prescribed.
  pure function turns_around(part) result(yes)
    type(driven_part_t), intent(in) :: part
    logical :: yes
    yes = part%drive%about_axis .and. part%axes(around)
  end function turns_around

  !> Adds the sums of a step to those since the start.
  pure subroutine driven_part_book(part, dt, sums)
    type(driven_part_t), intent(inout) :: part
    real(dp), intent(in) :: dt               !! velocity step
    real(dp), intent(in) :: sums(drive_sums)
    part%total = part%total + dt*sums(:driven_totals)
  end subroutine driven_part_book

end module sgmp_driven_part
