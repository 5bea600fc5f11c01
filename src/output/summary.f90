!> summary.json: the figures of a finished run for scripts and comparisons.
!!
!! Keys used by the driver (DESIGN 3): exit_status, steps, particle_steps, wall_seconds,
!! cpu_seconds, solve_seconds (wall), ns_per_particle_step, ranks, threads, peak_memory_bytes,
!! energy.*, checksum. A dot nests.
module sgmp_summary
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sgmp_errors, only: error_make, error_t, exit_io
  use sgmp_file_tools, only: newline, output_file_t
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_text, only: integer_text, real_text_short
  implicit none
  private
  public :: summary_t

  !> One value under its dotted key, as JSON text.
  type :: item_t
    character(:), allocatable :: key, json
  end type item_t

  !> A JSON object under construction; keys keep the order in which they were first set.
  type :: summary_t
    private
    type(item_t), allocatable :: items(:)
  contains
    procedure, private :: set_i4, set_i8, set_real, set_logical, set_text, set_reals, set_texts
    generic :: set => set_i4, set_i8, set_real, set_logical, set_text, set_reals, set_texts
    procedure :: json => summary_json
    procedure :: write => summary_write
  end type summary_t

contains

  subroutine set_i4(self, key, value)
    class(summary_t), intent(inout) :: self
    character(*), intent(in) :: key
    integer(i4), intent(in) :: value
    call store(self, key, integer_text(value))
  end subroutine set_i4

  subroutine set_i8(self, key, value)
    class(summary_t), intent(inout) :: self
    character(*), intent(in) :: key
    integer(i8), intent(in) :: value
    call store(self, key, integer_text(value))
  end subroutine set_i8

  subroutine set_real(self, key, value)
    class(summary_t), intent(inout) :: self
    character(*), intent(in) :: key
    real(dp), intent(in) :: value
    call store(self, key, real_json(value))
  end subroutine set_real

  subroutine set_reals(self, key, value)
    class(summary_t), intent(inout) :: self
    character(*), intent(in) :: key
    real(dp), intent(in) :: value(:)
    character(:), allocatable :: text
    integer :: i
    text = '['
    do i = 1, size(value)
      if (i > 1) text = text//', '
      text = text//real_json(value(i))
    end do
    call store(self, key, text//']')
  end subroutine set_reals

  subroutine set_logical(self, key, value)
    class(summary_t), intent(inout) :: self
    character(*), intent(in) :: key
    logical, intent(in) :: value
    if (value) then
      call store(self, key, 'true')
    else
      call store(self, key, 'false')
    end if
  end subroutine set_logical

  subroutine set_text(self, key, value)
    class(summary_t), intent(inout) :: self
    character(*), intent(in) :: key
    character(*), intent(in) :: value
    call store(self, key, quoted(value))
  end subroutine set_text

  subroutine set_texts(self, key, value)
    class(summary_t), intent(inout) :: self
    character(*), intent(in) :: key
    character(*), intent(in) :: value(:)  !! less the blanks at their ends
    character(:), allocatable :: text
    integer :: i
    text = '['
    do i = 1, size(value)
      if (i > 1) text = text//', '
      text = text//quoted(trim(value(i)))
    end do
    call store(self, key, text//']')
  end subroutine set_texts

  !> Sets or replaces the value under a dotted key.
  subroutine store(self, key, json)
    type(summary_t), intent(inout) :: self
    character(*), intent(in) :: key, json
    type(item_t) :: new
    integer :: i
    if (.not. allocated(self%items)) allocate (self%items(0))
    do i = 1, size(self%items)
      if (self%items(i)%key == trim(key)) then
        self%items(i)%json = json
        return
      end if
    end do
    new%key = trim(key)
    new%json = json
    self%items = [self%items, new]
  end subroutine store

  !> Writes the object to a file that appears complete or not at all.
  subroutine summary_write(self, path, error)
    class(summary_t), intent(in) :: self
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(output_file_t) :: file
    character(:), allocatable :: text
    call self%json(text, error)
    if (allocated(error)) return
    call file%open(path, 'replace', error)
    if (allocated(error)) return
    call file%line(text)
    call file%close(error)
  end subroutine summary_write

  !> The object as indented JSON; fails if a key is both a value and an object.
  subroutine summary_json(self, text, error)
    class(summary_t), intent(in) :: self
    character(:), allocatable, intent(out) :: text
    type(error_t), allocatable, intent(out) :: error
    integer :: i, j
    if (.not. allocated(self%items)) then
      text = '{}'
      return
    end if
    do i = 1, size(self%items)
      do j = 1, size(self%items)
        if (index(self%items(j)%key, self%items(i)%key//'.') /= 1) cycle
        call error_make(error, exit_io, "summary key '"//self%items(i)%key// &
                        "' is both a value and an object", &
                        'this is a fault of the program: report it')
        return
      end do
    end do
    text = object(self%items, '', 1)
  end subroutine summary_json

  !> The object of all items whose keys begin with `prefix`.
  pure recursive function object(items, prefix, depth) result(text)
    type(item_t), intent(in) :: items(:)
    character(*), intent(in) :: prefix  !! empty, or ends in a dot
    integer, intent(in) :: depth
    character(:), allocatable :: text, name, value
    integer :: dot, i, j
    logical :: seen
    text = ''
    do i = 1, size(items)
      if (index(items(i)%key, prefix) /= 1) cycle
      name = items(i)%key(len(prefix) + 1:)
      dot = index(name, '.')
      if (dot > 0) then
        name = name(:dot - 1)
        seen = .false.
        do j = 1, i - 1
          seen = seen .or. index(items(j)%key, prefix//name//'.') == 1
        end do
        if (seen) cycle
        value = object(items, prefix//name//'.', depth + 1)
      else
        value = items(i)%json
      end if
      if (len(text) > 0) text = text//','
      text = text//newline//repeat('  ', depth)//quoted(name)//': '//value
    end do
    text = '{'//text//newline//repeat('  ', depth - 1)//'}'
  end function object

  !> A JSON number, or null for NaN and infinities, which JSON lacks.
  pure function real_json(value) result(text)
    real(dp), intent(in) :: value
    character(:), allocatable :: text
    if (ieee_is_finite(value)) then
      text = real_text_short(value)
    else
      text = 'null'
    end if
  end function real_json

  !> A JSON string; letters in UTF-8 pass through, other bytes above 127 become U+FFFD.
  pure function quoted(text) result(json)
    character(*), intent(in) :: text
    character(:), allocatable :: json
    character(6) :: code
    integer :: i, skip
    json = '"'
    skip = 0
    do i = 1, len(text)
      if (skip > 0) then  ! within a letter
        skip = skip - 1
        json = json//text(i:i)
        cycle
      end if
      select case (iachar(text(i:i)))
      case (8)
        json = json//'\b'
      case (9)
        json = json//'\t'
      case (10)
        json = json//'\n'
      case (13)
        json = json//'\r'
      case (34)
        json = json//'\"'
      case (92)
        json = json//'\\'
      case (0:7, 11:12, 14:31)
        write (code, '("\u", z4.4)') iachar(text(i:i))
        json = json//code
      case (128:)
        skip = letter_bytes(text(i:)) - 1
        if (skip < 0) json = json//'\ufffd'
        if (skip >= 0) json = json//text(i:i)
        skip = max(0, skip)
      case default
        json = json//text(i:i)
      end select
    end do
    json = json//'"'
  end function quoted

  !> Bytes of the letter beyond ASCII that a text begins with, 0 where that is no UTF-8 (RFC 3629:
  !! no longer form than needed, no surrogates, nothing above U+10FFFF).
  pure integer function letter_bytes(text) result(n)
    character(*), intent(in) :: text
    integer :: first, i, lowest, highest
    first = iachar(text(1:1))
    n = 2 + merge(1, 0, first >= 224) + merge(1, 0, first >= 240)
    if (first < 194 .or. first > 244 .or. len(text) < n) n = 0
    lowest = 128
    highest = 191
    if (first == 224) lowest = 160
    if (first == 237) highest = 159
    if (first == 240) lowest = 144
    if (first == 244) highest = 143
    do i = 2, n
      if (iachar(text(i:i)) < lowest .or. iachar(text(i:i)) > highest) exit
      lowest = 128
      highest = 191
    end do
    if (i <= n) n = 0
  end function letter_bytes

end module sgmp_summary
