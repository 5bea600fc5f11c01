!> The procedures that pass over the planes of a field, by space: chosen here, once.
module sgmp_passes
  use sgmp_body, only: body_t
  use sgmp_centres_relax_1d, only: centres_relax_1d => centres_relax
  use sgmp_centres_relax_2d, only: centres_relax_2d => centres_relax
  use sgmp_centres_relax_3d, only: centres_relax_3d => centres_relax
  use sgmp_centres_relax_rz, only: centres_relax_rz => centres_relax
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_mesh, only: mesh_t
  use sgmp_method, only: method_t
  use sgmp_movers, only: movers_t
  use sgmp_nodes_1d, only: nodes_remap_1d => nodes_remap, nodes_solve_1d => nodes_solve, &
                           nodes_velocity_1d => nodes_velocity
  use sgmp_nodes_2d, only: nodes_remap_2d => nodes_remap, nodes_solve_2d => nodes_solve, &
                           nodes_velocity_2d => nodes_velocity
  use sgmp_nodes_3d, only: nodes_remap_3d => nodes_remap, nodes_solve_3d => nodes_solve, &
                           nodes_velocity_3d => nodes_velocity
  use sgmp_nodes_normalise_1d, only: nodes_normalise_1d => nodes_normalise
  use sgmp_nodes_normalise_2d, only: nodes_normalise_2d => nodes_normalise
  use sgmp_nodes_normalise_3d, only: nodes_normalise_3d => nodes_normalise
  use sgmp_nodes_normalise_rz, only: nodes_normalise_rz => nodes_normalise
  use sgmp_nodes_rotation_2d, only: nodes_rotation_2d => nodes_rotation
  use sgmp_nodes_rotation_3d, only: nodes_rotation_3d => nodes_rotation
  use sgmp_nodes_rotation_rz, only: nodes_rotation_rz => nodes_rotation
  use sgmp_nodes_rz, only: nodes_remap_rz => nodes_remap, nodes_solve_rz => nodes_solve, &
                           nodes_velocity_rz => nodes_velocity
  use sgmp_plan, only: plan_t, workspace_t
  use sgmp_rebinning, only: arrivals_t
  use sgmp_sums, only: nodes_sums
  use sgmp_surfaces_2d, only: surfaces_pass_2d => surfaces_pass
  use sgmp_surfaces_3d, only: surfaces_pass_3d => surfaces_pass
  use sgmp_surfaces_rz, only: surfaces_pass_rz => surfaces_pass
  use sgmp_sweep_1d, only: sweep_join_1d => sweep_join, sweep_slab_1d => sweep_slab
  use sgmp_sweep_2d, only: sweep_join_2d => sweep_join, sweep_slab_2d => sweep_slab
  use sgmp_sweep_3d, only: sweep_join_3d => sweep_join, sweep_slab_3d => sweep_slab
  use sgmp_sweep_movers_1d, only: sweep_add_movers_1d => sweep_add_movers
  use sgmp_sweep_movers_2d, only: sweep_add_movers_2d => sweep_add_movers
  use sgmp_sweep_movers_3d, only: sweep_add_movers_3d => sweep_add_movers
  use sgmp_sweep_movers_rz, only: sweep_add_movers_rz => sweep_add_movers
  use sgmp_sweep_rz, only: sweep_join_rz => sweep_join, sweep_slab_rz => sweep_slab
  implicit none
  private
  public :: passes_t, passes_of

  abstract interface
    !> See sgmp_sweep: sweeps the particles of some planes.
    subroutine sweep_slab(mesh, field, number, bodies, plan, plane1, plane2, sums, movers, work)
      import :: body_t, dp, field_t, mesh_t, movers_t, plan_t, workspace_t
      implicit none
      type(mesh_t), intent(in) :: mesh
      type(field_t), intent(inout) :: field
      integer, intent(in) :: number
      type(body_t), intent(inout) :: bodies(:)
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: plane1, plane2
      real(dp), intent(inout) :: sums(:, :, :)
      type(movers_t), intent(inout) :: movers(:)
      type(workspace_t), intent(inout) :: work
    end subroutine sweep_slab

    !> See sgmp_sweep: completes the first planes of a slab.
    pure subroutine sweep_join(field, plan, plane1, plane2, own, below)
      import :: field_t, plan_t, workspace_t
      implicit none
      type(field_t), intent(inout) :: field
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: plane1, plane2
      type(workspace_t), intent(in) :: own
      type(workspace_t), intent(in), optional :: below
    end subroutine sweep_join

    !> See sgmp_sweep_movers: adds particles that changed bins to some planes.
    subroutine sweep_add_movers(mesh, field, body, plan, lists, arrivals, planes)
      import :: arrivals_t, body_t, field_t, mesh_t, movers_t, plan_t
      implicit none
      type(mesh_t), intent(in) :: mesh
      type(field_t), intent(inout) :: field
      type(body_t), intent(in) :: body
      type(plan_t), intent(in) :: plan
      type(movers_t), intent(in) :: lists(:)
      type(arrivals_t), intent(in) :: arrivals
      integer, intent(in) :: planes(2)
    end subroutine sweep_add_movers

    !> See sgmp_nodes_normalise: volume-normalised stress of one plane.
    pure subroutine nodes_normalise(field, mesh, plane, interior)
      import :: dp, field_t, mesh_t
      implicit none
      type(field_t), intent(inout) :: field
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: plane
      real(dp), intent(in) :: interior
    end subroutine nodes_normalise

    !> See sgmp_centres_relax: what particles relax to at the centres of one plane.
    pure subroutine centres_relax(field, mesh, plane, method, dt)
      import :: dp, field_t, mesh_t, method_t
      implicit none
      type(field_t), intent(inout) :: field
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: plane
      type(method_t), intent(in) :: method
      real(dp), intent(in) :: dt
    end subroutine centres_relax

    !> See sgmp_nodes: momentum equation of one plane.
    pure subroutine nodes_solve(field, mesh, plane, method, dt, forced, sums)
      import :: dp, field_t, mesh_t, method_t, nodes_sums
      implicit none
      type(field_t), intent(inout) :: field
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: plane
      type(method_t), intent(in) :: method
      real(dp), intent(in) :: dt
      logical, intent(in) :: forced
      real(dp), intent(inout) :: sums(nodes_sums)
    end subroutine nodes_solve

    !> See sgmp_nodes: velocity of one plane from the projected momentum.
    pure subroutine nodes_velocity(field, mesh, plane, cutoff)
      import :: dp, field_t, mesh_t
      implicit none
      type(field_t), intent(inout) :: field
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: plane
      real(dp), intent(in) :: cutoff
    end subroutine nodes_velocity

    !> See sgmp_nodes: re-mapped velocity of one plane.
    pure subroutine nodes_remap(field, mesh, plane, method)
      import :: field_t, mesh_t, method_t
      implicit none
      type(field_t), intent(inout) :: field
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: plane
      type(method_t), intent(in) :: method
    end subroutine nodes_remap

    !> See sgmp_nodes_rotation: one stage of exact rotation of one plane.
    pure subroutine nodes_rotation(field, mesh, plane, stage, number, columns)
      import :: dp, field_t, mesh_t
      implicit none
      type(field_t), intent(inout) :: field
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: plane, stage
      real(dp), intent(in) :: number
      integer, intent(in) :: columns(:)
    end subroutine nodes_rotation

    !> See sgmp_surfaces: one stage of the correction at surfaces of one plane.
    pure subroutine surfaces_pass(field, mesh, plane, stage, column)
      import :: field_t, mesh_t
      implicit none
      type(field_t), intent(inout) :: field
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: plane, stage, column
    end subroutine surfaces_pass
  end interface

  !> The passes of one space.
  type :: passes_t
    procedure(sweep_slab), pointer, nopass :: sweep => null()
    procedure(sweep_join), pointer, nopass :: join => null()
    procedure(sweep_add_movers), pointer, nopass :: add_movers => null()
    procedure(nodes_normalise), pointer, nopass :: normalise => null()
    procedure(centres_relax), pointer, nopass :: relax => null()
    procedure(nodes_solve), pointer, nopass :: solve => null()
    procedure(nodes_velocity), pointer, nopass :: velocity => null()
    procedure(nodes_remap), pointer, nopass :: remap => null()
    procedure(nodes_rotation), pointer, nopass :: rotation => null()  !! none in 1D
    procedure(surfaces_pass), pointer, nopass :: surfaces => null()  !! none in 1D
  end type passes_t

