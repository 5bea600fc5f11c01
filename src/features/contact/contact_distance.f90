!> How far two bodies are apart at a node, and in which direction: from the surface particles around
!! it (Eq. 86).
module sgmp_contact_distance
  use sgmp_body, only: body_t
  use sgmp_contact_normals, only: contact_normal, volume_gradient
  use sgmp_contact_pairs, only: contact_pair_t, normal_separating
  use sgmp_contact_resolve, only: link_sharing
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_place, graded_spacing
  use sgmp_kernels, only: stencil_reach
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_separation, only: separation
  use sgmp_shared_nodes, only: most_rows, row_axis, shared_body, shared_leads, shared_members, &
                               shared_nodes_t, shared_parts
  use sgmp_surface_particles, only: surface_t
  implicit none
  private
  public :: clouds_t, distance_detect

  real(dp), parameter :: overlapping = 1.0e-3_dp
    !! distance (cells) below which the shortest line is not trusted
  real(dp), parameter :: far = 10.0_dp         !! no surface around a node is (cells)
  real(dp), parameter :: nowhere = -1.0e30_dp  !! reach of a body that is not there
  real(dp), parameter :: margin = 0.25_dp
    !! gap (cells) that bodies may close in a step and that is therefore measured
  real(dp), parameter :: aside = 0.75_dp       !! see reach_squared
  real(dp), parameter :: intruding = 0.5_dp
    !! part of the distance of bodies that touch, below which all nodes keep a fluid out
  real(dp), parameter :: edge = 1.0e-6_dp
    !! what lies so near to a limit (cells) is on one side of it, whatever its last bits

  !> Room for the surface particles of two bodies around a node, kept from node to node.
  type :: clouds_t
    real(dp), allocatable :: first(:, :), second(:, :)
      !! (balls or more, 4) centre relative to the node, 0 along axes that do not exist; radius
  end type clouds_t

