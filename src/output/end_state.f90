!> What the particles look like at the end of a run, as far as it tells a sound result from one that
!! is not: extremes, particles apart from their bodies, volumes without room.
module sgmp_end_state
  use sgmp_body, only: body_density, body_t
  use sgmp_constitutive, only: law_bends, law_gaseous, law_liquid, law_tears, &
                               material_crushable_foam
  use sgmp_debris, only: debris_possible
  use sgmp_failure, only: failure_none
  use sgmp_filling, only: filling_measure
  use sgmp_kernels, only: kernel_mpm
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_mesh, only: mesh_occupied, mesh_t
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass
  use sgmp_parallel, only: parallel_gather, parallel_max, parallel_min, parallel_sum
  use sgmp_particle_fields, only: particle_field_find, particle_field_t, particle_field_values, &
                                  particle_place_t
  use sgmp_particles, only: first_cell, particles_seat, particles_t
  use sgmp_pieces, only: pieces_find
  use sgmp_rows, only: key_j, key_k, row_key, rows_contains, rows_t
  use sgmp_scene, only: body_card_t, layout_file, scene_t
  use sgmp_shapes, only: combine_union
  use sgmp_shared_nodes, only: shared_nodes_t
  use sgmp_surface_exposure, only: filled_around
  implicit none
  private
  public :: end_state_t, end_state_take

  !> Of the particles of bodies that are not rigid.
  type :: end_state_t
    integer(i8) :: particles = 0_i8
    real(dp) :: compression = 1.0_dp         !! largest density over the initial one
    real(dp) :: condensed = 1.0_dp           !! the same, of bodies that are no gas
    real(dp) :: expansion = 1.0_dp           !! largest volume over the initial one
    real(dp) :: per_cell = huge(1.0_dp)      !! least particles per cell: a cell over the largest
    integer(i8) :: stretched = 0_i8          !! particles larger than a cell, but for debris
    integer(i8) :: thinned = 0_i8            !! of them, those of gases
    real(dp) :: crushed = 1.0_dp             !! largest density over the initial one, of foams
    real(dp) :: pressure(2) = 0.0_dp         !! least and largest
    real(dp) :: room = 0.0_dp  !! sum of volumes over the box between walls; 0: not closed
    real(dp) :: reached = 0.0_dp             !! part of that box that particles give volume to
    logical :: gas = .false.                 !! some body bears no tension
    real(dp) :: excess = 0.0_dp              !! part of the volume that has no room
    integer(i8) :: separated = 0_i8          !! particles out of reach of their body's main piece
    real(dp) :: separated_part = 0.0_dp      !! largest part of any body
    integer :: separated_body = 0
    integer(i8) :: inside = 0_i8             !! particles deep inside a body that theirs touches
    real(dp) :: inside_part = 0.0_dp         !! largest part of any body
    integer :: inside_bodies(2) = 0          !! whose, and in which
    real(dp) :: gaps = 0.0_dp
    !! largest number of gaps of one cell along an axis over the cells with particles, of any body
    integer :: gaps_body = 0
  end type end_state_t

