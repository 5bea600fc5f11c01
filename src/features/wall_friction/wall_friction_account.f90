!> Walls with friction beside the energy balance: impulses that press on them, and that pull. Their
!! work and dissipation are terms of the scheme itself (sgmp_energy).
module sgmp_wall_friction_account
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, terms_add, terms_find
  use sgmp_kinds, only: dp
  use sgmp_sums, only: feature_sums
  use sgmp_wall_friction_type, only: wall_friction_t
  implicit none
  private
  public :: wall_friction_account, wall_friction_book, wall_pressed, wall_pulled

  real(dp), parameter :: memory = 50.0_dp  !! steps of whose impulse a wall knows

  character(*), parameter :: wall_pressed = 'friction_walls.pressed_impulse'
  character(*), parameter :: wall_pulled = 'friction_walls.pulled_impulse'

contains

  !> Adds the impulses.
  pure subroutine wall_friction_account(terms)
    type(energy_terms_t), intent(inout) :: terms
    call terms_add(terms, energy_term_t(name=wall_pressed))
    call terms_add(terms, energy_term_t(name=wall_pulled))
  end subroutine wall_friction_account

  !> Books the impulses of a step, and what of that which presses in the next one rubs: what nothing
  !! pulls elsewhere on the same wall.
  pure subroutine wall_friction_book(friction, forces, dt_kick, terms)
    type(wall_friction_t), intent(inout) :: friction
    real(dp), intent(in) :: forces(feature_sums)  !! that press, that pull, of six faces
    real(dp), intent(in) :: dt_kick
    type(energy_terms_t), intent(inout) :: terms
    real(dp) :: pressed, pulled
    integer :: axis, side, face
    terms%term(terms_find(terms, wall_pressed))%step(1) = dt_kick*sum(forces(:6))
    terms%term(terms_find(terms, wall_pulled))%step(1) = dt_kick*sum(forces(7:))
    do axis = 1, 3
      do side = 1, 2
        face = 2*(axis - 1) + side
        call share_out(dt_kick*forces(face), dt_kick*forces(6 + face), &
                       friction%share(side, axis), friction%credit(side, axis), &
                       friction%usual(side, axis))
      end do
    end do
  end subroutine wall_friction_book

  !> The same of one wall. Over time what rubs is what presses less what pulls; a wall that has been
  !! left, or has pulled for long, forgets it.
  pure subroutine share_out(pressed, pulled, share, credit, usual)
    real(dp), intent(in) :: pressed, pulled       !! impulses of the step
    real(dp), intent(inout) :: share, credit, usual
    real(dp) :: most
    usual = usual + (pressed - usual)/memory
    most = memory*usual
    credit = max(-most, min(credit + pressed - pulled - share*pressed, most))
    share = 1.0_dp
    if (pressed > 0.0_dp) share = max(0.0_dp, min((pressed - pulled + credit)/pressed, 1.0_dp))
  end subroutine share_out

end module sgmp_wall_friction_account
