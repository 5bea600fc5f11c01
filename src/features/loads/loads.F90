! dimension-generic, axisymmetric
#include "dimension.inc"
!> External forces on a chunk of particles: body forces, loads that are shared out by mass, pressure
!! and traction on faces (doc/loads.md).
!!
!! The faces of a particle have an area vector a, which follows the deformation (Nanson), and act in
!! their middle: where V is the particle's volume, V/2 lies between them and its centre, so that the
!! middle is at x + a V/(2 |a|^2). There the grid receives their force, by the functions of the
!! particle continued linearly. Where stresses act at centres these are not the functions whose
!! gradients the stresses see: along the normal, those have at a place xi between two centres
!! (1 - xi)^2/2, 1/2 + xi (1 - xi), xi^2/2 at the nodes, the means of linear functions at the
!! centres (1 - xi)/2, 1/2, xi/2. What is missing is the force of a stress -/+ xi (1 - xi)/2 h at
!! the centres per force: the lever. With it a pressure on a face and a uniform stress behind it are
!! in equilibrium. Where strains are corrected at surfaces, stresses see those functions across the
!! normal, too, and there are levers along all axes.
module DIM(sgmp_loads)
  use sgmp_air_blast, only: air_blast_pressure
  use sgmp_body, only: body_t
  use sgmp_columns, only: twist_takes
  use sgmp_expression, only: expression_places, expression_t, expression_time
  use DIM(sgmp_graded_loads), only: graded_loads_aside, graded_loads_off, graded_loads_sides
  use sgmp_kinds, only: dp, lanes
  use sgmp_load, only: load_absorbing, load_blast, load_force, load_pressure, load_t
  use sgmp_mesh, only: mesh_place, mesh_t
  use sgmp_motion, only: motion_total
  use CARTESIAN(sgmp_reference), only: reference_way_now
  use sgmp_sums, only: sum_applied, sum_edge_impulse, sum_edge_work, sweep_sums
  implicit none
  private
  public :: loads_book, loads_book_strain, loads_halve, loads_impedance, loads_levers, &
            loads_on_faces, loads_on_mass, loads_some, loads_spring, loads_strain, loads_twist

