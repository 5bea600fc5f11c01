!> Which bodies fly into each other, and which of them stick together for want of contact.
module sgmp_meetings
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_fast_scenes, only: velocity_at_start
  use sgmp_graded_axis, only: graded_place
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_parallel, only: parallel_max, parallel_min
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: extent_t, judge_stuck, meetings_collide, meetings_extent

  real(dp), parameter :: fast = 0.25_dp        !! of c + |v|: what is faster flows, whether
                                               !! it sticks or slides
  real(dp), parameter :: least_blow = 0.1_dp   !! of the velocity that one has as the other sees it
  real(dp), parameter :: stuck_error = 0.25_dp

  !> Where a body is and how it moves, in lengths or in cells.
  type :: extent_t
    real(dp) :: lower(3) = 0.0_dp, upper(3) = 0.0_dp
    real(dp) :: velocity(3) = 0.0_dp
  end type extent_t

contains

  !> Solids that have met and share a velocity field, though the deck does not call them a group:
  !! they neither slide nor part. These are too many, or too fast (sgmp_default_contact).
  subroutine judge_stuck(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer :: a, b
    if (scene%many_groups > 0) then
      call opinion%expect(stuck_error, 'no card contact is for '// &
                          integer_text(scene%many_groups)//' bodies, which stick together '// &
                          'where they meet: more than 64 touch only if it is asked for; write '// &
                          'contact all, or make them groups')
      return
    end if
    do a = 1, size(scene%bodies)
      do b = a + 1, size(scene%bodies)
        if (.not. stick(scene, model, a, b)) cycle
        call opinion%expect(stuck_error, "bodies '"//trim(model%bodies(a)%name)//"' and '"// &
                            trim(model%bodies(b)%name)//"' have met and stick together, since "// &
                            'no card contact is for them: they neither slide nor part; write '// &
                            'contact all, or make them a group if they shall stick')
        return
      end do
    end do
  end subroutine judge_stuck

  !> Whether two solids stick that have flown into each other.
  function stick(scene, model, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: a, b
    logical :: yes
    type(extent_t) :: of(2)
    integer :: k, pair(2)
    pair = [a, b]
    yes = model%bodies(a)%field == model%bodies(b)%field .and. .not. &
          (scene%bodies(a)%leader > 0 .and. scene%bodies(a)%leader == scene%bodies(b)%leader)
    yes = yes .and. .not. any([(law_is_spherical(model%bodies(pair(k))%law), k=1, 2)])
    yes = yes .and. .not. any(model%bodies(pair)%rigid) .and. &
          all(model%totals%bodies(pair)%mass > 0.0_dp) .and. &
          all([(allocated(scene%bodies(pair(k))%shapes), k=1, 2)])
    if (.not. yes) return
    do k = 1, 2
      call shapes_box(scene%bodies(pair(k))%shapes, of(k)%lower, of(k)%upper)
      of(k)%velocity = velocity_at_start(scene, pair(k), model%mesh%ndim)
      of(k)%lower(model%mesh%ndim + 1:) = 0.0_dp
      of(k)%upper(model%mesh%ndim + 1:) = 0.0_dp
    end do
    yes = have_hit(scene, model, pair, of)
  end function stick

  !> Whether bodies were on their way to each other, and one was slowed as the other sees it.
  function have_hit(scene, model, pair, of) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: pair(2)
    type(extent_t), intent(in) :: of(2)          !! at the start
    logical :: yes
    real(dp) :: relative(3), lost(3), blow
    integer :: k
    relative = of(1)%velocity - of(2)%velocity
    yes = meetings_collide(of(1), of(2), scene%time%end) .and. &
          norm2(relative) < fast*model%findings%fastest
    blow = 0.0_dp
    do k = 1, 2
      lost = model%totals%bodies(pair(k))%momentum/model%totals%bodies(pair(k))%mass - &
             of(k)%velocity
      blow = max(blow, sum(lost*relative)*merge(-1.0_dp, 1.0_dp, k == 1))
    end do
    yes = yes .and. blow >= least_blow*sum(relative**2)
  end function have_hit

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
