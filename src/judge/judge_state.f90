!> What the particles at the end of a run, its bodies' thickness and its steps say about it
!! (doc/verdict.md).
module sgmp_judge_state
  use sgmp_end_state, only: end_state_t
  use sgmp_features, only: features_remedy_stretched
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_space, only: space_axisymmetric
  use sgmp_text, only: integer_text, percent_text, real_text, real_text_about
  implicit none
  private
  public :: judge_ball, judge_particles, judge_pressed, judge_resolution, judge_thin, judge_volumes

  ! What a sound run stays within.
  real(dp), parameter :: largest_room = 1.05_dp        !! sum of volumes over a closed box
  real(dp), parameter :: least_room = 0.9_dp           !! the same, where gas has reached all of it
  real(dp), parameter :: largest_excess = 0.18_dp      !! part of the volume without room
  real(dp), parameter :: largest_separated = 0.01_dp   !! part of a body
  real(dp), parameter :: largest_inside = 0.001_dp     !! part of a body inside one that it touches
  real(dp), parameter :: largest_gaps = 1.0_dp/3.0_dp  !! of a cell, over the cells with particles
  real(dp), parameter :: largest_stretched = 0.01_dp   !! part of the particles larger than a cell
  real(dp), parameter :: largest_thinned = 0.25_dp     !! the same of gas, which fans thin out
  real(dp), parameter :: gap_error = 0.1_dp            !! what fans with gaps are wrong by
  real(dp), parameter :: mpm_gap_error = 0.3_dp        !! with method mpm
  real(dp), parameter :: largest_compression = 30.0_dp  !! density over the initial one, of a gas
  real(dp), parameter :: kept_compression = 60.0_dp    !! of one whose volumes are kept: 32 is true
  real(dp), parameter :: largest_condensed = 3.0_dp    !! of other matter: no shock reaches more
  real(dp), parameter :: largest_collapse = 20.0_dp    !! longest step over shortest
  real(dp), parameter :: least_thickness = 2.0_dp      !! cells across a body

  ! What makes numbers inexact, and by how much (doc/verdict.md).
  real(dp), parameter :: coarse_room = 0.02_dp         !! of the box that gas has reached
  real(dp), parameter :: coarse_excess = 0.1_dp        !! part of the volume without room
  real(dp), parameter :: boxed_excess = 0.025_dp       !! the same of gas that has reached its box
  real(dp), parameter :: room_error = 0.25_dp
  real(dp), parameter :: mpm_compression = 1.05_dp     !! density over the initial one
  real(dp), parameter :: mpm_error = 0.4_dp
  real(dp), parameter :: usf_change = 1.05_dp          !! density or volume over the initial one
  real(dp), parameter :: usf_error = 0.15_dp           !! of pressures, first order in the step
  real(dp), parameter :: foam_compression = 1.05_dp
  real(dp), parameter :: foam_error = 0.15_dp
  real(dp), parameter :: plain_thickness = 8.0_dp      !! cells, of plain sgmp
  real(dp), parameter :: thin_thickness = 4.01_dp      !! of other methods
  real(dp), parameter :: thin_error = 0.15_dp
  real(dp), parameter :: ball_thickness = 13.0_dp      !! cells across a ball, of sgmp
  real(dp), parameter :: small_ball = 10.0_dp          !! of other methods
  real(dp), parameter :: ball_error = 0.1_dp

