! dimension-generic, axisymmetric
#include "dimension.inc"
!> A sweep over the particles of a slab of planes: read the grid, advance, write the grid.
!!
!! Bins are visited row by row and plane by plane. Sums travel with the sweep - along the row in the
!! accumulator, from row to row and plane to plane in buffers - so that every grid value is one
!! fixed expression of its particles, whatever the number of threads, and nothing is ever added to
!! shared memory.
!!
!! Longer than 500 lines: the buffers of planes, their joints included, are nobody else's.
module DIM(sgmp_sweep)
  use DIM(sgmp_auxmesh), only: auxmesh_copy, auxmesh_fill, auxmesh_midway, auxmesh_mirror, &
                              auxmesh_relax, auxmesh_swirl
#if NDIM == 2
  use DIM(sgmp_auxmesh), only: auxmesh_fill_cells
#endif
  use sgmp_bin_change, only: bin_close
  use sgmp_body, only: body_t
  use DIM(sgmp_chunk), only: chunk_advance, most_rows, task_make, task_t
  use sgmp_columns, only: averaging_rates, collide_total
  use sgmp_constitutive, only: law_by_cells
  use sgmp_drive, only: drive_sums
  use sgmp_field, only: field_t
  use sgmp_kernels, only: stencil_width
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_movers, only: movers_reset, movers_t
  use sgmp_particles, only: chunk_prefetch, first_cell, particles_t
  use sgmp_plan, only: plan_t, workspace_t
  use DIM(sgmp_reference_chunk), only: reference_chunk
  use sgmp_rows, only: key_j, key_k
  use CARTESIAN(sgmp_scatter), only: accumulators, linear_carry
  use DIM(sgmp_settling), only: settling_part
#if NDIM > 1
  use DIM(sgmp_surfaces), only: surfaces_add_gains
#endif
  use sgmp_sums, only: sweep_sums
  use CARTESIAN(sgmp_transfer_product), only: product_carry
  implicit none
  private
  public :: sweep_slab, sweep_join

