! dimension-generic, axisymmetric
#include "dimension.inc"
!> One chunk of particles in a sweep: reads the grid, kicks, drifts, strains, and adds what the
!! particles give to the accumulator of their stencil.
!!
!! Chunks are many and small, so what is the same for all of them is worked out once, in a task.
!! Longer than 500 lines: all that happens to a chunk, inlined into one pass.
module DIM(sgmp_chunk)
  use sgmp_averaging, only: averaging_advance, averaging_begin, averaging_collect, &
                            averaging_rates, averaging_sums
  use CARTESIAN(sgmp_axis_weights), only: axis_weights, gimp_size
  use sgmp_body, only: body_t
  use sgmp_closing, only: closing_waves
  use CARTESIAN(sgmp_collisions), only: collisions_apply, collisions_collect, collisions_plan
  use sgmp_columns, only: collide_total, columns_before, columns_t, node_remapped, pair_sums, &
                          relax_stiffness, relax_total, stage_debris, twist_takes, twists
  use sgmp_constitutive, only: constitutive_t, law_by_cells
  use sgmp_debris, only: debris_loose, debris_possible, debris_room
  use DIM(sgmp_departures), only: departures_eroded, departures_note, departures_note_all, &
                                  departures_outside, departures_relabelled, departures_take_out
  use CARTESIAN(sgmp_drift_graded), only: drift_graded
  use CARTESIAN(sgmp_drift_matched), only: drift_matched
  use sgmp_drive, only: most_drives
  use CARTESIAN(sgmp_driven_particles), only: driven_masses, driven_read
  use sgmp_features, only: sum_split
  use sgmp_graded_axis, only: graded_between
  use DIM(sgmp_graded_loads), only: graded_loads_aside, graded_loads_sides, &
                                    graded_loads_slopes, graded_loads_twist
  use sgmp_kernels, only: bin_span, kernel_centred, kernel_sgmp, stencil_shift, stencil_width
  use sgmp_kinds, only: dp, i4, lanes
  use sgmp_load, only: load_absorbing, load_force, load_t
  use DIM(sgmp_loads), only: loads_book, loads_book_strain, loads_halve, loads_impedance, &
                             loads_levers, loads_on_faces, loads_on_mass, loads_some, &
                             loads_spring, loads_strain, loads_twist
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_mass, motion_total, motion_velocity
  use sgmp_movers, only: movers_t
  use sgmp_one_sided, only: one_sided_arms, one_sided_drift, one_sided_face, one_sided_flux, &
                            one_sided_levers, one_sided_push, one_sided_reached, one_sided_strain
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_particle_faults, only: fault_inside_out, fault_silent
  use sgmp_plan, only: plan_t, workspace_t
  use DIM(sgmp_relaxation), only: relaxation_apply, relaxation_collect, relaxation_square
  use CARTESIAN(sgmp_scatter), only: column_sums, linear_scatter, linear_scatter_force, &
                                     linear_scatter_pairs, linear_scatter_slopes
  use DIM(sgmp_settling), only: settling_chunk
  use DIM(sgmp_splitting), only: splitting_choose, splitting_halve
  use DIM(sgmp_stress_update), only: stress_flux, stress_probe, stress_update
  use sgmp_sums, only: sum_applied, sum_collisions, sum_internal, sum_kinetic, sum_loose, &
                       sum_mass_aa, sum_moment, sum_momentum, sum_viscous, sweep_sums
  use DIM(sgmp_surrounding), only: surrounding_book, surrounding_leave
#ifdef AXISYMMETRIC
  use sgmp_swirl, only: swirl_blend, swirl_collect, swirl_drift, swirl_flux, swirl_kick, &
                        swirl_strain
  use sgmp_swirl_driven, only: swirl_driven_read
#endif
  use CARTESIAN(sgmp_transfer), only: flux_of, linear_gather, linear_gather_gradient, &
                                      linear_weights, record_group
#if NDIM == 2
  use CARTESIAN(sgmp_transfer), only: linear_gather_cells
#endif
  use CARTESIAN(sgmp_transfer_product), only: product_gather, product_gather_gradient, &
                                              product_scatter, product_scatter_force, &
                                              product_spread, product_spread_t
  implicit none
  private
  public :: axes_moved, chunk_advance, particle_axes, task_make, task_t
  public :: largest_stencil, most_columns, most_gathered, most_rows, twist_ends

  integer, parameter :: largest_stencil = NWIDE
  integer, parameter :: most_rows = NACROSS
  integer, parameter :: most_columns = 2 + NMASS + NDIM*(5 + 2*NDIM + twists(NDIM)) + NFLUX + 5 + &
                                     averaging_sums + most_drives + pair_sums(NDIM)
  integer, parameter :: most_gathered = 3*NDIM + 2 + NGRAD + relax_total(NDIM) + record_group + &
                                      collide_total(NDIM) + averaging_rates
  integer, parameter :: before_v = motion_velocity(NDIM) - 1  !! columns of the motion before v
  integer, parameter :: mass_at = motion_mass(NDIM)
  real(dp), parameter :: beyond = 1.0e150_dp     !! no particle whose state makes sense is as fast

#ifdef AXISYMMETRIC
  real(dp), parameter :: least_radius = 1.0e-12_dp  !! (cells) of a particle on the axis
#endif

  !> What a sweep asks of every chunk of a field, and the extents of the field's stencil.
  type :: task_t
    integer :: kernel = kernel_sgmp
    logical :: wide = .false.            !! three points per axis and not two
    logical :: centred = .true.          !! the stencil's points are cell centres
    integer :: width = 2, layers = 1, lines = 1, rows = 1  !! of the stencil
    integer :: points = 2                !! numbers of a column of an accumulator
    real(dp) :: shift = 0.5_dp           !! of the stencil against the grid (cells)
    logical :: by_cell = .false.  !! a record holds one vector at all points of a cell: in the plane
                                  !! they fill it
    integer :: span = 1                  !! cells of a bin
    integer :: nq = 0                    !! columns of the moments that are scattered
    integer :: pairs = 0                 !! of these, the first: moments of pairs of centres
    integer :: plain = 0                 !! of these, those that particles bring otherwise
    ! Columns of the values that particles bring, 0 for those that this sweep does not fill; of what
    ! says `before`, the columns before it.
    integer :: masses = NMASS            !! columns of mass, those of driven particles and the room
                                         !! of pairs among them
    integer :: drives = 0                !! mass of driven particles
    integer :: driven = 0                !! how many
    integer :: room = 0                  !! volume of what has not come apart
    integer :: averages = 0              !! sums of what is averaged over a length
    integer :: swirl = 0                 !! moments of swirl
    integer :: square = 0                !! m |v|^2
    integer :: forces = 0                !! before: the forces (MPM, GIMP)
    integer :: flux = 0                  !! before: the flux; MPM, GIMP: behind all others
    integer :: outside(2) = 0            !! first and last of the forces from outside
    integer :: push = 0                  !! first of the forces of walls that let go
    integer :: volume = 0                !! volume
    integer :: stiffness = 0             !! what they relax by
    integer :: values = 0                !! how many a particle brings, the flux included
    integer :: from(2) = 0               !! columns of the nodes' vectors that are gathered
    integer :: vectors = 0               !! components of these
    integer :: stride = 1                !! components of a grid record
    integer :: velocity = 1              !! first component of the grid velocity in a record
    integer :: kicked = 1                !! and of that in which forces do work
    integer :: gradient = 1              !! and of the velocity gradient
    integer :: relax = 0                 !! and of what particles relax to; 0: nothing
    integer :: collide = 0               !! and of what debris collides by; 0: there is none
    integer :: average = 0               !! and of the average over a length (2); 0: there is none
    integer :: read = 1                  !! components of a record without those
    integer :: square_read = 0           !! and of the square of the acceleration, where it is read
    integer :: swirl_read = 0            !! and of what they read of swirl: slopes
    integer :: swirl_kick = 0            !! the acceleration
    integer :: swirl_rate = 0            !! the rate after the kick, for PIC
    real(dp) :: h = 1.0_dp, inverse_h = 1.0_dp
    real(dp) :: dt_cells = 0.0_dp        !! position step over h
    real(dp) :: live(lanes, 0:lanes) = 0.0_dp  !! 1 for particles, 0 for pads, by how many live
  end type task_t

