!> Import of MPM3D decks: text -> words -> entries -> particles -> bodies and cards -> files.
module sgmp_import_mpm3d
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_errors, only: error_make, error_t, exit_io
  use sgmp_file_tools, only: directory_make, file_exists, file_lines, line_t, output_file_t
  use sgmp_import_notes, only: import_notes_t, note_approximated, note_honoured
  use sgmp_kinds, only: dp
  use sgmp_mpm3d_bodies, only: piece_file, piece_t, pieces_make
  use sgmp_mpm3d_deck, only: mpm3d_deck_t, mpm3d_read
  use sgmp_mpm3d_native, only: native_write, particle_file_name
  use sgmp_mpm3d_particles, only: cloud_t, clouds_make
  use sgmp_mpm3d_space, only: space_make, space_t
  use sgmp_mpm3d_words, only: mpm3d_words_t
  use sgmp_native_deck, only: native_deck_t
  use sgmp_text, only: integer_text, real_text_tidy
  implicit none
  private
  public :: imported_t, import_is_mpm3d, import_locate, import_path, import_place, import_read, &
            import_summary, import_write

  character(*), parameter :: suffix = '.mpm'

  !> A deck that has been imported and not yet written.
  type :: imported_t
    character(:), allocatable :: source   !! path of the deck it comes from
    character(:), allocatable :: stem     !! of the names of all files
    type(native_deck_t) :: native
    type(piece_t), allocatable :: pieces(:)
    type(import_notes_t) :: notes
    type(line_t), allocatable :: lines(:)  !! of the deck that it comes from
  end type imported_t

