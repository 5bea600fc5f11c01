!> The options of the command line: the one table from which they are parsed, listed, documented and
!! completed.
module sgmp_options
  use sgmp_deck_table, only: deck_table
  use sgmp_errors, only: exit_codes
  use sgmp_gallery, only: gallery_names
  use sgmp_registry, only: registry_t
  use sgmp_spelling, only: words_joined
  use sgmp_text, only: integer_text, text_with_backslashes
  implicit none
  private
  public :: option_t, options, option_find, options_usage, options_markdown, options_completion, &
            options_man
  public :: topic_options

  !> One option.
  type :: option_t
    character(12) :: name
    character(10) :: value    !! what its value is called; '' for none
    character(24) :: example
    character(80) :: help
  end type option_t

  type(option_t), parameter :: options(*) = [ &
    option_t('--check', '', '', 'build all, try some steps, say what would run; writes no file'), &
    option_t('--suggest', '', '', &
             'write DECK_graded.inp, with small cells only where bodies meet; or say why not'), &
    option_t('--set', 'NAME=VALUE', '--set h=0.5', &
             'replace the value of a parameter of the deck; may be repeated'), &
    option_t('--output', 'DIR', '--output results', &
             'directory of the results (default: the name of the deck and .out)'), &
    option_t('--threads', 'N', '--threads 2', &
             'largest number of threads (default: all of OpenMP); small scenes take fewer'), &
    option_t('--restart', 'FILE', '--restart latest', &
             'go on from a checkpoint; latest: from the last good one of the directory'), &
    option_t('--time-limit', 'HH:MM:SS', '--time-limit 23:45:00', &
             'stop with a checkpoint before so much wall time is over'), &
    option_t('--keep-3d', '', '', &
             'MPM3D decks: leave out no direction, however thin (doc/mpm3d-import.md)'), &
    option_t('--quiet', '', '', 'less on the terminal'), &
    option_t('--verbose', '', '', 'more on the terminal, the deck with all defaults among it'), &
    option_t('--help', '', '', 'show options and exit codes; also -h and sgmp help options'), &
    option_t('--version', '', '', 'show version, commit and compiler')]

  character(*), parameter :: uses(*) = [character(80) :: &
    '  sgmp DECK [options]       run a deck, or a deck of MPM3D (X.mpm)', &
    '  sgmp new [NAME]           copy a deck to begin with, or list them', &
    '  sgmp materials [NAME]     list the library of materials, or show one with its sources', &
    '  sgmp import X.mpm         make a deck of a deck of MPM3D, and a report of it', &
    '  sgmp help [CARD]          cards of a deck, or the keys of one', &
    '  sgmp help --markdown      the complete deck reference', &
    '  sgmp help combinations    what does not go together', &
    '  sgmp help --json          the same for programs', &
    '  sgmp help --man           the manual page', &
    '  sgmp completion bash      what makes the shell complete options and cards']

  character(*), parameter :: topic_options = 'options'  !! sgmp help options

