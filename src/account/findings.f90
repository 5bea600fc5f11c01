!> What the particles and nodes of this rank tell in a step beside their motion: sums, the fastest
!! particle, those that were lost, and what stopped the run.
module sgmp_findings
  use sgmp_errors, only: error_t
  use sgmp_kinds, only: dp, i4
  use sgmp_tally, only: tally_t
  implicit none
  private
  public :: findings_t

  !> Findings; put together over the ranks when a step ends.
  type :: findings_t
    type(tally_t) :: tally                  !! sums of the step, being formed
    real(dp) :: fastest = 0.0_dp            !! largest c + |v|
    integer(i4) :: fastest_id = 0           !! its particle
    integer :: fastest_field = 0
    real(dp) :: fastest_before = 0.0_dp     !! at the start of the step
    integer :: lost = 0                     !! particles removed so far, on all ranks
    integer :: lost_here = 0                !! of these, by this rank in this step
    integer :: moved = 0                    !! particles that changed bins in the last step
    type(error_t), allocatable :: failure   !! what stopped the run, if anything did
    integer :: strained = 0                 !! sweeps of this step that have strained particles
    integer :: failed_in = 0                !! of these, the one with the failure
  end type findings_t

end module sgmp_findings
