!> The first steps of a scene taken for a trial (`--check`): what a step costs here, and how long it
!! is once the run has begun.
module sgmp_trial
  use sgmp_errors, only: error_t
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_any, parallel_max
  use sgmp_scene, only: scene_t
  use sgmp_step, only: step_take
  use sgmp_text, only: integer_text
  use sgmp_time_step, only: clock_advance, clock_choose
  use sgmp_timers, only: wall_time
  implicit none
  private
  public :: trial_t, trial_take

  integer, parameter :: most_steps = 50
  real(dp), parameter :: longest = 0.5_dp    !! seconds of wall time

  !> What was found.
  type :: trial_t
    integer :: steps = 0                     !! that were taken
    real(dp) :: dt = 0.0_dp                  !! length of the last one; 0: none could be chosen
    real(dp) :: seconds = 0.0_dp             !! of wall time for a step, of the slowest rank
    real(dp) :: ahead = 0.0_dp               !! steps to the end of the run, in all
    character(:), allocatable :: failure     !! how a step failed; '' if none has
  end type trial_t

contains

  !> Takes some steps of a scene; all ranks must call it. The model is spent.
  subroutine trial_take(scene, model, trial)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(trial_t), intent(out) :: trial
    real(dp) :: started, spent
    logical :: ok
    trial%failure = ''
    spent = 0.0_dp
    started = wall_time()
    do while (trial%steps < min(most_steps, scene%time%steps))
      call clock_choose(model%clock, model%mesh%h, model%findings%fastest, huge(1.0_dp), ok)
      trial%dt = model%clock%dt
      if (.not. ok) exit
      call step_take(model)
      call clock_advance(model%clock, huge(1.0_dp))
      trial%steps = trial%steps + 1
      if (allocated(model%findings%failure)) then
        trial%failure = 'step '//integer_text(trial%steps)//' fails: '// &
                        model%findings%failure%message
        exit
      end if
      if (scene%time%end > 0.0_dp .and. model%clock%time >= scene%time%end) exit
      if (sum(model%totals%particles) == 0_i8) exit
      ! The first step fetches memory.
      if (trial%steps == 1) started = wall_time()
      spent = wall_time() - started
      if (parallel_any(spent > longest)) exit
    end do
    trial%seconds = parallel_max(spent)/max(trial%steps - 1, 1)
    trial%ahead = real(scene%time%steps, dp)
    if (scene%time%end > 0.0_dp .and. trial%dt > 0.0_dp) then
      trial%ahead = min(trial%ahead, trial%steps + &
                        max(scene%time%end - model%clock%time, 0.0_dp)/trial%dt)
    end if
  end subroutine trial_take

end module sgmp_trial
