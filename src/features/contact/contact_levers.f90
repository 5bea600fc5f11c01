!> How friction between two bodies reaches their surface where rotation is exact (doc/rotation.md).
!!
!! A node's velocity belongs to the centre of mass X_I of what the node stands for, and a force at
!! the node acts on particles there: inside the body. Friction with so short a lever turns a body
!! too little. Here slip is measured, and friction acts, at the point x_s where the bodies touch, by
!! shares a_J of the node and those around it with sum a_J = 1 and sum a_J X_J = x_s:
!!
!!     v_s = sum_J a_J v_J,    impulse on node J: a_J T
!!
!! One is the transpose of the other, so friction has the power T . v_s, and as both bodies feel it
!! at one point it keeps angular momentum. Of all such shares those that differ least from the node
!! alone are taken, by sum (a_J - a_J^I)^2/m_J; a node whose surroundings are too flat to tell how
!! they turn keeps its friction to itself.
module sgmp_contact_levers
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_inverse_mass
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_place
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_shared_nodes, only: row_axis, shared_members, shared_nodes_t
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: levers_t, levers_layout, levers_find, levers_see, levers_give, tangential, shift_of
  public :: colours, parts_of, plane_colours

  integer, parameter :: around = 27            !! a node and those around it
  integer, parameter :: itself = 14            !! the place of the node among them
  integer, parameter :: colours = 27           !! of nodes, those of a plane follow each other
  integer, parameter :: plane_colours = 3      !! of planes
  integer, parameter :: parts_of = 3           !! a relative vector, see levers_t
  real(dp), parameter :: least_spread = 1.0e-6_dp
    !! determinant of the spread of the masses around (cells^2 along each axis)
  real(dp), parameter :: most_turn = 4.0_dp
    !! largest response of the surroundings' rotation to an impulse over that of the node alone

  !> How friction at each link reaches the surface, and what it meets there.
  type :: levers_t
    integer, allocatable :: node(:)            !! (nodes) by colours
    integer :: first(colours + 1) = 1          !! of each colour
    integer, allocatable :: nodes(:, :)        !! (side, links) that have a share; rigid bodies: 0
    integer, allocatable :: place(:, :, :)     !! (around, side, links) which of those around
    integer, allocatable :: record(:, :, :)    !! (around, side, links) in the field
    real(dp), allocatable :: share(:, :, :)    !! (around, side, links) a_J
    real(dp), allocatable :: gain(:, :, :)     !! (around, side, links) a_J/m_J
    real(dp), allocatable :: response(:)
      !! (links) slip that a unit of impulse takes, sum a_J^2/m_J; 0: the bodies are not near
    real(dp) :: h = 1.0_dp                     !! cell side
    ! Relative vectors at the surface, across the normal: the parts of deformable bodies, of rigid
    ! ones whose motion is prescribed, and of free ones. (3, parts_of, links)
    real(dp), allocatable :: pull(:, :, :)     !! change of velocity by all forces but contact
    real(dp), allocatable :: before(:, :, :)   !! velocity before the kick
    real(dp), allocatable :: apart(:, :, :)
      !! velocity that strains the particles before it was made to obey
    real(dp), allocatable :: pressed(:, :, :)  !! the pull with the contact forces along the normals
    real(dp), allocatable :: external(:, :)
      !! (3, links) acceleration by gravity, body forces and loads, of deformable bodies
    real(dp), allocatable :: booked(:, :)      !! the same without forces on faces
  end type levers_t

