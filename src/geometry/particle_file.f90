!> Text files with a particle per line; # and ! begin comments.
!!
!! A first line of names says what the columns are, in any order: the axes of the space, volume,
!! velocities, id, material. Without it they are `x y z volume [velocity_x velocity_y velocity_z]`.
module sgmp_particle_file
  use sgmp_errors, only: error_make, error_t, exit_deck, exit_io
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_number_rows, only: number_looks_so, number_read, number_row_next, number_separators
  use sgmp_sorting, only: sort_order
  use sgmp_space, only: axis_names, space_dimensions
  use sgmp_spelling, only: string_t, suggestion, word_in_list, word_items, word_lower, &
                           word_position, words_joined
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: file_particles_t, material_choice_t, particle_file_columns, particle_file_names, &
            particle_file_read

  integer, parameter :: name_length = 16

  !> Which particles of a file a body takes, where the file says what each is made of.
  type :: material_choice_t
    character(:), allocatable :: material    !! those of this material
    character(:), allocatable :: others      !! blank-separated: what other bodies take from it
    character(:), allocatable :: known       !! blank-separated: all materials of the deck
    character(:), allocatable :: state       !! blank-separated: further columns of a file
  end type material_choice_t

  !> Particles of a file in its order, or in that of their ids where it gives some.
  type :: file_particles_t
    real(dp), allocatable :: position(:, :)  !! (3, n)
    real(dp), allocatable :: volume(:)       !! (n)
    real(dp), allocatable :: velocity(:, :)  !! (3, n), allocated if the file has velocities
    integer(i4), allocatable :: id(:)        !! (n) ascending; empty if the file has no ids
    character(name_length), allocatable :: names(:)  !! (columns) of the state
    real(dp), allocatable :: state(:, :)     !! (columns, n) what particles keep, at the start
  end type file_particles_t

  !> Quantities that a column may hold, behind the axes; the last are those of the state.
  integer, parameter :: in_volume = 4, in_velocity = 5, in_id = 8, in_material = 9
  integer, parameter :: in_line = 10         !! the line that a particle stands in
  integer, parameter :: in_state = 11, quantities = 40
  character(*), parameter :: particle_file_columns = &
    'x y z volume [velocity_x velocity_y velocity_z]'
  integer, parameter :: with_velocity = 7, without = 4  !! columns of a file without names

  !> What the columns of a file are.
  type :: columns_t
    integer :: ndim = 3                      !! axes of the space
    character(name_length) :: names(quantities) = ''
    integer :: place(quantities) = 0         !! column of each quantity, 0: not in the file
    integer :: known = in_line               !! quantities that have a name
    integer :: n = 0                         !! columns; 0: not known yet
  end type columns_t

  !> A line of a file.
  type :: line_t
    character(:), allocatable :: file, text
    integer :: number = 0
    integer :: words = 0
    integer :: first(quantities) = 0, last(quantities) = 0  !! letters of the first words
  end type line_t

  real(dp), parameter :: largest = 0.1_dp*huge(1.0_dp)
  character(*), parameter :: expected = 'expected: '//particle_file_columns// &
    ', volume > 0, or a first line that names the columns'

