!> New cuts between ranks when loads have moved: particles and sums of the grid go to their new
!! owners as they are, so that nothing depends on when it happens.
module sgmp_balancing
  use sgmp_bin_change, only: bin_close
  use sgmp_buffer, only: buffer_t
  use sgmp_columns, only: stage_stress
  use sgmp_contact_memory, only: memory_share
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_halo, only: halo_clear, halo_get_planes, halo_own_planes, halo_put_moments
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_movers, only: movers_add, movers_reset, movers_t
  use sgmp_parallel, only: parallel_deal, parallel_gather, parallel_sum, parallel_trade
  use sgmp_particles, only: particles_t
  use sgmp_partition, only: partition_cut, partition_imbalance, partition_loads, partition_owner, &
                            partition_t
  use sgmp_phases, only: phase_layout
  use sgmp_plan, only: workspace_t
  use sgmp_ranks, only: ranks_hold, ranks_renew_bins
  use sgmp_rebinning, only: arrivals_t, particles_rebin
  use sgmp_rigid_bodies, only: rigid_field
  use sgmp_rows, only: key_k
  use sgmp_scene, only: balance_card_t
  use sgmp_slabs, only: far_plane
  use sgmp_stages, only: stage_brings_stress
  use sgmp_timers, only: phase_balance, phase_contact, phase_drift, phase_grid, phase_kick, &
                         timers_stop
  use sgmp_update, only: update_usavg, update_usf
  implicit none
  private
  public :: balancing_look

  !> Work at a grid point over that of a particle, before any has been measured.
  real(dp), parameter :: usual_weight = 0.3_dp, largest_weight = 2.0_dp
  integer, parameter :: columns = 3      !! what a plane has: particles, grid points, pairs at nodes

