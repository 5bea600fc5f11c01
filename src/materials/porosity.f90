!> Porous matter: P-alpha of Herrmann (1969), with the pressure of Carroll and Holt (1972;
!! theory 4).
!!
!!     p      = ps(v alpha0/alpha, E alpha0)/alpha                                      (PA1)
!!     alpha <= 1 + (alpha0 - 1) ((p1 - p)/(p1 - p0))^2,  p0 <= p <= p1                 (PA2)
!!
!! alpha is the distention, volume over that of the solid, alpha0 that of the start, when v = V/V0
!! is 1; ps the equation of state of the solid, whose energy is counted per volume of the solid, E
!! per initial volume of the porous matter. Below p0 and when it is unloaded the pores stay as they
!! are, and waves have the speed of the solid; under p1 there are none left. Pores that have closed
!! do not open again, in tension neither.
module sgmp_porosity
  use sgmp_keys, only: fault_make, fault_t, key, key_t, kind_real, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  implicit none
  private
  public :: porosity_t, porosity_keys, porosity_read
  public :: porosity_bound, porosity_terms, porosity_bound_lanes, porosity_terms_lanes

  !> Constants of (PA1), (PA2).
  type :: porosity_t
    logical :: porous = .false.
    real(dp) :: distention = 1.0_dp  !! alpha0 > 1
    real(dp) :: start = 0.0_dp       !! p0, where pores begin to close (stress)
    real(dp) :: finish = 1.0_dp      !! p1, where they have closed (stress)
  end type porosity_t

contains

  !> Keys beside those of the solid's equation of state.
  function porosity_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    keys = [key('distention', kind_real, 'volume over that of the solid, of porous matter: '// &
                "density is that of the porous matter, the other constants are the solid's", &
                range='(1,inf)', source='P-alpha, Herrmann 1969'), &
            key('crush_start', kind_real, 'pressure at which pores begin to close; needed with '// &
                'distention', unit='stress', range='[0,inf)'), &
            key('crush_end', kind_real, 'pressure at which none is left; in between distention '// &
                'a follows (a - 1)/(distention - 1) = ((crush_end - p)/(crush_end - '// &
                'crush_start))^2; needed with distention', unit='stress', range='(0,inf)')]
  end function porosity_keys

  !> Porosity from the values of those keys; none where they are not given.
  pure subroutine porosity_read(values, porosity, history, fault)
    class(values_t), intent(in) :: values
    type(porosity_t), intent(out) :: porosity
    type(history_t), intent(inout) :: history
    type(fault_t), allocatable, intent(out) :: fault
    porosity%porous = values%has('distention')
    history%distention = porosity%porous
    if (porosity%porous .neqv. (values%has('crush_start') .and. values%has('crush_end'))) then
      call fault_make(fault, '', 'distention, crush_start and crush_end belong together', &
                      'give all of them, or none')
    end if
    if (.not. porosity%porous) return
    porosity%distention = values%number('distention')
    porosity%start = values%number('crush_start')
    porosity%finish = values%number('crush_end')
    if (allocated(fault)) return
    if (.not. porosity%finish > porosity%start) then
      call fault_make(fault, 'crush_end', 'pores have closed before they begin to', &
                      'give a pressure above crush_start')
    else if (values%number('energy0') > 0.0_dp .or. values%has('pressure0')) then
      call fault_make(fault, '', 'porous matter starts without pressure and heat', &
                      'remove energy0 and pressure0')
    end if
  end subroutine porosity_read

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
