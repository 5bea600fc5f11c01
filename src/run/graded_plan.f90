!> Where the grid of a scene would have to be fine, and what would be saved by a grid that is fine
!! only there (doc/grids.md): for advice (`--check`) and for a deck that has it (`--suggest`).
!!
!! Only for what is plain: bodies that fly straight into others at rest, well below the speed of
!! sound, all of ductile solids.
module sgmp_graded_plan
  use sgmp_constitutive, only: constitutive_t, material_elastic, material_j2, &
                               material_johnson_cook, material_mooney_rivlin, &
                               material_neo_hookean, material_steinberg_guinan, &
                               material_zerilli_armstrong
  use sgmp_graded_axis, only: graded_axis_t, graded_coordinate, graded_width
  use sgmp_graded_sides, only: graded_default_largest, graded_sides, graded_wish_t
  use sgmp_grid_fit, only: grid_fit_held
  use sgmp_kernels, only: method_sgmp
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_mesh, only: mesh_place, wall_slip
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_sum
  use sgmp_scene, only: body_card_t, layout_lattice, scene_space, scene_t
  use sgmp_scene_symmetry, only: scene_plain
  use sgmp_shapes, only: combine_difference, combine_union, shape_block, shape_cylinder, &
                         shape_halfspace, shapes_box
  use sgmp_space, only: axis_names
  use sgmp_text, only: real_text_plain, real_text_tidy
  implicit none
  private
  public :: graded_plan_t, graded_plan_find

  real(dp), parameter :: price = 1.35_dp       !! of a particle-step where cells are unequal
  real(dp), parameter :: fastest = 0.25_dp     !! speed (that of sound) up to which more is said
  real(dp), parameter :: ratio = 1.1_dp        !! of neighbouring cells
  real(dp), parameter :: fewest = 8.0_dp       !! of the largest cells that a body is wide

  !> What is found.
  type :: graded_plan_t
    character(:), allocatable :: words         !! for the card grid; '': none
    character(:), allocatable :: reason        !! why there are none
    integer(i8) :: particles = 0_i8            !! that there would be
    real(dp) :: gain = 1.0_dp                  !! particle-steps now over those with the words, by
                                               !! their price
  end type graded_plan_t

  !> Box of a body.
  type :: box_t
    real(dp) :: low(3) = 0.0_dp, high(3) = 0.0_dp, width(3) = 0.0_dp
      !! ends; width with the image behind slip walls (length)
    real(dp) :: velocity(3) = 0.0_dp
    logical :: flies = .false.
  end type box_t

