!> The switch of mutants in a copy of the sources made by mutate.py; pure as far as a compiler need know.
module sgmp_mutant
  use, intrinsic :: iso_c_binding, only: c_bool, c_int
  implicit none
  private
  public :: mutant_either, mutant_on

  interface
    pure function mutant_on(number) bind(c) result(yes)
      import :: c_bool, c_int
      integer(c_int), value, intent(in) :: number
      logical(c_bool) :: yes
    end function mutant_on
    pure function mutant_either_c(number, now, was) bind(c, name='mutant_either') result(yes)
      import :: c_bool, c_int
      integer(c_int), value, intent(in) :: number
      logical(c_bool), value, intent(in) :: now, was
      logical(c_bool) :: yes
    end function mutant_either_c
  end interface

contains

  !> A condition with a fault.
  pure function mutant_either(number, now, was) result(yes)
    integer, intent(in) :: number
    logical, intent(in) :: now, was
    logical :: yes
    yes = mutant_either_c(int(number, c_int), logical(now, c_bool), logical(was, c_bool))
  end function mutant_either

end module sgmp_mutant
