!> The deck's parameters: numbers for expressions, words for `$name`, and their replacement from the
!! command line.
module sgmp_parameters
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_errors, only: error_t
  use sgmp_expression, only: expression_free, expression_functions, expression_make, &
                             expression_ring_variables, expression_t, expression_variables, table_t
  use sgmp_kinds, only: dp
  use sgmp_lexer, only: token_t
  use sgmp_spelling, only: string_t, suggestion, word_count, word_in_list, word_is_identifier, &
                        word_item, word_lower, word_nearest
  use sgmp_text, only: integer_text, real_text_plain
  implicit none
  private
  public :: parameters_t, name_size

  real(dp), parameter :: largest = 1.0e60_dp  !! so that products of a few numbers do not overflow
  integer, parameter :: name_size = 32  !! longest name of a parameter
  integer, parameter :: longest_text = 10000  !! of a value once its `$names` are replaced

  !> One parameter: a number, or a word where `is_word`.
  type :: parameter_t
    character(name_size) :: name = ''
    logical :: is_word = .false.
    logical :: used = .false.
    real(dp) :: value = 0.0_dp
    character(:), allocatable :: text  !! the word, or the number as text
    type(position_t) :: position
  end type parameter_t

  !> One `--set NAME=VALUE`.
  type :: setting_t
    character(:), allocatable :: name, value
    logical :: used = .false.
    type(position_t) :: position
  end type setting_t

  !> One table that formulas call.
  type, extends(table_t) :: named_table_t
    logical :: used = .false.
    type(position_t) :: position
  end type named_table_t

  !> All parameters and tables defined so far.
  type :: parameters_t
    type(parameter_t), allocatable :: list(:)
    type(setting_t), allocatable :: settings(:)
    type(named_table_t), allocatable :: tables(:)
    logical :: axisymmetric = .false.  !! formulas are functions of r and z
  contains
    procedure :: start
    procedure :: define
    procedure :: define_table
    procedure :: substitute
    procedure :: make_expression
    procedure :: number
    procedure :: check_use
    procedure :: find
    procedure :: names
  end type parameters_t

