!> Functions of position and time written as text, evaluated by muParser.
!!
!! Variables are x, y, z (current position), x0, y0, z0 (initial position) and t, in axisymmetric
!! scenes r, z, r0, z0 and t; `pi` and the deck's parameters are
!! constants; upper and lower case are the same; both `^` and `**` mean power. muParser's own
!! functions are available.
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
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_funloc, &
    c_funptr, c_int, c_loc, &
                                         c_null_char, c_null_ptr, c_ptr
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kinds, only: dp, pi
  use sgmp_spelling, only: word_lower
!$ use omp_lib, only: omp_get_thread_num
  implicit none
  private
  public :: expression_t, expression_make, expression_constant, expression_clone, expression_free
  public :: expression_variables, expression_functions, expression_ring_variables

  integer, parameter :: longest_formula = 1500  !! muParser's messages end at 2048 letters
  !> Words that a parameter may not be called, because they mean something inside an expression.
  character(*), parameter :: expression_variables = 'x y z x0 y0 z0 t pi'
  character(*), parameter :: expression_ring_variables = 'r z r0 z0 t pi'  !! axisymmetric scenes
  character(*), parameter :: expression_functions = &
    'sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh log2 log10 log ln exp '// &
    'sqrt sign rint abs min max sum avg _pi _e'
  character(2), parameter :: variable_names(*) = ['x ', 'y ', 'z ', 'x0', 'y0', 'z0', 't ']
  character(2), parameter :: ring_names(*) = ['r ', 'z ', '  ', 'r0', 'z0', '  ', 't ']
  integer, parameter :: slots = 256
    !! threads beyond this number compile a parser for each evaluation

  !> One thread's parser with the variables it is bound to.
  type :: parser_t
    type(c_ptr) :: handle = c_null_ptr
    real(c_double) :: variables(size(variable_names)) = 0.0_c_double
  end type parser_t

  !> One thread's entry; empty until that thread first evaluates.
  type :: slot_t
    type(parser_t), pointer :: parser => null()
  end type slot_t

  !> What all plain copies of an expression share.
  type :: shared_t
    character(:), allocatable :: source                !! lower-case text with `**` written `^`
    character(2) :: variables(size(variable_names)) = variable_names  !! '' for none
    character(32), allocatable :: parameter_names(:)
    real(dp), allocatable :: parameter_values(:)
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
    procedure :: evaluate
  end type expression_t

  interface
    function mup_create(base_type) bind(c, name='mupCreate') result(handle)
      import :: c_int, c_ptr
      implicit none
      integer(c_int), value :: base_type
      type(c_ptr) :: handle
    end function mup_create
    subroutine mup_release(handle) bind(c, name='mupRelease')
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
    end subroutine mup_release
    subroutine mup_set_error_handler(handle, handler) bind(c, name='mupSetErrorHandler')
      import :: c_funptr, c_ptr
      implicit none
      type(c_ptr), value :: handle
      type(c_funptr), value :: handler
    end subroutine mup_set_error_handler
    subroutine mup_set_expr(handle, text) bind(c, name='mupSetExpr')
      import :: c_char, c_ptr
      implicit none
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: text(*)
    end subroutine mup_set_expr
    subroutine mup_define_var(handle, name, variable) bind(c, name='mupDefineVar')
      import :: c_char, c_ptr
      implicit none
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*)
      type(c_ptr), value :: variable
    end subroutine mup_define_var
    subroutine mup_define_const(handle, name, value) bind(c, name='mupDefineConst')
      import :: c_char, c_double, c_ptr
      implicit none
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: value
    end subroutine mup_define_const
    function mup_eval(handle) bind(c, name='mupEval') result(value)
      import :: c_double, c_ptr
      implicit none
      type(c_ptr), value :: handle
      real(c_double) :: value
    end function mup_eval
    function mup_eval_multi(handle, count) bind(c, name='mupEvalMulti') result(values)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), intent(out) :: count
      type(c_ptr) :: values
    end function mup_eval_multi
    function mup_error(handle) bind(c, name='mupError') result(failed)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int) :: failed
    end function mup_error
    function mup_get_error_pos(handle) bind(c, name='mupGetErrorPos') result(position)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int) :: position
    end function mup_get_error_pos
    function mup_get_error_token(handle) bind(c, name='mupGetErrorToken') result(token)
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
      type(c_ptr) :: token
    end function mup_get_error_token
    function mup_get_error_msg(handle) bind(c, name='mupGetErrorMsg') result(message)
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
      type(c_ptr) :: message
    end function mup_get_error_msg
    function mup_get_expr_var_num(handle) bind(c, name='mupGetExprVarNum') result(count)
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int) :: count
    end function mup_get_expr_var_num
    subroutine mup_get_expr_var(handle, number, name, variable) bind(c, name='mupGetExprVar')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: number
      type(c_ptr), intent(out) :: name, variable
    end subroutine mup_get_expr_var
  end interface

