!> The checksum of a run: of all that its particles hold, alike for every number of ranks and
!! threads.
module sgmp_model_checksum
  use sgmp_checksum, only: checksum_add, checksum_particles
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_sum
  use sgmp_particles, only: particles_t
  implicit none
  private
  public :: model_checksum

contains

  !> Checksum of the whole particle state, independent of order and layout.
  function model_checksum(model) result(checksum)
    type(model_t), intent(in) :: model
    integer(i8) :: checksum
    integer(i8) :: part
    integer :: b, c
    checksum = 0_i8
    do b = 1, size(model%bodies)
      !$omp parallel default(none) shared(model, checksum, b) private(part)
      part = 0_i8
      !$omp do
      do c = 1, model%bodies(b)%particles%chunks
        part = checksum_add(part, chunk_checksum(model%bodies(b)%particles, c))
      end do
      !$omp end do
      !$omp critical (checksums)
      checksum = checksum_add(checksum, part)  ! modulo 2^64: any order will do
      !$omp end critical (checksums)
      !$omp end parallel
    end do
    checksum = parallel_sum(checksum)
  end function model_checksum

  !> Checksum of the particles of a chunk.
  pure function chunk_checksum(particles, c) result(checksum)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: c
    integer(i8) :: checksum
    integer :: l, n
    integer(i4) :: ids(lanes)
    real(dp) :: values(particles%motion_columns + particles%state_columns, lanes)
    n = 0
    do l = 1, lanes
      if (particles%id(l, c) == 0) cycle
      n = n + 1
      ids(n) = particles%id(l, c)
      values(:particles%motion_columns, n) = particles%motion(l, :, c)
      values(particles%motion_columns + 1:, n) = particles%state(l, :, c)
    end do
    checksum = checksum_particles(ids(:n), values(:, :n))
  end function chunk_checksum

end module sgmp_model_checksum
