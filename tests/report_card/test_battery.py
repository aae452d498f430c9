"""A battery for report cards: right potentials pass, wrong forces and declarations fail.

Most wrong ones share a class, so that it compiles once; in the default set nothing is compiled.
"""

from typing import NamedTuple

import numpy as np
import pytest

import tribo
from tribo import check
from tribo.potentials import expression, from_points, tabulated

LENNARD_JONES, HERTZ, GAUSSIAN, MORSE, COULOMB = range(5)
KINDS = ("lennard-jones", "hertz", "gaussian", "morse", "coulomb")


class Suspect(NamedTuple):
    """A potential of unit energy and length that may have one flaw."""

    kind: float
    factor: float = 1.0  # of the force between two distances
    above: float = 0.0  # these distances
    below: float = 1e9
    power: float = 0.0  # the force is multiplied by r to this power
    shift: float = 0.0  # of r in the force
    drag: float = 0.0  # constant added to the force
    place: float = 1.1  # of a jump or a kink
    jump: float = 0.0  # of U
    kink: float = 0.0  # of U, with a jump of the force
    bend: float = 0.0  # of U, with a kink of the force
    end: float = 0.0  # declared range, if not 0
    smooth: float = 9.0  # declared smoothness
    within: float = 9.0  # declared smoothness below the range
    lowest: float = 0.0  # declared distance, energy and curvature of the minimum, if not 0
    depth: float = -1.0
    curvature: float = 1.0

    def energy(self, r):
        past = np.maximum(r - self.place, 0.0)
        extra = self.jump * (r > self.place) + self.kink * past + 0.5 * self.bend * past * past
        extra = extra * np.exp(-past)
        if self.kind == LENNARD_JONES:
            return 4.0 * (r**-12.0 - r**-6.0) + extra
        if self.kind == HERTZ:
            return np.maximum(1.5 - r, 0.0) ** 2.5 + extra
        if self.kind == GAUSSIAN:
            return np.exp(-0.5 * r * r) + extra
        if self.kind == MORSE:
            return np.exp(-2.0 * (r - 1.0)) - 2.0 * np.exp(-(r - 1.0)) + extra
        return 1.0 / r + extra

    def force(self, r):
        past = np.maximum(r - self.place, 0.0)
        extra = self.jump * (r > self.place) + self.kink * past + 0.5 * self.bend * past * past
        rate = self.kink * (r > self.place) + self.bend * past
        more = (extra * (r > self.place) - rate) * np.exp(-past) + self.drag
        x = r + self.shift
        if self.kind == LENNARD_JONES:
            plain = 4.0 * (12.0 * x**-13.0 - 6.0 * x**-7.0)
        elif self.kind == HERTZ:
            plain = 2.5 * np.maximum(1.5 - x, 0.0) ** 1.5
        elif self.kind == GAUSSIAN:
            plain = x * np.exp(-0.5 * x * x)
        elif self.kind == MORSE:
            plain = 2.0 * (np.exp(-2.0 * (x - 1.0)) - np.exp(-(x - 1.0)))
        else:
            plain = 1.0 / (x * x)
        wrong = (r > self.above) & (r < self.below)
        return plain * (1.0 + (self.factor - 1.0) * wrong) * r**self.power + more

    def range(self):
        return self.end if self.end > 0.0 else np.inf

    def smoothness(self):
        return self.smooth

    def smoothness_within(self):
        return self.within

    def minimum(self):
        return self.lowest if self.lowest > 0.0 else np.inf, self.depth, self.curvature


