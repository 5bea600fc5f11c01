!> Free rigid bodies in a step: the momentum with which they leave it, found together with what
!! contact gives them (doc/loads.md).
!!
!! Forces of contact belong to the velocity that the body has after the kick, and a light body may
!! carry more mass at its nodes than it has: its momentum p solves p = p0 + push + J(p), J the
!! impulses of the trial, by Newton's method in six unknowns. What particles then receive is exact
!! to round-off and the body receives the opposite; what Newton's method leaves over only moves the
!! body a little differently in this step.
module sgmp_rigid_stages
  use sgmp_body, only: body_t
  use sgmp_contact, only: contact_step_t, contact_t
  use sgmp_contact_reaction, only: reaction_find, reaction_t
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_ranks, only: ranks_t
  use sgmp_rigid_bodies, only: rigid_solve
  use sgmp_rigid_motion, only: freedoms, motion_advance, motion_axes, motion_energy, motion_plan, &
                               rigid_motion_t
  use sgmp_rotor, only: rotor_matrix
  use sgmp_shared_nodes, only: shared_nodes_t, shared_place
  use sgmp_space, only: axes_in_output
  use sgmp_totals, only: totals_t
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: free_any, free_open, free_settle, free_strain, free_close

  integer, parameter :: most_rounds = 20
  real(dp), parameter :: settled = 1.0e-13_dp    !! change of a momentum over what acts on it

