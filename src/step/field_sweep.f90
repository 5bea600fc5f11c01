!> A sweep over the particles of one velocity field: which planes each thread takes, which
!! dimension's procedures do them, and how the sums of slabs and ranks are joined.
!!
!! Between ranks the planes that neighbours wait for are swept first and sent, so that messages are
!! under way while the others are swept. Where a slab ends changes no sum: a plane between two slabs
!! is joined to what the straight sweep would have made of it.
module sgmp_field_sweep
  use sgmp_body, only: body_number
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_field, only: field_t
  use sgmp_halo, only: halo_own_planes, halo_read_sums, halo_write_above, halo_write_below
  use sgmp_kernels, only: stencil_width
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_lost_particles, only: lost_particles_check
  use sgmp_model, only: model_t
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_plan, only: plan_t, workspace_t
  use sgmp_sums, only: sweep_sums
  use sgmp_sweep_1d, only: sweep_join_1d => sweep_join, sweep_slab_1d => sweep_slab
  use sgmp_sweep_2d, only: sweep_join_2d => sweep_join, sweep_slab_2d => sweep_slab
  use sgmp_sweep_3d, only: sweep_join_3d => sweep_join, sweep_slab_3d => sweep_slab
  use sgmp_tally, only: tally_add
  use sgmp_text, only: integer_text
  use sgmp_timers, only: phase_halo, timers_move, wall_time
  implicit none
  private
  public :: field_divide, field_slabs, field_sweep, sweep_columns

  !> Slabs of a field: the lowest and highest planes of the rank, where neighbours wait for them,
  !! and one for each thread between.
  integer, parameter :: borders = 2

