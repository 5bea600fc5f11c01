!> Bodies whose particles have the volume of their shapes (doc/user-guide.md, Particles and shapes).
!!
!! Loads act on the faces of cubes, or of what is left of cubes that a plane along the lattice cuts.
!! What a load acts on where it is curved or oblique is made of whole cubes: their faces are stairs
!! whose area vectors add up to those of the shape. So is all that a load acts on with gimp and
!! cpgimp, whose functions are those of cubes.
module sgmp_body_fit
  use sgmp_kernels, only: method_cpgimp, method_gimp
  use sgmp_load, only: load_force
  use sgmp_mesh, only: wall_absorbing
  use sgmp_scene, only: body_card_t, scene_t
  use sgmp_shapes, only: shapes_flat
  implicit none
  private
  public :: body_fit_settle

contains

  !> Leaves those bodies whole cubes whose loads, or edges that let waves out, ask for them.
  pure subroutine body_fit_settle(scene)
    type(scene_t), intent(inout) :: scene
    integer :: axis, b, i
    logical :: of_cubes
    of_cubes = any(scene%method%kind == [method_gimp, method_cpgimp])
    do i = 1, size(scene%loads)
      associate (load => scene%loads(i))
        if (load%kind == load_force .or. load%body == 0) cycle
        associate (body => scene%bodies(load%body))
          do axis = 1, scene%dimension
            if (load%axis == axis .or. load%axis == 0) call need_flat(body, axis, of_cubes)
          end do
        end associate
      end associate
    end do
    do axis = 1, scene%dimension
      if (all(scene%grid%wall(:, axis) /= wall_absorbing)) cycle
      do b = 1, size(scene%bodies)
        call need_flat(scene%bodies(b), axis, of_cubes)
      end do
    end do
  end subroutine body_fit_settle

  !> Takes whole cubes unless a body's shapes are flat along an axis, and that is of use.
  pure subroutine need_flat(body, axis, of_cubes)
    type(body_card_t), intent(inout) :: body
    integer, intent(in) :: axis
    logical, intent(in) :: of_cubes
    if (.not. allocated(body%shapes)) return
    body%fitted = body%fitted .and. .not. of_cubes .and. shapes_flat(body%shapes, axis)
  end subroutine need_flat

end module sgmp_body_fit
