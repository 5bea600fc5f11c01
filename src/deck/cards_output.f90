!> The cards `output`, `history`, `gauge`, `checkpoint` and `balance`: what is written when, and how
!! ranks share the work.
module sgmp_cards_output
  use sgmp_deck_card, only: deck_card_t
  use sgmp_keys, only: kind_integer, kind_list, kind_name_word, kind_real, kind_vector, kind_word
  use sgmp_kinds, only: dp
  use sgmp_particle_fields, only: particle_field_names
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: dump_names, gauge_card_t, name_length
  use sgmp_scene_draft, only: draft_t, named_gauges
  use sgmp_spelling, only: word_count, word_in_list, word_item, word_position, words_joined
  implicit none
  private
  public :: register_output

  character(*), parameter :: always_written = 'id body position velocity'

contains

  !> Registers the cards of this group.
  subroutine register_output(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('output', 'Files of particles. vtkhdf (one file), vtu (a file per dump) '// &
                       'and tecplot: at the start, every so much time, each with an interval '// &
                       'of its own, and at the end; csv: particles_end.csv. The fields of all '// &
                       'such cards are in all files.', &
                       'output vtkhdf every=1e-3 fields=stress,pressure', read_output, &
                       selector='kind', free=.true.)
    call registry%key('kind', kind_word, 'format', choices=words_joined(dump_names)//' csv', &
                      slot=1, required=.true.)
    call registry%key('at', kind_word, 'when', choices='end', default='end', when='csv')
    call registry%key('every', kind_real, 'interval of time; default: start and end only', &
                      unit='time', range='(0,inf)', when=words_joined(dump_names))
    call registry%key('fields', kind_list, 'fields besides id, body, position and velocity, '// &
                      'which are always written', &
                      choices=particle_field_names()//' '//always_written)
    call registry%card('history', 'Rows of history.csv and bodies.csv.', 'history steps=10', &
                       read_history, once=.true., free=.true.)
    call registry%key('steps', kind_integer, 'a row every so many steps', range='[1,inf)', &
                      default='1')
    call registry%key('every', kind_real, 'a row every so much time instead: at the first step '// &
                      'at or after it', unit='time', range='(0,inf)')
    call registry%card('gauge', 'History of the particle nearest to a point at the start, or '// &
                       'of means over the particles around it, in gauges.csv.', &
                       'gauge foot point=(0,0,0) radius=1.5', read_gauge)
    call registry%key('name', kind_name_word, 'name in gauges.csv', slot=1, required=.true.)
    call registry%key('point', kind_vector, 'the point', unit='length', required=.true.)
    call registry%key('radius', kind_real, 'means over the particles within this distance of '// &
                      'the point, by volume; positions and velocities by mass', unit='length', &
                      range='(0,inf)')
    call registry%key('frame', kind_word, 'moving: the particles within the radius at the '// &
                      'start; fixed: those there at the time', choices='moving fixed', &
                      default='moving')
    call registry%key('fields', kind_list, 'fields besides pressure, von Mises stress and '// &
                      'density', choices='stress plastic_strain temperature damage energy '// &
                      'distention bulking compaction preconsolidation averaged_strain '// &
                      'afterburnt')
    call register_interrupts(registry)
  end subroutine register_output

  subroutine register_interrupts(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('checkpoint', 'Files checkpoint_NNNNNNN.h5, from which --restart goes '// &
                       'on. Without this card one is written only when a signal, the time '// &
                       'limit or the stop file ends the run; with it one more at the end.', &
                       'checkpoint every=1000 minutes=30', read_checkpoint, once=.true., &
                       free=.true.)
    call registry%key('every', kind_integer, 'after every so many steps (of output it is a '// &
                      'time)', range='[1,inf)')
    call registry%key('minutes', kind_real, 'after so many minutes of wall time', range='(0,inf)')
    call registry%key('keep', kind_integer, 'how many are kept', range='[1,inf)', default='2')
    call registry%card('balance', 'How work is divided anew among the ranks of a parallel run, '// &
                       'which changes no result.', 'balance every=100 gain=0.1', read_balance, &
                       once=.true., free=.true.)
    call registry%key('every', kind_integer, 'look after every so many steps; 0: never', &
                      range='[0,inf)', default='16')
    call registry%key('gain', kind_real, 'cut anew if the largest load shrinks by this part', &
                      range='[0,1)', default='0.05')
  end subroutine register_interrupts

  subroutine read_output(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    character(:), allocatable :: fields
    character(name_length) :: field
    integer :: format, i
    fields = card%word('fields')
    associate (output => draft%scene%output)
      format = word_position(card%word('kind'), dump_names)
      if (format == 0) then
        output%csv_end = .true.
      else
        output%writes(format) = .true.
        if (card%has('every')) call take_interval(output%every(format), card, draft)
      end if
      do i = 1, word_count(fields)
        field = word_item(fields, i)
        if (word_position(field, output%fields) > 0) cycle
        if (word_in_list(trim(field), always_written) > 0) cycle
        output%fields = [character(name_length) :: output%fields, field]
      end do
    end associate
  end subroutine read_output

  !> The interval of a format, which no other card may say otherwise.
  subroutine take_interval(every, card, draft)
    real(dp), intent(inout) :: every
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    if (every > 0.0_dp .and. abs(every - card%number('every')) > 0.0_dp) then
      call draft%errors%add(card%place('every'), 'two intervals for '//card%word('kind'), &
                            'another format may have another interval')
    end if
    every = card%number('every')
  end subroutine take_interval

  subroutine read_history(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%output%history_steps = card%whole('steps')
    draft%scene%output%history_every = card%number('every')
  end subroutine read_history

  subroutine read_gauge(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(gauge_card_t) :: new
    character(:), allocatable :: fields
    integer :: i
    if (.not. draft%new_name(card, named_gauges)) return
    new%name = card%word('name')
    new%point = card%vector('point')
    new%radius = card%number('radius')
    new%fixed = card%word('frame') == 'fixed'
    if (new%fixed .and. .not. card%has('radius')) then
      call draft%errors%add(card%place('frame'), 'a gauge that stays where it is needs a radius', &
                            'add radius=…, at least a cell')
    end if
    fields = card%word('fields')
    new%fields = [character(name_length) :: &
                  (word_item(fields, i), i=1, word_count(fields))]
    draft%gauges = draft%gauges + 1
    draft%scene%gauges(draft%gauges) = new
  end subroutine read_gauge

  subroutine read_checkpoint(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%checkpoint%every = card%whole('every')
    draft%scene%checkpoint%minutes = card%number('minutes')
    draft%scene%checkpoint%keep = card%whole('keep')
  end subroutine read_checkpoint

  subroutine read_balance(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%balance%every = card%whole('every')
    draft%scene%balance%gain = card%number('gain')
  end subroutine read_balance

end module sgmp_cards_output