contains

  !> Places of what chunks read of swirl.
  pure subroutine place_swirl(plan, task)
    type(plan_t), intent(in) :: plan
    type(task_t), intent(inout) :: task
    task%swirl_read = task%stride + 1
    task%swirl_kick = task%swirl_read + merge(NDIM, 0, plan%gradient > 0)
    task%stride = task%swirl_kick - merge(0, 1, plan%kick)
    if (.not. (plan%kick .and. plan%flip < 1.0_dp)) return
    task%swirl_rate = task%stride + 1
    task%stride = task%stride + 1
  end subroutine place_swirl

  !> The task of a plan.
  pure function task_make(kernel, columns, mesh, plan) result(task)
    integer, intent(in) :: kernel
    type(columns_t), intent(in) :: columns       !! of the field
    type(mesh_t), intent(in) :: mesh
    type(plan_t), intent(in) :: plan
    type(task_t) :: task
    integer :: nl
    task%kernel = kernel
    task%width = stencil_width(kernel)
    task%wide = task%width == 3
    task%centred = kernel_centred(kernel)
    task%layers = merge(WIDE_LAYER, NLAYER, task%wide)
    task%lines = merge(WIDE_LINE, NLINE, task%wide)
    task%rows = task%layers*task%lines
    task%points = merge(NWIDE_SUM, column_sums, task%wide)
    task%shift = stencil_shift(kernel)
    task%span = bin_span(kernel, NDIM)
    call place_values(columns, plan, task)
    call place_vectors(columns, plan, task)
    task%stride = max(1, task%vectors + merge(NGRAD, 0, plan%gradient > 0))
    task%gradient = 1 + task%vectors
    if (plan%swirl) call place_swirl(plan, task)
    if (plan%relax) then
      task%relax = task%stride + 1
      task%stride = task%stride + relax_total(NDIM)
    end if
    if (plan%loose .and. plan%gradient > 0) then
      task%square_read = task%stride + 1
      task%stride = task%stride + 1
    end if
    task%read = task%stride
    if (plan%collide) then
      task%collide = task%stride + 1
      task%stride = task%stride + collide_total(NDIM)
    end if
    if (plan%average) then
      task%average = task%stride + 1
      task%stride = task%stride + averaging_rates
    end if
    task%by_cell = NDIM == 2 .and. .not. task%wide .and. task%vectors == NDIM &
                   .and. task%stride == NDIM
    task%stride = record_group*((task%stride + record_group - 1)/record_group)
    if (.not. (plan%collide .or. plan%average)) task%read = task%stride
    task%inverse_h = mesh%inverse_h
    task%h = mesh%h
    task%dt_cells = plan%dt*mesh%inverse_h
    do nl = 1, lanes
      task%live(:nl, nl:) = 1.0_dp
    end do
  end function task_make

  !> Which vectors of the nodes a sweep gathers, and where a record has them. Where particles drift
  !! with the re-mapped velocity, forces on faces still do their work at that after the kick.
  pure subroutine place_vectors(columns, plan, task)
    type(columns_t), intent(in) :: columns
    type(plan_t), intent(in) :: plan
    type(task_t), intent(inout) :: task
    integer :: n
    n = size(plan%vectors)
    task%from(:n) = plan%vectors
    task%velocity = 1 + merge(NDIM, 0, plan%kick)
    task%kicked = task%velocity
    if (plan%drift .and. plan%gradient == node_remapped .and. columns%remapped) then
      task%from(1) = node_remapped
      if (columns%faces > 0) then
        n = 2
        task%from(2) = plan%vectors(1)
        task%kicked = task%velocity + NDIM
      end if
    end if
    task%vectors = NDIM*n
  end subroutine place_vectors

  !> Which columns a sweep fills, and where they are among the values that particles bring.
  pure subroutine place_values(columns, plan, task)
    type(columns_t), intent(in) :: columns
    type(plan_t), intent(in) :: plan
    type(task_t), intent(inout) :: task
    integer :: before
    before = columns_before(columns, plan%first_column)
    task%nq = plan%last_column - plan%first_column + 1
    if (plan%loose) then
      task%plain = task%nq
      task%values = task%nq
      return
    end if
    task%pairs = before - plan%first_column + 1
    task%plain = min(plan%last_column, columns%first(stage_debris) - 1) - before
    if (columns%apart > 0) task%plain = min(task%plain, columns%apart - 1 - before)
    task%masses = columns%momentum - columns%mass
    task%driven = columns%driven
    task%drives = place(columns%drives)
    task%room = place(columns%room)
    task%averages = place(columns%average)
    task%swirl = place(columns%swirl)
    task%square = place(columns%square)
    task%forces = min(plan%last_column, columns%force - 1) - before
    task%outside = [place(columns%outside(1)), place(columns%outside(2))]
    task%push = place(columns%push)
    task%volume = place(columns%volume)
    task%stiffness = place(columns%stiffness)
    task%flux = merge(task%forces, task%plain, task%centred)
    task%values = merge(max(task%plain, task%flux + NFLUX), task%plain, plan%stress)

  contains

    !> Place of a column among the values, 0 if the sweep does not fill it.
    pure function place(column) result(at)
      integer, intent(in) :: column
      integer :: at
      at = 0
      if (column > before .and. column <= plan%last_column) at = column - before
    end function place

  end subroutine place_values

#include "chunk_parts.inc"

  !> Advances a chunk: the one place where a sweep decides which of its parts run.
  ! allow(S901, S902)
  subroutine chunk_advance(mesh, body, plan, task, s, origin, extent, nl, row, records, nb, id, &
                           motion, state, stencil, lane_sums, movers, work)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: s                     !! interval of bins
    real(dp), intent(in) :: origin(NDIM)         !! lower corner of the bin
    real(dp), intent(in) :: extent(2, NDIM)      !! of the bin, from there
    integer, intent(in) :: nl                    !! particles in the chunk
    integer, intent(in) :: row(most_rows)        !! records of the rows of its first stencil
    real(dp), intent(in) :: records(task%stride, *)
    integer, intent(in) :: nb
    integer(i4), intent(inout) :: id(lanes)      !! 0 when the particle has left
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    type(movers_t), intent(inout) :: movers
    type(workspace_t), intent(inout) :: work
    real(dp) :: xi(lanes, NDIM), got(lanes, most_gathered)
    integer :: cell(lanes)                       !! of the bin, from 0; at last -1 for pads
    real(dp) :: axes(lanes, 3, NDIM, 2)          !! of a wide stencil: weights, slopes
    real(dp) :: values(lanes, most_columns + NFLUX), speed2(lanes), jacobian(lanes)
