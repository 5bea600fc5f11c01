!> How long the threads take for their planes. What a chunk of particles costs differs by material,
!! by how full chunks are and by how busy a core is; so planes are divided by what was measured, and
!! not by chunks alone. Which thread takes which plane changes no bit of a result.
module sgmp_pace
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: pace_t, pace_cost, pace_due, pace_learn, pace_note, pace_share

  integer, parameter :: window = 64           !! sweeps after which a measurement is complete
  real(dp), parameter :: tolerance = 1.05_dp  !! of the slowest thread's time over the mean

  !> What is known of the threads of a field.
  type :: pace_t
    integer, allocatable :: first(:)         !! (threads) row of planes with which each begins
    real(dp), allocatable :: load(:)         !! (threads) chunks of each
    real(dp), allocatable :: swept(:), spent(:)  !! (threads) chunks, seconds of the measurement
    integer :: sweeps = 0                    !! of the measurement
    integer, allocatable :: known_first(:)   !! (threads) `first` of the last one that is complete
    real(dp), allocatable :: known_cost(:)   !! (threads) its seconds per chunk
  end type pace_t

contains

  !> Notes how the planes are divided.
  pure subroutine pace_share(pace, first, load)
    type(pace_t), intent(inout) :: pace
    integer, intent(in) :: first(:)          !! (threads) row of planes with which each begins
    real(dp), intent(in) :: load(:)          !! (threads) chunks
    pace%first = first
    pace%load = load
    if (allocated(pace%swept)) then
      if (size(pace%swept) == size(load)) return
    end if
    allocate (pace%swept(size(load)), pace%spent(size(load)), source=0.0_dp)
  end subroutine pace_share

  !> Adds the seconds of a sweep.
  pure subroutine pace_note(pace, seconds)
    type(pace_t), intent(inout) :: pace
    real(dp), intent(in) :: seconds(:)       !! (threads)
    pace%swept = pace%swept + pace%load
    pace%spent = pace%spent + seconds
    pace%sweeps = pace%sweeps + 1
  end subroutine pace_note

  !> Whether a measurement is complete, by which the planes should be divided anew.
  pure logical function pace_due(pace) result(yes)
    type(pace_t), intent(in) :: pace
    yes = .false.
    if (pace%sweeps < window) return
    yes = maxval(pace%spent)*size(pace%spent) > tolerance*sum(pace%spent)
  end function pace_due

  !> Takes over a measurement that is complete, and begins the next.
  pure subroutine pace_learn(pace)
    type(pace_t), intent(inout) :: pace
    if (pace%sweeps < window) return
    if (all(pace%swept > 0.0_dp .and. pace%spent > 0.0_dp)) then
      pace%known_first = pace%first
      pace%known_cost = pace%spent/pace%swept
    end if
    pace%swept = 0.0_dp
    pace%spent = 0.0_dp
    pace%sweeps = 0
  end subroutine pace_learn

  !> What a chunk of a row of planes costs, in seconds; 1 while nothing is known.
  pure function pace_cost(pace, row) result(cost)
    type(pace_t), intent(in) :: pace
    integer, intent(in) :: row
    real(dp) :: cost
    cost = 1.0_dp
    if (.not. allocated(pace%known_cost)) return
    cost = pace%known_cost(max(1, count(pace%known_first <= row)))
  end function pace_cost

end module sgmp_pace
