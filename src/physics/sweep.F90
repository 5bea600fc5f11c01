! dimension-generic
#include "dimension.inc"
!> A sweep over the particles of a slab of planes: read the grid, advance, write the grid.
!!
!! Bins are visited row by row and plane by plane. Sums travel with the sweep - along the row in the
!! accumulator, from row to row and plane to plane in buffers - so that every grid value is one
!! fixed expression of its particles, whatever the number of threads, and nothing is ever added to
!! shared memory.
module DIM(sgmp_sweep)
  use DIM(sgmp_auxmesh), only: auxmesh_fill, auxmesh_mirror
  use sgmp_body, only: body_t
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp, i4, lanes
  use sgmp_mesh, only: mesh_t, stencil_shift, stencil_width
  use sgmp_movers, only: movers_add, movers_reset, movers_t
  use sgmp_particles, only: bin_coordinates
  use sgmp_plan, only: plan_t, sum_internal, sum_kinetic, sum_mass_aa, sum_moment, sum_momentum, &
      sweep_sums, workspace_t
  use sgmp_rows, only: key_j, key_k
  use DIM(sgmp_stress_update), only: stress_flux, stress_sums, stress_update
  use DIM(sgmp_transfer), only: flux_of, gimp_carry, gimp_gather, gimp_gradients, gimp_scatter, &
      gimp_weights, linear_carry, &
                                linear_gather, linear_gradients, linear_scatter, &
                                    linear_scatter_force, linear_weights
  use sgmp_transfer_kinds, only: kernel_gimp, kernel_mpm, kernel_sgmp
  implicit none
  private
  public :: sweep_slab, sweep_join, sweep_add_movers

  integer, parameter :: largest_stencil = NGIMP_PAD
  integer, parameter :: most_rows = NGIMP/3
  integer, parameter :: most_columns = 2 + 2*NDIM + NFLUX
  integer, parameter :: most_gathered = 2*NDIM + NGRAD

  !> Extents of the stencil of the field at hand.
  type :: shape_t
    integer :: width, layers, lines, rows, points
  end type shape_t

