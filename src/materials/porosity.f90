!> Porous matter: P-alpha of Herrmann (1969), with the pressure of Carroll and Holt (1972;
!! theory 4).
!!
!!     p      = ps(v alpha0/alpha, E alpha0)/alpha                                      (PA1)
!!     alpha <= 1 + (alpha0 - 1) ((p1 - p)/(p1 - p0))^2,  p0 <= p <= p1                 (PA2)
!!
!! alpha is the distention, volume over that of the solid, alpha0 that of the start, when v = V/V0
!! is 1; ps the equation of state of the solid, whose energy is counted per volume of the solid, E
!! per initial volume of the porous material. Below p0 and when it is unloaded pores stay as they
!! are, and waves have the speed of the solid; under p1 there are none left. Pores that have closed
!! do not open again, in tension neither.
!!
!! With a speed ce of sound in the porous material what is left of them is compressed elastically
!! (Herrmann 1969, with the 1/alpha of Carroll and Holt),
!!
!!     dalpha/dp = alpha^2/K0 (1 - 1/h^2),  h = 1 + (alpha - 1)(ce/c0 - 1)/(alpha0 - 1)   (PA3)
!!
!! K0 = rho_s c0^2, so that waves of small amplitude run with h c0: ce at first, c0 when the pores
!! have closed. All solutions of (PA3) are one curve of alpha over p, shifted in p: Pi(alpha), 0 at
!! alpha0, in closed form below. Matter remembers its shift s = Pi(alpha) - p, 0 at first; (PA2)
!! begins at the distention that the first curve has at p0 in place of alpha0. Beyond alpha0, in
!! tension, the curve goes on straight.
module sgmp_porosity
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: porosity_t, porosity_keys, porosity_read
  public :: porosity_bound, porosity_terms, porosity_bound_lanes, porosity_terms_lanes
  public :: porosity_set_elastic, porosity_curve, porosity_crush_pressure, porosity_excess
  public :: porosity_crushes, porosity_is_closed, porosity_speed_ratio

  real(dp), parameter :: closed_open = 1.0e-12_dp  !! alpha - 1 below which there are no pores

  !> Constants of (PA1), (PA2).
  type :: porosity_t
    logical :: porous = .false.
    real(dp) :: distention = 1.0_dp  !! alpha0 > 1
    real(dp) :: start = 0.0_dp       !! p0, where pores begin to close (stress)
    real(dp) :: finish = 1.0_dp      !! p1, where they have closed (stress)
    logical :: elastic = .false.     !! by (PA3)
    real(dp) :: bulk = 1.0_dp        !! K0 (stress)
    real(dp) :: slower = 0.0_dp      !! (1 - ce/c0)/(alpha0 - 1)
    real(dp) :: first = 1.0_dp       !! distention where crushing begins
    real(dp) :: factor(4) = 0.0_dp   !! of the terms of Pi
    real(dp) :: offset = 0.0_dp      !! of Pi
  end type porosity_t

