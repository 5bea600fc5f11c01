!> Walls of the grid that are no planes of symmetry (doc/loads.md, Bodies near walls).
!!
!! A wall is a plane of symmetry: what flies at one shares nodes with its image from a cell away,
!! comes to rest there, a cell early if it is slow, and is held where it would leave. So a wall that
!! nothing touches lets go (sgmp_one_sided), and so does a floor: one with friction, or to which
!! gravity pulls, is no plane of symmetry whatever rests on it. A wall that moves is put a cell
!! farther out: what is slow then rests where the deck has the wall.
module sgmp_walls_apart
  use sgmp_constitutive, only: law_bends, law_is_spherical, law_wave_modulus
  use sgmp_fast_scenes, only: largest_speed_of
  use sgmp_features, only: features_friction, features_release
  use sgmp_floor_pressure, only: floor_pressure
  use sgmp_kernels, only: method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_fixed, wall_free, wall_slip
  use sgmp_scene, only: body_card_t, grid_card_t, scene_space, scene_t, scene_turns
  use sgmp_shapes, only: combine_difference, shape_cylinder, shape_ring, shape_sphere, shape_t, &
                         shapes_box
  use sgmp_space, only: axis_names
  use sgmp_spelling, only: string_t
  use sgmp_text, only: real_text_tidy
  use sgmp_turn, only: turn_box
  use sgmp_update, only: update_musl, update_usavg
  implicit none
  private
  public :: walls_apart_lines, walls_apart_settle

  real(dp), parameter :: touching = 0.02_dp    !! cells within which a body touches a wall
  real(dp), parameter :: apart = 0.25_dp       !! cells; half a particle and a cell are reached
  real(dp), parameter :: fast = 0.1_dp         !! of the speed of sound: walls are entered too far

