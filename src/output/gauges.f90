!> Gauges: histories of single particles, or of means over the particles within a radius, in
!! gauges.csv.
!!
!! A mean weighs positions and velocities by mass, everything else by volume; its density is mass
!! over volume. Its particles are those that are within the radius at the start, or at the time
!! (`fixed`). They are added up in the order of their ids, so that the sums have the same bits on
!! any number of threads and ranks.
!!
!! A row costs what its gauges look at: the place of a gauge's particle is remembered and looked for
!! anew only when another particle is there; spheres are looked up in bins.
module sgmp_gauges
  use sgmp_body, only: body_given_id
  use sgmp_boxes, only: boxes_make, boxes_nearest, boxes_t
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_gauge_means, only: gauge_means
  use sgmp_gauge_spheres, only: gauge_spheres_any, gauge_spheres_holding, gauge_spheres_make, &
                                gauge_spheres_t
  use sgmp_growing, only: grow
  use sgmp_history, only: column_length, gauges_columns, gauges_integers, history_t
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_rank, parallel_sum
  use sgmp_particle_fields, only: particle_field_components, particle_field_find
  use sgmp_scene, only: gauge_card_t, name_length
  use sgmp_snapshot, only: snapshot_t
  use sgmp_snapshot_make, only: snapshot_gather, snapshot_position, snapshot_some, snapshot_whole
  use sgmp_sorting, only: sort_order, sorted_first
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
    type(gauge_spheres_t) :: staying, following
  end type gauges_t

