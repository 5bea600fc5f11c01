!> What a consistent mass keeps at the points of a velocity field (`method mass=consistent`,
!! doc/mass.md).
module sgmp_mass_points
  use sgmp_kinds, only: dp, i8
  implicit none
  private
  public :: mass_points_t, mass_points_make, mass_points_move, mass_points_size

  type :: mass_points_t
    real(dp), allocatable :: gain(:, :)      !! (points, 2 ndim) what two vectors of the nodes gain
    real(dp), allocatable :: before(:, :)    !! (points, ndim) acceleration before contact
    real(dp), allocatable :: force(:, :)     !! (points, ndim) force of a step, for what of it
                                             !! particles do not feel
    real(dp), allocatable :: external(:, :)  !! (points, ndim) the part whose work nodes book
  end type mass_points_t

contains

  !> Room for some points; nothing is read that was not written in the same step.
  pure subroutine mass_points_make(ndim, points, mass)
    integer, intent(in) :: ndim, points
    type(mass_points_t), intent(out) :: mass
    allocate (mass%gain(points, 2*ndim), mass%before(points, ndim), mass%force(points, ndim))
    allocate (mass%external(points, ndim))
  end subroutine mass_points_make

  !> Numbers that are kept.
  pure function mass_points_size(mass) result(numbers)
    type(mass_points_t), intent(in) :: mass
    integer(i8) :: numbers
    numbers = size(mass%gain, kind=i8) + size(mass%before, kind=i8) + size(mass%force, kind=i8) + &
              size(mass%external, kind=i8)
  end function mass_points_size

  !> Hands what is kept over without copying it.
  pure subroutine mass_points_move(from, to)
    type(mass_points_t), intent(inout) :: from, to
    call move_alloc(from%gain, to%gain)
    call move_alloc(from%before, to%before)
    call move_alloc(from%force, to%force)
    call move_alloc(from%external, to%external)
  end subroutine mass_points_move

end module sgmp_mass_points
