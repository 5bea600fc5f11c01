!> The folder of a run's results: made, locked against other runs, and cleared of the files of the
!! run before.
module sgmp_run_folder
  use sgmp_checkpoint, only: checkpoint_set_aside
  use sgmp_errors, only: error_make, error_t, exit_io
  use sgmp_file_tools, only: directory_make, file_exists, file_remove, io_error
  use sgmp_kinds, only: i8
  use sgmp_parallel, only: parallel_agree, parallel_rank
  use sgmp_posix, only: file_number, folder_lock, lock_impossible, lock_taken
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: run_folder_clear, run_folder_open

  character(*), parameter :: lock_file = '/.lock'

  !> What a run leaves besides its log, its checkpoints and the numbered files of the series.
  character(20), parameter :: results(*) = [character(20) :: &
    'summary.json', 'history.csv', 'bodies.csv', 'contact.csv', 'motion.csv', 'rigid.csv', &
    'gauges.csv', 'sections.csv', 'particles_end.csv', 'particles.vtkhdf', 'particles.pvd', &
    'particles.dat']
  character(*), parameter :: series_prefix = 'particles_', series_suffix = '.vtu'

contains

  !> Makes the folder and takes its lock, which other runs respect and which ends with the last
  !! process of this one, killed or not; a summary of the run before goes at once. All ranks come
  !! here.
  subroutine run_folder_open(folder, error)
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(out) :: error
    integer(i8) :: holder
    if (parallel_rank() == 0) then
      call directory_make(folder, error)
      if (.not. allocated(error)) then
        holder = folder_lock(folder//lock_file, 0)
        if (holder == lock_impossible) then
          call io_error(error, 'open', folder//lock_file)
        else if (holder > lock_taken) then
          call error_make(error, exit_io, "the folder '"//folder//"' belongs to a run that is "// &
                          'still going (process '//integer_text(holder)//')', &
                          'wait for it, end it, or choose another folder with --output')
        else
          call remove_if_there(folder//'/'//trim(results(1)), error)
        end if
      end if
    end if
    call parallel_agree(error)
    if (allocated(error) .or. parallel_rank() == 0) return
    holder = folder_lock(folder//lock_file, parallel_rank())  ! the first rank has asked for all
  end subroutine run_folder_open

  !> Removes the results of the run before, where a run starts anew; its checkpoints are set aside.
  subroutine run_folder_clear(folder, error)
    character(*), intent(in) :: folder
    type(error_t), allocatable, intent(out) :: error
    integer(i8) :: number
    integer :: i
    call checkpoint_set_aside(folder, -1_i8, error)
    if (allocated(error)) return
    if (parallel_rank() == 0) then
      do i = 1, size(results)
        if (.not. allocated(error)) call remove_if_there(folder//'/'//trim(results(i)), error)
      end do
      number = huge(number)
      do while (.not. allocated(error))
        number = file_number(folder, series_prefix, series_suffix, number)
        if (number < 0_i8) exit
        call remove_if_there(series_path(folder, number), error)
      end do
    end if
    call parallel_agree(error)
  end subroutine run_folder_clear

  pure function series_path(folder, number) result(path)
    character(*), intent(in) :: folder
    integer(i8), intent(in) :: number
    character(:), allocatable :: path
    character(24) :: digits
    write (digits, '(i0.7)') number
    path = folder//'/'//series_prefix//trim(digits)//series_suffix
  end function series_path

  subroutine remove_if_there(path, error)
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    if (file_exists(path)) call file_remove(path, error)
  end subroutine remove_if_there

end module sgmp_run_folder
