!> Gauges: histories of single particles, or of means over the particles within a radius, in
!! gauges.csv.
!!
!! A mean weighs positions and velocities by mass, everything else by volume; its density is mass
!! over volume. Its particles are those that are within the radius at the start, or at the time
!! (`fixed`). They are added up in the order of their ids, so that the sums have the same bits on
!! any number of threads and ranks.
!!
!! A row costs what its gauges look at: the place of a gauge's particle is remembered and looked for
!! anew only when another particle is there.
module sgmp_gauges
  use sgmp_body, only: body_given_id
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_history, only: column_length, gauges_columns, gauges_integers, history_t
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_rank, parallel_sum
  use sgmp_particle_fields, only: particle_field_components, particle_field_find
  use sgmp_scene, only: gauge_card_t, name_length
  use sgmp_snapshot, only: snapshot_t
  use sgmp_snapshot_make, only: snapshot_gather, snapshot_position, snapshot_some, snapshot_whole
  use sgmp_sorting, only: sort_order
  use sgmp_space, only: axes_in_output
  use sgmp_spelling, only: word_position
  use sgmp_text, only: integer_text
  use sgmp_voigt, only: stress_components
  implicit none
  private
  public :: gauges_t, gauges_start, gauges_open, gauges_find, gauges_from_start, gauges_write

  !> All gauges of a scene and their file.
  type :: gauges_t
    type(history_t) :: file
    type(gauge_card_t), allocatable :: cards(:)
    character(name_length), allocatable :: fields(:)  !! recorded besides position and velocity
    integer, allocatable :: ids(:)       !! of the particle nearest to each at the start
    integer, allocatable :: kept(:, :)
      !! (3, gauges) body, lane and chunk where that particle was last, 0: not on this rank
  end type gauges_t

