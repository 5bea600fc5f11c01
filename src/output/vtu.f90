!> Particle fields for ParaView: one .vtu file per dump and a .pvd collection that lists them with
!! times.
!!
!! VTK XML UnstructuredGrid, one vertex cell per particle, appended raw data with UInt64 block
!! sizes; for readers older than VTK 9.3 (ParaView 5.11), which do not know temporal VTKHDF.
module sgmp_vtu
  use, intrinsic :: iso_c_binding, only: c_int8_t
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: file_exists, file_lines, file_remove, line_t, output_file_t
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_snapshot, only: snapshot_field_t, snapshot_t
  use sgmp_text, only: integer_text, real_text_full
  use sgmp_vtk_fields, only: tensor_order, vector_order, vtk_components, vtk_field_values, &
                             vtk_is_tensor, vtk_is_vector, vtk_is_whole
  use sgmp_write_behind, only: write_behind_t
  implicit none
  private
  public :: vtu_series_t, vtu_write

  !> One file of the collection.
  type :: entry_t
    real(dp) :: time = 0.0_dp
    character(:), allocatable :: file
  end type entry_t

  !> `folder/name.pvd` and its `name_NNNNNNN.vtu`, numbered by step.
  type :: vtu_series_t
    private
    character(:), allocatable :: folder, name
    type(entry_t), allocatable :: entries(:)
  contains
    procedure :: open => series_open
    procedure :: dump => series_dump
  end type vtu_series_t

