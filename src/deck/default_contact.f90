!> Contact where the deck does not speak of it (doc/contact.md, Without a card).
!!
!! For two bodies that no card `contact` or `group` is for:
!!
!! * solids touch without friction;
!! * but those that share a surface at the start and move alike there are bonded, as by a `group`;
!! * a solid and a liquid touch; in one dimension unless they lie on each other and move alike.
!!
!! Where any of these touch, solids touch gases, too; where none does, all bodies share one field.
!! Of more than 64 bodies or groups none touches: a field for each would be dear.
module sgmp_default_contact
  use sgmp_constitutive, only: law_is_spherical, law_liquid, law_sound
  use sgmp_fast_scenes, only: largest_speed_of
  use sgmp_kinds, only: dp
  use sgmp_scene, only: body_card_t, contact_card_t, scene_t
  use sgmp_shapes, only: shapes_box, surface_depth
  use sgmp_turn, only: turn_back, turn_box
  implicit none
  private
  public :: contact_leader, default_contact_settle, solids_flow, solids_side

  real(dp), parameter :: joined = 1.0e-4_dp   !! cells: so near, surfaces are one
  real(dp), parameter :: wide = 0.5_dp        !! cells: so far that is to reach
  real(dp), parameter :: flows = 0.1_dp       !! of the speed of sound: what is faster flows
  integer, parameter :: most_groups = 64      !! that touch without a card: each is a field
  real(dp), parameter :: alike = 1.0e-9_dp    !! of the speeds: so near, bodies move alike
  integer, parameter :: starts = 3            !! places per axis from which a gap is looked for
  integer, parameter :: projections = 40      !! of a point onto two bodies in turn

