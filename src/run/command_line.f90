!> The command line: what to do and with which settings.
module sgmp_command_line
  use sgmp_errors, only: error_make, error_t, exit_usage
  use sgmp_spelling, only: string_t, suggestion, word_count, word_item
  implicit none
  private
  public :: command_line_t, command_line_read, command_line_parse, command_line_write_usage
  public :: action_run, action_help, action_markdown, action_version

  integer, parameter :: action_run = 1      !! run or check a deck
  integer, parameter :: action_help = 2     !! show cards, or usage where no keyword is given
  integer, parameter :: action_markdown = 3  !! write the deck reference
  integer, parameter :: action_version = 4  !! print the version

  character(*), parameter :: known_options = &
                             '--check --set --output --threads --restart --time-limit --quiet '// &
                             '--verbose --help --version'

  !> What the user asked for.
  type :: command_line_t
    integer :: action = action_run
    character(:), allocatable :: deck         !! path
    character(:), allocatable :: keyword      !! of help; '' for the overview
    character(:), allocatable :: settings(:)  !! `NAME=VALUE`
    character(:), allocatable :: output       !! directory; '' for the default
    integer :: threads = 0                    !! 0: as the environment says
    character(:), allocatable :: restart      !! checkpoint, `latest`, or '' for a new run
    integer :: time_limit = 0                 !! seconds of wall time; 0: none
    logical :: check = .false.
    logical :: quiet = .false.
    logical :: verbose = .false.
  end type command_line_t

