!> What looks wrong in a scene before its first step: nothing that stops a run, each a mistake that
!! somebody makes.
!!
!! A warning names the cards' own numbers and what to write instead. All ranks look, each at its own
!! particles.
module sgmp_forewarnings
  use sgmp_body, only: body_t
  use sgmp_build_stress, only: stress_returned
  use sgmp_constitutive, only: eos_none, law_bends, law_gaseous, law_is_spherical, &
                               material_explosive
  use sgmp_contact, only: contact_between
  use sgmp_debris_doubts, only: debris_warnings
  use sgmp_edge_pressure, only: edge_pressure_warning
  use sgmp_graded_axis, only: graded_place
  use sgmp_judge_collisions, only: projectile_narrow, projectile_wanted
  use sgmp_kernels, only: kernel_sgmp
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_meetings, only: extent_t, meetings_bonded, meetings_collide, meetings_extent
  use sgmp_mesh, only: mesh_find, mesh_occupied, wall_free
  use sgmp_model, only: model_t
  use sgmp_near_parts, only: near_parts
  use sgmp_near_walls, only: near_walls
  use sgmp_parallel, only: parallel_max, parallel_min, parallel_sum
  use sgmp_particle_file, only: particle_file_columns
  use sgmp_particles, only: particles_seat, particles_t
  use sgmp_scene, only: layout_file, scene_t
  use sgmp_seeding, only: seeding_shape_volume
  use sgmp_spelling, only: string_t
  use sgmp_text, only: integer_text, real_text_about, real_text_plain
  use sgmp_time_step, only: clock_choose, clock_t
  use sgmp_wall_doubts, only: wall_warnings
  implicit none
  private
  public :: forewarnings_find, gas_enclosed, shape_mass

  integer(i8), parameter :: unit = 2_i8**24  !! of volume, in a cell: whole numbers have one sum

