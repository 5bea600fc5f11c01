!> What a sweep over the particles does, and the buffers a thread needs for it.
module sgmp_plan
  use sgmp_constitutive, only: constitutive_t
  use sgmp_features, only: features_t
  use sgmp_kinds, only: dp, i4
  use sgmp_particle_faults, only: fault_none
  implicit none
  private
  public :: plan_t, workspace_t

  !> One sweep: gather, advance, scatter.
  type :: plan_t
    logical :: relax = .false.             !! particles relax to the centres (doc/volumes.md)
    logical :: swirl = .false.             !! with the velocity around the axis
    logical :: probe = .false.  !! nothing advances: particles answer with the stress or momentum of
                                !! what they read, per wave modulus and mass (sgmp_stability)
    logical :: loose = .false.   !! nothing advances: particles give what debris will collide by
    logical :: average = .false.           !! plastic strain is averaged over a length
    logical :: collide = .false.           !! with the kick, debris collides
    logical :: by_halves = .false.         !! strains are those of the velocity that particles have
                                           !! after the kick: the work of stresses goes by halves
    logical :: kick = .false.              !! v += a dt_kick
    logical :: drift = .false.             !! x += v_grid dt
    logical :: strain = .false.            !! stress update over dt
    logical :: mass = .false., momentum = .false., stress = .false.  !! what is scattered
    integer :: first_column = 1, last_column = 0  !! columns of the field's moments that the scatter
                                                 !! fills
    logical :: corrected = .false.         !! strains are, at surfaces
    integer :: faces = 0                   !! of these, those before the external force on faces; 0:
                                           !! there is none
    integer, allocatable :: vectors(:)     !! node columns gathered: acceleration and velocity as
                                           !! the sweep needs them
    integer :: gradient = 0  !! node column of the vector whose gradient strains the particles
    real(dp) :: dt_kick = 0.0_dp           !! velocity step
    real(dp) :: dt = 0.0_dp                !! position step
    real(dp) :: dt_strain = 0.0_dp         !! strain step
    logical :: behind = .false.            !! particles are where they are at its end, not its start
    real(dp) :: time = 0.0_dp              !! at the end of the sweep
    real(dp) :: began = 0.0_dp             !! time at which the step began
    real(dp) :: dt_work = 0.0_dp           !! velocity step, for the work of loads
    integer :: step = 0                    !! number of the step; 0: the first projection
    real(dp) :: work_lag = 0.5_dp          !! of their way, see method_t
    integer :: lost_policy = 1             !! one of lost_*: what those do that leave the grid
    logical :: loses = .false.           !! particles may leave the grid and be removed
    real(dp) :: flip = 1.0_dp              !! weight of FLIP against PIC
    type(features_t) :: features           !! that have a place of their own
  end type plan_t

  !> Buffers and findings of one slab of planes.
  type :: workspace_t
    real(dp), allocatable :: records(:)          !! (components, points of a plane, stencil width)
                                                 !! what particles read
    integer, allocatable :: record_plane(:)      !! plane held by each slot of `records`
    real(dp), allocatable :: planes(:, :, :, :)  !! (layers, columns, points, slots), in 1D (points,
                                                 !! columns, 1, 1): sums before the planes are
                                                 !! joined
    real(dp), allocatable :: lead(:, :, :)       !! GIMP: the first plane's sums, kept for the joint
                                                 !! with the slab below
    real(dp), allocatable :: stencil(:)  !! accumulators of a bin; every row leaves them empty
    real(dp), allocatable :: drives(:, :, :)  !! (drive_sums, drives, planes) of driven particles
    type(constitutive_t) :: law          !! of the body that is swept, with the sides of a chunk's
                                         !! cells; where cells are unequal and it is viscous
    integer :: plane = 0                         !! that is being swept
    integer :: cleared = 1                       !! next stored interval to zero in `planes`
    integer :: filled = 0                        !! points of a plane's row that have sums
    real(dp) :: fastest = 0.0_dp                 !! largest c + |v|
    integer(i4) :: fastest_id = 0                !! its particle
    integer(i4) :: bad_id = 0                    !! first particle whose state makes no sense
    integer :: fault = fault_none                !! of it, one of fault_*
  end type workspace_t

end module sgmp_plan
