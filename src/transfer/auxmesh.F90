! dimension-generic, axisymmetric
#include "dimension.inc"
!> The auxiliary grid of SGMP: values at cell centres from the nodes around them (Eqs. 25, 26, 32,
!! 33), as records that the particle sweeps read.
!!
!! MPM and GIMP read the nodes themselves; for them the records are copies of the nodal values.
module DIM(sgmp_auxmesh)
  use sgmp_columns, only: collide_kick, node_acceleration, node_swirl, node_velocity, &
                          relax_dilation, relax_total
  use sgmp_field, only: field_t
  use CARTESIAN(sgmp_graded_rows), only: graded_slopes
#ifdef AXISYMMETRIC
  use CARTESIAN(sgmp_graded_rows), only: graded_hoop
#endif
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_rows, only: key_j, key_k
  implicit none
  private
  public :: auxmesh_copy, auxmesh_fill, auxmesh_midway, auxmesh_mirror, &
            auxmesh_relax, auxmesh_swirl
  public :: graded_row, node_rows
#if NDIM == 2
  public :: auxmesh_fill_cells
#endif

  integer, parameter :: tile = 128

contains

  !> Records of one plane: first the vectors whose node columns are listed, then the gradient of one
  !! vector.
  pure subroutine auxmesh_fill(field, mesh, plane, vectors, gradient, stride, records)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane                 !! plane of the field
    integer, intent(in) :: vectors(:)            !! first node column of each vector to interpolate
    integer, intent(in) :: gradient  !! first node column of the vector to differentiate; 0: none
    integer, intent(in) :: stride                !! components of a record
    real(dp), intent(inout) :: records(stride, *)  !! (stride, points of the plane)
    integer :: s, first, n, q, v, a, point
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        point = field%neighbour(0, 0, s) + first - field%plane_start(plane) + 1
        q = 0
        do v = 1, size(vectors)
          do a = 0, NDIM - 1
            q = q + 1
            call fill_value(field, s, first, n, vectors(v) + a, stride, records(q, point))
          end do
        end do
        if (gradient == 0) cycle
        do a = 0, NDIM - 1
          if (kernel_centred(field%kernel)) then
            if (mesh%graded) then
              call graded_slopes(mesh, field%linear, graded_row(field, s), first, n, &
                                 field%node(1, gradient + a), node_rows(field, s, first), stride, &
                                 records(q + 1, point))
            else
              call fill_gradient(field, mesh%inverse_h, s, first, n, gradient + a, stride, &
                                 records(q + 1, point))
            end if
            q = q + NDIM
          else
            q = q + 1
            call fill_value(field, s, first, n, gradient + a, stride, records(q, point))
          end if
        end do
#ifdef AXISYMMETRIC
        if (kernel_centred(field%kernel)) then
          if (mesh%graded) then
            call graded_hoop(mesh, field%linear, graded_row(field, s), first, n, &
                             field%hoop(first, 1), field%hoop(first, 2), field%node(1, gradient), &
                             node_rows(field, s, first), stride, records(q + 1, point))
          else
            call fill_hoop(n, mesh%inverse_h, field%hoop(first, 1), field%hoop(first, 2), &
                           field%node(1, gradient), node_rows(field, s, first), stride, &
                           records(q + 1, point))
          end if
        end if
#endif
      end do
    end do
  end subroutine auxmesh_fill

#if NDIM == 2
  !> Records of cells that hold one vector at each of their points: what the points of one plane
  !! give to the cells of this plane, whose lower points they are, or to those of the plane below.
  pure subroutine auxmesh_fill_cells(field, plane, below, column, cells)
    type(field_t), intent(in) :: field
    integer, intent(in) :: plane                 !! plane of the field
    integer, intent(in) :: below                 !! 1: fill the cells of the plane below, else 0
    integer, intent(in) :: column                !! first node column of the vector
    real(dp), intent(inout) :: cells(NDIM, 0:1, 0:1, *)  !! (component, row, x; points of the plane)
    real(dp) :: vector(tile, NDIM)
    integer :: s, first, n, a, i, at
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        do a = 1, NDIM
          call fill_value(field, s, first, n, column + a - 1, 1, vector(1, a))
        end do
        at = field%neighbour(0, -below, s) + first - field%plane_start(plane - below)
        do i = 1, n
          cells(:, below, 0, at + i) = vector(i, :)
        end do
        ! No particle is in the cell before the first point.
        do i = merge(2, 1, first == field%work%first(s)), n
          cells(:, below, 1, at + i - 1) = vector(i, :)
        end do
      end do
    end do
  end subroutine auxmesh_fill_cells
