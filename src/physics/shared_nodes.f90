!> Grid nodes that two or more velocity fields share, and what contact has to know there: normals
!! and distances.
!!
!! The list is rebuilt with the layout of the fields and holds nothing for bodies that are apart.
!! Everything at one node
!! depends on that node alone, so nodes can be visited in any order and by any thread.
module sgmp_shared_nodes
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_link_t, contact_normal, normal_separating
  use sgmp_field, only: field_base, field_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_particles, only: particles_bin_of
  use sgmp_rows, only: key_j, key_k, row_key, rows_contains, rows_intersection, rows_points, &
    rows_t, rows_union
  use sgmp_separation, only: separation
  use sgmp_transfer_kinds, only: kernel_gimp, kernel_mpm, kernel_sgmp
  implicit none
  private
  public :: contact_pair_t, shared_nodes_t, shared_build, shared_detect

  integer, parameter :: most_rows = 9          !! rows of bins whose particles give to a node
  real(dp), parameter :: nowhere = -1.0_dp     !! surface offsets below are no surface particle's
  real(dp), parameter :: overlapping = 1.0e-3_dp
    !! distance (cells) below which the shortest line is not trusted

  !> Two bodies with a contact card.
  type :: contact_pair_t
    integer :: body(2) = 0
    integer :: field(2) = 0
    real(dp) :: friction = 0.0_dp
    real(dp) :: lambda = 0.5_dp
      !! bodies touch where their particles are closer than this (cells), Eq. 86
    real(dp) :: near = 0.5_dp
      !! distance is measured between particles this near to the node's normal (cells)
    integer :: normal = normal_separating  !! one of normal_*, the stiffer already resolved
    ! what has happened since the start
    real(dp) :: impulse(3) = 0.0_dp        !! on the first body
    real(dp) :: angular_impulse(3) = 0.0_dp  !! on the first body, about the origin
    real(dp) :: dissipation = 0.0_dp
    integer :: shared = 0, touching = 0    !! nodes in the last step
  end type contact_pair_t

  !> The shared nodes; members are the fields present at a node, links the pairs among them that
  !! have a contact card.
  type :: shared_nodes_t
    integer :: nodes = 0, members = 0, links = 0
    integer, allocatable :: point(:, :)         !! (3, nodes) i, j, k
    logical, allocatable :: held(:, :)
      !! (3, nodes) velocity components that a wall holds at zero
    integer, allocatable :: member_start(:)     !! (nodes + 1)
    integer, allocatable :: body(:)             !! (members)
    integer, allocatable :: field(:)            !! (members)
    integer, allocatable :: record(:)           !! (members) the node in the field
    integer, allocatable :: rows(:, :)          !! (most_rows, members) of bins, see rows_around
    integer, allocatable :: link_start(:)       !! (nodes + 1)
    integer, allocatable :: pair(:)             !! (links)
    type(contact_link_t), allocatable :: link(:)  !! (links) members counted within the node
    logical, allocatable :: touching(:)         !! (links) close enough for contact
  end type shared_nodes_t

