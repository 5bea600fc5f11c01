!> Pairs of bodies that may touch: what their contact card says, and what has happened between them.
module sgmp_contact_pairs
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: contact_pair_t, pair_turn
  public :: normal_average, normal_first, normal_second, normal_stiffer, normal_separating, &
            normal_names

  !> Where the common normal of a pair comes from, in the order of `normal_names`.
  integer, parameter :: normal_separating = 1
    !! along the shortest line between the bodies around the node
  integer, parameter :: normal_average = 2  !! from both bodies
  integer, parameter :: normal_first = 3    !! of the pair's first body
  integer, parameter :: normal_second = 4   !! of the pair's second body
  integer, parameter :: normal_stiffer = 5  !! of the stiffer of the two
  character(10), parameter :: normal_names(*) = [character(10) :: &
    'separating', 'average', 'first', 'second', 'stiffer']

  !> Two bodies with a contact card.
  type :: contact_pair_t
    integer :: body(2) = 0
    integer :: field(2) = 0
    integer :: kind(2) = 0
      !! fields, of bodies that touch themselves the first of all labels
    real(dp) :: friction = 0.0_dp
    real(dp) :: lambda = 0.5_dp
      !! bodies touch where their particles are closer than this (cells), Eq. 86
    real(dp) :: spacing = 0.5_dp           !! of the particles, the larger of both bodies (cells)
    real(dp) :: depth = huge(1.0_dp)
      !! contact acts at nodes this near to where the bodies touch (cells)
    logical :: held(2) = .false.           !! the body moves as prescribed, as a whole
    logical :: firm(2) = .false.           !! it does, or is a solid that a liquid wets
    real(dp) :: reach = huge(1.0_dp)
      !! and this near outside of a firm body (cells)
    integer :: normal = normal_separating  !! one of normal_*, the stiffer already resolved
    integer :: family = 0
      !! of bodies that touch themselves, where both are labels of it (sgmp_self_contact)
    logical :: fills = .false.
      !! one of the fields is a fluid, which comes as near as any of its particles does
    ! what has happened since the start, vectors along the axes of output
    real(dp) :: impulse(3) = 0.0_dp        !! on the first body
    real(dp) :: angular_impulse(3) = 0.0_dp  !! on the first body, about the origin
    real(dp) :: friction_impulse(3) = 0.0_dp  !! the part of `impulse` along the surfaces
    real(dp) :: dissipation = 0.0_dp
    integer :: shared = 0, touching = 0    !! nodes in the last step: with both masses, in contact
  end type contact_pair_t

contains

  !> How one pair lies to another of the same bodies with other labels (sgmp_self_contact): 1 the
  !! same way round, -1 the other way, 0 if it is none.
  pure function pair_turn(a, b) result(turn)
    type(contact_pair_t), intent(in) :: a, b
    integer :: turn
    turn = 0
    if (all(a%kind == b%kind)) turn = 1
    if (turn == 0 .and. all(a%kind == b%kind([2, 1]))) turn = -1
    if (a%kind(1) /= a%kind(2) .or. turn == 0) return
    if (any(a%field == b%field)) return  ! of one family: the label that both have decides
    turn = merge(-1, 0, any(a%field == b%field([2, 1])))
  end function pair_turn

end module sgmp_contact_pairs