#endif

  !> Makes the gradients of one plane even at centres behind fixed walls, as the stress is when it
  !! is folded (theory 3), and the hoop strain behind an outer wall.
  !!
  !! The nodes behind the wall are the odd image of those inside, which leaves the derivatives along
  !! the wall odd.
  pure subroutine auxmesh_mirror(field, mesh, plane, swirl, before, stride, records)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane                 !! plane of the field
    logical, intent(in) :: swirl                 !! its slopes lie behind the gradient
    integer, intent(in) :: before                !! components of a record before the gradient
    integer, intent(in) :: stride                !! components of a record
    real(dp), intent(inout) :: records(stride, *)  !! (stride, points of the plane)
    integer :: s, axis, side, ghost, row(3), first, last, base
    if (NDIM == 1 .or. .not. kernel_centred(field%kernel)) return
#ifdef AXISYMMETRIC
    if (mesh%wall(2, 1) /= wall_free) call mirror_hoop(field, mesh, plane, before, stride, records)
#endif
    if (.not. any(mesh%wall(:, :NDIM) == wall_fixed)) return
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      row = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
      if (NDIM == 2) row(2) = row(3)
      base = field%neighbour(0, 0, s) - field%plane_start(plane) + 1
      do axis = 1, NDIM
        do side = 1, 2
          if (mesh%wall(side, axis) /= wall_fixed) cycle
          ghost = merge(mesh%lower(axis) - 1, mesh%upper(axis), side == 1)
          first = field%work%first(s)
          last = field%work%last(s)
          if (axis == 1) then
            first = max(first, ghost)
            last = min(last, ghost)
          else if (row(axis) /= ghost) then
            cycle
          end if
          if (first <= last) then
            call reverse_along(axis, last - first + 1, swirl, before, stride, &
                               records(1, base + first))
          end if
        end do
      end do
    end do
  end subroutine auxmesh_mirror

  !> Adds to the records of one plane what particles read of swirl: slopes of the rate that belongs
  !! to the vector that is differentiated, and its acceleration where velocities are kicked.
  pure subroutine auxmesh_swirl(field, mesh, plane, kick, pic, gradient, before, stride, records)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane                 !! plane of the field
    logical, intent(in) :: kick, pic             !! the acceleration, the rate after it
    integer, intent(in) :: gradient              !! as for auxmesh_fill
    integer, intent(in) :: before                !! components of a record before swirl's
    integer, intent(in) :: stride                !! components of a record
    real(dp), intent(inout) :: records(stride, *)  !! (stride, points of the plane)
    integer :: s, n, q, point
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      n = field%work%last(s) - field%work%first(s) + 1
      point = field%neighbour(0, 0, s) + field%work%first(s) - field%plane_start(plane) + 1
      q = before + 1
      if (gradient > 0) then
        if (mesh%graded) then
          call fill_graded(field, mesh, s, n, node_swirl(gradient), stride, records(q, point))
        else
          call fill_gradient(field, mesh%inverse_h, s, field%work%first(s), n, &
                             node_swirl(gradient), stride, records(q, point))
        end if
        q = q + NDIM
      end if
      if (kick) call fill_value(field, s, field%work%first(s), n, node_swirl(node_acceleration), &
                                stride, records(q, point))
      if (pic) call fill_value(field, s, field%work%first(s), n, &
                               node_swirl(node_velocity(NDIM)), stride, records(q + 1, point))
    end do
  end subroutine auxmesh_swirl

  !> Adds to the records of one plane what particles relax to; the factor of
  !! normalised stress becomes the divergence by which it exceeds what the particles read.
  pure subroutine auxmesh_relax(field, plane, before, first, stride, records)
    type(field_t), intent(in) :: field
    integer, intent(in) :: plane                 !! plane of the field
    integer, intent(in) :: before                !! components of a record before the gradient
    integer, intent(in) :: first                 !! component to begin with
    integer, intent(in) :: stride                !! components of a record
    real(dp), intent(inout) :: records(stride, *)  !! (stride, points of the plane)
    real(dp) :: divergence
    integer :: s, i, a, from, to
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do i = field%work%first(s), field%work%last(s)
        from = field%neighbour(0, 0, s) + i
        to = from - field%plane_start(plane) + 1
        divergence = 0.0_dp
        do a = 1, NDIM
          divergence = divergence + records(before + (a - 1)*NDIM + a, to)
        end do
