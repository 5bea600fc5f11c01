!> Parts of a body that touches itself which lie so near each other at the start that patches
!! (sgmp_patches) cannot tell them apart: where two neighbouring patches hold cells that are not
!! joined, these parts share a velocity field for good, and stick where they meet.
module sgmp_near_parts
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_parallel, only: parallel_gather
  use sgmp_particles, only: particles_t
  use sgmp_patches, only: patch_of, patch_place, patch_side
  use sgmp_sorting, only: sort_order_within
  implicit none
  private
  public :: near_parts

  integer(i8), parameter :: most = 2_i8**20      !! cells along an axis

contains

  !> Whether there are such parts. All ranks must call it. Every rank holds all cells of the body,
  !! at the price of 80 bytes for each of them; it looks around patches that are not full.
  function near_parts(particles) result(yes)
    type(particles_t), intent(in) :: particles   !! of the body, on this rank
    logical :: yes
    real(dp), allocatable :: all(:)
    integer, allocatable :: cell(:, :), place(:, :), start(:), around(:), both(:)
    integer(i8), allocatable :: patch(:)
    logical, allocatable :: full(:)
    integer :: p, q, c
    cell = own_cells(particles)
    call sort_cells(particles%ndim, cell, patch)
    call parallel_gather(reshape(real(cell, dp), [size(cell)]), all)
    cell = reshape(nint(all), [3, size(all)/3])
    deallocate (all)
    call sort_cells(particles%ndim, cell, patch)
    start = pack([(c, c=1, size(patch))], [(starts(patch, c), c=1, size(patch))])
    patch = patch(start)
    place = reshape([(patch_place(patch(p), particles%ndim), p=1, size(start))], [3, size(start)])
    start = [start, size(cell, 2) + 1]
    full = start(2:) - start(:size(patch)) == nint(patch_side)**particles%ndim
    yes = .false.
    do p = 1, size(patch)
      around = neighbours(patch, place(:, p), particles%ndim)
      do q = 1, size(around)
        if (around(q) < p .or. (full(p) .and. full(around(q)))) cycle
        both = pack(around, near(place(:, around), place(:, around(q))))
        yes = apart(cell, start, both, [p, around(q)])
        if (yes) return
      end do
    end do
  end function near_parts

  pure function starts(patch, c) result(yes)
    integer(i8), intent(in) :: patch(:)
    integer, intent(in) :: c
    logical :: yes
    yes = c == 1
    if (.not. yes) yes = patch(c) /= patch(c - 1)
  end function starts

  !> The patches at a place and beside it, of those that there are.
  pure function neighbours(patch, place, ndim) result(list)
    integer(i8), intent(in) :: patch(:)          !! ascending
    integer, intent(in) :: place(3), ndim
    integer, allocatable :: list(:)
    integer :: i, j, k, low, high, middle
    integer(i8) :: number
    allocate (list(0))
    do k = -merge(1, 0, ndim > 2), merge(1, 0, ndim > 2)
      do j = -merge(1, 0, ndim > 1), merge(1, 0, ndim > 1)
        do i = -1, 1
          associate (at => patch_side*(place + [i, j, k]))
            number = patch_of(at(:ndim))
          end associate
          low = 1
          high = size(patch)
          do while (low < high)
            middle = (low + high)/2
            if (patch(middle) < number) then
              low = middle + 1
            else
              high = middle
            end if
          end do
          if (patch(low) == number) list = [list, low]
        end do
      end do
    end do
  end function neighbours

  !> Which places are one or beside it.
  pure function near(place, one) result(yes)
    integer, intent(in) :: place(:, :), one(3)   !! (3, places)
    logical :: yes(size(place, 2))
    integer :: q
    yes = [(maxval(abs(place(:, q) - one)) <= 1, q=1, size(yes))]
  end function near

  pure function count_cells(particles) result(n)
    type(particles_t), intent(in) :: particles
    integer :: n
    n = count(particles%id(:, :particles%chunks) > 0)
  end function count_cells

  !> Cells of all particles of this rank; 0 along axes that do not exist.
  pure function own_cells(particles) result(cell)
    type(particles_t), intent(in) :: particles
    integer :: cell(3, count_cells(particles))
    integer :: c, l, n
    n = 0
    cell = 0
    do c = 1, particles%chunks
      do l = 1, lanes
        if (particles%id(l, c) <= 0) cycle
        n = n + 1
        cell(:particles%ndim, n) = floor(particles%motion(l, :particles%ndim, c))
      end do
    end do
  end function own_cells

  !> Sorts cells by their patches, and leaves out those that are named twice.
  pure subroutine sort_cells(ndim, cell, patch)
    integer, intent(in) :: ndim
    integer, allocatable, intent(inout) :: cell(:, :)
    integer(i8), allocatable, intent(out) :: patch(:)
    integer(i8), allocatable :: number(:)
    integer, allocatable :: order(:)
    integer :: c, n
    allocate (patch(size(cell, 2)), number(size(cell, 2)), order(size(cell, 2)))
    do c = 1, size(cell, 2)
      patch(c) = patch_of(real(cell(:ndim, c), dp))
      number(c) = ((cell(3, c) + most/2)*most + cell(2, c) + most/2)*most + cell(1, c) + most/2
    end do
    call sort_order_within(patch, number, order)
    n = 0
    do c = 1, size(order)
      if (n > 0) then
        if (number(order(c)) == number(order(n))) cycle
      end if
      n = n + 1
      order(n) = order(c)
    end do
    cell = cell(:, order(:n))
    patch = patch(order(:n))
  end subroutine sort_cells

  !> Whether the cells of two neighbouring patches are not all joined, by faces, edges or corners,
  !! in the patches that are around both.
  ! allow(S901): a flood fill, its box before it and the question after it
  pure function apart(cell, start, around, two) result(yes)
    integer, intent(in) :: cell(:, :)            !! (3, cells)
    integer, intent(in) :: start(:)              !! first cell of each patch, and one more
    integer, intent(in) :: around(:)             !! these patches
    integer, intent(in) :: two(2)
    logical :: yes
    logical, allocatable :: filled(:, :, :)
    integer, allocatable :: list(:, :)
    integer :: low(3), high(3), c, p, n, found, i, j, k
    low = huge(1)
    high = -huge(1)
    do n = 1, size(around)
      p = around(n)
      low = min(low, minval(cell(:, start(p):start(p + 1) - 1), dim=2) - 1)
      high = max(high, maxval(cell(:, start(p):start(p + 1) - 1), dim=2) + 1)
    end do
    allocate (filled(low(1):high(1), low(2):high(2), low(3):high(3)), source=.false.)
    do n = 1, size(around)
      p = around(n)
      do c = start(p), start(p + 1) - 1
        filled(cell(1, c), cell(2, c), cell(3, c)) = .true.
      end do
    end do
    allocate (list(3, count(filled)))
    list(:, 1) = cell(:, start(two(1)))
    filled(list(1, 1), list(2, 1), list(3, 1)) = .false.
    found = 1
    c = 0
    do while (c < found)
      c = c + 1
      do k = list(3, c) - 1, list(3, c) + 1
        do j = list(2, c) - 1, list(2, c) + 1
          do i = list(1, c) - 1, list(1, c) + 1
            if (.not. filled(i, j, k)) cycle
            filled(i, j, k) = .false.
            found = found + 1
            list(:, found) = [i, j, k]
          end do
        end do
      end do
    end do
    yes = .false.
    do p = 1, 2
      do c = start(two(p)), start(two(p) + 1) - 1
        yes = yes .or. filled(cell(1, c), cell(2, c), cell(3, c))
      end do
    end do
  end function apart

end module sgmp_near_parts
