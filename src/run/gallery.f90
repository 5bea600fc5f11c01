!> The decks to begin with: their names, where they lie beside the program, and a copy of one.
module sgmp_gallery
  use sgmp_errors, only: error_make, error_t, exit_io, exit_usage
  use sgmp_file_tools, only: directory_make, file_exists, file_lines, line_t, output_file_t
  use sgmp_library_folder, only: library_file, library_places
  use sgmp_spelling, only: suggestion, word_items, word_position, words_joined
  implicit none
  private
  public :: gallery_copy, gallery_list, gallery_names

  !> A deck of the gallery.
  type :: deck_t
    character(13) :: name
    character(32) :: file   !! in the folder input
    character(96) :: what
  end type deck_t

  type(deck_t), parameter :: decks(*) = [ &
    deck_t('taylor', 'taylor_bar_axisymmetric.inp', &
           'a copper bar hits a wall and mushrooms; axisymmetric, seconds'), &
    deck_t('taylor_3d', 'taylor_bar.inp', 'the same bar in three dimensions'), &
    deck_t('spall', 'gallery/flyer_spall.inp', &
           'a flyer hits a plate, which spalls where release waves meet; 1D'), &
    deck_t('perforation', 'gallery/ball_plate.inp', &
           'a steel ball goes through an aluminium plate; axisymmetric, failure'), &
    deck_t('plate_3d', 'gallery/plate_3d.inp', &
           'a ball goes through a wide plate; a quarter of it in 3D, cells that grow, failure'), &
    deck_t('whipple', 'gallery/whipple.inp', &
           'a ball at 6 km/s, its cloud of debris and a rear wall; axisymmetric, failure'), &
    deck_t('penetration', 'gallery/ogive.inp', &
           'a rod with an ogive nose goes into aluminium; axisymmetric, friction'), &
    deck_t('impact_3d', 'rod_plate.inp', &
           'a steel rod makes a crater in a copper plate; a quarter of it in 3D'), &
    deck_t('oblique', 'gallery/oblique.inp', &
           'a hard core hits a plate at an angle; half of it in 3D, failure, two minutes'), &
    deck_t('concrete', 'gallery/concrete_slab.inp', &
           'a steel ogive goes through a slab of concrete; axisymmetric, damage'), &
    deck_t('folded_tube', 'gallery/folded_tube.inp', &
           'a tube is pressed into folds that touch each other; axisymmetric'), &
    deck_t('detonation', 'tnt_slab.inp', 'a slab of TNT is lit at one end; 1D'), &
    deck_t('cylinder_test', 'gallery/cylinder_test.inp', &
           'TNT drives a copper tube; axisymmetric'), &
    deck_t('blast', 'gallery/blast_wall.inp', &
           'a charge of TNT bursts in air before a wall; axisymmetric'), &
    deck_t('blast_plate', 'gallery/blast_plate.inp', &
           'a clamped plate under a charge, the air is not computed; axisymmetric'), &
    deck_t('underwater', 'gallery/underwater.inp', &
           'a charge of TNT bursts in water; axisymmetric'), &
    deck_t('cushion', 'gallery/cushion.inp', &
           'a head falls onto a cushion of foam; axisymmetric, contact'), &
    deck_t('dam_break', 'gallery/dam_break.inp', 'a column of water collapses in a tank; 2D'), &
    deck_t('slope', 'gallery/slope.inp', 'a slope of soil slides; 2D'), &
    deck_t('collapse', 'gallery/column_collapse.inp', &
           'a column of sand collapses on a rough floor; 2D'), &
    deck_t('rings', 'rings.inp', 'two rubber rings collide and bounce; 2D contact')]

contains

  !> Names of all decks, separated by blanks.
  pure function gallery_names() result(names)
    character(:), allocatable :: names
    names = words_joined(decks%name)
  end function gallery_names

  !> Writes names and descriptions.
  subroutine gallery_list(unit)
    integer, intent(in) :: unit  !! formatted unit
    integer :: i
    write (unit, '(a)') 'usage: sgmp new NAME [--output DIR]    copies a deck to NAME.inp', '', &
      'decks:'
    do i = 1, size(decks)
      write (unit, '(2x, a, t18, a)') trim(decks(i)%name), trim(decks(i)%what)
    end do
  end subroutine gallery_list

  !> Copies a deck into a folder, where no file of its name may be.
  subroutine gallery_copy(name, folder, path, error)
    character(*), intent(in) :: name
    character(*), intent(in) :: folder            !! '' for the current one
    character(:), allocatable, intent(out) :: path  !! of the copy
    type(error_t), allocatable, intent(out) :: error
    type(line_t), allocatable :: lines(:)
    type(output_file_t) :: copy
    character(:), allocatable :: source
    integer :: number, i
    path = name//'.inp'
    if (folder /= '') path = folder//'/'//path
    number = word_position(name, decks%name)
    if (number == 0) then
      call error_make(error, exit_usage, "there is no deck '"//name//"' in the gallery", &
                      suggestion(name, word_items(gallery_names()), 'decks')// &
                      '; sgmp new lists them')
    else if (file_exists(path)) then
      call error_make(error, exit_io, "there is a file '"//path//"' already", &
                      'move it away, or choose a folder with --output')
    end if
    if (allocated(error)) return
    source = library_file(trim(decks(number)%file))
    if (source == '') then
      call error_make(error, exit_io, 'the decks that come with the program are not in '// &
                      library_places(), 'install it whole (make install PREFIX=…), or copy '// &
                      'input/'//trim(decks(number)%file)//' from the sources')
      return
    end if
    call file_lines(source, lines, error)
    if (allocated(error)) return
    if (folder /= '') call directory_make(folder, error)
    if (allocated(error)) return
    call copy%open(path, 'new', error)
    if (allocated(error)) return
    do i = 1, size(lines)
      call copy%line(lines(i)%text)
    end do
    call copy%close(error)
  end subroutine gallery_copy

end module sgmp_gallery
