!> Large memory pages for the arrays that every step runs through: fewer misses in the address
!! tables.
module sgmp_large_pages
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_loc, c_size_t
  use sgmp_kinds, only: dp, i8
  implicit none
  private
  public :: large_pages_ask

  integer(c_int), parameter :: madv_hugepage = 14          ! Linux; other systems refuse it
  integer(c_intptr_t), parameter :: page = 2_c_intptr_t**21  ! bytes

  interface
    !> POSIX; its status is of no interest, for the advice changes no result. Pure for that reason.
    pure subroutine madvise(address, length, advice) bind(c, name='madvise')
      import :: c_int, c_intptr_t, c_size_t
      implicit none
      integer(c_intptr_t), value :: address
      integer(c_size_t), value :: length
      integer(c_int), value :: advice
    end subroutine madvise
  end interface

contains

  !> Asks the system to back an array with large pages; to be called before it is first written.
  !! Where the system has none nothing happens.
  pure subroutine large_pages_ask(array, length)
    integer(i8), intent(in) :: length              !! numbers in the array
    real(dp), intent(in), target :: array(length)
    integer(c_intptr_t) :: first, last
    if (8*length < 2*page) return
    first = transfer(c_loc(array), first)
    last = (first + 8*length)/page*page
    first = (first + page - 1)/page*page           ! whole pages only
    call madvise(first, int(last - first, c_size_t), madv_hugepage)
  end subroutine large_pages_ask

end module sgmp_large_pages
