"""Places and velocities of all bars and bobs at the start, by the independent solver.

Arrays of vectors are (2, asperites), those of all surfaces one after another.
"""

from typing import Any, NamedTuple

import numpy as np

from support import reference

SHORT = 1e-6  # duration of the run whose beginning is taken


class Start(NamedTuple):
    """The beginning of a scene."""

    counts: list[int]  # asperites of each surface
    velocity: np.ndarray  # of the centres of mass
    bob: np.ndarray
    depth: np.ndarray  # z of the bobs
    bar: np.ndarray
    bar_velocity: np.ndarray
    arm: np.ndarray  # distance of each bob from its centre of mass
    omega: np.ndarray
    twist: np.ndarray  # theta - phi - rest
    mass: np.ndarray
    frequency: np.ndarray  # of a pendulum without contact

    @property
    def parts(self) -> list[slice]:
        """The asperites of each surface."""
        ends = np.cumsum(self.counts).tolist()
        return [slice(end - n, end) for end, n in zip(ends, self.counts, strict=True)]


def start_of(table: dict[str, Any]) -> Start:
    """The beginning of the scene in a scene file's table."""
    found = reference.solve(table | {"duration": SHORT}, "long double").surfaces.values()
    counts = [each["theta"].shape[1] for each in found]
    surfaces = list(zip(table["surface"], counts, strict=True))

    def now(name: str) -> np.ndarray:
        return np.concatenate([each[name][0] for each in found])

    def given(name: str) -> np.ndarray:
        values = [s.get("asperite", {}).get(name, reference.PARAMETERS[name]) for s, _ in surfaces]
        return np.concatenate([np.broadcast_to(v, n) for v, n in zip(values, counts, strict=True)])

    centre, bob, bar, velocity = (
        np.array([now(f"{axis}_{of}") for axis in axes])
        for of, axes in (("cm", "xy"), ("bob", "xy"), ("bar", "xy"), ("cm", ("vx", "vy")))
    )
    omega = now("omega")
    x, y = bar - centre
    rest = [np.full(n, 0.0 if s.get("facing") != "up" else np.pi) for s, n in surfaces]
    depth = [
        s.get("depth", 0.0) + np.repeat(np.arange(n), m)[: n * m] * s.get("spacing", (0.0, 0.0))[1]
        for s, (m, n) in ((s, s.get("shape", (1, 1))) for s, _ in surfaces)
    ]
    m1 = given("m1")
    m2 = given("m2")
    inertia = m1 * m2 / (m1 + m2) * given("length") ** 2
    return Start(
        counts,
        velocity,
        bob,
        np.concatenate(depth),
        bar,
        velocity + omega * np.array([-y, x]),
        np.hypot(*(bob - centre)),
        omega,
        now("theta") - now("phi") - np.concatenate(rest),
        m1 + m2,
        np.sqrt(given("kappa") / inertia),
    )
