!> A body: its particles, what they are made of, and the field they move in.
module sgmp_body
  use sgmp_constitutive, only: constitutive_t
  use sgmp_driven_part, only: driven_part_t
  use sgmp_expression, only: expression_t
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: stencil_width
  use sgmp_kinds, only: dp, i4
  use sgmp_load, only: load_t
  use sgmp_one_sided_wall, only: one_sided_wall_t
  use sgmp_particles, only: first_cell, particles_t
  use sgmp_patches, only: labels_t
  use sgmp_rigid_motion, only: rigid_motion_t
  use sgmp_rows, only: key_j, key_k
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: body_t, body_density, body_place, body_forced, body_given_id, body_group, &
            body_number, body_particle, body_parts

  !> One body of the model; behind all of them come twins, which hold the particles of one that
  !! touches itself as they get other labels (sgmp_self_contact).
  type :: body_t
    character(32) :: name = ''
    integer :: field = 1                       !! velocity field it moves in
    integer(i4) :: first_id = 1                !! id of its first particle
    integer :: twin_of = 0                     !! the body that it is a twin of; 0: it is none
    integer :: family = 0                      !! first field of a body that touches itself; 0: not
    integer :: label = 0                       !! of its particles
    type(labels_t) :: labels                   !! of all patches of the family
    logical :: relabels = .false.              !! particles change their labels in this step
    integer(i4), allocatable :: given_ids(:)
      !! ids that a file gives all its particles, on every rank; empty: it gives none
    type(particles_t) :: particles
    type(constitutive_t) :: law
    logical :: springs = .false.               !! springs back (sgmp_springs)
    real(dp) :: half_size(3) = 0.25_dp         !! GIMP particle half-size (cells)
    logical :: sides_stretch = .false.         !! and it follows the particle's stretch (cpGIMP)
    real(dp) :: spacing = 0.0_dp               !! particle spacing (length)
    logical :: stressed = .false.              !! at the start, as its card says
    logical :: lit = .false.                   !! its file says when its particles are lit
    logical :: absorbs = .false.               !! faces lie on edges that let waves out
    logical :: forced = .false.                !! a body force or a load acts
    type(expression_t) :: force(3)             !! force per unit mass
    type(load_t), allocatable :: loads(:)      !! not allocated: none
    type(one_sided_wall_t), allocatable :: walls(:)  !! of the grid that let it go
    logical :: linear = .false.                !! as of its field
    logical :: faced = .false.                 !! some of them act on faces
    logical :: is_driven = .false.             !! the motion of parts of it is prescribed
    logical :: matched = .false.               !! moves as it is strained (sgmp_drift_matched)
    type(driven_part_t), allocatable :: driven(:)  !! these; not allocated: none
    logical :: rigid = .false.                 !! moves as prescribed, or as a whole
    logical :: at_rest = .false.               !! rigid and never moves
    type(expression_t) :: motion(3)            !! velocity of a rigid body, functions of t
    type(rigid_motion_t) :: rigid_motion       !! its rotation, and what moves it where it is free
    real(dp) :: removed_at = huge(1.0_dp)      !! from this time on it is no more
    logical :: leaves = .false.                !! its particles go in this step
    real(dp) :: speed(3) = 0.0_dp              !! of a rigid body, in this step
    real(dp) :: speed_before(3) = 0.0_dp       !! and in the one before
  end type body_t

  integer, parameter :: few_rows = 512       !! that are not worth a meeting of threads

