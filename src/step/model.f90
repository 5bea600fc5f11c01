!> Everything a simulation consists of while it runs; passed as an argument, never global.
module sgmp_model
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_t
  use sgmp_energy, only: ledger_t, step_sums_t
  use sgmp_errors, only: error_t
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_mesh, only: mesh_t
  use sgmp_movers, only: movers_t
  use sgmp_neighbours, only: neighbours_t, traffic_t
  use sgmp_partition, only: partition_t
  use sgmp_plan, only: workspace_t
  use sgmp_tally, only: tally_t
  use sgmp_time_step, only: clock_t
  use sgmp_timers, only: timers_t
  implicit none
  private
  public :: model_t, body_sums_t, balance_t

  !> Sums over one body, kept up to date by the sweeps.
  type :: body_sums_t
    real(dp) :: mass = 0.0_dp
    real(dp) :: moment(3) = 0.0_dp     !! sum m X, in cells from the grid origin
    real(dp) :: momentum(3) = 0.0_dp
    real(dp) :: kinetic = 0.0_dp, internal = 0.0_dp
  end type body_sums_t

  !> Looks at the loads of the ranks.
  type :: balance_t
    integer :: cuts = 0                !! times the cuts were moved
    integer(i8) :: moved = 0_i8        !! particles that changed ranks for it
    real(dp) :: imbalance = 1.0_dp     !! most moving particles of a rank over the mean, last look
    real(dp) :: largest = 1.0_dp       !! the largest of all looks
  end type balance_t

  !> State of a simulation.
  type :: model_t
    type(mesh_t) :: mesh
    type(field_t), allocatable :: fields(:)          !! velocity fields
    type(body_t), allocatable :: bodies(:)
    type(workspace_t), allocatable :: workspaces(:, :)  !! (slabs, fields)
    type(movers_t), allocatable :: movers(:, :)  !! (bodies, slabs + 1) who left their bins, and
                                                 !! who came from other ranks
    integer, allocatable :: slabs(:, :)  !! (slabs + 1, fields) first planes, see field_divide
    type(partition_t) :: partition                           !! planes that this rank owns
    type(balance_t) :: balance                       !! how evenly, and what was done about it
    type(workspace_t), allocatable :: below(:), above(:)  !! (fields) what neighbours sent
    type(neighbours_t) :: swap                       !! messages to and from them
    type(traffic_t) :: traffic                       !! sent so far
    integer(i8), allocatable :: counts(:)            !! (bodies) particles on all ranks
    integer(i8) :: points = 0_i8                     !! grid points stored on all ranks
    type(tally_t) :: tally                           !! sums of the step, being formed
    type(contact_t) :: contact                       !! pairs of bodies, nodes where they meet
    integer :: threads = 1
    integer :: update = 0                            !! one of update_*
    real(dp) :: flip = 1.0_dp
    real(dp) :: gravity(3) = 0.0_dp
    logical :: normalised = .false.                  !! volume-normalised stress
    integer :: spins = 0                             !! components of the spin that particles carry
    real(dp) :: interior = 0.0_dp  !! filling of interior cells, for normalised stress
    real(dp) :: cutoff = 0.0_dp                      !! node mass below which a node is ignored
    integer :: lost_policy = 1                       !! one of lost_*
    integer :: lost = 0                              !! particles removed so far, on all ranks
    integer :: lost_here = 0                         !! of these, by this rank in this step
    integer :: lost_before = 0                       !! of these, before the last kinetic sum
    integer :: moved = 0                             !! particles that changed bins in the last step
    type(clock_t) :: clock
    real(dp) :: fastest = 0.0_dp                     !! largest c + |v|
    integer(i4) :: fastest_id = 0
    integer :: fastest_field = 0
    real(dp) :: fastest_before = 0.0_dp              !! at the start of the step
    type(ledger_t) :: ledger
    type(step_sums_t) :: sums                        !! of the step at hand
    type(body_sums_t), allocatable :: body_sums(:)   !! (bodies)
    type(timers_t) :: timers
    type(error_t), allocatable :: failure            !! what stopped the run, if anything did
  end type model_t

end module sgmp_model
