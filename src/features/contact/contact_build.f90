!> From the cards `contact` and `rigid` to pairs of bodies and the fields that they need.
module sgmp_contact_build
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: law_gaseous, law_is_spherical, law_liquid
  use sgmp_contact_pairs, only: contact_pair_t, normal_first, normal_second, normal_separating, &
                                normal_stiffer
  use sgmp_default_contact, only: contact_leader
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: slots_ask, slots_t
  use sgmp_mesh, only: mesh_places, mesh_sides, mesh_t
  use sgmp_model, only: model_t
  use sgmp_patches, only: patch_of
  use sgmp_scene, only: body_card_t, contact_card_t, layout_file, layout_graded, scene_t
  use sgmp_shapes, only: shape_block, shape_cylinder, shapes_box, surface_depth
  use sgmp_space, only: space_axisymmetric
  use sgmp_surface_particles, only: surface_covered
  use sgmp_turn, only: turn_back, turn_same
  implicit none
  private
  public :: contact_pairs, contact_fields, contact_add_slot, contact_fill_slot, &
            contact_no_surface, contact_self

  !> Surface offset (cells) of particles that are never outermost: too far out, unused lanes.
  real(dp), parameter :: contact_no_surface = -2.0e3_dp
  real(dp), parameter :: outside = 0.05_dp   !! part of the spacing by which a particle may lie out
  real(dp), parameter :: interior = 0.95_dp  !! particles with a larger offset are covered by others
  !> How far outside of a body that is held (cells) contact acts at nodes, between blocks. Farther
  !! ones would hold a layer of the other body, which then bears no stress; round bodies want them,
  !! for they touch in a patch of few cells, which would give way, and sharp ones, which would cut
  !! in (doc/contact.md).
  real(dp), parameter :: held_reach = 0.5_dp
  !> The same outside of any solid that a liquid wets: farther nodes would carry a layer of the
  !! liquid along, nearer ones alone would let it come and go (class Slam of the random scenes).
  real(dp), parameter :: wet_reach = 0.75_dp

