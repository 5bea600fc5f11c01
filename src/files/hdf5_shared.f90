!> Files of HDF5 that all ranks write.
module sgmp_hdf5_shared
  use hdf5, only: h5pset_fapl_mpio_f, hid_t
  use mpi_f08, only: mpi_comm, mpi_info_null
  use sgmp_parallel, only: parallel_communicator
  implicit none
  private
  public :: hdf5_share

contains

  !> Lets all ranks open a file together.
  subroutine hdf5_share(list)
    integer(hid_t), intent(in) :: list  !! properties of a file access
    type(mpi_comm) :: all
    integer :: status
    all = parallel_communicator()
    call h5pset_fapl_mpio_f(list, all%mpi_val, mpi_info_null%mpi_val, status)
  end subroutine hdf5_share

end module sgmp_hdf5_shared
