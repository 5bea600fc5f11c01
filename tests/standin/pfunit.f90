!> What a unit test on several processes uses; like pFUnit's, it passes module mpi on.
module pfunit
  use mpi
  use funit
  use pfunit_runner, only: MpiTestMethod, any_on
  implicit none
  public

  interface anyExceptions
    procedure any_on
  end interface anyExceptions

end module pfunit
