!> What walls that let go do to matter, where the deck asks for it (wall … reactions=yes).
module sgmp_one_sided_reaction
  use sgmp_body, only: body_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided, only: one_sided_forces
  use sgmp_sums, only: sweep_sums, wall_entry
  use sgmp_tally, only: tally_add, tally_t
  implicit none
  private
  public :: one_sided_weigh

contains

  !> Books the forces on the particles of this rank, where they were when the grid got them.
  pure subroutine one_sided_weigh(mesh, bodies, tally)
    type(mesh_t), intent(in) :: mesh
    type(body_t), intent(in) :: bodies(:)
    type(tally_t), intent(inout) :: tally
    real(dp) :: push(3)
    integer :: b, c, l, w, entry
    do b = 1, size(bodies)
      do w = 1, size(bodies(b)%walls)
        associate (wall => bodies(b)%walls(w), own => bodies(b)%particles)
          entry = size(bodies)*sweep_sums + wall_entry(wall%side, wall%axis)
          do c = 1, own%chunks
            do l = 1, lanes
              if (own%id(l, c) == 0) cycle
              push = one_sided_forces(mesh, wall, own%motion(l, wall%axis, c), own%state(l, :, c))
              call tally_add(tally, entry, push(:mesh%ndim))
            end do
          end do
        end associate
      end do
    end do
  end subroutine one_sided_weigh

end module sgmp_one_sided_reaction
