"""tribo's general loop against loops written by hand for one kind of scene each.

Every scene is integrated by velocity Verlet with exact torsion springs, which is tribo's "verlet":
two forced surfaces with clamped bars and Coulomb contact; a row with lattice springs on its upper
surface; a pair with a bath on its upper bar.  The loops by hand compute the same motion and the
same ledger over structures of arrays, whose sizes are known only at run time.  They have no checks
of encounters, no samples, and no effect beyond those of their scene.

Before anything is timed, both are run for some steps, and their motion and works compared.  Then
they are timed in turn; times are medians over the rounds.

    python benchmarks/by_hand.py [--json] [--rounds N] [--scenes 1+1 64+64 ...]
"""

import argparse
import json
import math
import statistics
import time
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import njit

import tribo
from tribo.integrators.methods import METHODS
from tribo.kernels.status import PAUSED
from tribo.run.general_loop import GeneralLoop
from tribo.run.layout import lay_out

# Step of both loops [time].
STEP = 1e-3

# Steps before motion and works are compared.
COMPARED_STEPS = 2000

# Largest difference, relative to the largest number of its kind.
SAME = 1e-10

# Of the Coulomb contact [energy length].
STRENGTH = 0.02

# Angles from which the pendulums start [rad].
UPPER_SWING, LOWER_SWING = 0.2, -0.1

# Seconds of one timed call.
CALL = 0.02

# No more fast mathematics than contraction to fused multiply-add; sums are in any order only where
# `summed` says so.
loop = njit(error_model="numpy", fastmath={"contract"}, nogil=True)
part = njit(error_model="numpy", fastmath={"contract"}, forceinline=True, _nrt=False)
summed = njit(error_model="numpy", fastmath={"contract", "reassoc"}, forceinline=True, _nrt=False)

ROUNDING = 1.5 * 2.0**52  # adding and subtracting it rounds to an integer
QUARTER_TURN = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)


@part
def sine_cosine(x):
    """Sine and cosine, without branches: fdlibm's polynomials of K. C. Ng."""
    quarters = (x * 0.6366197723675814 + ROUNDING) - ROUNDING
    r = (x - quarters * QUARTER_TURN[0]) - quarters * QUARTER_TURN[1] - quarters * QUARTER_TURN[2]
    z = r * r
    sin = 1.58969099521155010221e-10 * z - 2.50507602534068634195e-08
    sin = sin * z + 2.75573137070700676789e-06
    sin = sin * z - 1.98412698298579493134e-04
    sin = sin * z + 8.33333333332248946124e-03
    sin = sin * z - 1.66666666666666324348e-01
    sin = r + r * z * sin
    cos = 2.08757232129817482790e-09 - 1.13596475577881948265e-11 * z
    cos = cos * z - 2.75573143513906633035e-07
    cos = cos * z + 2.48015872894767294178e-05
    cos = cos * z - 1.38888888888741095749e-03
    cos = cos * z + 4.16666666666666019037e-02
    cos = (1.0 - 0.5 * z) + z * z * cos
    quadrant = quarters - 4.0 * ((quarters * 0.25 - 0.375 + ROUNDING) - ROUNDING)
    even = abs(abs(quadrant - 2.0) - 1.0)
    one = cos if even < 0.5 else sin
    other = sin if even < 0.5 else cos
    one = one if quadrant < 1.5 else -one
    other = -other if abs(quadrant - 1.5) < 1.0 else other
    return one, other


class Surfaces(NamedTuple):
    """Asperites of both surfaces, those of the upper one first; arrays (n,)."""

    x: np.ndarray  # centres of mass at t = 0
    y: np.ndarray
    z: np.ndarray
    speed: np.ndarray  # along x
    charge: np.ndarray
    arm: np.ndarray  # l1, up or down
    torque: np.ndarray  # (l1 + l2) / inertia, up or down
    bar_arm: np.ndarray  # l2, up or down
    bar_torque: np.ndarray  # l2 / inertia, up or down
    end: np.ndarray  # inertia / bar length
    mass: np.ndarray
    frequency: np.ndarray


