!> How a rigid body moves beyond a velocity that is the same everywhere: it turns, about a point, as
!! prescribed or by its own inertia, and it may be free (doc/loads.md).
!!
!! The velocity that moves the body in a step is linear in the place, u = v + G (x - c) with
!! dt G = R - 1, R the rotation of the step: grids carry linear functions exactly, so particles keep
!! their distances to round-off. Seen from the positions at the end of the step the same velocity is
!! v + B (x - c) with dt B = 1 - R^T.
module sgmp_rigid_motion
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  use sgmp_rotor, only: rotor_free, rotor_growth, rotor_identity, rotor_matrix, rotor_of, &
                        rotor_product
  use sgmp_space, only: space_axisymmetric
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: rigid_motion_t, motion_axes, motion_inertia, motion_jerk, motion_kick, &
            motion_plan, motion_advance, motion_energy, motion_spin, motion_at, motion_start
  public :: freedoms

  integer, parameter :: freedoms = 6             !! of a rigid body in space: along axes, about them

  !> State of a rigid body's motion; vectors along the axes of the scene.
  type :: rigid_motion_t
    logical :: free = .false.                    !! forces move it
    logical :: turns = .false.                   !! it may turn
    type(expression_t) :: omega(3)               !! prescribed angular velocity, functions of t
    real(dp) :: centre(3) = 0.0_dp               !! c: centre of mass, or the point it turns about
    real(dp) :: attitude(4) = rotor_identity     !! rotation since the start
    real(dp) :: spin(3) = 0.0_dp                 !! angular velocity in this step
    real(dp) :: gradient(3, 3) = 0.0_dp          !! G of this step
    real(dp) :: gradient_before(3, 3) = 0.0_dp   !! B of the one before
    real(dp) :: turn(4) = rotor_identity         !! R of this step
    ! of free bodies
    real(dp) :: mass = 0.0_dp
    real(dp) :: heavier = 1.0_dp                 !! that mass over the one of its matter
    real(dp) :: inertia(3, 3) = 0.0_dp, inverse(3, 3) = 0.0_dp
      !! about the centre of mass, as the body lay at the start
    real(dp) :: momentum(freedoms) = 0.0_dp      !! linear, and angular about the centre of mass
    real(dp) :: trial(freedoms) = 0.0_dp      !! the same at the end of the step at hand
    real(dp) :: push(freedoms) = 0.0_dp      !! what gravity and body forces give in it
    real(dp) :: impulse(freedoms) = 0.0_dp      !! what contact has given since the start
    real(dp) :: last_change(3) = 0.0_dp, last_growth(3, 3) = 0.0_dp
      !! change of velocity in the step before: at the centre, and its gradient
  end type rigid_motion_t

  real(dp), parameter :: singular = 1.0e-14_dp   !! determinant over the cube of the largest element

