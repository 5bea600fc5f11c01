!> The switch of mutants in a copy of the sources made by mutate.py; pure as far as a compiler need know.
module sgmp_mutant
  use, intrinsic :: iso_c_binding, only: c_bool, c_int
  implicit none
  private
  public :: mutant_on

  interface
    pure function mutant_on(number) bind(c) result(yes)
      import :: c_bool, c_int
      integer(c_int), value, intent(in) :: number
      logical(c_bool) :: yes
    end function mutant_on
  end interface

end module sgmp_mutant
