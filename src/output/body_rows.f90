!> bodies.csv: one row per body and sample, sums over its particles and its name.
module sgmp_body_rows
  use sgmp_errors, only: error_t
  use sgmp_history, only: bodies_columns, history_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_position
  use sgmp_model, only: model_t
  use sgmp_space, only: axes_in_output
  implicit none
  private
  public :: body_rows_write, momentum_in_output

contains

  !> Writes a row for each body.
  subroutine body_rows_write(file, model, error)
    type(history_t), intent(inout) :: file
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    integer :: b
    do b = 1, size(model%bodies)
      if (model%bodies(b)%twin_of > 0) cycle
      call file%write_row(model%clock%step, body_row(model, b), error, trim(model%bodies(b)%name))
      if (allocated(error)) return
    end do
  end subroutine body_rows_write

  !> Time, body, mass, centroid, velocity, kinetic and internal energy,
  !! particles.
  pure function body_row(model, b) result(row)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: row(size(bodies_columns))
    real(dp) :: centroid(3)
    integer :: axes(3)
    associate (sums => model%totals%bodies(b), &
               mass => max(model%totals%bodies(b)%mass, tiny(1.0_dp)))  ! all of it may have eroded
      centroid = mesh_position(model%mesh%origin, model%mesh%h, sums%moment/mass)
      centroid(model%mesh%ndim + 1:) = 0.0_dp
      axes = axes_in_output(:, model%mesh%space)
      row = [model%clock%time, real(b, dp), sums%mass, centroid(axes), &
             momentum_in_output(model, sums%momentum)/mass, sums%kinetic, sums%internal, &
             real(model%totals%particles(b), dp)]
    end associate
  end function body_row

  !> A momentum along the axes of output. With swirl its third component is about the axis and has a
  !! column of its own in history.csv: no net momentum lies across the half-plane.
  pure function momentum_in_output(model, momentum) result(components)
    type(model_t), intent(in) :: model
    real(dp), intent(in) :: momentum(3)
    real(dp) :: components(3)
    components = momentum
    if (model%method%swirl) components(3) = 0.0_dp
    components = components(axes_in_output(:, model%mesh%space))
  end function momentum_in_output

end module sgmp_body_rows
