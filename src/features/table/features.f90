!> What the cards of features say, one component for each that has a place of its own: the scene,
!! the method and the plans of sweeps hand it on whole. What features share is here, too.
module sgmp_features
  use sgmp_kinds, only: dp
  use sgmp_splitting_type, only: splitting_t
  use sgmp_sums, only: nodes_features, sum_features
  use sgmp_wall_friction_type, only: wall_friction_t
  implicit none
  private
  public :: features_t, features_drag, features_drag_words, features_remedy_stretched, &
            features_walls_act
  public :: nodes_pressed, nodes_pulled, sum_split

  !> Cards of those slip walls that drag along what touches them, as errors name them.
  character(*), parameter :: features_drag_words = ', or a card wallfriction'

  !> Features; by default there is none of them.
  type :: features_t
    type(splitting_t) :: splitting
    type(wall_friction_t) :: wall_friction
  end type features_t

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

  !> Whether walls do more than to hold what comes: what lies behind them is kept.
  pure logical function features_walls_act(features) result(yes)
    type(features_t), intent(in) :: features
    yes = features%wall_friction%rubs
  end function features_walls_act

  !> What else could be done where particles have come apart; '': nothing.
  pure function features_remedy_stretched(features) result(remedy)
    type(features_t), intent(in) :: features
    character(:), allocatable :: remedy
    remedy = ''
    if (.not. features%splitting%limit > 0.0_dp) then
      remedy = '; method … split=0.75 splits what is stretched'
    end if
  end function features_remedy_stretched

end module sgmp_features
