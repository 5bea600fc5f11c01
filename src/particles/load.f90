!> A load on the particles of a body: a force that is shared out among them by their masses, or a
!! pressure, traction, air blast or an edge that lets waves out on faces of them.
module sgmp_load
  use sgmp_air_blast, only: air_blast_t
  use sgmp_expression, only: expression_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: load_absorbing, load_t, load_blast, load_force, load_pressure, load_traction, &
            load_is_bound

  integer, parameter :: load_force = 1, load_pressure = 2, load_traction = 3, load_blast = 4, &
                        load_absorbing = 5

  !> One load. Its column of the particles' second stream is for a force the particle's share in it
  !! per mass, for all others the first component of the area vector of its faces; behind that of
  !! an edge comes the traction that it bears at rest, and with springs a part of it that fades.
  type :: load_t
    integer :: kind = load_force       !! one of load_*
    integer :: column = 0
    integer :: set = 1                 !! which of the sets of faces of its card
    type(expression_t) :: value(3)     !! components of force or traction; pressure: the first
    type(air_blast_t) :: blast         !! the charge
    integer :: side = 0, axis = 0      !! of an edge: lower or upper face of the grid, axis
    real(dp) :: impedance(2) = 0.0_dp  !! across and along the edge (stress per velocity)
    real(dp) :: springs(2) = 0.0_dp    !! the same (stress); over the distance: stress per length
    real(dp) :: fading = 0.0_dp        !! what springs across the edge push less at first (stress)
    real(dp) :: speed = 0.0_dp         !! by which that fades, over the distance
    real(dp) :: source(3) = 0.0_dp     !! from where that distance counts
  end type load_t

contains

  !> Whether a load refers to the initial position, which must then be stored.
  pure function load_is_bound(load) result(yes)
    type(load_t), intent(in) :: load
    logical :: yes
    yes = any(load%value%uses_initial_position)
  end function load_is_bound

end module sgmp_load
