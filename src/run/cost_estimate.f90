!> What a run of a scene would cost (`--check`): what is solved, what is stored and why, what it
!! will cost.
module sgmp_cost_estimate
  use, intrinsic :: iso_fortran_env, only: output_unit
  use sgmp_air_blast, only: air_blast_wave, blast_arrival, blast_duration, blast_incident, &
                            blast_incident_impulse, blast_reflected, blast_reflected_impulse
  use sgmp_body, only: body_group, body_particle, body_t
  use sgmp_constitutive, only: constitutive_t, law_is_spherical, law_liquid, material_names
  use sgmp_contact, only: contact_between
  use sgmp_features, only: features_split_unasked
  use sgmp_field, only: field_bytes
  use sgmp_forewarnings, only: shape_mass
  use sgmp_graded_estimate, only: graded_estimate_lines
  use sgmp_grid_fit, only: grid_fit_moved
  use sgmp_kernels, only: method_names
  use sgmp_kinds, only: dp, i8
  use sgmp_load, only: load_absorbing, load_blast, load_force, load_t
  use sgmp_material_history, only: kept_columns, slots_t
  use sgmp_model, only: model_t
  use sgmp_particles, only: particles_bytes
  use sgmp_rigid_motion, only: rigid_motion_t
  use sgmp_rows, only: rows_points
  use sgmp_scene, only: scene_t
  use sgmp_spelling, only: string_t
  use sgmp_text, only: integer_text, real_text, real_text_about
  use sgmp_thickness, only: body_thickness
  use sgmp_time_step, only: clock_choose, clock_t, limit_names
  use sgmp_trial, only: trial_t
  use sgmp_update, only: update_names
  use sgmp_walls_apart, only: walls_apart_lines
  implicit none
  private
  public :: cost_estimate_write, cost_estimate_write_advice, cost_estimate_write_need, &
            cost_estimate_write_time

