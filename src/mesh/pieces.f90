!> Pieces that a set of grid points falls into: points within a reach of each other belong together.
module sgmp_pieces
  use sgmp_kinds, only: i8
  use sgmp_rows, only: key_j, key_k, row_key
  implicit none
  private
  public :: pieces_find

contains

  !> Names every interval of a set by the first interval of its piece.
  pure subroutine pieces_find(key, first, last, reach, piece)
    integer(i8), intent(in) :: key(:)              !! rows, ascending by (key, first)
    integer, intent(in) :: first(:), last(:)       !! inclusive range of each interval
    integer, intent(in) :: reach(3)                !! along i, j, k
    integer, intent(out) :: piece(:)
    integer :: s, dj, dk
    piece = [(s, s=1, size(piece))]
    do dk = -reach(3), 0
      do dj = -reach(2), merge(0, reach(2), dk == 0)
        call join_rows(key, first, last, dj, dk, reach(1), piece)
      end do
    end do
    do s = 1, size(piece)
      piece(s) = piece(piece(s))  ! a piece's first interval comes before the others
    end do
  end subroutine pieces_find

  !> Joins intervals with those of the row that lies (dj, dk) away, in one merge.
  pure subroutine join_rows(key, first, last, dj, dk, reach, piece)
    integer(i8), intent(in) :: key(:)
    integer, intent(in) :: first(:), last(:), dj, dk, reach
    integer, intent(inout) :: piece(:)
    integer(i8) :: row
    integer :: s, t, u
    t = 1
    do s = 1, size(key)
      row = row_key(key_j(key(s)) + dj, key_k(key(s)) + dk)
      do while (t <= size(key))
        if (key(t) > row .or. (key(t) == row .and. last(t) + reach >= first(s))) exit
        t = t + 1
      end do
      do u = t, size(key)
        if (key(u) /= row .or. first(u) - reach > last(s)) exit
        call join(piece, s, u)
      end do
    end do
  end subroutine join_rows

  !> Makes two pieces one, named by the lower of their names.
  pure subroutine join(piece, s, t)
    integer, intent(inout) :: piece(:)
    integer, intent(in) :: s, t
    integer :: a, b
    a = root(piece, s)
    b = root(piece, t)
    piece(max(a, b)) = min(a, b)
    piece(s) = min(a, b)
    piece(t) = min(a, b)
  end subroutine join

  pure function root(piece, s) result(r)
    integer, intent(in) :: piece(:), s
    integer :: r
    r = s
    do while (piece(r) /= r)
      r = piece(r)
    end do
  end function root

end module sgmp_pieces
