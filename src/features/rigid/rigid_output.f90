!> rigid.csv: one row per rigid body that turns or is free, with its name: where it is, how it is
!! turned, how it moves, and what contact does to a free one.
!!
!! Force and torque, about the body's centre, are means over the time since the row before, so that
!! no impulse is lost between rows.
module sgmp_rigid_output
  use sgmp_errors, only: error_t
  use sgmp_history, only: history_t, rigid_columns, rigid_integers
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_rigid_motion, only: motion_spin
  use sgmp_space, only: axes_in_output
  implicit none
  private
  public :: rigid_rows_t, rigid_rows_open, rigid_rows_write

  integer, parameter :: impulses = 6  !! components, linear and angular

  !> The table, and what its last rows counted up to.
  type :: rigid_rows_t
    type(history_t) :: file
    integer :: step = -1
    real(dp) :: time = 0.0_dp
    real(dp), allocatable :: impulse(:, :)   !! (impulses, bodies)
  end type rigid_rows_t

contains

  !> Starts the table where the model has such bodies.
  subroutine rigid_rows_open(rows, model, path, error, keep_to_step)
    type(rigid_rows_t), intent(inout) :: rows
    type(model_t), intent(in) :: model
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: keep_to_step  !! see history_t; sums are there already
    if (.not. any(has_row(model))) return
    if (.not. allocated(rows%impulse)) then
      allocate (rows%impulse(impulses, size(model%bodies)), source=0.0_dp)
    end if
    call rows%file%open(path, rigid_columns, error, rigid_integers, keep_to_step, 'name')
  end subroutine rigid_rows_open

  !> Which bodies have a row.
  pure function has_row(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes(size(model%bodies))
    yes = model%bodies%rigid_motion%free .or. model%bodies%rigid_motion%turns
  end function has_row

  !> Writes a row for each body.
  subroutine rigid_rows_write(rows, model, error)
    type(rigid_rows_t), intent(inout) :: rows
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: span
    integer :: b
    if (.not. any(has_row(model)) .or. rows%step == model%clock%step) return
    span = model%clock%time - rows%time
    if (model%clock%step == 0) span = 1.0_dp
    do b = 1, size(model%bodies)
      if (.not. (model%bodies(b)%rigid_motion%free .or. model%bodies(b)%rigid_motion%turns)) cycle
      call rows%file%write_row(model%clock%step, row_of(model, b, rows%impulse(:, b), span), &
                               error, trim(model%bodies(b)%name))
      if (allocated(error)) return
      rows%impulse(:, b) = model%bodies(b)%rigid_motion%impulse
    end do
    rows%step = model%clock%step
    rows%time = model%clock%time
  end subroutine rigid_rows_write

  !> Time, body, centre, attitude, velocity, angular velocity, force, torque.
  pure function row_of(model, b, before, span) result(row)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: before(impulses), span
    real(dp) :: row(size(rigid_columns))
    real(dp) :: force(impulses), velocity(3), spin(3)
    integer :: axes(3)
    axes = axes_in_output(:, model%mesh%space)
    associate (body => model%bodies(b), motion => model%bodies(b)%rigid_motion)
      velocity = body%speed
      spin = motion%spin
      if (motion%free) then
        velocity = motion%momentum(:3)/motion%mass
        spin = motion_spin(motion, motion%momentum(4:))
      end if
      force = (motion%impulse - before)/span
      row = [model%clock%time, real(b, dp), motion%centre(axes), motion%attitude, velocity(axes), &
             spin, force(axes), force(4:)]
    end associate
  end function row_of

end module sgmp_rigid_output
