!> What a rank knows of its neighbours: which planes are its own, and the bins near the cuts that
!! stand for theirs.
module sgmp_ranks
  use sgmp_halo, only: halo_get_bins, halo_put_bins
  use sgmp_model, only: model_t
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_particles, only: particles_t
  use sgmp_partition, only: partition_t
  use sgmp_rebinning, only: particles_renew_bins
  use sgmp_rows, only: rows_t, rows_union
  implicit none
  private
  public :: ranks_hold, ranks_renew_bins

contains

  !> Tells the particles of a body which planes are theirs.
  pure subroutine ranks_hold(partition, particles)
    type(partition_t), intent(in) :: partition
    type(particles_t), intent(inout) :: particles
    particles%own = partition%own
    particles%held = partition%own + [-partition%bins(1), partition%bins(2)]
  end subroutine ranks_hold

  !> Learns from the neighbours which bins near the cuts are occupied.
  subroutine ranks_renew_bins(model)
    type(model_t), intent(inout) :: model
    type(rows_t) :: below, above, both
    integer :: b
    if (model%partition%ranks == 1) return
    associate (partition => model%partition, swap => model%swap)
      do b = 1, size(model%bodies)
        call halo_put_bins(model%bodies(b)%particles, [partition%own(1), partition%own(1) + &
                                                       partition%bins(2) - 1], swap%to_below)
        call halo_put_bins(model%bodies(b)%particles, [partition%own(2) - partition%bins(1) + 1, &
                                                       partition%own(2)], swap%to_above)
      end do
      call neighbours_send(swap, model%traffic)
      call neighbours_receive(swap)
      do b = 1, size(model%bodies)
        call halo_get_bins(swap%from_below, below)
        call halo_get_bins(swap%from_above, above)
        call rows_union(below, above, both)
        call particles_renew_bins(model%bodies(b)%particles, both)
      end do
      call neighbours_wait(swap)
    end associate
  end subroutine ranks_renew_bins

end module sgmp_ranks
