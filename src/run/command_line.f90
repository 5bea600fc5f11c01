!> The command line: what to do and with which settings.
module sgmp_command_line
  use sgmp_errors, only: error_make, error_t, exit_usage
  use sgmp_options, only: option_find, options, topic_options
  use sgmp_spelling, only: string_t, suggestion, word_items, words_joined
  implicit none
  private
  public :: command_line_t, command_line_read, command_line_parse
  public :: action_run, action_help, action_markdown, action_version, action_usage, &
            action_usage_markdown, action_completion, action_import, action_new, action_man, &
            action_json, action_materials

  integer, parameter :: action_run = 1      !! run or check a deck
  integer, parameter :: action_help = 2     !! show cards, or the keys of one
  integer, parameter :: action_markdown = 3  !! write the deck reference
  integer, parameter :: action_version = 4  !! print the version
  integer, parameter :: action_usage = 5    !! show the options
  integer, parameter :: action_usage_markdown = 6  !! write them as tables
  integer, parameter :: action_completion = 7      !! write a script for the shell
  integer, parameter :: action_import = 8          !! make a native deck of an MPM3D deck

  integer, parameter :: action_new = 9             !! copy a deck of the gallery, or list them
  integer, parameter :: action_man = 10            !! write the manual page
  integer, parameter :: action_json = 11           !! write what goes with what
  integer, parameter :: action_materials = 12      !! list the library of materials, or show one

  !> What the user asked for.
  type :: command_line_t
    integer :: action = action_run
    character(:), allocatable :: deck         !! path; a name with action_new and action_materials
    character(:), allocatable :: keyword      !! of help; '' for the overview
    character(:), allocatable :: settings(:)  !! `NAME=VALUE`
    character(:), allocatable :: output       !! directory; '' for the default
    integer :: threads = 0                    !! 0: as the environment says
    character(:), allocatable :: restart      !! checkpoint, `latest`, or '' for a new run
    integer :: time_limit = 0                 !! seconds of wall time; 0: none
    logical :: check = .false.
    logical :: suggest = .false.              !! write a deck with unequal cells
    logical :: keep_3d = .false.              !! import leaves out no direction
    logical :: quiet = .false.
    logical :: verbose = .false.
  end type command_line_t

