!> What the columns of a velocity field hold: its sums over the particles, and the values at its
!! nodes. The only place that counts them.
module sgmp_columns
  use sgmp_kernels, only: kernel_centred
  use sgmp_space, only: space_axisymmetric, space_dimensions, spaces
  use sgmp_voigt, only: flux_components
  implicit none
  private
  public :: columns_t, columns_make
  public :: node_acceleration, node_inertia, node_inverse_mass, node_remapped, node_total, &
            node_velocity

  !> Columns of the sums; vectors and tensors by their first column.
  type :: columns_t
    integer :: mass = 1
    integer :: radial = 0              !! mass times radius (cells), 0: there is no axis
    integer :: momentum = 2
    integer :: spin = 0                !! the spin that particles carry, times their mass
    integer :: spins = 0               !! components of it, 0: none is carried
    integer :: force = 0               !! sigma V at auxiliary nodes, or the force at nodes
    integer :: forces = 0              !! components of it
    integer :: external = 0            !! external force, 0: no body force acts
    integer :: volume = 0              !! 0: not carried
    integer :: offset = 0              !! first moments of the mass about the centres (mass times
                                       !! cells), the last columns; 0: not carried
    integer :: total = 0
  end type columns_t

  ! Columns of the nodes' values, by dimension; MUSL puts the re-mapped velocity in the place of the
  ! acceleration, which it no longer needs then. The inverse mass is 0 where a node is ignored.
  integer, parameter :: node_acceleration = 1, node_remapped = node_acceleration
  integer, parameter :: node_velocity(3) = [2, 3, 4]
  integer, parameter :: node_inverse_mass(3) = [3, 5, 7]
  integer, parameter :: node_inertia = 6     !! axisymmetric: radial mass over mass
  integer, parameter :: node_total(spaces) = [node_inverse_mass, node_inertia]

contains

  !> Lays out the columns of the sums.
  pure function columns_make(space, kernel, external, volume, spins, offset) result(columns)
    integer, intent(in) :: space, kernel
    logical, intent(in) :: external    !! with an external force
    logical, intent(in) :: volume      !! with the volume
    integer, intent(in) :: spins       !! components of the spin that particles carry
    logical, intent(in), optional :: offset  !! with the first moments of the mass
    type(columns_t) :: columns
    integer :: ndim
    ndim = space_dimensions(space)
    if (space == space_axisymmetric) then
      columns%radial = columns%momentum
      columns%momentum = columns%radial + 1
    end if
    columns%spin = columns%momentum + ndim
    columns%spins = spins
    columns%force = columns%spin + spins
    columns%forces = merge(flux_components(space), ndim, kernel_centred(kernel))
    columns%total = columns%force + columns%forces - 1
    if (external) then
      columns%external = columns%total + 1
      columns%total = columns%total + ndim
    end if
    if (volume) then
      columns%total = columns%total + 1
      columns%volume = columns%total
    end if
    if (.not. present(offset)) return
    if (offset) then
      columns%offset = columns%total + 1
      columns%total = columns%total + ndim
    end if
  end function columns_make

end module sgmp_columns
