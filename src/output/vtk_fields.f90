!> Fields of particles as VTK wants them: symmetric tensors with six components, vectors with three.
module sgmp_vtk_fields
  use sgmp_kinds, only: dp
  use sgmp_snapshot, only: snapshot_field_t
  implicit none
  private
  public :: tensor_order, vector_order
  public :: vtk_components, vtk_field_values, vtk_is_tensor, vtk_is_vector, vtk_is_whole

  !> Order of VTK's symmetric tensors.
  character(2), parameter :: tensor_order(*) = ['xx', 'yy', 'zz', 'xy', 'yz', 'xz']
  character(2), parameter :: vector_order(*) = ['_x', '_y', '_z']

contains

  !> Components of a field in the file.
  pure function vtk_components(field) result(n)
    type(snapshot_field_t), intent(in) :: field
    integer :: n
    integer, allocatable :: source(:)
    call field_layout(field, source)
    n = size(source)
  end function vtk_components

  !> The values of a field (components, particles); components absent in this dimension are zero.
  subroutine vtk_field_values(field, values)
    type(snapshot_field_t), intent(in) :: field
    real(dp), allocatable, intent(out) :: values(:, :)
    integer, allocatable :: source(:)
    integer :: i, p
    call field_layout(field, source)
    allocate (values(size(source), size(field%values, 2)))
    !$omp parallel do schedule(static) default(none) shared(field, values, source) private(i)
    do p = 1, size(values, 2)
      do i = 1, size(source)
        values(i, p) = 0.0_dp
        if (source(i) > 0) values(i, p) = field%values(source(i), p)
      end do
    end do
    !$omp end parallel do
  end subroutine vtk_field_values

  !> Whether the file has the field as it is: all its components, in their order.
  pure function vtk_is_whole(field) result(yes)
    type(snapshot_field_t), intent(in) :: field
    logical :: yes
    integer, allocatable :: source(:)
    integer :: i
    call field_layout(field, source)
    yes = size(source) == size(field%values, 1)
    if (yes) yes = all(source == [(i, i=1, size(source))])
  end function vtk_is_whole

  !> For each component in the file, the one of the field it comes from; 0: absent in this
  !! dimension.
  pure subroutine field_layout(field, source)
    type(snapshot_field_t), intent(in) :: field
    integer, allocatable, intent(out) :: source(:)
    character(2) :: suffix
    integer :: i, j
    if (.not. (vtk_is_tensor(field) .or. vtk_is_vector(field))) then
      allocate (source(size(field%components)))
      source(:) = [(i, i=1, size(source))]
      return
    end if
    allocate (source(merge(6, 3, vtk_is_tensor(field))), source=0)
    do i = 1, size(source)
      suffix = vector_order(min(i, 3))
      if (vtk_is_tensor(field)) suffix = tensor_order(i)
      do j = 1, size(field%components)
        if (last_two(field%components(j)) == suffix) source(i) = j
      end do
    end do
  end subroutine field_layout

  !> Whether all components (two at least) end in xx, yy, …
  pure function vtk_is_tensor(field) result(yes)
    type(snapshot_field_t), intent(in) :: field
    logical :: yes
    integer :: i
    yes = size(field%components) > 1 .and. size(field%components) <= 6
    do i = 1, size(field%components)
      yes = yes .and. any(last_two(field%components(i)) == tensor_order)
    end do
  end function vtk_is_tensor

  !> Whether all components (two at least) end in _x, _y, _z.
  pure function vtk_is_vector(field) result(yes)
    type(snapshot_field_t), intent(in) :: field
    logical :: yes
    integer :: i
    yes = size(field%components) > 1 .and. size(field%components) <= 3
    do i = 1, size(field%components)
      yes = yes .and. any(last_two(field%components(i)) == vector_order)
    end do
  end function vtk_is_vector

  pure function last_two(word) result(suffix)
    character(*), intent(in) :: word
    character(2) :: suffix
    integer :: n
    n = len_trim(word)
    suffix = word(max(1, n - 1):n)
  end function last_two

end module sgmp_vtk_fields
