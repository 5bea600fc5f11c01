!> What the deck says about the method, and no step changes.
module sgmp_method
  use sgmp_features, only: features_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: method_t

  !> The scheme and its options.
  type :: method_t
    integer :: update = 0                   !! one of update_*
    type(features_t) :: features            !! that have a place of their own
    real(dp) :: flip = 1.0_dp               !! weight of FLIP against PIC
    real(dp) :: gravity(3) = 0.0_dp
    logical :: normalised = .false.         !! volume-normalised stress
    real(dp) :: interior = 0.0_dp           !! filling of interior cells, for normalised stress
    logical :: relaxed = .false.            !! volumes are kept (doc/volumes.md)
    !> Fastest sound in the bulk of what may fail; 0: nothing does, or its debris does not collide.
    real(dp) :: debris_speed = 0.0_dp
    logical :: rotation = .false.           !! rigid rotation strains nothing
    logical :: rubs_at_surface = .false.    !! friction of bodies acts there, not at the nodes
    !> Of fields without a solid the stress is not normalised, rotation not exact, surfaces are not
    !! corrected.
    logical :: normalised_solids = .false., rotation_solids = .false., surfaces_solids = .false.
    logical :: drift_remapped = .false.     !! particles move with the velocity that strains them
    logical :: drift_solids = .false.       !! of solids only whose stress is normalised
    logical :: surfaces = .false.           !! strains are corrected at surfaces
    logical :: consistent = .false.         !! fields of solids have a consistent mass
    logical :: consistent_springs = .false.  !! only those of what is elastic and nothing else
    logical :: swirl = .false.              !! axisymmetric: with a velocity around the axis
    real(dp) :: cutoff = 0.0_dp             !! node mass below which a node is ignored
    logical :: erodes = .false.             !! particles may be removed by their material's card
    logical :: removes = .false.            !! bodies are removed by a card
    integer :: removed = 0                  !! sums of a body over particles that go for good
    !> By which part of the velocity step the velocity with which forces do their work lies before
    !! that of the particles: a half, by which the kinetic energy is exact. Damping would lose a
    !! part of the work by it, of first order in the step; there it is 0, the way particles go.
    real(dp) :: work_lag = 0.5_dp
    logical :: damped = .false.             !! the deck has damping
    real(dp) :: damping = 0.0_dp            !! rate at which velocities decay
    logical :: kinetic_damping = .false.    !! all stop when the kinetic energy has fallen
    real(dp) :: damped_until = 0.0_dp       !! time
    real(dp) :: unfelt = 0.0_dp             !! part of what nodes are pushed by and particles do not
                                            !! feel that strains them now (sgmp_unfelt_stages)
    integer :: lost_policy = 1              !! one of lost_*
    logical :: loses = .false.              !! particles may leave the grid and be removed
  end type method_t

end module sgmp_method
