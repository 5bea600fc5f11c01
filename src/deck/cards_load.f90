!> The cards `velocity`, `gravity`, `bodyforce`, `damping` and `detonation`: what sets bodies in
!! motion, and to rest.
module sgmp_cards_load
  use sgmp_constitutive, only: material_explosive
  use sgmp_deck_card, only: deck_card_t
  use sgmp_expression, only: expression_clone, expression_free, expression_t
  use sgmp_keys, only: kind_expression, kind_logical, kind_name_word, kind_real, &
                       kind_vector
  use sgmp_kinds, only: dp
  use sgmp_registry, only: registry_t
  use sgmp_scene, only: bodyforce_card_t, detonation_card_t
  use sgmp_scene_draft, only: draft_t
  use sgmp_space, only: axis_names, omega_names, space_axisymmetric
  implicit none
  private
  public :: register_load

contains

  !> Registers the cards of this group.
  subroutine register_load(registry)
    type(registry_t), intent(inout) :: registry
    integer :: axis
    call registry%card('velocity', 'Initial velocity of a body.', 'velocity rod z="-190"', &
                       read_velocity, check_velocity)
    call registry%key('body', kind_name_word, 'the body; default: all', default='all', slot=1)
    call register_components(registry, 'speed')
    call registry%key('spin', kind_expression, 'angular velocity about the axis, radians per '// &
                      'time, in an axisymmetric scene with swirl', unit='1/time', default='0')
    do axis = 1, 3
      call registry%key(omega_names(axis), kind_real, 'angular velocity about an axis, radians '// &
                        'per time', unit='1/time', default='0')
    end do
    call registry%key('about', kind_vector, 'a point of those axes; default: the centre of '// &
                      'mass of each body', unit='length')
    call registry%card('gravity', 'Constant acceleration of everything.', 'gravity (0,0,-9.81)', &
                       read_gravity, check_gravity, once=.true.)
    call registry%key('vector', kind_vector, 'acceleration', unit='acceleration', slot=1, &
                      required=.true.)
    call registry%card('bodyforce', 'Force per unit mass as a function of x y z (where the '// &
                       'particle is), x0 y0 z0 (where it was at the start) and t.', &
                       'bodyforce bar x="sin(pi*x0)*cos(t)"', read_bodyforce)
    call registry%key('body', kind_name_word, 'the body; default: all', default='all', slot=1)
    call register_components(registry, 'acceleration')
    call register_damping(registry)
    call registry%card('detonation', 'A point or a plane from which explosives are lit.', &
                       'detonation point=(0,0,0)', read_detonation, check_detonation)
    call registry%key('point', kind_vector, 'the point, or a point of the plane', unit='length', &
                      default='(0,0,0)')
    call registry%key('time', kind_real, 'when', unit='time', default='0')
    call registry%key('normal', kind_vector, 'normal of a plane wave; without it the wave is '// &
                      'spherical')
  end subroutine register_load

  subroutine register_damping(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('damping', 'Slows everything down whose motion is not prescribed: the '// &
                       'way to an equilibrium.', 'damping rate=200', read_damping, &
                       check_damping, once=.true.)
    call registry%key('rate', kind_real, 'force against the velocity, per momentum: free '// &
                      'motion decays with exp(-rate t), vibrations with half of it', &
                      unit='1/time', range='[0,inf)', default='0', source='doc/damping.md')
    call registry%key('kinetic', kind_logical, 'everything stops whenever the kinetic energy '// &
                      'has begun to fall', default='no', source='doc/damping.md')
    call registry%key('until', kind_real, 'no damping from this time on; default: never', &
                      unit='time', range='(0,inf)')
  end subroutine register_damping

  !> Keys x, y, z, or r and z, that are functions of position.
  subroutine register_components(registry, unit)
    type(registry_t), intent(inout) :: registry
    character(*), intent(in) :: unit
    integer :: axis
    do axis = 1, 3
      call registry%key(axis_names(axis, 3), kind_expression, 'component', unit=unit, default='0')
    end do
    call registry%key(axis_names(1, space_axisymmetric), kind_expression, &
                      'component of an axisymmetric scene, in the place of x', unit=unit)
  end subroutine register_components

  subroutine read_velocity(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: named, b, axis
    named = draft%body_of(card, 'body')
    do axis = 1, 3
      associate (value => card%values(card%at(draft%axis_key(axis))), &
                 bodies => draft%scene%bodies)
        if (value%expression%uses_time) then
          call draft%errors%add(value%position, 'the initial velocity cannot depend on t', &
                                'use x, y and z')
        end if
        do b = 1, size(bodies)
          if (named /= 0 .and. named /= b) cycle
          call expression_free(bodies(b)%velocity(axis))
          bodies(b)%velocity(axis) = expression_clone(value%expression)
        end do
      end associate
    end do
    call read_spin(card, named, draft)
    call read_omega(card, named, draft)
  end subroutine read_velocity

  !> A velocity of a body that moves as its card rigid says would be lost.
  subroutine check_velocity(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    integer :: named, axis
    named = findloc(draft%scene%bodies%name == card%word('body'), .true., 1)
    if (named == 0) return                       ! all, or an error already
    associate (body => draft%scene%bodies(named))
      if (.not. body%rigid .or. body%free) return
      do axis = 1, 3
        if (vanishes(card%values(card%at(draft%axis_key(axis)))%expression)) cycle
        call draft%errors%add(card%place('body'), "body '"//trim(body%name)//"' is rigid: it "// &
                              'moves as its card rigid says', 'give that card the velocity, '// &
                              'or free=yes')
        return
      end do
    end associate
  end subroutine check_velocity

  !> The rotation that a card gives to a body, or to all.
  subroutine read_omega(card, named, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: named                 !! the body; 0: all
    type(draft_t), intent(inout) :: draft
    real(dp) :: omega(3)
    integer :: b, axis
    do axis = 1, 3
      omega(axis) = card%number(omega_names(axis))
      if (abs(omega(axis)) <= 0.0_dp .or. draft%turns_about(axis)) cycle
      call draft%errors%add(card%place(omega_names(axis)), 'nothing turns about '// &
                            omega_names(axis)(7:)//' '//draft%in_space(), &
                            merge('in the plane it is omega_z', 'remove it                 ', &
                                  draft%turns_about(3)))
    end do
    if (card%has('about') .and. all(abs(omega) <= 0.0_dp)) then
      call draft%errors%add(card%place('about'), "'about' without a rotation", &
                            'give omega_x, omega_y or omega_z, or remove it')
    end if
    do b = 1, size(draft%scene%bodies)
      if (named /= 0 .and. named /= b) cycle
      associate (body => draft%scene%bodies(b))
        body%spin_at_start = omega
        body%spin_point = huge(1.0_dp)
        if (card%has('about')) body%spin_point = card%vector('about')
      end associate
    end do
  end subroutine read_omega

  !> The angular velocity that a card gives to a body, or to all.
  subroutine read_spin(card, named, draft)
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: named                 !! the body; 0: all
    type(draft_t), intent(inout) :: draft
    integer :: b
    associate (value => card%values(card%at('spin')), bodies => draft%scene%bodies)
      if (.not. (draft%scene%swirl .or. vanishes(value%expression))) then
        call draft%errors%add(value%position, 'the scene has no swirl', &
                              'write dimension axisymmetric swirl=yes, or remove spin')
      else if (value%expression%uses_time) then
        call draft%errors%add(value%position, 'the initial velocity cannot depend on t', &
                              'use r and z')
      end if
      do b = 1, size(bodies)
        if (named /= 0 .and. named /= b) cycle
        call expression_free(bodies(b)%spin)
        bodies(b)%spin = expression_clone(value%expression)
      end do
    end associate
  end subroutine read_spin

  !> Whether a function is zero everywhere.
  pure function vanishes(expression) result(yes)
    type(expression_t), intent(in) :: expression
    logical :: yes
    yes = expression%is_constant .and. abs(expression%value) <= 0.0_dp
  end function vanishes

  subroutine read_gravity(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    draft%scene%gravity = card%vector('vector')
  end subroutine read_gravity

  !> Gravity along the radius has no direction.
  subroutine check_gravity(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    if (.not. draft%scene%axisymmetric .or. abs(draft%scene%gravity(1)) <= 0.0_dp) return
    call draft%errors%add(card%place('vector'), 'gravity along r in an axisymmetric scene', &
                          'write gravity (0,gz); what pulls to the axis is a bodyforce')
  end subroutine check_gravity

  subroutine read_bodyforce(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(bodyforce_card_t) :: new
    integer :: axis
    new%body = draft%body_of(card, 'body')
    if (new%body < 0) return
    new%location = card%position%text()
    do axis = 1, 3
      new%force(axis) = expression_clone(card%values(card%at(draft%axis_key(axis)))%expression)
    end do
    draft%scene%bodyforces = [draft%scene%bodyforces, new]
  end subroutine read_bodyforce

  subroutine read_damping(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    associate (damping => draft%scene%damping)
      damping%rate = card%number('rate')
      damping%kinetic = card%flag('kinetic')
      damping%until = card%number('until', absent=damping%until)
    end associate
  end subroutine read_damping

  subroutine check_damping(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    if (card%position%line == 0 .or. any(card%values%given)) return  ! not in the deck, or with keys
    call draft%errors%add(card%position, 'the damping does not say how', &
                          'write rate=…, kinetic=yes or both')
  end subroutine check_damping

  subroutine read_detonation(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    type(detonation_card_t) :: new
    new%point = card%vector('point')
    new%time = card%number('time')
    new%plane = card%has('normal')
    if (new%plane) new%normal = card%vector('normal')
    if (norm2(new%normal) > 0.0_dp) new%normal = new%normal/norm2(new%normal)
    draft%scene%detonations = [draft%scene%detonations, new]
  end subroutine read_detonation

  subroutine check_detonation(card, draft)
    type(deck_card_t), intent(in) :: card
    type(draft_t), intent(inout) :: draft
    if (any(draft%scene%materials%law%kind == material_explosive)) return
    call draft%errors%add(card%position, 'a detonation without an explosive', &
                          'add a material of kind explosive, or remove this card')
  end subroutine check_detonation

end module sgmp_cards_load
