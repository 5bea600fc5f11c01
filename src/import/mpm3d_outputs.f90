!> What an MPM3D deck wants to see, as native cards.
module sgmp_mpm3d_outputs
  use sgmp_import_notes, only: import_notes_t, note_approximated, note_honoured
  use sgmp_kinds, only: dp
  use sgmp_mpm3d_deck, only: mpm3d_deck_t, mpm3d_given, mpm3d_place, mpm3d_setting_t
  use sgmp_mpm3d_particles, only: cloud_t
  use sgmp_mpm3d_space, only: space_t
  use sgmp_native_deck, only: native_deck_t, native_vector
  use sgmp_spelling, only: word_in_list
  use sgmp_text, only: integer_text, real_text_tidy
  implicit none
  private
  public :: outputs_write

  character(*), parameter :: always = ' position velocity '             !! in every file
  character(*), parameter :: at_gauges = ' pressure von_mises position velocity energies '

contains

  !> Writes the cards output and gauge.
  subroutine outputs_write(deck, clouds, space, native, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    type(space_t), intent(in) :: space
    type(native_deck_t), intent(inout) :: native
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: fields, every
    call native%section('output')
    fields = ''
    call collect_fields(deck, fields, notes)
    if (fields /= '') fields = ' fields='//fields
    every = ''
    if (deck%interval < deck%end) every = ' every='//real_text_tidy(deck%interval)
    if (size(deck%outputs) > 0) call native%from(deck%outputs(1)%place)
    if (mpm3d_given(deck, 'para')) then
      call native%add('output vtu'//every//fields)
      call notes%add(note_honoured, mpm3d_place(deck, 'para'), 'para', &
                     'output vtu, without the grid')
    end if
    if (mpm3d_given(deck, 'tecp')) then
      call native%add('output tecplot'//every//fields)
      call notes%add(note_honoured, mpm3d_place(deck, 'tecp'), 'tecp', 'output tecplot')
    end if
    call native%add('output csv at=end'//fields)
    call write_gauges(deck, clouds, space, native)
    call note_others(deck, notes)
  end subroutine outputs_write

  !> The native field of a variable; '' where there is none.
  pure function field_of(variable) result(field)
    character(*), intent(in) :: variable
    character(:), allocatable :: field
    select case (variable)
    case ('seqv')
      field = 'von_mises'
    case ('epef')
      field = 'plastic_strain'
    case ('pres')
      field = 'pressure'
    case ('volu')
      field = 'volume'
    case ('velx', 'vely', 'velz')
      field = 'velocity'
    case ('cels')
      field = 'temperature'
    case ('damg', 'fail')
      field = 'damage'
    case ('stsx')
      field = 'stress'
    case ('disx', 'disy', 'disz')
      field = 'displacement'
    case ('engk', 'engi')
      field = 'energies'
    case default  ! mat, sspd
      field = ''
    end select
  end function field_of

  !> Fields that the deck asks for, each once, with a note for every request.
  subroutine collect_fields(deck, fields, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    character(:), allocatable, intent(inout) :: fields
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: field
    integer :: i
    do i = 1, size(deck%outputs)
      associate (setting => deck%outputs(i))
        field = field_of(setting%kind)
        call note_output(setting, field, notes)
        if (field == '' .or. field == 'energies') cycle
        if (index(always, ' '//field//' ') > 0) cycle
        if (index(','//fields//',', ','//field//',') > 0) cycle
        if (fields /= '') fields = fields//','
        fields = fields//field
      end associate
    end do
  end subroutine collect_fields

  subroutine note_output(setting, field, notes)
    type(mpm3d_setting_t), intent(in) :: setting
    character(*), intent(in) :: field
    type(import_notes_t), intent(inout) :: notes
    character(:), allocatable :: text
    integer :: status
    status = note_approximated
    select case (setting%kind)
    case ('mat')
      text = 'files have the number of the body instead of that of the material'
    case ('sspd')
      text = 'left out: there is no field of sound speeds'
    case ('fail')
      text = 'field damage: 1 is failed'
    case ('engk', 'engi')
      text = 'energies of all and of each body are in history.csv and bodies.csv'
    case default
      status = note_honoured
      text = 'field '//field
    end select
    if (setting%number /= 0 .and. index(at_gauges, ' '//field//' ') == 0 .and. &
        field /= 'displacement' .and. field /= '') then
      status = note_approximated
      text = text//' of the files of particles; gauges.csv has it not'
    else if (setting%number /= 0 .and. field /= '') then
      text = text//'; a gauge: gauges.csv'
    end if
    call notes%add(status, setting%place, trim(setting%kind), text)
  end subroutine note_output

  !> A gauge for every particle that a curve is asked of.
  subroutine write_gauges(deck, clouds, space, native)
    type(mpm3d_deck_t), intent(in) :: deck
    type(cloud_t), intent(in) :: clouds(:)
    type(space_t), intent(in) :: space
    type(native_deck_t), intent(inout) :: native
    character(:), allocatable :: done, name
    real(dp) :: point(3)
    integer :: i, b, points
    done = ''
    points = 0
    do i = 1, size(deck%outputs)
      associate (setting => deck%outputs(i))
        if (setting%number == 0) cycle
        if (setting%number > 0) then
          name = 'particle_'//integer_text(setting%number)
          do b = size(clouds), 1, -1
            if (clouds(b)%first <= setting%number) exit
          end do
          if (setting%number - clouds(b)%first + 1 > size(clouds(b)%mass)) cycle
          point = clouds(b)%position(:, setting%number - clouds(b)%first + 1)
        else
          points = points + 1
          name = 'point_'//integer_text(points)
          point = setting%value
        end if
        if (word_in_list(name, done) > 0) cycle
        done = done//' '//name
        call native%from(setting%place)
        call native%add('gauge '//name//' point='//native_vector(point(space%axes)))
      end associate
    end do
  end subroutine write_gauges

  subroutine note_others(deck, notes)
    type(mpm3d_deck_t), intent(in) :: deck
    type(import_notes_t), intent(inout) :: notes
    if (mpm3d_given(deck, 'outt')) call notes%add( &
      note_honoured, mpm3d_place(deck, 'outt'), 'outtime', 'every, for files of a series')
    if (mpm3d_given(deck, 'rptt')) call notes%add( &
      note_approximated, mpm3d_place(deck, 'rptt'), 'rpttime', &
      'the terminal reports by itself; history.csv has every step')
    if (mpm3d_given(deck, 'pt2d')) call notes%add( &
      note_approximated, mpm3d_place(deck, 'pt2d'), 'pt2d', 'all particles are written')
    if (mpm3d_given(deck, 'smoo')) call notes%add( &
      note_approximated, mpm3d_place(deck, 'smoo'), 'smooth', &
      'pressures are written as particles have them, not smoothed')
  end subroutine note_others

end module sgmp_mpm3d_outputs
