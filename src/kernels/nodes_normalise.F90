! dimension-generic, axisymmetric
#include "dimension.inc"
!> Volume-normalised stress at the centres of one plane (doc/normalised-stress.md).
module DIM(sgmp_nodes_normalise)
#ifdef AXISYMMETRIC
  use sgmp_axis, only: axis_cell, axis_radius, axis_radius_balanced
#endif
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_width
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_rows, only: key_j, key_k
  implicit none
  private
  public :: nodes_normalise
  public :: cell_sides, cell_volume, filled_volumes, grade_volumes, least_volume, normalise_factor

  integer, parameter :: tile = 128
  !> Of solids, a centre less full than this is none of a body's inside, but a gap that closes or a
  !! crack that opens: its stress keeps the particles' volumes. One that is fuller than `full` takes
  !! the cell's. Gases fill what they have, however few their particles are.
  real(dp), parameter :: empty = 0.5_dp, full = 0.75_dp

contains

  !> Volume-normalised stress: multiplies the stress moments of interior centres by V/V_c, where
  !! V_c is the volume that particles gave to the centre and V what they give where they fill
  !! everything (h^d), so that it is weighted by the cell's volume wherever particles are.
  !!
  !! A centre is interior if it and all its neighbours are filled beyond the fraction `interior`;
  !! what lies behind a wall counts as filled. Volumes are only read and stresses only scaled, so
  !! planes may be done in any order.
  pure subroutine nodes_normalise(field, mesh, plane, interior)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: plane
    real(dp), intent(in) :: interior
    real(dp) :: least(0:tile + 1), factor(tile), filled(tile), cell, around, volume
    integer :: s, first, n, i, q, idx, last      !! last: column of a stress
    cell = cell_volume(mesh%h)
    last = field%columns%normalised
    do s = field%plane_work(plane), field%plane_work(plane + 1) - 1
      do first = field%work%first(s), field%work%last(s), tile
        n = min(tile, field%work%last(s) - first + 1)
        idx = field%neighbour(0, 0, s) + first - 1
        call filled_volumes(mesh, cell, field%hoop_correction, first, n, filled)
        call least_volume(field, mesh, s, first, n, cell, least)
        if (mesh%graded) then
          call grade_volumes(mesh, key_j(field%work%key(s)), key_k(field%work%key(s)), first, n, &
                             filled)
        end if
        !$omp simd private(around, volume)
        do i = 1, n
          around = min(least(i - 1), least(i), least(i + 1))
          volume = merge(field%moment(idx + i, field%columns%volume), filled(i), &
                         around > interior*cell)
          factor(i) = normalise_factor(volume, filled(i), field%gaps)
        end do
        if (field%columns%room > 0) call keep_debris(field, idx, n, factor)
        do q = field%columns%force, last
          !$omp simd
          do i = 1, n
            field%moment(idx + i, q) = factor(i)*field%moment(idx + i, q)
          end do
        end do
      end do
    end do
  end subroutine nodes_normalise

  !> What the stress of an interior centre is multiplied by: of solids none where a gap closes or
  !! opens.
  elemental function normalise_factor(volume, filled, gaps) result(factor)
    real(dp), intent(in) :: volume, filled       !! of the particles, of a full cell
    logical, intent(in) :: gaps                  !! of a field with solids
    real(dp) :: factor, part
    part = merge(min(1.0_dp, max(0.0_dp, (volume/filled - empty)/(full - empty))), 1.0_dp, gaps)
    factor = 1.0_dp + part*(filled/volume - 1.0_dp)
  end function normalise_factor

  !> Debris is not normalised: factors by the part of the volume that has not come apart.
  pure subroutine keep_debris(field, before, n, factor)
    type(field_t), intent(in) :: field
    integer, intent(in) :: before, n             !! record before the first centre, how many
    real(dp), intent(inout) :: factor(n)
    integer :: i
    associate (volume => field%moment(:, field%columns%volume), &
               room => field%moment(:, field%columns%room))
      do i = 1, n
        if (room(before + i) < volume(before + i)) then
          factor(i) = 1.0_dp + room(before + i)/volume(before + i)*(factor(i) - 1.0_dp)
        end if
      end do
    end associate
  end subroutine keep_debris

  !> Volume of a cell; about an axis, over its radius in cells.
  pure function cell_volume(h) result(volume)
    real(dp), intent(in) :: h
    real(dp) :: volume
#ifdef AXISYMMETRIC
    volume = axis_cell(h)
#else
    volume = h**NDIM
#endif
  end function cell_volume

  !> Volumes that the centres of a row have where they are full.
  pure subroutine filled_volumes(mesh, cell, correction, first, n, filled)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: cell              !! cell_volume
    real(dp), intent(in) :: correction        !! of the hoop strain, about an axis
    integer, intent(in) :: first, n           !! first centre, how many
    real(dp), intent(out) :: filled(n)
    filled = cell
