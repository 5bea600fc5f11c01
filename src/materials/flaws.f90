!> Fragmentation of brittle matter by flaws in it (Grady and Kipp 1980, Int. J. Rock Mech. Min. Sci.
!! 17, 147; as Benz and Asphaug 1995, Comput. Phys. Commun. 87, 253, have it particle by particle;
!! theory 4).
!!
!! Of the flaws in a unit of volume k e^m grow at strains below e (Weibull 1939). The weakest of a
!! particle of volume V grows at e1 = (x/(k V))^(1/m), x of an exponential distribution, which the
!! seed and the number of the particle alone determine; at a strain e > e1
!!
!!     n = 1 + k V (e^m - e1^m)                                                         (GK1)
!!
!! of its flaws grow in the mean, and each crack relieves the stress around it while it grows with
!! the speed c over the particle's radius R, V = 4/3 pi R^3,
!!
!!     d(D^(1/3))/dt = n c/R,   0 <= D <= 1.                                            (GK2)
!!
!! e is the largest principal stress of undamaged matter over Young's modulus. D scales the deviator
!! and the tension (sgmp_softening). Benz and Asphaug give each particle a finite number of flaws
!! and bound D by the part of them that grows; so does N, the number of flaws of a particle that
!! breaks it,
!!
!!     D <= n/N.                                                                        (GK3)
module sgmp_flaws
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: flaws_advance, flaws_crack_speed, flaws_first, flaws_growing, flaws_t

  real(dp), parameter :: pi = acos(-1.0_dp)
  real(dp), parameter :: flaws_crack_speed = 0.4_dp  !! over that of longitudinal waves, by default

  !> Constants; no flaws: no such failure.
  type :: flaws_t
    real(dp) :: number = 0.0_dp      !! k (1/volume)
    real(dp) :: exponent = 1.0_dp    !! m
    real(dp) :: speed = 0.0_dp       !! c of cracks
    real(dp) :: count = 1.0_dp       !! N
  end type flaws_t

contains

  !> Strain of the weakest flaw of a particle, and its radius.
  pure subroutine flaws_first(law, volume, variate, strain, radius)
    type(flaws_t), intent(in) :: law
    real(dp), intent(in) :: volume       !! of the particle in space
    real(dp), intent(in) :: variate      !! x, above 0
    real(dp), intent(out) :: strain, radius
    strain = (variate/(law%number*volume))**(1.0_dp/law%exponent)
    radius = (0.75_dp*volume/pi)**(1.0_dp/3.0_dp)
  end subroutine flaws_first

  !> How many flaws grow, by (GK1); none below the first strain.
  pure real(dp) function flaws_growing(law, strain, first, radius) result(growing)
    type(flaws_t), intent(in) :: law
    real(dp), intent(in) :: strain, first, radius
    growing = 0.0_dp
    if (strain <= first) return
    growing = 1.0_dp + law%number*4.0_dp/3.0_dp*pi*radius**3 &
              *(strain**law%exponent - first**law%exponent)
  end function flaws_growing

  !> Lane kernel: damage after a step, by (GK2).
  pure subroutine flaws_advance(law, dt, strain, first, radius, damage)
    type(flaws_t), intent(in) :: law
    real(dp), intent(in) :: dt
    real(dp), intent(in) :: strain(lanes)        !! of the largest principal stress
    real(dp), intent(in) :: first(lanes), radius(lanes)
    real(dp), intent(inout) :: damage(lanes)
    real(dp) :: growing, root
    integer :: l
    do l = 1, lanes
      if (damage(l) >= 1.0_dp) cycle
      growing = flaws_growing(law, strain(l), first(l), radius(l))
      if (.not. growing > 0.0_dp) cycle
      root = max(damage(l), 0.0_dp)**(1.0_dp/3.0_dp) + growing*law%speed*dt/radius(l)
      damage(l) = max(damage(l), min(root**3, growing/law%count, 1.0_dp))
    end do
  end subroutine flaws_advance

end module sgmp_flaws
