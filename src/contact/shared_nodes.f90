!> Grid nodes that two or more velocity fields share, and what contact has to know there: normals
!! and distances.
!!
!! The list is rebuilt with the layout of the fields and holds nothing for bodies that are apart.
!! Everything at one node depends on that node alone, so nodes can be visited in any order and by
!! any thread, and two ranks that both solve a node find the same.
module sgmp_shared_nodes
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_link_t, contact_normal, normal_separating
  use sgmp_field, only: field_t
  use sgmp_kernels, only: kernel_gimp, kernel_mpm, kernel_sgmp
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_rows, only: key_j, key_k, row_key, rows_contains, rows_dilate, rows_intersection, &
    rows_planes, rows_points, rows_t, rows_union
  use sgmp_separation, only: separation
  use sgmp_surface_particles, only: surface_bins, surface_list, surface_t
  implicit none
  private
  public :: clouds_t, contact_pair_t, shared_nodes_t, shared_build, shared_detect, shared_meet, &
            shared_mark

  integer, parameter :: most_rows = 9          !! rows of bins whose particles give to a node
  real(dp), parameter :: overlapping = 1.0e-3_dp
    !! distance (cells) below which the shortest line is not trusted

  real(dp), parameter :: nowhere = -1.0e30_dp  !! reach of a body that is not there

  !> Two bodies with a contact card.
  type :: contact_pair_t
    integer :: body(2) = 0
    integer :: field(2) = 0
    real(dp) :: friction = 0.0_dp
    real(dp) :: lambda = 0.5_dp
      !! bodies touch where their particles are closer than this (cells), Eq. 86
    real(dp) :: near = 0.5_dp
      !! distance is measured between particles this near to the node's normal (cells)
    real(dp) :: depth = huge(1.0_dp)
      !! contact acts at nodes this near to where the bodies touch (cells)
    integer :: normal = normal_separating  !! one of normal_*, the stiffer already resolved
    ! what has happened since the start
    real(dp) :: impulse(3) = 0.0_dp        !! on the first body
    real(dp) :: angular_impulse(3) = 0.0_dp  !! on the first body, about the origin
    real(dp) :: dissipation = 0.0_dp
    integer :: shared = 0, touching = 0    !! nodes in the last step: with both masses, in contact
  end type contact_pair_t

  !> The shared nodes; members are the fields present at a node, links the pairs among them that
  !! have a contact card.
  type :: shared_nodes_t
    integer :: ndim = 3
    integer :: nodes = 0, members = 0, links = 0
    integer, allocatable :: point(:, :)         !! (3, nodes) i, j, k
    logical, allocatable :: held(:, :)
      !! (3, nodes) velocity components that a wall holds at zero
    integer, allocatable :: member_start(:)     !! (nodes + 1)
    integer, allocatable :: body(:)             !! (members)
    integer, allocatable :: field(:)            !! (members)
    integer, allocatable :: record(:)           !! (members) the node in the field
    integer, allocatable :: interval(:)         !! (members) of the field's work rows
    integer, allocatable :: bins(:, :, :)
      !! (2, most_rows, members) first and last bin, in the surface's list, of each row around
    type(surface_t), allocatable :: surface(:)  !! (bodies) surface particles around shared nodes
    integer, allocatable :: link_start(:)       !! (nodes + 1)
    integer, allocatable :: pair(:)             !! (links)
    type(contact_link_t), allocatable :: link(:)  !! (links) members counted within the node
    logical, allocatable :: meets(:)            !! (links) both bodies have mass at the node
    logical, allocatable :: touching(:)         !! (links) close enough for contact
  end type shared_nodes_t

  !> Room for the surface particles of two bodies around a node, kept from node to node.
  type :: clouds_t
    real(dp), allocatable :: first(:, :), second(:, :)
      !! (balls or more, 4) centre relative to the node, 0 along axes that do not exist; radius
  end type clouds_t

