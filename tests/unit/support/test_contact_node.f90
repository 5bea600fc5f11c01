!> Shared nodes made by hand: two bodies, each in a field of its own, with one pair between them.
module test_contact_node
  use sgmp_kinds, only: dp, lanes
  use sgmp_shared_nodes, only: most_rows, shared_nodes_t
  use sgmp_surface_particles, only: surface_t
  implicit none
  private
  public :: shared_nodes_of_two, put_around

contains

  !> Nodes at some points (i, j, k), in ascending order; both bodies have mass at each, the first in record n of its
  !! field.
  subroutine shared_nodes_of_two(shared, ndim, point)
    type(shared_nodes_t), intent(out) :: shared
    integer, intent(in) :: ndim, point(:, :)
    integer :: n, m, nodes
    nodes = size(point, 2)
    shared%ndim = ndim
    shared%nodes = nodes
    shared%members = 2*nodes
    shared%links = nodes
    shared%point = point
    allocate (shared%held(3, nodes), source=.false.)
    shared%member_start = [(1 + 2*(n - 1), n=1, nodes + 1)]
    shared%body = [(1 + modulo(m - 1, 2), m=1, 2*nodes)]
    shared%field = shared%body
    shared%record = [((m + 1)/2, m=1, 2*nodes)]
    allocate (shared%interval(2*nodes), source=1)
    shared%lead = [(1 + modulo(m - 1, 2), m=1, 2*nodes)]
    shared%body_start = [1, 2, 3]  ! a body for each field
    shared%bodies = [1, 2]
    shared%bins_start = [(n, n=1, 2*nodes + 1)]
    allocate (shared%bins(2, most_rows, 2*nodes))
    shared%bins(1, :, :) = 1
    shared%bins(2, :, :) = 0
    allocate (shared%surface(2))
    shared%link_start = [(n, n=1, nodes + 1)]
    allocate (shared%pair(nodes), source=1)
    allocate (shared%link(nodes), shared%terms(nodes))
    shared%link%first = 1
    shared%link%second = 2
    allocate (shared%meets(nodes), source=.true.)
    allocate (shared%near(nodes), source=.false.)
    allocate (shared%gap(nodes), shared%middle(nodes), source=0.0_dp)
  end subroutine shared_nodes_of_two

  !> Surface particles of a body around the first node, all in one bin: positions relative to the node, 0 along axes
  !! that do not exist, and offsets.
  subroutine put_around(shared, body, place, offset)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: body
    real(dp), intent(in) :: place(:, :), offset
    type(surface_t) :: surface
    real(dp) :: node(3)
    integer :: p, n
    n = size(place, 2)
    node = real(shared%point(:, 1), dp)
    if (shared%ndim == 2) node = [node(1), node(3), 0.0_dp]
    if (shared%ndim == 1) node(2:) = 0.0_dp
    surface%bins = 1
    surface%start = [1, n + 1]
    allocate (surface%x(n + lanes, 4), source=0.0_dp)
    do p = 1, n
      surface%x(p, :3) = node + place(:, p)
      surface%x(p, 4) = offset
    end do
    shared%surface(body) = surface
    shared%bins(2, 1, body) = 1
  end subroutine put_around

end module test_contact_node
