!> Columns of the grid for the correction at surfaces (doc/surfaces.md).
module sgmp_surface_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, stage_mass, stage_pairs, stage_stress, &
                          twist_takes, twists
  use sgmp_images, only: image_beside, image_product, image_t
  implicit none
  private
  public :: pairs_ask, room_ask, surfaces_ask, surfaces_ask_faces

contains

  !> Mass moments of pairs of centres, stored at the upper one of each. Those that reach across a
  !! wall are their own images.
  pure subroutine pairs_ask(columns, ndim)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    integer :: pair, axis
    call columns_ask(columns, block_t('pairs', stage_pairs, &
      [(image_beside([(pair == axis, axis=1, 3)]), pair=1, ndim)]))
  end subroutine pairs_ask

  !> In space those of quads, too.
  pure subroutine surfaces_ask(columns, ndim)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    integer :: quad, axis
    columns%corrected = .true.
    if (ndim == 3) call columns_ask(columns, block_t('quads', stage_pairs, &
      [(image_beside([(quad /= axis, axis=1, 3)]), quad=1, 3)]))
  end subroutine surfaces_ask

  !> Where something can come apart, the volume of what has not.
  pure subroutine room_ask(columns)
    type(columns_t), intent(inout) :: columns
    call columns_ask(columns, block_t('room', stage_mass, [image_t()]))
  end subroutine room_ask

  !> Forces on faces times two and three levers, component by component for each twist.
  pure subroutine surfaces_ask_faces(columns, ndim)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    integer :: a, t, d
    call columns_ask(columns, block_t('twist', stage_stress, &
      [((image_product(a, [(twist_takes(t, d, ndim), d=1, ndim)]), a=1, ndim), &
        t=1, twists(ndim))], apart=.true.))
  end subroutine surfaces_ask_faces

end module sgmp_surface_columns