contains

  !> Sweeps planes plane1..plane2 of field `number`; `sums` are the planes' own sums.
  subroutine sweep_slab(mesh, field, number, bodies, plan, plane1, plane2, sums, movers, work)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field        !! its moments are written
    integer, intent(in) :: number
    type(body_t), intent(inout) :: bodies(:)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: plane1, plane2
    real(dp), intent(inout) :: sums(:, :, :)     !! (sweep_sums, planes of the field, bodies)
    type(movers_t), intent(inout) :: movers(:)   !! (bodies) particles that leave their bins
    type(workspace_t), intent(inout) :: work
    type(task_t) :: task
    real(dp) :: lane_sums(lanes, sweep_sums)     !! of a plane, which leaves them empty
    integer :: plane, b, slot, nq
    task = task_make(field%kernel, field%columns, mesh, plan)
    nq = task%nq
    lane_sums = 0.0_dp
    call prepare(work, task)
    if (field%columns%driven > 0 .and. plan%kick) then
      call clear_drives(field%columns%driven, plane1, plane2, work)
    end if
    if (plane2 >= plane1) call fit_buffers(work, task, field%largest_plane)
    do b = 1, size(bodies)
      if (bodies(b)%field /= number .or. .not. plan%drift) cycle
      call movers_reset(movers(b), bodies(b)%particles%motion_columns + &
                        bodies(b)%particles%state_columns, task%values)
    end do
    do plane = plane1, plane2
      slot = mod(plane, task%layers) + 1
      work%plane = plane
      work%cleared = field%plane_store(plane)
      work%filled = 0
      do b = 1, size(bodies)
        if (bodies(b)%field /= number) cycle
        if (bodies(b)%particles%plane_row(plane) == bodies(b)%particles%plane_row(plane + 1)) cycle
        call fill_records(field, mesh, plan, task, plane, work)
        if (mesh%graded .and. plan%strain) then
          if (law_by_cells(bodies(b)%law)) work%law = bodies(b)%law
        end if
        call sweep_plane(mesh, field, bodies(b), plan, task, plane, work%stencil, lane_sums, &
                         size(work%planes, 1), work%planes(1, 1, 1, slot), sums(:, plane, b), &
                         movers(b), work)
      end do
      call clear_rest(field, task, plane, size(work%planes, 1), work%cleared, work%filled, &
                      work%planes(1, 1, 1, slot))
      call join_plane(field, plan%first_column, nq, task, plane, plane1, work)
    end do
  end subroutine sweep_slab

  !> Makes a workspace fit for a sweep.
  subroutine prepare(work, task)
    type(workspace_t), intent(inout) :: work
    type(task_t), intent(in) :: task
    integer :: slot
    work%record_plane = [(0, slot=1, task%layers)]
    work%fastest = 0.0_dp
    work%fastest_id = 0
    work%bad_id = 0
  end subroutine prepare

  !> Empties the sums over driven particles.
  subroutine clear_drives(drives, plane1, plane2, work)
    integer, intent(in) :: drives, plane1, plane2
    type(workspace_t), intent(inout) :: work
    if (allocated(work%drives)) deallocate (work%drives)
    allocate (work%drives(drive_sums, drives, plane1:plane2), source=0.0_dp)
  end subroutine clear_drives

  !> Makes the buffers as large as a sweep needs them.
  subroutine fit_buffers(work, task, largest_plane)
    type(workspace_t), intent(inout) :: work
    type(task_t), intent(in) :: task
    integer, intent(in) :: largest_plane
    integer :: numbers
    numbers = task%points*task%nq*accumulators
    if (allocated(work%stencil)) then
      if (size(work%stencil) < numbers) deallocate (work%stencil)
    end if
    if (.not. allocated(work%stencil)) allocate (work%stencil(numbers), source=0.0_dp)
    numbers = task%stride*largest_plane*task%layers
    if (allocated(work%records)) then
      if (size(work%records) < numbers) deallocate (work%records)
    end if
    if (.not. allocated(work%records)) allocate (work%records(numbers), source=0.0_dp)
    if (allocated(work%planes)) then
      if (size(work%planes, 2) /= task%nq .or. &
          size(work%planes, merge(1, 3, NDIM == 1)) < largest_plane) then
        deallocate (work%planes)
        if (allocated(work%lead)) deallocate (work%lead)
      end if
    end if
    if (.not. allocated(work%planes)) then
#if NDIM == 1
      allocate (work%planes(largest_plane, task%nq, task%layers, task%layers))
#else
      allocate (work%planes(task%layers, task%nq, largest_plane, task%layers))
#endif
    end if
  end subroutine fit_buffers

  !> Sees to it that the records of all planes under the stencils of `plane` are there.
  subroutine fill_records(field, mesh, plan, task, plane, work)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: plane
    type(workspace_t), intent(inout) :: work
    integer :: p, slot, first
#if NDIM == 2
    integer :: q
#endif
    if (size(plan%vectors) == 0 .and. plan%gradient == 0) return
    do p = plane, plane + task%layers - 1
      slot = mod(p, task%layers) + 1
      if (work%record_plane(slot) == p) cycle
      work%record_plane(slot) = p
      first = (slot - 1)*field%largest_plane*task%stride + 1
#if NDIM == 2
      if (task%by_cell) then
        do q = plane, p  ! the cells below wait for their upper points
          first = mod(q, task%layers)*field%largest_plane*task%stride + 1
          call auxmesh_fill_cells(field, p, p - q, task%from(1), work%records(first))
        end do
        cycle
      end if
#endif
      call auxmesh_fill(field, mesh, p, task%from(:task%vectors/NDIM), plan%gradient, &
                        task%stride, work%records(first))
      if (task%square_read > 0) then
        call auxmesh_midway(field, mesh, p, (1.0_dp - settling_part(plan%by_halves))*plan%dt_kick, &
                            task%vectors, task%stride, &
                            work%records(first))
      end if
      if (plan%swirl) then
        call auxmesh_swirl(field, mesh, p, plan%kick, task%swirl_rate > 0, plan%gradient, &
                           task%swirl_read - 1, task%stride, work%records(first))
      end if