#ifdef AXISYMMETRIC
    block
      integer :: i
      do i = 1, n
        filled(i) = cell*axis_radius_balanced(mesh%axes(1), correction, first + i - 1)
      end do
    end block
#endif
  end subroutine filled_volumes

  !> Turns volumes of equal cells into those of the cells of a row.
  pure subroutine grade_volumes(mesh, j, k, first, n, volumes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: j, k, first, n
    real(dp), intent(inout) :: volumes(n)
    real(dp) :: across
    integer :: i
    across = section_across(mesh, j, k)
    do i = 1, n
      volumes(i) = volumes(i)*(across*graded_width(mesh%axes(1), first + i - 1))
    end do
  end subroutine grade_volumes

  !> Least sides of the cells of a row (smallest cell).
  pure subroutine cell_sides(mesh, j, k, first, n, sides)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: j, k               !! of the row
    integer, intent(in) :: first, n           !! first centre, how many
    real(dp), intent(out) :: sides(n)
    integer :: i
    sides = 1.0_dp
    if (.not. mesh%graded) return
    sides = graded_width(mesh%axes(1), [(first + i - 1, i=1, n)])
    if (NDIM > 1) sides = min(sides, graded_width(mesh%axes(NDIM), k))
    if (NDIM > 2) sides = min(sides, graded_width(mesh%axes(2), j))
  end subroutine cell_sides

  !> Section of the cells of a row across it (smallest cell).
  pure function section_across(mesh, j, k) result(across)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: j, k
    real(dp) :: across
    across = 1.0_dp
    if (NDIM > 1) across = graded_width(mesh%axes(NDIM), k)
    if (NDIM > 2) across = across*graded_width(mesh%axes(2), j)
  end function section_across

  !> What lies behind walls across a row counts as filled.
  pure subroutine fill_behind(mesh, first, n, cell, least)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: first, n
    real(dp), intent(in) :: cell
    real(dp), intent(inout) :: least(0:tile + 1)
    integer :: i, side
    do side = 1, 2
      if (mesh%wall(side, 1) == wall_free) cycle
      i = merge(mesh%lower(1) - 1, mesh%upper(1), side == 1) - first + 1
      if (i >= 0 .and. i <= n + 1) least(i) = cell
    end do
  end subroutine fill_behind

  !> Least volume over the rows around each centre of a tile and its two neighbours: about an axis
  !! over the radius, of unequal cells over that of the cell, times that of equal ones.
  pure subroutine least_volume(field, mesh, s, first, n, cell, least)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n
    real(dp), intent(in) :: cell
    real(dp), intent(out) :: least(0:tile + 1)
    real(dp) :: one(0:tile + 1), across       !! sections of unequal cells, times radii
    integer :: dj, dk, i, b, j, k
    j = key_j(field%work%key(s))
    k = key_k(field%work%key(s))
    least = cell
    if (mesh%graded) then
      one(:n + 1) = graded_width(mesh%axes(1), [(first + i - 1, i=0, n + 1)])
#ifdef AXISYMMETRIC
      one(:n + 1) = one(:n + 1)*axis_radius(mesh%axes(1), [(first + i - 1, i=0, n + 1)])
#endif
    end if
    do dk = merge(-1, 0, NDIM > 1), merge(1, 0, NDIM > 1)
      do dj = merge(-1, 0, NDIM > 2), merge(1, 0, NDIM > 2)
        if (NDIM > 1 .and. behind_wall(mesh, NDIM, k + dk)) cycle
        if (NDIM > 2 .and. behind_wall(mesh, 2, j + dj)) cycle
        b = field%neighbour(dj, dk, s) + first - 1
        if (mesh%graded) then
          across = section_across(mesh, j + dj, k + dk)
          !$omp simd
          do i = 0, n + 1
            least(i) = min(least(i), field%moment(b + i, field%columns%volume)/(across*one(i)))
          end do
          cycle
        end if
        !$omp simd
        do i = 0, n + 1
#ifdef AXISYMMETRIC
          least(i) = min(least(i), field%moment(b + i, field%columns%volume)/ &
                                   axis_radius(mesh%axes(1), first + i - 1))
#else
          least(i) = min(least(i), field%moment(b + i, field%columns%volume))
#endif
        end do
      end do
    end do
    call fill_behind(mesh, first, n, cell, least)
  end subroutine least_volume

  !> Whether centres of that index lie behind a wall of the axis.
  pure function behind_wall(mesh, axis, centre) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, centre
    logical :: yes
    yes = (mesh%wall(1, axis) /= wall_free .and. centre == mesh%lower(axis) - 1) .or. &
          (mesh%wall(2, axis) /= wall_free .and. centre == mesh%upper(axis))
  end function behind_wall

end module DIM(sgmp_nodes_normalise)
