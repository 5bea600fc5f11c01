!> Solids that begin close to a wall of the grid and move towards it (doc/loads.md).
!!
!! A wall of the grid is a plane of symmetry: what shares a cell with it at the start is part of it,
!! as if it touched. A body that begins there comes to rest early and does not come off again. One
!! that begins farther away meets the wall and leaves it.
module sgmp_near_walls
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_place, mesh_t, wall_fixed, wall_slip
  use sgmp_model, only: model_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_space, only: axis_names
  use sgmp_text, only: real_text_about
  use sgmp_turn, only: turn_box
  implicit none
  private
  public :: near_walls, near_walls_flown_at

  real(dp), parameter :: touching = 0.01_dp   !! cells
  real(dp), parameter :: reach = 1.0_dp       !! cells from the wall to the middle of a particle

contains

  !> What is wrong with the place of a body at the start; '': nothing.
  subroutine near_walls(scene, model, b, text, touches)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: touches              !! it begins at the wall, not near it
    real(dp) :: gap
    integer :: axis, side
    text = ''
    touches = .false.
    associate (card => scene%bodies(b), law => model%bodies(b)%law)
      if (card%rigid .or. law_is_spherical(law) .or. .not. allocated(card%shapes)) return
      do axis = 1, model%mesh%ndim
        do side = 1, 2
          if (.not. (holds(model%mesh, axis, side) .and. approaches(scene, b, axis, side))) cycle
          gap = gap_of(scene, model%mesh, b, axis, side)
          if (gap > reach + 0.5_dp*card%spacing/model%mesh%h .or. gap < -touching) cycle
          touches = gap <= touching
          if (touches .and. .not. model%bodies(b)%springs) cycle
          text = begins(model, b, axis, side)
          if (touches) then
            text = text//' at it: the wall holds it as a plane of symmetry would, and it will '// &
                   'not come off; begin 1.5 cells away'
          else
            text = text//' '//real_text_about(gap)//' cells away: that is as if it touched, '// &
                   'and it will not come off; begin 1.5 cells away, or at the wall'
          end if
          return
        end do
      end do
    end associate
  end subroutine near_walls

  !> Whether a body flies at a wall that it does not touch at the start, one that lets go or one
  !! that holds.
  function near_walls_flown_at(scene, model, b, lets_go) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    logical, intent(in) :: lets_go
    logical :: yes
    integer :: axis, side
    yes = .false.
    if (.not. allocated(scene%bodies(b)%shapes)) return
    if (size(scene%bodies(b)%shapes) == 0) return  ! particles of a file
    do axis = 1, model%mesh%ndim
      do side = 1, 2
        if (.not. approaches(scene, b, axis, side)) cycle
        if (lets_go) then
          yes = yes .or. model%mesh%one_sided(side, axis)
        else if (holds(model%mesh, axis, side)) then
          yes = yes .or. gap_of(scene, model%mesh, b, axis, side) > touching
        end if
      end do
    end do
  end function near_walls_flown_at

  !> How a sentence about a body and a wall begins.
  function begins(model, b, axis, side) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b, axis, side
    character(:), allocatable :: text
    text = "body '"//trim(model%bodies(b)%name)//"' moves towards wall "// &
           axis_names(axis, model%mesh%space)//merge('-', '+', side == 1)//' and begins'
  end function begins

  !> Whether there is a wall that holds what begins at it.
  pure logical function holds(mesh, axis, side) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, side
    yes = any(mesh%wall(side, axis) == [wall_slip, wall_fixed])
  end function holds

  !> Whether a body flies towards a side of the grid as a whole.
  pure function approaches(scene, b, axis, side) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, axis, side
    logical :: yes
    yes = .false.
    associate (start => scene%bodies(b)%velocity(axis))
      if (start%is_constant) yes = start%value*merge(-1.0_dp, 1.0_dp, side == 1) > 0.0_dp
    end associate
  end function approaches

  !> Cells between the shapes of a body and a wall.
  pure function gap_of(scene, mesh, b, axis, side) result(gap)
    type(scene_t), intent(in) :: scene
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: b, axis, side
    real(dp) :: gap
    real(dp) :: lower(3), upper(3), wall
    associate (card => scene%bodies(b))
      call shapes_box(card%shapes, lower, upper)
      if (mesh%ndim > 1) call turn_box(card%turn, lower, upper)
    end associate
    wall = mesh_place(mesh, axis, real(merge(mesh%lower(axis), mesh%upper(axis), side == 1), dp))
    gap = merge(lower(axis) - wall, wall - upper(axis), side == 1)/mesh%h
  end function gap_of

end module sgmp_near_walls
