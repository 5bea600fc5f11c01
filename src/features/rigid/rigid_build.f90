!> Mass, inertia and first motion of rigid bodies that turn or are free, from their particles.
module sgmp_rigid_build
  use sgmp_body, only: body_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_places, mesh_position, mesh_t
  use sgmp_motion, only: motion_mass
  use sgmp_parallel, only: parallel_exact_sums
  use sgmp_rigid_motion, only: freedoms, motion_at, motion_axes, motion_inertia, motion_spin, &
                               motion_start
  use sgmp_scene, only: body_card_t, scene_at_rest
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: rigid_begin, rigid_declare, rigid_centre

contains

  !> What a card says of a body's motion.
  subroutine rigid_declare(card, mesh, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    real(dp), parameter :: nowhere(3) = 0.0_dp
    logical :: axes(freedoms)
    integer :: d
    body%rigid = card%rigid
    if (.not. body%rigid) return
    body%motion = card%motion
    body%at_rest = scene_at_rest(card)
    do d = 1, mesh%ndim
      body%speed(d) = body%motion(d)%evaluate(nowhere, nowhere, 0.0_dp)
    end do
    axes = motion_axes(mesh%space)
    associate (motion => body%rigid_motion)
      motion%free = card%free
      motion%turns = any(axes(4:)) .and. (card%free .or. card%turns())
      if (card%free) return
      do d = 1, 3
        motion%omega(d) = card%omega(d)
        if (motion%turns) motion%spin(d) = motion%omega(d)%evaluate(nowhere, nowhere, 0.0_dp)
      end do
    end associate
  end subroutine rigid_declare

  !> Where a body is and how it moves at the start. Particles of a free body bring their velocities:
  !! it takes their momentum, and they its motion. All ranks must call it.
  subroutine rigid_begin(card, mesh, body)
    type(body_card_t), intent(in) :: card
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    real(dp) :: moments(3, 3), own(3, 3), mass, momentum(freedoms)
    if (.not. (body%rigid_motion%free .or. body%rigid_motion%turns)) return
    associate (motion => body%rigid_motion)
      call rigid_centre(mesh, body, mass, motion%centre)
      if (motion%free) then
        if (card%mass > 0.0_dp) then
          motion%heavier = card%mass/mass
          call scale_masses(motion%heavier, body)
          mass = card%mass
        end if
        call rigid_moments(mesh, motion%centre, body, moments, own, momentum)
        momentum = merge(momentum, 0.0_dp, motion_axes(mesh%space))
        body%speed = momentum(:3)/mass
        ! Velocities of points say how fast the points turn; the cubes around them turn with them.
        call motion_inertia(motion, mesh%space, mass, moments)
        motion%spin = motion_spin(motion, momentum(4:))
        call motion_inertia(motion, mesh%space, mass, moments + own)
        motion%momentum = [momentum(:3), matmul(motion%inertia, motion%spin)]
      else if (card%about_given) then
        motion%centre = card%about
      end if
      call motion_start(motion)
      call set_velocities(mesh, body)
    end associate
  end subroutine rigid_begin

  !> Makes particles heavier, or lighter.
  pure subroutine scale_masses(factor, body)
    real(dp), intent(in) :: factor
    type(body_t), intent(inout) :: body
    integer :: c, column
    associate (particles => body%particles)
      column = motion_mass(particles%ndim)
      do c = 1, particles%chunks
        particles%motion(:, column, c) = factor*particles%motion(:, column, c)
      end do
    end associate
  end subroutine scale_masses

  !> Mass and centre of mass.
  subroutine rigid_centre(mesh, body, mass, centre)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: body
    real(dp), intent(out) :: mass, centre(3)
    real(dp), allocatable :: terms(:, :)
    real(dp) :: sums(4), m
    integer :: c, l, n
    n = mesh%ndim
    associate (particles => body%particles)
      allocate (terms(4, particles%chunks), source=0.0_dp)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          m = particles%motion(l, motion_mass(n), c)
          terms(1, c) = terms(1, c) + m
          terms(2:1 + n, c) = terms(2:1 + n, c) + m*particles%motion(l, :n, c)
        end do
      end do
    end associate
    call parallel_exact_sums(terms, sums)
    mass = sums(1)
    centre = 0.0_dp
    centre(:n) = mesh_position(mesh%origin(:n), mesh%h, sums(2:1 + n)/mass)
  end subroutine rigid_centre

  !> Second moments about a point: of the particles as points, and of each as a cube (in the plane a
  !! square) about itself; momentum.
  subroutine rigid_moments(mesh, centre, body, moments, own, momentum)
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: centre(3)
    type(body_t), intent(in) :: body
    real(dp), intent(out) :: moments(3, 3), own(3, 3), momentum(freedoms)
    real(dp), allocatable :: terms(:, :)
    real(dp) :: sums(9 + freedoms + 1), m, x(3), v(3)
    integer :: c, l, n, d
    n = mesh%ndim
    x = 0.0_dp
    v = 0.0_dp
    associate (particles => body%particles)
      allocate (terms(size(sums), particles%chunks), source=0.0_dp)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          m = particles%motion(l, motion_mass(n), c)
          x(:n) = mesh_places(mesh, particles%motion(l, :n, c)) - centre(:n)
          v(:n) = particles%motion(l, n + 1:2*n, c)
          terms(:, c) = terms(:, c) + m*[x(1)*x, x(2)*x, x(3)*x, v, cross(x, v), &
                                         particles%state(l, 1, c)**(2.0_dp/n)/12.0_dp]
        end do
      end do
    end associate
    call parallel_exact_sums(terms, sums)
    moments = reshape(sums(:9), [3, 3])
    momentum = sums(10:9 + freedoms)
    own = 0.0_dp
    do d = 1, n
      own(d, d) = sums(10 + freedoms)
    end do
  end subroutine rigid_moments

  !> Gives particles the velocity of the body.
  subroutine set_velocities(mesh, body)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: body
    real(dp) :: x(3), v(3)
    integer :: c, l, n
    n = mesh%ndim
    x = 0.0_dp
    associate (particles => body%particles)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          x(:n) = mesh_places(mesh, particles%motion(l, :n, c))
          v = motion_at(body%rigid_motion, body%speed, x)
          particles%motion(l, n + 1:2*n, c) = v(:n)
        end do
      end do
    end associate
  end subroutine set_velocities

end module sgmp_rigid_build
