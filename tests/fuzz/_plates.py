"""The free circular plate in its first axisymmetric mode by the theory of Mindlin and Deresiewicz (1954), with shear
and the inertia of rotation; shear factor pi^2/12. The table of Irie, Yamada and Aomura (1980) has the frequencies that
`tests/regression/axisymmetric.py` asks of it."""
import math

TERMS = 14


def kelvin(square, r, slope=0):
    """J0(sqrt(square) r), or its first or second derivative along r; I0 where the square is below zero."""
    total = 0.0
    for k in range((slope + 1)//2, TERMS):
        power = 2*k - slope
        factor = math.prod(2*k - i for i in range(slope))
        total += (-square/4)**k/math.factorial(k)**2*factor*r**power
    return total


class Plate:
    """Radius 1, density 1, Young's modulus 1."""

    def __init__(self, thickness, poisson):
        self.h, self.nu = thickness, poisson
        self.bending = thickness**3/(12*(1 - poisson**2))
        low, high = 3.0, 9.1  # the thin plate has 9.003 with 0.3
        for _ in range(60):
            middle = 0.5*(low + high)
            low, high = (middle, high) if self.unbalanced(middle)*self.unbalanced(low) > 0 else (low, middle)
        self.number = 0.5*(low + high)
        self.unbalanced(self.number)
        self.omega = self.number*math.sqrt(self.bending/self.h)

    def unbalanced(self, number):
        """Determinant of moment and shear force at the rim; leaves the two terms of the mode."""
        inertia = self.h**2/12
        shear = self.bending/(math.pi**2/12*self.h/(2*(1 + self.nu)))
        fourth = number**2
        root = math.sqrt((inertia - shear)**2 + 4/fourth)
        squares = [0.5*fourth*(inertia + shear + sign*root) for sign in (1, -1)]
        factors = [square/(inertia*fourth - 1/shear) for square in reversed(squares)]
        moment = [(f - 1)*(kelvin(s, 1, 2) + self.nu*kelvin(s, 1, 1)) for s, f in zip(squares, factors)]
        force = [f*kelvin(s, 1, 1) for s, f in zip(squares, factors)]
        self.terms = list(zip(squares, factors, (1.0, -force[0]/force[1])))
        return moment[0]*force[1] - moment[1]*force[0]

    def mode(self):
        """Formulas of the velocity along z and of the slope psi, v_r = z psi, along the radius r: polynomials."""
        deflection = [sum(a*(-s/4)**k/math.factorial(k)**2 for s, f, a in self.terms) for k in range(TERMS)]
        slope = [
            sum(a*(f - 1)*(-s/4)**k/math.factorial(k)**2*2*k for s, f, a in self.terms) for k in range(1, TERMS)
        ]
        return horner(deflection), f"r*({horner(slope)})"


def horner(values):
    """The text of a polynomial in r^2."""
    text = f"({values[-1]!r})"
    for value in reversed(values[:-1]):
        text = f"({value!r}+r*r*{text})"
    return text
