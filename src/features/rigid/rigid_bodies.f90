!> Rigid bodies: their speed, and what their nodes hold.
module sgmp_rigid_bodies
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_inverse_mass, node_velocity
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_place, mesh_t
  use sgmp_rigid_motion, only: motion_advance, motion_plan
  use sgmp_rows, only: key_j, key_k
  implicit none
  private
  public :: rigid_advance, rigid_choose_speed, rigid_solve, rigid_velocity, rigid_field

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

  !> Velocities of rigid bodies whose motion is prescribed, at a time: the middle of the step.
  subroutine rigid_choose_speed(bodies, time, dt, ndim)
    type(body_t), intent(inout) :: bodies(:)
    real(dp), intent(in) :: time
    real(dp), intent(in) :: dt               !! position step
    integer, intent(in) :: ndim
    real(dp), parameter :: nowhere(3) = 0.0_dp
    integer :: b, d
    do b = 1, size(bodies)
      if (.not. bodies(b)%rigid) cycle
      bodies(b)%speed_before = bodies(b)%speed
      if (bodies(b)%rigid_motion%free) cycle
      do d = 1, ndim
        bodies(b)%speed(d) = bodies(b)%motion(d)%evaluate(nowhere, nowhere, time)
      end do
      associate (motion => bodies(b)%rigid_motion)
        if (.not. motion%turns) cycle
        do d = 1, 3
          motion%spin(d) = motion%omega(d)%evaluate(nowhere, nowhere, time)
        end do
        call motion_plan(motion, bodies(b)%speed, dt)
      end associate
    end do
  end subroutine rigid_choose_speed

  !> Bodies whose motion is prescribed are where the step has taken them.
  pure subroutine rigid_advance(bodies, dt)
    type(body_t), intent(inout) :: bodies(:)
    real(dp), intent(in) :: dt               !! position step
    integer :: b
    do b = 1, size(bodies)
      if (.not. bodies(b)%rigid .or. bodies(b)%rigid_motion%free) cycle
      call motion_advance(bodies(b)%rigid_motion, bodies(b)%speed, bodies(b)%speed_before, dt)
    end do
  end subroutine rigid_advance

  !> Nodal acceleration and velocity of a rigid body.
  subroutine rigid_solve(body, mesh, field, dt)
    type(body_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(inout) :: field
    real(dp), intent(in) :: dt
    real(dp), parameter :: none(3, 3) = 0.0_dp
    integer :: d
    if (rigid_known(body, field)) return
    if (body%rigid_motion%turns) then
      associate (motion => body%rigid_motion)
        call fill(mesh, motion%centre, (body%speed - body%speed_before)/dt, &
                  (motion%gradient - motion%gradient_before)/dt, 1, field)
      end associate
    else
      do d = 1, field%ndim
        field%node(:, d) = (body%speed(d) - body%speed_before(d))/dt
      end do
    end if
    call rigid_velocity(body, mesh, .false., node_velocity(field%ndim), field)
  end subroutine rigid_solve

  !> Nodal velocity of a rigid body, in the vector that starts at `column`.
  subroutine rigid_velocity(body, mesh, before_kick, column, field)
    type(body_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: before_kick       !! the velocity of the step before
    integer, intent(in) :: column
    type(field_t), intent(inout) :: field
    integer :: d
    if (rigid_known(body, field)) return
    if (body%rigid_motion%turns) then
      associate (motion => body%rigid_motion)
        call fill(mesh, motion%centre, body%speed, &
                  merge(motion%gradient_before, motion%gradient, before_kick), column, field)
      end associate
    else
      do d = 1, field%ndim
        field%node(:, column + d - 1) = body%speed(d)
      end do
    end if
    field%node(:, node_inverse_mass(field%ndim)) = 1.0_dp
  end subroutine rigid_velocity

  !> A nodal vector that is linear in the place, in the columns from `column` on.
  pure subroutine fill(mesh, centre, vector, gradient, column, field)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: centre(3), vector(3), gradient(3, 3)
    integer, intent(in) :: column
    type(field_t), intent(inout) :: field
    real(dp) :: arm(3)
    integer :: s, i, d
    arm = 0.0_dp
    do s = 1, field%store%n
      if (field%ndim == 2) arm(2) = away(2, key_k(field%store%key(s)))
      if (field%ndim == 3) arm(2) = away(2, key_j(field%store%key(s)))
      if (field%ndim == 3) arm(3) = away(3, key_k(field%store%key(s)))
      do i = field%store%first(s), field%store%last(s)
        arm(1) = away(1, i)
        do d = 1, field%ndim
          field%node(field%base(s) + i, column + d - 1) = vector(d) + &
                                                          dot_product(gradient(d, :), arm)
        end do
      end do
    end do

  contains

    !> From the centre to a point of the grid along an axis.
    pure function away(axis, point) result(distance)
      integer, intent(in) :: axis, point
      real(dp) :: distance
      distance = mesh_place(mesh, axis, real(point, dp)) - centre(axis)
    end function away

  end subroutine fill

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