contains

  !> Normals of all links of a node, and which of them are close enough to touch (Eqs. 86-88).
  !! Which of them meet must be known, and the surface particles packed.
  pure subroutine distance_detect(shared, n, mesh, fields, bodies, pairs, clouds)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n                     !! the node
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    type(clouds_t), intent(inout) :: clouds
    integer :: at(2), balls(2), l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      shared%near(l) = .false.
      if (.not. shared%meets(l)) cycle
      if (shared%link(l)%shares) then
        if (shared%link(l)%seam .or. shared_leads(shared, n, l)) call touch(shared, l)
        cycle
      end if
      if (.not. shared_leads(shared, n, l)) cycle
      at = shared_members(shared, n, l)
      call cloud_around(shared, n, at(1), mesh, balls(1), clouds%first)
      call cloud_around(shared, n, at(2), mesh, balls(2), clouds%second)
      if (any(balls == 0)) cycle
      call measure(shared, n, l, at, mesh, fields, bodies, pairs(shared%pair(l)), balls, clouds)
    end do
  end subroutine distance_detect

  !> Debris touches whatever it meets, and matter what goes on behind a seam, from the start of the
  !! step; all directions are alike, and any is the normal.
  pure subroutine touch(shared, l)
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: l
    shared%near(l) = .true.
    shared%gap(l) = 0.0_dp
    shared%middle(l) = 0.0_dp
    shared%link(l)%normal = [1.0_dp, 0.0_dp, 0.0_dp]
    if (.not. shared%link(l)%seam) return
    shared%link(l)%state = link_sharing
    shared%link(l)%held_normal = shared%link(l)%normal
  end subroutine touch

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
    real(dp) :: line(3), gradient(3, 2), length, above, below, near2(2), sides(2)
    integer :: axes, side
    length = 0.0_dp
    if (pair%normal == normal_separating) then
      call separation(mesh%ndim, balls(1), clouds%first, balls(2), clouds%second, &
                      middle(balls(2), clouds%second) - middle(balls(1), clouds%first), &
                      pair%lambda + margin, line)
      length = norm2(line)
      if (length > pair%lambda + margin) return
    end if
    associate (normal => shared%link(l)%normal)
      if (length > overlapping) then
        normal = line/length
      else
        do side = 1, 2
          gradient(:, side) = whole_gradient(mesh, fields, shared, n, at(side), bodies)
          where (shared%held(:, n)) gradient(:, side) = 0.0_dp  ! the mirror image cancels it
        end do
        normal = contact_normal(pair%normal, gradient(:, 1), gradient(:, 2))
        if (all(abs(normal) <= 0.0_dp)) return
      end if
      axes = mesh%ndim - 1 - count(shared%held(:mesh%ndim, n))
      sides = local_sides(mesh, shared, n, normal)
      near2 = [reach_squared(aside, sides(2)*pair%spacing, axes), &
               reach_squared(2.0_dp*aside, sides(2)*pair%spacing, axes)]
      above = -reach(size(clouds%second, 1), balls(2), clouds%second, -normal, near2)
      below = reach(size(clouds%first, 1), balls(1), clouds%first, normal, near2)
      shared%gap(l) = max(0.0_dp, above - below - pair%lambda)
      ! Fluids are so thin or so stretched, gas in space and water along what it flows past, that no
      ! particle may lie near the normal, and go through what does not wait for them: all their
      ! particles around count.
      if (pair%fills) shared%gap(l) = max(0.0_dp, length - pair%lambda)
      ! Half way between the surfaces, seen from the node, is where the bodies touch.
      shared%middle(l) = 0.5_dp*above + 0.5_dp*below
      if (pair%fills .and. abs(shared%middle(l)) > far*sides(1)) shared%middle(l) = 0.0_dp
      shared%near(l) = (pair%fills .or. above - below < pair%lambda + margin) .and. &
                       abs(shared%middle(l)) <= sides(1)*pair%depth + edge .and. &
                       (outside(pair, shared%middle(l)) <= sides(1)*pair%reach + edge .or. &
                        (pair%fills .and. length <= intruding*pair%lambda))
    end associate
  end subroutine measure

  !> How far a node lies outside of a firm body, from where bodies touch; minus a lot if both give
  !! way.
  elemental function outside(pair, middle) result(way)
    type(contact_pair_t), intent(in) :: pair
    real(dp), intent(in) :: middle               !! along the normal, from the node
    real(dp) :: way
    way = nowhere
    if (pair%firm(2)) way = middle
    if (pair%firm(1)) way = -middle
  end function outside

  !> Outward direction of a member at a node, and of all that are one matter with it there.
  pure function whole_gradient(mesh, fields, shared, n, m, bodies) result(gradient)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, m                  !! node and member
    type(body_t), intent(in) :: bodies(:)
    real(dp) :: gradient(3)
    integer :: s
    gradient = 0.0_dp
    do s = shared%member_start(n), shared%member_start(n + 1) - 1
      if (shared%lead(s) /= shared%lead(m)) cycle
      gradient = gradient + volume_gradient(mesh, fields(shared%field(s)), shared, s, bodies, &
                                            shared%point(:, n))
    end do
  end function whole_gradient

  !> Mean position of balls.
  pure function middle(n, balls) result(mean)
    integer, intent(in) :: n                     !! a multiple of `lanes`
    real(dp), intent(in), contiguous :: balls(:, :)
    real(dp) :: mean(3), part(lanes, 3), number(lanes)
    integer :: d, l, p
    part = 0.0_dp
    number = 0.0_dp
    do p = 0, n - lanes, lanes
      do d = 1, 3
        !$omp simd
        do l = 1, lanes
          part(l, d) = part(l, d) + merge(balls(p + l, d), 0.0_dp, balls(p + l, 4) > nowhere)
        end do
      end do
      number = number + merge(1.0_dp, 0.0_dp, balls(p + 1:p + lanes, 4) > nowhere)
    end do
    mean = sum(part, dim=1)/sum(number)
  end function middle

  !> Square of the distance (cells) from a node's normal within which particles are looked for that
  !! lie within some spacings of it in a plane: along each further axis the nearest layer of
  !! particles may lie half a spacing aside.
  pure function reach_squared(spacings, spacing, axes) result(near2)
    real(dp), intent(in) :: spacings, spacing
    integer, intent(in) :: axes                  !! across the normal that no wall holds
    real(dp) :: near2
    near2 = (spacings**2 + 0.25_dp*max(0, axes - 1))*spacing**2*(1.0_dp + edge)
  end function reach_squared

  !> How far balls that are near the axis through the origin reach along it; minus a lot where there
  !! are none.
  pure function reach(stride, n, balls, axis, near2) result(furthest)
    integer, intent(in) :: stride, n
    real(dp), intent(in) :: balls(stride, 4), axis(3)
    real(dp), intent(in) :: near2(2)
      !! squares of distances from the axis: the outermost within the first count, else the second
    real(dp) :: furthest
    real(dp) :: top(lanes), along, across
    integer :: p, l
    top = nowhere
    do p = 0, n - lanes, lanes
      !$omp simd private(along, across)
      do l = 1, lanes
        along = balls(p + l, 1)*axis(1) + balls(p + l, 2)*axis(2) + balls(p + l, 3)*axis(3)
        across = (balls(p + l, 1)**2 + balls(p + l, 2)**2 + balls(p + l, 3)**2) - along**2
        along = along + balls(p + l, 4)
        top(l) = merge(along, top(l), across <= near2(1) .and. along > top(l))
      end do
    end do
    furthest = maxval(top)
    if (furthest > nowhere) return
    furthest = reach_between(stride, n, balls, axis, near2)
  end function reach

  !> Mean reach along the axis of the balls around it, for a surface that has been stretched until
  !! the axis passes between its particles; minus a lot beyond the body's edge, where those that are
  !! near lie on one side of it. In a slice of space these are those of a plane, layer by layer.
  pure function reach_between(stride, n, balls, axis, near2) result(mean)
    integer, intent(in) :: stride, n
    real(dp), intent(in) :: balls(stride, 4), axis(3), near2(2)
    real(dp) :: mean
    real(dp) :: along, across(3), middle(3), near
    integer :: p, found
    near = sqrt((near2(2) - near2(1))/3.0_dp)  ! what both allow in a plane
    found = 0
    middle = 0.0_dp
    mean = 0.0_dp
    do p = 1, n
      if (balls(p, 4) <= nowhere) cycle
      along = dot_product(balls(p, :3), axis)
      across = balls(p, :3) - along*axis
      if (dot_product(across, across) > near2(2)) cycle
      found = found + 1
      middle = middle + across
      mean = mean + (along + balls(p, 4))
    end do
    if (found == 0 .or. norm2(middle) > near*found) then
      mean = nowhere
    else
      mean = mean/found
    end if
  end function reach_between

  !> Surface particles of a member around a node, and of all that are one matter with it there;
  !! those that are left out, and the rest of the last group, reach nowhere. Where the node is held,
  !! particles are put onto its planes.
  pure subroutine cloud_around(shared, n, m, mesh, balls, x)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, m                  !! node and member
    type(mesh_t), intent(in) :: mesh
    integer, intent(out) :: balls                !! 0 or a multiple of `lanes`
    real(dp), allocatable, intent(inout) :: x(:, :)
    real(dp) :: node(4), support
    integer :: s, part, d
    balls = 0
    do s = shared%member_start(n), shared%member_start(n + 1) - 1
      if (shared%lead(s) /= shared%lead(m)) cycle
      do part = 1, shared_parts(shared, s)
        associate (surface => shared%surface(shared_body(shared, s, part)), &
                   bins => shared%bins(:, :, shared%bins_start(s) + part - 1))
          balls = balls + sum(surface%start(bins(2, :) + 1) - surface%start(bins(1, :)))
        end associate
      end do
    end do
    if (balls == 0) return
    call make_room(balls + 2*lanes, x)
    node = 0.0_dp
    node(1) = real(shared%point(1, n), dp)
    if (shared%ndim == 2) node(2) = real(shared%point(3, n), dp)
    if (shared%ndim == 3) node(2:3) = real(shared%point(2:3, n), dp)
    support = 0.5_dp*(stencil_reach(shared%kernel) + 1) - edge
    balls = 0
    do s = shared%member_start(n), shared%member_start(n + 1) - 1
      if (shared%lead(s) /= shared%lead(m)) cycle
      do part = 1, shared_parts(shared, s)
        call add_balls(shared%surface(shared_body(shared, s, part)), &
                       shared%bins(:, :, shared%bins_start(s) + part - 1), node, support, balls, x)
      end do
    end do
    if (all(x(:balls, 4) <= nowhere)) then
      balls = 0
      return
    end if
    if (mesh%graded) call stretch(mesh, node, balls, x)
    do d = 1, 3
      if (shared%held(d, n)) x(:balls, d) = 0.0_dp
    end do
    x(balls + 1:balls + lanes, :3) = 0.0_dp
    x(balls + 1:balls + lanes, 4) = nowhere
    balls = lanes*((balls + lanes - 1)/lanes)
  end subroutine cloud_around

  !> Turns differences of coordinates from a node into lengths, where cells are unequal.
  pure subroutine stretch(mesh, node, balls, x)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: node(4)
    integer, intent(in) :: balls
    real(dp), intent(inout) :: x(:, :)
    integer :: d
    do d = 1, mesh%ndim
      x(:balls, d) = graded_place(mesh%axes(d), node(d) + x(:balls, d)) - &
                     graded_place(mesh%axes(d), node(d))
    end do
  end subroutine stretch

  !> Spacings of the centres around a node, along a direction and the largest (smallest cell); 1
  !! where cells are equal.
  pure function local_sides(mesh, shared, n, normal) result(sides)
    type(mesh_t), intent(in) :: mesh
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n                     !! the node
    real(dp), intent(in) :: normal(3)            !! unit vector
    real(dp) :: sides(2)
    real(dp) :: spacing(mesh%ndim)
    integer :: d
    sides = 1.0_dp
    if (.not. mesh%graded) return
    spacing = graded_spacing(mesh%axes(:mesh%ndim), &
                             shared%point(row_axis([(d, d=1, mesh%ndim)], mesh%ndim), n))
    sides = [norm2(spacing*normal(:mesh%ndim)), maxval(spacing)]
  end function local_sides

  !> Adds the surface particles of a body in some bins.
  pure subroutine add_balls(surface, bins, node, support, balls, x)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: bins(2, most_rows)
    real(dp), intent(in) :: node(4), support
    integer, intent(inout) :: balls
    real(dp), intent(inout) :: x(:, :)
    integer :: r, p, last
    do r = 1, most_rows
      last = surface%start(bins(2, r) + 1) - 1
      ! Whole groups; what is too much is overwritten.
      do p = surface%start(bins(1, r)), last, lanes
        call copy_group(size(surface%x, 1), surface%x, p - 1, node, support, size(x, 1), x, balls)
        balls = balls + min(lanes, last - p + 1)
      end do
    end do
  end subroutine add_balls

  !> A group of balls, its positions relative to a node. A particle on the edge of the node's
  !! support gives nothing to it, and into which bin it has fallen is a matter of its last bits: it
  !! is left out.
  pure subroutine copy_group(stride, from, behind, node, support, stride_to, to, behind_to)
    integer, intent(in) :: stride, behind, stride_to, behind_to
    real(dp), intent(in) :: from(stride, 4), node(4), support
    real(dp), intent(inout) :: to(stride_to, 4)
    real(dp) :: x, y, z
    integer :: l
    !$omp simd private(x, y, z)
    do l = 1, lanes
      x = from(behind + l, 1) - node(1)
      y = from(behind + l, 2) - node(2)
      z = from(behind + l, 3) - node(3)
      to(behind_to + l, 1) = x
      to(behind_to + l, 2) = y
      to(behind_to + l, 3) = z
      to(behind_to + l, 4) = merge(from(behind + l, 4), nowhere, &
                                   max(abs(x), abs(y), abs(z)) < support)
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

end module sgmp_contact_distance
