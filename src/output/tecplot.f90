!> Tecplot ASCII output: particles.dat, POINT zones, one per body and dump.
!!
!! Zones of one body share a STRANDID, so that Tecplot animates them by SOLUTIONTIME. They are one-
!! dimensional (I = number of particles), which VTK's Tecplot reader skips: for
!! ParaView use the .vtu files.
module sgmp_tecplot
  use sgmp_errors, only: error_t
  use sgmp_file_tools, only: file_exists, file_lines, line_t, output_file_t
  use sgmp_kinds, only: dp
  use sgmp_snapshot, only: snapshot_t
  use sgmp_text, only: integer_text, real_text_full, row_text
  implicit none
  private
  public :: tecplot_t

  !> A Tecplot file that grows by one dump after another.
  type :: tecplot_t
    private
    type(output_file_t) :: file
    character(:), allocatable :: title
    logical :: headed = .false.  !! TITLE and VARIABLES are written
  contains
    procedure :: open => tecplot_open
    procedure :: dump => tecplot_dump
    procedure :: close => tecplot_close
  end type tecplot_t

contains

  !> Starts the file; with `keep_to_time`, zones of an existing file up to that time stay.
  subroutine tecplot_open(self, path, title, error, keep_to_time)
    class(tecplot_t), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: title                 !! of the simulation
    type(error_t), allocatable, intent(out) :: error
    real(dp), intent(in), optional :: keep_to_time
    self%title = title
    self%headed = .false.
    if (present(keep_to_time)) then
      if (file_exists(path)) then
        call cut_back(path, keep_to_time, self%headed, error)
        if (allocated(error)) return
      end if
    end if
    if (self%headed) then
      call self%file%open(path, 'append', error)
    else
      call self%file%open(path, 'new', error)
    end if
  end subroutine tecplot_open

  !> Adds a zone for every body that has particles. Values per point: x y z, velocity, body, id,
  !! then the components of the fields in the snapshot's order, which must be the same in every
  !! dump.
  subroutine tecplot_dump(self, snapshot, error)
    class(tecplot_t), intent(inout) :: self
    type(snapshot_t), intent(in) :: snapshot
    type(error_t), allocatable, intent(out) :: error
    integer :: b, points
    if (.not. self%headed) then
      call self%file%line('TITLE = "'//quotable(self%title)//'"')
      call self%file%line('VARIABLES = '//variables(snapshot))
      self%headed = .true.
    end if
    do b = 1, maxval([0, snapshot%body])
      points = count(snapshot%body == b)
      if (points == 0) cycle
      call self%file%line('ZONE T="'//body_name(snapshot, b)//'", STRANDID='//integer_text(b)// &
                          ', SOLUTIONTIME='//real_text_full(snapshot%time)//', I='// &
                          integer_text(points)//', DATAPACKING=POINT')
      call write_points(self%file, snapshot, b)
    end do
    call self%file%flush(error)
  end subroutine tecplot_dump

  !> Ends the file; harmless if it was never opened.
  subroutine tecplot_close(self, error)
    class(tecplot_t), intent(inout) :: self
    type(error_t), allocatable, intent(out) :: error
    call self%file%close(error)
  end subroutine tecplot_close

  subroutine write_points(file, snapshot, body)
    type(output_file_t), intent(inout) :: file
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: body
    character(:), allocatable :: row
    integer :: f, p
    do p = 1, size(snapshot%id)
      if (snapshot%body(p) /= body) cycle
      row = row_text([snapshot%position(:, p), snapshot%velocity(:, p)], ' ')//' '// &
            integer_text(body)//' '//integer_text(snapshot%id(p))
      if (allocated(snapshot%fields)) then
        do f = 1, size(snapshot%fields)
          row = row//' '//row_text(snapshot%fields(f)%values(:, p), ' ')
        end do
      end if
      call file%line(row)
    end do
  end subroutine write_points

  pure function variables(snapshot) result(text)
    type(snapshot_t), intent(in) :: snapshot
    character(:), allocatable :: text
    integer :: f, i
    text = '"x" "y" "z" "velocity_x" "velocity_y" "velocity_z" "body" "id"'
    if (.not. allocated(snapshot%fields)) return
    do f = 1, size(snapshot%fields)
      do i = 1, size(snapshot%fields(f)%components)
        text = text//' "'//trim(snapshot%fields(f)%components(i))//'"'
      end do
    end do
  end function variables

  pure function body_name(snapshot, body) result(name)
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: body
    character(:), allocatable :: name
    name = 'body '//integer_text(body)
    if (.not. allocated(snapshot%body_names)) return
    if (body <= size(snapshot%body_names)) name = quotable(trim(snapshot%body_names(body)))
  end function body_name

  !> Text that may stand between double quotes.
  pure function quotable(text) result(clean)
    character(*), intent(in) :: text
    character(len(text)) :: clean
    integer :: i
    clean = text
    do i = 1, len(text)
      if (text(i:i) == '"') clean(i:i) = "'"
    end do
  end function quotable

  !> Rewrites the file up to the first zone later than `time`; `headed` tells whether anything is
  !! left.
  subroutine cut_back(path, time, headed, error)
    character(*), intent(in) :: path
    real(dp), intent(in) :: time
    logical, intent(out) :: headed
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: key = 'SOLUTIONTIME='
    type(line_t), allocatable :: lines(:)
    type(output_file_t) :: file
    real(dp) :: zone_time
    integer :: i, start, status
    headed = .false.
    call file_lines(path, lines, error)
    if (allocated(error)) return
    call file%open(path, 'replace', error)
    if (allocated(error)) return
    do i = 1, size(lines)
      if (index(lines(i)%text, 'ZONE') == 1) then
        start = index(lines(i)%text, key) + len(key)
        read (lines(i)%text(start:), *, iostat=status) zone_time
        if (status /= 0) exit
        if (zone_time > time) exit
      end if
      call file%line(lines(i)%text)
      if (index(lines(i)%text, 'VARIABLES') == 1) headed = .true.
    end do
    call file%close(error)
  end subroutine cut_back

end module sgmp_tecplot
