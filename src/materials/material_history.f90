!> What particles keep besides place, velocity and mass: the columns of their second stream. The
!! only place that knows all of them.
!!
!! A law ticks what it wants in `history_t`; features ask by name (slots_ask). First columns, first
!! values, fields of output, columns of particle files, names in checkpoints and what `--check` says
!! follow from the table and the list. A new column is a row of `kept_columns`, a component of
!! `slots_t` with its line in `name_slots`, where kernels read it, and where a law wants it a flag
!! and its line in `slots_ask_history`.
module sgmp_material_history
  use sgmp_averaging, only: averaging_values
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: history_t, kept_columns, kept_t, slot_t, slots_t
  public :: slots_ask, slots_ask_history, slots_column, slots_first_values

  integer, parameter :: name_length = 16

  !> A column that may be asked for.
  type :: kept_t
    character(name_length) :: name   !! in output and checkpoints
    logical :: written               !! it is a field of output by this name
    logical :: given                 !! a particle file may give it
    character(60) :: said            !! by --check: what it is, and who asks for it; blank: nothing
  end type kept_t

  type(kept_t), parameter :: kept_columns(*) = [ &
    kept_t('stress', .false., .false., 'stress components (dimension, material)'), &
    kept_t('plastic_strain', .true., .true., 'plastic strain (material)'), &
    kept_t('temperature', .true., .true., 'temperature (material with thermal softening)'), &
    kept_t('damage', .true., .true., 'damage (failure, material)'), &
    kept_t('energy', .true., .true., 'internal energy (eos, erode)'), &
    kept_t('distention', .true., .true., 'distention (eos)'), &
    kept_t('pore_shift', .false., .true., 'shift of the curve of elastic pores (eos pore_speed)'), &
    kept_t('bulking', .true., .true., 'bulking pressure (material)'), &
    kept_t('compaction', .true., .true., 'greatest compression (material)'), &
    kept_t('preconsolidation', .true., .true., 'preconsolidation (material)'), &
    kept_t('lighting_time', .true., .true., 'lighting time (explosive, detonation)'), &
    kept_t('afterburnt', .true., .true., 'part of the afterburn that is given (eos afterburn)'), &
    kept_t('deformation', .false., .false., 'deformation gradient (neo-Hookean material)'), &
    kept_t('stretch', .false., .false., &
           'diagonal of the deformation gradient (method cpgimp, split)'), &
    kept_t('initial', .false., .false., 'initial position (bodyforce or load that uses it)'), &
    kept_t('reference', .false., .false., &
           'first place and deformation gradient (frame=reference)'), &
    kept_t('surface', .false., .false., ''), &
    kept_t('patch', .false., .false., 'patch of the first position (contact self=yes)'), &
    kept_t('swirl', .false., .false., &
           'velocity around the axis (dimension axisymmetric swirl=yes)'), &
    kept_t('strength', .true., .true., 'strength (failure weibull)'), &
    kept_t('yield_factor', .true., .true., 'factor of the yield stress (material yield_weibull)'), &
    kept_t('compliance', .false., .false., 'compliance (volumes=kept, eos)'), &
    kept_t('advanced_energy', .false., .false., 'energy of debris paid in advance (failure)'), &
    kept_t('viscous_pressure', .false., .false., 'viscous pressure of debris (failure)'), &
    kept_t('reach', .false., .false., 'wave and particle speed (erode time_step, update=usf)'), &
    kept_t('averaged_strain', .true., .false., 'averaged plastic strain (failure length)'), &
    kept_t('averaging', .false., .false., &
           'average, its rate, and what it drove (failure length)'), &
    kept_t('flaw_strain', .true., .false., 'strain of the weakest flaw (failure flaws)'), &
    kept_t('flaw_radius', .false., .false., 'radius of the particle (failure flaws)'), &
    kept_t('path', .true., .false., 'path from the particle that was split (split)'), &
    kept_t('grip', .false., .false., 'face at walls that let go (wall)')]

  !> Columns that a law wants besides volume and stress, with their first values where not 0.
  type :: history_t
    logical :: mean_stress = .false.    !! a fluid: the mean stress in place of the tensor
    logical :: plastic = .false.        !! equivalent plastic strain
    logical :: temperature = .false.
    logical :: damage = .false.
    logical :: energy = .false.         !! internal energy per initial volume
    logical :: distention = .false.     !! of porous material
    logical :: pore_shift = .false.     !! of elastic pores
    logical :: bulking = .false.        !! pressure of broken ceramics
    logical :: compaction = .false.     !! greatest compression of concrete
    logical :: preconsolidation = .false.  !! of clays
    logical :: lighting = .false.       !! lighting time of an explosive
    logical :: afterburnt = .false.     !! part of the afterburn of products
    logical :: deformation = .false.    !! deformation gradient
    logical :: averaged = .false.       !! plastic strain averaged over a length
    real(dp) :: first_temperature = 0.0_dp
    real(dp) :: first_energy = 0.0_dp
    real(dp) :: first_distention = 1.0_dp
    real(dp) :: first_mean_stress = 0.0_dp
  end type history_t

  !> Columns next to each other that something has asked for.
  type :: slot_t
    character(name_length) :: name = ''
    integer :: first = 0                 !! its first column
    real(dp), allocatable :: start(:)    !! first values
  end type slot_t

  !> Columns of the particles' second stream; 0: not stored, because nothing of the scene uses it.
  type :: slots_t
    integer :: volume = 1        !! current volume
    integer :: stress = 0        !! first of the stress components (or the mean stress alone)
    integer :: stresses = 0      !! how many
    integer :: plastic = 0       !! equivalent plastic strain
    integer :: temperature = 0
    integer :: damage = 0
    integer :: energy = 0        !! internal energy per initial volume, for an equation of state
    integer :: distention = 0    !! of porous material, behind the energy
    integer :: pore_shift = 0    !! of the curve of elastic pores, behind the distention
    integer :: bulking = 0       !! pressure of broken ceramics
    integer :: compaction = 0    !! greatest compression of concrete
    integer :: preconsolidation = 0  !! of clays
    integer :: lighting = 0      !! lighting time of an explosive
    integer :: afterburnt = 0    !! part of the afterburn that is given
    integer :: deformation = 0   !! deformation gradient, row by row
    integer :: stretch = 0       !! its diagonal alone, for cpGIMP and to split particles
    integer :: initial = 0       !! initial position, for body forces that use it
    integer :: reference = 0     !! first place (cells), then the deformation gradient row by row
    integer :: swirl = 0         !! velocity around the axis times radius (cells)
    integer :: surface = 0       !! distance to the body's surface, for contact
    integer :: patch = 0         !! of the first position, where a body touches itself
    integer :: compliance = 0    !! by which volume is exchanged, for kept volumes
    integer :: strength = 0      !! factor on the limits of failure, where they scatter
    integer :: yield_factor = 0  !! factor on the yield stress, where it scatters
    integer :: advanced = 0      !! debris: energy taken for its stress before that has acted
    integer :: viscous = 0       !! debris: viscous pressure that acts next; negative: settled
    integer :: reach = 0         !! c + |v| of the stress update before the kick, for erosion
    integer :: averaged = 0      !! largest averaged plastic strain so far
    integer :: averaging = 0     !! average, its rate, and what of that peak drove something
    integer :: flaw_strain = 0   !! at which the weakest flaw grows
    integer :: flaw_radius = 0   !! of a ball as large as the particle at the start
    integer :: path = 0          !! from the particle that it comes from, where particles are split:
                                 !! 1, and of the halves of b 2 b and 2 b + 1
    integer :: total = 1
    type(slot_t), allocatable :: list(:)  !! behind the volume, in the order of columns
  end type slots_t

