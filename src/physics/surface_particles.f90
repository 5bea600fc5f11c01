!> The particles at the surface of a body, around the nodes that it shares with others: packed, so
!! that contact reads each of them once per step from its bin, however many nodes look at it.
!!
!! Bins come in the order of their rows (by plane, row, place) and particles in the order of their
!! ids, so the particles of neighbouring bins of a row, and those of a plane, follow each other.
module sgmp_surface_particles
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_particles, only: particles_t
  use sgmp_rows, only: rows_intersection, rows_points, rows_t
  implicit none
  private
  public :: surface_t, surface_list, surface_pack, surface_bins

  real(dp), parameter :: nowhere = -1.0_dp  !! offsets below are no surface particle's

  !> Surface particles by bin.
  type :: surface_t
    integer :: bins = 0
    logical :: counted = .false.          !! `start` is that of the particles as they are
    type(rows_t) :: rows                  !! the bins, as rows
    integer, allocatable :: row_start(:)  !! (rows%n) bin i of a row has number row_start + i here
    integer, allocatable :: bin(:)        !! (bins) number among all bins of the body
    integer, allocatable :: start(:)      !! (bins + 1) first particle of each bin
    real(dp), allocatable :: x(:, :)
      !! (particles + lanes or more, 4) position (cells; 0 along axes that do not exist), surface
      !! offset
  end type surface_t

contains

  !> Lists the bins of a body that lie in a set of rows; no particles yet.
  pure subroutine surface_list(surface, particles, around)
    type(surface_t), intent(inout) :: surface
    type(particles_t), intent(in) :: particles
    type(rows_t), intent(in) :: around
    integer :: s, t, i, n
    surface%counted = .false.
    call rows_intersection(particles%bins, around, surface%rows)
    surface%bins = int(rows_points(surface%rows))
    if (allocated(surface%bin)) deallocate (surface%bin, surface%start, surface%row_start)
    allocate (surface%bin(surface%bins), surface%row_start(surface%rows%n))
    allocate (surface%start(surface%bins + 1), source=1)
    if (.not. allocated(surface%x)) allocate (surface%x(0, 4))
    n = 0
    t = 1
    do s = 1, surface%rows%n
      do while (particles%bins%key(t) /= surface%rows%key(s) .or. &
                particles%bins%last(t) < surface%rows%first(s))
        t = t + 1
      end do
      surface%row_start(s) = n + 1 - surface%rows%first(s)
      do i = surface%rows%first(s), surface%rows%last(s)
        n = n + 1
        surface%bin(n) = particles%bin_start(t) + i
      end do
    end do
  end subroutine surface_list

  !> First and last bin here of those from `first` to `last` in a row, an empty range if there are
  !! none. Asked again for the same row with a larger `first`, it goes on from where it was.
  pure subroutine surface_bins(surface, key, first, last, place, range)
    type(surface_t), intent(in) :: surface
    integer(i8), intent(in) :: key         !! of the row
    integer, intent(in) :: first, last
    integer, intent(inout) :: place
      !! interval that it was found in; 0 for a row that has not been asked for
    integer, intent(out) :: range(2)
    integer :: s, high, middle
    range = [1, 0]
    if (place == 0) then
      place = 1
      high = surface%rows%n
      do while (place <= high)
        middle = (place + high)/2
        if (surface%rows%key(middle) < key) then
          place = middle + 1
        else
          high = middle - 1
        end if
      end do
    end if
    do while (place <= surface%rows%n)
      if (surface%rows%key(place) /= key .or. surface%rows%last(place) >= first) exit
      place = place + 1
    end do
    do s = place, surface%rows%n
      if (surface%rows%key(s) /= key .or. surface%rows%first(s) > last) exit
      if (s == place) range(1) = surface%row_start(s) + max(first, surface%rows%first(s))
      range(2) = surface%row_start(s) + min(last, surface%rows%last(s))
    end do
  end subroutine surface_bins

  !> Packs the surface particles of all listed bins.
  subroutine surface_pack(surface, particles, moved, column, threads)
    type(surface_t), intent(inout) :: surface
    type(particles_t), intent(in) :: particles
    logical, intent(in) :: moved           !! particles have changed bins since the last time
    integer, intent(in) :: column          !! of the surface offset among the particles' data
    integer, intent(in) :: threads
    integer :: n
    if (surface%bins == 0) return
    if (moved .or. .not. surface%counted) call count_all(surface, particles, column, threads)
    !$omp parallel do num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(surface, particles, column) private(n)
    do n = 1, surface%bins
      if (surface%start(n + 1) == surface%start(n)) cycle
      call pack_bin(particles, surface%bin(n), column, surface%start(n), surface%x)
    end do
    !$omp end parallel do
  end subroutine surface_pack

  !> Counts the surface particles of all listed bins and makes room for them.
  subroutine count_all(surface, particles, column, threads)
    type(surface_t), intent(inout) :: surface
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: column, threads
    integer :: n
    !$omp parallel do num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(surface, particles, column) private(n)
    do n = 1, surface%bins
      surface%start(n + 1) = bin_count(particles, surface%bin(n), column)
    end do
    !$omp end parallel do
    surface%start(1) = 1
    do n = 1, surface%bins
      surface%start(n + 1) = surface%start(n) + surface%start(n + 1)
    end do
    n = surface%start(surface%bins + 1) - 1
    if (size(surface%x, 1) < n + lanes) then
      deallocate (surface%x)
      allocate (surface%x(n + n/8 + lanes, 4), source=0.0_dp)
    end if
    surface%counted = .true.
  end subroutine count_all

  !> Surface particles in a bin.
  pure function bin_count(particles, bin, column) result(n)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin, column
    integer :: n, chunk
    n = 0
    chunk = particles%first(bin)
    do while (chunk > 0)
      n = n + count(particles%b(:, column, chunk) > nowhere)
      chunk = particles%next(chunk)
    end do
  end function bin_count

  !> Writes the surface particles of a bin from row `start` of the table on.
  pure subroutine pack_bin(particles, bin, column, start, x)
    type(particles_t), intent(in) :: particles
    integer, intent(in) :: bin, column, start
    real(dp), intent(inout) :: x(:, :)
    integer :: n, l, d, chunk
    n = start - 1
    chunk = particles%first(bin)
    do while (chunk > 0)
      do l = 1, lanes
        if (particles%b(l, column, chunk) <= nowhere) cycle
        n = n + 1
        do d = 1, particles%ndim
          x(n, d) = particles%a(l, d, chunk)
        end do
        x(n, particles%ndim + 1:3) = 0.0_dp
        x(n, 4) = particles%b(l, column, chunk)
      end do
      chunk = particles%next(chunk)
    end do
  end subroutine pack_bin

end module sgmp_surface_particles
