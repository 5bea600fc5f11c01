"""A one-dimensional Lagrangian code (von Neumann and Richtmyer 1950, Wilkins 1964), written apart from the program:
layers of gas, explosive and metal in a row, in cylinders or in spheres. It gives random scenes their truth.

Nodes have places and velocities, zones between them density, energy and stress. Layers have nodes of their own at
their ends: they hit each other without bouncing, and part without holding. Any consistent units.
"""
import numpy as np


class Gas:
    """An ideal gas at a pressure."""

    def __init__(self, density, gamma, pressure):
        self.density, self.gamma = density, gamma
        self.energy0 = pressure/(gamma - 1)  # per initial volume
        self.shear = self.strength = 0.0

    def pressure(self, v, energy, _burnt):
        """Pressure and the square of the speed of sound times the initial density."""
        p = (self.gamma - 1)*energy/v
        return p, self.gamma*p*v


class Jwl:
    """Products of an explosive that a front of constant speed lights."""

    def __init__(self, density, speed, a, b, r1, r2, omega, energy0):
        self.density, self.speed, self.energy0 = density, speed, energy0
        self.law = a, b, r1, r2, omega
        self.shear = self.strength = 0.0

    def pressure(self, v, energy, burnt):
        """As above; what does not burn yet has no pressure."""
        a, b, r1, r2, omega = self.law
        ea, eb = a*np.exp(-r1*v), b*np.exp(-r2*v)
        p = ea*(1 - omega/(r1*v)) + eb*(1 - omega/(r2*v)) + omega*energy/v
        slope = (
            ea * (-r1 + omega / v + omega / (r1 * v**2))
            + eb * (-r2 + omega / v + omega / (r2 * v**2))
            - omega * energy / v**2 - omega * p / v
        )
        stiff = np.where(burnt > 0, np.maximum(-slope*v**2, 0.0), self.density*self.speed**2)
        return burnt*p, np.maximum(stiff, 1e-12*self.density*self.speed**2)


class Metal:
    """Mie and Grueneisen's equation on a linear shock velocity, perfectly plastic."""

    def __init__(self, density, c0, s, gamma0, shear, strength):
        self.density, self.c0, self.s, self.gamma0 = density, c0, s, gamma0
        self.energy0, self.shear, self.strength = 0.0, shear, strength

    def pressure(self, v, energy, _burnt):
        """As above."""
        mu = 1/v - 1
        c1 = self.density*self.c0**2
        dense = np.maximum(mu, 0.0)
        cubic = c1*dense + c1*(2*self.s - 1)*dense**2 + c1*(self.s - 1)*(3*self.s - 1)*dense**3
        p = np.where(mu > 0, cubic*(1 - 0.5*self.gamma0*(1 - v)), c1*mu) + self.gamma0*energy
        rise = c1 + 2*c1*(2*self.s - 1)*dense + 3*c1*(self.s - 1)*(3*self.s - 1)*dense**2
        return p, np.maximum(rise + self.gamma0*np.maximum(p, 0.0)*v**2, 0.1*c1) + 4/3*self.shear


class Water(Metal):
    """The same without strength: pulled, it boils and keeps no tension."""

    def __init__(self, density, c0, s, gamma0):
        super().__init__(density, c0, s, gamma0, 0.0, 0.0)

    def pressure(self, v, energy, burnt):
        p, stiff = super().pressure(v, energy, burnt)
        return np.maximum(p, 0.0), stiff


class Layer:
    """Matter between two places, with a velocity; `lit`: the place from which it burns."""

    def __init__(self, matter, lower, upper, zones, velocity=0.0, lit=None):
        self.matter, self.lower, self.upper, self.zones = matter, lower, upper, zones
        self.velocity, self.lit = velocity, lit


