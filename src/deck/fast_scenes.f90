!> What a deck leaves to the program and a slow scene does not need (doc/materials.md, Fast scenes).
!! Where bodies are fast at the start, pressures differ or something explodes, shocks run, and
!!
!! * materials with an equation of state and no card `viscosity` get a bulk viscosity,
!! * liquids without a card `failure` bear no tension. They bear none in slower scenes either,
!!   where loads, moved parts or speeds make more than weak sound, and there is no gravity, or
!!   pressures from outside outweigh it by far,
!! * metals with an equation of state that no card lets fail are torn where it ends.
module sgmp_fast_scenes
  use sgmp_constitutive, only: constitutive_t, law_bends, law_cavitate, law_first_pressure, &
                               law_is_spherical, law_liquid, law_may_cavitate, law_may_shock, &
                               law_may_tear, law_spread_shocks, law_tear, material_explosive
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_blast, load_pressure, load_traction
  use sgmp_scene, only: load_card_t, scene_t
  use sgmp_shapes, only: shapes_box
  implicit none
  private
  public :: fast_scene_settle, largest_load_of, largest_speed_of, liquid_thrown, speed_at_start, &
            velocity_at_start

  ! Speeds over that of sound in the bulk.
  real(dp), parameter :: tears = 0.2_dp        !! a ball on a plate tears from a third of it on
  real(dp), parameter :: shocks = 0.1_dp       !! of solids and gases: stress behind a front is off
                                               !! by a fifth and more
  real(dp), parameter :: hammers = 0.02_dp     !! of liquids, soils, by bodies that fly as a whole
  real(dp), parameter :: whispers = 1.0e-4_dp  !! of liquids: rho c v is 0.2 MPa in water
  real(dp), parameter :: outweighs = 10.0_dp   !! pressure of loads over that of a liquid's weight

  !> How fast a scene begins.
  type :: pace_t
    real(dp) :: anywhere = 0.0_dp    !! largest speed
    real(dp) :: whole = 0.0_dp       !! the same of bodies that fly as a whole
    real(dp) :: pressure = 0.0_dp    !! largest step of the pressure of fluids
    real(dp) :: load = 0.0_dp        !! largest pressure of loads; huge: of an air blast
    real(dp) :: head = 0.0_dp        !! gravity times height of all bodies along it
    logical :: explodes = .false.
  end type pace_t

