!> Particles that change bins: those that leave the grid or the rank, those that come, and what they
!! bring to the grid.
module sgmp_rebin_phases
  use sgmp_buffer, only: buffer_left, buffer_put, buffer_t, buffer_whole
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_field_sweep, only: sweep_columns
  use sgmp_kernels, only: stencil_width
  use sgmp_kinds, only: dp, i4
  use sgmp_lost_particles, only: lost_particles_find_bins
  use sgmp_model, only: model_t
  use sgmp_movers, only: movers_read, movers_reset, movers_t, movers_write
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_parallel, only: parallel_collect
  use sgmp_particles, only: bin_coordinates, particles_t
  use sgmp_phases, only: phase_fold, phase_layout
  use sgmp_plan, only: plan_t
  use sgmp_rebinning, only: arrivals_t, particles_close_lists, particles_extend_bins, &
                            particles_receive, particles_receive_rest
  use sgmp_sweep_1d, only: sweep_add_movers_1d => sweep_add_movers
  use sgmp_sweep_2d, only: sweep_add_movers_2d => sweep_add_movers
  use sgmp_sweep_3d, only: sweep_add_movers_3d => sweep_add_movers
  use sgmp_text, only: integer_text, real_text
  use sgmp_timers, only: phase_halo, timers_move, wall_time
  implicit none
  private
  public :: phase_rebin_particles

  character(1), parameter :: axis_names(3) = ['x', 'y', 'z']
  integer, parameter :: few = 512                !! movers that are not worth a meeting of threads

