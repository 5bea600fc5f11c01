!> What collisions of few cells say about a run (doc/verdict.md).
!!
!! Elastic bodies that meet face to face bounce by a wave that runs through them and back. On the
!! grid its front is as wide as the cube root of its way: of n cells the bodies keep a part
!! n^(-2/3) of what they should hand on, as a chain of masses does; on a rigid body twice that. At
!! a wall of the grid methods other than sgmp return the velocity to 1 % and better; sgmp lacks 0.65
!! to 0.8 parts of 1/n. That holds for bodies that do not widen where they are pressed: parts of a
!! face that does would leave the wall early, and are held for a cell.
!!
!! Plates of metal lose more where cells are few, for their viscosity widens fronts, too: of n cells
!! up to 0.7 parts of 1/n of the impulse that they should hand on (class Stack of the random
!! scenes). What a body keeps of its own velocity is uncertain by that over its mass.
module sgmp_judge_collisions
  use sgmp_constitutive, only: constitutive_t, law_bends, law_bulk, law_is_spherical, law_tears
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_contact_patch, only: patch_cells
  use sgmp_failure, only: failure_none
  use sgmp_fast_scenes, only: speed_at_start, velocity_at_start
  use sgmp_judge_entries, only: is_pool
  use sgmp_kernels, only: kernel_centred, method_mpm, method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_meetings, only: extent_t, meetings_extent, meetings_met, meetings_push
  use sgmp_mesh, only: wall_free
  use sgmp_model, only: model_t
  use sgmp_near_walls, only: near_walls, near_walls_flown_at
  use sgmp_opinion, only: opinion_t
  use sgmp_scene, only: scene_presses, scene_t
  use sgmp_shapes, only: shape_block, shape_ring, shapes_box
  use sgmp_text, only: integer_text, real_text, real_text_about
  use sgmp_thickness, only: body_thickness, length_along
  implicit none
  private
  public :: judge_collisions, judge_projectiles, projectile_fastest, projectile_narrow, &
            projectile_wanted

  real(dp), parameter :: line_weight = 0.41_dp    !! sgmp, bars of 4 to 80 cells: 0.30 to 0.41
  real(dp), parameter :: row_power = 1.3_dp       !! of meetings in a row: 2 and 3 bars after one
  real(dp), parameter :: least_flat = 0.05_dp     !! as least_loss, of elastic blocks
  real(dp), parameter :: bounce_weight = 0.65_dp  !! squares of 10 to 40 cells: 0.58 to 0.65
  real(dp), parameter :: rigid_weight = 1.4_dp    !! on a rigid body, 5 to 40 cells: 0.93 to 1.37
  real(dp), parameter :: cover_weight = 0.9_dp    !! one that covers it, 8 to 32 cells: 0.5 to 0.87
  real(dp), parameter :: shorter = 0.75_dp, longer = 4.0_dp/3.0_dp  !! than a plate was that flows
  real(dp), parameter :: plate_weight = 0.6_dp    !! metals, 4 to 40 cells: 0.1 to 0.7
  real(dp), parameter :: most_error = 0.35_dp     !! of what is coarse: 0.33 found
  real(dp), parameter :: least_parting = 0.02_dp  !! of the velocity with which bodies met
  real(dp), parameter :: least_loss = 0.06_dp     !! of the velocity, that is judged
  real(dp), parameter :: wide_poisson = 0.2_dp    !! Poisson's ratio; up to 0.15: below 0.02
  real(dp), parameter :: held_cells = 80.0_dp     !! sgmp, ratio 0.3: 0.22, 0.2, 0.13 of 10, 20, 40
  real(dp), parameter :: held_error = 0.3_dp      !! 0.45: 0.26, 0.29, 0.19; gimp 0.33, 0.20, 0.08
  real(dp), parameter :: wall_weight = 0.8_dp     !! sgmp, bars of 10 to 40 cells: 0.65 to 0.8
  ! At walls that let go, of the velocity before: squares that widen 0.02 to 0.17 of 24 to 6 cells,
  ! disks of 8 to 16 and Poisson's ratio 0.45 0.09, others 0.05; what yields 0.15 of 6 cells, 0.08
  ! of 8 to 24, 0.05 of 36.
  real(dp), parameter :: wide_weight = 1.6_dp, wide_cells = 24.0_dp, round_poisson = 0.4_dp
  real(dp), parameter :: soft_weight = 1.0_dp, soft_cells = 40.0_dp
  real(dp), parameter :: narrow_weight = 0.9_dp, narrow_cells = 9.0_dp
  real(dp), parameter :: spun_weight = 2.2_dp, spun_cells = 44.0_dp
    !! the lattice's facets turn less: disks of 16 and 32 cells lack 0.12 and 0.06 of their spin
  real(dp), parameter :: slowed = 0.5_dp          !! of its velocity it has lost at least so much
  real(dp), parameter :: round_weight = 0.75_dp   !! disks of 8 to 32 cells across: 0.6 to 0.75
  real(dp), parameter :: ball_patch = 0.24_dp     !! cells of the patch: 0.07 to 0.23
  real(dp), parameter :: disk_patch = 0.12_dp     !! 0.04 to 0.12
  real(dp), parameter :: ring_spacing = 0.4_dp    !! cells; of two particles per cell it is 0.5
  real(dp), parameter :: ring_error = 0.15_dp     !! rings of 3 to 10 cells: 4 to 13 %
  real(dp), parameter :: ring_cells = 4.5_dp      !! thickness; of 3 cells they lack 3 to 9 %
  real(dp), parameter :: ring_slender = 5.5_dp    !! radius over thickness: at 6.7 they lack 6 %
  real(dp), parameter :: bounce_cells = 16.0_dp   !! from here on the error is below 0.05 or so
  real(dp), parameter :: least_error = 0.1_dp     !! of what is coarse

  ! Projectiles that make their way through matter that fails: the way is wider than they are by a
  ! part of a cell on each side, so they are slowed too much (doc/verdict.md).
  real(dp), parameter :: slim = 6.0_dp, fair = 12.0_dp   !! cells across
  real(dp), parameter :: fair_liquid = 36.0_dp
    !! a ball in water has a coefficient of drag of 0.60 and 0.42 with 10 and 20 cells
  real(dp), parameter :: covers = 0.5_dp        !! width, of that of a liquid
  real(dp), parameter :: way_weight = 3.6_dp      !! error of what it has left, over a cell by these
  real(dp), parameter :: least_slowing = 0.05_dp  !! of their velocity
  real(dp), parameter :: ordnance(2) = [0.005_dp, 1.0_dp/3.0_dp]
    !! of c + |v|, up to half of the speed of sound: slower ones dent, before faster ones all flows

