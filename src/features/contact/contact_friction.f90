!> Friction at the surface at one node, in the stages of a step (doc/rotation.md).
!!
!! Friction at a node changes the slip at others. Impulses begin with the force of the step before,
!! and each node corrects its own once, in the order of its colours: nodes of one colour are three
!! apart along every axis and have no node around in common, so that any thread may take any of
!! them. Ranks swap nodes after each colour of planes (sgmp_contact_stages).
module sgmp_contact_friction
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_acceleration, node_velocity
  use sgmp_contact_ledger, only: body_force
  use sgmp_contact_levers, only: levers_give, levers_see, levers_t, parts_of, shift_of, &
                                 tangential
  use sgmp_contact_resolve, only: link_closed, link_sliding, link_sticking
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_shared_nodes, only: shared_members, shared_nodes_t
  implicit none
  private
  public :: friction_open, friction_press, friction_start, friction_turn, friction_close, &
            friction_measure, friction_hold, friction_settle

  ! How vectors of a rigid body grow with the place, in units of the gradients of its velocity in
  ! this step and in the one before.
  real(dp), parameter :: of_velocity(2) = [1.0_dp, 0.0_dp], of_before(2) = [0.0_dp, 1.0_dp], &
                         of_kick(2) = [1.0_dp, -1.0_dp]