contains

  !> All warnings of a scene; all ranks must call it.
  subroutine forewarnings_find(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(out) :: warnings(:)
    allocate (warnings(0))
    if (model%ranks%partition%ranks > 1 .and. .not. model%ranks%partition%divisible) then
      call warn(warnings, 'a scene in 1D is not divided: the first rank does all the work')
    end if
    call look_at_times(scene, model, warnings)
    call look_at_masses(scene, model, warnings)
    call look_at_projectiles(scene, model, warnings)
    call look_for_strangers(model, warnings)
    call look_for_bonds(scene, model, warnings)
    call look_for_soft_ground(model, warnings)
    call look_for_glue(scene, model, warnings)
    call look_for_closed_gas(model, warnings)
    call look_at_features(model, warnings)
    if (model%clock%step > 0) return  ! what follows is about places at the start
    call look_at_stress(scene, model, warnings)
    call look_at_spacing(scene, model, warnings)
    call look_at_gauges(scene, model, warnings)
    call look_at_lighting(scene, model, warnings)
    call look_for_collisions(scene, model, warnings)
    call look_for_flying_gas(scene, model, warnings)
    call look_for_near_parts(model, warnings)
    call look_at_walls(scene, model, warnings)
    call look_at_edges(scene, warnings)
  end subroutine forewarnings_find

  !> Gas whose pressure absorbing edges must balance.
  subroutine look_at_edges(scene, warnings)
    type(scene_t), intent(in) :: scene
    type(string_t), allocatable, intent(inout) :: warnings(:)
    character(:), allocatable :: text
    text = edge_pressure_warning(scene)
    if (text /= '') call warn(warnings, text)
  end subroutine look_at_edges

  !> Bodies that begin close to a wall towards which they move.
  subroutine look_at_walls(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    character(:), allocatable :: text
    logical :: touches
    integer :: b
    do b = 1, size(scene%bodies)
      call near_walls(scene, model, b, text, touches)
      if (text /= '') call warn(warnings, text)
    end do
  end subroutine look_at_walls

  !> Parts of a body that touches itself which patches cannot tell apart.
  subroutine look_for_near_parts(model, warnings)
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    integer :: b
    do b = 1, size(model%bodies)
      if (model%bodies(b)%family == 0 .or. model%bodies(b)%twin_of > 0) cycle
      if (.not. near_parts(model%bodies(b)%particles)) cycle
      call warn(warnings, "parts of body '"//trim(model%bodies(b)%name)//"' lie less than 16 "// &
                'cells apart: self=yes may not tell them apart, and where they meet they stick '// &
                'together; smaller cells, or bodies of their own')
    end do
  end subroutine look_for_near_parts

  subroutine warn(warnings, text)
    type(string_t), allocatable, intent(inout) :: warnings(:)
    character(*), intent(in) :: text
    type(string_t), allocatable :: longer(:)
    integer :: n
    n = size(warnings)
    allocate (longer(n + 1))
    longer(:n) = warnings
    longer(n + 1)%text = text
    call move_alloc(longer, warnings)
  end subroutine warn

  !> Numbers in another unit of time, or a step beyond every limit.
  subroutine look_at_times(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    real(dp), parameter :: many_dumps = 1.0e4_dp
    type(clock_t) :: clock
    real(dp) :: every, end, limit
    logical :: ok
    every = minval(scene%output%every, scene%output%every > 0.0_dp)
    clock = model%clock
    associate (time => scene%time)
      if (time%end > 0.0_dp .and. model%clock%step == 0) then
        call clock_choose(clock, model%mesh%h, model%findings%fastest, huge(1.0_dp), ok)
        if (time%end < clock%dt) call warn(warnings, 'the run ends within its first step: end='// &
          real_text_plain(time%end)//', and the step may be '//real_text_about(clock%dt)// &
          "; is end= in the deck's unit of time?")
      end if
      end = min(time%end, time%steps*clock%dt)  ! huge where not given
      if (end/many_dumps > every) then
        call warn(warnings, 'output every='//real_text_plain(every)//' makes '// &
                  integer_text(int(min(end/every, 1.0e15_dp), i8))// &
                  " dumps; is every= in the deck's unit of time?")
      end if
      limit = merge(2.54_dp, 2.0_dp, model%fields(1)%kernel == kernel_sgmp)
      if (time%dt <= 0.0_dp .and. .not. time%cfl_auto .and. time%cfl > limit) then
        call warn(warnings, 'cfl='//real_text_plain(time%cfl)//' is above '// &
                  real_text_plain(limit)//', the most that the method can bear at rest '// &
                  '(doc/time-step.md); cfl=auto finds what the scene bears')
      end if
    end associate
  end subroutine look_at_times

  !> Bodies whose particles make up more or less than their shapes.
  subroutine look_at_masses(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    real(dp), parameter :: tolerated = 0.04_dp
    real(dp) :: mass, expected
    integer :: b
    do b = 1, size(scene%bodies)
      mass = model%totals%bodies(b)%mass
      expected = shape_mass(scene, model, b)
      if (expected <= 0.0_dp .or. abs(mass - expected) <= tolerated*expected) cycle
      call warn(warnings, "the particles of body '"//trim(model%bodies(b)%name)// &
                "' have a mass of "//real_text_about(mass)//', its shapes of '// &
                real_text_about(expected)//': choose a spacing of which its sides are '// &
                'multiples, or a smaller one')
    end do
  end subroutine look_at_masses

  !> Projectiles of few cells across.
  subroutine look_at_projectiles(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    real(dp) :: cells
    integer :: b
    do b = 1, size(scene%bodies)
      cells = projectile_narrow(scene, model, b)
      if (cells >= huge(cells)) cycle
      call warn(warnings, "projectile '"//trim(model%bodies(b)%name)//"' is "// &
                real_text_about(cells)//' cells across: it will be slowed too much; with fewer '// &
                'than 6 its velocity is worth nothing, with '// &
                integer_text(nint(projectile_wanted(scene, model, b)))//' and more it is fair')
    end do
  end subroutine look_at_projectiles

  !> Mass of a body's shapes, 0 where it has none or its card rigid has another.
  pure function shape_mass(scene, model, b) result(mass)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: mass
    mass = 0.0_dp
    if (scene%bodies(b)%mass > 0.0_dp) return
    mass = model%bodies(b)%law%density*seeding_shape_volume(scene%bodies(b), model%mesh%ndim, &
                                                            size(scene%bodies))
  end function shape_mass

  !> Bodies in different velocity fields without contact between them.
  subroutine look_for_strangers(model, warnings)
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    integer :: a, b, first(2), found
    found = 0
    do a = 1, size(model%bodies)
      do b = a + 1, size(model%bodies)
        if (model%bodies(a)%field == model%bodies(b)%field) cycle
        if (any(model%bodies([a, b])%twin_of > 0)) cycle
        if (model%bodies(a)%rigid .and. model%bodies(b)%rigid) cycle
        if (contact_between(model%contact, model%bodies(a)%field, model%bodies(b)%field)) cycle
        found = found + 1
        if (found == 1) first = [a, b]
      end do
    end do
    if (found == 0) return
    call warn(warnings, "no card `contact` is for '"//trim(model%bodies(first(1))%name)// &
              "' and '"//trim(model%bodies(first(2))%name)//"' ("//integer_text(found)// &
              ' such in all): they pass through each other; `contact all` makes every pair touch')
  end subroutine look_for_strangers

  !> Soil with constant moduli beside an explosive, which presses it to many times these.
  subroutine look_for_soft_ground(model, warnings)
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    integer :: b
    if (.not. any(model%bodies%law%kind == material_explosive)) return
    do b = 1, size(model%bodies)
      if (model%bodies(b)%rigid) cycle
      associate (law => model%bodies(b)%law)
        if (law_bends(law) .or. law_is_spherical(law) .or. law%eos /= eos_none) cycle
      end associate
      call warn(warnings, "soil '"//trim(model%bodies(b)%name)//"' has constant moduli and may "// &
                'collapse beside an explosive: give it an equation of state (drucker_prager, '// &
                'doc/materials.md, Soils under blasts)')
      return
    end do
  end subroutine look_for_soft_ground

  !> Solids that are bonded for want of a card: the deck may mean two that can part.
  subroutine look_for_bonds(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    integer :: a, b, found, first(2)
    found = 0
    do a = 1, size(scene%bodies)
      do b = a + 1, size(scene%bodies)
        if (.not. meetings_bonded(scene, a, b)) cycle
        found = found + 1
        if (found == 1) first = [a, b]
      end do
    end do
    if (found == 0) return
    call warn(warnings, "'"//trim(model%bodies(first(1))%name)//"' and '"// &
              trim(model%bodies(first(2))%name)//"' share a surface at the start and are "// &
              'bonded'//more(found - 1)//': contact '// &
              trim(model%bodies(first(1))%name)//' '//trim(model%bodies(first(2))%name)// &
              ' lets them slide and part, a card group says that they are one')
  end subroutine look_for_bonds

  pure function more(pairs) result(text)
    integer, intent(in) :: pairs
    character(:), allocatable :: text
    text = ''
    if (pairs > 0) text = ' ('//integer_text(pairs + 1)//' such in all)'
  end function more

  !> Gas or fluid that sticks to a solid, where cards `contact` show that this may not be meant.
  subroutine look_for_glue(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    integer :: a, b
    if (size(model%contact%pairs) == 0) return
    do a = 1, size(scene%bodies)
      do b = 1, size(scene%bodies)
        if (model%bodies(a)%field /= model%bodies(b)%field) cycle
        if (scene%bodies(a)%leader > 0 .and. scene%bodies(a)%leader == scene%bodies(b)%leader) cycle
        if (.not. law_is_spherical(model%bodies(a)%law) .or. &
            law_is_spherical(model%bodies(b)%law)) cycle
        call warn(warnings, "'"//trim(model%bodies(a)%name)//"' flows and sticks to '"// &
                  trim(model%bodies(b)%name)//"', since no card `contact` parts them: `contact "// &
                  trim(model%bodies(b)%name)//'` lets it slip past')
        return
      end do
    end do
  end subroutine look_for_glue

  !> What features find doubtful, each in its own file (src/features/<name>/<name>_doubts.f90).
  subroutine look_at_features(model, warnings)
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    type(string_t), allocatable :: found(:)
    integer :: w
    call wall_warnings(model, found)
    do w = 1, size(found)
      call warn(warnings, found(w)%text)
    end do
    call debris_warnings(model, found)
    do w = 1, size(found)
      call warn(warnings, found(w)%text)
    end do
  end subroutine look_at_features

  !> Gas between walls with methods where the volumes of its particles drift.
  subroutine look_for_closed_gas(model, warnings)
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    if (.not. gas_enclosed(model) .or. model%fields(1)%kernel == kernel_sgmp) return
    call warn(warnings, 'gas enclosed by walls: with mpm and gimp a drift of volumes makes its '// &
              'pressure fall without end (doc/volumes.md); use sgmp volumes=kept')
  end subroutine look_for_closed_gas

  !> Whether gas is enclosed by walls and nothing keeps its particles' volumes.
  pure function gas_enclosed(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    integer :: b
    yes = .not. model%method%relaxed
    if (yes) yes = all(model%mesh%wall(:, :model%mesh%ndim) /= wall_free)
    if (yes) yes = any([(law_gaseous(model%bodies(b)%law) .and. .not. model%bodies(b)%rigid, &
                         b=1, size(model%bodies))])
  end function gas_enclosed

  !> Products of explosives that fly many times the size of their charge through open sides: each is
  !! soon alone in its cells, at the price of a full chunk.
  subroutine look_for_flying_gas(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    real(dp), parameter :: far = 3.0_dp          !! times the largest side of the charge
    type(extent_t) :: extent
    integer :: b
    associate (mesh => model%mesh)
      if (.not. any(mesh%open(:, :mesh%ndim) .and. mesh%wall(:, :mesh%ndim) == wall_free .and. &
                    .not. mesh%absorbs(:, :mesh%ndim))) return
      do b = 1, size(model%bodies)
        associate (body => model%bodies(b))
          if (body%rigid .or. .not. body%law%detonation_speed > 0.0_dp) cycle
          extent = meetings_extent(model, b)
          if (body%law%detonation_speed*scene%time%end <= &
              far*mesh%h*maxval(extent%upper - extent%lower)) cycle
          call warn(warnings, "products of the explosive '"//trim(body%name)//"' are followed "// &
                    'through the open sides of the grid, however thin they get, and most of '// &
                    'the time may go there: give these sides an end (grid … 0:300) and a card '// &
                    'lost remove')
          return
        end associate
      end do
    end associate
  end subroutine look_for_flying_gas

  !> Cells in which particles of a body lie: a bin may have several.
  pure function cells_of(particles) result(cells)
    type(particles_t), intent(in) :: particles
    integer(i8) :: cells
    real(dp) :: seat(particles%ndim)
    logical :: taken(0:particles%span - 1)
    integer :: bin, chunk, l
    cells = 0_i8
    do bin = 1, size(particles%first)
      taken = .false.
      chunk = particles%first(bin)
      do while (chunk > 0)
        do l = 1, lanes
          if (particles%id(l, chunk) == 0) cycle
          seat = particles_seat(particles, l, chunk)
          taken(modulo(floor(seat(1) - particles%shift), particles%span)) = .true.
        end do
        chunk = particles%next(chunk)
      end do
      cells = cells + count(taken, kind=i8)
    end do
  end function cells_of

  !> Initial stresses that matter does not bear.
  subroutine look_at_stress(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    integer(i8) :: particles
    character(31) :: limit
    character(:), allocatable :: advice
    integer :: b
    do b = 1, size(scene%bodies)
      particles = parallel_sum(stress_returned(scene%bodies(b), scene%gravity, model%mesh, &
                                               model%bodies(b)))
      if (particles == 0_i8) cycle
      limit = merge(' or a limit of the card failure', '                               ', &
                    model%bodies(b)%law%failure%given)
      advice = ''
      if (scene%bodies(b)%stress%geostatic) then
        advice = '; ground that slides at phi bears k0 between (1 - sin(phi))/(1 + sin(phi)) '// &
                 'and its inverse'
      end if
      call warn(warnings, 'the initial stress of '//integer_text(particles)// &
                " particles of body '"//trim(model%bodies(b)%name)//"' is beyond yield"// &
                trim(limit)//': they begin with what they bear instead, out of equilibrium'//advice)
    end do
  end subroutine look_at_stress

  !> Particles larger than the cells they lie in: too wide a lattice, or a particle file whose
  !! columns are not what was meant.
  subroutine look_at_spacing(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    real(dp), parameter :: most = 1.5_dp
    integer(i8) :: cells
    real(dp) :: filled
    integer :: b
    do b = 1, size(scene%bodies)
      associate (card => scene%bodies(b), h => model%mesh%h)
        if (card%layout /= layout_file) then
          if (model%bodies(b)%spacing <= h*(1.0_dp + 1.0e-9_dp)) cycle
          call warn(warnings, "the particles of body '"//trim(card%name)//"' are "// &
                    real_text_plain(model%bodies(b)%spacing)// &
                    ' apart, more than a cell of '//real_text_plain(h)// &
                    ': material between them is not seen; use ppc=2 or a smaller spacing')
        else
          cells = parallel_sum(cells_of(model%bodies(b)%particles))
          filled = real(parallel_sum(volume_of(model, b)), dp)/real(unit, dp)
          if (filled <= most*real(cells, dp)) cycle
          call warn(warnings, "the particles of body '"//trim(card%name)//"' have "// &
                    real_text_about(filled/real(cells, dp))//' times the volume of the cells '// &
                    'that they lie in; the columns of '//trim(card%file)// &
                    ' are read as '//particle_file_columns//', unless its first line names them')
        end if
      end associate
    end do
  end subroutine look_at_spacing

  !> Volume of this rank's particles of a body, in 1/unit of a cell.
  pure function volume_of(model, b) result(volume)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    integer(i8) :: volume
    integer :: c, l
    volume = 0_i8
    associate (particles => model%bodies(b)%particles, slots => model%bodies(b)%law%slots)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          volume = volume + nint(unit*mesh_occupied(model%mesh, &
            particles%motion(l, :particles%ndim, c), particles%state(l, slots%volume, c)), i8)
        end do
      end do
    end associate
  end function volume_of

  !> Gauges that have no particle near them.
  subroutine look_at_gauges(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    real(dp) :: x(3), cells
    integer :: g, b, d
    associate (mesh => model%mesh)
      do g = 1, size(scene%gauges)
        if (scene%gauges(g)%radius > 0.0_dp) cycle
        x(:mesh%ndim) = mesh_find(mesh, [(d, d=1, mesh%ndim)], &
                                  scene%gauges(g)%point(:mesh%ndim))
        cells = huge(1.0_dp)
        do b = 1, size(model%bodies)
          cells = min(cells, nearest(model%bodies(b)%particles, x(:mesh%ndim)))
        end do
        cells = parallel_min(cells)
        if (cells <= sqrt(real(mesh%ndim, dp))) cycle
        call warn(warnings, "gauge '"//trim(scene%gauges(g)%name)//"' is "// &
                  real_text_about(cells)//' cells from the nearest particle, which it will follow')
      end do
    end associate
  end subroutine look_at_gauges

  !> Distance of a point from the nearest particle held here.
  pure function nearest(particles, x) result(distance)
    type(particles_t), intent(in) :: particles
    real(dp), intent(in) :: x(:)                 !! (ndim) in cells
    real(dp) :: distance
    integer :: c, l
    distance = huge(1.0_dp)
    do c = 1, particles%chunks
      do l = 1, lanes
        if (particles%id(l, c) == 0) cycle
        distance = min(distance, norm2(particles%motion(l, :particles%ndim, c) - x))
      end do
    end do
  end function nearest

  !> Explosives that no detonation reaches before the end.
  subroutine look_at_lighting(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    real(dp) :: first
    integer :: b
    if (scene%time%end <= 0.0_dp) return
    do b = 1, size(scene%bodies)
      associate (particles => model%bodies(b)%particles, slots => model%bodies(b)%law%slots)
        if (slots%lighting == 0) cycle
        first = parallel_min(minval(particles%state(:, slots%lighting, :particles%chunks), &
                                    mask=particles%id(:, :particles%chunks) > 0))
      end associate
      if (first <= scene%time%end) cycle
      call warn(warnings, "the detonation reaches body '"//trim(model%bodies(b)%name)// &
                "' at "//real_text_about(first)//', after the end of the run')
    end do
  end subroutine look_at_lighting

  !> Bodies that fly into each other and, for want of contact, will stick together, and rigid ones,
  !! which pass through each other.
  subroutine look_for_collisions(scene, model, warnings)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(inout) :: warnings(:)
    type(extent_t) :: extents(size(scene%bodies))
    character(:), allocatable :: names
    logical :: meet, grouped                     !! grouped: one to others, as the deck says
    integer :: a, b
    do b = 1, size(scene%bodies)
      extents(b) = meetings_extent(model, b)
    end do
    do a = 1, size(scene%bodies)
      do b = a + 1, size(scene%bodies)
        meet = meetings_collide(extents(a), extents(b), scene%time%end)
        grouped = scene%bodies(a)%leader > 0 .and. &
                  scene%bodies(a)%leader == scene%bodies(b)%leader
        names = "'"//trim(model%bodies(a)%name)//"' and '"//trim(model%bodies(b)%name)//"'"
        if (pass_through(model%bodies(a), model%bodies(b), meet)) then
          call warn(warnings, names//' are both rigid: they do not feel each other, with or '// &
                    'without contact; make one of them deformable')
        else if (meet .and. .not. grouped .and. &
                 model%bodies(a)%field == model%bodies(b)%field) then
          call warn(warnings, names//' move towards each other and will stick '// &
                    'together where they meet, since no card contact is for them')
        else
          cycle
        end if
        return
      end do
    end do
  end subroutine look_for_collisions

  !> Whether bodies may come to lie in each other because both are rigid. Where a free one goes
  !! nobody knows before.
  pure function pass_through(a, b, meet) result(yes)
    type(body_t), intent(in) :: a, b
    logical, intent(in) :: meet                  !! if they keep their velocities
    logical :: yes
    yes = a%rigid .and. b%rigid .and. (meet .or. a%rigid_motion%free .or. b%rigid_motion%free)
  end function pass_through

end module sgmp_forewarnings