contains

  !> Bodies that bounce off each other, where nothing else acts on them; all ranks must call it.
  subroutine judge_collisions(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical :: flat(2), round(2)
    real(dp) :: push(3)
    integer, allocatable :: row(:)       !! pairs of flat faces that have met
    integer :: b, p, before
    call judge_crowd(opinion, model)
    call judge_near_walls(opinion, scene, model)
    if (any(abs(scene%gravity) > 0.0_dp)) return
    if (size(scene%bodyforces) + size(scene%loads) + size(scene%motions) > 0) return
    call judge_walls(opinion, scene, model)
    before = size(opinion%errors)
    allocate (row(0))
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p))
        if (.not. meetings_met(scene, model, pair)) cycle
        push = meetings_push(model, pair)
        flat = [(bounces(scene, model, pair%body(b), push), b=1, 2)]
        round = [(rebounds(scene, model, pair%body(b), push), b=1, 2)]
        if (all(flat .or. model%bodies(pair%body)%rigid)) then
          row = [row, p]
        else if (all(flat .or. round .or. model%bodies(pair%body)%rigid)) then
          call expect_round(opinion, scene, model, pair)
        else if (all([(is_plate(scene, model, pair%body(b), push), b=1, 2)])) then
          if (any([(reshaped(scene, model, pair%body(b)), b=1, 2)])) cycle
          call expect_plates(opinion, scene, model, pair)
        end if
      end associate
      if (size(opinion%errors) > before) return
    end do
    if (size(row) > 0) call expect_row(opinion, scene, model, model%contact%pairs(row))
  end subroutine judge_collisions

  !> Elastic bodies with flat faces that have met, or one that has met a rigid body: in a row of
  !! them each hands on what the one before has kept. Told of the pair that loses most.
  subroutine expect_row(opinion, scene, model, pairs)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pairs(:)
    real(dp) :: losses(size(pairs)), lost
    integer :: p, worst
    losses = [(flat_loss(scene, model, pairs(p)), p=1, size(pairs))]
    worst = maxloc(losses, dim=1)
    lost = size(pairs)**row_power*losses(worst)
    if (lost < least_flat) return
    call opinion%expect(min(most_error, max(least_error, lost)), &
                        bodies_text(model, pairs(worst)%body)//', '// &
                        real_text_about(cells_along(scene, model, pairs(worst)))// &
                        ' cells thick, bounce off each other: their velocities after it want '// &
                        'smaller cells')
  end subroutine expect_row

  !> Part of the velocity that one such meeting keeps from being handed on.
  function flat_loss(scene, model, pair) result(lost)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    real(dp) :: lost, weight
    weight = merge(line_weight, bounce_weight, model%mesh%ndim == 1)
    if (any(model%bodies(pair%body)%rigid)) then
      weight = merge(cover_weight, rigid_weight, pair%reach < huge(1.0_dp))
    end if
    lost = weight*cells_along(scene, model, pair)**(-2.0_dp/3.0_dp)
  end function flat_loss

  !> Cells along the shorter of two bodies with flat faces, from face to face; rigid ones are not
  !! counted.
  function cells_along(scene, model, pair) result(cells)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    real(dp) :: cells, push(3)
    integer :: b
    cells = huge(1.0_dp)
    push = meetings_push(model, pair)
    do b = 1, 2
      if (model%bodies(pair%body(b))%rigid) cycle
      cells = min(cells, length_along(scene%bodies(pair%body(b))%shapes, model%mesh, push))
    end do
  end function cells_along

  !> Two bodies with flat faces, not both elastic, that have met and part.
  subroutine expect_plates(opinion, scene, model, pair)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    real(dp) :: cells, lost, parting, push
    associate (bodies => model%totals%bodies(pair%body))
      push = norm2(pair%impulse)
      parting = norm2(bodies(2)%momentum/bodies(2)%mass - bodies(1)%momentum/bodies(1)%mass)
      if (parting < least_parting*push*sum(1.0_dp/bodies%mass)) return
      cells = cells_along(scene, model, pair)
      lost = plate_weight/cells*push/minval(bodies%mass)/ &
             max(norm2(bodies(1)%momentum)/bodies(1)%mass, norm2(bodies(2)%momentum)/bodies(2)%mass)
    end associate
    if (lost < least_loss) return
    call opinion%expect(min(most_error, max(least_error, lost)), bodies_text(model, pair%body)// &
                        ', '//real_text_about(cells)//' cells thick, bounce off each other: '// &
                        'their velocities after it want smaller cells')
  end subroutine expect_plates

  !> Whether a body has become another: it has flowed into the other one, and did not bounce. All
  !! ranks must call it.
  function reshaped(scene, model, b) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    logical :: yes
    real(dp) :: lower(3), upper(3), change(model%mesh%ndim)
    type(extent_t) :: now
    integer :: d
    now = meetings_extent(model, b)
    call shapes_box(scene%bodies(b)%shapes, lower, upper)
    change = [((now%upper(d) - now%lower(d))*model%mesh%h/(upper(d) - lower(d)), &
               d=1, model%mesh%ndim)]
    yes = any(change < shorter .or. change > longer)
  end function reshaped

  !> Two elastic bodies that have met, one of them at least not flat. Disks and balls of few cells
  !! lose energy to vibrations, and turn, for they touch in less than a cell or in a few; rings lose
  !! it to stresses within cells, the more the fewer particles these have.
  subroutine expect_round(opinion, scene, model, pair)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    real(dp) :: cells, patch, lost
    logical :: flat
    integer :: b
    flat = model%mesh%ndim == 2 .and. .not. scene%axisymmetric
    cells = huge(1.0_dp)
    do b = 1, 2
      if (.not. rebounds(scene, model, pair%body(b), meetings_push(model, pair))) cycle
      if (flat .and. any(scene%bodies(pair%body(b))%shapes%kind == shape_ring)) then
        call expect_rings(opinion, scene, model, pair%body)
        return
      end if
      cells = min(cells, body_thickness(scene%bodies(pair%body(b))%shapes, model%mesh))
    end do
    patch = patch_cells(scene, model, pair)
    lost = merge(disk_patch, ball_patch, flat .and. pair%friction <= 0.0_dp)/patch
    if (lost < least_loss) then
      if (.not. flat .or. cells >= bounce_cells) return
      lost = round_weight/cells
    end if
    call opinion%expect(min(most_error, max(least_error, lost)), &
                        bodies_text(model, pair%body)//', '//real_text_about(cells)// &
                        ' cells across, bounce off each other and touch in a patch of '// &
                        real_text_about(2.0_dp*patch)//' cells: their velocities and spins '// &
                        'after it want smaller cells')
  end subroutine expect_round

  !> Rings among two bodies that have met.
  subroutine expect_rings(opinion, scene, model, pair)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: pair(2)       !! numbers of the bodies
    character(:), allocatable :: meet
    real(dp) :: slender, thick
    logical :: sparse
    integer :: b
    slender = 0.0_dp
    thick = huge(1.0_dp)
    sparse = .false.
    do b = 1, 2
      associate (card => scene%bodies(pair(b)), shapes => scene%bodies(pair(b))%shapes)
        if (model%bodies(pair(b))%rigid .or. .not. any(shapes%kind == shape_ring)) cycle
        sparse = sparse .or. card%spacing > ring_spacing*scene%grid%cell
        thick = min(thick, body_thickness(card%shapes, model%mesh))
        slender = max(slender, maxval(shapes%radius/max(shapes%radius - shapes%radius2, &
                                                        tiny(1.0_dp)), &
                                      mask=shapes%kind == shape_ring))
      end associate
    end do
    meet = bodies_text(model, pair)//' bounce off each other'
    if (scene%method%kind == method_mpm) then
      call opinion%object(meet//': with method mpm rings lose half of their rebound and more; '// &
                          'use method sgmp')
    else if (scene%method%kind /= method_sgmp .or. .not. scene%method%surfaces) then
      call opinion%expect(merge(2.0_dp, 1.0_dp, sparse)*ring_error, meet//': rings lose less '// &
                          'of their rebound with method sgmp surfaces=corrected')
    else if (sparse) then
      call opinion%expect(ring_error, meet//' with few particles per cell: rings want three '// &
                          'along each axis, ppc=3')
    else
      if (slender > ring_slender) then
        call opinion%expect(ring_error*slender/10.0_dp, meet//': thin rings, their rebound '// &
                            'lacks some of their energy')
      end if
      if (thick < ring_cells) then
        call opinion%expect(least_error, meet//', rings '//real_text_about(thick)// &
                            ' cells thick: their rebound wants smaller cells')
      end if
    end if
  end subroutine expect_rings

  !> Names of two bodies, to begin a sentence.
  function bodies_text(model, pair) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: pair(2)       !! numbers of the bodies
    character(:), allocatable :: text
    text = "bodies '"//trim(model%bodies(pair(1))%name)//"' and '"// &
           trim(model%bodies(pair(2))%name)//"'"
  end function bodies_text

  !> Projectiles with few cells across that were slowed by matter that fails.
  subroutine judge_projectiles(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    real(dp) :: cells, now
    integer :: b
    do b = 1, size(scene%bodies)
      cells = projectile_narrow(scene, model, b)
      if (cells >= huge(cells)) cycle
      now = norm2(model%totals%bodies(b)%momentum(:model%mesh%ndim))/model%totals%bodies(b)%mass
      if (now > (1.0_dp - least_slowing)*speed_at_start(scene, b, model%mesh%ndim)) cycle
      if (cells < slim*(1.0_dp - 1.0e-9_dp)) then
        call opinion%object(narrow_text(scene, model, b, cells))
      else
        call opinion%expect(way_weight/cells, narrow_text(scene, model, b, cells))
      end if
    end do
  end subroutine judge_projectiles

  !> What is wrong with few cells across a projectile.
  function narrow_text(scene, model, b, cells) result(text)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: cells
    character(:), allocatable :: text
    text = "projectile '"//trim(model%bodies(b)%name)//"' is "//real_text_about(cells)// &
           ' cells across: its way through what it hits is too wide, and it is slowed '// &
           'too much; use smaller cells, '// &
           integer_text(nint(projectile_wanted(scene, model, b)))//' across at least'
  end function narrow_text

  !> Cells across a body that is shot at one that rests and can fail, where they are too few; huge
  !! for all others.
  pure function projectile_narrow(scene, model, b) result(cells)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: cells
    cells = huge(cells)
    if (model%mesh%ndim == 1 .or. .not. is_shot(scene, model, b)) return
    cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
    if (cells >= projectile_wanted(scene, model, b)*(1.0_dp - 1.0e-9_dp)) cells = huge(cells)
  end function projectile_narrow

  !> Cells across a projectile from which on it is slowed as it should be: a liquid, which nothing
  !! but its inertia opens, wants more.
  pure function projectile_wanted(scene, model, b) result(cells)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: cells
    cells = merge(fair_liquid, fair, is_shot(scene, model, b, liquid=.true.))
  end function projectile_wanted

  !> Whether a body is shot at one that rests and can fail, or at a liquid alone.
  pure logical function is_shot(scene, model, b, liquid) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    logical, intent(in), optional :: liquid
    real(dp) :: speed
    logical :: wet, all_kinds
    integer :: p, n, t
    n = model%mesh%ndim
    all_kinds = .true.
    if (present(liquid)) all_kinds = .not. liquid
    yes = .false.
    if (law_is_spherical(model%bodies(b)%law) .or. model%totals%bodies(b)%mass <= 0.0_dp) return
    speed = speed_at_start(scene, b, n)
    if (speed < ordnance(1)*model%findings%fastest) return
    if (speed > projectile_fastest(model)) return
    do p = 1, size(model%contact%pairs)
      associate (pair => model%contact%pairs(p)%body)
        if (any(pair > size(scene%bodies)) .or. .not. any(pair == b)) cycle
        t = sum(pair) - b
        wet = is_pool(scene, model, b, t, velocity_at_start(scene, b, n), covers)
        yes = yes .or. wet .or. (all_kinds .and. is_target(scene, model, t, n))
      end associate
    end do
  end function is_shot

  !> Speed from which on all flows that a body hits.
  pure function projectile_fastest(model) result(speed)
    type(model_t), intent(in) :: model
    real(dp) :: speed
    speed = ordnance(2)*model%findings%fastest
  end function projectile_fastest

  !> Whether a body rests at the start and can fail.
  pure logical function is_target(scene, model, b, n) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b, n
    yes = .not. model%bodies(b)%rigid .and. speed_at_start(scene, b, n) <= 0.0_dp
    if (yes) yes = asked_to_fail(model%bodies(b)%law) .or. &
                   model%bodies(b)%law%erosion%plastic_strain < failure_none
  end function is_target

  !> Whether a law fails by what its deck says.
  elemental logical function asked_to_fail(law) result(yes)
    type(constitutive_t), intent(in) :: law
    yes = law%history%damage .and. .not. law_tears(law)
  end function asked_to_fail

  !> Bodies that a wall has held since the start: near it those that it has slowed, at it those that
  !! come back.
  subroutine judge_near_walls(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    real(dp) :: left
    logical :: touches
    integer :: b, n
    n = model%mesh%ndim
    do b = 1, size(scene%bodies)
      call near_walls(scene, model, b, text, touches)
      if (text == '') cycle
      associate (start => scene%bodies(b)%velocity(:n)%value, body => model%totals%bodies(b))
        left = dot_product(start, body%momentum(:n))/(body%mass*sum(start**2))
      end associate
      if (left > merge(0.0_dp, 1.0_dp - least_slowing, touches)) cycle
      call opinion%object(text)
      return
    end do
  end subroutine judge_near_walls

  !> Parts of a body that meet where no velocity field is left for them.
  subroutine judge_crowd(opinion, model)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    if (model%contact%self%crowded == 0) return
    call opinion%object('more parts of a body that touches itself met than it has velocity '// &
                        'fields: some of them ('// &
                        integer_text(model%contact%self%crowded)// &
                        ' patches) stuck together; smaller cells')
  end subroutine judge_crowd

  !> Bodies that come back from a wall: those that fly against the one velocity with which they
  !! began, and touch no other; and those that yield at one, which holds what has become flat.
  subroutine judge_walls(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    logical :: held
    integer :: b, n, before
    n = model%mesh%ndim
    before = size(opinion%errors)
    if (size(model%contact%pairs) > 0) return
    if (all(model%mesh%wall(:, :n) == wall_free .and. .not. model%mesh%one_sided(:, :n))) return
    do b = 1, size(scene%bodies)
      held = near_walls_flown_at(scene, model, b, lets_go=.false.)
      if (near_walls_flown_at(scene, model, b, lets_go=.true.) .and. .not. held) then
        call expect_let_go(opinion, scene, model, b)
      else if (bounces(scene, model, b, velocity_at_start(scene, b, n))) then
        if (kept_speed(scene, model, b) >= 0.0_dp) cycle
        call expect_wall(opinion, model, b, body_thickness(scene%bodies(b)%shapes, model%mesh))
      else if (yields(model, b) .and. held) then
        if (kept_speed(scene, model, b) >= slowed) cycle
        call opinion%expect(held_error, "body '"//trim(model%bodies(b)%name)//"' yields at a "// &
                            'wall of the grid, which does not let it go: its velocity after it '// &
                            'wants a rigid body for the wall')
      end if
      if (size(opinion%errors) > before) return
    end do
  end subroutine judge_walls

  !> Part of the one velocity with which a body began that it has along that; 1 where it has none.
  pure function kept_speed(scene, model, b) result(part)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: part, square
    part = 1.0_dp
    associate (start => scene%bodies(b)%velocity(:model%mesh%ndim), sums => model%totals%bodies(b))
      if (.not. all(start%is_constant)) return
      square = sum(start%value**2)*sums%mass
      if (square > 0.0_dp) part = dot_product(start%value, sums%momentum(:size(start)))/square
    end associate
  end function kept_speed

  !> Whether a body is a solid that yields.
  pure logical function yields(model, b) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    associate (law => model%bodies(b)%law)
      yes = .not. (model%bodies(b)%rigid .or. model%bodies(b)%springs) .and. law_bends(law)
    end associate
  end function yields

  !> A body that has come back from a wall that lets go, or has lost much of its velocity there.
  !! What firm walls throw back (sgmp_one_sided_build) is as uncertain as squares that widen.
  subroutine expect_let_go(opinion, scene, model, b)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: cells, kept, flown(3)
    logical :: wide
    cells = body_thickness(scene%bodies(b)%shapes, model%mesh)
    kept = kept_speed(scene, model, b)
    flown = velocity_at_start(scene, b, model%mesh%ndim)
    if (any(model%mesh%rough > 0.0_dp) .and. rebounds(scene, model, b, flown) .and. &
        cells < spun_cells .and. kept < 1.0_dp - least_slowing) then
      call opinion%expect(spun_weight/cells, bounced(model, b, cells)//', and so does its spin')
    end if
    wide = scene_presses(scene) .or. any(scene%grid%floor) .or. model%mesh%ndim > 1 .and. &
           poisson_of(model, b) > merge(wide_poisson, round_poisson, &
                                        bounces(scene, model, b, flown))
    if (yields(model, b)) then
      if (kept < slowed) call tell(soft_weight, soft_cells)
    else if (kept < 0.0_dp .and. wide) then
      call tell(wide_weight, wide_cells)
    else if (kept < 0.0_dp) then
      call tell(narrow_weight, narrow_cells)
    end if

  contains

    subroutine tell(weight, enough)
      real(dp), intent(in) :: weight, enough
      if (cells < enough) call opinion%expect(max(least_error, weight/cells), &
                                              bounced(model, b, cells))
    end subroutine tell

  end subroutine expect_let_go

  !> How a sentence about a body that has met a wall begins.
  function bounced(model, b, cells) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: cells        !! its thickness
    character(:), allocatable :: text
    text = "body '"//trim(model%bodies(b)%name)//"', "//real_text_about(cells)//' cells thick, '// &
           'bounces off a wall: its velocity after it wants smaller cells'
  end function bounced

  !> Poisson's ratio of a body.
  pure function poisson_of(model, b) result(poisson)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: poisson
    associate (bulk => law_bulk(model%bodies(b)%law), shear => model%bodies(b)%law%elastic%shear)
      poisson = (3.0_dp*bulk - 2.0_dp*shear)/(2.0_dp*(3.0_dp*bulk + shear))
    end associate
  end function poisson_of

  !> An elastic body that has come back from a wall. Parts of its face would leave the wall while
  !! others press on it, where it widens as it is pressed; the wall holds them for a cell.
  subroutine expect_wall(opinion, model, b, cells)
    type(opinion_t), intent(inout) :: opinion
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: cells        !! its thickness
    character(:), allocatable :: text
    text = bounced(model, b, cells)
    if (model%mesh%ndim > 1 .and. poisson_of(model, b) > wide_poisson .and. &
        cells < held_cells) then
      call opinion%expect(held_error, text)
    else if (kernel_centred(model%fields(model%bodies(b)%field)%kernel) .and. &
             cells < bounce_cells) then
      call opinion%expect(max(least_error, wall_weight/cells), text//', or method gimp')
    end if
  end subroutine expect_wall

  !> Whether a body is elastic and has flat faces in the direction of a push.
  pure logical function bounces(scene, model, b, push) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: push(3)
    yes = .false.
    if (model%bodies(b)%rigid .or. .not. allocated(scene%bodies(b)%shapes)) return
    yes = model%bodies(b)%springs .and. &
          length_along(scene%bodies(b)%shapes, model%mesh, push) > 0.0_dp
  end function bounces

  !> Whether a body has flat faces there, and is a solid that cannot fail.
  pure logical function is_plate(scene, model, b, push) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: push(3)
    yes = .false.
    if (model%bodies(b)%rigid .or. .not. allocated(scene%bodies(b)%shapes)) return
    associate (law => model%bodies(b)%law)
      yes = .not. (law_is_spherical(law) .or. asked_to_fail(law)) .and. &
            law%erosion%plastic_strain >= failure_none .and. &
            length_along(scene%bodies(b)%shapes, model%mesh, push) > 0.0_dp
    end associate
  end function is_plate

  !> Whether a body is elastic and its surface is curved there.
  pure logical function rebounds(scene, model, b, push) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp), intent(in) :: push(3)
    yes = .false.
    if (model%bodies(b)%rigid .or. .not. allocated(scene%bodies(b)%shapes)) return
    yes = model%bodies(b)%springs .and. &
          all(scene%bodies(b)%shapes%kind /= shape_block) .and. &
          .not. length_along(scene%bodies(b)%shapes, model%mesh, push) > 0.0_dp
  end function rebounds

end module sgmp_judge_collisions
