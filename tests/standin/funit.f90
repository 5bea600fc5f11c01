!> What a serial unit test uses.
module funit
  use funit_asserts
  use funit_core, only: SourceLocation, throw, catch, anyExceptions
  implicit none
  public
end module funit
