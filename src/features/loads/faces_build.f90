!> The faces of a body: where a particle of its lattice has none beside it. A face is where the
!! body's shapes end, and of the area with which half of the particle's volume lies between it and
!! the particle, as loads take it (doc/loads.md): so of flat faces the areas add up to those of the
!! shapes, and pressures on them are in equilibrium with a uniform stress, whether the lattice fits
!! the shapes or not.
module sgmp_faces_build
  use sgmp_body_lattice, only: body_lattice_lay, body_lattice_of_grid
  use sgmp_kinds, only: dp
  use sgmp_lattice, only: lattice_fits, lattice_point, lattice_t
  use sgmp_mesh, only: mesh_t
  use sgmp_scene, only: body_card_t
  use sgmp_shapes, only: shapes_inside
  use sgmp_turn, only: turn_back, turn_forth
  implicit none
  private
  public :: face_t, faces_lattice, faces_length, faces_place, faces_shown

  real(dp), parameter :: least_lever = 0.1_dp  !! of a length: to a face of what is hardly a cube

  !> A face of a particle.
  type :: face_t
    logical :: shown = .false.         !! it is one of the body
    real(dp) :: middle(3) = 0.0_dp     !! where the body is
    real(dp) :: area(3) = 0.0_dp       !! vector, outwards; of rings all around
  end type face_t

contains

  !> The lattice of a body, as it was filled.
  pure subroutine faces_lattice(owner, mesh, lattice)
    type(body_card_t), intent(in) :: owner
    type(mesh_t), intent(in) :: mesh
    type(lattice_t), intent(out) :: lattice
    integer :: status
    call body_lattice_lay(owner, mesh%h, mesh%origin, mesh%ndim, lattice, status)
    if (status /= lattice_fits) lattice%count = 0  ! it was refused before
  end subroutine faces_lattice

  !> Which of the places of the lattice along each axis a particle has: parts of cubes have their
  !! centre in the middle half of these.
  pure function faces_place(owner, lattice, x) result(at)
    type(body_card_t), intent(in) :: owner
    type(lattice_t), intent(in) :: lattice
    real(dp), intent(in) :: x(3)                 !! of the particle
    integer :: at(3)
    real(dp) :: point(3)
    integer :: axis
    point = on_lattice(owner, x)
    at = 1
    do axis = 1, lattice%ndim
      at(axis) = nearest(lattice%coordinate(:lattice%count(axis), axis), point(axis))
    end do
  end function faces_place

  !> Length of a cube.
  pure function faces_length(lattice, at, axis) result(length)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: at(3)                 !! faces_place
    integer, intent(in) :: axis                  !! of the lattice
    real(dp) :: length
    length = lattice%length(at(axis), axis)
  end function faces_length

  !> The face of a particle towards one side of its lattice. Between rings a face is as long as its
  !! own radius says.
  pure function faces_shown(owner, lattice, at, axis, side, x, volume) result(face)
    type(body_card_t), intent(in) :: owner
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: at(3)                 !! faces_place
    integer, intent(in) :: axis, side            !! 1: lower, 2: upper
    real(dp), intent(in) :: x(3), volume         !! of the particle
    type(face_t) :: face
    real(dp) :: cube(3), next(3), point(3), tip(3), lever, outwards
    outwards = real(2*side - 3, dp)
    cube = lattice_point(lattice, at)
    next = cube
    next(axis) = next(axis) + outwards*gap(lattice, at(axis), 2*side - 3, axis)
    if (holds(owner, lattice, next)) return
    if (owner%rings .and. next(1) <= 0.0_dp) return
    face%shown = .true.
    point = on_lattice(owner, x)
    lever = 0.5_dp*lattice%length(at(axis), axis)
    if (lattice%cut) then
      lever = max(least_lever*lattice%length(at(axis), axis), &
                  outwards*(surface(owner, lattice, cube, next, axis) - point(axis)))
    end if
    tip = point
    tip(axis) = point(axis) + outwards*lever
    if (owner%rings) lever = lever*point(1)/tip(1)
    if (.not. body_lattice_of_grid(owner)) call turn_forth(owner%turn, tip)
    face%middle = tip
    face%area = (tip - x)*(0.5_dp*volume/(lever*norm2(tip - x)))
  end function faces_shown

  !> Distance of the next place of a lattice; at its end as if it went on.
  pure function gap(lattice, at, by, axis) result(length)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: at, by, axis
    real(dp) :: length
    if (at + by < 1 .or. at + by > lattice%count(axis)) then
      length = lattice%length(at, axis)
    else
      length = abs(lattice%coordinate(at + by, axis) - lattice%coordinate(at, axis))
    end if
  end function gap

  !> Where the shapes end along an axis between a place inside and one outside.
  pure function surface(owner, lattice, inside, outside, axis) result(place)
    type(body_card_t), intent(in) :: owner
    type(lattice_t), intent(in) :: lattice
    real(dp), intent(in) :: inside(3), outside(3)
    integer, intent(in) :: axis
    real(dp) :: place
    integer, parameter :: halvings = 40
    real(dp) :: low(3), high(3), middle(3)
    integer :: i
    low = inside
    high = outside
    do i = 1, halvings
      middle = 0.5_dp*(low + high)
      if (holds(owner, lattice, middle)) then
        low = middle
      else
        high = middle
      end if
    end do
    place = 0.5_dp*(low(axis) + high(axis))
  end function surface

  !> Whether a place of the lattice is in the body.
  pure function holds(owner, lattice, place) result(yes)
    type(body_card_t), intent(in) :: owner
    type(lattice_t), intent(in) :: lattice
    real(dp), intent(in) :: place(3)
    logical :: yes
    real(dp) :: point(3)
    point = place
    if (body_lattice_of_grid(owner)) call turn_back(owner%turn, point)
    yes = shapes_inside(owner%shapes, point, lattice%ndim, lattice%margin)
  end function holds

  !> A place of the body as its lattice has it, which is turned with it or not.
  pure function on_lattice(owner, x) result(point)
    type(body_card_t), intent(in) :: owner
    real(dp), intent(in) :: x(3)
    real(dp) :: point(3)
    point = x
    if (.not. body_lattice_of_grid(owner)) call turn_back(owner%turn, point)
  end function on_lattice

  !> Which of ascending numbers is nearest.
  pure function nearest(numbers, x) result(at)
    real(dp), intent(in) :: numbers(:)
    real(dp), intent(in) :: x
    integer :: at
    integer :: above, middle
    at = 1
    above = size(numbers) + 1
    do while (above - at > 1)
      middle = (at + above)/2
      if (numbers(middle) <= x) then
        at = middle
      else
        above = middle
      end if
    end do
    if (at < size(numbers)) then
      if (numbers(at + 1) - x < x - numbers(at)) at = at + 1
    end if
  end function nearest

end module sgmp_faces_build
