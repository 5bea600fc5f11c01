!> Failure of ductile metals by a damage that grows with plastic strain, the faster the more the
!! stress pulls (theory 4). Either by the work of the largest principal stress (Cockcroft and Latham
!! 1968, J. Inst. Metals 96, 33), with a critical work Wc per volume,
!!
!!     dD = max(s1, 0) de/Wc,                                                           (CL1)
!!
!! or by a strain at failure that knows the mean stress and the Lode angle, Hosford and Coulomb's
!! (Mohr and Marcadet 2015, Int. J. Solids Struct. 67-68, 40), with principal stresses
!! s1 >= s2 >= s3 over von Mises' stress,
!!
!!     dD = de/ef,     ef = b ((1 + c)/g)^(1/n),                                        (HC1)
!!     g = (((s1 - s2)^a + (s2 - s3)^a + (s1 - s3)^a)/2)^(1/a) + c (s1 + s3),
!!
!! so that b is the strain at failure in uniaxial and in equibiaxial tension; where g <= 0 nothing
!! fails. a = 1 is Mohr and Coulomb's, a = 2 von Mises' with a pressure. The stress is that at the
!! end of a step.
module sgmp_ductility
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  implicit none
  private
  public :: ductility_check, ductility_given, ductility_keys, ductility_lanes, ductility_read, &
            ductility_strain, ductility_t, principal_deviators

  integer, parameter :: components = 6  !! of a stress in space
  real(dp), parameter :: pi = acos(-1.0_dp)
  real(dp), parameter :: largest = 300.0_dp  !! logarithm of a strain over b that is taken for one

  !> Constants; no work and no strain: no such failure.
  type :: ductility_t
    real(dp) :: work = 0.0_dp        !! Wc (stress)
    real(dp) :: strain = 0.0_dp      !! b
    real(dp) :: exponent = 2.0_dp    !! a
    real(dp) :: friction = 0.0_dp    !! c
    real(dp) :: power = 0.1_dp       !! n
  end type ductility_t

