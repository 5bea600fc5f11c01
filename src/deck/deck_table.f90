!> The table of everything a deck may say: each card and key registered once.
module sgmp_deck_table
  use sgmp_contact_pairs, only: normal_words
  use sgmp_particle_fields, only: particle_field_names
  use sgmp_registry, only: kind_expression, kind_integer, kind_interval, kind_list, kind_logical, &
                           kind_name_word, kind_real, kind_text, kind_vector, kind_word, registry_t
  use sgmp_shapes, only: shape_names
  implicit none
  private
  public :: deck_table, wall_faces

  !> Keys of the card `wall`: axis and side, in the order of `grid_card_t%wall` read by columns.
  character(2), parameter :: wall_faces(*) = ['x-', 'x+', 'y-', 'y+', 'z-', 'z+']
  character(*), parameter :: round_shapes = 'cylinder ring cone ogive'
  character(*), parameter :: plastic = 'j2 johnson_cook'
  character(*), parameter :: jc = 'johnson_cook'

contains

  !> Builds the table.
  function deck_table() result(registry)
    type(registry_t) :: registry
    call register_general(registry)
    call register_grid(registry)
    call register_numerics(registry)
    call register_material(registry)
    call register_equations_of_state(registry)
    call register_bodies(registry)
    call register_contact(registry)
    call register_loads(registry)
    call register_output(registry)
  end function deck_table

  subroutine register_general(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('title', 'What the run is called in its output.', &
                       'title "Taylor bar"', once=.true., free=.true.)
    call registry%key('text', kind_text, 'the title', slot=1, required=.true.)
    call registry%card('units', "Units of the deck's numbers; labels the output and enables "// &
                       'checks of orders of magnitude. The numbers must be consistent: force '// &
                       'in mass*length/time^2, stress in mass/(length*time^2).', 'units mm g ms', &
                       once=.true.)
    call registry%key('length', kind_word, 'unit of length', choices='m mm cm um km', slot=1, &
                      required=.true.)
    call registry%key('mass', kind_word, 'unit of mass', choices='kg g mg t', slot=2, &
                      required=.true.)
    call registry%key('time', kind_word, 'unit of time', choices='s ms us ns', slot=3, &
                      required=.true.)
    call registry%card('dimension', '1: uniaxial strain along x; 2: plane strain, per unit '// &
                       'thickness; 3.', &
                       'dimension 2', once=.true.)
    call registry%key('value', kind_integer, 'number of dimensions', default='3', range='[1,3]', &
                      slot=1)
  end subroutine register_general

  subroutine register_grid(registry)
    type(registry_t), intent(inout) :: registry
    integer :: i
    call registry%card('grid', 'Background grid of cubic cells. Walls lie at the ends given '// &
                       'here; do not extend the box by hand.', 'grid cell=h x=0:1 y=open '// &
                       'z=0:open', &
                       once=.true.)
    call registry%key('cell', kind_real, 'side h of a cell', unit='length', range='(0,inf)', &
                      required=.true.)
    do i = 1, 3
      call registry%key('xyz' (i:i), kind_interval, 'extent; an open end follows the particles', &
                        unit='length', default='open')
    end do
    call registry%card('wall', 'Boundary condition of the faces of the grid. A face with a '// &
                       'wall needs an extent in the card grid.', 'wall x-=fixed y-=slip', &
                       once=.true.)
    do i = 1, size(wall_faces)
      call registry%key(wall_faces(i), kind_word, &
                        'fixed: no velocity; slip: no normal velocity; free: nothing', &
                        choices='free slip fixed', default='free')
    end do
    call registry%card('lost', 'What happens to a particle that leaves through a closed face '// &
                       'without a wall.', 'lost remove', once=.true.)
    call registry%key('policy', kind_word, 'error: stop; remove: count and drop; reflect: turn '// &
                      'back', &
                      choices='error remove reflect', default='error', slot=1)
  end subroutine register_grid

  subroutine register_numerics(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('method', 'Spatial discretisation and order of the update.', &
                       'method sgmp update=musl', once=.true.)
    call registry%key('kind', kind_word, 'discretisation', choices='mpm gimp cpgimp sgmp', &
                      default='sgmp', slot=1, source='sections 2 to 4 of the paper')
    call registry%key('update', kind_word, 'when the stress is updated: first, modified last, '// &
                      'last', &
                      choices='usf musl usl usavg', default='musl', &
                      source="MUSL is the paper's recommendation; usavg: half first, half last")
    call registry%key('flip', kind_real, 'part of the velocity taken from increments; 0 is '// &
                      'pure PIC', &
                      range='[0,1]', default='1')
    call registry%key('mass_cutoff', kind_real, &
                      'nodes lighter than this times the heaviest particle are ignored; '// &
                      'default: 1e-12, for gimp and cpgimp 1e-20 (their weights end as a square)', &
                      range='[0,1)')
    call registry%key('stress', kind_word, 'quadrature of the stress: as in the paper, or '// &
                      'normalised by the volume that particles fill (sgmp only)', &
                      choices='plain normalised', default='plain', &
                      source='doc/normalised-stress.md')
    call registry%key('interior', kind_real, 'a cell is normalised where it and its '// &
                      'neighbours are filled beyond this fraction', range='[0,1)', default='0.25')
    call registry%key('spin', kind_word, 'whether particles carry the rotation of what is '// &
                      'around them to the grid, so that what turns keeps turning (sgmp, musl)', &
                      choices='none carried', default='none', source='doc/spin.md')
    call registry%card('time', 'Time integration; end or steps must be given.', &
                       'time end=80e-3 cfl=0.8', once=.true.)
    call registry%key('end', kind_real, 'end time', unit='time', range='(0,inf)', free=.true.)
    call registry%key('cfl', kind_real, 'Courant number: dt = cfl*h/(c+|v|); auto: the largest '// &
                      'that is safe for the scheme on this scene', range='(0,inf)', &
                      choices='auto', default='0.5', source='Eq. 69; doc/time-step.md', free=.true.)
    call registry%key('dt', kind_real, 'fixed time step instead of the Courant number', &
                      unit='time', &
                      range='(0,inf)')
    call registry%key('dt_min', kind_real, 'the run aborts below this step; default: 1e-6 of '// &
                      'the first', &
                      unit='time', range='(0,inf)')
    call registry%key('growth', kind_real, 'largest ratio of successive steps', range='[1,inf)', &
                      default='1.05')
    call registry%key('steps', kind_integer, 'stop after so many steps', range='[1,inf)', &
                      free=.true.)
    call registry%card('stop', 'Conditions that end a run early.', 'stop kinetic_below=0.01', &
                       once=.true., free=.true.)
    call registry%key('energy_growth', kind_real, &
                      'abort when the total energy exceeds its reference this many times', &
                      range='(1,inf)', default='10')
    call registry%key('kinetic_below', kind_real, &
                      'finish when the kinetic energy falls below this fraction of its maximum', &
                      range='[0,1)', default='0')
  end subroutine register_numerics

  subroutine register_material(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('material', 'A material: name, kind, constants.', &
                       'material steel elastic density=7850 young=210e9 poisson=0.3', &
                       selector='kind')
    call registry%key('name', kind_name_word, 'name used by other cards', slot=1, required=.true.)
    call registry%key('kind', kind_word, 'constitutive model', slot=2, required=.true., &
                      choices='elastic neo_hookean j2 johnson_cook explosive')
    call registry%key('density', kind_real, 'initial density', unit='density', range='(0,inf)', &
                      required=.true.)
    call registry%key('young', kind_real, "Young's modulus", unit='stress', range='(0,inf)', &
                      required=.true., when='elastic neo_hookean '//plastic)
    call registry%key('poisson', kind_real, "Poisson's ratio", range='(-1,0.5)', required=.true., &
                      when='elastic neo_hookean '//plastic)
    call registry%key('strain', kind_word, 'small: the linear theory, with constant volume and '// &
                      'no rotation of the stress', &
                      choices='finite small', default='finite', when='elastic', &
                      source='the class in which the energy identities hold')
    call registry%key('yield', kind_real, 'initial yield stress (Johnson-Cook A)', unit='stress', &
                      range='(0,inf)', required=.true., when=plastic)
    call registry%key('hardening', kind_word, 'hardening law', choices='perfect linear power', &
                      default='perfect', when='j2')
    call registry%key('hardening_modulus', kind_real, &
                      'slope, or factor of the power law (Johnson-Cook B)', unit='stress', &
                      range='[0,inf)', default='0', when=plastic)
    call registry%key('hardening_exponent', kind_real, &
                      'exponent of the power law (Johnson-Cook n)', &
                      range='(0,inf)', default='1', when=plastic)
    call register_johnson_cook(registry)
    call registry%key('detonation_speed', kind_real, 'speed of the programmed burn', unit='speed', &
                      range='(0,inf)', required=.true., when='explosive')
    call registry%key('burn_cells', kind_real, &
                      'cells over which the burn fraction rises; 0: at once', &
                      range='[0,inf)', default='0', when='explosive')
  end subroutine register_material

  subroutine register_johnson_cook(registry)
    type(registry_t), intent(inout) :: registry
    integer :: i
    call registry%key('rate_coefficient', kind_real, 'Johnson-Cook C', range='[0,inf)', &
                      default='0', &
                      when=jc)
    call registry%key('reference_rate', kind_real, 'strain rate at which the rate factor is 1', &
                      unit='1/time', range='(0,inf)', default='1', when=jc)
    call registry%key('thermal', kind_logical, &
                      'carry the temperature and soften the yield stress', &
                      default='no', when=jc)
    call registry%key('thermal_exponent', kind_real, 'Johnson-Cook m', range='(0,inf)', &
                      default='1', &
                      when=jc)
    call registry%key('room_temperature', kind_real, 'initial and reference temperature', &
                      unit='temperature', range='[0,inf)', default='293', when=jc)
    call registry%key('melt_temperature', kind_real, 'melting temperature; needed if thermal', &
                      unit='temperature', range='(0,inf)', when=jc)
    call registry%key('specific_heat', kind_real, 'specific heat; needed if thermal', &
                      unit='specific heat', range='(0,inf)', when=jc)
    call registry%key('taylor_quinney', kind_real, 'part of the plastic work that becomes heat', &
                      range='[0,1]', default='0.9', when=jc)
    call registry%key('failure', kind_logical, 'Johnson-Cook damage and failure', default='no', &
                      when=jc)
    do i = 1, 5
      call registry%key('d'//achar(iachar('0') + i), kind_real, 'Johnson-Cook damage constant', &
                        default='0', when=jc)
    end do
  end subroutine register_johnson_cook

  subroutine register_equations_of_state(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('eos', 'Equation of state of a material.', &
                       'eos copper gruneisen c0=3940 s=1.49 gamma0=1.96', selector='kind')
    call registry%key('material', kind_name_word, 'the material', slot=1, required=.true.)
    call registry%key('kind', kind_word, 'equation', choices='gruneisen jwl', slot=2, &
                      required=.true.)
    call registry%key('c0', kind_real, 'bulk sound speed', unit='speed', range='(0,inf)', &
                      required=.true., when='gruneisen')
    call registry%key('s', kind_real, 'slope of shock speed over particle speed', range='[0,inf)', &
                      required=.true., when='gruneisen')
    call registry%key('gamma0', kind_real, 'Grueneisen coefficient', range='[0,inf)', &
                      required=.true., when='gruneisen')
    call registry%key('a', kind_real, 'JWL A', unit='stress', required=.true., when='jwl')
    call registry%key('b', kind_real, 'JWL B', unit='stress', required=.true., when='jwl')
    call registry%key('r1', kind_real, 'JWL R1', range='(0,inf)', required=.true., when='jwl')
    call registry%key('r2', kind_real, 'JWL R2', range='(0,inf)', required=.true., when='jwl')
    call registry%key('omega', kind_real, 'JWL omega', range='(0,inf)', required=.true., when='jwl')
    call registry%key('energy0', kind_real, 'initial energy per initial volume', unit='stress', &
                      range='[0,inf)', default='0')
    call registry%card('viscosity', 'Bulk viscosity in compression, q = rho h^2 b1 (tr D)^2 - '// &
                       'b2 rho h c tr D; none without this card.', 'viscosity copper')
    call registry%key('material', kind_name_word, 'the material; default: all', default='all', &
                      slot=1)
    call registry%key('quadratic', kind_real, 'b1', range='[0,inf)', default='1.5')
    call registry%key('linear', kind_real, 'b2', range='[0,inf)', default='0.06')
  end subroutine register_equations_of_state

  subroutine register_bodies(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('body', 'A body: its first shape, its material, its particles. Further '// &
                       'shapes are added, subtracted or intersected by the cards of those names.', &
                       'body rod cylinder material=copper radius=3.8 length=25.4 spacing=0.38', &
                       selector='shape')
    call registry%key('name', kind_name_word, 'name used by other cards', slot=1, required=.true.)
    call registry%key('shape', kind_word, 'first shape; file: particles from a file', slot=2, &
                      choices='block cylinder sphere ring cone ogive file', required=.true.)
    call registry%key('material', kind_name_word, 'the material', required=.true.)
    call register_shape_keys(registry)
    call registry%key('file', kind_text, 'text file with a line per particle: x y z volume '// &
                      '[velocity_x velocity_y velocity_z]; a relative path starts at the deck', &
                      when='file', required=.true.)
    call registry%key('layout', kind_word, 'uniform: particles in the middle of cubes; gauss: '// &
                      'Gauss points of each grid cell', choices='uniform gauss', default='uniform')
    call registry%key('spacing', kind_real, 'lattice constant; default: cell/ppc', unit='length', &
                      range='(0,inf)')
    call registry%key('ppc', kind_integer, 'particles per cell along each axis', range='[1,10]', &
                      default='2')
    call registry%key('jitter', kind_real, 'largest random displacement, in spacings', &
                      range='[0,0.5]', default='0')
    call registry%key('rotation', kind_real, 'angle in degrees about z, turns shapes and lattice', &
                      default='0')
    call registry%key('pivot', kind_vector, 'centre of the rotation', unit='length', &
                      default='(0,0,0)')
    call registry%key('lattice_origin', kind_vector, &
                      'a corner of the cubes of the lattice; default: lower corner of the '// &
                      'first shape, or the axis of a round one', unit='length')
    call registry%key('temperature', kind_real, 'initial temperature; default: room temperature', &
                      unit='temperature', range='[0,inf)')
    call registry%key('overlap', kind_word, 'allow: bodies may share space at the start', &
                      choices='error allow', default='error')
    call register_combination(registry, 'add', 'Adds a shape to a body.')
    call register_combination(registry, 'subtract', 'Cuts a shape out of a body.')
    call register_combination(registry, 'intersect', 'Keeps what lies inside a shape.')
    call registry%card('velocity', 'Initial velocity of a body.', 'velocity rod z="-190"')
    call registry%key('body', kind_name_word, 'the body; default: all', default='all', slot=1)
    call register_components(registry, 'speed')
  end subroutine register_bodies

  subroutine register_contact(registry)
    type(registry_t), intent(inout) :: registry
    integer :: i
    call registry%card('contact', 'Lets bodies touch, slide and separate; without it they '// &
                       'stick together where they meet. Names two bodies, one (with all '// &
                       'others) or all; the card that names more counts.', &
                       'contact ball plate friction=0.4')
    call registry%key('first', kind_name_word, 'a body, or all', default='all', slot=1)
    call registry%key('second', kind_name_word, 'another body; default: all others', &
                      default='all', slot=2)
    call registry%key('friction', kind_real, "Coulomb's coefficient of friction", &
                      range='[0,inf)', default='0', source='Eqs. 81 to 84')
    call registry%key('lambda', kind_real, 'bodies touch where their particles are closer than '// &
                      'this many cells along the normal; default: the mean of their spacings', &
                      range='(0,inf)', source='Eq. 86')
    call registry%key('depth', kind_real, 'contact acts at nodes no further than this many '// &
                      'cells from where the surfaces touch; default: at all shared nodes', &
                      range='[0.5,inf)', source='doc/contact.md')
    call registry%key('normal', kind_word, 'common normal: along the shortest line between the '// &
                      "bodies' particles around a node, or from the gradient of volume of "// &
                      'both bodies, of one, or of the stiffer', &
                      choices=normal_words, default='separating', &
                      source='Eqs. 87 and 88')
    call registry%card('rigid', 'Gives a body a prescribed velocity and infinite mass.', &
                       'rigid punch y="-v0*sin(pi*t)"')
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    do i = 1, 3
      call registry%key('xyz' (i:i), kind_expression, 'velocity, a function of t', unit='speed', &
                        default='0')
    end do
  end subroutine register_contact

  subroutine register_combination(registry, name, help)
    type(registry_t), intent(inout) :: registry
    character(*), intent(in) :: name, help
    call registry%card(name, help, name//' rod sphere centre=(0,0,0) radius=1', selector='shape')
    call registry%key('body', kind_name_word, 'the body', slot=1, required=.true.)
    call registry%key('shape', kind_word, 'the shape', slot=2, required=.true., &
                      choices=shape_names)
    call register_shape_keys(registry)
  end subroutine register_combination

  !> Keys of a shape, shared by body, add, subtract and intersect.
  subroutine register_shape_keys(registry)
    type(registry_t), intent(inout) :: registry
    call registry%key('lower', kind_vector, 'lower corner', unit='length', when='block', &
                      required=.true.)
    call registry%key('upper', kind_vector, 'upper corner', unit='length', when='block', &
                      required=.true.)
    call registry%key('centre', kind_vector, 'centre; of the base for cylinder, ring, cone, '// &
                      'ogive; a point of the plane for halfspace', unit='length', &
                      default='(0,0,0)', &
                      when='sphere halfspace '//round_shapes)
    call registry%key('axis', kind_vector, 'direction of the axis; outward normal of a halfspace', &
                      default='(0,0,1)', when='halfspace '//round_shapes)
    call registry%key('radius', kind_real, 'outer radius, of the base for cone and ogive', &
                      unit='length', range='(0,inf)', when='sphere '//round_shapes, required=.true.)
    call registry%key('inner', kind_real, 'inner radius', unit='length', range='(0,inf)', &
                      when='ring', required=.true.)
    call registry%key('top', kind_real, 'radius of the top', unit='length', range='[0,inf)', &
                      when='cone', default='0')
    call registry%key('length', kind_real, 'length along the axis; not needed in 2D', &
                      unit='length', &
                      range='(0,inf)', when=round_shapes)
  end subroutine register_shape_keys

  !> Keys x, y, z that are functions of position.
  subroutine register_components(registry, unit)
    type(registry_t), intent(inout) :: registry
    character(*), intent(in) :: unit
    integer :: i
    do i = 1, 3
      call registry%key('xyz' (i:i), kind_expression, 'component', unit=unit, default='0')
    end do
  end subroutine register_components

  subroutine register_loads(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('gravity', 'Constant acceleration of everything.', 'gravity (0,0,-9.81)', &
                       once=.true.)
    call registry%key('vector', kind_vector, 'acceleration', unit='acceleration', slot=1, &
                      required=.true.)
    call registry%card('bodyforce', 'Force per unit mass as a function of x y z (where the '// &
                       'particle is), x0 y0 z0 (where it was at the start) and t.', &
                       'bodyforce bar x="sin(pi*x0)*cos(t)"')
    call registry%key('body', kind_name_word, 'the body; default: all', default='all', slot=1)
    call register_components(registry, 'acceleration')
    call registry%card('detonation', 'A point or a plane from which explosives are lit.', &
                       'detonation point=(0,0,0)')
    call registry%key('point', kind_vector, 'the point, or a point of the plane', unit='length', &
                      default='(0,0,0)')
    call registry%key('time', kind_real, 'when', unit='time', default='0')
    call registry%key('normal', kind_vector, 'normal of a plane wave; without it the wave is '// &
                      'spherical')
  end subroutine register_loads

  subroutine register_output(registry)
    type(registry_t), intent(inout) :: registry
    call registry%card('output', 'Files of particles. vtkhdf (one file), vtu (a file per dump) '// &
                       'and tecplot: at the start, every so much time, and at the end; csv: '// &
                       'particles_end.csv.', &
                       'output vtkhdf every=1e-3 fields=stress,pressure', selector='kind', &
                       free=.true.)
    call registry%key('kind', kind_word, 'format', choices='vtkhdf vtu tecplot csv', slot=1, &
                      required=.true.)
    call registry%key('at', kind_word, 'when', choices='end', default='end', when='csv')
    call registry%key('every', kind_real, 'interval; default: start and end only', unit='time', &
                      range='(0,inf)', when='vtkhdf vtu tecplot')
    call registry%key('fields', kind_list, 'fields besides id, body, position and velocity', &
                      choices=particle_field_names())
    call registry%card('history', 'Rows of history.csv and bodies.csv.', 'history steps=10', &
                       once=.true., free=.true.)
    call registry%key('steps', kind_integer, 'a row every so many steps', range='[1,inf)', &
                      default='1')
    call registry%key('every', kind_real, 'a row every so much time instead: at the first step '// &
                      'at or after it', unit='time', range='(0,inf)')
    call registry%card('gauge', 'History of the particle nearest to a point at the start.', &
                       'gauge foot point=(0,0,0)')
    call registry%key('name', kind_name_word, 'name in gauges.csv', slot=1, required=.true.)
    call registry%key('point', kind_vector, 'the point', unit='length', required=.true.)
    call registry%card('checkpoint', 'Files checkpoint_NNNNNNN.h5, from which --restart goes '// &
                       'on. '// &
                       'Without this card one is written only when a signal, the time limit or '// &
                       'the stop file ends the run; with it one more at the end.', &
                       'checkpoint every=1000 minutes=30', once=.true., free=.true.)
    call registry%key('every', kind_integer, 'after every so many steps', range='[1,inf)')
    call registry%key('minutes', kind_real, 'after so many minutes of wall time', range='(0,inf)')
    call registry%key('keep', kind_integer, 'how many are kept', range='[1,inf)', default='2')
    call registry%card('balance', 'How work is divided anew among the ranks of a parallel run, '// &
                       'which changes no result.', 'balance every=100 gain=0.1', once=.true., &
                       free=.true.)
    call registry%key('every', kind_integer, 'look after every so many steps; 0: never', &
                      range='[0,inf)', default='16')
    call registry%key('gain', kind_real, 'cut anew if the largest load shrinks by this part', &
                      range='[0,1)', default='0.05')
  end subroutine register_output

end module sgmp_deck_table
