!> Which planes of the grid each rank owns.
!!
!! Ranks own consecutive slabs of planes along the slowest axis, as threads do inside a rank. A rank
!! also holds a few planes of its neighbours: the moments that its gathers touch, and the bins whose
!! particles give to those.
module sgmp_share
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, stencil_width, wall_free
  use sgmp_particles, only: far_plane
  use sgmp_transfer_kinds, only: kernel_mpm, kernel_sgmp
  implicit none
  private
  public :: share_t, share_make, share_cut, share_set, share_owner, share_loads, share_imbalance

  integer, parameter :: bisections = 60

  !> The cuts, and what this rank holds on either side of its own.
  type :: share_t
    integer :: rank = 0, ranks = 1
    integer, allocatable :: cuts(:)    !! (ranks + 1): rank r owns cuts(r + 1)..cuts(r + 2) - 1
    integer :: own(2) = [-far_plane, far_plane]   !! first and last plane of this rank
    integer :: moments(2) = 0          !! planes of moments held below and above the own ones
    integer :: bins(2) = 0             !! planes of bins held below and above
    integer :: nodes = 0               !! planes of nodes above the own ones that particles read
    integer :: least = 1               !! planes that a rank must own
    integer :: allowed(2) = [-far_plane, far_plane]  !! between these planes cuts may lie
    logical :: divisible = .true.      !! false in 1D, where there is one plane
  end type share_t

contains

  !> The widths that a method needs, and where walls allow cuts; all planes go to the first rank.
  pure subroutine share_make(share, mesh, kernel, normalised, divisible, rank, ranks)
    type(share_t), intent(out) :: share
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel            !! one of kernel_*
    logical, intent(in) :: normalised        !! stresses are scaled by the volumes of neighbours
    logical, intent(in) :: divisible         !! planes may go to other ranks than the first
    integer, intent(in) :: rank, ranks
    integer :: layers, more, r
    share%rank = rank
    share%ranks = ranks
    share%divisible = divisible
    layers = stencil_width(kernel)
    more = merge(1, 0, normalised)
    if (kernel == kernel_sgmp) share%moments(1) = 1 + more
    share%moments(2) = merge(1, 2 + more, kernel == kernel_mpm)
    share%nodes = merge(1, 2, kernel == kernel_mpm)
    share%bins = share%moments + [layers - 1, 0]
    share%least = max(share%bins(1), share%bins(2)) + 1
    ! A wall's fold and mirror images must be inside what one rank holds completely.
    if (mesh%wall(1, mesh%ndim) /= wall_free) then
      share%allowed(1) = mesh%lower(mesh%ndim) + share%least + 1
    end if
    if (mesh%wall(2, mesh%ndim) /= wall_free) then
      share%allowed(2) = mesh%upper(mesh%ndim) - share%least - 1
    end if
    allocate (share%cuts(ranks + 1))
    share%cuts = [-far_plane, (far_plane/2 + r*share%least, r=1, ranks - 1), far_plane + 1]
    call share_set(share)
  end subroutine share_make

  !> Puts the own planes where the cuts say.
  pure subroutine share_set(share)
    type(share_t), intent(inout) :: share
    share%own = [share%cuts(share%rank + 1), share%cuts(share%rank + 2) - 1]
  end subroutine share_set

  !> Cuts that make the largest load of a rank as small as whole planes allow.
  !!
  !! Ranks that find no planes get empty ones beyond the last.
  pure subroutine share_cut(share, first, load)
    type(share_t), intent(inout) :: share
    integer, intent(in) :: first       !! first plane with a load
    real(dp), intent(in) :: load(:)    !! of consecutive planes, >= 0
    real(dp) :: low, high, middle
    integer :: step
    logical :: fits
    if (share%ranks == 1 .or. .not. share%divisible .or. size(load) == 0) return
    low = 0.0_dp
    high = sum(load)*(1.0_dp + 1.0e-9_dp)
    do step = 1, bisections
      middle = 0.5_dp*(low + high)
      call fill(share, first, load, middle, fits)
      if (fits) then
        high = middle
      else
        low = middle
      end if
    end do
    call fill(share, first, load, high, fits)
    call share_set(share)
  end subroutine share_cut

  !> Cuts from the first plane on, each rank taking as much as `most` allows; whether that suffices.
  pure subroutine fill(share, first, load, most, fits)
    type(share_t), intent(inout) :: share
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
      if (k == share%allowed(2)) wanted = taken + sum(load(k - first + 1:)) > most  ! last chance
      if (wanted .and. r < share%ranks .and. k - begin >= share%least .and. &
          k >= share%allowed(1) .and. k <= share%allowed(2)) then
        r = r + 1
        share%cuts(r) = k
        begin = k
        taken = 0.0_dp
      end if
      taken = taken + load(k - first + 1)
      fits = fits .and. taken <= most
    end do
    beyond = first + size(load) + 2*share%least
    if (share%allowed(2) < far_plane) beyond = max(beyond, share%allowed(2) + 4*share%least)
    do k = r + 1, share%ranks
      share%cuts(k) = beyond + (k - r)*share%least
    end do
  end subroutine fill

  !> The rank that owns a plane.
  pure function share_owner(share, plane) result(rank)
    type(share_t), intent(in) :: share
    integer, intent(in) :: plane
    integer :: rank, low, high, middle
    low = 1
    high = share%ranks
    do while (low < high)
      middle = (low + high + 1)/2
      if (share%cuts(middle) <= plane) then
        low = middle
      else
        high = middle - 1
      end if
    end do
    rank = low - 1
  end function share_owner

  !> Load of every rank.
  pure function share_loads(share, first, load) result(loads)
    type(share_t), intent(in) :: share
    integer, intent(in) :: first
    real(dp), intent(in) :: load(:)
    real(dp) :: loads(share%ranks)
    integer :: k, r
    loads = 0.0_dp
    do k = 1, size(load)
      r = 1 + share_owner(share, first + k - 1)
      loads(r) = loads(r) + load(k)
    end do
  end function share_loads

  !> Largest load over the mean, 1 where there is none.
  pure function share_imbalance(loads) result(ratio)
    real(dp), intent(in) :: loads(:)
    real(dp) :: ratio
    ratio = 1.0_dp
    if (sum(loads) > 0.0_dp) ratio = maxval(loads)*size(loads)/sum(loads)
  end function share_imbalance

end module sgmp_share
