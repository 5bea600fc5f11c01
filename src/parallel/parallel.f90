!> The ranks of a run: who there is, and what they find out together.
!!
!! The communicator is the one thing here that is global (`parallel_attach` sets it). A program that
!! never starts MPI, such as a unit test or a run that no launcher has started, is a run of one
!! rank, for which every procedure returns at once.
module sgmp_parallel
  use mpi_f08, only: mpi_allgather, mpi_allgatherv, mpi_allreduce, mpi_alltoall, mpi_alltoallv, &
                     mpi_bcast, mpi_character, mpi_comm, mpi_comm_free, mpi_comm_rank, &
                     mpi_comm_size, mpi_comm_split_type, mpi_comm_type_shared, mpi_comm_world, &
                     mpi_datatype, mpi_double_precision, mpi_exscan, mpi_finalize, &
                     mpi_in_place, mpi_info_null, mpi_init_thread, mpi_integer, mpi_integer8, &
                     mpi_logical, mpi_lor, mpi_max, mpi_maxloc, mpi_min, mpi_sum, &
                     mpi_thread_funneled, mpi_2double_precision, mpi_type_commit, &
                     mpi_type_contiguous, mpi_type_free
  use sgmp_errors, only: error_t
  use sgmp_exact_sum, only: exact_add, exact_digits, exact_total
  use sgmp_kinds, only: dp, i4, i8
  implicit none
  private
  public :: parallel_start, parallel_end, parallel_attach
  public :: parallel_rank, parallel_ranks, parallel_ranks_here, parallel_communicator
  public :: parallel_any, parallel_sum, parallel_min, parallel_max, parallel_max_place
  public :: parallel_exact_sums, parallel_scan, parallel_agree, parallel_deal, parallel_collect, &
            parallel_gather, parallel_trade

  real(dp), parameter :: place_stride = 2.0_dp**31

  !> What launchers tell the processes that they start: Open MPI and PRRTE, PMIx, PMI (Hydra of
  !! MPICH and Intel MPI, Slurm), Slurm, MVAPICH, ALPS and PALS (Cray), JSM (Spectrum MPI), MPT;
  !! last what the user says.
  character(20), parameter :: launched(*) = [character(20) :: 'OMPI_COMM_WORLD_SIZE', 'PMIX_RANK', &
    'PMI_RANK', 'PMI_SIZE', 'PMI_FD', 'PMI_PORT', 'SLURM_PROCID', 'MV2_COMM_WORLD_RANK', &
    'ALPS_APP_PE', 'PALS_RANKID', 'JSM_NAMESPACE_RANK', 'MPI_LOCALNRANKS', 'SGMP_MPI']

  type(mpi_comm) :: communicator
  integer :: own_rank = 0, all_ranks = 1
  logical :: started = .false.

  interface parallel_sum
    module procedure sum_one, sum_many
  end interface parallel_sum

