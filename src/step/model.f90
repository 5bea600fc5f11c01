!> Everything a simulation consists of while it runs; passed as an argument, never global.
!!
!! Phases do not take the model: they take those of its parts that they read or change.
module sgmp_model
  use sgmp_angular_momentum, only: angular_momentum_t
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_t
  use sgmp_energy, only: ledger_t
  use sgmp_field, only: field_t
  use sgmp_findings, only: findings_t
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use sgmp_ranks, only: ranks_t
  use sgmp_team, only: team_t
  use sgmp_time_step, only: clock_t
  use sgmp_timers, only: timers_t
  use sgmp_totals, only: totals_t
  use sgmp_wall_motion, only: wall_motion_t
  implicit none
  private
  public :: model_t

  !> State of a simulation.
  type :: model_t
    type(mesh_t) :: mesh
    type(wall_motion_t) :: wall_motion               !! prescribed, of the mesh's walls
    type(method_t) :: method
    type(clock_t) :: clock
    type(field_t), allocatable :: fields(:)          !! velocity fields
    type(body_t), allocatable :: bodies(:)
    type(contact_t) :: contact                       !! pairs of bodies, nodes where they meet
    type(team_t) :: team                             !! threads, and how they share the work
    type(ranks_t) :: ranks                           !! this rank and its neighbours
    type(findings_t) :: findings                     !! of the step's sweeps, on this rank
    type(totals_t) :: totals                         !! of all ranks
    type(ledger_t) :: ledger                         !! of the energy
    type(angular_momentum_t), allocatable :: turning(:)
      !! (fields) at the start, where nothing may change it
    type(timers_t) :: timers
  end type model_t

end module sgmp_model
