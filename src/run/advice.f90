!> What would make a scene cheaper (`--check`): a line each, what is seen, the cards to write and
!! what they gain. Only what is sure and gains more than half.
module sgmp_advice
  use sgmp_graded_plan, only: graded_plan_find, graded_plan_t
  use sgmp_grid_fit, only: grid_fit_whole
  use sgmp_kinds, only: dp, i8, lanes, pi
  use sgmp_mesh, only: mesh_place, wall_free, wall_slip
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_sum
  use sgmp_scene, only: grid_card_t, dump_formats, dump_names, dump_tecplot, scene_space, scene_t
  use sgmp_scene_symmetry, only: scene_mirrored, scene_plain, scene_revolved, scene_uniform
  use sgmp_shapes, only: shapes_box
  use sgmp_space, only: axis_names
  use sgmp_spelling, only: string_t
  use sgmp_text, only: integer_text, real_text_about, real_text_tidy
  use sgmp_trial, only: trial_t
  implicit none
  private
  public :: advice_find, advice_of_output

  real(dp), parameter :: enough = 1.5_dp       !! gain from which on something is said
  real(dp), parameter :: unit = 2.0_dp**20     !! whole numbers have one sum over ranks
  ! Seconds that a particle takes in a dump, of its bytes and as text: four fifths of what
  ! input/taylor_bar.inp with output every=1e-3 fields=stress,plastic_strain took.
  real(dp), parameter :: binary_dump = 0.4e-6_dp, text_dump = 3.0e-6_dp

