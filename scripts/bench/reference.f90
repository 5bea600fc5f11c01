!> A yardstick: the SGMP step (MUSL, linear elasticity, 3D) as one would write it first. Particles
!! are records, visited one after the other; weights are worked out anew in every loop; grids are
!! arrays of records. No bins, no vectors, no walls, one thread. Its only use is to tell how fast a
!! machine is for this kind of work, and so how much the solver gains.
!!
!! usage: reference CELLS STEPS   (a block of CELLS^3 cells, 8 particles each, as input/block.inp)
program reference
  use, intrinsic :: iso_fortran_env, only: dp => real64, i8 => int64
  implicit none

  type :: particle_t
    real(dp) :: x(3), v(3), mass, volume, stress(6)  !! xx yy zz xy yz xz; lengths in cells
  end type particle_t

  integer, parameter :: margin = 3         !! empty cells around the block
  real(dp), parameter :: shear = 1.0_dp, lame = 1.5_dp, density = 1.0_dp, pi = acos(-1.0_dp)
  real(dp), parameter :: dt = 0.3_dp/sqrt((lame + 2.0_dp*shear)/density)
  integer, parameter :: pair(2, 6) = reshape([1, 1, 2, 2, 3, 3, 1, 2, 2, 3, 1, 3], [2, 6])
  integer, parameter :: flux(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])
  type(particle_t), allocatable :: particles(:)
  real(dp), allocatable :: centre(:, :, :, :)  !! (10, i, j, k): mass, momentum, stress*volume
  real(dp), allocatable :: node(:, :, :, :)    !! (7, i, j, k): acceleration, velocity, 1/mass
  real(dp), allocatable :: again(:, :, :, :)   !! (3, i, j, k): momentum of the updated particles
  real(dp), allocatable :: pushed(:, :, :, :)  !! (3, i, j, k): acceleration at centres
  real(dp), allocatable :: moved(:, :, :, :)   !! (12, i, j, k): velocity and its gradient at centres
  real(dp) :: initial                       !! kinetic energy
  integer :: cells, steps, points, s
  integer(i8) :: begin, finish, rate
  character(32) :: argument
  call get_command_argument(1, argument)
  read (argument, *) cells
  call get_command_argument(2, argument)
  read (argument, *) steps
  points = cells + 2*margin
  allocate (centre(10, points, points, points), node(7, points, points, points), &
            again(3, points, points, points), pushed(3, points, points, points), &
            moved(12, points, points, points))
  call seed()
  initial = kinetic_energy()
  call step(0.5_dp*dt)                      ! not counted: it touches all memory first
  call system_clock(begin, rate)
  do s = 1, steps
    call step(dt)
  end do
  call system_clock(finish)
  print '(a, f0.3, a, i0, a, es23.16, a)', '{"ns": ', &
    1.0e9_dp*real(finish - begin, dp)/real(rate, dp)/(real(size(particles), dp)*steps), &
    ', "particles": ', size(particles), ', "kinetic_share": ', kinetic_energy()/initial, '}'