class Motion(NamedTuple):
    """State, accounts and scratch; arrays (n,)."""

    q: np.ndarray  # swing
    v: np.ndarray
    impulse_x: np.ndarray  # of f1
    impulse_y: np.ndarray
    work_x: np.ndarray  # of f1_x about the centre of mass, per length of the rod
    work_y: np.ndarray
    impulse_end: np.ndarray  # of f_L along y
    sin: np.ndarray
    cos: np.ndarray
    bob_x: np.ndarray
    bob_y: np.ndarray
    fx: np.ndarray  # f1
    fy: np.ndarray
    versine: np.ndarray  # of the torsion springs' rotation in a step
    sine: np.ndarray


class Bobs(NamedTuple):
    """Bobs of one surface: views of the arrays of both, (n,)."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    charge: np.ndarray
    fx: np.ndarray
    fy: np.ndarray


class Slide(NamedTuple):
    """Centres of mass of the upper surface, accounts and scratch; arrays (upper,)."""

    x: np.ndarray  # displacement
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    slide_x: np.ndarray  # pseudoworks of f1_x, f1_y and f_L
    slide_y: np.ndarray
    slide_end: np.ndarray
    inner_x: np.ndarray  # impulse of f_int, its work about the centre of mass, its pseudowork
    inner_y: np.ndarray
    inner_work: np.ndarray
    inner_slide: np.ndarray
    impulse_end: np.ndarray  # of f_L along y, a step before
    bar_x: np.ndarray  # displacement of the bar
    bar_y: np.ndarray
    hx: np.ndarray  # f_int
    hy: np.ndarray


class Bonds(NamedTuple):
    """Lattice springs; arrays (bonds,)."""

    one: np.ndarray
    other: np.ndarray
    stiffness: np.ndarray


class Bath(NamedTuple):
    """Oscillators on one bar; arrays (oscillators,)."""

    mass: np.ndarray
    frequency: np.ndarray
    versine: np.ndarray  # of a rotation in a step
    sine: np.ndarray
    x: np.ndarray
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray


@part
def rotation(a, m, tau):
    """1 - cos and sin of the torsion springs' rotation in tau."""
    for i in range(m.q.size):
        half = math.sin(0.5 * a.frequency[i] * tau)
        m.versine[i] = 2.0 * half * half
        m.sine[i] = math.sin(a.frequency[i] * tau)


@part
def drift(a, m, t):
    """Rotate the pendulums on their springs, and place the bobs at t."""
    for i in range(m.q.size):
        q = m.q[i]
        v = m.v[i]
        change = -m.versine[i] * v - m.sine[i] * a.frequency[i] * q
        q = q - m.versine[i] * q + m.sine[i] / a.frequency[i] * v
        m.q[i] = q
        m.v[i] = v + change
        m.impulse_end[i] -= a.end[i] * change
        sin, cos = sine_cosine(q)
        m.sin[i] = sin
        m.cos[i] = cos
        m.bob_x[i] = a.x[i] + a.speed[i] * t + a.arm[i] * sin
        m.bob_y[i] = a.y[i] - a.arm[i] * cos
        m.fx[i] = 0.0
        m.fy[i] = 0.0


@summed
def contact(one, other, strength):
    """Coulomb forces between all bobs of the two surfaces."""
    for i in range(one.x.size):
        x = one.x[i]
        y = one.y[i]
        z = one.z[i]
        charge = strength * one.charge[i]
        sum_x = 0.0
        sum_y = 0.0
        for j in range(other.x.size):
            dx = x - other.x[j]
            dy = y - other.y[j]
            dz = z - other.z[j]
            square = dx * dx + dy * dy + dz * dz
            f = charge * other.charge[j] / (square * math.sqrt(square))
            sum_x += f * dx
            sum_y += f * dy
            other.fx[j] -= f * dx
            other.fy[j] -= f * dy
        one.fx[i] = sum_x
        one.fy[i] = sum_y


@part
def kick(a, m, tau):
    """Forced asperites: f2 = -f1."""
    for i in range(m.q.size):
        fx = m.fx[i]
        fy = m.fy[i]
        along_x = fx * m.cos[i]
        along_y = fy * m.sin[i]
        change = tau * a.torque[i] * (along_x + along_y)
        middle = tau * (m.v[i] + 0.5 * change)
        m.v[i] += change
        m.impulse_x[i] += tau * fx
        m.impulse_y[i] += tau * fy
        m.work_x[i] += middle * along_x
        m.work_y[i] += middle * along_y