# Flaws of every kind of potential.
FLAWS = {
    "half as much again in the core": {"factor": 1.5, "below": 0.6},
    "a factor in the tail": {"factor": 0.9, "above": 1.4},
    "a factor in a narrow interval": {"factor": 1.001, "above": 1.2, "below": 1.24},
    "a factor that is nearly 1": {"factor": 1.0 + 1e-8},
    "the other sign": {"factor": -1.0},
    "another power of r": {"power": 1e-7},
    "a shift of r": {"shift": 1e-7},
    "a constant force": {"drag": 1e-8},
    "a jump of the energy": {"jump": 1e-6},
    "a kink of the energy": {"kink": 1e-3},
    "a kink of the force": {"bend": 1e-1},
}
# Flaws of one kind.
DECLARATIONS = {
    "a range that is too short": (COULOMB, {"end": 3.0}),
    "a cutoff declared continuous": (COULOMB, {"end": 3.0, "smooth": 0.0}),
    "a jump of the force declared none": (LENNARD_JONES, {"end": 2.0 ** (1 / 6), "smooth": 0.0}),
    "a range short of a contact's": (HERTZ, {"end": 1.4, "smooth": 2.0}),
    "a kink declared two derivatives": (MORSE, {"bend": 0.1, "within": 2.0, "smooth": 2.0}),
    "a jump declared a kink": (GAUSSIAN, {"kink": 1e-3, "within": 1.0, "smooth": 1.0}),
    "a jump of U declared one of the force": (
        COULOMB,
        {"jump": 1e-3, "within": 0.0, "smooth": 0.0},
    ),
    "a minimum elsewhere": (MORSE, {"lowest": 1.001, "depth": -1.0, "curvature": 2.0}),
    "a minimum that is too deep": (MORSE, {"lowest": 1.0, "depth": -1.01, "curvature": 2.0}),
    "a curvature that is too small": (MORSE, {"lowest": 1.0, "depth": -1.0, "curvature": 1.0}),
    "a minimum of a repulsion": (GAUSSIAN, {"lowest": 1.0, "depth": 0.6, "curvature": 0.0}),
}


class Step(NamedTuple):
    """An energy between two distances, and a Gaussian."""

    h: float
    d: float
    begin: float = 0.0
    gaussian: float = 0.0

    def energy(self, r):
        step = np.where((r > self.begin) & (r < self.d), self.h, 0.0)
        return step + self.gaussian * np.exp(-12.0 * r * r)


class Power(NamedTuple):
    """A power whose exponent is a field."""

    n: float
    e: float = 1.0

    def energy(self, r):
        return self.e / r**self.n


def table_of_jones(points, low=0.8, high=3.0, at=None, change=lambda energy: energy):
    """A table of a Lennard-Jones energy, at equal distances, with one value changed."""
    r = np.linspace(low, high, points)
    energy = tribo.LennardJones(0.5, 1.0).energy(r)
    if at is not None:
        energy[at] = change(energy[at])
    return from_points(r, energy)


STEPS = {
    "a step below 1": Step(3.0, 0.7),
    "a step above 2": Step(3.0, 3.0),
    "a step at a large distance": Step(3.0, 4.7e5),
    "a well below 1": Step(-3.0, 0.7),
    "a well above 2": Step(-3.0, 5.0),
    "a narrow shell": Step(1.0, 5.01, begin=5.0),
    "a step beyond the force": Step(0.1, 5.0, gaussian=1.0),
    "a step that is high beside the force": Step(100.0, 0.2, gaussian=1e-3),
    "a step of an expression": expression("where(r < d, h, 0.0)", h=1.0, d=2.5),
}
TABLES = {
    "a table with one value off": table_of_jones(45, at=20, change=lambda energy: energy + 0.05),
    "a table with a flipped sign": table_of_jones(45, at=20, change=lambda energy: -energy),
    "a table with a lost digit": table_of_jones(60, at=12, change=lambda energy: 0.1 * energy),
}
WRONG = {
    f"{KINDS[kind]}, {flaw}": Suspect(float(kind), **values)
    for kind in range(5)
    for flaw, values in FLAWS.items()
} | {
    f"{KINDS[kind]}, {flaw}": Suspect(float(kind), **values)
    for flaw, (kind, values) in DECLARATIONS.items()
}
WRONG |= STEPS | TABLES


class HertzMaximum(NamedTuple):
    """A Hertz contact by a maximum."""

    d: float

    def energy(self, r):
        return 2.0 * np.maximum(1.0 - r / self.d, 0.0) ** 2.5


class HertzWhere(NamedTuple):
    """A Hertz contact by a choice of arrays."""

    d: float

    def energy(self, r):
        return np.where(r < self.d, 2.0 * np.abs(1.0 - r / self.d) ** 2.5, 0.0)

    def force(self, r):
        return np.where(r < self.d, 5.0 / self.d * np.abs(1.0 - r / self.d) ** 1.5, 0.0)


class HertzIf(NamedTuple):
    """A Hertz contact of numbers, with the declarations of the built-in one."""

    d: float

    def energy(self, r):
        if r < self.d:
            return 2.0 * (1.0 - r / self.d) ** 2.5
        return 0.0

    def range(self):
        return self.d

    def smoothness(self):
        return 2


