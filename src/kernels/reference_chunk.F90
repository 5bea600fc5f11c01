! dimension-generic, axisymmetric
#include "dimension.inc"
!> One chunk of particles that see the grid from their first places (sgmp_reference): they change no
!! bin, and nothing of them comes apart, relaxes or collides.
module DIM(sgmp_reference_chunk)
  use sgmp_body, only: body_t
  use DIM(sgmp_chunk), only: axes_moved, most_columns, most_gathered, most_rows, particle_axes, &
                             task_t
  use sgmp_closing, only: closing_waves
  use sgmp_constitutive, only: constitutive_t
  use CARTESIAN(sgmp_driven_particles), only: driven_masses, driven_read
#ifdef AXISYMMETRIC
  use sgmp_graded_axis, only: graded_between
#endif
  use sgmp_kinds, only: dp, i4, lanes
  use sgmp_load, only: load_force
  use DIM(sgmp_loads), only: loads_book, loads_book_strain, loads_on_faces, loads_on_mass, &
                             loads_some, loads_strain
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_mass, motion_total, motion_velocity
  use sgmp_one_sided, only: one_sided_drift, one_sided_push, one_sided_strain
  use sgmp_particle_faults, only: fault_inside_out, fault_none, fault_silent
  use sgmp_plan, only: plan_t, workspace_t
  use CARTESIAN(sgmp_reference), only: nominal_of, reference_check, reference_drift, &
                                       reference_locate, reference_nominal, reference_rates, &
                                       reference_strain, reference_way
  use CARTESIAN(sgmp_scatter), only: linear_scatter, linear_scatter_force
  use DIM(sgmp_stress_update), only: stress_probe, stress_update
  use sgmp_sums, only: sum_internal, sum_kinetic, sum_mass_aa, sum_momentum, sum_viscous, sweep_sums
  use CARTESIAN(sgmp_transfer), only: flux_of, linear_gather, linear_gather_gradient, linear_weights
#if NDIM == 2
  use CARTESIAN(sgmp_transfer), only: linear_gather_cells
#endif
  use CARTESIAN(sgmp_transfer_product), only: product_gather, product_gather_gradient, &
                                              product_scatter, product_scatter_force, &
                                              product_spread, product_spread_t
  implicit none
  private
  public :: reference_chunk

  integer, parameter :: before_v = motion_velocity(NDIM) - 1  !! columns of the motion before v
  integer, parameter :: mass_at = motion_mass(NDIM)
  real(dp), parameter :: beyond = 1.0e150_dp     !! no particle whose state makes sense is as fast
#ifdef AXISYMMETRIC
  real(dp), parameter :: least_radius = 1.0e-12_dp  !! (cells) of a particle on the axis
#endif

contains

#include "chunk_parts.inc"

  !> Advances a chunk as sgmp_chunk does, with what of it goes with first places.
  ! allow(S901, S902)
  subroutine reference_chunk(mesh, body, plan, task, origin, nl, row, records, nb, id, motion, &
                             state, stencil, lane_sums, work)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    real(dp), intent(in) :: origin(NDIM)         !! lower corner of the bin
    integer, intent(in) :: nl                    !! particles in the chunk
    integer, intent(in) :: row(most_rows)        !! records of the rows of its first stencil
    real(dp), intent(in) :: records(task%stride, *)
    integer, intent(in) :: nb
    integer(i4), intent(in) :: id(lanes)
    real(dp), intent(inout) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    type(workspace_t), intent(inout) :: work
    real(dp) :: xi(lanes, NDIM), got(lanes, most_gathered), axes(lanes, 3, NDIM, 2)
    real(dp) :: values(lanes, most_columns + NFLUX)
    integer :: cell(lanes)
    logical :: faced
    call reference_locate(nl, state(1, body%law%slots%reference), origin, xi)
    call enter_cells(task%span, xi, cell)
    if (task%wide) call particle_axes(body, task, nb, state, xi, axes)
    call gather(task, plan%gradient > 0, task%live(1, nl), xi, cell, axes, row, records, got)
