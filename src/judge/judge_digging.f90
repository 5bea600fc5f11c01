!> What bodies that have made their way into a metal that flows say about a run (doc/verdict.md).
!!
!! Cells as wide as a part of what digs in cannot follow how the metal makes way: it flows around it
!! as around a body that is wider by about a cell on each side, though it touches it where it
!! should, and bears too much. A rigid rod of 4, 8, 16, 32 cells across with a round nose, 500 m/s
!! into aluminium of constant strength: 126, 44, 16 and 6 % more force than that to which these
!! converge (sgmp; gimp and mpm likewise), half as much in the plane. Of the resistance that is the
!! part by strength, some five times the yield stress; what a jet meets is inertia. What is not held
!! loses depth: an ogive that is shot into aluminium 21 and 8 % with 8 and 16 cells, a long rod that
!! flows itself 21 and 5 %. Where metal fails the way is judged by judge_projectiles, at flat faces
!! that press on it by judge_punches.
module sgmp_judge_digging
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: law_is_metal, law_is_spherical, law_yield_stress
  use sgmp_fast_scenes, only: speed_at_start
  use sgmp_judge_collisions, only: projectile_fastest
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_meetings, only: meetings_push
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_tally, only: tally_add, tally_reset, tally_t, tally_total
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: body_thickness
  implicit none
  private
  public :: judge_digging

  real(dp), parameter :: weight = 12.5_dp, power = -1.6_dp  !! of the error over cells across
  real(dp), parameter :: plane_part = 0.5_dp     !! of it where it is wider along one axis only
  real(dp), parameter :: resistance = 5.0_dp     !! by strength, over the yield stress of what flows
  real(dp), parameter :: slower = 0.5_dp         !! speed of the way, of that at the start
  real(dp), parameter :: least_told = 0.05_dp, least_error = 0.1_dp, most_error = 0.5_dp
  real(dp), parameter :: flown = 1.0_dp          !! plastic strain of what has flowed around it
  real(dp), parameter :: deep = 0.25_dp          !! volume of that, over its width cubed
  real(dp), parameter :: narrow = 0.75_dp        !! its width, of that of the solid, along axes
  real(dp), parameter :: across = 0.7_dp         !! that have no larger part of the push

contains

  !> Pairs of solids of which one has gone into the other, a metal; all ranks must call it.
  subroutine judge_digging(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    real(dp) :: cells, error
    integer :: p, side, b, t, axes
    if (model%mesh%ndim == 1) return
    axes = merge(3, model%mesh%ndim, scene%axisymmetric)
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (.not. norm2(pair%impulse) > 0.0_dp .or. any(pair%body > size(scene%bodies))) cycle
        do side = 1, 2
          b = pair%body(side)
          t = pair%body(3 - side)
          if (.not. may_dig(scene, model, b, t, meetings_push(model, pair))) cycle
          cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
          error = force_error(scene, model, b, t, cells)
          if (.not. pair%held(side) .or. model%bodies(b)%rigid_motion%free) then
            error = error/(1.0_dp + error)
          end if
          if (error < least_told) cycle
          if (flown_volume(model%bodies(t), model%mesh%ndim) < &
              deep*(cells*model%mesh%h)**axes) cycle
          text = "body '"//trim(model%bodies(b)%name)//"', "//real_text_about(cells)// &
                 " cells across, has made its way into '"//trim(model%bodies(t)%name)// &
                 "', which flows around it as around a body that is a cell wider on each "// &
                 'side: forces are too large, depths too small; use smaller cells'
          if (error > most_error) then
            call opinion%object(text)
          else
            call opinion%expect(max(error, least_error), text)
          end if
          return
        end do
      end associate
    end do
  end subroutine judge_digging

  !> Part by which the force on what digs in is too large.
  pure function force_error(scene, model, b, t, cells) result(error)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b, t                  !! what digs in, and into what
    real(dp), intent(in) :: cells                !! across what digs in
    real(dp) :: error, strength, inertia, speed
    integer :: n
    n = model%mesh%ndim
    speed = max(speed_at_start(scene, b, n), speed_at_start(scene, t, n))
    if (model%bodies(b)%rigid) speed = max(speed, norm2(model%bodies(b)%speed))
    strength = resistance*law_yield_stress(model%bodies(t)%law, flown)
    inertia = 0.5_dp*model%bodies(t)%law%density*(slower*speed)**2
    error = weight*cells**power*strength/max(strength + inertia, tiny(1.0_dp))
    if (n == 2 .and. .not. scene%axisymmetric) error = plane_part*error
  end function force_error

  !> Whether a body, solid and narrower than the other across a push, may dig into that one, a
  !! metal, no faster than a projectile does.
  pure logical function may_dig(scene, model, b, t, push) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b, t                  !! what digs in, and into what
    real(dp), intent(in) :: push(3)
    real(dp) :: own(3, 2), its(3, 2)
    integer :: d, n
    n = model%mesh%ndim
    associate (law => model%bodies(t)%law)
      yes = law_is_metal(law) .and. law%slots%plastic > 0 .and. .not. law%rigid .and. &
            .not. law_is_spherical(model%bodies(b)%law)
    end associate
    if (yes) yes = allocated(scene%bodies(b)%shapes) .and. allocated(scene%bodies(t)%shapes)
    if (yes) yes = max(speed_at_start(scene, b, n), speed_at_start(scene, t, n)) <= &
                   projectile_fastest(model)
    if (.not. yes) return
    call shapes_box(scene%bodies(b)%shapes, own(:, 1), own(:, 2))
    call shapes_box(scene%bodies(t)%shapes, its(:, 1), its(:, 2))
    if (scene%axisymmetric) own(1, 1) = max(0.0_dp, own(1, 1))
    if (scene%axisymmetric) its(1, 1) = max(0.0_dp, its(1, 1))
    yes = .false.
    do d = 1, n
      if (abs(push(d)) > across*norm2(push)) cycle
      yes = yes .or. own(d, 2) - own(d, 1) < narrow*(its(d, 2) - its(d, 1))
    end do
  end function may_dig

  !> Volume, at the start, of a body's particles that have flowed; all ranks must call it.
  function flown_volume(body, ndim) result(volume)
    type(body_t), intent(in) :: body
    integer, intent(in) :: ndim
    type(tally_t) :: tally
    real(dp) :: volume, total(1)
    integer(i8) :: none(0)
    integer :: c, l
    call tally_reset(tally, 1)
    associate (law => body%law, particles => body%particles)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          if (particles%state(l, law%slots%plastic, c) < flown) cycle
          call tally_add(tally, 1, [particles%motion(l, motion_mass(ndim), c)/law%density])
        end do
      end do
    end associate
    call tally_total(tally, total, none)
    volume = total(1)
  end function flown_volume

end module sgmp_judge_digging
