!> What is doubtful about debris, before a run (doc/materials.md, Debris).
module sgmp_debris_doubts
  use sgmp_constitutive, only: constitutive_t, eos_linear, eos_none
  use sgmp_failure, only: carries_everything
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_spelling, only: string_t
  use sgmp_update, only: update_usl
  implicit none
  private
  public :: debris_warnings

  real(dp), parameter :: fast = 1.7_dp  !! c + |v| over the speed of sound in the bulk

contains

  !> An update that takes energy from what is shocked, and matter that is to be whole however far it
  !! has opened: both in fast impacts.
  subroutine debris_warnings(model, warnings)
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(out) :: warnings(:)
    type(string_t) :: found(2)
    integer :: n, b
    n = 0
    if (fast_impact(model)) then
      if (model%method%update == update_usl) then
        n = n + 1
        found(n)%text = 'update=usl strains with the whole kick of the nodes, of which '// &
                        'particles follow a part: in a fast impact a fifth of the energy may '// &
                        'get lost; leave update away (musl)'
      end if
      b = findloc(stays_whole(model%bodies%law), .true., 1)
      if (b > 0) then
        n = n + 1
        found(n)%text = "body '"//trim(model%bodies(b)%name)//"' carries everything when it "// &
                        'has failed (failure carries=everything), however far it opens: hot '// &
                        'debris presses the more the larger it gets, gains energy, and makes '// &
                        'steps shrink; use carries=pressure'
      end if
    end if
    warnings = found(:n)
  end subroutine debris_warnings

  !> Whether what may fail meets faster than sound.
  pure function fast_impact(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    associate (law => model%bodies%law)
      yes = any(law%fails)
      if (yes) yes = model%findings%fastest > fast*maxval(law%bulk_speed, mask=law%fails)
    end associate
  end function fast_impact

  !> Whether failed matter has the pressure of whole matter at any volume.
  elemental function stays_whole(law) result(yes)
    type(constitutive_t), intent(in) :: law
    logical :: yes
    yes = law%fails .and. law%history%damage .and. law%failure%carries == carries_everything &
          .and. law%eos /= eos_none .and. eos_linear(law)
  end function stays_whole

end module sgmp_debris_doubts
