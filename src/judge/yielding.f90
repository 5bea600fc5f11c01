!> Which bodies have sprung back: what is elastic alone, and metals whose plastic work is next to
!! nothing of the energy that the scene was given, and whose plastic strain is no larger than what
!! they bear elastically: a jet flows, however weak it is. Verdicts on vibrations and rebounds are
!! on these.
module sgmp_yielding
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_is_metal, law_is_springy, law_yield_stress, &
                               law_young
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass
  use sgmp_tally, only: tally_add, tally_reset, tally_t, tally_total
  implicit none
  private
  public :: yielding_look

  real(dp), parameter :: least_work = 0.1_dp     !! over the energy supplied

contains

  !> Tells each body whether it has sprung back; all ranks must call it.
  subroutine yielding_look(model)
    type(model_t), intent(inout) :: model
    type(tally_t) :: tally
    real(dp) :: work(size(model%bodies)), common
    integer(i8) :: none(0)
    integer :: b, first, i
    call tally_reset(tally, size(model%bodies))
    do b = 1, size(model%bodies)
      if (is_metal(model%bodies(b))) call add_work(model%bodies(b), model%mesh%ndim, b, tally)
    end do
    call tally_total(tally, work, none)
    do b = 1, size(model%bodies)
      first = model%bodies(b)%twin_of
      if (first > 0) work(first) = work(first) + work(b)
    end do
    common = 0.5_dp*sum([(sum(model%totals%bodies%momentum(i))**2, i=1, 3)])/ &
             max(sum(model%totals%bodies%mass), tiny(1.0_dp))
    do b = 1, size(model%bodies)
      associate (body => model%bodies(b))
        body%springs = law_is_springy(body%law) .or. &
                       (is_metal(body) .and. &
                        work(b) <= min(least_work*(model%ledger%supplied - common), &
                                       elastic_energy(body%law, model%totals%bodies(b)%mass)))
      end associate
    end do
  end subroutine yielding_look

  !> Whether a body is of a metal that yields at its yield stress.
  pure logical function is_metal(body) result(yes)
    type(body_t), intent(in) :: body
    yes = .not. body%rigid .and. law_is_metal(body%law) .and. body%law%slots%plastic > 0
  end function is_metal

  !> Twice the elastic energy of a mass in tension at its first yield stress: as much work takes a
  !! plastic strain as large as the elastic one.
  pure function elastic_energy(law, mass) result(energy)
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: mass
    real(dp) :: energy
    energy = 0.0_dp
    if (.not. law_is_metal(law)) return
    energy = mass/law%density*law_yield_stress(law, 0.0_dp)**2/max(law_young(law), tiny(1.0_dp))
  end function elastic_energy

  !> Adds the plastic work of a body's particles: the first yield stress times their strain.
  subroutine add_work(body, ndim, place, tally)
    type(body_t), intent(in) :: body
    integer, intent(in) :: ndim, place           !! axes; of the sum
    type(tally_t), intent(inout) :: tally
    real(dp) :: yield
    integer :: c, l
    associate (law => body%law, particles => body%particles)
      yield = law_yield_stress(law, 0.0_dp)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          call tally_add(tally, place, [particles%motion(l, motion_mass(ndim), c)/law%density* &
                                        yield*particles%state(l, law%slots%plastic, c)])
        end do
      end do
    end associate
  end subroutine add_work

end module sgmp_yielding