#if NDIM > 1
      if (field%columns%corrected .and. plan%gradient > 0 .and. (plan%strain .or. plan%probe)) then
        call surfaces_add_gains(field, p, task%vectors, task%stride, work%records(first))
      end if
#endif
      if (plan%gradient > 0) then
        call auxmesh_mirror(field, mesh, p, plan%swirl, task%vectors, &
                            task%stride, work%records(first))
      end if
      call fill_extras(field, plan, task, p, work%records(first))
    end do
  end subroutine fill_records

  !> What some scenes read besides velocities and gradients, into the records of a plane.
  subroutine fill_extras(field, plan, task, plane, records)
    type(field_t), intent(in) :: field
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: plane
    real(dp), intent(inout) :: records(*)
    if (plan%collide) call auxmesh_copy(field, plane, task%collide, collide_total(NDIM), &
                                        field%collide, task%stride, records)
    if (plan%average) call auxmesh_copy(field, plane, task%average, averaging_rates, &
                                        field%average, task%stride, records)
    if (plan%relax) call auxmesh_relax(field, plane, task%gradient - 1, task%relax, task%stride, &
                                       records)
  end subroutine fill_extras

  !> All rows of one body in one plane.
  subroutine sweep_plane(mesh, field, body, plan, task, plane, stencil, lane_sums, lead, planes, &
                         sums, movers, work)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    type(body_t), intent(inout) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: plane
    real(dp), intent(inout) :: stencil(task%points, task%nq, accumulators)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    integer, intent(in) :: lead                  !! first extent of the plane buffers
    real(dp), intent(inout) :: planes(lead, task%nq, *)
    real(dp), intent(inout) :: sums(sweep_sums)
    type(movers_t), intent(inout) :: movers
    type(workspace_t), intent(inout) :: work
    integer :: s, i, bins, row(most_rows), place(WIDE_LINE)
    do s = body%particles%plane_row(plane), body%particles%plane_row(plane + 1) - 1
      bins = body%particles%bins%last(s) - body%particles%bins%first(s) + 1
      if (.not. fills(task)) call clear_rows(field, plane, lead, task%nq, work%cleared, &
                                             key_j(body%particles%bins%key(s)) + task%lines - 1, &
                                             planes)
      call place_row(field, body, task, plane, s, row, place)
      do i = 0, bins - 1
        call sweep_bin(mesh, body, plan, task, s, i, row, stencil, lane_sums, movers, work)
        call carry(task, task%span, stencil, i*task%span, place, work%filled, lead, planes)
      end do
      do i = 0, bins_to(body, s, task%width - 1) - 1
        call carry(task, 1, stencil, bins*task%span + i, place, work%filled, lead, planes)
      end do
    end do
    ! What other bodies of the field give is added.
    if (fills(task)) call clear_rest(field, task, plane, lead, work%cleared, work%filled, planes)
    do i = 1, sweep_sums
      sums(i) = sum(lane_sums(:, i))
      lane_sums(:, i) = 0.0_dp
    end do
  end subroutine sweep_plane

  !> Bins between the end of an interval and the next in its row, at most `most`, in as many cells
  !! behind which the accumulator is empty.
  !!
  !! If the next one is nearer, the accumulator goes on into it as it would through empty bins: sums
  !! must not depend on which of those happen to be stored.
  pure function bins_to(body, s, most) result(bins)
    type(body_t), intent(in) :: body
    integer, intent(in) :: s, most
    integer :: bins
    bins = most
    associate (rows => body%particles%bins)
      if (s == rows%n) return
      if (rows%key(s + 1) == rows%key(s)) bins = min(most, rows%first(s + 1) - rows%last(s) - 1)
    end associate
  end function bins_to

  !> Where the stencils of a row's first cell lie: in the records read, and in the plane buffers.
  pure subroutine place_row(field, body, task, plane, s, row, place)
    type(field_t), intent(in) :: field
    type(body_t), intent(in) :: body
    type(task_t), intent(in) :: task
    integer, intent(in) :: plane, s
    integer, intent(out) :: row(most_rows), place(WIDE_LINE)
    integer :: line, layer, r, p, first
    row = 1
    place = 1
    first = first_cell(body%particles%span, body%particles%bins%first(s))
    do line = 1, task%lines
      do layer = 1, task%layers
        r = (line - 1)*task%layers + layer
        p = plane + layer - 1
        row(r) = first + body%particles%place(r, s) - field%plane_start(p) + 1 &
                 + mod(p, task%layers)*field%largest_plane
      end do
      place(line) = first + body%particles%place((line - 1)*task%layers + 1, s) &
                    - field%plane_start(plane) + 1
    end do
  end subroutine place_row

  !> Whether the first sums of a plane are put into its buffers and not added to zeros: where it is
  !! one row, whose points follow each other.
  pure function fills(task) result(yes)
    type(task_t), intent(in) :: task
    logical :: yes
    yes = NDIM < 3 .and. .not. task%wide
  end function fills

  !> Zeroes what is left of the plane buffers.
  pure subroutine clear_rest(field, task, plane, lead, cleared, filled, planes)
    type(field_t), intent(in) :: field
    type(task_t), intent(in) :: task
    integer, intent(in) :: plane, lead
    integer, intent(inout) :: cleared, filled
    real(dp), intent(inout) :: planes(lead, task%nq, *)
    integer :: points
    if (fills(task)) then
      points = field%plane_start(plane + 1) - field%plane_start(plane)
      call clear_points(lead, task%nq, filled + 1, points, planes)
      filled = points
    else
      call clear_rows(field, plane, lead, task%nq, cleared, huge(1), planes)
    end if
  end subroutine clear_rest

  !> Zeroes the plane buffers of all rows up to `line` that have not been yet, just before they are
  !! first added to.
  pure subroutine clear_rows(field, plane, lead, nq, cleared, line, planes)
    type(field_t), intent(in) :: field
    integer, intent(in) :: plane, lead, nq
    integer, intent(inout) :: cleared            !! next stored interval of the plane
    integer, intent(in) :: line
    real(dp), intent(inout) :: planes(lead, nq, *)
    integer :: first, last
    do while (cleared < field%plane_store(plane + 1))
      if (key_j(field%store%key(cleared)) > line) exit
      first = field%base(cleared) + field%store%first(cleared) - field%plane_start(plane) + 1
      last = first + field%store%last(cleared) - field%store%first(cleared)
      call clear_points(lead, nq, first, last, planes)
      cleared = cleared + 1
    end do
  end subroutine clear_rows

  !> Zeroes some points of the plane buffers.
  pure subroutine clear_points(lead, nq, first, last, planes)
    integer, intent(in) :: lead, nq, first, last
