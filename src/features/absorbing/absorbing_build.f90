!> Edges that let waves out (doc/loads.md): which faces of particles bear them, with what impedance,
!! and which stress they bear at rest.
!!
!! An edge is a property of the matter that ends there, and moves with it. The faces that particles
!! show to the edge of the grid at the start receive the traction (sgmp_loads)
!!   t = t_0 - rho c_p v_n n - rho c_s v_t,
!! with density and speeds of the material at the start. t_0 is the traction of the particle's
!! stress at the start, so that what is at rest stays at rest.
!!
!! With a source at the distance r, t_0 follows the displacement u: t_0 - (k_n u_n - q) n/r -
!! k_t u_t/r. Of a wave with the potential f(t - r/c)/r, u = -f/r^2 - f'/(c r), the stress is
!! -rho c v - 4 G u/r + q/r with q = rho c^2 (u + f/r^2), so that q' = rho c^2 v - c q/r: this is
!! exact for spherical waves, and a fluid that moves slowly feels the inertia of what lies beyond:
!! t - t_0 = -rho r v'. In the plane, where u goes with 1/sqrt(r) at first and with 1/r at
!! last, k_n = 2 G and half of q.
module sgmp_absorbing_build
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: constitutive_t, law_liquid, law_wave_modulus
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_faces_build, only: face_t, faces_lattice, faces_length, faces_place, faces_shown
  use sgmp_kinds, only: dp, lanes
  use sgmp_lattice, only: lattice_t
  use sgmp_load, only: load_absorbing, load_t
  use sgmp_mesh, only: mesh_place, mesh_places, mesh_t
  use sgmp_motion, only: motion_mass
  use sgmp_parallel, only: parallel_any, parallel_max
  use sgmp_scene, only: body_card_t, grid_card_t, layout_graded, layout_lattice
  use sgmp_space, only: axis_names
  use sgmp_voigt, only: voigt_axes
  implicit none
  private
  public :: absorbing_check, absorbing_declare, absorbing_fill

  real(dp), parameter :: near = 0.5_dp      !! spacings between a face and the edge that it bears
  real(dp), parameter :: aligned = 0.99_dp  !! cosine between a face's normal and the edge's