contains

  !> Reads the program's own command line.
  subroutine command_line_read(chosen, error)
    type(command_line_t), intent(out) :: chosen
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: arguments(:)
    integer :: i, length
    allocate (arguments(command_argument_count()))
    do i = 1, size(arguments)
      call get_command_argument(i, length=length)
      allocate (character(length) :: arguments(i)%text)
      if (length > 0) call get_command_argument(i, arguments(i)%text)
    end do
    call command_line_parse(arguments, chosen, error)
  end subroutine command_line_read

  !> Parses words as they follow the program's name.
  subroutine command_line_parse(arguments, chosen, error)
    type(string_t), intent(in) :: arguments(:)
    type(command_line_t), intent(out) :: chosen
    type(error_t), allocatable, intent(out) :: error  !! exit_usage
    integer :: i
    chosen%keyword = ''
    chosen%output = ''
    chosen%deck = ''
    chosen%restart = ''
    allocate (character(longest(arguments)) :: chosen%settings(0))
    if (size(arguments) == 0) then
      call error_make(error, exit_usage, 'no deck given', &
                      'usage: sgmp DECK [--check] …; see sgmp --help')
      return
    end if
    select case (arguments(1)%text)
    case ('help')
      call parse_help(arguments, chosen, error)
      return
    case ('completion')
      call parse_completion(arguments, chosen, error)
      return
    case ('import')
      chosen%action = action_import
      i = 2
    case ('new')
      chosen%action = action_new
      i = 2
    case ('materials')
      chosen%action = action_materials
      i = 2
    case default  ! a deck or an option
      i = 1
    end select
    do while (i <= size(arguments) .and. .not. allocated(error))
      if (index(arguments(i)%text, '-') == 1) then
        call take_option(arguments, i, chosen, error)
      else if (chosen%deck /= '') then
        call error_make(error, exit_usage, "more than one deck: '"//arguments(i)%text//"'", &
                        'one after the other')
      else
        chosen%deck = arguments(i)%text
      end if
      i = i + 1
    end do
    if (allocated(error)) return
    call check_combination(chosen, error)
  end subroutine command_line_parse

  !> Options that exclude or need each other.
  subroutine check_combination(chosen, error)
    type(command_line_t), intent(in) :: chosen
    type(error_t), allocatable, intent(out) :: error
    select case (chosen%action)
    case (action_run, action_import, action_new)
      call check_action(chosen, error)
      if (.not. allocated(error)) call check_pairs(chosen, error)
    case (action_materials)
      if (runs_something(chosen) .or. chosen%keep_3d .or. chosen%output /= '') then
        call error_make(error, exit_usage, 'materials takes no options', &
                        'sgmp materials lists them, sgmp materials NAME shows one')
      end if
    case default  ! help and the like have been parsed
      return
    end select
  end subroutine check_combination

  !> What a run, an import and a new deck need and take.
  subroutine check_action(chosen, error)
    type(command_line_t), intent(in) :: chosen
    type(error_t), allocatable, intent(out) :: error
    if (chosen%action == action_new) then
      if (runs_something(chosen) .or. chosen%keep_3d) then
        call error_make(error, exit_usage, 'new takes --output only', &
                        'run the deck that it makes with the other options')
      end if
    else if (chosen%deck == '') then
      call error_make(error, exit_usage, 'no deck given', &
                      'usage: sgmp DECK [--check] …; see sgmp --help')
    else if (chosen%action == action_import .and. runs_something(chosen)) then
      call error_make(error, exit_usage, 'import takes --keep-3d and --output only', &
                      'run the deck that it makes with the other options')
    end if
  end subroutine check_action

  !> Options of which one excludes the other.
  subroutine check_pairs(chosen, error)
    type(command_line_t), intent(in) :: chosen
    type(error_t), allocatable, intent(out) :: error
    if (chosen%suggest .and. (chosen%check .or. chosen%restart /= '' .or. &
                              chosen%output /= '')) then
      call error_make(error, exit_usage, &
                      '--suggest does not go with --check, --restart, --output', &
                      'run or check the deck that it writes')
    else if (chosen%quiet .and. chosen%verbose) then
      call error_make(error, exit_usage, '--quiet and --verbose exclude each other', 'remove one')
    end if
  end subroutine check_pairs

  !> Whether there are options that mean something for a run only.
  pure function runs_something(chosen) result(yes)
    type(command_line_t), intent(in) :: chosen
    logical :: yes
    yes = chosen%check .or. chosen%suggest .or. chosen%verbose .or. chosen%threads > 0 .or. &
          chosen%time_limit > 0 .or. size(chosen%settings) > 0 .or. chosen%restart /= ''
  end function runs_something

  !> Takes the option at `i`; `i` ends at its last word. Values may follow as `--option=value` too.
  subroutine take_option(arguments, i, chosen, error)
    type(string_t), intent(in) :: arguments(:)
    integer, intent(inout) :: i
    type(command_line_t), intent(inout) :: chosen
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: name, value
    integer :: equals, number
    name = arguments(i)%text
    equals = index(name, '=')
    value = ''
    if (equals > 0) then
      value = name(equals + 1:)
      name = name(:equals - 1)
    end if
    if (name == '-h') name = '--help'
    number = option_find(name)
    if (number == 0) then
      call error_make(error, exit_usage, "unknown option '"//name//"'", &
                      suggestion(name, word_items(words_joined(options%name)), 'options'))
      return
    end if
    if (options(number)%value == '' .and. equals > 0) then
      call error_make(error, exit_usage, name//' takes no value', 'remove ='//value)
    else if (options(number)%value /= '') then
      if (equals == 0 .and. i < size(arguments)) then
        i = i + 1
        value = arguments(i)%text
      end if
      if (value == '') call error_make(error, exit_usage, name//' needs a value', &
                                       'e.g. '//example_of(name))
    end if
    if (allocated(error)) return
    select case (name)
    case ('--check')
      chosen%check = .true.
    case ('--suggest')
      chosen%suggest = .true.
    case ('--keep-3d')
      chosen%keep_3d = .true.
    case ('--quiet')
      chosen%quiet = .true.
    case ('--verbose')
      chosen%verbose = .true.
    case ('--help')
      chosen%action = action_usage
    case ('--version')
      chosen%action = action_version
    case default
      call take_value(name, value, chosen, error)
    end select
  end subroutine take_option

  !> Takes the value of an option that has one.
  subroutine take_value(name, value, chosen, error)
    character(*), intent(in) :: name, value
    type(command_line_t), intent(inout) :: chosen
    type(error_t), allocatable, intent(out) :: error
    integer :: status
    select case (name)
    case ('--set')
      chosen%settings = [character(len(chosen%settings)) :: chosen%settings, value]
    case ('--output')
      chosen%output = value
    case ('--restart')
      chosen%restart = value
    case ('--time-limit')
      chosen%time_limit = seconds_of(value)
      if (chosen%time_limit < 1) then
        call error_make(error, exit_usage, "'"//value//"' is not a time HH:MM:SS", &
                        'e.g. '//example_of(name))
      end if
    case default  ! --threads
      status = 1
      if (verify(value, '0123456789') == 0 .and. len(value) < 6) then
        read (value, *, iostat=status) chosen%threads
      end if
      if (status /= 0 .or. chosen%threads < 1) then
        call error_make(error, exit_usage, "'"//value//"' is not a number of threads", &
                        'e.g. '//example_of(name))
      end if
    end select
  end subroutine take_value

  pure function example_of(name) result(text)
    character(*), intent(in) :: name
    character(:), allocatable :: text
    text = trim(options(option_find(name))%example)
  end function example_of

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

  !> `help [CARD|options|combinations] [--markdown|--man|--json]`.
  subroutine parse_help(arguments, chosen, error)
    type(string_t), intent(in) :: arguments(:)
    type(command_line_t), intent(inout) :: chosen
    type(error_t), allocatable, intent(out) :: error
    logical :: markdown, man, json
    integer :: i
    markdown = .false.
    man = .false.
    json = .false.
    do i = 2, size(arguments)
      if (arguments(i)%text == '--markdown') then
        markdown = .true.
        cycle
      end if
      if (arguments(i)%text == '--man') then
        man = .true.
        cycle
      end if
      if (arguments(i)%text == '--json') then
        json = .true.
        cycle
      end if
      if (index(arguments(i)%text, '-') == 1) then
        call error_make(error, exit_usage, "unknown option '"//arguments(i)%text//"' of help", &
                        "did you mean '--markdown'?")
        return
      end if
      if (chosen%keyword /= '') then
        call error_make(error, exit_usage, 'help takes one keyword', 'e.g. sgmp help body')
        return
      end if
      chosen%keyword = arguments(i)%text
    end do
    if (count([man, json, markdown .or. chosen%keyword /= '']) > 1) then
      call error_make(error, exit_usage, merge('--man writes the manual page     ', &
                                               '--json writes what goes with what', man), &
                      'leave out the rest')
    else if (man) then
      chosen%action = action_man
    else if (json) then
      chosen%action = action_json
    else if (chosen%keyword == topic_options) then
      chosen%action = merge(action_usage_markdown, action_usage, markdown)
    else if (markdown .and. chosen%keyword /= '') then
      call error_make(error, exit_usage, '--markdown writes the complete reference', &
                      'leave out the card, or --markdown')
    else
      chosen%action = merge(action_markdown, action_help, markdown)
    end if
  end subroutine parse_help

  !> `completion bash`.
  subroutine parse_completion(arguments, chosen, error)
    type(string_t), intent(in) :: arguments(:)
    type(command_line_t), intent(inout) :: chosen
    type(error_t), allocatable, intent(out) :: error
    logical :: known
    chosen%action = action_completion
    known = size(arguments) == 2
    if (known) known = arguments(2)%text == 'bash'
    if (.not. known) call error_make(error, exit_usage, 'completion is there for one shell', &
                                     'write: sgmp completion bash')
  end subroutine parse_completion

  pure integer function longest(arguments) result(length)
    type(string_t), intent(in) :: arguments(:)
    integer :: i
    length = 1
    do i = 1, size(arguments)
      length = max(length, len(arguments(i)%text))
    end do
  end function longest

end module sgmp_command_line