contains

  !> Stencil extents of a transfer.
  pure function stencil_shape(kernel) result(shape)
    integer, intent(in) :: kernel
    type(shape_t) :: shape
    shape%width = stencil_width(kernel)
    shape%layers = merge(GIMP_LAYER, NLAYER, kernel == kernel_gimp)
    shape%lines = merge(GIMP_LINE, NLINE, kernel == kernel_gimp)
    shape%rows = shape%layers*shape%lines
    shape%points = merge(NGIMP_PAD, NCORNER, kernel == kernel_gimp)
  end function stencil_shape

  !> Sweeps planes plane1..plane2 of field `number`; `sums` are the planes' own sums.
  subroutine sweep_slab(mesh, field, number, bodies, plan, plane1, plane2, sums, work)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field        !! its moments are written
    integer, intent(in) :: number
    type(body_t), intent(inout) :: bodies(:)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: plane1, plane2
    real(dp), intent(inout) :: sums(sweep_sums, plane1:plane2, size(bodies))
    type(workspace_t), intent(inout) :: work
    type(shape_t) :: shape
    integer :: plane, b, slot, nq
    shape = stencil_shape(field%kernel)
    nq = plan%last_column - plan%first_column + 1
    call prepare(work, shape, plan, nq, field%largest_plane, bodies)
    do plane = plane1, plane2
      slot = mod(plane, shape%layers) + 1
      work%cleared = field%plane_store(plane)
      do b = 1, size(bodies)
        if (bodies(b)%field /= number) cycle
        if (bodies(b)%particles%plane_row(plane) == bodies(b)%particles%plane_row(plane + 1)) cycle
        call fill_records(field, mesh, plan, shape, plane, work)
        call sweep_plane(mesh, field, bodies(b), plan, shape, plane, nq, &
                         work%planes(1, 1, 1, slot), sums(:, plane, b), work%movers(b), work)
      end do
      call clear_rows(field, plane, shape%layers*nq, huge(1), work%cleared, &
                      work%planes(1, 1, 1, slot))
      call join_plane(field, plan%first_column, nq, shape, plane, plane1, work)
    end do
  end subroutine sweep_slab

  !> Makes a workspace fit for a sweep.
  subroutine prepare(work, shape, plan, nq, largest_plane, bodies)
    type(workspace_t), intent(inout) :: work
    type(shape_t), intent(in) :: shape
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: nq, largest_plane
    type(body_t), intent(in) :: bodies(:)
    integer :: b, stride
    stride = max(1, record_size(plan))
    if (allocated(work%records)) then
      if (size(work%records, 1) /= stride .or. &
          size(work%records, 2) < largest_plane*shape%layers) then
        deallocate (work%records)
      end if
    end if
    if (.not. allocated(work%records)) allocate (work%records(stride, largest_plane*shape%layers))
    if (allocated(work%planes)) then
      if (size(work%planes, 2) /= nq .or. size(work%planes, 3) < largest_plane) then
        deallocate (work%planes)
        if (allocated(work%lead)) deallocate (work%lead)
      end if
    end if
    if (.not. allocated(work%planes)) allocate (work%planes(shape%layers, nq, largest_plane, &
                                                            shape%layers))
    if (.not. allocated(work%movers)) allocate (work%movers(size(bodies)))
    do b = 1, size(bodies)
      call movers_reset(work%movers(b), bodies(b)%particles%na + bodies(b)%particles%nb, nq + NFLUX)
    end do
    work%record_plane = [(0, b=1, shape%layers)]
    work%fastest = 0.0_dp
    work%fastest_id = 0
    work%bad_id = 0
  end subroutine prepare

  !> Components that a particle reads from each grid record.
  pure function record_size(plan) result(n)
    type(plan_t), intent(in) :: plan
    integer :: n
    n = NDIM*size(plan%vectors)
    if (plan%gradient > 0) n = n + NGRAD
  end function record_size

  !> Sees to it that the records of all planes under the stencils of `plane` are there.
  subroutine fill_records(field, mesh, plan, shape, plane, work)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    type(plan_t), intent(in) :: plan
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: plane
    type(workspace_t), intent(inout) :: work
    integer :: p, slot
    if (size(plan%vectors) == 0 .and. plan%gradient == 0) return
    do p = plane, plane + shape%layers - 1
      slot = mod(p, shape%layers) + 1
      if (work%record_plane(slot) == p) cycle
      call auxmesh_fill(field, mesh%inverse_h, p, plan%vectors, plan%gradient, &
                        size(work%records, 1), work%records(1, (slot - 1)*field%largest_plane + 1))
      if (plan%gradient > 0) then
        call auxmesh_mirror(field, mesh, p, NDIM*size(plan%vectors), size(work%records, 1), &
                            work%records(1, (slot - 1)*field%largest_plane + 1))
      end if
      work%record_plane(slot) = p
    end do
  end subroutine fill_records

  !> All rows of one body in one plane.
  subroutine sweep_plane(mesh, field, body, plan, shape, plane, nq, planes, sums, movers, work)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    type(body_t), intent(inout) :: body
    type(plan_t), intent(in) :: plan
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: plane, nq
    real(dp), intent(inout) :: planes(shape%layers, nq, *)
    real(dp), intent(inout) :: sums(sweep_sums)
    type(movers_t), intent(inout) :: movers
    type(workspace_t), intent(inout) :: work
    real(dp) :: lane_sums(lanes, sweep_sums), stencil(shape%points, nq)
    real(dp) :: cell(NDIM)
    integer :: s, i, r, line, layer, bin, base(most_rows), place(GIMP_LINE), row(most_rows)
    lane_sums = 0.0_dp
    do s = body%particles%plane_row(plane), body%particles%plane_row(plane + 1) - 1
      call clear_rows(field, plane, shape%layers*nq, key_j(body%particles%bins%key(s)) + &
                      shape%lines - 1, work%cleared, planes)
      stencil = 0.0_dp
      do line = 1, shape%lines
        do layer = 1, shape%layers
          r = (line - 1)*shape%layers + layer
          base(r) = body%particles%place(r, s) - field%plane_start(plane + layer - 1) + 1 &
                    + mod(plane + layer - 1, shape%layers)*field%largest_plane
        end do
        place(line) = body%particles%place((line - 1)*shape%layers + 1, s) - &
            field%plane_start(plane) + 1
      end do
      call bin_line(body, s, cell)
      do i = body%particles%bins%first(s), body%particles%bins%last(s)
        cell(1) = i
        bin = body%particles%bin_start(s) + i
        if (body%particles%size(bin) > 0) then
          row(:shape%rows) = base(:shape%rows) + i
          call sweep_bin(mesh, field%kernel, body, plan, shape, s, bin, cell, row, nq, stencil, &
                         lane_sums, movers, work)
        end if
        call carry(shape, nq, stencil, i, place, planes)
      end do
      do i = body%particles%bins%last(s) + 1, body%particles%bins%last(s) + shape%width - 1
        call carry(shape, nq, stencil, i, place, planes)
      end do
    end do
    do i = 1, sweep_sums
      sums(i) = sum(lane_sums(:, i))
    end do
  end subroutine sweep_plane

  !> Zeroes the plane buffers of all rows up to `line` that have not been yet, just before they are
  !! first added to.
  pure subroutine clear_rows(field, plane, n, line, cleared, planes)
    type(field_t), intent(in) :: field
    integer, intent(in) :: plane, n, line
    integer, intent(inout) :: cleared            !! next stored interval of the plane
    real(dp), intent(inout) :: planes(n, *)
    integer :: first, last
    do while (cleared < field%plane_store(plane + 1))
      if (key_j(field%store%key(cleared)) > line) exit
      first = field%base(cleared) + field%store%first(cleared) - field%plane_start(plane) + 1
      last = first + field%store%last(cleared) - field%store%first(cleared)
      planes(:, first:last) = 0.0_dp
      cleared = cleared + 1
    end do
  end subroutine clear_rows

  !> Moves the accumulator one bin along the row.
  subroutine carry(shape, nq, stencil, shift, place, planes)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: nq, shift, place(GIMP_LINE)
    real(dp), intent(inout) :: stencil(shape%points, nq), planes(shape%layers, nq, *)
    if (shape%width == 3) then
      call gimp_carry(nq, stencil, shift, place, planes)
    else
      call linear_carry(nq, stencil, shift, place, planes)
    end if
  end subroutine carry

  !> Bin coordinates along y and z of a row.
  pure subroutine bin_line(body, s, cell)
    type(body_t), intent(in) :: body
    integer, intent(in) :: s
    real(dp), intent(out) :: cell(NDIM)
    cell = 0.0_dp