contains

  !> Which gauges there are, and what they record.
  pure subroutine gauges_start(gauges, cards)
    type(gauges_t), intent(inout) :: gauges
    type(gauge_card_t), intent(in) :: cards(:)
    integer :: f, g
    gauges%cards = cards
    gauges%fields = [character(name_length) :: 'pressure', 'von_mises', 'density']
    do g = 1, size(cards)
      if (.not. allocated(cards(g)%fields)) cycle
      do f = 1, size(cards(g)%fields)
        if (word_position(cards(g)%fields(f), gauges%fields) > 0) cycle
        gauges%fields = [character(name_length) :: gauges%fields, cards(g)%fields(f)]
      end do
    end do
  end subroutine gauges_start

  !> Whether some gauge needs the initial positions of particles.
  pure logical function gauges_from_start(gauges) result(yes)
    type(gauges_t), intent(in) :: gauges
    yes = any(gauges%cards%radius > 0.0_dp .and. .not. gauges%cards%fixed)
  end function gauges_from_start

  !> Opens the file, on the first rank.
  subroutine gauges_open(gauges, model, path, error, keep_to_step)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: keep_to_step  !! of a run that is continued
    character(column_length), allocatable :: columns(:), whole(:)
    integer :: f
    if (size(gauges%cards) == 0) return
    columns = gauges_columns
    whole = gauges_integers
    do f = 1, size(gauges%fields)
      columns = [character(column_length) :: columns, &
                 particle_field_components(particle_field_find(gauges%fields(f)), &
                                           model%mesh%space, stresses(model))]
    end do
    if (any(gauges%cards%radius > 0.0_dp)) then
      columns = [character(column_length) :: columns, 'particles']
      whole = [character(column_length) :: whole, 'particles']
    end if
    call gauges%file%open(path, columns, error, whole, keep_to_step, 'name')
  end subroutine gauges_open

  !> Components of the stress in the output.
  pure function stresses(model) result(n)
    type(model_t), intent(in) :: model
    integer :: n
    n = stress_components(merge(3, model%mesh%ndim, model%method%swirl))
  end function stresses

  !> The particle nearest to each gauge at the start; a gauge that follows its particles has some.
  subroutine gauges_find(gauges, model, initial, error)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(in) :: initial(:, :)  !! positions by id, where needed
    type(error_t), allocatable, intent(out) :: error
    type(snapshot_t) :: snapshot
    character(name_length) :: none(0)
    integer :: g
    allocate (gauges%ids(size(gauges%cards)))
    gauges%ids = 0
    if (size(gauges%cards) == 0) return
    call snapshot_whole(model, none, initial, snapshot)
    if (parallel_rank() == 0) then
      do g = 1, size(gauges%cards)
        associate (card => gauges%cards(g))
          gauges%ids(g) = snapshot%id(minloc(distance2(snapshot%position, centre(card, model), &
                                                       snapshot%dimension), 1))
          if (card%radius <= 0.0_dp .or. card%fixed) cycle
          if (any(distance2(snapshot%position, centre(card, model), snapshot%dimension) <= &
                  card%radius**2)) cycle
          call error_make(error, exit_deck, "no particle is within the radius of gauge '"// &
                          trim(card%name)//"' at the start", 'move its point, make the radius '// &
                          'larger, or make it frame=fixed')
        end associate
      end do
    end if
    call parallel_agree(error)
    gauges%ids = int(parallel_sum(int(gauges%ids, i8)))
  end subroutine gauges_find

  !> Point of a gauge in the order of axes of the output.
  pure function centre(card, model) result(point)
    type(gauge_card_t), intent(in) :: card
    type(model_t), intent(in) :: model
    real(dp) :: point(3)
    point = card%point(axes_in_output(:, model%mesh%space))
  end function centre

  pure function distance2(position, point, ndim) result(d)
    real(dp), intent(in) :: position(:, :), point(3)
    integer, intent(in) :: ndim
    real(dp) :: d(size(position, 2))
    integer :: p
    do p = 1, size(d)
      d(p) = sum((position(:ndim, p) - point(:ndim))**2)
    end do
  end function distance2

  !> One row per gauge; none for a gauge without particles.
  subroutine gauges_write(gauges, model, initial, error)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(in) :: initial(:, :)  !! positions by id, where needed
    type(error_t), allocatable, intent(out) :: error
    type(snapshot_t) :: snapshot
    character(name_length), allocatable :: names(:)
    integer, allocatable :: looked_at(:, :), members(:)
    integer :: g, p
    if (size(gauges%cards) == 0) return
    names = gauges%fields
    if (any(gauges%cards%radius > 0.0_dp)) then
      names = [character(name_length) :: names, 'mass', 'volume']
    end if
    if (gauges_from_start(gauges)) names = [character(name_length) :: names, 'initial_position']
    if (any(gauges%cards%radius > 0.0_dp) .or. any(model%bodies%particles%path > 0)) then
      call look_at_all(gauges, model, initial, looked_at)
    else
      call look_again(gauges, model, looked_at)
    end if
    call snapshot_some(model, names, initial, looked_at, snapshot)
    if (model%ranks%partition%ranks > 1) then
      call snapshot_gather(snapshot, [(.true., p=1, size(snapshot%id))])
    end if
    do g = 1, merge(size(gauges%cards), 0, parallel_rank() == 0)
      call find_members(gauges, g, model, snapshot, members)
      if (size(members) > 0) call write_row(gauges, g, model, snapshot, members, error)
      if (allocated(error)) exit
    end do
    call parallel_agree(error)
  end subroutine gauges_write

  !> The particles of gauges without a radius, where nothing is split: where they were, or where
  !! they are found.
  subroutine look_again(gauges, model, looked_at)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    integer, allocatable, intent(out) :: looked_at(:, :)  !! (3, n) body, lane, chunk
    integer :: g, n
    if (.not. allocated(gauges%kept)) allocate (gauges%kept(3, size(gauges%ids)), source=0)
    do g = 1, size(gauges%ids)
      if (id_at(model, gauges%kept(:, g)) /= gauges%ids(g)) gauges%kept(:, g) = 0
    end do
    if (any(gauges%kept(1, :) == 0)) call search(gauges, model)
    n = count(gauges%kept(1, :) > 0)
    allocate (looked_at(3, n))
    n = 0
    do g = 1, size(gauges%ids)
      if (gauges%kept(1, g) == 0) cycle
      n = n + 1
      looked_at(:, n) = gauges%kept(:, g)
    end do
  end subroutine look_again

  !> Id of the particle at a place, 0 where there is none.
  pure integer function id_at(model, place) result(id)
    type(model_t), intent(in) :: model
    integer, intent(in) :: place(3)  !! body, lane, chunk; 0: no place
    id = 0
    if (place(1) == 0) return
    associate (particles => model%bodies(place(1))%particles)
      if (place(3) <= particles%chunks) id = particles%id(place(2), place(3))
    end associate
  end function id_at

  !> Looks for the particles whose place is not known, in one pass over all ids.
  subroutine search(gauges, model)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    integer, allocatable :: sorted(:), gauge(:)
    integer :: b, c, l, id, k
    gauge = pack([(k, k=1, size(gauges%ids))], gauges%kept(1, :) == 0)
    gauge = gauge(order_of(gauges%ids(gauge)))
    sorted = gauges%ids(gauge)
    do b = 1, size(model%bodies)
      associate (particles => model%bodies(b)%particles)
        do c = 1, particles%chunks
          do l = 1, lanes
            id = particles%id(l, c)
            if (id < sorted(1) .or. id > sorted(size(sorted))) cycle
            k = first_of(sorted, id)
            do while (k <= size(sorted))
              if (sorted(k) /= id) exit
              gauges%kept(:, gauge(k)) = [b, l, c]
              k = k + 1
            end do
          end do
        end do
      end associate
    end do
  end subroutine search

  !> Order of ids, ascending.
  pure function order_of(ids) result(order)
    integer, intent(in) :: ids(:)
    integer :: order(size(ids))
    call sort_order(int(ids, i8), order)
  end function order_of

  !> Place of the first of some ascending numbers that is not below a value; size + 1: none.
  pure integer function first_of(sorted, value) result(first)
    integer, intent(in) :: sorted(:), value
    integer :: last, middle
    first = 1
    last = size(sorted) + 1
    do while (first < last)
      middle = first + (last - first)/2
      if (sorted(middle) < value) then
        first = middle + 1
      else
        last = middle
      end if
    end do
  end function first_of

  !> All particles that some gauge looks at, by one pass over all.
  subroutine look_at_all(gauges, model, initial, looked_at)
    type(gauges_t), intent(in) :: gauges
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(in) :: initial(:, :)
    integer, allocatable, intent(out) :: looked_at(:, :)  !! (3, n) body, lane, chunk
    integer, allocatable :: sorted(:), longer(:, :)
    integer :: b, c, l, n
    sorted = pack(gauges%ids, gauges%cards%radius <= 0.0_dp)
    sorted = sorted(order_of(sorted))
    allocate (looked_at(3, 64))
    n = 0
    do b = 1, size(model%bodies)
      do c = 1, model%bodies(b)%particles%chunks
        do l = 1, lanes
          if (model%bodies(b)%particles%id(l, c) == 0) cycle
          if (.not. seen(gauges, model, initial, sorted, [b, l, c])) cycle
          if (n == size(looked_at, 2)) then
            allocate (longer(3, 2*n))
            longer(:, :n) = looked_at
            call move_alloc(longer, looked_at)
          end if
          n = n + 1
          looked_at(:, n) = [b, l, c]
        end do
      end do
    end do
    looked_at = looked_at(:, :n)
  end subroutine look_at_all

  !> Whether some gauge looks at a particle.
  pure logical function seen(gauges, model, initial, sorted, place) result(yes)
    type(gauges_t), intent(in) :: gauges
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(in) :: initial(:, :)
    integer, intent(in) :: sorted(:)   !! ids of the gauges without a radius
    integer, intent(in) :: place(3)    !! body, lane, chunk
    real(dp), parameter :: round_off = 1.0e-12_dp  !! find_members decides
    real(dp) :: x(3), at_start(3)
    integer :: g, id, k, nd
    id = id_at(model, place)
    k = first_of(sorted, id)
    yes = .false.
    if (k <= size(sorted)) yes = sorted(k) == id
    if (yes .or. .not. any(gauges%cards%radius > 0.0_dp)) return
    nd = maxval(axes_in_output(:model%mesh%ndim, model%mesh%space))
    x = snapshot_position(model, place)
    at_start = x
    if (allocated(initial)) at_start = initial(:, id)
    do g = 1, size(gauges%cards)
      associate (card => gauges%cards(g))
        if (card%radius <= 0.0_dp) cycle
        yes = sum((merge(x(:nd), at_start(:nd), card%fixed) - leading(centre(card, model), nd))**2) &
              <= (1.0_dp + round_off)*card%radius**2
      end associate
      if (yes) return
    end do
  end function seen

  !> The first components of a vector.
  pure function leading(x, n) result(first)
    real(dp), intent(in) :: x(3)
    integer, intent(in) :: n
    real(dp) :: first(n)
    first = x(:n)
  end function leading

  !> The particles of a snapshot that belong to a gauge.
  pure subroutine find_members(gauges, g, model, snapshot, members)
    type(gauges_t), intent(in) :: gauges
    integer, intent(in) :: g
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer, allocatable, intent(out) :: members(:)  !! ascending
    integer :: p
    associate (card => gauges%cards(g))
      if (card%radius <= 0.0_dp) then
        p = first_of(snapshot%id, gauges%ids(g))  ! the first of those that it was split into
        members = [integer ::]
        if (p > size(snapshot%id)) return
        if (snapshot%id(p) == gauges%ids(g)) members = [p]
      else if (card%fixed) then
        members = within(snapshot%position, centre(card, model), snapshot%dimension, card%radius)
      else
        members = within(snapshot%initial_position, centre(card, model), snapshot%dimension, &
                         card%radius)
      end if
    end associate
  end subroutine find_members

  !> Positions that are not further from a point than a radius.
  pure function within(position, point, ndim, radius) result(members)
    real(dp), intent(in) :: position(:, :), point(3), radius
    integer, intent(in) :: ndim
    integer, allocatable :: members(:)
    integer :: p
    members = pack([(p, p=1, size(position, 2))], distance2(position, point, ndim) <= radius**2)
  end function within

  !> Row of one gauge.
  subroutine write_row(gauges, g, model, snapshot, members, error)
    type(gauges_t), intent(inout) :: gauges
    integer, intent(in) :: g
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: members(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: values(:)
    integer :: f, p, particle
    if (gauges%cards(g)%radius > 0.0_dp) then
      particle = 0
      call means(gauges, snapshot, members, values)
    else
      p = members(1)
      particle = body_given_id(model%bodies(snapshot%body(p)), snapshot%id(p))
      values = [snapshot%position(:, p), snapshot%velocity(:, p), &
                (snapshot%fields(f)%values(:, p), f=1, size(gauges%fields))]
    end if
    if (any(gauges%cards%radius > 0.0_dp)) values = [values, real(size(members), dp)]
    call gauges%file%write_row(model%clock%step, [model%clock%time, real(g, dp), &
                                                  real(particle, dp), values], error, &
                               trim(gauges%cards(g)%name))
  end subroutine write_row

  !> Means over the members: position, velocity, fields.
  pure subroutine means(gauges, snapshot, members, values)
    type(gauges_t), intent(in) :: gauges
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: members(:)
    real(dp), allocatable, intent(out) :: values(:)
    real(dp) :: motion(2*3), total_mass, total_volume
    integer :: f, m, n, p
    motion = 0.0_dp
    n = size(gauges%fields)
    associate (mass => snapshot%fields(n + 1)%values(1, :), &
               volume => snapshot%fields(n + 2)%values(1, :))
      total_mass = 0.0_dp
      total_volume = 0.0_dp
      do m = 1, size(members)
        p = members(m)
        total_mass = total_mass + mass(p)
        total_volume = total_volume + volume(p)
        motion = motion + mass(p)*[snapshot%position(:, p), snapshot%velocity(:, p)]
      end do
      values = motion/total_mass
      do f = 1, n
        if (gauges%fields(f) == 'density') then
          values = [values, total_mass/total_volume]
        else
          values = [values, mean_of(snapshot%fields(f)%values, volume, members)/total_volume]
        end if
      end do
    end associate
  end subroutine means

  !> Sum of the members' values, each times its volume, in the order of the particles.
  pure function mean_of(values, volume, members) result(total)
    real(dp), intent(in) :: values(:, :), volume(:)
    integer, intent(in) :: members(:)
    real(dp) :: total(size(values, 1))
    integer :: m
    total = 0.0_dp
    do m = 1, size(members)
      total = total + volume(members(m))*values(:, members(m))
    end do
  end function mean_of

end module sgmp_gauges