@loop
def surfaces_by_hand(a, m, one, other, strength, h, steps):
    """Two forced surfaces."""
    rotation(a, m, 0.5 * h)
    drift(a, m, 0.5 * h)
    rotation(a, m, h)
    for k in range(1, steps):
        contact(one, other, strength)
        kick(a, m, h)
        drift(a, m, (k + 0.5) * h)
    contact(one, other, strength)
    kick(a, m, h)
    rotation(a, m, 0.5 * h)
    drift(a, m, steps * h)


@part
def slide_drift(a, m, s, tau):
    """Move the centres of mass of the upper surface for tau; bobs and bars with them."""
    for i in range(s.x.size):
        s.x[i] += tau * s.vx[i]
        s.y[i] += tau * s.vy[i]
        m.bob_x[i] += s.x[i]
        m.bob_y[i] += s.y[i]
        s.bar_x[i] = s.x[i] - a.bar_arm[i] * m.sin[i]
        s.bar_y[i] = s.y[i] - a.bar_arm[i] * (1.0 - m.cos[i])
        s.hx[i] = 0.0
        s.hy[i] = 0.0
        s.slide_end[i] += (m.impulse_end[i] - s.impulse_end[i]) * s.vy[i]
        s.impulse_end[i] = m.impulse_end[i]


@part
def springs(s, bonds):
    """Forces of lattice springs on the bars."""
    for b in range(bonds.one.size):
        i = bonds.one[b]
        j = bonds.other[b]
        x = bonds.stiffness[b] * (s.bar_x[i] - s.bar_x[j])
        y = bonds.stiffness[b] * (s.bar_y[i] - s.bar_y[j])
        s.hx[i] -= x
        s.hy[i] -= y
        s.hx[j] += x
        s.hy[j] += y


@part
def slide_kick(a, m, s, tau):
    """Forced asperites of the upper surface, whose centres of mass yield to f_int."""
    for i in range(s.x.size):
        fx = m.fx[i]
        fy = m.fy[i]
        hx = s.hx[i]
        hy = s.hy[i]
        along_x = fx * m.cos[i]
        along_y = fy * m.sin[i]
        inner = hx * m.cos[i] + hy * m.sin[i]
        change = tau * (a.torque[i] * (along_x + along_y) - a.bar_torque[i] * inner)
        push_x = tau * hx
        push_y = tau * hy
        middle = tau * (m.v[i] + 0.5 * change)
        middle_x = s.vx[i] + 0.5 * push_x / a.mass[i]
        middle_y = s.vy[i] + 0.5 * push_y / a.mass[i]
        m.v[i] += change
        s.vx[i] += push_x / a.mass[i]
        s.vy[i] += push_y / a.mass[i]
        m.impulse_x[i] += tau * fx
        m.impulse_y[i] += tau * fy
        m.work_x[i] += middle * along_x
        m.work_y[i] += middle * along_y
        s.slide_x[i] += tau * fx * middle_x
        s.slide_y[i] += tau * fy * middle_y
        s.inner_x[i] += push_x
        s.inner_y[i] += push_y
        s.inner_work[i] -= middle * a.bar_arm[i] * inner
        s.inner_slide[i] += push_x * middle_x + push_y * middle_y


@loop
def springs_by_hand(a, m, low, low_m, s, bonds, one, other, strength, h, steps):
    """Two forced surfaces with lattice springs on the upper one."""
    rotation(a, m, 0.5 * h)
    drift(a, m, 0.5 * h)
    slide_drift(a, m, s, 0.5 * h)
    rotation(a, m, h)
    for k in range(1, steps + 1):
        contact(one, other, strength)
        springs(s, bonds)
        slide_kick(a, m, s, h)
        kick(low, low_m, h)
        if k < steps:
            drift(a, m, (k + 0.5) * h)
            slide_drift(a, m, s, h)
    rotation(a, m, 0.5 * h)
    drift(a, m, steps * h)
    slide_drift(a, m, s, 0.5 * h)


@part
def bath_rotation(bath, tau):
    """1 - cos and sin of the oscillators' rotation in tau."""
    for n in range(bath.mass.size):
        half = math.sin(0.5 * bath.frequency[n] * tau)
        bath.versine[n] = 2.0 * half * half
        bath.sine[n] = math.sin(bath.frequency[n] * tau)


