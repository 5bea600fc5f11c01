!> One velocity field of the grid: which points are active, where they are stored, and what they
!! carry.
!!
!! Only rows that particles touch are stored. `work` holds the points that are computed, `store` the
!! same widened so that every stencil of a work point falls on stored (if need be empty) points; a
!! point's record is base + i.
module sgmp_field
  use sgmp_axis, only: axis_hoop_weights
  use sgmp_columns, only: averaging_rates, collide_kick, columns_keep_behind, columns_make, &
                          columns_t, relax_total
  use sgmp_drive, only: drive_t
  use sgmp_graded_axis, only: graded_axis_t
  use sgmp_kernels, only: kernel_centred, kernel_folds, kernel_sgmp, stencil_width
  use sgmp_kinds, only: dp, i8
  use sgmp_large_pages, only: large_pages_ask
  use sgmp_mass_points, only: mass_points_make, mass_points_move, mass_points_size, mass_points_t
  use sgmp_mesh, only: mesh_t, wall_free
  use sgmp_pair_points, only: pair_points_clear, pair_points_make, pair_points_move, pair_points_t
  use sgmp_rotation_points, only: rotation_points_clear, rotation_points_make, &
                                  rotation_points_move, rotation_points_t
  use sgmp_rows, only: key_k, row_key, rows_behind, rows_contains, rows_dilate, &
                       rows_locate, rows_t
  use sgmp_space, only: space_axisymmetric
  implicit none
  private
  public :: field_t, field_init, field_build, field_base, field_bytes

  !> Points behind the last that loops over whole vectors may read (sgmp_surfaces).
  integer, parameter :: beyond = 8
  integer, parameter :: few_points = 8192  !! that are not worth a meeting of threads

  !> Layout and grid values of a velocity field.
  type :: field_t
    integer :: kernel = kernel_sgmp                 !! one of kernel_*
    integer :: ndim = 3
    integer :: space = 3                            !! see sgmp_space
    type(columns_t) :: columns                      !! what the columns of `moment` hold
    integer :: points = 0                           !! stored points
    type(rows_t) :: work, store
    integer, allocatable :: base(:)                 !! record of i = 0 in each interval of `store`
    integer, allocatable :: neighbour(:, :, :)  !! (-1:1, -2:1, work%n): base of row j + dj, k + dk
    integer :: planes = 0                           !! stored planes, ascending in k
    integer, allocatable :: plane_k(:)              !! (planes)
    integer, allocatable :: plane_start(:)          !! (planes + 1): first record of each plane
    integer, allocatable :: plane_work(:)  !! (planes + 1): first interval of `work` in each plane
    integer, allocatable :: plane_store(:)  !! (planes + 1): first interval of `store` in each plane
    integer :: largest_plane = 0                    !! records of the largest plane
    real(dp), allocatable :: moment(:, :)           !! (points, columns%total) sums over particles
    type(rotation_points_t) :: rotation             !! for columns%turns
    type(pair_points_t) :: pairs                    !! for columns%corrected
    type(mass_points_t) :: mass                     !! for columns%consistent
    real(dp), allocatable :: node(:, :)             !! (points, columns%nodes) values at the nodes
    logical :: linear = .false.                     !! of unequal cells: across an axis gradients
                                                    !! read what is linear between nodes
    logical :: gaps = .false.                       !! normalised stress leaves gaps alone: solids
    real(dp) :: hoop_correction = 0.0_dp            !! of the hoop strain (sgmp_axis)
    type(graded_axis_t) :: radii                    !! sides of the cells along x
    real(dp), allocatable :: hoop(:, :)  !! (x of a centre; inner, outer) weights of the hoop strain
                                         !! where there is an axis and values are at centres
    real(dp), allocatable :: relax(:, :)  !! (points, relax_total) what particles relax to, at the
                                          !! centres; not allocated: nothing relaxes
    logical :: collides = .false.        !! there is debris in this step
    real(dp), allocatable :: collide(:, :)  !! (points, collide_kick) by how much it collides, for
                                            !! columns%debris > 0
    real(dp), allocatable :: average(:, :)  !! (points, averaging_rates) what plastic strain is
                                            !! averaged by, for columns%average > 0
    type(drive_t), allocatable :: drives(:)  !! prescribed motions; not allocated: none
    integer :: drive_terms = 0           !! entries of a step's sums before those of the drives
    real(dp), allocatable :: drive_sums(:, :, :)  !! (drive_sums, drives, planes) of the step
    real(dp), allocatable :: unfelt(:)  !! (planes) power of forces that particles do not feel
  end type field_t

