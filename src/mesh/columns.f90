!> What the columns of a velocity field hold: its sums over the particles, and the values at its
!! nodes. The only place that counts them.
!!
!! Whoever needs a sum asks for it (columns_ask): a name, a stage, and for each column its image
!! behind a wall. From the list of what was asked for follow first columns, what a sweep fills and
!! ranks exchange, what is folded at walls and how, what a particle that is turned back gives, what
!! is normalised, and the names in checkpoints. It is made once per run; kernels read plain numbers.
module sgmp_columns
  use sgmp_images, only: image_radial, image_sign, image_stress, image_t, image_vector
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_space, only: space_axisymmetric, space_dimensions, spaces
  use sgmp_text, only: integer_text
  use sgmp_voigt, only: flux_components
  implicit none
  private
  public :: averaging_rates, averaging_sums
  public :: block_t, columns_t, column_image, column_name, columns_ask, columns_before, &
            columns_keep_behind, columns_make, columns_range, columns_turn_back
  public :: pair_sums, twist_takes, twists
  public :: stage_pairs, stage_mass, stage_momentum, stage_stress, stage_debris, stage_behind
  public :: collide_kick, collide_rate, collide_square, collide_total, collide_velocity
  public :: node_acceleration, node_gyration, node_inertia, node_inverse_mass, node_remapped, &
            node_swirl, node_total, node_velocity, vector_column, vector_components
  public :: relax_dilation, relax_exchange, relax_filling, relax_filter, relax_stiffness, &
            relax_square, relax_total, relax_velocity

  !> When columns are filled; in this order they follow each other, and a sweep fills those of some
  !! stages without a gap.
  integer, parameter :: stage_pairs = 1     !! with the mass, by a scatter of their own
  integer, parameter :: stage_mass = 2
  integer, parameter :: stage_momentum = 3
  integer, parameter :: stage_stress = 4
  integer, parameter :: stage_debris = 5    !! by a sweep of their own
  integer, parameter :: stage_behind = 6    !! by walls, not by sweeps

  integer, parameter :: name_length = 12
  character(name_length), parameter :: behind_names(3) = ['behind_x    ', 'behind_y    ', &
                                                          'behind_z    ']

  !> Columns that something has asked for, next to each other.
  type :: block_t
    character(name_length) :: name = ''
    integer :: stage = stage_stress
    type(image_t), allocatable :: images(:)  !! one for each column
    logical :: probed = .false.  !! probes of the stability limit fill it; it is among the first of
                                 !! its stage
    logical :: turned = .false.  !! components of the particles' own velocity, which a particle that
                                 !! is turned back reverses
    integer :: power = 0         !! above 0: mass times this power of the radius, which changes when
                                 !! a particle is turned back
    logical :: normalised = .false.  !! a stress times volume
    logical :: outside = .false.  !! a force from outside that particles bring
    logical :: apart = .false.   !! particles do not bring it: a scatter of its own fills it; behind
                                 !! all others of its stage
    integer :: kept = 0          !! so many of them walls that act keep of what lies behind
    integer :: first = 0         !! its first column
  end type block_t

  !> Columns of the sums; vectors and tensors by their first column. 0: not carried.
  type :: columns_t
    logical :: corrected = .false.  !! strains are, at surfaces (doc/surfaces.md)
    logical :: turns = .false.   !! rotation is exact (doc/rotation.md)
    logical :: consistent = .false.  !! the mass of the nodes is (doc/mass.md)
    logical :: remapped = .false.  !! particles move with the velocity that strains them (MUSL)
    integer :: pairs = 0         !! mass moments of pairs of centres, behind them those of quads
    integer :: mass = 0
    integer :: radial = 0        !! mass times radius (cells), where there is an axis
    integer :: drives = 0        !! mass of particles whose motion is prescribed, one column for
                                 !! each prescription
    integer :: driven = 0        !! how many
    integer :: room = 0          !! volume of what has not come apart
    integer :: average = 0       !! sums by which plastic strain is averaged (sgmp_averaging)
    integer :: momentum = 0
    integer :: swirl = 0         !! v_theta times mass and radius, and mass times radius^2 (cells)
    integer :: square = 0        !! m |v|^2, where something relaxes (doc/volumes.md)
    integer :: force = 0         !! sigma V at auxiliary nodes, or the force at nodes
    integer :: forces = 0        !! components of it
    integer :: torque = 0        !! shear stresses of swirl times volume and radius, and the
                                 !! centrifugal force
    integer :: external = 0      !! external force
    integer :: faces = 0         !! that on faces of particles
    integer :: lever = 0         !! external force times lever (length), component by component
                                 !! along each axis
    integer :: twist = 0         !! external force times two or three levers (cells): columns of the
                                 !! components, one after another for each twist
    integer :: push = 0          !! forces of walls that let go, along each axis that has some
    integer :: impedance = 0     !! force per velocity of absorbing edges, component by component,
                                 !! then its levers as above
    integer :: volume = 0
    integer :: stiffness = 0     !! bulk modulus times volume, where something relaxes
    integer :: compliance = 0    !! the compliance w; behind it w p and w p^2
    integer :: debris = 0        !! by which debris collides: mass and momentum of all, mass of what
                                 !! collides, and that times the square of its velocity
    integer :: outside(2) = 0    !! first and last of the forces from outside that particles bring
    integer :: apart = 0         !! first of those that scatters of their own fill
    integer :: normalised = 0    !! the last of those that are normalised, from the force on
    integer :: behind(3) = 0     !! by axis, what lay behind its walls before it was folded: mass,
                                 !! momentum, force; 0: no wall moves
    integer :: first(stage_pairs:stage_behind + 1) = 1  !! of each stage, even an empty one
    integer :: probed(stage_pairs:stage_behind) = 0     !! the last that probes fill, of each stage
    integer :: total = 0
    integer :: nodes = 0         !! columns of the nodes' values
    type(block_t), allocatable :: blocks(:)  !! in the order of columns
  end type columns_t

  !> By which plastic strain is averaged (sgmp_averaging): sums M, M E, M k; what particles read of
  !! them, E/k and 1/k.
  integer, parameter :: averaging_sums = 3, averaging_rates = 2
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
  integer, parameter :: collide_kick(3) = collide_total + 1  !! at nodes: square of the acceleration

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

  !> The columns that every field has: mass, momentum, stress or force.
  pure function columns_make(space, kernel) result(columns)
    integer, intent(in) :: space, kernel
    type(columns_t) :: columns
    type(image_t), allocatable :: images(:)
    integer :: ndim, a
    ndim = space_dimensions(space)
    allocate (columns%blocks(0))
    columns%nodes = node_total(space)
    call columns_ask(columns, block_t('mass', stage_mass, [image_t()], kept=1))
    if (space == space_axisymmetric) then
      call columns_ask(columns, block_t('radial', stage_mass, [image_radial()], power=1))
    end if
    images = [(image_vector(a), a=1, ndim)]
    call columns_ask(columns, block_t('momentum', stage_momentum, images, probed=.true., &
                                      turned=.true., kept=ndim))
    if (kernel_centred(kernel)) images = [(image_stress(a, space), a=1, flux_components(space))]
    call columns_ask(columns, block_t('force', stage_stress, images, probed=.true., &
                                      normalised=.true., kept=ndim))
  end function columns_make

  !> Asks for columns: behind those of the same stage that were asked for before.
  pure subroutine columns_ask(columns, asked)
    type(columns_t), intent(inout) :: columns
    type(block_t), intent(in) :: asked
    type(block_t), allocatable :: blocks(:)
    integer :: n, b
    n = count(columns%blocks%stage <= asked%stage)
    allocate (blocks(size(columns%blocks) + 1))
    do b = 1, n
      blocks(b) = columns%blocks(b)
    end do
    blocks(n + 1) = asked
    do b = n + 1, size(columns%blocks)
      blocks(b + 1) = columns%blocks(b)
    end do
    call move_alloc(blocks, columns%blocks)
    call count_columns(columns)
    call name_columns(columns)
  end subroutine columns_ask

  !> Gives every block its place.
  pure subroutine count_columns(columns)
    type(columns_t), intent(inout) :: columns
    integer :: b, stage, last
    last = 0
    columns%total = sum([(size(columns%blocks(b)%images), b=1, size(columns%blocks))])
    columns%first = columns%total + 1
    columns%apart = 0
    columns%outside = 0
    columns%normalised = 0
    do b = 1, size(columns%blocks)
      associate (block => columns%blocks(b))
        block%first = last + 1
        last = last + size(block%images)
        columns%first(:block%stage) = min(columns%first(:block%stage), block%first)
        if (block%normalised) columns%normalised = last
        if (block%outside) columns%outside(2) = last
        if (block%outside .and. columns%outside(1) == 0) columns%outside(1) = block%first
        if (block%apart .and. columns%apart == 0) columns%apart = block%first
      end associate
    end do
    columns%probed = columns%first(:stage_behind) - 1
    do b = 1, size(columns%blocks)
      associate (block => columns%blocks(b))
        stage = block%stage
        if (block%probed) columns%probed(stage) = block%first + size(block%images) - 1
      end associate
    end do
  end subroutine count_columns

  !> The places of those that kernels and others ask for by name.
  pure subroutine name_columns(columns)
    type(columns_t), intent(inout) :: columns
    integer :: axis
    call find(columns, 'pairs', columns%pairs)
    call find(columns, 'mass', columns%mass)
    call find(columns, 'radial', columns%radial)
    call find(columns, 'drives', columns%drives, columns%driven)
    call find(columns, 'room', columns%room)
    call find(columns, 'average', columns%average)
    call find(columns, 'momentum', columns%momentum)
    call find(columns, 'swirl', columns%swirl)
    call find(columns, 'square', columns%square)
    call find(columns, 'force', columns%force, columns%forces)
    call find(columns, 'torque', columns%torque)
    call find(columns, 'external', columns%external)
    call find(columns, 'faces', columns%faces)
    call find(columns, 'lever', columns%lever)
    call find(columns, 'twist', columns%twist)
    call find(columns, 'impedance', columns%impedance)
    call find(columns, 'push', columns%push)
    call find(columns, 'volume', columns%volume)
    call find(columns, 'stiffness', columns%stiffness)
    call find(columns, 'compliance', columns%compliance)
    call find(columns, 'debris', columns%debris)
    do axis = 1, size(behind_names)
      call find(columns, behind_names(axis), columns%behind(axis))
    end do
  end subroutine name_columns

  !> First column and number of columns of a name, 0 where nothing has asked for it.
  pure subroutine find(columns, name, first, width)
    type(columns_t), intent(inout) :: columns
    character(*), intent(in) :: name
    integer, intent(out) :: first
    integer, intent(out), optional :: width
    integer :: b
    first = 0
    if (present(width)) width = 0
    do b = 1, size(columns%blocks)
      if (columns%blocks(b)%name /= name) cycle
      first = columns%blocks(b)%first
      if (present(width)) width = size(columns%blocks(b)%images)
    end do
  end subroutine find

  !> Columns that a sweep fills which brings mass, momentum or stress, first and last; a probe fills
  !! fewer. They are what ranks exchange and what is folded at walls.
  pure function columns_range(columns, mass, momentum, stress, probe) result(range)
    type(columns_t), intent(in) :: columns
    logical, intent(in) :: mass, momentum, stress, probe
    integer :: range(2), highest
    associate (first => columns%first)
      range(1) = first(merge(stage_pairs, merge(stage_momentum, stage_stress, momentum), mass))
      highest = merge(stage_stress, stage_momentum, stress)
      range(2) = first(highest + 1) - 1
      if (probe) range(2) = columns%probed(highest)
    end associate
  end function columns_range

  !> Columns before those of which particles bring values, in a sweep whose first column is given:
  !! pairs are made of other values.
  pure function columns_before(columns, first_column) result(before)
    type(columns_t), intent(in) :: columns
    integer, intent(in) :: first_column
    integer :: before
    before = max(first_column, columns%first(stage_mass)) - 1
  end function columns_before

  !> Image of a column at a wall: the sign with which it is folded, 0 where it stays.
  pure function column_image(columns, column, normal, wall) result(parity)
    type(columns_t), intent(in) :: columns
    integer, intent(in) :: column  !! of field%moment
    integer, intent(in) :: normal  !! axis of the wall's normal
    integer, intent(in) :: wall    !! wall_slip, wall_fixed or wall_axis
    real(dp) :: parity
    integer :: b
    parity = 0.0_dp
    b = block_of(columns, column)
    associate (block => columns%blocks(b))
      if (block%stage < stage_behind) then
        parity = image_sign(block%images(1 + column - block%first), normal, wall)
      end if
    end associate
  end function column_image

  !> The block of a column.
  pure function block_of(columns, column) result(b)
    type(columns_t), intent(in) :: columns
    integer, intent(in) :: column
    integer :: b
    b = count(columns%blocks%first <= column)
  end function block_of

  !> Name of a column: that of its block, and its number in it where there are more.
  pure function column_name(columns, column) result(name)
    type(columns_t), intent(in) :: columns
    integer, intent(in) :: column
    character(:), allocatable :: name
    associate (block => columns%blocks(block_of(columns, column)))
      name = trim(block%name)
      if (column > block%first) name = name//'+'//integer_text(column - block%first)
    end associate
  end function column_name

  !> What a particle gives to some columns, once it is turned back at a face across an axis: its own
  !! velocity along that is reversed, and along r its radius is another.
  pure subroutine columns_turn_back(columns, axis, radius, before, values)
    type(columns_t), intent(in) :: columns
    integer, intent(in) :: axis
    real(dp), intent(in) :: radius         !! now (cells); 0: there is no axis
    integer, intent(in) :: before          !! columns before those of the values
    real(dp), intent(inout) :: values(:)   !! whole blocks, the mass among them where radii are
    integer :: b, first
    do b = 1, size(columns%blocks)
      associate (block => columns%blocks(b))
        first = block%first - before
        if (first < 1 .or. first + size(block%images) - 1 > size(values)) cycle
        if (block%turned) values(first + axis - 1) = -values(first + axis - 1)
        if (block%power == 0 .or. axis > 1 .or. columns%mass <= before) cycle
        values(first) = values(columns%mass - before)*radius**block%power
      end associate
    end do
  end subroutine columns_turn_back

  !> Components of a vector of the nodes: the axes of the scene, and the one around its axis.
  pure function vector_components(columns, ndim) result(n)
    type(columns_t), intent(in) :: columns
    integer, intent(in) :: ndim
    integer :: n
    n = merge(3, ndim, columns%swirl > 0)
  end function vector_components

  !> Column of component `a` of a vector of the nodes that begins in a column.
  pure function vector_column(columns, column, a) result(at)
    type(columns_t), intent(in) :: columns
    integer, intent(in) :: column, a
    integer :: at
    at = column + a - 1
    if (columns%swirl > 0 .and. a == 3) at = node_swirl(column)
  end function vector_column

  !> Whether a twist is a difference along an axis.
  pure function twist_takes(twist, axis, ndim) result(yes)
    integer, intent(in) :: twist, axis, ndim
    logical :: yes
    yes = ndim == 2 .or. twist == 4 .or. axis /= 4 - twist
  end function twist_takes

  !> Adds columns for what lies behind the walls of some axes.
  pure subroutine columns_keep_behind(columns, axes)
    type(columns_t), intent(inout) :: columns
    logical, intent(in) :: axes(:)
    type(image_t), allocatable :: images(:)
    integer :: axis
    allocate (images(sum(columns%blocks%kept)))
    do axis = 1, size(axes)
      if (axes(axis)) call columns_ask(columns, block_t(behind_names(axis), stage_behind, images))
    end do
  end subroutine columns_keep_behind

end module sgmp_columns
