!> Bodies with prescribed motion: their speed, and what their nodes hold.
module sgmp_rigid_bodies
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_inverse_mass, node_velocity
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: rigid_choose_speed, rigid_solve, rigid_velocity, rigid_field

contains

  !> The rigid body that a field belongs to, 0 if it has none.
  pure function rigid_field(bodies, f) result(b)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: f
    integer :: b
    do b = 1, size(bodies)
      if (bodies(b)%field == f .and. bodies(b)%rigid) return
    end do
    b = 0
  end function rigid_field

  !> Velocities of rigid bodies at a time, the middle of the step.
  subroutine rigid_choose_speed(bodies, time, ndim)
    type(body_t), intent(inout) :: bodies(:)
    real(dp), intent(in) :: time
    integer, intent(in) :: ndim
    real(dp), parameter :: nowhere(3) = 0.0_dp
    integer :: b, d
    do b = 1, size(bodies)
      if (.not. bodies(b)%rigid) cycle
      bodies(b)%speed_before = bodies(b)%speed
      do d = 1, ndim
        bodies(b)%speed(d) = bodies(b)%motion(d)%evaluate(nowhere, nowhere, time)
      end do
    end do
  end subroutine rigid_choose_speed

  !> Nodal acceleration and velocity of a rigid body.
  subroutine rigid_solve(body, field, dt)
    type(body_t), intent(in) :: body
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: dt
    integer :: d
    if (rigid_known(body, field)) return
    do d = 1, field%ndim
      field%node(:, d) = (body%speed(d) - body%speed_before(d))/dt
    end do
    call rigid_velocity(body, field, node_velocity(field%ndim))
  end subroutine rigid_solve

  !> Nodal velocity of a rigid body, in the vector that starts at `column`.
  subroutine rigid_velocity(body, field, column)
    type(body_t), intent(in) :: body
    type(field_t), intent(inout) :: field
    integer, intent(in) :: column
    integer :: d
    if (rigid_known(body, field)) return
    do d = 1, field%ndim
      field%node(:, column + d - 1) = body%speed(d)
    end do
    field%node(:, node_inverse_mass(field%ndim)) = 1.0_dp
  end subroutine rigid_velocity

  !> Whether the nodes of a body at rest hold what they always will: a new layout sets them to zero.
  pure function rigid_known(body, field) result(known)
    type(body_t), intent(in) :: body
    type(field_t), intent(in) :: field
    logical :: known
    known = .false.
    if (.not. body%at_rest .or. field%points == 0) return
    known = field%node(1, node_inverse_mass(field%ndim)) > 0.0_dp
  end function rigid_known

end module sgmp_rigid_bodies
