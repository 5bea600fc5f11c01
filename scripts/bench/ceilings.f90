!> What this machine can do at most, measured with loops that do nothing else: multiply-adds in
!! registers, and the triad a = b + s*c through memory. Prints JSON, one entry per number of threads.
program ceilings
  use, intrinsic :: iso_fortran_env, only: dp => real64, i8 => int64
  !$ use omp_lib, only: omp_get_max_threads
  implicit none
  integer, parameter :: chain = 80        !! sums at a time: ten vectors of AVX-512 hide the latency
  integer, parameter :: rounds = 5000000
  integer, parameter :: length = 2**23    !! numbers in each array of the triad: far above any cache
  integer, parameter :: trials = 40       !! the best of them counts
  integer :: threads, most
  most = 1
  !$ most = omp_get_max_threads()
  print '(a)', '{'
  do threads = 1, most
    print '(a, i0, a, f0.3, a, f0.3, a)', '"', threads, '": {"gigaflops": ', &
      multiply_adds(threads), ', "gigabytes_per_second": ', triad(threads), &
      merge('},', '} ', threads < most)
  end do
  print '(a)', '}'

contains

  !> Seconds since some fixed moment.
  real(dp) function now()
    integer(i8) :: count, rate
    call system_clock(count, rate)
    now = real(count, dp)/real(rate, dp)
  end function now

  !> 10^9 floating-point operations per second.
  real(dp) function multiply_adds(threads)
    integer, intent(in) :: threads
    real(dp) :: start, best, sums(chain, threads)
    integer :: trial, t
    best = huge(best)
    call random_number(sums)
    do trial = 1, trials
      start = now()
      !$omp parallel do num_threads(threads) default(none) shared(sums, threads) private(t)
      do t = 1, threads
        call run_chains(1.0_dp - 1.0e-9_dp, 1.0e-9_dp, sums(:, t))
      end do
      !$omp end parallel do
      best = min(best, now() - start)
    end do
    if (any(sums < 0.0_dp)) error stop 'ceilings: lost count'  ! the sums must be wanted
    multiply_adds = 2.0e-9_dp*real(chain, dp)*real(rounds, dp)*threads/best
  end function multiply_adds

  subroutine run_chains(factor, term, sums)
    real(dp), intent(in) :: factor, term
    real(dp), intent(inout) :: sums(chain)
    real(dp) :: s(chain)
    integer :: i, r
    s = sums
    do r = 1, rounds
      !$omp simd
      do i = 1, chain
        s(i) = s(i)*factor + term
      end do
    end do
    sums = s
  end subroutine run_chains

  !> 10^9 bytes per second; 24 bytes per number (what the caches fetch besides is not counted).
  real(dp) function triad(threads)
    integer, intent(in) :: threads
    real(dp), allocatable :: a(:), b(:), c(:)
    real(dp) :: start, best
    integer :: trial, i
    allocate (a(length), b(length), c(length))
    !$omp parallel do num_threads(threads) default(none) shared(a, b, c) private(i) &
    !$omp& schedule(static)
    do i = 1, length
      a(i) = 0.0_dp
      b(i) = 1.0_dp
      c(i) = real(i, dp)
    end do
    !$omp end parallel do
    best = huge(best)
    do trial = 1, trials
      start = now()
      !$omp parallel do simd num_threads(threads) default(none) shared(a, b, c) private(i) &
      !$omp& schedule(static)
      do i = 1, length
        a(i) = b(i) + 3.0_dp*c(i)
      end do
      !$omp end parallel do simd
      best = min(best, now() - start)
    end do
    if (a(length) < 0.0_dp) error stop 'ceilings: lost count'
    triad = 24.0e-9_dp*real(length, dp)/best
  end function triad

end program ceilings
