!> A wall of the grid that bodies meet and leave: springs on the particles that reach through it.
module sgmp_one_sided_wall
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: one_sided_wall_t

  !> One such wall, as the particles of one body meet it.
  type :: one_sided_wall_t
    integer :: side = 0, axis = 0      !! lower or upper face of the grid, axis
    integer :: columns(3) = 0          !! of those for such forces, by components; 0: there is none
    real(dp) :: place = 0.0_dp         !! along the axis (cells)
    real(dp) :: stiffness = 0.0_dp     !! pressure per depth to which a face has come
    real(dp) :: hard = 0.0_dp          !! the same up to the depth `bed`
    real(dp) :: bed = 0.0_dp           !! as far as that, 0: nowhere
    real(dp) :: spacing = 0.0_dp       !! of the particles (length)
    real(dp) :: friction = 0.0_dp      !! coefficient; 0: smooth, huge: what is pressed on it stays
    real(dp) :: grip = 0.0_dp          !! shear stress per way along the wall
    logical :: turns = .false.         !! friction acts at the face, and turns what it holds there
    integer :: way = 0                 !! state column of that way, its first component; 0: smooth
    integer :: half = 0                !! that of how much longer the half of a particle is which
                                       !! lies towards it; of a rough one that of the way across
    integer :: rim = 0                 !! that of how much longer it was at the start, on the round
                                       !! side of its body; 0: that is not round there
  end type one_sided_wall_t

end module sgmp_one_sided_wall