contains

  !> An empty field.
  pure subroutine field_init(field, mesh, kernel, columns)
    type(field_t), intent(out) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: kernel        !! one of kernel_*
    type(columns_t), intent(in), optional :: columns  !! absent: those that every field has
    field%kernel = kernel
    field%ndim = mesh%ndim
    field%space = mesh%space
    field%hoop_correction = mesh%hoop
    field%radii = mesh%axes(1)
    field%columns = columns_make(mesh%space, kernel)
    if (present(columns)) field%columns = columns
    if (field%columns%driven > 0) allocate (field%drives(field%columns%driven))
    if (mesh%walls_act .and. kernel_folds(kernel)) then
      call columns_keep_behind(field%columns, any(mesh%wall(:, :mesh%ndim) /= wall_free, dim=1))
    end if
    field%points = 0
    allocate (field%moment(0, field%columns%total), field%node(0, field%columns%nodes))
    allocate (field%plane_k(0))
    allocate (field%plane_start(1), source=1)
    allocate (field%plane_work(1), field%plane_store(1), source=1)
  end subroutine field_init

  !> Lays the field out for the cells of some bins; values that are already there move along.
  subroutine field_build(field, cells)
    type(field_t), intent(inout) :: field
    type(rows_t), intent(in) :: cells    !! where particles of the field's bodies may be
    type(field_t) :: new
    type(rows_t) :: stencil
    integer :: reach(3), one(3), w, more
    w = stencil_width(field%kernel)
    one = merge([1, 1, 1], [0, 0, 0], active_axes(field%ndim))
    reach = (w - 1)*one
    new%kernel = field%kernel
    new%ndim = field%ndim
    new%space = field%space
    new%columns = field%columns
    call rows_dilate(cells, [0, 0, 0], reach, stencil)
    if (kernel_centred(field%kernel)) then
      call rows_dilate(stencil, [0, 0, 0], one, new%work)
      call rows_dilate(new%work, -one, one, new%store)
    else
      new%work = stencil
      call rows_dilate(new%work, [0, 0, -reach(3)], [0, 0, 0], new%store)
    end if
    call field_number(new)
    call field_link(new)
    call weigh_hoops(new, field%radii, field%hoop_correction)
    more = merge(beyond, 0, new%columns%pairs > 0)
    allocate (new%moment(new%points + more, new%columns%total))
    allocate (new%node(new%points + more, new%columns%nodes))
    new%moment(new%points + 1:, :) = 0.0_dp
    new%node(new%points + 1:, :) = 0.0_dp
    if (new%columns%square > 0) then
      allocate (new%relax(new%points, relax_total(new%ndim)), source=0.0_dp)
    end if
    if (new%columns%debris > 0) then
      allocate (new%collide(new%points, collide_kick(new%ndim)), source=0.0_dp)
    end if
    if (new%columns%average > 0) then
      allocate (new%average(new%points, averaging_rates), source=0.0_dp)
    end if
    call large_pages_ask(new%moment, size(new%moment, kind=i8))
    call large_pages_ask(new%node, size(new%node, kind=i8))
    if (new%columns%turns) then
      call rotation_points_make(new%ndim, new%points, more, &
                                new%columns%faces + new%columns%push > 0, &
                                field%rotation%least_offset, new%rotation)
    end if
    if (new%columns%corrected) call pair_points_make(new%space, new%points, more, new%pairs)
    if (new%columns%consistent) call mass_points_make(new%ndim, new%points, new%mass)
    call field_clear(new)
    call field_move(field, new)
    call field_replace(new, field)
  end subroutine field_build

  !> Weights of the hoop strain at the centres around the nodes, which all planes share.
  pure subroutine weigh_hoops(field, radii, correction)
    type(field_t), intent(inout) :: field
    type(graded_axis_t), intent(in) :: radii
    real(dp), intent(in) :: correction
    integer :: first, last
    if (field%space /= space_axisymmetric .or. .not. kernel_centred(field%kernel)) return
    if (field%work%n == 0) return
    first = minval(field%work%first(:field%work%n)) - 1
    last = maxval(field%work%last(:field%work%n))
    allocate (field%hoop(first:last, 2))
    call axis_hoop_weights(radii, correction, first, last - first + 1, field%hoop(:, 1), &
                           field%hoop(:, 2))
  end subroutine weigh_hoops

  !> Zeroes all values, every thread those of some planes, so that their memory lies near it.
  subroutine field_clear(field)
    type(field_t), intent(inout) :: field
    integer :: p, first, last
    !$omp parallel do schedule(static) if(field%points > few_points) default(none) shared(field) &
    !$omp& private(p, first, last)
    do p = 1, field%planes
      first = field%plane_start(p)
      last = field%plane_start(p + 1) - 1
      field%moment(first:last, :) = 0.0_dp
      field%node(first:last, :) = 0.0_dp
      if (field%columns%turns) call rotation_points_clear(first, last, field%rotation)
      if (field%columns%corrected) call pair_points_clear(first, last, field%pairs)
    end do
    !$omp end parallel do
  end subroutine field_clear

  !> Axes (i, j, k) that exist: in 2D the y axis is the k axis.
  pure function active_axes(ndim) result(active)
    integer, intent(in) :: ndim
    logical :: active(3)
    active = [.true., ndim == 3, ndim >= 2]
  end function active_axes

  !> Record of i = 0 in the stored interval that holds point i of row (j, k); `huge` if the point is
  !! not stored.
  pure function field_base(field, j, k, i) result(base)
    type(field_t), intent(in) :: field
    integer, intent(in) :: j, k, i
    integer :: base, s
    s = rows_contains(field%store, row_key(j, k), i)
    base = huge(1)
    if (s > 0) base = field%base(s)
  end function field_base

  !> Bytes held by a field.
  pure function field_bytes(field) result(bytes)
    type(field_t), intent(in) :: field
    integer(i8) :: bytes
    bytes = 8_i8*(size(field%moment, kind=i8) + size(field%node, kind=i8)) + &
            4_i8*size(field%neighbour, kind=i8) + &
            16_i8*(size(field%work%key, kind=i8) + size(field%store%key, kind=i8))
    if (allocated(field%relax)) bytes = bytes + 8_i8*size(field%relax, kind=i8)
    if (allocated(field%collide)) bytes = bytes + 8_i8*size(field%collide, kind=i8)
    if (allocated(field%average)) bytes = bytes + 8_i8*size(field%average, kind=i8)
    if (field%columns%corrected) then
      bytes = bytes + 8_i8*(size(field%pairs%weight, kind=i8) + &
                            size(field%pairs%centre, kind=i8) + size(field%pairs%gain, kind=i8))
    end if
    if (field%columns%consistent) bytes = bytes + 8_i8*mass_points_size(field%mass)
  end function field_bytes

  !> Numbers the stored points, plane by plane.
  pure subroutine field_number(field)
    type(field_t), intent(inout) :: field
    integer :: s, k, p, next
    allocate (field%base(field%store%n), field%plane_k(field%store%n), &
              field%plane_start(field%store%n + 1))
    allocate (field%plane_store(field%store%n + 1))
    next = 1
    p = 0
    do s = 1, field%store%n
      k = key_k(field%store%key(s))
      if (p > 0) then
        if (field%plane_k(p) /= k) p = -p
      end if
      if (p <= 0) then
        p = 1 - p
        field%plane_k(p) = k
        field%plane_start(p) = next
        field%plane_store(p) = s
      end if
      field%base(s) = next - field%store%first(s)
      next = next + field%store%last(s) - field%store%first(s) + 1
    end do
    field%plane_start(p + 1) = next
    field%plane_store(p + 1) = field%store%n + 1
    field%planes = p
    field%points = next - 1
    field%plane_k = field%plane_k(:p)
    field%plane_start = field%plane_start(:p + 1)
    field%plane_store = field%plane_store(:p + 1)
    field%largest_plane = 0
    if (p > 0) field%largest_plane = maxval(field%plane_start(2:) - field%plane_start(:p))
  end subroutine field_number

  !> Finds for every work interval the base of its own and its neighbouring rows, and the intervals
  !! of each plane.
  subroutine field_link(field)
    type(field_t), intent(inout) :: field
    integer :: row, s, p
    allocate (field%neighbour(-1:1, -2:1, field%work%n))
    !$omp parallel do schedule(static) if(field%points > few_points) default(none) shared(field)
    do row = 0, 11
      call link_rows(field, mod(row, 3) - 1, row/3 - 2)
    end do
    !$omp end parallel do
    allocate (field%plane_work(field%planes + 1))
    s = 1
    do p = 1, field%planes
      do while (s <= field%work%n)
        if (key_k(field%work%key(s)) >= field%plane_k(p)) exit
        s = s + 1
      end do
      field%plane_work(p) = s
    end do
    field%plane_work(field%planes + 1) = field%work%n + 1
  end subroutine field_link

  !> Finds the bases of the rows that lie by (dj, dk) rows from those of the work intervals.
  pure subroutine link_rows(field, dj, dk)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: dj, dk
    integer, allocatable :: host(:)
    integer :: s
    allocate (host(field%work%n))
    call rows_locate(field%work, row_key(dj, dk), field%store, host)
    do s = 1, field%work%n
      field%neighbour(dj, dk, s) = huge(1)/2
      if (host(s) > 0) field%neighbour(dj, dk, s) = field%base(host(s))
    end do
  end subroutine link_rows

  !> Copies the values of points that stay, every thread those of some planes.
  subroutine field_move(old, new)
    type(field_t), intent(in) :: old
    type(field_t), intent(inout) :: new
    integer :: p
    if (old%work%n == 0) return
    !$omp parallel do schedule(static) if(new%points > few_points) default(none) shared(old, new)
    do p = 1, new%planes
      call move_plane(old, new, new%plane_work(p), new%plane_work(p + 1) - 1)
    end do
    !$omp end parallel do
  end subroutine field_move

  !> Copies the values of points that stay in some intervals.
  pure subroutine move_plane(old, new, first, last)
    type(field_t), intent(in) :: old
    type(field_t), intent(inout) :: new
    integer, intent(in) :: first, last           !! of new%work
    integer :: s, t, a, b, shift
    if (first > last) return
    t = rows_behind(old%work, new%work%key(first))
    do s = first, last
      do while (t <= old%work%n)
        if (old%work%key(t) > new%work%key(s)) exit
        if (old%work%key(t) == new%work%key(s) .and. old%work%last(t) >= new%work%first(s)) exit
        t = t + 1
      end do
      do while (t <= old%work%n)
        if (old%work%key(t) /= new%work%key(s) .or. old%work%first(t) > new%work%last(s)) exit
        a = max(old%work%first(t), new%work%first(s))
        b = min(old%work%last(t), new%work%last(s))
        shift = old%neighbour(0, 0, t)
        new%moment(new%neighbour(0, 0, s) + a:new%neighbour(0, 0, s) + b, :) = &
          old%moment(shift + a:shift + b, :)
        if (old%work%last(t) > new%work%last(s)) exit
        t = t + 1
      end do
    end do
  end subroutine move_plane

  !> Hands the new layout over without copying it.
  pure subroutine field_replace(new, field)
    type(field_t), intent(inout) :: new, field
    field%points = new%points
    field%planes = new%planes
    field%largest_plane = new%largest_plane
    field%work = new%work
    field%store = new%store
    call move_alloc(new%base, field%base)
    call move_alloc(new%neighbour, field%neighbour)
    call move_alloc(new%plane_k, field%plane_k)
    call move_alloc(new%plane_start, field%plane_start)
    call move_alloc(new%plane_work, field%plane_work)
    call move_alloc(new%plane_store, field%plane_store)
    call move_alloc(new%moment, field%moment)
    call move_alloc(new%node, field%node)
    if (allocated(new%relax)) call move_alloc(new%relax, field%relax)
    if (allocated(new%collide)) call move_alloc(new%collide, field%collide)
    if (allocated(new%average)) call move_alloc(new%average, field%average)
    if (allocated(new%hoop)) call move_alloc(new%hoop, field%hoop)
    call rotation_points_move(new%rotation, field%rotation)
    call pair_points_move(new%pairs, field%pairs)
    call mass_points_move(new%mass, field%mass)
  end subroutine field_replace

end module sgmp_field
