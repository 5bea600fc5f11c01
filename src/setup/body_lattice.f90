!> The lattice that fills a body, by its card.
module sgmp_body_lattice
  use sgmp_kinds, only: dp
  use sgmp_lattice, only: lattice_cubic, lattice_fits, lattice_gauss, lattice_graded, lattice_t
  use sgmp_lattice_shares, only: lattice_fitting
  use sgmp_scene, only: body_card_t, layout_gauss, layout_graded
  use sgmp_shapes, only: shapes_anchor, shapes_box
  use sgmp_turn, only: infinite_length, turn_box, turn_turns
  implicit none
  private
  public :: body_lattice_lay, body_lattice_of_grid

contains

  !> Lays the lattice around a body of finite size. It is turned with the body, but for the places
  !! that the grid gives.
  pure subroutine body_lattice_lay(body, cell, grid_lower, ndim, lattice, status)
    type(body_card_t), intent(in) :: body
    real(dp), intent(in) :: cell                 !! side of a grid cell (length)
    real(dp), intent(in) :: grid_lower(3)        !! a corner of the grid (length)
    integer, intent(in) :: ndim
    type(lattice_t), intent(out) :: lattice
    integer, intent(out) :: status               !! lattice_fits, or why not
    real(dp) :: lower(3), upper(3), corner(3)
    call shapes_box(body%shapes, lower, upper)
    if (ndim > 1 .and. body_lattice_of_grid(body)) call turn_box(body%turn, lower, upper)
    if (any(body%axes%graded)) then
      corner = grid_lower
      if (body%layout == layout_graded) corner = shapes_anchor(body%shapes)
      call lattice_graded(lower, upper, corner, body%axes(:ndim), body%cell, body%ppc, &
                          body%layout == layout_gauss, lattice, status)
    else if (body%layout == layout_gauss) then
      call lattice_gauss(lower, upper, grid_lower, cell, body%ppc, ndim, lattice, status)
    else
      corner = body%lattice_origin
      if (any(corner >= infinite_length)) corner = shapes_anchor(body%shapes)
      call lattice_cubic(lower, upper, corner, body%spacing, body%jitter, ndim, lattice, status)
    end if
    if (status == lattice_fits) lattice%cut = cuts_cubes(body, lattice)
  end subroutine body_lattice_lay

  !> Whether the volumes of particles are to fit the shapes, and these cut cubes of the lattice.
  pure function cuts_cubes(body, lattice) result(yes)
    type(body_card_t), intent(in) :: body
    type(lattice_t), intent(in) :: lattice
    logical :: yes
    yes = body%fitted
    if (body_lattice_of_grid(body) .and. turn_turns(body%turn)) return
    if (yes) yes = .not. lattice_fitting(body%shapes, lattice)
  end function cuts_cubes

  !> Whether particles are where the grid has places for them, however the body is turned.
  elemental function body_lattice_of_grid(body) result(yes)
    type(body_card_t), intent(in) :: body
    logical :: yes
    yes = any(body%layout == [layout_gauss, layout_graded])
  end function body_lattice_of_grid

end module sgmp_body_lattice
