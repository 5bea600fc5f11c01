"""Johnson and Holmquist's ceramics (JH-2) along a path of uniaxial strain, as a second implementation: implicit in all
that the program takes from the beginning of the step, in shorter steps.
"""
import math


def power(base, exponent):
    return base**exponent if base > 0 else 0.0


def flow_of(trial, stiffness, strength):
    """Plastic strain that takes a trial stress down to the strength that it leaves: the secant method that keeps the
    root between its ends (Illinois)."""
    low, high, flow = 0.0, trial/stiffness, 0.0
    above, below = trial - strength(low), -strength(high)
    for _ in range(60):
        flow = (low*below - high*above)/(below - above)
        left = trial - stiffness*flow - strength(flow)
        if abs(left) < 1e-7*trial:
            break
        if left > 0:
            low, above, below = flow, left, below/2
        else:
            high, below, above = flow, left, above/2
    return flow


def strengths(c, pressure, rate):
    """Of intact and of fractured matter."""
    unit = 1.5*(c["hugoniot_limit"] - c["hugoniot_pressure"])
    faster = 1 + c.get("rate_coefficient", 0.0)*math.log(max(1.0, rate/c.get("reference_rate", 1.0)))
    intact = (
        c["intact_strength"]
        * power((pressure + c["tension_limit"]) / c["hugoniot_pressure"], c["intact_exponent"])
        * faster
    )
    fractured = c["fractured_strength"]*power(pressure/c["hugoniot_pressure"], c.get("fractured_exponent", 1.0))*faster
    return unit*intact, unit*min(fractured, c.get("fractured_limit", math.inf), intact)


def squeezed(c, times, volumes, substeps):
    """Pressure, von Mises stress, plastic strain, damage and bulking pressure at times when the volume is known, which
    is linear in between."""
    shear, k1 = c["shear_modulus"], c["k1"]
    axial = plastic = damage = bulking = pressure = 0.0
    found = [(0.0,)*5]
    for i in range(1, len(times)):
        dt = (times[i] - times[i - 1])/substeps
        for part in range(substeps):
            first, v = (volumes[i - 1] + (volumes[i] - volumes[i - 1])*(part + later)/substeps for later in (0, 1))
            strain, mu = math.log(v/first), 1/v - 1
            axial += 4/3*shear*strain
            trial, rate, dense = 1.5*abs(axial), 2/3*abs(strain)/dt, max(mu, 0.0)
            curve = k1*mu + c.get("k2", 0.0)*dense**2 + c.get("k3", 0.0)*dense**3
            if curve + bulking < -c["tension_limit"]*(1 - damage):
                damage = 1.0

            def after(flow):
                """Strength, damage and bulking pressure if this is the plastic strain of the step."""
                grown, more = damage, bulking
                if flow > 0:
                    for _ in range(3):  # damage, strength and bulking with the pressure that they make
                        now = max(curve + more, -c["tension_limit"]*(1 - grown))
                        fatal = c["damage_strain"] * power(
                            (now + c["tension_limit"]) / c["hugoniot_pressure"], c.get("damage_exponent", 1.0)
                        )
                        grown = min(1.0, damage + flow/fatal) if fatal > 0 else 1.0
                        intact, fractured = strengths(c, now, rate)
                        if k1*mu + bulking > 0:
                            energy = [(intact - d*(intact - fractured))**2/(6*shear) for d in (damage, grown)]
                            more = (
                                math.sqrt(
                                    (k1 * mu + bulking) ** 2 + 2 * c.get("bulking", 1.0) * k1 * (energy[0] - energy[1])
                                )
                                - k1 * mu
                            )
                now = max(curve + more, -c["tension_limit"]*(1 - grown))
                intact, fractured = strengths(c, now, rate)
                return intact - grown*(intact - fractured), grown, more
            flow = 0.0
            if trial > after(0.0)[0]:
                flow = flow_of(trial, 3*shear, lambda strain: after(strain)[0])
                _, damage, bulking = after(flow)
                axial *= (trial - 3*shear*flow)/trial
                plastic += flow
            pressure = max(curve + bulking, -c["tension_limit"]*(1 - damage))
        found.append((pressure, 1.5*abs(axial), plastic, damage, bulking))
    return found
