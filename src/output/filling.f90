!> Whether the particles' volumes fit into the room that they have.
!!
!! Every particle spreads its volume over the cells around it with the weights of the auxiliary
!! grid, what falls behind a wall back into the scene. Where the volumes of a cell sum to more than
!! the cell, particles have lost touch with the space they stand for: their neighbours are gone, or
!! their volumes have drifted. Of spray and debris the volume of the matter counts, not the gaps
!! that its particles stand for as well. Shares are whole numbers, so that sums depend on no order
!! and on no layout of ranks.
module sgmp_filling
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: law_liquid
  use sgmp_debris, only: debris_possible
  use sgmp_failure, only: failure_none
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_mesh, only: mesh_occupied, mesh_t, wall_free
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass
  use sgmp_parallel, only: parallel_deal, parallel_sum
  use sgmp_partition, only: partition_owner
  use sgmp_sorting, only: sort_order
  implicit none
  private
  public :: filling_measure

  integer(i8), parameter :: unit = 2_i8**24      !! of volume, in a cell
  real(dp), parameter :: most = 1.0e4_dp         !! cells; larger particles count as so large
  integer(i8), parameter :: base = 2_i8**20      !! cells on either side of the origin
  integer, parameter :: batch = 2**15            !! shares that are merged at once, in the caches

