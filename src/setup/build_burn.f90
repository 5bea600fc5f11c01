!> When explosives are lit: along straight lines from the detonations, and round what is in the way.
module sgmp_build_burn
  use sgmp_body, only: body_t
  use sgmp_burn, only: burn_lighting_time
  use sgmp_constitutive, only: material_explosive
  use sgmp_front_paths, only: front_arrival, front_lattice, front_never, front_place, &
                              front_solve, front_source_t, front_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_places, mesh_t
  use sgmp_scene, only: body_card_t, scene_t
  use sgmp_shapes, only: shape_block, shape_cone, shape_cylinder, shape_ogive, shape_sphere, &
                         shapes_box, shapes_inside
  use sgmp_turn, only: turn_back, turn_box
  implicit none
  private
  public :: burn_light

  integer, parameter :: most_points = 400000   !! of the lattice
  real(dp), parameter :: too_far = 1.0e15_dp   !! extents of a box that has no end

  !> Sources, and where straight lines may not do, the paths of the fronts.
  type :: burn_paths_t
    type(front_source_t), allocatable :: sources(:)
    logical :: winding = .false.               !! paths may have turns
    type(front_t) :: front
  end type burn_paths_t

contains

  !> Gives the particles of explosives the times at which they are lit.
  subroutine burn_light(scene, mesh, bodies)
    type(scene_t), intent(in) :: scene
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(inout) :: bodies(:)
    type(burn_paths_t) :: paths
    real(dp) :: place(3)
    integer :: b, c, l
    if (.not. any(bodies%law%slots%lighting > 0)) return
    call burn_paths_make(scene, minval(bodies%spacing, mask=bodies%law%slots%lighting > 0), paths)
    place = 0.0_dp
    do b = 1, size(bodies)
      associate (particles => bodies(b)%particles, column => bodies(b)%law%slots%lighting)
        if (column == 0 .or. bodies(b)%lit) cycle
        do c = 1, particles%chunks
          do l = 1, lanes
            if (particles%id(l, c) == 0) cycle
            place(:mesh%ndim) = mesh_places(mesh, particles%motion(l, :mesh%ndim, c))
            particles%state(l, column, c) = &
              burn_paths_time(paths, place, bodies(b)%law%detonation_speed)
          end do
        end do
      end associate
    end do
  end subroutine burn_light

  !> Finds the paths of a scene's detonations through its explosives. The lattice has the spacing of
  !! the particles, or more, so that it has not too many points.
  subroutine burn_paths_make(scene, spacing, paths)
    type(scene_t), intent(in) :: scene
    real(dp), intent(in) :: spacing            !! of the particles of explosives (length)
    type(burn_paths_t), intent(out) :: paths
    real(dp) :: lower(3), upper(3), step
    integer :: d, n
    allocate (paths%sources(size(scene%detonations)))
    do d = 1, size(paths%sources)
      associate (card => scene%detonations(d))
        paths%sources(d) = front_source_t(point=card%point, time=card%time, plane=card%plane, &
                                          normal=card%normal)
      end associate
    end do
    if (size(paths%sources) == 0 .or. is_convex(scene)) return
    call box_of(scene, lower, upper)
    n = scene%dimension
    if (any(abs(lower(:n)) > too_far .or. abs(upper(:n)) > too_far)) return
    step = max(spacing, (product(upper(:n) - lower(:n))/most_points)**(1.0_dp/n))
    call front_lattice(lower, upper, n, step, paths%front)
    call fill_region(scene, paths%front)
    paths%front%sources = paths%sources
    call front_solve(paths%front)
    paths%winding = .true.
  end subroutine burn_paths_make

  !> When a place of a body is lit: what no path reaches is lit along the straight line.
  pure function burn_paths_time(paths, place, speed) result(time)
    type(burn_paths_t), intent(in) :: paths
    real(dp), intent(in) :: place(3)
    real(dp), intent(in) :: speed              !! of detonation
    real(dp) :: time
    time = front_never
    if (paths%winding) time = front_arrival(paths%front, place, speed)
    if (time >= front_never) time = burn_lighting_time(paths%sources, place, speed)
  end function burn_paths_time

  !> Whether straight lines do: all explosive is one convex shape, or some of it has no known shape.
  pure function is_convex(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b, found
    found = 0
    yes = .true.
    do b = 1, size(scene%bodies)
      if (.not. is_explosive(scene, scene%bodies(b))) cycle
      found = found + 1
      yes = yes .and. size(scene%bodies(b)%shapes) == 1
      if (size(scene%bodies(b)%shapes) == 0) return
      yes = yes .and. any(scene%bodies(b)%shapes(1)%kind == &
                          [shape_block, shape_cylinder, shape_sphere, shape_cone, shape_ogive])
    end do
    yes = yes .and. found <= 1
    do b = 1, size(scene%bodies)
      if (.not. is_explosive(scene, scene%bodies(b))) cycle
      yes = yes .or. allocated(scene%bodies(b)%file)
    end do
  end function is_convex

  pure function is_explosive(scene, body) result(yes)
    type(scene_t), intent(in) :: scene
    type(body_card_t), intent(in) :: body
    logical :: yes
    yes = .false.
    if (body%material > 0) yes = scene%materials(body%material)%law%kind == material_explosive
  end function is_explosive

  !> Box around all explosives.
  pure subroutine box_of(scene, lower, upper)
    type(scene_t), intent(in) :: scene
    real(dp), intent(out) :: lower(3), upper(3)
    real(dp) :: low(3), high(3)
    integer :: b
    lower = huge(1.0_dp)
    upper = -huge(1.0_dp)
    do b = 1, size(scene%bodies)
      if (.not. is_explosive(scene, scene%bodies(b))) cycle
      call shapes_box(scene%bodies(b)%shapes, low, high)
      if (scene%dimension > 1) call turn_box(scene%bodies(b)%turn, low, high)
      lower = min(lower, low)
      upper = max(upper, high)
    end do
    if (scene%axisymmetric) lower(1) = max(lower(1), 0.0_dp)
  end subroutine box_of

  !> Detonation speeds at the points of the lattice.
  pure subroutine fill_region(scene, front)
    type(scene_t), intent(in) :: scene
    type(front_t), intent(inout) :: front
    real(dp) :: place(3)
    integer :: b, p
    do b = 1, size(scene%bodies)
      associate (body => scene%bodies(b))
        if (.not. is_explosive(scene, body)) cycle
        do p = 1, size(front%speed)
          place = front_place(front, p)
          call turn_back(body%turn, place)
          if (shapes_inside(body%shapes, place, scene%dimension, 0.0_dp)) then
            front%speed(p) = scene%materials(body%material)%law%detonation_speed
          end if
        end do
      end associate
    end do
  end subroutine fill_region

end module sgmp_build_burn