contains

  !> Room for a new list of shared nodes, and their order.
  pure subroutine levers_layout(levers, shared, h)
    type(levers_t), intent(out) :: levers
    type(shared_nodes_t), intent(in) :: shared
    real(dp), intent(in) :: h                  !! cell side
    integer :: n, c, next(colours)
    levers%h = h
    allocate (levers%node(shared%nodes), levers%response(shared%links))
    allocate (levers%nodes(2, shared%links), levers%place(around, 2, shared%links), &
              levers%record(around, 2, shared%links))
    allocate (levers%share(around, 2, shared%links), levers%gain(around, 2, shared%links))
    allocate (levers%pull(3, parts_of, shared%links), levers%before(3, parts_of, shared%links), &
              levers%apart(3, parts_of, shared%links), levers%pressed(3, parts_of, shared%links), &
              levers%external(3, shared%links), levers%booked(3, shared%links))
    next = 0
    do n = 1, shared%nodes
      c = colour(shared%point(:, n))
      next(c) = next(c) + 1
    end do
    do c = 1, colours
      levers%first(c + 1) = levers%first(c) + next(c)
    end do
    next = levers%first(:colours)
    do n = 1, shared%nodes
      c = colour(shared%point(:, n))
      levers%node(next(c)) = n
      next(c) = next(c) + 1
    end do
  end subroutine levers_layout

  pure function colour(point) result(c)
    integer, intent(in) :: point(3)
    integer :: c
    c = 1 + sum(modulo(point, 3)*[1, 3, 9])
  end function colour

  !> Shares of all links of a node. It must be known which bodies are near, and what the nodes
  !! around hold.
  pure subroutine levers_find(levers, shared, n, mesh, fields, bodies)
    type(levers_t), intent(inout) :: levers
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n                   !! the node
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer :: l, side, at(2)
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      levers%response(l) = 0.0_dp
      if (.not. shared%near(l) .or. shared%link(l)%shares) cycle
      at = shared_members(shared, n, l)
      do side = 1, 2
        levers%nodes(side, l) = 0
        if (bodies(shared%body(at(side)))%rigid) cycle
        call find_shares(levers, shared, n, l, side, at(side), mesh, &
                         fields(shared%field(at(side))))
        levers%response(l) = levers%response(l) + &
                             dot_product(levers%share(:levers%nodes(side, l), side, l), &
                                         levers%gain(:levers%nodes(side, l), side, l))
      end do
    end do
  end subroutine levers_find

  !> Shares of the nodes around a node in what happens where the bodies of a link touch.
  pure subroutine find_shares(levers, shared, n, l, side, m, mesh, field)
    type(levers_t), intent(inout) :: levers
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l, side, m       !! node, link, side of it and member
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    real(dp), dimension(around) :: inverse, part
    real(dp) :: x(3, around), spread(3, 3), way(3), turn(3), middle(3)
    integer :: low(3), high(3), shift(3), b, a, r, nodes, own, nd
    logical :: found
    nd = shared%ndim
    call reach(mesh, shared%point(:, n), low, high)
    nodes = 0
    own = 0
    x = 0.0_dp
    do b = 1, around
      shift = shift_of(b)
      if (any(shift < low .or. shift > high)) cycle
      r = field%neighbour(shift(2), shift(3), shared%interval(m)) + shared%point(1, n) + shift(1)
      if (field%node(r, node_inverse_mass(nd)) <= 0.0_dp) cycle
      nodes = nodes + 1
      if (b == itself) own = nodes
      levers%place(nodes, side, l) = b
      levers%record(nodes, side, l) = r
      inverse(nodes) = field%node(r, node_inverse_mass(nd))
      x(:nd, nodes) = ways(mesh, shared%point(:, n), shift) + offset_of(field, r, nd)
    end do
    levers%nodes(side, l) = nodes
    part(:nodes) = 1.0_dp/inverse(:nodes)
    part(:nodes) = part(:nodes)/sum(part(:nodes))
    way = shared%middle(l)*shared%link(l)%normal - x(:, own)
    middle = matmul(x(:, :nodes), part(:nodes))
    spread = 0.0_dp
    do b = 1, nodes
      x(:, b) = x(:, b) - middle
      do a = 1, 3
        spread(:, a) = spread(:, a) + part(b)*x(a, b)*x(:, b)
      end do
    end do
    if (nd == 2) spread(3, 3) = 1.0_dp
    call solve(spread, way, turn, found)
    found = found .and. dot_product(way, turn)*part(own) <= most_turn
    do b = 1, nodes
      levers%share(b, side, l) = merge(1.0_dp, 0.0_dp, b == own)
      if (found) levers%share(b, side, l) = levers%share(b, side, l) + &
                                            part(b)*dot_product(turn, x(:, b))
      levers%gain(b, side, l) = levers%share(b, side, l)*inverse(b)
    end do
  end subroutine find_shares

  !> From a node to one around it (smallest cell).
  pure function ways(mesh, point, shift) result(way)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: point(3), shift(3)    !! along i, j, k
    real(dp) :: way(mesh%ndim)
    integer :: axis, a
    do axis = 1, mesh%ndim
      a = row_axis(axis, mesh%ndim)
      way(axis) = shift(a)
      if (mesh%axes(axis)%graded) then
        way(axis) = graded_place(mesh%axes(axis), real(point(a) + shift(a), dp)) - &
                    graded_place(mesh%axes(axis), real(point(a), dp))
      end if
    end do
  end function ways

  !> Where a node's centre of mass lies, from the node (cells).
  pure function offset_of(field, r, nd) result(offset)
    type(field_t), intent(in) :: field
    integer, intent(in) :: r, nd                 !! record, dimensions
    real(dp) :: offset(nd)
    offset = 0.0_dp
    if (allocated(field%rotation%offset)) offset = field%rotation%offset(:nd, r)
  end function offset_of

  !> Steps along i, j, k to a node around.
  pure function shift_of(b) result(shift)
    integer, intent(in) :: b
    integer :: shift(3)
    shift = [mod(b - 1, 3), mod((b - 1)/3, 3), (b - 1)/9] - 1
  end function shift_of

  !> Which nodes around a node may have a share: none behind a wall, and on one only if the node
  !! itself is.
  pure subroutine reach(mesh, point, low, high)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: point(3)
    integer, intent(out) :: low(3), high(3)
    integer :: axis, a
    low = 0
    high = 0
    do axis = 1, mesh%ndim
      a = row_axis(axis, mesh%ndim)
      low(a) = -1
      high(a) = 1
      if (mesh%wall(1, axis) /= wall_free .and. point(a) <= mesh%lower(axis) + 1) low(a) = 0
      if (mesh%wall(2, axis) /= wall_free .and. point(a) >= mesh%upper(axis) - 1) high(a) = 0
    end do
  end subroutine reach

  !> Solves three equations.
  pure subroutine solve(a, b, x, found)
    real(dp), intent(in) :: a(3, 3), b(3)      !! symmetric
    real(dp), intent(out) :: x(3)
    logical, intent(out) :: found              !! the matrix has an inverse
    real(dp) :: c(3, 3), determinant
    c(:, 1) = cross(a(:, 2), a(:, 3))
    c(:, 2) = cross(a(:, 3), a(:, 1))
    c(:, 3) = cross(a(:, 1), a(:, 2))
    determinant = dot_product(a(:, 1), c(:, 1))
    found = determinant > least_spread
    x = 0.0_dp
    if (found) x = matmul(b, c)/determinant
  end subroutine solve

  !> What a link sees of a nodal vector at the surface: first body minus second, across the normal,
  !! of deformable and of rigid bodies.
  pure function levers_see(levers, shared, n, l, fields, bodies, column, slopes) result(apart)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l                !! node and link
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: column              !! the first of the vector's
    real(dp), intent(in) :: slopes(2)
      !! its gradient in a rigid body: of this step's velocity, and of that before
    real(dp) :: apart(3, parts_of)
    real(dp) :: vector(3)
    integer :: side, at(2), b, d, last, kind
    at = shared_members(shared, n, l)
    last = column + shared%ndim - 1
    apart = 0.0_dp
    do side = 1, 2
      vector = 0.0_dp
      kind = merge(2, 1, bodies(shared%body(at(side)))%rigid)
      associate (field => fields(shared%field(at(side))), nd => shared%ndim, &
                 motion => bodies(shared%body(at(side)))%rigid_motion)
        if (kind == 2) vector(:nd) = field%node(shared%record(at(side)), column:last)
        if (motion%turns) vector = vector + &
          matmul(slopes(1)*motion%gradient + slopes(2)*motion%gradient_before, &
                 levers%h*shared%middle(l)*shared%link(l)%normal)
        if (motion%free) kind = 3
        do b = 1, levers%nodes(side, l)
          do d = 1, nd
            vector(d) = vector(d) + levers%share(b, side, l)* &
                                    field%node(levers%record(b, side, l), column + d - 1)
          end do
        end do
      end associate
      apart(:, kind) = apart(:, kind) + merge(vector, -vector, side == 1)
    end do
    do kind = 1, parts_of
      apart(:, kind) = tangential(shared, n, l, apart(:, kind))
    end do
  end function levers_see

  !> The part of a vector across the normal of a link, and along what walls hold.
  pure function tangential(shared, n, l, vector) result(across)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l
    real(dp), intent(in) :: vector(3)
    real(dp) :: across(3)
    across = merge(0.0_dp, vector, shared%held(:, n))
    associate (normal => shared%link(l)%normal)
      across = across - dot_product(across, normal)*normal
    end associate
  end function tangential

  !> Adds to a nodal vector what an impulse on the second body, and its opposite on the first,
  !! changes.
  pure subroutine levers_give(levers, shared, n, l, impulse, column, fields)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l
    real(dp), intent(in) :: impulse(3)
    integer, intent(in) :: column
    type(field_t), intent(inout) :: fields(:)
    real(dp) :: change(3)
    integer :: side, at(2), b, d
    at = shared_members(shared, n, l)
    do side = 1, 2
      change = merge(-impulse, impulse, side == 1)
      associate (field => fields(shared%field(at(side))), gain => levers%gain(:, side, l), &
                 r => levers%record(:, side, l))
        do b = 1, levers%nodes(side, l)
          do d = 1, shared%ndim
            field%node(r(b), column + d - 1) = field%node(r(b), column + d - 1) + gain(b)*change(d)
          end do
        end do
      end associate
    end do
  end subroutine levers_give

end module sgmp_contact_levers
