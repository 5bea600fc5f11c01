!> sections.csv: one row per plane through which forces are measured, with its name.
!!
!! The force is the integral of the stress over the plane, taken over a layer of particles:
!!   F = sum_p V_p W(d_p) sigma_p n,  W(d) = max(0, 1 - |d|/w)/w,
!! d_p the distance from the plane, w the width of the card. W has the area 1 and, on a lattice
!! whose spacing divides w, the sum 1 over each column of particles: a force that varies linearly
!! along the normal is exact then. With sgmp and w = h this is, at planes of centres, what the grid
!! passes on: the forces of all nodes on one side. Between two of them their forces are
!! interpolated, for stresses of single particles have parts that no node feels. The same with 1 for
!! the stress is the area, with the place its centroid; the moment is about that. What particles
!! carry through the plane as they fly is not counted. Particles are added up in the order of their
!! ids, so that the sums have the same bits on any number of threads and ranks.
module sgmp_section_output
  use sgmp_errors, only: error_t
  use sgmp_graded_axis, only: graded_spacing
  use sgmp_history, only: column_length, history_t
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_find, mesh_t
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_agree, parallel_rank
  use sgmp_scene, only: name_length, section_card_t
  use sgmp_snapshot, only: snapshot_t
  use sgmp_snapshot_make, only: snapshot_gather, snapshot_own
  use sgmp_space, only: axes_in_output, space_axisymmetric
  use sgmp_vectors, only: cross
  implicit none
  private
  public :: section_rows_t, section_rows_open, section_rows_start, section_rows_write

  character(column_length), parameter :: section_columns(*) = [character(column_length) :: &
    'time', 'section', 'area', 'x', 'y', 'z', 'force_x', 'force_y', 'force_z', 'moment_x', &
    'moment_y', 'moment_z', 'particles']
  character(column_length), parameter :: section_integers(2) = [character(column_length) :: &
    'section', 'particles']
  integer, parameter :: stress_field = 1, volume_field = 2
  character(name_length), parameter :: fields(2) = [character(name_length) :: 'stress', 'volume']

  !> A plane: with sgmp, along the grid, the planes of centres on either side, with their shares.
  type :: section_t
    type(section_card_t) :: card             !! vectors along the axes of output, the normal a unit
    real(dp) :: away(2) = 0.0_dp, share(2) = [1.0_dp, 0.0_dp]
  end type section_t

  !> The table and its planes.
  type :: section_rows_t
    type(history_t) :: file
    type(section_t), allocatable :: planes(:)
  end type section_rows_t

