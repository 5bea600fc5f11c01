!> Patches of a body that may touch itself: the cubes of its first positions, which a particle keeps
!! for life, and the label of each, which says in which velocity field its particles move
!! (sgmp_self_contact).
module sgmp_patches
  use sgmp_kinds, only: dp, i8
  implicit none
  private
  public :: labels_t, patch_label, patch_of, patch_place, patches_apart, patch_side

  real(dp), parameter :: patch_side = 8.0_dp    !! cells
  integer(i8), parameter :: most = 2_i8**17     !! patches along an axis
  integer(i8), parameter :: middle = 2_i8**16   !! the number of the one at the grid's origin

  !> Labels of the patches that have another one than 0.
  type :: labels_t
    integer(i8), allocatable :: patch(:)        !! ascending
    integer, allocatable :: label(:)
  end type labels_t

contains

  !> The patch of a first position.
  pure function patch_of(x) result(patch)
    real(dp), intent(in) :: x(:)                !! (ndim) cells
    integer(i8) :: patch
    integer :: d
    patch = 0_i8
    do d = size(x), 1, -1
      patch = patch*most + (middle + floor(x(d)/patch_side, i8))
    end do
  end function patch_of

  !> Coordinates of a patch, in patches; 0 along axes that do not exist.
  pure function patch_place(patch, ndim) result(place)
    integer(i8), intent(in) :: patch
    integer, intent(in) :: ndim
    integer :: place(3)
    integer(i8) :: rest
    integer :: d
    place = 0
    rest = patch
    do d = 1, ndim
      place(d) = int(mod(rest, most) - middle)
      rest = rest/most
    end do
  end function patch_place

  !> Whether two patches are neither one nor neighbours.
  pure function patches_apart(a, b, ndim) result(yes)
    integer(i8), intent(in) :: a, b
    integer, intent(in) :: ndim
    logical :: yes
    yes = maxval(abs(patch_place(a, ndim) - patch_place(b, ndim))) > 1
  end function patches_apart

  !> Label of a patch.
  pure function patch_label(labels, patch) result(label)
    type(labels_t), intent(in) :: labels
    integer(i8), intent(in) :: patch
    integer :: label, low, high, middle_one
    label = 0
    if (.not. allocated(labels%patch)) return
    low = 1
    high = size(labels%patch)
    do while (low <= high)
      middle_one = (low + high)/2
      if (labels%patch(middle_one) == patch) then
        label = labels%label(middle_one)
        return
      end if
      if (labels%patch(middle_one) < patch) then
        low = middle_one + 1
      else
        high = middle_one - 1
      end if
    end do
  end function patch_label

end module sgmp_patches