contains

  !> Whether a path is that of an MPM3D deck.
  pure function import_is_mpm3d(path) result(yes)
    character(*), intent(in) :: path
    logical :: yes
    yes = len(path) > len(suffix)
    if (yes) yes = path(len(path) - len(suffix) + 1:) == suffix
  end function import_is_mpm3d

  !> Reads an MPM3D deck and makes a native deck of it, in memory. Where `errors%count()` is
  !! positive there is none.
  subroutine import_read(path, keep_3d, imported, errors, error)
    character(*), intent(in) :: path
    logical, intent(in) :: keep_3d               !! leaves out no direction
    type(imported_t), intent(out) :: imported
    type(deck_errors_t), intent(out) :: errors
    type(error_t), allocatable, intent(out) :: error  !! the file cannot be read
    type(mpm3d_words_t) :: words
    type(mpm3d_deck_t) :: deck
    type(cloud_t), allocatable :: clouds(:)
    type(space_t) :: space
    imported%source = path
    imported%stem = stem_of(path)
    words%file = path
    call file_lines(path, words%lines, error)
    if (allocated(error)) return
    call mpm3d_read(words, deck)
    if (.not. words%failed) call clouds_make(deck, words, clouds)
    if (.not. words%failed) call space_make(deck, clouds, keep_3d, words, space, imported%notes)
    if (.not. words%failed) call pieces_make(deck, clouds, space, words, imported%pieces, &
                                             imported%notes)
    if (.not. words%failed) then
      call imported%native%add('! '//imported%stem//suffix//', a deck of MPM3D, as sgmp import '// &
                               'makes it; '//imported%stem//'.import.txt says what became of '// &
                               'each keyword.')
      call native_write(deck, clouds, space, imported%pieces, imported%stem, words, &
                        imported%native, imported%notes)
    end if
    errors = words%errors
    call move_alloc(words%lines, imported%lines)
  end subroutine import_read

  !> Errors of the native deck at the places of the deck that it comes from.
  subroutine import_place(imported, native, found, errors)
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: native          !! path of the native deck
    type(deck_errors_t), intent(in) :: found    !! in it
    type(deck_errors_t), intent(out) :: errors
    type(position_t) :: place
    integer :: i
    if (.not. allocated(found%entries)) return
    do i = 1, size(found%entries)
      associate (entry => found%entries(i))
        if (entry%warning) cycle
        place = entry%position
        if (place%file == native) place = origin_of(imported, place%line)
        call errors%add(place, entry%message//' ('//entry%position%text()//': '// &
                        trim(adjustl(source_of(entry%position)))//')', entry%remedy)
      end associate
    end do
  end subroutine import_place

  !> The same for an error that names its place in a text.
  subroutine import_locate(imported, native, error)
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: native          !! path of the native deck
    type(error_t), allocatable, intent(inout) :: error
    type(position_t) :: place
    integer :: line, colon, status
    if (.not. allocated(error)) return
    if (index(error%location, native//':') /= 1) return
    associate (numbers => error%location(len(native) + 2:))
      colon = index(numbers//':', ':')
      read (numbers(:colon - 1), *, iostat=status) line
    end associate
    if (status /= 0) return
    place = origin_of(imported, line)
    error%message = error%message//' ('//error%location//')'
    error%location = place%text()
  end subroutine import_locate

  !> The place that a line of the native deck comes from.
  function origin_of(imported, line) result(place)
    type(imported_t), intent(in) :: imported
    integer, intent(in) :: line
    type(position_t) :: place
    place%file = imported%source
    if (line < 1 .or. line > size(imported%native%origin, 2)) return
    place%line = imported%native%origin(1, line)
    place%column = imported%native%origin(2, line)
    if (place%line > 0) place%source = imported%lines(place%line)%text
  end function origin_of

  !> The line of a place, '' where it has none.
  pure function source_of(place) result(text)
    type(position_t), intent(in) :: place
    character(:), allocatable :: text
    text = ''
    if (allocated(place%source)) text = place%source
  end function source_of

  !> Name of a file without folders and suffix.
  pure function stem_of(path) result(stem)
    character(*), intent(in) :: path
    character(:), allocatable :: stem
    integer :: dot
    stem = path(index(path, '/', back=.true.) + 1:)
    dot = index(stem, '.', back=.true.)
    if (dot > 1) stem = stem(:dot - 1)
  end function stem_of

  !> Path of the native deck in a folder.
  pure function import_path(imported, folder) result(path)
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: folder  !! '' for the current one
    character(:), allocatable :: path
    path = imported%stem//'.inp'
    if (folder /= '') path = folder//'/'//path
  end function import_path

  !> Writes deck, particle files and report into a folder.
  subroutine import_write(imported, folder, replace, error)
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: folder             !! '' for the current one
    logical, intent(in) :: replace                 !! files that are there already
    type(error_t), allocatable, intent(out) :: error
    type(output_file_t) :: file
    character(:), allocatable :: place, native
    integer :: i
    place = ''
    if (folder /= '') then
      place = folder//'/'
      call directory_make(folder, error)
      if (allocated(error)) return
    end if
    native = import_path(imported, folder)
    if (.not. replace .and. file_exists(native)) then
      call error_make(error, exit_io, "there is a file '"//native//"' already", &
                      'remove it, or choose a folder with --output')
      return
    end if
    do i = 1, size(imported%pieces)
      if (imported%pieces(i)%shape /= piece_file) cycle
      call write_particles(imported, i, place, error)
      if (allocated(error)) return
    end do
    call file%open(place//imported%stem//'.import.txt', 'replace', error)
    if (allocated(error)) return
    call imported%notes%write(imported%source, native, file)
    call file%close(error)
    if (allocated(error)) return
    call file%open(native, 'replace', error)
    if (allocated(error)) return
    do i = 1, size(imported%native%lines)
      call file%line(imported%native%lines(i)%text)
    end do
    call file%close(error)
  end subroutine import_write

  !> Writes the particles of one body; velocities only where something moves.
  subroutine write_particles(imported, number, place, error)
    type(imported_t), intent(in) :: imported
    integer, intent(in) :: number
    character(*), intent(in) :: place
    type(error_t), allocatable, intent(out) :: error
    type(output_file_t) :: file
    character(:), allocatable :: line
    integer :: p, k, columns
    associate (piece => imported%pieces(number))
      call file%open(place//particle_file_name(imported%stem, piece), 'replace', error)
      if (allocated(error)) return
      columns = merge(7, 4, any(abs(piece%rows(5:, :)) > 0.0_dp))
      line = '! '//imported%stem//suffix//', '//piece%name//': x y z volume'
      if (columns == 7) line = line//' velocity_x velocity_y velocity_z'
      call file%line(line)
      do p = 1, size(piece%rows, 2)
        line = real_text_tidy(piece%rows(1, p))
        do k = 2, columns
          line = line//' '//real_text_tidy(piece%rows(k, p))
        end do
        call file%line(line)
      end do
    end associate
    call file%close(error)
  end subroutine write_particles

  !> One line for the terminal.
  function import_summary(imported, native) result(text)
    type(imported_t), intent(in) :: imported
    character(*), intent(in) :: native  !! path of the deck
    character(:), allocatable :: text
    text = imported%source//' is '//native//' here: '// &
           integer_text(imported%notes%count(note_honoured))//' entries honoured, '// &
           integer_text(imported%notes%count(note_approximated))//' approximated, see '// &
           native(:len(native) - 4)//'.import.txt'
  end function import_summary

end module sgmp_import_mpm3d