#ifdef AXISYMMETRIC
    real(dp) :: radius(lanes)
#endif
    real(dp) :: change(lanes, NDIM), heat(lanes)
    real(dp) :: jumps(lanes, 3, size(body%walls))
    logical :: outside, erodes, eroded(lanes), collides, faced, leaves(lanes)
    if (plan%loose) then
      call chunk_loose(mesh, body, plan, task, origin, nl, row, records, nb, motion, state, &
                       stencil, lane_sums)
      return
    end if
    outside = .false.
    erodes = plan%drift .and. (body%law%erosion%given .or. body%leaves) .and. .not. body%law%rigid
    call locate(motion, origin, xi)
    call enter_cells(task%span, xi, cell)
    if (task%wide) call particle_axes(body, task, nb, state, xi, axes)
    call gather(task, plan%gradient > 0, task%live(1, nl), xi, cell, axes, row, records, got)
    if (plan%strain .and. size(body%walls) > 0) then
      call gather_walls(mesh, body%walls, task, xi, cell, row, records, motion, nb, state, jumps)
    end if
#ifdef AXISYMMETRIC
    if (.not. task%centred .and. plan%gradient > 0) then
      call gather_hoop(task, xi, cell, axes, row, records, motion, &
                       got(1, task%gradient + NGRAD - 1))
    end if
#endif
    if (nl < lanes .and. .not. task%by_cell) call hold_pads(task%read, task%live(1, nl), got)
    if (plan%probe) then
      call probe(body%law, plan%stress, task, task%live(1, nl), motion(1, mass_at), got, values)
#ifdef AXISYMMETRIC
      if (plan%stress .and. .not. task%centred) call hoop_force(task, motion, values)
#endif
      call scatter(task, plan%stress, xi, cell, axes, values, stencil)
      return
    end if
    if (body%is_driven .and. (plan%kick .or. plan%drift)) then
      call drive(mesh, body, plan, task, task%live(1, nl), nb, motion, state, got, work)
    end if
    faced = body%faced
    if (faced) faced = loads_some(body, nb, state)
    if ((plan%kick .or. plan%drift) .and. faced) then
      call book_faces(mesh, body, plan, task, task%live(1, nl), got, nb, motion, state, lane_sums)
    end if
    collides = .false.
    if (task%collide > 0) then
      call gather_collide(task, xi, cell, axes, row, records, got(1, task%collide), collides)
      if (collides) call collisions_plan(got(1, task%collide), task%live(1, nl), motion, change, &
                                         heat)
    end if
    if (plan%kick) call kick(plan%dt_kick, task%live(1, nl), got, plan%flip, &
                             got(1, task%velocity), motion, lane_sums)
    if (collides) then
      call collisions_apply(body%law, change, &
                            merge(0.5_dp, 1.0_dp, plan%by_halves)*plan%dt_kick*got(:, :NDIM), &
                            task%live(1, nl), nb, &
                            heat, motion, state, lane_sums(1, sum_momentum), &
                            lane_sums(1, sum_collisions), lane_sums(1, sum_internal))
    end if
#ifdef AXISYMMETRIC
    if (plan%swirl) then
      radius = radii(mesh, motion)
      if (plan%kick) call kick_swirl(mesh, body, plan, task, task%live(1, nl), radius, nb, motion, &
                                     got, state, lane_sums, work)
    end if
#endif
    if (task%relax > 0) call relaxation_apply(body%law, plan%dt_strain, task%live(1, nl), &
                                              got(1, task%relax), nb, motion, &
                                              state, got(1, task%gradient), lane_sums)
    if (task%average > 0 .and. body%law%slots%averaged > 0) then
      call average(body%law, plan%dt, task, xi, cell, axes, row, records, nb, state)
    end if
    if (plan%drift .and. body%faced) then
      call loads_spring(mesh, body, plan%dt, &
                        plan%dt*got(:, task%velocity:task%velocity + NDIM - 1), nb, motion, state)
    end if
    if (plan%drift .and. size(body%walls) > 0) then
      call one_sided_drift(mesh, body%walls, task%live(1, nl), motion, &
                           plan%dt*got(:, task%velocity:task%velocity + NDIM - 1), state, lane_sums)
    end if
    if (plan%drift .and. body%matched .and. plan%gradient > 0) then
      call drift_matched(mesh%h, task%live(1, nl), xi, cell, task%stride, &
                         records(task%gradient, 1), row, got(1, task%velocity))
    end if
    if (plan%drift .and. mesh%graded) then
      call drift_graded(mesh, task%dt_cells, task%live(1, nl), origin, extent, &
                        got(1, task%velocity), motion, xi, lane_sums, outside)
    else if (plan%drift) then
      call drift(task%dt_cells, task%live(1, nl), origin, extent, got(1, task%velocity), motion, &
                 xi, lane_sums, outside)
    end if
#ifdef AXISYMMETRIC
    if (plan%swirl .and. plan%drift) then
      call swirl_drift(task%live(1, nl), radius, radii(mesh, motion), motion(1, mass_at), &
                       state(1, body%law%slots%swirl), lane_sums)
    end if
#endif
    if (mesh%graded .and. plan%strain .and. law_by_cells(body%law)) then
      call measure_cells(mesh, motion, got(1, task%gradient), work%law)
      call update_stress(work%law, mesh, plan, task, task%live(1, nl), motion, got, nb, &
                         state, values(1, task%flux + 1), speed2, jacobian, lane_sums)
    else
      call update_stress(body%law, mesh, plan, task, task%live(1, nl), motion, got, nb, &
                         state, values(1, task%flux + 1), speed2, jacobian, lane_sums)
    end if
    if (body%law%ambient > 0.0_dp) then
      if (plan%strain .or. plan%stress) then
        call surrounding_leave(body%law%ambient, task%live(1, nl), state(1, 1), &
                               values(1, task%flux + 1))
      end if
      if (plan%strain) call surrounding_book(body%law%ambient, task%live(1, nl), state(1, 1), &
                                             jacobian, lane_sums)
    end if
    if (plan%strain .and. body%law%slots%damage > 0) then
      lane_sums(:, sum_loose) = lane_sums(:, sum_loose) + &
                                debris_loose(body%law, task%live(1, nl), motion(1, mass_at), nb, &
                                             state)
    end if
    if (plan%strain .and. size(body%walls) > 0) then
      call one_sided_strain(mesh, body%walls, task%live(1, nl), motion, state, &
                            plan%dt_strain, got(1, task%gradient), jumps, lane_sums)
    end if
    if (faced .and. plan%strain) then
      call loads_strain(body, plan%dt_strain, got(1, task%gradient), nb, state)
      call loads_book_strain(mesh, body, plan%time, plan%dt_strain, task%live(1, nl), &
                             got(1, task%gradient), nb, motion, state, lane_sums)
    end if
    if (erodes .or. (plan%strain .and. body%law%slots%reach > 0)) then
      call departures_eroded(body%law, plan%strain, nl, motion, speed2, nb, state, eroded)
      if (body%leaves) eroded(:nl) = .true.
      if (plan%strain) call check_chunk(nl, id, merge(0.0_dp, task%live(:, nl), eroded), motion, &
                                        closing_waves(body%law, plan%dt_strain, jacobian, nb, &
                                                      state, speed2), jacobian, work)
    else if (plan%strain) then
      call check_chunk(nl, id, task%live(1, nl), motion, &
                       closing_waves(body%law, plan%dt_strain, jacobian, nb, state, speed2), &
                       jacobian, work)
    end if
