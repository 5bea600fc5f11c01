!> contact.csv: one row per pair of bodies in contact, with their names; of many pairs for those
!! that are near each other.
!!
!! The force is that on the pair's first body; on the second it is the opposite. It is the mean over
!! the time since the row before, so that no impulse is lost between rows. Its part along the
!! surfaces, node by node, is friction's.
module sgmp_contact_output
  use sgmp_body, only: body_group
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_errors, only: error_t
  use sgmp_history, only: contact_columns, contact_integers, history_t
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  implicit none
  private
  public :: contact_rows_t, contact_rows_open, contact_rows_write, contact_impulses

  integer, parameter :: contact_impulses = 9  !! components, linear, angular, of friction
  integer, parameter :: most_pairs = 100  !! of more those have rows that are near each other

  !> The table, and what its last rows counted up to.
  type :: contact_rows_t
    type(history_t) :: file
    integer :: step = -1
    real(dp) :: time = 0.0_dp
    real(dp), allocatable :: impulse(:, :)   !! (contact_impulses, pairs)
  end type contact_rows_t

contains

  !> Starts the table where the model has pairs in contact.
  subroutine contact_rows_open(rows, model, path, error, keep_to_step)
    type(contact_rows_t), intent(inout) :: rows
    type(model_t), intent(in) :: model
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: keep_to_step  !! see history_t; sums are there already
    if (size(model%contact%pairs) == 0) return
    if (.not. allocated(rows%impulse)) then
      allocate (rows%impulse(contact_impulses, size(model%contact%pairs)), source=0.0_dp)
    end if
    call rows%file%open(path, contact_columns, error, contact_integers, keep_to_step, 'bodies')
  end subroutine contact_rows_open

  !> Writes a row for each pair.
  subroutine contact_rows_write(rows, model, error)
    type(contact_rows_t), intent(inout) :: rows
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: impulse(contact_impulses), span
    integer :: p, row
    integer, allocatable :: of(:)
    if (size(model%contact%pairs) == 0 .or. rows%step == model%clock%step) return
    span = model%clock%time - rows%time
    if (model%clock%step == 0) span = 1.0_dp
    row = 0
    do p = 1, size(model%contact%pairs)
      of = same_bodies(model, p)
      if (of(1) < p) cycle
      row = row + 1
      associate (pairs => model%contact%pairs(of), pair => model%contact%pairs(p))
        impulse = sum_of(pairs)
        if (size(model%contact%pairs) > most_pairs .and. sum(pairs%shared) == 0 .and. &
            all(abs(impulse - rows%impulse(:, p)) <= 0.0_dp)) cycle
        call rows%file%write_row(model%clock%step, &
                                 [model%clock%time, real(row, dp), &
                                  (impulse - rows%impulse(:, p))/span, &
                                  real(sum(pairs%shared), dp), real(sum(pairs%touching), dp), &
                                  sum(pairs%dissipation)], error, &
                                 body_group(model%bodies, of_deck(model, pair%body(1)))//' '// &
                                 body_group(model%bodies, of_deck(model, pair%body(2))))
        rows%impulse(:, p) = impulse
      end associate
      if (allocated(error)) return
    end do
    rows%step = model%clock%step
    rows%time = model%clock%time
  end subroutine contact_rows_write

  !> Pairs of the same bodies as one, whatever labels these have where they touch themselves; else
  !! it is the only one.
  pure function same_bodies(model, p) result(of)
    type(model_t), intent(in) :: model
    integer, intent(in) :: p
    integer, allocatable :: of(:)                !! ascending
    integer :: q, fields(2), others(2)
    of = [p]
    if (.not. model%contact%self%on) return
    fields = model%bodies(of_deck(model, model%contact%pairs(p)%body))%field
    deallocate (of)
    allocate (of(0))
    do q = 1, size(model%contact%pairs)
      others = model%bodies(of_deck(model, model%contact%pairs(q)%body))%field
      if (all(others == fields) .or. all(others == fields([2, 1]))) of = [of, q]
    end do
  end function same_bodies

  !> The body that a twin is of.
  elemental function of_deck(model, b) result(body)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    integer :: body
    body = merge(model%bodies(b)%twin_of, b, model%bodies(b)%twin_of > 0)
  end function of_deck

  !> Impulses of some pairs on the first bodies of the first of them; a body gives itself none.
  pure function sum_of(pairs) result(impulse)
    type(contact_pair_t), intent(in) :: pairs(:)
    real(dp) :: impulse(contact_impulses)
    integer :: q
    impulse = 0.0_dp
    do q = 1, size(pairs)
      if (pairs(q)%family > 0) cycle
      impulse = impulse + [pairs(q)%impulse, pairs(q)%angular_impulse, pairs(q)%friction_impulse]
    end do
  end function sum_of

end module sgmp_contact_output
