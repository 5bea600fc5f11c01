!> Angular momentum of the bodies that share a velocity field, about their common centre of mass.
!!
!! Where nothing but uniform gravity acts on them it stays what it is, and a method that loses it
!! shows (doc/rotation.md): the verdict compares the end with the start.
module sgmp_angular_momentum
  use sgmp_body, only: body_t
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_graded_axis, only: graded_place
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_method, only: method_t
  use sgmp_motion, only: motion_mass, motion_velocity
  use sgmp_parallel, only: parallel_exact_sums
  use sgmp_space, only: space_axisymmetric
  use sgmp_totals, only: body_sums_t
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: angular_momentum_note, angular_momentum_of, angular_momentum_t

  type :: angular_momentum_t
    real(dp) :: vector(3) = 0.0_dp
    real(dp) :: largest = 0.0_dp       !! if all turned the same way: sum m |x - x_c| |v - v_c|
  end type angular_momentum_t

contains

  !> Notes the angular momenta that nothing in a scene may change; all ranks must call it.
  subroutine angular_momentum_note(mesh, method, bodies, pairs, sums, found)
    type(mesh_t), intent(in) :: mesh
    type(method_t), intent(in) :: method
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    type(body_sums_t), intent(in) :: sums(:)     !! (bodies) as they are now
    type(angular_momentum_t), intent(inout) :: found(:)  !! (fields) unchanged where something may
    integer :: f
    do f = 1, size(found)
      if (.not. kept(mesh, method, bodies, pairs, f)) cycle
      call angular_momentum_of(mesh, bodies, sums, f, found(f))
    end do
  end subroutine angular_momentum_note

  !> Whether nothing in a scene may change the angular momentum of a field.
  pure logical function kept(mesh, method, bodies, pairs, field) result(yes)
    type(mesh_t), intent(in) :: mesh
    type(method_t), intent(in) :: method
    type(body_t), intent(in) :: bodies(:)
    type(contact_pair_t), intent(in) :: pairs(:)
    integer, intent(in) :: field
    integer :: p
    yes = mesh%ndim > 1 .and. mesh%space /= space_axisymmetric .and. &
          all(mesh%wall(:, :mesh%ndim) == wall_free) .and. &
          .not. (method%damped .or. method%erodes .or. method%removes) .and. &
          .not. any((bodies%rigid .or. bodies%forced .or. bodies%is_driven) .and. &
                     bodies%field == field)
    do p = 1, size(pairs)
      yes = yes .and. all(bodies(pairs(p)%body)%field /= field)
    end do
  end function kept

  !> Angular momentum of a field now; all ranks must call it.
  subroutine angular_momentum_of(mesh, bodies, sums, field, found)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    type(body_sums_t), intent(in) :: sums(:)     !! (bodies) as they are now
    integer, intent(in) :: field
    type(angular_momentum_t), intent(out) :: found
    real(dp), allocatable :: terms(:, :)
    real(dp) :: mass, centre(3), velocity(3), totals(4)
    integer :: b, c, d
    mass = max(sum(sums%mass, mask=bodies%field == field), tiny(1.0_dp))
    do d = 1, 3
      centre(d) = sum(sums%moment(d), mask=bodies%field == field)/mass
      velocity(d) = sum(sums%momentum(d), mask=bodies%field == field)/mass
    end do
    do b = 1, size(bodies)
      if (bodies(b)%field /= field) cycle
      allocate (terms(4, bodies(b)%particles%chunks))
      !$omp parallel do schedule(static) default(none) &
      !$omp& shared(bodies, mesh, terms, centre, velocity, b)
      do c = 1, bodies(b)%particles%chunks
        terms(:, c) = mesh%h*chunk_terms(bodies(b), mesh, c, centre, velocity)
      end do
      !$omp end parallel do
      call parallel_exact_sums(terms, totals)
      deallocate (terms)
      found%vector = found%vector + totals(:3)
      found%largest = found%largest + totals(4)
    end do
  end subroutine angular_momentum_of

  !> Those of the particles of a chunk, lengths in cells: vector, largest.
  pure function chunk_terms(body, mesh, c, centre, velocity) result(terms)
    type(body_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: c                     !! chunk
    real(dp), intent(in) :: centre(3), velocity(3)
    real(dp) :: terms(4)
    real(dp) :: arm(3), speed(3), mass
    integer :: l, first, n
    n = mesh%ndim
    terms = 0.0_dp
    arm = 0.0_dp
    speed = 0.0_dp
    first = motion_velocity(n)
    do l = 1, lanes
      if (body%particles%id(l, c) == 0) cycle
      mass = body%particles%motion(l, motion_mass(n), c)
      arm(:n) = graded_place(mesh%axes(:n), body%particles%motion(l, :n, c)) - centre(:n)
      speed(:n) = body%particles%motion(l, first:first + n - 1, c) - velocity(:n)
      terms = terms + mass*[cross(arm, speed), norm2(arm)*norm2(speed)]
    end do
  end function chunk_terms

end module sgmp_angular_momentum