contains

  !> Body force (Eq. 24) and the particles' shares in forces.
  subroutine loads_on_mass(mesh, body, time, mass, nb, motion, state, force)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: time, mass(lanes)      !! zero for pads
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: force(lanes, NDIM)  !! added to
    real(dp) :: places(lanes, expression_places)
    integer :: i, d
    call take_places(mesh, body, time, nb, motion, state, places)
    do d = 1, NDIM
      call add_force(body%force(d), places, mass, force(:, d))
    end do
    if (.not. allocated(body%loads)) return
    do i = 1, size(body%loads)
      associate (load => body%loads(i))
        if (load%kind /= load_force) cycle
        do d = 1, NDIM
          call add_force(load%value(d), places, mass*state(:, load%column), force(:, d))
        end do
      end associate
    end do
  end subroutine loads_on_mass

  !> Whether some particle of a chunk has a face that a load acts on.
  pure function loads_some(body, nb, state) result(some)
    type(body_t), intent(in) :: body
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    logical :: some
    integer :: i, d
    some = .true.
    do i = 1, size(body%loads)
      if (body%loads(i)%kind == load_force) cycle
      do d = body%loads(i)%column, body%loads(i)%column + NDIM - 1
        if (any(abs(state(:, d)) > 0.0_dp)) return
      end do
    end do
    some = .false.
  end function loads_some

  !> Pressure, traction or air blast on the faces of a chunk: force, and the way from the centres to
  !! where it acts; zero where there are no faces.
  subroutine loads_on_faces(mesh, body, load, time, live, nb, motion, state, force, way, some)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(load_t), intent(in) :: load
    real(dp), intent(in) :: time, live(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(out) :: force(lanes, NDIM)
    real(dp), intent(out) :: way(lanes, NDIM)      !! (cells)
    logical, intent(out) :: some                   !! there are faces
    real(dp) :: places(lanes, expression_places), area(lanes, NDIM), square(lanes), weight(lanes)
    real(dp) :: pressure(lanes)
    integer :: d
    square = 0.0_dp
    do d = 1, NDIM
      area(:, d) = live*state(:, load%column + d - 1)
      square = square + area(:, d)**2
    end do
    some = any(square > 0.0_dp)
    force = 0.0_dp
    way = 0.0_dp
    if (.not. some) return
    weight = 0.5_dp*mesh%inverse_h*state(:, body%law%slots%volume)/ &
             merge(square, 1.0_dp, square > 0.0_dp)
    do d = 1, NDIM
      way(:, d) = weight*area(:, d)
    end do
    if (body%law%slots%reference > 0) then
      call reference_way_now(state(1, body%law%slots%reference + NDIM), &
                             mesh%inverse_h*state(:, body%law%slots%volume), area, way)
    end if
    call take_places(mesh, body, time, nb, motion, state, places)
    places(:, :NDIM) = places(:, :NDIM) + mesh%h*way
    if (mesh%graded) way = way/graded_loads_sides(mesh, motion)
    select case (load%kind)
    case (load_absorbing)
      call edge_force(load, nb, state, sqrt(square), force)
    case (load_blast)
      call add_blast(load, time, places, area, force)
    case (load_pressure)
      pressure = 0.0_dp
      call add_force(load%value(1), places, merge(1.0_dp, 0.0_dp, square > 0.0_dp), pressure)
      do d = 1, NDIM
        force(:, d) = -pressure*area(:, d)
      end do
    case default  ! load_traction
      do d = 1, NDIM
        call add_force(load%value(d), places, sqrt(square), force(:, d))
      end do
    end select
  end subroutine loads_on_faces

  !> Adds the force of an air blast on the faces of a chunk.
  pure subroutine add_blast(load, time, places, area, force)
    type(load_t), intent(in) :: load
    real(dp), intent(in) :: time
    real(dp), intent(in) :: places(lanes, expression_places)
    real(dp), intent(in) :: area(lanes, NDIM)      !! zero where there is no face
    real(dp), intent(inout) :: force(lanes, NDIM)
    real(dp) :: normal(3), place(3)
    integer :: l
    normal = 0.0_dp
    place = 0.0_dp
    do l = 1, lanes
      if (all(abs(area(l, :)) <= 0.0_dp)) cycle
      normal(:NDIM) = area(l, :)
      place(:NDIM) = places(l, :NDIM)
      force(l, :) = force(l, :) - air_blast_pressure(load%blast, place, normal, time)*area(l, :)
    end do
  end subroutine add_blast

  !> What edges that let waves out bear at rest, on the faces of a chunk.
  pure subroutine edge_force(load, nb, state, area, force)
    type(load_t), intent(in) :: load
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    real(dp), intent(in) :: area(lanes)            !! 0 where there is no face
    real(dp), intent(out) :: force(lanes, NDIM)
    integer :: d
    do d = 1, NDIM
      force(:, d) = area*state(:, load%column + NDIM + d - 1)
    end do
  end subroutine edge_force

  !> Force per velocity along each axis by which an edge holds the faces of a chunk (Lysmer and
  !! Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969, 859-877): nodes work the force out (sgmp_nodes).
  pure subroutine loads_impedance(load, live, nb, state, impedance)
    type(load_t), intent(in) :: load
    real(dp), intent(in) :: live(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    real(dp), intent(out) :: impedance(lanes, NDIM)
    integer :: d
    do d = 1, NDIM
      impedance(:, d) = load%impedance(merge(1, 2, d == load%axis))*face_area(load, live, nb, state)
    end do
  end subroutine loads_impedance

  !> Area of the faces of a chunk; 0 where there are none.
  pure function face_area(load, live, nb, state) result(area)
    type(load_t), intent(in) :: load
    real(dp), intent(in) :: live(lanes)
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    real(dp) :: area(lanes)
    area = live*sqrt(sum(state(:, load%column:load%column + NDIM - 1)**2, dim=2))
  end function face_area

  !> Adds up what forces on faces do to a chunk: their work on the way that particles go with the
  !! grid, and of what edges bear at rest the work and the impulse.
  subroutine loads_book(mesh, body, time, dt, live, moved, nb, motion, state, sums)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: time                   !! of the forces
    real(dp), intent(in) :: dt                     !! velocity step; 0: no kick
    real(dp), intent(in) :: live(lanes)
    real(dp), intent(in) :: moved(lanes, NDIM)     !! the way, or this sweep's part of it
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: sums(lanes, sweep_sums)
    real(dp) :: force(lanes, NDIM), way(lanes, NDIM), work(lanes)
    logical :: some
    integer :: i, d
    do i = 1, size(body%loads)
      associate (load => body%loads(i))
        if (load%kind == load_force) cycle
        call loads_on_faces(mesh, body, load, time, live, nb, motion, state, force, way, some)
        if (.not. some) cycle
        work = sum(force*moved, dim=2)
        sums(:, sum_applied) = sums(:, sum_applied) + work
        if (load%kind /= load_absorbing) cycle
        sums(:, sum_edge_work) = sums(:, sum_edge_work) + work
        do d = 1, NDIM
          sums(:, sum_edge_impulse + d - 1) = sums(:, sum_edge_impulse + d - 1) + dt*force(:, d)
        end do
      end associate
    end do
  end subroutine loads_book

  !> The rest of the work of forces on faces: they move away from the centres of their particles as
  !! those are strained.
  subroutine loads_book_strain(mesh, body, time, dt, live, gradient, nb, motion, state, sums)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: time, dt, live(lanes), gradient(lanes, NGRAD)
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: sums(lanes, sweep_sums)
    real(dp) :: force(lanes, NDIM), way(lanes, NDIM)
    logical :: some
    integer :: i, a, b
    do i = 1, size(body%loads)
      if (body%loads(i)%kind == load_force) cycle
      call loads_on_faces(mesh, body, body%loads(i), time, live, nb, motion, state, force, way, &
                          some)
      if (.not. some) cycle
      if (mesh%graded) call grade_way(mesh, body%linear, motion, way)
      do a = 1, NDIM
        do b = 1, NDIM
          sums(:, sum_applied) = sums(:, sum_applied) + dt*mesh%h*force(:, a)*way(:, b)* &
                                 gradient(:, (a - 1)*NDIM + b)
        end do
      end do
    end do
  end subroutine loads_book_strain

  !> The way to faces in smallest cells, as far as forces there do work on the strain.
  pure subroutine grade_way(mesh, linear, motion, way)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                  !! of the body's field
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: way(lanes, NDIM)
    real(dp) :: aside(lanes, NDIM, 2), xi(lanes)
    integer :: d
    if (linear) then
      way = way*graded_loads_sides(mesh, motion) + graded_loads_off(mesh, motion)
      return
    end if
    aside = graded_loads_aside(mesh, motion, way)
    way = way*graded_loads_sides(mesh, motion)
    do d = 1, NDIM
      xi = motion(:, d) - 0.5_dp
      xi = xi - floor(xi)
      way(:, d) = way(:, d) - mesh%inverse_h*((1.0_dp - xi)*aside(:, d, 1) + xi*aside(:, d, 2))
    end do
  end subroutine grade_way

  !> Levers of forces on faces along each axis (length), the gradients of the centres' weights per
  !! cell left out.
  pure function loads_levers(mesh, motion, place, way, corrected) result(levers)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(in) :: place(lanes, NDIM)     !! of the force, from the centre below (cells)
    real(dp), intent(in) :: way(lanes, NDIM)       !! to there from the particle
    logical, intent(in) :: corrected               !! strains are (doc/surfaces.md)
    real(dp) :: levers(lanes, NDIM)
    real(dp) :: square(lanes), sides(lanes, NDIM)
    integer :: d
    sides = 1.0_dp
    if (mesh%graded) sides = graded_loads_sides(mesh, motion)
    square = max(sum((sides*way)**2, dim=2), tiny(1.0_dp))
    do d = 1, NDIM
      levers(:, d) = 0.5_dp*mesh%h*place(:, d)*(1.0_dp - place(:, d))
      if (.not. corrected) levers(:, d) = levers(:, d)*((sides(:, d)*way(:, d))**2/square)
      if (mesh%graded) levers(:, d) = sides(:, d)*levers(:, d)
    end do
  end function loads_levers

  !> Product of the levers along the axes of a twist (cells); forces push against second differences
  !! and along third ones (sgmp_surfaces).
  pure function loads_twist(twist, place) result(lever)
    integer, intent(in) :: twist
    real(dp), intent(in) :: place(lanes, NDIM)     !! of the force, from the centre below (cells)
    real(dp) :: lever(lanes)
    integer :: d, axes
    lever = 1.0_dp
    axes = 0
    do d = 1, NDIM
      if (.not. twist_takes(twist, d, NDIM)) cycle
      lever = lever*(0.5_dp*place(:, d)*(1.0_dp - place(:, d)))
      axes = axes + 1
    end do
    if (axes == 2) lever = -lever
  end function loads_twist

  !> Lets the area vectors of faces follow a step: a' = cof(I + dt L) a. In the linear theory they
  !! stay as they are, as volumes do.
  pure subroutine loads_strain(body, dt, gradient, nb, state)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: gradient(lanes, NGRAD)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb)
    real(dp) :: f(NDIM, NDIM), cofactor(NDIM, NDIM)
    integer :: i, l, a
    if (body%law%small_strain) return
    do i = 1, size(body%loads)
      associate (load => body%loads(i))
        if (load%kind == load_force) cycle
        do l = 1, lanes
          associate (area => state(l, load%column:load%column + NDIM - 1))
            if (all(abs(area) <= 0.0_dp)) cycle
            do a = 1, NDIM
              f(a, :) = dt*gradient(l, (a - 1)*NDIM + 1:a*NDIM)
              f(a, a) = 1.0_dp + f(a, a)
            end do
            cofactor = cofactors(f)
#ifdef AXISYMMETRIC
            cofactor = (1.0_dp + dt*gradient(l, NGRAD))*cofactor  ! the ring grows longer
#endif
            area = matmul(cofactor, area)
          end associate
        end do
      end associate
    end do
  end subroutine loads_strain

  !> Faces of one half of the particles that are split (sgmp_splitting): those along the axis of the
  !! split are cut as the volume is, those across it belong to the half on their side, with what
  !! little they have along it.
  pure subroutine loads_halve(body, side, axis, share, nb, state)
    type(body_t), intent(in) :: body
    integer, intent(in) :: side, axis(lanes)       !! -1 or +1; 0: not split
    real(dp), intent(in) :: share(lanes)           !! of the half in the volume
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb)
    real(dp), parameter :: little = 0.1_dp
    real(dp) :: across, along
    integer :: i, l
    do i = 1, size(body%loads)
      if (body%loads(i)%kind == load_force) cycle
      do l = 1, lanes
        if (axis(l) == 0) cycle
        associate (area => state(l, body%loads(i)%column:body%loads(i)%column + NDIM - 1))
          across = area(axis(l))
          along = sqrt(max(sum(area**2) - across**2, 0.0_dp))
          if (along < little*abs(across)) then
            if (side*across < 0.0_dp) area = 0.0_dp
          else
            area = share(l)*area
            area(axis(l)) = merge(across, 0.0_dp, side*across > 0.0_dp)
          end if
        end associate
      end do
    end do
  end subroutine loads_halve

  !> Lets edges with springs bear more, or less, by the way of a step: what they bear at rest grows
  !! by -k/r times it, and by a part across them that fades (sgmp_absorbing_build).
  pure subroutine loads_spring(mesh, body, dt, moved, nb, motion, state)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: moved(lanes, NDIM)     !! (length)
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: state(lanes, nb)
    real(dp) :: distance(lanes), before(lanes)
    integer :: i, d
    do i = 1, size(body%loads)
      associate (load => body%loads(i))
        if (load%fading <= 0.0_dp) cycle
        distance = 0.0_dp
        do d = 1, NDIM
          distance = distance + (mesh_place(mesh, d, motion(:, d)) - load%source(d))**2
        end do
        distance = sqrt(max(distance, mesh%h**2))
        do d = 1, NDIM
          associate (rest => state(:, load%column + NDIM + d - 1))
            rest = rest - load%springs(merge(1, 2, d == load%axis))*moved(:, d)/distance
          end associate
        end do
        associate (fades => state(:, load%column + 2*NDIM), &
                   rest => state(:, load%column + NDIM + load%axis - 1))
          before = fades
          fades = (fades + load%fading*moved(:, load%axis)/distance)/ &
                  (1.0_dp + dt*load%speed/distance)
          rest = rest + fades - before
        end associate
      end associate
    end do
  end subroutine loads_spring

  !> The cofactors of a matrix.
  pure function cofactors(f) result(cofactor)
    real(dp), intent(in) :: f(NDIM, NDIM)
    real(dp) :: cofactor(NDIM, NDIM)