contains

  !> Which gauges there are, and what they record.
  subroutine gauges_start(gauges, cards, model)
    type(gauges_t), intent(inout) :: gauges
    type(gauge_card_t), intent(in) :: cards(:)
    type(model_t), intent(in) :: model
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
    call make_spheres(gauges, model)
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
    allocate (gauges%ids(size(gauges%cards)))
    gauges%ids = 0
    if (size(gauges%cards) == 0) return
    call snapshot_whole(model, none, initial, snapshot)
    if (parallel_rank() == 0) call find_nearest(gauges, model, snapshot, error)
    call parallel_agree(error)
    gauges%ids = int(parallel_sum(int(gauges%ids, i8)))
  end subroutine gauges_find

  !> Puts the spheres of gauges into bins.
  subroutine make_spheres(gauges, model)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    real(dp), allocatable :: centres(:, :)
    integer :: g, nd
    allocate (centres(3, size(gauges%cards)))
    do g = 1, size(gauges%cards)
      centres(:, g) = centre(gauges%cards(g), model)
    end do
    nd = maxval(axes_in_output(:model%mesh%ndim, model%mesh%space))
    associate (cards => gauges%cards)
      call gauge_spheres_make(gauges%staying, cards%radius > 0.0_dp .and. cards%fixed, centres, &
                              cards%radius, nd)
      call gauge_spheres_make(gauges%following, cards%radius > 0.0_dp .and. .not. cards%fixed, &
                              centres, cards%radius, nd)
    end associate
  end subroutine make_spheres

  !> The nearest of all particles of a snapshot to each gauge.
  subroutine find_nearest(gauges, model, snapshot, error)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(out) :: error
    type(boxes_t) :: boxes
    real(dp) :: distance2
    integer :: g, nearest
    call boxes_make(boxes, snapshot%position, snapshot%position)
    do g = 1, size(gauges%cards)
      associate (card => gauges%cards(g))
        call boxes_nearest(boxes, snapshot%position, snapshot%dimension, centre(card, model), &
                           nearest, distance2)
        gauges%ids(g) = snapshot%id(nearest)
        if (card%radius <= 0.0_dp .or. card%fixed) cycle
        if (distance2 <= card%radius**2) cycle
        call error_make(error, exit_deck, "no particle is within the radius of gauge '"// &
                        trim(card%name)//"' at the start", 'move its point, make the radius '// &
                        'larger, or make it frame=fixed')
        return
      end associate
    end do
  end subroutine find_nearest

  !> Point of a gauge in the order of axes of the output.
  pure function centre(card, model) result(point)
    type(gauge_card_t), intent(in) :: card
    type(model_t), intent(in) :: model
    real(dp) :: point(3)
    point = card%point(axes_in_output(:, model%mesh%space))
  end function centre

  !> One row per gauge; none for a gauge without particles.
  subroutine gauges_write(gauges, model, initial, error)
    type(gauges_t), intent(inout) :: gauges
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(in) :: initial(:, :)  !! positions by id, where needed
    type(error_t), allocatable, intent(out) :: error
    type(snapshot_t) :: snapshot
    character(name_length), allocatable :: names(:)
    integer, allocatable :: looked_at(:, :), members(:), first(:)
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
    if (parallel_rank() == 0) then
      call find_members(gauges, snapshot, first, members)
      do g = 1, size(gauges%cards)
        if (first(g + 1) == first(g)) cycle
        call write_row(gauges, g, model, snapshot, members(first(g):first(g + 1) - 1), error)
        if (allocated(error)) exit
      end do
    end if
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
    gauge = gauge(ids_order(gauges%ids(gauge)))
    sorted = gauges%ids(gauge)
    do b = 1, size(model%bodies)
      associate (particles => model%bodies(b)%particles)
        do c = 1, particles%chunks
          do l = 1, lanes
            id = particles%id(l, c)
            if (id < sorted(1) .or. id > sorted(size(sorted))) cycle
            k = sorted_first(sorted, id)
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

  !> The order that puts ids into an ascending one.
  pure function ids_order(ids) result(order)
    integer, intent(in) :: ids(:)
    integer :: order(size(ids))
    call sort_order(int(ids, i8), order)
  end function ids_order

  !> All particles that some gauge looks at, by one pass over all.
  subroutine look_at_all(gauges, model, initial, looked_at)
    type(gauges_t), intent(in) :: gauges
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(in) :: initial(:, :)
    integer, allocatable, intent(out) :: looked_at(:, :)  !! (3, n) body, lane, chunk
    integer, allocatable :: sorted(:), longer(:, :)
    integer :: b, c, l, n
    sorted = pack(gauges%ids, gauges%cards%radius <= 0.0_dp)
    sorted = sorted(ids_order(sorted))
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
    integer :: id, k
    id = id_at(model, place)
    k = sorted_first(sorted, id)
    yes = .false.
    if (k <= size(sorted)) yes = sorted(k) == id
    if (yes) return
    yes = gauge_spheres_any(gauges%staying, snapshot_position(model, place), round_off)
    if (yes .or. .not. allocated(initial)) return
    yes = gauge_spheres_any(gauges%following, initial(:, id), round_off)
  end function seen

  !> The particles of a snapshot that belong to each gauge.
  subroutine find_members(gauges, snapshot, first, members)
    type(gauges_t), intent(in) :: gauges
    type(snapshot_t), intent(in) :: snapshot
    integer, allocatable, intent(out) :: first(:)    !! (gauges + 1) place of a gauge's first
    integer, allocatable, intent(out) :: members(:)  !! gauge by gauge, in each ascending
    integer, allocatable :: owner(:)
    integer :: g, n, p, holding(size(gauges%cards))
    allocate (owner(64), members(64))
    n = 0
    do g = 1, size(gauges%cards)
      if (gauges%cards(g)%radius > 0.0_dp) cycle
      p = sorted_first(snapshot%id, gauges%ids(g))  ! the first of those that it was split into
      if (p > size(snapshot%id)) cycle
      if (snapshot%id(p) == gauges%ids(g)) call append([g], p)
    end do
    do p = 1, size(snapshot%id)
      g = 0
      call gauge_spheres_holding(gauges%staying, snapshot%position(:, p), holding, g)
      if (allocated(snapshot%initial_position)) then
        call gauge_spheres_holding(gauges%following, snapshot%initial_position(:, p), holding, g)
      end if
      call append(holding(:g), p)
    end do
    owner = owner(:n)
    members = members(ids_order(owner))
    allocate (first(size(gauges%cards) + 1), source=0)
    do p = 1, n
      first(owner(p) + 1) = first(owner(p) + 1) + 1
    end do
    first(1) = 1
    do g = 1, size(gauges%cards)
      first(g + 1) = first(g) + first(g + 1)
    end do
  contains
    !> Particle p belongs to some more gauges.
    subroutine append(to, p)
      integer, intent(in) :: to(:), p
      call grow(owner, n, n + size(to))
      call grow(members, n, n + size(to))
      owner(n + 1:n + size(to)) = to
      members(n + 1:n + size(to)) = p
      n = n + size(to)
    end subroutine append
  end subroutine find_members

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
      call gauge_means(gauges%fields, snapshot, members, values)
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

end module sgmp_gauges
