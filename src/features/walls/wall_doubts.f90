!> What is doubtful about walls that move (doc/loads.md): before a run, and after it.
module sgmp_wall_doubts
  use sgmp_kernels, only: kernel_folds
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_spelling, only: string_t
  use sgmp_wall_motion, only: wall_motion_meets_walls
  implicit none
  private
  public :: wall_objections, wall_warnings

contains

  !> Walls that move into edges, or that start suddenly beside matter that moves.
  subroutine wall_warnings(model, warnings)
    type(model_t), intent(in) :: model
    type(string_t), allocatable, intent(out) :: warnings(:)
    type(string_t) :: found(2)
    integer :: n
    n = 0
    if (model%mesh%walls_move .and. lid_leaks(model)) then
      call note(found, n, 'a wall moves towards one across its way, as a lid does: '// &
                 'within a cell of the edge material is dragged into the wall at rest, and may '// &
                 'pass it (doc/loads.md); use method mpm, or leave the face open')
    end if
    if (model%mesh%walls_move .and. model%clock%step == 0 .and. &
        model%ledger%kinetic > 0.0_dp) then
      call note(found, n, 'walls are at rest before t = 0: material that moves with '// &
                 'them from the start is kicked by a velocity that is not 0 then; let both '// &
                 'begin at rest')
    end if
    warnings = found(:n)
  end subroutine wall_warnings

  !> Matter that is dragged through walls.
  subroutine wall_objections(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    if (lid_leaks(model)) then
      call opinion%object('a wall moves towards one across its way: beside their edge '// &
                          'material is dragged into the wall at rest (doc/loads.md); use '// &
                          'method mpm')
    end if
  end subroutine wall_objections

  pure subroutine note(found, n, text)
    type(string_t), intent(inout) :: found(:)
    integer, intent(inout) :: n
    character(*), intent(in) :: text
    n = n + 1
    found(n)%text = text
  end subroutine note

  !> Whether walls that move drag matter through others: functions that reach behind a wall read its
  !! motion there right up to the edge (doc/loads.md).
  pure logical function lid_leaks(model) result(leaks)
    type(model_t), intent(in) :: model
    leaks = kernel_folds(model%fields(1)%kernel) .and. &
            wall_motion_meets_walls(model%wall_motion, model%mesh)
  end function lid_leaks

end module sgmp_wall_doubts
