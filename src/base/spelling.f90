!> Words: lower case, lists, nearest spelling.
module sgmp_spelling
  implicit none
  private
  public :: string_t, word_lower, word_is_identifier, word_distance, word_nearest, word_in_list, &
    word_item, word_items, word_count, word_position, words_joined, suggestion

  !> A text of any length, for arrays of texts.
  type :: string_t
    character(:), allocatable :: text
  end type string_t

  character(*), parameter :: lower_case = 'abcdefghijklmnopqrstuvwxyz'
  character(*), parameter :: upper_case = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ'
  character(*), parameter :: digits = '0123456789'

contains

  !> The text in lower case (ASCII letters only).
  pure function word_lower(text) result(lower)
    character(*), intent(in) :: text
    character(len(text)) :: lower
    integer :: i, k
    do i = 1, len(text)
      k = index(upper_case, text(i:i))
      if (k > 0) then
        lower(i:i) = lower_case(k:k)
      else
        lower(i:i) = text(i:i)
      end if
    end do
  end function word_lower

  !> Whether the text is a name: a letter or underscore, then letters, digits and underscores.
  pure logical function word_is_identifier(text) result(yes)
    character(*), intent(in) :: text
    yes = .false.
    if (len(text) == 0) return
    if (verify(text, lower_case//upper_case//digits//'_') > 0) return
    yes = index(digits, text(1:1)) == 0
  end function word_is_identifier

  !> Number of single-letter changes, insertions, deletions and swaps of neighbours between two
  !! words.
  pure integer function word_distance(a, b) result(distance)
    character(*), intent(in) :: a, b
    integer :: d(0:len(a), 0:len(b))
    integer :: i, j, cost
    do i = 0, len(a)
      d(i, 0) = i
    end do
    do j = 0, len(b)
      d(0, j) = j
    end do
    do j = 1, len(b)
      do i = 1, len(a)
        cost = merge(0, 1, a(i:i) == b(j:j))
        d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + cost)
        if (i < 2 .or. j < 2) cycle
        if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) d(i, j) = min(d(i, j), &
            d(i - 2, j - 2) + 1)
      end do
    end do
    distance = d(len(a), len(b))
  end function word_distance

  !> The candidate nearest to a word, or '' where none is near enough to be meant.
  pure function word_nearest(word, candidates) result(nearest)
    character(*), intent(in) :: word            !! what was typed
    type(string_t), intent(in) :: candidates(:)  !! what is known
    character(:), allocatable :: nearest
    integer :: i, distance, best
    nearest = ''
    if (len(word) > 64) return
    best = max(1, (len(word) + 1)/3) + 1
    do i = 1, size(candidates)
      distance = word_distance(word_lower(word), word_lower(candidates(i)%text))
      ! A word of two letters is no misspelling of a longer one.
      if (len(word) == 2 .and. len(candidates(i)%text) > 2) cycle
      if (len(word) >= 4 .and. index(word_lower(candidates(i)%text), &
                                     word_lower(word)) == 1) distance = min(distance, 1)
      if (distance < best) then
        best = distance
        nearest = candidates(i)%text
      end if
    end do
  end function word_nearest

  !> A remedy: the nearest candidate if there is one, else all of them.
  pure function suggestion(word, candidates, what) result(text)
    character(*), intent(in) :: word            !! what was typed
    type(string_t), intent(in) :: candidates(:)  !! what is known
    character(*), intent(in) :: what            !! plural noun, e.g. 'keys of grid'
    character(:), allocatable :: text
    integer :: i
    text = word_nearest(word, candidates)
    if (len(text) > 0) then
      text = "did you mean '"//text//"'?"
    else if (size(candidates) == 0) then
      text = 'there are no '//what
    else
      text = what//': '
      do i = 1, size(candidates)
        text = text//candidates(i)%text
        if (i < size(candidates)) text = text//', '
      end do
    end if
  end function suggestion

  !> Number of blank-separated words in a list.
  pure integer function word_count(list) result(n)
    character(*), intent(in) :: list
    integer :: i
    n = 0
    do i = 1, len(list)
      if (list(i:i) == ' ') cycle
      if (i == 1) then
        n = n + 1
      else if (list(i - 1:i - 1) == ' ') then
        n = n + 1
      end if
    end do
  end function word_count

  !> The n-th word of a blank-separated list, '' beyond its end.
  pure function word_item(list, n) result(word)
    character(*), intent(in) :: list
    integer, intent(in) :: n
    character(:), allocatable :: word
    integer :: i, first, last
    word = ''
    last = 0
    do i = 1, n
      first = verify(list(last + 1:), ' ')
      if (first == 0) return
      first = first + last
      last = index(list(first:)//' ', ' ') + first - 2
    end do
    word = list(first:last)
  end function word_item

  !> All words of a blank-separated list.
  pure function word_items(list) result(words)
    character(*), intent(in) :: list
    type(string_t), allocatable :: words(:)
    integer :: i
    allocate (words(word_count(list)))
    do i = 1, size(words)
      words(i)%text = word_item(list, i)
    end do
  end function word_items

  !> Position of a word in a blank-separated list, 0 where it is not in it.
  pure integer function word_in_list(word, list) result(position)
    character(*), intent(in) :: word, list
    integer :: i
    position = 0
    do i = 1, word_count(list)
      if (word_item(list, i) == word) then
        position = i
        return
      end if
    end do
  end function word_in_list

  !> Place of a word among names, counted from 1; 0 where it is not among them.
  pure integer function word_position(word, names) result(position)
    character(*), intent(in) :: word
    character(*), intent(in) :: names(:)  !! padded with blanks
    do position = 1, size(names)
      if (names(position) == word) return
    end do
    position = 0
  end function word_position

  !> Names as one blank-separated list.
  pure function words_joined(names) result(list)
    character(*), intent(in) :: names(:)  !! padded with blanks
    character(:), allocatable :: list
    integer :: i
    list = ''
    do i = 1, size(names)
      list = list//trim(names(i))
      if (i < size(names)) list = list//' '
    end do
  end function words_joined

end module sgmp_spelling
