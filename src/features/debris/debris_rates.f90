!> Inelastic collisions of debris, the points' part: at which rate, and towards which velocity.
!!
!! Around a point, over all fields that have debris, m and p are mass and momentum of all particles,
!! W and D the mass of debris that moves as the grid cannot see, and that mass times the square of
!! its velocity u against the grid (sgmp_collisions). Particles take on the mean velocity p/m at the
!! rate
!!
!!     a = W/m min(1, dt max(c, sqrt(D/W))/h),                                        (DB3)
!!
!! which is 0 to the bit where no debris is, and belongs to the point: all particles around it see
!! the same, so momentum is kept and kinetic energy lost.
module sgmp_debris_rates
  use sgmp_columns, only: collide_kick, collide_rate, collide_square, collide_velocity, &
                          node_acceleration, node_inertia
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_width
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_free
  use sgmp_rows, only: key_j, key_k, row_key, rows_find
  use sgmp_space, only: space_axisymmetric
  implicit none
  private
  public :: debris_kicks, debris_rates, debris_rate

contains

  !> Square of the acceleration at each node, with the inertia of its radial component.
  pure subroutine debris_kicks(field)
    type(field_t), intent(inout) :: field
    integer :: a
    associate (square => field%collide(:, collide_kick(field%ndim)), n => field%points)
      square = field%node(:n, node_acceleration)**2
      if (field%space == space_axisymmetric) square = field%node(:n, node_inertia)*square
      do a = 1, field%ndim - 1
        square = square + field%node(:n, node_acceleration + a)**2
      end do
    end associate
  end subroutine debris_kicks

  !> Rates of one field.
  pure subroutine debris_rates(fields, f, mesh, dt, speed)
    type(field_t), intent(inout) :: fields(:)    !! those that collide have been swept
    integer, intent(in) :: f
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: dt, speed            !! of sound
    real(dp) :: sums(3 + mesh%ndim), velocity(mesh%ndim), rate
    integer :: s, i, c, debris, from(size(fields))
    debris = fields(f)%columns%debris
    from = 1
    fields(f)%collide = 0.0_dp
    do s = 1, fields(f)%work%n
      do i = fields(f)%work%first(s), fields(f)%work%last(s)
        c = fields(f)%neighbour(0, 0, s) + i
        if (.not. fields(f)%moment(c, debris) > 0.0_dp) cycle
        call point_sums(fields, key_j(fields(f)%work%key(s)), key_k(fields(f)%work%key(s)), i, &
                        from, sums)
        rate = debris_rate(sums(1), sums(mesh%ndim + 2), sums(mesh%ndim + 3), speed, &
                           dt/side(mesh, key_j(fields(f)%work%key(s)), &
                                   key_k(fields(f)%work%key(s)), i))
        if (.not. rate > 0.0_dp) cycle
        velocity = sums(2:mesh%ndim + 1)/sums(1)
        call hold(fields(f), mesh, s, i, velocity)
        fields(f)%collide(c, collide_rate) = rate
        fields(f)%collide(c, collide_square) = rate*sum(velocity**2)
        fields(f)%collide(c, collide_velocity:collide_velocity + mesh%ndim - 1) = rate*velocity
      end do
    end do
  end subroutine debris_rates

  !> Largest side of the cell of a point.
  pure function side(mesh, j, k, i) result(length)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: j, k, i
    real(dp) :: length
    integer :: point(3), d
    length = mesh%h
    if (.not. mesh%graded) return
    point = [i, j, k]
    if (mesh%ndim == 2) point(2) = k
    length = 0.0_dp
    do d = 1, mesh%ndim
      length = max(length, mesh%h*graded_width(mesh%axes(d), point(d)))
    end do
  end function side

  !> (DB3)
  elemental function debris_rate(mass, unseen, square, speed, dt_over_h) result(rate)
    real(dp), intent(in) :: mass, unseen, square  !! m, W, D
    real(dp), intent(in) :: speed, dt_over_h
    real(dp) :: rate
    rate = 0.0_dp
    if (.not. (unseen > 0.0_dp .and. mass > 0.0_dp)) return
    rate = unseen/mass*min(1.0_dp, dt_over_h*max(speed, sqrt(square/unseen)))
  end function debris_rate

  !> Sums around a point over all fields, in their order.
  pure subroutine point_sums(fields, j, k, i, from, sums)
    type(field_t), intent(in) :: fields(:)
    integer, intent(in) :: j, k, i
    integer, intent(inout) :: from(:)            !! (fields) see rows_find
    real(dp), intent(out) :: sums(:)
    integer :: g, interval
    sums = 0.0_dp
    do g = 1, size(fields)
      if (.not. fields(g)%collides) cycle
      call rows_find(fields(g)%store, row_key(j, k), i, from(g), interval)
      if (interval == 0) cycle
      associate (debris => fields(g)%columns%debris, point => fields(g)%base(interval) + i)
        sums = sums + fields(g)%moment(point, debris:debris + size(sums) - 1)
      end associate
    end do
  end subroutine point_sums

  !> Nodes on walls do not move across them.
  pure subroutine hold(field, mesh, s, i, velocity)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, i
    real(dp), intent(inout) :: velocity(mesh%ndim)
    integer :: axis, side, here(3)
    if (kernel_centred(field%kernel)) return
    here = [i, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (mesh%ndim == 2) here(2) = here(3)
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (mesh%wall(side, axis) == wall_free) cycle
        if (here(axis) /= merge(mesh%lower(axis), mesh%upper(axis), side == 1)) cycle
        velocity(axis) = 0.0_dp
        if (mesh%wall(side, axis) == wall_fixed) velocity = 0.0_dp
      end do
    end do
  end subroutine hold

end module sgmp_debris_rates
