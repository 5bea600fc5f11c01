!> Walls with friction beside the energy balance: impulses that press on them, and that pull. Their
!! work and dissipation are terms of the scheme itself (sgmp_energy).
module sgmp_wall_friction_account
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, from_nodes, terms_add
  use sgmp_features, only: nodes_pressed, nodes_pulled
  implicit none
  private
  public :: wall_friction_account, wall_pressed, wall_pulled

  character(*), parameter :: wall_pressed = 'friction_walls.pressed_impulse'
  character(*), parameter :: wall_pulled = 'friction_walls.pulled_impulse'

contains

  !> Adds the impulses.
  pure subroutine wall_friction_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name=wall_pressed, source=from_nodes, &
                                        entry=nodes_pressed))
    call terms_add(terms, energy_term_t(name=wall_pulled, source=from_nodes, entry=nodes_pulled))
  end subroutine wall_friction_account

end module sgmp_wall_friction_account
