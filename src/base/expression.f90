!> Functions of position and time written as text, compiled by muParser and evaluated for all lanes
!! of a chunk at a time.
!!
!! Variables are x, y, z (current position), x0, y0, z0 (initial position) and t, in axisymmetric
!! scenes r, z, r0, z0 and t; `pi` and the deck's parameters are
!! constants; upper and lower case are the same; both `^` and `**` mean power. muParser's own
!! functions are available, and tables that are called by their names.
!!
!! An `expression_t` is a small value that shares its compiled parsers with every plain copy of
!! itself. Each OpenMP
!! thread of a team compiles and uses a parser of its own, so any copy may be evaluated from any
!! thread at the same time
!! (nested parallel regions excepted: clone there). One of the copies is freed with
!! `expression_free`, after the last use.
module sgmp_expression
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: ieee_exceptions, only: ieee_all, ieee_get_status, ieee_set_halting_mode, &
    ieee_set_status, ieee_status_type
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_int, c_null_char, &
                                         c_null_ptr, c_ptr
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kinds, only: dp, lanes, pi
  use sgmp_spelling, only: word_lower
!$ use omp_lib, only: omp_get_thread_num
  implicit none
  private
  public :: expression_t, expression_make, expression_constant, expression_clone, expression_free
  public :: table_t
  public :: expression_variables, expression_functions, expression_ring_variables
  public :: expression_places, expression_time

  integer, parameter :: longest_formula = 1500  !! muParser's messages end at 2048 letters
  !> Words that a parameter may not be called, because they mean something inside an expression.
  character(*), parameter :: expression_variables = 'x y z x0 y0 z0 t pi'
  character(*), parameter :: expression_ring_variables = 'r z r0 z0 t pi'  !! axisymmetric scenes
  character(*), parameter :: expression_functions = &
    'sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh log2 log10 log ln exp '// &
    'sqrt sign rint abs min max sum avg _pi _e'
  character(2), parameter :: variable_names(*) = ['x ', 'y ', 'z ', 'x0', 'y0', 'z0', 't ']
  character(2), parameter :: ring_names(*) = ['r ', 'z ', '  ', 'r0', 'z0', '  ', 't ']
  integer, parameter :: expression_places = size(variable_names)  !! numbers that a formula may use:
    !! current position, initial position, time
  integer, parameter :: expression_time = expression_places  !! the one of them that is the time
  integer, parameter :: slots = 256
    !! threads beyond this number compile a parser for each evaluation

  !> One thread's compiled formula; none until that thread first evaluates. Of one that depends on
  !! the time alone, its last value: it is asked for by every chunk of particles.
  type :: slot_t
    type(c_ptr) :: formula = c_null_ptr
    real(dp) :: time = 0.0_dp, value = 0.0_dp
    logical :: known = .false.
  end type slot_t

  !> A function that formulas call: linear between its rows, constant before the first and behind
  !! the last.
  type :: table_t
    character(32) :: name = ''
    real(dp), allocatable :: rows(:, :)                !! (argument|value, row), arguments ascend
  end type table_t

  !> What all plain copies of an expression share.
  type :: shared_t
    character(:), allocatable :: source                !! lower-case text with `**` written `^`
    character(2) :: variables(size(variable_names)) = variable_names  !! '' for none
    character(32), allocatable :: parameter_names(:)
    real(dp), allocatable :: parameter_values(:)
    type(table_t), allocatable :: tables(:)
    type(slot_t) :: slot(0:slots - 1)
  end type shared_t

  !> A function of position and time; without text it is zero.
  type :: expression_t
    character(:), allocatable :: text       !! as written by the user; not allocated: zero
    logical :: is_constant = .true.         !! independent of position and time
    real(dp) :: value = 0.0_dp              !! the value where `is_constant`
    logical :: uses_time = .false.          !! depends on t
    logical :: uses_position = .false.      !! depends on x, y or z
    logical :: uses_initial_position = .false.  !! depends on x0, y0 or z0
    type(shared_t), pointer, private :: shared => null()
  contains
    procedure :: evaluate, evaluate_lanes
  end type expression_t

  interface
    function formula_make() result(handle) bind(c, name='sgmp_formula_make')
      import :: c_ptr
      implicit none
      type(c_ptr) :: handle
    end function formula_make
    subroutine formula_free(handle) bind(c, name='sgmp_formula_free')
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
    end subroutine formula_free
    subroutine formula_variable(handle, name, number) bind(c, name='sgmp_formula_variable')
      import :: c_char, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), value :: number
    end subroutine formula_variable
    subroutine formula_constant(handle, name, value) bind(c, name='sgmp_formula_constant')
      import :: c_char, c_double, c_ptr
      implicit none
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: value
    end subroutine formula_constant
    !> A table as a function: its rows are copied.
    subroutine formula_table(handle, name, rows, count) bind(c, name='sgmp_formula_table')
      import :: c_char, c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), intent(in) :: rows(*)
      integer(c_int), value :: count
    end subroutine formula_table
    !> How many values the text has, where all variables are zero, and the first; 0: an error, with
    !! muParser's message, the word that it stumbled over and its column.
    function formula_compile(handle, text, value, message, message_length, token, token_length, &
                             position) result(count) bind(c, name='sgmp_formula_compile')
      import :: c_char, c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: text(*)
      real(c_double), intent(out) :: value
      character(kind=c_char), intent(out) :: message(*), token(*)
      integer(c_int), value :: message_length, token_length
      integer(c_int), intent(out) :: position
      integer(c_int) :: count
    end function formula_compile
    function formula_uses(handle, number) result(uses) bind(c, name='sgmp_formula_uses')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: number
      integer(c_int) :: uses
    end function formula_uses
    !> Values in n lanes, whose numbers count from 0.
    subroutine formula_values(handle, places, lane, n, values) bind(c, name='sgmp_formula_values')
      import :: c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: places(*)
      integer(c_int), intent(in) :: lane(*)
      integer(c_int), value :: n
      real(c_double), intent(inout) :: values(*)
    end subroutine formula_values
  end interface

