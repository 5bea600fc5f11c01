!> Where slow flow at absorbing edges comes from, if the deck does not say (doc/loads.md, Absorbing
!! edges): liquids around a bubble or a charge feel the inertia of what lies beyond the edges.
module sgmp_edge_sources
  use sgmp_constitutive, only: law_gaseous
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_absorbing, wall_slip
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_turn, only: turn_box
  implicit none
  private
  public :: edge_sources_settle

contains

  !> Takes the middle of the only gas or charge that ends before all absorbing edges.
  subroutine edge_sources_settle(scene)
    type(scene_t), intent(inout) :: scene
    real(dp) :: middle(3), own(3)
    integer :: b
    logical :: known
    if (scene%grid%springs .or. scene%dimension == 1) return
    if (.not. any(scene%grid%wall == wall_absorbing)) return
    known = .false.
    do b = 1, size(scene%bodies)
      if (.not. bursts(scene, b)) cycle
      own = middle_of(scene, b)
      if (known .and. norm2(own - middle) > scene%grid%cell) return
      if (.not. known) middle = own
      known = .true.
    end do
    scene%grid%inertia = known
    if (known) scene%grid%source = middle
  end subroutine edge_sources_settle

  !> Whether a body is gas, or becomes it, and ends before all absorbing edges.
  pure function bursts(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    real(dp) :: lower(3), upper(3), gap(2)
    integer :: axis
    associate (body => scene%bodies(b), grid => scene%grid)
      yes = .not. body%rigid .and. body%material > 0 .and. allocated(body%shapes)
      if (yes) yes = size(body%shapes) > 0
      if (yes) yes = law_gaseous(scene%materials(body%material)%law)
      if (.not. yes) return
      call box_of(scene, b, lower, upper)
      do axis = 1, scene%dimension
        gap = [lower(axis) - grid%lower(axis), grid%upper(axis) - upper(axis)]
        yes = yes .and. all(gap > grid%cell .or. grid%wall(:, axis) /= wall_absorbing)
      end do
    end associate
  end function bursts

  !> Middle of the box around a body, about an axis on that.
  pure function middle_of(scene, b) result(middle)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    real(dp) :: middle(3)
    real(dp) :: lower(3), upper(3)
    integer :: axis
    call box_of(scene, b, lower, upper)
    middle = 0.0_dp
    associate (grid => scene%grid)
      do axis = 1, scene%dimension
        middle(axis) = 0.5_dp*(lower(axis) + upper(axis))
        ! Half of a body lies at a plane of symmetry.
        if (grid%wall(1, axis) == wall_slip .and. lower(axis) - grid%lower(axis) < grid%cell) then
          middle(axis) = grid%lower(axis)
        else if (grid%wall(2, axis) == wall_slip .and. &
                 grid%upper(axis) - upper(axis) < grid%cell) then
          middle(axis) = grid%upper(axis)
        end if
      end do
    end associate
    if (scene%axisymmetric) middle(1) = 0.0_dp
  end function middle_of

  !> Box around a body.
  pure subroutine box_of(scene, b, lower, upper)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    real(dp), intent(out) :: lower(3), upper(3)
    call shapes_box(scene%bodies(b)%shapes, lower, upper)
    if (scene%dimension > 1) call turn_box(scene%bodies(b)%turn, lower, upper)
  end subroutine box_of

end module sgmp_edge_sources
