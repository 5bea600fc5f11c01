!> sgmp again and again without the price of starting: each line of standard input is a command line,
!! its words separated by tabs, behind the path of a file that takes what it prints. Each is done by a
!! process of its own (fork), so that a crash is that one's. The answer is a line with its exit code,
!! or the number of the signal that ended it, negative.
program fuzz_driver
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use, intrinsic :: iso_fortran_env, only: error_unit, input_unit, iostat_end, output_unit
  use sgmp_command_line, only: command_line_parse, command_line_t
  use sgmp_deck_table, only: deck_table
  use sgmp_errors, only: error_t
  use sgmp_parallel, only: parallel_start
  use sgmp_posix, only: environment_default
  use sgmp_program, only: program_act, program_report
  use sgmp_registry, only: registry_t
  use sgmp_spelling, only: string_t
  use sgmp_timers, only: wall_time
  implicit none
  interface
    !> -1000 in the child, which prints into the file; in the parent the child's end.
    function c_split(path) result(ended) bind(c, name='fuzz_split')
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: ended
    end function c_split
    subroutine c_exit_at_once(status) bind(c, name='_exit')
      import :: c_int
      implicit none
      integer(c_int), value :: status
    end subroutine c_exit_at_once
  end interface
  integer(c_int), parameter :: is_child = -1000_c_int
  type(string_t), allocatable :: words(:)
  type(error_t), allocatable :: error
  type(registry_t) :: table
  character(4096) :: line
  integer(c_int) :: ended
  integer :: status
  call environment_default('OMPI_MCA_io', '^ompio')
  call parallel_start(error)
  table = deck_table()  ! built here, every child finds it
  do
    read (input_unit, '(a)', iostat=status) line
    if (status == iostat_end) exit
    call split_words(trim(line), words)
    ended = c_split(words(1)%text//c_null_char)
    if (ended == is_child) call run(words(2:))
    write (output_unit, '(i0)') ended
    flush (output_unit)
  end do
  call c_exit_at_once(0_c_int)

contains

  !> As the main program, but for the start and the end of MPI.
  subroutine run(words)
    type(string_t), intent(in) :: words(:)
    type(command_line_t) :: options
    type(error_t), allocatable :: error
    integer :: status
    call command_line_parse(words, options, error)
    if (.not. allocated(error)) call program_act(options, wall_time(), error, status)
    if (allocated(error)) then
      call program_report(error)
      status = error%code
    end if
    flush (output_unit)
    flush (error_unit)
    call c_exit_at_once(int(status, c_int))
  end subroutine run

  !> Cuts a line at tabs.
  subroutine split_words(line, words)
    character(*), intent(in) :: line
    type(string_t), allocatable, intent(out) :: words(:)
    character(1), parameter :: tab = achar(9)
    integer :: i, first, last
    allocate (words(1 + count([(line(i:i) == tab, i=1, len(line))])))
    first = 1
    do i = 1, size(words)
      last = index(line(first:)//tab, tab) + first - 2
      words(i)%text = line(first:last)
      first = last + 2
    end do
  end subroutine split_words

end program fuzz_driver