contains

  !> Starts a collection; with `keep_to_time`, entries of an existing one up to that time stay.
  subroutine series_open(self, folder, name, error, keep_to_time)
    class(vtu_series_t), intent(inout) :: self
    character(*), intent(in) :: folder, name
    type(error_t), allocatable, intent(out) :: error
    real(dp), intent(in), optional :: keep_to_time
    character(:), allocatable :: path
    self%folder = trim(folder)
    self%name = trim(name)
    if (allocated(self%entries)) deallocate (self%entries)
    allocate (self%entries(0))
    if (.not. present(keep_to_time)) return
    path = self%folder//'/'//self%name//'.pvd'
    if (file_exists(path)) call read_entries(self%folder, path, keep_to_time, self%entries, error)
  end subroutine series_open

  !> Writes one dump, then the collection; both replace what was there in one step. With `behind`
  !! a thread does so, in this order.
  subroutine series_dump(self, snapshot, error, behind)
    class(vtu_series_t), intent(inout) :: self
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(out) :: error
    type(write_behind_t), intent(in), optional :: behind
    type(output_file_t) :: file
    type(entry_t) :: entry
    character(24) :: number
    integer :: i
    write (number, '(i0.7)') snapshot%step
    entry%time = snapshot%time
    entry%file = self%name//'_'//trim(number)//'.vtu'
    call vtu_write(self%folder//'/'//entry%file, snapshot, error, behind)
    if (allocated(error)) return
    call set_entry(self%entries, entry)
    call file%open(self%folder//'/'//self%name//'.pvd', 'replace', error, behind)
    if (allocated(error)) return
    call file%line('<?xml version="1.0"?>')
    call file%line('<VTKFile type="Collection" version="1.0" byte_order="'//byte_order()//'">')
    call file%line('  <Collection>')
    do i = 1, size(self%entries)
      call file%line('    <DataSet timestep="'//real_text_full(self%entries(i)%time)// &
                     '" group="" part="0" file="'//escaped(self%entries(i)%file)//'"/>')
    end do
    call file%line('  </Collection>')
    call file%line('</VTKFile>')
    call file%close(error)
  end subroutine series_dump

  !> Writes one .vtu file: points, id, body, velocity and the snapshot's fields (tensors as six
  !! components xx yy zz xy yz xz, vectors as three), with the time as field data `TimeValue`.
  subroutine vtu_write(path, snapshot, error, behind)
    character(*), intent(in) :: path
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(out) :: error
    type(write_behind_t), intent(in), optional :: behind  !! writes later; absent: at once
    type(output_file_t) :: file
    integer(i8) :: offset
    integer :: f, n
    n = size(snapshot%id)
    offset = 0
    call file%open(path, 'replace', error, behind)
    if (allocated(error)) return
    call file%line('<?xml version="1.0"?>')
    call file%line('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="'//byte_order()// &
                   '" header_type="UInt64">')
    call file%line('<UnstructuredGrid>')
    call file%line('<FieldData>')
    call declare(file, 'Float64', 'TimeValue', 8_i8, offset, ' NumberOfTuples="1"')
    call file%line('</FieldData>')
    call file%line('<Piece NumberOfPoints="'//integer_text(n)//'" NumberOfCells="'// &
                   integer_text(n)//'">')
    call file%line('<PointData Vectors="velocity">')
    call declare(file, 'Int32', 'id', 4_i8*n, offset)
    call declare(file, 'Int32', 'body', 4_i8*n, offset)
    call declare(file, 'Float64', 'velocity', 24_i8*n, offset, component_attributes(vector_order))
    if (allocated(snapshot%initial_position)) then
      call declare(file, 'Float64', 'initial_position', 24_i8*n, offset, &
                   component_attributes(vector_order))
    end if
    if (allocated(snapshot%fields)) then
      do f = 1, size(snapshot%fields)
        call declare_field(file, snapshot%fields(f), n, offset)
      end do
    end if
    call file%line('</PointData>')
    call file%line('<Points>')
    call declare(file, 'Float64', 'Points', 24_i8*n, offset, ' NumberOfComponents="3"')
    call file%line('</Points>')
    call file%line('<Cells>')
    call declare(file, 'Int64', 'connectivity', 8_i8*n, offset)
    call declare(file, 'Int64', 'offsets', 8_i8*n, offset)
    call declare(file, 'UInt8', 'types', int(n, i8), offset)
    call file%line('</Cells>')
    call file%line('</Piece>')
    call file%line('</UnstructuredGrid>')
    call file%line('<AppendedData encoding="raw">')
    call file%put('_')
    call put_data(file, snapshot)
    call file%line('')
    call file%line('</AppendedData>')
    call file%line('</VTKFile>')
    call file%close(error)
  end subroutine vtu_write

  !> The data blocks, in the order of their declarations.
  subroutine put_data(file, snapshot)
    type(output_file_t), intent(inout) :: file
    type(snapshot_t), intent(in) :: snapshot
    integer(c_int8_t), parameter :: vertex = 1_c_int8_t
    integer(i8), allocatable :: numbers(:)
    integer(c_int8_t), allocatable :: types(:)
    integer :: f, n, p
    n = size(snapshot%id)
    call file%put([8_i8])
    call file%put([snapshot%time])
    call file%put([4_i8*n])
    call file%put(snapshot%id)
    call file%put([4_i8*n])
    call file%put(snapshot%body)
    call file%put([24_i8*n])
    call file%put(snapshot%velocity)
    if (allocated(snapshot%initial_position)) then
      call file%put([24_i8*n])
      call file%put(snapshot%initial_position)
    end if
    if (allocated(snapshot%fields)) then
      do f = 1, size(snapshot%fields)
        call put_field(file, snapshot%fields(f))
      end do
    end if
    call file%put([24_i8*n])
    call file%put(snapshot%position)
    allocate (numbers(n + 1))
    do p = 1, n + 1
      numbers(p) = p - 1
    end do
    call file%put([8_i8*n])
    call file%put(numbers(:n))
    call file%put([8_i8*n])
    call file%put(numbers(2:))
    call file%put([int(n, i8)])
    allocate (types(n), source=vertex)
    call file%put(types)
  end subroutine put_data

  !> One DataArray element; advances the offset by the block and its 8-byte size.
  subroutine declare(file, kind, name, bytes, offset, attributes)
    type(output_file_t), intent(inout) :: file
    character(*), intent(in) :: kind, name
    integer(i8), intent(in) :: bytes
    integer(i8), intent(inout) :: offset
    character(*), intent(in), optional :: attributes
    character(:), allocatable :: more
    more = ''
    if (present(attributes)) more = attributes
    call file%line('<DataArray type="'//kind//'" Name="'//escaped(name)//'"'//more// &
                   ' format="appended" offset="'//integer_text(offset)//'"/>')
    offset = offset + 8 + bytes
  end subroutine declare

  subroutine declare_field(file, field, n, offset)
    type(output_file_t), intent(inout) :: file
    type(snapshot_field_t), intent(in) :: field
    integer, intent(in) :: n
    integer(i8), intent(inout) :: offset
    character(:), allocatable :: attributes
    if (vtk_is_tensor(field)) then
      attributes = component_attributes(tensor_order)
    else if (vtk_is_vector(field)) then
      attributes = component_attributes(vector_order)
    else
      attributes = component_attributes(field%components)
    end if
    call declare(file, 'Float64', trim(field%name), 8_i8*vtk_components(field)*n, offset, &
                 attributes)
  end subroutine declare_field

  subroutine put_field(file, field)
    type(output_file_t), intent(inout) :: file
    type(snapshot_field_t), intent(in) :: field
    real(dp), allocatable :: values(:, :)
    if (vtk_is_whole(field)) then
      call file%put([8*size(field%values, kind=i8)])
      call file%put(field%values)
      return
    end if
    call vtk_field_values(field, values)
    call file%put([8*size(values, kind=i8)])
    call file%put(values)
  end subroutine put_field

  pure function component_attributes(names) result(text)
    character(*), intent(in) :: names(:)
    character(:), allocatable :: text
    integer :: i, first
    text = ''
    if (size(names) == 1) return
    text = ' NumberOfComponents="'//integer_text(size(names))//'"'
    do i = 1, size(names)
      first = merge(2, 1, names(i)(1:1) == '_')
      text = text//' ComponentName'//integer_text(i - 1)//'="'//escaped(trim(names(i)(first:)))//'"'
    end do
  end function component_attributes

  !> The byte order of this machine, in VTK's words.
  pure function byte_order() result(name)
    character(:), allocatable :: name
    integer(c_int8_t) :: bytes(4)
    bytes = transfer(1_i4, bytes)
    if (bytes(1) == 1) then
      name = 'LittleEndian'
    else
      name = 'BigEndian'
    end if
  end function byte_order

  !> Text for an XML attribute.
  pure function escaped(text) result(clean)
    character(*), intent(in) :: text
    character(:), allocatable :: clean
    integer :: i
    clean = ''
    do i = 1, len(text)
      select case (text(i:i))
      case ('&')
        clean = clean//'&amp;'
      case ('<')
        clean = clean//'&lt;'
      case ('"')
        clean = clean//'&quot;'
      case default
        clean = clean//text(i:i)
      end select
    end do
  end function escaped

  !> Entries of a collection written by `series_dump`, up to `time`; files of later ones go.
  subroutine read_entries(folder, path, time, entries, error)
    character(*), intent(in) :: folder, path
    real(dp), intent(in) :: time
    type(entry_t), allocatable, intent(inout) :: entries(:)
    type(error_t), allocatable, intent(out) :: error
    type(line_t), allocatable :: lines(:)
    type(entry_t) :: entry
    type(error_t), allocatable :: problem        ! a file that stays harms nobody
    character(:), allocatable :: stamp
    integer :: i, status
    call file_lines(path, lines, error)
    if (allocated(error)) return
    do i = 1, size(lines)
      if (index(lines(i)%text, '<DataSet') == 0) cycle
      stamp = attribute(lines(i)%text, 'timestep')
      read (stamp, *, iostat=status) entry%time
      if (status /= 0) cycle
      entry%file = attribute(lines(i)%text, 'file')
      if (entry%time > time) then
        call file_remove(folder//'/'//entry%file, problem)
      else
        call set_entry(entries, entry)
      end if
    end do
  end subroutine read_entries

  !> Appends an entry, unless its file is the last one's, written again.
  subroutine set_entry(entries, entry)
    type(entry_t), allocatable, intent(inout) :: entries(:)
    type(entry_t), intent(in) :: entry
    integer :: n
    n = size(entries)
    if (n > 0) then
      if (entries(n)%file == entry%file) n = n - 1
    end if
    entries = [entries(:n), entry]
  end subroutine set_entry

  pure function attribute(line, name) result(value)
    character(*), intent(in) :: line, name
    character(:), allocatable :: value
    integer :: first, last
    value = ''
    first = index(line, ' '//name//'="')
    if (first == 0) return
    first = first + len(name) + 3
    last = index(line(first:), '"') + first - 2
    value = line(first:last)
  end function attribute

end module sgmp_vtu