contains

  !> Particles on a lattice, ringing.
  subroutine seed()
    integer :: i, j, k, n
    allocate (particles((2*cells)**3))
    n = 0
    do k = 1, 2*cells
      do j = 1, 2*cells
        do i = 1, 2*cells
          n = n + 1
          particles(n)%x = 0.5_dp*[i, j, k] - 0.25_dp
          particles(n)%v = 1.0e-3_dp*0.3_dp/dt*cos(pi*particles(n)%x/cells)
          particles(n)%x = particles(n)%x + margin
          particles(n)%volume = 0.125_dp
          particles(n)%mass = density*particles(n)%volume
          particles(n)%stress = 0.0_dp
        end do
      end do
    end do
  end subroutine seed

  subroutine step(dt_kick)
    real(dp), intent(in) :: dt_kick
    integer :: p
    centre = 0.0_dp
    do p = 1, size(particles)
      call project(particles(p))
    end do
    call solve_nodes(dt_kick)
    call interpolate_vectors()
    again = 0.0_dp
    do p = 1, size(particles)
      call kick(particles(p), dt_kick)
      call project_momentum(particles(p))
    end do
    call remap_nodes()
    call differentiate()
    do p = 1, size(particles)
      call move(particles(p))
    end do
  end subroutine step

  !> First centre and weights of the eight centres around a particle.
  pure subroutine weigh(x, first, w)
    real(dp), intent(in) :: x(3)
    integer, intent(out) :: first(3)
    real(dp), intent(out) :: w(0:1, 0:1, 0:1)
    real(dp) :: r(3)
    integer :: i, j, k
    first = floor(x + 0.5_dp)
    r = x + 0.5_dp - first
    do k = 0, 1
      do j = 0, 1
        do i = 0, 1
          w(i, j, k) = merge(r(1), 1.0_dp - r(1), i == 1)*merge(r(2), 1.0_dp - r(2), j == 1)* &
                       merge(r(3), 1.0_dp - r(3), k == 1)
        end do
      end do
    end do
  end subroutine weigh

  !> Particle to centres (Eqs. 21-23).
  subroutine project(particle)
    type(particle_t), intent(in) :: particle
    real(dp) :: values(10), w(0:1, 0:1, 0:1)
    integer :: first(3), i, j, k
    values(1) = particle%mass
    values(2:4) = particle%mass*particle%v
    values(5:10) = particle%volume*particle%stress
    call weigh(particle%x, first, w)
    do k = 0, 1
      do j = 0, 1
        do i = 0, 1
          centre(:, first(1) + i, first(2) + j, first(3) + k) = w(i, j, k)*values + &
            centre(:, first(1) + i, first(2) + j, first(3) + k)
        end do
      end do
    end do
  end subroutine project

  !> The same for the momentum alone.
  subroutine project_momentum(particle)
    type(particle_t), intent(in) :: particle
    real(dp) :: w(0:1, 0:1, 0:1)
    integer :: first(3), i, j, k
    call weigh(particle%x, first, w)
    do k = 0, 1
      do j = 0, 1
        do i = 0, 1
          again(:, first(1) + i, first(2) + j, first(3) + k) = &
            again(:, first(1) + i, first(2) + j, first(3) + k) + &
            w(i, j, k)*particle%mass*particle%v
        end do
      end do
    end do
  end subroutine project_momentum

  !> Centres to nodes, acceleration and velocity (Eqs. 17-19, 33, 34).
  subroutine solve_nodes(dt_kick)
    real(dp), intent(in) :: dt_kick
    real(dp) :: mass, momentum(3), force(3), sign_of(3)
    integer :: i, j, k, a, b, c(3), n
    do k = 2, points
      do j = 2, points
        do i = 2, points
          mass = 0.0_dp
          momentum = 0.0_dp
          force = 0.0_dp
          do n = 0, 7
            c = [mod(n, 2), mod(n/2, 2), n/4]
            sign_of = 2*c - 1
            c = [i, j, k] - 1 + c
            mass = mass + 0.125_dp*centre(1, c(1), c(2), c(3))
            do a = 1, 3
              momentum(a) = momentum(a) + 0.125_dp*centre(1 + a, c(1), c(2), c(3))
              do b = 1, 3
                force(a) = force(a) + 0.25_dp*sign_of(b)*centre(4 + flux(b, a), c(1), c(2), c(3))
              end do
            end do
          end do
          node(:, i, j, k) = 0.0_dp
          if (mass <= 1.0e-12_dp) cycle
          node(7, i, j, k) = 1.0_dp/mass
          node(1:3, i, j, k) = force/mass
          node(4:6, i, j, k) = momentum/mass + dt_kick*force/mass
        end do
      end do
    end do
  end subroutine solve_nodes

  !> Nodes to centres: acceleration and velocity (Eqs. 32, 33).
  subroutine interpolate_vectors()
    integer :: i, j, k, q
    do k = 2, points - 1
      do j = 2, points - 1
        do i = 2, points - 1
          do q = 1, 3
            pushed(q, i, j, k) = 0.125_dp*sum(node(q, i:i + 1, j:j + 1, k:k + 1))
            moved(q, i, j, k) = 0.125_dp*sum(node(3 + q, i:i + 1, j:j + 1, k:k + 1))
          end do
        end do
      end do
    end do
  end subroutine interpolate_vectors

  !> Velocity re-mapped from the updated particles, in the place of the acceleration.
  subroutine remap_nodes()
    integer :: i, j, k, a
    do k = 2, points
      do j = 2, points
        do i = 2, points
          do a = 1, 3
            node(a, i, j, k) = node(7, i, j, k)*0.125_dp* &
                               sum(again(a, i - 1:i, j - 1:j, k - 1:k))
          end do
        end do
      end do
    end do
  end subroutine remap_nodes

  !> Nodes to centres: gradient of the re-mapped velocity (Eqs. 25, 26).
  subroutine differentiate()
    integer :: i, j, k, a
    do k = 2, points - 1
      do j = 2, points - 1
        do i = 2, points - 1
          do a = 1, 3
            moved(1 + 3*a, i, j, k) = 0.25_dp*(sum(node(a, i + 1, j:j + 1, k:k + 1)) &
                                               - sum(node(a, i, j:j + 1, k:k + 1)))
            moved(2 + 3*a, i, j, k) = 0.25_dp*(sum(node(a, i:i + 1, j + 1, k:k + 1)) &
                                               - sum(node(a, i:i + 1, j, k:k + 1)))
            moved(3 + 3*a, i, j, k) = 0.25_dp*(sum(node(a, i:i + 1, j:j + 1, k + 1)) &
                                               - sum(node(a, i:i + 1, j:j + 1, k)))
          end do
        end do
      end do
    end do
  end subroutine differentiate

  !> Velocity of a particle (Eq. 29).
  pure subroutine kick(particle, dt_kick)
    type(particle_t), intent(inout) :: particle
    real(dp), intent(in) :: dt_kick
    real(dp) :: got(3), w(0:1, 0:1, 0:1)
    integer :: first(3), i, j, k
    call weigh(particle%x, first, w)
    got = 0.0_dp
    do k = 0, 1
      do j = 0, 1
        do i = 0, 1
          got = got + w(i, j, k)*pushed(:, first(1) + i, first(2) + j, first(3) + k)
        end do
      end do
    end do
    particle%v = particle%v + dt_kick*got
  end subroutine kick

  !> Position, strain, rotation, Hooke's law (Eqs. 27, 28, 31).
  pure subroutine move(particle)
    type(particle_t), intent(inout) :: particle
    real(dp) :: got(12), w(0:1, 0:1, 0:1), l(3, 3), spin(3, 3), full(3, 3), rate(3, 3), trace
    real(dp) :: adjugate(3, 3), square(3, 3), turned(3, 3), first_of, second_of
    integer :: first(3), i, j, k, a, b, c
    call weigh(particle%x, first, w)
    got = 0.0_dp
    do k = 0, 1
      do j = 0, 1
        do i = 0, 1
          got = got + w(i, j, k)*moved(:, first(1) + i, first(2) + j, first(3) + k)
        end do
      end do
    end do
    do a = 1, 3
      l(a, :) = dt*got(3*a + 1:3*a + 3)
    end do
    ! strain in the middle of the step (doc/theory.md, 2), from the invariants of dt L
    first_of = l(1, 1) + l(2, 2) + l(3, 3)
    square = matmul(l, l)
    second_of = 0.5_dp*(first_of**2 - (square(1, 1) + square(2, 2) + square(3, 3)))
    adjugate = square - first_of*l
    do a = 1, 3
      adjugate(a, a) = adjugate(a, a) + second_of
    end do
    rate = 0.5_dp*(l + transpose(l)) - 0.25_dp*(adjugate + transpose(adjugate))
    do a = 1, 3
      rate(a, a) = rate(a, a) + 0.5_dp*second_of
    end do
    spin = 0.5_dp*(l - transpose(l))
    trace = rate(1, 1) + rate(2, 2) + rate(3, 3)
    do c = 1, 6
      full(pair(1, c), pair(2, c)) = particle%stress(c)
      full(pair(2, c), pair(1, c)) = particle%stress(c)
    end do
    turned = matmul(spin, full)
    turned = turned + transpose(turned)
    square = matmul(spin, turned)
    turned = turned + 0.5_dp*(square + transpose(square))
    do c = 1, 6
      a = pair(1, c)
      b = pair(2, c)
      particle%stress(c) = particle%stress(c) + 2.0_dp*shear*rate(a, b) + turned(a, b)
      if (a == b) particle%stress(c) = particle%stress(c) + lame*trace
    end do
    particle%volume = particle%volume*(1.0_dp + first_of + second_of + dot_product(l(1, :), adjugate(:, 1)))
    particle%x = particle%x + dt*got(1:3)
  end subroutine move

  real(dp) function kinetic_energy()
    integer :: p
    kinetic_energy = 0.0_dp
    do p = 1, size(particles)
      kinetic_energy = kinetic_energy + 0.5_dp*particles(p)%mass*sum(particles(p)%v**2)
    end do
  end function kinetic_energy

end program reference
