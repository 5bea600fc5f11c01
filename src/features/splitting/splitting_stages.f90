!> What splitting does before and during a run, beside what a sweep does (sgmp_splitting).
module sgmp_splitting_stages
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_gaseous, law_is_spherical
  use sgmp_errors, only: error_make, exit_numerical
  use sgmp_kinds, only: dp
  use sgmp_material_history, only: slots_ask
  use sgmp_model, only: model_t
  use sgmp_splitting_type, only: splitting_t
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: splitting_columns, splitting_guard

contains

  !> Columns of the particles of a body that can be split: how far they are stretched, and from
  !! which they come.
  pure subroutine splitting_columns(splitting, ndim, body)
    type(splitting_t), intent(in) :: splitting
    integer, intent(in) :: ndim
    type(body_t), intent(inout) :: body
    if (.not. splitting%limit > 0.0_dp .or. body%rigid) return
    if (.not. splits(splitting, body%law)) return
    ! The stress update of swirl is that of space, and stretches three axes.
    call slots_ask(body%law%slots, 'stretch', &
                   spread(1.0_dp, 1, merge(3, ndim, body%law%slots%swirl > 0)))
    call slots_ask(body%law%slots, 'path', [1.0_dp])
  end subroutine splitting_columns

  !> Whether particles of a law are split.
  pure logical function splits(splitting, law) result(yes)
    type(splitting_t), intent(in) :: splitting
    type(constitutive_t), intent(in) :: law
    if (law_gaseous(law)) then
      yes = splitting%gases
    else if (law_is_spherical(law)) then
      yes = splitting%liquids
    else
      yes = splitting%solids
    end if
  end function splits

  !> More particles than the deck allows are a failure.
  subroutine splitting_guard(model)
    type(model_t), intent(inout) :: model
    integer, parameter :: most = 10000000        !! where the deck does not say
    integer :: bound
    associate (splitting => model%method%features%splitting, n => sum(model%totals%particles))
      if (splitting%most == 0 .and. splitting%bounded) return
      bound = merge(splitting%most, most, splitting%most > 0)
      if (n <= bound) return
      call error_make(model%findings%failure, exit_numerical, 'splitting has led to '// &
                      integer_text(n)//' particles in step '//integer_text(model%clock%step)// &
                      ', more than split_most='//integer_text(bound), &
                      'raise split: particles stay larger; or raise split_most')
    end associate
  end subroutine splitting_guard

end module sgmp_splitting_stages