contains

  !> Number of an option in the table, 0 where there is none of this name.
  pure integer function option_find(name) result(number)
    character(*), intent(in) :: name
    do number = 1, size(options)
      if (options(number)%name == name) return
    end do
    number = 0
  end function option_find

  !> Writes how the program is called.
  subroutine options_usage(unit)
    integer, intent(in) :: unit  !! formatted unit
    integer :: i
    write (unit, '(a)') &
      'usage:', uses, '', 'options:'
    do i = 1, size(options)
      write (unit, '(2x, a, t27, a)') called(options(i)), trim(options(i)%help)
    end do
    write (unit, '(a)') '', 'exit codes:'
    do i = 1, size(exit_codes)
      write (unit, '(2x, i0, t7, a)') exit_codes(i)%code, trim(exit_codes(i)%meaning)
    end do
  end subroutine options_usage

  !> Writes the same as tables for doc/user-guide.md.
  subroutine options_markdown(unit)
    integer, intent(in) :: unit  !! formatted unit
    integer :: i
    write (unit, '(a)') '| option | meaning |', '|---|---|'
    do i = 1, size(options)
      write (unit, '(a)') '| `'//called(options(i))//'` | '//trim(options(i)%help)//' |'
    end do
    write (unit, '(a)') '', '| exit code | meaning |', '|---|---|'
    do i = 1, size(exit_codes)
      write (unit, '(a)') '| '//integer_text(exit_codes(i)%code)//' | '// &
        trim(exit_codes(i)%meaning)//' |'
    end do
  end subroutine options_markdown

  !> Writes the manual page (groff, macros man).
  subroutine options_man(unit)
    integer, intent(in) :: unit  !! formatted unit
    integer :: i
    write (unit, '(a)') '.TH SGMP 1', '.SH NAME', &
      'sgmp \- explicit material point solver for impact, penetration and blast', &
      '.SH SYNOPSIS', '.nf'
    write (unit, '(a)') (text_with_backslashes(trim(uses(i)), '-'), i=1, size(uses))
    write (unit, '(a)') '.fi', '.SH DESCRIPTION', &
      'A deck is a text file of cards, one a line. Results go into a folder named as the deck,', &
      'with .out: tables (history.csv, bodies.csv, gauges.csv), fields for ParaView or Tecplot,', &
      'run.log, and summary.json with a verdict on the run.', '.SH OPTIONS'
    do i = 1, size(options)
      write (unit, '(a)') '.TP', &
        '.B '//text_with_backslashes(called(options(i)), '-'), &
        text_with_backslashes(trim(options(i)%help), '-')
    end do
    write (unit, '(a)') '.SH EXIT STATUS'
    do i = 1, size(exit_codes)
      write (unit, '(a)') '.TP', '.B '//integer_text(exit_codes(i)%code), &
        text_with_backslashes(trim(exit_codes(i)%meaning), '-')
    end do
    write (unit, '(a)') '.SH ENVIRONMENT', '.TP', '.B OMP_NUM_THREADS', &
      'largest number of threads, where \-\-threads does not say', '.TP', '.B SGMP_THREADS', &
      'exact: as many threads as are allowed, in small scenes, too', '.TP', '.B SGMP_PATH', &
      'folders in which included files are looked for, separated by colons', &
      '.SH EXAMPLES', '.nf', &
      'sgmp new penetration', 'sgmp penetration.inp \-\-check', &
      'sgmp penetration.inp \-\-set speed=700', '.fi'
  end subroutine options_man

  !> An option with what its value is called.
  pure function called(option) result(text)
    type(option_t), intent(in) :: option
    character(:), allocatable :: text
    text = trim(trim(option%name)//' '//option%value)
  end function called

  !> Writes a script that makes bash complete decks, options, their values and the names of cards.
  subroutine options_completion(unit)
    integer, intent(in) :: unit  !! formatted unit
    type(registry_t) :: registry
    integer :: i
    registry = deck_table()
    write (unit, '(a)') &
      '# Completion of sgmp for bash: eval "$(sgmp completion bash)"', &
      '_sgmp() {', &
      '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} choices=', &
      '  COMPREPLY=()', &
      '  case $before in'
    do i = 1, size(options)
      if (options(i)%value == '') cycle
      write (unit, '(a)') '    '//trim(options(i)%name)//') '//values_of(options(i))//' return ;;'
    end do
    write (unit, '(a)', advance='no') '    help) choices="'//topic_options//' --markdown --man'
    do i = 1, size(registry%cards)
      write (unit, '(a)', advance='no') ' '//registry%cards(i)%name
    end do
    write (unit, '(a)') '" ;;', &
      '    completion) choices=bash ;;', &
      '    new) choices="'//gallery_names()//'" ;;', &
      '    materials) choices=$(sgmp materials 2>/dev/null | '// &
      'sed -n "/^  /s/^  \([^ ]*\) .*/\1/p") ;;', &
      '    import) COMPREPLY=($(compgen -f -X "!*.mpm" -- "$word") $(compgen -d -- "$word")) ;;', &
      '    *) case $word in', &
      '         -*) choices="'//words_joined(options%name)//'" ;;', &
      '         *) COMPREPLY=($(compgen -f -X "!*.inp" -- "$word") $(compgen -d -- "$word"))', &
      '            COMPREPLY+=($(compgen -f -X "!*.mpm" -- "$word"))', &
      '            if ((COMP_CWORD == 1)); then '// &
      'choices="help import new materials completion"; fi ;;', &
      '       esac ;;', &
      '  esac', &
      '  COMPREPLY+=($(compgen -W "$choices" -- "$word"))', &
      '}', &
      'complete -o filenames -F _sgmp sgmp'
  end subroutine options_completion

  !> Command of the script that lists the values of an option.
  pure function values_of(option) result(command)
    type(option_t), intent(in) :: option
    character(:), allocatable :: command
    select case (option%value)
    case ('DIR')
      command = 'COMPREPLY=($(compgen -d -- "$word"));'
    case ('FILE')
      command = 'COMPREPLY=($(compgen -W latest -- "$word") $(compgen -f -- "$word"));'
    case default  ! names and numbers
      command = ''
    end select
  end function values_of

end module sgmp_options