contains

  !> Which of the six directions a body may move in: along the axes, about them.
  pure function motion_axes(space) result(axes)
    integer, intent(in) :: space
    logical :: axes(freedoms)
    select case (space)
    case (1)
      axes = [.true., .false., .false., .false., .false., .false.]
    case (2)
      axes = [.true., .true., .false., .false., .false., .true.]
    case (space_axisymmetric)
      axes = [.false., .true., .false., .false., .false., .false.]
    case default
      axes = .true.
    end select
  end function motion_axes

  !> Sets the inertia of a body from its second moments, sum m x x^T about its centre of mass.
  pure subroutine motion_inertia(motion, space, mass, moments)
    type(rigid_motion_t), intent(inout) :: motion
    integer, intent(in) :: space
    real(dp), intent(in) :: mass, moments(3, 3)
    logical :: axes(freedoms)
    integer :: d
    axes = motion_axes(space)
    motion%mass = mass
    motion%inertia = -moments
    do d = 1, 3
      motion%inertia(d, d) = moments(1, 1) + moments(2, 2) + moments(3, 3) - moments(d, d)
    end do
    motion%inverse = 0.0_dp
    if (all(axes(4:))) then
      motion%inverse = inverse_of(motion%inertia)
    else if (axes(6) .and. motion%inertia(3, 3) > 0.0_dp) then
      motion%inverse(3, 3) = 1.0_dp/motion%inertia(3, 3)
    end if
  end subroutine motion_inertia

  !> Inverse of a symmetric matrix; zero where there is none: points on a line have no inertia
  !! about it.
  pure function inverse_of(a) result(b)
    real(dp), intent(in) :: a(3, 3)
    real(dp) :: b(3, 3)
    real(dp) :: determinant
    b(:, 1) = cross(a(:, 2), a(:, 3))
    b(:, 2) = cross(a(:, 3), a(:, 1))
    b(:, 3) = cross(a(:, 1), a(:, 2))
    determinant = dot_product(a(1, :), b(:, 1))
    if (abs(determinant) <= singular*maxval(abs(a))**3) then
      b = 0.0_dp
    else
      b = b/determinant
    end if
  end function inverse_of

  !> Angular velocity of a free body at an angular momentum.
  pure function motion_spin(motion, momentum) result(spin)
    type(rigid_motion_t), intent(in) :: motion
    real(dp), intent(in) :: momentum(3)
    real(dp) :: spin(3)
    real(dp) :: r(3, 3)
    r = rotor_matrix(motion%attitude)
    spin = matmul(r, matmul(motion%inverse, matmul(momentum, r)))
  end function motion_spin

  !> Kinetic energy of a free body.
  pure function motion_energy(motion) result(energy)
    type(rigid_motion_t), intent(in) :: motion
    real(dp) :: energy
    energy = 0.5_dp*(dot_product(motion%momentum(:3), motion%momentum(:3))/motion%mass + &
                     dot_product(motion%momentum(4:), motion_spin(motion, motion%momentum(4:))))
  end function motion_energy

  !> Plans a step: the rotation in it, by the angular velocity or for free bodies by the momentum.
  pure subroutine motion_plan(motion, speed, dt)
    type(rigid_motion_t), intent(inout) :: motion
    real(dp), intent(inout) :: speed(3)          !! of a free body: set
    real(dp), intent(in) :: dt
    if (motion%free) then
      speed = motion%trial(:3)/motion%mass
      motion%spin = motion_spin(motion, motion%trial(4:))
    end if
    if (.not. motion%turns) return
    if (motion%free) then
      motion%turn = rotor_free(motion%attitude, motion%inverse, motion%trial(4:), dt)
    else
      motion%turn = rotor_of(dt*motion%spin)
    end if
    motion%gradient = rotor_growth(motion%turn)/dt
  end subroutine motion_plan

  !> Ends a step.
  pure subroutine motion_advance(motion, speed, speed_before, dt)
    type(rigid_motion_t), intent(inout) :: motion
    real(dp), intent(in) :: speed(3), speed_before(3), dt
    real(dp) :: back(4)
    if (.not. (motion%free .or. motion%turns)) return
    motion%last_change = speed - speed_before
    motion%last_growth = motion%gradient - motion%gradient_before
    motion%centre = motion%centre + dt*speed
    if (.not. motion%turns) return
    motion%attitude = rotor_product(motion%turn, motion%attitude)
    back = [motion%turn(1), -motion%turn(2:)]
    motion%gradient_before = -rotor_growth(back)/dt
  end subroutine motion_advance

  !> Sets the gradients of a body that has yet to move.
  pure subroutine motion_start(motion)
    type(rigid_motion_t), intent(inout) :: motion
    associate (w => motion%spin)
      motion%gradient_before = reshape([0.0_dp, w(3), -w(2), -w(3), 0.0_dp, w(1), &
                                        w(2), -w(1), 0.0_dp], [3, 3])
    end associate
    motion%gradient = motion%gradient_before
  end subroutine motion_start

  !> Velocity at a place that moves with a body.
  pure function motion_at(motion, speed, place) result(velocity)
    type(rigid_motion_t), intent(in) :: motion
    real(dp), intent(in) :: speed(3), place(3)
    real(dp) :: velocity(3)
    velocity = speed
    if (motion%turns) velocity = speed + matmul(motion%gradient, place - motion%centre)
  end function motion_at

  !> Change of that velocity since the step before, for a change of the body's.
  pure function motion_kick(motion, change, place) result(kick)
    type(rigid_motion_t), intent(in) :: motion
    real(dp), intent(in) :: change(3), place(3)
    real(dp) :: kick(3)
    kick = change
    if (motion%turns) kick = change + matmul(motion%gradient - motion%gradient_before, &
                                             place - motion%centre)
  end function motion_kick

  !> How that change differs from the one in the step before.
  pure function motion_jerk(motion, change, place) result(jerk)
    type(rigid_motion_t), intent(in) :: motion
    real(dp), intent(in) :: change(3), place(3)
    real(dp) :: jerk(3)
    jerk = motion_kick(motion, change, place) - &
           (motion%last_change + matmul(motion%last_growth, place - motion%centre))
  end function motion_jerk

end module sgmp_rigid_motion
