! dimension-generic, axisymmetric
#include "dimension.inc"
!> What particles that have changed bins give to the grid, once they are in their new bins: added to
!! the sums of some planes in the order of bins and ids, as a sweep would have done.
module DIM(sgmp_sweep_movers)
  use sgmp_body, only: body_t
  use DIM(sgmp_chunk), only: axes_moved, largest_stencil, most_columns, particle_axes, task_make, &
                             task_t, twist_ends
  use sgmp_columns, only: twists
  use sgmp_field, only: field_t
  use DIM(sgmp_graded_loads), only: graded_loads_aside, graded_loads_sides, &
                                    graded_loads_slopes, graded_loads_twist
  use sgmp_kinds, only: dp, lanes
  use sgmp_load, only: load_force
  use DIM(sgmp_loads), only: loads_levers, loads_on_faces, loads_twist
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_total
  use sgmp_movers, only: movers_t
  use sgmp_one_sided, only: one_sided_flux, one_sided_levers
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_plan, only: plan_t
  use sgmp_rebinning, only: arrivals_t
  use CARTESIAN(sgmp_scatter), only: pair_ends, pair_spans, stride_of
  use CARTESIAN(sgmp_transfer), only: flux_of, linear_gradients, linear_weights
  use CARTESIAN(sgmp_transfer_product), only: product_gradients, product_weights
  implicit none
  private
  public :: sweep_add_movers

  !> What movers that come into one cell after the other give to the points of its stencil.
  type :: pile_t
    integer :: planes(2) = 0                      !! range of planes of the field to add to
    integer :: cell = 0, row = 0, plane = 1  !! cell along x, interval of its bin (0: none), plane
    real(dp) :: sums(largest_stencil, most_columns) = 0.0_dp  !! (points, x outermost; columns)
  end type pile_t

