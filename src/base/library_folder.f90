!> Where decks and materials that come with the program lie: folders that the user names, those of
!! an installed program, the sources of a program in its build folder.
module sgmp_library_folder
  use sgmp_posix, only: file_names, program_path
  use sgmp_spelling, only: string_t
  implicit none
  private
  public :: library_file, library_folders, library_names, library_places

  character(*), parameter :: variable = 'SGMP_PATH'  !! folders of the user, separated by colons

contains

  !> Path of a file in the first folder that has it, '' where none has.
  function library_file(name) result(path)
    character(*), intent(in) :: name  !! relative, e.g. materials/copper.inp
    character(:), allocatable :: path
    type(string_t), allocatable :: folders(:)
    logical :: exists
    integer :: i
    call library_folders(folders)
    do i = 1, size(folders)
      path = folders(i)%text//'/'//name
      inquire (file=path, exist=exists)
      if (exists) return
    end do
    path = ''
  end function library_file

  !> The folders in the order in which they are searched.
  subroutine library_folders(folders)
    type(string_t), allocatable, intent(out) :: folders(:)
    character(:), allocatable :: above, named
    type(string_t) :: next
    integer :: first, colon, length
    allocate (folders(0))
    call get_environment_variable(variable, length=length)
    allocate (character(length) :: named)
    if (length > 0) call get_environment_variable(variable, named)
    first = 1
    do while (first <= length)
      colon = index(named(first:)//':', ':') + first - 1
      next%text = named(first:colon - 1)
      if (colon > first) folders = [folders, next]
      first = colon + 1
    end do
    above = folder_of(folder_of(program_path()))
    next%text = above//'/share/sgmp/input'
    folders = [folders, next]
    next%text = folder_of(above)//'/input'
    folders = [folders, next]
  end subroutine library_folders

  !> The folder that a path lies in.
  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder
    folder = path(:max(index(path, '/', back=.true.) - 1, 0))
  end function folder_of

  !> Names of the decks (*.inp, without the suffix) of a folder of the library, sorted, each once.
  subroutine library_names(folder, names)
    character(*), intent(in) :: folder  !! e.g. materials
    type(string_t), allocatable, intent(out) :: names(:)
    type(string_t), allocatable :: folders(:), own(:)
    integer :: i, k
    call library_folders(folders)
    allocate (names(0))
    do i = 1, size(folders)
      call file_names(folders(i)%text//'/'//folder, '.inp', own)
      do k = 1, size(own)
        call insert(own(k), names)
      end do
    end do
  end subroutine library_names

  !> Puts a name at its place in sorted names, unless it is there.
  pure subroutine insert(name, names)
    type(string_t), intent(in) :: name
    type(string_t), allocatable, intent(inout) :: names(:)
    integer :: i
    do i = 1, size(names)
      if (names(i)%text == name%text) return
      if (lgt(names(i)%text, name%text)) exit
    end do
    names = [names(:i - 1), name, names(i:)]
  end subroutine insert

  !> The folders as a message names them.
  function library_places() result(text)
    character(:), allocatable :: text
    type(string_t), allocatable :: folders(:)
    integer :: i
    call library_folders(folders)
    text = ''
    do i = 1, size(folders)
      if (i > 1) text = text//', '
      text = text//folders(i)%text
    end do
  end function library_places

end module sgmp_library_folder
