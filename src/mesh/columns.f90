!> What the columns of a velocity field hold: its sums over the particles, and the values at its
!! nodes. The only place that counts them.
module sgmp_columns
  use sgmp_kernels, only: kernel_centred
  use sgmp_space, only: space_axisymmetric, space_dimensions, spaces
  use sgmp_voigt, only: flux_components
  implicit none
  private
  public :: columns_t, columns_add_debris, columns_keep_behind, columns_make, pair_sums, twist_takes, twists
  public :: node_acceleration, node_gyration, node_inertia, node_inverse_mass, node_remapped, &
            node_swirl, node_total, node_velocity
  public :: collide_rate, collide_square, collide_total, collide_velocity
  public :: relax_dilation, relax_exchange, relax_filling, relax_filter, relax_stiffness, &
            relax_square, relax_total, relax_velocity

  !> Columns of the sums; vectors and tensors by their first column.
  type :: columns_t
    integer :: pairs = 0               !! volume moments of pairs and quads of centres, the first;
                                       !! 0: surfaces are not corrected (doc/surfaces.md)
    integer :: mass = 1
    integer :: radial = 0              !! mass times radius (cells), 0: there is no axis
    integer :: drives = 0              !! mass of particles whose motion is prescribed, one column
                                       !! for each prescription; 0: there is none
    integer :: driven = 0              !! how many
    integer :: room = 0                !! volume, swept with the mass; 0: as for pairs
    integer :: momentum = 2
    integer :: spin = 0                !! the spin that particles carry, times their mass
    integer :: spins = 0               !! components of it, 0: none is carried
    integer :: swirl = 0               !! v_theta times mass and radius, and mass times radius^2
                                       !! (cells), 0: there is none
    integer :: square = 0              !! m |v|^2, 0: nothing relaxes (doc/volumes.md)
    integer :: force = 0               !! sigma V at auxiliary nodes, or the force at nodes
    integer :: forces = 0              !! components of it
    integer :: torque = 0              !! shear stresses of swirl times volume and radius, and the
                                       !! centrifugal force
    integer :: external = 0            !! external force, 0: none acts
    integer :: faces = 0               !! that on faces of particles, 0: none acts there
    integer :: lever = 0               !! external force times lever (length), component by
                                       !! component along each axis; 0: none acts on faces
    integer :: twist = 0               !! external force times two or three levers (cells): columns
                                       !! of the components, one after another for each twist;
                                       !! 0: no pairs, or none acts on faces
    integer :: impedance = 0           !! force per velocity of absorbing edges, component by
                                       !! component, then its levers as above; 0: there are none
    integer :: volume = 0              !! 0: not carried
    integer :: stiffness = 0           !! bulk modulus times volume, 0: nothing relaxes
    integer :: compliance = 0          !! the compliance w; behind it w p and w p^2
    integer :: offset = 0              !! first moments of the mass about the centres (mass times
                                       !! cells), the last that are swept; 0: not carried
    integer :: swept = 0               !! the last column that sweeps fill
    integer :: behind(3) = 0           !! by axis, what lay behind its walls before it was
                                       !! folded: mass, momentum, force; 0: no wall moves
    integer :: debris = 0              !! sums by which debris collides, in a sweep of their own: mass
                                       !! and momentum of all, mass of what collides and m |v|^2 of
                                       !! it against the grid; 0: nothing fails
    integer :: total = 0
    integer :: nodes = 0               !! columns of the nodes' values
  end type columns_t

  !> Columns of pairs and quads, by dimension: one for each axis, in space one for each two axes.
  integer, parameter :: pair_sums(3) = [0, 2, 6]
  !> Second differences at a centre (xy, in space xz and yz), and in space the third; by dimension.
  integer, parameter :: twists(3) = [0, 1, 4]

  ! Columns of the nodes' values, by dimension; MUSL puts the re-mapped velocity in the place of the
  ! acceleration, which it no longer needs then. The inverse mass is 0 where there is none, negative
  ! where a node is too light to be accelerated.
  integer, parameter :: node_acceleration = 1, node_remapped = node_acceleration
  integer, parameter :: node_velocity(3) = [2, 3, 4]
  integer, parameter :: node_inverse_mass(3) = [3, 5, 7]
  integer, parameter :: node_inertia = 6     !! axisymmetric: radial mass over mass
  integer, parameter :: node_total(spaces) = [node_inverse_mass, node_inertia]
  !> With swirl, v_theta over the radius beside the vector that begins in a column, and the moment
  !! of inertia over the mass.
  integer, parameter :: node_swirl(3) = node_inertia + [1, 0, 2], node_gyration = node_inertia + 3

  ! By how much particles collide, at the points of the stencils (sgmp_debris_rates); by dimension.
  integer, parameter :: collide_rate = 1      !! a
  integer, parameter :: collide_square = 2    !! a |v|^2
  integer, parameter :: collide_velocity = 3  !! first component of a v
  integer, parameter :: collide_total(3) = collide_velocity + [0, 1, 2]

  ! What particles relax to, at the centres of the auxiliary grid (sgmp_centres_relax); by dimension
  ! where there are two numbers of columns.
  integer, parameter :: relax_filter = 1      !! rate a of the velocity filter
  integer, parameter :: relax_square = 2      !! a |v|^2
  integer, parameter :: relax_exchange = 3    !! rate b of the exchange of volume; b p, b p^2
  integer, parameter :: relax_stiffness = 6   !! bulk modulus
  integer, parameter :: relax_filling = 7     !! logarithm of the factor on the volumes
  integer, parameter :: relax_dilation = 8    !! factor of normalised stress less 1
  integer, parameter :: relax_velocity = 9    !! first component of a v
  integer, parameter :: relax_total(3) = relax_velocity + [0, 1, 2]