contains

  !> Takes the command line's settings, each `NAME=VALUE`.
  subroutine start(self, settings, errors)
    class(parameters_t), intent(out) :: self
    character(*), intent(in) :: settings(:)
    type(deck_errors_t), intent(inout) :: errors
    integer :: i, k, equals
    allocate (self%list(0), self%tables(0))
    allocate (self%settings(size(settings)))
    do i = 1, size(settings)
      associate (setting => self%settings(i))
        equals = index(settings(i), '=')
        setting%position%file = '--set'
        setting%position%line = 1
        setting%position%column = 1
        setting%position%source = trim(settings(i))
        setting%name = word_lower(trim(adjustl(settings(i) (:max(0, equals - 1)))))
        setting%value = trim(adjustl(settings(i) (equals + 1:)))
        if (equals == 0 .or. setting%name == '' .or. setting%value == '') then
          call errors%add(setting%position, 'a setting must be NAME=VALUE', 'e.g. --set h=0.5')
          setting%used = .true.
        end if
        do k = 1, i - 1
          if (self%settings(k)%name /= setting%name .or. setting%used) cycle
          call errors%add(setting%position, "'"//setting%name//"' is set twice", &
                          'remove one of the two')
          setting%used = .true.
        end do
      end associate
    end do
  end subroutine start

  !> Defines a parameter from the tokens of `parameter name = value`, or from the command line's
  !! value.
  subroutine define(self, name, value, errors)
    class(parameters_t), intent(inout) :: self
    type(token_t), intent(in) :: name, value
    type(deck_errors_t), intent(inout) :: errors
    type(parameter_t) :: new, from_deck
    integer :: i
    if (.not. name_allowed(self, name%text, name%position, 'parameter', errors)) return
    call interpret(self, name, value%text, value%quoted, value%position, new, errors)
    do i = 1, size(self%settings)
      if (self%settings(i)%name /= new%name .or. self%settings(i)%used) cycle
      self%settings(i)%used = .true.
      from_deck = new
      call interpret(self, name, self%settings(i)%value, .false., self%settings(i)%position, new, &
                     errors)
      ! `auto` stands for a number that the program finds; the key it goes to says if it may.
      if (new%is_word .and. .not. from_deck%is_word .and. &
          self%settings(i)%value /= 'auto') then
        call errors%add(self%settings(i)%position, &
                        "'"//trim(new%name)//"' is a number in the deck, '"// &
                        self%settings(i)%value//"' is not", 'give a number')
        new = from_deck
      end if
    end do
    self%list = [self%list, new]
  end subroutine define

  !> Defines a table.
  subroutine define_table(self, name, position, rows, errors)
    class(parameters_t), intent(inout) :: self
    character(*), intent(in) :: name
    type(position_t), intent(in) :: position     !! of the name
    real(dp), intent(in) :: rows(:, :)           !! (argument|value, row), arguments ascend
    type(deck_errors_t), intent(inout) :: errors
    type(named_table_t) :: new
    if (.not. name_allowed(self, name, position, 'table', errors)) return
    new%name = name
    new%rows = rows
    new%position = position
    self%tables = [self%tables, new]
  end subroutine define_table

  !> Whether a parameter or table may have this name.
  logical function name_allowed(self, name, position, what, errors) result(allowed)
    class(parameters_t), intent(in) :: self
    character(*), intent(in) :: name
    type(position_t), intent(in) :: position
    character(*), intent(in) :: what             !! is named
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: lower
    integer :: table
    lower = word_lower(name)
    table = findloc(self%tables%name == lower, .true., 1)
    allowed = .false.
    if (.not. word_is_identifier(lower) .or. len(lower) > name_size) then
      call errors%add(position, "'"//name//"' cannot name a "//what, &
                      'a name is a letter, then letters, digits and underscores, 32 at most')
    else if (word_in_list(lower, variables(self)) > 0 .or. &
             word_in_list(lower, expression_functions) > 0) then
      call errors%add(position, "'"//name//"' already means something in expressions", &
                      'choose another name')
    else if (self%find(lower) > 0) then
      call errors%add(position, what//" '"//name//"' is defined twice", &
                      'first defined at '//self%list(self%find(lower))%position%text())
    else if (table > 0) then
      call errors%add(position, what//" '"//name//"' is defined twice", &
                      'first defined at '//self%tables(table)%position%text())
    else
      allowed = .true.
    end if
  end function name_allowed

  !> A number where the text is one, else a word; a bare text that is neither is an error.
  subroutine interpret(self, name, raw, quoted, position, new, errors)
    class(parameters_t), intent(inout) :: self
    type(token_t), intent(in) :: name
    character(*), intent(in) :: raw
    logical, intent(in) :: quoted
    type(position_t), intent(in) :: position
    type(parameter_t), intent(out) :: new
    type(deck_errors_t), intent(inout) :: errors
    type(expression_t) :: expression
    type(error_t), allocatable :: error
    character(:), allocatable :: text
    new%name = word_lower(name%text)
    new%position = name%position
    text = self%substitute(raw, position, errors)
    call try_expression(self, text, expression, error)
    if (.not. allocated(error) .and. expression%is_constant) then
      call mark_used(self, text)
      new%value = expression%value
      new%text = real_text_plain(new%value)
    else
      new%is_word = .true.
      new%text = text
      if (.not. (quoted .or. is_plain_word(text))) then
        if (allocated(error)) then
          call errors%add(position, "bad value '"//text//"': "//error%message, &
                          'give a number, a formula of numbers and earlier parameters, or a word')
        else
          call errors%add(position, "the value '"//text//"' depends on position or time", &
                          'put a formula that is to be used as $'//trim(new%name)//' in quotes')
        end if
      end if
    end if
    call expression_free(expression)
  end subroutine interpret

  !> Letters, digits, underscores, dots and dashes, beginning with a letter: a word without quotes.
  pure logical function is_plain_word(text) result(yes)
    character(*), intent(in) :: text
    integer :: i
    yes = .false.
    if (len(text) == 0) return
    if (.not. word_is_identifier(text(1:1))) return
    if (scan(word_lower(text), 'nN') == 1 .and. word_lower(text) == 'nan') return
    if (word_lower(text) == 'inf' .or. word_lower(text) == 'infinity') return
    do i = 1, len(text)
      if (.not. (word_is_identifier('_'//text(i:i)) .or. scan(text(i:i), '.-') > 0)) return
    end do
    yes = .true.
  end function is_plain_word

  !> Replaces `$name` and `${name}` by the parameter's text.
  function substitute(self, text, position, errors) result(replaced)
    class(parameters_t), intent(inout) :: self
    character(*), intent(in) :: text
    type(position_t), intent(in) :: position  !! of the text's first letter
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: replaced, name
    integer :: dollar, next, number
    replaced = ''
    next = 1
    do
      dollar = index(text(next:), '$')
      if (dollar == 0) exit
      if (len(replaced) > longest_text) then
        call errors%add(position, "what '"//text//"' stands for has more than "// &
                        integer_text(longest_text)//' letters', &
                        'do parameters stand in each other again and again?')
        replaced = ''
        return
      end if
      dollar = dollar + next - 1
      replaced = replaced//text(next:dollar - 1)
      call name_after_dollar(text, dollar, name, next)
      number = self%find(word_lower(name))
      if (number > 0) then
        self%list(number)%used = .true.
        replaced = replaced//self%list(number)%text
      else
        call errors%add(moved(position, dollar - 1), "there is no parameter '"//name//"'", &
                        suggestion(name, self%names(), 'parameters'))
      end if
    end do
    replaced = replaced//text(next:)
  end function substitute

  !> The name after a dollar sign, in braces or not; `next` is the column after it.
  pure subroutine name_after_dollar(text, dollar, name, next)
    character(*), intent(in) :: text
    integer, intent(in) :: dollar
    character(:), allocatable, intent(out) :: name
    integer, intent(out) :: next
    integer :: first
    first = dollar + 1
    if (text(first:min(first, len(text))) == '{') then
      next = index(text(first:)//'}', '}') + first
      name = text(first + 1:min(next - 2, len(text)))
      next = min(next, len(text) + 1)
      return
    end if
    do next = first, len(text)
      if (.not. word_is_identifier('_'//text(next:next))) exit
    end do
    name = text(first:next - 1)
  end subroutine name_after_dollar

  !> Compiles an expression; errors name the token, its column and the nearest known name.
  subroutine make_expression(self, text, position, expression, failed, errors)
    class(parameters_t), intent(inout) :: self
    character(*), intent(in) :: text
    type(position_t), intent(in) :: position  !! of the text's first letter
    type(expression_t), intent(out) :: expression
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    type(error_t), allocatable :: error
    character(:), allocatable :: token, remedy
    character(2*name_size) :: word
    integer :: column, known
    call try_expression(self, text, expression, error, column, word)
    token = trim(word)
    call mark_used(self, text)
    failed = allocated(error)
    if (.not. failed) return
    remedy = error%remedy
    known = self%find(word_lower(token))
    if (known > 0) then
      if (self%list(known)%is_word) then
        error%message = "parameter '"//token//"' is the word '"//self%list(known)%text//"', "// &
          'not a number'
        remedy = 'use it as $'//token
      end if
    else if (word_is_identifier(token) .and. .not. follows_digit(text, column) .and. &
             word_in_list(word_lower(token), 'nan inf infinity') == 0) then
      remedy = correction(self, word_lower(token))
    end if
    if (remedy == '') remedy = 'numbers are written like 12, 1.5e-3 or h/2, and must be finite'
    call errors%add(moved(position, column - 1), "'"//text//"': "//error%message, remedy)
  end subroutine make_expression

  !> What to write in the place of a word that a formula cannot have there: one that is spelt nearly
  !! so, or, where it is right as it is, what it needs; nothing where that is not known.
  pure function correction(self, word) result(remedy)
    class(parameters_t), intent(in) :: self
    character(*), intent(in) :: word             !! in lower case
    character(:), allocatable :: remedy
    remedy = word_nearest(word, known_names(self))
    if (remedy == '') return
    if (remedy /= word) then
      remedy = "did you mean '"//remedy//"'?"
    else if (word_in_list(word, expression_functions) > 0 .or. any(self%tables%name == word)) then
      remedy = "'"//word//"' is a function: write "//word//'(…), with what it is a function of'
    else
      remedy = ''
    end if
  end function correction

  !> Whether the word at a column is glued to a digit, as in `12abc`.
  pure function follows_digit(text, column) result(yes)
    character(*), intent(in) :: text
    integer, intent(in) :: column
    logical :: yes
    yes = .false.
    if (column < 2 .or. column > len(text)) return
    yes = scan(text(column - 1:column - 1), '0123456789.') > 0
  end function follows_digit

  !> The value of a constant expression.
  subroutine number(self, text, position, value, failed, errors)
    class(parameters_t), intent(inout) :: self
    character(*), intent(in) :: text
    type(position_t), intent(in) :: position
    real(dp), intent(out) :: value
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    type(expression_t) :: expression
    call self%make_expression(text, position, expression, failed, errors)
    value = expression%value
    if (.not. failed .and. .not. expression%is_constant) then
      failed = .true.
      value = 0.0_dp
      call errors%add(position, "'"//text//"' depends on position or time", &
                      'a number is expected here')
    end if
    if (.not. failed .and. abs(value) > 0.0_dp .and. &
        (abs(value) > largest .or. abs(value) < 1.0_dp/largest)) then
      failed = .true.
      call errors%add(position, "'"//text//"' = "//real_text_plain(value)// &
                      ' is beyond all measure', &
                      'magnitudes lie between 1e-60 and 1e60, or are zero')
      value = 0.0_dp
    end if
    call expression_free(expression)
  end subroutine number

  !> Names of the variables of formulas.
  pure function variables(self) result(words)
    class(parameters_t), intent(in) :: self
    character(:), allocatable :: words
    words = expression_variables
    if (self%axisymmetric) words = expression_ring_variables
  end function variables

  subroutine try_expression(self, text, expression, error, column, token)
    class(parameters_t), intent(in) :: self
    character(*), intent(in) :: text
    type(expression_t), intent(out) :: expression
    type(error_t), allocatable, intent(out) :: error
    integer, intent(out), optional :: column
    character(*), intent(out), optional :: token
    character(name_size), allocatable :: names(:)
    real(dp), allocatable :: values(:)
    type(table_t), allocatable :: tables(:)
    integer :: i, n
    allocate (names(count(.not. self%list%is_word)), values(count(.not. self%list%is_word)))
    n = 0
    do i = 1, size(self%list)
      if (self%list(i)%is_word) cycle
      n = n + 1
      names(n) = self%list(i)%name
      values(n) = self%list(i)%value
    end do
    allocate (tables(0))
    do i = 1, size(self%tables)
      if (index(word_lower(text), trim(self%tables(i)%name)) == 0) cycle
      tables = [tables, self%tables(i)%table_t]
    end do
    call expression_make(expression, text, names, values, error, column, token, &
                         self%axisymmetric, tables)
  end subroutine try_expression

  !> Marks the parameters and tables whose names occur in an expression.
  pure subroutine mark_used(self, text)
    class(parameters_t), intent(inout) :: self
    character(*), intent(in) :: text
    integer :: first, last, number
    first = 1
    do while (first <= len(text))
      last = first
      do while (last <= len(text))
        if (.not. word_is_identifier('_'//text(last:last))) exit
        last = last + 1
      end do
      number = self%find(word_lower(text(first:last - 1)))
      if (number > 0) self%list(number)%used = .true.
      where (self%tables%name == word_lower(text(first:last - 1))) self%tables%used = .true.
      first = last + 1
    end do
  end subroutine mark_used

  !> After the last card: settings of unknown parameters are errors, unused parameters and tables
  !! worth a warning.
  subroutine check_use(self, errors)
    class(parameters_t), intent(in) :: self
    type(deck_errors_t), intent(inout) :: errors
    integer :: i
    do i = 1, size(self%settings)
      if (self%settings(i)%used) cycle
      call errors%add(self%settings(i)%position, "the deck has no parameter '"// &
                      self%settings(i)%name//"'", &
                      suggestion(self%settings(i)%name, self%names(), 'parameters of this deck'))
    end do
    do i = 1, size(self%list)
      if (self%list(i)%used) cycle
      call errors%warn(self%list(i)%position, "parameter '"//trim(self%list(i)%name)//"' is "// &
                       'not used')
    end do
    do i = 1, size(self%tables)
      if (self%tables(i)%used) cycle
      call errors%warn(self%tables(i)%position, "table '"//trim(self%tables(i)%name)//"' is "// &
                       'not used')
    end do
  end subroutine check_use

  !> Number of a parameter, 0 where there is none of this (lower-case) name.
  pure integer function find(self, name) result(number)
    class(parameters_t), intent(in) :: self
    character(*), intent(in) :: name
    do number = 1, size(self%list)
      if (self%list(number)%name == name) return
    end do
    number = 0
  end function find

  !> Names of all parameters.
  pure function names(self) result(list)
    class(parameters_t), intent(in) :: self
    type(string_t), allocatable :: list(:)
    integer :: i
    allocate (list(size(self%list)))
    do i = 1, size(list)
      list(i)%text = trim(self%list(i)%name)
    end do
  end function names

  !> Everything that may be named in an expression.
  pure function known_names(self) result(all)
    class(parameters_t), intent(in) :: self
    type(string_t), allocatable :: all(:)
    character(:), allocatable :: words
    integer :: i, n
    words = variables(self)//' '//expression_functions
    do i = 1, size(self%tables)
      words = words//' '//trim(self%tables(i)%name)
    end do
    n = size(self%list)
    allocate (all(n + word_count(words)))
    do i = 1, size(all)
      if (i <= n) all(i)%text = trim(self%list(i)%name)
      if (i > n) all(i)%text = word_item(words, i - n)
    end do
  end function known_names

  !> A place some columns further right.
  pure function moved(position, columns) result(place)
    type(position_t), intent(in) :: position
    integer, intent(in) :: columns
    type(position_t) :: place
    place = position
    place%column = place%column + columns
  end function moved

end module sgmp_parameters
