"""What the regression scripts share: running sgmp, reading what it leaves behind, collecting complaints."""
import json
import os
import re
import shutil
import subprocess
import sys

SGMP, SOURCE, SCRATCH = (os.path.abspath(path) for path in sys.argv[1:4])
INPUT = os.path.join(SOURCE, "input")
os.makedirs(SCRATCH, exist_ok=True)
# Open MPI starts faster without a daemon of its own, but then needs a folder that no other script uses; and without
# looking for a way to other machines.
ENVIRONMENT = {**os.environ, "OMP_WAIT_POLICY": "passive", "OMPI_MCA_ess_singleton_isolated": "1",
               "OMPI_MCA_orte_tmpdir_base": SCRATCH, "OMPI_MCA_plm": "isolated", "SGMP_THREADS": "exact"}
# Long scripts are run in pieces, side by side (tests/CMakeLists.txt): number of this one, and how many there are.
PIECE, PIECES = (int(number) for number in os.environ.get("SGMP_TEST_PIECE", "1/1").split("/"))
# `make test-full` asks for more of the same.
FULL = os.environ.get("SGMP_TEST_FULL", "") not in ("", "0")
# The mutation tool asks whether anything fails, not what.
FIRST_ENDS = os.environ.get("SGMP_TEST_FIRST_ENDS", "") not in ("", "0")
# What runs have written is removed where nothing has failed: all tests together write gigabytes.
KEEP = os.environ.get("SGMP_TEST_KEEP", "") not in ("", "0")
FOUND = set(os.listdir(SCRATCH))

# Gas that fills a box from one side of it, {dimension} as the deck has it: volumes are kept.
KEPT = """
parameter method = sgmp
parameter update = musl
dimension {dimension}
grid cell=1 {grid}
wall {walls}
method $method update=$update volumes=kept
time cfl=0.4 steps=80
material air fluid density=1
eos air ideal_gas gamma=1.4 energy0=2.5
viscosity air quadratic=1.5 linear=0.06
body gas block material=air lower=(0,0,0) upper=({upper}) ppc=2
history steps=5
"""
# A strip two cells thick at 8 degrees to the grid, pulled by a force at each end and damped to rest.
INCLINED = """
parameter method = sgmp
parameter update = musl
parameter rotation = plain
parameter span = 2
parameter u = cos(8*pi/180)
parameter w = sin(8*pi/180)
dimension 2
grid cell=0.5
method $method update=$update rotation=$rotation
time end=400*span cfl=0.5
damping rate=0.1
material rubber neo_hookean density=1 young=1 poisson=0.3
body strip block material=rubber lower=(0,0.125) upper=(16,1.125) ppc=2 rotation=8
load strip x="0.004*u*min(t/400,1)" y="0.004*w*min(t/400,1)" where="x*u+y*w>15.75"
load strip x="-0.004*u*min(t/400,1)" y="-0.004*w*min(t/400,1)" where="x*u+y*w<0.25"
output csv at=end
"""
KEPT_PLANE = KEPT.format(dimension=2, grid="x=0:6 y=0:20", walls="x-=slip x+=fixed y-=slip y+=slip", upper="6,10,0")
KEPT_SPACE = KEPT.format(dimension=3, grid="x=0:3 y=0:3 z=0:18",
                         walls="x-=slip x+=slip y-=slip y+=fixed z-=slip z+=slip", upper="3,3,9")
KEPT_RINGS = KEPT.format(dimension="axisymmetric", grid="r=0:4 z=0:18", walls="r+=slip z-=slip z+=slip",
                         upper="4,9").replace("(0,0,0)", "(0,0)")