contains

  !> Density of a body as its particles have it at the start: that of its material, but for a free
  !! rigid body whose mass the deck gives.
  pure elemental function body_density(body) result(density)
    type(body_t), intent(in) :: body
    real(dp) :: density
    density = body%law%density*body%rigid_motion%heavier
  end function body_density

  !> Whether any body of a field feels a body force or a load.
  pure function body_forced(bodies, field) result(forced)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: field
    logical :: forced
    integer :: b
    forced = .false.
    do b = 1, size(bodies)
      if (bodies(b)%field == field .and. bodies(b)%forced) forced = .true.
    end do
  end function body_forced

  !> Names of the bodies that share the velocity field of one of them, its own first: a+b+c.
  pure function body_group(bodies, first) result(names)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: first
    character(:), allocatable :: names
    integer :: b
    names = trim(bodies(first)%name)
    do b = 1, size(bodies)
      if (b == first .or. bodies(b)%field /= bodies(first)%field) cycle
      names = names//'+'//trim(bodies(b)%name)
    end do
  end function body_group

  !> How many parts of a body have a prescribed motion.
  pure function body_parts(body) result(parts)
    type(body_t), intent(in) :: body
    integer :: parts
    parts = 0
    if (body%is_driven) parts = size(body%driven)
  end function body_parts

  !> Number of the body that a particle belongs to.
  pure function body_number(bodies, id) result(number)
    type(body_t), intent(in) :: bodies(:)
    integer(i4), intent(in) :: id          !! of the particle
    integer :: number, b
    number = 1
    do b = 2, size(bodies)
      if (bodies(b)%first_id <= id) number = b
    end do
  end function body_number

  !> The id by which the user knows a particle of a body.
  pure integer(i4) function body_given_id(body, id) result(given)
    type(body_t), intent(in) :: body
    integer(i4), intent(in) :: id
    integer :: place
    given = id
    if (.not. allocated(body%given_ids)) return
    place = id - body%first_id + 1
    if (place >= 1 .and. place <= size(body%given_ids)) given = body%given_ids(place)
  end function body_given_id

  !> A particle's name in messages.
  pure function body_particle(bodies, id) result(text)
    type(body_t), intent(in) :: bodies(:)
    integer(i4), intent(in) :: id
    character(:), allocatable :: text
    associate (body => bodies(body_number(bodies, id)))
      text = 'particle '//integer_text(body_given_id(body, id))//' of body '//trim(body%name)
    end associate
  end function body_particle

  !> Finds where the stencils of a body's bins lie in a field that has just been laid out.
  subroutine body_place(body, field)
    type(body_t), intent(inout) :: body
    type(field_t), intent(in) :: field
    integer :: s, p, width, lines, layers
    width = stencil_width(field%kernel)
    lines = merge(width, 1, field%ndim == 3)
    layers = merge(width, 1, field%ndim >= 2)
    associate (particles => body%particles)
      if (allocated(particles%place)) deallocate (particles%place, particles%plane_row)
      allocate (particles%place(lines*layers, particles%bins%n), &
                particles%plane_row(field%planes + 1))
      !$omp parallel do schedule(static) if(particles%bins%n > few_rows) default(none) &
      !$omp& shared(body, field, lines, layers)
      do s = 1, body%particles%bins%n
        call place_row(body, field, s, lines, layers)
      end do
      !$omp end parallel do
      s = 1
      do p = 1, field%planes
        do while (s <= particles%bins%n)
          if (key_k(particles%bins%key(s)) >= field%plane_k(p)) exit
          s = s + 1
        end do
        particles%plane_row(p) = s
      end do
      particles%plane_row(field%planes + 1) = particles%bins%n + 1
    end associate
  end subroutine body_place

  !> The same for one row of bins.
  pure subroutine place_row(body, field, s, lines, layers)
    type(body_t), intent(inout) :: body
    type(field_t), intent(in) :: field
    integer, intent(in) :: s                     !! the row
    integer, intent(in) :: lines, layers         !! rows of points that a stencil has
    integer :: line, layer, first
    associate (particles => body%particles)
      first = first_cell(particles%span, particles%bins%first(s))
      do line = 1, lines
        do layer = 1, layers
          particles%place((line - 1)*layers + layer, s) = &
            field_base(field, key_j(particles%bins%key(s)) + line - 1, &
                       key_k(particles%bins%key(s)) + layer - 1, first)
        end do
      end do
    end associate
  end subroutine place_row

end module sgmp_body
