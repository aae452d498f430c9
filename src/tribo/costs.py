"""What a method is going to cost on a scene, and which costs least.

    seconds = evaluations x (seconds of an evaluation)
    evaluations = evaluations(1e-6) (accuracy / 1e-6)^(-1/slope), for each radian of the pendulums
    seconds of an evaluation = (for each run) + (for each asperite) + (for each bath oscillator)

or, by the loop of a pair's own, PAIR nanoseconds.

The numbers were measured by benchmarks/calibrate.py.  Only ratios of them enter the choice, and
these are much the same on every machine.  Methods that turn bath oscillators exactly need not
resolve their fastest; all others do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tribo import methods
from tribo.layout import laid_out
from tribo.pair import has_loop
from tribo.scene import Scene


@dataclass(frozen=True)
class Rate:
    """What a method takes."""

    evaluations: float  # for each radian of the fastest pendulum, at an accuracy of 1e-6
    slope: float  # an accuracy ten times better takes 10^(1/slope) times as many
    run: float  # nanoseconds of an evaluation, whatever the scene
    asperite: float  # and for each asperite
    oscillator: float  # and for each bath oscillator


RATES = {
    "dop853": Rate(7.0, 8.0, 200.0, 200.0, 20.0),
    "rkn8": Rate(5.0, 8.0, 200.0, 200.0, 20.0),
    "rkn12": Rate(6.0, 12.0, 200.0, 200.0, 20.0),
    "gauss-radau-15": Rate(12.0, 15.0, 200.0, 200.0, 20.0),
}


PAIR = 12.0  # nanoseconds of an evaluation by tribo.pair


@dataclass(frozen=True)
class Estimate:
    """What one method is expected to take on one scene."""

    method: methods.Method
    evaluations: float
    seconds: float


def estimates(scene: Scene, accuracy: float) -> list[Estimate]:
    """All methods that take the scene, the cheapest first."""
    found = []
    layout = laid_out(scene) if scene.count == 2 else None
    for name, rate in RATES.items():
        method = methods.METHODS[name]
        if methods.refusal(method, scene) is None:
            radians = _radians(scene, exact=method.splits)
            evaluations = radians * rate.evaluations * (accuracy / 1e-6) ** (-1.0 / rate.slope)
            each = rate.run + scene.count * rate.asperite + _oscillators(scene) * rate.oscillator
            if layout is not None and has_loop(layout, method):
                each = PAIR
            found.append(Estimate(method, evaluations, 1e-9 * evaluations * each))
    return sorted(found, key=lambda item: item.seconds)


def cheapest(scene: Scene, accuracy: float) -> tuple[methods.Method, str]:
    """The method that should take the least time, and why in one sentence."""
    best, *others = estimates(scene, accuracy)
    why = f"{best.method.name} should be the fastest at {accuracy:.0e}"
    if others:
        ratio = others[0].seconds / best.seconds
        why += f"; {others[0].method.name}, the next, should take {ratio:.2g} times as long"
    return best.method, why


def _radians(scene: Scene, exact: bool) -> float:
    """How far the fastest oscillation that must be resolved turns in the run."""
    fastest = 0.0
    for surface in scene.surfaces:
        each = surface.asperite.for_each(surface.count)
        inverse = 1.0 / each["inertia"]
        if surface.bars != "clamped":
            inverse = inverse + 1.0 / each["i2"]
        fastest = max(fastest, float(np.max(np.sqrt(each["kappa"] * inverse))))
        if not exact:
            frequencies = (*surface.bath.frequencies, *surface.bath.torsional_frequencies)
            fastest = max(fastest, *frequencies, 0.0)
    return max(fastest * scene.duration, 2.0 * math.pi)


def _oscillators(scene: Scene) -> int:
    """Coordinates of all baths together."""
    return sum(
        surface.count * (2 * surface.bath.masses.size + surface.bath.inertias.size)
        for surface in scene.surfaces
    )
