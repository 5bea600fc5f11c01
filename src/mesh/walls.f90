!> Walls by the folding rule: what particles gave to a point behind a wall is folded onto its mirror
!! image, and before particles read, points behind the wall are filled with the mirror image again.
!!
!! Both use one table of signs (sgmp_images), so that what particles give and what they get are
!! transposes of each other; Eq. 42 (energy) rests on that. Axes are folded one after the other,
!! which takes care of edges and corners.
!!
!! A fixed wall may move along itself: velocities are odd as seen from the wall, and so is momentum,
!! v -> 2 V - v and p -> 2 m V - p. What lay behind it is kept for the work of the wall
!! (sgmp_wall_work). Friction changes nothing of this: it is a force on the nodes of a slip wall
!! (sgmp_wall_friction).
module sgmp_walls
  use sgmp_columns, only: collide_velocity, column_image, relax_filter, relax_square, &
                          relax_velocity, vector_column, vector_components
  use sgmp_field, only: field_base, field_t
  use sgmp_images, only: vector_parity
  use sgmp_kernels, only: kernel_centred, kernel_folds
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free, wall_speed
  use sgmp_rows, only: key_j, key_k
  implicit none
  private
  public :: walls_fold, walls_slow, walls_mirror, walls_mirror_average, walls_mirror_collide, &
            walls_mirror_centres, walls_hold, has_walls
  public :: ghost_intervals, ghost_point, ghost_records


