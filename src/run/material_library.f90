!> The command `sgmp materials`: what the library has, and one entry as it stands in its file.
module sgmp_material_library
  use sgmp_absent_materials, only: absent_reason
  use sgmp_errors, only: error_make, error_t, exit_io, exit_usage
  use sgmp_file_tools, only: file_lines, line_t
  use sgmp_library_folder, only: library_file, library_names, library_places
  use sgmp_spelling, only: string_t, suggestion
  implicit none
  private
  public :: material_list, material_show

  character(*), parameter :: folder = 'materials'

contains

  !> Writes the name and the first line of each entry.
  subroutine material_list(unit, error)
    integer, intent(in) :: unit  !! formatted unit
    type(error_t), allocatable, intent(out) :: error  !! exit_io where there is no library
    type(string_t), allocatable :: names(:)
    type(line_t), allocatable :: lines(:)
    integer :: i
    call library_names(folder, names)
    if (size(names) == 0) then
      call error_make(error, exit_io, 'the library of materials is not found in '// &
                      library_places(), 'name its folder (that of materials/) in SGMP_PATH')
      return
    end if
    write (unit, '(a)') 'usage: include "materials/NAME.inp" in a deck; sgmp materials NAME '// &
      'shows one', '', 'materials:'
    do i = 1, size(names)
      call file_lines(path_of(names(i)%text), lines, error)
      if (allocated(error)) return
      if (size(lines) == 0) cycle
      associate (first => lines(1)%text)
        write (unit, '(2x, a, t24, a)') names(i)%text, trim(adjustl(first(verify(first, '! '):)))
      end associate
    end do
  end subroutine material_list

  !> Writes an entry: its path, then its cards with the source of each constant.
  subroutine material_show(name, unit, error)
    character(*), intent(in) :: name
    integer, intent(in) :: unit  !! formatted unit
    type(error_t), allocatable, intent(out) :: error  !! exit_usage where there is none of this name
    type(line_t), allocatable :: lines(:)
    character(:), allocatable :: path
    integer :: i
    path = path_of(name)
    if (path == '') then
      call error_make(error, exit_usage, "there is no material '"//name//"' in the library", &
                      remedy(name))
      return
    end if
    call file_lines(path, lines, error)
    if (allocated(error)) return
    write (unit, '(a)') '! include "'//folder//'/'//name//'.inp" takes '//path
    do i = 1, size(lines)
      write (unit, '(a)') lines(i)%text
    end do
  end subroutine material_show

  !> What to write instead of an unknown name.
  function remedy(name) result(text)
    character(*), intent(in) :: name
    character(:), allocatable :: text
    type(string_t), allocatable :: names(:)
    text = absent_reason(name)
    if (text /= '') return
    call library_names(folder, names)
    text = 'name the folder of materials/ in SGMP_PATH'
    if (size(names) > 0) text = suggestion(name, names, 'materials')//'; sgmp materials lists them'
  end function remedy

  function path_of(name) result(path)
    character(*), intent(in) :: name
    character(:), allocatable :: path
    path = library_file(folder//'/'//name//'.inp')
  end function path_of

end module sgmp_material_library