contains

  !> Lays out the columns of the sums.
  ! allow(S901)
  pure function columns_make(space, kernel, external, volume, spins, offset, relaxed, swirl, &
                             faced, driven, absorbs, paired) result(columns)
    integer, intent(in) :: space, kernel
    logical, intent(in) :: external    !! with an external force
    logical, intent(in) :: volume      !! with the volume
    integer, intent(in) :: spins       !! components of the spin that particles carry
    logical, intent(in), optional :: offset  !! with the first moments of the mass
    logical, intent(in), optional :: relaxed  !! with what particles relax by; needs the volume
    logical, intent(in), optional :: swirl  !! with the velocity around the axis
    logical, intent(in), optional :: faced  !! external forces act on faces of particles
    integer, intent(in), optional :: driven  !! prescribed motions of parts of bodies
    logical, intent(in), optional :: absorbs  !! with the impedance of edges; needs `faced`
    logical, intent(in), optional :: paired  !! with volume moments of pairs of centres
    type(columns_t) :: columns
    integer :: ndim
    logical :: with_relaxation, with_swirl, with_pairs
    with_pairs = .false.
    if (present(paired)) with_pairs = paired .and. space /= 1
    with_relaxation = .false.
    if (present(relaxed)) with_relaxation = relaxed
    with_swirl = .false.
    if (present(swirl)) with_swirl = swirl
    columns%nodes = merge(node_gyration, node_total(space), with_swirl)
    ndim = space_dimensions(space)
    if (with_pairs) then
      columns%pairs = 1
      columns%mass = columns%pairs + pair_sums(ndim)
      columns%momentum = columns%mass + 1
    end if
    if (space == space_axisymmetric) then
      columns%radial = columns%momentum
      columns%momentum = columns%radial + 1
    end if
    if (present(driven)) columns%driven = driven
    columns%drives = merge(columns%momentum, 0, columns%driven > 0)
    columns%momentum = columns%momentum + columns%driven
    if (with_pairs) then
      columns%room = columns%momentum
      columns%momentum = columns%room + 1
    end if
    columns%spin = columns%momentum + ndim
    columns%spins = spins
    columns%force = columns%spin + spins
    if (with_swirl) then
      columns%swirl = columns%force
      columns%force = columns%force + 2
    end if
    if (with_relaxation) then
      columns%square = columns%force
      columns%force = columns%force + 1
    end if
    columns%forces = merge(flux_components(space), ndim, kernel_centred(kernel))
    columns%total = columns%force + columns%forces - 1
    if (with_swirl) then
      columns%torque = columns%total + 1
      columns%total = columns%total + 3
    end if
    if (external) then
      columns%external = columns%total + 1
      columns%total = columns%total + ndim
    end if
    if (wanted(faced)) then
      columns%faces = columns%total + 1
      columns%total = columns%total + ndim
    end if
    if (wanted(faced) .and. kernel_centred(kernel)) then
      columns%lever = columns%total + 1
      columns%total = columns%total + ndim**2
      if (with_pairs) then
        columns%twist = columns%total + 1
        columns%total = columns%total + ndim*twists(ndim)
      end if
    end if
    if (wanted(absorbs)) then
      columns%impedance = columns%total + 1
      columns%total = columns%total + merge(ndim + ndim**2, ndim, kernel_centred(kernel))
    end if
    if (volume) then
      columns%total = columns%total + 1
      columns%volume = columns%total
    end if
    if (with_relaxation) then
      columns%stiffness = columns%total + 1
      columns%compliance = columns%stiffness + 1
      columns%total = columns%compliance + 2
    end if
    if (present(offset)) then
      if (offset) then
        columns%offset = columns%total + 1
        columns%total = columns%total + ndim
      end if
    end if
    columns%swept = columns%total
  end function columns_make

  !> Adds columns for the sums by which debris collides.
  pure subroutine columns_add_debris(columns, ndim)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    columns%debris = columns%total + 1
    columns%total = columns%total + 3 + ndim
  end subroutine columns_add_debris

  !> Whether a twist is a difference along an axis.
  pure function twist_takes(twist, axis, ndim) result(yes)
    integer, intent(in) :: twist, axis, ndim
    logical :: yes
    yes = ndim == 2 .or. twist == 4 .or. axis /= 4 - twist
  end function twist_takes

  !> Whether something that need not be said is wanted.
  pure function wanted(what) result(yes)
    logical, intent(in), optional :: what
    logical :: yes
    yes = .false.
    if (present(what)) yes = what
  end function wanted

  !> Adds columns for what lies behind the walls of some axes.
  pure subroutine columns_keep_behind(columns, ndim, axes)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    logical, intent(in) :: axes(ndim)
    integer :: axis
    do axis = 1, ndim
      if (.not. axes(axis)) cycle
      columns%behind(axis) = columns%total + 1
      columns%total = columns%total + 1 + 2*ndim
    end do
  end subroutine columns_keep_behind

end module sgmp_columns