contains

  !> Whether an axis has a wall at all.
  pure function has_walls(mesh, axis) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    logical :: yes
    yes = any(mesh%wall(:, axis) /= wall_free)
  end function has_walls

  !> Folds columns q1..q2 of the moments of one axis; planes plane1..plane2 hold the points behind
  !! the wall.
  pure subroutine walls_fold(field, mesh, axis, plane1, plane2, q1, q2)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, plane1, plane2, q1, q2
    integer :: side, s, first, last, ghost, image, q, n, from, to
    real(dp) :: parity(q1:q2)
    if (.not. kernel_folds(field%kernel)) return
    do side = 1, 2
      if (mesh%wall(side, axis) == wall_free) cycle
      call ghost_point(mesh, axis, side, kernel_centred(field%kernel), ghost, image)
      call ghost_intervals(field, axis, ghost, plane1, plane2, first, last)
      do q = q1, q2
        parity(q) = column_image(field%columns, q, axis, mesh%wall(side, axis))
      end do
      do s = first, last
        call ghost_records(field, s, axis, ghost, image, from, to, n)
        if (n == 0) cycle
        if (field%columns%behind(axis) > 0) then
          call keep_behind(field, axis, q1, q2, from, n)
          call drag(field, mesh, axis, side, q1, q2, 1.0_dp, from, to, n)
        end if
        do q = q1, q2
          if (nint(parity(q)) /= 0) then
            call fold(n, parity(q), field%moment(from, q), field%moment(to, q))
          else
            call complete(n, field%moment(merge(to, from, side == 1), q))
          end if
        end do
      end do
    end do
  end subroutine walls_fold

  !> Multiplies the momentum of all particles by a factor after it has been folded: what belongs to
  !! the motion of walls stays.
  pure subroutine walls_slow(field, mesh, factor)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: factor
    integer :: axis, side, s, first, last, ghost, image, a, q, q2, n, from, to
    associate (q1 => field%columns%momentum)
      q2 = q1 + field%ndim - 1
      field%moment(:, q1:q2) = factor*field%moment(:, q1:q2)
      if (.not. kernel_folds(field%kernel)) return
      do axis = 1, field%ndim
        associate (behind => field%columns%behind(axis))
          if (behind == 0) cycle
          field%moment(:, behind + 1:behind + field%ndim) = &
            factor*field%moment(:, behind + 1:behind + field%ndim)
        end associate
        do side = 1, 2
          if (mesh%wall(side, axis) == wall_free) cycle
          call ghost_point(mesh, axis, side, kernel_centred(field%kernel), ghost, image)
          call ghost_intervals(field, axis, ghost, 1, field%planes, first, last)
          do s = first, last
            call ghost_records(field, s, axis, ghost, image, from, to, n)
            if (n == 0) cycle
            call drag(field, mesh, axis, side, q1, q2, 1.0_dp - factor, from, to, n)
            do q = q1, q2  ! what walls of other axes have dragged
              a = q - q1 + 1
              call fold(n, vector_parity(a, axis, mesh%wall(side, axis)), field%moment(from, q), &
                        field%moment(to, q))
            end do
          end do
        end do
      end do
    end associate
  end subroutine walls_slow

  !> Keeps what points behind a wall hold: mass, momentum and force as far as they are folded.
  pure subroutine keep_behind(field, axis, q1, q2, ghost, n)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: axis, q1, q2          !! columns that are folded
    integer, intent(in) :: ghost, n              !! first record, how many
    integer :: a, c, columns(1 + 2*field%ndim)
    columns = [field%columns%mass, (field%columns%momentum + a - 1, a=1, field%ndim), &
               (field%columns%force + a - 1, a=1, field%ndim)]
    do c = 1, size(columns)
      if (columns(c) < q1 .or. columns(c) > q2) cycle
      field%moment(ghost:ghost + n - 1, field%columns%behind(axis) + c - 1) = &
        field%moment(ghost:ghost + n - 1, columns(c))
    end do
  end subroutine keep_behind

  !> Adds to the images of points behind a moving wall the momentum that belongs to its motion.
  pure subroutine drag(field, mesh, axis, side, q1, q2, part, ghost, image, n)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, side, q1, q2    !! q1..q2: columns that are folded
    real(dp), intent(in) :: part                 !! of this momentum that is added
    integer, intent(in) :: ghost, image, n       !! first records, how many
    integer :: a, q
    do a = 1, field%ndim
      q = field%columns%momentum + a - 1
      if (q < q1 .or. q > q2 .or. mesh%wall(side, axis) /= wall_fixed) cycle
      field%moment(image:image + n - 1, q) = field%moment(image:image + n - 1, q) + &
        2.0_dp*part*mesh%wall_motion(a, side, axis, wall_speed)* &
        field%moment(ghost:ghost + n - 1, field%columns%behind(axis))
    end do
  end subroutine drag

  !> Adds what points behind a wall hold to their images, and empties them.
  pure subroutine fold(n, parity, ghost, image)
    integer, intent(in) :: n
    real(dp), intent(in) :: parity
    real(dp), intent(inout) :: ghost(n), image(n)
    integer :: i
    do i = 1, n
      image(i) = image(i) + parity*ghost(i)
      ghost(i) = 0.0_dp
    end do
  end subroutine fold

  !> What reaches across a wall, stored at the upper of the points that it joins, is that of a body
  !! and its mirror image.
  pure subroutine complete(n, moment)
    integer, intent(in) :: n
    real(dp), intent(inout) :: moment(n)
    moment = 2.0_dp*moment
  end subroutine complete

  !> Gives nodes on walls the components that the walls have, in the vector that starts at `column`.
  pure subroutine walls_hold(field, mesh, s, first, n, column, kind)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    integer, intent(in) :: column, kind       !! kind: wall_kick or wall_speed
    integer :: a
    do a = 1, vector_components(field%columns, field%ndim)
      call hold_component(field, mesh, s, first, n, a, vector_column(field%columns, column, a), &
                          kind)
    end do
  end subroutine walls_hold

  !> The same for component `a`, stored in `column`; the wall across it comes last: nothing passes
  !! it.
  pure subroutine hold_component(field, mesh, s, first, n, a, column, kind)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n, a, column, kind
    real(dp) :: wall
    integer :: turn, axis, side, at, idx, here(3)
    here = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (field%ndim == 2) here(2) = here(3)
    idx = field%neighbour(0, 0, s)
    do turn = a, a + field%ndim - 1
      axis = modulo(turn, field%ndim) + 1
      do side = 1, 2
        if (mesh%wall(side, axis) == wall_free) cycle
        if (axis /= a .and. mesh%wall(side, axis) /= wall_fixed) cycle
        at = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
        wall = mesh%wall_motion(a, side, axis, kind)
        if (axis == 1) then
          if (at >= first .and. at < first + n) field%node(idx + at, column) = wall
        else if (here(axis) == at) then
          field%node(idx + first:idx + first + n - 1, column) = wall
        end if
      end do
    end do
  end subroutine hold_component

  !> Fills nodes behind the walls of one axis with their mirror image, in the vectors that start at
  !! the given columns: accelerations and velocities, as the wall itself has them.
  pure subroutine walls_mirror(field, mesh, axis, plane1, plane2, columns, kinds)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, plane1, plane2
    integer, intent(in) :: columns(:)
    integer, intent(in) :: kinds(:)              !! (columns) wall_kick or wall_speed
    integer :: side, s, first, last, ghost, image, c, a, n, from, to, at
    if (.not. kernel_folds(field%kernel)) return
    do side = 1, 2
      if (mesh%wall(side, axis) == wall_free) cycle
      call ghost_point(mesh, axis, side, .false., ghost, image)
      call ghost_intervals(field, axis, ghost, plane1, plane2, first, last)
      do s = first, last
        call ghost_records(field, s, axis, ghost, image, to, from, n)
        if (n == 0) cycle
        do c = 1, size(columns)
          do a = 1, vector_components(field%columns, field%ndim)
            at = vector_column(field%columns, columns(c), a)
            call mirror(n, vector_parity(a, axis, mesh%wall(side, axis)), &
                        mesh%wall_motion(a, side, axis, kinds(c)), field%node(from, at), &
                        field%node(to, at))
          end do
        end do
      end do
    end do
  end subroutine walls_mirror

  !> Gives points behind a wall what their images hold, as seen from the wall.
  pure subroutine mirror(n, parity, wall, image, ghost)
    integer, intent(in) :: n
    real(dp), intent(in) :: parity, image(n)
    real(dp), intent(in) :: wall                 !! its own component
    real(dp), intent(out) :: ghost(n)
    integer :: i
    do i = 1, n
      ghost(i) = (1.0_dp - parity)*wall + parity*image(i)
    end do
  end subroutine mirror

  !> Fills centres behind the walls of one axis with their mirror image, in what particles relax to.
  !! Beside walls that move no velocity relaxes: it would be dragged by the image behind the wall,
  !! and the work of that belongs to the wall.
  pure subroutine walls_mirror_centres(field, mesh, axis, plane1, plane2)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, plane1, plane2
    integer :: side, s, first, last, ghost, image, a, n, from, to
    do side = 1, 2
      if (mesh%wall(side, axis) == wall_free) cycle
      call ghost_point(mesh, axis, side, .true., ghost, image)
      call ghost_intervals(field, axis, ghost, plane1, plane2, first, last)
      do s = first, last
        call ghost_records(field, s, axis, ghost, image, to, from, n)
        if (n == 0) cycle
        if (mesh%walls_move .and. mesh%wall(side, axis) == wall_fixed) then
          field%relax(from:from + n - 1, relax_filter:relax_square) = 0.0_dp
          field%relax(from:from + n - 1, relax_velocity:) = 0.0_dp
        end if
        field%relax(to:to + n - 1, :) = field%relax(from:from + n - 1, :)
        do a = 1, field%ndim
          field%relax(to:to + n - 1, relax_velocity + a - 1) = &
            vector_parity(a, axis, mesh%wall(side, axis))* &
            field%relax(from:from + n - 1, relax_velocity + a - 1)
        end do
      end do
    end do
  end subroutine walls_mirror_centres

  !> The same in what debris collides by, at the points of any stencil.
  pure subroutine walls_mirror_collide(field, mesh, axis)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    integer :: side, s, first, last, ghost, image, a, n, from, to
    if (.not. kernel_folds(field%kernel)) return
    do side = 1, 2
      if (mesh%wall(side, axis) == wall_free) cycle
      call ghost_point(mesh, axis, side, kernel_centred(field%kernel), ghost, image)
      call ghost_intervals(field, axis, ghost, 1, field%planes, first, last)
      do s = first, last
        call ghost_records(field, s, axis, ghost, image, to, from, n)
        if (n == 0) cycle
        field%collide(to:to + n - 1, :) = field%collide(from:from + n - 1, :)
        do a = 1, field%ndim
          field%collide(to:to + n - 1, collide_velocity + a - 1) = &
            vector_parity(a, axis, mesh%wall(side, axis))* &
            field%collide(from:from + n - 1, collide_velocity + a - 1)
        end do
      end do
    end do
  end subroutine walls_mirror_collide

  !> The same in what plastic strain is averaged by, which is even.
  pure subroutine walls_mirror_average(field, mesh, axis)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    integer :: side, s, first, last, ghost, image, n, from, to
    if (.not. kernel_folds(field%kernel)) return
    do side = 1, 2
      if (mesh%wall(side, axis) == wall_free) cycle
      call ghost_point(mesh, axis, side, kernel_centred(field%kernel), ghost, image)
      call ghost_intervals(field, axis, ghost, 1, field%planes, first, last)
      do s = first, last
        call ghost_records(field, s, axis, ghost, image, to, from, n)
        if (n > 0) field%average(to:to + n - 1, :) = field%average(from:from + n - 1, :)
      end do
    end do
  end subroutine walls_mirror_average

  !> Index of the point behind a wall and of its mirror image, for centres or for nodes.
  pure subroutine ghost_point(mesh, axis, side, centres, ghost, image)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, side
    logical, intent(in) :: centres
    integer, intent(out) :: ghost, image
    integer :: wall
    wall = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
    if (side == 1) then
      ghost = wall - 1
      image = merge(wall, wall + 1, centres)
    else
      ghost = merge(wall, wall + 1, centres)
      image = wall - 1
    end if
  end subroutine ghost_point

  !> Work intervals of some planes among which those behind a wall are: along the slowest axis only
  !! one plane is.
  pure subroutine ghost_intervals(field, axis, ghost, plane1, plane2, first, last)
    type(field_t), intent(in) :: field
    integer, intent(in) :: axis, ghost, plane1, plane2
    integer, intent(out) :: first, last
    integer :: p1, p2
    p1 = plane1
    p2 = plane2
    if (axis > 1 .and. axis == field%ndim) then
      do while (p1 <= plane2)
        if (field%plane_k(p1) >= ghost) exit
        p1 = p1 + 1
      end do
      p2 = p1 - 1
      if (p1 <= plane2) then
        if (field%plane_k(p1) == ghost) p2 = p1
      end if
    end if
    first = field%plane_work(p1)
    last = field%plane_work(p2 + 1) - 1
  end subroutine ghost_intervals

  !> Records of the points of work interval s that lie behind the wall, and of their images; n = 0:
  !! none.
  pure subroutine ghost_records(field, s, axis, ghost, image, at_ghost, at_image, n)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, axis, ghost, image
    integer, intent(out) :: at_ghost, at_image, n
    integer :: base, row(3)
    n = 0
    at_ghost = 0
    at_image = 0
    associate (first => field%work%first(s))
      if (axis == 1) then
        if (ghost < first .or. ghost > field%work%last(s)) return
        n = 1
        at_ghost = field%neighbour(0, 0, s) + ghost
        at_image = field%neighbour(0, 0, s) + image
        return
      end if
      row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
      if (row(merge(3, axis, field%ndim == 2)) /= ghost) return
      row(merge(3, axis, field%ndim == 2)) = image
      base = field_base(field, row(2), row(3), first)
      if (base == huge(1)) return
      n = field%work%last(s) - first + 1
      at_ghost = field%neighbour(0, 0, s) + first
      at_image = base + first
    end associate
  end subroutine ghost_records

end module sgmp_walls
