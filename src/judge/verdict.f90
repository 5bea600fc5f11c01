!> The verdict on a run: whether what it left behind can be sound, and if not, why (doc/verdict.md).
!!
!! Every criterion looks at the state at the end and at sums that the run has kept anyway; nothing
!! of it costs anything in the time loop. Each has a deck in tests/regression/verdict.py that trips
!! it.
module sgmp_verdict
  use sgmp_absorbing_doubts, only: absorbing_objections
  use sgmp_angular_momentum, only: angular_momentum_of, angular_momentum_t
  use sgmp_constitutive, only: eos_none
  use sgmp_end_state, only: end_state_t, end_state_take
  use sgmp_energy, only: ledger_drift
  use sgmp_energy_terms, only: terms_value
  use sgmp_errors, only: error_t, exit_stopped
  use sgmp_features, only: features_remedy_stretched
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_any
  use sgmp_run_log, only: log_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: combine_union, shape_block, shape_cylinder, shape_ring, shape_t
  use sgmp_spelling, only: string_t
  use sgmp_stages, only: stage_objection
  use sgmp_summary, only: summary_t
  use sgmp_text, only: integer_text, real_text
  use sgmp_time_step, only: limit_names
  use sgmp_turn, only: infinite_length
  use sgmp_wall_doubts, only: wall_objections
  implicit none
  private
  public :: verdict_t, body_thickness

  ! What a sound run stays within.
  real(dp), parameter :: largest_gain = 0.05_dp        !! drift of the energy upwards
  real(dp), parameter :: largest_loss = 0.25_dp        !! and downwards
  real(dp), parameter :: largest_gift = 0.05_dp        !! negative internal energy
  real(dp), parameter :: largest_room = 1.05_dp        !! sum of volumes over a closed box
  real(dp), parameter :: least_room = 0.9_dp           !! the same, where gas has reached all of it
  real(dp), parameter :: largest_excess = 0.1_dp       !! part of the volume without room
  real(dp), parameter :: largest_separated = 0.01_dp   !! part of a body
  real(dp), parameter :: largest_inside = 0.001_dp     !! part of a body inside one that it touches
  real(dp), parameter :: largest_gaps = 1.0_dp/3.0_dp  !! of a cell, over the cells with particles
  real(dp), parameter :: largest_stretched = 0.01_dp   !! part of the particles larger than a cell
  real(dp), parameter :: largest_compression = 30.0_dp  !! density over the initial one, of a gas
  real(dp), parameter :: largest_condensed = 3.0_dp    !! of other matter: no shock reaches more
  real(dp), parameter :: largest_collapse = 20.0_dp    !! longest step over shortest
  real(dp), parameter :: largest_eroded = 0.05_dp      !! part of the mass
  real(dp), parameter :: largest_turn = 0.05_dp        !! change of angular momentum over the first
  real(dp), parameter :: least_turn = 0.1_dp           !! that over what the motion could have
  real(dp), parameter :: largest_impulse = 1.0e-4_dp   !! lost, over the largest momentum
  real(dp), parameter :: least_thickness = 2.0_dp      !! cells across a body
  real(dp), parameter :: largest_unfelt = 3.0_dp       !! work of forces that particles do not feel

  integer, parameter :: reason_length = 240

  !> What was found, and what of it speaks against the run.
  type :: verdict_t
    private
    logical :: looked = .false.            !! the particles were in a state to be looked at
    type(end_state_t) :: state
    character(reason_length), allocatable :: reasons(:)
    real(dp) :: thickness = huge(1.0_dp)   !! of the thinnest body, in cells
    real(dp) :: drift = 0.0_dp, contact = 0.0_dp, viscous = 0.0_dp  !! parts of the energy supplied
    real(dp) :: projection = 0.0_dp        !! energy that projection loses, over the same
    real(dp) :: turn = -1.0_dp             !! largest change of angular momentum; -1: none is judged
    real(dp) :: impulse = 0.0_dp           !! of forces on nodes without mass
    real(dp) :: steps(2) = 0.0_dp          !! shortest and longest
    character(16) :: limited_by = ''       !! the last one
  contains
    procedure :: reach => verdict_reach
    procedure :: report => verdict_report
    procedure :: summarise => verdict_summarise
    procedure, private :: object
  end type verdict_t

