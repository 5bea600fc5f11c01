!> Gauges: histories of single particles, or of means over the particles within a radius, in
!! gauges.csv.
!!
!! A mean weighs positions and velocities by mass, everything else by volume; its density is mass
!! over volume. Its particles are those that are within the radius at the start, or at the time
!! (`fixed`). They are added up in the order of their ids, so that the sums have the same bits on
!! any number of threads and ranks.
module sgmp_gauges
  use sgmp_body, only: body_given_id
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_history, only: column_length, gauges_columns, gauges_integers, history_t
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_rank, parallel_sum
  use sgmp_particle_fields, only: particle_field_components, particle_field_find
  use sgmp_scene, only: gauge_card_t, name_length
  use sgmp_snapshot, only: snapshot_t
  use sgmp_snapshot_make, only: snapshot_gather, snapshot_own, snapshot_whole
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
    logical, allocatable :: member(:, :)
    integer :: g
    if (size(gauges%cards) == 0) return
    names = gauges%fields
    if (any(gauges%cards%radius > 0.0_dp)) then
      names = [character(name_length) :: names, 'mass', 'volume']
    end if
    if (gauges_from_start(gauges)) names = [character(name_length) :: names, 'initial_position']
    call snapshot_own(model, names, initial, snapshot)
    call find_members(gauges, model, snapshot, member)
    if (model%ranks%partition%ranks > 1) then
      call snapshot_gather(snapshot, any(member, 2))
      call find_members(gauges, model, snapshot, member)
    end if
    do g = 1, merge(size(gauges%cards), 0, parallel_rank() == 0)
      if (any(member(:, g))) call write_row(gauges, g, model, snapshot, member(:, g), error)
      if (allocated(error)) exit
    end do
    call parallel_agree(error)
  end subroutine gauges_write

  !> Which particles of a snapshot belong to which gauge.
  pure subroutine find_members(gauges, model, snapshot, member)
    type(gauges_t), intent(in) :: gauges
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    logical, allocatable, intent(out) :: member(:, :)  !! (particles, gauges)
    integer :: g, p
    allocate (member(size(snapshot%id), size(gauges%cards)))
    do g = 1, size(gauges%cards)
      associate (card => gauges%cards(g))
        if (card%radius <= 0.0_dp) then
          member(:, g) = .false.
          p = findloc(snapshot%id, gauges%ids(g), 1)  ! the first of those that it was split into
          if (p > 0) member(p, g) = .true.
        else if (card%fixed) then
          member(:, g) = distance2(snapshot%position, centre(card, model), snapshot%dimension) &
                         <= card%radius**2
        else
          member(:, g) = distance2(snapshot%initial_position, centre(card, model), &
                                   snapshot%dimension) <= card%radius**2
        end if
      end associate
    end do
  end subroutine find_members

  !> Row of one gauge.
  subroutine write_row(gauges, g, model, snapshot, member, error)
    type(gauges_t), intent(inout) :: gauges
    integer, intent(in) :: g
    type(model_t), intent(in) :: model
    type(snapshot_t), intent(in) :: snapshot
    logical, intent(in) :: member(:)
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: values(:)
    integer :: f, p, particle
    if (gauges%cards(g)%radius > 0.0_dp) then
      particle = 0
      call means(gauges, snapshot, member, values)
    else
      p = findloc(member, .true., 1)
      particle = body_given_id(model%bodies(snapshot%body(p)), snapshot%id(p))
      values = [snapshot%position(:, p), snapshot%velocity(:, p), &
                (snapshot%fields(f)%values(:, p), f=1, size(gauges%fields))]
    end if
    if (any(gauges%cards%radius > 0.0_dp)) values = [values, real(count(member), dp)]
    call gauges%file%write_row(model%clock%step, [model%clock%time, real(g, dp), &
                                                  real(particle, dp), values], error, &
                               trim(gauges%cards(g)%name))
  end subroutine write_row

  !> Means over the members: position, velocity, fields.
  pure subroutine means(gauges, snapshot, member, values)
    type(gauges_t), intent(in) :: gauges
    type(snapshot_t), intent(in) :: snapshot
    logical, intent(in) :: member(:)
    real(dp), allocatable, intent(out) :: values(:)
    real(dp) :: motion(2*3), total_mass, total_volume
    integer :: f, n, p
    motion = 0.0_dp
    n = size(gauges%fields)
    associate (mass => snapshot%fields(n + 1)%values(1, :), &
               volume => snapshot%fields(n + 2)%values(1, :))
      total_mass = 0.0_dp
      total_volume = 0.0_dp
      do p = 1, size(member)
        if (.not. member(p)) cycle
        total_mass = total_mass + mass(p)
        total_volume = total_volume + volume(p)
        motion = motion + mass(p)*[snapshot%position(:, p), snapshot%velocity(:, p)]
      end do
      values = motion/total_mass
      do f = 1, n
        if (gauges%fields(f) == 'density') then
          values = [values, total_mass/total_volume]
        else
          values = [values, mean_of(snapshot%fields(f)%values, volume, member)/total_volume]
        end if
      end do
    end associate
  end subroutine means

  !> Sum of the members' values, each times its volume, in the order of the particles.
  pure function mean_of(values, volume, member) result(total)
    real(dp), intent(in) :: values(:, :), volume(:)
    logical, intent(in) :: member(:)
    real(dp) :: total(size(values, 1))
    integer :: p
    total = 0.0_dp
    do p = 1, size(member)
      if (member(p)) total = total + volume(p)*values(:, p)
    end do
  end function mean_of

end module sgmp_gauges
