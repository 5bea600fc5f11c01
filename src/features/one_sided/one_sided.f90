!> Walls of the grid that let go: what they do to particles (doc/loads.md, Bodies near walls).
!!
!! The face of a particle with the volume V and the spacing s lies s/2 from its centre. Where it is
!! beyond the wall by the depth d it is pushed back by
!!     f = K d V/s,   K = 0.4 rho c^2/h,
!! the force of a spring with the energy K d^2 V/(2 s), which comes back. Nothing holds it when it
!! leaves.
!!
!! The force acts at the face. Particles bring it to the grid where they are, with f s/2 beside the
!! product of their stress and volume, and where stresses act at centres with
!!     f/h (h^2 xi (1 - xi)/2 - s^2/8)
!! more at the centre above than at the one below, xi the place between them: so it gets to the
!! nodes by the function whose gradient stresses see there, and a uniform stress is in equilibrium
!! with it (sgmp_loads). Its work is that on the way of the particle and, by the strain, on that of
!! the face from there.
module sgmp_one_sided
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided_wall, only: one_sided_wall_t
  implicit none
  private
  public :: one_sided_drift, one_sided_force, one_sided_lever, one_sided_push, one_sided_strain

contains

  !> Adds the forces of walls on a chunk to the columns for them, and what they do across it to the
  !! products of stresses and volumes.
  pure subroutine one_sided_push(mesh, walls, live, motion, volume, force, flux)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes)          !! 0 for pads
    real(dp), intent(in) :: motion(lanes, *)     !! places first (cells)
    real(dp), intent(in) :: volume(lanes)
    real(dp), intent(inout) :: force(lanes, *)   !! (one column for each axis that has such walls)
    real(dp), intent(inout) :: flux(lanes, *)    !! normal stresses first
    real(dp) :: push(lanes)
    integer :: w
    do w = 1, size(walls)
      associate (wall => walls(w), a => walls(w)%axis)
        if (.not. reached(wall, motion(:, a))) cycle
        push = live*one_sided_force(mesh, wall, motion(:, a), volume)
        force(:, wall%column) = force(:, wall%column) + push
        flux(:, a) = flux(:, a) + 0.5_dp*wall%spacing*abs(push)
      end associate
    end do
  end subroutine one_sided_push

  !> What the force of a wall adds at the centre above a particle along the wall's axis, and takes
  !! at the one below; zero where nothing is pushed.
  pure function one_sided_lever(mesh, wall, live, place, xi, volume) result(lever)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: live(lanes), volume(lanes)
    real(dp), intent(in) :: place(lanes), xi(lanes)  !! along the axis; from the centre below
    real(dp) :: lever(lanes)
    lever = live*one_sided_force(mesh, wall, place, volume)* &
            (0.5_dp*mesh%h*xi*(1.0_dp - xi) - 0.125_dp*mesh%inverse_h*wall%spacing**2)
  end function one_sided_lever

  !> Adds the energy that walls give to the particles of a chunk as they drift.
  pure subroutine one_sided_drift(mesh, walls, live, motion, volume, drifted, work)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes), motion(lanes, *), volume(lanes)
    real(dp), intent(in) :: drifted(lanes, *)    !! way to the new places
    real(dp), intent(inout) :: work(lanes)
    integer :: w
    do w = 1, size(walls)
      associate (wall => walls(w), place => motion(:, walls(w)%axis), &
                 way => mesh%inverse_h*drifted(:, walls(w)%axis))
        if (.not. reached(wall, place)) cycle
        work = work + live*(energy(mesh, wall, place, volume) - &
                            energy(mesh, wall, place + way, volume))
      end associate
    end do
  end subroutine one_sided_drift

  !> The same as faces move towards their centres.
  pure subroutine one_sided_strain(mesh, walls, live, motion, volume, dt, gradient, work)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes), motion(lanes, *), volume(lanes)
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: gradient(lanes, mesh%ndim, *)  !! of the velocity (axis, component)
    real(dp), intent(inout) :: work(lanes)
    integer :: w
    do w = 1, size(walls)
      associate (wall => walls(w), a => walls(w)%axis)
        if (.not. reached(wall, motion(:, a))) cycle
        work = work - live*abs(one_sided_force(mesh, wall, motion(:, a), volume))* &
                      (0.5_dp*wall%spacing*dt)*gradient(:, a, a)
      end associate
    end do
  end subroutine one_sided_strain

  !> Whether particles of a chunk may have come to a wall.
  pure logical function reached(wall, places) result(yes)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: places(lanes)
    yes = any(inwards(wall)*(places - wall%place) < 1.0_dp)
  end function reached

  !> Force of a wall on a particle, along the wall's axis.
  elemental function one_sided_force(mesh, wall, place, volume) result(force)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    real(dp), intent(in) :: volume
    real(dp) :: force
    force = inwards(wall)*wall%stiffness*depth(mesh, wall, place)*volume/wall%spacing
  end function one_sided_force

  !> Energy of the spring between a wall and a particle.
  elemental function energy(mesh, wall, place, volume) result(stored)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place, volume
    real(dp) :: stored
    stored = 0.5_dp*wall%stiffness*depth(mesh, wall, place)**2*volume/wall%spacing
  end function energy

  !> How far the face of a particle has come through a wall; 0: not at all.
  elemental function depth(mesh, wall, place) result(way)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place
    real(dp) :: way
    way = max(0.5_dp*wall%spacing - mesh%h*inwards(wall)*(place - wall%place), 0.0_dp)
  end function depth

  !> The way from a wall into the grid along its axis.
  elemental real(dp) function inwards(wall) result(way)
    type(one_sided_wall_t), intent(in) :: wall
    way = merge(1.0_dp, -1.0_dp, wall%side == 1)
  end function inwards

end module sgmp_one_sided
