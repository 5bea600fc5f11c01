!> The phases of a step over all fields: which fields take part, and in which order results are put
!! together. What a phase may change is in its arguments.
module sgmp_phases
  use sgmp_averaging, only: averaging_rate, averaging_sums
  use sgmp_body, only: body_forced, body_place, body_t
  use sgmp_columns, only: node_acceleration, node_remapped, node_velocity
  use sgmp_contact, only: contact_layout, contact_t
  use sgmp_drive, only: drive_sums
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_field, only: field_build, field_t
  use sgmp_field_nodes, only: field_normalise, field_relax, field_remap, field_solve, &
                              field_velocity
  use sgmp_field_rotation, only: field_rotation_place, field_rotation_prepare, field_rotation_swap
  use sgmp_field_surfaces, only: field_surfaces_strain, field_surfaces_weigh
  use sgmp_field_sweep, only: field_sweep, sweep_columns
  use sgmp_findings, only: findings_t
  use sgmp_halo, only: halo_own_planes
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use sgmp_particles, only: particles_cells
  use sgmp_partition, only: partition_t
  use sgmp_plan, only: plan_t
  use sgmp_ranks, only: ranks_t
  use sgmp_rigid_bodies, only: rigid_field, rigid_solve, rigid_velocity
  use sgmp_rows, only: rows_t, rows_union
  use sgmp_sums, only: nodes_sums, sweep_sums
  use sgmp_tally, only: tally_add, tally_t
  use sgmp_team, only: team_divide, team_t
  use sgmp_text, only: integer_text
  use sgmp_timers, only: phase_halo, timers_move, timers_t, wall_time
  use sgmp_walls, only: has_walls, walls_fold, walls_mirror, walls_mirror_average, &
                        walls_mirror_centres
  implicit none
  private
  public :: phase_average, phase_fold, phase_layout, phase_mirror, phase_normalise, phase_place, &
            phase_relax, phase_remap, phase_rotation, phase_solve, phase_surfaces_strain, &
            phase_surfaces_weigh, phase_swap_nodes, phase_sweep, phase_velocity

  !> Points of a field whose walls are not worth a meeting of threads.
  integer, parameter :: few_points = 32768