contains

  !> Lets the walls go that all bodies are away from, or puts them farther out.
  subroutine walls_apart_settle(scene)
    type(scene_t), intent(inout) :: scene
    integer :: axis, side
    if (.not. scene%grid%shifts .or. .not. slow_solids(scene)) return
    do axis = 1, scene%dimension
      if (scene%grid%axes(axis)%graded) cycle
      do side = 1, 2
        if (scene%axisymmetric .and. axis == 1 .and. side == 1) cycle
        call settle_wall(scene, axis, side, least_gap(scene, axis, side))
      end do
    end do
  end subroutine walls_apart_settle

  !> The same of one wall, if there is one: it lets go if it rests, and where things slide along it
  !! if they do not turn about the axis.
  subroutine settle_wall(scene, axis, side, gap)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: axis, side
    real(dp), intent(in) :: gap                  !! to the nearest body (cells)
    real(dp) :: friction
    logical :: rests, touched
    friction = features_friction(scene%features, side, axis)
    associate (grid => scene%grid)
      if (.not. any(grid%wall(side, axis) == [wall_slip, wall_fixed])) return
      if (grid%wall(side, axis) == wall_fixed) friction = huge(1.0_dp)
      associate (velocity => grid%wall_velocity(:, side, axis))
        rests = all(velocity%is_constant .and. abs(velocity%value) <= 0.0_dp)
      end associate
      if (rests .and. .not. (scene_turns(scene) .and. friction > 0.0_dp)) then
        touched = gap <= touching
        if (touched .and. .not. is_floor(scene, axis, side)) return
        grid%one_sided(side, axis) = .true.
        grid%floor(side, axis) = touched
        if (touched) grid%floor_bears(side, axis) = floor_pressure(scene, axis, side)
        grid%rough(side, axis) = friction
        grid%wall(side, axis) = wall_free
        grid%open(side, axis) = .true.
        call features_release(scene%features, side, axis)
      else if (gap > apart) then
        call put_out(grid, axis, side)
      end if
    end associate
  end subroutine settle_wall

  !> Whether what touches a wall stands on it or rubs on it: solids that bear tension, so that a
  !! plane of symmetry would hold them where they leave. The faces of particles follow their places
  !! and their strains: where these come from velocities of different instants, as with other
  !! methods and updates, what stays on springs gains or loses energy.
  pure function is_floor(scene, axis, side) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis, side
    logical :: yes
    integer :: b
    yes = scene%method%kind == method_sgmp .and. &
          any(scene%method%update == [update_musl, update_usavg]) .and. &
          scene%grid%wall(side, axis) == wall_slip .and. &
          (features_friction(scene%features, side, axis) > 0.0_dp .or. &
           scene%gravity(axis)*merge(-1.0_dp, 1.0_dp, side == 1) > 0.0_dp)
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        if (body%rigid .or. .not. yes) cycle
        if (gap_of(scene, body, axis, side) > touching) cycle
        yes = law_bends(scene%materials(body%material)%law)
      end associate
    end do
  end function is_floor

  !> Puts a wall a cell farther out.
  pure subroutine put_out(grid, axis, side)
    type(grid_card_t), intent(inout) :: grid
    integer, intent(in) :: axis, side
    grid%shifted(side, axis) = .true.
    if (side == 1) then
      grid%lower(axis) = grid%lower(axis) - grid%cell
    else
      grid%upper(axis) = grid%upper(axis) + grid%cell
    end if
  end subroutine put_out

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
        yes = .not. law_is_spherical(law) .and. &
              speed <= fast*sqrt(law_wave_modulus(law)/law%density)
      end associate
    end do
  end function slow_solids

  !> Cells between a wall and the body that begins closest to it. What is round and touches it in a
  !! point is no part of a symmetric body: it does not count.
  pure function least_gap(scene, axis, side) result(gap)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis, side
    real(dp) :: gap
    real(dp) :: own
    integer :: b
    gap = huge(1.0_dp)
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        own = gap_of(scene, body, axis, side)
        if (abs(own) <= touching .and. size(body%shapes) > 0 .and. &
            all(round_towards(body%shapes, axis, scene%axisymmetric))) cycle
        gap = min(gap, own)
      end associate
    end do
  end function least_gap

  !> Cells between a wall and a body; 0 where its particles come from a file, whose places are not
  !! known here.
  pure function gap_of(scene, body, axis, side) result(gap)
    type(scene_t), intent(in) :: scene
    type(body_card_t), intent(in) :: body
    integer, intent(in) :: axis, side
    real(dp) :: gap
    real(dp) :: lower(3), upper(3)
    gap = 0.0_dp
    if (size(body%shapes) == 0) return
    call shapes_box(body%shapes, lower, upper)
    if (scene%dimension > 1) call turn_box(body%turn, lower, upper)
    associate (grid => scene%grid)
      gap = merge(lower(axis) - grid%lower(axis), grid%upper(axis) - upper(axis), side == 1)/ &
            grid%cell
    end associate
  end function gap_of

  !> Whether a shape is round where a wall across an axis touches it; cylinders about the axis of
  !! the scene are not.
  elemental function round_towards(shape, axis, axisymmetric) result(yes)
    type(shape_t), intent(in) :: shape
    integer, intent(in) :: axis
    logical, intent(in) :: axisymmetric
    logical :: yes
    yes = shape%kind == shape_sphere .or. shape%combine == combine_difference
    if (axisymmetric) return
    if (any(shape%kind == [shape_cylinder, shape_ring])) yes = abs(shape%axis(axis)) <= touching
  end function round_towards

  !> A line for each wall that lets go or has been put farther out.
  pure function walls_apart_lines(scene) result(lines)
    type(scene_t), intent(in) :: scene
    type(string_t), allocatable :: lines(:)
    character(:), allocatable :: wall
    integer :: axis, side, n
    allocate (lines(count(scene%grid%one_sided .or. scene%grid%shifted)))
    n = 0
    do axis = 1, scene%dimension
      do side = 1, 2
        wall = 'wall '//axis_names(axis, scene_space(scene))//merge('-', '+', side == 1)
        if (scene%grid%one_sided(side, axis)) then
          n = n + 1
          if (scene%grid%floor(side, axis)) then
            lines(n)%text = wall//' is a floor and lets go: it has friction, or gravity pulls to '// &
                            'it (doc/loads.md)'
          else
            lines(n)%text = wall//' lets go: nothing touches it at the start (doc/loads.md)'
          end if
        else if (scene%grid%shifted(side, axis)) then
          n = n + 1
          lines(n)%text = wall//' is a cell outside of '// &
                          real_text_tidy(wall_asked(scene%grid, axis, side))//': nothing '// &
                          'touches it at the start, and what flies at a wall rests a cell '// &
                          'before it (doc/loads.md)'
        end if
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
