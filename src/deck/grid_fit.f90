!> Extents of the grid and cells that do not divide them: ends without a wall move outwards to the
!! grid; of cells between two walls it is said which would fit.
module sgmp_grid_fit
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_free
  use sgmp_scene, only: grid_card_t, scene_space, scene_t
  use sgmp_space, only: axis_names
  use sgmp_spelling, only: string_t
  use sgmp_text, only: real_text_plain, real_text_tidy
  implicit none
  private
  public :: grid_fit_extend, grid_fit_held, grid_fit_moved, grid_fit_sizes, grid_fit_whole

  real(dp), parameter :: tolerance = 1.0e-6_dp  !! cells, by which an extent may miss the grid
  real(dp), parameter :: most_tried = 1.0e6_dp  !! sizes of cells

contains

  !> Whether a length is a whole number of cells.
  elemental function grid_fit_whole(length, cell) result(yes)
    real(dp), intent(in) :: length, cell
    logical :: yes
    yes = abs(length/cell - anint(length/cell)) <= tolerance .and. length/cell > 0.5_dp
  end function grid_fit_whole

  !> Which ends of an axis must stay where they are: those with a wall, and the axis of symmetry.
  pure function grid_fit_held(grid, axis, axisymmetric) result(held)
    type(grid_card_t), intent(in) :: grid
    integer, intent(in) :: axis
    logical, intent(in) :: axisymmetric
    logical :: held(2)                           !! lower, upper
    held = grid%wall(:, axis) /= wall_free
    held(1) = held(1) .or. (axisymmetric .and. axis == 1)
  end function grid_fit_held

  !> Moves ends that are not held outwards, to the next whole number of cells. Where none is held
  !! the lower end stays, except in an extent from -a to a, which stays symmetric.
  pure subroutine grid_fit_extend(grid, axis, held)
    type(grid_card_t), intent(inout) :: grid
    integer, intent(in) :: axis
    logical, intent(in) :: held(2)               !! lower, upper; not both
    real(dp) :: length, more
    length = grid%upper(axis) - grid%lower(axis)
    more = grid%cell*max(1.0_dp, real(ceiling(length/grid%cell - tolerance), dp)) - length
    if (any(held)) then
      if (held(2)) grid%lower(axis) = grid%lower(axis) - more
      if (held(1)) grid%upper(axis) = grid%upper(axis) + more
    else if (abs(grid%lower(axis) + grid%upper(axis)) <= tolerance*grid%cell) then
      grid%lower(axis) = grid%lower(axis) - 0.5_dp*more
      grid%upper(axis) = grid%upper(axis) + 0.5_dp*more
    else
      grid%upper(axis) = grid%upper(axis) + more
    end if
  end subroutine grid_fit_extend

  !> Cells that divide all lengths: the nearest larger and the nearest smaller one, 0 where there is
  !! none up to about twice and down to half of the wanted size.
  pure function grid_fit_sizes(lengths, cell) result(sizes)
    real(dp), intent(in) :: lengths(:), cell
    real(dp) :: sizes(2)
    real(dp) :: shortest, count
    sizes = 0.0_dp
    shortest = minval(lengths)
    count = aint(shortest/cell)
    do while (count >= 1.0_dp .and. count >= 0.5_dp*shortest/cell - 1.0_dp)
      if (shortest/cell - count > most_tried) exit
      sizes(1) = rounded(shortest/count)
      if (all(grid_fit_whole(lengths, sizes(1)))) exit
      sizes(1) = 0.0_dp
      count = count - 1.0_dp
    end do
    count = aint(shortest/cell) + 1.0_dp
    do while (count <= 2.0_dp*shortest/cell + 1.0_dp)
      if (count - shortest/cell > most_tried) exit
      sizes(2) = rounded(shortest/count)
      if (all(grid_fit_whole(lengths, sizes(2)))) exit
      sizes(2) = 0.0_dp
      count = count + 1.0_dp
    end do
  end function grid_fit_sizes

  !> A number as a deck can have it: twelve digits more than the first.
  pure function rounded(value) result(short)
    real(dp), intent(in) :: value
    real(dp) :: short
    character(40) :: buffer
    write (buffer, '(es40.12e3)') value
    read (buffer, *) short
  end function rounded

  !> A line for each axis of a scene whose ends have moved.
  pure function grid_fit_moved(scene) result(lines)
    type(scene_t), intent(in) :: scene
    type(string_t), allocatable :: lines(:)
    character(1) :: name
    real(dp) :: ends(2)
    integer :: axis, n
    allocate (lines(scene%dimension))
    n = 0
    associate (grid => scene%grid)
      do axis = 1, scene%dimension
        if (any(grid%open(:, axis)) .or. .not. grid%moved(axis)) cycle
        name = axis_names(axis, scene_space(scene))
        n = n + 1
        ends = [grid%lower(axis), grid%upper(axis)] + &
               merge([grid%cell, -grid%cell], 0.0_dp, grid%shifted(:, axis))  ! sgmp_walls_apart
        lines(n)%text = 'grid '//name//'='//real_text_tidy(ends(1))//':'// &
                        real_text_tidy(ends(2))//' in the place of '// &
                        real_text_tidy(grid%asked(1, axis))//':'// &
                        real_text_tidy(grid%asked(2, axis))//': a whole number of cells of '// &
                        real_text_plain(grid%cell)//'; ends without a wall have moved'
      end do
    end associate
    lines = lines(:n)
  end function grid_fit_moved

end module sgmp_grid_fit