contains

  !> Gives materials what a fast scene needs, and their cards do not say.
  subroutine fast_scene_settle(scene)
    type(scene_t), intent(inout) :: scene
    type(pace_t) :: pace
    integer :: m
    pace = pace_of(scene)
    do m = 1, size(scene%materials)
      associate (law => scene%materials(m)%law)
        if (law_may_tear(law) .and. (pace%explodes .or. pace%anywhere > tears*law%bulk_speed)) then
          call law_tear(law)
        end if
        if (law_may_cavitate(law) .and. is_stirred(law, scene, pace)) call law_cavitate(law)
        if (.not. is_hit(law, pace)) cycle
        if (law_may_shock(law)) call law_spread_shocks(law, pace%explodes)
      end associate
    end do
  end subroutine fast_scene_settle

  !> Whether more than sound of little pressure runs through a liquid: it would open where it is
  !! drawn. Whoever looks at such sound alone means the tension that goes with it; and under gravity
  !! liquids are made softer than they are, so that their sound is no small one: water in a tank
  !! that is shaken would open, and splash with three times the energy. Of pressures that outweigh
  !! the liquid by far that is not so.
  pure function is_stirred(law, scene, pace) result(yes)
    type(constitutive_t), intent(in) :: law
    type(scene_t), intent(in) :: scene
    type(pace_t), intent(in) :: pace
    logical :: yes
    integer :: b
    yes = is_hit(law, pace)
    if (yes .or. size(scene%bodyforces) > 0) return
    if (any(abs(scene%gravity) > 0.0_dp)) then
      yes = pace%load > outweighs*law%density*pace%head
      return
    end if
    yes = max(pace%anywhere, pace%whole) > whispers*law%bulk_speed .or. &
          pace%pressure > whispers*law%density*law%bulk_speed**2 .or. &
          size(scene%loads) + size(scene%motions) > 0
    do b = 1, size(scene%bodies)
      if (.not. scene%bodies(b)%rigid) cycle
      yes = yes .or. any(scene%bodies(b)%motion%uses_time)
    end do
  end function is_stirred

  !> Whether a liquid is hit or flies, and nothing but fluids deforms.
  function liquid_thrown(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    type(pace_t) :: pace
    integer :: b
    yes = .false.
    pace = pace_of(scene)
    if (pace%explodes) return
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%rigid .or. scene%bodies(b)%material == 0) cycle
      associate (law => scene%materials(scene%bodies(b)%material)%law)
        yes = yes .or. (law_liquid(law) .and. is_hit(law, pace))
        if (law_is_spherical(law)) cycle
        yes = .false.
        return
      end associate
    end do
  end function liquid_thrown

  !> Largest speed of any body at the start.
  function largest_speed_of(scene) result(speed)
    type(scene_t), intent(in) :: scene
    real(dp) :: speed
    type(pace_t) :: pace
    pace = pace_of(scene)
    speed = pace%anywhere
  end function largest_speed_of

  !> Largest pressure or traction of loads; huge: of an air blast.
  function largest_load_of(scene) result(load)
    type(scene_t), intent(in) :: scene
    real(dp) :: load
    integer :: i
    load = 0.0_dp
    do i = 1, size(scene%loads)
      load = max(load, load_peak(scene%loads(i), scene%time%end))
    end do
  end function largest_load_of

  !> How fast a scene begins.
  function pace_of(scene) result(pace)
    type(scene_t), intent(in) :: scene
    type(pace_t) :: pace
    integer :: b, n
    n = scene%dimension
    do b = 1, size(scene%bodies)
      pace%anywhere = max(pace%anywhere, largest_speed(scene, b, n))
      pace%whole = max(pace%whole, speed_at_start(scene, b, n), speed_when_driven(scene, b, n))
      if (scene%bodies(b)%material == 0) cycle
      associate (law => scene%materials(scene%bodies(b)%material)%law)
        pace%explodes = pace%explodes .or. law%kind == material_explosive
      end associate
    end do
    pace%pressure = pressure_step(scene)
    pace%load = largest_load_of(scene)
    pace%head = head_of(scene)
  end function pace_of

  !> Largest pressure or traction of a load within a time.
  function load_peak(load, time) result(peak)
    type(load_card_t), intent(in) :: load
    real(dp), intent(in) :: time
    real(dp) :: peak
    real(dp), parameter :: nowhere(3) = 0.0_dp
    integer, parameter :: looks = 40
    real(dp) :: value(3)
    integer :: d, i
    peak = 0.0_dp
    if (load%kind == load_blast) peak = huge(1.0_dp)
    if (all(load%kind /= [load_pressure, load_traction])) return
    do i = 0, merge(looks, 0, time < huge(1.0_dp))
      ! More looks at the start, where pulses are.
      value = [(load%value(d)%evaluate(nowhere, nowhere, time*(real(i, dp)/looks)**4), d=1, 3)]
      if (all(abs(value) < huge(1.0_dp))) peak = max(peak, norm2(value))
    end do
  end function load_peak

  !> Gravity times the height of all bodies together.
  pure function head_of(scene) result(head)
    type(scene_t), intent(in) :: scene
    real(dp) :: head
    real(dp) :: lower(3), upper(3), low(3), high(3)
    integer :: b
    head = 0.0_dp
    low = huge(1.0_dp)
    high = -huge(1.0_dp)
    do b = 1, size(scene%bodies)
      if (.not. allocated(scene%bodies(b)%shapes)) cycle
      if (size(scene%bodies(b)%shapes) == 0) cycle
      call shapes_box(scene%bodies(b)%shapes, lower, upper)
      low = min(low, lower)
      high = max(high, upper)
    end do
    if (any(high < low)) return
    head = sum(abs(scene%gravity)*(high - low), mask=abs(scene%gravity) > 0.0_dp)
  end function head_of

  !> Whether what moves or pushes at the start makes shocks in a material. A step of the pressure
  !! moves matter by the pressure over density and speed of sound.
  pure function is_hit(law, pace) result(yes)
    type(constitutive_t), intent(in) :: law
    type(pace_t), intent(in) :: pace
    logical :: yes
    yes = pace%explodes .or. pace%anywhere > shocks*law%bulk_speed
    if (law_liquid(law) .or. .not. (law_bends(law) .or. law_is_spherical(law))) then
      yes = yes .or. pace%whole > hammers*law%bulk_speed
    end if
    if (.not. law_bends(law)) then
      yes = yes .or. pace%pressure > shocks*law%density*law%bulk_speed**2
    end if
  end function is_hit

  !> Largest difference of the pressures of fluids at the start.
  pure function pressure_step(scene) result(step)
    type(scene_t), intent(in) :: scene
    real(dp) :: step
    real(dp) :: least, most, pressure
    integer :: b
    least = huge(1.0_dp)
    most = -huge(1.0_dp)
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%rigid .or. scene%bodies(b)%material == 0) cycle
      associate (law => scene%materials(scene%bodies(b)%material)%law)
        if (law_bends(law)) cycle
        pressure = law_first_pressure(law)
        least = min(least, pressure)
        most = max(most, pressure)
      end associate
    end do
    step = max(0.0_dp, most - least)
  end function pressure_step

  !> Speed at the start of a rigid body whose motion is prescribed; 0 of others.
  function speed_when_driven(scene, b, n) result(speed)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, n        !! body, axes
    real(dp) :: speed
    real(dp), parameter :: origin(3) = 0.0_dp
    real(dp) :: velocity(n)
    integer :: d
    speed = 0.0_dp
    associate (body => scene%bodies(b))
      if (body%free .or. .not. body%rigid) return
      velocity = [(body%motion(d)%evaluate(origin, origin, 0.0_dp), d=1, n)]
      if (all(abs(velocity) < huge(1.0_dp))) speed = norm2(velocity)
    end associate
  end function speed_when_driven

  !> Largest speed of a body at the start: of a rigid one that of its motion, of a formula at the
  !! corners of the box around it, and in its middle.
  function largest_speed(scene, b, n) result(speed)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, n        !! body, axes
    real(dp) :: speed
    real(dp) :: box(3, 0:1), place(3), velocity(n)
    integer :: corner, d
    speed = speed_at_start(scene, b, n)
    associate (body => scene%bodies(b))
      if (body%rigid .and. .not. body%free) then
        speed = speed_when_driven(scene, b, n)
        return
      end if
      if (all(body%velocity(:n)%is_constant) .or. .not. allocated(body%shapes)) return
      call shapes_box(body%shapes, box(:, 0), box(:, 1))
      do corner = 0, 2**n
        place = 0.0_dp
        place(:n) = [(box(d, merge(1, 0, btest(corner, d - 1))), d=1, n)]
        if (corner == 2**n) place(:n) = 0.5_dp*(box(:n, 0) + box(:n, 1))
        velocity = [(body%velocity(d)%evaluate(place, place, 0.0_dp), d=1, n)]
        if (all(abs(velocity) < huge(1.0_dp))) speed = max(speed, norm2(velocity))
      end do
    end associate
  end function largest_speed

  !> Speed of a body at the start; 0 where it is not the same everywhere.
  pure function speed_at_start(scene, b, n) result(speed)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, n        !! body, axes
    real(dp) :: speed
    speed = norm2(velocity_at_start(scene, b, n))
  end function speed_at_start

  !> Velocity of a body at the start; 0 where it is not the same everywhere.
  pure function velocity_at_start(scene, b, n) result(velocity)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: b, n        !! body, axes
    real(dp) :: velocity(3)
    velocity = 0.0_dp
    associate (start => scene%bodies(b)%velocity(:n))
      if (all(start%is_constant)) velocity(:n) = start%value
    end associate
  end function velocity_at_start

end module sgmp_fast_scenes