contains

  !> Asks for columns, as many as there are first values: they come in the order of the table, and
  !! those that are not in it behind all others. What is there already is not asked for again.
  pure subroutine slots_ask(slots, name, start)
    type(slots_t), intent(inout) :: slots
    character(*), intent(in) :: name
    real(dp), intent(in) :: start(:)
    type(slot_t), allocatable :: list(:)
    integer :: n, i
    if (size(start) == 0 .or. slots_column(slots, name) > 0) return
    if (.not. allocated(slots%list)) allocate (slots%list(0))
    n = count([(rank_of(slots%list(i)%name) <= rank_of(name), i=1, size(slots%list))])
    allocate (list(size(slots%list) + 1))
    do i = 1, size(slots%list)
      list(merge(i, i + 1, i <= n)) = slots%list(i)
    end do
    list(n + 1)%name = name
    list(n + 1)%start = start
    call move_alloc(list, slots%list)
    slots%total = 1  ! the volume
    do i = 1, size(slots%list)
      slots%list(i)%first = slots%total + 1
      slots%total = slots%total + size(slots%list(i)%start)
    end do
    call name_slots(slots)
  end subroutine slots_ask

  !> Row of the table, one beyond its end where the name is not in it.
  pure integer function rank_of(name) result(rank)
    character(*), intent(in) :: name
    rank = findloc(kept_columns%name == name, .true., 1)
    if (rank == 0) rank = size(kept_columns) + 1
  end function rank_of

  !> Asks for what a law wants.
  pure subroutine slots_ask_history(slots, wants, ndim, stresses)
    type(slots_t), intent(inout) :: slots
    type(history_t), intent(in) :: wants
    integer, intent(in) :: ndim        !! of the deformation
    integer, intent(in) :: stresses    !! components
    real(dp), parameter :: none(1) = 0.0_dp
    integer :: d
    call slots_ask(slots, 'stress', [(merge(wants%first_mean_stress, 0.0_dp, d <= 3), &
                                      d=1, stresses)])
    if (wants%plastic) call slots_ask(slots, 'plastic_strain', none)
    if (wants%temperature) call slots_ask(slots, 'temperature', [wants%first_temperature])
    if (wants%damage) call slots_ask(slots, 'damage', none)
    if (wants%energy) call slots_ask(slots, 'energy', [wants%first_energy])
    if (wants%distention) call slots_ask(slots, 'distention', [wants%first_distention])
    if (wants%pore_shift) call slots_ask(slots, 'pore_shift', none)
    if (wants%bulking) call slots_ask(slots, 'bulking', none)
    if (wants%compaction) call slots_ask(slots, 'compaction', none)
    if (wants%preconsolidation) call slots_ask(slots, 'preconsolidation', none)
    if (wants%averaged) then
      call slots_ask(slots, 'averaged_strain', none)
      call slots_ask(slots, 'averaging', [(0.0_dp, d=1, averaging_values)])
    end if
    if (wants%lighting) call slots_ask(slots, 'lighting_time', none)
    if (wants%afterburnt) call slots_ask(slots, 'afterburnt', none)
    if (wants%deformation) then
      call slots_ask(slots, 'deformation', [(merge(1.0_dp, 0.0_dp, mod(d, ndim + 1) == 0), &
                                             d=0, ndim**2 - 1)])
    end if
  end subroutine slots_ask_history

  !> The places of those that kernels and others ask for by name.
  pure subroutine name_slots(slots)
    type(slots_t), intent(inout) :: slots
    slots%stress = slots_column(slots, 'stress')
    slots%plastic = slots_column(slots, 'plastic_strain')
    slots%temperature = slots_column(slots, 'temperature')
    slots%damage = slots_column(slots, 'damage')
    slots%energy = slots_column(slots, 'energy')
    slots%distention = slots_column(slots, 'distention')
    slots%pore_shift = slots_column(slots, 'pore_shift')
    slots%bulking = slots_column(slots, 'bulking')
    slots%compaction = slots_column(slots, 'compaction')
    slots%preconsolidation = slots_column(slots, 'preconsolidation')
    slots%lighting = slots_column(slots, 'lighting_time')
    slots%afterburnt = slots_column(slots, 'afterburnt')
    slots%deformation = slots_column(slots, 'deformation')
    slots%stretch = slots_column(slots, 'stretch')
    slots%initial = slots_column(slots, 'initial')
    slots%reference = slots_column(slots, 'reference')
    slots%swirl = slots_column(slots, 'swirl')
    slots%surface = slots_column(slots, 'surface')
    slots%patch = slots_column(slots, 'patch')
    slots%compliance = slots_column(slots, 'compliance')
    slots%strength = slots_column(slots, 'strength')
    slots%yield_factor = slots_column(slots, 'yield_factor')
    slots%advanced = slots_column(slots, 'advanced_energy')
    slots%viscous = slots_column(slots, 'viscous_pressure')
    slots%reach = slots_column(slots, 'reach')
    slots%averaged = slots_column(slots, 'averaged_strain')
    slots%averaging = slots_column(slots, 'averaging')
    slots%flaw_strain = slots_column(slots, 'flaw_strain')
    slots%flaw_radius = slots_column(slots, 'flaw_radius')
    slots%path = slots_column(slots, 'path')
    if (slots%stress > 0) slots%stresses = size(slots%list(1)%start)
  end subroutine name_slots

  !> First column of a name, 0 where nothing has asked for it.
  pure function slots_column(slots, name) result(column)
    type(slots_t), intent(in) :: slots
    character(*), intent(in) :: name
    integer :: column, i
    column = 0
    if (name == 'volume') column = slots%volume
    if (.not. allocated(slots%list)) return
    do i = 1, size(slots%list)
      if (slots%list(i)%name == name) column = slots%list(i)%first
    end do
  end function slots_column

  !> First values of the columns behind the volume.
  pure function slots_first_values(slots) result(first)
    type(slots_t), intent(in) :: slots
    real(dp) :: first(2:slots%total)
    integer :: i
    first = 0.0_dp
    if (.not. allocated(slots%list)) return
    do i = 1, size(slots%list)
      associate (slot => slots%list(i))
        first(slot%first:slot%first + size(slot%start) - 1) = slot%start
      end associate
    end do
  end function slots_first_values

end module sgmp_material_history
