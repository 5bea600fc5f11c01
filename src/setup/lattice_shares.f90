!> What a particle of a lattice stands for: of its cube as much as lies in the body's shapes, and
!! its share of the cubes beside it that have no particle because their middle lies outside. So a
!! body has the volume and the mass of its shapes, however its lattice fits them: of whole cubes a
!! ball of 4 to 8 cells across, two particles to a cell, is 4 to 5 % too heavy or too light
!! (scripts/bench/fitting.py).
module sgmp_lattice_shares
  use sgmp_kinds, only: dp, pi
  use sgmp_lattice, only: lattice_point, lattice_t, lattice_tolerance, lattice_volume
  use sgmp_shapes, only: shape_block, shape_halfspace, shape_planes, shape_t, shapes_cover, &
                         shapes_flat, shapes_inside, surface_depth
  use sgmp_turn, only: turn_back, turn_t, turn_turns
  implicit none
  private
  public :: fitting_t, lattice_fitting, lattice_fitting_prepare, lattice_share, share_reach, &
            share_t

  real(dp), parameter :: share_reach = 2.5_dp     !! lengths of a cube: how far shapes matter
  integer, parameter :: pieces = 4                !! of a cut cube along an axis; where that is flat
                                                  !! as many as there are planes in it, and one
  integer, parameter :: most_pieces = 8
  real(dp), parameter :: least_part = 1.0e-3_dp   !! of a cube; less is not seen, and left whole

  !> A lattice, and the shapes that it fills.
  type :: fitting_t
    type(shape_t), allocatable :: shapes(:)       !! that decide within the reach of a particle
    type(turn_t) :: turn                          !! of the shapes over the lattice
    logical :: turns = .false.                    !! they are turned over it; else both as one
    logical :: flat(3) = .false.                  !! along an axis all surfaces are planes across it
    logical :: rings = .false.                    !! volumes are of rings about x = 0
  end type fitting_t

  !> What a particle stands for.
  type :: share_t
    real(dp) :: volume = 0.0_dp                   !! (length**dimension; of rings length**3)
    real(dp) :: size = 0.0_dp                     !! of rings, the area of their section
    real(dp) :: centre(3) = 0.0_dp                !! on the lattice; while it is summed, times size
  end type share_t

