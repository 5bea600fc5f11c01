!> Names of the methods and of the particle-grid transfers they use.
module sgmp_kernels
  implicit none
  private
  public :: kernel_mpm, kernel_gimp, kernel_sgmp
  public :: method_mpm, method_gimp, method_cpgimp, method_sgmp, method_names

  integer, parameter :: method_mpm = 1, method_gimp = 2, method_cpgimp = 3, method_sgmp = 4
  character(8), parameter :: method_names(4) = [character(8) :: 'mpm', 'gimp', 'cpgimp', 'sgmp']

  integer, parameter :: kernel_mpm = 1  !! linear hat functions, particle to node
  integer, parameter :: kernel_gimp = 2  !! GIMP functions, particle to node (uGIMP and cpGIMP)
  integer, parameter :: kernel_sgmp = 3  !! linear on the auxiliary grid, then the fixed centre-node
                                        !! map

end module sgmp_kernels
