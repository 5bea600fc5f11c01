!> Walls and the correction at surfaces (doc/surfaces.md): a slip wall is the plane of symmetry of a
!! mirrored body, whose second differences and gradients are images of those inside.
module sgmp_surface_walls
  use sgmp_columns, only: twist_takes, twists
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_walls, only: ghost_intervals, ghost_point, ghost_records
  implicit none
  private
  public :: surface_walls_fold, surface_walls_mirror

contains

  !> Folds the forces on second and third differences behind walls onto their images; behind fixed
  !! walls there are none.
  pure subroutine surface_walls_fold(field, mesh)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer :: axis, side, ghost, image, s, first, last, from, to, n, q
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (any(mesh%wall(side, axis) == [wall_free, wall_fixed])) cycle
        call ghost_point(mesh, axis, side, .true., ghost, image)
        call ghost_intervals(field, axis, ghost, 1, field%planes, first, last)
        do s = first, last
          call ghost_records(field, s, axis, ghost, image, from, to, n)
          if (n == 0) cycle
          associate (centre => field%pairs%centre)
            do q = 1, size(centre, 2)
              centre(to:to + n - 1, q) = centre(to:to + n - 1, q) + &
                column_parity(q, axis, mesh%ndim)*centre(from:from + n - 1, q)
              centre(from:from + n - 1, q) = 0.0_dp
            end do
          end associate
        end do
      end do
    end do
  end subroutine surface_walls_fold

  !> Gives centres behind walls the images of what is added to gradients. Behind fixed walls it is
  !! the odd image of nodal velocities, as the gradient found there is before it is made even
  !! (auxmesh_mirror).
  pure subroutine surface_walls_mirror(field, mesh)
    type(field_t), intent(inout) :: field
    type(mesh_t), intent(in) :: mesh
    integer :: axis, side, ghost, image, s, first, last, from, to, n, q
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (mesh%wall(side, axis) == wall_free) cycle
        call ghost_point(mesh, axis, side, .true., ghost, image)
        call ghost_intervals(field, axis, ghost, 1, field%planes, first, last)
        do s = first, last
          call ghost_records(field, s, axis, ghost, image, to, from, n)
          if (n == 0) cycle
          associate (gain => field%pairs%gain)
            do q = 1, size(gain, 2)
              gain(to:to + n - 1, q) = gain(from:from + n - 1, q)* &
                gain_parity(q, axis, mesh%ndim, mesh%wall(side, axis) == wall_fixed)
            end do
          end associate
        end do
      end do
    end do
  end subroutine surface_walls_mirror

  !> Sign of the image of a column of differences at a slip wall; about an axis there is behind them
  !! that of the slope along z of the hoop strain.
  pure function column_parity(column, normal, ndim) result(parity)
    integer, intent(in) :: column, normal, ndim
    real(dp) :: parity
    integer :: twist
    logical :: across
    twist = (column - 1)/ndim + 1
    parity = merge(1.0_dp, -1.0_dp, normal == 1)
    if (twist > twists(ndim)) return
    parity = -1.0_dp
    across = mod(column - 1, ndim) + 1 == normal
    if (across .eqv. twist_takes(twist, normal, ndim)) parity = 1.0_dp
  end function column_parity

  !> Sign of the image of what is added to a component of the velocity gradient, or to the hoop
  !! strain.
  pure function gain_parity(column, normal, ndim, fixed) result(parity)
    integer, intent(in) :: column, normal, ndim
    logical, intent(in) :: fixed
    real(dp) :: parity
    logical :: odd
    associate (component => (column - 1)/ndim + 1, axis => mod(column - 1, ndim) + 1)
      if (column > ndim**2) then
        odd = fixed
      else if (fixed) then
        odd = axis /= normal
      else
        odd = (component == normal) .neqv. (axis == normal)
      end if
    end associate
    parity = merge(-1.0_dp, 1.0_dp, odd)
  end function gain_parity

end module sgmp_surface_walls
