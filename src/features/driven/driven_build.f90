!> Parts of bodies whose motion is prescribed: which particles they are, and how they start.
module sgmp_driven_build
  use sgmp_body, only: body_parts, body_t
  use sgmp_drive, only: drive_sums, drive_velocity
  use sgmp_driven_part, only: driven_part_start, driven_part_t
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kinds, only: dp, lanes
  use sgmp_loads_build, only: chosen
  use sgmp_material_history, only: slots_ask
  use sgmp_mesh, only: mesh_places, mesh_position, mesh_t
  use sgmp_model, only: model_t
  use sgmp_motion, only: motion_mass
  use sgmp_parallel, only: parallel_exact_sums
  use sgmp_scene, only: motion_card_t, scene_t
  use sgmp_sums, only: nodes_sums, sweep_sums
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: driven_add_columns, driven_declare, driven_fill, driven_number

  ! What is summed over particles: mass and its moment, particles that two cards move the same way,
  ! places of which where=… does not say.
  integer, parameter :: mass = 1, moment = 2, twice = 5, unclear = 6, sums = 6

contains

  !> What the cards say of a body's parts.
  subroutine driven_declare(scene, number, body)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(body_t), intent(inout) :: body
    type(driven_part_t) :: new
    integer :: i, d
    do i = 1, size(scene%motions)
      if (scene%motions(i)%body /= number) cycle
      if (.not. allocated(body%driven)) allocate (body%driven(0))
      associate (card => scene%motions(i))
        new%axes = card%axes
        new%velocity = card%velocity
        new%drive%pic = 1.0_dp - scene%method%flip
        new%drive%about_axis = card%about_axis
        new%until = card%until
        new%motion%turns = card%turns
        new%motion%centre = card%about
        do d = 1, 3
          new%motion%omega(d) = card%omega(d)
        end do
      end associate
      body%driven = [body%driven, new]
    end do
    body%is_driven = allocated(body%driven)
  end subroutine driven_declare

  !> Columns of the particles that say which belong to a part.
  pure subroutine driven_add_columns(body)
    type(body_t), intent(inout) :: body
    integer :: i
    do i = 1, body_parts(body)
      call slots_ask(body%law%slots, 'driven'//integer_text(i), [0.0_dp])
      body%driven(i)%mark = body%law%slots%total
    end do
  end subroutine driven_add_columns

  !> Fills these columns, and gives the particles their first velocity; an error where there are
  !! none. All ranks must call it.
  subroutine driven_fill(scene, number, mesh, body, error)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: total(sums)
    integer :: i, own, n
    n = mesh%ndim
    own = 0
    do i = 1, size(scene%motions)
      if (scene%motions(i)%body /= number) cycle
      own = own + 1
      associate (card => scene%motions(i), part => body%driven(own))
        call mark(card, mesh, own, body, total)
        if (total(unclear) > 0.0_dp) then
          call error_make(error, exit_deck, "where=… is not a number at some places of body '"// &
                          trim(body%name)//"'", 'particles are moved where it is not 0', &
                          card%location)
        else if (total(mass) <= 0.0_dp) then
          call error_make(error, exit_deck, 'the motion moves no particle', &
                          'look at where=…; particles are at the centres of their cubes', &
                          card%location)
        else if (total(twice) > 0.0_dp) then
          call error_make(error, exit_deck, "two cards move the same particles of body '"// &
                          trim(body%name)//"' along the same axis", 'let their where=… exclude '// &
                          'each other', card%location)
        end if
        if (allocated(error)) return
        if (.not. card%about_given) then
          part%motion%centre = 0.0_dp
          part%motion%centre(:n) = mesh_position(mesh%origin(:n), mesh%h, &
                                                 total(moment:moment + n - 1)/total(mass))
        end if
        call driven_part_start(part)
        call set_velocities(mesh, part, body)
      end associate
    end do
  end subroutine driven_fill

  !> Marks the particles of one part.
  subroutine mark(card, mesh, own, body, total)
    type(motion_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: own                   !! number of the part in its body
    type(body_t), intent(inout) :: body
    real(dp), intent(out) :: total(sums)
    real(dp), allocatable :: terms(:, :)
    real(dp) :: x(3), m
    integer :: c, l, n, i
    n = mesh%ndim
    x = 0.0_dp
    associate (particles => body%particles)
      allocate (terms(sums, particles%chunks), source=0.0_dp)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          x(:n) = mesh_places(mesh, particles%motion(l, :n, c))
          if (.not. chosen(card%where, x, terms(unclear, c))) cycle
          particles%state(l, body%driven(own)%mark, c) = 1.0_dp
          m = particles%motion(l, motion_mass(n), c)
          terms(mass, c) = terms(mass, c) + m
          terms(moment:moment + n - 1, c) = terms(moment:moment + n - 1, c) + &
                                            m*particles%motion(l, :n, c)
          do i = 1, own - 1
            if (any(body%driven(i)%axes .and. body%driven(own)%axes) .and. &
                particles%state(l, body%driven(i)%mark, c) > 0.0_dp) then
              terms(twice, c) = terms(twice, c) + 1.0_dp
            end if
          end do
        end do
      end do
    end associate
    call parallel_exact_sums(terms, total)
  end subroutine mark

  !> Gives the particles of a part the velocity that it has at the start.
  subroutine set_velocities(mesh, part, body)
    type(mesh_t), intent(in) :: mesh
    type(driven_part_t), intent(in) :: part
    type(body_t), intent(inout) :: body
    real(dp) :: x(3), v(3)
    integer :: c, l, d, n
    n = mesh%ndim
    x = 0.0_dp
    associate (particles => body%particles)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0 .or. .not. particles%state(l, part%mark, c) > 0.0_dp) cycle
          x(:n) = mesh_places(mesh, particles%motion(l, :n, c))
          v = drive_velocity(part%drive, x)
          do d = 1, n
            if (part%axes(d)) particles%motion(l, n + d, c) = v(d)
          end do
        end do
      end do
    end associate
  end subroutine set_velocities

  !> Numbers the parts of every field, and says where their sums are among those of a step.
  subroutine driven_number(model, parts, terms)
    type(model_t), intent(inout) :: model
    integer, intent(out) :: parts(:), terms(:)   !! (fields)
    integer :: f, b, i, before
    before = size(model%bodies)*(sweep_sums + model%method%removed) + nodes_sums
    parts = 0
    do f = 1, size(parts)
      do b = 1, size(model%bodies)
        if (model%bodies(b)%field /= f) cycle
        do i = 1, body_parts(model%bodies(b))
          parts(f) = parts(f) + 1
          model%bodies(b)%driven(i)%number = parts(f)
        end do
      end do
      terms(f) = before + drive_sums*sum(parts(:f - 1))
    end do
  end subroutine driven_number

end module sgmp_driven_build
