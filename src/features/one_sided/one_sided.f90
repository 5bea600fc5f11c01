!> Walls of the grid that let go: what they do to particles (doc/loads.md, Bodies near walls).
!!
!! The face of a particle with the volume V and the spacing s lies w from its centre, s/2 at first;
!! of balls and what rolls at their round surface, so that they do not roll on facets.
!! Where it is beyond the wall by the depth d it is pushed back by
!!     f = K d V/s,   K = 0.4 rho c^2/h (4 rho c^2/h where something is pressed),            (OS1)
!! the force of a spring with the energy K d^2 V/(2 s), which comes back. The bed of a floor, its
!! first d, is harder. Nothing holds a particle when it leaves. A rough wall holds it along itself,
!! by the way u that its face has gone since it touched:
!!     t = -K_t u V/s,   |t| <= mu f,   K_t = 0.4 G/h (4 G/h),                          (OS2)
!! Coulomb's law with an elastic way before it slides; beyond the limit u is cut back to it.
!!
!! The forces act at the face. Particles bring them to the grid where they are, with f w beside the
!! product of their stress and volume, and where stresses act at centres with
!!     A f/h,   A = h^2 xi (1 - xi)/2 - w^2/2                                                (OS3)
!! more at the centre above than at the one below, xi the place between them: so they get to the
!! nodes by the function whose gradient stresses see there, and a uniform stress is in equilibrium
!! with them (sgmp_loads). And the face moves as it must for that to be the transpose: with the
!! strain e of its particle, and with those at the centres,
!!     dx_f = dx -+ w e - A (e_above - e_below),                                             (OS4)
!! - at a lower wall, + at an upper one. d and u follow the face, so springs give back what they
!! take. (Where d followed the centre alone, a body that stood on a floor lost a quarter of its
!! energy in thirty vibrations.) What a particle keeps for that, w - s/2 and u, begins anew where
!! it comes within a cell of the wall.
!!
!! Stresses have no moment: friction that came as f w would turn a body as if it acted at the
!! centres of its particles, and what rolls would roll on a smaller radius. So where stresses act at
!! centres friction is taken to the face itself, by
!!     -+ t w/h                                                                       (OS5)
!! more of it at the centre above than at the one below, - at a lower wall, with
!! A = h^2 xi_f (1 - xi_f)/2 at the place xi_f of the face; and the face goes along the wall by
!!     dx_f = dx -+ w (l_above + l_below)/2 - A (e_above - e_below),                     (OS6)
!! l the change of the displacement along it across it.
!!
!! Velocities lie half a step before the places that go with them. So the energy of a spring that
!! adds up with theirs is K d d' V/(2 s), d and d' the depths before and after a step, and not
!! K d'^2 V/(2 s): the difference is a sum of its own, which the account takes back a step later.
!!
!! Springs bear what a body bears at the start, where it begins with a stress on a wall: by a depth
!! more, and a way along it, that make (OS1) and (OS2) the traction there.
module sgmp_one_sided
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_sums, only: sum_applied, sum_springs, sweep_sums
  implicit none
  private
  public :: one_sided_arms, one_sided_drift, one_sided_face, one_sided_flux, one_sided_forces, &
            one_sided_gap, one_sided_levers, one_sided_load, one_sided_push, &
            one_sided_reached, one_sided_strain

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
        if (.not. one_sided_reached(wall, motion(:, wall%axis))) cycle
        do l = 1, lanes
          if (live(l) <= 0.0_dp) cycle
          push = forces_on(mesh, wall, l, motion, state)
          do a = 1, mesh%ndim
            if (wall%columns(a) == 0) cycle
            force(l, wall%columns(a)) = force(l, wall%columns(a)) + push(a)
            if (wall%turns .and. a /= wall%axis) cycle
            associate (stress => flux(l, one_sided_flux(mesh, wall, a)))
              stress = stress + to_face(wall, state(l, wall%half))*inwards(wall)*push(a)
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
  !! the one below, component by component: to stresses (OS3), and to forces (OS5); zero where
  !! nothing is pushed.
  pure subroutine one_sided_levers(mesh, wall, live, motion, state, xi, levers, shifts, some)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: live(lanes), motion(lanes, *), state(lanes, *)
    real(dp), intent(in) :: xi(lanes)            !! place along the axis, from the centre below
    real(dp), intent(out) :: levers(lanes, 3), shifts(lanes, 3)
    logical, intent(out) :: some                 !! some are pushed
    real(dp) :: arms(lanes, 3), ways(lanes, 3), push(3)
    integer :: a, l
    levers = 0.0_dp
    shifts = 0.0_dp
    some = one_sided_reached(wall, motion(:, wall%axis))
    if (.not. some) return
    do a = 1, 3
      arms(:, a) = one_sided_arms(mesh, wall, a, xi, state)
      ways(:, a) = one_sided_face(mesh, wall, a, state)
    end do
    do l = 1, lanes
      if (live(l) <= 0.0_dp) cycle
      push = forces_on(mesh, wall, l, motion, state)
      levers(l, :) = arms(l, :)*push
      shifts(l, :) = ways(l, :)*push
    end do
    some = any(abs(levers) > 0.0_dp) .or. any(abs(shifts) > 0.0_dp)
  end subroutine one_sided_levers

  !> Their arms over the cell side for a component, A/h (OS3, OS5).
  pure function one_sided_arms(mesh, wall, a, xi, state) result(arms)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: a
    real(dp), intent(in) :: xi(lanes)            !! place along the axis, from the centre below
    real(dp), intent(in) :: state(lanes, *)
    real(dp) :: arms(lanes), place(lanes)
    place = xi + one_sided_face(mesh, wall, a, state)
    arms = 0.5_dp*mesh%h*place*(1.0_dp - place)
    if (wall%turns .and. a /= wall%axis) return
    arms = arms - 0.5_dp*mesh%inverse_h*to_face(wall, state(:lanes, wall%half))**2
  end function one_sided_arms

  !> The way (cells) by which a component of the forces is taken to the face (OS5).
  pure function one_sided_face(mesh, wall, a, state) result(ways)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: a
    real(dp), intent(in) :: state(lanes, *)
    real(dp) :: ways(lanes)
    ways = 0.0_dp
    if (.not. wall%turns .or. a == wall%axis) return
    ways = -inwards(wall)*mesh%inverse_h*to_face(wall, state(:lanes, wall%half))
  end function one_sided_face

  !> Moves the particles of a chunk along walls and books the energy that these give to them.
  pure subroutine one_sided_drift(mesh, walls, live, motion, drifted, state, sums)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes), motion(lanes, *)
    real(dp), intent(in) :: drifted(lanes, *)    !! way to the new places
    real(dp), intent(inout) :: state(lanes, *)   !! volumes first
    real(dp), intent(inout) :: sums(lanes, sweep_sums)
    real(dp) :: gone(3)
    integer :: l, w, n
    n = mesh%ndim
    gone = 0.0_dp
    do w = 1, size(walls)
      associate (wall => walls(w), place => motion(:, walls(w)%axis))
        if (.not. any(near(wall, place, most=2.0_dp))) cycle
        do l = 1, lanes
          if (live(l) <= 0.0_dp) cycle
          gone(:n) = drifted(l, :n)
          if (near(wall, place(l), most=1.0_dp)) then
            call move_face(mesh, wall, l, place(l), gone, .false., state, sums)
          else if (near(wall, place(l) + mesh%inverse_h*gone(wall%axis), most=1.0_dp)) then
            call forget(mesh, wall, l, state)
          end if
        end do
      end associate
    end do
  end subroutine one_sided_drift

  !> Moves faces as their particles are strained, and by their levers (OS4).
  pure subroutine one_sided_strain(mesh, walls, live, motion, state, dt, gradient, jumps, sums)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    real(dp), intent(in) :: live(lanes), motion(lanes, *)
    real(dp), intent(inout) :: state(lanes, *)
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: gradient(lanes, mesh%ndim, *)  !! of the velocity (axis, component)
    real(dp), intent(in) :: jumps(lanes, 3, *)
      !! minus the velocities of faces by levers (OS4), and by all that is not dx in (OS6), per wall
    real(dp), intent(inout) :: sums(lanes, sweep_sums)
    real(dp) :: rate, gone(3)
    integer :: a, l, w
    gone = 0.0_dp
    do w = 1, size(walls)
      associate (wall => walls(w), n => walls(w)%axis)
        if (.not. one_sided_reached(wall, motion(:, n))) cycle
        do l = 1, lanes
          if (live(l) <= 0.0_dp .or. .not. near(wall, motion(l, n), most=1.0_dp)) cycle
          do a = 1, mesh%ndim
            rate = gradient(l, n, a)
            if (a /= n) rate = merge(0.0_dp, rate + gradient(l, a, n), wall%turns)
            gone(a) = -dt*(inwards(wall)*to_face(wall, state(l, wall%half))*rate + jumps(l, a, w))
          end do
          call move_face(mesh, wall, l, motion(l, n), gone, .true., state, sums)
        end do
      end associate
    end do
  end subroutine one_sided_strain

  !> Moves the face of a particle with its centre, or, to where the next force acts, from it, and
  !! books the energy that springs give.
  pure subroutine move_face(mesh, wall, l, place, gone, settles, state, sums)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: l                     !! lane
    real(dp), intent(in) :: place                !! of the particle before (cells)
    real(dp), intent(in) :: gone(3)              !! way of its face
    logical, intent(in) :: settles               !! it moves from the centre
    real(dp), intent(inout) :: state(lanes, *), sums(lanes, sweep_sums)
    real(dp) :: area, before, after
    area = state(l, 1)/wall%spacing
    before = to_face(wall, state(l, wall%half)) - &
             mesh%h*inwards(wall)*(place - wall%place)
    after = max(before - inwards(wall)*gone(wall%axis), 0.0_dp)
    before = max(before, 0.0_dp)
    if (settles) state(l, wall%half) = state(l, wall%half) - inwards(wall)*gone(wall%axis)
    associate (work => sums(l, sum_applied), ahead => sums(l, sum_springs))
      work = work + area*(energy(wall, before) - energy(wall, after))
      ahead = ahead + 0.5_dp*area*pressure(wall, after)*(after - before)
    end associate
    if (wall%way > 0) call rub(mesh, wall, l, [before, after], gone, settles, state, sums)
  end subroutine move_face

  !> The way of a face along a rough wall and the work of the force in the middle, that of friction
  !! where it slides. When the face is where the next force acts, the way is cut back to what
  !! friction holds, and forgotten where the face has left.
  pure subroutine rub(mesh, wall, l, deep, moved, settles, state, sums)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: l                     !! lane
    real(dp), intent(in) :: deep(2)              !! depth of the face before and after
    real(dp), intent(in) :: moved(3)             !! its way between
    logical, intent(in) :: settles               !! it is where the next force acts
    real(dp), intent(inout) :: state(lanes, *), sums(lanes, sweep_sums)
    real(dp) :: way(3), old(3), new(3), gone(3)
    integer :: a, n
    n = mesh%ndim
    old = 0.0_dp
    gone = 0.0_dp
    do a = 1, n
      if (a == wall%axis) cycle
      old(a) = state(l, wall%way + a - 1)
      gone(a) = moved(a)
    end do
    way = old + gone
    old = held(wall, deep(1), old)
    new = held(wall, deep(merge(2, 1, settles)), way)
    associate (half => 0.5_dp*wall%grip*state(l, 1)/wall%spacing)
      sums(l, sum_applied) = sums(l, sum_applied) - half*dot_product(old + new, gone)
      sums(l, sum_springs) = sums(l, sum_springs) + half*dot_product(new, new - old)
    end associate
    if (settles) way = new
    do a = 1, n
      if (a /= wall%axis) state(l, wall%way + a - 1) = way(a)
    end do
  end subroutine rub

  !> As much of a way along a rough wall as friction holds where the face is so deep (OS2).
  pure function held(wall, deep, way) result(part)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: deep, way(3)
    real(dp) :: part(3)
    real(dp) :: length, most
    part = 0.0_dp
    if (deep <= 0.0_dp) return
    part = way
    length = norm2(way)
    most = min(wall%friction*(pressure(wall, deep)/wall%grip), huge(1.0_dp))
    if (length > most) part = way*(most/length)
  end function held

  !> Forces of a wall on a particle.
  pure function one_sided_forces(mesh, wall, place, state) result(forces)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    real(dp), intent(in) :: state(:)             !! its columns, the volume first
    real(dp) :: forces(3)
    real(dp) :: deep
    forces = 0.0_dp
    deep = depth(mesh, wall, place, state(wall%half))
    if (.not. deep > 0.0_dp) return
    if (wall%way > 0) forces(:mesh%ndim) = -wall%grip*state(wall%way:wall%way + mesh%ndim - 1)
    forces(wall%axis) = inwards(wall)*pressure(wall, deep)
    forces = forces*(state(1)/wall%spacing)
  end function one_sided_forces

  !> The same of a particle in its lane.
  pure function forces_on(mesh, wall, l, motion, state) result(forces)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: l
    real(dp), intent(in) :: motion(lanes, *), state(lanes, *)
    real(dp) :: forces(3)
    forces = one_sided_forces(mesh, wall, motion(l, wall%axis), &
                              state(l, :max(wall%half, wall%way + mesh%ndim - 1)))
  end function forces_on

  !> Lets the springs of a wall bear the stress with which a particle begins at it, if its face lies
  !! there and is pressed on it.
  pure subroutine one_sided_load(mesh, wall, stress, place, state)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: stress(3)            !! at the face: components with the wall's axis
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    real(dp), intent(inout) :: state(:)          !! its columns
    real(dp), parameter :: beside = 0.1_dp       !! spacings between such a face and the wall
    real(dp) :: way(3), length, most
    integer :: n
    n = wall%axis
    if (stress(n) >= 0.0_dp) return
    if (depth(mesh, wall, place, state(wall%half) + beside*wall%spacing) <= 0.0_dp) return
    state(wall%half) = state(wall%half) + depth_of(wall, abs(stress(n)))
    if (wall%way == 0) return
    way = inwards(wall)*stress/wall%grip
    way(n) = 0.0_dp
    length = norm2(way)
    most = min(wall%friction*(abs(stress(n))/wall%grip), huge(1.0_dp))
    if (length > most) way = way*(most/length)
    way(n) = state(wall%half)
    state(wall%way:wall%way + mesh%ndim - 1) = way(:mesh%ndim)
  end subroutine one_sided_load

  !> From the face of a particle to a wall, negative behind it, if it lies half a spacing away from
  !! the centre.
  pure real(dp) function one_sided_gap(mesh, wall, place) result(gap)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place                !! of the particle along the axis (cells)
    gap = mesh%h*inwards(wall)*(place - wall%place) - to_face(wall, 0.0_dp)
  end function one_sided_gap

  !> Forgets a particle's way and stretch.
  pure subroutine forget(mesh, wall, l, state)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    integer, intent(in) :: l                     !! lane
    real(dp), intent(inout) :: state(lanes, *)
    if (wall%way > 0) state(l, wall%way:wall%way + mesh%ndim - 1) = 0.0_dp
    state(l, wall%half) = 0.0_dp
    if (wall%rim > 0) state(l, wall%half) = state(l, wall%rim)
  end subroutine forget

  !> Whether particles of a chunk may have come to a wall.
  pure logical function one_sided_reached(wall, places) result(yes)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: places(lanes)
    yes = any(near(wall, places, most=1.0_dp))
  end function one_sided_reached

  !> Whether a particle is near a wall.
  elemental logical function near(wall, place, most) result(yes)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place, most          !! distance (cells)
    yes = inwards(wall)*(place - wall%place) < most
  end function near

  !> What the springs of a wall press with at a depth (OS1).
  elemental real(dp) function pressure(wall, depth) result(push)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: depth
    push = wall%stiffness*depth + (wall%hard - wall%stiffness)*min(depth, wall%bed)
  end function pressure

  !> The depth at which they press so.
  elemental real(dp) function depth_of(wall, pressure) result(depth)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: pressure
    depth = 0.0_dp
    if (wall%bed > 0.0_dp) depth = min(pressure/wall%hard, wall%bed)
    depth = depth + (pressure - wall%hard*depth)/wall%stiffness
  end function depth_of

  !> Their energy per area there.
  elemental real(dp) function energy(wall, depth) result(stored)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: depth
    associate (first => min(depth, wall%bed))
      stored = 0.5_dp*wall%stiffness*depth**2 + &
               (wall%hard - wall%stiffness)*first*(depth - 0.5_dp*first)
    end associate
  end function energy

  !> How far the face of a particle has come through a wall; 0: not at all.
  elemental function depth(mesh, wall, place, more) result(way)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: place
    real(dp), intent(in) :: more                 !! what a particle keeps of its half
    real(dp) :: way
    way = max(to_face(wall, more) - mesh%h*inwards(wall)*(place - wall%place), 0.0_dp)
  end function depth

  !> From the centre of a particle to its face.
  elemental real(dp) function to_face(wall, more) result(way)
    type(one_sided_wall_t), intent(in) :: wall
    real(dp), intent(in) :: more                 !! than half its spacing
    way = 0.5_dp*wall%spacing + more
  end function to_face

  !> The way from a wall into the grid along its axis.
  elemental real(dp) function inwards(wall) result(way)
    type(one_sided_wall_t), intent(in) :: wall
    way = merge(1.0_dp, -1.0_dp, wall%side == 1)
  end function inwards

end module sgmp_one_sided
