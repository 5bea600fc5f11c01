!> Scatter of the strength of particles after Weibull (1951): the factor by which the limits of a
!! particle, or its yield stress, are higher than those of the deck, which are the means.
!!
!! A factor depends on the seed and on the number of the particle alone, so that the same particles
!! are weak whatever threads and ranks do.
module sgmp_strength
  use sgmp_keys, only: key, key_t, kind_integer, kind_real, values_t
  use sgmp_kinds, only: dp, i4, i8
  implicit none
  private
  public :: strength_factor, strength_variate, scatter_t, yield_scatter_keys, yield_scatter_read

  !> A scatter.
  type :: scatter_t
    real(dp) :: weibull = 0.0_dp  !! modulus; 0: none
    integer :: seed = 0
  end type scatter_t

  integer(i8), parameter :: word = 2_i8**32

contains

  !> Keys of a yield stress that scatters.
  function yield_scatter_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('yield_weibull', kind_real, 'Weibull modulus of a yield stress that scatters '// &
                "from particle to particle; the law's is the mean", range='[0.5,inf)'), &
            key('yield_seed', kind_integer, 'another number, another scatter of the yield stress', &
                range='[0,inf)', default='0')]
  end function yield_scatter_keys

  !> Scatter from the values of those keys.
  pure function yield_scatter_read(values) result(scatter)
    class(values_t), intent(in) :: values
    type(scatter_t) :: scatter
    scatter%weibull = values%number('yield_weibull')
    scatter%seed = nint(values%number('yield_seed'))
  end function yield_scatter_read

  !> Factor of a particle: the quantile of a Weibull distribution of mean 1.
  pure function strength_factor(modulus, seed, id) result(factor)
    real(dp), intent(in) :: modulus    !! Weibull's, > 0
    integer, intent(in) :: seed        !! >= 0
    integer(i4), intent(in) :: id      !! of the particle, > 0
    real(dp) :: factor
    factor = strength_variate(seed, id)**(1.0_dp/modulus)/gamma(1.0_dp + 1.0_dp/modulus)
  end function strength_factor

  !> Number of a particle from an exponential distribution of mean 1.
  pure function strength_variate(seed, id) result(variate)
    integer, intent(in) :: seed        !! >= 0
    integer(i4), intent(in) :: id      !! of the particle, > 0
    real(dp) :: variate
    real(dp) :: survives
    survives = (real(scrambled(ieor(scrambled(int(seed, i8) + 1_i8), int(id, i8))), dp) + 0.5_dp) &
               /real(word, dp)
    variate = -log(survives)
  end function strength_variate

  !> A number of 32 bits for another, all bits of which change half of its own (Wellons 2018).
  pure function scrambled(number) result(bits)
    integer(i8), intent(in) :: number
    integer(i8) :: bits
    bits = ieor(number, ishft(number, -16))
    bits = product_of(bits, 2146121005_i8)
    bits = ieor(bits, ishft(bits, -15))
    bits = product_of(bits, 2221713035_i8)
    bits = ieor(bits, ishft(bits, -16))
  end function scrambled

  !> Lower 32 bits of a product of numbers of 32 bits.
  pure function product_of(a, b) result(bits)
    integer(i8), intent(in) :: a, b
    integer(i8) :: bits
    integer(i8), parameter :: half = 2_i8**16
    bits = modulo(modulo(a, half)*b + modulo((a/half)*b, half)*half, word)
  end function product_of

end module sgmp_strength
