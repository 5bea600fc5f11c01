!> The verdict on a run: whether what it left behind can be sound, and if not, why (doc/verdict.md).
!!
!! Every criterion looks at the state at the end and at sums that the run has kept anyway; nothing
!! of it costs anything in the time loop. Each has a deck in tests/regression/verdict.py that trips
!! it.
module sgmp_verdict
  use sgmp_absorbing_doubts, only: absorbing_objections
  use sgmp_constitutive, only: material_explosive, material_fluid
  use sgmp_end_state, only: end_state_t, end_state_take
  use sgmp_energy, only: ledger_drift
  use sgmp_errors, only: error_t, exit_stopped
  use sgmp_judge_balance, only: judge_energy, judge_erosion, judge_impulse, judge_noise, &
                                judge_stressed, judge_turning
  use sgmp_judge_collisions, only: judge_collisions, judge_projectiles
  use sgmp_judge_digging, only: judge_digging
  use sgmp_judge_entries, only: judge_entries
  use sgmp_judge_failure, only: judge_failure, judge_torn
  use sgmp_judge_fronts, only: judge_fronts
  use sgmp_judge_gases, only: judge_bubbles, judge_charges, judge_cushions, judge_mines
  use sgmp_judge_heat, only: judge_heat
  use sgmp_judge_punches, only: judge_punches, judge_standing
  use sgmp_judge_pushed, only: judge_pushed
  use sgmp_judge_rolling, only: judge_rolling
  use sgmp_judge_shocks, only: judge_shocks
  use sgmp_judge_spall, only: judge_spall
  use sgmp_judge_state, only: judge_ball, judge_particles, judge_pressed, judge_resolution, &
                              judge_thin, judge_volumes
  use sgmp_judge_toppling, only: judge_toppling
  use sgmp_judge_waves, only: judge_waves
  use sgmp_kernels, only: kernel_mpm
  use sgmp_kinds, only: dp
  use sgmp_meetings, only: judge_bonds, judge_stuck
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t, reason_length
  use sgmp_parallel, only: parallel_any
  use sgmp_run_log, only: log_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: combine_union, shape_sphere, shape_t
  use sgmp_stages, only: stage_objection
  use sgmp_summary, only: summary_t
  use sgmp_text, only: integer_text, percent_text, real_text, real_text_about
  use sgmp_thickness, only: body_thickness
  use sgmp_time_step, only: limit_names
  use sgmp_update, only: update_usf
  use sgmp_wall_doubts, only: wall_objections
  use sgmp_yielding, only: yielding_look
  implicit none
  private
  public :: verdict_t

  !> What was found, and what of it speaks against the run.
  type :: verdict_t
    private
    logical :: looked = .false.            !! the particles were in a state to be looked at
    type(end_state_t) :: state
    type(opinion_t) :: opinion
    character(:), allocatable :: thinnest  !! name of the thinnest body
    real(dp) :: thickness = huge(1.0_dp)   !! of it, in cells
    logical :: gauges = .false.            !! there are some
    real(dp) :: drift = 0.0_dp, contact = 0.0_dp, viscous = 0.0_dp  !! parts of the energy supplied
    real(dp) :: projection = 0.0_dp        !! energy that projection loses, over the same
    real(dp) :: failure = -1.0_dp  !! work of what failed by strain over the same; -1: none can
    real(dp) :: heat = -1.0_dp     !! the same of what heat has softened; -1: softens nothing
    real(dp) :: stressed = -1.0_dp         !! strain times time of elastic bodies; -1: none
    real(dp) :: turn = -1.0_dp             !! largest change of angular momentum; -1: none is judged
    real(dp) :: impulse = 0.0_dp           !! of forces on nodes without mass
    real(dp) :: steps(2) = 0.0_dp          !! shortest and longest
    character(16) :: limited_by = ''       !! the last one
  contains
    procedure :: reach => verdict_reach
    procedure :: report => verdict_report
    procedure :: summarise => verdict_summarise
  end type verdict_t