contains

  !> Lists the nodes that fields of contact pairs share.
  pure subroutine shared_build(shared, mesh, fields, bodies, pairs)
    type(shared_nodes_t), intent(out) :: shared
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
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
    n = int(rows_points(all))
    shared%nodes = n
    allocate (shared%point(3, n), shared%held(3, n), shared%member_start(n + 1), &
      shared%link_start(n + 1))
    call list_points(shared, mesh, all)
    call list_members(shared, fields, pairs, .false.)
    allocate (shared%body(shared%members), shared%field(shared%members), &
      shared%record(shared%members))
    allocate (shared%pair(shared%links), shared%link(shared%links), shared%touching(shared%links))
    call list_members(shared, fields, pairs, .true.)
    allocate (shared%rows(most_rows, shared%members))
    do n = 1, shared%nodes
      do p = shared%member_start(n), shared%member_start(n + 1) - 1
        shared%rows(:, p) = rows_around(mesh, bodies(shared%body(p)), shared%point(:, n))
      end do
    end do
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
    integer :: n, p, m, l, side, at(2), record(2), s
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

  !> Normals of all links of a node, and which of them are close enough to touch (Eqs. 86-88).
  pure subroutine shared_detect(shared, n, mesh, fields, bodies, pairs, cutoff)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    real(dp), intent(in) :: cutoff               !! nodes lighter than this are ignored
    real(dp) :: gradient(3, shared%member_start(n + 1) - shared%member_start(n))
    real(dp) :: guess(3), distance
    integer :: at(2)
    logical :: there(size(gradient, 2))
    integer :: l, m, k
    do k = 1, size(there)
      m = shared%member_start(n) + k - 1
      there(k) = node_there(mesh, fields(shared%field(m)), shared%record(m), shared%point(:, n), &
        cutoff)
      if (there(k)) then
        gradient(:, k) = volume_gradient(mesh, fields(shared%field(m)), bodies(shared%body(m)), &
          shared%point(:, n))
        where (shared%held(:, n)) gradient(:, k) = 0.0_dp  ! the mirror image cancels it
      end if
    end do
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      shared%touching(l) = .false.
      associate (link => shared%link(l), pair => pairs(shared%pair(l)))
        if (.not. (there(link%first) .and. there(link%second))) cycle
        guess = contact_normal(pair%normal, gradient(:, link%first), gradient(:, link%second))
        at = shared%member_start(n) - 1 + [link%first, link%second]
        call measure(shared, n, link, at, mesh, bodies(pair%body(1)), bodies(pair%body(2)), pair, &
                     guess, distance)
        shared%touching(l) = distance < pair%lambda
      end associate
    end do
  end subroutine shared_detect

  !> Whether a field has mass at a node.
  pure function node_there(mesh, field, record, point, cutoff) result(there)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, point(3)
    real(dp), intent(in) :: cutoff
    logical :: there
    if (field%kernel == kernel_sgmp) then
      there = node_mass(mesh, field, point) > cutoff
    else
      there = field%moment(record, 1) > cutoff
    end if
  end function node_there

  !> Mass that centres give to a node (Eq. 17).
  pure function node_mass(mesh, field, point) result(mass)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    integer, intent(in) :: point(3)
    real(dp) :: mass
    integer :: j, k, base
    mass = 0.0_dp
    do k = point(3) - merge(1, 0, mesh%ndim >= 2), point(3)
      do j = point(2) - merge(1, 0, mesh%ndim == 3), point(2)
        base = field_base(field, j, k, point(1)) + point(1)
        mass = mass + (field%moment(base - 1, 1) + field%moment(base, 1))
      end do
    end do
    mass = mass*0.5_dp**mesh%ndim
  end function node_mass

  !> Outward direction of a body at a node: sum of V grad N over centres (SGMP, Eq. 88) or particles
  !! (Eq. 87).
  pure function volume_gradient(mesh, field, body, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    real(dp) :: gradient(3)
    if (field%kernel == kernel_sgmp) then
      gradient = centre_gradient(mesh, field, point)
    else
      gradient = particle_gradient(mesh, field%kernel, body, point)
    end if
    gradient = gradient/body%law%density
  end function volume_gradient

  !> Sum of m_c grad N_Ic (Eq. 88), in units of mass per cell.
  pure function centre_gradient(mesh, field, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    integer, intent(in) :: point(3)
    real(dp) :: gradient(3)
    real(dp) :: left, right
    integer :: j, k, base
    gradient = 0.0_dp
    do k = point(3) - merge(1, 0, mesh%ndim >= 2), point(3)
      do j = point(2) - merge(1, 0, mesh%ndim == 3), point(2)
        base = field_base(field, j, k, point(1)) + point(1)
        left = field%moment(base - 1, 1)
        right = field%moment(base, 1)
        gradient(1) = gradient(1) + (left - right)
        if (mesh%ndim == 2) gradient(2) = gradient(2) + merge(left + right, -(left + right), &
          k < point(3))
        if (mesh%ndim == 3) gradient(2) = gradient(2) + merge(left + right, -(left + right), &
          j < point(2))
        if (mesh%ndim == 3) gradient(3) = gradient(3) + merge(left + right, -(left + right), &
          k < point(3))
      end do
    end do
    gradient = gradient*0.5_dp**(mesh%ndim - 1)
  end function centre_gradient

  !> Range of bins whose particles give to a node: lower corner, the upper one is the node itself.
  pure function lowest_bin(kernel, ndim, point) result(bin)
    integer, intent(in) :: kernel, ndim, point(3)
    integer :: bin(3)
    bin = point - merge(1, 2, kernel == kernel_mpm)*[1, merge(1, 0, ndim == 3), merge(1, 0, &
      ndim >= 2)]
  end function lowest_bin

  !> Sum of m_p grad S_Ip (Eq. 87), in units of mass per cell.
  pure function particle_gradient(mesh, kernel, body, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    real(dp) :: gradient(3)
    real(dp) :: s(3), g(3), half(3), node(3), m
    integer :: low(3), i, j, k, number, chunk, left, l, d, nd
    gradient = 0.0_dp
    nd = mesh%ndim
    low = lowest_bin(kernel, nd, point)
    node = real(point([1, row_axis(2, nd), 3]), dp)
    half = 0.0_dp
    s = 1.0_dp
    g = 0.0_dp
    do k = low(3), point(3)
      do j = low(2), point(2)
        do i = low(1), point(1)
          number = particles_bin_of(body%particles, [i, j, k])
          if (number == 0) cycle
          chunk = body%particles%first(number)
          left = body%particles%size(number)
          do while (left > 0)
            do l = 1, min(left, lanes)
              m = body%particles%a(l, 2*nd + 1, chunk)
              if (kernel == kernel_gimp) half = body%half_size
              do d = 1, nd
                if (body%law%slots%stretch > 0) half(d) = body%half_size(d) &
                  *body%particles%b(l, body%law%slots%stretch + d - 1, chunk)
                call weight(body%particles%a(l, d, chunk) - node(d), half(d), s(d), g(d))
              end do
              gradient(1) = gradient(1) + m*(g(1)*s(2)*s(3))
              if (nd >= 2) gradient(2) = gradient(2) + m*(s(1)*g(2)*s(3))
              if (nd == 3) gradient(3) = gradient(3) + m*(s(1)*s(2)*g(3))
            end do
            left = left - lanes
            chunk = body%particles%next(chunk)
          end do
        end do
      end do
    end do
  end function particle_gradient

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

  !> Normal and distance (cells) of a link: the shortest line between the bodies around the node,
  !! or the guess from gradients; distance between the outermost particles along it (Eq. 86).
  pure subroutine measure(shared, n, link, at, mesh, first, second, pair, guess, distance)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n               !! the node
    type(contact_link_t), intent(inout) :: link
    integer, intent(in) :: at(2)           !! its members
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: first, second
    type(contact_pair_t), intent(in) :: pair
    real(dp), intent(in) :: guess(3)       !! normal from the gradients of volume
    real(dp), intent(out) :: distance
    integer :: na, nb
    distance = huge(1.0_dp)
    call surface_around(mesh, first, shared%point(:, n), shared%rows(:, at(1)), shared%held(:, n), &
                        na)
    call surface_around(mesh, second, shared%point(:, n), shared%rows(:, at(2)), &
                        shared%held(:, n), nb)
    if (na == 0 .or. nb == 0) return
    block
      real(dp) :: a(na, mesh%ndim + 1), b(nb, mesh%ndim + 1)
      integer :: ma, mb
      call surface_around(mesh, first, shared%point(:, n), shared%rows(:, at(1)), &
                          shared%held(:, n), ma, a)
      call surface_around(mesh, second, shared%point(:, n), shared%rows(:, at(2)), &
                          shared%held(:, n), mb, b)
      if (ma == 0 .or. mb == 0) return
      call gap(mesh%ndim, a(:ma, :), b(:mb, :), pair, guess, link%normal, distance)
    end block
  end subroutine measure

  !> Normal and distance of two sets of surface particles.
  pure subroutine gap(ndim, a, b, pair, guess, normal, distance)
    integer, intent(in) :: ndim
    real(dp), intent(in), contiguous :: a(:, :), b(:, :)
      !! (particles, ndim + 1) see surface_around
    type(contact_pair_t), intent(in) :: pair
    real(dp), intent(in) :: guess(3)
    real(dp), intent(out) :: normal(3)     !! from the first to the second
    real(dp), intent(out) :: distance
    real(dp) :: start(ndim), line(ndim)
    normal = guess
    distance = huge(1.0_dp)
    if (pair%normal == normal_separating) then
      start = guess(:ndim)
      if (all(abs(start) <= 0.0_dp)) then
        start = sum(b(:, :ndim), 1)/size(b, 1) - sum(a(:, :ndim), 1)/size(a, 1)
      end if
      call separation(ndim, a, b, start, line)
      if (norm2(line) > overlapping) then
        normal = 0.0_dp
        normal(:ndim) = line/norm2(line)
      end if
    end if
    if (all(abs(normal) <= 0.0_dp)) return
    line = normal(:ndim)
    distance = -(reach(ndim, b, -line, pair%near) + reach(ndim, a, line, pair%near))
  end subroutine gap

  !> How far points within a distance of the axis through the origin reach along it; minus a lot
  !! where there are none.
  pure function reach(ndim, points, axis, near) result(furthest)
    integer, intent(in) :: ndim
    real(dp), intent(in) :: points(:, :), axis(:), near
    real(dp) :: furthest
    real(dp) :: along(size(points, 1)), square(size(points, 1))
    integer :: d
    along = 0.0_dp
    square = 0.0_dp
    do d = 1, ndim
      along = along + points(:, d)*axis(d)
      square = square + points(:, d)**2
    end do
    furthest = maxval(merge(along + points(:, ndim + 1), -1.0e30_dp, square - along**2 <= near**2))
  end function reach

  !> Intervals of a body's bins that start the rows around a node, 0 where a row is empty.
  pure function rows_around(mesh, body, point) result(rows)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    integer :: rows(most_rows)
    integer :: low(3), j, k, n
    low = lowest_bin_of(mesh, body, point)
    rows = 0
    n = 0
    do k = low(3), point(3)
      do j = low(2), point(2)
        n = n + 1
        rows(n) = rows_contains_from(body%particles%bins, row_key(j, k), low(1), point(1))
      end do
    end do
  end function rows_around

  !> Surface particles of a body around a node: positions relative to it, surface offsets (cells).
  !! Without `x` only their largest number is found. The rest of the last group repeats a particle.
  pure subroutine surface_around(mesh, body, point, rows, held, n, x)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    integer, intent(in) :: rows(most_rows)
    logical, intent(in) :: held(3)
    integer, intent(out) :: n
    real(dp), intent(inout), optional :: x(:, :)
    integer :: first, i, r, s, chunk, l, d, column
    n = 0
    first = lowest_first(mesh, body, point)
    column = body%law%slots%surface
    associate (particles => body%particles)
      do r = 1, most_rows
        if (rows(r) == 0) cycle
        do s = rows(r), particles%bins%n
          if (particles%bins%key(s) /= particles%bins%key(rows(r))) exit
          do i = max(first, particles%bins%first(s)), min(point(1), particles%bins%last(s))
            if (.not. present(x)) then
              n = n + (particles%size(particles%bin_start(s) + i) + lanes - 1)/lanes
              cycle
            end if
            chunk = particles%first(particles%bin_start(s) + i)
            do while (chunk > 0)
              if (any(particles%b(:, column, chunk) > nowhere)) then
                do l = 1, lanes
                  if (particles%b(l, column, chunk) <= nowhere) cycle
                  n = n + 1
                  do d = 1, mesh%ndim
                    x(n, d) = particles%a(l, d, chunk) - real(point(row_axis(d, mesh%ndim)), dp)
                  end do
                  x(n, mesh%ndim + 1) = particles%b(l, column, chunk)
                end do
              end if
              chunk = particles%next(chunk)
            end do
          end do
        end do
      end do
    end associate
    if (.not. present(x)) then
      n = lanes*n
      return
    end if
    if (n > 0) call fill_group(held(:mesh%ndim), n, x)
  end subroutine surface_around

  !> Puts particles onto the node's planes where it is held, and fills the last group with copies of
  !! the last particle.
  pure subroutine fill_group(held, n, x)
    logical, intent(in) :: held(:)
    integer, intent(inout) :: n
    real(dp), intent(inout) :: x(:, :)
    integer :: d, l
    do d = 1, size(held)
      if (held(d)) x(:n, d) = 0.0_dp
    end do
    do l = n + 1, lanes*((n + lanes - 1)/lanes)
      x(l, :) = x(n, :)
    end do
    n = lanes*((n + lanes - 1)/lanes)
  end subroutine fill_group

  !> First i of the bins around a node.
  pure function lowest_first(mesh, body, point) result(first)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    integer :: first, low(3)
    low = lowest_bin_of(mesh, body, point)
    first = low(1)
  end function lowest_first

  pure function lowest_bin_of(mesh, body, point) result(bin)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    integer, intent(in) :: point(3)
    integer :: bin(3)
    bin = lowest_bin(merge(kernel_sgmp, kernel_mpm, body%particles%shift > 0.25_dp), mesh%ndim, &
      point)
  end function lowest_bin_of

  !> First interval of a row that has points in first..last, 0 if none.
  pure function rows_contains_from(rows, key, first, last) result(s)
    type(rows_t), intent(in) :: rows
    integer(kind(rows%key)), intent(in) :: key
    integer, intent(in) :: first, last
    integer :: s, low, high, middle
    low = 1
    high = rows%n
    do while (low <= high)
      middle = (low + high)/2
      if (rows%key(middle) < key .or. (rows%key(middle) == key .and. rows%last(middle) < first)) &
        then
        low = middle + 1
      else
        high = middle - 1
      end if
    end do
    s = 0
    if (low > rows%n) return
    if (rows%key(low) == key .and. rows%first(low) <= last) s = low
  end function rows_contains_from

end module sgmp_shared_nodes
