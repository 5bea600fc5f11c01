!> New surfaces: particles that were inside a body and no longer are, where the surface has been
!! stretched until its first particles are far apart, or matter has torn.
!!
!! Only where bodies meet, and once in a few steps: which particles lie at the surface when the run
!! starts is known from the bodies' shapes.
module sgmp_surface_exposure
  use sgmp_body, only: body_t
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: kernel_centred, stencil_shift, stencil_width
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_filled, mesh_t, wall_free
  use sgmp_motion, only: motion_mass
  use sgmp_surface_particles, only: surface_covered, surface_t
  implicit none
  private
  public :: exposure_steps, filled_around, surface_expose

  integer, parameter :: exposure_steps = 8      !! steps from look to look
  !> A particle around which a smaller part of the space is filled lies at a surface. With linear
  !! weights to the centres and back a cubic B-spline says how much is: 0.66 a quarter of a cell
  !! below a plane, 0.90 in the layer below (0.81 at an edge, 0.73 at a corner in space).
  real(dp), parameter :: bare = 0.7_dp

contains

  !> Makes surface particles of all that lie bare in the marked bins of this rank.
  !! What other labels of a body that touches itself fill counts, too: a seam is no surface.
  ! allow(S901): one loop over lanes, and what to leave out of it
  pure subroutine surface_expose(surface, b, bodies, fields, mesh)
    type(surface_t), intent(inout) :: surface
    integer, intent(in) :: b               !! the body
    type(body_t), intent(inout) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    type(mesh_t), intent(in) :: mesh
    integer :: of(count(bodies%family == bodies(b)%family .and. bodies(b)%family > 0))
    real(dp) :: filled
    integer :: f
    integer :: n, l, chunk
    if (surface%bins == 0 .or. bodies(b)%rigid) return
    of = pack(bodies%field, bodies%family == bodies(b)%family .and. bodies(b)%family > 0)
    associate (particles => bodies(b)%particles, offset => bodies(b)%law%slots%surface, &
               volume => bodies(b)%law%slots%volume, nd => mesh%ndim)
      do n = surface%own(1), surface%own(2)
        if (.not. surface%marked(n)) cycle
        chunk = particles%first(surface%bin(n))
        do while (chunk > 0)
          do l = 1, lanes
            if (particles%id(l, chunk) == 0) cycle
            if (abs(particles%state(l, offset, chunk) - surface_covered) > 0.0_dp) cycle
            associate (x => particles%motion(l, :nd, chunk), &
                       density => particles%motion(l, motion_mass(nd), chunk)/ &
                       particles%state(l, volume, chunk))
              filled = filled_around(fields(bodies(b)%field), mesh, x, density)
              do f = 1, size(of)
                if (of(f) == bodies(b)%field .or. any(of(:f - 1) == of(f))) cycle
                if (fields(of(f))%points == 0 .or. filled >= bare) cycle
                filled = filled + filled_around(fields(of(f)), mesh, x, density, .true.)
              end do
            end associate
            if (filled >= bare) cycle
            particles%state(l, offset, chunk) = 0.0_dp
            surface%counted = .false.
          end do
          chunk = particles%next(chunk)
        end do
      end do
    end associate
  end subroutine surface_expose

  !> Part of the space around a place that a body fills, if it is as dense there as the particle: by
  !! linear weights of what the particles have given to the points around.
  pure function filled_around(field, mesh, x, density, empty) result(part)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: x(:)           !! (ndim) in cells
    real(dp), intent(in) :: density
    logical, intent(in), optional :: empty  !! what is not stored is empty space
    real(dp) :: part, weight, weights, place(3), half
    integer :: low(3), at(3), number, axis, width, row
    width = stencil_width(field%kernel)
    half = merge(0.5_dp, 0.0_dp, kernel_centred(field%kernel))
    low = 0
    low(:mesh%ndim) = floor(x - stencil_shift(field%kernel))
    part = 0.0_dp
    weights = 0.0_dp
    do number = 0, width**mesh%ndim - 1
      weight = 1.0_dp
      at = 0
      place = 0.0_dp
      do axis = 1, mesh%ndim
        at(axis) = low(axis) + mod(number/width**(axis - 1), width)
        place(axis) = at(axis) + half
        weight = weight*max(0.0_dp, 1.0_dp - abs(x(axis) - place(axis)))
        if (behind_wall(mesh, axis, place(axis))) weight = 0.0_dp
      end do
      if (weight <= 0.0_dp) cycle
      if (mesh%ndim == 2) at(3) = at(2)
      if (mesh%ndim == 2) at(2) = 0
      row = field_base(field, at(2), at(3), at(1))
      if (row == huge(1)) then
        if (present(empty)) weights = weights + weight
        cycle
      end if
      place(1) = max(place(1), 0.25_dp)  ! a node on an axis stands for the half cell beside it
      weights = weights + weight
      part = part + weight*mesh_filled(mesh, place(:mesh%ndim), &
                                       field%moment(row + at(1), field%columns%mass)/density)
    end do
    part = part/max(weights, tiny(1.0_dp))
  end function filled_around

  !> Whether a place lies behind a wall, where nothing is left after folding.
  pure function behind_wall(mesh, axis, place) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: axis
    real(dp), intent(in) :: place
    logical :: yes
    yes = (mesh%wall(1, axis) /= wall_free .and. place < mesh%lower(axis)) .or. &
          (mesh%wall(2, axis) /= wall_free .and. place > mesh%upper(axis))
  end function behind_wall

end module sgmp_surface_exposure
