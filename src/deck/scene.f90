!> The validated description of a simulation: what the deck says, and nothing about how it is
!! solved.
!!
!! The deck reader fills a `scene_t`; set-up builds a model from it. All numbers are in the deck's
!! own consistent units. Vectors always have three components; those beyond the dimension are zero.
module sgmp_scene
  use sgmp_air_blast, only: burst_free_air
  use sgmp_axis, only: axis_correction
  use sgmp_constitutive, only: constitutive_t
  use sgmp_contact_pairs, only: normal_separating
  use sgmp_deck_errors, only: position_t
  use sgmp_expression, only: expression_free, expression_t
  use sgmp_features, only: features_t
  use sgmp_graded_axis, only: graded_axis_t
  use sgmp_kernels, only: method_sgmp
  use sgmp_kinds, only: dp
  use sgmp_load, only: load_force
  use sgmp_lost_policy, only: lost_error
  use sgmp_mesh, only: wall_free
  use sgmp_particle_file, only: material_choice_t
  use sgmp_shapes, only: shape_t
  use sgmp_space, only: space_axisymmetric
  use sgmp_spelling, only: string_t
  use sgmp_turn, only: turn_t
  use sgmp_update, only: update_musl
  use sgmp_voigt, only: voigt_names
  implicit none
  private
  public :: alternatives_t, balance_card_t, body_card_t, bodyforce_card_t, checkpoint_card_t, &
            contact_card_t, damping_card_t, detonation_card_t, gauge_card_t, grid_card_t, &
            initial_stress_card_t, load_card_t, material_card_t, method_card_t, motion_card_t, &
            output_card_t, section_card_t, statement_text_t, stop_card_t, &
            time_card_t
  public :: contact_lambda_default
  public :: dump_formats, dump_names, dump_tecplot, dump_vtkhdf, dump_vtu
  public :: scene_at_rest, scene_free, scene_presses, scene_pulls, scene_space, scene_t, &
            scene_turns
  public :: layout_lattice, layout_gauss, layout_graded, layout_file, layout_names
  public :: name_length

  integer, parameter :: name_length = 32

  integer, parameter :: layout_lattice = 1, layout_gauss = 2, layout_graded = 3, &
                        layout_file = 4
  character(7), parameter :: layout_names(3) = [character(7) :: 'uniform', 'gauss', 'graded']
    !! what the card body may ask for
  real(dp), parameter :: contact_lambda_default = -1.0_dp  !! from the particle spacings
  integer, parameter :: dump_vtkhdf = 1, dump_vtu = 2, dump_tecplot = 3, dump_formats = 3
  character(7), parameter :: dump_names(dump_formats) = [character(7) :: 'vtkhdf', 'vtu', 'tecplot']

  !> Background grid: cubic cells of side `cell`; an open face follows the particles.
  type :: grid_card_t
    real(dp) :: cell = 0.0_dp                       !! cell side h (length)
    real(dp) :: lower(3) = 0.0_dp, upper(3) = 0.0_dp  !! box corners (length); unused where open
    real(dp) :: asked(2, 3) = 0.0_dp                !! the same as the deck has them
    logical :: moved(3) = .false.                   !! axes whose ends have moved to the grid
    logical :: shifts = .true.                      !! walls that nothing touches let go, or move
    logical :: shifted(2, 3) = .false.              !! (lower|upper, axis): put a cell outwards
    logical :: one_sided(2, 3) = .false.            !! this one lets go: an open face
    logical :: floor(2, 3) = .false.                !! and bodies stand on it at the start
    real(dp) :: floor_bears(2, 3) = 0.0_dp          !! what it may have to bear at rest (stress)
    real(dp) :: rough(2, 3) = 0.0_dp                !! its friction; huge: nothing slides
    type(position_t) :: position                    !! of the card
    logical :: open(2, 3) = .true.                  !! (lower|upper, axis): no extent given
    type(graded_axis_t) :: axes(3)                  !! whose cells are unequal
    integer :: wall(2, 3) = wall_free
      !! (lower|upper, axis): wall_free, wall_slip, wall_fixed, wall_absorbing
    logical :: springs = .false.              !! absorbing walls bear what a source pushes for ever
    logical :: inertia = .false.              !! the same of liquids alone, though no card says so
    real(dp) :: source(3) = 0.0_dp            !! its place (length)
    real(dp) :: ambient = 0.0_dp              !! pressure at rest that holds everywhere
    character(:), allocatable :: walls_location  !! file:line:column of the card, for messages
    type(expression_t) :: wall_velocity(3, 2, 3)
      !! (component, lower|upper, axis) of fixed walls and of those that drag, functions of t
    logical :: reactions = .false.            !! what walls bear is booked
    integer :: lost = lost_error
      !! what happens to a particle that leaves through a closed free face
  end type grid_card_t

  !> Discretisation and update scheme.
  type :: method_card_t
    integer :: kind = method_sgmp     !! one of method_*
    integer :: update = update_musl   !! one of update_*
    real(dp) :: flip = 1.0_dp         !! 1 pure FLIP (the paper), 0 pure PIC
    real(dp) :: mass_cutoff = 1.0e-12_dp
      !! nodes lighter than this times the largest particle mass are ignored
    logical :: normalised = .false.   !! volume-normalised stress (sgmp only)
    logical :: volumes_kept = .false.  !! particles keep the volume of the space they fill (sgmp)
    logical :: volumes_matched = .false.  !! liquids move as they are strained (sgmp)
    logical :: rotation = .false.     !! rigid rotation strains nothing (sgmp only)
    logical :: surfaces = .false.     !! strains are corrected at surfaces (sgmp only)
    logical :: consistent = .false.   !! solids have a consistent mass (sgmp only)
    !> The program chooses (sgmp_deck).
    logical :: normalised_auto = .false., rotation_auto = .false., surfaces_auto = .false.
    logical :: drift_auto = .false., volumes_auto = .false., consistent_auto = .false.
    logical :: drift_remapped = .false.  !! particles move with the velocity that strains them
    real(dp) :: hoop = axis_correction  !! correction of the hoop strain (axisymmetric)
    logical :: hoop_auto = .true.     !! liquids have that of their lattice
    real(dp) :: interior = 0.25_dp    !! filling beyond which a cell counts as interior
  end type method_card_t

  !> Time integration.
  type :: time_card_t
    real(dp) :: end = 0.0_dp       !! end time
    real(dp) :: cfl = 0.5_dp       !! Courant number of Eq. 69
    logical :: cfl_auto = .false.  !! found by the program instead
    real(dp) :: dt = 0.0_dp        !! fixed step; 0: from the Courant number
    real(dp) :: dt_min = 0.0_dp    !! abort below this; 0: 1e-6 of the first step
    real(dp) :: growth = 1.05_dp   !! largest ratio of successive steps
    integer :: steps = huge(1)     !! stop after so many steps
    character(:), allocatable :: location  !! file:line:column of the card, for messages
  end type time_card_t

  !> A material: its law with its equation of state and viscosity.
  type :: material_card_t
    character(name_length) :: name = ''
    type(constitutive_t) :: law
  end type material_card_t

  !> Stress of a body at the start: component by component, or that of ground at rest.
  type :: initial_stress_card_t
    logical :: given = .false.
    logical :: named = .false.                    !! by a card for this body alone
    logical :: geostatic = .false.                !! the weight of what lies above
    type(expression_t) :: value(size(voigt_names))  !! else: as stored, functions of the place
    type(expression_t) :: surface                 !! height against gravity, a function of the place
    real(dp) :: pressure = 0.0_dp                 !! on the surface (stress)
    logical :: pressure_given = .false.           !! else, of a fluid, its own
    real(dp) :: k0 = -1.0_dp                      !! horizontal over vertical; negative: not given
    character(:), allocatable :: location         !! file:line:column of the card, for messages
  end type initial_stress_card_t

  !> A body: geometry, particle layout, material, initial velocity.
  type :: body_card_t
    character(name_length) :: name = ''
    integer :: material = 0                       !! index into scene%materials
    type(shape_t), allocatable :: shapes(:)       !! combined in order
    integer :: layout = layout_lattice
    logical :: layout_asked = .false.             !! the deck names it, or a spacing
    type(graded_axis_t) :: axes(3)                !! of the grid, for layout_graded
    real(dp) :: cell = 0.0_dp                     !! its smallest side
    real(dp) :: spacing = 0.0_dp                  !! lattice constant (length)
    integer :: ppc = 0
      !! points per cell and axis (gauss layout; lattice if no spacing is given); 0: not said
    real(dp) :: jitter = 0.0_dp                   !! random displacement in spacings, reproducible
    type(turn_t) :: turn                          !! of shapes and lattice
    real(dp) :: lattice_origin(3) = huge(1.0_dp)
      !! a corner of the lattice's cells; huge: derived from the first shape
    character(:), allocatable :: file             !! that particles come from
    type(material_choice_t) :: choice             !! which of them
    type(expression_t) :: velocity(3)             !! initial velocity, functions of x, y, z
    type(expression_t) :: spin                    !! initial angular velocity of rings
    real(dp) :: temperature = -1.0_dp
      !! initial temperature; negative: the material's room temperature
    type(initial_stress_card_t) :: stress         !! initial stress
    character(:), allocatable :: location         !! file:line:column of the card, for messages
    logical :: allow_overlap = .false.            !! may share space with other bodies at t = 0
    logical :: rings = .false.                    !! axisymmetric: particles are rings about r = 0
    logical :: fitted = .false.                   !! volumes of particles add up to that of shapes
    real(dp) :: spin_at_start(3) = 0.0_dp         !! initial angular velocity
    real(dp) :: spin_point(3) = huge(1.0_dp)      !! about this point; huge: the centre of mass
    logical :: rigid = .false.                    !! moves as prescribed, whatever acts on it
    type(expression_t) :: motion(3)               !! its velocity, functions of t
    type(expression_t) :: omega(3)                !! and its angular velocity
    real(dp) :: about(3) = 0.0_dp                 !! the point that has that velocity at the start
    logical :: about_given = .false.              !! else it is the centre of mass
    logical :: free = .false.                     !! rigid, but forces move it
    real(dp) :: mass = 0.0_dp                     !! of a free body; 0: that of its particles
    real(dp) :: removed_at = huge(1.0_dp)         !! from this time on it is no more
    integer :: leader = 0                         !! first body of its group; 0: it is in none
    character(name_length) :: group = ''          !! name of that
  contains
    procedure :: turns => body_turns
  end type body_card_t

  !> Contact of two bodies, of one with all others, or of all; a card that names more bodies comes
  !! first.
  type :: contact_card_t
    integer :: body(2) = 0                        !! 0: any; of a group the first
    real(dp) :: friction = 0.0_dp                 !! Coulomb's coefficient
    real(dp) :: lambda = contact_lambda_default   !! distance of Eq. 86 in cells
    real(dp) :: depth = huge(1.0_dp)              !! distance of nodes from the surface (cells)
    integer :: normal = normal_separating         !! one of normal_*
    logical :: self = .false.                    !! its bodies touch themselves, too
    logical :: unasked = .false.                 !! the deck has no such card
  end type contact_card_t

  !> Body force per unit mass on one body or all, functions of x,y,z (current), x0,y0,z0 (initial),
  !! t.
  type :: bodyforce_card_t
    integer :: body = 0                           !! 0: all bodies
    type(expression_t) :: force(3)
    character(:), allocatable :: location         !! file:line:column of the card, for messages
  end type bodyforce_card_t

  !> Force on particles of a body, or pressure or traction on faces of them.
  type :: load_card_t
    integer :: body = 0
    integer :: kind = load_force                  !! one of load_*
    type(expression_t) :: value(3)                !! force, traction; pressure: the first
    real(dp) :: charge = 0.0_dp                   !! mass of TNT of an air blast
    integer :: burst = burst_free_air             !! one of burst_*
    real(dp) :: point(3) = 0.0_dp                 !! where the charge is
    real(dp) :: time = 0.0_dp                     !! when it is lit
    type(expression_t) :: where                   !! not 0 where the load acts, a function of place
    integer :: axis = 0, side = 0                 !! of the faces: lower 1, upper 2; 0: all
    character(:), allocatable :: location         !! file:line:column of the card, for messages
  end type load_card_t

  !> Prescribed motion of a part of a body.
  type :: motion_card_t
    integer :: body = 0
    type(expression_t) :: where                   !! not 0 at its particles, a function of place
    logical :: axes(3) = .false.                  !! components that are prescribed
    type(expression_t) :: velocity(3), omega(3)   !! functions of t
    logical :: turns = .false.                    !! an angular velocity is given
    real(dp) :: about(3) = 0.0_dp                 !! the point that has the velocity at the start
    logical :: about_axis = .false.               !! the third axis is around that of the scene
    logical :: about_given = .false.              !! else it is the centre of mass of the part
    real(dp) :: until = huge(1.0_dp)              !! time from which on it is free
    character(:), allocatable :: location         !! file:line:column of the card, for messages
  end type motion_card_t

  !> A point from which explosives are lit.
  type :: detonation_card_t
    real(dp) :: point(3) = 0.0_dp
    real(dp) :: time = 0.0_dp
    logical :: plane = .false.                    !! plane wave: distance measured along `normal`
    real(dp) :: normal(3) = [1.0_dp, 0.0_dp, 0.0_dp]
  end type detonation_card_t

  !> A card as the complete resolved deck has it, and where it stands.
  type :: statement_text_t
    character(:), allocatable :: text
    character(:), allocatable :: location         !! file:line:column
  end type statement_text_t

  !> What is written when.
  type :: output_card_t
    logical :: writes(dump_formats) = .false.     !! by dump_vtkhdf, dump_vtu, dump_tecplot
    real(dp) :: every(dump_formats) = 0.0_dp      !! interval in time; 0: start and end only
    logical :: csv_end = .false.
    character(name_length), allocatable :: fields(:)  !! fields besides id, body, position, velocity
    integer :: history_steps = 1                  !! history and bodies rows every so many steps
    real(dp) :: history_every = 0.0_dp            !! or every so much time (0: by steps)
  end type output_card_t

  !> When the cuts between ranks are moved.
  type :: balance_card_t
    integer :: every = 16              !! steps between looks; 0: never
    real(dp) :: gain = 0.05_dp         !! part by which the largest load must shrink
  end type balance_card_t

  !> When checkpoints are written.
  type :: checkpoint_card_t
    integer :: every = 0                          !! steps; 0: not by steps
    real(dp) :: minutes = 0.0_dp                  !! of wall time; 0: not by time
    integer :: keep = 2
  end type checkpoint_card_t

  !> A history of fields at the particle nearest to a point at t = 0, or of means around it.
  type :: gauge_card_t
    character(name_length) :: name = ''
    real(dp) :: point(3) = 0.0_dp
    real(dp) :: radius = 0.0_dp  !! of the ball that means are over; 0: the nearest particle alone
    logical :: fixed = .false.   !! the ball stays where it is, its particles change
    character(name_length), allocatable :: fields(:)  !! besides those of every gauge
  end type gauge_card_t

  !> A plane through which forces are measured.
  type :: section_card_t
    character(name_length) :: name = ''
    real(dp) :: point(3) = 0.0_dp, normal(3) = 0.0_dp
    real(dp) :: width = 0.0_dp   !! of the layer of particles on either side (length)
    integer :: body = 0          !! that is cut; 0: all
  end type section_card_t

  !> What slows all bodies down.
  type :: damping_card_t
    real(dp) :: rate = 0.0_dp                     !! of the velocities' decay
    logical :: kinetic = .false.                  !! all stop when the kinetic energy falls
    real(dp) :: until = huge(1.0_dp)              !! time
  end type damping_card_t

  !> Conditions that end a run early.
  type :: stop_card_t
    real(dp) :: energy_growth = 0.0_dp            !! 0: not given
      !! abort (exit 4) at this many times the energy that the scene was given
    real(dp) :: kinetic_below = 0.0_dp
      !! finish when kinetic energy falls below this fraction of its maximum
    real(dp) :: at_rest = 0.0_dp
      !! finish when kinetic energy is below this fraction of kinetic and internal energy
    real(dp) :: hold = 0.0_dp                     !! for so long
    real(dp) :: after = 0.0_dp                    !! counted from this time on
  end type stop_card_t

  !> What else would go with all that a deck asks for, for advice.
  type :: alternatives_t
    logical :: graded = .false.                   !! unequal cells
    logical :: axisymmetric = .false.
    logical :: dimension(3) = .false.             !! fewer dimensions
  end type alternatives_t

  !> A whole simulation.
  type :: scene_t
    character(:), allocatable :: title
    character(:), allocatable :: file             !! the deck's path as given
    character(:), allocatable :: resolved         !! echo of the complete resolved deck
    type(statement_text_t), allocatable :: fixed(:)  !! of it what a restart may not change
    type(string_t), allocatable :: warnings(:)    !! of the deck, a line each
    character(8) :: units(3) = ''                 !! length, mass, time; empty: not declared
    integer :: dimension = 3                      !! axes of the grid
    logical :: axisymmetric = .false.             !! they are r and z
    logical :: swirl = .false.                    !! there is a velocity around the axis
    type(grid_card_t) :: grid
    type(method_card_t) :: method
    type(features_t) :: features
    type(alternatives_t) :: allows
    type(time_card_t) :: time
    type(material_card_t), allocatable :: materials(:)
    type(body_card_t), allocatable :: bodies(:)
    real(dp) :: gravity(3) = 0.0_dp
    type(bodyforce_card_t), allocatable :: bodyforces(:)
    type(load_card_t), allocatable :: loads(:)
    type(motion_card_t), allocatable :: motions(:)
    type(contact_card_t), allocatable :: contacts(:)
    integer :: many_groups = 0                    !! so many that they do not touch without a card
    type(damping_card_t) :: damping
    type(detonation_card_t), allocatable :: detonations(:)
    type(output_card_t) :: output
    type(gauge_card_t), allocatable :: gauges(:)
    type(section_card_t), allocatable :: sections(:)
    type(stop_card_t) :: stop
    type(checkpoint_card_t) :: checkpoint
    type(balance_card_t) :: balance
    logical :: allow_overlap = .false.            !! bodies may overlap at t = 0
  end type scene_t

