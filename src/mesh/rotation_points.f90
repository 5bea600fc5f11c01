!> What exact rotation keeps at the points of a velocity field (`method rotation=exact`,
!! doc/rotation.md).
module sgmp_rotation_points
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: rotation_points_t, rotation_points_make, rotation_points_clear, rotation_points_move
  public :: at_node, at_centre, at_force
  public :: stage_offsets, stage_inertia, stage_inverses, stage_moments, stage_couples, &
            stage_face_moments, stage_face_couples, stage_curls, stage_place
  public :: spin_width

  !> Which points take part, columns of `at`: nodes whose centre of mass is not at their place,
  !! centres around those, nodes around those.
  integer, parameter :: at_node = 1, at_centre = 2, at_force = 3

  !> Stages, one pass over the planes each: the first three find where the masses are, the next two
  !! correct the forces of stresses, two more those on faces, the last two velocities.
  integer, parameter :: stage_offsets = 1, stage_inertia = 2, stage_inverses = 3, &
                        stage_moments = 4, stage_couples = 5, stage_face_moments = 6, &
                        stage_face_couples = 7, stage_curls = 8, stage_place = 9

  !> Numbers kept of a vector of one to three components: three become four, which processors
  !! handle at once. The points that take part are few and seldom follow each other: what belongs
  !! to one lies together.
  integer, parameter :: spin_width(3) = [1, 2, 4]

  type :: rotation_points_t
    !> Offsets below this many cells are taken for none: a lattice of particles has none but
    !! round-off and what strains of 1e-3 make of it.
    real(dp) :: least_offset = 2.0e-3_dp
    real(dp), allocatable :: offset(:, :)      !! (2 or 4, points) nodes: from a node to the centre
                                               !! of mass of what it stands for (cells)
    real(dp), allocatable :: inverse(:, :, :)  !! (1 or 4, 1 or 3, points) nodes: inverse of the
                                               !! tensor that gives the curl around a node from its
                                               !! angular velocity
    real(dp), allocatable :: tensor(:, :, :)   !! (1 or 4, 1 or 3, points) centres: that tensor
    real(dp), allocatable :: moment(:, :)      !! (1 or 4, points) nodes: moment of the force
    real(dp), allocatable :: couple(:, :)      !! (1 or 4, points) centres: couples, or the curl of
                                               !! a velocity, times the mass
    real(dp), allocatable :: face_couple(:, :)  !! the couples of forces on faces, where there are
                                               !! any
    real(dp), allocatable :: force(:, :)       !! (points, ndim) nodes: internal force, before it is
                                               !! corrected
    logical, allocatable :: at(:, :)           !! (points, 3): see at_node
  end type rotation_points_t

contains

  !> Room for some points.
  pure subroutine rotation_points_make(ndim, points, beyond, faced, least_offset, rotation)
    integer, intent(in) :: ndim, points
    integer, intent(in) :: beyond    !! points behind them, of which nothing is used
    logical, intent(in) :: faced     !! forces act on faces of particles
    real(dp), intent(in) :: least_offset
    type(rotation_points_t), intent(out) :: rotation
    integer :: spins, width, n
    spins = merge(1, 3, ndim == 2)
    width = spin_width(spins)
    rotation%least_offset = least_offset
    n = points + beyond
    allocate (rotation%offset(spin_width(ndim), n), rotation%force(n, ndim), rotation%at(n, 3))
    allocate (rotation%inverse(width, spins, n), rotation%tensor(width, spins, n))
    allocate (rotation%moment(width, n), rotation%couple(width, n))
    if (faced) allocate (rotation%face_couple(width, n))
    call rotation_points_clear(points + 1, n, rotation)
  end subroutine rotation_points_make

  !> Nothing takes part of the points of a range. What only points are asked for that take part need
  !! not be cleared.
  pure subroutine rotation_points_clear(first, last, rotation)
    integer, intent(in) :: first, last
    type(rotation_points_t), intent(inout) :: rotation
    rotation%offset(:, first:last) = 0.0_dp
    rotation%moment(:, first:last) = 0.0_dp
    rotation%couple(:, first:last) = 0.0_dp
    if (allocated(rotation%face_couple)) rotation%face_couple(:, first:last) = 0.0_dp
    rotation%at(first:last, :) = .false.
  end subroutine rotation_points_clear

  !> Hands what is kept over without copying it.
  pure subroutine rotation_points_move(from, to)
    type(rotation_points_t), intent(inout) :: from, to
    to%least_offset = from%least_offset
    call move_alloc(from%offset, to%offset)
    call move_alloc(from%inverse, to%inverse)
    call move_alloc(from%tensor, to%tensor)
    call move_alloc(from%moment, to%moment)
    call move_alloc(from%couple, to%couple)
    if (allocated(from%face_couple)) call move_alloc(from%face_couple, to%face_couple)
    call move_alloc(from%force, to%force)
    call move_alloc(from%at, to%at)
  end subroutine rotation_points_move

end module sgmp_rotation_points
