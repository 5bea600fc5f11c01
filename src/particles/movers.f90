!> Particles that have left their bin in a sweep, with all that is needed to put them elsewhere.
!!
!! The sweep copies a mover's state while its chunk is in the cache. Lists keep the order of the
!! sweep, in which movers from one bin follow each other; `order` sorts them by id.
module sgmp_movers
  use sgmp_buffer, only: buffer_get, buffer_put, buffer_t, buffer_whole
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_sorting, only: sort_order
  implicit none
  private
  public :: movers_t, movers_add, movers_append, movers_reset, movers_sort, &
            movers_read, movers_write

  !> A list of movers.
  type :: movers_t
    integer :: n = 0
    integer(i4), allocatable :: id(:)
    integer, allocatable :: chunk(:), lane(:)  !! where they were; 0: on another rank
    integer, allocatable :: row(:), bin(:)  !! interval of bins and bin: in the sweep those they
                                            !! left, after re-binning those they are in
    logical, allocatable :: gone(:)         !! outside the grid, removed
    integer, allocatable :: order(:)        !! by ascending id, after movers_sort
    real(dp), allocatable :: state(:, :)    !! (columns of both streams, n)
    real(dp), allocatable :: values(:, :)   !! (values, n) what they give to the grid
  end type movers_t

contains

  !> Forgets all movers; each will come with `nstate` values of its own and `nvalues` for the grid.
  pure subroutine movers_reset(movers, nstate, nvalues)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: nstate, nvalues
    movers%n = 0
    if (allocated(movers%id)) then
      if (size(movers%state, 1) == nstate .and. size(movers%values, 1) == nvalues) return
    end if
    call movers_allocate(movers, nstate, nvalues, 64)
  end subroutine movers_reset

  pure subroutine movers_allocate(movers, nstate, nvalues, capacity)
    type(movers_t), intent(out) :: movers
    integer, intent(in) :: nstate, nvalues, capacity
    allocate (movers%id(capacity), movers%chunk(capacity), movers%lane(capacity))
    allocate (movers%row(capacity), movers%bin(capacity), movers%order(capacity))
    allocate (movers%gone(capacity), source=.false.)
    allocate (movers%state(nstate, capacity), movers%values(nvalues, capacity))
  end subroutine movers_allocate

  !> Notes a particle; the caller fills in its state and values.
  pure subroutine movers_add(movers, id, chunk, lane, row, bin)
    type(movers_t), intent(inout) :: movers
    integer(i4), intent(in) :: id
    integer, intent(in) :: chunk, lane, row, bin
    if (movers%n == size(movers%id)) call movers_reserve(movers, 2*movers%n)
    movers%n = movers%n + 1
    movers%id(movers%n) = id
    movers%chunk(movers%n) = chunk
    movers%lane(movers%n) = lane
    movers%row(movers%n) = row
    movers%bin(movers%n) = bin
    movers%gone(movers%n) = .false.
  end subroutine movers_add

  !> Appends one list to another.
  pure subroutine movers_append(movers, more)
    type(movers_t), intent(inout) :: movers
    type(movers_t), intent(in) :: more
    if (more%n == 0) return
    if (movers%n + more%n > size(movers%id)) call movers_reserve(movers, 2*(movers%n + more%n))
    call copy_list(more, movers, movers%n)
    movers%n = movers%n + more%n
  end subroutine movers_append

  pure subroutine movers_reserve(movers, capacity)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: capacity
    type(movers_t) :: new
    call movers_allocate(new, size(movers%state, 1), size(movers%values, 1), capacity)
    call copy_list(movers, new, 0)
    new%n = movers%n
    call move_alloc(new%id, movers%id)
    call move_alloc(new%chunk, movers%chunk)
    call move_alloc(new%lane, movers%lane)
    call move_alloc(new%row, movers%row)
    call move_alloc(new%bin, movers%bin)
    call move_alloc(new%gone, movers%gone)
    call move_alloc(new%order, movers%order)
    call move_alloc(new%state, movers%state)
    call move_alloc(new%values, movers%values)
  end subroutine movers_reserve

  !> Copies a list behind entry `before` of another.
  pure subroutine copy_list(from, to, before)
    type(movers_t), intent(in) :: from
    type(movers_t), intent(inout) :: to
    integer, intent(in) :: before
    integer :: n
    n = from%n
    to%id(before + 1:before + n) = from%id(:n)
    to%chunk(before + 1:before + n) = from%chunk(:n)
    to%lane(before + 1:before + n) = from%lane(:n)
    to%row(before + 1:before + n) = from%row(:n)
    to%bin(before + 1:before + n) = from%bin(:n)
    to%gone(before + 1:before + n) = from%gone(:n)
    to%state(:, before + 1:before + n) = from%state(:, :n)
    to%values(:, before + 1:before + n) = from%values(:, :n)
  end subroutine copy_list

  !> Appends a mover to a message.
  pure subroutine movers_write(movers, m, buffer)
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: m
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, [real(movers%id(m), dp), movers%state(:, m), movers%values(:, m)])
  end subroutine movers_write

  !> Reads a mover from a message; it comes from no chunk of this rank.
  pure subroutine movers_read(movers, buffer)
    type(movers_t), intent(inout) :: movers
    type(buffer_t), intent(inout) :: buffer
    integer :: id
    call buffer_whole(buffer, id)
    call movers_add(movers, int(id, i4), 0, 0, 1, 0)
    call buffer_get(buffer, movers%state(:, movers%n))
    call buffer_get(buffer, movers%values(:, movers%n))
  end subroutine movers_read

  !> Finds the order of the ids.
  pure subroutine movers_sort(movers)
    type(movers_t), intent(inout) :: movers
    call sort_order(int(movers%id(:movers%n), i8), movers%order(:movers%n))
  end subroutine movers_sort

end module sgmp_movers
