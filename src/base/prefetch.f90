!> Asks the processor to bring data into its cache before they are needed.
module sgmp_prefetch
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  private
  public :: prefetch

  interface
    pure subroutine prefetch(data, bytes) bind(c, name='sgmp_prefetch_lines')
      import :: c_double, c_int
      implicit none
      real(c_double), intent(in) :: data(*)
      integer(c_int), value :: bytes
    end subroutine prefetch
  end interface

end module sgmp_prefetch