contains

  !> Compiles a text; on error the expression is zero and the message names the offending token.
  subroutine expression_make(expression, text, parameter_names, parameter_values, error, position, &
                             token, axisymmetric, tables)
    type(expression_t), intent(out) :: expression
    character(*), intent(in) :: text                     !! e.g. `v0*sin(pi*x/L)`
    character(*), intent(in) :: parameter_names(:)       !! constants it may use
    real(dp), intent(in) :: parameter_values(:)          !! their values, same size
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out), optional :: position           !! column of the error in the text, from 1
    character(*), intent(out), optional :: token         !! the word that muParser stumbled over
    logical, intent(in), optional :: axisymmetric        !! variables are r and z
    type(table_t), intent(in), optional :: tables(:)     !! functions it may use
    type(ieee_status_type) :: status
    integer :: i
    expression%text = text
    if (present(position)) position = 1
    if (present(token)) token = ''
    if (len_trim(text) == 0) then
      call error_make(error, exit_deck, 'empty expression', 'write a number or a formula')
      return
    end if
    if (len(text) > longest_formula) then
      call error_make(error, exit_deck, 'the formula is too long', &
                      'put parts of it into parameters')
      return
    end if
    allocate (expression%shared)
    expression%shared%source = muparser_source(text)
    if (present(axisymmetric)) then
      if (axisymmetric) expression%shared%variables = ring_names
    end if
    allocate (expression%shared%parameter_names(size(parameter_names)))
    do i = 1, size(parameter_names)
      expression%shared%parameter_names(i) = word_lower(parameter_names(i))
    end do
    expression%shared%parameter_values = parameter_values
    allocate (expression%shared%tables(0))
    if (present(tables)) expression%shared%tables = tables
    call ieee_get_status(status)  ! trial values may lie outside the formula's domain
    call ieee_set_halting_mode(ieee_all, .false.)
    call inspect(expression, error, position, token)
    call ieee_set_status(status)
    if (allocated(error)) then
      call expression_free(expression)
      expression%text = text
    end if
  end subroutine expression_make

  !> A constant.
  function expression_constant(value) result(expression)
    real(dp), intent(in) :: value
    type(expression_t) :: expression
    character(32) :: buffer
    write (buffer, '(es24.16e3)') value
    expression%text = trim(adjustl(buffer))
    expression%value = value
  end function expression_constant

  !> A copy that shares nothing with the original.
  function expression_clone(expression) result(clone)
    type(expression_t), intent(in) :: expression
    type(expression_t) :: clone
    clone = expression
    if (.not. associated(expression%shared)) return
    allocate (clone%shared)
    clone%shared%source = expression%shared%source
    clone%shared%variables = expression%shared%variables
    clone%shared%parameter_names = expression%shared%parameter_names
    clone%shared%parameter_values = expression%shared%parameter_values
    clone%shared%tables = expression%shared%tables
  end function expression_clone

  !> Releases the parsers; the expression becomes zero and its plain copies unusable. May be called
  !! twice on one copy.
  subroutine expression_free(expression)
    type(expression_t), intent(inout) :: expression
    integer :: i
    if (associated(expression%shared)) then
      do i = lbound(expression%shared%slot, 1), ubound(expression%shared%slot, 1)
        if (c_associated(expression%shared%slot(i)%formula)) then
          call formula_free(expression%shared%slot(i)%formula)
        end if
      end do
      deallocate (expression%shared)
    end if
    expression%shared => null()
    if (allocated(expression%text)) deallocate (expression%text)
    expression%is_constant = .true.
    expression%value = 0.0_dp
    expression%uses_time = .false.
    expression%uses_position = .false.
    expression%uses_initial_position = .false.
  end subroutine expression_free

  !> The value at a point and time; not finite where the formula is not.
  function evaluate(self, position, initial_position, time) result(value)
    class(expression_t), intent(in) :: self
    real(dp), intent(in) :: position(3)         !! x, y, z; r, z
    real(dp), intent(in) :: initial_position(3)  !! x0, y0, z0; r0, z0
    real(dp), intent(in) :: time                !! t
    real(dp) :: value
    real(dp) :: places(lanes, expression_places), values(lanes)
    integer :: lane, thread
    value = self%value
    if (self%is_constant) return
    thread = 0
