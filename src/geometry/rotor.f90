!> Rotations as unit quaternions (scalar first), and the step of a rigid body that turns without
!! torque (doc/loads.md).
!!
!! With p = R^T L the angular momentum in the frame of the body, J the inverse of its inertia there,
!! and w = J (p0 + p1)/2, the step turns the body about w by dt |w|, so p1 = exp(-dt w^) p0: the
!! implicit midpoint rule of Euler's equations with a step dt' = 2/|w| tan(dt |w|/2). It keeps all
!! that is quadratic in p: |p| and the energy p.Jp/2. L is not touched, and R1 p1 = L by
!! construction.
module sgmp_rotor
  use sgmp_kinds, only: dp
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: rotor_identity, rotor_of, rotor_product, rotor_turn, rotor_matrix, rotor_growth, &
            rotor_free

  real(dp), parameter :: rotor_identity(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
  real(dp), parameter :: largest_turn = 0.3_dp     !! radians in a step of the midpoint rule
  real(dp), parameter :: settled = 4.0_dp*epsilon(1.0_dp)
  integer, parameter :: most_rounds = 60

contains

  !> The rotation about a vector by its length in radians.
  pure function rotor_of(vector) result(q)
    real(dp), intent(in) :: vector(3)
    real(dp) :: q(4)
    real(dp) :: half
    half = 0.5_dp*norm2(vector)
    q(1) = cos(half)
    q(2:) = 0.5_dp*vector
    if (half > 0.0_dp) q(2:) = vector*(sin(half)/(2.0_dp*half))
  end function rotor_of

  !> The rotation b and then a, its length put right.
  pure function rotor_product(a, b) result(c)
    real(dp), intent(in) :: a(4), b(4)
    real(dp) :: c(4)
    c(1) = a(1)*b(1) - dot_product(a(2:), b(2:))
    c(2:) = a(1)*b(2:) + b(1)*a(2:) + cross(a(2:), b(2:))
    c = c/norm2(c)
  end function rotor_product

  !> A vector turned.
  pure function rotor_turn(q, vector) result(turned)
    real(dp), intent(in) :: q(4), vector(3)
    real(dp) :: turned(3)
    turned = vector + matmul(rotor_growth(q), vector)
  end function rotor_turn

  !> R of a rotation.
  pure function rotor_matrix(q) result(r)
    real(dp), intent(in) :: q(4)
    real(dp) :: r(3, 3)
    integer :: d
    r = rotor_growth(q)
    do d = 1, 3
      r(d, d) = r(d, d) + 1.0_dp
    end do
  end function rotor_matrix

  !> R - 1 of a rotation, without the loss of digits that subtraction would bring.
  pure function rotor_growth(q) result(r)
    real(dp), intent(in) :: q(4)
    real(dp) :: r(3, 3)
    real(dp) :: skew(3, 3)
    skew = reshape([0.0_dp, q(4), -q(3), -q(4), 0.0_dp, q(2), q(3), -q(2), 0.0_dp], [3, 3])
    r = 2.0_dp*(q(1)*skew + matmul(skew, skew))
  end function rotor_growth

  !> The rotation in space that a body without torque makes in a time.
  pure function rotor_free(attitude, inverse, momentum, dt) result(turn)
    real(dp), intent(in) :: attitude(4)
    real(dp), intent(in) :: inverse(3, 3)      !! of the inertia, in the frame of the body
    real(dp), intent(in) :: momentum(3)        !! angular, in space
    real(dp), intent(in) :: dt
    real(dp) :: turn(4)
    real(dp) :: back(4), before(3), after(3), last(3), way(3), part
    integer :: steps, step, round
    turn = rotor_identity
    steps = 1 + int(min(dt*norm2(inverse)*norm2(momentum)/largest_turn, 1.0e6_dp))
    part = dt/steps
    do step = 1, steps
      back = rotor_product(turn, attitude)
      back(2:) = -back(2:)
      before = rotor_turn(back, momentum)
      after = before
      do round = 1, most_rounds
        last = after
        way = part*matmul(inverse, 0.5_dp*(before + after))
        after = rotor_turn(rotor_of(-way), before)
        if (maxval(abs(after - last)) <= settled*norm2(before)) exit
      end do
      back(2:) = -back(2:)
      turn = rotor_product(rotor_of(rotor_turn(back, way)), turn)
    end do
  end function rotor_free

end module sgmp_rotor
