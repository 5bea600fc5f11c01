!> motion.csv: one row per prescribed motion of a part of a body, with the body's name: where its
!! centre is, how it moves, what force and torque it takes, and the work done.
!!
!! Force and torque, about that centre, are what moves the part, means over the time since the row
!! before, so that no impulse is lost between rows; work is counted from the start.
module sgmp_driven_output
  use sgmp_body, only: body_parts
  use sgmp_drive, only: drive_force, drive_torque, drive_work
  use sgmp_driven_part, only: driven_part_t, driven_totals
  use sgmp_driven_parts, only: driven_any, driven_terms
  use sgmp_errors, only: error_t
  use sgmp_history, only: history_t, motion_columns, motion_integers
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_space, only: axes_in_output
  implicit none
  private
  public :: motion_rows_t, motion_rows_open, motion_rows_write

  !> The table, and what its last rows counted up to.
  type :: motion_rows_t
    type(history_t) :: file
    integer :: step = -1
    real(dp) :: time = 0.0_dp
    real(dp), allocatable :: before(:, :)    !! (driven_totals, motions)
  end type motion_rows_t

contains

  !> Starts the table where the model has such motions.
  subroutine motion_rows_open(rows, model, path, error, keep_to_step)
    type(motion_rows_t), intent(inout) :: rows
    type(model_t), intent(in) :: model
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: keep_to_step  !! see history_t; sums are there already
    if (.not. driven_any(model%fields)) return
    if (.not. allocated(rows%before)) then
      allocate (rows%before(driven_totals, driven_terms(model%fields)), source=0.0_dp)
    end if
    call rows%file%open(path, motion_columns, error, motion_integers, keep_to_step, 'name')
  end subroutine motion_rows_open

  !> Writes a row for each motion, in the order of the bodies and of their cards.
  subroutine motion_rows_write(rows, model, error)
    type(motion_rows_t), intent(inout) :: rows
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: span
    integer :: b, i, n
    if (.not. driven_any(model%fields) .or. rows%step == model%clock%step) return
    span = model%clock%time - rows%time
    if (model%clock%step == 0) span = 1.0_dp
    n = 0
    do b = 1, size(model%bodies)
      do i = 1, body_parts(model%bodies(b))
        n = n + 1
        associate (part => model%bodies(b)%driven(i))
          call rows%file%write_row(model%clock%step, [model%clock%time, real(b, dp), real(i, dp), &
                                   row_of(part, model%mesh%space, rows%before(:, n), span)], &
                                   error, trim(model%bodies(b)%name))
          if (allocated(error)) return
          rows%before(:, n) = part%total
        end associate
      end do
    end do
    rows%step = model%clock%step
    rows%time = model%clock%time
  end subroutine motion_rows_write

  !> Centre, velocity, angular velocity, force, torque, work.
  pure function row_of(part, space, before, span) result(row)
    type(driven_part_t), intent(in) :: part
    integer, intent(in) :: space
    real(dp), intent(in) :: before(driven_totals), span
    real(dp) :: row(size(motion_columns) - 3)
    real(dp) :: mean(driven_totals), centre(3), velocity(3), force(3)
    integer :: axes(3)
    axes = axes_in_output(:, space)
    mean = (part%total - before)/span
    centre = part%motion%centre
    velocity = part%drive%velocity
    force = mean(drive_force:drive_force + 2)
    row = [centre(axes), velocity(axes), part%motion%spin, force(axes), &
           mean(drive_torque:drive_torque + 2), part%total(drive_work)]
  end function row_of

end module sgmp_driven_output