contains

  !> Writes the estimate to the terminal.
  subroutine cost_estimate_write(scene, model)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(string_t), allocatable :: moved(:), lines(:)
    integer(i8) :: bytes, particles
    integer :: b
    call put('deck        '//scene%file//': '//scene%title)
    if (scene%axisymmetric) then
      call put('dimension   axisymmetric')
    else
      call put('dimension   '//integer_text(scene%dimension)// &
               trim(merge(' (plane strain)', '               ', scene%dimension == 2)))
    end if
    call put('method      '//trim(method_names(scene%method%kind))//', '// &
             trim(update_names(scene%method%update)))
    if (features_split_unasked(scene%features) /= '') then
      call put('  default   '//features_split_unasked(scene%features))
    end if
    call put('grid        cell '//real_text(model%mesh%h)//', active points '// &
             integer_text(sum(rows_points(model%fields%work)))//' (stored '// &
             integer_text(sum(model%fields%points))//'), '// &
             integer_text(model%fields(1)%columns%total + model%fields(1)%columns%nodes)// &
             ' values each, '// &
             bytes_text(sum([(field_bytes(model%fields(b)), b=1, size(model%fields))])))
    moved = grid_fit_moved(scene)
    do b = 1, size(moved)
      call put('  '//moved(b)%text)
    end do
    moved = walls_apart_lines(scene)
    do b = 1, size(moved)
      call put('  '//moved(b)%text)
    end do
    lines = graded_estimate_lines(model%mesh, model%bodies)
    do b = 1, size(lines)
      call put(lines(b)%text)
    end do
    bytes = sum([(field_bytes(model%fields(b)), b=1, size(model%fields))])
    particles = 0_i8
    do b = 1, size(scene%bodies)
      call put_body(scene, model, b)
      bytes = bytes + particles_bytes(model%bodies(b)%particles)
      particles = particles + int(model%bodies(b)%particles%count, i8)
    end do
    call put_contact(scene, model)
    call put('memory      '//bytes_text(bytes)//' for '//integer_text(particles)//' particles: '// &
             real_text(real(bytes, dp)/real(max(particles, 1_i8), dp))// &
             ' bytes per particle, grid included')
    call put_step(model)
  end subroutine cost_estimate_write

  !> What is known of a scene that would strain the memory, where nothing has been built.
  subroutine cost_estimate_write_need(scene, need, available)
    type(scene_t), intent(in) :: scene
    real(dp), intent(in) :: need, available      !! bytes on this machine
    character(:), allocatable :: verdict
    call put('deck        '//scene%file//': '//scene%title)
    verdict = 'too large to be built for a check'
    if (need > available) verdict = 'does not fit, and would be refused'
    call put('memory      about '//bytes_text(nint(need, i8))//' needed, '// &
             bytes_text(nint(min(available, 1.0e18_dp), i8))//' available: '//verdict)
  end subroutine cost_estimate_write_need

  !> Groups of bodies that move in one velocity field, which of them touch, and what the others do.
  ! allow(S901): four lists, each with what it leaves out
  subroutine put_contact(scene, model)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer :: f, g, a, b, p
    if (size(model%bodies) < 2 .and. size(model%contact%pairs) == 0) return
    if (size(model%contact%pairs) == 0) then
      call put('contact     none: all bodies share one velocity field, and stick together '// &
               'where they meet')
      return
    end if
    do f = 1, size(model%fields)
      b = findloc(model%bodies%field, f, 1)
      if (model%bodies(b)%twin_of > 0) cycle
      if (b > 0) call put('field       '//integer_text(f)//': '//body_group(model%bodies, b)// &
                          together(scene, model, f))
    end do
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (any(model%bodies(pair%body)%label > 1)) cycle
        if (pair%family > 0) then
          call put('contact     '//body_group(model%bodies, pair%body(1))//' and itself, '// &
                   'friction '//real_text(pair%friction))
          cycle
        end if
        if (any(model%bodies(pair%body)%label > 0)) cycle
        call put('contact     '//body_group(model%bodies, pair%body(1))//' and '// &
                 body_group(model%bodies, pair%body(2))//', friction '//real_text(pair%friction))
      end associate
    end do
    if (any(scene%contacts%unasked)) then
      call put('  default   contact all: no card contact or group is for some that may meet '// &
               '(doc/contact.md)')
    end if
    do f = 1, size(model%fields)
      do g = f + 1, size(model%fields)
        a = findloc(model%bodies%field, f, 1)
        b = findloc(model%bodies%field, g, 1)
        if (any(model%bodies([a, b])%twin_of > 0)) cycle
        if (a == 0 .or. b == 0 .or. contact_between(model%contact, f, g)) cycle
        call put('no contact  '//body_group(model%bodies, a)//' and '// &
                 body_group(model%bodies, b)//' pass through each other')
      end do
    end do
  end subroutine put_contact

  !> What the bodies of one field do where they meet, and the name of their group.
  function together(scene, model, field) result(text)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: field
    character(:), allocatable :: text
    logical :: flows(size(model%bodies))
    integer :: b
    text = ''
    if (count(model%bodies%field == field) < 2) return
    do b = 1, size(flows)
      flows(b) = law_is_spherical(model%bodies(b)%law)
    end do
    text = ', stick together'
    if (all(flows .or. model%bodies%field /= field)) text = ', mix'
    b = findloc(model%bodies(:size(scene%bodies))%field == field .and. &
                scene%bodies%group /= '', .true., 1)
    if (b > 0) then
      text = text//' (group '//trim(scene%bodies(b)%group)//')'
    else if (any(model%bodies(:size(scene%bodies))%field == field .and. &
                 scene%bodies%leader > 0)) then
      text = text//' (default: they touch at the start and move alike)'
    end if
  end function together

  subroutine put_body(scene, model, b)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    associate (body => model%bodies(b), material => scene%materials(scene%bodies(b)%material))
      call put('body        '//trim(body%name)//': '//integer_text(body%particles%count)// &
               ' particles of '//trim(material%name)//' ('// &
               trim(material_names(material%law%kind))//'), '// &
               bytes_text(particles_bytes(body%particles)))
      call put_mass(model%totals%bodies(b)%mass, shape_mass(scene, model, b))
      call put_thickness(body_thickness(scene%bodies(b)%shapes, model%mesh))
      if (body%rigid_motion%free) call put_free(body%rigid_motion)
      call put('  stored    position, velocity, mass, volume and id (always)')
      call put_slots(body%law%slots)
      call put_defaults(body%law)
      call put_loads(body)
    end associate
  end subroutine put_body

  !> What moves as a whole: its centre of mass, and the inertia about it as the body lies.
  subroutine put_free(motion)
    type(rigid_motion_t), intent(in) :: motion
    integer :: d
    call put('  rigid     free, centre of mass ('//list(motion%centre)//')')
    if (motion%turns) then
      call put('  inertia   xx yy zz '//list([(motion%inertia(d, d), d=1, 3)])//', xy yz zx '// &
               list([motion%inertia(1, 2), motion%inertia(2, 3), motion%inertia(3, 1)]))
    end if
  end subroutine put_free

  !> Three numbers.
  function list(values) result(text)
    real(dp), intent(in) :: values(3)
    character(:), allocatable :: text
    text = real_text(values(1))//' '//real_text(values(2))//' '//real_text(values(3))
  end function list

  !> Mass of a body's particles beside that of its shapes.
  subroutine put_mass(mass, expected)
    real(dp), intent(in) :: mass, expected       !! expected: of the shapes, 0 where there are none
    character(24) :: percent
    if (expected <= 0.0_dp) then
      call put('  mass      '//real_text(mass))
    else
      write (percent, '(sp, f24.1)') 100.0_dp*(mass/expected - 1.0_dp)
      call put('  mass      '//real_text(mass)//'; of its shapes '//real_text(expected)//' ('// &
               trim(adjustl(percent))//' %)')
    end if
  end subroutine put_mass

  !> Cells across the thinnest of a body's shapes.
  subroutine put_thickness(cells)
    real(dp), intent(in) :: cells                !! huge: not known
    if (cells >= huge(cells)) return
    call put('  thinnest  '//real_text_about(cells)//' cells')
  end subroutine put_thickness

  !> Fields of the second stream with the card that asked for them.
  subroutine put_slots(slots)
    type(slots_t), intent(in) :: slots
    integer :: i, k
    do i = 1, size(slots%list)
      k = findloc(kept_columns%name == slots%list(i)%name, .true., 1)
      if (k == 0) cycle
      if (kept_columns(k)%name == 'stress') then
        call put_slot(1, integer_text(slots%stresses)//' '//trim(kept_columns(k)%said))
      else if (kept_columns(k)%said /= '') then
        call put_slot(1, trim(kept_columns(k)%said))
      end if
    end do
  end subroutine put_slots

  !> What a fast scene gives a material whose cards do not say it (sgmp_fast_scenes).
  subroutine put_defaults(law)
    type(constitutive_t), intent(in) :: law
    if (law%viscous .and. .not. law%viscosity%given) then
      call put('  default   bulk viscosity quadratic='//real_text(law%viscosity%quadratic)// &
               ' linear='//real_text(law%viscosity%linear)//' (fast scene, no card viscosity)')
    end if
    if (law%fails .and. .not. law%failure%given .and. law_liquid(law)) then
      call put('  default   no tension (no card failure)')
    end if
  end subroutine put_defaults

  !> What is stored for the loads of a body.
  subroutine put_loads(body)
    type(body_t), intent(in) :: body
    integer :: edges, forces, i
    forces = count(body%loads%kind == load_force)
    call put_slot(forces, integer_text(forces)//' shares in forces (load)')
    edges = count(body%loads%kind == load_absorbing)
    forces = size(body%loads) - forces - edges
    call put_slot(forces, integer_text(forces)//' area vectors of faces (pressure, traction, '// &
                  'blast)')
    call put_slot(edges, integer_text(edges)//' area vectors of faces, and the traction at '// &
                  'rest (absorbing walls)')
    i = findloc(body%loads%kind == load_absorbing .and. body%loads%fading > 0.0_dp, .true., 1)
    if (i > 0) call put('  edges     bear what goes on pushing around ('// &
                        real_text(body%loads(i)%source(1))//','// &
                        real_text(body%loads(i)%source(2))//','// &
                        real_text(body%loads(i)%source(3))//')')
    if (body%law%ambient > 0.0_dp) then
      call put('  around    a pressure of '//real_text(body%law%ambient)//' everywhere: the '// &
               'grid feels what is above it (absorbing walls)')
    end if
    do i = 1, size(body%loads)
      if (body%loads(i)%kind /= load_blast .or. body%loads(i)%set > 1) cycle
      call put_blast(body%loads(i))
    end do
  end subroutine put_loads

  !> What an air blast does at the face nearest to its charge, in the units of the deck.
  subroutine put_blast(load)
    type(load_t), intent(in) :: load
    associate (wave => air_blast_wave(load%blast, load%blast%nearest), &
               distance => load%blast%nearest)
      call put('  blast     nearest face at '//real_text(distance)//' ('// &
               real_text(distance*load%blast%scale)//' m/kg^(1/3)): arrives at '// &
               real_text(wave(blast_arrival))//', lasts '//real_text(wave(blast_duration)))
      call put('            incident: peak '//real_text(wave(blast_incident))//', impulse '// &
               real_text(wave(blast_incident_impulse))//'; reflected head on: peak '// &
               real_text(wave(blast_reflected))//', impulse '// &
               real_text(wave(blast_reflected_impulse)))
    end associate
  end subroutine put_blast

  subroutine put_slot(column, text)
    integer, intent(in) :: column
    character(*), intent(in) :: text
    if (column > 0) call put('            '//text)
  end subroutine put_slot

  !> First step and what limits it.
  subroutine put_step(model)
    type(model_t), intent(in) :: model
    type(clock_t) :: clock
    logical :: ok
    clock = model%clock
    call clock_choose(clock, model%mesh%h, model%findings%fastest, huge(1.0_dp), ok)
    call put('time step   '//real_text(clock%dt)//' ('//trim(limit_names(clock%limited_by))// &
             ', c + |v| = '//real_text(model%findings%fastest)//' at '// &
             body_particle(model%bodies, model%findings%fastest_id)//')')
  end subroutine put_step

  !> How many steps there will be and how long they may take, by those of a trial.
  !! Contact, debris and split particles come later than the trial, and cost up to three times as
  !! much (doc/performance.md, What --check says).
  subroutine cost_estimate_write_time(trial, model, particles)
    type(trial_t), intent(in) :: trial
    type(model_t), intent(in) :: model
    integer(i8), intent(in) :: particles         !! of all ranks
    logical :: parts(size(model%bodies))         !! their particles may be parted
    integer :: threads, b
    threads = model%team%threads
    call put('steps       about '//integer_text(nint(trial%ahead, i8))//' (those tried have '// &
             real_text_about(trial%dt)//'), '// &
             real_text_about(trial%ahead*real(particles, dp))//' particle-steps')
    if (trial%steps < 2) return
    call put('run time    about '//real_text_about(trial%ahead*trial%seconds)//' s on '// &
             integer_text(threads)//' thread'//trim(merge('s', ' ', threads > 1))// &
             ', output not counted: '// &
             real_text_about(1.0e9_dp*trial%seconds/real(max(particles, 1_i8), dp))// &
             ' ns per particle-step in '//integer_text(trial%steps - 1)//' steps that were tried')
    parts = [(model%bodies(b)%law%slots%path > 0, b=1, size(model%bodies))]
    if (size(model%contact%pairs) > 0 .or. any(model%bodies%law%fails .or. parts)) then
      call put('            up to three times as long once bodies meet, break or spread')
    end if
  end subroutine cost_estimate_write_time

  !> What would make it cheaper, a line each.
  subroutine cost_estimate_write_advice(lines)
    type(string_t), intent(in) :: lines(:)
    integer :: i
    do i = 1, size(lines)
      call put('advice      '//lines(i)%text)
    end do
  end subroutine cost_estimate_write_advice

  subroutine put(text)
    character(*), intent(in) :: text
    write (output_unit, '(a)') text
  end subroutine put

  pure function bytes_text(bytes) result(text)
    integer(i8), intent(in) :: bytes
    character(:), allocatable :: text
    character(24) :: buffer
    write (buffer, '(f0.3)') real(bytes, dp)/1048576.0_dp
    if (buffer(1:1) == '.') buffer = '0'//buffer
    text = trim(buffer)//' MiB'
  end function bytes_text

end module sgmp_cost_estimate