class Row:
    """The state of a row of layers; `order` 0: plane, 1: about an axis, 2: about a point."""

    def __init__(self, layers, order=0, left=None, right=None):
        self.layers, self.order = layers, order
        self.left, self.right = left, right  # walls
        self.parts, node, zone = [], 0, 0
        x, v, density, lit, energy = [], [], [], [], []
        for layer in layers:
            n = layer.zones
            nodes = np.linspace(layer.lower, layer.upper, n + 1)
            self.parts.append((slice(node, node + n + 1), slice(zone, zone + n)))
            node, zone = node + n + 1, zone + n
            x.append(nodes)
            v.append(np.full(n + 1, layer.velocity))
            density.append(np.full(n, layer.matter.density))
            energy.append(np.full(n, layer.matter.energy0/layer.matter.density))
            middle = 0.5*(nodes[1:] + nodes[:-1])
            burns = isinstance(layer.matter, Jwl)
            lit.append(abs(middle - layer.lit)/layer.matter.speed if burns else np.full(n, -np.inf))
        self.x, self.v = np.concatenate(x), np.concatenate(v)
        self.density0, self.lit, self.energy = (np.concatenate(some) for some in (density, lit, energy))
        self.first = np.concatenate([np.arange(part.start, part.stop - 1) for part, _ in self.parts])
        self.room = self.volumes()
        self.mass = self.density0*self.room
        self.node_mass = np.zeros_like(self.x)
        np.add.at(self.node_mass, self.first, 0.5*self.mass)
        np.add.at(self.node_mass, self.first + 1, 0.5*self.mass)
        self.radial, self.around = np.zeros_like(self.mass), np.zeros_like(self.mass)  # deviatoric stress
        self.viscous = np.zeros_like(self.mass)
        self.failed = np.zeros(len(self.mass), dtype=bool)
        self.time = 0.0
        self.update_pressure()

    def volumes(self):
        """Of the zones: per area, per radian and length, per steradian."""
        power = self.order + 1
        return (self.x[self.first + 1]**power - self.x[self.first]**power)/power

    def burnt(self):
        """Part of each zone that has burnt: the front crosses it in three zones' time."""
        out = np.ones_like(self.mass)
        for layer, (nodes, zones) in zip(self.layers, self.parts):
            if isinstance(layer.matter, Jwl):
                wide = 3*(layer.upper - layer.lower)/layer.zones/layer.matter.speed
                out[zones] = np.clip((self.time - self.lit[zones])/wide + 0.5, 0.0, 1.0)
        return out

    def update_pressure(self):
        """Pressure and speed of sound of all zones."""
        v, burnt = self.volumes()*self.density0/self.mass, self.burnt()
        self.p, self.c = np.zeros_like(v), np.zeros_like(v)
        for layer, (_, zones) in zip(self.layers, self.parts):
            energy = self.energy[zones]*layer.matter.density
            p, stiff = layer.matter.pressure(v[zones], energy, burnt[zones])
            limit = getattr(layer.matter, "spall", None)
            if limit is not None:  # what was pulled so far bears pressure alone from then on
                self.failed[zones] |= p < limit
                p = np.where(self.failed[zones], np.maximum(p, 0.0), p)
            self.p[zones], self.c[zones] = p, np.sqrt(stiff/layer.matter.density)

    def step(self, limit):
        """One step, of at most `limit`."""
        width = self.x[self.first + 1] - self.x[self.first]
        speed = self.c + 4*np.abs(self.v[self.first + 1] - self.v[self.first])
        dt = min(limit, 0.4*float(np.min(width/speed)))
        self.v += dt*self.force()/self.node_mass
        self.meet(dt)
        self.x += dt*self.v
        before = self.mass/self.room
        room = self.volumes()
        middle = 0.5*(self.x[self.first + 1] + self.x[self.first])
        stretch = (self.v[self.first + 1] - self.v[self.first])/(self.x[self.first + 1] - self.x[self.first])
        hoop = 0.5*(self.v[self.first + 1] + self.v[self.first])/middle if self.order else np.zeros_like(stretch)
        spread = np.log(room/self.room)/dt
        work = self.strain(dt, stretch, hoop, spread, before)
        change = room - self.room
        self.room = room
        density = self.mass/room
        squeeze = np.maximum(-stretch, 0.0)*width
        viscous = density*squeeze*(1.5*squeeze + 0.1*self.c)
        old = self.p + 0.5*(self.viscous + viscous)
        self.viscous = viscous
        self.time += dt
        start = self.energy.copy()
        self.energy = start + work - old*change/self.mass
        p = self.p.copy()
        for _ in range(2):  # with the mean pressure of the step
            self.update_pressure()
            self.energy = start + work - (old + 0.5*(self.p - p))*change/self.mass
        self.update_pressure()
        return dt

    def strain(self, dt, stretch, hoop, spread, density):
        """Deviatoric stress of metals, radial return; its work per mass."""
        work = np.zeros_like(stretch)
        for layer, (_, zones) in zip(self.layers, self.parts):
            matter = layer.matter
            if matter.shear == 0.0:
                continue
            r0, t0 = self.radial[zones].copy(), self.around[zones].copy()
            r = r0 + 2*matter.shear*dt*(stretch[zones] - spread[zones]/3)
            t = t0 + 2*matter.shear*dt*(hoop[zones] - spread[zones]/3)  # order 0: -spread/3 each
            third = -r - t
            size = np.sqrt(1.5*(r**2 + t**2 + third**2))
            back = np.minimum(1.0, matter.strength/np.maximum(size, 1e-30))*~self.failed[zones]
            self.radial[zones], self.around[zones] = r*back, t*back
            mr, mt = 0.5*(r0 + self.radial[zones]), 0.5*(t0 + self.around[zones])
            along = spread[zones] - stretch[zones] - hoop[zones] if self.order < 2 else hoop[zones]
            if self.order == 0:
                along = np.zeros_like(along)
            work[zones] = dt*(mr*stretch[zones] + mt*hoop[zones] + (-mr - mt)*along)/density[zones]
        return work

    def force(self):
        """On the nodes."""
        stress = -self.p - self.viscous + self.radial
        out = np.zeros_like(self.x)
        area = self.x**self.order
        np.add.at(out, self.first, stress*area[self.first])
        np.add.at(out, self.first + 1, -stress*area[self.first + 1])
        if self.order:  # what bears around the axis: as the work of the zone's volume
            around = -self.p - self.viscous + self.around
            if self.order == 2:
                around = -self.p - self.viscous - 0.5*self.radial
            middle = 0.5*(self.x[self.first + 1] + self.x[self.first])
            half = 0.5*self.room/middle*self.order
            push = np.zeros_like(out)
            np.add.at(push, self.first, half*around)
            np.add.at(push, self.first + 1, half*around)
            low, high = self.x[self.first], self.x[self.first + 1]
            own = np.zeros_like(out)  # the radial stress times the change of the area in the zone
            np.add.at(own, self.first, stress*0.5*(high**self.order - low**self.order))
            np.add.at(own, self.first + 1, stress*0.5*(high**self.order - low**self.order))
            out += own - push
        return out

    def meet(self, dt):
        """A wall, the middle, and layers that touch."""
        if self.left is not None or self.order:
            wall = self.left if self.left is not None else 0.0
            if self.x[0] + dt*self.v[0] < wall or self.x[0] <= wall:
                self.v[0] = max(self.v[0], 0.0) if self.x[0] > wall else 0.0
        if self.right is not None and self.x[-1] + dt*self.v[-1] >= self.right:
            self.v[-1] = min(self.v[-1], 0.0)
        for (a, _), (b, _) in zip(self.parts, self.parts[1:]):
            i, j = a.stop - 1, b.start
            if self.x[i] + dt*self.v[i] > self.x[j] + dt*self.v[j]:
                common = (self.node_mass[i]*self.v[i] + self.node_mass[j]*self.v[j])/(
                    self.node_mass[i] + self.node_mass[j])
                self.v[i] = self.v[j] = common
                self.x[i] = self.x[j] = 0.5*(self.x[i] + self.x[j])

    def run(self, end):
        """To a time."""
        while self.time < end*(1 - 1e-12):
            self.step(end - self.time)
        return self

    def velocity(self, layer):
        """Mean over the mass of a layer."""
        nodes, zones = self.parts[layer]
        v, m = self.v[nodes], self.mass[zones]
        return float(np.sum(0.5*(v[1:] + v[:-1])*m)/np.sum(m))

    def outer(self, layer, part):
        """Mean velocity of the outer part of a layer as it lay at the start."""
        nodes, _ = self.parts[layer]
        v = self.v[nodes]
        n = round((1 - part)*(len(v) - 1))
        return float(np.mean(0.5*(v[n + 1:] + v[n:-1])))

    def energies(self):
        """Kinetic and internal energy."""
        return float(0.5*np.sum(self.node_mass*self.v**2)), float(np.sum(self.mass*self.energy))
