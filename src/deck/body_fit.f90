!> Bodies whose particles have the volume of their shapes (doc/user-guide.md, Particles and shapes).
!!
!! Loads act on the faces of cubes, or of what is left of cubes that planes along the lattice cut.
!! Whole cubes are taken where a load acts on
!! - what is round or oblique to the lattice: the area vectors of its stairs are those of the shape;
!! - shapes with steps along the load: what is left of a cube in their corners is no box, and stress
!!   there would be off by the whole pressure (a block with a hole);
!! - bodies of gimp and cpgimp, whose functions are those of cubes.
module sgmp_body_fit
  use sgmp_kernels, only: method_cpgimp, method_gimp
  use sgmp_kinds, only: dp
  use sgmp_lattice, only: lattice_tolerance
  use sgmp_load, only: load_force
  use sgmp_mesh, only: wall_absorbing
  use sgmp_scene, only: body_card_t, scene_t
  use sgmp_shapes, only: combine_intersection, combine_union, shape_planes, shape_t, shapes_flat
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
    if (body%fitted) body%fitted = .not. steps(body%shapes, axis, lattice_tolerance*body%spacing)
  end subroutine need_flat

  !> Whether shapes that are united or subtracted end along an axis elsewhere than the body does.
  pure function steps(shapes, axis, near) result(yes)
    type(shape_t), intent(in) :: shapes(:)       !! flat along the axis
    integer, intent(in) :: axis
    real(dp), intent(in) :: near                 !! by which they may differ (length)
    logical :: yes
    real(dp) :: ends(2), planes(2)
    integer :: i
    ends = shape_planes(shapes(1), axis)
    do i = 2, size(shapes)
      if (shapes(i)%combine /= combine_intersection) cycle
      planes = shape_planes(shapes(i), axis)
      ends = [max(ends(1), planes(1)), min(ends(2), planes(2))]
    end do
    yes = .false.
    do i = 2, size(shapes)
      if (shapes(i)%combine == combine_intersection) cycle
      planes = shape_planes(shapes(i), axis)
      yes = yes .or. any(planes > ends(1) + near .and. planes < ends(2) - near)
      if (shapes(i)%combine == combine_union) then
        yes = yes .or. planes(1) < ends(1) - near .or. planes(2) > ends(2) + near
      end if
    end do
  end function steps

end module sgmp_body_fit
