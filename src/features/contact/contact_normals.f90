!> Normals from the gradients of the bodies' volumes (Eqs. 76, 87, 88).
module sgmp_contact_normals
  use sgmp_axis, only: axis_radius_filled
  use sgmp_body, only: body_density, body_t
  use sgmp_contact_pairs, only: normal_first, normal_second
  use sgmp_field, only: field_t
  use sgmp_graded_axis, only: graded_spacing, graded_width
  use sgmp_kernel_functions, only: kernel_function
  use sgmp_kernels, only: kernel_centred, kernel_sized
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_motion, only: motion_mass
  use sgmp_shared_nodes, only: row_axis, shared_body, shared_nodes_t, shared_parts
  use sgmp_space, only: space_axisymmetric
  use sgmp_surface_particles, only: surface_t
  implicit none
  private
  public :: contact_normal, volume_gradient

contains

  !> Common unit normal of a pair from the gradients of the bodies' volumes; zero where they give no
  !! direction.
  !!
  !! The average (g_r - g_s)/|g_r - g_s| is taken of volumes, not masses, so that a dense body does
  !! not decide alone.
  pure function contact_normal(choice, first, second) result(normal)
    integer, intent(in) :: choice
      !! one of normal_*, the stiffer already resolved
    real(dp), intent(in) :: first(3), second(3)
      !! sum of V grad N over what each body has around the node
    real(dp) :: normal(3)
    real(dp) :: length
    select case (choice)
    case (normal_first)
      normal = first
    case (normal_second)
      normal = -second
    case default
      normal = first - second
    end select
    length = norm2(normal)
    if (length > 1.0e-12_dp*(norm2(first) + norm2(second)) .and. length > 0.0_dp) then
      normal = normal/length
    else
      normal = 0.0_dp
    end if
  end function contact_normal

  !> Outward direction of a member at a node: sum of V grad N over centres (SGMP, Eq. 88) or
  !! particles (Eq. 87). Centres do not know which body of the field their mass belongs to: all of
  !! it counts with the density of the first.
  pure function volume_gradient(mesh, field, shared, m, bodies, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: m
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: point(3)
    real(dp) :: gradient(3)
    integer :: part, b
    if (kernel_centred(field%kernel)) then
      gradient = centre_gradient(mesh, field, shared%interval(m), point)/ &
                 body_density(bodies(shared%body(m)))
      return
    end if
    gradient = 0.0_dp
    do part = 1, shared_parts(shared, m)
      b = shared_body(shared, m, part)
      gradient = gradient + particle_gradient(mesh, field%kernel, bodies(b), shared%surface(b), &
                                              shared%bins(:, :, shared%bins_start(m) + part - 1), &
                                              point)/body_density(bodies(b))
    end do
  end function volume_gradient

  !> Sum of m_c grad N_Ic (Eq. 88), in units of mass per cell. Where cells are unequal, of masses
  !! over the volumes of their cells: a body that fills them all has no gradient.
  pure function centre_gradient(mesh, field, interval, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    integer, intent(in) :: interval, point(3)
    real(dp) :: gradient(3)
    real(dp) :: left, right, section(2)
    integer :: dj, dk, base, i, axis
    i = point(1)
    section = 1.0_dp                       ! what masses of rings grow with
    if (field%space == space_axisymmetric) section = axis_radius_filled(mesh%axes(1), [i - 1, i])
    gradient = 0.0_dp
    do dk = -merge(1, 0, field%ndim >= 2), 0
      do dj = -merge(1, 0, field%ndim == 3), 0
        base = field%neighbour(dj, dk, interval) + i
        left = field%moment(base - 1, field%columns%mass)/section(1)
        right = field%moment(base, field%columns%mass)/section(2)
        if (mesh%graded) then
          left = left/cell_size(mesh, [i - 1, point(2) + dj, point(3) + dk])
          right = right/cell_size(mesh, [i, point(2) + dj, point(3) + dk])
        end if
        gradient(1) = gradient(1) + (left - right)
        if (field%ndim == 2) gradient(2) = gradient(2) + sign(left + right, -dk - 0.5_dp)
        if (field%ndim == 3) gradient(2) = gradient(2) + sign(left + right, -dj - 0.5_dp)
        if (field%ndim == 3) gradient(3) = gradient(3) + sign(left + right, -dk - 0.5_dp)
      end do
    end do
    gradient = gradient*0.5_dp**(field%ndim - 1)
    if (.not. mesh%graded) return
    do axis = 1, field%ndim
      gradient(axis) = gradient(axis)/graded_spacing(mesh%axes(axis), &
                                                     point(row_axis(axis, field%ndim)))
    end do
  end function centre_gradient

  !> Volume of the cell of a centre, over that of the smallest.
  pure function cell_size(mesh, centre) result(volume)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: centre(3)             !! i, j, k
    real(dp) :: volume
    integer :: axis
    volume = 1.0_dp
    do axis = 1, mesh%ndim
      volume = volume*graded_width(mesh%axes(axis), centre(row_axis(axis, mesh%ndim)))
    end do
  end function cell_size

  !> Sum of m_p grad S_Ip (Eq. 87), in units of mass per cell.
  pure function particle_gradient(mesh, kernel, body, surface, bins, point) result(gradient)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel
    type(body_t), intent(in) :: body
    type(surface_t), intent(in) :: surface       !! of the body
    integer, intent(in) :: bins(:, :)            !! (2, rows) the bins around the node in its list
    integer, intent(in) :: point(3)
    real(dp) :: gradient(3)
    real(dp) :: half(3), node(3)
    integer :: r, n, g, number, chunk, left, l, nd
    gradient = 0.0_dp
    nd = mesh%ndim
    node = real(point([1, row_axis(2, nd), 3]), dp)
    half = 0.0_dp
    if (kernel_sized(kernel)) half = body%half_size
    do r = 1, size(bins, 2)
      do n = bins(1, r), bins(2, r)
        do g = surface%guest_first(n), surface%guest_first(n) + surface%guest_size(n) - 1
          associate (guest => surface%guest(:, g))
            if (kernel_sized(kernel)) half(:nd) = guest(nd + 3:2*nd + 2)
            call add_gradient(kernel, nd, guest(:nd) - node(:nd), half, &
                              guest(nd + 2)/circumference(mesh%space, guest(1)), gradient)
          end associate
        end do
        number = surface%bin(n)
        chunk = body%particles%first(number)
        left = body%particles%size(number)
        do while (left > 0)
          do l = 1, min(left, lanes)
            associate (motion => body%particles%motion(l, :, chunk), &
                       state => body%particles%state(l, :, chunk))
              if (body%law%slots%stretch > 0) half(:nd) = body%half_size(:nd)* &
                state(body%law%slots%stretch:body%law%slots%stretch + nd - 1)
              call add_gradient(kernel, nd, motion(:nd) - node(:nd), half, &
                                motion(motion_mass(nd))/circumference(mesh%space, motion(1)), &
                                gradient)
            end associate
          end do
          left = left - lanes
          chunk = body%particles%next(chunk)
        end do
      end do
    end do
  end function particle_gradient

  !> What the mass of a ring grows with as it moves out, so that mass divided by it is that of a
  !! section.
  elemental function circumference(space, radius) result(way)
    integer, intent(in) :: space
    real(dp), intent(in) :: radius               !! cells
    real(dp) :: way
    way = merge(radius, 1.0_dp, space == space_axisymmetric)
  end function circumference

  !> Adds what one particle gives to the gradient at a node.
  pure subroutine add_gradient(kernel, nd, x, half, mass, gradient)
    integer, intent(in) :: kernel, nd
    real(dp), intent(in) :: x(nd)                !! particle minus node (cells)
    real(dp), intent(in) :: half(3), mass
    real(dp), intent(inout) :: gradient(3)
    real(dp) :: s(3), g(3)
    s = 1.0_dp
    g = 0.0_dp
    call kernel_function(kernel, x, half(:nd), s(:nd), g(:nd))
    gradient(1) = gradient(1) + mass*(g(1)*s(2)*s(3))
    if (nd >= 2) gradient(2) = gradient(2) + mass*(s(1)*g(2)*s(3))
    if (nd == 3) gradient(3) = gradient(3) + mass*(s(1)*s(2)*g(3))
  end subroutine add_gradient

end module sgmp_contact_normals
