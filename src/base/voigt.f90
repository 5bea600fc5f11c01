!> Order of the components of symmetric tensors, in 1, 2 (plane strain) and 3 dimensions.
!!
!! Particles store the stress components xx yy zz xy yz xz, cut after the last that exists; of these
!! only those along the grid's axes exert a force (fluxes) and do work on the strain. Everything is
!! a constant, indexed by the dimension last, so that dimension-generic sources lose nothing.
module sgmp_voigt
  implicit none
  private
  public :: voigt_names, voigt_axes, stress_components, flux_components
  public :: flux_stress, flux_between

  integer, parameter :: most = 6  !! components in three dimensions
  character(2), parameter :: voigt_names(most) = ['xx', 'yy', 'zz', 'xy', 'yz', 'xz']
  integer, parameter :: voigt_axes(2, most) = &
    reshape([1, 1, 2, 2, 3, 3, 1, 2, 2, 3, 1, 3], [2, most])
  integer, parameter :: stress_components(3) = [3, 4, 6]  !! stored
  integer, parameter :: flux_components(3) = [1, 3, 6]    !! that exert a force

  !> Stress component of each flux (and strain) component, 0 beyond the last: (component, ndim).
  integer, parameter :: flux_stress(most, 3) = reshape([1, 0, 0, 0, 0, 0, &
                                                        1, 2, 4, 0, 0, 0, &
                                                        1, 2, 3, 4, 5, 6], [most, 3])

  !> Flux component that acts along one axis across another, 0 beyond the last: (a, b, ndim).
  integer, parameter :: flux_between(3, 3, 3) = reshape([1, 0, 0, 0, 0, 0, 0, 0, 0, &
                                                         1, 3, 0, 3, 2, 0, 0, 0, 0, &
                                                         1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3, 3])

end module sgmp_voigt
