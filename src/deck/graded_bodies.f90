!> Particles of bodies on a grid with unequal cells (doc/grids.md).
!!
!! A body at rest gets as many particles between two centres everywhere. One that moves may come
!! where cells are small: its particles are as small as those there need them, all over. So are
!! those of a turned body, whose surfaces a lattice along the axes would make steps of.
module sgmp_graded_bodies
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  use sgmp_scene, only: body_card_t, grid_card_t, layout_gauss, layout_graded, &
                        layout_lattice
  use sgmp_turn, only: turn_turns
  implicit none
  private
  public :: graded_bodies_settle

contains

  !> Layout of all bodies whose cards leave it to the program, and what they must know of the grid.
  pure subroutine graded_bodies_settle(grid, bodies)
    type(grid_card_t), intent(in) :: grid
    type(body_card_t), intent(inout) :: bodies(:)
    integer :: b
    if (.not. any(grid%axes%graded)) then
      where (bodies%layout == layout_graded) bodies%layout = layout_lattice
      return
    end if
    do b = 1, size(bodies)
      associate (body => bodies(b))
        if (body%layout == layout_lattice .and. rests(body)) body%layout = layout_graded
        if (all(body%layout /= [layout_gauss, layout_graded])) cycle
        body%axes = grid%axes
        body%cell = grid%cell
      end associate
    end do
  end subroutine graded_bodies_settle

  !> Whether a body begins at rest, and its card does not say where its particles are.
  pure function rests(body) result(yes)
    type(body_card_t), intent(in) :: body
    logical :: yes
    yes = .not. (body%layout_asked .or. body%rigid .or. any(abs(body%spin_at_start) > 0.0_dp) .or. &
                 turn_turns(body%turn))
    yes = yes .and. zero(body%velocity)
  end function rests

  !> Whether functions are zero everywhere.
  pure function zero(functions) result(yes)
    type(expression_t), intent(in) :: functions(:)
    logical :: yes
    yes = all(functions%is_constant) .and. all(abs(functions%value) <= 0.0_dp)
  end function zero

end module sgmp_graded_bodies
