!> Checksums: of particle states, whatever the order of the particles, and of stored data.
module sgmp_checksum
  use sgmp_kinds, only: dp, i4, i8
  implicit none
  private
  public :: checksum_add, checksum_particles, checksum_sums, checksum_text, checksum_words

  integer, parameter :: checksum_sums = 4  !! sums that checksum_words fills

contains

  !> Order- and rank-independent checksum of the particle state: the sum modulo 2^64 over particles
  !! of a 64-bit hash of the id and the bits of its values. Ranks combine theirs with
  !! `checksum_add`. Equal sums mean, to within chance, equal bits; -0 differs from +0, and one NaN
  !! from another.
  pure function checksum_particles(ids, values) result(total)
    integer(i4), intent(in) :: ids(:)      !! (n) unique ids
    real(dp), intent(in) :: values(:, :)   !! (fields, n)
    integer(i8) :: total
    integer(i8) :: hash(size(ids))
    integer :: k, p
    hash = mix(int(ids, i8))
    do k = 1, size(values, 1)
      !$omp simd
      do p = 1, size(ids)
        hash(p) = mix(ieor(hash(p), transfer(values(k, p), 0_i8)))
      end do
    end do
    total = 0
    do p = 1, size(ids)
      total = checksum_add(total, hash(p))
    end do
  end function checksum_particles

  !> Sum modulo 2^64 without signed overflow.
  elemental function checksum_add(a, b) result(total)
    integer(i8), intent(in) :: a, b
    integer(i8) :: total
    integer(i8), parameter :: low = int(z'FFFFFFFF', i8)
    integer(i8) :: lower, upper
    lower = iand(a, low) + iand(b, low)
    upper = ishft(a, -32) + ishft(b, -32) + ishft(lower, -32)
    total = ior(ishft(upper, 32), iand(lower, low))
  end function checksum_add

  !> Adds words of a data set to its sums: of their lower and upper halves, plain and weighted with
  !! the place (Fletcher 1982). Every changed or misplaced word changes them, and since only the
  !! place in the whole counts, parts may be added in any order and by any rank.
  pure subroutine checksum_words(words, before, sums)
    integer(i8), intent(in), contiguous :: words(:)
    integer(i8), intent(in) :: before       !! words of the data set before these
    integer(i8), intent(inout) :: sums(checksum_sums)
    integer(i8), parameter :: half = int(z'FFFFFFFF', i8), places = 2_i8**20 - 1_i8
    integer, parameter :: block = 1024      ! so many products of 32 and 21 bits do not overflow
    integer(i8) :: low, high, place, lows, highs, low_places, high_places
    integer :: first, i
    do first = 1, size(words), block
      lows = 0_i8
      highs = 0_i8
      low_places = 0_i8
      high_places = 0_i8
      !$omp simd private(low, high, place) reduction(+:lows, highs, low_places, high_places)
      do i = first, min(first + block - 1, size(words))
        low = iand(words(i), half)
        high = ishft(words(i), -32)
        place = 1_i8 + iand(before + i, places)
        lows = lows + low
        highs = highs + high
        low_places = low_places + place*low
        high_places = high_places + place*high
      end do
      sums = checksum_add(sums, [lows, highs, low_places, high_places])
    end do
  end subroutine checksum_words

  !> The checksum as 16 hexadecimal digits.
  pure function checksum_text(checksum) result(text)
    integer(i8), intent(in) :: checksum
    character(16) :: text
    write (text, '(z16.16)') checksum
  end function checksum_text

  !> Step and output function of the SplitMix64 generator (Steele, Lea & Flood 2014): bijective,
  !! every input bit reaches every output bit; the step keeps zero from being a fixed point.
  elemental function mix(key) result(hash)
    integer(i8), intent(in) :: key
    integer(i8) :: hash
    hash = checksum_add(key, int(z'9E3779B97F4A7C15', i8))
    hash = multiply(ieor(hash, ishft(hash, -30)), int(z'BF58476D1CE4E5B9', i8))
    hash = multiply(ieor(hash, ishft(hash, -27)), int(z'94D049BB133111EB', i8))
    hash = ieor(hash, ishft(hash, -31))
  end function mix

  !> Product modulo 2^64 from products of 32 x 16 bits, none of which can overflow.
  elemental function multiply(a, b) result(product)
    integer(i8), intent(in) :: a, b
    integer(i8) :: product
    integer(i8), parameter :: half = int(z'FFFF', i8), word = int(z'FFFFFFFF', i8)
    integer(i8) :: a0, a1, a2, a3, low, high, upper
    a0 = iand(a, half)               ! a = a0 + 2^16 a1 + 2^32 a2 + 2^48 a3
    a1 = iand(ishft(a, -16), half)
    a2 = iand(ishft(a, -32), half)
    a3 = ishft(a, -48)
    low = iand(b, word)              ! b = low + 2^32 high
    high = ishft(b, -32)
    upper = a2*low + ishft(iand(a3*low, half), 16) + a0*high + ishft(iand(a1*high, half), 16)
    product = checksum_add(checksum_add(a0*low, ishft(a1*low, 16)), ishft(upper, 32))
  end function multiply

end module sgmp_checksum