#ifdef AXISYMMETRIC
    if (plan%stress .and. .not. task%centred) call hoop_force(task, motion, values)
#endif
    call collect(mesh, plan%mass, plan%momentum, task%masses, task%live(1, nl), motion, values)
    if (task%drives > 0) call driven_masses(body, task%live(1, nl), motion(1, mass_at), nb, state, &
                                            task%driven, values(1, task%drives))
    if (task%room > 0) call debris_room(body%law, task%live(1, nl), motion(1, mass_at), nb, state, &
                                        values(1, task%room))
    if (task%averages > 0) call collect_average(body%law, plan%step == 0, task%live(1, nl), &
                                                motion(1, mass_at), xi, nb, state, &
                                                values(1, task%averages))
#ifdef AXISYMMETRIC
    if (task%swirl > 0) call swirl_collect(task%live(1, nl), radii(mesh, motion), &
                                           motion(1, mass_at), state(1, body%law%slots%swirl), &
                                           values(1, task%swirl))
#endif
    if (task%square > 0) then
      call relaxation_square(body%law, task%live(1, nl), motion, values(1, task%square))
    end if
    if (task%stiffness > 0) then
      if (task%relax == 0) got(:, 1) = 0.0_dp  ! nothing is known of the neighbours
      call relaxation_collect(body%law, task%live(1, nl), motion(1, mass_at), speed2, &
                              got(1, merge(task%relax + relax_stiffness - 1, 1, task%relax > 0)), &
                              nb, state, values(1, task%stiffness))
    end if
    if (plan%stress .and. (.not. task%centred .or. task%plain > task%forces + NFLUX)) then
      call collect_rest(mesh, body, plan, task, task%live(1, nl), nb, motion, state, values)
    end if
    if (plan%drift .and. plan%features%splitting%limit > 0.0_dp &
        .and. body%law%slots%path > 0) then
      call split_particles(mesh, body, plan, task, s, extent, nl, got(1, task%gradient), nb, &
                           motion, state, id, xi, values, lane_sums, movers)
    end if
    if (erodes) call departures_note_all(eroded .and. id /= 0, .true., task%values, s, extent, nl, &
                                         nb, motion, state, id, xi, values, movers)
    leaves = .false.
    if (outside) leaves = departures_outside(extent, xi)
    if (body%relabels .and. plan%drift) then
      leaves = leaves .or. id /= 0 .and. departures_relabelled(body%labels, body%label, nl, &
                                                               state(1, body%law%slots%patch))
      outside = any(leaves)
    end if
    if (outside) call departures_note_all(leaves, .false., task%values, s, extent, nl, nb, motion, &
                                          state, id, xi, values, movers)
    if (plan%drift) call enter_cells(task%span, xi, cell)
    if (task%wide .and. (plan%drift .or. plan%mass .and. body%sides_stretch)) then
      call particle_axes(body, task, nb, state, xi, axes)
    end if
    if (NDIM < 3) cell(nl + 1:) = -1
    call scatter(task, plan%stress, xi, cell, axes, values, stencil)
    if (task%push > 0 .and. task%centred) then
      call scatter_walls(mesh, body%walls, task, id, motion, state, nb, xi, cell, stencil)
    end if
    if (faced .and. plan%faces > 0) then
      call scatter_faces(mesh, body, plan, task, id, nb, motion, state, xi, cell, axes, stencil)
    end if
  end subroutine chunk_advance

  !> What a chunk gives to the sums by which debris collides (sgmp_collisions).
  subroutine chunk_loose(mesh, body, plan, task, origin, nl, row, records, nb, motion, state, &
                         stencil, lane_sums)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    real(dp), intent(in) :: origin(NDIM)         !! lower corner of the bin
    integer, intent(in) :: nl                    !! particles in the chunk
    integer, intent(in) :: row(most_rows)        !! as in chunk_advance
    real(dp), intent(in) :: records(task%stride, *)
    integer, intent(in) :: nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: state(lanes, nb), lane_sums(lanes, sweep_sums)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp) :: xi(lanes, NDIM), got(lanes, most_gathered), axes(lanes, 3, NDIM, 2)
    real(dp) :: values(lanes, most_columns + NFLUX), loose(lanes)
    integer :: cell(lanes)
    logical :: settles
    loose = 0.0_dp
    if (.not. body%is_driven) loose = debris_loose(body%law, task%live(1, nl), &
                                                   motion(1, mass_at), nb, state)
    if (plan%gradient == 0 .and. all(loose < 0.5_dp)) return
    call locate(motion, origin, xi)
    call enter_cells(task%span, xi, cell)
    if (task%wide) call particle_axes(body, task, nb, state, xi, axes)
    if (plan%gradient == 0) then
      values(:, 1) = loose*motion(:, mass_at)
      if (NDIM < 3) cell(nl + 1:) = -1
      call scatter(task, .false., xi, cell, axes, values, stencil)
      return
    end if
    got(:, :task%square_read) = 0.0_dp
    settles = body%law%slots%viscous > 0 .and. .not. body%is_driven
    if (settles) settles = any(state(:nl, body%law%slots%damage) >= 1.0_dp)
    if (settles .or. any(loose > 0.5_dp)) then
      call gather(task, .true., task%live(1, nl), xi, cell, axes, row, records, got)
    end if
    if (settles) call settle(body, plan, task, nl, xi, cell, axes, row, records, motion, nb, got, &
                             state, lane_sums(1, sum_internal))
    call collisions_collect(loose, task%live(1, nl), sides(mesh, motion), body%law%bulk_speed, &
                            got(:, NDIM + 1:2*NDIM) - plan%dt_kick*got(:, :NDIM), &
                            got(1, task%gradient), motion, values)
    if (NDIM < 3) cell(nl + 1:) = -1
    call scatter(task, .false., xi, cell, axes, values, stencil)
  end subroutine chunk_loose

  !> Largest side of the cells that particles are in.
  pure function sides(mesh, motion) result(side)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp) :: side(lanes)
    real(dp) :: spacing(lanes, NDIM)
    integer :: d
    side = mesh%h
    if (.not. mesh%graded) return
    spacing = spacings(mesh, motion)
    side = spacing(:, 1)
    do d = 2, NDIM
      side = max(side, spacing(:, d))
    end do
    side = mesh%h*side
  end function sides

  !> Spacings of the centres between which particles are, along the axes (smallest cell).
  pure function spacings(mesh, motion) result(spacing)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp) :: spacing(lanes, NDIM)
    real(dp) :: lower(lanes), place(lanes)
    integer :: d
    do d = 1, NDIM
#if NDIM == 3
      ! A bin is a cell: all particles lie between the same centres.
      call graded_between(mesh%axes(d), 1, motion(1, d), spacing(1, d), lower, place)
      spacing(:, d) = spacing(1, d)
#else
      call graded_between(mesh%axes(d), lanes, motion(1, d), spacing(1, d), lower, place)