# Rubber and gas whose particles are stretched to many times their size, and split.
SPLIT = """
parameter method = sgmp
parameter update = musl
parameter split = 0.6
dimension 2
grid cell=0.25 x=0:open y=0:1
wall x-=slip y-=slip y+=slip
method $method update=$update split=split
time steps=60 cfl=0.4
material rubber neo_hookean density=1 young=1e-3 poisson=0
body bar block material=rubber lower=(0,0) upper=(1,1) ppc=2
velocity bar x=x
history steps=5
gauge middle point=(0.5,0.5,0)
output csv at=end fields=density,mass,volume,path,displacement
"""
SPLIT_GAS = KEPT_PLANE.replace("volumes=kept", "volumes=kept split=0.75").replace("(6,10,0)", "(6,2,0)")
SPLIT_RINGS = KEPT_RINGS.replace("volumes=kept", "volumes=kept split=0.75").replace("upper=(4,9)", "upper=(4,2)")
# Apart in all directions, across the planes that ranks own.
SPLIT_SPACE = """
parameter method = sgmp
parameter update = musl
dimension 3
grid cell=0.5
method $method update=$update split=0.7
time steps=16 cfl=0.5
material rubber neo_hookean density=1 young=1e-5 poisson=0.3
body ball sphere material=rubber centre=(0.1,0.2,0.3) radius=1 ppc=2
velocity ball x=0.5*x y=x+0.7*y z=z
history steps=5
output vtkhdf
"""
# About an axis, where a half of a ring is not half of it.
SPLIT_AXIS = """
parameter method = sgmp
parameter update = musl
dimension axisymmetric
grid cell=0.25 r=0:open z=open:open
method $method update=$update split=0.6
time end=4 cfl=0.4
material rubber neo_hookean density=1 young=1e-6 poisson=0
body bar cylinder material=rubber radius=1 length=1 ppc=2
velocity bar r=r z=0.15*r*r
history steps=5
output csv at=end fields=density,mass,volume,path
"""
# Under the address sanitizer, which takes memory of its own, what tests say of memory does not hold.
SANITIZED = os.environ.get("SGMP_TEST_SANITIZED", "") not in ("", "0")


# A body of every kind of matter without strength, in a box.
FLUIDS = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=1 x=0:12 y=0:open
wall x-=slip x+=fixed y-=slip
method $method update=$update
time steps=40 cfl=0.4
gravity (0,-2)
material air fluid density=0.1 viscosity=0.05
material water fluid density=1
material oil fluid density=0.9 viscosity=0.2
material brine fluid density=1.1
eos air ideal_gas gamma=1.4 pressure0=20
eos water tait c0=30 exponent=7 pressure0=20
eos oil stiffened_gas gamma=4.4 p_inf=150 pressure0=20
eos brine polynomial a1=900 a2=900 a3=400 b0=0.3 b1=0.3 energy0=60
viscosity all
body air block material=air lower=(0,6) upper=(12,12) ppc=2
body water block material=water lower=(0,0) upper=(4,6) ppc=2 jitter=0.2
body oil block material=oil lower=(4,0) upper=(8,6) ppc=2
body brine block material=brine lower=(8,0) upper=(12,6) ppc=2
velocity water x=6 y=3
velocity oil y=-3
history steps=10
output csv at=end fields=stress,density,energy
"""

# Plates that hit each other and fail, each by a criterion of its own, two heaps of soil and a bank of clay that they
# hit. A notched bar that is pulled apart; it fails by a strain that is averaged over a length.
AVERAGED = """
parameter h = 0.5
parameter method = sgmp
parameter update = musl
parameter t_end = 0.03
dimension 2
units mm g ms
grid cell=h
method $method update=$update
time end=t_end cfl=0.4
material steel j2 density=7.85e-3 young=200e3 poisson=0.3 yield=500 hardening_modulus=100
failure steel plastic_strain=0.2 length=1
body bar block material=steel lower=(-8,-2) upper=(8,2) ppc=2
subtract bar cylinder centre=(0,2,0) axis=(0,0,1) radius=1.5 length=1
motion bar where="x>7" x=20
motion bar where="x<-7" x=-20
history steps=20
output csv at=end
"""
FAILING = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=1 x=open:open y=0:open
wall y-=slip
method $method update=$update
time steps=80 cfl=0.4
material spalling j2 density=1 young=100 poisson=0.3 yield=1
material torn johnson_cook density=1 young=100 poisson=0.3 yield=1 hardening_modulus=2 hardening_exponent=0.5 &
  failure=yes d1=0.03
material brittle j2 density=1 young=100 poisson=0.3 yield=5
material soil drucker_prager density=0.5 young=20 poisson=0.3 friction=30 cohesion=0.01 dilatancy=5
material clay mohr_coulomb density=0.5 young=20 poisson=0.3 friction=25 cohesion=0.02 dilatancy=5 tension=0.005
eos spalling gruneisen c0=9 s=1.5 gamma0=1.5
failure spalling pmin=-0.5
failure brittle principal_stress=0.8 plastic_strain=0.02 carries=nothing
material mud cam_clay density=0.6 poisson=0.3 critical_ratio=1 compression_slope=0.2 swelling_slope=0.02 &
  void_ratio=1 pressure0=0.05 overconsolidation=1.5
body flyer block material=torn lower=(0,0) upper=(6,8) ppc=2 jitter=0.2
body plate block material=spalling lower=(6,0) upper=(18,8) ppc=2
body lid block material=brittle lower=(0,8) upper=(18,14) ppc=2
body heap block material=soil lower=(18,0) upper=(22,9) ppc=2
body slope block material=clay lower=(22,0) upper=(26,9) ppc=2
body bank block material=mud lower=(26,0) upper=(30,9) ppc=2
velocity flyer x=2
velocity plate y="0.1*x"
history steps=10
output csv at=end fields=stress,density,energy,damage,preconsolidation,plastic_strain
"""