contains

  !> The passes of a space.
  function passes_of(space) result(passes)
    integer, intent(in) :: space
    type(passes_t) :: passes
    select case (space)
    case (1)
      passes = passes_t(sweep_slab_1d, sweep_join_1d, sweep_add_movers_1d, nodes_normalise_1d, &
                        centres_relax_1d, nodes_solve_1d, nodes_velocity_1d, nodes_remap_1d)
    case (2)
      passes = passes_t(sweep_slab_2d, sweep_join_2d, sweep_add_movers_2d, nodes_normalise_2d, &
                        centres_relax_2d, nodes_solve_2d, nodes_velocity_2d, nodes_remap_2d, &
                        nodes_rotation_2d, surfaces_pass_2d)
    case (3)
      passes = passes_t(sweep_slab_3d, sweep_join_3d, sweep_add_movers_3d, nodes_normalise_3d, &
                        centres_relax_3d, nodes_solve_3d, nodes_velocity_3d, nodes_remap_3d, &
                        nodes_rotation_3d, surfaces_pass_3d)
    case default  ! space_axisymmetric
      passes = passes_t(sweep_slab_rz, sweep_join_rz, sweep_add_movers_rz, nodes_normalise_rz, &
                        centres_relax_rz, nodes_solve_rz, nodes_velocity_rz, nodes_remap_rz, &
                        nodes_rotation_rz, surfaces_pass_rz)
    end select
  end function passes_of

end module sgmp_passes