#endif
    end do
  end function spacings

  !> Tells a law the sides of the cells that a chunk is in (smallest cell). Of the bulk viscosity
  !! h tr(D) is the sum of h_d D_dd where sides h_d differ by axis; `side` is the h that gives it
  !! (doc/grids.md, 2), between the smallest and the largest.
  pure subroutine measure_cells(mesh, motion, gradient, law)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), gradient(lanes, NGRAD)
    type(constitutive_t), intent(inout) :: law
    real(dp) :: spacing(lanes, NDIM), trace, way, least, most
    integer :: l, d
    spacing = spacings(mesh, motion)
    !$omp simd simdlen(8) private(d, trace, way, least, most)
    do l = 1, lanes
      trace = 0.0_dp
      way = 0.0_dp
      least = spacing(l, 1)
      most = spacing(l, 1)
      do d = 1, NDIM
        trace = trace + gradient(l, 1 + (d - 1)*(NDIM + 1))
        way = way + spacing(l, d)*gradient(l, 1 + (d - 1)*(NDIM + 1))
        least = min(least, spacing(l, d))
        most = max(most, spacing(l, d))
      end do
      way = way/merge(trace, -1.0_dp, trace < 0.0_dp)
      law%side(l) = merge(min(max(way, least), most), 1.0_dp, trace < 0.0_dp)
    end do
    law%unequal = .true.
    if (.not. law%softens) return
    law%cells(:, :NDIM) = spacing
    law%cells(:, NDIM + 1:) = spread(sum(spacing, 2)/NDIM, 2, 3 - NDIM)
  end subroutine measure_cells

  !> Settles what the stress of a chunk's debris does in the kick to come (sgmp_settling).
  subroutine settle(body, plan, task, nl, xi, cell, axes, row, records, motion, nb, got, state, &
                    internal)
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: nl, cell(lanes), row(most_rows), nb
    real(dp), intent(in) :: xi(lanes, NDIM), axes(lanes, 3, NDIM, 2), records(task%stride, *)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: got(lanes, most_gathered), state(lanes, nb), internal(lanes)
    if (.not. task%centred) then
#ifdef AXISYMMETRIC
      call gather_hoop(task, xi, cell, axes, row, records, motion, &
                       got(1, task%gradient + NGRAD - 1))
#endif
      call gather_one(task, xi, cell, axes, row, records(task%square_read, 1), &
                      got(1, task%square_read))
    end if
    call settling_chunk(body%law, plan%by_halves, plan%dt_kick, task%live(1, nl), &
                        got(1, task%gradient), got, &
                        got(1, task%square_read), motion, nb, state, internal)
  end subroutine settle

  !> Averages the plastic strain of a chunk over its length (sgmp_averaging).
  subroutine average(law, dt, task, xi, cell, axes, row, records, nb, state)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: dt
    type(task_t), intent(in) :: task
    real(dp), intent(in) :: xi(lanes, NDIM), axes(lanes, 3, NDIM, 2)
    integer, intent(in) :: cell(lanes), row(most_rows), nb
    real(dp), intent(in) :: records(task%stride, *)
    real(dp), intent(inout) :: state(lanes, nb)
    real(dp) :: rate(lanes, averaging_rates)
    integer :: c
    do c = 1, averaging_rates
      call gather_one(task, xi, cell, axes, row, records(task%average + c - 1, 1), rate(1, c))
    end do
    call averaging_advance(law%averaging, dt, state(1, law%slots%plastic), rate, &
                           state(1, law%slots%averaged), state(1, law%slots%averaging))
  end subroutine average

  !> What a chunk gives to the sums of the average, nothing where it has none.
  subroutine collect_average(law, begins, live, mass, xi, nb, state, values)
    type(constitutive_t), intent(in) :: law
    logical, intent(in) :: begins                !! the run does
    real(dp), intent(in) :: live(lanes), mass(lanes), xi(lanes, NDIM)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb), values(lanes, averaging_sums)
    values = 0.0_dp
    if (law%slots%averaged == 0) return
    if (begins) call averaging_begin(state(1, law%slots%plastic), state(1, law%slots%averaged), &
                                     state(1, law%slots%averaging))
    call averaging_collect(law%averaging, NDIM, live, mass, xi, state(1, law%slots%averaging), &
                           values)
  end subroutine collect_average

  !> What the points around a chunk let it collide by, and whether they do.
  pure subroutine gather_collide(task, xi, cell, axes, row, records, got, collides)
    type(task_t), intent(in) :: task
    real(dp), intent(in) :: xi(lanes, NDIM), axes(lanes, 3, NDIM, 2)
    integer, intent(in) :: cell(lanes), row(most_rows)
    real(dp), intent(in) :: records(task%stride, *)
    real(dp), intent(out) :: got(lanes, collide_total(NDIM))
    logical, intent(out) :: collides
    real(dp) :: w(lanes, NCORNER)
    if (task%wide) then
      call product_gather(collide_total(NDIM), axes, task%stride, records(task%collide, 1), row, &
                          got)
    else
      call linear_weights(xi, w)
      call linear_gather(collide_total(NDIM), w, cell, task%stride, records(task%collide, 1), &
                         row, got)
    end if
    collides = any(got(:, 1) > 0.0_dp)
  end subroutine gather_collide

  !> Stress update where the sweep strains, and the flux that the grid wants.
  subroutine update_stress(law, mesh, plan, task, live, motion, got, nb, state, flux, speed2, &
                           jacobian, lane_sums)
    type(constitutive_t), intent(in) :: law
    type(mesh_t), intent(in) :: mesh
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    real(dp), intent(in) :: live(lanes), motion(lanes, motion_total(NDIM))
    real(dp), intent(in) :: got(lanes, most_gathered)
    integer, intent(in) :: nb
    real(dp), intent(inout) :: state(lanes, nb), flux(lanes, *), speed2(lanes), jacobian(lanes)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
#ifdef AXISYMMETRIC
    if (plan%swirl) then
      if (plan%strain) then
        call swirl_strain(law, plan%dt_strain, plan%behind, plan%time, task%inverse_h, &
                          radii(mesh, motion), motion(1, mass_at), live, got(1, task%gradient), &
                          got(1, task%swirl_read), nb, state, flux, speed2, jacobian, &
                          lane_sums(1, sum_internal), lane_sums(1, sum_viscous))
      else if (plan%stress) then
        call swirl_flux(law, task%inverse_h, radii(mesh, motion), motion(1, mass_at), live, nb, &
                        state, flux)
      end if
      return
    end if