#if NDIM == 1
    real(dp), intent(inout) :: planes(lead, nq)
#else
    real(dp), intent(inout) :: planes(lead*nq*last)
#endif
    if (first > last) return
#if NDIM == 1
    planes(first:last, :) = 0.0_dp
#else
    planes(lead*nq*(first - 1) + 1:) = 0.0_dp
#endif
  end subroutine clear_points

  !> Moves the accumulators some cells along the row.
  subroutine carry(task, cells, stencil, shift, place, filled, lead, planes)
    type(task_t), intent(in) :: task
    integer, intent(in) :: cells, shift, place(WIDE_LINE)
    real(dp), intent(inout) :: stencil(task%points, task%nq, accumulators)
    integer, intent(inout) :: filled             !! points of the buffers, if `fills`
    integer, intent(in) :: lead
    real(dp), intent(inout) :: planes(lead, task%nq, *)
    logical :: fresh
    if (task%wide) then
      call product_carry(lead, task%nq, stencil, shift, place, planes)
      return
    end if
    fresh = fills(task) .and. place(1) + shift > filled
    if (fresh) then
      call clear_points(lead, task%nq, filled + 1, place(1) + shift - 1, planes)
      filled = place(1) + shift + cells - 1
    end if
#if NDIM < 3
    call linear_carry(lead, task%nq, cells, stencil, shift, place, fresh, planes)
