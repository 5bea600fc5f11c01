!> A wall of the grid that bodies meet and leave: springs on the particles that reach through it.
module sgmp_one_sided_wall
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: one_sided_wall_t

  !> One such wall, as the particles of one body meet it.
  type :: one_sided_wall_t
    integer :: side = 0, axis = 0      !! lower or upper face of the grid, axis
    integer :: column = 0              !! of those for such forces: one for each axis
    real(dp) :: place = 0.0_dp         !! along the axis (cells)
    real(dp) :: stiffness = 0.0_dp     !! pressure per depth to which a face has come
    real(dp) :: spacing = 0.0_dp       !! of the particles (length)
  end type one_sided_wall_t

end module sgmp_one_sided_wall
