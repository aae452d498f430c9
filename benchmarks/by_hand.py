"""tribo's general loop against loops written by hand for one kind of scene each.

The scenes are two forced surfaces with clamped bars and Coulomb contact, one with lattice springs
on the upper surface, and a pair with a bath on the upper bar.  Both loops integrate by the method
"verlet" with the same ledger; those by hand stand in loops_by_hand.py.

Before anything is timed, both run for some steps, and their motion and works must agree.  Then they
are timed in turn.  The times are those of the processor, and the shortest of all rounds counts, so
that other programs on the machine disturb little.

    python benchmarks/by_hand.py [--json] [--rounds N] [--scenes 1+1 64+64 ...]
"""

import argparse
import json
import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from loops_by_hand import (
    Bath,
    Bobs,
    Bonds,
    Motion,
    Slide,
    Surfaces,
    bath_by_hand,
    springs_by_hand,
    surfaces_by_hand,
)

import tribo
from tribo.integrators.methods import METHODS
from tribo.kernels.status import PAUSED
from tribo.layout.layout import lay_out
from tribo.loops.general import GeneralLoop
from tribo.loops.setting import Setting

# Step of both loops [time].
STEP = 1e-3

# Steps before motion and works are compared.
COMPARED_STEPS = 2000

# Largest difference, relative to the largest number of its kind.
SAME = 1e-10

# Smallest such scale, for works that are zero [energy].
SMALLEST_SCALE = 1e-3

# Of the Coulomb contact [energy length].
STRENGTH = 0.02

# Angles from which the pendulums start [rad].
UPPER_SWING, LOWER_SWING = 0.2, -0.1

# Seconds of one timed call: long against the 50 us of a call from Python.
CALL = 0.01

# Timed calls of each loop.
ROUNDS = 100


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
        scale = max(float(np.max(np.abs(known))), SMALLEST_SCALE)
        difference = float(np.max(np.abs(found - known))) / scale
        assert difference < SAME, f"{case.name}: {name} differs by {difference:.1e}"


class Tribo:
    """tribo's general loop for one case, in the middle of a long run."""

    def __init__(self, case: Case) -> None:
        layout = lay_out(case.scene(1e6))
        self._loop = GeneralLoop(layout, METHODS["verlet"], Setting(step=STEP), layout.start, 0.0)
        self._times = layout.times
        self._columns = self._loop.room(self._times.size)

    def run(self, steps: int) -> None:
        """Take steps from the present state."""
        assert self._loop.advance(self._times, self._columns, steps) == PAUSED


def nanoseconds(loop: Tribo | ByHand, steps: int) -> float:
    """Nanoseconds of processor time a step, of so many steps."""
    began = time.thread_time_ns()
    loop.run(steps)
    return (time.thread_time_ns() - began) / steps


def timed(loop: Tribo | ByHand) -> tuple[Tribo | ByHand, int]:
    """A loop, and the number of steps of a timed call."""
    loop.run(1)  # compiles it
    steps = 10
    while steps * nanoseconds(loop, steps) < 0.5e9 * CALL:
        steps *= 2
    return loop, steps


def pair_loop(rounds: int) -> dict[str, float]:
    """Nanoseconds a force evaluation of the loop for pairs, by gauss-radau-15."""
    simulation = tribo.prepare(CASES[0].scene(10.0), accuracy=1e-8, method="gauss-radau-15")
    costs = [simulation.run(estimate=False).cost for _ in range(rounds)]
    taken = min(cost.wall_seconds for cost in costs)
    return {"pair_loop_ns_an_evaluation": 1e9 * taken / costs[0].force_evaluations}


def rows(rounds: int = ROUNDS, names: list[str] | None = None) -> list[dict[str, Any]]:
    """Nanoseconds a step of both loops, for every case."""
    cases = [case for case in CASES if names is None or case.name in names]
    for case in cases:
        check(case)
    loops = {case.name: (timed(Tribo(case)), timed(ByHand(case))) for case in cases}
    found = {name: [math.inf, math.inf] for name in loops}
    for _ in range(rounds):
        for name, both in loops.items():
            found[name] = [
                min(best, nanoseconds(*loop)) for best, loop in zip(found[name], both, strict=True)
            ]
    return [
        {"scene": name, "tribo_ns": general, "by_hand_ns": hand, "ratio": general / hand}
        | (pair_loop(rounds) if name == "1+1" else {})
        for name, (general, hand) in found.items()
    ]


def main() -> None:
    """Measure all cases in one process."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
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
