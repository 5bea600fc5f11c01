!> Grid nodes that two or more velocity fields share: which bodies and pairs are there, which bins
!! of particles are around, and where both bodies of a pair have mass.
!!
!! The list is rebuilt with the layout of the fields and holds nothing for bodies that are apart.
!! Everything at one node depends on that node alone, so nodes can be visited in any order and by
!! any thread, and two ranks that both solve a node find the same.
module sgmp_shared_nodes
  use sgmp_body, only: body_t
  use sgmp_contact_pairs, only: contact_pair_t, pair_turn
  use sgmp_contact_resolve, only: contact_link_t, link_free
  use sgmp_field, only: field_t
  use sgmp_kernels, only: kernel_centred, kernel_sgmp, stencil_reach
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_place, mesh_t, wall_fixed, wall_free
  use sgmp_rows, only: key_j, key_k, row_key, rows_dilate, rows_find, rows_intersection, &
    rows_planes, rows_points, rows_t, rows_union
  use sgmp_surface_particles, only: surface_bins, surface_list, surface_t
  implicit none
  private
  public :: node_terms_t, shared_nodes_t, shared_body, shared_build, shared_leads, shared_mark, &
            shared_meet, shared_members, shared_parts, shared_place, shared_share
  public :: most_rows, row_axis

  real(dp), parameter :: half = 0.5_dp
  integer, parameter :: most_rows = 9          !! rows of bins whose particles give to a node

  !> What contact at a node adds to the sums of the step, besides impulse and dissipation of its
  !! pairs (sgmp_contact_ledger).
  type :: node_terms_t
    real(dp) :: rigid_work = 0.0_dp, nodes_aa = 0.0_dp, power_before = 0.0_dp
    real(dp) :: external_power = 0.0_dp
  end type node_terms_t

  !> The shared nodes; members are the fields present at a node, links the pairs among them that
  !! have a contact card.
  type :: shared_nodes_t
    integer :: ndim = 3, kernel = kernel_sgmp
    logical :: at_surface = .false.             !! friction acts there (sgmp_contact_levers)
    logical :: around = .false.                 !! nodes have a velocity around the axis
    integer :: nodes = 0, members = 0, links = 0
    integer, allocatable :: point(:, :)         !! (3, nodes) i, j, k
    logical, allocatable :: held(:, :)
      !! (3, nodes) velocity components that a wall holds at zero
    integer, allocatable :: member_start(:)     !! (nodes + 1)
    integer, allocatable :: body(:)             !! (members) the first of the field
    integer, allocatable :: field(:)            !! (members)
    integer, allocatable :: record(:)           !! (members) the node in the field
    integer, allocatable :: interval(:)         !! (members) of the field's work rows
    integer, allocatable :: lead(:)
      !! (members) which member of the node, counted within it, stands for those that are one matter
      !! with it there; itself where there is no seam
    logical :: driven = .false.                 !! motions of parts of some fields are prescribed
    ! (3, members) of these, in this step: the change of velocity that is prescribed, the impulse
    ! of contact that whoever moves them takes, and the energy that it has from them.
    real(dp), allocatable :: driven_kick(:, :), driven_push(:, :), driven_work(:, :)
    integer, allocatable :: body_start(:)       !! (fields + 1)
    integer, allocatable :: bodies(:)           !! of each field, in their order
    integer, allocatable :: bins_start(:)       !! (members + 1)
    integer, allocatable :: bins(:, :, :)
      !! (2, most_rows, bodies of members) first and last bin, in the surface's list, of each row
      !! around, for each body of the member's field
    type(surface_t), allocatable :: surface(:)  !! (bodies) surface particles around shared nodes
    integer, allocatable :: link_start(:)       !! (nodes + 1)
    integer, allocatable :: pair(:)             !! (links)
    type(contact_link_t), allocatable :: link(:)  !! (links) members counted within the node
    logical, allocatable :: meets(:)            !! (links) both bodies have mass at the node
    logical, allocatable :: near(:)             !! (links) so close that they may touch in this step
    real(dp), allocatable :: gap(:)             !! (links) that is left between the bodies (cells)
    real(dp), allocatable :: middle(:)
      !! (links) from the node along the normal to half way between their surfaces (cells)
    type(node_terms_t), allocatable :: terms(:)  !! (nodes)
  end type shared_nodes_t