def changed(text, *pairs):
    """A deck with words in the place of others, one pair after the other."""
    for old, new in pairs:
        text = text.replace(old, new)
    return text


# A block that flies, turns and is pulled at one face, and whose particles see the grid from their first places.
REFERENCE = """
parameter method = gimp
parameter update = musl
dimension 2
grid cell=0.25
method $method update=$update frame=reference
time steps=80 cfl=0.4
material rubber neo_hookean density=1 young=1 poisson=0.3
body block block material=rubber lower=(0.1,0) upper=(2.1,1) ppc=2 rotation=20
velocity block x=0.3 y=0.8 omega_z=0.2
traction block face=x+ x=0.01
history steps=5
gauge middle point=(1,0.5,0)
output csv at=end fields=stress,displacement
"""
# A burst in air under its own pressure, between edges that let waves out, beside a plate.
OPEN_AIR = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=0.1 x=0:2 y=0:3
wall x-=slip x+=absorbing y-=absorbing y+=absorbing
method $method update=$update
time steps=100
material gas fluid density=1.2
eos gas ideal_gas gamma=1.4 energy0=2.5e5
material hot fluid density=12
eos hot ideal_gas gamma=1.4 energy0=2.5e6
material steel j2 density=7800 young=2e11 poisson=0.3 yield=3e8
body air block material=gas lower=(0,0) upper=(2,3)
subtract air sphere centre=(0,1.5) radius=0.6
subtract air block lower=(1,0.5) upper=(1.2,2.5)
body ball sphere material=hot centre=(0,1.5) radius=0.6
intersect ball block lower=(0,0) upper=(2,3)
body plate block material=steel lower=(1,0.5) upper=(1.2,2.5)
history steps=5
output csv at=end fields=stress,density
"""

REFERENCE_SPACE = changed(REFERENCE, ("dimension 2", "dimension 3"), ("steps=80", "steps=30"),
                          ("lower=(0.1,0) upper=(2.1,1)", "lower=(0.1,0,0) upper=(1.6,0.75,1.5)"))


# The same, one of them little by little, with limits and yield stresses that scatter.
SCATTERED = changed(
    FAILING, ("failure spalling pmin=-0.5", "failure spalling pmin=-0.5 weibull=3"),
    ("failure=yes d1=0.03", "failure=yes d1=0.03\nfailure torn weibull=2 seed=5"),
    ("plastic_strain=0.02 carries=nothing", "plastic_strain=0.02 fracture_energy=0.01 weibull=4 seed=3"),
    ("poisson=0.3 yield=", "poisson=0.3 yield_weibull=5 yield_seed=2 yield="),
    ("plastic_strain\n", "plastic_strain,strength,yield_factor\n"))

# The same without the heaps, and what has come to nothing goes.
ERODING = changed(
    SCATTERED, ("body heap", "! body heap"), ("body slope", "! body slope"), ("body bank", "! body bank"),
    ("stress,density,energy", "mass,energy"),
    ("failure brittle", """erode torn failed=yes
