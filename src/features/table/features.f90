!> What the cards of features say, one component for each that has a place of its own: the scene,
!! the method and the plans of sweeps hand it on whole. What features share is here, too.
module sgmp_features
  use sgmp_kinds, only: dp
  use sgmp_splitting_type, only: splitting_t
  use sgmp_sums, only: nodes_features, sum_features
  use sgmp_text, only: integer_text, real_text
  use sgmp_wall_friction_type, only: wall_friction_t
  implicit none
  private
  public :: features_t, feature_memory, features_drag, features_drag_words, features_memory, &
            features_friction, features_recall, features_release, features_remedy_stretched, &
            features_split_gas, features_split_limit, &
            features_split_solids, features_split_unasked, features_walls_act
  public :: nodes_pressed, nodes_pulled, sum_split

  !> Cards of those slip walls that drag along what touches them, as errors name them.
  character(*), parameter :: features_drag_words = ', or a card wallfriction'

  integer, parameter :: feature_memory = 18  !! numbers that a checkpoint keeps of them

  !> Features; by default there is none of them.
  type :: features_t
    type(splitting_t) :: splitting
    type(wall_friction_t) :: wall_friction
    logical :: reference = .false.     !! particles see the grid from their first places
    integer :: meeting(2) = 0          !! bodies that nothing would keep apart then
  end type features_t

  !> Of a particle where the program splits it, by axes: it becomes no more than 256, 16, 8.
  integer, parameter :: few_halvings(3) = [8, 4, 3]

  ! Entries of the sums over particles that features have.
  integer, parameter :: sum_split = sum_features   !! kinetic energy of halves apart

  ! Entries of the sums over nodes that features have.
  !> First of six faces: forces that press on walls that rub, those by which such walls hold back.
  integer, parameter :: nodes_pressed = nodes_features, nodes_pulled = nodes_features + 6

contains

  !> Whether a slip wall drags along what touches it.
  pure logical function features_drag(features, side, axis) result(yes)
    type(features_t), intent(in) :: features
    integer, intent(in) :: side, axis
    yes = features%wall_friction%coefficient(side, axis) > 0.0_dp
  end function features_drag

  !> Coulomb's coefficient of a wall.
  pure real(dp) function features_friction(features, side, axis) result(coefficient)
    type(features_t), intent(in) :: features
    integer, intent(in) :: side, axis
    coefficient = features%wall_friction%coefficient(side, axis)
  end function features_friction

  !> A wall no longer drags along what touches it: it is none of the grid.
  pure subroutine features_release(features, side, axis)
    type(features_t), intent(inout) :: features
    integer, intent(in) :: side, axis
    features%wall_friction%coefficient(side, axis) = 0.0_dp
    features%wall_friction%rubs = any(features%wall_friction%coefficient > 0.0_dp)
  end subroutine features_release

  !> Whether walls do more than to hold what comes: what lies behind them is kept.
  pure logical function features_walls_act(features) result(yes)
    type(features_t), intent(in) :: features
    yes = features%wall_friction%rubs
  end function features_walls_act

  !> What a checkpoint keeps of features.
  pure function features_memory(features) result(memory)
    type(features_t), intent(in) :: features
    real(dp) :: memory(feature_memory)
    associate (friction => features%wall_friction)
      memory = [friction%share, friction%credit, friction%usual]
    end associate
  end function features_memory

  !> Takes it from a checkpoint.
  pure subroutine features_recall(features, memory)
    type(features_t), intent(inout) :: features
    real(dp), intent(in) :: memory(feature_memory)
    associate (friction => features%wall_friction)
      friction%share = reshape(memory(:6), [2, 3])
      friction%credit = reshape(memory(7:12), [2, 3])
      friction%usual = reshape(memory(13:), [2, 3])
    end associate
  end subroutine features_recall

  !> Gas that expands comes to be thin in places: where the deck leaves it open its particles do not
  !! outgrow their cells, alone in a box without end, beside other matter for a few halvings.
  pure subroutine features_split_gas(features, ndim, sides, alone)
    type(features_t), intent(inout) :: features
    integer, intent(in) :: ndim
    real(dp), intent(in) :: sides(:)             !! of the particles of each body of gas (cells)
    logical, intent(in) :: alone                 !! nothing else moves in a box
    real(dp), parameter :: whole = 1.0_dp, beside = 0.75_dp  !! cells
    real(dp) :: limit
    limit = merge(whole, beside, alone)
    if (.not. features%splitting%automatic .or. any(sides > limit)) return
    features%splitting%limit = limit
    features%splitting%liquids = alone
    features%splitting%solids = alone
    features%splitting%bounded = .not. alone
    if (.not. alone) features%splitting%halvings = few_halvings(ndim)
  end subroutine features_split_gas

  !> Solids that touch and flow along each other leave gaps where they are stretched, into which the
  !! other comes: where the deck leaves it open, their particles are split a few times.
  pure subroutine features_split_solids(features, ndim, side)
    type(features_t), intent(inout) :: features
    integer, intent(in) :: ndim
    real(dp), intent(in) :: side                 !! longest of the particles of solids (cells)
    real(dp), parameter :: longest = 0.75_dp, grown = 1.5_dp, most = 2.0_dp
    real(dp) :: limit
    associate (splitting => features%splitting)
      limit = max(longest, grown*side, splitting%limit)
      if (.not. splitting%automatic .or. limit > most) return
      splitting%gases = splitting%limit > 0.0_dp
      splitting%liquids = .false.
      splitting%solids = .true.
      splitting%limit = limit
      splitting%bounded = .true.
      splitting%halvings = few_halvings(ndim)
    end associate
  end subroutine features_split_solids

  !> Longest side of a particle that stays whole (cells); 0: all do.
  pure real(dp) function features_split_limit(features) result(limit)
    type(features_t), intent(in) :: features
    limit = features%splitting%limit
  end function features_split_limit

  !> Which particles of solids are split though the deck does not ask for it; '': none.
  pure function features_split_unasked(features) result(text)
    type(features_t), intent(in) :: features
    character(:), allocatable :: text
    text = ''
    associate (splitting => features%splitting)
      if (splitting%bounded .and. splitting%solids) then
        text = 'particles of solids longer than '//real_text(splitting%limit)//' cells are '// &
               'split, one in '//integer_text(2**splitting%halvings)// &
               ' at most (fast scene; doc/volumes.md)'
      end if
    end associate
  end function features_split_unasked

  !> What else could be done where particles have come apart; '': nothing.
  pure function features_remedy_stretched(features) result(remedy)
    type(features_t), intent(in) :: features
    character(:), allocatable :: remedy
    remedy = ''
    if (.not. features%splitting%limit > 0.0_dp .or. .not. features%splitting%solids) then
      remedy = '; method … split=0.75 splits what is stretched'
    end if
  end function features_remedy_stretched

end module sgmp_features
