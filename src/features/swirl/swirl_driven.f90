!> Particles whose motion around the axis is prescribed: they take the moment of their part, and the
!! difference is a torque of whoever turns them (sgmp_driven_particles).
module sgmp_swirl_driven
  use sgmp_body, only: body_parts, body_t
  use sgmp_drive, only: drive_add
  use sgmp_graded_axis, only: graded_place
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  implicit none
  private
  public :: swirl_driven_read, swirl_driven_start

  integer, parameter :: around = 3             !! component around the axis
  real(dp), parameter :: least_radius = 1.0e-12_dp  !! (cells) of a particle on the axis

contains

  !> Puts the acceleration of the rate v_theta/X that driven particles of a chunk shall have in the
  !! place of what they read of the grid.
  pure subroutine swirl_driven_read(body, h, dt, live, radius, mass, nb, state, acceleration, &
                                    rate, sums)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: h, dt                !! length of a cell, velocity step
    real(dp), intent(in) :: live(lanes), radius(lanes), mass(lanes)  !! radius in cells
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    real(dp), intent(inout) :: acceleration(lanes)
    real(dp), intent(inout) :: rate(lanes)       !! after the kick, which PIC reads
    real(dp), intent(inout) :: sums(:, :)        !! (drive_sums, drives)
    real(dp) :: own, wanted, change, pic, force(3), turning(3), x
    integer :: i, l
    do i = 1, body_parts(body)
      associate (part => body%driven(i))
        if (.not. (part%drive%acts .and. part%drive%axes(around))) cycle
        do l = 1, lanes
          if (.not. live(l)*state(l, part%mark) > 0.0_dp) cycle
          x = max(radius(l), least_radius)
          own = state(l, body%law%slots%swirl)/x
          wanted = part%drive%spin*h*x
          change = (wanted - own)/dt
          ! What PIC would have given the particle it does not.
          pic = part%drive%pic*((x*rate(l) - own)/dt - x*acceleration(l))
          force = 0.0_dp
          turning = 0.0_dp
          force(around) = mass(l)*(change - x*acceleration(l) - pic)
          turning(around) = mass(l)*(change - pic)
          call drive_add(part%drive, [h*x, 0.0_dp, 0.0_dp], force, turning, &
                         force(around)*(0.5_dp*(own + wanted)), force(around)*own, &
                         sums(:, part%number))
          acceleration(l) = change/x
          rate(l) = wanted/x
        end do
      end associate
    end do
  end subroutine swirl_driven_read

  !> Gives driven particles the moment that they have at the start.
  subroutine swirl_driven_start(mesh, body)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    integer :: i, c
    do i = 1, body_parts(body)
      associate (part => body%driven(i), particles => body%particles)
        if (.not. (part%drive%about_axis .and. part%axes(around))) cycle
        do c = 1, particles%chunks
          where (particles%state(:, part%mark, c) > 0.0_dp)
            particles%state(:, body%law%slots%swirl, c) = part%drive%spin*mesh%h* &
              graded_place(mesh%axes(1), particles%motion(:, 1, c))**2
          end where
        end do
      end associate
    end do
  end subroutine swirl_driven_start

end module sgmp_swirl_driven
