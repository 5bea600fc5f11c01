!> Walls of the grid that let go: what they do to particles (doc/loads.md, Bodies near walls).
!!
!! The face of a particle with the volume V and the spacing s lies s/2 from its centre. Where it is
!! beyond the wall by the depth d it is pushed back by
!!     f = K d V/s,   K = 0.4 rho c^2/h (2 rho c^2/h where something is pressed),            (OS1)
!! the force of a spring with the energy K d^2 V/(2 s), which comes back. The first d of a floor, its
!! bed, are as stiff as the matter that stands there. Nothing holds a particle when it leaves. A rough wall holds it along itself, by the way u that it has gone since it touched:
!!     t = -K_t u V/s,   |t| <= mu f,   K_t = 0.4 G/h (2 G/h),                          (OS2)
!! Coulomb's law with an elastic way before it slides; beyond the limit u is cut back to it.
!!
!! Springs bear what a body bears at the start, where it begins with a stress on a wall: by a depth
!! more, and a way along it, that make (OS1) and (OS2) the traction there. A particle keeps both
!! until it leaves, that depth as the component of its way across the wall.
!!
!! The forces act at the face. Particles bring them to the grid where they are, with f s/2 beside
!! the product of their stress and volume, and where stresses act at centres with
!!     f/h (h^2 xi (1 - xi)/2 - s^2/8)                                                       (OS3)
!! more at the centre above than at the one below, xi the place between them: so they get to the
!! nodes by the function whose gradient stresses see there, and a uniform stress is in equilibrium
!! with them (sgmp_loads). Their work is that on the way of the particle and, by the strain, on that
!! of the face from there.
!!
!! Velocities lie half a step before the places that go with them. So the energy of a spring that
!! adds up with theirs is K d d' V/(2 s), d and d' the depths before and after a step, and not
!! K d'^2 V/(2 s): the difference is a sum of its own, which the account takes back a step later.
module sgmp_one_sided
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_sums, only: sum_applied, sum_springs, sweep_sums
  implicit none
  private
  public :: one_sided_drift, one_sided_first_way, one_sided_flux, one_sided_forces, one_sided_levers, one_sided_push, &
            one_sided_strain

  !> Place of the stress between two axes among those that exert a force, where there are so many
  !! axes.
  integer, parameter :: shear(3, 3, 3) = reshape([ &
    1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 3, 0, 3, 2, 0, 0, 0, 0, 1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3, 3])

