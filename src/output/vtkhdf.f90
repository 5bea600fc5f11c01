!> All dumps of a run in one file for ParaView: particles.vtkhdf, temporal VTKHDF 2.0.
!!
!! An unstructured grid of vertices, one part per step, ordered by particle id, so that the file
!! does not depend on the ranks that wrote it. Every step has a place of fixed size, laid out when
!! the file is made; a dump fills the next place and only then counts it (NSteps). So a dump that
!! fails or is killed harms none of the earlier ones, a restart cuts back by counting fewer, and the
!! bytes of the file depend on nothing but the dumps in it. When there is no place left the file is
!! replaced by a larger one, at the end of the run by one without empty places.
!!
!! Connectivity and offsets are the same in every step and stored once, offsets once more for every
!! change of the number of particles (VTK reads them at CellOffsets + PartOffsets).
module sgmp_vtkhdf
  use, intrinsic :: iso_c_binding, only: c_int8_t
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: file_exists, file_remove, file_rename, io_error
  use sgmp_hdf5_file, only: hdf5_byte, hdf5_file_t, hdf5_integer, hdf5_long, hdf5_real
  use sgmp_kinds, only: dp, i8
  use sgmp_parallel, only: parallel_agree, parallel_rank
  use sgmp_posix, only: file_sync
  use sgmp_snapshot, only: snapshot_t
  use sgmp_vtk_fields, only: vtk_components, vtk_field_values
  implicit none
  private
  public :: vtkhdf_t

  integer, parameter :: block_columns = 65536    !! particles copied or numbered at a time
  integer(i8), parameter :: vertex = 1_i8        !! VTK's number of the cell
  character(*), parameter :: root = '/VTKHDF', steps = root//'/Steps', &
                             data = root//'/PointData'

  !> One array of the particles.
  type :: array_t
    character(:), allocatable :: name            !! below the root
    integer :: kind = hdf5_real
    integer :: rows = 0                          !! components; 0: a plain list
  end type array_t

  !> The file between two dumps, during which it is closed.
  type :: vtkhdf_t
    private
    character(:), allocatable :: path
    integer :: capacity = 0                      !! places for steps
    integer :: parts_capacity = 0                !! places for numbers of particles
    integer :: used = 0, parts = 0               !! of these in use
    integer(i8) :: points = 0_i8                 !! particles that a place holds
    integer(i8) :: last_count = -1_i8            !! particles of the last step
    logical :: made = .false.                    !! the file is there
    type(array_t), allocatable :: arrays(:)
  contains
    procedure :: open => vtkhdf_open
    procedure :: dump => vtkhdf_dump
    procedure :: has_room
    procedure :: trim => vtkhdf_trim
  end type vtkhdf_t

