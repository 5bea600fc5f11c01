!> What bodies that are held, or stiff, and have a flat face, narrower than what they press on, say
!! about a run (doc/verdict.md).
!!
!! Contact acts at nodes, and a node at the edge of the face stands for half a cell beyond it: the
!! face acts as if it were wider by half a cell and more at each edge. Strips on clay, 4 to 24 cells
!! wide, bear up to 1/n for each edge more than (2 + pi) c, n cells across (Prandtl; class Footing
!! of the random scenes).
!!
!! So it does below what stands on a body that is held: a block of n cells of height has up to
!! 2.3/n^2 too much stress by its weight (class Sit), along the grid 0.3/n with its foot on nodes,
!! 1/n where they lie half a cell below it; from there on nodes inside act, and it has 0.4/n too
!! little (4, 8, 16 cells in the plane and about the axis, deck `FOOT` of verdict.py).
module sgmp_judge_punches
  use sgmp_constitutive, only: law_bends, law_is_spherical, law_is_springy, law_wave_modulus
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  use sgmp_meetings, only: meetings_push
  use sgmp_mesh, only: mesh_t
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: body_card_t, scene_t
  use sgmp_shapes, only: shapes_box
  use sgmp_space, only: space_axisymmetric
  use sgmp_text, only: real_text_about
  use sgmp_thickness, only: length_along
  use sgmp_turn, only: turn_direction, turn_inverse, turn_same, turn_turns
  implicit none
  private
  public :: judge_punches, judge_standing

  real(dp), parameter :: edge_cells = 1.0_dp     !! by which an edge acts too far outside
  real(dp), parameter :: least_told = 0.06_dp, least_error = 0.1_dp
  !> Error of stress by the weight, times cells of height: aslant, and their square; on nodes, what
  !! each cell to nodes below adds, and where no nodes below act; where all do, which hold a layer.
  real(dp), parameter :: stands_aslant = 2.3_dp, stands_at = 0.3_dp, stands_above = 1.4_dp, &
                         stands_within = 0.41_dp, stands_held = 1.15_dp
  real(dp), parameter :: carried = 0.5_dp        !! part of its weight all the time
  real(dp), parameter :: straight = 0.9_dp       !! part of the impulse that is across the face
  real(dp), parameter :: stiffer = 5.0_dp        !! moduli of plane waves, of what digs in
  real(dp), parameter :: least_step = 1.0_dp     !! cells from an edge to where the other body ends

