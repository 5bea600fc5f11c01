!> Images behind walls: with which sign a number at a point stands for the one at its mirror image.
!!
!! A slip wall and an axis mirror; a fixed wall turns whole vectors round and leaves all else. What
!! particles give (sgmp_columns) and what they get (sgmp_walls) use the same signs.
module sgmp_images
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: wall_axis, wall_fixed, wall_slip
  use sgmp_voigt, only: flux_stress, voigt_axes
  implicit none
  private
  public :: image_t, image_beside, image_product, image_radial, &
            image_shear, image_sign, image_stress, image_vector, vector_parity

  !> Signs of a column: (axis of the wall's normal, kind of wall). 0: the number reaches across the
  !! wall and is its own image.
  type :: image_t
    integer :: sign(3, wall_slip:wall_axis) = 1
  end type image_t

contains

  !> Sign at a wall.
  pure function image_sign(image, normal, wall) result(parity)
    type(image_t), intent(in) :: image
    integer, intent(in) :: normal  !! axis of the wall's normal
    integer, intent(in) :: wall    !! wall_slip, wall_fixed or wall_axis
    real(dp) :: parity
    parity = real(image%sign(normal, wall), dp)
  end function image_sign

  !> Component of a vector: the one across a wall is odd, at a fixed wall all are.
  pure function vector_parity(component, normal, wall) result(parity)
    integer, intent(in) :: component, normal, wall
    real(dp) :: parity
    parity = merge(-1.0_dp, 1.0_dp, component == normal .or. wall == wall_fixed)
  end function vector_parity

  !> The same as an image.
  pure function image_vector(component) result(image)
    integer, intent(in) :: component
    type(image_t) :: image
    integer :: normal, wall
    do wall = wall_slip, wall_axis
      do normal = 1, 3
        image%sign(normal, wall) = nint(vector_parity(component, normal, wall))
      end do
    end do
  end function image_vector

  !> What pulls along r: it is opposite on the other side of the axis.
  pure function image_radial() result(image)
    type(image_t) :: image
    image%sign(:, wall_axis) = -1
  end function image_radial

  !> Component of the stress: shear stresses at a mirror are odd.
  pure function image_stress(flux, space) result(image)
    integer, intent(in) :: flux    !! component, in the order of fluxes
    integer, intent(in) :: space
    type(image_t) :: image
    integer :: axes(2)
    axes = voigt_axes(:, flux_stress(flux, space))
    if (axes(1) == axes(2)) return
    image%sign(axes, :) = -1
    image%sign(:, wall_fixed) = 1
  end function image_stress

  !> Shear stress along a direction that lies in all walls, across an axis.
  pure function image_shear(axis) result(image)
    integer, intent(in) :: axis
    type(image_t) :: image
    image%sign(axis, :) = -1
    image%sign(:, wall_fixed) = 1
  end function image_shear

  !> Component of a vector times levers or derivatives along some axes: at a mirror a factor for
  !! each.
  pure function image_product(component, along) result(image)
    integer, intent(in) :: component  !! 0: no vector
    logical, intent(in) :: along(:)   !! (axes)
    type(image_t) :: image
    integer :: normal
    do normal = 1, size(along)
      if ((component == normal) .neqv. along(normal)) image%sign(normal, :) = -1
    end do
    image%sign(:, wall_fixed) = 1
  end function image_product

  !> What reaches across walls of some axes: it is its own image.
  pure function image_beside(across) result(image)
    logical, intent(in) :: across(3)
    type(image_t) :: image
    integer :: normal
    do normal = 1, 3
      if (across(normal)) image%sign(normal, :) = 0
    end do
  end function image_beside

end module sgmp_images