class Adhesive(NamedTuple):
    """A smooth contact: elastic repulsion below 1, adhesion that vanishes at 1 + gap."""

    stiffness: float
    adhesion: float
    gap: float

    def energy(self, r):
        overlap = np.maximum(1.0 - r, 0.0)
        u = np.minimum(np.maximum((r - 1.0) / self.gap, 0.0), 1.0)
        well = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        return self.stiffness * overlap * overlap * np.sqrt(overlap) - self.adhesion * well


JONES = tribo.LennardJones(1.0, 1.0)
R = np.geomspace(0.8, 4.0, 300)
RIGHT = {
    "a stiff spring": expression("0.5*k*(r - r0)**2", k=1e10, r0=1.0),
    **{KINDS[kind]: Suspect(float(kind)) for kind in range(5)},
    "a declared kink": Suspect(float(MORSE), bend=0.1, within=1.0, smooth=1.0),
    "a declared jump": Suspect(float(MORSE), kink=0.1, within=0.0, smooth=0.0),
    "a declared jump of U": Suspect(float(COULOMB), jump=0.1, within=-1.0, smooth=-1.0),
    "a declared end": Suspect(float(COULOMB), end=3.0, smooth=-1.0),
    "a declared minimum": Suspect(float(MORSE), lowest=1.0, depth=-1.0, curvature=2.0),
    "hertz by np.maximum": HertzMaximum(1.0),
    "a small hertz contact": HertzMaximum(1e-3),
    "a large hertz contact": HertzMaximum(300.0),
    "hertz by np.where": HertzWhere(0.2),
    "hertz by if": HertzIf(5.0),
    "hertz": tribo.Hertz(1.0, 0.05),
    "soft spheres": tribo.SoftSphere(1.0, 0.3, 12.0),
    "very soft spheres": tribo.SoftSphere(1.0, 0.3, 1.0),
    "an adhesive contact": Adhesive(10.0, 0.1, 0.2),
    "a weak adhesive contact": Adhesive(1000.0, 1e-3, 0.5),
    "a hertz expression": expression("A*max(1 - r/d, 0)**2.5", A=1.0, d=0.7),
    "an if expression": expression("A*(d - r)**3 if r < d else 0", A=1.0, d=0.7),
    "a table": tabulated(JONES.energy, 0.8, 3.0, 1e-5),
    "a dense spline": from_points(R, JONES.energy(R)),
    "a table with a cutoff": tabulated(JONES.energy, 0.8, 3.0, 1e-5).with_cutoff(2.9),
    "a coarse table": table_of_jones(12, low=0.9),
    "a table of a core": table_of_jones(40, low=0.4),
    "a table with few digits": table_of_jones(200, at=20, change=lambda energy: round(energy, 3)),
    **{f"a power of {n}": Power(n) for n in (6.5, 8.5, 12.0, 36.0)},
    "a declared step": Suspect(float(GAUSSIAN), jump=-0.2, place=5.0, smooth=-1.0, within=-1.0),
    "a sum of contacts": tribo.Hertz(5.0, 1.0) + -0.2 * tribo.Gaussian(1.0, 0.5),
    **{
        f"{how} at {cutoff}": JONES.with_cutoff(cutoff, how)
        for how in ("switch", "truncate", "shift", "force-shift")
        for cutoff in (1.3, 5.0)
    },
}
# In the default set, uncompiled: contacts that were misjudged once, and a flaw of each sort.
QUICK = [
    *("hertz by np.maximum", "hertz by np.where", "hertz by if", "an adhesive contact"),
    *(name for name in WRONG if name.startswith("hertz")),
    *("lennard-jones, half as much again in the core", "coulomb, a range that is too short"),
    *("morse, a minimum elsewhere", "morse, a kink declared two derivatives"),
    *(*STEPS, *TABLES, "a coarse table", "a table of a core", "a power of 12.0"),
]
ALL = [*WRONG, *RIGHT]


def judge(name):
    """Right potentials pass; of wrong ones a line fails, and says what to change."""
    report = check((WRONG | RIGHT)[name])
    assert report.passed == (name in RIGHT), str(report)
    for line in report.checks:
        assert line.passed or line.advice, line.name


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("name", QUICK)
def test_quick(name):
    """A part of the battery."""
    judge(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_battery(name):
    """None is misjudged."""
    judge(name)


def test_size():
    """The battery has as many wrong forces as the page on report cards says."""
    assert len(WRONG) == 78 and len(RIGHT) == 42
