!> Which planes of the grid each rank owns.
!!
!! Ranks own consecutive slabs of planes along the slowest axis, as threads do inside a rank. A rank
!! also holds a few planes of its neighbours: the moments that its gathers touch, and the bins whose
!! particles give to those.
module sgmp_partition
  use sgmp_kernels, only: kernel_centred, stencil_reach, stencil_width
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_slabs, only: far_plane
  implicit none
  private
  public :: partition_t, partition_make, partition_cut, partition_owner, &
    partition_loads, partition_imbalance

  integer, parameter :: bisections = 60

  !> The cuts, and what this rank holds on either side of its own.
  type :: partition_t
    integer :: rank = 0, ranks = 1
    integer, allocatable :: cuts(:)    !! (ranks + 1): rank r owns cuts(r + 1)..cuts(r + 2) - 1
    integer :: own(2) = [-far_plane, far_plane]   !! first and last plane of this rank
    integer :: moments(2) = 0          !! planes of moments held below and above the own ones
    integer :: bins(2) = 0             !! planes of bins held below and above
    integer :: nodes = 0               !! planes of nodes above the own ones that particles read
    integer :: least = 1               !! planes that a rank must own
    integer :: allowed(2) = [-far_plane, far_plane]  !! between these planes cuts may lie
    logical :: divisible = .true.      !! false in 1D, where there is one plane
  end type partition_t

