!> The ranks of a run in a build without MPI (-DSGMP_MPI=OFF): there is one. The procedures are
!! those of ../parallel.f90, with the same results as one rank has there.
module sgmp_parallel
  use sgmp_errors, only: error_make, error_t, exit_usage
  use sgmp_exact_sum, only: exact_add, exact_digits, exact_total
  use sgmp_kinds, only: dp, i4, i8
  implicit none
  private
  public :: parallel_start, parallel_end
  public :: parallel_rank, parallel_ranks, parallel_ranks_here
  public :: parallel_any, parallel_sum, parallel_min, parallel_max, parallel_max_place
  public :: parallel_exact_sums, parallel_scan, parallel_agree, parallel_deal, parallel_collect, &
            parallel_gather, parallel_trade

  !> Where launchers say how many processes they start: Open MPI, Hydra of MPICH and Intel MPI,
  !! MVAPICH, Slurm.
  character(20), parameter :: launched(*) = [character(20) :: 'OMPI_COMM_WORLD_SIZE', 'PMI_SIZE', &
    'MV2_COMM_WORLD_SIZE', 'SLURM_STEP_NUM_TASKS']

  interface parallel_sum
    module procedure sum_one, sum_many
  end interface parallel_sum

contains

  !> Refuses what a launcher has started as several processes: each would be a run of its own.
  subroutine parallel_start(error)
    type(error_t), allocatable, intent(out) :: error
    character(12) :: text
    integer :: n, number, status
    do n = 1, size(launched)
      call get_environment_variable(trim(launched(n)), text, status=status)
      if (status /= 0) cycle
      read (text, *, iostat=status) number
      if (status /= 0 .or. number < 2) cycle
      call error_make(error, exit_usage, 'this sgmp was built without MPI and knows one rank', &
                      'start it without a launcher, with --threads, or build it with MPI '// &
                      '(cmake -DSGMP_MPI=ON)')
      return
    end do
  end subroutine parallel_start

  !> Nothing is to be ended.
  subroutine parallel_end()
  end subroutine parallel_end

  !> This rank, from 0.
  function parallel_rank() result(rank)
    integer :: rank
    rank = 0
  end function parallel_rank

  !> Number of ranks.
  function parallel_ranks() result(ranks)
    integer :: ranks
    ranks = 1
  end function parallel_ranks

  !> Number of ranks on this machine.
  function parallel_ranks_here() result(ranks)
    integer :: ranks
    ranks = 1
  end function parallel_ranks_here

  !> Whether it is so on any rank.
  function parallel_any(here) result(anywhere)
    logical, intent(in) :: here
    logical :: anywhere
    anywhere = here
  end function parallel_any

  function sum_one(here) result(total)
    integer(i8), intent(in) :: here
    integer(i8) :: total
    total = here
  end function sum_one

  function sum_many(here) result(total)
    integer(i8), intent(in) :: here(:)
    integer(i8) :: total(size(here))
    total = here
  end function sum_many

  !> Smallest of the ranks' values.
  function parallel_min(here) result(least)
    real(dp), intent(in) :: here
    real(dp) :: least
    least = here
  end function parallel_min

  !> Largest of the ranks' values.
  function parallel_max(here) result(largest)
    real(dp), intent(in) :: here
    real(dp) :: largest
    largest = here
  end function parallel_max

  !> Largest of the ranks' values and where it was found: they are this rank's.
  subroutine parallel_max_place(value, place, order)
    real(dp), intent(inout) :: value
    integer(i4), intent(inout) :: place
    integer, intent(in) :: order
    associate (unused_value => value, unused_place => place, unused_order => order)
    end associate
  end subroutine parallel_max_place

  !> Sums over all columns with one rounding.
  subroutine parallel_exact_sums(terms, sums)
    real(dp), intent(in) :: terms(:, :)      !! (quantities, columns)
    real(dp), intent(out) :: sums(:)         !! (quantities)
    integer(i8), allocatable :: digits(:, :)
    integer :: c, q
    if (size(terms, 2) == 1) then
      sums = terms(:, 1)
      return
    end if
    allocate (digits(exact_digits, size(sums)), source=0_i8)
    do c = 1, size(terms, 2)
      do q = 1, size(sums)
        call exact_add(digits(:, q), terms(q, c))
      end do
    end do
    do q = 1, size(sums)
      sums(q) = exact_total(digits(:, q))
    end do
  end subroutine parallel_exact_sums

  !> Sum over the ranks before this one.
  function parallel_scan(here) result(before)
    integer(i8), intent(in) :: here
    integer(i8) :: before
    before = 0_i8*here
  end function parallel_scan

  !> The error of this rank is that of all.
  subroutine parallel_agree(error, moment)
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: moment
    associate (unused_error => error, unused_moment => present(moment))
    end associate
  end subroutine parallel_agree

  !> All columns stay.
  subroutine parallel_deal(columns, destination, received)
    real(dp), intent(in) :: columns(:, :)    !! (values, columns)
    integer, intent(in) :: destination(:)    !! (columns) rank, from 0
    real(dp), allocatable, intent(out) :: received(:, :)
    received = columns(:, :size(destination))
  end subroutine parallel_deal

  !> The values of all ranks.
  subroutine parallel_gather(values, all, before)
    real(dp), intent(in) :: values(:)
    real(dp), allocatable, intent(out) :: all(:)
    integer, intent(out), optional :: before  !! how many of them are of lower ranks
    if (present(before)) before = 0
    all = values
  end subroutine parallel_gather

  !> The values of all other ranks: none.
  subroutine parallel_collect(values, others)
    real(dp), intent(in) :: values(:)
    real(dp), allocatable, intent(out) :: others(:)
    others = values(:0)
  end subroutine parallel_collect

  !> This rank's part of its own list.
  subroutine parallel_trade(values, counts, received)
    real(dp), intent(in) :: values(:)
    integer, intent(in) :: counts(:)     !! (ranks) values for each
    real(dp), allocatable, intent(out) :: received(:)
    received = values(:sum(counts))
  end subroutine parallel_trade

end module sgmp_parallel