#ifdef AXISYMMETRIC
        divergence = divergence + records(before + NGRAD, to)
#endif
        records(first:first + relax_total(NDIM) - 1, to) = field%relax(from, :)
        records(first + relax_dilation - 1, to) = field%relax(from, relax_dilation)*divergence
      end do
    end do
  end subroutine auxmesh_relax

  !> Copies values of the points of one plane into its records: what debris collides by, what
  !! plastic strain is averaged by.
  pure subroutine auxmesh_copy(field, plane, at, components, values, stride, records)
    type(field_t), intent(in) :: field
    integer, intent(in) :: plane                 !! plane of the field
    integer, intent(in) :: at                    !! first component of a record
    integer, intent(in) :: components
    real(dp), intent(in) :: values(:, :)         !! (points, components or more)
    integer, intent(in) :: stride                !! components of a record
    real(dp), intent(inout) :: records(stride, *)  !! (stride, points of the plane)
    integer :: s, i, from, to
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do i = field%work%first(s), field%work%last(s)
        from = field%neighbour(0, 0, s) + i
        to = from - field%plane_start(plane) + 1
        records(at:at + components - 1, to) = values(from, :components)
      end do
    end do
  end subroutine auxmesh_copy

  !> Takes gradients in the records of one plane, which are those of the velocity after a kick, back
  !! by a part of it, and adds the square of the acceleration behind them.
  pure subroutine auxmesh_midway(field, mesh, plane, back, before, stride, records)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane                 !! plane of the field
    real(dp), intent(in) :: back                 !! part of the velocity step
    integer, intent(in) :: before                !! components of a record before the gradient
    integer, intent(in) :: stride                !! components of a record
    real(dp), intent(inout) :: records(stride, *)  !! (stride, points of the plane)
    real(dp), allocatable :: slopes(:, :)        !! too large for the stack of a thread
    integer :: s, i, first, n, to, read
    integer, parameter :: none(0) = 0
    allocate (slopes(NGRAD, field%largest_plane))
    call auxmesh_fill(field, mesh, plane, none, node_acceleration, NGRAD, slopes)
    read = merge(NGRAD, NDIM, kernel_centred(field%kernel))
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      first = field%work%first(s)
      n = field%work%last(s) - first + 1
      to = field%neighbour(0, 0, s) + first - field%plane_start(plane) + 1
      do i = to, to + n - 1
        records(before + 1:before + read, i) = records(before + 1:before + read, i) &
                                               - back*slopes(:read, i)
      end do
      if (kernel_centred(field%kernel)) then
        call fill_mean(n, field%collide(1, collide_kick(NDIM)), node_rows(field, s, first), &
                       stride, &
                       records(before + NGRAD + 1, to))
      else
        records(before + NGRAD + 1, to:to + n - 1) = &
          field%collide(field%neighbour(0, 0, s) + first:field%neighbour(0, 0, s) + first + n - 1, &
                        collide_kick(NDIM))
      end if
    end do
  end subroutine auxmesh_midway

  !> Changes the sign of all derivatives but those along `axis`.
  pure subroutine reverse_along(axis, n, swirl, before, stride, records)
    integer, intent(in) :: axis, n, before, stride
    logical, intent(in) :: swirl
    real(dp), intent(inout) :: records(stride, n)
    integer :: a, b
    do a = 0, NDIM - 1
      do b = 1, NDIM
        if (b /= axis) records(before + a*NDIM + b, :) = -records(before + a*NDIM + b, :)
      end do
    end do
#ifdef AXISYMMETRIC
    if (axis == 2) records(before + NGRAD, :) = -records(before + NGRAD, :)
#endif
    if (swirl) then
      b = before + NGRAD + NDIM + 1 - axis  ! the axis that is not `axis`
      records(b, :) = -records(b, :)
    end if
  end subroutine reverse_along