#else
    call linear_carry(lead, task%nq, cells, stencil, shift, place, planes)
#endif
  end subroutine carry

  !> All chunks of one bin.
  subroutine sweep_bin(mesh, body, plan, task, s, i, row, stencil, lane_sums, movers, work)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    type(plan_t), intent(in) :: plan
    type(task_t), intent(in) :: task
    integer, intent(in) :: s, i                  !! interval of bins; bin, from its first
    integer, intent(in) :: row(most_rows)        !! records of the stencil of its first cell
    real(dp), intent(inout) :: stencil(task%points, task%nq, accumulators)
    real(dp), intent(inout) :: lane_sums(lanes, sweep_sums)
    type(movers_t), intent(inout) :: movers
    type(workspace_t), intent(inout) :: work
    real(dp) :: origin(NDIM), extent(2, NDIM)
    integer :: bin, chunk, next, left, movers_before
    logical :: in_turn                           !! fetched though it lies behind in memory
    bin = body%particles%bin_start(s) + body%particles%bins%first(s) + i
    left = body%particles%size(bin)
    if (left == 0) return
    chunk = body%particles%first(bin)
    call place_bin(mesh, task, body%particles%bins%first(s) + i, body%particles%bins%key(s), &
                   origin, extent)
    movers_before = movers%n
    in_turn = NDIM == 3 .and. (plan%stress .or. body%particles%reference > 0)
    do while (left > 0)
      if (body%particles%scattered .or. in_turn) then
        next = following(body%particles, bin, chunk)
        ! In most sweeps the processor fetches by itself what lies behind in memory.
        if (next /= chunk + 1 .or. in_turn) then
          call chunk_prefetch(body%particles, next, plan%stress)
        end if
      end if
      if (body%particles%reference > 0) then
        call reference_chunk(mesh, body, plan, task, origin, min(left, lanes), row, &
                             work%records(1 + i*task%span*task%stride), &
                             body%particles%state_columns, body%particles%id(1, chunk), &
                             body%particles%motion(1, 1, chunk), &
                             body%particles%state(1, 1, chunk), stencil, lane_sums, work)
      else
        call chunk_advance(mesh, body, plan, task, s, origin, extent, min(left, lanes), row, &
                           work%records(1 + i*task%span*task%stride), &
                           body%particles%state_columns, body%particles%id(1, chunk), &
                           body%particles%motion(1, 1, chunk), body%particles%state(1, 1, chunk), &
                           stencil, lane_sums, movers, work)
      end if
      left = left - lanes
      chunk = body%particles%next(chunk)
    end do
    if (movers%n > movers_before) call bin_close(body%particles, bin, movers)
  end subroutine sweep_bin

  !> Chunk that will be swept after one of a bin, as far as that is easy to tell; 0: none.
  pure function following(particles, bin, chunk) result(next)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin, chunk
    integer :: next
    next = particles%next(chunk)
    if (next == 0 .and. bin < size(particles%first)) next = particles%first(bin + 1)
  end function following

  !> Lower corner of a bin, and its extent from there: what lies behind the outermost cells of the
  !! grid is none of it.
  pure subroutine place_bin(mesh, task, i, key, origin, extent)
    type(mesh_t), intent(in) :: mesh
    type(task_t), intent(in) :: task
    integer, intent(in) :: i
    integer(i8), intent(in) :: key               !! of its row
    real(dp), intent(out) :: origin(NDIM), extent(2, NDIM)
#if NDIM < 3
    origin(1) = first_cell(task%span, i) + task%shift
#else
    origin(1) = i + task%shift
#endif
#if NDIM == 2
    origin(2) = key_k(key) + task%shift
#elif NDIM == 3
    origin(2) = key_j(key) + task%shift
    origin(3) = key_k(key) + task%shift
#endif
    extent(1, :) = 0.0_dp
    extent(2, :) = 1.0_dp