contains

  !> Lists the nodes that fields of contact pairs share in a range of planes.
  pure subroutine shared_build(shared, mesh, fields, bodies, pairs, planes)
    type(shared_nodes_t), intent(out) :: shared
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    integer, intent(in) :: planes(2)             !! first and last k
    type(rows_t) :: all, common, sum_of
    integer :: p, n
    allocate (all%key(0), all%first(0), all%last(0))
    do p = 1, size(pairs)
      associate (a => fields(pairs(p)%field(1))%work, b => fields(pairs(p)%field(2))%work)
        if (a%n == 0 .or. b%n == 0) cycle
        if (a%key(1) > b%key(b%n) .or. b%key(1) > a%key(a%n)) cycle
        call rows_intersection(a, b, common)
      end associate
      if (common%n == 0) cycle
      call rows_union(all, common, sum_of)
      all = sum_of
    end do
    call rows_planes(all, planes, common)
    all = common
    n = int(rows_points(all))
    shared%ndim = mesh%ndim
    shared%nodes = n
    allocate (shared%point(3, n), shared%held(3, n), shared%member_start(n + 1), &
      shared%link_start(n + 1))
    call list_points(shared, mesh, all)
    call list_members(shared, fields, pairs, .false.)
    allocate (shared%body(shared%members), shared%field(shared%members), &
      shared%record(shared%members), shared%interval(shared%members))
    allocate (shared%pair(shared%links), shared%link(shared%links))
    allocate (shared%meets(shared%links), shared%touching(shared%links), source=.false.)
    call list_members(shared, fields, pairs, .true.)
    call list_bins(shared, mesh, all, bodies)
  end subroutine shared_build

  !> Coordinates of the nodes, and the components that walls hold there.
  pure subroutine list_points(shared, mesh, rows)
    type(shared_nodes_t), intent(inout) :: shared
    type(mesh_t), intent(in) :: mesh
    type(rows_t), intent(in) :: rows
    integer :: s, i, n, axis, side
    n = 0
    do s = 1, rows%n
      do i = rows%first(s), rows%last(s)
        n = n + 1
        shared%point(:, n) = [i, key_j(rows%key(s)), key_k(rows%key(s))]
        shared%held(:, n) = .false.
        do axis = 1, mesh%ndim
          do side = 1, 2
            if (mesh%wall(side, axis) == wall_free) cycle
            if (shared%point(row_axis(axis, mesh%ndim), n) /= merge(mesh%lower(axis), &
              mesh%upper(axis), side == 1)) cycle
            shared%held(axis, n) = .true.
            if (mesh%wall(side, axis) == wall_fixed) shared%held(:, n) = .true.
          end do
        end do
      end do
    end do
  end subroutine list_points

  !> Where the coordinate along an axis is found among (i, j, k): in 2D the y axis is k.
  elemental function row_axis(axis, ndim) result(place)
    integer, intent(in) :: axis, ndim
    integer :: place
    place = merge(3, axis, ndim == 2 .and. axis == 2)
  end function row_axis

  !> Counts, or with `fill` lists, the fields and the pairs at each node.
  pure subroutine list_members(shared, fields, pairs, fill)
    type(shared_nodes_t), intent(inout) :: shared
    type(field_t), intent(in) :: fields(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    logical, intent(in) :: fill
    integer :: n, p, m, l, side, at(2), record(2), interval(2), s
    m = 0
    l = 0
    do n = 1, shared%nodes
      shared%member_start(n) = m + 1
      shared%link_start(n) = l + 1
      do p = 1, size(pairs)
        do side = 1, 2
          associate (field => fields(pairs(p)%field(side)))
            s = rows_contains(field%work, row_key(shared%point(2, n), shared%point(3, n)), &
              shared%point(1, n))
            record(side) = 0
            interval(side) = s
            if (s > 0) record(side) = field%neighbour(0, 0, s) + shared%point(1, n)
          end associate
        end do
        if (any(record == 0)) cycle
        l = l + 1
        if (.not. fill) then
          m = m + 2  ! an upper bound: a body may be in several pairs
          cycle
        end if
        do side = 1, 2
          do s = shared%member_start(n), m
            if (shared%field(s) == pairs(p)%field(side)) exit
          end do
          if (s > m) then
            m = s
            shared%field(s) = pairs(p)%field(side)
            shared%body(s) = pairs(p)%body(side)
            shared%record(s) = record(side)
            shared%interval(s) = interval(side)
          end if
          at(side) = s - shared%member_start(n) + 1
        end do
        shared%pair(l) = p
        shared%link(l)%first = at(1)
        shared%link(l)%second = at(2)
        shared%link(l)%friction = pairs(p)%friction
      end do
    end do
    shared%member_start(shared%nodes + 1) = m + 1
    shared%link_start(shared%nodes + 1) = l + 1
    shared%members = m
    shared%links = l
  end subroutine list_members

  !> Lists the bins around shared nodes, and which of them are around each node.
  pure subroutine list_bins(shared, mesh, nodes, bodies)
    type(shared_nodes_t), intent(inout) :: shared
    type(mesh_t), intent(in) :: mesh
    type(rows_t), intent(in) :: nodes
    type(body_t), intent(in) :: bodies(:)
    type(rows_t) :: around
    integer, allocatable :: place(:, :)          !! (most_rows, bodies) see surface_bins
    integer :: b, n, m, r, j, k, low(3)
    allocate (shared%surface(size(bodies)), shared%bins(2, most_rows, shared%members))
    do b = 1, size(bodies)
      if (.not. any(shared%body == b)) cycle
      call rows_dilate(nodes, lowest_bin_of(mesh, bodies(b), [0, 0, 0]), [0, 0, 0], around)
      call surface_list(shared%surface(b), bodies(b)%particles, around)
    end do
    allocate (place(most_rows, size(bodies)))
    do n = 1, shared%nodes
      if (n == 1) then
        place = 0
      else if (any(shared%point(2:, n) /= shared%point(2:, n - 1))) then
        place = 0
      end if
      do m = shared%member_start(n), shared%member_start(n + 1) - 1
        b = shared%body(m)
        low = lowest_bin_of(mesh, bodies(b), shared%point(:, n))
        r = 0
        do k = low(3), shared%point(3, n)
          do j = low(2), shared%point(2, n)
            r = r + 1
            call surface_bins(shared%surface(b), row_key(j, k), low(1), shared%point(1, n), &
                              place(r, b), shared%bins(:, r, m))
          end do
        end do
        shared%bins(1, r + 1:, m) = 1
        shared%bins(2, r + 1:, m) = 0
      end do
    end do
  end subroutine list_bins

  !> Finds the links of a node at which both bodies have mass.
  pure subroutine shared_meet(shared, n, fields, cutoff)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: cutoff               !! nodes lighter than this are ignored
    integer :: at(2), l, side
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      at = members_of(shared, n, l)
      shared%meets(l) = .true.
      do side = 1, 2
        shared%meets(l) = shared%meets(l) .and. &
          node_mass(fields(shared%field(at(side))), shared, at(side), n) > cutoff
      end do
    end do
  end subroutine shared_meet

  !> Marks the bins of all bodies around the nodes of a range of planes where bodies meet, and tells
  !! whether any do.
  pure subroutine shared_mark(shared, planes, any_meet)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: planes(2)             !! first and last k
    logical, intent(out) :: any_meet
    integer :: b, n, l
    any_meet = .false.
    do n = 1, shared%nodes
      if (shared%point(3, n) < planes(1)) cycle
      if (shared%point(3, n) > planes(2)) exit
      do l = shared%link_start(n), shared%link_start(n + 1) - 1
        if (.not. shared%meets(l)) cycle
        if (.not. any_meet) then
          do b = 1, size(shared%surface)
            if (shared%surface(b)%bins > 0) shared%surface(b)%marked = .false.
          end do
        end if
        any_meet = .true.
        call mark_around(shared, members_of(shared, n, l))
      end do
    end do
  end subroutine shared_mark

  !> Marks the bins around a node of the two members of a link.
  pure subroutine mark_around(shared, at)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: at(2)                 !! members
    integer :: side, r
    do side = 1, 2
      associate (bins => shared%bins(:, :, at(side)), &
                 surface => shared%surface(shared%body(at(side))))
        do r = 1, most_rows
          surface%marked(bins(1, r):bins(2, r)) = .true.
        end do
      end associate
    end do
  end subroutine mark_around

  !> The members of a link.
  pure function members_of(shared, n, l) result(at)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l                  !! node and link
    integer :: at(2)
    at = shared%member_start(n) - 1 + [shared%link(l)%first, shared%link(l)%second]
  end function members_of

  !> Normals of all links of a node, and which of them are close enough to touch (Eqs. 86-88).
  !! Which of them meet must be known, and the surface particles packed.
  pure subroutine shared_detect(shared, n, mesh, fields, bodies, pairs, clouds)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    type(clouds_t), intent(inout) :: clouds
    integer :: at(2), balls(2), l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      shared%touching(l) = .false.
      if (.not. shared%meets(l)) cycle
      at = members_of(shared, n, l)
      call cloud_around(shared, n, at(1), balls(1), clouds%first)
      call cloud_around(shared, n, at(2), balls(2), clouds%second)
      if (any(balls == 0)) cycle
      call measure(shared, n, l, at, mesh, fields, bodies, pairs(shared%pair(l)), balls, clouds)
    end do
  end subroutine shared_detect

  !> Normal of a link and whether its bodies touch. The normal is that of the shortest line between
  !! the surface particles around the node, or where they overlap, or by the deck's choice, that of
  !! the gradients of volume; the distance is that of the outermost particles along it (Eq. 86).
  pure subroutine measure(shared, n, l, at, mesh, fields, bodies, pair, balls, clouds)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n, l                  !! node and link
    integer, intent(in) :: at(2)                 !! members of the link
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pair
    integer, intent(in) :: balls(2)
    type(clouds_t), intent(in) :: clouds
    real(dp) :: line(3), gradient(3, 2), length, above, below
    integer :: side
    length = 0.0_dp
    if (pair%normal == normal_separating) then
      call separation(mesh%ndim, balls(1), clouds%first, balls(2), clouds%second, &
                      middle(balls(2), clouds%second) - middle(balls(1), clouds%first), &
                      pair%lambda, line)
      length = norm2(line)
      if (length > pair%lambda) return
    end if
    associate (normal => shared%link(l)%normal)
      if (length > overlapping) then
        normal = line/length
      else
        do side = 1, 2
          gradient(:, side) = volume_gradient(mesh, fields(shared%field(at(side))), shared, &
            at(side), bodies(shared%body(at(side))), shared%point(:, n))
          where (shared%held(:, n)) gradient(:, side) = 0.0_dp  ! the mirror image cancels it
        end do
        normal = contact_normal(pair%normal, gradient(:, 1), gradient(:, 2))
        if (all(abs(normal) <= 0.0_dp)) return
      end if
      above = -reach(size(clouds%second, 1), balls(2), clouds%second, -normal, pair%near)
      below = reach(size(clouds%first, 1), balls(1), clouds%first, normal, pair%near)
      ! Half way between the surfaces, seen from the node, is where the bodies touch.
      shared%touching(l) = above - below < pair%lambda .and. &
                           abs(0.5_dp*above + 0.5_dp*below) <= pair%depth
    end associate
  end subroutine measure

  !> Mean position of balls.
  pure function middle(n, balls) result(mean)
    integer, intent(in) :: n                     !! a multiple of `lanes`
    real(dp), intent(in), contiguous :: balls(:, :)
    real(dp) :: mean(3), part(lanes)
    integer :: d, p
    do d = 1, 3
      part = 0.0_dp
      do p = 0, n - lanes, lanes
        part = part + balls(p + 1:p + lanes, d)
      end do
      mean(d) = sum(part)/n
    end do
  end function middle

  !> How far balls that are `near` the axis through the origin reach along it; minus a lot where
  !! there are none.
  pure function reach(stride, n, balls, axis, near) result(furthest)
    integer, intent(in) :: stride, n
    real(dp), intent(in) :: balls(stride, 4), axis(3), near
    real(dp) :: furthest
    real(dp) :: top(lanes), along, aside
    integer :: p, l
    top = nowhere
    do p = 0, n - lanes, lanes
      !$omp simd private(along, aside)
      do l = 1, lanes
        along = balls(p + l, 1)*axis(1) + balls(p + l, 2)*axis(2) + balls(p + l, 3)*axis(3)
        aside = (balls(p + l, 1)**2 + balls(p + l, 2)**2 + balls(p + l, 3)**2) - along**2
        along = along + balls(p + l, 4)
        top(l) = merge(along, top(l), aside <= near**2 .and. along > top(l))
      end do
    end do
    furthest = maxval(top)
    if (furthest > nowhere) return
    furthest = reach_between(stride, n, balls, axis, near)
  end function reach

  !> Mean reach along the axis of the balls around it, for a surface that has been stretched until
  !! the axis passes between its particles; minus a lot beyond the body's edge, where those within
  !! twice `near` lie on one side of it.
  pure function reach_between(stride, n, balls, axis, near) result(mean)
    integer, intent(in) :: stride, n
    real(dp), intent(in) :: balls(stride, 4), axis(3), near
    real(dp) :: mean
    real(dp) :: along, aside(3), middle(3)
    integer :: p, found
    found = 0
    middle = 0.0_dp
    mean = 0.0_dp
    do p = 1, n
      along = dot_product(balls(p, :3), axis)
      aside = balls(p, :3) - along*axis
      if (dot_product(aside, aside) > (2.0_dp*near)**2) cycle
      if (p > 1) then
        if (maxval(abs(balls(p, :) - balls(p - 1, :))) <= 0.0_dp) exit  ! the rest repeats the last
      end if
      found = found + 1
      middle = middle + aside
      mean = mean + (along + balls(p, 4))
    end do
    if (found == 0 .or. norm2(middle) > near*found) then
      mean = nowhere
    else
      mean = mean/found
    end if
  end function reach_between

  !> Surface particles of a member around a node. The rest of the last group repeats the last
  !! particle. Where the node is held, particles are put onto its planes.
  pure subroutine cloud_around(shared, n, m, balls, x)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, m                  !! node and member
    integer, intent(out) :: balls
    real(dp), allocatable, intent(inout) :: x(:, :)
    real(dp) :: node(4)
    integer :: r, d, p, last, last_row
    associate (surface => shared%surface(shared%body(m)), bins => shared%bins(:, :, m))
      balls = 0
      last_row = 0
      do r = 1, most_rows
        p = surface%start(bins(2, r) + 1) - surface%start(bins(1, r))
        if (p > 0) last_row = r
        balls = balls + p
      end do
      if (balls == 0) return
      call make_room(balls + 2*lanes, x)
      node = 0.0_dp
      node(1) = real(shared%point(1, n), dp)
      if (shared%ndim == 2) node(2) = real(shared%point(3, n), dp)
      if (shared%ndim == 3) node(2:3) = real(shared%point(2:3, n), dp)
      balls = 0
      do r = 1, last_row
        last = surface%start(bins(2, r) + 1) - 1
        ! Whole groups; what is too much is overwritten.
        do p = surface%start(bins(1, r)), last, lanes
          call copy_group(size(surface%x, 1), surface%x, p - 1, node, size(x, 1), x, balls)
          balls = balls + min(lanes, last - p + 1)
        end do
      end do
    end associate
    do d = 1, 3
      if (shared%held(d, n)) x(:balls, d) = 0.0_dp
    end do
    do d = 1, 4
      x(balls + 1:balls + lanes, d) = x(balls, d)
    end do
    balls = lanes*((balls + lanes - 1)/lanes)
  end subroutine cloud_around

  !> A group of balls, its positions relative to a node.
  pure subroutine copy_group(stride, from, behind, node, stride_to, to, behind_to)
    integer, intent(in) :: stride, behind, stride_to, behind_to
    real(dp), intent(in) :: from(stride, 4), node(4)
    real(dp), intent(inout) :: to(stride_to, 4)
    integer :: l
    !$omp simd
    do l = 1, lanes
      to(behind_to + l, 1) = from(behind + l, 1) - node(1)
      to(behind_to + l, 2) = from(behind + l, 2) - node(2)
      to(behind_to + l, 3) = from(behind + l, 3) - node(3)
      to(behind_to + l, 4) = from(behind + l, 4)
    end do
  end subroutine copy_group

  pure subroutine make_room(n, x)
    integer, intent(in) :: n
    real(dp), allocatable, intent(inout) :: x(:, :)
    if (allocated(x)) then
      if (size(x, 1) >= n) return
      deallocate (x)
    end if
    allocate (x(2*n, 4))
  end subroutine make_room

  !> Mass of a member at a node (Eq. 17).
  pure function node_mass(field, shared, m, n) result(mass)
    type(field_t), intent(in) :: field
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: m, n
    real(dp) :: mass
    integer :: dj, dk, base
    if (field%kernel /= kernel_sgmp) then
      mass = field%moment(shared%record(m), 1)
      return
    end if
    mass = 0.0_dp
    do dk = -merge(1, 0, field%ndim >= 2), 0
      do dj = -merge(1, 0, field%ndim == 3), 0
        base = field%neighbour(dj, dk, shared%interval(m)) + shared%point(1, n)
        mass = mass + (field%moment(base - 1, 1) + field%moment(base, 1))
      end do
    end do
    mass = mass*0.5_dp**field%ndim
  end function node_mass

  !> Outward direction of a body at a node: sum of V grad N over centres (SGMP, Eq. 88) or particles
  !! (Eq. 87).
  pure function volume_gradient(mesh, field, shared, m, body, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: m
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    real(dp) :: gradient(3)
    if (field%kernel == kernel_sgmp) then
      gradient = centre_gradient(field, shared%interval(m), point(1))
    else
      gradient = particle_gradient(mesh, field%kernel, body, &
                                   shared%surface(shared%body(m)), shared%bins(:, :, m), point)
    end if
    gradient = gradient/body%law%density
  end function volume_gradient

  !> Sum of m_c grad N_Ic (Eq. 88), in units of mass per cell.
  pure function centre_gradient(field, interval, i) result(gradient)
    type(field_t), intent(in) :: field
    integer, intent(in) :: interval, i
    real(dp) :: gradient(3)
    real(dp) :: left, right
    integer :: dj, dk, base
    gradient = 0.0_dp
    do dk = -merge(1, 0, field%ndim >= 2), 0
      do dj = -merge(1, 0, field%ndim == 3), 0
        base = field%neighbour(dj, dk, interval) + i
        left = field%moment(base - 1, 1)
        right = field%moment(base, 1)
        gradient(1) = gradient(1) + (left - right)
        if (field%ndim == 2) gradient(2) = gradient(2) + sign(left + right, -dk - 0.5_dp)
        if (field%ndim == 3) gradient(2) = gradient(2) + sign(left + right, -dj - 0.5_dp)
        if (field%ndim == 3) gradient(3) = gradient(3) + sign(left + right, -dk - 0.5_dp)
      end do
    end do
    gradient = gradient*0.5_dp**(field%ndim - 1)
  end function centre_gradient

  !> Range of bins whose particles give to a node: lower corner, the upper one is the node itself.
  pure function lowest_bin(kernel, ndim, point) result(bin)
    integer, intent(in) :: kernel, ndim, point(3)
    integer :: bin(3)
    bin = point - merge(1, 2, kernel == kernel_mpm)*[1, merge(1, 0, ndim == 3), merge(1, 0, &
      ndim >= 2)]
  end function lowest_bin

  !> Sum of m_p grad S_Ip (Eq. 87), in units of mass per cell.
  pure function particle_gradient(mesh, kernel, body, surface, bins, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel
    type(body_t), intent(in) :: body
    type(surface_t), intent(in) :: surface       !! of the body
    integer, intent(in) :: bins(:, :)            !! (2, rows) the bins around the node in its list
    integer, intent(in) :: point(3)
    real(dp) :: gradient(3)
    real(dp) :: half(3), node(3)
    integer :: r, n, g, number, chunk, left, l, nd
    gradient = 0.0_dp
    nd = mesh%ndim
    node = real(point([1, row_axis(2, nd), 3]), dp)
    half = 0.0_dp
    if (kernel == kernel_gimp) half = body%half_size
    do r = 1, size(bins, 2)
      do n = bins(1, r), bins(2, r)
        do g = surface%guest_first(n), surface%guest_first(n) + surface%guest_size(n) - 1
          associate (guest => surface%guest(:, g))
            if (kernel == kernel_gimp) half(:nd) = guest(nd + 3:2*nd + 2)
            call add_gradient(nd, guest(:nd) - node(:nd), half, guest(nd + 2), gradient)
          end associate
        end do
        number = surface%bin(n)
        chunk = body%particles%first(number)
        left = body%particles%size(number)
        do while (left > 0)
          do l = 1, min(left, lanes)
            associate (a => body%particles%a(l, :, chunk), b => body%particles%b(l, :, chunk))
              if (body%law%slots%stretch > 0) half(:nd) = body%half_size(:nd)* &
                b(body%law%slots%stretch:body%law%slots%stretch + nd - 1)
              call add_gradient(nd, a(:nd) - node(:nd), half, a(2*nd + 1), gradient)
            end associate
          end do
          left = left - lanes
          chunk = body%particles%next(chunk)
        end do
      end do
    end do
  end function particle_gradient

  !> Adds what one particle gives to the gradient at a node.
  pure subroutine add_gradient(nd, x, half, mass, gradient)
    integer, intent(in) :: nd
    real(dp), intent(in) :: x(nd)                !! particle minus node (cells)
    real(dp), intent(in) :: half(3), mass
    real(dp), intent(inout) :: gradient(3)
    real(dp) :: s(3), g(3)
    integer :: d
    s = 1.0_dp
    g = 0.0_dp
    do d = 1, nd
      call weight(x(d), half(d), s(d), g(d))
    end do
    gradient(1) = gradient(1) + mass*(g(1)*s(2)*s(3))
    if (nd >= 2) gradient(2) = gradient(2) + mass*(s(1)*g(2)*s(3))
    if (nd == 3) gradient(3) = gradient(3) + mass*(s(1)*s(2)*g(3))
  end subroutine add_gradient

  !> Weight and derivative of a node along one axis: GIMP function, or with half-size 0 the hat
  !! function.
  pure subroutine weight(x, half, s, g)
    real(dp), intent(in) :: x              !! particle minus node (cells)
    real(dp), intent(in) :: half           !! particle half-size (cells)
    real(dp), intent(out) :: s, g
    real(dp) :: r
    r = abs(x)
    if (r < half) then
      s = 1.0_dp - (x*x + half*half)/(2.0_dp*half)
      g = -x/half
    else if (r < 1.0_dp - half) then
      s = 1.0_dp - r
      g = -sign(1.0_dp, x)
    else if (r < 1.0_dp + half) then
      s = (1.0_dp + half - r)**2/(4.0_dp*half)
      g = -sign((1.0_dp + half - r)/(2.0_dp*half), x)
    else
      s = 0.0_dp
      g = 0.0_dp
    end if
  end subroutine weight

  pure function lowest_bin_of(mesh, body, point) result(bin)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    integer :: bin(3)
    bin = lowest_bin(merge(kernel_sgmp, kernel_mpm, body%particles%shift > 0.25_dp), mesh%ndim, &
      point)
  end function lowest_bin_of

end module sgmp_shared_nodes