contains

  !> Names the file, which the first dump makes; with `keep_to_time` the steps of an existing one up
  !! to that time stay. All ranks together, like the other procedures.
  subroutine vtkhdf_open(self, path, expected, error, keep_to_time)
    class(vtkhdf_t), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in) :: expected              !! dumps, as far as is known
    type(error_t), allocatable, intent(out) :: error
    real(dp), intent(in), optional :: keep_to_time
    type(error_t), allocatable :: problem
    self%path = path
    self%capacity = max(1, expected)
    self%parts_capacity = 1
    self%used = 0
    self%parts = 0
    self%made = .false.
    if (.not. present(keep_to_time)) return
    ! Half of a larger file, of a run that was killed while it made room.
    if (parallel_rank() == 0 .and. file_exists(path//'.part')) then
      call file_remove(path//'.part', problem)
    end if
    if (file_exists(path)) call continue_file(self, keep_to_time, error)
  end subroutine vtkhdf_open

  !> Takes the places of an existing file and counts the steps up to a time.
  subroutine continue_file(self, time, error)
    class(vtkhdf_t), intent(inout) :: self
    real(dp), intent(in) :: time
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    real(dp), allocatable :: times(:, :)
    integer(i8), allocatable :: part(:, :), counts(:, :)
    integer(i8) :: n, counted
    integer :: rows, whole
    call file%open(self%path, shared=.true., writable=.true.)
    call file%extent(steps//'/PartOffsets', rows, n)
    self%capacity = int(max(n, 0_i8))
    call file%extent(steps//'/Values', rows, counted)
    call file%extent(root//'/NumberOfPoints', rows, n)
    self%parts_capacity = int(max(n, 0_i8))
    call file%extent(root//'/Connectivity', rows, self%points)
    call file%get_whole(steps, 'NSteps', whole)
    whole = int(max(0_i8, min(int(whole, i8), counted, int(self%capacity, i8))))
    allocate (times(1, whole), part(1, self%capacity), counts(1, self%parts_capacity))
    call file%get(steps//'/Values', times, 0_i8)
    call file%get(steps//'/PartOffsets', part, 0_i8)
    call file%get(root//'/NumberOfPoints', counts, 0_i8)
    if (file%good()) then
      do while (self%used < whole)
        if (times(1, self%used + 1) > time) exit
        self%used = self%used + 1
      end do
      if (self%used > 0) self%parts = int(part(1, self%used)) + 1
      if (self%parts > 0) self%last_count = counts(1, self%parts)
      self%made = .true.
    end if
    ! No rank may cut the file while another still reads it.
    call parallel_agree(error)
    call file%set_whole(steps, 'NSteps', [int(self%used, i8)], .true.)
    call file%set_total(steps//'/Values', int(max(1, self%used), i8))
    call file%close(error)
    call parallel_agree(error)
  end subroutine continue_file

  !> Adds a step: this rank's share of the particles, a range of ids behind `before` others.
  subroutine vtkhdf_dump(self, snapshot, before, total, error)
    class(vtkhdf_t), intent(inout) :: self
    type(snapshot_t), intent(in) :: snapshot
    integer(i8), intent(in) :: before, total     !! particles of lower ids on other ranks; of all
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    integer(i8) :: points
    logical :: new_part
    call list_arrays(self, snapshot)
    if (.not. self%made) then
      self%points = total
      call make_file(self, self%path, error)
      if (allocated(error)) return
      self%made = .true.
    end if
    new_part = total /= self%last_count
    if (new_part) self%parts = self%parts + 1
    points = self%points
    do while (points < total)  ! particles have been split
      points = 2*max(1_i8, points)
    end do
    if (self%used == self%capacity .or. self%parts > self%parts_capacity .or. &
        points > self%points) then
      call resize(self, merge(2*self%capacity, self%capacity, self%used == self%capacity), &
                  merge(2*self%parts_capacity, self%parts_capacity, &
                        self%parts > self%parts_capacity), points, error)
      if (allocated(error)) return
    end if
    self%last_count = total
    call file%open(self%path, shared=.true., writable=.true.)
    call check_arrays(self, file)
    call put_particles(self, file, snapshot, self%used*self%points + before)
    if (parallel_rank() == 0) then
      call put_places(self, file, total)
      if (new_part) call put_vertices(self, file, total)
    end if
    call file%close(error)
    call parallel_agree(error)
    if (.not. allocated(error)) call count_step(self, snapshot%time, error)
  end subroutine vtkhdf_dump

  !> Counts a step, behind everything else: VTK wants as many times as there are steps.
  subroutine count_step(self, time, error)
    class(vtkhdf_t), intent(inout) :: self
    real(dp), intent(in) :: time
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    if (parallel_rank() == 0) then
      call file%open(self%path, shared=.false., writable=.true.)
      call file%set_total(steps//'/Values', self%used + 1_i8)
      call file%put(steps//'/Values', reshape([time], [1, 1]), int(self%used, i8))
      call file%set_whole(steps, 'NSteps', [self%used + 1_i8], .true.)
      call file%close(error)
    end if
    call parallel_agree(error)
    if (.not. allocated(error)) self%used = self%used + 1
  end subroutine count_step

  !> The arrays of a snapshot and what they are in the file.
  subroutine list_arrays(self, snapshot)
    class(vtkhdf_t), intent(inout) :: self
    type(snapshot_t), intent(in) :: snapshot
    integer :: f, n
    if (allocated(self%arrays)) return
    n = merge(5, 4, allocated(snapshot%initial_position))
    allocate (self%arrays(n + size(snapshot%fields)))
    self%arrays(1) = array_t(root//'/Points', hdf5_real, 3)
    self%arrays(2) = array_t(data//'/id', hdf5_integer, 0)
    self%arrays(3) = array_t(data//'/body', hdf5_integer, 0)
    self%arrays(4) = array_t(data//'/velocity', hdf5_real, 3)
    if (n == 5) self%arrays(5) = array_t(data//'/initial_position', hdf5_real, 3)
    do f = 1, size(snapshot%fields)
      associate (components => vtk_components(snapshot%fields(f)))
        self%arrays(n + f) = array_t(data//'/'//trim(snapshot%fields(f)%name), hdf5_real, &
                                     merge(0, components, components == 1))
      end associate
    end do
  end subroutine list_arrays

  !> An existing file must have the arrays of this run.
  subroutine check_arrays(self, file)
    class(vtkhdf_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file
    integer :: n, rows
    integer(i8) :: total
    do n = 1, size(self%arrays)
      call file%extent(self%arrays(n)%name, rows, total)
      if (rows /= max(1, self%arrays(n)%rows) .or. total /= self%capacity*self%points) then
        call file%refuse('continue', 'its fields are not those of this run; move it away, or '// &
                         'restart with the same output cards')
        return
      end if
    end do
  end subroutine check_arrays

  ! ------------------------------------------------------------ layout of the file

  !> Makes an empty file, on the first rank alone: so its layout is the same for any number.
  subroutine make_file(self, path, error)
    class(vtkhdf_t), intent(in) :: self
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t) :: file
    integer :: n
    if (parallel_rank() == 0) then
      call file%create(path, shared=.false., summed=.false.)
      call file%add_group(root)
      call file%set_whole(root, 'Version', [2_i8, 0_i8], .false.)
      call file%set_text(root, 'Type', 'UnstructuredGrid')
      call file%add_group(data)
      call file%add_group(steps)
      call file%set_whole(steps, 'NSteps', [0_i8], .true.)
      call declare_topology(self, file)
      call file%add_group(steps//'/PointDataOffsets')
      do n = 1, size(self%arrays)
        call file%declare(self%arrays(n)%name, self%arrays(n)%kind, self%capacity*self%points, &
                          self%arrays(n)%rows, early=.true.)
        if (n > 1) call file%declare(offsets_name(self%arrays(n)), hdf5_long, &
                                     int(self%capacity, i8), 0, early=.true.)
      end do
      call put_connectivity(self, file)
      call file%close(error)
    end if
    call parallel_agree(error)
  end subroutine make_file

  !> Where the offsets of an array stand.
  pure function offsets_name(array) result(name)
    type(array_t), intent(in) :: array
    character(:), allocatable :: name
    name = steps//'/PointDataOffsets'//array%name(len(data) + 1:)
  end function offsets_name

  subroutine declare_topology(self, file)
    class(vtkhdf_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file
    character(*), parameter :: per_part(*) = [character(32) :: 'NumberOfPoints', &
                                              'NumberOfCells', 'NumberOfConnectivityIds']
    character(*), parameter :: per_step(*) = [character(32) :: 'PartOffsets', 'NumberOfParts', &
                                              'PointOffsets', 'CellOffsets', &
                                              'ConnectivityIdOffsets']
    integer :: n
    do n = 1, size(per_part)
      call file%declare(root//'/'//trim(per_part(n)), hdf5_long, int(self%parts_capacity, i8), 0, &
                        early=.true.)
    end do
    call file%declare_growing(steps//'/Values', hdf5_real, int(self%capacity, i8))
    do n = 1, size(per_step)
      call file%declare(steps//'/'//trim(per_step(n)), hdf5_long, int(self%capacity, i8), 0, &
                        early=.true.)
    end do
    call file%declare(root//'/Connectivity', hdf5_long, self%points, 0, early=.true.)
    call file%declare(root//'/Offsets', hdf5_long, self%parts_capacity*(self%points + 1), 0, &
                      early=.true.)
    call file%declare(root//'/Types', hdf5_byte, self%parts_capacity*self%points, 0, early=.true.)
  end subroutine declare_topology

  !> Each vertex has the particle of its own number.
  subroutine put_connectivity(self, file)
    class(vtkhdf_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file
    integer(i8) :: first, p
    do first = 0, self%points - 1, block_columns
      call file%put(root//'/Connectivity', &
                    reshape([(p, p=first, min(first + block_columns, self%points) - 1)], &
                            [1, int(min(int(block_columns, i8), self%points - first))]), first)
    end do
  end subroutine put_connectivity

  !> Replaces the file by one with other numbers of places, all at once.
  subroutine resize(self, capacity, parts_capacity, points, error)
    class(vtkhdf_t), intent(inout) :: self
    integer, intent(in) :: capacity, parts_capacity
    integer(i8), intent(in) :: points            !! a multiple of those now
    type(error_t), allocatable, intent(out) :: error
    type(vtkhdf_t) :: larger
    type(error_t), allocatable :: problem
    character(:), allocatable :: part
    part = self%path//'.part'
    larger%path = part
    larger%capacity = capacity
    larger%parts_capacity = parts_capacity
    larger%points = points
    larger%arrays = self%arrays
    call make_file(larger, part, error)
    if (parallel_rank() == 0 .and. .not. allocated(error)) then
      call copy_steps(self, larger, min(self%parts, parts_capacity), error)
      if (.not. allocated(error)) then
        if (.not. file_sync(part)) call io_error(error, 'write', part)
      end if
      if (.not. allocated(error)) call file_rename(part, self%path, error)
    end if
    call parallel_agree(error)
    if (allocated(error)) then
      if (parallel_rank() == 0 .and. file_exists(part)) call file_remove(part, problem)
      return
    end if
    self%capacity = capacity
    self%parts_capacity = parts_capacity
    self%points = points
  end subroutine resize

  !> Copies the steps in use into a larger or smaller file.
  subroutine copy_steps(self, larger, parts, error)
    class(vtkhdf_t), intent(in) :: self, larger
    integer, intent(in) :: parts
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: lists(*) = [character(32) :: 'Steps/PointOffsets', &
      'Steps/CellOffsets', 'Steps/PartOffsets', 'Steps/NumberOfParts', &
      'Steps/ConnectivityIdOffsets', 'NumberOfPoints', 'NumberOfCells', 'NumberOfConnectivityIds']
    integer, parameter :: of_places = 2          !! the first ones count places of particles
    integer, parameter :: of_steps = 5           !! the first ones have a value per step
    type(hdf5_file_t) :: from, to
    integer(i8) :: growth
    integer :: n
    growth = larger%points/max(1_i8, self%points)
    call from%open(self%path, shared=.false., writable=.false.)
    call to%open(larger%path, shared=.false., writable=.true.)
    do n = 1, size(self%arrays)
      call copy(from, to, self%arrays(n)%name, self%arrays(n)%kind, self%used, &
                [self%points, larger%points])
      if (n > 1) call copy(from, to, offsets_name(self%arrays(n)), hdf5_long, self%used, &
                           [1_i8, 1_i8], growth)
    end do
    call to%set_total(steps//'/Values', int(max(1, self%used), i8))
    call copy(from, to, steps//'/Values', hdf5_real, self%used, [1_i8, 1_i8])
    do n = 1, size(lists)
      call copy(from, to, root//'/'//trim(lists(n)), hdf5_long, &
                merge(self%used, parts, n <= of_steps), [1_i8, 1_i8], &
                merge(growth, 1_i8, n <= of_places))
    end do
    call copy(from, to, root//'/Offsets', hdf5_long, parts, [self%points, larger%points] + 1_i8)
    call copy(from, to, root//'/Types', hdf5_byte, parts, [self%points, larger%points])
    call to%set_whole(steps, 'NSteps', [int(self%used, i8)], .true.)
    call from%close(error)
    if (allocated(error)) return
    call to%close(error)
  end subroutine copy_steps

  !> Copies the first places of a data set, each of so many columns in the one file and in the
  !! other; whole numbers are multiplied.
  subroutine copy(from, to, name, kind, places, columns, factor)
    type(hdf5_file_t), intent(inout) :: from, to
    character(*), intent(in) :: name
    integer, intent(in) :: kind, places
    integer(i8), intent(in) :: columns(2)
    integer(i8), intent(in), optional :: factor
    integer(i8) :: there, place
    integer :: rows
    call from%extent(name, rows, there)
    if (.not. from%good()) return
    if (columns(1) == columns(2)) then
      call copy_columns(from, to, name, kind, rows, min(places*columns(1), there), [0_i8, 0_i8], &
                        factor)
      return
    end if
    do place = 0, places - 1
      call copy_columns(from, to, name, kind, rows, min(columns(1), there - place*columns(1)), &
                        place*columns, factor)
    end do
  end subroutine copy

  !> Copies some columns of a data set from behind `before`(1) to behind `before`(2).
  subroutine copy_columns(from, to, name, kind, rows, total, before, factor)
    type(hdf5_file_t), intent(inout) :: from, to
    character(*), intent(in) :: name
    integer, intent(in) :: kind, rows
    integer(i8), intent(in) :: total, before(2)
    integer(i8), intent(in), optional :: factor
    real(dp), allocatable :: reals(:, :)
    integer(i8), allocatable :: longs(:, :)
    integer(i8) :: first
    integer :: n
    do first = 0, total - 1, block_columns
      n = int(min(int(block_columns, i8), total - first))
      select case (kind)
      case (hdf5_real)
        allocate (reals(rows, n))
        call from%get(name, reals, before(1) + first)
        call to%put(name, reals, before(2) + first)
        deallocate (reals)
      case default  ! whole numbers, which HDF5 turns into those of the file
        allocate (longs(1, n))
        call from%get(name, longs, before(1) + first)
        if (present(factor)) longs = longs*factor
        call to%put(name, longs, before(2) + first)
        deallocate (longs)
      end select
    end do
  end subroutine copy_columns

  !> At the end of a run: no empty places.
  subroutine vtkhdf_trim(self, snapshot, error)
    class(vtkhdf_t), intent(inout) :: self
    type(snapshot_t), intent(in) :: snapshot     !! with the fields of all dumps
    type(error_t), allocatable, intent(out) :: error
    call list_arrays(self, snapshot)
    call resize(self, self%used, self%parts, self%points, error)
  end subroutine vtkhdf_trim

  !> Whether there are empty places.
  pure function has_room(self) result(yes)
    class(vtkhdf_t), intent(in) :: self
    logical :: yes
    yes = self%made .and. self%used > 0 .and. &
          (self%used < self%capacity .or. self%parts < self%parts_capacity)
  end function has_room

  ! ---------------------------------------------------------------------- a step

  subroutine put_particles(self, file, snapshot, place)
    class(vtkhdf_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file
    type(snapshot_t), intent(in) :: snapshot
    integer(i8), intent(in) :: place
    real(dp), allocatable :: values(:, :)
    integer :: f, n
    call file%put(self%arrays(1)%name, snapshot%position, place)
    call file%put(self%arrays(2)%name, snapshot%id, place)
    call file%put(self%arrays(3)%name, snapshot%body, place)
    call file%put(self%arrays(4)%name, snapshot%velocity, place)
    n = 4
    if (allocated(snapshot%initial_position)) then
      n = 5
      call file%put(self%arrays(5)%name, snapshot%initial_position, place)
    end if
    do f = 1, size(snapshot%fields)
      call vtk_field_values(snapshot%fields(f), values)
      call file%put(self%arrays(n + f)%name, values, place)
    end do
  end subroutine put_particles

  !> Places of a step; its vertices where there is a new number of them.
  subroutine put_places(self, file, total)
    class(vtkhdf_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file
    integer(i8), intent(in) :: total
    integer(i8) :: part, s
    integer :: n
    s = self%used
    part = self%parts - 1
    call put_one('Steps/PartOffsets', part, s)
    call put_one('Steps/NumberOfParts', 1_i8, s)
    call put_one('Steps/PointOffsets', s*self%points, s)
    call put_one('Steps/CellOffsets', part*self%points, s)
    call put_one('Steps/ConnectivityIdOffsets', 0_i8, s)
    do n = 2, size(self%arrays)
      call file%put(offsets_name(self%arrays(n)), reshape([s*self%points], [1, 1]), s)
    end do
    call put_one('NumberOfPoints', total, part)
    call put_one('NumberOfCells', total, part)
    call put_one('NumberOfConnectivityIds', total, part)
  contains
    subroutine put_one(name, value, before)
      character(*), intent(in) :: name
      integer(i8), intent(in) :: value, before
      call file%put(root//'/'//name, reshape([value], [1, 1]), before)
    end subroutine put_one
  end subroutine put_places

  !> Offsets 0 to n of a new number of particles, and the kind of their cells.
  subroutine put_vertices(self, file, total)
    class(vtkhdf_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file
    integer(i8), intent(in) :: total
    integer(i8) :: part, first, p
    integer :: n
    part = self%parts - 1
    do first = 0, total, block_columns
      n = int(min(int(block_columns, i8), total + 1 - first))
      call file%put(root//'/Offsets', reshape([(p, p=first, first + n - 1)], [1, n]), &
                    part*(self%points + 1) + first)
      n = int(min(int(block_columns, i8), total - first))
      call file%put(root//'/Types', [(int(vertex, c_int8_t), p=1, n)], part*self%points + first)
    end do
  end subroutine put_vertices

end module sgmp_vtkhdf