contains

  !> Adds particles that changed bins to some planes of the moments, cell by cell, so that
  !! each sum has the order of the bins and in each of the ids. Threads take planes; weights are
  !! computed for as many movers at a time as a chunk has lanes.
  subroutine sweep_add_movers(mesh, field, body, plan, lists, arrivals, planes)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(movers_t), intent(in) :: lists(:)       !! in their new bins
    type(arrivals_t), intent(in) :: arrivals     !! their order; all that reach the planes
    integer, intent(in) :: planes(2)             !! first and last plane to add to
    type(task_t) :: task
    type(pile_t) :: pile
    integer :: r, r2
    task = task_make(field%kernel, field%columns, mesh, plan)
    pile%planes = planes
    do r = 1, arrivals%n, lanes
      r2 = min(r + lanes - 1, arrivals%n)
      call pile_movers(mesh, field, body, plan, task, lists, arrivals%list(r:r2), &
                       arrivals%at(r:r2), pile)
    end do
    call add_pile(body, plan, task, pile, field)
  end subroutine sweep_add_movers

  !> Piles up what some movers give to the grid; a pile is added to the moments when the next bin
  !! begins.
  subroutine pile_movers(mesh, field, body, plan, task, lists, list, at, pile)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    type(movers_t), intent(in) :: lists(:)
    integer, intent(in) :: list(:), at(:)        !! (<= lanes) movers
    type(pile_t), intent(inout) :: pile
    real(dp) :: w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM), xi(lanes, NDIM)
    real(dp), allocatable :: force(:, :, :), w_face(:, :, :), levers(:, :, :), &
        g_face(:, :, :, :)                       ! of the loads on faces
    real(dp), allocatable :: levers_walls(:, :, :), shifts(:, :, :), slopes(:, :, :)
                                                 ! of walls that let go
    logical :: forces
    integer :: cell, l
    forces = plan%stress .and. .not. task%centred
    call mover_weights(task, body, forces, lists, list, at, xi, w, g)
    if (body%faced .and. plan%faces > 0) then
      call mover_faces(mesh, body, plan, task, lists, list, at, xi, force, w_face, levers, g_face)
    end if
    if (task%push > 0 .and. task%centred) then
      call mover_walls(mesh, body%walls, lists, list, at, xi, levers_walls, shifts, slopes)
    end if
    do l = 1, size(at)
      associate (movers => lists(list(l)))
        cell = floor(movers%particle(1, at(l)) - body%particles%shift)
        if (movers%row(at(l)) /= pile%row .or. cell /= pile%cell) then
          call add_pile(body, plan, task, pile, field)
          pile%cell = cell
          pile%row = movers%row(at(l))
          pile%sums(:, :task%nq) = 0.0_dp
        end if
        call add_mover(task, forces, l, w, g, movers%values(1, at(l)), pile%sums)
        if (task%pairs > 0) call add_mover_pairs(task, xi(l, :), w(l, :), &
                                                 movers%values(1, at(l)), pile%sums)
        if (allocated(slopes)) then
          call add_mover_walls(mesh, body%walls, task, l, levers_walls, shifts, slopes, pile%sums)
        end if
        if (allocated(force)) call add_mover_faces(task, plan, l, force, w_face, levers, g_face, &
                                                   pile%sums)
      end associate
    end do
  end subroutine pile_movers


  !> Weights of some movers in their new bins, and where forces are scattered their gradients.
  pure subroutine mover_weights(task, body, gradients, lists, list, at, xi, w, g)
    type(task_t), intent(in) :: task
    type(body_t), intent(in) :: body
    logical, intent(in) :: gradients
    type(movers_t), intent(in) :: lists(:)
    integer, intent(in) :: list(:), at(:)        !! (<= lanes) movers
    real(dp), intent(out) :: xi(lanes, NDIM)     !! position in the cell
    real(dp), intent(out) :: w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM)
    real(dp) :: axes(lanes, 3, NDIM, 2), state(lanes, body%particles%state_columns), &
        slopes(lanes, NCORNER, NDIM)
    integer :: l
    xi = 0.5_dp
    state = 1.0_dp
    do l = 1, size(at)
      xi(l, :) = lists(list(l))%particle(:NDIM, at(l))
      xi(l, :) = (xi(l, :) - real(floor(xi(l, :) - body%particles%shift), dp)) &
          - body%particles%shift
      if (task%wide) state(l, :) = lists(list(l))%particle(motion_total(NDIM) + 1:, at(l))
    end do
    if (task%wide) then
      call particle_axes(body, task, body%particles%state_columns, state, xi, axes)
      call product_weights(axes(1, 1, 1, 1), w)
      if (gradients) call product_gradients(axes(1, 1, 1, 1), axes(1, 1, 1, 2), g)
    else
      call linear_weights(xi, w)
      if (gradients) call linear_gradients(xi, task%inverse_h, slopes)
      if (gradients) g(:, :NCORNER, :) = slopes
    end if
  end subroutine mover_weights

  !> Levers of the forces of walls that let go on some movers, and derivatives of the weights.
  pure subroutine mover_walls(mesh, walls, lists, list, at, xi, levers, shifts, slopes)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    type(movers_t), intent(in) :: lists(:)
    integer, intent(in) :: list(:), at(:)        !! (<= lanes) movers
    real(dp), intent(in) :: xi(lanes, NDIM)      !! position in the cell
    real(dp), allocatable, intent(out) :: levers(:, :, :), shifts(:, :, :)  !! (lanes, 3, walls)
    real(dp), allocatable, intent(out) :: slopes(:, :, :)  !! per cell
    real(dp), allocatable :: state(:, :)
    real(dp) :: live(lanes), motion(lanes, motion_total(NDIM))
    logical :: some
    integer :: l, w
    allocate (state(lanes, size(lists(list(1))%particle, 1) - motion_total(NDIM)), source=1.0_dp)
    live = 0.0_dp
    motion = 0.5_dp
    do l = 1, size(at)
      associate (particle => lists(list(l))%particle(:, at(l)))
        live(l) = 1.0_dp
        motion(l, :) = particle(:motion_total(NDIM))
        state(l, :) = particle(motion_total(NDIM) + 1:)
      end associate
    end do
    allocate (levers(lanes, 3, size(walls)), shifts(lanes, 3, size(walls)))
    allocate (slopes(lanes, NCORNER, NDIM))
    do w = 1, size(walls)
      call one_sided_levers(mesh, walls(w), live, motion, state, xi(:, walls(w)%axis), &
                            levers(:, :, w), shifts(:, :, w), some)
    end do
    call linear_gradients(xi, 1.0_dp, slopes)
  end subroutine mover_walls

  !> The same for one of them, added.
  pure subroutine add_mover_walls(mesh, walls, task, lane, levers, shifts, slopes, sums)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    type(task_t), intent(in) :: task
    integer, intent(in) :: lane
    real(dp), intent(in) :: levers(:, :, :), shifts(:, :, :), slopes(:, :, :)
    real(dp), intent(inout) :: sums(largest_stencil, most_columns)
    integer :: a, w
    do w = 1, size(walls)
      associate (wall => walls(w))
        do a = 1, NDIM
          if (wall%columns(a) == 0) cycle
          call add_product(NCORNER, levers(lane, a, w), slopes(lane, :, wall%axis), &
                           sums(1, task%pairs + task%forces + one_sided_flux(mesh, wall, a)))
          if (.not. wall%turns .or. a == wall%axis) cycle
          call add_product(NCORNER, shifts(lane, a, w), slopes(lane, :, wall%axis), &
                           sums(1, task%pairs + task%push + wall%columns(a) - 1))
        end do
      end associate
    end do
  end subroutine add_mover_walls

  !> Pressure and traction on the faces of some movers, and the weights where they act.
  subroutine mover_faces(mesh, body, plan, task, lists, list, at, xi, force, w, levers, g)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    type(movers_t), intent(in) :: lists(:)
    integer, intent(in) :: list(:), at(:)        !! (<= lanes) movers
    real(dp), intent(in) :: xi(lanes, NDIM)      !! position in the cell
    real(dp), allocatable, intent(out) :: force(:, :, :), w(:, :, :)
    real(dp), allocatable, intent(out) :: levers(:, :, :), g(:, :, :, :)  !! and gradients per cell
    real(dp) :: motion(lanes, motion_total(NDIM)), state(lanes, body%particles%state_columns), &
        axes(lanes, 3, NDIM, 2), live(lanes), way(lanes, NDIM), corners(lanes, NCORNER)
    logical :: some
    integer :: l, i
    motion = 0.5_dp
    state = 1.0_dp
    live = 0.0_dp
    do l = 1, size(at)
      associate (particle => lists(list(l))%particle(:, at(l)))
        motion(l, :) = particle(:motion_total(NDIM))
        state(l, :) = particle(motion_total(NDIM) + 1:)
        live(l) = 1.0_dp
      end associate
    end do
    allocate (force(lanes, NDIM, size(body%loads)), w(lanes, largest_stencil, size(body%loads)), &
              levers(lanes, NDIM, size(body%loads)), &
              g(lanes, NCORNER, NDIM + twists(NDIM), size(body%loads)), &
              source=0.0_dp)
    if (task%wide) call particle_axes(body, task, size(state, 2), state, xi, axes)
    do i = 1, size(body%loads)
      if (body%loads(i)%kind == load_force) cycle
      call loads_on_faces(mesh, body, body%loads(i), plan%time, live, size(state, 2), motion, &
                          state, force(:, :, i), way, some)
      if (.not. some) cycle
      if (task%wide) then
        call product_weights(axes_moved(axes, task%h*way), w(:, :, i))
      else
        call linear_weights(xi + way, corners)
        w(:, :NCORNER, i) = corners
        levers(:, :, i) = loads_levers(mesh, motion, xi + way, way, plan%corrected)
        call linear_gradients(xi + way, 1.0_dp, g(:, :, :NDIM, i))
        if (mesh%graded .and. .not. body%linear) then
          call aside_weights(mesh, motion, way, xi + way, levers(:, :, i), g(:, :, :NDIM, i))
        end if
        if (plan%corrected) call twist_weights(mesh, body%linear, motion, way, xi + way, &
                                               g(:, :, NDIM + 1:, i))
      end if
    end do
  end subroutine mover_faces

  !> Derivatives of the corners' weights times levers, which are 1 then, with what centres of
  !! unequal cells get beside them (sgmp_graded_loads).
  pure subroutine aside_weights(mesh, motion, way, place, levers, g)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(in) :: way(lanes, NDIM), place(lanes, NDIM)
    real(dp), intent(inout) :: levers(lanes, NDIM), g(lanes, NCORNER, NDIM)
    real(dp) :: aside(lanes, NDIM, 2), ends(lanes, NDIM), w(lanes, NCORNER), share(lanes)
    integer :: b, side
    aside = graded_loads_aside(mesh, motion, way)
    do b = 1, NDIM
      g(:, :, b) = spread(levers(:, b), 2, NCORNER)*g(:, :, b)
      do side = 0, 1
        ends = place
        ends(:, b) = side
        call linear_weights(ends, w)
        share = merge(place(:, b), 1.0_dp - place(:, b), side == 1)*aside(:, b, side + 1)
        g(:, :, b) = g(:, :, b) + spread(share, 2, NCORNER)*w
      end do
    end do
    levers = 1.0_dp
  end subroutine aside_weights

  !> Derivatives of the corners' weights along the axes of each twist, times their levers.
  pure subroutine twist_weights(mesh, linear, motion, way, place, g)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! of the body's field
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(in) :: way(lanes, NDIM), place(lanes, NDIM)
    real(dp), intent(out) :: g(lanes, NCORNER, twists(NDIM))
    real(dp) :: ends(lanes, NDIM), w(lanes, NCORNER), lever(lanes)
    real(dp) :: sides(lanes, NDIM), slopes(lanes, NDIM, 2), aside(lanes, NDIM, 2)
    integer :: q, corner, sign
    g = 0.0_dp
    if (mesh%graded) then
      sides = graded_loads_sides(mesh, motion)
      slopes = graded_loads_slopes(mesh, motion)
      aside = 0.0_dp
      if (.not. linear) aside = mesh%inverse_h*graded_loads_aside(mesh, motion, way)
    end if
    do q = 1, twists(NDIM)
      do corner = 0, NCORNER - 1
        call twist_ends(q, corner, place, ends, sign)
        if (sign == 0) cycle
        lever = loads_twist(q, place)
        if (mesh%graded) lever = graded_loads_twist(q, corner, place, sides, slopes, aside)
        call linear_weights(ends, w)
        g(:, :, q) = g(:, :, q) + sign*spread(lever, 2, NCORNER)*w
      end do
    end do
  end subroutine twist_weights

  !> The same for one of them, added.
  pure subroutine add_mover_faces(task, plan, lane, force, w, levers, g, sums)
    type(task_t), intent(in) :: task
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: lane
    real(dp), intent(in) :: force(:, :, :), w(:, :, :)  !! of each load
    real(dp), intent(in) :: levers(:, :, :), g(:, :, :, :)
    real(dp), intent(inout) :: sums(largest_stencil, most_columns)
    integer :: i, d, b, points
    points = task%width*task%rows
    do i = 1, size(force, 3)
      do d = 1, NDIM
        call add_product(points, force(lane, d, i), w(lane, :points, i), &
                         sums(1, plan%faces + d))
        if (.not. task%centred) cycle
        do b = 1, NDIM
          call add_product(NCORNER, force(lane, d, i)*levers(lane, b, i), g(lane, :, b, i), &
                           sums(1, plan%faces + d*NDIM + b))
        end do
        if (.not. plan%corrected) cycle
        do b = 1, twists(NDIM)
          call add_product(NCORNER, force(lane, d, i), g(lane, :, NDIM + b, i), &
                           sums(1, plan%faces + NDIM*(NDIM + b) + d))
        end do
      end do
    end do
  end subroutine add_mover_faces

  !> Mass moments of the pairs and quads of the stencil's points (sgmp_scatter), of which what has
  !! come apart has none.
  pure subroutine add_mover_pairs(task, xi, w, values, sums)
    type(task_t), intent(in) :: task
    real(dp), intent(in) :: xi(NDIM), w(largest_stencil)
    real(dp), intent(in) :: values(task%values)
    real(dp), intent(inout) :: sums(largest_stencil, most_columns)
    real(dp) :: part
    integer :: d, q
    if (task%room > 0) then
      if (.not. values(task%room) > 0.0_dp) return
    end if
    do q = 1, task%pairs
      part = values(1)
      do d = 1, NDIM
        if (pair_spans(q, d)) part = part*(1.0_dp - xi(d))
      end do
      sums(:NCORNER, q) = sums(:NCORNER, q) + pair_ends(:, q)*(w(:NCORNER)*part)
    end do
  end subroutine add_mover_pairs

  !> One particle.
  pure subroutine add_mover(task, forces, lane, w, g, values, sums)
    type(task_t), intent(in) :: task
    logical, intent(in) :: forces                 !! MPM, GIMP: columns from task%forces on
    integer, intent(in) :: lane                   !! of the weights
    real(dp), intent(in) :: w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM)
    real(dp), intent(in) :: values(task%values)
    real(dp), intent(inout) :: sums(largest_stencil, most_columns)
    real(dp) :: own(largest_stencil, 0:NDIM)
    integer :: q, a, b, points
    points = task%width*task%rows
    own(:points, 0) = w(lane, :points)
    if (forces) own(:points, 1:) = g(lane, :points, :)
    do q = 1, task%plain
      a = q - task%forces                         ! axis of the force, if it is one
      if (forces .and. a >= 1 .and. a <= NDIM) then
        do b = 1, NDIM
          call add_product(points, -values(task%flux + flux_of(b, a)), own(1, b), sums(1, q))
        end do
