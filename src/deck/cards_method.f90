!> The cards `method`, `time` and `stop`: how and how long the scene is computed.
module sgmp_cards_method
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_kernels, only: kernel_sized, method_kernel, method_names, method_sgmp
  use sgmp_keys, only: kind_integer, kind_real, kind_word
  use sgmp_kinds, only: dp
  use sgmp_registry, only: registry_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_spelling, only: words_joined
  use sgmp_update, only: update_musl, update_names, update_usf
  implicit none
  private
  public :: register_method

contains

  !> Registers the cards of this group.
  subroutine register_method(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('method', 'Spatial discretisation and order of the update.', &
                       'method sgmp update=musl', read_method, check_method, once=.true.)
    call registry%key('kind', kind_word, 'discretisation', choices=words_joined(method_names), &
                      default=trim(method_names(method_sgmp)), slot=1, &
                      source='Kan, Liang and Zhang 2021, sections 2 to 4')
    call registry%key('update', kind_word, 'when the stress is updated: usf, first; usl, last; '// &
                      'musl (modified), last, with velocities that particles have given to '// &
                      'the nodes anew; usavg, half first and half last', &
                      choices=words_joined(update_names), &
                      default=trim(update_names(update_musl)), &
                      source='Kan, Liang and Zhang 2021, which recommends musl; '// &
                      'doc/theory.md, 2 and 6')
    call registry%key('flip', kind_real, 'part of the velocity taken from increments; 0 is '// &
                      'pure PIC', range='[0,1]', default='1')
    call registry%key('mass_cutoff', kind_real, &
                      'nodes lighter than this times the heaviest particle are ignored; '// &
                      'default: 1e-12, for gimp, cpgimp, bspline 1e-20 (weights end as a square)', &
                      range='[0,1)')
    call registry%key('stress', kind_word, 'quadrature of the stress: as in the paper, or '// &
                      'normalised by the volume that particles fill (sgmp only); auto: '// &
                      'normalised for solids, not beside absorbing walls or with self=yes', &
                      choices='auto plain normalised', default='auto', &
                      source='doc/normalised-stress.md')
    call registry%key('interior', kind_real, 'a cell is normalised where it and its '// &
                      'neighbours are filled beyond this fraction', range='[0,1)', default='0.25')
    call registry%key('volumes', kind_word, 'kept: the volumes of the particles stay those of '// &
                      'the space they fill, for explosives, and for gases that walls enclose '// &
                      '(sgmp; musl, usavg); auto: liquids move as they are strained; kept '// &
                      'where something burns beside other '// &
                      'matter, where gas is in another gas (not on a line) or only rigid '// &
                      'bodies are beside it, and where nothing but gas moves in a box of walls', &
                      choices='auto plain kept', default='auto', &
                      source='doc/volumes.md')
    call registry%key('hoop', kind_real, 'axisymmetric: correction C of the hoop strain next '// &
                      'to the axis; the default is that of particles anywhere, 1/12, of '// &
                      'liquids that of their lattice, 1/8 with two per cell (sgmp only)', &
                      range='[0,1]', &
                      source='doc/theory.md, 7')
    call registry%key('rotation', kind_word, &
      'exact: rigid rotation strains nothing and internal '// &
                      'forces have no moment, at free surfaces as well (sgmp only); auto: '// &
                      'exact for solids, beside friction where they are pressed on a body '// &
                      'or roll', &
                      choices='auto plain exact', default='auto', source='doc/rotation.md')
    call registry%key('surfaces', kind_word, 'corrected: strains are right at free surfaces '// &
                      'that lie at an angle to the grid (sgmp only); auto: corrected for '// &
                      'solids in plane and space where the rest of the deck allows it', &
                      choices='auto plain corrected', default='auto', source='doc/surfaces.md')
    call registry%key('mass', kind_word, 'of the nodes: lumped, as in the paper, or '// &
                      'consistent, with which waves do not run slow (solids, sgmp only); '// &
                      'auto: consistent for what springs back and meets nothing, with Courant '// &
                      'numbers up to 0.8', choices='auto lumped consistent', &
                      default='auto', source='doc/mass.md')
    call registry%key('drift', kind_word, 'velocity that moves particles: as in the paper that '// &
                      'of nodes after the kick, or the one that strains them, re-mapped '// &
                      'from the particles (musl, usavg); auto: re-mapped with sgmp for '// &
                      'solids whose stress is normalised', choices='auto plain remapped', &
                      default='auto', source='doc/surfaces.md')
    call registry%key('spin', kind_word, 'taken out: rotation=exact keeps what turns turning; '// &
                      'none is accepted, with a warning', choices='none carried', &
                      default='none', source='doc/rotation.md')
    call register_time(registry)
  end subroutine register_method

  subroutine register_time(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('time', 'Time integration; end or steps must be given.', &
                       'time end=80e-3 cfl=0.8', read_time, check_time, once=.true., &
                       needed='add an end, e.g. time end=1')
    call registry%key('end', kind_real, 'end time', unit='time', range='(0,inf)', free=.true.)
    call registry%key('cfl', kind_real, 'Courant number: dt = cfl*h/(c+|v|); auto: the largest '// &
                      'that is safe for the scheme on this scene', range='(0,inf)', &
                      choices='auto', default='0.5', free=.true., &
                      source='Kan, Liang and Zhang 2021, Eq. 69; doc/time-step.md')
    call registry%key('dt', kind_real, 'fixed time step instead of the Courant number', &
                      unit='time', range='(0,inf)')
    call registry%key('dt_min', kind_real, 'the run aborts below this step; default: 1e-6 of '// &
                      'the first', unit='time', range='(0,inf)')
    call registry%key('growth', kind_real, 'largest ratio of successive steps', range='[1,inf)', &
                      default='1.05')
    call registry%key('steps', kind_integer, 'stop after so many steps', range='[1,inf)', &
                      free=.true.)
    call registry%card('stop', 'Conditions that end a run early.', 'stop kinetic_below=0.01', &
                       read_stop, once=.true., free=.true.)
    call registry%key('energy_growth', kind_real, &
                      'abort when there is this many times the energy that the scene was '// &
                      'given, at the start or by external work; default: 1.1, and 10 in the '// &
                      'first twentieth of the run, its first 200 steps and with '// &
                      'update=usf', range='(1,inf)')
    call registry%key('kinetic_below', kind_real, &
                      'finish when the kinetic energy falls below this fraction of its maximum', &
                      range='[0,1)', default='0')
    call registry%key('at_rest', kind_real, &
                      'finish when the kinetic energy is below this fraction of kinetic and '// &
                      'internal energy', range='[0,1)', default='0')
    call registry%key('hold', kind_real, 'and has been for this long: longer than a vibration', &
                      unit='time', range='[0,inf)', default='0')
    call registry%key('after', kind_real, 'at_rest counts from this time on', unit='time', &
                      range='[0,inf)', default='0')
  end subroutine register_time

  subroutine read_method(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    associate (method => draft%scene%method)
      method%kind = card%pick('kind', method_names)
      method%update = card%pick('update', update_names)
      method%flip = card%number('flip')
      ! At the end of its support a GIMP weight is the square of its gradient: a node lighter by
      ! 1e-12 than a particle still carries 1e-6 of its force, and dropping that is felt in the
      ! momentum.
      if (kernel_sized(method_kernel(method%kind))) method%mass_cutoff = 1.0e-20_dp
      method%mass_cutoff = card%number('mass_cutoff', absent=method%mass_cutoff)
      method%normalised = card%word('stress') == 'normalised'
      method%normalised_auto = card%word('stress') == 'auto'
      method%rotation_auto = card%word('rotation') == 'auto'
      method%surfaces_auto = card%word('surfaces') == 'auto'
      method%interior = card%number('interior')
      method%volumes_kept = card%word('volumes') == 'kept'
      method%volumes_auto = card%word('volumes') == 'auto' .and. card%word('stress') /= 'plain'
      ! usf strains in another sweep than it moves.
      method%volumes_matched = method%kind == method_sgmp .and. method%update /= update_usf .and. &
                               (method%volumes_auto .or. method%volumes_kept)
      if (method%volumes_kept) method%normalised = .true.
      if (method%volumes_kept) method%normalised_auto = .false.
      method%hoop = card%number('hoop', absent=method%hoop)
      method%hoop_auto = .not. card%has('hoop')
      method%rotation = card%word('rotation') == 'exact'
      method%surfaces = card%word('surfaces') == 'corrected'
      method%drift_remapped = card%word('drift') == 'remapped'
      method%consistent = card%word('mass') == 'consistent'
      ! Who asks for the paper's stress or surfaces gets its mass.
      method%consistent_auto = card%word('mass') == 'auto' .and. &
                               card%word('stress') /= 'plain' .and. &
                               card%word('surfaces') /= 'plain'
      method%drift_auto = card%word('drift') == 'auto'
    end associate
  end subroutine read_method

  !> What goes with what is in `sgmp_combinations`.
  subroutine check_method(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    call check_spin(card, draft%errors)
  end subroutine check_method

  !> A word of former releases.
  subroutine check_spin(card, errors)
    type(deck_card_t), intent(in) :: card
    type(deck_errors_t), intent(inout) :: errors
    if (.not. card%values(card%at('spin'))%given) return
    if (card%word('spin') == 'carried') then
      call errors%add(card%place('spin'), 'spin=carried has been taken out: it damped bending '// &
                      'and rolled worse than rotation=exact', 'write rotation=exact instead')
    else
      call errors%warn(card%place('spin'), 'spin says nothing any more: nothing is carried', &
                       'remove it')
    end if
  end subroutine check_spin

  subroutine read_time(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    associate (time => draft%scene%time)
      time%location = card%position%text()
      time%end = card%number('end', absent=huge(1.0_dp))
      time%cfl = card%number('cfl')
      time%cfl_auto = card%has('cfl') .and. card%word('cfl') == 'auto'
      time%dt = card%number('dt')
      time%dt_min = card%number('dt_min')
      time%growth = card%number('growth')
      time%steps = card%whole('steps', absent=huge(1))
    end associate
  end subroutine read_time

  subroutine check_time(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    if (.not. (card%has('end') .or. card%has('steps'))) then
      call draft%errors%add(card%position, 'the time has no end', 'add end=… or steps=…')
    end if
    if (card%has('dt') .and. card%values(card%at('cfl'))%given) then
      call draft%errors%add(card%place('cfl'), 'both dt and cfl are given', &
                            'remove one of the two')
    end if
  end subroutine check_time

  subroutine read_stop(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%stop%energy_growth = card%number('energy_growth', absent=0.0_dp)
    draft%scene%stop%kinetic_below = card%number('kinetic_below')
    draft%scene%stop%at_rest = card%number('at_rest')
    draft%scene%stop%hold = card%number('hold')
    draft%scene%stop%after = card%number('after')
  end subroutine read_stop

end module sgmp_cards_method
