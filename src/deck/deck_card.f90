!> One card of a deck with the values of its keys.
module sgmp_deck_card
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_expression, only: expression_free, expression_t
  use sgmp_keys, only: values_t
  use sgmp_kinds, only: dp
  use sgmp_spelling, only: string_t, word_position
  implicit none
  private
  public :: deck_card_t, value_t, card_fail, card_free

  !> The value of one key.
  type :: value_t
    logical :: given = .false.             !! written in the deck
    logical :: present = .false.           !! given, or has a default
    character(:), allocatable :: text      !! after replacement of `$name`; words in lower case
    type(position_t) :: position           !! of the value, or of the card where not given
    real(dp) :: number = 0.0_dp            !! real, integer
    logical :: named = .false.             !! number: one of the key's words instead
    logical :: flag = .false.              !! logical
    real(dp) :: vector(3) = 0.0_dp         !! vector; interval: lower, upper
    integer :: components = 0              !! of the vector
    logical :: open(2) = .true.            !! interval
    real(dp), allocatable :: points(:, :)  !! (2, n)
    real(dp), allocatable :: rows(:, :)    !! numbers of a file (columns, rows)
    integer, allocatable :: lines(:), columns(:, :)  !! where they stand in it
    type(expression_t) :: expression
  end type value_t

  !> A card with a value for each key of its definition, in the same order.
  type, extends(values_t) :: deck_card_t
    integer :: definition = 0              !! number in the table
    character(:), allocatable :: name      !! keyword
    type(string_t), allocatable :: keys(:)
    type(value_t), allocatable :: values(:)
    type(position_t) :: position
    logical :: failed = .false.            !! some value is wrong: do not use
  contains
    procedure :: at
    procedure :: number => card_number
    procedure :: whole => card_whole
    procedure :: word => card_word
    procedure :: vector => card_vector
    procedure :: points => card_points
    procedure :: flag => card_flag
    procedure :: rows => card_rows
    procedure :: has => card_has
    procedure :: pick => card_pick
    procedure :: place => card_place
  end type deck_card_t

contains

  !> Number of the value of a key that the table has for this card.
  pure integer function at(self, key) result(number)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    do number = 1, size(self%keys)
      if (self%keys(number)%text == key) return
    end do
    number = 0
  end function at

  !> The number of a real key, or a replacement where it has none.
  pure function card_number(self, key, absent) result(value)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    real(dp), intent(in), optional :: absent  !! zero if not given
    real(dp) :: value
    value = 0.0_dp
    if (present(absent)) value = absent
    if (self%has(key)) value = self%values(self%at(key))%number
  end function card_number

  !> The number of a whole-number key, or a replacement where it has none.
  pure integer function card_whole(self, key, absent) result(value)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    integer, intent(in), optional :: absent  !! zero if not given
    value = 0
    if (present(absent)) value = absent
    if (self%has(key)) value = nint(self%values(self%at(key))%number)
  end function card_whole

  !> The text of a word, name, list or text; '' where it has none.
  pure function card_word(self, key) result(word)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    character(:), allocatable :: word
    word = ''
    if (self%has(key)) word = self%values(self%at(key))%text
  end function card_word

  !> The three components of a vector.
  pure function card_vector(self, key) result(vector)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    real(dp) :: vector(3)
    vector = self%values(self%at(key))%vector
  end function card_vector

  !> The points of a plane; none where they are not given.
  pure function card_points(self, key) result(points)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    real(dp), allocatable :: points(:, :)  !! (2, n)
    allocate (points(2, 0))
    if (self%has(key)) points = self%values(self%at(key))%points
  end function card_points

  !> Rows of numbers of a file; none where it is not given.
  pure function card_rows(self, key) result(rows)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    real(dp), allocatable :: rows(:, :)    !! (columns, rows)
    allocate (rows(0, 0))
    if (.not. self%has(key)) return
    if (allocated(self%values(self%at(key))%rows)) rows = self%values(self%at(key))%rows
  end function card_rows

  !> A yes or no.
  pure function card_flag(self, key) result(flag)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    logical :: flag
    flag = self%values(self%at(key))%flag
  end function card_flag

  !> Whether a key has a value, given or by default.
  pure function card_has(self, key) result(has)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    logical :: has
    has = self%values(self%at(key))%present
  end function card_has

  !> Number of the word among the names it may be, in their order; 0 where there is no word.
  pure integer function card_pick(self, key, names) result(number)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    character(*), intent(in) :: names(:)
    number = word_position(self%word(key), names)
  end function card_pick

  !> Where the value of a key stands, or the card where it is not given.
  pure function card_place(self, key) result(place)
    class(deck_card_t), intent(in) :: self
    character(*), intent(in) :: key
    type(position_t) :: place
    place = self%values(self%at(key))%position
  end function card_place

  !> Notes what is wrong with a card, which then is not used.
  subroutine card_fail(card, errors, position, message, remedy)
    type(deck_card_t), intent(inout) :: card
    type(deck_errors_t), intent(inout) :: errors
    type(position_t), intent(in) :: position
    character(*), intent(in) :: message, remedy
    card%failed = .true.
    call errors%add(position, message, remedy)
  end subroutine card_fail

  !> Releases what the values hold.
  subroutine card_free(card)
    type(deck_card_t), intent(inout) :: card
    integer :: i
    if (.not. allocated(card%values)) return
    do i = 1, size(card%values)
      call expression_free(card%values(i)%expression)
    end do
  end subroutine card_free

end module sgmp_deck_card
