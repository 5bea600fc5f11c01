!> Plastic strain that is averaged over a length of the material, for what must not follow the cell:
!! failure by strain, Johnson and Cook's damage, heat of plastic work (theory 4).
!!
!! The average E of the plastic strain e obeys the implicit gradient equation (Peerlings, de Borst,
!! Brekelmans and de Vree 1996, Int. J. Numer. Methods Eng. 39, 3391; for plasticity Engelen, Geers
!! and Baaijens 2003, Int. J. Plasticity 19, 403; both from memory of the literature),
!!
!!     E - l^2 div grad E = e,     no flux through surfaces,                            (NL1)
!!
!! to which an explicit step relaxes, as micromorphic variables with an inertia do:
!!
!!     E'' + 2 w E' = w^2 (e - E + l^2 div grad E),     w = c/l                         (NL2)
!!
!! with the speed c of sound in the bulk: the average lags behind by 2 l/c and spreads as fast as
!! sound. The divergence is that of the grid,
!!
!!     (div grad E)_p = sum_i N_ip (E_i - E_p)/(k_i h^2),     E_i = sum_q m_q N_iq E_q/M_i,
!!     k_i = sum_q m_q N_iq k_q/M_i,     M_i = sum_q m_q N_iq,
!!
!! k_q half of the variance in cells of what particle q gives to the grid and gets from it. It keeps
!! constants and the total sum m E, is symmetric in the masses, and knows neither gaps nor other
!! fields. Only the largest E so far drives anything: waves of (NL2) do not.
module sgmp_averaging
  use sgmp_columns, only: averaging_rates, averaging_sums
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: averaging_advance, averaging_begin, averaging_collect, averaging_make, averaging_rate, &
            averaging_rates, averaging_spread
  public :: averaging_sums, averaging_t, averaging_values

  integer, parameter :: averaging_values = 3  !! kept of the average: itself, its rate, and the part
                                              !! of its peak that has driven something
  real(dp), parameter :: least_spread = 0.1_dp  !! k of a point; 0 where its only particle is at it
  real(dp), parameter :: largest_turn = 1.0_dp  !! of the fastest wave of the grid in a step; 2 is
                                                !! where (NL2) is stable without friction

  !> Constants of the average.
  type :: averaging_t
    real(dp) :: length = 0.0_dp          !! l; 0: nothing is averaged
    real(dp) :: frequency = 0.0_dp       !! w (1/time)
    real(dp) :: coupling = 0.0_dp        !! l^2/h^2
    real(dp) :: spread = 0.0_dp          !! k of functions with a size; 0: of hats, by the place
  end type averaging_t

contains

  !> Constants from a length, the speed of sound, the side of cells, and the spread of functions.
  pure function averaging_make(length, speed, h, spread) result(averaging)
    real(dp), intent(in) :: length, speed, h
    real(dp), intent(in) :: spread       !! k; 0: of hats, by the place
    type(averaging_t) :: averaging
    averaging%length = length
    if (length > 0.0_dp) averaging%frequency = speed/length
    averaging%coupling = (length/h)**2
    averaging%spread = spread
  end function averaging_make

  !> k of functions that are hats averaged over particles of a half size s side by side: that of
  !! hats, x (1 - x), 1/6 in the mean, and s^2/3; 0 of hats themselves.
  pure function averaging_spread(half_size, wide) result(spread)
    real(dp), intent(in) :: half_size    !! of particles (cells), at most 1/2
    logical, intent(in) :: wide          !! functions have that size
    real(dp) :: spread
    spread = merge(1.0_dp/6.0_dp + min(half_size, 0.5_dp)**2/3.0_dp, 0.0_dp, wide)
  end function averaging_spread

  !> What particles read of a point from its sums: E_i/k_i, 1/k_i; nothing where there is no mass.
  pure function averaging_rate(sums) result(rate)
    real(dp), intent(in) :: sums(averaging_sums)
    real(dp) :: rate(averaging_rates)
    rate = 0.0_dp
    if (sums(1) > 0.0_dp) then
      rate(2) = sums(1)/max(sums(3), least_spread*sums(1))
      rate(1) = rate(2)*(sums(2)/sums(1))
    end if
  end function averaging_rate

  !> Lane kernel: the average is the plastic strain itself, at the start.
  pure subroutine averaging_begin(plastic, peak, kept)
    real(dp), intent(in) :: plastic(lanes)
    real(dp), intent(out) :: peak(lanes), kept(lanes, averaging_values)
    peak = plastic
    kept(:, 1) = plastic
    kept(:, 2) = 0.0_dp
    kept(:, 3) = plastic
  end subroutine averaging_begin

  !> Lane kernel: mass, and mass times the average and times k.
  pure subroutine averaging_collect(averaging, ndim, live, mass, xi, average, values)
    type(averaging_t), intent(in) :: averaging
    integer, intent(in) :: ndim
    real(dp), intent(in) :: live(lanes), mass(lanes), average(lanes)
    real(dp), intent(in) :: xi(lanes, ndim)      !! place (cells), from any point of the grid
    real(dp), intent(out) :: values(lanes, averaging_sums)
    real(dp) :: spread(lanes), x
    integer :: l, d
    spread = averaging%spread
    if (.not. averaging%spread > 0.0_dp) then
      do d = 1, ndim
        do l = 1, lanes
          x = xi(l, d) - floor(xi(l, d))
          spread(l) = spread(l) + x*(1.0_dp - x)/ndim
        end do
      end do
    end if
    !$omp simd simdlen(8)
    do l = 1, lanes
      values(l, 1) = live(l)*mass(l)
      values(l, 2) = live(l)*(mass(l)*average(l))
      values(l, 3) = live(l)*(mass(l)*spread(l))
    end do
  end subroutine averaging_collect

  !> Lane kernel: a step of (NL2), friction implicit; where a step is too long for the fastest waves
  !! of the grid all of it is slower.
  pure subroutine averaging_advance(averaging, dt, plastic, rate, peak, kept)
    type(averaging_t), intent(in) :: averaging
    real(dp), intent(in) :: dt                   !! position step
    real(dp), intent(in) :: plastic(lanes)       !! e
    real(dp), intent(in) :: rate(lanes, averaging_rates)  !! E_i/k_i, 1/k_i times functions
    real(dp), intent(inout) :: peak(lanes), kept(lanes, averaging_values)
    real(dp) :: turn, pull
    integer :: l
    turn = min(dt*averaging%frequency, largest_turn/sqrt(1.0_dp + averaging%coupling/least_spread))
    !$omp simd simdlen(8) private(pull)
    do l = 1, lanes
      pull = (plastic(l) - kept(l, 1)) + averaging%coupling*(rate(l, 1) - rate(l, 2)*kept(l, 1))
      kept(l, 2) = (kept(l, 2) + turn**2*pull)/(1.0_dp + 2.0_dp*turn)
      kept(l, 1) = kept(l, 1) + kept(l, 2)
      peak(l) = max(peak(l), kept(l, 1))
    end do
  end subroutine averaging_advance

end module sgmp_averaging
