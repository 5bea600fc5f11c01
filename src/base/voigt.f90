!> Order of the components of symmetric tensors, in 1, 2 (plane strain) and 3 dimensions, and in
!! axisymmetric scenes, where x y z are r z theta.
!!
!! Particles store the stress components xx yy zz xy yz xz, cut after the last that exists; of these
!! only those along the grid's axes exert a force (fluxes) and do work on the strain; about an axis
!! of symmetry the hoop stress does, too. Everything is a constant, indexed by the space last, so
!! that dimension-generic sources lose nothing.
module sgmp_voigt
  use sgmp_space, only: axes_in_output, spaces
  implicit none
  private
  public :: voigt_name, voigt_names, voigt_axes, stress_components, flux_components
  public :: flux_stress, flux_between

  integer, parameter :: most = 6  !! components in three dimensions
  character(2), parameter :: voigt_names(most) = ['xx', 'yy', 'zz', 'xy', 'yz', 'xz']
  integer, parameter :: voigt_axes(2, most) = &
    reshape([1, 1, 2, 2, 3, 3, 1, 2, 2, 3, 1, 3], [2, most])
  integer, parameter :: stress_components(3) = [3, 4, 6]  !! stored
  integer, parameter :: flux_components(spaces) = [1, 3, 6, 4]  !! that exert a force

  !> Stress component of each flux (and strain) component, 0 beyond the last: (component, space).
  integer, parameter :: flux_stress(most, spaces) = reshape([1, 0, 0, 0, 0, 0, &
                                                        1, 2, 4, 0, 0, 0, &
                                                        1, 2, 3, 4, 5, 6, &
                                                        1, 2, 4, 3, 0, 0], [most, spaces])

  !> Flux component that acts along one axis across another, 0 beyond the last: (a, b, space).
  integer, parameter :: flux_between(3, 3, spaces) = reshape([1, 0, 0, 0, 0, 0, 0, 0, 0, &
                                                         1, 3, 0, 3, 2, 0, 0, 0, 0, &
                                                         1, 4, 6, 4, 2, 5, 6, 5, 3, &
                                                         1, 3, 0, 3, 2, 0, 0, 0, 0], &
                                                         [3, 3, spaces])

contains

  !> Name in decks and in output of a stored stress component, in a space (sgmp_space).
  pure function voigt_name(component, space) result(name)
    integer, intent(in) :: component, space
    character(2) :: name
    integer :: axes(2), c
    axes = axes_in_output(voigt_axes(:, component), space)
    do c = 1, size(voigt_names)
      if (all(voigt_axes(:, c) == [minval(axes), maxval(axes)])) name = voigt_names(c)
    end do
  end function voigt_name

end module sgmp_voigt