@summed
def rotate_bath(bath, x, y):
    """Rotate the oscillators about a bar at (x, y); the momentum that they gain."""
    px = 0.0
    py = 0.0
    for n in range(bath.mass.size):
        frequency = bath.frequency[n]
        versine = bath.versine[n]
        sine = bath.sine[n]
        dx = bath.x[n] - x
        dy = bath.y[n] - y
        vx = bath.vx[n]
        vy = bath.vy[n]
        change_x = -versine * vx - sine * frequency * dx
        change_y = -versine * vy - sine * frequency * dy
        bath.x[n] += sine / frequency * vx - versine * dx
        bath.y[n] += sine / frequency * vy - versine * dy
        bath.vx[n] = vx + change_x
        bath.vy[n] = vy + change_y
        px += bath.mass[n] * change_x
        py += bath.mass[n] * change_y
    return px, py


@part
def push_bar(a, m, s, px, py):
    """Give momentum to the bar of asperite 0."""
    along = m.cos[0] * px + m.sin[0] * py
    change = -a.bar_torque[0] * along
    change_x = px / a.mass[0]
    change_y = py / a.mass[0]
    s.inner_x[0] += px
    s.inner_y[0] += py
    s.inner_work[0] -= a.bar_arm[0] * along * (m.v[0] + 0.5 * change)
    s.inner_slide[0] += px * (s.vx[0] + 0.5 * change_x) + py * (s.vy[0] + 0.5 * change_y)
    m.v[0] += change
    s.vx[0] += change_x
    s.vy[0] += change_y


@loop
def bath_by_hand(a, m, low, low_m, s, bath, one, other, strength, h, steps):
    """A forced pair with a bath on the upper bar."""
    rotation(a, m, 0.5 * h)
    drift(a, m, 0.5 * h)
    slide_drift(a, m, s, 0.5 * h)
    rotation(a, m, h)
    bath_rotation(bath, h)
    for k in range(1, steps + 1):
        contact(one, other, strength)
        slide_kick(a, m, s, 0.5 * h)
        kick(low, low_m, 0.5 * h)
        px, py = rotate_bath(bath, s.bar_x[0], s.bar_y[0])
        push_bar(a, m, s, -px, -py)
        slide_kick(a, m, s, 0.5 * h)
        kick(low, low_m, 0.5 * h)
        if k < steps:
            drift(a, m, (k + 0.5) * h)
            slide_drift(a, m, s, h)
    rotation(a, m, 0.5 * h)
    drift(a, m, steps * h)
    slide_drift(a, m, s, 0.5 * h)


@dataclass(frozen=True)
class Case:
    """Two rows of asperites, the upper one moving."""

    name: str
    upper: int
    lower: int
    stiffness: float = 0.0
    oscillators: int = 0

    @property
    def slides(self) -> bool:
        """Whether the centres of mass of the upper surface leave their uniform motion."""
        return self.stiffness > 0.0 or self.oscillators > 0

    def scene(self, duration: float) -> tribo.Scene:
        """The scene, to be run for a duration."""
        frequencies = np.linspace(0.5, 40.0, self.oscillators)
        upper = tribo.Surface(
            "upper",
            bob=(-3.3, 0.9),
            velocity=(0.5, 0.0),
            shape=(self.upper, 1),
            spacing=(1.1, 0.0),
            springs=tribo.Springs(stiffness=self.stiffness),
            bath=tribo.Bath(np.full(self.oscillators, 1e-3), frequencies),
            initial=tribo.Initial(swing=UPPER_SWING),
        )
        lower = tribo.Surface(
            "lower",
            facing="up",
            shape=(self.lower, 1),
            spacing=(1.0, 0.0),
            initial=tribo.Initial(swing=LOWER_SWING),
        )
        output = tribo.Output(samples=2)
        return tribo.Scene((upper, lower), tribo.Coulomb(STRENGTH), duration, output=output)


CASES = (
    Case("1+1", 1, 1),
    Case("3+3", 3, 3),
    Case("8+8", 8, 8),
    Case("64+64", 64, 64),
    Case("32+32 springs", 32, 32, stiffness=5.0),
    Case("1+1 bath 200", 1, 1, oscillators=200),
)


