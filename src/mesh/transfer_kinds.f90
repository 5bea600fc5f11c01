!> Names of the particle-grid transfers.
module sgmp_transfer_kinds
  implicit none
  private
  public :: kernel_mpm, kernel_gimp, kernel_sgmp

  integer, parameter :: kernel_mpm = 1  !! linear hat functions, particle to node
  integer, parameter :: kernel_gimp = 2  !! GIMP functions, particle to node (uGIMP and cpGIMP)
  integer, parameter :: kernel_sgmp = 3  !! linear on the auxiliary grid, then the fixed centre-node
                                        !! map

end module sgmp_transfer_kinds
