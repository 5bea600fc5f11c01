!> HDF5 files, written and read by one rank or by all of them; the only module that knows HDF5 (but
!! for what MPI adds, hdf5_shared.f90).
!!
!! Data sets are contiguous and unfiltered. Every rank puts or gets its own columns, independently
!! of the others; opening, declaring and closing are done by all together. Like `output_file_t` a
!! file keeps its first failure, skips what follows, and hands the failure out at `close`.
!!
!! A summed file ends with checksums of all its data sets, which `verify` compares; its own
!! structure is protected by HDF5's (format of HDF5 1.8 and later).
!!
!! Longer than other files because it is the one wall between HDF5 and the rest: structure, data and
!! checksums share the handles and helpers of this module, which two modules would have to open to
!! each other.
module sgmp_hdf5_file
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int8_t, c_loc, c_ptr
  use hdf5, only: h5_integer_kind, h5_real_kind, h5aclose_f, h5acreate_f, h5aexists_f, h5aopen_f, &
                  h5aread_f, h5awrite_f, h5d_alloc_time_early_f, h5d_fill_time_never_f, &
                  h5dclose_f, h5dcreate_f, h5dget_space_f, h5dget_type_f, h5dont_atexit_f, &
                  h5dopen_f, h5dread_f, h5dset_extent_f, h5dwrite_f, h5eset_auto_f, &
                  h5f_acc_rdonly_f, h5f_acc_rdwr_f, h5f_acc_trunc_f, h5f_libver_latest_f, &
                  h5f_scope_global_f, h5fclose_f, h5fcreate_f, h5fflush_f, h5fopen_f, h5gclose_f, &
                  h5gcreate_f, h5kind_to_type, h5lexists_f, h5oclose_f, h5oopen_f, h5open_f, &
                  h5p_dataset_create_f, h5p_file_access_f, h5p_file_create_f, h5p_group_create_f, &
                  h5pclose_f, h5pcreate_f, h5pset_alloc_time_f, h5pset_chunk_f, &
                  h5pset_fill_time_f, h5pset_libver_bounds_f, h5pset_obj_track_times_f, &
                  h5s_scalar_f, h5s_select_set_f, h5sclose_f, h5screate_f, &
                  h5screate_simple_f, h5sget_simple_extent_dims_f, &
                  h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, h5t_float_f, &
                  h5t_fortran_s1, h5t_ieee_f64le, h5t_std_i32le, h5t_std_i64le, h5t_std_u8le, &
                  h5t_str_nullpad_f, h5t_string_f, h5tclose_f, h5tcopy_f, h5tget_class_f, &
                  h5tget_size_f, h5tset_size_f, h5tset_strpad_f, hid_t, hsize_t, size_t
  use sgmp_checksum, only: checksum_sums, checksum_words
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: io_error, newline, system_message
  use sgmp_hdf5_shared, only: hdf5_share
  use sgmp_kinds, only: dp, i4, i8
  use sgmp_parallel, only: parallel_any, parallel_rank, parallel_ranks, parallel_sum
  use sgmp_spelling, only: string_t
  implicit none
  private
  public :: hdf5_file_t
  public :: hdf5_byte, hdf5_integer, hdf5_long, hdf5_real

  integer, parameter :: hdf5_byte = 1     !! unsigned, 8 bits
  integer, parameter :: hdf5_integer = 2  !! 32 bits
  integer, parameter :: hdf5_long = 3     !! 64 bits
  integer, parameter :: hdf5_real = 4     !! 64 bits
  integer, parameter :: block_words = 2**17  !! words verified at a time

  logical :: library_open = .false.

  !> One file.
  type :: hdf5_file_t
    private
    integer(hid_t) :: id = -1_hid_t
    character(:), allocatable :: path
    logical :: summed = .false.            !! with checksums
    type(error_t), allocatable :: failure  !! first failure
    type(string_t), allocatable :: names(:)     !! data sets declared
    integer(i8), allocatable :: sums(:, :)      !! (checksum_sums, data sets) of this rank's parts
  contains
    procedure :: create
    procedure :: open => open_file
    procedure :: close => close_file
    procedure :: flush => flush_file
    procedure :: good
    procedure :: add_group
    procedure :: set_text, set_whole, get_whole
    procedure :: refuse => fail
    procedure :: declare, declare_growing, set_total
    procedure :: extent
    procedure, private :: put_reals, put_longs, put_integers, put_bytes
    generic :: put => put_reals, put_longs, put_integers, put_bytes
    procedure, private :: get_reals, get_longs
    generic :: get => get_reals, get_longs
    procedure :: put_text
    procedure :: get_text
    procedure :: has
    procedure :: verify
  end type hdf5_file_t