class ByHand:
    """The loop by hand for one case, and its state."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self._scene = case.scene(1.0)
        count = case.upper + case.lower
        self.a = Surfaces(*self._constants())
        self.m = Motion(*np.zeros((len(Motion._fields), count)))
        self.m.q[:] = np.repeat((UPPER_SWING, LOWER_SWING), (case.upper, case.lower))
        self._start = self.m.q.copy()
        a, m, upper = self.a, self.m, case.upper
        both = (m.bob_x, m.bob_y, a.z, a.charge, m.fx, m.fy)
        self.bobs = Bobs(*(x[:upper] for x in both)), Bobs(*(x[upper:] for x in both))
        self.lower = Surfaces(*(x[upper:] for x in a)), Motion(*(x[upper:] for x in m))
        self.s = Slide(*np.zeros((len(Slide._fields), case.upper)))
        bonds = np.arange(case.upper - 1)
        self.bonds = Bonds(bonds, bonds + 1, np.full(bonds.size, case.stiffness))
        bath = self._scene.surfaces[0].bath
        self.bath = Bath(bath.masses, bath.frequencies, *np.zeros((6, case.oscillators)))
        arm = self.a.bar_arm[0]
        self.bath.x[:] = -arm * math.sin(self.m.q[0])
        self.bath.y[:] = -arm * (1.0 - math.cos(self.m.q[0]))

    def _each(self, values: Any) -> np.ndarray:
        """One number per surface, repeated for its asperites."""
        return np.repeat(values, [surface.count for surface in self._scene.surfaces]).astype(float)

    def _constants(self) -> list[np.ndarray]:
        surfaces = self._scene.surfaces
        bobs = np.concatenate([s.resting_bobs((0.0, 0.0, 0.0)) for s in surfaces])
        each = [s.asperite.for_each(s.count) for s in surfaces]
        a = {key: np.concatenate([e[key] for e in each]) for key in each[0]}
        facing = self._each([surface.facing_sign for surface in surfaces])
        speed = self._each([surface.velocity[0] for surface in surfaces])
        rod = facing * (a["l1"] + a["l2"])
        self.kappa, self.bar_length = a["kappa"], a["bar_length"]
        return [
            *(bobs[:, 0], bobs[:, 1] + facing * a["l1"], bobs[:, 2].copy(), speed, a["charge"]),
            *(facing * a["l1"], rod / a["inertia"], facing * a["l2"]),
            *(facing * a["l2"] / a["inertia"], a["inertia"] / a["bar_length"], a["mass"]),
            np.sqrt(a["kappa"] / a["inertia"]),
        ]

    def run(self, steps: int) -> None:
        """Take steps from the present state, with t = 0 at their start."""
        a, m = self.a, self.m
        contact = (*self.bobs, STRENGTH, STEP, steps)
        if self.case.oscillators:
            bath_by_hand(a, m, *self.lower, self.s, self.bath, *contact)
        elif self.case.stiffness:
            springs_by_hand(a, m, *self.lower, self.s, self.bonds, *contact)
        else:
            surfaces_by_hand(a, m, *contact)

    def ledger(self, t: float) -> dict[str, np.ndarray]:
        """Motion and works of all asperites in the laboratory, after a run to t."""
        a, m, upper = self.a, self.m, self.case.upper
        slide = Slide(*(np.append(x, np.zeros(self.case.lower)) for x in self.s))
        about = m.work_x + m.work_y
        arcs = [np.sin(q) - q * np.cos(q) for q in (self._start, m.q)]
        end_about = -a.bar_arm * self.kappa / self.bar_length * (arcs[1] - arcs[0])
        facing = np.where(np.arange(m.q.size) < upper, 1.0, -1.0)
        return {
            "omega": m.v,
            "x_cm": a.x + a.speed * t + slide.x,
            "vx_cm": a.speed + slide.vx,
            "y_cm": a.y + slide.y,
            "w1": a.arm * about + a.speed * m.impulse_x + slide.slide_x + slide.slide_y,
            "w2": a.bar_arm * about - a.speed * m.impulse_x - slide.slide_x - slide.slide_y,
            "wL": end_about + slide.slide_end,
            "w_int": slide.inner_work + a.speed * slide.inner_x + slide.inner_slide,
            "theta": m.q + np.where(facing > 0.0, 0.0, math.pi),
        }


def check(case: Case) -> None:
    """Assert that both loops give the same motion and works."""
    duration = COMPARED_STEPS * STEP
    result = tribo.simulate(case.scene(duration), method="verlet", step=STEP)
    hand = ByHand(case)
    hand.run(COMPARED_STEPS)
    surfaces = result.end["surfaces"].values()
    for name, found in hand.ledger(duration).items():
        known = np.concatenate([np.asarray(surface[name]) for surface in surfaces])
        scale = max(float(np.max(np.abs(known))), 1e-3)
        difference = float(np.max(np.abs(found - known))) / scale
        assert difference < SAME, f"{case.name}: {name} differs by {difference:.1e}"


class Tribo:
    """tribo's general loop for one case, in the middle of a long run."""

    def __init__(self, case: Case) -> None:
        layout = lay_out(case.scene(1e6))
        self._loop = GeneralLoop(layout, METHODS["verlet"], STEP, layout.start, 0.0)
        self._times = layout.times
        self._columns = self._loop.room(self._times.size)
        self.run(1)

    def run(self, steps: int) -> None:
        """Take steps from the present state."""
        assert self._loop.advance(self._times, self._columns, steps) == PAUSED