contains

  !> Keys of the card `failure`.
  function ductility_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('plastic_work', kind_real, 'critical work per volume of the largest principal '// &
                'stress, in tension, in plastic strain (Cockcroft and Latham)', unit='stress', &
                range='(0,inf)'), &
            key('hosford_strain', kind_real, 'b of Hosford and Coulomb: plastic strain at '// &
                'failure in uniaxial tension, b ((1 + c)/g)^(1/n) at any stress, see '// &
                'doc/materials.md', range='(0,inf)'), &
            key('hosford_exponent', kind_real, 'a of it; with hosford_strain', range='[1,inf)'), &
            key('hosford_friction', kind_real, 'c of it; with hosford_strain', range='[0,inf)'), &
            key('hosford_power', kind_real, 'n of it; default: 0.1', range='(0,inf)')]
  end function ductility_keys

  !> Constants from the values of those keys.
  pure function ductility_read(values) result(law)
    class(values_t), intent(in) :: values
    type(ductility_t) :: law
    law%work = values%number('plastic_work')
    law%strain = values%number('hosford_strain')
    law%exponent = values%number('hosford_exponent', 2.0_dp)
    law%friction = values%number('hosford_friction')
    law%power = values%number('hosford_power', 0.1_dp)
  end function ductility_read

  !> Whether the keys go together.
  pure subroutine ductility_check(values, fault)
    class(values_t), intent(in) :: values
    type(fault_t), allocatable, intent(inout) :: fault
    character(*), parameter :: b = 'hosford_strain'
    logical :: shape
    if (allocated(fault)) return
    shape = values%has('hosford_exponent') .and. values%has('hosford_friction')
    if (values%has('plastic_work') .and. values%has(b)) then
      call fault_make(fault, 'plastic_work', 'there is one damage, and two laws say how it grows', &
                      'keep plastic_work or hosford_strain')
    else if (values%has(b) .and. .not. shape) then
      call fault_make(fault, b, 'Hosford and Coulomb need hosford_exponent and '// &
                      'hosford_friction', 'give both')
    else if (.not. values%has(b) .and. (values%has('hosford_exponent') .or. &
                                        values%has('hosford_friction') .or. &
                                        values%has('hosford_power'))) then
      call fault_make(fault, '', 'Hosford and Coulomb need hosford_strain', 'give it')
    end if
  end subroutine ductility_check

  !> Whether matter fails so.
  elemental logical function ductility_given(law) result(yes)
    type(ductility_t), intent(in) :: law
    yes = law%work > 0.0_dp .or. law%strain > 0.0_dp
  end function ductility_given

  !> Principal deviators over von Mises' stress, the largest first, in closed form (Smith 1961), and
  !! that stress. None where there is none.
  pure subroutine principal_deviators(deviator, principal, mises)
    real(dp), intent(in) :: deviator(components)  !! in Voigt's order: xx yy zz xy yz xz
    real(dp), intent(out) :: principal(3), mises
    real(dp) :: size, determinant, angle
    size = sqrt((sum(deviator(:3)**2) + 2.0_dp*sum(deviator(4:)**2))/6.0_dp)
    mises = 3.0_dp*size
    principal = 0.0_dp
    if (.not. size > 0.0_dp) return
    determinant = deviator(1)*(deviator(2)*deviator(3) - deviator(5)**2) &
                  - deviator(4)*(deviator(4)*deviator(3) - deviator(5)*deviator(6)) &
                  + deviator(6)*(deviator(4)*deviator(5) - deviator(2)*deviator(6))
    angle = acos(max(-1.0_dp, min(1.0_dp, 0.5_dp*determinant/size**3)))/3.0_dp
    principal = 2.0_dp/3.0_dp*[cos(angle), cos(angle - 2.0_dp*pi/3.0_dp), &
                               cos(angle + 2.0_dp*pi/3.0_dp)]
  end subroutine principal_deviators

  !> Strain at failure of (HC1); huge where nothing fails.
  pure real(dp) function ductility_strain(law, mean, principal) result(strain)
    type(ductility_t), intent(in) :: law
    real(dp), intent(in) :: mean          !! of the stress, over von Mises'
    real(dp), intent(in) :: principal(3)  !! deviators over von Mises', the largest first
    real(dp) :: g, most
    most = principal(1) - principal(3)
    g = most*((((principal(1) - principal(2))/most)**law%exponent + &
               ((principal(2) - principal(3))/most)**law%exponent + 1.0_dp)/2.0_dp) &
        **(1.0_dp/law%exponent) &
        + law%friction*(2.0_dp*mean + principal(1) + principal(3))
    strain = huge(1.0_dp)
    if (g <= 0.0_dp) return
    ! By logarithms: (1 + c)/g to the power of ten and more may overflow.
    if (log((1.0_dp + law%friction)/g) > law%power*largest) return
    strain = law%strain*((1.0_dp + law%friction)/g)**(1.0_dp/law%power)
  end function ductility_strain

  !> Lane kernel: damage by a step.
  pure subroutine ductility_lanes(law, mean, deviator, increment, damage)
    type(ductility_t), intent(in) :: law
    real(dp), intent(in) :: mean(lanes), deviator(lanes, components)  !! at the end of the step
    real(dp), intent(in) :: increment(lanes)     !! of the equivalent plastic strain
    real(dp), intent(inout) :: damage(lanes)
    real(dp) :: principal(3), mises
    integer :: p
    do p = 1, lanes
      if (.not. increment(p) > 0.0_dp) cycle
      call principal_deviators(deviator(p, :), principal, mises)
      if (.not. mises > 0.0_dp) cycle
      if (law%work > 0.0_dp) then
        damage(p) = damage(p) + max(mean(p) + mises*principal(1), 0.0_dp)*increment(p)/law%work
      else
        damage(p) = damage(p) + increment(p)/ductility_strain(law, mean(p)/mises, principal)
      end if
      damage(p) = min(damage(p), 1.0_dp)
    end do
  end subroutine ductility_lanes

end module sgmp_ductility
