!> Friction at the surface in stages, each over all shared nodes or those of some colours: how
!! threads share the nodes.
!!
!! In a trial: levers (once in a step), before, the trial along the normals, first, next (each
!! colour of planes), after. For another velocity that strains: before, along the normals, strain
!! (each colour of planes), after. Between stages nodes have to come from other ranks
!! (sgmp_contact_stages).
module sgmp_friction_stages
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_step_t, contact_t, contact_trial_strain
  use sgmp_contact_friction, only: friction_close, friction_hold, friction_measure, friction_open, &
                                   friction_press, friction_settle, friction_start, friction_turn
  use sgmp_contact_levers, only: colours, levers_find, plane_colours
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  implicit none
  private
  public :: friction_levers, friction_before_trial, friction_first, friction_next, &
            friction_after_trial, friction_before_strain, friction_strain, friction_after_strain

contains

  !> Shares of the nodes around shared nodes.
  subroutine friction_levers(contact, mesh, fields, bodies, threads)
    type(contact_t), intent(inout) :: contact
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, mesh, fields, bodies) private(n)
    do n = 1, contact%shared%nodes
      call levers_find(contact%levers, contact%shared, n, mesh, fields, bodies)
    end do
    !$omp end parallel do
  end subroutine friction_levers

  !> What forces do to the slip.
  subroutine friction_before_trial(contact, fields, bodies, step, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, fields, bodies, step) private(n)
    do n = 1, contact%shared%nodes
      call friction_open(contact%levers, contact%shared, n, fields, bodies, step%dt_kick, &
                         step%gravity)
    end do
    !$omp end parallel do
  end subroutine friction_before_trial

  !> The forces of the step before.
  subroutine friction_first(contact, fields, bodies, step, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    integer, intent(in) :: threads
    integer :: c, n, q
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, fields, bodies, step) private(n)
    do n = 1, contact%shared%nodes
      call friction_press(contact%levers, contact%shared, n, fields, bodies, step%dt_kick)
    end do
    !$omp end parallel do
    do c = 1, colours
      !$omp parallel do schedule(static) num_threads(threads) if(threads > 1) default(none) &
      !$omp& shared(contact, fields, step, c) private(q)
      do q = contact%levers%first(c), contact%levers%first(c + 1) - 1
        call friction_start(contact%levers, contact%shared, contact%levers%node(q), step%dt_kick, &
                            fields)
      end do
      !$omp end parallel do
    end do
  end subroutine friction_first

  !> Corrects them on the planes of one colour.
  subroutine friction_next(contact, plane_colour, fields, bodies, step, threads)
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: plane_colour
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    integer, intent(in) :: threads
    integer :: c, q
    do c = first_colour(plane_colour), first_colour(plane_colour + 1) - 1
      !$omp parallel do schedule(static) num_threads(threads) if(threads > 1) default(none) &
      !$omp& shared(contact, fields, bodies, step, c) private(q)
      do q = contact%levers%first(c), contact%levers%first(c + 1) - 1
        call friction_turn(contact%levers, contact%shared, contact%levers%node(q), step%dt_kick, &
                           bodies, fields)
      end do
      !$omp end parallel do
    end do
  end subroutine friction_next

  !> What friction did in the trial.
  subroutine friction_after_trial(contact, fields, bodies, step, threads)
    type(contact_t), intent(inout) :: contact
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_step_t), intent(in) :: step
    integer, intent(in) :: threads
    integer :: n
    if (step%strains_with_trial) call contact_trial_strain(contact, fields, bodies, step, threads)
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, fields, bodies, step) private(n)
    do n = 1, contact%shared%nodes
      call friction_close(contact%levers, contact%shared, n, fields, bodies, step%dt_kick, &
                          step%before, step%strains_with_trial, step%work_part)
    end do
    !$omp end parallel do
  end subroutine friction_after_trial

  !> The slip of a velocity that strains.
  subroutine friction_before_strain(contact, column, fields, bodies, threads)
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: column          !! of the velocity
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: threads
    integer :: n
    !$omp parallel do schedule(dynamic, 16) num_threads(threads) if(threads > 1) default(none) &
    !$omp& shared(contact, column, fields, bodies) private(n)
    do n = 1, contact%shared%nodes
      call friction_measure(contact%levers, contact%shared, n, fields, bodies, column)
    end do
    !$omp end parallel do
  end subroutine friction_before_strain

  !> Takes the slip of bodies that stick from that velocity, on the planes of one colour.
  subroutine friction_strain(contact, plane_colour, column, fields, bodies, threads)
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: plane_colour, column
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: threads
    integer :: c, q
    do c = first_colour(plane_colour), first_colour(plane_colour + 1) - 1
      !$omp parallel do schedule(static) num_threads(threads) if(threads > 1) default(none) &
      !$omp& shared(contact, fields, bodies, column, c) private(q)
      do q = contact%levers%first(c), contact%levers%first(c + 1) - 1
        call friction_hold(contact%levers, contact%shared, contact%levers%node(q), bodies, column, &
                           fields)
      end do
      !$omp end parallel do
    end do
  end subroutine friction_strain

  !> What friction took through the velocity after the kick.
  subroutine friction_after_strain(contact, part)
    type(contact_t), intent(inout) :: contact
    real(dp), intent(in) :: part           !! of the strain that it makes
    integer :: n
    do n = 1, contact%shared%nodes
      call friction_settle(contact%levers, contact%shared, n, part)
    end do
  end subroutine friction_after_strain

  !> The first colour of the nodes on planes of a colour.
  pure function first_colour(plane_colour) result(c)
    integer, intent(in) :: plane_colour
    integer :: c
    c = 1 + (plane_colour - 1)*(colours/plane_colours)
  end function first_colour

end module sgmp_friction_stages