contains

  !> Keys beside those of the solid's equation of state.
  function porosity_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('distention', kind_real, 'volume over that of the solid, of porous material: '// &
                "density is that of the porous material, the other constants are the solid's", &
                range='(1,inf)', source='P-alpha, Herrmann 1969'), &
            key('crush_start', kind_real, 'pressure at which pores begin to close; needed with '// &
                'distention', unit='stress', range='[0,inf)'), &
            key('crush_end', kind_real, 'pressure at which none is left; in between distention '// &
                'a follows (a - 1)/(distention - 1) = ((crush_end - p)/(crush_end - '// &
                'crush_start))^2; needed with distention', unit='stress', range='(0,inf)'), &
            key('pore_speed', kind_real, 'speed of sound in the bulk of the porous material: '// &
                'pores are compressed elastically below crush_start and when it is unloaded; '// &
                'without it they stay, and waves have the speed c0 of the solid', unit='speed', &
                range='(0,inf)')]
  end function porosity_keys

  !> Porosity from the values of those keys; none where they are not given.
  pure subroutine porosity_read(density, values, porosity, history, fault)
    real(dp), intent(in) :: density  !! of the porous material at the start
    class(values_t), intent(in) :: values
    type(porosity_t), intent(out) :: porosity
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    porosity%porous = values%has('distention')
    history%distention = porosity%porous
    history%pore_shift = values%has('pore_speed')
    if (porosity%porous .neqv. (values%has('crush_start') .and. values%has('crush_end'))) then
      call fault_make(fault, '', 'distention, crush_start and crush_end belong together', &
                      'give all of them, or none')
    else if (history%pore_shift .and. .not. porosity%porous) then
      call fault_make(fault, 'pore_speed', 'pore_speed is that of porous material', &
                      'add distention, crush_start and crush_end')
    end if
    if (.not. porosity%porous) return
    porosity%distention = values%number('distention')
    history%first_distention = porosity%distention
    porosity%start = values%number('crush_start')
    porosity%finish = values%number('crush_end')
    if (allocated(fault)) return
    if (.not. porosity%finish > porosity%start) then
      call fault_make(fault, 'crush_end', 'pores have closed before they begin to', &
                      'give a pressure above crush_start')
    else if (values%number('energy0') > 0.0_dp .or. values%has('pressure0')) then
      call fault_make(fault, '', 'porous material starts without pressure and heat', &
                      'remove energy0 and pressure0')
    else if (history%pore_shift) then
      call read_elastic(density, values, porosity, fault)
    end if
  end subroutine porosity_read

  !> Elastic pores from the values of the keys.
  pure subroutine read_elastic(density, values, porosity, fault)
    real(dp), intent(in) :: density
    class(values_t), intent(in) :: values
    type(porosity_t), intent(inout) :: porosity
    type(fault_t), allocatable, intent(out) :: fault
    real(dp) :: ratio, crushed
    ratio = values%number('pore_speed')/values%number('c0')
    if (.not. ratio < 1.0_dp) then
      call fault_make(fault, 'pore_speed', 'waves in porous material are slower than in the '// &
                      'solid', 'give a speed below c0, or none')
      return
    end if
    call porosity_set_elastic(porosity, density*porosity%distention*values%number('c0')**2, ratio)
    crushed = 2.0_dp*(porosity%first - 1.0_dp)/(porosity%finish - porosity%start)
    if (.not. crushed > -1.0_dp/curve_slope(porosity, porosity%first)) then
      call fault_make(fault, 'pore_speed', 'pores yield more before crush_start than beyond', &
                      'give a higher pore_speed, or a lower crush_end')
    end if
  end subroutine read_elastic

  !> Makes pores elastic: the terms of (PA3)'s partial fractions, and where crushing begins.
  pure subroutine porosity_set_elastic(porosity, bulk, ratio)
    type(porosity_t), intent(inout) :: porosity
    real(dp), intent(in) :: bulk   !! K0 of the solid (stress)
    real(dp), intent(in) :: ratio  !! ce/c0 < 1
    real(dp) :: b, low, high, middle
    integer :: k
    porosity%elastic = .true.
    porosity%bulk = bulk
    b = (1.0_dp - ratio)/(porosity%distention - 1.0_dp)
    porosity%slower = b
    porosity%factor = [0.5_dp, 0.5_dp*(b/(b + 2.0_dp))**2 - 0.5_dp, (1.0_dp + b)**2/(2.0_dp + b), &
                       -0.5_dp*(b/(b + 2.0_dp))**2]
    porosity%offset = 0.0_dp
    porosity%offset = porosity_curve(porosity, porosity%distention)
    low = 1.0_dp
    high = porosity%distention
    do k = 1, 200
      middle = 0.5_dp*(low + high)
      if (porosity_curve(porosity, middle) > porosity%start) low = middle
      if (.not. porosity_curve(porosity, middle) > porosity%start) high = middle
    end do
    porosity%first = high
  end subroutine porosity_set_elastic

  !> Pi: pressure at a distention on the curve of matter that was never crushed (stress).
  pure elemental function porosity_curve(porosity, distention) result(pressure)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention
    real(dp) :: pressure
    real(dp) :: x
    x = min(max(distention - 1.0_dp, closed_open), porosity%distention - 1.0_dp)
    pressure = porosity%factor(1)*log(x) + porosity%factor(2)*log(1.0_dp + x) &
               + porosity%factor(3)/(1.0_dp + x) &
               + porosity%factor(4)*log(2.0_dp - porosity%slower*x)
    pressure = -porosity%bulk/porosity%slower*pressure - porosity%offset
    if (distention > porosity%distention) then
      pressure = pressure + curve_slope(porosity, porosity%distention) &
                            *(distention - porosity%distention)
    end if
  end function porosity_curve

  !> dPi/dalpha, not beyond the distention of the start (stress).
  pure elemental function curve_slope(porosity, distention) result(slope)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention
    real(dp) :: slope
    real(dp) :: h2
    h2 = porosity_speed_ratio(porosity, distention)**2
    slope = -porosity%bulk*h2/(distention**2*(1.0_dp - h2))
  end function curve_slope

  !> h: speed of small waves over that in the solid.
  pure elemental function porosity_speed_ratio(porosity, distention) result(ratio)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention
    real(dp) :: ratio
    ratio = 1.0_dp - porosity%slower*(min(distention, porosity%distention) - 1.0_dp)
  end function porosity_speed_ratio

  !> Pressure that crushes elastic pores further: the inverse of (PA2) (stress).
  pure elemental function porosity_crush_pressure(porosity, distention) result(pressure)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention
    real(dp) :: pressure
    pressure = porosity%start
    if (distention < porosity%first) then
      pressure = porosity%finish - (porosity%finish - porosity%start) &
                 *sqrt(max(distention - 1.0_dp, 0.0_dp)/(porosity%first - 1.0_dp))
    end if
  end function porosity_crush_pressure

  !> By how much, over K0, a pressure is above what elastic pores of a distention bear, on their own
  !! curve and on that of crushing; grows with the distention. None where pressure and distention
  !! go together.
  pure elemental function porosity_excess(porosity, distention, pressure, shift) result(excess)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention, pressure  !! alpha, p (stress)
    real(dp), intent(in) :: shift                 !! s of the curve (stress)
    real(dp) :: excess
    excess = max(pressure - (porosity_curve(porosity, distention) - shift), &
                 pressure - porosity_crush_pressure(porosity, distention))/porosity%bulk
  end function porosity_excess

  !> Whether it is crushing that bounds elastic pores, and not their curve.
  pure elemental function porosity_crushes(porosity, distention, shift) result(yes)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention, shift     !! as in porosity_excess
    logical :: yes
    yes = porosity_crush_pressure(porosity, distention) <= porosity_curve(porosity, distention) - &
          shift
  end function porosity_crushes

  !> Whether elastic pores have closed, and stay so.
  pure elemental function porosity_is_closed(distention) result(yes)
    real(dp), intent(in) :: distention
    logical :: yes
    yes = distention - 1.0_dp <= closed_open
  end function porosity_is_closed

  !> Greatest distention under a pressure (PA2).
  pure function porosity_bound(porosity, pressure) result(bound)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: pressure  !! (stress)
    real(dp) :: bound
    real(dp) :: open
    open = (porosity%finish - pressure)/(porosity%finish - porosity%start)
    open = merge(open, 0.0_dp, open > 0.0_dp)
    open = merge(open, 1.0_dp, open < 1.0_dp)
    bound = 1.0_dp + (porosity%distention - 1.0_dp)*open**2
  end function porosity_bound

  !> From the terms of the solid's equation of state at v alpha0/alpha those of (PA1) at v, with
  !! their derivatives while the pores stay.
  pure subroutine porosity_terms(porosity, distention, a0, b0, da, db)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention            !! alpha
    real(dp), intent(inout) :: a0, b0, da, db     !! as in eos_terms
    real(dp) :: closed
    closed = porosity%distention/distention
    a0 = a0/distention
    b0 = b0*closed
    da = da*closed/distention
    db = db*closed**2
  end subroutine porosity_terms

  !> Lane kernel of porosity_bound.
  pure subroutine porosity_bound_lanes(porosity, pressure, bound)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: pressure(lanes)
    real(dp), intent(out) :: bound(lanes)
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      bound(p) = porosity_bound(porosity, pressure(p))
    end do
  end subroutine porosity_bound_lanes

  !> Lane kernel of porosity_terms.
  pure subroutine porosity_terms_lanes(porosity, distention, a0, b0, da, db)
    type(porosity_t), intent(in) :: porosity
    real(dp), intent(in) :: distention(lanes)
    real(dp), dimension(lanes), intent(inout) :: a0, b0, da, db
    integer :: p
    !$omp simd simdlen(8)
    do p = 1, lanes
      call porosity_terms(porosity, distention(p), a0(p), b0(p), da(p), db(p))
    end do
  end subroutine porosity_terms_lanes

end module sgmp_porosity