contains

  !> Makes a new file; with `summed` it carries checksums, without it is of the oldest format, whose
  !! bytes depend on nothing but what is put into it.
  subroutine create(self, path, shared, summed)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: path
    logical, intent(in) :: shared          !! by all ranks; else this rank writes alone
    logical, intent(in) :: summed
    integer(hid_t) :: access, creation
    integer :: status
    call start(self, path, summed)
    access = access_list(shared, summed)
    creation = timeless(h5p_file_create_f)
    call h5fcreate_f(path, h5f_acc_trunc_f, self%id, status, creation, access)
    call h5pclose_f(creation, status)
    if (self%id < 0_hid_t) then
      self%id = -1_hid_t
      call fail(self, 'create')
    end if
    call h5pclose_f(access, status)
    if (shared) call give_up_together(self, 'create')
    if (summed) call self%add_group('/checked')
  end subroutine create

  !> Opens a file that exists.
  subroutine open_file(self, path, shared, writable)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: path
    logical, intent(in) :: shared          !! by all ranks
    logical, intent(in) :: writable
    integer(hid_t) :: access
    integer :: status, mode
    call start(self, path, .false.)
    access = access_list(shared, .false.)
    mode = merge(h5f_acc_rdwr_f, h5f_acc_rdonly_f, writable)
    call h5fopen_f(path, mode, self%id, status, access_prp=access)
    if (status < 0) then
      self%id = -1_hid_t
      call fail(self, 'read', 'it is not there, cut short, or not an HDF5 file')
    end if
    call h5pclose_f(access, status)
    if (shared) call give_up_together(self, 'read')
  end subroutine open_file

  !> A file that some rank cannot open is open on none.
  subroutine give_up_together(self, action)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: action
    integer :: status
    if (.not. parallel_any(allocated(self%failure))) return
    call fail(self, action, 'another rank cannot')
    if (self%id >= 0_hid_t) call h5fclose_f(self%id, status)
    self%id = -1_hid_t
  end subroutine give_up_together

  subroutine start(self, path, summed)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: path
    logical, intent(in) :: summed
    integer :: status
    if (.not. library_open) then
      ! Files left open by a failure must not be tried again at the end.
      call h5dont_atexit_f(status)
      call h5open_f(status)  ! makes its types anew every time, and keeps them
      call h5eset_auto_f(0, status)
      library_open = .true.
    end if
    self%path = path
    self%summed = summed
    if (allocated(self%failure)) deallocate (self%failure)
    if (allocated(self%names)) deallocate (self%names, self%sums)
    allocate (self%names(0), self%sums(checksum_sums, 0))
  end subroutine start

  function access_list(shared, latest) result(list)
    logical, intent(in) :: shared, latest
    integer(hid_t) :: list
    integer :: status
    call h5pcreate_f(h5p_file_access_f, list, status)
    if (latest) call h5pset_libver_bounds_f(list, h5f_libver_latest_f, h5f_libver_latest_f, status)
    if (shared .and. parallel_ranks() > 1) call hdf5_share(list)
  end function access_list

  !> Properties of a new object that does not tell when it was made: equal contents, equal bytes.
  function timeless(class) result(creation)
    integer(hid_t), intent(in) :: class
    integer(hid_t) :: creation
    integer :: status
    call h5pcreate_f(class, creation, status)
    call h5pset_obj_track_times_f(creation, .false., status)
  end function timeless

  !> Notes a failure; the reason defaults to the system's.
  subroutine fail(self, action, reason)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: action
    character(*), intent(in), optional :: reason
    if (allocated(self%failure)) return
    if (present(reason)) then
      call io_error(self%failure, action, self%path, reason)
    else
      call io_error(self%failure, action, self%path, system_message())
    end if
  end subroutine fail

  !> Whether nothing has failed so far on this rank.
  pure function good(self) result(yes)
    class(hdf5_file_t), intent(in) :: self
    logical :: yes
    yes = .not. allocated(self%failure)
  end function good

  !> Hands everything to the operating system.
  subroutine flush_file(self)
    class(hdf5_file_t), intent(inout) :: self
    integer :: status
    if (allocated(self%failure)) return
    call h5fflush_f(self%id, h5f_scope_global_f, status)
    if (status < 0) call fail(self, 'write')
  end subroutine flush_file

  !> Ends the file and reports its first failure on this rank.
  subroutine close_file(self, error)
    class(hdf5_file_t), intent(inout) :: self
    type(error_t), allocatable, intent(out) :: error
    integer :: status
    if (self%id >= 0_hid_t) then
      if (self%summed) call put_checksums(self)
      call self%flush()
      call h5fclose_f(self%id, status)
      if (status < 0) call fail(self, 'close')
      self%id = -1_hid_t
    end if
    call move_alloc(self%failure, error)
  end subroutine close_file

  ! ------------------------------------------------------------------ structure

  !> Adds a group.
  subroutine add_group(self, name)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(hid_t) :: group, creation
    integer :: status
    if (self%id < 0_hid_t) return
    creation = timeless(h5p_group_create_f)
    call h5gcreate_f(self%id, name, group, status, gcpl_id=creation)
    if (status < 0) then
      call fail(self, 'write')
    else
      call h5gclose_f(group, status)
    end if
    call h5pclose_f(creation, status)
  end subroutine add_group

  !> Gives an object an attribute: text without a final blank or zero.
  subroutine set_text(self, object, name, text)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: object, name
    character(*), intent(in), target :: text
    integer(hid_t) :: owner, kind, space, attribute
    integer :: status
    if (self%id < 0_hid_t) return
    call h5oopen_f(self%id, object, owner, status)
    kind = text_kind(len(text))
    call h5screate_f(h5s_scalar_f, space, status)
    call h5acreate_f(owner, name, kind, space, attribute, status)
    call h5awrite_f(attribute, kind, c_loc(text), status)
    if (status < 0) call fail(self, 'write')
    call h5aclose_f(attribute, status)
    call h5sclose_f(space, status)
    call h5tclose_f(kind, status)
    call h5oclose_f(owner, status)
  end subroutine set_text

  !> Gives an object an attribute of whole numbers, or changes it in place.
  subroutine set_whole(self, object, name, values, scalar)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: object, name
    integer(i8), intent(in), target, contiguous :: values(:)
    logical, intent(in) :: scalar          !! a single number, not an array of one
    integer(hid_t) :: owner, space, attribute
    integer(hsize_t) :: extents(1)
    integer :: status
    logical :: there
    if (self%id < 0_hid_t) return
    call h5oopen_f(self%id, object, owner, status)
    call h5aexists_f(owner, name, there, status)
    if (there) then
      call h5aopen_f(owner, name, attribute, status)
    else
      extents = size(values, kind=hsize_t)
      if (scalar) then
        call h5screate_f(h5s_scalar_f, space, status)
      else
        call h5screate_simple_f(1, extents, space, status)
      end if
      call h5acreate_f(owner, name, h5t_std_i64le, space, attribute, status)
      call h5sclose_f(space, status)
    end if
    call h5awrite_f(attribute, memory_kind(hdf5_long), c_loc(values), status)
    if (status < 0) call fail(self, 'write')
    call h5aclose_f(attribute, status)
    call h5oclose_f(owner, status)
  end subroutine set_whole

  !> A whole number that an object has as an attribute.
  subroutine get_whole(self, object, name, value)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: object, name
    integer, intent(out) :: value
    integer(i8), target :: long(1)
    integer(hid_t) :: owner, attribute
    type(c_ptr) :: buffer
    integer :: status, closing
    value = 0
    if (allocated(self%failure)) return
    call h5oopen_f(self%id, object, owner, status)
    if (status >= 0) then
      call h5aopen_f(owner, name, attribute, status)
      if (status < 0) call h5oclose_f(owner, closing)
    end if
    if (status < 0) then
      call fail(self, 'read', "it has no attribute '"//name//"'")
      return
    end if
    buffer = c_loc(long)
    call h5aread_f(attribute, memory_kind(hdf5_long), buffer, status)
    value = int(long(1))
    call h5aclose_f(attribute, status)
    call h5oclose_f(owner, status)
  end subroutine get_whole

  !> Declares a data set of `total` columns with `rows` values each (0: a plain list); `early` puts
  !! it into the file at once, where it stays.
  subroutine declare(self, name, kind, total, rows, early)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind            !! one of hdf5_*
    integer(i8), intent(in) :: total       !! of all ranks
    integer, intent(in) :: rows
    logical, intent(in), optional :: early
    integer(hid_t) :: space
    integer(hsize_t) :: extents(2)
    integer :: status
    if (self%id < 0_hid_t) return
    extents = [int(rows, hsize_t), int(total, hsize_t)]
    if (rows == 0) extents(1) = extents(2)
    call h5screate_simple_f(merge(1, 2, rows == 0), extents, space, status)
    call make_dataset(self, name, file_kind(kind), space, early)
    call h5sclose_f(space, status)
  end subroutine declare

  !> Declares a plain list of one number that may grow to `most`, for which there is room at once.
  subroutine declare_growing(self, name, kind, most)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind            !! one of hdf5_*
    integer(i8), intent(in) :: most
    integer(hid_t) :: space
    integer(hsize_t) :: extents(1), limits(1)
    integer :: status
    if (self%id < 0_hid_t) return
    extents = 1
    limits = most
    call h5screate_simple_f(1, extents, space, status, limits)
    call make_dataset(self, name, file_kind(kind), space, .true., most)
    call h5sclose_f(space, status)
  end subroutine declare_growing

  !> Changes the length of such a list; all that have the file open must do so.
  subroutine set_total(self, name, total)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(i8), intent(in) :: total
    integer(hid_t) :: dataset
    integer(hsize_t) :: extents(1)
    integer :: status
    if (allocated(self%failure)) return
    call h5dopen_f(self%id, name, dataset, status)
    if (status >= 0) then
      extents = total
      call h5dset_extent_f(dataset, extents, status)
      if (status < 0) call fail(self, 'write')
      call h5dclose_f(dataset, status)
    else
      call fail(self, 'access', "it has no data set '"//name//"'")
    end if
  end subroutine set_total

  subroutine make_dataset(self, name, kind, space, early, chunk)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(hid_t), intent(in) :: kind, space
    logical, intent(in), optional :: early
    integer(i8), intent(in), optional :: chunk  !! numbers that are stored together
    integer(hid_t) :: creation, dataset
    integer :: status
    creation = timeless(h5p_dataset_create_f)
    call h5pset_fill_time_f(creation, h5d_fill_time_never_f, status)
    if (present(early)) then
      if (early) call h5pset_alloc_time_f(creation, h5d_alloc_time_early_f, status)
    end if
    if (present(chunk)) call h5pset_chunk_f(creation, 1, [int(chunk, hsize_t)], status)
    call h5dcreate_f(self%id, name, kind, space, dataset, status, dcpl_id=creation)
    if (status < 0) then
      call fail(self, 'write')
    else
      call h5dclose_f(dataset, status)
    end if
    call h5pclose_f(creation, status)
    if (self%summed) call add_name(self, name)
  end subroutine make_dataset

  subroutine add_name(self, name)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    type(string_t) :: new
    integer :: i
    new%text = name
    self%names = [self%names, new]
    self%sums = reshape([self%sums, (0_i8, i=1, checksum_sums)], [checksum_sums, size(self%names)])
  end subroutine add_name

  !> Whether the file has an object of this name.
  function has(self, name) result(there)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    logical :: there
    integer :: status
    there = .false.
    if (self%id < 0_hid_t) return
    call h5lexists_f(self%id, name, there, status)
    if (status < 0) there = .false.
  end function has

  !> Rows (1 for a plain list) and columns of a data set; -1 where there is none.
  subroutine extent(self, name, rows, total)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(out) :: rows
    integer(i8), intent(out) :: total
    integer(hid_t) :: dataset, space
    integer(hsize_t) :: extents(2), most(2)
    integer :: status, rank
    rows = -1
    total = -1_i8
    if (allocated(self%failure)) return
    call h5dopen_f(self%id, name, dataset, status)
    if (status < 0) then
      call fail(self, 'read', "it has no data set '"//name//"'")
      return
    end if
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (rank == 1 .or. rank == 2) then
      call h5sget_simple_extent_dims_f(space, extents(:rank), most(:rank), status)
      rows = 1
      if (rank == 2) rows = int(extents(1))
      total = int(extents(rank), i8)
    else
      call fail(self, 'read', "data set '"//name//"' is not a table")
    end if
    call h5sclose_f(space, status)
    call h5dclose_f(dataset, status)
  end subroutine extent

  function file_kind(kind) result(id)
    integer, intent(in) :: kind
    integer(hid_t) :: id
    select case (kind)
    case (hdf5_byte)
      id = h5t_std_u8le
    case (hdf5_integer)
      id = h5t_std_i32le
    case (hdf5_long)
      id = h5t_std_i64le
    case default  ! hdf5_real
      id = h5t_ieee_f64le
    end select
  end function file_kind

  function memory_kind(kind) result(id)
    integer, intent(in) :: kind
    integer(hid_t) :: id
    select case (kind)
    case (hdf5_byte)
      id = h5t_std_u8le
    case (hdf5_integer)
      id = h5kind_to_type(i4, h5_integer_kind)
    case (hdf5_long)
      id = h5kind_to_type(i8, h5_integer_kind)
    case default  ! hdf5_real
      id = h5kind_to_type(dp, h5_real_kind)
    end select
  end function memory_kind

  !> Text of a fixed length, without padding.
  function text_kind(length) result(id)
    integer, intent(in) :: length
    integer(hid_t) :: id
    integer :: status
    call h5tcopy_f(h5t_fortran_s1, id, status)
    call h5tset_size_f(id, int(max(1, length), size_t), status)
    call h5tset_strpad_f(id, h5t_str_nullpad_f, status)
  end function text_kind

  ! ----------------------------------------------------------------------- data

  !> Puts columns behind the first `before` ones of a data set.
  subroutine put_reals(self, name, values, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    real(dp), intent(in), target, contiguous :: values(:, :)
    integer(i8), intent(in) :: before
    integer(i8), pointer, contiguous :: words(:)
    integer :: n(1)
    if (size(values) == 0) return
    call put_columns(self, name, hdf5_real, c_loc(values), size(values, 1), &
                     size(values, 2, kind=i8), before)
    if (.not. self%summed) return
    n(1) = size(values)
    call c_f_pointer(c_loc(values), words, n)
    call add_sums(self, name, words, before*size(values, 1))
  end subroutine put_reals

  subroutine put_longs(self, name, values, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(i8), intent(in), target, contiguous :: values(:, :)
    integer(i8), intent(in) :: before
    integer(i8), pointer, contiguous :: words(:)
    integer :: n(1)
    if (size(values) == 0) return
    call put_columns(self, name, hdf5_long, c_loc(values), size(values, 1), &
                     size(values, 2, kind=i8), before)
    if (.not. self%summed) return
    n(1) = size(values)
    call c_f_pointer(c_loc(values), words, n)
    call add_sums(self, name, words, before*size(values, 1))
  end subroutine put_longs

  !> 32-bit numbers, a plain list; not for summed files.
  subroutine put_integers(self, name, values, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(i4), intent(in), target, contiguous :: values(:)
    integer(i8), intent(in) :: before
    if (size(values) == 0) return
    call put_columns(self, name, hdf5_integer, c_loc(values), 1, size(values, kind=i8), before)
  end subroutine put_integers

  !> Bytes, a plain list; not for summed files.
  subroutine put_bytes(self, name, values, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(c_int8_t), intent(in), target, contiguous :: values(:)
    integer(i8), intent(in) :: before
    if (size(values) == 0) return
    call put_columns(self, name, hdf5_byte, c_loc(values), 1, size(values, kind=i8), before)
  end subroutine put_bytes

  subroutine get_reals(self, name, values, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    real(dp), intent(out), target, contiguous :: values(:, :)
    integer(i8), intent(in) :: before
    if (size(values) > 0) call get_columns(self, name, hdf5_real, c_loc(values), size(values, 1), &
                                           size(values, 2, kind=i8), before)
  end subroutine get_reals

  subroutine get_longs(self, name, values, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(i8), intent(out), target, contiguous :: values(:, :)
    integer(i8), intent(in) :: before
    if (size(values) > 0) call get_columns(self, name, hdf5_long, c_loc(values), size(values, 1), &
                                           size(values, 2, kind=i8), before)
  end subroutine get_longs

  subroutine put_columns(self, name, kind, address, rows, columns, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind, rows
    type(c_ptr), intent(in) :: address
    integer(i8), intent(in) :: columns, before
    integer(hid_t) :: dataset, memory, space
    integer :: status
    if (allocated(self%failure)) return
    call select_columns(self, name, rows, columns, before, dataset, memory, space)
    if (allocated(self%failure)) return
    call h5dwrite_f(dataset, memory_kind(kind), address, status, memory, space)
    if (status < 0) call fail(self, 'write')
    call release(dataset, memory, space)
  end subroutine put_columns

  subroutine get_columns(self, name, kind, address, rows, columns, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind, rows
    type(c_ptr), intent(in) :: address
    integer(i8), intent(in) :: columns, before
    integer(hid_t) :: dataset, memory, space
    type(c_ptr) :: buffer
    integer :: status
    if (allocated(self%failure)) return
    call select_columns(self, name, rows, columns, before, dataset, memory, space)
    if (allocated(self%failure)) return
    buffer = address
    call h5dread_f(dataset, memory_kind(kind), buffer, status, memory, space)
    if (status < 0) call fail(self, 'read', "data set '"//name//"' is damaged")
    call release(dataset, memory, space)
  end subroutine get_columns

  !> Opens a data set and selects some of its columns.
  subroutine select_columns(self, name, rows, columns, before, dataset, memory, space)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: rows
    integer(i8), intent(in) :: columns, before
    integer(hid_t), intent(out) :: dataset, memory, space
    integer(hsize_t) :: first(2), extents(2)
    integer :: status, rank
    call h5dopen_f(self%id, name, dataset, status)
    if (status < 0) then
      call fail(self, 'access', "it has no data set '"//name//"'")
      return
    end if
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    first = [0_hsize_t, int(before, hsize_t)]
    extents = [int(rows, hsize_t), int(columns, hsize_t)]
    if (rank == 1) then
      first(1) = first(2)
      extents(1) = extents(2)
    end if
    call h5sselect_hyperslab_f(space, h5s_select_set_f, first(:rank), extents(:rank), status)
    call h5screate_simple_f(rank, extents(:rank), memory, status)
  end subroutine select_columns

  subroutine release(dataset, memory, space)
    integer(hid_t), intent(in) :: dataset, memory, space
    integer :: status
    call h5sclose_f(memory, status)
    call h5sclose_f(space, status)
    call h5dclose_f(dataset, status)
  end subroutine release

  !> Declares and writes a text, on the first rank.
  subroutine put_text(self, name, text)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    character(*), intent(in), target :: text
    integer(hid_t) :: kind, space, dataset
    integer :: status, i
    if (self%id < 0_hid_t) return
    kind = text_kind(len(text))
    call h5screate_f(h5s_scalar_f, space, status)
    call make_dataset(self, name, kind, space)
    if (parallel_rank() == 0 .and. len(text) > 0 .and. self%good()) then
      call h5dopen_f(self%id, name, dataset, status)
      call h5dwrite_f(dataset, kind, c_loc(text), status)
      if (status < 0) call fail(self, 'write')
      call h5dclose_f(dataset, status)
      if (self%summed) call add_sums(self, name, [(iachar(text(i:i), i8), i=1, len(text))], 0_i8)
    end if
    call h5sclose_f(space, status)
    call h5tclose_f(kind, status)
  end subroutine put_text

  !> A text; '' where there is none.
  subroutine get_text(self, name, text)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    character(:), allocatable, target, intent(out) :: text
    integer(hid_t) :: kind, dataset
    integer(size_t) :: length
    type(c_ptr) :: buffer
    integer :: status
    text = ''
    if (allocated(self%failure)) return
    call h5dopen_f(self%id, name, dataset, status)
    if (status < 0) then
      call fail(self, 'read', "it has no text '"//name//"'")
      return
    end if
    call h5dget_type_f(dataset, kind, status)
    call h5tget_size_f(kind, length, status)
    deallocate (text)
    allocate (character(int(length)) :: text)
    buffer = c_loc(text)
    call h5dread_f(dataset, kind, buffer, status)
    if (status < 0) call fail(self, 'read', "text '"//name//"' is damaged")
    call h5tclose_f(kind, status)
    call h5dclose_f(dataset, status)
  end subroutine get_text

  ! ------------------------------------------------------------------ checksums

  subroutine add_sums(self, name, words, before)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(i8), intent(in), contiguous :: words(:)
    integer(i8), intent(in) :: before
    integer :: n
    do n = size(self%names), 1, -1
      if (self%names(n)%text == name) exit
    end do
    if (n > 0) call checksum_words(words, before, self%sums(:, n))
  end subroutine add_sums

  !> Ends a summed file with the names and sums of its data sets.
  subroutine put_checksums(self)
    class(hdf5_file_t), intent(inout) :: self
    character(:), allocatable :: list
    integer(i8), allocatable :: total(:, :)
    integer :: n
    list = ''
    do n = 1, size(self%names)
      list = list//self%names(n)%text//newline
    end do
    total = self%sums
    self%summed = .false.
    if (size(total) > 0) total = reshape(parallel_sum(reshape(total, [size(total)])), shape(total))
    call self%put_text('/checked/names', list)
    call self%declare('/checked/sums', hdf5_long, size(total, 2, kind=i8), checksum_sums)
    if (parallel_rank() == 0) call self%put('/checked/sums', total, 0_i8)
  end subroutine put_checksums

  !> Reads all that a summed file holds and compares its checksums; ranks share the work. All ranks
  !! get the same answer.
  subroutine verify(self)
    class(hdf5_file_t), intent(inout) :: self
    character(:), allocatable :: list, name
    integer(i8), allocatable :: kept(:, :), found(:, :)
    integer(i8) :: total
    integer :: rows, n, last
    call self%get_text('/checked/names', list)
    call self%extent('/checked/sums', rows, total)
    if (rows /= checksum_sums) then
      call fail(self, 'read', 'it carries no checksums')
      return
    end if
    allocate (kept(checksum_sums, total), found(checksum_sums, total), source=0_i8)
    call self%get('/checked/sums', kept, 0_i8)
    do n = 1, int(total)
      last = index(list, newline) - 1
      if (last < 1) exit
      name = list(:last)
      list = list(last + 2:)
      call sum_dataset(self, name, found(:, n))
    end do
    if (total > 0) found = reshape(parallel_sum(reshape(found, [size(found)])), shape(found))
    if (n <= total .or. len(list) > 0 .or. any(found /= kept)) then
      call fail(self, 'read', 'its checksums do not fit its contents')
    end if
    if (parallel_any(allocated(self%failure))) call fail(self, 'read', 'it is damaged')
  end subroutine verify

  !> Sums of this rank's share of a data set.
  subroutine sum_dataset(self, name, sums)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(i8), intent(inout) :: sums(checksum_sums)
    integer(hid_t) :: dataset, kind
    integer :: status, class
    if (allocated(self%failure)) return
    call h5dopen_f(self%id, name, dataset, status)
    if (status < 0) then
      call fail(self, 'read', "it has no data set '"//name//"'")
      return
    end if
    call h5dget_type_f(dataset, kind, status)
    call h5tget_class_f(kind, class, status)
    call h5tclose_f(kind, status)
    call h5dclose_f(dataset, status)
    if (class == h5t_string_f) then
      call sum_text(self, name, sums)
    else if (class == h5t_float_f) then
      call sum_columns(self, name, hdf5_real, sums)
    else
      call sum_columns(self, name, hdf5_long, sums)
    end if
  end subroutine sum_dataset

  subroutine sum_text(self, name, sums)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer(i8), intent(inout) :: sums(checksum_sums)
    character(:), allocatable :: text
    integer :: i
    if (parallel_rank() > 0) return
    call self%get_text(name, text)
    call checksum_words([(iachar(text(i:i), i8), i=1, len(text))], 0_i8, sums)
  end subroutine sum_text

  subroutine sum_columns(self, name, kind, sums)
    class(hdf5_file_t), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: kind
    integer(i8), intent(inout) :: sums(checksum_sums)
    integer(i8), allocatable, target :: words(:)
    integer(i8) :: total, first, last, step
    integer :: rows
    call self%extent(name, rows, total)
    if (rows < 1) return
    step = max(1, block_words/rows)
    first = total*parallel_rank()/parallel_ranks()
    last = total*(parallel_rank() + 1)/parallel_ranks()
    allocate (words(rows*min(step, max(last - first, 0_i8))))
    do while (first < last)
      step = min(step, last - first)
      call get_columns(self, name, kind, c_loc(words), rows, step, first)
      if (allocated(self%failure)) return
      call checksum_words(words(:rows*step), first*rows, sums)
      first = first + step
    end do
  end subroutine sum_columns

end module sgmp_hdf5_file