erode spalling plastic_strain=0.05
erode brittle failed=yes time_step=0.02
failure brittle"""))

# Metals that hit each other so fast that they warm, stiffen and in part melt, foams that they crush and ceramics that
# break.
METALS = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=1 x=open:open y=0:open
wall y-=slip
method $method update=$update
time steps=80 cfl=0.4
material stiff steinberg_guinan yield_weibull=4 density=1 young=100 poisson=0.3 yield=0.5 yield_limit=1.2 &
  hardening_factor=40 hardening_exponent=0.4 &
  pressure_stiffening=0.02 thermal_softening=5e-4 specific_heat=0.01 melt_temperature=420 melt_slope=1.5 melt_gamma=2
eos stiff shock c0=9 s=1.5 gamma0=1.5
material fcc zerilli_armstrong yield_weibull=6 yield_seed=9 density=1.2 young=80 poisson=0.3 yield=0.1 &
  thermal_hardening=3 thermal_softening=2e-3 thermal_rate=1e-4 specific_heat=0.003
eos fcc gruneisen c0=8 s=1.4 gamma0=2
material bcc zerilli_armstrong density=0.8 young=90 poisson=0.3 yield=0.1 thermal_stress=4 thermal_softening=7e-3 &
  thermal_rate=4e-4 hardening_modulus=1 &
  hardening_exponent=0.3
failure bcc plastic_strain=0.2
material foam j2 density=0.7 young=40 poisson=0.3 yield=0.2
eos foam gruneisen c0=8 s=1.4 gamma0=2 distention=1.4 crush_start=0.3 crush_end=6
material sponge j2 density=0.7 young=40 poisson=0.3 yield=0.2
eos sponge shock c0=8 s=1.4 gamma0=2 distention=1.4 crush_start=0.3 crush_end=6 pore_speed=4
material tile johnson_holmquist density=0.9 shear_modulus=40 k1=60 k2=20 k3=30 hugoniot_limit=3 &
  hugoniot_pressure=1.2 intact_strength=0.9 intact_exponent=0.6 &
  fractured_strength=0.4 fractured_exponent=0.7 rate_coefficient=0.02 reference_rate=1e-3 tension_limit=1 &
  damage_strain=0.1
material pad crushable_foam density=0.5 young=30 poisson=0.2 plateau=0.2 plastic_poisson=0.1 linear_hardening=0.2 &
  densification=0.3 densification_strain=1 densification_exponent=3
material wall concrete density=0.8 shear_modulus=30 compressive_strength=0.5 cohesive_strength=0.8 &
  pressure_hardening=1.6 pressure_exponent=0.6 strength_limit=7 &
  rate_coefficient=0.01 reference_rate=1e-3 tension_limit=0.05 damage_strain=0.04 least_damage_strain=0.01 &
  crush_pressure=0.2 crush_compression=0.005 &
  lock_pressure=4 lock_compression=0.15 k1=150 k2=-200 k3=300
erode tile plastic_strain=2
viscosity all
body tile block material=tile lower=(-6,0) upper=(0,8) ppc=2
body flyer block material=stiff lower=(0,0) upper=(6,8) ppc=2 jitter=0.2
body plate block material=fcc lower=(6,0) upper=(14,8) ppc=2
body lid block material=bcc lower=(6,8) upper=(14,14) ppc=2
body backing block material=foam lower=(14,0) upper=(20,4) ppc=2
body cushion block material=sponge lower=(14,4) upper=(20,8) ppc=2
body pad block material=pad lower=(0,8) upper=(6,12) ppc=2
body wall block material=wall lower=(-12,0) upper=(-6,8) ppc=2 jitter=0.2
velocity tile x=6
velocity flyer x=3 y=0.5
velocity pad x=3 y=-0.5
velocity wall x=12
velocity plate y="0.1*x"
history steps=10
output csv at=end fields=stress,density,energy,temperature,plastic_strain,distention,damage,bulking,compaction
"""

