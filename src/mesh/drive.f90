!> Prescribed motion of a part of a body, as the nodes of its field see it in one step
!! (doc/loads.md).
!!
!! The velocity is linear in the place: grids carry linear functions exactly, so that a part which
!! turns keeps its shape to round-off. Where matter turns about the axis of an axisymmetric scene
!! the third component is that around the axis, an angular velocity times the radius.
module sgmp_drive
  use sgmp_kinds, only: dp
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: drive_t, drive_add, drive_jolt, drive_velocity, drive_velocity_before
  public :: most_drives, drive_sums, drive_force, drive_torque, drive_work, drive_power

  integer, parameter :: most_drives = 8    !! of a field: each is a column of the particles' sums

  ! What a step sums up of each drive.
  integer, parameter :: drive_force = 1    !! first component of its force
  integer, parameter :: drive_torque = 4   !! and of the torque about its centre
  integer, parameter :: drive_work = 7     !! power of the force
  !> What it adds to sum m a . v at the velocity before the kick (sgmp_energy).
  integer, parameter :: drive_power = 8
  integer, parameter :: drive_sums = 8     !! entries

  integer, parameter :: around = 3         !! component around the axis

  !> A motion in the step at hand; vectors along the axes of the scene.
  type :: drive_t
    logical :: acts = .false.
    logical :: axes(3) = .false.               !! components that it prescribes
    logical :: about_axis = .false.            !! the third one is around an axis
    real(dp) :: centre(3) = 0.0_dp             !! point about which the velocity is given (length)
    real(dp) :: velocity(3) = 0.0_dp, gradient(3, 3) = 0.0_dp
    real(dp) :: before(3) = 0.0_dp, gradient_before(3, 3) = 0.0_dp
      !! in the step before, seen from where the part is now
    real(dp) :: spin = 0.0_dp, spin_before = 0.0_dp  !! around the axis
    real(dp) :: pic = 0.0_dp
      !! share of the grid's velocity in particles' (1 - flip)
  end type drive_t

contains

  !> Whether it prescribes an angular velocity about the axis of the scene.
  pure function turns_around(drive) result(yes)
    type(drive_t), intent(in) :: drive
    logical :: yes
    yes = drive%about_axis .and. drive%axes(around)
  end function turns_around

  !> Velocity at a place, in this step.
  pure function drive_velocity(drive, place) result(velocity)
    type(drive_t), intent(in) :: drive
    real(dp), intent(in) :: place(3)           !! length
    real(dp) :: velocity(3)
    velocity = drive%velocity + matmul(drive%gradient, place - drive%centre)
    if (turns_around(drive)) velocity(around) = drive%spin*place(1)
  end function drive_velocity

  !> The same in the step before, of what is now at that place.
  pure function drive_velocity_before(drive, place) result(velocity)
    type(drive_t), intent(in) :: drive
    real(dp), intent(in) :: place(3)           !! length
    real(dp) :: velocity(3)
    velocity = drive%before + matmul(drive%gradient_before, place - drive%centre)
    if (turns_around(drive)) velocity(around) = drive%spin_before*place(1)
  end function drive_velocity_before

  !> What a kick adds to the power of what a unit of mass at a place takes: dt/2 |A|^2.
  pure function drive_jolt(drive, place, dt) result(power)
    type(drive_t), intent(in) :: drive
    real(dp), intent(in) :: place(3), dt       !! length, velocity step
    real(dp) :: power
    power = 0.5_dp/dt*sum((drive_velocity(drive, place) - drive_velocity_before(drive, place))**2, &
                          mask=drive%axes)
  end function drive_jolt

  !> Adds a force, its torque about the centre of the drive, its power and its part of drive_power.
  pure subroutine drive_add(drive, place, force, turning, power, extra, sums)
    type(drive_t), intent(in) :: drive
    real(dp), intent(in) :: place(3)           !! length
    real(dp), intent(in) :: force(3)
    real(dp), intent(in) :: turning(3)         !! the force there whose torque counts
    real(dp), intent(in) :: power, extra
    real(dp), intent(inout) :: sums(drive_sums)
    sums(drive_force:drive_force + 2) = sums(drive_force:drive_force + 2) + force
    if (drive%about_axis) then
      sums(drive_torque + 2) = sums(drive_torque + 2) + place(1)*turning(around)
    else
      sums(drive_torque:drive_torque + 2) = sums(drive_torque:drive_torque + 2) + &
                                            cross(place - drive%centre, turning)
    end if
    sums(drive_work) = sums(drive_work) + power
    sums(drive_power) = sums(drive_power) + extra
  end subroutine drive_add

end module sgmp_drive
