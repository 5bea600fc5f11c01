!> Entries of the sums that the sweeps form plane by plane, over particles and over nodes.
module sgmp_sums
  implicit none
  private
  public :: sweep_sums, sum_kinetic, sum_mass_aa, sum_internal, sum_viscous, sum_momentum, &
            sum_moment, sum_angular, sum_edge_impulse, sum_edge_work, sum_filter, &
            sum_swirl, sum_volume, sum_features, &
            sum_applied, sum_collisions, sum_loose, sum_springs
  public :: removed_by_card, removed_by_erosion, removed_by_loss, removed_causes
  public :: removed_sums, removed_count, removed_mass, removed_momentum, removed_moment, &
            removed_kinetic, removed_internal
  public :: nodes_sums, nodes_mass_aa, nodes_mass_av, nodes_external, nodes_edge_push, &
            nodes_edge_taken, nodes_features, feature_sums, nodes_lost, nodes_taken, nodes_unfelt, &
            nodes_walls, wall_entry

  integer, parameter :: sweep_sums = 22    !! entries of a plane's sums over particles
  integer, parameter :: sum_kinetic = 1    !! sum 1/2 m |v|^2 (at the end of the sweep)
  integer, parameter :: sum_mass_aa = 2    !! sum m_p |a_p|^2
  integer, parameter :: sum_internal = 3   !! growth of internal energy
  integer, parameter :: sum_viscous = 4    !! part of it that the bulk viscosity dissipates
  integer, parameter :: sum_momentum = 5   !! first of sum m v (3 components)
  integer, parameter :: sum_moment = 8  !! first of sum m X after the drift (3 components, in cells)
  !> With swirl, sum m v_theta X in the place of the component that axisymmetric scenes do not have.
  integer, parameter :: sum_angular = sum_momentum + 2
  integer, parameter :: sum_filter = 11  !! kinetic energy that the velocity filter turns to heat
  integer, parameter :: sum_volume = 12  !! sum |dV| p of volumes that are put right
  integer, parameter :: sum_features = 13  !! first of those of features (sgmp_features); 1
  integer, parameter :: sum_edge_work = 14   !! work of what absorbing edges bear at rest
  integer, parameter :: sum_edge_impulse = 15  !! first of its impulse (3 components)
  integer, parameter :: sum_applied = 18     !! work of forces on faces of particles
  integer, parameter :: sum_collisions = 19  !! kinetic energy that debris loses by collisions
  integer, parameter :: sum_loose = 20       !! particles that have failed and are open
  integer, parameter :: sum_swirl = 21       !! kinetic energy that swirl loses as rings widen
  integer, parameter :: sum_springs = 22     !! of springs on faces, energy ahead of the velocities

  !> Why particles go for good: their material's card erode, that they have left the grid, or their
  !! body's card remove. A body has sums for each, those of a cause after cause*removed_sums others.
  integer, parameter :: removed_by_erosion = 0, removed_by_loss = 1, removed_by_card = 2, &
                        removed_causes = 3
  integer, parameter :: removed_sums = 10  !! entries of a body's sums over particles that go
  integer, parameter :: removed_count = 1
  integer, parameter :: removed_mass = 2
  integer, parameter :: removed_momentum = 3  !! first of sum m v (3 components)
  integer, parameter :: removed_moment = 6  !! first of sum m X (3 components, in cells)
  integer, parameter :: removed_kinetic = 9
  integer, parameter :: removed_internal = 10

  integer, parameter :: nodes_sums = 40    !! entries of a plane's sums over nodes
  integer, parameter :: nodes_mass_aa = 1  !! sum m_I |a_I|^2
  integer, parameter :: nodes_mass_av = 2  !! sum m_I a_I . v_I at the velocity before the kick
  integer, parameter :: nodes_external = 3  !! power of gravity, body forces, and absorbing edges
                                           !! against waves, at the mid-step velocity
  !> Forces on nodes below the mass cut-off, which move nothing: sum |f_x| + |f_y| + |f_z|.
  integer, parameter :: nodes_lost = 4
  integer, parameter :: nodes_taken = 5  !! power that walls take from nodes for good
  integer, parameter :: nodes_features = 6  !! first of those of features (sgmp_features)
  integer, parameter :: feature_sums = 12   !! and how many they have
  integer, parameter :: nodes_edge_taken = 18  !! power that absorbing edges take from waves
  integer, parameter :: nodes_edge_push = 19  !! first of their force against waves (3 components)
  integer, parameter :: nodes_walls = 22  !! first of the forces of walls (wall_entry), 18
  integer, parameter :: nodes_unfelt = 40  !! power of forces that particles do not feel, on strains

contains

  !> Entry of the sums over nodes where the force of a wall on the matter begins (3 components).
  pure integer function wall_entry(side, axis) result(entry)
    integer, intent(in) :: side, axis      !! lower 1, upper 2
    entry = nodes_walls + 3*(2*(axis - 1) + side - 1)
  end function wall_entry

end module sgmp_sums