contains

  !> Slabs that a field is divided into, some of which may be empty.
  pure function field_slabs(threads) result(slabs)
    integer, intent(in) :: threads
    integer :: slabs
    slabs = threads + borders
  end function field_slabs

  !> Divides the planes into slabs: the threads' loads, in chunks, are about the same, of which the
  !! borders belong to the first thread.
  subroutine field_divide(model, f)
    type(model_t), intent(inout) :: model
    integer, intent(in) :: f
    integer(i8), allocatable :: load(:)
    integer(i8) :: before, total
    integer :: p, t, p1, p2, least, border(2)
    call halo_own_planes(model%fields(f), model%partition, p1, p2)
    allocate (load(p1:p2))
    do p = p1, p2
      load(p) = plane_load(model, f, p)
    end do
    total = sum(load)
    least = max(1, layers(model, f) - 1)
    border = border_planes(model, f)
    before = sum(load(:p1 + border(1) - 1)) + sum(load(p2 - border(2) + 1:))
    if (sum(border) + least > p2 - p1 + 1 .or. before*model%threads > total) then
      border = 0
      before = 0_i8
    end if
    model%slabs(:, f) = p2 - border(2) + 1
    model%slabs(1, f) = p1
    model%slabs(2, f) = p1 + border(1)
    model%slabs(size(model%slabs, 1), f) = p2 + 1
    t = 1
    do p = p1 + border(1), p2 - border(2)
      if (t < model%threads .and. before*model%threads >= total*t .and. &
          p - model%slabs(t + 1, f) >= least .and. p2 - border(2) - p + 1 >= least) then
        t = t + 1
        model%slabs(t + 1, f) = p
      end if
      before = before + load(p)
    end do
  end subroutine field_divide

  !> Planes that a particle gives to.
  pure function layers(model, f) result(n)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    integer :: n
    n = merge(1, stencil_width(model%fields(f)%kernel), model%mesh%ndim == 1)
  end function layers

  !> Chunks of a plane.
  pure function plane_load(model, f, p) result(load)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f, p
    integer(i8) :: load
    integer :: b, s, first, last
    load = 0_i8
    do b = 1, size(model%bodies)
      if (model%bodies(b)%field /= f) cycle
      associate (particles => model%bodies(b)%particles)
        do s = particles%plane_row(p), particles%plane_row(p + 1) - 1
          first = particles%bin_start(s) + particles%bins%first(s)
          last = particles%bin_start(s) + particles%bins%last(s)
          load = load + sum(int((particles%size(first:last) + lanes - 1)/lanes, i8))
        end do
      end associate
    end do
  end function plane_load

  !> Planes that a neighbour below and above waits for; above also those in which a slab is joined
  !! to the one below.
  pure function border_planes(model, f) result(border)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    integer :: border(2), joined
    joined = layers(model, f) - 1
    border = 0
    associate (partition => model%partition)
      if (partition%rank > 0) border(1) = max(partition%moments(2), joined)
      if (partition%rank < partition%ranks - 1) border(2) = partition%moments(1) + joined
    end associate
  end function border_planes

  !> One sweep; what it finds goes into the tally and to `fastest` and `failure` of the model.
  subroutine field_sweep(model, plan, f)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    real(dp), allocatable :: sums(:, :, :)
    type(plan_t) :: own
    integer :: t, s, b, p
    logical :: sent
    own = plan
    call sweep_columns(own, model%fields(f))
    sent = has_borders(model, f)
    allocate (sums(sweep_sums, model%fields(f)%planes, size(model%bodies)), source=0.0_dp)
    ! One region for both: each that is opened costs a meeting of the threads more.
    !$omp parallel num_threads(model%threads) if(model%threads > 1) &
    !$omp& default(none) shared(model, own, f, sums, sent) private(t, s)
    !$omp do schedule(static, 1)
    do t = 1, model%threads
      if (t == 1) call sweep_borders(model, own, f, sums)  ! this thread may send
      call sweep_slab(model, own, f, t + 1, sums)
    end do
    !$omp end do
    !$omp do schedule(static, 1)
    do s = 1, field_slabs(model%threads)
      call join_slabs(model, own, f, s)
    end do
    !$omp end do nowait
    !$omp end parallel
    if (model%partition%ranks > 1) then
      if (.not. sent) call send_sums(model, own, f)
      call join_ranks(model, own, f)
    end if
    do b = 1, size(model%bodies)
      if (model%bodies(b)%field /= f) cycle
      do p = model%slabs(1, f), model%slabs(size(model%slabs, 1), f) - 1
        call tally_add(model%tally, 1 + (b - 1)*sweep_sums, sums(:, p, b))
      end do
    end do
    call collect_findings(model, plan, f)
  end subroutine field_sweep

  pure function has_borders(model, f) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    logical :: yes
    yes = .not. (empty(model, f, 1) .and. empty(model, f, field_slabs(model%threads)))
  end function has_borders

  pure function empty(model, f, s) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f, s
    logical :: yes
    yes = model%slabs(s + 1, f) <= model%slabs(s, f)
  end function empty

  !> Columns of the moments that a sweep fills.
  pure subroutine sweep_columns(plan, field)
    type(plan_t), intent(inout) :: plan
    type(field_t), intent(in) :: field
    if (plan%mass) then
      plan%first_column = field%columns%mass
    else if (plan%momentum) then
      plan%first_column = field%columns%momentum
    else
      plan%first_column = field%columns%force
    end if
    plan%spins = field%columns%spins
    plan%last_column = merge(field%columns%total, field%columns%force - 1, plan%stress)
    if (plan%probe .and. plan%stress) then
      plan%last_column = field%columns%force + field%columns%forces - 1
    end if
    plan%volume = plan%stress .and. field%columns%volume > 0 .and. .not. plan%probe
  end subroutine sweep_columns

  !> Sweeps what neighbours wait for and sends it.
  subroutine sweep_borders(model, plan, f, sums)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    real(dp), intent(inout) :: sums(:, :, :)
    call sweep_slab(model, plan, f, 1, sums)
    call sweep_slab(model, plan, f, field_slabs(model%threads), sums)
    if (has_borders(model, f)) call send_sums(model, plan, f)
  end subroutine sweep_borders

  subroutine sweep_slab(model, plan, f, s, sums)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f, s
    real(dp), intent(inout) :: sums(:, :, :)
    integer :: p1, p2
    p1 = model%slabs(s, f)
    p2 = model%slabs(s + 1, f) - 1
    select case (model%mesh%ndim)
    case (1)
      call sweep_slab_1d(model%mesh, model%fields(f), f, model%bodies, plan, p1, p2, &
                         sums, model%movers(:, s), model%workspaces(s, f))
    case (2)
      call sweep_slab_2d(model%mesh, model%fields(f), f, model%bodies, plan, p1, p2, &
                         sums, model%movers(:, s), model%workspaces(s, f))
    case default
      call sweep_slab_3d(model%mesh, model%fields(f), f, model%bodies, plan, p1, p2, &
                         sums, model%movers(:, s), model%workspaces(s, f))
    end select
    if (plan%drift) call lost_particles_check(model, plan, f, s)
  end subroutine sweep_slab

  !> Joins a slab with the one below it; the lowest one waits for the rank below.
  subroutine join_slabs(model, plan, f, s)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f, s
    integer :: below, p1, p2
    if (empty(model, f, s)) return
    p1 = model%slabs(s, f)
    p2 = model%slabs(s + 1, f) - 1
    below = s - 1
    do while (below > 0)
      if (.not. empty(model, f, below)) exit
      below = below - 1
    end do
    if (below > 0) then
      call join(model, plan, f, p1, p2, model%workspaces(s, f), model%workspaces(below, f))
    else if (model%partition%ranks == 1) then
      call join(model, plan, f, p1, p2, model%workspaces(s, f))
    end if
  end subroutine join_slabs

  !> Completes the first planes of a slab with what the slab below gave to them.
  subroutine join(model, plan, f, p1, p2, own, below)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f, p1, p2
    type(workspace_t), intent(in) :: own
    type(workspace_t), intent(in), optional :: below
    select case (model%mesh%ndim)
    case (1)
      call sweep_join_1d(model%fields(f), plan, p1, p2, own, below)
    case (2)
      call sweep_join_2d(model%fields(f), plan, p1, p2, own, below)
    case default
      call sweep_join_3d(model%fields(f), plan, p1, p2, own, below)
    end select
  end subroutine join

  !> The lowest and highest slab that are not empty; 1 if all are.
  pure subroutine outer_slabs(model, f, lowest, highest)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    integer, intent(out) :: lowest, highest
    lowest = 1
    do while (lowest < field_slabs(model%threads) .and. empty(model, f, lowest))
      lowest = lowest + 1
    end do
    highest = field_slabs(model%threads)
    do while (highest > 1 .and. empty(model, f, highest))
      highest = highest - 1
    end do
  end subroutine outer_slabs

  !> Sends the sums of the outer planes, before they are joined with those of other ranks.
  subroutine send_sums(model, plan, f)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    real(dp) :: since
    integer :: lowest, highest, columns(2)
    since = wall_time()
    columns = [plan%first_column, plan%last_column]
    call outer_slabs(model, f, lowest, highest)
    associate (work => model%workspaces(:, f), swap => model%swap)
      call halo_write_below(model%fields(f), model%partition, columns, layers(model, f), &
        work(lowest), &
                            swap%to_below)
      call halo_write_above(model%fields(f), model%partition, columns, layers(model, f), &
                            work(highest), swap%to_above)
      call neighbours_send(swap, model%traffic)
    end associate
    call timers_move(model%timers, phase_halo, since)
  end subroutine send_sums

  !> Joins the own planes with those of the neighbours, as slabs of threads are joined.
  subroutine join_ranks(model, plan, f)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    real(dp) :: since
    integer :: lowest, highest, p1, p2, columns(2)
    logical :: complete
    since = wall_time()
    columns = [plan%first_column, plan%last_column]
    call outer_slabs(model, f, lowest, highest)
    associate (field => model%fields(f), work => model%workspaces(:, f), swap => model%swap)
      call neighbours_receive(swap)
      call halo_read_sums(field, model%partition, columns, layers(model, f), swap%from_below, &
                          swap%from_above, model%below(f), model%above(f), complete)
      call neighbours_wait(swap)
      if (.not. complete) call misplaced(model)
      call halo_own_planes(field, model%partition, p1, p2)
      if (p2 >= p1) then
        call join(model, plan, f, p1, model%slabs(lowest + 1, f) - 1, work(lowest), model%below(f))
        if (p2 < field%planes) then
          call join(model, plan, f, p2 + 1, min(p2 + 2, field%planes), model%above(f), &
                    work(highest))
        end if
      end if
    end associate
    call timers_move(model%timers, phase_halo, since)
  end subroutine join_ranks

  !> A neighbour sent a value for a point that is not stored here.
  subroutine misplaced(model)
    type(model_t), intent(inout) :: model
    if (allocated(model%failure)) return
    call error_make(model%failure, exit_numerical, 'a rank has no place for what its neighbour '// &
                    'sent in step '//integer_text(model%clock%step + 1), &
                    'this is a fault of the program: report it')
  end subroutine misplaced

  !> Puts the findings of the slabs together: the fastest particle, and the first one out of its
  !! senses.
  subroutine collect_findings(model, plan, f)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    integer :: s
    if (.not. plan%strain) return
    do s = 1, field_slabs(model%threads)
      if (empty(model, f, s)) cycle
      associate (work => model%workspaces(s, f))
        if (work%fastest > model%fastest) then
          model%fastest = work%fastest
          model%fastest_id = work%fastest_id
          model%fastest_field = f
        end if
        if (work%bad_id > 0 .and. .not. allocated(model%failure)) then
          call error_make(model%failure, exit_numerical, 'particle '//integer_text(work%bad_id)// &
                          ' of body '//trim(model%bodies(body_number(model%bodies, &
                          work%bad_id))%name)// &
                          trim(merge(' has an imaginary sound speed   ', &
                                     ' is inside out or not a number  ', work%no_sound))// &
                          ' after step '//integer_text(model%clock%step + 1), &
                          'reduce cfl, add bulk viscosity, or use a finer grid; see the last '// &
                          'dump for where it is')
        end if
      end associate
    end do
  end subroutine collect_findings

end module sgmp_field_sweep
