!> Deck text to statements: files and includes, comments, continuation, quotes, tokens with their
!! places.
module sgmp_lexer
  use sgmp_absent_materials, only: absent_reason
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_kinds, only: i8
  use sgmp_library_folder, only: library_file, library_names, library_places
  use sgmp_posix, only: file_regular
  use sgmp_spelling, only: string_t, word_lower, word_nearest
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: token_t, statement_t, lexer_read, lexer_split

  character(1), parameter :: tab = achar(9), newline = achar(10), carriage_return = achar(13)
  character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)
  integer(i8), parameter :: largest_file = 16*1024_i8**2  !! bytes; a deck is text written by people
  integer, parameter :: deepest_include = 32
  integer, parameter :: longest_line = 10000  !! letters; every token knows its line

  !> A word, a quoted text or an equals sign.
  type :: token_t
    character(:), allocatable :: text
    logical :: quoted = .false.
    logical :: equals = .false.
    type(position_t) :: position
  end type token_t

  !> The tokens of one card, continuation lines joined.
  type :: statement_t
    type(token_t), allocatable :: tokens(:)
  end type statement_t

contains

  !> Reads a deck with everything it includes; what could not be read is in `errors`.
  subroutine lexer_read(path, statements, complete, errors)
    character(*), intent(in) :: path
    type(statement_t), allocatable, intent(out) :: statements(:)
    logical, intent(out) :: complete  !! every file was read
    type(deck_errors_t), intent(inout) :: errors
    type(string_t) :: open_files(0)
    type(position_t) :: nowhere
    nowhere%file = path
    allocate (statements(0))
    complete = .true.
    call read_file(path, nowhere, open_files, statements, complete, errors)
  end subroutine lexer_read

  !> Appends one file's statements; `open_files` are the files that are being included now.
  recursive subroutine read_file(path, asked_at, open_files, statements, complete, errors)
    character(*), intent(in) :: path
    type(position_t), intent(in) :: asked_at
    type(string_t), intent(in) :: open_files(:)
    type(statement_t), allocatable, intent(inout) :: statements(:)
    logical, intent(inout) :: complete  !! becomes false if some file is not read
    type(deck_errors_t), intent(inout) :: errors
    type(string_t), allocatable :: lines(:)
    type(statement_t), allocatable :: own(:)
    logical :: failed
    integer :: i, first
    do i = 1, size(open_files)
      if (open_files(i)%text /= path) cycle
      complete = .false.
      call errors%add(asked_at, "'"//path//"' includes itself", 'remove one of the include cards')
      return
    end do
    if (size(open_files) >= deepest_include) then
      complete = .false.
      call errors%add(asked_at, 'includes are nested too deeply', 'join some of the files')
      return
    end if
    call read_lines(path, asked_at, lines, failed, errors)
    complete = complete .and. .not. failed
    if (failed) return
    call lexer_split(path, lines, own, errors)
    first = 1
    do i = 1, size(own)
      if (word_lower(own(i)%tokens(1)%text) /= 'include') cycle
      statements = [statements, own(first:i - 1)]
      call include_file(path, own(i), open_files, statements, complete, errors)
      first = i + 1
    end do
    statements = [statements, own(first:)]
    if (size(own) == 0) call errors%add(whole_file(path), 'the file has no cards', &
                                        'see `sgmp help` for the cards of a deck')
  end subroutine read_file

  !> Follows one include card; a relative path is relative to the file that includes.
  recursive subroutine include_file(path, statement, open_files, statements, complete, errors)
    character(*), intent(in) :: path
    type(statement_t), intent(in) :: statement
    type(string_t), intent(in) :: open_files(:)
    type(statement_t), allocatable, intent(inout) :: statements(:)
    logical, intent(inout) :: complete
    type(deck_errors_t), intent(inout) :: errors
    type(string_t), allocatable :: deeper(:)
    character(:), allocatable :: name
    allocate (deeper(size(open_files) + 1))
    deeper(:size(open_files)) = open_files
    deeper(size(deeper))%text = path
    associate (tokens => statement%tokens)
      if (size(tokens) /= 2) then
        complete = .false.
        call errors%add(tokens(1)%position, 'include takes one file name', 'write: include "file"')
        return
      end if
      name = tokens(2)%text
      if (index(name, '/') /= 1) name = included_path(path, name)
      call read_file(name, tokens(2)%position, deeper, statements, complete, errors)
    end associate
  end subroutine include_file

  !> Path of a file that another includes: beside it, else in the library, where that has it.
  function included_path(path, name) result(found)
    character(*), intent(in) :: path  !! of the file that includes
    character(*), intent(in) :: name  !! as the card has it, relative
    character(:), allocatable :: found, of_library
    logical :: exists
    found = path(:index(path, '/', back=.true.))//name
    inquire (file=found, exist=exists)
    if (exists) return
    of_library = library_file(name)
    if (of_library /= '') found = of_library
  end function included_path

  !> Reads a text file as lines; refuses directories, missing, empty, huge and binary files.
  subroutine read_lines(path, asked_at, lines, failed, errors)
    character(*), intent(in) :: path
    type(position_t), intent(in) :: asked_at
    type(string_t), allocatable, intent(out) :: lines(:)
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    character(:), allocatable :: text
    integer :: unit, status
    integer(i8) :: bytes
    logical :: exists
    failed = .true.
    inquire (file=path//'/.', exist=exists)
    if (exists) then
      call errors%add(asked_at, "'"//path//"' is a directory", 'give the path of a deck')
      return
    end if
    inquire (file=path, exist=exists)
    if (.not. exists) then
      call errors%add(asked_at, "there is no file '"//path//"'", missing_remedy(path, asked_at))
      return
    end if
    if (.not. file_regular(path)) then
      call errors%add(asked_at, "'"//path//"' is a pipe or a device", 'give the path of a file')
      return
    end if
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status /= 0) then
      call errors%add(asked_at, "'"//path//"' cannot be opened", 'check its permissions')
      return
    end if
    inquire (unit=unit, size=bytes)
    if (bytes > largest_file) then
      call errors%add(asked_at, "'"//path//"' is too large for a deck", &
                      'particles and other data belong into files of their own')
    else
      allocate (character(max(bytes, 0_i8)) :: text)
      if (bytes > 0) read (unit, iostat=status) text
      failed = status /= 0
      if (failed) call errors%add(asked_at, "'"//path//"' cannot be read", 'is it a text file?')
    end if
    close (unit)
    if (failed) return
    call cut_lines(path, text, lines, failed, errors)
  end subroutine read_lines

  !> What to do about a missing file: of one that is included, where it was looked for.
  function missing_remedy(path, asked_at) result(text)
    character(*), intent(in) :: path
    type(position_t), intent(in) :: asked_at
    character(:), allocatable :: text
    text = absent_reason(path)
    if (text /= '') return
    text = 'check the spelling of the path'
    if (asked_at%line <= 0) return
    text = likely_materials(path)
    if (text == '') text = 'check the spelling of the path'
    text = text//'; looked for beside the file that includes it and in '//library_places()// &
           ' (sgmp materials lists the library)'
  end function missing_remedy

  !> Entries of the library that a path may mean: those whose names contain its last part, else the
  !! nearest; '' for none.
  function likely_materials(path) result(text)
    character(*), intent(in) :: path
    character(:), allocatable :: text, word
    type(string_t), allocatable :: names(:)
    integer :: i, dot
    call library_names('materials', names)
    word = path(index(path, '/', back=.true.) + 1:)
    dot = index(word, '.', back=.true.)
    if (dot > 1) word = word(:dot - 1)
    text = ''
    do i = 1, size(names)
      if (len(word) >= 3 .and. index(names(i)%text, word_lower(word)) > 0) then
        text = text//'materials/'//names(i)%text//'.inp, '
      end if
    end do
    if (text == '') then
      text = word_nearest(word, names)
      if (text /= '') text = 'materials/'//text//'.inp, '
    end if
    if (text /= '') text = 'did you mean '//text(:len(text) - 2)//'?'
  end function likely_materials

  !> Cuts a text at newlines; control characters mean that it is not a deck.
  subroutine cut_lines(path, text, lines, failed, errors)
    character(*), intent(in) :: path, text
    type(string_t), allocatable, intent(out) :: lines(:)
    logical, intent(out) :: failed
    type(deck_errors_t), intent(inout) :: errors
    type(position_t) :: place
    integer :: i, n, first, last
    n = 1
    do i = 1, len(text)
      if (text(i:i) == newline) n = n + 1
    end do
    allocate (lines(n))
    first = 1
    if (index(text, byte_order_mark) == 1) first = 1 + len(byte_order_mark)
    place = whole_file(path)
    do i = 1, n
      last = index(text(first:), newline)
      last = merge(first + last - 2, len(text), last > 0)
      lines(i)%text = without_return(text(first:last))
      place%column = control_character(lines(i)%text)
      if (place%column > 0) exit
      first = last + 2
    end do
    failed = place%column > 0
    if (.not. failed) return
    place%line = i
    call errors%add(place, 'not a text file: byte '// &
                    integer_text(iachar(lines(i)%text(place%column:place%column)))// &
                    ' is a control character', 'a deck is plain text in UTF-8 or ASCII')
  end subroutine cut_lines

  !> Column of the first control character, 0 if there is none.
  pure integer function control_character(line) result(column)
    character(*), intent(in) :: line
    do column = 1, len(line)
      if (line(column:column) == tab) cycle
      if (iachar(line(column:column)) < 32 .or. iachar(line(column:column)) == 127) return
    end do
    column = 0
  end function control_character

  pure function without_return(line) result(text)
    character(*), intent(in) :: line
    character(:), allocatable :: text
    text = line
    if (len(line) == 0) return
    if (line(len(line):) == carriage_return) text = line(:len(line) - 1)
  end function without_return

  !> Cuts lines into statements: one per line, a line ending in `&` goes on in the next.
  subroutine lexer_split(path, lines, statements, errors)
    character(*), intent(in) :: path
    type(string_t), intent(in) :: lines(:)
    type(statement_t), allocatable, intent(out) :: statements(:)
    type(deck_errors_t), intent(inout) :: errors
    type(statement_t) :: statement, found(size(lines))
    type(position_t) :: place
    logical :: continued, pending
    integer :: i, n, tokens_before
    n = 0
    allocate (statement%tokens(0))
    place%file = path
    pending = .false.
    do i = 1, size(lines)
      place%line = i
      place%source = lines(i)%text
      tokens_before = size(statement%tokens)
      call split_line(place, statement%tokens, continued, errors)
      ! a comment or an empty line does not end a continuation
      pending = continued .or. (pending .and. size(statement%tokens) == tokens_before)
      if (pending .and. i < size(lines)) cycle
      if (pending) then
        associate (last => statement%tokens(size(statement%tokens))%position)
          call errors%add(last, 'the file ends after a continuation', 'remove the &')
        end associate
      end if
      if (size(statement%tokens) > 0) then
        n = n + 1
        call move_alloc(statement%tokens, found(n)%tokens)
        allocate (statement%tokens(0))
      end if
    end do
    statements = found(:n)
  end subroutine lexer_split

  !> Appends the tokens of one line.
  subroutine split_line(line, tokens, continued, errors)
    type(position_t), intent(in) :: line  !! its source is the text
    type(token_t), allocatable, intent(inout) :: tokens(:)
    logical, intent(out) :: continued    !! the line ends in `&`
    type(deck_errors_t), intent(inout) :: errors
    type(token_t), allocatable :: own(:)
    type(position_t) :: place
    continued = .false.
    if (len(line%source) > longest_line) then
      place = line
      place%column = 1
      place%source = line%source(:40)//'…'
      call errors%add(place, 'the line has '//integer_text(len(line%source))//' letters, more '// &
                      'than '//integer_text(longest_line), 'end it with & and go on in the next')
      return
    end if
    call find_tokens(line, size(tokens) > 0, own, continued, errors)
    tokens = [tokens, own]
  end subroutine split_line

  !> Finds the tokens of one line.
  subroutine find_tokens(line, goes_on, tokens, continued, errors)
    type(position_t), intent(in) :: line  !! its source is the text
    logical, intent(in) :: goes_on        !! the statement has begun on a line before
    type(token_t), allocatable, intent(out) :: tokens(:)
    logical, intent(out) :: continued     !! the line ends in `&`
    type(deck_errors_t), intent(inout) :: errors
    type(token_t), allocatable :: found(:), more(:)
    type(token_t) :: token
    integer :: first, next, n
    continued = .false.
    next = 1
    n = 0
    allocate (found(8))
    do
      first = next + verify(line%source(next:)//'.', ' '//tab) - 1
      if (first > len(line%source)) exit
      if (scan(line%source(first:first), '!#') > 0) exit
      if (line%source(first:first) == '&') then
        continued = goes_on .or. n > 0
        next = first + 1
        cycle
      end if
      token%position = line
      token%position%column = first
      if (continued) then
        call errors%add(token%position, 'text after the continuation sign &', &
                        '& must be the last character of a line')
        exit
      end if
      call take_token(line%source, first, token, next, errors)
      if (n == size(found)) then
        allocate (more(2*n))
        more(:n) = found
        call move_alloc(more, found)
      end if
      n = n + 1
      found(n) = token
    end do
    tokens = found(:n)
  end subroutine find_tokens

  !> Takes the token that starts at `first`; `next` is the column after it.
  subroutine take_token(source, first, token, next, errors)
    character(*), intent(in) :: source
    integer, intent(in) :: first
    type(token_t), intent(inout) :: token
    integer, intent(out) :: next
    type(deck_errors_t), intent(inout) :: errors
    character(1) :: c
    c = source(first:first)
    token%quoted = scan(c, '"''') > 0
    token%equals = c == '='
    if (token%quoted) then
      next = index(source(first + 1:), c)
      if (next == 0) then
        call errors%add(token%position, 'the quote is not closed', 'add '//c)
        next = len(source) + 1
        token%text = source(first + 1:)
      else
        token%text = source(first + 1:first + next - 1)
        next = first + next + 1
      end if
    else if (token%equals) then
      token%text = '='
      next = first + 1
    else
      next = end_of_word(source, first)
      token%text = source(first:next - 1)
      if (parentheses(token%text) /= 0) then
        call errors%add(token%position, "unbalanced parentheses in '"//token%text//"'")
      end if
    end if
  end subroutine take_token

  !> Column after a bare word; blanks and signs inside parentheses belong to it.
  pure integer function end_of_word(source, first) result(next)
    character(*), intent(in) :: source
    integer, intent(in) :: first
    integer :: depth
    depth = 0
    do next = first, len(source)
      if (source(next:next) == '(') depth = depth + 1
      if (source(next:next) == ')') depth = depth - 1
      if (scan(source(next:next), '"''#!') > 0) return
      if (depth > 0) cycle
      if (is_blank(source(next:next)) .or. scan(source(next:next), '=&') > 0) return
    end do
  end function end_of_word

  pure integer function parentheses(text) result(depth)
    character(*), intent(in) :: text
    integer :: i
    depth = 0
    do i = 1, len(text)
      if (text(i:i) == '(') depth = depth + 1
      if (text(i:i) == ')') depth = depth - 1
      if (depth < 0) return
    end do
  end function parentheses

  pure function is_blank(c) result(yes)
    character(1), intent(in) :: c
    logical :: yes
    yes = c == ' ' .or. c == tab
  end function is_blank

  pure function whole_file(path) result(place)
    character(*), intent(in) :: path
    type(position_t) :: place
    place%file = path
  end function whole_file

end module sgmp_lexer
