!> What `--check` says of a grid with unequal cells (doc/grids.md): cells along each axis, where the
!! smallest are, and how large particles are in the cells in which they begin.
module sgmp_graded_estimate
  use sgmp_body, only: body_t
  use sgmp_graded_axis, only: graded_axis_t, graded_spacing, graded_width
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_occupied, mesh_place, mesh_t
  use sgmp_space, only: axis_names
  use sgmp_spelling, only: string_t
  use sgmp_text, only: integer_text, real_text_about, real_text_tidy
  implicit none
  private
  public :: graded_estimate_lines

contains

  !> Lines for the terminal; none where cells are equal.
  function graded_estimate_lines(mesh, bodies) result(lines)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    type(string_t), allocatable :: lines(:)
    integer :: axis, b
    allocate (lines(0))
    if (.not. mesh%graded) return
    do axis = 1, mesh%ndim
      lines = [lines, string_t('  '//trim(axis_names(axis, mesh%space))//'         '// &
                               graded_axis_line(mesh, axis))]
    end do
    lines = [lines, string_t('  step      from the smallest side, '//real_text_tidy(mesh%h)// &
                             ', in all cells')]
    do b = 1, size(bodies)
      lines = [lines, string_t('  '//particles_line(mesh, bodies(b)))]
    end do
  end function graded_estimate_lines

  !> Cells along an axis: how many, how large, where the smallest are.
  function graded_axis_line(mesh, axis) result(text)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    character(:), allocatable :: text
    real(dp), allocatable :: sides(:)
    integer :: c, from, equal
    associate (table => mesh%axes(axis))
      if (.not. table%graded) then
        text = 'equal cells of '//real_text_tidy(mesh%h)
        return
      end if
      sides = [(graded_width(table, c), c=table%first, table%last - 1)]
      equal = nint((mesh_place(mesh, axis, real(table%last, dp)) - &
                    mesh_place(mesh, axis, real(table%first, dp)))/mesh%h)
      text = integer_text(size(sides))//' cells of '//side_text(mesh, minval(sides))//' to '// &
             side_text(mesh, maxval(sides))//' from '// &
             real_text_about(mesh_place(mesh, axis, real(table%first, dp)))//' to '// &
             real_text_about(mesh_place(mesh, axis, real(table%last, dp)))//', where '// &
             integer_text(equal)//' equal ones would be; smallest at '
      from = 0
      do c = 1, size(sides) + 1
        if (smallest(table, table%first + c - 1)) then
          if (from == 0) from = c
        else if (from > 0) then
          text = text//interval(mesh, axis, table%first + from - 1, table%first + c - 1)//', '
          from = 0
        end if
      end do
      text = text(:len(text) - 2)
    end associate
  end function graded_axis_line

  !> Whether a cell is one of the smallest: the spacing on one side of it, at least, is.
  pure function smallest(table, c) result(yes)
    type(graded_axis_t), intent(in) :: table
    integer, intent(in) :: c
    logical :: yes
    yes = c < table%last .and. &
          min(graded_spacing(table, c), graded_spacing(table, c + 1)) <= 1.0_dp + 1.0e-6_dp
  end function smallest

  !> A length given in smallest cells.
  function side_text(mesh, side) result(text)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: side
    character(:), allocatable :: text
    text = real_text_about(side*mesh%h)
  end function side_text

  !> From one node of an axis to another.
  function interval(mesh, axis, low, high) result(text)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, low, high
    character(:), allocatable :: text
    text = '('//real_text_about(mesh_place(mesh, axis, real(low, dp)))//','// &
           real_text_about(mesh_place(mesh, axis, real(high, dp)))//')'
  end function interval

  !> The largest particle of a body in the cell in which it begins, and in the smallest.
  function particles_line(mesh, body) result(text)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    character(:), allocatable :: text
    real(dp) :: here, largest, volume
    integer :: c, l, n
    n = mesh%ndim
    here = 0.0_dp
    largest = 0.0_dp
    do c = 1, body%particles%chunks
      do l = 1, lanes
        if (body%particles%id(l, c) == 0) cycle
        volume = body%particles%state(l, body%law%slots%volume, c)
        here = max(here, mesh_occupied(mesh, body%particles%motion(l, :n, c), volume))
        largest = max(largest, volume)
      end do
    end do
    text = "particles of '"//trim(body%name)//"' are as wide as "// &
           real_text_about(here**(1.0_dp/n))//' of their cells at most, and the largest as '// &
           real_text_about((largest/mesh%h**n)**(1.0_dp/n))//' of the smallest cell'
  end function particles_line

end module sgmp_graded_estimate