#if NDIM == 1
    cofactor = 1.0_dp + 0.0_dp*f
#elif NDIM == 2
    cofactor = reshape([f(2, 2), -f(1, 2), -f(2, 1), f(1, 1)], [2, 2])
#else
    integer :: i, j
    do j = 1, 3
      do i = 1, 3
        associate (i1 => mod(i, 3) + 1, i2 => mod(i + 1, 3) + 1, &
                   j1 => mod(j, 3) + 1, j2 => mod(j + 1, 3) + 1)
          cofactor(i, j) = f(i1, j1)*f(i2, j2) - f(i1, j2)*f(i2, j1)
        end associate
      end do
    end do
#endif
  end function cofactors

  !> What formulas may use of the particles of a chunk.
  pure subroutine take_places(mesh, body, time, nb, motion, state, places)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: time
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(out) :: places(lanes, expression_places)
    integer :: d
    places = 0.0_dp
    places(:, expression_time) = time
    do d = 1, NDIM
      if (mesh%graded) then
        places(:, d) = mesh_place(mesh, d, motion(:, d))
      else
        places(:, d) = mesh%origin(d) + mesh%h*motion(:, d)
      end if
      if (body%law%slots%initial > 0) places(:, 3 + d) = state(:, body%law%slots%initial + d - 1)
    end do
  end subroutine take_places

  !> Adds weight times a formula; where all places give the same value it is worked out once.
  subroutine add_force(formula, places, weight, force)
    type(expression_t), intent(in) :: formula
    real(dp), intent(in) :: places(lanes, expression_places), weight(lanes)
    real(dp), intent(inout) :: force(lanes)
    real(dp) :: values(lanes)
    if (formula%uses_position .or. formula%uses_initial_position) then
      call formula%evaluate_lanes(places, abs(weight) > 0.0_dp, values)
    else
      values = formula%evaluate(places(1, :3), places(1, 4:6), places(1, expression_time))
    end if
    force = force + weight*values
  end subroutine add_force

end module DIM(sgmp_loads)
