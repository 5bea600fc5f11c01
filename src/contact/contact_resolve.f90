!> Contact of several bodies at one grid node: Coulomb friction between velocity fields (Eqs.
!! 76-84).
!!
!! Each pair of bodies that touch at the node exchanges an impulse. With two bodies it is the closed
!! form of Eqs. 81-84: the
!! impulse that makes both velocities equal, its tangential part cut to the friction cone. With
!! three or more the impulses
!! depend on each other; they are found by going round the pairs until nothing changes, each pair
!! correcting its accumulated
!! impulse (projected Gauss-Seidel), so that in the end no pair approaches, no impulse pulls, and
!! every one lies in its cone.
!! Bodies of infinite mass have an inverse mass of zero.
module sgmp_contact_resolve
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: contact_link_t, contact_resolve

  integer, parameter :: most_rounds = 500
  real(dp), parameter :: settled = 1.0e-15_dp
    !! change of velocity, relative, at which the rounds end

  !> Two bodies that touch at a node.
  type :: contact_link_t
    integer :: first = 0, second = 0       !! members of the node
    real(dp) :: normal(3) = 0.0_dp         !! unit normal, from the first to the second
    real(dp) :: friction = 0.0_dp          !! Coulomb's coefficient
    real(dp) :: normal_impulse = 0.0_dp    !! accumulated, not negative
    real(dp) :: tangent_impulse(3) = 0.0_dp  !! accumulated, on the second body
  end type contact_link_t

contains

  !> Velocities after contact, and the impulses that make it: -(normal + tangent) acts on the first,
  !! + on the second.
  pure subroutine contact_resolve(links, inverse_mass, velocity)
    type(contact_link_t), intent(inout) :: links(:)  !! touching pairs; impulses are set
    real(dp), intent(in) :: inverse_mass(:)          !! (members) 0: prescribed motion
    real(dp), intent(inout) :: velocity(:, :)
      !! (3, members) in: trial velocity (Eq. 77), out: admissible (Eq. 80)
    real(dp) :: scale, change
    integer :: round, n
    do n = 1, size(links)
      links(n)%normal_impulse = 0.0_dp
      links(n)%tangent_impulse = 0.0_dp
    end do
    scale = maxval(abs(velocity))
    do round = 1, merge(1, most_rounds, size(links) <= 1)
      change = 0.0_dp
      do n = 1, size(links)
        call correct(links(n), inverse_mass, velocity, change)
      end do
      if (change <= settled*scale) exit
    end do
  end subroutine contact_resolve

  !> One pair's correction of its impulse.
  pure subroutine correct(link, inverse_mass, velocity, change)
    type(contact_link_t), intent(inout) :: link
    real(dp), intent(in) :: inverse_mass(:)
    real(dp), intent(inout) :: velocity(:, :)
    real(dp), intent(inout) :: change                !! largest change of a velocity so far
    real(dp) :: weight, approach(3), before, tangent(3), length, impulse(3)
    weight = inverse_mass(link%first) + inverse_mass(link%second)
    if (weight <= 0.0_dp) return
    approach = velocity(:, link%first) - velocity(:, link%second)
    before = link%normal_impulse
    link%normal_impulse = max(0.0_dp, before + dot_product(approach, link%normal)/weight)
    tangent = link%tangent_impulse + (approach - dot_product(approach, &
      link%normal)*link%normal)/weight
    length = norm2(tangent)
    if (length > link%friction*link%normal_impulse) then
      tangent = tangent*(link%friction*link%normal_impulse/max(length, tiny(1.0_dp)))
    end if
    impulse = (link%normal_impulse - before)*link%normal + (tangent - link%tangent_impulse)
    link%tangent_impulse = tangent
    velocity(:, link%first) = velocity(:, link%first) - inverse_mass(link%first)*impulse
    velocity(:, link%second) = velocity(:, link%second) + inverse_mass(link%second)*impulse
    change = max(change, weight*maxval(abs(impulse)))
  end subroutine correct

end module sgmp_contact_resolve
