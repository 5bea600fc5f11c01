!> Bodies that touch themselves (doc/contact.md).
!!
!! A body with self-contact is divided into patches, cubes of its first positions. Patches that come
!! near each other in space and were no neighbours get different labels, and each label has a
!! velocity field of its own, in which twins of the body hold the particles. At a node two labels
!! either meet along a seam, where matter goes on from one to the other: they then have one velocity
!! and one acceleration, as one field would; or they are parts that were apart: they touch. The
!! first positions around the node decide.
!!
!! Patches are looked at as they pass through boxes of two cells, once in some steps. What is found
!! is the same on all ranks: counts and extremes, which do not depend on any order.
module sgmp_self_contact
  use sgmp_body, only: body_t
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_velocity
  use sgmp_parallel, only: parallel_gather, parallel_max
  use sgmp_patches, only: labels_t, patch_label, patch_place, patches_apart
  use sgmp_shared_nodes, only: row_axis, shared_nodes_t
  use sgmp_sorting, only: sort_order_within
  implicit none
  private
  public :: self_t, self_decide, self_index, self_labels, self_look, self_table

  integer, parameter :: self_labels = 4         !! labels, and so fields, of a family
  integer, parameter :: self_table = 12         !! numbers of a row of `table`
  integer, parameter :: side = 2                !! cells of a box
  integer, parameter :: around = 2              !! boxes on either side that are looked at
  real(dp), parameter :: near = 4.0_dp
    !! patches with a smaller gap (cells) get different labels: supports of 1.5 cells on both sides,
    !! and what they may come closer until the next look
  real(dp), parameter :: travel = 0.5_dp        !! cells that a particle may go until then
  real(dp), parameter :: hurry = 2.0_dp         !! by which it may get faster
  integer, parameter :: most_steps = 16         !! until then
  real(dp), parameter :: reach = 2.5_dp         !! cells around a node, for its labels
  real(dp), parameter :: seam = 1.5_dp
    !! patches between the means of two labels around a node, below which matter goes on

  !> What is known of all families.
  type :: self_t
    logical :: on = .false.                     !! some body touches itself
    integer :: next_step = 0                    !! when patches are looked at again, at the latest
    real(dp) :: next_time = -huge(1.0_dp)
    logical :: fresh = .false.                  !! nodes have yet to decide
    integer :: crowded = 0                      !! most patches for which no label was left
    real(dp), allocatable :: table(:, :)
      !! (self_table, rows) where patches are: family, box, coordinates of the patch, its particles
      !! there, their lower and upper corner less the box (cells); patch. By box and patch.
    integer(i8), allocatable :: box(:)          !! (rows) number of the box
    integer :: low(3) = 0, extent(3) = 1        !! of the boxes
  end type self_t

