"""Choosing a method by a model of what each costs on a scene.

    seconds = evaluations x (seconds of an evaluation)
    evaluations = evaluations(1e-6) (accuracy / 1e-6)^(-1/slope), for each radian of the pendulums,
                  but at least those of one step for each sample, and of the steps towards the
                  encounters ahead
    seconds of an evaluation = (for each run) + (for each asperite) + (for each bath oscillator)

The numbers were measured by benchmarks/calibrate.py and are part of the source: no clock decides
which method is chosen.  Only their ratios enter, which differ little between machines.  Methods
that integrate bath oscillators numerically are stable only if steps are short against the fastest
of them.  Methods that advance oscillators exactly are stable, but their errors fall more slowly
until steps are that short.  Encounters ahead are those of bobs that keep their initial velocity.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from tribo.accuracy.comparison import Accuracy, strictest
from tribo.accuracy.encounter_estimate import steps_towards
from tribo.accuracy.tolerance_scales import first_step, unit_step
from tribo.integrators import methods
from tribo.layout.layout import Layout
from tribo.layout.member_numbers import MemberNumbers
from tribo.loops.pair import has_pair_loop
from tribo.loops.resolution import (
    bath_frequency,
    corrugation_frequency,
    longest_damped_step,
    longest_kick,
    longest_step,
    pendulum_frequency,
    spring_frequency,
    turn_of_step,
    user_frequency,
)
from tribo.model.settings import check_accuracy
from tribo.validation import POSITIVE, InputError, number

# The accuracy where neither the call nor the scene file gives one: far below what a figure can
# show, and far above round-off.
DEFAULT_ACCURACY = 1e-8
# Ratio of two times below which the model of costs does not tell one from the other.
LONGER = 1.1
# Step of a run with noise, in units of the first step of a run without: a tenth of a radian of the
# fastest pendulum or oscillator.
NOISY_STEP = 2.0
# Such a step is also at most this phase of springs between bars, of pulling springs, and of a
# user's forces [rad].
NOISY_PHASE = 0.1
# Most phase of a pendulum and of springs between two kicks [rad].  At 2, deflections are 0.64 of
# the right ones and springs become unstable; at pi, kicks are in resonance with the pendulum.
MOST_PHASE = 2.0


@dataclass(frozen=True)
class Rate:
    """What a method costs."""

    evaluations: float  # per radian of the fastest pendulum, at an accuracy of 1e-6
    slope: float  # a tenth of the error takes 10^(1/slope) times as many evaluations
    run: float  # time of an evaluation, whatever the scene [ns]
    asperite: float  # and for each asperite [ns]
    oscillator: float  # and for each coordinate of a bath [ns]
    step: int  # evaluations of a step


# Of all methods, including those that are the cheapest on no scene.
RATES = {
    "midpoint": Rate(440.0, 2.0, 108.0, 34.2, 1.5, 2),
    "rk4": Rate(20.1, 4.0, 83.0, 31.2, 1.4, 4),
    "dop853": Rate(5.91, 11.2, 92.5, 44.5, 2.4, 12),
    "rkn8": Rate(3.8, 12.1, 118.0, 47.5, 2.2, 9),
    "rkn12": Rate(8.0, 105.0, 108.0, 43.4, 2.6, 17),
    "gauss-radau-15": Rate(7.21, 26.7, 89.4, 38.8, 3.6, 18),
    "gauss-8": Rate(31.3, 26.9, 78.8, 30.2, 2.8, 28),
    "verlet": Rate(90.6, 2.0, 69.3, 29.3, 0.5, 1),
    "kahan-li-6": Rate(15.2, 6.25, 36.5, 29.0, 0.4, 9),
    "kahan-li-8": Rate(20.4, 14.4, 33.4, 28.6, 0.4, 17),
    "blanes-moan-6": Rate(13.3, 8.02, 35.7, 28.6, 0.0, 10),
}
# Of gauss-radau-15 in the loop for pairs.
PAIR = Rate(5.13, 21.4, 12.0, 0.0, 0.0, 18)
# Evaluations per radian of a bath's fastest oscillator that methods need for stability.
FAST = 1.6
# Evaluations and slope, as in Rate, with a fast bath, of methods that advance it exactly.
WITH_FAST_BATH = {
    "verlet": (108.0, 2.0),
    "kahan-li-6": (55.4, 4.25),
    "kahan-li-8": (71.5, 5.79),
}
# The steepest slope where some derivative of a potential jumps.
ROUGH_SLOPE = 12.0


@dataclass(frozen=True)
class Choice:
    """A method with an accuracy or a step.

    Attributes
    ----------
    method : Method
        How time advances.
    accuracy : float, mapping or None
        The relative error of everything, or of each observable named; None with a step.
    step : float or None
        The step [time]; None with an accuracy.
    why : str
        Why the method was chosen; empty where it was given.
    seconds : float
        Wall time of the choice [s].
    automatic : bool
        Whether the step was chosen too, and may be halved.
    """

    method: methods.Method
    accuracy: Accuracy | None
    step: float | None
    why: str = ""
    seconds: float = 0.0
    automatic: bool = False


def choose(
    layout: Layout, accuracy: Accuracy | None, method: str | None, step: float | None
) -> Choice:
    """The method and its accuracy or step for a request.

    Parameters
    ----------
    layout : Layout
        The scene.
    accuracy : float, mapping or None
        The relative error wanted, of everything or of each observable named.
    method : str or None
        A method's name; None takes the one that should be the fastest.
    step : float or None
        A step [time], in place of an accuracy.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        These do not go together, or the method cannot integrate the scene.
    """
    scene = layout.scene
    if accuracy is not None and step is not None:
        raise InputError("accuracy", "cannot go with a step; give one or the other")
    if method is None and methods.noisy(scene):
        method = "verlet"
    elif method is None and step is not None:
        method = "midpoint"
    if method is not None:
        methods.check(methods.named(method), scene)
    if methods.noisy(scene):
        return _noisy(layout, accuracy, step)
    wanted = check_accuracy(DEFAULT_ACCURACY if accuracy is None else accuracy)
    if method is None:
        began = time.perf_counter()
        chosen, why = cheapest(layout, strictest(wanted))
        return Choice(chosen, wanted, None, why, time.perf_counter() - began)
    chosen = methods.named(method)
    if step is None and (chosen.adaptive or accuracy is not None):
        return Choice(chosen, wanted, None)
    if chosen.adaptive:
        raise InputError(
            "step", f"cannot go with {chosen.name}, which chooses its steps; give an accuracy"
        )
    if step is None:
        raise InputError("step", f"is missing; {chosen.name} takes equal steps; or give accuracy")
    return Choice(chosen, None, _checked_step(layout, chosen, step))


def _checked_step(layout: Layout, method: methods.Method, step: float) -> float:
    """A given step.

    Raises InputError where a splitting method would not resolve the scene, unless that is allowed.
    """
    step = number("step", step, POSITIVE)
    if method.splits:
        check_damped_step(longest_damped_step(layout), step)
        check_resolved(layout, method, step)
    return step


def check_resolved(
    layout: Layout, method: methods.Method, step: float, members: MemberNumbers | None = None
) -> None:
    """Refuse a step with which a splitting method does not resolve the scene, or its members.

    Raises InputError, unless the scene allows it.
    """
    if layout.scene.numerics.allow_unresolved:
        return
    for what, frequency in (
        ("the fastest pendulum", pendulum_frequency(layout, members)),
        ("the stiffest spring between bars or to a stage", spring_frequency(layout, members)),
    ):
        if turn_of_step(layout, method, step, frequency) > MOST_PHASE:
            most = MOST_PHASE / (frequency * longest_kick(method))
            raise InputError(
                "step",
                f"must be at most {most:.3g} for {method.name}, got {step:g}: a longer one does "
                f"not resolve {what}, {frequency:.3g} rad/time; allow_unresolved permits it",
            )


def check_damped_step(longest: float, step: float) -> None:
    """Refuse a step with which reservoirs would heat swings.  Raises InputError."""
    if step > longest * (1.0 + 1e-9):
        raise InputError(
            "step",
            f"must be at most {longest:.3g} for the damping of the reservoir on these swings, got "
            f"{step:g}: a longer one would heat them",
        )


def _noisy(layout: Layout, accuracy: Accuracy | None, step: float | None) -> Choice:
    """One method integrates noise, and no two runs agree on any digit."""
    if accuracy is not None:
        raise InputError(
            "accuracy",
            "cannot be kept with thermal noise, where no two runs agree; give a step, and average "
            "over runs, as tribo.ensemble does",
        )
    method = methods.METHODS["verlet"]
    if step is not None:
        return Choice(method, None, _checked_step(layout, method, step))
    step = NOISY_STEP * first_step(layout)
    fastest = max(spring_frequency(layout), corrugation_frequency(layout), user_frequency(layout))
    step = min(step, longest_damped_step(layout))
    step = min(step, NOISY_PHASE / fastest if fastest > 0.0 else np.inf)
    return Choice(method, None, longest_step(layout, step), automatic=True)  # as it is taken


def cheapest(layout: Layout, accuracy: float) -> tuple[methods.Method, str]:
    """The method that should take the least time, and why in one sentence."""
    best, *others = estimates(layout, accuracy)
    why = f"{best.method.name} should be the fastest at {accuracy:.0e}"
    if others:
        ratio, name = others[0].seconds / best.seconds, others[0].method.name
        much = f"{ratio:.2g} times as long" if ratio >= LONGER else "hardly longer"
        why += f"; {name}, the next, should take {much}"
    return best.method, why


@dataclass(frozen=True)
class Estimate:
    """What one method should cost on one scene."""

    method: methods.Method
    evaluations: float
    seconds: float


def estimates(layout: Layout, accuracy: float) -> list[Estimate]:
    """Methods for the scene, the cheapest first.

    Equal steps cannot shorten at an encounter.  So methods with equal steps are considered only
    where a fast bath would make even the best of the others take short steps throughout.
    """
    scene = layout.scene
    work, oscillators = workload(layout), layout.coordinates - layout.core
    found = []
    for name, rate in RATES.items():
        method = methods.METHODS[name]
        if methods.refusal(method, scene) is not None:
            continue
        if method.smoothness > scene.smoothness and method.adaptive:
            continue
        if has_pair_loop(layout, method):
            rate = PAIR
        count = evaluations(name, rate, work, accuracy)
        each = rate.run + scene.count * rate.asperite + oscillators * rate.oscillator
        found.append(Estimate(method, count, 1e-9 * count * each))
    found.sort(key=lambda item: item.seconds)
    adaptive = [item for item in found if item.method.adaptive]
    return adaptive if adaptive and adaptive[0].evaluations > work.fast else found


@dataclass(frozen=True)
class Workload:
    """What a scene demands of any method."""

    radians: float  # of its fastest pendulum
    steps: float  # at least, for samples and encounters
    fast: float  # evaluations for stability with the fastest oscillator of its baths
    rough: bool  # whether some derivative of a potential jumps


def workload(layout: Layout) -> Workload:
    """What the scene demands of any method."""
    scene = layout.scene
    return Workload(
        radians=scene.duration / unit_step(layout),
        steps=max(steps_towards(layout), float(scene.times.size)),
        fast=FAST * scene.duration * bath_frequency(layout),
        rough=bool(np.isfinite(scene.smoothness)),
    )


def evaluations(name: str, rate: Rate, work: Workload, accuracy: float) -> float:
    """Force evaluations that a method should take."""

    def at_accuracy(each: float, slope: float) -> float:
        slope = min(slope, ROUGH_SLOPE) if work.rough else slope
        return work.radians * each * (accuracy / 1e-6) ** (-1.0 / slope)

    least = rate.step * work.steps
    count = max(at_accuracy(rate.evaluations, rate.slope), least)
    if not methods.METHODS[name].splits:
        return max(count, work.fast)
    return max(count, at_accuracy(*WITH_FAST_BATH[name])) if count < work.fast else count