#ifdef AXISYMMETRIC
        if (a == 1) call add_product(points, values(task%flux + NFLUX), own, sums(1, q))
#endif
      else
        call add_product(points, values(q), own, sums(1, task%pairs + q))
      end if
    end do
  end subroutine add_mover

  !> sums = sums + value weights, as vectors: linear stencils have a length that the compiler knows.
  pure subroutine add_product(points, value, weights, sums)
    integer, intent(in) :: points
    real(dp), intent(in) :: value, weights(points)
    real(dp), intent(inout) :: sums(points)
    if (points == NCORNER) then
      sums(:NCORNER) = sums(:NCORNER) + value*weights(:NCORNER)
    else
      sums = sums + value*weights
    end if
  end subroutine add_product

  !> Adds a pile to those points of its cell's stencil that lie in the planes asked for.
  pure subroutine add_pile(body, plan, task, pile, field)
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    type(pile_t), intent(inout) :: pile
    type(field_t), intent(inout) :: field
    integer :: x, r, n, q, e, plane, from(largest_stencil), to(largest_stencil)
    if (pile%row == 0) return
    do while (body%particles%plane_row(pile%plane + 1) <= pile%row)
      pile%plane = pile%plane + 1
    end do
    n = 0
    do r = 1, task%rows
      plane = pile%plane + mod(r - 1, task%layers)
      if (plane < pile%planes(1) .or. plane > pile%planes(2)) cycle
      do x = 0, task%width - 1
        n = n + 1
        from(n) = x*task%rows + r
        to(n) = body%particles%place(r, pile%row) + pile%cell + x
      end do
    end do
    do q = 1, task%nq
      do e = 1, n
        associate (moment => field%moment(to(e), plan%first_column + q - 1))
          moment = moment + pile%sums(from(e), q)
        end associate
      end do
    end do
  end subroutine add_pile

end module DIM(sgmp_sweep_movers)