contains

  !> Starts MPI, which takes some tenths of a second, where a launcher has started the program; only
  !! the thread that calls it talks to other ranks.
  subroutine parallel_start(error)
    type(error_t), allocatable, intent(out) :: error  !! of builds without MPI only
    integer :: provided, n, length
    do n = 1, size(launched)
      call get_environment_variable(trim(launched(n)), length=length)
      if (length > 0) started = .true.
    end do
    if (.not. started) return
    call mpi_init_thread(mpi_thread_funneled, provided)
    call parallel_attach(mpi_comm_world)
  end subroutine parallel_start

  !> Makes the ranks of a communicator those of the run, where MPI is already running (tests).
  subroutine parallel_attach(all)
    type(mpi_comm), intent(in) :: all
    communicator = all
    call mpi_comm_rank(communicator, own_rank)
    call mpi_comm_size(communicator, all_ranks)
  end subroutine parallel_attach

  !> Ends MPI; all ranks must come here.
  subroutine parallel_end()
    if (.not. started) return
    call mpi_finalize()
    started = .false.
    own_rank = 0
    all_ranks = 1
  end subroutine parallel_end

  !> This rank, from 0.
  function parallel_rank() result(rank)
    integer :: rank
    rank = own_rank
  end function parallel_rank

  !> Number of ranks.
  function parallel_ranks() result(ranks)
    integer :: ranks
    ranks = all_ranks
  end function parallel_ranks

  !> Number of ranks on this machine; all ranks must ask.
  function parallel_ranks_here() result(ranks)
    integer :: ranks
    type(mpi_comm) :: machine
    ranks = 1
    if (all_ranks == 1) return
    call mpi_comm_split_type(communicator, mpi_comm_type_shared, own_rank, mpi_info_null, machine)
    call mpi_comm_size(machine, ranks)
    call mpi_comm_free(machine)
  end function parallel_ranks_here

  !> The communicator of all ranks, for parallel files; only with MPI started.
  function parallel_communicator() result(all)
    type(mpi_comm) :: all
    all = communicator
  end function parallel_communicator

  !> Whether it is so on any rank.
  function parallel_any(here) result(anywhere)
    logical, intent(in) :: here
    logical :: anywhere
    anywhere = here
    if (all_ranks == 1) return
    call mpi_allreduce(here, anywhere, 1, mpi_logical, mpi_lor, communicator)
  end function parallel_any

  function sum_one(here) result(total)
    integer(i8), intent(in) :: here
    integer(i8) :: total
    total = here
    if (all_ranks == 1) return
    call mpi_allreduce(here, total, 1, mpi_integer8, mpi_sum, communicator)
  end function sum_one

  function sum_many(here) result(total)
    integer(i8), intent(in) :: here(:)
    integer(i8) :: total(size(here))
    total = here
    if (all_ranks == 1) return
    call mpi_allreduce(here, total, size(here), mpi_integer8, mpi_sum, communicator)
  end function sum_many

  !> Smallest of the ranks' values.
  function parallel_min(here) result(least)
    real(dp), intent(in) :: here
    real(dp) :: least
    least = here
    if (all_ranks == 1) return
    call mpi_allreduce(here, least, 1, mpi_double_precision, mpi_min, communicator)
  end function parallel_min

  !> Largest of the ranks' values.
  function parallel_max(here) result(largest)
    real(dp), intent(in) :: here
    real(dp) :: largest
    largest = here
    if (all_ranks == 1) return
    call mpi_allreduce(here, largest, 1, mpi_double_precision, mpi_max, communicator)
  end function parallel_max

  !> Largest of the ranks' values and where it was found; of equals that with the smallest `order`,
  !! then that of the lowest rank.
  subroutine parallel_max_place(value, place, order)
    real(dp), intent(inout) :: value
    integer(i4), intent(inout) :: place      !! goes along with the value, e.g. a particle's id
    integer, intent(in) :: order             !! >= 0, times the ranks below 2^21
    real(dp) :: own(2), best(2)
    if (all_ranks == 1) return
    ! Order, rank and place in one number: whole numbers up to 2^53 are exact.
    own = [value, (real(order, dp)*all_ranks + own_rank)*place_stride + place]
    call mpi_allreduce(own, best, 1, mpi_2double_precision, mpi_maxloc, communicator)
    value = best(1)
    place = int(mod(best(2), place_stride), i4)
  end subroutine parallel_max_place

  !> Sums over all columns of all ranks with one rounding, so that they do not depend on the order
  !! or on who holds which column.
  subroutine parallel_exact_sums(terms, sums)
    real(dp), intent(in) :: terms(:, :)      !! (quantities, columns)
    real(dp), intent(out) :: sums(:)         !! (quantities)
    integer, parameter :: many = 4096  ! columns from which a meeting of threads pays
    integer(i8) :: digits(exact_digits, size(sums))
    integer :: c, q
    if (all_ranks == 1 .and. size(terms, 2) == 1) then
      sums = terms(:, 1)
      return
    end if
    digits = 0_i8
    ! Whole numbers: any order of the threads gives the same.
    !$omp parallel do schedule(static) if(size(terms, 2) > many) default(none) shared(terms, sums) &
    !$omp& private(q) reduction(+: digits)
    do c = 1, size(terms, 2)
      do q = 1, size(sums)
        call exact_add(digits(:, q), terms(q, c))
      end do
    end do
    !$omp end parallel do
    if (all_ranks > 1) then
      call mpi_allreduce(mpi_in_place, digits, size(digits), mpi_integer8, mpi_sum, communicator)
    end if
    do q = 1, size(sums)
      sums(q) = exact_total(digits(:, q))
    end do
  end subroutine parallel_exact_sums

  !> Sum over the ranks before this one: where its share of a common list begins, from 0.
  function parallel_scan(here) result(before)
    integer(i8), intent(in) :: here
    integer(i8) :: before
    before = 0_i8
    if (all_ranks == 1) return
    call mpi_exscan(here, before, 1, mpi_integer8, mpi_sum, communicator)
    if (own_rank == 0) before = 0_i8
  end function parallel_scan

  !> Makes an error of any rank one of all; where several have one, that of the lowest rank.
  subroutine parallel_agree(error, moment)
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: moment  !! when it happened (>= 0): the earliest counts
    integer :: own, first, lengths(4)
    character(:), allocatable :: text
    if (all_ranks == 1) return
    own = huge(1)
    if (allocated(error)) then
      own = own_rank
      if (present(moment)) own = own_rank + all_ranks*moment
    end if
    call mpi_allreduce(own, first, 1, mpi_integer, mpi_min, communicator)
    if (first == huge(1)) return
    first = modulo(first, all_ranks)
    lengths = 0
    if (own_rank == first) lengths = [error%code, len(error%location), len(error%message), &
                                      len(error%remedy)]
    call mpi_bcast(lengths, size(lengths), mpi_integer, first, communicator)
    allocate (character(sum(lengths(2:))) :: text)
    if (own_rank == first) text = error%location//error%message//error%remedy
    call mpi_bcast(text, len(text), mpi_character, first, communicator)
    if (allocated(error)) deallocate (error)
    allocate (error)
    error%code = lengths(1)
    error%location = text(:lengths(2))
    error%message = text(lengths(2) + 1:lengths(2) + lengths(3))
    error%remedy = text(lengths(2) + lengths(3) + 1:)
  end subroutine parallel_agree

  !> Deals columns out to ranks: each goes to its destination, and arrives behind those of lower
  !! ranks, in the order of its own rank.
  subroutine parallel_deal(columns, destination, received)
    real(dp), intent(in) :: columns(:, :)    !! (values, columns)
    integer, intent(in) :: destination(:)    !! (columns) rank, from 0
    real(dp), allocatable, intent(out) :: received(:, :)
    real(dp), allocatable :: packed(:, :)
    integer :: counts(0:all_ranks - 1), theirs(0:all_ranks - 1), place(0:all_ranks - 1)
    integer :: c, r, width
    type(mpi_datatype) :: column
    if (all_ranks == 1) then
      received = columns
      return
    end if
    width = size(columns, 1)
    counts = 0
    do c = 1, size(destination)
      counts(destination(c)) = counts(destination(c)) + 1
    end do
    call mpi_alltoall(counts, 1, mpi_integer, theirs, 1, mpi_integer, communicator)
    place = offsets(counts)
    allocate (packed(width, size(destination)), received(width, sum(theirs)))
    do c = 1, size(destination)
      r = destination(c)
      place(r) = place(r) + 1
      packed(:, place(r)) = columns(:, c)
    end do
    call mpi_type_contiguous(width, mpi_double_precision, column)
    call mpi_type_commit(column)
    call mpi_alltoallv(packed, counts, offsets(counts), column, received, theirs, &
                       offsets(theirs), column, communicator)
    call mpi_type_free(column)
  end subroutine parallel_deal

  !> The values of all ranks, one rank after the other.
  subroutine parallel_gather(values, all, before)
    real(dp), intent(in) :: values(:)
    real(dp), allocatable, intent(out) :: all(:)
    integer, intent(out), optional :: before  !! how many of them are of lower ranks
    integer :: counts(all_ranks)
    if (present(before)) before = 0
    if (all_ranks == 1) then
      all = values
      return
    end if
    call mpi_allgather(size(values), 1, mpi_integer, counts, 1, mpi_integer, communicator)
    allocate (all(sum(counts)))
    call mpi_allgatherv(values, size(values), mpi_double_precision, all, counts, offsets(counts), &
                        mpi_double_precision, communicator)
    if (present(before)) before = sum(counts(:own_rank))
  end subroutine parallel_gather

  !> The values of all other ranks, one rank after the other.
  subroutine parallel_collect(values, others)
    real(dp), intent(in) :: values(:)
    real(dp), allocatable, intent(out) :: others(:)
    real(dp), allocatable :: all(:)
    integer :: before
    call parallel_gather(values, all, before)
    others = [all(:before), all(before + size(values) + 1:)]
  end subroutine parallel_collect

  !> Sends every rank its part of a list; what arrives follows the order of the ranks.
  subroutine parallel_trade(values, counts, received)
    real(dp), intent(in) :: values(:)    !! the parts, one rank after the other
    integer, intent(in) :: counts(:)     !! (ranks) values for each
    real(dp), allocatable, intent(out) :: received(:)
    integer :: theirs(all_ranks)
    if (all_ranks == 1) then
      received = values
      return
    end if
    call mpi_alltoall(counts, 1, mpi_integer, theirs, 1, mpi_integer, communicator)
    allocate (received(sum(theirs)))
    call mpi_alltoallv(values, counts, offsets(counts), mpi_double_precision, received, theirs, &
                       offsets(theirs), mpi_double_precision, communicator)
  end subroutine parallel_trade

  !> Sums of the counts before each.
  pure function offsets(counts) result(before)
    integer, intent(in) :: counts(:)
    integer :: before(size(counts))
    integer :: r
    before(1) = 0
    do r = 2, size(counts)
      before(r) = before(r - 1) + counts(r - 1)
    end do
  end function offsets

end module sgmp_parallel
