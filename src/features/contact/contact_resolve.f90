!> Contact of several bodies at one grid node: velocities that Coulomb's law admits, and the
!! impulses between the bodies (Eqs. 76-84).
!!
!! Constraint and force are kept apart. What moves with the grid obeys the constraint: bodies do
!! not come closer than the gap between them allows. What the particles receive is the force alone:
!! the impulse that keeps bodies from being pulled into each other during the step. Both and
!! friction are decided once in a step, from the trial velocity; the velocity that strains the
!! particles then obeys the state so found, as an equality where bodies are pressed together. So
!! contact does no work along the normal (doc/contact.md).
!!
!! Every pair of bodies exchanges an impulse. With two bodies it is a closed form. With three or
!! more the impulses depend on each other; they are found by going round the pairs until nothing
!! changes, each pair correcting its accumulated impulse (projected Gauss-Seidel).
!! Bodies of infinite mass have an inverse mass of zero.
!!
!! In an axisymmetric scene the radial component has an inertia of its own (theory 7): the inverse
!! mass along n is n_r^2/m^r + n_z^2/m, and a normal impulse changes the slip as well.
module sgmp_contact_resolve
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: contact_link_t, resolve_trial, resolve_strain, link_dissipation
  public :: link_free, link_closed, link_sharing, link_sliding, link_sticking

  ! What the trial has found out about a pair, from loose to tight.
  integer, parameter :: link_free = 0      !! the bodies go their ways
  integer, parameter :: link_closed = 1    !! they would come too close, but nothing presses them
  integer, parameter :: link_sliding = 2   !! they are pressed together and slide
  integer, parameter :: link_sticking = 3  !! they are pressed together and do not slide
  integer, parameter :: link_sharing = 4   !! debris meets something: they have one velocity

  integer, parameter :: most_rounds = 500
  real(dp), parameter :: unyielding = 1.0e-2_dp
    !! inverse mass, relative, below which a direction counts as prescribed
  real(dp), parameter :: settled = 1.0e-15_dp
    !! change of velocity, relative, at which the rounds end

  !> Two bodies at a node.
  type :: contact_link_t
    integer :: first = 0, second = 0       !! members of the node
    real(dp) :: normal(3) = 0.0_dp         !! unit normal, from the first to the second
    real(dp) :: approach = 0.0_dp          !! speed at which the gap between them may close
    real(dp) :: friction = 0.0_dp          !! Coulomb's coefficient
    integer :: state = link_free           !! as the last trial has found it
    real(dp) :: held_normal(3) = 0.0_dp    !! the normal of that trial
    real(dp) :: impulse(3) = 0.0_dp        !! that particles receive: + the second body, - the first
    real(dp) :: passed(3) = 0.0_dp
      !! the same and what a share of PIC, which reads the grid's velocity, takes from constraint
    real(dp) :: pull(3) = 0.0_dp           !! change of relative velocity by all forces but contact
    real(dp) :: correction(3) = 0.0_dp
      !! momentum that makes the straining velocity obey; no particle receives it
    real(dp) :: dissipation = 0.0_dp       !! energy that contact has taken in this step
    logical :: shares = .false.            !! most of one body is debris here, or
    logical :: seam = .false.              !! matter goes on from one to the other
    logical :: at_surface = .false.
      !! friction does not act at the node but at the surface (sgmp_contact_levers), where
    real(dp) :: rub(3) = 0.0_dp            !! is its impulse in this step, on the second body
    real(dp) :: drag(3) = 0.0_dp           !! the same as a force: the next step begins with it
    real(dp) :: hold(3) = 0.0_dp           !! what `correction` is along the normal
  end type contact_link_t

  !> One pair's condition on a velocity field, and the impulse that meets it.
  type :: condition_t
    logical :: active = .false.
    integer :: first = 0, second = 0
    real(dp) :: normal(3) = 0.0_dp
    real(dp) :: approach = 0.0_dp          !! that is left
    real(dp) :: least = 0.0_dp             !! lower bound of the normal impulse
    real(dp) :: friction = 0.0_dp          !! upper bound of the tangential impulse
    real(dp) :: along = 0.0_dp, across(3) = 0.0_dp  !! normal and tangential impulse on the second
    logical :: slides = .false.            !! the upper bound is reached
  end type condition_t

