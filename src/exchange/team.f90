!> The threads of a rank: the slabs of planes that they take, their buffers, and their lists of
!! particles that leave their bins.
module sgmp_team
  use sgmp_body, only: body_t
  use sgmp_field, only: field_t
  use sgmp_halo, only: halo_own_planes
  use sgmp_kernels, only: stencil_width
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_movers, only: movers_reset, movers_t
  use sgmp_pace, only: pace_cost, pace_learn, pace_share, pace_t
  use sgmp_partition, only: partition_t
  use sgmp_passes, only: passes_of, passes_t
  use sgmp_plan, only: workspace_t
  implicit none
  private
  public :: team_t, team_divide, team_make, team_slabs
  public :: slab_empty, stencil_layers

  !> How the threads of a rank share the work.
  type :: team_t
    integer :: threads = 1
    type(passes_t) :: passes                 !! what they do to a plane
    integer, allocatable :: slabs(:, :)      !! (slabs + 1, fields) first planes, see team_divide
    type(pace_t), allocatable :: paces(:)    !! (fields)
    type(workspace_t), allocatable :: workspaces(:, :)  !! (slabs, fields)
    type(movers_t), allocatable :: movers(:, :)  !! (bodies, slabs + 1) who left their bins, and
                                                 !! who came from other ranks
  end type team_t

  !> Slabs of a field: the lowest and highest planes of the rank, where neighbours wait for them,
  !! and one for each thread between.
  integer, parameter :: borders = 2

contains

  !> Slabs that a field is divided into, some of which may be empty.
  pure function team_slabs(threads) result(slabs)
    integer, intent(in) :: threads
    integer :: slabs
    slabs = threads + borders
  end function team_slabs

  !> A team without particles.
  subroutine team_make(team, threads, space, fields, bodies)
    type(team_t), intent(out) :: team
    integer, intent(in) :: threads, space
    integer, intent(in) :: fields, bodies        !! how many
    integer :: b, s
    team%threads = threads
    team%passes = passes_of(space)
    allocate (team%slabs(team_slabs(threads) + 1, fields))
    allocate (team%workspaces(team_slabs(threads), fields), team%paces(fields))
    allocate (team%movers(bodies, team_slabs(threads) + 1))
    do s = 1, size(team%movers, 2)
      do b = 1, bodies  ! empty lists also for bodies that no sweep ever visits
        call movers_reset(team%movers(b, s), 0, 0)
      end do
    end do
  end subroutine team_make

  !> Divides the planes of field f into slabs: the threads' loads, in chunks times what these cost,
  !! are about the same, of which the borders belong to the first thread.
  pure subroutine team_divide(team, f, field, bodies, partition)
    type(team_t), intent(inout) :: team
    integer, intent(in) :: f
    type(field_t), intent(in) :: field
    type(body_t), intent(in) :: bodies(:)
    type(partition_t), intent(in) :: partition
    real(dp), allocatable :: chunks(:), load(:)
    real(dp) :: before, total
    integer :: p, t, p1, p2, least, border(2)
    call halo_own_planes(field, partition, p1, p2)
    allocate (chunks(p1:p2), load(p1:p2))
    call pace_learn(team%paces(f))
    do p = p1, p2
      chunks(p) = plane_load(bodies, f, p)
      load(p) = chunks(p)*pace_cost(team%paces(f), field%plane_k(p))
    end do
    total = sum(load)
    least = max(1, stencil_layers(field) - 1)
    border = border_planes(field, partition)
    if (sum(border) + least > p2 - p1 + 1) border = 0
    before = sum(load(:p1 + border(1) - 1)) + sum(load(p2 - border(2) + 1:))
    if (before*team%threads > total) then
      border = 0
      before = 0.0_dp
    end if
    associate (first => team%slabs(:, f))
      first = p2 - border(2) + 1
      first(1) = p1
      first(2) = p1 + border(1)
      first(size(first)) = p2 + 1
      t = 1
      do p = p1 + border(1), p2 - border(2)
        if (t < team%threads .and. (before + 0.5_dp*load(p))*team%threads >= total*t .and. &
            p - first(t + 1) >= least .and. p2 - border(2) - p + 1 >= least) then
          t = t + 1
          first(t + 1) = p
        end if
        before = before + load(p)
      end do
      call pace_share(team%paces(f), [(field%plane_k(min(first(t + 1), p2)), t=1, team%threads)], &
                      [(sum(chunks(first(t + 1):first(t + 2) - 1)), t=1, team%threads)])
    end associate
  end subroutine team_divide

  !> Planes that a particle gives to.
  pure function stencil_layers(field) result(n)
    type(field_t), intent(in) :: field
    integer :: n
    n = merge(1, stencil_width(field%kernel), field%ndim == 1)
  end function stencil_layers

  !> Whether slab s of field f has no planes.
  pure function slab_empty(team, f, s) result(yes)
    type(team_t), intent(in) :: team
    integer, intent(in) :: f, s
    logical :: yes
    yes = team%slabs(s + 1, f) <= team%slabs(s, f)
  end function slab_empty

  !> Chunks of a plane.
  pure function plane_load(bodies, f, p) result(load)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: f, p
    integer(i8) :: load
    integer :: b, s, first, last
    load = 0_i8
    do b = 1, size(bodies)
      if (bodies(b)%field /= f) cycle
      associate (particles => bodies(b)%particles)
        do s = particles%plane_row(p), particles%plane_row(p + 1) - 1
          first = particles%bin_start(s) + particles%bins%first(s)
          last = particles%bin_start(s) + particles%bins%last(s)
          load = load + sum(int((particles%size(first:last) + lanes - 1)/lanes, i8))
        end do
      end associate
    end do
  end function plane_load

  !> Planes that a neighbour below and above waits for; above also those in which a slab is joined
  !! to the one below.
  pure function border_planes(field, partition) result(border)
    type(field_t), intent(in) :: field
    type(partition_t), intent(in) :: partition
    integer :: border(2), joined
    joined = stencil_layers(field) - 1
    border = 0
    if (partition%rank > 0) border(1) = max(partition%moments(2), joined)
    if (partition%rank < partition%ranks - 1) border(2) = partition%moments(1) + joined
  end function border_planes

end module sgmp_team