def seconds(loop: Tribo | ByHand, steps: int) -> float:
    """Seconds of so many steps."""
    began = time.perf_counter()
    loop.run(steps)
    return time.perf_counter() - began


def fresh(case: Case) -> tuple[Tribo, ByHand, int]:
    """Both loops at the start of their runs, and the number of steps of a timed call."""
    hand = ByHand(case)
    hand.run(1)
    steps = int(CALL / (seconds(hand, 1000) / 1000))
    return Tribo(case), ByHand(case), max(10, min(steps, COMPARED_STEPS * 100))


def pair_loop(rounds: int) -> dict[str, float]:
    """Nanoseconds a force evaluation of the loop for pairs, by gauss-radau-15."""
    simulation = tribo.prepare(CASES[0].scene(10.0), accuracy=1e-8, method="gauss-radau-15")
    costs = [simulation.run(estimate=False).cost for _ in range(rounds)]
    taken = statistics.median(cost.wall_seconds for cost in costs)
    return {"pair_loop_ns_an_evaluation": 1e9 * taken / costs[0].force_evaluations}


def rows(rounds: int = 50, names: list[str] | None = None) -> list[dict[str, Any]]:
    """Nanoseconds a step of both loops, for every case."""
    cases = [case for case in CASES if names is None or case.name in names]
    for case in cases:
        check(case)
    loops = {case.name: fresh(case) for case in cases}
    taken: dict[str, list[tuple[float, float]]] = {case.name: [] for case in cases}
    for _ in range(rounds):
        for name, (general, hand, steps) in loops.items():
            taken[name].append((seconds(general, steps) / steps, seconds(hand, steps) / steps))
    found = []
    for name, pairs in taken.items():
        tribo_ns, by_hand_ns = (
            1e9 * statistics.median(times) for times in zip(*pairs, strict=True)
        )
        row = {"scene": name, "tribo_ns": tribo_ns, "by_hand_ns": by_hand_ns}
        found.append(row | {"ratio": tribo_ns / by_hand_ns})
        if name == "1+1":
            found[-1] |= pair_loop(rounds)
    return found


def main() -> None:
    """Measure all cases in one process."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--rounds", type=int, default=50)
    parser.add_argument("--scenes", nargs="*", choices=[case.name for case in CASES])
    options = parser.parse_args()
    found = rows(options.rounds, options.scenes)
    if options.json:
        print(json.dumps({"rows": found}, indent=1))
        return
    print(f"{'scene':<14} {'tribo, ns a step':>17} {'by hand':>9} {'ratio':>6}")
    for row in found:
        print(
            f"{row['scene']:<14} {row['tribo_ns']:>17.0f} {row['by_hand_ns']:>9.0f} "
            f"{row['ratio']:>6.2f}"
        )
        if "pair_loop_ns_an_evaluation" in row:
            each = row["pair_loop_ns_an_evaluation"]
            print(f"{'':<14} the loop for pairs: {each:.0f} ns a force evaluation")


if __name__ == "__main__":
    main()