contains

  !> The widths that a method needs, and where walls allow cuts; all planes go to the first rank.
  pure subroutine partition_make(partition, mesh, kernel, normalised, divisible, rank, ranks, &
    rotation, paired, consistent)
    type(partition_t), intent(out) :: partition
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel            !! one of kernel_*
    logical, intent(in) :: normalised        !! stresses are scaled by the volumes of neighbours
    logical, intent(in) :: divisible         !! planes may go to other ranks than the first
    integer, intent(in) :: rank, ranks
    logical, intent(in), optional :: rotation  !! velocities and forces are corrected by neighbours'
    logical, intent(in), optional :: paired    !! strains and forces at centres, by neighbours'
    logical, intent(in), optional :: consistent  !! nodes know of the places of those next to them
    logical :: turns
    integer :: more, r
    turns = .false.
    partition%rank = rank
    partition%ranks = ranks
    partition%divisible = divisible
    more = merge(1, 0, normalised)
    partition%nodes = stencil_reach(kernel)
    ! Nodes need the centres below them, too.
    partition%moments = [merge(1 + more, 0, kernel_centred(kernel)), partition%nodes + more]
    if (present(rotation)) then
      ! The force at a node takes the moments of nodes next to it, and these the masses of centres
      ! up to two cells from there, and above them their pairs with the next.
      turns = rotation
      if (rotation) partition%moments = [3, partition%nodes + 3]
    end if
    if (present(paired)) then
      ! The force at a node takes stresses up to two cells from the centres around it.
      if (paired) partition%moments = partition%moments + [1, merge(0, 1, turns)]
    end if
    if (present(consistent)) then
      if (consistent .and. turns) partition%moments = partition%moments + 1
    end if
    partition%bins = partition%moments + [stencil_width(kernel) - 1, 0]
    partition%least = max(partition%bins(1), partition%bins(2)) + 1
    ! A wall's fold and mirror images must be inside what one rank holds completely.
    if (mesh%wall(1, mesh%ndim) /= wall_free) then
      partition%allowed(1) = mesh%lower(mesh%ndim) + partition%least + 1
    end if
    if (mesh%wall(2, mesh%ndim) /= wall_free) then
      partition%allowed(2) = mesh%upper(mesh%ndim) - partition%least - 1
    end if
    allocate (partition%cuts(ranks + 1))
    partition%cuts = [-far_plane, (far_plane/2 + r*partition%least, r=1, ranks - 1), far_plane + 1]
    call partition_set(partition)
  end subroutine partition_make

  !> Puts the own planes where the cuts say.
  pure subroutine partition_set(partition)
    type(partition_t), intent(inout) :: partition
    partition%own = [partition%cuts(partition%rank + 1), partition%cuts(partition%rank + 2) - 1]
  end subroutine partition_set

  !> Cuts that make the largest load of a rank as small as whole planes allow.
  !!
  !! Ranks that find no planes get empty ones beyond the last.
  pure subroutine partition_cut(partition, first, load)
    type(partition_t), intent(inout) :: partition
    integer, intent(in) :: first       !! first plane with a load
    real(dp), intent(in) :: load(:)    !! of consecutive planes, >= 0
    real(dp) :: low, high, middle
    integer :: step
    logical :: fits
    if (partition%ranks == 1 .or. .not. partition%divisible .or. size(load) == 0) return
    low = 0.0_dp
    high = sum(load)*(1.0_dp + 1.0e-9_dp)
    do step = 1, bisections
      middle = 0.5_dp*(low + high)
      call fill(partition, first, load, middle, fits)
      if (fits) then
        high = middle
      else
        low = middle
      end if
    end do
    call fill(partition, first, load, high, fits)
    call partition_set(partition)
  end subroutine partition_cut

  !> Cuts from the first plane on, each rank taking as much as `most` allows; whether that suffices.
  pure subroutine fill(partition, first, load, most, fits)
    type(partition_t), intent(inout) :: partition
    integer, intent(in) :: first
    real(dp), intent(in) :: load(:), most
    logical, intent(out) :: fits
    real(dp) :: taken
    integer :: r, k, begin, beyond
    logical :: wanted
    fits = .true.
    r = 1
    begin = first
    taken = 0.0_dp
    do k = first, first + size(load) - 1
      wanted = taken + load(k - first + 1) > most
      if (k == partition%allowed(2)) wanted = taken + sum(load(k - first + 1:)) > most
        ! last chance
      if (wanted .and. r < partition%ranks .and. k - begin >= partition%least .and. &
          k >= partition%allowed(1) .and. k <= partition%allowed(2)) then
        r = r + 1
        partition%cuts(r) = k
        begin = k
        taken = 0.0_dp
      end if
      taken = taken + load(k - first + 1)
      fits = fits .and. taken <= most
    end do
    beyond = first + size(load) + 2*partition%least
    if (partition%allowed(2) < far_plane) beyond = max(beyond, partition%allowed(2) + &
      4*partition%least)
    do k = r + 1, partition%ranks
      partition%cuts(k) = beyond + (k - r)*partition%least
    end do
  end subroutine fill

  !> The rank that owns a plane.
  pure function partition_owner(partition, plane) result(rank)
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: plane
    integer :: rank, low, high, middle
    low = 1
    high = partition%ranks
    do while (low < high)
      middle = (low + high + 1)/2
      if (partition%cuts(middle) <= plane) then
        low = middle
      else
        high = middle - 1
      end if
    end do
    rank = low - 1
  end function partition_owner

  !> Load of every rank.
  pure function partition_loads(partition, first, load) result(loads)
    type(partition_t), intent(in) :: partition
    integer, intent(in) :: first
    real(dp), intent(in) :: load(:)
    real(dp) :: loads(partition%ranks)
    integer :: k, r
    loads = 0.0_dp
    do k = 1, size(load)
      r = 1 + partition_owner(partition, first + k - 1)
      loads(r) = loads(r) + load(k)
    end do
  end function partition_loads

  !> Largest load over the mean, 1 where there is none.
  pure function partition_imbalance(loads) result(ratio)
    real(dp), intent(in) :: loads(:)
    real(dp) :: ratio
    ratio = 1.0_dp
    if (sum(loads) > 0.0_dp) ratio = maxval(loads)*size(loads)/sum(loads)
  end function partition_imbalance

end module sgmp_partition