contains

  !> Compiles a text; on error the expression is zero and the message names the offending token.
  subroutine expression_make(expression, text, parameter_names, parameter_values, error, position, &
                             token, axisymmetric)
    type(expression_t), intent(out) :: expression
    character(*), intent(in) :: text                     !! e.g. `v0*sin(pi*x/L)`
    character(*), intent(in) :: parameter_names(:)       !! constants it may use
    real(dp), intent(in) :: parameter_values(:)          !! their values, same size
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out), optional :: position           !! column of the error in the text, from 1
    character(*), intent(out), optional :: token         !! the word that muParser stumbled over
    logical, intent(in), optional :: axisymmetric        !! variables are r and z
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
  end function expression_clone

  !> Releases the parsers; the expression becomes zero and its plain copies unusable. May be called
  !! twice on one copy.
  subroutine expression_free(expression)
    type(expression_t), intent(inout) :: expression
    integer :: i
    if (associated(expression%shared)) then
      do i = lbound(expression%shared%slot, 1), ubound(expression%shared%slot, 1)
        call parser_free(expression%shared%slot(i)%parser)
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
    type(parser_t), pointer :: parser
    integer :: thread
    if (self%is_constant) then
      value = self%value
      return
    end if
    thread = 0
!$  thread = omp_get_thread_num()
    if (thread < slots) then
      if (.not. associated(self%shared%slot(thread)%parser)) then
        call parser_make(self%shared%slot(thread)%parser, self%shared)
      end if
      parser => self%shared%slot(thread)%parser
    else
      call parser_make(parser, self%shared)
    end if
    parser%variables(1:3) = position
    parser%variables(4:6) = initial_position
    parser%variables(size(variable_names)) = time
    value = mup_eval(parser%handle)
    if (thread >= slots) call parser_free(parser)
  end function evaluate

  !> Compiles once, to find errors and the variables used.
  subroutine inspect(expression, error, position, token)
    type(expression_t), intent(inout) :: expression
    type(error_t), allocatable, intent(out) :: error
    integer, intent(inout), optional :: position
    character(*), intent(inout), optional :: token
    type(parser_t), pointer :: parser
    character(:), allocatable :: word
    integer(c_int) :: count
    integer :: at
    real(c_double), pointer :: values(:)
    type(c_ptr) :: address
    call parser_make(parser, expression%shared)
    address = mup_eval_multi(parser%handle, count)
    if (mup_error(parser%handle) /= 0) then
      word = fortran_text(mup_get_error_token(parser%handle))
      at = min(max(1, int(mup_get_error_pos(parser%handle)) + 1), len(expression%text) + 1)
      call error_make(error, exit_deck, explain(fortran_text(mup_get_error_msg(parser%handle)), &
                                                word))
      if (present(position)) position = at
      if (present(token)) token = word
    else if (count /= 1) then
      call error_make(error, exit_deck, 'one value expected, but the expression is a list')
    else
      call c_f_pointer(address, values, [count])
      expression%value = values(1)
      call find_variables(expression, parser%handle)
      if (expression%is_constant .and. .not. ieee_is_finite(expression%value)) then
        call error_make(error, exit_deck, "the value of '"//expression%text//"' is not a "// &
                        'finite number')
      end if
    end if
    call parser_free(parser)
  end subroutine inspect

  !> Which variables the compiled expression uses.
  subroutine find_variables(expression, handle)
    type(expression_t), intent(inout) :: expression
    type(c_ptr), intent(in) :: handle
    type(c_ptr) :: name, variable
    integer(c_int) :: i, n
    n = mup_get_expr_var_num(handle)
    expression%is_constant = n == 0
    do i = 0, n - 1
      call mup_get_expr_var(handle, i, name, variable)
      select case (fortran_text(name))
      case ('t')
        expression%uses_time = .true.
      case ('x0', 'y0', 'z0', 'r0')
        expression%uses_initial_position = .true.
      case default
        expression%uses_position = .true.
      end select
    end do
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

  !> Creates one parser bound to its own variables and the expression's constants.
  subroutine parser_make(parser, shared)
    type(parser_t), pointer, intent(out) :: parser
    type(shared_t), intent(in) :: shared
    integer :: i
    allocate (parser)
    !$omp critical (sgmp_expression_create)
    parser%handle = mup_create(0_c_int)
    call mup_set_error_handler(parser%handle, c_funloc(ignore_error))
    do i = 1, size(shared%variables)
      if (shared%variables(i) == '') cycle
      call mup_define_var(parser%handle, c_text(trim(shared%variables(i))), &
                          c_loc(parser%variables(i)))
    end do
    call mup_define_const(parser%handle, c_text('pi'), pi)
    do i = 1, size(shared%parameter_names)
      call mup_define_const(parser%handle, c_text(trim(shared%parameter_names(i))), &
                            shared%parameter_values(i))
    end do
    call mup_set_expr(parser%handle, c_text(shared%source))
    !$omp end critical (sgmp_expression_create)
  end subroutine parser_make

  !> Releases one parser, if there is one.
  subroutine parser_free(parser)
    type(parser_t), pointer, intent(inout) :: parser
    if (.not. associated(parser)) return
    if (c_associated(parser%handle)) call mup_release(parser%handle)
    deallocate (parser)
    parser => null()
  end subroutine parser_free

  !> muParser calls this instead of throwing; the error is asked for afterwards.
  subroutine ignore_error(handle) bind(c)
    type(c_ptr), value :: handle
    if (.not. c_associated(handle)) return
  end subroutine ignore_error

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

  !> A copy of a null-terminated text.
  function fortran_text(address) result(text)
    type(c_ptr), intent(in) :: address
    character(:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    integer, parameter :: longest = 10000
    integer :: i
    text = ''
    if (.not. c_associated(address)) return
    call c_f_pointer(address, letters, [longest])
    do i = 1, longest
      if (letters(i) == c_null_char) exit
      text = text//letters(i)
    end do
  end function fortran_text

end module sgmp_expression