contains

  !> Bodies that are held, or stiff, and have pressed on a deformable solid with a flat face.
  subroutine judge_punches(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: error, cells
    integer :: p, b
    if (model%mesh%ndim == 1) return
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (.not. norm2(pair%impulse) > 0.0_dp .or. any(pair%body > size(scene%bodies))) cycle
        if (all(pair%held)) cycle
        b = findloc(pair%held .or. [(digs_in(scene, model, pair%body(b), pair%body(3 - b)), &
                                     b=1, 2)], .true., dim=1)
        if (b == 0) cycle
        if (law_is_spherical(model%bodies(pair%body(3 - b))%law)) cycle
        call look_at_edges(scene%bodies(pair%body(b)), scene%bodies(pair%body(3 - b)), &
                           model%mesh, meetings_push(model, pair), error, cells)
        if (error <= least_told) cycle
        call opinion%expect(max(error, least_error), &
                            "body '"//trim(model%bodies(pair%body(b))%name)//"' presses on '"// &
                            trim(model%bodies(pair%body(3 - b))%name)//"' with a face of "// &
                            real_text_about(cells)//' cells, whose edges act half a cell too '// &
                            'far outside: use smaller cells')
        return
      end associate
    end do
  end subroutine judge_punches

  !> Blocks of few cells that stand on a body that is held.
  subroutine judge_standing(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: high, weight, error, push(3)
    integer :: p, b
    if (model%mesh%ndim == 1) return
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (any(pair%body > size(scene%bodies)) .or. count(pair%held) /= 1) cycle
        b = pair%body(findloc(pair%held, .false., dim=1))
        weight = norm2(scene%gravity)*model%totals%bodies(b)%mass*model%clock%time
        if (.not. weight > 0.0_dp .or. norm2(pair%impulse) < carried*weight) cycle
        push = merge(1.0_dp, -1.0_dp, b == pair%body(1))*meetings_push(model, pair)
        if (law_is_spherical(model%bodies(b)%law) .or. &
            .not. is_flat(scene%bodies(b), model%mesh, push)) cycle
        high = length_along(scene%bodies(b)%shapes, model%mesh, push)
        error = foot_error(scene%bodies(b), model%mesh, push, pair%reach, high)/high
        if (error < least_told) cycle
        call opinion%expect(max(error, least_error), "body '"//trim(model%bodies(b)%name)//"', "// &
                            real_text_about(high)//' cells high, stands on another: contact '// &
                            'acts at nodes and not at its foot, so that stress by its own '// &
                            'weight is off; use smaller cells')
        return
      end associate
    end do
  end subroutine judge_standing

  !> Error of stress by the weight, times cells of height, of a body that a push holds up.
  pure function foot_error(card, mesh, push, reach, high) result(error)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: push(3)
    real(dp), intent(in) :: reach                !! below the foot, within which nodes act (cells)
    real(dp), intent(in) :: high                 !! cells of height
    real(dp) :: error, box(3, 2), below
    integer :: a
    error = stands_held
    if (reach >= huge(1.0_dp)) return
    a = maxloc(abs(push(:mesh%ndim)), dim=1)
    error = stands_aslant/high
    if (abs(push(a)) < straight*norm2(push) .or. mesh%graded .or. turn_turns(card%turn)) return
    call shapes_box(card%shapes, box(:, 1), box(:, 2))
    below = modulo(merge(box(a, 1), -box(a, 2), push(a) > 0.0_dp)*mesh%inverse_h, 1.0_dp)
    error = stands_at + stands_above*below
    if (below > reach) error = stands_within
  end function foot_error

  !> Whether a stiff body presses on one that yields, both at rest at first: where they are shot at
  !! each other more than edges matters.
  pure function digs_in(scene, model, own, other) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: own, other            !! bodies
    logical :: yes
    integer :: a, n
    n = model%mesh%ndim
    associate (law => model%bodies(other)%law)
      yes = law_bends(law) .and. .not. law_is_springy(law) .and. &
            law_wave_modulus(model%bodies(own)%law) > stiffer*law_wave_modulus(law)
    end associate
    do a = 1, merge(n, 0, yes)
      yes = yes .and. at_rest(scene%bodies(own)%velocity(a)) .and. &
            at_rest(scene%bodies(other)%velocity(a))
    end do
  end function digs_in

  !> Whether a component of a velocity is zero.
  pure logical function at_rest(velocity) result(yes)
    type(expression_t), intent(in) :: velocity
    yes = velocity%is_constant .and. abs(velocity%value) <= 0.0_dp
  end function at_rest

  !> The error by the edges of a body's flat face that lie on another's, and the cells across it.
  pure subroutine look_at_edges(card, other, mesh, impulse, error, cells)
    type(body_card_t), intent(in) :: card, other
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: impulse(3)
    real(dp), intent(out) :: error
    real(dp), intent(out) :: cells               !! of the narrowest face that has such edges
    real(dp) :: own(3, 2), its(3, 2), across(3), step
    integer :: a, edges
    error = 0.0_dp
    cells = huge(1.0_dp)
    if (.not. (is_flat(card, mesh, impulse) .and. is_flat(other, mesh, impulse))) return
    if (.not. turn_same(card%turn, other%turn)) return
    across = turn_direction(turn_inverse(card%turn), impulse)
    call shapes_box(card%shapes, own(:, 1), own(:, 2))
    call shapes_box(other%shapes, its(:, 1), its(:, 2))
    if (mesh%space == space_axisymmetric) then
      own(1, 1) = max(0.0_dp, own(1, 1))
      its(1, 1) = max(0.0_dp, its(1, 1))
    end if
    step = least_step*mesh%h
    do a = 1, mesh%ndim
      if (abs(across(a)) > straight*norm2(across)) cycle
      edges = count([own(a, 1) > its(a, 1) + step, own(a, 2) < its(a, 2) - step])
      if (edges == 0) cycle
      if (mesh%space == space_axisymmetric) edges = 2
      cells = min(cells, (own(a, 2) - own(a, 1))/mesh%h)
      error = error + edge_cells*edges*mesh%h/(own(a, 2) - own(a, 1))
    end do
  end subroutine look_at_edges

  !> Whether a body is made of one shape with a flat face in the direction of a push.
  pure logical function is_flat(card, mesh, push) result(yes)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: push(3)
    yes = allocated(card%shapes)
    if (yes) yes = size(card%shapes) == 1
    if (yes) yes = length_along(card%shapes, mesh, push) > 0.0_dp
  end function is_flat

end module sgmp_judge_punches
