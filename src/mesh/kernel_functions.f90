!> The functions by which particles and nodes know each other, along one axis: what the transfers
!! work out for whole chunks, written down point by point.
module sgmp_kernel_functions
  use sgmp_kernels, only: kernel_gimp
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: kernel_function, gimp_function, gimp_slope

contains

  !> Weight of a node for a particle and its derivative with respect to the particle's position
  !! (1/cell); for kernels that join particles and nodes directly.
  elemental subroutine kernel_function(kernel, d, p, s, g)
    integer, intent(in) :: kernel
    real(dp), intent(in) :: d              !! particle minus node (cells)
    real(dp), intent(in) :: p              !! particle half-size (cells), where the kernel knows it
    real(dp), intent(out) :: s, g
    select case (kernel)
    case (kernel_gimp)
      s = gimp_function(d, p)
      g = gimp_slope(d, p)
    case default  ! kernel_mpm
      s = hat_function(d)
      g = hat_slope(d)
    end select
  end subroutine kernel_function

  !> Hat function of a node at distance d (cells).
  elemental function hat_function(d) result(s)
    real(dp), intent(in) :: d
    real(dp) :: s
    s = merge(1.0_dp - abs(d), 0.0_dp, abs(d) < 1.0_dp)
  end function hat_function

  !> Its derivative.
  elemental function hat_slope(d) result(g)
    real(dp), intent(in) :: d
    real(dp) :: g
    g = merge(-sign(1.0_dp, d), 0.0_dp, abs(d) < 1.0_dp)
  end function hat_slope

  !> GIMP function of a node at distance d (cells) from a particle of half-size p (cells), p <= 1/2.
  elemental function gimp_function(d, p) result(s)
    real(dp), intent(in) :: d, p
    real(dp) :: s
    real(dp) :: r
    r = abs(d)
    if (r < p) then
      s = 1.0_dp - (d*d + p*p)/(2.0_dp*p)
    else if (r < 1.0_dp - p) then
      s = hat_function(d)
    else if (r < 1.0_dp + p) then
      s = (1.0_dp + p - r)**2/(4.0_dp*p)
    else
      s = 0.0_dp
    end if
  end function gimp_function

  !> Derivative of the GIMP function with respect to the particle's position (1/cell).
  elemental function gimp_slope(d, p) result(g)
    real(dp), intent(in) :: d, p           !! d = particle minus node
    real(dp) :: g
    real(dp) :: r
    r = abs(d)
    if (r < p) then
      g = -d/p
    else if (r < 1.0_dp - p) then
      g = hat_slope(d)
    else if (r < 1.0_dp + p) then
      g = -sign((1.0_dp + p - r)/(2.0_dp*p), d)
    else
      g = 0.0_dp
    end if
  end function gimp_slope

end module sgmp_kernel_functions