#if NDIM < 3
    extent(1, 1) = max(0.0_dp, mesh%lower(1) - task%shift - origin(1))
    extent(2, 1) = min(real(task%span, dp), mesh%upper(1) + task%shift - origin(1))
#endif
  end subroutine place_bin

  !> Sums the layers that belong to one plane; the contributions of the slab below wait for
  !! `sweep_join`.
  pure subroutine join_plane(field, first_column, nq, task, plane, plane1, work)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq
    type(task_t), intent(in) :: task
    integer, intent(in) :: plane, plane1
    type(workspace_t), intent(inout) :: work
    integer :: slot
    slot = mod(plane, task%layers) + 1
    if (task%layers == 2 .and. plane > plane1) then
      if (field%plane_k(plane - 1) == field%plane_k(plane) - 1) then
        call take_both(field, first_column, nq, plane, work%planes(1, 1, 1, slot), &
                       work%planes(1, 1, 1, mod(plane - 1, 2) + 1))
        return
      end if
    end if
    call take_layer(field, first_column, nq, size(work%planes, 1), plane, &
                    work%planes(1, 1, 1, slot))
    if (task%layers < 3) return
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
    integer :: nq, layers
    layers = merge(WIDE_LAYER, NLAYER, stencil_width(field%kernel) == 3)
    nq = plan%last_column - plan%first_column + 1
    if (layers == 1) return
    if (layers == 2) then
      if (present(below)) then
        call add_below(field, plan%first_column, nq, 2, plane1, &
                       below%planes(1, 1, 1, mod(plane1 - 1, 2) + 1))
      end if
      return
    end if
    if (present(below)) then
      call add_two_below(field, plan%first_column, nq, plane1, &
                         below%planes(1, 1, 1, mod(plane1 - 1, 3) + 1), &
                         below%planes(1, 1, 1, modulo(plane1 - 2, 3) + 1))
      if (plane2 > plane1) call add_two_below(field, plan%first_column, nq, plane1 + 1, own%lead, &
                                              below%planes(1, 1, 1, mod(plane1 - 1, 3) + 1))
    else if (plane2 > plane1) then
      call add_below(field, plan%first_column, nq, 3, plane1 + 1, own%lead)
    end if
  end subroutine sweep_join

  !> moment = lowest layer of the plane's own sums.
  pure subroutine take_layer(field, first_column, nq, lead, plane, planes)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq, lead, plane
    real(dp), intent(in) :: planes(lead, nq, *)
    integer :: s, i, q, here, to
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      to = field%neighbour(0, 0, s)
      here = to - field%plane_start(plane) + 1
      do q = 1, nq
        do i = field%work%first(s), field%work%last(s)
          field%moment(to + i, first_column + q - 1) = LOWEST(here + i, q)
        end do
      end do
    end do
  end subroutine take_layer

  !> moment = (second layer of the plane below) + lowest layer of the plane's own sums.
  pure subroutine take_both(field, first_column, nq, plane, own, below)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: first_column, nq, plane
    real(dp), intent(in) :: own(2, nq, *), below(2, nq, *)
    integer :: s, q, first, n, to, here, shift
    integer, parameter :: tile = 16      !! points whose columns the nearest cache holds
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        to = field%neighbour(0, 0, s) + first
        here = to - field%plane_start(plane) + 1
        shift = field%neighbour(0, -1, s) + first - field%plane_start(plane - 1) + 1
        do q = 1, nq
          call add_two(n, 2*nq, below(2, q, shift), own(1, q, here), &
                       field%moment(to, first_column + q - 1))
        end do
      end do
    end do
  end subroutine take_both

  !> Sum of two rows whose points lie `stride` apart.
  pure subroutine add_two(n, stride, a, b, total)
    integer, intent(in) :: n, stride
    real(dp), intent(in) :: a(stride, n), b(stride, n)
    real(dp), intent(out) :: total(n)
    integer :: i
    do i = 1, n
      total(i) = a(1, i) + b(1, i)
    end do
  end subroutine add_two

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

end module DIM(sgmp_sweep)