#if NDIM == 2
    cell(2) = key_k(body%particles%bins%key(s))
#elif NDIM == 3
    cell(2) = key_j(body%particles%bins%key(s))
    cell(3) = key_k(body%particles%bins%key(s))
#endif
  end subroutine bin_line

  !> All chunks of one bin.
  subroutine sweep_bin(mesh, kernel, body, plan, shape, interval, bin, cell, row, nq, stencil, &
                       lane_sums, movers, work)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel
    type(body_t), intent(inout) :: body
    type(plan_t), intent(in) :: plan
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: interval, bin         !! interval of bins, bin
    real(dp), intent(in) :: cell(NDIM)           !! bin coordinates
    integer, intent(in) :: row(most_rows)        !! records of the stencil's rows
    integer, intent(in) :: nq
    real(dp), intent(inout) :: stencil(shape%points, nq)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    type(movers_t), intent(inout) :: movers
    type(workspace_t), intent(inout) :: work
    real(dp) :: live(lanes)
    integer :: chunk, left, nl, l
    chunk = body%particles%first(bin)
    left = body%particles%size(bin)
    do while (left > 0)
      nl = min(left, lanes)
      do l = 1, lanes
        live(l) = merge(1.0_dp, 0.0_dp, l <= nl)
      end do
      call sweep_chunk(mesh, kernel, body, plan, shape, [chunk, interval, bin], cell, row, nl, &
                       live, nq, &
                       body%particles%nb, body%particles%a(1, 1, chunk), &
                           body%particles%b(1, 1, chunk), stencil, &
                       lane_sums, movers, work)
      left = left - nl
      chunk = body%particles%next(chunk)
    end do
  end subroutine sweep_bin

  !> One chunk: gather, kick, drift, strain, scatter.
  ! allow(S902)
  subroutine sweep_chunk(mesh, kernel, body, plan, shape, home, cell, row, nl, live, nq, nb, a, &
                         b, stencil, &
                         lane_sums, movers, work)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel, nl, nq, nb
    integer, intent(in) :: home(3)               !! chunk, interval of bins, bin
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: cell(NDIM), live(lanes)
    integer, intent(in) :: row(most_rows)
    real(dp), intent(inout) :: a(lanes, 2*NDIM + 1), b(lanes, nb)
    real(dp), intent(inout) :: stencil(shape%points, nq)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    type(movers_t), intent(inout) :: movers
    type(workspace_t), intent(inout) :: work
    real(dp) :: xi(lanes, NDIM), half(lanes, NDIM), got(lanes, most_gathered), flux(lanes, NFLUX)
    real(dp) :: values(lanes, most_columns), speed2(lanes), jacobian(lanes)
    integer :: velocity, gradient, outside
    outside = 0
    velocity = 1 + merge(NDIM, 0, plan%kick)  ! component of `got` where the grid velocity starts
    gradient = 1 + NDIM*size(plan%vectors)               ! and the velocity gradient
    call locate(a, cell, stencil_shift(kernel), xi)
    if (kernel == kernel_gimp) call particle_size(body, nb, b, half)
    call gather(mesh%inverse_h, kernel, plan, xi, half, row, work%records, got)
    if (nl < lanes) call hold_pads(size(work%records, 1), live, got)
    if (plan%kick) then
      call kick(plan%dt_kick, live, got, plan%flip, got(1, velocity), a, lane_sums)
    end if
    if (plan%drift) then
      call drift(plan%dt*mesh%inverse_h, live, cell, stencil_shift(kernel), got(1, velocity), a, &
                 xi, lane_sums, outside)
    end if
    if (plan%strain) then
      call stress_update(body%law, plan%dt_strain, plan%time, a(1, 2*NDIM + 1), live, &
                         got(1, gradient), nb, b, flux, speed2, &
                         jacobian, lane_sums(1, sum_internal))
      call check_chunk(body, home(1), nl, live, a, speed2, jacobian, work)
    else if (plan%stress) then
      speed2 = 0.0_dp
      call stress_flux(body%law, b(1, 1), speed2, live, b(1, body%law%slots%stress), flux)
    end if
    if ((plan%drift .or. plan%mass) .and. kernel == kernel_gimp) call particle_size(body, nb, b, &
        half)
    call collect(mesh, kernel, body, plan, live, nb, a, b, flux, nq, values)
    if (outside > 0) call note_movers(nl, body%particles%id(1, home(1)), home, nq, nb, a, b, xi, &
                                      values, flux, movers)
    call scatter(mesh%inverse_h, kernel, plan, shape, nl, nq, xi, half, values, flux, stencil)
  end subroutine sweep_chunk

  !> Pads are given nothing, so they stay as they are.
  pure subroutine hold_pads(n, live, got)
    integer, intent(in) :: n
    real(dp), intent(in) :: live(lanes)
    real(dp), intent(inout) :: got(lanes, n)
    integer :: l, q
    do q = 1, n
      !$omp simd simdlen(8)
      do l = 1, lanes
        got(l, q) = live(l)*got(l, q)
      end do
    end do
  end subroutine hold_pads

  !> Local coordinates in the bin.
  pure subroutine locate(a, cell, shift, xi)
    real(dp), intent(in) :: a(lanes, 2*NDIM + 1), cell(NDIM), shift
    real(dp), intent(out) :: xi(lanes, NDIM)
    integer :: l, d
    do d = 1, NDIM
      !$omp simd simdlen(8)
      do l = 1, lanes
        xi(l, d) = (a(l, d) - cell(d)) - shift
      end do
    end do
  end subroutine locate

  !> GIMP half-sizes of a chunk: constant, or stretched with the particle (cpGIMP).
  pure subroutine particle_size(body, nb, b, half)
    type(body_t), intent(in) :: body
    integer, intent(in) :: nb
    real(dp), intent(in) :: b(lanes, nb)
    real(dp), intent(out) :: half(lanes, NDIM)
    integer :: d
    do d = 1, NDIM
      if (body%law%slots%stretch > 0) then
        half(:, d) = body%half_size(d)*b(:, body%law%slots%stretch + d - 1)
      else
        half(:, d) = body%half_size(d)
      end if
    end do
  end subroutine particle_size

  !> Vectors and velocity gradient at the particles, from the records of the grid.
  pure subroutine gather(inverse_h, kernel, plan, xi, half, row, records, got)
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: kernel
    type(plan_t), intent(in) :: plan
    real(dp), intent(in) :: xi(lanes, NDIM), half(lanes, NDIM)
    integer, intent(in) :: row(most_rows)
    real(dp), intent(in) :: records(:, :)
    real(dp), intent(out) :: got(lanes, most_gathered)
    real(dp) :: w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM), column(lanes, NDIM)
    integer :: n, stride, d, c
    n = NDIM*size(plan%vectors)
    stride = size(records, 1)
    if (n == 0 .and. plan%gradient == 0) then
      got = 0.0_dp
      return
    end if
    select case (kernel)
    case (kernel_sgmp)
      call linear_weights(xi, w)
      call linear_gather(stride, w, stride, records, row, got)
    case (kernel_mpm)
      call linear_weights(xi, w)
      if (n > 0) call linear_gather(n, w, stride, records, row, got)
      if (plan%gradient > 0) call linear_gradients(xi, inverse_h, g)
    case default  ! kernel_gimp
      call gimp_weights(xi, half, w)
      if (n > 0) call gimp_gather(n, w, stride, records, row, got)
      if (plan%gradient > 0) call gimp_gradients(xi, half, inverse_h, g)
    end select
    if (plan%gradient == 0 .or. kernel == kernel_sgmp) return
    do d = 1, NDIM
      if (kernel == kernel_mpm) then
        call linear_gather_part(NDIM, n, g, d, stride, records, row, column)
      else
        call gimp_gather_part(NDIM, n, g(1, 1, d), stride, records, row, column)
      end if
      do c = 1, NDIM
        got(:, n + (c - 1)*NDIM + d) = column(:, c)
      end do
    end do
  end subroutine gather

  !> Gather of the record's components behind the first `skip`, with the linear gradients along axis
  !! d.
  pure subroutine linear_gather_part(n, skip, g, d, stride, records, row, values)
    integer, intent(in) :: n, skip, d, stride, row(most_rows)
    real(dp), intent(in) :: g(lanes, NCORNER, NDIM), records(stride, *)
    real(dp), intent(out) :: values(lanes, NDIM)
    call linear_gather(n, g(1, 1, d), stride, records(skip + 1, 1), row, values)
  end subroutine linear_gather_part

  !> The same for GIMP.
  pure subroutine gimp_gather_part(n, skip, g, stride, records, row, values)
    integer, intent(in) :: n, skip, stride, row(most_rows)
    real(dp), intent(in) :: g(lanes, NGIMP_PAD), records(stride, *)
    real(dp), intent(out) :: values(lanes, NDIM)
    call gimp_gather(n, g, stride, records(skip + 1, 1), row, values)
  end subroutine gimp_gather_part

  !> v += a dt (Eq. 29), blended with PIC where asked for; sums for the energy ledger.
  pure subroutine kick(dt, live, acceleration, flip, grid_velocity, a, lane_sums)
    real(dp), intent(in) :: dt, live(lanes), acceleration(lanes, NDIM)
    real(dp), intent(in) :: flip  !! weight of FLIP; below 1 the grid velocity is read
    real(dp), intent(in) :: grid_velocity(lanes, NDIM)
    real(dp), intent(inout) :: a(lanes, 2*NDIM + 1), lane_sums(lanes, sweep_sums)
    real(dp) :: mass, aa, vv
    integer :: l, d
    if (flip < 1.0_dp) then
      do d = 1, NDIM
        a(:, NDIM + d) = flip*a(:, NDIM + d) + &
                         (1.0_dp - flip)*(grid_velocity(:, d) - dt*acceleration(:, d))
      end do
    end if
    !$omp simd simdlen(8) private(mass, aa, vv, d)
    do l = 1, lanes
      mass = live(l)*a(l, 2*NDIM + 1)
      aa = 0.0_dp
      vv = 0.0_dp
      do d = 1, NDIM
        a(l, NDIM + d) = a(l, NDIM + d) + dt*acceleration(l, d)
        aa = aa + acceleration(l, d)*acceleration(l, d)
        vv = vv + a(l, NDIM + d)*a(l, NDIM + d)
        lane_sums(l, sum_momentum + d - 1) = lane_sums(l, sum_momentum + d - 1) + &
            mass*a(l, NDIM + d)
      end do
      lane_sums(l, sum_mass_aa) = lane_sums(l, sum_mass_aa) + mass*aa
      lane_sums(l, sum_kinetic) = lane_sums(l, sum_kinetic) + 0.5_dp*mass*vv
    end do
  end subroutine kick

  !> x += v_grid dt (Eq. 31), in cells; counts the lanes that leave the bin.
  pure subroutine drift(dt, live, cell, shift, velocity, a, xi, lane_sums, outside)
    real(dp), intent(in) :: dt, live(lanes), cell(NDIM), shift, velocity(lanes, NDIM)
    real(dp), intent(inout) :: a(lanes, 2*NDIM + 1), lane_sums(lanes, sweep_sums)
    real(dp), intent(out) :: xi(lanes, NDIM)     !! new position in the bin
    integer, intent(out) :: outside
    real(dp) :: mass, far
    integer :: l, d
    far = 0.0_dp
    !$omp simd simdlen(8) private(mass, d) reduction(+:far)
    do l = 1, lanes
      mass = live(l)*a(l, 2*NDIM + 1)
      do d = 1, NDIM
        a(l, d) = a(l, d) + dt*velocity(l, d)
        xi(l, d) = (a(l, d) - cell(d)) - shift
        lane_sums(l, sum_moment + d - 1) = lane_sums(l, sum_moment + d - 1) + mass*a(l, d)
        far = far + merge(0.0_dp, 1.0_dp, xi(l, d) >= 0.0_dp) + &
              merge(0.0_dp, 1.0_dp, xi(l, d) < 1.0_dp)
      end do
    end do
    outside = merge(1, 0, far > 0.0_dp)
  end subroutine drift

  !> Largest c + |v| for the time step (Eq. 69), and whether every particle is still in its senses.
  pure subroutine check_chunk(body, chunk, nl, live, a, speed2, jacobian, work)
    type(body_t), intent(in) :: body
    integer, intent(in) :: chunk, nl
    real(dp), intent(in) :: live(lanes), a(lanes, 2*NDIM + 1), speed2(lanes), jacobian(lanes)
    type(workspace_t), intent(inout) :: work
    real(dp) :: speed(lanes), square, good, fast
    integer :: l, d
    good = 0.0_dp
    fast = 0.0_dp
    !$omp simd simdlen(8) private(square, d) reduction(+:good) reduction(max:fast)
    do l = 1, lanes
      square = 0.0_dp
      do d = 1, NDIM
        square = square + a(l, NDIM + d)*a(l, NDIM + d)
      end do
      speed(l) = live(l)*(sqrt(speed2(l)) + sqrt(square))
      fast = max(fast, speed(l))
      good = good + merge(1.0_dp, 0.0_dp, jacobian(l) > 0.0_dp)* &
             merge(1.0_dp, 0.0_dp, speed(l) < 1.0e150_dp)
    end do
    if (fast > work%fastest) then
      l = maxloc(speed, 1)
      work%fastest = speed(l)
      work%fastest_id = body%particles%id(l, chunk)
    end if
    if (good > lanes - 0.5_dp .or. work%bad_id /= 0) return
    do l = 1, nl
      if (jacobian(l) > 0.0_dp .and. speed(l) < 1.0e150_dp) cycle
      work%bad_id = body%particles%id(l, chunk)
      work%bad_jacobian = jacobian(l)
      return
    end do
  end subroutine check_chunk

  !> Values that go to the grid, in the order of the moments' columns; the force columns of MPM and
  !! GIMP stay open.
  subroutine collect(mesh, kernel, body, plan, live, nb, a, b, flux, nq, values)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel, nb, nq
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    real(dp), intent(in) :: live(lanes), a(lanes, 2*NDIM + 1), b(lanes, nb), flux(lanes, NFLUX)
    real(dp), intent(out) :: values(lanes, nq)
    real(dp) :: mass(lanes)
    integer :: n, d, l
    n = 0
    mass = live*a(:, 2*NDIM + 1)
    if (plan%mass) then
      n = 1
      values(:, 1) = mass
    end if
    if (plan%momentum) then
      do d = 1, NDIM
        !$omp simd simdlen(8)
        do l = 1, lanes
          values(l, n + d) = mass(l)*a(l, NDIM + d)
        end do
      end do
      n = n + NDIM
    end if
    if (.not. plan%stress) return
    if (kernel == kernel_sgmp) then
      do d = 1, NFLUX
        !$omp simd simdlen(8)
        do l = 1, lanes
          values(l, n + d) = live(l)*flux(l, d)
        end do
      end do
      n = n + NFLUX
    else
      values(:, n + 1:n + NDIM) = 0.0_dp
      n = n + NDIM
    end if
    if (plan%volume) values(:, nq) = live*b(:, 1)
    if (n == merge(nq - 1, nq, plan%volume)) return
    values(:, n + 1:n + NDIM) = 0.0_dp
    if (body%forced) call external_force(mesh, body, plan, mass, nb, a, b, values(1, n + 1))
  end subroutine collect

  !> Mass times the body force at the particles (Eq. 24).
  subroutine external_force(mesh, body, plan, mass, nb, a, b, force)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: nb
    real(dp), intent(in) :: mass(lanes), a(lanes, 2*NDIM + 1), b(lanes, nb)
    real(dp), intent(out) :: force(lanes, NDIM)
    real(dp) :: x(3), x0(3)
    integer :: l, d, s
    s = body%law%slots%initial
    x = 0.0_dp
    x0 = 0.0_dp
    force = 0.0_dp
    do l = 1, lanes
      if (mass(l) <= 0.0_dp) cycle
      do d = 1, NDIM
        x(d) = mesh%origin(d) + mesh%h*a(l, d)
        if (s > 0) x0(d) = b(l, s + d - 1)
      end do
      do d = 1, NDIM
        force(l, d) = mass(l)*body%force(d)%evaluate(x, x0, plan%time)
      end do
    end do
  end subroutine external_force

  !> Takes particles that left the bin out of the scatter and notes them.
  pure subroutine note_movers(nl, id, home, nq, nb, a, b, xi, values, flux, movers)
    integer, intent(in) :: nl, home(3), nq, nb
    integer(i4), intent(in) :: id(lanes)
    real(dp), intent(in) :: a(lanes, 2*NDIM + 1), b(lanes, nb)
    real(dp), intent(inout) :: xi(lanes, NDIM), values(lanes, nq), flux(lanes, NFLUX)
    type(movers_t), intent(inout) :: movers
    integer :: l, q, m
    do l = 1, nl
      if (all(xi(l, :) >= 0.0_dp .and. xi(l, :) < 1.0_dp)) cycle
      call movers_add(movers, id(l), home(1), l, home(2), home(3))
      m = movers%n
      do q = 1, 2*NDIM + 1
        movers%state(q, m) = a(l, q)
      end do
      do q = 1, nb
        movers%state(2*NDIM + 1 + q, m) = b(l, q)
      end do
      do q = 1, nq
        movers%values(q, m) = values(l, q)
        values(l, q) = 0.0_dp
      end do
      do q = 1, NFLUX
        movers%values(nq + q, m) = flux(l, q)
        flux(l, q) = 0.0_dp
      end do
      xi(l, :) = 0.5_dp
    end do
  end subroutine note_movers

  !> Adds a chunk to the accumulator of its stencil.
  pure subroutine scatter(inverse_h, kernel, plan, shape, nl, nq, xi, half, values, flux, stencil)
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: kernel, nl, nq
    type(plan_t), intent(in) :: plan
    type(shape_t), intent(in) :: shape
    real(dp), intent(in) :: xi(lanes, NDIM), half(lanes, NDIM), values(lanes, nq), &
        flux(lanes, NFLUX)
    real(dp), intent(inout) :: stencil(shape%points, nq)
    real(dp) :: w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM)
    integer :: plain, rest
    if (kernel == kernel_sgmp) then
      call linear_scatter(nq, xi, values, stencil)
      return
    end if
    plain = merge(1, 0, plan%mass) + merge(NDIM, 0, plan%momentum)
    rest = plain + merge(NDIM, 0, plan%stress)
    if (kernel == kernel_mpm) then
      if (plain > 0) call linear_scatter(plain, xi, values, stencil)
      if (rest < nq) call linear_scatter(nq - rest, xi, values(1, rest + 1), stencil(1, rest + 1))
      if (.not. plan%stress) return
      call linear_gradients(xi, inverse_h, g)
      call linear_scatter_force(nl, g, flux, stencil(1, plain + 1))
    else
      call gimp_weights(xi, half, w)
      if (plain > 0) call gimp_scatter(nl, plain, w, values, stencil)
      if (rest < nq) call gimp_scatter(nl, nq - rest, w, values(1, rest + 1), stencil(1, rest + 1))
      if (.not. plan%stress) return
      call gimp_gradients(xi, half, inverse_h, g)
      call gimp_scatter_force(nl, g, flux, stencil(1, plain + 1))
    end if
  end subroutine scatter

  !> Adds -grad S . (sigma V) to the nodal forces of GIMP.
  pure subroutine gimp_scatter_force(nl, g, flux, sums)
    integer, intent(in) :: nl
    real(dp), intent(in) :: g(lanes, NGIMP_PAD, NDIM), flux(lanes, NFLUX)
    real(dp), intent(inout) :: sums(NGIMP_PAD, NDIM)
    real(dp) :: gl(NGIMP_PAD, NDIM)
    integer :: l, e
    do l = 1, nl
      gl = g(l, :, :)
      !$omp simd
      do e = 1, NGIMP_PAD
