!> Damping: every step takes the same part of the velocity from all that moves freely.
!!
!! A pass of its own after the step, over the particles and over the momentum that they have given
!! to the grid, so that steps without damping know nothing of it. With the factor f on the
!! velocities the energy taken is (1 - f^2) of the kinetic energy, exactly. Leapfrog with
!! f = exp(-rate dt) after each kick lets a mode decay with rate/2, exactly (doc/damping.md).
module sgmp_damping_stages
  use sgmp_body, only: body_t
  use sgmp_damping_account, only: damping_book
  use sgmp_energy, only: ledger_t
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use sgmp_motion, only: motion_velocity
  use sgmp_particles, only: particles_t
  use sgmp_rigid_bodies, only: rigid_field
  use sgmp_totals, only: body_sums_t
  use sgmp_walls, only: walls_slow
  implicit none
  private
  public :: damping_factor, damping_slow

contains

  !> What is left of the velocities at the end of a step. Kinetic damping leaves nothing once the
  !! kinetic energy has passed a maximum: the elastic energy is then near a minimum.
  pure function damping_factor(method, time, dt_kick, kinetic_before, kinetic) result(factor)
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: time               !! at the start of the step
    real(dp), intent(in) :: dt_kick            !! velocity step
    real(dp), intent(in) :: kinetic_before, kinetic  !! energy before and after the step
    real(dp) :: factor
    factor = 1.0_dp
    if (time >= method%damped_until) return
    factor = exp(-method%damping*dt_kick)
    if (method%kinetic_damping .and. kinetic < kinetic_before) factor = 0.0_dp
  end function damping_factor

  !> Multiplies velocities and momenta by a factor and books the energy that this takes.
  subroutine damping_slow(factor, threads, mesh, fields, bodies, sums, ledger)
    real(dp), intent(in) :: factor
    integer, intent(in) :: threads
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(body_sums_t), intent(inout) :: sums(:)  !! (bodies)
    type(ledger_t), intent(inout) :: ledger
    integer :: b, f
    do b = 1, size(bodies)
      if (bodies(b)%rigid_motion%free) then
        bodies(b)%rigid_motion%momentum = factor*bodies(b)%rigid_motion%momentum
        sums(b)%momentum = factor*sums(b)%momentum
        sums(b)%kinetic = factor**2*sums(b)%kinetic
      end if
      if (bodies(b)%rigid) cycle
      call slow_particles(factor, threads, bodies(b)%law%slots%swirl, bodies(b)%particles)
      sums(b)%momentum = factor*sums(b)%momentum
      sums(b)%kinetic = factor**2*sums(b)%kinetic
    end do
    do f = 1, size(fields)
      if (rigid_field(bodies, f) == 0) call slow_field(factor, mesh, fields(f))
    end do
    call damping_book(ledger, factor)
  end subroutine damping_slow

  !> All that is a velocity in the particles of a body.
  subroutine slow_particles(factor, threads, swirl, particles)
    real(dp), intent(in) :: factor
    integer, intent(in) :: threads
    integer, intent(in) :: swirl               !! column of the state, 0: none
    type(particles_t), intent(inout) :: particles
    integer :: c, first, last
    first = motion_velocity(particles%ndim)
    last = first + particles%ndim - 1
    !$omp parallel do schedule(static) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(particles, first, last, factor, swirl) private(c)
    do c = 1, particles%chunks
      particles%motion(:, first:last, c) = factor*particles%motion(:, first:last, c)
      if (swirl > 0) particles%state(:, swirl, c) = factor*particles%state(:, swirl, c)
    end do
    !$omp end parallel do
  end subroutine slow_particles

  !> All that is a momentum in the sums of a field, for the step to come.
  subroutine slow_field(factor, mesh, field)
    real(dp), intent(in) :: factor
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    associate (columns => field%columns)
      if (any(columns%behind > 0)) then
        call walls_slow(field, mesh, factor)
      else
        call scale(columns%momentum, field%ndim, factor)
      end if
      if (columns%swirl > 0) call scale(columns%swirl, 1, factor)
      if (columns%square > 0) call scale(columns%square, 1, factor**2)
    end associate

  contains

    subroutine scale(first, n, part)
      integer, intent(in) :: first, n
      real(dp), intent(in) :: part
      field%moment(:, first:first + n - 1) = part*field%moment(:, first:first + n - 1)
    end subroutine scale

  end subroutine slow_field

end module sgmp_damping_stages