!$  thread = omp_get_thread_num()
    if (thread < slots .and. .not. (self%uses_position .or. self%uses_initial_position)) then
      value = value_at(self%shared, thread, time)
      return
    end if
    places = 0.0_dp
    places(1, :3) = position
    places(1, 4:6) = initial_position
    places(1, expression_time) = time
    call self%evaluate_lanes(places, [(lane == 1, lane=1, lanes)], values)
    value = values(1)
  end function evaluate

  !> The value of a formula that depends on the time alone.
  function value_at(shared, thread, time) result(value)
    type(shared_t), intent(inout) :: shared
    integer, intent(in) :: thread
    real(dp), intent(in) :: time
    real(dp) :: value
    real(dp) :: places(lanes, expression_places), values(lanes)
    associate (slot => shared%slot(thread))
      if (.not. (slot%known .and. abs(time - slot%time) <= 0.0_dp)) then
        if (.not. c_associated(slot%formula)) call formula_bind(slot%formula, shared)
        places = 0.0_dp
        places(1, expression_time) = time
        call formula_values(slot%formula, places, [0_c_int], 1_c_int, values)
        slot%value = values(1)
        slot%time = time
        slot%known = .true.
      end if
      value = slot%value
    end associate
  end function value_at

  !> The values in those lanes that are wanted; zero in the others.
  subroutine evaluate_lanes(self, places, wanted, values)
    class(expression_t), intent(in) :: self
    real(dp), intent(in) :: places(lanes, expression_places)
    logical, intent(in) :: wanted(lanes)
    real(dp), intent(out) :: values(lanes)
    type(c_ptr) :: formula
    integer(c_int) :: chosen(lanes)
    integer :: thread, lane, n
    values = merge(self%value, 0.0_dp, wanted)
    if (self%is_constant) return
    n = 0
    do lane = 1, lanes
      if (.not. wanted(lane)) cycle
      n = n + 1
      chosen(n) = int(lane - 1, c_int)
    end do
    thread = 0
