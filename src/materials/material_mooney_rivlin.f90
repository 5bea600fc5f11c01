!> Mooney and Rivlin's rubber (1940, 1948), compressible (theory 4):
!!
!!     W = C1 (I1 - 3) + C2 (I2 - 3) - 2 (C1 + 2 C2) ln J + (lambda - 4 C2)/2 (ln J)^2     (R2)
!!     sigma = (2 A + ((lambda - 4 C2) ln J - 2 (C1 + 2 C2)) I)/J,
!!     A = (C1 + C2 I1) b - C2 b^2,  b = F F^T
!!
!! with I1, I2 of b itself (Ciarlet 1988, 4.10): small strains have the moduli mu = 2 (C1 + C2) and
!! lambda, and without C2 it is the neo-Hookean law, at any volume. Where the volume is kept,
!! differences of stresses are those of the incompressible law. A wave along n has the modulus
!! (2 n.A n + 2 (C1 + 2 C2) + (lambda - 4 C2)(1 - ln J))/J.
module sgmp_material_mooney_rivlin
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_elastic, only: elastic_init, elastic_t, moduli_keys
  use sgmp_material_history, only: history_t
  use sgmp_voigt, only: voigt_axes
  implicit none
  private
  public :: mooney_rivlin_keys, mooney_rivlin_read
  public :: mooney_rivlin_t, mooney_rivlin_init, mooney_rivlin_stress

  integer, parameter :: components = 6  !! of a tensor in space
  integer, parameter :: row(components) = voigt_axes(1, :), column(components) = voigt_axes(2, :)

  !> Constants of (R2).
  type :: mooney_rivlin_t
    real(dp) :: c1 = 0.0_dp, c2 = 0.0_dp  !! (stress)
    real(dp) :: start = 0.0_dp            !! 2 (C1 + 2 C2): no stress at the start (stress)
    real(dp) :: volume = 0.0_dp           !! lambda - 4 C2, of the logarithm (stress)
  end type mooney_rivlin_t

contains

  !> Keys of the law.
  function mooney_rivlin_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    type(key_t), allocatable :: moduli(:)
    moduli = moduli_keys()
    keys = [key('c1', kind_real, 'factor of the first invariant; 2 (c1 + c2) is the shear '// &
                'modulus', unit='stress', range='(0,inf)', required=.true.), &
            key('c2', kind_real, 'factor of the second invariant', unit='stress', &
                range='[0,inf)', default='0'), &
            moduli(2)]
  end function mooney_rivlin_keys

  !> Law from the values of its keys.
  pure subroutine mooney_rivlin_read(density, values, law, elastic, history, fault)
    real(dp), intent(in) :: density
    class(values_t), intent(in) :: values
    type(mooney_rivlin_t), intent(out) :: law
    type(elastic_t), intent(out) :: elastic    !! of small strains
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    associate (c1 => values%number('c1'), c2 => values%number('c2'), &
               poisson => values%number('poisson'))
      elastic = elastic_init(density, 4.0_dp*(c1 + c2)*(1.0_dp + poisson), poisson)
      law = mooney_rivlin_init(c1, c2, elastic%lambda)
    end associate
    history%deformation = .true.
    if (law%c2 > 0.0_dp .and. law%volume < 0.0_dp) then
      call fault_make(fault, 'poisson', 'such a rubber would collapse under pressure', &
                      'poisson/(1 - 2 poisson) is at least c2/(c1 + c2), as it always is from '// &
                      '1/3 on')
    end if
  end subroutine mooney_rivlin_read

  !> Constants from plain numbers.
  pure function mooney_rivlin_init(c1, c2, lambda) result(law)
    real(dp), intent(in) :: c1, c2     !! (stress)
    real(dp), intent(in) :: lambda     !! Lame's first constant of small strains (stress)
    type(mooney_rivlin_t) :: law
    law%c1 = c1
    law%c2 = c2
    law%start = 2.0_dp*(c1 + 2.0_dp*c2)
    law%volume = lambda - 4.0_dp*c2
  end function mooney_rivlin_init

  !> Lane kernel: stress, and the largest modulus of waves along the axes.
  pure subroutine mooney_rivlin_stress(law, n, b, j, log_j, stress, modulus)
    type(mooney_rivlin_t), intent(in) :: law
    integer, intent(in) :: n                          !! components stored
    real(dp), intent(in) :: b(lanes, n)               !! F F^T, in Voigt's order
    real(dp), intent(in) :: j(lanes), log_j(lanes)    !! volume over the initial one
    real(dp), intent(out) :: stress(lanes, n), modulus(lanes)  !! (stress)
    real(dp) :: full(3, 3), along, a
    integer :: l, c
    do l = 1, lanes
      full = 0.0_dp
      do c = 1, n
        full(row(c), column(c)) = b(l, c)
        full(column(c), row(c)) = b(l, c)
      end do
      along = 0.0_dp
      do c = 1, n
        a = (law%c1 + law%c2*(full(1, 1) + full(2, 2) + full(3, 3)))*b(l, c) &
            - law%c2*dot_product(full(:, row(c)), full(:, column(c)))
        stress(l, c) = 2.0_dp*a/j(l)
        if (c > 3) cycle
        stress(l, c) = stress(l, c) + (law%volume*log_j(l) - law%start)/j(l)
        along = max(along, a)
      end do
      modulus(l) = (2.0_dp*along + law%start + law%volume*(1.0_dp - log_j(l)))/j(l)
    end do
  end subroutine mooney_rivlin_stress

end module sgmp_material_mooney_rivlin
