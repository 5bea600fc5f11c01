!> Takes particles out of a bin and puts others in; their order by id stays.
module sgmp_bin_change
  use sgmp_kinds, only: lanes
  use sgmp_movers, only: movers_free_chunk, movers_t
  use sgmp_particles, only: chunk_pad, particles_t
  implicit none
  private
  public :: bin_close, bin_insert

contains

  !> Moves the particles of a bin up to the front of its chain, over those whose id is 0: they have
  !! left. Chunks that are no longer needed are noted beside the movers.
  pure subroutine bin_close(particles, bin, movers)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin
    type(movers_t), intent(inout) :: movers
    integer :: c, l, left, to_c, to_l, live
    c = particles%first(bin)
    to_c = c
    to_l = 0
    live = 0
    left = particles%size(bin)
    do while (left > 0)
      do l = 1, min(left, lanes)
        if (particles%id(l, c) == 0) cycle
        if (to_l == lanes) then
          to_c = particles%next(to_c)
          to_l = 0
        end if
        to_l = to_l + 1
        live = live + 1
        if (to_c /= c .or. to_l /= l) call copy_lane(particles, l, c, to_l, to_c)
      end do
      left = left - lanes
      c = particles%next(c)
    end do
    call cut_chain(particles, bin, live, to_c, to_l, movers)
  end subroutine bin_close

  !> Ends a bin's chain behind its last particle.
  pure subroutine cut_chain(particles, bin, live, chunk, lane, movers)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin, live   !! particles that are left
    integer, intent(in) :: chunk, lane  !! of the last of them
    type(movers_t), intent(inout) :: movers
    integer :: c, next
    particles%size(bin) = live
    if (live == 0) then
      c = particles%first(bin)
      particles%first(bin) = 0
    else
      c = particles%next(chunk)
      particles%next(chunk) = 0
      call chunk_pad(particles, chunk, lane + 1)
    end if
    do while (c > 0)
      next = particles%next(c)
      particles%id(:, c) = 0
      call movers_free_chunk(movers, c)
      c = next
    end do
  end subroutine cut_chain

  pure subroutine copy_lane(particles, from_lane, from_chunk, to_lane, to_chunk)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: from_lane, from_chunk, to_lane, to_chunk
    integer :: q
    do q = 1, particles%motion_columns
      particles%motion(to_lane, q, to_chunk) = particles%motion(from_lane, q, from_chunk)
    end do
    do q = 1, particles%state_columns
      particles%state(to_lane, q, to_chunk) = particles%state(from_lane, q, from_chunk)
    end do
    particles%id(to_lane, to_chunk) = particles%id(from_lane, from_chunk)
  end subroutine copy_lane

  !> Merges movers into a bin, from its end on, so that nobody moves twice.
  pure subroutine bin_insert(particles, bin, lists, list, at, taken, used)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin
    type(movers_t), intent(in) :: lists(:)
    integer, intent(in) :: list(:), at(:)        !! the movers, by ascending id
    integer, intent(in) :: taken(:)              !! chunks for use
    integer, intent(inout) :: used               !! of them, so far
    integer :: chain(0:(particles%size(bin) + size(at) - 1)/lanes), n, r, t, l, c
    call lengthen_chain(particles, bin, taken, used, chain)
    n = particles%size(bin)
    particles%size(bin) = n + size(at)
    r = size(at)
    do t = n + r, 1, -1
      if (r == 0) exit
      l = mod(t - 1, lanes) + 1
      c = chain((t - 1)/lanes)
      if (comes_later(n, lists(list(r)), at(r))) then
        call copy_lane(particles, mod(n - 1, lanes) + 1, chain((n - 1)/lanes), l, c)
        n = n - 1
      else
        call put_mover(particles, lists(list(r)), at(r), l, c)
        r = r - 1
      end if
    end do
    t = particles%size(bin)
    if (used > 0 .and. mod(t, lanes) > 0) then
      if (chain(ubound(chain, 1)) == taken(used)) then
        call chunk_pad(particles, taken(used), mod(t, lanes) + 1)
      end if
    end if

  contains

    !> Whether the last particle of the bin, if there is one left, stands behind a mover.
    pure function comes_later(last, movers, m) result(yes)
      integer, intent(in) :: last, m
      type(movers_t), intent(in) :: movers
      logical :: yes
      integer :: lane, chunk
      yes = .false.
      if (last == 0) return
      lane = mod(last - 1, lanes) + 1
      chunk = chain((last - 1)/lanes)
      yes = particles%id(lane, chunk) > movers%id(m)
      if (particles%id(lane, chunk) == movers%id(m)) then  ! both come from one that was split
        yes = particles%state(lane, particles%path, chunk) > &
              movers%particle(particles%motion_columns + particles%path, m)
      end if
    end function comes_later

  end subroutine bin_insert

  !> Appends chunks to a bin until its chain is as long as `chain`, which lists them all.
  pure subroutine lengthen_chain(particles, bin, taken, used, chain)
    type(particles_t), intent(inout) :: particles
    integer, intent(in) :: bin
    integer, intent(in) :: taken(:)
    integer, intent(inout) :: used
    integer, intent(out) :: chain(0:)
    integer :: t
    do t = 0, ubound(chain, 1)
      if (t == 0) then
        chain(t) = particles%first(bin)
      else
        chain(t) = particles%next(chain(t - 1))
      end if
      if (chain(t) > 0) cycle
      used = used + 1
      chain(t) = taken(used)
      if (t == 0) then
        particles%first(bin) = chain(t)
      else
        particles%next(chain(t - 1)) = chain(t)
      end if
    end do
  end subroutine lengthen_chain

  pure subroutine put_mover(particles, movers, m, lane, chunk)
    type(particles_t), intent(inout) :: particles
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: m, lane, chunk
    integer :: q
    do q = 1, particles%motion_columns
      particles%motion(lane, q, chunk) = movers%particle(q, m)
    end do
    do q = 1, particles%state_columns
      particles%state(lane, q, chunk) = movers%particle(particles%motion_columns + q, m)
    end do
    particles%id(lane, chunk) = movers%id(m)
  end subroutine put_mover

end module sgmp_bin_change