contains

  !> Looks where patches are, if it is time to, and gives them their labels; bodies whose particles
  !! get others are told so. All ranks must call it.
  subroutine self_look(self, mesh, bodies, step, time)
    type(self_t), intent(inout) :: self
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: bodies(:)
    integer, intent(in) :: step                 !! its number
    real(dp), intent(in) :: time                !! when it begins
    real(dp), allocatable :: own(:, :), all(:)
    type(labels_t) :: labels
    real(dp) :: fastest
    integer :: b, n, family, crowded, all_crowded
    if (step < self%next_step .and. time < self%next_time) return
    allocate (own(self_table, 64))
    n = 0
    fastest = 0.0_dp
    do b = 1, size(bodies)
      if (bodies(b)%family == 0) cycle
      call list_body(bodies(b), mesh%ndim, own, n, fastest)
    end do
    call parallel_gather(reshape(own(:, :n), [self_table*n]), all)
    call put_table(self, reshape(all, [self_table, size(all)/self_table]))
    fastest = parallel_max(fastest)*mesh%inverse_h
    self%next_step = step + most_steps
    self%next_time = time + travel/max(hurry*fastest, tiny(1.0_dp))
    self%fresh = .true.
    all_crowded = 0
    do family = 1, maxval(bodies%family)
      if (.not. any(bodies%family == family)) cycle
      b = findloc(bodies%family, family, 1)
      call choose_labels(self, family, mesh%ndim, bodies(b)%labels, labels, crowded)
      all_crowded = all_crowded + crowded
      if (same(labels, bodies(b)%labels)) cycle
      do b = 1, size(bodies)
        if (bodies(b)%family /= family) cycle
        bodies(b)%labels = labels
        bodies(b)%relabels = .true.
      end do
    end do
    self%crowded = max(self%crowded, all_crowded)
  end subroutine self_look

  !> Whether two sets of labels are one.
  pure function same(a, b) result(yes)
    type(labels_t), intent(in) :: a, b
    logical :: yes
    yes = size(a%patch) == 0 .and. .not. allocated(b%patch)
    if (.not. allocated(b%patch)) return
    yes = size(a%patch) == size(b%patch)
    if (yes) yes = all(a%patch == b%patch) .and. all(a%label == b%label)
  end function same

  !> Appends the patches of a body in the boxes that its particles of this rank are in.
  pure subroutine list_body(body, ndim, table, n, fastest)
    type(body_t), intent(in) :: body
    integer, intent(in) :: ndim
    real(dp), allocatable, intent(inout) :: table(:, :)
    integer, intent(inout) :: n                 !! rows
    real(dp), intent(inout) :: fastest          !! particle's speed
    integer :: bin, chunk, l, first, left, v
    associate (particles => body%particles)
      v = motion_velocity(ndim)
      do bin = 1, size(particles%size)
        first = n + 1
        chunk = particles%first(bin)
        left = particles%size(bin)
        do while (left > 0)
          do l = 1, min(left, lanes)
            fastest = max(fastest, norm2(particles%motion(l, v:v + ndim - 1, chunk)))
            call list_particle(body%family, particles%motion(l, :ndim, chunk), &
                               particles%state(l, body%law%slots%patch, chunk), first, table, n)
          end do
          left = left - lanes
          chunk = particles%next(chunk)
        end do
      end do
    end associate
  end subroutine list_body

  !> Notes one particle in the row of its box and patch, among those from `first` on.
  pure subroutine list_particle(family, x, patch, first, table, n)
    integer, intent(in) :: family, first
    real(dp), intent(in) :: x(:)                !! (ndim) cells
    real(dp), intent(in) :: patch
    real(dp), allocatable, intent(inout) :: table(:, :)
    integer, intent(inout) :: n
    real(dp), allocatable :: larger(:, :)
    real(dp) :: box(3), place(3)
    integer :: row
    box = 0.0_dp
    place = 0.0_dp
    box(:size(x)) = floor(x/side)
    place(:size(x)) = x - side*box(:size(x))
    do row = n, first, -1
      if (abs(table(5, row) - patch) > 0.0_dp) cycle
      if (any(abs(table(2:4, row) - box) > 0.0_dp)) cycle
      table(6, row) = table(6, row) + 1.0_dp
      table(7:9, row) = min(table(7:9, row), place)
      table(10:12, row) = max(table(10:12, row), place)
      return
    end do
    if (n == size(table, 2)) then
      allocate (larger(self_table, 2*n))
      larger(:, :n) = table
      call move_alloc(larger, table)
    end if
    n = n + 1
    table(:, n) = [real(family, dp), box, patch, 1.0_dp, place, place]
  end subroutine list_particle

  !> Sorts rows by box and patch, and makes one of those that are alike.
  pure subroutine put_table(self, rows)
    type(self_t), intent(inout) :: self
    real(dp), intent(in) :: rows(:, :)
    integer, allocatable :: order(:)
    integer :: r, n
    if (allocated(self%table)) deallocate (self%table)
    allocate (self%table(self_table, size(rows, 2)), order(size(rows, 2)))
    self%table = rows
    call self_index(self)
    call sort_order_within(self%box, nint(rows(5, :), i8), order)
    n = 0
    do r = 1, size(order)
      associate (row => rows(:, order(r)))
        if (n > 0) then
          if (all(abs(self%table(:5, n) - row(:5)) <= 0.0_dp)) then
            self%table(6, n) = self%table(6, n) + row(6)
            self%table(7:9, n) = min(self%table(7:9, n), row(7:9))
            self%table(10:12, n) = max(self%table(10:12, n), row(10:12))
            cycle
          end if
        end if
        n = n + 1
        self%table(:, n) = row
      end associate
    end do
    self%table = self%table(:, :n)
    call self_index(self)
  end subroutine put_table

  !> Numbers of the boxes of all rows; there is room for as many around as are looked at.
  pure subroutine self_index(self)
    type(self_t), intent(inout) :: self
    integer :: r
    if (allocated(self%box)) deallocate (self%box)
    allocate (self%box(size(self%table, 2)))
    if (size(self%box) == 0) return
    self%low = nint(minval(self%table(2:4, :), dim=2)) - around
    self%extent = nint(maxval(self%table(2:4, :), dim=2)) + around + 1 - self%low
    do r = 1, size(self%box)
      self%box(r) = box_number(self, nint(self%table(1, r)), nint(self%table(2:4, r)))
    end do
  end subroutine self_index

  !> Number of a box for a family.
  pure function box_number(self, family, box) result(number)
    type(self_t), intent(in) :: self
    integer, intent(in) :: family, box(3)
    integer(i8) :: number
    associate (at => int(box - self%low, i8), n => int(self%extent, i8))
      number = ((family*n(3) + at(3))*n(2) + at(2))*n(1) + at(1)
    end associate
  end function box_number

  !> First row whose box has this number or a larger one.
  pure function first_row(self, number) result(row)
    type(self_t), intent(in) :: self
    integer(i8), intent(in) :: number
    integer :: row, high, half
    row = 1
    high = size(self%box) + 1
    do while (row < high)
      half = (row + high)/2
      if (self%box(half) < number) then
        row = half + 1
      else
        high = half
      end if
    end do
  end function first_row

  !> Labels of the patches of a family: each keeps its own where it may, else takes the first that
  !! none of those it meets has; those that meet none have 0.
  pure subroutine choose_labels(self, family, ndim, old, new, crowded)
    type(self_t), intent(in) :: self
    integer, intent(in) :: family, ndim
    type(labels_t), intent(in) :: old
    type(labels_t), intent(out) :: new
    integer, intent(out) :: crowded             !! for which no label was left
    integer(i8), allocatable :: one(:), other(:)
    integer :: m, last, taken(0:self_labels - 1), label
    integer :: n
    call list_meetings(self, family, ndim, one, other)
    crowded = 0
    allocate (new%patch(size(one)), new%label(size(one)))
    n = 0
    m = 1
    do while (m <= size(one))
      last = m
      do while (last < size(one))
        if (one(last + 1) /= one(m)) exit
        last = last + 1
      end do
      call count_taken(new, n, other(m:last), one(m), taken)
      label = patch_label(old, one(m))
      if (taken(label) > 0) label = minloc(taken, 1) - 1
      if (taken(label) > 0) crowded = crowded + 1
      n = n + 1
      new%patch(n) = one(m)
      new%label(n) = label
      m = last + 1
    end do
    new%patch = pack(new%patch(:n), new%label(:n) > 0)
    new%label = pack(new%label(:n), new%label(:n) > 0)
  end subroutine choose_labels

  !> How many of the patches that one meets have each label, of those before it.
  pure subroutine count_taken(new, n, others, patch, taken)
    type(labels_t), intent(in) :: new
    integer, intent(in) :: n                    !! patches that have theirs
    integer(i8), intent(in) :: others(:), patch
    integer, intent(out) :: taken(0:)
    type(labels_t) :: given
    integer :: m, label
    taken = 0
    given%patch = new%patch(:n)
    given%label = new%label(:n)
    do m = 1, size(others)
      if (others(m) >= patch) cycle
      label = patch_label(given, others(m))
      taken(label) = taken(label) + 1
    end do
  end subroutine count_taken

  !> Pairs of patches of a family that are near each other and no neighbours, each both ways round,
  !! in their order.
  pure subroutine list_meetings(self, family, ndim, one, other)
    type(self_t), intent(in) :: self
    integer, intent(in) :: family, ndim
    integer(i8), allocatable, intent(out) :: one(:), other(:)
    integer(i8), allocatable :: found(:, :)
    integer, allocatable :: order(:)
    integer :: r, n, p
    allocate (found(2, 16))
    n = 0
    do r = 1, size(self%box)
      if (nint(self%table(1, r)) == family) call meet_row(self, r, ndim, found, n)
    end do
    one = [found(1, :n), found(2, :n)]
    other = [found(2, :n), found(1, :n)]
    allocate (order(2*n))
    call sort_order_within(one, other, order)
    one = one(order)
    other = other(order)
    r = 0
    do p = 1, size(one)
      if (r > 0) then
        if (one(p) == one(r) .and. other(p) == other(r)) cycle
      end if
      r = r + 1
      one(r) = one(p)
      other(r) = other(p)
    end do
    one = one(:r)
    other = other(:r)
  end subroutine list_meetings

  !> Appends what the patch of a row meets in the boxes around, of the rows behind it.
  pure subroutine meet_row(self, r, ndim, found, n)
    type(self_t), intent(in) :: self
    integer, intent(in) :: r, ndim
    integer(i8), allocatable, intent(inout) :: found(:, :)
    integer, intent(inout) :: n
    integer(i8), allocatable :: larger(:, :)
    integer(i8) :: start, patch, theirs
    integer :: j, k, q, box(3)
    box = nint(self%table(2:4, r))
    patch = nint(self%table(5, r), i8)
    do k = -merge(around, 0, ndim > 2), merge(around, 0, ndim > 2)
      do j = -merge(around, 0, ndim > 1), merge(around, 0, ndim > 1)
        start = box_number(self, nint(self%table(1, r)), box + [-around, j, k])
        if (start + 2*around < self%box(r)) cycle
        do q = max(r + 1, first_row(self, start)), size(self%box)
          if (self%box(q) > start + 2*around) exit
          theirs = nint(self%table(5, q), i8)
          if (.not. patches_apart(patch, theirs, ndim)) cycle
          if (gap(self%table(:, r), self%table(:, q)) >= near) cycle
          if (n > 0) then
            if (all(found(:, n) == [patch, theirs])) cycle
          end if
          if (n == size(found, 2)) then
            allocate (larger(2, 2*n))
            larger(:, :n) = found
            call move_alloc(larger, found)
          end if
          n = n + 1
          found(:, n) = [patch, theirs]
        end do
      end do
    end do
  end subroutine meet_row

  !> Largest gap along an axis between the particles of two rows (cells).
  pure function gap(a, b) result(cells)
    real(dp), intent(in) :: a(self_table), b(self_table)
    real(dp) :: cells
    real(dp) :: shift(3)
    shift = side*(b(2:4) - a(2:4))
    cells = maxval(max(shift + b(7:9) - a(10:12), a(7:9) - b(10:12) - shift))
  end function gap

  !> At which nodes two labels of a family are one matter: their links share what they do.
  pure subroutine self_decide(self, ndim, bodies, pairs, shared)
    type(self_t), intent(in) :: self
    integer, intent(in) :: ndim
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    type(shared_nodes_t), intent(inout) :: shared
    integer :: n, l
    do n = 1, shared%nodes
      do l = shared%link_start(n), shared%link_start(n + 1) - 1
        associate (pair => pairs(shared%pair(l)))
          if (pair%family == 0) cycle
          shared%link(l)%seam = one_matter(self, ndim, bodies(pair%body(1)), &
                                           bodies(pair%body(2))%label, shared%point(:, n))
        end associate
      end do
    end do
  end subroutine self_decide

  !> Whether matter goes on from one label to another around a node.
  ! allow(S901): one loop over the boxes around, and what to leave out of it
  pure function one_matter(self, ndim, body, other, point) result(yes)
    type(self_t), intent(in) :: self
    integer, intent(in) :: ndim, other
    type(body_t), intent(in) :: body            !! the one
    integer, intent(in) :: point(3)             !! the node
    logical :: yes
    real(dp) :: node(self_table), place(3, 2), number(2)
    integer(i8) :: start
    integer :: box(3), j, k, q, d, which
    node = 0.0_dp
    box = 0
    do d = 1, ndim
      box(d) = floor(real(point(row_axis(d, ndim)), dp)/side)
      node(6 + d) = point(row_axis(d, ndim)) - side*box(d)
    end do
    node(2:4) = box
    node(10:12) = node(7:9)
    place = 0.0_dp
    number = 0.0_dp
    yes = .true.
    if (.not. allocated(self%box)) return
    if (any(box < self%low .or. box >= self%low + self%extent)) return
    do k = -merge(around, 0, ndim > 2), merge(around, 0, ndim > 2)
      do j = -merge(around, 0, ndim > 1), merge(around, 0, ndim > 1)
        if (any(box + [0, j, k] < self%low .or. box + [0, j, k] >= self%low + self%extent)) cycle
        start = box_number(self, body%family, [max(box(1) - around, self%low(1)), &
                                               box(2) + j, box(3) + k])
        do q = first_row(self, start), size(self%box)
          if (self%box(q) > start + 2*around) exit
          if (gap(node, self%table(:, q)) > reach) cycle
          which = 0
          if (patch_label(body%labels, nint(self%table(5, q), i8)) == body%label) which = 1
          if (patch_label(body%labels, nint(self%table(5, q), i8)) == other) which = 2
          if (which == 0) cycle
          number(which) = number(which) + self%table(6, q)
          place(:, which) = place(:, which) + self%table(6, q)* &
                            patch_place(nint(self%table(5, q), i8), ndim)
        end do
      end do
    end do
    if (any(number <= 0.0_dp)) return
    yes = maxval(abs(place(:, 1)/number(1) - place(:, 2)/number(2))) < seam
  end function one_matter

end module sgmp_self_contact
