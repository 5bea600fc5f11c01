!> What walls with friction do in a step that strains before the kick, and what is doubtful about
!! them after a run (doc/loads.md).
module sgmp_wall_friction_stages
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_remapped, node_velocity, vector_column, vector_components
  use sgmp_drive, only: drive_sums
  use sgmp_energy_terms, only: energy_terms_t, terms_value
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use sgmp_partition, only: partition_t
  use sgmp_phases, only: phase_remap, phase_solve
  use sgmp_rigid_bodies, only: rigid_field, rigid_velocity
  use sgmp_sums, only: nodes_sums, sweep_sums
  use sgmp_tally, only: tally_reset, tally_t
  use sgmp_team, only: team_t
  use sgmp_text, only: percent_text, real_text
  use sgmp_wall_friction_account, only: wall_pressed, wall_pulled
  implicit none
  private
  public :: wall_friction_objection, wall_velocity_rubbed

  character(*), parameter :: uncertain = &
    ': they rub with the difference, but where and when is uncertain (doc/loads.md); take a '// &
    'rigid body and a card contact'
  real(dp), parameter :: largest_pull = 0.4_dp   !! over what presses
  real(dp), parameter :: coarse_pull = 0.05_dp   !! beyond which numbers are inexact
  real(dp), parameter :: least_error = 0.1_dp    !! of them; else that part

contains

  !> Velocity of the nodes before the stress update (USF): nodes that would stick to a wall in a
  !! step with the stresses as they are have its velocity.
  subroutine wall_velocity_rubbed(method, dt, mesh, fields, bodies, team, partition)
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: dt                   !! velocity step
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(team_t), intent(in) :: team
    type(partition_t), intent(in) :: partition
    type(tally_t) :: unused
    type(method_t) :: still                      !! particles have not felt these forces yet
    integer :: f, a, b
    still = method
    still%unfelt = 0.0_dp
    call tally_reset(unused, size(bodies)*(sweep_sums + method%removed) + nodes_sums + &
                     sum(fields%columns%driven)*drive_sums)
    call phase_solve(method, dt, mesh, fields, bodies, team, partition, unused)
    call phase_remap(still, mesh, fields, bodies, team, partition)
    do f = 1, size(fields)
      b = rigid_field(bodies, f)
      if (b > 0) then
        call rigid_velocity(bodies(b), mesh, .true., node_velocity(mesh%ndim), fields(f))
        cycle
      end if
      do a = 1, vector_components(fields(f)%columns, mesh%ndim)
        fields(f)%node(:, vector_column(fields(f)%columns, node_velocity(mesh%ndim), a)) = &
          fields(f)%node(:, vector_column(fields(f)%columns, node_remapped, a))
      end do
    end do
  end subroutine wall_velocity_rubbed

  !> Walls that pull hold what would leave them: what they pull here presses elsewhere all the more.
  !! Friction is that of the difference, but at other places and times. By which part numbers are
  !! inexact, and why; 1: a doubt.
  pure subroutine wall_friction_objection(terms, inexact, reason)
    type(energy_terms_t), intent(in) :: terms
    real(dp), intent(out) :: inexact
    character(:), allocatable, intent(out) :: reason
    inexact = 0.0_dp
    reason = ''
    associate (pressed => terms_value(terms, wall_pressed), &
               pulled => terms_value(terms, wall_pulled))
      if (pulled > largest_pull*pressed) then
        inexact = 1.0_dp
        reason = 'walls with friction have held back by '// &
                 real_text(pulled)//' what would leave them, and '//real_text(pressed)// &
                 ' has pressed on them (impulses)'//uncertain
      else if (pulled > coarse_pull*pressed) then
        inexact = max(least_error, pulled/pressed)
        reason = 'walls with friction have held back '//percent_text(pulled/pressed)// &
                 ' of what presses on them'//uncertain
      end if
    end associate
  end subroutine wall_friction_objection

end module sgmp_wall_friction_stages
