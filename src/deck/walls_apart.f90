!> Walls of the grid that nothing touches at the start (doc/loads.md, Walls that are hit).
!!
!! A wall is a plane of symmetry. What flies at one shares nodes with its image from a cell away and
!! comes to rest there, a cell early, if it is slow; at a tenth of its speed of sound half a cell.
!! So such a wall is put a cell farther out: what is slow then rests where the deck has the wall.
module sgmp_walls_apart
  use sgmp_constitutive, only: law_is_spherical, law_sound
  use sgmp_fast_scenes, only: largest_speed_of
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_fixed, wall_slip
  use sgmp_scene, only: grid_card_t, scene_space, scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_space, only: axis_names
  use sgmp_spelling, only: string_t
  use sgmp_text, only: real_text_tidy
  use sgmp_turn, only: turn_box
  implicit none
  private
  public :: walls_apart_lines, walls_apart_settle

  real(dp), parameter :: apart = 0.25_dp       !! cells; half a particle and a cell are reached
  real(dp), parameter :: fast = 0.1_dp         !! of the speed of sound: as much too late as early

contains

  !> Puts the walls farther out that all bodies are away from.
  subroutine walls_apart_settle(scene)
    type(scene_t), intent(inout) :: scene
    integer :: axis, side
    if (.not. scene%grid%shifts .or. .not. slow_solids(scene)) return
    do axis = 1, scene%dimension
      if (scene%grid%axes(axis)%graded) cycle
      do side = 1, 2
        if (.not. any(scene%grid%wall(side, axis) == [wall_slip, wall_fixed])) cycle
        if (scene%axisymmetric .and. axis == 1 .and. side == 1) cycle
        if (.not. all_apart(scene, axis, side)) cycle
        scene%grid%shifted(side, axis) = .true.
        if (side == 1) then
          scene%grid%lower(axis) = scene%grid%lower(axis) - scene%grid%cell
        else
          scene%grid%upper(axis) = scene%grid%upper(axis) + scene%grid%cell
        end if
      end do
    end do
  end subroutine walls_apart_settle

  !> Whether all that deforms are solids, and none begins fast.
  function slow_solids(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    real(dp) :: speed
    integer :: b
    speed = largest_speed_of(scene)
    yes = size(scene%bodies) > 0
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%rigid) cycle
      yes = yes .and. scene%bodies(b)%material > 0
      if (.not. yes) return
      associate (law => scene%materials(scene%bodies(b)%material)%law)
        yes = .not. law_is_spherical(law) .and. speed <= fast*law_sound(law)
      end associate
    end do
  end function slow_solids

  !> Whether all bodies begin away from a wall.
  pure function all_apart(scene, axis, side) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis, side
    logical :: yes
    real(dp) :: lower(3), upper(3), gap
    integer :: b
    yes = .true.
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b), grid => scene%grid)
        yes = yes .and. size(body%shapes) > 0      ! where a file puts particles is not known here
        if (.not. yes) return
        call shapes_box(body%shapes, lower, upper)
        if (scene%dimension > 1) call turn_box(body%turn, lower, upper)
        gap = merge(lower(axis) - grid%lower(axis), grid%upper(axis) - upper(axis), side == 1)
        yes = gap > apart*grid%cell
      end associate
    end do
  end function all_apart

  !> A line for each wall that has been put farther out.
  pure function walls_apart_lines(scene) result(lines)
    type(scene_t), intent(in) :: scene
    type(string_t), allocatable :: lines(:)
    real(dp) :: place
    integer :: axis, side, n
    allocate (lines(count(scene%grid%shifted)))
    n = 0
    do axis = 1, scene%dimension
      do side = 1, 2
        if (.not. scene%grid%shifted(side, axis)) cycle
        place = wall_asked(scene%grid, axis, side)
        n = n + 1
        lines(n)%text = 'wall '//axis_names(axis, scene_space(scene))// &
                        merge('-', '+', side == 1)//' is a cell outside of '// &
                        real_text_tidy(place)//': nothing touches it at the start, and what '// &
                        'flies at a wall rests a cell before it (doc/loads.md)'
      end do
    end do
  end function walls_apart_lines

  !> Where the deck has a wall.
  pure real(dp) function wall_asked(grid, axis, side) result(place)
    type(grid_card_t), intent(in) :: grid
    integer, intent(in) :: axis, side
    place = merge(grid%lower(axis) + grid%cell, grid%upper(axis) - grid%cell, side == 1)
  end function wall_asked

end module sgmp_walls_apart
