"""The method and its accuracy or step, as asked for or by the model of costs."""

import math
import time
from dataclasses import dataclass

import numpy as np

from tribo.accuracy.comparison import Accuracy, strictest
from tribo.accuracy.cost_model import estimates
from tribo.integrators import methods
from tribo.integrators.step_control import count_of_steps
from tribo.layout.layout import Layout
from tribo.layout.scene_records import MemberNumbers
from tribo.loops import resolution
from tribo.model.settings import check_accuracy
from tribo.validation import POSITIVE, InputError, number

# The accuracy if none is given: far below what a figure can show, and far above round-off.
DEFAULT_ACCURACY = 1e-8
# Ratio of two times below which the model of costs does not tell one from the other.
LONGER = 1.1
# Step with noise, in units of the first step without: 0.1 rad of the fastest pendulum or bath.
NOISY_STEP = 2.0
# Most phase of springs between bars, of pulling springs, and of a user's forces in a step [rad].
NOISY_PHASE = 0.1
# Most phase of a pendulum and of springs between two kicks [rad].  At 2, deflections are 0.64 of
# the right ones and springs become unstable; at pi, kicks are in resonance with the pendulum.
MOST_PHASE = 2.0
# Part of a time between samples within which a step ends at a kink of a schedule.
MET = 1e-9
# Numbers of steps that are tried, to find one with which steps end at all kinks.
MOST_COUNTS = 10_000


@dataclass(frozen=True)
class Choice:
    method: methods.Method
    accuracy: Accuracy | None
    step: float | None  # [time]
    why: str = ""  # why the method was chosen; empty where it was given
    seconds: float = 0.0  # wall time of the choice
    automatic: bool = False  # whether the step was chosen too, and may be halved


def choose(
    layout: Layout, accuracy: Accuracy | None, method: str | None, step: float | None
) -> Choice:
    """The method, by default the fastest, and its accuracy or step.  Raises InputError."""
    scene = layout.scene
    if accuracy is not None and step is not None:
        raise InputError("accuracy", "cannot go with a step; give one or the other")
    if method is None and scene.is_noisy:
        method = methods.NOISY
    elif method is None and step is not None:
        method = "midpoint"
    if method is not None:
        methods.check(methods.named(method), scene)
    if scene.is_noisy:
        return _noisy(layout, accuracy, step)
    wanted = check_accuracy("accuracy", DEFAULT_ACCURACY if accuracy is None else accuracy)
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
    """A given step.  Raises InputError where a splitting method would not resolve the scene."""
    step = number("step", step, POSITIVE)
    check_kinks(layout, step)
    if method.splits:
        check_damped_step(resolution.longest_damped_step(layout), step)
        check_resolved(layout, method, step)
    return step


def check_kinks(layout: Layout, step: float) -> None:
    """Refuse equal steps of which none ends at a kink of a schedule.  Raises InputError."""
    kinks = layout.legs.kinks
    ends = layout.times
    after = np.searchsorted(ends, kinks)
    # Lengths of times between samples, and the parts of each at which there are kinks.
    between: list[tuple[float, np.ndarray]] = []
    missed = None
    for k in np.unique(after[(after > 0) & (after < ends.size)]):
        length = float(ends[k] - ends[k - 1])
        own = kinks[after == k]
        between.append((length, (own - ends[k - 1]) / length))
        if missed is None and not _are_met([between[-1]], step):
            missed = own[0]
    if missed is None:
        return
    longest = between[0][0]
    least = int(count_of_steps(longest, step))
    steps = (longest / count for count in range(least, least + MOST_COUNTS))
    found = next((each for each in steps if _are_met(between, each)), None)
    advice = "add that time to output.times"
    if found is not None:
        digit = 10.0 ** (math.floor(math.log10(found)) - 5)
        advice = (
            f"{digit * math.ceil(found / digit - MET):.6g} does, or {advice}"  # as few steps fit
        )
    raise InputError(
        "step",
        f"must end at the kink of a schedule at t = {missed:.10g}, as steps are equal parts of the "
        f"times between samples; {step:g} does not; {advice}",
    )


def _are_met(between: list[tuple[float, np.ndarray]], step: float) -> bool:
    """Whether equal steps end at some parts of times between samples."""
    for length, parts in between:
        count = count_of_steps(length, step)
        steps = parts * count
        if np.any(np.abs(steps - np.round(steps)) > MET * count):
            return False
    return True


def check_resolved(
    layout: Layout, method: methods.Method, step: float, members: MemberNumbers | None = None
) -> None:
    """Refuse a step with which a splitting method does not resolve the scene, or its members."""
    if layout.scene.numerics.allow_unresolved:
        return
    springs = resolution.spring_frequency(layout, members)
    found = {"the fastest pendulum": resolution.pendulum_frequency(layout, members)}
    found["the stiffest spring between bars or to a stage"] = springs
    for what, frequency in found.items():
        if resolution.turn_of_step(layout, method, step, frequency) > MOST_PHASE:
            most = MOST_PHASE / (frequency * resolution.longest_kick(method))
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
    method = methods.METHODS[methods.NOISY]
    if step is not None:
        return Choice(method, None, _checked_step(layout, method, step))
    return Choice(method, None, bounded_step(layout), automatic=True)


def bounded_step(layout: Layout, members: MemberNumbers | None = None) -> float:
    """The longest step with noise, by the frequencies that a scene states, or any of its members.

    Contacts and fields depend on the motion: see `accuracy.noisy_step`.
    """
    springs = resolution.spring_frequency(layout, members)
    user = resolution.user_frequency(layout)
    fastest = max(springs, resolution.corrugation_frequency(layout), user)
    fastest = max(fastest, resolution.schedule_frequency(layout))
    step = min(
        NOISY_STEP * resolution.first_step(layout, members),
        resolution.longest_damped_step(layout, members),
        NOISY_PHASE / fastest if fastest > 0.0 else np.inf,
    )
    return resolution.longest_step(layout, step)


def cheapest(layout: Layout, accuracy: float) -> tuple[methods.Method, str]:
    """The method that should take the least time, and why in one sentence."""
    best, *others = estimates(layout, accuracy)
    why = f"{best.method.name} should be the fastest at {accuracy:.0e}"
    if others:
        ratio = others[0].seconds / best.seconds
        name = others[0].method.name
        much = f"{ratio:.2g} times as long" if ratio >= LONGER else "hardly longer"
        why += f"; {name}, the next, should take {much}"
    return best.method, why
