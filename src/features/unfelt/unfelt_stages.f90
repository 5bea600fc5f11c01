!> Forces that particles do not feel, where a scene is slow (doc/damping.md, What particles do not
!! feel).
!!
!! With sgmp particles move by averages over nodes. What alternates from node to node they do not
!! feel, and a velocity that is projected from them anew knows nothing of it: a stress that
!! alternates from cell to cell then meets no strain, and stays. With update=usl it does, at the
!! price of a part of each wave. Where there are no waves to speak of, or they are to die out, a
!! small part of that strains the particles of the other updates, too: such stresses go within some
!! hundred steps, and at rest nothing is left of it.
module sgmp_unfelt_stages
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_field, only: field_t
  use sgmp_halo, only: halo_own_planes
  use sgmp_kernels, only: kernel_sgmp
  use sgmp_kinds, only: dp
  use sgmp_method, only: method_t
  use sgmp_partition, only: partition_t
  use sgmp_rigid_bodies, only: rigid_field
  use sgmp_sums, only: nodes_unfelt, sweep_sums
  use sgmp_tally, only: tally_add, tally_t
  use sgmp_update, only: update_musl, update_usavg
  implicit none
  private
  public :: unfelt_part, unfelt_possible, unfelt_tally

  real(dp), parameter :: part = 0.02_dp        !! of update=usl
  real(dp), parameter :: slow = 0.01_dp        !! kinetic over internal energy of solids, at most
  real(dp), parameter :: fast = 0.2_dp         !! from here on nothing of it; between, in proportion
                                               !! (1/4: what a sudden load makes vibrate)

contains

  !> Whether a scene may come to strain particles with forces that they do not feel.
  pure function unfelt_possible(method, bodies, fields) result(yes)
    type(method_t), intent(in) :: method
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    logical :: yes
    yes = any(method%update == [update_musl, update_usavg]) .and. &
          all(fields%kernel == kernel_sgmp) .and. &
          (method%damped .or. .not. all(bodies%rigid .or. law_is_spherical(bodies%law)))
  end function unfelt_possible

  !> Which part of the velocity that forces give the nodes beyond what particles feel of it strains
  !! them in a step: where the scene is damped, or as its kinetic energy has never been more than a
  !! hundredth of what its solids have taken up by now, and less where it has been up to a fifth.
  pure function unfelt_part(method, time, bodies, internal, largest_kinetic, fields) result(unfelt)
    type(method_t), intent(in) :: method
    real(dp), intent(in) :: time                 !! at the start of the step
    type(body_t), intent(in) :: bodies(:)
    real(dp), intent(in) :: internal(:)          !! energy of the bodies
    real(dp), intent(in) :: largest_kinetic      !! of all of them since the start
    type(field_t), intent(in) :: fields(:)
    real(dp) :: unfelt
    real(dp) :: solids
    unfelt = 0.0_dp
    if (.not. unfelt_possible(method, bodies, fields)) return
    if (method%damped) then
      if (time < method%damped_until) unfelt = part
      return
    end if
    solids = sum(internal, mask=.not. (bodies%rigid .or. law_is_spherical(bodies%law)))
    if (largest_kinetic < slow*solids) then
      unfelt = part
    else if (largest_kinetic < fast*solids) then
      unfelt = part*slow*solids/largest_kinetic
    end if
  end function unfelt_part

  !> Adds up the power of such forces on the strains, over the planes of this rank; a step of usavg
  !! strains with the re-mapped velocity for one half.
  pure subroutine unfelt_tally(method, fields, bodies, partition, tally)
    type(method_t), intent(in) :: method
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    type(partition_t), intent(in) :: partition
    type(tally_t), intent(inout) :: tally
    real(dp) :: strained
    integer :: f, p, p1, p2
    strained = merge(0.5_dp, 1.0_dp, method%update == update_usavg)
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0) cycle
      call halo_own_planes(fields(f), partition, p1, p2)
      do p = p1, p2
        call tally_add(tally, size(bodies)*sweep_sums + nodes_unfelt, &
                       [strained*fields(f)%unfelt(p)])
      end do
    end do
  end subroutine unfelt_tally

end module sgmp_unfelt_stages