#endif
    if (plan%strain) then
      call stress_update(law, plan%dt_strain, plan%time, motion(1, mass_at), live, &
                         got(1, task%gradient), nb, state, flux, speed2, jacobian, &
                         lane_sums(1, sum_internal), lane_sums(1, sum_viscous), plan%behind)
    else if (plan%stress) then
      speed2 = 0.0_dp
      call stress_flux(law, state(1, 1), speed2, live, state(1, law%slots%stress), flux)
    end if
  end subroutine update_stress

  !> Positions in the bin.
  pure subroutine locate(motion, origin, xi)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), origin(NDIM)
    real(dp), intent(out) :: xi(lanes, NDIM)
    integer :: l, d
    !$omp simd simdlen(8) private(d)
    do l = 1, lanes
      do d = 1, NDIM
        xi(l, d) = motion(l, d) - origin(d)
      end do
    end do
  end subroutine locate

  !> GIMP sizes of a chunk: constant, or stretched with the particle (cpGIMP).
  pure subroutine particle_size(body, nb, state, size_of)
    type(body_t), intent(in) :: body
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb)
    real(dp), intent(out) :: size_of(lanes, NDIM, 2)  !! as gimp_axes wants them
    integer :: d
    do d = 1, NDIM
      if (body%sides_stretch) then
        call gimp_size(body%half_size(d), state(1, body%law%slots%stretch + d - 1), &
                       size_of(1, d, 1), size_of(1, d, 2))
      else
        size_of(:, d, 1) = min(body%half_size(d), 0.5_dp)
        size_of(:, d, 2) = 0.5_dp/min(body%half_size(d), 0.5_dp)
      end if
    end do
  end subroutine particle_size

  !> Weights and slopes per axis of a chunk.
  pure subroutine particle_axes(body, task, nb, state, xi, axes)
    type(body_t), intent(in) :: body
    type(task_t), intent(in) :: task
    integer, intent(in) :: nb
    real(dp), intent(in) :: state(lanes, nb), xi(lanes, NDIM)
    real(dp), intent(out) :: axes(lanes, 3, NDIM, 2)
    real(dp) :: size_of(lanes, NDIM, 2)
    call particle_size(body, nb, state, size_of)
    call axis_weights(task%kernel, xi, size_of, task%inverse_h, axes(1, 1, 1, 1), &
                      axes(1, 1, 1, 2))
  end subroutine particle_axes


#ifdef AXISYMMETRIC
  !> Kick of the velocity around the axis; what is driven turns with its part.
  subroutine kick_swirl(mesh, body, plan, task, live, radius, nb, motion, got, state, lane_sums, &
                        work)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: nb
    real(dp), intent(in) :: live(lanes), radius(lanes), motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: got(lanes, most_gathered)
    real(dp), intent(inout) :: state(lanes, nb), lane_sums(lanes, sweep_sums)
    type(workspace_t), intent(inout) :: work
    real(dp) :: rate(lanes)
    rate = 0.0_dp
    if (task%swirl_rate > 0) rate = got(:, task%swirl_rate)
    if (body%is_driven) then
      call swirl_driven_read(body, mesh%h, plan%dt_kick, live, radius, motion(1, mass_at), nb, &
                             state, got(1, task%swirl_kick), rate, work%drives(:, :, work%plane))
    end if
    if (task%swirl_rate > 0) then
      call swirl_blend(plan%dt_kick, plan%flip, radius, got(1, task%swirl_kick), rate, &
                       state(1, body%law%slots%swirl))
    end if
    call swirl_kick(plan%dt_kick, live, radius, motion(1, mass_at), got(1, task%swirl_kick), &
                    state(1, body%law%slots%swirl), lane_sums)
  end subroutine kick_swirl

#endif
  !> x += v_grid dt (Eq. 31), in cells; whether a lane may have left the bin.
  pure subroutine drift(dt, live, origin, extent, velocity, motion, xi, lane_sums, outside)
    real(dp), intent(in) :: dt, live(lanes), origin(NDIM), extent(2, NDIM), velocity(lanes, NDIM)
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), lane_sums(lanes, sweep_sums)
    real(dp), intent(out) :: xi(lanes, NDIM)     !! new position in the bin
    logical, intent(out) :: outside
    real(dp) :: mass, left
#if NDIM < 3
    real(dp) :: middle(NDIM), half(NDIM)
#else
    real(dp), parameter :: middle(NDIM) = 0.5_dp, half(NDIM) = 0.5_dp  ! known: a bin is a cell
#endif
    integer :: l, d
    left = 0.0_dp
#if NDIM < 3
    middle = 0.5_dp*(extent(2, :) + extent(1, :))
    half = 0.5_dp*(extent(2, :) - extent(1, :))
