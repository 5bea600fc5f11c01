!> What walls do to matter: the reaction of each, where the deck asks for it (wall … reactions=yes).
!!
!! A wall acts on particles in three ways (sgmp_wall_work): it holds nodes, with F = m (A - a) for a
!! wall that speeds up by A; particles read the image of the acceleration a_i behind it, with
!! F = m_g (a_g - a_i); and the force f_g that they gave to nodes there comes back with the signs of
!! an image, F = -2 f_g where they turn. Friction along it is the fourth. Their sum is what the
!! momentum of the particles gains beside forces of other kinds.
module sgmp_wall_reaction
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_acceleration, node_inertia, node_inverse_mass
  use sgmp_energy_terms, only: energy_term_t, energy_terms_t, from_nodes, terms_add
  use sgmp_field, only: field_t
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t, wall_fixed, wall_kick, wall_slip
  use sgmp_rigid_bodies, only: rigid_field
  use sgmp_rows, only: key_j, key_k
  use sgmp_space, only: axis_names, space_axisymmetric
  use sgmp_sums, only: nodes_sums, sweep_sums, wall_entry
  use sgmp_tally, only: tally_add, tally_t
  use sgmp_wall_work, only: ghost_force, holding_wall
  use sgmp_walls, only: ghost_intervals, ghost_point, ghost_records
  implicit none
  private
  public :: phase_wall_reaction, reaction_account, wall_nodes_weigh, wall_reacts

contains

  !> Whether a face has a wall whose reaction is booked.
  pure logical function wall_reacts(mesh, side, axis) result(yes)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: side, axis
    yes = mesh%walls_weigh .and. (mesh%one_sided(side, axis) .or. &
                                  any(mesh%wall(side, axis) == [wall_slip, wall_fixed]))
  end function wall_reacts

  !> Terms of the balance that hold the impulses of the walls on the matter, and change nothing.
  pure subroutine reaction_account(terms, mesh)
    type(energy_terms_t), intent(inout) :: terms
    type(mesh_t), intent(in) :: mesh
    character(1), parameter :: sides(2) = ['-', '+']
    character(:), allocatable :: face
    integer :: axis, side
    do axis = 1, mesh%ndim
      do side = 1, 2
        if (.not. wall_reacts(mesh, side, axis)) cycle
        face = axis_names(axis, mesh%space)//sides(side)
        call terms_add(terms, energy_term_t(name='walls.impulse_'//face, &
                                            column='wall_'//face//'_impulse', source=from_nodes, &
                                            entry=wall_entry(side, axis), components=3))
      end do
    end do
  end subroutine reaction_account

  !> Books the forces that hold nodes of a tile on walls, which have their accelerations as if there
  !! were no wall.
  pure subroutine wall_nodes_weigh(field, mesh, s, first, n, m, sums)
    type(field_t), intent(in) :: field
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: s, first, n           !! work interval, first node, nodes
    real(dp), intent(in) :: m(n)                 !! mass of the nodes
    real(dp), intent(inout) :: sums(nodes_sums)  !! of the plane, added to
    real(dp) :: mass
    integer :: i, a, side, axis, record, entry, point(3)
    point = [0, key_j(field%work%key(s)), key_k(field%work%key(s))]
    if (field%ndim == 2) point(2) = point(3)
    do i = 1, n
      point(1) = first + i - 1
      record = field%neighbour(0, 0, s) + point(1)
      if (.not. field%node(record, node_inverse_mass(field%ndim)) > 0.0_dp) cycle
      do a = 1, field%ndim
        call holding_wall(mesh, point, a, side, axis)
        if (axis == 0) cycle
        if (.not. wall_reacts(mesh, side, axis)) cycle
        mass = m(i)
        if (a == 1 .and. field%space == space_axisymmetric) then
          mass = mass*field%node(record, node_inertia)
        end if
        entry = wall_entry(side, axis) + a - 1
        sums(entry) = sums(entry) + mass*(mesh%wall_motion(a, side, axis, wall_kick) - &
                                          field%node(record, node_acceleration + a - 1))
      end do
    end do
  end subroutine wall_nodes_weigh

  !> Books what walls do by what particles read and gave behind them, in the planes of this rank;
  !! the nodes there are mirror images already.
  pure subroutine phase_wall_reaction(mesh, fields, bodies, own, tally)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: fields(:)
    type(body_t), intent(in) :: bodies(:)
    integer, intent(in) :: own(2)                !! planes of this rank
    type(tally_t), intent(inout) :: tally
    integer :: f, axis, side
    do f = 1, size(fields)
      if (rigid_field(bodies, f) > 0) cycle
      do axis = 1, mesh%ndim
        if (fields(f)%columns%behind(axis) == 0) cycle
        do side = 1, 2
          if (wall_reacts(mesh, side, axis) .and. .not. mesh%one_sided(side, axis)) then
            call book_face(mesh, fields(f), axis, side, own, size(bodies)*sweep_sums, tally)
          end if
        end do
      end do
    end do
  end subroutine phase_wall_reaction

  !> The same of one field and one wall.
  pure subroutine book_face(mesh, field, axis, side, own, before, tally)
    type(mesh_t), intent(in) :: mesh
    type(field_t), intent(in) :: field
    integer, intent(in) :: axis, side, own(2)
    integer, intent(in) :: before                !! entries of the tally before those of nodes
    type(tally_t), intent(inout) :: tally
    real(dp) :: force(3)
    integer :: s, ghost, image, first, last, at_ghost, at_image, n, i
    call ghost_point(mesh, axis, side, kernel_centred(field%kernel), ghost, image)
    call ghost_intervals(field, axis, ghost, 1, field%planes, first, last)
    do s = first, last
      call ghost_records(field, s, axis, ghost, image, at_ghost, at_image, n)
      if (key_k(field%work%key(s)) < own(1) .or. key_k(field%work%key(s)) > own(2)) cycle
      do i = 0, n - 1
        force = ghost_force(mesh, field, axis, side, s, at_ghost + i, image)
        call tally_add(tally, before + wall_entry(side, axis), force(:mesh%ndim))
      end do
    end do
  end subroutine book_face

end module sgmp_wall_reaction
