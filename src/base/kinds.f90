!> Number kinds and the few constants that every layer shares.
module sgmp_kinds
  use, intrinsic :: iso_fortran_env, only: int32, int64, real64
  implicit none
  private
  public :: dp, i4, i8, lanes, pi

  integer, parameter :: dp = real64  !! every floating-point quantity of the solver
  integer, parameter :: i4 = int32  !! counts and indices inside a rank
  integer, parameter :: i8 = int64  !! global counts, keys and byte sizes
  integer, parameter :: lanes = 8   !! particles in a chunk: the SIMD unit of all particle kernels
  real(dp), parameter :: pi = 3.14159265358979323846264338327950288_dp

end module sgmp_kinds
