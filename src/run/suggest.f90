!> A deck with cells that are small only where bodies meet, made of one with equal cells
!! (`sgmp DECK --suggest`): the words of the plan (sgmp_graded_plan) on its card grid.
module sgmp_suggest
  use, intrinsic :: iso_fortran_env, only: output_unit
  use sgmp_build_model, only: model_build
  use sgmp_errors, only: error_make, error_t, exit_io, exit_usage
  use sgmp_file_tools, only: file_exists, file_lines, line_t, output_file_t
  use sgmp_graded_plan, only: graded_plan_find, graded_plan_t
  use sgmp_kinds, only: dp
  use sgmp_memory_need, only: memory_refuse
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_rank
  use sgmp_scene, only: scene_t
  use sgmp_text, only: integer_text
  use sgmp_thread_choice, only: thread_choice_t
  implicit none
  private
  public :: suggest_write

  real(dp), parameter :: enough = 1.2_dp       !! gain from which on a deck is written

contains

  !> Writes the deck beside the one that it is made of, or says why there is none; all ranks must
  !! call it.
  subroutine suggest_write(scene, threads, error)
    type(scene_t), intent(in) :: scene
    type(thread_choice_t), intent(inout) :: threads
    type(error_t), allocatable, intent(out) :: error
    type(model_t), allocatable :: model
    type(graded_plan_t) :: plan
    character(:), allocatable :: path
    call memory_refuse(scene, error)
    if (allocated(error)) return
    call threads%choose(scene)
    allocate (model)
    call model_build(scene, threads%threads, model, error)
    call parallel_agree(error)
    if (allocated(error)) return
    call graded_plan_find(scene, model, plan)
    if (plan%words /= '' .and. plan%gain < enough) then
      plan%reason = 'with '//plan%words//' there would be '//integer_text(plan%particles)// &
                    ' particles in the place of '//integer_text(sum(model%totals%particles))// &
                    ', each dearer by a third'
    end if
    if (parallel_rank() == 0) then
      if (plan%reason == '') then
        call write_deck(scene, plan%words, path, error)
        if (.not. allocated(error)) write (output_unit, '(a)') path//': '//plan%words//'; '// &
          integer_text(plan%particles)//' particles in the place of '// &
          integer_text(sum(model%totals%particles))
      else
        write (output_unit, '(a)') scene%file//': nothing is gained by unequal cells: '//plan%reason
      end if
    end if
    call parallel_agree(error)
  end subroutine suggest_write

  !> Writes the deck with words put behind the name of its card grid.
  subroutine write_deck(scene, words, path, error)
    type(scene_t), intent(in) :: scene
    character(*), intent(in) :: words
    character(:), allocatable, intent(out) :: path  !! of the new deck
    type(error_t), allocatable, intent(out) :: error
    type(line_t), allocatable :: lines(:)
    type(output_file_t) :: deck
    integer :: i, dot
    dot = index(scene%file, '.', back=.true.)
    if (dot <= index(scene%file, '/', back=.true.) + 1) dot = len(scene%file) + 1
    path = scene%file(:dot - 1)//'_graded.inp'
    associate (place => scene%grid%position)
      if (place%file /= scene%file) then
        call error_make(error, exit_usage, 'the card grid is in a file that the deck includes', &
                        'write '//words//' behind it', place%text())
      else if (file_exists(path)) then
        call error_make(error, exit_io, "there is a file '"//path//"' already", 'move it away')
      end if
      if (allocated(error)) return
      call file_lines(scene%file, lines, error)
      if (allocated(error)) return
      call deck%open(path, 'new', error)
      if (allocated(error)) return
      do i = 1, size(lines)
        associate (text => lines(i)%text, split => place%column + len('grid'))
          if (i == place%line) then
            call deck%line(text(:split - 1)//' '//words//text(split:))
          else
            call deck%line(text)
          end if
        end associate
      end do
    end associate
    call deck%close(error)
  end subroutine write_deck

end module sgmp_suggest
