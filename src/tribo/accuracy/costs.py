"""What a method is going to cost on a scene, and which costs least.

    seconds = evaluations x (seconds of an evaluation)
    evaluations = evaluations(1e-6) (accuracy / 1e-6)^(-1/slope), for each radian of the pendulums,
                  but those of a step for each sample, and for each step towards the encounters
                  ahead, at least
    seconds of an evaluation = (for each run) + (for each asperite) + (for each bath oscillator)

The numbers were measured by benchmarks/calibrate.py.  Only ratios of them enter the choice, and
these are much the same on every machine.  Methods that do not turn bath oscillators exactly are
not stable unless steps are short against the fastest of these; those that do are stable, but
errors fall more slowly until then.  Encounters ahead are those of bobs that slide as they begin,
and do not swing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tribo.accuracy.encounter_estimate import steps_towards
from tribo.accuracy.scales import unit_step
from tribo.integrators import methods
from tribo.model.scene import Scene
from tribo.run.layout import Layout
from tribo.run.pair_adapter import has_pair_loop


@dataclass(frozen=True)
class Rate:
    """What a method takes."""

    evaluations: float  # for each radian of the fastest pendulum, at an accuracy of 1e-6
    slope: float  # an accuracy ten times better takes 10^(1/slope) times as many
    run: float  # nanoseconds of an evaluation, whatever the scene
    asperite: float  # and for each asperite
    oscillator: float  # and for each coordinate of a bath
    step: int  # evaluations of a step, of which there is one at least for each sample


RATES = {  # of all methods, though some are never the cheapest that takes a scene
    "midpoint": Rate(440.0, 2.0, 204.0, 124.0, 6.73, 2),
    "rk4": Rate(20.1, 4.0, 146.0, 121.0, 6.01, 4),
    "dop853": Rate(5.91, 11.2, 201.0, 134.0, 8.78, 12),
    "rkn8": Rate(3.8, 12.1, 196.0, 136.0, 9.93, 9),
    "rkn12": Rate(8.0, 105.0, 150.0, 137.0, 11.1, 17),
    "gauss-radau-15": Rate(7.21, 26.7, 0.0, 106.0, 11.7, 18),
    "gauss-8": Rate(31.3, 26.9, 68.2, 96.1, 9.69, 28),
    "verlet": Rate(90.6, 2.0, 253.0, 122.0, 7.7, 1),
    "kahan-li-6": Rate(15.2, 6.25, 24.9, 122.0, 10.4, 9),
    "kahan-li-8": Rate(20.4, 14.4, 2.0, 123.0, 10.5, 17),
    "blanes-moan-6": Rate(13.3, 8.02, 12.5, 125.0, 0.0, 10),
}
FAST = 1.6  # evaluations for each radian of a bath's fastest oscillator, for stability
BATHED = {  # evaluations and slope of methods that turn oscillators exactly, with a fast bath
    "verlet": (108.0, 2.0),
    "kahan-li-6": (55.4, 4.25),
    "kahan-li-8": (71.5, 5.79),
}
ROUGH = 12.0  # the steepest slope where some derivative of a potential jumps
PAIR = Rate(5.13, 21.4, 12.0, 0.0, 0.0, 18)  # gauss-radau-15 in a loop of its own


@dataclass(frozen=True)
class Estimate:
    """What one method is expected to take on one scene."""

    method: methods.Method
    evaluations: float
    seconds: float


@dataclass(frozen=True)
class Task:
    """What a scene asks of any method."""

    radians: float  # of its fastest pendulum
    steps: float  # at least, for samples and encounters
    fast: float  # evaluations that are stable with the fastest oscillator of its baths
    rough: bool  # whether some derivative of a potential jumps


def task(layout: Layout) -> Task:
    """What the scene that is laid out asks for."""
    scene = layout.scene
    return Task(
        radians=scene.duration / unit_step(layout),
        steps=max(steps_towards(layout), float(scene.times.size)),
        fast=FAST * _fast_radians(layout),
        rough=bool(np.isfinite(scene.smoothness)),
    )


def evaluations(name: str, rate: Rate, job: Task, accuracy: float) -> float:
    """How many a method is expected to take."""

    def within(each: float, slope: float) -> float:
        slope = min(slope, ROUGH) if job.rough else slope
        return job.radians * each * (accuracy / 1e-6) ** (-1.0 / slope)

    least = rate.step * job.steps
    if not methods.METHODS[name].splits:
        return max(within(rate.evaluations, rate.slope), least, job.fast)
    count = max(within(rate.evaluations, rate.slope), least)
    return max(count, within(*BATHED[name])) if count < job.fast else count


def estimates(layout: Layout, accuracy: float) -> list[Estimate]:
    """Methods for the scene, the cheapest first.

    Equal steps cannot shorten at an encounter, so methods that make them are looked at only where
    a fast bath would have the best of the others make short steps all the way.
    """
    scene = layout.scene
    job, oscillators = task(layout), _oscillators(scene)
    found = []
    for name, rate in RATES.items():
        method = methods.METHODS[name]
        if methods.refusal(method, scene) is not None:
            continue
        if method.smoothness > scene.smoothness and method.adaptive:
            continue
        if has_pair_loop(layout, method):
            rate = PAIR
        count = evaluations(name, rate, job, accuracy)
        each = rate.run + scene.count * rate.asperite + oscillators * rate.oscillator
        found.append(Estimate(method, count, 1e-9 * count * each))
    found.sort(key=lambda item: item.seconds)
    adaptive = [item for item in found if item.method.adaptive]
    return adaptive if adaptive and adaptive[0].evaluations > job.fast else found


def cheapest(layout: Layout, accuracy: float) -> tuple[methods.Method, str]:
    """The method that should take the least time, and why in one sentence."""
    best, *others = estimates(layout, accuracy)
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
