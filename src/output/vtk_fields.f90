!> Fields of particles as VTK wants them: symmetric tensors with six components, vectors with three.
module sgmp_vtk_fields
  use sgmp_kinds, only: dp
  use sgmp_snapshot, only: snapshot_field_t
  implicit none
  private
  public :: tensor_order, vector_order
  public :: vtk_components, vtk_field_values, vtk_is_tensor, vtk_is_vector

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
  pure subroutine vtk_field_values(field, values)
    type(snapshot_field_t), intent(in) :: field
    real(dp), allocatable, intent(out) :: values(:, :)
    integer, allocatable :: source(:)
    integer :: i
    call field_layout(field, source)
    allocate (values(size(source), size(field%values, 2)), source=0.0_dp)
    do i = 1, size(source)
      if (source(i) > 0) values(i, :) = field%values(source(i), :)
    end do
  end subroutine vtk_field_values

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
