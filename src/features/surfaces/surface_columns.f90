!> Columns of the grid for the correction at surfaces (doc/surfaces.md).
module sgmp_surface_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, pair_sums, stage_mass, stage_pairs, &
                          stage_stress, twist_takes, twists
  use sgmp_images, only: image_beside, image_product, image_t
  implicit none
  private
  public :: surfaces_ask, surfaces_ask_faces

contains

  !> Volume moments of pairs and quads of centres, and the volume that they are made of. Those that
  !! reach across a wall stay where they are, stored at the centre behind a lower wall and at the
  !! last one before an upper wall.
  pure subroutine surfaces_ask(columns, ndim)
    type(columns_t), intent(inout) :: columns
    integer, intent(in) :: ndim
    type(image_t) :: images(pair_sums(ndim))
    integer :: pair, axis
    do pair = 1, size(images)
      images(pair) = image_beside([(merge(pair == axis, pair - ndim /= axis, pair <= ndim), &
                                    axis=1, 3)])
    end do
    call columns_ask(columns, block_t('pairs', stage_pairs, images))
    call columns_ask(columns, block_t('room', stage_mass, [image_t()]))
  end subroutine surfaces_ask

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
