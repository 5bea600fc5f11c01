!> All particles at one time as a table that any script reads: particles_end.csv.
module sgmp_particle_table
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: output_file_t
  use sgmp_kinds, only: dp
  use sgmp_snapshot, only: snapshot_t
  use sgmp_text, only: integer_text, row_text
  implicit none
  private
  public :: particle_table_write

contains

  !> Writes `id,body,x,y,z[,x0,y0,z0],velocity_x,velocity_y,velocity_z,<components of fields>`, one
  !! row per particle in the order of the snapshot (by id), full precision. The file appears
  !! complete or not at all.
  subroutine particle_table_write(path, snapshot, error)
    character(*), intent(in) :: path
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(out) :: error
    type(output_file_t) :: file
    real(dp), allocatable :: row(:)
    integer :: f, n, p
    call file%open(path, 'replace', error)
    if (allocated(error)) return
    call file%line(csv_header(snapshot))
    n = 6
    if (allocated(snapshot%initial_position)) n = n + 3
    if (allocated(snapshot%fields)) then
      n = n + sum([(size(snapshot%fields(f)%values, 1), f=1, size(snapshot%fields))])
    end if
    allocate (row(n))
    do p = 1, size(snapshot%id)
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
      call file%line(integer_text(snapshot%id(p))//','//integer_text(snapshot%body(p))//','// &
                     row_text(row, ','))
    end do
    call file%close(error)
  end subroutine particle_table_write

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