contains

  !> Volumes that sum to more or less than the room that there is.
  subroutine judge_volumes(opinion, found, kept)
    type(opinion_t), intent(inout) :: opinion
    type(end_state_t), intent(in) :: found
    logical, intent(in) :: kept            !! by the method
    character(:), allocatable :: reason, remedy
    remedy = ''
    if (found%gas .and. .not. kept) remedy = '; for enclosed gas use method sgmp volumes=kept'
    if (found%room > largest_room) then
      call opinion%object("the particles' volumes sum to "//real_text(found%room)// &
                         ' times the closed box: they have drifted'//remedy)
    else if (found%gas .and. found%reached > least_room .and. &
               found%room < least_room*found%reached) then
      call opinion%object("the particles' volumes sum to "//real_text(found%room)// &
                         ' times the closed box, '//percent_text(found%reached)// &
                         ' of which they have reached: they have drifted, and the '// &
                         'pressure with them'//remedy)
    end if
    reason = percent_text(found%excess)//" of the particles' volume has no room in the cells "// &
             'around them: volumes have drifted, or neighbours are gone'//remedy
    if (found%excess > largest_excess) then
      call opinion%object(reason)
    else if (found%excess > coarse_excess) then
      call opinion%expect(room_error, reason)
    end if
    call expect_room(opinion, found, kept, remedy)
  end subroutine judge_volumes

  !> Volumes of gas that miss the room a little.
  subroutine expect_room(opinion, found, kept, remedy)
    type(opinion_t), intent(inout) :: opinion
    type(end_state_t), intent(in) :: found
    logical, intent(in) :: kept            !! by the method
    character(*), intent(in) :: remedy
    if (.not. found%gas .or. .not. found%room > 0.0_dp .or. found%reached < least_room) return
    if (abs(found%room/found%reached - 1.0_dp) > coarse_room .or. &
        (found%excess > boxed_excess .and. .not. kept)) then
      call opinion%expect(room_error, "the particles' volumes sum to "//real_text(found%room)// &
                          ' times the closed box, and '//percent_text(found%excess)// &
                          ' of them has no room in its cells: pressures have drifted'//remedy)
    end if
  end subroutine expect_room

  !> Particles that no longer stand for the space around them.
  subroutine judge_particles(opinion, found, scene, lost, mpm)
    type(opinion_t), intent(inout) :: opinion
    type(end_state_t), intent(in) :: found
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: lost            !! particles that have left the grid
    logical, intent(in) :: mpm             !! it is the method
    character(:), allocatable :: reason, remedy
    remedy = features_remedy_stretched(scene%features)
    if (found%particles == 0 .and. lost > 0) then
      call opinion%object('no particle is left: all have left the grid; enlarge it, or '// &
                         'end earlier')
    end if
    if (found%separated_part > largest_separated) then
      call opinion%object(percent_text(found%separated_part)//" of body '"// &
                         trim(scene%bodies(found%separated_body)%name)// &
                         "' is out of reach of the rest, though its material does not fail: "// &
                         'numerical fracture'//remedy)
    end if
    if (found%inside_part > largest_inside) then
      call opinion%object(percent_text(found%inside_part)//" of body '"// &
                         trim(scene%bodies(found%inside_bodies(1))%name)//"' is inside body '"// &
                         trim(scene%bodies(found%inside_bodies(2))%name)// &
                         "': contact has not kept it out; use smaller cells or cfl"//remedy)
    end if
    if (found%gaps > largest_gaps .and. .not. found%separated_part > largest_separated) then
      call opinion%object("cells of body '"//trim(scene%bodies(found%gaps_body)%name)// &
                         "' between others have no particle, "//percent_text(found%gaps)// &
                         ' of those that have: it is stretched beyond its particles'//remedy)
    end if
    if (found%stretched > largest_stretched*found%particles) then
      reason = integer_text(found%stretched)//' of '//integer_text(found%particles)// &
                 ' particles are larger than a cell: they leave gaps between them'//remedy
      if (found%stretched - found%thinned > largest_stretched*found%particles .or. &
            found%thinned > largest_thinned*found%particles) then
        call opinion%object(reason)
      else
        call opinion%expect(merge(mpm_gap_error, gap_error, mpm), reason)
      end if
    end if
    if (found%condensed > largest_condensed .or. &
        found%compression > merge(kept_compression, largest_compression, &
                                  scene%method%volumes_kept)) then
      call opinion%object('material is '//real_text(found%compression)// &
                         ' times as dense as at the start: it has collapsed, or is pressed '// &
                         'into fewer cells than resolve it')
    end if
  end subroutine judge_particles

  !> What the method makes inexact where matter is pressed together (make truth).
  subroutine judge_pressed(opinion, found, mpm, usf)
    type(opinion_t), intent(inout) :: opinion
    type(end_state_t), intent(in) :: found
    logical, intent(in) :: mpm, usf        !! it is the method, the update
    if (usf .and. found%gas .and. max(found%compression, found%expansion) > usf_change) then
      call opinion%expect(usf_error, 'gas or explosive with update=usf: its energy is of first '// &
                          'order in the step, and pressures come out too high; use update=musl')
    end if
    if (mpm .and. found%compression > mpm_compression) then
      call opinion%expect(mpm_error, 'material is '//real_text(found%compression)// &
                          ' times as dense as at the start, and stresses of mpm jump where '// &
                          'particles change cells: use method sgmp, gimp or bspline')
    end if
    if (found%crushed > foam_compression) then
      call opinion%expect(merge(mpm_error, foam_error, mpm), &
                          'foam was crushed to '//real_text(found%crushed)// &
                          ' times its density: noise of the strains takes it off its yield '// &
                          'surface, and it is too weak; use smaller cells, viscosity linear=1')
    end if
  end subroutine judge_pressed

  !> A ball that has few cells for the method, in space or about the axis.
  subroutine judge_ball(opinion, model, body, thickness)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    integer, intent(in) :: body            !! the thinnest ball; 0: none
    real(dp), intent(in) :: thickness      !! its own, in cells
    if (body == 0 .or. model%mesh%ndim == 1 .or. model%mesh%space == 2) return
    if (thickness < merge(ball_thickness, small_ball, kernel_centred(model%fields(1)%kernel))) then
      call opinion%expect(ball_error, thin_text(model, body, thickness)// &
                          ', and a ball: use smaller cells')
    end if
  end subroutine judge_ball

  !> A solid that has few cells for the method: surfaces that lie at an angle to the grid.
  subroutine judge_thin(opinion, model, body, thickness)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    integer, intent(in) :: body            !! the thinnest solid; 0: none
    real(dp), intent(in) :: thickness      !! its own, in cells
    if (body == 0 .or. model%mesh%ndim == 1) return
    if (model%fields(model%bodies(body)%field)%columns%corrected) return
    if (kernel_centred(model%fields(1)%kernel) .and. thickness < plain_thickness .and. &
        model%mesh%space /= space_axisymmetric) then
      call opinion%expect(thin_error, thin_text(model, body, thickness)//', and plain strains '// &
                          'of sgmp are wrong at surfaces that cut cells: use smaller cells, or '// &
                          'surfaces=corrected where the scene allows it')
    else if (thickness < thin_thickness) then
      call opinion%expect(thin_error, thin_text(model, body, thickness)//': use smaller cells')
    end if
  end subroutine judge_thin

  !> How thick a body is, in words.
  function thin_text(model, body, thickness) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: body
    real(dp), intent(in) :: thickness      !! in cells
    character(:), allocatable :: text
    text = "body '"//trim(model%bodies(body)%name)//"' is "//real_text_about(thickness)// &
           ' cells thick'
  end function thin_text

  !> Bodies too thin for the grid, steps that have collapsed.
  subroutine judge_resolution(opinion, name, thickness, steps)
    type(opinion_t), intent(inout) :: opinion
    character(*), intent(in) :: name       !! of the thinnest body
    real(dp), intent(in) :: thickness      !! its own, in cells
    real(dp), intent(in) :: steps(2)       !! shortest and longest
    if (thickness < least_thickness*(1.0_dp - 1.0e-9_dp)) then
      call opinion%object("body '"//trim(name)//"' is "// &
                       real_text_about(thickness)//' cells thick: pressures in it are not '// &
                       'resolved; use smaller cells')
    end if
    if (steps(2) > largest_collapse*steps(1)) then
      call opinion%object('the time step has shrunk from '//real_text(steps(2))//' to '// &
                       real_text(steps(1))//': look at the fastest particles')
    end if
  end subroutine judge_resolution

end module sgmp_judge_state
