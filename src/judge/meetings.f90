!> Which bodies meet, and which of them stick together though no card says that they shall.
module sgmp_meetings
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_fast_scenes, only: velocity_at_start
  use sgmp_graded_axis, only: graded_place
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_blast
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_parallel, only: parallel_max, parallel_min
  use sgmp_scene, only: load_card_t, scene_t
  use sgmp_space, only: axes_in_output, space_axisymmetric
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: extent_t, judge_bonds, judge_stuck, meetings_bonded, meetings_collide, &
            meetings_extent, meetings_met, meetings_push

  real(dp), parameter :: least_blow = 0.1_dp  !! impulse, over what the lighter body could have
  real(dp), parameter :: stuck_error = 0.25_dp

  !> Where a body is and how it moves, in lengths or in cells.
  type :: extent_t
    real(dp) :: lower(3) = 0.0_dp, upper(3) = 0.0_dp
    real(dp) :: velocity(3) = 0.0_dp
  end type extent_t

contains

  !> Bodies that share a velocity field, though the deck does not call them a group, because they
  !! are too many (sgmp_default_contact): they neither slide nor part.
  subroutine judge_stuck(opinion, scene)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    if (scene%many_groups == 0) return
    call opinion%expect(stuck_error, 'no card contact is for '//integer_text(scene%many_groups)// &
                        ' bodies, which stick together where they meet: more than 64 touch '// &
                        'only if it is asked for; write contact all, or make them groups')
  end subroutine judge_stuck

  !> Solids that are bonded because they share a surface at the start, which another body or a
  !! sudden load has hit: whether a blow parts them the deck does not say.
  subroutine judge_bonds(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer :: a, b, p, side
    call find_loaded(scene, a, b)
    if (b > 0) then
      call object_to_bond(opinion, model, a, b, 'a sudden load acts on them: whether that')
      return
    end if
    if (.not. differ(scene, model%mesh%ndim)) return
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (.not. meetings_met(scene, model, pair)) cycle
        do side = 1, 2
          do a = 1, size(scene%bodies)
            if (model%bodies(a)%field /= pair%field(side)) cycle
            do b = a + 1, size(scene%bodies)
              if (.not. meetings_bonded(scene, a, b)) cycle
              call object_to_bond(opinion, model, a, b, 'were hit: whether a blow')
              return
            end do
          end do
        end do
      end associate
    end do
  end subroutine judge_bonds

  !> A body on which a sudden load acts, and one that is bonded to it; b = 0: none.
  subroutine find_loaded(scene, a, b)
    type(scene_t), intent(in) :: scene
    integer, intent(out) :: a, b
    integer :: l
    a = 0
    do l = 1, size(scene%loads)
      if (.not. is_sudden(scene%loads(l))) cycle
      a = scene%loads(l)%body
      do b = 1, size(scene%bodies)
        if (b == a) cycle
        if (meetings_bonded(scene, a, b)) return
      end do
    end do
    b = 0
  end subroutine find_loaded

  !> The objection.
  subroutine object_to_bond(opinion, model, a, b, cause)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    integer, intent(in) :: a, b                  !! bodies
    character(*), intent(in) :: cause
    call opinion%object("'"//trim(model%bodies(a)%name)//"' and '"// &
                        trim(model%bodies(b)%name)//"' are bonded, since they share a "// &
                        'surface at the start, and '//cause//' parts them is not said; '// &
                        'write contact all if it does, or make them a group')
  end subroutine object_to_bond

  !> Whether a load is there at once and changes, so that what it sends in comes back as tension.
  function is_sudden(load) result(yes)
    type(load_card_t), intent(in) :: load
    logical :: yes
    real(dp), parameter :: nowhere(3) = 0.0_dp
    integer :: d
    yes = load%kind == load_blast
    do d = 1, 3
      if (.not. load%value(d)%uses_time) cycle
      yes = yes .or. abs(load%value(d)%evaluate(nowhere, nowhere, 0.0_dp)) > 0.0_dp
    end do
  end function is_sudden

  !> Whether two bodies are bonded though no card says so.
  pure function meetings_bonded(scene, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    logical :: yes
    associate (one => scene%bodies(a), two => scene%bodies(b))
      yes = one%leader > 0 .and. one%leader == two%leader .and. .not. &
            (one%group /= '' .and. one%group == two%group)
    end associate
  end function meetings_bonded

  !> Whether bodies begin with different velocities.
  pure function differ(scene, ndim) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: ndim
    logical :: yes
    real(dp) :: first(3)
    integer :: b
    yes = .false.
    if (size(scene%bodies) == 0) return
    first = velocity_at_start(scene, 1, ndim)
    do b = 2, size(scene%bodies)
      yes = yes .or. any(abs(velocity_at_start(scene, b, ndim) - first) > 0.0_dp)
    end do
  end function differ

  !> Whether two bodies, one of which deforms, have given each other a blow.
  pure function meetings_met(scene, model, pair) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    logical :: yes
    real(dp) :: mass, speed2
    yes = all(pair%body <= size(scene%bodies))  ! no twin
    if (yes) yes = .not. all(model%bodies(pair%body)%rigid)
    if (.not. yes) return
    speed2 = 2.0_dp*model%ledger%supplied/max(sum(model%totals%bodies%mass), tiny(1.0_dp))
    mass = minval(model%totals%bodies(pair%body)%mass, mask=.not. model%bodies(pair%body)%rigid)
    yes = sum(pair%impulse**2) >= least_blow**2*mass**2*speed2
  end function meetings_met

  !> What a pair has given each other along the axes of the space; about an axis of symmetry pushes
  !! along the radius cancel.
  pure function meetings_push(model, pair) result(push)
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    real(dp) :: push(3)
    push(axes_in_output(:, model%mesh%space)) = pair%impulse
    if (model%mesh%space == space_axisymmetric) push(1) = 0.0_dp
  end function meetings_push

  !> Where the particles of a body are (cells); all ranks must call it.
  function meetings_extent(model, b) result(extent)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    type(extent_t) :: extent
    real(dp) :: low(3), high(3)
    integer :: c, d, n
    n = model%mesh%ndim
    low = huge(low)
    high = -huge(high)
    !$omp parallel do schedule(static) default(none) shared(model, b, n) private(d) &
    !$omp& reduction(min: low) reduction(max: high)
    do c = 1, model%bodies(b)%particles%chunks
      associate (particles => model%bodies(b)%particles)
        do d = 1, n
          low(d) = min(low(d), minval(particles%motion(:, d, c), mask=particles%id(:, c) > 0))
          high(d) = max(high(d), maxval(particles%motion(:, d, c), mask=particles%id(:, c) > 0))
        end do
      end associate
    end do
    !$omp end parallel do
    associate (body => model%bodies(b), h => model%mesh%h, sums => model%totals%bodies(b))
      do d = 1, n
        extent%lower(d) = parallel_min(low(d))
        extent%upper(d) = parallel_max(high(d))
        extent%lower(d) = graded_place(model%mesh%axes(d), extent%lower(d)) - 0.5_dp*body%spacing/h
        extent%upper(d) = graded_place(model%mesh%axes(d), extent%upper(d)) + 0.5_dp*body%spacing/h
      end do
      extent%velocity = sums%momentum/(h*max(sums%mass, tiny(1.0_dp)))
      if (body%rigid) extent%velocity = body%speed/h
    end associate
  end function meetings_extent

  !> Whether boxes that keep their velocities come to overlap before the end (0: none).
  pure function meetings_collide(a, b, end) result(yes)
    type(extent_t), intent(in) :: a, b
    real(dp), intent(in) :: end
    logical :: yes
    real(dp) :: from, to, speed, times(2)
    integer :: d
    from = 0.0_dp
    to = huge(1.0_dp)
    if (end > 0.0_dp) to = end
    yes = any(abs(a%velocity - b%velocity) > 1.0e-9_dp*(abs(a%velocity) + abs(b%velocity)))
    do d = 1, 3
      if (a%upper(d) <= a%lower(d)) cycle  ! no such axis
      speed = a%velocity(d) - b%velocity(d)
      if (abs(speed) <= 0.0_dp) then
        yes = yes .and. a%lower(d) < b%upper(d) .and. b%lower(d) < a%upper(d)
      else
        times = [(b%lower(d) - a%upper(d))/speed, (b%upper(d) - a%lower(d))/speed]
        from = max(from, minval(times))
        to = min(to, maxval(times))
      end if
    end do
    yes = yes .and. from < to
  end function meetings_collide

end module sgmp_meetings