contains

  !> Lists the nodes that fields of contact pairs share in a range of planes.
  pure subroutine shared_build(shared, mesh, fields, bodies, pairs, planes, at_surface)
    type(shared_nodes_t), intent(out) :: shared
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    integer, intent(in) :: planes(2)             !! first and last k
    logical, intent(in) :: at_surface            !! friction acts at the surface
    type(rows_t) :: all, common, sum_of
    integer :: p, n, m
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
    shared%at_surface = at_surface
    shared%kernel = fields(1)%kernel
    shared%nodes = n
    allocate (shared%point(3, n), shared%held(3, n), shared%member_start(n + 1), &
      shared%link_start(n + 1))
    call list_points(shared, mesh, all)
    call list_members(shared, fields, pairs, .false.)
    allocate (shared%body(shared%members), shared%field(shared%members), &
      shared%record(shared%members), shared%interval(shared%members), &
      shared%lead(shared%members))
    shared%driven = any(fields%columns%driven > 0)
    m = merge(shared%members, 0, shared%driven)
    allocate (shared%driven_kick(3, m), shared%driven_push(3, m), shared%driven_work(3, m), &
              source=0.0_dp)
    allocate (shared%pair(shared%links), shared%link(shared%links))
    allocate (shared%meets(shared%links), shared%near(shared%links), source=.false.)
    allocate (shared%gap(shared%links), shared%middle(shared%links), source=0.0_dp)
    allocate (shared%terms(n))
    call list_members(shared, fields, pairs, .true.)
    call list_bodies(shared, size(fields), bodies)
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

  !> Position of a shared node.
  pure function shared_place(shared, n, mesh) result(position)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n
    type(mesh_t), intent(in) :: mesh
    real(dp) :: position(3)
    integer :: d
    position = 0.0_dp
    do d = 1, mesh%ndim
      position(d) = mesh_place(mesh, d, real(shared%point(row_axis(d, mesh%ndim), n), dp))
    end do
  end function shared_place

  !> Counts, or with `fill` lists, the fields and the pairs at each node.
  pure subroutine list_members(shared, fields, pairs, fill)
    type(shared_nodes_t), intent(inout) :: shared
    type(field_t), intent(in) :: fields(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    logical, intent(in) :: fill
    integer :: n, p, m, l, side, at(2), record(2), interval(2), s, from(2, size(pairs))
    from = 1
    m = 0
    l = 0
    do n = 1, shared%nodes
      shared%member_start(n) = m + 1
      shared%link_start(n) = l + 1
      do p = 1, size(pairs)
        do side = 1, 2
          associate (field => fields(pairs(p)%field(side)))
            call rows_find(field%work, row_key(shared%point(2, n), shared%point(3, n)), &
                           shared%point(1, n), from(side, p), s)
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
            shared%lead(s) = s - shared%member_start(n) + 1
          end if
          at(side) = s - shared%member_start(n) + 1
        end do
        shared%pair(l) = p
        shared%link(l)%first = at(1)
        shared%link(l)%second = at(2)
        shared%link(l)%friction = pairs(p)%friction
        shared%link(l)%at_surface = shared%at_surface
      end do
    end do
    shared%member_start(shared%nodes + 1) = m + 1
    shared%link_start(shared%nodes + 1) = l + 1
    shared%members = m
    shared%links = l
  end subroutine list_members

  !> Lists the bodies of each field.
  pure subroutine list_bodies(shared, fields, bodies)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: fields
    type(body_t), intent(in) :: bodies(:)
    integer :: f, b, m
    allocate (shared%body_start(fields + 1), shared%bodies(size(bodies)))
    allocate (shared%bins_start(shared%members + 1))
    m = 0
    do f = 1, fields
      shared%body_start(f) = m + 1
      do b = 1, size(bodies)
        if (bodies(b)%field /= f) cycle
        m = m + 1
        shared%bodies(m) = b
      end do
    end do
    shared%body_start(fields + 1) = m + 1
    shared%bins_start(1) = 1
    do m = 1, shared%members
      shared%bins_start(m + 1) = shared%bins_start(m) + shared%body_start(shared%field(m) + 1) &
                                 - shared%body_start(shared%field(m))
    end do
  end subroutine list_bodies

  !> Body number `part` of a member's field.
  pure function shared_body(shared, m, part) result(b)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: m, part               !! member; from 1
    integer :: b
    b = shared%bodies(shared%body_start(shared%field(m)) + part - 1)
  end function shared_body

  !> How many bodies the field of a member has.
  pure function shared_parts(shared, m) result(parts)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: m
    integer :: parts
    parts = shared%bins_start(m + 1) - shared%bins_start(m)
  end function shared_parts

  !> Lists the bins around shared nodes, and which of them are around each node.
  pure subroutine list_bins(shared, mesh, nodes, bodies)
    type(shared_nodes_t), intent(inout) :: shared
    type(mesh_t), intent(in) :: mesh
    type(rows_t), intent(in) :: nodes
    type(body_t), intent(in) :: bodies(:)
    type(rows_t) :: around
    integer, allocatable :: place(:, :)          !! (most_rows, bodies) see surface_bins
    integer :: b, n, m, part, low(3)
    allocate (shared%surface(size(bodies)))
    allocate (shared%bins(2, most_rows, shared%bins_start(shared%members + 1) - 1))
    do b = 1, size(bodies)
      if (.not. any(shared%field == bodies(b)%field)) cycle
      call rows_dilate(nodes, lowest_bin(shared%kernel, mesh%ndim, [0, 0, 0]), [0, 0, 0], around)
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
        low = lowest_bin(shared%kernel, mesh%ndim, shared%point(:, n))
        do part = 1, shared_parts(shared, m)
          b = shared_body(shared, m, part)
          call bins_around(shared%surface(b), low, shared%point(:, n), place(:, b), &
                           shared%bins(:, :, shared%bins_start(m) + part - 1))
        end do
      end do
    end do
  end subroutine list_bins

  !> Bins of a body in the rows from a corner to a node.
  pure subroutine bins_around(surface, low, point, place, bins)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: low(3), point(3)
    integer, intent(inout) :: place(most_rows)   !! see surface_bins
    integer, intent(out) :: bins(2, most_rows)
    integer :: r, j, k
    r = 0
    do k = low(3), point(3)
      do j = low(2), point(2)
        r = r + 1
        call surface_bins(surface, row_key(j, k), low(1), point(1), place(r), bins(:, r))
      end do
    end do
    bins(1, r + 1:) = 1
    bins(2, r + 1:) = 0
  end subroutine bins_around

  !> Range of bins whose particles give to a node: lower corner, the upper one is the node itself.
  pure function lowest_bin(kernel, ndim, point) result(bin)
    integer, intent(in) :: kernel, ndim, point(3)
    integer :: bin(3)
    bin = point - stencil_reach(kernel)*[1, merge(1, 0, ndim == 3), merge(1, 0, ndim >= 2)]
  end function lowest_bin

  !> Finds the links of a node at which both bodies have mass.
  pure subroutine shared_meet(shared, n, fields, cutoff)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: cutoff               !! nodes lighter than this are ignored
    integer :: at(2), l, side
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      at = shared_members(shared, n, l)
      shared%meets(l) = .true.
      do side = 1, 2
        shared%meets(l) = shared%meets(l) .and. &
          node_mass(fields(shared%field(at(side))), shared, at(side), n, &
                    fields(shared%field(at(side)))%columns%mass) > cutoff
      end do
    end do
  end subroutine shared_meet

  !> Which links of a node share their velocity: where matter goes on from one label to another, and
  !! where debris is more than half of one body's mass.
  pure subroutine shared_share(shared, n, fields, pairs)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(field_t), intent(in) :: fields(:)       !! those that collide know the mass of their debris
    type(contact_pair_t), intent(in) :: pairs(:)  !! all, or none where no body touches itself
    integer :: at(2), l, side
    if (size(pairs) > 0) then
      call join_seams(shared, n, fields)
      call hand_on(shared, n, pairs)
    end if
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      shared%link(l)%shares = shared%link(l)%seam
      if (.not. shared%meets(l) .or. shared%link(l)%seam) cycle
      at = shared_members(shared, n, l)
      do side = 1, 2
        associate (field => fields(shared%field(at(side))))
          if (.not. field%collides) cycle
          shared%link(l)%shares = shared%link(l)%shares .or. &
            whole_mass(fields, shared, at(side), n, .true.) > &
            half*whole_mass(fields, shared, at(side), n, .false.)
        end associate
      end do
    end do
  end subroutine shared_share

  !> Finds which members of a node are one matter, and lets the heaviest stand for all of them: what
  !! touches them touches one body.
  pure subroutine join_seams(shared, n, fields)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(field_t), intent(in) :: fields(:)
    integer :: group(shared%member_start(n + 1) - shared%member_start(n))
    real(dp) :: mass(size(group))
    integer :: first, last, k, l
    first = shared%link_start(n)
    last = shared%link_start(n + 1) - 1
    associate (lead => shared%lead(shared%member_start(n):shared%member_start(n + 1) - 1), &
               links => shared%link(first:last))
      lead = [(k, k=1, size(lead))]
      if (.not. any(links%seam .and. shared%meets(first:last))) return
      group = lead
      do k = 2, size(group)  ! as often as the longest chain may need
        do l = first, last
          if (.not. (shared%link(l)%seam .and. shared%meets(l))) cycle
          associate (two => [shared%link(l)%first, shared%link(l)%second])
            group(two) = minval(group(two))
          end associate
        end do
      end do
      do k = 1, size(group)
        associate (m => shared%member_start(n) + k - 1)
          mass(k) = node_mass(fields(shared%field(m)), shared, m, n, &
                              fields(shared%field(m))%columns%mass)
        end associate
      end do
      do k = 1, size(group)
        lead(k) = maxloc(mass, 1, mask=group == group(k))
      end do
    end associate
  end subroutine join_seams

  !> A link that rests, because another label stands for the matter or all of it has got another
  !! label, leaves its state to the one that acts between the same bodies.
  pure subroutine hand_on(shared, n, pairs)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(contact_pair_t), intent(in) :: pairs(:)
    integer :: l, q, turn
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      if (shared%link(l)%state == link_free .or. shared%link(l)%seam) cycle
      if (acts(shared, n, l)) cycle
      do q = shared%link_start(n), shared%link_start(n + 1) - 1
        if (q == l .or. shared%link(q)%state /= link_free .or. shared%link(q)%seam) cycle
        turn = pair_turn(pairs(shared%pair(l)), pairs(shared%pair(q)))
        if (turn == 0 .or. .not. acts(shared, n, q)) cycle
        shared%link(q)%state = shared%link(l)%state
        shared%link(q)%held_normal = turn*shared%link(l)%held_normal
      end do
      shared%link(l)%state = link_free
    end do
  end subroutine hand_on

  !> Whether the bodies of a link meet, and it is the one that acts for them.
  pure function acts(shared, n, l) result(yes)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l                  !! node and link
    logical :: yes
    yes = shared%meets(l)
    if (yes) yes = shared_leads(shared, n, l)
  end function acts

  !> Whether a link is between two members that stand for themselves or for what is one with them.
  pure function shared_leads(shared, n, l) result(yes)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l                  !! node and link
    logical :: yes
    integer :: at(2)
    at = shared_members(shared, n, l)
    yes = all(shared%lead(at) == [shared%link(l)%first, shared%link(l)%second])
  end function shared_leads

  !> Mass of a member at a node and of all that are one with it, or of their debris.
  pure function whole_mass(fields, shared, m, n, debris) result(mass)
    type(field_t), intent(in) :: fields(:)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: m, n
    logical, intent(in) :: debris
    real(dp) :: mass
    integer :: s
    mass = 0.0_dp
    do s = shared%member_start(n), shared%member_start(n + 1) - 1
      if (shared%lead(s) /= shared%lead(m)) cycle
      associate (field => fields(shared%field(s)))
        if (debris .and. field%columns%debris == 0) cycle
        mass = mass + node_mass(field, shared, s, n, &
                                merge(field%columns%debris, field%columns%mass, debris))
      end associate
    end do
  end function whole_mass

  !> Mass of a member at a node (Eq. 17), or of a part of it.
  pure function node_mass(field, shared, m, n, column) result(mass)
    type(field_t), intent(in) :: field
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: m, n
    integer, intent(in) :: column                !! of the moments
    real(dp) :: mass
    integer :: dj, dk, base
    if (.not. kernel_centred(field%kernel)) then
      mass = field%moment(shared%record(m), column)
      return
    end if
    mass = 0.0_dp
    do dk = -merge(1, 0, field%ndim >= 2), 0
      do dj = -merge(1, 0, field%ndim == 3), 0
        base = field%neighbour(dj, dk, shared%interval(m)) + shared%point(1, n)
        mass = mass + (field%moment(base - 1, column) + field%moment(base, column))
      end do
    end do
    mass = mass*0.5_dp**field%ndim
  end function node_mass

  !> Marks the bins of all bodies around the nodes of a range of planes where bodies meet, but not
  !! along a seam, and tells whether any do.
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
        if (.not. shared%meets(l) .or. shared%link(l)%seam) cycle
        if (.not. any_meet) then
          do b = 1, size(shared%surface)
            if (shared%surface(b)%bins > 0) shared%surface(b)%marked = .false.
          end do
        end if
        any_meet = .true.
        call mark_around(shared, shared_members(shared, n, l))
      end do
    end do
  end subroutine shared_mark

  !> Marks the bins around a node of the two members of a link.
  pure subroutine mark_around(shared, at)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: at(2)                 !! members
    integer :: side, part, r
    do side = 1, 2
      do part = 1, shared_parts(shared, at(side))
        associate (bins => shared%bins(:, :, shared%bins_start(at(side)) + part - 1), &
                   surface => shared%surface(shared_body(shared, at(side), part)))
          do r = 1, most_rows
            surface%marked(bins(1, r):bins(2, r)) = .true.
          end do
        end associate
      end do
    end do
  end subroutine mark_around

  !> The members of a link.
  pure function shared_members(shared, n, l) result(at)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l                  !! node and link
    integer :: at(2)
    at = shared%member_start(n) - 1 + [shared%link(l)%first, shared%link(l)%second]
  end function shared_members

end module sgmp_shared_nodes
