!> Tests on several processes: each runs on a communicator of the number of processes that it asks for.
module pfunit_runner
  use, intrinsic :: iso_fortran_env, only: output_unit
  use mpi
  use funit_core, only: any_local => anyExceptions, exception_text, exceptions_clear, new_line_char
  use funit_runner, only: test_record
  implicit none
  private
  public :: MpiTestMethod, mpi_test_begin, mpi_test_end

  integer, parameter :: text_length = 8192

  !> A running test: its communicator and the calling process in it.
  type :: MpiTestMethod
    private
    integer :: communicator = MPI_COMM_NULL
    integer :: processes = 0
    integer :: rank = -1
    character(128) :: name = ''
  contains
    procedure :: getMpiCommunicator
    procedure :: getNumProcesses
    procedure :: getProcessRank
  end type MpiTestMethod

contains

  integer function getMpiCommunicator(this)
    class(MpiTestMethod), intent(in) :: this

    getMpiCommunicator = this%communicator
  end function getMpiCommunicator

  integer function getNumProcesses(this)
    class(MpiTestMethod), intent(in) :: this

    getNumProcesses = this%processes
  end function getNumProcesses

  integer function getProcessRank(this)
    class(MpiTestMethod), intent(in) :: this

    getProcessRank = this%rank
  end function getProcessRank

  !> True on all processes of `comm` if there is an exception on any of them (collective).
  logical function any_on(comm)
    integer, intent(in) :: comm
    integer :: ierror

    call MPI_Allreduce(any_local(), any_on, 1, MPI_LOGICAL, MPI_LOR, comm, ierror)
  end function any_on

  !> Sets up a test on the first `npes` processes (collective over all of them).
  subroutine mpi_test_begin(this, name, npes, takes_part)
    type(MpiTestMethod), intent(inout) :: this
    character(*), intent(in) :: name
    integer, intent(in) :: npes
    logical, intent(out) :: takes_part
    integer :: world_size, world_rank, colour, ierror

    call MPI_Comm_size(MPI_COMM_WORLD, world_size, ierror)
    call MPI_Comm_rank(MPI_COMM_WORLD, world_rank, ierror)
    if (npes > world_size) then
      write (output_unit, '(a, i0, a)') trim(name) // ' needs ', npes, ' processes: raise MAX_PES'
      flush (output_unit)
      call MPI_Abort(MPI_COMM_WORLD, 2, ierror)
    end if
    call exceptions_clear()
    takes_part = world_rank < npes
    colour = merge(1, MPI_UNDEFINED, takes_part)
    call MPI_Comm_split(MPI_COMM_WORLD, colour, world_rank, this%communicator, ierror)
    this%processes = npes
    this%rank = merge(world_rank, -1, takes_part)
    write (this%name, '(2a, i0, a)') trim(name), '[npes=', npes, ']'
  end subroutine mpi_test_begin

  !> Collects the exceptions of all processes (collective over all of them).
  subroutine mpi_test_end(this)
    type(MpiTestMethod), intent(inout) :: this
    character(text_length) :: text
    character(text_length), allocatable :: texts(:)
    character(:), allocatable :: all_texts
    character(16) :: rank
    logical :: has_failed
    integer :: world_size, world_rank, i, ierror

    call MPI_Comm_size(MPI_COMM_WORLD, world_size, ierror)
    call MPI_Comm_rank(MPI_COMM_WORLD, world_rank, ierror)
    has_failed = any_on(MPI_COMM_WORLD)
    all_texts = ''
    if (has_failed) then
      allocate (texts(world_size))
      text = exception_text()
      call MPI_Gather(text, text_length, MPI_CHARACTER, texts, text_length, MPI_CHARACTER, 0, MPI_COMM_WORLD, ierror)
      do i = 1, merge(world_size, 0, world_rank == 0)
        write (rank, '(i0)') i - 1
        if (texts(i) /= '') all_texts = all_texts // '  (rank ' // trim(rank) // ')' // new_line_char // trim(texts(i))
      end do
    end if
    if (world_rank == 0) call test_record(this%name, has_failed, all_texts)
    call exceptions_clear()
    if (this%communicator /= MPI_COMM_NULL) call MPI_Comm_free(this%communicator, ierror)
  end subroutine mpi_test_end

end module pfunit_runner