#ifdef AXISYMMETRIC
    if (plan%gradient > 0) call gather_hoop(task, xi, cell, axes, row, records, motion, &
                                            got(1, task%gradient + NGRAD - 1))
#endif
    if (nl < lanes .and. .not. task%by_cell) call hold_pads(task%read, task%live(1, nl), got)
    if (body%is_driven .and. (plan%kick .or. plan%drift)) then
      call drive(mesh, body, plan, task, task%live(1, nl), nb, motion, state, got, work)
    end if
    faced = body%faced
    if (faced) faced = loads_some(body, nb, state)
    if ((plan%kick .or. plan%drift) .and. faced) then
      call book_faces(mesh, body, plan, task, task%live(1, nl), got, nb, motion, state, lane_sums)
    end if
    if (plan%kick) call kick(plan%dt_kick, task%live(1, nl), got, plan%flip, &
                             got(1, task%velocity), motion, lane_sums)
    if (plan%drift) then
      call one_sided_drift(mesh, body%walls, task%live(1, nl), motion, &
                           plan%dt*got(:, task%velocity:task%velocity + NDIM - 1), state, lane_sums)
      call reference_drift(task%dt_cells, task%live(1, nl), got(1, task%velocity), motion, &
                           lane_sums)
    end if
    if (plan%strain) then
      call strain(mesh, body, plan, task, nl, id, motion, got, nb, state, &
                  values(1, task%flux + 1), lane_sums, work)
      if (faced) then
        call loads_strain(body, plan%dt_strain, got(1, task%gradient), nb, state)
        call loads_book_strain(mesh, body, plan%time, plan%dt_strain, task%live(1, nl), &
                               got(1, task%gradient), nb, motion, state, lane_sums)
      end if
    else if (plan%probe) then
      call probe(body%law, plan%stress, task, task%live(1, nl), motion(1, mass_at), got, values)
    end if
#ifdef AXISYMMETRIC
    if (plan%stress) call hoop_force(task, motion, values)
