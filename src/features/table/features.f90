!> What the cards of features say, one component for each that has a place of its own: the scene, the
!! method and the plans of sweeps hand it on whole. What features share beside it is here, too.
module sgmp_features
  use sgmp_kinds, only: dp
  use sgmp_splitting_type, only: splitting_t
  use sgmp_sums, only: sum_features
  implicit none
  private
  public :: features_t, features_remedy_stretched
  public :: sum_split

  !> Features; by default there is none of them.
  type :: features_t
    type(splitting_t) :: splitting
  end type features_t

  ! Entries of the sums over particles that features have.
  integer, parameter :: sum_split = sum_features   !! kinetic energy of the halves of particles apart

contains

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
