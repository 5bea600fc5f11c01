!> Text of a native deck while it is put together: cards, comments, numbers as one would write them.
module sgmp_native_deck
  use sgmp_deck_errors, only: position_t
  use sgmp_kinds, only: dp
  use sgmp_spelling, only: string_t
  use sgmp_text, only: real_text_tidy
  implicit none
  private
  public :: native_deck_t, native_vector

  integer, parameter :: longest_line = 100, column_of_rules = 90

  !> The lines of a deck, each with the place of what it comes from.
  type :: native_deck_t
    type(string_t), allocatable :: lines(:)
    integer, allocatable :: origin(:, :)       !! (2, lines): line and column in the deck there
    integer, private :: current(2) = 0         !! what the next lines come from; 0: the whole file
  contains
    procedure :: from => native_from
    procedure :: add => native_add
    procedure :: section => native_section
    procedure :: parameter => native_parameter
  end type native_deck_t

contains

  !> Says what the lines that are added next come from.
  subroutine native_from(self, place)
    class(native_deck_t), intent(inout) :: self
    type(position_t), intent(in) :: place
    self%current = [place%line, place%column]
  end subroutine native_from

  !> Adds a card, continued where it is long; quotes are not cut.
  subroutine native_add(self, card)
    class(native_deck_t), intent(inout) :: self
    character(*), intent(in) :: card
    type(string_t) :: line
    integer :: cut
    if (.not. allocated(self%lines)) allocate (self%lines(0), self%origin(2, 0))
    cut = 0
    if (len(card) > longest_line .and. index(card, '!') /= 1) cut = place_to_cut(card)
    line%text = card
    if (cut > 0) line%text = card(:cut)//'&'
    self%lines = [self%lines, line]
    self%origin = reshape([self%origin, self%current], [2, size(self%lines)])
    if (cut > 0) call self%add('  '//card(cut + 1:))
  end subroutine native_add

  !> The last blank before the longest line's end that is not in quotes, 0 where there is none.
  pure integer function place_to_cut(card) result(cut)
    character(*), intent(in) :: card
    logical :: quoted
    integer :: i
    cut = 0
    quoted = .false.
    do i = 1, min(len(card), longest_line - 2)
      if (card(i:i) == '"') quoted = .not. quoted
      if (card(i:i) == ' ' .and. .not. quoted .and. i > 2) cut = i
    end do
  end function place_to_cut

  !> Begins a section with a ruled headline.
  subroutine native_section(self, title)
    class(native_deck_t), intent(inout) :: self
    character(*), intent(in) :: title
    call self%add('')
    call self%add('! ---- '//title//' '//repeat('-', max(4, column_of_rules - len(title))))
  end subroutine native_section

  !> Adds a parameter with a comment.
  subroutine native_parameter(self, name, value, comment)
    class(native_deck_t), intent(inout) :: self
    character(*), intent(in) :: name, value, comment
    call self%add('parameter '//padded(name, 8)//' = '//padded(value, 10)//' ! '//comment)
  end subroutine native_parameter

  pure function padded(text, width) result(wide)
    character(*), intent(in) :: text
    integer, intent(in) :: width
    character(:), allocatable :: wide
    wide = text//repeat(' ', max(0, width - len(text)))
  end function padded

  !> A vector: (1,2,3), or a number where there is one component.
  pure function native_vector(x) result(text)
    real(dp), intent(in) :: x(:)
    character(:), allocatable :: text
    integer :: i
    text = real_text_tidy(x(1))
    if (size(x) == 1) return
    do i = 2, size(x)
      text = text//','//real_text_tidy(x(i))
    end do
    text = '('//text//')'
  end function native_vector

end module sgmp_native_deck