#endif
    !$omp simd simdlen(8) private(mass, d) reduction(max:left)
    do l = 1, lanes
      mass = live(l)*motion(l, mass_at)
      do d = 1, NDIM
        motion(l, d) = motion(l, d) + dt*velocity(l, d)
        xi(l, d) = motion(l, d) - origin(d)
        lane_sums(l, sum_moment + d - 1) = lane_sums(l, sum_moment + d - 1) + mass*motion(l, d)
        left = max(left, merge(0.0_dp, 1.0_dp, abs(xi(l, d) - middle(d)) < half(d)))
      end do
    end do
    outside = left > 0.0_dp
  end subroutine drift

  !> How fast faces at walls move by the levers of these (OS4).
  pure subroutine gather_walls(mesh, walls, task, xi, cell, row, records, motion, nb, state, jumps)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    type(task_t), intent(in) :: task
    integer, intent(in) :: cell(lanes), row(most_rows), nb
    real(dp), intent(in) :: xi(lanes, NDIM), records(task%stride, *)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(out) :: jumps(lanes, 3, size(walls))
    real(dp) :: at(lanes, NDIM, NDIM, 0:1), end(lanes, NDIM), weights(lanes, NCORNER)
    integer :: a, side, w
    jumps = 0.0_dp
    if (.not. task%centred) return
    do w = 1, size(walls)
      associate (n => walls(w)%axis)
        if (.not. one_sided_reached(walls(w), motion(:, n))) cycle
        do side = 0, 1
          end = xi
          end(:, n) = side
          call linear_weights(end, weights)
          call linear_gather(NDIM**2, weights, cell, task%stride, records(task%gradient, 1), row, &
                             at(1, 1, 1, side))
        end do
        do a = 1, NDIM
          jumps(:, a, w) = at(:, n, a, 1) - at(:, n, a, 0)
          if (a /= n) jumps(:, a, w) = jumps(:, a, w) + at(:, a, n, 1) - at(:, a, n, 0)
          jumps(:, a, w) = one_sided_arms(mesh, walls(w), a, xi(:, n), state)*jumps(:, a, w) - &
                           mesh%h*one_sided_face(mesh, walls(w), a, state)* &
                           (0.5_dp*(at(:, n, a, 0) + at(:, n, a, 1)))
        end do
      end associate
    end do
  end subroutine gather_walls

  !> Adds the levers of the forces of walls that let go, on those particles that have stayed.
  pure subroutine scatter_walls(mesh, walls, task, id, motion, state, nb, xi, cell, stencil)
    type(mesh_t), intent(in) :: mesh
    type(one_sided_wall_t), intent(in) :: walls(:)
    type(task_t), intent(in) :: task
    integer(i4), intent(in) :: id(lanes)
    integer, intent(in) :: nb, cell(lanes)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb), xi(lanes, NDIM)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp) :: levers(lanes, 3), shifts(lanes, 3), end(lanes, NDIM)
    logical :: some
    integer :: a, column, side, w
    do w = 1, size(walls)
      associate (wall => walls(w))
        call one_sided_levers(mesh, wall, merge(1.0_dp, 0.0_dp, id /= 0), motion, state, &
                              xi(:, wall%axis), levers, shifts, some)
        if (.not. some) cycle
        do side = 0, 1
          end = xi
          end(:, wall%axis) = side
          do a = 1, NDIM
            if (wall%columns(a) == 0) cycle
            column = task%pairs + task%forces + one_sided_flux(mesh, wall, a)
            call linear_scatter(1, end, cell, (2*side - 1)*levers(:, a), task%nq, &
                                stencil(1, column, 1))
            if (.not. wall%turns .or. a == wall%axis) cycle
            column = task%pairs + task%push + wall%columns(a) - 1
            call linear_scatter(1, end, cell, (2*side - 1)*shifts(:, a), task%nq, &
                                stencil(1, column, 1))
          end do
        end do
      end associate
    end do
  end subroutine scatter_walls

  !> Adds pressure and traction on the faces of those particles that have stayed, where they act:
  !! the weights are continued linearly from the centres.
  subroutine scatter_faces(mesh, body, plan, task, id, nb, motion, state, xi, cell, axes, stencil)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer(i4), intent(in) :: id(lanes)
    integer, intent(in) :: nb, cell(lanes)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(in) :: xi(lanes, NDIM), axes(lanes, 3, NDIM, 2)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp) :: force(lanes, NDIM), way(lanes, NDIM)
    type(product_spread_t) :: spread
    logical :: some
    integer :: i
    do i = 1, size(body%loads)
      if (body%loads(i)%kind == load_force) cycle
      call loads_on_faces(mesh, body, body%loads(i), plan%time, &
                          merge(1.0_dp, 0.0_dp, id /= 0), nb, motion, state, force, way, some)
      if (.not. some) cycle
      if (task%wide) then
        call product_spread(axes_moved(axes, task%h*way), axes(1, 1, 1, 2), .false., spread)
        call product_scatter(NDIM, spread, force, stencil(1, plan%faces + 1, 1))
      else
        call linear_scatter(NDIM, xi + way, cell, force, task%nq, stencil(1, plan%faces + 1, 1))
        if (task%centred) call scatter_levers(task, plan%faces + NDIM, xi + way, &
                                              loads_levers(mesh, motion, xi + way, way, &
                                                           plan%corrected), cell, force, stencil)
        if (task%centred .and. mesh%graded .and. .not. body%linear) then
          call scatter_aside(mesh, task, plan%faces + NDIM, motion, way, xi + way, cell, force, &
                             stencil)
        end if
        if (plan%corrected .and. mesh%graded) then
          call scatter_graded_twists(mesh, body%linear, task, plan%faces + NDIM + NDIM**2, &
                                     motion, way, xi + way, cell, force, stencil)
        else if (plan%corrected) then
          call scatter_twists(task, plan%faces + NDIM + NDIM**2, xi + way, cell, force, stencil)
        end if
      end if
      if (body%loads(i)%kind == load_absorbing) call scatter_impedance(mesh, body%linear, &
                                        body%loads(i), plan, task, id, nb, motion, state, xi, &
                                        cell, axes, way, stencil)
    end do
  end subroutine scatter_faces

  !> Adds the impedance of faces at an absorbing edge where they are, but not beyond the cell of
  !! their particle: weights that are continued further are negative.
  pure subroutine scatter_impedance(mesh, linear, load, plan, task, id, nb, motion, state, xi, &
                                    cell, axes, way, stencil)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! of the body's field
    type(load_t), intent(in) :: load
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer(i4), intent(in) :: id(lanes)
    integer, intent(in) :: nb, cell(lanes)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(in) :: xi(lanes, NDIM), axes(lanes, 3, NDIM, 2)
    real(dp), intent(in) :: way(lanes, NDIM)     !! from the centres to the faces
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp) :: impedance(lanes, NDIM), place(lanes, NDIM)
    type(product_spread_t) :: spread
    integer :: before
    before = plan%faces + merge(NDIM + NDIM**2, NDIM, task%centred)  ! columns
    call loads_impedance(load, merge(1.0_dp, 0.0_dp, id /= 0), nb, state, impedance)
    if (task%wide) then
      call product_spread(axes_moved(axes, task%h*way), axes(1, 1, 1, 2), .false., spread)
      call product_scatter(NDIM, spread, impedance, stencil(1, before + 1, 1))
      return
    end if
    place = min(1.0_dp, max(0.0_dp, xi + way))
    call linear_scatter(NDIM, place, cell, impedance, task%nq, stencil(1, before + 1, 1))
    if (task%centred) call scatter_levers(task, before + NDIM, place, &
                                          loads_levers(mesh, motion, place, way, .false.), cell, &
                                          impedance, stencil)
    if (task%centred .and. mesh%graded .and. .not. linear) then
      call scatter_aside(mesh, task, before + NDIM, motion, way, place, cell, impedance, stencil)
    end if
  end subroutine scatter_impedance

  !> Adds force times lever to the centres (sgmp_loads). The derivative of a linear weight along an
  !! axis is what it is at the upper end of the cell less what it is at the lower one.
  pure subroutine scatter_levers(task, before, place, levers, cell, force, stencil)
    type(task_t), intent(in) :: task
    integer, intent(in) :: before, cell(lanes)   !! before: columns
    real(dp), intent(in) :: place(lanes, NDIM), levers(lanes, NDIM), force(lanes, NDIM)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    integer :: b, d
    do b = 1, NDIM
      call linear_scatter_slopes([(d == b, d=1, NDIM)], place, cell, &
                                 spread(levers(:, b), 2, NDIM)*force, NDIM, task%nq, &
                                 stencil(1, before + b, 1))
    end do
  end subroutine scatter_levers

  !> Adds what the centres of unequal cells get beside levers (sgmp_graded_loads).
  pure subroutine scatter_aside(mesh, task, before, motion, way, place, cell, force, stencil)
    type(mesh_t), intent(in) :: mesh
    type(task_t), intent(in) :: task
    integer, intent(in) :: before, cell(lanes)   !! before: columns
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(in) :: way(lanes, NDIM), place(lanes, NDIM), force(lanes, NDIM)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp) :: aside(lanes, NDIM, 2), end(lanes, NDIM)
    integer :: a, b, side
    aside = graded_loads_aside(mesh, motion, way)
    do b = 1, NDIM
      do side = 0, 1
        end = place
        end(:, b) = side
        aside(:, b, side + 1) = aside(:, b, side + 1)* &
                                merge(place(:, b), 1.0_dp - place(:, b), side == 1)
        do a = 1, NDIM
          call linear_scatter(1, end, cell, force(:, a)*aside(:, b, side + 1), task%nq, &
                              stencil(1, before + (a - 1)*NDIM + b, 1))
        end do
      end do
    end do
  end subroutine scatter_aside

  !> Adds force times two and three levers to the centres, for the products of the functions that
  !! stresses see along the axes (sgmp_loads): the derivatives along all axes of a twist, as above.
  pure subroutine scatter_twists(task, before, place, cell, force, stencil)
    type(task_t), intent(in) :: task
    integer, intent(in) :: before, cell(lanes)   !! before: columns
    real(dp), intent(in) :: place(lanes, NDIM), force(lanes, NDIM)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    integer :: d, q
    do q = 1, twists(NDIM)
      call linear_scatter_slopes([(twist_takes(q, d, NDIM), d=1, NDIM)], place, cell, &
                                 spread(loads_twist(q, place), 2, NDIM)*force, 1, task%nq, &
                                 stencil(1, before + (q - 1)*NDIM + 1, 1))
    end do
  end subroutine scatter_twists

  !> The same of unequal cells, whose levers differ from corner to corner.
  pure subroutine scatter_graded_twists(mesh, linear, task, before, motion, way, place, cell, &
                                        force, stencil)
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: linear                !! of the body's field
    type(task_t), intent(in) :: task
    integer, intent(in) :: before, cell(lanes)   !! before: columns
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(in) :: way(lanes, NDIM), place(lanes, NDIM), force(lanes, NDIM)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp) :: ends(lanes, NDIM), lever(lanes)
    real(dp) :: sides(lanes, NDIM), slopes(lanes, NDIM, 2), aside(lanes, NDIM, 2)
    integer :: q, corner, sign
    sides = graded_loads_sides(mesh, motion)
    slopes = graded_loads_slopes(mesh, motion)
    aside = 0.0_dp
    if (.not. linear) aside = mesh%inverse_h*graded_loads_aside(mesh, motion, way)
    do q = 1, twists(NDIM)
      do corner = 0, NCORNER - 1
        call twist_ends(q, corner, place, ends, sign)
        if (sign == 0) cycle
        lever = sign*graded_loads_twist(q, corner, place, sides, slopes, aside)
        call linear_scatter(NDIM, ends, cell, spread(lever, 2, NDIM)*force, task%nq, &
                            stencil(1, before + (q - 1)*NDIM + 1, 1))
      end do
    end do
  end subroutine scatter_graded_twists

  !> Places at the ends of the cell along the axes of a twist, and the sign of their weights in the
  !! derivative along those: 0 where a corner means an end along another axis.
  pure subroutine twist_ends(twist, corner, place, ends, sign)
    integer, intent(in) :: twist, corner         !! bits: upper ends
    real(dp), intent(in) :: place(lanes, NDIM)
    real(dp), intent(out) :: ends(lanes, NDIM)
    integer, intent(out) :: sign
    integer :: d
    ends = place
    sign = 1
    do d = 1, NDIM
      if (twist_takes(twist, d, NDIM)) then
        ends(:, d) = merge(1.0_dp, 0.0_dp, btest(corner, d - 1))
        if (.not. btest(corner, d - 1)) sign = -sign
      else if (btest(corner, d - 1)) then
        sign = 0
      end if
    end do
  end subroutine twist_ends

  !> Weights per axis some way off, continued linearly.
  pure function axes_moved(axes, way) result(moved)
    real(dp), intent(in) :: axes(lanes, 3, NDIM, 2), way(lanes, NDIM)  !! way: length
    real(dp) :: moved(lanes, 3, NDIM)
    integer :: point
    do point = 1, 3
      moved(:, point, :) = axes(:, point, :, 1) + way*axes(:, point, :, 2)
    end do
  end function axes_moved

  !> Splits particles that have been stretched too far: both halves leave as movers, and give to the
  !! grid half of what the whole gives, but for the mass's moment and the momentum, which are
  !! theirs.
  ! allow(S902)
  pure subroutine split_particles(mesh, body, plan, task, s, extent, nl, gradient, nb, motion, &
                                  state, id, xi, values, lane_sums, movers)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: s, nl, nb
    real(dp), intent(in) :: extent(2, NDIM)
    real(dp), intent(in) :: gradient(lanes, NGRAD), motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: state(lanes, nb)
    integer(i4), intent(inout) :: id(lanes)
    real(dp), intent(inout) :: xi(lanes, NDIM), values(lanes, most_columns + NFLUX)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    type(movers_t), intent(inout) :: movers
    real(dp) :: offset(lanes), live(lanes), share(lanes), half(lanes, most_columns + NFLUX)
    real(dp) :: half_motion(lanes, motion_total(NDIM)), half_state(lanes, nb)
    integer :: axis(lanes), side, l
    call splitting_choose(body%law, mesh, plan%features%splitting, body%half_size(:NDIM), extent, &
                          nl, xi, nb, motion, state, axis, offset)
    if (all(axis == 0)) return
    live = merge(1.0_dp, 0.0_dp, axis > 0)
    do side = -1, 1, 2
      half_motion = motion
      half_state = state
      call splitting_halve(body%law, mesh, side, axis, offset, gradient, nb, half_motion, &
                           half_state, share, lane_sums(1, sum_split))
      if (body%faced) call loads_halve(body, side, axis, share, nb, half_state)
      half = spread(share, 2, size(values, 2))*values
      call collect(mesh, plan%mass, plan%momentum, task%masses, live, half_motion, half)
      if (task%square > 0) then
        call relaxation_square(body%law, live, half_motion, half(1, task%square))
      end if
