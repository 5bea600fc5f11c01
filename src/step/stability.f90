!> The largest stable Courant number of the scheme on the scene as it lies.
!!
!! With the particles held where they are, the nodal velocity that strains them changes in a step by
!! -dt A u, u its sum over the steps. A = M^-1 S M^-1 K, K the stiffness that the particles give to
!! the grid and S their consistent mass: the nodal acceleration goes to the particles and back (S)
!! before the strain reads it, a leapfrog that is stable up to dt^2 largest(A) = 4. USL strains with
!! the velocity before that smoothing: A = M^-1 K, and modes that the smoothing takes away
!! altogether are stable up to dt^2 largest(A) = 2 only. A consistent mass (doc/mass.md) has another
!! inverse in the place of M^-1. Derivation: doc/time-step.md.
!!
!! A is applied by the sweeps of the step itself (`plan_t%probe`), so it knows walls, free surfaces,
!! the particles' layout and the method. Every particle is given the same wave speed, the largest,
!! by which the Courant number is defined; so the result does not depend on the materials' scale.
!! Both operators are self-adjoint in the energy norm of K: Lanczos iteration, from below.
!!
!! Where the grid hardly resists, as around a particle that is alone, the limit is that of Courant,
!! Friedrichs and Lewy: in a step, stress reaches no farther than a stencil out and a stencil back.
module sgmp_stability
  use sgmp_columns, only: node_acceleration, node_inertia, node_inverse_mass
  use sgmp_field, only: field_t
  use sgmp_field_nodes, only: field_node_planes, field_remap, field_solve
  use sgmp_halo, only: halo_own_planes
  use sgmp_kernels, only: stencil_reach
  use sgmp_kinds, only: dp, i8
  use sgmp_mass_stages, only: mass_spread
  use sgmp_mesh, only: wall_kick
  use sgmp_method, only: method_t
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_exact_sums
  use sgmp_phases, only: phase_mirror, phase_normalise, phase_place, phase_rotation, &
                         phase_surfaces_strain, phase_surfaces_weigh, phase_sweep
  use sgmp_plan, only: plan_t
  use sgmp_rebin_phases, only: phase_rebin_particles
  use sgmp_rigid_bodies, only: rigid_field
  use sgmp_rows, only: key_j, key_k
  use sgmp_sums, only: nodes_sums
  use sgmp_update, only: update_usl
  implicit none
  private
  public :: stability_choose, stability_limit, largest_eigenvalue

  integer, parameter :: most_iterations = 16
  integer, parameter :: interval = 320  !! steps between two probes: they cost a step an iteration
  !> Part of the limit that is used, by update (usf, musl, usl, usavg) and kernel (mpm, gimp, sgmp).
  !! Particles move on until the next probe, and they move through the grid, which the limit of
  !! resting particles does not see: MPM's jumps of the gradient at cell faces feed energy into the
  !! motion well below it. Measured: doc/time-step.md.
  real(dp), parameter :: safety(4, 3) = reshape([0.13_dp, 0.35_dp, 0.85_dp, 0.50_dp, &
                                                 0.78_dp, 0.78_dp, 0.85_dp, 0.78_dp, &
                                                 0.78_dp, 0.78_dp, 0.85_dp, 0.78_dp], [4, 3])
  real(dp), parameter :: safety_contact = 0.40_dp  !! bodies that may touch: impulses come and go

  !> A vector of the nodes of one field.
  type :: vector_t
    real(dp), allocatable :: x(:, :)   !! (points, ndim)
  end type vector_t

