!> Columns of the grid for the forces of walls that let go.
module sgmp_one_sided_columns
  use sgmp_columns, only: block_t, columns_ask, columns_t, stage_stress
  use sgmp_images, only: image_radial, image_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  implicit none
  private
  public :: one_sided_ask, one_sided_components

contains

  !> One for each component of these forces; along r it turns behind the axis.
  pure subroutine one_sided_ask(columns, mesh)
    type(columns_t), intent(inout) :: columns
    type(mesh_t), intent(in) :: mesh
    type(image_t), allocatable :: images(:)
    logical :: acts(3)
    acts = one_sided_components(mesh)
    if (.not. any(acts)) return
    allocate (images(count(acts)))
    if (acts(1)) images(1) = image_radial()
    call columns_ask(columns, block_t('push', stage_stress, images, outside=.true.))
  end subroutine one_sided_ask

  !> Components of the forces of such walls: all where some are rough.
  pure function one_sided_components(mesh) result(acts)
    type(mesh_t), intent(in) :: mesh
    logical :: acts(3)
    acts = any(mesh%one_sided, dim=1) .or. any(mesh%rough > 0.0_dp)
    acts(mesh%ndim + 1:) = .false.
  end function one_sided_components

end module sgmp_one_sided_columns