contains

  !> Whether shapes are blocks, and half-spaces along an axis, whose faces all lie between cubes of
  !! the lattice: then each particle has a whole cube, and nothing is to be done.
  pure function lattice_fitting(shapes, lattice) result(fits)
    type(shape_t), intent(in) :: shapes(:)
    type(lattice_t), intent(in) :: lattice
    logical :: fits
    real(dp), parameter :: straight = 1.0_dp - 1.0e-12_dp
    integer :: i, axis
    fits = .false.
    do i = 1, size(shapes)
      associate (shape => shapes(i))
        if (turn_turns(shape%turn)) return
        select case (shape%kind)
        case (shape_block)
          do axis = 1, lattice%ndim
            if (.not. between_cubes(lattice, axis, shape%lower(axis))) return
            if (.not. between_cubes(lattice, axis, shape%upper(axis))) return
          end do
        case (shape_halfspace)
          axis = maxloc(abs(shape%axis), 1)
          if (abs(shape%axis(axis)) < straight) return
          if (.not. between_cubes(lattice, axis, shape%centre(axis))) return
        case default
          return
        end select
      end associate
    end do
    fits = .true.
  end function lattice_fitting

  !> Whether a plane across an axis cuts no cube.
  pure function between_cubes(lattice, axis, place) result(yes)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: axis
    real(dp), intent(in) :: place
    logical :: yes
    associate (n => lattice%count(axis))
      yes = all(abs(lattice%coordinate(:n, axis) - place) >= &
                0.5_dp*lattice%length(:n, axis) - lattice%margin)
    end associate
  end function between_cubes

  !> What a point inside stands for, and the centre of that: so not only the mass of a body is right
  !! but also where its surface layers are, which bear most of its bending.
  pure function lattice_share(fitting, lattice, ijk) result(share)
    type(fitting_t), intent(in) :: fitting
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)                 !! of the point
    type(share_t) :: share
    integer :: by(3), next(3), i, j, k, far(3)
    real(dp) :: depth
    depth = depth_of(fitting, lattice, ijk)
    share = whole(fitting, lattice, ijk)
    if (depth < diagonal(lattice, ijk) .or. &     ! else all points beside this one are inside
        (fitting%rings .and. lattice%coordinate(ijk(1), 1) < lattice%length(ijk(1), 1))) then
      far = merge(1, 0, [1, 2, 3] <= lattice%ndim)
      share = part(fitting, lattice, ijk, depth)
      do k = -far(3), far(3)
        do j = -far(2), far(2)
          do i = -1, 1
            by = [i, j, k]
            next = ijk + by
            if (all(by == 0) .or. any(next < 1 .or. next > lattice%count)) cycle
            if (holds(fitting, lattice, next)) cycle
            call add_portion(fitting, lattice, next, sum(abs(by)), share)
          end do
        end do
      end do
    end if
    if (share%size < least_part*lattice_volume(lattice, ijk)) share = whole(fitting, lattice, ijk)
    if (abs(share%size - lattice_volume(lattice, ijk)) > 0.0_dp) then
      share%centre = share%centre/share%size
    else
      share%centre = lattice_point(lattice, ijk)
    end if
  end function lattice_share

  !> What a point outside gives to each of those beside it that are so near, if none is nearer: its
  !! part is divided equally among the nearest (1: its cube has a face in common with this one, 2:
  !! an edge, 3: a corner).
  pure subroutine add_portion(fitting, lattice, ijk, steps, share)
    type(fitting_t), intent(in) :: fitting
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)                 !! of the point outside
    integer, intent(in) :: steps
    type(share_t), intent(inout) :: share
    integer :: by(3), next(3), i, j, k, far(3), takers
    type(share_t) :: more
    real(dp) :: depth
    depth = depth_of(fitting, lattice, ijk)
    if (depth <= -0.5_dp*diagonal(lattice, ijk)) return
    far = merge(1, 0, [1, 2, 3] <= lattice%ndim)
    takers = 0
    do k = -far(3), far(3)
      do j = -far(2), far(2)
        do i = -1, 1
          by = [i, j, k]
          next = ijk + by
          if (all(by == 0) .or. sum(abs(by)) > steps) cycle
          if (any(next < 1 .or. next > lattice%count)) cycle
          if (.not. holds(fitting, lattice, next)) cycle
          if (sum(abs(by)) < steps) return
          takers = takers + 1
        end do
      end do
    end do
    more = part(fitting, lattice, ijk, depth)
    share%volume = share%volume + more%volume/takers
    share%size = share%size + more%size/takers
    share%centre = share%centre + more%centre/takers
  end subroutine add_portion

  !> A whole cube.
  pure function whole(fitting, lattice, ijk) result(share)
    type(fitting_t), intent(in) :: fitting
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    type(share_t) :: share
    share%size = lattice_volume(lattice, ijk)
    share%centre = lattice_point(lattice, ijk)*share%size
    share%volume = share%size
    if (fitting%rings) then
      share%volume = 2.0_dp*pi*max(lattice%coordinate(ijk(1), 1), 0.0_dp)*share%size
    end if
  end function whole

  !> What is known of shapes over a lattice, once for a line of it.
  pure subroutine lattice_fitting_prepare(fitting, ndim)
    type(fitting_t), intent(inout) :: fitting     !! with all else
    integer, intent(in) :: ndim
    integer :: axis
    if (fitting%turns .and. turn_turns(fitting%turn)) return
    do axis = 1, ndim
      fitting%flat(axis) = shapes_flat(fitting%shapes, axis)
    end do
  end subroutine lattice_fitting_prepare

  !> The part of a cube that lies in the shapes.
  pure function part(fitting, lattice, ijk, depth) result(share)
    type(fitting_t), intent(in) :: fitting
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    real(dp), intent(in) :: depth                 !! of its middle
    type(share_t) :: share
    real(dp) :: edges(0:most_pieces, 3), middle(3), piece(3), cover
    integer :: n(3), i, j, k
    logical :: beyond_axis
    beyond_axis = fitting%rings .and. lattice%coordinate(ijk(1), 1) < &
                  (0.5_dp - lattice_tolerance)*lattice%length(ijk(1), 1)
    if (beyond_axis .or. depth < 0.5_dp*diagonal(lattice, ijk)) then
      call divide(fitting, lattice, ijk, n, edges)
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            middle = 0.5_dp*[edges(i - 1, 1) + edges(i, 1), edges(j - 1, 2) + edges(j, 2), &
                             edges(k - 1, 3) + edges(k, 3)]
            if (fitting%rings .and. middle(1) <= 0.0_dp) cycle
            piece = [edges(i, 1) - edges(i - 1, 1), edges(j, 2) - edges(j - 1, 2), &
                     edges(k, 3) - edges(k - 1, 3)]
            cover = product(piece)*shapes_cover(fitting%shapes, on_body(fitting, middle), piece, &
                                                lattice%ndim)
            share%size = share%size + cover
            share%centre = share%centre + cover*middle
            share%volume = share%volume + cover*middle(1)
          end do
        end do
      end do
      share%volume = merge(2.0_dp*pi*share%volume, share%size, fitting%rings)
      if (share%size < (1.0_dp - lattice_tolerance)*lattice_volume(lattice, ijk)) return
    end if
    share = whole(fitting, lattice, ijk)          ! to the last digit
  end function part

  !> Divides a cube into pieces: along an axis on which all surfaces are planes where these are, so
  !! that volumes and centres are exact; along others evenly.
  pure subroutine divide(fitting, lattice, ijk, n, edges)
    type(fitting_t), intent(in) :: fitting
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    integer, intent(out) :: n(3)                  !! pieces
    real(dp), intent(out) :: edges(0:, :)         !! (piece, axis)
    real(dp) :: low, side
    integer :: axis, i
    n = 1
    edges = -0.5_dp
    edges(1, :) = 0.5_dp
    do axis = 1, lattice%ndim
      side = lattice%length(ijk(axis), axis)
      low = lattice%coordinate(ijk(axis), axis) - 0.5_dp*side
      if (fitting%flat(axis)) then
        call cut_by_planes(fitting%shapes, axis, low, low + side, n(axis), edges(:, axis))
        if (n(axis) > 0) cycle
      end if
      n(axis) = pieces
      edges(:pieces, axis) = low + side*[(i, i=0, pieces)]/pieces
    end do
  end subroutine divide

  !> Edges of the pieces into which planes across an axis cut a length of it.
  pure subroutine cut_by_planes(shapes, axis, low, high, n, edges)
    type(shape_t), intent(in) :: shapes(:)        !! all of them flat along the axis
    integer, intent(in) :: axis
    real(dp), intent(in) :: low, high
    integer, intent(out) :: n                     !! pieces; 0: too many
    real(dp), intent(inout) :: edges(0:)
    real(dp) :: planes(2)
    integer :: i, side
    n = 1
    edges(:1) = [low, high]
    do i = 1, size(shapes)
      planes = shape_planes(shapes(i), axis)
      do side = 1, 2
        associate (plane => planes(side))
          if (plane <= low .or. plane >= high) cycle
          if (any(abs(edges(:n) - plane) < lattice_tolerance*(high - low))) cycle
          if (n == most_pieces) then
            n = 0
            return
          end if
          edges(:n + 1) = [pack(edges(:n), edges(:n) < plane), plane, &
                           pack(edges(:n), edges(:n) > plane)]
          n = n + 1
        end associate
      end do
    end do
  end subroutine cut_by_planes

  !> Whether a point of the lattice is one of the body's particles.
  pure function holds(fitting, lattice, ijk) result(yes)
    type(fitting_t), intent(in) :: fitting
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    logical :: yes
    real(dp) :: point(3)
    point = lattice_point(lattice, ijk)
    yes = shapes_inside(fitting%shapes, on_body(fitting, point), lattice%ndim, lattice%margin)
    if (fitting%rings) yes = yes .and. point(1) > 0.0_dp
  end function holds

  pure function depth_of(fitting, lattice, ijk) result(depth)
    type(fitting_t), intent(in) :: fitting
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    real(dp) :: depth
    depth = surface_depth(fitting%shapes, on_body(fitting, lattice_point(lattice, ijk)), &
                          lattice%ndim)
  end function depth_of

  !> A place of the lattice as the shapes have it.
  pure function on_body(fitting, point) result(place)
    type(fitting_t), intent(in) :: fitting
    real(dp), intent(in) :: point(3)
    real(dp) :: place(3)
    place = point
    if (fitting%turns) call turn_back(fitting%turn, place)
  end function on_body

  pure function sides(lattice, ijk) result(lengths)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    real(dp) :: lengths(3)
    integer :: axis
    lengths = [(lattice%length(ijk(axis), axis), axis=1, 3)]
  end function sides

  !> Of a cube, or of the longest beside it.
  pure function diagonal(lattice, ijk) result(length)
    type(lattice_t), intent(in) :: lattice
    integer, intent(in) :: ijk(3)
    real(dp) :: length, longest(3)
    integer :: axis
    do axis = 1, 3
      longest(axis) = maxval(lattice%length(max(1, ijk(axis) - 1): &
                                            min(lattice%count(axis), ijk(axis) + 1), axis))
    end do
    length = norm2(longest(:lattice%ndim))
  end function diagonal

end module sgmp_lattice_shares
