!> The first partition of a scene among the ranks, found by counting particles before any is made.
module sgmp_first_partition
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kernels, only: stencil_shift
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_max, parallel_sum
  use sgmp_partition, only: partition_cut
  use sgmp_scene, only: scene_at_rest, scene_t
  use sgmp_seeding, only: seeding_survey, survey_t
  use sgmp_slabs, only: far_plane, slab_t
  implicit none
  private
  public :: partition_first, partition_slab

contains

  !> Counts the particles plane by plane, and cuts so that ranks get as many each of those that
  !! move.
  subroutine partition_first(scene, model, kernel, surveys, error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model        !! its share is set
    integer, intent(in) :: kernel
    type(survey_t), allocatable, intent(out) :: surveys(:)  !! (bodies) of all ranks together
    type(error_t), allocatable, intent(out) :: error
    real(dp), allocatable :: load(:)
    integer(i8), allocatable :: counts(:)
    integer :: b, low, high
    allocate (surveys(size(scene%bodies)))
    if (model%ranks%partition%ranks == 1) return
    low = far_plane
    high = -far_plane
    do b = 1, size(surveys)
      call seeding_survey(scene%bodies(b), scene%grid%cell, model%mesh%origin, model%mesh%ndim, &
                          partition_slab(model, kernel), model%ranks%partition%rank, &
                            model%ranks%partition%ranks, &
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
    call partition_cut(model%ranks%partition, low, load)
  end subroutine partition_first

  !> The planes of this rank, for seeding.
  pure function partition_slab(model, kernel) result(slab)
    type(model_t), intent(in) :: model
    integer, intent(in) :: kernel
    type(slab_t) :: slab
    slab%axis = merge(model%mesh%ndim, 0, model%mesh%ndim > 1)
    if (slab%axis > 0) slab%origin = model%mesh%origin(slab%axis)
    slab%h = model%mesh%h
    if (slab%axis > 0) slab%graded = model%mesh%axes(slab%axis)
    slab%shift = stencil_shift(kernel)
    slab%own = model%ranks%partition%own
  end function partition_slab

end module sgmp_first_partition
