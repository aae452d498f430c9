"""What a method is going to cost on a scene, and which costs least.

    seconds = evaluations x (seconds of an evaluation)
    evaluations = evaluations(1e-6) (accuracy / 1e-6)^(-1/slope), for each radian of the pendulums,
                  but those of a step for each sample at least
    seconds of an evaluation = (for each run) + (for each asperite) + (for each bath oscillator)

The numbers were measured by benchmarks/calibrate.py.  Only ratios of them enter the choice, and
these are much the same on every machine.  Methods that do not turn bath oscillators exactly are
not stable unless steps are short against the fastest of these.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tribo import methods
from tribo.accuracy import unit_step
from tribo.layout import Layout, laid_out
from tribo.pair import has_loop
from tribo.scene import Scene


@dataclass(frozen=True)
class Rate:
    """What a method takes."""

    evaluations: float  # for each radian of the fastest pendulum, at an accuracy of 1e-6
    slope: float  # an accuracy ten times better takes 10^(1/slope) times as many
    run: float  # nanoseconds of an evaluation, whatever the scene
    asperite: float  # and for each asperite
    oscillator: float  # and for each coordinate of a bath
    step: int  # evaluations of a step, of which there is one at least for each sample


RATES = {
    "midpoint": Rate(440.0, 2.0, 264.0, 109.0, 19.9, 2),
    "rk4": Rate(20.1, 4.0, 207.0, 102.0, 18.2, 4),
    "dop853": Rate(5.91, 11.2, 285.0, 111.0, 22.7, 12),
    "rkn8": Rate(3.8, 12.1, 244.0, 125.0, 22.5, 9),
    "rkn12": Rate(8.0, 105.0, 186.0, 125.0, 27.8, 17),
    "gauss-radau-15": Rate(5.77, 25.7, 10.0, 101.0, 34.6, 18),
    "gauss-8": Rate(31.3, 26.9, 117.0, 90.3, 29.1, 28),
    "verlet": Rate(90.6, 2.0, 297.0, 124.0, 33.9, 1),
    "kahan-li-6": Rate(15.2, 6.25, 41.9, 126.0, 32.3, 9),
    "kahan-li-8": Rate(20.4, 14.4, 26.4, 126.0, 31.8, 17),
    "blanes-moan-6": Rate(13.3, 8.02, 36.1, 127.0, 0.0, 10),
}
FAST = 1.6  # evaluations for each radian of a bath's fastest oscillator, for stability
PAIR = replace(RATES["gauss-radau-15"], run=12.0, asperite=0.0)  # in a loop of its own


@dataclass(frozen=True)
class Estimate:
    """What one method is expected to take on one scene."""

    method: methods.Method
    evaluations: float
    seconds: float


def estimates(scene: Scene, accuracy: float) -> list[Estimate]:
    """Methods for the scene, the cheapest first.

    Equal steps cannot shorten at an encounter, so methods that make them are looked at only where
    a bath would have the others make short steps all the way.
    """
    layout = laid_out(scene)
    bathed = _oscillators(scene) > 0
    smoothness = min((i.potential.smoothness() for i in scene.interactions), default=np.inf)
    found = []
    for name, rate in RATES.items():
        method = methods.METHODS[name]
        if methods.refusal(method, scene) is not None or not (method.adaptive or bathed):
            continue
        if method.smoothness > smoothness and method.adaptive:
            continue
        if has_loop(layout, method):
            rate = PAIR
        radians = scene.duration / unit_step(layout)
        evaluations = radians * rate.evaluations * (accuracy / 1e-6) ** (-1.0 / rate.slope)
        evaluations = max(evaluations, float(rate.step * scene.times.size))
        if not method.splits:
            evaluations = max(evaluations, FAST * _fast_radians(layout))
        each = rate.run + scene.count * rate.asperite + _oscillators(scene) * rate.oscillator
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


def _fast_radians(layout: Layout) -> float:
    """How far the fastest oscillator of any bath turns in the run."""
    baths = (layout.model.bath, layout.model.torsional)
    fastest = [float(np.max(bath.frequency)) for bath in baths if bath is not None]
    return layout.scene.duration * max(fastest, default=0.0)


def _oscillators(scene: Scene) -> int:
    """Coordinates of all baths together."""
    return sum(
        surface.count * (2 * surface.bath.masses.size + surface.bath.inertias.size)
        for surface in scene.surfaces
    )
