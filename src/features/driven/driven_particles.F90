! dimension-generic
#include "dimension.inc"
!> Particles whose motion is prescribed: they take the velocity of their part, whatever the grid
!! says, and the difference is a force of whoever moves them.
module DIM(sgmp_driven_particles)
  use sgmp_body, only: body_parts, body_t
  use sgmp_drive, only: drive_add, drive_jolt, drive_velocity
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_places, mesh_t
  use sgmp_motion, only: motion_mass, motion_total, motion_velocity
  implicit none
  private
  public :: driven_masses, driven_read

  integer, parameter :: before_v = motion_velocity(NDIM) - 1  !! columns of the motion before v
  integer, parameter :: mass_at = motion_mass(NDIM)

contains

  !> Puts what driven particles of a chunk shall do in the place of what they read of the grid:
  !! with `kick` the acceleration that leads to the velocity of the step, with `moves` the velocity.
  pure subroutine driven_read(mesh, body, dt, kick, moves, live, nb, motion, state, acceleration, &
                              velocity, sums)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: dt                   !! velocity step
    logical, intent(in) :: kick, moves
    real(dp), intent(in) :: live(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: acceleration(lanes, NDIM)
    real(dp), intent(inout) :: velocity(lanes, NDIM)  !! 0 where the grid's is not read
    real(dp), intent(inout) :: sums(:, :)        !! (drive_sums, drives)
    real(dp) :: place(3), wanted(3), force(3), turning(3), change, pic, power, extra
    integer :: i, l, d
    do i = 1, size(body%driven)
      associate (part => body%driven(i))
        if (.not. part%drive%acts) cycle
        if (.not. any(state(:, part%mark) > 0.0_dp)) cycle
        do l = 1, lanes
          if (.not. live(l)*state(l, part%mark) > 0.0_dp) cycle
          place = 0.0_dp
          place(:NDIM) = mesh_places(mesh, motion(l, :NDIM))
          wanted = drive_velocity(part%drive, place)
          force = 0.0_dp
          turning = 0.0_dp
          power = 0.0_dp
          if (kick) power = motion(l, mass_at)*drive_jolt(part%drive, place, dt)
          extra = 0.0_dp
          do d = 1, NDIM
            if (.not. part%axes(d)) cycle
            if (kick) then
              associate (own => motion(l, before_v + d))
                change = (wanted(d) - own)/dt
                ! What PIC would have given the particle it does not.
                pic = part%drive%pic*((velocity(l, d) - own)/dt - acceleration(l, d))
                force(d) = motion(l, mass_at)*(change - acceleration(l, d) - pic)
                turning(d) = motion(l, mass_at)*(change - pic)
                power = power + force(d)*(0.5_dp*(own + wanted(d)))
                extra = extra + force(d)*own
              end associate
              acceleration(l, d) = change
            end if
            if (moves) velocity(l, d) = wanted(d)
          end do
          if (kick) call drive_add(part%drive, place, force, turning, power, extra, &
                                   sums(:, part%number))
        end do
      end associate
    end do
  end subroutine driven_read

  !> Masses of driven particles, a column for each part of the field.
  pure subroutine driven_masses(body, live, mass, nb, state, columns, values)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: live(lanes), mass(lanes)
    integer, intent(in) :: nb, columns
    real(dp), intent(in) :: state(lanes, nb)
    real(dp), intent(inout) :: values(lanes, columns)
    integer :: i
    values = 0.0_dp
    do i = 1, body_parts(body)
      associate (part => body%driven(i))
        values(:, part%number) = live*mass*state(:, part%mark)
      end associate
    end do
  end subroutine driven_masses

end module DIM(sgmp_driven_particles)