contains

  !> A load for each edge of the grid.
  pure subroutine absorbing_declare(card, grid, mesh, law, body)
    type(body_card_t), intent(in) :: card
    type(grid_card_t), intent(in) :: grid
    type(mesh_t), intent(in) :: mesh
    type(constitutive_t), intent(in) :: law
    type(body_t), intent(inout) :: body
    type(load_t) :: new
    integer :: axis, side
    if (card%rigid) return
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (.not. mesh%absorbs(side, axis)) cycle
        new%kind = load_absorbing
        new%side = side
        new%axis = axis
        new%impedance = impedance(law)
        if (grid%springs .or. (grid%inertia .and. law_liquid(law))) then
          new%springs = law%elastic%shear*spring_factors(mesh)
          new%speed = new%impedance(1)/law%density
          new%fading = merge(0.5_dp, 1.0_dp, mesh%space == 2)*new%impedance(1)*new%speed
          new%source = grid%source
        end if
        body%loads = [body%loads, new]
        body%absorbs = .true.
        body%forced = .true.
        body%faced = .true.
      end do
    end do
  end subroutine absorbing_declare

  !> Density times the speeds of plane waves, of compression and of shear, at the start.
  pure function impedance(law) result(z)
    type(constitutive_t), intent(in) :: law
    real(dp) :: z(2)
    z(1) = sqrt(law%density*law_wave_modulus(law))
    z(2) = sqrt(law%density*law%elastic%shear)
  end function impedance

  !> Stress across and along an edge at the distance r from a source over G u/r, u the displacement
  !! there: across, of what is at rest around it, u ~ 1/r^2 in space (stress -4 G u/r), 1/r in the
  !! plane (-2 G u/r); along, of shear waves that spread, u ~ 1/r (-2 G u/r), 1/sqrt(r)
  !! (-3/2 G u/r).
  pure function spring_factors(mesh) result(factors)
    type(mesh_t), intent(in) :: mesh
    real(dp) :: factors(2)
    factors = [4.0_dp, 2.0_dp]
    if (mesh%space == 2) factors = [2.0_dp, 1.5_dp]
  end function spring_factors

  !> Fills the columns of the edges of a body: area vectors, tractions at rest. An error where
  !! matter lies beyond an edge, or beside it without faces. All ranks must call it.
  subroutine absorbing_fill(card, gravity, mesh, body, error)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(out) :: error
    type(lattice_t) :: lattice
    real(dp) :: weight(3), x(3)
    logical :: beyond, faceless
    integer :: c, i, l, mass
    beyond = .false.
    faceless = .false.
    x = 0.0_dp
    weight = 0.0_dp
    mass = motion_mass(mesh%ndim)
    if (body%absorbs .and. has_faces(card)) call faces_lattice(card, mesh, lattice)
    do i = 1, size(body%loads)
      if (body%loads(i)%kind /= load_absorbing) cycle
      do c = 1, body%particles%chunks
        do l = 1, lanes
          if (body%particles%id(l, c) == 0) cycle
          x(:mesh%ndim) = mesh_places(mesh, &
                                        body%particles%motion(l, :mesh%ndim, c))
          if (body%stressed) weight = body%particles%motion(l, mass, c)/ &
                                      body%particles%state(l, body%law%slots%volume, c)*gravity
          call fill_particle(card, mesh, lattice, weight, body%loads(i), body%spacing, &
                             body%law, x, body%particles%state(l, :, c), beyond, faceless)
        end do
      end do
    end do
    if (parallel_any(beyond)) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' goes beyond an absorbing "// &
                      'edge of the grid', 'let bodies end where the edge is', card%location)
    else if (parallel_any(faceless)) then
      call error_make(error, exit_deck, "the particles of body '"//trim(body%name)//"' have no "// &
                      'known faces at an absorbing edge', 'faces are those of a lattice along '// &
                      'the edge: layout=uniform, no jitter, no file, not turned', card%location)
    end if
  end subroutine absorbing_fill

  !> The columns of one particle and one edge.
  pure subroutine fill_particle(card, mesh, lattice, weight, load, spacing, law, x, state, &
                                beyond, faceless)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(lattice_t), intent(in) :: lattice       !! where the faces are known
    real(dp), intent(in) :: weight(3)            !! per volume, of matter that rests on its stress
    type(load_t), intent(in) :: load
    real(dp), intent(in) :: spacing
    type(constitutive_t), intent(in) :: law
    real(dp), intent(in) :: x(3)
    real(dp), intent(inout) :: state(:)
    logical, intent(inout) :: beyond, faceless
    real(dp) :: area(3), outward, to_edge, length
    integer :: n, at(3)
    n = mesh%ndim
    outward = real(2*load%side - 3, dp)
    to_edge = outward*(mesh_place(mesh, load%axis, real(mesh%edge(load%side, load%axis), dp)) - &
                       x(load%axis))
    length = spacing
    if (has_faces(card)) then
      at = faces_place(card, lattice, x)
      length = faces_length(lattice, at, load%axis)
    end if
    if (to_edge >= length) return
    beyond = beyond .or. to_edge <= 0.0_dp
    if (.not. has_faces(card)) then
      faceless = .true.
      return
    end if
    area = area_shown(card, mesh, lattice, load, at, x, state(1))
    faceless = faceless .or. (all(abs(area) <= 0.0_dp) .and. to_edge < near*length)
    if (all(abs(area) <= 0.0_dp)) return
    state(load%column:load%column + n - 1) = area(:n)
    associate (rest => state(load%column + n:load%column + 2*n - 1), first => law%slots%stress)
      rest = outward*across(state(first:first + law%slots%stresses - 1), load%axis, n)
      rest(load%axis) = rest(load%axis) + outward*law%ambient
      ! At the face, half a particle from where the stress is known.
      rest(load%axis) = rest(load%axis) - 0.5_dp*state(1)/norm2(area)*weight(load%axis)
    end associate
  end subroutine fill_particle

  !> Whether the faces of a body's particles are known: those of a lattice.
  pure function has_faces(card) result(yes)
    type(body_card_t), intent(in) :: card
    logical :: yes
    yes = any(card%layout == [layout_graded, layout_lattice]) .and. card%jitter <= 0.0_dp
  end function has_faces

  !> Area vector of the face that a particle shows to an edge; 0: it shows none.
  pure function area_shown(card, mesh, lattice, load, at, x, volume) result(area)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(lattice_t), intent(in) :: lattice
    type(load_t), intent(in) :: load
    integer, intent(in) :: at(3)                 !! faces_place
    real(dp), intent(in) :: x(3), volume
    real(dp) :: area(3)
    type(face_t) :: face
    integer :: axis, side
    area = 0.0_dp
    do axis = 1, mesh%ndim
      do side = 1, 2
        face = faces_shown(card, lattice, at, axis, side, x, volume)
        if ((2*load%side - 3)*face%area(load%axis) < aligned*norm2(face%area)) cycle
        if (face%shown) area = face%area
      end do
    end do
  end function area_shown

  !> Stress across an axis: a fluid has the mean alone.
  pure function across(stress, axis, ndim) result(traction)
    real(dp), intent(in) :: stress(:)
    integer, intent(in) :: axis, ndim
    real(dp) :: traction(ndim)
    integer :: c, a, b
    traction = 0.0_dp
    if (size(stress) == 1) then
      traction(axis) = stress(1)
      return
    end if
    do c = 1, size(stress)
      a = voigt_axes(1, c)
      b = voigt_axes(2, c)
      if (b == axis .and. a <= ndim) traction(a) = stress(c)
      if (a == axis .and. b <= ndim) traction(b) = stress(c)
    end do
  end function across

  !> An error where no body ends at an edge. All ranks must call it.
  subroutine absorbing_check(mesh, bodies, location, error)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    character(:), allocatable, intent(in) :: location  !! of the card
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: largest(2, 3)
    integer :: axis, b, i, side
    if (allocated(error)) return
    largest = 0.0_dp
    do b = 1, size(bodies)
      if (.not. bodies(b)%absorbs) cycle
      do i = 1, size(bodies(b)%loads)
        associate (load => bodies(b)%loads(i), particles => bodies(b)%particles)
          if (load%kind /= load_absorbing) cycle
          largest(load%side, load%axis) = &
            max(largest(load%side, load%axis), &
                maxval(abs(particles%state(:, load%column + load%axis - 1, :particles%chunks))))
        end associate
      end do
    end do
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (.not. mesh%absorbs(side, axis)) cycle
        if (parallel_max(largest(side, axis)) > 0.0_dp) cycle
        call error_make(error, exit_deck, 'nothing ends at the absorbing edge '// &
                        axis_names(axis, mesh%space)//merge('-', '+', side == 1), &
                        'let a body reach the edge of the grid there, or remove the wall', &
                        location)
        return
      end do
    end do
  end subroutine absorbing_check

end module sgmp_absorbing_build