contains

  !> Moves the cuts where it pays; all ranks decide alike.
  subroutine balancing_look(model, card, done)
    type(model_t), intent(inout) :: model
    type(balance_card_t), intent(in) :: card
    logical, intent(out) :: done
    type(partition_t) :: new
    real(dp), allocatable :: particles(:), load(:)
    integer :: first
    done = .false.
    if (model%ranks%partition%ranks == 1 .or. card%every == 0) return
    if (.not. model%ranks%partition%divisible) return
    if (model%clock%step == 0 .or. mod(model%clock%step, card%every) /= 0) return
    call measure(model, first, particles, load)
    associate (partition => model%ranks%partition, balance => model%ranks%balance)
      balance%imbalance = partition_imbalance(partition_loads(partition, first, particles))
      balance%largest = max(balance%largest, balance%imbalance)
      new = partition
      call partition_cut(new, first, load)
      done = partition_imbalance(partition_loads(new, first, load)) < &
             (1.0_dp - card%gain)*partition_imbalance(partition_loads(partition, first, load))
      if (done) then
        call move(model, new)
        balance%cuts = balance%cuts + 1
        balance%imbalance = partition_imbalance(partition_loads(new, first, particles))
      end if
    end associate
    call timers_stop(model%timers, phase_balance)
  end subroutine balancing_look

  !> Particles and load of every plane, in particles; a grid point and a pair of bodies at a node
  !! count as what they have cost.
  subroutine measure(model, first, particles, load)
    type(model_t), intent(in) :: model
    integer, intent(out) :: first                !! first plane
    real(dp), allocatable, intent(out) :: particles(:), load(:)
    type(buffer_t) :: own
    real(dp), allocatable :: all(:), table(:, :)
    real(dp) :: seconds(columns)
    integer :: at, c, k, last, n
    call list_planes(model, own)
    call parallel_gather(own%values(:own%n), all)  ! in one order for all, who must decide alike
    first = far_plane
    last = -far_plane
    seconds = 0.0_dp
    at = 0
    do while (at < size(all))
      seconds = seconds + all(at + 1:at + columns)
      first = min(first, nint(all(at + columns + 1)))
      n = nint(all(at + columns + 2))
      last = max(last, nint(all(at + columns + 1)) + n - 1)
      at = at + columns + 2 + columns*n
    end do
    allocate (table(max(0, last - first + 1), columns), source=0.0_dp)
    at = 0
    do while (at < size(all))
      k = nint(all(at + columns + 1)) - first
      n = nint(all(at + columns + 2))
      at = at + columns + 2
      do c = 1, columns
        table(k + 1:k + n, c) = table(k + 1:k + n, c) + all(at + 1:at + n)
        at = at + n
      end do
    end do
    particles = table(:, 1)
    load = particles + min(largest_weight, weight_of(2, usual_weight))*table(:, 2) + &
           weight_of(3, 0.0_dp)*table(:, 3)

  contains

    !> What one of a column costs over what a particle costs.
    pure function weight_of(column, usual) result(weight)
      integer, intent(in) :: column
      real(dp), intent(in) :: usual              !! before anything has been measured
      real(dp) :: weight, number(2)
      number = [sum(table(:, 1)), sum(table(:, column))]
      weight = usual
      if (min(seconds(1), seconds(column), minval(number)) <= 0.0_dp) return
      weight = seconds(column)/number(2)*number(1)/seconds(1)
    end function weight_of

  end subroutine measure

  !> This rank's seconds in sweeps, on the grid and in contact, first plane and number of planes,
  !! then of each plane the particles that move, the grid points and the pairs that meet at nodes.
  pure subroutine list_planes(model, own)
    type(model_t), intent(in) :: model
    type(buffer_t), intent(out) :: own
    real(dp), allocatable :: table(:, :)
    integer :: f, p1, p2, first, last
    first = far_plane
    last = -far_plane
    do f = 1, size(model%fields)
      call halo_own_planes(model%fields(f), model%ranks%partition, p1, p2)
      if (p2 < p1) cycle
      first = min(first, model%fields(f)%plane_k(p1))
      last = max(last, model%fields(f)%plane_k(p2))
    end do
    if (last < first) then
      allocate (own%values(0))
      own%n = 0
      return
    end if
    allocate (table(first:last, columns), source=0.0_dp)
    call count_particles(model, first, table(:, 1))
    call count_points(model, first, table(:, 2))
    call count_meetings(model, first, table(:, 3))
    associate (spent => model%timers%seconds)
      own%values = [spent(phase_kick) + spent(phase_drift), spent(phase_grid), &
                    spent(phase_contact), real([first, last - first + 1], dp), table]
    end associate
    own%n = size(own%values)
  end subroutine list_planes

  !> Particles of bodies that move, by plane.
  pure subroutine count_particles(model, first, number)
    type(model_t), intent(in) :: model
    integer, intent(in) :: first
    real(dp), intent(inout) :: number(first:)
    integer :: b, s, k, n1, n2
    do b = 1, size(model%bodies)
      if (model%bodies(b)%at_rest) cycle
      associate (particles => model%bodies(b)%particles)
        do s = 1, particles%bins%n
          k = key_k(particles%bins%key(s))
          if (k < model%ranks%partition%own(1) .or. k > model%ranks%partition%own(2)) cycle
          n1 = particles%bin_start(s) + particles%bins%first(s)
          n2 = particles%bin_start(s) + particles%bins%last(s)
          number(k) = number(k) + sum(particles%size(n1:n2))
        end do
      end associate
    end do
  end subroutine count_particles

  !> Grid points by plane, but for those of bodies at rest.
  pure subroutine count_points(model, first, number)
    type(model_t), intent(in) :: model
    integer, intent(in) :: first
    real(dp), intent(inout) :: number(first:)
    integer :: b, f, p, p1, p2, k
    do f = 1, size(model%fields)
      b = rigid_field(model%bodies, f)
      if (b > 0) then
        if (model%bodies(b)%at_rest) cycle
      end if
      call halo_own_planes(model%fields(f), model%ranks%partition, p1, p2)
      do p = p1, p2
        k = model%fields(f)%plane_k(p)
        number(k) = number(k) + model%fields(f)%plane_start(p + 1) - &
                    model%fields(f)%plane_start(p)
      end do
    end do
  end subroutine count_points

  !> Pairs of bodies that meet at the nodes of each plane.
  pure subroutine count_meetings(model, first, number)
    type(model_t), intent(in) :: model
    integer, intent(in) :: first
    real(dp), intent(inout) :: number(first:)
    integer :: n, k
    associate (shared => model%contact%shared)
      do n = 1, shared%nodes
        k = shared%point(3, n)
        if (k < model%ranks%partition%own(1) .or. k > model%ranks%partition%own(2)) cycle
        number(k) = number(k) + &
                    count(shared%meets(shared%link_start(n):shared%link_start(n + 1) - 1))
      end do
    end associate
  end subroutine count_meetings

  !> Gives particles and grid sums to the owners that new cuts make.
  subroutine move(model, new)
    type(model_t), intent(inout) :: model
    type(partition_t), intent(in) :: new
    type(workspace_t) :: none
    type(buffer_t), allocatable :: sums(:)
    integer(i8) :: moved
    integer :: b, f, columns(2)
    logical :: complete
    allocate (sums(size(model%fields)))
    do f = 1, size(model%fields)
      call trade_sums(model, new, f, sums(f))
    end do
    moved = 0_i8
    do b = 1, size(model%bodies)
      call ranks_hold(new, model%bodies(b)%particles)
      call trade_particles(new, model%bodies(b)%particles, moved)
    end do
    model%ranks%balance%moved = model%ranks%balance%moved + parallel_sum(moved)
    call memory_share(model%contact%memory, model%contact%shared, model%ranks%partition%own)
    model%ranks%partition = new
    call ranks_renew_bins(model%ranks, model%bodies)
    call phase_layout(model%mesh, model%fields, model%bodies, model%contact, model%team, &
                      model%ranks%partition)
    do f = 1, size(model%fields)
      columns = columns_alive(model, f)
      call halo_clear(model%fields(f), 1, model%fields(f)%planes, [1, &
                      model%fields(f)%columns%total])
      call halo_get_planes(model%fields(f), columns, none, sums(f), complete)
      if (complete .or. allocated(model%findings%failure)) cycle
      call error_make(model%findings%failure, exit_numerical, 'grid sums got lost between ranks', &
                      'this is a fault of the program: report it')
    end do
  end subroutine move

  !> Columns of the moments that the next step reads: where it begins with a stress update, the
  !! stresses are those of the last one, for bins that particles have left. The first moments of the
  !! mass, and what lies behind walls that act, are the last columns and bring the stresses along.
  !! The sums by which debris collides are formed anew before they are read.
  pure function columns_alive(model, f) result(columns)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    integer :: columns(2)
    columns = [1, model%fields(f)%columns%total]
    if (model%fields(f)%columns%debris > 0) columns(2) = model%fields(f)%columns%debris - 1
    if (any(model%method%update == [update_usf, update_usavg]) .and. &
        .not. stage_brings_stress(model)) then
      columns(2) = model%fields(f)%columns%first(stage_stress) - 1
    end if
  end function columns_alive

  !> Sends the sums of the own planes to all ranks that will hold them, own or beside their own.
  subroutine trade_sums(model, new, f, received)
    type(model_t), intent(in) :: model
    type(partition_t), intent(in) :: new
    integer, intent(in) :: f
    type(buffer_t), intent(out) :: received
    type(buffer_t) :: all
    integer :: counts(new%ranks), r, p, p1, p2, before
    call halo_own_planes(model%fields(f), model%ranks%partition, p1, p2)
    do r = 1, new%ranks
      before = all%n
      do p = p1, p2
        associate (k => model%fields(f)%plane_k(p))
          if (k < new%cuts(r) - new%moments(1)) cycle
          if (k > new%cuts(r + 1) - 1 + new%moments(2)) cycle
        end associate
        call halo_put_moments(model%fields(f), p, columns_alive(model, f), all)
      end do
      counts(r) = all%n - before
    end do
    if (.not. allocated(all%values)) allocate (all%values(1))
    call parallel_trade(all%values(:all%n), counts, received%values)
    received%n = size(received%values)
  end subroutine trade_sums

  !> Sends the particles outside the planes that are theirs now, and takes those that come.
  subroutine trade_particles(new, particles, moved)
    type(partition_t), intent(in) :: new
    type(particles_t), intent(inout) :: particles  !! holds the new range already
    integer(i8), intent(inout) :: moved
    type(movers_t) :: movers(1)
    type(arrivals_t) :: arrivals(1)
    real(dp), allocatable :: columns(:, :), received(:, :)
    integer, allocatable :: destination(:)
    logical :: new_bins
    integer :: m, n
    n = particles%motion_columns + particles%state_columns
    call movers_reset(movers(1), n, 0)
    call take_leaving(new, particles, movers(1), destination)
    allocate (columns(1 + n, movers(1)%n))
    do m = 1, movers(1)%n
      columns(:, m) = [real(movers(1)%id(m), dp), movers(1)%particle(:, m)]
    end do
    moved = moved + movers(1)%n
    call parallel_deal(columns, destination, received)
    do m = 1, size(received, 2)
      call movers_add(movers(1), nint(received(1, m), i4), .false., 1)
      movers(1)%particle(:, movers(1)%n) = received(2:, m)
    end do
    if (movers(1)%n == 0) return
    call particles_rebin(particles, movers, spread(-huge(1.0_dp), 1, 3), &
                         spread(huge(1.0_dp), 1, 3), arrivals, new_bins)
  end subroutine trade_particles

  !> Takes the particles in planes of others out of their bins.
  subroutine take_leaving(new, particles, movers, destination)
    type(partition_t), intent(in) :: new
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(inout) :: movers
    integer, allocatable, intent(out) :: destination(:)
    integer :: s, i, number, chunk, left, l, owner
    allocate (destination(particles%count))
    do s = 1, particles%bins%n
      owner = partition_owner(new, key_k(particles%bins%key(s)))
      if (owner == new%rank) cycle
      do i = particles%bins%first(s), particles%bins%last(s)
        number = particles%bin_start(s) + i
        chunk = particles%first(number)
        left = particles%size(number)
        do while (left > 0)
          do l = 1, min(left, lanes)
            call movers_add(movers, particles%id(l, chunk), .true., s)
            particles%id(l, chunk) = 0
            movers%particle(:particles%motion_columns, movers%n) = particles%motion(l, :, chunk)
            movers%particle(particles%motion_columns + 1:, movers%n) = particles%state(l, :, chunk)
            destination(movers%n) = owner
          end do
          left = left - lanes
          chunk = particles%next(chunk)
        end do
        call bin_close(particles, number, movers)
      end do
    end do
    destination = destination(:movers%n)
  end subroutine take_leaving

end module sgmp_balancing
