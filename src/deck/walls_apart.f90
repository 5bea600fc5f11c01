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
  public :: walls_apart_from_rubbing, walls_apart_lines, walls_apart_settle

  !> What becomes of a wall.
  integer, parameter :: stays = 0, lets_go = 1, moves_out = 2

  real(dp), parameter :: touching = 0.02_dp    !! cells within which a body touches a wall
  real(dp), parameter :: apart = 0.25_dp       !! cells; half a particle and a cell are reached
  real(dp), parameter :: fast = 0.1_dp         !! of the speed of sound: walls are entered too far

contains

  !> Lets walls go, or puts them farther out.
  subroutine walls_apart_settle(scene)
    type(scene_t), intent(inout) :: scene
    integer :: axis, side
    logical :: slow
    slow = slow_solids(scene)
    do axis = 1, scene%dimension
      do side = 1, 2
        select case (fate_of(scene, slow, axis, side))
        case (lets_go)
          call let_go(scene, axis, side)
        case (moves_out)
          call put_out(scene%grid, axis, side)
        case default  ! it stays
          cycle
        end select
      end do
    end do
  end subroutine walls_apart_settle

  !> Whether walls with friction will all let go, so that none of them holds what touches it.
  function walls_apart_from_rubbing(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: axis, side
    logical :: slow
    slow = slow_solids(scene)
    yes = .true.
    do axis = 1, scene%dimension
      do side = 1, 2
        if (.not. features_friction(scene%features, side, axis) > 0.0_dp) cycle
        yes = yes .and. fate_of(scene, slow, axis, side) == lets_go
      end do
    end do
  end function walls_apart_from_rubbing

  !> What becomes of a wall: it lets go if it rests, and where things slide along it if they do not
  !! turn about the axis.
  function fate_of(scene, slow, axis, side) result(fate)
    type(scene_t), intent(in) :: scene
    logical, intent(in) :: slow                  !! all that deform are slow solids
    integer, intent(in) :: axis, side
    integer :: fate
    real(dp) :: gap
    logical :: rests, rough
    fate = stays
    if (.not. (slow .and. may_go(scene, axis, side))) return
    associate (grid => scene%grid)
      associate (velocity => grid%wall_velocity(:, side, axis))
        rests = all(velocity%is_constant .and. abs(velocity%value) <= 0.0_dp)
      end associate
      rough = grid%wall(side, axis) == wall_fixed .or. &
              features_friction(scene%features, side, axis) > 0.0_dp
    end associate
    gap = least_gap(scene, axis, side)
    if (rests .and. .not. (scene_turns(scene) .and. rough)) then
      if (gap > touching .or. is_floor(scene, axis, side)) fate = lets_go
    else if (gap > apart) then
      fate = moves_out
    end if
  end function fate_of

  !> Whether there is a wall that may go, where cells are equal; the axis of rings is none.
  pure logical function may_go(scene, axis, side) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis, side
    associate (grid => scene%grid)
      yes = grid%shifts .and. .not. grid%axes(axis)%graded .and. &
            any(grid%wall(side, axis) == [wall_slip, wall_fixed]) .and. &
            .not. (scene%axisymmetric .and. axis == 1 .and. side == 1)
    end associate
  end function may_go

  !> Lets a wall go: an open face, beyond which springs push.
  subroutine let_go(scene, axis, side)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: axis, side
    associate (grid => scene%grid)
      grid%one_sided(side, axis) = .true.
      grid%rough(side, axis) = features_friction(scene%features, side, axis)
      if (grid%wall(side, axis) == wall_fixed) grid%rough(side, axis) = huge(1.0_dp)
      grid%floor(side, axis) = least_gap(scene, axis, side) <= touching
      if (grid%floor(side, axis)) then
        grid%floor_bears(side, axis) = floor_pressure(scene, axis, side)
      end if
      grid%wall(side, axis) = wall_free
      grid%open(side, axis) = .true.
      call features_release(scene%features, side, axis)
    end associate
  end subroutine let_go

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
            lines(n)%text = wall//' is a floor and lets go: it has friction, or gravity pulls '// &
                            'to it (doc/loads.md)'
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
