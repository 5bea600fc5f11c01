!> All particles at one time as a table that any script reads: particles_end.csv.
module sgmp_particle_table
!$ use omp_lib, only: omp_get_max_threads
  use sgmp_decimals, only: integer_put, integer_width, real_width, reals_put
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: newline, output_file_t
  use sgmp_kinds, only: dp
  use sgmp_snapshot, only: snapshot_t
  use sgmp_write_behind, only: write_behind_t
  implicit none
  private
  public :: particle_table_write

  integer, parameter :: rows = 256   !! in a block, which one thread writes
  integer, parameter :: share = 4    !! blocks of a thread, before all have met

contains

  !> Writes `id,body,x,y,z[,x0,y0,z0],velocity_x,velocity_y,velocity_z,<components of fields>`, one
  !! row per particle in the order of the snapshot (by id), full precision. The file appears
  !! complete or not at all. With `behind` a thread writes while others put numbers into words.
  subroutine particle_table_write(path, snapshot, error, behind)
    character(*), intent(in) :: path
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(out) :: error
    type(write_behind_t), intent(in), optional :: behind
    type(output_file_t) :: file
    character(:), allocatable :: text(:)
    integer, allocatable :: used(:)
    integer :: blocks, width, n, first, b
    call file%open(path, 'replace', error, behind)
    if (allocated(error)) return
    call file%line(csv_header(snapshot))
    n = size(snapshot%id)
    width = 2*integer_width + real_width*columns(snapshot)
    blocks = share
!$  blocks = share*omp_get_max_threads()
    allocate (character(rows*width) :: text(blocks))
    allocate (used(blocks))
    do first = 1, n, rows*blocks
      !$omp parallel do schedule(dynamic) default(none) &
      !$omp   shared(snapshot, first, n, text, used, blocks)
      do b = 1, blocks
        call write_rows(snapshot, first + rows*(b - 1), min(n, first + rows*b - 1), text(b), &
                        used(b))
      end do
      !$omp end parallel do
      do b = 1, blocks
        call file%put(text(b)(:used(b)))
      end do
    end do
    call file%close(error)
  end subroutine particle_table_write

  !> Numbers in a row, besides id and body.
  pure function columns(snapshot) result(n)
    type(snapshot_t), intent(in) :: snapshot
    integer :: n, f
    n = 6
    if (allocated(snapshot%initial_position)) n = n + 3
    if (.not. allocated(snapshot%fields)) return
    n = n + sum([(size(snapshot%fields(f)%values, 1), f=1, size(snapshot%fields))])
  end function columns

  !> Rows of some particles as text.
  pure subroutine write_rows(snapshot, first, last, text, used)
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: first, last           !! particles
    character(*), intent(inout) :: text
    integer, intent(out) :: used                 !! letters of it
    real(dp) :: row(columns(snapshot))
    integer :: p, f, n
    used = 0
    do p = first, last
      call integer_put(snapshot%id(p), text, used)
      call put_mark(',', text, used)
      call integer_put(snapshot%body(p), text, used)
      call put_mark(',', text, used)
      row(:3) = snapshot%position(:, p)
      n = 3
      if (allocated(snapshot%initial_position)) then
        row(4:6) = snapshot%initial_position(:, p)
        n = 6
      end if
      row(n + 1:n + 3) = snapshot%velocity(:, p)
      n = n + 3
      if (allocated(snapshot%fields)) then
        do f = 1, size(snapshot%fields)
          associate (values => snapshot%fields(f)%values(:, p))
            row(n + 1:n + size(values)) = values
            n = n + size(values)
          end associate
        end do
      end if
      call reals_put(row, ',', text, used)
      call put_mark(newline, text, used)
    end do
  end subroutine write_rows

  !> Appends one letter.
  pure subroutine put_mark(mark, text, used)
    character(1), intent(in) :: mark
    character(*), intent(inout) :: text
    integer, intent(inout) :: used
    used = used + 1
    text(used:used) = mark
  end subroutine put_mark

  !> Column names of a snapshot.
  pure function csv_header(snapshot) result(header)
    type(snapshot_t), intent(in) :: snapshot
    character(:), allocatable :: header
    integer :: f, i
    header = 'id,body,x,y,z'
    if (allocated(snapshot%initial_position)) header = header//',x0,y0,z0'
    header = header//',velocity_x,velocity_y,velocity_z'
    if (.not. allocated(snapshot%fields)) return
    do f = 1, size(snapshot%fields)
      do i = 1, size(snapshot%fields(f)%components)
        header = header//','//trim(snapshot%fields(f)%components(i))
      end do
    end do
  end function csv_header

end module sgmp_particle_table