contains

  !> Looks at the end of a run and judges it; all ranks must call it.
  subroutine verdict_reach(self, scene, model, error)
    class(verdict_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model            !! which bodies have sprung back
    type(error_t), allocatable, intent(in) :: error  !! what ended the run early
    real(dp) :: supplied
    character(:), allocatable :: reason
    real(dp) :: inexact, cells
    logical :: solid(size(scene%bodies)), mpm
    integer :: b
    call self%opinion%open()
    self%gauges = size(scene%gauges) > 0
    supplied = max(model%ledger%supplied, tiny(1.0_dp))
    self%drift = ledger_drift(model%ledger)
    self%contact = model%ledger%contact_dissipation/supplied
    self%viscous = model%ledger%viscous_dissipation/supplied
    self%projection = model%ledger%interpolation_error/supplied
    self%steps = [model%clock%shortest, model%clock%longest]
    self%limited_by = limit_names(model%clock%limited_by)
    b = thinnest_of(scene, model, .not. scene%bodies%rigid, self%thickness)
    self%thinnest = ''
    if (b > 0) self%thinnest = trim(scene%bodies(b)%name)
    self%looked = .true.
    if (allocated(error)) self%looked = error%code == exit_stopped
    self%looked = .not. parallel_any(.not. self%looked)
    if (.not. self%looked) then
      if (allocated(error)) call self%opinion%object('it failed: '//error%message)
      return
    end if
    call end_state_take(scene, model, self%state)
    call yielding_look(model)
    self%impulse = model%ledger%lost_impulse
    call judge_energy(self%opinion, model)
    call judge_noise(self%opinion, model)
    call judge_stressed(self%opinion, model, self%stressed)
    call judge_erosion(self%opinion, model)
    call judge_impulse(self%opinion, model)
    call judge_turning(self%opinion, scene, model, self%turn)
    call judge_stuck(self%opinion, scene)
    call judge_bonds(self%opinion, scene, model)
    call judge_collisions(self%opinion, scene, model)
    call judge_projectiles(self%opinion, scene, model)
    call judge_punches(self%opinion, scene, model)
    call judge_standing(self%opinion, scene, model)
    call judge_digging(self%opinion, scene, model)
    call judge_entries(self%opinion, scene, model)
    call judge_rolling(self%opinion, scene, model)
    call judge_toppling(self%opinion, scene, model)
    call judge_charges(self%opinion, scene, model)
    call judge_mines(self%opinion, scene, model)
    call judge_shocks(self%opinion, scene, model)
    call judge_cushions(self%opinion, scene, model, self%state%compression)
    call judge_bubbles(self%opinion, scene, model)
    call judge_waves(self%opinion, scene, model)
    call judge_pushed(self%opinion, scene)
    call judge_fronts(self%opinion, model)
    call judge_failure(self%opinion, model, self%failure)
    call judge_torn(self%opinion, model)
    call judge_spall(self%opinion, scene, model)
    call judge_heat(self%opinion, model, self%heat)
    call stage_objection(model, inexact, reason)
    if (inexact >= 1.0_dp) then
      call self%opinion%object(reason)
    else if (inexact > 0.0_dp) then
      call self%opinion%expect(inexact, reason)
    end if
    call wall_objections(self%opinion, model)
    call absorbing_objections(self%opinion, model)
    call judge_volumes(self%opinion, self%state, scene%method%volumes_kept)
    mpm = model%fields(1)%kernel == kernel_mpm
    call judge_particles(self%opinion, self%state, scene, model%findings%lost, mpm)
    call judge_pressed(self%opinion, self%state, stresses_jump(model), &
                       model%method%update == update_usf)
    solid = .not. scene%bodies%rigid .and. &
            [(.not. any(model%bodies(b)%law%kind == [material_explosive, material_fluid]), &
              b=1, size(scene%bodies))]
    call judge_thin(self%opinion, model, thinnest_of(scene, model, solid, cells), cells)
    solid = solid .and. [(has_ball(scene%bodies(b)%shapes), b=1, size(scene%bodies))]
    call judge_ball(self%opinion, model, thinnest_of(scene, model, solid, cells), cells)
    call judge_resolution(self%opinion, self%thinnest, self%thickness, self%steps)
  end subroutine verdict_reach

  !> Whether stresses jump where particles change cells; those that keep their first places do not.
  pure logical function stresses_jump(model) result(yes)
    type(model_t), intent(in) :: model
    yes = model%fields(1)%kernel == kernel_mpm .and. .not. model%method%features%reference
  end function stresses_jump

  !> The body with the fewest cells across among some; 0 where none of them has an end.
  function thinnest_of(scene, model, among, cells) result(thinnest)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical, intent(in) :: among(:)                !! (bodies)
    real(dp), intent(out) :: cells                 !! across it; huge for none
    integer :: thinnest, b
    cells = huge(1.0_dp)
    thinnest = 0
    do b = 1, size(scene%bodies)
      if (.not. among(b)) cycle
      if (body_thickness(scene%bodies(b)%shapes, model%mesh) >= cells) cycle
      cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
      thinnest = b
    end do
  end function thinnest_of

  !> Whether a body unites a sphere with others, or is one.
  pure function has_ball(shapes) result(yes)
    type(shape_t), allocatable, intent(in) :: shapes(:)
    logical :: yes
    yes = .false.
    if (allocated(shapes)) yes = any(shapes%kind == shape_sphere .and. &
                                     shapes%combine == combine_union)
  end function has_ball

  !> Closing lines of the log: what was found, then the verdict; doubts are warnings.
  subroutine verdict_report(self, log)
    class(verdict_t), intent(in) :: self
    type(log_t), intent(inout) :: log
    character(reason_length), allocatable :: reasons(:)
    integer :: r
    if (self%looked .and. self%state%particles > 0) then
      associate (found => self%state)
        call log%line('density up to '//real_text(found%compression)//' times, volume up to '// &
                      real_text(found%expansion)//' times the initial one; pressure '// &
                      real_text(found%pressure(1))//' to '//real_text(found%pressure(2)))
        call log%line('at least '//real_text(found%per_cell)//' particles per cell, '// &
                      integer_text(found%separated)//' out of reach of their bodies, '// &
                      percent_text(found%excess)//' of their volume without room'//thinnest(self))
      end associate
    end if
    call log%line('energy: drift '//percent_text(self%drift)//', contact '// &
                  percent_text(self%contact)//', viscosity '//percent_text(self%viscous)// &
                  ' of what the scene was given; steps '// &
                  real_text(self%steps(1))//' to '//real_text(self%steps(2))// &
                  ', last limited by '//trim(self%limited_by))
    reasons = self%opinion%reasons()
    if (size(reasons) == 0) then
      call log%line('verdict: sound')
      if (self%gauges) call log%line('  peaks at gauges are not judged: those behind steep '// &
                                     'fronts follow the cells (sgmp-view error)')
    end if
    do r = 1, size(reasons)
      call log%warning('verdict: '//self%opinion%word()//': '//expected(self%opinion, r)// &
                       trim(reasons(r)))
    end do
  end subroutine verdict_report

  !> Of what a coarse run is expected to be wrong, in front of its reason.
  pure function expected(opinion, r) result(text)
    type(opinion_t), intent(in) :: opinion
    integer, intent(in) :: r
    character(:), allocatable :: text
    text = ''
    if (size(opinion%doubts) > 0) return
    text = 'expect errors of '//integer_text(ceiling(100.0_dp*opinion%errors(r) - 1.0e-9_dp))// &
           ' %: '
  end function expected

  pure function thinnest(self) result(text)
    type(verdict_t), intent(in) :: self
    character(:), allocatable :: text
    text = ''
    if (self%thickness < huge(1.0_dp)) then
      text = "; thinnest body '"//self%thinnest//"': "//real_text_about(self%thickness)//' cells'
    end if
  end function thinnest

  !> The same for summary.json.
  subroutine verdict_summarise(self, summary)
    class(verdict_t), intent(in) :: self
    type(summary_t), intent(inout) :: summary
    call summary%set('verdict', self%opinion%word())
    call summary%set('verdict_reasons', self%opinion%reasons())
    if (size(self%opinion%doubts) == 0) then
      call summary%set('verdict_error', self%opinion%error())
    end if
    call summary%set('end_state.contact_share', self%contact)
    call summary%set('end_state.viscous_share', self%viscous)
    call summary%set('end_state.projection_share', self%projection)
    call summary%set('end_state.shortest_step', self%steps(1))
    call summary%set('end_state.longest_step', self%steps(2))
    call summary%set('end_state.limited_by', trim(self%limited_by))
    if (self%thickness < huge(1.0_dp)) then
      call summary%set('end_state.thinnest_body_cells', self%thickness)
      call summary%set('end_state.thinnest_body', self%thinnest)
    end if
    if (.not. self%looked) return
    call summary%set('end_state.lost_impulse', self%impulse)
    if (self%failure >= 0.0_dp) call summary%set('end_state.failure_share', self%failure)
    if (self%heat >= 0.0_dp) call summary%set('end_state.softened_share', self%heat)
    if (self%stressed >= 0.0_dp) call summary%set('end_state.strain_time', self%stressed)
    if (self%turn >= 0.0_dp) call summary%set('end_state.angular_momentum_change', self%turn)
    associate (found => self%state)
      call summary%set('end_state.largest_compression', found%compression)
      call summary%set('end_state.largest_expansion', found%expansion)
      call summary%set('end_state.least_particles_per_cell', found%per_cell)
      call summary%set('end_state.particles_larger_than_a_cell', found%stretched)
      call summary%set('end_state.particles_out_of_reach', found%separated)
      call summary%set('end_state.particles_inside_other_bodies', found%inside)
      call summary%set('end_state.gaps', found%gaps)
      call summary%set('end_state.volume_without_room', found%excess)
      if (found%room > 0.0_dp) call summary%set('end_state.volume_over_box', found%room)
      if (found%reached > 0.0_dp) call summary%set('end_state.box_reached', found%reached)
      call summary%set('end_state.least_pressure', found%pressure(1))
      call summary%set('end_state.largest_pressure', found%pressure(2))
    end associate
  end subroutine verdict_summarise

end module sgmp_verdict