contains

  !> Adds the card `contact all` where bodies may meet that no card names, and groups of solids that
  !! are bonded.
  subroutine default_contact_settle(scene)
    type(scene_t), intent(inout) :: scene
    logical :: apart(size(scene%bodies), size(scene%bodies))
    integer :: a, b
    call bond(scene, apart)
    do a = 1, size(scene%bodies)
      do b = a + 1, size(scene%bodies)
        if (.not. (apart(a, b) .or. passes_by(scene, a, b))) cycle
        if (is_named(scene, a, b) .or. in_one_group(scene, a, b)) cycle
        if (scene%features%reference) then
          scene%features%meeting = [a, b]
          return
        end if
        scene%many_groups = groups(scene)
        if (scene%many_groups > most_groups) return
        scene%many_groups = 0
        scene%contacts = [scene%contacts, contact_card_t(unasked=.true.)]
        return
      end do
    end do
  end subroutine default_contact_settle

  !> Bonds what no card is for and is one piece; what is not shall touch.
  subroutine bond(scene, apart)
    type(scene_t), intent(inout) :: scene
    logical, intent(out) :: apart(:, :)          !! which pairs shall touch
    integer :: a, b
    apart = .false.
    do a = 1, size(scene%bodies)
      do b = a + 1, size(scene%bodies)
        if (.not. concerns(scene, a, b)) cycle
        if (is_named(scene, a, b) .or. in_one_group(scene, a, b)) cycle
        if (is_liquid(scene, a) .or. is_liquid(scene, b)) then
          apart(a, b) = scene%dimension > 1 .or. .not. are_bonded(scene, a, b)
          cycle
        end if
        apart(a, b) = .not. are_bonded(scene, a, b)
        if (apart(a, b)) cycle
        apart(a, b) = .not. may_share(scene, a, b)
        if (.not. apart(a, b)) call join(scene, a, b)
      end do
    end do
  end subroutine bond

  !> Whether solids touch in a scene so fast that they flow along each other: without more, contact
  !! does not keep metals that are stretched far out of each other.
  function solids_flow(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    real(dp) :: speed
    integer :: a, b
    yes = .false.
    if (scene%dimension == 1 .or. size(scene%contacts) == 0) return
    speed = largest_speed_of(scene)
    do a = 1, size(scene%bodies)
      if (.not. is_solid(scene, a)) cycle
      do b = a, size(scene%bodies)
        if (.not. (is_solid(scene, b) .and. is_named(scene, a, b))) cycle
        if (in_one_group(scene, a, b) .and. .not. touches_itself(scene, a)) cycle
        yes = is_fast(scene, a, b, speed)
        if (yes) return
      end do
    end do
  end function solids_flow

  !> Longest side of the particles of solids at the start (cells).
  pure function solids_side(scene) result(side)
    type(scene_t), intent(in) :: scene
    real(dp) :: side
    integer :: b
    side = maxval([(scene%bodies(b)%spacing, b=1, size(scene%bodies))], &
                  mask=[(is_solid(scene, b), b=1, size(scene%bodies))])/scene%grid%cell
  end function solids_side

  !> Whether two solids flow into each other like liquids in a scene as fast as this.
  pure function is_fast(scene, a, b, speed) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    real(dp), intent(in) :: speed                !! largest at the start
    logical :: yes
    yes = any(speed > flows*law_sound(scene%materials(scene%bodies([a, b])%material)%law))
  end function is_fast

  !> Number of bodies and groups of them that deform.
  pure function groups(scene) result(number)
    type(scene_t), intent(in) :: scene
    integer :: number, b
    number = count([(contact_leader(scene, b) == b .and. .not. scene%bodies(b)%rigid, &
                     b=1, size(scene%bodies))])
  end function groups

  !> Whether a solid and what flows would pass through each other, because a card names one of them
  !! and others.
  pure function passes_by(scene, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    logical :: yes
    yes = size(scene%contacts) > 0 .and. .not. any(scene%bodies([a, b])%rigid) .and. &
          all(scene%bodies([a, b])%material > 0) .and. &
          (is_solid(scene, a) .neqv. is_solid(scene, b))
  end function passes_by

  !> Whether two bodies are solids, or a solid and a liquid.
  pure function concerns(scene, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    logical :: yes
    yes = (is_solid(scene, a) .and. (is_solid(scene, b) .or. is_liquid(scene, b))) .or. &
          (is_liquid(scene, a) .and. is_solid(scene, b))
  end function concerns

  pure function is_liquid(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    yes = .not. scene%bodies(b)%rigid .and. scene%bodies(b)%material > 0
    if (yes) yes = law_liquid(scene%materials(scene%bodies(b)%material)%law)
  end function is_liquid

  !> Whether a body deforms and bears shear.
  pure function is_solid(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    yes = .not. scene%bodies(b)%rigid .and. scene%bodies(b)%material > 0
    if (yes) yes = .not. law_is_spherical(scene%materials(scene%bodies(b)%material)%law)
  end function is_solid

  !> Whether a card `contact` is for two bodies.
  pure function is_named(scene, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    logical :: yes
    integer :: c, pair(2)
    pair = [contact_leader(scene, a), contact_leader(scene, b)]
    yes = .false.
    do c = 1, size(scene%contacts)
      associate (named => scene%contacts(c)%body)
        yes = yes .or. all(named == 0 .or. named == pair(1) .or. named == pair(2))
      end associate
    end do
  end function is_named

  !> Whether a card `contact` lets a body touch itself.
  pure function touches_itself(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    integer :: c
    yes = .false.
    do c = 1, size(scene%contacts)
      associate (card => scene%contacts(c))
        yes = yes .or. (card%self .and. any(card%body == 0 .or. &
                                            card%body == contact_leader(scene, b)))
      end associate
    end do
  end function touches_itself

  !> The first body of a body's group, itself where it has none.
  pure function contact_leader(scene, b) result(leader)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    integer :: leader
    leader = merge(scene%bodies(b)%leader, b, scene%bodies(b)%leader > 0)
  end function contact_leader

  pure function in_one_group(scene, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    logical :: yes
    yes = contact_leader(scene, a) == contact_leader(scene, b)
  end function in_one_group

  !> Whether two bodies may be one group: others must not touch them in different ways.
  pure function may_share(scene, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    logical :: yes
    integer :: c
    yes = .true.
    do c = 1, size(scene%contacts)
      yes = yes .and. alike_cards(scene%contacts(1), scene%contacts(c))
    end do
    yes = yes .or. .not. (names_alone(scene, a) .and. names_alone(scene, b))
  end function may_share

  pure function alike_cards(one, two) result(yes)
    type(contact_card_t), intent(in) :: one, two
    logical :: yes
    yes = one%normal == two%normal .and. (one%self .eqv. two%self) .and. &
          abs(one%friction - two%friction) <= 0.0_dp .and. &
          abs(one%lambda - two%lambda) <= 0.0_dp .and. abs(one%depth - two%depth) <= 0.0_dp
  end function alike_cards

  !> Whether a card `contact` names a body, or its group.
  pure function names_alone(scene, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b
    logical :: yes
    integer :: c
    yes = .false.
    do c = 1, size(scene%contacts)
      yes = yes .or. any(scene%contacts(c)%body == contact_leader(scene, b))
    end do
  end function names_alone

  !> Makes two bodies, and the groups they are in, one group; cards `contact` follow.
  pure subroutine join(scene, a, b)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: a, b
    integer :: c, first, i, pair(2)
    pair = [contact_leader(scene, a), contact_leader(scene, b)]
    first = minval(pair)
    do i = 1, size(scene%bodies)
      if (any(contact_leader(scene, i) == pair)) scene%bodies(i)%leader = first
    end do
    do c = 1, size(scene%contacts)
      where (scene%contacts(c)%body == maxval(pair)) scene%contacts(c)%body = first
    end do
  end subroutine join

  !> Whether two bodies share a surface at the start, and move alike there.
  function are_bonded(scene, a, b) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: a, b
    logical :: yes
    real(dp) :: places(3, starts**3)
    integer :: found, i
    places = 0.0_dp
    found = 1
    yes = .true.
    associate (one => scene%bodies(a), two => scene%bodies(b), n => scene%dimension)
      if (has_shapes(one) .and. has_shapes(two)) then
        call find_touch(one, two, n, scene%grid%cell, places, found)
        yes = reaches(places(:, :found), n, wide*scene%grid%cell)
      end if
      do i = 1, found
        yes = yes .and. move_alike(one, two, places(:, i), n)
      end do
    end associate
  end function are_bonded

  !> Whether a body is made of shapes; its particles come from a file else.
  pure logical function has_shapes(body) result(yes)
    type(body_card_t), intent(in) :: body
    yes = allocated(body%shapes)
    if (yes) yes = size(body%shapes) > 0
  end function has_shapes

  !> Whether places lie on a surface of some width, not about a point or, in space, on a line.
  pure function reaches(places, n, far) result(yes)
    real(dp), intent(in) :: places(:, :)         !! (3, number)
    integer, intent(in) :: n                     !! axes
    real(dp), intent(in) :: far                  !! length
    logical :: yes
    real(dp) :: along(3), beside(3, size(places, 2))
    yes = size(places, 2) > 0
    if (n == 1 .or. .not. yes) return
    beside = places - spread(places(:, 1), 2, size(places, 2))
    along = beside(:, maxloc(norm2(beside, dim=1), dim=1))
    yes = norm2(along) > far
    if (n == 2 .or. .not. yes) return
    along = along/norm2(along)
    beside = beside - spread(along, 2, size(places, 2))*spread(matmul(along, beside), 1, 3)
    yes = maxval(norm2(beside, dim=1)) > far
  end function reaches

  !> Places where two bodies touch.
  pure subroutine find_touch(one, two, n, cell, places, found)
    type(body_card_t), intent(in) :: one, two
    integer, intent(in) :: n                     !! axes
    real(dp), intent(in) :: cell                 !! length
    real(dp), intent(inout) :: places(:, :)      !! (3, at most) the first of them are found
    integer, intent(out) :: found
    real(dp) :: box(3, 2), other(3, 2), place(3)
    integer :: at, d, step(3), turn
    found = 0
    box = box_of(one, cell)
    other = box_of(two, cell)
    box(:, 1) = max(box(:, 1), other(:, 1))
    box(:, 2) = min(box(:, 2), other(:, 2))
    if (any(box(:n, 1) > box(:n, 2))) return
    do at = 0, starts**n - 1
      step = [(mod(at/starts**(d - 1), starts), d=1, 3)]
      place = 0.0_dp
      place(:n) = box(:n, 1) + (step(:n) + 0.5_dp)/starts*(box(:n, 2) - box(:n, 1))
      do turn = 1, projections
        call bring_into(one, n, joined*cell, place)
        call bring_into(two, n, joined*cell, place)
        if (min(depth_of(one, place, n), depth_of(two, place, n)) < -joined*cell) cycle
        found = found + 1
        places(:, found) = place
        exit
      end do
    end do
  end subroutine find_touch

  !> The box around a body, a bit wider; what has no end is cut off far out.
  pure function box_of(body, cell) result(box)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: cell
    real(dp) :: box(3, 2)
    real(dp), parameter :: far = 1.0e4_dp        !! cells
    call shapes_box(body%shapes, box(:, 1), box(:, 2))
    call turn_box(body%turn, box(:, 1), box(:, 2))
    box(:, 1) = max(box(:, 1), -far*cell) - joined*cell
    box(:, 2) = min(box(:, 2), far*cell) + joined*cell
  end function box_of

  !> Moves a place outside of a body the shortest way to its surface.
  pure subroutine bring_into(body, n, near, place)
    type(body_card_t), intent(in) :: body
    integer, intent(in) :: n
    real(dp), intent(in) :: near
    real(dp), intent(inout) :: place(3)
    real(dp) :: beside(3), depth, slope(3)
    integer :: d
    depth = depth_of(body, place, n)
    if (depth >= 0.0_dp) return
    slope = 0.0_dp
    do d = 1, n
      beside = place
      beside(d) = place(d) + 0.01_dp*near
      slope(d) = depth_of(body, beside, n)
      beside(d) = place(d) - 0.01_dp*near
      slope(d) = slope(d) - depth_of(body, beside, n)
    end do
    place = place - depth*slope/max(norm2(slope), tiny(1.0_dp))
  end subroutine bring_into

  !> How deep a place lies in a body; negative outside.
  pure function depth_of(body, place, n) result(depth)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: place(3)
    integer, intent(in) :: n
    real(dp) :: depth, point(3)
    point = place
    call turn_back(body%turn, point)
    depth = surface_depth(body%shapes, point, n)
  end function depth_of

  !> Whether two bodies have the same velocity at a place at the start.
  function move_alike(one, two, place, n) result(yes)
    type(body_card_t), intent(in) :: one, two
    real(dp), intent(in) :: place(3)
    integer, intent(in) :: n
    logical :: yes
    real(dp) :: velocity(3, 2), spin(2)
    integer :: d
    velocity = 0.0_dp
    do d = 1, n
      velocity(d, :) = [one%velocity(d)%evaluate(place, place, 0.0_dp), &
                        two%velocity(d)%evaluate(place, place, 0.0_dp)]
    end do
    spin = [one%spin%evaluate(place, place, 0.0_dp), two%spin%evaluate(place, place, 0.0_dp)]
    yes = norm2(velocity(:, 1) - velocity(:, 2)) <= &
          alike*(norm2(velocity(:, 1)) + norm2(velocity(:, 2)))
    yes = yes .and. abs(spin(1) - spin(2)) <= alike*sum(abs(spin))
    if (any(abs([one%spin_at_start, two%spin_at_start]) > 0.0_dp)) then
      yes = yes .and. all(abs(one%spin_at_start - two%spin_at_start) <= 0.0_dp) .and. &
            all(abs(one%spin_point - two%spin_point) <= 0.0_dp) .and. &
            all(one%spin_point < huge(1.0_dp))
    end if
  end function move_alike

end module sgmp_default_contact
