!> Sets of names that are asked for many times: by a table of hashes, so that a question costs the
!! same however many there are.
module sgmp_name_set
  use sgmp_kinds, only: i8
  use sgmp_spelling, only: string_t
  implicit none
  private
  public :: name_set_t

  !> Some names, none twice.
  type :: name_set_t
    private
    integer :: count = 0
    type(string_t), allocatable :: names(:)
    integer, allocatable :: table(:)  !! number of a name at its place or soon behind, 0: free
  contains
    procedure :: has
    procedure :: add
  end type name_set_t

contains

  !> Whether a name is in the set.
  pure logical function has(self, name) result(yes)
    class(name_set_t), intent(in) :: self
    character(*), intent(in) :: name
    yes = .false.
    if (self%count > 0) yes = self%table(place(self, name)) > 0
  end function has

  !> Puts a name into the set, where it is not there.
  pure subroutine add(self, name)
    class(name_set_t), intent(inout) :: self
    character(*), intent(in) :: name
    if (self%has(name)) return
    call make_room(self)
    self%count = self%count + 1
    self%names(self%count)%text = name
    self%table(place(self, name)) = self%count
  end subroutine add

  !> Makes room for one more name: a table of at least twice as many places.
  pure subroutine make_room(self)
    type(name_set_t), intent(inout) :: self
    type(string_t), allocatable :: more(:)
    integer :: n
    if (.not. allocated(self%names)) allocate (self%names(0))
    if (self%count < size(self%names)) return
    allocate (more(max(16, 2*self%count)))
    more(:self%count) = self%names(:self%count)
    call move_alloc(more, self%names)
    self%table = [(0, n=1, 2*size(self%names))]
    do n = 1, self%count
      self%table(place(self, self%names(n)%text)) = n
    end do
  end subroutine make_room

  !> Where a name is in the table, or where it would go.
  pure integer function place(self, name) result(at)
    type(name_set_t), intent(in) :: self
    character(*), intent(in) :: name
    at = 1 + int(modulo(hash(name), size(self%table, kind=i8)))
    do while (self%table(at) > 0)
      if (self%names(self%table(at))%text == name) return
      at = 1 + modulo(at, size(self%table))
    end do
  end function place

  !> A number below 2^31 from the letters of a name (trailing blanks do not count).
  pure integer(i8) function hash(name) result(number)
    character(*), intent(in) :: name
    integer :: i
    number = 5381_i8
    do i = 1, len_trim(name)
      number = modulo(33_i8*number + iachar(name(i:i)), 2147483647_i8)
    end do
  end function hash

end module sgmp_name_set