contains

  !> Sets the clock's Courant number where the deck leaves it to the program and it is due.
  subroutine stability_choose(model, found)
    type(model_t), intent(inout) :: model
    logical, intent(out), optional :: found      !! it was due
    real(dp) :: part
    if (present(found)) found = .false.
    associate (clock => model%clock)
      if (.not. clock%automatic) return
      if (clock%step >= clock%next_probe) then
        clock%limit = stability_limit(model)
        clock%next_probe = clock%step + interval
        if (present(found)) found = .true.
      end if
      part = safety(model%method%update, model%fields(1)%kernel)
      if (size(model%contact%pairs) > 0) part = min(part, safety_contact)
      clock%cfl = part*clock%limit
    end associate
  end subroutine stability_choose

  !> Largest stable Courant number with the particles held where they are. Needs the projection of
  !! their present state, as it is between two steps, and leaves it as it was.
  function stability_limit(model) result(courant)
    type(model_t), intent(inout) :: model
    real(dp) :: courant
    type(field_t), allocatable :: saved(:)
    type(vector_t), allocatable :: now(:), before(:)
    real(dp) :: alpha(most_iterations), beta(most_iterations), square, largest
    integer :: f, j, n
    real(dp) :: wall_motion(3, 2, 3, 2)
    logical :: smoothing
    smoothing = model%method%update /= update_usl
    allocate (saved, source=model%fields)
    wall_motion = model%mesh%wall_motion
    model%mesh%wall_motion = 0.0_dp  ! waves run as if walls were at rest, and smooth
    do f = 1, size(model%fields)  ! and of parts that are moved as if they were free
      if (model%fields(f)%columns%driven > 0) model%fields(f)%drives%acts = .false.
    end do
    call phase_rotation(model%method, model%mesh, model%fields, model%bodies, model%team, &
                        model%ranks%partition)
    call phase_surfaces_weigh(model%method, model%mesh, model%fields, model%bodies, model%team, &
                              model%ranks%partition)
    call start(model)
    call vector_get(model, before)
    call accelerate(model)
    if (smoothing) call smooth(model)
    n = 0
    do j = 1, most_iterations
      call vector_get(model, now)
      call accelerate(model)
      square = -mass_product(model, now)
      if (.not. square > 0.0_dp) exit
      beta(j) = sqrt(square)
      if (j > 1) then
        if (beta(j) < 1.0e-8_dp*alpha(1)) exit
      end if
      n = j
      call vector_scale(now, 1.0_dp/beta(j))
      call step_lanczos(model, smoothing, now, before, beta(j), &
                        merge(0.0_dp, beta(j), j == 1), alpha(j))
      call move_alloc(now, before)
    end do
    call move_alloc(saved, model%fields)
    model%mesh%wall_motion = wall_motion
    courant = 2.0_dp*stencil_reach(model%fields(1)%kernel)
    if (n == 0) return
    largest = largest_eigenvalue(alpha(:n), beta(2:n))
    if (largest > 0.0_dp) courant = min(courant, merge(2.0_dp, sqrt(2.0_dp), smoothing)/ &
                                        (model%mesh%h*sqrt(largest)))
  end function stability_limit

  !> From the acceleration a of `now`: the next vector A now - alpha now - beta before, in the
  !! nodes.
  subroutine step_lanczos(model, smoothing, now, before, beta, part, alpha)
    type(model_t), intent(inout) :: model
    logical, intent(in) :: smoothing
    type(vector_t), intent(in) :: now(:), before(:)
    real(dp), intent(in) :: beta                 !! norm of `now` before it was scaled
    real(dp), intent(in) :: part                 !! the same, 0 for the first vector
    real(dp), intent(out) :: alpha
    type(vector_t), allocatable :: force(:)
    integer :: f, n
    n = model%mesh%ndim
    call vector_get(model, force)
    call mass_spread(model)
    if (smoothing) then
      call smooth(model)
      call mass_spread(model)
    end if
    alpha = mass_product(model, force)/beta**2
    do f = 1, size(model%fields)
      associate (next => model%fields(f)%node(:, :n))
        next = -next/beta - alpha*now(f)%x - part*before(f)%x
      end associate
    end do
  end subroutine step_lanczos

  !> Nodal masses, and a velocity that contains every mode: a different number at every node and
  !! axis, of the node's place alone.
  subroutine start(model)
    type(model_t), intent(inout) :: model
    integer :: f, s, i, d, n, p1, p2
    integer(i8) :: hash
    n = model%mesh%ndim
    do f = 1, size(model%fields)
      associate (field => model%fields(f))
        field%node = 0.0_dp
        if (rigid_field(model%bodies, f) > 0) cycle
        call field_node_planes(field, model%ranks%partition, p1, p2)
        if (p2 < p1) cycle
        do s = field%plane_work(p1), field%plane_work(p2 + 1) - 1
          do i = field%work%first(s), field%work%last(s)
            do d = 1, n
              hash = i*73856093_i8 + key_j(field%work%key(s))*19349663_i8 + &
                     key_k(field%work%key(s))*83492791_i8 + d*29986577_i8
              field%node(field%neighbour(0, 0, s) + i, d) = &
                real(modulo(ieor(hash, ishft(abs(hash), -7))*2654435_i8, 65536_i8), dp)/32768.0_dp &
                - 1.0_dp
            end do
          end do
        end do
      end associate
    end do
  end subroutine start

  !> Velocity in the nodes -> acceleration -M^-1 K w by the particles' stress.
  subroutine accelerate(model)
    type(model_t), intent(inout) :: model
    type(plan_t) :: plan
    type(method_t) :: still                      !! no gravity, no features: stresses alone
    real(dp), allocatable :: sums(:, :)
    integer :: f
    still%cutoff = model%method%cutoff
    still%work_lag = 0.0_dp
    plan%probe = .true.
    plan%stress = .true.
    plan%gradient = node_acceleration
    allocate (plan%vectors(0))
    call probe(model, plan)
    call phase_normalise(model%method, model%mesh, model%fields, model%team, model%ranks%partition)
    do f = 1, size(model%fields)
      if (rigid_field(model%bodies, f) > 0) cycle
      allocate (sums(nodes_sums, model%fields(f)%planes), source=0.0_dp)  ! ledger: unused
      call field_solve(model%fields(f), model%mesh, still, 0.0_dp, .false., model%team, &
                       model%ranks%partition, sums)
      deallocate (sums)
    end do
  end subroutine accelerate

  !> A nodal vector to the particles and back, M^-1 S M^-1 M a.
  subroutine smooth(model)
    type(model_t), intent(inout) :: model
    type(plan_t) :: plan
    type(method_t) :: still
    integer :: f
    plan%probe = .true.
    plan%momentum = .true.
    plan%vectors = [node_acceleration]
    call probe(model, plan)
    do f = 1, size(model%fields)
      if (rigid_field(model%bodies, f) > 0) cycle
      call field_remap(model%fields(f), model%mesh, still, model%team, model%ranks%partition)
    end do
  end subroutine smooth

  !> The particles read the vector in the place of the acceleration and answer.
  subroutine probe(model, plan)
    type(model_t), intent(inout) :: model
    type(plan_t), intent(in) :: plan
    type(plan_t) :: own
    own = plan
    own%step = model%clock%step
    if (plan%stress) then
      call phase_place(own%step, model%method, model%mesh, model%fields, model%bodies, &
                       [node_acceleration], 0.0_dp, model%team, model%ranks, model%findings, &
                       model%timers)
    end if
    call phase_mirror(model%mesh, model%fields, model%bodies, [node_acceleration], [wall_kick], &
                      model%team%threads)
    if (plan%stress) then
      call phase_surfaces_strain(own%step, model%method, model%mesh, model%fields, model%bodies, &
                                 plan%gradient, model%team, model%ranks, model%findings, &
                                 model%timers)
    end if
    call phase_sweep(own, model%mesh, model%fields, model%bodies, model%team, model%ranks, &
                     model%findings, model%timers)
    call phase_rebin_particles(own, model%mesh, model%fields, model%bodies, model%contact, &
                               model%team, model%ranks, model%findings, model%timers)
  end subroutine probe

  !> Sum of m u . v over the nodes, u a vector and v what the nodes hold; about an axis the radial
  !! components have an inertia of their own.
  function mass_product(model, u) result(product)
    type(model_t), intent(in) :: model
    type(vector_t), intent(in) :: u(:)
    real(dp) :: product
    real(dp), allocatable :: terms(:, :)
    real(dp) :: total(1), weight
    integer :: f, p, p1, p2, s, i, n, place
    n = model%mesh%ndim
    product = 0.0_dp
    do f = 1, size(model%fields)
      if (rigid_field(model%bodies, f) > 0) cycle
      associate (field => model%fields(f))
        call halo_own_planes(field, model%ranks%partition, p1, p2)
        allocate (terms(1, p1:max(p2, p1)), source=0.0_dp)
        do p = p1, p2
          do s = field%plane_work(p), field%plane_work(p + 1) - 1
            do i = field%work%first(s), field%work%last(s)
              place = field%neighbour(0, 0, s) + i
              if (.not. field%node(place, node_inverse_mass(n)) > 0.0_dp) cycle
              weight = 0.0_dp  ! that the radial component has beyond the others
              if (field%columns%radial > 0) weight = field%node(place, node_inertia) - 1.0_dp
              terms(1, p) = terms(1, p) + (sum(u(f)%x(place, :)*field%node(place, :n)) + &
                                           weight*u(f)%x(place, 1)*field%node(place, 1))/ &
                            field%node(place, node_inverse_mass(n))
            end do
          end do
        end do
        call parallel_exact_sums(terms, total)
        product = product + total(1)
        deallocate (terms)
      end associate
    end do
  end function mass_product

  !> The vector that the nodes hold.
  subroutine vector_get(model, vector)
    type(model_t), intent(in) :: model
    type(vector_t), allocatable, intent(out) :: vector(:)
    integer :: f
    allocate (vector(size(model%fields)))
    do f = 1, size(vector)
      vector(f)%x = model%fields(f)%node(:, :model%mesh%ndim)
    end do
  end subroutine vector_get

  pure subroutine vector_scale(vector, factor)
    type(vector_t), intent(inout) :: vector(:)
    real(dp), intent(in) :: factor
    integer :: f
    do f = 1, size(vector)
      vector(f)%x = factor*vector(f)%x
    end do
  end subroutine vector_scale

  !> Largest eigenvalue of a symmetric tridiagonal matrix, by bisection on the sign count of its
  !! characteristic polynomials (Sturm).
  pure function largest_eigenvalue(diagonal, beside) result(largest)
    real(dp), intent(in) :: diagonal(:)          !! (n)
    real(dp), intent(in) :: beside(:)            !! (n - 1)
    real(dp) :: largest
    real(dp) :: lower, upper, pivot
    integer :: i, j, n
    n = size(diagonal)
    lower = maxval(diagonal)
    upper = lower + 2.0_dp*sum(abs(beside)) + tiny(1.0_dp)
    do i = 1, 60
      largest = 0.5_dp*(lower + upper)
      pivot = diagonal(1) - largest
      do j = 2, n
        if (pivot >= 0.0_dp) exit
        pivot = diagonal(j) - largest - beside(j - 1)**2/pivot
      end do
      if (pivot >= 0.0_dp) then
        lower = largest
      else
        upper = largest
      end if
    end do
  end function largest_eigenvalue

end module sgmp_stability
