!> Walls by the folding rule: what particles gave to a point behind a wall is folded onto its mirror
!! image, and before particles read, points behind the wall are filled with the mirror image again.
!!
!! Both use one table of parities, so that what particles give and what they get are transposes of
!! each other; Eq. 42 (energy) rests on that. Axes are folded one after the other, which takes care
!! of edges and corners.
module sgmp_walls
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: kernel_mpm, kernel_sgmp
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_rows, only: key_j, key_k
  implicit none
  private
  public :: walls_fold, walls_mirror, moment_parity, has_walls

contains

  !> Whether an axis has a wall at all.
  pure function has_walls(mesh, axis) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    logical :: yes
    yes = any(mesh%wall(:, axis) /= wall_free)
  end function has_walls

  !> Sign with which a column of the moments is folded at a wall of the given kind and normal axis.
  pure function moment_parity(column, normal, wall, ndim, kernel, spins) result(parity)
    integer, intent(in) :: column        !! column of field%moment
    integer, intent(in) :: normal        !! axis of the wall's normal
    integer, intent(in) :: wall          !! wall_slip or wall_fixed
    integer, intent(in) :: ndim, kernel
    integer, intent(in), optional :: spins  !! columns of the spin, behind the momentum
    real(dp) :: parity
    integer :: flux, nflux, before
    parity = 1.0_dp
    nflux = merge(ndim*(ndim + 1)/2, ndim, kernel == kernel_sgmp)
    before = 1 + ndim
    if (present(spins)) before = before + spins
    if (column == 1) return
    if (column <= 1 + ndim) then
      if (column - 1 == normal .or. wall == wall_fixed) parity = -1.0_dp
    else if (column <= before) then
      ! An axial vector: a mirror keeps only the rotation about its normal.
      if (wall /= wall_fixed .and. (column - 1 - ndim /= normal .or. ndim == 2)) parity = -1.0_dp
    else if (column <= before + nflux) then
      flux = column - before
      if (kernel /= kernel_sgmp) then
        if (flux == normal .or. wall == wall_fixed) parity = -1.0_dp
      else if (wall /= wall_fixed) then
        parity = stress_parity(flux, normal, ndim)
      end if
    end if
  end function moment_parity

  !> The same for a stress component at a slip wall: shear stresses at the wall are odd.
  pure function stress_parity(flux, normal, ndim) result(parity)
    integer, intent(in) :: flux          !! component
    integer, intent(in) :: normal, ndim
    real(dp) :: parity
    integer, parameter :: pair(*, *) = reshape([1, 1, 2, 2, 3, 3, 1, 2, 2, 3, 1, 3], [2, 6])
    integer, parameter :: plane_pair(*, *) = reshape([1, 1, 2, 2, 1, 2], [2, 3])
    parity = 1.0_dp
    if (ndim == 3) then
      if (pair(1, flux) /= pair(2, flux) .and. any(pair(:, flux) == normal)) parity = -1.0_dp
    else if (plane_pair(1, flux) /= plane_pair(2, flux)) then
      parity = -1.0_dp
    end if
  end function stress_parity

  !> Folds columns q1..q2 of the moments of one axis; planes plane1..plane2 hold the points behind
  !! the wall.
  pure subroutine walls_fold(field, mesh, axis, plane1, plane2, q1, q2)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, plane1, plane2, q1, q2
    integer :: side, s, first, last, ghost, image, q, n, from, to
    real(dp) :: parity
    if (field%kernel == kernel_mpm) return
    do side = 1, 2
      if (mesh%wall(side, axis) == wall_free) cycle
      call ghost_point(field, mesh, axis, side, field%kernel == kernel_sgmp, ghost, image)
      call ghost_intervals(field, axis, ghost, plane1, plane2, first, last)
      do s = first, last
        call ghost_records(field, s, axis, ghost, image, from, to, n)
        do q = q1, q2
          if (n == 0) exit
          parity = moment_parity(q, axis, mesh%wall(side, axis), field%ndim, field%kernel, &
                                 field%spins)
          field%moment(to:to + n - 1, q) = field%moment(to:to + n - 1, q) + &
                                           parity*field%moment(from:from + n - 1, q)
          field%moment(from:from + n - 1, q) = 0.0_dp
        end do
      end do
    end do
  end subroutine walls_fold

  !> Fills nodes behind the walls of one axis with their mirror image, in the vectors that start at
  !! the given columns.
  pure subroutine walls_mirror(field, mesh, axis, plane1, plane2, columns)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, plane1, plane2
    integer, intent(in) :: columns(:)
    integer :: side, s, first, last, ghost, image, c, a, n, from, to
    real(dp) :: parity
    if (field%kernel == kernel_mpm) return
    do side = 1, 2
      if (mesh%wall(side, axis) == wall_free) cycle
      call ghost_point(field, mesh, axis, side, .false., ghost, image)
      call ghost_intervals(field, axis, ghost, plane1, plane2, first, last)
      do s = first, last
        call ghost_records(field, s, axis, ghost, image, to, from, n)
        if (n == 0) cycle
        do c = 1, size(columns)
          do a = 1, field%ndim
            parity = merge(-1.0_dp, 1.0_dp, a == axis .or. mesh%wall(side, axis) == wall_fixed)
            field%node(to:to + n - 1, columns(c) + a - 1) = &
              parity*field%node(from:from + n - 1, columns(c) + a - 1)
          end do
        end do
      end do
    end do
  end subroutine walls_mirror

  !> Index of the point behind a wall and of its mirror image, for centres or for nodes.
  pure subroutine ghost_point(field, mesh, axis, side, centres, ghost, image)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, side
    logical, intent(in) :: centres
    integer, intent(out) :: ghost, image
    integer :: wall
    wall = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
    if (field%ndim < 1) wall = 0
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
    integer :: first, base, row(3)
    n = 0
    at_ghost = 0
    at_image = 0
    first = field%work%first(s)
    row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (axis == 1) then
      if (ghost < first .or. ghost > field%work%last(s)) return
      n = 1
      at_ghost = field%neighbour(0, 0, s) + ghost
      at_image = field%neighbour(0, 0, s) + image
    else
      if (row(merge(3, axis, field%ndim == 2)) /= ghost) return
      row(merge(3, axis, field%ndim == 2)) = image
      base = field_base(field, row(2), row(3), first)
      if (base == huge(1)) return
      n = field%work%last(s) - first + 1
      at_ghost = field%neighbour(0, 0, s) + first
      at_image = base + first
    end if
  end subroutine ghost_records

end module sgmp_walls