contains

  !> Volumes of all particles that move freely: their sum, and the part of it that has no room in
  !! the cells around it.
  subroutine filling_measure(model, sum_over_box, excess, reached)
    type(model_t), intent(in) :: model
    real(dp), intent(out) :: sum_over_box     !! 0 where walls do not enclose the scene
    real(dp), intent(out) :: excess
    real(dp), intent(out) :: reached          !! part of the box that some particle gives volume to,
                                              !! 0 as above
    integer(i8), allocatable :: cell(:), share(:)
    integer(i8) :: total, without, touched
    real(dp) :: cells
    call spread_volumes(model, cell, share)
    call send_home(model, cell, share)
    call merge_cells(cell, share)
    total = parallel_sum(sum(share))
    without = parallel_sum(sum(max(0_i8, share - unit)))
    excess = real(without, dp)/real(max(1_i8, total), dp)
    touched = parallel_sum(count(share > 0_i8, kind=i8))
    sum_over_box = 0.0_dp
    reached = 0.0_dp
    if (all(model%mesh%wall(:, :model%mesh%ndim) /= wall_free)) then
      cells = product(real(model%mesh%cells(:model%mesh%ndim), dp))
      sum_over_box = real(total, dp)/(real(unit, dp)*cells)
      reached = real(touched, dp)/cells
    end if
  end subroutine filling_measure

  !> Shares of this rank's particles, cells in ascending order and named once.
  subroutine spread_volumes(model, cell, share)
    type(model_t), intent(in) :: model
    integer(i8), allocatable, intent(out) :: cell(:), share(:)
    integer(i8), allocatable :: new_cell(:), new_share(:)
    integer :: b, m
    m = 0
    allocate (cell(0), share(0))
    do b = 1, size(model%bodies)
      if (model%bodies(b)%rigid) cycle
      !$omp parallel default(none) shared(model, b, cell, share, m) private(new_cell, new_share)
      call spread_body(model, b, new_cell, new_share)
      !$omp critical (fillings)
      call grow(cell, m, m + size(new_cell))
      call grow(share, m, m + size(new_cell))
      cell(m + 1:m + size(new_cell)) = new_cell
      share(m + 1:m + size(new_cell)) = new_share
      m = m + size(new_cell)
      !$omp end critical (fillings)
      !$omp end parallel
    end do
    cell = cell(:m)
    share = share(:m)
    call merge_cells(cell, share)  ! sums of whole numbers: the order of the threads is not seen
  end subroutine spread_volumes

  !> Shares of the particles of a body that fall to this thread. Particles that follow each other
  !! give to the same cells more often than not: these are added up first.
  subroutine spread_body(model, b, cell, share)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    integer(i8), allocatable, intent(out) :: cell(:), share(:)
    integer(i8), allocatable :: new_cell(:), new_share(:)
    integer(i8), dimension(2**model%mesh%ndim) :: cells, shares, sums, at
    integer :: c, l, n, m, nd, corners
    nd = model%mesh%ndim
    corners = 2**nd
    allocate (cell(0), share(0), new_cell(batch), new_share(batch))
    n = 0
    m = 0
    at = -1_i8
    sums = 0_i8
    associate (particles => model%bodies(b)%particles)
      !$omp do
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          call spread_one(model%mesh, particles%motion(l, :nd, c), &
                          matter_volume(model%bodies(b), l, c), cells, shares)
          if (any(cells /= at)) then
            if (n + corners > batch) call append(new_cell, new_share, n, cell, share, m)
            new_cell(n + 1:n + corners) = at
            new_share(n + 1:n + corners) = sums
            if (at(1) >= 0_i8) n = n + corners
            at = cells
            sums = 0_i8
          end if
          sums = sums + shares
        end do
      end do
      !$omp end do
    end associate
    call append(new_cell, new_share, n, cell, share, m)
    if (at(1) >= 0_i8) then
      cell = [cell(:m), at]
      share = [share(:m), sums]
    else
      cell = cell(:m)
      share = share(:m)
    end if
  end subroutine spread_body

  !> Volume of a particle; of one that has been pulled apart as far as it bears, a liquid's or one
  !! that has failed, at most the first one.
  pure function matter_volume(body, l, c) result(volume)
    type(body_t), intent(in) :: body
    integer, intent(in) :: l, c
    real(dp) :: volume
    logical :: apart
    associate (law => body%law, particles => body%particles)
      volume = particles%state(l, law%slots%volume, c)
      apart = law_liquid(law) .and. law%failure%tension < failure_none
      if (debris_possible(law)) apart = particles%state(l, law%slots%damage, c) >= 1.0_dp
      if (.not. apart) return
      volume = min(volume, particles%motion(l, motion_mass(particles%ndim), c)/law%density)
    end associate
  end function matter_volume

  !> Adds n new shares to m, each cell of them named once, and forgets them.
  pure subroutine append(new_cell, new_share, n, cell, share, m)
    integer(i8), intent(in) :: new_cell(:), new_share(:)
    integer, intent(inout) :: n
    integer(i8), allocatable, intent(inout) :: cell(:), share(:)
    integer, intent(inout) :: m
    integer(i8), allocatable :: merged_cell(:), merged_share(:)
    merged_cell = new_cell(:n)
    merged_share = new_share(:n)
    call merge_cells(merged_cell, merged_share)
    n = size(merged_cell)
    call grow(cell, m, m + n)
    call grow(share, m, m + n)
    cell(m + 1:m + n) = merged_cell
    share(m + 1:m + n) = merged_share
    m = m + n
    n = 0
  end subroutine append

  !> Shares of one particle.
  pure subroutine spread_one(mesh, x, volume, cell, share)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: x(:)              !! (ndim) in cells
    real(dp), intent(in) :: volume
    integer(i8), intent(out) :: cell(:), share(:)   !! (2**ndim)
    integer :: corner, axis, at(3), low(3), up
    real(dp) :: weight, part
    low = 0
    low(:mesh%ndim) = floor(x - 0.5_dp)
    do corner = 0, size(cell) - 1
      weight = min(mesh_occupied(mesh, x, volume), most)
      at = 0
      do axis = 1, mesh%ndim
        up = ibits(corner, axis - 1, 1)
        part = x(axis) - 0.5_dp - low(axis)
        weight = weight*merge(part, 1.0_dp - part, up == 1)
        at(axis) = folded(mesh, axis, low(axis) + up)
      end do
      cell(corner + 1) = ((at(3) + base)*2*base + at(2) + base)*2*base + at(1) + base
      share(corner + 1) = nint(weight*unit, i8)
    end do
  end subroutine spread_one

  !> A cell, or its mirror image if it lies behind a wall.
  pure function folded(mesh, axis, i) result(j)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis, i
    integer :: j
    j = i
    if (i < mesh%lower(axis) .and. mesh%wall(1, axis) /= wall_free) j = 2*mesh%lower(axis) - 1 - i
    if (i >= mesh%upper(axis) .and. mesh%wall(2, axis) /= wall_free) j = 2*mesh%upper(axis) - 1 - i
  end function folded

  !> Gives the shares to the ranks that own the cells' planes.
  subroutine send_home(model, cell, share)
    type(model_t), intent(in) :: model
    integer(i8), allocatable, intent(inout) :: cell(:), share(:)
    real(dp), allocatable :: columns(:, :), received(:, :)
    integer, allocatable :: owner(:)
    integer :: n
    if (model%ranks%partition%ranks == 1) return
    allocate (owner(size(cell)), columns(3, size(cell)))
    do n = 1, size(cell)
      owner(n) = partition_owner(model%ranks%partition, plane_of(cell(n), model%mesh%ndim))
      columns(:, n) = [real(cell(n)/(2*base), dp), real(modulo(cell(n), 2*base), dp), &
                       real(share(n), dp)]
    end do
    call parallel_deal(columns, owner, received)
    cell = nint(received(1, :), i8)*2*base + nint(received(2, :), i8)
    share = nint(received(3, :), i8)
  end subroutine send_home

  !> The plane of a cell along the slowest axis.
  pure function plane_of(cell, ndim) result(plane)
    integer(i8), intent(in) :: cell
    integer, intent(in) :: ndim
    integer :: plane
    plane = 0
    if (ndim > 1) plane = int(modulo(cell/(2*base)**(ndim - 1), 2*base) - base)
  end function plane_of

  !> Adds the shares of equal cells.
  pure subroutine merge_cells(cell, share)
    integer(i8), allocatable, intent(inout) :: cell(:), share(:)
    integer, allocatable :: order(:)
    integer :: n, m
    if (size(cell) == 0) return
    allocate (order(size(cell)))
    call sort_order(cell, order)
    cell = cell(order)
    share = share(order)
    m = 1
    do n = 2, size(cell)
      if (cell(n) == cell(m)) then
        share(m) = share(m) + share(n)
      else
        m = m + 1
        cell(m) = cell(n)
        share(m) = share(n)
      end if
    end do
    cell = cell(:m)
    share = share(:m)
  end subroutine merge_cells

end module sgmp_filling