#ifdef AXISYMMETRIC
  !> Copies the hoop strain to centres behind the outer wall, where the formula would take the
  !! radius of the image.
  pure subroutine mirror_hoop(field, mesh, plane, before, stride, records)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane, before, stride
    real(dp), intent(inout) :: records(stride, *)
    integer :: s, ghost
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      if (mesh%upper(1) <= field%work%first(s) .or. mesh%upper(1) > field%work%last(s)) cycle
      ghost = field%neighbour(0, 0, s) - field%plane_start(plane) + 1 + mesh%upper(1)
      records(before + NGRAD, ghost) = records(before + NGRAD, ghost - 1)
    end do
  end subroutine mirror_hoop

  !> Hoop strain rates at the centres of a row (sgmp_axis).
  pure subroutine fill_hoop(n, inverse_h, inner, outer, column, b, stride, records)
    integer, intent(in) :: n, b(NROW), stride
    real(dp), intent(in) :: inverse_h, inner(n), outer(n)
    real(dp), intent(in) :: column(*)            !! radial velocity
    real(dp), intent(inout) :: records(stride, n)
    integer :: i
    do i = 1, n
      records(1, i) = inverse_h*(inner(i)*corner_sum(column, b, i - 1) &
                                      + outer(i)*corner_sum(column, b, i))
    end do
  end subroutine fill_hoop
#endif

  !> One component: mean of the 2^d nodes around each centre (SGMP), or the node itself.
  pure subroutine fill_value(field, s, first, n, column, stride, records)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first, n, column, stride
    real(dp), intent(inout) :: records(stride, n)
    integer :: i
    if (kernel_centred(field%kernel)) then
      call fill_mean(n, field%node(1, column), node_rows(field, s, first), stride, records)
    else
      do i = 1, n
        records(1, i) = field%node(field%neighbour(0, 0, s) + first + i - 1, column)
      end do
    end if
  end subroutine fill_value

  !> Means of the nodes around the centres of a row.
  pure subroutine fill_mean(n, column, b, stride, records)
    integer, intent(in) :: n, b(NROW), stride
    real(dp), intent(in) :: column(*)
    real(dp), intent(inout) :: records(stride, n)
    integer :: i
    do i = 1, n
      records(1, i) = 0.5_dp**NDIM*(corner_sum(column, b, i - 1) + corner_sum(column, b, i))
    end do
  end subroutine fill_mean

  !> Derivatives of one component along all axes at each centre.
  pure subroutine fill_gradient(field, inverse_h, s, first, n, column, stride, records)
    type(field_t), intent(in) :: field
    real(dp), intent(in) :: inverse_h
    integer, intent(in) :: s, first, n, column, stride
    real(dp), intent(inout) :: records(stride, n)
    call fill_slopes(n, inverse_h*0.5_dp**(NDIM - 1), field%node(1, column), &
                     node_rows(field, s, first), stride, records)
  end subroutine fill_gradient

  !> The same of a whole row where cells are unequal.
  pure subroutine fill_graded(field, mesh, s, n, column, stride, records)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, n, column, stride
    real(dp), intent(inout) :: records(stride, n)
    integer :: i, first
    do i = 1, n, tile
      first = field%work%first(s) + i - 1
      call graded_slopes(mesh, field%linear, graded_row(field, s), first, min(tile, n - i + 1), &
                         field%node(1, column), node_rows(field, s, first), stride, records(1, i))
    end do
  end subroutine fill_graded

  !> Differences of the nodes around the centres of a row, along each axis.
  pure subroutine fill_slopes(n, scale, column, b, stride, records)
    integer, intent(in) :: n, b(NROW), stride
    real(dp), intent(in) :: scale, column(*)
    real(dp), intent(inout) :: records(stride, n)
    integer :: i
    do i = 1, n
      records(1, i) = scale*(corner_sum(column, b, i) - corner_sum(column, b, i - 1))
#if NDIM > 1
      records(2, i) = scale*(corner_slope_2(column, b, i - 1) + corner_slope_2(column, b, i))
#endif
#if NDIM > 2
      records(3, i) = scale*(corner_slope_3(column, b, i - 1) + corner_slope_3(column, b, i))
#endif
    end do
  end subroutine fill_slopes

  !> Numbers along the slower axes of a row of points (y, z in space; y in the plane).
  pure function graded_row(field, s) result(row)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s
    integer :: row(2)
    row = [key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (NDIM == 2) row(1) = row(2)
  end function graded_row

  !> Records of node `first` in the rows of nodes around a row of centres.
  pure function node_rows(field, s, first) result(b)
    type(field_t), intent(in) :: field
    integer, intent(in) :: s, first
    integer :: b(NROW)
    integer :: r
    do r = 1, NROW
      b(r) = field%neighbour((r - 1)/2, mod(r - 1, 2), s) + first
    end do
  end function node_rows

#include "corner_sums.inc"

end module DIM(sgmp_auxmesh)
