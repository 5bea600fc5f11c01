!> Edges that let waves out in the energy balance: what they do is work of external forces, which
!! the balance of the scheme holds; these terms say how much of it is theirs. Energy and impulse of
!! waves are those that the nodes lose, to round-off; the work of what edges bear at rest is by the
!! velocity of the particles beside them. The two impulses are the reaction of the edges.
module sgmp_absorbing_account
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, from_nodes, from_particles, &
                               terms_add
  use sgmp_sums, only: nodes_edge_push, nodes_edge_taken, sum_edge_impulse, sum_edge_work
  implicit none
  private
  public :: absorbing_account

contains

  !> Adds the terms.
  pure subroutine absorbing_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name='absorbing_edges.energy_taken', &
                                        column='edges_energy_taken', source=from_nodes, &
                                        entry=nodes_edge_taken))
    call terms_add(terms, energy_term_t(name='absorbing_edges.impulse', column='edges_impulse', &
                                        source=from_nodes, entry=nodes_edge_push, components=3))
    call terms_add(terms, energy_term_t(name='absorbing_edges.work_at_rest', &
                                        column='edges_work_at_rest', source=from_particles, &
                                        entry=sum_edge_work))
    call terms_add(terms, energy_term_t(name='absorbing_edges.impulse_at_rest', &
                                        column='edges_impulse_at_rest', source=from_particles, &
                                        entry=sum_edge_impulse, components=3))
  end subroutine absorbing_account

end module sgmp_absorbing_account
