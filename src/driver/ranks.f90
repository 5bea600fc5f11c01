!> How the ranks of a run divide a scene among them: the first cuts, the bins that stand for those
!! of neighbours.
module sgmp_ranks
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_halo, only: halo_get_bins, halo_put_bins
  use sgmp_kinds, only: dp, i8
  use sgmp_mesh, only: stencil_shift
  use sgmp_model, only: model_t
  use sgmp_neighbours, only: neighbours_receive, neighbours_send, neighbours_wait
  use sgmp_parallel, only: parallel_agree, parallel_max, parallel_sum
  use sgmp_particles, only: far_plane, particles_t, slab_t
  use sgmp_rebinning, only: particles_renew_bins
  use sgmp_rows, only: rows_t, rows_union
  use sgmp_scene, only: scene_at_rest, scene_t
  use sgmp_seeding, only: seeding_survey, survey_t
  use sgmp_share, only: share_cut, share_t
  implicit none
  private
  public :: ranks_share, ranks_slab, ranks_hold, ranks_renew_bins

contains

  !> Counts the particles plane by plane, and cuts so that ranks get as many each of those that
  !! move.
  subroutine ranks_share(scene, model, kernel, surveys, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model        !! its share is set
    integer, intent(in) :: kernel
    type(survey_t), allocatable, intent(out) :: surveys(:)  !! (bodies) of all ranks together
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: load(:)
    integer(i8), allocatable :: counts(:)
    integer :: b, low, high
    allocate (surveys(size(scene%bodies)))
    if (model%share%ranks == 1) return
    low = far_plane
    high = -far_plane
    do b = 1, size(surveys)
      call seeding_survey(scene%bodies(b), scene%grid%cell, model%mesh%origin, model%mesh%ndim, &
                          ranks_slab(model, kernel), model%share%rank, model%share%ranks, &
                          surveys(b), error)
      call parallel_agree(error)
      if (allocated(error)) return
      associate (survey => surveys(b))
        survey%points = int(parallel_sum(int(survey%points, i8)))
        survey%lowest = int(parallel_sum(int(survey%lowest, i8)))
        survey%highest = int(parallel_sum(int(survey%highest, i8)))
        if (sum(survey%points) == 0) then
          call error_make(error, exit_deck, "body '"//trim(scene%bodies(b)%name)// &
                          "' has no particles", 'use a smaller spacing or check its shapes')
          if (allocated(scene%bodies(b)%location)) error%location = scene%bodies(b)%location
          return
        end if
        if (size(survey%load) == 0 .or. scene_at_rest(scene%bodies(b))) cycle
        low = min(low, survey%first)
        high = max(high, survey%first + size(survey%load) - 1)
      end associate
    end do
    low = -nint(parallel_max(real(-low, dp)))
    high = nint(parallel_max(real(high, dp)))
    allocate (counts(low:high), source=0_i8)
    do b = 1, size(surveys)
      if (scene_at_rest(scene%bodies(b))) cycle
      associate (survey => surveys(b))
        counts(survey%first:survey%first + size(survey%load) - 1) = &
          counts(survey%first:survey%first + size(survey%load) - 1) + int(survey%load, i8)
      end associate
    end do
    load = real(parallel_sum(counts), dp)
    call share_cut(model%share, low, load)
  end subroutine ranks_share

  !> The planes of this rank, for seeding.
  pure function ranks_slab(model, kernel) result(slab)
    type(model_t), intent(in) :: model
    integer, intent(in) :: kernel
    type(slab_t) :: slab
    slab%axis = merge(model%mesh%ndim, 0, model%mesh%ndim > 1)
    if (slab%axis > 0) slab%origin = model%mesh%origin(slab%axis)
    slab%h = model%mesh%h
    slab%shift = stencil_shift(kernel)
    slab%own = model%share%own
  end function ranks_slab

  !> Tells the particles of a body which planes are theirs.
  pure subroutine ranks_hold(share, particles)
    type(share_t), intent(in) :: share
    type(particles_t), intent(inout) :: particles
    particles%own = share%own
    particles%held = share%own + [-share%bins(1), share%bins(2)]
  end subroutine ranks_hold

  !> Learns from the neighbours which bins near the cuts are occupied.
  subroutine ranks_renew_bins(model)
    type(model_t), intent(inout) :: model
    type(rows_t) :: below, above, both
    integer :: b
    if (model%share%ranks == 1) return
    associate (share => model%share, swap => model%swap)
      do b = 1, size(model%bodies)
        call halo_put_bins(model%bodies(b)%particles, [share%own(1), share%own(1) + &
                                                       share%bins(2) - 1], swap%to_below)
        call halo_put_bins(model%bodies(b)%particles, [share%own(2) - share%bins(1) + 1, &
                                                       share%own(2)], swap%to_above)
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