contains

  !> Looks at the end of a run and judges it; all ranks must call it.
  subroutine verdict_reach(self, scene, model, error)
    class(verdict_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(in) :: error  !! what ended the run early
    real(dp) :: supplied
    integer :: b, thinnest
    allocate (self%reasons(0))
    supplied = max(model%ledger%supplied, tiny(1.0_dp))
    self%drift = ledger_drift(model%ledger)
    self%contact = model%ledger%contact_dissipation/supplied
    self%viscous = model%ledger%viscous_dissipation/supplied
    self%projection = model%ledger%interpolation_error/supplied
    self%steps = [model%clock%shortest, model%clock%longest]
    self%limited_by = limit_names(model%clock%limited_by)
    thinnest = 0
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%rigid) cycle
      if (body_thickness(scene%bodies(b)%shapes, model%mesh) >= self%thickness) cycle
      self%thickness = body_thickness(scene%bodies(b)%shapes, model%mesh)
      thinnest = b
    end do
    self%looked = .true.
    if (allocated(error)) self%looked = error%code == exit_stopped
    self%looked = .not. parallel_any(.not. self%looked)
    if (.not. self%looked) then
      if (allocated(error)) call self%object('it failed: '//error%message)
      return
    end if
    call end_state_take(scene, model, self%state)
    call judge_energy(self, model)
    call judge_noise(self, model)
    call judge_erosion(self, model)
    call judge_impulse(self, model)
    call judge_turning(self, scene, model)
    call judge_features(self, model)
    call judge_volumes(self, scene%method%volumes_kept)
    call judge_particles(self, scene, model%findings%lost)
    call judge_resolution(self, scene, thinnest)
  end subroutine verdict_reach

  !> What features find doubtful, each in its own file (src/features/<name>/<name>_doubts.f90).
  subroutine judge_features(self, model)
    type(verdict_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(string_t), allocatable :: reasons(:)
    integer :: r
    if (stage_objection(model) /= '') call self%object(stage_objection(model))
    call wall_objections(model, reasons)
    do r = 1, size(reasons)
      call self%object(reasons(r)%text)
    end do
    call absorbing_objections(model, reasons)
    do r = 1, size(reasons)
      call self%object(reasons(r)%text)
    end do
  end subroutine judge_features

  !> Bodies too thin for the grid, steps that have collapsed.
  subroutine judge_resolution(self, scene, thinnest)
    type(verdict_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: thinnest        !! body
    if (self%thickness < least_thickness) then
      call self%object("body '"//trim(scene%bodies(thinnest)%name)//"' is "// &
                       real_text(self%thickness)//' cells thick: pressures in it are not '// &
                       'resolved; use smaller cells')
    end if
    if (self%steps(2) > largest_collapse*self%steps(1)) then
      call self%object('the time step has shrunk from '//real_text(self%steps(2))//' to '// &
                       real_text(self%steps(1))//': look at the fastest particles')
    end if
  end subroutine judge_resolution

  !> Where a body is damped to rest, forces that nodes receive and no particle feels: noise of the
  !! stress, by which the body becomes too soft (doc/hard-cases.md). Bodies that move have such
  !! forces, too, without harm; and so have those whose strains are corrected at surfaces.
  subroutine judge_noise(self, model)
    type(verdict_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    if (.not. model%method%damped .or. model%method%flip < 1.0_dp) return
    if (model%method%surfaces) return
    if (model%ledger%damped_share <= largest_unfelt) return
    call self%object('nodes push with forces that no particle feels: projection has lost '// &
                     real_text(model%ledger%damped_share)//' times the energy that the '// &
                     'scene was given, so stress is noise in part and bodies are too soft: '// &
                     'use method bspline, half the cfl or more particles per cell')
  end subroutine judge_noise

  !> Energy from nowhere, or gone.
  subroutine judge_energy(self, model)
    type(verdict_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    real(dp) :: given
    integer :: b
    if (self%drift > largest_gain) then
      call self%object('the energy has grown by '//percent(self%drift)// &
                       ' of what the scene was given: reduce cfl')
    else if (self%drift < -largest_loss) then
      call self%object(percent(-self%drift)//' of the energy that the scene was given is gone, '// &
                       'not into contact: use update=musl, smaller cells')
    end if
    do b = 1, size(model%bodies)
      ! Elastic energy is never negative, plastic work neither; an equation of state has its own.
      if (model%bodies(b)%rigid .or. model%bodies(b)%law%eos /= eos_none) cycle
      given = -(model%totals%bodies(b)%internal + model%totals%bodies(b)%taken)
      if (given <= largest_gift*model%ledger%supplied) cycle
      call self%object("body '"//trim(model%bodies(b)%name)//"' has given away energy that it "// &
                       'never had, '//percent(given/model%ledger%supplied)//' of what the '// &
                       'scene was given: soil that dilates (reduce dilatancy), or an elastic '// &
                       'law far beyond small strains')
    end do
  end subroutine judge_energy

  !> Mass and energy that erosion has taken away from what would have been hit or held by them, and
  !! bodies of which it has left nothing.
  subroutine judge_erosion(self, model)
    type(verdict_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    real(dp) :: all, mass, energy
    integer :: b
    associate (terms => model%ledger%terms)
      if (terms_value(terms, 'eroded.particles') <= 0.0_dp) return
      mass = terms_value(terms, 'eroded.mass')
      energy = (terms_value(terms, 'eroded.kinetic_energy') + &
                terms_value(terms, 'eroded.internal_energy'))/ &
               max(model%ledger%supplied, tiny(1.0_dp))
      all = mass + sum(model%totals%bodies%mass, mask=.not. model%bodies%rigid)
      if (mass > largest_eroded*all) then
        call self%object(percent(mass/all)//' of the mass was eroded: what it would '// &
                         'have pushed or stopped is not in the result; raise the limits of erode')
      else if (energy > largest_eroded) then
        call self%object(percent(energy)//' of the energy that the scene was given was '// &
                         'eroded: what it would have done is not in the result; raise the '// &
                         'limits of erode')
      end if
    end associate
    do b = 1, size(model%bodies)
      if (model%totals%particles(b) > 0 .or. model%bodies(b)%rigid) cycle
      if (model%clock%time >= model%bodies(b)%removed_at) cycle
      call self%object("erosion has left nothing of body '"//trim(model%bodies(b)%name)// &
                       "': what it would have hit was not hit; raise the limits of erode")
    end do
  end subroutine judge_erosion

  !> Forces that moved nothing, for they acted on nodes without mass: momentum is not kept.
  subroutine judge_impulse(self, model)
    type(verdict_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    real(dp) :: momentum
    self%impulse = model%ledger%lost_impulse
    momentum = sqrt(2.0_dp*sum(model%totals%bodies%mass, mask=.not. model%bodies%rigid)* &
                    model%ledger%largest_kinetic)
    if (.not. self%impulse > largest_impulse*momentum) return
    call self%object('forces acted on grid points without mass and moved nothing, an impulse '// &
                     'of '//percent(self%impulse/max(momentum, tiny(1.0_dp)))//' of the '// &
                     'largest momentum: particles lie on the faces of cells; shift the body '// &
                     'or the grid by a part of a cell')
  end subroutine judge_impulse

  !> Angular momentum that nothing acts on, and yet has changed.
  subroutine judge_turning(self, scene, model)
    type(verdict_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(angular_momentum_t) :: now
    character(:), allocatable :: remedy
    real(dp) :: change
    integer :: f
    if (model%findings%lost > 0) return
    remedy = '; use smaller cells or cfl'
    if (.not. scene%method%rotation) remedy = '; method sgmp rotation=exact keeps it'
    do f = 1, size(model%fields)
      associate (before => model%turning(f))
        if (norm2(before%vector) <= least_turn*before%largest) cycle
        call angular_momentum_of(model%mesh, model%bodies, model%totals%bodies, f, now)
        change = norm2(now%vector - before%vector)/norm2(before%vector)
        self%turn = max(self%turn, change)
        if (.not. change > largest_turn) cycle
        call self%object("the angular momentum of body '"// &
                         trim(model%bodies(findloc(model%bodies%field, f, 1))%name)// &
                         "' has changed by "//percent(change)//', though nothing acts on it'// &
                         remedy)
      end associate
    end do
  end subroutine judge_turning

  !> Volumes that sum to more or less than the room that there is.
  subroutine judge_volumes(self, kept)
    type(verdict_t), intent(inout) :: self
    logical, intent(in) :: kept            !! by the method
    character(:), allocatable :: remedy
    associate (found => self%state)
      remedy = ''
      if (found%gas .and. .not. kept) remedy = '; for enclosed gas use method sgmp volumes=kept'
      if (found%room > largest_room) then
        call self%object("the particles' volumes sum to "//real_text(found%room)// &
                         ' times the closed box: they have drifted'//remedy)
      else if (found%gas .and. found%reached > least_room .and. &
               found%room < least_room*found%reached) then
        call self%object("the particles' volumes sum to "//real_text(found%room)// &
                         ' times the closed box, '//percent(found%reached)//' of which they '// &
                         'have reached: they have drifted, and the pressure with them'//remedy)
      end if
      if (found%excess > largest_excess) then
        call self%object(percent(found%excess)//" of the particles' volume has no room in the "// &
                         'cells around them: volumes have drifted, or neighbours are gone'// &
                         remedy)
      end if
    end associate
  end subroutine judge_volumes

  !> Particles that no longer stand for the space around them.
  subroutine judge_particles(self, scene, lost)
    type(verdict_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: lost            !! particles that have left the grid
    character(:), allocatable :: remedy
    remedy = features_remedy_stretched(scene%features)
    associate (found => self%state)
      if (found%particles == 0 .and. lost > 0) then
        call self%object('no particle is left: all have left the grid; enlarge it, or end earlier')
      end if
      if (found%separated_part > largest_separated) then
        call self%object(percent(found%separated_part)//" of body '"// &
                         trim(scene%bodies(found%separated_body)%name)// &
                         "' is out of reach of the rest, though its material does not fail: "// &
                         'numerical fracture'//remedy)
      end if
      if (found%inside_part > largest_inside) then
        call self%object(percent(found%inside_part)//" of body '"// &
                         trim(scene%bodies(found%inside_bodies(1))%name)//"' is inside body '"// &
                         trim(scene%bodies(found%inside_bodies(2))%name)// &
                         "': contact has not kept it out; use smaller cells or cfl")
      end if
      if (found%gaps > largest_gaps .and. .not. found%separated_part > largest_separated) then
        call self%object("cells of body '"//trim(scene%bodies(found%gaps_body)%name)// &
                         "' between others have no particle, "//percent(found%gaps)// &
                         ' of those that have: it is stretched beyond its particles'//remedy)
      end if
      if (found%stretched > largest_stretched*found%particles) then
        call self%object(integer_text(found%stretched)//' particles are larger than a cell: '// &
                         'they leave gaps between them'//remedy)
      end if
      if (found%compression > largest_compression .or. found%condensed > largest_condensed) then
        call self%object('material is '//real_text(found%compression)// &
                         ' times as dense as at the start: it has collapsed, or is pressed '// &
                         'into fewer cells than resolve it')
      end if
    end associate
  end subroutine judge_particles

  !> Adds a reason.
  subroutine object(self, reason)
    class(verdict_t), intent(inout) :: self
    character(*), intent(in) :: reason
    self%reasons = [character(reason_length) :: self%reasons, reason]
  end subroutine object

  !> Closing lines of the log: what was found, then the verdict; doubts are warnings.
  subroutine verdict_report(self, log)
    class(verdict_t), intent(in) :: self
    type(log_t), intent(inout) :: log
    integer :: r
    if (self%looked .and. self%state%particles > 0) then
      associate (found => self%state)
        call log%line('density up to '//real_text(found%compression)//' times, volume up to '// &
                      real_text(found%expansion)//' times the initial one; pressure '// &
                      real_text(found%pressure(1))//' to '//real_text(found%pressure(2)))
        call log%line('at least '//real_text(found%per_cell)//' particles per cell, '// &
                      integer_text(found%separated)//' out of reach of their bodies, '// &
                      percent(found%excess)//' of their volume without room'//thinnest(self))
      end associate
    end if
    call log%line('energy: drift '//percent(self%drift)//', contact '//percent(self%contact)// &
                  ', viscosity '//percent(self%viscous)//' of what the scene was given; steps '// &
                  real_text(self%steps(1))//' to '//real_text(self%steps(2))// &
                  ', last limited by '//trim(self%limited_by))
    if (size(self%reasons) == 0) call log%line('verdict: sound')
    do r = 1, size(self%reasons)
      call log%warning('verdict: doubtful: '//trim(self%reasons(r)))
    end do
  end subroutine verdict_report

  pure function thinnest(self) result(text)
    type(verdict_t), intent(in) :: self
    character(:), allocatable :: text
    text = ''
    if (self%thickness < huge(1.0_dp)) then
      text = '; thinnest body '//real_text(self%thickness)//' cells'
    end if
  end function thinnest

  !> The same for summary.json.
  subroutine verdict_summarise(self, summary)
    class(verdict_t), intent(in) :: self
    type(summary_t), intent(inout) :: summary
    call summary%set('verdict', trim(merge('sound   ', 'doubtful', size(self%reasons) == 0)))
    call summary%set('verdict_reasons', self%reasons)
    call summary%set('end_state.contact_share', self%contact)
    call summary%set('end_state.viscous_share', self%viscous)
    call summary%set('end_state.projection_share', self%projection)
    call summary%set('end_state.shortest_step', self%steps(1))
    call summary%set('end_state.longest_step', self%steps(2))
    call summary%set('end_state.limited_by', trim(self%limited_by))
    if (self%thickness < huge(1.0_dp)) then
      call summary%set('end_state.thinnest_body_cells', self%thickness)
    end if
    if (.not. self%looked) return
    call summary%set('end_state.lost_impulse', self%impulse)
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

  !> Cells across the thinnest of the shapes that a body unites; huge where that has no end, or the
  !! shape is unknown. A wall continues a body that touches it, two walls without end.
  pure function body_thickness(shapes, mesh) result(cells)
    type(shape_t), allocatable, intent(in) :: shapes(:)
    type(mesh_t), intent(in) :: mesh
    real(dp) :: cells
    real(dp) :: thinnest
    integer :: s
    cells = huge(1.0_dp)
    if (.not. allocated(shapes)) return
    thinnest = infinite_length
    do s = 1, size(shapes)
      if (shapes(s)%combine == combine_union) then
        thinnest = min(thinnest, shape_thickness(shapes(s), mesh))
      end if
    end do
    if (thinnest < infinite_length) cells = thinnest/mesh%h
  end function body_thickness

  !> Least distance between opposite surfaces of a shape.
  pure function shape_thickness(shape, mesh) result(thickness)
    type(shape_t), intent(in) :: shape
    type(mesh_t), intent(in) :: mesh
    real(dp) :: thickness, across
    integer :: axis
    thickness = huge(1.0_dp)
    select case (shape%kind)
    case (shape_block)
      do axis = 1, mesh%ndim
        across = shape%upper(axis) - shape%lower(axis)
        if (at_wall(mesh, 1, axis, shape%lower(axis))) across = 2.0_dp*across
        if (at_wall(mesh, 2, axis, shape%upper(axis))) then
          across = merge(huge(1.0_dp), 2.0_dp*across, at_wall(mesh, 1, axis, shape%lower(axis)))
        end if
        thickness = min(thickness, across)
      end do
    case (shape_ring)
      thickness = shape%radius - shape%radius2
    case (shape_cylinder)
      thickness = 2.0_dp*shape%radius
      if (mesh%ndim == 3) thickness = min(thickness, shape%length)
    case default
      if (shape%radius > 0.0_dp) thickness = 2.0_dp*shape%radius
    end select
  end function shape_thickness

  !> Whether a coordinate lies on a wall, but for a hundredth of a cell.
  pure function at_wall(mesh, side, axis, x) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: side, axis
    real(dp), intent(in) :: x
    logical :: yes
    integer :: node
    node = merge(mesh%lower(axis), mesh%upper(axis), side == 1)
    yes = mesh%wall(side, axis) /= wall_free
    if (yes) yes = abs(mesh%origin(axis) + node*mesh%h - x) < 0.01_dp*mesh%h
  end function at_wall

  pure function percent(part) result(text)
    real(dp), intent(in) :: part
    character(:), allocatable :: text
    character(24) :: number
    write (number, '(f24.2)') max(-1.0e12_dp, min(1.0e12_dp, 100.0_dp*part))
    text = trim(adjustl(number))//' %'
  end function percent

end module sgmp_verdict