# A ball on the axis and a tube that closes on it, walls below and outside.
HOOPS = """
parameter method = sgmp
parameter update = musl
parameter stress = plain
parameter height = 8
dimension axisymmetric
grid cell=1 r=0:12 z=0:open
wall r+=fixed z-=slip
method $method update=$update stress=$stress
time dt=0.1 steps=60
gravity (0,-0.01)
material m elastic density=1 young=1 poisson=0.2
body ball sphere material=m centre=(0,4) radius=3.5 ppc=2 jitter=0.3
body tube block material=m lower=(6,0) upper=(12,height) ppc=2
velocity ball r="0.05*r" z=-0.4
velocity tube r="-0.3*(12-r)/6" z=0.3
"""

# The same turning about the axis, the ball faster above, the tube held by its outer wall.
SWIRL = changed(HOOPS, ("axisymmetric", "axisymmetric swirl=yes"), ('r="0.05*r"', 'r="0.05*r" spin="0.1+0.02*z"'),
                ('r="-0.3*(12-r)/6"', 'r="-0.3*(12-r)/6" spin="0.05*(12-r)/6"'))

# Jelly in a duct whose walls move, one of them across the slowest axis, one beside another at rest.
DRAGGED = """
parameter method = sgmp
parameter update = musl
dimension 3
grid cell=1 x=0:5 y=0:open z=0:14
wall x-=fixed y-=fixed z-=fixed z+=fixed
wallmotion z- x="0.2*sin(t)"
wallmotion z+ x=0.1 y="-0.2*cos(t)"
wallmotion x- z=0.3
method $method update=$update
time dt=0.1 steps=30
material m elastic density=1 young=1 poisson=0.2
body b block material=m lower=(0,0,0) upper=(4,4,14) ppc=2 jitter=0.3
velocity b x=0.05 y="0.1*sin(z)" z="0.05*(x-2)"
history steps=3
output csv at=end
"""

# The same in a duct that rubs: nodes that stick and that slide, walls that are pulled along, images behind walls at the
# cuts.
RUBBED = changed(
    DRAGGED, ("wall x-=fixed y-=fixed z-=fixed z+=fixed",
              "wall x-=slip y-=fixed z-=slip z+=slip\nwallfriction x- friction=0.2\n"
              "wallfriction z- friction=0.5\nwallfriction z+ friction=3"),
    ("velocity b", 'bodyforce b x=-0.01 z="0.02*sin(t)"\nvelocity b'))

# A rigid punch drives a cone into a seat of the same slope, with a hoop around it: bodies of revolution that touch
# along the axis, across it and at an angle to it, near the axis and far from it, three at a corner.
SEAT = """
parameter method = sgmp
parameter update = musl
parameter normal = separating
parameter friction = 0.3
parameter up = 1              ! -1: upside down
dimension axisymmetric
grid cell=1 z=open:open
method $method update=$update mass_cutoff=0
time steps=60 cfl=0.4
material m elastic density=1 young=1 poisson=0.2
material s elastic density=3 young=5 poisson=0.3
body cone polygon material=m corners=(0,3*up),(4,6*up),(4,10*up),(0,10*up)
body seat polygon material=s corners=(0,0),(8,0),(8,9*up),(0,3*up)
body hoop polygon material=m corners=(4,6*up),(6,7.5*up),(6,10*up),(4,10*up)
body punch cylinder material=s centre=(0,10*up) axis=(0,up) radius=6 length=2
rigid punch z="up*(-0.05-0.02*t)"
velocity cone z=-up*0.02
velocity hoop r=-0.01
contact all friction=friction normal=$normal
history steps=1
output csv at=end fields=stress
"""

