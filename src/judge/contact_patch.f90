!> How wide the patch was in which two elastic bodies have touched, one of them a ball or a disk, by
!! Hertz from the impulse between them (doc/verdict.md).
!!
!! In space a collision at the speed v goes as deep as d = (15 m v^2/(16 E sqrt(R)))^(2/5), and the
!! patch has the radius sqrt(R d); m, R and E are those of both bodies, 1/m = 1/m1 + 1/m2 and so on.
!! In the plane a disk of radius r is pressed for about 3.5 r/c, so that the force comes to 0.24 J
!! c/r, and half the width of the patch is sqrt(4 P R/(pi E)). (Johnson, Contact Mechanics, 1985.)
module sgmp_contact_patch
  use sgmp_constitutive, only: law_bulk
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_kinds, only: dp
  use sgmp_meetings, only: meetings_push
  use sgmp_model, only: model_t
  use sgmp_scene, only: scene_t
  use sgmp_thickness, only: body_width, length_along
  implicit none
  private
  public :: patch_cells

  real(dp), parameter :: pi = acos(-1.0_dp)
  real(dp), parameter :: rebound = 1.9_dp        !! impulse over m v, 1 plus what is restored
  real(dp), parameter :: disk_push = 0.24_dp     !! force over J c/r

contains

  !> Half the width of the patch in cells; huge where no round body touched.
  function patch_cells(scene, model, pair) result(cells)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    type(contact_pair_t), intent(in) :: pair
    real(dp) :: cells
    real(dp) :: yields, curves, lightness      !! inverse of E, R, m of both
    real(dp) :: radius, loud, push, depth
    real(dp) :: along(3)
    integer :: side
    yields = 0.0_dp
    curves = 0.0_dp
    lightness = 0.0_dp
    along = meetings_push(model, pair)
    loud = 0.0_dp
    do side = 1, 2
      associate (b => pair%body(side), body => model%bodies(pair%body(side)))
        if (.not. body%rigid .or. body%rigid_motion%free) then
          lightness = lightness + 1.0_dp/model%totals%bodies(b)%mass
        end if
        if (body%springs .and. .not. body%rigid) then
          associate (e => body%law%elastic)
            yields = yields + (1.0_dp/e%shear + 1.0_dp/(law_bulk(body%law) + e%shear/3.0_dp))/4.0_dp
            loud = max(loud, sqrt(e%shear/e%density))
          end associate
        end if
        if (length_along(scene%bodies(b)%shapes, model%mesh, along) > 0.0_dp) cycle
        radius = 0.5_dp*body_width(scene%bodies(b)%shapes, model%mesh)
        curves = curves + 1.0_dp/radius
      end associate
    end do
    cells = huge(1.0_dp)
    push = norm2(pair%impulse - pair%friction_impulse)
    if (.not. min(yields, curves, lightness, push) > 0.0_dp) return
    if (model%mesh%ndim == 2 .and. .not. scene%axisymmetric) then
      push = disk_push*push*sqrt(2.5_dp)*loud*curves
      cells = sqrt(4.0_dp*push*yields/(pi*curves))/model%mesh%h
    else
      push = push/rebound
      depth = (15.0_dp/16.0_dp*push**2*lightness*yields*sqrt(curves))**0.4_dp
      cells = sqrt(depth/curves)/model%mesh%h
    end if
  end function patch_cells

end module sgmp_contact_patch