contains

  !> Adds the forces of walls on a chunk to the columns for them, and what they do across it to the
  !! products of stresses and volumes.
  pure subroutine one_sided_push(mesh, walls, live, motion, state, force, flux)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes)          !! 0 for pads
    real(dp), intent(in) :: motion(lanes, *)     !! places first (cells)
    real(dp), intent(in) :: state(lanes, *)      !! volumes first
    real(dp), intent(inout) :: force(lanes, *)
    real(dp), intent(inout) :: flux(lanes, *)
    real(dp) :: push(3)
    integer :: a, l, w
    do w = 1, size(walls)
      associate (wall => walls(w))
        if (.not. reached(wall, motion(:, wall%axis))) cycle
        do l = 1, lanes
          if (live(l) <= 0.0_dp) cycle
          push = forces_on(mesh, wall, l, motion, state)
          do a = 1, mesh%ndim
            if (wall%columns(a) == 0) cycle
            force(l, wall%columns(a)) = force(l, wall%columns(a)) + push(a)
            associate (stress => flux(l, one_sided_flux(mesh, wall, a)))
              stress = stress + 0.5_dp*wall%spacing*inwards(wall)*push(a)
            end associate
          end do
        end do
      end associate
    end do
  end subroutine one_sided_push

  !> Where the stress is by which the component `a` of a wall's force acts across a particle.
  pure integer function one_sided_flux(mesh, wall, a) result(place)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: a
    place = shear(a, wall%axis, mesh%ndim)
  end function one_sided_flux

  !> What the forces of a wall add at the centre above a particle along the wall's axis, and take at
  !! the one below, component by component (OS3); zero where nothing is pushed.
  pure subroutine one_sided_levers(mesh, wall, live, motion, state, xi, levers, some)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: live(lanes), motion(lanes, *), state(lanes, *)
    real(dp), intent(in) :: xi(lanes)            !! place along the axis, from the centre below
    real(dp), intent(out) :: levers(lanes, 3)
    logical, intent(out) :: some                 !! some are pushed
    real(dp) :: arm
    integer :: l
    levers = 0.0_dp
    some = reached(wall, motion(:, wall%axis))
    if (.not. some) return
    do l = 1, lanes
      if (live(l) <= 0.0_dp) cycle
      arm = 0.5_dp*mesh%h*xi(l)*(1.0_dp - xi(l)) - 0.125_dp*mesh%inverse_h*wall%spacing**2
      levers(l, :) = arm*forces_on(mesh, wall, l, motion, state)
    end do
    some = any(abs(levers(:, wall%axis)) > 0.0_dp)
  end subroutine one_sided_levers

  !> Moves the particles of a chunk along walls and adds the energy that these give to them.
  pure subroutine one_sided_drift(mesh, walls, live, motion, drifted, state, sums)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes), motion(lanes, *)
    real(dp), intent(in) :: drifted(lanes, *)    !! way to the new places
    real(dp), intent(inout) :: state(lanes, *)   !! volumes first
    real(dp), intent(inout) :: sums(lanes, sweep_sums)
    real(dp) :: before, after, area, more
    integer :: l, w
    do w = 1, size(walls)
      associate (wall => walls(w), place => motion(:, walls(w)%axis))
        if (.not. reached(wall, place)) cycle
        do l = 1, lanes
          if (live(l) <= 0.0_dp) cycle
          area = state(l, 1)/wall%spacing
          more = 0.0_dp
          if (wall%way > 0) more = state(l, wall%way + wall%axis - 1)
          before = depth(mesh, wall, place(l), more)
          after = depth(mesh, wall, place(l) + mesh%inverse_h*drifted(l, wall%axis), more)
          associate (work => sums(l, sum_applied), ahead => sums(l, sum_springs))
            work = work + area*(energy(wall, before) - energy(wall, after))
            ahead = ahead + 0.5_dp*area*pressure(wall, after)*(after - before)
            if (wall%way > 0) call rub(mesh, wall, l, after, area, drifted, state, work, ahead)
          end associate
        end do
      end associate
    end do
  end subroutine one_sided_drift

  !> The way of a particle along a wall, which it forgets where it leaves; the work of the force in
  !! the middle of the step, that of friction where it slides.
  pure subroutine rub(mesh, wall, l, depth_now, area, drifted, state, work, ahead)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: l                     !! lane
    real(dp), intent(in) :: depth_now, area, drifted(lanes, *)
    real(dp), intent(inout) :: state(lanes, *), work, ahead
    real(dp) :: most, length, way(3), old(3), gone(3)
    integer :: n
    n = mesh%ndim
    if (depth_now <= 0.0_dp) then
      state(l, wall%way:wall%way + n - 1) = 0.0_dp
      return
    end if
    if (.not. wall%friction > 0.0_dp) return
    way = 0.0_dp
    way(:n) = state(l, wall%way:wall%way + n - 1)
    way(wall%axis) = 0.0_dp
    gone = 0.0_dp
    gone(:n) = drifted(l, :n)
    gone(wall%axis) = 0.0_dp
    old = way
    way = way + gone
    length = norm2(way)
    most = min(wall%friction*(pressure(wall, depth_now)/wall%grip), huge(1.0_dp))
    if (length > most) way = way*(most/length)
    work = work - wall%grip*area*dot_product(0.5_dp*(old + way), gone)
    ahead = ahead + 0.5_dp*wall%grip*area*dot_product(way, way - old)
    way(wall%axis) = state(l, wall%way + wall%axis - 1)
    state(l, wall%way:wall%way + n - 1) = way(:n)
  end subroutine rub

  !> The rest of the work of walls: faces move towards their centres.
  pure subroutine one_sided_strain(mesh, walls, live, motion, state, dt, gradient, work)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes), motion(lanes, *), state(lanes, *)
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: gradient(lanes, mesh%ndim, *)  !! of the velocity (axis, component)
    real(dp), intent(inout) :: work(lanes)
    real(dp) :: push(3), strain
    integer :: a, l, w
    do w = 1, size(walls)
      associate (wall => walls(w), n => walls(w)%axis)
        if (.not. reached(wall, motion(:, n))) cycle
        do l = 1, lanes
          if (live(l) <= 0.0_dp) cycle
          push = forces_on(mesh, wall, l, motion, state)
          do a = 1, mesh%ndim
            strain = gradient(l, n, a)
            if (a /= n) strain = strain + gradient(l, a, n)
            work(l) = work(l) - 0.5_dp*wall%spacing*inwards(wall)*push(a)*dt*strain
          end do
        end do
      end associate
    end do
  end subroutine one_sided_strain

  !> Forces of a wall on a particle.
  pure function one_sided_forces(mesh, wall, place, volume, way) result(forces)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    real(dp), intent(in) :: volume
    real(dp), intent(in) :: way(:)               !! along the wall, and its depth at the start;
                                                 !! empty: there are none
    real(dp) :: forces(3)
    real(dp) :: deep
    forces = 0.0_dp
    if (size(way) == 0) then
      deep = depth(mesh, wall, place, 0.0_dp)
    else
      deep = depth(mesh, wall, place, way(wall%axis))
    end if
    if (.not. deep > 0.0_dp) return
    forces(:size(way)) = -wall%grip*way
    forces(wall%axis) = inwards(wall)*pressure(wall, deep)
    forces = forces*(volume/wall%spacing)
  end function one_sided_forces

  !> The way with which a particle begins whose face lies at a wall and bears a stress there: none
  !! where it lies farther away or is pulled.
  pure function one_sided_first_way(mesh, wall, place, stress) result(way)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    real(dp), intent(in) :: stress(3)            !! components of the stress with the wall's axis
    real(dp) :: way(3)
    real(dp), parameter :: near = 0.1_dp         !! spacings between such a face and the wall
    real(dp) :: length, most
    integer :: n
    n = wall%axis
    way = 0.0_dp
    if (stress(n) >= 0.0_dp .or. &
        depth(mesh, wall, place, near*wall%spacing) <= 0.0_dp) return
    if (wall%friction > 0.0_dp) way = inwards(wall)*stress/wall%grip
    way(n) = 0.0_dp
    length = norm2(way)
    most = min(wall%friction*abs(stress(n))/wall%grip, huge(1.0_dp))
    if (length > most) way = way*(most/length)
    way(n) = depth_of(wall, abs(stress(n)))
  end function one_sided_first_way

  !> The same of a particle in its lane.
  pure function forces_on(mesh, wall, l, motion, state) result(forces)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: l
    real(dp), intent(in) :: motion(lanes, *), state(lanes, *)
    real(dp) :: forces(3)
    forces = one_sided_forces(mesh, wall, motion(l, wall%axis), state(l, 1), &
                              state(l, wall%way:wall%way + merge(mesh%ndim, 0, wall%way > 0) - 1))
  end function forces_on

  !> Whether particles of a chunk may have come to a wall.
  pure logical function reached(wall, places) result(yes)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: places(lanes)
    yes = any(inwards(wall)*(places - wall%place) < 1.0_dp)
  end function reached

  !> What the springs of a wall press with at a depth (OS1).
  elemental real(dp) function pressure(wall, depth)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: depth
    pressure = wall%stiffness*depth + (wall%hard - wall%stiffness)*min(depth, wall%bed)
  end function pressure

  !> The depth at which they press so.
  elemental real(dp) function depth_of(wall, pressure) result(depth)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: pressure
    depth = min(pressure/max(wall%hard, wall%stiffness), wall%bed)
    depth = depth + (pressure - max(wall%hard, wall%stiffness)*depth)/wall%stiffness
  end function depth_of

  !> Their energy per area there.
  elemental real(dp) function energy(wall, depth)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: depth
    associate (first => min(depth, wall%bed))
      energy = 0.5_dp*wall%stiffness*depth**2 + &
               (wall%hard - wall%stiffness)*first*(depth - 0.5_dp*first)
    end associate
  end function energy

  !> How far the face of a particle has come through a wall; 0: not at all.
  elemental function depth(mesh, wall, place, more) result(way)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place
    real(dp), intent(in) :: more                 !! by its stress at the start
    real(dp) :: way
    way = max(0.5_dp*wall%spacing + more - mesh%h*inwards(wall)*(place - wall%place), 0.0_dp)
  end function depth

  !> The way from a wall into the grid along its axis.
  elemental real(dp) function inwards(wall) result(way)
    type(one_sided_wall_t), intent(in) :: wall
    way = merge(1.0_dp, -1.0_dp, wall%side == 1)
  end function inwards

end module sgmp_one_sided