#if NDIM == 1
        sums(e, 1) = sums(e, 1) - gl(e, 1)*flux(l, 1)
#elif NDIM == 2
        sums(e, 1) = sums(e, 1) - (gl(e, 1)*flux(l, 1) + gl(e, 2)*flux(l, 3))
        sums(e, 2) = sums(e, 2) - (gl(e, 1)*flux(l, 3) + gl(e, 2)*flux(l, 2))
#else
        sums(e, 1) = sums(e, 1) - ((gl(e, 1)*flux(l, 1) + gl(e, 2)*flux(l, 4)) + &
                                   gl(e, 3)*flux(l, 6))
        sums(e, 2) = sums(e, 2) - ((gl(e, 1)*flux(l, 4) + gl(e, 2)*flux(l, 2)) + &
                                   gl(e, 3)*flux(l, 5))
        sums(e, 3) = sums(e, 3) - ((gl(e, 1)*flux(l, 6) + gl(e, 2)*flux(l, 5)) + &
                                   gl(e, 3)*flux(l, 3))
#endif
      end do
    end do
  end subroutine gimp_scatter_force

  !> Sums the layers that belong to one plane; the contributions of the slab below wait for
  !! `sweep_join`.
  pure subroutine join_plane(field, first_column, nq, shape, plane, plane1, work)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: plane, plane1
    type(workspace_t), intent(inout) :: work
    integer :: slot
    slot = mod(plane, shape%layers) + 1
    if (shape%layers == 2 .and. plane > plane1) then
      if (field%plane_k(plane - 1) == field%plane_k(plane) - 1) then
        call take_both(field, first_column, nq, plane, work%planes(1, 1, 1, slot), &
                       work%planes(1, 1, 1, mod(plane - 1, 2) + 1))
        return
      end if
    end if
    call take_layer(field, first_column, nq, shape%layers, plane, work%planes(1, 1, 1, slot))
    if (shape%layers < 3) return
    if (plane == plane1) then
      work%lead = work%planes(:, :, :, slot)
    else if (plane > plane1 + 1) then
      call add_two_below(field, first_column, nq, plane, &
                         work%planes(1, 1, 1, mod(plane - 1, 3) + 1), &
                         work%planes(1, 1, 1, mod(plane - 2, 3) + 1))
    end if
  end subroutine join_plane

  !> Completes the first planes of a slab with what the slab below gave to them.
  pure subroutine sweep_join(field, plan, plane1, plane2, own, below)
    type(field_t), intent(inout) :: field
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: plane1, plane2
    type(workspace_t), intent(in) :: own
    type(workspace_t), intent(in), optional :: below  !! of the slab below; absent for the lowest
                                                      !! slab
    type(shape_t) :: shape
    integer :: nq
    shape = stencil_shape(field%kernel)
    nq = plan%last_column - plan%first_column + 1
    if (shape%layers == 1) return
    if (shape%layers == 2) then
      if (present(below)) then
        call add_below(field, plan%first_column, nq, 2, plane1, &
                       below%planes(1, 1, 1, mod(plane1 - 1, 2) + 1))
      end if
      return
    end if
    if (present(below)) then
      call add_two_below(field, plan%first_column, nq, plane1, &
                         below%planes(1, 1, 1, mod(plane1 - 1, 3) + 1), &
                         below%planes(1, 1, 1, mod(plane1 - 2, 3) + 1))
      if (plane2 > plane1) call add_two_below(field, plan%first_column, nq, plane1 + 1, own%lead, &
                                              below%planes(1, 1, 1, mod(plane1 - 1, 3) + 1))
    else if (plane2 > plane1) then
      call add_below(field, plan%first_column, nq, 3, plane1 + 1, own%lead)
    end if
  end subroutine sweep_join

  !> moment = lowest layer of the plane's own sums.
  pure subroutine take_layer(field, first_column, nq, layers, plane, planes)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq, layers, plane
    real(dp), intent(in) :: planes(layers, nq, *)
    integer :: s, i, q, to
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do q = 1, nq
        do i = field%work%first(s), field%work%last(s)
          to = field%neighbour(0, 0, s) + i
          field%moment(to, first_column + q - 1) = planes(1, q, to - field%plane_start(plane) + 1)
        end do
      end do
    end do
  end subroutine take_layer

  !> moment = (second layer of the plane below) + lowest layer of the plane's own sums.
  pure subroutine take_both(field, first_column, nq, plane, own, below)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq, plane
    real(dp), intent(in) :: own(2, nq, *), below(2, nq, *)
    integer :: s, i, q, to, here, shift
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      here = field%neighbour(0, 0, s) - field%plane_start(plane) + 1
      shift = field%neighbour(0, -1, s) - field%plane_start(plane - 1) + 1
      to = field%neighbour(0, 0, s)
      do q = 1, nq
        do i = field%work%first(s), field%work%last(s)
          field%moment(to + i, first_column + q - 1) = below(2, q, shift + i) + own(1, q, here + i)
        end do
      end do
    end do
  end subroutine take_both

  !> moment = (second layer of the plane below) + moment.
  pure subroutine add_below(field, first_column, nq, layers, plane, below)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq, layers, plane
    real(dp), intent(in) :: below(layers, nq, *)
    integer :: s, i, q, shift
    if (plane < 2) return
    if (field%plane_k(plane - 1) /= field%plane_k(plane) - 1) return
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      shift = field%neighbour(0, -1, s) - field%plane_start(plane - 1) + 1
      do q = 1, nq
        do i = field%work%first(s), field%work%last(s)
          field%moment(field%neighbour(0, 0, s) + i, first_column + q - 1) = &
            below(2, q, shift + i) + &
            field%moment(field%neighbour(0, 0, s) + i, first_column + q - 1)
        end do
      end do
    end do
  end subroutine add_below

  !> moment = (third layer of the plane two below + second layer of the plane below) + moment.
  pure subroutine add_two_below(field, first_column, nq, plane, below, below2)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq, plane
    real(dp), intent(in) :: below(3, nq, *), below2(3, nq, *)
    integer :: s, i, q, shift, shift2
    if (plane < 3) then
      call add_below(field, first_column, nq, 3, plane, below)
      return
    end if
    if (field%plane_k(plane - 2) /= field%plane_k(plane) - 2) then
      call add_below(field, first_column, nq, 3, plane, below)
      return
    end if
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      shift = field%neighbour(0, -1, s) - field%plane_start(plane - 1) + 1
      shift2 = field%neighbour(0, -2, s) - field%plane_start(plane - 2) + 1
      do q = 1, nq
        do i = field%work%first(s), field%work%last(s)
          field%moment(field%neighbour(0, 0, s) + i, first_column + q - 1) = &
              (below2(3, q, shift2 + i) + below(2, q, shift + i)) + &
              field%moment(field%neighbour(0, 0, s) + i, first_column + q - 1)
        end do
      end do
    end do
  end subroutine add_two_below

  !> Adds particles that changed bins to the moments, one after the other in the order of their
  !! ids. Weights are
  !! computed for as many at a time as a chunk has lanes.
  subroutine sweep_add_movers(mesh, field, body, plan, movers)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(movers_t), intent(in) :: movers         !! in their new bins
    type(shape_t) :: shape
    real(dp) :: w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM)
    integer :: r, l, n, first_force, who(lanes)
    shape = stencil_shape(field%kernel)
    first_force = 0
    if (plan%stress .and. field%kernel /= kernel_sgmp) first_force = 2 + NDIM
    r = 1
    do while (r <= movers%n)
      n = 0
      do while (r <= movers%n .and. n < lanes)
        if (.not. movers%gone(movers%order(r))) then
          n = n + 1
          who(n) = movers%order(r)
        end if
        r = r + 1
      end do
      if (n == 0) exit
      call mover_weights(mesh%inverse_h, field%kernel, body, first_force > 0, movers, who(:n), w, g)
      do l = 1, n
        call add_mover(field, body, plan, shape, movers%row(who(l)), movers%bin(who(l)), &
            movers%values(:, who(l)), l, &
                       w, first_force, g)
      end do
    end do
  end subroutine sweep_add_movers

  !> Weights of some movers in their new bins, and where forces are scattered their gradients.
  pure subroutine mover_weights(inverse_h, kernel, body, gradients, movers, who, w, g)
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: kernel
    type(body_t), intent(in) :: body
    logical, intent(in) :: gradients
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: who(:)                !! (<= lanes) movers
    real(dp), intent(out) :: w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM)
    real(dp) :: xi(lanes, NDIM), half(lanes, NDIM), b(lanes, body%particles%nb), &
        slopes(lanes, NCORNER, NDIM)
    integer :: l, d
    xi = 0.5_dp
    b = 1.0_dp
    do l = 1, size(who)
      do d = 1, NDIM
        xi(l, d) = movers%state(d, who(l))
        xi(l, d) = (xi(l, d) - real(floor(xi(l, d) - body%particles%shift), dp)) &
            - body%particles%shift
      end do
      if (kernel == kernel_gimp) b(l, :) = movers%state(2*NDIM + 2:, who(l))
    end do
    if (kernel == kernel_gimp) then
      call particle_size(body, body%particles%nb, b, half)
      call gimp_weights(xi, half, w)
      if (gradients) call gimp_gradients(xi, half, inverse_h, g)
    else
      call linear_weights(xi, w)
      if (gradients) call linear_gradients(xi, inverse_h, slopes)
      if (gradients) g(:, :NCORNER, :) = slopes
    end if
  end subroutine mover_weights

  !> One particle.
  pure subroutine add_mover(field, body, plan, shape, row, bin, values, lane, w, first_force, g)
    type(field_t), intent(inout) :: field
    type(body_t), intent(in) :: body
    type(plan_t), intent(in) :: plan
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: row, bin, lane         !! new interval and bin; lane of the weights
    integer, intent(in) :: first_force            !! first column of a force, 0: none
    real(dp), intent(in) :: values(:), w(lanes, largest_stencil), g(lanes, largest_stencil, NDIM)
    integer :: e, x, r, q, a, b, at, nq
    nq = plan%last_column - plan%first_column + 1
    e = 0
    do x = 0, shape%width - 1
      do r = 1, shape%rows
        e = e + 1
        at = body%particles%place(r, row) + (bin - body%particles%bin_start(row)) + x
        do q = 1, nq
          field%moment(at, plan%first_column + q - 1) = field%moment(at, plan%first_column + q &
                                                                     - 1) &
                                                        + w(lane, e)*values(q)
        end do
        if (first_force == 0) cycle
        do a = 1, NDIM
          do b = 1, NDIM
            field%moment(at, first_force + a - 1) = field%moment(at, first_force + a - 1) &
                                                    - g(lane, e, b)*values(nq + flux_of(b, a))
          end do
        end do
      end do
    end do
  end subroutine add_mover

end module DIM(sgmp_sweep)
