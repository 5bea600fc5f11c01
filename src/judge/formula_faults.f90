!> A run that fails because a formula of the deck stopped being a number (the root of what became
!! negative, a division by zero): which card it stands on.
module sgmp_formula_faults
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sgmp_errors, only: error_t
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  use sgmp_scene, only: scene_t
  use sgmp_text, only: real_text
  implicit none
  private
  public :: formula_faults_name

contains

  !> Puts the place of the first card whose formula of t has no finite value at a time, and that
  !! reason, in front of an error. Formulas of the place are left out: where they were evaluated
  !! last is not known any more.
  subroutine formula_faults_name(scene, time, error)
    type(scene_t), intent(in) :: scene
    real(dp), intent(in) :: time
    type(error_t), intent(inout) :: error
    integer :: i
    do i = 1, size(scene%loads)
      associate (card => scene%loads(i))
        if (any_fails(card%value, time)) call blame(card%location, time, error)
      end associate
    end do
    do i = 1, size(scene%bodyforces)
      associate (card => scene%bodyforces(i))
        if (any_fails(card%force, time)) call blame(card%location, time, error)
      end associate
    end do
    do i = 1, size(scene%motions)
      associate (card => scene%motions(i))
        if (any_fails([card%velocity, card%omega], min(time, card%until))) then
          call blame(card%location, time, error)
        end if
      end associate
    end do
  end subroutine formula_faults_name

  function any_fails(formulas, time) result(yes)
    type(expression_t), intent(in) :: formulas(:)
    real(dp), intent(in) :: time
    logical :: yes
    real(dp), parameter :: nowhere(3) = 0.0_dp
    integer :: i
    yes = .false.
    do i = 1, size(formulas)
      if (formulas(i)%uses_position .or. formulas(i)%uses_initial_position) cycle
      if (.not. ieee_is_finite(formulas(i)%evaluate(nowhere, nowhere, time))) yes = .true.
    end do
  end function any_fails

  subroutine blame(location, time, error)
    character(*), intent(in) :: location
    real(dp), intent(in) :: time
    type(error_t), intent(inout) :: error
    if (len(error%location) > 0) return
    error%location = location
    error%message = 'a formula of this card has no value at time '//real_text(time)//'; '// &
                    error%message
    error%remedy = 'give it a value at all times, e.g. sqrt(max(0,1-t))'
  end subroutine blame

end module sgmp_formula_faults