#endif
    if (.not. plan%probe) then
      call collect(mesh, plan%mass, plan%momentum, task%masses, task%live(1, nl), motion, values)
      if (task%drives > 0) call driven_masses(body, task%live(1, nl), motion(1, mass_at), nb, &
                                              state, task%driven, values(1, task%drives))
      if (plan%stress) call collect_rest(mesh, body, plan, task, task%live(1, nl), nb, motion, &
                                         state, values)
    end if
    if (NDIM < 3) cell(nl + 1:) = -1
    call scatter(task, plan%stress, xi, cell, axes, state(1, body%law%slots%reference + NDIM), &
                 values, stencil)
    if (faced .and. plan%faces > 0) then
      call scatter_faces(mesh, body, plan, task, id, nb, motion, state, xi, cell, axes, stencil)
    end if
  end subroutine reference_chunk

  !> Strains a chunk. L is that at the start of the step, whatever the update.
  subroutine strain(mesh, body, plan, task, nl, id, motion, got, nb, state, flux, lane_sums, work)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: nl, nb
    integer(i4), intent(in) :: id(lanes)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM))
    real(dp), intent(inout) :: got(lanes, most_gathered)  !! dF/dt becomes L
    real(dp), intent(inout) :: state(lanes, nb), flux(lanes, *), lane_sums(lanes, sweep_sums)
    type(workspace_t), intent(inout) :: work
    real(dp) :: rates(lanes, NDIM, NDIM), speed2(lanes), jacobian(lanes)
    real(dp) :: jumps(lanes, 3, size(body%walls))
    integer :: f, fault, lane
    f = body%law%slots%reference + NDIM
    call reference_rates(state(1, f), got(1, task%gradient), rates)
    call stress_update(body%law, plan%dt_strain, plan%time, motion(1, mass_at), task%live(1, nl), &
                       got(1, task%gradient), nb, state, flux, speed2, jacobian, &
                       lane_sums(1, sum_internal), lane_sums(1, sum_viscous), .false.)
    call reference_strain(plan%dt_strain, rates, state(1, f))
    call reference_check(mesh, nl, motion, state(1, f), speed2, fault, lane)
    if (fault /= fault_none .and. work%bad_id == 0) then
      work%bad_id = id(lane)
      work%fault = fault
    end if
    call check_chunk(nl, id, task%live(1, nl), motion, &
                     closing_waves(body%law, plan%dt_strain, jacobian, nb, state, speed2), &
                     jacobian, work)
    jumps = 0.0_dp  ! forces of walls act where particles are
    call one_sided_strain(mesh, body%walls, task%live(1, nl), motion, state, plan%dt_strain, &
                          got(1, task%gradient), jumps, lane_sums)
  end subroutine strain

  !> Adds a chunk to the accumulators of its stencils; forces are those of nominal stresses.
  !!
  !! Written out here and in sgmp_chunk: one procedure for both, with the flux as an argument, made
  !! sweeps of gimp 5 % slower (medians of 15 pairs).
  pure subroutine scatter(task, stress, xi, cell, axes, f, values, stencil)
    type(task_t), intent(in) :: task
    logical, intent(in) :: stress
    real(dp), intent(in) :: xi(lanes, NDIM), axes(lanes, 3, NDIM, 2)
    integer, intent(in) :: cell(lanes)
    real(dp), intent(in) :: f(lanes, NDIM, NDIM)  !! deformation gradient
    real(dp), intent(in) :: values(lanes, most_columns + NFLUX)
    real(dp), intent(inout) :: stencil(task%points, task%nq, *)
    real(dp) :: nominal(lanes, NDIM, NDIM)
    type(product_spread_t) :: spread
    integer :: forces, rest
    forces = task%forces
    rest = forces + merge(NDIM, 0, stress)
    if (stress) call reference_nominal(f, flux_of, values(1, task%flux + 1), nominal)
    if (task%wide) then
      call product_spread(axes, axes(1, 1, 1, 2), stress, spread)
      if (forces > 0) call product_scatter(forces, spread, values, stencil)
      if (rest < task%plain) call product_scatter(task%plain - rest, spread, &
                                                  values(1, rest + 1), stencil(1, rest + 1, 1))
      if (.not. stress) return
      call product_scatter_force(spread, nominal_of, nominal, stencil(1, forces + 1, 1))
#ifdef AXISYMMETRIC
      call product_scatter(1, spread, values(1, task%flux + NFLUX), stencil(1, forces + 1, 1))
#endif
    else
      if (forces > 0) call linear_scatter(forces, xi, cell, values, task%nq, stencil)
      if (rest < task%plain) call linear_scatter(task%plain - rest, xi, cell, &
                                                 values(1, rest + 1), task%nq, &
                                                 stencil(1, rest + 1, 1))
      if (.not. stress) return
      call linear_scatter_force(xi, cell, task%inverse_h, nominal_of, nominal, task%nq, &
                                stencil(1, forces + 1, 1))
#ifdef AXISYMMETRIC
      call linear_scatter(1, xi, cell, values(1, task%flux + NFLUX), task%nq, &
                          stencil(1, forces + 1, 1))
#endif
    end if
  end subroutine scatter

  !> Adds pressure and traction on faces where they were on the first shape: the weights are
  !! continued linearly from the particles.
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
      way = reference_way(state(1, body%law%slots%reference + NDIM), way)
      if (task%wide) then
        call product_spread(axes_moved(axes, task%h*way), axes(1, 1, 1, 2), .false., spread)
        call product_scatter(NDIM, spread, force, stencil(1, plan%faces + 1, 1))
      else
        call linear_scatter(NDIM, xi + way, cell, force, task%nq, stencil(1, plan%faces + 1, 1))
      end if
    end do
  end subroutine scatter_faces

end module DIM(sgmp_reference_chunk)