contains

  !> Plans the cells of a scene; all ranks must call it.
  subroutine graded_plan_find(scene, model, plan)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(graded_plan_t), intent(out) :: plan
    type(box_t) :: boxes(size(scene%bodies))
    type(graded_axis_t) :: axes(3)
    real(dp) :: fine(2, 3), largest
    logical :: graded(3)
    integer(i8) :: now
    integer :: a
    plan%words = ''
    call find_obstacle(scene, model, plan%reason)
    if (plan%reason /= '') return
    call find_boxes(scene, model, boxes, plan%reason)
    if (plan%reason /= '') return
    call find_intervals(scene, model, boxes, fine, graded)
    largest = largest_cell(scene, boxes, fine, graded)
    if (largest < 1.5_dp) graded = .false.
    do a = 1, scene%dimension
      if (graded(a)) call make_axis(scene, a, fine(:, a), largest, axes(a))
      graded(a) = axes(a)%graded
    end do
    plan%reason = 'small cells are needed all over, or cells would grow too little'
    if (.not. any(graded)) return
    if (gauge_outside(scene, fine, graded)) then
      plan%reason = 'a gauge is far from where bodies meet'
      return
    end if
    now = sum(model%totals%particles)
    plan%particles = planned_particles(scene, model, axes)
    plan%gain = real(now, dp)/(price*real(max(plan%particles, 1_i8), dp))
    do a = 1, scene%dimension
      if (graded(a)) plan%words = plan%words//'fine_'//axis_names(a, scene_space(scene))//'=('// &
                                  real_text_tidy(fine(1, a))//','//real_text_tidy(fine(2, a))//') '
    end do
    plan%words = plan%words//'ratio='//real_text_plain(ratio)
    if (largest < graded_default_largest) plan%words = plan%words//' largest='// &
                                                       real_text_tidy(largest*scene%grid%cell)
    plan%reason = ''
  end subroutine graded_plan_find

  !> Why nothing is planned for a scene; '' if nothing stands against it.
  subroutine find_obstacle(scene, model, reason)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(:), allocatable, intent(out) :: reason
    integer :: b
    reason = ''
    if (model%mesh%graded) then
      reason = 'its cells are unequal already'
    else if (scene%method%kind /= method_sgmp .or. .not. scene%allows%graded) then
      reason = 'unequal cells do not go with what it asks for (sgmp help combinations)'
    else if (pushed(scene)) then
      reason = 'forces or explosives act elsewhere than where bodies meet'
    else if (.not. scene%time%end > 0.0_dp) then
      reason = 'it has no end in time, so that it is not known how far bodies fly'
    else if (.not. scene_plain(scene)) then
      reason = 'bodies come from files, are turned, or something in them is drawn by chance'
    else
      do b = 1, size(scene%bodies)
        if (.not. (ductile(model%bodies(b)%law) .or. scene%bodies(b)%rigid)) then
          reason = "'"//trim(scene%bodies(b)%name)//"' flows or is brittle, and may need small "// &
                   'cells anywhere'
        end if
      end do
    end if
  end subroutine find_obstacle

  !> Whether something other than contact moves bodies.
  pure function pushed(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    yes = any(abs(scene%gravity) > 0.0_dp) .or. size(scene%bodyforces) > 0 .or. &
          size(scene%loads) > 0 .or. size(scene%motions) > 0 .or. size(scene%detonations) > 0
  end function pushed

  !> Whether a material is a ductile solid.
  pure function ductile(law) result(yes)
    type(constitutive_t), intent(in) :: law
    logical :: yes
    yes = any(law%kind == [material_elastic, material_j2, material_johnson_cook, &
                           material_mooney_rivlin, material_neo_hookean, &
                           material_steinberg_guinan, material_zerilli_armstrong])
  end function ductile

  !> Boxes and velocities of bodies that fly straight, and of plain ones at rest.
  subroutine find_boxes(scene, model, boxes, reason)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(box_t), intent(out) :: boxes(:)
    character(:), allocatable, intent(out) :: reason
    real(dp) :: speed
    integer :: b
    reason = ''
    speed = 0.0_dp
    do b = 1, size(boxes)
      associate (card => scene%bodies(b))
        if (.not. all(card%velocity%is_constant .and. card%motion%is_constant)) then
          reason = "the velocity of '"//trim(card%name)//"' is a formula"
          return
        end if
      end associate
      call make_box(scene, scene%bodies(b), boxes(b))
      speed = max(speed, norm2(boxes(b)%velocity))
    end do
    if (all(boxes%flies) .or. .not. any(boxes%flies)) then
      reason = 'no body flies into another one at rest'
    else if (speed > fastest*(model%findings%fastest - speed)) then
      reason = 'at such a speed debris may hit far from where bodies meet'
    end if
    do b = 1, size(boxes)
      if (reason /= '' .or. boxes(b)%flies .or. scene%bodies(b)%rigid) cycle
      if (.not. plain(scene%bodies(b))) reason = "'"//trim(scene%bodies(b)%name)// &
                                                 "' has parts that cells must resolve"
    end do
  end subroutine find_boxes

  !> The box of a body, and how it flies.
  subroutine make_box(scene, card, box)
    type(scene_t), intent(in) :: scene
    type(body_card_t), intent(in) :: card
    type(box_t), intent(out) :: box
    integer :: a
    call shapes_box(card%shapes, box%low, box%high)
    box%low(scene%dimension + 1:) = 0.0_dp
    box%high(scene%dimension + 1:) = 0.0_dp
    box%velocity = card%velocity%value
    if (card%rigid .and. .not. card%free) box%velocity = card%motion%value
    box%flies = any(abs(box%velocity) > 0.0_dp)
    do a = 1, scene%dimension
      call cut_at_walls(scene, a, box)
    end do
  end subroutine make_box

  !> A box within the grid, as wide as with its image where it meets a slip wall.
  subroutine cut_at_walls(scene, axis, box)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    type(box_t), intent(inout) :: box
    logical :: touches(2), about
    about = scene%axisymmetric .and. axis == 1   ! its image lies behind the axis
    associate (grid => scene%grid)
      if (about) box%low(axis) = max(box%low(axis), 0.0_dp)
      if (.not. grid%open(1, axis)) box%low(axis) = max(box%low(axis), grid%lower(axis))
      if (.not. grid%open(2, axis)) box%high(axis) = min(box%high(axis), grid%upper(axis))
      touches(1) = (about .or. grid%wall(1, axis) == wall_slip) .and. &
                   box%low(axis) < merge(0.0_dp, grid%lower(axis), about) + 0.01_dp*grid%cell
      touches(2) = grid%wall(2, axis) == wall_slip .and. &
                   box%high(axis) > grid%upper(axis) - 0.01_dp*grid%cell
      box%width(axis) = (box%high(axis) - box%low(axis))*(1 + count(touches))
    end associate
  end subroutine cut_at_walls

  !> Whether a body is a block or a cylinder, perhaps cut.
  pure function plain(card) result(yes)
    type(body_card_t), intent(in) :: card
    logical :: yes
    integer :: s
    yes = count(card%shapes%combine == combine_union) == 1
    do s = 1, size(card%shapes)
      associate (shape => card%shapes(s))
        if (shape%combine == combine_difference) then
          yes = yes .and. shape%kind == shape_halfspace
        else
          yes = yes .and. any(shape%kind == [shape_block, shape_cylinder])
        end if
      end associate
    end do
  end function plain

  !> Intervals of small cells: where what flies will be, and around it as far as it cuts and dents
  !! others; none along an axis where that is nearly all.
  subroutine find_intervals(scene, model, boxes, fine, graded)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(box_t), intent(in) :: boxes(:)
    real(dp), intent(out) :: fine(2, 3)
    logical, intent(out) :: graded(3)
    real(dp) :: margin, ends(2), start
    logical :: ended
    integer :: a, b
    graded = .false.
    fine(1, :) = huge(1.0_dp)
    fine(2, :) = -huge(1.0_dp)
    do b = 1, size(boxes)
      associate (box => boxes(b), h => scene%grid%cell)
        if (.not. box%flies) cycle
        margin = half_width(box, scene%dimension)
        margin = margin*(0.5_dp + 2.0_dp*norm2(box%velocity)/ &
                         (model%findings%fastest - norm2(box%velocity)))
        margin = max(margin, 2.0_dp*h)
        do a = 1, scene%dimension
          fine(1, a) = min(fine(1, a), box%low(a) + min(0.0_dp, box%velocity(a)*scene%time%end) - &
                           margin)
          fine(2, a) = max(fine(2, a), box%high(a) + max(0.0_dp, box%velocity(a)*scene%time%end) + &
                           margin)
        end do
      end associate
    end do
    associate (grid => scene%grid, h => scene%grid%cell)
      do a = 1, scene%dimension
        ended = .not. grid%open(1, a)
        start = merge(grid%lower(a), 0.0_dp, ended)
        if (scene%axisymmetric .and. a == 1) ended = .true.  ! at the axis
        fine(1, a) = start + h*floor((fine(1, a) - start)/h + 1.0e-6_dp)
        fine(2, a) = start + h*ceiling((fine(2, a) - start)/h - 1.0e-6_dp)
        if (ended .and. fine(1, a) < start + 4.0_dp*h) fine(1, a) = start
        if (.not. grid%open(2, a)) then
          if (fine(2, a) > grid%upper(a) - 4.0_dp*h) fine(2, a) = grid%upper(a)
        end if
        ends = [minval(boxes%low(a)), maxval(boxes%high(a))]
        graded(a) = max(fine(1, a) - ends(1), ends(2) - fine(2, a)) > 4.0_dp*h
      end do
    end associate
  end subroutine find_intervals

  !> Half of the width of a body across its longest axis.
  pure function half_width(box, ndim) result(width)
    type(box_t), intent(in) :: box
    integer, intent(in) :: ndim
    real(dp) :: width
    logical :: others(3)
    others = .false.
    others(:ndim) = .true.
    if (ndim > 1) others(maxloc(box%width(:ndim), 1)) = .false.
    width = 0.5_dp*maxval(box%width, mask=others)
  end function half_width

  !> Side up to which cells may grow (smallest cell): bodies in large ones have some of them across.
  pure function largest_cell(scene, boxes, fine, graded) result(largest)
    type(scene_t), intent(in) :: scene
    type(box_t), intent(in) :: boxes(:)
    real(dp), intent(in) :: fine(2, 3)
    logical, intent(in) :: graded(3)
    real(dp) :: largest
    integer :: a, b
    largest = graded_default_largest
    do a = 1, scene%dimension
      if (.not. graded(a)) cycle
      do b = 1, size(boxes)
        if (boxes(b)%low(a) >= fine(1, a) .and. boxes(b)%high(a) <= fine(2, a)) cycle
        largest = min(largest, boxes(b)%width(a)/(fewest*scene%grid%cell))
      end do
    end do
    largest = 0.5_dp*aint(2.0_dp*largest)
  end function largest_cell

  !> Tables of an axis with a fine interval; without any where no cells fit.
  subroutine make_axis(scene, axis, fine, largest, table)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: axis
    real(dp), intent(in) :: fine(2), largest
    type(graded_axis_t), intent(out) :: table
    type(graded_wish_t) :: wish
    character(:), allocatable :: message, remedy
    real(dp) :: ends(2)
    associate (grid => scene%grid)
      wish%open = grid%open(:, axis)
      if (axis == 1 .and. scene%axisymmetric) wish%open(1) = .false.
      wish%held = grid_fit_held(grid, axis, scene%axisymmetric) .and. .not. wish%open
      wish%ends = [grid%lower(axis), grid%upper(axis)]
      wish%cell = grid%cell
      wish%ratio = ratio
      wish%largest = largest
      wish%fine = reshape(fine, [2, 1])
      call graded_sides(wish, table, ends, message, remedy)
      if (message /= '') table%graded = .false.
    end associate
  end subroutine make_axis

  !> Whether a gauge lies beyond the small cells, where waves come disturbed.
  pure function gauge_outside(scene, fine, graded) result(yes)
    type(scene_t), intent(in) :: scene
    real(dp), intent(in) :: fine(2, 3)
    logical, intent(in) :: graded(3)
    logical :: yes
    integer :: g
    yes = .false.
    do g = 1, size(scene%gauges)
      associate (x => scene%gauges(g)%point)
        yes = yes .or. any(graded .and. (x < fine(1, :) .or. x > fine(2, :)))
      end associate
    end do
  end function gauge_outside

  !> How many particles there would be: of bodies at rest fewer where cells are larger.
  function planned_particles(scene, model, axes) result(particles)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(graded_axis_t), intent(in) :: axes(3)
    integer(i8) :: particles
    real(dp) :: part, here, x
    integer :: a, b, c, l
    here = 0.0_dp
    do b = 1, size(scene%bodies)
      associate (own => model%bodies(b)%particles)
        do c = 1, own%chunks
          do l = 1, lanes
            if (own%id(l, c) == 0) cycle
            part = 1.0_dp
            if (coarsens(scene%bodies(b))) then
              do a = 1, scene%dimension
                if (.not. axes(a)%graded) cycle
                x = mesh_place(model%mesh, a, own%motion(l, a, c))
                x = graded_coordinate(axes(a), (x - axes(a)%origin)/scene%grid%cell)
                part = part/graded_width(axes(a), floor(x))
              end do
            end if
            here = here + part
          end do
        end do
      end associate
    end do
    particles = parallel_sum(nint(here, i8))
  end function planned_particles

  !> Whether the particles of a body are larger in larger cells (sgmp_graded_bodies).
  pure function coarsens(card) result(yes)
    type(body_card_t), intent(in) :: card
    logical :: yes
    yes = card%layout == layout_lattice .and. .not. (card%layout_asked .or. card%rigid) .and. &
          all(abs(card%velocity%value) <= 0.0_dp)
  end function coarsens

end module sgmp_graded_plan