!$  thread = omp_get_thread_num()
    if (thread < slots) then
      if (.not. c_associated(self%shared%slot(thread)%formula)) then
        call formula_bind(self%shared%slot(thread)%formula, self%shared)
      end if
      formula = self%shared%slot(thread)%formula
    else
      call formula_bind(formula, self%shared)
    end if
    call formula_values(formula, places, chosen, int(n, c_int), values)
    if (thread >= slots) call formula_free(formula)
  end subroutine evaluate_lanes

  !> Compiles once, to find errors and the variables used.
  subroutine inspect(expression, error, position, token)
    type(expression_t), intent(inout) :: expression
    type(error_t), allocatable, intent(out) :: error
    integer, intent(inout), optional :: position
    character(*), intent(inout), optional :: token
    type(c_ptr) :: formula
    character(2048) :: message
    character(256) :: word
    integer(c_int) :: count, at
    call formula_bind(formula, expression%shared, count, expression%value, message, word, at)
    if (count == 0) then
      call error_make(error, exit_deck, explain(trim(message), trim(word)))
      if (present(position)) position = min(max(1, int(at)), len(expression%text) + 1)
      if (present(token)) token = word
    else if (count /= 1) then
      call error_make(error, exit_deck, 'one value expected, but the expression is a list')
    else
      call find_variables(expression, formula)
      if (expression%is_constant .and. .not. ieee_is_finite(expression%value)) then
        call error_make(error, exit_deck, "the value of '"//expression%text//"' is not a "// &
                        'finite number')
      end if
    end if
    call formula_free(formula)
  end subroutine inspect

  !> Which variables the compiled expression uses.
  subroutine find_variables(expression, formula)
    type(expression_t), intent(inout) :: expression
    type(c_ptr), intent(in) :: formula
    logical :: used(expression_places)
    integer :: i
    used = [(formula_uses(formula, int(i, c_int)) /= 0, i=1, expression_places)]
    expression%is_constant = .not. any(used)
    expression%uses_position = any(used(1:3))
    expression%uses_initial_position = any(used(4:6))
    expression%uses_time = used(expression_time)
  end subroutine find_variables

  !> muParser's message in this program's words.
  pure function explain(message, token) result(text)
    character(*), intent(in) :: message, token
    character(:), allocatable :: text
    if (index(message, 'Unexpected token') == 1 .and. len(token) > 0) then
      text = "unexpected '"//token//"' in the expression"
    else
      text = message
    end if
  end function explain

  !> Compiles a formula with variables of its own; how many values it has, the first, and what is
  !! wrong with it if it has none.
  subroutine formula_bind(formula, shared, count, value, message, word, position)
    type(c_ptr), intent(out) :: formula
    type(shared_t), intent(in) :: shared
    integer(c_int), intent(out), optional :: count, position
    real(dp), intent(out), optional :: value
    character(*), intent(out), optional :: message, word
    character(2048) :: found
    character(256) :: token
    integer(c_int) :: values, at
    real(dp) :: first
    integer :: i
    !$omp critical (sgmp_expression_create)
    formula = formula_make()
    do i = 1, size(shared%variables)
      if (shared%variables(i) == '') cycle
      call formula_variable(formula, c_text(trim(shared%variables(i))), int(i, c_int))
    end do
    call formula_constant(formula, c_text('pi'), pi)
    do i = 1, size(shared%parameter_names)
      call formula_constant(formula, c_text(trim(shared%parameter_names(i))), &
                            shared%parameter_values(i))
    end do
    do i = 1, size(shared%tables)
      associate (table => shared%tables(i))
        call formula_table(formula, c_text(trim(table%name)), table%rows, &
                           size(table%rows, 2, c_int))
      end associate
    end do
    values = formula_compile(formula, c_text(shared%source), first, found, len(found, c_int), &
                             token, len(token, c_int), at)
    !$omp end critical (sgmp_expression_create)
    if (present(count)) count = values
    if (present(value)) value = first
    if (present(message)) message = found
    if (present(word)) word = token
    if (present(position)) position = at
  end subroutine formula_bind

  !> The text as muParser reads it; `**` becomes ` ^` so that columns stay the same.
  pure function muparser_source(text) result(source)
    character(*), intent(in) :: text
    character(len(text)) :: source
    integer :: i
    source = word_lower(text)
    do i = 1, len(source) - 1
      if (source(i:i + 1) == '**') source(i:i + 1) = ' ^'
    end do
  end function muparser_source

  !> A null-terminated text.
  pure function c_text(text) result(array)
    character(*), intent(in) :: text
    character(kind=c_char) :: array(len(text) + 1)
    integer :: i
    do i = 1, len(text)
      array(i) = text(i:i)
    end do
    array(len(text) + 1) = c_null_char
  end function c_text

end module sgmp_expression
