!> Files of HDF5 that all ranks write, in a build without MPI: there is one rank, and HDF5 may be
!! one without MPI, too.
module sgmp_hdf5_shared
  use hdf5, only: hid_t
  implicit none
  private
  public :: hdf5_share

contains

  !> Nothing is to be shared.
  subroutine hdf5_share(list)
    integer(hid_t), intent(in) :: list  !! properties of a file access
    associate (unused => list)
    end associate
  end subroutine hdf5_share

end module sgmp_hdf5_shared
