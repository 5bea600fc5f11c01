!> The stage of a step in which it becomes known by how much debris collides: a sweep of its own
!! before the kick, of those fields that have debris, and the rates from its sums.
module sgmp_debris_stages
  use sgmp_body, only: body_t
  use sgmp_debris_rates, only: debris_kicks, debris_rates
  use sgmp_field, only: field_t
  use sgmp_field_sweep, only: field_sweep
  use sgmp_findings, only: findings_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_phases, only: phase_fold
  use sgmp_plan, only: plan_t
  use sgmp_ranks, only: ranks_t
  use sgmp_team, only: team_t
  use sgmp_timers, only: timers_t
  use sgmp_totals, only: totals_t
  use sgmp_walls, only: has_walls, walls_mirror_collide
  implicit none
  private
  public :: phase_collisions, phase_debris_mass

contains

  !> Mass of debris in all fields that have some, for contact: such fields are known from the end of
  !! the step before.
  subroutine phase_debris_mass(plan, totals, mesh, fields, bodies, team, ranks, findings, timers)
    type(plan_t), intent(in) :: plan             !! of the sweep
    type(totals_t), intent(in) :: totals
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(team_t), intent(inout) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    integer :: f
    do f = 1, size(fields)
      fields(f)%collides = any(totals%bodies%loose > 0.0_dp) .and. &
                           any(bodies%field == f .and. .not. bodies%rigid)
      if (.not. fields(f)%collides) cycle
      if (plan%gradient > 0) call debris_kicks(fields(f))
      call field_sweep(plan, f, mesh, fields(f), bodies, team, ranks, findings, timers)
    end do
    if (any(fields%collides)) call phase_fold(plan, mesh, fields, team%threads)
  end subroutine phase_debris_mass

  !> Rates of all fields with debris.
  subroutine phase_collisions(plan, speed, totals, mesh, fields, bodies, team, ranks, findings, &
                              timers)
    type(plan_t), intent(in) :: plan             !! of the sweep
    real(dp), intent(in) :: speed                !! of sound
    type(totals_t), intent(in) :: totals
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(team_t), intent(inout) :: team
    type(ranks_t), intent(inout) :: ranks
    type(findings_t), intent(inout) :: findings
    type(timers_t), intent(inout) :: timers
    integer :: f, axis
    call phase_debris_mass(plan, totals, mesh, fields, bodies, team, ranks, findings, timers)
    do f = 1, size(fields)
      if (fields(f)%collides) call debris_rates(fields, f, mesh, plan%dt_kick, speed)
    end do
    do f = 1, size(fields)
      if (.not. fields(f)%collides) cycle
      do axis = 1, mesh%ndim
        if (has_walls(mesh, axis)) call walls_mirror_collide(fields(f), mesh, axis)
      end do
    end do
  end subroutine phase_collisions

end module sgmp_debris_stages