contains

  !> Moves particles to their new bins, follows them with the grid, and folds the moments at walls.
  subroutine phase_rebin_particles(model, plan)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer :: b
    logical :: changed(size(model%fields))
    changed = .false.
    model%moved = 0
    if (plan%drift) then
      call report_culprits(model)
      if (model%partition%ranks > 1) call swap_movers(model)
      model%moved = sum(model%movers%n)
      do b = 1, size(model%bodies)
        if (.not. any(model%movers(b, :)%homeless)) cycle
        associate (particles => model%bodies(b)%particles)
          call particles_extend_bins(particles, model%movers(b, :), &
                                     model%mesh%lower - particles%shift, &
                                     model%mesh%upper + particles%shift)
        end associate
        changed(model%bodies(b)%field) = .true.
      end do
      if (any(changed)) call phase_layout(model, changed)
      do b = 1, size(model%bodies)
        if (any(model%movers(b, :)%n > 0)) call settle_movers(model, plan, b)
      end do
    end if
    call phase_fold(model, plan)
  end subroutine phase_rebin_particles

  !> An error for the first particle that has left the grid where it must not.
  subroutine report_culprits(model)
    type(model_t), intent(inout) :: model
    integer :: b, s
    do b = 1, size(model%bodies)
      do s = 1, size(model%movers, 2) - 1
        associate (movers => model%movers(b, s), m => model%movers(b, s)%culprit(1), &
                   d => model%movers(b, s)%culprit(2))
          if (movers%n == 0 .or. m == 0 .or. allocated(model%failure)) cycle
          call error_make(model%failure, exit_numerical, 'particle '// &
                          integer_text(movers%id(m))//' of body '// &
                          trim(model%bodies(b)%name)//' left the grid along '// &
                          axis_names(d)//' at '// &
                          real_text(model%mesh%origin(d) + model%mesh%h*movers%particle(d, m))// &
                          ' in step '//integer_text(model%clock%step + 1), &
                          'extend the grid, leave that face open, or choose '// &
                          '`lost policy=remove` or `reflect`')
        end associate
      end do
    end do
  end subroutine report_culprits

  !> Tells the neighbours of the particles that have moved into their planes, or next to them.
  !!
  !! Where particles may cross more than a cell, every rank tells all others.
  subroutine swap_movers(model)
    type(model_t), intent(inout) :: model
    type(buffer_t) :: all
    real(dp) :: since
    integer :: b, s, m, n, plane, bin(3), received
    logical :: far
    since = wall_time()
    received = size(model%movers, 2)
    far = model%clock%dt*model%fastest_before*model%mesh%inverse_h > 1.0_dp
    do b = 1, size(model%bodies)
      call movers_reset(model%movers(b, received), size(model%movers(b, 1)%particle, 1), &
                        size(model%movers(b, 1)%values, 1))
      do s = 1, received - 1
        associate (movers => model%movers(b, s), particles => model%bodies(b)%particles, &
                   partition => model%partition)
          do m = 1, movers%n
            bin = bin_coordinates(movers%particle(:, m), particles%shift, particles%ndim)
            plane = bin(3)
            if (far) then
              call write_mover(b, movers, m, all)
              cycle
            end if
            if (plane < partition%own(1) + partition%bins(2)) then
              call write_mover(b, movers, m, model%swap%to_below)
            end if
            if (plane > partition%own(2) - partition%bins(1)) then
              call write_mover(b, movers, m, model%swap%to_above)
            end if
            if (plane < partition%own(1) - 1 .or. plane > partition%own(2) + 1) then
              call moved_too_far(model, b, movers%id(m))
            end if
          end do
        end associate
      end do
    end do
    if (far) then
      if (.not. allocated(all%values)) allocate (all%values(0))
      n = all%n
      call parallel_collect(all%values(:n), model%swap%from_below%values)
      model%swap%from_below%n = size(model%swap%from_below%values)
      model%swap%from_below%read = 0
      call read_movers(model, model%swap%from_below)
    else
      call neighbours_send(model%swap, model%traffic)
      call neighbours_receive(model%swap)
      call read_movers(model, model%swap%from_below)
      call read_movers(model, model%swap%from_above)
      call neighbours_wait(model%swap)
    end if
    do b = 1, size(model%bodies)
      call lost_particles_find_bins(model%mesh, model%bodies(b)%particles, model%movers(b, &
        received))
    end do
    call timers_move(model%timers, phase_halo, since)
  end subroutine swap_movers

  pure subroutine write_mover(b, movers, m, buffer)
    integer, intent(in) :: b, m
    type(movers_t), intent(in) :: movers
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, [real(b, dp)])
    call movers_write(movers, m, buffer)
  end subroutine write_mover

  subroutine read_movers(model, buffer)
    type(model_t), intent(inout) :: model
    type(buffer_t), intent(inout) :: buffer
    integer :: b
    do while (buffer_left(buffer))
      call buffer_whole(buffer, b)
      call movers_read(model%movers(b, size(model%movers, 2)), buffer)
    end do
  end subroutine read_movers

  !> A particle has crossed more than a cell although the time step should not let it.
  subroutine moved_too_far(model, b, id)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: b
    integer(i4), intent(in) :: id
    if (allocated(model%failure)) return
    call error_make(model%failure, exit_numerical, 'particle '//integer_text(id)//' of body '// &
                    trim(model%bodies(b)%name)//' has crossed more than a cell in step '// &
                    integer_text(model%clock%step + 1), &
                    'reduce cfl or dt; see the last dump for where it is')
  end subroutine moved_too_far

  !> Puts the movers of one body into their bins and adds them to the grid; every thread has a range
  !! of planes, and the bins that reach into it are all it needs.
  subroutine settle_movers(model, plan, b)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: b
    type(plan_t) :: own
    type(arrivals_t) :: arrivals(model%threads)
    integer :: f, s, t, planes(2), team
    f = model%bodies(b)%field
    own = plan
    call sweep_columns(own, model%fields(f))
    do s = 1, size(model%movers, 2)
      associate (movers => model%movers(b, s))
        model%lost_here = model%lost_here + count(movers%gone(:movers%n) .and. &
                                                  movers%here(:movers%n))
      end associate
    end do
    call particles_close_lists(model%bodies(b)%particles, model%movers(b, :))
    team = merge(model%threads, 1, sum(model%movers(b, :)%n) > few)
    !$omp parallel do schedule(static, 1) num_threads(team) if(team > 1) default(none) &
    !$omp& shared(model, own, b, f, arrivals) private(t, planes)
    do t = 1, model%threads
      planes = planes_of(model, f, t)
      call particles_receive(model%bodies(b)%particles, model%movers(b, :), &
                             bins_of(model%bodies(b)%particles, planes, &
                                     stencil_width(model%fields(f)%kernel)), arrivals(t))
      call add_movers(model, own, b, arrivals(t), planes)
    end do
    !$omp end parallel do
    call particles_receive_rest(model%bodies(b)%particles, model%movers(b, :), arrivals)
  end subroutine settle_movers

  !> Planes of a field that a thread adds movers to: those of its slab, and for the first and the
  !! last also those of the borders and of other ranks.
  pure function planes_of(model, f, thread) result(planes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f, thread
    integer :: planes(2)
    planes = [model%slabs(thread + 1, f), model%slabs(thread + 2, f) - 1]
    if (thread == 1) planes(1) = 1
    if (thread == model%threads) planes(2) = model%fields(f)%planes
  end function planes_of

  !> First bin whose stencil reaches into some planes, first bin in them, last bin.
  pure function bins_of(particles, planes, width) result(bins)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: planes(2), width      !! width: of the stencil
    integer :: bins(3)
    bins = [first_bin(particles, max(1, planes(1) - width + 1)), &
            first_bin(particles, planes(1)), first_bin(particles, planes(2) + 1) - 1]
  end function bins_of

  !> First bin of a plane or, where it has none, of the next that does.
  pure function first_bin(particles, plane) result(bin)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: plane
    integer :: bin, row
    row = particles%plane_row(plane)
    bin = size(particles%size) + 1
    if (row <= particles%bins%n) bin = particles%bin_start(row) + particles%bins%first(row)
  end function first_bin

  !> Adds the movers of one body to some planes of the grid.
  subroutine add_movers(model, plan, b, arrivals, planes)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: b, planes(2)
    type(arrivals_t), intent(in) :: arrivals
    if (arrivals%n == 0) return
    associate (field => model%fields(model%bodies(b)%field), body => model%bodies(b), &
               lists => model%movers(b, :))
      select case (model%mesh%ndim)
      case (1)
        call sweep_add_movers_1d(model%mesh, field, body, plan, lists, arrivals, planes)
      case (2)
        call sweep_add_movers_2d(model%mesh, field, body, plan, lists, arrivals, planes)
      case default
        call sweep_add_movers_3d(model%mesh, field, body, plan, lists, arrivals, planes)
      end select
    end associate
  end subroutine add_movers

end module sgmp_rebin_phases