contains

  !> The same for a velocity that strains: before the kick it is where that of the trial will be.
  pure function of_column(ndim, column) result(slopes)
    integer, intent(in) :: ndim, column
    real(dp) :: slopes(2)
    slopes = merge(of_before, of_velocity, column == node_velocity(ndim))
  end function of_column

  !> Before the trial: what forces do to the slip at a node.
  pure subroutine friction_open(levers, shared, n, fields, bodies, dt, gravity)
    type(levers_t), intent(inout) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: dt, gravity(3)
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      shared%link(l)%rub = 0.0_dp
      if (levers%response(l) <= 0.0_dp) cycle
      levers%pull(:, :, l) = dt*levers_see(levers, shared, n, l, fields, bodies, &
                                           node_acceleration, of_kick/dt)
      levers%before(:, :, l) = levers_see(levers, shared, n, l, fields, bodies, &
                                          node_velocity(shared%ndim), of_velocity) - &
                               levers%pull(:, :, l)
      levers%external(:, l) = tangential(shared, n, l, external(levers, shared, n, l, fields, &
                                                                bodies, gravity, .true.))
      levers%booked(:, l) = tangential(shared, n, l, external(levers, shared, n, l, fields, &
                                                              bodies, gravity, .false.))
    end do
  end subroutine friction_open

  !> Acceleration by gravity and body forces at the surface, and by forces on faces, whose work is
  !! booked on the particles; first body minus second, rigid ones left out.
  pure function external(levers, shared, n, l, fields, bodies, gravity, faces) result(apart)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, l
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: gravity(3)
    logical, intent(in) :: faces
    real(dp) :: apart(3), vector(3)
    integer :: side, at(2), b
    at = shared_members(shared, n, l)
    apart = 0.0_dp
    do side = 1, 2
      if (bodies(shared%body(at(side)))%rigid) cycle
      vector = gravity
      associate (field => fields(shared%field(at(side))), nd => shared%ndim)
        if (field%columns%external > 0) then
          do b = 1, levers%nodes(side, l)
            vector(:nd) = vector(:nd) + levers%gain(b, side, l)* &
              body_force(field, levers%record(b, side, l), &
                         shared%point(:, n) + shift_of(levers%place(b, side, l)), faces)
          end do
        end if
      end associate
      apart = apart + merge(vector, -vector, side == 1)
    end do
  end function external

  !> After the trial along the normals: what forces do to the slip now.
  pure subroutine friction_press(levers, shared, n, fields, bodies, dt)
    type(levers_t), intent(inout) :: levers
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: dt
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      if (levers%response(l) <= 0.0_dp) cycle
      levers%pressed(:, :, l) = dt*levers_see(levers, shared, n, l, fields, bodies, &
                                              node_acceleration, of_kick/dt)
    end do
  end subroutine friction_press

  !> Begins with the forces of the step before.
  pure subroutine friction_start(levers, shared, n, dt, fields)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    real(dp), intent(in) :: dt
    type(field_t), intent(inout) :: fields(:)
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      if (levers%response(l) <= 0.0_dp .or. shared%link(l)%state <= link_closed) cycle
      call rub(levers, shared, n, l, tangential(shared, n, l, dt*shared%link(l)%drag), dt, fields)
    end do
  end subroutine friction_start

  !> Corrects friction at a node by the slip that is left.
  pure subroutine friction_turn(levers, shared, n, dt, bodies, fields)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    real(dp), intent(in) :: dt
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(inout) :: fields(:)
    real(dp) :: slip(3)
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      if (levers%response(l) <= 0.0_dp .or. shared%link(l)%state <= link_closed) cycle
      slip = sum(levers_see(levers, shared, n, l, fields, bodies, node_velocity(shared%ndim), &
                            of_velocity), dim=2)
      call rub(levers, shared, n, l, shared%link(l)%rub + slip/levers%response(l), dt, fields)
    end do
  end subroutine friction_turn

  !> Sets friction to a trial, as far as Coulomb's law admits.
  pure subroutine rub(levers, shared, n, l, trial, dt, fields)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n, l
    real(dp), intent(in) :: trial(3), dt
    type(field_t), intent(inout) :: fields(:)
    real(dp) :: impulse(3), change(3), most
    associate (link => shared%link(l))
      most = link%friction*max(0.0_dp, dot_product(link%impulse, link%normal))
      impulse = trial
      link%state = link_sticking
      if (norm2(trial) > most .or. most <= 0.0_dp) then
        impulse = trial*(most/max(norm2(trial), tiny(1.0_dp)))
        link%state = link_sliding
      end if
      change = impulse - link%rub
      call levers_give(levers, shared, n, l, change, node_velocity(shared%ndim), fields)
      call levers_give(levers, shared, n, l, change/dt, node_acceleration, fields)
      link%rub = impulse
    end associate
  end subroutine rub

  !> After the trial: books friction at a node. Where a velocity from before the end of the trial
  !! strains the particles, it is that before the kick or, `with_trial`, what particles receive.
  pure subroutine friction_close(levers, shared, n, fields, bodies, dt, part, with_trial, &
                                 work_part)
    type(levers_t), intent(inout) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: part               !! of the strain that comes from such a velocity
    logical, intent(in) :: with_trial
    real(dp), intent(in) :: work_part          !! see contact_step_t
    real(dp) :: kick(3, parts_of)
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      associate (link => shared%link(l), terms => shared%terms(n))
        link%drag = link%rub/dt
        if (levers%response(l) <= 0.0_dp) cycle
        kick = dt*levers_see(levers, shared, n, l, fields, bodies, node_acceleration, of_kick/dt)
        ! sum m (|a|^2 - |b|^2) = sum m (a - b) . (a + b)
        terms%nodes_aa = terms%nodes_aa - &
                         dot_product(link%rub, levers%pressed(:, 1, l) + kick(:, 1))/dt**2
        terms%power_before = terms%power_before - dot_product(link%rub, levers%before(:, 1, l))/dt
        terms%external_power = terms%external_power - &
                               work_part*dot_product(link%rub, levers%booked(:, l))
        if (part <= 0.0_dp) cycle
        levers%apart(:, :, l) = levers%before(:, :, l)
        if (with_trial) levers%apart(:, :, l) = levers%apart(:, :, l) + kick
        call book(levers, shared, n, l, part)
      end associate
    end do
  end subroutine friction_close

  !> Before a straining velocity is made to obey: the slip that it has.
  pure subroutine friction_measure(levers, shared, n, fields, bodies, column)
    type(levers_t), intent(inout) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: column              !! of the velocity
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      shared%link(l)%hold = 0.0_dp
      if (levers%response(l) <= 0.0_dp) cycle
      levers%apart(:, :, l) = levers_see(levers, shared, n, l, fields, bodies, column, &
                                          of_column(shared%ndim, column))
    end do
  end subroutine friction_measure

  !> Takes slip from the straining velocity of bodies that stick.
  pure subroutine friction_hold(levers, shared, n, bodies, column, fields)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: column
    type(field_t), intent(inout) :: fields(:)
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      if (levers%response(l) <= 0.0_dp .or. shared%link(l)%state /= link_sticking) cycle
      associate (link => shared%link(l))
        link%hold = sum(levers_see(levers, shared, n, l, fields, bodies, column, &
                                    of_column(shared%ndim, column)), dim=2)/ &
                    levers%response(l)
        call levers_give(levers, shared, n, l, link%hold, column, fields)
      end associate
    end do
  end subroutine friction_hold

  !> Books what friction took through the velocity that strained the particles after the kick.
  pure subroutine friction_settle(levers, shared, n, part)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n
    real(dp), intent(in) :: part               !! of the strain that it makes
    integer :: l
    do l = shared%link_start(n), shared%link_start(n + 1) - 1
      if (levers%response(l) > 0.0_dp) call book(levers, shared, n, l, part)
    end do
  end subroutine friction_settle

  !> Energy that friction takes through one straining velocity (sgmp_contact_ledger).
  pure subroutine book(levers, shared, n, l, part)
    type(levers_t), intent(in) :: levers
    type(shared_nodes_t), intent(inout) :: shared
    integer, intent(in) :: n, l
    real(dp), intent(in) :: part
    associate (link => shared%link(l), terms => shared%terms(n), apart => levers%apart(:, :, l), &
               pull => levers%pull(:, :, l))
      link%dissipation = link%dissipation + part* &
        (dot_product(link%rub, sum(apart, dim=2)) - dot_product(link%hold, sum(pull, dim=2)))
      terms%rigid_work = terms%rigid_work + part*(dot_product(link%rub, apart(:, 2)) - &
                                                  dot_product(link%hold, pull(:, 2)))
      terms%external_power = terms%external_power - &
                             part*dot_product(link%hold, levers%external(:, l))
    end associate
  end subroutine book

end module sgmp_contact_friction