contains

  !> Lists the pairs of groups that may touch, and gives each group a velocity field of its own.
  subroutine contact_pairs(scene, model)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(inout) :: model
    type(contact_pair_t) :: pair
    integer :: a, b, first, n, side, card(size(model%bodies), size(model%bodies))
    integer :: leader(size(model%bodies)), of(size(model%bodies))
    n = size(scene%bodies)
    of = [(merge(model%bodies(b)%twin_of, b, model%bodies(b)%twin_of > 0), b=1, size(of))]
    leader = [(contact_leader(scene, of(b)), b=1, size(leader))]
    card = cards_between(scene, leader, model)
    call group_bodies(card(:n, :n), leader(:n), model%bodies(:n))
    call field_twins(n, model%bodies)
    allocate (model%contact%pairs(0))
    do a = 1, size(model%bodies)
      do b = a + 1, size(model%bodies)
        if (model%bodies(a)%field == model%bodies(b)%field) cycle
        first = best_card(scene%contacts, leader(a), leader(b))
        if (model%bodies(a)%family > 0 .and. &
            model%bodies(a)%family == model%bodies(b)%family) then
          first = self_card(scene%contacts, leader(a))
          pair = make_pair(scene%contacts(first), [a, b], of, model)
          pair%family = model%bodies(a)%family
        else
          if (card(a, b) == 0) cycle
          pair = make_pair(scene%contacts(first), [a, b], of, model)
        end if
        pair%field = model%bodies(pair%body)%field
        pair%kind = merge(model%bodies(pair%body)%family, pair%field, &
                          model%bodies(pair%body)%family > 0)
        if (is_listed(model%contact%pairs, pair%field)) cycle
        pair%held = [(is_held(scene, model, pair%body(side)), side=1, 2)]
        pair%firm = pair%held
        if (wets(model, pair)) then
          pair%firm = .not. [(is_liquid(model, pair%field(side)), side=1, 2)]
          pair%reach = wet_reach
        else if (any(pair%held)) then
          pair%reach = reach_of(scene, model, pair)
        end if
        pair%fills = pair%normal == normal_separating .and. &
                     any(law_is_spherical(model%bodies%law) .and. &
                         (model%bodies%field == pair%field(1) .or. &
                          model%bodies%field == pair%field(2)))
        model%contact%pairs = [model%contact%pairs, pair]
      end do
    end do
    model%contact%self%on = any(model%bodies%family > 0)
    ! Without friction the surface and the nodes are alike, and the levers would be worked out for
    ! nothing.
    model%contact%at_surface = model%method%rubs_at_surface .and. &
                               any(model%contact%pairs%friction > 0.0_dp)
  end subroutine contact_pairs

  !> Fields of the twins: one for each label of a family.
  pure subroutine field_twins(n, bodies)
    integer, intent(in) :: n                     !! bodies that are no twins
    type(body_t), intent(inout) :: bodies(:)
    integer :: a, b, fields
    fields = maxval(bodies(:n)%field)
    do b = n + 1, size(bodies)
      associate (of => bodies(bodies(b)%twin_of))
        of%family = of%field
        bodies(b)%family = of%field
      end associate
      do a = n + 1, b - 1
        if (bodies(a)%family == bodies(b)%family .and. bodies(a)%label == bodies(b)%label) exit
      end do
      if (a == b) fields = fields + 1
      bodies(b)%field = fields
      if (a < b) bodies(b)%field = bodies(a)%field
    end do
  end subroutine field_twins

  !> Whether a card says that a body touches itself.
  pure function contact_self(scene, number) result(yes)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number                !! of the body
    logical :: yes
    yes = .not. scene%bodies(number)%rigid .and. &
          .not. law_is_spherical(scene%materials(scene%bodies(number)%material)%law)
    if (yes) yes = self_card(scene%contacts, contact_leader(scene, number)) > 0
  end function contact_self

  !> The card by which a body touches itself, the one that names it before one for all; 0: none.
  pure function self_card(cards, body) result(best)
    type(contact_card_t), intent(in) :: cards(:)
    integer, intent(in) :: body
    integer :: best, c
    best = 0
    do c = 1, size(cards)
      if (.not. cards(c)%self) cycle
      if (any(cards(c)%body == body)) then
        best = c
        return
      end if
      if (all(cards(c)%body == 0) .and. best == 0) best = c
    end do
  end function self_card

  !> The card that says how two bodies touch, for all of them; 0: they do not. Fluids and explosives
  !! mix unless a card names both.
  pure function cards_between(scene, leader, model) result(card)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: leader(:)             !! of each body's group, itself where it has none
    type(model_t), intent(in) :: model
    integer :: card(size(model%bodies), size(model%bodies))
    integer :: a, b
    logical :: flows(size(model%bodies))
    do a = 1, size(model%bodies)
      flows(a) = law_is_spherical(model%bodies(a)%law)
    end do
    card = 0
    do a = 1, size(model%bodies)
      do b = a + 1, size(model%bodies)
        if (model%bodies(a)%rigid .and. model%bodies(b)%rigid) cycle
        if (leader(a) == leader(b)) cycle
        card(a, b) = best_card(scene%contacts, leader(a), leader(b))
        if (card(a, b) > 0 .and. flows(a) .and. flows(b)) then
          if (any(scene%contacts(card(a, b))%body == 0)) card(a, b) = 0
        end if
        if (card(a, b) > 0) card(a, b) = first_alike(scene%contacts, card(a, b))
        card(b, a) = card(a, b)
      end do
    end do
  end function cards_between

  !> The first card that says the same as another, whatever bodies they name.
  pure function first_alike(cards, c) result(first)
    type(contact_card_t), intent(in) :: cards(:)
    integer, intent(in) :: c
    integer :: first
    do first = 1, c - 1
      if (cards(first)%normal == cards(c)%normal .and. &
          abs(cards(first)%friction - cards(c)%friction) <= 0.0_dp .and. &
          abs(cards(first)%lambda - cards(c)%lambda) <= 0.0_dp .and. &
          abs(cards(first)%depth - cards(c)%depth) <= 0.0_dp) return
    end do
  end function first_alike

  !> Gives every body a velocity field. Bodies of a card group, and those that do not touch each
  !! other, but the same others in the same way, share one: they stick together, or if they flow
  !! they mix.
  !! Those that no card names have the first field; rigid ones each their own.
  pure subroutine group_bodies(card, leader, bodies)
    integer, intent(in) :: card(:, :)            !! between bodies
    integer, intent(in) :: leader(:)             !! of their groups by cards
    type(body_t), intent(inout) :: bodies(:)
    integer :: a, b, fields
    logical :: own(size(bodies))
    own = bodies%rigid .or. any(card > 0, dim=1)
    fields = merge(0, 1, all(own))
    do b = 1, size(bodies)
      bodies(b)%field = 1
      if (.not. own(b)) cycle
      do a = 1, b - 1
        if (.not. own(a) .or. bodies(a)%rigid .or. bodies(b)%rigid) cycle
        if (leader(a) == leader(b)) exit
        if (card(a, b) == 0 .and. all(card(:, a) == card(:, b))) exit
      end do
      if (a < b) then
        bodies(b)%field = bodies(a)%field
      else
        fields = fields + 1
        bodies(b)%field = fields
      end if
    end do
  end subroutine group_bodies

  !> Whether two fields are a pair already.
  pure function is_listed(pairs, field) result(yes)
    type(contact_pair_t), intent(in) :: pairs(:)
    integer, intent(in) :: field(2)
    logical :: yes
    integer :: p
    yes = .false.
    do p = 1, size(pairs)
      yes = yes .or. all(pairs(p)%field == field) .or. all(pairs(p)%field == field([2, 1]))
    end do
  end function is_listed

  !> Adds the column of the surface offset to a body that a contact card speaks of.
  pure subroutine contact_add_slot(scene, number, slots)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    type(slots_t), intent(inout) :: slots
    integer :: c
    do c = 1, size(scene%contacts)
      if (.not. any(scene%contacts(c)%body == contact_leader(scene, number) .or. &
                    scene%contacts(c)%body == 0)) cycle
      call slots_ask(slots, 'surface', [contact_no_surface])
      if (contact_self(scene, number)) call slots_ask(slots, 'patch', [0.0_dp])
      return
    end do
  end subroutine contact_add_slot

  !> Fills it: how much farther than half a spacing a particle is from its body's surface (cells). A
  !! ball of that radius around every particle makes up the body less half a spacing, of whatever
  !! shape it is and however the lattice lies in it.
  pure subroutine contact_fill_slot(card, mesh, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    integer :: c, l, n
    real(dp) :: x(3), offset, wider
    if (body%law%slots%surface == 0) return
    n = mesh%ndim
    do c = 1, body%particles%chunks
      do l = 1, lanes
        if (body%particles%id(l, c) == 0) cycle
        offset = 0.0_dp  ! particles from a file: the surface is half a spacing away
        wider = 0.0_dp
        if (card%layout /= layout_file) then
          x = 0.0_dp
          x(:n) = mesh_places(mesh, body%particles%motion(l, :n, c))
          call turn_back(card%turn, x)
          offset = surface_depth(card%shapes, x, n)/body%spacing - 0.5_dp
          if (card%layout == layout_graded) then  ! the outermost may be farther inside
            wider = 0.5_dp*(maxval(mesh_sides(mesh, body%particles%motion(l, :n, c))) - 1.0_dp)
          end if
        end if
        if (law_gaseous(body%law)) then
          offset = 0.0_dp  ! any particle may come to the front
        else if (offset < -outside) then
          offset = contact_no_surface
        else if (offset > interior + wider) then
          offset = surface_covered
        else
          offset = max(offset, 0.0_dp)*body%spacing*mesh%inverse_h
        end if
        body%particles%state(l, body%law%slots%surface, c) = offset
        if (body%law%slots%patch == 0) cycle
        body%particles%state(l, body%law%slots%patch, c) = &
          real(patch_of(body%particles%motion(l, :n, c)), dp)
      end do
    end do
  end subroutine contact_fill_slot

  !> Number of velocity fields.
  pure function contact_fields(model) result(fields)
    type(model_t), intent(in) :: model
    integer :: fields
    fields = maxval(model%bodies%field)
  end function contact_fields

  !> The card that names most of two bodies, 0 if none speaks of them; of equals the first.
  pure function best_card(cards, a, b) result(best)
    type(contact_card_t), intent(in) :: cards(:)
    integer, intent(in) :: a, b
    integer :: best, c, names, most
    best = 0
    most = -1
    do c = 1, size(cards)
      if (.not. all(cards(c)%body == 0 .or. cards(c)%body == a .or. cards(c)%body == b)) cycle
      names = count(cards(c)%body > 0)
      if (names <= most) cycle
      most = names
      best = c
    end do
  end function best_card

  !> A pair in the order of its card, so that `first` and `second` mean what the card says.
  pure function make_pair(card, two, of, model) result(pair)
    type(contact_card_t), intent(in) :: card
    integer, intent(in) :: two(2)
    integer, intent(in) :: of(:)                 !! body of the deck that each is, or is a twin of
    type(model_t), intent(in) :: model
    type(contact_pair_t) :: pair
    pair%body = two
    if (of(two(1)) > of(two(2))) pair%body = two([2, 1])
    if (card%body(1) == of(pair%body(2)) .or. card%body(2) == of(pair%body(1))) then
      pair%body = pair%body([2, 1])
    end if
    pair%friction = card%friction
    pair%lambda = card%lambda
    if (pair%lambda <= 0.0_dp) then
      pair%lambda = 0.5_dp*sum(model%bodies(pair%body)%spacing)/model%mesh%h
    end if
    pair%spacing = maxval(model%bodies(pair%body)%spacing)/model%mesh%h
    pair%depth = card%depth
    pair%normal = card%normal
    if (pair%normal == normal_stiffer) then
      pair%normal = merge(normal_first, normal_second, &
                          stiffness(model, pair%body(1)) >= stiffness(model, pair%body(2)))
    end if
  end function make_pair

  !> Whether one of two fields is nothing but liquid, and in the other nothing flows.
  pure logical function wets(model, pair) result(yes)
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    integer :: side
    yes = pair%depth >= huge(1.0_dp) .and. &
          (is_liquid(model, pair%field(1)) .neqv. is_liquid(model, pair%field(2)))
    do side = 1, merge(2, 0, yes)
      if (is_liquid(model, pair%field(side))) cycle
      yes = .not. any(law_is_spherical(model%bodies%law) .and. .not. model%bodies%rigid .and. &
                      model%bodies%field == pair%field(side))
    end do
  end function wets

  !> Whether all bodies of a field are liquids.
  pure logical function is_liquid(model, field) result(yes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: field
    yes = all((law_liquid(model%bodies%law) .and. .not. model%bodies%rigid) .or. &
              model%bodies%field /= field)
  end function is_liquid

  !> How far outside of a body that is held nodes are in contact: where it is a block, about the
  !! axis a cylinder, too, and covers the other, another such, which has no body beside it in its
  !! field.
  pure function reach_of(scene, model, pair) result(reach)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    real(dp) :: reach
    integer :: side, b
    reach = huge(1.0_dp)
    if (pair%depth < reach .or. any(law_is_spherical(model%bodies(pair%body)%law))) return
    if (any(pair%body > size(scene%bodies))) return
    do side = 1, 2
      associate (card => scene%bodies(pair%body(side)))
        if (count(model%bodies%field == pair%field(side)) /= 1) return
        if (.not. allocated(card%shapes)) return
        if (size(card%shapes) /= 1) return
        if (card%shapes(1)%kind /= shape_block .and. &
            .not. (scene%axisymmetric .and. card%shapes(1)%kind == shape_cylinder)) return
      end associate
    end do
    b = findloc(pair%held, .true., dim=1)
    if (covers(scene%bodies(pair%body(b)), scene%bodies(pair%body(3 - b)), model%mesh)) then
      reach = held_reach
    end if
  end function reach_of

  !> Whether the face of a block that looks at another at the start covers that.
  pure function covers(card, other, mesh) result(yes)
    type(body_card_t), intent(in) :: card, other
    type(mesh_t), intent(in) :: mesh
    logical :: yes
    logical, dimension(mesh%ndim) :: apart, within
    real(dp) :: own(3, 2), its(3, 2), slack
    slack = 0.01_dp*mesh%h
    call shapes_box(card%shapes, own(:, 1), own(:, 2))
    call shapes_box(other%shapes, its(:, 1), its(:, 2))
    if (mesh%space == space_axisymmetric) then  ! nothing is on the other side of the axis
      own(1, 1) = max(0.0_dp, own(1, 1))
      its(1, 1) = max(0.0_dp, its(1, 1))
    end if
    associate (n => mesh%ndim)
      apart = own(:n, 1) > its(:n, 2) - slack .or. own(:n, 2) < its(:n, 1) + slack
      within = own(:n, 1) < its(:n, 1) + slack .and. own(:n, 2) > its(:n, 2) - slack
    end associate
    yes = turn_same(card%turn, other%turn) .and. count(apart) == 1 .and. all(apart .or. within)
  end function covers

  !> Whether a body moves as prescribed, as a whole.
  pure function is_held(scene, model, b) result(yes)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    logical :: yes
    integer :: m
    yes = model%bodies(b)%rigid
    do m = 1, size(scene%motions)
      associate (motion => scene%motions(m))
        if (motion%body /= b .or. .not. all(motion%axes(:model%mesh%ndim))) cycle
        yes = yes .or. (motion%where%is_constant .and. abs(motion%where%value) > 0.0_dp .and. &
                        motion%until >= huge(1.0_dp))
      end associate
    end do
  end function is_held

  !> Stiffness that the option normal=stiffer compares.
  pure function stiffness(model, b) result(k)
    type(model_t), intent(in) :: model
    integer, intent(in) :: b
    real(dp) :: k
    associate (law => model%bodies(b)%law)
      k = law%elastic%bulk
      if (law%rigid) k = huge(1.0_dp)
    end associate
  end function stiffness

end module sgmp_contact_build