#ifdef AXISYMMETRIC
      if (task%swirl > 0) call swirl_collect(live, radii(mesh, half_motion), &
                                             half_motion(1, mass_at), &
                                             half_state(1, body%law%slots%swirl), &
                                             half(1, task%swirl))
#endif
      do l = 1, nl
        if (axis(l) == 0) cycle
        call departures_note(task%values, s, l, id(l), side < 0, nb, half_motion, half_state, &
                             half, movers)
      end do
    end do
    do l = 1, nl
      if (axis(l) > 0) call departures_take_out(l, extent, task%values, id, xi, values)
    end do
  end subroutine split_particles

  !> Adds a chunk to the accumulators of its stencils.
  pure subroutine scatter(task, stress, xi, cell, axes, values, stencil)
    type(task_t), intent(in) :: task
    logical, intent(in) :: stress
    real(dp), intent(in) :: xi(lanes, NDIM), axes(lanes, 3, NDIM, 2)
    integer, intent(in) :: cell(lanes)
    real(dp), intent(inout) :: values(lanes, most_columns + NFLUX)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    type(product_spread_t) :: spread
    integer :: plain, rest
    real(dp) :: firm(lanes)
    if (task%centred) then
      if (task%pairs > 0) then
        firm = values(:, 1)
        if (task%room > 0) firm = merge(firm, 0.0_dp, values(:, task%room) > 0.0_dp)
        call linear_scatter_pairs(task%pairs, xi, cell, firm, task%nq, stencil)
      end if
      call linear_scatter(task%plain, xi, cell, values, task%nq, stencil(1, task%pairs + 1, 1))
      return
    end if
    plain = task%forces
    rest = plain + merge(NDIM, 0, stress)
    if (.not. task%wide) then
      if (plain > 0) call linear_scatter(plain, xi, cell, values, task%nq, stencil)
      if (rest < task%plain) call linear_scatter(task%plain - rest, xi, cell, &
                                                 values(1, rest + 1), task%nq, &
                                                 stencil(1, rest + 1, 1))
      if (stress) call linear_scatter_force(xi, cell, task%inverse_h, flux_of, &
                                            values(1, task%flux + 1), task%nq, &
                                            stencil(1, plain + 1, 1))
#ifdef AXISYMMETRIC
      if (stress) call linear_scatter(1, xi, cell, values(1, task%flux + NFLUX), task%nq, &
                                      stencil(1, plain + 1, 1))
#endif
    else
      call product_spread(axes, axes(1, 1, 1, 2), stress, spread)
      if (plain > 0) call product_scatter(plain, spread, values, stencil)
      if (rest < task%plain) call product_scatter(task%plain - rest, spread, &
                                                  values(1, rest + 1), stencil(1, rest + 1, 1))
      if (stress) call product_scatter_force(spread, flux_of, values(1, task%flux + 1), &
                                             stencil(1, plain + 1, 1))
#ifdef AXISYMMETRIC
      if (stress) call product_scatter(1, spread, values(1, task%flux + NFLUX), &
                                       stencil(1, plain + 1, 1))
#endif
    end if
  end subroutine scatter

end module DIM(sgmp_chunk)