contains

  !> Advice on the geometry of a scene; all ranks must call it.
  subroutine advice_find(scene, model, lines)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(out) :: lines(:)
    type(graded_plan_t) :: plan
    logical :: unsaid(3)                       !! axes of which nothing is said yet
    allocate (lines(0))
    if (model%clock%step > 0) return
    unsaid = .false.
    unsaid(:scene%dimension) = .true.
    if (scene_plain(scene)) then
      call advise_revolution(scene, model, unsaid, lines)
      call advise_dimension(scene, model, unsaid, lines)
      call advise_mirrors(scene, unsaid, lines)
    end if
    call graded_plan_find(scene, model, plan)
    if (plan%words == '' .or. plan%gain < enough) return
    lines = [lines, string_t('small cells are needed only where bodies meet: grid … '// &
                             plan%words//' (sgmp DECK --suggest writes the deck): '// &
                             integer_text(plan%particles)//' particles, about '// &
                             factor_text(plan%gain)//' times less time')]
  end subroutine advice_find

  !> A body of revolution in three dimensions.
  subroutine advise_revolution(scene, model, unsaid, lines)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical, intent(inout) :: unsaid(3)
    type(string_t), allocatable, intent(inout) :: lines(:)
    real(dp) :: line(3), low(3), high(3), rings
    integer :: a
    if (scene%dimension < 3 .or. .not. scene%allows%axisymmetric) return
    do a = 3, 1, -1
      call shapes_box(scene%bodies(1)%shapes, low, high)
      line = 0.5_dp*(low + high)
      if (.not. all(abs(line) < 1.0e30_dp)) return
      if (.not. scene_revolved(scene, a, line)) cycle
      rings = rings_of(scene, model, a, line)
      if (sum(model%totals%particles) < enough*rings) return
      lines = [lines, string_t('all is round about one line along '//axis_names(a, 3)// &
               ' and moves along it: dimension axisymmetric, grid r=0:… z=…, bodies by '// &
               'their sections (r,z), unless it may buckle or break out of round: about '// &
               factor_text(real(sum(model%totals%particles), dp)/rings)// &
               ' times fewer particles')]
      unsaid(:) = .false.
      unsaid(a) = .true.
      return
    end do
  end subroutine advise_revolution

  !> How many rings a body of revolution has: area of its section over that of a particle.
  function rings_of(scene, model, axis, line) result(rings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: axis
    real(dp), intent(in) :: line(3)            !! a point of the line (length)
    real(dp) :: rings
    real(dp) :: x(3), r, part, area
    integer :: a, b, c, l
    part = 1.0_dp                              ! of the whole round
    do a = 1, 3
      if (a /= axis .and. any(scene%grid%wall(:, a) == wall_slip)) part = 0.5_dp*part
    end do
    rings = 0.0_dp
    do b = 1, size(scene%bodies)
      area = 0.0_dp
      associate (body => model%bodies(b), own => model%bodies(b)%particles)
        do c = 1, own%chunks
          do l = 1, lanes
            if (own%id(l, c) == 0) cycle
            x = [(mesh_place(model%mesh, a, own%motion(l, a, c)), a=1, 3)] - line
            x(axis) = 0.0_dp
            r = max(norm2(x), 0.25_dp*body%spacing)
            area = area + own%state(l, body%law%slots%volume, c)/(2.0_dp*pi*part*r)
          end do
        end do
        rings = rings + parallel_sum(nint(unit*area/body%spacing**2, i8))/unit
      end associate
    end do
    rings = max(rings, 1.0_dp)
  end function rings_of

  !> Axes along which nothing changes.
  subroutine advise_dimension(scene, model, unsaid, lines)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical, intent(inout) :: unsaid(3)
    type(string_t), allocatable, intent(inout) :: lines(:)
    character(:), allocatable :: names, left
    logical :: alike(3)
    real(dp) :: fewer
    integer :: a, b, dimension
    if (scene%axisymmetric .or. scene%dimension == 1) return
    alike = axes_alike(scene, unsaid .and. .not. model%mesh%axes%graded)
    dimension = scene%dimension - count(alike)
    if (.not. any(alike) .or. .not. scene%allows%dimension(dimension)) return
    fewer = 0.0_dp
    do b = 1, size(scene%bodies)
      fewer = fewer + real(model%totals%particles(b), dp)/ &
              product(max(1.0_dp, (scene%grid%upper - scene%grid%lower)/model%bodies(b)%spacing), &
                      mask=alike)
    end do
    if (sum(model%totals%particles) < enough*fewer) return
    names = ''
    left = ''
    do a = 1, scene%dimension
      if (alike(a)) names = names//trim(merge(' and ', '     ', names /= ''))//' '//axis_names(a, 3)
      if (.not. alike(a)) left = left//' '//axis_names(a, 3)
    end do
    lines = [lines, string_t('nothing changes along'//names//', from wall to wall: dimension '// &
                             integer_text(dimension)//' in'//left//': '// &
                             factor_text(sum(model%totals%particles)/fewer)// &
                             ' times fewer particles')]
    where (alike) unsaid = .false.
  end subroutine advise_dimension

  !> Which axes a scene can do without: one is left.
  function axes_alike(scene, asked) result(alike)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: asked(3)
    logical :: alike(3)
    integer :: a
    alike = .false.
    do a = scene%dimension, 1, -1
      if (asked(a) .and. count(alike) < scene%dimension - 1) alike(a) = scene_uniform(scene, a)
    end do
  end function axes_alike

  !> Planes of symmetry.
  subroutine advise_mirrors(scene, unsaid, lines)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: unsaid(3)
    type(string_t), allocatable, intent(inout) :: lines(:)
    character(:), allocatable :: planes, grid, wall, cut
    character(9), parameter :: parts(3) = [character(9) :: 'a half', 'a quarter', 'an eighth']
    character(1) :: name
    real(dp) :: plane
    integer :: a, found
    if (scene%dimension == 1) return
    planes = ''
    grid = ''
    wall = ''
    cut = ''
    found = 0
    do a = 1, scene%dimension
      if (.not. unsaid(a) .or. (scene%axisymmetric .and. a == 1)) cycle
      call choose_plane(scene, a, plane)
      if (.not. abs(plane) < 1.0e30_dp) cycle
      if (.not. scene_mirrored(scene, a, plane)) cycle
      found = found + 1
      name = axis_names(a, scene_space(scene))
      if (found > 1) planes = planes//', '
      planes = planes//name//' = '//real_text_tidy(plane)
      grid = grid//' '//name//'='//real_text_tidy(plane)//':'//end_text(scene%grid, a)
      wall = wall//' '//name//'-=slip'
      cut = cut//', subtract BODY halfspace axis='//direction_text(scene, a, 1.0_dp)
      if (abs(plane) > 0.0_dp) cut = cut//' centre='//direction_text(scene, a, plane)
    end do
    if (found == 0) return
    lines = [lines, string_t('the scene is its own image in '//planes//': compute '// &
                             trim(parts(found))//' of it, grid …'//grid//', wall'//wall//cut// &
                             ' for each body: '//integer_text(2**found)//' times fewer particles')]
  end subroutine advise_mirrors

  !> The upper end of the grid along an axis as a deck has it.
  pure function end_text(grid, axis) result(text)
    type(grid_card_t), intent(in) :: grid
    integer, intent(in) :: axis
    character(:), allocatable :: text
    text = 'open'
    if (grid%one_sided(2, axis) .or. .not. grid%open(2, axis)) then
      text = real_text_tidy(grid%upper(axis))
    end if
  end function end_text

  !> Where a plane of symmetry across an axis may be: midway between the ends of the grid, in an
  !! open grid in the middle of the first body; huge where cells would not fit behind it.
  subroutine choose_plane(scene, axis, plane)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    real(dp), intent(out) :: plane             !! (length)
    real(dp) :: low(3), high(3)
    associate (grid => scene%grid)
      if (any(grid%open(:, axis))) then
        call shapes_box(scene%bodies(1)%shapes, low, high)
        plane = 0.5_dp*low(axis) + 0.5_dp*high(axis)
      else
        plane = 0.5_dp*(grid%lower(axis) + grid%upper(axis))
        if (grid%wall(2, axis) /= wall_free .and. &
            .not. grid_fit_whole(grid%upper(axis) - plane, grid%cell)) plane = huge(1.0_dp)
      end if
      if (abs(plane) < 1.0e-9_dp*grid%cell) plane = 0.0_dp
    end associate
  end subroutine choose_plane

  !> A vector along an axis, as the deck has it.
  pure function direction_text(scene, axis, length) result(text)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    real(dp), intent(in) :: length
    character(:), allocatable :: text
    integer :: a
    text = '('
    do a = 1, scene%dimension
      if (a > 1) text = text//','
      if (a == axis) text = text//real_text_tidy(length)
      if (a /= axis) text = text//'0'
    end do
    text = text//')'
  end function direction_text

  !> Advice on dumps that take longer than what is between them, by the steps of a trial.
  function advice_of_output(scene, trial, particles) result(lines)
    type(scene_t), intent(in) :: scene
    type(trial_t), intent(in) :: trial
    integer(i8), intent(in) :: particles       !! of all ranks
    type(string_t), allocatable :: lines(:)
    real(dp) :: end, dumps, seconds, solving, every
    integer :: f
    allocate (lines(0))
    if (trial%steps < 2 .or. trial%dt <= 0.0_dp) return
    end = trial%ahead*trial%dt
    if (scene%time%end > 0.0_dp) end = min(end, scene%time%end)
    solving = trial%ahead*trial%seconds
    do f = 1, dump_formats
      every = scene%output%every(f)
      if (.not. (scene%output%writes(f) .and. every > 0.0_dp)) cycle
      dumps = end/every
      seconds = dumps*particles*merge(text_dump, binary_dump, f == dump_tecplot)
      if (seconds < solving) cycle
      every = end/(0.1_dp*solving/(seconds/dumps))
      lines = [lines, string_t('output '//trim(dump_names(f))//' writes '// &
               integer_text(nint(min(dumps, 1.0e15_dp), i8))//' dumps, which take longer than '// &
               'the steps: every='//real_text_about(rounded(every))//' makes it a tenth of '// &
               'them at most: about '//factor_text((solving + seconds)/(1.1_dp*solving))// &
               ' times less time')]
    end do
  end function advice_of_output

  !> The next 1, 2 or 5 times a power of ten.
  pure function rounded(value) result(above)
    real(dp), intent(in) :: value
    real(dp) :: above, power
    power = 10.0_dp**floor(log10(value))
    above = power*merge(2.0_dp, merge(5.0_dp, 10.0_dp, value <= 5.0_dp*power), &
                        value <= 2.0_dp*power)
  end function rounded

  !> A factor of two digits.
  pure function factor_text(factor) result(text)
    real(dp), intent(in) :: factor
    character(:), allocatable :: text
    character(24) :: buffer
    write (buffer, '(f24.1)') factor
    if (factor >= 10.0_dp) write (buffer, '(f24.0)') factor
    text = trim(adjustl(buffer))
    if (text(len(text):) == '.') text = text(:len(text) - 1)
  end function factor_text

end module sgmp_advice