contains

  !> Lays out fields for the cells of their bodies' bins and divides the planes among the threads.
  subroutine phase_layout(mesh, fields, bodies, contact, team, partition, changed)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(contact_t), intent(inout) :: contact
    type(team_t), intent(inout) :: team
    type(partition_t), intent(in) :: partition
    logical, intent(in), optional :: changed(:)  !! (fields) whose bins are new; absent: all
    type(rows_t) :: cells, own, more
    integer :: f, b
    do f = 1, size(fields)
      if (present(changed)) then
        if (.not. changed(f)) cycle
      end if
      cells%n = 0
      if (allocated(cells%key)) deallocate (cells%key, cells%first, cells%last)
      allocate (cells%key(0), cells%first(0), cells%last(0))
      do b = 1, size(bodies)
        if (bodies(b)%field /= f) cycle
        call particles_cells(bodies(b)%particles, own)
        call rows_union(cells, own, more)
        cells = more
      end do
      call field_build(fields(f), cells)
      do b = 1, size(bodies)
        if (bodies(b)%field == f) call body_place(bodies(b), fields(f))
      end do
      call team_divide(team, f, fields(f), bodies, partition)
    end do
    call contact_layout(contact, mesh, fields, bodies, partition%own + [0, partition%nodes])
  end subroutine phase_layout

  !> One sweep over all particles.
  subroutine phase_sweep(plan, mesh, fields, bodies, team, ranks, findings, timers)
    type(plan_t), intent(in) :: plan
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(team_t), intent(inout) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    integer :: f, b
    if (plan%strain) findings%fastest = 0.0_dp
    do f = 1, size(fields)
      b = rigid_field(bodies, f)
      if (b > 0 .and. plan%step > 0) then
        if (bodies(b)%at_rest) cycle  ! nothing of it changes after the first projection
      end if
      call field_sweep(plan, f, mesh, fields(f), bodies, team, ranks, findings, timers)
    end do
  end subroutine phase_sweep

  !> Folds what was just scattered behind walls.
  subroutine phase_fold(plan, mesh, fields, threads)
    type(plan_t), intent(in) :: plan
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    integer, intent(in) :: threads
    type(plan_t) :: own
    integer :: f, axis, t
    do f = 1, size(fields)
      own = plan
      call sweep_columns(own, fields(f))
      do axis = 1, mesh%ndim
        if (.not. has_walls(mesh, axis)) cycle
        if (axis == mesh%ndim) then
          call walls_fold(fields(f), mesh, axis, 1, fields(f)%planes, own%first_column, &
                          own%last_column)
        else
          !$omp parallel do num_threads(threads) &
          !$omp& if(threads > 1 .and. fields(f)%points > few_points) &
          !$omp& default(none) shared(mesh, fields, own, f, axis, threads) private(t)
          do t = 1, threads
            call walls_fold(fields(f), mesh, axis, 1 + share(fields(f)%planes, threads, t - 1), &
                            share(fields(f)%planes, threads, t), own%first_column, own%last_column)
          end do
          !$omp end parallel do
        end if
      end do
    end do
  end subroutine phase_fold

  !> Fills nodes behind walls with their mirror images, in all fields that the walls act on.
  subroutine phase_mirror(mesh, fields, bodies, columns, kinds, threads)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: columns(:)            !! first columns of the vectors
    integer, intent(in) :: kinds(:)              !! of each: wall_kick or wall_speed
    integer, intent(in) :: threads
    integer :: f
    do f = 1, size(fields)
      if (rigid_field(bodies, f) == 0) call mirror(mesh, fields(f), columns, kinds, threads)
    end do
  end subroutine phase_mirror

  !> Fills nodes behind walls with their mirror images.
  subroutine mirror(mesh, field, columns, kinds, threads)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    integer, intent(in) :: columns(:), kinds(:), threads
    integer :: axis, t
    do axis = 1, mesh%ndim
      if (.not. has_walls(mesh, axis)) cycle
      if (axis == mesh%ndim) then
        call walls_mirror(field, mesh, axis, 1, field%planes, columns, kinds)
      else
        !$omp parallel do num_threads(threads) if(threads > 1 .and. field%points > few_points) &
        !$omp& default(none) shared(mesh, field, axis, columns, kinds, threads) private(t)
        do t = 1, threads
          call walls_mirror(field, mesh, axis, 1 + share(field%planes, threads, t - 1), &
                            share(field%planes, threads, t), columns, kinds)
        end do
        !$omp end parallel do
      end if
    end do
  end subroutine mirror

  !> Planes that the first t threads take where all planes are alike.
  pure function share(planes, threads, t) result(last)
    integer, intent(in) :: planes, threads, t
    integer :: last
    last = planes*t/threads
  end function share

  !> Prepares exact rotation for the masses as they lie.
  subroutine phase_rotation(method, mesh, fields, bodies, team, partition)
    type(method_t), intent(in) :: method
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: f
    if (.not. method%rotation) return
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0 .or. .not. fields(f)%columns%turns) cycle
      call field_rotation_prepare(fields(f), mesh, method%cutoff, team, partition)
    end do
  end subroutine phase_rotation

  !> Weights of the correction at surfaces, for the volumes as they lie.
  subroutine phase_surfaces_weigh(method, mesh, fields, bodies, team, partition)
    type(method_t), intent(in) :: method
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: f
    if (.not. method%surfaces) return
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0 .or. .not. fields(f)%columns%corrected) cycle
      call field_surfaces_weigh(fields(f), mesh, team, partition)
    end do
  end subroutine phase_surfaces_weigh

  !> What the correction at surfaces adds to the gradient of a nodal velocity, before particles read
  !! it.
  subroutine phase_surfaces_strain(step, method, mesh, fields, bodies, column, team, ranks, &
                                   findings, timers)
    integer, intent(in) :: step                  !! its number
    type(method_t), intent(in) :: method
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: column                !! first column of the velocity
    type(team_t), intent(in) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    integer :: f
    if (.not. method%surfaces) return
    call phase_swap_nodes(step, [column, column + mesh%ndim - 1], 1, fields, bodies, ranks, &
                          findings, timers)
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0 .or. .not. fields(f)%columns%corrected) cycle
      call field_surfaces_strain(fields(f), mesh, column, team, ranks%partition)
    end do
  end subroutine phase_surfaces_strain

  !> Takes nodal velocities to the places of the nodes, where rotation is exact.
  subroutine phase_place(step, method, mesh, fields, bodies, columns, kick, team, ranks, &
                         findings, timers)
    integer, intent(in) :: step                  !! its number
    type(method_t), intent(in) :: method
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: columns(:)            !! first column of each; the curl of the first
    real(dp), intent(in) :: kick                 !! times the acceleration is left out of the curl
    type(team_t), intent(in) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    integer :: f, swapped(2)
    if (.not. method%rotation) return
    swapped = [columns(1), columns(1) + mesh%ndim - 1]
    if (abs(kick) > 0.0_dp) swapped(1) = node_acceleration
    call phase_swap_nodes(step, swapped, 1, fields, bodies, ranks, findings, timers)
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0 .or. .not. fields(f)%columns%turns) cycle
      call field_rotation_place(fields(f), mesh, columns, kick, team, ranks%partition)
    end do
  end subroutine phase_place

  !> Nodes of the planes next to those that particles of this rank read, or more of them, as the
  !! neighbours know them.
  subroutine phase_swap_nodes(step, columns, planes, fields, bodies, ranks, findings, timers)
    integer, intent(in) :: step                  !! its number
    integer, intent(in) :: columns(2)            !! first and last
    integer, intent(in) :: planes                !! on either side
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    logical :: complete
    real(dp) :: since
    integer :: f
    if (ranks%partition%ranks == 1) return
    since = wall_time()
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0) cycle
      call field_rotation_swap(fields(f), columns, planes, ranks, complete)
      if (.not. complete .and. .not. allocated(findings%failure)) then
        call error_make(findings%failure, exit_numerical, 'a rank has no place for velocities '// &
                        'of its neighbour in step '//integer_text(step), &
                        'this is a fault of the program: report it')
      end if
    end do
    call timers_move(timers, phase_halo, since)
  end subroutine phase_swap_nodes

  !> Volume-normalised stress at all centres, where the scene asks for it.
  subroutine phase_normalise(method, mesh, fields, team, partition)
    type(method_t), intent(in) :: method
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: f
    if (.not. method%normalised) return
    do f = 1, size(fields)
      if (fields(f)%columns%volume == 0) cycle
      call field_normalise(fields(f), mesh, method, team, partition)
    end do
  end subroutine phase_normalise

  !> What particles relax to at all centres, where the scene asks for it.
  subroutine phase_relax(method, dt, mesh, fields, bodies, team, partition)
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: dt
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: f, axis
    if (.not. method%relaxed) return
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0) cycle
      call field_relax(fields(f), mesh, method, dt, team, partition)
      do axis = 1, mesh%ndim
        call walls_mirror_centres(fields(f), mesh, axis, 1, fields(f)%planes)
      end do
    end do
  end subroutine phase_relax

  !> What plastic strain is averaged by, at all points, those behind walls included: a copy, for
  !! sweeps write the sums anew while they read.
  subroutine phase_average(mesh, fields, threads)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    integer, intent(in) :: threads
    integer :: f, axis
    do f = 1, size(fields)
      if (fields(f)%columns%average == 0) cycle
      call average_points(threads, fields(f))
      do axis = 1, mesh%ndim
        call walls_mirror_average(fields(f), mesh, axis)
      end do
    end do
  end subroutine phase_average

  !> The same at the points of one field.
  subroutine average_points(threads, field)
    integer, intent(in) :: threads
    type(field_t), intent(inout) :: field
    integer :: p, i, c
    c = field%columns%average
    !$omp parallel do num_threads(threads) if(threads > 1) schedule(static) default(none) &
    !$omp& shared(field, c) private(p, i)
    do p = 1, field%planes
      do i = field%plane_start(p), field%plane_start(p + 1) - 1
        field%average(i, :) = averaging_rate(field%moment(i, c:c + averaging_sums - 1))
      end do
    end do
    !$omp end parallel do
  end subroutine average_points

  !> Momentum equation at all nodes (Eqs. 33, 34); rigid bodies must know their speed.
  subroutine phase_solve(method, dt, mesh, fields, bodies, team, partition, tally)
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: dt                   !! velocity step dt^k
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    type(tally_t), intent(inout) :: tally
    real(dp), allocatable :: sums(:, :)
    integer :: f, p, b, k, p1, p2
    do f = 1, size(fields)
      b = rigid_field(bodies, f)
      if (b > 0) then
        call rigid_solve(bodies(b), mesh, fields(f), dt)
        cycle
      end if
      allocate (sums(nodes_sums, fields(f)%planes), source=0.0_dp)
      if (fields(f)%columns%driven > 0) call clear_drives(fields(f))
      call field_solve(fields(f), mesh, method, dt, &
                       body_forced(bodies, f), team, partition, sums)
      call halo_own_planes(fields(f), partition, p1, p2)
      do p = p1, p2
        call tally_add(tally, 1 + size(bodies)*sweep_sums, sums(:, p))
        do k = 1, fields(f)%columns%driven
          call tally_add(tally, 1 + fields(f)%drive_terms + (k - 1)*drive_sums, &
                         fields(f)%drive_sums(:, k, p))
        end do
      end do
      deallocate (sums)
    end do
  end subroutine phase_solve

  !> Empties the sums of what driven nodes take.
  pure subroutine clear_drives(field)
    type(field_t), intent(inout) :: field
    if (allocated(field%drive_sums)) deallocate (field%drive_sums)
    allocate (field%drive_sums(drive_sums, field%columns%driven, field%planes), source=0.0_dp)
  end subroutine clear_drives

  !> Nodal velocity before the stress update (USF).
  subroutine phase_velocity(method, mesh, fields, bodies, team, partition)
    type(method_t), intent(in) :: method
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: f, b
    do f = 1, size(fields)
      b = rigid_field(bodies, f)
      if (b > 0) then
        call rigid_velocity(bodies(b), mesh, .true., node_velocity(mesh%ndim), fields(f))
      else
        call field_velocity(fields(f), mesh, method%cutoff, team, partition)
      end if
    end do
  end subroutine phase_velocity

  !> Nodal velocity re-mapped from the updated particles (MUSL).
  subroutine phase_remap(method, mesh, fields, bodies, team, partition)
    type(method_t), intent(in) :: method
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    integer :: f, b
    do f = 1, size(fields)
      b = rigid_field(bodies, f)
      if (b > 0) then
        call rigid_velocity(bodies(b), mesh, .false., node_remapped, fields(f))
      else
        call field_remap(fields(f), mesh, method, team, partition)
      end if
    end do
  end subroutine phase_remap

end module sgmp_phases
