!> The words of an MPM3D deck: a free stream of tokens, read one after the other whatever the lines.
!!
!! Blanks, tabs and commas separate; `!` begins a comment. A keyword is known by its first four
!! letters. The first error ends the stream: after it nobody could say what the next word means.
module sgmp_mpm3d_words
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_file_tools, only: line_t
  use sgmp_kinds, only: dp
  use sgmp_spelling, only: string_t, suggestion, word_lower
  implicit none
  private
  public :: mpm3d_words_t, keyword_length

  integer, parameter :: keyword_length = 4  !! letters by which a keyword is known
  integer, parameter :: longest_number = 40
  integer, parameter :: largest_exponent = 60  !! a density times a cube of lengths is still finite
  character(*), parameter :: separators = ' ,'//achar(9)//achar(13)
  character(*), parameter :: digits = '0123456789'

  !> Where the stream is.
  type :: mpm3d_words_t
    character(:), allocatable :: file
    type(line_t), allocatable :: lines(:)
    integer :: line = 1, column = 1  !! where the next word is looked for
    logical :: failed = .false.
    type(deck_errors_t) :: errors
    type(position_t) :: position     !! of the word read last
  contains
    procedure :: keyword => words_keyword
    procedure :: number => words_number
    procedure :: vector => words_vector
    procedure :: whole => words_whole
    procedure :: rest => words_rest
    procedure :: more_on_line => words_more_on_line
    procedure :: fail => words_fail
  end type mpm3d_words_t

contains

  !> Ends the stream with an error at the word read last.
  subroutine words_fail(self, message, remedy)
    class(mpm3d_words_t), intent(inout) :: self
    character(*), intent(in) :: message, remedy
    if (.not. self%failed) call self%errors%add(self%position, message, remedy)
    self%failed = .true.
  end subroutine words_fail

  !> The next keyword among those known, '' at the end of the file or after an error.
  function words_keyword(self, known, what) result(keyword)
    class(mpm3d_words_t), intent(inout) :: self
    character(keyword_length), intent(in) :: known(:)
    character(*), intent(in) :: what  !! plural noun, e.g. 'keywords'
    character(keyword_length) :: keyword
    character(:), allocatable :: word
    type(string_t) :: names(size(known))
    integer :: i
    keyword = ''
    if (self%failed) return
    word = next_word(self)
    keyword = word_lower(word)
    if (word == '' .or. any(known == keyword)) return
    do i = 1, size(known)
      names(i)%text = trim(known(i))
    end do
    call self%fail("'"//word//"' is not among the "//what//' of MPM3D', &
                   suggestion(word_lower(word(:min(len(word), keyword_length))), names, what))
    keyword = ''
  end function words_keyword

  !> The next number; MPM3D's own reader takes only what begins with a digit or a minus sign.
  function words_number(self) result(value)
    class(mpm3d_words_t), intent(inout) :: self
    real(dp) :: value
    character(:), allocatable :: word
    integer :: status
    value = 0.0_dp
    if (self%failed) return
    word = next_word(self)
    if (word == '') then
      call self%fail('the deck ends where a number is expected', 'add what is missing')
    else if (.not. is_number(word_lower(word))) then
      call self%fail("'"//word//"' is not a number", 'numbers are written like 1, -0.5 or 1.0d-3')
    else
      read (word, *, iostat=status) value
      if (status /= 0) call self%fail("'"//word//"' is not a number", &
                                      'numbers are written like 1, -0.5 or 1.0d-3')
    end if
  end function words_number

  !> The next three numbers.
  function words_vector(self) result(vector)
    class(mpm3d_words_t), intent(inout) :: self
    real(dp) :: vector(3)
    integer :: i
    do i = 1, 3
      vector(i) = self%number()
    end do
  end function words_vector

  !> The next whole number, which must lie in a range.
  function words_whole(self, least, most, what) result(value)
    class(mpm3d_words_t), intent(inout) :: self
    integer, intent(in) :: least, most
    character(*), intent(in) :: what  !! the number of what
    integer :: value
    real(dp) :: number
    value = least
    number = self%number()
    if (self%failed) return
    if (abs(number - anint(number)) > 0.0_dp) then
      call self%fail(what//' must be a whole number', 'remove the fraction')
    else if (number < real(least, dp)) then
      call self%fail(what//' is too small', 'check the order of the values, or use a larger one')
    else if (number > real(most, dp)) then
      call self%fail(what//' is too large', 'check it against what the deck has before')
    else
      value = nint(number)
    end if
  end function words_whole

  !> The rest of the line, without the separators around it; comments belong to it.
  function words_rest(self) result(text)
    class(mpm3d_words_t), intent(inout) :: self
    character(:), allocatable :: text
    text = ''
    if (self%line > size(self%lines)) return
    text = trim(adjustl(self%lines(self%line)%text(self%column:)))
    self%line = self%line + 1
    self%column = 1
  end function words_rest

  !> Whether another word stands on the line of the word read last.
  function words_more_on_line(self) result(more)
    class(mpm3d_words_t), intent(in) :: self
    logical :: more
    integer :: first
    more = .false.
    if (self%line > size(self%lines)) return
    associate (text => self%lines(self%line)%text)
      first = verify(text(self%column:), separators)
      if (first > 0) more = text(self%column + first - 1:self%column + first - 1) /= '!'
    end associate
  end function words_more_on_line

  !> Takes the next word of the file, '' where there is none.
  function next_word(self) result(word)
    class(mpm3d_words_t), intent(inout) :: self
    character(:), allocatable :: word
    integer :: first, length
    word = ''
    do while (self%line <= size(self%lines))
      if (self%more_on_line()) exit
      self%line = self%line + 1
      self%column = 1
    end do
    self%position%file = self%file
    self%position%line = min(self%line, size(self%lines))
    if (self%line > size(self%lines)) then
      self%position%column = 1
      if (size(self%lines) > 0) self%position%source = self%lines(size(self%lines))%text
      return
    end if
    associate (text => self%lines(self%line)%text)
      first = self%column + verify(text(self%column:), separators) - 1
      length = scan(text(first:), separators//'!') - 1
      if (length < 0) length = len(text) - first + 1
      word = text(first:first + length - 1)
      self%position%column = first
      self%position%source = text
    end associate
    self%column = first + length
  end function next_word

  !> Whether a text in lower case is a decimal number of moderate size.
  pure function is_number(text) result(yes)
    character(*), intent(in) :: text
    logical :: yes
    integer :: mark, exponent, status
    character(:), allocatable :: mantissa, power
    yes = .false.
    if (len(text) > longest_number) return
    mark = scan(text, 'ed')
    mantissa = text
    power = '0'
    if (mark > 0) then
      mantissa = text(:mark - 1)
      power = unsigned(text(mark + 1:))
    end if
    mantissa = unsigned(mantissa)
    if (scan(mantissa, digits) == 0 .or. verify(mantissa, digits//'.') > 0) return
    if (index(mantissa, '.') /= index(mantissa, '.', back=.true.)) return
    if (power == '' .or. verify(power, digits) > 0 .or. len(power) > 4) return
    read (power, *, iostat=status) exponent
    yes = status == 0 .and. exponent <= largest_exponent
  end function is_number

  !> A text without its sign.
  pure function unsigned(text) result(rest)
    character(*), intent(in) :: text
    character(:), allocatable :: rest
    rest = text
    if (scan(text, '+-') == 1) rest = text(2:)
  end function unsigned

end module sgmp_mpm3d_words
