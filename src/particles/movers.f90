!> Particles that have left their bin in a sweep, with all that is needed to put them elsewhere.
!!
!! The sweep copies a mover's state while its chunk is in the cache. Every thread has a list of its
!! own, in the order of its sweep.
module sgmp_movers
  use sgmp_buffer, only: buffer_get, buffer_put, buffer_t, buffer_whole
  use sgmp_growing, only: grow
  use sgmp_kinds, only: dp, i4
  implicit none
  private
  public :: movers_t, movers_add, movers_free_chunk, movers_reset, movers_read, movers_write

  !> A list of movers, and the chunks that they have left empty.
  type :: movers_t
    integer :: n = 0
    integer(i4), allocatable :: id(:)
    logical, allocatable :: here(:)         !! from a bin of this rank, not from a message
    logical, allocatable :: gone(:)         !! outside the grid, removed
    logical, allocatable :: eroded(:)       !! removed by its material's card
    integer, allocatable :: row(:)          !! interval of bins: in the sweep that which they left,
                                            !! after re-binning that which they are in
    integer, allocatable :: bin(:)          !! after re-binning: their bin, 0 where none is held
    integer :: bins(2) = 0                  !! after re-binning: least and largest of `bin`
    real(dp), allocatable :: particle(:, :)  !! (columns of motion, then of state, n)
    real(dp), allocatable :: values(:, :)   !! (values, n) what they give to the grid
    logical :: without_bin = .false.           !! some have no bin although one should be held
    integer :: escaped(2) = 0               !! first that must not leave the grid, and the axis
    integer :: freed = 0
    integer, allocatable :: chunk(:)        !! (freed) chunks without particles, in no bin
  end type movers_t

contains

  !> Forgets all movers; each will come with `nstate` values of its own and `nvalues` for the grid.
  pure subroutine movers_reset(movers, nstate, nvalues)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: nstate, nvalues
    movers%n = 0
    movers%freed = 0
    movers%without_bin = .false.
    movers%escaped = 0
    if (allocated(movers%id)) then
      if (size(movers%particle, 1) == nstate .and. size(movers%values, 1) == nvalues) return
    end if
    call movers_allocate(movers, nstate, nvalues, 64)
  end subroutine movers_reset

  pure subroutine movers_allocate(movers, nstate, nvalues, capacity)
    type(movers_t), intent(out) :: movers
    integer, intent(in) :: nstate, nvalues, capacity
    allocate (movers%id(capacity), movers%row(capacity), movers%bin(capacity))
    allocate (movers%here(capacity), movers%gone(capacity), movers%eroded(capacity))
    allocate (movers%particle(nstate, capacity), movers%values(nvalues, capacity))
    allocate (movers%chunk(64))
  end subroutine movers_allocate

  !> Notes a particle; the caller fills in its state and values.
  pure subroutine movers_add(movers, id, here, row)
    type(movers_t), intent(inout) :: movers
    integer(i4), intent(in) :: id
    logical, intent(in) :: here
    integer, intent(in) :: row
    if (movers%n == size(movers%id)) call movers_reserve(movers, 2*movers%n)
    movers%n = movers%n + 1
    movers%id(movers%n) = id
    movers%here(movers%n) = here
    movers%gone(movers%n) = .false.
    movers%eroded(movers%n) = .false.
    movers%row(movers%n) = row
    movers%bin(movers%n) = 0
  end subroutine movers_add

  !> Notes a chunk that no bin uses any more.
  pure subroutine movers_free_chunk(movers, chunk)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: chunk
    call grow(movers%chunk, movers%freed, movers%freed + 1)
    movers%freed = movers%freed + 1
    movers%chunk(movers%freed) = chunk
  end subroutine movers_free_chunk

  pure subroutine movers_reserve(movers, capacity)
    type(movers_t), intent(inout) :: movers
    integer, intent(in) :: capacity
    type(movers_t) :: new
    integer :: n
    call movers_allocate(new, size(movers%particle, 1), size(movers%values, 1), capacity)
    n = movers%n
    new%n = n
    new%id(:n) = movers%id(:n)
    new%here(:n) = movers%here(:n)
    new%gone(:n) = movers%gone(:n)
    new%eroded(:n) = movers%eroded(:n)
    new%row(:n) = movers%row(:n)
    new%bin(:n) = movers%bin(:n)
    new%particle(:, :n) = movers%particle(:, :n)
    new%values(:, :n) = movers%values(:, :n)
    new%freed = movers%freed
    call move_alloc(movers%chunk, new%chunk)
    call movers_replace(new, movers)
  end subroutine movers_reserve

  !> Hands a list over.
  pure subroutine movers_replace(from, to)
    type(movers_t), intent(inout) :: from
    type(movers_t), intent(out) :: to
    to%n = from%n
    to%freed = from%freed
    call move_alloc(from%id, to%id)
    call move_alloc(from%here, to%here)
    call move_alloc(from%gone, to%gone)
    call move_alloc(from%eroded, to%eroded)
    call move_alloc(from%row, to%row)
    call move_alloc(from%bin, to%bin)
    call move_alloc(from%particle, to%particle)
    call move_alloc(from%values, to%values)
    call move_alloc(from%chunk, to%chunk)
  end subroutine movers_replace

  !> Appends a mover to a message.
  pure subroutine movers_write(movers, m, buffer)
    type(movers_t), intent(in) :: movers
    integer, intent(in) :: m
    type(buffer_t), intent(inout) :: buffer
    call buffer_put(buffer, [real(movers%id(m), dp), movers%particle(:, m), movers%values(:, m)])
  end subroutine movers_write

  !> Reads a mover from a message; it comes from no bin of this rank.
  pure subroutine movers_read(movers, buffer)
    type(movers_t), intent(inout) :: movers
    type(buffer_t), intent(inout) :: buffer
    integer :: id
    call buffer_whole(buffer, id)
    call movers_add(movers, int(id, i4), .false., 1)
    call buffer_get(buffer, movers%particle(:, movers%n))
    call buffer_get(buffer, movers%values(:, movers%n))
  end subroutine movers_read

end module sgmp_movers
