! dimension-generic, axisymmetric
#include "dimension.inc"
!> Particles that leave a chunk in a sweep: out of their bin, split in two, or removed by their
!! material's card.
!!
!! A mover takes along its motion, its state and what it gives to the grid; its lane is left empty.
!! `values` are a chunk's, `columns` as many of them as the sweep scatters.
module DIM(sgmp_departures)
  use sgmp_constitutive, only: constitutive_t
  use sgmp_erosion, only: erosion_wanted
  use sgmp_kinds, only: dp, i4, i8, lanes
  use sgmp_motion, only: motion_total, motion_velocity
  use sgmp_movers, only: movers_add, movers_t
  use sgmp_patches, only: labels_t, patch_label
  implicit none
  private
  public :: departures_eroded, departures_note, departures_note_all, departures_outside, &
            departures_relabelled
  public :: departures_take_out

  integer, parameter :: before_v = motion_velocity(NDIM) - 1

contains

  !> Which particles are to be removed. One that is inside out is left to stop the run. Where the
  !! stress is updated before the kick its sweep decides on wave and particle speed.
  pure subroutine departures_eroded(law, strains, nl, motion, speed2, nb, state, eroded)
    type(constitutive_t), intent(in) :: law
    logical, intent(in) :: strains               !! the sound speed is known
    integer, intent(in) :: nl, nb
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), speed2(lanes)
    real(dp), intent(inout) :: state(lanes, nb)
    logical, intent(out) :: eroded(lanes)
    real(dp) :: strain(lanes), damage(lanes), speed(lanes)
    integer :: d
    strain = 0.0_dp
    damage = 0.0_dp
    speed = 0.0_dp
    if (law%slots%plastic > 0) strain = state(:, law%slots%plastic)
    if (law%slots%averaged > 0) strain = state(:, law%slots%averaged)
    if (law%slots%damage > 0) damage = state(:, law%slots%damage)
    if (strains .and. (law%slots%reach > 0 .or. law%erosion%speed < huge(1.0_dp))) then
      do d = 1, NDIM
        speed = speed + motion(:, before_v + d)**2
      end do
      speed = sqrt(max(speed2, 0.0_dp)) + sqrt(speed)
    end if
    if (law%slots%reach > 0) then
      if (strains) state(:nl, law%slots%reach) = speed(:nl)
      speed = state(:, law%slots%reach)
    end if
    eroded = erosion_wanted(law%erosion, strain, damage, speed)
    eroded(nl + 1:) = .false.
  end subroutine departures_eroded

  !> Which lanes are outside their bin.
  pure function departures_outside(extent, xi) result(outside)
    real(dp), intent(in) :: extent(2, NDIM)      !! of the bin
    real(dp), intent(in) :: xi(lanes, NDIM)      !! from the bin's corner
    logical :: outside(lanes)
    integer :: l
    do l = 1, lanes
      outside(l) = .not. all(xi(l, :) >= extent(1, :) .and. xi(l, :) < extent(2, :))
    end do
  end function departures_outside

  !> Which particles get another label, and so another velocity field.
  pure function departures_relabelled(labels, own, nl, patch) result(leaves)
    type(labels_t), intent(in) :: labels
    integer, intent(in) :: own                   !! label of their body
    integer, intent(in) :: nl
    real(dp), intent(in) :: patch(lanes)
    logical :: leaves(lanes)
    integer :: l
    leaves = .false.
    do l = 1, nl
      leaves(l) = patch_label(labels, nint(patch(l), i8)) /= own
    end do
  end function departures_relabelled

  !> Notes the lanes that leave, and takes them out of their bin and of the scatter.
  pure subroutine departures_note_all(leaves, removed, columns, s, extent, nl, nb, motion, state, &
                                      id, xi, values, movers)
    logical, intent(in) :: leaves(lanes)
    logical, intent(in) :: removed               !! by their material's card: for good
    integer, intent(in) :: columns, s, nl, nb
    real(dp), intent(in) :: extent(2, NDIM)
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    integer(i4), intent(inout) :: id(lanes)
    real(dp), intent(inout) :: xi(lanes, NDIM), values(lanes, columns)
    type(movers_t), intent(inout) :: movers
    integer :: l
    do l = 1, nl
      if (.not. leaves(l)) cycle
      call departures_note(columns, s, l, id(l), .true., nb, motion, state, values, movers)
      movers%eroded(movers%n) = removed
      call departures_take_out(l, extent, columns, id, xi, values)
    end do
  end subroutine departures_note_all

  !> Notes one lane as a mover; of the halves of a particle one counts as leaving the bin.
  pure subroutine departures_note(columns, s, l, id, here, nb, motion, state, values, movers)
    integer, intent(in) :: columns, s, l, nb
    integer(i4), intent(in) :: id
    logical, intent(in) :: here
    real(dp), intent(in) :: motion(lanes, motion_total(NDIM)), state(lanes, nb)
    real(dp), intent(in) :: values(lanes, columns)
    type(movers_t), intent(inout) :: movers
    integer :: q, m
    call movers_add(movers, id, here, s)
    m = movers%n
    do q = 1, motion_total(NDIM)
      movers%particle(q, m) = motion(l, q)
    end do
    do q = 1, nb
      movers%particle(motion_total(NDIM) + q, m) = state(l, q)
    end do
    do q = 1, columns
      movers%values(q, m) = values(l, q)
    end do
  end subroutine departures_note

  !> Takes a lane out of its bin and of the scatter: what is left is in the middle of the bin.
  pure subroutine departures_take_out(l, extent, columns, id, xi, values)
    integer, intent(in) :: l, columns
    real(dp), intent(in) :: extent(2, NDIM)      !! of the bin
    integer(i4), intent(inout) :: id(lanes)
    real(dp), intent(inout) :: xi(lanes, NDIM), values(lanes, columns)
    id(l) = 0
    values(l, :) = 0.0_dp
    xi(l, :) = 0.5_dp*(extent(1, :) + extent(2, :))
  end subroutine departures_take_out

end module DIM(sgmp_departures)
