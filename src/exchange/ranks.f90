!> What a rank knows of its neighbours: which planes are its own, the bins near the cuts that stand
!! for theirs, and what they say to each other.
module sgmp_ranks
  use sgmp_body, only: body_t
  use sgmp_halo, only: halo_get_bins, halo_put_bins
  use sgmp_kinds, only: dp, i8
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_t, neighbours_wait, &
                             traffic_t
  use sgmp_particles, only: particles_t
  use sgmp_partition, only: partition_t
  use sgmp_plan, only: workspace_t
  use sgmp_rebinning, only: particles_renew_bins
  use sgmp_rows, only: rows_t, rows_union
  implicit none
  private
  public :: balance_t, ranks_t, ranks_hold, ranks_renew_bins

  !> Looks at the loads of the ranks.
  type :: balance_t
    integer :: cuts = 0                !! times the cuts were moved
    integer(i8) :: moved = 0_i8        !! particles that changed ranks for it
    real(dp) :: imbalance = 1.0_dp     !! most moving particles of a rank over the mean, last look
    real(dp) :: largest = 1.0_dp       !! the largest of all looks
  end type balance_t

  !> This rank among the others.
  type :: ranks_t
    type(partition_t) :: partition     !! planes that this rank owns
    type(balance_t) :: balance         !! how evenly, and what was done about it
    type(neighbours_t) :: messages     !! to and from the neighbours
    type(traffic_t) :: traffic         !! sent so far
    type(workspace_t), allocatable :: below(:), above(:)  !! (fields) sums that neighbours sent
  end type ranks_t

contains

  !> Tells the particles of a body which planes are theirs.
  pure subroutine ranks_hold(partition, particles)
    type(partition_t), intent(in) :: partition
    type(particles_t), intent(inout) :: particles
    particles%own = partition%own
    particles%held = partition%own + [-partition%bins(1), partition%bins(2)]
  end subroutine ranks_hold

  !> Learns from the neighbours which bins near the cuts are occupied.
  subroutine ranks_renew_bins(ranks, bodies)
    type(ranks_t), intent(inout) :: ranks
    type(body_t), intent(inout) :: bodies(:)
    type(rows_t) :: below, above, both
    integer :: b
    if (ranks%partition%ranks == 1) return
    associate (own => ranks%partition%own, bins => ranks%partition%bins, &
               messages => ranks%messages)
      do b = 1, size(bodies)
        call halo_put_bins(bodies(b)%particles, [own(1), own(1) + bins(2) - 1], messages%to_below)
        call halo_put_bins(bodies(b)%particles, [own(2) - bins(1) + 1, own(2)], messages%to_above)
      end do
      call neighbours_send(messages, ranks%traffic)
      call neighbours_receive(messages)
      do b = 1, size(bodies)
        call halo_get_bins(messages%from_below, below)
        call halo_get_bins(messages%from_above, above)
        call rows_union(below, above, both)
        call particles_renew_bins(bodies(b)%particles, both)
      end do
      call neighbours_wait(messages)
    end associate
  end subroutine ranks_renew_bins

end module sgmp_ranks
