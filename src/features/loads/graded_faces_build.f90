!> Faces of particles that lie as many between any two centres of unequal cells (doc/grids.md, 1):
!! boxes as long as the lattice says, which does not turn with its body.
module sgmp_graded_faces_build
  use sgmp_kinds, only: dp
  use sgmp_lattice, only: lattice_graded, lattice_t
  use sgmp_scene, only: body_card_t
  use sgmp_shapes, only: shapes_anchor, shapes_box, shapes_inside
  use sgmp_turn, only: turn_back, turn_box
  implicit none
  private
  public :: graded_faces_lay, graded_faces_place, graded_faces_shown

contains

  !> The lattice of a body, as seeding lays it.
  subroutine graded_faces_lay(owner, ndim, lattice)
    type(body_card_t), intent(in) :: owner
    integer, intent(in) :: ndim
    type(lattice_t), intent(out) :: lattice
    real(dp) :: lower(3), upper(3)
    integer :: status
    call shapes_box(owner%shapes, lower, upper)
    if (ndim > 1) call turn_box(owner%turn, lower, upper)
    call lattice_graded(lower, upper, shapes_anchor(owner%shapes), owner%axes(:ndim), owner%cell, &
                        owner%ppc, .false., lattice, status)
  end subroutine graded_faces_lay

  !> Which of the places of the lattice along each axis a particle has.
  pure function graded_faces_place(lattice, x) result(at)
    type(lattice_t), intent(in) :: lattice
    real(dp), intent(in) :: x(3)                 !! of the particle
    integer :: at(3)
    integer :: axis
    at = 1
    do axis = 1, lattice%ndim
      at(axis) = minloc(abs(lattice%coordinate(:lattice%count(axis), axis) - x(axis)), dim=1)
    end do
  end function graded_faces_place

  !> Area of a face of a particle, 0 where the lattice has another one behind it; the middle of the
  !! face. Between rings a face is as long as its own radius says.
  pure subroutine graded_faces_shown(owner, lattice, at, axis, side, x, volume, face, area)
    type(body_card_t), intent(in) :: owner
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: at(3)                 !! graded_faces_place
    integer, intent(in) :: axis, side            !! 1: lower, 2: upper
    real(dp), intent(in) :: x(3), volume         !! of the particle
    real(dp), intent(out) :: face(3), area
    real(dp) :: next(3)
    integer :: beside
    face = x
    face(axis) = x(axis) + (side - 1.5_dp)*lattice%length(at(axis), axis)
    area = 0.0_dp
    beside = at(axis) + 2*side - 3
    if (beside >= 1 .and. beside <= lattice%count(axis)) then
      next = x
      next(axis) = lattice%coordinate(beside, axis)
      call turn_back(owner%turn, next)
      if (shapes_inside(owner%shapes, next, lattice%ndim, lattice%margin)) return
    end if
    area = volume/lattice%length(at(axis), axis)
    if (owner%rings) area = area*face(1)/x(1)
  end subroutine graded_faces_shown

end module sgmp_graded_faces_build