contains

  !> The planes. All ranks come here.
  pure subroutine section_rows_start(rows, cards, model)
    type(section_rows_t), intent(inout) :: rows
    type(section_card_t), intent(in) :: cards(:)
    type(model_t), intent(in) :: model
    integer :: c, axes(3)
    axes = axes_in_output(:, model%mesh%space)
    allocate (rows%planes(size(cards)))
    do c = 1, size(cards)
      associate (plane => rows%planes(c))
        plane%card = cards(c)
        plane%card%normal = cards(c)%normal/norm2(cards(c)%normal)
        if (kernel_centred(model%fields(1)%kernel)) call find_centres(plane, model%mesh)
        plane%card%point = plane%card%point(axes)
        plane%card%normal = plane%card%normal(axes)
      end associate
    end do
  end subroutine section_rows_start

  !> The planes of centres beside a plane that lies along the grid, and their shares.
  pure subroutine find_centres(plane, mesh)
    type(section_t), intent(inout) :: plane      !! its vectors along the axes of the grid
    type(mesh_t), intent(in) :: mesh
    real(dp) :: place
    integer :: axis
    axis = maxloc(abs(plane%card%normal), 1)
    if (abs(plane%card%normal(axis)) < 1.0_dp - 1.0e-12_dp) return
    place = mesh_find(mesh, axis, plane%card%point(axis)) - 0.5_dp
    plane%share(2) = place - floor(place)
    plane%share(1) = 1.0_dp - plane%share(2)
    plane%away = mesh%h*graded_spacing(mesh%axes(axis), floor(place) + 1)* &
                 [-plane%share(2), plane%share(1)]*plane%card%normal(axis)
  end subroutine find_centres

  !> Starts the table where the scene has sections, on the first rank.
  subroutine section_rows_open(rows, path, error, keep_to_step)
    type(section_rows_t), intent(inout) :: rows
    character(*), intent(in) :: path
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: keep_to_step  !! of a run that is continued
    if (size(rows%planes) == 0) return
    call rows%file%open(path, section_columns, error, section_integers, keep_to_step, 'name')
  end subroutine section_rows_open

  !> A row for each plane; all ranks must call it.
  subroutine section_rows_write(rows, model, error)
    type(section_rows_t), intent(inout) :: rows
    type(model_t), intent(in) :: model
    type(error_t), allocatable, intent(out) :: error
    type(snapshot_t) :: snapshot
    real(dp), allocatable :: none(:, :)
    real(dp) :: row(size(section_columns) - 2)
    integer :: c
    if (size(rows%planes) == 0) return
    call snapshot_own(model, fields, none, snapshot)
    if (model%ranks%partition%ranks > 1) call snapshot_gather(snapshot, near_any(rows, snapshot))
    do c = 1, merge(size(rows%planes), 0, parallel_rank() == 0)
      call measure(rows%planes(c), snapshot, model%mesh%space, row)
      call rows%file%write_row(model%clock%step, [model%clock%time, real(c, dp), row], error, &
                               trim(rows%planes(c)%card%name))
      if (allocated(error)) exit
    end do
    call parallel_agree(error)
  end subroutine section_rows_write

  !> Which particles count for some plane.
  pure function near_any(rows, snapshot) result(near)
    type(section_rows_t), intent(in) :: rows
    type(snapshot_t), intent(in) :: snapshot
    logical :: near(size(snapshot%id))
    integer :: c, p
    near = .false.
    do c = 1, size(rows%planes)
      do p = 1, size(near)
        near(p) = near(p) .or. weight(rows%planes(c), snapshot, p) > 0.0_dp
      end do
    end do
  end function near_any

  !> Weight of a particle in a plane, per length.
  pure real(dp) function weight(plane, snapshot, p) result(share)
    type(section_t), intent(in) :: plane
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: p
    real(dp) :: away
    share = 0.0_dp
    associate (card => plane%card)
      if (card%body > 0 .and. card%body /= snapshot%body(p)) return
      away = dot_product(snapshot%position(:, p) - card%point, card%normal)
      share = dot_product(plane%share, max(0.0_dp, 1.0_dp - abs(away - plane%away)/card%width))/ &
               card%width
    end associate
  end function weight

  !> Area, centroid, force, moment about the centroid, number of particles.
  pure subroutine measure(plane, snapshot, space, row)
    type(section_t), intent(in) :: plane
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: space
    real(dp), intent(out) :: row(:)
    real(dp) :: area, share, centroid(3), force(3), moment(3), pull(3)
    integer :: p, particles
    area = 0.0_dp
    centroid = 0.0_dp
    force = 0.0_dp
    moment = 0.0_dp
    particles = 0
    do p = 1, size(snapshot%id)
      share = weight(plane, snapshot, p)*snapshot%fields(volume_field)%values(1, p)
      if (.not. share > 0.0_dp) cycle
      pull = share*matmul(tensor(snapshot, p), plane%card%normal)
      particles = particles + 1
      area = area + share
      centroid = centroid + share*snapshot%position(:, p)
      force = force + pull
      moment = moment + cross(snapshot%position(:, p), pull)
    end do
    if (particles > 0) centroid = centroid/area
    moment = moment - cross(centroid, force)
    if (space == space_axisymmetric) then  ! particles are rings: what remains is along the axis
      force(:2) = 0.0_dp
      centroid = [0.0_dp, 0.0_dp, centroid(3)]
      moment = 0.0_dp
    end if
    row = [area, centroid, force, moment, real(particles, dp)]
  end subroutine measure

  !> Stress of a particle, by the names of its components in the output.
  pure function tensor(snapshot, p) result(stress)
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: p
    real(dp) :: stress(3, 3)
    character(1), parameter :: axes(3) = ['x', 'y', 'z']
    integer :: c, i, j
    stress = 0.0_dp
    associate (field => snapshot%fields(stress_field))
      do c = 1, size(field%components)
        i = findloc(axes, field%components(c)(8:8), 1)
        j = findloc(axes, field%components(c)(9:9), 1)
        stress(i, j) = field%values(c, p)
        stress(j, i) = field%values(c, p)
      end do
    end associate
  end function tensor

end module sgmp_section_output
