!> What a thread does with the movers of its slab right after the sweep: those that leave the grid,
!! and the bins of the others.
module sgmp_lost_particles
  use sgmp_body, only: body_parts, body_t
  use sgmp_columns, only: columns_before, columns_t, columns_turn_back
  use sgmp_graded_axis, only: graded_place
  use sgmp_kinds, only: dp
  use sgmp_lost_policy, only: lost_reflect, lost_remove
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_total, motion_velocity
  use sgmp_movers, only: movers_t
  use sgmp_particles, only: particles_t
  use sgmp_plan, only: plan_t
  use sgmp_rebinning, only: particles_find_bins
  implicit none
  private
  public :: lost_particles_check, lost_particles_find_bins

contains

  !> Looks after the movers that the bodies of field f have in one slab.
  pure subroutine lost_particles_check(plan, f, mesh, columns, bodies, movers)
    type(plan_t), intent(in) :: plan
    integer, intent(in) :: f
    type(mesh_t), intent(in) :: mesh
    type(columns_t), intent(in) :: columns       !! of the field
    type(body_t), intent(in) :: bodies(:)
    type(movers_t), intent(inout) :: movers(:)   !! (bodies)
    integer :: b
    logical :: reflect, remove
    do b = 1, size(bodies)
      if (bodies(b)%field /= f) cycle
      ! A rigid body goes on through the face: what is outside cannot be turned back alone.
      reflect = plan%lost_policy == lost_reflect .and. .not. bodies(b)%rigid
      remove = plan%lost_policy == lost_remove .or. &
               (plan%lost_policy == lost_reflect .and. bodies(b)%rigid)
      call note_nowhere(mesh%ndim, movers(b))
      if (.not. remove .and. movers(b)%escaped(1) == 0) then
        call guard_grid(mesh, plan, columns, bodies(b), reflect, movers(b))
      end if
      call lost_particles_find_bins(mesh, bodies(b)%particles, movers(b))
    end do
  end subroutine lost_particles_check

  !> Notes the first mover with a coordinate that is not a number.
  pure subroutine note_nowhere(ndim, movers)
    integer, intent(in) :: ndim
    type(movers_t), intent(inout) :: movers
    integer :: m, d
    do m = 1, movers%n
      do d = 1, ndim
        if (movers%particle(d, m) == movers%particle(d, m)) cycle
        movers%escaped = [m, d]
        return
      end do
    end do
  end subroutine note_nowhere

  !> Applies the deck's policy to movers that are leaving the grid: reflection, or an error, for
  !! which the first one is noted.
  !!
  !! A particle is outside once its bin is: half a cell beyond the face with SGMP and GIMP, at the
  !! face with MPM.
  pure subroutine guard_grid(mesh, plan, columns, body, reflect, movers)
    type(mesh_t), intent(in) :: mesh
    type(plan_t), intent(in) :: plan
    type(columns_t), intent(in) :: columns
    type(body_t), intent(in) :: body
    logical, intent(in) :: reflect
    type(movers_t), intent(inout) :: movers
    integer :: m, d
    do m = 1, movers%n
      if (movers%eroded(m)) cycle
      do d = 1, mesh%ndim
        associate (x => movers%particle(d, m))
          if (x >= mesh%lower(d) .and. x <= mesh%upper(d)) cycle
          if (reflect) then
            if (driven(body, d, movers%particle(motion_total(mesh%ndim) + 1:, m))) cycle
            call turn_back(mesh, plan, columns, d, movers%particle(:, m), movers%values(:, m))
          else if (x < mesh%lower(d) - body%particles%shift .or. &
                   x > mesh%upper(d) + body%particles%shift) then
            movers%escaped = [m, d]
            return
          end if
        end associate
      end do
    end do
  end subroutine guard_grid

  !> Whether a particle belongs to a part whose motion along an axis is prescribed now: it goes on
  !! through the face as a rigid body does, for to turn it back is no motion of the part.
  pure logical function driven(body, d, state) result(yes)
    type(body_t), intent(in) :: body
    integer, intent(in) :: d                     !! axis
    real(dp), intent(in) :: state(:)             !! its second stream
    integer :: i
    yes = .false.
    do i = 1, body_parts(body)
      associate (part => body%driven(i))
        if (part%drive%acts .and. part%axes(d)) yes = yes .or. state(part%mark) > 0.0_dp
      end associate
    end do
  end function driven

  !> Mirrors a mover at the face that it has passed, with what it gives to the grid.
  pure subroutine turn_back(mesh, plan, columns, d, particle, values)
    type(mesh_t), intent(in) :: mesh
    type(plan_t), intent(in) :: plan
    type(columns_t), intent(in) :: columns       !! of its field
    integer, intent(in) :: d                     !! axis of the face
    real(dp), intent(inout) :: particle(:), values(:)
    integer :: v
    v = motion_velocity(mesh%ndim) + d - 1
    particle(d) = 2*merge(mesh%lower(d), mesh%upper(d), particle(d) < mesh%lower(d)) - particle(d)
    particle(v) = -particle(v)
    call columns_turn_back(columns, d, graded_place(mesh%axes(1), particle(1)), &
                           columns_before(columns, plan%first_column), values)
  end subroutine turn_back

  !> Finds the bins of movers; those beyond the outermost bins of the grid are gone.
  pure subroutine lost_particles_find_bins(mesh, particles, movers)
    type(mesh_t), intent(in) :: mesh
    type(particles_t), intent(in) :: particles
    type(movers_t), intent(inout) :: movers
    call particles_find_bins(particles, mesh%lower - particles%shift, &
                             mesh%upper + particles%shift, movers)
  end subroutine lost_particles_find_bins

end module sgmp_lost_particles
