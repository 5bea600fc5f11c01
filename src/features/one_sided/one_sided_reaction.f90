!> What walls that let go do to matter, where the deck asks for it (wall … reactions=yes).
module sgmp_one_sided_reaction
  use sgmp_body, only: body_t
  use sgmp_kinds, only: lanes
  use sgmp_mesh, only: mesh_t
  use sgmp_one_sided, only: one_sided_force
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
    integer :: b, c, l, w, entry
    do b = 1, size(bodies)
      do w = 1, size(bodies(b)%walls)
        associate (wall => bodies(b)%walls(w), own => bodies(b)%particles, &
                   volume => bodies(b)%law%slots%volume)
          entry = size(bodies)*sweep_sums + wall_entry(wall%side, wall%axis) + wall%axis - 1
          do c = 1, own%chunks
            do l = 1, lanes
              if (own%id(l, c) == 0) cycle
              call tally_add(tally, entry, [one_sided_force(mesh, wall, &
                                                            own%motion(l, wall%axis, c), &
                                                            own%state(l, volume, c))])
            end do
          end do
        end associate
      end do
    end do
  end subroutine one_sided_weigh

end module sgmp_one_sided_reaction