contains

  !> Whether there are any.
  pure function free_any(bodies) result(yes)
    type(body_t), intent(in) :: bodies(:)
    logical :: yes
    yes = any(bodies%rigid_motion%free)
  end function free_any

  !> What gravity and body forces do; without contact that is all.
  subroutine free_open(bodies, mesh, gravity, time, dt, dt_kick)
    type(body_t), intent(inout) :: bodies(:)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: gravity(3), time
    real(dp), intent(in) :: dt, dt_kick          !! position and velocity step
    real(dp) :: force(3)
    integer :: b, d
    do b = 1, size(bodies)
      associate (body => bodies(b), motion => bodies(b)%rigid_motion)
        if (.not. motion%free) cycle
        force = gravity
        if (body%forced) then
          do d = 1, mesh%ndim
            force(d) = force(d) + body%force(d)%evaluate(motion%centre, motion%centre, time)
          end do
        end if
        motion%push = 0.0_dp
        motion%push(:3) = dt_kick*motion%mass*merge(force, 0.0_dp, first_axes(mesh%space))
        motion%trial = motion%momentum + motion%push
        call motion_plan(motion, body%speed, dt)
      end associate
    end do
  end subroutine free_open

  pure function first_axes(space) result(axes)
    integer, intent(in) :: space
    logical :: axes(3), all_axes(freedoms)
    all_axes = motion_axes(space)
    axes = all_axes(:3)
  end function first_axes

  !> The momentum with contact. It must be known where bodies touch; other bodies' nodes hold their
  !! trial.
  subroutine free_settle(step, dt, mesh, fields, bodies, contact, threads, ranks)
    type(contact_step_t), intent(in) :: step
    real(dp), intent(in) :: dt                   !! position step
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(inout) :: bodies(:)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: threads
    type(ranks_t), intent(in) :: ranks
    type(reaction_t) :: reactions(size(bodies))
    real(dp) :: change, largest
    integer :: b, round
    if (size(contact%pairs) == 0) return
    do round = 1, most_rounds
      call reaction_find(contact, mesh, ranks%partition%own, fields, bodies, step, threads, &
                         reactions)
      largest = 0.0_dp
      do b = 1, size(bodies)
        if (.not. bodies(b)%rigid_motion%free) cycle
        call improve(reactions(b), mesh%space, round, bodies(b), change)
        largest = max(largest, change)
        if (change <= 0.0_dp) cycle
        call motion_plan(bodies(b)%rigid_motion, bodies(b)%speed, dt)
        call rigid_solve(bodies(b), mesh, fields(bodies(b)%field), step%dt_kick)
      end do
      if (largest <= settled) exit
    end do
  end subroutine free_settle

  !> The velocity with which free bodies strain the others. What contact takes from the nodes to
  !! make that velocity obey, and no particle receives, is taken from a free body as a whole: else
  !! contact would do work on what comes up to a light one (doc/loads.md).
  subroutine free_strain(step, mesh, fields, bodies, contact, column, threads, ranks)
    type(contact_step_t), intent(in) :: step
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: column                !! of the nodes, where the velocity begins
    integer, intent(in) :: threads
    type(ranks_t), intent(in) :: ranks
    type(reaction_t) :: reactions(size(bodies))
    real(dp) :: matrix(freedoms, freedoms), change(freedoms)
    integer :: b
    if (size(contact%pairs) == 0) return
    call reaction_find(contact, mesh, ranks%partition%own, fields, bodies, step, threads, &
                       reactions, column)
    do b = 1, size(bodies)
      if (.not. bodies(b)%rigid_motion%free) cycle
      matrix = mass_matrix(bodies(b)%rigid_motion) + reactions(b)%carried
      change = merge(reactions(b)%impulse, 0.0_dp, motion_axes(mesh%space))
      call hold(motion_axes(mesh%space), matrix)
      call add_motion(contact%shared, b, mesh, bodies(b), solution(matrix, change), column, fields)
    end do
  end subroutine free_strain

  !> Adds a small motion of a body to its velocity at the nodes that it shares.
  pure subroutine add_motion(shared, b, mesh, body, change, column, fields)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: b                     !! its number
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(in) :: change(freedoms)     !! linear, and angular about its centre
    integer, intent(in) :: column
    type(field_t), intent(inout) :: fields(:)
    real(dp) :: velocity(3)
    integer :: n, m, last
    last = column + mesh%ndim - 1
    do n = 1, shared%nodes
      do m = shared%member_start(n), shared%member_start(n + 1) - 1
        if (shared%body(m) /= b) cycle
        velocity = change(:3) + cross(change(4:), shared_place(shared, n, mesh) - &
                                      body%rigid_motion%centre)
        associate (node => fields(shared%field(m))%node, i => shared%record(m))
          node(i, column:last) = node(i, column:last) + velocity(:mesh%ndim)
        end associate
      end do
    end do
  end subroutine add_motion

  !> Mass and, as the body lies now, moments of inertia.
  pure function mass_matrix(motion) result(mass)
    type(rigid_motion_t), intent(in) :: motion
    real(dp) :: mass(freedoms, freedoms), r(3, 3)
    integer :: d
    r = rotor_matrix(motion%attitude)
    mass = 0.0_dp
    mass(4:, 4:) = matmul(r, matmul(motion%inertia, transpose(r)))
    do d = 1, 3
      mass(d, d) = motion%mass
    end do
  end function mass_matrix

  !> Takes the directions in which a body cannot move out of a system of equations.
  pure subroutine hold(axes, matrix)
    logical, intent(in) :: axes(freedoms)
    real(dp), intent(inout) :: matrix(freedoms, freedoms)
    integer :: d
    do d = 1, freedoms
      if (axes(d)) cycle
      matrix(d, :) = 0.0_dp
      matrix(:, d) = 0.0_dp
      matrix(d, d) = 1.0_dp
    end do
  end subroutine hold

  !> One step of Newton's method; after a few, where bodies open and close in turns, half of one.
  pure subroutine improve(reaction, space, round, body, change)
    type(reaction_t), intent(in) :: reaction
    integer, intent(in) :: space, round
    type(body_t), intent(inout) :: body
    real(dp), intent(out) :: change              !! relative
    real(dp) :: matrix(freedoms, freedoms), mass(freedoms, freedoms), scale
    real(dp) :: missing(freedoms), response(freedoms)
    logical :: axes(freedoms)
    integer :: d
    axes = motion_axes(space)
    associate (motion => body%rigid_motion)
      mass = mass_matrix(motion)
      missing = merge(motion%momentum + motion%push + reaction%impulse - motion%trial, 0.0_dp, axes)
      matrix = mass + reaction%carried
      call hold(axes, matrix)
      response = matmul(mass, solution(matrix, missing))
      response = merge(response, 0.0_dp, axes)
      if (round > most_rounds/2) response = 0.5_dp*response
      motion%trial = motion%trial + response
      change = 0.0_dp
      do d = 1, 4, 3
        scale = norm2(motion%momentum(d:d + 2)) + norm2(motion%push(d:d + 2)) + &
                norm2(reaction%impulse(d:d + 2))
        if (scale > 0.0_dp) change = max(change, norm2(response(d:d + 2))/scale)
      end do
    end associate
  end subroutine improve

  !> Solves six equations by elimination with the largest pivot of each column.
  pure function solution(matrix, right) result(x)
    real(dp), intent(in) :: matrix(freedoms, freedoms), right(freedoms)
    real(dp) :: x(freedoms)
    real(dp) :: a(freedoms, freedoms + 1), row(freedoms + 1)
    integer :: i, j, p
    a(:, :freedoms) = matrix
    a(:, freedoms + 1) = right
    do j = 1, freedoms
      p = j - 1 + maxloc(abs(a(j:, j)), dim=1)
      row = a(p, :)
      a(p, :) = a(j, :)
      a(j, :) = row/row(j)
      do i = 1, freedoms
        if (i /= j) a(i, :) = a(i, :) - a(i, j)*a(j, :)
      end do
    end do
    x = a(:, freedoms + 1)
  end function solution

  !> Ends a step: bodies receive what contact has taken from the others, and the sums know of it.
  subroutine free_close(bodies, contact, space, dt, totals)
    type(body_t), intent(inout) :: bodies(:)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: space
    real(dp), intent(in) :: dt                   !! position step
    type(totals_t), intent(inout) :: totals
    real(dp) :: given(freedoms), kinetic
    integer :: b
    do b = 1, size(bodies)
      associate (motion => bodies(b)%rigid_motion, own => totals%bodies(b))
        if (.not. motion%free) cycle
        given = merge(received(b, motion%centre, contact, space, totals%impulses), 0.0_dp, &
                      motion_axes(space))
        totals%sums%rigid_work = totals%sums%rigid_work + &
          dot_product(motion%push(:3), motion%momentum(:3) + &
                      0.5_dp*(motion%push(:3) + given(:3)))/motion%mass
        motion%momentum = motion%momentum + (motion%push + given)
        motion%impulse = motion%impulse + given
        call motion_advance(motion, bodies(b)%speed, bodies(b)%speed_before, dt)
        kinetic = own%kinetic
        own%kinetic = motion_energy(motion)
        own%momentum = motion%momentum(:3)
        totals%sums%free_growth = totals%sums%free_growth + (own%kinetic - kinetic)
        totals%sums%kinetic = totals%sums%kinetic + own%kinetic
        totals%sums%momentum = totals%sums%momentum + own%momentum
      end associate
    end do
  end subroutine free_close

  !> What a body has received in the step from all its pairs: impulse, and its moment about a point.
  pure function received(b, centre, contact, space, before) result(given)
    integer, intent(in) :: b
    real(dp), intent(in) :: centre(3)
    type(contact_t), intent(in) :: contact
    integer, intent(in) :: space
    real(dp), intent(in) :: before(:, :)
    real(dp) :: given(freedoms)
    real(dp) :: impulse(freedoms)
    integer :: p
    given = 0.0_dp
    do p = 1, size(contact%pairs)
      associate (pair => contact%pairs(p))
        impulse = [pair%impulse, pair%angular_impulse] - before(:, p)
        impulse(axes_in_output(:, space)) = impulse(:3)
        if (pair%body(1) == b) given = given + impulse
        if (pair%body(2) == b) given = given - impulse
      end associate
    end do
    given(4:) = given(4:) - cross(centre, given(:3))
  end function received

end module sgmp_rigid_stages
