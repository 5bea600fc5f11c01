!> What blasts in a gas say about a run whose cells they hardly resolve (doc/verdict.md).
!!
!! Behind the front of a strong blast most of what it has met lies in a layer of a sixth (plane),
!! twelfth (line) or eighteenth (point) of its way; a ball of gas that bursts has pushed only some
!! cells of the gas around it when it begins. A front is three cells wide. Where that is much of the
!! layer, the mean of the velocity over the mass is off by up to 0.15 times what neighbouring points
!! of the grid differ by (root mean squares over each other), and the radius of the front by 5 %
!! (classes Flash and Burst of the random scenes).
module sgmp_judge_fronts
  use sgmp_constitutive, only: law_gaseous, material_explosive
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_node_motion, only: node_motion
  use sgmp_opinion, only: opinion_t
  use sgmp_text, only: percent_text
  implicit none
  private
  public :: judge_fronts

  real(dp), parameter :: weight = 0.15_dp          !! up to 0.15 found
  !> Kinetic energy, of all of the gas: blasts have 0.007 to 0.28, gas that has come to rest less.
  real(dp), parameter :: least_moving = 0.005_dp
  real(dp), parameter :: least_told = 0.075_dp, least_error = 0.1_dp, most_error = 0.3_dp

contains

  !> Gas whose motion changes from cell to cell. All ranks must call it.
  subroutine judge_fronts(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp) :: square, change, part
    integer :: f
    if (any(model%bodies%rigid)) return            ! what drives gas drives its layer, too
    do f = 1, size(model%fields)
      if (.not. moves(model, f) .or. is_driven(model, f)) cycle
      call node_motion(model, f, square, change)
      if (.not. square > 0.0_dp) cycle
      part = sqrt(change/square)
      if (weight*part < least_told) cycle
      call opinion%expect(min(most_error, max(least_error, weight*part)), &
                          'velocities of the gas change by '//percent_text(part)// &
                          ' from cell to cell: the layer behind the front of its blast wants '// &
                          'smaller cells')
      return
    end do
  end subroutine judge_fronts

  !> Whether a gas is one body beside others: these drive it, not a blast.
  pure function is_driven(model, f) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    logical :: yes
    yes = count(model%bodies%field == f) == 1 .and. any(model%bodies%field /= f)
  end function is_driven

  !> Whether a field is that of gases alone, and some of their energy is motion.
  pure function moves(model, f) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    logical :: yes
    logical :: own(size(model%bodies))
    own = model%bodies%field == f
    associate (laws => model%bodies%law, sums => model%totals%bodies)
      yes = any(own) .and. .not. any(own .and. (.not. law_gaseous(laws) .or. &
                                                laws%kind == material_explosive))
      if (yes) yes = sum(sums%kinetic, mask=own) > &
                     least_moving*(sum(sums%kinetic, mask=own) + sum(sums%internal, mask=own))
    end associate
  end function moves

end module sgmp_judge_fronts