contains

  !> Reads the program's own command line.
  subroutine command_line_read(options, error)
    type(command_line_t), intent(out) :: options
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: arguments(:)
    integer :: i, length
    allocate (arguments(command_argument_count()))
    do i = 1, size(arguments)
      call get_command_argument(i, length=length)
      allocate (character(length) :: arguments(i)%text)
      if (length > 0) call get_command_argument(i, arguments(i)%text)
    end do
    call command_line_parse(arguments, options, error)
  end subroutine command_line_read

  !> Parses words as they follow the program's name.
  subroutine command_line_parse(arguments, options, error)
    type(string_t), intent(in) :: arguments(:)
    type(command_line_t), intent(out) :: options
    type(error_t), allocatable, intent(out) :: error  !! exit_usage
    integer :: i
    options%keyword = ''
    options%output = ''
    options%deck = ''
    options%restart = ''
    allocate (character(longest(arguments)) :: options%settings(0))
    if (size(arguments) == 0) then
      call error_make(error, exit_usage, 'no deck given', &
                      'usage: sgmp DECK [--check] …; see sgmp --help')
      return
    end if
    select case (arguments(1)%text)
    case ('help')
      call parse_help(arguments, options, error)
      return
    case ('import')
      call not_available('import', error)
      return
    case default  ! a deck or an option
      i = 1
    end select
    do while (i <= size(arguments) .and. .not. allocated(error))
      if (index(arguments(i)%text, '-') == 1) then
        call take_option(arguments, i, options, error)
      else if (options%deck /= '') then
        call error_make(error, exit_usage, "more than one deck: '"//arguments(i)%text//"'", &
                        'run them one after the other')
      else
        options%deck = arguments(i)%text
      end if
      i = i + 1
    end do
    if (allocated(error)) return
    call check_combination(options, error)
  end subroutine command_line_parse

  !> Options that exclude or need each other.
  subroutine check_combination(options, error)
    type(command_line_t), intent(in) :: options
    type(error_t), allocatable, intent(out) :: error
    if (options%action /= action_run) return
    if (options%deck == '') then
      call error_make(error, exit_usage, 'no deck given', &
                      'usage: sgmp DECK [--check] …; see sgmp --help')
    else if (options%quiet .and. options%verbose) then
      call error_make(error, exit_usage, '--quiet and --verbose exclude each other', 'remove one')
    end if
  end subroutine check_combination

  !> Takes the option at `i`; `i` ends at its last word. Values may follow as `--option=value` too.
  subroutine take_option(arguments, i, options, error)
    type(string_t), intent(in) :: arguments(:)
    integer, intent(inout) :: i
    type(command_line_t), intent(inout) :: options
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: name, value
    integer :: equals
    name = arguments(i)%text
    equals = index(name, '=')
    value = ''
    if (equals > 0) then
      value = name(equals + 1:)
      name = name(:equals - 1)
    end if
    select case (name)
    case ('--check')
      options%check = .true.
    case ('--quiet')
      options%quiet = .true.
    case ('--verbose')
      options%verbose = .true.
    case ('--help', '-h')
      options%action = action_help
    case ('--version')
      options%action = action_version
    case ('--set', '--output', '--threads', '--restart', '--time-limit')
      if (equals == 0) call next_word(arguments, i, name, value, error)
      if (allocated(error)) return
      equals = 0
      call take_value(name, value, options, error)
    case default
      call error_make(error, exit_usage, "unknown option '"//name//"'", &
                      suggestion(name, all_options(), 'options'))
    end select
    if (equals > 0 .and. .not. allocated(error)) then
      call error_make(error, exit_usage, name//' takes no value', 'remove ='//value)
    end if
  end subroutine take_option

  !> Takes the value of an option that has one.
  subroutine take_value(name, value, options, error)
    character(*), intent(in) :: name, value
    type(command_line_t), intent(inout) :: options
    type(error_t), allocatable, intent(out) :: error
    integer :: status
    select case (name)
    case ('--set')
      options%settings = [character(len(options%settings)) :: options%settings, value]
    case ('--output')
      options%output = value
    case ('--restart')
      options%restart = value
      if (value == '') call error_make(error, exit_usage, '--restart needs a value', &
                                       'e.g. '//example_of(name))
    case ('--time-limit')
      options%time_limit = seconds_of(value)
      if (options%time_limit < 1) then
        call error_make(error, exit_usage, "'"//value//"' is not a time HH:MM:SS", &
                        'e.g. '//example_of(name))
      end if
    case default  ! --threads
      status = 1
      if (verify(value, '0123456789') == 0 .and. len(value) < 6) then
        read (value, *, iostat=status) options%threads
      end if
      if (status /= 0 .or. options%threads < 1) then
        call error_make(error, exit_usage, "'"//value//"' is not a number of threads", &
                        'e.g. '//example_of(name))
      end if
    end select
  end subroutine take_value

  !> Seconds of `HH:MM:SS`, `MM:SS` or `SS`; 0 where it is none of these.
  pure function seconds_of(text) result(seconds)
    character(*), intent(in) :: text
    integer :: seconds, first, last, part
    seconds = 0
    if (text == '' .or. verify(text, '0123456789:') > 0) return
    first = 1
    do while (first <= len(text) + 1)
      last = index(text(first:)//':', ':') + first - 2
      if (last < first .or. last - first > 5) then
        seconds = 0
        return
      end if
      read (text(first:last), *) part
      if (seconds > 10**6) exit
      seconds = 60*seconds + part
      first = last + 2
    end do
  end function seconds_of

  subroutine next_word(arguments, i, name, value, error)
    type(string_t), intent(in) :: arguments(:)
    integer, intent(inout) :: i
    character(*), intent(in) :: name
    character(:), allocatable, intent(inout) :: value
    type(error_t), allocatable, intent(out) :: error
    if (i < size(arguments)) then
      i = i + 1
      value = arguments(i)%text
    end if
    if (value == '') call error_make(error, exit_usage, name//' needs a value', &
                                     'e.g. '//example_of(name))
  end subroutine next_word

  pure function example_of(name) result(text)
    character(*), intent(in) :: name
    character(:), allocatable :: text
    select case (name)
    case ('--set')
      text = '--set h=0.5'
    case ('--threads')
      text = '--threads 2'
    case ('--restart')
      text = '--restart latest'
    case ('--time-limit')
      text = '--time-limit 23:45:00'
    case default
      text = '--output results'
    end select
  end function example_of

  !> `help [keyword]` or `help --markdown`.
  subroutine parse_help(arguments, options, error)
    type(string_t), intent(in) :: arguments(:)
    type(command_line_t), intent(inout) :: options
    type(error_t), allocatable, intent(out) :: error
    options%action = action_help
    if (size(arguments) == 1) return
    if (size(arguments) > 2) then
      call error_make(error, exit_usage, 'help takes one keyword', 'e.g. sgmp help body')
    else if (arguments(2)%text == '--markdown') then
      options%action = action_markdown
    else if (index(arguments(2)%text, '-') == 1) then
      call error_make(error, exit_usage, "unknown option '"//arguments(2)%text//"' of help", &
                      "did you mean '--markdown'?")
    else
      options%keyword = arguments(2)%text
    end if
  end subroutine parse_help

  subroutine not_available(name, error)
    character(*), intent(in) :: name
    type(error_t), allocatable, intent(out) :: error
    call error_make(error, exit_usage, name//' is not available in this version', &
                    'see sgmp --help for what is')
  end subroutine not_available

  pure function all_options() result(names)
    type(string_t), allocatable :: names(:)
    character(:), allocatable :: words
    integer :: i
    words = known_options
    allocate (names(word_count(words)))
    do i = 1, size(names)
      names(i)%text = word_item(words, i)
    end do
  end function all_options

  pure integer function longest(arguments) result(length)
    type(string_t), intent(in) :: arguments(:)
    integer :: i
    length = 1
    do i = 1, size(arguments)
      length = max(length, len(arguments(i)%text))
    end do
  end function longest

  !> Writes how the program is called.
  subroutine command_line_write_usage(unit)
    integer, intent(in) :: unit  !! formatted unit
    write (unit, '(a)') &
      'usage: sgmp DECK [options]       run a deck', &
      '       sgmp help [CARD]          cards of a deck, or the keys of one', &
      '       sgmp help --markdown      the complete deck reference', &
      '       sgmp --version', '', &
      'options:', &
      '  --check             build everything, run nothing, print what would run', &
      '  --set NAME=VALUE    replace the value of a parameter of the deck; may be repeated', &
      '  --output DIR        directory of the results (default: <deck>.out)', &
      '  --threads N         number of threads', &
      '  --restart FILE      go on from a checkpoint; latest: from the last good one of the '// &
      'directory', &
      '  --time-limit T      stop with a checkpoint before HH:MM:SS of wall time are over', &
      '  --quiet, --verbose  less or more on the terminal', '', &
      'exit codes: 0 finished, 2 usage, 3 deck, 4 numerical, 5 input/output, 6 stopped after a '// &
      'checkpoint'
  end subroutine command_line_write_usage

end module sgmp_command_line