contains

  !> Looks at the particles of all ranks; all must call it.
  subroutine end_state_take(scene, model, state)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(end_state_t), intent(out) :: state
    integer :: b
    state%pressure = [huge(1.0_dp), -huge(1.0_dp)]
    do b = 1, size(model%bodies)
      if (model%bodies(b)%rigid) cycle
      state%gas = state%gas .or. law_gaseous(model%bodies(b)%law)
      state%particles = state%particles + model%totals%particles(b)
      call look_at_body(model%bodies(b), model%mesh, state)
      if (model%bodies(b)%twin_of > 0 .or. model%bodies(b)%family > 0) cycle  ! parts of one
      if (holds_together(model%bodies(b), model%totals%bodies(b)%loose)) then
        call find_separated(scene%bodies(b), model, b, state)
      end if
    end do
    call find_inside(model, state)
    state%compression = parallel_max(state%compression)
    state%condensed = parallel_max(state%condensed)
    state%expansion = parallel_max(state%expansion)
    state%per_cell = parallel_min(state%per_cell)
    state%stretched = parallel_sum(state%stretched)
    state%thinned = parallel_sum(state%thinned)
    state%crushed = parallel_max(state%crushed)
    state%pressure = [parallel_min(state%pressure(1)), parallel_max(state%pressure(2))]
    if (state%particles == 0_i8) state%pressure = 0.0_dp
    call filling_measure(model, state%room, state%excess, state%reached)
    if (any(model%bodies%rigid)) state%reached = 0.0_dp  ! which take some of the room
  end subroutine end_state_take

  !> Extremes of this rank's particles of a body.
  subroutine look_at_body(body, mesh, state)
    type(body_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    type(end_state_t), intent(inout) :: state
    type(particle_field_t) :: field
    type(end_state_t) :: own                     ! of a thread
    integer :: c
    field = particle_field_find('pressure')
    !$omp parallel default(none) shared(body, mesh, state, field) private(own)
    own = end_state_t(pressure=[huge(1.0_dp), -huge(1.0_dp)])
    !$omp do schedule(static)
    do c = 1, body%particles%chunks
      call look_at_chunk(body, mesh, field, c, own)
    end do
    !$omp end do nowait
    !$omp critical (end_states)
    state%compression = max(state%compression, own%compression)
    state%condensed = max(state%condensed, own%condensed)
    state%expansion = max(state%expansion, own%expansion)
    state%per_cell = min(state%per_cell, own%per_cell)
    state%stretched = state%stretched + own%stretched
    state%thinned = state%thinned + own%thinned
    state%crushed = max(state%crushed, own%crushed)
    state%pressure = [min(state%pressure(1), own%pressure(1)), &
                      max(state%pressure(2), own%pressure(2))]
    !$omp end critical (end_states)
    !$omp end parallel
  end subroutine look_at_body

  !> Extremes of the particles of a chunk.
  subroutine look_at_chunk(body, mesh, field, c, state)
    type(body_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    type(particle_field_t), intent(in) :: field  !! the pressure
    integer, intent(in) :: c
    type(end_state_t), intent(inout) :: state
    real(dp) :: volume, ratio, pressure, cells
    integer :: l, nd
    nd = mesh%ndim
    do l = 1, lanes
      if (body%particles%id(l, c) == 0) cycle
      volume = body%particles%state(l, body%law%slots%volume, c)
      ratio = volume*body%law%density/body%particles%motion(l, motion_mass(nd), c)
      pressure = sum(particle_field_values(field, body, particle_place_t(nd, l, c)))
      state%compression = max(state%compression, 1.0_dp/ratio)
      if (.not. law_gaseous(body%law)) state%condensed = max(state%condensed, 1.0_dp/ratio)
      state%expansion = max(state%expansion, ratio)
      cells = mesh_occupied(mesh, body%particles%motion(l, :nd, c), volume)
      state%per_cell = min(state%per_cell, 1.0_dp/cells)
      if (cells > 1.0_dp .and. leaves_gaps(body, l, c, pressure)) then
        state%stretched = state%stretched + 1
        if (law_gaseous(body%law)) state%thinned = state%thinned + 1
      end if
      if (body%law%kind == material_crushable_foam) then
        state%crushed = max(state%crushed, 1.0_dp/ratio)
      end if
      state%pressure = [min(state%pressure(1), pressure), max(state%pressure(2), pressure)]
    end do
  end subroutine look_at_chunk

  !> Whether a particle that has grown larger than a cell has left its neighbours: not where it sees
  !! the grid from its first place, nor where nothing is to hold it.
  pure function leaves_gaps(body, l, c, pressure) result(yes)
    type(body_t), intent(in) :: body
    integer, intent(in) :: l, c
    real(dp), intent(in) :: pressure
    logical :: yes
    yes = body%law%slots%reference == 0 .and. &
          .not. (is_debris(body, l, c) .or. is_spray(body, pressure))
  end function leaves_gaps

  !> Whether a particle has failed and bears no stress, as long as it is larger than at the start:
  !! gaps around it change nothing.
  pure function is_debris(body, l, c) result(yes)
    type(body_t), intent(in) :: body
    integer, intent(in) :: l, c
    logical :: yes
    yes = debris_possible(body%law)
    if (yes) yes = body%particles%state(l, body%law%slots%damage, c) >= 1.0_dp
  end function is_debris

  !> Whether a liquid has been pulled apart as far as it bears: it has no more to say.
  pure function is_spray(body, pressure) result(yes)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: pressure
    logical :: yes
    yes = law_liquid(body%law) .and. body%law%failure%tension < failure_none
    if (yes) yes = pressure <= -body%law%failure%tension
  end function is_spray

  !> Whether a body is meant to stay in one piece: it is no fluid and no soil, and its material has
  !! no damage, or one only where it is torn, and was not.
  pure function holds_together(body, loose) result(yes)
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: loose                !! particles that have failed and are open
    logical :: yes
    associate (law => body%law)
      yes = law_bends(law) .and. ((law_tears(law) .and. .not. loose > 0.0_dp) .or. &
                                  .not. (law%fails .or. law%history%damage .or. law%erosion%given))
    end associate
  end function holds_together

  !> Counts the particles of a body out of reach of its largest pieces, of which it may have as
  !! many as its card unites shapes: particles hold together as long as they share grid points.
  subroutine find_separated(card, model, b, state)
    type(body_card_t), intent(in) :: card
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    type(end_state_t), intent(inout) :: state
    integer(i8), allocatable :: key(:), number(:)
    integer, allocatable :: first(:), last(:), piece(:)
    integer(i8) :: apart
    integer :: reach, n, p
    if (card%layout == layout_file) return  ! any number of pieces
    call gather_intervals(model%bodies(b), key, first, last, number)
    if (gaps(key, first, last) > state%gaps) then
      state%gaps = gaps(key, first, last)
      state%gaps_body = b
    end if
    allocate (piece(size(key)))
    reach = merge(1, 2, model%fields(model%bodies(b)%field)%kernel == kernel_mpm)
    call pieces_find(key, first, last, [reach, reach, reach], piece)
    do n = 1, size(piece)
      if (piece(n) == n) cycle
      number(piece(n)) = number(piece(n)) + number(n)
      number(n) = 0
    end do
    apart = sum(number)
    do p = 1, count(card%shapes%combine == combine_union)
      if (size(number) == 0) exit
      n = maxloc(number, 1)
      apart = apart - number(n)
      number(n) = 0
    end do
    state%separated = state%separated + apart
    if (real(apart, dp) > state%separated_part*real(max(1_i8, model%totals%particles(b)), dp)) then
      state%separated_part = real(apart, dp)/real(model%totals%particles(b), dp)
      state%separated_body = b
    end if
  end subroutine find_separated

  !> Counts the particles that have got into a body that contact should have kept them out of.
  subroutine find_inside(model, state)
    type(model_t), intent(in) :: model
    type(end_state_t), intent(inout) :: state
    integer(i8) :: inside
    integer :: p, side
    do p = 1, size(model%contact%pairs)
      if (any(model%bodies(model%contact%pairs(p)%body)%twin_of > 0)) cycle
      do side = 1, 2
        associate (bodies => cshift(model%contact%pairs(p)%body, side - 1))
          if (model%bodies(bodies(1))%rigid) cycle
          ! How much of it fills a place does not show in a gas, which is denser here than there;
          ! its own particles in the other body do.
          if (law_gaseous(model%bodies(bodies(2))%law)) cycle
          inside = 0_i8
          if (meet_here(model%contact%shared, p)) then
            inside = count_inside(model, bodies(1), bodies(2))
          end if
          inside = parallel_sum(inside)
          state%inside = state%inside + inside
          if (real(inside, dp) <= state%inside_part*model%totals%particles(bodies(1))) cycle
          state%inside_part = real(inside, dp)/real(model%totals%particles(bodies(1)), dp)
          state%inside_bodies = bodies
        end associate
      end do
    end do
  end subroutine find_inside

  !> Whether the fields of a pair share a node of this rank: those of most pairs do not.
  pure function meet_here(shared, pair) result(yes)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: pair
    logical :: yes
    yes = shared%links > 0
    if (yes) yes = any(shared%pair == pair)
  end function meet_here

  !> Particles of a body here around which another body fills the space.
  pure function count_inside(model, own, other) result(inside)
    type(model_t), intent(in) :: model
    integer, intent(in) :: own, other
    integer(i8) :: inside
    real(dp), parameter :: full = 0.9_dp         !! 0.34 where bodies touch, 0.96 a cell below
    integer :: c, l
    inside = 0_i8
    associate (particles => model%bodies(own)%particles, body => model%bodies(other))
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          if (filled_around(model%fields(body%field), model%mesh, &
                            particles%motion(l, :model%mesh%ndim, c), &
                            body_density(body)) >= full) inside = inside + 1_i8
        end do
      end do
    end associate
  end function count_inside

  !> Cells without particles between two that have some, along the axis with most of them, over the
  !! cells with particles.
  pure real(dp) function gaps(key, first, last) result(part)
    integer(i8), intent(in) :: key(:)            !! rows of intervals of occupied cells
    integer, intent(in) :: first(:), last(:)
    type(rows_t) :: rows
    integer :: s, i, axis, found(3), total
    rows = rows_t(size(key), key, first, last)
    found = 0
    total = 0
    do s = 1, rows%n
      total = total + last(s) - first(s) + 1
      do i = first(s), last(s)
        do axis = 1, 3
          if (beside(axis, 1) == 0 .and. beside(axis, 2) > 0) found(axis) = found(axis) + 1
        end do
      end do
    end do
    part = real(maxval(found), dp)/max(1, total)

  contains

    !> Interval that holds the cell so many behind cell i of row s along an axis; 0: none.
    pure integer function beside(axis, step) result(interval)
      integer, intent(in) :: axis, step
      associate (along => merge(step, 0, [1, 2, 3] == axis))
        interval = rows_contains(rows, row_key(key_j(key(s)) + along(2), &
                                               key_k(key(s)) + along(3)), i + along(1))
      end associate
    end function beside

  end function gaps

  !> Occupied cells of a body on all ranks, as intervals of rows with their particles.
  subroutine gather_intervals(body, key, first, last, number)
    type(body_t), intent(in) :: body
    integer(i8), allocatable, intent(out) :: key(:), number(:)
    integer, allocatable, intent(out) :: first(:), last(:)
    real(dp), allocatable :: own(:), all(:), table(:, :)
    integer :: inside(0:body%particles%span - 1)
    integer :: s, i, c, n, cell, before
    allocate (own(5*size(body%particles%size)*body%particles%span))
    n = 0
    do s = 1, body%particles%bins%n
      before = -huge(1)
      do i = body%particles%bins%first(s), body%particles%bins%last(s)
        call count_by_cell(body%particles, body%particles%bin_start(s) + i, &
                           first_cell(body%particles%span, i), inside)
        do c = 0, ubound(inside, 1)
          if (inside(c) == 0) cycle
          cell = first_cell(body%particles%span, i) + c
          if (cell /= before + 1) then
            n = n + 1
            own(5*n - 4:5*n) = real([key_j(body%particles%bins%key(s)), &
                                     key_k(body%particles%bins%key(s)), cell, cell, 0], dp)
          end if
          own(5*n - 1) = real(cell, dp)
          own(5*n) = own(5*n) + inside(c)
          before = cell
        end do
      end do
    end do
    call parallel_gather(own(:5*n), all)  ! ranks own ascending planes
    table = reshape(all, [5, size(all)/5])
    key = row_key(nint(table(1, :)), nint(table(2, :)))
    first = nint(table(3, :))
    last = nint(table(4, :))
    number = nint(table(5, :), i8)
  end subroutine gather_intervals

  !> Particles in each cell of a bin.
  pure subroutine count_by_cell(particles, bin, first, inside)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin, first            !! bin, and its first cell
    integer, intent(out) :: inside(0:)
    integer :: chunk, left, l, c
    real(dp) :: seat(particles%ndim)
    inside = 0
    chunk = particles%first(bin)
    left = particles%size(bin)
    do while (left > 0)
      do l = 1, min(left, lanes)
        seat = particles_seat(particles, l, chunk)
        c = floor(seat(1) - particles%shift) - first
        inside(c) = inside(c) + 1
      end do
      left = left - lanes
      chunk = particles%next(chunk)
    end do
  end subroutine count_by_cell

end module sgmp_end_state