# A rigid cone goes into soft metal, whose surface along the axis opens to the cone's.
CONE = """
parameter method = sgmp
parameter update = musl
dimension axisymmetric
grid cell=1
method $method update=$update
time end=24 cfl=0.4
material soft j2 density=1 young=100 poisson=0.3 yield=0.3
viscosity all quadratic=1.5 linear=0.2
body cone polygon material=soft corners=(0,0),(4,8),(4,30),(0,30) ppc=2
body block block material=soft lower=(0,-36) upper=(20,0) ppc=2
rigid cone z=-1
contact all friction=0.1
history steps=50
output csv at=end
"""
# A charge, dense air and a metal.
BURNS = """material tnt explosive density=1.63e-3 detonation_speed=6930
eos tnt jwl a=371200 b=3210 r1=4.15 r2=0.95 omega=0.30 energy0=6993
material air fluid density=5e-5
eos air ideal_gas gamma=1.4 pressure0=0.1
material steel johnson_cook density=7.83e-3 young=207000 poisson=0.29 yield=500
eos steel gruneisen c0=4569 s=1.49 gamma0=1.93
viscosity all
"""


class Run:
    """One finished run: exit code, everything printed, summary.json, its folder."""

    def __init__(self, code, text, folder):
        self.code = code
        self.text = text
        self.folder = folder
        path = os.path.join(folder, "summary.json")
        self.summary = {}
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.summary = json.load(file)

    def __getitem__(self, name):
        value = self.summary
        for part in name.split("."):
            value = value[part]
        return value

    def table(self, name):
        """A csv file as a list of dictionaries of numbers."""
        with open(os.path.join(self.folder, name), encoding="utf-8") as file:
            lines = [line.rstrip("\n") for line in file if not line.startswith("#")]
        head = lines[0].split(",")
        return [{key: number(value) for key, value in zip(head, line.split(","))} for line in lines[1:]]


def number(text):
    """A number of a csv file; Fortran leaves the E out of exponents of three digits."""
    try:
        return float(text)
    except ValueError:
        return float(re.sub(r"(\d)([+-]\d{3})$", r"\1E\2", text)) if re.match(r"[-+.\d]", text) else text


def own(items):
    """Those that belong to this piece of the script."""
    return list(items)[PIECE - 1::PIECES]


def run(name, deck, threads=1, options=(), timeout=300, **settings):
    """Runs a deck of input/ (by name) or of its own (text with line ends)."""
    folder = os.path.join(SCRATCH, name)
    if "\n" in deck:
        path = os.path.join(SCRATCH, name + ".inp")
        with open(path, "w", encoding="utf-8") as file:
            file.write(deck)
    else:
        path = os.path.join(INPUT, deck)
    for old in ("summary.json", "history.csv", "particles_end.csv"):
        if os.path.exists(os.path.join(folder, old)):
            os.remove(os.path.join(folder, old))
    command = [SGMP, path, "--quiet", "--threads", str(threads), "--output", folder, *options]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=timeout, check=False,
                          env=ENVIRONMENT)
    return Run(done.returncode, done.stdout.decode("utf-8", "replace"), folder)


def remove(result):
    """Removes the folder of a run whose files are not needed any more."""
    if not KEEP:
        shutil.rmtree(result.folder, ignore_errors=True)


def tidy():
    """Removes from the scratch folder what was not in it when the script began."""
    for name in set(os.listdir(SCRATCH)) - FOUND if not KEEP else ():
        path = os.path.join(SCRATCH, name)
        if os.path.isdir(path) and not os.path.islink(path):
            shutil.rmtree(path, ignore_errors=True)
        else:
            os.remove(path)


class Report:
    """Counts what is checked and what is wrong."""

    def __init__(self):
        self.checks = 0
        self.failures = 0

    def check(self, condition, message):
        """Notes a failure unless the condition holds; returns the condition."""
        self.checks += 1
        if not condition:
            self.failures += 1
            print("FAIL", message, flush=True)
            if FIRST_ENDS:
                sys.exit(1)
        return condition

    def finished(self, result, name):
        """A run that ended well."""
        return self.check(result.code == 0, f"{name}: exit code {result.code}\n{result.text}")

    def add(self, other):
        """Counts what another report has counted."""
        self.checks += other.checks
        self.failures += other.failures

    def end(self):
        """Last line and exit code."""
        print(f"{self.checks} checks, {self.failures} failures")
        if not self.failures:
            tidy()
        sys.exit(1 if self.failures or not self.checks else 0)