contains

  !> Whether the deck moves something, which may press a body on a wall.
  pure logical function scene_presses(scene) result(yes)
    type(scene_t), intent(in) :: scene
    yes = size(scene%motions) > 0 .or. any(scene%bodies%rigid)
  end function scene_presses

  !> Whether a force acts throughout the bodies.
  pure logical function scene_pulls(scene) result(yes)
    type(scene_t), intent(in) :: scene
    yes = any(abs(scene%gravity) > 0.0_dp) .or. size(scene%bodyforces) > 0
  end function scene_pulls

  !> Whether velocities have a component around the axis.
  pure logical function scene_turns(scene) result(yes)
    type(scene_t), intent(in) :: scene
    yes = scene%swirl
  end function scene_turns

  !> Releases the expressions' parsers; plain copies of the scene become unusable.
  subroutine scene_free(scene)
    type(scene_t), intent(inout) :: scene
    integer :: i, k
    if (allocated(scene%bodies)) then
      do i = 1, size(scene%bodies)
        call initial_stress_free(scene%bodies(i)%stress)
      end do
    end if
    do k = 1, 3
      if (allocated(scene%bodies)) then
        do i = 1, size(scene%bodies)
          call expression_free(scene%bodies(i)%velocity(k))
          call expression_free(scene%bodies(i)%motion(k))
          call expression_free(scene%bodies(i)%omega(k))
          call expression_free(scene%bodies(i)%spin)
        end do
      end if
      if (allocated(scene%bodyforces)) then
        do i = 1, size(scene%bodyforces)
          call expression_free(scene%bodyforces(i)%force(k))
        end do
      end if
      if (allocated(scene%loads)) then
        do i = 1, size(scene%loads)
          call expression_free(scene%loads(i)%value(k))
          call expression_free(scene%loads(i)%where)
        end do
      end if
      if (allocated(scene%motions)) then
        do i = 1, size(scene%motions)
          call expression_free(scene%motions(i)%velocity(k))
          call expression_free(scene%motions(i)%omega(k))
          call expression_free(scene%motions(i)%where)
        end do
      end if
    end do
  end subroutine scene_free

  !> Releases the parsers of an initial stress.
  subroutine initial_stress_free(stress)
    type(initial_stress_card_t), intent(inout) :: stress
    integer :: c
    do c = 1, size(stress%value)
      call expression_free(stress%value(c))
    end do
    call expression_free(stress%surface)
  end subroutine initial_stress_free

  !> The space of a scene (sgmp_space).
  pure function scene_space(scene) result(space)
    type(scene_t), intent(in) :: scene
    integer :: space
    space = merge(space_axisymmetric, scene%dimension, scene%axisymmetric)
  end function scene_space

  !> Whether a body is rigid and never moves.
  pure function scene_at_rest(card) result(rests)
    type(body_card_t), intent(in) :: card
    logical :: rests
    rests = .false.
    if (card%rigid .and. .not. card%free) rests = vanish(card%motion) .and. vanish(card%omega)
  end function scene_at_rest

  !> Whether a body has an angular velocity.
  pure function body_turns(self) result(yes)
    class(body_card_t), intent(in) :: self
    logical :: yes
    yes = .not. vanish(self%omega)
  end function body_turns

  !> Whether functions are zero at all times.
  pure function vanish(functions) result(yes)
    type(expression_t), intent(in) :: functions(:)
    logical :: yes
    yes = all(functions%is_constant) .and. all(abs(functions%value) <= 0.0_dp)
  end function vanish

end module sgmp_scene
