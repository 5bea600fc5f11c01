!> Stress of particles at the start, as the card `initial_stress` says it.
module sgmp_build_stress
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use sgmp_body, only: body_t
  use sgmp_constitutive, only: law_is_spherical
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_lattice, only: lattice_tolerance
  use sgmp_material_weight, only: fluid_below, stress_energy
  use sgmp_mesh, only: mesh_places, mesh_t
  use sgmp_motion, only: motion_mass
  use sgmp_one_sided_build, only: one_sided_bear
  use sgmp_parallel, only: parallel_agree
  use sgmp_scene, only: body_card_t
  use sgmp_voigt, only: voigt_axes
  implicit none
  private
  public :: stress_fill, stress_returned

  integer, parameter :: most = 6  !! components of a stress

contains

  !> Gives the particles of a body their stress, and those of a fluid the mass and energy that go
  !! with it; an error where a particle lies above the surface, a formula is no number there, or a
  !! fluid has no such state. All ranks must call it.
  subroutine stress_fill(card, gravity, mesh, body, error)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(out) :: error
    logical :: buried, possible
    integer :: c, l
    body%stressed = card%stress%given .and. .not. body%rigid
    if (.not. body%stressed) return
    buried = .true.
    possible = .true.
    do c = 1, body%particles%chunks
      do l = 1, lanes
        if (body%particles%id(l, c) > 0) then
          call fill(card, gravity, place(mesh, body%particles%motion(l, :mesh%ndim, c)), mesh, &
                    l, c, body, buried, possible)
        end if
      end do
    end do
    if (.not. buried) then
      call error_make(error, exit_deck, "particles of body '"//trim(body%name)//"' lie above "// &
                      'the surface of the ground', 'surface=… is measured from the origin, '// &
                      'against gravity', card%stress%location)
    else if (.not. possible) then
      call error_make(error, exit_deck, "body '"//trim(body%name)//"' cannot have this stress "// &
                      'at some places', 'formulas must be finite there, and the equation of '// &
                      'state must have such a pressure', card%stress%location)
    end if
    call parallel_agree(error)
  end subroutine stress_fill

  !> Gives a particle its stress; says where that cannot be.
  subroutine fill(card, gravity, x, mesh, l, c, body, buried, possible)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3), x(3)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: l, c                  !! lane, chunk
    type(body_t), intent(inout) :: body
    logical, intent(inout) :: buried, possible
    real(dp) :: stress(most)
    logical :: ok
    if (card%stress%geostatic) then
      if (depth(card, gravity, x) < -lattice_tolerance*body%spacing) buried = .false.
    end if
    if (law_is_spherical(body%law)) then
      call fill_fluid(card, gravity, x, l, c, body, ok)
      possible = possible .and. ok
      return
    end if
    stress = stress_at(card, gravity, x, body)
    possible = possible .and. all(ieee_is_finite(stress))
    associate (slots => body%law%slots, n => body%law%slots%stresses)
      body%particles%state(l, slots%stress:slots%stress + n - 1, c) = stress(:n)
      if (slots%energy > 0) then
        body%particles%state(l, slots%energy, c) = stress_energy(body%law, stress(:n))
      end if
    end associate
    call load_walls(card, gravity, x, mesh, l, c, body)
  end subroutine fill

  !> Lets walls that let go bear the stress where a particle's face lies at them.
  subroutine load_walls(card, gravity, x, mesh, l, c, body)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3), x(3)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: l, c                  !! lane, chunk
    type(body_t), intent(inout) :: body
    real(dp) :: face(3)
    integer :: w
    do w = 1, size(body%walls)
      associate (wall => body%walls(w))
        face = x
        face(wall%axis) = x(wall%axis) + 0.5_dp*wall%spacing*merge(-1.0_dp, 1.0_dp, wall%side == 1)
        call one_sided_bear(mesh, wall, stress_at(card, gravity, face, body), &
                            body%particles%motion(l, wall%axis, c), body%particles%state(l, :, c))
      end associate
    end do
  end subroutine load_walls

  !> Where a particle is.
  pure function place(mesh, coordinates) result(x)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: coordinates(:)       !! (ndim) cells
    real(dp) :: x(3)
    integer :: n
    n = size(coordinates)
    x = 0.0_dp
    x(:n) = mesh_places(mesh, coordinates)
  end function place

  !> Depth below the surface, where there is one.
  function depth(card, gravity, x) result(length)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3), x(3)
    real(dp) :: length
    length = 0.0_dp  ! the pressure is the same everywhere
    if (.not. card%stress%geostatic) return
    length = card%stress%surface%evaluate(x, x, 0.0_dp) + dot_product(gravity, x)/norm2(gravity)
  end function depth

  !> Stress of a solid at a place: the weight above it along gravity, k0 times as much across.
  function stress_at(card, gravity, x, body) result(stress)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3), x(3)
    type(body_t), intent(in) :: body
    real(dp) :: stress(most)
    real(dp) :: down(3), weight, k0
    integer :: c
    if (.not. card%stress%geostatic) then
      do c = 1, most
        stress(c) = card%stress%value(c)%evaluate(x, x, 0.0_dp)
        if (c <= 3) stress(c) = stress(c) - card%stress%pressure
      end do
      return
    end if
    k0 = card%stress%k0
    if (k0 < 0.0_dp) k0 = body%law%elastic%poisson/(1.0_dp - body%law%elastic%poisson)
    down = gravity/norm2(gravity)
    weight = card%stress%pressure + body%law%density*norm2(gravity)*depth(card, gravity, x)
    do c = 1, most
      stress(c) = -weight*(1.0_dp - k0)*down(voigt_axes(1, c))*down(voigt_axes(2, c))
      if (c <= 3) stress(c) = stress(c) - weight*k0
    end do
  end function stress_at

  !> Pressure, energy and mass of a particle of a fluid, which fills its volume as it is below so
  !! much weight.
  subroutine fill_fluid(card, gravity, x, l, c, body, ok)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3), x(3)
    integer, intent(in) :: l, c                  !! lane, chunk
    type(body_t), intent(inout) :: body
    logical, intent(out) :: ok
    real(dp) :: surface, v, energy, pressure
    integer :: mass
    surface = card%stress%pressure
    if (.not. card%stress%pressure_given) surface = -body%law%history%first_mean_stress
    call fluid_below(body%law, surface, norm2(gravity), max(depth(card, gravity, x), 0.0_dp), v, &
                     energy, pressure, ok)
    if (.not. ok) return
    associate (slots => body%law%slots, particles => body%particles)
      mass = motion_mass(particles%ndim)
      particles%motion(l, mass, c) = particles%motion(l, mass, c)/v
      particles%state(l, slots%energy, c) = energy
      particles%state(l, slots%stress:slots%stress + min(3, slots%stresses) - 1, c) = -pressure
    end associate
  end subroutine fill_fluid

  !> How many particles, held by this rank, no longer have the stress that the card gave them at the
  !! start: it was beyond yield.
  function stress_returned(card, gravity, mesh, body) result(n)
    type(body_card_t), intent(in) :: card
    real(dp), intent(in) :: gravity(3)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    integer(i8) :: n
    real(dp), parameter :: same = 1.0e-9_dp
    real(dp) :: stress(most)
    integer :: c, l, first, last
    n = 0_i8
    if (.not. card%stress%given .or. body%rigid .or. law_is_spherical(body%law)) return
    first = body%law%slots%stress
    last = first + body%law%slots%stresses - 1
    do c = 1, body%particles%chunks
      do l = 1, lanes
        if (body%particles%id(l, c) == 0) cycle
        stress = stress_at(card, gravity, place(mesh, body%particles%motion(l, :mesh%ndim, c)), &
                           body)
        associate (now => body%particles%state(l, first:last, c))
          if (maxval(abs(now - stress(:size(now)))) > same*maxval(abs(stress))) n = n + 1_i8
        end associate
      end do
    end do
  end function stress_returned

end module sgmp_build_stress