contains

  !> Reads the particles that a body takes; the whole file must be right.
  subroutine particle_file_read(file, place, space, choice, particles, error)
    character(*), intent(in) :: file, place  !! place: of the card that names it
    integer, intent(in) :: space             !! coordinates beyond its axes must be zero
    type(material_choice_t), intent(in) :: choice
    type(file_particles_t), intent(out) :: particles
    type(error_t), allocatable, intent(out) :: error
    type(columns_t) :: columns
    real(dp), allocatable :: rows(:, :)
    integer :: unit, status
    open (newunit=unit, file=file, status='old', action='read', iostat=status)
    if (status /= 0) then
      call error_make(error, exit_io, "the particle file '"//file//"' cannot be opened", &
                      'check its path', place)
      return
    end if
    columns%ndim = space_dimensions(space)
    columns%names(:3) = axis_names(:, space)
    columns%names(in_volume) = 'volume'
    columns%names(in_velocity:in_velocity + 2) = 'velocity_'//axis_names(:, space)
    columns%names(in_id) = 'id'
    columns%names(in_material) = 'material'
    call name_state(choice, columns)
    call read_rows(unit, file, choice, columns, rows, error)
    close (unit)
    if (allocated(error)) return
    if (columns%place(in_id) > 0) call order_by_id(file, rows, error)
    if (allocated(error)) return
    if (size(rows, 2) == 0) then
      call error_make(error, exit_deck, "the particle file '"//file//"' has no particles", &
                      'a line per particle: '//particle_file_columns, place)
    else if (columns%place(in_material) == 0 .and. choice%others /= '') then
      call error_make(error, exit_deck, 'several bodies take their particles from '//file// &
                      ', which does not say what each is made of', &
                      'name its columns in its first line, one of them material', place)
    else if (.not. any(rows(in_material, :) > 0.0_dp)) then
      call error_make(error, exit_deck, "the particle file '"//file//"' has no particles of "// &
                      "material '"//choice%material//"'", 'look at its column material', place)
    else
      call take_rows(rows, columns, particles)
    end if
  end subroutine particle_file_read

  !> Whether the first line of a file names its columns, so that a state may be among them.
  function particle_file_names(file) result(named)
    character(*), intent(in) :: file
    logical :: named
    type(line_t) :: line
    integer :: unit, status
    named = .false.
    open (newunit=unit, file=file, status='old', action='read', iostat=status)
    if (status /= 0) return
    do while (next_line(unit, line))
      if (line%words == 0) cycle
      named = .not. number_looks_so(word(line, 1))
      exit
    end do
    close (unit)
  end function particle_file_names

  !> Names of the columns of the state that a file may have.
  pure subroutine name_state(choice, columns)
    type(material_choice_t), intent(in) :: choice
    type(columns_t), intent(inout) :: columns
    type(string_t), allocatable :: names(:)
    integer :: q
    if (.not. allocated(choice%state)) return
    names = word_items(choice%state)
    do q = 1, size(names)
      columns%names(in_state + q - 1) = names(q)%text
    end do
    columns%known = in_line + size(names)
  end subroutine name_state

  !> The rows that a body takes as particles.
  pure subroutine take_rows(rows, columns, particles)
    real(dp), intent(in) :: rows(:, :)
    type(columns_t), intent(in) :: columns
    type(file_particles_t), intent(out) :: particles
    integer, allocatable :: taken(:), kept(:)
    integer :: p, q
    taken = pack([(p, p=1, size(rows, 2))], rows(in_material, :) > 0.0_dp)
    particles%position = rows(1:3, taken)
    particles%volume = rows(in_volume, taken)
    if (any(columns%place(in_velocity:in_velocity + 2) > 0)) then
      particles%velocity = rows(in_velocity:in_velocity + 2, taken)
    end if
    allocate (particles%id(0))
    if (columns%place(in_id) > 0) particles%id = nint(rows(in_id, taken), i4)
    kept = pack([(q, q=in_state, columns%known)], columns%place(in_state:columns%known) > 0)
    particles%names = columns%names(kept)
    particles%state = rows(kept, taken)
  end subroutine take_rows

  !> Puts rows into the order of their ids; an error where two have the same.
  subroutine order_by_id(file, rows, error)
    character(*), intent(in) :: file
    real(dp), intent(inout) :: rows(:, :)
    type(error_t), allocatable, intent(out) :: error
    integer, allocatable :: order(:)
    integer :: p, lines(2)
    allocate (order(size(rows, 2)))
    call sort_order(nint(rows(in_id, :), i8), order)
    rows = rows(:, order)
    do p = 2, size(order)
      if (rows(in_id, p) > rows(in_id, p - 1)) cycle
      lines = nint(rows(in_line, p - 1:p))
      call error_make(error, exit_deck, 'two particles have the id '// &
                      integer_text(nint(rows(in_id, p))), 'give each its own; the first is in '// &
                      'line '//integer_text(minval(lines)), &
                      file//':'//integer_text(maxval(lines))//':1')
      return
    end do
  end subroutine order_by_id

  !> All rows of a particle file: its quantities (material: 1 if the body takes it, else 0), line.
  subroutine read_rows(unit, file, choice, columns, rows, error)
    integer, intent(in) :: unit
    character(*), intent(in) :: file
    type(material_choice_t), intent(in) :: choice
    type(columns_t), intent(inout) :: columns
    real(dp), allocatable, intent(out) :: rows(:, :)  !! (quantities, n)
    type(error_t), allocatable, intent(out) :: error
    type(line_t) :: line
    real(dp) :: row(columns%known)
    logical :: named
    integer :: n
    allocate (rows(columns%known, 0))
    n = 0
    line%file = file
    do while (next_line(unit, line))
      if (line%words == 0) cycle
      if (columns%n == 0) then
        call choose_columns(line, columns, named, error)
        if (allocated(error)) return
        if (named) cycle
      end if
      call read_row(line, columns, row, error)
      if (allocated(error)) return
      call look_at_material(line, columns%place(in_material), choice, row(in_material), error)
      if (allocated(error)) return
      call grow(rows, n, n + 1)
      n = n + 1
      rows(:, n) = row
    end do
    rows = rows(:, :n)
  end subroutine read_rows

  !> What the first line says of the columns: by names, or by their number alone.
  subroutine choose_columns(line, columns, named, error)
    type(line_t), intent(in) :: line
    type(columns_t), intent(inout) :: columns
    logical, intent(out) :: named            !! it is no particle
    type(error_t), allocatable, intent(out) :: error
    integer :: w, q
    named = .not. number_looks_so(word(line, 1))
    if (.not. named) then
      columns%n = merge(with_velocity, without, line%words == with_velocity)
      columns%place(:columns%n) = [(q, q=1, columns%n)]
      return
    end if
    if (line%words > quantities) then
      call refuse(line, 1, 'there are '//integer_text(line%words)//' columns', &
                  'known are '//words_joined(known_names(columns)), error)
      return
    end if
    do w = 1, line%words
      q = word_position(word(line, w), columns%names(:columns%known))
      if (q == 0) then
        call refuse(line, w, "a particle has no '"//word(line, w)//"'", suggestion( &
                    word(line, w), word_items(words_joined(known_names(columns))), &
                    'columns'), error)
      else if (columns%place(q) > 0) then
        call refuse(line, w, "there are two columns '"//word(line, w)//"'", 'remove one', error)
      end if
      if (allocated(error)) return
      columns%place(q) = w
    end do
    columns%n = line%words
    do q = 1, in_volume
      if (columns%place(q) > 0 .or. (q > columns%ndim .and. q < in_volume)) cycle
      call refuse(line, 1, "there is no column '"//trim(columns%names(q))//"'", &
                  'particles have a place and a volume', error)
      return
    end do
  end subroutine choose_columns

  !> Names of all quantities that a column may hold.
  pure function known_names(columns) result(names)
    type(columns_t), intent(in) :: columns
    character(name_length), allocatable :: names(:)
    names = pack(columns%names(:columns%known), columns%names(:columns%known) /= '')
  end function known_names

  !> The numbers of a line, or why it is no particle.
  subroutine read_row(line, columns, row, error)
    type(line_t), intent(in) :: line
    type(columns_t), intent(in) :: columns
    real(dp), intent(out) :: row(:)
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: wrong
    integer :: q
    row = 0.0_dp
    row(in_line) = line%number
    if (line%words /= columns%n) then
      call refuse(line, 1, 'not a particle ('//integer_text(line%words)//' numbers, not '// &
                  integer_text(columns%n)//'): '//trim(line%text), expected, error)
      return
    end if
    do q = 1, columns%known
      if (columns%place(q) == 0 .or. q == in_material) cycle
      call number_read(word(line, columns%place(q)), row(q), wrong)
      if (wrong == '') wrong = objection(q, row(q), columns%ndim)
      if (wrong == '') cycle
      call refuse(line, columns%place(q), 'not a particle ('//wrong//'): '//trim(line%text), &
                  expected, error)
      return
    end do
  end subroutine read_row

  !> What is wrong with a quantity of a particle, nothing if it may be.
  pure function objection(quantity, value, ndim) result(text)
    integer, intent(in) :: quantity, ndim
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    text = ''
    if (quantity >= in_state .and. abs(value) <= largest) return
    if (.not. abs(value) <= largest) then
      text = 'a number is not finite'
    else if (quantity == in_volume) then
      if (value <= 0.0_dp) text = 'the volume is not positive'
    else if (quantity == in_id) then
      if (value < 0.0_dp .or. value > real(huge(1_i4), dp) .or. &
          abs(value - aint(value)) > 0.0_dp) then
        text = 'an id is a whole number from 0 to '//integer_text(huge(1_i4))
      end if
    else if (abs(value) > 0.0_dp .and. ndim < merge(quantity, quantity - in_velocity + 1, &
                                                    quantity < in_velocity)) then
      text = 'a component beyond the dimension is not 0'
    end if
  end function objection

  !> Whether the body takes the particle of a line; an error where no body does.
  subroutine look_at_material(line, column, choice, taken, error)
    type(line_t), intent(in) :: line
    integer, intent(in) :: column            !! 0: the file does not say
    type(material_choice_t), intent(in) :: choice
    real(dp), intent(out) :: taken           !! 1 or 0
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: name
    taken = 1.0_dp
    if (column == 0) return
    name = word_lower(word(line, column))
    if (name == choice%material) return
    taken = 0.0_dp
    if (word_in_list(name, choice%others) > 0) return
    if (word_in_list(name, choice%known) > 0) then
      call refuse(line, column, "no body takes the particles of material '"//name//"'", &
                  'add a card: body NAME file material='//name//' file="'//line%file//'"', error)
    else
      call refuse(line, column, "there is no material '"//name//"'", suggestion(name, &
                  word_items(choice%known), 'materials of the deck'), error)
    end if
  end subroutine look_at_material

  !> An error at a word of a line.
  subroutine refuse(line, at, message, remedy, error)
    type(line_t), intent(in) :: line
    integer, intent(in) :: at                !! number of the word
    character(*), intent(in) :: message, remedy
    type(error_t), allocatable, intent(out) :: error
    call error_make(error, exit_deck, message, remedy, line%file//':'// &
                    integer_text(line%number)//':'//integer_text(line%first(at)))
  end subroutine refuse

  !> The next line without its comment, split into words; false at the end of the file.
  function next_line(unit, line) result(there)
    integer, intent(in) :: unit
    type(line_t), intent(inout) :: line
    logical :: there
    there = number_row_next(unit, line%text)
    line%number = line%number + 1
    call find_words(line)
  end function next_line

  !> Finds the words of a line: counts all, notes where the first are.
  pure subroutine find_words(line)
    type(line_t), intent(inout) :: line
    integer :: first, last
    line%words = 0
    last = 0
    do
      first = verify(line%text(last + 1:), number_separators) + last
      if (first == last) return
      last = scan(line%text(first:)//' ', number_separators) + first - 2
      line%words = line%words + 1
      if (line%words > quantities) cycle
      line%first(line%words) = first
      line%last(line%words) = last
    end do
  end subroutine find_words

  !> A word of a line.
  pure function word(line, number) result(text)
    type(line_t), intent(in) :: line
    integer, intent(in) :: number
    character(:), allocatable :: text
    text = line%text(line%first(number):line%last(number))
  end function word

end module sgmp_particle_file
