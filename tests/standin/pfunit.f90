!> What a unit test on several processes uses; like pFUnit's, it passes module mpi on.
module pfunit
  use mpi
  use funit
  use pfunit_runner, only: MpiTestMethod
  implicit none
  public

end module pfunit