contains

  !> The trial: velocity of the grid (Eqs. 79, 80), impulses on the particles, and the state of each
  !! pair. A pair that was free in the step before is stopped by an impulse, once.
  pure subroutine resolve_trial(links, inverse_mass, velocity, kick)
    type(contact_link_t), intent(inout) :: links(:)  !! pairs near enough to touch in this step
    real(dp), intent(in) :: inverse_mass(:, :)
      !! (3, members) of each component; 0: prescribed motion
    real(dp), intent(inout) :: velocity(:, :)
      !! (3, members) in: trial velocity (Eq. 77), out: admissible
    real(dp), intent(in) :: kick(:, :)               !! (3, members) the part of it by forces
    type(condition_t) :: closing(size(links)), pressing(size(links))
    real(dp) :: part(3, size(inverse_mass, 2))
    logical :: was_free
    integer :: l
    do l = 1, size(links)
      closing(l) = condition_t(.true., links(l)%first, links(l)%second, links(l)%normal, &
                               links(l)%approach)
    end do
    where (links%shares)
      closing%least = -huge(1.0_dp)
      closing%friction = huge(1.0_dp)
    end where
    pressing = closing
    part = velocity
    call relax(closing, inverse_mass, part)
    pressing%active = closing%along > 0.0_dp .or. links%shares
    pressing%approach = 0.0_dp
    part = kick
    call relax(pressing, inverse_mass, part)
    do l = 1, size(links)
      was_free = links(l)%state == link_free
      links(l)%state = link_free
      if (links(l)%shares) cycle
      if (pressing(l)%active) links(l)%state = link_closed
      if (was_free) pressing(l)%along = max(pressing(l)%along, closing(l)%along)
      if (.not. links(l)%at_surface) closing(l)%friction = links(l)%friction*pressing(l)%along
    end do
    closing%along = 0.0_dp
    where (links%shares)
      closing%across(1) = 0.0_dp
      closing%across(2) = 0.0_dp
      closing%across(3) = 0.0_dp
    end where
    call relax(closing, inverse_mass, velocity)
    do l = 1, size(links)
      if (links(l)%shares) then
        call share(links(l), pressing(l), closing(l))
        cycle
      end if
      if (pressing(l)%along > 0.0_dp) then
        links(l)%state = merge(link_sliding, link_sticking, closing(l)%slides)
      end if
      links(l)%held_normal = links(l)%normal
      links(l)%impulse = pressing(l)%along*links(l)%normal + closing(l)%across
      links(l)%correction = (closing(l)%along - pressing(l)%along)*links(l)%normal
    end do
  end subroutine resolve_trial

  !> A pair of which one is debris: all forces act on both, as on one body, and what else makes its
  !! velocity one does no work.
  pure subroutine share(link, pressing, closing)
    type(contact_link_t), intent(inout) :: link
    type(condition_t), intent(in) :: pressing    !! of what forces do
    type(condition_t), intent(in) :: closing     !! of the velocity
    link%state = link_sharing
    link%held_normal = link%normal
    link%impulse = pressing%along*link%normal + pressing%across
    link%correction = closing%along*link%normal + closing%across - link%impulse
  end subroutine share

  !> Makes a straining velocity obey the state of each pair: pressed bodies neither approach nor
  !! part, those that stick do not slide, those that are only closed do not approach.
  pure subroutine resolve_strain(links, inverse_mass, velocity)
    type(contact_link_t), intent(inout) :: links(:)
    real(dp), intent(in) :: inverse_mass(:, :)       !! (3, members)
    real(dp), intent(inout) :: velocity(:, :)        !! (3, members)
    type(condition_t) :: condition(size(links))
    integer :: l
    do l = 1, size(links)
      condition(l) = condition_t(links(l)%state > link_free, links(l)%first, links(l)%second, &
                                 links(l)%held_normal)
      if (links(l)%state > link_closed) condition(l)%least = -huge(1.0_dp)
      if ((links(l)%state == link_sticking .and. .not. links(l)%at_surface) .or. &
          links(l)%state == link_sharing) then
        condition(l)%friction = huge(1.0_dp)
      end if
    end do
    call relax(condition, inverse_mass, velocity)
    do l = 1, size(links)
      links(l)%correction = condition(l)%along*links(l)%held_normal + condition(l)%across
    end do
  end subroutine resolve_strain

  !> Energy that contact takes from a pair whose straining velocity was `apart` (first minus second)
  !! before it was made to obey. It is not negative along the normal, and zero where bodies are
  !! pressed together but in the first step of a contact.
  pure function link_dissipation(link, apart) result(energy)
    type(contact_link_t), intent(in) :: link
    real(dp), intent(in) :: apart(3)
    real(dp) :: energy
    energy = dot_product(link%impulse, apart) - dot_product(link%pull, link%correction)
  end function link_dissipation

  !> Changes velocities until all conditions are met.
  pure subroutine relax(conditions, inverse_mass, velocity)
    type(condition_t), intent(inout) :: conditions(:)
    real(dp), intent(in) :: inverse_mass(:, :)       !! (3, members)
    real(dp), intent(inout) :: velocity(:, :)
    real(dp) :: scale, change
    logical :: at_once
    integer :: round, n
    scale = maxval(abs(velocity))
    ! One pair alone is done in one round but where its normal impulse changes the slip.
    at_once = count(conditions%active) <= 1 .and. &
              (all(conditions%friction <= 0.0_dp) .or. &
               all(abs(inverse_mass(1:2, :) - inverse_mass([3, 3], :)) <= 0.0_dp))
    do round = 1, merge(1, most_rounds, at_once)
      change = 0.0_dp
      do n = 1, size(conditions)
        if (conditions(n)%active) call correct(conditions(n), inverse_mass, velocity, change)
      end do
      if (change <= settled*scale) exit
    end do
  end subroutine relax

  !> One pair's correction of its impulse.
  pure subroutine correct(condition, inverse_mass, velocity, change)
    type(condition_t), intent(inout) :: condition
    real(dp), intent(in) :: inverse_mass(:, :)       !! (3, members)
    real(dp), intent(inout) :: velocity(:, :)
    real(dp), intent(inout) :: change                !! largest change of a velocity so far
    real(dp) :: weight(3), normal_weight, slip_weight
    real(dp) :: apart(3), normal_part, along, across(3), length, impulse(3)
    weight = inverse_mass(:, condition%first) + inverse_mass(:, condition%second)
    if (all(weight <= 0.0_dp)) return
    associate (n => condition%normal)
      normal_weight = weight(3) + dot_product(n**2, weight - weight(3))
      apart = velocity(:, condition%first) - velocity(:, condition%second)
      ! In a plane the one direction across n; else an upper bound, with which the rounds converge.
      slip_weight = merge(weight(1) + weight(2) - normal_weight, maxval(weight), &
                          max(abs(n(3)), abs(apart(3))) <= 0.0_dp)
      normal_part = dot_product(apart, n)
      along = condition%along
      ! What hardly yields along n, as all of it is prescribed, does not.
      if (normal_weight > unyielding*maxval(weight)) then
        along = max(condition%least, along + (normal_part - condition%approach)/normal_weight)
      end if
      across = condition%across
      if (slip_weight > unyielding*maxval(weight)) then
        across = across + (apart - normal_part*n)/slip_weight
      end if
      length = norm2(across)
      condition%slides = length > condition%friction .or. condition%friction <= 0.0_dp
      if (condition%slides) across = across*(condition%friction/max(length, tiny(1.0_dp)))
      impulse = (along - condition%along)*n + (across - condition%across)
    end associate
    condition%along = along
    condition%across = across
    velocity(:, condition%first) = velocity(:, condition%first) - &
                                   inverse_mass(:, condition%first)*impulse
    velocity(:, condition%second) = velocity(:, condition%second) + &
                                    inverse_mass(:, condition%second)*impulse
    change = max(change, maxval(weight*abs(impulse)))
  end subroutine correct

end module sgmp_contact_resolve
