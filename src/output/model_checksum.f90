!> The checksum of a run: of all that its particles hold, alike for every number of ranks and
!! threads.
module sgmp_model_checksum
  use sgmp_checksum, only: checksum_add, checksum_particles
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_sum
  implicit none
  private
  public :: model_checksum

contains

  !> Checksum of the whole particle state, independent of order and layout.
  function model_checksum(model) result(checksum)
    type(model_t), intent(in) :: model
    integer(i8) :: checksum
    integer :: b, c, l, n
    integer(i4) :: ids(lanes)
    real(dp), allocatable :: values(:, :)
    checksum = 0_i8
    do b = 1, size(model%bodies)
      associate (particles => model%bodies(b)%particles)
        allocate (values(particles%motion_columns + particles%state_columns, lanes))
        do c = 1, particles%chunks
          n = 0
          do l = 1, lanes
            if (particles%id(l, c) == 0) cycle
            n = n + 1
            ids(n) = particles%id(l, c)
            values(:particles%motion_columns, n) = particles%motion(l, :, c)
            values(particles%motion_columns + 1:, n) = particles%state(l, :, c)
          end do
          checksum = checksum_add(checksum, checksum_particles(ids(:n), values(:, :n)))
        end do
        deallocate (values)
      end associate
    end do
    checksum = parallel_sum(checksum)
  end function model_checksum

end module sgmp_model_checksum
