!> What the card `method` says about splitting.
module sgmp_splitting_type
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: splitting_t

  !> Particles that are stretched too far are split (doc/volumes.md, 5).
  type :: splitting_t
    real(dp) :: limit = 0.0_dp    !! longest side (cells) of a particle that stays whole; 0: all do
    logical :: automatic = .false.  !! the program chooses (sgmp_deck)
    integer :: most = 0           !! particles that splitting may lead to; 0: not said
    logical :: gases = .true.     !! they are split, and explosives
    logical :: liquids = .true.   !! they are
    logical :: solids = .true.    !! they are
    logical :: bounded = .false.  !! a few halvings only: no bound on all particles is needed
    integer :: halvings = 50      !! of one particle: the path from it is a number below 2**this
  end type splitting_t

end module sgmp_splitting_type
