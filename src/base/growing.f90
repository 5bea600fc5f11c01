!> Lists that grow: room for more elements along the last axis, where the first `used` stay. Those
!! behind are undefined.
module sgmp_growing
  use sgmp_kinds, only: dp, i8
  implicit none
  private
  public :: grow

  !> Makes `list` hold at least `needed` elements: nothing where it does, else some to spare, so
  !! that appending one by one costs little.
  interface grow
    module procedure grow_integers, grow_longs, grow_reals, grow_columns
  end interface grow

contains

  pure subroutine grow_integers(list, used, needed)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: used, needed
    integer, allocatable :: longer(:)
    if (needed <= size(list)) return
    allocate (longer(with_spare(needed)))
    longer(:used) = list(:used)
    call move_alloc(longer, list)
  end subroutine grow_integers

  pure subroutine grow_longs(list, used, needed)
    integer(i8), allocatable, intent(inout) :: list(:)
    integer, intent(in) :: used, needed
    integer(i8), allocatable :: longer(:)
    if (needed <= size(list)) return
    allocate (longer(with_spare(needed)))
    longer(:used) = list(:used)
    call move_alloc(longer, list)
  end subroutine grow_longs

  pure subroutine grow_reals(list, used, needed)
    real(dp), allocatable, intent(inout) :: list(:)
    integer, intent(in) :: used, needed
    real(dp), allocatable :: longer(:)
    if (needed <= size(list)) return
    allocate (longer(with_spare(needed)))
    longer(:used) = list(:used)
    call move_alloc(longer, list)
  end subroutine grow_reals

  pure subroutine grow_columns(list, used, needed)
    real(dp), allocatable, intent(inout) :: list(:, :)
    integer, intent(in) :: used, needed
    real(dp), allocatable :: longer(:, :)
    if (needed <= size(list, 2)) return
    allocate (longer(size(list, 1), with_spare(needed)))
    longer(:, :used) = list(:, :used)
    call move_alloc(longer, list)
  end subroutine grow_columns

  !> Twice what is needed, as far as it can be counted.
  pure function with_spare(needed) result(capacity)
    integer, intent(in) :: needed
    integer :: capacity
    capacity = needed + min(needed, huge(needed) - needed)
  end function with_spare

end module sgmp_growing
