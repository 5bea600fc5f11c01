!> What is doubtful about edges that let waves out (doc/loads.md) after a run.
module sgmp_absorbing_doubts
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_absorbing
  use sgmp_mesh, only: mesh_find, mesh_t
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_parallel, only: parallel_max
  use sgmp_space, only: axis_names
  use sgmp_text, only: integer_text, real_text
  implicit none
  private
  public :: absorbing_objections

  real(dp), parameter :: largest_way = 1.0_dp  !! cells by which matter at an edge may have moved
  real(dp), parameter :: long = 20.0_dp        !! times of sound across the grid: what then still
                                               !! moves in a fluid is slow
  real(dp), parameter :: little = 0.05_dp      !! of the distance from the source, by which a fluid
                                               !! may move that feels what lies beyond its edge, or
                                               !! whose pressure is held all around
  real(dp), parameter :: still = 1.0e-3_dp     !! part of the largest kinetic energy

contains

  !> Edges that have moved: what pushes them without end they do not hold. All ranks must call it.
  subroutine absorbing_objections(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    real(dp) :: moved(2, 3)
    integer :: axis, b, side
    moved = 0.0_dp
    do b = 1, size(model%bodies)
      if (model%bodies(b)%absorbs) call look_at(model%mesh, model%bodies(b), moved)
    end do
    do axis = 1, model%mesh%ndim
      do side = 1, 2
        if (.not. model%mesh%absorbs(side, axis)) cycle
        moved(side, axis) = parallel_max(moved(side, axis))
        if (moved(side, axis) <= largest_way) cycle
        call opinion%object('material at the absorbing edge '// &
                            axis_names(axis, model%mesh%space)//merge('-', '+', side == 1)// &
                            ' has moved by '//real_text(moved(side, axis))//' cells across it: '// &
                            'such an edge holds nothing but the stress at the start '// &
                            '(doc/loads.md); hold what bears a load for long elsewhere, or put '// &
                            'the edge further away')
      end do
    end do
    if (model%mesh%ndim > 1 .and. holds_slow_flow(model)) then  ! on a line dashpots are exact
      call opinion%object('a fluid still moves after sound has crossed the grid '// &
                          integer_text(nint(crossings(model)))//' times: absorbing edges hold '// &
                          'slow flow far more than the fluid beyond them would, a bubble '// &
                          'hardly breathes (doc/loads.md); write where its source is, '// &
                          'wall … centre=')
    end if
  end subroutine absorbing_objections

  !> Whether edges without a source have slow flow of a fluid to let out.
  pure function holds_slow_flow(model) result(yes)
    type(model_t), intent(in) :: model
    logical :: yes
    yes = crossings(model) > long .and. &
          model%ledger%kinetic > still*model%ledger%largest_kinetic
  end function holds_slow_flow

  !> How often sound in a fluid that ends at edges without a source has crossed the grid; 0: there
  !! is no such fluid.
  pure function crossings(model) result(times)
    type(model_t), intent(in) :: model
    real(dp) :: times
    real(dp) :: across, speed
    integer :: b, i
    times = 0.0_dp
    do b = 1, size(model%bodies)
      associate (body => model%bodies(b))
        if (.not. body%absorbs .or. .not. law_is_spherical(body%law)) cycle
        do i = 1, size(body%loads)
          associate (load => body%loads(i))
            if (load%kind /= load_absorbing .or. load%fading > 0.0_dp) cycle
            across = model%mesh%h*model%mesh%cells(load%axis)
            speed = load%impedance(1)/body%law%density
            if (across > 0.0_dp) times = max(times, model%clock%time*speed/across)
          end associate
        end do
      end associate
    end do
  end function crossings

  !> Cells from an edge to where its waves come from, where that is not known: the middle of the
  !! grid, or all of it where the other side is a plane of symmetry, the axis or a wall.
  pure function half_way(mesh, axis) result(cells)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    real(dp) :: cells
    cells = mesh%cells(axis)
    if (mesh%absorbs(1, axis) .and. mesh%absorbs(2, axis)) cells = 0.5_dp*cells
  end function half_way

  !> How far particles that bear the edges have moved across them (cells).
  pure subroutine look_at(mesh, body, moved)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(inout) :: moved(2, 3)
    real(dp) :: place, way, allowed
    integer :: c, i, l
    do i = 1, size(body%loads)
      associate (load => body%loads(i), particles => body%particles)
        if (load%kind /= load_absorbing) cycle
        place = mesh%edge(load%side, load%axis) - (load%side - 1.5_dp)*body%spacing*mesh%inverse_h
        allowed = 0.0_dp
        if (load%fading > 0.0_dp .and. law_is_spherical(body%law)) then
          allowed = little*abs(place - mesh_find(mesh, load%axis, load%source(load%axis)))
        else if (body%law%ambient > 0.0_dp) then
          allowed = little*half_way(mesh, load%axis)
        end if
        do c = 1, particles%chunks
          do l = 1, size(particles%id, 1)
            if (particles%id(l, c) == 0) cycle
            if (abs(particles%state(l, load%column + load%axis - 1, c)) <= 0.0_dp) cycle
            way = abs(particles%motion(l, load%axis, c) - place)
            if (way > allowed) moved(load%side, load%axis) = max(moved(load%side, load%axis), way)
          end do
        end do
      end associate
    end do
  end subroutine look_at

end module sgmp_absorbing_doubts
